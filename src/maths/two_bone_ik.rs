//! Two-bone inverse kinematics.
