//! The spring legs and the flight of the centre of mass: height by springs whose rest lengths the feet set, level motion
//! by the lean over the centre of pressure, the push on top.

use super::{Inputs, Params, Phase, Physique, State, StepKind, grip, ground, rise, swing};
use crate::maths::pendulum::{self, GRAVITY};
use crate::maths::real;
use crate::model::Side;
use glam::{DVec2, DVec3};

/// Moves the centre of mass on by `dt` s.
pub fn integrate(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, dt: f64) {
    let walking = matches!(state.gait.phase, Phase::Single | Phase::Double);
    let legs = if walking { physique.com_height } else { rest_height(params, physique, state) };
    let rest = legs.min(physique.com_height - state.arc) + state.carried.height;
    let push = inputs.force / physique.mass;
    // equation 3, x the legs' error of length and v its rate: a rest length that changes takes the damper along
    let (x, v) = (state.com.y - rest, state.velocity.y - state.carried.rate);
    let spring = (-params.spring * x - params.damper * v) / physique.mass;
    let wanted = match &state.swing {
        // the stance leg gives way, so that the fall is caught by the landing foot and not pushed on by the other
        Some(swing) if swing.kind == StepKind::Corrective => {
            let left_over = (swing.land - state.time).max(dt);
            let lands = landing_height(params, physique, state) + rise::at_landing(state);
            let drop = lands - state.com.y - state.velocity.y * left_over;
            (2.0 * params.give * drop / (left_over * left_over)).min(0.0)
        }
        _ => spring,
    };
    let lift = state.lift
        + (wanted.clamp(-0.35 * GRAVITY, 1.0 * GRAVITY) - state.lift) * (1.0 - real::exp(-dt / params.leg_lag));
    let lift = if params.leg_change { lift } else { 0.0 };
    let lift = if lift.abs() < 1e-12 * GRAVITY { 0.0 } else { lift };
    state.lift = lift;
    let tip = state.tip * (1.0 / (0.2 * params.tempo));
    state.tip -= tip * dt;
    // in the gait at the tick's middle, so that ξ grows as the closed form says
    let half = if state.gait.phase == Phase::Rest { 0.0 } else { 0.5 * dt };
    let middle = ground(state.com) + ground(state.velocity) * half;
    // the ground's force runs from the pressure to the centre of mass
    let over = if params.leg_change { state.com.y - rise::under_pressure(state, state.cop) } else { state.height() };
    let height = over.max(0.5 * params.low);
    let flat = grip::held(state, (middle - state.cop) * ((GRAVITY + lift) / height), GRAVITY + lift) + tip;
    let acceleration = DVec3::new(flat.x + push.x, lift + push.y, flat.y + push.z);
    state.com += state.velocity * dt + acceleration * (0.5 * dt * dt);
    state.velocity += acceleration * dt;
    if !params.leg_change {
        // along the line of the footholds: on such a path a pendulum's level motion is the flat one's (Kajita 2001)
        let below = rise::under(state, ground(state.com));
        (state.velocity.y, state.com.y) = ((below - state.carried.height) / dt, physique.com_height + below);
        state.carried.height = below;
    }
    state.acceleration = acceleration;
    let off = Side::BOTH
        .into_iter()
        .filter(|&side| state.planted(side))
        .map(|side| {
            let foot = ground(state.feet[side as usize].ankle);
            let away = hip(params, ground(state.com), state.ahead, side) - foot;
            if walking {
                away.dot(state.gait.velocity.normalize_or(state.ahead)).powi(2)
            } else {
                away.length_squared()
            }
        })
        .fold(f64::INFINITY, f64::min);
    let height = physique.com_height;
    let off = if walking { off.min(0.23 * physique.leg_length * physique.leg_length) } else { off };
    // on stairs the treads say how high; sideways the legs fold less
    let free = walking && state.gait.longest.is_infinite();
    let along = if free { state.gait.velocity.normalize_or(state.ahead).dot(state.ahead).powi(4) } else { 0.0 };
    let share = params.slip_arc + (params.walk_arc - params.slip_arc) * along;
    let arc = share * (height - (height * height - off.min(0.5 * height * height)).sqrt());
    state.arc += (arc - state.arc) * (1.0 - real::exp(-dt / (0.06 * params.tempo)));
}

/// The height that the legs allow: each spring's rest length makes up for gravity, the longest is the whole leg.
fn rest_height(params: &Params, physique: &Physique, state: &State) -> f64 {
    let mut height = physique.com_height;
    for side in Side::BOTH {
        let (ankle, weight) = match &state.swing {
            Some(swing) if swing.side == side => {
                let u = swing::phase(swing, state.time);
                (ground(swing.to.ankle), u * u * (3.0 - 2.0 * u))
            }
            _ => (ground(state.feet[side as usize].ankle), 1.0),
        };
        let allowed = leg_height(params, physique, (ground(state.com), state.ahead), side, ankle);
        height = height.min(physique.com_height + (allowed - physique.com_height) * weight);
    }
    height.max(0.7 * physique.com_height)
}

/// The height that the legs will allow when the swing lands.
fn landing_height(params: &Params, physique: &Physique, state: &State) -> f64 {
    let Some(swing) = &state.swing else { return physique.com_height };
    let left_over = (swing.land - state.time).max(0.0);
    let stance = &state.feet[swing.side.other() as usize];
    let (com, _) = pendulum::predict(ground(state.com), ground(state.velocity), state.cop, state.omega(), left_over);
    let new = leg_height(params, physique, (com, state.ahead), swing.side, ground(swing.to.ankle));
    let old = leg_height(params, physique, (com, state.ahead), swing.side.other(), ground(stance.ankle));
    new.min(old).max(0.84 * physique.com_height)
}

/// The centre of mass's height with that leg stretched.
fn leg_height(params: &Params, physique: &Physique, (com, ahead): (DVec2, DVec2), side: Side, ankle: DVec2) -> f64 {
    let hip = hip(params, com, ahead, side);
    let across = hip - ankle;
    let behind = across.dot(ahead).max(0.0) / physique.leg_length;
    let upright = physique.hip_height - physique.ankle_height;
    let leg = params.leg_span.max(upright) + 0.07 * params.size * (2.5 * behind).min(1.0);
    let tall = (leg * leg - across.length_squared()).max(0.0).sqrt();
    physique.com_height + (tall - upright).min(0.0)
}

/// Where that hip is over the ground.
pub fn hip(params: &Params, com: DVec2, ahead: DVec2, side: Side) -> DVec2 {
    com - ahead * params.com_forward + DVec2::new(ahead.y, -ahead.x) * (0.5 * side.sign() * params.width)
}
