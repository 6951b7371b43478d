//! `surefoot audit` as a pipeline and a person meet it: exit codes, the fixed JSON, order, waivers, files. Pages stay in target/pages for
//! `tests/tools/report_check.mjs`.

use crate::data;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Joints of a small figure: name, parent, offset in cm; the legs hang straight, the arms too.
const FIGURE: [(&str, &str, [f64; 3]); 19] = [
    ("Hips", "", [0.0, 94.0, 0.0]),
    ("Spine", "Hips", [0.0, 12.0, 0.0]),
    ("Chest", "Spine", [0.0, 20.0, 0.0]),
    ("Neck", "Chest", [0.0, 22.0, 0.0]),
    ("Head", "Neck", [0.0, 8.0, 0.0]),
    ("LeftArm", "Chest", [18.0, 18.0, 0.0]),
    ("LeftForeArm", "LeftArm", [0.0, -28.0, 0.0]),
    ("LeftHand", "LeftForeArm", [0.0, -25.0, 0.0]),
    ("RightArm", "Chest", [-18.0, 18.0, 0.0]),
    ("RightForeArm", "RightArm", [0.0, -28.0, 0.0]),
    ("RightHand", "RightForeArm", [0.0, -25.0, 0.0]),
    ("LeftUpLeg", "Hips", [9.0, -4.0, 0.0]),
    ("LeftLeg", "LeftUpLeg", [0.0, -41.0, 0.0]),
    ("LeftFoot", "LeftLeg", [0.0, -41.0, 0.0]),
    ("LeftToeBase", "LeftFoot", [0.0, -6.0, 13.0]),
    ("RightUpLeg", "Hips", [-9.0, -4.0, 0.0]),
    ("RightLeg", "RightUpLeg", [0.0, -41.0, 0.0]),
    ("RightFoot", "RightLeg", [0.0, -41.0, 0.0]),
    ("RightToeBase", "RightFoot", [0.0, -6.0, 13.0]),
];

/// A figure that stands for 4 s at 30 fps. From the second second on, for one second, the whole of it glides ahead at so many cm/s, and
/// its left foot at so many besides.
fn gliding(whole: f64, foot: f64) -> String {
    fn joint(name: &str, depth: usize, text: &mut String) {
        let (_, _, [x, y, z]) = FIGURE.iter().find(|joint| joint.0 == name).expect("a joint of the figure");
        let pad = "  ".repeat(depth);
        let (kind, channels) = match depth {
            0 => ("ROOT", "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"),
            _ if name == "LeftFoot" => {
                ("JOINT", "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation")
            }
            _ => ("JOINT", "CHANNELS 3 Zrotation Xrotation Yrotation"),
        };
        text.push_str(&format!("{pad}{kind} {name}\n{pad}{{\n{pad}OFFSET {x} {y} {z}\n{pad}{channels}\n"));
        let children: Vec<&str> = FIGURE.iter().filter(|child| child.1 == name).map(|child| child.0).collect();
        for child in &children {
            joint(child, depth + 1, text);
        }
        if children.is_empty() {
            let end = if name.ends_with("ToeBase") {
                "0 0 6"
            } else if name == "Head" {
                "0 18 0"
            } else {
                "0 -8 0"
            };
            text.push_str(&format!("{pad}End Site\n{pad}{{\n{pad}OFFSET {end}\n{pad}}}\n"));
        }
        text.push_str(&format!("{pad}}}\n"));
    }
    let mut text = "HIERARCHY\n".to_owned();
    joint("Hips", 0, &mut text);
    text.push_str("MOTION\nFrames: 120\nFrame Time: 0.0333333\n");
    let zeros = |joints: usize| " 0".repeat(3 * joints);
    let foot_at = FIGURE.iter().position(|joint| joint.0 == "LeftFoot").expect("a joint of the figure");
    for frame in 0..120 {
        let ahead = (f64::from(frame) / 30.0 - 2.0).clamp(0.0, 1.0);
        let (root, foot) = (whole * ahead, foot * ahead);
        text.push_str(&format!("0 94 {root:.4}{} 0 -41 {foot:.4}{}\n", zeros(foot_at), zeros(FIGURE.len() - foot_at)));
    }
    text
}

struct Shell {
    folder: tempfile::TempDir,
}

