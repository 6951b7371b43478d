//! Up flights of stairs and high steps by a body of links, step over step: what is not as on the way down ([`super::descend`]).
//!
//! Each foot goes past the other onto the next tread. The body comes over a foot whose knee is bent, and an ankle has no range for a shank
//! that leans far: so the heel behind rises until that foot stands on its ball, the trunk leans ahead, and the body has risen before the foot
//! behind leaves. Scenario space, metres, radians.

use super::climb::{BESIDE, EDGE, Flight, ROOM, STRIDE, floor, tread};
use super::gait::Rhythm;
use super::{Params, Physique, Plant, State, climb, ground, kerb, pace};
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::DVec2;

/// m of the reference body: a foot goes up to a tread that is no farther ahead; and the size, as a share of it, below which legs of the same
/// steps go as far. Of 40 drawn flights on legs of 0.58 to 0.71 m four fall with 1, one with 0.85.
const LONGEST: f64 = 0.37;
/// As [`LONGEST`] says.
const SHORT: f64 = 0.85;
/// m of the reference body, that toes keep from a riser, beyond [`EDGE`].
const TOES: f64 = 0.03;
/// Share of a sole that may be over the edge behind it where the tread is hard to reach: as much as on treads that are shorter than it.
const OVERHANGS: f64 = 0.25;
/// m of the reference body: a foot that would go no farther stays where it is.
const STAYS: f64 = 0.02;
/// Share of a leg's length, of the one behind with its heel down.
const LEG: f64 = 0.975;
/// m of the reference body, how high the heel behind rises at most; from where to where ahead of its sole's middle the pressure frees it;
/// from the ankle to the ball. Of 40 drawn flights on eight bodies one more falls with 0.08.
const HEEL: f64 = 0.11;
/// As [`HEEL`] says.
const FREES: f64 = 0.1;
/// As [`HEEL`] says: share of the sole.
const FREED_AT: f64 = 0.6;
/// As [`HEEL`] says.
const BALL: f64 = 0.13;
/// rad, by which a heel turns up at most: arcsine of this.
const STEEPEST: f64 = 0.85;
/// rad for each metre (of the reference body) of a rise, how far the trunk leans ahead: 15 degrees at 17 cm.
pub(super) const LEANS: f64 = 1.5;

/// The foot that goes next: the one behind, or the one that has just come beside the other, over which ξ is, if it gets on from there.
pub(super) fn next(params: &Params, physique: &Physique, terrain: &Terrain, state: &State) -> Side {
    let before = state.feet[0].ankle.z - state.feet[1].ankle.z;
    if before.abs() < BESIDE * params.size {
        let side = state.last.unwrap_or(params.lead);
        let goes = place(params, physique, terrain, state, side) - state.feet[side as usize].ankle.z;
        return if goes > STAYS * params.size { side } else { side.other() };
    }
    if before < 0.0 { Side::Left } else { Side::Right }
}

/// m, how far along the way that foot is to go: onto the next tread, or as near to it as it can where that is out of reach; from far behind on
/// the same tread, and at the end, beside the other.
pub(super) fn place(params: &Params, physique: &Physique, terrain: &Terrain, state: &State, side: Side) -> f64 {
    let (own, stance) = (&state.feet[side as usize], &state.feet[side.other() as usize]);
    let Some([before, on, far]) = onto(params, physique, terrain, stance) else { return stance.ankle.z };
    let passes = above(stance, own) || on <= far || (own.ankle.z - stance.ankle.z).abs() < BESIDE * params.size;
    if !passes {
        return stance.ankle.z;
    }
    if on <= far { on } else { before.min(stance.ankle.z + STRIDE * params.size) }
}

/// m, along the way, from where a foot stands: the last place before the next riser, the place on its tread, and how far a step goes. `None`
/// where nothing is ahead.
fn onto(params: &Params, physique: &Physique, terrain: &Terrain, stance: &Plant) -> Option<[f64; 3]> {
    let (rear, front) = (physique.heel - EDGE, physique.tip + EDGE + TOES * params.size);
    let edge = tread(terrain, physique, stance)[1];
    if edge.is_infinite() {
        return None;
    }
    let [next, end] = floor(terrain, stance.ankle.x, edge);
    let (low, high) = (next - rear, end - front);
    let far = stance.ankle.z + LONGEST * params.size.max(SHORT);
    let least = low - OVERHANGS * (physique.tip - physique.heel);
    let on = if high < low { high } else { (low + (0.5 * (high - low)).min(ROOM * params.size)).min(far.max(least)) };
    Some([edge - front, on, far])
}

