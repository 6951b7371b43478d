//! VRM animations: what the specification demands, the same pose wherever they are played, read back by the clip loader.
//!
//! Files for tests/tools (the Khronos validator, three-vrm in Chromium) stay in target/vrma.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::data;
use crate::export::{json_of, report};
use crate::synthetic;
use glam::{DQuat, DVec3};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;
use surefoot::bake::keys::{Curves, KeyInput, keyed_clip};
use surefoot::bake::{BakeOptions, RootMotion, bake};
use surefoot::export::vrma::{ExportedVrma, REQUIRED};
use surefoot::export::{t_pose, vrma};
use surefoot::mocap::{self, Options};
use surefoot::model::report::{Contact, Disturbance, Part};
use surefoot::model::{BodyPose, Clip, ClipReport, Role, Scenario, Side};
use surefoot::rig::Rig;

const LENGTH: f64 = 2.0;

pub fn made_path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/vrma");
    std::fs::create_dir_all(&folder).expect("target can be written");
    folder.join(name)
}

/// Rigs by name: the built-in one, troubled ones made by hand, and those of the data folder that load.
pub fn rigs() -> Vec<(String, Rig)> {
    let mut rigs = vec![("builtin".to_owned(), crate::common::builtin())];
    rigs.extend(
        synthetic::troubles().into_iter().map(|(name, trouble)| (format!("synthetic_{name}"), synthetic::rig(trouble))),
    );
    let Some(data) = data::more() else { return rigs };
    let entries = std::fs::read_dir(data.join("rigs")).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        rigs.extend(surefoot::rig::load(&path).ok().map(|rig| (name, rig)));
    }
    rigs
}

/// Everything moves, fingers and toes too: half a radian and more, and the hips go their way.
fn moving(rig: &Rig, time: f64) -> BodyPose {
    let mut pose = BodyPose::rest(&rig.body);
    let size = rig.body.height / 1.7;
    pose.hips += DVec3::new(0.1 * (3.0 * time).sin(), -0.08 * time.min(1.0), 0.4 * time) * size;
    for (index, joint) in rig.body.joints.iter().enumerate() {
        let wave = 0.4 * (2.0 * time + index as f64).sin() * time.min(0.5);
        let own =
            DQuat::from_rotation_x(wave) * DQuat::from_rotation_y(1.3 * wave) * DQuat::from_rotation_z(-0.7 * wave);
        pose.turns[index] = match joint.parent {
            None => DQuat::from_rotation_y(0.8 * time) * own,
            Some(parent) if !joint.animated => pose.turns[parent],
            Some(parent) => pose.turns[parent] * own,
        };
    }
    pose
}

pub fn clip(rig: &Rig, root_motion: RootMotion) -> Clip {
    let pose = |time: f64| moving(rig, time);
    let (name, fps, duration, contacts) = ("all over", 30.0, LENGTH, &[]);
    keyed_clip(&KeyInput { rig, name, fps, duration, pose: &pose, contacts, root_motion, curves: Curves::Linear })
}

pub fn made(rig: &Rig, clip: &Clip) -> ExportedVrma {
    vrma(rig, clip, &report(clip)).expect("can be written")
}

/// A VRM animation as any reader has it: bones by name, their rest, and their channels.
pub struct Played {
    pub bones: BTreeMap<String, usize>,
    parents: Vec<Option<usize>>,
    rest: Vec<DVec3>,
    turns: BTreeMap<usize, (Vec<f32>, Vec<[f32; 4]>)>,
    way: (Vec<f32>, Vec<[f32; 3]>),
}

