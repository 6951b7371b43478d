//! The gate at work: a body's clip that stands as nobody lets pass is searched for again, then helped where help is allowed, then falls.
//!
//! What may not pass says [`crate::measure::gate`]: both feet in the air without a jump, a force from nowhere, legs through each other.

use super::played::Played;
use super::ragdoll::{Drive, Helped, rungs};
use super::{BakeError, BakeOptions, Baked, Performance, contacts, once};
use crate::measure::gate::{Hindrance, LONGEST_HOVER, gate};
use crate::measure::{Findings, Frame, HeldContact, KnownPush, Motion, Scuff, Setting, measure_in};
use crate::model::BodyPose;
use crate::model::report::Outcome;
use crate::model::scenario::Scenario;
use crate::rig::Rig;
use crate::sim::Ahead;

/// Hz, samples of what is measured of a part of a motion, as of a clip at 30 frames a second; and the fewest that can be.
const HZ: f64 = 120.0;
const PER_FRAME: usize = 4;
const LEAST: f64 = 12.0;

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

/// Why a clip that stands may not pass. What a base clip that walks does by itself is not asked.
fn hindrance(baked: &Baked) -> Option<Hindrance> {
    let found = baked.findings.as_ref().filter(|_| stands(baked))?;
    let Some([away, alone]) = baked.performance.timeline.played.as_ref().and_then(Played::away) else {
        return gate(found).into_iter().next();
    };
    let (away, alone) = (between(&baked.performance, away)?, between(&baked.performance, alone));
    // Where clip and run are blended no body moves.
    let residual_kept_up = alone.map_or((0.0, 0.0), |alone| alone.residual_kept_up);
    gate(&Findings { residual_kept_up, ..away }).into_iter().next()
}

/// What is measured of the motion between two times (s); nothing where that is too short.
fn between(performance: &Performance, [from, to]: [f64; 2]) -> Option<Findings> {
    let timeline = &performance.timeline;
    let count = ((to.min(timeline.stands()) - from) * HZ).floor();
    let count = (count > LEAST).then_some(count as usize + 1)?;
    let poses: Vec<BodyPose> = (0..count).map(|sample| timeline.pose_at(from + sample as f64 / HZ)).collect();
    let motion = Motion { body: &timeline.body, hz: HZ, per_frame: PER_FRAME, poses: &poses };
    let contacts = contacts::held(&performance.contacts, Frame::of(&timeline.terrain)).into_iter();
    let shifted = |held: HeldContact| HeldContact { start: held.start - from, end: held.end - from, ..held };
    let held: Vec<HeldContact> = contacts.map(shifted).filter(|held| held.end > 0.0).collect();
    let pushes = performance.pushes.iter();
    let pushes: Vec<KnownPush> =
        pushes.map(|push| KnownPush { start: push.start - from, end: push.end - from, ..*push }).collect();
    let scuffs = timeline.played.as_ref().map_or(&[][..], Played::scuffs).iter();
    let scuffs: Vec<Scuff> =
        scuffs.map(|scuff| Scuff { start: scuff.start - from, end: scuff.end - from, ..*scuff }).collect();
    let setting = Setting { terrain: &timeline.terrain, loads: &[], crouched: 0.0, scuffs: &scuffs, goes: false };
    let mut found = measure_in(motion, &setting, &held, &pushes)?;
    for time in [&mut found.hover.time, &mut found.residual_kept_up.1, &mut found.legs.time] {
        *time += from;
    }
    Some(found)
}

/// s, when it is too much.
fn when(why: &Hindrance) -> f64 {
    match why {
        Hindrance::Hover { time, .. } => time + LONGEST_HOVER,
        Hindrance::Force { time, .. } | Hindrance::Legs { time, .. } => *time,
    }
}
