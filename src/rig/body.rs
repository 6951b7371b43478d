//! From the bones that were found and the mesh around them to the [`Body`] that is simulated.
//!
//! Scenario space, metres, kilograms; the ground is already at y = 0. Joints that a rig lacks are extrapolated from the
//! segment before and from the mesh, with a warning. Masses are de Leva's, in [`super::segments`]; soles in
//! [`super::sole`]. It leaves out how the bones were found and which way they face.

use super::MeshPart;
use super::flanks::flanks;
use super::flesh::flesh;
use super::segments::segments;
use super::skin::{Skin, crown};
use super::sole::{FootInput, foot_shape};
use super::sole_twin::matched;
use crate::model::{Body, BodyJoint, Role, Side};
use glam::DVec3;
use std::collections::BTreeMap;

/// Body mass over height squared, kg/m², where nothing says otherwise.
const MASS_PER_HEIGHT_SQUARED: f64 = 23.0;

/// What is known of a rig.
#[derive(Clone, Copy, Debug)]
pub struct BodyInput<'a> {
    /// Each role found: its node and its place at the bind pose, scenario space.
    pub bones: &'a BTreeMap<Role, (usize, DVec3)>,
    /// What is drawn, scenario space at the bind pose; weights by node index.
    pub mesh: &'a [MeshPart],
    /// (nodes) index of each node's parent: what hangs on an unmapped node moves with the mapped one above it.
    pub parents: &'a [Option<usize>],
    /// kg; `None` for 23 times the height squared.
    pub mass: Option<f64>,
}

/// The body, and what had to be assumed.
#[derive(Clone, Debug)]
pub struct DerivedBody {
    /// In scenario space.
    pub body: Body,
    /// (body joints) the node that each joint is; `None` where it was extrapolated.
    pub joint_nodes: Vec<Option<usize>>,
    /// Sentences for a person.
    pub warnings: Vec<String>,
    /// 0..1: what the confidence in the mapping is to be multiplied by.
    pub confidence_factor: f64,
}

/// Derives joints, masses and soles. Never fails: a role that it needs and that is not there is placed by proportion.
pub fn derive(input: &BodyInput) -> DerivedBody {
    let skin = Skin::new(input);
    let mut warnings = Vec::new();
    let mut confidence_factor = 1.0;
    if skin.is_empty() {
        warnings.push("the rig has no mesh; height and soles are made from the joints".to_owned());
        confidence_factor *= 0.9;
    }
    let height = height(input, &skin);
    let mut places: BTreeMap<Role, DVec3> = input.bones.iter().map(|(role, (_, place))| (*role, *place)).collect();
    for side in Side::BOTH {
        extrapolate_leg(side, height, &skin, &mut places);
        extrapolate_arm(side, height, &skin, &mut places);
    }
    // A trunk that leans takes the head along: it stands over the shoulders, not over the hips.
    if let (Some(left), Some(right)) = (places.get(&Role::LeftUpperArm), places.get(&Role::RightUpperArm)) {
        let over = DVec3::Y * (template(Role::Head).y - template(Role::LeftUpperArm).y) * height;
        let place = left.midpoint(*right) + over;
        places.entry(Role::Head).or_insert(place);
    }
    for role in [Role::Hips, Role::Spine, Role::Head] {
        places.entry(role).or_insert(DVec3::new(0.0, template(role).y * height, 0.0));
    }
    let made: Vec<Role> = places.keys().copied().filter(|role| !input.bones.contains_key(role)).collect();
    for role in &made {
        let foot = matches!(role, Role::LeftFoot | Role::RightFoot);
        let then = if foot { "its sole turns with the shank: contacts slip" } else { "it keeps its parent's rotation" };
        warnings.push(format!("the rig has no {}; its place is extrapolated and {then}", role.name()));
        confidence_factor *= if foot { 0.95 } else { 0.98 };
    }

    // The order of the roles has parents before children.
    let mut joints: Vec<BodyJoint> = Vec::new();
    let mut joint_nodes = Vec::new();
    for (&role, &rest) in &places {
        let mut above = role.parent();
        let parent = loop {
            match above {
                None => break (!joints.is_empty()).then_some(0),
                Some(candidate) => match joints.iter().position(|joint| joint.role == candidate) {
                    Some(index) => break Some(index),
                    None => above = candidate.parent(),
                },
            }
        };
        joints.push(BodyJoint { role, parent, rest, animated: input.bones.contains_key(&role) });
        joint_nodes.push(input.bones.get(&role).map(|bone| bone.0));
    }

    let measured = Side::BOTH.map(|side| {
        let [_, _, foot, toes] = leg_roles(side);
        let index = |role: Role| joints.iter().position(|joint| joint.role == role);
        let ankle = index(foot).unwrap_or(0);
        let rest = joints[ankle].rest;
        let toe = index(toes).map(|toe| (toe, joints[toe].rest - rest));
        let vertices = skin.foot(side, rest, input.bones.contains_key(&foot));
        if !skin.is_empty() && vertices.len() < 4 {
            warnings.push(format!("no part of the mesh moves with {}; its sole is made from the joints", foot.name()));
            confidence_factor *= 0.95;
        }
        foot_shape(&FootInput { side, ankle, ankle_y: rest.y, toe, height, vertices: &vertices })
    });
    let (feet, one_mirrored) = matched(measured, &joints, height, &mut warnings);
    if one_mirrored {
        confidence_factor *= 0.95;
    }
    let mass =
        input.mass.filter(|mass| mass.is_finite() && *mass > 0.0).unwrap_or(MASS_PER_HEIGHT_SQUARED * height * height);
    let segments = segments(&joints, &feet, height, mass);
    let leg_length = Side::BOTH
        .map(|side| {
            let [hip, knee, ankle, _] = leg_roles(side).map(|role| places.get(&role).copied().unwrap_or(DVec3::ZERO));
            hip.distance(knee) + knee.distance(ankle)
        })
        .iter()
        .sum::<f64>()
        / 2.0;
    let flanks = flanks(input.mesh, &skin, &places, height);
    let belly = belly(&skin, &places, height);
    let flesh = flesh(&skin, &joints, &feet, height);
    let body = Body { joints, segments, feet, mass, height, leg_length, flanks, belly, flesh };
    DerivedBody { body, joint_nodes, warnings, confidence_factor }
}

