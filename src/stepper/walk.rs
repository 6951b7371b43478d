//! Walking: the commanded velocity, ramped; the phases of the gait; the pressure's way; the landing of each step.
//!
//! Start (the weight goes over the stance foot) -> single -> double -> single ... -> the last step stops by the paper's
//! formula with no speed left, and `decide` brings the feet together. What the gait cannot hold, `decide` catches with a
//! corrective step; then the gait goes on. Scenario space, SI units.

use super::gait::{self, Rhythm};
use super::support::{Support, Tread};
use super::{Inputs, Params, Physique, Plant, State, StepKind, Swing, ground, swing};
use super::{Passing, balance};
use crate::model::Side;
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
    /// This step is the last one.
    pub last: bool,
}

impl Gait {
    /// Not walking.
    pub fn still(side: Side) -> Gait {
        let none = DVec2::ZERO;
        let phase = Phase::Rest;
        Gait {
            phase,
            velocity: none,
            side,
            since: 0.0,
            until: 0.0,
            from: none,
            shift: none,
            lasting: none,
            last: false,
        }
    }
}

/// A planned landing and how far it is from the wanted one.
struct Aim {
    plant: Plant,
    off: f64,
}

/// Follows the command.
pub fn steer(params: &Params, state: &mut State, inputs: &Inputs, dt: f64) {
    let wanted = inputs.walk.unwrap_or(DVec2::ZERO);
    let gait = &mut state.gait;
    if gait.phase == Phase::Rest && wanted == DVec2::ZERO && gait.velocity == DVec2::ZERO {
        return;
    }
    let most = params.ramp * dt;
    let first = 0.5 * params.size / params.tempo;
    let wanted = if gait.phase == Phase::Start { wanted.clamp_length_max(first) } else { wanted };
    gait.velocity += (wanted - gait.velocity).clamp_length_max(most);
    if wanted == DVec2::ZERO && gait.velocity.length() < most {
        gait.velocity = DVec2::ZERO;
    }
    gait.lasting += (ground(inputs.force) - gait.lasting) * (1.0 - (-dt / (0.3 * params.tempo)).exp());
}

