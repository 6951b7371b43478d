//! Where a mapped skeleton stands: up, forward, left, unit, ground. And whether it has the build of a human at all.
//!
//! In: bones and bind positions in the document's world. Out: the similarity between scenario space (metres, Y up, Z
//! forward, origin on the ground below the hips) and the document. glTF says metres and Y up; files that do not keep to
//! it are recognised by the body itself.

use super::{MeshPart, RigNode, Similarity};
use crate::maths::real;
use crate::model::Role;
use glam::{DMat3, DQuat, DVec3};
use std::collections::BTreeMap;

/// Heights, in file units, that are taken for metres as they stand.
const METRES: std::ops::RangeInclusive<f64> = 0.4..=3.5;
/// Units that files come in, metres each, likeliest first, and how tall a body may then be, m.
const UNITS: [(f64, std::ops::RangeInclusive<f64>); 9] = [
    (0.01, 1.0..=2.6),
    (0.1, 1.0..=2.6),
    (0.001, 1.0..=2.6),
    (0.0254, 1.3..=2.1),
    (0.3048, 1.3..=2.1),
    (0.056_444, 1.3..=2.1), // CMU's: inches over 0.45
    (10.0, 1.0..=2.6),
    (100.0, 1.0..=2.6),
    (1000.0, 1.0..=2.6),
];
/// Between the spine and the legs, stretched: a human's is near 1, a quadruped's near 0.
const UPRIGHT: f64 = 0.5;
/// A foot's horizontal length relative to the leg from which its direction is believed.
const FOOT: f64 = 0.05;

/// What was found.
#[derive(Clone, Debug)]
pub struct Stance {
    /// The way to the document.
    pub document_from_scenario: Similarity,
    /// "+Y".
    pub up: String,
    /// "+Z".
    pub forward: String,
    /// Left and right are the wrong way round: the feet say so. The bones must be mirrored by who asked.
    pub swapped: bool,
    /// Factors below 1 for what was odd.
    pub confidence: f64,
    /// Sentences.
    pub warnings: Vec<String>,
}

/// Landmarks of the body in the document's world.
pub struct Landmarks {
    /// Mid of the upper leg joints.
    pub hips: DVec3,
    /// Mid of the upper arm joints.
    pub shoulders: DVec3,
    /// Mid of the feet (or lower legs).
    pub feet: DVec3,
    /// From right to left, not unit.
    pub left: DVec3,
}

impl Landmarks {
    /// Of those bones; the required ones must be there.
    pub fn of(bones: &BTreeMap<Role, usize>, positions: &[DVec3]) -> Option<Landmarks> {
        let at = |role: Role| bones.get(&role).map(|node| positions[*node]);
        let middle = |left: Role| Some((at(left)? + at(left.mirrored())?) * 0.5);
        let across = |left: Role| Some(at(left)? - at(left.mirrored())?);
        let feet = middle(Role::LeftFoot).or_else(|| middle(Role::LeftLowerLeg))?;
        let arms = across(Role::LeftUpperArm)?;
        let legs = across(Role::LeftUpperLeg)?;
        let left = arms.normalize_or_zero() + 2.0 * legs.normalize_or_zero();
        Some(Landmarks { hips: middle(Role::LeftUpperLeg)?, shoulders: middle(Role::LeftUpperArm)?, feet, left })
    }

    /// From feet to shoulders: the body's own up.
    pub fn body_up(&self) -> DVec3 {
        let (trunk, legs) = (self.shoulders - self.hips, self.hips - self.feet);
        (trunk.normalize_or_zero() + legs.normalize_or_zero()).normalize_or_zero()
    }
}

/// Why those bones are not those of an upright human, if they are not.
pub fn not_human(bones: &BTreeMap<Role, usize>, positions: &[DVec3]) -> Option<String> {
    let marks = Landmarks::of(bones, positions)?;
    let (trunk, legs) = (marks.shoulders - marks.hips, marks.hips - marks.feet);
    if trunk.length() < 1e-9 || legs.length() < 1e-9 {
        return Some("hips, shoulders and feet lie in one place".into());
    }
    let straight = trunk.normalize().dot(legs.normalize());
    if straight >= UPRIGHT {
        return None;
    }
    let angle = real::acos(straight.clamp(-1.0, 1.0)).to_degrees();
    let hand = |role: Role| bones.get(&role).map(|node| positions[*node]);
    let up = legs.normalize();
    let hands = [Role::LeftHand, Role::RightHand].into_iter().filter_map(hand).map(|hand| (hand - marks.feet).dot(up));
    let reach = hands.fold(f64::MAX, f64::min);
    let quadruped = reach < legs.length() * 0.3;
    let tail = if quadruped { ", and the hands reach down to where the feet are: a quadruped" } else { "" };
    Some(format!("the spine lies {angle:.0} degrees off the line of the legs{tail}"))
}

