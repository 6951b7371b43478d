//! Footholds on a ground of triangles: whole soles, off edges, out of walls, no higher or lower than a leg steps; how long a step such
//! ground allows and how far the way is free. Scenario space, metres.
//!
//! What lies in the way is found by asking: the ground's height under the points of a sole, and walls across lines. Nothing is remembered.

use super::{Params, Physique, Plant, climb, support};
use crate::maths::real;
use crate::model::{Spot, Terrain};
use glam::{DVec2, DVec3};

/// m, that a sole keeps from an edge.
const EDGE: f64 = 0.01;
/// Points along a sole and across it at which the ground is asked.
const POINTS: [usize; 2] = [7, 3];
/// m of the reference body: a landing is moved no farther than that, in rings so far apart, refined by halving so often.
const FARTHEST: f64 = 0.24;
const RING: f64 = 0.015;
const HALVINGS: usize = 5;
/// 1/m of the reference body: where no place holds a whole sole, 5 cm farther are worth as much as a fifth of it.
const DEARER: f64 = 4.0;
/// Directions around a place.
const DIRECTIONS: usize = 16;
/// Part of the leg: a step goes up or down no farther. People step up 0.88 of it at most, and choose to under a third (Warren 1984).
const RISE: f64 = 0.5;
/// m over the ground, at which a wall is in the way of a foot; part of the leg, of the body.
const WALLS: [f64; 2] = [0.06, 0.6];
/// m, ground that rises or falls so much within [`STRIDE`] is a riser of a stair or a kerb.
const RISER: f64 = 0.06;
/// m, between the places asked along a way.
const STRIDE: f64 = 0.03;
/// m of the reference body: a stair is seen so far ahead and behind, as stairs by name are, and two risers farther apart are none.
const SEEN: [f64; 2] = [1.4, 0.4];
const NEIGHBOURS: f64 = 0.9;
/// Part of the leg: so far before and behind a foothold the ground counts for it.
const BESIDE: f64 = 0.12;
/// m: ground that is no farther below a sole bears it as it rocks: where a ramp of 12 degrees begins or ends under its middle.
const ROCKS: f64 = 0.03;
/// m, the same of a sole on a ridge, which bears it along a line only: of 32 drawn walks down onto a ramp of 12 to 24 degrees six fall with 0.03,
/// three with this.
const RIDGE: f64 = 0.012;
/// m of the reference body: ahead and behind a bend of the ground is seen so far; m, between the places asked; m/m, by how much it bends at least.
const BENDS_SEEN: [f64; 2] = [1.0, 0.3];
const BENDS_APART: f64 = 0.1;
const BENDS: f64 = 0.15;
/// m of the reference body: ground that is no higher over a sole may bear it.
const BESIDE_SOLE: f64 = 0.03;
/// m of the reference body: so much free way is looked for, so much is kept before what is in it, and a gap so wide is stepped over.
const LOOK: f64 = 2.4;
const KEPT: f64 = 0.50;
const GAP: f64 = 0.5;

/// A sole of a body, as points of the ground plane to be asked about.
struct Sole {
    points: Vec<DVec2>, // m, from the ankle's shadow, with the edge that it keeps
}

impl Sole {
    fn new(physique: &Physique, yaw: f64, edge: f64) -> Sole {
        let (ahead, left) = (support::forward(yaw), support::left(yaw));
        let (from, to, wide) = (physique.heel - edge, physique.tip + edge, physique.half_width + edge);
        let share = |at: usize, of: usize| at as f64 / (of - 1) as f64;
        let points = (0..POINTS[0]).flat_map(|along| {
            let along = from + (to - from) * share(along, POINTS[0]);
            (0..POINTS[1]).map(move |across| ahead * along + left * (wide * (2.0 * share(across, POINTS[1]) - 1.0)))
        });
        Sole { points: points.collect() }
    }

    /// Its outline: corners in order.
    fn outline(&self) -> [DVec2; 4] {
        let last = self.points.len() - 1;
        [self.points[0], self.points[POINTS[1] - 1], self.points[last], self.points[last + 1 - POINTS[1]]]
    }
}

/// How a foot lies somewhere, and how well.
#[derive(Clone, Copy)]
struct Place {
    plant: Plant,
    held: f64,   // 0..1
    hangs: f64,  // m, how far below the sole the ground is at the most
    ridge: bool, // the ground under the middle is over that under the ends
}

/// Where a sole that points one way may be set down.
struct Ground<'a> {
    terrain: &'a Terrain,
    physique: &'a Physique,
    by: Option<&'a Plant>,
    sole: Sole,
    yaw: f64,
}

