//! The run over a base clip that walks: a body that walks as fast by itself, struck where it is as far in its step as the clip.
//!
//! It starts at rest, as every run does, and walks until its gait is steady; what is before the moment that is the clip's first is cut off.
//! Scenario space, SI.

use super::perform::run;
use crate::bake::base::Walked;
use crate::bake::base::walk::{AFTER, WARM};
use crate::bake::ragdoll::{Driven, Helped};
use crate::bake::{BakeError, pushes};
use crate::measure::KnownPush;
use crate::model::scenario::{Scenario, Walk};
use crate::model::{Body, Physique, Side};
use crate::ragdoll::control::Assist;
use crate::sim::{Ahead, Trace};
use glam::{DQuat, DVec3};

/// m/s on legs of 0.83 m: over clips that walk faster bodies were not looked at.
const FASTEST: f64 = 1.3;
/// Of the height in a stand: a walk whose centre of mass is lower in the mean is crouched.
const CROUCHED: f64 = 0.92;
/// s at the end of the walk by itself, over which its speed is seen, and how much of the clip's it must have: chibis step on the spot.
const SEEN: f64 = 2.0;
const GETS_ON: f64 = 0.85;

/// What of a base clip that walks cannot be played on a body, for a person.
pub(super) fn unplayed(walked: &Walked, body: &Body, physique: &Physique) -> Option<&'static str> {
    let gait = &walked.gait;
    match () {
        () if gait.velocity.length() > FASTEST * (body.leg_length / 0.83).sqrt() => {
            Some("[base] that walks at more than 1.3 m/s")
        }
        () if gait.com_height < CROUCHED * physique.com_height => Some("[base] that walks crouched"),
        () => None,
    }
}

/// Whether a walk by itself gets on as fast as the clip.
fn gets_on(trace: &Trace, walked: &Walked) -> bool {
    let back = (SEEN / trace.dt) as usize;
    let [Some(first), Some(last)] = [trace.ticks.len().checked_sub(1 + back), trace.ticks.len().checked_sub(1)] else {
        return false;
    };
    let way = (trace.ticks[last].com - trace.ticks[first].com).with_y(0.0).length();
    trace.lost.is_none() && way > GETS_ON * walked.gait.velocity.length() * back as f64 * trace.dt
}

/// The body's run from the clip's first moment on, laid where the clip walks.
pub(super) fn walk(
    body: &Body,
    scenario: &Scenario,
    seed: u64,
    (helped, ahead): (Helped, Ahead),
    walked: &Walked,
) -> Result<Driven, BakeError> {
    let facing = walked.gait.facing;
    let lane = walked.lane();
    // It starts facing ahead: the run is turned to where the clip faces.
    let lane = Walk { heading: lane.heading - facing, facing: Some(0.0), ..lane };
    let walks = Scenario { base: None, walk: vec![lane], ..scenario.clone() };
    let known = pushes::known(body, scenario);
    let from = known.iter().map(|(push, _)| push.start).fold(scenario.duration, f64::min);
    let alone = Scenario { duration: WARM.max(from) + AFTER, push: Vec::new(), pull: Vec::new(), ..walks.clone() };
    let helped_alone = match helped {
        Helped::Within(_) => helped,
        Helped::Auto => Helped::Within(Assist::default()),
    };
    let bare = run(body, &alone, seed, (helped_alone, Ahead::default()), None, &[])?.run.trace;
    let cannot =
        || BakeError::Unplayed { parts: "[base] that walks as the body of this rig does not by itself".into() };
    if !gets_on(&bare, walked) {
        return Err(cannot());
    }
    let ago = walked.beat(from, &bare.steps, bare.dt);
    let turn = DQuat::from_rotation_y(-facing);
    let later = |(push, turns): &(KnownPush, bool)| {
        let force = if *turns { push.force } else { turn * push.force };
        (KnownPush { start: push.start + ago, end: push.end + ago, force, ..*push }, *turns)
    };
    let pushes: Vec<(KnownPush, bool)> = known.iter().map(later).collect();
    let ahead = Ahead { gives_up: ahead.gives_up.map(|when| when + ago), ..ahead };
    let walks = Scenario { duration: scenario.duration + ago + AFTER, ..walks };
    let driven = run(body, &walks, seed, (helped, ahead), None, &pushes)?;
    if driven.run.trace.lost.is_some_and(|lost| lost < from + ago) {
        return Err(cannot());
    }
    let first = (ago / driven.run.trace.dt).round() as usize;
    let begun = driven.run.begun_at(first, scenario.duration).moved(facing, DVec3::ZERO);
    let at = ((from / begun.trace.dt).round() as usize).min(begun.trace.ticks.len().saturating_sub(1));
    let run = begun.poses.get(at).map(|pose| (pose.positions(body), begun.trace.ticks[at].com));
    let by = run.map_or(DVec3::ZERO, |(positions, com)| {
        // Laid so that who stands on a foot stands where the clip's does: beside that he would swing the other one through the leg. With
        // a foot on its way down both are as far off.
        let coming = Side::BOTH.iter().any(|side| walked.lands(*side, from).is_some());
        let stance = walked.gait.falls.iter().rfind(|fall| fall.down <= from && !coming);
        let on = |side: Side| walked.gait.foot(side, from).ankle - positions[body.feet[side as usize].ankle];
        stance.map_or(walked.gait.at(from).com - com, |fall| on(fall.side)).with_y(0.0)
    });
    Ok(Driven { run: begun.moved(0.0, by), ..driven })
}
