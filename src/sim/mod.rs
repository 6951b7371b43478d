//! The fixed-step session (10 ms ticks) that runs the stepper or the articulated body under a scenario, and the trace it leaves.

pub mod articulated;
pub mod balls;
mod homeward;
mod looks;
mod mirror;
mod moved;
mod pilot;
mod record;
mod retrace;
mod run;
pub mod script;
mod search;
pub mod session;
pub mod trace;

pub use articulated::{Articulated, ArticulatedOptions, Ease, Help, Things, simulate_articulated, simulate_with};
pub use balls::{Flown, Incoming, Struck};
pub use pilot::FASTEST;
pub use record::PRESSED;
pub use script::Script;
pub use search::{Ahead, Searched};
pub use session::{Session, SessionPush, SimulateOptions, simulate, simulate_pushes};
pub use trace::{TickState, Trace};
