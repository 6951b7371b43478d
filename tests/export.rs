//! From poses to the bytes of a GLB and back: what an independent reader finds is what was posed, and nothing is lost.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::synthetic::{self, DURATION, contacts, held, stepping, troubles};
use glam::DVec3;
use serde_json::Value;
use std::path::PathBuf;
use surefoot::bake::keys::{Curves, KeyInput, keyed_clip};
use surefoot::bake::root_motion::{RootMotion, root_bone};
use surefoot::export::{ExportError, glb};
use surefoot::model::report::*;
use surefoot::model::{BodyPose, Clip, ClipReport, KeyValues, Role, Target};
use surefoot::rig::Rig;

pub const MODES: [RootMotion; 3] = [RootMotion::Root, RootMotion::Hips, RootMotion::InPlace];

fn clip(rig: &Rig, root_motion: RootMotion) -> Clip {
    keyed(rig, root_motion, Curves::Linear)
}

fn keyed(rig: &Rig, root_motion: RootMotion, curves: Curves) -> Clip {
    let pose = |time: f64| stepping(&rig.body, time);
    keyed_clip(&KeyInput {
        rig,
        name: "shove",
        fps: 30.0,
        duration: DURATION,
        pose: &pose,
        contacts: &contacts(),
        root_motion,
        curves,
    })
}

pub fn report(clip: &Clip) -> ClipReport {
    ClipReport {
        version: 1,
        generator: "surefoot tests".into(),
        fps: clip.fps,
        duration: clip.duration,
        seed: 1,
        root_motion: "root".into(),
        drive: "stepper".into(),
        scenario: "shove".into(),
        outcome: Outcome::Step,
        steps: 2,
        body: BodyReport { mass: 70.0, height: 1.7 },
        contacts: Vec::new(),
        scuffs: Vec::new(),
        events: vec![Event { time: 1.0 / 3.0, name: "push_start".into(), foot: None, bone: None, impulse: None }],
        disturbances: Vec::new(),
        assist: Assist::default(),
        torques: Vec::new(),
        base: None,
        looped: None,
        drift: None,
        search: None,
        plausibility: Plausibility::default(),
    }
}

/// Where baked files go, so that the scripts of tests/tools can look at them.
pub fn baked_path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/baked");
    std::fs::create_dir_all(&folder).expect("target can be written");
    folder.join(name)
}

pub fn json_of(file: &[u8]) -> (Value, &[u8]) {
    let length = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().expect("four bytes")) as usize;
    let json = length(12);
    let bin = if file.len() > 20 + json { &file[28 + json..28 + json + length(20 + json)] } else { &[] };
    (serde_json::from_slice(&file[20..20 + json]).expect("JSON chunk"), bin)
}

#[test]
fn a_clip_reads_back_as_the_poses_it_was_made_from() {
    for (name, trouble) in troubles() {
        let rig = synthetic::rig(trouble);
        for mode in [RootMotion::Root, RootMotion::Hips] {
            let clip = clip(&rig, mode);
            let mut sampler = rig.sampler(&clip);
            for tick in 0..=360 {
                let time = f64::from(tick) / 90.0;
                let (wanted, got) = (stepping(&rig.body, time), sampler.sample(time));
                for (joint, (wanted, got)) in wanted.positions(&rig.body).iter().zip(&got.positions).enumerate() {
                    let off = wanted.distance(*got);
                    assert!(off < 6e-3, "{name} {mode:?} {time} {:?}: {off} m", rig.body.joints[joint].role);
                }
                for (joint, (wanted, got)) in wanted.turns.iter().zip(&got.turns).enumerate() {
                    let off = wanted.angle_between(*got).to_degrees();
                    assert!(off < 2.0, "{name} {mode:?} {time} {:?}: {off} degrees", rig.body.joints[joint].role);
                }
            }
        }
    }
}

