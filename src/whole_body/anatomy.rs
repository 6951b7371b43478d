//! A body's chains and the frames that make its bind pose irrelevant. Scenario space at rest, radians.
//!
//! A rig may rest in a T, an A, mid-stride or with bent knees. Here each limb segment's bind direction and hinge become
//! a rotation to a common reference: torso upright, arms straight down with the palms inwards, legs as limb frames
//! (Y up the bone, X the hinge). Angles mean the same on every rig after that. Does not look at meshes.

use crate::maths::quat::{limb_frame, shortest_arc};
use crate::maths::real;
use crate::model::{Body, Role, Side};
use glam::{DQuat, DVec3};

/// Indices into `Body::joints` and bind corrections.
#[derive(Clone, Debug)]
pub struct Anatomy {
    /// Spine joints from the pelvis up (spine, chest, upper chest: those that are there).
    pub spine: Vec<usize>,
    /// The neck, where there is one.
    pub neck: Option<usize>,
    /// The head.
    pub head: usize,
    /// Left and right arm.
    pub arms: [Arm; 2],
    /// Left and right leg.
    pub legs: [Leg; 2],
    /// Turn from rest that puts the torso upright.
    pub torso_upright: DQuat,
    /// m, hip joint to hip joint.
    pub hip_width: f64,
}

/// One arm.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "indices named after the roles")]
pub struct Arm {
    pub shoulder: Option<usize>,
    pub upper: usize,
    pub lower: usize,
    pub hand: usize,
    pub fingers: Vec<usize>,
    /// Turns from rest that hang the upper arm and the forearm straight down beside an upright torso.
    pub upper_down: DQuat,
    pub lower_down: DQuat,
    /// rad, by how much more a hanging arm is abducted for its hand to clear what the hips wear.
    pub widen: f64,
}

/// One leg.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "indices named after the roles")]
pub struct Leg {
    pub upper: usize,
    pub lower: usize,
    pub foot: usize,
    pub toe: Option<usize>,
    /// m, hip to knee and knee to ankle.
    pub thigh_length: f64,
    pub shank_length: f64,
    /// Inverse limb frames at rest.
    pub thigh_from_rest: DQuat,
    pub shank_from_rest: DQuat,
}

impl Anatomy {
    /// Reads the chains of a body that has the roles `Body` promises.
    pub fn new(body: &Body) -> Anatomy {
        let index = |role: Role| body.joint(role).unwrap_or(0);
        let rest = |joint: usize| body.joints[joint].rest;
        let spine: Vec<usize> =
            [Role::Spine, Role::Chest, Role::UpperChest].into_iter().filter_map(|role| body.joint(role)).collect();
        let hips_middle = (rest(index(Role::LeftUpperLeg)) + rest(index(Role::RightUpperLeg))) * 0.5;
        let shoulders_middle = (rest(index(Role::LeftUpperArm)) + rest(index(Role::RightUpperArm))) * 0.5;
        let trunk = (shoulders_middle - hips_middle) * DVec3::new(0.0, 1.0, 1.0);
        let lean = real::atan2(trunk.z, trunk.y);
        // A few degrees either way are how characters are drawn; more is a bind pose that is not a stand.
        let torso_upright =
            if lean.abs() > 6_f64.to_radians() { DQuat::from_rotation_x(-lean) } else { DQuat::IDENTITY };
        let arms = Side::BOTH.map(|side| Arm::new(body, side));
        let legs = Side::BOTH.map(|side| Leg::new(body, side));
        let hip_width = (rest(legs[0].upper) - rest(legs[1].upper)).length();
        Anatomy { spine, neck: body.joint(Role::Neck), head: index(Role::Head), arms, legs, torso_upright, hip_width }
    }
}

impl Arm {
    fn new(body: &Body, side: Side) -> Arm {
        use Role::*;
        let (shoulder, upper, lower, hand, prefix) = match side {
            Side::Left => (LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand, "left"),
            Side::Right => (RightShoulder, RightUpperArm, RightLowerArm, RightHand, "right"),
        };
        let index = |role: Role| body.joint(role).unwrap_or(0);
        let (upper, lower, hand) = (index(upper), index(lower), index(hand));
        let rest = |joint: usize| body.joints[joint].rest;
        let fingers = (0..body.joints.len())
            .filter(|joint| {
                let name = body.joints[*joint].role.name();
                name.starts_with(prefix)
                    && ["Thumb", "Index", "Middle", "Ring", "Little"].iter().any(|finger| name.contains(finger))
            })
            .collect();
        Arm {
            shoulder: body.joint(shoulder),
            upper,
            lower,
            hand,
            fingers,
            upper_down: shortest_arc(rest(lower) - rest(upper), DVec3::NEG_Y),
            lower_down: shortest_arc(rest(hand) - rest(lower), DVec3::NEG_Y),
            widen: super::stand::widening(
                [rest(lower).distance(rest(upper)), rest(hand).distance(rest(lower))],
                side.sign() * rest(upper).x,
                body.flanks[side as usize],
            ),
        }
    }
}

impl Leg {
    fn new(body: &Body, side: Side) -> Leg {
        use Role::*;
        let (upper, lower, foot) = match side {
            Side::Left => (LeftUpperLeg, LeftLowerLeg, LeftFoot),
            Side::Right => (RightUpperLeg, RightLowerLeg, RightFoot),
        };
        let index = |role: Role| body.joint(role).unwrap_or(0);
        let (upper, lower, foot) = (index(upper), index(lower), index(foot));
        let rest = |joint: usize| body.joints[joint].rest;
        let (thigh, shank) = (rest(lower) - rest(upper), rest(foot) - rest(lower));
        // The knee's hinge: square to the plane of a bent knee; of a straight one, to where the foot points.
        let shape = &body.feet[side as usize];
        let across = DVec3::new(shape.forward.y, 0.0, -shape.forward.x);
        let bent = thigh.normalize_or_zero().cross(shank.normalize_or_zero());
        let hinge = if bent.length() > real::sin(15_f64.to_radians()) && bent.dot(across) > 0.5 * bent.length() {
            bent.normalize()
        } else {
            across
        };
        Leg {
            upper,
            lower,
            foot,
            toe: shape.toe,
            thigh_length: thigh.length(),
            shank_length: shank.length(),
            thigh_from_rest: limb_frame(thigh, hinge).inverse(),
            shank_from_rest: limb_frame(shank, hinge).inverse(),
        }
    }

    /// m, hip to ankle along the straight leg.
    pub fn length(&self) -> f64 {
        self.thigh_length + self.shank_length
    }

    /// rad, the knee's bend with the ankle `distance` m from the hip; 0 past the straight leg.
    pub fn bend_at(&self, distance: f64) -> f64 {
        let (a, b) = (self.thigh_length, self.shank_length);
        real::acos(((distance * distance - a * a - b * b) / (2.0 * a * b).max(1e-12)).clamp(-1.0, 1.0))
    }

    /// m from hip to ankle at a bend of the knee.
    pub fn length_at(&self, bend: f64) -> f64 {
        let (a, b) = (self.thigh_length, self.shank_length);
        (a * a + b * b + 2.0 * a * b * real::cos(bend)).max(0.0).sqrt()
    }
}
