//! What is true of a motion: slip, penetration, ZMP, residual wrench, pops. One definition for bake, audit and tests.
//!
//! Scenario space, SI units, f64. A [`Motion`] is sampled uniformly, four samples a frame of the clip, from the keys
//! that a reader will get; the contacts it claims and the pushes it was given come beside it. [`measure`] gives every
//! finding, [`plausibility()`] the part of them that a baked clip says about itself.

pub mod alike;
pub mod dynamics;
pub mod feet;
#[cfg(test)]
pub(crate) mod fixture;
pub mod gait;
pub mod gate;
pub mod ground;
pub mod hover;
pub mod joints;
pub mod legs;
pub mod moving;
mod notes;
pub mod outcome;
pub mod plausibility;
#[cfg(test)]
mod plausibility_tests;
pub mod pops;
pub mod residual;
pub mod score;
pub mod scuff;
pub mod speed;
pub mod stance;
pub mod support;
pub mod zmp;

pub use gate::{Hindrance, gate};
pub use outcome::{Balance, balance};
pub use plausibility::{Findings, Setting, measure, measure_in, measure_on, plausibility};
pub use scuff::Scuff;
pub use speed::SpeedGain;

use crate::model::{Body, BodyPose, Load, Side, Terrain, report::Part};
use glam::{DQuat, DVec3};

/// m/s²; gravity points along -Y.
pub const GRAVITY: f64 = 9.81;

/// m/s, speed of the centre of mass above which the body moves.
pub const MOVING_SPEED: f64 = 0.05;

/// A motion to measure: poses at 0, 1/hz, 2/hz, ...
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// What moves.
    pub body: &'a Body,
    /// Samples a second: `per_frame` times the clip's frame rate.
    pub hz: f64,
    /// Samples a frame of the clip, 4 by the measures' definition. Pops are looked for from frame to frame.
    pub per_frame: usize,
    /// The samples.
    pub poses: &'a [BodyPose],
}

/// What a contact is still relative to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// The world.
    #[default]
    World,
    /// The platform: the ground frame, which turns about the origin as [`Terrain::turn`] says.
    Platform,
}

impl Frame {
    /// The frame of what stands on a ground.
    pub fn of(terrain: &Terrain) -> Frame {
        if terrain.moves() { Frame::Platform } else { Frame::World }
    }

    /// As the report spells it.
    pub fn name(self) -> &'static str {
        match self {
            Frame::World => "world",
            Frame::Platform => "platform",
        }
    }
}

/// A contact that the motion claims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldContact {
    /// Which foot.
    pub side: Side,
    /// Which part of its sole holds.
    pub part: Part,
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// m, a point of the ground plane under the foot, in `frame`.
    pub point: DVec3,
    /// The plane's unit normal, in `frame`.
    pub normal: DVec3,
    /// What it is still relative to.
    pub frame: Frame,
}

/// A known outside force, constant from start to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownPush {
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// N.
    pub force: DVec3,
    /// Where it acts.
    pub at: PushPoint,
}

/// Where a push acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PushPoint {
    /// At the centre of mass: it has no moment.
    Centre,
    /// At that joint of the body, wherever it is.
    Joint(usize),
    /// At a point of a joint's segment: offset from the joint at rest, m.
    Segment(usize, DVec3),
    /// At a point of scenario space, m.
    World(DVec3),
}

impl Motion<'_> {
    /// Whether it can be measured: a rate, samples of the body's own size, nothing infinite, some mass.
    pub fn is_sound(&self) -> bool {
        let joints = self.body.joints.len();
        self.hz > 0.0
            && self.hz.is_finite()
            && self.per_frame > 0
            && joints > 0
            && !self.poses.is_empty()
            && self.body.mass > 0.0
            && self.body.segments.iter().all(|segment| segment.joint < joints)
            && self.poses.iter().all(|pose| {
                pose.turns.len() == joints && pose.hips.is_finite() && pose.turns.iter().all(|turn| turn.is_finite())
            })
    }

    /// s, the time of a sample.
    pub fn time(&self, sample: usize) -> f64 {
        sample as f64 / self.hz
    }

    /// The samples that lie in a span of time, both ends counted.
    pub fn samples_in(&self, start: f64, end: f64) -> std::ops::Range<usize> {
        let from = (start * self.hz - 1e-6).ceil().max(0.0) as usize;
        let to = (end * self.hz + 1e-6).floor() + 1.0;
        let to = if to > 0.0 { (to as usize).min(self.poses.len()) } else { 0 };
        from.min(to)..to
    }
}

