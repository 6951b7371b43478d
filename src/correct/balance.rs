//! A body that no ground could hold up: the pelvis and the trunk go back over the feet, which stay.
//!
//! Clip space, SI. The zero-moment point is z = c - c''h/g, less what the clip's told pushes explain of it, so a shift s of the centre of
//! mass moves it by s - s''h/g. Least squares over the flagged span and what is beside it: the ZMP comes to the middle of what bears (first attempt) or to the nearest place in it (then), the
//! shift is smooth and begins and ends at rest. A pelvis that sank meanwhile comes back to the height that it has before and after.

use super::posing::{Goal, as_it_is, pose};
use super::seen::Seen;
use super::slides::bears;
use super::{Fix, flag_group};
use crate::audit::balance::support;
use crate::maths::banded::BandedLeastSquares;
use crate::maths::hull::{centroid, closest_point, shrink};
use crate::measure::GRAVITY;
use crate::model::findings::{Findings, Flag, Rule};
use crate::model::{Capture, Side};
use glam::{DVec2, DVec3};

/// s: flags that are nearer are of one fault.
const JOIN: f64 = 0.9;
/// s: how far beside the flags the fault may begin and end.
const EDGE: f64 = 0.3;
/// s: smoothness of the shift.
const SMOOTH: f64 = 0.05;
/// How much of a pelvis's shift the centre of mass goes, feet held.
const CARRIED: f64 = 0.85;
/// s: soles that bear within that time carry.
const CARRY: f64 = 0.06;
/// m: a pelvis that is lower than beside the span by more comes up.
const SUNK: f64 = 0.015;
/// s: a body stands aside no longer, from where the ZMP shows it.
const LASTS: f64 = 1.1;
/// Share of the clip that a fault of the body may last.
const MOST: f64 = 0.7;
/// A pelvis whose path loses more than the rest of its unsteadiness was off itself.
const CALMER: f64 = 0.5;
/// How much harder it starts there than nine tenths of the clip do.
const ABRUPT: f64 = 3.0;

/// Proposals for the flags of balance; `odd`: only where the pelvis's path becomes much smoother by it, so that it is the body that is off
/// and not a foot.
pub fn fixes(seen: &Seen, findings: &Findings, attempt: usize, odd: bool) -> Vec<Fix> {
    let groups = flag_group(&findings.flags, Rule::Balance, seen.frames_in(JOIN));
    groups.iter().filter_map(|group| fix(seen, group, attempt, odd)).collect()
}

fn fix(seen: &Seen, group: &[Flag], attempt: usize, odd: bool) -> Option<Fix> {
    let first = group.first()?;
    let edge = seen.frames_in(EDGE * if attempt == 2 { 2.0 } else { 1.0 });
    let (from, to) = (first.start, group.iter().map(|flag| flag.end).max()?);
    let (from, to) = if odd { abrupt(seen, from, to) } else { (from, to) };
    let start = from.saturating_sub(edge);
    let end = (to + edge).min(seen.track.len() - 1);
    // What lasts for most of the clip has no surroundings to come back to.
    let whole =
        end - start + 1 >= (MOST * seen.track.len() as f64) as usize || (start == 0 && end + 1 == seen.track.len());
    if end < start + 6 || whole {
        return None;
    }
    let capture = seen.capture();
    let shift = over_the_feet(seen, start, end, attempt == 1);
    if odd && !smoother(seen, start, &shift) {
        return None;
    }
    let rise = rise(seen, start, end);
    let goals: Vec<Goal> = (start..=end)
        .map(|frame| {
            let index = frame - start;
            let mut goal = as_it_is(capture, frame, bears(seen, frame));
            goal.body = DVec3::new(shift[index].x, rise[index], shift[index].y);
            goal
        })
        .collect();
    let (piece, _) = pose(capture, start, &goals);
    let moved = goals.iter().map(|goal| goal.body.length()).fold(0.0, f64::max);
    let what = format!("pelvis and trunk moved by up to {:.1} cm, the feet held", 100.0 * moved);
    Some(Fix { piece, flags: group.to_vec(), moved, what, held: Vec::new() })
}