impl Played {
    pub fn read(file: &[u8]) -> Played {
        let (json, _) = json_of(file);
        let gltf = gltf::Gltf::from_slice(file).expect("the gltf crate reads it");
        let blob = gltf.blob.clone().expect("has a BIN chunk");
        let count = gltf.nodes().count();
        let (mut parents, mut rest) = (vec![None; count], vec![DVec3::ZERO; count]);
        for node in gltf.nodes() {
            let (translation, rotation, scale) = node.transform().decomposed();
            assert_eq!((rotation, scale), ([0.0, 0.0, 0.0, 1.0], [1.0; 3]), "{:?} is turned at rest", node.name());
            rest[node.index()] = DVec3::from(translation.map(f64::from));
            node.children().for_each(|child| parents[child.index()] = Some(node.index()));
        }
        let bones = json["extensions"]["VRMC_vrm_animation"]["humanoid"]["humanBones"].as_object().expect("bones");
        let bones: BTreeMap<String, usize> =
            bones.iter().map(|(name, bone)| (name.clone(), bone["node"].as_u64().expect("a node") as usize)).collect();
        let (mut turns, mut way) = (BTreeMap::new(), (Vec::new(), Vec::new()));
        for channel in gltf.animations().next().expect("has a clip").channels() {
            let node = channel.target().node().index();
            let reader = channel.reader(|_| Some(&blob));
            let times: Vec<f32> = reader.read_inputs().expect("times").collect();
            match reader.read_outputs().expect("values") {
                gltf::animation::util::ReadOutputs::Rotations(keys) => {
                    turns.insert(node, (times, keys.into_f32().collect()));
                }
                gltf::animation::util::ReadOutputs::Translations(keys) => {
                    assert_eq!(node, bones["hips"], "only the hips are moved");
                    way = (times, keys.collect());
                }
                _ => panic!("a VRM animation has no scales and no weights"),
            }
        }
        Played { bones, parents, rest, turns, way }
    }

    pub fn bone(&self, role: Role) -> Option<usize> {
        self.bones.get(role.name()).copied()
    }

    pub fn place_at_rest(&self, node: usize) -> DVec3 {
        self.rest[node] + self.parents[node].map_or(DVec3::ZERO, |parent| self.place_at_rest(parent))
    }

    /// The turn from the T-pose and the place of a bone at a time, as a reader interpolates.
    pub fn at(&self, node: usize, time: f64) -> (DQuat, DVec3) {
        let (above, base) = self.parents[node].map_or((DQuat::IDENTITY, DVec3::ZERO), |parent| self.at(parent, time));
        let between = |times: &[f32]| {
            let next = times.partition_point(|key| f64::from(*key) <= time).min(times.len() - 1);
            let from = next.saturating_sub(1);
            let span = f64::from(times[next] - times[from]);
            (from, next, if span > 0.0 { ((time - f64::from(times[from])) / span).clamp(0.0, 1.0) } else { 0.0 })
        };
        let own = self.turns.get(&node).map_or(DQuat::IDENTITY, |(times, keys)| {
            let (from, to, share) = between(times);
            let key = |at: usize| DQuat::from_array(keys[at].map(f64::from)).normalize();
            surefoot::rig::animate::slerp(key(from), key(to), share)
        });
        let local = if Some(node) == self.bone(Role::Hips) {
            let (from, to, share) = between(&self.way.0);
            let key = |at: usize| DVec3::from(self.way.1[at].map(f64::from));
            key(from).lerp(key(to), share)
        } else {
            self.rest[node]
        };
        (above * own, base + above * local)
    }
}

/// Where the file's space lies from scenario space.
fn offset(rig: &Rig, file: &Played, clip: &Clip) -> DVec3 {
    let mut sampler = rig.sampler(clip);
    let hips = sampler.node_globals(0.0)[rig.hips_node()].translation;
    file.at(file.bones["hips"], 0.0).1 - hips
}

