//! The joints of a body that falls: dampers, a muscle tone that wanes, and soft stops at the ends of their ranges.
//!
//! Scenario space, SI. No balance any more: what is left is to come down without a limb turned the wrong way. Hinges have
//! the engine's own stops; ball joints get a stiff spring back per axis of the rotation vector from the stand, which is good
//! to about two radians. The numbers are ranges of people rounded, wider where a fall forces them.

use super::figure::{Figure, Freedom, Part};
use super::short;
use super::world::{LinkState, World};
use glam::DVec3;

/// rad/s, natural frequency of the tone when balance is lost and later, and how fast it goes over (s).
const TONE: [f64; 2] = [7.0, 1.5];
const WANES: f64 = 0.35;
/// rad/s, what the dampers are tuned to: critical for that frequency.
const DAMPED: f64 = 6.0;
/// rad/s, of the stops.
const STOP: f64 = 22.0;

/// Lets the joints be those of a body that has fallen for `passed` s, for the coming tick.
pub fn relax(figure: &Figure, world: &mut World, states: &[LinkState], passed: f64) {
    let tone = TONE[1] + (TONE[0] - TONE[1]) * (-passed / WANES).exp();
    for (index, link) in figure.links.iter().enumerate().skip(1) {
        let parent = link.parent.unwrap_or(0);
        let turned = short(states[parent].turn.inverse() * states[index].turn);
        let soft = link.carried * tone * tone;
        let damping = DVec3::splat(2.0 * link.carried * DAMPED);
        let mut ahead = wanted(link.part) - turned;
        let mut stiffness = DVec3::splat(soft);
        let mut damping = damping;
        if let Freedom::Hinge { axis, .. } = link.freedom {
            ahead = axis * (bent(link.part) - turned.dot(axis));
        } else {
            let [low, high] = range(link.part);
            for axis in 0..3 {
                let inside = turned[axis].clamp(low[axis], high[axis]);
                if inside != turned[axis] {
                    ahead[axis] = inside - turned[axis];
                    stiffness[axis] = link.carried * STOP * STOP;
                    damping[axis] = 2.0 * link.carried * STOP;
                }
            }
        }
        world.loosen(figure, index, stiffness, damping, ahead);
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
        _ => 0.6,
    }
}

/// rad, least and most about x, y, z of the parent, from the stand.
fn range(part: Part) -> [DVec3; 2] {
    // Outward of a left limb is about +z.
    let sided = |low: DVec3, high: DVec3, left: bool| {
        if left { [low, high] } else { [DVec3::new(low.x, -high.y, -high.z), DVec3::new(high.x, -low.y, -low.z)] }
    };
    let both = |x: [f64; 2], y: f64, z: f64| [DVec3::new(x[0], -y, -z), DVec3::new(x[1], y, z)];
    match part {
        Part::Pelvis => both([-9.0, 9.0], 9.0, 9.0),
        Part::Trunk => both([-0.35, 0.9], 0.5, 0.45),
        Part::Head => both([-0.7, 0.7], 1.0, 0.5),
        Part::UpperArm(side) => sided(DVec3::new(-2.6, -1.0, -0.2), DVec3::new(0.7, 1.0, 2.3), side.sign() > 0.0),
        Part::Forearm(_) | Part::Shank(_) => both([-9.0, 9.0], 9.0, 9.0),
        Part::Hand(_) => both([-0.8, 0.8], 0.05, 0.5),
        Part::Thigh(side) => sided(DVec3::new(-1.9, -0.6, -0.25), DVec3::new(0.3, 0.6, 0.7), side.sign() > 0.0),
        Part::Foot(_) => both([-0.4, 0.7], 0.06, 0.3),
    }
}
