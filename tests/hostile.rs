//! Broken and malicious files as RIG: an error that names the file, or a rig; never a panic, never a second.

#![expect(clippy::print_stdout, reason = "how many mutants loaded")]

use super::data;
use super::rig_variants::{nothing, sticks};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use surefoot::model::Role;
use surefoot::rig::mannequin::BUILTIN;
use surefoot::rig::{load, load_bytes};

/// Mutants of each file.
const MUTANTS: usize = 400;

#[test]
fn every_file_of_the_hostile_collection_is_refused_by_name_or_loads() {
    let Some(data) = data::folder() else { return };
    let mut folders = vec![data.join("hostile")];
    let (mut files, mut refused) = (0, 0);
    while let Some(folder) = folders.pop() {
        let mut entries: Vec<_> =
            std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let begun = Instant::now();
            let name = path.display().to_string();
            files += 1;
            if let Err(error) = load(&path) {
                refused += 1;
                assert!(error.to_string().starts_with(&name), "{name} is not named: {error}");
            }
            assert!(begun.elapsed() < Duration::from_secs(2), "{name} took {:?}", begun.elapsed());
        }
    }
    assert!(files > 90 && refused > 80, "{refused} of {files} refused");
}

#[test]
fn huge_counts_are_refused_without_being_allocated() {
    let base = || -> Value { serde_json::from_slice(&person()).expect("JSON") };
    let place = |json: &mut Value, accessor: Value| {
        json["buffers"] = json!([{ "byteLength": 16, "uri": "data:;base64,AAAAAAAAAAAAAAAAAAAAAA==" }]);
        json["bufferViews"] = json!([{ "buffer": 0, "byteLength": 16 }]);
        json["accessors"] = json!([accessor]);
        json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
        json["nodes"][0]["mesh"] = json!(0);
    };
    let huge = 4_000_000_000_u64;
    let cases = [
        json!({ "componentType": 5126, "type": "VEC3", "count": huge, "bufferView": 0 }),
        json!({ "componentType": 5126, "type": "VEC3", "count": u64::MAX, "bufferView": 0 }),
        json!({ "componentType": 5126, "type": "VEC3", "count": huge }),
        json!({ "componentType": 5126, "type": "VEC3", "count": 1, "byteOffset": u64::MAX, "bufferView": 0 }),
        json!({ "componentType": 5126, "type": "VEC3", "count": 1, "bufferView": u64::MAX }),
        json!({ "componentType": 5126, "type": "VEC3", "count": 3, "sparse": { "count": huge,
            "indices": { "bufferView": 0, "componentType": 5125 }, "values": { "bufferView": 0 } } }),
    ];
    for accessor in cases {
        let mut json = base();
        place(&mut json, accessor.clone());
        let begun = Instant::now();
        let loaded = load_bytes("huge.gltf", json.to_string().as_bytes(), &nothing, None);
        assert!(begun.elapsed() < Duration::from_secs(2), "{accessor}");
        match loaded {
            Ok(rig) => assert!(rig.mapping.warnings.iter().any(|warning| warning.contains("too large")), "{accessor}"),
            Err(error) => assert!(
                error.to_string().starts_with("huge.gltf: accessors[0]") || error.to_string().contains("meshes[0]"),
                "{error}"
            ),
        }
    }
    let mut json = base();
    json["buffers"] = json!([{ "byteLength": huge, "uri": "data:;base64,AAAA" }]);
    let error = load_bytes("huge.gltf", json.to_string().as_bytes(), &nothing, None).expect_err("no such bytes");
    assert!(error.to_string().contains("buffers[0]"), "{error}");
    let deep = "[".repeat(1_000_000);
    load_bytes("deep.gltf", format!("{{\"asset\":{deep}").as_bytes(), &nothing, None).expect_err("too deep");
}

#[test]
fn one_small_mesh_drawn_by_many_nodes_does_not_fill_the_memory() {
    let mut json: Value = serde_json::from_slice(&person()).expect("JSON");
    json["accessors"] = json!([{ "componentType": 5126, "type": "VEC3", "count": 900_000 }]);
    json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
    let nodes = json["nodes"].as_array_mut().expect("nodes");
    nodes.extend(std::iter::repeat_n(json!({ "mesh": 0 }), 5000));
    let begun = Instant::now();
    let rig = load_bytes("many.gltf", json.to_string().as_bytes(), &nothing, None).expect("the bones are there");
    assert!(rig.mapping.warnings.iter().any(|warning| warning.contains("too large")), "{:?}", rig.mapping.warnings);
    // Half a second on a machine that does nothing else; on a busy one it may wait.
    assert!(begun.elapsed() < Duration::from_secs(8), "{:?}", begun.elapsed());
}

