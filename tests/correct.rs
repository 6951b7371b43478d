//! Corrections of clips whose faults are planted: what goes, what stays to the bit, what is written.
//!
//! The clip is the built-in rig's own baked walk, read back as any clip; faults are planted into its capture and written into files by the
//! writer that is tested, so no third-party data is needed.

use crate::audit_faults::{self, Planted, Way};
use crate::common::builtin;
use glam::DQuat;
use serde_json::Value;
use std::fmt::Write;
use std::process::Command;
use std::sync::OnceLock;
use surefoot::audit::{AuditOptions, audit};
use surefoot::bake::{BakeOptions, bake};
use surefoot::correct::{CorrectOptions, Corrected, correct, locals};
use surefoot::export::{Amended, amend, glb};
use surefoot::maths::seed::Seed;
use surefoot::mocap::{self, ClipFile, Options, Reading, bvh_write};
use surefoot::model::findings::{Findings, Rule};
use surefoot::model::{Capture, Role, Scenario};

const WALK: &str = "title = \"walk\"\nduration = 7.0\n[[walk]]\nstart = 0.3\nspeed = 1.2\n";

/// A GLB with a shove and a walk that the audit has nothing against: a walk as it is baked at 30 fps is corrected first.
pub fn walk_bytes() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let file = read("walk.glb", baked_bytes());
        let reading = file.reading(1, &Options::default()).expect("a clip");
        let corrected = correct(&reading.capture, &CorrectOptions::default());
        file_with(&file, &reading, 1, &corrected.capture)
    })
}

/// A GLB with a shove and a walk.
pub fn baked_bytes() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let rig = builtin();
        let baked = |scenario: &Scenario| {
            let baked = bake(&rig, scenario, &BakeOptions::default()).expect("bakes");
            (baked.clip, baked.report)
        };
        let walk = surefoot::model::scenario_text::parse("walk.toml", WALK).expect("a scenario");
        glb(&rig, &[baked(&Scenario::demo()), baked(&walk)]).expect("writes").bytes
    })
}

pub fn read(name: &str, bytes: &[u8]) -> ClipFile {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    mocap::read(name, bytes, &alone, None).expect("a clip file")
}

/// The walk, with its file.
fn walk() -> (ClipFile, Reading) {
    let file = read("walk.glb", walk_bytes());
    let reading = file.reading(1, &Options::default()).expect("a clip");
    (file, reading)
}

/// The file with another motion in its clip: what the writer makes of it.
pub fn file_with(file: &ClipFile, reading: &Reading, clip: usize, capture: &Capture) -> Vec<u8> {
    let corrected = as_if(reading, capture);
    let source = locals::Source::of(file, clip, reading).expect("no FBX");
    let edits = locals::edits(reading, &source, &corrected);
    let amended =
        Amended { animation: clip, start: reading.start, fps: reading.capture.fps, edits, speed: 1.0, extras: None };
    amend(file.document().expect("glTF"), file.nodes().expect("glTF"), &[amended]).expect("writes")
}

/// A correction that makes that of a clip.
pub fn as_if(reading: &Reading, capture: &Capture) -> Corrected {
    let found = audit(capture, &AuditOptions::default());
    let old = &reading.capture;
    let all: Vec<usize> = (0..capture.body.joints.len()).collect();
    let differs =
        |frame: &usize| old.at(*frame) != capture.at(*frame) || old.turns_at(*frame) != capture.turns_at(*frame);
    let changed = (0..old.frames()).filter(differs).map(|frame| (frame, all.clone())).collect();
    Corrected {
        capture: capture.clone(),
        changed,
        before: found.clone(),
        after: found,
        done: Vec::new(),
        slip: 0.0,
        speed: 1.0,
        notes: Vec::new(),
    }
}

fn faults(capture: &Capture) -> Vec<(&'static str, Rule, Planted)> {
    let seed = || Seed::new(3);
    let planted = |name, rule, planted: Option<Planted>| (name, rule, planted.expect(name));
    vec![
        planted("plant out", Rule::FootPlacement, audit_faults::moved_plant(capture, Way::Outward, 0.2, &mut seed())),
        planted("plant back", Rule::FootPlacement, audit_faults::moved_plant(capture, Way::Backward, 0.2, &mut seed())),
        planted("pelvis", Rule::Balance, audit_faults::moved_pelvis(capture, 0.25, &mut seed())),
        planted("lifted", Rule::Float, audit_faults::lifted(capture, 0.06, &mut seed())),
        planted("sunk", Rule::Penetration, audit_faults::lifted(capture, -0.06, &mut seed())),
        planted("slide", Rule::FootSlide, audit_faults::slide(capture, 0.2, &mut seed())),
    ]
}

