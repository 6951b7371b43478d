//! Rigs made by hand, with the troubles of real ones on demand, and a stepping motion that is exact at any time.

use glam::{DAffine3, DMat4, DQuat, DVec2, DVec3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use surefoot::bake::contacts::FootContact;
use surefoot::model::report::Part;
use surefoot::model::{Body, BodyJoint, BodyPose, FootShape, Role, Segment, Side};
use surefoot::rig::{Document, Mapping, Rig, RigNode, Similarity, Trs};
use surefoot::stepper::Plant;

/// What is awkward about a rig.
#[derive(Clone, Copy, Debug)]
pub struct Trouble {
    /// Of the armature node.
    pub scale: f64,
    /// The armature is Z-up: turned by -90 degrees about X.
    pub z_up: bool,
    /// Document units a metre.
    pub units: f64,
    /// rad, the document's forward against +Z.
    pub heading: f64,
    /// There is a bone called root.
    pub root_bone: bool,
    /// Nodes rest in another pose than they are bound in.
    pub rests_elsewhere: bool,
    /// The hips node has a matrix.
    pub matrix: bool,
    /// Mirrored armature (scale -1 on x, and the bones placed to match).
    pub mirrored: bool,
}

pub const PLAIN: Trouble = Trouble {
    scale: 1.0,
    z_up: false,
    units: 1.0,
    heading: 0.0,
    root_bone: false,
    rests_elsewhere: false,
    matrix: false,
    mirrored: false,
};

/// Every trouble, one a rig, and several together.
pub fn troubles() -> Vec<(&'static str, Trouble)> {
    vec![
        ("plain", PLAIN),
        ("root_bone", Trouble { root_bone: true, ..PLAIN }),
        ("scaled_z_up", Trouble { scale: 0.01, z_up: true, ..PLAIN }),
        ("scaled_z_up_root_bone", Trouble { scale: 0.01, z_up: true, root_bone: true, ..PLAIN }),
        ("centimetres_sideways", Trouble { units: 100.0, heading: 1.2, ..PLAIN }),
        ("rests_elsewhere", Trouble { rests_elsewhere: true, root_bone: true, ..PLAIN }),
        ("matrix", Trouble { matrix: true, ..PLAIN }),
        ("mirrored", Trouble { mirrored: true, scale: 0.38, ..PLAIN }),
    ]
}

/// Name, parent, place in scenario space, role.
type Bone = (&'static str, Option<&'static str>, [f64; 3], Option<Role>);

const BONES: &[Bone] = &[
    ("hips", None, [0.0, 0.95, 0.0], Some(Role::Hips)),
    ("spine", Some("hips"), [0.0, 1.05, -0.01], Some(Role::Spine)),
    ("chest", Some("spine"), [0.0, 1.25, -0.01], Some(Role::Chest)),
    ("head", Some("chest"), [0.0, 1.5, 0.0], Some(Role::Head)),
    ("upperarm_l", Some("chest"), [0.18, 1.42, 0.0], Some(Role::LeftUpperArm)),
    ("lowerarm_l", Some("upperarm_l"), [0.46, 1.42, 0.0], Some(Role::LeftLowerArm)),
    ("hand_l", Some("lowerarm_l"), [0.72, 1.42, 0.0], Some(Role::LeftHand)),
    ("upperarm_r", Some("chest"), [-0.18, 1.42, 0.0], Some(Role::RightUpperArm)),
    ("lowerarm_r", Some("upperarm_r"), [-0.46, 1.42, 0.0], Some(Role::RightLowerArm)),
    ("thigh_l", Some("hips"), [0.1, 0.9, 0.0], Some(Role::LeftUpperLeg)),
    ("thigh_twist_l", Some("thigh_l"), [0.1, 0.7, 0.01], None),
    ("calf_l", Some("thigh_twist_l"), [0.1, 0.49, 0.02], Some(Role::LeftLowerLeg)),
    ("foot_l", Some("calf_l"), [0.1, 0.09, 0.0], Some(Role::LeftFoot)),
    ("ball_l", Some("foot_l"), [0.1, 0.02, 0.13], Some(Role::LeftToes)),
    ("thigh_r", Some("hips"), [-0.1, 0.9, 0.0], Some(Role::RightUpperLeg)),
    ("calf_r", Some("thigh_r"), [-0.1, 0.49, 0.02], Some(Role::RightLowerLeg)),
    ("foot_r", Some("calf_r"), [-0.1, 0.09, 0.0], Some(Role::RightFoot)),
    ("ball_r", Some("foot_r"), [-0.1, 0.02, 0.13], Some(Role::RightToes)),
    ("ik_foot_root", None, [0.0, 0.0, 0.0], None),
    ("ik_foot_l", Some("ik_foot_root"), [0.1, 0.09, 0.0], None),
];

/// Hands that no bone moves are joints of the body too.
const NO_BONE: (Role, Role, [f64; 3]) = (Role::RightHand, Role::RightLowerArm, [-0.72, 1.42, 0.0]);

/// A rig with those troubles. Bones have skew local axes throughout.
pub fn rig(trouble: Trouble) -> Rig {
    let document_from_scenario = Similarity {
        scale: trouble.units,
        rotation: DQuat::from_rotation_y(trouble.heading),
        translation: DVec3::new(0.3, 0.0, -0.2) * trouble.units,
    };
    let armature_turn =
        if trouble.z_up { DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2) } else { DQuat::IDENTITY };
    let mirror = if trouble.mirrored { -1.0 } else { 1.0 };
    let armature = Trs {
        translation: document_from_scenario.translation,
        rotation: document_from_scenario.rotation * armature_turn,
        scale: DVec3::splat(trouble.scale) * DVec3::new(mirror, 1.0, 1.0),
    };
    let node = |name: &str, parent: Option<usize>, local: Trs| RigNode {
        name: Some(name.into()),
        parent,
        children: Vec::new(),
        local,
        bind: local,
        has_matrix: false,
        mesh: None,
        skin: None,
    };
    let mut nodes = vec![node("Armature", None, armature), node("body_mesh", None, Trs::IDENTITY)];
    let mut globals: Vec<DAffine3> = vec![armature.affine(), DAffine3::IDENTITY];
    let place =
        |nodes: &mut Vec<RigNode>, globals: &mut Vec<DAffine3>, name: &str, parent: usize, at: DVec3, skew: f64| {
            let rotation = DQuat::from_rotation_x(skew) * DQuat::from_rotation_z(0.7 * skew);
            let translation = globals[parent].inverse().transform_point3(document_from_scenario.point(at));
            let local = Trs { translation, rotation, scale: DVec3::ONE };
            globals.push(globals[parent] * local.affine());
            nodes.push(node(name, Some(parent), local));
            nodes.len() - 1
        };
    let top = if trouble.root_bone { place(&mut nodes, &mut globals, "root", 0, DVec3::ZERO, 0.4) } else { 0 };
    for (index, (name, parent, at, _)) in BONES.iter().enumerate() {
        let parent = parent.map_or(top, |parent| {
            nodes.iter().position(|node| node.name.as_deref() == Some(parent)).expect("listed before")
        });
        place(&mut nodes, &mut globals, name, parent, DVec3::from_array(*at), 0.3 + 0.61 * index as f64);
    }
    for index in 0..nodes.len() {
        if let Some(parent) = nodes[index].parent {
            nodes[parent].children.push(index);
        }
        if trouble.rests_elsewhere && index > 2 {
            nodes[index].local.rotation = DQuat::from_rotation_y(0.2) * nodes[index].bind.rotation;
            nodes[index].local.translation *= 1.05;
        }
    }
    let find = |name: &str| nodes.iter().position(|node| node.name.as_deref() == Some(name)).expect("listed");
    let mapped: Vec<(Role, usize)> =
        BONES.iter().filter_map(|(name, .., role)| role.map(|role| (role, find(name)))).collect();
    nodes[mapped[0].1].has_matrix = trouble.matrix;
    let (body, joint_nodes) = body(&mapped);
    let json = document(&nodes, &mapped);
    let (mapping, buffer) = (
        Mapping {
            method: "by hand".into(),
            confidence: 1.0,
            bones: mapped.iter().copied().collect::<BTreeMap<_, _>>(),
            warnings: Vec::new(),
            up: "+Y".into(),
            forward: "+Z".into(),
        },
        // 37 bytes: not a multiple of four.
        [1.0f32, 1.0, 1.0].iter().flat_map(|value| value.to_le_bytes()).chain(0u8..25).collect::<Vec<u8>>(),
    );
    let document =
        Document { json, buffers: vec![buffer], glb_buffer: true, images: Vec::new(), image_files: Vec::new() };
    Rig {
        document,
        nodes,
        body,
        joint_nodes,
        document_from_scenario,
        mapping,
        mesh: Vec::new(),
        leg_scales: Default::default(),
    }
}

