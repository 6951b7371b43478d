//! The kinds of file at the shell: skeleton and clip alone, without the contact nodes, and who carries the travel.

use crate::data;
use crate::export::json_of;
use crate::shell::Shell;
use glam::DVec3;
use serde_json::Value;
use surefoot::rig::{Rig, clips, load};

/// Node names by parents, and rest pose: what programs bind by.
fn skeleton(json: &Value) -> Vec<Value> {
    let of = |node: &Value| {
        let kept = ["name", "children", "translation", "rotation", "scale", "matrix"];
        Value::from_iter(kept.iter().map(|key| ((*key).to_owned(), node[*key].clone())))
    };
    json["nodes"].as_array().expect("nodes").iter().map(of).collect()
}

/// Joint places of a file's clip over its duration, m.
fn played(rig: &Rig, clip: usize) -> Vec<Vec<DVec3>> {
    let clip = clips::read_clip(rig, clip).expect("a clip");
    let mut sampler = rig.sampler(&clip);
    (0..=40).map(|tick| sampler.sample(clip.duration * f64::from(tick) / 40.0).positions).collect()
}

/// Leaves a file for tests/tools/onto_check.mjs, which plays the animation on the character in other programs.
fn left_for_players(name: &str, kind: &str, bytes: &[u8]) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/alone");
    std::fs::create_dir_all(&folder).expect("target can be written");
    std::fs::write(folder.join(format!("{name}.{kind}.glb")), bytes).expect("target can be written");
}

/// Asks a bake for the whole file and for the animation alone, and compares them.
fn alone(shell: &Shell, name: &str, rig: &str) {
    let ok = |words: &str| {
        let told = shell.run(words);
        assert_eq!(told.code, 0, "{words}: {}{}", told.out, told.err);
        told
    };
    ok(&format!("bake {rig} --demo --root root -o whole.glb"));
    ok(&format!("bake {rig} --demo --root root --only-animation -o alone.glb"));
    let (whole, alone) = (std::fs::read(shell.path("whole.glb")), std::fs::read(shell.path("alone.glb")));
    let (whole, alone) = (whole.expect("written"), alone.expect("written"));
    for (kind, bytes) in [("whole", &whole), ("alone", &alone)] {
        left_for_players(name, kind, bytes);
    }
    let ((json, _), (alone_json, _)) = (json_of(&whole), json_of(&alone));
    for gone in ["meshes", "materials", "textures", "images", "cameras", "samplers", "extensions", "extensionsRequired"]
    {
        assert!(alone_json.get(gone).is_none(), "{rig}: {gone} are left");
    }
    assert_eq!(skeleton(&json), skeleton(&alone_json), "{rig}");
    let last = json["animations"].as_array().expect("clips").len() - 1;
    assert_eq!(alone_json["animations"].as_array().expect("clips").len(), 1, "{rig}: its own clip alone");
    for key in ["name", "extras"] {
        assert_eq!(json["animations"][last][key], alone_json["animations"][0][key], "{rig}: {key}");
    }
    gltf::Gltf::from_slice(&alone).expect("the gltf crate reads it");
    assert!(alone.len() < 150_000, "{rig}: {} bytes", alone.len());
    // Played on the character that is there: the clip's nodes are the rig's.
    let whole_rig = load(&shell.path("whole.glb")).expect("a rig");
    let mut other = whole_rig.clone();
    let stripped = surefoot::rig::Document::parse("alone.glb", &alone, &|_| Err(std::io::ErrorKind::NotFound.into()));
    other.document = stripped.expect("a document");
    for (at, (a, b)) in played(&whole_rig, last).iter().zip(&played(&other, 0)).enumerate() {
        let off = a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(off < 1e-9, "{rig}: {off} m at sample {at}");
    }
    let told = ok("audit alone.glb --json -");
    assert!(told.out.contains("\"frames\""), "{rig}: an audit reads it");
}

#[test]
fn an_animation_alone_has_the_skeleton_the_clip_and_its_report_and_nothing_that_is_drawn() {
    left_for_players("builtin", "rig", surefoot::rig::mannequin::BUILTIN);
    alone(&Shell::new(), "builtin", "builtin");
}

#[test]
fn an_animation_alone_of_third_party_rigs_too() {
    for name in ["m2m_human_base_animations.glb", "kaykit_Knight.glb", "godette_vrm0.vrm"] {
        let Some(path) = data::file(&format!("rigs/{name}")) else { return };
        left_for_players(name, "rig", &std::fs::read(&path).expect("it is there"));
        alone(&Shell::new(), name, &path.display().to_string());
    }
}

