//! Where and when a step of the gait lands: the wanted foothold bent to what legs can do, and sooner where it is out of
//! reach. Ground plane (x, z), metres, seconds. Source of the timing: Khadiv (2016), step timing adjustment.

use super::control::wrap;
use super::gait::{self, Rhythm};
use super::{
    Params, Physique, Plant, State, Swing, ascend, footing, ground, halt, kerb, learned, pace, support, swing, turn,
    walk,
};
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// A planned landing.
#[derive(Clone, Copy, Debug)]
pub struct Footfall {
    /// Where.
    pub plant: Plant,
    /// m, how far it is from where it is wanted.
    pub off: f64,
    /// s, until the foot lifts; 0 where it has.
    pub wait: f64,
    /// s, from then (or now) until it lands.
    pub time: f64,
}

/// The landing of `side` that lifts in `wait` s and flies for `time` s more, sooner if that brings it nearer to where it
/// is wanted; neither is made shorter than `least`.
pub fn plan(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &State,
    side: Side,
    (wait, time): (f64, f64),
    least: (f64, f64),
) -> Footfall {
    if fits(params, terrain, state) {
        let found = fitted(params, physique, terrain, state, side, (wait, time), least);
        // The pendulum alone, shoved, catches itself wherever it can: of 60 walks none falls; with timed steps only, 2 of the first 20.
        if params.fits || found.off <= 0.0 {
            return found;
        }
    }
    let rhythm = walk::rhythm_now(params, physique, state);
    let mut best = landing(params, physique, state, &rhythm, side, (wait, time));
    if best.off < 0.02 * params.size || !params.rolls && wait + time <= least.0 + least.1 {
        return best;
    }
    let mut price = best.off;
    for haste in 1..=6 {
        let share = 1.0 - 0.15 * f64::from(haste);
        let sooner = ((wait * share).max(least.0.min(wait)), (time * share).max(least.1.min(time)));
        let found = landing(params, physique, state, &rhythm, side, sooner);
        let cost = found.off + 0.05 * params.size * (1.0 - share);
        if cost < price {
            (best, price) = (found, cost);
        }
    }
    best
}

/// Are steps timed so that they land off the edges of the ground?
pub fn fits(params: &Params, terrain: &Terrain, state: &State) -> bool {
    let edged = || params.fits && state.gait.broken || kerb::near(params, terrain, state);
    !state.gait.spot && (terrain.has_gaps() || edged())
}

/// m of the reference body: a landing over a gap, and one before it, are that far apart at least; which it is is chosen before the foot leaves.
const ELSEWHERE: f64 = 0.1;
/// What a landing counts beside how far it is from where it is wanted: m of the reference body for a step's time that it is later or
/// sooner than usual, and m for each that it is wider than usual.
const UNTIMELY: f64 = 0.3;
const WIDER: f64 = 0.5;
/// As `UNTIMELY`, where the foothold is chosen for an edge: to be a little late is better than to fall short of it.
const PATIENT: f64 = 0.05;
/// m of the reference body, the widest landing of such a step: one on the way over a gap is late, and what is late falls to the side.
const WIDEST: f64 = 0.4;
/// Share of a leg's reach within which such a step lands.
const WITHIN: f64 = 0.8;
/// s of the reference body: its longest swing, and between the times that are looked at.
const LONGEST: f64 = 0.8;
const BETWEEN: f64 = 0.02;
/// Share of its delay, and s of the reference body at most, for which both feet stay down.
const WAITS: f64 = 0.3;
const WAITS_MOST: f64 = 0.15;
/// m of the reference body, so far from where it is wanted a landing may be: the ankles make up for it.
const EASY: f64 = 0.1;

