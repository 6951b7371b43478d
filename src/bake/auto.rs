//! Chooses between the stepper and the articulated body: both play the scenario, and what is better is kept. Where that is clear after
//! one of them, the other bakes nothing.
//!
//! Who stands is before who falls, and who does as told before who does not set off, lift a foot or turn. Where things touch the body (balls, a box) the
//! articulated body is kept, and on a platform where its clip could hardly look better; else the clip of the higher plausibility, that of a body which
//! walks slower or higher than told counted for less, and the stepper's where they are even. Where both fall, the clip that shows more of it.

use super::base::Over;
use super::base::apart::ends_in;
use super::obeys::{Shirked, obeyed, shirked};
use super::ragdoll::{Drive, Helped};
use super::unplayed::unplayed;
use super::{BakeError, BakeOptions, Baked, bake_by};
use crate::model::report::Outcome;
use crate::model::scenario::{GroundKind, Scenario};
use crate::rig::Rig;

/// Why the ragdoll is kept where balls or a box meet a body that stays up, and where a platform does.
const TOUCHED: &str = "things touch the body";
const CARRIED: &str = "the ground moves";

/// Plausibility from which on another clip of someone who stands could hardly look better: what is above are differences that nobody sees.
const PLAUSIBLE: f64 = 0.95;

/// mm from the run: a clip of the ragdoll that is farther from it over a base clip is led back to that, not played.
const LED: f64 = 60.0;

/// Share of its plausibility that the clip of a body that does nothing of what it is told, or is led back to its base clip, is counted less by:
/// stairs that are gone one tread at a time look better than a stride down them on the stepper's bent ankles.
const LESS: f64 = 0.3;

/// Why a drive was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// For a person.
    pub why: String,
    /// Plausibility of the clip that was not kept, where there is one.
    pub other: Option<f64>,
}

/// How a clip of someone who falls goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fall {
    /// It ends where balance is lost, at that time (s).
    Ends(f64),
    /// It is measured as fallen (too low, or more than its feet on the ground) at that time (s), though the simulation keeps
    /// its balance.
    Measured(f64),
    /// Balance is lost then (s) and it goes down to the ground.
    Down(f64),
}

/// Bakes with the drive that does it better. Where things touch a body that stays up, and where it stands well on a platform, the stepper has no say, and
/// bakes nothing.
pub(super) fn bake(rig: &Rig, scenario: &Scenario, options: &BakeOptions, helped: Helped) -> Result<Baked, BakeError> {
    let stepper = || bake_by(rig, scenario, options, Drive::Stepper);
    if !favours_ragdoll(scenario) || !unplayed(scenario, options.base.as_deref()).is_empty() {
        return stepper().map(|stepper| choose(stepper, rig, scenario, options, helped));
    }
    let ragdoll = bake_by(rig, scenario, options, Drive::Ragdoll(helped));
    match ragdoll {
        Ok(ragdoll) if stands_as_told(&ragdoll, scenario) => match favoured(scenario, &ragdoll) {
            Some(why) => Ok(ragdoll.chosen(why.into(), None)),
            None => stepper().map(|stepper| better(stepper, Ok(ragdoll), scenario)),
        },
        ragdoll => stepper().map(|stepper| better(stepper, ragdoll, scenario)),
    }
}

/// Whether the ragdoll's clip may be kept whatever the stepper's is like: where things touch the body, and where the ground moves.
fn favours_ragdoll(scenario: &Scenario) -> bool {
    touched(scenario) || moves(scenario)
}

/// Why that clip of the ragdoll, who stands and does as told, is kept whatever the stepper's is like, if it is: where the ground moves it must
/// hardly be able to look better.
fn favoured(scenario: &Scenario, ragdoll: &Baked) -> Option<&'static str> {
    if touched(scenario) {
        return Some(TOUCHED);
    }
    (moves(scenario) && ragdoll.report.plausibility.score >= PLAUSIBLE).then_some(CARRIED)
}

/// Whether it stays up and does what it is told.
fn stands_as_told(baked: &Baked, scenario: &Scenario) -> bool {
    baked.fall().is_none() && shirked(scenario, &baked.performance).is_none()
}

/// The stepper's clip of that scenario, or the ragdoll's where that is better.
pub fn choose(stepper: Baked, rig: &Rig, scenario: &Scenario, options: &BakeOptions, helped: Helped) -> Baked {
    let unplayed = unplayed(scenario, options.base.as_deref());
    if !unplayed.is_empty() {
        return stepper.chosen(format!("the ragdoll cannot play {} yet", unplayed.join(", ")), None);
    }
    if stepper.fall().is_none() && !favours_ragdoll(scenario) && stepper.report.plausibility.score >= PLAUSIBLE {
        return stepper
            .chosen(format!("its clip stands, and no other is needed from a plausibility of {PLAUSIBLE} on"), None);
    }
    better(stepper, bake_by(rig, scenario, options, Drive::Ragdoll(helped)), scenario)
}

