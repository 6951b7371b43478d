//! Walking: the commanded velocity, ramped; the phases of the gait; the pressure's way; the landing of each step.
//!
//! Start (the weight goes over the stance foot) -> single -> double -> single ... -> the last step (`halt`), after which `decide`
//! brings the feet together. What the gait cannot hold, `decide` catches with a corrective step; then the gait goes on. Scenario
//! space, SI units.

use super::gait::{self, Rhythm};
use super::learned::Learned;
use super::pace::Pace;
use super::support::{Support, Tread};
use super::{
    Inputs, Params, Physique, State, StepKind, Swing, footfall, footing, grip, ground, halt, kerb, learned, mesh,
    push_off, rise, roll, steep, swing, turn,
};
use super::{Passing, balance};
use crate::maths::pendulum::{self, GRAVITY};
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// Where in the gait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Not walking.
    Rest,
    /// Both feet carry, the first step is being prepared.
    Start,
    /// Both feet carry, from a landing to the next lift.
    Double,
    /// One foot carries.
    Single,
}

/// What the gait remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    /// Where in it.
    pub phase: Phase,
    /// s, a tick: the gait's times are whole ticks.
    pub tick: f64,
    /// m/s, the command as it is followed now, (x, z).
    pub velocity: DVec2,
    /// The foot that swings, or will next.
    pub side: Side,
    /// s, when the phase began.
    pub since: f64,
    /// s, when it is to end.
    pub until: f64,
    /// m, centre of pressure when it began, (x, z).
    pub from: DVec2,
    /// m, what ankle feedback adds to the pressure's roll, (x, z).
    pub shift: DVec2,
    /// N, the force that lasts, (x, z).
    pub lasting: DVec2,
    /// rad/s, how fast the pelvis turns.
    pub turn: f64,
    /// rad, how far it has yet to turn.
    pub goal: f64,
    /// The feet have to step for it to get there.
    pub turning: bool,
    /// It began as a turn on the spot, and nothing else has been asked for since.
    pub spot: bool,
    /// This step is the last one.
    pub last: bool,
    /// The last one, in which a foot is set beside the other.
    pub closes: bool,
    /// m, the longest step that the ground allows.
    pub longest: f64,
    /// m, the longest step that friction allows.
    pub grip: f64,
    /// m, how much higher the next foothold is than the stance foot.
    pub rise: f64,
    /// The same a metre of the way, as the last step found it.
    pub grade: f64,
    /// What its steps have taught.
    pub learned: Learned,
    /// Does what a mesh has in the way leave nowhere to go? It stands then.
    pub barred: bool,
    /// Is a mesh's ground by the next foothold such that a sole does not lie on it everywhere?
    pub broken: bool,
    /// Has the ground edges, off which steps are timed to land: gaps, treads?
    pub timed: bool,
    /// m, where the foot that leaves next is to land, (x, z), and s, how long it then swings; where steps are timed to land off edges.
    pub next: Option<(DVec2, f64)>,
    /// The speed that is held.
    pub pace: Pace,
}

impl Gait {
    /// Not walking.
    pub fn still(side: Side) -> Gait {
        let none = DVec2::ZERO;
        Gait {
            phase: Phase::Rest,
            tick: 0.01,
            velocity: none,
            side,
            since: 0.0,
            until: 0.0,
            from: none,
            shift: none,
            lasting: none,
            turn: 0.0,
            goal: 0.0,
            turning: false,
            spot: false,
            last: false,
            closes: false,
            longest: f64::INFINITY,
            grip: f64::INFINITY,
            rise: 0.0,
            grade: 0.0,
            learned: Learned::default(),
            barred: false,
            broken: false,
            timed: false,
            next: None,
            pace: Pace::default(),
        }
    }
}

