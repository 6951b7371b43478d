//! Clips of every kind, as captured and keyed by others: sizes, ways, feet, writing back; broken ones.

use super::rig_variants::{nothing, sticks};
use super::rigs::data;
use glam::{DQuat, DVec3};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use surefoot::mocap::bvh::{Bvh, decode, encode};
use surefoot::mocap::bvh_write::{Edits, write};
use surefoot::mocap::{ClipFile, Options, load, read};
use surefoot::model::{Capture, Role};
use surefoot::rig::load_bytes;

/// Figures whose legs are not a grown person's, in metres: a child-sized robot, chibis, a mascot.
const SHORT: [&str; 3] = ["kaykit_Knight", "sketchbook_boxman", "khronos_CesiumMan"];

fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder of the data").flatten().map(|entry| entry.path());
    let wanted = |path: &PathBuf| path.extension().is_some_and(|tail| extensions.iter().any(|other| tail == *other));
    let mut files: Vec<PathBuf> = entries.filter(wanted).collect();
    files.sort();
    files
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Every clip of the collection that has a whole body.
fn every_clip(data: &Path, mut check: impl FnMut(&str, &str, &Capture)) -> usize {
    let mut count = 0;
    for folder in ["clips", "audit", "forces", "rigs"] {
        for path in files(&data.join(folder), &["bvh", "fbx", "glb", "gltf", "vrm", "vrma"]) {
            let name = stem(&path);
            let file = match load(&path) {
                Ok(file) => file,
                Err(error) => {
                    let told = error.to_string();
                    assert!(told.starts_with(&path.display().to_string()), "{told}");
                    assert!(folder == "rigs" && told.contains("has no animation"), "{told}");
                    continue;
                }
            };
            for clip in 0..file.clips.len() {
                match file.capture(clip, &Options::default()) {
                    Ok(capture) => {
                        count += 1;
                        check(&name, &file.clips[clip], &capture);
                    }
                    Err(error) => {
                        let known = ["pybvh_rotation_first_root", "khronos_Fox"].contains(&name.as_str());
                        assert!(known && error.is_about_bones(), "{error}");
                    }
                }
            }
        }
    }
    count
}

fn joint(capture: &Capture, role: Role) -> usize {
    capture.body.joint(role).unwrap_or_else(|| panic!("{} has no {}", capture.name, role.name()))
}

#[test]
fn every_clip_of_the_collection_gives_a_body_of_a_persons_size_that_stands_on_its_feet() {
    let Some(data) = data() else { return };
    let mut odd = Vec::new();
    let count = every_clip(&data, |file, clip, capture| {
        let place = format!("{file}: {clip}");
        let (leg, height) = (capture.body.leg_length, capture.body.height);
        let short = SHORT.contains(&file);
        assert!((0.55..=1.15).contains(&leg) || (short && (0.2..0.55).contains(&leg)), "{place}: leg {leg}");
        assert!((0.9..2.4).contains(&height), "{place}: {height} m high");
        assert!((15.0..=240.0).contains(&capture.fps), "{place}: {} fps", capture.fps);
        assert_eq!(capture.positions.len(), capture.turns.len());
        assert!(capture.positions.iter().all(|point| point.is_finite()), "{place}");
        assert!(capture.turns.iter().all(|turn| (turn.length() - 1.0).abs() < 1e-6), "{place}");
        // The feet are below the hips in most frames of all that is not a fall, a seat or a dive.
        let lies =
            ["death", "lie", "sit", "roll", "dead", "dash", "air", "swim", "jump", "slide", "crawl", "floor", "dodge"];
        if lies.iter().any(|word| clip.to_lowercase().contains(word)) {
            return;
        }
        let (hips, feet) = (joint(capture, Role::Hips), capture.body.feet.each_ref().map(|foot| foot.ankle));
        let below = |frame: &usize| {
            let at = capture.at(*frame);
            feet.iter().all(|foot| at[hips].y - at[*foot].y > 0.3 * leg)
        };
        let share = (0..capture.frames()).filter(below).count() as f64 / capture.frames() as f64;
        if share < 0.6 {
            odd.push(format!("{place}: both feet below the hips in {share:.2} of the frames"));
        }
    });
    assert!(odd.is_empty(), "{odd:#?}");
    assert!(count > 150, "{count} clips");
}

