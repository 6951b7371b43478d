//! Damped springs integrated exactly.
