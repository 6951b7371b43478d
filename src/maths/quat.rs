//! Rotations: swing and twist, shortest arcs, angular velocity.
