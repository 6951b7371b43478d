//! Faults planted into captures, with the frames that they spoil: what the audit and the correction are measured by.
//!
//! Clip space, SI. A planted fault leaves everything else as it was: a moved foot takes its leg along by two-bone inverse kinematics, a
//! moved pelvis leaves the feet. What it cannot do is told by `None` (a step too near the clip's end, no flight).

#![allow(dead_code)] // the benchmark and the tests each use their part

use glam::{DQuat, DVec2, DVec3};
use surefoot::audit::contacts::{Contact, Footfalls, footfalls};
use surefoot::audit::placement::{self, Taken};
use surefoot::audit::track::Track;
use surefoot::maths::quat::shortest_arc;
use surefoot::maths::seed::Seed;
use surefoot::maths::two_bone_ik::two_bone_ik;
use surefoot::model::{Capture, Role, Side};

/// A capture with a fault in it.
pub struct Planted {
    /// What it was planted into.
    pub capture: Capture,
    /// Frames that are spoiled, first and last.
    pub span: (usize, usize),
    /// The foot that was moved, where it is one.
    pub side: Option<Side>,
}

/// Where a plant is moved to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    Forward,
    Backward,
    Inward,
    Outward,
}

/// The steps that can be spoiled: whole in the clip, their swing before and after as well.
fn candidates(feet: &Footfalls, track: &Track) -> Vec<(Taken, usize)> {
    placement::taken(track, feet)
        .into_iter()
        .filter_map(|taken| {
            let next = feet.steps.iter().find(|step| step.from == taken.step.to)?;
            let landing = &feet.contacts[taken.step.to];
            let from = &feet.contacts[taken.step.from];
            let whole = !landing.cut.0 && !landing.cut.1 && landing.start > from.end + 2;
            (whole && taken.speed > 0.3).then_some((taken, next.to))
        })
        .collect()
}

fn pick<T: Clone>(list: &[T], seed: &mut Seed) -> Option<T> {
    let index = (seed.unit() * list.len() as f64) as usize;
    list.get(index.min(list.len().saturating_sub(1))).cloned()
}

/// One foot's plant moved by so many metres: the swings before and after lead to it and away from it.
pub fn moved_plant(capture: &Capture, way: Way, metres: f64, seed: &mut Seed) -> Option<Planted> {
    let track = Track::new(capture);
    let feet = footfalls(&track);
    let (taken, next) = pick(&candidates(&feet, &track), seed)?;
    let shift = match way {
        Way::Forward => taken.ahead,
        Way::Backward => -taken.ahead,
        Way::Inward => -taken.out,
        Way::Outward => taken.out,
    } * metres;
    let (before, landing, after) =
        (&feet.contacts[taken.step.from], &feet.contacts[taken.step.to], &feet.contacts[next]);
    let mut planted = capture.clone();
    for frame in before.end..=after.start {
        let share = if frame < landing.start {
            smooth(ratio(frame, before.end, landing.start))
        } else if frame > landing.end {
            1.0 - smooth(ratio(frame, landing.end, after.start))
        } else {
            1.0
        };
        move_foot(&mut planted, frame, landing.side, DVec3::new(shift.x, 0.0, shift.y) * share, None);
    }
    Some(Planted { capture: planted, span: (landing.start, landing.end), side: Some(landing.side) })
}

/// One foot slides by so many metres while it bears.
pub fn slide(capture: &Capture, metres: f64, seed: &mut Seed) -> Option<Planted> {
    let track = Track::new(capture);
    let feet = footfalls(&track);
    let (taken, next) = pick(&candidates(&feet, &track), seed)?;
    let (landing, after) = (&feet.contacts[taken.step.to], &feet.contacts[next]);
    let angle = seed.between(0.0, std::f64::consts::TAU);
    let shift = DVec3::new(angle.cos(), 0.0, angle.sin()) * metres;
    let mut planted = capture.clone();
    for frame in landing.start..=after.start {
        let share = if frame <= landing.end {
            smooth(ratio(frame, landing.start, landing.end))
        } else {
            1.0 - smooth(ratio(frame, landing.end, after.start))
        };
        move_foot(&mut planted, frame, landing.side, shift * share, None);
    }
    Some(Planted { capture: planted, span: (landing.start, landing.end), side: Some(landing.side) })
}

