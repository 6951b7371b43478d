//! What a file must say so that every program plays it alike.
//!
//! Blender drops keys that are closer than 0.01 of its frames, Assimp and others read rotations as floats only, Filament skips channels of
//! one key, and players that go from clip to clip leave what the next does not animate where it was. Each is asked of every kind of clip;
//! and the keys are compared with the poses that they were made from, between them too.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::data;
use crate::export::json_of;
use crate::limits_grid::{rigs, shove};
use crate::shell::Shell;
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeSet;
use surefoot::bake::root_motion::root_bone;
use surefoot::bake::{BakeOptions, Baked, Curves, Drive, Helped, RootMotion, bake};
use surefoot::export::{Form, baked, glb, vrma};
use surefoot::model::scenario::Walk;
use surefoot::model::{Body, KeyValues, Role, Scenario, Target};
use surefoot::rig::{Rig, load, load_bytes};

/// s: half as much again as what Blender drops at 24 frames a second.
const APART: f32 = 0.6e-3;
/// m: what moves in a millisecond by so much more or less than in the one before jumps. Where a foot touches down, poses may.
const JUMP: f64 = 1e-3;

/// As fast for its legs as 1.2 m/s is for those of an adult.
fn walk(body: &Body, seconds: f64) -> Scenario {
    let speed = 1.2 * (body.leg_length / 0.83).sqrt();
    Scenario {
        push: Vec::new(),
        duration: seconds,
        walk: vec![Walk { start: 0.2, speed, heading: 0.0, facing: None, duration: None }],
        ..Scenario::demo()
    }
}

/// The numbers of an accessor that lies in the file's one buffer.
fn floats(json: &Value, bin: &[u8], accessor: &Value) -> Vec<f32> {
    let accessor = &json["accessors"][accessor.as_u64().expect("an index") as usize];
    assert_eq!(accessor["componentType"], 5126, "floats");
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().expect("an index") as usize];
    let start = view["byteOffset"].as_u64().unwrap_or(0) + accessor["byteOffset"].as_u64().unwrap_or(0);
    let width =
        ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|kind| accessor["type"] == *kind).expect("known") + 1;
    let count = accessor["count"].as_u64().expect("a count") as usize * width;
    let bytes = &bin[start as usize..][..4 * count];
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four"))).collect()
}

/// Asks it of the last animation of a file.
fn plays_alike(what: &str, file: &[u8]) {
    let (json, bin) = json_of(file);
    let animations = json["animations"].as_array().expect("animations");
    let last = animations.last().expect("a clip");
    let duration = last["extras"]["surefoot"]["duration"].as_f64().expect("a report");
    let mut own = BTreeSet::new();
    for channel in last["channels"].as_array().expect("channels") {
        let sampler = &last["samplers"][channel["sampler"].as_u64().expect("an index") as usize];
        let target = (channel["target"]["node"].as_u64(), channel["target"]["path"].as_str());
        let times = floats(&json, bin, &sampler["input"]);
        floats(&json, bin, &sampler["output"]);
        assert!(times.len() > 1, "{what}: {target:?} has one key");
        let closest = times.windows(2).map(|pair| pair[1] - pair[0]).fold(f32::INFINITY, f32::min);
        assert!(closest >= APART * 0.999, "{what}: {target:?} has keys {closest} s apart");
        assert!(times[0] == 0.0 && f64::from(times[times.len() - 1]) <= duration + 1e-6, "{what}: {target:?}");
        own.insert(target);
    }
    for other in animations.iter().flat_map(|other| other["channels"].as_array().into_iter().flatten()) {
        let target = (other["target"]["node"].as_u64(), other["target"]["path"].as_str());
        assert!(target.0.is_none() || own.contains(&target), "{what}: {target:?} is left to another clip");
    }
}

fn ragdoll() -> Drive {
    Drive::Ragdoll(Helped::Auto)
}

