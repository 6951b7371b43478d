//! A clip that ends in the midst of a walk is baked a step farther and cut: its end knows of the lift that comes next, for which a heel
//! rises before.

use super::base::over::whole;
use super::perform::Performance;
use crate::model::Body;
use crate::model::scenario::Scenario;

/// s of the reference body: till the foot that stands at the end has lifted.
const BEYOND: f64 = 0.9;

/// The scenario a step longer, where it ends in the midst of a walk on empty hands.
pub(super) fn farther(scenario: &Scenario, body: &Body) -> Option<Scenario> {
    let begun = |start: f64| start < scenario.duration;
    let walk = scenario.walk.iter().filter(|walk| begun(walk.start)).max_by(|a, b| a.start.total_cmp(&b.start))?;
    let goes = walk.speed > 0.0 && walk.duration.is_none_or(|duration| walk.start + duration > scenario.duration);
    let later = BEYOND * (body.leg_length / 0.83).sqrt();
    let alone = scenario.carry.is_empty() && scenario.throw.is_empty();
    (goes && alone).then(|| Scenario { duration: scenario.duration + later, ..scenario.clone() })
}

/// What of a longer performance is that scenario's.
pub(super) fn cut(mut performance: Performance, scenario: &Scenario) -> Performance {
    let Performance { timeline, trace, lost, contacts, pushes, .. } = &mut performance;
    let end = whole(scenario, trace.dt);
    let last = (end / trace.dt).round() as usize;
    if timeline.com.len() <= last + 1 {
        return performance; // balance was lost before
    }
    timeline.cut(last);
    trace.ticks.truncate(last + 1);
    let late = end + 1e-9;
    let flies = trace.steps.iter().copied().chain(trace.aloft).find(|step| step.lift < late && step.land > late);
    trace.steps.retain(|step| step.land <= late);
    (trace.aloft, trace.rest) = (flies, 0.0);
    trace.lost = trace.lost.filter(|time| *time <= late);
    *lost = lost.filter(|time| *time <= late);
    *contacts = timeline.feet.contacts(timeline.stands());
    pushes.iter_mut().for_each(|push| push.end = push.end.min(scenario.duration));
    performance
}
