//! Things in the world beside the body: balls that fly, hit and roll, and what they gave to whom; a box in both hands.
//!
//! Scenario space, SI. Balls are rigid spheres that meet the body's boxes, the ground and one another; they are there from a
//! moment before they arrive, and for good. Their contact forces are the engine's own.

use super::figure::{Figure, Part, steiner};
use super::world::{LinkState, World, double, rotation, vector};
use crate::model::Side;
use glam::{DMat3, DQuat, DVec3};
use rapier3d::prelude::*;

/// Balls meet all.
const BALL: InteractionGroups = InteractionGroups::new(
    Group::GROUP_3,
    Group::GROUP_1.union(Group::GROUP_2).union(Group::GROUP_3).union(Group::GROUP_4),
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

/// A box held by both hands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    body: RigidBodyHandle,
    size: DVec3,
}

/// The box meets the ground and balls, not who holds it.
const BOX: InteractionGroups =
    InteractionGroups::new(Group::GROUP_4, Group::GROUP_2.union(Group::GROUP_3), InteractionTestMode::And);
/// kg, the least that the engine's box weighs.
const LIGHTEST: f64 = 0.05;

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
        (double(body.translation()), quat(*body.rotation()), double(body.linvel()))
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

    /// Puts a box (m: across, up, forward) between the hands where they are, joined to both.
    pub fn take_up(&mut self, figure: &Figure, size: DVec3, mass: f64, centre: DVec3, turn: DQuat) {
        self.let_go();
        let hands = Side::BOTH.map(|side| figure.links.iter().position(|link| link.part == Part::Hand(side)));
        let [Some(left), Some(right)] = hands else { return };
        let half = vector(0.5 * size);
        let pose = Pose::from_parts(vector(centre), rotation(turn));
        let body = RigidBodyBuilder::dynamic().pose(pose).can_sleep(false);
        let collider = ColliderBuilder::cuboid(half.x, half.y, half.z).density(0.0).friction(0.5).collision_groups(BOX);
        let (body, _) = self.physics.insert(body, collider);
        for link in [left, right] {
            let at = self.physics.bodies[self.links[link]].position();
            let back = quat(at.rotation).inverse();
            let frame = Pose::from_parts(vector(back * (centre - double(at.translation))), rotation(back * turn));
            self.physics.insert_impulse_joint(self.links[link], body, FixedJointBuilder::new().local_frame1(frame));
        }
        self.held = Some(Held { body, size });
        self.weigh(mass);
    }

    /// The box weighs that now (kg).
    pub fn weigh(&mut self, mass: f64) {
        let Some(held) = self.held else { return };
        let mass = mass.max(LIGHTEST);
        let inertia = cuboid(held.size, mass);
        let properties = MassProperties::new(Vector::ZERO, mass as f32, vector(inertia));
        if let Some(body) = self.physics.bodies.get_mut(held.body) {
            body.set_additional_mass_properties(properties, true);
        }
    }

    /// Where the box is: centre, turn, size; `None` without one.
    pub fn held_box(&self) -> Option<(DVec3, DQuat, DVec3)> {
        let held = self.held?;
        let pose = self.physics.bodies[held.body].position();
        Some((double(pose.translation), quat(pose.rotation), held.size))
    }

    /// The box is gone.
    pub fn let_go(&mut self) {
        if let Some(held) = self.held.take() {
            self.physics.remove_body(held.body);
        }
        self.offsets.fill(DVec3::ZERO);
    }

    /// The figure as the law is to see it: each hand with half of the box (kg), which moves as the hand does.
    pub fn laden(&mut self, figure: &Figure, states: &[LinkState], mass: f64) -> Option<Figure> {
        let (centre, turn, size) = self.held_box()?;
        let mut laden = figure.clone();
        let half = 0.5 * mass.max(LIGHTEST);
        let axes = cuboid(size, half);
        for side in Side::BOTH {
            let hand = figure.links.iter().position(|link| link.part == Part::Hand(side))?;
            let state = states[hand];
            let at = state.turn.inverse() * (centre - state.origin);
            let local = DMat3::from_quat(state.turn.inverse() * turn);
            let own = &figure.links[hand];
            let both = own.mass + half;
            let middle = (own.centre * own.mass + at * half) / both;
            let link = &mut laden.links[hand];
            link.inertia = own.inertia
                + steiner(own.mass, own.centre - middle)
                + local * DMat3::from_diagonal(axes) * local.transpose()
                + steiner(half, at - middle);
            (link.mass, link.centre) = (both, middle);
            self.offsets[hand] = middle - own.centre;
            laden.mass += half;
            let mut up = Some(hand);
            while let Some(link) = up.filter(|link| *link > 0) {
                laden.links[link].carried += half * (centre - states[link].origin).length_squared() * 0.67;
                up = figure.links[link].parent;
            }
        }
        Some(laden)
    }

    /// What is wrong with the balls, for a person.
    pub fn broken_ball(&self) -> Option<String> {
        let bad = |sphere: &Sphere| {
            let body = &self.physics.bodies[sphere.body];
            !double(body.translation()).is_finite() || double(body.linvel()).length() > super::world::FASTEST
        };
        self.spheres.iter().position(bad).map(|number| format!("ball {} is out of bounds", number + 1))
    }

    /// A part that the engine had to take out in the last tick because its numbers were none.
    pub fn quarantined(&self, figure: &Figure) -> Option<String> {
        let taken = self.physics.quarantine().bodies();
        let link = (0..figure.links.len()).find(|link| taken.contains(&self.links[*link]));
        let name =
            link.map(|link| figure.links[link].part.name()).or_else(|| taken.first().map(|_| "box or ball".into()));
        name.map(|name| format!("the place of the {name} is not a finite number"))
    }
}

/// kg m², of a box about its axes.
fn cuboid(size: DVec3, mass: f64) -> DVec3 {
    let square = size * size;
    DVec3::new(square.y + square.z, square.x + square.z, square.x + square.y) * (mass / 12.0)
}

fn quat(turn: Rotation) -> DQuat {
    DQuat::from_xyzw(turn.x.into(), turn.y.into(), turn.z.into(), turn.w.into()).normalize()
}