/// m, how far the trunk's mesh reaches ahead of the hips joint between hips and elbows, near the middle plane; 0 without one.
fn belly(skin: &Skin, places: &BTreeMap<Role, DVec3>, height: f64) -> f64 {
    let place = |role: Role| places.get(&role).copied();
    let (Some(hips), Some(shoulder), Some(elbow)) =
        (place(Role::Hips), place(Role::LeftUpperArm), place(Role::LeftLowerArm))
    else {
        return 0.0;
    };
    let high = shoulder.y - 0.6 * shoulder.distance(elbow);
    [Role::Hips, Role::Spine, Role::Chest]
        .into_iter()
        .flat_map(|role| skin.of(role))
        .filter(|vertex| vertex.y > hips.y && vertex.y < high && (vertex.x - hips.x).abs() < 0.08 * height)
        .map(|vertex| vertex.z - hips.z)
        .fold(0.0, f64::max)
}

/// The mass that a document states for its character: `scenes[scene].extras.surefoot.mass_kg`, kg. The built-in rig does.
pub fn stated_mass(document: &serde_json::Value) -> Option<f64> {
    let scene = document.get("scene").and_then(serde_json::Value::as_u64).unwrap_or(0);
    let extras = document.get("scenes")?.get(usize::try_from(scene).ok()?)?.get("extras")?;
    extras.get("surefoot")?.get("mass_kg")?.as_f64().filter(|mass| mass.is_finite() && *mass > 0.0)
}

pub(super) fn leg_roles(side: Side) -> [Role; 4] {
    match side {
        Side::Left => [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes],
        Side::Right => [Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot, Role::RightToes],
    }
}

pub(super) fn arm_roles(side: Side) -> [Role; 3] {
    match side {
        Side::Left => [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand],
        Side::Right => [Role::RightUpperArm, Role::RightLowerArm, Role::RightHand],
    }
}

/// Where a joint of an ordinary adult stands, shares of the height, arms down, left side (Winter's proportions).
fn template(role: Role) -> DVec3 {
    match role {
        Role::Hips => DVec3::new(0.0, 0.54, 0.0),
        Role::Spine => DVec3::new(0.0, 0.60, 0.0),
        Role::Head => DVec3::new(0.0, 0.885, 0.0),
        Role::LeftUpperLeg | Role::RightUpperLeg => DVec3::new(0.055, 0.53, 0.0),
        Role::LeftLowerLeg | Role::RightLowerLeg => DVec3::new(0.055, 0.285, 0.0),
        Role::LeftFoot | Role::RightFoot => DVec3::new(0.055, 0.04, 0.0),
        Role::LeftUpperArm | Role::RightUpperArm => DVec3::new(0.11, 0.818, 0.0),
        Role::LeftLowerArm | Role::RightLowerArm => DVec3::new(0.12, 0.63, 0.0),
        _ => DVec3::new(0.12, 0.485, 0.0),
    }
}

