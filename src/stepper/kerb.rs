//! Over one step of the ground, up or down, by a body of links: first one foot, then the other beside it where the way asks for it.
//! Steps are timed so that ξ is where the foothold wants it. Scenario space, metres, seconds.

use super::gait::Rhythm;
use super::walk::Phase;
use super::{Params, Physique, Plant, State, mesh, pace, support};
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// m, steps before and on kerbs are no longer than that: with treads of it, walks of 0.3 to 0.4 m/s keep their feet.
pub const STRIDE: f64 = 0.3;
/// Of [`STRIDE`], the mean step there: each second one sets a foot beside the other. s of the reference body, how long it takes at least and
/// at most.
pub const MEAN: f64 = 0.5;
pub const TAKES: [f64; 2] = [0.4, 0.55];
/// s of the reference body for [`STRIDE`]: no faster.
pub const SLOWEST: f64 = 0.8;
/// Strides from an edge within which footholds are chosen for it, and from which on the next step goes over it or to the other foot.
const NEAR: f64 = 2.0;
const AT: f64 = 1.5;
/// m, that soles keep from an edge; m of the reference body, more of it from one that rises: a foot that comes down beside the other has its
/// toes low, and boxes of links are larger than soles. Behind the edge so much more where there is room.
const EDGE: f64 = 0.01;
const TOES: f64 = 0.03;
const ROOM: f64 = 0.02;
/// Cosine of what a way may be aside of z, on a mesh: 18 degrees.
const STRAIGHT: f64 = 0.95;
/// m of the reference body: feet no farther apart stand beside each other.
const BESIDE: f64 = 0.1;
/// Share of the way over an edge that a step of the walk must have without being asked for, to go over from feet that are not.
const GOES: f64 = 0.6;
/// m of the reference body: whose usual step is shorter is not going there.
pub(super) const SLOW: f64 = 0.05;
/// Share of a usual step that steps up to an edge are at least taken to be, and what is added to their count before it is cut off.
const LEAST: f64 = 0.5;
const MORE: f64 = 0.85;

/// Does the foot that stands lie so near to an edge that the next foothold is chosen for it?
pub fn near(params: &Params, terrain: &Terrain, state: &State) -> bool {
    if !terrain.has_treads() && !terrain.is_mesh()
        || state.gait.last
        || matches!(state.gait.phase, Phase::Start | Phase::Rest)
    {
        return false;
    }
    let stance = &state.feet[state.gait.side.other() as usize];
    let middle = stance.ankle.z + params.com_forward;
    let at = DVec2::new(stance.ankle.x, middle);
    terrain.floor_at(at).is_some_and(|[_, edge]| {
        let near = edge.is_finite() && edge - stance.ankle.z < NEAR * STRIDE;
        near && (!terrain.is_mesh() || straight(state) && terrain.spot(DVec2::new(at.x, edge + EDGE)).holds)
    })
}

/// Does it go straight along z?
fn straight(state: &State) -> bool {
    let way = state.gait.velocity.normalize_or_zero();
    way.y > STRAIGHT && state.ahead.y > STRAIGHT
}

/// Is it on stairs, or on a mesh near a step of the ground?
pub fn by(params: &Params, terrain: &Terrain, state: &State) -> bool {
    terrain.has_treads() || terrain.is_mesh() && state.gait.longest.is_finite() && near(params, terrain, state)
}

/// m, z of the next foothold near an edge, where the walk by itself would set the foot at `natural`; `None` where that is as good.
pub fn ahead(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &State,
    (rhythm, side): (&Rhythm, Side),
    natural: f64,
) -> Option<f64> {
    let stance = &state.feet[side.other() as usize];
    let (rear, front) = (physique.heel - EDGE, physique.tip + EDGE);
    let line = |z: f64| DVec2::new(stance.ankle.x, z);
    let [from, edge] = terrain.floor_at(line(stance.ankle.z + 0.5 * (rear + front)))?;
    let usual = (pace::aimed(state) * rhythm.step).y;
    if usual < SLOW * params.size || !edge.is_finite() {
        return None;
    }
    let [next, end] = terrain.floor_at(line(edge + EDGE))?;
    let up = terrain.spot(line(next + EDGE)).height > stance.ankle.y;
    let keeps = if up { TOES * params.size } else { 0.0 };
    let (low, high) = (next - rear, end - front - keeps);
    let over = if high < low && up { high } else { low + (0.5 * (high - low)).clamp(0.0, ROOM * params.size) };
    let (before, far) = (edge - front - keeps, over - stance.ankle.z);
    let own = state.swing.filter(|swing| swing.side == side).map_or(state.feet[side as usize], |swing| swing.from);
    if far < AT * STRIDE {
        let level = (own.ankle.y - stance.ankle.y).abs() < 0.02 * params.size;
        let beside = (own.ankle.z - stance.ankle.z).abs() < BESIDE * params.size;
        let goes = beside || natural - stance.ankle.z > GOES * far;
        return Some(if level && goes { over } else { stance.ankle.z.max(from - rear).min(before) });
    }
    let count = count(far, natural - stance.ankle.z, usual);
    let lands = stance.ankle.z + far / count;
    Some(if count > 1.0 { lands.min(before) } else { lands })
}

/// How many steps of one length take it so far (m), the next of which would be `natural` and a usual one `usual` m.
pub fn count(far: f64, natural: f64, usual: f64) -> f64 {
    (far / natural.clamp(LEAST * usual, usual) + MORE).floor().max(1.0)
}

/// A foot at that place, on the tread that is under its middle.
pub fn stood(terrain: &Terrain, physique: &Physique, ankle: DVec2, yaw: f64) -> Plant {
    if terrain.is_mesh() {
        return mesh::stood(terrain, physique, ankle, yaw);
    }
    let middle = ankle + support::forward(yaw) * (0.5 * (physique.heel + physique.tip));
    Plant::level(DVec3::new(ankle.x, terrain.spot(middle).height, ankle.y), yaw)
}