/// Some of every kind.
fn every_kind(name: &str, rig: &Rig) {
    let kinds: [(&str, Scenario, BakeOptions); 5] = [
        ("stepper", shove(&rig.body, 60.0, 70.0), BakeOptions::default()),
        ("ragdoll", shove(&rig.body, 200.0, 50.0), BakeOptions { drive: ragdoll(), ..BakeOptions::default() }),
        ("hips", walk(&rig.body, 3.0), BakeOptions { root: RootMotion::Hips, fps: 60.0, ..BakeOptions::default() }),
        ("spline", walk(&rig.body, 3.0), BakeOptions { curves: Curves::Spline, ..BakeOptions::default() }),
        (
            "loop",
            walk(&rig.body, 8.0),
            BakeOptions { looped: true, root: RootMotion::InPlace, ..BakeOptions::default() },
        ),
    ];
    for (kind, scenario, options) in kinds {
        let Ok(made) = bake(rig, &scenario, &options) else { panic!("{name} {kind}: no clip") };
        let file = baked(rig, &made, Form { props: true, ..Form::default() }).expect("can be written").file;
        plays_alike(&format!("{name} {kind}"), &file);
        let animation = vrma(rig, &made.clip, &made.report).expect("can be written");
        plays_alike(&format!("{name} {kind}, as a VRM animation"), &animation.bytes);
    }
}

#[test]
fn every_kind_of_clip_plays_alike_everywhere() {
    every_kind("builtin", &builtin());
}

#[test]
fn every_kind_of_clip_of_third_party_rigs_plays_alike_everywhere() {
    let wanted =
        ["m2m_human_base_animations.glb", "kaykit_Knight.glb", "gdquest_mannequiny.glb", "vrm1_debug_robot.vrm"];
    for name in wanted {
        let Some(path) = data::file(&format!("rigs/{name}")) else { return };
        every_kind(name, &load(&path).expect("a rig"));
    }
}

#[test]
fn a_retargeted_and_a_corrected_clip_play_alike_everywhere() {
    let shell = Shell::new();
    let walk = concat!(env!("CARGO_MANIFEST_DIR"), "/exports/gallery/audit/walk.bvh");
    for words in [&format!("retarget {walk} builtin -o walk.glb"), "correct walk.glb -o corrected.glb"] {
        let told = shell.run(words);
        assert_eq!(told.code, 0, "{words}: {}{}", told.out, told.err);
    }
    let [walk, corrected] = ["walk.glb", "corrected.glb"].map(|name| std::fs::read(shell.path(name)).expect("written"));
    assert_ne!(walk, corrected, "something was corrected");
    plays_alike("retargeted", &walk);
    plays_alike("corrected", &corrected);
}

#[test]
fn what_another_clip_of_the_file_moves_is_held_at_rest() {
    let first = builtin();
    let made = bake(&first, &Scenario::demo(), &BakeOptions::default()).expect("it bakes");
    let file = glb(&first, &[(made.clip, made.report)]).expect("can be written").bytes;
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let rig = load_bytes("a rig with a clip", &file, &alone, None).expect("a rig");
    let options = BakeOptions { root: RootMotion::Hips, ..BakeOptions::default() };
    let made = bake(&rig, &Scenario::demo(), &options).expect("it bakes");
    let root = root_bone(&rig).expect("it has a root bone");
    assert!(made.clip.channels.iter().all(|channel| channel.target != Target::Node(root)), "the clip itself lacks it");
    let file = glb(&rig, &[(made.clip, made.report)]).expect("can be written").bytes;
    plays_alike("the second clip", &file);
    let (json, bin) = json_of(&file);
    let ours = &json["animations"][1];
    let channels = ours["channels"].as_array().expect("channels").iter();
    let held: Vec<(&str, Vec<f32>)> = channels
        .filter(|channel| channel["target"]["node"] == root)
        .map(|channel| {
            let sampler = &ours["samplers"][channel["sampler"].as_u64().expect("an index") as usize];
            (channel["target"]["path"].as_str().expect("a path"), floats(&json, bin, &sampler["output"]))
        })
        .collect();
    assert_eq!(held, [("rotation", [0.0, 0.0, 0.0, 1.0].repeat(2)), ("translation", vec![0.0; 6])]);
}

