//! A capture's motion on another body, by humanoid role, with its feet held where the source's bear.
//!
//! Clip space in, clip space out (m, Y up, the file's heading); the target's floor is y = 0. Segments take the source's directions
//! (`retarget_turns`), feet are held where the source's bear (`retarget_planted`, `retarget_feet`), pelvis and legs follow (`retarget_pose`);
//! walks on the spot and cycles keep being that (`retarget_cycle`). Bones keep their lengths: what a capture stretches is lost. Keeps no
//! hand off the body.

pub use super::retarget_cycle::belt;
pub use super::retarget_planted::Planted;

use super::retarget_cycle::{cycle, middle as middle_of_three, moved, stances_of_middle, three, thrice};
use super::retarget_planted::{Stance, source_feet};
use super::retarget_pose::Work;
use crate::model::capture::ToldPush;
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Capture};
use glam::DVec3;

/// m: joints that rest nearer to each other are the same.
const SAME: f64 = 1e-6;
/// The motion of `capture` on another body. The same fps, frames, name and clip space; the floor of the source's feet becomes y = 0. On the
/// source's own body it is the source's motion.
pub fn retarget(capture: &Capture, body: &Body) -> Capture {
    retarget_by(capture, body, None)
}

/// The same, with the stances that somebody else knows (the audit, the clip's own extras), by the source's frames.
pub fn retarget_with(capture: &Capture, body: &Body, planted: &[Planted]) -> Capture {
    retarget_by(capture, body, Some(planted))
}

/// When the source's feet bear, as [`retarget`] holds them; of a walk on the spot, on the ground that goes by ([`belt`]).
pub fn planted(capture: &Capture) -> Vec<Planted> {
    stances(capture).iter().map(|stance| stance.planted).collect()
}

/// The same by the part of the sole that bears: each stance in pieces, and m, how high over the source's floor it stands.
pub fn planted_parts(capture: &Capture) -> Vec<(Planted, Part, f64)> {
    let pieces = |stance: Stance| {
        let Planted { side, start, .. } = stance.planted;
        let mut pieces: Vec<(Planted, Part, f64)> = Vec::new();
        for (frame, part) in (start..).zip(&stance.parts) {
            match pieces.last_mut() {
                Some(last) if last.1 == *part => last.0.end = frame,
                _ => pieces.push((Planted { side, start: frame, end: frame }, *part, stance.height)),
            }
        }
        pieces
    };
    stances(capture).into_iter().flat_map(pieces).collect()
}

fn stances(capture: &Capture) -> Vec<Stance> {
    let (still, _) = on_its_ground(capture);
    match cycle(&still) {
        Some(travel) => stances_of_middle(source_feet(&three(&still, travel), None).stances, still.frames()),
        None => source_feet(&still, None).stances,
    }
}

/// The clip where its ground is still, and m/s, how that goes by in the clip itself.
fn on_its_ground(capture: &Capture) -> (Capture, DVec3) {
    let belt = belt(capture).unwrap_or(DVec3::ZERO);
    let mut still = capture.clone();
    if belt != DVec3::ZERO {
        moved(&mut still, -belt);
    }
    (still, belt)
}

/// Whether two bodies have the same joints at the same places.
pub fn same_joints(a: &Body, b: &Body) -> bool {
    a.joints.len() == b.joints.len()
        && a.joints.iter().zip(&b.joints).all(|(one, other)| {
            one.role == other.role && one.parent == other.parent && one.rest.abs_diff_eq(other.rest, SAME)
        })
}

