//! The residual: the least force and moment, beyond what the contacts can supply, that a motion needs.
//!
//! What contacts can supply is the cone of wrenches about the centre of mass that friction cones at the support's
//! corners span: it holds unilateral normals, |tangent| <= mu normal, a pressure inside the support, and the yaw that
//! friction allows, on one plane or on several. The residual is the needed wrench less the nearest of that cone, forces
//! measured in body weights, moments in body weight x height (non-negative least squares, Lawson & Hanson 1974, over
//! eight edges a corner, one of them along the needed tangent so that it is exact there and short by at most 8 % in
//! between). A sample that a closed-form test shows to be inside skips that.

use super::dynamics::Wrench;
use super::support::Support;
use super::{GRAVITY, zmp::zmp};
use crate::maths::real;
use glam::DVec3;
use std::f64::consts::TAU;

/// Edges of the pyramid in a corner's friction cone.
const EDGES: usize = 8;
/// Rows of a wrench.
const ROWS: usize = 6;
type Row = [f64; ROWS];

/// Weight (N) and height (m): the units of a residual.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    /// N.
    pub weight: f64,
    /// m.
    pub height: f64,
}

impl Units {
    /// A body's own.
    pub fn of(body: &crate::model::Body) -> Units {
        Units { weight: body.mass * GRAVITY, height: body.height.max(1e-3) }
    }
}

/// The missing wrench (N, N m): needed less the nearest that the support can give with that friction.
pub fn residual(support: Option<&Support>, needed: Wrench, com: DVec3, friction: f64, units: Units) -> Wrench {
    let Some(support) = support.filter(|support| !support.corners.is_empty()) else { return needed };
    if support.level && surely_inside(support, needed, com, friction, units) {
        return Wrench::default();
    }
    let tangent = needed.force - support.normal * needed.force.dot(support.normal);
    let mut edges: Vec<Row> = Vec::with_capacity(EDGES * support.corners.len());
    for (point, normal) in &support.corners {
        let towards = (tangent - *normal * tangent.dot(*normal)).normalize_or(normal.any_orthonormal_vector());
        let across = normal.cross(towards);
        for edge in 0..EDGES {
            let angle = TAU * edge as f64 / EDGES as f64;
            let force = *normal + (towards * real::cos(angle) + across * real::sin(angle)) * friction;
            edges.push(row(force, (*point - com).cross(force) / units.height));
            if friction <= 0.0 {
                break;
            }
        }
    }
    let wanted = row(needed.force / units.weight, needed.moment / (units.weight * units.height));
    let missing = beyond_cone(&edges, wanted);
    Wrench {
        force: DVec3::new(missing[0], missing[1], missing[2]) * units.weight,
        moment: DVec3::new(missing[3], missing[4], missing[5]) * (units.weight * units.height),
    }
}

/// Sufficient, not necessary: pressing, not slipping, the ZMP inside, and the yaw within what two half loads on either
/// side of the ZMP, as far apart as the support is deep there, can twist.
fn surely_inside(support: &Support, needed: Wrench, com: DVec3, friction: f64, units: Units) -> bool {
    let normal = needed.force.dot(support.normal);
    let tangent = (needed.force - support.normal * normal).length();
    let at = zmp(support, needed, com, units.weight);
    let depth = -support.outside(at);
    if normal <= 0.0 || tangent > friction * normal || depth < 0.0 || normal < 0.1 * units.weight {
        return false;
    }
    let yaw = support.normal.dot(needed.moment + (com - support.in_space(at)).cross(needed.force));
    yaw.abs() <= (friction * normal - tangent) * depth
}

/// A wrench in one row.
fn row(force: DVec3, moment: DVec3) -> Row {
    [force.x, force.y, force.z, moment.x, moment.y, moment.z]
}

