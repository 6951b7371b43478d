//! Pops: steps of a joint's rotation from one frame to the next that those two frames before and after do not explain. Radians.

use super::Track;
use crate::model::{BodyPose, Role};
use glam::DQuat;

/// rad, the least step that can be a pop: 4 degrees.
const POP_LEAST: f64 = 4.0 * std::f64::consts::PI / 180.0;
/// How much larger than its neighbours' a step must be to be one.
const POP_FACTOR: f64 = 4.0;

/// A step of a joint's rotation that its neighbours do not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pop {
    /// Which joint.
    pub role: Role,
    /// s, the frame that the step begins at.
    pub time: f64,
    /// rad.
    pub step: f64,
}

/// Frame to frame, each joint against its parent.
pub fn pops(track: &Track) -> Vec<Pop> {
    let motion = track.motion;
    let mut found = Vec::new();
    let frames: Vec<&BodyPose> = motion.poses.iter().step_by(motion.per_frame).collect();
    for (index, joint) in motion.body.joints.iter().enumerate() {
        let local = |pose: &BodyPose| match joint.parent {
            Some(parent) => pose.turns[parent].inverse() * pose.turns[index],
            None => pose.turns[index],
        };
        let steps: Vec<f64> =
            frames.windows(2).map(|pair| angle_of(local(pair[0]).inverse() * local(pair[1]))).collect();
        for (at, step) in steps.iter().enumerate() {
            let before = at.checked_sub(2).map(|before| steps[before]);
            let after = steps.get(at + 2).copied();
            let Some(around) = before.into_iter().chain(after).reduce(f64::max) else { continue };
            if *step > POP_LEAST && *step > POP_FACTOR * around {
                let time = motion.time(at * motion.per_frame);
                found.push(Pop { role: joint.role, time, step: *step });
            }
        }
    }
    found
}

/// rad, of a rotation; exact for small ones.
fn angle_of(turn: DQuat) -> f64 {
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    #[test]
    fn one_frames_jerk_is_a_pop_and_a_fast_swing_is_not() {
        let body = fixture::body();
        let knee = body.joint(Role::LeftLowerLeg).expect("a knee");
        let swing = |jerk: f64| {
            fixture::poses(&body, 121, |pose, sample| {
                let time = sample / 120.0;
                let mut bend = 1.2 - 1.2 * (4.0 * time).cos();
                if (0.5 - 1e-9..0.5333).contains(&time) {
                    bend += jerk * (time - 0.5) * 30.0;
                } else if time >= 0.5333 {
                    bend += jerk;
                }
                (knee..knee + 3).for_each(|joint| pose.turns[joint] = DQuat::from_rotation_x(bend));
            })
        };
        let found = |jerk: f64| pops(&Track::new(fixture::motion(&body, &swing(jerk))).expect("sound"));
        assert!(found(0.0).is_empty(), "{:?}", found(0.0));
        let jerked = found(1.0);
        assert!(jerked.len() == 1 && jerked[0].role == Role::LeftLowerLeg, "{jerked:?}");
        assert!((jerked[0].time - 0.5).abs() < 1e-6, "{jerked:?}");
        assert!(found(0.2).is_empty(), "a fast knee hides it: {:?}", found(0.2));
    }
}