fn flagged(findings: &Findings, span: (usize, usize)) -> Vec<Rule> {
    let near = findings.flags.iter().filter(|flag| flag.start <= span.1 + 6 && flag.end + 6 >= span.0);
    near.map(|flag| flag.rule).collect()
}

#[test]
fn a_clean_walk_is_given_back_to_the_bit() {
    let (_, reading) = walk();
    let corrected = correct(&reading.capture, &CorrectOptions::default());
    assert_eq!(corrected.before.flags, [], "the corrected walk is clean when it is read again");
    assert!(corrected.changed.is_empty() && corrected.done.is_empty());
    assert!(corrected.capture.positions == reading.capture.positions, "positions");
    assert!(corrected.capture.turns == reading.capture.turns, "turns");
}

#[test]
fn planted_faults_go_and_frames_that_were_not_changed_stay_to_the_bit() {
    let (_, reading) = walk();
    for (name, rule, planted) in faults(&reading.capture) {
        let corrected = correct(&planted.capture, &CorrectOptions::default());
        let found = flagged(&corrected.before, planted.span);
        assert!(found.contains(&rule), "{name}: found {found:?}");
        assert_eq!(flagged(&corrected.after, planted.span), [], "{name}: {:?}", corrected.done);
        assert_eq!(corrected.after.flags, [], "{name}: no new flag");
        assert!(corrected.slip < 0.005, "{name}: slips {} m", corrected.slip);
        let reach =
            corrected.done.iter().fold((usize::MAX, 0), |span, done| (span.0.min(done.start), span.1.max(done.end)));
        for frame in 0..reading.capture.frames() {
            if corrected.changed.contains_key(&frame) {
                assert!((reach.0..=reach.1).contains(&frame), "{name}: frame {frame} is in no repair");
                continue;
            }
            assert!(corrected.capture.at(frame) == planted.capture.at(frame), "{name}: frame {frame}");
            assert!(corrected.capture.turns_at(frame) == planted.capture.turns_at(frame), "{name}: frame {frame}");
        }
        assert!(corrected.changed.len() < reading.capture.frames() / 2, "{name}: {} frames", corrected.changed.len());
        let body = &reading.capture.body;
        let may = [
            Role::Hips,
            Role::LeftUpperLeg,
            Role::LeftLowerLeg,
            Role::LeftFoot,
            Role::RightUpperLeg,
            Role::RightLowerLeg,
            Role::RightFoot,
        ];
        for joint in corrected.changed.values().flatten() {
            let role = body.joints[*joint].role;
            assert!(may.contains(&role), "{name}: turned {role:?} relative to its parent");
        }
    }
}

#[test]
fn bones_keep_their_lengths() {
    let (_, reading) = walk();
    for (name, _, planted) in faults(&reading.capture) {
        let corrected = correct(&planted.capture, &CorrectOptions::default());
        let body = &reading.capture.body;
        for frame in corrected.changed.keys() {
            for (joint, parent) in (0..body.joints.len()).filter_map(|joint| Some((joint, body.joints[joint].parent?)))
            {
                let length = |capture: &Capture| capture.at(*frame)[joint].distance(capture.at(*frame)[parent]);
                let (was, is) = (length(&planted.capture), length(&corrected.capture));
                assert!((was - is).abs() < 1e-6, "{name}: frame {frame} joint {joint}: {was} became {is}");
            }
        }
    }
}

#[test]
fn only_the_rules_that_are_named_are_repaired() {
    let (_, reading) = walk();
    let planted = audit_faults::lifted(&reading.capture, 0.06, &mut Seed::new(3)).expect("room");
    let other = correct(&planted.capture, &CorrectOptions { only: vec![Rule::FootSlide], ..CorrectOptions::default() });
    assert!(other.changed.is_empty() && !other.after.flags.is_empty());
}

