//! What `--engine` writes beside a clip: whole or not at all, the same bytes twice, one row of the table each.
//!
//! A baked clip with its helpers stays in target/engines, where tests/tools runs them: in Chromium, in Bevy, in Blender, and the names of clips in
//! the helpers for Godot and Unreal without those.

use crate::data;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use surefoot::export::engine::{ENGINES, Engine};

/// Runs `surefoot` in a folder: exit code, stdout, stderr.
fn run(folder: &Path, words: &str) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    command.args(words.split_whitespace()).current_dir(folder).env("NO_COLOR", "1");
    let Output { status, stdout, stderr } = command.output().expect("the program was built");
    let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
    (status.code().unwrap_or(-1), text(stdout), text(stderr))
}

fn listing(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the test's own folder");
    let mut names: Vec<String> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn every_engine_gets_its_helper_beside_the_clip() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/engines");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("target can be written");
    let all =
        "bake builtin --demo --drive stepper --engine three,blender --engine bevy,godot,unity --engine unreal,three";
    let (code, out, err) = run(&folder, &format!("{all} -o shove.glb"));
    assert_eq!(code, 0, "{err}");
    let mut wanted: Vec<String> = ENGINES.iter().map(|engine| engine.file.to_owned()).collect();
    wanted.extend(["shove.glb".into(), "shove.events.json".into()]);
    wanted.sort();
    assert_eq!(listing(&folder), wanted);
    for engine in &ENGINES {
        assert!(out.contains(engine.file), "the summary names {}", engine.file);
        assert_eq!(fs::read(folder.join(engine.file)).expect("there"), engine.helper(), "{}", engine.name);
    }
    // Again, over its own results, and as a VRM animation beside it: the helpers serve both.
    let before: Vec<Vec<u8>> = wanted.iter().map(|name| fs::read(folder.join(name)).expect("there")).collect();
    let (code, _, err) = run(&folder, &format!("{all} -o shove.glb"));
    assert_eq!(code, 0, "{err}");
    let after: Vec<Vec<u8>> = wanted.iter().map(|name| fs::read(folder.join(name)).expect("there")).collect();
    assert!(before == after, "the same bytes twice");
    let (code, out, err) = run(&folder, "bake builtin --demo --drive stepper --engine three -o shove_vrm.vrma --json");
    assert_eq!(code, 0, "{err}");
    let told: serde_json::Value = serde_json::from_str(&out).expect("one object");
    assert_eq!(told["helpers"][0], "surefoot_three.js");
    assert_eq!(told["output"], "shove_vrm.vrma");
    assert!(folder.join("shove_vrm.events.json").is_file());
}

#[test]
fn helpers_say_what_their_engine_wants_and_whether_they_were_run() {
    for engine in &ENGINES {
        let text = String::from_utf8(engine.helper()).expect("UTF-8");
        assert!(!text.contains("{{") && !text.contains('\r') && text.ends_with('\n'), "{}", engine.name);
        let head: String = text.lines().take(14).collect::<Vec<_>>().join("\n");
        for part in [engine.axes, engine.units, engine.events, engine.looped, engine.root] {
            assert!(head.contains(part), "{}: the head lacks `{part}`", engine.name);
        }
        let unrun = head.contains("NOT RUN");
        assert_eq!(unrun, engine.run_in.is_none(), "{}", engine.name);
        assert_eq!(unrun, ["godot", "unity", "unreal"].contains(&engine.name), "{}", engine.name);
        for foot in engine.feet {
            assert!(text.contains(&format!("\"{foot}\"")), "{}: {foot}", engine.name);
        }
        assert!(text.lines().count() < 160, "{}: short", engine.name);
        assert_eq!(Engine::named(engine.name), Some(engine));
    }
    assert_eq!(Engine::named("Unreal"), None, "names are as they are listed");
}

#[test]
fn helpers_promise_only_what_their_engine_can() {
    let text = |name: &str| String::from_utf8(Engine::named(name).expect("listed").helper()).expect("UTF-8");
    // glTFast makes no Avatar; a .anim that is replaced loses what refers to it; an asset that is not saved is lost.
    for (engine, words) in [
        ("unity", &["-o take.fbx", "without an Avatar", "EditorUtility.CopySerialized", "none of it run"] as &[&str]),
        ("unreal", &["save_loaded_asset", "key=len", "Read in Unreal's documentation only"]),
        ("godot", &["validate_node_name", "push_warning", "Read in Godot's documentation only"]),
        ("blender", &["frame_end", "action_slot", "drop_contacts"]),
    ] {
        for word in words {
            assert!(text(engine).contains(word), "{engine}: {word}");
        }
    }
    for (engine, joint) in [("blender", true), ("godot", true), ("unreal", true), ("unity", false), ("three", false)] {
        assert_eq!(Engine::named(engine).expect("listed").root_is_joint, joint, "{engine}");
    }
}

#[test]
fn an_engine_that_there_is_none_of_is_refused_with_the_list() {
    let folder = tempfile::tempdir().expect("a folder");
    for words in ["--engine cryengine", "--engine three,cryengine", "--engine Unity", "--engine="] {
        let (code, _, err) = run(folder.path(), &format!("bake builtin --demo -o a.glb {words}"));
        assert_eq!(code, 2, "{words}: {err}");
        assert!(err.contains("three, blender, bevy, godot, unity, unreal"), "{words}: {err}");
    }
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn nothing_is_written_where_one_helper_cannot_be() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("surefoot_bevy.rs")).expect("the test's own folder");
    let (code, _, err) = run(folder.path(), "bake builtin --demo --drive stepper --engine three,bevy -o a.glb");
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("surefoot_bevy.rs: this is a folder"), "{err}");
    assert_eq!(listing(folder.path()), ["surefoot_bevy.rs"]);
    // Nor may a clip take a helper's name away, or an input be overwritten by one.
    fs::write(folder.path().join("SurefootEvents.cs"), "title = \"mine\"\n").expect("the test's own folder");
    let (code, _, err) = run(folder.path(), "bake builtin SurefootEvents.cs --engine unity -o a.glb");
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("never overwritten"), "{err}");
}