fn dot(a: &Row, b: &Row) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `wanted` less the nearest point of the cone that the edges span (Lawson-Hanson active set).
fn beyond_cone(edges: &[Row], wanted: Row) -> Row {
    let mut used: Vec<usize> = Vec::with_capacity(ROWS); // edges with a weight over 0
    let mut weights: Vec<f64> = Vec::with_capacity(ROWS);
    let mut missing = wanted;
    let mut barred: Vec<usize> = Vec::new(); // edges that depend on the used ones
    for _ in 0..100 {
        // The edge that helps most.
        let mut best = (None, 1e-9);
        for (index, edge) in edges.iter().enumerate() {
            let gain = dot(edge, &missing);
            if gain > best.1 && !used.contains(&index) && !barred.contains(&index) {
                best = (Some(index), gain);
            }
        }
        let Some(enters) = best.0 else { break };
        if used.len() >= ROWS {
            break;
        }
        used.push(enters);
        weights.push(0.0);
        // Least squares on the used edges; back off to where the first weight turns negative, drop it, again.
        let mut stuck = false;
        loop {
            let Some(free) = least_squares(edges, &used, &wanted) else {
                used.pop();
                weights.pop();
                stuck = true;
                break;
            };
            if free.iter().all(|weight| *weight > 0.0) {
                weights = free;
                break;
            }
            let step = weights
                .iter()
                .zip(&free)
                .filter(|(_, to)| **to <= 0.0)
                .map(|(from, to)| if from > to { from / (from - to) } else { 0.0 })
                .fold(1.0, f64::min);
            for (weight, to) in weights.iter_mut().zip(&free) {
                *weight += step * (to - *weight);
            }
            let before = used.len();
            let kept: Vec<(usize, f64)> =
                used.iter().copied().zip(weights.iter().copied()).filter(|(_, weight)| *weight > 1e-12).collect();
            (used, weights) = kept.into_iter().unzip();
            if used.is_empty() || used.len() == before {
                stuck = used.len() == before;
                break;
            }
        }
        missing = wanted;
        for (index, weight) in used.iter().zip(&weights) {
            for (left, part) in missing.iter_mut().zip(&edges[*index]) {
                *left -= weight * part;
            }
        }
        if stuck {
            barred.push(enters);
        } else {
            barred.clear();
        }
    }
    missing
}

/// Weights of the used edges that come nearest to `wanted`, signs free (normal equations, Cholesky); `None` where the
/// edges depend on each other.
fn least_squares(edges: &[Row], used: &[usize], wanted: &Row) -> Option<Vec<f64>> {
    let count = used.len();
    let mut lower = [[0.0; ROWS]; ROWS];
    let mut right = [0.0; ROWS];
    for i in 0..count {
        let edge = &edges[used[i]];
        for j in 0..=i {
            let mut sum = dot(edge, &edges[used[j]]);
            sum -= lower[i].iter().zip(&lower[j]).take(j).map(|(a, b)| a * b).sum::<f64>();
            if i == j {
                if sum < 1e-12 {
                    return None;
                }
                lower[i][i] = sum.sqrt();
            } else {
                lower[i][j] = sum / lower[j][j];
            }
        }
        let mut sum = dot(edge, wanted);
        sum -= lower[i].iter().zip(&right).take(i).map(|(a, b)| a * b).sum::<f64>();
        right[i] = sum / lower[i][i];
    }
    for i in (0..count).rev() {
        for k in i + 1..count {
            right[i] -= lower[k][i] * right[k];
        }
        right[i] /= lower[i][i];
    }
    Some(right[..count].to_vec())
}

#[cfg(test)]
mod tests {
    use super::super::support::{Support, support};
    use super::super::{Track, fixture};
    use super::*;
    use glam::dvec3;

    fn stand() -> (Support, DVec3, Units) {
        let body = fixture::body();
        let poses = fixture::poses(&body, 2, |_, _| {});
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let stand = support(&track, &fixture::standing(), 0).expect("in contact");
        (stand, fixture::com(&body), Units::of(&body))
    }

    /// The wrench about `com` of a force at a point, with a twist about the vertical.
    fn pressing(com: DVec3, at: DVec3, force: DVec3, yaw: f64) -> Wrench {
        Wrench { force, moment: (at - com).cross(force) + DVec3::Y * yaw }
    }

    #[test]
    fn what_the_ground_can_give_leaves_nothing() {
        let (stand, com, units) = stand();
        for (x, z) in [(0.0, 0.05), (0.144, 0.189), (-0.144, -0.059), (0.05, 0.18)] {
            for yaw in [-60.0, -5.0, 0.0, 5.0, 60.0] {
                let needed = pressing(com, dvec3(x, 0.0, z), dvec3(120.0, 780.0, -200.0), yaw);
                let left = residual(Some(&stand), needed, com, 1.0, units);
                // Hard up in a corner friction has no arm to twist with: there only the gentle yaw must fit.
                if yaw == 0.0 || x.abs() < 0.1 {
                    // 1 cm from an edge the strong yaw is at its limit, where the pyramid is a hair short of the cone.
                    assert!(left.force.length() < 0.2 && left.moment.length() < 0.5, "{x} {z} {yaw}: {left:?}");
                }
            }
        }
    }

