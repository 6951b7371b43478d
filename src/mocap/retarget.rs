//! A capture's motion on another body, by humanoid role, with its feet held where the source's bear.
//!
//! Clip space in, clip space out (m, Y up, the file's heading); the target's floor is y = 0. Segments take the source's directions
//! ([`super::retarget_turns`]); the pelvis goes the source's way scaled by leg length, at the height at which the legs that bear are as bent
//! as the source's; then feet are held ([`super::retarget_feet`]) and two-bone IK takes up what is left, the pelvis sinking where a foot that
//! bears is out of reach. Bones keep their lengths: what a capture stretches is lost. Keeps no hand off the body.

pub use super::retarget_cycle::belt;
pub use super::retarget_planted::Planted;

use super::retarget_cycle::{cycle, middle as middle_of_three, moved, stances_of_middle, three, thrice};
use super::retarget_feet::FootPlan;
use super::retarget_planted::{SourceFeet, Stance, source_feet};
use super::retarget_turns::{TurnMap, rest_frames};
use crate::maths::filter::zero_lag;
use crate::maths::quat::shortest_arc;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::capture::ToldPush;
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Capture, Role, Side};
use glam::{DQuat, DVec3};

/// m: joints that rest nearer to each other are the same.
const SAME: f64 = 1e-6;
/// A leg is no straighter than that, unless the source's was.
const STRAIGHTEST: f64 = 0.9985;
/// Nor ever than that.
const STRAIGHT: f64 = 0.9999;
/// Of the leg's length: the pelvis sinks no more for reach.
const DEEPEST: f64 = 0.15;
/// s, at a leg of 0.83 m: how long before it is needed, and after, the pelvis sinks.
const SINKS: f64 = 0.36;
/// Hz: what the height of the pelvis gets beside the scaled one changes no faster.
const SETTLES: f64 = 2.0;
/// How often legs without a foot joint are solved again.
const STIFF_PASSES: usize = 4;
/// m, m/s: a foot this far over the floor or this fast says little of how high the pelvis is.
const LIGHT: (f64, f64) = (0.02, 0.6);

/// The motion of `capture` on another body. The same fps, frames, name and clip space; the floor of the source's feet becomes y = 0. On the
/// source's own body it is the source's motion.
pub fn retarget(capture: &Capture, body: &Body) -> Capture {
    retarget_by(capture, body, None)
}

/// The same, with the stances that somebody else knows (the audit, the clip's own extras), by the source's frames.
pub fn retarget_with(capture: &Capture, body: &Body, planted: &[Planted]) -> Capture {
    retarget_by(capture, body, Some(planted))
}

/// When the source's feet bear, as [`retarget`] holds them; of a walk on the spot, on the ground that goes by ([`belt`]).
pub fn planted(capture: &Capture) -> Vec<Planted> {
    stances(capture).iter().map(|stance| stance.planted).collect()
}

/// The same by the part of the sole that bears: each stance in pieces, and m, how high over the source's floor it stands.
pub fn planted_parts(capture: &Capture) -> Vec<(Planted, Part, f64)> {
    let pieces = |stance: Stance| {
        let Planted { side, start, .. } = stance.planted;
        let mut pieces: Vec<(Planted, Part, f64)> = Vec::new();
        for (frame, part) in (start..).zip(&stance.parts) {
            match pieces.last_mut() {
                Some(last) if last.1 == *part => last.0.end = frame,
                _ => pieces.push((Planted { side, start: frame, end: frame }, *part, stance.height)),
            }
        }
        pieces
    };
    stances(capture).into_iter().flat_map(pieces).collect()
}

fn stances(capture: &Capture) -> Vec<Stance> {
    let (still, _) = on_its_ground(capture);
    match cycle(&still) {
        Some(travel) => stances_of_middle(source_feet(&three(&still, travel), None).stances, still.frames()),
        None => source_feet(&still, None).stances,
    }
}

/// The clip where its ground is still, and m/s, how that goes by in the clip itself.
fn on_its_ground(capture: &Capture) -> (Capture, DVec3) {
    let belt = belt(capture).unwrap_or(DVec3::ZERO);
    let mut still = capture.clone();
    if belt != DVec3::ZERO {
        moved(&mut still, -belt);
    }
    (still, belt)
}

/// Whether two bodies have the same joints at the same places.
pub fn same_joints(a: &Body, b: &Body) -> bool {
    a.joints.len() == b.joints.len()
        && a.joints.iter().zip(&b.joints).all(|(one, other)| {
            one.role == other.role && one.parent == other.parent && one.rest.abs_diff_eq(other.rest, SAME)
        })
}