#[test]
fn planted_feet_stay_between_keys_and_few_keys_are_left() {
    for (name, trouble) in troubles() {
        let rig = synthetic::rig(trouble);
        let clip = clip(&rig, RootMotion::Root);
        let mut sampler = rig.sampler(&clip);
        let mut worst: f64 = 0.0;
        for contact in contacts() {
            let start = held(&rig, &sampler.sample(contact.start), &contact);
            for tick in 0..=480 {
                let time = contact.start + (contact.end - contact.start) * f64::from(tick) / 480.0;
                let now = held(&rig, &sampler.sample(time), &contact);
                worst = start.iter().zip(&now).map(|(a, b)| a.distance(*b)).fold(worst, f64::max);
            }
        }
        let keys: usize = clip.channels.iter().map(|channel| channel.times.len()).sum();
        let frames = (DURATION * clip.fps) as usize + 1;
        let share = keys as f64 / (frames * clip.channels.len()) as f64;
        println!("{name}: slip {:.3} mm, {keys} keys, {:.1} % of frames x channels", worst * 1e3, share * 100.0);
        assert!(worst < 0.5e-3, "{name}: {worst}");
        // A clip that steps all the time; straight lines take more keys than splines and fewer bytes.
        let curves = keyed(&rig, RootMotion::Root, Curves::Spline);
        let keys: usize = curves.channels.iter().map(|channel| channel.times.len()).sum();
        let share = keys as f64 / (frames * curves.channels.len()) as f64;
        assert!(share < 0.3, "{name}: {share}");
    }
}

#[test]
fn the_plain_grid_would_slip_so_the_bisection_is_needed() {
    // The planted extreme of the test above: the same motion without contacts to guard.
    let rig = synthetic::rig(synthetic::PLAIN);
    let pose = |time: f64| stepping(&rig.body, time);
    let loose = keyed_clip(&KeyInput {
        rig: &rig,
        name: "loose",
        fps: 30.0,
        duration: DURATION,
        pose: &pose,
        contacts: &[],
        root_motion: RootMotion::Root,
        curves: Curves::Spline,
    });
    let mut sampler = rig.sampler(&loose);
    let mut worst: f64 = 0.0;
    for contact in contacts() {
        let start = held(&rig, &sampler.sample(contact.start), &contact);
        for tick in 0..=480 {
            let time = contact.start + (contact.end - contact.start) * f64::from(tick) / 480.0;
            let now = held(&rig, &sampler.sample(time), &contact);
            worst = start.iter().zip(&now).map(|(a, b)| a.distance(*b)).fold(worst, f64::max);
        }
    }
    assert!(worst > 0.8e-3, "{worst}");
}

#[test]
fn keys_are_what_readers_demand() {
    for (name, trouble) in troubles() {
        let rig = synthetic::rig(trouble);
        for mode in MODES {
            let clip = clip(&rig, mode);
            let last = clip.duration as f32;
            assert!(clip.channels.iter().any(|channel| channel.times.last() == Some(&last)), "{name}");
            for channel in &clip.channels {
                assert_eq!(channel.times[0], 0.0);
                assert!(
                    channel.times.windows(2).all(|pair| pair[0] < pair[1] && pair[1] <= last),
                    "{name} {:?}",
                    channel.target
                );
                let KeyValues::Rotation(keys) = &channel.values else { continue };
                let stride = channel.interpolation.stride();
                let values: Vec<[f32; 4]> = keys.chunks_exact(stride).map(|key| key[stride / 2]).collect();
                for pair in values.windows(2) {
                    let dot: f32 = pair[0].iter().zip(&pair[1]).map(|(a, b)| a * b).sum();
                    assert!(dot > 0.0, "{name} {:?}: neighbours on different hemispheres", channel.target);
                }
            }
        }
    }
}

#[test]
fn root_motion_modes_put_the_travel_where_they_say() {
    for (name, trouble) in troubles() {
        let rig = synthetic::rig(trouble);
        assert_eq!(root_bone(&rig).is_some(), trouble.root_bone, "{name}");
        let carrier = root_bone(&rig).map_or(Target::NewRoot, Target::Node);
        let travel = |mode: RootMotion| {
            let clip = clip(&rig, mode);
            let moves = clip.channels.iter().any(|channel| channel.target == carrier && channel.times.len() > 1);
            let (start, end) = (rig.sample(&clip, 0.0), rig.sample(&clip, DURATION));
            (moves, end.hips - start.hips)
        };
        let (moves, way) = travel(RootMotion::Root);
        assert!(moves && (way.z - 0.28).abs() < 1e-3, "{name}: {way}");
        let (moves, way) = travel(RootMotion::Hips);
        assert!(!moves && (way.z - 0.28).abs() < 1e-3, "{name}: {way}");
        let (moves, way) = travel(RootMotion::InPlace);
        assert!(!moves && way.z.abs() < 1e-3 && way.y < -0.05, "{name}: {way}");
    }
}

