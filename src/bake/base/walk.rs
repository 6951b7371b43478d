//! A reaction over a base clip that walks. Until the first disturbance the clip plays, its own footfalls and all; then the stepper
//! walks on from the same moment of the gait; once it walks as before, the clip is taken up again, foot by foot, each in its swing.
//!
//! The upper body is the clip's all the way, its time kept to the stepper's footfalls. Scenario space, metres, seconds.

use super::gait::{Fall, Gait, blended};
use super::{Base, BaseError, BaseFrame, FootOffset};
use crate::bake::contacts::FootContact;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::measure::KnownPush;
use crate::model::report::Part;
use crate::model::scenario::Walk;
use crate::model::{Body, Plant, Side};
use crate::sim::{SimulateOptions, Trace};
use crate::stepper::{Step, StepKind};
use crate::whole_body::{Anatomy, BasePose, FootTarget, Neutral};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// s that the stepper walks before it is looked at.
pub(in crate::bake) const WARM: f64 = 6.0;
/// s, by which the moment of its gait may be off for both feet to be where the clip's are.
const OFF_BEAT: f64 = 0.14;
/// 1/s, how fast what the two differ by is let go.
const LETS_GO: f64 = 6.0;
/// s, after the last disturbance, before the clip may be taken up.
const RECOVERS: f64 = 0.6;
/// m at a leg of 0.83 m: a step that differs by less from those before the disturbance is one of the walk.
const SAME_STEP: f64 = 0.07;
/// s, in which a foot that is coming down when the stepper takes over lies as the clip's would.
const SETTLES: f64 = 0.1;
/// s that the stepper is run for beyond the end: the step that is on its way then lands.
pub(in crate::bake) const AFTER: f64 = 3.0;
/// s of gait that are made beyond the clip's end.
const BEYOND: f64 = 6.0;

/// Runs the stepper under pushes; with each, whether its direction is the character's own.
pub type Run<'a> = dyn Fn(&SimulateOptions, &[(KnownPush, bool)]) -> Trace + 'a;

/// A base clip that walks, and how clip and stepper are joined.
#[derive(Clone, Debug)]
pub struct Walked {
    /// The clip.
    pub base: Arc<Base>,
    /// As a walk that goes on.
    pub gait: Gait,
    /// What a reaction is measured from.
    pub neutral: Neutral,
    /// Sentences for a person.
    pub notes: Vec<String>,
    from: f64, // s, the stepper takes over
    pub(super) sides: [Joined; 2],
    pub(super) back: Option<Back>,
    beats: Vec<[f64; 2]>, // s of the baked clip, s of the gait
}

/// One foot's way from the clip to the stepper and back.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Joined {
    offset: Option<FootOffset>, // the clip's from the stepper's when it takes over
    // s, and the same then: of a foot that is coming down when the stepper takes over, once both lie flat.
    settles: Option<(f64, FootOffset)>,
    goes: Option<[f64; 2]>,            // s, the swing in which that is let go
    pub(super) back: Option<[f64; 2]>, // s, the swing in which the clip is taken up
}

/// The clip, taken up again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Back {
    pub(super) later: f64,     // s, the baked clip's time less the gait's
    pub(super) shift: DVec3,   // m
    pub(super) over: [f64; 2], // s, from the first foot's lift to the second one's landing
}

impl Walked {
    /// Measures the clip, for a bake of so many seconds.
    pub fn new(base: Arc<Base>, body: &Body, anatomy: &Anatomy, seconds: f64) -> Result<Walked, BaseError> {
        let gait = Gait::new(&base, body, anatomy, seconds + BEYOND, seconds)?;
        let fastest = 1.8 * (body.leg_length / 0.83).sqrt();
        let speed = gait.velocity.length();
        if speed > fastest * 1.05 {
            let what = format!("goes at {speed:.1} m/s; walks are to {fastest:.1} m/s");
            return Err(BaseError::Unfit { name: base.name.clone(), what });
        }
        let notes = base.notes.clone();
        let neutral = Neutral::new(body, anatomy);
        Ok(Walked {
            base,
            gait,
            neutral,
            notes,
            from: f64::INFINITY,
            sides: Default::default(),
            back: None,
            beats: Vec::new(),
        })
    }