#[test]
fn a_clip_that_plays_too_slow_is_retimed_only_when_asked() {
    let (_, reading) = walk();
    let slow = Capture { fps: 0.6 * reading.capture.fps, ..reading.capture.clone() };
    let told = correct(&slow, &CorrectOptions::default());
    assert_eq!((told.speed, told.capture.fps), (1.0, slow.fps));
    if told.before.clip_flags.is_empty() {
        panic!("the slowed walk is not flagged");
    }
    assert!(told.notes.iter().any(|note| note.contains("--retime")), "{:?}", told.notes);
    let only = vec![Rule::Timing];
    let faster = correct(&slow, &CorrectOptions { retime: true, only, ..CorrectOptions::default() });
    assert!((faster.speed - 1.0 / 0.6).abs() < 0.35, "{}", faster.speed);
    assert_eq!(faster.after.clip_flags, []);
    assert!(faster.capture.positions == slow.positions, "poses stay");
}

#[test]
fn a_glb_keeps_its_bytes_its_other_clips_and_every_key_outside() {
    let (file, reading) = walk();
    let planted = audit_faults::moved_plant(&reading.capture, Way::Outward, 0.2, &mut Seed::new(3)).expect("a step");
    let spoiled = file_with(&file, &reading, 1, &planted.capture);
    let spoiled_file = read("walk.glb", &spoiled);
    let spoiled_reading = spoiled_file.reading(1, &Options::default()).expect("a clip");
    // The moved plant may stretch the leg, which rotations cannot show: what the file shows is what counts.
    let corrected = correct(&spoiled_reading.capture, &CorrectOptions::default());
    assert!(!corrected.before.flags.is_empty() && corrected.after.flags.is_empty(), "{:?}", corrected.after.flags);
    let source = locals::Source::of(&spoiled_file, 1, &spoiled_reading).expect("a clip");
    let edits = locals::edits(&spoiled_reading, &source, &corrected);
    let document = spoiled_file.document().expect("glTF");
    let clip = Amended {
        animation: 1,
        start: spoiled_reading.start,
        fps: spoiled_reading.capture.fps,
        edits,
        speed: 1.0,
        extras: None,
    };
    let bytes = amend(document, spoiled_file.nodes().expect("glTF"), &[clip]).expect("writes");
    let back_file = read("walk.glb", &bytes);
    let back = back_file.reading(1, &Options::default()).expect("a clip");
    let off = locals::written_off_by(&corrected.capture, &back.capture);
    assert!(off < 1e-4, "written {off} m off");
    assert_eq!(audit(&back.capture, &AuditOptions::default()).flags, []);
    // Frames outside: 0.01 mm is what is allowed, f32 keys that were not touched give nothing at all.
    for frame in (0..back.capture.frames()).filter(|frame| !corrected.changed.contains_key(frame)) {
        for (was, is) in spoiled_reading.capture.at(frame).iter().zip(back.capture.at(frame)) {
            assert!(was.distance(*is) < 1e-6, "frame {frame}: {}", was.distance(*is));
        }
    }
    let (old, new) = (document, back_file.document().expect("glTF"));
    assert!(new.buffers[0].starts_with(&old.buffers[0]), "the source's bytes are a prefix");
    for name in ["nodes", "meshes", "skins", "materials", "scenes", "images", "textures", "extensions", "extras"] {
        assert_eq!(old.json.get(name), new.json.get(name), "{name}");
    }
    assert_eq!(old.json["animations"][0], new.json["animations"][0], "the other clip");
    assert_eq!(
        old.json["animations"][1]["channels"].as_array().map(Vec::len),
        new.json["animations"][1]["channels"].as_array().map(Vec::len)
    );
    keys_outside_are_the_same(old, new, &corrected, &spoiled_reading);
}

#[test]
fn a_retimed_clip_keeps_its_keys_and_leaves_the_other_clip_alone() {
    let (file, reading) = walk();
    let document = file.document().expect("glTF");
    let fps = reading.capture.fps;
    let twice =
        Amended { animation: 1, start: reading.start, fps, edits: locals::Edits::new(), speed: 2.0, extras: None };
    let bytes = amend(document, file.nodes().expect("glTF"), &[twice]).expect("writes");
    let back = read("walk.glb", &bytes);
    assert_eq!(back.document().expect("glTF").json["animations"][0], document.json["animations"][0]);
    let faster = back.capture(1, &Options { fps: Some(2.0 * fps), ..Options::default() }).expect("a clip");
    assert_eq!(faster.frames(), reading.capture.frames());
    let off = locals::written_off_by(&reading.capture, &faster);
    assert!(off < 1e-5, "{off} m off");
}

