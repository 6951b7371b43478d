//! Mathematics that knows glam alone: no body, no rig, no file.

pub mod banded;
pub mod curve;
pub mod filter;
pub mod hull;
pub mod pendulum;
pub mod quat;
pub mod seed;
pub mod spring;
pub mod two_bone_ik;

/// TEMPORARY.
pub fn knob(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}