#[test]
fn root_motion_that_an_engine_cannot_take_is_warned_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let bake = |root: &str| {
        let words = format!("bake builtin --demo --drive stepper --root {root} --engine unreal,three -o a.glb");
        let (code, _, err) = run(folder.path(), &words);
        assert_eq!(code, 0, "{err}");
        err
    };
    let told = bake("hips");
    assert!(told.contains("Unreal Engine takes root motion from the skeleton's root bone"), "{told}");
    assert!(!told.contains("three.js"), "{told}");
    assert!(!bake("root").contains("Unreal"));
}

/// Each skin's joints, and how many inverse bind matrices it has.
fn skins(file: &Path) -> Vec<(Vec<u64>, Option<u64>)> {
    let bytes = fs::read(file).expect("there");
    gltf::Gltf::from_slice(&bytes).expect("the gltf crate reads it");
    let (json, _) = crate::export::json_of(&bytes);
    let numbers =
        |list: &serde_json::Value| list.as_array().expect("joints").iter().filter_map(|one| one.as_u64()).collect();
    let skins = json["skins"].as_array().cloned().unwrap_or_default();
    let count = |skin: &serde_json::Value| {
        let accessor = skin["inverseBindMatrices"].as_u64()? as usize;
        json["accessors"][accessor]["count"].as_u64()
    };
    skins.iter().map(|skin| (numbers(&skin["joints"]), count(skin))).collect()
}

#[test]
fn a_new_root_is_a_bone_where_the_engine_wants_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(data) = data::folder() else { return };
    // One has no root, and nodes between the scene and its joints; one has a root that is no joint; one is right as it is.
    for (source, joined) in [("khronos_CesiumMan.gltf", 3), ("gdquest_mannequiny.glb", 1), ("m2m_human_male.glb", 0)] {
        root_as_bone(folder.path(), &data.join("rigs").join(source), source, joined);
    }
}

fn root_as_bone(folder: &Path, rig: &Path, source: &str, joined: usize) {
    let bake = |engine: &str, root: &str| {
        let words = format!("bake {} --demo --drive stepper {engine} --root {root} -o a.glb", rig.display());
        let (code, _, err) = run(folder, &words);
        assert_eq!(code, 0, "{err}");
        (skins(&folder.join("a.glb")), err)
    };
    let (plain, _) = bake("", "root");
    assert_eq!(bake("--engine three,bevy,unity", "root").0, plain);
    assert_eq!(bake("--engine unreal", "in-place").0, plain);
    for engine in ["unreal", "godot", "blender"] {
        let (with, err) = bake(&format!("--engine {engine}"), "root");
        assert_eq!(err.contains("joined it as a root bone"), joined > 0, "{source}: {err}");
        let json = crate::export::json_of(&fs::read(folder.join("a.glb")).expect("there")).0;
        let is_root =
            |node: &serde_json::Value| node["name"].as_str().is_some_and(|name| name.eq_ignore_ascii_case("root"));
        let root = json["nodes"].as_array().expect("nodes").iter().position(is_root).expect("a root");
        for ((before, matrices), (after, more)) in plain.iter().zip(&with) {
            assert!(after.starts_with(before), "joints keep their places");
            assert!(after.contains(&(root as u64)), "{source} {engine}: the root is no joint");
            assert_eq!(after.len(), before.len() + joined, "{source} {engine}");
            assert_eq!(
                more.map(|more| more - matrices.unwrap_or(0)),
                matrices.map(|_| (after.len() - before.len()) as u64)
            );
        }
        // The skin hangs as it did.
        let mesh = |path: &Path| surefoot::rig::load(path).expect("loads").mesh;
        for (before, after) in mesh(rig).iter().zip(&mesh(&folder.join("a.glb"))) {
            let off = before.positions.iter().zip(&after.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(off < 1e-5 && before.positions.len() == after.positions.len(), "{source} {engine}: {off} m");
        }
        // For the Khronos validator.
        let kept = crate::export::baked_path(&format!("root_bone_{engine}_{source}.glb"));
        fs::copy(folder.join("a.glb"), &kept).expect("can be written");
        fs::write(kept.with_extension("glb.source"), source).expect("can be written");
    }
}

#[test]
fn props_have_no_place_in_a_vrm_animation() {
    let folder = tempfile::tempdir().expect("a folder");
    let (code, _, err) = run(folder.path(), "bake builtin --demo --props -o a.vrma");
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("holds no meshes") && err.contains("help:"), "{err}");
    let (code, _, err) = run(folder.path(), "bake builtin --demo -o a.dae");
    assert!(code == 2 && err.contains(".vrma") && err.contains(".fbx"), "{err}");
    assert!(listing(folder.path()).is_empty());
}

#[test]
fn the_audit_takes_a_baked_vrm_animation() {
    let folder = tempfile::tempdir().expect("a folder");
    let (code, _, err) = run(folder.path(), "bake builtin --demo --drive stepper -o a.vrma");
    assert_eq!(code, 0, "{err}");
    let (code, out, err) = run(folder.path(), "audit a.vrma --strict");
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("shove_from_the_left") && out.contains("no flags"), "{out}");
}
