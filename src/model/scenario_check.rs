//! The checks that the rules of a scenario are made of: ranges, times, curves. Each fault that they find names its place as a path
//! (`push.0.force`); messages speak in the units of the text.

use super::scenario::Direction;
use super::scenario_errors::Fault;

/// s; longer clips are refused: at 600 s a file is past what an engine loads gladly.
pub(super) const LONGEST: f64 = 600.0;

/// s, slack for sums of decimal fractions.
pub(super) const TIME_SLACK: f64 = 1e-9;

/// Collects faults.
pub(super) struct Check {
    /// s, of the scenario.
    pub(super) duration: f64,
    pub(super) faults: Vec<Fault>,
}

impl Check {
    pub(super) fn fault(&mut self, path: impl Into<String>, message: impl Into<String>, remedy: impl Into<String>) {
        self.faults.push(Fault { path: path.into(), message: message.into(), remedy: remedy.into() });
    }

    /// `low..=high`; what it is and its unit for the message.
    pub(super) fn range(&mut self, path: impl Into<String>, value: f64, (low, high): (f64, f64), unit: &str) -> bool {
        let good = value >= low && value <= high; // false for NaN
        if !good {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            self.fault(path, format!("{value}{unit} is out of range"), format!("give {low} to {high}{unit}"));
        }
        good
    }

    /// Over zero, at most `high`.
    pub(super) fn positive(&mut self, path: impl Into<String>, value: f64, high: f64, unit: &str) -> bool {
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

    pub(super) fn finite(&mut self, path: impl Into<String>, value: f64) {
        if !value.is_finite() {
            self.fault(path, "not a finite number", "give a plain number");
        }
    }

    /// The start of an entry: in the scenario.
    pub(super) fn start(&mut self, path: &str, start: f64) -> bool {
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

    pub(super) fn optional_duration(&mut self, path: &str, duration: Option<f64>) {
        if let Some(duration) = duration {
            self.positive(format!("{path}.duration"), duration, LONGEST, "s");
        }
    }

    pub(super) fn direction(&mut self, path: String, direction: Direction) {
        match direction {
            Direction::Vector(vector) if direction.unit(0.0).length() < 0.5 => {
                self.fault(path, format!("{vector} has no direction"), "give a vector that is not zero");
            }
            Direction::Heading(angle) => self.finite(path, angle),
            _ => {}
        }
    }

    /// Times of a curve: from 0 on, rising.
    pub(super) fn curve(&mut self, path: &str, points: &[[f64; 2]]) {
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
}

/// A sum of decimal fractions as a person would write it.
pub(super) fn tidy(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// rad to degrees as a person wrote them.
pub(super) fn tidy_degrees(angle: f64) -> f64 {
    tidy(angle.to_degrees())
}
