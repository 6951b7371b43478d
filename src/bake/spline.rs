//! Slopes of the spline without a jump in its acceleration through given values, the ends' slopes given.
//!
//! Keys with these tangents move a body without kicks, and readers that drop a file's tangents and draw smooth curves
//! through its keys (Blender: handles of continuous acceleration) draw the same ones.

use glam::DVec4;

/// The slopes (a second) at `times` (s, rising) of the cubic spline through `values`, `ends` the first's and the last's.
pub(super) fn slopes(times: &[f64], values: &[DVec4], ends: [DVec4; 2]) -> Vec<DVec4> {
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
    use crate::rig::animate::hermite;

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
