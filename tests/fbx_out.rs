//! FBX files that are written: read back by ufbx, joint by joint, beside the clip they were made of.
//!
//! The files and what is expected of them stay in target/fbx, for tests/tools/fbx_check.py (Blender) and Assimp.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::export::report;
use crate::lanes::baked;
use crate::limits_grid::shove;
use crate::vrma::{clip, rigs};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use surefoot::bake::keys::{Curves, KeyInput, keyed_clip};
use surefoot::bake::{BakeOptions, Baked, RootMotion, bake};
use surefoot::export::{ExportedFbx, fbx};
use surefoot::model::{BodyPose, Clip, ClipReport, Target};
use surefoot::rig::Rig;
use surefoot::rig::nodes::globals;
use ufbx::{CoordinateAxis, SceneRoot};

/// mm: a joint of the file may be so far from the clip's, on the frames.
const NEAR: f64 = 0.5;

pub fn made_path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/fbx");
    std::fs::create_dir_all(&folder).expect("target can be written");
    folder.join(name)
}

pub fn open(bytes: &[u8]) -> SceneRoot {
    ufbx::load_memory(bytes, ufbx::LoadOpts::default()).expect("ufbx reads it")
}

fn local(transform: &ufbx::Transform) -> DAffine3 {
    let (t, r, s) = (&transform.translation, &transform.rotation, &transform.scale);
    DAffine3::from_scale_rotation_translation(
        DVec3::new(s.x, s.y, s.z),
        DQuat::from_xyzw(r.x, r.y, r.z, r.w),
        DVec3::new(t.x, t.y, t.z),
    )
}

/// Every node but the scene's own in the file's world at a time of its only take; without one at rest.
pub fn places(scene: &SceneRoot, time: Option<f64>) -> BTreeMap<String, DAffine3> {
    let mut all: Vec<DAffine3> = Vec::new();
    let mut named = BTreeMap::new();
    for node in &scene.nodes {
        let own = match time {
            Some(time) => local(&ufbx::evaluate_transform(&scene.anim_stacks[0].anim, node, time)),
            None => local(&node.local_transform),
        };
        let parent = node.parent.as_ref().map_or(DAffine3::IDENTITY, |parent| all[parent.element.typed_id as usize]);
        all.push(parent * own);
        if !node.is_root {
            named.insert(node.element.name.to_string(), parent * own);
        }
    }
    named
}

/// The rig's nodes in the file's world, cm, as the document has them there.
fn file_from_document(rig: &Rig) -> DAffine3 {
    let stands = &rig.document_from_scenario;
    let upright = (stands.rotation * DVec3::Y).y > 0.99;
    let turn = if upright { DQuat::IDENTITY } else { stands.rotation.inverse() };
    DAffine3::from_scale_rotation_translation(DVec3::splat(100.0), turn, DVec3::ZERO)
}

/// What a file must show: cm, by node, at a time of the clip.
fn expected(rig: &Rig, clip: &Clip, time: f64) -> BTreeMap<usize, DVec3> {
    let to_file = file_from_document(rig) * rig.scenario_from_document().inverse();
    let mut sampler = rig.sampler(clip);
    sampler.node_globals(time).iter().map(|at| to_file.transform_point3(at.translation)).enumerate().collect()
}

/// The node that a bone of the file is.
fn node_of(rig: &Rig, bone: &str) -> Option<usize> {
    let unnamed = || bone.strip_prefix("node_").and_then(|index| index.parse().ok());
    rig.nodes.iter().position(|node| node.name.as_deref() == Some(bone)).or_else(unnamed)
}

fn duplicated(rig: &Rig) -> BTreeSet<&str> {
    let mut seen = BTreeSet::new();
    rig.nodes.iter().filter_map(|node| node.name.as_deref()).filter(|name| !seen.insert(*name)).collect()
}

/// mm and where: the joint that is farthest from the clip's on the file's frames, and between them.
fn farthest(rig: &Rig, clip: &Clip, made: &ExportedFbx, pace: f64) -> [(f64, String); 2] {
    let scene = open(&made.bytes);
    let stack = &scene.anim_stacks[0];
    let frames = ((stack.time_end - stack.time_begin) * made.fps).round() as usize;
    let twins = duplicated(rig);
    let mut worst = [(0.0, String::new()), (0.0, String::new())];
    for half in 0..=2 * frames {
        let time = half as f64 / 2.0 / made.fps;
        let wanted = expected(rig, clip, time / pace);
        for (name, at) in places(&scene, Some(time)) {
            if twins.contains(name.as_str()) {
                continue;
            }
            let Some(node) = node_of(rig, &name) else { continue };
            let off = at.translation.distance(wanted[&node]) * 10.0 / rig.document_from_scenario.scale;
            let worst = &mut worst[half % 2];
            if off > worst.0 {
                *worst = (off, format!("{name} at {time:.3} s"));
            }
        }
    }
    worst
}

