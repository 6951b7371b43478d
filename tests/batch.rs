//! `surefoot batch` at the shell: every clip as `bake` alone makes it, whatever the jobs, chunks and kills; what fails and what is wrong.

use crate::shell::Shell;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use surefoot::maths::seed::Seed;
use surefoot::rig::{self, clips};

const SHOVE: &str = "title = \"shove\"\nduration = 1.5\nseed = 7\n\n[[push]]\nstart = 0.3\nduration = 0.2\nforce = 250.0\ntoward = \"right\"\n";

const SWEEP: &str = r#"
scenario = "shove.toml"
rigs = ["builtin", { name = "small", file = "small.glb" }]
name = "{title}_{push.0.toward}_{push.0.force}_s{seed}"
[vary]
"push.0.toward" = ["front", { name = "side", value = -90 }]
"push.0.force" = [{ name = "light", value = 60 }, { name = "hard", value = 350 }]
seed = [1, 2]
[bake]
drive = "stepper"
"#;

fn shell() -> Shell {
    let shell = Shell::with(&[("shove.toml", SHOVE), ("sweep.toml", SWEEP)]);
    shell.run("new rig --height 1.4 --leg-scale 0.95 -o small.glb").exits(0);
    shell
}

/// Every file of a batch's folder but those that are the program's own.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fn walk(folder: &Path, root: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let name = path.strip_prefix(root).expect("below").display().to_string();
            if path.is_dir() {
                walk(&path, root, found);
            } else if name != ".surefoot/lock" {
                found.insert(name, fs::read(&path).expect("the test's own file"));
            }
        }
    }
    let mut found = BTreeMap::new();
    walk(folder, folder, &mut found);
    found
}

fn same(one: &BTreeMap<String, Vec<u8>>, other: &BTreeMap<String, Vec<u8>>, what: &str) {
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>(), "{what}");
    for (name, bytes) in one {
        assert!(other[name] == *bytes, "{what}: {name} differs");
    }
}

#[test]
fn each_clip_is_the_one_that_bake_makes_of_its_scenario() {
    let shell = shell();
    let told = shell.run("batch sweep.toml -o out --scenarios").exits(0);
    assert!(told.out.contains("16 variations"), "{}", told.out);
    let manifest: serde_json::Value =
        serde_json::from_slice(&fs::read(shell.path("out/manifest.json")).expect("a manifest")).expect("JSON");
    let clips = manifest["clips"].as_array().expect("rows");
    assert_eq!(clips.len(), 16);
    assert_eq!(clips[3]["name"], "shove_front_hard_s2");
    for row in [&clips[3], &clips[12]] {
        let (name, rig) = (row["name"].as_str().expect("a name"), row["rig"].as_str().expect("a rig"));
        let file = if rig == "builtin" { "builtin" } else { "small.glb" };
        shell
            .run(&format!(
                "bake {file} out/scenarios/{rig}_{name}.toml -o alone/{name}.glb --clip {name} --drive stepper"
            ))
            .exits(0);
        for ending in ["glb", "events.json"] {
            let alone = fs::read(shell.path(&format!("alone/{name}.{ending}"))).expect("baked");
            let batch = fs::read(shell.path(&format!("out/{rig}/{name}.{ending}"))).expect("baked");
            assert!(alone == batch, "{rig}/{name}.{ending} is not what bake makes");
        }
        let glb = fs::read(shell.path(row["file"].as_str().map(|file| format!("out/{file}")).as_deref().unwrap_or("")));
        assert_eq!(row["hash"], blake3::hash(&glb.expect("the file that the manifest names")).to_hex().as_str());
    }
    let csv = fs::read_to_string(shell.path("out/manifest.csv")).expect("a table");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 17);
    assert!(
        lines[0].starts_with("number,name,file,rig,scenario,push.0.toward,push.0.force,seed,state,outcome,"),
        "{}",
        lines[0]
    );
    assert!(
        lines[16].starts_with("16,shove_side_hard_s2,small/shove_side_hard_s2.glb,small,shove,-90,350,2,baked,"),
        "{}",
        lines[16]
    );
    for picture in ["sheet.png", "coverage.svg"] {
        assert!(fs::metadata(shell.path(&format!("out/{picture}"))).is_ok_and(|there| there.len() > 1000), "{picture}");
    }
}