/// The GLB files of a folder: name, bytes.
fn sizes(shell: &Shell, folder: &str) -> Vec<(String, u64)> {
    let files = shell.files().into_iter().filter(|name| name.starts_with(folder) && name.ends_with(".glb"));
    let size = |name: &String| std::fs::metadata(shell.path(name)).map_or(0, |about| about.len());
    files.map(|name| (name.clone(), size(&name))).collect()
}

#[test]
fn a_batch_of_animations_alone_is_small_and_merges() {
    let sweep =
        "scenario = \"shove.toml\"\nname = \"s{seed}\"\n[vary]\nseed = [1, 2, 3]\n[bake]\ndrive = \"stepper\"\n";
    let shell = Shell::with(&[("sweep.toml", sweep)]);
    for words in [
        "new scenario -o shove.toml",
        "batch sweep.toml -o whole --no-sheet",
        "batch sweep.toml -o alone --no-sheet --only-animation",
        "batch sweep.toml -o merged --no-sheet --only-animation --merge",
    ] {
        let told = shell.run(words);
        assert_eq!(told.code, 0, "{words}: {}{}", told.out, told.err);
    }
    let [whole, alone, merged] = ["whole", "alone", "merged"].map(|folder| sizes(&shell, folder));
    assert_eq!((whole.len(), alone.len(), merged.len()), (3, 3, 1));
    assert!(alone.iter().zip(&whole).all(|(alone, whole)| alone.1 < whole.1), "{alone:?} {whole:?}");
    let file = std::fs::read(shell.path(&merged[0].0)).expect("written");
    let (json, _) = json_of(&file);
    assert!(json.get("meshes").is_none());
    assert_eq!(json["animations"].as_array().expect("clips").len(), 3);
    let told = shell.run("batch sweep.toml -o both --only-animation --openjd job");
    assert_eq!(told.code, 2, "a farm reads the sweep, not the flag: {}", told.err);
}

#[test]
fn a_retargeted_and_a_corrected_clip_can_be_written_alone() {
    let shell = Shell::new();
    for words in [
        "bake builtin --demo -o shoved.glb",
        "retarget shoved.glb builtin -o retargeted.glb --only-animation --no-contact-nodes",
        "correct shoved.glb -o corrected.glb --only-animation",
    ] {
        let told = shell.run(words);
        assert_eq!(told.code, 0, "{words}: {}{}", told.out, told.err);
    }
    for name in ["retargeted.glb", "corrected.glb"] {
        let file = std::fs::read(shell.path(name)).expect("written");
        let (json, _) = json_of(&file);
        assert!(json.get("meshes").is_none() && json["animations"].as_array().is_some_and(|clips| clips.len() == 1));
        let helpers = json["nodes"].as_array().expect("nodes").iter().filter(|node| node["name"] == "contact_L");
        assert_eq!(helpers.count(), usize::from(name == "corrected.glb"), "{name}");
    }
}

#[test]
fn a_clip_without_contact_nodes_has_none_and_is_the_same_motion() {
    let shell = Shell::new();
    for words in ["bake builtin --demo -o with.glb", "bake builtin --demo -o without.glb --no-contact-nodes"] {
        assert_eq!(shell.run(words).code, 0, "{words}");
    }
    let [with, without] = ["with.glb", "without.glb"].map(|name| load(&shell.path(name)).expect("a rig"));
    assert_eq!(with.nodes.len(), without.nodes.len() + 2);
    assert!(without.nodes.iter().all(|node| node.name.as_deref().is_none_or(|name| !name.starts_with("contact_"))));
    assert_eq!(played(&with, 0), played(&without, 0));
}

#[test]
fn a_rig_without_a_root_bone_says_who_carries_its_travel() {
    let Some(path) = data::file("rigs/khronos_CesiumMan.gltf") else { return };
    let (shell, rig) = (Shell::new(), path.display().to_string());
    for (words, root, says) in [
        ("", "root", "new node `Root`"),
        ("--engine unity", "hips", "for Unity the travel is in its hips"),
        ("--engine blender", "root", "for Blender the travel is on a new bone `Root`"),
        ("--only-animation", "hips", "the travel is in its hips"),
        ("--root hips", "hips", ""),
    ] {
        let told = shell.run(&format!("bake {rig} --demo -o out.glb --json {words}"));
        assert_eq!(told.code, 0, "{words}: {}", told.err);
        let made: Value = serde_json::from_str(&told.out).expect("one object");
        assert_eq!(made["report"]["root_motion"], root, "{words}");
        let said = made["warnings"].as_array().expect("warnings").iter().any(|one| {
            one.as_str().is_some_and(|one| one.contains("root bone") && !says.is_empty() && one.contains(says))
        });
        assert_eq!(said, !says.is_empty(), "{words}: {}", told.out);
    }
}
