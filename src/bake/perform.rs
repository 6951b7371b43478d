//! A scenario on a body, without a rig: the run, its feet and upper body, and the passes that make it one motion.
//!
//! stepper run -> foot curves and upper-body springs -> poses -> reach envelope and balance filter, a few times over.
//! Scenario space, SI. What comes out is a [`Timeline`] that gives the pose at any time; keys are made elsewhere.

use super::base::{Base, Over, over::whole};
use super::carried::Carried;
use super::cast::Cast;
use super::contacts::FootContact;
use super::key_times::within;
use super::ragdoll::{self, Drive};
use super::throws::Ball;
use super::timeline::Timeline;
use super::{BakeError, BakeOptions, converge, feet, footing, played, pushes, slant};
use crate::maths::curve::smooth3;
use crate::measure::KnownPush;
use crate::model::scenario::{Feet, Scenario};
use crate::model::{Body, Side, Terrain};
use crate::sim::{Ahead, Script, TickState, Trace};
use crate::stepper::{Phase, Physique, Plant, Step, Style};
use crate::whole_body::reaction::{Personality, Reaction, UpperAngles};
use crate::whole_body::solve::Solved;
use crate::whole_body::stoop::Stoop;
use crate::whole_body::struck::{Blow, struck};
use crate::whole_body::sway::Sway;
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

