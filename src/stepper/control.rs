//! The tick: perceive, decide, plan, move the centre of pressure, integrate, land. Scenario space, SI units.

use super::foothold::{ankles, middle};
use super::{Inputs, Params, Physique, State, Step, StepKind, Swing, TickOutput};
use super::{balance::pressure, decide, footing, grip, ground, legs, pace, rise, roll, stand, swing, turn, walk};
use crate::maths::pendulum::GRAVITY;
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// One tick of `dt` s. Does nothing once balance is lost.
pub fn tick(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &mut State,
    inputs: &Inputs,
    dt: f64,
) -> TickOutput {
    let mut output = TickOutput::default();
    if state.lost.is_some() {
        return output;
    }
    perceive(params, physique, state, inputs, dt);
    state.gait.grip = grip::longest(params, physique, state);
    walk::steer(params, physique, terrain, state, inputs, dt);
    let inputs = &walk::halted(state, inputs);
    rise::foresee(params, physique, terrain, state);
    if state.swing.is_none() {
        let (mut busy, mut lifted) = (false, None);
        if state.gait.phase == walk::Phase::Rest {
            (busy, lifted) = stand::both_down(params, physique, state, inputs);
        }
        if !busy {
            (busy, lifted) = walk::both_down(params, physique, terrain, state, inputs, dt);
        }
        output.lifted = lifted;
        if !busy {
            decide::decide(params, physique, state);
            output.lifted = decide::lift(params, physique, terrain, state, dt);
        }
    }
    stand::hold(params, physique, terrain, state, inputs, dt);
    decide::replan(params, physique, terrain, state, dt);
    if let Some(cop) = roll::pressure(params, physique, terrain, state, dt) {
        state.cop = cop;
    } else {
        let one = stand::pressure(params, physique, state);
        let wanted = one.unwrap_or_else(|| pressure(params, physique, state));
        state.cop += (wanted - state.cop) * (1.0 - real::exp(-dt / params.lag));
    }
    rise::follow(params, physique, terrain, state, dt);
    legs::integrate(params, physique, state, inputs, dt);
    state.tick += 1;
    state.time = state.tick as f64 * dt;
    output.landed = advance(params, physique, terrain, state, dt);
    footing::carry(terrain, params, physique, state);
    judge(params, state, dt);
    output.lost = state.lost.is_some();
    output
}

/// What it feels of a push, where its pelvis turns, how long it has been disturbed.
pub(super) fn perceive(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, dt: f64) {
    let force = ground(inputs.force);
    let slow = if force.length_squared() > state.felt.length_squared() { 0.8 * params.tempo } else { params.sense };
    state.felt += (force - state.felt) * (1.0 - real::exp(-dt / slow));
    let tipping = inputs.moment.cross(DVec3::Y) / (physique.mass * physique.com_height);
    state.tip += ground(tipping) * (params.tipping * dt);
    if state.felt.length() < 1e-9 * physique.mass {
        state.felt = DVec2::ZERO;
    }
    turn::face(params, physique, state, inputs, dt);
    state.settled += dt;
    state.recovering += dt;
    let aim = middle(params, state.ahead, ankles(state));
    // what lasts is no shove to who leads a body: under 80 N it gave up its steps as if struck at each of them
    let lasts = if params.trims { DVec2::ZERO } else { state.gait.lasting };
    let shoved = shoved(physique, state, force - lasts, dt);
    state.touch += (force - state.touch) * (1.0 - real::exp(-dt / (0.5 * params.sense)));
    state.pushed = if shoved { state.pushed + dt } else { 0.0 };
    if shoved || (state.xi() - aim).length() > 0.03 * params.size {
        state.alarm += dt;
    } else if state.calm >= params.pause - params.instant && state.intent.is_none() {
        state.alarm = 0.0;
    }
}

/// Is it being shoved, by a force (N) that no one takes for a breeze? Keeps the time since then.
pub(super) fn shoved(physique: &Physique, state: &mut State, force: DVec2, dt: f64) -> bool {
    let shoved = force.length() > 0.08 * physique.mass * GRAVITY;
    state.shoved = if shoved { 0.0 } else { state.shoved + dt };
    shoved
}

/// Moves the swinging foot; sets it down when its time is up.
fn advance(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) -> Option<Step> {
    let swing = state.swing?;
    if state.time < swing.land - 0.5 * dt {
        state.feet[swing.side as usize] = swing::along(params, &swing, state.time);
        return None;
    }
    state.feet[swing.side as usize] = swing.to;
    Some(landed(params, physique, terrain, state, &swing))
}

/// The foot of that swing is down, where [`State::feet`] has it.
pub(super) fn landed(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &mut State,
    swing: &Swing,
) -> Step {
    state.swing = None;
    let from = state.held[swing.side as usize];
    let to = footing::to_ground(&state.feet[swing.side as usize], terrain.turn(state.time));
    state.held[swing.side as usize] = to;
    state.hold(params, physique);
    state.settled = 0.0;
    state.last = Some(swing.side);
    if swing.kind != StepKind::Comfort {
        state.recovering = 0.0;
    }
    if swing.kind == StepKind::Walk {
        pace::landed(params, physique, state);
        walk::landed(params, physique, state, swing.side);
    }
    let Swing { side, kind, lift, .. } = *swing;
    let lift = state.one.lifted.take().unwrap_or(lift);
    Step { side, kind, lift, land: state.time, from, to }
}

/// Keeps the clocks of rest and of failure.
fn judge(params: &Params, state: &mut State, dt: f64) {
    let com = ground(state.com);
    let speed = state.velocity.length();
    let (slow, slow_for_its_size) = (speed < 0.05, speed < 0.05 * params.size / params.tempo);
    let held = (slow || slow_for_its_size) && state.swing.is_none() && { state.outline.outside(state.xi()) <= 0.0 };
    state.rest = if held && slow { state.rest + dt } else { 0.0 };
    state.calm = if held && slow_for_its_size { state.calm + dt } else { 0.0 };
    let near = Side::BOTH
        .into_iter()
        .filter(|&side| state.planted(side))
        .map(|side| legs::hip(params, com, state.ahead, side).distance(ground(state.feet[side as usize].ankle)))
        .fold(f64::INFINITY, f64::min);
    let finite = com.is_finite() && state.com.y.is_finite();
    if state.height() < params.low || near > params.lean || !finite {
        state.lost = Some(state.time);
    }
}

/// The same angle within half a turn.
pub fn wrap(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}
