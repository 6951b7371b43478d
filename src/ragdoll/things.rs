//! Things in the world beside the body: balls that fly, hit and roll, and what they gave to whom; a box in both hands.
//!
//! Scenario space, SI. Balls are rapier's rigid spheres among themselves and on the ground; where they meet the body, the body's own
//! contacts act on both by equal and opposite impulses. They are there from a moment before they arrive, and for good.

use super::bulk::steiner;
use super::figure::{Figure, Part};
use super::ground::{self, double, rotation, vector};
use super::touches::Round;
use super::world::{FASTEST, LinkState, World};
use crate::dynamics::{Loose, Weld};
use crate::model::{Side, Terrain};
use glam::{DMat3, DQuat, DVec3};
use rapier3d::prelude::*;

/// What stands still, and balls.
const GROUND: InteractionGroups = InteractionGroups::new(Group::GROUP_2, Group::GROUP_3, InteractionTestMode::And);
const BALL: InteractionGroups =
    InteractionGroups::new(Group::GROUP_3, Group::GROUP_2.union(Group::GROUP_3), InteractionTestMode::And);
/// Share of the closing speed that a ball bounces with.
const RESTITUTION: f64 = 0.35;
/// Of a ball's skin.
const FRICTION: f64 = 0.6;
/// m, beyond what a ball makes in a tick.
const FORESEEN: f64 = 0.01;
/// 1/s, what rolling and the air take.
const DRAG: [f32; 2] = [0.05, 0.8];
/// kg, the least that a box weighs.
const LIGHTEST: f64 = 0.05;

/// A ball.
#[derive(Clone, Copy, Debug)]
struct Ball {
    radius: f64,
    body: Loose,
}

/// Balls, and rapier's world with them and the ground. A copy makes a world of its own when it needs one.
#[derive(Default)]
pub(super) struct Balls {
    balls: Vec<Ball>,
    physics: Option<Physics>,
}

/// Rapier's world.
struct Physics {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    ground: Vec<ground::Piece>,
}

impl Clone for Balls {
    fn clone(&self) -> Balls {
        Balls { balls: self.balls.clone(), physics: None }
    }
}

/// A box held by both hands.
#[derive(Clone, Debug)]
pub(super) struct Held {
    size: DVec3,
    hands: [usize; 2],
    welds: [Weld; 2],
    wrists: Option<[DVec3; 2]>, // m, from its centre along its edges, as it was taken up
    body: Loose,
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

impl Balls {
    /// A tick of their own, after the body's: rapier's, with the speeds that the body left them.
    fn fly(&mut self, terrain: &Terrain, time: f64, dt: f64) {
        if self.balls.is_empty() {
            return;
        }
        let Balls { balls, physics } = self;
        let physics = physics.get_or_insert_with(|| Physics::new(terrain));
        for ball in &balls[physics.bodies.len()..] {
            physics.add(ball);
        }
        physics.world.integration_parameters.dt = dt as f32;
        for (ball, handle) in balls.iter().zip(&physics.bodies) {
            let body = &mut physics.world.bodies[*handle];
            body.set_linvel(vector(ball.body.velocity), true);
            body.set_angvel(vector(ball.body.spin), true);
        }
        ground::turn(&mut physics.world, &physics.ground, terrain, time);
        physics.world.step();
        for (ball, handle) in balls.iter_mut().zip(&physics.bodies) {
            let body = &physics.world.bodies[*handle];
            ball.body.place = double(body.translation());
            ball.body.turn = quat(*body.rotation());
            ball.body.velocity = double(body.linvel());
            ball.body.spin = double(body.angvel());
        }
    }
}

impl Physics {
    fn new(terrain: &Terrain) -> Physics {
        let mut world = PhysicsWorld::new();
        world.gravity = vector(DVec3::NEG_Y * crate::maths::pendulum::GRAVITY);
        world.integration_parameters.contact_recycling = false;
        let ground = ground::build(&mut world, terrain, GROUND);
        Physics { world, bodies: Vec::new(), ground }
    }

    fn add(&mut self, ball: &Ball) {
        let Ball { radius, body } = ball;
        let built = RigidBodyBuilder::dynamic()
            .pose(Pose::from_parts(vector(body.place), rotation(body.turn)))
            .linvel(vector(body.velocity))
            .angvel(vector(body.spin))
            .linear_damping(DRAG[0])
            .angular_damping(DRAG[1])
            .can_sleep(false);
        let collider = ColliderBuilder::ball(*radius as f32)
            .mass(body.mass as f32)
            .friction(FRICTION as f32)
            .restitution(RESTITUTION as f32)
            .restitution_combine_rule(CoefficientCombineRule::Max)
            .collision_groups(BALL);
        let (handle, _) = self.world.insert(built, collider);
        self.bodies.push(handle);
    }
}

impl World {
    /// Lists what is loose for the coming tick: the balls, and the box last.
    pub(super) fn gather(&mut self) {
        let World { balls, around, surroundings, held, dt, .. } = self;
        around.loose.clear();
        around.loose.extend(balls.balls.iter().map(|ball| ball.body));
        surroundings.balls.clear();
        surroundings.balls.extend(balls.balls.iter().map(|ball| Round {
            radius: ball.radius,
            reach: ball.body.velocity.length() * *dt + FORESEEN,
            friction: FRICTION,
            bounce: RESTITUTION,
        }));
        around.welds.clear();
        surroundings.carried = None;
        if let Some(held) = held {
            let number = around.loose.len();
            around.loose.push(held.body);
            around.welds.extend(held.welds.iter().map(|weld| Weld { body: number, ..*weld }));
            surroundings.carried = Some((number, held.size, held.hands[0]));
        }
    }

