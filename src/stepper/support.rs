//! The support area on the ground: the hull of the soles, or the paper's circles and capsule. (x, z), metres.
//!
//! Fixed arrays, no allocation. A support is a convex polygon of at most eight corners, grown by a radius: two soles
//! give eight corners and radius 0, two circles give two corners and their radius, two capsules four and theirs.

use super::{Params, Physique, Plant};
use crate::maths::real;
use crate::model::scenario::SupportModel;
use glam::{DVec2, DVec3};

/// Corners of a round outline: it is 0.2 % of the radius too small.
const ROUND: usize = 48;

/// The part of a sole that carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tread {
    /// Heel to tip.
    Whole,
    /// From the ball line on: the heel is rising.
    Ball,
}

/// A convex area on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    corners: [DVec2; 8],
    count: usize,
    radius: f64,
}

/// (x, z) unit vector that the yaw points along.
pub fn forward(yaw: f64) -> DVec2 {
    DVec2::new(real::sin(yaw), real::cos(yaw))
}

/// (x, z) unit vector to the left of the yaw.
pub fn left(yaw: f64) -> DVec2 {
    DVec2::new(real::cos(yaw), -real::sin(yaw))
}

/// Unit vector on the ground under a foot, the way that it points.
pub fn along(plant: &Plant) -> DVec3 {
    let level = DVec3::new(real::sin(plant.yaw), 0.0, real::cos(plant.yaw));
    let rise = -(level.dot(plant.normal)) / plant.normal.y.max(0.1);
    (level + DVec3::Y * rise).normalize()
}

impl Support {
    /// Under one foot, its edge drawn in by `margin` m.
    pub fn one(params: &Params, physique: &Physique, plant: &Plant, tread: Tread, margin: f64) -> Support {
        let mut corners = [DVec2::ZERO; 8];
        let (count, radius) = corners_of(params, physique, plant, tread, margin, &mut corners);
        Support { corners, count, radius }
    }

    /// Under both feet and between them.
    pub fn two(params: &Params, physique: &Physique, plants: [&Plant; 2], treads: [Tread; 2], margin: f64) -> Support {
        let mut corners = [DVec2::ZERO; 8];
        let (first, radius) = corners_of(params, physique, plants[0], treads[0], margin, &mut corners);
        let (second, _) = corners_of(params, physique, plants[1], treads[1], margin, &mut corners[first..]);
        if params.support == SupportModel::Circles {
            return Support { corners, count: first + second, radius };
        }
        // Fewer than eight corners: the first again and again, which the hull leaves out.
        let (first_one, all) = (corners[0], first + second);
        corners[all..].fill(first_one);
        let (corners, count) = hull(corners);
        Support { corners, count, radius }
    }

    /// How far outside the area the point is, m; negative inside.
    pub fn outside(&self, point: DVec2) -> f64 {
        let (on_edge, inside) = self.edge(point);
        let gap = point.distance(on_edge);
        (if inside { -gap } else { gap }) - self.radius
    }

    /// The point itself where it is inside, else the nearest one of the area.
    pub fn nearest(&self, point: DVec2) -> DVec2 {
        let (on_edge, inside) = self.edge(point);
        let gap = point.distance(on_edge);
        if inside || gap <= self.radius { point } else { on_edge + (point - on_edge) * (self.radius / gap) }
    }

    /// The outline, counter-clockwise seen with x to the right and z up; what is round as [`ROUND`] corners.
    pub fn outline(&self) -> Vec<DVec2> {
        let corners = &self.corners[..self.count];
        if self.radius <= 0.0 {
            return corners.to_vec();
        }
        let farthest = |toward: DVec2| {
            let corner = corners.iter().copied().max_by(|a, b| a.dot(toward).total_cmp(&b.dot(toward)));
            corner.unwrap_or_default() + self.radius * toward
        };
        let step = std::f64::consts::TAU / ROUND as f64;
        (0..ROUND).map(|at| farthest(DVec2::new(real::cos(at as f64 * step), real::sin(at as f64 * step)))).collect()
    }

