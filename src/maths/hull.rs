//! Convex polygons in the plane: hull, distance, containment, inward offset. Unit-free; what they hold is up to the caller.
//!
//! A polygon is a slice of its corners, counter-clockwise, none of them on the line between its neighbours; one corner
//! is a point and two are a segment, and every function takes those too. Monotone chain (Andrew 1979); the offset cuts
//! with the moved half-planes, so that a corner which the offset swallows goes away. No polygon with holes or dents.

use glam::DVec2;

/// The convex hull of points in any order: empty for none, one corner for equal points, two for points on a line.
/// Points that are not finite are left out.
pub fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted: Vec<DVec2> = points.iter().copied().filter(|point| point.is_finite()).collect();
    sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut hull: Vec<DVec2> = Vec::with_capacity(sorted.len() + 1);
    for point in &sorted {
        push_turning_left(&mut hull, 0, *point);
    }
    let lower = hull.len() - 1; // the upper chain begins at the lower one's last corner
    for point in sorted.iter().rev().skip(1) {
        push_turning_left(&mut hull, lower, *point);
    }
    hull.pop(); // the first corner again
    hull
}

/// Distance from a point to the polygon's edge: negative inside, infinite for no polygon.
pub fn signed_distance(polygon: &[DVec2], point: DVec2) -> f64 {
    match polygon {
        [] => f64::INFINITY,
        [only] => point.distance(*only),
        [a, b] => point.distance(closest_on_segment(*a, *b, point)),
        _ => {
            let nearest = edges(polygon)
                .map(|(a, b)| point.distance_squared(closest_on_segment(a, b, point)))
                .fold(f64::INFINITY, f64::min)
                .sqrt();
            if contains(polygon, point) { -nearest } else { nearest }
        }
    }
}

/// The point of the polygon (its inside counts) that is nearest; `None` for no polygon.
pub fn closest_point(polygon: &[DVec2], point: DVec2) -> Option<DVec2> {
    match polygon {
        [] => None,
        [only] => Some(*only),
        [a, b] => Some(closest_on_segment(*a, *b, point)),
        _ if contains(polygon, point) => Some(point),
        _ => edges(polygon)
            .map(|(a, b)| closest_on_segment(a, b, point))
            .min_by(|a, b| a.distance_squared(point).total_cmp(&b.distance_squared(point))),
    }
}

/// Whether a point is inside or on the edge. A point or a segment holds only what lies exactly on it.
pub fn contains(polygon: &[DVec2], point: DVec2) -> bool {
    match polygon {
        [] => false,
        [only] => *only == point,
        [a, b] => closest_on_segment(*a, *b, point) == point,
        _ => edges(polygon).all(|(a, b)| (b - a).perp_dot(point - a) >= 0.0),
    }
}

/// The polygon whose points lie `distance` or more inside this one. Where nothing does, its middle: the core that is
/// left just before the offset vanishes (a point for a round polygon, a segment for a long one).
pub fn shrink(polygon: &[DVec2], distance: f64) -> Vec<DVec2> {
    if distance <= 0.0 || polygon.len() < 2 {
        return polygon.to_vec();
    }
    if let [a, b] = polygon {
        let length = a.distance(*b);
        let along = (*b - *a) / length;
        return if length > 2.0 * distance {
            vec![*a + along * distance, *b - along * distance]
        } else {
            vec![(*a + *b) * 0.5]
        };
    }
    let cut = cut_inwards(polygon, distance);
    if !cut.is_empty() {
        return convex_hull(&cut);
    }
    let (mut holds, mut vanishes) = (0.0, distance);
    for _ in 0..40 {
        let middle = 0.5 * (holds + vanishes);
        if cut_inwards(polygon, middle).is_empty() { vanishes = middle } else { holds = middle }
    }
    // The core is thin by construction: give back its line, or its point.
    let core = convex_hull(&cut_inwards(polygon, holds));
    let mut ends = (polygon[0], polygon[0], -1.0);
    for (index, a) in core.iter().enumerate() {
        for b in &core[index..] {
            if a.distance(*b) > ends.2 {
                ends = (*a, *b, a.distance(*b));
            }
        }
    }
    if ends.2 < 1e-6 * distance { vec![(ends.0 + ends.1) * 0.5] } else { vec![ends.0, ends.1] }
}

/// The mean of the polygon's area (of its corners for a point or a segment); `None` for no polygon.
pub fn centroid(polygon: &[DVec2]) -> Option<DVec2> {
    let first = *polygon.first()?;
    let mut area = 0.0;
    let mut moment = DVec2::ZERO;
    for (a, b) in edges(polygon) {
        let twice = (a - first).perp_dot(b - first);
        area += twice;
        moment += (a + b - 2.0 * first) * twice;
    }
    if area > 0.0 {
        Some(first + moment / (3.0 * area))
    } else {
        Some(polygon.iter().sum::<DVec2>() / polygon.len() as f64)
    }
}

/// Adds a corner to a chain, taking back those that no longer turn left; the first `keep` stay.
fn push_turning_left(chain: &mut Vec<DVec2>, keep: usize, point: DVec2) {
    while chain.len() >= keep + 2 {
        let (a, b) = (chain[chain.len() - 2], chain[chain.len() - 1]);
        if (b - a).perp_dot(point - b) > 0.0 {
            break;
        }
        chain.pop();
    }
    chain.push(point);
}

/// Corner pairs, around.
fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    polygon.iter().enumerate().map(|(index, a)| (*a, polygon[(index + 1) % polygon.len()]))
}

