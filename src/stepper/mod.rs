//! The paper's low-dimensional controller: a point mass on springy legs with feet that hold an area, stepping to stay up.
//!
//! [`tick`] runs a tick: `control` (the order of things), `decide` (whether, which foot, when, where), `foothold` (the
//! paper's step length), `balance` (ankle feedback), `legs` (springs and flight), `rise` (the ground that they feel), `swing` (the
//! foot's way), `support` (the soles). All tuning is in [`Params`], all memory in [`State`]. [`catch`] says with which foot, where and when
//! a body that moves by its own torques catches a fall.
//!
//! Pure functions and plain state; no I/O, no allocation in a tick. Scenario space, SI units. Sources: Kenwright, "Watch
//! Your Step" (2013); the capture point of Koolen (2012) and the extrapolated centre of mass of Hof (2005).

mod ascend;
mod balance;
pub mod catch;
mod climb;
mod control;
mod decide;
mod descend;
pub mod follow;
mod footfall;
mod foothold;
pub mod footing;
mod gait;
mod grip;
mod halt;
mod haste;
mod kerb;
mod learned;
mod legs;
mod mesh;
mod pace;
pub mod params;
pub mod push_off;
mod rise;
mod roll;
mod stand;
pub mod state;
pub mod steep;
pub mod support;
mod swing;
mod turn;
pub mod walk;

pub use control::tick;
pub use params::{Params, Style};
pub use stand::OneFoot;
pub use state::{Inputs, Intent, Passing, State, Swing, TickOutput};
pub use support::Support;
pub use walk::{Gait, Phase};

pub use crate::model::{Physique, Plant};

use crate::model::Side;
use glam::{DVec2, DVec3};

/// Why a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepKind {
    /// To catch the fall.
    Corrective,
    /// One of the gait.
    Walk,
    /// The trailing foot comes after.
    FollowUp,
    /// Back into a comfortable stand.
    Comfort,
    /// Lifted and held in the air while the other foot carries, and set down where it stood.
    Held,
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
    /// Where it stood, in the ground frame (a platform's; scenario space else).
    pub from: Plant,
    /// Where it landed, likewise.
    pub to: Plant,
}

/// The present position of the centre of mass over the ground, as (x, z).
pub fn ground(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}
