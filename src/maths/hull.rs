//! Convex hulls in the ground plane and signed distances to them.