impl Ground<'_> {
    /// The sole laid down there; `None` where there is nothing under it.
    fn place(&self, at: DVec2) -> Option<Place> {
        let lie = self.terrain.lie(at, &self.sole.points)?;
        let plant = Plant { ankle: DVec3::new(at.x, lie.height, at.y), yaw: self.yaw, normal: lie.normal };
        Some(Place { plant, held: lie.held, hangs: lie.hangs, ridge: self.bent(at).1 > 0.0 })
    }

    /// Is what is under a place no higher or lower than a leg steps? Asked first: a sole over another floor is laid down for nothing.
    fn steps_to(&self, at: DVec2) -> bool {
        let rise = |other: &Plant| (self.terrain.spot(at).height - other.ankle.y).abs();
        self.by.is_none_or(|other| rise(other) <= RISE * self.physique.leg_length + ROCKS)
    }

    /// May a whole sole lie there, or rock? Where its ends and its middle are not nearly on one line it does neither.
    fn may_lie(&self, at: DVec2) -> bool {
        let (holds, bent) = self.bent(at);
        holds && bent.abs() <= ROCKS
    }

    /// Is there ground under its ends and its middle, and how far is the middle's over the line between the ends', m?
    fn bent(&self, at: DVec2) -> (bool, f64) {
        let middle = POINTS[1] / 2;
        let [rear, half, front] = [0, POINTS[0] / 2, POINTS[0] - 1]
            .map(|along| self.terrain.spot(at + self.sole.points[along * POINTS[1] + middle]));
        let bent = half.height - 0.5 * (rear.height + front.height);
        (rear.holds && half.holds && front.holds, bent)
    }

    /// No wall in it, none between it and the other foot, not too steep, not too high?
    fn is_free(&self, place: &Place) -> bool {
        let (terrain, leg) = (self.terrain, self.physique.leg_length);
        let ankle = place.plant.ankle;
        let slips = place.plant.normal.y < 1.0 / real::hypot(1.0, terrain.friction); // out of the friction cone
        if slips || self.by.is_some_and(|other| (ankle.y - other.ankle.y).abs() > RISE * leg) {
            return false;
        }
        let [low, high] = [WALLS[0], WALLS[1] * leg];
        let reached = self.by.is_none_or(|other| {
            let height = other.ankle.y.max(ankle.y) + high;
            let from = DVec3::new(other.ankle.x, height, other.ankle.z);
            terrain.wall(from, DVec3::new(ankle.x, height, ankle.z)).is_none()
        });
        let outline = self.sole.outline().map(|corner| DVec2::new(ankle.x, ankle.z) + corner);
        let lift = |at: DVec2, height: f64| DVec3::new(at.x, ankle.y + height, at.y);
        reached
            && (0..4).all(|side| {
                let (here, next, over) = (outline[side], outline[(side + 1) % 4], outline[(side + 2) % 4]);
                let free = |to: DVec2, height: f64| terrain.wall(lift(here, height), lift(to, height)).is_none();
                free(next, low) && (side > 1 || free(over, low) && free(over, high))
            })
    }

    /// The nearest place where the sole lies and is free; else what comes nearest to that.
    fn search(&self, ankle: DVec2, lies: fn(&Place) -> bool) -> Result<Place, Option<Place>> {
        let good = |found: &Place| lies(found) && self.is_free(found);
        let first = self.place(ankle);
        if let Some(found) = first.as_ref().filter(|found| good(found)) {
            return Ok(*found);
        }
        let size = self.physique.leg_length / Physique::REFERENCE.leg_length;
        // Less is asked where the answer does not count.
        let most = |best: &Option<(f64, Place)>| best.as_ref().map_or(f64::NEG_INFINITY, |known| known.0 + 1e-9);
        let dear = |moved: f64| DEARER * moved / size;
        let better = |best: Option<(f64, Place)>, found: Place, moved: f64| {
            let worth = found.held - dear(moved);
            if worth + 1.0 <= most(&best) {
                return best;
            }
            let worth = worth + f64::from(u8::from(self.is_free(&found)));
            if worth > most(&best) { Some((worth, found)) } else { best }
        };
        let mut best = first.and_then(|found| better(None, found, 0.0));
        let ring = RING * size;
        for number in 1..=(FARTHEST / RING) as usize {
            for direction in 0..DIRECTIONS {
                let (sine, cosine) = real::sin_cos(std::f64::consts::TAU * direction as f64 / DIRECTIONS as f64);
                let way = DVec2::new(sine, cosine);
                let at = ankle + way * (ring * number as f64);
                let moved = at.distance(ankle);
                let may_be_good = self.may_lie(at);
                if !self.steps_to(at) || !may_be_good && 2.0 - dear(moved) <= most(&best) {
                    continue;
                }
                let Some(found) = self.place(at) else { continue };
                if may_be_good && good(&found) {
                    let look = |at: DVec2| self.place(at).filter(good);
                    return Ok(nearer(&look, ankle, way, [ring * (number - 1) as f64, ring * number as f64], found));
                }
                best = better(best, found, moved);
            }
        }
        Err(best.map(|(_, place)| place))
    }
}

