//! Pops: steps of a joint's rotation from one frame to the next that the frames before and after do not explain. Radians.
//!
//! Held against captured people (30 frames a second, without toes): of 82 s of runs and 198 s of walks one such step in 5 and in 20 s, most
//! of them of hands and heads. A swing that a joint goes through in four frames is none: people who catch themselves bend and stretch a
//! knee in a tenth of a second each, and their knees alone pop once a second where the frames two away are asked.

use super::Track;
use crate::maths::real;
use crate::model::{BodyPose, Role};
use glam::DQuat;

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// rad, the least step that can be a pop.
pub(crate) const POP_LEAST: f64 = 4.0 * DEGREE;
/// rad, the least step over two frames that can be one.
const POP_LEAST_OF_TWO: f64 = 30.0 * DEGREE;
/// rad, of toes: those of captured people flick by 4 degrees and more every other second, as they touch down and leave, by more than 30
/// once in 30 s.
const POP_LEAST_OF_TOES: f64 = 30.0 * DEGREE;
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
        let turns: Vec<DQuat> = frames.iter().map(|pose| local(pose)).collect();
        let least = if matches!(joint.role, Role::LeftToes | Role::RightToes) { POP_LEAST_OF_TOES } else { POP_LEAST };
        found.extend(jumps(&turns, least, 2).into_iter().map(|(frame, step)| Pop {
            role: joint.role,
            time: motion.time(frame * motion.per_frame),
            step,
        }));
    }
    found
}

/// The pops of a joint that is turned like that frame by frame: the frame that each begins at and its step, rad. The first and the last step
/// are held against so many on their one side: 1, or 2 of a whole clip, where a joint that turns back there does not pop, nor one that sets off
/// or comes to rest no more sharply than it does elsewhere in the clip: what a cut leaves of a quick swing.
pub(crate) fn jumps(turns: &[DQuat], least: f64, at_ends: usize) -> Vec<(usize, f64)> {
    let steps: Vec<f64> = turns.windows(2).map(|pair| angle_of(pair[0].inverse() * pair[1])).collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < steps.len() {
        let over = [(1, least), (2, POP_LEAST_OF_TWO)]
            .map(|(count, least)| (count, jump(&steps, at, (count, least), at_ends)));
        match over.into_iter().find_map(|(count, step)| Some((count, step?))) {
            Some((count, step)) => {
                found.push((at, step));
                at += count;
            }
            None => at += 1,
        }
    }
    found
}

/// rad, what so many steps from one on are together, where that is a jump that neither the step before nor the one after explains.
fn jump(steps: &[f64], at: usize, (count, least): (usize, f64), at_ends: usize) -> Option<f64> {
    let taken = steps.get(at..at + count)?;
    let sum: f64 = taken.iter().sum();
    // Of two frames both are part of it.
    if taken.iter().any(|step| POP_FACTOR * step < sum) {
        return None;
    }
    let before = || steps[..at].iter().rev();
    let after = || steps[at + count..].iter();
    let far = |is_end: bool| if is_end { at_ends } else { 1 };
    let (first, last) = (at == 0, at + count == steps.len());
    let around = before().take(far(last)).chain(after().take(far(first))).copied().reduce(f64::max)?;
    let starts_as_elsewhere = || {
        let sharpest = if last { sharpest(&steps[..at]) } else { sharpest(&steps[at + count..]) };
        sum - around * count as f64 <= sharpest
    };
    let jumps = sum > least && sum > POP_FACTOR * around * count as f64;
    (jumps && !((first || last) && at_ends > 1 && starts_as_elsewhere())).then_some(sum)
}

/// rad, the largest change from a step to the next.
fn sharpest(steps: &[f64]) -> f64 {
    steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
}

/// rad, of a rotation; exact for small ones.
fn angle_of(turn: DQuat) -> f64 {
    2.0 * real::atan2(turn.xyz().length(), turn.w.abs())
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
                let mut bend = 1.2 - 1.2 * real::cos(4.0 * time);
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

    /// The pops of a joint that turns by so much in so many frames from 0.5 s on, as smoothly as can be.
    fn turned(role: Role, degrees: f64, frames: f64) -> Vec<Pop> {
        let body = fixture::body();
        let poses = fixture::poses(&body, 121, |pose, sample| {
            let u = ((sample / 120.0 - 0.5) * 30.0 / frames).clamp(0.0, 1.0);
            let turn = DQuat::from_rotation_x(degrees * DEGREE * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u));
            let below = [Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes];
            for role in below.iter().skip_while(|below| **below != role) {
                pose.turns[body.joint(*role).expect("a leg")] = turn;
            }
        });
        pops(&Track::new(fixture::motion(&body, &poses)).expect("sound"))
    }

    #[test]
    fn a_knee_that_bends_within_an_eighth_of_a_second_is_quick_and_one_within_a_frame_or_two_pops() {
        assert_eq!(turned(Role::LeftLowerLeg, 60.0, 4.0), []);
        for frames in [1.0, 2.0] {
            let found = turned(Role::LeftLowerLeg, 60.0, frames);
            assert!(found.len() == 1 && found[0].role == Role::LeftLowerLeg, "{frames}: {found:?}");
            assert!((found[0].step / DEGREE - 60.0).abs() < 1e-6 && (found[0].time - 0.5).abs() < 1e-6, "{found:?}");
        }
        assert_eq!(turned(Role::LeftLowerLeg, 6.0, 1.0).len(), 1);
    }

    #[test]
    fn a_knee_that_turns_back_just_before_the_end_does_not_pop_and_one_that_jerks_there_does() {
        let knee = |degrees: &[f64]| {
            let turns: Vec<DQuat> = degrees.iter().map(|turn| DQuat::from_rotation_x(turn * DEGREE)).collect();
            let back: Vec<DQuat> = turns.iter().rev().copied().collect();
            [turns, back].map(|turns| jumps(&turns, POP_LEAST, 2).len())
        };
        assert_eq!(knee(&[10.0, 25.0, 34.0, 36.0, 27.0]), [0, 0]);
        assert_eq!(knee(&[33.5, 34.0, 34.5, 35.0, 26.0]), [1, 1]);
    }

    #[test]
    fn a_clip_may_be_cut_wherever_a_swing_is_that_it_has_seen_before() {
        // A heel that rises by 40 degrees in four frames and comes back as quickly, once in 16.
        let swing = |frame: usize| {
            let u = ((frame % 16) as f64 / 4.0).min((12.0 - (frame % 16) as f64) / 4.0).clamp(0.0, 1.0);
            DQuat::from_rotation_x(40.0 * DEGREE * u * u * (3.0 - 2.0 * u))
        };
        let ends = |frames: usize, jerk: f64| {
            let mut turns: Vec<DQuat> = (0..frames).map(swing).collect();
            *turns.last_mut().expect("frames") *= DQuat::from_rotation_x(jerk * DEGREE);
            let back: Vec<DQuat> = turns.iter().rev().copied().collect();
            [turns, back].map(|turns| jumps(&turns, POP_LEAST, 2).len())
        };
        for frames in 32..64 {
            assert_eq!(ends(frames, 0.0), [0, 0], "{frames} frames");
        }
        assert_eq!(ends(48, 20.0), [1, 1], "at rest for three frames before");
    }

    #[test]
    fn toes_may_flick_as_far_as_those_of_people() {
        assert_eq!(turned(Role::LeftToes, 20.0, 1.0), []);
        assert_eq!(turned(Role::LeftToes, 40.0, 1.0).len(), 1);
    }
}
