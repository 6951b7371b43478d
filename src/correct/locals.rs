//! Back to nodes.