/// m, along the way, where a walk's foot that would land at `natural` lands before a flight up: after steps of one length, where the next
/// one reaches the first tread. `None` where there is no flight or nobody goes there.
pub(super) fn approached(
    params: &Params,
    physique: &Physique,
    terrain: &Terrain,
    state: &State,
    (rhythm, side): (&Rhythm, Side),
    natural: f64,
) -> Option<f64> {
    let stance = &state.feet[side.other() as usize];
    let usual = (pace::aimed(state) * rhythm.step).y;
    let up = climb::flight(params, physique, terrain, stance) == Some(Flight::Up);
    if !up || usual < kerb::SLOW * params.size {
        return None;
    }
    let at = stance.ankle.z;
    let [before, on, far] = onto(params, physique, terrain, stance)?;
    let least = before.min(at + on - far);
    if at >= least {
        return Some(at.min(before));
    }
    let ahead = 0.5 * (least + before) - at;
    Some(at + ahead / kerb::count(ahead, natural - at, usual))
}

/// Does that foot stand on a higher tread than the other?
fn above(foot: &Plant, other: &Plant) -> bool {
    foot.ankle.y > other.ankle.y + EDGE
}

/// m, how much higher the tread is before the foot that is behind.
pub(super) fn rise_ahead(physique: &Physique, terrain: &Terrain, state: &State) -> f64 {
    let [left, right] = &state.feet;
    let foot = if left.ankle.z > right.ankle.z { right } else { left };
    let [_, edge] = tread(terrain, physique, foot);
    if edge - foot.ankle.z > 2.0 * STRIDE {
        return 0.0;
    }
    let height = |z: f64| terrain.spot(DVec2::new(foot.ankle.x, z)).height;
    (height(edge + EDGE) - height(edge - EDGE)).max(0.0)
}

/// m, the height to which the legs let the body rise with both feet down, its hips at `hip` along the way, m; and rad, how far the heel of the
/// foot behind turns up for it. `most`: m, what the foot ahead lets it.
pub(super) fn height(
    params: &Params,
    physique: &Physique,
    (state, side): (&State, Side),
    hip: f64,
    most: f64,
) -> (f64, f64) {
    let (own, stance) = (&state.feet[side as usize], &state.feet[side.other() as usize]);
    let rear = reaches(physique, own, LEG, hip);
    let frees = own.ankle.z + physique.heel + FREED_AT * (physique.tip - physique.heel);
    let freed = smooth3((state.cop.y - frees) / (FREES * params.size));
    let heel = if above(stance, own) { HEEL * freed * params.size } else { 0.0 };
    let goal = most.min(rear + heel);
    (goal, real::asin(((goal - rear) / (BALL * params.size)).clamp(0.0, STEEPEST)))
}

/// m, how high above the stand on level ground the hips are, at `hip` along the way, m, whose leg on that foot uses that share of its length.
pub(super) fn reaches(physique: &Physique, foot: &Plant, used: f64, hip: f64) -> f64 {
    let stands = physique.hip_height - physique.ankle_height;
    let (leg, away) = (used * physique.leg_length, foot.ankle.z - hip);
    foot.ankle.y + (leg * leg - away * away).max(0.3 * stands * stands).sqrt() - stands
}

/// m, (x, z), where that pressure can be under a foot that may hang over the edge behind it.
pub(super) fn on_tread(terrain: &Terrain, physique: &Physique, foot: &Plant, pressure: DVec2) -> DVec2 {
    let from = tread(terrain, physique, foot)[0] + ROOM;
    DVec2::new(pressure.x, pressure.y.max(from.min(ground(foot.ankle).y + physique.tip)))
}

/// Can who walks go on up from here, at a landing: is the next tread in reach of the foot behind?
pub(super) fn begins(params: &Params, physique: &Physique, terrain: &Terrain, state: &State) -> bool {
    let side = if state.feet[0].ankle.z < state.feet[1].ankle.z { Side::Left } else { Side::Right };
    onto(params, physique, terrain, &state.feet[side.other() as usize]).is_some_and(|[_, on, far]| on <= far)
}