#[test]
fn files_outside_and_on_the_network_are_not_asked_for() {
    for uri in ["http://example.com/a.bin", "/etc/passwd", "file:///etc/passwd", "C:\\a.bin", "%2Fetc%2Fpasswd"] {
        let json = json!({ "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 1, "uri": uri }] });
        let asked = std::cell::Cell::new(false);
        let resolve = |_: &str| {
            asked.set(true);
            Ok(vec![0])
        };
        let error = load_bytes("a.gltf", json.to_string().as_bytes(), &resolve, None).expect_err(uri).to_string();
        assert!(!asked.get() && error.contains("buffers[0].uri"), "{uri}: {error}");
    }
}

#[test]
fn percent_encoded_files_beside_the_document_are_found() {
    let mut json: Value = serde_json::from_slice(&person()).expect("JSON");
    json["buffers"] = json!([{ "byteLength": 4, "uri": "my%20rig/b%C3%A4r.bin" }]);
    let resolve = |path: &str| if path == "my rig/bär.bin" { Ok(vec![1, 2, 3, 4]) } else { nothing(path) };
    let rig = load_bytes("a.gltf", json.to_string().as_bytes(), &resolve, None).expect("a rig");
    assert_eq!(rig.document.buffers, [[1, 2, 3, 4]]);
}

#[test]
fn other_kinds_of_files_say_what_to_do() {
    let cases: [(&str, &[u8], &str); 6] = [
        ("a.fbx", b"Kaydara FBX Binary  \0", "export it again as binary FBX"),
        ("a.bvh", b"HIERARCHY\nROOT Hips", "BVH"),
        ("a.txt", b"hello", "glb"),
        ("a.glb", b"", "empty"),
        ("a.glb", b"glTF", "GLB header"),
        ("a.gltf", b"{}", "asset.version"),
    ];
    for (file, bytes, word) in cases {
        let error = load_bytes(file, bytes, &nothing, None).expect_err(file).to_string();
        assert!(error.starts_with(file) && error.contains(word), "{file}: {error}");
    }
    let required = json!({ "asset": { "version": "2.0" }, "extensionsRequired": ["KHR_draco_mesh_compression"] });
    let error =
        load_bytes("a.gltf", required.to_string().as_bytes(), &nothing, None).expect_err("compressed").to_string();
    assert!(error.contains("KHR_draco_mesh_compression") && error.contains("gltf-transform"), "{error}");
    let mut used: Value = serde_json::from_slice(&person()).expect("JSON");
    used["extensionsUsed"] = json!(["KHR_animation_pointer", "ACME_unheard_of"]);
    load_bytes("a.gltf", used.to_string().as_bytes(), &nothing, None)
        .expect("extensions that are only used do no harm");
}

#[test]
fn thousands_of_mutants_of_made_files_never_break_the_loader() {
    let person = person();
    let files = [
        ("person.gltf", person.clone()),
        ("person.glb", as_glb(&person)),
        ("builtin.glb", BUILTIN.to_vec()),
        ("skinless.glb", without_drawing(BUILTIN)),
    ];
    let mut dice = Dice(0x5eed);
    for (name, bytes) in &files {
        let [loaded, refused] = load_mutants(name, bytes, &mut dice);
        // A tenth of each kind at least, or the mutants test nothing: 58 to 179 of 400 load.
        assert!(loaded > MUTANTS / 10 && refused > MUTANTS / 10, "{name}: {loaded} loaded, {refused} refused");
    }
}

#[test]
fn thousands_of_mutants_of_other_peoples_files_never_break_the_loader() {
    let Some(data) = data::folder() else { return };
    let small = [
        "rigs/m2m_rig_human.glb",
        "rigs/vrm1_debug_robot.vrm",
        "rigs/vrm_tiny_basic_armature.vrm",
        "rigs/vrm_tiny_minimal.vrm",
        "rigs/vrm_tiny_basic_armature_vrm1.vrm",
        "hostile/gltfrs_box_sparse.glb",
    ];
    let mut dice = Dice(0xf11e);
    for name in small {
        load_mutants(name, &std::fs::read(data.join(name)).expect("the folder is whole"), &mut dice);
    }
}

/// Loads mutants of a file: each is refused by name within two seconds, or gives a body that is finite. [loaded, refused].
fn load_mutants(name: &str, bytes: &[u8], dice: &mut Dice) -> [usize; 2] {
    let [mut loaded, mut refused] = [0, 0];
    for round in 0..MUTANTS {
        let mutant = mutate(bytes, round, dice);
        let begun = Instant::now();
        match load_bytes(name, &mutant, &nothing, None) {
            Ok(rig) => {
                loaded += 1;
                let sane = rig.body.height.is_finite() && rig.body.joints.iter().all(|joint| joint.rest.is_finite());
                assert!(sane, "{name}, mutant {round}: a body that is not finite");
            }
            Err(error) => {
                refused += 1;
                assert!(error.to_string().starts_with(name), "{name}, mutant {round}: {error}");
            }
        }
        assert!(begun.elapsed() < Duration::from_secs(2), "{name}, mutant {round}: {:?}", begun.elapsed());
    }
    println!("{name}: {loaded} mutants loaded, {refused} refused");
    [loaded, refused]
}

/// The JSON of a .gltf in a binary container.
fn as_glb(text: &[u8]) -> Vec<u8> {
    with_json(text, &[])
}

/// A GLB whose nodes draw nothing: the humanoid alone.
fn without_drawing(glb: &[u8]) -> Vec<u8> {
    let (mut json, rest) = split(glb);
    for node in json["nodes"].as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
        node.remove("mesh");
        node.remove("skin");
    }
    with_json(json.to_string().as_bytes(), rest)
}

/// The JSON of a GLB and the chunks after it.
fn split(glb: &[u8]) -> (Value, &[u8]) {
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    (serde_json::from_slice(&glb[20..20 + length]).expect("the file is whole"), &glb[20 + length..])
}

/// A GLB of that JSON, with those chunks after it.
fn with_json(text: &[u8], rest: &[u8]) -> Vec<u8> {
    let mut text = text.to_vec();
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((20 + text.len() as u32 + rest.len() as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    glb.extend(rest);
    glb
}

/// A stick person as .gltf.
pub fn person() -> Vec<u8> {
    use Role::*;
    let roles = [
        Hips,
        Spine,
        Chest,
        Neck,
        Head,
        LeftUpperArm,
        LeftLowerArm,
        LeftHand,
        RightUpperArm,
        RightLowerArm,
        RightHand,
        LeftUpperLeg,
        LeftLowerLeg,
        LeftFoot,
        LeftToes,
        RightUpperLeg,
        RightLowerLeg,
        RightFoot,
        RightToes,
    ];
    let names: BTreeMap<Role, String> = roles.into_iter().map(|role| (role, role.name().to_owned())).collect();
    sticks(&names, &[], true)
}

/// Another broken copy: bytes, length, or one value of the JSON.
fn mutate(bytes: &[u8], round: usize, dice: &mut Dice) -> Vec<u8> {
    let mut mutant = bytes.to_vec();
    match round % 4 {
        0 => {
            for _ in 0..=dice.below(8) {
                let at = dice.below(mutant.len());
                mutant[at] ^= 1 << dice.below(8);
            }
        }
        1 => mutant.truncate(dice.below(bytes.len())),
        _ => return mutate_json(bytes, round % 4 == 2, dice),
    }
    mutant
}

/// Changes values of the JSON and puts the file together again.
fn mutate_json(bytes: &[u8], numbers: bool, dice: &mut Dice) -> Vec<u8> {
    let glb = bytes.starts_with(b"glTF");
    let (mut json, rest) = match glb {
        true => split(bytes),
        false => (serde_json::from_slice(bytes).expect("the file is whole"), &[][..]),
    };
    for _ in 0..=dice.below(3) {
        if numbers {
            let count = count_numbers(&json);
            change_number(&mut json, &mut dice.below(count.max(1)), dice);
        } else {
            change_tree(&mut json, dice);
        }
    }
    let text = json.to_string().into_bytes();
    if glb { with_json(&text, rest) } else { text }
}

fn count_numbers(json: &Value) -> usize {
    match json {
        Value::Number(_) => 1,
        Value::Array(list) => list.iter().map(count_numbers).sum(),
        Value::Object(map) => map.values().map(count_numbers).sum(),
        _ => 0,
    }
}

fn change_number(json: &mut Value, left: &mut usize, dice: &mut Dice) -> bool {
    match json {
        Value::Number(_) if *left == 0 => {
            let odd = [
                json!(-1),
                json!(0),
                json!(1),
                json!(5126),
                json!(u64::MAX),
                json!(1e300),
                json!(-1e-300),
                json!(0.5),
                json!(null),
                json!("7"),
                json!(4_294_967_295_u32),
                json!(1e6),
            ];
            *json = odd[dice.below(odd.len())].clone();
            true
        }
        Value::Number(_) => {
            *left -= 1;
            false
        }
        Value::Array(list) => list.iter_mut().any(|value| change_number(value, left, dice)),
        Value::Object(map) => map.values_mut().any(|value| change_number(value, left, dice)),
        _ => false,
    }
}

/// Moves a node, or takes away or doubles an entry of a list.
fn change_tree(json: &mut Value, dice: &mut Dice) {
    let count = json["nodes"].as_array().map_or(0, Vec::len);
    if count > 0 && dice.below(2) == 0 {
        let (parent, child) = (dice.below(count), dice.below(count));
        let kept = dice.below(2) == 0;
        for (index, node) in json["nodes"].as_array_mut().into_iter().flatten().enumerate() {
            if let Some(children) = node.get_mut("children").and_then(Value::as_array_mut) {
                children.retain(|other| kept || *other != json!(child));
                if index == parent {
                    children.push(json!(child));
                }
            }
        }
        return;
    }
    let lists: Vec<String> = json
        .as_object()
        .into_iter()
        .flatten()
        .filter(|(_, value)| value.is_array())
        .map(|(key, _)| key.clone())
        .collect();
    let Some(name) = lists.get(dice.below(lists.len().max(1))) else { return };
    let Some(list) = json[name].as_array_mut().filter(|list| !list.is_empty()) else { return };
    let at = dice.below(list.len());
    match dice.below(3) {
        0 => drop(list.remove(at)),
        1 => list.push(list[at].clone()),
        _ => list[at] = json!({}),
    }
}

/// A seeded generator (xorshift64*).
struct Dice(u64);

impl Dice {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % bound
    }
}
