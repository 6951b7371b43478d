//! A base clip that walks, as a walk that goes on: travel where the clip walks in place, the cycle begun again, feet that hold the ground.
//!
//! Captured and keyed feet slide by millimetres to centimetres while they bear. Here each contact has one place: the foot turns about
//! its heel until it is flat, lies, and turns about its ball until it leaves; what that costs is taken back in the swing. Scenario
//! space, metres, seconds.

use super::{Base, BaseError, BaseFrame};
use crate::audit::contacts::footfalls;
use crate::audit::track::Track;
use crate::bake::contacts::FootContact;
use crate::maths::curve::smooth3;
use crate::maths::quat::yaw_of;
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Capture, Plant, Role, Side};
use crate::whole_body::{Anatomy, FootTarget};
use crate::whole_body::stand::foot_yaw;
use glam::{DQuat, DVec2, DVec3};

/// m/s at a leg of 0.83 m: slower is no walk.
const SLOWEST: f64 = 0.2;
/// Part of the feet's speed under a body by which a body that walks in place moves at most.
const IN_PLACE: f64 = 0.3;
/// m at a leg of 0.83 m: a heel or ball that is farther over the other's floor is up.
const UP: f64 = 0.015;
/// m: soles lower than this over the lowest bear, of a walk in place.
const LOW: f64 = 0.03;
/// s, standard deviations of the smoothing of its travel that are tried.
const EVENED: [f64; 3] = [0.08, 0.2, 0.6];
/// Part of the frames in which no foot is seen to bear, of a walk.
const MOST_FLIGHT: f64 = 0.25;
/// m at a leg of 0.83 m: a foot that is so far from where it lies does not stand there yet, or no more.
const OFF: f64 = 0.05;
/// m, the same of its height.
const OVER: f64 = 0.012;

/// A walk without an end.
#[derive(Clone, Debug)]
pub struct Gait {
    /// Frames a second.
    pub fps: f64,
    /// m/s, mean, (x, z).
    pub velocity: DVec2,
    /// rad, where the pelvis looks, mean.
    pub facing: f64,
    /// s, a cycle of two steps.
    pub period: f64,
    /// m, mean centre of mass over the ground.
    pub com_height: f64,
    /// How far out each leg reaches, in leg lengths.
    pub reach: [f64; 2],
    /// By touchdown.
    pub falls: Vec<Fall>,
    frames: Vec<BaseFrame>,
    feet: [Vec<FootTarget>; 2],
    contacts: Vec<Bears>,
}

/// A foot that bears: s. It lies flat from `flat` to `ball`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "each line says it")]
pub struct Fall {
    pub side: Side,
    pub down: f64,
    pub flat: f64,
    pub ball: f64,
    pub up: f64,
    /// Where it lies.
    pub plant: Plant,
}

/// A foot as a clip has it: ankle, foot and toe.
#[derive(Clone, Copy, Debug)]
struct Posed {
    ankle: DVec3,
    foot: DQuat,
    toe: DQuat,
}

