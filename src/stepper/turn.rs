//! Turning: the pelvis follows the wanted facing at a pace that feet and speed allow; the gait's velocity turns with it, and
//! on the spot the feet step when the twist is more than comfort allows. Radians about +Y, scenario space.

use super::control::wrap;
use super::{Inputs, Params, Physique, State, support};
use crate::model::Side;
use glam::DVec2;

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
    let most = 1.6_f64.min(1.0 / pace.max(0.1)) / params.tempo;
    let mut wanted = (left_over * 4.0 / params.tempo).clamp(-most, most);
    if wanted * ahead_of_feet > 0.0 {
        wanted *= (1.0 - (ahead_of_feet.abs() - 0.4) / 0.25).clamp(0.0, 1.0);
    }
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
    let (sin, cos) = angle.sin_cos();
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
