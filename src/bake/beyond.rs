//! A clip that ends in the midst of a walk is baked a step farther and cut: its end knows of the lift that comes next, for which a heel
//! rises before.

use super::base::over::whole;
use super::perform::Performance;
use crate::model::Body;
use crate::model::scenario::Scenario;
use crate::sim::Script;
use glam::DVec2;

/// s of the reference body: till the foot that stands at the end has lifted.
const BEYOND: f64 = 0.9;

/// The scenario a step longer, where it ends in the midst of a walk on empty hands.
pub(super) fn farther(scenario: &Scenario, body: &Body) -> Option<Scenario> {
    let last = scenario.duration - 1e-6;
    let goes = Script::of(scenario, Vec::new()).intent(last).walk.is_some_and(|walk| walk != DVec2::ZERO);
    let later = BEYOND * (body.leg_length / 0.83).sqrt();
    let alone = scenario.carry.is_empty() && scenario.throw.is_empty();
    (goes && alone).then(|| Scenario { duration: scenario.duration + later, ..scenario.clone() })
}

/// What of a longer performance, in which balance is kept, is that scenario's.
pub(super) fn cut(mut performance: Performance, scenario: &Scenario) -> Performance {
    let Performance { timeline, trace, contacts, pushes, .. } = &mut performance;
    let end = whole(scenario, trace.dt);
    let last = (end / trace.dt).round() as usize;
    timeline.cut(last);
    trace.ticks.truncate(last + 1);
    let late = end + 1e-9;
    let flies = trace.steps.iter().copied().chain(trace.aloft).find(|step| step.lift < late && step.land > late);
    trace.steps.retain(|step| step.land <= late);
    (trace.aloft, trace.rest) = (flies, 0.0);
    *contacts = timeline.feet.contacts(timeline.stands());
    pushes.iter_mut().for_each(|push| push.end = push.end.min(scenario.duration));
    performance
}