/// Nearest point of a segment.
fn closest_on_segment(a: DVec2, b: DVec2, point: DVec2) -> DVec2 {
    let along = b - a;
    let length_squared = along.length_squared();
    if length_squared <= 0.0 {
        return a;
    }
    a + along * ((point - a).dot(along) / length_squared).clamp(0.0, 1.0)
}

/// Cuts with every edge's half-plane moved inwards (Sutherland-Hodgman); empty when nothing is left.
fn cut_inwards(polygon: &[DVec2], distance: f64) -> Vec<DVec2> {
    let (mut left, mut next) = (polygon.to_vec(), Vec::with_capacity(polygon.len() + 1));
    for (a, b) in edges(polygon) {
        let inward = (b - a).perp().normalize_or_zero();
        let depth = |point: DVec2| (point - a).dot(inward) - distance;
        next.clear();
        for (from, to) in edges(&left) {
            let (from_depth, to_depth) = (depth(from), depth(to));
            if from_depth >= 0.0 {
                next.push(from);
            }
            if (from_depth >= 0.0) != (to_depth >= 0.0) {
                next.push(from + (to - from) * (from_depth / (from_depth - to_depth)));
            }
        }
        std::mem::swap(&mut left, &mut next);
        if left.is_empty() {
            break;
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    fn square() -> Vec<DVec2> {
        convex_hull(&[dvec2(1.0, 1.0), dvec2(-1.0, -1.0), dvec2(1.0, -1.0), dvec2(-1.0, 1.0), dvec2(0.2, 0.1)])
    }

    #[test]
    fn the_hull_of_a_square_has_four_corners_counter_clockwise() {
        let hull = square();
        assert_eq!(hull.len(), 4, "{hull:?}");
        let area: f64 = edges(&hull).map(|(a, b)| 0.5 * a.perp_dot(b)).sum();
        assert_eq!(area, 4.0);
    }

    #[test]
    fn points_between_corners_are_no_corners() {
        let hull = convex_hull(&[dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(2.0, 0.0), dvec2(2.0, 1.0), dvec2(1.0, 0.5)]);
        assert_eq!(hull.len(), 3, "{hull:?}");
    }

    #[test]
    fn degenerate_hulls_are_what_they_are() {
        assert!(convex_hull(&[]).is_empty());
        assert!(convex_hull(&[dvec2(f64::NAN, 0.0)]).is_empty());
        assert_eq!(convex_hull(&[dvec2(1.0, 2.0), dvec2(1.0, 2.0)]), [dvec2(1.0, 2.0)]);
        let line: Vec<DVec2> = (0..9).map(|i| dvec2(0.1 * f64::from(i), 0.2 * f64::from(i))).collect();
        assert_eq!(convex_hull(&[line[4], line[0], line[8], line[2]]).len(), 2);
    }

    #[test]
    fn distance_is_negative_inside_and_euclidean_past_a_corner() {
        let square = square();
        assert!((signed_distance(&square, dvec2(0.25, 0.0)) + 0.75).abs() < 1e-12);
        assert!((signed_distance(&square, dvec2(4.0, 5.0)) - 5.0).abs() < 1e-12);
        assert_eq!(signed_distance(&[], dvec2(0.0, 0.0)), f64::INFINITY);
        assert!((signed_distance(&[dvec2(0.0, 0.0), dvec2(2.0, 0.0)], dvec2(1.0, 3.0)) - 3.0).abs() < 1e-12);
        assert_eq!(closest_point(&square, dvec2(4.0, 5.0)), Some(dvec2(1.0, 1.0)));
        assert_eq!(closest_point(&square, dvec2(0.3, 0.2)), Some(dvec2(0.3, 0.2)));
        assert!(contains(&square, dvec2(1.0, 0.0)) && !contains(&square, dvec2(1.0 + 1e-9, 0.0)));
    }

    #[test]
    fn shrinking_leaves_only_points_that_far_inside_and_then_the_middle() {
        let square = square();
        let inner = shrink(&square, 0.25);
        assert_eq!(inner.len(), 4);
        for corner in &inner {
            assert!((signed_distance(&square, *corner) + 0.25).abs() < 1e-12);
        }
        let gone = shrink(&square, 3.0);
        assert!(gone.iter().all(|point| point.length() < 1e-3), "{gone:?}");
        let long = convex_hull(&[dvec2(-3.0, -1.0), dvec2(3.0, -1.0), dvec2(3.0, 1.0), dvec2(-3.0, 1.0)]);
        let core = shrink(&long, 1.5);
        assert_eq!(core.len(), 2, "{core:?}");
        assert!((core[0].distance(core[1]) - 4.0).abs() < 1e-3, "{core:?}");
        assert_eq!(shrink(&[dvec2(0.0, 0.0), dvec2(1.0, 0.0)], 0.6), [dvec2(0.5, 0.0)]);
    }

    #[test]
    fn the_centroid_weighs_area_not_corners() {
        let crowded =
            convex_hull(&[dvec2(0.0, 0.0), dvec2(3.0, 0.0), dvec2(3.0, 2.0), dvec2(0.0, 2.0), dvec2(3.1, 1.0)]);
        let middle = centroid(&crowded).expect("a polygon");
        assert!((middle.y - 1.0).abs() < 1e-12 && middle.x > 1.5 && middle.x < 1.56, "{middle}");
        assert_eq!(centroid(&[]), None);
    }
}