impl Gait {
    /// Of a clip, for so many seconds at least.
    pub fn new(base: &Base, body: &Body, anatomy: &Anatomy, seconds: f64) -> Result<Gait, BaseError> {
        let unfit = |what: String| BaseError::Unfit { name: base.name.clone(), what };
        let size = (body.leg_length / 0.83).max(1e-3);
        // The least smoothing with which the feet are seen to bear.
        let mut best: Option<(usize, Vec<BaseFrame>, f64, Vec<Bears>)> = None;
        for evened in EVENED {
            let travelled =
                travelled(base, body, evened).ok_or_else(|| unfit("has feet that never bear".into()))?;
            let (unrolled, period) = unrolled(base, &travelled, (body, anatomy), seconds);
            for contacts in [seen(base, body, &unrolled), low(body, &unrolled, size)] {
                let flight = (0..unrolled.len()).filter(|frame| !bears(&contacts, *frame)).count();
                let steps = Side::BOTH.map(|side| contacts.iter().filter(|contact| contact.side == side).count());
                let flight = if steps.iter().any(|steps| *steps < 2) { unrolled.len() } else { flight };
                if best.as_ref().is_none_or(|best| flight * 2 < best.0) {
                    best = Some((flight, unrolled.clone(), period, contacts));
                }
            }
        }
        let Some((flight, unrolled, period, mut contacts)) = best else { return Err(BaseError::Empty(base.name.clone())) };
        let last = unrolled.len() - 1;
        if flight == unrolled.len() {
            return Err(unfit("takes too few steps to be a walk".into()));
        }
        if flight as f64 > MOST_FLIGHT * unrolled.len() as f64 {
            return Err(unfit("runs: both feet are off the ground at times".into()));
        }
        bridge(&mut contacts, unrolled.len());
        let seconds = last as f64 / base.fps;
        let way = unrolled[last].com - unrolled[0].com;
        let velocity = DVec2::new(way.x, way.z) / seconds.max(1e-9);
        if velocity.length() < SLOWEST * size.sqrt() {
            return Err(unfit(format!("steps, but goes nowhere ({:.2} m/s)", velocity.length())));
        }
        let frames = unrolled;
        let facing = frames.iter().map(|frame| DVec2::from_angle(yaw_of(frame.pose.turns[0]))).sum::<DVec2>().to_angle();
        // Poses as of a body that faces as this one walks.
        let frames: Vec<BaseFrame> =
            frames.into_iter().map(|frame| BaseFrame::of(body, anatomy, frame.pose, facing)).collect();
        let com_height = frames.iter().map(|frame| frame.com.y).sum::<f64>() / frames.len() as f64;
        let mut at = Vec::new();
        let mut reach = [0.0_f64; 2];
        for frame in &frames {
            frame.pose.positions_into(body, &mut at);
            for side in Side::BOTH {
                let leg = &anatomy.legs[side as usize];
                reach[side as usize] = reach[side as usize].max((at[leg.foot] - at[leg.upper]).length() / leg.length());
            }
        }
        let mut gait = Gait {
            fps: base.fps,
            velocity,
            facing,
            period,
            com_height,
            reach,
            falls: Vec::new(),
            frames,
            feet: Default::default(),
            contacts,
        };
        gait.hold(body, &[0.0]);
        Ok(gait)
    }

    /// Holds the feet that bear; at the times of `exact` (s) they are where the clip has them.
    pub fn hold(&mut self, body: &Body, exact: &[f64]) {
        let last = self.frames.len() - 1;
        let exact: Vec<usize> = exact.iter().map(|time| ((time * self.fps).round().max(0.0) as usize).min(last)).collect();
        let size = (body.leg_length / 0.83).max(1e-3);
        self.falls.clear();
        for side in Side::BOTH {
            let own: Vec<&Bears> = self.contacts.iter().filter(|contact| contact.side == side).collect();
            // The left foot's contacts may have become shorter.
            let fps = self.fps;
            let falls = self.falls.clone();
            let other = |frame: usize| match side {
                Side::Left => {
                    let mut right = self.contacts.iter().filter(|contact| contact.side == Side::Right);
                    right.any(|contact| (contact.start..=contact.end).contains(&frame))
                }
                Side::Right => {
                    let time = frame as f64 / fps;
                    falls.iter().any(|fall: &Fall| fall.down <= time + 1e-9 && time <= fall.up + 1e-9)
                }
            };
            let (targets, held) = hold(body, side, &self.frames, &own, (fps, size), (&exact, &other));
            self.feet[side as usize] = targets;
            self.falls.extend(held);
        }
        self.falls.sort_by(|a, b| a.down.total_cmp(&b.down));
    }

    /// s, of the last frame.
    pub fn end(&self) -> f64 {
        (self.frames.len() - 1) as f64 / self.fps
    }