fn body(mapped: &[(Role, usize)]) -> (Body, Vec<Option<usize>>) {
    let mut roles: Vec<(Role, DVec3, Option<usize>)> = mapped
        .iter()
        .map(|(role, node)| {
            (*role, DVec3::from_array(BONES.iter().find(|bone| bone.3 == Some(*role)).expect("listed").2), Some(*node))
        })
        .collect();
    roles.push((NO_BONE.0, DVec3::from_array(NO_BONE.2), None));
    let at = |role: Role| roles.iter().position(|(other, ..)| *other == role);
    let parent = |role: Role| {
        let mut above = role.parent();
        while let Some(role) = above.filter(|role| at(*role).is_none()) {
            above = role.parent();
        }
        above.and_then(at)
    };
    let joints: Vec<BodyJoint> = roles
        .iter()
        .map(|(role, rest, node)| BodyJoint {
            role: *role,
            parent: parent(*role),
            rest: *rest,
            animated: node.is_some(),
        })
        .collect();
    let segments = vec![Segment { joint: 0, mass: 70.0, centre: DVec3::ZERO, inertia: glam::DMat3::IDENTITY }];
    let foot = |ankle: Role, toe: Role| FootShape {
        ankle: at(ankle).expect("there"),
        toe: at(toe),
        ankle_height: 0.09,
        forward: DVec2::Y,
        heel: -0.06,
        ball: 0.13,
        tip: 0.2,
        half_width: 0.045,
        level: DQuat::IDENTITY,
        toe_level: DQuat::IDENTITY,
        rear_sole: vec![DVec3::new(0.0, -0.09, -0.06)],
        front_sole: vec![DVec3::new(0.0, -0.09, 0.2)],
    };
    let feet = [foot(Role::LeftFoot, Role::LeftToes), foot(Role::RightFoot, Role::RightToes)];
    let nodes = roles.iter().map(|(.., node)| *node).collect();
    (
        Body {
            joints,
            segments,
            feet,
            mass: 70.0,
            height: 1.7,
            leg_length: 0.81,
            flanks: [0.0; 2],
            belly: 0.0,
            flesh: vec![],
        },
        nodes,
    )
}