/// Follows the command.
pub fn steer(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, inputs: &Inputs, dt: f64) {
    // while the pelvis turns, the way to go turns with it
    let mut wanted = turn::rotated(inputs.walk.unwrap_or(DVec2::ZERO), -state.gait.goal);
    let ramp = grip::ramp(params, state);
    let gait = &mut state.gait;
    gait.spot &= inputs.walk.is_none_or(|walk| walk == DVec2::ZERO);
    if gait.phase == Phase::Rest && wanted == DVec2::ZERO && gait.velocity == DVec2::ZERO {
        return;
    }
    gait.tick = dt;
    gait.timed = terrain.has_gaps() || terrain.has_treads();
    gait.longest = footing::longest(terrain, params, ground(state.com), wanted.normalize_or(state.ahead));
    let mut slowest = footing::STAIR_STEP;
    if params.fits && terrain.is_mesh() {
        gait.longest = mesh::beside_edge(terrain, params.size, ground(state.com), state.ahead);
        gait.timed = gait.longest.is_finite() || mesh::bends(terrain, params.size, ground(state.com), state.ahead);
    }
    if params.fits && gait.longest.is_finite() {
        (gait.longest, slowest) = (kerb::STRIDE, kerb::SLOWEST);
    }
    let longest = gait.longest.min(gait.grip);
    let flight = matches!(terrain.kind, GroundKind::Stairs { count: 2.., .. });
    let climbs = flight && gait.longest < footing::CLIMBED * params.size;
    if !params.fits && climbs && wanted != DVec2::ZERO {
        let least = gait.longest / (footing::SLOWEST_STAIR_STEP * params.tempo);
        wanted = wanted.clamp_length_min(least);
    }
    let wanted = wanted.clamp_length_max(longest / (slowest * params.tempo)).clamp_length_max(most_speed(physique));
    let fastest = footing::fastest(terrain, params, physique, ground(state.com), wanted);
    gait.barred = wanted != DVec2::ZERO && fastest < BARRED[usize::from(gait.barred)] * params.size / params.tempo;
    let wanted = if gait.barred { DVec2::ZERO } else { wanted.clamp_length_max(fastest) };
    let most = ramp * dt;
    let first = 0.5 * params.size / params.tempo;
    let wanted = if gait.phase == Phase::Start { wanted.clamp_length_max(first) } else { wanted };
    gait.velocity += (wanted - gait.velocity).clamp_length_max(most);
    if wanted == DVec2::ZERO && gait.velocity.length() < most {
        gait.velocity = DVec2::ZERO;
    }
    let force = ground(inputs.force).clamp_length_max(0.6 * params.foresee);
    let slow = if force.length_squared() < 0.5 * gait.lasting.length_squared() { 0.15 } else { 0.5 };
    gait.lasting += (force - gait.lasting) * (1.0 - real::exp(-dt / (slow * params.tempo)));
}

/// m/s, the fastest walk: a Froude number of a half, above which people run (Alexander 1989).
pub fn most_speed(physique: &Physique) -> f64 {
    (0.5 * GRAVITY * physique.leg_length).sqrt()
}

/// m/s of the reference body: who may go no faster before a wall or a ledge stands, until it may go as fast as the second.
const BARRED: [f64; 2] = [0.2, 0.5];

/// What the gait is told: to end before what bars the way.
pub fn halted(state: &State, inputs: &Inputs) -> Inputs {
    Inputs { walk: inputs.walk.filter(|_| !state.gait.barred), ..*inputs }
}

/// m of the reference body, [`Params::stumble`] where steps are fitted to the ground: who gives up there steps into a gap.
const STUMBLES: f64 = 0.3;

