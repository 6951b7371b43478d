//! The articulated body: rigid links, joint torques, contacts.

mod bulk;
pub mod control;
pub mod crouch;
pub mod dynamics;
pub mod fall;
mod felt;
pub mod figure;
mod forces;
mod ground;
pub mod guide;
mod help;
mod joints;
mod kerb;
mod knee;
mod linear;
mod lying;
mod ranges;
mod reach;
pub mod slope;
mod sole;
pub mod stance;
mod stepping;
mod swing;
mod tasks;
pub mod things;
mod toes;
mod touches;
pub mod tuning;
pub mod world;

pub use control::Controller;
pub use figure::{Figure, Locks};
pub use guide::{Guide, Wish};
pub use stance::Stance;
pub use tuning::Tuning;
pub use world::{LinkState, World};

use glam::{DQuat, DVec2, DVec3};

/// (x, z).
fn flat(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}

/// The rotation vector by the short way, rad.
fn short(turn: DQuat) -> DVec3 {
    if turn.w < 0.0 { (-turn).to_scaled_axis() } else { turn.to_scaled_axis() }
}