struct Told {
    out: String,
    err: String,
}

impl Shell {
    /// A folder with a clip that stands (`a_stands.bvh`) and one whose feet slide (`b_slides.bvh`).
    fn new() -> Shell {
        let shell = Shell { folder: tempfile::tempdir().expect("a folder for the test") };
        shell.put("a_stands.bvh", &gliding(0.0, 0.0));
        shell.put("b_slides.bvh", &gliding(0.0, 30.0));
        shell
    }

    fn put(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("the test's own folder");
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    #[track_caller]
    fn audit(&self, words: &[&str], exit: i32) -> Told {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
        command.arg("audit").args(words).current_dir(self.folder.path());
        let output = command.output().expect("the program was built");
        let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
        let told = Told { out: text(output.stdout), err: text(output.stderr) };
        assert!(!told.err.contains("panicked") && !told.err.contains("broke down"), "{words:?}: {}", told.err);
        assert_eq!(output.status.code(), Some(exit), "{words:?}\nstdout:\n{}\nstderr:\n{}", told.out, told.err);
        told
    }

    #[track_caller]
    fn json(&self, words: &[&str], exit: i32) -> Value {
        let told = self.audit(&[words, &["--json", "-"]].concat(), exit);
        serde_json::from_str(&told.out).unwrap_or_else(|error| panic!("{error} in {}", told.out))
    }
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().map(|object| object.keys().map(String::as_str).collect()).unwrap_or_default()
}

/// Where pages stay for the browser.
fn page_path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/pages");
    fs::create_dir_all(&folder).expect("the build's own folder");
    folder.join(name)
}

#[test]
fn a_clip_that_stands_has_no_flags_and_one_that_slides_has() {
    let shell = Shell::new();
    let told = shell.audit(&["a_stands.bvh"], 0);
    for part in ["a_stands: 4.00 s, 120 frames at 30 fps, unit 0.01 m, up +Y", "no flags", "steps "] {
        assert!(told.out.contains(part), "{part}: {}", told.out);
    }
    let told = shell.audit(&["b_slides.bvh"], 0);
    assert!(told.out.contains("foot-slide  left") && told.out.contains("cm  "), "{}", told.out);
    let found = shell.json(&["b_slides.bvh"], 0);
    let flags = found["flags"].as_array().expect("flags");
    let slide =
        flags.iter().find(|flag| flag["rule"] == "foot-slide" && flag["foot"] == "left").expect("the left foot's");
    // 30 cm in all; how much of it one flag tells is the rule's affair.
    assert!((0.15..0.32).contains(&slide["delta_m"].as_f64().expect("metres")), "{slide}");
    assert!(flags.iter().all(|flag| flag["foot"] != "right"), "the right one stands: {found}");
}

#[test]
fn the_json_has_the_fixed_keys_in_their_order() {
    let shell = Shell::new();
    let found = shell.json(&["b_slides.bvh"], 0);
    let fixed = [
        "version",
        "clip",
        "fps",
        "frames",
        "units_to_metres",
        "up",
        "confidence",
        "flags",
        "clip_flags",
        "contacts",
        "steps",
        "abstained",
    ];
    assert_eq!(keys(&found)[..fixed.len()], fixed);
    assert_eq!((&found["version"], &found["clip"], &found["frames"]), (&1.into(), &"b_slides".into(), &120.into()));
    let flag = &found["flags"][0];
    assert_eq!(keys(flag), ["start", "end", "rule", "foot", "severity", "measured", "predicted", "delta_m", "why"]);
    assert_eq!(keys(&found["contacts"][0]), ["foot", "part", "start", "end"]);
    let several = shell.json(&["b_slides.bvh", "a_stands.bvh"], 0);
    let names: Vec<&Value> = several.as_array().expect("an array").iter().map(|clip| &clip["clip"]).collect();
    assert_eq!(names, ["b_slides", "a_stands"], "as given");
    shell.audit(&["b_slides.bvh", "--json", "out/found.json"], 0);
    let written: Value = serde_json::from_str(&shell.text("out/found.json")).expect("JSON");
    assert_eq!(written, found, "the file says what stdout says");
}

