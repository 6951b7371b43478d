//! The reach envelope: how far the centre of mass must sink so that every planted foot stays on its leg.
//!
//! The gentlest sinking that is enough: least squares of its acceleration over the whole run (a clip is authored, so the
//! future counts), above what each moment needs, and none before the first disturbance, which nobody saw coming. Metres,
//! seconds.

use super::base::Over;
use super::care::Care;
use super::timeline::Timeline;
use crate::maths::banded::BandedLeastSquares;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::Side;
use crate::whole_body::solve::Solved;
use glam::DVec3;

/// Longest part of a planted leg that is used: straighter, and the knee pops.
const PLANTED_REACH: f64 = 0.994;
/// The same of a walker, who vaults over legs that are almost straight and lands on one.
const WALKING_REACH: f64 = 0.997;
/// Part of the leg that a landing leaves bent, and for how long (s): people land on bent knees, and a straight one pops.
const LANDING_BEND: f64 = 0.02;
/// Part of the leg by which a walker may rise over the standing height: the swinging leg's mass is up.
const RISES: f64 = 0.04;
/// Part of the leg, the arm at which a planted knee's angular acceleration counts as acceleration.
const KNEES: f64 = 0.06;
/// m, the same of what is held on to from pass to pass: a short leg's knee is the steeper.
const HOLDS_ON: f64 = 0.05;
/// Least sine of a knee's bend that its steepness is taken at.
const STEEPEST: f64 = 0.15;
/// s.
const LANDING: f64 = 0.2;
/// s, after the first disturbance, in which a base clip's legs bend as far as a planted one should.
const UNBENDS: f64 = 0.5;
/// Part of the leg by which a base clip is lowered for its feet to be reached at most; a reaction over one may need more of its own.
const MOST_SUNK: f64 = 0.3;
/// s, time in which a sinking that nothing holds comes up again (for a centre of mass at 0.96 m).
const RISE: f64 = 0.11;
/// Part of the leg that a walker's centre of mass travels up and down at most.
const TRAVEL: f64 = 0.078;
/// s of the reference body: steps of the first and longer take all of that travel, steps of the second and shorter the part below. People's
/// grows by the root of the speed only (Orendurff 2004), and who rises and falls as far in less time all but leaves the ground.
const QUICK: [f64; 2] = [0.56, 0.48];
const LESS: f64 = 0.5;
/// s, [`RISE`] of a walker.
const STRIDE: f64 = 0.06;
/// s, [`RISE`] where a base clip walks.
const BASE_STRIDE: f64 = 0.085;
/// Weight of a sample whose need is not met, against the squared acceleration: it pushes up only.
const HOLD: f64 = 3e11;
/// m, how far over the need the lowering aims, so that the soft hold still meets it.
const OVER: f64 = 8e-4;
/// s that a walker knows ahead of his own steps.
const FORESIGHT: f64 = 0.6;
/// Rounds of the one-sided penalty (a Newton method: it settles in about ten).
const ROUNDS: usize = 24;

