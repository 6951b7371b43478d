//! Balls on their way to the articulated body: when they are let loose, how they flew, what they hit. Scenario space, SI.

use crate::maths::pendulum::GRAVITY;
use crate::model::Body;
use crate::ragdoll::{Figure, LinkState, World};
use glam::{DQuat, DVec3};

/// s before it arrives, from when on a ball is in the world; before that it flies unhindered.
const LEAD: f64 = 0.15;
/// s: what a ball gives within so much of the first touch is one hit.
const ONE_HIT: f64 = 0.06;
/// Share of a ball's momentum that a later touch must give to count as a hit too.
const COUNTS: f64 = 0.25;

/// A ball that is to come.
pub struct Incoming<'a> {
    /// s, when it arrives.
    pub arrives: f64,
    /// m.
    pub radius: f64,
    /// kg.
    pub mass: f64,
    /// The joint that it is aimed at, and how far from it in the natural stand, m.
    pub at: (usize, DVec3),
    /// From the aimed place and the way that the character faces (rad): the place (m) and the velocity (m/s) on arrival.
    pub way: &'a dyn Fn(DVec3, f64) -> (DVec3, DVec3),
}

/// A ball that was thrown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flown {
    /// m.
    pub radius: f64,
    /// kg.
    pub mass: f64,
    /// s, m, turn: from when it is in the world, one a tick.
    pub way: Vec<(f64, DVec3, DQuat)>,
    /// m/s, when it is let loose.
    pub velocity: DVec3,
    /// What it hit of the body.
    pub hits: Vec<Struck>,
}

/// A hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Struck {
    /// s, the first touch and the last.
    pub span: [f64; 2],
    /// N s, on the body.
    pub impulse: DVec3,
    /// The joint whose bone took most of it, and where, from it, in the frame of its rest, m.
    pub at: (usize, DVec3),
    /// m, in the scenario.
    pub point: DVec3,
    most: f64,
}

/// The balls of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Balls {
    flown: Vec<Flown>,
    loosed: Vec<bool>,
    felt: Vec<(DVec3, DVec3)>, // N s and where, in the last tick
}

impl Balls {
    /// Lets loose what is due at `time`. `now`: s, rad, m/s of the body.
    pub(super) fn launch(
        &mut self,
        figure: &Figure,
        body: &Body,
        incoming: &[Incoming],
        states: &[LinkState],
        world: &mut World,
        (time, facing, velocity): (f64, f64, DVec3),
    ) {
        self.loosed.resize(incoming.len(), false);
        for (ball, loosed) in incoming.iter().zip(&mut self.loosed) {
            if *loosed || ball.arrives - LEAD > time + 1e-9 {
                continue;
            }
            *loosed = true;
            let left = ball.arrives - time;
            let (joint, offset) = ball.at;
            let state = states[figure.link_of[joint]];
            let now = state.origin + state.turn * (figure.joint_in_link(body, joint) + offset);
            let (place, speed) = (ball.way)(now + velocity * left, facing);
            let fall = DVec3::NEG_Y * GRAVITY;
            let from = place - speed * left + fall * (0.5 * left * left);
            let speed = speed - fall * left;
            world.throw(ball.radius, ball.mass, from, speed);
            self.flown.push(Flown {
                radius: ball.radius,
                mass: ball.mass,
                way: vec![(time, from, DQuat::IDENTITY)],
                velocity: speed,
                hits: Vec::new(),
            });
        }
    }

    /// Notes where they are at `time` and what they hit in the tick before.
    pub(super) fn watch(&mut self, figure: &Figure, body: &Body, states: &[LinkState], world: &World, time: f64) {
        self.felt.clear();
        for (number, ball) in self.flown.iter_mut().enumerate() {
            let (place, turn, _) = world.ball(number);
            ball.way.push((time, place, turn));
            for blow in world.blows(number) {
                self.felt.push((blow.impulse, blow.point));
                let size = blow.impulse.length();
                let state = states[blow.link];
                let inside = state.turn.inverse() * (blow.point - state.origin);
                let joint = figure.joint_at(body, blow.link, inside);
                let offset = inside - figure.joint_in_link(body, joint);
                let at = (joint, figure.stand.turns[joint].inverse() * offset);
                match ball.hits.last_mut().filter(|hit| time - hit.span[0] < ONE_HIT) {
                    Some(hit) => {
                        hit.span[1] = time;
                        hit.impulse += blow.impulse;
                        if size > hit.most {
                            (hit.at, hit.point, hit.most) = (at, blow.point, size);
                        }
                    }
                    None => ball.hits.push(Struck {
                        span: [time - world.dt, time],
                        impulse: blow.impulse,
                        at,
                        point: blow.point,
                        most: size,
                    }),
                }
            }
        }
    }

    /// N and N m about the centre of mass, what the body felt of them in the last tick.
    pub(super) fn felt(&self, com: DVec3, dt: f64) -> (DVec3, DVec3) {
        let force = self.felt.iter().map(|(impulse, _)| *impulse / dt).sum();
        let moment = self.felt.iter().map(|(impulse, point)| (*point - com).cross(*impulse / dt)).sum();
        (force, moment)
    }

    /// The balls in the order of their launch; touches that give next to nothing are left out.
    pub(super) fn finish(self) -> Vec<Flown> {
        let mut flown = self.flown;
        for ball in &mut flown {
            let least = COUNTS * ball.mass * ball.velocity.length();
            ball.hits.retain(|hit| hit.impulse.length() > least);
        }
        flown
    }
}
