//! The joints of a body that falls: dampers, and a muscle tone that wanes. Scenario space, SI.
//!
//! No balance any more: what is left is to come down. Joints stop at the ends of their ranges as they always do (`ranges`).

use super::figure::{Figure, Freedom, Part};
use super::short;
use super::toes;
use super::world::{LinkState, World};
use crate::maths::real;
use glam::DVec3;

/// rad/s, natural frequency of the tone when balance is lost and later, and how fast it goes over (s).
const TONE: [f64; 2] = [7.0, 1.5];
const WANES: f64 = 0.35;
/// rad/s, what the dampers are tuned to: critical for that frequency.
const DAMPED: f64 = 6.0;

/// Lets the joints be those of a body that has fallen for `passed` s, for the coming tick.
pub fn relax(figure: &Figure, world: &mut World, states: &[LinkState], passed: f64) {
    let tone = TONE[1] + (TONE[0] - TONE[1]) * real::exp(-passed / WANES);
    toes::drive(figure, world, states, &[toes::Asked::default(); 2]);
    for (index, link) in figure.links.iter().enumerate().skip(1) {
        if let Part::Toes(_) = link.part {
            continue;
        }
        let parent = link.parent.unwrap_or(0);
        let turned = short(states[parent].turn.inverse() * states[index].turn);
        let stiffness = DVec3::splat(link.carried * tone * tone);
        let damping = DVec3::splat(2.0 * link.carried * DAMPED);
        let ahead = match link.freedom {
            Freedom::Hinge { axis, .. } => axis * (bent(link.part) - turned.dot(axis)),
            _ => wanted(link.part) - turned,
        };
        world.drive(index, stiffness, damping, ahead);
    }
}

/// rad, what the tone draws a ball joint to.
fn wanted(part: Part) -> DVec3 {
    match part {
        Part::Trunk => DVec3::new(0.35, 0.0, 0.0),
        Part::Head => DVec3::new(0.3, 0.0, 0.0),
        Part::UpperArm(side) => DVec3::new(-0.6, 0.0, 0.35 * side.sign()),
        Part::Thigh(side) => DVec3::new(-0.5, 0.0, 0.08 * side.sign()),
        Part::Foot(_) => DVec3::new(0.25, 0.0, 0.0),
        _ => DVec3::ZERO,
    }
}

/// rad, and a hinge, from the stand.
fn bent(part: Part) -> f64 {
    match part {
        Part::Shank(_) => 0.7,
        Part::Toes(_) => 0.0,
        _ => 0.6,
    }
}
