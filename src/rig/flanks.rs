//! How far the mesh of trunk and thighs reaches to the side where hanging hands are: a skirt, a belt with pouches, wide hips.
//!
//! Scenario space, metres, at the bind pose. Triangles are clipped to the box that a hand hangs in, so a coarse skirt
//! counts between its rings too. It leaves out what moves with the arms, and cloth that would give way.

use super::MeshPart;
use super::body::arm_roles;
use super::skin::Skin;
use crate::model::{Role, Side};
use glam::DVec3;
use std::collections::BTreeMap;

/// Wrist to fingertips over elbow to wrist (de Leva: 187.9 / 268.9 mm).
const HAND: f64 = 0.70;
/// Share of the straight arm's length by which a wrist hangs under its shoulder, and is ahead of it, elbow a little bent.
const HANG: (f64, f64) = (0.97, 0.17);
/// Half of the length, fore and aft, in which a hand hangs, over the forearm.
const HALF_DEPTH: f64 = 0.35;
/// Share of the height by which the two sides of a symmetric character may differ.
const ALIKE: f64 = 0.01;
/// The thickest that a hand's half is taken for, over the forearm.
const MOST_HALF_HAND: f64 = 0.25;

/// Left and right, from the middle plane: as far out as the middle of a hanging hand must be, [`crate::model::Body::flanks`].
/// The noise of a mesh makes no difference between them.
pub(super) fn flanks(mesh: &[MeshPart], skin: &Skin, places: &BTreeMap<Role, DVec3>, height: f64) -> [f64; 2] {
    let [left, right] = Side::BOTH.map(|side| flank(mesh, skin, places, side).unwrap_or(0.0));
    if (left - right).abs() < ALIKE * height { [left.max(right); 2] } else { [left, right] }
}

fn flank(mesh: &[MeshPart], skin: &Skin, places: &BTreeMap<Role, DVec3>, side: Side) -> Option<f64> {
    let [shoulder, elbow, wrist] = arm_roles(side).map(|role| places.get(&role).copied());
    let (shoulder, elbow, wrist) = (shoulder?, elbow?, wrist?);
    let forearm = elbow.distance(wrist);
    let arm = shoulder.distance(elbow) + forearm;
    let (down, ahead) = (shoulder.y - HANG.0 * arm, shoulder.z + HANG.1 * arm);
    // Side by side with the fingers' roots, not their tips: those curl in under a skirt's hem and over a thigh.
    let low = DVec3::new(0.0, down - 0.6 * HAND * forearm, ahead - HALF_DEPTH * forearm);
    let high = DVec3::new(0.0, down + 0.1 * forearm, ahead + HALF_DEPTH * forearm);
    let mut reach: Option<f64> = None;
    for part in mesh {
        let place = |vertex: u32| {
            let vertex = usize::try_from(vertex).ok()?;
            let place = *part.positions.get(vertex)?;
            let below = place.is_finite() && skin.share(part.weights.get(vertex)?, is_below) > 0.5;
            below.then(|| DVec3::new(side.sign() * place.x, place.y, place.z))
        };
        for corners in part.indices.chunks_exact(3) {
            let (Some(a), Some(b), Some(c)) = (place(corners[0]), place(corners[1]), place(corners[2])) else {
                continue;
            };
            for corner in clipped([a, b, c], low, high) {
                reach = Some(reach.map_or(corner.x, |most| most.max(corner.x)));
            }
        }
    }
    Some(reach? + half_hand(skin, side).unwrap_or(0.0).min(MOST_HALF_HAND * forearm))
}

/// What a hanging hand may hang beside.
fn is_below(role: Role) -> bool {
    use Role::*;
    matches!(role, Hips | Spine | Chest | UpperChest | LeftUpperLeg | RightUpperLeg)
}

/// m, half of a hand's thickness: the least extent of its mesh along an axis.
fn half_hand(skin: &Skin, side: Side) -> Option<f64> {
    let points: Vec<DVec3> = skin.of(arm_roles(side)[2]).collect();
    let low = points.iter().copied().reduce(DVec3::min)?;
    let high = points.iter().copied().reduce(DVec3::max)?;
    Some(0.5 * (high - low).min_element())
}

