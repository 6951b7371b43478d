//! What of a scenario the articulated body cannot play, by name: all else is played, and the report says how it went.

use super::base::Base;
use crate::model::scenario::{GroundKind, Scenario, Stepper};
use crate::model::{Body, BodyPose};
use crate::ragdoll::{Figure, Locks};

/// What of a scenario the articulated body cannot play, over that clip if any, for a person; empty where it plays it all.
pub(super) fn unplayed(scenario: &Scenario, base: Option<&Base>) -> Vec<&'static str> {
    let over = base.is_some() || scenario.base.is_some();
    let crouches = scenario.character.crouch > 0.0 || scenario.crouch.iter().any(|crouch| crouch.amount > 0.0);
    let lowers = crouches || !scenario.carry.is_empty();
    let Stepper { spring, damping, .. } = scenario.stepper;
    [
        (over && lowers, "[base] beside [[crouch]] or [[carry]]"),
        (over && scenario.ground.kind != GroundKind::Flat, "[base] on ground that is not flat"),
        // Its legs hold it by torques, whatever a spring would.
        (spring != 1.0 || damping != 1.0, "spring and damping of [stepper]"),
    ]
    .into_iter()
    .filter_map(|(is, name)| is.then_some(name))
    .collect()
}

/// What of it another body could play, but not this one: on stairs the balls of the feet bear, and feet that do not bend have none (of 40
/// drawn flights all fall).
pub(super) fn unfit(scenario: &Scenario, body: &Body) -> Option<&'static str> {
    let stairs = matches!(scenario.ground.kind, GroundKind::Stairs { rise, count, .. } if climbed(rise, count));
    let walks = scenario.walk.iter().any(|walk| walk.speed > 0.0);
    let bends = || Figure::new(body, &BodyPose::rest(body), Locks::default()).balls_ahead().is_some();
    (stairs && walks && !bends()).then_some("[[walk]] on stairs on feet that do not bend at their toes")
}

/// Are they more than feet that do not bend can go: down, unless it is one low step, or up by more than 0.1 m a step?
fn climbed(rise: f64, count: u32) -> bool {
    const KERB: f64 = 0.1 + 1e-9;
    rise.abs() > KERB || (rise < 0.0 && count > 1)
}