    /// Takes back what the body's tick did to what is loose, and lets the balls go on.
    pub(super) fn scatter(&mut self, terrain: &Terrain, time: f64) {
        let World { balls, around, held, dt, .. } = self;
        for (ball, body) in balls.balls.iter_mut().zip(&around.loose) {
            (ball.body.velocity, ball.body.spin) = (body.velocity, body.spin);
        }
        if let (Some(held), Some(body)) = (held, around.loose.last()) {
            held.body = *body;
        }
        balls.fly(terrain, time, *dt);
    }

    /// Lets a ball loose; its number.
    pub fn throw(&mut self, radius: f64, mass: f64, place: DVec3, velocity: DVec3) -> usize {
        let body = Loose {
            mass,
            inertia: DVec3::splat(0.4 * mass * radius * radius),
            place,
            turn: DQuat::IDENTITY,
            velocity,
            spin: DVec3::ZERO,
            falls: false,
        };
        self.balls.balls.push(Ball { radius, body });
        self.balls.balls.len() - 1
    }

    /// m, turn and m/s of a ball.
    pub fn ball(&self, number: usize) -> (DVec3, DQuat, DVec3) {
        let body = &self.balls.balls[number].body;
        (body.place, body.turn, body.velocity)
    }

    /// What a ball gave to links in the last tick.
    pub fn blows(&self, number: usize) -> Vec<Blow> {
        let mut blows: Vec<Blow> = Vec::new();
        for met in self.around.met.iter().filter(|met| met.touch.other == Some(number)) {
            let (link, point) = (met.touch.link, met.touch.at);
            match blows.iter_mut().find(|blow| blow.link == link) {
                Some(blow) => blow.impulse += met.impulse,
                None => blows.push(Blow { link, impulse: met.impulse, point }),
            }
        }
        blows.sort_by_key(|blow| blow.link);
        blows
    }

    /// Puts a box (m: across, up, forward) between the hands where they are, joined to both.
    pub fn take_up(&mut self, figure: &Figure, size: DVec3, mass: f64, centre: DVec3, turn: DQuat) {
        self.let_go();
        let hands = Side::BOTH.map(|side| figure.links.iter().position(|link| link.part == Part::Hand(side)));
        let [Some(left), Some(right)] = hands else { return };
        let weld = |link: usize| {
            let (origin, hand) = self.body.place(link);
            let at = [hand.inverse() * (centre - origin), DVec3::ZERO];
            Weld { link, body: 0, at, turn: hand.inverse() * turn }
        };
        let (velocity, spin) = self.body.motion_at(left, centre);
        let body = Loose { mass, inertia: DVec3::ONE, place: centre, turn, velocity, spin, falls: true };
        self.held = Some(Held { size, hands: [left, right], welds: [weld(left), weld(right)], wrists: None, body });
        self.weigh(mass);
    }

    /// The box has that size now (m: across, up, forward), and the wrists are so far from its centre, along its edges: what fixes the
    /// hands to it goes along with its sides.
    pub fn reshape(&mut self, size: DVec3, wrists: [DVec3; 2]) {
        if let Some(held) = &mut self.held {
            held.size = size;
            let first = *held.wrists.get_or_insert(wrists);
            for (weld, (now, then)) in held.welds.iter_mut().zip(wrists.iter().zip(first)) {
                weld.at[1] = *now - then;
            }
        }
    }

    /// The box weighs that now (kg).
    pub fn weigh(&mut self, mass: f64) {
        if let Some(held) = &mut self.held {
            held.body.mass = mass.max(LIGHTEST);
            held.body.inertia = cuboid(held.size, held.body.mass);
        }
    }

    /// Where the box is: centre, turn, size; `None` without one.
    pub fn held_box(&self) -> Option<(DVec3, DQuat, DVec3)> {
        self.held.as_ref().map(|held| (held.body.place, held.body.turn, held.size))
    }

    /// The box is gone.
    pub fn let_go(&mut self) {
        self.held = None;
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
        let bad = |ball: &Ball| {
            !ball.body.place.is_finite() || ball.body.velocity.length() > FASTEST || ball.body.velocity.is_nan()
        };
        self.balls.balls.iter().position(bad).map(|number| format!("ball {} is out of bounds", number + 1))
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
