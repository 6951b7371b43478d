//! What a scenario must hold to make sense, whoever wrote it: ranges, times, lanes that contradict each other.
//!
//! Every fault is found, not only the first; each names its place as a path (`push.0.force`), which the text form turns
//! into a line. Messages speak in the units of the text: degrees, seconds, newtons.

use super::scenario::{Direction, GroundKind, Push, Scenario};
use super::scenario_errors::Fault;

/// s; longer clips are refused: at 600 s a file is past what an engine loads gladly.
const LONGEST: f64 = 600.0;
/// Least and greatest body mass, kg.
const MASSES: (f64, f64) = (1.0, 2000.0);
/// Least and greatest leg scale.
const LEG_SCALES: (f64, f64) = (0.25, 4.0);
/// Least and greatest friction: under 0.05 nobody can push off the ground.
const FRICTIONS: (f64, f64) = (0.05, 10.0);
/// N; the paper goes to 500.
const GREATEST_FORCE: f64 = 20_000.0;
/// Seeds stay whole in readers that know numbers as doubles only: 2^53.
const GREATEST_SEED: u64 = 1 << 53;
/// s, slack for sums of decimal fractions.
const TIME_SLACK: f64 = 1e-9;

impl Scenario {
    /// Everything that is out of range or contradicts itself; empty for a good scenario.
    pub fn validate(&self) -> Vec<Fault> {
        let mut check = Check { duration: self.duration, faults: Vec::new() };
        check.document(self);
        check.character(self);
        check.ground(self);
        check.intent(self);
        for (lane, pushes) in [("push", &self.push), ("pull", &self.pull)] {
            for (index, push) in pushes.iter().enumerate() {
                check.force(&format!("{lane}.{index}"), lane, push);
            }
        }
        check.throws(self);
        check.carries(self);
        for (index, marker) in self.marker.iter().enumerate() {
            check.range(format!("marker.{index}.time"), marker.time, (0.0, LONGEST), "s");
            if marker.name.trim().is_empty() || marker.name.chars().count() > 80 {
                let remedy = "say in 1 to 80 letters what is there: `name = \"hit\"`";
                check.fault(format!("marker.{index}.name"), "a marker needs a name", remedy);
            }
        }
        check.faults
    }
}

/// Collects faults.
struct Check {
    duration: f64,
    faults: Vec<Fault>,
}

impl Check {
    fn fault(&mut self, path: impl Into<String>, message: impl Into<String>, remedy: impl Into<String>) {
        self.faults.push(Fault { path: path.into(), message: message.into(), remedy: remedy.into() });
    }

    /// `low..=high`; what it is and its unit for the message.
    fn range(&mut self, path: impl Into<String>, value: f64, (low, high): (f64, f64), unit: &str) -> bool {
        let good = value >= low && value <= high; // false for NaN
        if !good {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            self.fault(path, format!("{value}{unit} is out of range"), format!("give {low} to {high}{unit}"));
        }
        good
    }

    /// Over zero, at most `high`.
    fn positive(&mut self, path: impl Into<String>, value: f64, high: f64, unit: &str) -> bool {
        let good = value > 0.0 && value <= high;
        if !good {
            self.fault(
                path,
                format!("{value} {unit} is out of range"),
                format!("give more than 0 and at most {high} {unit}"),
            );
        }
        good
    }

    fn finite(&mut self, path: impl Into<String>, value: f64) {
        if !value.is_finite() {
            self.fault(path, "not a finite number", "give a plain number");
        }
    }

    /// The start of an entry: in the scenario.
    fn start(&mut self, path: &str, start: f64) -> bool {
        let (good, remedy) = if start.is_nan() || start < 0.0 {
            (false, "times count from 0, the start of the clip".to_owned())
        } else if start >= self.duration {
            (false, format!("the scenario lasts {} s: start earlier, or give it a longer `duration`", self.duration))
        } else {
            (true, String::new())
        };
        if !good {
            self.fault(format!("{path}.start"), format!("{start} s is outside of the scenario"), remedy);
        }
        good
    }

    fn optional_duration(&mut self, path: &str, duration: Option<f64>) {
        if let Some(duration) = duration {
            self.positive(format!("{path}.duration"), duration, LONGEST, "s");
        }
    }

    fn direction(&mut self, path: String, direction: Direction) {
        match direction {
            Direction::Vector(vector) if direction.unit(0.0).length() < 0.5 => {
                self.fault(path, format!("{vector} has no direction"), "give a vector that is not zero");
            }
            Direction::Heading(angle) => self.finite(path, angle),
            _ => {}
        }
    }

    fn document(&mut self, scenario: &Scenario) {
        if scenario.title.trim().is_empty() {
            self.fault("title", "the title is empty", "the clip is named after it: write what happens");
        }
        if scenario.title.chars().count() > 200 {
            self.fault("title", "the title is longer than 200 letters", "the clip is named after it: shorten it");
        }
        if !self.positive("duration", scenario.duration, LONGEST, "s") {
            self.duration = f64::INFINITY; // one fault is enough: do not measure the lanes by it
        }
        if scenario.seed > GREATEST_SEED {
            self.fault("seed", format!("{} is out of range", scenario.seed), format!("give 0 to {GREATEST_SEED}"));
        }
    }

