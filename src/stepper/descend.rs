//! Down flights of stairs and high kerbs by a body of links, one tread at a time: what is not as on the way up ([`super::climb`]).
//!
//! The knee of the foot that stays bends by more than its ankle's range, so its heel comes off about its toes' hinge and its ball alone bears.
//! That ball stands at the edge, the toes over it, and ξ is ahead of it before the other foot leaves: nothing bears behind the ball then. The
//! body goes ahead and down until the other foot stands on the tread below.
//! Scenario space, metres, seconds.

use super::climb::{EDGE, ROOM, STRIDE, floor, tread};
use super::support::Tread;
use super::{Params, Physique, Plant, State, Support, Swing, ascend, ground, support};
use crate::maths::curve::smooth3;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// m of the reference body: so far behind the edge is the ball of a foot from which the other one goes down, and so far from there it may be.
/// Nearer, a foot that creeps hangs over the edge on which it turns, farther off, legs of 0.83 and 1.08 m do not reach the tread below.
const BRINK: [f64; 2] = [0.02, 0.03];
/// m of the reference body: so far ahead of that ball ξ is held before the other foot leaves.
const AHEAD: f64 = 0.018;
/// m of the reference body: a foot that is farther behind comes beside the other before it goes down.
const TRAILS: f64 = 0.25;
/// m of the reference body, between feet of which neither is behind.
const LEVEL: f64 = 0.025;
/// Share of the height of the next tread by which both knees bend before a foot leaves for it, and s of the reference body that they take:
/// from straight knees the foot leaves late, while the body sinks.
const BENDS: [f64; 2] = [0.08, 0.4];
/// Share of a leg's length with which the foot reaches the tread below, and shares of the swing in which the body sinks so far: from when on,
/// and in how much of it.
const LEG: f64 = 1.0;
/// As [`LEG`] says.
const SINKS: [f64; 2] = [0.12, 0.915];
/// m of the reference body: while the ball behind bears, the pressure is so near to the line from there to over the other foot; and of that
/// line's length, how far along it at most.
const ASIDE: f64 = 0.1;
/// As [`ASIDE`] says.
const ALONG: f64 = 1.15;
/// m, m/s of the reference body: the foot behind leaves when ξ is so far inside the sole of the other one and the body is no faster.
const INSIDE: f64 = 0.022;
/// As [`INSIDE`] says.
const CALM: f64 = 0.6;

/// m, from the ankle to the ball.
fn ball(params: &Params, physique: &Physique) -> f64 {
    params.balls.unwrap_or(0.5 * physique.tip)
}

/// m, where along the way an ankle stands whose ball is at that edge.
fn brink(params: &Params, physique: &Physique, edge: f64) -> f64 {
    edge - ball(params, physique) - BRINK[0] * params.size
}

/// Does a foot stand at the edge of its tread?
fn at_brink(params: &Params, physique: &Physique, terrain: &Terrain, foot: &Plant) -> bool {
    let edge = tread(terrain, physique, foot)[1];
    edge.is_finite() && foot.ankle.z > brink(params, physique, edge) - BRINK[1] * params.size
}

/// Is that foot so far behind the other one that it comes beside it before it goes down?
fn trails(params: &Params, state: &State, side: Side) -> bool {
    state.feet[side.other() as usize].ankle.z - state.feet[side as usize].ankle.z > TRAILS * params.size
}

/// Is that foot on a higher tread than the other one?
pub fn above(state: &State, side: Side) -> bool {
    state.feet[side as usize].ankle.y > state.feet[side.other() as usize].ankle.y + EDGE
}

/// The foot that goes next: the one behind.
pub fn next(params: &Params, state: &State) -> Side {
    let before = state.feet[0].ankle.z - state.feet[1].ankle.z;
    if before.abs() < LEVEL * params.size {
        return state.last.map_or(params.lead, Side::other);
    }
    if before < 0.0 { Side::Left } else { Side::Right }
}

/// m, how far along the way that foot is to go: to the edge of the tread, from beside a foot there to the tread below, else beside the other.
pub fn place(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, side: Side) -> f64 {
    let stance = &state.feet[side.other() as usize];
    let edge = tread(terrain, physique, stance)[1];
    if edge.is_infinite() {
        return stance.ankle.z;
    }
    if !at_brink(params, physique, terrain, stance) {
        return brink(params, physique, edge).min(stance.ankle.z + STRIDE * params.size);
    }
    if above(state, side) || trails(params, state, side) {
        return stance.ankle.z;
    }
    let [next, end] = floor(terrain, stance.ankle.x, edge);
    (next - physique.heel + EDGE + ROOM * params.size).min(brink(params, physique, end).max(next))
}

