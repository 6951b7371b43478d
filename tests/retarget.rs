//! Clips on other bodies: directions kept, feet held, knees whole. `cargo bench --bench retarget` prints the table.

#![expect(clippy::print_stdout, reason = "the table")]

use super::data;
use super::retarget_grid::{ARMS, FILES, LEGS, Row, bodies, clips, measured, off};
use surefoot::mocap::retarget::{planted, retarget, retarget_with};
use surefoot::model::Capture;

/// What the guards are for: swimmers have no ground, and what is on its way to one is no clip of its own.
fn is_a_clip(name: &str) -> bool {
    !["T-Pose", "Swim"].iter().any(|odd| name.contains(odd))
}

/// Rows of a file's clips on a body, with their names.
fn rows(captures: &[Capture], body: &surefoot::model::Body) -> Vec<(String, Row)> {
    let long = captures.iter().filter(|capture| capture.frames() > 2);
    long.map(|capture| (capture.name.clone(), measured(capture, &retarget(capture, body)))).collect()
}

#[test]
fn directions_are_the_clips_and_feet_are_held_on_every_body() {
    let Some(data) = data::folder() else { return };
    let bodies = bodies(&data);
    for file in FILES {
        let captures = clips(&data, file, &is_a_clip);
        for (name, body) in &bodies {
            let own = file.contains(name);
            let rows = rows(&captures, body);
            let worst = |value: &dyn Fn(&Row) -> f64| rows.iter().map(|row| value(&row.1)).fold(0.0, f64::max);
            let mean = rows.iter().map(|row| row.1.legs[0]).sum::<f64>() / rows.len().max(1) as f64;
            println!(
                "{file:36} {name:24} slip {:6.2} mm sink {:5.2} mm arms {:4.2} legs {mean:5.2} deg knees {:4.2}",
                worst(&|row| row.slip),
                worst(&|row| row.sink),
                worst(&|row| row.arms),
                worst(&|row| row.knees)
            );
            for (clip, row) in &rows {
                let place = format!("{file}: {clip} on {name}: {row:?}");
                if own {
                    assert!(row.legs[1] < 1e-4, "its own body changes nothing: {place}");
                    continue;
                }
                assert!(row.arms < 0.01, "{place}");
                assert!(row.knees < 1e-6, "{place}");
                // A foot without a joint turns with its shank, and no knee can hold it then.
                let stiff = name.contains("boxman");
                // A chibi's lunge takes a grown person's hips farther than legs reach.
                let lunges = if file.contains("Knight") { 20.0 } else { 1.0 };
                assert!(row.slip < if stiff { 60.0 } else { lunges }, "{place}");
                assert!(row.sink < if stiff { 10.0 } else { 5.0 }, "{place}");
            }
        }
    }
}

#[test]
fn there_and_back_again_is_nearly_the_clip() {
    let Some(data) = data::folder() else { return };
    let bodies = bodies(&data);
    for (file, clip) in [
        ("clips/cmu_02_01_walk.bvh", ""),
        ("rigs/m2m_human_base_animations.glb", "Idle_Loop"),
        ("rigs/m2m_human_base_animations.glb", "Hit_Chest"),
        ("rigs/m2m_human_base_animations.glb", "Walk_Loop"),
    ] {
        let source = clips(&data, file, &|name| name.contains(clip)).swap_remove(0);
        for (name, body) in bodies.iter().filter(|(name, _)| !name.contains("boxman")) {
            let back = retarget(&retarget(&source, body), &source.body);
            let (mut arms, mut legs, mut worst, mut place): (f64, f64, f64, f64) = (0.0, 0.0, 0.0, 0.0);
            for frame in 0..source.frames() {
                let arm = |limb| off(&source, &back, frame, limb);
                arms = ARMS.into_iter().map(arm).fold(arms, f64::max);
                for limb in LEGS {
                    let off = off(&source, &back, frame, limb);
                    legs += off / (4 * source.frames()) as f64;
                    worst = worst.max(off);
                }
                let between = |frame: usize| back.at(frame)[0] - source.at(frame)[0];
                // The floor of the clip became y = 0.
                place = place.max((between(frame) - between(0)).length());
            }
            println!(
                "{:20} {name:24} arms {arms:.4} legs {legs:5.2} worst {worst:5.1} deg hips {:5.1} mm",
                source.name,
                1000.0 * place
            );
            assert!(arms < 0.01, "{name}: {arms}");
            // Feet twice as long for their legs cost something both ways.
            let chibi = name.contains("Knight");
            assert!(legs < if chibi { 15.0 } else { 5.0 }, "{name}: {legs}");
            assert!(place < if chibi { 0.2 } else { 0.1 }, "{name}: {place}");
        }
    }
}

#[test]
fn stances_that_are_told_are_those_that_are_held() {
    let Some(data) = data::folder() else { return };
    let body = &bodies(&data)[0].1;
    let source = clips(&data, "clips/cmu_02_01_walk.bvh", &|_| true).swap_remove(0);
    let found = planted(&source);
    assert!(found.len() >= 6, "{found:?}");
    let same = retarget_with(&source, body, &found);
    assert!(same.turns == retarget(&source, body).turns, "what it finds itself");
    let none = retarget_with(&source, body, &[]);
    let ankle = body.feet[found[2].side as usize].ankle;
    let way = |capture: &Capture| {
        let middle = (found[2].start + found[2].end) / 2;
        let places: Vec<_> = (middle - 15..=middle + 15).map(|frame| capture.at(frame)[ankle]).collect();
        places.iter().map(|place| place.distance(places[0])).fold(0.0, f64::max)
    };
    assert!(way(&same) < 1e-3 && way(&none) > 2e-3, "{} and {}", way(&same), way(&none));
}

#[test]
fn a_cycle_ends_as_it_begins_on_every_body() {
    let Some(data) = data::folder() else { return };
    let cycle = |name: &str| name == "Walk_Loop" || name == "Idle_Loop" || name == "Jog_Fwd_Loop";
    for capture in clips(&data, "rigs/m2m_human_base_animations.glb", &cycle) {
        for (name, body) in bodies(&data) {
            let out = retarget(&capture, &body);
            let last = out.frames() - 1;
            let own = capture.turns_at(0).iter().zip(capture.turns_at(last)).map(|(a, b)| a.angle_between(*b));
            let own = own.fold(0.0, f64::max);
            if own > 0.01 {
                println!("{}: its own ends are {:.1} degrees apart: no cycle", out.name, own.to_degrees());
                continue;
            }
            let off = out.turns_at(0).iter().zip(out.turns_at(last)).map(|(a, b)| a.angle_between(*b));
            let off = off.fold(0.0, f64::max);
            let moved = (out.at(0)[0] - out.at(last)[0]).length();
            println!(
                "{:14} {name:24} {:.3} deg (source {:.3}) {:.2} mm",
                out.name,
                off.to_degrees(),
                own.to_degrees(),
                1000.0 * moved
            );
            // A foot without a joint is not held, and shows what the ends of the clip are apart.
            let stiff = if name.contains("boxman") { 0.03 } else { 0.01 };
            assert!(off < own + stiff && moved < 0.005, "{} on {name}: {off} rad, {moved} m", out.name);
        }
    }
}