/// A span widened to where else, near it, the pelvis starts or stops as it does nowhere in the clip: a body that stands aside shows in the
/// ZMP as it goes there or as it comes back, and not always in both.
fn abrupt(seen: &Seen, from: usize, to: usize) -> (usize, usize) {
    let near = seen.frames_in(LASTS);
    let bend = |frame: usize| {
        let place = |frame: usize| seen.at(frame, 0) * DVec3::new(1.0, 0.0, 1.0);
        (place(frame - 1) - place(frame) * 2.0 + place(frame + 1)).length()
    };
    let frames = 1..seen.track.len() - 1;
    let mut usual: Vec<f64> = frames.clone().filter(|frame| seen.domain.walks(*frame)).map(bend).collect();
    usual.sort_by(f64::total_cmp);
    let limit = ABRUPT * usual.get(usual.len() / 2).copied().unwrap_or(f64::MAX);
    let odd = |frame: &usize| *frame + near >= from && *frame <= to + near && bend(*frame) > limit;
    let found: Vec<usize> = frames.filter(odd).collect();
    (found.first().map_or(from, |first| from.min(*first)), found.last().map_or(to, |last| to.max(*last)))
}

/// Whether the pelvis starts and stops there as nowhere else in the clip, and the shift takes most of that out of its path.
fn smoother(seen: &Seen, start: usize, shift: &[DVec2]) -> bool {
    let bend = |frame: usize, share: f64| {
        let place = |frame: usize| {
            let hips = seen.at(frame, 0);
            let by = frame.checked_sub(start).and_then(|index| shift.get(index)).copied().unwrap_or(DVec2::ZERO);
            DVec2::new(hips.x, hips.z) + by * share
        };
        (place(frame - 1) - place(frame) * 2.0 + place(frame + 1)).length()
    };
    let end = start + shift.len() - 1;
    let inner = start.max(1)..end.min(seen.track.len() - 1);
    let peak = inner.clone().map(|frame| bend(frame, 0.0)).fold(0.0, f64::max);
    let mut usual: Vec<f64> = (1..seen.track.len() - 1)
        .filter(|frame| !inner.contains(frame) && seen.domain.walks(*frame))
        .map(|frame| bend(frame, 0.0))
        .collect();
    usual.sort_by(f64::total_cmp);
    let usual = usual.get(usual.len() * 9 / 10).copied().unwrap_or(0.0);
    let roughness = |share: f64| inner.clone().map(|frame| bend(frame, share).powi(2)).sum::<f64>();
    peak > ABRUPT * usual && roughness(1.0) < CALMER * roughness(0.0)
}

/// m, (x, z), (frames): what the pelvis is moved by.
fn over_the_feet(seen: &Seen, start: usize, end: usize, least: bool) -> Vec<DVec2> {
    let capture = seen.capture();
    let hz = capture.fps;
    let count = end - start + 1;
    let com: Vec<DVec3> = (0..seen.track.len()).map(|frame| capture.centre_of_mass(frame)).collect();
    let carry = seen.frames_in(CARRY);
    let mut systems = [(); 2].map(|()| BandedLeastSquares::new(count, 3));
    for index in 1..count.saturating_sub(1) {
        let frame = start + index;
        let height = (com[frame].y - seen.feet.floor_at(frame, seen.track.below(frame))).max(0.2);
        let stiff = height / GRAVITY * hz * hz;
        let bend = com[frame - 1] - com[frame] * 2.0 + com[frame + 1];
        let zmp = com[frame] - bend * stiff;
        let zmp = DVec2::new(zmp.x, zmp.z) + pushed(capture, frame, com[frame], height);
        let Some(hull) = support(&seen.track, &seen.feet, frame, carry) else { continue };
        let inner = shrink(&hull, 0.02 * seen.track.size());
        let inside = if inner.is_empty() { &hull } else { &inner };
        let nearest = closest_point(inside, zmp).unwrap_or(zmp);
        let aim = if least { nearest } else { centroid(&hull).unwrap_or(nearest) };
        let by = aim - zmp;
        for (system, by) in systems.iter_mut().zip([by.x, by.y]) {
            system.equation(index - 1, &[-stiff, 1.0 + 2.0 * stiff, -stiff], by / CARRIED, 1.0);
        }
    }
    let smooth = (SMOOTH * hz).powi(6) * 40.0;
    let [x, z] = systems.map(|mut system| {
        for index in 0..count.saturating_sub(3) {
            system.equation(index, &[-1.0, 3.0, -3.0, 1.0], 0.0, smooth);
        }
        for index in 0..count {
            let pinned = (index < 2 && start > 0) || (index + 2 >= count && end + 1 < seen.track.len());
            system.equation(index, &[1.0], 0.0, if pinned { 1e7 } else { 1e-3 });
        }
        system.solve()
    });
    let pinned = |index: usize| (index == 0 && start > 0) || (index + 1 == count && end + 1 < seen.track.len());
    (0..count).map(|index| if pinned(index) { DVec2::ZERO } else { DVec2::new(x[index], z[index]) }).collect()
}