/// m, the farthest that hands and head, and feet, of a clip are from its poses, at every millisecond; and the share of moments that are
/// left out, because the poses themselves jump there.
fn off(rig: &Rig, made: &Baked) -> ([f64; 2], f64) {
    let joints = |roles: &[Role]| -> Vec<usize> { roles.iter().filter_map(|role| rig.body.joint(*role)).collect() };
    let parts = [
        joints(&[Role::Head, Role::LeftHand, Role::RightHand]),
        joints(&[Role::LeftFoot, Role::RightFoot, Role::LeftToes, Role::RightToes]),
    ];
    let mut sampler = rig.sampler(&made.clip);
    let poses: Vec<Vec<DVec3>> = (0..=(made.clip.duration * 1000.0) as usize)
        .map(|tick| made.performance.timeline.pose_at(tick as f64 * 1e-3).positions(&rig.body))
        .collect();
    let all: Vec<usize> = parts.concat();
    let jumps = |three: &[Vec<DVec3>]| {
        all.iter().any(|joint| (three[0][*joint] + three[2][*joint] - three[1][*joint] * 2.0).length() > JUMP)
    };
    let jumped: Vec<usize> = (1..poses.len() - 1).filter(|tick| jumps(&poses[tick - 1..=tick + 1])).collect();
    let mut worst = [0.0_f64; 2];
    let mut left_out = 0;
    for (tick, meant) in poses.iter().enumerate() {
        // A line leads over a jump in the 4 ms to the next frame.
        if jumped.iter().any(|jump| jump.abs_diff(tick) <= 5) {
            left_out += 1;
            continue;
        }
        let shown = sampler.sample(tick as f64 * 1e-3).positions;
        for (worst, joints) in worst.iter_mut().zip(&parts) {
            *worst = joints.iter().map(|joint| shown[*joint].distance(meant[*joint])).fold(*worst, f64::max);
        }
    }
    (worst, left_out as f64 / poses.len() as f64)
}

#[test]
fn straight_lines_show_hands_and_head_within_two_millimetres_and_feet_within_half_a_one() {
    for (name, rig) in rigs() {
        for (kind, scenario, drive) in [
            ("shove", shove(&rig.body, 100.0, 80.0), Drive::Stepper),
            ("shoved body", shove(&rig.body, 320.0, 80.0), ragdoll()),
            ("walk", walk(&rig.body, 3.0), Drive::Stepper),
        ] {
            let options = BakeOptions { drive, ..BakeOptions::default() };
            let made = bake(&rig, &scenario, &options).expect("it bakes");
            let ([upper, feet], left_out) = off(&rig, &made);
            println!("{name} {kind}: hands and head {:.2} mm, feet {:.2} mm", 1e3 * upper, 1e3 * feet);
            assert!(upper < 2.0e-3 && feet < 0.5e-3, "{name} {kind}: {upper} {feet} m");
            assert!(left_out < 0.1, "{name} {kind}: poses jump in {left_out} of the clip");
        }
    }
}

#[test]
fn the_feet_of_a_clip_that_lost_half_of_its_keys_are_farther_off() {
    // The planted extreme: what the test above measures can fail.
    let rig = builtin();
    let mut made = bake(&rig, &walk(&rig.body, 3.0), &BakeOptions::default()).expect("it bakes");
    for channel in made.clip.channels.iter_mut().filter(|channel| channel.times.len() > 20) {
        let kept: Vec<usize> =
            (0..channel.times.len()).filter(|key| key % 2 == 0 || *key + 1 == channel.times.len()).collect();
        channel.times = kept.iter().map(|key| channel.times[*key]).collect();
        match &mut channel.values {
            KeyValues::Translation(keys) | KeyValues::Scale(keys) => {
                *keys = kept.iter().map(|key| keys[*key]).collect();
            }
            KeyValues::Rotation(keys) => *keys = kept.iter().map(|key| keys[*key]).collect(),
        }
    }
    let ([_, feet], _) = off(&rig, &made);
    assert!(feet > 1e-3, "{feet} m");
}
