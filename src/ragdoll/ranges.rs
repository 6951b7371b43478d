//! How far the joints of a figure go, as the dynamics take it. Radians from the stand, scenario axes.
//!
//! Ranges of people as the measures have them (`measure::joints`: hips, ankles) and rounded elsewhere; what is held within them is the
//! body itself, in balance and in a fall.

use super::figure::{Figure, Freedom, Part};
use crate::dynamics::{Range, Swing};
use glam::DVec3;

/// The range of a link's joint.
pub(super) fn range_of(figure: &Figure, index: usize) -> Range {
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
            let [x, z, twist] = ends(link.part);
            Range::Ball(Swing { along, about: [across, ahead], swing: [x, z], twist })
        }
    }
}

/// Least and most about x (forwards bends a trunk by more, a limb by less), about z, and about the bone.
fn ends(part: Part) -> [[f64; 2]; 3] {
    // Outward of a left limb is about +z; its bone points down, so that turning it outward is about -y, which is about +bone.
    let sided = |x: [f64; 2], out: [f64; 2], twist: f64, left: bool| {
        let z = if left { out } else { [-out[1], -out[0]] };
        [x, z, [-twist, twist]]
    };
    match part {
        Part::Trunk => [[-0.35, 0.9], [-0.45, 0.45], [-0.6, 0.6]],
        Part::Head => [[-0.7, 0.7], [-0.5, 0.5], [-1.0, 1.0]],
        Part::UpperArm(side) => sided([-2.6, 0.8], [-0.4, 2.3], 1.2, side.sign() > 0.0),
        Part::Hand(_) => [[-0.8, 0.8], [-0.5, 0.5], [-0.3, 0.3]],
        Part::Thigh(side) => sided([-2.18, 0.52], [-0.52, 0.785], 0.8, side.sign() > 0.0),
        Part::Foot(side) => sided([-0.52, 0.87], [-0.35, 0.52], 0.4, side.sign() > 0.0),
        Part::Pelvis | Part::Forearm(_) | Part::Shank(_) => [[-3.0, 3.0]; 3],
    }
}
