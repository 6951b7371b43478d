//! What of a scenario the articulated body cannot play yet, by name: bounds within which seeded walks of several rigs keep their feet.

use super::base::Base;
use super::crossed::{Crossed, crossed};
use crate::maths::real;
use crate::model::scenario::{GroundKind, Scenario, Stepper, Walk};
use crate::model::{Body, BodyPose};
use crate::ragdoll::{Figure, Locks, crouch};
use crate::sim::FASTEST;
use crate::whole_body::{Anatomy, Solver, stand};

/// By which a tilt (rad), or a length, share or speed, may be over a bound for what it was rounded to.
const ROUNDED: f64 = 1e-9;
/// Share of the leg, on level ground and elsewhere: of 40 crouches to 0.5 on five bodies one took steps, at 0.47.
const LOWEST: [f64; 2] = [0.4 + ROUNDED, 0.2 + ROUNDED];
/// m/s, the fastest walk that faces elsewhere than it goes: faster ones were not looked at.
const BACKWARDS: f64 = 1.3 + ROUNDED;
/// The same beside other lanes; m/s at legs of usual length, Froude-equal at others: so fast are its walks, and those backwards and sideways.
const LOWEST_GOING: f64 = 0.3 + ROUNDED;
const CROUCHED: f64 = 1.0;
const CROUCHED_ASIDE: f64 = 0.3;
/// `leg_scale` from which on legs are so long that a crouch of a quarter of them takes steps, and does not always rise (1.3).
const LENGTHENED: f64 = 1.15;
/// rad: slopes are walked across, and turned on, to here; and up, by feet that do not bend, on whose balls nobody stands.
const STEEP: f64 = 12.0_f64.to_radians();
/// rad: and up to here; m/s at legs of usual length, Froude-equal at others: at such speeds over `STEEP`. Slower, one of 15 drawn walks falls;
/// up 20 to 25 degrees they keep their feet, but some legs of 0.7 and 1.3 go at half the speed.
const UP: (f64, [f64; 2]) = (20.0_f64.to_radians(), [0.3 - ROUNDED, 0.45 + ROUNDED]);
/// rad: to here one stands on one foot and crouches.
const STEEPER: f64 = 15.0_f64.to_radians();
/// rad: and walks backwards and sideways to here, m/s: no faster than so.
const ASIDE: (f64, f64) = (8.0_f64.to_radians(), 0.3);
/// rad: and down to here.
const STEEPEST: f64 = 25.0_f64.to_radians();
/// rad: less is as good as level.
const LEVEL: f64 = 2.0_f64.to_radians();
/// rad, of a slope; m/s: walks on it are slower than the first, on a steeper one than the second.
const TEN: f64 = 10.0_f64.to_radians();
const SLOWER: [f64; 2] = [0.8, 0.6];

/// rad, about either axis: a platform may tilt by as much; m/s: and be walked on as fast.
const TILTS: f64 = 12.0_f64.to_radians();
const ABOARD: f64 = 0.3;
/// rad: to here one turns, crouches and stands on one foot on it (60 of 60 drawn on five bodies stand at 18 degrees; of 20 walks one falls).
const TILTS_MORE: f64 = 18.0_f64.to_radians();

/// m: gaps so wide are walked over, and (at legs of usual length) so far from one to the next; m/s at such legs, Froude-equal at others: at
/// such speeds (of 74 seeded walks of 20 s six fell or stumbled, all of them faster); rad: so straight.
const WIDEST: f64 = 0.2 + ROUNDED;
const APART: f64 = 0.9 - ROUNDED;
const CROSSES: [f64; 2] = [0.4 - ROUNDED, 0.5 + ROUNDED];
const ASLANT: f64 = 2.0_f64.to_radians();

/// m: so high is a single step, up or down, that is walked over in the gait; m/s at legs of usual length, Froude-equal at others: and so
/// fast. On shortened legs a third of the walks up falls.
const KERB: f64 = 0.1 + ROUNDED;
const CLIMBS: [f64; 2] = [0.3 - ROUNDED, 0.4 + ROUNDED];

/// m/s at legs of usual length: so fast are walks without ankle feedback.
const BARE: f64 = 1.0;