fn retarget_by(capture: &Capture, body: &Body, told: Option<&[Planted]>) -> Capture {
    if same_joints(&capture.body, body) {
        let pose = |frame: usize| BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() };
        return on_body(capture, body, &(0..capture.frames()).map(pose).collect::<Vec<_>>(), Vec::new());
    }
    let (still, belt) = on_its_ground(capture);
    let frames = still.frames();
    let travel = cycle(&still);
    let mut out = match travel {
        Some(travel) => {
            let told = told.map(|told| thrice(told, frames));
            middle_of_three(&on_ground(&three(&still, travel), body, told.as_deref(), Some(frames)), body, frames)
        }
        None => on_ground(&still, body, told, None),
    };
    if belt != DVec3::ZERO {
        moved(&mut out, belt * (body.leg_length / capture.body.leg_length.max(1e-6)));
        out.notes.push(format!("the clip walks on the spot: its ground goes by at {:.2} m/s", belt.length()));
    }
    if travel.is_some() {
        out.notes.push("the clip ends as it begins, and so it does here".to_owned());
    }
    out
}

/// A clip whose ground is still. `cycle`: its frames, where it is three times one.
fn on_ground(capture: &Capture, body: &Body, told: Option<&[Planted]>, cycle: Option<usize>) -> Capture {
    let source = source_feet(capture, told);
    let work = Work::new(capture, body);
    let (held, slides) = match cycle {
        Some(frames) => (stances_of_middle(source.stances.clone(), frames).len(), source.slides.div_ceil(3)),
        None => (source.stances.len(), source.slides),
    };
    on_body(capture, body, &work.poses(&source), work.notes(held, slides))
}

