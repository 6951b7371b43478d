//! Where a foot bears: six points of the sole's own outline, two at the heel, two over the ball, two at the tip.
//!
//! m, in the foot link's frame (scenario axes in the stand, origin at the ankle). A box around a sole is 2 to 5 cm larger at its corners
//! than the rounded sole in it: a body that stands on such corners stands on air.

use crate::maths::hull::convex_hull;
use crate::model::FootShape;
use glam::{DQuat, DVec2, DVec3};

/// Points of a sole.
pub const POINTS: usize = 6;
/// From which on they are those of the ball, and of the tip.
pub(super) const BALL: usize = 2;
/// As `BALL` says.
pub(super) const TIP: usize = 4;
/// Share of the sole's length, from either end, at which its width is taken: ends are round.
const ENDS: f64 = 0.03;
/// m at a sole of 0.27 m: flesh and rubber give, so a sole bears as far beside its outline as the measure of the zero-moment point allows.
const GIVES: f64 = 0.004;

/// The points of a sole that turned so from rest lies level: rear left and right (as one looks ahead), at the ball, at the tip.
pub(super) fn points(shape: &FootShape, stand: DQuat) -> [DVec3; POINTS] {
    let turn = stand * shape.level.inverse();
    let ahead = turn * DVec3::new(shape.forward.x, 0.0, shape.forward.y);
    let ahead = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or_zero();
    let across = DVec3::Y.cross(ahead);
    let outline = outline(shape);
    let long = shape.foremost() - shape.heel;
    let gives = GIVES * long / 0.27;
    let stations = [shape.heel + ENDS * long, shape.ball, shape.foremost() - ENDS * long];
    let mut points = [DVec3::ZERO; POINTS];
    for (pair, at) in points.chunks_exact_mut(2).zip(stations) {
        let [right, left] = width(&outline, at).unwrap_or([-shape.half_width, shape.half_width]);
        for (point, aside) in pair.iter_mut().zip([left + gives, right - gives]) {
            *point = ahead * at + across * aside - DVec3::Y * shape.ankle_height;
        }
    }
    points
}

/// The sole's outline, m: (ahead of the ankle, to its left), levelled.
fn outline(shape: &FootShape) -> Vec<DVec2> {
    let along = DVec2::new(shape.forward.x, shape.forward.y);
    let flat = |turn: DQuat, at: DVec3| {
        let at = turn * at;
        let at = DVec2::new(at.x, at.z);
        DVec2::new(at.dot(along), at.dot(DVec2::new(along.y, -along.x)))
    };
    let rear = shape.rear_sole.iter().map(|at| flat(shape.level, *at));
    let front = shape.front_sole.iter().map(|at| flat(shape.level, *at));
    convex_hull(&rear.chain(front).collect::<Vec<DVec2>>())
}

/// Right and left end of an outline at that far ahead; `None` where it does not reach.
fn width(outline: &[DVec2], at: f64) -> Option<[f64; 2]> {
    let mut found: Option<[f64; 2]> = None;
    for (index, a) in outline.iter().enumerate() {
        let b = outline[(index + 1) % outline.len()];
        let (low, high) = (a.x.min(b.x), a.x.max(b.x));
        if !(low..=high).contains(&at) {
            continue;
        }
        let share = if high - low > 1e-9 { (at - a.x) / (b.x - a.x) } else { 0.0 };
        let aside = a.y + (b.y - a.y) * share;
        let [least, most] = found.unwrap_or([aside; 2]);
        found = Some([least.min(aside), most.max(aside)]);
    }
    found.filter(|[right, left]| left - right > 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::hull::signed_distance;
    use crate::maths::real;
    use crate::measure::fixture;

    #[test]
    fn a_sole_bears_on_its_own_outline_and_not_on_a_box_around_it() {
        let body = fixture::body();
        let mut shape = body.feet[0].clone();
        // A round sole: an ellipse of 0.26 m by 0.1 m.
        let (long, wide) = (shape.foremost() - shape.heel, 2.0 * shape.half_width);
        let middle = 0.5 * (shape.foremost() + shape.heel);
        let ahead = DVec3::new(shape.forward.x, 0.0, shape.forward.y);
        let across = DVec3::Y.cross(ahead);
        let rim = |index: i32| {
            let (sin, cos) = real::sin_cos(f64::from(index) * std::f64::consts::TAU / 64.0);
            ahead * (middle + 0.5 * long * cos) + across * (0.5 * wide * sin) - DVec3::Y * shape.ankle_height
        };
        let unlevel = shape.level.inverse();
        (shape.rear_sole, shape.front_sole) = ((0..64).map(|index| unlevel * rim(index)).collect(), Vec::new());
        let hull = outline(&shape);
        let found = points(&shape, shape.level);
        for point in found {
            let at = DVec2::new(point.dot(ahead), point.dot(across));
            let out = signed_distance(&hull, at);
            assert!(out < 1.1 * GIVES * long / 0.27, "{point} is {out} m out of the sole");
            assert!((point.y + shape.ankle_height).abs() < 1e-12);
        }
        let apart = |pair: usize| found[2 * pair].distance(found[2 * pair + 1]);
        assert!(apart(0) < 0.5 * wide && apart(2) < 0.5 * wide && apart(1) > 0.8 * wide, "narrow at its ends");
    }
}