    fn place(&self, time: f64) -> (usize, usize, f64) {
        let last = self.frames.len() - 1;
        let mut place = (time * self.fps).clamp(0.0, last as f64);
        if (place - place.round()).abs() < 1e-6 {
            place = place.round();
        }
        let first = place.floor() as usize;
        (first, (first + 1).min(last), place - first as f64)
    }

    /// The clip's frame at a time.
    pub fn at(&self, time: f64) -> BaseFrame {
        let (from, to, share) = self.place(time);
        self.frames[from].between(&self.frames[to], share)
    }

    /// A foot then, held while it bears.
    pub fn foot(&self, side: Side, time: f64) -> FootTarget {
        let (from, to, share) = self.place(time);
        let (from, to) = (&self.feet[side as usize][from], &self.feet[side as usize][to]);
        blended(from, to, share)
    }

    /// The foot's last touchdown before a time, and the next one.
    pub fn around(&self, side: Side, time: f64) -> (Option<&Fall>, Option<&Fall>) {
        let own = || self.falls.iter().filter(move |fall| fall.side == side);
        (own().rfind(|fall| fall.down <= time), own().find(|fall| fall.down > time))
    }

    /// Contacts of a foot between two times of the clip's own, moved by `shift` and later by `later` s.
    pub fn contacts(&self, side: Side, from: f64, to: f64, shift: DVec3, later: f64, list: &mut Vec<FootContact>) {
        for fall in self.falls.iter().filter(|fall| fall.side == side) {
            let plant = Plant { ankle: fall.plant.ankle + shift, ..fall.plant };
            let parts = [(Part::Heel, fall.down, fall.flat), (Part::Flat, fall.flat, fall.ball), (Part::Ball, fall.ball, fall.up)];
            for (part, start, end) in parts {
                let (start, end) = (start.max(from), end.min(to));
                if end - start > 1e-4 {
                    list.push(FootContact { side, part, start: start + later, end: end + later, plant });
                }
            }
        }
    }
}

/// Between two targets of a foot.
pub(super) fn blended(from: &FootTarget, to: &FootTarget, share: f64) -> FootTarget {
    if share <= 0.0 {
        return *from;
    }
    FootTarget {
        ankle: from.ankle.lerp(to.ankle, share),
        foot: from.foot.slerp(to.foot, share),
        toe: from.toe.slerp(to.toe, share),
        yaw: from.yaw + crate::maths::quat::wrap_angle(to.yaw - from.yaw) * share,
        soft: from.soft + (to.soft - from.soft) * share,
        bend: if share < 0.5 { from.bend } else { to.bend },
    }
}

