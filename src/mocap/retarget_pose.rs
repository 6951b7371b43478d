//! Pelvis and legs of a retarget: how high the pelvis goes, and legs that put the feet where they shall be.
//!
//! Clip space, m, rad; the target's floor is y = 0. The pelvis goes the source's way scaled by leg length, at the height at which the legs that
//! bear are as bent as the source's; two-bone IK takes up what holding the feet leaves, knees pointing as they did. Where a foot that bears is
//! out of reach the pelvis sinks, early and gently; one that swings comes as near as it can.

use super::retarget_feet::FootPlan;
use super::retarget_planted::SourceFeet;
use super::retarget_turns::{TurnMap, rest_frames};
use crate::maths::filter::zero_lag;
use crate::maths::quat::shortest_arc;
use crate::maths::real;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::{Body, BodyPose, Capture, Role, Side};
use glam::{DQuat, DVec3};

/// A leg is no straighter than that, unless the source's was.
const STRAIGHTEST: f64 = 0.9985;
/// Nor ever than that.
const STRAIGHT: f64 = 0.9999;
/// Of the leg's length: the pelvis sinks no more for reach.
const DEEPEST: f64 = 0.3;
/// s, at a leg of 0.83 m: how long before it is needed, and after, the pelvis sinks.
const SINKS: f64 = 0.36;
/// Hz: what the height of the pelvis gets beside the scaled one changes no faster.
const SETTLES: f64 = 2.0;
/// How often legs without a foot joint are solved again.
const STIFF_PASSES: usize = 4;
/// m, m/s: a foot this far over the floor or this fast says little of how high the pelvis is.
const LIGHT: (f64, f64) = (0.02, 0.6);

/// One leg of the target.
struct Leg {
    hip: usize,
    knee: usize,
    ankle: usize,
    toes: Option<usize>,
    /// m, at rest: from the middle between the hip joints to this one, thigh, shank.
    bones: [DVec3; 3],
    /// What is in front of the thigh, at rest.
    front: DVec3,
}

/// A retarget under way.
pub(super) struct Work<'a> {
    capture: &'a Capture,
    body: &'a Body,
    scale: f64,
    legs: [Leg; 2],
    /// m, at rest: from the middle between the hip joints to the hips joint.
    to_hips: DVec3,
    /// (frames) the turns of every joint, as the source has them.
    turns: Vec<Vec<DQuat>>,
}