/// With both feet down: is the gait in charge? It may lift a foot.
pub fn both_down(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &mut State,
    inputs: &Inputs,
    dt: f64,
) -> (bool, Option<Side>) {
    let go = goes(params, state, inputs);
    match state.gait.phase {
        Phase::Rest if !go => return (false, None),
        Phase::Rest => {
            if !begin(params, physique, terrain, state, inputs) {
                return (false, None);
            }
        }
        Phase::Start if !go => {
            state.gait.phase = Phase::Rest;
            state.gait.velocity = DVec2::ZERO;
            return (false, None);
        }
        Phase::Start | Phase::Double | Phase::Single => {}
    }
    let left_over = (state.gait.until - state.time).max(0.0);
    let rhythm = rhythm_now(params, physique, state);
    let mut single = rhythm.step - rhythm.double;
    if state.gait.phase == Phase::Start {
        if state.outline.outside(state.xi() + balance::steady_lean(physique, state)) > 0.0 {
            state.gait.phase = Phase::Rest;
            return (false, None);
        }
    } else {
        let least = ((params.double_support - state.settled).max(0.0), footfall::least_swing(params, state));
        let times = (left_over, single);
        let planned = |state: &State| footfall::plan(params, physique, terrain, state, state.gait.side, times, least);
        let footfall = planned(state);
        let fits = footfall::fits(params, terrain, state);
        let most = if fits && params.fits { STUMBLES * params.size } else { params.stumble };
        let stumbles = |state: &State, footfall: &footfall::Footfall| {
            footfall.off > most || breadth(params, physique, state, inputs, (state.gait.side, footfall)) > params.wide
        };
        let alone = footfall::let_go(state);
        if stumbles(state, &footfall) && (!params.fits || stumbles(&alone, &planned(&alone))) {
            state.gait.phase = Phase::Rest;
            return (false, None);
        }
        single = footfall.time;
        state.gait.next = fits.then_some((ground(footfall.plant.ankle), footfall.time));
        if (footfall.wait - left_over).abs() > 0.5 * dt {
            state.gait.until = state.time + (footfall.wait / dt).round() * dt;
        }
    }
    if state.gait.phase == Phase::Start || !go {
        single = single.min(params.brief);
    }
    state.intent = None;
    if state.gait.until > state.time + 0.5 * dt {
        return (true, None);
    }
    let stance = state.feet[state.gait.side.other() as usize];
    let sole = Support::one(params, physique, &stance, Tread::Whole, 0.5 * params.margin);
    if params.rolls && sole.outside(state.cop) > 0.0 {
        state.gait.until = state.time + dt;
        return (true, None);
    }
    (true, Some(lift(params, physique, terrain, state, inputs, (single, dt))))
}

/// m, how far that footfall is to the side of the foot that stands, beyond what a way to the side takes: two steps' worth at once.
fn breadth(
    params: &Params,
    physique: &Physique,
    state: &State,
    inputs: &Inputs,
    (side, footfall): (Side, &footfall::Footfall),
) -> f64 {
    let stance = ground(state.feet[side.other() as usize].ankle);
    let across = inputs.walk.unwrap_or_default().dot(state.aside()).abs();
    let beside = (ground(footfall.plant.ankle) - stance).dot(state.aside()) * side.sign();
    beside - 2.0 * across * rhythm_now(params, physique, state).step
}

/// Is there somewhere to go, or to turn to?
fn goes(params: &Params, state: &State, inputs: &Inputs) -> bool {
    let least = 0.02 * params.size / params.tempo;
    state.gait.turning || inputs.walk.is_some_and(|walk| walk.length() > least)
}

/// s of the reference body, over which the weight goes to the foot that stands before the first step: of a turn on the spot, of a walk.
const STARTS: [f64; 2] = [0.32, 0.5];

/// s of the reference body after a shove, within which a walk that it has brought to a stand goes on as soon as it can.
const HURRIES: f64 = 3.0;

