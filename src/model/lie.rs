//! How a stiff sole lies on ground of any form, and which sole lies well enough to stand on. Ground frame, metres.
//!
//! A sole that no single plane carries lies on what is highest under it, and the rest of it hangs over an edge: never in the ground.

use super::terrain::Terrain;
use glam::{DMat3, DVec2, DVec3};

/// m, ground that bends less than this under a sole carries it as a plane does: what a shoe's sole gives.
const BENDS: f64 = 0.012;
/// m, how far below the plane of the highest point the ground may lie and still be of the same floor.
const SAME_FLOOR: f64 = 0.03;
/// m, a point of the sole so little over the ground is carried: as a sole over uneven ground (8 mm off at most there).
const CARRIED: f64 = 0.010;

/// A sole laid on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lie {
    /// m, of its plane at the place that it was laid at.
    pub height: f64,
    /// Unit, of its plane.
    pub normal: DVec3,
    /// 0..1, how much of it the ground carries; the rest is over an edge or a hole.
    pub held: f64,
    /// m, how far below it the ground is at the most.
    pub hangs: f64,
}

impl Terrain {
    /// A sole whose points lie so far from a place, (x, z), laid down there; `None` where there is nothing under it.
    pub fn lie(&self, at: DVec2, sole: &[DVec2]) -> Option<Lie> {
        let points: Vec<DVec3> = sole
            .iter()
            .filter_map(|offset| {
                let spot = self.spot(at + *offset);
                spot.holds.then(|| DVec3::new(offset.x, spot.height, offset.y))
            })
            .collect();
        laid(&points, sole.len(), |top| self.spot(at + top).normal)
    }

    /// The same for a sole that is there already, its ground no higher than `ceiling` m over the plane of what is under that place: what rises
    /// beside it does not bear it.
    pub fn lie_under(&self, at: DVec2, sole: &[DVec2], ceiling: f64) -> Option<Lie> {
        let normal = self.spot_under(DVec3::new(at.x, ceiling, at.y), 0.0).normal;
        let slope = DVec2::new(-normal.x, -normal.z) / normal.y.max(0.1);
        let spot = |offset: DVec2| {
            let height = ceiling + slope.dot(offset);
            self.spot_under(DVec3::new(at.x + offset.x, height, at.y + offset.y), 0.0)
        };
        let held = sole.iter().map(|offset| (offset, spot(*offset))).filter(|(_, spot)| spot.holds);
        let points: Vec<DVec3> = held.map(|(offset, spot)| DVec3::new(offset.x, spot.height, offset.y)).collect();
        laid(&points, sole.len(), |top| spot(top).normal)
    }
}

/// A sole of `count` points over those of them that have ground, laid down on it; `normal`: of the ground, by how far from its place.
fn laid(points: &[DVec3], count: usize, normal: impl Fn(DVec2) -> DVec3) -> Option<Lie> {
    let top = points.iter().copied().reduce(|top, point| if point.y > top.y { point } else { top })?;
    let plane = plane_of(points).filter(|plane| points.iter().all(|point| off(*plane, *point).abs() < BENDS));
    let plane = plane.unwrap_or_else(|| {
        let normal = normal(DVec2::new(top.x, top.z));
        let slope = DVec2::new(-normal.x, -normal.z) / normal.y.max(0.1);
        let highest = [top.y - slope.x * top.x - slope.y * top.z, slope.x, slope.y];
        let floor: Vec<DVec3> =
            points.iter().copied().filter(|point| off(highest, *point).abs() < SAME_FLOOR).collect();
        plane_of(&floor).unwrap_or(highest)
    });
    // The sole is stiff: nothing of the ground is in it.
    let raised = points.iter().map(|point| off(plane, *point)).fold(f64::NEG_INFINITY, f64::max);
    let hangs = points.iter().map(|point| raised - off(plane, *point)).fold(0.0, f64::max);
    let carried = points.iter().filter(|point| raised - off(plane, **point) < CARRIED).count();
    Some(Lie {
        height: plane[0] + raised,
        normal: DVec3::new(-plane[1], 1.0, -plane[2]).normalize(),
        held: carried as f64 / count.max(1) as f64,
        hangs: if points.len() < count { f64::INFINITY } else { hangs },
    })
}

/// m, how far a point of the ground is over the plane y = a + b x + c z.
fn off([a, b, c]: [f64; 3], point: DVec3) -> f64 {
    point.y - (a + b * point.x + c * point.z)
}

/// Least squares of y = a + b x + c z: a, b, c; `None` where the points lie on one line.
pub fn plane_of(points: &[DVec3]) -> Option<[f64; 3]> {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for point in points {
        let row = DVec3::new(1.0, point.x, point.z);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        right += row * point.y;
    }
    (normal.determinant().abs() > 1e-12).then(|| (normal.inverse() * right).to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::{Ground, GroundKind};

    fn sole() -> Vec<DVec2> {
        let along = |at: i32| -0.07 + 0.25 * f64::from(at) / 8.0;
        (0..=8).flat_map(|at| [-0.045, 0.0, 0.045].map(|x| DVec2::new(x, along(at)))).collect()
    }

    #[test]
    fn a_sole_over_an_edge_lies_on_the_higher_floor_and_hangs() {
        let kind = GroundKind::Stairs { rise: 0.17, tread: 0.5, count: 1 };
        let stairs = Terrain::new(&Ground { kind, ..Ground::default() });
        for (z, height, held) in [(0.5, 0.0, 1.0), (0.9, 0.17, 0.36), (1.0, 0.17, 0.67), (1.2, 0.17, 1.0)] {
            let lie = stairs.lie(DVec2::new(0.0, z), &sole()).expect("ground");
            assert!((lie.height - height).abs() < 1e-9 && lie.normal.distance(DVec3::Y) < 1e-9, "{z}: {lie:?}");
            assert!((lie.held - held).abs() < 0.12, "{z}: {lie:?}");
        }
    }

    #[test]
    fn a_sole_on_a_slope_or_on_rolling_ground_is_carried_whole_and_nowhere_in_it() {
        for kind in [GroundKind::Slope { angle: 0.3 }, GroundKind::Uneven { height: 0.05, wavelength: 1.5, seed: 9 }] {
            let ground = Terrain::new(&Ground { kind, ..Ground::default() });
            for index in 0..40 {
                let at = DVec2::new(0.1 * f64::from(index), -0.07 * f64::from(index));
                let lie = ground.lie(at, &sole()).expect("ground");
                let slope = DVec2::new(-lie.normal.x, -lie.normal.z) / lie.normal.y;
                let depth = |offset: &DVec2| ground.spot(at + *offset).height - lie.height - slope.dot(*offset);
                let deepest = sole().iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
                assert!(deepest < 1e-9 && lie.held > 0.8, "{index}: {deepest} {lie:?}");
            }
        }
    }
}
