//! Walks as fast as people walk, and faster: from a brisk one to where they would run.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::people::people;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::report::Outcome;
use surefoot::model::scenario_text;
use surefoot::rig::Rig;

/// Of 1: the scores of each clip, and of all.
const LEAST: f64 = 0.8;
const MEAN: f64 = 0.93;

fn walked(rig: &Rig, legs: f64, speed: f64) -> Baked {
    let text = format!(
        "title = \"quick\"\nduration = 8\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n"
    );
    let scenario = scenario_text::parse("quick", &text).unwrap_or_else(|errors| panic!("{errors:?}\n{text}"));
    bake(rig, &scenario, &BakeOptions::default()).expect("it bakes")
}

/// m/s of the hips, over the last four seconds.
fn speed(rig: &Rig, clip: &Baked) -> f64 {
    let hips = |time: f64| rig.sample(&clip.clip, time).hips;
    (hips(8.0) - hips(4.0)).length() / 4.0
}

#[test]
fn who_walks_as_fast_as_legs_go_keeps_his_feet_and_his_speed() {
    let people = people(&[1.0, 0.7, 1.3], &["gdquest_mannequiny.glb", "m2m_human_male.glb", "khronos_CesiumMan.gltf"]);
    let clips: Vec<(String, f64, Baked)> = (0..20_u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x2011);
            let (rig, legs) = &people[seed as usize % people.len()];
            let wanted = draw.between(1.3, 1.8) * (legs * rig.body.leg_length / 0.83).sqrt();
            let clip = walked(rig, *legs, wanted);
            let off = speed(rig, &clip) / wanted - 1.0;
            (format!("{seed}: {wanted:.2} m/s, legs {legs}, {:+.1} %", 100.0 * off), off, clip)
        })
        .collect();
    let mut mean = 0.0;
    for (name, _, clip) in &clips {
        let score = &clip.report.plausibility;
        println!("{name}: {:?}, {:.2}, {:?}", clip.report.outcome, score.score, score.notes);
        mean += score.score / clips.len() as f64;
    }
    println!("mean score {mean:.3}");
    for (name, off, clip) in &clips {
        let score = &clip.report.plausibility;
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
        assert!(off.abs() < 0.05, "{name}");
        assert!(score.score >= LEAST, "{name}: {:.2}", score.score);
    }
    assert!(mean >= MEAN, "{mean:.3}");
}

#[test]
fn who_is_to_walk_faster_than_people_do_walks_as_fast_as_they_do_and_is_told() {
    for (rig, legs) in people(&[1.0, 0.7], &[]) {
        let most = (0.5 * 9.81 * legs * rig.body.leg_length).sqrt();
        let clip = walked(&rig, legs, 2.6);
        let told = format!("runs above {most:.2} m/s");
        assert!(clip.warnings.iter().any(|warning| warning.contains(&told)), "{:?}", clip.warnings);
        assert!((speed(&rig, &clip) / most - 1.0).abs() < 0.05, "legs {legs}: {:.2} m/s", speed(&rig, &clip));
        assert_ne!(clip.report.outcome, Outcome::Fall, "legs {legs}");
    }
}