fn retarget_by(capture: &Capture, body: &Body, told: Option<&[Planted]>) -> Capture {
    if same_joints(&capture.body, body) {
        let pose = |frame: usize| BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() };
        return on_body(capture, body, &(0..capture.frames()).map(pose).collect::<Vec<_>>(), Vec::new());
    }
    let (still, belt) = on_its_ground(capture);
    let frames = still.frames();
    let travel = cycle(&still);
    let mut out = match travel {
        Some(travel) => {
            let told = told.map(|told| thrice(told, frames));
            middle_of_three(&on_ground(&three(&still, travel), body, told.as_deref()), body, frames)
        }
        None => on_ground(&still, body, told),
    };
    if belt != DVec3::ZERO {
        moved(&mut out, belt * (body.leg_length / capture.body.leg_length.max(1e-6)));
        out.notes.push(format!("the clip walks on the spot: its ground goes by at {:.2} m/s", belt.length()));
    }
    if travel.is_some() {
        out.notes.push("the clip ends as it begins, and so it does here".to_owned());
    }
    out
}

/// A clip whose ground is still.
fn on_ground(capture: &Capture, body: &Body, told: Option<&[Planted]>) -> Capture {
    let source = source_feet(capture, told);
    let work = Work::new(capture, body);
    on_body(capture, body, &work.poses(&source), work.notes(&source))
}

/// The capture with other poses, of another body.
fn on_body(capture: &Capture, body: &Body, poses: &[BodyPose], notes: Vec<String>) -> Capture {
    let joints = capture.body.joints.as_slice();
    let pushes = capture.pushes.iter().map(|push| {
        let role = push.joint.and_then(|joint| joints.get(joint)).map(|joint| joint.role);
        ToldPush { joint: role.and_then(|role| body.joint(role)), ..push.clone() }
    });
    let mut out = Capture {
        name: capture.name.clone(),
        fps: capture.fps,
        body: body.clone(),
        positions: Vec::with_capacity(poses.len() * body.joints.len()),
        turns: Vec::with_capacity(poses.len() * body.joints.len()),
        units_to_metres: capture.units_to_metres,
        up: capture.up.clone(),
        confidence: capture.confidence,
        method: capture.method.clone(),
        notes: capture.notes.iter().cloned().chain(notes).collect(),
        pushes: pushes.collect(),
    };
    let mut places = Vec::new();
    for pose in poses {
        pose.positions_into(body, &mut places);
        out.positions.extend_from_slice(&places);
        out.turns.extend_from_slice(&pose.turns);
    }
    out
}

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
struct Work<'a> {
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
    fn new(capture: &'a Capture, body: &'a Body) -> Work<'a> {
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

    fn notes(&self, source: &SourceFeet) -> Vec<String> {
        let mut notes =
            vec![format!("retargeted: the way of the pelvis is {:.3} of the clip's, by leg length", self.scale)];
        let lacks: Vec<&str> = (self.body.joints.iter().filter(|joint| joint.animated))
            .filter(|joint| self.capture.body.joint(joint.role).is_none())
            .map(|joint| joint.role.name())
            .collect();
        if !lacks.is_empty() {
            notes.push(format!("the clip has no {}: they go with what they hang from", lacks.join(", ")));
        }
        let held = source.stances.len();
        notes.push(match (held, source.slides) {
            (0, 0) => "no foot of the clip stands still: none is held".to_owned(),
            (0, slides) => format!("feet slide through all of {slides} stances: none is held"),
            (held, 0) => format!("feet are held in {held} stances"),
            (held, slides) => format!("feet are held in {held} stances; {slides} more slide and are not"),
        });
        notes
    }

    fn poses(&self, source: &SourceFeet) -> Vec<BodyPose> {
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
                self.pose(frame, pelvis[frame], goals, feet)
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
                    (hip.y - highest).max(0.0) * plans[side as usize].bears[frame]
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
    fn pose(&self, frame: usize, pelvis: DVec3, ankles: [DVec3; 2], feet: [[DQuat; 2]; 2]) -> BodyPose {
        let mut turns = self.turns[frame].clone();
        for side in Side::BOTH {
            let leg = &self.legs[side as usize];
            let hip = pelvis + turns[0] * leg.bones[0];
            let (thigh, shank) = (turns[leg.hip] * leg.bones[1], turns[leg.knee] * leg.bones[2]);
            let (upper, lower) = (thigh.length(), shank.length());
            let goal = ankles[side as usize];
            let pole = pole(thigh, shank, goal - hip, turns[leg.hip] * leg.front);
            let straightest = self.reach(frame, side) / (upper + lower).max(1e-9);
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

/// Where the knee goes: as it points in the source, for what it bends more to the front of the thigh, and never behind it.
fn pole(thigh: DVec3, shank: DVec3, target: DVec3, front: DVec3) -> DVec3 {
    let axis = (thigh + shank).normalize_or(DVec3::NEG_Y);
    let aside = |vector: DVec3| vector - axis * vector.dot(axis);
    let (now, front) = (aside(thigh), aside(front).normalize_or_zero());
    let (upper, lower) = (thigh.length(), shank.length());
    let distance = target.length().clamp((upper - lower).abs() + 1e-6, (upper + lower).max(2e-6));
    let along = (upper * upper - lower * lower + distance * distance) / (2.0 * distance);
    let then = (upper * upper - along * along).max(0.0).sqrt();
    let behind = (-now.dot(front)).max(0.0);
    now + front * ((then - now.length()).max(1e-9) + 2.0 * behind)
}
