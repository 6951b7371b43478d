//! A capture's motion on another body, by humanoid role, with its feet held where the source's bear.
//!
//! Clip space in, clip space out (m, Y up, the file's heading); the target's floor is y = 0. Segments take the source's directions
//! ([`super::retarget_turns`]); the pelvis goes the source's way scaled by leg length, at the height at which the legs that bear are as bent
//! as the source's; then feet are held ([`super::retarget_feet`]) and two-bone IK takes up what is left, the pelvis sinking where a foot that
//! bears is out of reach. Bones keep their lengths: what a capture stretches is lost. Keeps no hand off the body.

pub use super::retarget_planted::Planted;

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
const SINKS: f64 = 0.2;
/// Hz: what the height of the pelvis gets beside the scaled one changes no faster.
const SETTLES: f64 = 3.0;
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

/// When the source's feet bear, as [`retarget`] holds them.
pub fn planted(capture: &Capture) -> Vec<Planted> {
    source_feet(capture, None).stances.iter().map(|stance| stance.planted).collect()
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
    source_feet(capture, None).stances.into_iter().flat_map(pieces).collect()
}

/// Whether two bodies have the same joints at the same places.
pub fn same_joints(a: &Body, b: &Body) -> bool {
    a.joints.len() == b.joints.len()
        && a.joints.iter().zip(&b.joints).all(|(one, other)| {
            one.role == other.role && one.parent == other.parent && one.rest.abs_diff_eq(other.rest, SAME)
        })
}

fn retarget_by(capture: &Capture, body: &Body, told: Option<&[Planted]>) -> Capture {
    let mut notes = capture.notes.clone();
    let poses: Vec<BodyPose> = if same_joints(&capture.body, body) {
        (0..capture.frames())
            .map(|frame| BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() })
            .collect()
    } else {
        let source = source_feet(capture, told);
        let work = Work::new(capture, body);
        notes.extend(work.notes(&source));
        work.poses(&source)
    };
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
        notes,
        pushes: capture
            .pushes
            .iter()
            .map(|push| {
                let role = push.joint.map(|joint| capture.body.joints[joint].role);
                ToldPush { joint: role.and_then(|role| body.joint(role)), ..push.clone() }
            })
            .collect(),
    };
    let mut places = Vec::new();
    for pose in &poses {
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
        let mut notes = vec![format!("retargeted: the way of the pelvis is {:.3} of the clip's, by leg length", self.scale)];
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
        let frames = self.capture.frames();
        if frames == 0 {
            return Vec::new();
        }
        let fps = self.capture.fps;
        let plans = Side::BOTH.map(|side| {
            let leg = &self.legs[side as usize];
            let toe = self.body.feet[side as usize].toe.unwrap_or(leg.ankle);
            let raw: Vec<[DQuat; 2]> = self.turns.iter().map(|turns| [turns[leg.ankle], turns[toe]]).collect();
            FootPlan::new(self.body, side, &raw, source, self.scale, fps)
        });
        let mut pelvis = self.pelvis(source, &plans);
        let ankles = Side::BOTH.map(|side| {
            let own: Vec<DVec3> = (0..frames).map(|frame| pelvis[frame] + self.hanging(frame, side)).collect();
            plans[side as usize].ankles(&own)
        });
        let sinks = self.sinking(&pelvis, &ankles, &plans);
        for (place, sunk) in pelvis.iter_mut().zip(sinks) {
            place.y -= sunk;
        }
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
        let scaled: Vec<DVec3> =
            own.iter().map(|own| first + (*own - first - DVec3::Y * floor) * self.scale).collect();
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
        // Each need is a hat with eased sides; their maximum, and no corner in it.
        let tempo = (self.body.leg_length / 0.83).max(0.01).sqrt();
        let wide = (SINKS * tempo * self.capture.fps).round().max(2.0) as usize;
        let hats: Vec<f64> = (0..pelvis.len())
            .map(|frame| {
                let near = frame.saturating_sub(wide)..=(frame + wide).min(pelvis.len() - 1);
                near.map(|at| {
                    let u = 1.0 - at.abs_diff(frame) as f64 / wide as f64;
                    need[at] * u * u * (3.0 - 2.0 * u)
                })
                .fold(0.0, f64::max)
            })
            .collect();
        zero_lag(&hats, 2.0 * SETTLES / tempo, self.capture.fps).into_iter().zip(&need).map(|(a, b)| a.max(*b)).collect()
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
