//! FBX rigs that are read: as the same character as GLB, and their clips back onto them.
//!
//! The files are made here of the built-in rig (`fbx_text`); those of the data folder are read where it is.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::data;
use crate::export::report;
use crate::fbx_out::{made_path, open, places};
use crate::fbx_text::{CENTIMETRES, Written, text};
use crate::vrma::clip;
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;
use surefoot::bake::{BakeOptions, RootMotion, bake};
use surefoot::export::{fbx, glb};
use surefoot::mocap::{self, Options};
use surefoot::model::{Role, Scenario};
use surefoot::rig::{Rig, RigError, load_bytes};

fn nothing(_: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::Error::from(std::io::ErrorKind::NotFound))
}

fn read(name: &str, bytes: &[u8]) -> Result<Rig, RigError> {
    load_bytes(name, bytes, &nothing, None)
}

fn of_text(written: Written) -> Rig {
    read("made.fbx", text(&builtin(), written).as_bytes()).expect("a rig")
}

/// mm: the farthest that a joint of the body stands from the other rig's.
fn apart(one: &Rig, other: &Rig) -> f64 {
    let place = |rig: &Rig, role: Role| rig.body.joint(role).map(|joint| rig.body.joints[joint].rest);
    let both = Role::ALL.iter().filter_map(|role| Some(place(one, *role)?.distance(place(other, *role)?)));
    both.fold(0.0, f64::max) * 1e3
}

#[test]
fn an_fbx_of_any_unit_and_axes_is_the_character_that_its_glb_is() {
    let own = builtin();
    for (what, written) in [
        ("centimetres", CENTIMETRES),
        ("metres", Written { unit: 100.0, ..CENTIMETRES }),
        ("inches", Written { unit: 2.54, ..CENTIMETRES }),
        ("Z up", Written { z_up: true, ..CENTIMETRES }),
        ("Z up in metres", Written { z_up: true, unit: 100.0, ..CENTIMETRES }),
    ] {
        let rig = of_text(written);
        assert_eq!(rig.mapping.bones.len(), own.mapping.bones.len(), "{what}");
        assert!(apart(&own, &rig) < 0.05, "{what}: {} mm", apart(&own, &rig));
        let (feet, others) = (&own.body.feet, &rig.body.feet);
        for (foot, other) in feet.iter().zip(others) {
            assert!((foot.ankle_height - other.ankle_height).abs() < 1e-3, "{what}: soles are of the mesh");
        }
        assert!((rig.body.height - own.body.height).abs() < 1e-3, "{what}: {} m", rig.body.height);
        assert_eq!(rig.mesh.len(), own.mesh.len(), "{what}: a part a material");
        let colour = rig.mesh[0].base_color;
        assert!((colour[0] - 0.25).abs() < 0.01 && (colour[2] - 0.75).abs() < 0.01, "{what}: {colour:?}");
        let most = rig
            .mesh
            .iter()
            .flat_map(|part| &part.weights)
            .map(|four| (four.iter().map(|(_, share)| share).sum::<f64>() - 1.0).abs());
        assert!(most.fold(0.0, f64::max) < 1e-5, "{what}: weights sum to one");
        assert!(rig.mapping.warnings.iter().any(|note| note.contains("more than 4 weights")), "{what}: it is told");
    }
}

#[test]
fn a_take_baked_onto_an_fbx_has_its_names_hierarchy_and_rest() {
    for written in [CENTIMETRES, Written { prefix: "mixamorig:", unit: 100.0, ..CENTIMETRES }] {
        let source = text(&builtin(), written);
        let rig = read("made.fbx", source.as_bytes()).expect("a rig");
        let made = fbx(&rig, &clip(&rig, RootMotion::Root), &report(&clip(&rig, RootMotion::Root))).expect("written");
        let (first, take) = (open(source.as_bytes()), open(&made.bytes));
        let above = |scene: &ufbx::SceneRoot, name: &str| {
            let node = scene.nodes.into_iter().find(|node| &*node.element.name == name)?;
            Some(node.parent.as_ref().map(|parent| parent.element.name.to_string()).unwrap_or_default())
        };
        let (rests, kept) = (places(&first, None), places(&take, None));
        let bones: BTreeSet<&String> = rests.keys().filter(|name| *name != "body").collect();
        let extra: Vec<&String> = kept.keys().filter(|name| !bones.contains(name)).collect();
        assert!(extra.iter().all(|name| *name == "Root"), "{extra:?}");
        for bone in bones {
            let parent = above(&take, bone).unwrap_or_else(|| panic!("{bone} is not in the take"));
            let wanted = above(&first, bone).expect("it is there");
            assert!(parent == wanted || (wanted.is_empty() && parent == "Root"), "{bone} hangs from {parent}");
            let local = |places: &std::collections::BTreeMap<String, DAffine3>, unit: f64| {
                let above = places.get(&wanted).copied().unwrap_or(DAffine3::IDENTITY);
                (above.inverse() * places[bone]).translation * unit
            };
            let off = local(&rests, written.unit).distance(local(&kept, 1.0));
            assert!(off < 1e-3, "{bone} rests {off} cm beside");
        }
        assert!(made.changes.is_empty(), "{:?}", made.changes);
    }
}