/// The capture with other poses, of another body.
fn on_body(capture: &Capture, body: &Body, poses: &[BodyPose], notes: Vec<String>) -> Capture {
    let joints = capture.body.joints.as_slice();
    let pushes = capture.pushes.iter().map(|push| {
        let role = push.joint.and_then(|joint| joints.get(joint)).map(|joint| joint.role);
        ToldPush { joint: role.and_then(|role| body.joint(role)), ..push.clone() }
    });
    let mut out = Capture {
        name: capture.name.clone(),
        fps: capture.fps,
        body: body.clone(),
        positions: Vec::with_capacity(poses.len() * body.joints.len()),
        turns: Vec::with_capacity(poses.len() * body.joints.len()),
        units_to_metres: capture.units_to_metres,
        up: capture.up.clone(),
        confidence: capture.confidence,
        method: capture.method.clone(),
        notes: capture.notes.iter().cloned().chain(notes).collect(),
        pushes: pushes.collect(),
    };
    let mut places = Vec::new();
    for pose in poses {
        pose.positions_into(body, &mut places);
        out.positions.extend_from_slice(&places);
        out.turns.extend_from_slice(&pose.turns);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;
    use crate::measure::fixture;
    use crate::model::{BodyJoint, Role, Side};
    use glam::DQuat;

    fn capture(body: &Body, frames: usize, mut pose: impl FnMut(usize, &mut BodyPose)) -> Capture {
        let poses: Vec<BodyPose> = (0..frames)
            .map(|frame| {
                let mut at = BodyPose::rest(body);
                pose(frame, &mut at);
                at
            })
            .collect();
        let empty = Capture {
            name: "made".into(),
            fps: 30.0,
            body: body.clone(),
            positions: vec![],
            turns: vec![],
            units_to_metres: 1.0,
            up: "+Y".into(),
            confidence: 1.0,
            method: String::new(),
            notes: vec![],
            pushes: vec![],
        };
        on_body(&empty, body, &poses, vec![])
    }

    /// Arms out, palms down, instead of hanging; and long legs on high ankles.
    fn other_body() -> Body {
        let mut body = fixture::body().with_leg_scale(1.3);
        for side in Side::BOTH {
            let own = |role: Role| if side == Side::Left { role } else { role.mirrored() };
            let shoulder = body.joints[body.joint(own(Role::LeftUpperArm)).expect("an arm")].rest;
            for (role, out) in [(Role::LeftLowerArm, 0.3), (Role::LeftHand, 0.55)] {
                let joint = body.joint(own(role)).expect("an arm");
                body.joints[joint].rest = shoulder + DVec3::X * out * side.sign();
            }
            let foot = &mut body.feet[side as usize];
            foot.ankle_height += 0.03;
            foot.rear_sole.iter_mut().chain(&mut foot.front_sole).for_each(|vertex| vertex.y -= 0.03);
        }
        body.joints.iter_mut().for_each(|joint| joint.rest.y += 0.03);
        body
    }

    fn lowest(capture: &Capture, frame: usize, side: Side) -> f64 {
        let pose = BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() };
        let (rear, front) = pose.sole(&capture.body, capture.at(frame), side);
        rear.iter().chain(&front).map(|vertex| vertex.y).fold(f64::INFINITY, f64::min)
    }

    fn direction(capture: &Capture, frame: usize, from: Role, to: Role) -> DVec3 {
        let at = |role| capture.at(frame)[capture.body.joint(role).expect("a joint")];
        (at(to) - at(from)).normalize()
    }

    #[test]
    fn on_its_own_body_a_clip_is_itself() {
        let body = fixture::body();
        let clip = capture(&body, 12, |frame, pose| {
            pose.hips += DVec3::new(0.1, -0.01, 0.02) * frame as f64;
            pose.turns[3] = DQuat::from_rotation_x(0.1 * frame as f64);
        });
        let same = retarget(&clip, &body);
        assert!(same.turns == clip.turns && same.positions == clip.positions);
    }

    #[test]
    fn a_raised_arm_points_the_same_way_on_a_body_that_rests_with_its_arms_out() {
        let body = fixture::body();
        let (upper, lower) = (body.joint(Role::LeftUpperArm).expect("an arm"), body.joint(Role::LeftLowerArm));
        let clip = capture(&body, 9, |frame, pose| {
            pose.turns[upper] = DQuat::from_rotation_x(-0.2 * frame as f64);
            for joint in [lower.expect("an arm"), body.joint(Role::LeftHand).expect("a hand")] {
                pose.turns[joint] = DQuat::from_rotation_x(-0.3 * frame as f64);
            }
        });
        let out = retarget(&clip, &other_body());
        for frame in 0..9 {
            for (from, to) in [(Role::LeftUpperArm, Role::LeftLowerArm), (Role::RightLowerArm, Role::RightHand)] {
                let (is, shall) = (direction(&out, frame, from, to), direction(&clip, frame, from, to));
                assert!(is.angle_between(shall) < 1e-6, "frame {frame}: {is} for {shall}");
            }
        }
        // The elbow's hinge came along: the upper arm's own X axis at rest, which was across, is now up or down.
        let hinge = out.turns_at(0)[out.body.joint(Role::LeftUpperArm).expect("an arm")] * DVec3::Y;
        assert!(hinge.x.abs() > 0.999, "{hinge}");
    }

    #[test]
    fn who_stands_stands_flat_on_longer_legs_and_higher_ankles() {
        let clip = capture(&fixture::body(), 20, |_, _| {});
        let out = retarget(&clip, &other_body());
        for frame in 0..20 {
            for side in Side::BOTH {
                assert!(lowest(&out, frame, side).abs() < 1e-6, "{}", lowest(&out, frame, side));
            }
        }
        assert!(out.at(5)[0].y > clip.at(5)[0].y + 0.2, "on long legs the hips are high");
    }

    #[test]
    fn a_foot_that_shivers_in_its_stance_is_held_and_let_go_gently() {
        let body = fixture::body();
        let clip = capture(&body, 60, |frame, pose| {
            // It sways by 2 cm on feet that go with it, then walks off in the air.
            pose.hips.x += 0.004 * real::sin(frame as f64 * 0.2);
            pose.hips.y += if frame > 40 { 0.02 * (frame - 40) as f64 } else { 0.0 };
        });
        let out = retarget(&clip, &other_body());
        let ankle = out.body.feet[0].ankle;
        let first = out.at(0)[ankle];
        for frame in 0..38 {
            assert!(out.at(frame)[ankle].distance(first) < 1e-9, "frame {frame}");
        }
        for frame in 1..60 {
            let step = out.at(frame)[ankle].distance(out.at(frame - 1)[ankle]);
            assert!(step < 0.05, "frame {frame}: {step} m");
        }
        assert!(lowest(&out, 59, Side::Left) > 0.3, "it flies");
    }

    #[test]
    fn a_spine_of_three_shares_what_a_spine_of_two_bends() {
        let body = fixture::body();
        let mut other = body.clone();
        let chest = body.joint(Role::Chest).expect("a chest");
        let rest = body.joints[chest].rest + DVec3::Y * 0.1;
        let upper = BodyJoint { role: Role::UpperChest, parent: Some(chest), rest, animated: true };
        other.joints.insert(chest + 1, upper);
        for joint in other.joints.iter_mut().skip(chest + 2) {
            joint.parent = joint.parent.map(|parent| parent + usize::from(parent >= chest));
        }
        other.feet.iter_mut().for_each(|foot| {
            foot.ankle += 1;
            foot.toe = foot.toe.map(|toe| toe + 1);
        });
        let above: Vec<usize> = (chest..body.joints.len())
            .filter(|joint| !body.joints[*joint].role.name().contains("Leg"))
            .filter(|joint| !["Foot", "Toes"].iter().any(|part| body.joints[*joint].role.name().contains(part)))
            .collect();
        let clip = capture(&body, 4, |_, pose| {
            above.iter().for_each(|joint| pose.turns[*joint] = DQuat::from_rotation_x(0.6));
        });
        let out = retarget(&clip, &other);
        let bend = |role: Role| {
            let turn = out.turns_at(2)[out.body.joint(role).expect("a spine")];
            turn.to_scaled_axis().x
        };
        assert!((bend(Role::UpperChest) - 0.6).abs() < 1e-9 && (bend(Role::Head) - 0.6).abs() < 1e-9);
        assert!(bend(Role::Chest) > 0.3 && bend(Role::Chest) < 0.6, "{}", bend(Role::Chest));
        assert!(bend(Role::Spine) >= 0.0 && bend(Role::Spine) < 0.2, "{}", bend(Role::Spine));
    }

    #[test]
    fn a_walk_on_the_spot_is_told_from_one_that_gets_somewhere() {
        let body = fixture::body();
        // Both feet go back at 1 m/s under hips that stay: a belt.
        let clip = capture(&body, 20, |frame, pose| pose.hips.z -= frame as f64 / 30.0);
        let mut stays = clip.clone();
        let joints = body.joints.len();
        for (index, place) in stays.positions.iter_mut().enumerate() {
            if index % joints == 0 {
                place.z += (index / joints) as f64 / 30.0;
            }
        }
        let found = belt(&stays).expect("a belt");
        assert!((found - DVec3::NEG_Z).length() < 1e-6, "{found}");
        assert_eq!(belt(&clip), None, "a slide of the whole body is none");
        assert_eq!(belt(&capture(&body, 20, |_, _| {})), None);
    }

    #[test]
    fn nothing_of_no_sense_panics() {
        let (body, other) = (fixture::body(), other_body());
        assert_eq!(retarget(&capture(&body, 0, |_, _| {}), &other).frames(), 0);
        assert_eq!(retarget(&capture(&body, 1, |_, _| {}), &other).frames(), 1);
        let mut broken = capture(&body, 9, |_, _| {});
        broken.turns[40] = DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0);
        broken.positions[60] = DVec3::INFINITY;
        retarget(&broken, &other);
        let mut flat = other.clone();
        flat.joints.iter_mut().for_each(|joint| joint.rest = DVec3::ZERO);
        flat.leg_length = 0.0;
        let clip = capture(&body, 9, |frame, pose| pose.hips.y += 0.01 * frame as f64);
        retarget(&clip, &flat);
        let planted = |side, start, end| Planted { side, start, end };
        let told = [planted(Side::Left, 2, 6), planted(Side::Left, 4, 90), planted(Side::Right, 70, 80)];
        retarget_with(&clip, &other, &told);
    }
}
