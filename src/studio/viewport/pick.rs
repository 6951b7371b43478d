//! Which bone the pointer is on: the ray against the body's bones as capsules. Scenario space, metres.

use crate::model::{Body, Role};
use glam::DVec3;

/// How thick a bone is for the pointer, of the body's height.
fn thickness(role: Role) -> f64 {
    match role {
        Role::Hips | Role::Spine | Role::Chest | Role::UpperChest => 0.085,
        Role::Head => 0.065,
        Role::LeftUpperLeg | Role::RightUpperLeg => 0.055,
        Role::LeftLowerLeg | Role::RightLowerLeg | Role::LeftShoulder | Role::RightShoulder | Role::Neck => 0.042,
        _ => 0.035,
    }
}

/// The bone that a ray meets first, and where its joint is.
pub fn bone(body: &Body, positions: &[DVec3], eye: DVec3, ray: DVec3) -> Option<(Role, DVec3)> {
    let mut nearest: Option<(f64, usize)> = None;
    for (index, joint) in body.joints.iter().enumerate() {
        if !grabbed(joint.role) {
            continue;
        }
        let radius = thickness(joint.role) * body.height;
        for end in ends(body, positions, index) {
            if let Some(far) = meets(eye, ray, positions[index], end, radius)
                && nearest.is_none_or(|(best, _)| far < best)
            {
                nearest = Some((far, index));
            }
        }
    }
    nearest.map(|(_, index)| (body.joints[index].role, positions[index]))
}

/// Bones that can be pushed by themselves: no fingers, no eyes.
fn grabbed(role: Role) -> bool {
    use Role::*;
    matches!(
        role,
        Hips | Spine
            | Chest
            | UpperChest
            | Neck
            | Head
            | LeftShoulder
            | RightShoulder
            | LeftUpperArm
            | RightUpperArm
            | LeftLowerArm
            | RightLowerArm
            | LeftHand
            | RightHand
            | LeftUpperLeg
            | RightUpperLeg
            | LeftLowerLeg
            | RightLowerLeg
            | LeftFoot
            | RightFoot
    )
}

/// Where a bone goes from its joint: to the joints below it; a last one goes on as its parent came.
fn ends(body: &Body, positions: &[DVec3], joint: usize) -> Vec<DVec3> {
    let below = |(index, below): (usize, &crate::model::BodyJoint)| {
        (below.parent == Some(joint) && grabbed(below.role)).then_some(positions[index])
    };
    let mut ends: Vec<DVec3> = body.joints.iter().enumerate().filter_map(below).collect();
    if ends.is_empty() {
        let from = body.joints[joint].parent.map_or(positions[joint], |parent| positions[parent]);
        let along = (positions[joint] - from).normalize_or(DVec3::Y);
        ends.push(positions[joint] + along * 0.06 * body.height);
    }
    ends
}

/// How far along a ray it comes within `radius` of the segment, m.
fn meets(eye: DVec3, ray: DVec3, a: DVec3, b: DVec3, radius: f64) -> Option<f64> {
    let (bone, off) = (b - a, a - eye);
    // The nearest points of a line and a segment.
    let (length, lean) = (bone.length_squared().max(1e-12), bone.dot(ray));
    let slant = length - lean * lean;
    let share = if slant < 1e-12 { 0.0 } else { ((lean * off.dot(ray)) - off.dot(bone)) / slant };
    let on_bone = a + bone * share.clamp(0.0, 1.0);
    let far = (on_bone - eye).dot(ray);
    let gap = (eye + ray * far).distance(on_bone);
    (far > 0.0 && gap < radius).then(|| far - (radius * radius - gap * gap).sqrt())
}

/// m, how far from a point the flesh reaches that way: what lies within a hand's length of the body's height, arms before
/// the trunk too.
pub fn reach(body: &Body, turns: &[glam::DQuat], positions: &[DVec3], point: DVec3, along: DVec3) -> f64 {
    let deepest = 0.17 * body.height;
    let leaves = |flesh: &crate::model::Flesh| {
        let (turn, joint) = (*turns.get(flesh.joint)?, *positions.get(flesh.joint)?);
        // Leaving the ellipsoid in the box.
        let to_box = (turn * flesh.turn).inverse();
        let half = flesh.half.max(DVec3::splat(1e-3));
        let from = (to_box * (point - joint - turn * flesh.middle)) / half;
        let way = (to_box * along) / half;
        let (square, mixed, rest) = (way.length_squared(), way.dot(from), from.length_squared() - 1.0);
        let root = (mixed * mixed - square * rest).max(-1.0);
        (root >= 0.0 && square > 1e-9).then(|| (root.sqrt() - mixed) / square)
    };
    let within = body.flesh.iter().filter_map(leaves).filter(|far| (0.0..deepest).contains(far));
    let furthest = within.fold(0.0, f64::max);
    if furthest > 0.0 { furthest } else { 0.05 * body.height }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::BodyPose;
    use crate::rig;

    #[test]
    fn a_ray_at_a_bone_meets_it_and_one_beside_the_body_meets_none() {
        let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let rig = rig::load_bytes("builtin", rig::mannequin::BUILTIN, &none, None).expect("the rig inside");
        let positions = BodyPose::rest(&rig.body).positions(&rig.body);
        let eye = DVec3::new(0.4, 1.3, 4.0);
        for role in [Role::LeftLowerLeg, Role::RightLowerArm, Role::Head] {
            let joint = rig.body.joint(role).expect("it has one");
            let end = ends(&rig.body, &positions, joint)[0];
            let ray = (positions[joint].lerp(end, 0.5) - eye).normalize();
            assert_eq!(bone(&rig.body, &positions, eye, ray).map(|found| found.0), Some(role));
        }
        assert_eq!(bone(&rig.body, &positions, eye, (DVec3::new(2.0, 1.0, 0.0) - eye).normalize()), None);
    }
}