/// Fills in what a leg lacks; a foot by the mesh that hangs on the shank.
fn extrapolate_leg(side: Side, height: f64, skin: &Skin, places: &mut BTreeMap<Role, DVec3>) {
    let [hip, knee, foot, _] = leg_roles(side);
    let mirror = DVec3::new(side.sign(), 1.0, 1.0);
    for role in [hip, knee] {
        places.entry(role).or_insert_with(|| template(role) * height * mirror);
    }
    if places.contains_key(&foot) {
        return;
    }
    let (hip, knee) = (places[&hip], places[&knee]);
    let shank: Vec<DVec3> = skin.of(leg_roles(side)[1]).collect();
    let bottom = shank.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
    let bottom = if bottom.is_finite() && bottom < knee.y { bottom } else { 0.0 };
    // Ankle over sole is 0.14 of knee over sole in people.
    let drop = 0.86 * (knee.y - bottom).max(0.1 * height);
    let thigh = (knee - hip).try_normalize().unwrap_or(DVec3::NEG_Y);
    // The shank goes on straight down, or a little along the thigh where the bind pose is bent or spread.
    let shank_direction = (thigh + 2.0 * DVec3::NEG_Y).try_normalize().unwrap_or(DVec3::NEG_Y);
    let mut ankle = knee + shank_direction * (drop / -shank_direction.y.min(-0.5));
    // The mesh knows better where its ankle is, sideways.
    let slice: Vec<DVec3> = shank.iter().copied().filter(|point| (point.y - ankle.y).abs() < 0.25 * drop).collect();
    if slice.len() >= 3 {
        let low = slice.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = slice.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        ankle.x = (low.x + high.x) / 2.0;
    }
    places.insert(foot, ankle);
}

/// Fills in what an arm lacks; a hand by the mesh that hangs on the forearm.
fn extrapolate_arm(side: Side, height: f64, skin: &Skin, places: &mut BTreeMap<Role, DVec3>) {
    let [shoulder, elbow, hand] = arm_roles(side);
    let mirror = DVec3::new(side.sign(), 1.0, 1.0);
    for role in [shoulder, elbow] {
        places.entry(role).or_insert_with(|| template(role) * height * mirror);
    }
    if places.contains_key(&hand) {
        return;
    }
    let (shoulder_at, elbow_at) = (places[&shoulder], places[&elbow]);
    let upper = elbow_at - shoulder_at;
    let direction = upper.try_normalize().unwrap_or(DVec3::NEG_Y);
    let reach = skin.of(elbow).map(|point| (point - elbow_at).dot(direction)).fold(0.0, f64::max);
    // Of elbow to fingertips the wrist stands at 0.58 (de Leva); without a mesh the forearm is 0.85 of the upper arm.
    let length = if reach > 0.3 * upper.length() { 0.58 * reach } else { 0.85 * upper.length() };
    places.insert(hand, elbow_at + direction * length);
}