fn keys_outside_are_the_same(
    old: &surefoot::rig::Document,
    new: &surefoot::rig::Document,
    corrected: &Corrected,
    reading: &Reading,
) {
    let changed: Vec<usize> = corrected.changed.keys().copied().collect();
    let (first, last) = (changed[0], changed[changed.len() - 1]);
    let seconds = |frame: usize| reading.start + frame as f64 / reading.capture.fps;
    let samplers = |document: &surefoot::rig::Document| {
        document.json["animations"][1]["samplers"].as_array().cloned().unwrap_or_default()
    };
    let mut compared = 0;
    for (was, is) in samplers(old).iter().zip(&samplers(new)) {
        let keys = |document: &surefoot::rig::Document, sampler: &Value| {
            let number = |name: &str| sampler[name].as_u64().expect("an index") as usize;
            let times = document.read_f32s(number("input"), "input").expect("times");
            let values = document.read_f32s(number("output"), "output").expect("values");
            let outside = |time: f64| time < seconds(first - 1) - 1e-3 || time > seconds(last + 1) + 1e-3;
            let at = |index: usize| f64::from(times.values[index]);
            let list: Vec<(u32, Vec<u32>)> = (0..times.values.len())
                .filter(|index| outside(at(*index)))
                .map(|index| {
                    let stride = if sampler["interpolation"] == "CUBICSPLINE" { 3 } else { 1 };
                    let elements = (stride * index..stride * (index + 1)).flat_map(|at| values.element(at));
                    (times.values[index].to_bits(), elements.map(|v| v.to_bits()).collect())
                })
                .collect();
            list
        };
        let (was, is) = (keys(old, was), keys(new, is));
        compared += was.len();
        assert_eq!(was, is);
    }
    assert!(compared > 100, "{compared} keys");
}

#[test]
fn a_bvh_keeps_the_characters_of_what_was_not_touched() {
    let (_, reading) = walk();
    let planted = audit_faults::lifted(&reading.capture, 0.06, &mut Seed::new(3)).expect("room");
    let text = bvh_of(&planted.capture);
    let file = read("walk.bvh", text.as_bytes());
    let reading = file.reading(0, &Options::default()).expect("a clip");
    let corrected = correct(&reading.capture, &CorrectOptions::default());
    assert!(!corrected.before.flags.is_empty() && corrected.after.flags.is_empty(), "{:?}", corrected.after.flags);
    let source = locals::Source::of(&file, 0, &reading).expect("a BVH");
    let edits = locals::edits(&reading, &source, &corrected);
    let written = bvh_write::write(&text, file.bvh().expect("a BVH"), &edits);
    let back = read("walk.bvh", written.as_bytes()).capture(0, &Options::default()).expect("a clip");
    let off = locals::written_off_by(&corrected.capture, &back);
    assert!(off < 1e-4, "written {off} m off");
    let head = text.find("MOTION").expect("a motion");
    assert_eq!(text[..head], written[..head]);
    let rows = |text: &str| -> Vec<String> { text[head..].lines().skip(3).map(str::to_owned).collect() };
    let mut same = 0;
    for (frame, (was, is)) in rows(&text).iter().zip(&rows(&written)).enumerate() {
        if corrected.changed.contains_key(&frame) {
            let words = was.split(' ').zip(is.split(' ')).filter(|(was, is)| was == is).count();
            assert!(words > was.split(' ').count() / 2, "frame {frame}: arms and spine stay");
        } else {
            assert_eq!(was, is, "frame {frame}");
            same += 1;
        }
    }
    assert!(same > 60, "{same} frames stay");
}

