//! Where the ground holds a foot: its height and lean under a landing, off stair edges and gaps; feet that a platform carries.
//!
//! The controller reckons heights over the ground that carries the body (the clip adds the ground's own): here only the
//! feet know the ground. Scenario space unless a name says ground frame; metres, radians.

use super::control::wrap;
use super::{Params, Physique, Plant, State, ground, kerb, mesh, support};
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::terrain::FIRST;
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec2, DVec3};

/// s, of the reference body: a step on stairs takes no less.
pub const STAIR_STEP: f64 = 0.55;
/// s of the reference body: a tread a step no slower, or it falls from one side to the other: of 60 seeded walks with a tread in 0.54 to 0.77 s
/// none falls, in 0.84 to 1.24 s 16 of 30.
pub const SLOWEST_STAIR_STEP: f64 = 0.72;
/// m of the reference body: deeper treads are too far from one to the next for its legs to go quicker.
pub const CLIMBED: f64 = 0.6;
/// m, of the reference body: soles land so far apart.
pub const ROOM: f64 = 0.015;
/// s, of the reference body: a walker begins to slow down no sooner than its next step.
const BEGINS: f64 = 0.5;
/// m, that a sole keeps from an edge.
const EDGE: f64 = 0.01;
/// Share of a walk's speed that is along Z where it goes straight over gaps.
const STRAIGHT: f64 = 0.9;

/// The foot set down at that place of the ground as it lies at `time`, moved along Z to where the whole sole is held.
pub fn set_down(terrain: &Terrain, physique: &Physique, ankle: DVec2, yaw: f64, time: f64) -> Plant {
    match terrain.kind {
        GroundKind::Flat => Plant::level(DVec3::new(ankle.x, 0.0, ankle.y), yaw),
        GroundKind::Mesh { .. } => mesh::set_down(terrain, physique, None, ankle, yaw),
        GroundKind::Platform { .. } => {
            let normal = terrain.turn(time) * DVec3::Y;
            let height = -(normal.x * ankle.x + normal.z * ankle.y) / normal.y.max(0.1);
            Plant { ankle: DVec3::new(ankle.x, height, ankle.y), yaw, normal }
        }
        _ => {
            let at = held(terrain, physique, ankle, yaw);
            let spot = terrain.spot(at);
            Plant { ankle: DVec3::new(at.x, spot.height, at.y), yaw, normal: spot.normal }
        }
    }
}

/// The same for a foot that steps from the other one: on a mesh no higher, and through no wall.
pub fn set_down_by(terrain: &Terrain, physique: &Physique, by: &Plant, ankle: DVec2, (yaw, time): (f64, f64)) -> Plant {
    match terrain.kind {
        GroundKind::Mesh { .. } => mesh::set_down(terrain, physique, Some(by), ankle, yaw),
        _ => set_down(terrain, physique, ankle, yaw, time),
    }
}

/// The same by a body of links.
pub fn rocked(terrain: &Terrain, physique: &Physique, by: &Plant, ankle: DVec2, (yaw, time): (f64, f64)) -> Plant {
    match terrain.kind {
        GroundKind::Mesh { .. } => mesh::set_down_by(terrain, physique, by, ankle, yaw),
        _ => set_down(terrain, physique, ankle, yaw, time),
    }
}

/// The same for a step of the gait: near a kerb, where the step that leads over it needs it.
pub fn stepped(
    params: &Params,
    (terrain, physique): (&Terrain, &Physique),
    state: &State,
    by: &Plant,
    ankle: DVec2,
    (yaw, time): (f64, f64),
) -> Plant {
    if kerb::near(params, terrain, state) {
        if params.fits {
            return kerb::stood(terrain, physique, ankle, yaw);
        }
        if let Some(plant) = on_its_floor(terrain, physique, by, ankle, yaw) {
            return plant;
        }
    }
    let set_down = if params.fits { rocked } else { set_down_by };
    set_down(terrain, physique, by, ankle, (yaw, time))
}

