//! How far the joints of a figure go, as the dynamics take it. Radians from the stand, scenario axes.
//!
//! Ranges of people as the measures have them (`measure::joints`: hips, ankles) and rounded elsewhere; what is held within them is the
//! body itself, in balance and in a fall.

use super::figure::{Figure, Freedom, INSIDE, Part};
use crate::dynamics::{Axes, Range, Reading, Swing};
use crate::measure::joints::JointAxes;
use crate::model::scenario::GroundKind;
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec3};

/// The range of a link's joint, on that ground.
pub(super) fn range_of(figure: &Figure, index: usize, terrain: &Terrain) -> Range {
    let link = &figure.links[index];
    match link.freedom {
        Freedom::Free => Range::Free,
        Freedom::Hinge { range, .. } => Range::Hinge(range),
        Freedom::Ball { .. } => {
            if let Some(axes) = of_leg(figure, link.part, leaning(terrain)) {
                return Range::Axes(axes);
            }
            let next = figure.links.iter().find(|other| other.parent == Some(index));
            let along = next.map_or(link.centre, |next| next.anchor).normalize_or(DVec3::NEG_Y);
            let across = (DVec3::X - along * along.x).normalize_or(DVec3::Z);
            let ahead = along.cross(across);
            let ahead = if ahead.dot(DVec3::Z) + 1e-3 * ahead.dot(DVec3::Y) < 0.0 { -ahead } else { ahead };
            let [x, z, twist] = ends(link.part);
            Range::Ball(Swing { along, about: [across, ahead], swing: [x, z], twist })
        }
    }
}

/// Of a hip or an ankle as the measures read it.
fn of_leg(figure: &Figure, part: Part, yields: f64) -> Option<Axes> {
    let of = |side: Side| figure.leg_axes[side as usize];
    let (joint, reading) = match part {
        Part::Thigh(side) => (of(side)?[0], Reading::Turns),
        Part::Foot(side) => (of(side)?[1], Reading::Swing),
        _ => return None,
    };
    let JointAxes { before, after, range } = joint;
    let mut axes = Axes { reading, before, after, range };
    // Who stands past an end may stand; and the foot is not to turn on its shank, which people's hardly do.
    for (way, (at, _)) in axes.angles(DQuat::IDENTITY).into_iter().enumerate() {
        let by = if way == 2 { 0.0 } else { yields };
        let [low, high] = axes.range[way];
        axes.range[way] = [(low + INSIDE).min(at) - by, (high - INSIDE).max(at) + by];
        if way == 2 && reading == Reading::Swing {
            axes.range[way] = [at - TURNS, at + TURNS];
        }
    }
    Some(axes)
}

/// rad, by which hips and ankles go beyond their ranges on that ground.
pub(super) fn leaning(terrain: &Terrain) -> f64 {
    match terrain.kind {
        _ if terrain.moves() => LEANING,
        GroundKind::Slope { .. } | GroundKind::Uneven { .. } => SLOPES,
        GroundKind::Mesh { surface: Some(ref surface), .. } if surface.leans() => SLOPES,
        _ => 0.0,
    }
}

/// Least and most about x (forwards bends a trunk by more, a limb by less), about z, and about the bone.
fn ends(part: Part) -> [[f64; 2]; 3] {
    // Outward of a left limb is about +z; its bone points down.
    let sided = |side: Side, out: [f64; 2]| if side == Side::Left { out } else { [-out[1], -out[0]] };
    match part {
        Part::Trunk => [[-0.35, 0.9], [-0.45, 0.45], [-0.6, 0.6]],
        Part::Head => [[-0.7, 0.7], [-0.5, 0.5], [-1.0, 1.0]],
        Part::UpperArm(side) => [[-2.6, 0.8], sided(side, [-0.4, 2.3]), [-1.2, 1.2]],
        Part::Hand(_) => [[-0.8, 0.8], [-0.5, 0.5], [-0.3, 0.3]],
        _ => [[-3.0, 3.0]; 3],
    }
}

