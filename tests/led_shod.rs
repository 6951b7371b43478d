//! Clips of the articulated body in shoes: toe joints at half the foot's length, and feet that are long for their legs.
//!
//! By its own torques alone, on grounds and at speeds that are drawn. Third-party rigs; without them nothing is tested here.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::data;
use crate::led_ground::{baked, walk};
use rayon::prelude::*;
use surefoot::bake::Baked;
use surefoot::maths::seed::Seed;
use surefoot::model::report::Outcome;
use surefoot::rig::load;

/// Bakes a walk of 15 s for each seed, on that ground at that Froude-equal speed, and asserts that none falls and how they score.
#[track_caller]
fn walks(file: &str, legs: f64, least: f64, draw: impl Fn(&mut Seed) -> (String, f64) + Sync) {
    let Some(path) = data::file(&format!("rigs/{file}")) else { return };
    let rig = load(&path).expect("the rig loads");
    let clips: Vec<(String, Baked)> = (0..12u64)
        .into_par_iter()
        .map(|seed| {
            let (ground, pace) = draw(&mut Seed::new(seed ^ 0x5B0D));
            let pace = pace * (legs / 0.83).sqrt();
            let text = format!("title = \"shod\"\nduration = 15.0\n{ground}{}", walk(pace));
            (format!("{seed} at {pace:.2} m/s {}", ground.replace('\n', " ")), baked(&rig, &text, seed))
        })
        .collect();
    let mut sum = 0.0;
    for (name, clip) in &clips {
        let (report, score) = (&clip.report, clip.report.plausibility.score);
        println!("{file} {name}: {:?}, score {score:.2}", report.outcome);
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        sum += score;
    }
    let mean = sum / clips.len() as f64;
    println!("{file}: mean score {mean:.3}");
    assert!(mean >= least, "{file}: {mean:.3}");
}

#[test]
fn a_foot_that_bends_in_its_middle_climbs_stairs_and_slopes() {
    walks("gdquest_mannequiny.glb", 0.82, 0.94, |draw| {
        let way = if draw.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
        let tread = draw.between(0.3, 0.36);
        let stairs = format!("[ground]\nkind = \"stairs\"\nrise = {:.2}\ntread = {tread:.3}\ncount = 8\n", 0.17 * way);
        (stairs, draw.between(0.25, 0.35))
    });
    walks("gdquest_mannequiny.glb", 0.82, 0.94, |draw| {
        let slope = format!("[ground]\nkind = \"slope\"\nangle = {:.1}\n", draw.between(10.0, 18.0));
        (slope, draw.between(0.35, 0.5))
    });
}

#[test]
fn feet_that_are_long_for_their_legs_walk() {
    walks("godette_vrm0.vrm", 0.44, 0.94, |draw| (String::new(), draw.between(0.2, 0.9)));
}
