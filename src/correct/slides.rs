//! A foot that slides while it bears is held where it stands: its heel while that alone bears, then the ball.
//!
//! Clip space, m. The place is where the foot was most of the time, or the point of its slide that is nearest to where the pendulum puts
//! it; the swings before and after are led there and away. Where both feet slide together (drift) the pelvis goes back with them. While the
//! sole is flat the foot keeps one heading, unless it turns on the spot by more than a few degrees: then that is what it does.

use super::Fix;
use super::posing::{Goal, as_it_is, pose};
use super::seen::{Seen, eased, side_of};
use crate::audit::contacts::Contact;
use crate::maths::real;
use crate::measure::support::levelled_point;
use crate::model::findings::{Findings, Flag, Rule};
use crate::model::{Capture, Side};
use glam::{DQuat, DVec2, DVec3};

/// rad: a flat foot that turns by more pivots.
const PIVOTS: f64 = 0.14;
/// s: a heel lifts, or an end of a slide bears, no shorter.
const BRIEF: f64 = 0.07;

/// How a foot must be moved to be still: from each frame of its contact.
pub struct Hold {
    /// First frame of the contact.
    pub start: usize,
    /// (frames) m: what its ankle is moved by; 0 in the first.
    pub shift: Vec<DVec3>,
    /// (frames) rad about the vertical: what it is turned by.
    pub yaw: Vec<f64>,
}

/// Proposals for the flags of foot-slide and drift.
pub fn fixes(seen: &Seen, findings: &Findings, rules: &[Rule], attempt: usize) -> Vec<Fix> {
    let flags: Vec<&Flag> = findings.flags.iter().filter(|flag| rules.contains(&flag.rule)).collect();
    let mut fixes = Vec::new();
    for flag in flags {
        let sides = side_of(flag.foot).map_or(Side::BOTH.to_vec(), |side| vec![side]);
        let contacts: Vec<usize> = sides.iter().filter_map(|side| seen.contact(*side, flag.start, flag.end)).collect();
        fixes.extend(fix(seen, flag, &contacts, attempt));
    }
    fixes
}

fn fix(seen: &Seen, flag: &Flag, contacts: &[usize], attempt: usize) -> Option<Fix> {
    let spans: Vec<(usize, usize)> = contacts.iter().map(|index| seen.swings(*index)).collect();
    let start = spans.iter().map(|span| span.0).min()?;
    let end = spans.iter().map(|span| span.1).max()?;
    let capture = seen.capture();
    let mut goals: Vec<Goal> = (start..=end).map(|frame| as_it_is(capture, frame, bears(seen, frame))).collect();
    let mut moved: f64 = 0.0;
    let mut held = Vec::new();
    for index in contacts {
        let contact = &seen.feet.contacts[*index];
        let hold = hold(seen, contact);
        let aside = reference(seen, *index, &hold, attempt);
        for frame in start..=end {
            let (shift, yaw) = hold.at(frame, seen.swings(*index), aside);
            let foot = &mut goals[frame - start].feet[contact.side as usize];
            foot.ankle += shift;
            foot.turn = DQuat::from_rotation_y(yaw);
            moved = moved.max(shift.length());
        }
        held.push((contact.side, contact.start, contact.end));
    }
    if flag.rule == Rule::Drift {
        follow(capture, start, &mut goals);
    }
    let (piece, _) = pose(capture, start, &goals);
    let who = flag.foot.map_or("both feet".to_owned(), |foot| format!("the {foot} foot"));
    let body = if flag.rule == Rule::Drift { ", the body moved back over them" } else { "" };
    let what = format!("{who} held in place, moved by up to {:.1} cm{body}", 100.0 * moved);
    Some(Fix { piece, flags: vec![flag.clone()], moved, what, held })
}

/// Which feet bear.
pub fn bears(seen: &Seen, frame: usize) -> [bool; 2] {
    Side::BOTH.map(|side| seen.feet.of[side as usize][frame].is_some())
}

/// The pelvis goes with the mean of its feet.
fn follow(capture: &Capture, start: usize, goals: &mut [Goal]) {
    for (index, goal) in goals.iter_mut().enumerate() {
        let was = as_it_is(capture, start + index, [true; 2]);
        let shift = |side: usize| goal.feet[side].ankle - was.feet[side].ankle;
        let mean = (shift(0) + shift(1)) * 0.5;
        goal.body = DVec3::new(mean.x, 0.0, mean.z);
    }
}

impl Hold {
    /// Shift and yaw of a frame within the foot's swings, moved aside by so much: eased in and out.
    pub fn at(&self, frame: usize, swings: (usize, usize), aside: DVec3) -> (DVec3, f64) {
        let last = self.start + self.shift.len() - 1;
        let index = frame.clamp(self.start, last) - self.start;
        let share = if frame < swings.0 || frame > swings.1 {
            0.0
        } else if frame < self.start {
            eased(frame, swings.0, self.start)
        } else if frame > last {
            1.0 - eased(frame, last, swings.1)
        } else {
            1.0
        };
        ((self.shift[index] + aside) * share, self.yaw[index] * share)
    }
}

/// What holds a contact's foot still, from where it came down.
pub fn hold(seen: &Seen, contact: &Contact) -> Hold {
    let capture = seen.capture();
    let parts = parts(seen, contact);
    let yaw = yaws(capture, contact, &parts);
    let mut shift: Vec<DVec3> = Vec::with_capacity(parts.len());
    let point = |frame: usize, index: usize| turned(capture, frame, contact.side, parts[index], yaw[index]);
    for index in 0..parts.len() {
        let frame = contact.start + index;
        let before = shift.last().copied().unwrap_or(DVec3::ZERO);
        if index == 0 {
            shift.push(DVec3::ZERO);
            continue;
        }
        // The point that bears stays where it was a frame before.
        let was = turned(capture, frame - 1, contact.side, parts[index], yaw[index - 1]) + before;
        let step = was - point(frame, index);
        shift.push(DVec3::new(step.x, 0.0, step.z));
    }
    Hold { start: contact.start, shift, yaw }
}

