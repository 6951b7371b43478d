//! A scenario played by the articulated body: its run, and the clip's motion that is that run. Scenario space, SI.
//!
//! The stepper has no part in it.

use super::over::Course;
use super::{Played, Run, walk};
use crate::bake::base::{Base, Over, Stood};
use crate::bake::perform::{Performance, check, style};
use crate::bake::ragdoll::{self, Driven, Helped};
use crate::bake::timeline::Timeline;
use crate::bake::unplayed::{unfit, unplayed};
use crate::bake::{BakeError, carried, pushes, throws};
use crate::measure::KnownPush;
use crate::model::scenario::Scenario;
use crate::model::{Body, Terrain};
use crate::sim::{Ahead, ArticulatedOptions};
use crate::whole_body::reaction::Personality;
use crate::whole_body::{Anatomy, stand};
use std::sync::Arc;

/// Runs the scenario on a body with at most that help.
pub fn perform(
    body: &Body,
    scenario: &Scenario,
    seed: u64,
    (helped, ahead): (Helped, Ahead),
    base: Option<&Arc<Base>>,
) -> Result<Performance, BakeError> {
    let unplayed = unplayed(scenario, base.map(Arc::as_ref));
    if !unplayed.is_empty() {
        return Err(BakeError::Unplayed { parts: unplayed.join(", ") });
    }
    if let Some(part) = unfit(scenario, body) {
        return Err(BakeError::Unplayed { parts: part.into() });
    }
    let anatomy = Anatomy::new(body);
    let over = base.map(|base| Over::new(base, body, &anatomy, scenario)).transpose()?;
    let part = match &over {
        Some(Over::Stand(stood)) => stood.unplayed(&anatomy),
        Some(Over::Walk(walked)) => walk::unplayed(walked, body, &stand::physique(body, &anatomy)),
        None => None,
    };
    if let Some(part) = part {
        return Err(BakeError::Unplayed { parts: part.into() });
    }
    let driven = match &over {
        // A clip is not the same in the mirror.
        Some(Over::Stand(stood)) => {
            run(body, scenario, seed, (helped, ahead), Some(stood.as_ref()), &pushes::known(body, scenario))?
        }
        Some(Over::Walk(walked)) => walk::walk(body, scenario, seed, (helped, ahead), walked)?,
        None => driven(body, scenario, seed, (helped, ahead))?,
    };
    let physique = stand::physique(body, &anatomy);
    let physique = over.as_ref().map_or(physique, |over| over.physique(&physique));
    let (carried, loads) = carried::carried(body, &anatomy, scenario);
    let known = pushes::known(body, scenario);
    let trace = driven.run.trace.clone();
    check(&trace)?;
    let balls = driven.balls();
    let acted = known.iter().zip(&trace.pushes);
    let mut pushes: Vec<KnownPush> =
        acted.map(|((push, _), acted)| KnownPush { force: acted.force, ..*push }).collect();
    pushes.extend(balls.iter().filter_map(|ball| ball.hit).map(|hit| hit.push));
    pushes.sort_by(|a, b| a.start.total_cmp(&b.start));
    let terrain = Terrain::new(&scenario.ground);
    let played = played(&driven, (scenario, &pushes), (body, &anatomy), &terrain, over);
    let over = played.over();
    let contacts = played.contacts();
    let lost = trace.lost;
    let com = (0..=played.stands).map(|tick| match &over {
        // Before it is struck and at the end it is the clip.
        Some(Over::Walk(_)) => {
            let pose = played.pose_at(body, &anatomy, &terrain, tick as f64 * trace.dt);
            pose.centre_of_mass(body, &pose.positions(body))
        }
        _ => trace.ticks[tick].com,
    });
    let com = com.collect();
    let mut timeline =
        Timeline::played(body, anatomy, (trace.dt, com), (&physique, &trace.start, &trace.steps), &terrain, played);
    (timeline.carried, timeline.loads, timeline.over) = (carried, loads, over);
    Ok(Performance {
        timeline,
        trace,
        lost,
        contacts,
        pushes,
        balls,
        physique,
        style: style(scenario),
        zmp_before_pass: Vec::new(),
        articulated: Some(driven),
    })
}

