//! What a corrected clip that was baked here tells of itself in its extras: contacts, slips, plausibility.
//!
//! Feet are moved in the built-in rig's baked shove by the writer that is tested, so no third-party data is needed.

use crate::audit_faults;
use crate::correct::{as_if, baked_bytes, file_with, read};
use serde_json::Value;
use surefoot::correct::told;
use surefoot::mocap::Options;
use surefoot::model::{Capture, Side};

/// What a clip tells of itself.
fn extras(bytes: &[u8], clip: usize) -> Value {
    let json = read("walk.glb", bytes).document().expect("glTF").json.clone();
    json["animations"][clip]["extras"]["surefoot"].clone()
}

/// The shove, which is clip 0, four times as dense.
fn dense(bytes: &[u8], fps: f64) -> Capture {
    let options = Options { fps: Some(fps * 4.0), ..Options::default() };
    read("walk.glb", bytes).capture(0, &options).expect("a clip")
}

#[test]
fn a_clip_that_was_not_changed_tells_of_itself_as_it_was_baked() {
    let file = read("walk.glb", baked_bytes());
    let reading = file.reading(0, &Options::default()).expect("a clip");
    let told = extras(baked_bytes(), 0);
    let same = as_if(&reading, &reading.capture);
    let again = told::again(&told, &reading, &same, &dense(baked_bytes(), reading.capture.fps)).expect("an object");
    let number = |value: &Value, key: &str| value["plausibility"][key].as_f64().expect("a number");
    for (key, near) in [("score", 0.02), ("zmp_inside", 0.02), ("slip_max_mm", 0.2), ("penetration_max_mm", 0.5)] {
        let (was, is) = (number(&told, key), number(&again, key));
        assert!((was - is).abs() < near, "{key} {was} {is}");
    }
    assert_eq!(told["contacts"].as_array().map(Vec::len), again["contacts"].as_array().map(Vec::len));
    for (was, is) in
        told["contacts"].as_array().expect("a list").iter().zip(again["contacts"].as_array().expect("a list"))
    {
        assert_eq!(was["position"], is["position"]);
        assert!((was["slip_mm"].as_f64().expect("mm") - is["slip_mm"].as_f64().expect("mm")).abs() < 0.2, "{was} {is}");
    }
    for key in ["outcome", "steps", "events", "disturbances", "fps", "duration"] {
        assert_eq!(told[key], again[key], "{key}");
    }
}

#[test]
fn a_contact_whose_foot_was_moved_is_told_where_it_is_now_and_how_far_it_slips() {
    let file = read("walk.glb", baked_bytes());
    let reading = file.reading(0, &Options::default()).expect("a clip");
    let told = extras(baked_bytes(), 0);
    let fps = reading.capture.fps;
    // Of the first contact that lasts: moved by 6 cm in all of it, or slid by that much through it.
    let list = told["contacts"].as_array().expect("contacts").clone();
    let lasts = |contact: &&Value| contact["end"].as_f64() > contact["start"].as_f64().map(|start| start + 0.5);
    let contact = list.iter().find(lasts).expect("a stand");
    let side = if contact["foot"] == "left" { Side::Left } else { Side::Right };
    let frames = |contact: &Value| {
        let frame = |key: &str| (contact[key].as_f64().expect("s") * fps).round() as usize;
        (frame("start"), frame("end").min(reading.capture.frames() - 1))
    };
    let (start, end) = frames(contact);
    for slides in [false, true] {
        let mut capture = reading.capture.clone();
        for frame in start.saturating_sub(2)..=(end + 2).min(capture.frames() - 1) {
            let share = if slides { (frame.clamp(start, end) - start) as f64 / (end - start) as f64 } else { 1.0 };
            audit_faults::move_foot(&mut capture, frame, side, glam::DVec3::X * 0.06 * share * side.sign(), None);
        }
        let bytes = file_with(&file, &reading, 0, &capture);
        let again = told::again(&told, &reading, &as_if(&reading, &capture), &dense(&bytes, fps)).expect("an object");
        let index = list.iter().position(|one| one == contact).expect("it is there");
        let is = &again["contacts"][index];
        let x = |value: &Value| value["position"][0].as_f64().expect("m");
        let (moved, slip) = ((x(is) - x(contact)) * side.sign(), is["slip_mm"].as_f64().expect("mm"));
        if slides {
            assert!((0.02..0.04).contains(&moved) && (50.0..70.0).contains(&slip), "{moved} {slip}");
            assert!(again["plausibility"]["slip_max_mm"].as_f64() >= Some(50.0));
            assert!(again["plausibility"]["score"].as_f64() < told["plausibility"]["score"].as_f64());
        } else {
            assert!((moved - 0.06).abs() < 1e-3 && slip < 5.0, "{moved} {slip}");
        }
    }
    // What cannot be measured from the file is told no more.
    let mut carried = told.clone();
    carried["disturbances"] =
        serde_json::json!([{ "kind": "carry", "start": 0.0, "end": 1.0, "force": [0, -50, 0], "bone": "leftHand" }]);
    let same = as_if(&reading, &reading.capture);
    let again = told::again(&carried, &reading, &same, &dense(baked_bytes(), fps)).expect("an object");
    assert!(again.get("plausibility").is_none() && again["contacts"][0].get("slip_mm").is_none());
}
