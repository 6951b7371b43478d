//! What the feet stood on, as things to look at: a slab, a slope, stairs, rolling ground, slabs with gaps, a platform.
//!
//! As large as the way that was gone and 2 m around it. Scenario space, metres. Their tops are the terrain's own surface;
//! rolling ground is a net of triangles, within 2 mm of it.

use super::timeline::Timeline;
use crate::maths::real;
use crate::model::props::{Mesh, Prop, PropKey, Shape};
use crate::model::scenario::GroundKind;
use crate::model::{Side, Surface, Terrain, terrain};
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// m, ground around the way.
const AROUND: f64 = 2.0;
/// m, how thick the ground is drawn.
const THICK: f64 = 0.05;
/// m, how deep a gap is.
const DEEP: f64 = 0.3;
/// Cells of rolling ground along a side, at most.
const MOST_CELLS: f64 = 200.0;
/// s between the platform's keys where it turns about two axes.
const PLATFORM_KEYS: f64 = 1.0 / 60.0;
/// rad, keys of the platform that straight lines come that near to are left out.
const PLATFORM_TOLERANCE: f64 = 1e-5;
/// Linear RGB of the ground.
const STONE: [f32; 3] = [0.32, 0.34, 0.36];

/// A patch of the plane, (x, z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// m.
    pub low: DVec2,
    /// m.
    pub high: DVec2,
}

/// The ground of a run.
pub fn ground(timeline: &Timeline) -> Vec<Prop> {
    vec![ground_prop(&timeline.terrain, travelled(timeline), timeline.duration())]
}

/// Where the centre of mass and the feet went, and 2 m around.
fn travelled(timeline: &Timeline) -> Patch {
    let mut low = DVec2::splat(f64::INFINITY);
    let mut high = DVec2::splat(f64::NEG_INFINITY);
    let mut take = |point: DVec3| {
        if point.is_finite() {
            low = low.min(DVec2::new(point.x, point.z));
            high = high.max(DVec2::new(point.x, point.z));
        }
    };
    for (index, com) in timeline.com.iter().enumerate() {
        let time = index as f64 * timeline.dt;
        take(*com);
        match &timeline.played {
            Some(played) => played.ankles(&timeline.body, index).into_iter().for_each(&mut take),
            None => Side::BOTH.map(|side| timeline.feet.at(side, time).ankle).into_iter().for_each(&mut take),
        }
    }
    let fallen = timeline.played.iter().flat_map(|played| played.fallen());
    fallen.for_each(|pose| take(pose.hips));
    if !(low + high).is_finite() {
        (low, high) = (DVec2::ZERO, DVec2::ZERO);
    }
    // Whole decimetres: a clip that sways by a hair more has the same ground.
    Patch { low: ((low - AROUND) * 10.0).floor() / 10.0, high: ((high + AROUND) * 10.0).ceil() / 10.0 }
}

/// The ground over a patch. `duration`: for how long a platform is followed, s.
pub fn ground_prop(terrain: &Terrain, patch: Patch, duration: f64) -> Prop {
    let mut mesh = Mesh::default();
    let Patch { low, high } = patch;
    let mut block = |from: f64, to: f64, top: f64, bottom: f64| {
        if to > from {
            mesh.cuboid(DVec3::new(low.x, bottom, from), DVec3::new(high.x, top, to));
        }
    };
    let name = match terrain.kind {
        GroundKind::Flat => {
            block(low.y, high.y, 0.0, -THICK);
            "ground"
        }
        GroundKind::Slope { angle } => {
            mesh = slope(patch, real::tan(angle));
            "slope"
        }
        GroundKind::Stairs { rise, tread, count } => {
            let bottom = (rise * f64::from(count)).min(0.0) - THICK;
            block(low.y, high.y.min(terrain::FIRST), 0.0, bottom);
            for step in 0..count {
                let from = terrain::FIRST + tread * f64::from(step);
                let to = if step + 1 == count { high.y } else { (from + tread).min(high.y) };
                block(from.max(low.y), to, rise * f64::from(step + 1), bottom);
            }
            "stairs"
        }
        GroundKind::Gaps { width, spacing } => {
            block(low.y, high.y.min(terrain::FIRST), 0.0, -DEEP);
            let mut from = terrain::FIRST;
            while from < high.y && spacing > 0.0 {
                block(from + width, (from + spacing).min(high.y), 0.0, -DEEP);
                from += spacing;
            }
            "slabs"
        }
        GroundKind::Uneven { wavelength, .. } => {
            mesh = rolling(terrain, patch, wavelength);
            "ground"
        }
        GroundKind::Mesh { ref surface, .. } => {
            let ceiling = terrain.kind.ceiling();
            mesh = surface.as_ref().map_or_else(Mesh::default, |surface| around(surface, patch, ceiling));
            "ground"
        }
        GroundKind::Platform { .. } => {
            let half = 0.5 * terrain::PLATFORM_SIDE;
            mesh.cuboid(DVec3::new(-half, -2.0 * THICK, -half), DVec3::new(half, 0.0, half));
            "platform"
        }
    };
    let keys = if terrain.moves() { platform_keys(terrain, duration) } else { vec![PropKey::default()] };
    Prop { ground: true, keys, ..Prop::standing(name, Shape::Mesh(mesh), STONE) }
}