fn document(nodes: &[RigNode], mapped: &[(Role, usize)]) -> Value {
    let node = |node: &RigNode| {
        let Trs { translation, rotation, scale } = node.local;
        let mut json = json!({ "name": node.name });
        if node.has_matrix {
            json["matrix"] =
                json!(DMat4::from_scale_rotation_translation(scale, rotation, translation).to_cols_array());
        } else {
            json["rotation"] = json!(rotation.to_array());
            json["scale"] = json!(scale.to_array());
            json["translation"] = json!(translation.to_array());
        }
        if !node.children.is_empty() {
            json["children"] = json!(node.children);
        }
        json
    };
    let mut nodes: Vec<Value> = nodes.iter().map(node).collect();
    nodes[0]["extras"] = json!({ "keep": [1, { "me": 0.1 }] });
    let joints: Vec<usize> = mapped.iter().map(|(_, node)| *node).collect();
    json!({
        "asset": { "version": "2.0", "generator": "by hand" },
        "scene": 0,
        "scenes": [{ "name": "Scene", "nodes": [0, 1] }],
        "nodes": nodes,
        "skins": [{ "joints": joints }],
        "extensionsUsed": ["EXAMPLE_unknown"],
        "extensions": { "EXAMPLE_unknown": { "node": 3 } },
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 1, "type": "SCALAR", "min": [1.0], "max": [1.0] },
            { "bufferView": 1, "componentType": 5126, "count": 1, "type": "VEC3" }
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 12 }, { "buffer": 0, "byteLength": 12 }],
        "buffers": [{ "byteLength": 37 }],
        "animations": [{
            "name": "shove",
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "scale" } }],
            "samplers": [{ "input": 0, "output": 1 }]
        }]
    })
}

/// s: how long [`stepping`] lasts.
pub const DURATION: f64 = 4.0;

/// One step forward with each foot, with ball and heel phases: (left, right) foot's path as
/// ball off, lift, land (heel), flat, all in s.
const STEPS: [[f64; 4]; 2] = [[0.713, 0.8017, 1.2, 1.267], [1.41, 1.5, 1.8533, 1.91]];
const REACH: f64 = 0.28;