/// For programs outside: the file, and where its joints must be on every frame, metres.
fn leave(name: &str, rig: &Rig, clip: &Clip, made: &ExportedFbx) {
    let scene = open(&made.bytes);
    let stack = &scene.anim_stacks[0];
    let frames = (stack.time_end * made.fps).round() as usize;
    let twins = duplicated(rig);
    let nodes: BTreeMap<String, usize> = places(&scene, None)
        .into_keys()
        .filter(|name| !twins.contains(name.as_str()))
        .filter_map(|name| Some((name.clone(), node_of(rig, &name)?)))
        .collect();
    let frames: Vec<Vec<[f64; 3]>> = (0..=frames)
        .map(|frame| {
            let wanted = expected(rig, clip, frame as f64 / made.fps);
            nodes.values().map(|node| (wanted[node] / 100.0).to_array()).collect()
        })
        .collect();
    let all: Vec<String> = places(&scene, None).into_keys().collect();
    let told = json!({ "take": made.name, "units": rig.document_from_scenario.scale, "fps": made.fps, "bones": all, "names": nodes.keys().collect::<Vec<_>>(), "frames": frames });
    std::fs::write(made_path(&format!("{name}.fbx")), &made.bytes).expect("target can be written");
    std::fs::write(made_path(&format!("{name}.json")), told.to_string()).expect("target can be written");
}

fn made(rig: &Rig, clip: &Clip) -> ExportedFbx {
    fbx(rig, clip, &report(clip)).expect("can be written")
}

fn shoved(rig: &Rig, root: RootMotion) -> Baked {
    let options = BakeOptions { root, ..BakeOptions::default() };
    bake(rig, &shove(&rig.body, 270.0, 60.0), &options).expect("a shove")
}

#[test]
fn joints_of_every_rig_stand_in_the_fbx_where_the_clip_has_them() {
    let mut bad = Vec::new();
    let rigs = rigs();
    assert!(rigs.len() > 3, "the built-in rig and the troubled ones at least");
    for (name, rig) in &rigs {
        let clip = clip(rig, RootMotion::Root);
        let made = made(rig, &clip);
        let [on, between] = farthest(rig, &clip, &made, 1.0);
        println!("{name}: {:.4} mm on the frames ({}), {:.1} mm between, {:?}", on.0, on.1, between.0, made.changes);
        if on.0 > NEAR {
            bad.push(format!("{name}: {} mm, {}", on.0, on.1));
        }
        leave(name, rig, &clip, &made);
    }
    assert!(bad.is_empty(), "{bad:#?}");
}

#[test]
fn a_shove_keeps_its_joints_under_every_root_motion_and_on_longer_legs() {
    let rig = crate::common::builtin();
    for root in [RootMotion::Root, RootMotion::Hips, RootMotion::InPlace] {
        let shoved = shoved(&rig, root);
        let made = fbx(&rig, &shoved.clip, &shoved.report).expect("can be written");
        let [on, between] = farthest(&rig, &shoved.clip, &made, 1.0);
        println!("{}: {:.4} mm on the frames, {:.2} between", root.name(), on.0, between.0);
        assert!(on.0 < NEAR, "{}: {} mm at {}", root.name(), on.0, on.1);
        leave(&format!("shove_{}", root.name()), &rig, &shoved.clip, &made);
    }
    let mut scenario = shove(&rig.body, 270.0, 60.0);
    scenario.character.leg_scale = 1.3;
    let long = baked(&rig, &scenario);
    let made = fbx(&rig, &long.clip, &long.report).expect("can be written");
    let [on, _] = farthest(&rig, &long.clip, &made, 1.0);
    assert!(on.0 < NEAR, "long legs: {} mm at {}", on.0, on.1);
    let hips = |time| places(&open(&made.bytes), Some(time))["hips"].translation.y;
    assert!(hips(0.0) > 110.0, "the legs are longer: {}", hips(0.0));
    leave("shove_long_legs", &rig, &long.clip, &made);
}