/// m, where the clip's body is by each frame that walks in place: what the feet that bear go back by, evened. Zero where it travels by
/// itself; `None` where no foot ever bears.
fn travelled(base: &Base, body: &Body, evened: f64) -> Option<Vec<DVec3>> {
    let frames = base.frames();
    let count = frames.len();
    let point = |frame: &BaseFrame, side: Side, which: usize| {
        let (rear, front) = frame.pose.sole(body, &frame.pose.positions(body), side);
        rear.iter().chain(&front).nth(which).copied().unwrap_or(DVec3::ZERO)
    };
    let lows: Vec<[f64; 2]> = frames.iter().map(|frame| lowest(body, frame)).collect();
    let floor = lows.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let mut steps: Vec<Option<DVec3>> = Vec::with_capacity(count);
    for frame in 1..count {
        let (mut way, mut weight) = (DVec3::ZERO, 0.0);
        for side in Side::BOTH {
            let height = 0.5 * (lows[frame][side as usize] + lows[frame - 1][side as usize]) - floor;
            let bears = (1.0 - height / LOW).max(0.0).powi(2);
            if bears > 0.0 {
                let positions = frames[frame].pose.positions(body);
                let (rear, front) = frames[frame].pose.sole(body, &positions, side);
                let lowest = rear.iter().chain(&front).enumerate().min_by(|a, b| a.1.y.total_cmp(&b.1.y));
                let Some((which, at)) = lowest else { continue };
                way += (*at - point(&frames[frame - 1], side, which)) * bears;
                weight += bears;
            }
        }
        steps.push((weight > 1e-6).then(|| way / weight * DVec3::new(1.0, 0.0, 1.0)));
    }
    let known: Vec<DVec3> = steps.iter().flatten().copied().collect();
    if known.is_empty() {
        return None;
    }
    let mean = known.iter().sum::<DVec3>() / known.len() as f64;
    let seconds = (count - 1).max(1) as f64 / base.fps;
    let way = frames[count - 1].com - frames[0].com;
    let goes = DVec2::new(way.x, way.z).length() / seconds;
    let under = mean.length() * base.fps;
    if under < SLOWEST || goes > IN_PLACE * under {
        return Some(vec![DVec3::ZERO; count]);
    }
    let steps: Vec<DVec3> = steps.into_iter().map(|step| step.unwrap_or(mean)).collect();
    // Evened over a moment: a body has no jolts.
    let sigma = (evened * base.fps).max(1e-3);
    let reach = (3.0 * sigma).ceil() as isize;
    let evened = |at: usize| {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for off in -reach..=reach {
            let weight = (-0.5 * (off as f64 / sigma).powi(2)).exp();
            let index = at as isize + off;
            let last = steps.len() as isize;
            let index = if base.loops { index.rem_euclid(last) } else { index.clamp(0, last - 1) };
            sum += steps[index as usize] * weight;
            total += weight;
        }
        sum / total
    };
    let mut list = vec![DVec3::ZERO; count];
    for frame in 1..count {
        list[frame] = list[frame - 1] - evened(frame - 1);
    }
    Some(list)
}

/// The clip with its travel, begun again as often as is needed: frames, and s of a cycle.
fn unrolled(
    base: &Base,
    travelled: &[DVec3],
    (body, anatomy): (&Body, &Anatomy),
    seconds: f64,
) -> (Vec<BaseFrame>, f64) {
    let mut frames: Vec<BaseFrame> =
        base.frames().iter().zip(travelled).map(|(frame, way)| frame.moved(*way)).collect();
    let (from, to) = if base.loops { (0, frames.len() - 1) } else { cycle(base, &frames, body) };
    let whole = to - from;
    let period = whole as f64 / base.fps;
    let needed = (seconds * base.fps).ceil() as usize + 2;
    if frames.len() >= needed || whole < 3 {
        return (frames, period);
    }
    if !base.loops {
        // What the cycle's end differs by from its start is let go over the cycle, so that it can begin again.
        let (start, end) = (frames[from].pose.clone(), frames[to].pose.clone());
        let off: Vec<DQuat> = end.turns.iter().zip(&start.turns).map(|(end, start)| end.inverse() * *start).collect();
        let rise = start.hips.y - end.hips.y;
        for (index, frame) in frames.iter_mut().enumerate().take(to + 1).skip(from) {
            let share = smooth3((index - from) as f64 / whole as f64);
            let mut pose = frame.pose.clone();
            for (turn, off) in pose.turns.iter_mut().zip(&off) {
                *turn = (*turn * DQuat::IDENTITY.slerp(*off, share)).normalize();
            }
            pose.hips.y += rise * share;
            *frame = BaseFrame::of(body, anatomy, pose, 0.0);
        }
    }
    let way = frames[to].pose.hips - frames[from].pose.hips;
    let level = DVec3::new(way.x, 0.0, way.z);
    let mut list: Vec<BaseFrame> = frames[..to].to_vec();
    let mut rounds = 1.0;
    while list.len() < needed {
        list.extend((from..to).map(|frame| frames[frame].moved(level * rounds)));
        rounds += 1.0;
    }
    (list, period)
}