/// The foot set down as near to that place as the whole sole is held; where it is nowhere near, where most of it is. `by`: the other
/// foot, from which it is stepped.
pub fn set_down(terrain: &Terrain, physique: &Physique, by: Option<&Plant>, ankle: DVec2, yaw: f64) -> Plant {
    set(terrain, physique, by, (ankle, yaw), |found| found.held >= 1.0)
}

/// The same by a body of links, whose feet rock over where ramps begin and end.
pub fn set_down_by(terrain: &Terrain, physique: &Physique, by: &Plant, ankle: DVec2, yaw: f64) -> Plant {
    set(terrain, physique, Some(by), (ankle, yaw), rocks)
}

/// Does a sole lie there, or rock on its middle or between its ends?
fn rocks(place: &Place) -> bool {
    place.held >= 1.0 || place.hangs < if place.ridge { RIDGE } else { ROCKS }
}

fn set(
    terrain: &Terrain,
    physique: &Physique,
    by: Option<&Plant>,
    (ankle, yaw): (DVec2, f64),
    lies: fn(&Place) -> bool,
) -> Plant {
    let mut best = None;
    // On a stair as deep as the sole is long there is no room for edges.
    for edge in [EDGE, 0.0] {
        let ground = Ground { terrain, physique, by, sole: Sole::new(physique, yaw, edge), yaw };
        match ground.search(ankle, lies) {
            Ok(found) => return found.plant,
            Err(found) => best = found,
        }
    }
    best.map_or_else(|| nowhere(by, ankle, yaw), |best: Place| best.plant)
}

/// The nearest good place between two distances along a way, of which the farther one is good; `look` gives good places only.
fn nearer(
    look: &dyn Fn(DVec2) -> Option<Place>,
    from: DVec2,
    way: DVec2,
    [mut near, mut far]: [f64; 2],
    mut found: Place,
) -> Place {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (near + far);
        match look(from + way * middle) {
            Some(better) => (far, found) = (middle, better),
            None => near = middle,
        }
    }
    found
}

/// Where there is no ground: as high as the other foot, for who falls off the edge of the world.
fn nowhere(by: Option<&Plant>, ankle: DVec2, yaw: f64) -> Plant {
    Plant::level(DVec3::new(ankle.x, by.map_or(0.0, |other| other.ankle.y), ankle.y), yaw)
}

/// m, the longest step that risers allow a body at `place` that goes that way: from one to the next.
pub fn longest(terrain: &Terrain, size: f64, place: DVec2, way: DVec2) -> f64 {
    let way = way.normalize_or_zero();
    let [ahead, behind] = SEEN.map(|seen| seen * size);
    let reach = NEIGHBOURS * size;
    let count = ((ahead + behind + 2.0 * reach) / STRIDE).ceil() as usize;
    let along = |index: usize| -behind - reach + STRIDE * index as f64;
    let spot = |index: usize| terrain.spot(place + way * along(index));
    let mut risers: Vec<f64> = Vec::new();
    let mut before = spot(0);
    for index in 1..=count {
        let here = spot(index);
        let (fall, slope) = (here.height - before.height, 0.5 * (grade(&before, way) + grade(&here, way)));
        if here.holds && before.holds && (fall - slope * STRIDE).abs() > RISER {
            risers.push(riser(terrain, place, way, [along(index - 1), along(index)], before.height + 0.5 * fall));
        }
        before = here;
    }
    let mut least = f64::INFINITY;
    for pair in risers.windows(2) {
        let seen = pair.iter().any(|riser| (-behind..=ahead).contains(riser));
        let apart = pair[1] - pair[0];
        if seen && apart < reach && apart > 2.0 * STRIDE {
            least = least.min(apart);
        }
    }
    least
}

/// m: finite where a body at `place` that faces that way is near an edge; its steps are short there.
pub fn beside_edge(terrain: &Terrain, size: f64, place: DVec2, way: DVec2) -> f64 {
    let [ahead, behind] = SEEN.map(|seen| seen * size);
    let near = terrain.edge(place, way, ahead).or_else(|| terrain.edge(place, -way, behind));
    near.map_or(f64::INFINITY, |_| 0.0)
}

