//! The base clip: what the character does until it is disturbed, and goes back to.
//!
//! A [`Base`] is a clip on the body that is baked, judged once: a stand (both feet stay) or a walk. [`stand`] lays a reaction over a
//! stand. Scenario space: metres, the ground at 0, the clip's own place and heading. What runs, jumps or sits is refused.

pub(in crate::bake) mod again;
pub(in crate::bake) mod apart;
mod bearing;
mod beside;
mod cycle;
mod error;
pub(in crate::bake) mod foot;
pub mod gait;
mod hold;
pub(in crate::bake) mod over;
mod prepare;
mod soles;
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

/// m at a leg of 0.83 m: feet that move by less stay.
const STAYS: f64 = 0.006;
/// s at a leg of 0.83 m: a stand lasts longer.
const STANDS: f64 = 0.3;
/// m at a leg of 0.83 m: a stand that shifts its feet does it by less,
const SHIFTS: f64 = 0.45;
/// and rises and sinks by less.
const SINKS: f64 = 0.15;

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
        let track = Track::new(capture);
        base.walks = base.judge(&track);
        if base.walks
            && let Some((from, to)) = base.stays(body)
        {
            base.steady(&track, from..=to)?;
            base.walks = false;
            base.loops = false;
            base.frames.truncate(to + 1);
            base.frames.drain(..from);
            base.notes.push(format!(
                "the base clip shifts its feet: it is played from {:.2} to {:.2} s, where they stay",
                from as f64 / base.fps,
                to as f64 / base.fps
            ));
        } else if !base.walks {
            base.steady(&track, 0..=base.frames.len() - 1)?;
        }
        Ok(base)
    }

    /// Whether it lifts its feet.
    fn judge(&self, track: &Track) -> bool {
        let feet = footfalls(track);
        Side::BOTH.into_iter().any(|side| feet.of[side as usize].contains(&None))
    }

    /// The frames, most of the clip, in which both feet stay where they are, of one that lifts or shifts them a little besides.
    fn stays(&self, body: &Body) -> Option<(usize, usize)> {
        let size = (body.leg_length / 0.83).max(1e-3);
        let ankles: Vec<[DVec3; 2]> = self
            .frames
            .iter()
            .map(|frame| {
                let positions = frame.pose.positions(body);
                Side::BOTH.map(|side| positions[body.feet[side as usize].ankle])
            })
            .collect();
        let apart = |from: usize, to: usize| {
            let off = [0, 1].map(|side| ankles[from][side].distance(ankles[to][side]));
            off[0].max(off[1]) / size
        };
        let count = ankles.len();
        let mut best = (0, 0);
        for from in 0..count {
            if count - from <= best.1 - best.0 + 1 {
                break;
            }
            let to = (from..count).take_while(|to| apart(from, *to) < STAYS).last().unwrap_or(from);
            if to - from > best.1 - best.0 {
                best = (from, to);
            }
        }
        let (from, to) = best;
        let most = (to - from + 1) * 2 > count && (to - from) as f64 / self.fps > STANDS * size.sqrt();
        let sinks = |frame: &BaseFrame| (frame.com.y - self.frames[from].com.y).abs() > SINKS * size;
        let shifts = (0..count).all(|frame| apart(from, frame) < SHIFTS) && !self.frames.iter().any(sinks);
        (most && shifts).then_some(best)
    }

    /// A stand has its centre of mass over its feet.
    fn steady(&self, track: &Track, mut frames: std::ops::RangeInclusive<usize>) -> Result<(), BaseError> {
        let size = track.size();
        let out = |frame: usize| {
            let at = |point: DVec3| DVec2::new(point.x, point.z);
            let points: Vec<DVec2> = track.feet.iter().flat_map(|foot| foot.points[frame].map(at)).collect();
            let half = track.capture.body.feet[0].half_width;
            signed_distance(&convex_hull(&points), track.below(frame)) - half
        };
        match frames.find(|frame| out(*frame) > TOPPLED * size) {
            Some(frame) => {
                let far = out(frame) * 100.0;
                let what = format!("has its centre of mass {far:.0} cm out of its feet at frame {frame}");
                Err(BaseError::Unfit { name: self.name.clone(), what })
            }
            None => Ok(()),
        }
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
