//! The fixed-step session (10 ms ticks) that runs the stepper under a scenario, and the trace it leaves.

pub mod script;
pub mod session;
pub mod trace;

pub use script::Script;
pub use session::{Session, SessionPush, SimulateOptions, simulate, simulate_pushes};
pub use trace::{TickState, Trace};
