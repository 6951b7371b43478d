//! How far a clip's pose is from the base's, horizontal place and heading apart. Degrees and millimetres.

use crate::maths::real;
use crate::model::{Body, BodyPose};
use glam::{DQuat, DVec2, DVec3};

/// The largest turn between joints that nodes move (degrees) and the largest distance between joints (mm), after the turn about +Y and
/// the shift along the ground that bring the joints together best.
pub fn error(body: &Body, pose: &BodyPose, base: &BodyPose) -> (f64, f64) {
    let (have, want) = (pose.positions(body), base.positions(body));
    let flat = |point: &DVec3| DVec2::new(point.x, point.z);
    let middle = |points: &[DVec3]| points.iter().map(flat).sum::<DVec2>() / points.len().max(1) as f64;
    let (here, there) = (middle(&have), middle(&want));
    let (mut dot, mut cross) = (0.0, 0.0);
    for (have, want) in have.iter().zip(&want) {
        let (have, want) = (flat(have) - here, flat(want) - there);
        dot += want.dot(have);
        // From (x, z) of the base to the clip's: about +Y, z towards x.
        cross += want.y * have.x - want.x * have.y;
    }
    let turn = DQuat::from_rotation_y(real::atan2(cross, dot));
    let angle = (0..body.joints.len())
        .filter(|joint| body.joints[*joint].animated)
        .map(|joint| (turn * base.turns[joint]).angle_between(pose.turns[joint]).to_degrees())
        .fold(0.0, f64::max);
    let to = |want: &DVec3| turn * (*want - DVec3::new(there.x, 0.0, there.y)) + DVec3::new(here.x, 0.0, here.y);
    let far = have.iter().zip(&want).map(|(have, want)| have.distance(to(want)) * 1e3).fold(0.0, f64::max);
    (angle, far)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;

    #[test]
    fn place_and_heading_are_no_error_and_a_bent_joint_is() {
        let body = fixture::body();
        let base = BodyPose::rest(&body);
        let by = DQuat::from_rotation_y(1.1);
        let mut moved = BodyPose {
            hips: by * base.hips + DVec3::new(3.0, 0.0, -2.0),
            turns: base.turns.iter().map(|turn| by * *turn).collect(),
        };
        let (deg, mm) = error(&body, &moved, &base);
        assert!(deg < 1e-4 && mm < 1e-6, "{deg} {mm}");
        let last = moved.turns.len() - 1;
        moved.turns[last] *= DQuat::from_rotation_x(0.1);
        moved.hips.y += 0.004;
        let (deg, mm) = error(&body, &moved, &base);
        assert!((deg - 5.73).abs() < 0.01 && mm > 3.9, "{deg} {mm}");
    }
}
