//! Clips made by hand, broken and malicious ones: glTF's interpolations, override files, mutants, places of faults.

use super::data;
use super::mocap::joint;
use super::rig_variants::{nothing, sticks};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use surefoot::mocap::{ClipFile, Options, load, read};
use surefoot::model::{Capture, Role};

/// A stick figure, and an animation of its left upper leg and hips by hand.
fn kicking(edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let roles = Role::ALL.iter().filter(|role| !role.name().contains("Eye") && **role != Role::Jaw);
    let names: BTreeMap<Role, String> = roles.map(|role| (*role, role.name().to_owned())).collect();
    let mut json: Value = serde_json::from_slice(&sticks(&names, &[], true)).expect("JSON");
    let node = |name: &str| json["nodes"].as_array().expect("nodes").iter().position(|node| node["name"] == name);
    let (leg, hips) = (node("leftUpperLeg").expect("a leg"), node("hips").expect("hips"));
    let sine = (0.5_f32).sin();
    let mut floats: Vec<f32> = vec![0.0, 1.0]; // times
    floats.extend([0.0, 0.0, 0.0, 1.0, -sine, 0.0, 0.0, (0.5_f32).cos()]); // rotation about X
    let hips_at = json["nodes"][hips]["translation"].clone();
    let at = |axis: usize| hips_at[axis].as_f64().expect("a number") as f32;
    let (start, end) = ([at(0), at(1), at(2)], [at(0), at(1), at(2) + 1.0]);
    floats.extend([0.0; 3]); // a spline of the hips: in-tangent, value, out-tangent
    floats.extend(start);
    floats.extend([0.0, 0.0, 4.0]);
    floats.extend([0.0; 3]);
    floats.extend(end);
    floats.extend([0.0; 3]);
    let mut bytes: Vec<u8> = floats.iter().flat_map(|number| number.to_le_bytes()).collect();
    let shorts = bytes.len();
    let quarter = |number: f32| (number * 32767.0).round() as i16;
    bytes.extend(
        [0, 0, 0, 32767, quarter(-sine), 0, 0, quarter((0.5_f32).cos())].iter().flat_map(|n: &i16| n.to_le_bytes()),
    );
    let sparse = bytes.len();
    bytes.extend([1_u8, 0, 0, 0]); // the second element
    bytes.extend(2.0_f32.to_le_bytes());
    let length = bytes.len();
    json["buffers"] = json!([{ "byteLength": length, "uri": "keys.bin" }]);
    json["bufferViews"] = json!([
        { "buffer": 0, "byteOffset": 0, "byteLength": shorts },
        { "buffer": 0, "byteOffset": shorts, "byteLength": 16 },
        { "buffer": 0, "byteOffset": sparse, "byteLength": 4 },
        { "buffer": 0, "byteOffset": sparse + 4, "byteLength": 4 },
    ]);
    json["accessors"] = json!([
        { "bufferView": 0, "byteOffset": 0, "componentType": 5126, "type": "SCALAR", "count": 2 },
        { "bufferView": 0, "byteOffset": 8, "componentType": 5126, "type": "VEC4", "count": 2 },
        { "bufferView": 0, "byteOffset": 40, "componentType": 5126, "type": "VEC3", "count": 6 },
        { "bufferView": 1, "componentType": 5122, "normalized": true, "type": "VEC4", "count": 2 },
        { "bufferView": 0, "componentType": 5126, "type": "SCALAR", "count": 2, "sparse": { "count": 1,
            "indices": { "bufferView": 2, "componentType": 5121 }, "values": { "bufferView": 3 } } },
    ]);
    json["animations"] = json!([{ "name": "kick",
        "channels": [
            { "sampler": 0, "target": { "node": leg, "path": "rotation" } },
            { "sampler": 1, "target": { "node": hips, "path": "translation" } },
        ],
        "samplers": [
            { "input": 0, "output": 1 },
            { "input": 0, "output": 2, "interpolation": "CUBICSPLINE" },
        ] }]);
    edit(&mut json);
    let mut data = json.to_string().into_bytes();
    data.extend([0]); // so that the two are told apart below
    data.extend(bytes);
    data
}