    /// The nearest point on the polygon's outline, and whether the point is inside of it.
    fn edge(&self, point: DVec2) -> (DVec2, bool) {
        let corners = &self.corners[..self.count];
        let mut best = corners[0];
        let mut best_gap = f64::INFINITY;
        let mut inside = self.count > 2;
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[if i + 1 == self.count { 0 } else { i + 1 }];
            let (along, to) = (b - a, point - a);
            if along.perp_dot(to) < 0.0 {
                inside = false;
            }
            let share = (to.dot(along) / along.length_squared().max(1e-18)).clamp(0.0, 1.0);
            let on = a + along * share;
            let gap = on.distance_squared(point);
            if gap < best_gap {
                (best, best_gap) = (on, gap);
            }
        }
        (best, inside)
    }
}

fn corners_of(
    params: &Params,
    physique: &Physique,
    plant: &Plant,
    tread: Tread,
    margin: f64,
    into: &mut [DVec2],
) -> (usize, f64) {
    let ankle = DVec2::new(plant.ankle.x, plant.ankle.z);
    let (sin, cos) = real::sin_cos(plant.yaw);
    let (mut ahead, mut side) = (DVec2::new(sin, cos), DVec2::new(cos, -sin));
    if plant.normal != DVec3::Y {
        // as the leaning sole is seen from above
        let toe = along(plant);
        let left = plant.normal.cross(toe);
        (ahead, side) = (DVec2::new(toe.x, toe.z), DVec2::new(left.x, left.z));
    }
    let middle = 0.5 * (physique.heel + physique.tip);
    if params.support == SupportModel::Circles {
        into[0] = ankle + ahead * middle;
        return (1, (params.circle_radius - margin).max(0.0));
    }
    let half = 0.5 * (physique.tip - physique.heel);
    let margin = margin.min(0.9 * half).min(0.9 * physique.half_width);
    if params.support == SupportModel::Capsules {
        let round = physique.half_width.min(half);
        let ball = physique.heel + 0.72 * 2.0 * half + round;
        let rear = if tread == Tread::Ball { ball } else { physique.heel + round };
        let front = physique.tip - round;
        (into[0], into[1]) = (ankle + ahead * rear.min(front), ankle + ahead * front);
        return (2, round - margin);
    }
    let rear = match tread {
        Tread::Whole => physique.heel + margin,
        Tread::Ball => (physique.heel + 0.72 * 2.0 * half).min(physique.tip - margin),
    };
    let (front, out) = (physique.tip - margin, physique.half_width - margin);
    into[0] = ankle + ahead * rear - side * out;
    into[1] = ankle + ahead * rear + side * out;
    into[2] = ankle + ahead * front + side * out;
    into[3] = ankle + ahead * front - side * out;
    (4, 0.0)
}

/// Convex hull of eight points, counter-clockwise by `perp_dot` (monotone chain on the stack).
fn hull(mut points: [DVec2; 8]) -> ([DVec2; 8], usize) {
    for i in 1..8 {
        let mut j = i;
        while j > 0 && (points[j].x, points[j].y) < (points[j - 1].x, points[j - 1].y) {
            points.swap(j, j - 1);
            j -= 1;
        }
    }
    let mut chain = [DVec2::ZERO; 16];
    let mut count = 0;
    for &point in &points {
        count = push(&mut chain, count, 0, point);
    }
    let base = count - 1;
    for &point in points.iter().rev().skip(1) {
        count = push(&mut chain, count, base, point);
    }
    count -= 1; // the first point again
    let mut corners = [DVec2::ZERO; 8];
    let count = count.min(8);
    corners[..count].copy_from_slice(&chain[..count]);
    (corners, count)
}

fn push(chain: &mut [DVec2; 16], mut count: usize, base: usize, point: DVec2) -> usize {
    while count >= base + 2 && (chain[count - 1] - chain[count - 2]).perp_dot(point - chain[count - 2]) <= 0.0 {
        count -= 1;
    }
    chain[count] = point;
    count + 1
}