/// On a mesh, the nearest place along Z on the floor that is under the sole's middle, as on stairs by name: there a sole that is longer than its
/// tread hangs over the edge. `None` where it does not lie there.
fn on_its_floor(terrain: &Terrain, physique: &Physique, by: &Plant, ankle: DVec2, yaw: f64) -> Option<Plant> {
    let mut short = false;
    let mut floor = |z: f64| {
        let found = terrain.floor_at(DVec2::new(ankle.x, z));
        short = found.is_some_and(|[from, to]| to - from < physique.tip - physique.heel + 2.0 * EDGE);
        found
    };
    let at = terrain.is_mesh().then(|| held_on(terrain, physique, ankle, yaw, &mut floor))?;
    mesh::lying(terrain, physique, by, at, yaw).or_else(|| short.then(|| kerb::stood(terrain, physique, at, yaw)))
}

/// The ground under the ankle of a foot that is or was somewhere: where it stands if it stands there, rad and s its yaw and the time.
pub fn beneath(terrain: &Terrain, physique: &Physique, ankle: DVec3, (yaw, time): (f64, f64)) -> Plant {
    let place = DVec2::new(ankle.x, ankle.z);
    match terrain.kind {
        GroundKind::Flat | GroundKind::Platform { .. } => set_down(terrain, physique, place, yaw, time),
        // a sole may hang over an edge before it or behind it
        GroundKind::Stairs { .. } => {
            let mut plant = kerb::stood(terrain, physique, place, yaw);
            plant.ankle.y = plant.ankle.y.max(terrain.spot(place).height);
            plant
        }
        _ => {
            if terrain.is_mesh()
                && let Some(plant) = mesh::beneath(terrain, physique, ankle, yaw)
            {
                return plant;
            }
            let normal = terrain.spot_under(ankle, 0.0).normal;
            let point = ankle - normal * physique.ankle_height;
            let spot = terrain.spot_under(DVec3::new(point.x, ankle.y, point.z), 0.0);
            Plant { ankle: DVec3::new(point.x, spot.height, point.z), yaw, normal: spot.normal }
        }
    }
}

/// The nearest place along Z where the sole is on one tread, or on one side of a gap.
fn held(terrain: &Terrain, physique: &Physique, ankle: DVec2, yaw: f64) -> DVec2 {
    held_on(terrain, physique, ankle, yaw, &mut |z| terrain.floor(z))
}

/// The same where `floor` says from where to where, along Z, the floor at a place reaches.
pub fn held_on(
    terrain: &Terrain,
    physique: &Physique,
    ankle: DVec2,
    yaw: f64,
    floor: &mut dyn FnMut(f64) -> Option<[f64; 2]>,
) -> DVec2 {
    let (toe, wide) = (real::cos(yaw), (real::sin(yaw) * physique.half_width).abs());
    let (one, two) = (toe * physique.heel, toe * physique.tip);
    let (rear, front) = (one.min(two) - wide - EDGE, one.max(two) + wide + EDGE);
    let middle = ankle.y + 0.5 * (rear + front);
    let Some([from, to]) = floor(middle) else { return ankle };
    let (low, high) = (from - rear, to - front);
    if low <= high {
        return DVec2::new(ankle.x, ankle.y.clamp(low, high));
    }
    // A sole longer than its tread keeps out of the riser and hangs over the other edge.
    let height = |z: f64| terrain.spot(DVec2::new(ankle.x, z)).height;
    let up = height(to + EDGE) > height(middle) + EDGE;
    DVec2::new(ankle.x, if up { high } else { low })
}

/// m of clear ground between two soles in plan, each a capsule from heel to tip; negative where they overlap.
pub fn clear(physique: &Physique, feet: [&Plant; 2]) -> f64 {
    let round = physique.half_width.min(0.5 * (physique.tip - physique.heel));
    let line = |foot: &Plant| {
        let toe = support::forward(foot.yaw);
        [physique.heel + round, physique.tip - round].map(|along| ground(foot.ankle) + toe * along)
    };
    let near = |[from, to]: [DVec2; 2], point: DVec2| {
        let share = ((point - from).dot(to - from) / (to - from).length_squared().max(1e-12)).clamp(0.0, 1.0);
        point.distance(from.lerp(to, share))
    };
    let [one, two] = feet.map(line);
    let beyond = |[from, to]: [DVec2; 2], point: DVec2| (to - from).perp_dot(point - from) > 0.0;
    let parts = |line: [DVec2; 2], other: [DVec2; 2]| beyond(line, other[0]) != beyond(line, other[1]);
    let crossed = parts(one, two) && parts(two, one);
    let gap = near(one, two[0]).min(near(one, two[1])).min(near(two, one[0])).min(near(two, one[1]));
    (if crossed { 0.0 } else { gap }) - 2.0 * physique.half_width
}

