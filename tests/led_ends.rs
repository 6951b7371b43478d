//! Clips of the articulated body that sets out and comes to a stand again: how wide it steps, and how soon its feet are side by side.
//!
//! By its own torques alone, at speeds that are drawn; times and speeds are those of legs of 0.83 m.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::led_ground::baked;
use crate::people::people;
use rayon::prelude::*;
use surefoot::bake::Baked;
use surefoot::maths::seed::Seed;
use surefoot::model::report::Outcome;
use surefoot::rig::Rig;

/// Rigs, how long their legs are made, and what that makes of a second at legs of 0.83 m.
fn bodies() -> Vec<(Rig, f64, f64)> {
    let files =
        ["m2m_rig_human.glb", "m2m_human_male.glb", "m2m_ue_names_wrong_bone_count.glb", "gdquest_mannequiny.glb"];
    let bodies = people(&[0.7, 1.0, 1.15, 1.3], &files);
    bodies.into_iter().map(|(rig, legs)| (rig, legs, legs.sqrt())).collect()
}

/// s from the end of the walk on until the last foot is down, and how many were set down.
fn rests(clip: &Baked, end: f64) -> (f64, usize) {
    let landed = clip.performance.trace.steps.iter().map(|step| step.land).filter(|land| *land > end);
    landed.fold((0.0, 0), |(last, count), land| (f64::max(last, land - end), count + 1))
}

#[test]
fn who_stops_sets_his_last_foot_beside_the_other() {
    let bodies = bodies();
    let clips: Vec<_> = (0..48u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x5709);
            let (rig, legs, tempo) = &bodies[seed as usize % bodies.len()];
            let (speed, lasts) = (draw.between(0.2, 1.3) * tempo, draw.between(4.0, 7.0));
            let end = 0.5 + lasts;
            let lane = match seed / 8 % 3 {
                0 => String::new(),
                1 => format!("[[crouch]]\nstart = 2.0\nduration = {:.1}\namount = 0.15\n", lasts + 2.0),
                _ => format!("[ground]\nkind = \"slope\"\nangle = {:.1}\n", draw.between(-12.0, 6.0)),
            };
            let speed = if lane.is_empty() { speed } else { speed.min(0.6 * tempo) };
            let text = format!(
                "title = \"stop\"\nduration = {:.2}\n[character]\nleg_scale = {legs}\n{lane}[[walk]]\nstart = 0.5\n\
                 duration = {lasts:.2}\nspeed = {speed:.3}\n",
                end + 4.0
            );
            let clip = baked(rig, &text, seed);
            let (late, steps) = rests(&clip, end);
            (
                format!("{seed}: legs {legs}, {speed:.2} m/s {}", lane.replace('\n', " ")),
                late / tempo,
                steps,
                clip.report,
            )
        })
        .collect();
    let (mut late, mut unclean, mut sum) = (0, 0, 0.0);
    for (name, rests, steps, report) in &clips {
        let score = &report.plausibility;
        println!("{name}: {steps} steps, the feet rest {rests:.2} s after it, score {:.2}", score.score);
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        late += usize::from(*rests > 2.5);
        unclean += usize::from(score.notes.iter().any(|note| note.contains("side by side")));
        sum += score.score;
    }
    let mean = sum / clips.len() as f64;
    println!("{late} of {} are late, {unclean} end in a stride, mean score {mean:.3}", clips.len());
    assert!(late <= 2, "{late} of {} are not at rest after 2.5 s", clips.len());
    assert!(unclean <= 1, "{unclean} of {} end with their feet apart", clips.len());
    assert!(mean >= 0.97, "{mean:.3}");
}

#[test]
fn who_sets_out_steps_no_wider_than_he_stood() {
    let bodies = bodies();
    let found: Vec<(String, f64)> = (0..24u64)
        .into_par_iter()
        .map(|seed| {
            let (rig, legs, tempo) = &bodies[seed as usize % bodies.len()];
            let speed = Seed::new(seed ^ 0x0B16).between(0.65, 1.1) * tempo;
            let text = format!(
                "title = \"start\"\nduration = 8.0\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.3}\n"
            );
            let clip = baked(rig, &text, seed);
            let steps = &clip.performance.trace.steps;
            let stood = (steps[0].from.ankle.x - steps[1].from.ankle.x).abs();
            let widths: Vec<f64> =
                steps.windows(2).take(12).map(|pair| (pair[1].to.ankle.x - pair[0].to.ankle.x).abs()).collect();
            let mean = widths.iter().sum::<f64>() / widths.len() as f64;
            (format!("{seed}: legs {legs}, {speed:.2} m/s: {widths:.2?}, it stood {stood:.2} m wide"), mean / stood)
        })
        .collect();
    for (name, share) in &found {
        println!("{name}: {share:.2}");
    }
    let mean = found.iter().map(|(_, share)| share).sum::<f64>() / found.len() as f64;
    println!("mean {mean:.2}");
    assert!(found.iter().all(|(_, share)| *share < 1.25), "{found:#?}");
    assert!(mean < 0.95, "{mean:.2} of how wide they stood");
}