/// The body at `time`, feet exactly held where [`contacts`] says so.
pub fn stepping(body: &Body, time: f64) -> BodyPose {
    let mut pose = BodyPose::rest(body);
    let ease = |from: f64, to: f64| {
        let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    };
    let travel = REACH * ease(0.5, 2.2);
    let sway = (ease(0.2, 0.6) - ease(1.0, 2.6)) * (5.0 * time).sin();
    pose.hips = body.joints[0].rest + DVec3::new(0.03 * sway, -0.06 * ease(0.0, 0.5) + 0.02 * sway, travel);
    let pelvis = DQuat::from_rotation_y(0.15 * sway + 0.3 * ease(0.4, 2.0)) * DQuat::from_rotation_x(0.1 * sway);
    for (index, joint) in body.joints.iter().enumerate() {
        let wave = sway * (0.05 + 0.004 * index as f64);
        pose.turns[index] = match joint.parent {
            None => pelvis,
            Some(parent) if !joint.animated => pose.turns[parent],
            Some(parent) => pose.turns[parent] * DQuat::from_rotation_z(0.3 * wave) * DQuat::from_rotation_x(wave),
        };
    }
    for side in Side::BOTH {
        leg(body, &mut pose, side, time);
    }
    pose
}

fn leg(body: &Body, pose: &mut BodyPose, side: Side, time: f64) {
    let [ball, lift, land, flat] = STEPS[side as usize];
    let foot = &body.feet[side as usize];
    let rest = body.joints[foot.ankle].rest;
    let share = |from: f64, to: f64| {
        let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    };
    let end = DVec3::Z * REACH;
    let (pitch, ankle) = if time < lift {
        let pitch = 0.5 * share(ball, lift);
        let toe = DVec3::new(0.0, 0.02 - 0.09, 0.13);
        (pitch, rest + toe - DQuat::from_rotation_x(pitch) * toe)
    } else if time < land {
        let u = share(lift, land);
        let pitch = 0.5 - 0.75 * u;
        let toe = DVec3::new(0.0, 0.02 - 0.09, 0.13);
        let heel = DVec3::new(0.0, -0.09, -0.06);
        let from = rest + toe - DQuat::from_rotation_x(0.5) * toe;
        let to = rest + end + heel - DQuat::from_rotation_x(-0.25) * heel;
        (pitch, from.lerp(to, u) + DVec3::Y * (1.6 * u * u * (1.0 - u) * (1.0 - u)))
    } else {
        let pitch = -0.25 * (1.0 - share(land, flat));
        let heel = DVec3::new(0.0, -0.09, -0.06);
        (pitch, rest + end + heel - DQuat::from_rotation_x(pitch) * heel)
    };
    let calf = body.joints[foot.ankle].parent.expect("a foot hangs from a leg");
    let thigh = body.joints[calf].parent.expect("a leg has two parts");
    let hip = pose.positions(body)[thigh];
    let (upper, lower) = (body.offset(calf), body.offset(foot.ankle));
    let span = ankle - hip;
    let length = span.length().min(0.9999 * (upper.length() + lower.length()));
    let along = (upper.length_squared() - lower.length_squared() + length * length) / (2.0 * length);
    let forward = (DVec3::Z - span * DVec3::Z.dot(span) / span.length_squared()).normalize();
    let knee = hip + span.normalize() * along + forward * (upper.length_squared() - along * along).max(0.0).sqrt();
    pose.turns[thigh] = DQuat::from_rotation_arc(upper.normalize(), (knee - hip).normalize());
    pose.turns[calf] = DQuat::from_rotation_arc(lower.normalize(), (ankle - knee).normalize());
    pose.turns[foot.ankle] = DQuat::from_rotation_x(pitch);
    if let Some(toe) = foot.toe {
        pose.turns[toe] = DQuat::from_rotation_x(pitch * share(lift, land));
    }
}

/// What the feet of [`stepping`] hold.
pub fn contacts() -> Vec<FootContact> {
    let mut contacts = Vec::new();
    for side in Side::BOTH {
        let [ball, lift, land, flat] = STEPS[side as usize];
        let plant = |z: f64| Plant::level(DVec3::new(0.1 * side.sign(), 0.0, z), 0.0);
        let spans = [
            (Part::Flat, 0.0, ball, 0.0),
            (Part::Ball, ball, lift, 0.0),
            (Part::Heel, land, flat, REACH),
            (Part::Flat, flat, DURATION, REACH),
        ];
        contacts.extend(spans.map(|(part, start, end, z)| FootContact { side, part, start, end, plant: plant(z) }));
    }
    contacts
}

/// The point or points of a foot that a contact holds, as the clip's pose has them.
pub fn held(rig: &Rig, pose: &surefoot::rig::animate::SampledPose, contact: &FootContact) -> Vec<DVec3> {
    let points = surefoot::measure::support::held_points(&rig.body, contact.side, contact.part);
    points.iter().map(|point| pose.positions[point.joint] + pose.turns[point.joint] * point.offset).collect()
}
