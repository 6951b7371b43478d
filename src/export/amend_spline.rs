//! A spline with other keys in spans of frames: one curve to readers of its tangents and to those that draw their own.
//!
//! Document units. Blender's importer drops tangents and lets the acceleration go on at every key (see `bake/spline.rs`), so a change
//! would bend the curve beside it too. Here each span hangs between two corners, milliseconds within the frames beside it; the old keys
//! beyond keep their values and tangents, and what lies between is drawn as the importer draws it.

use crate::bake::spline::{Knot, piece, slopes};
use crate::rig::clips::{Join, RawKeys};
use glam::DVec4;
use std::collections::BTreeMap;
use std::ops::Range;

/// s: a corner stands that far within the frame beside a span, and from any old key.
const GAP: f64 = 2.0e-3;
/// Of the time between two frames: and no farther.
const SHARE: f64 = 1.0 / 3.0;

/// A knot of the new curve.
struct Place {
    knot: Knot,
    /// Index of the old key that it is.
    kept: Option<usize>,
}

/// A spline's old keys with those frames in it; `None` where old keys leave no room for corners. `sample` and `slope` (a second) are the
/// old curve's.
pub(super) fn amended(
    old: &RawKeys,
    frames: &BTreeMap<usize, DVec4>,
    time: &dyn Fn(usize) -> f64,
    sample: &dyn Fn(f64) -> DVec4,
    slope: &dyn Fn(f64) -> DVec4,
    rotates: bool,
) -> Option<RawKeys> {
    let spans = super::amend::spans(frames);
    let mut places: Vec<Place> = Vec::new();
    let mut changed: Vec<Range<f64>> = Vec::new();
    for (from, to) in spans {
        let corners = corners(old, from, to, time)?;
        let mut knots: Vec<(f64, DVec4)> = Vec::new();
        knots.extend(corners[0].map(|at| (at, sample(at))));
        for (frame, value) in frames.range(from..=to) {
            let near = knots.last().map_or_else(|| sample(time(*frame)), |last| last.1);
            let flipped = rotates && near.dot(*value) < 0.0;
            knots.push((time(*frame), if flipped { -*value } else { *value }));
        }
        if let Some(at) = corners[1] {
            let value = sample(at);
            let flipped = rotates && knots.last().is_some_and(|last| last.1.dot(value) < 0.0);
            // The way round would have to be undone beyond the span.
            if flipped {
                return None;
            }
            knots.push((at, value));
        }
        let (clock, values): (Vec<f64>, Vec<DVec4>) = knots.iter().copied().unzip();
        let secant = |a: usize, b: usize| (values[b] - values[a]) / (clock[b] - clock[a]).max(1e-9);
        let last = knots.len() - 1;
        let ends = [
            corners[0].map_or_else(|| secant(0, last.min(1)), slope),
            corners[1].map_or_else(|| secant(last.saturating_sub(1), last), slope),
        ];
        let bent = slopes(&clock, &values, ends);
        for (at, (seconds, value)) in knots.into_iter().enumerate() {
            let corner = corners.contains(&Some(seconds));
            places.push(Place { knot: Knot { time: seconds, value, slopes: [bent[at]; 2], corner }, kept: None });
        }
        changed.push(corners[0].unwrap_or(f64::MIN)..corners[1].unwrap_or(f64::MAX));
    }
    for (index, at) in old.times.iter().enumerate() {
        let seconds = f64::from(*at);
        if !changed.iter().any(|span| span.contains(&seconds)) {
            let [before, value, after] = parts(&old.numbers[index]);
            let knot = Knot { time: seconds, value, slopes: [before, after], corner: false };
            places.push(Place { knot, kept: Some(index) });
        }
    }
    places.sort_by(|a, b| a.knot.time.total_cmp(&b.knot.time));
    Some(keys(old, &places, slope, if rotates { 4 } else { 3 }))
}

