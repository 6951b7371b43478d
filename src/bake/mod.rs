//! Trace to clip: the passes that see the whole run before the first key is written.

pub mod contacts;
pub mod keys;
mod leg_chain;
pub mod root_motion;