/// The better of two clips.
fn better(stepper: Baked, ragdoll: Result<Baked, BakeError>, scenario: &Scenario) -> Baked {
    let ragdoll = match ragdoll {
        Ok(baked) => baked,
        Err(error) => return stepper.chosen(format!("of the ragdoll, {error}"), None),
    };
    let scores = (stepper.report.plausibility.score, ragdoll.report.plausibility.score);
    let led = over_stand(&ragdoll) && ragdoll.report.drift.is_some_and(|drift| drift.position_mm > LED);
    let obeyed = if led { 0.0 } else { obeyed(scenario, &ragdoll.performance) };
    let weighed = scores.1 * (1.0 - LESS * (1.0 - obeyed));
    let shirked = shirked(scenario, &ragdoll.performance);
    let favoured = favoured(scenario, &ragdoll);
    match (stepper.fall(), ragdoll.fall()) {
        (None, Some(_)) => stepper.chosen("the ragdoll falls".into(), Some(scores.1)),
        (Some(_), None) => ragdoll.chosen("the stepper falls".into(), Some(scores.0)),
        (Some(one), Some(other)) => {
            let shows_more = other.shows() > one.shows() || (other.shows() == one.shows() && touched(scenario));
            if shows_more || (other.shows() == one.shows() && scores.1 > scores.0) {
                ragdoll.chosen(format!("both fall; its clip {other}, the stepper's {one}"), Some(scores.0))
            } else {
                stepper.chosen(format!("both fall; its clip {one}, the ragdoll's {other}"), Some(scores.1))
            }
        }
        _ if shirked.is_some() => {
            let what = shirked.map_or("obey", Shirked::told);
            stepper.chosen(format!("the ragdoll does not {what}"), Some(scores.1))
        }
        _ if is_home(&stepper) && !is_home(&ragdoll) => {
            stepper.chosen("the ragdoll does not come back to the base clip".into(), Some(scores.1))
        }
        _ if let Some(why) = favoured => ragdoll.chosen(why.into(), Some(scores.0)),
        _ if weighed > scores.0 => ragdoll.chosen("its clip is the more plausible".into(), Some(scores.0)),
        _ if led && scores.1 > scores.0 => {
            stepper.chosen("the ragdoll is led back to the base clip, farther than its run goes".into(), Some(scores.1))
        }
        _ if scores.1 > scores.0 => stepper.chosen("the ragdoll does less of what it is told".into(), Some(scores.1)),
        _ => stepper.chosen("its clip is the more plausible".into(), Some(scores.1)),
    }
}

/// Whether a clip ends in the base clip that it is laid over, if any.
fn is_home(baked: &Baked) -> bool {
    baked.report.base.as_ref().is_none_or(ends_in)
}

/// Whether it is laid over a base clip that stands.
fn over_stand(baked: &Baked) -> bool {
    matches!(baked.performance.timeline.over, Some(Over::Stand(_)))
}

/// Whether anything but a push and the ground meets the body.
fn touched(scenario: &Scenario) -> bool {
    !scenario.throw.is_empty() || !scenario.carry.is_empty()
}

/// Whether the ground moves under it.
fn moves(scenario: &Scenario) -> bool {
    matches!(scenario.ground.kind, GroundKind::Platform { .. })
}

impl Baked {
    /// How it falls, where it does.
    pub fn fall(&self) -> Option<Fall> {
        if self.report.outcome != Outcome::Fall {
            return None;
        }
        let lost = self.performance.lost_within(self.report.duration);
        Some(match lost {
            Some(lost) if self.performance.timeline.falls() => Fall::Down(lost),
            Some(lost) => Fall::Ends(lost),
            None => {
                let fallen = self.findings.as_ref().and_then(|findings| findings.balance.fallen);
                Fall::Measured(fallen.unwrap_or(self.report.duration))
            }
        })
    }

    fn chosen(self, why: String, other: Option<f64>) -> Baked {
        Baked { choice: Some(Choice { why, other }), ..self }
    }
}

impl Fall {
    /// The more of a fall a clip shows, the higher.
    fn shows(self) -> u8 {
        match self {
            Fall::Ends(_) => 0,
            Fall::Measured(_) => 1,
            Fall::Down(_) => 2,
        }
    }
}

impl std::fmt::Display for Fall {
    fn fmt(&self, to: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Fall::Ends(time) => write!(to, "ends where balance is lost, at {time:.2} s"),
            Fall::Measured(time) => write!(to, "is measured as fallen at {time:.2} s"),
            Fall::Down(time) => write!(to, "goes down from {time:.2} s on"),
        }
    }
}