/// Does that swing go down to another tread?
pub fn sinks(state: &State, swing: &Swing) -> bool {
    state.feet[swing.side.other() as usize].ankle.y > swing.to.ankle.y + EDGE
}

/// m, (x, z): ahead of the ball of a foot, where it stands at the edge and the other one is to go down from beside it. It does not change while
/// that one is on its way there.
pub fn over(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, side: Side) -> Option<DVec2> {
    let foot = &state.feet[side as usize];
    let steps = match &state.swing {
        Some(swing) => sinks(state, swing),
        None => !above(state, side.other()) && !trails(params, state, side.other()),
    };
    let at = ground(foot.ankle) + support::forward(foot.yaw) * (ball(params, physique) + AHEAD * params.size);
    (steps && at_brink(params, physique, terrain, foot)).then_some(at)
}

/// Is ξ over the ball from which the other foot goes down, where that is held at `over`, m along the way?
pub fn ahead(params: &Params, state: &State, over: f64) -> bool {
    state.xi().y > over - AHEAD * params.size
}

/// Share of the way from one place to another, m along it, that ξ has come. A foot that goes down leaves a ball behind from which the pressure
/// pushes along the line to ξ: ξ goes aside no farther than it has come ahead.
pub fn came(state: &State, from: f64, to: f64) -> f64 {
    ((state.xi().y - from) / (to - from).max(EDGE)).clamp(0.0, 1.0)
}

/// The pressure under a foot whose heel may rise: from its ball to the edge.
pub fn on_ball(params: &Params, physique: &Physique, terrain: &Terrain, foot: &Plant, pressure: DVec2) -> DVec2 {
    let sole = Support::one(params, physique, foot, Tread::Whole, 0.5 * params.margin).nearest(pressure);
    let low = foot.ankle.z + ball(params, physique);
    let edge = tread(terrain, physique, foot)[1];
    DVec2::new(sole.x, pressure.y.clamp(low, (foot.ankle.z + physique.tip).min(edge).max(low)))
}

/// The pressure under both feet, of which the one behind, on the tread above, bears on its ball: along the line from there to where ξ is to
/// be over the other one. Behind that ball nothing bears, whatever ξ would need to come ahead.
pub fn between(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    (rear, over): (&Plant, DVec2),
    pressure: DVec2,
) -> DVec2 {
    let edge = tread(terrain, physique, rear)[1];
    let ball = ground(rear.ankle) + support::forward(rear.yaw) * ball(params, physique);
    let from = DVec2::new(ball.x, ball.y.min(edge - EDGE));
    let way = over - from;
    let most = ASIDE * params.size;
    let on = from + way * ((pressure.y - from.y) / way.y.max(EDGE)).clamp(0.0, ALONG);
    DVec2::new(on.x + (pressure.x - on.x).clamp(-most, most), on.y)
}

/// Has the foot that landed below taken the body over, so that the one behind may leave?
pub fn taken(params: &Params, physique: &Physique, state: &State, side: Side) -> bool {
    let stance = &state.feet[side.other() as usize];
    let sole = Support::one(params, physique, stance, Tread::Whole, INSIDE * params.size);
    let slow = ground(state.velocity).length() < CALM * params.size / params.tempo;
    above(state, side) && slow && sole.outside(state.xi()) <= 0.0
}

/// m, the height to which a swing down lets the body sink now: in the end where the leg that lands reaches its tread. `hip`: m, along the way.
pub fn height(physique: &Physique, state: &State, swing: &Swing, hip: f64) -> f64 {
    let goal = ascend::reaches(physique, &swing.to, LEG, hip);
    let share = (state.time - swing.lift) / (swing.land - swing.lift);
    let stance = state.feet[swing.side.other() as usize].ankle.y;
    let from = stance - BENDS[0] * (stance - swing.to.ankle.y);
    from + (goal.min(from) - from) * smooth3((share - SINKS[0]) / SINKS[1])
}

/// m, by how much both knees are bent, s after both feet came to stand, before a foot goes down by that height, m.
pub fn bends(params: &Params, stood: f64, drop: f64) -> f64 {
    BENDS[0] * drop * smooth3(stood / (BENDS[1] * params.tempo))
}
