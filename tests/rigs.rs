//! Real rigs: the right node for each bone, height, heading, unit; the same without names; what is refused.

use super::data;
use super::rig_variants::{load_document, parse, strip};
use surefoot::model::Role;
use surefoot::rig::{Rig, RigError, load};

/// What a file must give. Names of the left side; `{}` stands for the side. A name `#7` is node 7.
struct Expected {
    file: &'static str,
    method: &'static str,
    forward: &'static str,
    /// m
    height: f64,
    sides: [&'static str; 2],
    middle: &'static [(Role, &'static str)],
    paired: &'static [(Role, &'static str)],
}

use Role::*;

const UNREAL: &[(Role, &str)] = &[
    (LeftShoulder, "clavicle_{}"),
    (LeftUpperArm, "upperarm_{}"),
    (LeftLowerArm, "lowerarm_{}"),
    (LeftHand, "hand_{}"),
    (LeftUpperLeg, "thigh_{}"),
    (LeftLowerLeg, "calf_{}"),
    (LeftFoot, "foot_{}"),
    (LeftToes, "ball_{}"),
    (LeftIndexProximal, "index_01_{}"),
    (LeftThumbDistal, "thumb_03_{}"),
];
const UNREAL_MIDDLE: &[(Role, &str)] = &[
    (Hips, "pelvis"),
    (Spine, "spine_01"),
    (Chest, "spine_02"),
    (UpperChest, "spine_03"),
    (Neck, "neck_01"),
    (Head, "head"),
];
const ROBOT: &[(Role, &str)] = &[
    (LeftShoulder, "shoulder.{}"),
    (LeftUpperArm, "upper_arm.{}"),
    (LeftLowerArm, "lower_arm.{}"),
    (LeftHand, "hand.{}"),
    (LeftUpperLeg, "upper_leg.{}"),
    (LeftLowerLeg, "lower_leg.{}"),
    (LeftFoot, "foot.{}"),
    (LeftToes, "toes.{}"),
    (LeftThumbMetacarpal, "thumb_proximal.{}"),
];
const ROBOT_MIDDLE: &[(Role, &str)] =
    &[(Hips, "hips"), (Spine, "spine"), (Chest, "chest"), (Neck, "neck"), (Head, "head")];

