//! Plain data, with serde and validation: what the rows above pass to each other. No I/O, no algorithms.

pub mod body;
pub mod capture;
pub mod clip;
pub mod file_kind;
pub mod findings;
mod leg_scale;
pub mod load;
mod mirror;
pub mod physique;
pub mod pose;
pub mod props;
pub mod report;
pub mod role;
pub mod scenario;
mod scenario_check;
pub mod scenario_errors;
mod scenario_forms;
mod scenario_lane_rules;
mod scenario_reader;
pub mod scenario_rules;
mod scenario_tables;
pub mod scenario_text;
pub mod scenario_write;
pub mod schema;
#[cfg(test)]
mod schema_check;
pub mod sweep;
mod sweep_axes;
mod sweep_bake;
pub mod sweep_range;
pub mod sweep_text;
pub mod terrain;

pub use body::{Body, BodyJoint, Flesh, FootShape, Segment, Side};
pub use capture::Capture;
pub use clip::{Channel, Clip, Interpolation, KeyValues, Target};
pub use file_kind::FileKind;
pub use load::Load;
pub use physique::{Physique, Plant, Stance};
pub use pose::BodyPose;
pub use props::Prop;
pub use report::ClipReport;
pub use role::Role;
pub use scenario::Scenario;
pub use scenario_errors::{ScenarioErrors, ScenarioSource};
pub use sweep::Sweep;
pub use terrain::{Spot, Terrain};
