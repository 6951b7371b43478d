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

    /// The report of a shove's clip whose keys are changed so.
    fn told(change: &dyn Fn(&mut crate::model::Clip)) -> crate::model::report::Drift {
        use crate::bake::{BakeOptions, Drive, Helped, RootMotion, bake, report};
        let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let rig = crate::rig::load_bytes("builtin", crate::rig::mannequin::BUILTIN, &none, None).expect("it loads");
        let drive = Drive::Ragdoll(Helped::Within(Default::default()));
        let scenario = crate::model::Scenario { duration: 2.0, ..crate::model::Scenario::demo() };
        let mut baked = bake(&rig, &scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("it bakes");
        change(&mut baked.clip);
        let input = report::ReportInput {
            rig: &rig,
            clip: &baked.clip,
            performance: &baked.performance,
            scenario: &scenario,
            seed: 0,
            root: RootMotion::Root,
        };
        report::report(&input).0.drift.expect("a ragdoll's")
    }

    #[test]
    fn a_clip_that_is_not_its_run_is_told_so() {
        use crate::model::KeyValues;
        let own = told(&|_| {});
        assert!(own.position_mm <= 5.0 && own.angle_deg <= 2.0, "{own:?}");
        // One key of all that move the body, lifted by 2 cm.
        let lifted = told(&|clip| {
            let moved = clip.channels.iter_mut().find_map(|channel| match &mut channel.values {
                KeyValues::Translation(values) if values.len() > 4 => Some(values),
                _ => None,
            });
            let values = moved.expect("something moves");
            let middle = values.len() / 2;
            values[middle][1] += 0.02;
        });
        assert!(lifted.position_mm > 15.0, "{lifted:?}");
        // Late by a tenth of a second.
        let late = told(&|clip| {
            for channel in &mut clip.channels {
                channel.times.iter_mut().skip(1).for_each(|time| *time += 0.1);
            }
        });
        assert!(late.position_mm > 20.0 && late.angle_deg > 5.0, "{late:?}");
    }
}