/// m: so high are the steps of a flight that is gone one tread at a time: up, on feet that do not bend (on higher ones only their tips bear,
/// and a third falls), and up and down on others.
const CLIMBED: [f64; 2] = [0.1 + ROUNDED, 0.17 + ROUNDED];
/// m, from where to where its treads reach: of 100 walks drawn on treads of 0.28 to 0.34 m seven fall, all on treads under 0.30 m.
const TREADS: [f64; 2] = [0.3 - ROUNDED, 0.36 + ROUNDED];
/// Shortest and longest `leg_scale` on it: with 0.8 a third falls on high steps, with 1.3 some fall before the first.
const SCALED: [f64; 2] = [1.0 - ROUNDED, 1.15 + ROUNDED];
/// m/s at legs of usual length, Froude-equal at others: how fast it is walked up to.
const APPROACHES: [f64; 2] = [0.2 - ROUNDED, 0.35 + ROUNDED];

/// rad: so steep are meshes walked down, and so much may their ground bend within 15 cm (of 60 seeded walks over ramps of 4 to 15 degrees three
/// fall, where these bend by 13 to 15); m: so high are their steps (of 16 drawn to 0.1 m one, of 0.099 m, is not got over).
const MESH_DOWN: f64 = 15.0_f64.to_radians();
const BENDS: f64 = 10.0_f64.to_radians();
const MESH_KERB: f64 = 0.08 + ROUNDED;

const EDGED: [&str; 4] = [
    "[[walk]] on ground with edges",
    "[[turn]] on ground with edges",
    "[[crouch]] on ground with edges",
    "[[stand]] on ground with edges",
];
const MESHED: [&str; 4] = ["[[walk]] on a mesh", "[[turn]] on a mesh", "[[crouch]] on a mesh", "[[stand]] on a mesh"];
const TILTED: [&str; 4] = [
    "[[walk]] on a platform that tilts by more than 12 degrees",
    "[[turn]] on a platform that tilts by more than 18 degrees",
    "[[crouch]] on a platform that tilts by more than 18 degrees",
    "[[stand]] on a platform that tilts by more than 18 degrees",
];

/// What of a scenario the articulated body cannot play yet, over that clip if any, for a person; empty where it plays it all.
pub(super) fn unplayed(scenario: &Scenario, base: Option<&Base>) -> Vec<&'static str> {
    let mut parts = Parts::default();
    match scenario.ground.kind {
        GroundKind::Flat => {}
        GroundKind::Slope { angle } => on_slope(scenario, angle, &mut parts),
        GroundKind::Uneven { .. } => {
            let fast = scenario.walk.iter().any(|walk| walk.speed > SLOWER[1]);
            parts.add(fast, "[[walk]] at more than 0.6 m/s on uneven ground");
        }
        GroundKind::Platform { ref pitch, ref roll } => on_platform(scenario, [pitch, roll], &mut parts),
        GroundKind::Gaps { width, spacing } => on_gaps(scenario, [width, spacing], &mut parts),
        GroundKind::Stairs { rise, count: 1, .. } if rise.abs() <= KERB => on_kerb(scenario, &mut parts),
        GroundKind::Stairs { rise, tread, .. } => on_stairs(scenario, [rise, tread], &mut parts),
        GroundKind::Mesh { .. } => on_mesh(scenario, &mut parts),
    }
    let [walks, turns, stands] = [!scenario.walk.is_empty(), !scenario.turn.is_empty(), !scenario.stand.is_empty()];
    let crouches = lowest(scenario) > 0.0;
    parts.add(scenario.walk.iter().any(|walk| walk.speed > FASTEST), "[[walk]] at more than 1.5 m/s");
    let fast_aside = |walk: &Walk| aside(walk) && walk.speed > BACKWARDS;
    parts.add(scenario.walk.iter().any(fast_aside), "[[walk]] backwards or sideways at more than 1.3 m/s");
    on_crouch(scenario, &mut parts);
    let over = base.is_some() || scenario.base.is_some();
    let lanes = walks || turns || stands || crouches || !scenario.carry.is_empty();
    parts.add(over && lanes, "[base] beside [[walk]], [[turn]], [[crouch]], [[stand]] or [[carry]]");
    parts.add(over && scenario.ground.kind != GroundKind::Flat, "[base] on ground that is not flat");
    on_stepper(scenario, &mut parts);
    parts.0
}

/// How low it is meant to go, of its leg.
fn lowest(scenario: &Scenario) -> f64 {
    scenario.crouch.iter().map(|crouch| crouch.amount).fold(scenario.character.crouch, f64::max)
}

