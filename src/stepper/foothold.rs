//! Where a foot must land: the paper's step length from the state predicted at touchdown, bent to what legs can do; and
//! where the feet and the body are at ease.
//!
//! Ground plane (x, z), metres, seconds.

use super::balance::{braking, steady_lean};
use super::{Params, Passing, Physique, Plant, State, Support, footing, ground, rise, support::Tread, swing};
use crate::maths::pendulum;
use crate::model::Side;
use glam::{DVec2, DVec3};

/// A planned landing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foothold {
    /// Where.
    pub plant: Plant,
    /// m, how far outside of both feet the fall goes on.
    pub miss: f64,
    /// m, by how much it lies off the place that would be best.
    pub off: f64,
    /// m/s, the centre of mass at touchdown.
    pub speed: f64,
    /// m, how far it is across on the other foot's side.
    pub across: f64,
}

/// The landing of `side` after `time` s (of a swing of `swing_time` s) that stops the fall, or comes nearest.
pub fn corrective(
    params: &Params,
    physique: &Physique,
    state: &State,
    side: Side,
    passing: Passing,
    (time, swing_time): (f64, f64),
) -> Foothold {
    let stance = &state.feet[side.other() as usize];
    let from = match state.swing {
        Some(swing) => ground(swing.from.ankle),
        None => ground(state.feet[side as usize].ankle),
    };
    let sole = Support::one(params, physique, stance, Tread::Whole, params.margin);
    let lean = steady_lean(physique, state);
    let pivot = sole.nearest(state.xi() + lean) - lean;
    let more = state.pushed.min(params.expect).min(time.max(0.0));
    let shove = expected(params, physique, state, time);
    let (com, velocity) = (ground(state.com) - shove * (0.5 * more), ground(state.velocity) + shove);
    let (com, velocity) = pendulum::predict(com, velocity, pivot, state.omega(), time.max(0.0));
    let speed = velocity.length();
    let direction = if speed > 1e-9 { velocity / speed } else { DVec2::ZERO };
    let bias = params.leg_bias * (state.com.y - state.carried.height - physique.com_height);
    // equation 2: the body is as high over the lower of the two footholds as it stands
    let rise = rise::ahead(stance, com + velocity / state.omega());
    let height = (physique.com_height + bias).max(0.1 + rise.max(0.0)) + rise.min(0.0);
    let distance = pendulum::step_distance(speed, 0.0, height, rise);
    let weight = physique.mass * pendulum::GRAVITY;
    let capture = com + direction * distance + state.felt * (params.pull / weight);

    let (ahead, out) = (state.ahead, state.aside() * side.sign());
    let away = capture - middle(params, state.ahead, [from, ground(stance.ankle)]);
    let direction = away.normalize_or_zero();
    let over = (speed / (0.5 * params.size / params.tempo)).min(1.0);
    let outward = if passing == Passing::Own { params.outward } else { params.across };
    let wanted = capture + direction * (params.overshoot * over) + out * outward - ahead * params.com_forward;

    let hip = com - ahead * params.com_forward + out * (0.5 * params.width);
    let step = params.ankle_speed * swing_time / swing::PEAK;
    let foot = physique.tip - physique.heel;
    let short = params.least_step - (wanted - from).dot(direction);
    let wanted = wanted + direction * short.max(0.0);
    let mut ankle = wanted;
    for _ in 0..2 {
        ankle = within(ankle, hip, params.reach);
        ankle = within(ankle, from, step);
        let relative = ankle - ground(stance.ankle);
        let (beside, before) = (relative.dot(out), relative.dot(ahead));
        if passing != Passing::Own {
            ankle += out * (-params.most_across - beside).max(0.0);
        }
        let clear = clearance(params, foot, beside);
        match passing {
            Passing::Own => ankle += out * (params.gap - beside).max(0.0),
            Passing::Front => ankle += ahead * (clear - before).max(0.0) * f64::from(clear > 0.0),
            Passing::Behind => ankle -= ahead * (clear + before).max(0.0) * f64::from(clear > 0.0),
        }
    }
    let yaw = state.facing + params.stance.yaws[side as usize];
    let plant = Plant::level(DVec3::new(ankle.x, 0.0, ankle.y), yaw);
    let plant = footing::apart(physique, stance, &plant, side, footing::ROOM * params.size);
    let ankle = ground(plant.ankle);
    let across = (-(ankle - ground(stance.ankle)).dot(out)).max(0.0);
    let stands = Support::two(params, physique, [stance, &plant], [Tread::Whole; 2], params.margin);
    let xi = state.xi() + lean + shove / state.omega() - shove * (0.5 * more);
    let fin = over_foot(params, state, side, passing, &plant);
    let pivot = braking(params, state, passing, &sole, (xi, fin), time);
    let caught = pendulum::carried(xi, pivot, state.omega(), time.max(0.0));
    let miss = stands.outside(caught).max(0.0);
    Foothold { plant, miss, off: ankle.distance(wanted), speed, across }
}