#[test]
fn a_written_take_is_read_again_as_a_rig_and_as_a_clip() {
    let rig = builtin();
    let options = BakeOptions { root: RootMotion::Root, ..BakeOptions::default() };
    let baked = bake(&rig, &Scenario::demo(), &options).expect("the demo");
    let made = fbx(&rig, &baked.clip, &baked.report).expect("written");
    let again = read("take.fbx", &made.bytes).expect("a rig");
    assert!(apart(&rig, &again) < 0.1, "{} mm", apart(&rig, &again));
    let file = mocap::read("take.fbx", &made.bytes, &nothing, None).expect("a clip");
    assert_eq!(file.clips, std::slice::from_ref(&baked.clip.name));
    let capture = file.capture(0, &Options::default()).expect("it moves");
    assert!((capture.fps - 30.0).abs() < 1e-9);
    assert!((capture.frames() as f64 - baked.clip.duration * 30.0).abs() < 1.5, "{} frames", capture.frames());
    // Its own take is a clip of the document that a base can name, and a bake goes on from it.
    let names = surefoot::rig::clips::clip_names(&again);
    assert_eq!(names, std::slice::from_ref(&baked.clip.name));
    let whole = glb(&again, &[(clip(&again, RootMotion::Root), report(&baked.clip))]).expect("written");
    let twice = read("take.glb", &whole.bytes).expect("a rig");
    assert_eq!(surefoot::rig::clips::clip_names(&twice).len(), 2);
}

#[test]
fn an_fbx_without_a_skin_has_soles_made_of_joints_and_says_so() {
    let rig = of_text(Written { skin: false, ..CENTIMETRES });
    assert!(apart(&builtin(), &rig) < 0.5);
    assert!(rig.mesh.is_empty());
    println!("{:#?}", rig.mapping.warnings);
    assert!(!rig.mapping.warnings.is_empty(), "it is told");
}

#[test]
fn broken_fbx_files_and_those_of_no_humanoid_are_told_of_by_name() {
    let own = text(&builtin(), CENTIMETRES);
    let told = |name: &str, bytes: &[u8]| match read(name, bytes) {
        Ok(_) => panic!("{name} is no rig"),
        Err(error) => error.to_string(),
    };
    for bytes in [&b""[..], b"Kaydara FBX Binary  \0\x1a\0", b"; FBX 7.4.0 project file\nObjects: {", b"\0\x01\x02"] {
        let words = told("broken.fbx", bytes);
        assert!(words.starts_with("broken.fbx: "), "{words}");
    }
    let nobody = own.replace("LeftUpperLeg", "wing").replace("leftUpperLeg", "wing");
    let words = told("bird.fbx", nobody.split("Deformer: ").next().unwrap_or_default().as_bytes());
    assert!(words.contains("bird.fbx"), "{words}");
    let empty =
        "; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXVersion: 7400\n}\nObjects: {\n}\nConnections: {\n}\n";
    let words = told("empty.fbx", empty.as_bytes());
    assert!(words.contains("no humanoid found"), "{words}");
    for at in (own.len() / 20..own.len()).step_by(own.len() / 60) {
        for letter in [b'9', b'-', b'}', b',', 0] {
            let mut hurt = own.clone().into_bytes();
            hurt[at] = letter;
            let _ = read("hurt.fbx", &hurt);
        }
    }
    // Cut anywhere, a file is a rig or is told of; it never breaks the program.
    for part in 1..40 {
        let _ = read("cut.fbx", &own.as_bytes()[..own.len() * part / 40]);
    }
    let take = fbx(&builtin(), &clip(&builtin(), RootMotion::Hips), &report(&clip(&builtin(), RootMotion::Hips)));
    let take = take.expect("written").bytes;
    for at in (0..take.len()).step_by(take.len() / 150) {
        let mut hurt = take.clone();
        hurt[at] ^= 0x55;
        let _ = read("hurt.fbx", &hurt);
        let _ = read("cut.fbx", &take[..at]);
    }
}

