//! A base clip that walks, as a walk that goes on: travel where the clip walks in place, the cycle begun again, feet that hold the ground.
//!
//! Captured and keyed feet slide by millimetres to centimetres while they bear. Here each contact has one place: the foot turns about
//! its heel until it is flat, lies, and turns about its ball until it leaves; what that costs is taken back in the swing. Scenario
//! space, metres, seconds.

use super::{Base, BaseError, BaseFrame};
use crate::audit::contacts::{Contact, footfalls};
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
/// m: soles lower than this bear, of a walk in place.
const LOW: f64 = 0.03;

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
        let travelled = travelled(base, body).ok_or_else(|| unfit("has feet that never bear".into()))?;
        let (unrolled, period) = unrolled(base, &travelled, (body, anatomy), seconds);
        let capture = as_capture(base, body, &unrolled);
        let track = Track::new(&capture);
        let found = footfalls(&track);
        let last = unrolled.len() - 1;
        if Side::BOTH.iter().any(|side| found.contacts.iter().filter(|contact| contact.side == *side).count() < 2) {
            return Err(unfit("takes too few steps to be a walk".into()));
        }
        let flight = (0..unrolled.len()).filter(|frame| found.bearing(*frame) == 0).count();
        if flight as f64 > 0.04 * unrolled.len() as f64 {
            return Err(unfit("runs: both feet are off the ground at times".into()));
        }
        let seconds = last as f64 / base.fps;
        let way = unrolled[last].com - unrolled[0].com;
        let velocity = DVec2::new(way.x, way.z) / seconds.max(1e-9);
        if velocity.length() < SLOWEST * size.sqrt() {
            return Err(unfit(format!("steps, but goes nowhere ({:.2} m/s)", velocity.length())));
        }
        let frames = unrolled;
        let mut feet: [Vec<FootTarget>; 2] = Default::default();
        let mut falls = Vec::new();
        for side in Side::BOTH {
            let own: Vec<&Contact> = found.contacts.iter().filter(|contact| contact.side == side).collect();
            let (targets, held) = hold(body, side, &frames, &own, base.fps, size);
            feet[side as usize] = targets;
            falls.extend(held);
        }
        falls.sort_by(|a, b| a.down.total_cmp(&b.down));
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
        Ok(Gait { fps: base.fps, velocity, facing, period, com_height, reach, falls, frames, feet })
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

/// m a frame, where the clip's body goes that walks in place: what the lower foot goes back by. Zero where it travels by itself.
fn travelled(base: &Base, body: &Body) -> Option<Vec<DVec3>> {
    let frames = base.frames();
    let count = frames.len();
    let positions: Vec<Vec<DVec3>> = frames.iter().map(|frame| frame.pose.positions(body)).collect();
    let level = |frame: usize| {
        let own = positions[frame].clone();
        Side::BOTH.map(|side| {
            let (rear, front) = frames[frame].pose.sole(body, &own, side);
            let low = rear.iter().chain(&front).map(|point| point.y).fold(f64::INFINITY, f64::min);
            let foot = &body.feet[side as usize];
            let ball = foot.toe.map_or(own[foot.ankle], |toe| own[toe]);
            (low, ball)
        })
    };
    let levels: Vec<[(f64, DVec3); 2]> = (0..count).map(level).collect();
    let mut speeds: Vec<DVec2> = Vec::new();
    for frame in 1..count {
        let lower = if levels[frame][0].0 + levels[frame - 1][0].0 < levels[frame][1].0 + levels[frame - 1][1].0 { 0 } else { 1 };
        if levels[frame][lower].0 < LOW && levels[frame - 1][lower].0 < LOW {
            let way = levels[frame][lower].1 - levels[frame - 1][lower].1;
            speeds.push(DVec2::new(way.x, way.z) * base.fps);
        }
    }
    if speeds.is_empty() {
        return None;
    }
    let median = |pick: fn(&DVec2) -> f64| {
        let mut values: Vec<f64> = speeds.iter().map(pick).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let under = DVec2::new(median(|speed| speed.x), median(|speed| speed.y));
    let seconds = (count - 1).max(1) as f64 / base.fps;
    let way = frames[count - 1].com - frames[0].com;
    let goes = DVec2::new(way.x, way.z).length() / seconds;
    let walks_in_place = under.length() > 0.2 && goes < IN_PLACE * under.length();
    let step = if walks_in_place { -under / base.fps } else { DVec2::ZERO };
    Some((0..count).map(|frame| DVec3::new(step.x, 0.0, step.y) * frame as f64).collect())
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

/// A foot's targets, held while it bears, and when it does.
fn hold(
    body: &Body,
    side: Side,
    frames: &[BaseFrame],
    contacts: &[&Contact],
    fps: f64,
    size: f64,
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
        let (first, last) = (contact.start, contact.end);
        let heel = |frame: usize| (posed[frame].ankle + posed[frame].foot * to_heel).y;
        let ball = |frame: usize| {
            let at = posed[frame].ankle + posed[frame].foot * to_ball;
            // Over the ball is the sole, lower by what the foot's own shape has.
            at.y - (to_ball_height(body, side))
        };
        let flat_from = (first..=last).find(|frame| ball(*frame) - heel(*frame) < UP * size).unwrap_or(first);
        let flat_to = (flat_from..=last).rfind(|frame| heel(*frame) - ball(*frame) < UP * size).unwrap_or(last);
        let middle = (flat_from + flat_to) / 2;
        // What the clip starts in is kept.
        let anchor = if first == 0 { flat_from } else { middle };
        let lies = posed[anchor];
        let (from, to) = (posed[flat_from], posed[flat_to]);
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
        for at in begin..frame {
            let share = smooth3((at + 1 - begin) as f64 / (frame + 1 - begin) as f64);
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