/// rad, by which a foot turns on its shank to either side.
const TURNS: f64 = 0.4;
/// rad, by which hips and ankles go beyond the ranges that they are measured by on a platform that moves: the law lays soles flat on it even
/// where it leans by 30 degrees.
const LEANING: f64 = 1.2;
/// rad, the same on ground that stays as it is, within what is heeded before the end: uphill every degree of an ankle counts.
const SLOPES: f64 = 0.03;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;
    use crate::measure::joints::angles;
    use crate::model::{Body, BodyPose, Role};
    use crate::ragdoll::Locks;

    /// The synthetic humanoid in a stand with bent knees, its feet turned out.
    fn humanoid() -> (Body, BodyPose) {
        let body = fixture::body();
        let mut stand = BodyPose::rest(&body);
        for (side, leg) in [(1.0, Role::LeftUpperLeg), (-1.0, Role::RightUpperLeg)] {
            let hip = body.joint(leg).expect("a leg");
            let out = DQuat::from_rotation_y(0.2 * side);
            stand.turns[hip] = out * DQuat::from_rotation_x(-0.25);
            stand.turns[hip + 1] = out * DQuat::from_rotation_x(0.2);
            (hip + 2..hip + 4).for_each(|joint| stand.turns[joint] = out);
        }
        (body, stand)
    }

    #[test]
    fn hips_and_ankles_stop_by_the_angles_that_they_are_measured_by() {
        let (body, stand) = humanoid();
        let figure = Figure::new(&body, &stand, Locks::default());
        let (bend, side_way, spin) =
            (DQuat::from_rotation_x(-0.8), DQuat::from_rotation_z(0.3), DQuat::from_rotation_y(0.25));
        for side in Side::BOTH {
            let [hip, knee, foot] = figure.legs[side as usize];
            for (link, sign) in [(hip, -1.0), (foot, -1.0)] {
                let turn = bend * side_way * spin;
                let mut placed: Vec<(DVec3, DQuat)> = figure.placed(&body, &stand);
                for index in [hip, knee, foot].into_iter().filter(|index| *index >= link) {
                    placed[index].1 = turn;
                }
                let pose = figure.pose(&placed);
                let measured = angles(&body, &pose);
                let role = figure.role_of(link);
                let of = |axis: &str| {
                    let found = measured.iter().find(|angle| angle.role == role && angle.axis == axis);
                    found.map(|angle| angle.value)
                };
                let Range::Axes(axes) = range_of(&figure, link, &Terrain::flat()) else { panic!("{role:?}") };
                let [x, z, y] = axes.angles(turn).map(|(angle, _)| angle);
                let outward = if side == Side::Left { 1.0 } else { -1.0 };
                let across = if link == hip { of("abduction") } else { of("inversion").map(|value| -value) };
                assert!((sign * x - of("flexion").expect("bends")).abs() < 1e-9, "{role:?}");
                assert!((outward * z - across.expect("swings")).abs() < 1e-9, "{role:?}");
                if let Some(rotation) = of("rotation") {
                    assert!((-outward * y - rotation).abs() < 1e-9, "{role:?}");
                }
                // And as far as they are measured to go, but for what a clip is beside its run.
                let range = |axis: &str| measured.iter().find(|a| a.role == role && a.axis == axis).expect("one").range;
                let [low, high] = range("flexion");
                assert!((axes.range[0][0] - (INSIDE - high)).abs() < 1e-9, "{role:?}: {:?}", axes.range);
                assert!((axes.range[0][1] - (-low - INSIDE)).abs() < 1e-9, "{role:?}: {:?}", axes.range);
            }
        }
    }

    #[test]
    fn who_stands_past_an_end_may_stand() {
        let (body, mut stand) = humanoid();
        let foot = body.joint(Role::LeftFoot).expect("a foot");
        stand.turns[foot] = DQuat::from_rotation_x(-0.7) * stand.turns[foot];
        let figure = Figure::new(&body, &stand, Locks::default());
        let Range::Axes(axes) = range_of(&figure, figure.legs[0][2], &Terrain::flat()) else { panic!("an ankle") };
        let within = |((angle, _), [low, high]): ((f64, DVec3), [f64; 2])| low <= angle && angle <= high;
        assert!(axes.angles(DQuat::IDENTITY).into_iter().zip(axes.range).all(within), "{axes:?}");
    }
}