/// Computes the lowering afresh from the poses that the present one gave, so that planted knees bend evenly too. `scale`:
/// times relative to the reference body; `damping`: how much a knee near straight holds on to the present lowering (knees
/// are far from linear: undamped, the passes go to and fro by centimetres).
pub fn lower_into_reach(timeline: &mut Timeline, solved: &[Solved], scale: f64, care: &Care, damping: f64) {
    let need: Vec<f64> = solved.iter().enumerate().map(|(index, pose)| need_at(timeline, index, pose)).collect();
    let first = (timeline.still_until / timeline.dt).round() as usize;
    let knees = planted_knees(timeline, solved, care);
    let was = timeline.lowering.clone();
    timeline.lowering = if need.iter().all(|need| *need == 0.0) {
        vec![0.0; need.len()]
    } else {
        let rise = |index: usize| {
            let (walks, own) = (timeline.walking[index], walking(timeline, index));
            scale * (RISE + (STRIDE - RISE) * own + (BASE_STRIDE - RISE) * (walks - own).max(0.0))
        };
        let rise: Vec<f64> = (0..need.len()).map(rise).collect();
        // Nobody sees a push coming: up to each, the lowering is the one that would have been without it.
        let mut done: Vec<f64> = Vec::new();
        for surprise in timeline.surprises.iter().copied().chain([f64::INFINITY]) {
            let cut = ((surprise / timeline.dt).round().max(0.0) as usize).min(need.len());
            if cut <= first.max(done.len()) && cut < need.len() {
                continue;
            }
            let foreseen = foreseen(&need, cut, timeline);
            let ease = eased(&foreseen, timeline);
            let knees: Vec<Knee> = knees.iter().filter(|knee| knee.at + 2 < cut).copied().collect();
            let solved =
                gentlest(&foreseen, &ease, first, &done, timeline.dt, &rise[..foreseen.len()], (&knees, &was, damping));
            done = solved[..cut].to_vec();
        }
        done
    };
}

/// The second difference of a planted knee's bend at three entries, as the lowering makes it.
#[derive(Clone, Copy, Debug)]
struct Knee {
    at: usize,
    by: [f64; 3], // rad a metre of lowering
    value: f64,   // rad, at no lowering
    weight: f64,
    hold: f64, // the weight of damping
}

/// Those of all planted legs, linear about the present poses.
fn planted_knees(timeline: &Timeline, solved: &[Solved], care: &Care) -> Vec<Knee> {
    let mut knees = Vec::new();
    for side in Side::BOTH {
        let leg = &timeline.anatomy.legs[side as usize];
        let slope = |index: usize| {
            let bend = solved[index].knees[side as usize];
            let length = leg.length_at(bend);
            let down = (solved[index].hips[side as usize].y
                - timeline.feet.at(side, index as f64 * timeline.dt).ankle.y)
                / length;
            0.9 * down * length / (leg.thigh_length * leg.shank_length * real::sin(bend).max(STEEPEST))
        };
        let free: Vec<bool> = (0..solved.len())
            .map(|index| index as f64 * timeline.dt)
            .map(|time| timeline.feet.freedom(side, time) > 0.0 || timeline.feet.flies_as_clip(side, time))
            .collect();
        for at in 0..solved.len().saturating_sub(2) {
            if free[at..at + 3].contains(&true) {
                continue;
            }
            let by = [slope(at), -2.0 * slope(at + 1), slope(at + 2)];
            let bend = |index: usize| solved[index].knees[side as usize];
            let now = bend(at) - 2.0 * bend(at + 1) + bend(at + 2);
            let value = now - (0..3).map(|k| by[k] * timeline.lowering[at + k]).sum::<f64>();
            let care = care.of(side)[at + 1];
            let weight = care * (KNEES * leg.length()).powi(2);
            knees.push(Knee { at, by, value, weight, hold: care * HOLDS_ON.powi(2) });
        }
    }
    knees
}

/// What is known of the needs at entry `cut`: those before it, and for a while on what a stride ago was needed.
fn foreseen(need: &[f64], cut: usize, timeline: &Timeline) -> Vec<f64> {
    let until = (cut + (FORESIGHT / timeline.dt) as usize).min(need.len());
    let mut known = need[..until].to_vec();
    let stride =
        timeline.feet.stride_before(cut as f64 * timeline.dt).map(|time| (time / timeline.dt).round() as usize);
    for index in cut..until {
        let ago = match stride {
            Some(stride) if timeline.walking[cut] > 0.0 && stride > 0 => index.checked_sub(stride),
            _ => cut.checked_sub(1),
        };
        known[index] = ago.map_or(0.0, |ago| known[ago]);
    }
    known
}