    /// What the stepper is told.
    pub fn lane(&self) -> Walk {
        let velocity = self.gait.velocity;
        Walk {
            start: 0.0,
            duration: None,
            speed: velocity.length(),
            heading: real::atan2(velocity.x, velocity.y),
            facing: Some(self.gait.facing),
        }
    }

    /// s, from when on the stepper's undisturbed walk is like the clip's at the time `from`. `steps`: its own, a long walk's; `dt`: s a tick.
    pub fn beat(&self, from: f64, steps: &[Step], dt: f64) -> f64 {
        let falls = &self.gait.falls;
        let Some(last) = falls.iter().rfind(|fall| fall.down <= from).or(falls.first()) else { return 0.0 };
        let next = falls
            .iter()
            .find(|fall| fall.down > last.down)
            .map_or(last.down + 0.5 * self.gait.period, |fall| fall.down);
        let share = ((from - last.down) / (next - last.down).max(1e-6)).clamp(0.0, 1.0);
        let warm = WARM.max(from + 0.2);
        let pairs = steps.windows(2).find(|pair| pair[0].side == last.side && pair[0].land >= warm);
        let Some([land, after]) = pairs.map(|pair| [pair[0].land, pair[1].land]) else { return 0.0 };
        let nominal = land + (after - land) * share;
        let clip = Side::BOTH.map(|side| self.bears(side, from));
        let agrees =
            |time: f64| Side::BOTH.iter().filter(|side| stands(steps, **side, time) == clip[**side as usize]).count();
        let most = (OFF_BEAT / dt).round() as i64;
        let mut tries: Vec<f64> = (-most..=most).map(|tick| nominal + tick as f64 * dt).collect();
        tries.sort_by(|a, b| (a - nominal).abs().total_cmp(&(b - nominal).abs()));
        let best = tries
            .iter()
            .copied()
            .max_by(|a, b| agrees(*a).cmp(&agrees(*b)).then((b - nominal).abs().total_cmp(&(a - nominal).abs())));
        ((best.unwrap_or(nominal) - from) / dt).round() * dt
    }

    /// The stepper's run that goes on from the clip at the time `from`. `run` runs it under pushes.
    pub fn walk_on(&self, from: f64, options: &SimulateOptions, pushes: &[(KnownPush, bool)], run: &Run) -> Trace {
        let bare = run(&SimulateOptions { duration: WARM.max(from) + 4.0 + self.gait.period, ..*options }, &[]);
        let ago = self.beat(from, &bare.steps, bare.dt);
        let later = |(push, turns): &(KnownPush, bool)| {
            (KnownPush { start: push.start + ago, end: push.end + ago, ..*push }, *turns)
        };
        let pushes: Vec<(KnownPush, bool)> = pushes.iter().map(later).collect();
        let options = SimulateOptions { duration: options.duration + ago + AFTER, ..*options };
        self.cut(&run(&options, &pushes), ago, from)
    }

    fn bears(&self, side: Side, time: f64) -> bool {
        self.bearing(side, time).is_some()
    }

    /// What a foot that bears in the clip then stands on.
    pub fn bearing(&self, side: Side, time: f64) -> Option<Part> {
        let fall = self.gait.around(side, time).0.filter(|fall| fall.up >= time)?;
        Some(match time {
            _ if time < fall.flat => fall.parts[0],
            _ if time < fall.ball => Part::Flat,
            _ => fall.parts[1],
        })
    }

