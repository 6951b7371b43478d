//! Rigs made from others or from nothing: scales, axes, units, skins, conventions, lacking bones, overrides.

use super::data;
use super::rigs::stands_as_scenario_space_says;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use surefoot::model::Role;
use surefoot::rig::{Document, Rig, RigError, inspect_json, inspect_text, load, load_bytes};

use Role::*;

#[test]
fn a_scaled_turned_or_centimetre_armature_gives_the_same_body() {
    let Some(data) = data::folder() else { return };
    for file in ["rigs/m2m_human_male.glb", "rigs/kaykit_Knight.glb", "rigs/gdquest_mannequiny.glb"] {
        let path = data.join(file);
        let plain = load(&path).expect("a rig");
        let root = (0..plain.nodes.len()).find(|node| plain.nodes[*node].parent.is_none()).expect("a root");
        // (scale of the root, metres a unit that must be found, height relative to the plain one)
        for (scale, unit, relative) in [(0.01, 100.0, 1.0), (0.38, 1.0, 0.38), (100.0, 0.01, 1.0), (10.0, 0.1, 1.0)] {
            let mut document = parse(&path);
            document.json["nodes"][root]["scale"] = json!([scale, scale, scale]);
            let rig = load_document(&document).unwrap_or_else(|error| panic!("{error}"));
            let what = format!("{file} scaled by {scale}");
            assert_eq!(rig.mapping.bones, plain.mapping.bones, "{what}");
            assert!(
                (rig.document_from_scenario.scale * unit - 1.0).abs() < 1e-9,
                "{what}: {} a metre",
                rig.document_from_scenario.scale
            );
            same_places(&what, &rig, &plain, relative);
        }
        let mut document = parse(&path);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        document.json["nodes"][root]["rotation"] = json!([half, 0.0, 0.0, half]);
        let rig = load_document(&document).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((rig.mapping.up.as_str(), rig.mapping.forward.as_str()), ("+Z", "-Y"), "{file} lying along Z");
        same_places(&format!("{file} along Z"), &rig, &plain, 1.0);
        // Joints in centimetres under a root of 0.01, as many exporters write them.
        let mut document = parse(&path);
        centimetre_joints(&mut document, root);
        let rig = load_document(&document).unwrap_or_else(|error| panic!("{error}"));
        same_places(&format!("{file} with joints in centimetres"), &rig, &plain, 1.0);
    }
}

fn same_places(what: &str, rig: &Rig, plain: &Rig, relative: f64) {
    for (a, b) in rig.body.joints.iter().zip(&plain.body.joints) {
        assert_eq!(a.role, b.role, "{what}");
        let off = (a.rest - b.rest * relative).length();
        assert!(off < 0.002, "{what}: {} is {:.1} mm off", a.role.name(), off * 1000.0);
    }
}

#[test]
fn a_second_skin_for_one_body_changes_nothing_and_a_contrary_one_is_told() {
    let Some(data) = data::folder() else { return };
    let path = data.join("rigs/m2m_human_male.glb");
    let plain = load(&path).expect("a rig");
    let mut document = parse(&path);
    let mut second = document.json["skins"][0].clone();
    second["joints"].as_array_mut().expect("joints").truncate(30);
    document.json["skins"].as_array_mut().expect("skins").push(second.clone());
    let rig = load_document(&document).expect("a rig");
    same_places("two skins", &rig, &plain, 1.0);
    assert_eq!(rig.mapping.warnings, plain.mapping.warnings, "they agree");
    let joints = second["joints"].as_array_mut().expect("joints");
    joints.rotate_left(7);
    document.json["skins"][1] = second;
    let rig = load_document(&document).expect("a rig");
    same_places("two skins that differ", &rig, &plain, 1.0);
    assert!(rig.mapping.warnings.iter().any(|warning| warning.contains("two skins")), "{:?}", rig.mapping.warnings);
}

