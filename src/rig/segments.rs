//! Mass segments of a body: de Leva 1996 (men), laid on whatever joints the rig has.
//!
//! Scenario space, metres, kilograms. Mass fractions sum to one. Centres stand at de Leva's fractions of each segment's
//! length; radii of gyration are fractions of the same length. The trunk is placed on the line from the middle of the
//! hips to the base of the neck, whatever spine joints there are, and its three parts are given to the joints that lie
//! under them. Hair, clothes and props weigh nothing.

use crate::model::{BodyJoint, FootShape, Role, Segment, Side};
use glam::{DMat3, DVec2, DVec3};

/// One row of de Leva's table.
struct Row {
    /// Share of the body's mass.
    mass: f64,
    /// From the proximal end, share of the segment's length.
    centre: f64,
    /// Radii of gyration about the sagittal (forward), transverse (sideways) and long axis, shares of the length.
    radii: [f64; 3],
}

/// From the base of the neck to the top of the head: de Leva's vertex to cervicale.
const HEAD: Row = Row { mass: 0.0694, centre: 0.4998, radii: [0.303, 0.315, 0.261] };
const UPPER_TRUNK: Row = Row { mass: 0.1596, centre: 0.2999, radii: [0.716, 0.454, 0.659] };
const MID_TRUNK: Row = Row { mass: 0.1633, centre: 0.4502, radii: [0.482, 0.383, 0.468] };
const LOWER_TRUNK: Row = Row { mass: 0.1117, centre: 0.6115, radii: [0.615, 0.551, 0.587] };
const UPPER_ARM: Row = Row { mass: 0.0271, centre: 0.5772, radii: [0.285, 0.269, 0.158] };
const FOREARM: Row = Row { mass: 0.0162, centre: 0.4574, radii: [0.276, 0.265, 0.121] };
/// From the wrist to the middle finger's knuckle.
const HAND: Row = Row { mass: 0.0061, centre: 0.7900, radii: [0.628, 0.513, 0.401] };
const THIGH: Row = Row { mass: 0.1416, centre: 0.4095, radii: [0.329, 0.329, 0.149] };
const SHANK: Row = Row { mass: 0.0433, centre: 0.4395, radii: [0.251, 0.246, 0.102] };
/// From the heel to the tip of the toes.
const FOOT: Row = Row { mass: 0.0137, centre: 0.4415, radii: [0.257, 0.245, 0.124] };

/// Lengths of the upper, middle and lower trunk, shares of suprasternale to mid-hip.
const TRUNK_SHARES: [f64; 3] = [170.7 / 531.9, 215.5 / 531.9, 145.7 / 531.9];
/// Wrist to knuckle over elbow to wrist, for hands without fingers.
const HAND_OVER_FOREARM: f64 = 86.2 / 268.9;

/// The segments of these joints. `height` is the top of the head.
pub(super) fn segments(joints: &[BodyJoint], feet: &[FootShape; 2], height: f64, mass: f64) -> Vec<Segment> {
    let find = |role: Role| joints.iter().position(|joint| joint.role == role);
    let at = |role: Role| find(role).map(|index| joints[index].rest);
    let mut list = Vec::new();
    let mut put = |joint: Option<usize>, row: &Row, from: DVec3, to: DVec3| {
        if let Some(joint) = joint {
            list.push(segment(joint, joints[joint].rest, row, mass, from, to));
        }
    };

    let hips = at(Role::Hips).unwrap_or(DVec3::ZERO);
    let middle = |a: Role, b: Role| Some((at(a)? + at(b)?) / 2.0);
    let mid_hip = middle(Role::LeftUpperLeg, Role::RightUpperLeg).unwrap_or(hips);
    let neck =
        neck_base(at(Role::Neck), at(Role::Head), middle(Role::LeftUpperArm, Role::RightUpperArm), mid_hip, height);

    let crown = match at(Role::Head) {
        // The head stands over its own joint, however the neck leans.
        Some(head) => DVec3::new(head.x, height.max(neck.y + 0.02 * height), head.z),
        None => neck + DVec3::Y * 0.12 * height,
    };
    put(find(Role::Head).or(find(Role::Neck)), &HEAD, crown, neck);

    let trunk =
        [Role::Hips, Role::Spine, Role::Chest, Role::UpperChest].map(|role| find(role).map(|i| (i, joints[i].rest)));
    let owners = trunk_owners(&trunk, neck, mid_hip);
    let cuts = [0.0, TRUNK_SHARES[0], TRUNK_SHARES[0] + TRUNK_SHARES[1], 1.0].map(|share| neck.lerp(mid_hip, share));
    for (part, row) in [&UPPER_TRUNK, &MID_TRUNK, &LOWER_TRUNK].into_iter().enumerate() {
        put(owners[part], row, cuts[part], cuts[part + 1]);
    }

    for side in Side::BOTH {
        let [shoulder, elbow, wrist, knuckle, hip, knee, ankle] = match side {
            Side::Left => [
                Role::LeftUpperArm,
                Role::LeftLowerArm,
                Role::LeftHand,
                Role::LeftMiddleProximal,
                Role::LeftUpperLeg,
                Role::LeftLowerLeg,
                Role::LeftFoot,
            ],
            Side::Right => [
                Role::RightUpperArm,
                Role::RightLowerArm,
                Role::RightHand,
                Role::RightMiddleProximal,
                Role::RightUpperLeg,
                Role::RightLowerLeg,
                Role::RightFoot,
            ],
        };
        for (row, from, to) in
            [(&UPPER_ARM, shoulder, elbow), (&FOREARM, elbow, wrist), (&THIGH, hip, knee), (&SHANK, knee, ankle)]
        {
            if let (Some(a), Some(b)) = (at(from), at(to)) {
                put(find(from), row, a, b);
            }
        }
        if let (Some(elbow), Some(wrist)) = (at(elbow), at(wrist)) {
            let end = at(knuckle).unwrap_or(wrist + (wrist - elbow) * HAND_OVER_FOREARM);
            put(
                find(match side {
                    Side::Left => Role::LeftHand,
                    Side::Right => Role::RightHand,
                }),
                &HAND,
                wrist,
                end,
            );
        }
        if at(ankle).is_some() {
            let foot = &feet[side as usize];
            let unturn = foot.level.inverse();
            let place = |along: f64| {
                let flat: DVec2 = foot.forward * along;
                // Half way up to the ankle: the foot is thickest under it and thin at the toes.
                let levelled = DVec3::new(flat.x, -0.55 * foot.ankle_height, flat.y);
                joints[foot.ankle].rest + unturn * levelled
            };
            put(Some(foot.ankle), &FOOT, place(foot.heel), place(foot.tip));
        }
    }
    list
}