/// The run. What first goes to the right is played to the left by the mirrored body and seen in the mirror: a scenario and its mirror
/// image are then the same run.
fn driven(body: &Body, scenario: &Scenario, seed: u64, help: (Helped, Ahead)) -> Result<Driven, BakeError> {
    let (scenario, mirrored) = scenario.to_the_left();
    let known = pushes::known(body, &scenario);
    if !mirrored {
        return run(body, &scenario, seed, help, None, &known);
    }
    let (image, twins) = body.mirrored();
    // Who is the same on both sides plays both himself: what his file rounds would grow in a run.
    let player = if body.is_alike(&image) { body } else { &image };
    let known = pushes::known(player, &scenario);
    let driven = run(player, &scenario, seed, help, None, &known).map_err(in_the_mirror)?;
    Ok(Driven { run: driven.run.mirrored(&twins), ..driven })
}

/// The part that is named is the other side's.
fn in_the_mirror(error: BakeError) -> BakeError {
    match error {
        BakeError::Overdone { time, what, mass } => {
            let [left, right] = ["the left ", "the right "];
            let what = if what.contains(left) { what.replace(left, right) } else { what.replace(right, left) };
            BakeError::Overdone { time, what, mass }
        }
        error => error,
    }
}

/// The run of a scenario as it is, under those pushes.
pub(super) fn run(
    body: &Body,
    scenario: &Scenario,
    seed: u64,
    (helped, ahead): (Helped, Ahead),
    stood: Option<&Stood>,
    known: &[(KnownPush, bool)],
) -> Result<Driven, BakeError> {
    let anatomy = Anatomy::new(body);
    let physique = stand::physique(body, &anatomy);
    let (carried, loads) = carried::carried(body, &anatomy, scenario);
    let options = ArticulatedOptions {
        duration: scenario.duration,
        personality: Personality::drawn(seed),
        arms: scenario.character.style.arms,
        ahead,
        // The run ends with the clip.
        extra: 0.0,
        seed,
        style: style(scenario),
        ..ArticulatedOptions::default()
    };
    let tosses = throws::tosses(scenario, seed);
    ragdoll::run(body, &anatomy, &physique, scenario, &options, known, &tosses, (&carried, &loads), helped, stood)
}

/// The run up to the clip's end; a fall that begins before it goes on until the body lies.
fn played(
    driven: &Driven,
    (scenario, pushes): (&Scenario, &[KnownPush]),
    (body, anatomy): (&Body, &Anatomy),
    terrain: &Terrain,
    over: Option<Over>,
) -> Played {
    let run = &driven.run;
    let dt = run.trace.dt;
    let duration = scenario.duration;
    let whole = (duration / dt).round().max(0.0) as usize;
    let stands = whole.min(run.trace.ticks.len().min(run.poses.len()).saturating_sub(1));
    let falls = run.trace.lost.is_some_and(|lost| lost <= duration);
    let last = if falls { run.poses.len() } else { stands + 1 };
    let input = Run { body, anatomy, terrain, dt, pressed: &run.pressed, stood: &run.stood, joints: &run.joints };
    let played = Played::new(&input, run.poses[..last].to_vec(), stands);
    let struck = pushes.iter().map(|push| push.start).fold(f64::INFINITY, f64::min);
    let pushed = pushes.iter().map(|push| push.end).fold(0.0, f64::max);
    match over {
        Some(Over::Stand(stood)) => {
            let busy = run.trace.steps.iter().map(|step| step.land).fold(pushed, f64::max);
            let struck = begins(scenario).fold(struck, f64::min);
            played.over_stand(&input, *stood, &Course { struck, busy, stands: !falls })
        }
        Some(Over::Walk(walked)) => played.over_walk(&input, *walked, &run.trace.steps, (struck, pushed, !falls)),
        None => played,
    }
}

/// s, when each thing begins that is asked of it.
fn begins(scenario: &Scenario) -> impl Iterator<Item = f64> + '_ {
    let walks = scenario.walk.iter().map(|walk| walk.start);
    walks.chain(scenario.turn.iter().map(|turn| turn.start)).chain(scenario.stand.iter().map(|stand| stand.start))
}
