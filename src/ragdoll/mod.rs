//! The articulated body: rigid links, joint torques, contacts.

pub mod control;
pub mod dynamics;
pub mod figure;
mod forces;
mod ground;
mod linear;
pub mod plan;
mod swing;
pub mod world;

pub use control::{Controller, Tuning};
pub use figure::{Figure, Locks};
pub use world::{LinkState, World};
