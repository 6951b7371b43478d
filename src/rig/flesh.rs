//! The room that each part of a body takes up: an oriented box along its bone, as thick as the mesh around it.
//!
//! Scenario space, metres, at the bind pose. Across the bone a box holds the middle four fifths of the part's vertices, so
//! that a strap, a spike or a lock of hair counts nothing, within bounds that no limb of any build leaves; what lies beyond a bone's
//! ends (a skirt's hem, a sword) is not of it. Feet have their soles. Without a mesh, or where too little of it moves with
//! a part, there is no box.

use super::body::{arm_roles, leg_roles};
use super::skin::Skin;
use crate::model::{BodyJoint, Flesh, FootShape, Role, Side};
use glam::{DMat3, DQuat, DVec3};

/// Shares of the vertices that a box leaves out on either side.
const OUTSIDE: f64 = 0.10;
/// Vertices, fewer make no box.
const FEWEST: usize = 6;
/// Share of a bone's length over its ends in which vertices still tell its thickness.
const OVER_THE_END: f64 = 0.2;
/// Half of a limb's thickness, least and most, over its bone's length.
const LIMB: [f64; 2] = [0.06, 0.40];
/// Of a hand, over the forearm's; and its length over the forearm's (de Leva: 0.70).
const HAND: [f64; 2] = [0.04, 0.40];
/// As [`HAND`] says.
const HAND_LENGTH: [f64; 2] = [0.40, 0.95];
/// Half of the trunk, over the height: across and fore-and-aft, least and most.
const TRUNK: [[f64; 2]; 2] = [[0.05, 0.17], [0.04, 0.13]];
/// Of a head, over its own height.
const HEAD: [f64; 2] = [0.20, 0.75];
/// How far the pelvis reaches under the hips, over the height.
const UNDER_HIPS: f64 = 0.04;
/// Boxes of two sides that differ by no more, over the height, are one and its mirror image.
const ALIKE: f64 = 0.01;

/// A part of the body on its way to a box.
struct Part {
    /// The joint that it moves with.
    role: Role,
    /// m, its bone.
    from: DVec3,
    to: DVec3,
    /// m, half its thickness, least and most, across and fore-and-aft.
    bounds: [[f64; 2]; 2],
}

