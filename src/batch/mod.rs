//! Many variations of a scenario: a sweep to a plan, a plan to clips side by side, and what they came to.
//!
//! [`plan`] makes the list and checks it, [`run`] bakes it on all cores, each clip as `bake` alone would.

pub mod combine;
pub mod farm;
pub mod manifest;
pub mod merged;
pub mod name;
pub mod openjd;
mod paths;
pub mod pictures;
pub mod plan;
pub mod record;
pub mod run;
pub mod slurm;

pub use plan::{Plan, Variation, plan};