/// m, (x, z): how far the told pushes move the ZMP: over there the ground must push to hold them up, and the motion does not show it. A push
/// counts by the share of the frame that it covers, as in `measure::dynamics`.
fn pushed(capture: &Capture, frame: usize, com: DVec3, height: f64) -> DVec2 {
    let hz = capture.fps;
    let time = frame as f64 / hz;
    let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
    for push in &capture.pushes {
        let covered = (push.end.min(time + 0.5 / hz) - push.start.max(time - 0.5 / hz)) * hz;
        let share = push.force * covered.clamp(0.0, 1.0);
        force += share;
        moment += push.joint.map_or(DVec3::ZERO, |joint| capture.at(frame)[joint] - com).cross(share);
    }
    let weight = capture.body.mass * GRAVITY;
    let load = (weight - force.y).max(0.4 * weight).max(1e-9);
    DVec2::new(height * force.x - moment.z, height * force.z + moment.x) / load
}

/// m, (frames): how far a pelvis that sank comes up.
fn rise(seen: &Seen, start: usize, end: usize) -> Vec<f64> {
    let count = end - start + 1;
    let around = seen.frames_in(0.5);
    let mean = |from: usize, to: usize| {
        let heights: Vec<f64> = (from..to).map(|frame| height(seen, frame)).collect();
        (!heights.is_empty()).then(|| heights.iter().sum::<f64>() / heights.len() as f64)
    };
    let before = mean(start.saturating_sub(around), start);
    let after = mean((end + 1).min(seen.track.len()), (end + 1 + around).min(seen.track.len()));
    let (Some(before), Some(after)) = (before.or(after), after.or(before)) else { return vec![0.0; count] };
    let line = |index: usize| before + (after - before) * index as f64 / count as f64;
    let low: Vec<f64> = (0..count).map(|index| line(index) - height(seen, start + index)).collect();
    let core = &low[count / 4..count - count / 4];
    let sunk = core.iter().sum::<f64>() / core.len().max(1) as f64;
    if sunk < SUNK * seen.track.size() {
        return vec![0.0; count];
    }
    // What comes and goes within a stride is the walker's own.
    let mut system = BandedLeastSquares::new(count, 2);
    let smooth = (0.1 * seen.capture().fps).powi(4);
    for (index, low) in low.iter().enumerate() {
        system.equation(index, &[1.0], *low, 1.0);
        if index + 2 < count {
            system.equation(index, &[1.0, -2.0, 1.0], 0.0, smooth);
        }
        if (index < 2 && start > 0) || (index + 2 >= count && end + 1 < seen.track.len()) {
            system.equation(index, &[1.0], 0.0, 1e5);
        }
    }
    let mut rise = system.solve();
    if start > 0 {
        rise[0] = 0.0;
    }
    if end + 1 < seen.track.len() {
        rise[count - 1] = 0.0;
    }
    rise
}

/// m: the pelvis over the floor that bears.
fn height(seen: &Seen, frame: usize) -> f64 {
    let floor = Side::BOTH
        .map(|side| seen.feet.ground.under(side, seen.track.below(frame)))
        .into_iter()
        .fold(f64::MAX, f64::min);
    seen.at(frame, 0).y - floor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::balance::balance;
    use crate::audit::contacts::footfalls;
    use crate::audit::fixture::stand;
    use crate::audit::track::Track;
    use crate::model::Role;
    use crate::model::capture::ToldPush;

    #[test]
    fn a_told_push_moves_the_zmp_as_the_audit_has_it() {
        let still = stand(2.0);
        let chest = still.body.joint(Role::Chest).or(still.body.joint(Role::Spine)).expect("a trunk");
        for (force, joint) in [(DVec3::X * 60.0, None), (DVec3::new(20.0, 30.0, -50.0), Some(chest))] {
            let mut capture = still.clone();
            capture.pushes = vec![ToldPush { start: 0.2, end: 1.8, force, joint }];
            let zmp = |capture: &Capture| {
                let track = Track::new(capture);
                balance(&track, &footfalls(&track))[capture.frames() / 2].expect("it stands").zmp
            };
            let track = Track::new(&capture);
            let middle = capture.frames() / 2;
            let floor = footfalls(&track).floor_at(middle, track.below(middle));
            let by = pushed(&capture, middle, track.com[middle], track.com[middle].y - floor);
            let told = zmp(&capture) - zmp(&still);
            assert!(told.length() > 0.05 && by.distance(told) < 1e-3, "{by} {told}");
        }
    }
}