/// m/s that the push of this moment will add within `time` s, if it goes on as pushes do.
pub fn expected(params: &Params, physique: &Physique, state: &State, time: f64) -> DVec2 {
    state.touch * (state.pushed.min(params.expect).min(time.max(0.0)) / physique.mass)
}

/// The point that a corrective step to that plant means to have ξ at when it lands.
pub fn over_foot(params: &Params, state: &State, side: Side, passing: Passing, plant: &Plant) -> DVec2 {
    let (ahead, out) = (state.ahead, state.aside() * side.sign());
    let outward = if passing == Passing::Own { params.outward } else { params.across };
    ground(plant.ankle) + ahead * params.com_forward - out * outward
}

/// How far ahead of (or behind) the stance foot a crossing foot must land, m: clear of the sole where the two are in
/// line, of the leg where it is past it, not at all on its own side.
fn clearance(params: &Params, foot: f64, beside: f64) -> f64 {
    let near = beside / params.gap;
    let ramp = ((1.5 - near) / 0.5).clamp(0.0, 1.0);
    let line = (1.0 - near * near).max(0.0);
    ramp * (params.pass + (foot + params.margin - params.pass).max(0.0) * line)
}

/// Where that foot is at ease beside the other one.
pub fn beside(params: &Params, state: &State, side: Side) -> Plant {
    let other = ground(state.feet[side.other() as usize].ankle);
    let apart = params.stance.apart * side.sign();
    let ankle = other + state.aside() * apart.x + state.ahead * apart.y;
    Plant::level(DVec3::new(ankle.x, 0.0, ankle.y), state.facing + params.stance.yaws[side as usize])
}

/// The point over which the body stands at ease on those two ankles.
pub fn middle(params: &Params, ahead: DVec2, ankles: [DVec2; 2]) -> DVec2 {
    (ankles[0] + ankles[1]) * 0.5 + DVec2::new(ahead.y, -ahead.x) * params.stance.over.x + ahead * params.stance.over.y
}

/// The point to stand over once `side` has come beside the other.
pub fn middle_after(params: &Params, state: &State, side: Side) -> DVec2 {
    let stance = ground(state.feet[side.other() as usize].ankle);
    let to = ground(beside(params, state, side).ankle);
    let ankles = if side == Side::Left { [to, stance] } else { [stance, to] };
    middle(params, state.ahead, ankles)
}

/// Both ankles on the ground, left and right.
pub fn ankles(state: &State) -> [DVec2; 2] {
    [ground(state.feet[0].ankle), ground(state.feet[1].ankle)]
}

fn within(point: DVec2, centre: DVec2, radius: f64) -> DVec2 {
    let gap = point.distance(centre);
    if gap > radius { centre + (point - centre) * (radius / gap) } else { point }
}
