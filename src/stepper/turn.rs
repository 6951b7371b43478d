//! Turning: the pelvis follows the wanted facing at a pace that feet and speed allow; the gait's velocity turns with it, and
//! on the spot the feet step when the twist is more than comfort allows. Radians about +Y, scenario space.

use super::control::wrap;
use super::walk::Phase;
use super::{Inputs, Params, Physique, State, ground, support};
use crate::maths::real;
use crate::model::Side;
use glam::DVec2;

/// rad, the foot on the inside of a turn on the spot opens out by no more.
const OPEN: f64 = 0.95;
/// rad, the other one comes round past it by no more.
const CLOSE: f64 = 0.17;

/// Turns the pelvis on by a tick.
pub fn face(params: &Params, physique: &Physique, state: &mut State, inputs: &Inputs, dt: f64) {
    let left_over = wrap(inputs.facing - state.facing);
    state.gait.goal = left_over;
    if left_over == 0.0 && state.gait.turn == 0.0 && !state.gait.turning {
        return;
    }
    let ahead_of_feet = twist(physique, state);
    let to_turn = (left_over + ahead_of_feet).abs();
    state.gait.turning = to_turn > if state.gait.turning { params.turned } else { params.twist_most };
    let pace = state.gait.velocity.length() * params.tempo / params.size;
    let most = params.turn_rate.min(1.0 / pace.max(0.1) / params.tempo);
    let mut wanted = (left_over * 4.0 / params.tempo).clamp(-most, most);
    if wanted * ahead_of_feet > 0.0 {
        let (free, gone) = if state.gait.spot { (0.1, 0.35) } else { (0.4, 0.25) };
        wanted *= (1.0 - (ahead_of_feet.abs() - free) / gone).clamp(0.0, 1.0);
    }
    // on the spot the turn comes to its end, and not ever nearer to it
    let creep = if state.gait.spot || state.gait.phase == Phase::Rest { 0.02 / params.tempo } else { 0.0 };
    wanted += (creep * left_over.signum()).clamp(-left_over.abs() / dt, left_over.abs() / dt);
    let quicker = 8.0 * dt / (params.tempo * params.tempo);
    state.gait.turn += (wanted - state.gait.turn).clamp(-quicker, quicker);
    let step = state.gait.turn * dt;
    let step = if left_over.abs() < 1e-4 && step.abs() < 1e-4 {
        state.gait.turn = 0.0;
        left_over
    } else {
        step
    };
    state.facing += step;
    state.ahead = support::forward(state.facing);
    state.gait.velocity = rotated(state.gait.velocity, step);
}

/// Where the next foot of a turn on the spot lands, its sole's middle line included: the foot on the inside of the turn
/// opens out, the other one comes round to it, both on one circle.
pub fn around(params: &Params, physique: &Physique, state: &State, side: Side) -> (DVec2, f64) {
    let stance = &state.feet[side.other() as usize];
    let (stands, left_over) = to_go(physique, state, side);
    let most = if left_over * side.sign() > 0.0 { OPEN } else { CLOSE };
    let faces = stands + left_over.clamp(-most, most);
    let half = 0.5 * params.width * side.sign();
    let ankle = ground(stance.ankle) + (support::left(stands) + support::left(faces)) * half;
    (ankle, faces + side.sign() * physique.toe_out)
}

/// Does the step of that foot end the turn, the other one being there?
pub fn closes(physique: &Physique, state: &State, side: Side) -> bool {
    to_go(physique, state, side).1.abs() < CLOSE
}

/// Where the body would face that the foot which stands stands for, and how far that is from where it is wanted to.
fn to_go(physique: &Physique, state: &State, side: Side) -> (f64, f64) {
    let stance = &state.feet[side.other() as usize];
    let stands = stance.yaw + side.sign() * physique.toe_out;
    (stands, wrap(state.facing - stands) + state.gait.goal)
}

/// How far the pelvis will have turned in that time.
pub fn turned_in(state: &State, time: f64) -> f64 {
    let most = state.gait.goal.abs();
    (state.gait.turn * time).clamp(-most, most)
}

/// The vector (x, z) turned to the left by that angle.
pub fn rotated(vector: DVec2, angle: f64) -> DVec2 {
    if angle == 0.0 {
        return vector;
    }
    let (sin, cos) = real::sin_cos(angle);
    DVec2::new(vector.x * cos + vector.y * sin, vector.y * cos - vector.x * sin)
}

/// How far the pelvis has turned past the feet.
fn twist(physique: &Physique, state: &State) -> f64 {
    let past = |side: Side| {
        let foot = match state.swing {
            Some(swing) if swing.side == side => swing.to,
            _ => state.feet[side as usize],
        };
        wrap(state.facing - (foot.yaw - side.sign() * physique.toe_out))
    };
    0.5 * (past(Side::Left) + past(Side::Right))
}