impl<'a> Work<'a> {
    /// Reads the turns.
    pub fn new(capture: &'a Capture, body: &'a Body) -> Work<'a> {
        let map = TurnMap::new(&capture.body, body);
        let turns = (0..capture.frames()).map(|frame| map.turns(capture.turns_at(frame))).collect();
        let rest = rest_frames(body);
        let middle = middle(body, &|joint| body.joints[joint].rest);
        let legs = Side::BOTH.map(|side| {
            let [hip, knee] = leg_roles(side).map(|role| body.joint(role).unwrap_or(0));
            let shape = &body.feet[side as usize];
            let place = |joint: usize| body.joints[joint].rest;
            let toes = body.joint(if side == Side::Left { Role::LeftToes } else { Role::RightToes });
            let bones = [place(hip) - middle, place(knee) - place(hip), place(shape.ankle) - place(knee)];
            Leg { hip, knee, ankle: shape.ankle, toes, bones, front: rest[hip] * DVec3::Z }
        });
        let to_hips = body.joints[0].rest - middle;
        let scale = body.leg_length / capture.body.leg_length.max(1e-6);
        Work { capture, body, scale, legs, to_hips, turns }
    }

    /// What was done, for a person.
    pub fn notes(&self, held: usize, slides: usize) -> Vec<String> {
        let mut notes =
            vec![format!("retargeted: the way of the pelvis is {:.3} of the clip's, by leg length", self.scale)];
        let lacks: Vec<&str> = (self.body.joints.iter().filter(|joint| joint.animated))
            .filter(|joint| self.capture.body.joint(joint.role).is_none())
            .map(|joint| joint.role.name())
            .collect();
        if !lacks.is_empty() {
            notes.push(format!("the clip has no {}: they go with what they hang from", lacks.join(", ")));
        }
        notes.push(match (held, slides) {
            (0, 0) => "no foot of the clip stands still: none is held".to_owned(),
            (0, slides) => format!("feet slide through all of {slides} stances: none is held"),
            (held, 0) => format!("feet are held in {held} stances"),
            (held, slides) => format!("feet are held in {held} stances; {slides} more slide and are not"),
        });
        notes
    }

    /// Poses of every frame.
    pub fn poses(&self, source: &SourceFeet) -> Vec<BodyPose> {
        if self.turns.is_empty() {
            return Vec::new();
        }
        let mut poses = self.pass(source, None);
        // A foot that no node moves turns with its shank, which IK turns to put the foot where it shall be.
        if self.legs.iter().any(|leg| !self.body.joints[leg.ankle].animated) {
            for _ in 0..STIFF_PASSES {
                poses = self.pass(source, Some(&poses));
            }
        }
        poses
    }

    /// Poses of every frame; `last`: those of the pass before.
    fn pass(&self, source: &SourceFeet, last: Option<&[BodyPose]>) -> Vec<BodyPose> {
        let frames = self.turns.len();
        let plans = Side::BOTH.map(|side| {
            let leg = &self.legs[side as usize];
            let toe = self.body.feet[side as usize].toe.unwrap_or(leg.ankle);
            let stiff = !self.body.joints[leg.ankle].animated;
            let raw: Vec<[DQuat; 2]> = match last.filter(|_| stiff) {
                Some(last) => last.iter().map(|pose| [pose.turns[leg.ankle], pose.turns[toe]]).collect(),
                None => self.turns.iter().map(|turns| [turns[leg.ankle], turns[toe]]).collect(),
            };
            FootPlan::new(self.capture, self.body, side, &raw, source)
        });
        let mut pelvis = self.pelvis(source, &plans);
        let ankles = |pelvis: &[DVec3]| {
            Side::BOTH.map(|side| {
                let own: Vec<DVec3> = (0..frames).map(|frame| pelvis[frame] + self.hanging(frame, side)).collect();
                plans[side as usize].ankles(&own)
            })
        };
        let sinks = self.sinking(&pelvis, &ankles(&pelvis), &plans);
        for (place, sunk) in pelvis.iter_mut().zip(sinks) {
            place.y -= sunk;
        }
        let ankles = ankles(&pelvis);
        (0..frames)
            .map(|frame| {
                let goals = Side::BOTH.map(|side| ankles[side as usize][frame]);
                let feet = Side::BOTH.map(|side| plans[side as usize].turns[frame]);
                let bears = Side::BOTH.map(|side| plans[side as usize].bears[frame]);
                self.pose(frame, pelvis[frame], goals, feet, bears)
            })
            .collect()
    }

    /// m: from between the hip joints to an ankle, legs as the source has them.
    fn hanging(&self, frame: usize, side: Side) -> DVec3 {
        let leg = &self.legs[side as usize];
        let turns = &self.turns[frame];
        turns[0] * leg.bones[0] + turns[leg.hip] * leg.bones[1] + turns[leg.knee] * leg.bones[2]
    }

    /// m, (frames): between the hip joints.
    fn pelvis(&self, source: &SourceFeet, plans: &[FootPlan; 2]) -> Vec<DVec3> {
        let frames = self.capture.frames();
        let floor = 0.5 * (source.floor[0] + source.floor[1]);
        let own: Vec<DVec3> =
            (0..frames).map(|frame| middle(&self.capture.body, &|joint| self.capture.at(frame)[joint])).collect();
        let first = DVec3::new(own[0].x, 0.0, own[0].z);
        let scaled: Vec<DVec3> = own.iter().map(|own| first + (*own - first - DVec3::Y * floor) * self.scale).collect();
        let size = self.capture.body.leg_length / 0.83;
        let (light, fast) = (LIGHT.0 * size, LIGHT.1 * size.max(0.0).sqrt());
        let beside: Vec<f64> = (0..frames)
            .map(|frame| {
                let (mut weights, mut sum) = (0.0, 0.0);
                for side in Side::BOTH {
                    let at = side as usize;
                    let (over, speed) = (source.clearance[at][frame].max(0.0) / light, source.still[at][frame] / fast);
                    let weight = 1.0 / (1.0 + over * over + speed * speed).powi(2);
                    weights += weight;
                    sum += weight * (plans[at].height[frame] - self.hanging(frame, side).y - scaled[frame].y);
                }
                sum / weights
            })
            .collect();
        let tempo = (self.body.leg_length / 0.83).max(0.01).sqrt();
        let beside = zero_lag(&beside, SETTLES / tempo, self.capture.fps);
        scaled.iter().zip(beside).map(|(scaled, beside)| *scaled + DVec3::Y * beside).collect()
    }

    /// How far a leg may stretch in a frame, m.
    fn reach(&self, frame: usize, side: Side) -> f64 {
        let leg = &self.legs[side as usize];
        let whole = leg.bones[1].length() + leg.bones[2].length();
        let turns = &self.turns[frame];
        let own = (turns[leg.hip] * leg.bones[1] + turns[leg.knee] * leg.bones[2]).length();
        whole * (own / whole.max(1e-9)).clamp(STRAIGHTEST, STRAIGHT)
    }

    /// m, (frames): how far the pelvis sinks so that feet that bear are reached.
    fn sinking(&self, pelvis: &[DVec3], ankles: &[Vec<DVec3>; 2], plans: &[FootPlan; 2]) -> Vec<f64> {
        let deepest = DEEPEST * self.body.leg_length;
        let need: Vec<f64> = (0..pelvis.len())
            .map(|frame| {
                let of = |side: Side| {
                    let leg = &self.legs[side as usize];
                    let hip = pelvis[frame] + self.turns[frame][0] * leg.bones[0];
                    let (ankle, reach) = (ankles[side as usize][frame], self.reach(frame, side));
                    let across = (hip - ankle) * DVec3::new(1.0, 0.0, 1.0);
                    let highest = ankle.y + (reach * reach - across.length_squared()).max(0.0).sqrt();
                    (hip.y - highest).max(0.0) * plans[side as usize].bears[frame].powi(4)
                };
                of(Side::Left).max(of(Side::Right)).min(deepest)
            })
            .collect();
        if need.iter().all(|need| *need < 1e-6) {
            return vec![0.0; pelvis.len()];
        }
        // The most that is needed within a while, smoothed over that while: never less than what is needed, and no corner in it.
        let tempo = (self.body.leg_length / 0.83).max(0.01).sqrt();
        let wide = (0.5 * SINKS * tempo * self.capture.fps).round().max(1.0) as usize;
        let last = need.len() - 1;
        let near = |frame: usize| frame.saturating_sub(wide)..=(frame + wide).min(last);
        let most: Vec<f64> =
            (0..need.len()).map(|frame| need[near(frame)].iter().copied().fold(0.0, f64::max)).collect();
        (0..need.len())
            .map(|frame| {
                let (mut weights, mut sum) = (0.0, 0.0);
                for at in near(frame) {
                    let u = 1.0 - (at.abs_diff(frame) as f64 / (wide + 1) as f64).powi(2);
                    weights += u * u;
                    sum += u * u * most[at];
                }
                sum / weights
            })
            .collect()
    }

    /// A frame: the pelvis and the ankles at their places, legs between.
    fn pose(
        &self,
        frame: usize,
        pelvis: DVec3,
        ankles: [DVec3; 2],
        feet: [[DQuat; 2]; 2],
        bears: [f64; 2],
    ) -> BodyPose {
        let mut turns = self.turns[frame].clone();
        for side in Side::BOTH {
            let leg = &self.legs[side as usize];
            let hip = pelvis + turns[0] * leg.bones[0];
            let (thigh, shank) = (turns[leg.hip] * leg.bones[1], turns[leg.knee] * leg.bones[2]);
            let (upper, lower) = (thigh.length(), shank.length());
            let (own, reach) = ((thigh + shank).length(), self.reach(frame, side));
            let goal = hip + softened(ankles[side as usize] - hip, own, reach, bears[side as usize]);
            let pole = pole(thigh, shank, goal - hip, turns[leg.hip] * leg.front);
            let straightest = reach / (upper + lower).max(1e-9);
            let solved = two_bone_ik(hip, goal, upper, lower, pole, straightest);
            turns[leg.hip] = (shortest_arc(thigh, solved.middle - hip) * turns[leg.hip]).normalize();
            turns[leg.knee] = (shortest_arc(shank, solved.end - solved.middle) * turns[leg.knee]).normalize();
            let [foot, toes] = feet[side as usize];
            turns[leg.ankle] = if self.body.joints[leg.ankle].animated { foot } else { turns[leg.knee] };
            if let Some(at) = leg.toes {
                let bends = self.body.feet[side as usize].toe.is_some() && self.body.joints[at].animated;
                turns[at] = if bends { toes } else { turns[leg.ankle] };
            }
        }
        BodyPose { hips: pelvis + turns[0] * self.to_hips, turns }
    }
}

