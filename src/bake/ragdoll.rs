//! The articulated body at the wheel: which scenarios it can play, and how much help it gets.
//!
//! Its run leaves the stepper's kind of trace, and the links' poses; [`super::played`] makes them a clip. Scenario space, SI.

use super::base::Stood;
use super::carried::{self, Carried};
use super::throws::{Ball, Hit, Toss};
use super::{BakeError, Performance};
use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::{Push, Scenario};
use crate::model::{Body, BodyPose, Load, Physique, Terrain};
use crate::ragdoll::control::Assist;
use crate::sim::{Ahead, Articulated, ArticulatedOptions, Ease, Incoming, Script, Things, simulate_with};
use crate::stepper::Phase;
use crate::whole_body::{Anatomy, Solver, stand};
use glam::DVec3;

/// Who moves the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drive {
    /// The pendulum; the pose follows it.
    #[default]
    Stepper,
    /// Joint torques and contacts.
    Ragdoll(Helped),
    /// The better of the two ([`super::auto`]), the ragdoll helped like that.
    Auto(Helped),
}

/// How much help the pelvis may get.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Helped {
    /// At most that.
    Within(Assist),
    /// As little as recovers, at most 300 N m and 300 N; none where no help does.
    Auto,
}

/// A run and the bound that it had.
#[derive(Clone, Debug)]
pub struct Driven {
    /// The run.
    pub run: Articulated,
    /// The bound of its help.
    pub bound: Assist,
    /// Why it was given that help and not less, for a person, where there is more to say than that less does not recover.
    pub why: Option<String>,
}

/// Bounds that `Auto` tries, N m and N, the least first.
const TRIES: [[f64; 2]; 8] =
    [[0.0, 0.0], [25.0, 0.0], [50.0, 0.0], [100.0, 0.0], [150.0, 0.0], [200.0, 50.0], [300.0, 150.0], [300.0, 300.0]];

/// The bounds that `Auto` tries on a body of that mass (kg), the least first.
pub(super) fn rungs(mass: f64) -> impl Iterator<Item = Assist> {
    let scale = mass / HEAVY;
    TRIES.into_iter().map(move |[torque, force]| Assist { torque: torque * scale, force: force * scale })
}

/// kg, of whom [`TRIES`] are.
const HEAVY: f64 = 89.5;

#[expect(clippy::too_many_arguments, reason = "all that a run depends on")]
/// Runs the articulated body, with as much help as is asked or allowed.
pub(super) fn run(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    scenario: &Scenario,
    options: &ArticulatedOptions,
    pushes: &[(KnownPush, bool)],
    tosses: &[Toss],
    (carried, loads): (&[Carried], &[Load]),
    helped: Helped,
    stood: Option<&Stood>,
) -> Result<Driven, BakeError> {
    let terrain = Terrain::new(&scenario.ground);
    let standing = Solver::new(body, anatomy).solve(&stand::natural_stand(body, physique)).pose;
    let positions = standing.positions(body);
    let ways: Vec<_> = tosses.iter().map(|toss| |aim: DVec3, facing: f64| toss.way(aim, facing)).collect();
    let incoming: Vec<Incoming> = tosses
        .iter()
        .zip(&ways)
        .map(|(toss, way)| {
            let (joint, aim) = toss.aimed(body, &standing);
            let at = (joint, aim - positions[joint]);
            Incoming { arrives: toss.arrives, radius: toss.radius(), mass: toss.mass(), at, way }
        })
        .collect();
    let hold = |time: f64| carried::hold(carried, loads, time);
    let script = Script::of(scenario, Vec::new());
    let lanes = [scenario.walk.len(), scenario.turn.len(), scenario.crouch.len(), scenario.stand.len()];
    let led = lanes != [0; 4] || scenario.character.crouch > 0.0;
    let intent = |time: f64| led.then(|| script.intent(time));
    let flat = stood.map(|stood| stood.on_soles(body, anatomy));
    let goal = |time: f64| {
        let Some((stood, (_, moved))) = stood.zip(flat.as_ref()) else { return (standing.clone(), DVec3::ZERO) };
        let frame = stood.base.at(time);
        (BodyPose { hips: frame.pose.hips + *moved, ..frame.pose }, frame.com)
    };
    let ease = stood.zip(flat.as_ref()).map(|(stood, (stand, _))| Ease {
        stand: stand.clone(),
        plants: stood.feet.map(|foot| foot.plant),
        natural: standing.clone(),
        goal: &goal,
    });
    let things = Things { incoming: &incoming, loads, hold: &hold, intent: &intent, ease };
    let once = |bound: Assist, effort: u8| -> Result<Driven, BakeError> {
        let options = ArticulatedOptions { ahead: Ahead { effort, ..options.ahead }, ..*options };
        let run = simulate_with(body, anatomy, physique, &terrain, &options, pushes, bound, &things)
            .map_err(|broken| BakeError::Overdone { time: broken.time, what: broken.what, mass: physique.mass })?;
        Ok(Driven { run, bound, why: None })
    };
    let scale = physique.mass / HEAVY;
    if let Helped::Within(bound) = helped {
        return once(bound, options.ahead.effort);
    }
    let mut least = None;
    for bound in rungs(physique.mass) {
        // Help is for where looking ahead finds nothing.
        let effort = if bound.torque > 0.0 { 0 } else { options.ahead.effort };
        let driven = once(bound, effort)?;
        if driven.run.trace.lost.is_none() {
            return Ok(driven);
        }
        least.get_or_insert(driven);
    }
    // Help that does not keep it up only bends the fall.
    let mut driven =
        least.ok_or(BakeError::BrokeDown { time: 0.0, what: "the articulated body did not move".into() })?;
    let [torque, force] = TRIES[TRIES.len() - 1];
    driven.why = Some(format!("up to {:.0} Nm and {:.0} N do not keep it up", torque * scale, force * scale));
    Ok(driven)
}

