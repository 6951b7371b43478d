//! An articulated run as a clip shows it: the links' poses, tick by tick, with the points still that a foot stands on.
//!
//! [`perform`] runs it; [`contacts`] finds what stands and where, [`hold`] how far the clip is beside the run there and on the way
//! in and out, [`leg`] poses a leg for it, [`drift`] says how far any joint ends up from where it was. Scenario space, SI. Nothing
//! else is changed: what the run does the clip does, falls included.

pub mod contacts;
pub mod drift;
mod hold;
mod joined;
mod landing;
pub mod leg;
mod onward;
mod over;
pub mod perform;
mod walk;

use super::base::{Over, Stood, Walked};
use super::contacts::FootContact;
use crate::maths::curve::sample;
use crate::maths::filter::zero_lag;
use crate::measure::Scuff;
use crate::model::{Body, BodyPose, Side, Terrain};
use crate::stepper::Step;
use crate::whole_body::Anatomy;
use glam::{DQuat, DVec3, DVec4};
use hold::Held;

/// Hz, how fast the body follows what its planted feet are moved by: faster is the contacts' jitter.
const FOLLOWS: f64 = 6.0;
/// N/N: how readily the body is moved along a leg rather than the leg bent; about the square of a millimetre in a metre.
const GIVES: f64 = 1e-2;
/// m and rad that held feet may move any joint by: the rest of the 5 mm and 2 degrees is for the keys, 1.3 mm of it for those of the hands.
const MOST: drift::Drift = drift::Drift { place: 3.7e-3, turn: 1.7 * std::f64::consts::PI / 180.0 };
/// m that a leg may be too short for where its foot is held: half of what a contact that stands still may slip.
const SHORT: f64 = 5e-4;
/// Looks at that in a tick where a hold begins or ends: 2.5 ms apart, closer than the 4 ms in which a leg that straightens passes through
/// the least that inverse kinematics leaves it bent.
const BETWEEN_TICKS: usize = 4;
/// Rounds in which contacts are cut to what the bound allows.
const ROUNDS: usize = 12;

/// What a run is made a clip of.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Who moves.
    pub body: &'a Body,
    /// Its chains.
    pub anatomy: &'a Anatomy,
    /// What it stands on.
    pub terrain: &'a Terrain,
    /// s between poses.
    pub dt: f64,
    /// N s, what pressed on each foot in the tick before each pose, as far as it stands.
    pub pressed: &'a [[f64; 2]],
    /// s, from when to when each foot stood: what it touches in between is scuffed.
    pub stood: &'a [Vec<[f64; 2]>; 2],
    /// The joint that each link turns about.
    pub joints: &'a [usize],
}

/// The run's poses, and what is changed of them.
#[derive(Clone, Debug)]
pub struct Played {
    dt: f64,
    run: Vec<BodyPose>,
    stands: usize, // the last pose of the stand: what comes after is a fall
    joints: Vec<usize>,
    held: [Held; 2],
    shift: Vec<DVec3>, // m, by which the body gives way to its held feet
    scuffs: Vec<Scuff>,
    laid: Option<Laid>,
}

/// The base clip under a run.
#[derive(Clone, Debug)]
enum Laid {
    Stand(Box<over::Laid>),
    Walk(Box<onward::Onward>),
}

impl Played {
    /// Of a run whose poses up to entry `stands` are of who stands, and of who falls after.
    pub fn new(run: &Run, poses: Vec<BodyPose>, stands: usize) -> Played {
        let animated = |joint: &usize| run.body.joints[*joint].animated;
        let none = || Held::new(run.body, Side::Left, run.dt, Vec::new());
        let mut played = Played {
            dt: run.dt,
            run: poses.into_iter().map(|pose| bound(run.body, pose)).collect(),
            stands,
            joints: run.joints.iter().copied().filter(animated).collect(),
            held: [none(), none()],
            shift: vec![DVec3::ZERO; stands + 1],
            scuffs: Vec::new(),
            laid: None,
        };
        let track = |side: Side| contacts::Track::new(run, &played.run[..=stands], side);
        let tracks = [track(Side::Left), track(Side::Right)];
        let mut spans = tracks.each_ref().map(contacts::Track::spans);
        for round in 0..=ROUNDS {
            let holds = [0, 1].map(|side| tracks[side].holds(&spans[side]));
            let [left, right] = holds;
            played.held = [(Side::Left, left), (Side::Right, right)]
                .map(|(side, holds)| Held::new(run.body, side, run.dt, holds));
            played.follow(run);
            for side in 0..2 {
                let mut held = played.held[side].clone();
                held.ease(&|time| played.raw(run, time, side));
                played.held[side] = held;
            }
            let beyond = played.beyond(run);
            if beyond.iter().all(Vec::is_empty) {
                break;
            }
            spans = [0, 1].map(|side| contacts::cut(&spans[side], &beyond[side], 2 + 2 * round));
        }
        played.scuffs = contacts::scuffs(run, &played.held, stands);
        played
    }

    /// The same over the clip that the run started from.
    fn over_stand(mut self, run: &Run, stood: Stood, course: &over::Course) -> Played {
        self.laid = Some(Laid::Stand(Box::new(over::Laid::new(&self, run, stood, course))));
        self
    }