fn on_crouch(scenario: &Scenario, parts: &mut Parts) {
    let [low, low_at_first] = [lowest(scenario), scenario.character.crouch];
    if low <= 0.0 {
        return;
    }
    let level = scenario.ground.kind == GroundKind::Flat;
    let long = scenario.character.leg_scale > LENGTHENED;
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let lanes = [scenario.walk.is_empty(), scenario.turn.is_empty(), scenario.stand.is_empty()] != [true; 3];
    parts.add(low > LOWEST[0], "[[crouch]] by more than 0.4");
    parts.add(!level && low > LOWEST[1], "[[crouch]] by more than 0.2 on ground that is not flat");
    parts.add(level && long && low > LOWEST[1], "[[crouch]] by more than 0.2 on lengthened legs");
    parts.add(!level && low_at_first > 0.0, "[character] crouch on ground that is not flat");
    parts.add(!level && lanes, "[[crouch]] beside [[walk]], [[turn]] or [[stand]] on ground that is not flat");
    parts.add(lanes && low > LOWEST_GOING, "[[crouch]] by more than 0.3 beside [[walk]], [[turn]] or [[stand]]");
    let [fastest, aside_by] =
        [CROUCHED, CROUCHED_ASIDE].map(|speed| speed * scenario.character.leg_scale.sqrt() + ROUNDED);
    parts.add(walks(&|walk| walk.speed > fastest), "[[walk]] at more than 1 m/s beside [[crouch]]");
    parts.add(
        walks(&|walk| aside(walk) && walk.speed > aside_by),
        "[[walk]] backwards or sideways at more than 0.3 m/s beside [[crouch]]",
    );
}

/// Does it face elsewhere than it goes?
fn aside(walk: &Walk) -> bool {
    real::cos(walk.facing.unwrap_or(walk.heading) - walk.heading) < 0.7
}

#[derive(Default)]
struct Parts(Vec<&'static str>);

impl Parts {
    fn add(&mut self, is: bool, name: &'static str) {
        if is {
            self.0.push(name);
        }
    }
}

/// What of it another body could play, but not this one.
pub(super) fn unfit(scenario: &Scenario, body: &Body) -> Option<&'static str> {
    unbent(scenario, body).or_else(|| stiff(scenario, body))
}

/// Ankles that keep their heels down over a crouch only under a trunk that is bent double.
fn stiff(scenario: &Scenario, body: &Body) -> Option<&'static str> {
    let low = lowest(scenario);
    if low <= 0.0 || !scenario.walk.iter().any(|walk| walk.speed > 0.0) {
        return None;
    }
    let anatomy = Anatomy::new(body);
    let physique = stand::physique(body, &anatomy);
    let standing = Solver::new(body, &anatomy).solve(&stand::natural_stand(body, &physique)).pose;
    let figure = Figure::new(body, &standing, Locks::default());
    let stiff = !crouch::suffices(&figure, low * physique.leg_length);
    stiff.then_some("[[walk]] beside a [[crouch]] that its ankles are too stiff for")
}

/// What of it only feet that bend play, if they do not.
fn unbent(scenario: &Scenario, body: &Body) -> Option<&'static str> {
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let part = match scenario.ground.kind {
        GroundKind::Slope { angle } if walks(&|walk| real::tan(angle) * real::cos(walk.heading) > real::tan(STEEP)) => {
            "[[walk]] up a slope of more than 12 degrees on feet without toe joints"
        }
        GroundKind::Stairs { rise, count, .. } if rise < 0.0 && (count > 1 || rise < -KERB) && walks(&|_| true) => {
            "[[walk]] down stairs on feet without toe joints"
        }
        GroundKind::Stairs { rise, .. } if rise > CLIMBED[0] && walks(&|_| true) => {
            "[[walk]] up stairs with steps of more than 0.1 m on feet without toe joints"
        }
        _ => return None,
    };
    let bends = Figure::new(body, &BodyPose::rest(body), Locks::default()).balls_ahead().is_some();
    (!bends).then_some(part)
}

/// A plan without ankle feedback or springs is played; what else can be chosen of it is the stepper's own.
fn on_stepper(scenario: &Scenario, parts: &mut Parts) {
    let played = Stepper { ankle_feedback: true, leg_change: true, ..scenario.stepper };
    parts.add(played != Stepper::default(), "[stepper] but for ankle_feedback and leg_change");
    if scenario.stepper.ankle_feedback {
        return;
    }
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let fastest = BARE * scenario.character.leg_scale.min(1.0).sqrt() + ROUNDED;
    parts.add(walks(&|walk| walk.speed > fastest), "[[walk]] at more than 1 m/s without ankle feedback");
    parts.add(walks(&aside), "[[walk]] backwards or sideways without ankle feedback");
    let flat = scenario.ground.kind == GroundKind::Flat;
    parts.add(!flat && walks(&|_| true), "[[walk]] without ankle feedback on ground that is not flat");
}

