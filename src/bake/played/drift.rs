//! How far a clip is from its run: the joint that is the farthest from where its link was, and the one that is turned the most.
//!
//! m and rad; joints that a link turns about (and a node moves) only: the spine above its lowest joint, collar bones and fingers go
//! with their link.

use crate::model::{Body, BodyPose};

/// The largest distance and the largest turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// m.
    pub place: f64,
    /// rad.
    pub turn: f64,
}

impl Drift {
    /// Neither is larger.
    pub fn within(&self, most: &Drift) -> bool {
        self.place <= most.place && self.turn <= most.turn
    }

    /// The larger of each.
    pub fn or(self, other: Drift) -> Drift {
        Drift { place: self.place.max(other.place), turn: self.turn.max(other.turn) }
    }
}

/// Between two poses, of these joints.
pub fn between(body: &Body, joints: &[usize], run: &BodyPose, clip: &BodyPose) -> Drift {
    let (a, b) = (run.positions(body), clip.positions(body));
    let one = |joint: &usize| Drift {
        place: a[*joint].distance(b[*joint]),
        turn: run.turns[*joint].angle_between(clip.turns[*joint]),
    };
    joints.iter().map(one).fold(Drift::default(), Drift::or)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;
    use crate::model::Role;
    use glam::{DQuat, DVec3};

    #[test]
    fn the_farthest_joint_and_the_largest_turn_are_told_each_for_itself() {
        let body = fixture::body();
        let run = BodyPose::rest(&body);
        let joints: Vec<usize> = (0..body.joints.len()).collect();
        assert_eq!(between(&body, &joints, &run, &run), Drift::default());
        let mut clip = run.clone();
        clip.hips += DVec3::new(0.003, 0.0, 0.004);
        let hand = body.joint(Role::LeftHand).expect("a hand");
        clip.turns[hand] = DQuat::from_rotation_z(0.02);
        let found = between(&body, &joints, &run, &clip);
        assert!((found.place - 0.005).abs() < 1e-9 && (found.turn - 0.02).abs() < 1e-7, "{found:?}");
        assert_eq!(between(&body, &[0], &run, &clip).turn, 0.0, "of the joints that are asked for");
    }
}
