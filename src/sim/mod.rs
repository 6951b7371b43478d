//! The fixed-step session (10 ms ticks) that runs the stepper under a scenario, and the trace it leaves.

pub mod session;
pub mod trace;

pub use session::{Session, SessionPush, SimulateOptions, simulate_pushes};
pub use trace::{TickState, Trace};
