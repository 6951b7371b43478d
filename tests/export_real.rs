//! Rigs that nobody here made, baked and read back; the files stay in target/baked for the scripts of tests/tools.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::data;
use crate::export::{MODES, baked_path, dump_pose, json_of, keeps_everything, reads_back, report};
use crate::synthetic::{DURATION, held};
use glam::{DQuat, DVec3};
use std::path::PathBuf;
use surefoot::bake::RootMotion;
use surefoot::bake::keys::{Curves, KeyInput, keyed_clip};
use surefoot::export::glb;
use surefoot::model::BodyPose;
use surefoot::model::report::Outcome;
use surefoot::rig::Rig;

/// The rigs of the data folder that load, by file name.
fn real_rigs() -> Vec<(String, Rig)> {
    let Some(data) = data::more() else { return Vec::new() };
    let entries = std::fs::read_dir(data.join("rigs")).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
    paths.iter().filter_map(|path| Some((name(path)?, surefoot::rig::load(path).ok()?))).collect()
}

/// A motion for any body: hips that travel, turn and bob, limbs that swing, feet that go along. Nothing is planted.
fn waving(rig: &Rig, time: f64) -> BodyPose {
    let mut pose = BodyPose::rest(&rig.body);
    let size = rig.body.height / 1.7;
    let envelope = (std::f64::consts::PI * time / DURATION).sin().powi(2);
    pose.hips += DVec3::new(0.05 * (4.0 * time).sin() * envelope, -0.05 * envelope, 0.2 * time) * size;
    for (index, joint) in rig.body.joints.iter().enumerate() {
        let wave = envelope * 0.1 * (3.0 * time + index as f64).sin();
        let own = DQuat::from_rotation_x(wave) * DQuat::from_rotation_y(2.0 * wave) * DQuat::from_rotation_z(-wave);
        pose.turns[index] = match joint.parent {
            None => DQuat::from_rotation_y(0.5 * time / DURATION) * own,
            Some(parent) if !joint.animated => pose.turns[parent],
            Some(parent) => pose.turns[parent] * own,
        };
    }
    pose
}

#[test]
fn real_rigs_keep_everything_and_show_the_pose() {
    for (name, rig) in real_rigs() {
        for mode in MODES {
            let pose = |time: f64| waving(&rig, time);
            let input = KeyInput {
                rig: &rig,
                name: "shove",
                fps: 30.0,
                duration: DURATION,
                pose: &pose,
                contacts: &[],
                root_motion: mode,
                curves: Curves::Linear,
            };
            let clip = keyed_clip(&input);
            let made = glb(&rig, &[(clip.clone(), report(&clip))]).expect("can be written");
            let file = format!("{name}.{}.glb", mode.name());
            std::fs::write(baked_path(&file), &made.bytes).expect("can be written");
            std::fs::write(baked_path(&format!("{file}.source")), &name).expect("can be written");
            keeps_everything(&rig, &made.bytes, &made.changes);
            reads_back(&rig, &clip, &made.bytes);
            dump_pose(&rig, &clip, &made.names[0], &file);
            if mode == RootMotion::InPlace {
                continue;
            }
            let mut sampler = rig.sampler(&clip);
            let mut worst = (0.0, 0.0, None);
            for tick in 0..=90 {
                let time = DURATION * f64::from(tick) / 90.0;
                let (wanted, got) = (pose(time), sampler.sample(time));
                for (joint, (wanted, got)) in wanted.positions(&rig.body).iter().zip(&got.positions).enumerate() {
                    let off = wanted.distance(*got) / rig.body.height;
                    if off > worst.0 {
                        worst = (off, time, Some(rig.body.joints[joint].role));
                    }
                }
            }
            println!("{name} {}: {:.2} mm a metre of height at worst {worst:?}", mode.name(), worst.0 * 1e3);
            assert!(worst.0 < 4e-3, "{name} {mode:?}: {worst:?}");
        }
    }
}