#[test]
fn the_file_says_its_unit_axes_rate_and_take_and_holds_bones_under_one_root_only() {
    for (name, rig) in rigs() {
        let clip = clip(&rig, RootMotion::Root);
        let made = made(&rig, &clip);
        let scene = open(&made.bytes);
        let settings = &scene.settings;
        assert_eq!(settings.unit_meters, 0.01, "{name}");
        assert_eq!(settings.axes.up, CoordinateAxis::PositiveY, "{name}");
        assert_eq!(settings.axes.front, CoordinateAxis::PositiveZ, "{name}");
        assert_eq!(settings.axes.right, CoordinateAxis::PositiveX, "{name}");
        assert_eq!(settings.frames_per_second, 30.0, "{name}");
        assert_eq!(scene.anim_stacks.count, 1, "{name}");
        assert_eq!(&*scene.anim_stacks[0].element.name, "all over", "{name}");
        assert!((scene.anim_stacks[0].time_end - 2.0).abs() < 1e-9, "{name}: {}", scene.anim_stacks[0].time_end);
        assert_eq!(scene.meshes.count + scene.cameras.count + scene.lights.count, 0, "{name}");
        assert_eq!(scene.root_node.children.count, 1, "{name}: one root");
        assert!(scene.metadata.warnings.is_empty(), "{name}: {}", scene.metadata.warnings.count);
        let kept: BTreeSet<String> = places(&scene, None).into_keys().collect();
        assert_eq!(kept.len() + 1, scene.nodes.count, "{name}: names are there once");
        assert!(!kept.contains("contact_L") && !kept.contains("contact_R"), "{name}");
        for node in rig.joint_nodes.iter().flatten() {
            let own = rig.nodes[*node].name.clone().unwrap_or_default();
            let told = made.changes.iter().any(|change| change.contains(&format!("\"{own}\"")) || own.is_empty());
            assert!(kept.contains(&own) || told, "{name}: {own} is neither there nor told of");
        }
        let named = |value: &ufbx::AnimValue| value.element.name.to_string();
        for (curved, curve) in scene.anim_values.into_iter().flat_map(|value| {
            let name = named(value);
            value.curves.iter().flatten().map(move |curve| (name.clone(), curve))
        }) {
            for key in &curve.keyframes {
                let frame = key.time * 30.0;
                assert!((frame - frame.round()).abs() < 1e-9, "{name}: a key at {} s", key.time);
            }
            let most = curve.keyframes.windows(2).map(|pair| (pair[1].value - pair[0].value).abs()).fold(0.0, f64::max);
            assert!(curved != "R" || most < 180.0, "{name}: angles jump by {most} degrees");
        }
        assert!(scene.anim_values.into_iter().any(|value| named(value) == "R"), "{name}: there are angles");
        assert_eq!(made, self::made(&rig, &clip), "{name}: the same bytes each time");
    }
}

#[test]
fn bones_rest_as_the_rig_does() {
    for (name, rig) in rigs() {
        let scene = open(&made(&rig, &clip(&rig, RootMotion::Hips)).bytes);
        let rests = globals(&rig.nodes, |node| node.local);
        let to_file = file_from_document(&rig);
        let twins = duplicated(&rig);
        let unscaled = rig.nodes.iter().all(|node| (node.local.scale - DVec3::ONE).abs().max_element() < 1e-6);
        for (bone, at) in places(&scene, None).iter().filter(|(bone, _)| !twins.contains(bone.as_str())) {
            let Some(node) = node_of(&rig, bone) else { continue };
            let off = (to_file.transform_point3(rests[node].translation) - at.translation).length() * 10.0
                / rig.document_from_scenario.scale;
            assert!(off < 0.01, "{name}: {bone} rests {off} mm beside");
            if unscaled && to_file.matrix3.x_axis.normalize().abs_diff_eq(DVec3::X, 1e-9) {
                let turned: DMat3 = rests[node].matrix3.transpose() * at.matrix3;
                assert!(turned.abs_diff_eq(DMat3::IDENTITY, 1e-6), "{name}: {bone} rests turned: {turned}");
            }
        }
    }
}

