//! The schemas of `exports/` and what the program writes have the same keys, both ways, and `exports/README.md` explains each of them.
//!
//! Keys are compared as paths (`contacts[].slip_mm`). The reports here are whole literals: a new field does not compile until it stands here, and then
//! fails until the schema and the page have it. Files in the gallery are compared one way. `tests/tools/schema_check.mjs` checks values too.

use crate::correct::{as_if, baked_bytes, read as clip_file};
use crate::shell::Shell;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use surefoot::correct::{Done, told};
use surefoot::mocap::Options;
use surefoot::model::findings::{Abstained, ClipFlag, Findings, Flag, FootContact, Rule, StepVerdict};
use surefoot::model::report::{
    Assist, BaseReport, BodyReport, ClipReport, Contact, Disturbance, Drift, Event, JointTorque, LoopReport, Outcome,
    Part, Plausibility, Scuff, Search,
};
use surefoot::model::{Capture, Side};

type Keys = BTreeSet<String>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn schema(name: &str) -> Value {
    let text = fs::read_to_string(root().join(format!("exports/{name}.schema.json"))).expect("a schema");
    serde_json::from_str(&text).expect("JSON")
}

/// The keys that a schema knows, and those of them that must be there. Every object must refuse others.
fn known(schema: &Value, of: &Value, place: &str, all: &mut Keys, required: &mut Keys) {
    if let Some(path) = of["$ref"].as_str() {
        let target = schema.pointer(path.trim_start_matches('#')).expect("a definition");
        return known(schema, target, place, all, required);
    }
    if let Some(items) = of.get("items") {
        known(schema, items, &format!("{place}[]"), all, required);
    }
    let Some(properties) = of.get("properties").and_then(Value::as_object) else { return };
    assert_eq!(of["additionalProperties"], json!(false), "{place}: other keys are to be refused");
    for (key, value) in properties {
        let path = format!("{place}.{key}");
        assert!(value.get("$ref").is_some() || value.get("description").is_some(), "{path}: no description");
        let must = of["required"].as_array().into_iter().flatten().any(|name| name == key);
        if must {
            required.insert(path.clone());
        }
        all.insert(path.clone());
        known(schema, value, &path, all, required);
    }
}

fn known_of(schema: &Value, of: &Value) -> (Keys, Keys) {
    let (mut all, mut required) = (Keys::new(), Keys::new());
    known(schema, of, "", &mut all, &mut required);
    (all, required)
}

/// The keys of a value.
fn keys(value: &Value, place: &str, found: &mut Keys) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| keys(item, &format!("{place}[]"), found)),
        Value::Object(fields) => {
            for (key, value) in fields {
                let path = format!("{place}.{key}");
                found.insert(path.clone());
                keys(value, &path, found);
            }
        }
        _ => {}
    }
}

fn keys_of(value: &Value) -> Keys {
    let mut found = Keys::new();
    keys(value, "", &mut found);
    found
}