#[test]
fn real_bakes_keep_their_feet_with_few_keys() {
    let mannequin = surefoot::rig::mannequin::mannequin(&surefoot::rig::mannequin::MannequinOptions::default());
    let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let builtin = surefoot::rig::load_bytes("builtin", &mannequin, &none, None).expect("the built-in rig loads");
    let scenario = surefoot::model::scenario::Scenario::demo();
    for (name, rig) in [("builtin".to_owned(), builtin)].into_iter().chain(real_rigs()) {
        let baked = match surefoot::bake::bake(&rig, &scenario, &surefoot::bake::BakeOptions::default()) {
            Ok(baked) => baked,
            Err(error) => panic!("{name}: {error}"),
        };
        let timeline = &baked.performance.timeline;
        let exact = |time: f64| {
            let pose = timeline.pose_at(time);
            let positions = pose.positions(&rig.body);
            surefoot::rig::animate::SampledPose { hips: pose.hips, turns: pose.turns, positions }
        };
        let start = std::time::Instant::now();
        let keyed = |curves: Curves| {
            keyed_clip(&KeyInput {
                rig: &rig,
                name: "shove",
                fps: 30.0,
                duration: timeline.duration(),
                pose: &|time| timeline.pose_at(time),
                contacts: &baked.performance.contacts,
                root_motion: RootMotion::Root,
                curves,
            })
        };
        let clip = keyed(Curves::Linear);
        let spent = start.elapsed().as_secs_f64() * 1e3;
        let mut sampler = rig.sampler(&clip);
        let (mut slip, mut exact_slip): (f64, f64) = (0.0, 0.0);
        for contact in &baked.performance.contacts {
            let (start, exact_start) =
                (held(&rig, &sampler.sample(contact.start), contact), held(&rig, &exact(contact.start), contact));
            for tick in 0..=((contact.end - contact.start) * 120.0).ceil() as usize {
                let time = (contact.start + tick as f64 / 120.0).min(contact.end);
                let now = held(&rig, &sampler.sample(time), contact);
                slip = start.iter().zip(&now).map(|(a, b)| a.distance(*b)).fold(slip, f64::max);
                let now = held(&rig, &exact(time), contact);
                exact_slip = exact_start.iter().zip(&now).map(|(a, b)| a.distance(*b)).fold(exact_slip, f64::max);
            }
        }
        let made = glb(&rig, &[(clip.clone(), baked.report.clone())]).expect("can be written");
        let file = format!("bake_{name}.glb");
        std::fs::write(baked_path(&file), &made.bytes).expect("can be written");
        std::fs::write(baked_path(&format!("{file}.source")), &name).expect("can be written");
        keeps_everything(&rig, &made.bytes, &made.changes);
        reads_back(&rig, &clip, &made.bytes);
        dump_pose(&rig, &clip, &made.names[0], &file);
        // Splines need few; straight lines take more keys and fewer bytes.
        let curves = keyed(Curves::Spline);
        let keys: usize = curves.channels.iter().map(|channel| channel.times.len()).sum();
        let frames = (clip.duration * clip.fps) as usize + 1;
        let share = keys as f64 / (frames * clip.channels.len()) as f64;
        let (json, bin) = json_of(&made.bytes);
        let before = rig.document.json.to_string().len() + rig.document.buffers.iter().map(Vec::len).sum::<usize>();
        let added = (json.to_string().len() + bin.len()).saturating_sub(before); // 0 where a data: uri went away
        println!(
            "{name}: {:.1} s, slip {:.2} mm (pose {:.2}), {keys} keys on {} channels, {:.1} %, {:.1} kB, {spent:.1} ms",
            clip.duration,
            slip * 1e3,
            exact_slip * 1e3,
            clip.channels.len(),
            share * 1e2,
            added as f64 / 1e3
        );
        assert!(slip < exact_slip + 0.3e-3, "{name}: {slip} m, the pose itself {exact_slip} m");
        // Where little but legs has bones, theirs are most of the keys.
        let most = if clip.channels.len() > 30 { 0.21 } else { 0.3 };
        let fell = baked.report.outcome == Outcome::Fall; // a short clip that moves in every frame
        assert!(fell || share < most, "{name}: {share}");
    }
}

#[test]
fn the_khronos_validator_finds_nothing_that_the_source_did_not_have() {
    if std::env::var_os("SUREFOOT_NODE_MODULES").is_none() {
        println!("skipped: SUREFOOT_NODE_MODULES does not say where gltf-validator is");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |rig: &Rig, file: &str, source: &str| {
        let pose = |time: f64| waving(rig, time);
        let (name, fps, duration, contacts, root_motion) = ("shove", 30.0, DURATION, &[], RootMotion::Root);
        let clip = keyed_clip(&KeyInput {
            rig,
            name,
            fps,
            duration,
            pose: &pose,
            contacts,
            root_motion,
            curves: Curves::Linear,
        });
        let made = glb(rig, &[(clip.clone(), report(&clip))]).expect("can be written");
        std::fs::write(folder.path().join(format!("{file}.glb")), &made.bytes).expect("can be written");
        std::fs::write(folder.path().join(format!("{file}.glb.source")), source).expect("can be written");
    };
    for (name, trouble) in crate::synthetic::troubles() {
        write(&crate::synthetic::rig(trouble), name, "none");
    }
    for (name, rig) in real_rigs() {
        write(&rig, &name, &name);
    }
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let sources = data::place().join("rigs");
    let mut node = std::process::Command::new("node");
    let output = node.arg(root.join("tests/tools/validate.mjs")).arg(folder.path()).arg(sources).output();
    let output = output.expect("node runs");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{said}");
    assert!(output.status.success() && !said.contains("skipped"), "{said}{}", String::from_utf8_lossy(&output.stderr));
}
