//! The VRM T-pose of a rig: how far each joint must turn from rest for it, by role.
//!
//! Turns are global, from rest, in scenario axes, as those of a pose. What a VRM file shows without animation is its T-pose by the
//! format's own word. Any other rig is brought there: arms and fingers along X with the palms down, thumbs half way to +Z, a trunk and
//! legs that stand askew upright, soles level, feet along +Z. A trunk and legs that stand straight stay as they are: whoever wears
//! the clip has its own idea of straight. Source: the VRM 1.0 specification, "tpose".

use crate::maths::quat::shortest_arc;
use crate::maths::real;
use crate::model::{Body, Role, Side};
use crate::rig::Rig;
use glam::{DQuat, DVec3};

/// rad: a trunk that leans by less is standing.
const LEANS: f64 = 8.0 * std::f64::consts::PI / 180.0;
/// rad: a leg that stands out by less is straight down by its own idea.
const STANDS_OUT: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// rad: a knee that is bent by less is straight.
const BENT: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// (body joints) turns from rest to the T-pose. `places` are the joints at rest, in metres.
pub fn t_pose(rig: &Rig, places: &[DVec3]) -> Vec<DQuat> {
    if is_vrm(rig) {
        let still = crate::model::Clip { name: String::new(), fps: 30.0, duration: 0.0, channels: Vec::new() };
        return rig.sample(&still, 0.0).turns;
    }
    let mut pose = Raised { body: &rig.body, places, turns: vec![DQuat::IDENTITY; rig.body.joints.len()] };
    pose.trunk();
    for side in Side::BOTH {
        pose.arm(side);
        pose.leg(side);
    }
    pose.turns
}

/// Whether the file says itself what its T-pose is.
pub fn is_vrm(rig: &Rig) -> bool {
    rig.mapping.method.starts_with("vrm")
}

struct Raised<'a> {
    body: &'a Body,
    places: &'a [DVec3],
    turns: Vec<DQuat>,
}

