//! Curves without a jump in their acceleration, level at both ends: what Blender's importer draws through a file's keys.
//!
//! It drops the tangents of CUBICSPLINE keys and solves for the slopes at which the acceleration goes on, the outermost level. Keys
//! that have these tangents are one curve to every reader. Where a curve has a corner, or an end that is not level, keys a
//! millisecond away round it: values and slopes are chosen so that the solution leads as the curve did from there on.

use super::key_times::NEAREST;
use crate::rig::animate::hermite;
use glam::DVec4;

/// s: keys around a corner stand that far from it.
const ROUND: f64 = 1.0e-3;
/// m or rad: so far, over six, may the round be off the corner.
const ROUNDED: f64 = 0.3e-3;

/// A key on the way to a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Knot {
    pub(crate) time: f64, // s
    pub(crate) value: DVec4,
    pub(crate) slopes: [DVec4; 2], // before and after, a second
    pub(crate) corner: bool,       // the acceleration jumps here, and the slope may
}

/// The piece between two knots.
struct Piece {
    from: Knot,
    to: Knot,
}

impl Piece {
    fn seconds(&self) -> f64 {
        self.to.time - self.from.time
    }

    /// s, how far from a corner at one of its ends its keys stand; `turned`: by how much the slope changes there, a second. `None` where
    /// keys would come too close to each other: there the corner stays one key.
    fn round(&self, turned: f64) -> Option<f64> {
        let most = self.seconds() / 6.0;
        (most >= NEAREST).then(|| (ROUNDED / turned.max(1e-9)).clamp(NEAREST, ROUND).min(most))
    }

    /// The same of two pieces at their common corner.
    fn round_between(&self, after: &Piece, turned: f64) -> Option<f64> {
        Some(self.round(turned)?.min(after.round(turned)?))
    }

    /// Value, slope and acceleration at a time.
    fn at(&self, time: f64) -> [DVec4; 3] {
        let (h, share) = (self.seconds(), (time - self.from.time) / self.seconds());
        let ends = [self.from.value, self.from.slopes[1], self.to.slopes[0], self.to.value];
        let [v0, m0, m1, v1] = ends;
        let secant = (v1 - v0) / h;
        let (bend, twist) = ((secant * 3.0 - m0 * 2.0 - m1) / h, (m0 + m1 - secant * 2.0) / (h * h));
        let t = share * h;
        [hermite(ends, h, share), m0 + bend * (2.0 * t) + twist * (3.0 * t * t), bend * 2.0 + twist * (6.0 * t)]
    }
}

/// The keys, level at both ends, of a curve that leads as these knots do: times, values, slopes. Of rotations the values are units;
/// of others one is `unit` m.
pub(crate) fn level(knots: &[Knot], rotates: bool, unit: f64) -> (Vec<f32>, Vec<DVec4>, Vec<DVec4>) {
    piece(knots, rotates, unit, [true; 2])
}

