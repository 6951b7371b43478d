//! What a person at the shell meets: the built program, its exit codes, its words, its files.

use crate::shell::Shell;
use std::fs;
use std::process::Command;

const SHOVE: &str = "title = \"shove\"\n\n[[push]]\nstart = 0.5\nduration = 0.2\nforce = 250.0\ntoward = \"right\"\n";

#[test]
fn help_is_a_result_and_names_every_command() {
    let told = Shell::new().run("--help").exits(0);
    for command in ["bake", "audit", "correct", "batch", "inspect", "new", "sheet", "studio"] {
        assert!(told.out.contains(command), "{command}");
    }
    assert_eq!(told.err, "");
}

#[test]
fn bad_usage_exits_two() {
    for words in ["", "bkae", "bake", "bake a.glb", "bake a.glb b.toml", "bake builtin --demo --fps 0", "new castle"] {
        let told = Shell::new().run(words).exits(2);
        assert_eq!(told.out, "", "{words}");
    }
}

#[test]
fn a_window_that_cannot_be_opened_says_why_and_a_missing_file_is_told_before() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    shell.run("studio nothing.toml").exits(2).says(&["nothing.toml: no such file"]);
    if cfg!(target_os = "linux") {
        shell.run("studio shove.toml").exits(3).says(&["the window cannot be opened", "help:"]);
    }
    assert_eq!(shell.files(), ["shove.toml"]);
}

#[test]
fn what_the_ragdoll_cannot_play_is_named_and_a_fall_is_a_result_unless_balance_is_required() {
    let walk = format!("{SHOVE}\n[[walk]]\nstart = 0.5\nspeed = 1.0\n[stepper]\nspring = 2.0\n");
    let hard = SHOVE.replace("250.0", "1800.0");
    let shell = Shell::with(&[("walk.toml", &walk), ("hard.toml", &hard)]);
    shell
        .run("bake builtin walk.toml -o out.glb --drive ragdoll")
        .exits(2)
        .says(&["spring and damping of [stepper]", "--drive stepper"]);
    let required = "bake builtin hard.toml -o out.glb --drive ragdoll --assist off --require-balance";
    shell.run(required).exits(1).says(&["fell", "nothing was written"]);
    assert_eq!(shell.files(), ["hard.toml", "walk.toml"]);
    shell
        .run("bake builtin hard.toml -o out.glb --drive ragdoll --assist off")
        .exits(0)
        .says(&["and the character falls"]);
}

#[test]
fn a_clip_of_the_articulated_body_says_how_much_it_was_helped() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    let told = shell.run("bake builtin shove.toml -o out.glb --drive ragdoll --assist off").exits(0);
    for words in
        ["drive ragdoll", "assist     0 Nm peak (0 rms), 0 N peak (0 rms) on the root; allowed 0 Nm, 0 N", "torques"]
    {
        assert!(told.out.contains(words), "{words}: {}", told.out);
    }
}

#[test]
fn a_faulty_scenario_shows_each_line_and_what_would_be_right() {
    let shell = Shell::with(&[("s.toml", &SHOVE.replace("duration", "duraton").replace("250.0", "-250.0"))]);
    let told = shell.run("bake builtin s.toml -o out.glb").exits(2).says(&[
        "s.toml:5:1",
        "duraton = 0.2",
        "did you mean `duration`?",
        "s.toml:6:9",
        "force = -250.0",
        "turn `toward` round",
        "nothing was written",
    ]);
    assert_eq!(told.out, "");
    assert_eq!(shell.files(), ["s.toml"]);
}

#[test]
fn a_base_clip_that_is_not_there_is_told_with_the_remedy() {
    let own = format!("{SHOVE}\n[base]\nclip = \"Idle\"\n");
    let file = format!("{SHOVE}\n[base]\nfile = \"walk.bvh\"\n");
    let broken = format!("{SHOVE}\n[base]\nfile = \"broken.bvh\"\n");
    let shell =
        Shell::with(&[("s.toml", &own), ("f.toml", &file), ("b.toml", &broken), ("broken.bvh", "HIERARCHY\nROOT")]);
    shell.run("bake builtin s.toml -o out.glb").exits(2).says(&["[base]", "no clips of its own", "file = "]);
    shell.run("bake builtin f.toml -o out.glb").exits(2).says(&["walk.bvh", "no such file"]);
    shell.run("bake builtin b.toml -o out.glb").exits(2).says(&["[base]", "broken.bvh"]);
    assert_eq!(shell.files(), ["b.toml", "broken.bvh", "f.toml", "s.toml"]);
}

