//! Trace to clip: the passes that see the whole run before the first key is written.
//!
pub mod balance;
pub mod contacts;
pub mod feet;
pub mod perform;
pub mod reach;
pub mod timeline;

/// Why there is no clip.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The scenario asks for what this version cannot do.
    #[error(
        "{what} is not available yet: this version bakes pushes and pulls of a standing character on flat ground. Remove {remedy} and bake again"
    )]
    NotAvailable {
        /// What was asked.
        what: String,
        /// What to take out.
        remedy: String,
    },
    /// The simulation broke down.
    #[error(
        "the simulation broke down at {time:.2} s: {what} is not a finite number. Please report the rig and the scenario"
    )]
    BrokeDown {
        /// s.
        time: f64,
        /// What became infinite.
        what: &'static str,
    },
}