    /// The stepper's run as the clip's: from `ago` s on, where the feet are that bear at the time `from`.
    pub fn cut(&self, trace: &Trace, ago: f64, from: f64) -> Trace {
        let first = (ago / trace.dt).round() as usize;
        let start = Side::BOTH.map(|side| {
            let landed = trace.steps.iter().rfind(|step| step.side == side && step.land <= ago);
            landed.map_or(trace.start[side as usize], |step| step.to)
        });
        let mut cut = Trace {
            ticks: trace.ticks.get(first..).unwrap_or_default().to_vec(),
            steps: trace.steps.iter().filter(|step| step.land > ago).copied().collect(),
            start,
            lost: trace.lost.map(|lost| lost - ago),
            ..trace.clone()
        };
        let later = |step: &mut Step| {
            step.lift -= ago;
            step.land -= ago;
        };
        cut.steps.iter_mut().for_each(later);
        cut.aloft.iter_mut().for_each(later);
        cut.pushes.iter_mut().for_each(|push| push.start -= ago);
        let stance = self.gait.falls.iter().rfind(|fall| fall.down <= from);
        let shift = stance.map_or(DVec3::ZERO, |fall| {
            let plant = plant_at(&cut.start, &cut.steps, fall.side, from);
            (fall.plant.ankle - plant.ankle) * DVec3::new(1.0, 0.0, 1.0)
        });
        let flat = DVec2::new(shift.x, shift.z);
        for tick in &mut cut.ticks {
            tick.com += shift;
            tick.xi += flat;
            tick.cop += flat;
            tick.feet.iter_mut().for_each(|foot| foot.ankle += shift);
        }
        cut.start.iter_mut().for_each(|plant| plant.ankle += shift);
        for step in cut.steps.iter_mut().chain(&mut cut.aloft) {
            step.from.ankle += shift;
            step.to.ankle += shift;
        }
        cut
    }

    /// Plans the way back: the step with which the clip is taken up, and the one after it as the clip has it. `busy`: s, when the last
    /// disturbance is over; `end`: s of the bake.
    pub fn plan(&mut self, steps: &mut Vec<Step>, spans: (f64, f64, f64), body: &Body) {
        self.way_back(steps, spans, body.leg_length / 0.83);
        self.note_swings(steps);
        self.gait.hold(body, &[0.0, self.beat_at(spans.2)]);
    }

    fn way_back(&mut self, steps: &mut Vec<Step>, (from, busy, end): (f64, f64, f64), size: f64) {
        self.from = from;
        self.beats = vec![[0.0, 0.0], [from, from]];
        let mut next = self.gait.falls.iter().position(|fall| fall.down > from).unwrap_or(0);
        let usual = |side: Side| {
            let before = steps.windows(2).rfind(|pair| pair[1].side == side && pair[1].land <= from);
            before.map(|pair| pair[1].to.ankle - pair[0].to.ankle)
        };
        let usual = Side::BOTH.map(usual);
        let size = size.max(1e-3);
        for index in 0..steps.len() {
            let step = steps[index];
            if step.land <= from {
                continue;
            }
            let Some(fall) = self.gait.falls.get(next).copied() else { break };
            if fall.side != step.side {
                continue;
            }
            if step.land > self.beats[self.beats.len() - 1][0] {
                self.beats.push([step.land, fall.down]);
            }
            next += 1;
            let regular = index > 0
                && step.kind == StepKind::Walk
                && steps[index - 1].kind == StepKind::Walk
                && step.lift > busy + RECOVERS
                && usual[step.side as usize].is_none_or(|usual| {
                    (step.to.ankle - steps[index - 1].to.ankle - usual).length() < SAME_STEP * size
                });
            if regular && self.take_up(steps, index, &fall, end) {
                return;
            }
        }
        if busy < end - 0.1 && !self.ends_in_clip(end) {
            self.notes.push(
                "the clip ends before it is back in the base clip's walk: give the scenario more duration".into(),
            );
        }
    }

    fn take_up(&mut self, steps: &mut Vec<Step>, index: usize, fall: &Fall, end: f64) -> bool {
        let step = steps[index];
        // A little sooner, for the end to be one of the clip's frames.
        let place = (end - step.land + fall.down) * self.gait.fps;
        let sooner = ((place - 1e-6).ceil() - place) / self.gait.fps;
        let (later, other) = (step.land - fall.down - sooner, step.side.other());
        let (stood, lands) = self.gait.around(other, fall.down);
        let (Some(stood), Some(lands)) = (stood.copied(), lands.copied()) else { return false };
        let shift = (step.to.ankle - fall.plant.ankle) * DVec3::new(1.0, 0.0, 1.0);
        let lift = (stood.up + later).max(step.land + 0.02);
        let land = lands.down + later;
        let Some(after) = steps.get(index + 1).copied().filter(|after| after.side == other) else { return false };
        if land > end || land - lift < 0.1 {
            return false;
        }
        let to = Plant { ankle: lands.plant.ankle + shift, ..lands.plant };
        steps.truncate(index + 1);
        steps[index].to.yaw = fall.plant.yaw;
        if let Some(beat) = self.beats.last_mut().filter(|beat| beat[0] == step.land) {
            beat[1] = step.land - later;
        }
        steps.push(Step { lift, land, to, ..after });
        self.back = Some(Back { later, shift, over: [step.lift, land] });
        true
    }