/// The landing of `side` moved the shortest way, outwards or along the feet, until `room` m lie between the soles; no
/// farther than a sole is long.
pub fn apart(physique: &Physique, stance: &Plant, plant: &Plant, side: Side, room: f64) -> Plant {
    if clear(physique, [stance, plant]) >= room {
        return *plant;
    }
    let way = stance.yaw + 0.5 * wrap(plant.yaw - stance.yaw);
    let (out, ahead) = (support::left(way) * side.sign(), support::forward(way));
    let mut best = (f64::INFINITY, *plant);
    for way in [out, ahead, -ahead] {
        let found = moved(physique, stance, plant, way, room);
        if found.0 < best.0 {
            best = found;
        }
    }
    best.1
}

/// How far that way, m, and where it then is.
fn moved(physique: &Physique, stance: &Plant, plant: &Plant, way: DVec2, room: f64) -> (f64, Plant) {
    let most = physique.tip - physique.heel;
    let (mut gone, mut plant) = (0.0, *plant);
    loop {
        let lack = room - clear(physique, [stance, &plant]);
        if lack <= 1e-4 * most {
            return (gone, plant);
        }
        if gone >= most {
            return (f64::INFINITY, plant);
        }
        // no nearer than by what lacks does any way lead apart
        let step = lack.max(1e-3 * most);
        plant.ankle += DVec3::new(way.x, 0.0, way.y) * step;
        gone += step;
    }
}

/// m, the longest step that the ground allows a body at `place` that goes that way: a tread, on and before stairs.
pub fn longest(terrain: &Terrain, params: &Params, place: DVec2, way: DVec2) -> f64 {
    let (tread, count) = match terrain.kind {
        GroundKind::Stairs { tread, count, .. } => (tread, count),
        GroundKind::Mesh { .. } => return mesh::longest(terrain, params.size, place, way),
        _ => return f64::INFINITY,
    };
    let ahead = 1.4 * params.size * way.y.signum(); // room to slow down in
    let (near, far) = ((place.y + ahead).min(place.y), (place.y + ahead).max(place.y));
    let end = FIRST + tread * (f64::from(count) - 1.0);
    let on = far > FIRST && near < end + 0.4 * params.size;
    // across the stairs every step is as good as another
    if on && way.y.abs() > 0.4 { tread / way.y.abs() } else { f64::INFINITY }
}

/// m/s, the fastest that a body at `place` may go that way so as to stop before what a mesh has in it.
pub fn fastest(terrain: &Terrain, params: &Params, physique: &Physique, place: DVec2, way: DVec2) -> f64 {
    let GroundKind::Mesh { .. } = terrain.kind else { return f64::INFINITY };
    let free = mesh::free(terrain, params, physique.leg_length, place, way);
    // As the command ramps down, with a step's time to begin in.
    let begins = params.ramp * BEGINS * params.tempo;
    (real::hypot(begins, (2.0 * params.ramp * free).sqrt()) - begins).max(0.0)
}

/// The plant in the ground frame as it lies at a time.
pub fn to_ground(plant: &Plant, turn: DQuat) -> Plant {
    turned(plant, turn.inverse())
}

/// A plant of the ground frame in scenario space.
pub fn from_ground(plant: &Plant, turn: DQuat) -> Plant {
    turned(plant, turn)
}

fn turned(plant: &Plant, turn: DQuat) -> Plant {
    if turn == DQuat::IDENTITY {
        return *plant;
    }
    let toe = support::along(plant);
    let toe = turn * toe;
    Plant { ankle: turn * plant.ankle, yaw: real::atan2(toe.x, toe.z), normal: turn * plant.normal }
}

/// Feet that stand on ground that turns go with it, and so does what they hold.
pub fn carry(terrain: &Terrain, params: &Params, physique: &Physique, state: &mut State) {
    if !matches!(terrain.kind, GroundKind::Platform { .. }) {
        return;
    }
    let turn = terrain.turn(state.time);
    for side in Side::BOTH {
        if state.planted(side) {
            state.feet[side as usize] = from_ground(&state.held[side as usize], turn);
        }
    }
    if state.swing.is_none() {
        state.hold(params, physique);
    }
}

