//! Why `rig/document.rs` does not hand whole files to the `gltf` crate: what it refuses, loses, rounds or panics on, each beside what
//! is read here.

use super::hostile::person;
use super::rig_variants::nothing;
use gltf::Gltf;
use gltf::animation::util::ReadOutputs;
use serde_json::{Value, json};
use std::panic::catch_unwind;
use surefoot::rig::clips::read_tracks;
use surefoot::rig::{Document, load_bytes};

/// A stick person, changed.
fn person_with(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut json: Value = serde_json::from_slice(&person()).expect("JSON");
    change(&mut json);
    json.to_string().into_bytes()
}

/// The same with those bytes and accessors.
fn with_data(bytes: &[u8], accessors: Value, change: impl FnOnce(&mut Value)) -> Vec<u8> {
    person_with(|json| {
        let data: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
        let uri = format!("data:application/octet-stream,{data}");
        json["buffers"] = json!([{ "byteLength": bytes.len(), "uri": uri }]);
        json["bufferViews"] = json!([{ "buffer": 0, "byteLength": bytes.len() }]);
        json["accessors"] = accessors;
        change(json);
    })
}

fn document(bytes: &[u8]) -> Document {
    Document::parse("it.gltf", bytes, &nothing).unwrap_or_else(|error| panic!("{error}"))
}

fn error(bytes: &[u8]) -> String {
    load_bytes("it.gltf", bytes, &nothing, None).expect_err("not readable").to_string()
}

#[test]
fn keys_that_nobody_knows_are_kept_and_the_crate_drops_them() {
    let bytes = person_with(|json| {
        json["nodes"][0]["ACME_mood"] = json!("happy");
        json["extensions"] = json!({ "VRM": { "meta": { "author": "someone" } } });
    });
    let root: gltf::json::Root = serde_json::from_slice(&bytes).expect("the crate reads it");
    let written = serde_json::to_string(&root).expect("JSON");
    assert!(!written.contains("ACME_mood") && !written.contains("someone"), "{written}");
    assert_eq!(document(&bytes).json.to_string().into_bytes(), bytes, "key for key, in their order");
}

#[test]
fn a_required_extension_that_leaves_the_body_alone_is_no_reason_to_refuse_and_is_one_to_the_crate() {
    let bytes = person_with(|json| json["extensionsRequired"] = json!(["VRMC_vrm", "KHR_texture_basisu"]));
    Gltf::from_slice(&bytes).expect_err("an extension that the crate was not built for");
    load_bytes("it.gltf", &bytes, &nothing, None).expect("a rig");
}

#[test]
fn an_index_beyond_the_end_is_an_error_and_the_crate_panics() {
    let bytes = person_with(|json| {
        json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 7 } }] }]);
        json["nodes"][0]["mesh"] = json!(0);
    });
    catch_unwind(|| Gltf::from_slice(&bytes).is_ok()).expect_err("it checks the bounds of POSITION before the index");
    assert_eq!(error(&bytes), "it.gltf: meshes[0].primitives[0]: is 7, but there are 0 accessors");
}

#[test]
fn an_accessor_that_its_bytes_do_not_back_says_so_and_the_crate_panics_or_shows_none() {
    let mesh = |json: &mut Value| {
        json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
        json["nodes"][0]["mesh"] = json!(0);
    };
    let read = |bytes: &[u8]| -> Option<Vec<[f32; 3]>> {
        let gltf = Gltf::from_slice(bytes).expect("the crate takes it");
        let primitive = gltf.meshes().next().expect("a mesh").primitives().next().expect("a primitive");
        let data = [0_u8; 12];
        primitive.reader(|_| Some(&data)).read_positions().map(Iterator::collect)
    };
    let zero = [0.0; 3];
    let accessor = |count: usize| json!([{ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": count, "min": zero, "max": zero }]);
    let beyond = with_data(&[0; 12], accessor(2), mesh);
    assert_eq!(read(&beyond), None, "without a word");
    assert!(error(&beyond).starts_with("it.gltf: accessors[0]: 2 elements of 12 bytes"), "{}", error(&beyond));
    let narrow = with_data(&[0; 12], accessor(1), |json| {
        mesh(json);
        json["bufferViews"][0]["byteStride"] = json!(4);
    });
    catch_unwind(|| read(&narrow)).expect_err("an element is read from a third of itself");
    assert_eq!(error(&narrow), "it.gltf: bufferViews[0].byteStride: is 4, less than an element of 12 bytes");
}

#[test]
fn indices_written_with_a_point_are_read_and_the_crate_refuses_them() {
    let bytes = person_with(|json| {
        for node in json["nodes"].as_array_mut().expect("nodes") {
            for child in node.get_mut("children").and_then(Value::as_array_mut).into_iter().flatten() {
                *child = json!(child.as_f64().expect("an index"));
            }
        }
    });
    assert!(String::from_utf8_lossy(&bytes).contains("[1.0"), "the file says 1.0");
    Gltf::from_slice(&bytes).expect_err("no integers");
    let plain = load_bytes("it.gltf", &person(), &nothing, None).expect("a rig");
    let rig = load_bytes("it.gltf", &bytes, &nothing, None).expect("the same rig");
    assert_eq!(rig.mapping.bones, plain.mapping.bones);
}

#[test]
fn a_clip_or_a_material_that_is_broken_leaves_the_rig_readable() {
    let bytes = person_with(|json| {
        json["animations"] = json!([{ "name": "broken", "channels": 3 }]);
        json["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorFactor": "red" } }]);
        json["nodes"].as_array_mut().expect("nodes").push(json!({ "name": 12 }));
    });
    Gltf::from_slice(&bytes).expect_err("odd entries");
    load_bytes("it.gltf", &bytes, &nothing, None).expect("a rig");
}

