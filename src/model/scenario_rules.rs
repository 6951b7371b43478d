//! What a scenario must hold to make sense, whoever wrote it: the document, its character and its ground. What its lanes must hold
//! says `scenario_lane_rules`.
//!
//! Every fault is found, not only the first; each names its place as a path (`push.0.force`), which the text form turns
//! into a line. Messages speak in the units of the text: degrees, seconds, newtons.

use super::scenario::{GroundKind, Scenario};
use super::scenario_check::{Check, LONGEST, tidy_degrees};
use super::scenario_errors::Fault;

/// Least and greatest body mass, kg.
const MASSES: (f64, f64) = (1.0, 2000.0);
/// Least and greatest leg scale.
const LEG_SCALES: (f64, f64) = (0.25, 4.0);
/// Least and greatest friction: under 0.05 nobody can push off the ground.
const FRICTIONS: (f64, f64) = (0.05, 10.0);
/// Least and greatest factor on the legs' springs and dampers: softer they fold, stiffer a tick is too long for them.
const SPRINGS: (f64, f64) = (0.25, 4.0);
/// Least and greatest bias of a step's length.
const BIASES: (f64, f64) = (0.0, 2.0);
/// Lowest and highest ceiling of a mesh, m over the origin.
const CEILINGS: (f64, f64) = (0.5, 100.0);
/// Seeds stay whole in readers that know numbers as doubles only: 2^53.
const GREATEST_SEED: u64 = 1 << 53;

impl Scenario {
    /// Everything that is out of range or contradicts itself; empty for a good scenario.
    pub fn validate(&self) -> Vec<Fault> {
        let mut check = Check { duration: self.duration, faults: Vec::new() };
        check.document(self);
        check.character(self);
        check.ground(self);
        check.stepper(self);
        check.lanes(self);
        check.faults
    }
}

impl Check {
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

    fn stepper(&mut self, scenario: &Scenario) {
        let stepper = &scenario.stepper;
        self.range("stepper.spring", stepper.spring, SPRINGS, "");
        self.range("stepper.damping", stepper.damping, SPRINGS, "");
        self.range("stepper.length_bias", stepper.length_bias, BIASES, "");
        self.range("stepper.pull_bias", stepper.pull_bias, BIASES, "");
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
            GroundKind::Mesh { file, ceiling, .. } => {
                if file.trim().is_empty() {
                    let remedy = "name a .glb or .gltf beside the scenario, as in `file = \"level.glb\"`";
                    self.fault("ground.file", "the name of the file is empty", remedy);
                }
                if let Some(ceiling) = ceiling {
                    self.range("ground.ceiling", *ceiling, CEILINGS, "m");
                }
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::model::scenario::Direction;
    use glam::DVec3;

    pub(in crate::model) fn paths(scenario: &Scenario) -> Vec<String> {
        scenario.validate().into_iter().map(|fault| fault.path).collect()
    }

    #[test]
    fn the_default_and_the_demo_are_good() {
        assert_eq!(Scenario::default().validate(), []);
        assert_eq!(Scenario::demo().validate(), []);
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
}