/// Where the lowering is drawn to: none in a stand; of a walker a rise, held to what people's centres of mass travel.
fn eased(need: &[f64], timeline: &Timeline) -> Vec<f64> {
    let around = (0.5 / timeline.dt).round() as usize;
    let leg = timeline.anatomy.legs[0].length();
    let tempo = (leg / 0.83).sqrt();
    (0..need.len())
        .map(|index| {
            let stride = timeline.feet.stride_before(index as f64 * timeline.dt);
            let slow = |stride: f64| ((0.5 * stride / tempo - QUICK[1]) / (QUICK[0] - QUICK[1])).clamp(0.0, 1.0);
            let travel = TRAVEL * leg * (LESS + (1.0 - LESS) * stride.map_or(1.0, slow));
            let near = &need[index.saturating_sub(around)..(index + around + 1).min(need.len())];
            let deepest = near.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let rise = need[index].min(0.0);
            rise + ((deepest - travel).max(rise) - rise) * walking(timeline, index)
        })
        .collect()
}

/// How much an entry is a walk of the stepper's own: over a base clip that walks, the clip rises and sinks by itself.
fn walking(timeline: &Timeline, index: usize) -> f64 {
    let own = match &timeline.over {
        Some(Over::Walk(walked)) => walked.own(index as f64 * timeline.dt),
        _ => 1.0,
    };
    timeline.walking[index] * own
}

/// m, lowering that the planted feet ask for at one entry, counted from no lowering at all.
fn need_at(timeline: &Timeline, index: usize, pose: &Solved) -> f64 {
    let time = index as f64 * timeline.dt;
    let walking = walking(timeline, index);
    let mut need: f64 = -RISES * walking * timeline.anatomy.legs[0].length();
    for side in Side::BOTH {
        let freedom = timeline.feet.freedom(side, time);
        if freedom > 0.5 || timeline.feet.flies_as_clip(side, time) {
            continue;
        }
        let leg = timeline.anatomy.legs[side as usize].length();
        let landed = 1.0 - smooth3(timeline.feet.since_landing(side, time) / LANDING);
        let bend = LANDING_BEND * (1.0 - walking);
        // A base clip may stand on straighter legs; nothing is asked of it before it is disturbed.
        let calm = 1.0 - smooth3((time - timeline.still_until) / UNBENDS);
        let straightest = timeline.over.as_ref().map_or(0.0, |over| over.reach(side) + 1e-4 + 0.02 * calm);
        let planted = PLANTED_REACH + (WALKING_REACH - PLANTED_REACH) * walking;
        let reach = leg * (planted.max(straightest) - bend * landed + 0.05 * freedom);
        let hip = pose.hips[side as usize];
        let ankle = timeline.feet.at(side, time).ankle;
        let flat = (hip - ankle) * DVec3::new(1.0, 0.0, 1.0);
        let highest = ankle.y + (reach * reach - flat.length_squared()).max(0.0).sqrt();
        // Sinking by one centimetre lowers the hip by a little less: the folding legs carry mass.
        need = need.max(timeline.lowering[index] + (hip.y - highest) * 1.12);
    }
    // A base clip whose legs are too short for where its feet are held is not made to kneel.
    if timeline.over.is_some() { need.min(MOST_SUNK * timeline.anatomy.legs[0].length()) } else { need }
}