/// s: where the corners of a span stand; none where the curve ends with it. `None` where there is no room.
fn corners(old: &RawKeys, from: usize, to: usize, time: &dyn Fn(usize) -> f64) -> Option<[Option<f64>; 2]> {
    let step = time(from + 1) - time(from);
    let gap = GAP.min(SHARE * step);
    let keys = || old.times.iter().map(|at| f64::from(*at));
    let before = from.checked_sub(1).map(|edge| {
        let free = |at: f64, key: f64| if (key - at).abs() < gap - 1e-6 { key + gap } else { at };
        keys().fold(time(edge) + gap, free)
    });
    let last = keys().next_back().unwrap_or(f64::MIN);
    let after = (last > time(to) + 1e-4).then(|| {
        let free = |at: f64, key: f64| if (key - at).abs() < gap - 1e-6 { key - gap } else { at };
        keys().rev().fold(time(to + 1) - gap, free)
    });
    let room =
        before.is_none_or(|at| at < time(from) - 0.25 * step) && after.is_none_or(|at| at > time(to) + 0.25 * step);
    room.then_some([before, after])
}

/// The keys of those places: old ones as they were, the others as the pieces between them are drawn.
fn keys(old: &RawKeys, places: &[Place], slope: &dyn Fn(f64) -> DVec4, width: usize) -> RawKeys {
    let mut made = RawKeys { times: Vec::new(), numbers: Vec::new(), join: Join::CubicSpline };
    let keep = |made: &mut RawKeys, index: usize| {
        made.times.push(old.times[index]);
        made.numbers.push(old.numbers[index].clone());
    };
    let mut at = 0;
    while at < places.len() {
        if let Some(index) = places[at].kept {
            keep(&mut made, index);
            at += 1;
            continue;
        }
        let end = (at..places.len()).find(|end| places[*end].kept.is_some()).unwrap_or(places.len());
        let run = at.saturating_sub(1)..(end + 1).min(places.len());
        let knots: Vec<Knot> = places[run].iter().map(|place| place.knot).collect();
        let (first, last) = (at == 0, end == places.len());
        let (times, values, slopes) = piece(&knots, width == 4, 1.0, [first, last]);
        let (from, to) = (usize::from(!first), times.len() - usize::from(!last));
        for key in from..to {
            let mut tangents = [slopes[key]; 2];
            // Towards old keys the old curve's own.
            if key == from && !first {
                tangents[0] = slope(f64::from(times[key]));
            }
            if key + 1 == to && !last {
                tangents[1] = slope(f64::from(times[key]));
            }
            if made.times.last().is_none_or(|last| *last < times[key]) {
                made.times.push(times[key]);
                let numbers = [tangents[0], values[key], tangents[1]];
                made.numbers.push(
                    numbers.iter().flat_map(|part| part.to_array()[..width].to_vec()).map(|part| part as f32).collect(),
                );
            }
        }
        at = end;
    }
    made
}