fn kicked(edit: impl FnOnce(&mut Value)) -> Capture {
    let data = kicking(edit);
    let cut = data.iter().position(|byte| *byte == 0).expect("an end of the JSON");
    let keys = data[cut + 1..].to_vec();
    let resolve = |name: &str| if name == "keys.bin" { Ok(keys.clone()) } else { nothing(name) };
    let file = read("kick.gltf", &data[..cut], &resolve, None).unwrap_or_else(|error| panic!("{error}"));
    file.find("kick").and_then(|clip| file.capture(clip, &Options::default())).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn splines_steps_integers_and_sparse_keys_are_read_as_the_specification_says() {
    let capture = kicked(|_| {});
    assert_eq!((capture.fps, capture.frames()), (30.0, 31));
    let hips = |capture: &Capture, frame: usize| capture.at(frame)[0].z - capture.at(0)[0].z;
    // Half way: 1/2, and the tangent of 4 a second over 1 s times 1/8.
    assert!((hips(&capture, 15) - 1.0).abs() < 1e-6, "{}", hips(&capture, 15));
    assert!((hips(&capture, 30) - 1.0).abs() < 1e-6);
    let knee = joint(&capture, Role::LeftLowerLeg);
    let bent = |capture: &Capture, frame: usize| {
        let thigh = joint(capture, Role::LeftUpperLeg);
        capture.turns_at(frame)[thigh].to_scaled_axis().x
    };
    assert!((bent(&capture, 15) + 0.5).abs() < 1e-6 && (bent(&capture, 30) + 1.0).abs() < 1e-6);
    let ahead = |frame: usize| capture.at(frame)[knee].z - capture.at(frame)[0].z;
    assert!(ahead(30) > ahead(0) + 0.2, "the knee comes forward: {}", ahead(30));
    let integers = kicked(|json| json["animations"][0]["samplers"][0]["output"] = json!(3));
    assert!((bent(&integers, 15) + 0.5).abs() < 1e-4, "{}", bent(&integers, 15));
    let step = kicked(|json| json["animations"][0]["samplers"][0]["interpolation"] = json!("STEP"));
    assert!((bent(&step, 29).abs() < 1e-9) && (bent(&step, 30) + 1.0).abs() < 1e-6);
    let sparse = kicked(|json| json["animations"][0]["samplers"][0]["input"] = json!(4));
    assert_eq!(sparse.frames(), 61, "the sparse second key stands at 2 s");
    assert!((bent(&sparse, 30) + 0.5).abs() < 1e-6);
    let pointer = kicked(|json| {
        let channels = json["animations"][0]["channels"].as_array_mut().expect("channels");
        let pointer = json!({ "KHR_animation_pointer": { "pointer": "/materials/0/alphaCutoff" } });
        channels.push(json!({ "sampler": 0, "target": { "path": "pointer", "extensions": pointer } }));
    });
    assert_eq!(pointer.positions, capture.positions);
    assert!(pointer.notes.iter().any(|note| note.contains("KHR_animation_pointer")), "{:?}", pointer.notes);
}

#[test]
fn a_scale_that_a_parent_has_counts_and_metres_stay_metres() {
    let large = kicked(|json| {
        let nodes = json["nodes"].as_array_mut().expect("nodes");
        let count = nodes.len();
        let hips = nodes.iter().position(|node| node["name"] == "hips").expect("hips");
        nodes.push(json!({ "name": "armature", "scale": [0.6, 0.6, 0.6], "children": [hips] }));
        json["scenes"] = json!([{ "nodes": [count] }]);
    });
    let usual = kicked(|_| {});
    assert!((large.body.leg_length / usual.body.leg_length - 0.6).abs() < 1e-6, "a child stays a child");
    assert_eq!(large.units_to_metres, 1.0);
}

#[test]
fn every_file_of_the_hostile_collection_is_refused_by_name_or_read() {
    let Some(data) = data::folder() else { return };
    let mut folders = vec![data.join("hostile")];
    let mut count = 0;
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            count += 1;
            let (begun, name) = (Instant::now(), path.display().to_string());
            let told = match load(&path) {
                Ok(file) => read_all(&file),
                Err(error) => vec![error.to_string()],
            };
            assert!(told.iter().all(|told| told.starts_with(&name)), "{name} is not named: {told:?}");
            assert!(begun.elapsed() < Duration::from_secs(2), "{name} took {:?}", begun.elapsed());
        }
    }
    assert!(count > 90, "{count} files");
}

