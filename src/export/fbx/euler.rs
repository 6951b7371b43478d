//! Rotations as the three angles that FBX animates: about X, then Y, then Z, in degrees.
//!
//! A rotation is said by many triples. Each frame takes the one that is nearest to the frame before, so that curves have no jumps of
//! 180 or 360 degrees.

use crate::maths::real;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Cosine of the middle angle below which the other two turn about one axis (gimbal lock): the first then stays as it was.
const LOCKED: f64 = 1e-7;

/// Degrees: the triple of that rotation nearest to `before`.
pub fn nearest(rotation: DQuat, before: DVec3) -> DVec3 {
    let before = before.map(f64::to_radians);
    let matrix = DMat3::from_quat(rotation.normalize());
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let across = real::hypot(x.x, x.y);
    let middle = real::atan2(-x.z, across);
    let first = if across > LOCKED {
        DVec3::new(real::atan2(y.z, z.z), middle, real::atan2(x.y, x.x))
    } else {
        // Only the sum or the difference of the outer angles shows: the first stays.
        let (sine, cosine) = real::sin_cos(before.x);
        let y = y * cosine - z * sine; // with the first angle taken off: (-sin, cos, 0) of the last
        DVec3::new(before.x, middle, real::atan2(-y.x, y.y))
    };
    let second = DVec3::new(first.x + PI, PI - first.y, first.z + PI);
    let [first, second] = [first, second].map(|angles| {
        DVec3::from_array(std::array::from_fn(|axis| {
            angles[axis] + TAU * ((before[axis] - angles[axis]) / TAU).round()
        }))
    });
    let way = |angles: DVec3| (angles - before).abs().element_sum();
    let chosen = if way(second) < way(first) { second } else { first };
    chosen.map(f64::to_degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(angles: DVec3) -> DQuat {
        let [x, y, z] = angles.map(f64::to_radians).to_array();
        DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x)
    }

    #[test]
    fn the_angles_say_the_rotation_also_in_gimbal_lock() {
        for x in [-170.0, -35.0, 0.0, 20.0, 179.0] {
            for y in [-120.0, -90.0, -89.9999, 0.0, 45.0, 90.0, 100.0] {
                for z in [-95.0, 0.0, 60.0] {
                    for before in [DVec3::ZERO, DVec3::new(300.0, -80.0, 500.0)] {
                        let wanted = turn(DVec3::new(x, y, z));
                        let said = turn(nearest(wanted, before));
                        assert!(wanted.angle_between(said) < 2e-6, "{x} {y} {z} from {before}: {said}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_turn_of_two_rounds_and_one_through_the_pole_have_no_jump() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.2, 1.0, -0.1).normalize()] {
            let mut before = DVec3::ZERO;
            for step in 0..=720 {
                let angles = nearest(DQuat::from_axis_angle(axis, f64::from(step).to_radians()), before);
                let most = if axis == DVec3::new(0.2, 1.0, -0.1).normalize() { 20.0 } else { 1.001 };
                assert!((angles - before).abs().max_element() <= most, "{axis} at {step}: {before} to {angles}");
                before = angles;
            }
        }
    }
}