/// In-tangent, value and out-tangent of a key.
fn parts(numbers: &[f32]) -> [DVec4; 3] {
    let width = numbers.len() / 3;
    [0, 1, 2].map(|part| {
        let mut parts = [0.0; 4];
        for (to, from) in parts.iter_mut().zip(&numbers[part * width..(part + 1) * width]) {
            *to = f64::from(*from);
        }
        DVec4::from_array(parts)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::spline::level;
    use crate::maths::real;
    use crate::rig::animate::hermite;

    /// x over time: keys, and slopes of one's own.
    fn x(times: &[f64], values: &[DVec4], slopes: &[DVec4], at: f64) -> f64 {
        let after = times.partition_point(|key| *key <= at).clamp(1, times.len() - 1);
        let seconds = times[after] - times[after - 1];
        let share = ((at - times[after - 1]) / seconds).clamp(0.0, 1.0);
        hermite([values[after - 1], slopes[after - 1], slopes[after], values[after]], seconds, share).x
    }

    #[test]
    fn readers_that_draw_their_own_slopes_see_the_old_curve_outside_and_the_frames_inside() {
        let waves = |at: f64| 0.3 * real::sin(3.0 * at);
        let knots: Vec<Knot> = (0..=12)
            .map(|key| {
                let (time, bent) = (0.2 * f64::from(key), 0.9 * real::cos(0.6 * f64::from(key)));
                let slopes = [DVec4::X * bent; 2];
                Knot { time, value: DVec4::X * waves(time), slopes, corner: false }
            })
            .collect();
        let (times, values, slopes_of) = level(&knots, false, 1.0);
        let numbers = |at: usize| -> Vec<f32> {
            [slopes_of[at], values[at], slopes_of[at]]
                .iter()
                .flat_map(|part| part.to_array()[..3].to_vec())
                .map(|part| part as f32)
                .collect()
        };
        let old = RawKeys { numbers: (0..times.len()).map(numbers).collect(), join: Join::CubicSpline, times };
        let drawn = |keys: &RawKeys, at: f64| {
            let clock: Vec<f64> = keys.times.iter().map(|time| f64::from(*time)).collect();
            let values: Vec<DVec4> = keys.numbers.iter().map(|numbers| parts(numbers)[1]).collect();
            x(&clock, &values, &slopes(&clock, &values, [DVec4::ZERO; 2]), at)
        };
        let told = |keys: &RawKeys, at: f64| {
            let clock: Vec<f64> = keys.times.iter().map(|time| f64::from(*time)).collect();
            let parts_of: Vec<[DVec4; 3]> = keys.numbers.iter().map(|numbers| parts(numbers)).collect();
            let after = clock.partition_point(|key| *key <= at).clamp(1, clock.len() - 1);
            let seconds = clock[after] - clock[after - 1];
            let (from, to) = (parts_of[after - 1], parts_of[after]);
            hermite([from[1], from[2], to[0], to[1]], seconds, ((at - clock[after - 1]) / seconds).clamp(0.0, 1.0)).x
        };
        let sample = |at: f64| DVec4::X * told(&old, at);
        let slope = |at: f64| (sample(at + 1e-4) - sample(at - 1e-4)) / 2e-4;
        let time = |frame: usize| frame as f64 / 30.0;
        // In the middle, to the last frame, from the first one.
        for (from, to) in [(24, 40), (50, 72), (0, 9)] {
            // Eased in and out over some frames, as repairs are.
            let eased = |frames: usize| (frames as f64 / 6.0).min(1.0).powi(2);
            let share = |frame: usize| {
                let before = if from == 0 { 1.0 } else { eased(frame + 1 - from) };
                before * if to == 72 { 1.0 } else { eased(to + 1 - frame) }
            };
            let wanted =
                |frame: usize| told(&old, time(frame)) + 0.06 * share(frame) * (1.5 + real::sin(0.4 * frame as f64));
            let frames: BTreeMap<usize, DVec4> = (from..=to).map(|frame| (frame, DVec4::X * wanted(frame))).collect();
            let new = amended(&old, &frames, &time, &sample, &slope, false).expect("there is room");
            for step in 0..=2400 {
                let at = f64::from(step) * 1e-3;
                let inside = from.checked_sub(1).is_none_or(|edge| at > time(edge)) && at < time(to + 1);
                if !inside {
                    let off = (drawn(&new, at) - drawn(&old, at)).abs();
                    assert!(off < 3e-5, "{from}..{to}, {at} s: {off} m by one's own slopes");
                    assert!((told(&new, at) - told(&old, at)).abs() < 2e-6, "{at} s by the tangents");
                }
            }
            for frame in from..=to {
                for shown in [drawn(&new, time(frame)), told(&new, time(frame))] {
                    assert!((shown - wanted(frame)).abs() < 1e-5, "frame {frame}: {shown}");
                }
            }
            for at in (0..2400).map(|step| f64::from(step) * 1e-3) {
                assert!((drawn(&new, at) - told(&new, at)).abs() < 3e-4, "{at} s: one curve to both");
            }
        }
    }
}