/// Finds the stance. `sides_known`: left and right come from names, not from a guess.
pub fn stance(
    nodes: &[RigNode],
    bones: &BTreeMap<Role, usize>,
    positions: &[DVec3],
    parts: &[MeshPart],
    sides_known: bool,
) -> Option<Stance> {
    let marks = Landmarks::of(bones, positions)?;
    let mut warnings = Vec::new();
    let mut confidence = 1.0;
    let body_up = marks.body_up();
    let up = if body_up.dot(DVec3::Y) > 0.6 { DVec3::Y } else { nearest_axis(body_up) };
    if body_up.dot(up) < 0.8 {
        confidence *= 0.9;
        warnings.push(format!(
            "the body leans {:.0} degrees in its bind pose",
            real::acos(body_up.dot(up).min(1.0)).to_degrees()
        ));
    }
    let left = (marks.left - up * marks.left.dot(up)).normalize_or_zero();
    let mut front = left.cross(up).normalize_or_zero();
    if front == DVec3::ZERO {
        front = up.any_orthonormal_vector();
        confidence *= 0.5;
        warnings.push("left and right cannot be told apart".into());
    }
    let leg = (marks.hips - marks.feet).length();
    let mut swapped = false;
    if let Some(feet) = foot_direction(nodes, bones, positions, parts, up, leg) {
        let agreement = feet.normalize().dot(front);
        if agreement < -0.5 && (!sides_known || feet.length() > 2.0 * FOOT * leg) {
            front = -front;
            swapped = true;
            if sides_known {
                confidence *= 0.8;
                warnings.push(
                    "the feet point backwards by the sides that the file names: left and right were exchanged".into(),
                );
            }
        } else if agreement.abs() < 0.5 {
            confidence *= 0.9;
            warnings.push("the feet point sideways: forward was taken from left and right".into());
        }
    } else if !sides_known {
        confidence *= 0.8;
        warnings.push("nothing shows where the front is".into());
    }
    let front = snap(front, up);
    let (low, high) = extent(nodes, bones, positions, parts, up, leg);
    let height = high - low;
    let units = units_of(height);
    if units != 1.0 {
        warnings.push(format!("the body is {height:.3} units high: taken as {units} m each"));
        confidence *= 0.97;
    }
    let across = up.cross(front);
    let rotation = DQuat::from_mat3(&DMat3::from_cols(across, up, front)).normalize();
    let translation = marks.hips - up * marks.hips.dot(up) + up * low;
    Some(Stance {
        document_from_scenario: Similarity { scale: 1.0 / units, rotation, translation },
        up: axis_name(up),
        forward: axis_name(front),
        swapped,
        confidence,
        warnings,
    })
}

/// Metres a unit for a body that many units high.
fn units_of(height: f64) -> f64 {
    if METRES.contains(&height) || !(height > 0.0 && height.is_finite()) {
        return 1.0;
    }
    let likely = UNITS.iter().find(|(unit, human)| human.contains(&(height * unit))).map(|(unit, _)| *unit);
    likely.unwrap_or_else(|| {
        let power = real::log10(1.7 / height).round().clamp(-12.0, 12.0);
        10_f64.powi(power as i32)
    })
}

/// Horizontal, from ankles forward: to the toe joints, or along the soles. Its length is a foot's.
fn foot_direction(
    nodes: &[RigNode],
    bones: &BTreeMap<Role, usize>,
    positions: &[DVec3],
    parts: &[MeshPart],
    up: DVec3,
    leg: f64,
) -> Option<DVec3> {
    let flat = |vector: DVec3| vector - up * vector.dot(up);
    let mut sum = DVec3::ZERO;
    for (foot, toes) in [(Role::LeftFoot, Role::LeftToes), (Role::RightFoot, Role::RightToes)] {
        if let (Some(foot), Some(toes)) = (bones.get(&foot), bones.get(&toes)) {
            sum += flat(positions[*toes] - positions[*foot]) * 0.5;
        }
    }
    if sum.length() > FOOT * leg {
        return Some(sum);
    }
    // The middle of the lowest slice of the mesh lies ahead of the ankle.
    let mut soles = DVec3::ZERO;
    for bone in leg_ends(bones) {
        let points = points_under(nodes, bone, parts);
        let low = points.iter().map(|point| point.dot(up)).fold(f64::MAX, f64::min);
        let sole: Vec<DVec3> = points.into_iter().filter(|point| point.dot(up) < low + 0.06 * leg).collect();
        if sole.len() < 3 {
            continue;
        }
        let (least, most) = sole.iter().fold((DVec3::MAX, DVec3::MIN), |(a, b), point| (a.min(*point), b.max(*point)));
        soles += flat((least + most) * 0.5 - positions[bone]) * 0.5;
    }
    let found = if soles.length() > sum.length() { soles } else { sum };
    // Less than that is the noise of a straight leg.
    (found.length() > 0.6 * FOOT * leg).then_some(found)
}