fn on_slope(scenario: &Scenario, angle: f64, parts: &mut Parts) {
    let rises = real::tan(angle);
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let up = |walk: &Walk| rises * real::cos(walk.heading);
    parts.add(walks(&|walk| up(walk) > real::tan(UP.0)), "[[walk]] up a slope of more than 20 degrees");
    let pace = scenario.character.leg_scale.sqrt();
    let paced = |walk: &Walk| (UP.1[0] * pace..=UP.1[1] * pace).contains(&walk.speed);
    parts.add(
        walks(&|walk| up(walk) > real::tan(STEEP) && !paced(walk)),
        "[[walk]] up a slope of more than 12 degrees at less than 0.3 or more than 0.45 m/s",
    );
    parts.add(walks(&|walk| up(walk) < -real::tan(STEEPEST)), "[[walk]] down a slope of more than 25 degrees");
    parts.add(
        walks(&|walk| (rises * real::sin(walk.heading)).abs() > real::tan(STEEP)),
        "[[walk]] across a slope of more than 12 degrees",
    );
    if angle.abs() > LEVEL {
        let beyond = |walk: &Walk| aside(walk) && (angle.abs() > ASIDE.0 || walk.speed > ASIDE.1);
        parts.add(
            walks(&beyond),
            "[[walk]] backwards or sideways on a slope of more than 8 degrees or at more than 0.3 m/s",
        );
    }
    if angle.abs() > TEN {
        parts.add(
            walks(&|walk| walk.speed > SLOWER[1]),
            "[[walk]] at more than 0.6 m/s on a slope of more than 10 degrees",
        );
    } else if angle.abs() > LEVEL {
        parts.add(walks(&|walk| walk.speed > SLOWER[0]), "[[walk]] at more than 0.8 m/s on a slope");
    }
    parts.add(angle.abs() > STEEP && !scenario.turn.is_empty(), "[[turn]] on a slope of more than 12 degrees");
    if angle.abs() > STEEPER {
        parts.add(!scenario.crouch.is_empty(), "[[crouch]] on a slope of more than 15 degrees");
        parts.add(!scenario.stand.is_empty(), "[[stand]] on a slope of more than 15 degrees");
    }
}

fn on_platform(scenario: &Scenario, tilts: [&[[f64; 2]]; 2], parts: &mut Parts) {
    let most = tilts.into_iter().flatten().fold(0.0, |most: f64, [_, tilt]| most.max(tilt.abs()));
    let fast = |walk: &Walk| walk.speed > ABOARD;
    parts.add(scenario.walk.iter().any(fast), "[[walk]] at more than 0.3 m/s on a platform");
    parts.add(most > TILTS + ROUNDED && !scenario.walk.is_empty(), TILTED[0]);
    if most > TILTS_MORE + ROUNDED {
        let others = Scenario { walk: Vec::new(), ..scenario.clone() };
        lanes(&others, parts, TILTED);
    }
}

/// The first gap is a metre ahead: who does not walk stands on level ground.
fn on_gaps(scenario: &Scenario, [width, spacing]: [f64; 2], parts: &mut Parts) {
    let size = scenario.character.leg_scale;
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let turned = |walk: &Walk| walk.heading.abs().max(walk.facing.unwrap_or(walk.heading).abs()) > ASLANT;
    let pace = size.sqrt();
    let fast = |walk: &Walk| !(CROSSES[0] * pace..=CROSSES[1] * pace).contains(&walk.speed);
    parts.add(walks(&|_| width > WIDEST), "[[walk]] over gaps of more than 0.2 m");
    parts.add(walks(&|_| spacing < APART * size), "[[walk]] over gaps less than 0.9 m from one to the next");
    parts.add(walks(&|_| size < 1.0), "[[walk]] over gaps on shortened legs");
    parts.add(walks(&fast), "[[walk]] over gaps at less than 0.4 or more than 0.5 m/s");
    parts.add(walks(&turned), "[[walk]] over gaps that does not go and face straight ahead");
    let walks = walks(&|_| true);
    parts.add(walks && !scenario.turn.is_empty(), "[[turn]] beside [[walk]] over gaps");
    parts.add(walks && !scenario.stand.is_empty(), "[[stand]] beside [[walk]] over gaps");
}

/// A single step a metre ahead, low enough for the gait.
fn on_kerb(scenario: &Scenario, parts: &mut Parts) {
    let size = scenario.character.leg_scale;
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let turned = |walk: &Walk| walk.heading.abs().max(walk.facing.unwrap_or(walk.heading).abs()) > ASLANT;
    let pace = size.sqrt();
    let fast = |walk: &Walk| !(CLIMBS[0] * pace..=CLIMBS[1] * pace).contains(&walk.speed);
    parts.add(walks(&|_| size < 1.0), "[[walk]] over a kerb on shortened legs");
    parts.add(walks(&fast), "[[walk]] over a kerb at less than 0.3 or more than 0.4 m/s");
    parts.add(walks(&turned), "[[walk]] over a kerb that does not go and face straight ahead");
    lanes(&Scenario { walk: Vec::new(), ..scenario.clone() }, parts, EDGED);
}

