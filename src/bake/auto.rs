//! Chooses between the stepper and the articulated body: both play the scenario, and what is better is kept.
//!
//! Who stands is before who falls. Where things touch the body (balls, a box, a platform) the articulated body is kept, and so
//! it is where both fall; else the clip of the higher plausibility, the stepper's where they are even.

use super::ragdoll::{Drive, Helped, unplayed};
use super::{BakeError, BakeOptions, Baked, bake_by};
use crate::model::report::Outcome;
use crate::model::scenario::{GroundKind, Scenario};
use crate::rig::Rig;

/// Why a drive was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// For a person.
    pub why: String,
    /// Plausibility of the clip that was not kept, where there is one.
    pub other: Option<f64>,
}

/// Bakes with the drive that does it better.
pub(super) fn bake(rig: &Rig, scenario: &Scenario, options: &BakeOptions, helped: Helped) -> Result<Baked, BakeError> {
    let stepper = bake_by(rig, scenario, options, Drive::Stepper)?;
    let unplayed = unplayed(scenario);
    if !unplayed.is_empty() {
        return Ok(stepper.chosen(format!("the ragdoll cannot play {} yet", unplayed.join(", ")), None));
    }
    let ragdoll = match bake_by(rig, scenario, options, Drive::Ragdoll(helped)) {
        Ok(baked) => baked,
        Err(error) => return Ok(stepper.chosen(format!("of the ragdoll, {error}"), None)),
    };
    let score = |baked: &Baked| baked.report.plausibility.score;
    let falls = |baked: &Baked| baked.report.outcome == Outcome::Fall;
    let scores = (score(&stepper), score(&ragdoll));
    Ok(match (falls(&stepper), falls(&ragdoll)) {
        (false, true) => stepper.chosen("the ragdoll falls".into(), Some(scores.1)),
        (true, false) => ragdoll.chosen("the stepper falls".into(), Some(scores.0)),
        (true, true) => ragdoll.chosen("both fall, and the stepper's clip would end there".into(), Some(scores.0)),
        _ if touched(scenario) => ragdoll.chosen("things touch the body".into(), Some(scores.0)),
        _ if scores.1 > scores.0 => ragdoll.chosen("its clip is the more plausible".into(), Some(scores.0)),
        _ => stepper.chosen("its clip is the more plausible".into(), Some(scores.1)),
    })
}

/// Whether anything but a push meets the body.
fn touched(scenario: &Scenario) -> bool {
    let platform = matches!(scenario.ground.kind, GroundKind::Platform { .. });
    platform || !scenario.throw.is_empty() || !scenario.carry.is_empty()
}

impl Baked {
    fn chosen(self, why: String, other: Option<f64>) -> Baked {
        Baked { choice: Some(Choice { why, other }), ..self }
    }
}