#[test]
fn every_convention_maps_with_and_without_its_toes_hands_and_neck() {
    for (method, names) in conventions() {
        let whole = load_sticks(&names, &[]).unwrap_or_else(|error| panic!("{method}: {error}"));
        assert_eq!(whole.mapping.method, format!("names: {method}"));
        stands_as_scenario_space_says(method, &whole);
        assert_eq!(whole.mapping.bones.len(), names.len(), "{method}: {:?}", whole.mapping.bones.keys());
        for (role, node) in &whole.mapping.bones {
            assert_eq!(
                whole.nodes[*node].name.as_deref(),
                names.get(role).map(String::as_str),
                "{method}: {}",
                role.name()
            );
        }
        for lacking in [
            vec![LeftToes, RightToes],
            vec![LeftHand, RightHand],
            vec![Neck],
            vec![LeftToes, RightToes, LeftFoot, RightFoot],
        ] {
            let rig =
                load_sticks(&names, &lacking).unwrap_or_else(|error| panic!("{method} without {lacking:?}: {error}"));
            assert!(rig.mapping.method.starts_with("names"), "{method} without {lacking:?}: {}", rig.mapping.method);
            assert!(lacking.iter().all(|role| !rig.mapping.bones.contains_key(role)), "{method}: invented {lacking:?}");
            assert!(rig.mapping.confidence <= whole.mapping.confidence, "{method} without {lacking:?}");
        }
    }
}

#[test]
fn plain_words_map_without_neck_shoulders_hands_and_toes() {
    let mut names = conventions().pop().expect("the last one").1;
    let without = [UpperChest, Neck, LeftShoulder, RightShoulder, LeftHand, RightHand, LeftToes, RightToes];
    names.insert(Chest, "chest".into());
    names.retain(|role, _| !without.contains(role));
    let wanted = "hip waist chest head l-arm l-forearm l-thigh l-leg l-foot r-arm r-forearm r-thigh r-leg r-foot";
    let mut given: Vec<&str> = names.values().map(String::as_str).collect();
    let mut words: Vec<&str> = wanted.split(' ').collect();
    given.sort_unstable();
    words.sort_unstable();
    assert_eq!(given, words);
    let rig = load_sticks(&names, &[]).expect("a rig");
    assert_eq!(rig.mapping.method, "names: Plain words");
    for (role, node) in &rig.mapping.bones {
        assert_eq!(rig.nodes[*node].name.as_deref(), names.get(role).map(String::as_str), "{}", role.name());
    }
    assert_eq!(rig.mapping.bones.len(), names.len());
}

#[test]
fn a_missing_arm_is_named_and_an_override_supplies_it() {
    let names = conventions().remove(0).1;
    let mut odd = names.clone();
    odd.insert(LeftLowerArm, "Gizmo".into());
    odd.insert(LeftHand, "Gadget".into());
    let bytes = sticks(&odd, &[RightUpperLeg, RightLowerLeg, RightFoot, RightToes], true);
    let error = load_bytes("hero.glb", &bytes, &nothing, None).expect_err("a leg is missing").to_string();
    for word in ["hero.glb", "rightUpperLeg", "Gizmo", "hero.bones.toml", "[bones]"] {
        assert!(error.contains(word), "{word} is not in: {error}");
    }
    let bytes = sticks(&odd, &[], true);
    let rig =
        load_bytes("hero.glb", &bytes, &nothing, Some("[bones]\nleftLowerArm = \"Gizmo\"\nleftHand = \"Gadget\"\n"));
    let rig = rig.expect("the override names it");
    assert!(rig.mapping.method.ends_with("+ override"), "{}", rig.mapping.method);
    assert_eq!(rig.nodes[rig.mapping.bones[&LeftLowerArm]].name.as_deref(), Some("Gizmo"));
    for (text, word) in [
        ("[bones]\nleftfoot = \"LeftFoot\"", "leftFoot"),
        ("[bones]\nleftFoot = \"Nowhere\"", "Nowhere"),
        ("[bones]\nleftFoot = 900", "900"),
        ("[bone]\nleftFoot = 1", "bone"),
        ("[bones\n", "TOML"),
    ] {
        let error = load_bytes("hero.glb", &bytes, &nothing, Some(text)).expect_err("a wrong override").to_string();
        assert!(error.contains("hero.bones.toml") && error.contains(word), "{text:?}: {error}");
    }
}