#[test]
fn contacts_are_plain_step_animation_too() {
    let rig = synthetic::rig(synthetic::PLAIN);
    let clip = clip(&rig, RootMotion::Root);
    let left = clip.channels.iter().find(|channel| channel.target == Target::ContactLeft).expect("is there");
    // Flat and ball are one contact; then the swing; then heel and flat.
    assert_eq!(left.times, [0.0, 0.8017, 1.2, 4.0]);
    assert_eq!(left.values, KeyValues::Translation(vec![[1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]));
}

#[test]
fn unreal_ik_bones_follow_and_twist_bones_inherit() {
    let rig = synthetic::rig(synthetic::troubles()[3].1);
    let clip = clip(&rig, RootMotion::Root);
    let find = |name: &str| rig.nodes.iter().position(|node| node.name.as_deref() == Some(name)).expect("is there");
    let mut sampler = rig.sampler(&clip);
    for time in [0.0, 0.75, 1.0, 1.3, 4.0] {
        let globals = sampler.node_globals(time);
        let off = globals[find("ik_foot_l")].translation.distance(globals[find("foot_l")].translation);
        assert!(off < 1.5e-3, "{time}: {off}");
    }
    assert!(clip.channels.iter().all(|channel| channel.target != Target::Node(find("thigh_twist_l"))));
}

#[test]
fn everything_of_the_source_is_still_there() {
    for (name, trouble) in troubles() {
        let rig = synthetic::rig(trouble);
        for mode in MODES {
            let clip = clip(&rig, mode);
            let made = glb(&rig, &[(clip.clone(), report(&clip))]).expect("can be written");
            std::fs::write(baked_path(&format!("synthetic_{name}_{}.glb", mode.name())), &made.bytes)
                .expect("can be written");
            dump_pose(&rig, &clip, &made.names[0], &format!("synthetic_{name}_{}.glb", mode.name()));
            keeps_everything(&rig, &made.bytes, &made.changes);
            assert_eq!(made.names, ["shove_2"], "the rig has a shove already");
            assert_eq!(!made.changes.is_empty(), trouble.matrix, "{:?}", made.changes);
            reads_back(&rig, &clip, &made.bytes);
        }
    }
}

/// Every JSON value of the source at its index in the file, its bytes a prefix of the buffer.
pub fn keeps_everything(rig: &Rig, file: &[u8], changes: &[String]) {
    let (json, bin) = json_of(file);
    assert!(bin.starts_with(rig.document.buffers.first().map_or(&[][..], Vec::as_slice)));
    let source = rig.document.json.as_object().expect("object");
    for (key, value) in source {
        let now = &json[key];
        match (key.as_str(), value) {
            ("buffers" | "scenes" | "bufferViews" | "images", _) => {}
            ("nodes", Value::Array(nodes)) => {
                for (index, (before, after)) in nodes.iter().zip(now.as_array().expect("array")).enumerate() {
                    for (field, before) in before.as_object().expect("object") {
                        match (field.as_str(), before) {
                            ("children", Value::Array(before)) => {
                                assert!(after[field].as_array().expect("array").starts_with(before), "node {index}");
                            }
                            ("matrix", _)
                                if changes.iter().any(|change| change.starts_with(&format!("node {index} "))) => {}
                            _ => assert_eq!(&after[field], before, "node {index} {field}"),
                        }
                    }
                }
            }
            (_, Value::Array(items)) => assert!(now.as_array().expect("array").starts_with(items), "{key}"),
            _ => assert_eq!(now, value, "{key}"),
        }
    }
    let views = source.get("bufferViews").and_then(Value::as_array).map_or(0, Vec::len);
    for index in 0..views {
        // The bytes behind each view are what they were.
        let range = |json: &Value, buffers: &[&[u8]]| {
            let view = &json["bufferViews"][index];
            let number = |field: &str| view[field].as_u64().unwrap_or(0) as usize;
            buffers[number("buffer")][number("byteOffset")..number("byteOffset") + number("byteLength")].to_vec()
        };
        let before: Vec<&[u8]> = rig.document.buffers.iter().map(Vec::as_slice).collect();
        assert_eq!(range(&rig.document.json, &before), range(&json, &[bin]), "bufferViews[{index}]");
    }
}

/// The gltf crate finds the clip's keys, key for key, and the report.
pub fn reads_back(rig: &Rig, clip: &Clip, file: &[u8]) {
    let gltf = gltf::Gltf::from_slice(file).expect("the gltf crate reads it");
    let blob = gltf.blob.as_deref().expect("has a BIN chunk");
    let animation = gltf.animations().last().expect("has the clip");
    let read: Vec<_> = animation.channels().collect();
    assert!(read.len() >= clip.channels.len(), "beyond these it holds what other animations of the file move");
    let source_nodes = rig.nodes.len();
    for (channel, read) in clip.channels.iter().zip(&read) {
        match channel.target {
            Target::Node(node) => assert_eq!(read.target().node().index(), node),
            Target::NewRoot => assert_eq!(read.target().node().name(), Some("Root")),
            Target::ContactLeft => assert_eq!(read.target().node().name(), Some("contact_L")),
            Target::ContactRight => assert_eq!(read.target().node().name(), Some("contact_R")),
        }
        assert!(matches!(channel.target, Target::Node(_)) || read.target().node().index() >= source_nodes);
        let reader = read.reader(|_| Some(blob));
        // What never changes has its value twice.
        let twice = usize::from(channel.times.len() == 1 && clip.duration > 0.0) + 1;
        let times: Vec<f32> = reader.read_inputs().expect("times").collect();
        assert_eq!(times[..channel.times.len()], channel.times);
        assert_eq!(times.len(), channel.times.len() * twice);
        assert!(twice == 1 || times[1] == clip.duration as f32);
        match (reader.read_outputs().expect("values"), &channel.values) {
            (gltf::animation::util::ReadOutputs::Translations(read), KeyValues::Translation(keys)) => {
                assert_eq!(read.collect::<Vec<_>>(), keys.repeat(twice));
            }
            (gltf::animation::util::ReadOutputs::Rotations(read), KeyValues::Rotation(keys)) => {
                assert!(matches!(read, gltf::animation::util::Rotations::F32(_)), "rotations are floats");
                assert_eq!(read.into_f32().collect::<Vec<_>>(), keys.repeat(twice));
            }
            (gltf::animation::util::ReadOutputs::Scales(read), KeyValues::Scale(keys)) => {
                assert_eq!(read.collect::<Vec<_>>(), keys.repeat(twice));
            }
            _ => panic!("another path"),
        }
    }
    let (json, _) = json_of(file);
    assert_eq!(json["animations"][animation.index()]["extras"]["surefoot"]["version"], 1);
    for node in gltf.nodes().skip(source_nodes) {
        let in_scene =
            gltf.scenes().flat_map(|scene| scene.nodes().collect::<Vec<_>>()).any(|root| reaches(&root, node.index()));
        assert!(in_scene, "{:?} is in no scene", node.name());
    }
}

fn reaches(root: &gltf::Node, wanted: usize) -> bool {
    root.index() == wanted || root.children().any(|child| reaches(&child, wanted))
}

/// Where the body's nodes are at some times, for tests/tools/three_check.mjs and blender_check.py: document space.
pub fn dump_pose(rig: &Rig, clip: &Clip, name: &str, file: &str) {
    let mut sampler = rig.sampler(clip);
    let samples: Vec<Value> = [0.0, 0.0775, 0.1875, 0.3085, 0.5, 0.775, 1.0]
        .iter()
        .map(|share| {
            let time = share * clip.duration;
            let globals = sampler.node_globals(time).to_vec();
            let nodes: Vec<Value> = rig
                .joint_nodes
                .iter()
                .flatten()
                .map(|node| {
                    let place = rig.document_from_scenario.point(globals[*node].translation);
                    serde_json::json!([node, place.x, place.y, place.z])
                })
                .collect();
            serde_json::json!({ "time": time, "nodes": nodes })
        })
        .collect();
    let names: Vec<Option<&str>> = rig.nodes.iter().map(|node| node.name.as_deref()).collect();
    let unit = rig.document_from_scenario.scale;
    let dump = serde_json::json!({ "file": file, "clip": name, "unit": unit, "names": names, "samples": samples });
    std::fs::write(baked_path(&format!("{file}.pose.json")), serde_json::to_vec(&dump).expect("JSON"))
        .expect("can be written");
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let bytes = || {
        let rig = synthetic::rig(synthetic::PLAIN);
        let clip = clip(&rig, RootMotion::Root);
        glb(&rig, &[(clip.clone(), report(&clip))]).expect("can be written").bytes
    };
    assert!(bytes() == bytes());
}

#[test]
fn a_key_that_is_no_number_is_refused_with_its_node_and_time() {
    let rig = synthetic::rig(synthetic::PLAIN);
    let mut clip = clip(&rig, RootMotion::Root);
    let hips = rig.hips_node();
    let channel = clip.channels.iter_mut().find(|channel| channel.target == Target::Node(hips)).expect("hips move");
    let KeyValues::Translation(keys) = &mut channel.values else { panic!("translations come first") };
    let stride = channel.interpolation.stride();
    keys[stride + stride / 2][2] = f32::NAN; // the value of the second key
    let time = f64::from(channel.times[1]);
    let report = report(&clip);
    let error = glb(&rig, &[(clip, report)]).expect_err("NaN");
    assert_eq!(
        error,
        ExportError::NotFinite { clip: "shove".into(), node: format!("translation of node {hips} \"hips\""), time }
    );
}

#[test]
fn several_buffers_outer_images_and_missing_scenes_become_one_whole_file() {
    let mut rig = synthetic::rig(synthetic::PLAIN);
    let json = &mut rig.document.json;
    json.as_object_mut().expect("object").shift_remove("scenes");
    json.as_object_mut().expect("object").shift_remove("scene");
    json["buffers"] = serde_json::json!([{ "byteLength": 13, "uri": "one.bin", "name": "first" }, { "byteLength": 12, "uri": "two.bin" }]);
    json["bufferViews"] =
        serde_json::json!([{ "buffer": 1, "byteLength": 12 }, { "buffer": 0, "byteOffset": 1, "byteLength": 5 }]);
    json["images"] = serde_json::json!([{ "uri": "skin.png", "name": "skin" }, { "uri": "gone.png" }]);
    let times: Vec<u8> = [1.0f32, 2.0, 3.0].iter().flat_map(|value| value.to_le_bytes()).collect();
    let png = b"\x89PNG\r\n\x1a\nnot really".to_vec();
    rig.document.buffers = vec![(0..13).collect(), times];
    rig.document.image_files = vec![Some(png.clone()), None];
    rig.document.glb_buffer = false;
    let clip = clip(&rig, RootMotion::Root);
    let made = glb(&rig, &[(clip.clone(), report(&clip))]).expect("can be written");
    keeps_everything(&rig, &made.bytes, &made.changes);
    let (json, bin) = json_of(&made.bytes);
    assert_eq!(json["buffers"].as_array().map(Vec::len), Some(1));
    assert_eq!(json["buffers"][0]["name"], "first");
    let view = &json["bufferViews"][json["images"][0]["bufferView"].as_u64().expect("embedded") as usize];
    let at = view["byteOffset"].as_u64().expect("offset") as usize;
    assert!(bin[at..].starts_with(&png));
    assert_eq!(json["images"][0]["mimeType"], "image/png");
    assert_eq!(json["images"][1]["uri"], "gone.png");
    assert_eq!(json["scenes"].as_array().map(Vec::len), Some(1));
}

#[test]
fn a_still_pose_needs_one_key_a_channel() {
    let rig = synthetic::rig(synthetic::PLAIN);
    let pose = |_: f64| BodyPose::rest(&rig.body);
    let still = keyed_clip(&KeyInput {
        rig: &rig,
        name: "still",
        fps: 30.0,
        duration: 2.0,
        pose: &pose,
        contacts: &[],
        root_motion: RootMotion::Root,
        curves: Curves::Linear,
    });
    let moving = still.channels.iter().filter(|channel| channel.times.len() > 1);
    assert_eq!(moving.map(|channel| channel.target).collect::<Vec<_>>(), [Target::ContactLeft, Target::ContactRight]);
    let head = rig.body.joint(Role::Head).expect("has one");
    let off = rig.sample(&still, 1.0).positions[head].distance(rig.body.joints[head].rest);
    assert!(off < 1e-6, "{off}");
    assert!(rig.sample(&still, 99.0).hips.distance(DVec3::new(0.0, 0.95, 0.0)) < 1e-6);
}
