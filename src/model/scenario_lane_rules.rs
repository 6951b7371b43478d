//! What the lanes of a scenario must hold: entries within its time and in range, and none that contradicts another.

use super::scenario::{Carry, Push, Scenario};
use super::scenario_check::{Check, LONGEST, TIME_SLACK, tidy};

/// N; the paper goes to 500.
const GREATEST_FORCE: f64 = 20_000.0;

impl Check {
    /// Every lane.
    pub(super) fn lanes(&mut self, scenario: &Scenario) {
        self.intent(scenario);
        for (lane, pushes) in [("push", &scenario.push), ("pull", &scenario.pull)] {
            for (index, push) in pushes.iter().enumerate() {
                self.force(&format!("{lane}.{index}"), lane, push);
            }
        }
        self.throws(scenario);
        self.carries(scenario);
        for (index, marker) in scenario.marker.iter().enumerate() {
            self.range(format!("marker.{index}.time"), marker.time, (0.0, LONGEST), "s");
            if marker.name.trim().is_empty() || marker.name.chars().count() > 80 {
                let remedy = "say in 1 to 80 letters what is there: `name = \"hit\"`";
                self.fault(format!("marker.{index}.name"), "a marker needs a name", remedy);
            }
        }
    }

    fn intent(&mut self, scenario: &Scenario) {
        let mut starts = Vec::new();
        for (index, walk) in scenario.walk.iter().enumerate() {
            let path = format!("walk.{index}");
            self.start(&path, walk.start);
            self.optional_duration(&path, walk.duration);
            if walk.speed < 0.0 {
                self.fault(
                    format!("{path}.speed"),
                    format!("{} m/s is negative", walk.speed),
                    "to walk backwards, turn the heading by 180 and keep the facing",
                );
            } else {
                self.range(format!("{path}.speed"), walk.speed, (0.0, 10.0), "m/s");
            }
            self.finite(format!("{path}.heading"), walk.heading);
            if let Some(facing) = walk.facing {
                self.finite(format!("{path}.facing"), facing);
            }
            starts.push(("walk", index, walk.start));
        }
        for (index, turn) in scenario.turn.iter().enumerate() {
            let path = format!("turn.{index}");
            self.start(&path, turn.start);
            self.optional_duration(&path, turn.duration);
            self.finite(format!("{path}.facing"), turn.facing);
            starts.push(("turn", index, turn.start));
        }
        for (index, crouch) in scenario.crouch.iter().enumerate() {
            let path = format!("crouch.{index}");
            self.start(&path, crouch.start);
            self.optional_duration(&path, crouch.duration);
            self.range(format!("{path}.amount"), crouch.amount, (0.0, 1.0), "");
            starts.push(("crouch", index, crouch.start));
        }
        for (index, stand) in scenario.stand.iter().enumerate() {
            let path = format!("stand.{index}");
            self.start(&path, stand.start);
            self.optional_duration(&path, stand.duration);
            starts.push(("stand", index, stand.start));
        }
        for (at, (lane, index, start)) in starts.iter().enumerate() {
            let twin = starts[..at].iter().find(|(other, _, time)| other == lane && (time - start).abs() < TIME_SLACK);
            if let Some((_, first, _)) = twin {
                self.fault(
                    format!("{lane}.{index}.start"),
                    format!("two [[{lane}]] entries start at {start} s (numbers {} and {})", first + 1, index + 1),
                    "only one of them can hold: move one, or take it out",
                );
            }
        }
        self.turns_while_walking(scenario);
    }

    /// Turning on the spot and walking exclude each other.
    fn turns_while_walking(&mut self, scenario: &Scenario) {
        for (index, turn) in scenario.turn.iter().enumerate() {
            let walking = scenario
                .walk
                .iter()
                .filter(|walk| walk.start <= turn.start)
                .max_by(|a, b| a.start.total_cmp(&b.start))
                .filter(|walk| walk.speed > 0.0)
                .filter(|walk| walk.duration.is_none_or(|duration| turn.start < walk.start + duration));
            if let Some(walk) = walking {
                self.fault(
                    format!("turn.{index}.start"),
                    format!("a turn on the spot at {} s, while walking at {} m/s", turn.start, walk.speed),
                    "stop first with a [[walk]] of speed 0, or turn with the walk's own `facing`",
                );
            }
        }
    }

    fn force(&mut self, path: &str, lane: &str, push: &Push) {
        let started = self.start(path, push.start);
        let lasting = self.positive(format!("{path}.duration"), push.duration, LONGEST, "s");
        if started && lasting && push.end() > self.duration + TIME_SLACK {
            self.fault(
                format!("{path}.duration"),
                format!("the {lane} goes on until {} s, past the end", tidy(push.end())),
                format!(
                    "the scenario lasts {} s: at most {} s here, or give the scenario a longer `duration`",
                    self.duration,
                    tidy(self.duration - push.start)
                ),
            );
        }
        if push.force < 0.0 {
            self.fault(
                format!("{path}.force"),
                format!("{} N is negative", push.force),
                "turn `toward` round and give the strength",
            );
        } else {
            self.range(format!("{path}.force"), push.force, (0.0, GREATEST_FORCE), "N");
        }
        self.direction(format!("{path}.toward"), push.toward);
    }

