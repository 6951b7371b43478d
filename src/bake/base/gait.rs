//! A base clip that walks, as a walk that goes on: travel where the clip walks in place, the cycle begun again, feet that hold the ground.
//!
//! [`super::cycle`] makes it travel and go on, [`super::bearing`] sees which feet bear, [`super::hold`] holds them. Scenario space,
//! metres, seconds.

use super::bearing::{Bears, as_capture, bears, bridge, low, seen};
use super::cycle::{resampled, travelled, unrolled};
use super::hold::{hold, strays};
use super::turning::turning;
use super::{Base, BaseError, BaseFrame};
use crate::audit::track::Track;
use crate::bake::contacts::FootContact;
use crate::maths::quat::yaw_of;
use crate::maths::real;
use crate::measure::GRAVITY;
use crate::model::report::Part;
use crate::model::{Body, Plant, Role, Side};
use crate::whole_body::{Anatomy, FootTarget};
use glam::{DVec2, DVec3};

/// m/s at a leg of 0.83 m: slower is no walk.
pub(super) const SLOWEST: f64 = 0.2;
/// s, standard deviations of the smoothing of its travel that are tried.
const EVENED: [f64; 3] = [0.08, 0.2, 0.6];
/// m/s², RMS: a body that travels so unevenly costs as much as
const JOLTS: f64 = 3.0;
/// feet that stray by that much of the leg, mean, from where the clip has them.
const STRAYS: f64 = 0.1;
/// Part of the leg: feet that stray by more do not walk.
const MOST_STRAYS: f64 = 0.25;
/// Of gravity: a body that sinks with more falls,
const FALLS: f64 = 0.75;
/// and one that does in more than that part of the frames jumps.
const MOST_FALLING: f64 = 0.15;
/// Cosine of the trunk's lean, mean: a body that leans more does not walk.
const UPRIGHT: f64 = 0.5;
/// Part of the frames in which no foot is seen to bear, of a walk.
const MOST_FLIGHT: f64 = 0.25;

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
    /// m, RMS: how far its feet are held from where the clip has them while they bear.
    pub strays: f64,
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
    /// What it stands on before it is flat, and after.
    pub parts: [Part; 2],
    /// Where it lies.
    pub plant: Plant,
}

/// A way to see a clip as a walk.
struct Seen {
    cost: f64,
    aloft: f64,  // part of the frames
    strays: f64, // m, RMS
    frames: Vec<BaseFrame>,
    fps: f64,
    period: f64,
    contacts: Vec<Bears>,
}