/// The two frames a cycle apart that are most alike, of a clip that is no loop.
fn cycle(base: &Base, frames: &[BaseFrame], body: &Body) -> (usize, usize) {
    let capture = as_capture(base, body, frames);
    let track = Track::new(&capture);
    let found = footfalls(&track);
    let mut best = (f64::INFINITY, 0, frames.len() - 1);
    for side in Side::BOTH {
        let downs: Vec<usize> =
            found.contacts.iter().filter(|contact| contact.side == side && !contact.cut.0).map(|contact| contact.start).collect();
        for (at, from) in downs.iter().enumerate() {
            for to in &downs[at + 1..] {
                let (one, other) = (&frames[*from].pose, &frames[*to].pose);
                let off: f64 = one.turns.iter().zip(&other.turns).map(|(a, b)| a.angle_between(*b)).sum();
                if off < best.0 {
                    best = (off, *from, *to);
                }
            }
        }
    }
    (best.1, best.2)
}

fn as_capture(base: &Base, body: &Body, frames: &[BaseFrame]) -> Capture {
    Capture {
        name: base.name.clone(),
        fps: base.fps,
        body: body.clone(),
        positions: frames.iter().flat_map(|frame| frame.pose.positions(body)).collect(),
        turns: frames.iter().flat_map(|frame| frame.pose.turns.clone()).collect(),
        units_to_metres: 1.0,
        up: "+Y".into(),
        confidence: 1.0,
        method: String::new(),
        notes: Vec::new(),
        pushes: Vec::new(),
    }
}

/// A foot that bears: first and last frame.
#[derive(Clone, Copy, Debug)]
struct Bears {
    side: Side,
    start: usize,
    end: usize,
}

fn bears(contacts: &[Bears], frame: usize) -> bool {
    contacts.iter().any(|contact| (contact.start..=contact.end).contains(&frame))
}

/// The feet that bear as the audit sees them: they hardly move.
fn seen(base: &Base, body: &Body, frames: &[BaseFrame]) -> Vec<Bears> {
    let capture = as_capture(base, body, frames);
    let found = footfalls(&Track::new(&capture)).contacts;
    found.iter().map(|contact| Bears { side: contact.side, start: contact.start, end: contact.end }).collect()
}

/// The feet that are low, however fast they slide.
fn low(body: &Body, frames: &[BaseFrame], size: f64) -> Vec<Bears> {
    let heights: Vec<[f64; 2]> = frames.iter().map(|frame| lowest(body, frame)).collect();
    let floor = heights.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let mut list = Vec::new();
    for side in Side::BOTH {
        let is_low = |frame: usize| heights[frame][side as usize] - floor < 0.8 * LOW * size.max(0.8);
        let mut frame = 0;
        while frame < frames.len() {
            if !is_low(frame) {
                frame += 1;
                continue;
            }
            let start = frame;
            while frame < frames.len() && is_low(frame) {
                frame += 1;
            }
            if frame - start > 2 {
                list.push(Bears { side, start, end: frame - 1 });
            }
        }
    }
    list.sort_by_key(|contact| (contact.start, contact.side));
    list
}

/// m, the lowest point of each sole.
fn lowest(body: &Body, frame: &BaseFrame) -> [f64; 2] {
    let positions = frame.pose.positions(body);
    Side::BOTH.map(|side| {
        let (rear, front) = frame.pose.sole(body, &positions, side);
        rear.iter().chain(&front).map(|point| point.y).fold(f64::INFINITY, f64::min)
    })
}

