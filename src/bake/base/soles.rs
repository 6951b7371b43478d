//! A base clip's stand as a body can have it whose soles lie flat on the ground. Scenario space, m.

use super::Stood;
use crate::bake::played::leg::{self, Foot};
use crate::model::{Body, BodyPose, Side};
use crate::whole_body::Anatomy;
use crate::whole_body::stand::flat_foot;
use glam::{DQuat, DVec3};

/// Part of its length that a leg uses at most.
const STRAIGHTEST: f64 = 0.995;
/// Rounds of lowering a body whose legs are too short.
const ROUNDS: usize = 3;

/// rad: thighs that are turned by more about their own length, against where the foot points, do not tell how hips go.
const TWISTED: f64 = 60.0 * std::f64::consts::PI / 180.0;

impl Stood {
    /// What of this stand the articulated body cannot take, for a person.
    pub(in crate::bake) fn unplayed(&self, anatomy: &Anatomy) -> Option<&'static str> {
        if self.feet_and_balls().iter().any(|(_, ball)| *ball) {
            return Some("[base] that stands on the balls of its feet");
        }
        let turns = &self.base.at(0.0).pose.turns;
        let twisted = Side::BOTH.into_iter().any(|side| {
            let leg = &anatomy.legs[side as usize];
            let hinge = (turns[leg.upper] * leg.thigh_from_rest.inverse() * DVec3::X).with_y(0.0);
            let across = DQuat::from_rotation_y(self.feet[side as usize].plant.yaw) * DVec3::X;
            hinge.angle_between(across) > TWISTED
        });
        twisted.then_some("[base] whose thighs are turned about their own length by more than 60 degrees")
    }

    /// The clip's first pose with its soles flat where they stand, and by how much it is moved for that, m.
    pub(in crate::bake) fn on_soles(&self, body: &Body, anatomy: &Anatomy) -> (BodyPose, DVec3) {
        let mut pose = self.base.at(0.0).pose;
        let before = pose.hips;
        let feet = Side::BOTH.map(|side| {
            let flat = flat_foot(body, side, &self.feet[side as usize].plant);
            Foot { ankle: flat.ankle, foot: flat.foot, toe: flat.toe }
        });
        let positions = pose.positions(body);
        let up = Side::BOTH.map(|side| feet[side as usize].ankle.y - positions[anatomy.legs[side as usize].foot].y);
        pose.hips.y += 0.5 * (up[0] + up[1]);
        for _ in 0..ROUNDS {
            let positions = pose.positions(body);
            let short = Side::BOTH.map(|side| {
                let leg = &anatomy.legs[side as usize];
                let far = positions[leg.upper] - feet[side as usize].ankle;
                let long = STRAIGHTEST * leg.length();
                far.y - (long * long - far.with_y(0.0).length_squared()).max(0.0).sqrt()
            });
            pose.hips.y -= short[0].max(short[1]).max(0.0);
        }
        let positions = pose.positions(body);
        for side in Side::BOTH {
            leg::reach(body, anatomy, &mut pose, &positions, (side, None), &feet[side as usize]);
        }
        let moved = pose.hips - before;
        (pose, moved)
    }
}
