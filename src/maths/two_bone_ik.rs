//! Two-bone inverse kinematics: where the middle joint goes. Any unit of length, any space.
//!
//! Reports where the target was out of reach instead of hiding it. Knows no joint limits: the caller bounds the reach.

use crate::maths::real;
use glam::DVec3;

/// What the chain became.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBone {
    /// The middle joint (knee, elbow).
    pub middle: DVec3,
    /// Where the end joint is: the target, or the nearest reachable point on the line to it.
    pub end: DVec3,
    /// Unit hinge axis: turning the lower bone about it by a positive angle bends the chain away from the pole.
    pub hinge: DVec3,
    /// rad, 0 for a straight chain.
    pub bend: f64,
    /// The target was within reach.
    pub reached: bool,
}

/// Solves a chain of lengths `upper` and `lower` from `root` to `target`, its middle joint towards `pole` (a direction).
/// `straightest`: the largest part of the full length that is allowed, below 1 so that the knee never locks. A chain without length
/// stays at its root.
pub fn two_bone_ik(root: DVec3, target: DVec3, upper: f64, lower: f64, pole: DVec3, straightest: f64) -> TwoBone {
    let to_target = target - root;
    let wanted = to_target.length();
    let axis = if wanted > 1e-9 { to_target / wanted } else { DVec3::NEG_Y };
    let longest = (upper + lower) * straightest;
    let sound = longest > 1e-9 && longest.is_finite() && upper > 1e-9 && lower > 1e-9 && wanted.is_finite();
    if !sound {
        return TwoBone { middle: root, end: root, hinge: DVec3::X, bend: 0.0, reached: false };
    }
    let shortest = (upper - lower).abs() + 0.02 * (upper + lower);
    let distance = wanted.clamp(shortest.min(longest), longest);
    let side = (pole - axis * pole.dot(axis)).try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
    let along = (upper * upper - lower * lower + distance * distance) / (2.0 * distance);
    let across = (upper * upper - along * along).max(0.0).sqrt();
    let middle = root + axis * along + side * across;
    let end = root + axis * distance;
    let (thigh, shank) = ((middle - root) / upper, (end - middle) / lower);
    TwoBone {
        middle,
        end,
        hinge: side.cross(axis).normalize(),
        bend: real::acos(thigh.dot(shank).clamp(-1.0, 1.0)),
        reached: (wanted - distance).abs() < 1e-9,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn keeps_both_lengths_and_bends_towards_the_pole_under_any_turn() {
        for turn in
            [DQuat::IDENTITY, DQuat::from_rotation_y(1.0), DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.0, -2.0)]
        {
            let target = turn * DVec3::new(0.1, -0.6, 0.2);
            let leg = two_bone_ik(DVec3::ZERO, target, 0.42, 0.41, turn * DVec3::Z, 0.999);
            assert!(leg.reached && (leg.end - target).length() < 1e-12, "end");
            assert!((leg.middle.length() - 0.42).abs() < 1e-12, "upper length");
            assert!(((leg.end - leg.middle).length() - 0.41).abs() < 1e-12, "lower length");
            assert!((turn.inverse() * leg.middle).z > 0.1, "knee forward");
            assert!((turn.inverse() * leg.hinge).x > 0.9, "hinge to the left, so that flexion is positive about it");
        }
    }

    #[test]
    fn a_chain_without_length_or_with_a_lost_target_stays_at_its_root() {
        for (upper, target) in [(0.0, DVec3::X), (0.4, DVec3::NAN), (f64::NAN, DVec3::X)] {
            let leg = two_bone_ik(DVec3::Y, target, upper, 0.4, DVec3::Z, 0.999);
            assert!(!leg.reached && leg.end == DVec3::Y && leg.hinge.is_finite(), "{leg:?}");
        }
    }

    #[test]
    fn says_when_the_target_is_too_far() {
        let leg = two_bone_ik(DVec3::ZERO, DVec3::new(0.0, -2.0, 0.0), 0.42, 0.41, DVec3::Z, 0.995);
        assert!(!leg.reached && (leg.end.length() - 0.83 * 0.995).abs() < 1e-9, "{leg:?}");
    }
}