#[test]
fn strict_exits_one_where_a_flag_stands() {
    let shell = Shell::new();
    shell.audit(&["a_stands.bvh", "--strict"], 0);
    let told = shell.audit(&["b_slides.bvh", "--strict"], 1);
    assert!(told.out.contains("foot-slide"), "the flags are told all the same: {}", told.out);
    shell.audit(&[".", "--strict"], 1);
    shell.audit(&["b_slides.bvh", "--strict", "--json", "found.json"], 1);
    assert!(shell.text("found.json").contains("foot-slide"), "and written");
}

#[test]
fn waived_flags_are_shown_as_such_and_do_not_count() {
    let shell = Shell::new();
    shell.audit(&["b_slides.bvh", "--write-waivers", "w.toml"], 0);
    let told = shell.audit(&["b_slides.bvh", "--strict", "--waive", "w.toml"], 0);
    assert!(told.out.contains("no flags, ") && told.out.contains("[waived: seen and accepted]"), "{}", told.out);
    assert!(!told.err.contains("warning"), "each covers something: {}", told.err);
    let found = shell.json(&["b_slides.bvh", "--waive", "w.toml"], 0);
    let flags = found["flags"].as_array().expect("flags");
    assert!(!flags.is_empty() && flags.iter().all(|flag| flag["waived"] == "seen and accepted"), "{found}");

    let ice =
        |foot: &str| format!("[[waive]]\nclip = \"b_*\"\nrule = \"foot-slide\"\nfoot = \"{foot}\"\nreason = \"ice\"\n");
    shell.put("one.toml", &ice("left"));
    let told = shell.audit(&["b_slides.bvh", "--strict", "--waive", "one.toml"], 0);
    assert!(told.out.contains("[waived: ice]"), "{}", told.out);
    shell.put("other.toml", &ice("right"));
    shell.audit(&["b_slides.bvh", "--strict", "--waive", "other.toml"], 1);
    let told = shell.audit(&["a_stands.bvh", "--waive", "one.toml"], 0);
    assert!(told.err.contains("warning: one.toml:1:") && told.err.contains("covers no flag"), "{}", told.err);
    shell.put("bad.toml", "[[waive]]\nclip = \"b\"\nrule = \"slide\"\nreason = \"x\"\n");
    let told = shell.audit(&["b_slides.bvh", "--waive", "bad.toml"], 2);
    assert!(told.err.contains("bad.toml:3: no rule \"slide\""), "{}", told.err);
}

#[test]
fn folders_and_patterns_are_looked_through_in_order_whatever_the_jobs() {
    let shell = Shell::new();
    fs::create_dir(shell.path("more")).expect("made");
    shell.put("more/c.bvh", &gliding(12.0, 0.0));
    shell.put("more/notes.txt", "no clip");
    let outputs = |jobs: &str| {
        let told = shell.audit(
            &[
                ".",
                "--jobs",
                jobs,
                "--json",
                "f.json",
                "--csv",
                "f.csv",
                "--html",
                "f.html",
                "--write-waivers",
                "f.toml",
            ],
            0,
        );
        let files: Vec<Vec<u8>> = ["f.json", "f.csv", "f.html", "f.toml"]
            .iter()
            .map(|name| fs::read(shell.path(name)).expect("there"))
            .collect();
        (told.out, files)
    };
    let (one, four) = (outputs("1"), outputs("4"));
    assert!(one == four, "the same bytes whatever the jobs");
    let lines: Vec<&str> = one.0.lines().collect();
    assert!(lines[0].starts_with("clip") && lines[0].contains("foot-slide"), "{}", one.0);
    assert!(
        lines[1].starts_with("a_stands")
            && lines[2].starts_with("b_slides")
            && lines[3].replace('\\', "/").starts_with("more/c.bvh"),
        "{}",
        one.0
    );
    assert!(lines[4].starts_with("3 clips"), "{}", one.0);
    let found = shell.json(&["*.bvh"], 0);
    assert_eq!(found.as_array().map(Vec::len), Some(2), "a pattern that no shell expanded");
    let told = shell.audit(&["*.fbx"], 2);
    assert!(told.err.contains("*.fbx: no clip there"), "{}", told.err);
}