/// Enters the gait: from a stand by shifting the weight, on the move at once.
fn begin(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, inputs: &Inputs) -> bool {
    let lean = balance::steady_lean(physique, state);
    let rhythm = rhythm_now(params, physique, state);
    let moving = state.velocity.length() > 0.3 * params.size / params.tempo && state.settled < params.tempo;
    let gait = state.gait;
    if moving {
        let times = (rhythm.double, rhythm.step - rhythm.double);
        let least = (params.double_support, params.least_swing);
        let next = state.last.map_or(gait.side, Side::other);
        let [usual, other] = [next, next.other()]
            .map(|side| (side, footfall::plan(params, physique, terrain, state, side, times, least)));
        let least = usual.1.off.min(other.1.off);
        let (side, footfall) = if usual.1.off > other.1.off + 0.1 * params.size { other } else { usual };
        if least > params.stumble || breadth(params, physique, state, inputs, (side, &footfall)) > params.wide {
            return false;
        }
        state.gait.spot = false;
        enter(state, Phase::Double, side, rhythm.double);
        return true;
    }
    if state.outline.outside(state.xi() + lean) > -params.margin {
        return false;
    }
    let way = gait.velocity.normalize_or_zero();
    let behind = (ground(state.feet[0].ankle) - ground(state.feet[1].ankle)).dot(state.ahead);
    let across = way.dot(state.aside());
    let side = if gait.turning && way == DVec2::ZERO {
        if gait.goal > 0.0 { Side::Left } else { Side::Right }
    } else if across.abs() > 0.5 {
        if across > 0.0 { Side::Left } else { Side::Right }
    } else if behind.abs() > params.stagger {
        if behind * way.dot(state.ahead) > 0.0 { Side::Right } else { Side::Left }
    } else {
        params.lead
    };
    state.gait.spot = gait.turning && way == DVec2::ZERO;
    let usual = (side, STARTS[usize::from(!state.gait.spot)] * params.tempo);
    let hurries = params.fits && !state.gait.spot && state.shoved < HURRIES * params.tempo;
    let (side, shifts) = if hurries { roll::soonest(params, physique, state) } else { None }.unwrap_or(usual);
    enter(state, Phase::Start, side, shifts);
    true
}

fn enter(state: &mut State, phase: Phase, side: Side, time: f64) {
    let (since, until, from) = (state.time, state.time + time, state.cop);
    state.gait = Gait { phase, side, since, until, from, last: false, closes: false, ..state.gait };
}

/// m a metre, up or down: on steeper ground, and in turns on the spot, slow steps are no slower than others.
const GENTLE: f64 = 0.05;
/// s of the reference body, a step of a turn on the spot takes no longer: 90 degrees in 1.5 s are three steps after the weight's shift.
const SPOT: f64 = 0.36;

/// Share of its weight, from a force that lasts as strong as that on a body takes its quickest steps: of 20 walks under 60 to 80 N two are given
/// up again and again with slow ones.
const PULLED: f64 = 0.05;
/// s of the reference body after a shove, for which a body takes its quickest steps; in as much time again it comes back to its usual ones.
pub(super) const SHAKEN: f64 = 1.5;

/// Do its feet land when they are planned to, so that it can take its time over a step? Off edges they are timed to land; feet that do not bend
/// and ankles that do nothing make up for less of what is wrong at a landing.
pub fn in_time(params: &Params, state: &State) -> bool {
    !state.gait.timed && params.rolls && params.balls.is_some()
}

/// How much of its quickest steps a body needs, 0 to 1: uphill on its balls, against a force that lasts, after a shove.
pub(super) fn quick(params: &Params, physique: &Physique, state: &State) -> f64 {
    let pulled = state.gait.lasting.length() / (PULLED * physique.mass * GRAVITY);
    let shaken = (2.0 - state.shoved / (SHAKEN * params.tempo)).clamp(0.0, 1.0);
    steep::share(params, state).max(pulled.min(1.0)).max(shaken)
}