/// Does the ground bend near a body at `place` that goes that way, and rise there? Its steps are quick there, and timed.
pub fn bends(terrain: &Terrain, size: f64, place: DVec2, way: DVec2) -> bool {
    let [ahead, behind] = BENDS_SEEN.map(|seen| seen * size);
    let spots = (0..=((ahead + behind) / BENDS_APART) as usize)
        .map(|index| terrain.spot(place + way * (BENDS_APART * index as f64 - behind)));
    let grades = spots.filter(|spot| spot.holds).map(|spot| grade(&spot, way));
    let [least, most] =
        grades.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], at| [least.min(at), most.max(at)]);
    most - least > BENDS && most > BENDS
}

/// Is the ground around a foothold such that a sole does not lie on it everywhere?
pub fn broken(terrain: &Terrain, physique: &Physique, by: &Plant, ankle: DVec2, yaw: f64) -> bool {
    let ground = Ground { terrain, physique, by: Some(by), sole: Sole::new(physique, yaw, EDGE), yaw };
    let ahead = support::forward(yaw) * (BESIDE * physique.leg_length);
    [-1.0, 0.0, 1.0]
        .into_iter()
        .any(|share| ground.place(ankle + ahead * share).is_none_or(|there| !rocks(&there) || !ground.is_free(&there)))
}

/// A foot at exactly that place, where a whole sole lies there and a leg steps there from the other foot.
pub fn lying(terrain: &Terrain, physique: &Physique, by: &Plant, ankle: DVec2, yaw: f64) -> Option<Plant> {
    let ground = Ground { terrain, physique, by: Some(by), sole: Sole::new(physique, yaw, 0.0), yaw };
    let there = ground.place(ankle)?;
    (there.held >= 1.0 && ground.is_free(&there)).then_some(there.plant)
}

/// A foot at exactly that place.
pub fn stood(terrain: &Terrain, physique: &Physique, ankle: DVec2, yaw: f64) -> Plant {
    let ground = Ground { terrain, physique, by: None, sole: Sole::new(physique, yaw, 0.0), yaw };
    ground.place(ankle).map_or_else(|| nowhere(None, ankle, yaw), |there| there.plant)
}

/// The ground that bears the sole of a foot whose ankle is there, m: what rises higher beside it does not.
pub fn beneath(terrain: &Terrain, physique: &Physique, ankle: DVec3, yaw: f64) -> Option<Plant> {
    let sole = Sole::new(physique, yaw, 0.0);
    let ceiling = ankle.y - physique.ankle_height + BESIDE_SOLE * physique.leg_length / Physique::REFERENCE.leg_length;
    let foot = ankle - terrain.spot_under(ankle, 0.0).normal * physique.ankle_height;
    let at = DVec2::new(foot.x, foot.z);
    let lie = terrain.lie_under(at, &sole.points, ceiling)?;
    Some(Plant { ankle: DVec3::new(at.x, lie.height, at.y), yaw, normal: lie.normal })
}

/// m along a way, where between two places the ground goes past a height.
fn riser(terrain: &Terrain, place: DVec2, way: DVec2, [mut from, mut to]: [f64; 2], height: f64) -> f64 {
    let above = |at: f64| terrain.spot(place + way * at).height > height;
    let side = above(from);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        if above(middle) == side { from = middle } else { to = middle }
    }
    0.5 * (from + to)
}

/// m/m, by which the plane at a spot rises that way.
fn grade(spot: &Spot, way: DVec2) -> f64 {
    -(spot.normal.x * way.x + spot.normal.z * way.y) / spot.normal.y.max(0.1)
}

/// m, how far a body at `place` may go that way before a wall, a drop, a rise or a gap that no step crosses; infinite where it sees none.
pub fn free(terrain: &Terrain, params: &Params, leg: f64, place: DVec2, way: DVec2) -> f64 {
    let way = way.normalize_or_zero();
    let look = LOOK * params.size;
    let most = if params.fits { climb::HIGHEST } else { RISE } * leg;
    let here = terrain.spot(place);
    let mut last = here; // the last ground that a foot could be on
    let mut lacking = 0.0;
    let mut at = 0.0;
    while at < look {
        let next = at + STRIDE;
        let spot = terrain.spot(place + way * next);
        let over = last.height + WALLS[1] * leg;
        let walled = last.holds && {
            let [from, to] = [at, next].map(|at| place + way * at);
            terrain.wall(DVec3::new(from.x, over, from.y), DVec3::new(to.x, over, to.y)).is_some()
        };
        let stands = spot.holds && last.holds && (spot.height - last.height).abs() <= most;
        if walled {
            return (at - KEPT * params.size).max(0.0);
        }
        if stands || !last.holds {
            (last, lacking) = (spot, 0.0);
        } else {
            lacking += STRIDE;
            if lacking > GAP * params.size {
                return (next - lacking - KEPT * params.size).max(0.0);
            }
        }
        at = next;
    }
    f64::INFINITY
}