#[test]
fn units_and_axes_of_real_files_are_found() {
    let Some(data) = data() else { return };
    let cases = [
        ("clips/cmu_12_01_walk.bvh", 0.056444, "+Y", 120.0),
        ("clips/cmu_01_01_hops.bvh", 0.056444, "+Y", 120.0),
        ("clips/cmu_02_01_walk.bvh", 0.01, "+Y", 120.0),
        ("clips/cmu_jumping_jacks_30hz.bvh", 0.056444, "+Y", 30.0),
        ("clips/fair1_jumping.bvh", 1.0 / 25.4, "+Z", 119.88),
        ("clips/makehuman_walk1.bvh", 0.1, "+Z", 24.0),
        ("clips/pab_walk.fbx", 0.01, "+Y", 30.0),
        ("audit/walk_normal_001.bvh", 0.01, "+Y", 30.0),
        ("forces/rajagopal_walk.glb", 1.0, "+Y", 100.0),
    ];
    for (file, unit, up, fps) in cases {
        let capture = first(&data.join(file), &Options::default());
        assert!((capture.units_to_metres / unit - 1.0).abs() < 1e-3, "{file}: {}", capture.units_to_metres);
        assert_eq!(capture.up, up, "{file}");
        assert!((capture.fps - fps).abs() < 0.01, "{file}: {}", capture.fps);
    }
    // And a person's word goes over what is found.
    let options = Options { fps: Some(60.0), unit: Some(0.02), up: Some(DVec3::Z) };
    let capture = first(&data.join("audit/walk_normal_001.bvh"), &options);
    assert_eq!((capture.fps, capture.up.as_str()), (60.0, "+Z"));
    assert!((capture.units_to_metres - 0.02).abs() < 1e-12 && (capture.body.leg_length - 1.6).abs() < 0.05);
}

