//! The reach envelope: how far the centre of mass must sink so that every planted foot stays on its leg.
//!
//! A sinking smoothed from the future as well as the past (a clip is authored): the running maximum over a window, then a
//! raised cosine of the same width, so that it never falls under what is needed and starts before it is. Metres, seconds.

use super::timeline::Timeline;
use crate::model::Side;
use crate::whole_body::solve::Solved;
use glam::DVec3;

/// Longest part of a planted leg that is used: straighter, and the knee pops.
const PLANTED_REACH: f64 = 0.994;
/// m/s², the most that the sinking itself may accelerate the centre of mass.
const MOST_ACCELERATION: f64 = 4.5;

/// Computes the lowering afresh from the poses that the present one gave. `scale`: times relative to the reference body.
pub fn lower_into_reach(timeline: &mut Timeline, solved: &[Solved], scale: f64) {
    let dt = timeline.dt;
    let need: Vec<f64> = solved.iter().enumerate().map(|(index, pose)| need_at(timeline, index, pose)).collect();
    if need.iter().all(|need| *need <= 0.0) {
        timeline.lowering.iter_mut().for_each(|value| *value = 0.0);
        return;
    }
    let mut half = 0.11 * scale;
    for _ in 0..8 {
        let lowering = envelope(&need, (half / dt).round().max(1.0) as usize);
        let worst = lowering.windows(3).map(|w| ((w[0] - 2.0 * w[1] + w[2]) / (dt * dt)).abs()).fold(0.0, f64::max);
        timeline.lowering = lowering;
        if worst < MOST_ACCELERATION {
            break;
        }
        half *= 1.25;
    }
}

/// m, lowering that the planted feet ask for at one entry, counted from no lowering at all.
fn need_at(timeline: &Timeline, index: usize, pose: &Solved) -> f64 {
    let time = index as f64 * timeline.dt;
    let mut need: f64 = 0.0;
    for side in Side::BOTH {
        let freedom = timeline.feet.freedom(side, time);
        if freedom > 0.5 {
            continue;
        }
        let leg = timeline.anatomy.legs[side as usize].length();
        let reach = leg * (PLANTED_REACH + 0.05 * freedom);
        let hip = pose.hips[side as usize];
        let ankle = timeline.feet.at(side, time).ankle;
        let flat = (hip - ankle) * DVec3::new(1.0, 0.0, 1.0);
        let highest = ankle.y + (reach * reach - flat.length_squared()).max(0.0).sqrt();
        // Sinking by one centimetre lowers the hip by a little less: the folding legs carry mass.
        need = need.max(timeline.lowering[index] + (hip.y - highest) * 1.12);
    }
    need
}

/// The running maximum over ±`half` samples, smoothed by a raised cosine of ±`half`.
fn envelope(need: &[f64], half: usize) -> Vec<f64> {
    let last = need.len() - 1;
    let top: Vec<f64> = (0..need.len())
        .map(|i| need[i.saturating_sub(half)..=(i + half).min(last)].iter().copied().fold(0.0, f64::max))
        .collect();
    let kernel: Vec<f64> = (0..=2 * half)
        .map(|k| 1.0 + (std::f64::consts::PI * (k as f64 - half as f64) / (half as f64 + 1.0)).cos())
        .collect();
    let sum: f64 = kernel.iter().sum();
    (0..need.len())
        .map(|i| {
            kernel
                .iter()
                .enumerate()
                .map(|(k, weight)| weight * top[(i + k).saturating_sub(half).min(last)])
                .sum::<f64>()
                / sum
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::envelope;

    #[test]
    fn the_envelope_never_falls_under_the_need_and_has_no_corners() {
        let need: Vec<f64> = (0..200).map(|i| if (80..95).contains(&i) { 0.1 } else { 0.0 }).collect();
        let low = envelope(&need, 12);
        for (index, (have, want)) in low.iter().zip(&need).enumerate() {
            assert!(have + 1e-12 >= *want, "sample {index}: {have} under {want}");
        }
        let jump = low.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 0.01, "a jump of {jump}");
    }
}