/// The landing on ground with gaps or near a kerb: at the time, sooner or later, at which what is wanted is nearest to where the whole sole
/// is held. ξ runs away from the foot that stands, so a later step is a longer one.
fn fitted(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &State,
    side: Side,
    (wait, time): (f64, f64),
    least: (f64, f64),
) -> Footfall {
    let rhythm = walk::rhythm_now(params, physique, state);
    let by = state.feet[side.other() as usize];
    let swing = state.swing.filter(|swing| swing.side == side);
    let gone = swing.map_or(0.0, |swing| state.time - swing.lift);
    let usual = wait + (rhythm.step - rhythm.double - gone).max(0.0);
    let natural = ground(landing(params, physique, state, &rhythm, side, (wait, time)).plant.ankle).y;
    // the pendulum alone lands where a whole sole is held, wherever that is
    let kerb = params.fits && (terrain.has_treads() || kerb::near(params, terrain, state));
    let edge = kerb.then(|| {
        let by = (&rhythm, side);
        let flight = ascend::approached(params, physique, terrain, state, by, natural);
        flight.or_else(|| kerb::ahead(params, physique, terrain, state, by, natural))
    });
    let chosen = edge.flatten();
    let [untimely, waits] = if chosen.is_some() { [PATIENT, 0.0] } else { [UNTIMELY, WAITS] };
    let mut floors: Vec<[f64; 2]> = Vec::new();
    let mut floor = |x: f64, z: f64| {
        let known = floors.iter().find(|[from, to]| *from <= z && z < *to).copied();
        known.or_else(|| {
            let found = terrain.floor_at(DVec2::new(x, z))?;
            floors.push(found);
            Some(found)
        })
    };
    let mut held = |times: (f64, f64)| {
        let found = landing(params, physique, state, &rhythm, side, times);
        let ankle = ground(found.plant.ankle);
        let lands = state.time + times.0 + times.1;
        let there = if terrain.is_mesh() && !params.fits {
            // as on stairs by name: to look for a whole sole in each of these places takes 20 times as long
            let on = footing::held_on(terrain, physique, ankle, found.plant.yaw, &mut |z| floor(ankle.x, z));
            kerb::stood(terrain, physique, on, found.plant.yaw)
        } else {
            let ankle = DVec2::new(ankle.x, footing::onward(terrain, physique, state.gait.velocity, &by, ankle.y));
            footing::rocked(terrain, physique, &by, ankle, (found.plant.yaw, lands))
        };
        let elsewhere = |swing: &Swing| ground(swing.to.ankle).distance(ground(there.ankle)) > ELSEWHERE * params.size;
        let plant = match chosen {
            Some(z) => kerb::stood(terrain, physique, DVec2::new(ankle.x, z), found.plant.yaw),
            None => swing.filter(elsewhere).map_or(there, |swing| swing.to),
        };
        let com = touchdown(params, physique, state, &rhythm, (side, state.cop), times).0;
        let far = (ground(plant.ankle).distance(com) - WITHIN * params.reach).max(0.0);
        Footfall { plant, off: found.off + ground(plant.ankle).distance(ankle) + far, ..found }
    };
    let price = |found: &Footfall| {
        let beside = (ground(found.plant.ankle) - ground(by.ankle)).dot(state.aside()) * side.sign();
        let late = (found.wait + found.time - usual).abs() / rhythm.step;
        let wide = if beside > WIDEST * params.size { 1.0 + beside } else { 0.0 };
        found.off + untimely * params.size * late + WIDER * (beside - rhythm.width).abs() + wide
    };
    let whole = wait + time;
    let mut best = held((wait, time));
    if least.0 + least.1 < whole {
        let first = (least.0.min(wait) + least.1).min(whole);
        let last = wait + (LONGEST * params.tempo - gone).max(time);
        let step = BETWEEN * params.tempo;
        for number in 0..=((last - first) / step).clamp(0.0, 60.0) as usize {
            let lands = first + step * number as f64;
            let lifts = if lands < whole {
                (wait * lands / whole).max(least.0.min(wait))
            } else if wait > 0.0 {
                wait + (waits * (lands - whole)).min(WAITS_MOST * params.tempo)
            } else {
                wait
            };
            let found = held((lifts, lands - lifts));
            if price(&found) < price(&best) {
                best = found;
            }
        }
    }
    best.off = (best.off - EASY * params.size).max(0.0);
    best
}

/// The state, were the shove over now: what it will yet do is a guess, and no reason to give a walk up.
pub fn let_go(state: &State) -> State {
    State { touch: state.gait.lasting, ..*state }
}

/// s, a swing of the gait takes no less: one that turns on the spot is not in a hurry.
pub fn least_swing(params: &Params, state: &State) -> f64 {
    if state.gait.spot { params.least_swing.max(0.28 * params.tempo) } else { params.least_swing }
}

/// The swing in the air, aimed again: its landing and when that is.
pub fn replan(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &State,
    swing: &Swing,
    dt: f64,
) -> (Footfall, f64) {
    let gone = state.time - swing.lift;
    let least = (least_swing(params, state) - gone).max(2.0 * dt);
    let footfall =
        plan(params, physique, terrain, state, swing.side, (0.0, (swing.land - state.time).max(0.0)), (0.0, least));
    let ticks = (footfall.time / dt).ceil().max(1.0);
    let later = if fits(params, terrain, state) { -2.0 * dt } else { 0.0 };
    let sooner = (swing.land - state.time - ticks * dt).clamp(later, 2.0 * dt);
    (footfall, swing.land - (sooner / dt).round() * dt)
}