/// Closes what few frames no foot is seen to bear in, half by the foot that leaves and half by the one that comes.
fn bridge(contacts: &mut [Bears], frames: usize) {
    let mut frame = 0;
    while frame < frames {
        if bears(contacts, frame) {
            frame += 1;
            continue;
        }
        let from = frame;
        while frame < frames && !bears(contacts, frame) {
            frame += 1;
        }
        let middle = (from + frame) / 2;
        let leaves = contacts.iter().position(|contact| contact.end + 1 == from);
        let comes = contacts.iter().position(|contact| contact.start == frame);
        if let Some(leaves) = leaves {
            contacts[leaves].end = if comes.is_some() { middle } else { frame - 1 };
        }
        if let Some(comes) = comes {
            contacts[comes].start = if leaves.is_some() { middle } else { from };
        }
    }
}

/// A foot's targets, held while it bears, and when it does.
fn hold(
    body: &Body,
    side: Side,
    frames: &[BaseFrame],
    contacts: &[&Bears],
    (fps, size): (f64, f64),
    (exact, other): (&[usize], &dyn Fn(usize) -> bool),
) -> (Vec<FootTarget>, Vec<Fall>) {
    let shape = &body.feet[side as usize];
    let role = if side == Side::Left { Role::LeftFoot } else { Role::RightFoot };
    let ankle = body.joint(role).unwrap_or(shape.ankle);
    let posed: Vec<Posed> = frames
        .iter()
        .map(|frame| {
            let positions = frame.pose.positions(body);
            let foot = frame.pose.turns[ankle];
            let toe = shape.toe.map_or(foot, |toe| frame.pose.turns[toe]);
            Posed { ankle: positions[ankle], foot, toe }
        })
        .collect();
    let to_ball = super::foot::to_ball(body, side);
    let to_heel = shape.heel_point();
    let mut held: Vec<Option<Posed>> = vec![None; posed.len()];
    let mut falls = Vec::new();
    for contact in contacts {
        let (mut first, mut last) = (contact.start, contact.end);
        let heel = |frame: usize| (posed[frame].ankle + posed[frame].foot * to_heel).y;
        let ball = |frame: usize| {
            let at = posed[frame].ankle + posed[frame].foot * to_ball;
            // Over the ball is the sole, lower by what the foot's own shape has.
            at.y - (to_ball_height(body, side))
        };
        let flat_from = (first..=last).find(|frame| ball(*frame) - heel(*frame) < UP * size).unwrap_or(first);
        let flat_to = (flat_from..=last).rfind(|frame| heel(*frame) - ball(*frame) < UP * size).unwrap_or(last);
        let middle = (flat_from + flat_to) / 2;
        let kept = exact.iter().copied().find(|frame| (first..=last).contains(frame));
        let mut lies = posed[kept.map_or(middle, |frame| frame.clamp(flat_from, flat_to))];
        let (from, to) = (posed[flat_from], posed[flat_to]);
        // Where it is not yet, or no more, it does not stand.
        let away = |frame: usize, to_point: DVec3| {
            let off = posed[frame].ankle + posed[frame].foot * to_point - lies.ankle - lies.foot * to_point;
            off.y > OVER * size || (off * DVec3::new(1.0, 0.0, 1.0)).length() > OFF * size
        };
        while first < flat_from && away(first, to_heel) && other(first) {
            first += 1;
        }
        while last > flat_to && away(last, to_ball) && other(last) {
            last -= 1;
        }
        let kept = kept.filter(|frame| (first..=last).contains(frame));
        // What it turns about then is where the clip has it.
        match kept {
            Some(frame) if frame < flat_from => {
                let heel_of = |posed: &Posed| posed.ankle + posed.foot * to_heel;
                lies.ankle += heel_of(&posed[frame]) - heel_of(&lies);
            }
            Some(frame) if frame > flat_to => {
                let ball_of = |posed: &Posed| posed.ankle + posed.foot * to_ball;
                lies.ankle += ball_of(&posed[frame]) - ball_of(&lies);
            }
            _ => {}
        }
        let heel_at = lies.ankle + lies.foot * to_heel;
        let ball_at = lies.ankle + lies.foot * to_ball;
        for frame in first..=last {
            let own = posed[frame];
            held[frame] = Some(if frame < flat_from {
                let foot = (own.foot * from.foot.inverse() * lies.foot).normalize();
                let toe = (own.toe * from.toe.inverse() * lies.toe).normalize();
                Posed { ankle: heel_at - foot * to_heel, foot, toe }
            } else if frame <= flat_to {
                lies
            } else {
                let foot = (own.foot * to.foot.inverse() * lies.foot).normalize();
                Posed { ankle: ball_at - foot * to_ball, foot, toe: lies.toe }
            });
            // A clip whose feet slide by more than can be mended slides on.
            if let Some(held) = &mut held[frame] {
                held.ankle = own.ankle + (held.ankle - own.ankle).clamp_length_max(OFF * size);
            }
        }
        let yaw = foot_yaw(body, side, lies.foot);
        let time = |frame: usize| frame as f64 / fps;
        falls.push(Fall {
            side,
            down: time(first),
            flat: time(flat_from),
            ball: time(flat_to),
            up: time(last),
            plant: Plant::level(DVec3::new(lies.ankle.x, 0.0, lies.ankle.z), yaw),
        });
    }
    // In the air: what the two contacts took is handed over on the way.
    let count = posed.len();
    let mut frame = 0;
    while frame < count {
        if held[frame].is_some() {
            frame += 1;
            continue;
        }
        let begin = frame;
        while frame < count && held[frame].is_none() {
            frame += 1;
        }
        let off = |at: Option<usize>| {
            at.and_then(|at| held[at].map(|held| (at, held))).map(|(at, held)| {
                let own = posed[at];
                (held.ankle - own.ankle, held.foot * own.foot.inverse(), held.toe * own.toe.inverse())
            })
        };
        let before = off(begin.checked_sub(1));
        let after = off((frame < count).then_some(frame));
        let none = (DVec3::ZERO, DQuat::IDENTITY, DQuat::IDENTITY);
        let (from, to) = (before.or(after).unwrap_or(none), after.or(before).unwrap_or(none));
        let kept = exact.iter().copied().find(|exact| (begin..frame).contains(exact));
        for at in begin..frame {
            let along = |from: usize, to: usize| smooth3((at + 1 - from) as f64 / (to + 1 - from).max(1) as f64);
            let (from, to, share) = match kept {
                Some(kept) if at <= kept => (from, none, along(begin, kept)),
                Some(kept) => (none, to, along(kept, frame)),
                None => (from, to, along(begin, frame)),
            };
            let share = if kept == Some(at) { 1.0 } else { share };
            let own = posed[at];
            held[at] = Some(Posed {
                ankle: own.ankle + from.0.lerp(to.0, share),
                foot: (from.1.slerp(to.1, share) * own.foot).normalize(),
                toe: (from.2.slerp(to.2, share) * own.toe).normalize(),
            });
        }
    }
    let target = |held: &Option<Posed>, own: &Posed| {
        let held = held.as_ref().unwrap_or(own);
        FootTarget {
            ankle: held.ankle,
            foot: held.foot,
            toe: held.toe,
            yaw: foot_yaw(body, side, held.foot),
            soft: 0.0,
            bend: None,
        }
    };
    (held.iter().zip(&posed).map(|(held, own)| target(held, own)).collect(), falls)
}

/// m, how far the ball joint is over the sole of a level foot.
fn to_ball_height(body: &Body, side: Side) -> f64 {
    let shape = &body.feet[side as usize];
    let levelled = shape.level * super::foot::to_ball(body, side);
    levelled.y + shape.ankle_height
}

impl BaseFrame {
    /// The same elsewhere.
    fn moved(&self, way: DVec3) -> BaseFrame {
        BaseFrame {
            pose: BodyPose { hips: self.pose.hips + way, turns: self.pose.turns.clone() },
            com: self.com + way,
            base: self.base.clone(),
        }
    }
}