#[test]
fn recorded_fbx_files_are_rigs_too_and_take_a_clip() {
    let Some(folder) = data::folder() else { return };
    let mut seen = 0;
    let files = std::fs::read_dir(folder.join("clips")).expect("a folder").filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<_> = files.filter(|path| path.extension().is_some_and(|ending| ending == "fbx")).collect();
    files.sort();
    for path in files {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let rig = surefoot::rig::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!((1.4..2.1).contains(&rig.body.height), "{name}: {} m", rig.body.height);
        let clip = clip(&rig, RootMotion::Root);
        let made = fbx(&rig, &clip, &report(&clip)).expect("written");
        std::fs::write(made_path(&format!("onto_{name}.fbx.bin")), &made.bytes).expect("target can be written");
        let shown = places(&open(&made.bytes), Some(0.5));
        let mut sampler = rig.sampler(&clip);
        let hips = rig
            .scenario_from_document()
            .inverse()
            .transform_point3(sampler.node_globals(0.5)[rig.hips_node()].translation)
            * 100.0;
        let bone = rig.nodes[rig.hips_node()].name.clone().expect("a name");
        let off: DVec3 = shown[&bone].translation - hips;
        assert!(off.length() / rig.document_from_scenario.scale < 0.05, "{name}: {off} cm");
        seen += 1;
    }
    assert!(seen > 0, "there are clips of that kind");
}

#[test]
fn a_take_of_an_fbx_that_is_larger_than_a_person_fits_it_all_the_same() {
    // Three times as large as it should be, as files of games often are.
    let source = text(&builtin(), Written { unit: 1.0, ..CENTIMETRES }).replace(
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n",
        "\"UnitScaleFactor\", \"double\", \"Number\", \"\",3\n",
    );
    let rig = read("large.fbx", source.as_bytes()).expect("a rig");
    assert!(rig.document_from_scenario.scale > 2.0, "its unit is guessed: {}", rig.document_from_scenario.scale);
    let clip = clip(&rig, RootMotion::Hips);
    let made = fbx(&rig, &clip, &report(&clip)).expect("written");
    let (first, take) = (places(&open(source.as_bytes()), None), places(&open(&made.bytes), None));
    for (bone, at) in &take {
        let off = (first[bone].translation * 3.0).distance(at.translation);
        assert!(off < 1e-2, "{bone} rests {off} cm beside");
    }
}

#[test]
fn a_batch_bakes_takes_onto_an_fbx_under_the_names_of_its_plan() {
    const SHOVE: &str = "title = \"shove\"\nduration = 1.0\n\n[[push]]\nstart = 0.3\nduration = 0.2\nforce = 100.0\ntoward = \"right\"\nat = \"chest\"\n";
    const SWEEP: &str = "scenario = \"shove.toml\"\nrigs = [\"hero.fbx\"]\nname = \"s{seed}\"\n\n[vary]\nseed = [1, 2]\n\n[bake]\ndrive = \"stepper\"\nformat = \"fbx\"\n";
    let hero = text(&builtin(), CENTIMETRES);
    let shell = crate::shell::Shell::with(&[("hero.fbx", &hero), ("shove.toml", SHOVE), ("sweep.toml", SWEEP)]);
    shell.run("batch sweep.toml -o out --no-sheet").exits(0);
    for take in ["s1", "s2"] {
        let bytes = std::fs::read(shell.path(&format!("out/hero/{take}.fbx"))).expect("it was baked");
        assert_eq!(&*open(&bytes).anim_stacks[0].element.name, take);
        assert!(shell.path(&format!("out/hero/{take}.events.json")).is_file());
    }
    let table = std::fs::read_to_string(shell.path("out/manifest.csv")).expect("a table");
    assert!(table.contains("hero/s1.fbx"), "{table}");
    shell.run("batch sweep.toml -o again --merge").exits(2).says(&["an FBX take holds one clip"]);
}
