//! What a scenario does to a body, and when the first of it happens. Scenario space, SI.

use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::{Direction, GroundKind, Scenario};
use crate::model::{Body, Role};

/// The scenario's pushes and pulls as forces on joints of the body, in order of start.
/// With each, whether its direction is the character's own: then as for one that faces +Z.
pub(super) fn known(body: &Body, scenario: &Scenario) -> Vec<(KnownPush, bool)> {
    let mut pushes: Vec<(KnownPush, bool)> = scenario
        .push
        .iter()
        .chain(&scenario.pull)
        .map(|push| {
            let known = KnownPush {
                start: push.start,
                end: push.end().min(scenario.duration),
                force: push.toward.unit(0.0) * push.force,
                at: PushPoint::Joint(nearest_joint(body, push.at)),
            };
            (known, !matches!(push.toward, Direction::Vector(_)))
        })
        .collect();
    pushes.sort_by(|a, b| a.0.start.total_cmp(&b.0.start));
    pushes
}

/// The joint of that role, or of the nearest role up the body that it has.
pub fn nearest_joint(body: &Body, role: Role) -> usize {
    let mut role = Some(role);
    while let Some(wanted) = role {
        if let Some(joint) = body.joint(wanted) {
            return joint;
        }
        role = wanted.parent();
    }
    0
}

/// s, when the first thing happens: a push, the ground's turn, hands that go for a box, or what the character means to do.
/// At rest before.
pub(super) fn still_until(scenario: &Scenario, pushes: &[KnownPush], taken_up: f64) -> f64 {
    let meant = (scenario.walk.iter().map(|walk| walk.start))
        .chain(scenario.turn.iter().map(|turn| turn.start))
        .chain(scenario.crouch.iter().map(|crouch| crouch.start))
        .chain(scenario.stand.iter().map(|stand| stand.start));
    let turning = match &scenario.ground.kind {
        // The first point of either says from when on it turns: before, it holds.
        GroundKind::Platform { pitch, roll } => [pitch, roll]
            .into_iter()
            .flat_map(|points| points.windows(2).find(|pair| pair[0][1] != pair[1][1]))
            .map(|pair| pair[0][0])
            .fold(f64::INFINITY, f64::min),
        _ => f64::INFINITY,
    };
    let first = meant.chain(pushes.iter().map(|push| push.start)).fold(turning.min(taken_up), f64::min);
    if first.is_finite() { first.max(0.0) } else { 0.0 }
}
