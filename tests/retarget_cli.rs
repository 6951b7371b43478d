//! `surefoot retarget` at the shell: one more clip in a copy of the rig's file, read back; and what it refuses.

use super::data;
use std::path::Path;
use std::process::Command;
use surefoot::bake::Curves;
use surefoot::bake::RootMotion;
use surefoot::bake::retargeted::{RetargetOptions, retargeted};
use surefoot::mocap::{Options, load};
use surefoot::rig;

/// Runs `surefoot` with those words in a folder: exit code, stdout, stderr.
fn run(folder: &Path, words: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    let output = command.args(words).current_dir(folder).env("NO_COLOR", "1").output().expect("the program was built");
    let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
    let (out, err) = (text(output.stdout), text(output.stderr));
    assert!(!err.contains("panicked"), "{words:?}: {err}");
    (output.status.code().unwrap_or(-1), out, err)
}

#[test]
fn a_baked_clip_of_a_tall_rig_plays_on_the_built_in_one() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let at = |name: &str| folder.path().join(name);
    for words in [
        &["new", "rig", "--height", "2.1", "-o", "tall.glb"][..],
        &["bake", "tall.glb", "--demo", "--drive", "stepper", "-o", "shoved.glb"],
        &["retarget", "shoved.glb", "builtin", "-o", "out.glb", "--name", "borrowed"],
    ] {
        let (code, out, err) = run(folder.path(), words);
        assert_eq!(code, 0, "{words:?}: {out}{err}");
    }
    let read = |name: &str| {
        let file = load(&at(name)).expect("it was written");
        let last = file.clips.len() - 1;
        (file.clips[last].clone(), file.capture(last, &Options::default()).expect("a motion"))
    };
    let (name, back) = read("out.glb");
    assert_eq!(name, "borrowed");
    let rig = rig::load(&at("out.glb")).expect("a rig");
    let options = RetargetOptions { name: None, fps: None, root: RootMotion::Root, curves: Curves::Linear };
    let meant = retargeted(&rig, &read("shoved.glb").1, &options).expect("a motion");
    assert_eq!(back.frames(), meant.capture.frames());
    let ankles = rig.body.feet.each_ref().map(|foot| foot.ankle);
    let off = |wanted: &dyn Fn(usize) -> bool| {
        let pairs = back.positions.iter().zip(&meant.capture.positions).enumerate();
        let pairs = pairs.filter(|(index, _)| wanted(index % rig.body.joints.len()));
        pairs.map(|(_, (a, b))| a.distance(*b)).fold(0.0, f64::max)
    };
    // Keys are left out where a hand goes no more than millimetres astray for it.
    let (all, feet) = (off(&|_| true), off(&|joint| ankles.contains(&joint)));
    assert!(all < 6e-3 && feet < 1e-3, "what was written is {all} m off, feet {feet} m");
    let report = &meant.report;
    assert!(report.contacts.len() >= 4 && report.disturbances.len() == 1, "{report:?}");
    let slip = report.contacts.iter().map(|contact| contact.slip_mm).fold(0.0, f64::max);
    assert!(slip < 4.0 && report.plausibility.penetration_max_mm < 5.0, "slip {slip} mm, {:?}", report.plausibility);
    // The document of the built-in rig has gained one animation and lost nothing.
    let document = |bytes: &[u8]| {
        let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        rig::Document::parse("x.glb", bytes, &none).expect("a document").json
    };
    let (before, after) =
        (document(rig::mannequin::BUILTIN), document(&std::fs::read(at("out.glb")).expect("it was written")));
    let count = |value: &serde_json::Value, list: &str| value[list].as_array().map_or(0, Vec::len);
    assert_eq!(count(&after, "animations"), count(&before, "animations") + 1);
    assert_eq!(before["meshes"], after["meshes"]);
    let events = std::fs::read_to_string(at("out.events.json")).expect("events beside it");
    assert!(events.contains("\"borrowed\"") && events.contains("foot_down"), "{events}");
}

#[test]
fn what_cannot_be_retargeted_is_told_with_a_remedy() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    std::fs::write(folder.path().join("notes.txt"), "no clip").expect("the test's own folder");
    let told = |words: &[&str], part: &str| {
        let (code, out, err) = run(folder.path(), words);
        assert!(code == 2 && out.is_empty() && err.contains(part), "{words:?}: {code} {out} {err}");
    };
    told(&["retarget", "none.bvh", "builtin", "-o", "a.glb"], "no such file");
    told(&["retarget", "notes.txt", "builtin", "-o", "a.glb"], "notes.txt");
    told(&["retarget", "notes.txt", "builtin", "-o", "a.bvh"], ".glb");
    let Some(data) = data::folder() else { return };
    let path = |name: &str| data.join(name).display().to_string();
    let (pack, walk) = (path("rigs/m2m_human_base_animations.glb"), path("clips/cmu_02_01_walk.bvh"));
    told(&["retarget", &pack, "builtin", "-o", "a.glb"], "name one with --clip");
    told(&["retarget", &pack, "builtin", "-o", "a.glb", "--clip", "Nap"], "no clip \"Nap\"");
    told(&["retarget", &walk, &path("rigs/quaternius_Robot.fbx"), "-o", "a.glb"], "not a humanoid");
    told(&["retarget", &walk, "notes.txt", "-o", "a.glb"], "notes.txt");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the test's own folder").count(), 1, "nothing was written");
}
