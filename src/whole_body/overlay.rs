//! A reaction laid over a base clip's pose: trunk, head and arms add what they do to what the clip does; hands and fingers keep
//! the clip's; knees point where the clip's do. Scenario space, radians.
//!
//! The two priorities of the paper: balance (feet, centre of mass) is the solver's and is enforced; style is the clip's and fills
//! what is left. At rest, with the clip's own feet and centre of mass, the solved pose is the clip's.

use super::anatomy::Anatomy;
use super::reaction::{UPPER, upper_turns};
use super::solve::{PoseTarget, STRAIGHTEST, Solver, knee_pole};
use super::stand::natural_plants;
use super::stand::{foot_yaw, stand_target};
use crate::maths::curve::smooth3;
use crate::maths::quat::{limb_frame, wrap_angle};
use crate::maths::real;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::{Body, BodyPose, Side};
use glam::{DQuat, DVec3};

/// m at a leg of 0.83 m: a knee that is off the line from hip to ankle by less than the first says nothing of where it points, by more than the second all.
const OFF_LINE: [f64; 2] = [0.0004, 0.0012];
/// rad: a knee that bends by more than the clip's shows less of how the clip's points, and from how much more on the least.
const FREELY: f64 = 0.05;
/// rad.
const FADES: f64 = 0.4;
/// Part of the leg: a clip that uses more of it may lock its knee.
const STRAIGHT: f64 = 0.995;
/// The straightest leg that a base clip may show.
const LOCKED: f64 = 0.999_999_9;

/// A base clip's pose, the pelvis of the stand facing +Z, as a reaction is laid over it.
#[derive(Clone, Debug, PartialEq)]
pub struct BasePose {
    /// Global turns from rest, one a joint.
    pub turns: Vec<DQuat>,
    /// rad, how far each knee points off where the solver would have it, about the line from hip to ankle.
    pub knees: [f64; 2],
    /// rad, how far each knee is bent, and how sure it is where it points, 0..1.
    pub bends: [(f64, f64); 2],
    /// What thigh and shank are turned about their own length.
    pub twists: [[DQuat; 2]; 2],
    /// Part of the leg's length that each leg of the clip uses: it may be straighter than the solver's.
    pub straightest: [f64; 2],
}

/// What the solver poses where nothing happens: what a reaction is measured from.
#[derive(Clone, Debug)]
pub struct Neutral {
    turns: Vec<DQuat>,
    chest: usize,
    arms: [Vec<usize>; 2], // collar bone to fingers
    lower: [usize; 2],
    rigid: Vec<Option<usize>>, // of a joint that keeps to the forearm as in the clip: the one above it
}

impl Neutral {
    /// Of a body.
    pub fn new(body: &Body, anatomy: &Anatomy) -> Neutral {
        let stand = stand_target(body, &natural_plants(0.2, 0.0), DVec3::Y, 0.0);
        let (pelvis, chest, head, arms) = upper_turns(&[0.0; UPPER]);
        let target = PoseTarget { pelvis, chest, head, arms, ..stand };
        let turns = Solver::new(body, anatomy).upper(&target);
        let mut rigid = vec![None; turns.len()];
        let mut chains = [Vec::new(), Vec::new()];
        for side in Side::BOTH {
            let arm = &anatomy.arms[side as usize];
            let root = arm.shoulder.unwrap_or(arm.upper);
            let chain = &mut chains[side as usize];
            for (joint, rigid) in rigid.iter_mut().enumerate() {
                let hangs = body.joints[joint].parent.is_some_and(|parent| chain.contains(&parent));
                if joint == root || joint == arm.upper || hangs {
                    chain.push(joint);
                    let own = [root, arm.upper, arm.lower].contains(&joint);
                    *rigid = body.joints[joint].parent.filter(|_| !own);
                }
            }
        }
        let chest = anatomy.spine.last().copied().unwrap_or(0);
        Neutral { turns, chest, arms: chains, lower: [anatomy.arms[0].lower, anatomy.arms[1].lower], rigid }
    }

    /// Lays the reaction of `turns` (global, facing anywhere) over the base. Legs are not touched.
    pub(super) fn lay(&self, turns: &mut [DQuat], base: &BasePose, holds: f64) {
        let reaction = turns.to_vec();
        let arm = |joint: usize| Side::BOTH.into_iter().find(|side| self.arms[*side as usize].contains(&joint));
        for (joint, turn) in turns.iter_mut().enumerate() {
            if arm(joint).is_none() {
                *turn = reaction[joint] * self.turns[joint].inverse() * base.turns[joint];
            }
        }
        let chest = turns[self.chest];
        let (reacts, rests) = (reaction[self.chest].inverse(), self.turns[self.chest].inverse());
        let stands = base.turns[self.chest].inverse();
        for side in Side::BOTH {
            let laid = |joint: usize| {
                let moved = if self.rigid[joint].is_some() { self.lower[side as usize] } else { joint };
                let by = (reacts * reaction[moved]) * (rests * self.turns[moved]).inverse();
                chest * by * (stands * base.turns[joint])
            };
            for &joint in &self.arms[side as usize] {
                turns[joint] = match self.rigid[joint] {
                    _ if holds <= 0.0 => laid(joint),
                    // Fingers of a fist are half a turn from those that hold: each joint opens by its own bend.
                    Some(above) => {
                        let [clip, held] =
                            [laid(above).inverse() * laid(joint), reaction[above].inverse() * reaction[joint]];
                        turns[above] * clip.slerp(held, holds)
                    }
                    None => laid(joint).slerp(reaction[joint], holds),
                };
            }
        }
        for turn in turns {
            *turn = turn.normalize();
        }
    }
}