/// How a walk that was asked for went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stroll {
    /// As it was asked, or none was.
    AsTold,
    /// It never set off.
    Never,
    /// m/s, in the mean once it had had time to get there; and what was asked then.
    Slower(f64, f64),
}

/// What became of the walks of a scenario, as far as the body kept its balance.
pub fn stroll(scenario: &Scenario, performance: &Performance) -> Stroll {
    let trace = &performance.trace;
    let script = Script::of(scenario, Vec::new());
    let until = performance.lost.unwrap_or(f64::INFINITY).min(scenario.duration);
    let tempo = (performance.timeline.body.leg_length / 0.83).sqrt();
    let shoves = |time: f64| {
        let acts = |push: &Push| (push.start..push.start + push.duration).contains(&time);
        scenario.push.iter().any(|push| push.duration < SHOVES && acts(push))
    };
    let (mut since, mut even, mut wanted, mut got, mut settled) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut longest, mut goes): (f64, bool) = (0.0, false);
    for (index, tick) in trace.ticks.iter().enumerate() {
        let time = index as f64 * trace.dt;
        if time > until {
            break;
        }
        let order = script.intent(time).walk.unwrap_or_default();
        since = if order.length() > SLOWEST { since + trace.dt } else { 0.0 };
        even = if since > 0.0 && !shoves(time) { even + trace.dt } else { 0.0 };
        longest = longest.max(since);
        goes |= matches!(tick.gait, Phase::Double | Phase::Single);
        if even > GATHERS * tempo {
            settled += 1.0;
            wanted += order.length();
            got += glam::DVec2::new(tick.velocity.x, tick.velocity.z).dot(order.normalize_or_zero());
        }
    }
    if longest > SETS_OFF * tempo && !goes {
        return Stroll::Never;
    }
    match settled {
        0.0 => Stroll::AsTold,
        _ if got > 0.9 * wanted => Stroll::AsTold,
        _ => Stroll::Slower(got / settled, wanted / settled),
    }
}

/// m/s, slower is no walk.
const SLOWEST: f64 = 0.05;
/// s after a walk is asked for, for legs of 0.83 m: when it must have set off, and when it must be up to its speed, then and after a shove.
const SETS_OFF: f64 = 1.5;
/// As [`SETS_OFF`] says.
const GATHERS: f64 = 4.0;
/// s, a shove is shorter: what pushes for longer is walked against.
const SHOVES: f64 = 1.0;

impl Driven {
    /// Its balls as the report takes them, one for each hit and one for each that missed.
    pub fn balls(&self) -> Vec<Ball> {
        let mut balls = Vec::new();
        for flown in &self.run.balls {
            let Some((time, place, _)) = flown.way.first().copied() else { continue };
            let ball =
                Ball { radius: flown.radius, mass: flown.mass, time, place, velocity: flown.velocity, hit: None };
            if flown.hits.is_empty() {
                balls.push(ball);
            }
            balls.extend(flown.hits.iter().map(|hit| {
                let [start, end] = hit.span;
                let (joint, at) = hit.at;
                let push =
                    KnownPush { start, end, force: hit.impulse / (end - start), at: PushPoint::Segment(joint, at) };
                Ball { hit: Some(Hit { push, impulse: hit.impulse, joint, point: hit.point }), ..ball }
            }));
        }
        balls
    }
}