    /// The same over the clip of a walk, in which it was struck and took those steps.
    fn over_walk(mut self, run: &Run, walked: Walked, steps: &[Step], course: (f64, f64, bool)) -> Played {
        let laid = onward::Onward::new(&self, run, walked, steps, course);
        for scuff in &mut self.scuffs {
            let [from, to] = laid.touches(scuff.side);
            (scuff.start, scuff.end) = (scuff.start.max(from), scuff.end.min(to));
        }
        self.scuffs.retain(|scuff| scuff.start < scuff.end);
        self.laid = Some(Laid::Walk(Box::new(laid)));
        self
    }

    /// The clip that it is shown over.
    pub fn over(&self) -> Option<Over> {
        Some(match self.laid.as_ref()? {
            Laid::Stand(laid) => Over::Stand(Box::new(laid.stood().clone())),
            Laid::Walk(laid) => Over::Walk(Box::new(laid.walked().clone())),
        })
    }

    /// s, over a clip that walks: from when to when it is not that clip, and from when to when it is the run alone.
    pub fn away(&self) -> Option<[[f64; 2]; 2]> {
        match &self.laid {
            Some(Laid::Walk(laid)) => Some(laid.away()),
            _ => None,
        }
    }

    /// s, of the last pose.
    pub fn duration(&self) -> f64 {
        (self.run.len() - 1) as f64 * self.dt
    }

    /// Whether it goes on after the stand, as a fall.
    pub fn falls(&self) -> bool {
        self.run.len() > self.stands + 1
    }

    /// m, both ankles at a tick.
    pub fn ankles(&self, body: &Body, index: usize) -> [DVec3; 2] {
        let positions = self.run[index.min(self.run.len() - 1)].positions(body);
        [0, 1].map(|side: usize| positions[body.feet[side].ankle])
    }

    /// The poses of the fall.
    pub fn fallen(&self) -> &[BodyPose] {
        &self.run[self.stands + 1..]
    }