#[test]
fn jobs_chunks_and_resuming_give_the_same_bytes() {
    let shell = shell();
    shell.run("batch sweep.toml -o one --jobs 1").exits(0);
    let one = results(&shell.path("one"));
    assert_eq!(one.len(), 16 * 3 + 4);
    shell.run("batch sweep.toml -o eight --jobs 8").exits(0);
    same(&one, &results(&shell.path("eight")), "eight jobs");
    // Chunks in any order, one of them twice, then the whole.
    for only in ["9-16", "1-5", "6-8", "1-5"] {
        let told = shell.run(&format!("batch sweep.toml -o chunks --only {only} --jobs 2")).exits(0);
        assert!(told.out.contains("chunk") && !shell.path("chunks/manifest.csv").exists());
    }
    let told = shell.run("batch sweep.toml -o chunks").exits(0);
    assert!(told.out.contains("16 were there already"), "{}", told.out);
    same(&one, &results(&shell.path("chunks")), "chunks");
    // A file that was damaged or removed is made again, the rest is kept.
    fs::write(shell.path("one/builtin/shove_side_hard_s1.glb"), b"cut").expect("written");
    fs::remove_file(shell.path("one/small/shove_side_hard_s1.events.json")).expect("removed");
    fs::write(shell.path("one/.surefoot/small/shove_front_light_s1.record"), b"cut").expect("written");
    let told = shell.run("batch sweep.toml -o one").exits(0);
    assert!(told.out.contains("13 were there already"), "{}", told.out);
    same(&one, &results(&shell.path("one")), "mended");
    let told = shell.run("batch sweep.toml -o one --force --jobs 2").exits(0);
    assert!(!told.out.contains("already"), "{}", told.out);
    same(&one, &results(&shell.path("one")), "forced");
    // What changed is baked again, and only that.
    fs::write(shell.path("sweep.toml"), SWEEP.replace("350", "300")).expect("written");
    let told = shell.run("batch sweep.toml -o one").exits(0);
    assert!(told.out.contains("8 were there already"), "{}", told.out);
}

