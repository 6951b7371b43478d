//! A step that the pendulum would not have taken: its plant is moved to where the body balances over it, or, where the foot was merely
//! too early, its swing is timed anew.
//!
//! Clip space, SI. The foothold goes along the error, to where a [`LEFT`] share of what would be told is left; the swings before and after
//! lead there and away. Reach bounds it: the pelvis sinks a little, beyond that the foot goes as far as the leg lets it. A swing that took
//! far less time than the clip's others is stretched until the body is where the foot comes down; its path stays the same.

use super::Fix;
use super::posing::{as_it_is, leg, pose, under};
use super::seen::{Seen, eased, side_of};
use super::slides::{bears, hold};
use crate::audit::placement::{Judged, median};
use crate::audit::stages::judged;
use crate::maths::filter::value_at;
use crate::model::findings::{Findings, Flag, Rule};
use crate::model::{Capture, Side};
use glam::{DQuat, DVec2, DVec3, DVec4};

/// Share of the limit that an error may keep, by attempt.
const LEFT: [f64; 3] = [0.25, 0.25, 0.0];
/// A swing that took a smaller share of the others' time was too fast.
const HASTY: f64 = 0.75;
/// A swing that is stretched takes no more of the others' time.
const LONGEST: f64 = 1.25;
/// Of the leg's length: a plant goes no farther.
const FARTHEST: f64 = 0.35;
/// m: a foot that bears may miss its place by reach.
const MISSED: f64 = 0.004;

/// Proposals for the flags of foot-placement.
pub fn fixes(seen: &Seen, findings: &Findings, attempt: usize) -> Vec<Fix> {
    let flags = findings.flags.iter().filter(|flag| flag.rule == Rule::FootPlacement);
    flags.filter_map(|flag| fix(seen, flag, attempt)).collect()
}

fn fix(seen: &Seen, flag: &Flag, attempt: usize) -> Option<Fix> {
    let index = seen.contact(side_of(flag.foot)?, flag.start, flag.end)?;
    let step = seen.judged.iter().find(|judged| judged.taken.step.to == index)?;
    let hasty = swing(seen, step) < HASTY * usual_swing(seen, step);
    match (attempt, hasty) {
        (0, true) | (1, false) => stretch(seen, flag, step),
        (0, false) | (1, true) => shift(seen, flag, step, LEFT[attempt]),
        _ => shift(seen, flag, step, LEFT[2]),
    }
}

/// s, of the swing that a step ends.
fn swing(seen: &Seen, step: &Judged) -> f64 {
    let contacts = &seen.feet.contacts;
    let frames = contacts[step.taken.step.to].start.saturating_sub(contacts[step.taken.step.from].end);
    frames as f64 / seen.capture().fps
}

/// s, of the clip's other swings.
fn usual_swing(seen: &Seen, step: &Judged) -> f64 {
    let others = seen.judged.iter().filter(|other| other.taken.step != step.taken.step);
    let swings: Vec<f64> = others.map(|other| swing(seen, other)).collect();
    if swings.len() < 2 { 0.4 * seen.track.tempo() } else { median(&swings) }
}

/// Moves the plant.
fn shift(seen: &Seen, flag: &Flag, step: &Judged, left: f64) -> Option<Fix> {
    let index = step.taken.step.to;
    let contact = &seen.feet.contacts[index];
    let (error, limit) = (step.error, step.limit);
    let size = (error / limit).length();
    if size < 1e-6 {
        return None;
    }
    let error = error * (1.0 - left / size).max(0.0);
    let flat = -(step.taken.ahead * error.x + step.taken.out * error.y);
    let capture = seen.capture();
    let swings = seen.swings(index);
    // What the foot slid as it stood stays, unless it is little: then it is held.
    let hold = hold(seen, contact);
    let slid = hold.shift.iter().map(|shift| shift.length()).fold(0.0, f64::max);
    let still = slid < 0.02 * seen.track.size();
    if flat.length() > FARTHEST * capture.body.leg_length {
        return None;
    }
    let mut share = 1.0;
    let mut best = None;
    for _ in 0..4 {
        let aside = DVec3::new(flat.x, 0.0, flat.y) * share;
        let goals: Vec<_> = (swings.0..=swings.1)
            .map(|frame| {
                let mut goal = as_it_is(capture, frame, bears(seen, frame));
                let foot = &mut goal.feet[contact.side as usize];
                let (by, yaw) = hold.at(frame, swings, aside);
                if still {
                    foot.ankle += by;
                    foot.turn = DQuat::from_rotation_y(yaw);
                } else {
                    let first = eased(frame, swings.0, contact.start);
                    let then = eased(frame, contact.end, swings.1);
                    foot.ankle += aside * if frame <= contact.end { first } else { 1.0 - then };
                }
                goal
            })
            .collect();
        let (piece, missed) = pose(capture, swings.0, &goals);
        let moved = aside.length();
        let what = format!("the {} foot's plant moved by {:.1} cm", flag.foot.unwrap_or("one"), 100.0 * moved);
        let held = if still { vec![(contact.side, contact.start, contact.end)] } else { Vec::new() };
        best = Some(Fix { piece, flags: vec![flag.clone()], moved, what, held });
        if missed < MISSED {
            break;
        }
        share *= 0.8;
    }
    best
}