#[test]
fn the_file_is_what_the_specification_demands() {
    for (name, rig) in rigs() {
        for mode in [RootMotion::Root, RootMotion::Hips, RootMotion::InPlace] {
            let clip = clip(&rig, mode);
            let made = made(&rig, &clip);
            assert!(made == self::made(&rig, &clip), "{name}: the same bytes twice");
            std::fs::write(made_path(&format!("{name}.{}.vrma", mode.name())), &made.bytes).expect("can be written");
            let (json, _) = json_of(&made.bytes);
            for absent in ["meshes", "skins", "materials", "textures", "images", "cameras"] {
                assert!(json.get(absent).is_none(), "{name}: {absent}");
            }
            assert_eq!(json["extensionsUsed"], json!(["VRMC_vrm_animation"]));
            assert_eq!(json["extensions"]["VRMC_vrm_animation"]["specVersion"], "1.0");
            assert_eq!(json["animations"].as_array().map(Vec::len), Some(1));
            assert_eq!(json["animations"][0]["name"], "all over");
            assert_eq!(json["animations"][0]["extras"]["surefoot"]["version"], 1);
            let file = Played::read(&made.bytes); // and rest, channels
            for role in REQUIRED {
                assert!(file.bone(role).is_some(), "{name} lacks {}", role.name());
            }
            for bone in file.bones.keys() {
                assert!(Role::from_name(bone).is_some(), "{bone} is no bone of VRM 1.0");
                assert!(!bone.contains("Eye"), "eyes are the look-at's");
            }
            let nodes: std::collections::BTreeSet<usize> = file.bones.values().copied().collect();
            assert_eq!(nodes.len(), file.bones.len(), "{name}: two bones are one node");
            for role in [Role::LeftToes, Role::RightToes, Role::LeftMiddleProximal, Role::RightThumbMetacarpal] {
                let animated = rig.body.joint(role).is_some_and(|joint| rig.body.joints[joint].animated);
                assert_eq!(file.bone(role).is_some(), animated, "{name}: {}", role.name());
                if let Some(bone) = file.bone(role) {
                    assert!(file.turns.contains_key(&bone), "{name}: {} does not move", role.name());
                }
            }
            let last = file.way.0.last().copied().expect("hips move");
            assert_eq!(last, clip.duration as f32, "{name}: as long as the clip");
        }
    }
}

#[test]
fn the_rest_pose_is_a_t() {
    for (name, rig) in rigs() {
        let file = Played::read(&made(&rig, &clip(&rig, RootMotion::Root)).bytes);
        let place = |role: Role| file.bone(role).map(|bone| file.place_at_rest(bone));
        let degrees = |from: Role, to: Role, along: DVec3| {
            Some((place(to)? - place(from)?).angle_between(along).to_degrees()).filter(|angle| angle.is_finite())
        };
        let vrm = rig.mapping.method.starts_with("vrm"); // its own word is taken for a T
        let most = |degrees: f64| if vrm { 15.0 } else { degrees };
        let mut worst: BTreeMap<&str, f64> = BTreeMap::new();
        for (left, out) in [(true, DVec3::X), (false, DVec3::NEG_X)] {
            let role = |role: Role| if left { role } else { role.mirrored() };
            for (part, from, to, along, limit) in [
                ("upper arm", Role::LeftUpperArm, Role::LeftLowerArm, out, 0.1),
                ("lower arm", Role::LeftLowerArm, Role::LeftHand, out, 0.1),
                ("finger", Role::LeftMiddleProximal, Role::LeftMiddleIntermediate, out, 0.1),
                ("thumb", Role::LeftThumbProximal, Role::LeftThumbDistal, out + DVec3::Z, 0.1),
                ("leg", Role::LeftUpperLeg, Role::LeftFoot, DVec3::NEG_Y, 5.0),
            ] {
                let Some(angle) = degrees(role(from), role(to), along) else { continue };
                // VRM 0 says nothing of thumbs.
                let limit = if part == "thumb" && vrm { 90.0 } else { most(limit) };
                assert!(angle < limit, "{name}: {part} {angle:.2} degrees off");
                worst.entry(part).and_modify(|worst| *worst = worst.max(angle)).or_insert(angle);
            }
            // The first finger lies ahead of the last: the palm faces down.
            if let (Some(first), Some(last)) =
                (place(role(Role::LeftIndexProximal)), place(role(Role::LeftLittleProximal)))
            {
                assert!((first - last).normalize().z > 0.6, "{name}: the palm does not face down");
            }
        }
        let hips = place(Role::Hips).expect("hips");
        let head = place(Role::Head).expect("a head");
        let lean = (head - hips).angle_between(DVec3::Y).to_degrees();
        assert!(lean < 10.0, "{name} leans by {lean:.1} degrees");
        let low = if vrm { 0.0 } else { 0.15 * rig.body.height }; // one VRM has its hips between its feet
        assert!(hips.y > low && hips.y < 0.75 * rig.body.height, "{name}: hips at {} m", hips.y);
        println!("{name}: {worst:.1?}, lean {lean:.1}");
    }
}