impl HeldContact {
    /// m, height of a point over the contact's plane, along its normal.
    pub fn height(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }
}

/// A motion with the positions of all its joints.
#[derive(Clone, Debug)]
pub struct Track<'a> {
    /// The motion.
    pub motion: Motion<'a>,
    /// The ground, where it is known; else the contacts' planes and y = 0 stand for it.
    pub terrain: Option<Terrain>,
    /// Boxes in both hands: the ground must carry them too.
    pub loads: &'a [Load],
    /// m, by how much the body means to go lower than it stands.
    pub crouched: f64,
    /// When a foot bears without holding still.
    pub scuffs: &'a [Scuff],
    /// Whether it is asked to walk where the motion ends.
    pub goes: bool,
    positions: Vec<DVec3>,        // (samples x joints), sample-major
    touched: Vec<scuff::Touched>, // (scuffs)
}

impl<'a> Track<'a> {
    /// Forward kinematics of every sample; `None` for a motion that cannot be measured.
    pub fn new(motion: Motion<'a>) -> Option<Track<'a>> {
        if !motion.is_sound() {
            return None;
        }
        let mut positions = Vec::with_capacity(motion.poses.len() * motion.body.joints.len());
        let mut one = Vec::new();
        for pose in motion.poses {
            pose.positions_into(motion.body, &mut one);
            positions.extend_from_slice(&one);
        }
        Some(Track {
            motion,
            terrain: None,
            loads: &[],
            crouched: 0.0,
            scuffs: &[],
            goes: false,
            positions,
            touched: Vec::new(),
        })
    }

    /// The same over a ground that is known.
    pub fn over(motion: Motion<'a>, terrain: &Terrain) -> Option<Track<'a>> {
        Some(Track { terrain: Some(terrain.clone()), ..Track::new(motion)? })
    }

    /// The same with what is carried.
    pub fn carrying(self, loads: &'a [Load]) -> Track<'a> {
        let joints = self.motion.body.joints.len();
        Track { loads: if loads.iter().all(|load| load.joint < joints) { loads } else { &[] }, ..self }
    }

    /// The same of a body that means to go so much lower, m.
    pub fn crouching(self, crouched: f64) -> Track<'a> {
        Track { crouched, ..self }
    }

    /// The same that is asked to walk where it ends.
    pub fn going(self, goes: bool) -> Track<'a> {
        Track { goes, ..self }
    }

    /// The same whose feet scuff, over a ground that is known by then.
    pub fn scuffing(self, scuffs: &'a [Scuff]) -> Track<'a> {
        let touched = scuffs.iter().map(|scuff| scuff::Touched::new(&self, scuff)).collect();
        Track { scuffs, touched, ..self }
    }

    /// kg, the body and what it carries at a sample.
    pub fn mass(&self, sample: usize) -> f64 {
        let time = self.motion.time(sample);
        self.motion.body.mass + self.loads.iter().map(|load| load.mass_at(time)).sum::<f64>()
    }

    /// How a frame is turned about the origin at a sample.
    pub fn turn(&self, frame: Frame, sample: usize) -> DQuat {
        match (&self.terrain, frame) {
            (Some(terrain), Frame::Platform) => terrain.turn(self.motion.time(sample)),
            _ => DQuat::IDENTITY,
        }
    }

    /// A contact with its plane where it is at a sample, in the world.
    pub fn placed(&self, contact: &HeldContact, sample: usize) -> HeldContact {
        let turn = self.turn(contact.frame, sample);
        HeldContact { point: turn * contact.point, normal: turn * contact.normal, frame: Frame::World, ..*contact }
    }

    /// Samples.
    pub fn len(&self) -> usize {
        self.motion.poses.len()
    }

    /// Whether there is no sample (never, of a track that was made).
    pub fn is_empty(&self) -> bool {
        self.motion.poses.is_empty()
    }

    /// Joint positions of one sample, m.
    pub fn positions(&self, sample: usize) -> &[DVec3] {
        let joints = self.motion.body.joints.len();
        &self.positions[sample * joints..(sample + 1) * joints]
    }

    /// m, a point that is rigid with a joint: its offset from the joint at rest.
    pub fn rigid_point(&self, sample: usize, joint: usize, offset: DVec3) -> DVec3 {
        self.positions(sample)[joint] + self.motion.poses[sample].turns[joint] * offset
    }
}

/// The value below which a share of the values lies (nearest rank); 0 for none.
pub fn percentile(values: &[f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}