/// The lowest bone of each leg: its foot, else its lower leg.
fn leg_ends(bones: &BTreeMap<Role, usize>) -> Vec<usize> {
    let ends = [(Role::LeftFoot, Role::LeftLowerLeg), (Role::RightFoot, Role::RightLowerLeg)];
    ends.iter().filter_map(|(foot, shank)| bones.get(foot).or_else(|| bones.get(shank))).copied().collect()
}

/// Mesh vertices that move mostly with that node or what hangs below it.
fn points_under(nodes: &[RigNode], bone: usize, parts: &[MeshPart]) -> Vec<DVec3> {
    let under = below(nodes, bone);
    let mut points = Vec::new();
    for part in parts {
        for (point, weights) in part.positions.iter().zip(&part.weights) {
            let share: f64 = weights.iter().filter(|(node, _)| under[*node]).map(|(_, share)| share).sum();
            if share > 0.5 {
                points.push(*point);
            }
        }
    }
    points
}

/// Which nodes are that one or hang below it.
pub fn below(nodes: &[RigNode], top: usize) -> Vec<bool> {
    let mut under = vec![false; nodes.len()];
    let mut open = vec![top];
    while let Some(node) = open.pop() {
        under[node] = true;
        open.extend(&nodes[node].children);
    }
    under
}

/// Lowest and highest along up: soles and crown, from the mesh of feet and head, else from the joints.
fn extent(
    nodes: &[RigNode],
    bones: &BTreeMap<Role, usize>,
    positions: &[DVec3],
    parts: &[MeshPart],
    up: DVec3,
    leg: f64,
) -> (f64, f64) {
    let feet = leg_ends(bones);
    let soles = feet.iter().flat_map(|foot| points_under(nodes, *foot, parts)).map(|point| point.dot(up));
    let soles = soles.fold(f64::MAX, f64::min);
    let joints = feet.iter().map(|foot| {
        let under = below(nodes, *foot);
        (0..nodes.len()).filter(|node| under[*node]).map(|node| positions[node].dot(up)).fold(f64::MAX, f64::min)
    });
    let lowest = joints.fold(f64::MAX, f64::min);
    let ankles = feet.iter().map(|foot| positions[*foot].dot(up)).fold(f64::MAX, f64::min);
    // Without a mesh: the document's own floor where a sole would lie on it, else a sole below what is lowest.
    let (near, sole) = match bones.contains_key(&Role::LeftFoot) {
        true if lowest < ankles - 0.02 * leg => (-0.005..0.05, 0.01),
        true => (0.04..0.2, 0.075),
        false => (0.4..0.6, 0.5),
    };
    let low = if soles < f64::MAX {
        soles
    } else if near.contains(&(lowest / leg.max(1e-12))) {
        0.0
    } else {
        lowest - sole * leg
    };
    let head = bones.get(&Role::Head).copied();
    let crown = head.map(|head| points_under(nodes, head, parts)).unwrap_or_default();
    let crown = crown.iter().map(|point| point.dot(up)).fold(f64::MIN, f64::max);
    let shoulders = bones.get(&Role::LeftUpperArm).map_or(low, |arm| positions[*arm].dot(up));
    let high = match head {
        Some(_) if crown > f64::MIN => crown,
        // Without a mesh: shoulders stand at 0.82 of the height (Drillis and Contini).
        _ => low + ((shoulders - low) / 0.82).max(head.map_or(0.0, |head| positions[head].dot(up) - low)),
    };
    (low, high)
}

/// An axis of the document where the direction is within 15 degrees of one.
fn snap(direction: DVec3, up: DVec3) -> DVec3 {
    let axis = nearest_axis(direction);
    let snapped = if axis.dot(direction) > 0.966 && axis.dot(up).abs() < 0.01 { axis } else { direction };
    (snapped - up * snapped.dot(up)).normalize_or(direction)
}

/// The signed axis that a direction is nearest to; +Y on a tie.
pub fn nearest_axis(direction: DVec3) -> DVec3 {
    let axes = [DVec3::Y, DVec3::Z, DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z, DVec3::NEG_X];
    axes.into_iter()
        .fold(DVec3::Y, |best, axis| if axis.dot(direction) > best.dot(direction) + 1e-9 { axis } else { best })
}

/// "+X", "-Z"; for a slanting one the nearest axis.
pub fn axis_name(direction: DVec3) -> String {
    let axis = nearest_axis(direction);
    let sign = if axis.min_element() < 0.0 { '-' } else { '+' };
    let letter = if axis.x != 0.0 {
        'X'
    } else if axis.y != 0.0 {
        'Y'
    } else {
        'Z'
    };
    format!("{sign}{letter}")
}