fn first(path: &Path, options: &Options) -> Capture {
    load(path).and_then(|file| file.capture(0, options)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn who_walks_goes_where_the_pelvis_faces() {
    let Some(data) = data() else { return };
    let mut walks: Vec<PathBuf> = files(&data.join("audit"), &["bvh"]);
    walks.retain(|path| stem(path).starts_with("walk") || stem(path).starts_with("run"));
    for file in
        ["cmu_02_01_walk.bvh", "cmu_12_01_walk.bvh", "cmu_02_03_run.bvh", "pab_walk.fbx", "pab_run.fbx", "pab_jog.fbx"]
    {
        walks.push(data.join("clips").join(file));
    }
    walks.push(data.join("forces/rajagopal_walk.glb"));
    for path in &walks {
        let capture = first(path, &Options::default());
        let step = (0.1 * capture.fps).max(1.0) as usize;
        let (mut along, mut whole) = (0.0, 0.0);
        for frame in step..capture.frames() {
            let moved = capture.at(frame)[0] - capture.at(frame - step)[0];
            let moved = DVec3::new(moved.x, 0.0, moved.z);
            let facing = capture.turns_at(frame)[0] * DVec3::Z;
            along += moved.dot(DVec3::new(facing.x, 0.0, facing.z).normalize_or_zero());
            whole += moved.length();
        }
        let seconds = capture.frames() as f64 / capture.fps;
        assert!(whole / step as f64 / seconds > 0.3, "{}: walks {whole} m", path.display());
        assert!(along / whole > 0.85, "{}: {:.2} of its way is forward", path.display(), along / whole);
    }
}

#[test]
fn feet_of_walks_come_down_to_one_floor() {
    let Some(data) = data() else { return };
    let mut worst: f64 = 0.0;
    for path in files(&data.join("audit"), &["bvh"]).iter().filter(|path| stem(path).starts_with("walk_")) {
        let capture = first(path, &Options::default());
        let lowest: Vec<f64> = capture
            .body
            .feet
            .iter()
            .map(|foot| {
                let lowest = |frame: usize| {
                    let points = foot.rear_sole.iter().map(|point| capture.rigid_point(frame, foot.ankle, *point).y);
                    points.fold(f64::MAX, f64::min)
                };
                let mut heights: Vec<f64> = (0..capture.frames()).map(lowest).collect();
                heights.sort_by(f64::total_cmp);
                heights[heights.len() / 20]
            })
            .collect();
        worst = worst.max((lowest[0] - lowest[1]).abs());
        assert!((lowest[0] - lowest[1]).abs() < 0.03, "{}: left and right sole at {lowest:.3?} m", path.display());
    }
    eprintln!("soles of both feet within {:.1} mm", worst * 1000.0);
}

#[test]
fn a_bvh_without_edits_is_written_as_it_was_and_with_edits_says_what_was_asked() {
    let Some(data) = data() else { return };
    for path in
        files(&data.join("clips"), &["bvh"]).into_iter().chain(files(&data.join("audit"), &["bvh"]).into_iter().take(4))
    {
        let bytes = std::fs::read(&path).expect("a file");
        let text = decode(&bytes);
        let bvh = Bvh::parse("b.bvh", &text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(encode(&write(&text, &bvh, &Edits::new()), &bytes), bytes, "{}", path.display());
        let mut edits = Edits::new();
        let frames = bvh.frames() / 3..bvh.frames() / 3 + 12.min(bvh.frames() / 3);
        for frame in frames.clone() {
            for joint in 0..bvh.joints.len() {
                let mut local = bvh.local(frame, joint);
                if bvh.joints[joint].channels.len() >= 3 {
                    local.rotation *= DQuat::from_scaled_axis(DVec3::new(0.05, -0.1, 0.02));
                    edits.insert((frame, joint), local);
                }
            }
        }
        let again = write(&text, &bvh, &edits);
        let after = Bvh::parse("b.bvh", &again).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for ((frame, joint), wanted) in &edits {
            let off = after.local(*frame, *joint).rotation.angle_between(wanted.rotation);
            assert!(off < 1e-3, "{}: frame {frame}, {}: {off} rad off", path.display(), bvh.joints[*joint].name);
        }
        for (index, (before, after)) in bvh.values.iter().zip(&after.values).enumerate() {
            let frame = index / bvh.width;
            assert!(frames.contains(&frame) || before == after, "{}: frame {frame} was not touched", path.display());
            assert!((before - after).abs() < 150.0, "{}: frame {frame}: {before} became {after}", path.display());
        }
    }
}

#[test]
fn an_fbx_as_a_glb_moves_as_it_did() {
    let Some(data) = data() else { return };
    for path in files(&data.join("clips"), &["fbx"]) {
        let file = load(&path).unwrap_or_else(|error| panic!("{error}"));
        let options = Options::default();
        let glb = file.fbx_to_glb(&options).expect("an FBX").unwrap_or_else(|error| panic!("{error}"));
        load_bytes("fbx.glb", &glb, &nothing, None).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let other = read("fbx.glb", &glb, &nothing, None).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(other.clips, file.clips);
        let one = file.capture(0, &options).expect("a capture");
        let two = other.capture(0, &Options { fps: Some(one.fps), ..options }).expect("a capture");
        assert_eq!((one.frames(), one.body.joints.len()), (two.frames(), two.body.joints.len()), "{}", path.display());
        let far = one.positions.iter().zip(&two.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(far < 1e-4, "{}: {far} m apart", path.display());
        assert!((one.body.feet[0].ankle_height - two.body.feet[0].ankle_height).abs() < 0.002, "{}", path.display());
    }
}

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
    let Some(data) = data() else { return };
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
    let Some(data) = data() else { return };
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
    let Some(data) = data() else { return };
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