/// m, a landing along the way of who walks straight over gaps, at `velocity`, that is not behind one that the foot which stands has crossed.
pub fn onward(terrain: &Terrain, physique: &Physique, velocity: DVec2, by: &Plant, along: f64) -> f64 {
    if !terrain.has_gaps() || velocity.y.abs() < STRAIGHT * velocity.length() {
        return along;
    }
    let Some([from, to]) = terrain.floor(by.ankle.z + 0.5 * (physique.heel + physique.tip)) else { return along };
    if velocity.y > 0.0 { along.max(from - physique.heel) } else { along.min(to - physique.tip) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::Ground;

    fn terrain(kind: GroundKind) -> Terrain {
        Terrain::new(&Ground { kind, ..Ground::default() })
    }

    fn sole(plant: &Plant) -> [f64; 2] {
        let physique = Physique::REFERENCE;
        [plant.ankle.z + physique.heel, plant.ankle.z + physique.tip]
    }

    #[test]
    fn a_sole_is_whole_on_one_tread_and_out_of_the_gaps() {
        let stairs = terrain(GroundKind::Stairs { rise: 0.17, tread: 0.30, count: 5 });
        let gaps = terrain(GroundKind::Gaps { width: 0.2, spacing: 1.2 });
        for index in 0..400 {
            let at = DVec2::new(0.1, 0.01 * f64::from(index));
            let plant = set_down(&stairs, &Physique::REFERENCE, at, 0.0, 0.0);
            let heights = sole(&plant).map(|z| stairs.spot(DVec2::new(0.1, z)).height);
            assert!(heights[0] == heights[1] && heights[0] == plant.ankle.y, "{at}: {heights:?} {plant:?}");
            assert!((plant.ankle.z - at.y).abs() < 0.16, "{at}: moved to {}", plant.ankle.z);
            let plant = set_down(&gaps, &Physique::REFERENCE, at, 0.0, 0.0);
            let [heel, tip] = sole(&plant);
            for z in [heel, 0.5 * (heel + tip), tip] {
                assert!(gaps.spot(DVec2::new(0.1, z)).holds, "{at}: the sole {heel}..{tip} is over a gap");
            }
        }
    }

    #[test]
    fn a_platform_carries_what_stands_on_it() {
        let platform = terrain(GroundKind::Platform { pitch: vec![[0.0, 0.0], [1.0, 0.5]], roll: vec![] });
        let plant = set_down(&platform, &Physique::REFERENCE, DVec2::new(0.2, 0.3), 0.1, 1.0);
        let held = to_ground(&plant, platform.turn(1.0));
        assert!(held.ankle.y.abs() < 1e-12 && held.normal.distance(DVec3::Y) < 1e-12);
        let back = from_ground(&held, platform.turn(1.0));
        assert!(back.ankle.distance(plant.ankle) < 1e-12 && (back.yaw - plant.yaw).abs() < 1e-12);
    }

    #[test]
    fn a_landing_is_not_behind_a_gap_that_has_been_crossed() {
        let gaps = terrain(GroundKind::Gaps { width: 0.2, spacing: 1.2 });
        let physique = Physique::REFERENCE;
        for at in [0.5, 1.9, 2.4] {
            let by = set_down(&gaps, &physique, DVec2::new(0.1, at), 0.0, 0.0);
            let [from, to] = gaps.floor(by.ankle.z + 0.5 * (physique.heel + physique.tip)).expect("it stands");
            for along in [at - 1.0, at, at + 1.0] {
                let ahead = onward(&gaps, &physique, DVec2::new(0.0, 0.4), &by, along);
                assert!(ahead + physique.heel >= from - 1e-9 && ahead >= along, "{at}, {along}: {ahead}");
                let back = onward(&gaps, &physique, DVec2::new(0.0, -0.4), &by, along);
                assert!(back + physique.tip <= to + 1e-9 && back <= along, "{at}, {along}: {back}");
                assert!(onward(&gaps, &physique, DVec2::new(0.3, 0.3), &by, along) == along, "askew");
            }
        }
    }
}
