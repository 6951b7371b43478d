//! What steep ground asks of the body over the feet, beside where the feet stand: trunks lean into a slope, and over ground that slants
//! sideways knees bend, so that they can turn downhill and bring the shanks nearer to square on it. Radians, metres, seconds.

use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::Physique;
use crate::sim::{TickState, Trace};
use crate::whole_body::reaction::UpperAngles;
use glam::DVec3;

/// rad, grade up to which a trunk leans as every walker's does.
const STEEP: f64 = 0.2;
/// rad of lean for each of grade beyond that: with the rest 26 degrees up a slope of 25, where people's hips stay behind their feet.
const LEAN: f64 = 1.0;
/// Of that lean, what the pelvis takes beyond its share.
const PELVIS: f64 = 0.3;
/// rad, sideways slants at which knees begin to bend for them, and bend no more.
const SLANTS: [f64; 2] = [0.15, 0.5];
/// Part of the leg by which they lower the body then: knees at 60 to 70 degrees, which turn a shank by 25.
const LOWER: f64 = 0.15;
/// Leg over foot: where it is less than the first, a knee that bends on ground that slants by more than [`STEEPER`] (rad) comes to lie on
/// that ground; people's is over 3.
const LONG: [f64; 2] = [2.4, 3.0];
/// rad.
const STEEPER: [f64; 2] = [0.5, 0.7];
/// s, standard deviation of the smoothing of either.
const SMOOTHING: f64 = 0.2;

/// rad, how steeply the ground under the feet rises ahead and to the left, smooth in time: an entry a tick.
pub(super) fn slants(ticks: &[TickState], dt: f64) -> Vec<[f64; 2]> {
    let raw = ticks.iter().map(|tick| {
        let normal = (tick.feet[0].normal + tick.feet[1].normal).normalize_or(DVec3::Y);
        let (sin, cos) = real::sin_cos(tick.facing);
        [DVec3::new(sin, 0.0, cos), DVec3::new(cos, 0.0, -sin)].map(|way| real::atan2(-normal.dot(way), normal.y))
    });
    let raw: Vec<[f64; 2]> = raw.collect();
    if raw.iter().all(|slant| *slant == [0.0; 2]) {
        return raw;
    }
    let reach = (3.0 * SMOOTHING / dt).ceil() as isize;
    let weights: Vec<f64> =
        (-reach..=reach).map(|off| real::exp(-0.5 * (off as f64 * dt / SMOOTHING).powi(2))).collect();
    let total: f64 = weights.iter().sum();
    let last = raw.len() as isize - 1;
    let at = |index: isize, axis: usize| {
        let near = (-reach..=reach).zip(&weights);
        near.map(|(off, weight)| weight * raw[(index + off).clamp(0, last) as usize][axis]).sum::<f64>() / total
    };
    (0..=last).map(|index| [at(index, 0), at(index, 1)]).collect()
}

/// Leans trunks into steep slopes.
pub(super) fn lean(upper: &mut [UpperAngles], slants: &[[f64; 2]]) {
    for (angles, [grade, _]) in upper.iter_mut().zip(slants) {
        let lean = LEAN * (grade - STEEP).max(0.0);
        angles[1] += lean;
        angles[17] += PELVIS * lean;
    }
}

/// m, by how much the body is lower over ground that slants sideways.
pub(super) fn lower(slant: &[f64; 2], physique: &Physique) -> f64 {
    let over = |[from, to]: [f64; 2], value: f64| smooth3((value - from) / (to - from));
    let sideways = slant[1].abs();
    let room = 1.0 - over(STEEPER, sideways) * (1.0 - over(LONG, physique.leg_length / (physique.tip - physique.heel)));
    LOWER * room * physique.leg_length * over(SLANTS, sideways)
}

/// m, the most that a run's body is lower for it.
pub(super) fn lowest(trace: &Trace, physique: &Physique) -> f64 {
    slants(&trace.ticks, trace.dt).iter().map(|slant| lower(slant, physique)).fold(0.0, f64::max)
}