    fn character(&mut self, scenario: &Scenario) {
        let character = &scenario.character;
        if let Some(mass) = character.mass {
            self.range("character.mass", mass, MASSES, "kg");
        }
        self.range("character.leg_scale", character.leg_scale, LEG_SCALES, "");
        let style = &character.style;
        for (key, value) in [
            ("crouch", character.crouch),
            ("agility", character.agility),
            ("breathing", character.breathing),
            ("step_height", style.step_height),
            ("stance_width", style.stance_width),
            ("readiness", style.readiness),
            ("recovery_time", style.recovery_time),
            ("arms", style.arms),
        ] {
            self.range(format!("character.{key}"), value, (0.0, 1.0), "");
        }
    }

    fn ground(&mut self, scenario: &Scenario) {
        self.range("ground.friction", scenario.ground.friction, FRICTIONS, "");
        match &scenario.ground.kind {
            GroundKind::Flat => {}
            GroundKind::Slope { angle } => {
                self.range("ground.angle", tidy_degrees(*angle), (-45.0, 45.0), "degrees");
            }
            GroundKind::Stairs { rise, tread, count } => {
                self.range("ground.rise", *rise, (-0.5, 0.5), "m");
                self.range("ground.tread", *tread, (0.1, 5.0), "m");
                self.range("ground.count", f64::from(*count), (1.0, 200.0), "");
            }
            GroundKind::Uneven { height, wavelength, seed } => {
                self.range("ground.height", *height, (0.0, 1.0), "m");
                self.range("ground.wavelength", *wavelength, (0.2, 100.0), "m");
                if *seed > GREATEST_SEED {
                    self.fault("ground.seed", format!("{seed} is out of range"), format!("give 0 to {GREATEST_SEED}"));
                }
            }
            GroundKind::Gaps { width, spacing } => {
                let good = self.positive("ground.width", *width, 5.0, "m");
                if good && !(*spacing > *width && *spacing <= 100.0) {
                    self.fault(
                        "ground.spacing",
                        format!("{spacing} m from gap to gap leaves no ground between gaps of {width} m"),
                        format!("give more than {width} and at most 100 m"),
                    );
                }
            }
            GroundKind::Platform { pitch, roll } => {
                for (key, angles) in [("pitch", pitch), ("roll", roll)] {
                    self.curve(&format!("ground.{key}"), angles);
                    for (index, [_, angle]) in angles.iter().enumerate() {
                        self.range(format!("ground.{key}.{index}.1"), tidy_degrees(*angle), (-60.0, 60.0), "degrees");
                    }
                }
            }
        }
    }

    /// Times of a curve: from 0 on, rising.
    fn curve(&mut self, path: &str, points: &[[f64; 2]]) {
        let mut before = f64::NEG_INFINITY;
        for (index, [time, _]) in points.iter().enumerate() {
            if !(*time >= 0.0 && time.is_finite()) {
                self.fault(format!("{path}.{index}.0"), format!("{time} s is not a time"), "times count from 0");
            } else if *time <= before {
                self.fault(
                    format!("{path}.{index}.0"),
                    format!("{time} s does not come after {before} s"),
                    "put the points in the order of their times, each time once",
                );
            }
            before = *time;
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
            for (axis, length) in carry.size.to_array().into_iter().enumerate() {
                self.range(format!("{path}.size.{axis}"), length, (0.01, 3.0), "m");
            }
            let end = |carry: &super::scenario::Carry| carry.end.unwrap_or(self.duration);
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

/// A sum of decimal fractions as a person would write it.
fn tidy(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// rad to degrees as a person wrote them.
fn tidy_degrees(angle: f64) -> f64 {
    tidy(angle.to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::{Carry, Turn, Walk};
    use glam::DVec3;

    fn paths(scenario: &Scenario) -> Vec<String> {
        scenario.validate().into_iter().map(|fault| fault.path).collect()
    }

    #[test]
    fn the_default_and_the_demo_are_good() {
        assert_eq!(Scenario::default().validate(), []);
        assert_eq!(Scenario::demo().validate(), []);
    }

    #[test]
    fn a_push_may_end_with_the_scenario_but_not_after_it() {
        let mut scenario = Scenario::demo();
        scenario.push[0].start = scenario.duration - 0.2; // 3.8 + 0.2, which is not 4.0 in binary everywhere
        assert!(paths(&scenario).is_empty());
        scenario.push[0].duration = 0.21;
        assert_eq!(paths(&scenario), ["push.0.duration"]);
    }

    #[test]
    fn every_fault_is_reported() {
        let mut scenario = Scenario::demo();
        scenario.character.agility = 1.5;
        scenario.ground.friction = f64::NAN;
        scenario.push[0].force = -1.0;
        scenario.push[0].toward = Direction::Vector(DVec3::ZERO);
        assert_eq!(paths(&scenario), ["character.agility", "ground.friction", "push.0.force", "push.0.toward"]);
    }

    #[test]
    fn a_bad_duration_is_one_fault() {
        let scenario = Scenario { duration: -1.0, ..Scenario::demo() };
        assert_eq!(paths(&scenario), ["duration"]);
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
        let carry = Carry { start: 0.0, end: None, mass: vec![[0.0, 2.0]], size: DVec3::splat(0.3) };
        let mut scenario =
            Scenario { carry: vec![carry.clone(), Carry { start: 2.0, ..carry }], ..Scenario::default() };
        assert_eq!(paths(&scenario), ["carry.1.start"]);
        scenario.carry[0].end = Some(2.0);
        assert!(paths(&scenario).is_empty());
    }
}
