//! A scenario on a body, without a rig: the run, its feet and upper body, and the passes that make it one motion.
//!
//! stepper run -> foot curves and upper-body springs -> poses -> reach envelope and balance filter, a few times over.
//! Scenario space, SI. What comes out is a [`Timeline`] that gives the pose at any time; keys are made elsewhere.

use super::base::{Base, Over, over::whole};
use super::carried::{self, Carried};
use super::contacts::FootContact;
use super::ragdoll::{self, Drive};
use super::throws::{self, Ball};
use super::timeline::Timeline;
use super::{BakeError, BakeOptions, converge, feet, footing, played, pushes, slant};
use crate::maths::curve::smooth3;
use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::{Feet, Scenario};
use crate::model::{Body, Side, Terrain};
use crate::sim::{Ahead, Script, SessionPush, SimulateOptions, TickState, Trace, simulate};
use crate::stepper::{Phase, Physique, Plant, Step, Style};
use crate::whole_body::reaction::{Personality, Reaction, UpperAngles};
use crate::whole_body::solve::Solved;
use crate::whole_body::stoop::Stoop;
use crate::whole_body::struck::{Blow, struck};
use crate::whole_body::sway::Sway;
use crate::whole_body::{Anatomy, Solver, stand};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// s, in which a walk that is a base clip's is left at first and come back to at last.
const ENDS: f64 = 0.12;
/// A performed scenario.
#[derive(Clone, Debug)]
pub struct Performance {
    /// The pose at any time.
    pub timeline: Timeline,
    /// The run behind it.
    pub trace: Trace,
    /// s, where balance is lost and the motion ends.
    pub lost: Option<f64>,
    /// Foot contacts.
    pub contacts: Vec<FootContact>,
    /// The pushes as they act.
    pub pushes: Vec<KnownPush>,
    /// The balls that were thrown, hits and misses.
    pub balls: Vec<Ball>,
    /// The stand that the stepper knew.
    pub physique: Physique,
    /// The scenario's dials of the stepper.
    pub style: Style,
    /// The articulated body's run, where it drove.
    pub articulated: Option<ragdoll::Driven>,
    /// m, the farthest that the ZMP was out of the support before each pass of the filter.
    pub zmp_before_pass: Vec<f64>,
}

/// Runs the scenario on a body, the stepper at the wheel.
pub fn perform(body: &Body, scenario: &Scenario, seed: u64) -> Result<Performance, BakeError> {
    perform_by(body, scenario, seed, Drive::Stepper)
}

/// Runs the scenario on a body.
pub fn perform_by(body: &Body, scenario: &Scenario, seed: u64, drive: Drive) -> Result<Performance, BakeError> {
    perform_over(
        body,
        scenario,
        seed,
        (drive, Ahead { effort: BakeOptions::default().effort, ..Ahead::default() }),
        None,
    )
}

