//! What of a scenario keeps a clip from beginning or ending in its base clip's pose, for a person.

use crate::model::report::BaseReport;
use crate::model::scenario::{Feet, GroundKind, Scenario};
use crate::sim::Script;
use glam::DVec2;

/// Degrees and mm: a frame that is farther from the base clip's pose is not in it.
const HOME: (f64, f64) = (1.0, 5.0);
/// s before a clip's end: what ends later leaves no time to come back.
const BACK: f64 = 0.5;

/// Whether a clip ends in its base clip's pose.
pub(in crate::bake) fn ends_in(base: &BaseReport) -> bool {
    base.last_deg < HOME.0 && base.last_mm < HOME.1
}

/// A sentence on a clip that does not begin or end in its base clip's pose, of a scenario that does not let it.
pub(in crate::bake) fn apart(scenario: &Scenario, base: &BaseReport) -> Option<String> {
    let off = |degrees: f64, mm: f64| format!("{degrees:.0} degrees and {mm:.0} mm from its pose");
    let begins = base.first_deg < HOME.0 && base.first_mm < HOME.1;
    if scenario.ground.kind != GroundKind::Flat && !(begins && ends_in(base)) {
        let first = off(base.first_deg, base.first_mm);
        let last = off(base.last_deg, base.last_mm);
        return Some(format!(
            "the base clip stands on level ground: on this ground the first frame is {first}, the last one {last}"
        ));
    }
    let (lane, remedy) = goes_on(scenario).filter(|_| !ends_in(base))?;
    let last = off(base.last_deg, base.last_mm);
    Some(format!("it does not end in the base clip, {last}: {lane} goes on to its end; give it {remedy} to come back"))
}

/// The lane that is not over when the clip ends, and what ends it.
fn goes_on(scenario: &Scenario) -> Option<(&'static str, &'static str)> {
    let end = scenario.duration - BACK;
    let meant = Script::of(scenario, Vec::new()).intent(end);
    let carries = |until: Option<f64>| until.is_none_or(|until| until > end);
    let lanes = [
        (meant.walk.is_some_and(|walk| walk != DVec2::ZERO), "[[walk]]", "a `duration`"),
        (meant.stand != Feet::Both, "[[stand]]", "a `duration`"),
        (meant.crouch > 0.0, "[[crouch]]", "a `duration`"),
        (scenario.carry.iter().any(|carry| carry.start < end && carries(carry.end)), "[[carry]]", "an `end`"),
    ];
    lanes.into_iter().find_map(|(is, lane, remedy)| is.then_some((lane, remedy)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::{Ground, Walk};

    fn walks(duration: Option<f64>) -> Scenario {
        let walk = Walk { start: 1.0, duration, speed: 0.6, heading: 0.0, facing: None };
        Scenario { duration: 8.0, walk: vec![walk], ..Scenario::default() }
    }

    fn off(first: f64, last: f64) -> BaseReport {
        BaseReport { clip: "Idle".into(), first_deg: first, first_mm: 0.0, last_deg: last, last_mm: 0.0 }
    }

    #[test]
    fn a_lane_that_goes_on_to_the_end_is_named_with_its_remedy() {
        let told = apart(&walks(None), &off(0.0, 26.0)).expect("told");
        assert!(told.contains("26 degrees") && told.contains("[[walk]]") && told.contains("`duration`"), "{told}");
        assert_eq!(apart(&walks(Some(2.0)), &off(0.0, 26.0)), None, "another reason: told elsewhere");
        assert_eq!(apart(&walks(None), &off(0.0, 0.2)), None, "it is back");
    }

    #[test]
    fn ground_that_is_not_level_is_named_with_both_ends() {
        let ground = Ground { kind: GroundKind::Slope { angle: 0.17 }, ..Ground::default() };
        let told = apart(&Scenario { ground, ..walks(Some(2.0)) }, &off(15.7, 14.3)).expect("told");
        assert!(told.contains("16 degrees") && told.contains("14 degrees"), "{told}");
    }
}