#[test]
fn inputs_that_are_no_files_are_named() {
    let shell = Shell::with(&[("shove.toml", SHOVE), ("hero.gltf", "x"), ("bin.toml", "")]);
    fs::write(shell.path("bin.toml"), [0x67, 0x0a, 0xff, 0xfe]).expect("written");
    fs::create_dir(shell.path("folder")).expect("made");
    shell.run("bake nobody.glb shove.toml -o out.glb").exits(2).says(&["nobody.glb", "no such file"]);
    shell.run("bake hero.glb shove.toml -o out.glb").exits(2).says(&["hero.glb", "did you mean hero.gltf?"]);
    shell.run("bake folder shove.toml -o out.glb").exits(2).says(&["folder", "not a file"]);
    shell.run("bake builtin nothing.toml -o out.glb").exits(2).says(&["nothing.toml", "surefoot new scenario"]);
    shell.run("bake builtin folder -o out.glb").exits(2).says(&["folder", "not a file"]);
    shell.run("bake builtin bin.toml -o out.glb").exits(2).says(&["bin.toml", "line 2", "UTF-8"]);
    shell.run("bake shove.toml shove.toml -o out.glb").exits(2).says(&["the order is"]);
    shell.run("inspect nobody.vrm").exits(2).says(&["nobody.vrm", "no such file"]);
    shell.run("sheet nobody.glb -o a.png").exits(2).says(&["nobody.glb", "no such file"]);
    assert_eq!(shell.files(), ["bin.toml", "hero.gltf", "shove.toml"]);
}

#[test]
fn an_fbx_rig_is_baked_and_a_broken_one_is_told_of_by_name() {
    let hero = crate::fbx_text::text(&crate::common::builtin(), crate::fbx_text::CENTIMETRES);
    let shell = Shell::with(&[("broken.fbx", "Kaydara FBX Binary"), ("hero.fbx", &hero), ("shove.toml", SHOVE)]);
    shell.run("bake broken.fbx shove.toml -o out.glb").exits(2).says(&["broken.fbx", "Truncated", "binary FBX"]);
    shell.run("bake hero.fbx shove.toml -o take.fbx").exits(0);
    shell.run("bake hero.fbx shove.toml -o hero.glb").exits(0);
    shell.run("inspect hero.fbx").exits(0);
    shell.run("retarget take.fbx hero.fbx -o again.fbx").exits(0);
    shell.run("audit take.fbx").exits(0);
    shell.run("bake hero.fbx shove.toml -o take.fbx --props").exits(2).says(&["an FBX take holds no meshes"]);
    assert!(shell.files().contains(&"take.events.json".to_owned()), "{:?}", shell.files());
}

#[cfg(unix)]
#[test]
fn a_device_is_neither_read_nor_replaced() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    shell.run("bake /dev/zero shove.toml -o out.glb").exits(2).says(&["not a plain file"]);
    shell.run("bake builtin /dev/zero -o out.glb").exits(2).says(&["not a plain file"]);
}

#[test]
fn a_new_scenario_goes_to_stdout_and_bakes_as_it_stands() {
    let shell = Shell::new();
    let told = shell.run("new scenario").exits(0);
    assert_eq!(surefoot::model::scenario_text::parse("x", &told.out).expect("good"), surefoot::model::Scenario::demo());
    shell.run("new scenario -o shove.toml").exits(0);
    assert_eq!(fs::read_to_string(shell.path("shove.toml")).expect("there"), told.out);
}

#[test]
fn a_new_file_never_replaces_one_that_is_there() {
    let shell = Shell::with(&[("mine.toml", "my work"), ("mine.glb", "my rig")]);
    shell.run("new scenario -o mine.toml").exits(2).says(&["mine.toml", "already"]);
    shell.run("new rig -o mine.glb").exits(2);
    assert_eq!(fs::read_to_string(shell.path("mine.toml")).expect("there"), "my work");
    assert_eq!(fs::read_to_string(shell.path("mine.glb")).expect("there"), "my rig");
}

