//! The paper's low-dimensional controller: a point mass on springy legs with feet that hold an area, stepping to stay up.
//!
//! [`tick`] runs a tick: `control` (the order of things), `decide` (whether, which foot, when, where), `foothold` (the
//! paper's step length), `balance` (ankle feedback), `legs` (springs and flight), `swing` (the foot's way), `support` (the
//! soles). All tuning is in [`Params`], all memory in [`State`].
//!
//! Pure functions and plain state; no I/O, no allocation in a tick. Scenario space, SI units. Sources: Kenwright, "Watch
//! Your Step" (2013); the capture point of Koolen (2012) and the extrapolated centre of mass of Hof (2005).

mod balance;
mod control;
mod decide;
mod foothold;
mod legs;
pub mod params;
pub mod state;
pub mod support;
mod swing;

pub use control::tick;
pub use params::{Params, Style, Trigger};
pub use state::{Inputs, Intent, Passing, State, Swing, TickOutput};
pub use support::{Support, SupportModel};

use crate::model::Side;
use glam::{DVec2, DVec3};

/// What the controller needs to know of a body, measured in its natural stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Physique {
    /// kg.
    pub mass: f64,
    /// m, centre of mass over the ground in the natural stand.
    pub com_height: f64,
    /// m, hip to ankle along the straight leg.
    pub leg_length: f64,
    /// m, hip joint over the ground in the natural stand.
    pub hip_height: f64,
    /// m, ankle joint over the ground.
    pub ankle_height: f64,
    /// m, ankle to ankle in the natural stand.
    pub stance_width: f64,
    /// m, how far the centre of mass is ahead of the ankles' line in the natural stand.
    pub com_forward: f64,
    /// rad, outward turn of each foot in the natural stand.
    pub toe_out: f64,
    /// m, sole from the ankle along the foot: rearmost point (negative).
    pub heel: f64,
    /// m, foremost point.
    pub tip: f64,
    /// m, half of the sole's width.
    pub half_width: f64,
}

/// A foot set on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// m, the ground point under the ankle joint.
    pub ankle: DVec3,
    /// rad, where the foot points, about +Y from +Z towards +X (left).
    pub yaw: f64,
}

/// Why a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    /// To catch the fall.
    Corrective,
    /// The trailing foot comes after.
    FollowUp,
    /// Back into a comfortable stand.
    Comfort,
}

/// A step that was taken: exact times and places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Which foot.
    pub side: Side,
    /// Why.
    pub kind: StepKind,
    /// s, the sole leaves the ground.
    pub lift: f64,
    /// s, it is down again.
    pub land: f64,
    /// Where it stood.
    pub from: Plant,
    /// Where it landed.
    pub to: Plant,
}

/// The present position of the centre of mass over the ground, as (x, z).
pub fn ground(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}