#[test]
fn what_cannot_be_read_is_told_and_the_rest_goes_on() {
    let shell = Shell::new();
    shell.put("broken.bvh", &gliding(0.0, 0.0).replacen("Frames: 120", "Frames: 500", 1));
    let told = shell.audit(&[".", "--json", "found.json"], 2);
    assert!(
        told.out.contains("a_stands") && told.out.contains("b_slides") && told.out.contains("1 could not be read"),
        "{}",
        told.out
    );
    assert!(told.out.contains("broken.bvh: line ") && told.err.contains("1 of 3 clips"), "{}{}", told.out, told.err);
    let told = shell.audit(&[".", "--json", "-"], 2);
    assert!(told.err.contains("broken.bvh: line "), "where no table tells it: {}", told.err);
    let found: Value = serde_json::from_str(&shell.text("found.json")).expect("JSON");
    assert_eq!(found.as_array().map(Vec::len), Some(2), "what was read is written");
    let told = shell.audit(&["broken.bvh", "--json", "alone.json"], 2);
    assert!(told.err.contains("broken.bvh: line ") && !shell.path("alone.json").exists(), "{}", told.err);
    let told = shell.audit(&["nowhere.bvh"], 2);
    assert!(told.err.contains("nowhere.bvh: no such file"), "{}", told.err);
    let told = shell.audit(&["b_slides.bvh", "--clip", "walk"], 2);
    assert!(told.err.contains("b_slides") && told.err.contains("walk"), "{}", told.err);
}

#[test]
fn an_input_is_never_overwritten() {
    let shell = Shell::new();
    let before = shell.text("b_slides.bvh");
    let told = shell.audit(&["b_slides.bvh", "--json", "b_slides.bvh"], 2);
    assert!(told.err.contains("never overwritten"), "{}", told.err);
    shell.audit(&["b_slides.bvh", "a_stands.bvh", "--json", "./a_stands.bvh"], 2);
    shell.audit(&["b_slides.bvh", "--write-waivers", "w.toml"], 0);
    shell.audit(&["b_slides.bvh", "--waive", "w.toml", "--write-waivers", "w.toml"], 2);
    shell.audit(
        &["b_slides.bvh", "--json", "x.json", "--csv", "x.csv", "--html", "x.html", "--write-waivers", "x.toml"],
        0,
    );
    shell.audit(&["b_slides.bvh", "--json", "same.csv", "--csv", "same.csv"], 2);
    assert_eq!(shell.text("b_slides.bvh"), before);
    assert!(!shell.path("same.csv").exists());
}

#[test]
fn the_table_has_a_row_a_frame_with_its_flags() {
    let shell = Shell::new();
    shell.put("glides.bvh", &gliding(30.0, 0.0));
    shell.audit(&["glides.bvh", "--csv", "g.csv"], 0);
    let found = shell.json(&["glides.bvh"], 0);
    let text = shell.text("g.csv");
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let head = "frame,time,com_x,com_y,com_z,speed,xi_x,xi_z,zmp_x,zmp_z,margin,left_contact,right_contact,\
                left_sole_height,right_sole_height,flags,clip,file";
    assert_eq!(lines[0], head.split(',').collect::<Vec<_>>());
    assert_eq!((lines.len(), lines[1].len()), (121, 18));
    let cell = |frame: usize, name: &str| lines[frame + 1][lines[0].iter().position(|head| *head == name).expect(name)];
    assert_eq!((cell(0, "left_contact"), cell(75, "right_contact")), ("flat", "flat"));
    let flags = found["flags"].as_array().expect("flags");
    assert!(!flags.is_empty(), "a figure that glides without a step");
    for frame in 0..120 {
        let within = |flag: &&Value| flag["start"].as_u64() <= Some(frame) && Some(frame) <= flag["end"].as_u64();
        let rules: std::collections::BTreeSet<&str> =
            flags.iter().filter(within).filter_map(|flag| flag["rule"].as_str()).collect();
        let told: std::collections::BTreeSet<&str> =
            cell(frame as usize, "flags").split('|').filter(|rule| !rule.is_empty()).collect();
        assert_eq!(told, rules, "frame {frame}");
    }
    let number = |frame: usize, name: &str| cell(frame, name).parse::<f64>().expect(name);
    assert!((number(75, "speed") - 0.3).abs() < 0.03, "it glides at 0.3 m/s");
    assert!((number(119, "com_z") - number(0, "com_z") - 0.3).abs() < 0.005, "0.3 m on");
    let lead = number(75, "xi_z") - number(75, "com_z");
    let wanted = 0.3 / (9.81 / number(75, "com_y")).sqrt();
    assert!((lead - wanted).abs() < 0.02, "ξ leads by v/ω: {lead} {wanted}");
    assert!(number(0, "margin") > 0.0, "who stands is inside of his feet");
}