    fn throws(&mut self, scenario: &Scenario) {
        for (index, throw) in scenario.throw.iter().enumerate() {
            let path = format!("throw.{index}");
            let started = self.start(&path, throw.start);
            let counted = self.range(format!("{path}.count"), f64::from(throw.count), (1.0, 1000.0), "");
            let spaced = self.range(format!("{path}.interval"), throw.interval, (0.0, 60.0), "s");
            let last = throw.start + f64::from(throw.count.saturating_sub(1)) * throw.interval;
            if started && counted && spaced && last > self.duration + TIME_SLACK {
                self.fault(
                    format!("{path}.count"),
                    format!("the last ball comes at {} s, past the end", tidy(last)),
                    format!("the scenario lasts {} s: fewer balls, or a shorter interval", self.duration),
                );
            }
            let [least, greatest] = throw.radius;
            self.range(format!("{path}.radius"), least, (0.01, 1.0), "m");
            self.range(format!("{path}.radius"), greatest, (0.01, 1.0), "m");
            if least > greatest {
                self.fault(
                    format!("{path}.radius"),
                    format!("from {least} to {greatest} m runs downwards"),
                    "the smaller one comes first",
                );
            }
            self.positive(format!("{path}.density"), throw.density, 20_000.0, "kg/m3");
            self.positive(format!("{path}.speed"), throw.speed, 100.0, "m/s");
            self.range(format!("{path}.spread"), throw.spread, (0.0, 5.0), "m");
            self.direction(format!("{path}.from"), throw.from);
        }
    }

    fn carries(&mut self, scenario: &Scenario) {
        for (index, carry) in scenario.carry.iter().enumerate() {
            let path = format!("carry.{index}");
            let started = self.start(&path, carry.start);
            if let Some(end) = carry.end {
                let good = end > carry.start && end <= self.duration + TIME_SLACK;
                if started && !good {
                    self.fault(
                        format!("{path}.end"),
                        format!("{end} s does not lie between the start and the end of the scenario"),
                        format!("give more than {} and at most {} s", carry.start, self.duration),
                    );
                }
            }
            if carry.mass.is_empty() {
                self.fault(format!("{path}.mass"), "no mass", "give kilograms, or [[seconds, kilograms], ...]");
            }
            self.curve(&format!("{path}.mass"), &carry.mass);
            for (point, [_, mass]) in carry.mass.iter().enumerate() {
                self.range(format!("{path}.mass.{point}.1"), *mass, (0.0, 200.0), "kg");
            }
            if carry.size.is_empty() {
                self.fault(format!("{path}.size"), "no size", "give [across, up, forward], or [[seconds, those], ...]");
            }
            let times: Vec<[f64; 2]> = carry.size.iter().map(|(time, size)| [*time, size.x]).collect();
            self.curve(&format!("{path}.size"), &times);
            for (point, (_, size)) in carry.size.iter().enumerate() {
                let place = if carry.size.len() == 1 { String::new() } else { format!(".{point}.1") };
                for (axis, length) in size.to_array().into_iter().enumerate() {
                    self.range(format!("{path}.size{place}.{axis}"), length, (0.01, 3.0), "m");
                }
            }
            let end = |carry: &Carry| carry.end.unwrap_or(self.duration);
            let other = scenario.carry[..index]
                .iter()
                .position(|other| other.start < end(carry) - TIME_SLACK && carry.start < end(other) - TIME_SLACK);
            if let Some(other) = other {
                self.fault(
                    format!("{path}.start"),
                    format!("both hands still hold the box of [[carry]] number {}", other + 1),
                    "give the earlier one an `end`",
                );
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::model::scenario::{Carry, Scenario, Turn, Walk};
    use crate::model::scenario_rules::tests::paths;
    use glam::DVec3;

    #[test]
    fn a_push_may_end_with_the_scenario_but_not_after_it() {
        let mut scenario = Scenario::demo();
        scenario.push[0].start = scenario.duration - 0.2; // 3.8 + 0.2, which is not 4.0 in binary everywhere
        assert!(paths(&scenario).is_empty());
        scenario.push[0].duration = 0.21;
        assert_eq!(paths(&scenario), ["push.0.duration"]);
    }

    #[test]
    fn two_walks_cannot_start_together() {
        let walk = Walk { start: 0.5, duration: None, speed: 1.0, heading: 0.0, facing: None };
        let scenario = Scenario { walk: vec![walk, Walk { speed: 0.0, ..walk }], ..Scenario::default() };
        assert_eq!(paths(&scenario), ["walk.1.start"]);
    }

    #[test]
    fn a_turn_on_the_spot_needs_a_stop() {
        let walk = Walk { start: 0.5, duration: None, speed: 1.0, heading: 0.0, facing: None };
        let turn = Turn { start: 2.0, duration: None, facing: 1.0 };
        let mut scenario = Scenario { walk: vec![walk], turn: vec![turn], ..Scenario::default() };
        assert_eq!(paths(&scenario), ["turn.0.start"]);
        scenario.walk.push(Walk { start: 1.5, speed: 0.0, ..walk });
        assert!(paths(&scenario).is_empty());
    }

    #[test]
    fn two_boxes_need_four_hands() {
        let carry = Carry { start: 0.0, end: None, mass: vec![[0.0, 2.0]], size: vec![(0.0, DVec3::splat(0.3))] };
        let mut scenario =
            Scenario { carry: vec![carry.clone(), Carry { start: 2.0, ..carry }], ..Scenario::default() };
        assert_eq!(paths(&scenario), ["carry.1.start"]);
        scenario.carry[0].end = Some(2.0);
        assert!(paths(&scenario).is_empty());
    }
}
