//! The ground as the legs feel it: how high it is under a place, how much higher the next foothold is, and the height to
//! which the longest leg carries the body. Scenario space, metres, seconds.
//!
//! The paper's leg lengths: each leg's rest length follows from the heights of the feet, and the longest leg goes back to its
//! full length. So the body stands as high as the full leg to the *lower* foot brings it, the leg to the higher one is shorter by
//! what that foot is higher; once the lower foot has left, the other leg is the longest, goes back to full and lifts the body over it.
//! Downhill it is the other way round: the stance leg gives until the full leg of the swinging foot reaches its foothold.

use super::walk::{self, Phase};
use super::{Params, Physique, Plant, State, StepKind, footing, ground, kerb, mesh, swing};
use crate::maths::curve::smooth3;
use crate::maths::pendulum::GRAVITY;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// Share of a step in which the leg of a higher foothold goes back to full: over the foot it is.
const STRETCHES: f64 = 0.85;
/// s, of the reference body, that takes a body of links at least on a kerb; and its time constant: with 0.05, 16 of 20 walks down kerbs of 5
/// to 12 cm keep their feet, with this 18.
const SOFT: [f64; 2] = [0.6, 0.08];
/// s, of the reference body: rest lengths follow ground that moves, and footholds that are aimed anew, within so long.
const FOLLOWS: f64 = 0.12;
/// s, of the reference body: time constant of the rest lengths behind all that.
const ROUNDED: f64 = 0.05;
/// Of gravity, the mean acceleration at which legs that go back to full lift the body over its line along the footholds: with more, walks
/// down stairs of 17 cm that are pushed by 100 N for 0.2 s keep their feet in 22 of 32 directions, with this in 30 (measured).
const QUICKEST: f64 = 0.05;
/// How far the lower foot counts for more in a stand, 0..1: the higher leg bends more easily than the lower one grows.
const LOWER: f64 = 0.7;

/// Least and greatest share of h by which h - s counts for a step's length: downhill no leg reaches much farther than on the level.
const STEEP: [f64; 2] = [0.6, 1.1];

/// The height of the ground that the longest leg, at its full length, stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carried {
    /// m.
    pub height: f64,
    /// m/s.
    pub rate: f64,
    /// m and m/s, the same where each leg goes back to its full length.
    full: [f64; 2],
}

impl Carried {
    /// At rest at that height, m.
    pub fn still(height: f64) -> Carried {
        Carried { height, rate: 0.0, full: [height, 0.0] }
    }
}

/// Does the gait go over level ground, with no edge near?
pub fn on_level(state: &State) -> bool {
    let gait = &state.gait;
    gait.longest.is_infinite() && gait.rise == 0.0 && gait.grade == 0.0 && !gait.broken
}

/// m, how high the ground is at a place, (x, z), as far as the feet know it: the planes of the two footholds, joined by
/// how near each is. A swinging foot counts by the way that it has gone.
pub fn under(state: &State, at: DVec2) -> f64 {
    let [one, two] = Side::BOTH.map(|side| shadow(state, side));
    let apart = ground(two.ankle) - ground(one.ankle);
    let share = (at - ground(one.ankle)).dot(apart) / apart.length_squared().max(1e-9);
    let share = share.clamp(0.0, 1.0);
    plane(&one, at) * (1.0 - share) + plane(&two, at) * share
}

/// The unit normal of the ground that carries: the stance foot's, or the mean of both.
pub fn normal(state: &State) -> DVec3 {
    let [left, right] = state.feet.each_ref().map(|foot| foot.normal);
    match &state.swing {
        Some(swing) => state.feet[swing.side.other() as usize].normal,
        None => (left + right).normalize_or(DVec3::Y),
    }
}

/// m, how high the centre of pressure is: on the stance foot's plane, or between the two.
pub fn under_pressure(state: &State, cop: DVec2) -> f64 {
    match &state.swing {
        Some(swing) => plane(&state.feet[swing.side.other() as usize], cop),
        None => under(state, cop),
    }
}

/// m, how much higher than the stance foot its own plane is at a place: what is known of a foothold before it is chosen.
pub fn ahead(stance: &Plant, at: DVec2) -> f64 {
    plane(stance, at) - stance.ankle.y
}

fn plane(plant: &Plant, at: DVec2) -> f64 {
    let off = at - ground(plant.ankle);
    plant.ankle.y - (plant.normal.x * off.x + plant.normal.z * off.y) / plant.normal.y.max(0.1)
}

/// The foothold that a foot has, or is on its way to: its place on the ground.
fn shadow(state: &State, side: Side) -> Plant {
    let Some(swing) = state.swing.filter(|swing| swing.side == side) else { return state.feet[side as usize] };
    // a foot that was held up and comes down in haste starts in the air
    let from = if state.one.lifted.is_some() { swing.to } else { swing.from };
    let gone = smooth3(swing::phase(&swing, state.time));
    let normal = from.normal.lerp(swing.to.normal, gone).normalize();
    Plant { ankle: from.ankle.lerp(swing.to.ankle, gone), yaw: swing.to.yaw, normal }
}