impl Raised<'_> {
    /// Turns a joint and all that hangs from it by `turn`, beyond what they are turned already.
    fn carry(&mut self, joint: usize, turn: DQuat) {
        let mut moved = vec![false; self.turns.len()];
        for index in 0..self.turns.len() {
            moved[index] = index == joint || self.body.joints[index].parent.is_some_and(|parent| moved[parent]);
            if moved[index] {
                self.turns[index] = (turn * self.turns[index]).normalize();
            }
        }
    }

    /// A joint that a node moves: no other can be turned apart from its parent.
    fn joint(&self, role: Role) -> Option<usize> {
        self.body.joint(role).filter(|joint| self.body.joints[*joint].animated)
    }

    /// At rest, from one joint to another.
    fn between(&self, from: Role, to: Role) -> Option<DVec3> {
        Some(self.places[self.body.joint(to)?] - self.places[self.body.joint(from)?])
    }

    /// Lets the part from `role` to `next` point that way.
    fn point(&mut self, role: Role, next: Role, to: DVec3) {
        let (Some(joint), Some(along)) = (self.joint(role), self.between(role, next)) else { return };
        let along = (self.turns[joint] * along).normalize_or_zero();
        if along != DVec3::ZERO {
            self.carry(joint, shortest_arc(along, to));
        }
    }

    /// Upright where it leans, hips and shoulders across X.
    fn trunk(&mut self) {
        use Role::{Hips, LeftUpperArm, LeftUpperLeg, RightUpperArm, RightUpperLeg};
        let middle = |left: Role| {
            let place = |role: Role| self.body.joint(role).map(|joint| self.places[joint]);
            Some((place(left)? + place(left.mirrored())?) / 2.0)
        };
        if let (Some(hips), Some(shoulders)) = (middle(LeftUpperLeg), middle(LeftUpperArm)) {
            let up = (shoulders - hips).normalize_or(DVec3::Y);
            if up.angle_between(DVec3::Y) > LEANS
                && let Some(joint) = self.joint(Hips)
            {
                self.carry(joint, shortest_arc(up, DVec3::Y));
            }
        }
        let shoulders = Role::ALL[..4].iter().rev().find(|role| self.joint(**role).is_some()).copied();
        for (role, right, left) in [
            (Some(Hips), RightUpperLeg, LeftUpperLeg),
            (shoulders.filter(|role| *role != Hips), RightUpperArm, LeftUpperArm),
        ] {
            let (Some(role), Some(across)) = (role, self.between(right, left)) else { continue };
            let Some(joint) = self.joint(role) else { continue };
            let across = self.turns[joint] * across;
            self.carry(joint, DQuat::from_rotation_y(real::atan2(across.z, across.x)));
        }
    }

    /// Along X from the shoulder to the fingertips, palm down.
    fn arm(&mut self, side: Side) {
        let out = DVec3::X * side.sign();
        let role = |role: Role| if side == Side::Left { role } else { role.mirrored() };
        self.point(role(Role::LeftUpperArm), role(Role::LeftLowerArm), out);
        self.point(role(Role::LeftLowerArm), role(Role::LeftHand), out);
        let hand = role(Role::LeftHand);
        let long = [
            [Role::LeftIndexProximal, Role::LeftIndexIntermediate, Role::LeftIndexDistal],
            [Role::LeftMiddleProximal, Role::LeftMiddleIntermediate, Role::LeftMiddleDistal],
            [Role::LeftRingProximal, Role::LeftRingIntermediate, Role::LeftRingDistal],
            [Role::LeftLittleProximal, Role::LeftLittleIntermediate, Role::LeftLittleDistal],
        ]
        .map(|finger| finger.map(role));
        // Between two knuckles the palm's width: the first finger lies ahead.
        let knuckles: Vec<Role> =
            long.iter().map(|finger| finger[0]).filter(|role| self.body.joint(*role).is_some()).collect();
        if let ([first, .., last], Some(lower)) = (knuckles.as_slice(), self.joint(role(Role::LeftLowerArm)))
            && let Some(across) = self.between(*last, *first)
        {
            let across = self.turns[lower] * across;
            if real::hypot(across.y, across.z) > 0.3 * across.length() {
                self.carry(lower, DQuat::from_rotation_x(real::atan2(across.y, across.z)));
            }
        }
        let middle: Option<DVec3> = knuckles.iter().map(|role| self.between(hand, *role)).sum::<Option<DVec3>>();
        if let (Some(joint), Some(along)) = (self.joint(hand), middle)
            && along.length() > 1e-6
        {
            let along = (self.turns[joint] * along).normalize();
            self.carry(joint, shortest_arc(along, out));
        }
        for [proximal, intermediate, distal] in long {
            self.point(proximal, intermediate, out);
            self.point(intermediate, distal, out);
        }
        let thumb = (out + DVec3::Z).normalize();
        let [metacarpal, proximal, distal] =
            [Role::LeftThumbMetacarpal, Role::LeftThumbProximal, Role::LeftThumbDistal].map(role);
        self.point(metacarpal, proximal, thumb);
        self.point(proximal, distal, thumb);
    }

    /// Under the hip where it stands out, straight where it is bent, the foot level and ahead.
    fn leg(&mut self, side: Side) {
        let role = |role: Role| if side == Side::Left { role } else { role.mirrored() };
        let [upper, lower, foot] = [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot].map(role);
        if let (Some(joint), Some(thigh), Some(shank)) =
            (self.joint(upper), self.between(upper, lower), self.between(lower, foot))
        {
            let bent = thigh.angle_between(shank) > BENT;
            let whole = self.turns[joint] * (thigh + shank);
            if bent {
                self.point(upper, lower, DVec3::NEG_Y);
                self.point(lower, foot, DVec3::NEG_Y);
            } else if whole.angle_between(DVec3::NEG_Y) > STANDS_OUT {
                self.carry(joint, shortest_arc(whole.normalize_or(DVec3::NEG_Y), DVec3::NEG_Y));
            }
        }
        let shape = &self.body.feet[side as usize];
        let ahead = DQuat::from_rotation_y(-real::atan2(shape.forward.x, shape.forward.y));
        let (level, toe, toe_level) = (shape.level, shape.toe, shape.toe_level);
        if let Some(joint) = self.joint(foot) {
            let turn = ahead * level * self.turns[joint].inverse();
            self.carry(joint, turn);
        }
        if let Some(joint) = toe.filter(|joint| self.body.joints[*joint].animated) {
            let turn = ahead * toe_level * self.turns[joint].inverse();
            self.carry(joint, turn);
        }
    }
}