/// Times the swing anew: the foot comes down when the body is there.
fn stretch(seen: &Seen, flag: &Flag, step: &Judged) -> Option<Fix> {
    let (from, to) = (&seen.feet.contacts[step.taken.step.from], &seen.feet.contacts[step.taken.step.to]);
    let capture = seen.capture();
    let longest = from.end + (LONGEST * usual_swing(seen, step) * capture.fps).round() as usize;
    let last = longest.min(to.end.saturating_sub(seen.frames_in(0.15)));
    let worst = |error: DVec2, limit: DVec2| (error / limit).abs().max_element();
    let later = |down: usize| -> Option<f64> {
        let mut feet = seen.feet.clone();
        let index = step.taken.step.to;
        feet.contacts[index].touch_down = to.touch_down + (down - to.start) as f64;
        feet.contacts[index].start = down;
        let judged = judged(&seen.track, &feet, &seen.domain);
        let same = judged.iter().find(|judged| judged.taken.step == step.taken.step)?;
        Some(worst(same.error, same.limit))
    };
    let found = (to.start + 1..=last)
        .filter_map(|down| Some((later(down)?, down)))
        .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
    let (left, down) = found;
    if left > 0.7 * worst(step.error, step.limit) {
        return None;
    }
    let (start, side) = (from.end, to.side);
    let ankle = capture.body.feet[side as usize].ankle;
    // Where the foot was at a time of the old swing, on a smooth curve: a straight one would shake the stretched leg.
    let source =
        |frame: usize| start as f64 + (frame - start) as f64 * (to.start - start) as f64 / (down - start) as f64;
    let (first, last) = (start.saturating_sub(2), (to.start + 2).min(seen.track.len() - 1));
    let time = |frame: usize| source(frame) - first as f64;
    let path = |joint: usize| -> Vec<DVec3> { (first..=last).map(|frame| seen.at(frame, joint)).collect() };
    let ankles = path(ankle);
    let knees = knees(seen, side, first, last);
    let mut moved: f64 = 0.0;
    let goals: Vec<_> = (start..=down)
        .map(|frame| {
            let other = bears(seen, frame)[1 - side as usize];
            let mut held = [other; 2];
            held[side as usize] = frame == start || frame == down;
            let mut goal = as_it_is(capture, frame, held);
            let then = value_at(&ankles, 1.0, time(frame)).unwrap_or(goal.feet[side as usize].ankle);
            let foot = &mut goal.feet[side as usize];
            moved = moved.max(then.distance(foot.ankle));
            foot.ankle = then;
            // The knee points, seen from the pelvis, to where it did at that time of the swing.
            foot.knee = value_at(&knees, 1.0, time(frame)).map(|knee| capture.turns_at(frame)[0] * knee);
            goal
        })
        .collect();
    let (mut piece, _) = pose(capture, start, &goals);
    let below: Vec<(usize, Vec<DVec3>, Vec<DVec4>)> = under(&capture.body, ankle)
        .into_iter()
        .map(|joint| (joint, path(joint), turns(capture, joint, first, last)))
        .collect();
    for frame in start + 1..down {
        let (mut places, mut turns) = (capture.at(frame).to_vec(), capture.turns_at(frame).to_vec());
        for (joint, path, turned) in &below {
            places[*joint] = value_at(path, 1.0, time(frame)).unwrap_or(places[*joint]);
            let turn = value_at(turned, 1.0, time(frame)).and_then(DVec4::try_normalize);
            turns[*joint] = turn.map_or(turns[*joint], DQuat::from_vec4);
        }
        piece.turn_foot_like(&capture.body, frame, side, &turns, &places);
    }
    let late = (down - to.start) as f64 / capture.fps;
    let what = format!("the {} foot's swing takes {late:.2} s longer", flag.foot.unwrap_or("one"));
    Some(Fix { piece, flags: vec![flag.clone()], moved, what, held: Vec::new() })
}

/// Where a knee points in the pelvis's frame, (frames of a span): from the line between hip and ankle, a little to the thigh's front.
fn knees(seen: &Seen, side: Side, first: usize, last: usize) -> Vec<DVec3> {
    let capture = seen.capture();
    let [hip, knee, ankle] = leg(&capture.body, side);
    let points = |frame: usize| {
        let places = capture.at(frame);
        let axis = (places[ankle] - places[hip]).normalize_or(DVec3::NEG_Y);
        let aside = |vector: DVec3| vector - axis * vector.dot(axis);
        let front = aside(capture.turns_at(frame)[hip] * DVec3::Z).normalize_or_zero();
        capture.turns_at(frame)[0].inverse()
            * (aside(places[knee] - places[hip]) + front * 0.01 * capture.body.leg_length)
    };
    (first..=last).map(points).collect()
}

/// A joint's turns in a span, each on the near side of the one before.
fn turns(capture: &Capture, joint: usize, first: usize, last: usize) -> Vec<DVec4> {
    let mut before = DVec4::ZERO;
    let near = |frame: usize| {
        let turn = DVec4::from(capture.turns_at(frame)[joint]);
        before = if turn.dot(before) < 0.0 { -turn } else { turn };
        before
    };
    (first..=last).map(near).collect()
}
