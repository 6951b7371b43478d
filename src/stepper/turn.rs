//! Turning: the pelvis follows the wanted facing at a pace that feet and speed allow; the gait's velocity turns with it, and
//! on the spot the feet step when the twist is more than comfort allows. Radians about +Y, scenario space.

use super::control::wrap;
use super::walk::Phase;
use super::{Inputs, Params, Physique, State, ground, support};
use crate::maths::real;
use crate::model::Side;
use glam::DVec2;

/// rad, the foot on the inside of a turn on the spot opens out by no more: 62 degrees, of which the hip that turns out does half and the
/// pelvis, on its way, the rest.
const OPEN: f64 = 1.09;
/// rad, the other one comes round past it by no more, so that 90 degrees are three steps.
const CLOSE: f64 = 0.45;
/// rad, by which it comes round past it and still stands beside it as usual; m of the reference body a radian, how much wider it is set
/// from there on: its toes point to the other foot. With 0 legs come within 11 cm of each other, with these 13 cm.
const BESIDE: f64 = 0.17;
const WIDER: f64 = 0.2;
/// rad, the step that comes within so much of where both feet are to point is the last one.
const ENDS: f64 = 0.12;
/// rad/s of the reference body, how fast the pelvis turns on the spot, and 1/s, how it slows towards the end: people turn by 90 degrees in
/// 1.2 to 1.5 s.
const RATE: f64 = 2.2;
const SLOWS: f64 = 6.0;
/// rad, by which the pelvis turns ahead of the feet freely, and by which more it is held back for good: on the spot, and in a walk. With
/// 0.1 and 0.35 on the spot, feet that landed short kept it waiting for seconds.
const FREE: [(f64, f64); 2] = [(0.3, 0.3), (0.4, 0.25)];

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
    let on_spot = state.gait.spot || state.gait.phase == Phase::Rest;
    let (fastest, slows) = if on_spot { (RATE / params.tempo, SLOWS) } else { (params.turn_rate, 4.0) };
    let most = fastest.min(1.0 / pace.max(0.1) / params.tempo);
    let mut wanted = (left_over * slows / params.tempo).clamp(-most, most);
    if wanted * ahead_of_feet > 0.0 {
        let (free, gone) = FREE[usize::from(!on_spot)];
        wanted *= (1.0 - (ahead_of_feet.abs() - free) / gone).clamp(0.0, 1.0);
    }
    // on the spot the turn comes to its end, and not ever nearer to it
    let creep = if on_spot { 0.02 / params.tempo } else { 0.0 };
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
    let opens = left_over * side.sign() > 0.0;
    let most = if opens { OPEN } else { CLOSE };
    let faces = stands + left_over.clamp(-most, most);
    let past = if opens { 0.0 } else { (left_over.abs().min(most) - BESIDE).max(0.0) };
    let half = 0.5 * (params.width + WIDER * params.size * past) * side.sign();
    let ankle = ground(stance.ankle) + (support::left(stands) + support::left(faces)) * half;
    (ankle, faces + side.sign() * physique.toe_out)
}

/// Does the step of that foot end the turn, the other one being there?
pub fn closes(physique: &Physique, state: &State, side: Side) -> bool {
    to_go(physique, state, side).1.abs() < ENDS
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
        // Who has taken no step yet stands as at rest.
        let rests = state.gait.phase == Phase::Rest && !state.gait.turning;
        let out = if rests { physique.points(side) } else { side.sign() * physique.toe_out };
        wrap(state.facing - (foot.yaw - out))
    };
    0.5 * (past(Side::Left) + past(Side::Right))
}