/// The lowering of least acceleration over `need` (m a sample), drawn to `ease`, beginning as it is `done`, constant up to sample `first` (zero on level feet), rising again within `rise` s.
fn gentlest(
    need: &[f64],
    ease: &[f64],
    first: usize,
    done: &[f64],
    dt: f64,
    rise: &[f64],
    (knees, was, damping): (&[Knee], &[f64], f64),
) -> Vec<f64> {
    let count = need.len();
    // On uneven feet the stand itself is lower.
    let still = need[..=first.min(count - 1)].iter().copied().fold(f64::MIN, f64::max);
    let still = if still > 0.0 { still + OVER } else { 0.0 };
    let wanted_at = |index: usize| need[index] + OVER * f64::from(need[index] > 0.0);
    let mut held: Vec<bool> = need.iter().map(|need| *need > 0.0).collect();
    let mut lowering = vec![0.0; count];
    let floor = need.iter().copied().fold(0.0, f64::min);
    let bend = 1.0 / (dt * dt);
    for _ in 0..ROUNDS {
        let mut system = BandedLeastSquares::new(count, 2);
        for index in 0..count {
            if index + 2 < count {
                system.equation(index, &[bend, -2.0 * bend, bend], 0.0, 1.0);
            }
            system.equation(index, &[1.0], ease[index], rise[index].powi(-4));
            if let Some(done) = done.get(index) {
                system.equation(index, &[1.0], *done, 10.0 * HOLD);
            } else if index <= first {
                system.equation(index, &[1.0], still, 10.0 * HOLD);
            } else if held[index] {
                system.equation(index, &[1.0], wanted_at(index), HOLD);
            }
        }
        for knee in knees {
            system.equation(knee.at, &knee.by.map(|by| by * bend), -knee.value * bend, knee.weight);
            for (k, by) in knee.by.iter().enumerate() {
                let weight = damping * knee.hold * (by * bend).powi(2);
                system.equation(knee.at + k, &[1.0], was[knee.at + k], weight);
            }
        }
        lowering = system.solve();
        let mut changed = false;
        for index in 0..count {
            let wanted = index > first
                && index >= done.len()
                && lowering[index] < wanted_at(index)
                && (need[index] > 0.0 || need[index] > floor + 1e-9);
            changed |= wanted != held[index];
            held[index] = wanted;
        }
        if !changed {
            break;
        }
    }
    lowering.iter_mut().zip(need).skip(done.len()).for_each(|(value, need)| *value = value.max(need.min(0.0)));
    lowering
}

#[cfg(test)]
mod tests {
    use super::gentlest;
    use crate::maths::real;

    #[test]
    fn the_lowering_meets_the_need_starts_after_the_push_and_stays_gentle() {
        let (dt, first) = (0.01, 60);
        let need: Vec<f64> = (0..300).map(|i| if (95..120).contains(&i) { 0.10 } else { -0.01 }).collect();
        let low = gentlest(&need, &[0.0; 300], first, &[], dt, &[0.11; 300], (&[], &[], 0.0));
        for (index, (have, want)) in low.iter().zip(&need).enumerate() {
            assert!(have + 1e-4 >= *want, "sample {index}: {have} under {want}");
        }
        assert!(low[..=first].iter().all(|value| value.abs() < 1e-6), "sinks before it is pushed");
        let worst = low.windows(3).map(|w| ((w[0] - 2.0 * w[1] + w[2]) / (dt * dt)).abs()).fold(0.0, f64::max);
        assert!(worst < 9.0, "an acceleration of {worst}");
        assert!(low[250] < 0.005, "comes up again: {}", low[250]);
    }

    #[test]
    fn what_a_surprise_asks_for_joins_smoothly_on_what_was() {
        let dt = 0.01;
        let before: Vec<f64> = (0..300).map(|i| 0.02 + 0.015 * real::sin(f64::from(i) * 0.12)).collect();
        let need: Vec<f64> = (0..500).map(|i| if (328..350).contains(&i) { 0.17 } else { -0.03 }).collect();
        let low = gentlest(&need, &[0.0; 500], 50, &before, dt, &[0.085; 500], (&[], &[], 0.0));
        assert!(low[..300].iter().zip(&before).all(|(have, was)| (have - was).abs() < 1e-5), "the past changes");
        for (index, w) in low.windows(3).enumerate().skip(295) {
            let bend = (w[0] - 2.0 * w[1] + w[2]) / (dt * dt);
            assert!(bend.abs() < 25.0, "sample {index}: {bend} m/s2 at {w:?}");
        }
    }
}
