//! VRM animations beside the characters that wear them, ready for tests/tools/vrma_check.mjs: target/vrma/*.play.json.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::data;
use crate::vrma::{Played, clip, made, made_path, rigs};
use glam::{DQuat, DVec3};
use serde_json::{Value, json};
use surefoot::bake::{BakeOptions, RootMotion, bake};
use surefoot::export::{t_pose, vrma};
use surefoot::model::report::Part;
use surefoot::model::{BodyPose, Clip, Role, Scenario, Side};
use surefoot::rig::{Rig, load_bytes};

/// The rig's document as a VRM 1.0 whose rest pose is the T-pose that its animation tells of.
fn as_vrm(rig: &Rig, file: &Played) -> Vec<u8> {
    let rest: Vec<DVec3> = rig.body.joints.iter().map(|joint| joint.rest).collect();
    let hips = file.place_at_rest(file.bones["hips"]);
    let locals = rig.node_locals(&BodyPose { hips, turns: t_pose(rig, &rest) });
    let mut json = rig.document.json.clone();
    for (node, local) in locals.iter().enumerate() {
        let fields = json["nodes"][node].as_object_mut().expect("a node");
        fields.shift_remove("matrix");
        fields.insert("translation".into(), json!(local.translation.to_array()));
        fields.insert("rotation".into(), json!(local.rotation.to_array()));
        fields.insert("scale".into(), json!(local.scale.to_array()));
    }
    let bones: serde_json::Map<String, Value> = rig
        .body
        .joints
        .iter()
        .zip(&rig.joint_nodes)
        .filter_map(|(joint, node)| Some((joint.role.name().to_owned(), json!({ "node": (*node)? }))))
        .collect();
    let meta = json!({ "name": "test", "version": "1", "authors": ["surefoot's tests"], "licenseUrl": "https://vrm.dev/licenses/1.0/" });
    json["extensionsUsed"] = json!(["VRMC_vrm"]);
    json["extensions"] =
        json!({ "VRMC_vrm": { "specVersion": "1.0", "meta": meta, "humanoid": { "humanBones": bones } } });
    json.as_object_mut().expect("an object").shift_remove("animations");
    let mut text = serde_json::to_vec(&json).expect("JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bin = rig.document.buffers[0].clone();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend(((28 + text.len() + bin.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bin)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// A VRM beside its animation, and where the tool has the VRM's nodes: document space, for tests/tools/vrma_check.mjs.
fn dump(name: &str, rig: &Rig, clip: &Clip, vrm: &[u8], animation: &[u8]) {
    let mut sampler = rig.sampler(clip);
    let similarity = &rig.document_from_scenario;
    let samples: Vec<Value> = [0.0, 0.0775, 0.1875, 0.3085, 0.5, 0.775, 1.0]
        .iter()
        .map(|share| {
            let time = share * clip.duration;
            let globals = sampler.node_globals(time).to_vec();
            let nodes = rig.joint_nodes.iter().zip(&rig.body.joints).filter(|(_, joint)| joint.animated);
            let nodes: Vec<Value> = nodes
                .filter_map(|(node, joint)| {
                    let node = (*node).filter(|_| !matches!(joint.role, Role::LeftEye | Role::RightEye | Role::Jaw))?;
                    let place = similarity.point(globals[node].translation).to_array();
                    let turn = similarity.rotation * globals[node].to_scale_rotation_translation().1;
                    Some(json!([node, place, turn.normalize().to_array()]))
                })
                .collect();
            json!({ "time": time, "nodes": nodes })
        })
        .collect();
    std::fs::write(made_path(&format!("{name}.vrm")), vrm).expect("can be written");
    std::fs::write(made_path(&format!("{name}.vrma")), animation).expect("can be written");
    let dump = json!({ "vrm": format!("{name}.vrm"), "file": format!("{name}.vrma"), "unit": similarity.scale, "samples": samples });
    std::fs::write(made_path(&format!("{name}.play.json")), dump.to_string()).expect("can be written");
}

/// m: how high the hips stand over the document's own origin.
fn hips_height(rig: &Rig) -> f64 {
    let none = Clip { name: String::new(), fps: 30.0, duration: 0.0, channels: Vec::new() };
    let place = rig.sampler(&none).node_globals(0.0)[rig.hips_node()].translation;
    rig.document_from_scenario.point(place).y / rig.document_from_scenario.scale
}

#[test]
fn it_is_ready_to_be_played_on_its_own_character() {
    let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    for (name, rig) in rigs() {
        if name.starts_with("synthetic") {
            continue;
        }
        let clip = clip(&rig, RootMotion::Root);
        let made = made(&rig, &clip);
        let similarity = &rig.document_from_scenario;
        if rig.mapping.method.starts_with("vrm") {
            if hips_height(&rig) < 0.1 {
                // three-vrm divides by it.
                println!("{name} has its hips on its origin: no player can scale a way by their height");
                continue;
            }
            let vrm = std::fs::read(data::place().join("rigs").join(&name)).expect("it was loaded");
            dump(&format!("play_{name}"), &rig, &clip, &vrm, &made.bytes);
        } else if similarity.scale == 1.0 && similarity.translation.length() < 1e-3 && rig.document.glb_buffer {
            let upright = similarity.rotation.angle_between(DQuat::IDENTITY) < 1e-6;
            assert!(upright || name != "builtin");
            let vrm = as_vrm(&rig, &Played::read(&made.bytes));
            dump(&format!("play_{name}_as_vrm1"), &rig, &clip, &vrm, &made.bytes);
            if upright {
                // The VRM's own animation, made from the VRM, is the same: the T-pose does not depend on how it was found.
                let again = load_bytes("as.vrm", &vrm, &none, None).unwrap_or_else(|error| panic!("{name}: {error}"));
                assert!(again.mapping.method.starts_with("vrm1"), "{}", again.mapping.method);
            }
        }
    }
}

#[test]
fn the_demo_as_a_vrm_animation_keeps_its_feet() {
    let rig = crate::common::builtin();
    let baked = bake(&rig, &Scenario::demo(), &BakeOptions::default()).expect("the demo bakes");
    let made = vrma(&rig, &baked.clip, &baked.report).expect("can be written");
    let file = Played::read(&made.bytes);
    let as_vrm = as_vrm(&rig, &file);
    dump("play_demo", &rig, &baked.clip, &as_vrm, &made.bytes);
    let mut slip: f64 = 0.0;
    for contact in made.report.contacts.iter().filter(|contact| contact.part == Part::Flat) {
        let foot = if contact.foot == Side::Left { Role::LeftFoot } else { Role::RightFoot };
        let bone = file.bone(foot).expect("a foot");
        let start = file.at(bone, contact.start).1;
        for tick in 0..=60 {
            let time = contact.start + (contact.end - contact.start) * f64::from(tick) / 60.0;
            slip = slip.max(file.at(bone, time).1.distance(start));
        }
    }
    println!("the demo's ankles slip by {:.3} mm, {} bytes", slip * 1e3, made.bytes.len());
    assert!(slip < 1e-3, "{slip}");
    assert!(made.losses.is_empty());
}
