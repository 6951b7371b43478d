//! Trunks that lean into steep ground, and how steeply it rises under the feet. Radians, seconds.

use crate::maths::{filter, real};
use crate::sim::TickState;
use crate::whole_body::reaction::UpperAngles;
use glam::DVec3;

/// rad, grade up to which a trunk leans as every walker's does.
const STEEP: f64 = 0.2;
/// rad of lean for each of grade beyond that: with the rest 26 degrees up a slope of 25, where people's hips stay behind their feet.
const LEAN: f64 = 1.0;
/// Of that lean, what the pelvis takes beyond its share.
const PELVIS: f64 = 0.3;
/// Hz, where the smoothing of a grade is 3 dB down: a trunk takes about half a second for a new one.
const SMOOTHING: f64 = 0.7;

/// rad, how steeply the ground under the feet rises ahead, smooth in time: an entry a tick.
pub(super) fn grades(ticks: &[TickState], dt: f64) -> Vec<f64> {
    let raw = ticks.iter().map(|tick| {
        let normal = (tick.feet[0].normal + tick.feet[1].normal).normalize_or(DVec3::Y);
        let (sin, cos) = real::sin_cos(tick.facing);
        real::atan2(-normal.dot(DVec3::new(sin, 0.0, cos)), normal.y)
    });
    let raw: Vec<f64> = raw.collect();
    if raw.iter().all(|grade| *grade == 0.0) {
        return raw;
    }
    filter::zero_lag(&raw, SMOOTHING, 1.0 / dt)
}

/// Leans trunks into steep slopes.
pub(super) fn lean(upper: &mut [UpperAngles], grades: &[f64]) {
    for (angles, grade) in upper.iter_mut().zip(grades) {
        let lean = LEAN * (grade - STEEP).max(0.0);
        angles[1] += lean;
        angles[17] += PELVIS * lean;
    }
}
