//! Whether a run of the articulated body did what it was told: who does not is told, and `auto` keeps the stepper. Scenario space, SI.

use super::Performance;
use super::ragdoll::{Stroll, stroll};
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::scenario::{Crouch, Feet, GroundKind, Scenario, Stepper};
use crate::model::{Side, Terrain};
use crate::sim::{FASTEST, Script};
use glam::{DVec2, DVec3};

/// s at legs of 0.83 m, by when a foot must be up that is not to be stood on: the weight goes over the other one in about one.
const LIFTS: f64 = 2.5;
/// s at such legs, by when a turn is done: by 180 degrees in 4.
const TURNS: f64 = 4.5;
/// rad, how far from where it is told to face it may end: 20 degrees, which is seen.
const OFF: f64 = 0.35;

/// Share of the leg by which a crouch may be less than asked.
const CROUCHES: f64 = 0.03;

/// What it never did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shirked {
    /// It never set off.
    Walk,
    /// It never lifted the foot that it was not to stand on.
    Stand,
    /// It did not turn to where it was told to.
    Turn,
}

impl Shirked {
    /// What it did not do, for a person.
    pub fn told(self) -> &'static str {
        match self {
            Shirked::Walk => "set off",
            Shirked::Stand => "lift its foot",
            Shirked::Turn => "turn to where it is told",
        }
    }
}

/// Is it asked to walk then (s)?
pub fn goes_at(scenario: &Scenario, time: f64) -> bool {
    Script::of(scenario, Vec::new()).intent(time).walk.is_some_and(|walk| walk.length() > 0.0)
}

/// What of the lanes of a scenario it never did, as far as it kept its balance.
pub fn shirked(scenario: &Scenario, performance: &Performance) -> Option<Shirked> {
    if stroll(scenario, performance) == Stroll::Never {
        return Some(Shirked::Walk);
    }
    let trace = &performance.trace;
    let script = Script::of(scenario, Vec::new());
    let until = performance.lost.unwrap_or(f64::INFINITY).min(scenario.duration);
    let tempo = (performance.timeline.body.leg_length / 0.83).sqrt();
    let (mut on_one, mut facing, mut faces, mut off): (f64, f64, f64, f64) = (0.0, 0.0, 0.0, 0.0);
    for (index, tick) in trace.ticks.iter().enumerate() {
        let time = index as f64 * trace.dt;
        if time > until {
            break;
        }
        let intent = script.intent(time);
        let walks = intent.walk.is_some_and(|walk| walk.length() > 0.0);
        let up = match intent.stand {
            Feet::Both => None,
            Feet::Left => Some(Side::Right),
            Feet::Right => Some(Side::Left),
        };
        let stands = up.is_some_and(|side| tick.planted[side as usize]) && !walks;
        on_one = if stands { on_one + trace.dt } else { 0.0 };
        if on_one > LIFTS * tempo {
            return Some(Shirked::Stand);
        }
        let same = wrap_angle(intent.facing - facing).abs() < 1e-6 && !walks;
        (facing, faces) = (intent.facing, if same { faces + trace.dt } else { 0.0 });
        off = wrap_angle(tick.facing - intent.facing).abs();
    }
    let turned = !scenario.turn.is_empty() && faces > TURNS * tempo && off > OFF;
    turned.then_some(Shirked::Turn)
}

/// What is not as asked of an articulated body's run, for a person.
pub(super) fn strayed(scenario: &Scenario, performance: &Performance) -> Option<String> {
    if let Some(shirked) = shirked(scenario, performance) {
        return Some(format!("the ragdoll does not {} on this rig: `--drive stepper` does", shirked.told()));
    }
    let leg = performance.timeline.body.leg_length;
    let most = FASTEST * (leg / 0.83).sqrt();
    let asked = scenario.walk.iter().map(|walk| walk.speed).fold(0.0, f64::max);
    match stroll(scenario, performance) {
        _ if asked > most + 0.005 => {
            Some(format!("on legs of {leg:.2} m the ragdoll walks at most {most:.2} m/s, not {asked:.2}"))
        }
        Stroll::Slower(..) if stopped(scenario, performance).is_some() => None,
        Stroll::Slower(got, wanted) => Some(format!("the ragdoll walks at {got:.2} m/s, not {wanted:.2}")),
        Stroll::AsTold | Stroll::Never => too_high(scenario, performance),
    }
}

/// What is set of `[stepper]` and changes nothing of an articulated body's run, for a person: nobody leads it, and its own law, which
/// catches it, has no such dials.
pub(super) fn unheeded(scenario: &Scenario) -> Option<String> {
    let led = scenario.walk.iter().any(|walk| walk.speed > 0.0)
        || !scenario.turn.is_empty()
        || scenario.stand.iter().any(|stand| stand.on != Feet::Both);
    let (set, usual) = (scenario.stepper, Stepper::default());
    let keys = [
        ("ankle_feedback", set.ankle_feedback != usual.ankle_feedback),
        ("leg_change", set.leg_change != usual.leg_change),
        ("support", set.support != usual.support),
        ("length_bias", set.length_bias != usual.length_bias),
        ("pull_bias", set.pull_bias != usual.pull_bias),
    ];
    let keys: Vec<&str> = keys.into_iter().filter_map(|(key, is)| is.then_some(key)).collect();
    (!led && !keys.is_empty()).then(|| {
        format!(
            "[stepper] {} changes nothing here: the ragdoll catches a shove by a law of its own; `--drive stepper` follows it",
            keys.join(", ")
        )
    })
}