impl BasePose {
    /// Of a clip's pose: `positions` (m) and `turns` of all joints; `facing` (rad): where the body faces that is posed so.
    pub fn of(body: &Body, anatomy: &Anatomy, pose: &BodyPose, positions: &[DVec3], facing: f64) -> BasePose {
        let back = DQuat::from_rotation_y(-facing);
        let mut base = BasePose {
            turns: pose.turns.iter().map(|turn| if facing == 0.0 { *turn } else { back * *turn }).collect(),
            knees: [0.0; 2],
            bends: [(0.0, 1.0); 2],
            twists: [[DQuat::IDENTITY; 2]; 2],
            straightest: [STRAIGHTEST; 2],
        };
        for side in Side::BOTH {
            let leg = &anatomy.legs[side as usize];
            let [hip, knee, ankle] = [leg.upper, leg.lower, leg.foot].map(|joint| positions[joint]);
            let foot = foot_yaw(body, side, pose.turns[leg.foot]);
            let yaw = facing + 0.65 * wrap_angle(foot - facing);
            let Some(axis) = (ankle - hip).try_normalize() else { continue };
            let square = |way: DVec3| way - axis * way.dot(axis);
            let Some(pole) = square(knee_pole(ankle - hip, yaw)).try_normalize() else { continue };
            let off = square(knee - hip);
            // The hinge that the thigh itself turns about, for a leg too straight to show one.
            let hinge = (pose.turns[leg.upper] * leg.thigh_from_rest.inverse()) * DVec3::X;
            let own = square(axis.cross(hinge)).try_normalize().unwrap_or(pole);
            let size = leg.length() / 0.83;
            let told = smooth3((off.length() - OFF_LINE[0] * size) / ((OFF_LINE[1] - OFF_LINE[0]) * size).max(1e-9));
            let seen = off.try_normalize().unwrap_or(own);
            let way = (own * (1.0 - told) + seen * told).try_normalize().unwrap_or(seen);
            base.knees[side as usize] = real::atan2(pole.cross(way).dot(axis), pole.dot(way));
            let stretch = (ankle - hip).length() / leg.length();
            base.straightest[side as usize] = if stretch > STRAIGHT { LOCKED } else { STRAIGHTEST };
            let chain =
                two_bone_ik(hip, ankle, leg.thigh_length, leg.shank_length, way, base.straightest[side as usize]);
            base.bends[side as usize] = (chain.bend, told);
            let bones = [
                (limb_frame(chain.middle - hip, chain.hinge) * leg.thigh_from_rest, leg.upper, leg.lower),
                (limb_frame(chain.end - chain.middle, chain.hinge) * leg.shank_from_rest, leg.lower, leg.foot),
            ];
            for (bone, (turn, joint, end)) in bones.into_iter().enumerate() {
                let by = turn.inverse() * pose.turns[joint];
                base.twists[side as usize][bone] = about(by, body.offset(end));
            }
        }
        base
    }

    /// Between two of them.
    pub fn between(&self, other: &BasePose, share: f64) -> BasePose {
        let mix = |from: f64, to: f64| from + (to - from) * share;
        BasePose {
            turns: self.turns.iter().zip(&other.turns).map(|(from, to)| from.slerp(*to, share)).collect(),
            knees: [0, 1].map(|side| {
                let way = wrap_angle(other.knees[side] - self.knees[side]);
                self.knees[side] + way * share
            }),
            bends: [0, 1].map(|side| {
                let (from, to) = (self.bends[side], other.bends[side]);
                (mix(from.0, to.0), mix(from.1, to.1))
            }),
            twists: [0, 1].map(|side| [0, 1].map(|b| self.twists[side][b].slerp(other.twists[side][b], share))),
            straightest: [0, 1].map(|side| mix(self.straightest[side], other.straightest[side])),
        }
    }
}

impl BasePose {
    /// How much of where the clip's knee points is kept by a leg that bends by that, rad: a straight leg's knee says little of where
    /// a bent one points.
    pub(super) fn keeps(&self, side: Side, bend: f64) -> f64 {
        let (shown, told) = self.bends[side as usize];
        let least = 0.6 * told;
        least + (1.0 - least) * (1.0 - smooth3((bend - shown - FREELY) / FADES))
    }
}

/// The part of a rotation that turns about an axis.
fn about(turn: DQuat, axis: DVec3) -> DQuat {
    let Some(axis) = axis.try_normalize() else { return DQuat::IDENTITY };
    let along = axis * turn.xyz().dot(axis);
    let twist = DQuat::from_xyzw(along.x, along.y, along.z, turn.w);
    if twist.length_squared() < 1e-12 { DQuat::IDENTITY } else { twist.normalize() }
}