/// Looks ahead in the gait: by how much the next foothold is higher than the stance foot, as the ground is.
pub fn foresee(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State) {
    if terrain.is_flat() || state.gait.phase == Phase::Rest {
        return;
    }
    let stance = state.feet[state.gait.side.other() as usize];
    if let Some(swing) = state.swing.filter(|swing| swing.kind == StepKind::Walk) {
        state.gait.rise = swing.to.ankle.y - stance.ankle.y;
        return;
    }
    let rhythm = walk::rhythm_now(params, physique, state);
    let stride = state.gait.velocity * rhythm.step;
    let place = ground(stance.ankle) + stride + state.aside() * (state.gait.side.sign() * rhythm.width);
    let next = footing::set_down(terrain, physique, place, state.facing, state.time + rhythm.step);
    state.gait.rise = next.ankle.y - stance.ankle.y;
    state.gait.broken =
        params.fits && terrain.is_mesh() && mesh::broken(terrain, physique, &stance, place, state.facing);
    if state.time - state.gait.since < 1.5 * state.gait.tick || state.gait.phase == Phase::Start {
        let far = stride.length();
        state.gait.grade = if far > 0.1 * params.size { state.gait.rise / far } else { 0.0 };
    }
}

/// Follows the rest lengths by a tick: to the lower foot's height in a stand; in the gait over to the stance foot where it
/// is the higher one, and down to the next foothold's where that is lower.
pub fn follow(params: &Params, physique: &Physique, terrain: &Terrain, state: &mut State, dt: f64) {
    if terrain.is_flat() {
        return;
    }
    let soonest = FOLLOWS * params.tempo;
    let mut share = 1.0;
    let walks = matches!(state.gait.phase, Phase::Single | Phase::Double)
        && state.swing.is_none_or(|swing| swing.kind == StepKind::Walk);
    let (goal, time) = if walks {
        let stance = state.feet[state.gait.side.other() as usize].ankle.y;
        let step = walk::rhythm_now(params, physique, state).step;
        let most = QUICKEST * GRAVITY * step * step / 6.0; // of a cubic from rest to rest in a step
        share = most / most.max(state.gait.rise.abs());
        if state.gait.rise < 0.0 {
            let lands = state.swing.map_or(step - state.settled, |swing| swing.land - state.time);
            (stance + state.gait.rise, lands)
        } else {
            let soft = if params.fits && kerb::by(params, terrain, state) { SOFT[0] * params.tempo } else { 0.0 };
            (stance, soft.max(STRETCHES * step) - state.settled)
        }
    } else {
        let [left, right] = Side::BOTH.map(|side| shadow(state, side).ankle.y);
        (0.5 * (left + right) - 0.5 * LOWER * (left - right).abs(), soonest)
    };
    let time = time.max(soonest);
    let [full, rate] = state.carried.full;
    // the cubic that is at rest at the goal then: of all ways there the one of least acceleration
    let acceleration = (6.0 * (goal - full) / (time * time) - 4.0 * rate / time).clamp(-GRAVITY, GRAVITY);
    let full = [full + rate * dt + 0.5 * acceleration * dt * dt, rate + acceleration * dt];
    // where that would be too sudden the legs stay bent, by half a rise, and the body goes more along the line of the footholds
    let line = under(state, ground(state.com)) - 0.5 * state.gait.rise.abs();
    let height = if share < 1.0 { full[0] * share + line * (1.0 - share) } else { full[0] };
    // footholds that are aimed anew make it jump: legs do not
    let rounded = if params.fits && kerb::by(params, terrain, state) { SOFT[1] } else { ROUNDED };
    let sharp = 1.0 / (rounded * params.tempo);
    let rate = state.carried.rate
        + ((height - state.carried.height) * (sharp * sharp) - state.carried.rate * (2.0 * sharp)) * dt;
    state.carried = Carried { height: state.carried.height + rate * dt, rate, full };
}

/// Follows the rest lengths by a tick to that height, m, with that time constant, s.
pub fn towards(state: &mut State, goal: f64, constant: f64, dt: f64) {
    let Carried { height, rate, .. } = state.carried;
    let sharp = 1.0 / constant;
    let rate = rate + ((goal - height) * (sharp * sharp) - rate * (2.0 * sharp)) * dt;
    let height = height + rate * dt;
    state.carried = Carried { height, rate, full: [height, rate] };
}

/// m, the height that the longest leg will have when the swing lands: the lower of the two footholds.
pub fn at_landing(state: &State) -> f64 {
    let Some(swing) = &state.swing else { return state.carried.height };
    let stance = state.feet[swing.side.other() as usize].ankle.y;
    0.5 * (stance + swing.to.ankle.y) - 0.5 * LOWER * (stance - swing.to.ankle.y).abs()
}

/// Times the level one, how long a step is that goes up or down as steeply as the ground does here: equation 2's d at a rise over its d
/// at none, for the same speeds (v² is small beside 4g(h - s)).
pub fn share_of_step(physique: &Physique, state: &State, step: f64) -> f64 {
    if state.gait.grade == 0.0 || state.gait.longest.is_finite() {
        return 1.0;
    }
    let rise = state.gait.grade * state.gait.velocity.length() * step;
    (1.0 - rise / physique.com_height).clamp(STEEP[0], STEEP[1]).sqrt()
}
