//! Geometry of a sole: the plane that a set of points would rest on, and the few points that stand for many.
//!
//! Metres, Y up. Knows no feet.

use glam::{DVec2, DVec3};

/// No foot rests on a plane steeper than this, tangent of the angle from the bind pose.
const STEEPEST: f64 = 1.8;
/// Points kept for each of the two parts of a sole.
const MOST_POINTS: usize = 20;

/// The unit normal of the lower hull's face under `at` (x, z): the plane on which these points would come to rest.
///
/// A linear programme in the plane y = a x + b z + c under all points, as high as can be at `at`: constraints are added
/// where they are broken most, and the few that bind are tried in threes.
pub(super) fn resting_normal(points: &[DVec3], at: DVec2) -> DVec3 {
    let Some(low) = points.iter().copied().reduce(|a, b| if b.y < a.y { b } else { a }) else { return DVec3::Y };
    let lowest = low.y;
    let reach = 10.0;
    let wall = lowest + reach * STEEPEST;
    let local = |point: DVec3| DVec3::new(point.x - at.x, point.y, point.z - at.y);
    // Far points bound the slope.
    let mut active: Vec<DVec3> = vec![
        DVec3::new(reach, wall, 0.0),
        DVec3::new(-reach, wall, 0.0),
        DVec3::new(0.0, wall, reach),
        DVec3::new(0.0, wall, -reach),
    ];
    active.push(local(low));
    let mut best = DVec3::new(0.0, 0.0, lowest);
    for _ in 0..64 {
        best = highest_plane(&active).unwrap_or(best);
        let under = |point: DVec3| best.x * point.x + best.y * point.z + best.z - point.y;
        active.retain(|point| under(*point) > -1e-9);
        let worst = points.iter().map(|point| local(*point)).max_by(|a, b| under(*a).total_cmp(&under(*b)));
        match worst {
            Some(worst) if under(worst) > 1e-7 => active.push(worst),
            _ => break,
        }
    }
    DVec3::new(-best.x, 1.0, -best.y).normalize()
}

/// Among the planes (a, b, c) through three of the points and under all of them, the one highest at the origin.
fn highest_plane(points: &[DVec3]) -> Option<DVec3> {
    let mut best: Option<DVec3> = None;
    for (first, p) in points.iter().enumerate() {
        for (second, q) in points.iter().enumerate().skip(first + 1) {
            for r in points.iter().skip(second + 1) {
                let (u, v) = (*q - *p, *r - *p);
                let area = u.z * v.x - u.x * v.z;
                if area.abs() < 1e-12 {
                    continue;
                }
                let a = (u.z * v.y - u.y * v.z) / area;
                let b = (u.y * v.x - u.x * v.y) / area;
                let c = p.y - a * p.x - b * p.z;
                let plane_is_under = points.iter().all(|point| a * point.x + b * point.z + c <= point.y + 1e-9);
                if plane_is_under && best.is_none_or(|best| c > best.z) {
                    best = Some(DVec3::new(a, b, c));
                }
            }
        }
    }
    best
}

/// At most [`MOST_POINTS`] of these: the hull of all seen from above, and the hull of those that touch the ground, which a
/// rounded shoe's outermost points do not.
pub(super) fn thin(points: &[usize], flat: &dyn Fn(usize) -> DVec2, laid: &[DVec3]) -> Vec<usize> {
    let mut sorted: Vec<usize> = points.to_vec();
    sorted.sort_by(|&a, &b| {
        let (p, q) = (flat(a), flat(b));
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(laid[a].y.total_cmp(&laid[b].y)).then(a.cmp(&b))
    });
    sorted.dedup_by(|a, b| (flat(*a) - flat(*b)).length() < 1e-6);
    let lowest = sorted.iter().map(|&index| laid[index].y).fold(f64::INFINITY, f64::min);
    let touching: Vec<usize> = sorted.iter().copied().filter(|&index| laid[index].y < lowest + TOUCHING).collect();
    let mut kept = hull(&sorted, flat, MOST_POINTS / 2);
    for index in hull(&touching, flat, MOST_POINTS / 2) {
        if !kept.contains(&index) {
            kept.push(index);
        }
    }
    kept
}

/// m, over the lowest point: what still touches level ground.
const TOUCHING: f64 = 0.002;

/// The hull of points sorted by place, its least corners dropped until there are at most `most`.
fn hull(sorted: &[usize], flat: &dyn Fn(usize) -> DVec2, most: usize) -> Vec<usize> {
    let turn = |a: usize, b: usize, c: usize| (flat(b) - flat(a)).perp_dot(flat(c) - flat(a));
    let mut hull: Vec<usize> = Vec::new();
    for pass in 0..2 {
        let start = hull.len();
        let order: Vec<usize> = if pass == 0 { sorted.to_vec() } else { sorted.iter().rev().copied().collect() };
        for index in order {
            while hull.len() >= start + 2 && turn(hull[hull.len() - 2], hull[hull.len() - 1], index) <= 1e-12 {
                hull.pop();
            }
            hull.push(index);
        }
        hull.pop();
    }
    if hull.is_empty() {
        hull = sorted.first().copied().into_iter().collect();
    }
    while hull.len() > most {
        let count = hull.len();
        let least = (0..count)
            .map(|at| (at, turn(hull[(at + count - 1) % count], hull[at], hull[(at + 1) % count])))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |entry| entry.0);
        hull.remove(least);
    }
    hull
}
