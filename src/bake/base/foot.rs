//! How a base clip's foot stands, as what it differs by from a foot flat on its plant. Metres, radians.
//!
//! The difference is held at the ball (the toe joint, or the tip where there is none): a foot that rolls over its ball before it
//! lifts rolls over the clip's.

use crate::maths::real;
use crate::model::{Body, Plant, Side};
use crate::whole_body::FootTarget;
use crate::whole_body::stand::{flat_foot, foot_yaw};
use glam::{DQuat, DVec3};

/// rad, a foot that turns less out of the ground is flat on it.
const FLAT: f64 = 0.02;

/// m, at rest: from the ankle to what the foot rolls over, its toe joint, or the tip where there is none.
pub(in crate::bake) fn to_ball(body: &Body, side: Side) -> DVec3 {
    let shape = &body.feet[side as usize];
    match shape.toe {
        Some(toe) => body.joints[toe].rest - body.joints[shape.ankle].rest,
        None => {
            let ahead = DVec3::new(shape.forward.x, 0.0, shape.forward.y);
            shape.level.inverse() * (ahead * shape.tip - DVec3::Y * shape.ankle_height)
        }
    }
}

/// A foot that stands otherwise than flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootOffset {
    /// Where it stands.
    pub plant: Plant,
    foot: DQuat,    // after the flat foot's turn
    toe: DQuat,     // likewise
    ball: DVec3,    // m, as the foot points: the ball from the flat foot's
    to_ball: DVec3, // m, at rest: from ankle to ball
}

impl FootOffset {
    /// Of a foot whose ankle is there (m), turned from rest like that.
    pub fn new(body: &Body, side: Side, ankle: DVec3, foot: DQuat, toe: DQuat) -> FootOffset {
        let plant = Plant::level(DVec3::new(ankle.x, 0.0, ankle.z), foot_yaw(body, side, foot));
        let flat = flat_foot(body, side, &plant);
        let to_ball = to_ball(body, side);
        let ball = |ankle: DVec3, foot: DQuat| ankle + foot * to_ball;
        let off = ball(ankle, foot) - ball(flat.ankle, flat.foot);
        FootOffset {
            plant,
            foot: flat.foot.inverse() * foot,
            toe: flat.toe.inverse() * toe,
            ball: DQuat::from_rotation_y(-plant.yaw) * off,
            to_ball,
        }
    }

    /// From one way of holding a foot to another at the same moment.
    pub fn between(body: &Body, side: Side, from: &FootTarget, to: &FootTarget) -> FootOffset {
        let to_ball = to_ball(body, side);
        let ball = |target: &FootTarget| target.ankle + target.foot * to_ball;
        FootOffset {
            plant: Plant::level(DVec3::new(to.ankle.x, 0.0, to.ankle.z), to.yaw),
            foot: from.foot.inverse() * to.foot,
            toe: from.toe.inverse() * to.toe,
            ball: DQuat::from_rotation_y(-from.yaw) * (ball(to) - ball(from)),
            to_ball,
        }
    }

    /// That foot with so much of the difference, 0..1.
    pub fn on(&self, target: &FootTarget, share: f64) -> FootTarget {
        if share <= 0.0 {
            return *target;
        }
        let some = |turn: DQuat| if share >= 1.0 { turn } else { DQuat::IDENTITY.slerp(turn, share) };
        let foot = (target.foot * some(self.foot)).normalize();
        let toe = (target.toe * some(self.toe)).normalize();
        let ball = target.ankle + target.foot * self.to_ball + DQuat::from_rotation_y(target.yaw) * self.ball * share;
        FootTarget { ankle: ball - foot * self.to_ball, foot, toe, ..*target }
    }

    /// Does it turn out of the flat foot by no more than a soft sole gives?
    pub fn is_flat(&self) -> bool {
        self.foot.angle_between(DQuat::IDENTITY) < FLAT
    }

    /// rad, how far the heel is up.
    pub fn pitch(&self, body: &Body, side: Side) -> f64 {
        let level = body.feet[side as usize].level;
        let ahead = level * self.foot * level.inverse();
        let shape = &body.feet[side as usize];
        let forward = DVec3::new(shape.forward.x, 0.0, shape.forward.y);
        -real::asin((ahead * forward).y.clamp(-1.0, 1.0))
    }
}