fn leg_roles(side: Side) -> [Role; 2] {
    match side {
        Side::Left => [Role::LeftUpperLeg, Role::LeftLowerLeg],
        Side::Right => [Role::RightUpperLeg, Role::RightLowerLeg],
    }
}

/// m: between the hip joints.
fn middle(body: &Body, place: &dyn Fn(usize) -> DVec3) -> DVec3 {
    let [left, right] = Side::BOTH.map(|side| place(body.joint(leg_roles(side)[0]).unwrap_or(0)));
    (left + right) * 0.5
}

/// What a leg stretches for: one that swings nears its reach more and more slowly beyond what it does by itself, so that its knee does not
/// snap straight; one that bears must be there.
fn softened(goal: DVec3, own: f64, reach: f64, bears: f64) -> DVec3 {
    let (wanted, room) = (goal.length(), reach - own);
    if wanted <= own || room < 1e-9 || bears >= 1.0 {
        return goal;
    }
    let soft = own + room * (1.0 - real::exp(-(wanted - own) / room));
    goal * ((soft + (wanted.min(reach) - soft) * bears) / wanted)
}

/// Where the knee goes: as it points in the source, for what it bends more to the front of the thigh, and never behind it.
fn pole(thigh: DVec3, shank: DVec3, target: DVec3, front: DVec3) -> DVec3 {
    let axis = (thigh + shank).normalize_or(DVec3::NEG_Y);
    let aside = |vector: DVec3| vector - axis * vector.dot(axis);
    let (now, front) = (aside(thigh), aside(front).normalize_or_zero());
    let (upper, lower) = (thigh.length(), shank.length());
    let distance = target.length().min(upper + lower).max((upper - lower).abs() + 1e-6);
    let along = (upper * upper - lower * lower + distance * distance) / (2.0 * distance);
    let then = (upper * upper - along * along).max(0.0).sqrt();
    let behind = (-now.dot(front)).max(0.0);
    now + front * ((then - now.length()).max(1e-9) + 2.0 * behind)
}