/// One swing at so many times its speed: the foot arrives that much sooner and waits; nothing else changes.
pub fn fast_swing(capture: &Capture, times: f64, seed: &mut Seed) -> Option<Planted> {
    let track = Track::new(capture);
    let feet = footfalls(&track);
    let (taken, _) = pick(&candidates(&feet, &track), seed)?;
    let (before, landing) = (&feet.contacts[taken.step.from], &feet.contacts[taken.step.to]);
    let (start, end) = (before.end, landing.start + 1);
    let foot = capture.body.feet[landing.side as usize].ankle;
    let mut planted = capture.clone();
    for frame in start..=end {
        let shown = (start + (times * (frame - start) as f64).round() as usize).min(end);
        let shift = capture.at(shown)[foot] - capture.at(frame)[foot];
        move_foot(&mut planted, frame, landing.side, shift, Some(shown));
    }
    Some(Planted { capture: planted, span: (start, end), side: Some(landing.side) })
}

/// The body above the feet stands aside for a second; the pelvis sinks where a leg would not reach.
pub fn moved_pelvis(capture: &Capture, metres: f64, seed: &mut Seed) -> Option<Planted> {
    let (start, end) = window(capture, 1.0, seed)?;
    let angle = seed.between(0.0, std::f64::consts::TAU);
    let aside = DVec3::new(angle.cos(), 0.0, angle.sin()) * metres;
    let mut planted = capture.clone();
    let ramp = (0.2 * capture.fps).round().max(1.0) as usize;
    for frame in start..=end {
        let share = ramped(frame, start, end, ramp);
        let mut shift = aside * share;
        for side in Side::BOTH {
            let [hip, knee, ankle] = leg(capture, side);
            let places = capture.at(frame);
            let longest = 0.995 * (places[hip].distance(places[knee]) + places[knee].distance(places[ankle]));
            let flat = places[hip] + DVec3::new(shift.x, 0.0, shift.z) - places[ankle];
            let across = DVec2::new(flat.x, flat.z).length();
            let highest = (longest * longest - across * across).max(0.0).sqrt();
            shift.y = shift.y.min((highest - flat.y).min(0.0)).max(-0.25);
        }
        let ankles = Side::BOTH.map(|side| capture.at(frame)[leg(capture, side)[2]]);
        let joints = capture.body.joints.len();
        for place in &mut planted.positions[frame * joints..(frame + 1) * joints] {
            *place += shift;
        }
        for side in Side::BOTH {
            let ankle = planted.at(frame)[leg(capture, side)[2]];
            move_foot(&mut planted, frame, side, ankles[side as usize] - ankle, None);
        }
    }
    Some(Planted { capture: planted, span: (start, end), side: None })
}

/// The whole body over (or under) its ground for a second.
pub fn lifted(capture: &Capture, metres: f64, seed: &mut Seed) -> Option<Planted> {
    let (start, end) = window(capture, 1.0, seed)?;
    let ramp = (0.1 * capture.fps).round().max(1.0) as usize;
    let joints = capture.body.joints.len();
    let mut planted = capture.clone();
    for frame in start..=end {
        let lift = metres * ramped(frame, start, end, ramp);
        for place in &mut planted.positions[frame * joints..(frame + 1) * joints] {
            place.y += lift;
        }
    }
    Some(Planted { capture: planted, span: (start, end), side: None })
}

/// A flight that plays at that share of its speed.
pub fn slow_flight(capture: &Capture, speed: f64, seed: &mut Seed) -> Option<Planted> {
    let feet = footfalls(&Track::new(capture));
    let mut flights: Vec<(usize, usize)> = Vec::new();
    let mut open = None;
    for frame in 0..capture.frames() {
        match (feet.bearing(frame), open) {
            (0, None) => open = Some(frame),
            (1.., Some(start)) => {
                flights.push((start, frame - 1));
                open = None;
            }
            _ => {}
        }
    }
    flights.retain(|(start, end)| *start > 2 && (end - start) as f64 / capture.fps > 0.12);
    let (start, end) = pick(&flights, seed)?;
    let length = ((end - start) as f64 / speed).round() as usize;
    let times: Vec<f64> = (0..start)
        .map(|frame| frame as f64)
        .chain((0..=length).map(|frame| start as f64 + frame as f64 / length as f64 * (end - start) as f64))
        .chain((end + 1..capture.frames()).map(|frame| frame as f64))
        .collect();
    Some(Planted { capture: resampled(capture, &times), span: (start, start + length), side: None })
}

/// The whole clip at that share of its speed.
pub fn slow_clip(capture: &Capture, speed: f64) -> Planted {
    let frames = ((capture.frames() - 1) as f64 / speed).floor() as usize + 1;
    let times: Vec<f64> = (0..frames).map(|frame| (frame as f64 * speed).min((capture.frames() - 1) as f64)).collect();
    Planted { capture: resampled(capture, &times), span: (0, frames - 1), side: None }
}