#[cfg(test)]
mod tests {
    use super::super::Style;
    use super::*;
    use crate::model::scenario::Stepper;
    use glam::DVec3;

    fn foot(x: f64, z: f64, yaw: f64) -> Plant {
        Plant::level(DVec3::new(x, 0.0, z), yaw)
    }

    fn params(support: SupportModel) -> Params {
        Params::new(
            &Physique::REFERENCE,
            &Style { variant: Stepper { support, ..Stepper::default() }, ..Style::default() },
        )
    }

    #[test]
    fn a_sole_reaches_from_heel_to_tip_and_across() {
        let (params, body) = (params(SupportModel::Soles), Physique::REFERENCE);
        let sole = Support::one(&params, &body, &foot(1.0, 2.0, 0.0), Tread::Whole, 0.0);
        for (x, z, out) in
            [(1.0, 2.28, 0.1), (1.0, 1.83, 0.1), (1.145, 2.0, 0.1), (0.855, 2.0, 0.1), (1.0, 2.05, -0.045)]
        {
            assert!((sole.outside(DVec2::new(x, z)) - out).abs() < 1e-12, "{x} {z}");
        }
        let ball = Support::one(&params, &body, &foot(1.0, 2.0, 0.0), Tread::Ball, 0.0);
        assert!(ball.outside(DVec2::new(1.0, 2.05)) > 0.05 && ball.outside(DVec2::new(1.0, 2.15)) < 0.0);
    }

    #[test]
    fn a_capsule_is_a_sole_without_its_corners() {
        let body = Physique::REFERENCE;
        let under = |model: SupportModel| Support::one(&params(model), &body, &foot(0.0, 0.0, 0.0), Tread::Whole, 0.0);
        let (sole, capsule) = (under(SupportModel::Soles), under(SupportModel::Capsules));
        let (tip, side) = (body.tip, body.half_width);
        for on_both in [DVec2::new(0.0, tip), DVec2::new(0.0, body.heel), DVec2::new(side, 0.0)] {
            assert!(sole.outside(on_both).abs() < 1e-12 && capsule.outside(on_both).abs() < 1e-12, "{on_both}");
        }
        let corner = capsule.outside(DVec2::new(side, tip));
        assert!((corner - side * (2.0_f64.sqrt() - 1.0)).abs() < 1e-12, "{corner}");
    }

    #[test]
    fn a_foot_turned_left_points_left() {
        let (params, body) = (params(SupportModel::Soles), Physique::REFERENCE);
        let sole = Support::one(&params, &body, &foot(0.0, 0.0, std::f64::consts::FRAC_PI_2), Tread::Whole, 0.0);
        assert!(sole.outside(DVec2::new(0.17, 0.0)) < 0.0 && sole.outside(DVec2::new(-0.08, 0.0)) > 0.0);
    }

    #[test]
    fn two_feet_hold_what_lies_between_them_whatever_their_order() {
        let body = Physique::REFERENCE;
        for model in [SupportModel::Soles, SupportModel::Circles, SupportModel::Capsules] {
            let params = params(model);
            let (one, two) = (foot(0.3, 0.5, 0.4), foot(-0.2, -0.1, -0.2));
            let ab = Support::two(&params, &body, [&one, &two], [Tread::Whole; 2], 0.01);
            let ba = Support::two(&params, &body, [&two, &one], [Tread::Whole; 2], 0.01);
            assert!(ab.outside(DVec2::new(0.06, 0.24)) < 0.0);
            for i in 0..100 {
                let point = DVec2::new(0.02 * f64::from(i % 10) - 0.3, 0.1 * f64::from(i / 10) - 0.4);
                assert!((ab.outside(point) - ba.outside(point)).abs() < 1e-12);
                let near = ab.nearest(point);
                assert!(ab.outside(near) < 1e-12 && (near.distance(point) - ab.outside(point).max(0.0)).abs() < 1e-12);
            }
        }
    }
}