/// A clip of one channel, whose rotations are those shorts, and one that an extension animates.
fn turning(shorts: &[i16]) -> Vec<u8> {
    let mut bytes: Vec<u8> = (0..shorts.len() / 4).flat_map(|key| (key as f32).to_le_bytes()).collect();
    let start = bytes.len();
    bytes.extend(shorts.iter().flat_map(|short| short.to_le_bytes()));
    let count = shorts.len() / 4;
    let accessors = json!([
        { "bufferView": 0, "componentType": 5126, "type": "SCALAR", "count": count, "min": [0.0], "max": [count - 1] },
        { "bufferView": 0, "byteOffset": start, "componentType": 5122, "normalized": true, "type": "VEC4", "count": count },
    ]);
    with_data(&bytes, accessors, |json| {
        json["animations"] = json!([{ "samplers": [{ "input": 0, "output": 1 }],
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }] }]);
    })
}

#[test]
fn normalised_shorts_are_divided_by_32767_and_the_crate_multiplies_by_its_reciprocal() {
    let shorts: Vec<i16> = (i16::MIN..i16::MAX).step_by(113).take(512).collect();
    let bytes = turning(&shorts);
    let document = document(&bytes);
    let read = document.read_f32s(1, "the test").expect("numbers").values;
    let wanted: Vec<f32> = shorts.iter().map(|short| (f32::from(*short) / 32767.0).max(-1.0)).collect();
    assert!(read.iter().zip(&wanted).all(|(a, b)| a.to_bits() == b.to_bits()));
    let gltf = Gltf::from_slice(&bytes).expect("the crate reads it");
    let channel = gltf.animations().next().expect("a clip").channels().next().expect("a channel");
    let Some(ReadOutputs::Rotations(turns)) =
        channel.reader(|_| document.buffers.first().map(Vec::as_slice)).read_outputs()
    else {
        panic!("rotations")
    };
    let other = turns.into_f32().flatten().zip(&wanted).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
    assert!(other > 0, "none of 512 differs in the last bit: the crate divides now, and could read these numbers");
}

#[test]
fn a_clip_with_a_channel_of_an_extension_plays_and_the_crate_refuses_the_file() {
    let mut json: Value = serde_json::from_slice(&turning(&[0, 0, 0, 32767, 0, 0, 32767, 0])).expect("JSON");
    let pointer = json!({ "KHR_animation_pointer": { "pointer": "/materials/0/emissiveFactor" } });
    let foreign = json!({ "sampler": 0, "target": { "path": "pointer", "extensions": pointer } });
    json["animations"][0]["channels"].as_array_mut().expect("channels").push(foreign);
    let bytes = json.to_string().into_bytes();
    Gltf::from_slice(&bytes).expect_err("a channel without a node");
    let document = document(&bytes);
    let tracks = read_tracks(&document, document.list("nodes").len(), 0).expect("a clip");
    assert_eq!(tracks.list.len(), 1);
    assert!(tracks.notes[0].starts_with("1 channels animate something other than nodes"), "{:?}", tracks.notes);
}

#[test]
fn places_of_nodes_keep_the_digits_that_the_file_gives_and_the_crate_rounds_them() {
    let bytes = person_with(|json| json["nodes"][0]["translation"] = json!([0.1, 0.95, 1e-9]));
    let gltf = Gltf::from_slice(&bytes).expect("the crate reads it");
    let (rounded, _, _) = gltf.nodes().next().expect("a node").transform().decomposed();
    assert_ne!(f64::from(rounded[0]), 0.1);
    let rig = load_bytes("it.gltf", &bytes, &nothing, None).expect("a rig");
    assert_eq!(rig.nodes[0].local.translation.to_array(), [0.1, 0.95, 1e-9]);
}

#[test]
fn a_chunk_of_another_kind_is_passed_over_and_the_crate_refuses_the_file() {
    let mut json = person();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + 8 + json.len() as u32 + 8 + 4).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend(b"\x04\0\0\0ACMEmore");
    Gltf::from_slice(&glb).expect_err("an unknown chunk");
    load_bytes("it.glb", &glb, &nothing, None).expect("glTF 2.0, 4.4.3: such chunks are ignored");
}