/// What of the sole bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bears {
    /// The heel alone.
    Heel,
    /// The ball, or all.
    Ball,
}

/// (frames of the contact) what holds; the heel only at the beginning, unless the foot walks backwards onto it.
fn parts(seen: &Seen, contact: &Contact) -> Vec<Bears> {
    let frames = contact.start..=contact.end;
    let mut parts: Vec<Bears> = frames
        .map(|frame| match crate::audit::part(&seen.track, contact, frame) {
            "heel" => Bears::Heel,
            _ => Bears::Ball,
        })
        .collect();
    let brief = seen.frames_in(BRIEF);
    for at in 1..parts.len() {
        let same = parts[at..].iter().take_while(|part| **part == parts[at]).count();
        if parts[at] != parts[at - 1] && same < brief && at + same < parts.len() {
            let before = parts[at - 1];
            parts[at..at + same].fill(before);
        }
    }
    parts
}

/// (frames of the contact) rad: what takes a flat foot's small turns away.
fn yaws(capture: &Capture, contact: &Contact, parts: &[Bears]) -> Vec<f64> {
    let foot = &capture.body.feet[contact.side as usize];
    let heading = |frame: usize| {
        let [heel, ball] =
            [foot.heel, foot.ball].map(|at| capture.rigid_point(frame, foot.ankle, levelled_point(foot, at, 0.0, 0.0)));
        let along = ball - heel;
        (real::atan2(along.x, along.z), (along.y / along.length().max(1e-6)).abs() < 0.12)
    };
    let headings: Vec<(f64, bool)> = (contact.start..=contact.end).map(heading).collect();
    let flat: Vec<usize> =
        (0..parts.len()).filter(|index| parts[*index] == Bears::Ball && headings[*index].1).collect();
    let (Some(first), Some(last)) = (flat.first(), flat.last()) else { return vec![0.0; parts.len()] };
    let middle = headings[flat[flat.len() / 2]].0;
    let off = |index: usize| crate::maths::quat::wrap_angle(middle - headings[index].0);
    if flat.iter().any(|index| off(*index).abs() > 0.5 * PIVOTS) {
        return vec![0.0; parts.len()];
    }
    (0..parts.len()).map(|index| off(index.clamp(*first, *last))).map(|off| off.clamp(-PIVOTS, PIVOTS)).collect()
}

/// m: the point of the sole that bears, with the foot turned about its ankle.
fn turned(capture: &Capture, frame: usize, side: Side, part: Bears, yaw: f64) -> DVec3 {
    let ankle = capture.at(frame)[capture.body.feet[side as usize].ankle];
    ankle + DQuat::from_rotation_y(yaw) * (held_point(capture, frame, side, part) - ankle)
}

/// m: the point of the sole that is held: the heel's end, or the toe joint (the ball line where there is none).
pub fn held_point(capture: &Capture, frame: usize, side: Side, part: Bears) -> DVec3 {
    let foot = &capture.body.feet[side as usize];
    match (part, foot.toe) {
        (Bears::Ball, Some(toe)) => capture.at(frame)[toe],
        (Bears::Ball, None) => capture.rigid_point(frame, foot.ankle, levelled_point(foot, foot.ball, 0.0, 0.0)),
        (Bears::Heel, _) => capture.rigid_point(frame, foot.ankle, levelled_point(foot, foot.heel, 0.0, 0.0)),
    }
}

/// m: how far the point of a foot that bears goes from a frame to another of a contact.
pub fn slip(seen: &Seen, contact: &Contact, start: usize, end: usize) -> f64 {
    let capture = seen.capture();
    let parts = parts(seen, contact);
    let (mut worst, mut from) = (0.0_f64, None);
    for frame in start.max(contact.start)..=end.min(contact.end) {
        let part = parts[frame - contact.start];
        let place = held_point(capture, frame, contact.side, part);
        let (_, first) = *from.get_or_insert((part, place));
        if from.is_some_and(|(was, _)| was != part) {
            from = Some((part, place));
            continue;
        }
        worst = worst.max(DVec2::new(place.x - first.x, place.z - first.z).length());
    }
    worst
}

/// m: where the held foot goes, from where it came down.
fn reference(seen: &Seen, index: usize, hold: &Hold, attempt: usize) -> DVec3 {
    let contact = &seen.feet.contacts[index];
    let foot = &seen.track.feet[contact.side as usize];
    let slide = -hold.shift.last().copied().unwrap_or(DVec3::ZERO);
    let middle = hold.shift.len() / 2;
    let held = foot.place(contact.start + middle) + DVec2::new(hold.shift[middle].x, hold.shift[middle].z);
    let along = |place: DVec2| {
        let way = DVec2::new(slide.x, slide.z);
        ((place - held).dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0)
    };
    let predicted = seen.judged.iter().find(|judged| judged.taken.step.to == index).map(|judged| judged.predicted);
    let most = along(contact.place);
    let share = match (attempt, predicted) {
        (0, Some(predicted)) => along(predicted),
        (2, _) => {
            if most < 0.5 {
                0.0
            } else {
                1.0
            }
        }
        _ => most,
    };
    slide * share
}