/// s: a way that is barred for so long before a walk ends was not free any more.
const BARRED: f64 = 0.5;

/// Where a walk ends early since something of the ground is in its way that no step crosses, for a person.
pub(super) fn stopped(scenario: &Scenario, performance: &Performance) -> Option<String> {
    let trace = &performance.trace;
    let script = Script::of(scenario, Vec::new());
    let walks = |time: f64| script.intent(time).walk.is_some_and(|walk| walk.length() > 0.0);
    let time = |index: usize| index as f64 * trace.dt;
    let until = trace.ticks.iter().enumerate().take_while(|(index, _)| time(*index) <= scenario.duration);
    let asked: Vec<usize> = until.filter(|(index, _)| walks(time(*index))).map(|(index, _)| index).collect();
    let from = *asked.iter().rev().take_while(|index| trace.ticks[**index].barred).last()?;
    let com = trace.ticks[from].com;
    (time(*asked.last()?) - time(from) >= BARRED).then(|| {
        let why = over_the_ceiling(scenario, DVec2::new(com.x, com.z)).map_or_else(
            || "a wall, a drop, or a step that is too high for the legs is in its way".to_owned(),
            |ceiling| format!("the ground goes on over the ceiling of {ceiling} m: raise [ground] ceiling"),
        );
        format!("the walk stops at {:.1} s, at ({:.1}, {:.1}) m of (x, z): {why}", time(from), com.x, com.z)
    })
}

/// m: so near to where a walk stopped ground that ends at the ceiling is what stopped it; ground that goes on over it is no higher than a step.
const BEFORE: f64 = 1.5;
const STEP: f64 = 0.3;
/// Directions and rings in which it is looked for.
const AROUND: [u32; 2] = [16, 8];

/// m, the ceiling of a mesh, if ground near a place ends only since it goes on over that.
fn over_the_ceiling(scenario: &Scenario, place: DVec2) -> Option<f64> {
    let GroundKind::Mesh { surface: Some(surface), .. } = &scenario.ground.kind else { return None };
    let ceiling = scenario.ground.kind.ceiling();
    let terrain = Terrain::new(&scenario.ground);
    let [directions, rings] = AROUND;
    let mut places = (0..directions * rings).map(|index| {
        let (sine, cosine) =
            real::sin_cos(std::f64::consts::TAU * f64::from(index % directions) / f64::from(directions));
        place + DVec2::new(sine, cosine) * (BEFORE * f64::from(1 + index / directions) / f64::from(rings))
    });
    let ends = |at: DVec2| {
        let higher = |(height, _): (f64, DVec3)| height > ceiling && height < ceiling + STEP;
        let under = terrain.spot(at);
        (!under.holds || under.height < ceiling - STEP) && surface.ground(at, ceiling + STEP).is_some_and(higher)
    };
    // A wall's top may be over the ceiling too: ground that goes on begins under it.
    let near = terrain.spot(place).height > ceiling - BEFORE;
    (near && places.any(ends)).then_some(ceiling)
}

/// Who walks goes no lower than his ankles allow, and nobody as low as he is told off level ground.
fn too_high(scenario: &Scenario, performance: &Performance) -> Option<String> {
    let [lowest, asked] = crouched(scenario, performance);
    (lowest < asked - CROUCHES)
        .then(|| format!("the legs of the ragdoll let it crouch by {lowest:.2} at most here, not {asked:.2}"))
}

/// s, a crouch that is shorter, or begins so soon before the clip's end, may end before it is as low as it is to be.
const GOES_DOWN: f64 = 2.0;

/// Shares of the leg by which it is lower than in the stand, at the most, and by which it was to be where it had time for it. None where it
/// stands on level ground.
fn crouched(scenario: &Scenario, performance: &Performance) -> [f64; 2] {
    if scenario.ground.kind == GroundKind::Flat && scenario.walk.iter().all(|walk| walk.speed <= 0.0) {
        return [0.0; 2];
    }
    let lowest = performance.trace.ticks.iter().map(|tick| tick.crouched).fold(0.0, f64::max);
    let lasts = |crouch: &&Crouch| {
        let until = crouch.duration.map_or(f64::INFINITY, |duration| crouch.start + duration);
        until.min(scenario.duration) - crouch.start >= GOES_DOWN
    };
    let asked = scenario.crouch.iter().filter(lasts).map(|crouch| crouch.amount);
    let asked = asked.fold(scenario.character.crouch, f64::max);
    [lowest / performance.timeline.body.leg_length, asked]
}

/// How much of the speed and of the depth of what it is told an articulated body comes to, 0 to 1: the lesser of both.
pub(super) fn obeyed(scenario: &Scenario, performance: &Performance) -> f64 {
    let speed = match stroll(scenario, performance) {
        Stroll::Slower(got, wanted) => got / wanted,
        Stroll::AsTold | Stroll::Never => 1.0,
    };
    let [lowest, asked] = crouched(scenario, performance);
    let depth = if lowest < asked - CROUCHES { lowest / asked } else { 1.0 };
    speed.min(depth).clamp(0.0, 1.0)
}