/// A capture as a BVH in centimetres.
fn bvh_of(capture: &Capture) -> String {
    fn joint(text: &mut String, capture: &Capture, index: usize, order: &mut Vec<usize>) {
        let body = &capture.body;
        let offset = body.offset(index) * 100.0;
        let kind = if index == 0 { "ROOT" } else { "JOINT" };
        let channels = if index == 0 { "6 Xposition Yposition Zposition" } else { "3" };
        writeln!(
            text,
            "{kind} {}\n{{\nOFFSET {:.6} {:.6} {:.6}\nCHANNELS {channels} Zrotation Xrotation Yrotation",
            body.joints[index].role.name(),
            offset.x,
            offset.y,
            offset.z
        )
        .expect("text");
        order.push(index);
        let children: Vec<usize> =
            (0..body.joints.len()).filter(|child| body.joints[*child].parent == Some(index)).collect();
        for child in &children {
            joint(text, capture, *child, order);
        }
        if children.is_empty() {
            text.push_str("End Site\n{\nOFFSET 0 0 5\n}\n");
        }
        text.push_str("}\n");
    }
    let (mut text, mut order) = (String::from("HIERARCHY\n"), Vec::new());
    joint(&mut text, capture, 0, &mut order);
    writeln!(text, "MOTION\nFrames: {}\nFrame Time: {:.7}", capture.frames(), 1.0 / capture.fps).expect("text");
    let mut before = vec![vec![0.0; 3]; order.len()];
    for frame in 0..capture.frames() {
        let hips = capture.at(frame)[0] * 100.0;
        let mut row = vec![format!("{:.6} {:.6} {:.6}", hips.x, hips.y, hips.z)];
        for index in &order {
            let turns = capture.turns_at(frame);
            let above = capture.body.joints[*index].parent.map_or(DQuat::IDENTITY, |parent| turns[parent]);
            let angles = bvh_write::angles(&[2, 0, 1], above.inverse() * turns[*index], &before[*index]);
            row.push(format!("{:.6} {:.6} {:.6}", angles[0], angles[1], angles[2]));
            before[*index] = angles;
        }
        writeln!(text, "{}", row.join(" ")).expect("text");
    }
    text
}

/// The program in a folder with that file: exit code, stdout, stderr.
fn run(folder: &std::path::Path, words: &str) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    let output = command.args(words.split_whitespace()).current_dir(folder).output().expect("the program was built");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

#[test]
fn the_command_writes_beside_and_never_over_the_original() {
    let (_, reading) = walk();
    let planted = audit_faults::lifted(&reading.capture, 0.06, &mut Seed::new(3)).expect("room");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("walk.bvh");
    std::fs::write(&path, bvh_of(&planted.capture)).expect("writes");
    let original = std::fs::read(&path).expect("reads");
    let (code, _, err) = run(folder.path(), "correct walk.bvh -o ./walk.bvh");
    assert!(code == 2 && err.contains("never overwritten"), "{code}: {err}");
    let (code, _, err) = run(folder.path(), "correct walk.bvh -o out.glb");
    assert!(code == 2 && err.contains(".bvh"), "{code}: {err}");
    let (code, _, err) = run(folder.path(), "correct walk.bvh -o out.bvh --rules nonsense");
    assert!(code == 2 && err.contains("foot-placement"), "{code}: {err}");
    let (code, out, err) = run(folder.path(), "correct walk.bvh -o out.bvh");
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("float") && out.contains("after none") && out.contains("lowered"), "{out}");
    let (code, out, _) = run(folder.path(), "correct walk.bvh -o out2.bvh --json -");
    assert_eq!(code, 0);
    let told: Value = serde_json::from_str(&out).expect("one JSON object");
    assert!(told["before"]["flags"].as_array().is_some_and(|flags| !flags.is_empty()));
    assert_eq!(told["after"]["flags"], Value::Array(Vec::new()));
    assert!(told["changed"].as_array().is_some_and(|changed| !changed.is_empty()));
    assert_eq!(told["clip"], "walk");
    let (_, audited, _) = run(folder.path(), "audit out.bvh --json -");
    let audited: Value = serde_json::from_str(&audited).expect("JSON");
    assert_eq!(audited["flags"], Value::Array(Vec::new()), "the file that was written is clean");
    assert_eq!(std::fs::read(folder.path().join("out.bvh")).ok(), std::fs::read(folder.path().join("out2.bvh")).ok());
    assert_eq!(std::fs::read(&path).expect("reads"), original);
}

#[test]
fn every_clip_of_a_file_is_corrected_and_a_clean_file_comes_out_byte_for_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("two.glb"), walk_bytes()).expect("writes");
    let (code, out, err) = run(folder.path(), "correct two.glb -o same.glb --clip walk");
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("nothing to correct"), "{out}");
    assert_eq!(std::fs::read(folder.path().join("same.glb")).expect("reads"), walk_bytes());
    let (code, out, _) = run(folder.path(), "correct two.glb -o all.glb --json -");
    assert_eq!(code, 0);
    let told: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(told.as_array().map(Vec::len), Some(2), "an array for several clips");
    let (code, _, err) = run(folder.path(), "correct two.glb -o x.glb --clip nobody");
    assert!(code == 2 && err.contains("nobody"), "{err}");
}