fn expected() -> Vec<Expected> {
    let unreal = |file, height| Expected {
        file,
        method: "names: Unreal",
        forward: "+Z",
        height,
        sides: ["l", "r"],
        middle: UNREAL_MIDDLE,
        paired: UNREAL,
    };
    let robot = |file, method, forward, height| Expected {
        file,
        method,
        forward,
        height,
        sides: ["L", "R"],
        middle: ROBOT_MIDDLE,
        paired: ROBOT,
    };
    vec![
        unreal("rigs/m2m_human_male.glb", 1.83),
        unreal("rigs/m2m_ue_names_no_animation.glb", 1.83),
        unreal("rigs/m2m_ue_names_wrong_bone_count.glb", 1.83),
        unreal("rigs/m2m_rig_human.glb", 1.79),
        robot("rigs/vrm1_debug_robot.vrm", "vrm1", "+Z", 2.1),
        robot("rigs/vrm_tiny_basic_armature.vrm", "vrm0", "-Z", 1.75),
        robot("rigs/vrm_tiny_basic_armature_vrm1.vrm", "vrm1", "+Z", 1.75),
        Expected {
            file: "rigs/vrm_tiny_minimal.vrm",
            method: "vrm0",
            forward: "-Z",
            height: 2.0,
            sides: ["L", "R"],
            middle: ROBOT_MIDDLE,
            paired: &[
                (LeftUpperArm, "upper_arm.{}"),
                (LeftLowerArm, "lower_arm.{}"),
                (LeftHand, "hand.{}"),
                (LeftUpperLeg, "upper_leg.{}"),
                (LeftLowerLeg, "lower_leg.{}"),
                (LeftFoot, "foot.{}"),
            ],
        },
        Expected {
            file: "rigs/m2m_human_base_animations.glb",
            method: "names: Rigify",
            forward: "+Z",
            height: 1.83,
            sides: ["L", "R"],
            middle: &[
                (Hips, "DEF-hips"),
                (Spine, "DEF-spine.001"),
                (Chest, "DEF-spine.002"),
                (UpperChest, "DEF-spine.003"),
                (Neck, "DEF-neck"),
                (Head, "DEF-head"),
            ],
            paired: &[
                (LeftShoulder, "DEF-shoulder.{}"),
                (LeftUpperArm, "DEF-upper_arm.{}"),
                (LeftLowerArm, "DEF-forearm.{}"),
                (LeftHand, "DEF-hand.{}"),
                (LeftUpperLeg, "DEF-thigh.{}"),
                (LeftLowerLeg, "DEF-shin.{}"),
                (LeftFoot, "DEF-foot.{}"),
                (LeftToes, "DEF-toe.{}"),
                (LeftLittleDistal, "DEF-f_pinky.03.{}"),
            ],
        },
        Expected {
            file: "rigs/kaykit_Knight.glb",
            method: "names: KayKit",
            forward: "+Z",
            height: 2.315,
            sides: ["l", "r"],
            middle: &[(Hips, "hips"), (Spine, "spine"), (Chest, "chest"), (Head, "head")],
            paired: &[
                (LeftUpperArm, "upperarm.{}"),
                (LeftLowerArm, "lowerarm.{}"),
                (LeftHand, "hand.{}"),
                (LeftUpperLeg, "upperleg.{}"),
                (LeftLowerLeg, "lowerleg.{}"),
                (LeftFoot, "foot.{}"),
                (LeftToes, "toes.{}"),
            ],
        },
        Expected {
            file: "rigs/gdquest_mannequiny.glb",
            method: "names: Unreal",
            forward: "+Z",
            height: 1.8,
            sides: ["l", "r"],
            middle: &[(Hips, "pelvis"), (Spine, "spine_01"), (Chest, "spine_02"), (Neck, "neck_01"), (Head, "head")],
            paired: &[
                (LeftShoulder, "clavicle.{}"),
                (LeftUpperArm, "upperarm.{}"),
                (LeftLowerArm, "lowerarm.{}"),
                (LeftHand, "hand.{}"),
                (LeftUpperLeg, "thigh.{}"),
                (LeftLowerLeg, "calf.{}"),
                (LeftFoot, "foot.{}"),
                (LeftToes, "ball.{}"),
            ],
        },
        Expected {
            file: "rigs/sketchbook_boxman.glb",
            method: "names: KayKit",
            forward: "+Z",
            height: 1.027,
            sides: ["L", "R"],
            middle: &[(Hips, "butt_bone"), (Spine, "body_lower"), (Chest, "body_upper"), (Head, "head")],
            paired: &[
                (LeftUpperArm, "arm_upper.{}"),
                (LeftLowerArm, "arm_lower.{}"),
                (LeftUpperLeg, "leg_upper.{}"),
                (LeftLowerLeg, "leg_lower.{}"),
            ],
        },
        Expected {
            file: "rigs/godette_vrm0.vrm",
            method: "vrm0",
            forward: "-Z",
            height: 1.45,
            sides: ["l", "r"],
            middle: &[
                (Hips, "pelvis_Armature"),
                (Spine, "tummy_Armature"),
                (Chest, "chest_Armature"),
                (Neck, "neck_Armature"),
                (Head, "head_Armature"),
            ],
            paired: &[
                (LeftShoulder, "shoulder.{}_Armature"),
                (LeftUpperArm, "upper_arm.{}_Armature"),
                (LeftLowerArm, "lowerarm.{}_Armature"),
                (LeftHand, "hand.{}_Armature"),
                (LeftUpperLeg, "thigh.{}_Armature"),
                (LeftLowerLeg, "shin.{}_Armature"),
                (LeftFoot, "foot.{}_Armature"),
                (LeftToes, "toes.{}_Armature"),
                (LeftThumbMetacarpal, "thumb.1.{}_Armature"),
            ],
        },
        Expected {
            file: "rigs/khronos_CesiumMan.gltf",
            method: "geometry",
            forward: "+X",
            height: 1.507,
            sides: ["", ""],
            middle: &[
                (Hips, "#2"),
                (Spine, "#11"),
                (Chest, "#12"),
                (Neck, "#19"),
                (Head, "#20"),
                (LeftUpperArm, "#16"),
                (LeftLowerArm, "#17"),
                (LeftHand, "#18"),
                (RightUpperArm, "#13"),
                (RightLowerArm, "#14"),
                (RightHand, "#15"),
                (LeftUpperLeg, "#7"),
                (LeftLowerLeg, "#8"),
                (LeftFoot, "#9"),
                (LeftToes, "#10"),
                (RightUpperLeg, "#3"),
                (RightLowerLeg, "#4"),
                (RightFoot, "#5"),
                (RightToes, "#6"),
            ],
            paired: &[],
        },
        Expected {
            file: "forces/rajagopal_walk.glb",
            method: "names: OpenSim",
            forward: "+X",
            height: 1.75,
            sides: ["l", "r"],
            middle: &[(Hips, "pelvis"), (Spine, "torso")],
            paired: &[
                (LeftUpperArm, "humerus_{}"),
                (LeftLowerArm, "ulna_{}"),
                (LeftHand, "hand_{}"),
                (LeftUpperLeg, "femur_{}"),
                (LeftLowerLeg, "tibia_{}"),
                (LeftFoot, "talus_{}"),
                (LeftToes, "toes_{}"),
            ],
        },
    ]
}