/// The same of a piece of a curve: where the curve itself does not end, the outermost knot keeps its slope.
pub(crate) fn piece(knots: &[Knot], rotates: bool, unit: f64, ends: [bool; 2]) -> (Vec<f32>, Vec<DVec4>, Vec<DVec4>) {
    let stored = |value: DVec4| {
        let value = if rotates { value.try_normalize().unwrap_or(DVec4::W) } else { value };
        DVec4::from_array(value.to_array().map(|part| f64::from(part as f32)))
    };
    let mut keys: Vec<(f32, DVec4)> = Vec::with_capacity(knots.len() + 8);
    let mut add = |time: f32, value: DVec4| keys.push((time, stored(value)));
    let last = knots.len().saturating_sub(1);
    for (at, knot) in knots.iter().enumerate() {
        let before = at.checked_sub(1).map(|before| Piece { from: knots[before], to: *knot });
        let after = knots.get(at + 1).map(|after| Piece { from: *knot, to: *after });
        let here = knot.time as f32;
        match (before, after) {
            (None, Some(piece)) if ends[0] && knot.slopes[1] != DVec4::ZERO => {
                add(here, knot.value);
                let Some(round) = piece.round(knot.slopes[1].length() * unit) else { continue };
                let times = [1.0, 2.0].map(|steps| (knot.time + steps * round) as f32);
                let [end, slope, bend] = piece.at(f64::from(times[1]));
                let steps = [times[0] - here, times[1] - times[0]].map(f64::from);
                add(times[0], knot.value + led(end - knot.value, slope, bend, steps));
                add(times[1], end);
            }
            (Some(piece), None) if ends[1] && at == last && knot.slopes[0] != DVec4::ZERO => {
                let Some(round) = piece.round(knot.slopes[0].length() * unit) else {
                    add(here, knot.value);
                    continue;
                };
                let times = [2.0, 1.0].map(|steps| (knot.time - steps * round) as f32);
                let [start, slope, bend] = piece.at(f64::from(times[0]));
                add(times[0], start);
                let steps = [here - times[1], times[1] - times[0]].map(f64::from);
                add(times[1], knot.value + led(start - knot.value, -slope, bend, steps));
                add(here, knot.value);
            }
            (Some(before), Some(after)) if knot.corner => {
                let turned = knot.slopes[0].distance(knot.slopes[1]) * unit;
                let Some(round) = before.round_between(&after, turned) else {
                    add(here, knot.value);
                    continue;
                };
                let times = [-round, round].map(|step| (knot.time + step) as f32);
                let [start, left, bend_left] = before.at(f64::from(times[0]));
                let [end, right, bend_right] = after.at(f64::from(times[1]));
                // Slopes and accelerations from either side, one acceleration in the middle: its slope, and then the secants.
                let steps = [here - times[0], times[1] - here].map(f64::from);
                let middle = (left / steps[0] + right / steps[1] + (bend_left - bend_right) * 0.5)
                    / (1.0 / steps[0] + 1.0 / steps[1]);
                let secants = [
                    (left * 4.0 + middle * 2.0 + bend_left * steps[0]) / 6.0,
                    (right * 4.0 + middle * 2.0 - bend_right * steps[1]) / 6.0,
                ];
                add(times[0], start);
                add(here, (start + secants[0] * steps[0] + end - secants[1] * steps[1]) * 0.5);
                add(times[1], end);
            }
            _ => add(here, knot.value),
        }
    }
    let clock: Vec<f64> = keys.iter().map(|(time, _)| f64::from(*time)).collect();
    let (times, values): (Vec<f32>, Vec<DVec4>) = keys.into_iter().unzip();
    let held =
        |knot: Option<&Knot>, end: usize| knot.filter(|_| !ends[end]).map_or(DVec4::ZERO, |knot| knot.slopes[1 - end]);
    let slopes = slopes(&clock, &values, [held(knots.first(), 0), held(knots.last(), 1)]);
    (times, values, slopes)
}

/// How far a curve gets on the first of two steps (s) that lead from level to a slope, an acceleration and `way`.
fn led(way: DVec4, slope: DVec4, bend: DVec4, [a, b]: [f64; 2]) -> DVec4 {
    let pull = (way * 6.0 - slope * (4.0 * b) + bend * (b * b)) / (a * a) + slope * (2.0 / b) - bend;
    let middle = pull / (4.0 / a + 2.0 * b / (a * a) + 2.0 / b);
    way - (middle * 2.0 + slope * 4.0 - bend * b) * (b / 6.0)
}