/// The rhythm of the commanded velocity, in whole ticks.
pub fn rhythm_now(params: &Params, physique: &Physique, state: &State) -> Rhythm {
    let tick = state.gait.tick;
    let gait = &state.gait;
    let kerb = (params.fits && gait.longest.is_finite()).then_some(kerb::MEAN * kerb::STRIDE);
    let bounds = (gait.turn, gait.longest.min(gait.grip), kerb);
    let hurried = if gait.spot { 1.0 } else { gait.grade.abs() / GENTLE };
    let timed = if in_time(params, state) { quick(params, physique, state) } else { 1.0 };
    let rhythm = gait::rhythm(params, physique, state.ahead, gait.velocity, bounds, (hurried, timed));
    let rhythm = push_off::rolled(rhythm, push_off::strides(params, physique, state));
    let quicker = if gait.spot { (SPOT * params.tempo / rhythm.step).min(1.0) } else { 1.0 };
    let rhythm = Rhythm { step: rhythm.step * quicker, double: rhythm.double * quicker, ..rhythm };
    let slower = rise::share_of_step(physique, state, rhythm.step);
    let whole = |time: f64| (time * slower / tick).round() * tick;
    let single = whole(rhythm.step - rhythm.double).max(2.0 * tick);
    let step = whole(rhythm.step).max(single);
    let rhythm = Rhythm { step, double: if params.rolls { step - single } else { 0.0 }, ..rhythm };
    steep::on_balls(params, physique, state, rhythm)
}

/// Lifts the foot.
fn lift(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &mut State,
    inputs: &Inputs,
    (single, dt): (f64, f64),
) -> Side {
    let side = state.gait.side;
    let halts = !state.gait.spot && !goes(params, state, inputs);
    let closes = halts && halt::closes(params, physique, state, side);
    let single = if closes { halt::time(params, single) } else { single };
    let ticks = (single / dt).round().max(2.0);
    let land = state.time + ticks * dt;
    let slow = (state.gait.velocity.length() - params.ramp * ticks * dt) < 0.2 * params.size / params.tempo;
    let slow = slow && state.velocity.length() < 0.68 * params.size / params.tempo;
    let stops = closes || halts && slow && !halt::able(params, state);
    let last = if state.gait.spot { turn::closes(physique, state, side) } else { stops };
    enter(state, Phase::Single, side, ticks * dt);
    (state.gait.last, state.gait.closes) = (last, closes);
    let to = footfall::plan(params, physique, terrain, state, side, (0.0, ticks * dt), (0.0, ticks * dt)).plant;
    let aim = ground(to.ankle);
    let beside = state.feet[side.other() as usize];
    let to = footing::stepped(params, (terrain, physique), state, &beside, aim, (to.yaw, land));
    let from = state.feet[side as usize];
    let stance = ground(state.feet[side.other() as usize].ankle);
    let round = swing::round(ground(from.ankle), ground(to.ankle), stance, state.aside() * side.sign());
    state.swing = Some(Swing {
        side,
        kind: StepKind::Walk,
        lift: state.time,
        land,
        from,
        to,
        off: 0.0,
        aim,
        passing: Passing::Own,
        round,
        detour: swing::detour(ground(from.ankle), ground(to.ankle), stance, round, params.step_gap),
    });
    side
}

/// After a step of the gait has landed.
pub fn landed(params: &Params, physique: &Physique, state: &mut State, side: Side) {
    if state.gait.last {
        let Gait { turn, goal, .. } = state.gait;
        state.gait = Gait { turn, goal, ..Gait::still(side.other()) };
        return;
    }
    let rhythm = rhythm_now(params, physique, state);
    state.gait.learned = learned::landed(params, physique, state, side);
    enter(state, Phase::Double, side.other(), rhythm.double);
    if !params.rolls {
        state.cop = roll::contact(params, state, side);
        state.gait.from = state.cop;
    }
}

/// 1/s, the pendulum's rate at the height of a walking centre of mass.
pub fn omega(params: &Params, physique: &Physique) -> f64 {
    let share = if params.leg_change { 0.965 } else { 1.0 };
    pendulum::rate((share * physique.com_height).max(1e-3))
}