#[test]
fn every_real_humanoid_maps_to_the_bones_that_a_person_sees() {
    let Some(data) = data::folder() else { return };
    for case in expected() {
        let rig = load(&data.join(case.file)).unwrap_or_else(|error| panic!("{error}"));
        let file = case.file;
        let check = |role: Role, name: &str| {
            let node = *rig.mapping.bones.get(&role).unwrap_or_else(|| panic!("{file}: no {}", role.name()));
            let found = rig.nodes[node].name.clone().unwrap_or_default();
            let fits = name.strip_prefix('#').map_or(found == name, |index| index.parse() == Ok(node));
            assert!(fits, "{file}: {} is {found} ({node}), not {name}", role.name());
        };
        case.middle.iter().for_each(|(role, name)| check(*role, name));
        for (role, name) in case.paired {
            check(*role, &name.replace("{}", case.sides[0]));
            check(role.mirrored(), &name.replace("{}", case.sides[1]));
        }
        assert!(rig.mapping.method.starts_with(case.method), "{file}: by {}", rig.mapping.method);
        assert_eq!(rig.mapping.up, "+Y", "{file}");
        assert_eq!(rig.mapping.forward, case.forward, "{file}");
        assert_eq!(rig.document_from_scenario.scale, 1.0, "{file}: in metres as it stands");
        stands_as_scenario_space_says(file, &rig);
        assert!(
            (height(&rig) / case.height - 1.0).abs() < 0.07,
            "{file}: {:.3} m high, not {}",
            height(&rig),
            case.height
        );
    }
}

/// Crown of the mesh without what is held, or 1/0.82 of the shoulders' height, m: what the loader alone decides.
fn height(rig: &Rig) -> f64 {
    let shoulder = place(rig, LeftUpperArm).expect("an arm").y;
    let Some(head) = rig.mapping.bones.get(&Head) else { return shoulder / 0.82 };
    let under = surefoot::rig::space::below(&rig.nodes, *head);
    let points = rig.mesh.iter().flat_map(|part| part.positions.iter().zip(&part.weights));
    let crown = points.filter(|(_, weights)| under[weights[0].0]).map(|(point, _)| point.y).fold(0.0, f64::max);
    if crown > 0.0 { crown } else { shoulder / 0.82 }
}

/// A joint at rest, m.
fn place(rig: &Rig, role: Role) -> Option<glam::DVec3> {
    rig.body.joint(role).map(|joint| rig.body.joints[joint].rest)
}

