//! Things in the world beside the body: balls that fly, hit and roll, and what they gave to whom.
//!
//! Scenario space, SI. Balls are rigid spheres that meet the body's boxes, the ground and one another; they are there from a
//! moment before they arrive, and for good. Their contact forces are the engine's own.

use super::figure::Figure;
use super::world::{World, double, rotation, vector};
use glam::{DQuat, DVec3};
use rapier3d::prelude::*;

/// Balls meet all.
const BALL: InteractionGroups = InteractionGroups::new(
    Group::GROUP_3,
    Group::GROUP_1.union(Group::GROUP_2).union(Group::GROUP_3),
    InteractionTestMode::And,
);
/// Share of the closing speed that a ball bounces with.
const RESTITUTION: f32 = 0.35;
/// m, from how far away a contact is foreseen: what a fast ball makes in a tick, and a bit.
const FORESEEN: f32 = 0.2;
/// Of a ball's skin.
const FRICTION: f32 = 0.6;
/// 1/s, what rolling and the air take.
const DRAG: [f32; 2] = [0.05, 0.8];

/// A sphere in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    body: RigidBodyHandle,
    collider: ColliderHandle,
}

/// What a ball gave a link in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// Which link.
    pub link: usize,
    /// N s, on the link.
    pub impulse: DVec3,
    /// m, where its box was met.
    pub point: DVec3,
}

impl World {
    /// Lets a ball loose; its number.
    pub fn throw(&mut self, radius: f64, mass: f64, place: DVec3, velocity: DVec3) -> usize {
        let body = RigidBodyBuilder::dynamic()
            .translation(vector(place))
            .linvel(vector(velocity))
            .linear_damping(DRAG[0])
            .angular_damping(DRAG[1])
            // Contacts are foreseen; hard CCD would hold links back against their joints.
            .soft_ccd_prediction(FORESEEN)
            .can_sleep(false);
        let collider = ColliderBuilder::ball(radius as f32)
            .mass(mass as f32)
            .friction(FRICTION)
            .restitution(RESTITUTION)
            .restitution_combine_rule(CoefficientCombineRule::Max)
            .collision_groups(BALL);
        let (body, collider) = self.physics.insert(body, collider);
        self.spheres.push(Sphere { body, collider });
        self.spheres.len() - 1
    }

    /// m, turn and m/s of a ball.
    pub fn ball(&self, number: usize) -> (DVec3, DQuat, DVec3) {
        let body = &self.physics.bodies[self.spheres[number].body];
        let turn = body.rotation();
        let turn = DQuat::from_xyzw(turn.x.into(), turn.y.into(), turn.z.into(), turn.w.into()).normalize();
        (double(body.translation()), turn, double(body.linvel()))
    }

    /// What a ball gave to links in the last tick.
    pub fn blows(&self, figure: &Figure, number: usize) -> Vec<Blow> {
        let sphere = self.spheres[number];
        let centre = self.physics.bodies[sphere.body].translation();
        let mut blows = Vec::new();
        for pair in self.physics.narrow_phase.contact_pairs_with(sphere.collider) {
            let first = pair.collider1 == sphere.collider;
            let other = if first { pair.collider2 } else { pair.collider1 };
            let Some(link) = (0..figure.links.len()).find(|link| self.boxes[*link] == other) else { continue };
            let impulse = double(pair.total_impulse()) * if first { 1.0 } else { -1.0 };
            if impulse.length() <= 0.0 {
                continue;
            }
            let collider = &self.physics.colliders[other];
            let point = collider.shape().project_point(collider.position(), centre, true).point;
            blows.push(Blow { link, impulse, point: double(point) });
        }
        blows.sort_by_key(|blow| blow.link);
        blows
    }

    /// What is wrong with the balls, for a person.
    pub fn broken_ball(&self) -> Option<String> {
        let bad = |sphere: &Sphere| {
            let body = &self.physics.bodies[sphere.body];
            !double(body.translation()).is_finite() || double(body.linvel()).length() > super::world::FASTEST
        };
        self.spheres.iter().position(bad).map(|number| format!("ball {} is out of bounds", number + 1))
    }

    /// Takes a ball away that has rolled out of sight.
    pub fn forget(&mut self, number: usize) {
        let pose = Pose::from_parts(vector(DVec3::new(500.0 + number as f64, 500.0, 0.0)), rotation(DQuat::IDENTITY));
        if let Some(body) = self.physics.bodies.get_mut(self.spheres[number].body) {
            body.set_position(pose, false);
            body.set_enabled(false);
        }
    }
}