/// The triangles over a patch that begin under the ceiling, as they are.
fn around(surface: &Surface, patch: Patch, ceiling: f64) -> Mesh {
    let near: BTreeSet<usize> = surface.near(patch.low, patch.high).collect();
    let mut mesh = Mesh::default();
    for corners in near.into_iter().map(|index| surface.triangles()[index]) {
        let [a, b, c] = corners;
        let least = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        let beside =
            least(0) > patch.high.x || most(0) < patch.low.x || least(2) > patch.high.y || most(2) < patch.low.y;
        if beside || least(1) > ceiling {
            continue;
        }
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners);
        mesh.normals.extend([(b - a).cross(c - a).normalize_or(DVec3::Y); 3]);
        mesh.indices.extend([first, first + 1, first + 2]);
    }
    mesh
}

/// A plane that rises by `grade` along Z, with upright sides.
fn slope(patch: Patch, grade: f64) -> Mesh {
    let Patch { low, high } = patch;
    let at = |x: f64, z: f64, down: f64| DVec3::new(x, grade * z - down, z);
    let mut mesh = Mesh::default();
    let (a, b, c, d) = ([low.x, low.y], [low.x, high.y], [high.x, high.y], [high.x, low.y]);
    let top = |[x, z]: [f64; 2]| at(x, z, 0.0);
    let under = |[x, z]: [f64; 2]| at(x, z, THICK);
    mesh.quad([top(a), top(b), top(c), top(d)]);
    mesh.quad([under(a), under(d), under(c), under(b)]);
    for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
        mesh.quad([under(from), under(to), top(to), top(from)]);
    }
    mesh
}

/// A net over rolling ground with the terrain's own normals, and a rim.
fn rolling(terrain: &Terrain, patch: Patch, wavelength: f64) -> Mesh {
    let size = patch.high - patch.low;
    // A chord over 1/14 of a wave of 5 cm is about 1 mm off.
    let cells = (size / (wavelength / 14.0).clamp(0.02, 0.25)).ceil().clamp(DVec2::ONE, DVec2::splat(MOST_CELLS));
    let (columns, rows) = (cells.x as u32, cells.y as u32);
    let at = |column: u32, row: u32| patch.low + size * DVec2::new(f64::from(column), f64::from(row)) / cells;
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let place = at(column, row);
            let spot = terrain.spot(place);
            mesh.positions.push(DVec3::new(place.x, spot.height, place.y));
            mesh.normals.push(spot.normal);
        }
    }
    let top = |column: u32, row: u32| row * (columns + 1) + column;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [top(column, row), top(column, row + 1)];
            mesh.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
        }
    }
    let floor = mesh.positions.iter().map(|point| point.y).fold(0.0, f64::min) - THICK;
    let around = (0..rows)
        .map(|row| [(0, row), (0, row + 1)])
        .chain((0..columns).map(|column| [(column, rows), (column + 1, rows)]))
        .chain((0..rows).rev().map(|row| [(columns, row + 1), (columns, row)]))
        .chain((0..columns).rev().map(|column| [(column + 1, 0), (column, 0)]));
    for [from, to] in around {
        let [from, to] = [from, to].map(|(column, row)| mesh.positions[top(column, row) as usize]);
        let down = |point: DVec3| DVec3::new(point.x, floor, point.z);
        mesh.quad([down(from), down(to), to, from]);
    }
    let corners = [(0, 0), (columns, 0), (columns, rows), (0, rows)];
    let bottom = corners.map(|(column, row)| at(column, row)).map(|place| DVec3::new(place.x, floor, place.y));
    mesh.quad(bottom);
    mesh
}

