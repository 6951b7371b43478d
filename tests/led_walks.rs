//! Clips of the articulated body that walks on level ground: its steps are alike, and shoves of the paper's range do not fell it.
//!
//! By its own torques alone, each clip of another person. Shoves are drawn as in "Watch Your Step": 10 to 500 N for 0.1 to 0.5 s.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::report::Outcome;
use surefoot::model::scenario_text;
use surefoot::ragdoll::control::Assist;
use surefoot::rig::Rig;

/// Bakes that scenario with joint torques alone, looking ahead as the command line does unless told otherwise.
fn baked(rig: &Rig, text: &str, seed: u64) -> Baked {
    let scenario = scenario_text::parse("walk", text).unwrap_or_else(|errors| panic!("{errors:?}\n{text}"));
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    bake(rig, &scenario, &BakeOptions { drive, seed: Some(seed), ..BakeOptions::default() }).expect("it bakes")
}

/// m, the lengths of the steps from 3 s on, along +Z.
fn steps(baked: &Baked) -> Vec<f64> {
    let landed = baked.performance.trace.steps.iter().filter(|step| step.land > 3.0);
    let along: Vec<f64> = landed.map(|step| step.to.ankle.z).collect();
    along.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// How unlike steps of the left and of the right foot are: the mean change from one to the next over the mean step.
fn limps(steps: &[f64]) -> f64 {
    let changes: f64 = steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    changes / ((steps.len() - 1) as f64 * mean)
}

/// The built-in rig and third-party ones.
fn rigs(names: &[&'static str]) -> Vec<(&'static str, Rig)> {
    let mut rigs = vec![("built-in", builtin())];
    if let Some(folder) = data::more() {
        for name in names {
            rigs.push((*name, surefoot::rig::load(&folder.join("rigs").join(name)).expect("the rig loads")));
        }
    }
    rigs
}

#[test]
fn nobody_drags_a_foot_who_walks_straight_ahead_at_up_to_a_metre_per_second() {
    let rigs = rigs(&["gdquest_mannequiny.glb", "m2m_rig_human.glb", "m2m_human_male.glb"]);
    let cases: Vec<_> = rigs.iter().flat_map(|rig| (0..4).map(move |index| (rig, index))).collect();
    let walked: Vec<_> = cases
        .into_par_iter()
        .map(|((name, rig), index)| {
            let speed = Seed::new(0xF007 ^ (index << 8) ^ name.len() as u64).between(0.25, 1.0);
            let text = format!("title = \"walk\"\nduration = 12.0\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n");
            (format!("{name} at {speed:.2} m/s"), baked(rig, &text, index).report.plausibility)
        })
        .collect();
    for (name, found) in &walked {
        println!("{name}: a foot slides by {:.0} mm at most, score {:.2}", found.scuff_max_mm, found.score);
    }
    for (name, found) in walked {
        assert!(found.scuff_max_mm < 60.0, "{name}: a foot slides by {:.0} mm", found.scuff_max_mm);
        assert!(found.score > 0.85, "{name}: {:.2}, {:?}", found.score, found.notes);
    }
}

#[test]
fn platforms_that_tilt_are_walked_turned_and_stood_on() {
    let rigs = rigs(&["gdquest_mannequiny.glb", "m2m_rig_human.glb"]);
    let cases: Vec<_> = rigs.iter().flat_map(|rig| (0..6).map(move |index| (rig, index))).collect();
    let fell: Vec<String> = cases
        .into_par_iter()
        .filter_map(|((name, rig), index)| {
            let mut draw = Seed::new(0x7117 ^ (index << 8) ^ name.len() as u64);
            let [pitch, roll] = [0; 2].map(|_| draw.between(-12.0, 12.0));
            let (turn, speed) = (draw.between(-170.0, 170.0), draw.between(0.1, 0.3));
            let tilts =
                format!("pitch = [[0, 0], [4, {pitch:.1}], [8, {:.1}]]\nroll = [[0, 0], [3, {roll:.1}]]", -pitch);
            let does = match index % 3 {
                0 => format!("[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n[[walk]]\nstart = 5\nspeed = 0"),
                1 => format!("[[turn]]\nstart = 1\nfacing = {turn:.0}"),
                _ => "[[stand]]\nstart = 1\nduration = 6\non = \"left\"".into(),
            };
            let text = format!("title = \"tilts\"\nduration = 10\n[ground]\nkind = \"platform\"\n{tilts}\n{does}\n");
            let clip = baked(rig, &text, index);
            (clip.report.outcome == Outcome::Fall).then(|| format!("{name}:\n{text}"))
        })
        .collect();
    assert!(fell.is_empty(), "{}", fell.join("\n"));
}

#[test]
fn nobody_limps_who_walks_straight_ahead() {
    let rigs = rigs(&["gdquest_mannequiny.glb", "m2m_rig_human.glb"]);
    let cases: Vec<_> =
        rigs.iter().flat_map(|rig| [0.4, 0.6, 0.8, 0.9, 1.0, 1.1, 1.2].map(|speed| (rig, speed))).collect();
    let walked: Vec<_> = cases
        .into_par_iter()
        .map(|((name, rig), speed)| {
            let text = format!("title = \"walk\"\nduration = 12.0\n[[walk]]\nstart = 0.5\nspeed = {speed}\n");
            (format!("{name} at {speed} m/s"), limps(&steps(&baked(rig, &text, 5))))
        })
        .collect();
    for (name, limp) in &walked {
        println!("{name}: steps differ by {limp:.3} of their length");
    }
    for (name, limp) in walked {
        assert!(limp < 0.12, "{name}: steps differ by {limp:.3} of their length");
    }
}

#[test]
fn nine_of_ten_shoves_of_the_papers_range_do_not_fell_who_walks() {
    let rig = builtin();
    let one = |index: u64| {
        let mut draw = Seed::new(0x5107E ^ index);
        let (start, lasts) = (draw.between(3.0, 5.0), draw.between(0.1, 0.5));
        let (force, toward) = (draw.between(10.0, 500.0), draw.between(0.0, 360.0));
        let push = format!("start = {start:.3}\nduration = {lasts:.3}\nforce = {force:.1}\ntoward = {toward:.1}");
        let walk = "[[walk]]\nstart = 0.5\nspeed = 1.2";
        let text = format!("title = \"shove\"\nduration = {:.2}\n{walk}\n[[push]]\n{push}\n", start + 4.5);
        let clip = baked(&rig, &text, index);
        (clip.report.outcome == Outcome::Fall).then(|| format!("{:.0} Ns toward {toward:.0}", force * lasts))
    };
    let fell: Vec<String> = (0..64).into_par_iter().filter_map(one).collect();
    println!("{} of 64 keep their feet; fell: {}", 64 - fell.len(), fell.join(", "));
    assert!(fell.len() <= 6, "{} of 64 fall: {}", fell.len(), fell.join(", "));
}