/// Ground to the top of the head.
fn height(input: &BodyInput, skin: &Skin) -> f64 {
    let place = |role: Role| input.bones.get(&role).map(|bone| bone.1);
    let head = place(Role::Head);
    // Hair and hats hang on nodes of their own under the head; but so may most of the skull, on a leaf joint.
    let joint = head.map_or(0.0, |head| head.y);
    let (itself, whole) = (crown(&skin.head(true)), crown(&skin.head(false)));
    let skull = itself.filter(|top| whole.is_none_or(|whole| *top - joint > 0.55 * (whole - joint))).or(whole);
    if let Some(crown) = skull.filter(|crown| *crown > head.map_or(0.0, |head| head.y)) {
        return crown.max(1e-3);
    }
    let highest = input.bones.values().map(|bone| bone.1.y).fold(0.0, f64::max);
    let from_joints = match head {
        // The head's joint at the skull's base stands at 0.885 of the height.
        Some(head) if head.y > 0.0 => (head.y / template(Role::Head).y).max(highest),
        // Nor is a raised hand its crown: the shoulders tell, at 0.818.
        _ => match place(Role::LeftUpperArm).zip(place(Role::RightUpperArm)) {
            Some((left, right)) => 0.5 * (left.y + right.y) / template(Role::LeftUpperArm).y,
            None => highest * 1.1,
        },
    };
    from_joints.max(1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec2};

    /// Joints of the template, both sides, for 1.7 m; node indices are their order.
    fn bones(roles: &[Role]) -> BTreeMap<Role, (usize, DVec3)> {
        let mut list = BTreeMap::new();
        for (node, role) in roles.iter().enumerate() {
            let place = template(*role) * 1.7;
            let place = if role.name().starts_with("right") { DVec3::new(-place.x, place.y, place.z) } else { place };
            list.insert(*role, (node, place));
        }
        list
    }

    fn with_feet_and_hands() -> Vec<Role> {
        let mut roles = Role::REQUIRED.to_vec();
        roles.extend([Role::LeftHand, Role::RightHand, Role::LeftFoot, Role::RightFoot]);
        roles
    }

    /// A box of a mesh with all its weight on one node.
    fn block(node: usize, low: DVec3, high: DVec3) -> MeshPart {
        let corner = |bit: usize, of: usize, a: f64, b: f64| if of >> bit & 1 == 0 { a } else { b };
        let positions: Vec<DVec3> = (0..8)
            .map(|of| {
                DVec3::new(corner(0, of, low.x, high.x), corner(1, of, low.y, high.y), corner(2, of, low.z, high.z))
            })
            .collect();
        let weights = vec![[(node, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)]; 8];
        MeshPart { positions, weights, ..MeshPart::default() }
    }

    fn derive_from(bones: &BTreeMap<Role, (usize, DVec3)>, mesh: &[MeshPart], mass: Option<f64>) -> DerivedBody {
        let parents = vec![None; 64];
        derive(&BodyInput { bones, mesh, parents: &parents, mass })
    }

    #[test]
    fn segments_weigh_what_the_body_weighs_and_stand_upright() {
        let derived = derive_from(&bones(&with_feet_and_hands()), &[], Some(80.0));
        let body = &derived.body;
        let sum: f64 = body.segments.iter().map(|segment| segment.mass).sum();
        assert!((sum - 80.0).abs() < 1e-9, "{sum}");
        assert!((body.height - 1.7).abs() < 1e-9, "{}", body.height);
        let centre: DVec3 = body
            .segments
            .iter()
            .map(|segment| (body.joints[segment.joint].rest + segment.centre) * segment.mass)
            .sum::<DVec3>()
            / sum;
        // Standing men have it at 0.56 of their height, over their feet.
        assert!((0.53..0.59).contains(&(centre.y / 1.7)), "centre of mass at {}", centre.y);
        assert!(centre.x.abs() < 1e-12 && centre.z.abs() < 0.05, "{centre}");
        assert_eq!(derived.joint_nodes.iter().flatten().count(), 15);
    }

    #[test]
    fn a_symmetric_rig_gives_a_symmetric_body() {
        let derived = derive_from(&bones(&with_feet_and_hands()), &[], None);
        let body = derived.body;
        let flip = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        for segment in &body.segments {
            let role = body.joints[segment.joint].role;
            let twin = body
                .segments
                .iter()
                .find(|other| body.joints[other.joint].role == role.mirrored() && other.mass == segment.mass)
                .expect("each segment has a twin");
            assert_eq!(flip * segment.centre, twin.centre, "{role:?}");
            assert_eq!(flip * segment.inertia * flip, twin.inertia, "{role:?}");
        }
        let [left, right] = &body.feet;
        assert_eq!((left.heel, left.tip, left.half_width), (right.heel, right.tip, right.half_width));
        for (one, other) in left.rear_sole.iter().zip(&right.rear_sole) {
            let mirrored = right.rear_sole.iter().any(|point| flip * *point == *one);
            assert!(mirrored, "{one} has no twin like {other}");
        }
    }

    #[test]
    fn a_leg_without_a_foot_gets_one_from_the_shank_mesh() {
        let found = bones(&Role::REQUIRED);
        let (shank, knee) = found[&Role::LeftLowerLeg];
        let leg = block(shank, DVec3::new(knee.x - 0.05, 0.0, -0.07), DVec3::new(knee.x + 0.05, knee.y, 0.17));
        let derived = derive_from(&found, &[leg], None);
        let body = &derived.body;
        let foot = &body.feet[Side::Left as usize];
        let ankle = &body.joints[foot.ankle];
        assert_eq!((ankle.role, ankle.animated, foot.toe), (Role::LeftFoot, false, None));
        assert!((ankle.rest.y - foot.ankle_height).abs() < 1e-9, "the sole is on the ground: {}", foot.ankle_height);
        assert!((foot.tip - foot.heel - 0.24).abs() < 1e-9, "{} to {}", foot.heel, foot.tip);
        assert!(derived.warnings.iter().any(|warning| warning.contains("leftFoot")), "{:?}", derived.warnings);
        assert!(derived.confidence_factor < 0.95, "{}", derived.confidence_factor);
    }

    #[test]
    fn the_height_is_the_skull_and_not_the_feather() {
        let found = bones(&with_feet_and_hands());
        let head = found[&Role::Head].0;
        let skull = block(head, DVec3::new(-0.08, 1.48, -0.1), DVec3::new(0.08, 1.72, 0.1));
        let feather = block(head, DVec3::new(-0.005, 1.72, -0.005), DVec3::new(0.005, 2.1, 0.005));
        let plain = derive_from(&found, std::slice::from_ref(&skull), None);
        let adorned = derive_from(&found, &[skull, feather], None);
        assert!((plain.body.height - 1.72).abs() < 1e-9, "{}", plain.body.height);
        assert!((adorned.body.height - 1.72).abs() < 1e-9, "{}", adorned.body.height);
        assert!((plain.body.mass - 23.0 * 1.72f64.powi(2)).abs() < 1e-9, "{}", plain.body.mass);
    }

    #[test]
    fn eyes_over_the_head_are_of_its_height_and_hair_is_not() {
        let mut roles = with_feet_and_hands();
        roles.extend([Role::LeftEye, Role::RightEye]);
        let found = bones(&roles);
        let (head, eye) = (found[&Role::Head].0, found[&Role::LeftEye].0);
        let skull = block(head, DVec3::new(-0.18, 1.45, -0.18), DVec3::new(0.18, 1.72, 0.18));
        let box_eye = block(eye, DVec3::new(0.0, 1.6, -0.1), DVec3::new(0.35, 1.95, 0.25));
        // Node 40 is hair: a leaf on the head.
        let mut parents = vec![None; 64];
        parents[40] = Some(head);
        let hair = block(40, DVec3::new(-0.1, 1.6, -0.2), DVec3::new(0.1, 2.1, 0.0));
        let derived =
            derive(&BodyInput { bones: &found, mesh: &[skull, box_eye, hair], parents: &parents, mass: None });
        assert!((derived.body.height - 1.95).abs() < 1e-9, "{}", derived.body.height);
    }

    #[test]
    fn vertices_of_unmapped_nodes_count_for_the_bone_above() {
        let found = bones(&with_feet_and_hands());
        let (foot, ankle) = found[&Role::RightFoot];
        // Node 40 is a leaf on 41, which is a leaf on the foot.
        let mut parents = vec![None; 64];
        parents[40] = Some(41);
        parents[41] = Some(foot);
        let sole = block(40, ankle + DVec3::new(-0.05, -ankle.y, -0.06), ankle + DVec3::new(0.05, 0.0, 0.19));
        let derived = derive(&BodyInput { bones: &found, mesh: &[sole], parents: &parents, mass: None });
        let shape = &derived.body.feet[Side::Right as usize];
        assert!((shape.tip - 0.19).abs() < 1e-9 && (shape.half_width - 0.05).abs() < 1e-9, "{shape:?}");
        assert_eq!(shape.forward, DVec2::Y);
    }

    #[test]
    fn an_empty_rig_and_a_looped_one_make_no_panic() {
        let derived = derive(&BodyInput { bones: &BTreeMap::new(), mesh: &[], parents: &[], mass: Some(f64::NAN) });
        assert!(derived.body.mass > 0.0 && derived.body.segments.iter().all(|segment| segment.centre.is_finite()));
        let found = bones(&with_feet_and_hands());
        let mesh = [block(50, DVec3::ZERO, DVec3::ONE)];
        let parents = vec![Some(50); 64];
        derive(&BodyInput { bones: &found, mesh: &mesh, parents: &parents, mass: None });
    }
}