/// The same, with that effort, starting from a base clip and returning to it.
pub fn perform_over(
    body: &Body,
    scenario: &Scenario,
    seed: u64,
    (drive, ahead): (Drive, Ahead),
    base: Option<&Arc<Base>>,
) -> Result<Performance, BakeError> {
    if let Drive::Ragdoll(helped) | Drive::Auto(helped) = drive {
        return played::perform::perform(body, scenario, seed, (helped, ahead), base);
    }
    let anatomy = Anatomy::new(body);
    let mut over = base.map(|base| Over::new(base, body, &anatomy, scenario)).transpose()?;
    let physique = stand::physique(body, &anatomy);
    let physique = over.as_ref().map_or(physique, |over| over.physique(&physique));
    let (carried, loads) = carried::carried(body, &anatomy, scenario);
    let style = style(scenario);
    let options = SimulateOptions { duration: scenario.duration, style, ..SimulateOptions::default() };
    let most = ((options.duration + options.extra) / options.dt).ceil() as usize + 2;
    let physiques = carried::physiques(body, &anatomy, (&carried, &loads), options.dt, most);
    let mut script = Script { physiques, ..Script::of(scenario, Vec::new()) };
    let mut pushes = pushes::known(body, scenario);
    let mut trace = match &over {
        Some(Over::Walk(walked)) => {
            script.walk = vec![walked.lane()];
            let from = pushes.iter().map(|(push, _)| push.start).fold(whole(scenario, options.dt), f64::min);
            walked.walk_on(from, &options, &pushes, &|options, pushes| {
                run(body, &anatomy, &physique, &script, options, pushes)
            })
        }
        _ => run(body, &anatomy, &physique, &script, &options, &pushes),
    };
    let mut balls = Vec::new();
    let tosses = throws::tosses(scenario, seed);
    for toss in &tosses {
        let index = (toss.arrives / trace.dt).round() as usize;
        let Some(tick) = trace.ticks.get(index) else { break };
        let measures = script.physiques.get(index).unwrap_or(&physique);
        let ground = tick.feet[0].ankle.y.min(tick.feet[1].ankle.y);
        let com = DVec3::new(tick.com.x, ground + measures.com_height, tick.com.z);
        let target = stand::stand_target(body, &tick.feet, com, tick.facing);
        let hold = carried::hold(&carried, &loads, toss.arrives);
        let solved = Solver::new(body, &anatomy).solve(&hold.map_or(target, |hold| target.holding(hold)));
        let ball = toss.meet(&throws::Standing {
            body,
            pose: &solved.pose,
            velocity: tick.velocity,
            facing: tick.facing,
            mass: measures.mass,
            load: loads.iter().find(|load| load.span[0] <= toss.arrives && toss.arrives <= load.span[1]),
        });
        if let Some(hit) = &ball.hit {
            pushes.push((hit.push, false));
            pushes.sort_by(|a, b| a.0.start.total_cmp(&b.0.start));
            // What was before does not change: the next ball meets a body that this one has pushed.
            trace = run(body, &anatomy, &physique, &script, &options, &pushes);
        }
        balls.push(ball);
    }
    check(&trace)?;
    let acted = pushes.iter().zip(&trace.pushes);
    let pushes: Vec<KnownPush> = acted.map(|((push, _), acted)| KnownPush { force: acted.force, ..*push }).collect();
    let scale = (physique.com_height / 0.96).sqrt();
    let count = ((whole(scenario, trace.dt) / trace.dt).round() as usize + 1).min(trace.ticks.len());
    let ticks = &trace.ticks[..count];
    let terrain = Terrain::new(&scenario.ground);
    let taken_up = carried.iter().filter_map(Carried::begins).fold(f64::INFINITY, f64::min);
    let still_until = match &over {
        Some(Over::Walk(_)) => pushes.iter().map(|push| push.start).fold(whole(scenario, trace.dt), f64::min),
        _ => pushes::still_until(scenario, &pushes, taken_up),
    };
    // What the end cuts off is flown as far as it goes; who falls does not land.
    let aloft = trace.aloft.filter(|_| trace.lost.is_none());
    let steps: Vec<Step> = trace.steps.iter().copied().chain(aloft).collect();
    let cop: Vec<DVec2> = ticks.iter().map(|tick| tick.cop).collect();
    let steps = footing::sooner(&steps, &physique, &cop, trace.dt, scale);
    let (start, mut steps) = footing::grounded(body, &terrain, &trace.start, &steps);
    if terrain.is_flat() || scenario.ground.surface().is_some() {
        footing::roomier(body, &terrain, &start, &mut steps, &physique);
    }
    let facing = ticks.last().map_or(0.0, |tick| tick.facing);
    let busy = pushes.iter().map(|push| push.end).fold(0.0, f64::max);
    let end = (count - 1) as f64 * trace.dt;
    let home = match &mut over {
        Some(Over::Stand(stood)) if trace.lost.is_none() && trace.aloft.is_none() => {
            stood.come_home(&start, &mut steps, facing, body)
        }
        Some(Over::Walk(walked)) => {
            walked.plan(&mut steps, (still_until, busy, end), body);
            true
        }
        _ => false,
    };
    let bases = footing::bases(body, &terrain, &start, &steps, trace.dt, count);
    let grades = if over.is_none() { slant::grades(ticks, trace.dt) } else { vec![0.0; count] };
    let height = |index: usize| {
        let standing = script.physiques.get(index).unwrap_or(&physique).com_height;
        standing + bases[index] - ticks[index].crouched
    };
    let path = ticks.iter().enumerate().map(|(index, tick)| DVec3::new(tick.com.x, height(index), tick.com.z));
    let mut com: Vec<DVec3> = path.collect();
    let blows = Blow::of(body, &anatomy, &physique, &pushes);
    let walks = matches!(over, Some(Over::Walk(_)));
    let mut upper = upper_body(ticks, trace.dt, (&physique, &script.physiques), &blows, (seed, walks), scenario);
    if over.is_none() {
        let deepest = ticks.iter().map(|tick| tick.crouched).fold(0.0, f64::max);
        let stoop = Stoop::new(body, &anatomy, &physique, deepest);
        upper.iter_mut().zip(ticks).for_each(|(angles, tick)| stoop.add(tick.crouched, angles));
        slant::lean(&mut upper, &grades);
    }
    let landed = steps.iter().map(|step| step.land).fold(busy, f64::max);
    let left: Vec<f64> = (0..count)
        .map(|index| over.as_ref().filter(|_| home).map_or(1.0, |over| over.left(index as f64 * trace.dt, landed, end)))
        .collect();
    if let Some(over) = &over {
        over.lay(&mut com, &mut upper, &left, trace.dt, (&start, &steps, facing));
    }
    let curves = feet::FootCurves::new(body, &physique, &start, &steps, still_until, scale, &terrain);
    let mut timeline = Timeline {
        body: body.clone(),
        anatomy,
        dt: trace.dt,
        still_until: if walks { 0.0 } else { still_until },
        surprises: pushes.iter().map(|push| push.start).collect(),
        com,
        shift: vec![DVec3::ZERO; count],
        lowering: vec![0.0; count],
        walking: walking(ticks, trace.dt, scale),
        bends: Default::default(),
        swivels: Default::default(),
        pelvis: [Vec::new(), Vec::new()],
        upper,
        feet: match &over {
            Some(Over::Stand(stood)) => curves.over(stood.feet_and_balls()),
            Some(Over::Walk(walked)) => curves.over_walk(body, walked.as_ref().clone()),
            None => curves,
        },
        over,
        played: None,
        terrain,
        carried,
        loads,
    };
    let plants: Vec<Plant> = start.iter().copied().chain(steps.iter().map(|step| step.to)).collect();
    let uneven = converge::heels_may_rise(&timeline, ticks, &plants);
    let (care, zmp_before_pass) = converge::converge(&mut timeline, (&cop, &pushes), scale, uneven);
    // The swinging legs' mass moves the hips: the bends stay, so that this lowering is the one that they need.
    converge::settle(&mut timeline, scale, &care);
    if home {
        // Both ends are the base clip's, the last where the walk is back in it.
        let back = !matches!(&timeline.over, Some(Over::Walk(walked)) if !walked.ends_in_clip(end));
        let held = |index: usize| {
            let time = index as f64 * trace.dt;
            if walks {
                smooth3(time / ENDS) * if back { smooth3((end - time) / ENDS) } else { 1.0 }
            } else {
                left[index]
            }
        };
        timeline.lowering.iter_mut().enumerate().for_each(|(index, lowering)| *lowering *= held(index));
        if walks {
            let turned = timeline.pelvis.iter_mut().flat_map(|series| series.iter_mut().enumerate());
            turned.for_each(|(index, turn)| *turn *= held(index));
        }
    }
    let mut lost = trace.lost;
    if lost.is_some()
        && let Some(held) = held_until(&timeline)
    {
        // Who falls leaves the ground under some foot before the pendulum gives up: the clip ends while its contacts hold.
        timeline.cut(held);
        lost = Some(timeline.stands());
    }
    let contacts = timeline.feet.contacts(timeline.stands());
    Ok(Performance {
        timeline,
        trace,
        lost,
        contacts,
        pushes,
        balls,
        physique,
        style,
        zmp_before_pass,
        articulated: None,
    })
}

