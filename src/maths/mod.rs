//! Mathematics that knows glam alone: no body, no rig, no file.

pub mod banded;
pub mod curve;
pub mod filter;
pub mod hull;
pub mod mirror;
pub mod pendulum;
pub mod quat;
pub mod real;
pub mod seed;
pub mod spring;
pub mod two_bone_ik;