#[test]
fn a_reader_that_stops_early_is_no_failure() {
    use std::process::Stdio;
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    let mut child =
        command.args(["new", "scenario"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_at_stdout_exits_three() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a device that is always full");
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    let output = command.args(["new", "scenario"]).stdout(full).output().expect("runs");
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write to stdout"));
}

#[test]
fn the_demo_needs_no_other_file_and_says_what_came_of_it() {
    let shell = Shell::new();
    let told = shell.run("bake builtin --demo").exits(0);
    assert_eq!(shell.files(), ["exports/demo.events.json", "exports/demo.glb"]);
    for part in ["exports/demo.glb", "shove_from_the_left", "outcome    step", "push_start", "flat", "plausible"] {
        assert!(told.out.contains(part), "`{part}` is not in\n{}", told.out);
    }
    let readme = include_str!("../README.md");
    let (_, sample) = readme.split_once("It prints what happened:\n\n```text\n").expect("README shows what it prints");
    let (sample, _) = sample.split_once("\n```").expect("an end");
    for line in sample.lines().map(|line| line.trim_end_matches("...")) {
        assert!(told.out.contains(line), "README shows `{line}`, which is not in\n{}", told.out);
    }
    let bytes = fs::read(shell.path("exports/demo.glb")).expect("there");
    assert!(bytes.starts_with(b"glTF"));
    let events: serde_json::Value =
        serde_json::from_slice(&fs::read(shell.path("exports/demo.events.json")).expect("there")).expect("JSON");
    assert_eq!(events["shove_from_the_left"]["outcome"], "step");
}

#[test]
fn a_new_scenario_and_a_new_rig_bake_as_they_stand_and_twice_the_same() {
    let shell = Shell::new();
    shell.run("new scenario -o shove.toml").exits(0);
    shell.run("new rig --height 1.5 --leg-scale 1.1 -o hero.glb").exits(0);
    let told = shell.run("bake hero.glb shove.toml -o a.glb --json --fps 24").exits(0);
    let object = told.json();
    assert_eq!((object["output"].as_str(), object["clip"].as_str()), (Some("a.glb"), Some("shove_from_the_left")));
    assert_eq!(object["report"]["fps"], 24.0);
    shell.run("bake hero.glb shove.toml -o b.glb --fps 24").exits(0);
    assert!(fs::read(shell.path("a.glb")).expect("there") == fs::read(shell.path("b.glb")).expect("there"));
    shell.run("bake hero.glb shove.toml -o c.glb --fps 24 --seed 8").exits(0);
    assert!(fs::read(shell.path("a.glb")).expect("there") != fs::read(shell.path("c.glb")).expect("there"));
}

#[test]
fn a_clip_name_that_is_taken_gets_a_number() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    shell.run("bake builtin shove.toml -o a.glb").exits(0);
    let object = shell.run("bake a.glb shove.toml -o b.glb --json").exits(0).json();
    let name = object["clip"].as_str().expect("a name");
    assert_eq!(name, "shove_2");
    let events: serde_json::Value =
        serde_json::from_slice(&fs::read(shell.path("b.events.json")).expect("there")).expect("JSON");
    assert!(events[name].is_object(), "the events go by the name in the file: {events}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_exits_three_and_leaves_nothing() {
    let shell = Shell::with(&[("long.toml", &format!("duration = 60.0\n{SHOVE}"))]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    command.args(["bake", "builtin", "long.toml", "-o", "out.glb", "--fps", "240"]).current_dir(shell.path(""));
    let mut child = command.stderr(std::process::Stdio::piped()).spawn().expect("runs");
    std::thread::sleep(std::time::Duration::from_millis(250));
    assert_eq!(child.try_wait().expect("can be asked"), None, "the bake is too quick for this test");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(3), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stderr).contains("interrupted"));
    assert_eq!(shell.files(), ["long.toml"]);
}

#[test]
fn a_fall_is_a_result_unless_balance_is_required() {
    let shell = Shell::with(&[("shove.toml", &SHOVE.replace("250.0", "2500.0"))]);
    let told = shell.run("bake builtin shove.toml -o a.glb --require-balance --json").exits(1);
    assert_eq!(told.json()["output"], serde_json::Value::Null);
    assert_eq!(shell.files(), ["shove.toml"]);
    let told = shell.run("bake builtin shove.toml -o a.glb").exits(0).says(&["warning"]);
    assert!(told.out.contains("outcome    fall"), "{}", told.out);
}

#[test]
fn an_input_is_never_overwritten() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    shell.run("new rig -o hero.glb").exits(0);
    let before = fs::read(shell.path("hero.glb")).expect("there");
    shell.run("bake hero.glb shove.toml -o ./hero.glb").exits(2).says(&["hero.glb", "never overwritten"]);
    if cfg!(unix) {
        fs::hard_link(shell.path("hero.glb"), shell.path("alias.glb")).expect("a link");
        shell.run("bake hero.glb shove.toml -o alias.glb").exits(2).says(&["never overwritten"]);
    }
    assert!(fs::read(shell.path("hero.glb")).expect("there") == before);
}