/// The platform's turns, as few as straight lines need.
fn platform_keys(terrain: &Terrain, duration: f64) -> Vec<PropKey> {
    let mut times: Vec<f64> = match &terrain.kind {
        GroundKind::Platform { pitch, roll } => pitch.iter().chain(roll).map(|point| point[0]).collect(),
        _ => Vec::new(),
    };
    let count = (duration / PLATFORM_KEYS).ceil().clamp(1.0, 1e5) as usize;
    times.extend((0..=count).map(|index| (index as f64 * PLATFORM_KEYS).min(duration)));
    times.retain(|time| (0.0..=duration).contains(time));
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier < 1e-6);
    let turns: Vec<_> = times.iter().map(|time| terrain.turn(*time)).collect();
    // As long a straight line as fits, again and again.
    let fits = |from: usize, to: usize| {
        (from + 1..to).all(|at| {
            let share = (times[at] - times[from]) / (times[to] - times[from]);
            turns[from].slerp(turns[to], share).angle_between(turns[at]) < PLATFORM_TOLERANCE
        })
    };
    let mut kept = vec![0];
    while let Some(from) = kept.last().copied().filter(|from| from + 1 < times.len()) {
        let mut to = from + 1;
        let mut stride = 1;
        while to + stride < times.len() && fits(from, to + stride) {
            to += stride;
            stride *= 2;
        }
        while stride > 0 {
            if to + stride < times.len() && fits(from, to + stride) {
                to += stride;
            }
            stride /= 2;
        }
        kept.push(to);
    }
    kept.into_iter().map(|at| PropKey { time: times[at], rotation: turns[at], ..PropKey::default() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::Ground;

    fn prop(kind: GroundKind) -> (Terrain, Prop) {
        let terrain = Terrain::new(&Ground { kind, ..Ground::default() });
        let patch = Patch { low: DVec2::new(-2.1, -2.3), high: DVec2::new(2.2, 4.4) };
        let prop = ground_prop(&terrain, patch, 3.0);
        (terrain, prop)
    }

    /// m, how high the mesh is at (x, z): the highest triangle there.
    fn height(mesh: &Mesh, at: DVec2) -> Option<f64> {
        let mut highest: Option<f64> = None;
        for triangle in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|corner| mesh.positions[triangle[corner] as usize]);
            let flat = |point: DVec3| DVec2::new(point.x, point.z);
            let area = (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
            let weight = |from: DVec3, to: DVec3| (flat(to) - flat(from)).perp_dot(at - flat(from)) / area;
            let (u, v, w) = (weight(b, c), weight(c, a), weight(a, b));
            if area.abs() > 1e-12 && u.min(v).min(w) >= -1e-12 {
                let y = a.y * u + b.y * v + c.y * w;
                highest = Some(highest.map_or(y, |highest| highest.max(y)));
            }
        }
        highest
    }

    #[test]
    fn the_tops_of_all_grounds_are_the_terrain() {
        for kind in [
            GroundKind::Flat,
            GroundKind::Slope { angle: -0.4 },
            GroundKind::Stairs { rise: 0.17, tread: 0.29, count: 5 },
            GroundKind::Stairs { rise: -0.17, tread: 0.29, count: 5 },
            GroundKind::Uneven { height: 0.05, wavelength: 0.8, seed: 4 },
            GroundKind::Gaps { width: 0.2, spacing: 0.9 },
        ] {
            let (terrain, prop) = prop(kind.clone());
            let mesh = prop.shape.mesh();
            for index in 0..300_u32 {
                let draw = |prime: u32| f64::from(index * prime % 997) / 997.0;
                let at = DVec2::new(-2.0 + 4.1 * draw(331), -2.2 + 6.5 * draw(577));
                let spot = terrain.spot(at);
                match height(&mesh, at) {
                    Some(height) => assert!((height - spot.height).abs() < 2e-3 && spot.holds, "{kind:?} at {at}"),
                    None => assert!(!spot.holds, "{kind:?}: nothing at {at}"),
                }
            }
            let corner = |at: u32| mesh.positions[at as usize];
            let volume: f64 =
                mesh.indices.chunks_exact(3).map(|t| corner(t[0]).cross(corner(t[1])).dot(corner(t[2])) / 6.0).sum();
            assert!(volume > 0.1, "{kind:?}: it is inside out: {volume}");
        }
    }

    #[test]
    fn a_platforms_keys_follow_its_turn() {
        let wave =
            |at: f64| (0..7).map(|s| [f64::from(s) * 0.5, at * f64::from(s * (6 - s)) / 9.0]).collect::<Vec<_>>();
        let (terrain, platform) = prop(GroundKind::Platform { pitch: wave(0.3), roll: wave(-0.5) });
        let worst = (0..3000)
            .map(|ms| f64::from(ms) * 1e-3)
            .map(|time| platform.at(time).rotation.angle_between(terrain.turn(time)))
            .fold(0.0, f64::max);
        assert!(worst < 2e-4, "{worst} rad");
        let (_, simple) = prop(GroundKind::Platform { pitch: vec![[0.5, 0.0], [1.5, 0.3]], roll: vec![] });
        assert_eq!(simple.keys.len(), 4, "two kinks and two ends: {:?}", simple.keys);
    }
}