/// A report with everything in it.
fn report() -> ClipReport {
    let contact = Contact {
        foot: Side::Left,
        part: Part::Flat,
        start: 0.0,
        end: 1.0,
        frame: "world".into(),
        position: [0.0; 3],
        normal: [0.0, 1.0, 0.0],
        slip_mm: 0.1,
    };
    let hit = Event {
        time: 0.5,
        name: "ball_hit".into(),
        foot: Some(Side::Left),
        bone: Some("chest".into()),
        impulse: Some(3.0),
    };
    let push =
        Disturbance { kind: "push".into(), start: 0.2, end: 0.4, force: [300.0, 0.0, 0.0], bone: "chest".into() };
    let base = BaseReport { clip: "Idle".into(), first_deg: 0.0, first_mm: 0.0, last_deg: 0.0, last_mm: 0.0 };
    let looped = LoopReport { period: 1.0, error_deg: 0.0, error_mm: 0.0, speed: 1.0, evened_deg: 0.0, evened_mm: 0.0 };
    ClipReport {
        version: 1,
        generator: "surefoot".into(),
        fps: 30.0,
        duration: 1.0,
        seed: 7,
        root_motion: "root".into(),
        drive: "stepper".into(),
        scenario: "shove".into(),
        outcome: Outcome::Step,
        steps: 1,
        body: BodyReport { mass: 89.5, height: 1.7 },
        contacts: vec![contact],
        scuffs: vec![Scuff { foot: Side::Right, start: 0.2, end: 0.3, slid_mm: 12.0 }],
        events: vec![hit],
        disturbances: vec![push],
        assist: Assist { peak_nm: 0.0, rms_nm: 0.0, peak_n: 0.0, rms_n: 0.0 },
        torques: vec![JointTorque { joint: "leftUpperLeg".into(), peak_nm: 100.0, share: 0.2 }],
        drift: Some(Drift { position_mm: 2.5, angle_deg: 1.25 }),
        search: Some(Search { effort: 1, tried: 12, chosen: 2 }),
        plausibility: Plausibility {
            score: 1.0,
            zmp_inside: 1.0,
            zmp_outside_p95_cm: 0.0,
            friction_p99: 0.3,
            vertical_min: 0.8,
            residual_force: 0.0,
            residual_moment: 0.0,
            slip_max_mm: 0.1,
            scuff_max_mm: 12.0,
            penetration_max_mm: 0.0,
            peak_ankle_speed: 4.0,
            speed_ratio: 1.0,
            speed_beyond: 0.0,
            hover_s: 0.0,
            hover_longest_s: 0.0,
            legs_mm: 170.0,
            joint_excess_deg: 0.0,
            joint_excess_share: 0.0,
            pops: 0,
            pops_deg: 0.0,
            end_stance_mm: 0.0,
            falls: false,
            notes: Vec::new(),
        },
        base: Some(base),
        looped: Some(looped),
    }
}

/// What a clip of which something was corrected reports.
fn corrected() -> Value {
    let file = clip_file("walk.glb", baked_bytes());
    let reading = file.reading(0, &Options::default()).expect("a clip");
    let was = serde_json::to_value(report()).expect("JSON");
    let mut done = as_if(&reading, &reading.capture);
    done.done.push(Done {
        start: 3,
        end: 9,
        rule: Rule::FootSlide,
        foot: None,
        moved_m: 0.1,
        what: "held".into(),
        held: Vec::new(),
        answers: Vec::new(),
    });
    let options = Options { fps: Some(reading.capture.fps * 4.0), ..Options::default() };
    let dense: Capture = file.capture(0, &options).expect("a clip");
    told::again(&was, &reading, &done, &dense).expect("an object")
}

/// Findings with everything in them, as `surefoot audit` writes them.
fn findings() -> Findings {
    let (why, foot) = (String::from("why"), Some("left"));
    let flag = Flag {
        start: 0,
        end: 1,
        rule: Rule::FootSlide,
        foot,
        severity: 0.5,
        measured: 0.1,
        predicted: 0.0,
        delta_m: 0.1,
        why: why.clone(),
    };
    let step = StepVerdict {
        foot: "left",
        touch_down: 9,
        lift_off: 3,
        predicted: [0.0; 2],
        actual: [0.0; 2],
        error_m: 0.0,
        error_forward_m: 0.0,
        error_sideways_m: 0.0,
        stopping_m: 0.0,
        lead_m: 0.0,
    };
    Findings {
        version: 1,
        clip: "walk".into(),
        fps: 30.0,
        frames: 10,
        units_to_metres: 0.01,
        up: "+Y".into(),
        confidence: 1.0,
        flags: vec![flag],
        clip_flags: vec![ClipFlag { rule: Rule::Timing, severity: 0.5, why: why.clone() }],
        contacts: vec![FootContact { foot: "left", part: "flat", start: 0, end: 9 }],
        steps: vec![step],
        abstained: vec![Abstained { start: 0, end: 1, why }],
        notes: Vec::new(),
    }
}

#[test]
fn the_schema_of_a_clip_has_the_keys_that_a_report_has_and_no_others() {
    let schema = schema("surefoot");
    let (all, required) = known_of(&schema, &schema);
    let baked = serde_json::to_value(report()).expect("JSON");
    let mut written = keys_of(&baked);
    written.extend(keys_of(&corrected()));
    assert_eq!(all, written, "exports/surefoot.schema.json and model/report.rs differ");
    let plain = keys_of(&baked);
    assert!(required.iter().all(|key| plain.contains(key) || key.starts_with(".corrected[]")), "{required:?}");
}