    #[test]
    fn the_short_cut_and_the_full_search_agree() {
        let (stand, com, units) = stand();
        let mut inside = 0;
        for index in 0..400_u32 {
            let draw = |k: u32| f64::from((index * 7919 + k * 104_729) % 1000) / 1000.0 - 0.5;
            let at = dvec3(0.4 * draw(1), 0.0, 0.07 + 0.4 * draw(2));
            let needed =
                pressing(com, at, dvec3(900.0 * draw(3), 500.0 + 900.0 * draw(4), 900.0 * draw(5)), 120.0 * draw(6));
            if surely_inside(&stand, needed, com, 1.0, units) {
                inside += 1;
                let mut tilted = stand.clone();
                tilted.level = false; // keeps the short cut out
                let left = residual(Some(&tilted), needed, com, 1.0, units);
                // Eight edges instead of a cone: up to 8 % of the tangent may be missing between two of them.
                assert!(left.force.length() < 0.03 * units.weight, "{index}: {left:?}");
            }
        }
        assert!(inside > 40, "only {inside} draws were inside: the test tests nothing");
    }

    #[test]
    fn what_is_missing_is_the_least_that_can_be() {
        // The conditions of a least distance to a cone: no edge would help, and what is missing stands square on what
        // is given.
        let (stand, com, units) = stand();
        let mut out = 0;
        for index in 0..500_u32 {
            let draw = |k: u32| f64::from((index * 7919 + k * 104_729) % 1000) / 1000.0 - 0.5;
            let mut edges = Vec::new();
            for (point, normal) in &stand.corners {
                for edge in 0..EDGES {
                    let (sin, cos) = real::sin_cos(TAU * edge as f64 / EDGES as f64);
                    let force = *normal + dvec3(cos, 0.0, sin) * 0.8;
                    edges.push(row(force, (*point - com).cross(force) / units.height));
                }
            }
            let at = dvec3(0.4 * draw(1), 0.0, 0.07 + 0.3 * draw(2));
            let force = dvec3(1.2 * draw(3), 1.0 + 1.6 * draw(4), 1.2 * draw(5));
            let pressed = pressing(com, at, force, 0.2 * draw(6));
            let wanted = row(pressed.force, pressed.moment / units.height);
            let missing = beyond_cone(&edges, wanted);
            let given: Row = std::array::from_fn(|i| wanted[i] - missing[i]);
            for edge in &edges {
                assert!(dot(edge, &missing) < 1e-6, "{index}: an edge still helps by {}", dot(edge, &missing));
            }
            assert!(dot(&given, &missing).abs() < 1e-6, "{index}: {}", dot(&given, &missing));
            out += usize::from(dot(&missing, &missing) > 1e-8);
        }
        assert!(out > 100 && out < 500, "{out} of 500 lay outside: the draw tests nothing");
    }

    #[test]
    fn beyond_friction_the_tangent_is_missing() {
        let (stand, com, units) = stand();
        let needed = pressing(com, dvec3(0.0, 0.0, 0.05), dvec3(600.0, 800.0, 0.0), 0.0);
        let left = residual(Some(&stand), needed, com, 0.5, units);
        // Nearest wrench of the cone: the pressure moves, but at least (600 - 0.5 F_n) must be missing at some F_n.
        assert!(left.force.length() > 100.0 && left.force.length() < 205.0, "{left:?}");
        assert_eq!(residual(Some(&stand), needed, com, 1.0, units), Wrench::default());
    }

    #[test]
    fn the_ground_does_not_pull() {
        let (stand, com, units) = stand();
        let needed = Wrench { force: dvec3(0.0, -300.0, 0.0), moment: DVec3::ZERO };
        let left = residual(Some(&stand), needed, com, 1.0, units);
        assert!((left.force - needed.force).length() < 1e-6, "{left:?}");
    }

    #[test]
    fn in_flight_all_that_is_needed_is_missing() {
        let (_, com, units) = stand();
        let needed = Wrench { force: dvec3(10.0, 500.0, 0.0), moment: dvec3(1.0, 2.0, 3.0) };
        assert_eq!(residual(None, needed, com, 1.0, units), needed);
    }

    #[test]
    fn a_pressure_outside_is_missing_its_arm() {
        let (stand, com, units) = stand();
        // 10 cm past the left edge at x = 0.145: weight x 0.1 m, less what a sideways force may make up.
        let needed = pressing(com, dvec3(0.245, 0.0, 0.05), dvec3(0.0, 800.0, 0.0), 0.0);
        let left = residual(Some(&stand), needed, com, 1.0, units);
        let score =
            real::hypot(left.force.length() / units.weight, left.moment.length() / (units.weight * units.height));
        let arm_alone = 80.0 / (units.weight * units.height);
        assert!(score > 0.5 * arm_alone && score <= arm_alone + 1e-9, "{score} against {arm_alone}");
    }
}