#[test]
fn a_rest_pose_that_is_no_t_is_turned_into_one() {
    // The planted extreme: arms that hang at 40 degrees off the body stay there without the turn.
    let rig = crate::common::builtin();
    let still = t_pose(&rig, &rig.body.joints.iter().map(|joint| joint.rest).collect::<Vec<_>>());
    let arm = rig.body.joint(Role::LeftUpperArm).expect("an arm");
    let angle = still[arm].angle_between(DQuat::IDENTITY).to_degrees();
    assert!((angle - 50.0).abs() < 0.5, "{angle}");
    let spine = rig.body.joint(Role::Spine).expect("a spine");
    assert!(still[spine].angle_between(DQuat::IDENTITY) < 1e-6, "a straight trunk stays");
}

#[test]
fn a_palm_that_faces_ahead_is_turned_down() {
    let Some(file) = data::file("rigs/m2m_human_male.glb") else { return };
    let rig = surefoot::rig::load(&file).expect("the rig loads");
    let joint = |role: Role| rig.body.joint(role).expect("it has whole hands");
    let (lower, hand) = (joint(Role::LeftLowerArm), joint(Role::LeftHand));
    let mut places: Vec<DVec3> = rig.body.joints.iter().map(|joint| joint.rest).collect();
    let plain = t_pose(&rig, &places);
    // Everything beyond the wrist, rolled about the forearm by a quarter.
    let axis = (places[hand] - places[lower]).normalize();
    let roll = DQuat::from_axis_angle(axis, std::f64::consts::FRAC_PI_2);
    for at in hand + 1..places.len() {
        if rig.body.joints[at].role.name().starts_with("left")
            && std::iter::successors(Some(at), |at| rig.body.joints[*at].parent).any(|above| above == hand)
        {
            places[at] = places[hand] + roll * (places[at] - places[hand]);
        }
    }
    let rolled = t_pose(&rig, &places);
    let across = |turns: &[DQuat], places: &[DVec3]| {
        let between = places[joint(Role::LeftIndexProximal)] - places[joint(Role::LeftLittleProximal)];
        (turns[hand] * between).normalize()
    };
    let rest: Vec<DVec3> = rig.body.joints.iter().map(|joint| joint.rest).collect();
    assert!(across(&plain, &rest).z > 0.9, "{}", across(&plain, &rest));
    assert!(across(&rolled, &places).z > 0.9, "{}", across(&rolled, &places));
    let back = rolled[lower].angle_between(plain[lower]).to_degrees();
    assert!((back - 90.0).abs() < 3.0, "the forearm rolls back by {back:.1} degrees");
    assert!(rolled[joint(Role::LeftUpperArm)].angle_between(plain[joint(Role::LeftUpperArm)]) < 1e-9);
}

#[test]
fn joints_turn_and_go_as_on_the_rig() {
    for (name, rig) in rigs() {
        for mode in [RootMotion::Root, RootMotion::Hips] {
            let clip = clip(&rig, mode);
            let file = Played::read(&made(&rig, &clip).bytes);
            let mut sampler = rig.sampler(&clip);
            let rest: Vec<DVec3> = rig.body.joints.iter().map(|joint| joint.rest).collect();
            let still = t_pose(&rig, &rest);
            let base = offset(&rig, &file, &clip);
            let (mut turned, mut moved) = ((0.0, Role::Hips), 0.0_f64);
            for tick in 0..=97 {
                let time = LENGTH * f64::from(tick) / 97.0;
                let pose = sampler.sample(time);
                let hips = sampler.node_globals(time)[rig.hips_node()].translation;
                for (joint, one) in rig.body.joints.iter().enumerate() {
                    let Some(bone) = file.bone(one.role) else { continue };
                    let (turn, place) = file.at(bone, time);
                    let off = turn.angle_between(pose.turns[joint] * still[joint].inverse()).to_degrees();
                    if off > turned.0 {
                        turned = (off, one.role);
                    }
                    if joint == 0 {
                        moved = moved.max((place - base).distance(hips));
                    }
                }
            }
            println!("{name} {}: {:.4} degrees ({:?}), hips {:.4} mm", mode.name(), turned.0, turned.1, moved * 1e3);
            assert!(turned.0 < 0.1 && moved < 1e-3, "{name} {mode:?}: {turned:?}, {moved} m");
        }
    }
}