/// Reads every clip; what was told.
fn read_all(file: &ClipFile) -> Vec<String> {
    let captures = (0..file.clips.len().min(20)).map(|clip| file.capture(clip, &Options::default()));
    captures.filter_map(Result::err).map(|error| error.to_string()).collect()
}

fn mutants(path: &str, cases: u32) {
    let Some(data) = data::folder() else { return };
    let bytes = std::fs::read(data.join(path)).expect("a file of the data");
    let name = path.rsplit('/').next().unwrap_or(path).to_owned();
    let length = bytes.len();
    let change = (0..length, 0..6_u8, any::<u8>(), 0..length);
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let mut runner = proptest::test_runner::TestRunner::new_with_rng(
        config,
        proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha),
    );
    let changes = proptest::collection::vec(change, 1..6);
    let outcome = runner.run(&changes, |changes| {
        let mut mutant = bytes.clone();
        for (at, kind, byte, other) in changes {
            let (at, other) = (at.min(mutant.len() - 1), other.min(mutant.len() - 1));
            match kind {
                0 => mutant[at] = byte,
                1 => mutant[at] ^= 1 << (byte % 8),
                2 => mutant.truncate(at.max(1)),
                3 => mutant.iter_mut().skip(at).take(usize::from(byte % 16)).for_each(|byte| *byte = 0xFF),
                4 => {
                    let part = mutant[other..(other + usize::from(byte)).min(mutant.len())].to_vec();
                    mutant.iter_mut().skip(at).zip(part).for_each(|(byte, other)| *byte = other);
                }
                // What stands in the head does the most harm.
                _ => mutant[at % 4096.min(length)] = byte,
            }
        }
        let begun = Instant::now();
        let told = match read(&name, &mutant, &nothing, None) {
            Ok(file) => read_all(&file),
            Err(error) => vec![error.to_string()],
        };
        prop_assert!(told.iter().all(|told| told.starts_with(&name)), "{:?}", told);
        prop_assert!(begun.elapsed() < Duration::from_secs(2), "took {:?}: {:?}", begun.elapsed(), told);
        Ok(())
    });
    outcome.unwrap_or_else(|error| panic!("{path}: {error}"));
}

#[test]
fn mutants_of_a_bvh_are_refused_or_read() {
    mutants("clips/makehuman_walk1.bvh", 300);
    mutants("clips/pybvh_rotation_first_root.bvh", 300);
}

#[test]
fn mutants_of_an_fbx_are_refused_or_read() {
    mutants("clips/cmu_91_48.fbx", 300);
}

#[test]
fn mutants_of_a_glb_are_refused_or_read() {
    mutants("forces/rajagopal_walk.glb", 300);
    mutants("rigs/threevrm_test.vrma", 300);
}