impl Performance {
    /// s, where balance is lost in a clip of that duration (s).
    pub fn lost_within(&self, duration: f64) -> Option<f64> {
        self.lost.filter(|lost| within(*lost, duration))
    }
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
    let mut cast = Cast::new(body, scenario, base)?;
    let mut pushes = pushes::known(body, scenario);
    let mut trace = cast.first_run(&pushes);
    let balls = cast.throw(seed, &mut pushes, &mut trace);
    check(&trace)?;
    let acted = pushes.iter().zip(&trace.pushes);
    let pushes: Vec<KnownPush> = acted.map(|((push, _), acted)| KnownPush { force: acted.force, ..*push }).collect();
    let (physique, style) = (cast.physique, cast.options.style);
    let footwork = Footwork::new(&mut cast, &trace, &pushes);
    let ticks = &trace.ticks[..footwork.count];
    let (mut timeline, left) = staged(cast, &footwork, (ticks, trace.dt), &pushes, seed);
    let uneven = converge::heels_may_rise(&timeline, ticks, &footwork.plants());
    let (care, zmp_before_pass) = converge::converge(&mut timeline, (&footwork.cop, &pushes), footwork.scale, uneven);
    // The swinging legs' mass moves the hips: the bends stay, so that this lowering is the one that they need.
    converge::settle(&mut timeline, footwork.scale, &care);
    if footwork.home {
        give_back(&mut timeline, &left, footwork.end);
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

/// Where the feet of a run go on the real ground, and back to the base clip if there is one. Metres, seconds.
struct Footwork {
    start: [Plant; 2],
    steps: Vec<Step>,
    cop: Vec<DVec2>,
    terrain: Terrain,
    count: usize, // ticks
    scale: f64,   // times relative to the reference body
    facing: f64,  // rad, at the end
    still_until: f64,
    busy: f64, // until the last push is over
    end: f64,
    home: bool, // it ends as the base clip is
}

impl Footwork {
    fn new(cast: &mut Cast, trace: &Trace, pushes: &[KnownPush]) -> Footwork {
        let Cast { body, scenario, physique, carried, over, .. } = cast;
        let scale = (physique.com_height / 0.96).sqrt();
        let count = ((whole(scenario, trace.dt) / trace.dt).round() as usize + 1).min(trace.ticks.len());
        let ticks = &trace.ticks[..count];
        let terrain = Terrain::new(&scenario.ground);
        let taken_up = carried.iter().filter_map(Carried::begins).fold(f64::INFINITY, f64::min);
        let still_until = match &over {
            Some(Over::Walk(_)) => pushes.iter().map(|push| push.start).fold(whole(scenario, trace.dt), f64::min),
            _ => pushes::still_until(scenario, pushes, taken_up),
        };
        // What the end cuts off is flown as far as it goes; who falls does not land.
        let aloft = trace.aloft.filter(|_| trace.lost.is_none());
        let steps: Vec<Step> = trace.steps.iter().copied().chain(aloft).collect();
        let cop: Vec<DVec2> = ticks.iter().map(|tick| tick.cop).collect();
        let steps = footing::sooner(&steps, physique, &cop, trace.dt, scale);
        let (start, mut steps) = footing::grounded(body, &terrain, &trace.start, &steps);
        if terrain.is_flat() || scenario.ground.surface().is_some() {
            footing::roomier(body, &terrain, &start, &mut steps, physique);
        }
        let facing = ticks.last().map_or(0.0, |tick| tick.facing);
        let busy = pushes.iter().map(|push| push.end).fold(0.0, f64::max);
        let end = (count - 1) as f64 * trace.dt;
        let home = match over {
            Some(Over::Stand(stood)) if trace.lost.is_none() && trace.aloft.is_none() => {
                stood.come_home(&start, &mut steps, facing, body)
            }
            Some(Over::Walk(walked)) => {
                walked.plan(&mut steps, (still_until, busy, end), body);
                true
            }
            _ => false,
        };
        Footwork { start, steps, cop, terrain, count, scale, facing, still_until, busy, end, home }
    }

    fn plants(&self) -> Vec<Plant> {
        self.start.iter().copied().chain(self.steps.iter().map(|step| step.to)).collect()
    }
}

/// The run as curves that poses follow, before any pass; and how far it is from its base clip at each tick, from 0 to 1.
fn staged(
    cast: Cast,
    footwork: &Footwork,
    (ticks, dt): (&[TickState], f64),
    pushes: &[KnownPush],
    seed: u64,
) -> (Timeline, Vec<f64>) {
    let Footwork { start, steps, terrain, count, scale, facing, still_until, busy, end, home, .. } = footwork;
    let bases = footing::bases(cast.body, terrain, start, steps, dt, *count);
    let path = ticks.iter().enumerate().map(|(index, tick)| {
        let height = cast.physique_at(index).com_height + bases[index] - tick.crouched;
        DVec3::new(tick.com.x, height, tick.com.z)
    });
    let mut com: Vec<DVec3> = path.collect();
    let walks = matches!(cast.over, Some(Over::Walk(_)));
    let mut upper = upper_body(&cast, (ticks, dt), pushes, (seed, walks));
    let landed = steps.iter().map(|step| step.land).fold(*busy, f64::max);
    let left = |over: &Over, index: usize| over.left(index as f64 * dt, landed, *end);
    let left: Vec<f64> =
        (0..*count).map(|index| cast.over.as_ref().filter(|_| *home).map_or(1.0, |over| left(over, index))).collect();
    if let Some(over) = &cast.over {
        over.lay(&mut com, &mut upper, &left, dt, (start, steps, *facing));
    }
    let curves = feet::FootCurves::new(cast.body, &cast.physique, start, steps, *still_until, *scale, terrain);
    let timeline = Timeline {
        body: cast.body.clone(),
        anatomy: cast.anatomy,
        dt,
        still_until: if walks { 0.0 } else { *still_until },
        surprises: pushes.iter().map(|push| push.start).collect(),
        com,
        shift: vec![DVec3::ZERO; *count],
        lowering: vec![0.0; *count],
        walking: walking(ticks, dt, *scale),
        bends: Default::default(),
        swivels: Default::default(),
        pelvis: [Vec::new(), Vec::new()],
        upper,
        feet: match &cast.over {
            Some(Over::Stand(stood)) => curves.over(stood.feet_and_balls()),
            Some(Over::Walk(walked)) => curves.over_walk(cast.body, walked.as_ref().clone()),
            None => curves,
        },
        over: cast.over,
        played: None,
        terrain: terrain.clone(),
        carried: cast.carried,
        loads: cast.loads,
    };
    (timeline, left)
}

/// Both ends are the base clip's, the last where the walk is back in it.
fn give_back(timeline: &mut Timeline, left: &[f64], end: f64) {
    let dt = timeline.dt;
    let walks = matches!(timeline.over, Some(Over::Walk(_)));
    let back = !matches!(&timeline.over, Some(Over::Walk(walked)) if !walked.ends_in_clip(end));
    let held = |index: usize| {
        let time = index as f64 * dt;
        if walks { smooth3(time / ENDS) * if back { smooth3((end - time) / ENDS) } else { 1.0 } } else { left[index] }
    };
    timeline.lowering.iter_mut().enumerate().for_each(|(index, lowering)| *lowering *= held(index));
    if walks {
        let turned = timeline.pelvis.iter_mut().flat_map(|series| series.iter_mut().enumerate());
        turned.for_each(|(index, turn)| *turn *= held(index));
    }
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

/// What trunk, head and arms do: as the run shakes them, over crouches and up slopes too.
fn upper_body(
    cast: &Cast,
    (ticks, dt): (&[TickState], f64),
    pushes: &[KnownPush],
    (seed, over_a_walk): (u64, bool),
) -> Vec<UpperAngles> {
    let Cast { body, anatomy, scenario, physique, .. } = cast;
    let blows = Blow::of(body, anatomy, physique, pushes);
    let mut angles = reactions(cast, (ticks, dt), &blows, (seed, over_a_walk), scenario);
    if cast.over.is_none() {
        let deepest = ticks.iter().map(|tick| tick.crouched).fold(0.0, f64::max);
        let stoop = Stoop::new(body, anatomy, physique, deepest);
        angles.iter_mut().zip(ticks).for_each(|(angles, tick)| stoop.add(tick.crouched, angles));
        slant::lean(&mut angles, &slant::grades(ticks, dt));
    }
    angles
}

fn reactions(
    cast: &Cast,
    (ticks, dt): (&[TickState], f64),
    blows: &[Blow],
    (seed, over_a_walk): (u64, bool),
    scenario: &Scenario,
) -> Vec<UpperAngles> {
    let physique = &cast.physique;
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
        reaction.weigh(cast.physique_at(index).mass);
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
