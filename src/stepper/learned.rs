//! What a body's own steps teach the plan: how its landings differ from those that were planned.
//!
//! A body of links does what it is told late and not in full. What its last steps were found to be too long, too wide or short of is taken
//! off the next ones, each time by a part of it. Ground plane (x, z), SI units.

use super::gait::Rhythm;
use super::{Params, Physique, State, footfall, ground, pace, rise, walk};
use crate::maths::real;
use crate::model::Side;
use glam::DVec2;

/// What a landing counts for the mean of the last ones, and for how much nearer feet land: with 0.25 there too, 21 of 288 drawn walks are too wide
/// for good after a shove aside, not 7; with 0.55 one is, and more of them halt.
const REMEMBERS: f64 = 0.25;
const NARROWS: f64 = 0.4;
/// m at legs of 0.83 m, at most so much of what makes a step unlike the last ones is taken for unevenness: more is a shove's.
const UNEVEN: f64 = 0.1;

/// m at legs of 0.83 m, so much wider than planned steps may be, and at most so much nearer to ξ feet land for it. As narrow as planned
/// they leave the zero-moment point 2 cm outside them at 1.2 m/s.
const BROADER: f64 = 0.02;
const NEARER: f64 = 0.04;
/// m there, what a walk on level ground begins with: what brisk ones come to. From none on, the first steps of one of 0.9 m/s are 0.23 m wide
/// and the tenth 0.14 m. On ground that leans legs come too near to each other with it.
const BEGINS: f64 = 0.015;
/// m/s there, from which on and from which on in full that is so: slower ones are as wide as planned without it.
const BRISK: [f64; 2] = [0.5, 0.8];
/// m/s at legs of 0.83 m, slower walks keep their feet as wide as they find them.
const UNHURRIED: f64 = 0.4;

/// m/s at legs of 0.83 m, what is asked of the plan, from which on and from which on in full it is learned how far ξ falls short at landings;
/// m there, the most of it. From 1.5 on short legs drag their toes at 1.33 m/s; from 0.7 on, of 256 walks of 1.2 m/s 13 fall of the shoves of
/// which 8 do otherwise; with 0.09 m two of 40 drawn walks of 1.5 to 1.8 m/s fall.
const SHORT: [f64; 2] = [1.6, 1.8];
const SHORTEST: f64 = 0.06;

/// What is remembered of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Learned {
    /// m, by how much steps are longer than planned, in the mean of the last ones.
    longer: f64,
    /// m, how much nearer to ξ feet are to land for steps to be as wide as planned; `None` before that was seen.
    nearer: Option<f64>,
    /// m, along the way, by how much ξ falls short at landings of where it is foreseen.
    pub(super) short: f64,
}

/// What is remembered after a step of `side` from one foothold to the other has landed.
pub fn landed(params: &Params, physique: &Physique, state: &State, side: Side) -> Learned {
    let rhythm = walk::rhythm_now(params, physique, state);
    let feet = [side.other(), side].map(|side| ground(state.feet[side as usize].ankle));
    let way = state.gait.velocity.normalize_or(state.ahead);
    let apart = feet[1] - feet[0] - pace::aimed(state) * rhythm.step;
    let longer = state.gait.learned.longer;
    Learned {
        longer: longer + REMEMBERS * (apart.dot(way) - longer),
        nearer: narrowed(params, physique, state, &rhythm, (side, apart)),
        short: short(params, physique, state, &rhythm, (side, feet), way),
    }
}

/// The landing, with less of what makes its step unlike the last ones: what a body does of a plan comes late, and steps that each make up
/// for the one before in full turn long and short by turns.
pub(super) fn evened(
    params: &Params,
    state: &State,
    (rear, ankle): (DVec2, DVec2),
    stride: DVec2,
    way: DVec2,
) -> DVec2 {
    let most = UNEVEN * params.size;
    let unlike = (ankle - rear - stride).dot(way) - state.gait.learned.longer;
    ankle - way * (unlike.clamp(-most, most) * (1.0 - params.even))
}

/// m, how much nearer to ξ feet are to land than planned.
pub(super) fn nearer(params: &Params, state: &State) -> f64 {
    if !narrows(params, state) {
        return 0.0;
    }
    let pace = state.gait.velocity.length() * params.tempo / params.size;
    let brisk = ((pace - BRISK[0]) / (BRISK[1] - BRISK[0])).clamp(0.0, 1.0);
    let begins = if rise::on_level(state) { BEGINS * params.size * brisk } else { 0.0 };
    state.gait.learned.nearer.unwrap_or(begins)
}

/// Does the plan see to it how wide its steps are?
fn narrows(params: &Params, state: &State) -> bool {
    let slow = state.gait.velocity.length() < UNHURRIED * params.size / params.tempo;
    params.even < 1.0 && params.rolls && !slow && state.gait.longest.is_infinite()
}

/// [`nearer`] after a step of `side` has landed `apart` (m, x and z) from the other foot, less the way that was gone in it.
/// In a steady gait a foot that lands d m beside ξ is
/// d (1 + e^ωT) m beside the other one, so what steps are wider than planned is taken off that d. A body's feet come down before ξ is where
/// it was foreseen: without this its steps are wider by 0.1 m, and after a shove by 0.3 m for good.
fn narrowed(
    params: &Params,
    physique: &Physique,
    state: &State,
    rhythm: &Rhythm,
    (side, apart): (Side, DVec2),
) -> Option<f64> {
    if !narrows(params, state) {
        return None;
    }
    let beside = apart.dot(state.aside()) * side.sign();
    let grows = 1.0 + real::exp(walk::omega(params, physique) * rhythm.step);
    let (most, bound) = (UNEVEN * params.size, NEARER * params.size);
    let wider = (beside - rhythm.width - BROADER * params.size).clamp(-most, most);
    Some((nearer(params, state) + NARROWS * wider / grows).clamp(0.0, bound))
}

/// m, along the way, by how much ξ fell short at the last landings, of `side` now: feet come down early and take speed. Where ξ is foreseen
/// farther ahead than it gets, feet land too far ahead of it, and each step brakes: without this walks of 1.58 m/s are 6 to 7 % too slow.
fn short(
    params: &Params,
    physique: &Physique,
    state: &State,
    rhythm: &Rhythm,
    (side, [stands, landed]): (Side, [DVec2; 2]),
    way: DVec2,
) -> f64 {
    let gait = &state.gait;
    if params.even >= 1.0 || !params.rolls || gait.longest.is_finite() {
        return 0.0;
    }
    let pace = gait.velocity.length() * params.tempo / params.size;
    let share = ((pace - SHORT[0]) / (SHORT[1] - SHORT[0])).clamp(0.0, 1.0);
    let suits = footfall::pivot(params, physique, state, rhythm, side, 0.0).xi_for(stands, landed);
    let most = UNEVEN * params.size;
    let lacks = (suits - state.xi()).dot(way).clamp(-most, most);
    (gait.learned.short + REMEMBERS * lacks).clamp(0.0, SHORTEST * params.size * share)
}