#[test]
fn twist_nodes_between_bones_are_passed_over() {
    let names = conventions().remove(0).1;
    for named in [true, false] {
        let mut json: Value = serde_json::from_slice(&sticks(&names, &[], named)).expect("JSON");
        let plain = load_bytes("plain.gltf", json.to_string().as_bytes(), &nothing, None).expect("a rig");
        for role in [LeftLowerArm, RightLowerArm, LeftLowerLeg, RightLowerLeg] {
            split_bone(&mut json, plain.mapping.bones[&role], named);
        }
        let rig = load_bytes("twist.gltf", json.to_string().as_bytes(), &nothing, None).expect("a rig");
        assert_eq!(rig.mapping.bones, plain.mapping.bones, "named: {named}");
    }
}

#[test]
fn names_of_no_convention_still_tell_the_sides() {
    let mut names = conventions().remove(0).1;
    for (role, name) in &mut names {
        let side = if role.name().starts_with("left") {
            "links_L"
        } else if role.mirrored() == *role {
            ""
        } else {
            "rechts_R"
        };
        *name = format!("knochen{}_{side}", *role as usize);
    }
    // Facing -Z and without toes: only the names can tell.
    let mut json: Value = serde_json::from_slice(&sticks(&names, &[LeftToes, RightToes], true)).expect("JSON");
    json["nodes"][0]["rotation"] = json!([0.0, 1.0, 0.0, 0.0]);
    let rig = load_bytes("odd.gltf", json.to_string().as_bytes(), &nothing, None).expect("a rig");
    assert_eq!(rig.mapping.method, "geometry, sides by name");
    assert_eq!(rig.mapping.forward, "-Z");
    let left = rig.nodes[rig.mapping.bones[&LeftLowerArm]].name.clone().unwrap_or_default();
    assert!(left.ends_with("_L"), "{left}");
}

#[test]
fn inspect_says_it_all_as_json_and_as_text() {
    let names = conventions().remove(0).1;
    let rig = load_sticks(&names, &[]).expect("a rig");
    let json = inspect_json(&rig);
    let fields = "height_m mass_kg up forward units_to_metres confidence method bones legs feet warnings";
    for field in fields.split(' ') {
        assert!(json.get(field).is_some(), "{field} is missing: {json}");
    }
    assert_eq!(json["bones"]["leftFoot"], "mixamorig:LeftFoot");
    assert!(inspect_text(&rig).contains("mixamorig:LeftFoot"), "{}", inspect_text(&rig));
}

/// Conventions with the names of a whole body.
fn conventions() -> Vec<(&'static str, BTreeMap<Role, String>)> {
    let order = [
        Hips,
        Spine,
        Chest,
        UpperChest,
        Neck,
        Head,
        LeftShoulder,
        LeftUpperArm,
        LeftLowerArm,
        LeftHand,
        LeftUpperLeg,
        LeftLowerLeg,
        LeftFoot,
        LeftToes,
    ];
    let table = [
        (
            "Mixamo",
            ["Left", "Right"],
            "mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Spine2 mixamorig:Neck mixamorig:Head mixamorig:{}Shoulder mixamorig:{}Arm mixamorig:{}ForeArm mixamorig:{}Hand mixamorig:{}UpLeg mixamorig:{}Leg mixamorig:{}Foot mixamorig:{}ToeBase",
        ),
        (
            "Mixamo",
            ["Left", "Right"],
            "Hips Spine Spine1 Spine2 Neck Head {}Shoulder {}Arm {}ForeArm {}Hand {}UpLeg {}Leg {}Foot {}ToeBase",
        ),
        (
            "Unreal",
            ["l", "r"],
            "pelvis spine_01 spine_02 spine_03 neck_01 head clavicle_{} upperarm_{} lowerarm_{} hand_{} thigh_{} calf_{} foot_{} ball_{}",
        ),
        (
            "Rigify",
            ["L", "R"],
            "spine spine.001 spine.002 spine.003 spine.004 spine.006 shoulder.{} upper_arm.{} forearm.{} hand.{} thigh.{} shin.{} foot.{} toe.{}",
        ),
        (
            "Biped",
            ["L", "R"],
            "Bip001_Pelvis Bip001_Spine Bip001_Spine1 Bip001_Spine2 Bip001_Neck Bip001_Head Bip001_{}_Clavicle Bip001_{}_UpperArm Bip001_{}_Forearm Bip001_{}_Hand Bip001_{}_Thigh Bip001_{}_Calf Bip001_{}_Foot Bip001_{}_Toe0",
        ),
        (
            "Character Creator",
            ["L", "R"],
            "CC_Base_Hip CC_Base_Waist CC_Base_Spine01 CC_Base_Spine02 CC_Base_NeckTwist01 CC_Base_Head CC_Base_{}_Clavicle CC_Base_{}_Upperarm CC_Base_{}_Forearm CC_Base_{}_Hand CC_Base_{}_Thigh CC_Base_{}_Calf CC_Base_{}_Foot CC_Base_{}_ToeBase",
        ),
        (
            "Daz",
            ["l", "r"],
            "hip abdomenLower abdomenUpper chestLower neckLower head {}Collar {}ShldrBend {}ForearmBend {}Hand {}ThighBend {}Shin {}Foot {}Toe",
        ),
        (
            "VRM",
            ["left", "right"],
            "hips spine chest upperChest neck head {}Shoulder {}UpperArm {}LowerArm {}Hand {}UpperLeg {}LowerLeg {}Foot {}Toes",
        ),
        (
            "Biovision",
            ["Left", "Right"],
            "Hips Chest Chest2 Chest3 Neck Head {}Collar {}Shoulder {}Elbow {}Wrist {}Hip {}Knee {}Ankle {}Toe",
        ),
        (
            "SMPL",
            ["left", "right"],
            "pelvis spine1 spine2 spine3 neck head {}_collar {}_shoulder {}_elbow {}_wrist {}_hip {}_knee {}_ankle {}_foot",
        ),
        (
            "CMU",
            ["l", "r"],
            "root lowerback upperback thorax lowerneck head {}clavicle {}humerus {}radius {}wrist {}femur {}tibia {}foot {}toes",
        ),
        (
            "Plain words",
            ["l", "r"],
            "hip waist torso chest neck head {}-shoulder {}-arm {}-forearm {}-hand {}-thigh {}-leg {}-foot {}-toes",
        ),
    ];
    table
        .into_iter()
        .map(|(method, sides, text)| {
            let mut names = BTreeMap::new();
            for (role, name) in order.into_iter().zip(text.split(' ')) {
                names.insert(role, name.replace("{}", sides[0]));
                names.insert(role.mirrored(), name.replace("{}", sides[1]));
            }
            (method, names)
        })
        .collect()
}

