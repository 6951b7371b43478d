//! The base clip: what the character does until it is disturbed, and goes back to.
//!
//! A [`Base`] is a clip on the body that is baked, judged once: a stand (both feet stay) or a walk. [`stand`] lays a reaction over a
//! stand. Scenario space: metres, the ground at 0, the clip's own place and heading. What runs, jumps or sits is refused.

mod bearing;
mod beside;
mod cycle;
mod error;
mod foot;
pub mod gait;
mod hold;
mod over;
mod prepare;
pub mod stand;
mod turning;
pub mod walk;

pub use beside::add;
pub use error::error;
pub use foot::FootOffset;
pub use over::Over;
pub use prepare::prepare;
pub use stand::Stood;
pub use walk::Walked;

use crate::audit::contacts::footfalls;
use crate::audit::track::Track;
use crate::maths::hull::{convex_hull, signed_distance};
use crate::model::{Body, BodyPose, Capture, Side};
use crate::whole_body::{Anatomy, BasePose};
use glam::{DQuat, DVec2, DVec3};

/// rad, mean over the joints: a clip whose last pose is this near to its first is a loop.
const LOOPS: f64 = 2.5 * std::f64::consts::PI / 180.0;

/// m, at a leg of 0.83 m: a centre of mass that far out of the feet is not standing on them.
const TOPPLED: f64 = 0.04;

/// A clip to start from and to return to.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    /// Its name.
    pub name: String,
    /// Frames a second.
    pub fps: f64,
    /// It lifts its feet: a walk, or nothing that can be a base.
    pub walks: bool,
    /// It begins again where it ends.
    pub loops: bool,
    /// Its index among the clips of the rig that is baked, where it is one of them.
    pub own: Option<usize>,
    /// Sentences for a person.
    pub notes: Vec<String>,
    frames: Vec<BaseFrame>,
}

/// A frame of it.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseFrame {
    /// m: hips, and turns.
    pub pose: BodyPose,
    /// m, centre of mass.
    pub com: DVec3,
    /// What is laid under a reaction.
    pub base: BasePose,
}

/// Why a clip cannot be a base.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BaseError {
    /// It has no frames.
    #[error("the base clip \"{0}\" has no frames")]
    Empty(String),
    /// It neither stands nor walks.
    #[error("the base clip \"{name}\" {what}. A base is a stand on both feet or a walk")]
    Unfit {
        /// The clip.
        name: String,
        /// What it does instead.
        what: String,
    },
}

impl Base {
    /// Of a clip on the body that will be baked, in scenario space.
    pub fn new(capture: &Capture) -> Result<Base, BaseError> {
        let body = &capture.body;
        if capture.frames() == 0 {
            return Err(BaseError::Empty(capture.name.clone()));
        }
        let anatomy = Anatomy::new(body);
        let frames: Vec<BaseFrame> = (0..capture.frames())
            .map(|frame| {
                let pose = BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() };
                BaseFrame::of(body, &anatomy, pose, 0.0)
            })
            .collect();
        let apart = |from: &BodyPose, to: &BodyPose| {
            let off = from.turns.iter().zip(&to.turns).map(|(from, to)| from.angle_between(*to)).sum::<f64>();
            off / from.turns.len().max(1) as f64
        };
        let loops = frames.len() > 2 && apart(&frames[0].pose, &frames[frames.len() - 1].pose) < LOOPS;
        let mut base = Base {
            name: capture.name.clone(),
            fps: capture.fps,
            loops,
            walks: false,
            own: None,
            notes: Vec::new(),
            frames,
        };
        base.walks = base.judge(capture)?;
        Ok(base)
    }

    /// Whether it lifts its feet. A stand keeps both on the ground from end to end, and its centre of mass over them.
    fn judge(&self, capture: &Capture) -> Result<bool, BaseError> {
        let track = Track::new(capture);
        let feet = footfalls(&track);
        let unfit = |what: String| Err(BaseError::Unfit { name: self.name.clone(), what });
        for side in Side::BOTH {
            if feet.of[side as usize].contains(&None) {
                return Ok(true);
            }
        }
        let size = track.size();
        let out = |frame: usize| {
            let at = |point: DVec3| DVec2::new(point.x, point.z);
            let points: Vec<DVec2> = track.feet.iter().flat_map(|foot| foot.points[frame].map(at)).collect();
            let half = capture.body.feet[0].half_width;
            signed_distance(&convex_hull(&points), track.below(frame)) - half
        };
        let worst = (0..track.len()).max_by(|a, b| out(*a).total_cmp(&out(*b))).unwrap_or(0);
        if out(worst) > TOPPLED * size {
            let far = out(worst) * 100.0;
            return unfit(format!("has its centre of mass {far:.0} cm out of its feet at frame {worst}"));
        }
        Ok(false)
    }

    /// s, from its first frame to its last.
    pub fn seconds(&self) -> f64 {
        (self.frames.len() - 1) as f64 / self.fps
    }

    /// s, the clip's own time then: begun again where it loops, at the end where it does not.
    pub fn wrapped(&self, time: f64) -> f64 {
        let (time, whole) = (time.max(0.0), self.seconds());
        if !self.loops || whole <= 0.0 {
            return time.min(whole);
        }
        let round = time % whole;
        if whole - round < 1e-9 { 0.0 } else { round }
    }

    /// The frame at any time (s): begun again where it loops, else the last one is held.
    pub fn at(&self, time: f64) -> BaseFrame {
        let last = self.frames.len() - 1;
        let mut place = self.wrapped(time) * self.fps;
        // Times that are whole frames are those frames.
        if (place - place.round()).abs() < 1e-6 {
            place = place.round();
        }
        let first = (place.floor() as usize).min(last);
        let share = (place - first as f64).clamp(0.0, 1.0);
        let (from, to) = (&self.frames[first], &self.frames[(first + 1).min(last)]);
        if share == 0.0 {
            return from.clone();
        }
        from.between(to, share)
    }

    /// All its frames.
    pub fn frames(&self) -> &[BaseFrame] {
        &self.frames
    }
}

impl BaseFrame {
    /// Of a pose.
    pub(super) fn of(body: &Body, anatomy: &Anatomy, pose: BodyPose, facing: f64) -> BaseFrame {
        let positions = pose.positions(body);
        let base = BasePose::of(body, anatomy, &pose, &positions, facing);
        BaseFrame { com: pose.centre_of_mass(body, &positions), base, pose }
    }

    /// Between two of them.
    pub(super) fn between(&self, to: &BaseFrame, share: f64) -> BaseFrame {
        if share <= 0.0 {
            return self.clone();
        }
        BaseFrame {
            pose: BodyPose {
                hips: self.pose.hips.lerp(to.pose.hips, share),
                turns: slerped(&self.pose.turns, &to.pose.turns, share),
            },
            com: self.com.lerp(to.com, share),
            base: self.base.between(&to.base, share),
        }
    }
}

fn slerped(from: &[DQuat], to: &[DQuat], share: f64) -> Vec<DQuat> {
    from.iter().zip(to).map(|(from, to)| from.slerp(*to, share)).collect()
}
