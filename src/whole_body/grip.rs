//! A box in both hands: where it is held, what the arms do, how far the trunk leans back. Metres, radians.
//!
//! Elbows near a right angle, the box level against the belly, a palm on either side of it. Box and arms are rigid with the
//! upper trunk, so all of it is worked out once, in the frame of the upright chest with its origin at the uppermost joint
//! of the spine. It leaves out fingers that close and boxes wider than the arms can span: there the palms are as far out
//! as they come.

use super::anatomy::Anatomy;
use super::solve::Hold;
use super::stand::TRUNK_LEAN;
use crate::maths::curve::soft_limit;
use crate::maths::quat::limb_frame;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::load::Form;
use crate::model::{Body, Load, Role, Side};
use glam::{DQuat, DVec3};

/// Share of the upper arm by which the hands are under the shoulders.
const HAND_DROP: f64 = 0.95;
/// Wrist to the middle of the palm, over the forearm.
const PALM: f64 = 0.35;
/// m by height: a palm's half thickness.
const PALM_HALF: f64 = 0.012;
/// Belly ahead of the hips, by height, where there is no mesh.
const BELLY: f64 = 0.07;
/// Share of the load's moment that leaning back makes up for; the pelvis does the rest.
const LEAN_SHARE: f64 = 0.5;
/// rad, the farthest that the trunk leans back.
const MOST_LEAN: f64 = 16.0 * std::f64::consts::PI / 180.0;
/// The upper body over the hips: part of the mass, and its centre's height by the body's.
const UPPER: (f64, f64) = (0.62, 0.18);

/// How a box is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// The joint that it moves with.
    pub joint: usize,
    /// m, the box's centre from that joint at rest.
    pub centre: DVec3,
    /// What the joint's turn is multiplied with to turn the box.
    pub level: DQuat,
    ahead: f64,            // m, box centre ahead of the spine
    arms: [[DQuat; 2]; 2], // left, right: upper arm and forearm from hanging, relative to the chest
    size: DVec3,           // m: across, up, forward
    wrists: [DVec3; 2],    // m, from the box's centre along its edges
    body: (f64, f64),      // kg, m height
}

impl Grip {
    /// For a box of that size (m: across, up, forward) whose greatest mass is `heaviest` (kg) and greatest depth `deepest` (m): under
    /// those it is level.
    pub fn new(body: &Body, anatomy: &Anatomy, size: DVec3, (heaviest, deepest): (f64, f64)) -> Grip {
        let upright = anatomy.torso_upright;
        let joint = anatomy.spine.last().copied().unwrap_or(0);
        let of = |other: usize| upright * (body.joints[other].rest - body.joints[joint].rest);
        let shoulder = |side: Side| of(anatomy.arms[side as usize].upper);
        let length = |side: Side| {
            let arm = &anatomy.arms[side as usize];
            let rest = |joint: usize| body.joints[joint].rest;
            [rest(arm.upper).distance(rest(arm.lower)), rest(arm.lower).distance(rest(arm.hand))]
        };
        let [upper, forearm] = [0, 1].map(|bone| 0.5 * (length(Side::Left)[bone] + length(Side::Right)[bone]));
        let spine = of(body.joint(Role::Hips).unwrap_or(0));
        let belly = spine.z + if body.belly > 0.0 { body.belly } else { BELLY * body.height };
        let mut grip = Grip {
            joint,
            centre: DVec3::ZERO,
            level: DQuat::IDENTITY,
            ahead: belly + 0.5 * size.z - spine.z,
            arms: [[DQuat::IDENTITY; 2]; 2],
            size,
            wrists: [DVec3::ZERO; 2],
            body: (body.mass, body.height),
        };
        // The level frame about the joint, in which the chest is turned by what it leans.
        let most = Grip { ahead: belly + 0.5 * deepest - spine.z, ..grip.clone() };
        let chest = DQuat::from_rotation_x(TRUNK_LEAN - most.lean(heaviest));
        let level = chest.inverse();
        let middle = chest * ((shoulder(Side::Left) + shoulder(Side::Right)) * 0.5);
        let hands = middle.y - HAND_DROP * upper;
        let front = (chest.slerp(DQuat::IDENTITY, 0.4) * DVec3::new(0.0, spine.y, belly)).z;
        let centre = DVec3::new(middle.x, hands, front + 0.5 * size.z);
        // As far forward as the forearms bring the palms, but on the box.
        let palm = (middle.z + 0.95 * forearm + PALM * forearm).clamp(front + 0.1 * size.z, front + 0.9 * size.z);
        for side in Side::BOTH {
            let root = shoulder(side);
            let reach = 0.7 * (upper + forearm) + (root.x - middle.x).abs();
            let out = (0.5 * size.x + PALM_HALF * body.height).min(reach);
            let wrist = DVec3::new(middle.x + side.sign() * out, hands - 0.1 * size.y, palm - PALM * forearm);
            grip.wrists[side as usize] = wrist - centre;
            let pole = level * DVec3::new(0.35 * side.sign(), -0.6, -1.0);
            let [upper, forearm] = length(side);
            let chain = two_bone_ik(root, level * wrist, upper, forearm, pole, 0.98);
            let (above, below) = (chain.middle - root, chain.end - chain.middle);
            let hinge = below.cross(above);
            grip.arms[side as usize] = [limb_frame(above, hinge), limb_frame(below, hinge)];
        }
        grip.centre = upright.inverse() * (level * centre);
        grip.level = upright.inverse() * level;
        grip
    }

    /// rad, how far the trunk leans back under a mass (kg).
    pub fn lean(&self, mass: f64) -> f64 {
        let (body, height) = self.body;
        let moment = LEAN_SHARE * mass * self.ahead;
        soft_limit(moment / (UPPER.0 * body * UPPER.1 * height), MOST_LEAN)
    }

    /// What the pose solver is told: the mass in the hands (kg) and how far they are at the box (0..1).
    pub fn hold(&self, mass: f64, arms: f64) -> Hold {
        Hold { mass, joint: self.joint, centre: self.centre, weight: arms, arms: self.arms, lean: self.lean(mass) }
    }

    /// Between this grip and another of the same box in another size.
    pub fn towards(&self, other: &Grip, share: f64) -> Grip {
        let mix = |one: DVec3, next: DVec3| one.lerp(next, share);
        Grip {
            centre: mix(self.centre, other.centre),
            ahead: self.ahead + (other.ahead - self.ahead) * share,
            arms: [0, 1].map(|side| [0, 1].map(|bone| self.arms[side][bone].slerp(other.arms[side][bone], share))),
            size: mix(self.size, other.size),
            wrists: [0, 1].map(|side| mix(self.wrists[side], other.wrists[side])),
            ..self.clone()
        }
    }

    /// The box's form at a time (s).
    pub fn form(&self, time: f64) -> Form {
        Form { time, size: self.size, centre: self.centre, wrists: self.wrists }
    }

    /// The box as a mass that moves with the trunk.
    pub fn load(&self, forms: Vec<Form>, mass: Vec<[f64; 2]>, span: [f64; 2]) -> Load {
        Load { joint: self.joint, level: self.level, forms, mass, span }
    }
}