#[test]
fn the_clip_loader_reads_it_back() {
    for (name, rig) in rigs() {
        let clip = clip(&rig, RootMotion::Root);
        let file = made(&rig, &clip);
        let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
        let read = mocap::read("clip.vrma", &file.bytes, &none, None).unwrap_or_else(|error| panic!("{name}: {error}"));
        let said = Options { unit: Some(1.0), fps: Some(30.0), ..Options::default() };
        let capture = read.capture(0, &said).unwrap_or_else(|error| panic!("{name}: {error}"));
        let played = Played::read(&file.bytes);
        let mut worst = (0.0, Role::Hips);
        for frame in 0..capture.frames() {
            for (joint, one) in capture.body.joints.iter().enumerate().filter(|(_, one)| one.animated) {
                let bone = played.bone(one.role).unwrap_or_else(|| panic!("{name}: {:?} was made up", one.role));
                let off = capture.at(frame)[joint].distance(played.at(bone, frame as f64 / 30.0).1);
                if off > worst.0 {
                    worst = (off, one.role);
                }
            }
        }
        assert!(capture.frames() == 61 && worst.0 < 1e-3, "{name}: {} frames, {worst:?}", capture.frames());
    }
}

#[test]
fn contacts_and_forces_are_told_in_the_files_own_space() {
    // Centimetres, Z up, turned: nothing of it is left in the file.
    for (name, rig) in rigs() {
        let clip = clip(&rig, RootMotion::Hips);
        let similarity = &rig.document_from_scenario;
        let (foot, force) = (DVec3::new(0.1, 0.0, 0.3), DVec3::new(-200.0, 0.0, 50.0));
        let contact = Contact {
            foot: Side::Left,
            part: Part::Flat,
            start: 0.0,
            end: 1.0,
            frame: "world".into(),
            position: similarity.point(foot).to_array(),
            normal: (similarity.rotation * DVec3::Y).to_array(),
            slip_mm: 0.0,
        };
        let kind = "push".to_owned();
        let force_there = (similarity.rotation * force).to_array();
        let push = Disturbance { kind, start: 0.2, end: 0.4, force: force_there, bone: "chest".into() };
        let said = ClipReport { contacts: vec![contact], disturbances: vec![push], ..report(&clip) };
        let made = vrma(&rig, &clip, &said).expect("can be written");
        let base = offset(&rig, &Played::read(&made.bytes), &clip);
        let told = &made.report;
        assert_eq!(told.root_motion, "hips", "whichever node of the rig had it");
        assert!(DVec3::from(told.contacts[0].position).distance(foot + base) < 1e-6, "{name}");
        assert!(DVec3::from(told.contacts[0].normal).distance(DVec3::Y) < 1e-9, "{name}");
        assert!(DVec3::from(told.disturbances[0].force).distance(force) < 1e-6, "{name}");
        let (json, _) = json_of(&made.bytes);
        assert_eq!(json["animations"][0]["extras"]["surefoot"]["contacts"][0]["foot"], "left");
    }
}

#[test]
fn legs_of_another_length_are_told_as_a_loss() {
    let rig = crate::common::builtin();
    let mut scenario = Scenario::demo();
    scenario.character.leg_scale = 1.2;
    let baked = bake(&rig, &scenario, &BakeOptions::default()).expect("the demo bakes");
    let made = vrma(&rig, &baked.clip, &baked.report).expect("can be written");
    assert!(made.losses[0].contains("scale"), "{:?}", made.losses);
    let file = Played::read(&made.bytes);
    let drop = file.place_at_rest(file.bones["hips"]).y;
    assert!(drop > 1.05, "the hips stand on the long legs: {drop}");
}