/// The boxes of what the mesh shows.
pub(super) fn flesh(skin: &Skin, joints: &[BodyJoint], feet: &[FootShape; 2], height: f64) -> Vec<Flesh> {
    let at = |role: Role| joints.iter().find(|joint| joint.role == role).map(|joint| joint.rest);
    let mut list = Vec::new();
    if skin.is_empty() {
        return list;
    }
    let around = |part: Option<Part>, points: &[DVec3]| -> Option<Flesh> {
        let part = part?;
        let joint = joints.iter().position(|joint| joint.role == part.role)?;
        boxed(&part, joint, joints[joint].rest, points)
    };
    let middle = |a: Role, b: Role| Some((at(a)? + at(b)?) / 2.0);
    let hips = at(Role::Hips).unwrap_or(DVec3::ZERO);
    let legs = middle(Role::LeftUpperLeg, Role::RightUpperLeg).unwrap_or(hips);
    let spine = at(Role::Spine).unwrap_or(hips);
    let neck_role = if at(Role::Neck).is_some() { Role::Neck } else { Role::Head };
    let neck = at(neck_role).unwrap_or(spine + DVec3::Y * 0.25 * height);
    let broad = TRUNK.map(|bounds| bounds.map(|share| share * height));
    // Some rigs have their hips bone on the ground, between the feet.
    let seat = hips.y.min(legs.y).max(legs.y - 0.02 * height);
    let low = DVec3::new(legs.x, seat - UNDER_HIPS * height, legs.z);
    let high = DVec3::new(legs.x, spine.y.max(hips.y.max(legs.y) + 0.03 * height), legs.z);
    let pelvis = Part { role: Role::Hips, from: low, to: high, bounds: broad };
    list.extend(around(Some(pelvis), &skin.moved_by(&|role| role == Role::Hips)));
    let trunk = Part { role: Role::Spine, from: spine, to: neck, bounds: broad };
    list.extend(around(Some(trunk), &skin.moved_by(&in_trunk)));
    let top = DVec3::new(neck.x, height.max(neck.y + 0.05 * height), neck.z);
    let round = HEAD.map(|share| share * (top.y - neck.y));
    // Without its hair, unless there is no skull without what hangs on nodes of its own.
    let mut skull = skin.head(true);
    if skull.iter().map(|point| point.y).fold(neck.y, f64::max) - neck.y < 0.55 * (top.y - neck.y) {
        skull = skin.head(false);
    }
    list.extend(around(Some(Part { role: neck_role, from: neck, to: top, bounds: [round; 2] }), &skull));
    let limb = |role: Role, to: Role| {
        let (from, to) = (at(role)?, at(to)?);
        Some(Part { role, from, to, bounds: [LIMB.map(|share| share * from.distance(to)); 2] })
    };
    let mut sides: [Vec<Option<Flesh>>; 2] = [Vec::new(), Vec::new()];
    for side in Side::BOTH {
        let [shoulder, elbow, wrist] = arm_roles(side);
        let [hip, knee, ankle, _] = leg_roles(side);
        let made = &mut sides[side as usize];
        for (role, end) in [(shoulder, elbow), (elbow, wrist), (hip, knee)] {
            made.push(around(limb(role, end), &skin.moved_by(&|own| own == role)));
        }
        let shank = around(limb(knee, ankle), &skin.moved_by(&|own| own == knee));
        made.push(shank.map(|shank| over_the_ground(shank, feet[side as usize].ankle_height)));
        let points = skin.moved_by(&|own| is_hand(own, side));
        let hand = limb(elbow, wrist).and_then(|forearm| hand(&points, &forearm, side));
        made.push(around(hand, &points));
    }
    list.extend(sides.iter().flatten().flatten());
    let [left, right] = sides;
    for (left, right) in left.into_iter().zip(right) {
        if let (Some(left), Some(right)) = (left, right)
            && let Some(twin) = twin(&left, &right, height)
        {
            list.iter_mut().filter(|flesh| flesh.joint == right.joint).for_each(|flesh| *flesh = twin);
        }
    }
    list
}

/// A thick shank ends over the ankle, so that its edge does not stand on the ground where it leans.
fn over_the_ground(shank: Flesh, ankle_height: f64) -> Flesh {
    let spare = (shank.half.x.max(shank.half.z) - 0.9 * ankle_height).clamp(0.0, 0.4 * shank.half.y);
    let half = shank.half - DVec3::Y * (0.5 * spare);
    Flesh { half, middle: shank.middle - shank.turn * DVec3::Y * (0.5 * spare), ..shank }
}

/// A hand's bone: on along the forearm, as far as its mesh (these points) reaches.
fn hand(points: &[DVec3], forearm: &Part, side: Side) -> Option<Part> {
    let bone = forearm.to - forearm.from;
    let length = bone.length();
    // Towards its own middle, where that is ahead of the wrist at all.
    let centre = points.iter().sum::<DVec3>() / points.len().max(1) as f64 - forearm.to;
    let ahead = bone.normalize_or_zero();
    let direction = if centre.dot(ahead) > 0.5 * centre.length() { centre.normalize_or_zero() } else { ahead };
    let mut along: Vec<f64> = points.iter().map(|point| (*point - forearm.to).dot(direction)).collect();
    let reach = share_of(&mut along, 0.95)?.clamp(HAND_LENGTH[0] * length, HAND_LENGTH[1] * length);
    let bounds = [HAND.map(|share| share * length); 2];
    Some(Part { role: arm_roles(side)[2], from: forearm.to, to: forearm.to + direction * reach, bounds })
}