/// Left on +X, feet on the ground ahead of their ankles, the origin between them, head over hips.
pub fn stands_as_scenario_space_says(what: &str, rig: &Rig) {
    for left in [LeftUpperArm, LeftLowerArm, LeftUpperLeg, LeftLowerLeg, LeftFoot] {
        let (Some(a), Some(b)) = (place(rig, left), place(rig, left.mirrored())) else { continue };
        assert!(a.x > 0.01 && b.x < -0.01, "{what}: {} at x {:.3}, its mirror at {:.3}", left.name(), a.x, b.x);
    }
    if let (Some(foot), Some(toes)) = (place(rig, LeftFoot), place(rig, LeftToes)) {
        assert!(toes.z > foot.z, "{what}: toes at z {:.3}, ankle at {:.3}", toes.z, foot.z);
    }
    let middle = (place(rig, LeftUpperLeg).expect("leg") + place(rig, RightUpperLeg).expect("leg")) * 0.5;
    assert!(middle.x.abs() < 1e-6 && middle.z.abs() < 1e-6, "{what}: hips over {middle}");
    let lowest = rig
        .mesh
        .iter()
        .flat_map(|part| part.positions.iter().zip(&part.weights))
        .filter(|(_, weights)| {
            rig.mapping.bones.iter().any(|(role, node)| {
                matches!(role, LeftFoot | RightFoot | LeftToes | RightToes) && *node == weights[0].0
            })
        })
        .map(|(point, _)| point.y)
        .fold(f64::MAX, f64::min);
    assert!(lowest == f64::MAX || lowest.abs() < 0.01, "{what}: the lowest vertex of the feet is at {lowest:.4} m");
    let shoulders = place(rig, LeftUpperArm).expect("an arm").y;
    assert!(
        shoulders > middle.y && middle.y > 0.1 * shoulders,
        "{what}: hips at {:.3}, shoulders at {shoulders:.3}",
        middle.y
    );
}

#[test]
fn the_bones_of_unnamed_rigs_are_those_that_their_names_say() {
    let Some(data) = data::folder() else { return };
    let core = [LeftUpperArm, LeftLowerArm, LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes];
    for case in expected().iter().filter(|case| case.method != "geometry" && !case.file.contains("rajagopal")) {
        let path = data.join(case.file);
        let named = load(&path).expect("a rig");
        let mut document = parse(&path);
        strip(&mut document);
        let bare = load_document(&document).unwrap_or_else(|error| panic!("{}: {error}", case.file));
        assert_eq!(bare.mapping.method, "geometry", "{}", case.file);
        assert!(bare.mapping.confidence < named.mapping.confidence, "{}: a guess is surer than names", case.file);
        // Without toes nothing shows the front of the plainest rigs: then the sides may be exchanged.
        let front = bare.mapping.forward == named.mapping.forward;
        assert!(front || !named.mapping.bones.contains_key(&LeftToes), "{}: faces {}", case.file, bare.mapping.forward);
        for role in [Hips, Spine, Chest, Neck, Head] {
            assert_eq!(bare.mapping.bones.get(&role), named.mapping.bones.get(&role), "{}: {}", case.file, role.name());
        }
        for role in core.into_iter().flat_map(|role| [role, role.mirrored()]) {
            let found = if front { role } else { role.mirrored() };
            let name = format!("{}: {}", case.file, role.name());
            assert_eq!(bare.mapping.bones.get(&found), named.mapping.bones.get(&role), "{name}");
        }
    }
}

#[test]
fn the_fox_is_refused_as_a_quadruped_named_or_not() {
    let Some(data) = data::folder() else { return };
    let path = data.join("rigs/khronos_Fox.glb");
    let mut bare = parse(&path);
    strip(&mut bare);
    for refused in [load(&path), load_document(&bare)] {
        let error = refused.expect_err("a fox is no human");
        assert!(matches!(error, RigError::NotHumanoid { .. }), "{error}");
        assert!(error.to_string().contains("quadruped"), "{error}");
    }
}

#[test]
fn the_bind_pose_is_upright_where_the_nodes_rest_in_mid_air() {
    let Some(data) = data::folder() else { return };
    let rig = load(&data.join("rigs/gdquest_mannequiny.glb")).expect("a rig");
    let at = |role| place(&rig, role).expect("a joint");
    assert!((at(LeftFoot).y - at(RightFoot).y).abs() < 0.005, "feet at one height");
    assert!((at(LeftLowerArm).y - at(LeftUpperArm).y).abs() < 0.02, "arms straight out: a T-pose");
    let node = rig.mapping.bones[&LeftLowerLeg];
    let turned = rig.nodes[node].local.rotation.angle_between(rig.nodes[node].bind.rotation).to_degrees();
    assert!(turned > 30.0, "the knee of the resting node is bent, {turned:.0} degrees from the bind pose");
}
