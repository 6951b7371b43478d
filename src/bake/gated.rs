//! The gate at work: a body's clip that stands as nobody lets pass is searched for again, then helped where help is allowed, then falls.
//!
//! What may not pass says [`crate::measure::gate`]: both feet in the air without a jump, a force from nowhere, legs through each other.

use super::ragdoll::{Drive, Helped, rungs};
use super::{BakeError, BakeOptions, Baked, once};
use crate::measure::gate::{Hindrance, LONGEST_HOVER, gate};
use crate::model::report::Outcome;
use crate::model::scenario::Scenario;
use crate::rig::Rig;
use crate::sim::Ahead;

/// How a clip's warning begins whose run stood as nobody does, and fell for it.
pub const FALLS: &str = "it falls because it could only go on as nobody does";

/// Bakes the articulated body, helped like that.
pub(super) fn bake(rig: &Rig, scenario: &Scenario, options: &BakeOptions, helped: Helped) -> Result<Baked, BakeError> {
    let ahead = Ahead { effort: options.effort, ..Ahead::default() };
    let play = |helped: Helped, ahead: Ahead| once(rig, scenario, options, (Drive::Ragdoll(helped), ahead));
    let first = play(helped, ahead)?;
    let Some(why) = hindrance(&first) else { return Ok(first) };
    if ahead.effort > 0 {
        let second = play(helped, Ahead { again: 1, ..ahead })?;
        if stands(&second) && hindrance(&second).is_none() {
            return Ok(second);
        }
    }
    let bound = first.performance.articulated.as_ref().map(|driven| driven.bound).unwrap_or_default();
    if helped == Helped::Auto {
        let more = rungs(first.report.body.mass).filter(|rung| rung.torque > bound.torque || rung.force > bound.force);
        for rung in more {
            let other = play(Helped::Within(rung), Ahead::default())?;
            if stands(&other) && hindrance(&other).is_none() {
                return Ok(other);
            }
        }
    }
    let gives_up = Some(when(&why).min(scenario.duration));
    let mut fallen = play(Helped::Within(bound), Ahead { gives_up, ..ahead })?;
    let told = format!("{FALLS}: {why}");
    fallen.report.plausibility.notes.insert(0, told.clone());
    fallen.warnings.push(told);
    Ok(fallen)
}

fn stands(baked: &Baked) -> bool {
    baked.report.outcome != Outcome::Fall
}

/// Why a clip that stands may not pass.
fn hindrance(baked: &Baked) -> Option<Hindrance> {
    let found = baked.findings.as_ref().filter(|_| stands(baked))?;
    gate(found).into_iter().next()
}

/// s, when it is too much.
fn when(why: &Hindrance) -> f64 {
    match why {
        Hindrance::Hover { time, .. } => time + LONGEST_HOVER,
        Hindrance::Force { time, .. } | Hindrance::Legs { time, .. } => *time,
    }
}