#[test]
fn kills_at_random_moments_leave_whole_files_and_the_next_run_goes_on() {
    let shell = shell();
    shell.run("batch sweep.toml -o whole --jobs 2").exits(0);
    let whole = results(&shell.path("whole"));
    let mut draw = Seed::new(5);
    let mut killed = 0;
    for _ in 0..20 {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
        command.args(["batch", "sweep.toml", "-o", "torn", "--jobs", "2"]).current_dir(shell.path(""));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program was built");
        std::thread::sleep(Duration::from_millis((draw.unit() * 260.0) as u64));
        killed += usize::from(child.try_wait().expect("a child").is_none());
        drop(child.kill());
        drop(child.wait());
        for (name, bytes) in results(&shell.path("torn")) {
            let staged = name.rsplit('/').next().is_some_and(|name| name.starts_with(".surefoot-"));
            assert!(staged || whole.get(&name) == Some(&bytes), "{name} is broken after a kill");
        }
        if whole.len() == results(&shell.path("torn")).len() {
            fs::remove_dir_all(shell.path("torn")).expect("the test's own folder");
        }
    }
    assert!(killed >= 10, "only {killed} of the runs were killed in time: this says nothing");
    shell.run("batch sweep.toml -o torn --jobs 2").exits(0);
    same(&whole, &results(&shell.path("torn")), "after the kills");
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_only_whole_files_and_says_how_to_go_on() {
    let shell = shell();
    shell.run("batch sweep.toml -o whole --jobs 2").exits(0);
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    command.args(["batch", "sweep.toml", "-o", "torn", "--jobs", "1", "--force"]).current_dir(shell.path(""));
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program was built");
    // The first clip is there, the last is not.
    let there = || shell.path("torn/.surefoot/builtin/shove_front_light_s1.record").exists();
    for _ in 0..500 {
        if there() {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(signal.success() && there());
    let told = child.wait_with_output().expect("a child");
    assert_eq!(told.status.code(), Some(3));
    let words = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(words.contains("interrupted; whole clips are kept, and the same command goes on from here"), "{words}");
    let whole = results(&shell.path("whole"));
    for (name, bytes) in results(&shell.path("torn")) {
        assert!(whole.get(&name) == Some(&bytes), "{name} after an interrupt");
    }
    shell.run("batch sweep.toml -o torn").exits(0);
    same(&whole, &results(&shell.path("torn")), "after the interrupt");
}

#[test]
fn two_at_once_in_one_folder_do_no_harm() {
    let shell = shell();
    shell.run("batch sweep.toml -o whole --jobs 2").exits(0);
    let run = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
        command.args(["batch", "sweep.toml", "-o", "both", "--jobs", "2", "--only", "1-8"]).current_dir(shell.path(""));
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program was built")
    };
    for mut child in [run(), run(), run()] {
        assert!(child.wait().expect("a child").success());
    }
    shell.run("batch sweep.toml -o both").exits(0);
    same(&results(&shell.path("whole")), &results(&shell.path("both")), "three workers");
}

#[test]
fn what_fails_is_listed_and_the_rest_is_done() {
    let walk = format!("{SHOVE}\n[stepper]\nspring = 1.0\n");
    let sweep = "scenario = \"walk.toml\"\nname = \"w_{stepper.spring}\"\n[vary]\n\"stepper.spring\" = [1.0, 1.6, 1.7]\n[bake]\ndrive = \"ragdoll\"\nassist = \"off\"\n";
    let shell = Shell::with(&[("walk.toml", &walk), ("sweep.toml", sweep)]);
    let told = shell.run("batch sweep.toml -o out").exits(3).says(&["2 of 3 variations failed", "w_1.6", "[stepper]"]);
    assert!(told.out.contains("failed"), "{}", told.out);
    let csv = fs::read_to_string(shell.path("out/manifest.csv")).expect("a table");
    let row = csv.lines().nth(2).expect("a row");
    assert!(row.contains(",failed,") && row.contains("[stepper]"), "{row}");
    assert!(shell.path("out/builtin/w_1.glb").exists() && !shell.path("out/builtin/w_1.6.glb").exists());
    shell.run("batch sweep.toml -o out --tolerant").exits(0).says(&["warning: 2 of 3 variations failed"]);
    let json = shell.run("batch sweep.toml -o out --json").exits(3).json();
    assert_eq!(json["clips"][1]["state"], "failed");
}

#[test]
fn a_place_that_takes_nothing_stops_the_batch_and_the_next_run_goes_on() {
    let shell = shell();
    let blocked = shell.path("out/builtin/shove_side_light_s1.glb");
    fs::create_dir_all(&blocked).expect("the test's own folder");
    shell.run("batch sweep.toml -o out --jobs 1").exits(3).says(&[
        "stopped with 4 of 16",
        "shove_side_light_s1.glb",
        "folder",
    ]);
    assert!(!shell.path("out/manifest.csv").exists());
    fs::remove_dir(&blocked).expect("the test's own folder");
    let told = shell.run("batch sweep.toml -o out").exits(0);
    assert!(told.out.contains("4 were there already"), "{}", told.out);
    fs::write(shell.path("file"), "x").expect("written");
    shell.run("batch sweep.toml -o file").exits(2).says(&["this is a file"]);
}

#[test]
fn merged_files_hold_every_clip_as_it_is_alone() {
    let shell = shell();
    shell.run("batch sweep.toml -o apart").exits(0);
    shell.run("batch sweep.toml -o out --merge --only 3-9").exits(0);
    shell.run("batch sweep.toml -o out --merge").exits(0);
    assert!(!shell.path("out/builtin").exists() && shell.path("out/small.events.json").exists());
    let merged = rig::load(&shell.path("out/small.glb")).expect("a merged file");
    let names = clips::clip_names(&merged);
    assert_eq!(names.len(), 8);
    for (index, name) in names.iter().enumerate() {
        let alone = rig::load(&shell.path(&format!("apart/small/{name}.glb"))).expect("a clip alone");
        let (one, other) = (clips::read_clip(&merged, index), clips::read_clip(&alone, 0));
        assert!(one.is_ok() && one == other, "{name}");
        let extras = |rig: &rig::Rig, index: usize| rig.document.list("animations")[index]["extras"].clone();
        assert_eq!(extras(&merged, index), extras(&alone, 0), "{name}");
    }
    let rows = |folder: &str| {
        let text = fs::read(shell.path(&format!("{folder}/manifest.json"))).expect("a manifest");
        let manifest: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
        manifest["clips"].as_array().expect("rows").clone()
    };
    for (one, other) in rows("out").iter().zip(&rows("apart")) {
        assert_eq!((&one["hash"], &one["outcome"]), (&other["hash"], &other["outcome"]));
        assert_eq!(one["file"], format!("{}.glb", one["rig"].as_str().unwrap_or_default()));
    }
}

#[test]
fn helpers_of_engines_stand_beside_clips_that_are_baked_for_them() {
    let shell = shell();
    let sweep = SWEEP.replace("drive = \"stepper\"", "drive = \"stepper\"\nengine = [\"unity\", \"godot\"]");
    fs::write(shell.path("sweep.toml"), sweep.replace("seed = [1, 2]", "seed = [1]")).expect("written");
    shell.run("batch sweep.toml -o out --scenarios").exits(0);
    let alone = "bake small.glb out/scenarios/small_shove_side_hard_s1.toml -o alone/shove_side_hard_s1.glb --clip shove_side_hard_s1";
    shell.run(&format!("{alone} --drive stepper --engine unity,godot")).exits(0);
    for file in ["shove_side_hard_s1.glb", "SurefootEvents.cs", "surefoot_godot.gd"] {
        let (one, other) =
            (fs::read(shell.path(&format!("alone/{file}"))), fs::read(shell.path(&format!("out/small/{file}"))));
        assert!(one.is_ok_and(|one| other.is_ok_and(|other| one == other)), "{file}");
    }
    shell.run("batch sweep.toml -o merged --merge --no-sheet").exits(0);
    assert!(shell.path("merged/surefoot_godot.gd").exists());
    let skins = |file: &str| rig::load(&shell.path(file)).expect("a baked file").document.list("skins").to_vec();
    assert_eq!(skins("merged/small.glb"), skins("alone/shove_side_hard_s1.glb"));
}

#[test]
fn all_that_is_wrong_is_told_before_anything_runs() {
    let shell = shell();
    let cases = [
        (SWEEP.replace("push.0.force\" = [", "push.0.forse\" = ["), "did you mean `force`"),
        (SWEEP.replace("small.glb", "lacks.glb"), "lacks.glb: no such file"),
        (SWEEP.replace("shove.toml", "lacks.toml"), "lacks.toml: no such file"),
        (SWEEP.replace("_s{seed}", ""), "would both be called"),
        (SWEEP.replace("_s{seed}", "/{seed}"), "stands in no file name"),
        (SWEEP.replace("value = 350", "value = 1e9"), "is out of"),
        (SWEEP.replace("[vary]", "[vari]"), "unknown key `vari`"),
        (SWEEP.replace("small.glb", "shove.toml"), "a scenario stands where the rig should"),
        ("scenario = ".into(), "not TOML"),
    ];
    for (sweep, words) in cases {
        fs::write(shell.path("bad.toml"), &sweep).expect("written");
        shell.run("batch bad.toml -o out").exits(2).says(&[words]);
        assert!(!shell.path("out").exists(), "{words}");
    }
    shell.run("batch sweep.toml -o out --only 17").exits(2).says(&["16 variations"]);
    let listed = shell.run("batch sweep.toml --dry-run").exits(0);
    assert!(
        listed.out.contains("   16  small/shove_side_hard_s2  push.0.toward = -90, push.0.force = 350, seed = 2"),
        "{}",
        listed.out
    );
    assert_eq!(
        shell.run("batch sweep.toml --dry-run --json").exits(0).json()["clips"].as_array().map(Vec::len),
        Some(16)
    );
    assert!(!shell.path("out").exists());
    // The sweep that the program writes is one that it takes.
    shell.run("new sweep -o mine.toml").exits(0);
    shell.run("batch mine.toml --dry-run").exits(0);
}
