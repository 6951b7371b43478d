//! The articulated body at the wheel: which scenarios it can play, and how much help it gets.
//!
//! Its run leaves the stepper's kind of trace; the passes of the bake then lock the feet and keep the balance as they do for
//! the stepper's. From where balance is lost on the clip shows the links as they fall. Scenario space, SI.

use super::BakeError;
use super::carried::{self, Carried};
use super::throws::{Ball, Hit, Toss};
use crate::maths::quat::wrap_angle;
use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::{GroundKind, Scenario, Walk};
use crate::model::{Body, Load, Physique, Terrain};
use crate::ragdoll::control::Assist;
use crate::ragdoll::walk::Order;
use crate::sim::{Articulated, Incoming, Script, SimulateOptions, Things, simulate_with};
use crate::whole_body::{Anatomy, Solver, stand};
use glam::DVec3;

/// Who moves the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drive {
    /// The pendulum; the pose follows it.
    #[default]
    Stepper,
    /// Joint torques and contacts.
    Ragdoll(Helped),
    /// The better of the two ([`super::auto`]), the ragdoll helped like that.
    Auto(Helped),
}

/// How much help the pelvis may get.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Helped {
    /// At most that.
    Within(Assist),
    /// As little as recovers, at most 300 N m and 300 N.
    Auto,
}

/// A run and the bound that it had.
#[derive(Clone, Debug)]
pub struct Driven {
    /// The run.
    pub run: Articulated,
    /// The bound of its help.
    pub bound: Assist,
}

/// Bounds that `Auto` tries, N m and N, the least first.
const TRIES: [[f64; 2]; 8] =
    [[0.0, 0.0], [25.0, 0.0], [50.0, 0.0], [100.0, 0.0], [150.0, 0.0], [200.0, 50.0], [300.0, 150.0], [300.0, 300.0]];

/// m/s, faster its pelvis turns too far with the legs.
const FASTEST: f64 = 1.3;

/// What of a scenario the articulated body cannot play yet, for a person; empty where it plays it all.
pub fn unplayed(scenario: &Scenario) -> Vec<&'static str> {
    let mut parts = Vec::new();
    let mut part = |is: bool, name: &'static str| {
        if is {
            parts.push(name);
        }
    };
    let flat = matches!(scenario.ground.kind, GroundKind::Flat);
    let straight = |walk: &Walk| walk.facing.is_none_or(|facing| wrap_angle(facing - walk.heading).abs() < 0.01);
    let walks = !scenario.walk.is_empty();
    part(walks && !flat, "[[walk]] on ground that is not flat");
    part(!scenario.walk.iter().all(straight), "[[walk]] sideways or backwards");
    part(scenario.walk.iter().any(|walk| walk.speed > FASTEST), "[[walk]] at more than 1.3 m/s");
    part(!scenario.turn.is_empty(), "[[turn]]");
    part(!scenario.crouch.is_empty() || scenario.character.crouch > 0.0, "crouch");
    part(!scenario.stand.is_empty(), "[[stand]]");
    parts
}

#[expect(clippy::too_many_arguments, reason = "all that a run depends on")]
/// Runs the articulated body, with as much help as is asked or allowed.
pub(super) fn run(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    scenario: &Scenario,
    options: &SimulateOptions,
    pushes: &[(KnownPush, bool)],
    tosses: &[Toss],
    (carried, loads): (&[Carried], &[Load]),
    helped: Helped,
) -> Result<Driven, BakeError> {
    let unplayed = unplayed(scenario);
    if !unplayed.is_empty() {
        return Err(BakeError::Unplayed { parts: unplayed.join(", ") });
    }
    let terrain = Terrain::new(&scenario.ground);
    let plants = stand::natural_plants(physique.stance_width, physique.com_forward);
    let target = stand::stand_target(body, &plants, DVec3::Y * physique.com_height, 0.0);
    let standing = Solver::new(body, anatomy).solve(&target).pose;
    let positions = standing.positions(body);
    let ways: Vec<_> = tosses.iter().map(|toss| |aim: DVec3, facing: f64| toss.way(aim, facing)).collect();
    let incoming: Vec<Incoming> = tosses
        .iter()
        .zip(&ways)
        .map(|(toss, way)| {
            let (joint, aim) = toss.aimed(body, &standing);
            let at = (joint, aim - positions[joint]);
            Incoming { arrives: toss.arrives, radius: toss.radius(), mass: toss.mass(), at, way }
        })
        .collect();
    let hold = |time: f64| carried::hold(carried, loads, time);
    let script = Script::of(scenario, Vec::new());
    let walk = |time: f64| {
        let intent = script.intent(time);
        let velocity = intent.walk.unwrap_or_default();
        (!scenario.walk.is_empty()).then_some(Order { velocity, facing: intent.facing })
    };
    let things = Things { incoming: &incoming, loads, hold: &hold, walk: &walk };
    let once = |bound: Assist| -> Result<Driven, BakeError> {
        let run = simulate_with(body, anatomy, physique, &terrain, options, pushes, bound, &things)
            .map_err(|broken| BakeError::BrokeDown { time: broken.time, what: broken.what })?;
        Ok(Driven { run, bound })
    };
    let scale = physique.mass / 89.5;
    match helped {
        Helped::Within(bound) => once(bound),
        Helped::Auto => {
            let mut last = None;
            for [torque, force] in TRIES {
                let driven = once(Assist { torque: torque * scale, force: force * scale })?;
                if driven.run.trace.lost.is_none() {
                    return Ok(driven);
                }
                last = Some(driven);
            }
            last.ok_or(BakeError::BrokeDown { time: 0.0, what: "the articulated body did not move".into() })
        }
    }
}

impl Driven {
    /// Its balls as the report takes them, one for each hit and one for each that missed.
    pub fn balls(&self) -> Vec<Ball> {
        let mut balls = Vec::new();
        for flown in &self.run.balls {
            let Some((time, place, _)) = flown.way.first().copied() else { continue };
            let ball =
                Ball { radius: flown.radius, mass: flown.mass, time, place, velocity: flown.velocity, hit: None };
            if flown.hits.is_empty() {
                balls.push(ball);
            }
            balls.extend(flown.hits.iter().map(|hit| {
                let [start, end] = hit.span;
                let (joint, at) = hit.at;
                let push =
                    KnownPush { start, end, force: hit.impulse / (end - start), at: PushPoint::Segment(joint, at) };
                Ball { hit: Some(Hit { push, impulse: hit.impulse, joint, point: hit.point }), ..ball }
            }));
        }
        balls
    }
}