/// The last entry before a planted foot is out of its leg's reach; `None` where all are reached.
fn held_until(timeline: &Timeline) -> Option<usize> {
    let out = |(index, solved): (usize, &Solved)| {
        let time = index as f64 * timeline.dt;
        Side::BOTH
            .iter()
            .any(|side| timeline.feet.freedom(*side, time) == 0.0 && solved.short[*side as usize] > OUT_OF_REACH)
    };
    timeline.solve_all().iter().enumerate().position(out).map(|index| index.saturating_sub(1).max(4))
}

/// m, a planted foot that is farther than this from where it stands does not hold.
const OUT_OF_REACH: f64 = 5e-4;

fn run(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    script: &Script,
    options: &SimulateOptions,
    pushes: &[(KnownPush, bool)],
) -> Trace {
    let standing = Solver::new(body, anatomy).solve(&stand::natural_stand(body, physique));
    let positions = standing.pose.positions(body);
    // What is carried lifts the centre of mass.
    let height = |time: f64| {
        let tick = (time / options.dt).round() as usize;
        script.physiques.get(tick).or(script.physiques.last()).unwrap_or(physique).com_height
    };
    let pushes: Vec<SessionPush> = pushes
        .iter()
        .map(|(push, turns)| SessionPush {
            start: push.start,
            duration: push.end - push.start,
            force: push.force,
            turns: *turns,
            arm: match push.at {
                PushPoint::Joint(joint) => positions[joint].y - height(push.start),
                PushPoint::Segment(joint, offset) => {
                    (positions[joint] + standing.pose.turns[joint] * offset).y - height(push.start)
                }
                _ => 0.0,
            },
        })
        .collect();
    simulate(physique, &Script { pushes, ..script.clone() }, options)
}

