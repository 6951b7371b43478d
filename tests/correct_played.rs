//! Corrected clips of curves for other programs to play: left in target/baked with the tool's own pose, as a file is played there.
//!
//! Shoves and walks are baked on the built-in rig and on a third party's, faults planted and corrected. Blender's importer drops a
//! spline's tangents (tests/tools/blender_check.py): what it shows is compared by hand, outside and inside of what was corrected.

use crate::audit_faults::{self, Planted, Way};
use crate::common::builtin;
use crate::correct::{file_with, read};
use crate::data;
use crate::export::baked_path;
use glam::DAffine3;
use serde_json::{Value, json};
use surefoot::bake::{BakeOptions, Curves, bake};
use surefoot::correct::{CorrectOptions, correct};
use surefoot::export::glb;
use surefoot::maths::seed::Seed;
use surefoot::mocap::{ClipFile, Options, Reading};
use surefoot::model::{Capture, Scenario, scenario_text};
use surefoot::rig::clips::{Join, read_tracks};
use surefoot::rig::{Rig, load};

const WALK: &str = "title = \"walk\"\nduration = 6.0\n[[walk]]\nstart = 0.3\nspeed = 1.1\n";

type Plant = fn(&Capture, &mut Seed) -> Option<Planted>;

const FAULTS: [(&str, Plant); 4] = [
    ("plant", |clip, seed| audit_faults::moved_plant(clip, Way::Outward, 0.2, seed)),
    ("pelvis", |clip, seed| audit_faults::moved_pelvis(clip, 0.25, seed)),
    ("lifted", |clip, seed| audit_faults::lifted(clip, 0.06, seed)),
    ("slide", |clip, seed| audit_faults::slide(clip, 0.2, seed)),
];

#[test]
fn corrected_curves_are_left_for_other_programs_to_play() {
    let mut rigs = vec![("builtin".to_owned(), None, builtin())];
    if let Some(data) = data::more() {
        let file = "m2m_human_male.glb";
        rigs.push(("m2m".to_owned(), Some(file), load(&data.join("rigs").join(file)).expect("a rig")));
    }
    for (name, source, rig) in rigs {
        for scenario in [Scenario::demo(), scenario_text::parse("walk.toml", WALK).expect("a scenario")] {
            let baked = bake(&rig, &scenario, &BakeOptions { curves: Curves::Spline, ..BakeOptions::default() })
                .expect("bakes");
            let clip = baked.clip.name.clone();
            let file = read("baked.glb", &glb(&rig, &[(baked.clip, baked.report)]).expect("writes").bytes);
            let index = file.clips.iter().position(|other| *other == clip).expect("it is in it");
            let reading = file.reading(index, &Options::default()).expect("a clip");
            let mut mended = 0;
            for (fault, plant) in FAULTS {
                let Some(planted) = plant(&reading.capture, &mut Seed::new(5)) else { continue };
                let spoiled = file_with(&file, &reading, index, &planted.capture);
                let spoiled = read("spoiled.glb", &spoiled);
                let again = spoiled.reading(index, &Options::default()).expect("a clip");
                let corrected = correct(&again.capture, &CorrectOptions::default());
                if corrected.changed.is_empty() {
                    continue;
                }
                mended += 1;
                let bytes = file_with(&spoiled, &again, index, &corrected.capture);
                let out = format!("corrected_{name}_{}_{fault}.glb", clip.replace(' ', "_"));
                std::fs::write(baked_path(&out), &bytes).expect("can be written");
                if let Some(source) = source {
                    std::fs::write(baked_path(&format!("{out}.source")), source).expect("can be written");
                }
                let changed: Vec<usize> = corrected.changed.keys().copied().collect();
                dump(&read(&out, &bytes), &again, index, &rig, &out, &changed);
            }
            assert!(mended > 0, "{name} {clip}: no fault was corrected");
        }
    }
}

/// Where the body's nodes are through a clip, frame by frame and between frames, as tests/tools/blender_check.py reads it.
fn dump(file: &ClipFile, reading: &Reading, index: usize, rig: &Rig, out: &str, changed: &[usize]) {
    let (document, nodes) = (file.document().expect("glTF"), file.nodes().expect("glTF"));
    let tracks = read_tracks(document, nodes.len(), index).expect("tracks");
    let curves = tracks.list.iter().filter(|track| track.join == Join::CubicSpline).count();
    assert!(curves > 10, "{out}: {curves} curves: this is to be about curves");
    let order = reading.rig.parents_first();
    let fps = reading.capture.fps;
    let seconds = |frame: f64| reading.start + frame / fps;
    let steps = 2 * (reading.capture.frames() - 1);
    let samples: Vec<Value> = (0..=steps)
        .map(|step| {
            let time = seconds(step as f64 / 2.0);
            let mut places = vec![DAffine3::IDENTITY; nodes.len()];
            for &node in &order {
                let above = nodes[node].parent.map_or(DAffine3::IDENTITY, |parent| places[parent]);
                places[node] = above * tracks.local(node, time, &nodes[node].local).affine();
            }
            let nodes: Vec<Value> = (reading.rig.joint_nodes.iter().flatten())
                .map(|node| {
                    let place = places[*node].translation;
                    json!([node, place.x, place.y, place.z])
                })
                .collect();
            json!({ "time": time, "nodes": nodes })
        })
        .collect();
    let names: Vec<Option<&str>> = nodes.iter().map(|node| node.name.as_deref()).collect();
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let mut last = None;
    for frame in changed {
        match spans.last_mut() {
            Some(span) if last == frame.checked_sub(1) => span.1 = seconds(*frame as f64 + 1.0),
            _ => spans.push((seconds(*frame as f64 - 1.0), seconds(*frame as f64 + 1.0))),
        }
        last = Some(*frame);
    }
    let dump = json!({ "file": out, "clip": tracks.name, "unit": rig.document_from_scenario.scale, "names": names,
        "samples": samples, "changed": spans });
    std::fs::write(baked_path(&format!("{out}.pose.json")), serde_json::to_vec(&dump).expect("JSON"))
        .expect("can be written");
}
