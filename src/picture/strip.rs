//! A strip of poses as capsule figures, straight from [`BodyPose`]s: what a pose solver's author looks at.

use super::compose::{Frame, Header, Layout, Trail, page};
use super::figure::{figure, flat};
use super::marks::Overlay;
use crate::model::{Body, BodyPose};
use image::RgbaImage;

/// Front, side and plan of each pose. `overlays` has one a pose, or none at all: then the centre of mass is shown alone.
pub fn stick_strip(body: &Body, poses: &[(f64, BodyPose)], overlays: &[Overlay], title: &str) -> RgbaImage {
    let mut frames: Vec<Frame> = poses
        .iter()
        .enumerate()
        .map(|(at, (time, pose))| Frame {
            time: *time,
            label: String::new(),
            surfaces: figure(body, pose),
            overlay: overlays.get(at).cloned().unwrap_or_else(|| Overlay::of_pose(body, pose, &[])),
            ..Frame::default()
        })
        .collect();
    for at in 1..frames.len() {
        let (before, rest) = frames.split_at_mut(at);
        let last = &before[at - 1].overlay;
        if rest[0].overlay.prints.is_empty() {
            let mut prints = last.prints.clone();
            prints.extend(last.soles.iter().cloned());
            rest[0].overlay.prints = prints;
        }
    }
    let trail: Trail = frames
        .iter()
        .filter_map(|frame| frame.overlay.com.map(|com| (frame.time, flat(com), frame.overlay.xi)))
        .collect();
    let header = Header { title: title.to_owned(), ..Header::default() };
    page(&frames, &trail, &header, &Layout::fitting(frames.len()))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::model::{BodyJoint, FootShape, Role, Segment, Side, report::Part};
    use crate::picture::{Push, marks};
    use glam::{DMat3, DQuat, DVec2, DVec3};

    /// A person of 1.78 m, arms hanging.
    pub(crate) fn person() -> Body {
        use Role::*;
        let rows: &[(Role, Option<Role>, [f64; 3])] = &[
            (Hips, None, [0.0, 0.97, 0.0]),
            (Spine, Some(Hips), [0.0, 1.08, -0.01]),
            (Chest, Some(Spine), [0.0, 1.26, -0.02]),
            (Neck, Some(Chest), [0.0, 1.48, -0.02]),
            (Head, Some(Neck), [0.0, 1.56, 0.0]),
            (LeftUpperArm, Some(Chest), [0.19, 1.42, -0.02]),
            (LeftLowerArm, Some(LeftUpperArm), [0.23, 1.13, -0.03]),
            (LeftHand, Some(LeftLowerArm), [0.25, 0.88, 0.02]),
            (RightUpperArm, Some(Chest), [-0.19, 1.42, -0.02]),
            (RightLowerArm, Some(RightUpperArm), [-0.23, 1.13, -0.03]),
            (RightHand, Some(RightLowerArm), [-0.25, 0.88, 0.02]),
            (LeftUpperLeg, Some(Hips), [0.09, 0.92, 0.0]),
            (LeftLowerLeg, Some(LeftUpperLeg), [0.09, 0.50, 0.02]),
            (LeftFoot, Some(LeftLowerLeg), [0.09, 0.08, -0.02]),
            (LeftToes, Some(LeftFoot), [0.09, 0.02, 0.11]),
            (RightUpperLeg, Some(Hips), [-0.09, 0.92, 0.0]),
            (RightLowerLeg, Some(RightUpperLeg), [-0.09, 0.50, 0.02]),
            (RightFoot, Some(RightLowerLeg), [-0.09, 0.08, -0.02]),
            (RightToes, Some(RightFoot), [-0.09, 0.02, 0.11]),
        ];
        let index = |role: Role| rows.iter().position(|row| row.0 == role);
        let joints: Vec<BodyJoint> = rows
            .iter()
            .map(|(role, parent, rest)| BodyJoint {
                role: *role,
                parent: parent.and_then(index),
                rest: DVec3::from(*rest),
                animated: true,
            })
            .collect();
        let foot = |ankle: Role, toe: Role| FootShape {
            ankle: index(ankle).expect("an ankle"),
            toe: index(toe),
            ankle_height: 0.08,
            forward: DVec2::Y,
            heel: -0.07,
            ball: 0.13,
            tip: 0.20,
            half_width: 0.048,
            level: DQuat::IDENTITY,
            toe_level: DQuat::IDENTITY,
            rear_sole: vec![],
            front_sole: vec![],
        };
        let segment = |joint: usize, mass: f64| Segment { joint, mass, centre: DVec3::ZERO, inertia: DMat3::IDENTITY };
        Body {
            segments: vec![segment(0, 40.0), segment(2, 32.0)],
            feet: [foot(LeftFoot, LeftToes), foot(RightFoot, RightToes)],
            joints,
            mass: 72.0,
            height: 1.78,
            leg_length: 0.84,
            flanks: [0.0; 2],
            belly: 0.0,
            flesh: vec![],
        }
    }

    /// Stands, leans, with the left arm out.
    fn leaning(body: &Body, lean: f64) -> BodyPose {
        let mut pose = BodyPose::rest(body);
        for (joint, turn) in pose.turns.iter_mut().enumerate().take(11) {
            *turn = DQuat::from_rotation_z(lean);
            let role = body.joints[joint].role;
            if matches!(role, Role::LeftUpperArm | Role::LeftLowerArm | Role::LeftHand) {
                *turn = DQuat::from_rotation_z(lean + 1.2);
            }
        }
        pose
    }

    fn count(image: &RgbaImage, near: [u8; 3]) -> usize {
        let close = |pixel: &&image::Rgba<u8>| (0..3).all(|c| pixel[c].abs_diff(near[c]) < 28);
        image.pixels().filter(close).count()
    }

    fn sample() -> RgbaImage {
        let body = person();
        let poses: Vec<(f64, BodyPose)> =
            (0..4).map(|at| (at as f64 * 0.1, leaning(&body, at as f64 * 0.06))).collect();
        let overlays: Vec<Overlay> = poses
            .iter()
            .enumerate()
            .map(|(at, (_, pose))| {
                let mut overlay = Overlay::of_pose(&body, pose, &[(Side::Left, Part::Flat), (Side::Right, Part::Ball)]);
                overlay.xi = Some(DVec2::new(-0.05 * at as f64, 0.02));
                overlay.cop = Some(DVec2::new(0.03, 0.05));
                if at == 1 {
                    overlay.pushes = vec![Push { point: DVec3::new(0.0, 1.3, 0.0), force: DVec3::NEG_X * 300.0 }];
                }
                overlay
            })
            .collect();
        stick_strip(&body, &poses, &overlays, "a strip of four")
    }

    #[test]
    fn the_same_strip_twice_has_the_same_bytes() {
        assert_eq!(crate::picture::png(&sample()), crate::picture::png(&sample()));
    }

    #[test]
    fn a_push_paints_red_and_the_feet_their_own_colours() {
        let image = sample();
        assert!(count(&image, marks::PUSH) > 60, "red {}", count(&image, marks::PUSH));
    }
}