/// Where an adult's joint is, m; the right side mirrored.
fn stand(role: Role) -> [f64; 3] {
    let left = if role.name().starts_with("right") { role.mirrored() } else { role };
    let [x, y, z] = match left {
        Hips => [0.0, 0.95, 0.0],
        Spine => [0.0, 1.05, 0.0],
        Chest => [0.0, 1.18, 0.0],
        UpperChest => [0.0, 1.3, 0.0],
        Neck => [0.0, 1.48, 0.0],
        Head => [0.0, 1.57, 0.02],
        LeftShoulder => [0.03, 1.44, 0.0],
        LeftUpperArm => [0.18, 1.43, 0.0],
        LeftLowerArm => [0.46, 1.43, -0.01],
        LeftHand => [0.72, 1.43, 0.0],
        LeftUpperLeg => [0.09, 0.93, 0.0],
        LeftLowerLeg => [0.09, 0.52, 0.01],
        LeftFoot => [0.09, 0.09, -0.03],
        _ => [0.09, 0.02, 0.11],
    };
    if left == role { [x, y, z] } else { [-x, y, z] }
}

/// A .gltf of bare joints. Roles in `without` are left out, what hangs on them with them.
pub fn sticks(names: &BTreeMap<Role, String>, without: &[Role], named: bool) -> Vec<u8> {
    let mut nodes: Vec<Value> = Vec::new();
    let mut index: BTreeMap<Role, usize> = BTreeMap::new();
    for (role, name) in names.iter().filter(|(role, _)| !without.contains(role)) {
        let parent = std::iter::successors(role.parent(), |role| role.parent()).find(|role| index.contains_key(role));
        let (at, from) = (stand(*role), parent.map_or([0.0; 3], stand));
        let mut node = json!({ "translation": [at[0] - from[0], at[1] - from[1], at[2] - from[2]], "children": [] });
        if named {
            node["name"] = json!(name);
        }
        if let Some(parent) = parent {
            let next = nodes.len();
            nodes[index[&parent]]["children"].as_array_mut().expect("children").push(json!(next));
        }
        index.insert(*role, nodes.len());
        nodes.push(node);
    }
    for node in &mut nodes {
        if node["children"] == json!([]) {
            node.as_object_mut().expect("a node").remove("children");
        }
    }
    json!({ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": nodes }).to_string().into_bytes()
}

fn load_sticks(names: &BTreeMap<Role, String>, without: &[Role]) -> Result<Rig, RigError> {
    load_bytes("sticks.gltf", &sticks(names, without, true), &nothing, None)
}

/// Puts a node half-way between that one and its parent.
fn split_bone(json: &mut Value, node: usize, named: bool) {
    let nodes = json["nodes"].as_array_mut().expect("nodes");
    let half: Vec<f64> = nodes[node]["translation"]
        .as_array()
        .expect("xyz")
        .iter()
        .map(|x| x.as_f64().expect("a number") / 2.0)
        .collect();
    nodes[node]["translation"] = json!(half);
    let mut between = json!({ "translation": half, "children": [node] });
    if named {
        between["name"] = json!(format!("twist_{node}"));
    }
    let next = nodes.len();
    for other in nodes.iter_mut() {
        if let Some(children) = other.get_mut("children").and_then(Value::as_array_mut) {
            children.iter_mut().filter(|child| **child == json!(node)).for_each(|child| *child = json!(next));
        }
    }
    nodes.push(between);
}

/// No file lies beside the document.
pub fn nothing(_: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::Error::new(std::io::ErrorKind::NotFound, "nothing is here"))
}

pub fn parse(path: &std::path::Path) -> Document {
    let bytes = std::fs::read(path).expect("a file of the data folder");
    Document::parse(&path.display().to_string(), &bytes, &nothing).unwrap_or_else(|error| panic!("{error}"))
}

/// Takes away all names and extensions.
pub fn strip(document: &mut Document) {
    for node in document.json["nodes"].as_array_mut().expect("nodes") {
        node.as_object_mut().expect("a node").remove("name");
    }
    document.json.as_object_mut().expect("an object").remove("extensions");
}

pub fn load_document(document: &Document) -> Result<Rig, RigError> {
    let mut json = document.json.clone();
    let buffers = document.buffers.clone();
    for (index, buffer) in json["buffers"].as_array_mut().into_iter().flatten().enumerate() {
        buffer["uri"] = json!(format!("{index}.bin"));
    }
    let resolve = |name: &str| {
        let index: usize = name.trim_end_matches(".bin").parse().map_err(std::io::Error::other)?;
        buffers.get(index).cloned().ok_or_else(|| std::io::Error::other("no such buffer"))
    };
    load_bytes("variant.gltf", json.to_string().as_bytes(), &resolve, None)
}

/// Joints times 100 under a root of 0.01, inverse bind matrices to match; what is drawn stays where it was.
fn centimetre_joints(document: &mut Document, root: usize) {
    let joints: Vec<usize> = document.json["skins"][0]["joints"]
        .as_array()
        .expect("joints")
        .iter()
        .map(|joint| joint.as_u64().expect("an index") as usize)
        .collect();
    for (index, node) in document.json["nodes"].as_array_mut().expect("nodes").iter_mut().enumerate() {
        if index == root {
            node["scale"] = json!([0.01, 0.01, 0.01]);
            continue;
        }
        if let Some(translation) = node.get("translation").and_then(Value::as_array).cloned() {
            node["translation"] = translation.iter().map(|x| json!(x.as_f64().expect("a number") * 100.0)).collect();
        }
        // A mesh that hangs rigidly must be as large as before.
        if node.get("mesh").is_some() && node.get("skin").is_none() && !joints.contains(&index) {
            node["scale"] = json!([100.0, 100.0, 100.0]);
        }
    }
    let accessor = document.json["skins"][0]["inverseBindMatrices"].as_u64().expect("matrices") as usize;
    let view = document.json["accessors"][accessor]["bufferView"].as_u64().expect("a view") as usize;
    let offset = |value: &Value| value.get("byteOffset").and_then(Value::as_u64).unwrap_or(0) as usize;
    let start = offset(&document.json["accessors"][accessor]) + offset(&document.json["bufferViews"][view]);
    for number in 0..joints.len() * 16 {
        let bytes = &mut document.buffers[0][start + number * 4..start + number * 4 + 4];
        let value = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        if number % 4 != 3 {
            bytes.copy_from_slice(&(value * 100.0).to_le_bytes());
        }
    }
}