impl Gait {
    /// Of a clip, for so many seconds at least. `ends` (s) is to be one of its frames.
    pub fn new(base: &Base, body: &Body, anatomy: &Anatomy, seconds: f64, ends: f64) -> Result<Gait, BaseError> {
        let unfit = |what: String| BaseError::Unfit { name: base.name.clone(), what };
        let size = (body.leg_length / 0.83).max(1e-3);
        // Of all ways to see it, the one in which the feet that bear leave the clip's the least, and the body travels evenly.
        let mut best: Option<Seen> = None;
        let turns = turning(body, base.frames(), size);
        let ways = EVENED.into_iter().flat_map(|evened| [(evened, None), (evened, Some(turns.as_slice()))]);
        for (evened, told) in ways.filter(|(_, told)| told.is_none_or(|told| !told.is_empty())) {
            let travelled =
                travelled(base, body, evened, told).ok_or_else(|| unfit("has feet that never bear".into()))?;
            let (unrolled, period) = unrolled(base, &travelled, (body, anatomy), seconds);
            let (unrolled, fps) = on_frames(unrolled, base.fps, ends);
            let contacts = match told {
                Some(_) => vec![turning(body, &unrolled, size)],
                None => vec![seen(base, body, &unrolled), low(body, &unrolled, size)],
            };
            let uneven = jolts(base, &travelled) / JOLTS / size.sqrt();
            for contacts in contacts {
                let flight = (0..unrolled.len()).filter(|frame| !bears(&contacts, *frame)).count();
                let steps = Side::BOTH.map(|side| contacts.iter().filter(|contact| contact.side == side).count());
                if steps.iter().any(|steps| *steps < 2) {
                    continue;
                }
                let strays = strays(body, (&unrolled, fps), &contacts);
                let aloft = flight as f64 / unrolled.len() as f64;
                let cost = 4.0 * aloft + strays / (STRAYS * body.leg_length) + uneven;
                if best.as_ref().is_none_or(|best| cost < best.cost) {
                    best = Some(Seen { cost, aloft, strays, frames: unrolled.clone(), fps, period, contacts });
                }
            }
        }
        let Some(Seen { aloft, strays, frames: unrolled, fps, period, mut contacts, .. }) = best else {
            return Err(unfit("takes too few steps to be a walk".into()));
        };
        let last = unrolled.len() - 1;
        if aloft > MOST_FLIGHT {
            return Err(unfit("runs: both feet are off the ground at times".into()));
        }
        let falls = Track::new(&as_capture(base, body, base.frames())).acceleration;
        if falls.iter().filter(|rate| rate.y < -FALLS * GRAVITY).count() as f64 > MOST_FALLING * falls.len() as f64 {
            return Err(unfit("jumps: it falls freely at times".into()));
        }
        if strays > MOST_STRAYS * body.leg_length {
            return Err(unfit(format!("slides on feet that bear ({:.0} cm)", strays * 100.0)));
        }
        let upright = unrolled.iter().map(|frame| upright(body, frame)).sum::<f64>() / unrolled.len() as f64;
        if upright < UPRIGHT {
            return Err(unfit(format!(
                "lies ({:.0} degrees off upright)",
                real::acos(upright.clamp(-1.0, 1.0)).to_degrees()
            )));
        }
        bridge(&mut contacts, unrolled.len());
        let seconds = last as f64 / fps;
        let way = unrolled[last].com - unrolled[0].com;
        let velocity = DVec2::new(way.x, way.z) / seconds.max(1e-9);
        if velocity.length() < SLOWEST * size.sqrt() {
            return Err(unfit(format!("steps, but goes nowhere ({:.2} m/s)", velocity.length())));
        }
        let frames = unrolled;
        let facing =
            frames.iter().map(|frame| DVec2::from_angle(yaw_of(frame.pose.turns[0]))).sum::<DVec2>().to_angle();
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
            fps,
            velocity,
            facing,
            period,
            com_height,
            strays,
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
        let exact: Vec<usize> =
            exact.iter().map(|time| ((time * self.fps).round().max(0.0) as usize).min(last)).collect();
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
            let parts = [
                (fall.parts[0], fall.down, fall.flat),
                (Part::Flat, fall.flat, fall.ball),
                (fall.parts[1], fall.ball, fall.up),
            ];
            for (part, start, end) in parts {
                let (start, end) = (start.max(from), end.min(to));
                if end - start > 1e-4 {
                    list.push(FootContact { side, part, start: start + later, end: end + later, plant });
                }
            }
        }
    }
}

/// Cosine of how far the trunk leans.
fn upright(body: &Body, frame: &BaseFrame) -> f64 {
    let positions = frame.pose.positions(body);
    let head = body.joint(Role::Head).map_or(frame.com, |head| positions[head]);
    (head - frame.pose.hips).try_normalize().map_or(1.0, |up| up.y)
}

/// The frames at a rate, near their own, at which that time (s) is a frame.
fn on_frames(frames: Vec<BaseFrame>, fps: f64, ends: f64) -> (Vec<BaseFrame>, f64) {
    let place = ends * fps;
    if place < 1.0 || (place - place.round()).abs() < 1e-6 {
        return (frames, fps);
    }
    let rate = place.ceil() / ends;
    (resampled(&frames, fps, rate), rate)
}

/// m/s², RMS of a travel's acceleration.
fn jolts(base: &Base, travelled: &[DVec3]) -> f64 {
    let squares = travelled.windows(3).map(|three| (three[0] - 2.0 * three[1] + three[2]).length_squared());
    (squares.sum::<f64>() / travelled.len().max(1) as f64).sqrt() * base.fps * base.fps
}

/// Between two targets of a foot.
pub(in crate::bake) fn blended(from: &FootTarget, to: &FootTarget, share: f64) -> FootTarget {
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
        swivel: from.swivel + (to.swivel - from.swivel) * share,
    }
}
