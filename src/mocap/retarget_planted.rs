//! Where a captured foot bears, and on which part of its sole: a plain test, for holding feet after a retarget.
//!
//! Clip space, m, s, rad. A foot bears while some point of its sole hardly moves and its lowest is near the floor, with hysteresis; its
//! pitch says whether it stands on the heel, the flat sole or the ball. The floor is where most of the slow heights are, of each foot for
//! itself (soles without a mesh are guesses). A foot that bears and yet slides is left alone: it may be meant, or a treadmill's.

use super::retarget_turns::rest_frames;
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::maths::real;
use crate::model::report::Part;
use crate::model::{Body, Capture, Side};
use glam::{DQuat, DVec3};

/// m/s at a leg of 0.83 m: the stillest point of a sole that comes down is slower; faster than the second, it has left.
const SPEED: (f64, f64) = (0.35, 0.6);
/// m: its lowest point is nearer to the floor; farther than the second, it has left.
const NEAR: (f64, f64) = (0.05, 0.08);
/// s: a stance is no shorter, a gap in one no longer.
const SHORTEST: f64 = 0.07;
/// s.
const GAP: f64 = 0.05;
/// m: a stance that slides farther is none.
const SLIDES: f64 = 0.12;
/// rad: a foot that is pitched less stands flat; one that stands flat does so up to the second.
const FLAT: (f64, f64) = (0.1, 0.13);
/// m: a stance that is lower than that over the floor, or under it, stands on it.
const SAME_FLOOR: f64 = 0.06;
/// m: the feet's own floors differ by no more.
const APART: f64 = 0.05;
/// Of the height at which most slow feet are: another that is nearer to y = 0 needs so much to be the floor.
const SUPPORT: f64 = 0.25;
/// m: a sole may sink so much into the ground where a heel's rounding rolls.
const HAIR: f64 = 0.0035;
/// rad: a foot that turns more on the spot turns over its ball.
pub(super) const SWIVELS: f64 = 0.25;

/// A foot on the ground, in frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planted {
    /// Which foot.
    pub side: Side,
    /// First frame.
    pub start: usize,
    /// Last frame, inclusive.
    pub end: usize,
}

/// A stance of the source.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stance {
    /// When, and which foot.
    pub planted: Planted,
    /// (frames of it) what part bears.
    pub parts: Vec<Part>,
    /// m, over the floor.
    pub height: f64,
}

/// What the source's feet do.
#[derive(Clone, Debug)]
pub(super) struct SourceFeet {
    /// m, of each foot.
    pub floor: [f64; 2],
    /// m, (frames) of each foot: its lowest point over the floor.
    pub clearance: [Vec<f64>; 2],
    /// m/s, (frames) of each foot: its stillest point.
    pub still: [Vec<f64>; 2],
    /// By start, left before right.
    pub stances: Vec<Stance>,
    /// Stances that slide and are none.
    pub slides: usize,
}

/// The points of a sole that matter when it moves.
pub(super) struct Sole<'a> {
    body: &'a Body,
    side: Side,
    toe: Option<DVec3>,
    heel: DVec3,
    tip: DVec3,
}