#[test]
fn the_clips_of_the_gallery_have_no_key_that_the_schema_lacks_and_all_that_it_requires() {
    let schema = schema("surefoot");
    let (all, required) = known_of(&schema, &schema);
    let mut seen = 0;
    for folder in fs::read_dir(root().join("exports/gallery")).expect("the gallery").flatten() {
        for file in fs::read_dir(folder.path()).into_iter().flatten().flatten() {
            if file.path().extension().is_none_or(|ending| ending != "glb") {
                continue;
            }
            let bytes = fs::read(file.path()).expect("a clip");
            let gltf = clip_file("a.glb", &bytes).document().expect("glTF").json.clone();
            for animation in gltf["animations"].as_array().into_iter().flatten() {
                let report = &animation["extras"]["surefoot"];
                let written = keys_of(report);
                assert!(written.is_subset(&all), "{:?}: {:?}", file.path(), written.difference(&all));
                let parent = |key: &str| key.rsplit_once('.').map_or("", |(parent, _)| parent).to_owned();
                let there = |place: &str| {
                    let list = place.trim_end_matches("[]");
                    list.is_empty()
                        || (written.contains(list)
                            && (list == place || written.iter().any(|key| key.starts_with(&format!("{place}.")))))
                };
                for key in required.iter().filter(|key| there(&parent(key))) {
                    assert!(written.contains(key), "{:?}: no {key}", file.path());
                }
                seen += 1;
            }
        }
    }
    assert!(seen >= 9, "{seen} clips");
}

#[test]
fn the_schema_of_an_audit_has_the_keys_that_findings_have_and_no_others() {
    let schema = schema("audit");
    let (all, required) = known_of(&schema, &schema["definitions"]["clip"]);
    let mut written = json!(findings());
    written["file"] = json!("walk.bvh");
    written["flags"][0]["waived"] = json!("why");
    written["clip_flags"][0]["waived"] = json!("why");
    assert_eq!(all, keys_of(&written), "exports/audit.schema.json and model/findings.rs differ");
    let rules = schema["definitions"]["rule"]["enum"].as_array().expect("rules").clone();
    assert_eq!(rules, Rule::ALL.map(|rule| json!(rule.name())));
    // What the commands write themselves.
    let take = root().join("exports/gallery/audit/walk.bvh");
    let shell = Shell::new();
    fs::copy(take, shell.path("walk.bvh")).expect("the gallery's walk");
    shell.run("audit walk.bvh --json first.json --write-waivers w.toml").exits(0);
    shell.run("audit walk.bvh --json second.json --waive w.toml").exits(0);
    let json = |name: &str| -> Value {
        serde_json::from_str(&fs::read_to_string(shell.path(name)).expect("written")).expect("JSON")
    };
    for name in ["first.json", "second.json"] {
        let written = keys_of(&json(name));
        assert!(written.is_subset(&all), "{:?}", written.difference(&all));
        assert!(required.iter().all(|key| key.contains("[]") || written.contains(key)), "{name}");
        assert_eq!(written.contains(".flags[].waived"), name == "second.json");
    }
    let (all, required) = known_of(&schema, &schema["definitions"]["correction"]);
    shell.run("correct walk.bvh -o out.bvh --json changed.json").exits(0);
    let written = keys_of(&json("changed.json"));
    assert!(written.is_subset(&all), "{:?}", written.difference(&all));
    assert!(required.iter().all(|key| key.matches("[]").count() > 0 || written.contains(key)), "{required:?}");
    assert!(written.contains(".changed[].moved_m"), "the gallery's walk is corrected");
}

#[test]
fn the_page_explains_every_key() {
    let page = fs::read_to_string(root().join("exports/README.md")).expect("the page");
    let (clip, audit) = (schema("surefoot"), schema("audit"));
    let (mut all, _) = known_of(&clip, &clip);
    for part in ["clip", "correction"] {
        all.extend(known_of(&audit, &audit["definitions"][part]).0);
    }
    for path in all {
        let key = path.rsplit('.').next().unwrap_or(&path);
        assert!(page.contains(&format!("`{key}`")), "exports/README.md does not explain `{key}` ({path})");
    }
}