/// The centre of mass when `side` lands: its position (leaning against a force that lasts) and velocity.
pub fn touchdown(
    params: &Params,
    physique: &Physique,
    state: &State,
    rhythm: &Rhythm,
    (side, cop): (Side, DVec2),
    (wait, time): (f64, f64),
) -> (DVec2, DVec2) {
    let omega = walk::omega(params, physique);
    let stance = &state.feet[side.other() as usize];
    let rear = ground(stance.ankle);
    let toe = support::forward(stance.yaw);
    // what a shove will yet do, over the force that lasts
    let goes_on = state.pushed.min(params.expect).min((wait + time).max(0.0));
    let more = (state.touch - state.gait.lasting) * (goes_on / physique.mass);
    let (mut com, mut velocity) = (ground(state.com) + lean(params, physique, state), ground(state.velocity) + more);
    let mut cop = cop;
    if wait > 0.0 {
        let early = rear + toe * rhythm.roll[0];
        (com, velocity) = gait::carried(com, velocity, [cop, early], omega, wait);
        cop = early;
    }
    if time > 0.0 {
        let (late, runs) = (rear + toe * rhythm.roll[1], running(state, rhythm, wait, time));
        (com, velocity) = gait::carried(com, velocity, [cop, late], omega, runs);
        if time > runs {
            (com, velocity) = gait::carried(com, velocity, [late; 2], omega, time - runs);
        }
    }
    let short = if state.shoved < walk::SHAKEN * params.tempo { 0.0 } else { state.gait.learned.short };
    let way = state.gait.velocity.normalize_or(state.ahead);
    (com, velocity - way * (short * omega))
}

/// s, how much of the `time` that is left on one foot, after `wait`, the pressure still rolls.
fn running(state: &State, rhythm: &Rhythm, wait: f64, time: f64) -> f64 {
    let gait = &state.gait;
    let whole = if wait > 0.0 || gait.phase != walk::Phase::Single { time } else { gait.until - gait.since };
    (time - (1.0 - rhythm.run) * whole.max(time)).max(0.0)
}

/// What the paper's k_p is as people set it (`[stepper] pull_bias`): then the lean balances the force.
const BALANCES: f64 = 0.4;

/// m, the paper's β k_p of a step of the gait, β = F_p / F_g: how far ahead of the centre of mass the pressure balances a force
/// that lasts.
pub fn lean(params: &Params, physique: &Physique, state: &State) -> DVec2 {
    let omega = walk::omega(params, physique);
    let bias = params.pull / (BALANCES * physique.com_height);
    state.gait.lasting * bias / (physique.mass * omega * omega)
}

/// The effective pivot of the step that `side` begins when it lands `time` s from now, and the lead that keeps the
/// commanded velocity; the legs' length error shortens the step as the paper's bias.
pub fn pivot(
    params: &Params,
    physique: &Physique,
    state: &State,
    rhythm: &Rhythm,
    side: Side,
    time: f64,
) -> gait::Pivot {
    let rear = &state.feet[side.other() as usize];
    let amid = turn::turned_in(state, time + 0.5 * rhythm.step);
    let yaws = [rear.yaw, state.facing + amid + side.sign() * physique.toe_out];
    let ahead = turn::rotated(state.ahead, amid);
    let velocity = turn::rotated(pace::aimed(state), amid);
    let mut pivot = gait::pivot(rhythm, walk::omega(params, physique), side, yaws, ahead, velocity);
    let bias = if state.gait.longest.is_infinite() { params.walk_bias } else { params.leg_bias };
    let slack = bias * (physique.com_height + state.carried.height - state.com.y);
    let slack = velocity.normalize_or_zero() * slack;
    pivot.lead += slack;
    pivot.then += slack;
    pivot
}

/// m, equation 2's h: the centre of mass over the stance foot at touchdown, as high over the lower of the two footholds as it is
/// over the one that carries it now.
fn height(state: &State) -> f64 {
    state.com.y - state.carried.height + state.gait.rise.min(0.0)
}