/// How much each tick is a walk, 0..1: the gait is in charge, with a soft edge.
fn walking(ticks: &[TickState], dt: f64, scale: f64) -> Vec<f64> {
    let edge = (0.3 * scale / dt).round().max(1.0);
    let mut share: Vec<f64> = ticks.iter().map(|tick| f64::from(u8::from(tick.gait != Phase::Rest))).collect();
    for index in 1..share.len() {
        share[index] = share[index].min(share[index - 1] + 1.0 / edge);
    }
    for index in (1..share.len()).rev() {
        share[index - 1] = share[index - 1].min(share[index] + 1.0 / edge);
    }
    share.into_iter().map(smooth3).collect()
}

pub(super) fn check(trace: &Trace) -> Result<(), BakeError> {
    for (index, tick) in trace.ticks.iter().enumerate() {
        let time = index as f64 * trace.dt;
        if !tick.com.is_finite() {
            return Err(BakeError::BrokeDown { time, what: "the centre of mass is not a finite number".into() });
        }
        if !tick.feet.iter().all(|foot| foot.ankle.is_finite()) {
            return Err(BakeError::BrokeDown { time, what: "a foot is not at a finite number".into() });
        }
    }
    Ok(())
}

fn upper_body(
    ticks: &[TickState],
    dt: f64,
    (physique, loaded): (&Physique, &[Physique]),
    blows: &[Blow],
    (seed, over_a_walk): (u64, bool),
    scenario: &Scenario,
) -> Vec<UpperAngles> {
    let personality = Personality::drawn(seed);
    let unhurried = style(scenario).unhurried();
    let mut reaction = Reaction::new(physique, personality, scenario.character.style.arms).unhurried(unhurried);
    if over_a_walk {
        reaction = reaction.over_a_walk();
    }
    let sway = {
        let aside = blows.iter().flat_map(|blow| [blow.force.x, blow.beside.x]).find(|aside| aside.abs() > 1e-6);
        let side = aside.map_or(1.0, f64::signum);
        let seconds = (ticks.len() - 1) as f64 * dt;
        Sway::new(seed, scenario.character.breathing, side, seconds, (physique.com_height / 0.96).sqrt())
    };
    let script = Script::of(scenario, Vec::new());
    let mut angles = Vec::with_capacity(ticks.len());
    for (index, tick) in ticks.iter().enumerate() {
        reaction.weigh(loaded.get(index).unwrap_or(physique).mass);
        let time = index as f64 * dt;
        let senses = tick.senses(script.intent(time).stand != Feet::Both);
        let reacts = reaction.tick_struck(&senses, &struck(blows, tick.facing, time, dt), dt);
        let sways = sway.at(time, reaction.calm());
        angles.push(std::array::from_fn(|entry| reacts[entry] + sways[entry]));
    }
    angles
}

/// The stepper's dials from the scenario's.
pub(super) fn style(scenario: &Scenario) -> Style {
    let character = &scenario.character;
    Style {
        variant: scenario.stepper,
        agility: character.agility,
        step_height: character.style.step_height,
        stance_width: character.style.stance_width,
        readiness: character.style.readiness,
        recovery_time: character.style.recovery_time,
        ..Style::default()
    }
}