/// A flight, or a kerb too high for the gait: one tread at a time, up and down.
fn on_stairs(scenario: &Scenario, [rise, tread]: [f64; 2], parts: &mut Parts) {
    let size = scenario.character.leg_scale;
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    let turned = |walk: &Walk| walk.heading.abs().max(walk.facing.unwrap_or(walk.heading).abs()) > ASLANT;
    let pace = size.sqrt();
    let fast = |walk: &Walk| !(APPROACHES[0] * pace..=APPROACHES[1] * pace).contains(&walk.speed);
    parts.add(walks(&|_| rise.abs() > CLIMBED[1]), "[[walk]] on stairs with steps of more than 0.17 m");
    parts.add(
        walks(&|_| !(TREADS[0]..=TREADS[1]).contains(&tread)),
        "[[walk]] on stairs with treads of less than 0.3 or more than 0.36 m",
    );
    parts.add(
        walks(&|_| !(SCALED[0]..=SCALED[1]).contains(&size)),
        "[[walk]] on stairs on legs scaled by less than 1 or more than 1.15",
    );
    parts.add(walks(&fast), "[[walk]] on stairs at less than 0.2 or more than 0.35 m/s");
    parts.add(walks(&turned), "[[walk]] on stairs that does not go and face straight ahead");
    lanes(&Scenario { walk: Vec::new(), ..scenario.clone() }, parts, EDGED);
}

/// A mesh: by what of it the walks cross.
fn on_mesh(scenario: &Scenario, parts: &mut Parts) {
    lanes(&Scenario { walk: Vec::new(), ..scenario.clone() }, parts, MESHED);
    let walks = |cannot: &dyn Fn(&Walk) -> bool| scenario.walk.iter().any(|walk| walk.speed > 0.0 && cannot(walk));
    if !walks(&|_| true) {
        return;
    }
    let Crossed { up, down, across, bends, step, apart, hole, aslant } = crossed(scenario);
    let (size, steepest) = (scenario.character.leg_scale, up.max(down));
    parts.add(hole, "[[walk]] over a hole of a mesh");
    parts.add(up > real::tan(STEEP), "[[walk]] up a mesh of more than 12 degrees");
    parts.add(down > real::tan(MESH_DOWN), "[[walk]] down a mesh of more than 15 degrees");
    parts.add(across > real::tan(ASIDE.0), "[[walk]] across a mesh of more than 8 degrees");
    parts.add(bends > real::tan(BENDS), "[[walk]] over a mesh that bends by more than 10 degrees at once");
    if steepest > real::tan(LEVEL) {
        parts.add(walks(&aside), "[[walk]] backwards or sideways on a mesh that is not level");
        parts.add(walks(&|walk| walk.speed > SLOWER[1]), "[[walk]] at more than 0.6 m/s on a mesh that is not level");
    }
    if step > 0.0 {
        let turned = |walk: &Walk| walk.heading.abs().max(walk.facing.unwrap_or(walk.heading).abs()) > ASLANT;
        let pace = size.sqrt();
        let fast = |walk: &Walk| !(CLIMBS[0] * pace..=CLIMBS[1] * pace).contains(&walk.speed);
        let near = apart.is_some_and(|apart| apart < APART * size);
        parts.add(step > MESH_KERB, "[[walk]] over a step of a mesh of more than 0.08 m");
        parts.add(near, "[[walk]] over steps of a mesh less than 0.9 m from one to the next");
        parts.add(size < 1.0, "[[walk]] over a step of a mesh on shortened legs");
        parts.add(walks(&fast), "[[walk]] over a step of a mesh at less than 0.3 or more than 0.4 m/s");
        parts.add(
            aslant || walks(&turned),
            "[[walk]] over a step of a mesh that does not go straight ahead and over it",
        );
    }
}

/// Names every lane that is there.
fn lanes(scenario: &Scenario, parts: &mut Parts, names: [&'static str; 4]) {
    let there =
        [!scenario.walk.is_empty(), !scenario.turn.is_empty(), !scenario.crouch.is_empty(), !scenario.stand.is_empty()];
    for (is, name) in there.into_iter().zip(names) {
        parts.add(is, name);
    }
}
