//! A synthetic humanoid for tests: 1.7 m, 80 kg, arms down, legs straight, box feet flat on the ground, symmetric.
//!
//! Scenario space. Masses after de Leva (1996), rounded; segments are rods with a girth. No rig and no file stands
//! behind it, so what a test expects of it can be worked out by hand.

use super::{Frame, HeldContact, Motion};
use crate::model::{Body, BodyJoint, BodyPose, FootShape, Role, Segment, Side, report::Part};
use glam::{DMat3, DQuat, DVec2, DVec3, dvec3};

/// The humanoid: 19 joints.
pub(crate) fn body() -> Body {
    let mut joints: Vec<BodyJoint> = Vec::new();
    let mut segments: Vec<Segment> = Vec::new();
    let mut add = |role: Role, parent: Option<Role>, rest: DVec3, share: f64, centre: DVec3, half: f64| {
        let parent =
            parent.map(|parent| joints.iter().position(|j: &BodyJoint| j.role == parent).expect("parents first"));
        joints.push(BodyJoint { role, parent, rest, animated: true });
        if share > 0.0 {
            let mass = 80.0 * share;
            let (long, girth) = (mass * half * half / 3.0, mass * 0.002);
            let along = centre.normalize_or(DVec3::Y).abs();
            let diagonal = DVec3::splat(long + girth) - along * long;
            segments.push(Segment { joint: joints.len() - 1, mass, centre, inertia: DMat3::from_diagonal(diagonal) });
        }
    };
    add(Role::Hips, None, dvec3(0.0, 0.92, 0.0), 0.112, dvec3(0.0, 0.05, 0.0), 0.07);
    add(Role::Spine, Some(Role::Hips), dvec3(0.0, 1.02, 0.0), 0.163, dvec3(0.0, 0.08, 0.0), 0.10);
    add(Role::Chest, Some(Role::Spine), dvec3(0.0, 1.20, 0.0), 0.160, dvec3(0.0, 0.10, 0.0), 0.12);
    add(Role::Neck, Some(Role::Chest), dvec3(0.0, 1.43, 0.0), 0.0, DVec3::ZERO, 0.0);
    add(Role::Head, Some(Role::Neck), dvec3(0.0, 1.50, 0.0), 0.069, dvec3(0.0, 0.10, 0.0), 0.10);
    for side in Side::BOTH {
        let x = side.sign();
        let role = |left: Role| if side == Side::Left { left } else { left.mirrored() };
        add(
            role(Role::LeftUpperArm),
            Some(Role::Chest),
            dvec3(0.18 * x, 1.40, 0.0),
            0.027,
            dvec3(0.0, -0.15, 0.0),
            0.14,
        );
        add(
            role(Role::LeftLowerArm),
            Some(role(Role::LeftUpperArm)),
            dvec3(0.18 * x, 1.12, 0.0),
            0.016,
            dvec3(0.0, -0.11, 0.0),
            0.12,
        );
        add(
            role(Role::LeftHand),
            Some(role(Role::LeftLowerArm)),
            dvec3(0.18 * x, 0.87, 0.0),
            0.006,
            dvec3(0.0, -0.07, 0.0),
            0.08,
        );
        add(
            role(Role::LeftUpperLeg),
            Some(Role::Hips),
            dvec3(0.10 * x, 0.90, 0.0),
            0.142,
            dvec3(0.0, -0.17, 0.0),
            0.20,
        );
        add(
            role(Role::LeftLowerLeg),
            Some(role(Role::LeftUpperLeg)),
            dvec3(0.10 * x, 0.49, 0.0),
            0.043,
            dvec3(0.0, -0.18, 0.0),
            0.20,
        );
        add(
            role(Role::LeftFoot),
            Some(role(Role::LeftLowerLeg)),
            dvec3(0.10 * x, 0.08, 0.0),
            0.011,
            dvec3(0.0, -0.05, 0.05),
            0.10,
        );
        add(
            role(Role::LeftToes),
            Some(role(Role::LeftFoot)),
            dvec3(0.10 * x, 0.02, 0.12),
            0.003,
            dvec3(0.0, -0.005, 0.03),
            0.03,
        );
    }
    // What the rounded shares leave goes to the chest.
    let short = 80.0 - segments.iter().map(|segment| segment.mass).sum::<f64>();
    segments[2].mass += short;
    let feet = Side::BOTH.map(|side| {
        let find = |left: Role| {
            let role = if side == Side::Left { left } else { left.mirrored() };
            joints.iter().position(|joint| joint.role == role).expect("it was added")
        };
        let corner = |x: f64, z: f64| dvec3(x, -0.08, z);
        FootShape {
            ankle: find(Role::LeftFoot),
            toe: Some(find(Role::LeftToes)),
            level: DQuat::IDENTITY,
            toe_level: DQuat::IDENTITY,
            ankle_height: 0.08,
            forward: DVec2::Y,
            heel: -0.06,
            ball: 0.12,
            tip: 0.19,
            half_width: 0.045,
            rear_sole: [-0.06, 0.0, 0.06, 0.12].iter().flat_map(|z| [corner(-0.045, *z), corner(0.045, *z)]).collect(),
            front_sole: [0.12, 0.19].iter().flat_map(|z| [corner(-0.045, *z), corner(0.045, *z)]).collect(),
        }
    });
    Body {
        joints,
        segments,
        feet,
        mass: 80.0,
        height: 1.7,
        leg_length: 0.82,
        flanks: [0.0; 2],
        belly: 0.0,
        flesh: vec![],
    }
}

/// The body's centre of mass at rest.
pub(crate) fn com(body: &Body) -> DVec3 {
    let pose = BodyPose::rest(body);
    pose.centre_of_mass(body, &pose.positions(body))
}

/// Samples: the rest pose, changed by a function of the sample's number.
pub(crate) fn poses(body: &Body, count: usize, mut change: impl FnMut(&mut BodyPose, f64)) -> Vec<BodyPose> {
    (0..count)
        .map(|sample| {
            let mut pose = BodyPose::rest(body);
            change(&mut pose, sample as f64);
            pose
        })
        .collect()
}

/// A motion at 120 Hz of 30 fps.
pub(crate) fn motion<'a>(body: &'a Body, poses: &'a [BodyPose]) -> Motion<'a> {
    Motion { body, hz: 120.0, per_frame: 4, poses }
}

/// A flat contact on the ground at y = 0.
pub(crate) fn flat(side: Side, start: f64, end: f64) -> HeldContact {
    HeldContact { side, part: Part::Flat, start, end, point: DVec3::ZERO, normal: DVec3::Y, frame: Frame::World }
}

/// Both feet flat for good.
pub(crate) fn standing() -> [HeldContact; 2] {
    Side::BOTH.map(|side| flat(side, 0.0, 1e3))
}
