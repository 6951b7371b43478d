//! A clip as a body's motion, frame by frame: what every kind of clip file becomes before it is judged.
//!
//! **Clip space**: metres, Y up, the file's own horizontal axes and origin (a Z-up file is turned by a quarter about X), so that a
//! place that is printed is found again in the file. `Body` is in scenario space at rest (see there); `turns` lead from rest to
//! clip space, so a point that is rigid with joint j at rest offset v stands at `positions[j] + turns[j] * v`, as in a `BodyPose`.

use super::Body;
use glam::{DQuat, DVec3};

/// A recorded or keyed motion of one humanoid.
#[derive(Clone, Debug)]
pub struct Capture {
    /// The clip's name.
    pub name: String,
    /// Frames a second.
    pub fps: f64,
    /// Who moves.
    pub body: Body,
    /// (frames x joints), frame-major: m, clip space.
    pub positions: Vec<DVec3>,
    /// (frames x joints), frame-major: global rotations from rest.
    pub turns: Vec<DQuat>,
    /// Metres a unit of the file.
    pub units_to_metres: f64,
    /// The file's up axis, as in "+Y".
    pub up: String,
    /// 0..1: how sure the bones are.
    pub confidence: f64,
    /// How the bones were found.
    pub method: String,
    /// Sentences for a person.
    pub notes: Vec<String>,
    /// What the file says pushed the body: a clip that was baked here tells its disturbances.
    pub pushes: Vec<ToldPush>,
}

/// A force from outside that a clip tells of.
#[derive(Clone, Debug, PartialEq)]
pub struct ToldPush {
    /// s, of the clip's first frame.
    pub start: f64,
    /// s.
    pub end: f64,
    /// N, clip space.
    pub force: DVec3,
    /// Index of the body's joint that it acts on; `None` for its centre of mass.
    pub joint: Option<usize>,
}

impl Capture {
    /// Frames.
    pub fn frames(&self) -> usize {
        self.positions.len() / self.body.joints.len().max(1)
    }

    /// Joint positions of a frame, m.
    pub fn at(&self, frame: usize) -> &[DVec3] {
        let joints = self.body.joints.len();
        &self.positions[frame * joints..(frame + 1) * joints]
    }

    /// Joint turns of a frame.
    pub fn turns_at(&self, frame: usize) -> &[DQuat] {
        let joints = self.body.joints.len();
        &self.turns[frame * joints..(frame + 1) * joints]
    }

    /// m, a point that is rigid with a joint: its offset from the joint at rest.
    pub fn rigid_point(&self, frame: usize, joint: usize, offset: DVec3) -> DVec3 {
        self.at(frame)[joint] + self.turns_at(frame)[joint] * offset
    }

    /// m, the articulated centre of mass of a frame.
    pub fn centre_of_mass(&self, frame: usize) -> DVec3 {
        let (positions, turns) = (self.at(frame), self.turns_at(frame));
        let moment: DVec3 =
            self.body.segments.iter().map(|s| (positions[s.joint] + turns[s.joint] * s.centre) * s.mass).sum();
        moment / self.body.mass
    }
}
