//! Bodies and numbers that are none, or that are far from a person's, through the command line with the articulated body: an error that
//! names the file and a remedy, or a clip of finite numbers; never a panic.

use crate::hostile::person;
use crate::shell::{Shell, Told};
use serde_json::{Value, json};
use std::fs;

/// A push of so many newtons on the chest for 0.2 s, and what `[character]` says.
fn shove(newtons: f64, character: &str) -> String {
    let character = if character.is_empty() { String::new() } else { format!("[character]\n{character}\n") };
    let push = format!("[[push]]\nstart = 0.4\nduration = 0.2\nforce = {newtons:?}\ntoward = 70\nat = \"chest\"\n");
    format!("title = \"odd\"\nduration = 2.0\n{character}{push}")
}

/// The stick person with every joint so many times as far from its parent, changed further by name.
fn stick(times: f64, change: &dyn Fn(&str, &mut Value)) -> Vec<u8> {
    let mut json: Value = serde_json::from_slice(&person()).expect("it is whole");
    for node in json["nodes"].as_array_mut().expect("nodes") {
        let name = node["name"].as_str().unwrap_or_default().to_owned();
        for number in node["translation"].as_array_mut().into_iter().flatten() {
            *number = json!(number.as_f64().expect("a number") * times);
        }
        change(&name, node);
    }
    json.to_string().into_bytes()
}

fn baked(rig: &[u8], scenario: &str, drive: &str) -> Told {
    let shell = Shell::with(&[("odd.toml", scenario)]);
    fs::write(shell.path("odd.gltf"), rig).expect("the test's own folder");
    shell.run(&format!("bake odd.gltf odd.toml --drive {drive} --json -o odd.glb"))
}

/// A number that is none is written as null: none is where a number belongs.
fn is_sound(told: &Told) {
    let told = told.json();
    let report = &told["report"];
    let number = |value: &Value| value.as_f64().expect("a number");
    assert!((0.0..=1.0).contains(&number(&report["plausibility"]["score"])), "{report}");
    assert!(number(&report["body"]["height"]) > 0.2 && number(&report["body"]["mass"]) > 0.0, "{report}");
    for contact in report["contacts"].as_array().expect("contacts") {
        assert!(
            contact["position"].as_array().expect("a place").iter().all(|value| number(value).abs() < 1e7),
            "{contact}"
        );
    }
}

#[test]
fn a_rig_of_three_centimetres_or_of_thirty_metres_is_taken_for_a_person_and_bakes() {
    // A millionth, 3 cm, half of a person, thirty metres, a million times.
    for times in [1e-6, 0.018, 0.5, 18.0, 1e6] {
        let told = baked(&stick(times, &|_, _| ()), &shove(40.0, ""), "ragdoll").exits(0);
        if !(0.3..2.0).contains(&times) {
            assert!(told.err.contains("odd.gltf: the body is") && told.err.contains("units high"), "{}", told.err);
        }
        is_sound(&told);
    }
}

#[test]
fn no_mass_and_masses_that_are_no_numbers_are_refused_with_the_place_and_what_to_give() {
    for (mass, named) in [("0.0", "out of range"), ("-5.0", "out of range"), ("nan", "finite"), ("inf", "finite")] {
        let shell = Shell::with(&[("odd.toml", &shove(100.0, &format!("mass = {mass}")))]);
        let told = shell.run("bake builtin odd.toml --drive ragdoll -o odd.glb").exits(2);
        told.says(&["odd.toml", "mass", named, "help: give"]);
        assert_eq!(shell.files(), ["odd.toml"], "nothing was written");
    }
}

#[test]
fn joints_that_are_at_no_place_are_refused_by_name() {
    for text in ["1e300", "1e39", "null", "\"NaN\""] {
        let value: Value = serde_json::from_str(text).expect("JSON");
        let hand = |name: &str, node: &mut Value| {
            if name == "leftHand" {
                node["translation"][0] = value.clone();
            }
        };
        baked(&stick(1.0, &hand), &shove(100.0, ""), "ragdoll").exits(2).says(&["odd.gltf", "translation"]);
    }
}

#[test]
fn limbs_without_length_bake_or_are_refused_in_words() {
    let nothing = |named: &'static [&'static str]| {
        move |name: &str, node: &mut Value| {
            if named.contains(&name) {
                node["translation"] = json!([0.0, 0.0, 0.0]);
            }
        }
    };
    let limbs: [&[&str]; 4] = [
        &["leftLowerArm", "rightLowerArm", "leftHand", "rightHand"],
        &["neck", "head"],
        &["leftLowerLeg"],
        &["leftFoot", "rightFoot", "leftToes", "rightToes"],
    ];
    for named in limbs {
        let told = baked(&stick(1.0, &nothing(named)), &shove(60.0, ""), "ragdoll");
        match told.code {
            0 => is_sound(&told),
            2 => assert!(told.err.contains("odd.gltf: ") && told.err.contains("--drive stepper"), "{}", told.err),
            other => panic!("{named:?}: exit code {other}: {}", told.err),
        }
    }
}

#[test]
fn who_is_thrown_about_faster_than_any_body_is_told_what_to_change() {
    // 1000 m/s for a body of 1 kg, to either side: the part is named on the side where it is.
    for toward in ["70", "-70"] {
        let scenario = shove(5000.0, "mass = 1.0").replace("70", toward);
        let shell = Shell::with(&[("odd.toml", &scenario)]);
        let told = shell.run("bake builtin odd.toml --drive ragdoll -o odd.glb").exits(2);
        let told = told.says(&["builtin: the ragdoll cannot go on at 0.", "1.0 kg", "mass", "--drive stepper"]);
        assert_eq!(shell.files(), ["odd.toml"], "nothing was written: {}", told.err);
        let told = shell.run("bake builtin odd.toml --drive auto --json -o odd.glb").exits(0);
        let choice = &told.json()["choice"];
        assert_eq!(choice["drive"], "stepper", "{choice}");
        assert!(choice["why"].as_str().expect("a reason").contains("the ragdoll cannot go on"), "{choice}");
    }
}
