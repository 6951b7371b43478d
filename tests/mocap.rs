//! Clips of every kind, as captured and keyed by others: sizes, ways, feet, writing back.

use super::data;
use super::rig_variants::nothing;
use glam::{DQuat, DVec3};
use std::path::{Path, PathBuf};
use surefoot::mocap::bvh::{Bvh, decode, encode};
use surefoot::mocap::bvh_write::{Edits, write};
use surefoot::mocap::{Options, load, read};
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

pub fn joint(capture: &Capture, role: Role) -> usize {
    capture.body.joint(role).unwrap_or_else(|| panic!("{} has no {}", capture.name, role.name()))
}

#[test]
fn every_clip_of_the_collection_gives_a_body_of_a_persons_size_that_stands_on_its_feet() {
    let Some(data) = data::folder() else { return };
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
        // The lower foot is below the hips in most frames of all that is not a fall, a seat or a dive.
        let lies = [
            "death", "lie", "sit", "roll", "dead", "dash", "air", "swim", "jump", "slide", "crawl", "floor", "dodge",
            "crouch", "kneel",
        ];
        if lies.iter().any(|word| clip.to_lowercase().contains(word)) {
            return;
        }
        let (hips, feet) = (joint(capture, Role::Hips), capture.body.feet.each_ref().map(|foot| foot.ankle));
        let below = |frame: &usize| {
            let at = capture.at(*frame);
            let over = feet.iter().map(|foot| at[hips].y - at[*foot].y).fold(f64::MIN, f64::max);
            over > if short { 0.25 } else { 0.5 } * leg
        };
        let share = (0..capture.frames()).filter(below).count() as f64 / capture.frames() as f64;
        if share < 0.6 {
            odd.push(format!("{place}: a foot below the hips in {share:.2} of the frames"));
        }
    });
    assert!(odd.is_empty(), "{odd:#?}");
    assert!(count > 150, "{count} clips");
}

#[test]
fn units_and_axes_of_real_files_are_found() {
    let Some(data) = data::folder() else { return };
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
    let Some(data) = data::folder() else { return };
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
    let Some(data) = data::folder() else { return };
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
    let Some(data) = data::folder() else { return };
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
    let Some(data) = data::folder() else { return };
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
