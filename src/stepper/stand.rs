//! Standing on one foot: the weight goes over it, the other one is lifted beside it and held, by ankle feedback alone;
//! a push that this cannot hold is caught with the lifted foot. On command it comes down again. Ground plane (x, z), metres.

use super::balance::steady_lean;
use super::foothold::corrective;
use super::support::{Support, Tread};
use super::{Inputs, Params, Passing, Physique, State, StepKind, Swing, footing, ground};
use crate::model::scenario::Feet;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// What standing on one foot remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OneFoot {
    /// The foot that carries, or is about to.
    pub stance: Option<Side>,
    /// s, when a held foot was lifted that has to be put down in haste.
    pub lifted: Option<f64>,
}

/// The foot that is meant to carry alone.
fn wanted(inputs: &Inputs) -> Option<Side> {
    if inputs.walk.is_some_and(|walk| walk != DVec2::ZERO) {
        return None;
    }
    match inputs.stand {
        Feet::Both => None,
        Feet::Left => Some(Side::Left),
        Feet::Right => Some(Side::Right),
    }
}

/// With both feet down: is the weight being shifted onto one? Lifts the other when it is.
pub fn both_down(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs) -> (bool, Option<Side>) {
    let Some(stance) = wanted(inputs) else {
        state.one.stance = None;
        return (false, None);
    };
    let ready = state.one.stance.is_some() || (state.calm >= params.pause - params.instant && state.intent.is_none());
    let safe = state.outline.outside(state.xi() + steady_lean(physique, state)) <= -params.margin;
    if !ready || !safe {
        state.one.stance = None;
        return (false, None);
    }
    state.one.stance = Some(stance);
    state.intent = None;
    let foot = &state.feet[stance as usize];
    let sole = Support::one(params, physique, foot, Tread::Whole, params.margin);
    let off = state.xi() + steady_lean(physique, state) - over(params, state, stance);
    if off.length() > 0.012 * params.size
        || sole.outside(state.cop) > 0.0
        || state.velocity.length() > 0.06 * params.size / params.tempo
    {
        return (true, None);
    }
    let side = stance.other();
    let from = state.feet[side as usize];
    state.swing = Some(Swing {
        side,
        kind: StepKind::Held,
        lift: state.time,
        land: f64::INFINITY,
        from,
        to: from,
        off: 0.0,
        aim: ground(from.ankle),
        passing: Passing::Own,
        round: state.aside() * side.sign(),
        detour: DVec2::ZERO,
    });
    (true, Some(side))
}

/// With a foot held in the air: puts it down on command, or in haste where the other one cannot hold.
pub fn hold(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, inputs: &Inputs, dt: f64) {
    let Some(mut swing) = state.swing.filter(|swing| swing.kind == StepKind::Held) else { return };
    let stance = swing.side.other();
    let place = footing::from_ground(&state.held[swing.side as usize], terrain.turn(state.time));
    (swing.from, swing.to) = (place, place);
    let sole = Support::one(params, physique, &state.feet[stance as usize], Tread::Whole, 0.0);
    if sole.outside(state.xi() + steady_lean(physique, state)) > 0.0 {
        let ticks = (0.75 * params.swing / dt).round().max(2.0);
        let now = state.feet[swing.side as usize];
        state.one = OneFoot { stance: None, lifted: Some(swing.lift) };
        let mut best = (f64::INFINITY, Passing::Own, place);
        for passing in [Passing::Own, Passing::Front, Passing::Behind] {
            let foothold = corrective(params, physique, state, swing.side, passing, (ticks * dt, ticks * dt));
            let price = foothold.miss + 0.3 * foothold.off + 0.1 * foothold.across;
            if price < best.0 {
                best = (price, passing, foothold.plant);
            }
        }
        let round = match best.1 {
            Passing::Own => swing.round,
            Passing::Front => state.ahead,
            Passing::Behind => -state.ahead,
        };
        let (lift, land) = (state.time, state.time + ticks * dt);
        let (passing, aim) = (best.1, ground(best.2.ankle));
        let by = state.feet[stance as usize];
        let to = footing::set_down_by(terrain, physique, &by, aim, (best.2.yaw, land));
        swing = Swing { kind: StepKind::Corrective, lift, land, from: now, to, aim, passing, round, ..swing };
    } else if swing.land.is_infinite() && wanted(inputs) != Some(stance) {
        let ticks = (params.comfort_swing / dt).round().max(2.0);
        swing.land = state.time.max(swing.lift + ticks * dt) + ticks * dt;
    }
    state.swing = Some(swing);
}

/// Where the pressure is wanted; `None` where this is not in charge.
pub fn pressure(params: &Params, physique: &Physique, state: &State) -> Option<DVec2> {
    let xi = state.xi() + steady_lean(physique, state);
    match &state.swing {
        Some(swing) if swing.kind == StepKind::Held => {
            let stance = swing.side.other();
            let foot = &state.feet[stance as usize];
            let sole = Support::one(params, physique, foot, Tread::Whole, 0.5 * params.margin);
            let aim = over(params, state, stance);
            Some(sole.nearest(xi + (xi - aim) * 1.2))
        }
        None => {
            let error = xi - over(params, state, state.one.stance?);
            Some(state.inset.nearest(xi + error.clamp_length_max(0.08 * params.size)))
        }
        Some(_) => None,
    }
}

/// The point over which the body stands on that foot.
fn over(params: &Params, state: &State, stance: Side) -> DVec2 {
    let foot = &state.feet[stance as usize];
    ground(foot.ankle) + super::support::forward(foot.yaw) * params.com_forward
}

/// m, how high a held foot is at that time: up, held, down to its landing.
pub fn height(params: &Params, swing: &Swing, time: f64) -> f64 {
    let eased = |u: f64| {
        let u = u.clamp(0.0, 1.0);
        u * u * (3.0 - 2.0 * u)
    };
    let up = eased((time - swing.lift) / params.comfort_swing);
    let down = if swing.land.is_finite() { eased((swing.land - time) / params.comfort_swing) } else { 1.0 };
    1.2 * params.lift_height * up.min(down)
}