    /// Joins the feet: `curve` is the stepper's foot at a time.
    pub fn join(&mut self, body: &Body, curve: &dyn Fn(Side, f64) -> FootTarget) {
        for side in Side::BOTH {
            let offset = FootOffset::between(body, side, &curve(side, self.from), &self.gait.foot(side, self.from));
            let joined = &mut self.sides[side as usize];
            joined.offset = Some(offset);
            let fall = self.gait.around(side, self.from).0.filter(|fall| fall.up >= self.from && self.from < fall.flat);
            let flat = fall.map(|fall| (fall.flat + 0.02).max(self.from + SETTLES).min(fall.ball.max(fall.flat)));
            let stays = |time: &f64| *time > self.from + 0.02 && joined.goes.is_none_or(|goes| goes[0] > *time);
            joined.settles = flat.filter(stays).map(|time| {
                let (own, clip) = (curve(side, time), self.gait.foot(side, time));
                (time, FootOffset::between(body, side, &own, &clip))
            });
        }
    }

    /// Notes the swings in which each foot leaves the clip and comes back to it.
    fn note_swings(&mut self, steps: &[Step]) {
        for side in Side::BOTH {
            let first = steps.iter().find(|step| step.side == side && step.land > self.from);
            let last = steps.iter().rfind(|step| step.side == side);
            self.sides[side as usize] = Joined {
                offset: None,
                settles: None,
                goes: first.map(|step| [step.lift.max(self.from), step.land]),
                back: self.back.and(last).map(|step| [step.lift, step.land]),
            };
        }
    }

    /// A foot of the baked clip; `curve`: the stepper's then.
    pub fn foot(&self, side: Side, time: f64, curve: &FootTarget) -> FootTarget {
        if time <= self.from {
            return self.gait.foot(side, time);
        }
        let joined = &self.sides[side as usize];
        let left = joined.goes.map_or(1.0, |goes| 1.0 - smooth3((time - goes[0]) / (goes[1] - goes[0]).max(1e-6)));
        let mut target = joined.offset.map_or(*curve, |offset| offset.on(curve, left));
        if let Some((flat, offset)) = joined.settles {
            target = blended(&target, &offset.on(curve, left), smooth3((time - self.from) / (flat - self.from)));
        }
        match (joined.back, self.back) {
            (Some([lift, land]), Some(back)) if time > lift => {
                let clip = self.gait.foot(side, time - back.later);
                let clip = FootTarget { ankle: clip.ankle + back.shift, ..clip };
                if time >= land { clip } else { blended(&target, &clip, smooth3((time - lift) / (land - lift))) }
            }
            _ => target,
        }
    }

    /// Is that foot the clip's then?
    pub fn is_clips(&self, side: Side, time: f64) -> bool {
        let back = self.sides[side as usize].back;
        time <= self.from || back.is_some_and(|back| time >= back[1])
    }

    /// Does a foot of the clip's bear then?
    pub fn clip_bears(&self, side: Side, time: f64) -> bool {
        let own = if time <= self.from { time } else { self.beat_at(time) };
        self.bears(side, own)
    }

    /// A foot's contacts: the clip's, the stepper's (`own`), and the clip's again.
    pub fn contacts(&self, side: Side, own: &[FootContact], end: f64) -> Vec<FootContact> {
        let mut list = Vec::new();
        let mut first = Vec::new();
        self.gait.contacts(side, 0.0, self.from.min(end), DVec3::ZERO, 0.0, &mut first);
        let back = self.sides[side as usize].back;
        let until = back.map_or(end, |back| back[0]);
        let middle = own.iter().filter(|contact| contact.end > self.from && contact.start < until);
        let middle = middle.map(|contact| FootContact {
            start: contact.start.max(self.from),
            end: contact.end.min(until),
            ..*contact
        });
        list.append(&mut first);
        for contact in middle {
            match list.last_mut() {
                // It goes on standing as it stood.
                Some(last) if (contact.start - last.end).abs() < 1e-6 && last.part == contact.part => {
                    last.end = contact.end
                }
                // A heel that the clip has up already stays up.
                Some(last) if (contact.start - last.end).abs() < 1e-6 && last.part == Part::Ball => {
                    last.end = contact.end
                }
                _ => list.push(contact),
            }
        }
        self.contacts_again(side, end, &mut list);
        list
    }