fn window(capture: &Capture, seconds: f64, seed: &mut Seed) -> Option<(usize, usize)> {
    let length = (seconds * capture.fps).round() as usize;
    let edge = (0.3 * capture.fps) as usize;
    let room = capture.frames().checked_sub(length + 2 * edge + 1)?;
    let start = edge + (seed.unit() * room as f64) as usize;
    Some((start, start + length))
}

fn ramped(frame: usize, start: usize, end: usize, ramp: usize) -> f64 {
    smooth(ratio(frame, start, start + ramp)).min(smooth(1.0 - ratio(frame, end - ramp, end)))
}

fn ratio(frame: usize, from: usize, to: usize) -> f64 {
    ((frame as f64 - from as f64) / (to as f64 - from as f64).max(1.0)).clamp(0.0, 1.0)
}

fn smooth(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

fn leg(capture: &Capture, side: Side) -> [usize; 3] {
    let roles = match side {
        Side::Left => [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot],
        Side::Right => [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot],
    };
    roles.map(|role| capture.body.joint(role).expect("a body has legs"))
}

/// Moves an ankle, the leg with it; the foot keeps its turn, or takes that of another frame (of the capture as it is).
pub fn move_foot(capture: &mut Capture, frame: usize, side: Side, shift: DVec3, like: Option<usize>) {
    let [hip, knee, ankle] = leg(capture, side);
    let joints = capture.body.joints.len();
    let base = frame * joints;
    let places = capture.at(frame).to_vec();
    let wanted = places[ankle] + shift;
    let (upper, lower) = (places[hip].distance(places[knee]), places[knee].distance(places[ankle]));
    // A leg that is too short stretches, as rigs with stretching limbs do: the foot is where it was put.
    let stretch = (places[hip].distance(wanted) / (0.998 * (upper + lower))).max(1.0);
    let (upper, lower) = (upper * stretch, lower * stretch);
    let pole = places[knee] - places[hip].lerp(places[ankle], 0.5);
    let pole = pole.try_normalize().unwrap_or(DVec3::Z);
    let solved = two_bone_ik(places[hip], wanted, upper, lower, pole, 0.999);
    let new_knee = solved.middle;
    let new_ankle = solved.end;
    let turn = |from: DVec3, to: DVec3| shortest_arc(from.normalize_or(DVec3::Y), to.normalize_or(DVec3::Y));
    let thigh = turn(places[knee] - places[hip], new_knee - places[hip]);
    let shank = turn(places[ankle] - places[knee], new_ankle - new_knee);
    capture.turns[base + hip] = thigh * capture.turns[base + hip];
    capture.turns[base + knee] = shank * capture.turns[base + knee];
    capture.positions[base + knee] = new_knee;
    let below: Vec<usize> = (0..joints).filter(|joint| *joint == ankle || is_under(capture, *joint, ankle)).collect();
    for joint in below {
        if let Some(like) = like {
            let other = like * joints;
            capture.turns[base + joint] = capture.turns[other + joint];
            capture.positions[base + joint] =
                new_ankle + capture.positions[other + joint] - capture.positions[other + ankle];
        } else {
            capture.positions[base + joint] += new_ankle - places[ankle];
        }
    }
}

fn is_under(capture: &Capture, joint: usize, above: usize) -> bool {
    let mut at = capture.body.joints[joint].parent;
    while let Some(parent) = at {
        if parent == above {
            return true;
        }
        at = capture.body.joints[parent].parent;
    }
    false
}

fn resampled(capture: &Capture, times: &[f64]) -> Capture {
    let joints = capture.body.joints.len();
    let mut made = capture.clone();
    made.positions.clear();
    made.turns.clear();
    for time in times {
        let from = (time.floor() as usize).min(capture.frames() - 1);
        let to = (from + 1).min(capture.frames() - 1);
        let share = time - from as f64;
        for joint in 0..joints {
            made.positions.push(capture.at(from)[joint].lerp(capture.at(to)[joint], share));
            let (a, b): (DQuat, DQuat) = (capture.turns_at(from)[joint], capture.turns_at(to)[joint]);
            made.turns.push(a.slerp(if a.dot(b) < 0.0 { -b } else { b }, share));
        }
    }
    made
}

/// Frames of a contact, for labels.
pub fn span(contact: &Contact) -> (usize, usize) {
    (contact.start, contact.end)
}