#[test]
fn what_cannot_be_written_exits_three_and_leaves_nothing() {
    let shell = Shell::with(&[("shove.toml", SHOVE), ("file", "in the way")]);
    shell.run("bake builtin shove.toml -o file/out.glb").exits(3).says(&["file/out.glb", "cannot be written"]);
    fs::create_dir(shell.path("out.events.json")).expect("made");
    shell.run("bake builtin shove.toml -o out.glb").exits(2).says(&["out.events.json", "folder"]);
    assert_eq!(shell.files(), ["file", "shove.toml"]);
}

#[test]
fn a_file_that_is_no_rig_is_refused_with_its_fault() {
    let shell = Shell::with(&[("shove.toml", SHOVE), ("text.glb", "hello"), ("empty.glb", ""), ("some.gltf", "{}")]);
    for rig in ["text.glb", "empty.glb", "some.gltf"] {
        shell.run(&format!("bake {rig} shove.toml -o out.glb")).exits(2).says(&[rig]);
        shell.run(&format!("inspect {rig}")).exits(2).says(&[rig]);
    }
    assert!(!shell.path("out.glb").exists());
}

#[test]
fn inspect_prints_one_object() {
    let object = Shell::new().run("inspect builtin --json").exits(0).json();
    assert_eq!(object["bones"]["hips"], "hips");
    for field in
        ["height_m", "mass_kg", "up", "forward", "units_to_metres", "confidence", "method", "legs", "feet", "warnings"]
    {
        assert!(!object[field].is_null(), "{field}");
    }
}

#[test]
fn a_sheet_is_drawn_of_a_baked_file_and_beside_a_bake() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    shell.run("bake builtin shove.toml -o a.glb --sheet beside.png").exits(0);
    shell.run("sheet a.glb -o after.png").exits(0);
    for name in ["beside.png", "after.png"] {
        assert!(fs::read(shell.path(name)).expect("there").starts_with(b"\x89PNG"), "{name}");
    }
    shell.run("sheet a.glb -o b.png --clip dance").exits(2).says(&["dance", "shove"]);
    shell.run("new rig -o hero.glb").exits(0);
    shell.run("sheet hero.glb -o b.png").exits(2).says(&["no clip"]);
}

#[test]
fn a_plot_is_drawn_beside_a_bake_with_its_contacts_and_its_push() {
    let shell = Shell::with(&[("shove.toml", SHOVE)]);
    shell.run("bake builtin shove.toml -o a.glb --plot run.svg").exits(0);
    let text = fs::read_to_string(shell.path("run.svg")).expect("SVG is text");
    assert!(text.trim_end().ends_with("</svg>"));
    for what in ["left foot", "right foot", "commanded", "centre of pressure", "250 N"] {
        assert!(text.contains(what), "{what} is missing");
    }
    shell.run("bake builtin shove.toml -o b.glb --plot run.png").exits(2).says(&["end in .svg"]);
    assert!(!shell.files().contains(&"b.glb".to_owned()));
}
