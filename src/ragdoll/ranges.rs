//! How far the joints of a figure go, as the dynamics take it. Radians from the stand, scenario axes.
//!
//! Ranges of people as the measures have them (`measure::joints`: hips, ankles) and rounded elsewhere; what is held within them is the
//! body itself, in balance and in a fall.

use super::figure::{Figure, Freedom, Part};
use crate::dynamics::{Range, Swing};
use crate::model::{Side, Terrain};
use glam::DVec3;

/// The range of a link's joint, on that ground.
pub(super) fn range_of(figure: &Figure, index: usize, terrain: &Terrain) -> Range {
    let link = &figure.links[index];
    match link.freedom {
        Freedom::Free => Range::Free,
        Freedom::Hinge { range, .. } => Range::Hinge(range),
        Freedom::Ball { .. } => {
            let down = matches!(link.part, Part::Foot(_));
            let next = figure.links.iter().find(|other| other.parent == Some(index) && !down);
            let along = next.map_or(link.centre, |next| next.anchor);
            // A foot swings about its ankle as its sole does, whatever way it points.
            let along = if down { DVec3::NEG_Y } else { along.normalize_or(DVec3::NEG_Y) };
            let across = (DVec3::X - along * along.x).normalize_or(DVec3::Z);
            let ahead = along.cross(across);
            let ahead = if ahead.dot(DVec3::Z) + 1e-3 * ahead.dot(DVec3::Y) < 0.0 { -ahead } else { ahead };
            let [x, z, twist] = ends(figure, link.part, leaning(terrain));
            Range::Ball(Swing { along, about: [across, ahead], swing: [x, z], twist })
        }
    }
}

/// rad, by which hips and ankles go beyond their ranges on that ground.
pub(super) fn leaning(terrain: &Terrain) -> f64 {
    if terrain.moves() { LEANING } else { 0.0 }
}

/// Least and most about x (forwards bends a trunk by more, a limb by less), about z, and about the bone.
fn ends(figure: &Figure, part: Part, yields: f64) -> [[f64; 2]; 3] {
    // Outward of a left limb is about +z; its bone points down.
    let sided = |side: Side, out: [f64; 2]| if side == Side::Left { out } else { [-out[1], -out[0]] };
    let turned = |range: [f64; 2]| [-range[1], -range[0]];
    let outer = |range: [f64; 2]| [range[0] - yields, range[1] + yields];
    match part {
        Part::Trunk => [[-0.35, 0.9], [-0.45, 0.45], [-0.6, 0.6]],
        Part::Head => [[-0.7, 0.7], [-0.5, 0.5], [-1.0, 1.0]],
        Part::UpperArm(side) => [[-2.6, 0.8], sided(side, [-0.4, 2.3]), [-1.2, 1.2]],
        Part::Hand(_) => [[-0.8, 0.8], [-0.5, 0.5], [-0.3, 0.3]],
        Part::Thigh(side) => {
            let [flexion, abduction, ..] = figure.leg_ranges[side as usize];
            [turned(outer(flexion)), sided(side, outer(abduction)), [-0.8, 0.8]]
        }
        Part::Foot(side) => {
            let [.., flexion, inversion] = figure.leg_ranges[side as usize];
            [turned(outer(flexion)), sided(side, turned(outer(inversion))), [-0.4, 0.4]]
        }
        Part::Pelvis | Part::Forearm(_) | Part::Shank(_) | Part::Toes(_) => [[-3.0, 3.0]; 3],
    }
}

/// rad, by which hips and ankles go beyond the ranges that they are measured by on a platform that moves: the law lays soles flat on it even
/// where it leans by 30 degrees.
const LEANING: f64 = 1.2;