impl<'a> Sole<'a> {
    /// Of a body's foot.
    pub fn of(body: &'a Body, side: Side) -> Sole<'a> {
        let foot = &body.feet[side as usize];
        let toe = foot.toe.map(|toe| body.joints[toe].rest - body.joints[foot.ankle].rest);
        let ahead = foot.forward * foot.tip;
        let tip = foot.level.inverse() * DVec3::new(ahead.x, -foot.ankle_height, ahead.y);
        Sole { body, side, toe, heel: foot.heel_point(), tip }
    }

    /// m, the lowest point against the ankle, of a foot and toes that are turned so.
    pub fn lowest(&self, foot: DQuat, toes: DQuat) -> f64 {
        let shape = &self.body.feet[self.side as usize];
        let rear = shape.rear_sole.iter().map(|vertex| (foot * *vertex).y);
        let front = shape.front_sole.iter().map(|vertex| match self.toe {
            Some(toe) => (foot * toe + toes * (*vertex - toe)).y,
            None => (foot * *vertex).y,
        });
        let lowest = rear.chain(front).fold(f64::INFINITY, f64::min);
        if lowest.is_finite() { lowest } else { -shape.ankle_height }
    }

    /// m, how high the ankle stands over the ground with that part of the sole on it. A heel rolls over its rounding: its point is held
    /// as far as the sole sinks no more than a hair.
    pub fn standing(&self, part: Part, foot: DQuat, toes: DQuat) -> f64 {
        let lowest = -self.lowest(foot, toes);
        let hair = HAIR * self.body.leg_length / 0.83;
        if part == Part::Heel { (-(foot * self.heel).y).max(lowest - hair).min(lowest) } else { lowest }
    }

    /// m, what a foot turns about, against the ankle: the heel, else the toe joint or, without one, the tip.
    pub fn pivot(&self, part: Part, foot: DQuat) -> DVec3 {
        match (part, self.toe) {
            (Part::Heel, _) => foot * self.heel,
            (_, Some(toe)) => foot * toe,
            (_, None) => foot * self.tip,
        }
    }

    /// m, (frames) how far the ankle goes, level, while the foot turns about what it stands on.
    pub fn roll(&self, feet: &[DQuat], parts: &[Part]) -> Vec<DVec3> {
        let mut way = vec![DVec3::ZERO; feet.len()];
        for at in 1..feet.len() {
            let part = if parts[at - 1] == Part::Heel { Part::Heel } else { Part::Ball };
            let step = self.pivot(part, feet[at - 1]) - self.pivot(part, feet[at]);
            way[at] = way[at - 1] + DVec3::new(step.x, 0.0, step.z);
        }
        way
    }
}

/// Reads them. `told`: the stances that somebody else knows better.
pub(super) fn source_feet(capture: &Capture, told: Option<&[Planted]>) -> SourceFeet {
    let body = &capture.body;
    let frames = capture.frames();
    let size = body.leg_length / 0.83;
    let tempo = size.max(0.0).sqrt();
    let reach = ((capture.fps / 60.0).round() as usize).max(1);
    let mut found = SourceFeet {
        floor: [0.0; 2],
        clearance: [vec![], vec![]],
        still: [vec![], vec![]],
        stances: vec![],
        slides: 0,
    };
    for side in Side::BOTH {
        let sole = Sole::of(body, side);
        let shape = &body.feet[side as usize];
        let toe = shape.toe.unwrap_or(shape.ankle);
        let places = |frame: usize| {
            let (at, turns) = (capture.at(frame)[shape.ankle], capture.turns_at(frame));
            let foot = turns[shape.ankle];
            [at + foot * sole.heel, at + sole.pivot(Part::Ball, foot), at + foot * sole.tip]
        };
        for frame in 0..frames {
            let turns = capture.turns_at(frame);
            let low = capture.at(frame)[shape.ankle].y + sole.lowest(turns[shape.ankle], turns[toe]);
            found.clearance[side as usize].push(low);
            let (before, after) = (frame.saturating_sub(reach), (frame + reach).min(frames - 1));
            let seconds = ((after - before) as f64 / capture.fps).max(1e-9);
            let moved = places(before).into_iter().zip(places(after)).map(|(a, b)| a.distance(b) / seconds);
            found.still[side as usize].push(moved.fold(f64::INFINITY, f64::min));
        }
    }
    found.floor = floors(&found, size, tempo);
    for side in Side::BOTH {
        let floor = found.floor[side as usize];
        found.clearance[side as usize].iter_mut().for_each(|low| *low -= floor);
    }
    let spans: Vec<Planted> = match told {
        Some(told) => merged(told),
        None => Side::BOTH.into_iter().flat_map(|side| spans(&found, side, capture.fps, size, tempo)).collect(),
    };
    let frames_at_rest = rest_frames(body);
    for planted in spans {
        if planted.start >= frames {
            continue;
        }
        let planted = Planted { end: planted.end.min(frames - 1), ..planted };
        let stance = stance(capture, &found, planted, &frames_at_rest, size);
        if told.is_none() && slide(capture, &stance) > SLIDES * size {
            found.slides += 1;
        } else {
            found.stances.push(stance);
        }
    }
    found.stances.sort_by_key(|stance| (stance.planted.start, stance.planted.side as usize));
    found
}

/// m: where most of the slow heights of each foot are; of both where one tells too little.
fn floors(found: &SourceFeet, size: f64, tempo: f64) -> [f64; 2] {
    let width = 0.012 * size;
    let slow = |side: usize| -> Vec<f64> {
        let all = found.clearance[side].iter().zip(&found.still[side]);
        all.filter(|(_, still)| **still < SPEED.0 * tempo).map(|(low, _)| *low).collect()
    };
    let each = [slow(0), slow(1)];
    let mut both = each.concat();
    if both.len() < 4 {
        // Feet that never hold still (a treadmill's) are on the ground where they are lowest.
        let lowest = |side: usize| found.clearance[side].iter().copied().fold(f64::INFINITY, f64::min);
        return [lowest(0), lowest(1)].map(|low| if low.is_finite() { low } else { 0.0 });
    }
    both.sort_by(f64::total_cmp);
    let common = mode(&both, width);
    each.map(|mut heights| {
        heights.sort_by(f64::total_cmp);
        let own = if heights.len() * 8 >= both.len() { mode(&heights, width) } else { common };
        if (own - common).abs() < APART * size { own } else { common }
    })
}

/// The value around which most lie, of sorted ones; of lower ones around which many lie, one that is nearer to 0.
fn mode(sorted: &[f64], width: f64) -> f64 {
    let thinned: Vec<f64> = sorted.iter().copied().step_by(sorted.len().div_ceil(2000).max(1)).collect();
    let around = |value: f64| {
        let near = thinned.iter().map(|other| ((other - value).abs(), other)).filter(|(off, _)| *off < width);
        let (weight, sum) = near.fold((0.0, 0.0), |(weight, sum), (off, other)| {
            let share = 1.0 - off / width;
            (weight + share, sum + share * other)
        });
        (weight, sum / f64::max(weight, 1e-12))
    };
    let found: Vec<(f64, f64)> = thinned.iter().map(|value| around(*value)).collect();
    let best = found.iter().copied().fold((0.0, 0.0), |best, next| if next.0 > best.0 + 1e-9 { next } else { best });
    // Feet that hang still in a jump are over the floor, not on it.
    let low = found
        .iter()
        .filter(|(weight, at)| *weight > SUPPORT * best.0 && *at < best.1 && at.abs() + 4.0 * width < best.1.abs());
    low.copied()
        .fold(None, |kept: Option<(f64, f64)>, next| kept.filter(|kept| kept.0 >= next.0).or(Some(next)))
        .unwrap_or(best)
        .1
}

/// Stances that touch made one, by foot and start.
pub(super) fn merged(told: &[Planted]) -> Vec<Planted> {
    let mut all: Vec<Planted> = told.iter().copied().filter(|one| one.start <= one.end).collect();
    all.sort_by_key(|one| (one.side as usize, one.start, one.end));
    all.dedup_by(|next, kept| {
        let touches = next.side == kept.side && next.start <= kept.end.saturating_add(1);
        if touches {
            kept.end = kept.end.max(next.end);
        }
        touches
    });
    all
}

/// When a foot bears.
fn spans(found: &SourceFeet, side: Side, fps: f64, size: f64, tempo: f64) -> Vec<Planted> {
    let (clearance, still) = (&found.clearance[side as usize], &found.still[side as usize]);
    let mut spans: Vec<Planted> = Vec::new();
    let mut open = None;
    for (frame, (clearance, still)) in clearance.iter().zip(still).enumerate() {
        let within = |near: f64, speed: f64| *clearance < near * size && *still < speed * tempo;
        let bears = if open.is_some() { within(NEAR.1, SPEED.1) } else { within(NEAR.0, SPEED.0) };
        match (open, bears) {
            (None, true) => open = Some(frame),
            (Some(start), false) => {
                spans.push(Planted { side, start, end: frame - 1 });
                open = None;
            }
            _ => {}
        }
    }
    spans.extend(open.map(|start| Planted { side, start, end: clearance.len() - 1 }));
    let least = |seconds: f64| (seconds * tempo * fps).round() as usize;
    let mut merged: Vec<Planted> = Vec::new();
    for span in spans {
        match merged.last_mut() {
            Some(last) if span.start - last.end <= least(GAP) + 1 => last.end = span.end,
            _ => merged.push(span),
        }
    }
    let edge = |span: &Planted| span.start == 0 || span.end + 1 == clearance.len();
    merged.retain(|span| span.end - span.start + 1 >= least(SHORTEST).max(2) || edge(span));
    merged
}

/// The parts and the height of a span.
fn stance(capture: &Capture, found: &SourceFeet, planted: Planted, rest: &[DQuat], size: f64) -> Stance {
    let ankle = capture.body.feet[planted.side as usize].ankle;
    let range = planted.start..=planted.end;
    let mut parts: Vec<Part> = Vec::new();
    for frame in range.clone() {
        let ahead = capture.turns_at(frame)[ankle] * rest[ankle] * DVec3::Z;
        let pitch = real::asin(ahead.y.clamp(-1.0, 1.0));
        let flat = if parts.last() == Some(&Part::Flat) { FLAT.1 } else { FLAT.0 };
        parts.push(match pitch {
            pitch if pitch > flat => Part::Heel,
            pitch if pitch < -flat => Part::Ball,
            _ => Part::Flat,
        });
    }
    // One that turns on the spot does so over its ball.
    let mut at = 0;
    while at < parts.len() {
        let run = parts[at..].iter().take_while(|part| **part == parts[at]).count();
        let yaws = (at..at + run).map(|at| yaw_of(capture.turns_at(planted.start + at)[ankle] * rest[ankle]));
        let first = yaw_of(capture.turns_at(planted.start + at)[ankle] * rest[ankle]);
        let (low, high) = yaws
            .map(|yaw| wrap_angle(yaw - first))
            .fold((0.0, 0.0), |(low, high): (f64, f64), yaw| (low.min(yaw), high.max(yaw)));
        if parts[at] == Part::Flat && high - low > SWIVELS {
            parts[at..at + run].fill(Part::Ball);
        }
        at += run;
    }
    let mut heights: Vec<f64> = range.map(|frame| found.clearance[planted.side as usize][frame]).collect();
    heights.sort_by(f64::total_cmp);
    let height = heights.get(heights.len() / 2).copied().unwrap_or(0.0);
    Stance { planted, parts, height: if height.abs() < SAME_FLOOR * size { 0.0 } else { height } }
}

/// m: how far a stance slides beside what its rolling explains.
fn slide(capture: &Capture, stance: &Stance) -> f64 {
    let Planted { side, start, end } = stance.planted;
    let ankle = capture.body.feet[side as usize].ankle;
    let feet: Vec<DQuat> = (start..=end).map(|frame| capture.turns_at(frame)[ankle]).collect();
    let way = Sole::of(&capture.body, side).roll(&feet, &stance.parts);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (frame, way) in (start..=end).zip(way) {
        let at = capture.at(frame)[ankle] - way;
        (low, high) = (low.min(at), high.max(at));
    }
    let slid = high - low;
    real::hypot(slid.x, slid.z)
}
