//! Ankle feedback: where under the feet the pressure goes. It stays inside what carries, so the motion is one that a
//! ground without glue allows. Ground plane (x, z), metres.

use super::foothold::{ankles, middle, middle_after, over_foot};
use super::support::{Support, Tread};
use super::{Params, Passing, Physique, State, StepKind, ground};
use crate::maths::pendulum;
use crate::maths::real;
use glam::DVec2;

/// Where the pressure is wanted, inside what carries.
pub fn pressure(params: &Params, physique: &Physique, state: &State) -> DVec2 {
    let lean = steady_lean(physique, state);
    let xi = state.xi() + lean;
    if let Some(swing) = &state.swing {
        let stance = &state.feet[swing.side.other() as usize];
        let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
        let left_over = (swing.land - state.time).max(0.1 * params.tempo);
        if swing.kind == StepKind::Corrective {
            let fin = over_foot(params, state, swing.side, swing.passing, &swing.to);
            return braking(params, state, swing.passing, &sole, (xi, fin), left_over);
        }
        let fin = middle(params, state.ahead, [ground(stance.ankle), ground(swing.to.ankle)]);
        return sole.nearest(pendulum::pivot_for(xi, fin, state.omega(), left_over));
    }
    let mut aim = middle(params, state.ahead, ankles(state));
    if let Some(intent) = state.intent {
        let stance = &state.feet[intent.side.other() as usize];
        let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
        if intent.kind == StepKind::Corrective {
            return sole.nearest(xi);
        }
        let time = if intent.kind == StepKind::Comfort { params.comfort_swing } else { params.follow_swing };
        let fin = middle_after(params, state, intent.side);
        let pivot = pendulum::pivot_for(xi, fin, state.omega(), time);
        if intent.committed {
            return sole.nearest(pivot);
        }
        let stand = ground(stance.ankle) + state.ahead * params.com_forward;
        aim = stand + (fin - stand) * real::exp(-state.omega() * time);
    }
    let error = xi - aim;
    let far = (error.length() / params.inner).min(1.0);
    let awake = (state.alarm / params.delay).min(1.0);
    let far = if state.intent.is_some() { 1.0 } else { far };
    // The ankles answer a shove gradually: until they do, the pressure stays under the centre of mass.
    let answer = if state.alarm > 0.0 { (state.alarm / (0.5 * params.delay)).min(1.0) } else { 1.0 };
    let com = ground(state.com);
    state.inset.nearest(com + (xi - com) * answer + error * (params.gain * awake * awake * far * far))
}

/// The pressure under the stance foot that slows the fall most; a foot that crosses is met half-way, forward or back,
/// because it cannot land in line.
pub fn braking(
    params: &Params,
    state: &State,
    passing: Passing,
    sole: &Support,
    (xi, fin): (DVec2, DVec2),
    time: f64,
) -> DVec2 {
    if passing == Passing::Own {
        return sole.nearest(xi);
    }
    let ahead = state.ahead;
    let pivot = pendulum::pivot_for(xi, fin, state.omega(), time.max(0.1 * params.tempo));
    sole.nearest(xi + ahead * (pivot - xi).dot(ahead))
}

/// How far the centre of pressure must lie ahead of ξ, along the lasting push, to hold against it.
pub fn steady_lean(physique: &Physique, state: &State) -> DVec2 {
    state.felt / (physique.mass * state.omega() * state.omega())
}