    /// What the feet hold, in order of start, left before right.
    pub fn contacts(&self) -> Vec<FootContact> {
        match &self.laid {
            Some(Laid::Stand(laid)) => return laid.contacts().to_vec(),
            Some(Laid::Walk(laid)) => return laid.contacts().to_vec(),
            None => {}
        }
        let each = Side::BOTH.into_iter().flat_map(|side| self.held[side as usize].contacts(side));
        let mut contacts: Vec<FootContact> = each.collect();
        contacts.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.side.cmp(&b.side)));
        contacts
    }

    /// When a foot bears and holds nothing, in order of start, left before right.
    pub fn scuffs(&self) -> &[Scuff] {
        &self.scuffs
    }

    /// The joints that links turn about and nodes move.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// The run's own pose at a time: a cubic through its ticks.
    pub fn run_at(&self, time: f64) -> BodyPose {
        let last = self.run.len() - 1;
        let place = (time / self.dt).clamp(0.0, last as f64);
        let index = (place.floor() as usize).min(last.saturating_sub(1));
        if place - (index as f64) < 1e-9 {
            return self.run[index].clone();
        }
        let near = [index.saturating_sub(1), index, (index + 1).min(last), (index + 2).min(last)];
        let window = near.map(|index| &self.run[index]);
        let u = place - index as f64;
        let turn = |joint: usize| {
            let here = window[1].turns[joint];
            let near = window.map(|pose| {
                let turn = pose.turns[joint];
                DVec4::from(if turn.dot(here) < 0.0 { -turn } else { turn })
            });
            DQuat::from_vec4(sample(&near, 1.0, 1.0 + u)).normalize()
        };
        BodyPose {
            hips: sample(&window.map(|pose| pose.hips), 1.0, 1.0 + u),
            turns: (0..window[1].turns.len()).map(turn).collect(),
        }
    }

    /// The pose at a time, its planted points still.
    pub fn pose_at(&self, body: &Body, anatomy: &Anatomy, terrain: &Terrain, time: f64) -> BodyPose {
        let pose = self.held_pose(body, anatomy, terrain, time);
        match &self.laid {
            Some(Laid::Stand(laid)) => laid.pose(body, anatomy, &pose, time),
            Some(Laid::Walk(laid)) => laid.pose(body, anatomy, &pose, time),
            None => pose,
        }
    }

    /// The run's pose at a time, its planted points still.
    fn held_pose(&self, body: &Body, anatomy: &Anatomy, terrain: &Terrain, time: f64) -> BodyPose {
        self.held_at(body, anatomy, terrain, time).0
    }

    /// The same, and by how much each leg is too short for what its foot holds then, m.
    fn held_at(&self, body: &Body, anatomy: &Anatomy, terrain: &Terrain, time: f64) -> (BodyPose, [f64; 2]) {
        let mut short = [0.0; 2];
        let mut pose = self.shifted(time);
        let ground = terrain.turn(time);
        let mut positions = Vec::new();
        for side in Side::BOTH {
            let held = &self.held[side as usize];
            if !held.acts(time) {
                continue;
            }
            if positions.is_empty() {
                pose.positions_into(body, &mut positions);
            }
            let now = leg::Foot::of(body, &pose, &positions, side).seen_from(ground);
            let wanted = held.at(&now, time).seen_from(ground.inverse());
            let lacks = leg::reach(body, anatomy, &mut pose, &positions, (side, None), &wanted);
            short[side as usize] = held.holding(time).map_or(0.0, |_| lacks);
        }
        (bound(body, pose), short)
    }

    /// The run's pose where the body has been moved to.
    fn shifted(&self, time: f64) -> BodyPose {
        let mut pose = self.run_at(time);
        pose.hips += sample(&self.shift, self.dt, time);
        pose
    }

    /// A foot of the moved run, in the ground's frame.
    fn raw(&self, run: &Run, time: f64, side: usize) -> leg::Foot {
        let pose = self.shifted(time);
        let positions = pose.positions(run.body);
        leg::Foot::of(run.body, &pose, &positions, Side::BOTH[side]).seen_from(run.terrain.turn(time))
    }

    /// Moves the body along with its held feet, as far as that leaves the legs as long as they were.
    fn follow(&mut self, run: &Run) {
        let mut wanted = vec![DVec3::ZERO; self.stands + 1];
        for (index, wanted) in wanted.iter_mut().enumerate() {
            let time = index as f64 * self.dt;
            if self.held.iter().all(|held| held.holding(time).is_none()) {
                continue;
            }
            let pose = &self.run[index];
            let positions = pose.positions(run.body);
            let ground = run.terrain.turn(time);
            let mut along = Vec::with_capacity(2);
            for side in Side::BOTH {
                let held = &self.held[side as usize];
                if held.holding(time).is_none() {
                    continue;
                }
                let now = leg::Foot::of(run.body, pose, &positions, side).seen_from(ground);
                let moved = ground * (held.at(&now, time).ankle - now.ankle);
                let hip = positions[run.anatomy.legs[side as usize].upper];
                let way = (positions[run.anatomy.legs[side as usize].foot] - hip).normalize_or(DVec3::NEG_Y);
                along.push((way, moved.dot(way)));
            }
            *wanted = least(&along);
        }
        self.shift = zero_lag(&wanted, FOLLOWS, 1.0 / self.dt);
        // A fall is let alone: what is left of the shift goes within the fade of the feet.
        if self.falls() {
            let fades = (hold::FADES / self.dt).round() as usize;
            let last = self.shift.last().copied().unwrap_or_default();
            let fade = |step: usize| last * (1.0 - crate::maths::curve::smooth3(step as f64 / fades as f64));
            self.shift.extend((1..=fades).map(fade));
        }
    }

    /// The entries at which some joint is farther from the run than held feet may take it, or a leg too short for what it holds: for
    /// each foot those of its leg and of the body.
    fn beyond(&self, run: &Run) -> [Vec<usize>; 2] {
        let mut found = [Vec::new(), Vec::new()];
        let legs = Side::BOTH.map(|side| {
            let leg = &run.anatomy.legs[side as usize];
            [leg.upper, leg.lower, leg.foot, leg.toe.unwrap_or(leg.foot)]
        });
        let of = |side: usize| -> Vec<usize> {
            self.joints.iter().copied().filter(|joint| !legs[1 - side].contains(joint)).collect()
        };
        let joints = [of(0), of(1)];
        // Between two ticks, too, where a hold begins or ends: the knee of a leg that is almost straight is the farthest off on its way.
        for piece in 0..=BETWEEN_TICKS * self.stands {
            let (index, time) = (piece / BETWEEN_TICKS, piece as f64 * self.dt / BETWEEN_TICKS as f64);
            if !piece.is_multiple_of(BETWEEN_TICKS) && !self.held.iter().any(|held| held.changes(time)) {
                continue;
            }
            let own = self.run_at(time);
            let (pose, short) = self.held_at(run.body, run.anatomy, run.terrain, time);
            for side in 0..2 {
                let counted = found[side].last() == Some(&index);
                let near = || drift::between(run.body, &joints[side], &own, &pose).within(&MOST);
                if !counted && (short[side] > SHORT || !near()) {
                    found[side].push(index);
                }
            }
        }
        found
    }
}

/// The least shift that goes so far along each of these ways.
fn least(along: &[(DVec3, f64)]) -> DVec3 {
    match along {
        [] => DVec3::ZERO,
        [(way, far)] => *way * (far / (1.0 + GIVES)),
        [(a, far), (b, near), ..] => {
            let (own, across) = (1.0 + GIVES, a.dot(*b));
            let by = own * own - across * across;
            *a * ((far * own - near * across) / by) + *b * ((near * own - far * across) / by)
        }
    }
}

/// A joint that no node moves keeps its parent's turn.
fn bound(body: &Body, mut pose: BodyPose) -> BodyPose {
    for (index, joint) in body.joints.iter().enumerate() {
        if let (false, Some(parent)) = (joint.animated, joint.parent) {
            pose.turns[index] = pose.turns[parent];
        }
    }
    pose
}

#[cfg(test)]
mod tests;
