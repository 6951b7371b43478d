//! Rotations: shortest arcs, frames, yaw, rotation vectors. Radians, right-handed, Y up.

use crate::maths::real;
use glam::{DMat3, DQuat, DVec3};

/// The least rotation that takes one direction to the other. For opposite directions, about an axis that stays near Z.
pub fn shortest_arc(from: DVec3, to: DVec3) -> DQuat {
    let (from, to) = (from.normalize_or_zero(), to.normalize_or_zero());
    if from == DVec3::ZERO || to == DVec3::ZERO {
        return DQuat::IDENTITY;
    }
    if from.dot(to) < -0.999_999 {
        let axis = (DVec3::Z - from * from.z).try_normalize().unwrap_or(DVec3::X);
        return DQuat::from_axis_angle(axis, std::f64::consts::PI);
    }
    DQuat::from_rotation_arc(from, to)
}

/// The rotation whose Y axis runs against `direction` (a bone that points down has Y up) and whose X axis is as near
/// `hinge` as a right angle allows: the frame of a limb segment. Any frame where `hinge` is along `direction`.
pub fn limb_frame(direction: DVec3, hinge: DVec3) -> DQuat {
    let y = -direction.normalize_or(DVec3::NEG_Y);
    let x = (hinge - y * hinge.dot(y)).try_normalize().unwrap_or_else(|| y.any_orthonormal_vector());
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize()
}

/// Heading of a rotated +Z, about +Y from +Z towards +X.
pub fn yaw_of(turn: DQuat) -> f64 {
    let forward = turn * DVec3::Z;
    real::atan2(forward.x, forward.z)
}

/// Rotation vector (axis x angle), angle in 0..π.
pub fn rotation_vector(turn: DQuat) -> DVec3 {
    let turn = if turn.w < 0.0 { -turn } else { turn };
    turn.to_scaled_axis()
}

/// The angle wrapped into -π..π.
pub fn wrap_angle(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortest_arc_reaches_even_the_opposite_direction() {
        for (from, to) in [(DVec3::X, DVec3::NEG_Y), (DVec3::Z, DVec3::NEG_Z), (DVec3::NEG_Y, DVec3::Y)] {
            assert!((shortest_arc(from, to) * from - to).length() < 1e-9, "{from} to {to}");
        }
    }

    #[test]
    fn limb_frame_keeps_the_direction_and_bends_the_hinge_square() {
        let frame = limb_frame(DVec3::new(0.1, -1.0, 0.3), DVec3::X);
        assert!((frame * DVec3::NEG_Y - DVec3::new(0.1, -1.0, 0.3).normalize()).length() < 1e-9, "direction");
        assert!((frame * DVec3::X).x > 0.9, "hinge");
    }
}
