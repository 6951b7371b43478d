//! The fixed-step session (10 ms ticks) that runs the stepper under a scenario, and the trace it leaves.

pub mod trace;

pub use trace::{TickState, Trace};