/// The box around a part's vertices.
fn boxed(part: &Part, joint: usize, origin: DVec3, points: &[DVec3]) -> Option<Flesh> {
    let bone = part.to - part.from;
    let length = bone.length();
    let along = bone.try_normalize()?;
    let ahead = if along.z.abs() < 0.8 { DVec3::Z } else { DVec3::Y };
    let depth = (ahead - along * along.dot(ahead)).try_normalize()?;
    let across = along.cross(depth);
    let near = |point: &&DVec3| {
        let share = (**point - part.from).dot(along) / length;
        (-OVER_THE_END..=1.0 + OVER_THE_END).contains(&share)
    };
    let near: Vec<DVec3> = points.iter().filter(near).map(|point| *point - part.from).collect();
    if near.len() < FEWEST {
        return None;
    }
    let mut middle = part.from + 0.5 * bone;
    let mut half = [0.0; 2];
    for (axis, (half, bounds)) in [across, depth].into_iter().zip(half.iter_mut().zip(part.bounds)) {
        let mut places: Vec<f64> = near.iter().map(|point| point.dot(axis)).collect();
        let (low, high) = (share_of(&mut places, OUTSIDE)?, share_of(&mut places, 1.0 - OUTSIDE)?);
        *half = (0.5 * (high - low)).clamp(bounds[0], bounds[1]);
        // A box stays around its bone.
        middle += axis * (0.5 * (low + high)).clamp(-*half, *half);
    }
    let turn = DQuat::from_mat3(&DMat3::from_cols(across, along, depth)).normalize();
    Some(Flesh { joint, middle: middle - origin, half: DVec3::new(half[0], 0.5 * length, half[1]), turn })
}

/// The value under which that share of the values lies.
fn share_of(values: &mut [f64], share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    values.get((share * last as f64).round() as usize).copied()
}

/// The right one as the mirror image of the left, where they are so but for the noise of a mesh.
fn twin(left: &Flesh, right: &Flesh, height: f64) -> Option<Flesh> {
    let within = ALIKE * height;
    let middle = DVec3::new(-left.middle.x, left.middle.y, left.middle.z);
    let turn = DQuat::from_xyzw(left.turn.x, -left.turn.y, -left.turn.z, left.turn.w);
    let alike = left.half.distance(right.half) < within
        && middle.distance(right.middle) < within
        && (turn * DVec3::Y).dot(right.turn * DVec3::Y) > 0.999;
    alike.then_some(Flesh { joint: right.joint, middle, half: left.half, turn })
}

fn in_trunk(role: Role) -> bool {
    use Role::{Chest, LeftShoulder, RightShoulder, Spine, UpperChest};
    matches!(role, Spine | Chest | UpperChest | LeftShoulder | RightShoulder)
}

/// The hand itself or a finger of it.
fn is_hand(role: Role, side: Side) -> bool {
    let finger = |name: &str| ["Thumb", "Index", "Middle", "Ring", "Little"].iter().any(|part| name.contains(part));
    let own = if side == Side::Left { "left" } else { "right" };
    role == arm_roles(side)[2] || (role.name().starts_with(own) && finger(role.name()))
}

#[cfg(test)]
mod tests {
    use crate::maths::real;
    use crate::model::{Body, Flesh, Role};
    use crate::rig::MeshPart;
    use crate::rig::body::{BodyInput, derive};
    use glam::DVec3;
    use std::collections::BTreeMap;

    /// A man of 1.75 m with his arms out; node indices are the order, the right side's ten more.
    fn bones() -> BTreeMap<Role, (usize, DVec3)> {
        let left = [
            (Role::LeftUpperArm, DVec3::new(0.18, 1.43, 0.0)),
            (Role::LeftLowerArm, DVec3::new(0.47, 1.43, 0.0)),
            (Role::LeftHand, DVec3::new(0.73, 1.43, 0.0)),
            (Role::LeftUpperLeg, DVec3::new(0.09, 0.92, 0.0)),
            (Role::LeftLowerLeg, DVec3::new(0.09, 0.50, 0.0)),
            (Role::LeftFoot, DVec3::new(0.09, 0.08, 0.0)),
        ];
        let mut bones = BTreeMap::from([
            (Role::Hips, (0, DVec3::new(0.0, 0.98, 0.0))),
            (Role::Spine, (1, DVec3::new(0.0, 1.05, 0.0))),
            (Role::Head, (2, DVec3::new(0.0, 1.52, 0.0))),
        ]);
        for (at, (role, place)) in left.into_iter().enumerate() {
            bones.insert(role, (10 + at, place));
            bones.insert(role.mirrored(), (20 + at, DVec3::new(-place.x, place.y, place.z)));
        }
        bones
    }