fn landing(
    params: &Params,
    physique: &Physique,
    state: &State,
    rhythm: &Rhythm,
    side: Side,
    (wait, time): (f64, f64),
) -> Footfall {
    let gait = &state.gait;
    let stance = &state.feet[side.other() as usize];
    let rear = ground(stance.ankle);
    let mut cop = state.cop;
    if gait.side == side && matches!(gait.phase, walk::Phase::Single | walk::Phase::Double) {
        // a tick's pressure is its middle's
        let (to, left) = if gait.phase == walk::Phase::Single { (1, time) } else { (0, wait) };
        let end = rear + support::forward(stance.yaw) * rhythm.roll[to];
        let left = if to == 1 { running(state, rhythm, 0.0, left) } else { left };
        cop += (end - cop) * (0.5 * gait.tick / left.max(gait.tick));
    }
    let (com, velocity) = touchdown(params, physique, state, rhythm, (side, cop), (wait, time));
    let amid = turn::turned_in(state, wait + time + 0.5 * rhythm.step);
    let ahead = turn::rotated(state.ahead, amid);
    let out = DVec2::new(ahead.y, -ahead.x) * side.sign();
    let wanted = if gait.last {
        halt::landing(params, state, (rear, stance.yaw), (com, velocity), (ahead, out), (height(state), rhythm.roll[1]))
    } else {
        let step = pivot(params, physique, state, rhythm, side, wait + time);
        let way = turn::rotated(gait.velocity, amid).normalize_or(ahead);
        // treads decide where on stairs: there the wanted landing is that of the line along the footholds; legs that keep their length
        // carry the body along that line everywhere
        let level = gait.longest.is_finite() || !params.leg_change;
        let (height, rise) =
            if level { (state.height().max(0.1), 0.0) } else { (height(state).max(0.1 + gait.rise), gait.rise) };
        let pendulum = (walk::omega(params, physique), height, rise);
        let ankle = learned::evened(
            params,
            state,
            (rear, step.landing(rear, (com, velocity), pendulum, way)),
            step.stride,
            way,
        );
        ankle - out * learned::nearer(params, state)
    };
    if gait.spot {
        let (ideal, yaw) = turn::around(params, physique, state, side);
        let ankle = ideal + (wanted - ideal).clamp_length_max(0.03 * params.size);
        let plant = Plant::level(DVec3::new(ankle.x, 0.0, ankle.y), yaw);
        let plant = footing::apart(physique, stance, &plant, side, footing::ROOM * params.size);
        let off = (ground(plant.ankle).distance(wanted) - 0.08 * params.size).max(0.0); // no haste for less
        return Footfall { plant, off, wait, time };
    }
    let (from, gone) = match state.swing {
        Some(swing) if swing.side == side => (ground(swing.from.ankle), state.time - swing.lift),
        _ => (ground(state.feet[side as usize].ankle), 0.0),
    };
    let reach = |across: bool| bounded(params, physique, ahead, (wanted, from, rear, out), com, gone + time, across);
    let (own, over) = (reach(false), reach(true));
    let [straight, crossed] = [own, over].map(|ankle| ankle.distance(wanted));
    let (ankle, off) = if crossed + 0.1 * params.size < straight { (over, crossed) } else { (own, straight) };
    let yaw = state.facing + amid + side.sign() * physique.toe_out;
    let yaw = stance.yaw + wrap(yaw - stance.yaw).clamp(-1.0, 1.0);
    let plant = Plant::level(DVec3::new(ankle.x, 0.0, ankle.y), yaw);
    let plant = footing::apart(physique, stance, &plant, side, footing::ROOM * params.size);
    Footfall { plant, off, wait, time }
}

/// The nearest landing that legs can do in `fly` s: on the foot's own side, or across in front of the other one
/// or behind it.
fn bounded(
    params: &Params,
    physique: &Physique,
    ahead: DVec2,
    (wanted, from, rear, out): (DVec2, DVec2, DVec2, DVec2),
    com: DVec2,
    fly: f64,
    across: bool,
) -> DVec2 {
    let hip = com - ahead * params.com_forward + out * (0.5 * params.width);
    let far = params.ankle_speed * fly / swing::WALK_PEAK;
    let foot = physique.tip - physique.heel;
    let mut ankle = wanted;
    for _ in 0..2 {
        ankle = hip + (ankle - hip).clamp_length_max(params.reach);
        ankle = from + (ankle - from).clamp_length_max(far);
        let relative = ankle - rear;
        let (beside, before) = (relative.dot(out), relative.dot(ahead));
        if across {
            ankle += out * (-params.most_across - beside).max(0.0);
            let clear = params.pass + 0.5 * beside.max(0.0);
            if (wanted - rear).dot(ahead) < 0.0 {
                ankle -= ahead * (clear + before).max(0.0);
            } else {
                ankle += ahead * (clear - before).max(0.0);
            }
        } else {
            let past = (before.abs() / foot).min(1.0);
            ankle += out * (params.step_gap * (1.0 - 0.7 * past * past) - beside).max(0.0);
        }
    }
    ankle
}