#[test]
fn what_is_broken_is_told_with_its_place() {
    let Some(data) = data::folder() else { return };
    let told = |name: &str, bytes: &[u8]| match read(name, bytes, &nothing, None) {
        Ok(file) => read_all(&file).join("; "),
        Err(error) => error.to_string(),
    };
    let fbx = std::fs::read(data.join("clips/cmu_91_48.fbx")).expect("a file");
    let cut = told("cut.fbx", &fbx[..fbx.len() / 2]);
    assert!(cut.starts_with("cut.fbx: FBX: ") && cut.len() > 20, "{cut}");
    let bvh = std::fs::read(data.join("clips/cmu_12_01_walk.bvh")).expect("a file");
    let cut = told("cut.bvh", &bvh[..bvh.len() / 2]);
    assert!(cut.starts_with("cut.bvh: line ") && cut.contains("cut off"), "{cut}");
    let glb = std::fs::read(data.join("forces/rajagopal_walk.glb")).expect("a file");
    let cut = told("cut.glb", &glb[..glb.len() / 2]);
    assert!(cut.starts_with("cut.glb: GLB header: says"), "{cut}");
    assert!(told("t.fbx", b"; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n").starts_with("t.fbx: "));
}

#[test]
fn bones_named_beside_the_clip_are_believed() {
    let text =
        "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
    let mut bvh = text.to_owned();
    // Legs and arms of nonsense names; the spine goes up.
    let limb = |letters: [&str; 3], at: [f64; 3], step: [f64; 3]| {
        let [x, y, z] = at;
        let [dx, dy, dz] = step;
        let channels = "CHANNELS 3 Zrotation Xrotation Yrotation";
        let [a, b, c] = letters;
        format!(
            "JOINT {a}\n{{\nOFFSET {x} {y} {z}\n{channels}\nJOINT {b}\n{{\nOFFSET {dx} {dy} {dz}\n{channels}\nJOINT {c}\n{{\n\
             OFFSET {dx} {dy} {dz}\n{channels}\nEnd Site\n{{\nOFFSET 0 {} 10\n}}\n}}\n}}\n}}\n",
            if dy < 0.0 { -7.0 } else { 0.0 }
        )
    };
    bvh += &limb(["q", "w", "e"], [9.0, -3.0, 0.0], [0.0, -41.0, 0.0]);
    bvh += &limb(["r", "t", "y"], [-9.0, -3.0, 0.0], [0.0, -41.0, 0.0]);
    bvh += "JOINT s\n{\nOFFSET 0 10 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n";
    bvh += &limb(["u", "i", "o"], [17.0, 38.0, 0.0], [27.0, 0.0, 0.0]);
    bvh += &limb(["p", "f", "g"], [-17.0, 38.0, 0.0], [-27.0, 0.0, 0.0]);
    bvh +=
        "JOINT h\n{\nOFFSET 0 55 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 18 0\n}\n}\n}\n}\n";
    let width = 6 + 3 * 14;
    let frame = format!("0 92 0{}\n", " 0".repeat(width - 3));
    bvh += &format!("MOTION\nFrames: 4\nFrame Time: 0.0333333\n{}", frame.repeat(4));
    let bones = "[bones]\nhips = 'a'\nspine = 's'\nhead = 'h'\nleftUpperLeg = 'q'\nleftLowerLeg = 'w'\nleftFoot = 'e'\n\
        rightUpperLeg = 'r'\nrightLowerLeg = 't'\nrightFoot = 'y'\nleftUpperArm = 'u'\nleftLowerArm = 'i'\nleftHand = 'o'\n\
        rightUpperArm = 'p'\nrightLowerArm = 'f'\nrightHand = 'g'\n";
    let file = read("odd.bvh", bvh.as_bytes(), &nothing, Some(bones)).unwrap_or_else(|error| panic!("{error}"));
    let capture = file.capture(0, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(capture.method.contains("override"), "{}", capture.method);
    assert_eq!((capture.units_to_metres, capture.fps), (0.01, 30.0));
    let wrong = read("odd.bvh", bvh.as_bytes(), &nothing, Some("[bones]\nhips = 'zz'\n")).expect("parses");
    let told = wrong.capture(0, &Options::default()).expect_err("no such node").to_string();
    assert!(told.starts_with("odd.bones.toml: bones.hips"), "{told}");
}
