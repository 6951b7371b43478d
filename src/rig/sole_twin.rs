//! The two soles of a body beside each other: alike but for the noise of a mesh, the right one becomes the exact mirror image of the
//! left; unlike by a quarter, or one of them by no mesh, the worse measured one becomes the mirror image of the other.
//!
//! Metres; offsets from the ankle joint in scenario axes, whose middle plane is x = 0. A mesh whose weights are wrong on one side gives
//! that side another sole, and a body that rolls over it folds its shoe open. What it leaves out: legs that are no mirror images of each
//! other at rest; their soles stay as they were measured, with a note.

use super::sole::{Measured, name};
use super::sole_frame::angle_of;
use crate::model::{BodyJoint, FootShape, Side};
use glam::{DQuat, DVec2, DVec3};

/// Larger over smaller, of length, width or height over the ankle: from here on the two are not the same person's.
const UNLIKE: f64 = 1.25;
/// How far a joint may be from the other side's mirror image, share of the height (34 mm for 1.7 m).
const PAIRED: f64 = 0.02;
/// How far two soles may differ by the noise of a mesh, share of the height (1.7 mm for 1.7 m).
const NOISE: f64 = 0.001;
/// The same of directions: rad, and length of the difference of two unit vectors.
const NOISE_TURN: f64 = 0.01;
/// What a sole between ankle and ground counts for, beside the rad that it was turned by: share of the height for 1 (170 mm for 1.7 m).
const OFF_GROUND: f64 = 0.1;

/// Both feet's soles. Notes: those of the measuring, without those of a sole that was not kept, and what was mirrored. Whether one was.
pub(super) fn matched(
    measured: [Measured; 2],
    joints: &[BodyJoint],
    height: f64,
    notes: &mut Vec<String>,
) -> ([FootShape; 2], bool) {
    let [left, right] = &measured;
    let Some(difference) = difference(left, right) else {
        notes.extend(measured.iter().flat_map(|side| side.notes.clone()));
        let [left, right] = measured.map(|side| side.shape);
        let twin = if same(&left, &right, joints, height) { mirrored(&left, &right, joints) } else { right };
        return ([left, twin], false);
    };
    if !paired(&left.shape, &right.shape, joints, height) {
        notes.extend(measured.iter().flat_map(|side| side.notes.clone()));
        notes.push(format!("{difference}; the legs are not mirror images of each other, so both are used as they are"));
        return (measured.map(|side| side.shape), false);
    }
    let doubts = measured.each_ref().map(|side| doubt(side, joints, height));
    let (kept, other) = if doubts[0] <= doubts[1] { (0, 1) } else { (1, 0) };
    notes.extend(measured[kept].notes.clone());
    let sides = [Side::Left, Side::Right].map(name);
    notes.push(format!("{difference}; the {} one is used mirrored for the {} foot too", sides[kept], sides[other]));
    let image = mirrored(&measured[kept].shape, &measured[other].shape, joints);
    let mut feet = measured.map(|side| side.shape);
    feet[other] = image;
    (feet, true)
}

/// In which size two soles are unlike, or that the mesh makes one of them alone, as the beginning of a sentence.
fn difference(left: &Measured, right: &Measured) -> Option<String> {
    if left.of_mesh != right.of_mesh {
        let side = name(if left.of_mesh { Side::Left } else { Side::Right });
        return Some(format!("the mesh makes a sole of the {side} foot alone"));
    }
    let sizes =
        |Measured { shape: foot, .. }: &Measured| [foot.tip - foot.heel, 2.0 * foot.half_width, foot.ankle_height];
    let named = ["long", "wide", "high under the ankle"].into_iter().zip(sizes(left)).zip(sizes(right));
    named
        .map(|((what, left), right)| (left.max(right) / left.min(right).max(1e-6), what, left, right))
        .filter(|(ratio, ..)| *ratio > UNLIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, what, left, right)| {
            let cm = |metres: f64| 100.0 * metres;
            format!("the left sole was found {:.1} cm {what} and the right one {:.1} cm", cm(left), cm(right))
        })
}

/// Whether ankles and toe joints stand at each other's mirror image, and both have toes or neither.
fn paired(left: &FootShape, right: &FootShape, joints: &[BodyJoint], height: f64) -> bool {
    let apart = |one: usize, other: usize| flip(joints[one].rest).distance(joints[other].rest);
    let toes = |foot: &FootShape| joints.iter().position(|joint| joint.parent == Some(foot.ankle));
    apart(left.ankle, right.ankle) < PAIRED * height
        && match (toes(left), toes(right)) {
            (Some(one), Some(other)) => apart(one, other) < PAIRED * height,
            (one, other) => one == other,
        }
}

/// How little a measured sole is to be believed: what it had to be turned by to lie flat, and how far off the ground it lies at rest.
fn doubt(side: &Measured, joints: &[BodyJoint], height: f64) -> f64 {
    let shape = &side.shape;
    if !side.of_mesh {
        return f64::INFINITY;
    }
    let off = (joints[shape.ankle].rest.y - shape.ankle_height).abs();
    angle_of(shape.level) + angle_of(shape.toe_level * shape.level.inverse()) + off / (OFF_GROUND * height)
}

/// Whether they are mirror images but for the noise of a mesh.
fn same(left: &FootShape, right: &FootShape, joints: &[BodyJoint], height: f64) -> bool {
    let sizes = |foot: &FootShape| [foot.ankle_height, foot.heel, foot.ball, foot.tip, foot.half_width];
    flip(joints[left.ankle].rest).distance(joints[right.ankle].rest) < NOISE * height
        && left.toe.is_some() == right.toe.is_some()
        && sizes(left).iter().zip(sizes(right)).all(|(one, other)| (one - other).abs() < NOISE * height)
        && left.forward.distance(DVec2::new(-right.forward.x, right.forward.y)) < NOISE_TURN
        && turn(left.level).angle_between(right.level) < NOISE_TURN
        && turn(left.toe_level).angle_between(right.toe_level) < NOISE_TURN
}

/// A foot's mirror image on the other foot's joints.
fn mirrored(of: &FootShape, on: &FootShape, joints: &[BodyJoint]) -> FootShape {
    let twin = |toe: usize| joints.iter().position(|joint| joint.role == joints[toe].role.mirrored());
    FootShape {
        ankle: on.ankle,
        toe: of.toe.and_then(twin),
        level: turn(of.level),
        toe_level: turn(of.toe_level),
        forward: DVec2::new(-of.forward.x, of.forward.y),
        rear_sole: of.rear_sole.iter().copied().map(flip).collect(),
        front_sole: of.front_sole.iter().copied().map(flip).collect(),
        ..of.clone()
    }
}

fn flip(point: DVec3) -> DVec3 {
    DVec3::new(-point.x, point.y, point.z)
}

fn turn(level: DQuat) -> DQuat {
    DQuat::from_xyzw(level.x, -level.y, -level.z, level.w)
}