/// Where the neck meets the trunk: the neck joint; without one, a place under the head joint.
fn neck_base(neck: Option<DVec3>, head: Option<DVec3>, shoulders: Option<DVec3>, mid_hip: DVec3, height: f64) -> DVec3 {
    match (neck, head, shoulders) {
        (Some(neck), _, _) => neck,
        (None, Some(head), Some(shoulders)) if head.y > shoulders.y => head.lerp(shoulders, 0.5),
        (None, Some(head), _) => head,
        (None, None, Some(shoulders)) => shoulders,
        (None, None, None) => mid_hip + DVec3::Y * 0.3 * height,
    }
}

/// Which joint carries the upper, the middle and the lower trunk.
///
/// The lower is the pelvis's; the upper moves with the last trunk joint, which carries the shoulders; the middle with
/// the highest joint that lies under its centre, but not with the pelvis where there is a spine.
fn trunk_owners(trunk: &[Option<(usize, DVec3)>; 4], neck: DVec3, mid_hip: DVec3) -> [Option<usize>; 3] {
    let line = neck - mid_hip;
    let length_squared = line.length_squared().max(1e-12);
    let centre = 1.0 - TRUNK_SHARES[0] - MID_TRUNK.centre * TRUNK_SHARES[1];
    let present: Vec<(usize, f64)> =
        trunk.iter().flatten().map(|(joint, rest)| (*joint, (*rest - mid_hip).dot(line) / length_squared)).collect();
    let lower = present.first().map(|entry| entry.0);
    let upper = present.last().map(|entry| entry.0);
    let middle =
        present.iter().skip(1).rfind(|entry| entry.1 <= centre).or(present.get(1)).map(|entry| entry.0).or(lower);
    [upper, middle, lower]
}

/// A rod-like segment from its proximal to its distal end.
fn segment(joint: usize, rest: DVec3, row: &Row, body_mass: f64, from: DVec3, to: DVec3) -> Segment {
    let mass = row.mass * body_mass;
    let axis = to - from;
    let length = axis.length();
    let long = axis.try_normalize().unwrap_or(DVec3::NEG_Y);
    // The sagittal axis is the one that looks forward; for a segment that points forward itself, up.
    let ahead = DVec3::Z - long * long.z;
    let sagittal = if ahead.length_squared() > 0.25 { ahead } else { DVec3::Y - long * long.y };
    let sagittal = sagittal.try_normalize().unwrap_or(DVec3::X);
    let transverse = long.cross(sagittal);
    let frame = DMat3::from_cols(sagittal, transverse, long);
    let moments = DVec3::from_array(row.radii.map(|radius| mass * (radius * length).powi(2)));
    let inertia = frame * DMat3::from_diagonal(moments) * frame.transpose();
    Segment { joint, mass, centre: from + axis * row.centre - rest, inertia }
}