#[cfg(unix)]
#[test]
fn hostile_names_stay_names() {
    let shell = Shell::new();
    let name = "\u{1b}[31m<img src=x onerror=alert(1)>\"&.bvh";
    shell.put(name, &gliding(0.0, 30.0));
    let told = shell.audit(&[name, "--html", "h.html", "--csv", "h.csv", "--write-waivers", "h.toml"], 0);
    assert!(!told.out.contains('\u{1b}') && !told.err.contains('\u{1b}'), "no colour of the file's own");
    let page = shell.text("h.html");
    assert!(!page.contains("<img") && page.contains("\\u003cimg"), "text, not an element");
    fs::copy(shell.path("h.html"), page_path("hostile.html")).expect("copied");
    shell.audit(&[name, "--strict", "--waive", "h.toml"], 0);
}

#[test]
fn a_hostile_clip_name_cannot_leave_the_pages_data() {
    use surefoot::audit::{AuditOptions, audit};
    use surefoot::picture::report_frames::frame_rows;
    use surefoot::picture::report_page::{ClipView, clip_json, report_page};
    let mut capture = surefoot::mocap::read_bvh("x.bvh", &gliding(0.0, 30.0)).expect("a clip");
    capture.name = "</script><img src=x onerror=alert(1)><script>alert(2)</script>\u{2028}{{data}}".to_owned();
    capture.notes.push("<b onmouseover=alert(3)>".to_owned());
    let findings = audit(&capture, &AuditOptions::default());
    let rows = frame_rows(&capture, &findings);
    let none = vec![None; findings.flags.len()];
    let waived: Vec<Option<String>> = none.iter().map(|_: &Option<String>| Some("<i>ok</i>".to_owned())).collect();
    let view = ClipView {
        file: "<x>.bvh",
        capture: &capture,
        findings: &findings,
        rows: &rows,
        waived: &none,
        waived_clip: &[],
    };
    let clips = [clip_json(&view, 1 << 20), clip_json(&ClipView { waived: &waived, ..view }, 1 << 20)];
    let page = report_page(&capture.name, &clips);
    assert_eq!(
        (page.matches("<script").count(), page.matches("<img").count(), page.matches("onmouseover").count()),
        (2, 0, 2)
    );
    fs::write(page_path("hostile_clip.html"), &page).expect("can be written");

    let small = clip_json(&view, 9_000);
    let value: Value = serde_json::from_str(&small).expect("JSON");
    assert!(small.len() <= 9_000 && value["stride"].as_u64() > Some(1), "{} bytes, decimated", small.len());
    let samples = value["curves"].as_array().map_or(0, Vec::len) / value["curveNames"].as_array().map_or(1, Vec::len);
    let stride = value["stride"].as_u64().expect("a number") as usize;
    assert_eq!(samples, rows.len().div_ceil(stride));
}

#[test]
fn pages_of_real_clips_are_small_and_complete() {
    let Some(data) = data::folder() else { return };
    let shell = Shell::new();
    for (name, file) in [
        ("walk", "audit/walk_normal_001.bvh"),
        ("turn", "audit/walk-turn-left_feminine_011.bvh"),
        ("hops", "clips/cmu_01_01_hops.bvh"),
    ] {
        let page = page_path(&format!("{name}.html"));
        let told = shell.audit(&[&data.join(file).display().to_string(), "--html", &page.display().to_string()], 0);
        assert!(told.out.contains("confidence"), "{}", told.out);
        let size = fs::metadata(&page).expect("written").len();
        assert!((50_000..3_000_000).contains(&size), "{name}: {size} bytes");
    }
    let folder = data.join("audit").display().to_string();
    let page = page_path("folder.html");
    let told = shell.audit(&[&folder, "--html", &page.display().to_string()], 0);
    let clips = fs::read_dir(Path::new(&folder)).expect("the data").count();
    assert_eq!(told.out.lines().count(), clips + 2, "a head, a line a clip, the sum:\n{}", told.out);
    assert!(fs::metadata(&page).expect("written").len() < 10_000_000);
}