    /// Those of the clip that is taken up again.
    pub fn contacts_again(&self, side: Side, end: f64, list: &mut Vec<FootContact>) {
        if let (Some([_, land]), Some(taken)) = (self.sides[side as usize].back, self.back) {
            let clip = [land - taken.later - 1e-3, end - taken.later];
            self.gait.contacts(side, clip[0], clip[1], taken.shift, taken.later, list);
        }
    }

    /// s of the gait at a time of the baked clip.
    pub fn beat_at(&self, time: f64) -> f64 {
        let at = self.beats.partition_point(|beat| beat[0] <= time);
        match (at.checked_sub(1).map(|before| self.beats[before]), self.beats.get(at)) {
            (Some(from), Some(to)) => from[1] + (to[1] - from[1]) * (time - from[0]) / (to[0] - from[0]).max(1e-9),
            (Some(from), None) => from[1] + time - from[0],
            (None, _) => time,
        }
    }

    /// What is laid under the reaction at a time.
    pub fn pose(&self, time: f64) -> BasePose {
        self.gait.at(self.beat_at(time)).base
    }

    /// The clip's own frame at a time.
    pub fn frame(&self, time: f64) -> BaseFrame {
        self.gait.at(self.beat_at(time))
    }

    /// How much of the stepper's motion is left: 1, and 0 once the clip is taken up again.
    pub fn left_over(&self, time: f64) -> f64 {
        self.back.map_or(1.0, |back| 1.0 - smooth3((time - back.over[0]) / (back.over[1] - back.over[0])))
    }

    /// Is that the clip's own frame again, `end` s being the bake's last? An undisturbed walk never left it.
    pub fn ends_in_clip(&self, end: f64) -> bool {
        self.back.is_some() || self.from >= end - 1e-6
    }

    /// How much of the motion is the stepper's own, 0..1.
    pub fn own(&self, time: f64) -> f64 {
        smooth3((time - self.from) / 0.3) * self.left_over(time)
    }

    /// How much of a reaction shows: none before it is disturbed.
    pub fn shows(&self, time: f64) -> f64 {
        smooth3((time - self.from) / 0.15) * self.left_over(time)
    }

    /// The centre of mass's path: the clip's, the stepper's (`com`, every `dt` s), the clip's again.
    pub fn path(&self, com: &[DVec3], dt: f64) -> Vec<DVec3> {
        let clip = |time: f64| self.gait.at(time).com;
        let at = ((self.from / dt).round() as usize).min(com.len().saturating_sub(2));
        let from = at as f64 * dt;
        let off = clip(from) - com[at];
        let speed = (clip(from) - clip(from - dt) - (com[at + 1] - com[at])) / dt;
        com.iter()
            .enumerate()
            .map(|(index, com)| {
                let time = index as f64 * dt;
                if time <= self.from {
                    return clip(time);
                }
                let since = time - from;
                let gone = real::exp(-LETS_GO * since);
                let own = *com + (off + (speed + off * LETS_GO) * since) * gone;
                match self.back {
                    Some(back) => {
                        let left = self.left_over(time);
                        own * left + (clip(time - back.later) + back.shift) * (1.0 - left)
                    }
                    None => own,
                }
            })
            .collect()
    }
}

/// Does a foot stand at a time?
fn stands(steps: &[Step], side: Side, time: f64) -> bool {
    !steps.iter().any(|step| step.side == side && step.lift < time && time < step.land)
}

fn plant_at(start: &[Plant; 2], steps: &[Step], side: Side, time: f64) -> Plant {
    steps
        .iter()
        .rfind(|step| step.side == side && step.land <= time + 1e-6)
        .map_or(start[side as usize], |step| step.to)
}
