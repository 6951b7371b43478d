//! A body over or under its floor: the whole of it is lowered or lifted, or the one foot that is off.
//!
//! Clip space, m. How far off is read from the soles that bear, frame by frame, and smoothed; where the floor is told by the rest of the
//! clip. Whole body first where both feet say the same, or where that makes the pelvis's path smoother; else the foot alone.

use super::posing::{as_it_is, pose};
use super::seen::{Seen, side_of};
use super::{Fix, flag_group};
use crate::maths::banded::BandedLeastSquares;
use crate::model::Side;
use crate::model::findings::{Findings, Flag, Rule};
use glam::DVec3;

/// s: flags that are nearer are of one fault.
const JOIN: f64 = 0.4;
/// s: how far beside the flags the fault may begin and end.
const EDGE: f64 = 0.25;
/// m: soles are no truer than that.
const SOLE: f64 = 0.012;
/// s: how smooth the lift is.
const SMOOTH: f64 = 0.035;

/// Of the leg's length: nothing is lifted or lowered farther.
const FARTHEST: f64 = 0.2;

/// Proposals for the flags of penetration and float.
pub fn fixes(seen: &Seen, findings: &Findings, rules: &[Rule], attempt: usize) -> Vec<Fix> {
    let mut fixes = Vec::new();
    for rule in rules {
        for group in flag_group(&findings.flags, *rule, seen.frames_in(JOIN)) {
            fixes.extend(fix(seen, &group, attempt));
        }
    }
    fixes
}

fn fix(seen: &Seen, group: &[Flag], attempt: usize) -> Option<Fix> {
    let first = group.first()?;
    let sides: Vec<Option<Side>> = group.iter().map(|flag| side_of(flag.foot)).collect();
    let edge = seen.frames_in(EDGE);
    let (start, end) = (first.start.saturating_sub(edge), (group.last()?.end + edge).min(seen.track.len() - 1));
    let both = off_by(seen, start, end, &Side::BOTH);
    let alone = sides.iter().flatten().next().copied().filter(|side| sides.iter().all(|other| *other == Some(*side)));
    let whole = match alone {
        None => true,
        Some(_) => smoother(seen, start, &both),
    };
    let (whole, steps) = match attempt {
        0 => (whole, 1.0),
        1 => (!whole, 1.0),
        _ => (whole, 0.6),
    };
    let feet: Vec<Side> = if whole { Side::BOTH.to_vec() } else { vec![alone.unwrap_or(Side::Left)] };
    if !whole && alone.is_none() {
        return None;
    }
    let lift: Vec<f64> = if whole { both } else { off_by(seen, start, end, &feet) };
    let goals: Vec<_> = lift
        .iter()
        .enumerate()
        .map(|(index, lift)| {
            let mut goal = as_it_is(seen.capture(), start + index, [false; 2]);
            let by = DVec3::Y * *lift * steps;
            if whole {
                goal.body = by;
            }
            for side in &feet {
                goal.feet[*side as usize].ankle += by;
            }
            goal
        })
        .collect();
    let (piece, _) = pose(seen.capture(), start, &goals);
    let moved = lift.iter().map(|lift| lift.abs()).fold(0.0, f64::max);
    if moved > FARTHEST * seen.capture().body.leg_length {
        return None;
    }
    let way = if lift.iter().sum::<f64>() < 0.0 { "lowered" } else { "lifted" };
    let who = if whole { "the whole body".to_owned() } else { format!("the {} foot", first.foot.unwrap_or("one")) };
    let what = format!("{who} {way} by up to {:.1} cm", 100.0 * moved);
    Some(Fix { piece, flags: group.to_vec(), moved, what, held: Vec::new() })
}

/// m, (frames from `start` to `end`): by how much those feet must rise so that what bears is on the floor; smooth, 0 at both ends.
fn off_by(seen: &Seen, start: usize, end: usize, sides: &[Side]) -> Vec<f64> {
    let (track, feet) = (&seen.track, &seen.feet);
    let count = end - start + 1;
    let mut system = BandedLeastSquares::new(count, 2);
    let sole = SOLE * track.size();
    for index in 0..count {
        let frame = start + index;
        for side in sides {
            if feet.of[*side as usize][frame].is_none() {
                continue;
            }
            let foot = &track.feet[*side as usize];
            let height = foot.low[frame] - feet.under(*side, frame, foot.place(frame));
            let wanted = if height.abs() < sole { 0.0 } else { -height };
            system.equation(index, &[1.0], wanted, 1.0);
        }
        system.equation(index, &[1.0], 0.0, 1e-4);
    }
    let stiff = (SMOOTH * track.capture.fps).powi(4);
    for index in 0..count.saturating_sub(2) {
        system.equation(index, &[1.0, -2.0, 1.0], 0.0, stiff);
    }
    // The clip's own ends are free, others join what stays.
    let (first, last) = (start > 0, end + 1 < track.len());
    for index in 0..2.min(count) {
        if first {
            system.equation(index, &[1.0], 0.0, 1e4);
        }
        if last {
            system.equation(count - 1 - index, &[1.0], 0.0, 1e4);
        }
    }
    let mut lift = system.solve();
    for (at_end, index) in [(first, 0), (last, count - 1)] {
        if at_end {
            lift[index] = 0.0;
        }
    }
    lift
}

/// Whether that lift leaves the pelvis a smoother path than it has.
fn smoother(seen: &Seen, start: usize, lift: &[f64]) -> bool {
    let roughness = |lifted: bool| -> f64 {
        let height = |index: usize| seen.at(start + index, 0).y + if lifted { lift[index] } else { 0.0 };
        (1..lift.len().saturating_sub(1))
            .map(|index| (height(index - 1) - 2.0 * height(index) + height(index + 1)).powi(2))
            .sum()
    };
    roughness(true) < roughness(false)
}