/// The slopes (a second) at `times` (s, rising) of the cubic spline through `values`, `ends` the first's and the last's.
pub(crate) fn slopes(times: &[f64], values: &[DVec4], ends: [DVec4; 2]) -> Vec<DVec4> {
    let count = times.len().min(values.len());
    let mut slopes = vec![ends[0]; count];
    let Some(last) = count.checked_sub(1).filter(|last| *last > 0) else { return slopes };
    slopes[last] = ends[1];
    // m[i-1] / before + 2 (1 / before + 1 / after) m[i] + m[i+1] / after = 3 (secant before / before + secant after / after)
    let mut above = vec![0.0; count]; // what is left of the row's last entry, forwards
    for at in 1..last {
        let [before, after] = [times[at] - times[at - 1], times[at + 1] - times[at]];
        let secants =
            (values[at] - values[at - 1]) / (before * before) + (values[at + 1] - values[at]) / (after * after);
        let pivot = 2.0 / before + 2.0 / after - above[at - 1] / before;
        above[at] = 1.0 / (after * pivot);
        slopes[at] = (secants * 3.0 - slopes[at - 1] / before) / pivot;
    }
    for at in (1..last).rev() {
        slopes[at] = slopes[at] - slopes[at + 1] * above[at];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_ends_that_are_not_level_are_rounded_within_milliseconds() {
        // Up at 2 m/s, from 0.4 s down at 1 m/s: bent as a cubic bends, and everything is met but for 3 ms around.
        let knot = |time: f64, value: f64, slopes: [f64; 2], corner| Knot {
            time,
            value: DVec4::splat(value),
            slopes: slopes.map(DVec4::splat),
            corner,
        };
        let knots =
            [knot(0.0, 0.0, [2.0; 2], false), knot(0.4, 0.7, [1.5, -1.0], true), knot(1.0, 0.2, [-0.5; 2], false)];
        let (times, values, slopes) = level(&knots, false, 1.0);
        assert_eq!(times.len(), 9);
        assert_eq!(
            (slopes[0], slopes[8], values[0], values[8].x),
            (DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, 0.2_f32.into())
        );
        let pieces = [Piece { from: knots[0], to: knots[1] }, Piece { from: knots[1], to: knots[2] }];
        let (mut near, mut far): (f64, f64) = (0.0, 0.0);
        for tick in 0..10_000 {
            let time = f64::from(tick) * 1e-4;
            let wanted = pieces[usize::from(time > 0.4)].at(time)[0].x;
            let at = times.partition_point(|key| f64::from(*key) <= time) - 1;
            let seconds = f64::from(times[at + 1]) - f64::from(times[at]);
            let share = (time - f64::from(times[at])) / seconds;
            let off =
                (hermite([values[at], slopes[at], slopes[at + 1], values[at + 1]], seconds, share).x - wanted).abs();
            let rounded = [0.0, 0.4, 1.0].iter().any(|corner: &f64| (time - corner).abs() < 2.1e-3);
            if rounded { near = near.max(off) } else { far = far.max(off) }
        }
        assert!(far < 2e-5 && near < 0.5e-3, "{far} {near}");
        // The planted extreme: the corner as one key leads astray for long.
        let plain = knots.map(|knot| Knot { corner: false, ..knot });
        assert_eq!(level(&plain, false, 1.0).0.len(), 7);
    }

    #[test]
    fn a_cubic_is_met_everywhere_and_the_acceleration_does_not_jump_elsewhere() {
        let times = [0.0, 0.1, 0.4, 0.5, 1.1];
        let cubic = |t: f64| DVec4::new(t * t * t - t, 2.0 * t, 1.0, -t * t);
        let slope = |t: f64| DVec4::new(3.0 * t * t - 1.0, 2.0, 0.0, -2.0 * t);
        let values = times.map(cubic);
        let found = slopes(&times, &values, [slope(0.0), slope(1.1)]);
        for (time, found) in times.iter().zip(&found) {
            assert!(found.distance(slope(*time)) < 1e-12, "{time}: {found}");
        }
        let values = [0.0, 1.0, -1.0, 0.5, 0.0].map(DVec4::splat);
        let found = slopes(&times, &values, [DVec4::ZERO; 2]);
        let bend = |from: usize, share: f64| {
            let seconds = times[from + 1] - times[from];
            let at =
                |share: f64| hermite([values[from], found[from], found[from + 1], values[from + 1]], seconds, share).x;
            (at(share - 0.01) - 2.0 * at(share) + at(share + 0.01)) / (0.01 * seconds).powi(2)
        };
        // A cubic's second difference is its acceleration there: from both sides, led on to the key.
        let led = |from: usize, to: f64| bend(from, 0.5) + (bend(from, 0.75) - bend(from, 0.25)) * (to - 0.5) * 2.0;
        for key in 1..4 {
            let (before, after) = (led(key - 1, 1.0), led(key, 0.0));
            assert!((before - after).abs() < 1e-6 * before.abs().max(1.0), "{key}: {before} {after}");
        }
    }
}