/// The corners of what lies in a box that is open towards +X (Sutherland and Hodgman).
fn clipped(triangle: [DVec3; 3], low: DVec3, high: DVec3) -> Vec<DVec3> {
    let mut corners = triangle.to_vec();
    let sides = [(0, 1.0, low.x), (1, 1.0, low.y), (1, -1.0, high.y), (2, 1.0, low.z), (2, -1.0, high.z)];
    for (axis, sign, bound) in sides {
        let inside = |point: DVec3| sign * (point[axis] - bound);
        let mut kept = Vec::with_capacity(corners.len() + 1);
        for (index, &here) in corners.iter().enumerate() {
            let before = corners[(index + corners.len() - 1) % corners.len()];
            let (from, to) = (inside(before), inside(here));
            if (from < 0.0) != (to < 0.0) {
                kept.push(before + (here - before) * (from / (from - to)));
            }
            if to >= 0.0 {
                kept.push(here);
            }
        }
        corners = kept;
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;
    use crate::rig::body::{BodyInput, derive};

    /// Shoulders at 1.4 m and 0.18 m out, arms of 0.3 and 0.25 m that hang; hips at 0.95 m. Node indices are the order.
    fn bones() -> BTreeMap<Role, (usize, DVec3)> {
        let left = [
            (Role::LeftUpperArm, DVec3::new(0.18, 1.4, 0.0)),
            (Role::LeftLowerArm, DVec3::new(0.18, 1.1, 0.0)),
            (Role::LeftHand, DVec3::new(0.18, 0.85, 0.0)),
            (Role::LeftUpperLeg, DVec3::new(0.1, 0.92, 0.0)),
            (Role::LeftLowerLeg, DVec3::new(0.1, 0.5, 0.0)),
            (Role::LeftFoot, DVec3::new(0.1, 0.08, 0.0)),
        ];
        let mut bones = BTreeMap::from([
            (Role::Hips, (0, DVec3::new(0.0, 0.95, 0.0))),
            (Role::Spine, (1, DVec3::new(0.0, 1.05, 0.0))),
            (Role::Head, (2, DVec3::new(0.0, 1.5, 0.0))),
        ]);
        for (at, (role, place)) in left.into_iter().enumerate() {
            bones.insert(role, (10 + at, place));
            bones.insert(role.mirrored(), (20 + at, DVec3::new(-place.x, place.y, place.z)));
        }
        bones
    }

    /// A cone of cloth with rings at 1 m and 0.6 m alone, all of it on one node.
    fn skirt(node: usize, waist: f64, hem: f64) -> MeshPart {
        let mut part = MeshPart::default();
        let count = 32;
        for step in 0..count {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(count);
            for (radius, y) in [(waist, 1.0), (hem, 0.6)] {
                part.positions.push(DVec3::new(radius * real::cos(angle), y, radius * real::sin(angle)));
                part.weights.push([(node, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]);
            }
            let (here, next) = (2 * step, 2 * ((step + 1) % count));
            part.indices.extend([here, next, here + 1, next, next + 1, here + 1]);
        }
        part
    }

    fn flanks_of(mesh: &[MeshPart]) -> [f64; 2] {
        let bones = bones();
        derive(&BodyInput { bones: &bones, mesh, parents: &[None; 64], mass: None }).body.flanks
    }

    #[test]
    fn a_skirt_of_two_rings_counts_between_them() {
        let [left, right] = flanks_of(&[skirt(0, 0.15, 0.35)]);
        // The lowest that counts: 0.97 of an arm of 0.55 m under the shoulder, and 0.6 of a hand of 0.175 m.
        let low = 1.4 - 0.97 * 0.55 - 0.6 * 0.7 * 0.25;
        let radius = 0.15 + 0.2 * (1.0 - low) / 0.4;
        assert!((left - radius).abs() < 0.006, "{left}, the cone is {radius} wide there");
        assert_eq!(left, right);
    }

    #[test]
    fn sleeves_and_a_missing_mesh_count_nothing() {
        assert_eq!(flanks_of(&[]), [0.0; 2]);
        let sleeve = skirt(11, 0.15, 0.35);
        assert_eq!(flanks_of(&[sleeve]), [0.0; 2], "it moves with the forearm");
    }

    #[test]
    fn broken_meshes_make_no_panic() {
        let mut part = skirt(0, 0.15, 0.35);
        part.indices = vec![0, 1, 900, 2, 3, 4, 5];
        part.positions[3] = DVec3::NAN;
        part.weights.truncate(4);
        assert_eq!(flanks_of(&[part]), [0.0; 2]);
    }
}