/// With both feet down: is the gait in charge? It may lift a foot.
pub fn both_down(
    params: &Params,
    physique: &Physique,
    state: &mut State,
    inputs: &Inputs,
    dt: f64,
) -> (bool, Option<Side>) {
    let go = inputs.walk.is_some_and(|walk| walk.length() > 0.02 * params.size / params.tempo);
    match state.gait.phase {
        Phase::Rest if !go => return (false, None),
        Phase::Rest => {
            if !begin(params, physique, state) {
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
    if state.gait.phase == Phase::Start || !go {
        single = single.min(params.brief);
    }
    let aim = landing(params, physique, state, state.gait.side, left_over, single);
    let lost = if state.gait.phase == Phase::Start {
        state.outline.outside(state.xi() + balance::steady_lean(physique, state)) > 0.0
    } else {
        aim.off > params.stumble
    };
    if lost {
        state.gait.phase = Phase::Rest;
        return (false, None);
    }
    state.intent = None;
    if left_over > 0.5 * dt {
        return (true, None);
    }
    let stance = state.feet[state.gait.side.other() as usize];
    let sole = Support::one(params, physique, &stance, Tread::Whole, 0.5 * params.margin);
    if params.rolls && sole.outside(state.cop) > 0.0 {
        state.gait.until = state.time + dt;
        return (true, None);
    }
    (true, Some(lift(params, physique, state, inputs, (single, dt))))
}

/// Enters the gait: from a stand by shifting the weight, on the move at once.
fn begin(params: &Params, physique: &Physique, state: &mut State) -> bool {
    let lean = balance::steady_lean(physique, state);
    let rhythm = rhythm_now(params, physique, state);
    let moving = state.velocity.length() > 0.3 * params.size / params.tempo && state.settled < params.tempo;
    let gait = state.gait;
    if moving {
        let single = rhythm.step - rhythm.double;
        let off = |side: Side| landing(params, physique, state, side, rhythm.double, single).off;
        let side = match state.last {
            Some(last) => last.other(),
            None => gait.side,
        };
        if off(side) > 0.5 * params.stumble {
            return false;
        }
        enter(state, Phase::Double, side, rhythm.double);
        return true;
    }
    if state.outline.outside(state.xi() + lean) > -params.margin {
        return false;
    }
    let way = gait.velocity.normalize_or_zero();
    let behind = (ground(state.feet[0].ankle) - ground(state.feet[1].ankle)).dot(state.ahead);
    let across = way.dot(state.aside());
    let side = if across.abs() > 0.5 {
        if across > 0.0 { Side::Left } else { Side::Right }
    } else if behind.abs() > params.stagger {
        if behind * way.dot(state.ahead) > 0.0 { Side::Right } else { Side::Left }
    } else {
        params.lead
    };
    enter(state, Phase::Start, side, 0.5 * params.tempo);
    true
}

fn enter(state: &mut State, phase: Phase, side: Side, time: f64) {
    state.gait =
        Gait { phase, side, since: state.time, until: state.time + time, from: state.cop, last: false, ..state.gait };
}

fn rhythm_now(params: &Params, physique: &Physique, state: &State) -> Rhythm {
    gait::rhythm(params, physique, state.ahead, state.gait.velocity)
}

/// Lifts the foot.
fn lift(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, (single, dt): (f64, f64)) -> Side {
    let side = state.gait.side;
    let ticks = (single / dt).round().max(2.0);
    let land = state.time + ticks * dt;
    let slow = (state.gait.velocity.length() - params.ramp * ticks * dt) < 0.2 * params.size / params.tempo;
    let last = slow && inputs.walk.is_none_or(|walk| walk == DVec2::ZERO);
    enter(state, Phase::Single, side, ticks * dt);
    state.gait.last = last;
    let to = landing(params, physique, state, side, 0.0, ticks * dt).plant;
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
        passing: Passing::Own,
        round,
        detour: swing::detour(ground(from.ankle), ground(to.ankle), stance, round, params.step_gap),
    });
    side
}

/// After a step of the gait has landed.
pub fn landed(params: &Params, physique: &Physique, state: &mut State, side: Side, dt: f64) {
    if state.gait.last {
        state.gait = Gait { velocity: DVec2::ZERO, ..Gait::still(side.other()) };
        return;
    }
    let rhythm = rhythm_now(params, physique, state);
    let ticks = (rhythm.step / dt).round() - ((rhythm.step - rhythm.double) / dt).round().max(2.0);
    enter(state, Phase::Double, side.other(), ticks.max(0.0) * dt);
    if !params.rolls {
        state.cop = contact(params, state, side);
        state.gait.from = state.cop;
    }
}

/// Where the bare pendulum touches the ground.
fn contact(params: &Params, state: &State, side: Side) -> DVec2 {
    let foot = &state.feet[side as usize];
    ground(foot.ankle) + super::support::forward(foot.yaw) * params.com_forward
}

/// Where `side` should land when it lifts in `wait` s and flies for `time` s.
fn landing(params: &Params, physique: &Physique, state: &State, side: Side, wait: f64, time: f64) -> Aim {
    let gait = &state.gait;
    let omega = state.omega();
    let stance = &state.feet[side.other() as usize];
    let rear = ground(stance.ankle);
    let rhythm = rhythm_now(params, physique, state);
    let toe = super::support::forward(stance.yaw);
    let (mut com, mut velocity) = (ground(state.com) + lean(physique, state), ground(state.velocity));
    let mut cop = state.cop;
    if wait > 0.0 {
        let early = rear + toe * rhythm.roll[0];
        (com, velocity) = gait::carried(com, velocity, [cop, early], omega, wait);
        cop = early;
    }
    if time > 0.0 {
        (com, velocity) = gait::carried(com, velocity, [cop, rear + toe * rhythm.roll[1]], omega, time);
    }
    let out = state.aside() * side.sign();
    let yaw = state.facing + side.sign() * physique.toe_out;
    let wanted = if gait.last {
        let residue = out * (0.5 * params.width) - state.ahead * params.com_forward;
        let speed = velocity.length();
        let distance = crate::maths::pendulum::step_distance(speed, 0.0, state.com.y, 0.0);
        com + velocity.normalize_or_zero() * distance + residue
    } else {
        let step = gait::pivot(&rhythm, omega, side, [stance.yaw, yaw], state.ahead, gait.velocity);
        let way = gait.velocity.normalize_or(state.ahead);
        let bias = params.walk_bias * (state.com.y - physique.com_height);
        step.landing(rear, (com, velocity), (omega, state.com.y.max(0.1), 0.0, bias), way)
    };
    let from = match state.swing {
        Some(swing) if swing.side == side => ground(swing.from.ankle),
        _ => ground(state.feet[side as usize].ankle),
    };
    let fly = match state.swing {
        Some(swing) if swing.side == side => swing.land - swing.lift,
        _ => time,
    };
    let ankle = bounded(params, physique, state, (wanted, from, rear, out), com, fly);
    Aim { plant: gait::plant(physique, state, side, ankle), off: ankle.distance(wanted) }
}

/// The nearest landing that legs can do.
fn bounded(
    params: &Params,
    physique: &Physique,
    state: &State,
    (wanted, from, rear, out): (DVec2, DVec2, DVec2, DVec2),
    com: DVec2,
    fly: f64,
) -> DVec2 {
    let hip = com - state.ahead * params.com_forward + out * (0.5 * params.width);
    let far = params.ankle_speed * fly / swing::WALK_PEAK;
    let foot = physique.tip - physique.heel;
    let mut ankle = wanted;
    for _ in 0..2 {
        ankle = hip + (ankle - hip).clamp_length_max(params.reach);
        ankle = from + (ankle - from).clamp_length_max(far);
        let relative = ankle - rear;
        let past = (relative.dot(state.ahead).abs() / foot).min(1.0);
        let gap = params.step_gap * (1.0 - 0.7 * past * past);
        ankle += out * (gap - relative.dot(out)).max(0.0);
    }
    ankle
}

fn lean(physique: &Physique, state: &State) -> DVec2 {
    let omega = state.omega();
    state.gait.lasting / (physique.mass * omega * omega)
}

/// The landing of the step in the air, aimed again.
pub fn replan(params: &Params, physique: &Physique, state: &State, swing: &Swing) -> Plant {
    landing(params, physique, state, swing.side, 0.0, (swing.land - state.time).max(0.0)).plant
}

/// The centre of pressure at the end of this tick; `None` where the gait is not in charge of it.
pub fn pressure(params: &Params, physique: &Physique, state: &mut State, dt: f64) -> Option<DVec2> {
    let gait = state.gait;
    let stance = state.feet[gait.side.other() as usize];
    let rear = ground(stance.ankle);
    let rhythm = rhythm_now(params, physique, state);
    let toe = super::support::forward(stance.yaw);
    let along = ((state.time + 0.5 * dt - gait.since) / (gait.until - gait.since).max(dt)).clamp(0.0, 1.0);
    match gait.phase {
        Phase::Rest => None,
        Phase::Start => Some(prepare(params, physique, state, &rhythm, dt)),
        Phase::Double if !params.rolls => Some(state.cop),
        Phase::Double => Some(gait.from.lerp(rear + toe * rhythm.roll[0], along)),
        Phase::Single if state.swing.is_none_or(|swing| swing.kind != StepKind::Walk) => None,
        Phase::Single if !params.rolls => Some(contact(params, state, gait.side.other())),
        Phase::Single => {
            let late = rear + toe * rhythm.roll[1];
            let left_over = (gait.until - state.time).max(0.0);
            let wanted = feedback(params, physique, state, &rhythm, (late, left_over));
            let shift = gait.shift + (wanted - gait.shift) * (1.0 - (-dt / params.lag).exp());
            let sole = Support::one(params, physique, &stance, Tread::Whole, params.margin);
            let roll = gait.from.lerp(late, along);
            let fading = ((1.0 - along) / 0.3).min(1.0);
            let at = sole.nearest(roll + shift * fading);
            state.gait.shift = shift;
            Some(at)
        }
    }
}

/// How far the pressure should be off its roll for the step to come out as a steady one would.
fn feedback(
    params: &Params,
    physique: &Physique,
    state: &State,
    rhythm: &Rhythm,
    (late, left_over): (DVec2, f64),
) -> DVec2 {
    let gait = &state.gait;
    let omega = state.omega();
    let roll = gait.from.lerp(late, ((state.time - gait.since) / (gait.until - gait.since)).clamp(0.0, 1.0));
    let (com, velocity) = (ground(state.com) + lean(physique, state), ground(state.velocity));
    let (com, velocity) = gait::carried(com, velocity, [roll, late], omega, left_over);
    let wanted = steady_xi(physique, state, rhythm, gait.side);
    let mut error = com + velocity / omega - wanted;
    if gait.last {
        let stance = ground(state.feet[gait.side.other() as usize].ankle);
        let middle = stance + state.aside() * (0.5 * gait.side.sign() * params.width);
        error = state.aside() * (error + wanted - middle).dot(state.aside());
    }
    error * (params.walk_gain / ((omega * left_over.max(0.2 * params.tempo)).exp() - 1.0))
}

/// ξ at the touchdown of a step as long and as wide as the steady ones.
fn steady_xi(physique: &Physique, state: &State, rhythm: &Rhythm, side: Side) -> DVec2 {
    let gait = &state.gait;
    let stance = &state.feet[side.other() as usize];
    let rear = ground(stance.ankle);
    let ankle = rear + gait.velocity * rhythm.step + state.aside() * (side.sign() * rhythm.width);
    let yaw = state.facing + side.sign() * physique.toe_out;
    gait::pivot(rhythm, state.omega(), side, [stance.yaw, yaw], state.ahead, gait.velocity).xi_for(rear, ankle)
}

/// The pressure that brings the weight over the stance foot and forward of it, first away from it.
fn prepare(params: &Params, physique: &Physique, state: &State, rhythm: &Rhythm, dt: f64) -> DVec2 {
    let gait = &state.gait;
    let omega = state.omega();
    let stance = &state.feet[gait.side.other() as usize];
    let early = ground(stance.ankle) + super::support::forward(stance.yaw) * params.com_forward;
    let late = ground(stance.ankle) + super::support::forward(stance.yaw) * rhythm.roll[1];
    let over = 0.16 * params.tempo;
    let left_over = (gait.until - state.time).max(0.0);
    if left_over <= over {
        let share = (dt / left_over.max(dt)).min(1.0);
        return state.cop + (early - state.cop) * share;
    }
    let single = (rhythm.step - rhythm.double).min(params.brief);
    let landing = steady_xi(physique, state, rhythm, gait.side);
    let [one, two] = gait::weights(omega, 0.0, single);
    let at_lift = landing * (-omega * single).exp() + early * one + late * two;
    let hold = left_over - over;
    let kept = (-omega * hold).exp();
    let [one, two] = gait::weights(omega, hold, over);
    let xi = state.xi() + lean(physique, state);
    let pivot = (xi - at_lift * (-omega * left_over).exp() - early * two) / (1.0 - kept + one);
    let pivot = state.inset.nearest(pivot);
    state.cop + (pivot - state.cop) * (1.0 - (-dt / params.lag).exp())
}