#[test]
fn an_armature_that_is_scaled_and_turned_stays_as_it_is_and_a_scaled_bone_goes_into_lengths() {
    let mut json = crate::common::builtin().document.json;
    let roots = json["scenes"][0]["nodes"].as_array().expect("roots").clone();
    let nodes = json["nodes"].as_array_mut().expect("nodes");
    for node in nodes.iter_mut() {
        if let Some(place) = node["translation"].as_array().cloned() {
            node["translation"] = place.iter().map(|part| json!(part.as_f64().unwrap_or(0.0) * 100.0)).collect();
        }
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    nodes.push(json!({ "name": "Armature", "children": roots, "scale": [0.01, 0.01, 0.01], "rotation": [-half, 0.0, 0.0, half] }));
    let last = nodes.len() - 1;
    nodes.push(json!({ "name": "Upright", "children": [last], "rotation": [half, 0.0, 0.0, half] }));
    json["scenes"][0]["nodes"] = json!([last + 1]);
    json.as_object_mut()
        .expect("an object")
        .retain(|key, _| ["asset", "scene", "scenes", "nodes"].contains(&key.as_str()));
    for node in json["nodes"].as_array_mut().expect("nodes") {
        node.as_object_mut().expect("a node").retain(|key, _| key != "skin" && key != "mesh");
    }
    let text = json.to_string();
    let nothing = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let rig = surefoot::rig::load_bytes("armature.gltf", text.as_bytes(), &nothing, None).expect("a rig");
    for root in [RootMotion::Root, RootMotion::Hips] {
        let clip = clip(&rig, root);
        let made = made(&rig, &clip);
        let [on, _] = farthest(&rig, &clip, &made, 1.0);
        assert!(on.0 < NEAR, "{} mm: {}", on.0, on.1);
        assert!(made.changes.is_empty(), "{:?}", made.changes);
        let scene = open(&made.bytes);
        let armature = scene.nodes.into_iter().find(|node| &*node.element.name == "Armature").expect("is there");
        assert!((armature.local_transform.scale.x - 0.01).abs() < 1e-9);
        assert!(armature.bone.is_none(), "a scaled armature is a null object");
        leave(&format!("armature_{}", root.name()), &rig, &clip, &made);
    }
    // The same scale on a joint of the body.
    let mut scaled = rig.clone();
    let chest = scaled.mapping.bones[&surefoot::model::Role::Chest];
    scaled.nodes[chest].local.scale = DVec3::splat(2.0);
    scaled.nodes[chest].bind.scale = DVec3::splat(2.0);
    let clip = clip(&scaled, RootMotion::Root);
    let made = made(&scaled, &clip);
    let [on, _] = farthest(&scaled, &clip, &made, 1.0);
    assert!(on.0 < NEAR, "{} mm: {}", on.0, on.1);
    assert_eq!(made.changes.len(), 1, "{:?}", made.changes);
    leave("scaled_chest", &scaled, &clip, &made);
}

#[test]
fn a_loop_ends_on_a_frame_and_its_last_frame_is_its_first() {
    let rig = crate::common::builtin();
    let looped: ClipReport = {
        let mut told = report(&clip(&rig, RootMotion::InPlace));
        told.looped = Some(surefoot::model::report::LoopReport {
            period: 1.015,
            error_deg: 0.0,
            error_mm: 0.0,
            speed: 1.0,
            evened_deg: 0.0,
            evened_mm: 0.0,
        });
        told.events[0].time = 1.015;
        told
    };
    let pose = |time: f64| {
        let mut pose = BodyPose::rest(&rig.body);
        pose.turns[3] *= DQuat::from_rotation_x(0.3 * (time / 1.015 * std::f64::consts::TAU).sin());
        pose
    };
    let (name, root_motion, curves) = ("round_loop", RootMotion::Hips, Curves::Linear);
    let clip = keyed_clip(&KeyInput {
        rig: &rig,
        name,
        fps: 30.0,
        duration: 1.015,
        pose: &pose,
        contacts: &[],
        root_motion,
        curves,
    });
    let made = fbx(&rig, &clip, &looped).expect("can be written");
    assert_eq!(made.changes.len(), 1, "{:?}", made.changes);
    let scene = open(&made.bytes);
    assert!((scene.anim_stacks[0].time_end - 1.0).abs() < 1e-9, "30.45 frames become 30");
    assert!((made.report.events[0].time - 1.0).abs() < 1e-6);
    let [on, _] = farthest(&rig, &clip, &made, 30.0 / 30.45);
    assert!(on.0 < NEAR, "{} mm: {}", on.0, on.1);
    let (first, last) = (places(&scene, Some(0.0)), places(&scene, Some(1.0)));
    for (bone, at) in first {
        assert!(at.translation.distance(last[&bone].translation) < 0.05, "{bone} does not close");
    }
}

#[test]
fn rates_names_and_doubled_bones_that_fbx_cannot_hold_are_changed_and_told() {
    let mut rig = crate::common::builtin();
    let spine = rig.mapping.bones[&surefoot::model::Role::Spine];
    let head = rig.mapping.bones[&surefoot::model::Role::Head];
    let neck = rig.mapping.bones[&surefoot::model::Role::Neck];
    rig.nodes[spine].name = Some("mixamorig:Spine".into());
    rig.nodes[head].name = Some("rig::Head\0\u{1}Model".into());
    rig.nodes[neck].name = None;
    let foot = rig.mapping.bones[&surefoot::model::Role::LeftFoot];
    rig.nodes[foot].name = Some("mixamorig:Spine".into());
    let mut clip = clip(&rig, RootMotion::Root);
    clip.name = "a\0b".into();
    clip.fps = 45.0;
    let made = made(&rig, &clip);
    let names = places(&open(&made.bytes), None);
    for name in ["mixamorig:Spine", "mixamorig:Spine_2", "rig_Head__Model", &format!("node_{neck}")] {
        assert!(names.contains_key(name), "{name} is not among {:?}", names.keys());
    }
    assert_eq!((made.name.as_str(), made.fps), ("a_b", 60.0));
    assert_eq!(made.changes.len(), 5, "{:#?}", made.changes);
    assert!(clip.channels.iter().any(|channel| channel.target == Target::Node(spine)));
}