    /// Rings around a bone: radius across it in the plane of Z and of what is square to both.
    fn tube(node: usize, from: DVec3, to: DVec3, radius: f64) -> MeshPart {
        let mut part = MeshPart::default();
        let along = (to - from).normalize();
        let (depth, across) = (DVec3::Z, along.cross(DVec3::Z));
        for ring in 0..=8 {
            let at = from.lerp(to, f64::from(ring) / 8.0);
            for step in 0..16 {
                let (sin, cos) = real::sin_cos(std::f64::consts::TAU * f64::from(step) / 16.0);
                part.positions.push(at + (across * cos + depth * sin) * radius);
                part.weights.push([(node, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]);
            }
        }
        part
    }

    fn body_of(mesh: &[MeshPart]) -> Body {
        let bones = bones();
        derive(&BodyInput { bones: &bones, mesh, parents: &[None; 64], mass: None }).body
    }

    fn of(body: &Body, role: Role) -> Option<Flesh> {
        body.flesh.iter().find(|flesh| Some(flesh.joint) == body.joint(role)).copied()
    }

    fn forearm(radius: f64) -> MeshPart {
        tube(11, DVec3::new(0.47, 1.43, 0.0), DVec3::new(0.73, 1.43, 0.0), radius)
    }

    #[test]
    fn a_limb_is_as_thick_as_its_mesh_and_lies_along_its_bone() {
        let body = body_of(&[forearm(0.045)]);
        let flesh = of(&body, Role::LeftLowerArm).expect("a forearm");
        assert!((flesh.turn * DVec3::Y - DVec3::X).length() < 1e-9, "along the bone: {}", flesh.turn * DVec3::Y);
        assert!((flesh.half.y - 0.13).abs() < 1e-9, "{}", flesh.half);
        assert!((flesh.half.x - 0.045).abs() < 0.006 && (flesh.half.z - 0.045).abs() < 0.006, "{}", flesh.half);
        assert!((flesh.middle - DVec3::X * 0.13).length() < 1e-9, "{}", flesh.middle);
        assert!(of(&body, Role::RightLowerArm).is_none(), "no mesh on that side");
    }

    #[test]
    fn a_spike_and_what_hangs_beyond_the_bone_count_nothing() {
        let plain = of(&body_of(&[forearm(0.045)]), Role::LeftLowerArm);
        let spike = MeshPart {
            positions: vec![DVec3::new(0.6, 2.4, 0.0); 3],
            weights: vec![[(11, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]; 3],
            ..MeshPart::default()
        };
        let spiked = of(&body_of(&[forearm(0.045), spike]), Role::LeftLowerArm).expect("a forearm");
        assert!((spiked.half - plain.expect("a forearm").half).length() < 0.005, "{}", spiked.half);
        let thigh = tube(13, DVec3::new(0.09, 0.92, 0.0), DVec3::new(0.09, 0.5, 0.0), 0.08);
        let cloak = tube(13, DVec3::new(0.09, 0.38, 0.0), DVec3::new(0.09, 0.1, 0.0), 0.3);
        let worn = of(&body_of(&[thigh, cloak]), Role::LeftUpperLeg).expect("a thigh");
        assert!(worn.half.x < 0.085 && worn.half.z < 0.085, "{}", worn.half);
    }

    #[test]
    fn thickness_keeps_its_bounds() {
        let thick = of(&body_of(&[forearm(0.5)]), Role::LeftLowerArm).expect("a forearm");
        let thin = of(&body_of(&[forearm(0.0001)]), Role::LeftLowerArm).expect("a forearm");
        assert!((thick.half.x - 0.4 * 0.26).abs() < 1e-9 && (thin.half.x - 0.06 * 0.26).abs() < 1e-9);
        assert!(body_of(&[]).flesh.is_empty());
    }
}
