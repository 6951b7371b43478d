//! Clips of the articulated body that walks over kerbs and up and down flights of stairs.
//!
//! By its own torques alone, each clip of another person, on steps and at speeds that are drawn.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use crate::led_ground::{baked, baked_with, walk};
use crate::people::people;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::report::Outcome;
use surefoot::model::scenario_text;
use surefoot::ragdoll::control::Assist;
use surefoot::rig::Rig;

#[test]
fn kerbs_are_stepped_up_and_down() {
    let people = people(&[1.0, 1.3], &["gdquest_mannequiny.glb", "m2m_rig_human.glb"]);
    for (way, up) in [("up", 1.0), ("down", -1.0)] {
        let clips: Vec<(String, f64, Baked)> = (0..20u64)
            .into_par_iter()
            .map(|seed| {
                let mut draw = Seed::new(seed ^ 0x4E2B);
                let (rig, legs) = &people[seed as usize % people.len()];
                let rise = up * draw.between(0.03, 0.1);
                let pace = draw.between(0.301, 0.399) * f64::sqrt(*legs);
                let ground = format!("[ground]\nkind = \"stairs\"\nrise = {rise:.4}\ntread = 0.3\ncount = 1");
                let character = format!("[character]\nleg_scale = {legs}");
                let text = format!("title = \"kerb\"\nduration = 20.0\n{ground}\n{character}\n{}", walk(pace));
                (format!("{seed}: {rise:.3} m at {pace:.2} m/s, legs {legs}"), rise, baked(rig, &text, seed))
            })
            .collect();
        for (name, rise, clip) in &clips {
            let report = &clip.report;
            let ticks = &clip.performance.trace.ticks;
            let (first, last) = (ticks[0].com, ticks[ticks.len() - 1].com);
            println!("{way} {name}: {:?}, {:.1} m, score {:.2}", report.outcome, last.z, report.plausibility.score);
            assert_ne!(report.outcome, Outcome::Fall, "{name}");
            assert!(last.z > 3.0, "{name}: it came {:.2} m far", last.z);
            let gained = last.y - first.y;
            assert!((gained - rise).abs() < 0.04, "{name}: the body is {gained:.3} m higher");
            assert!(report.plausibility.joint_excess_share <= 0.01, "{name}: joints past their ranges");
            assert!(report.plausibility.hover_longest_s <= 0.05, "{name}: in the air");
            assert!(report.plausibility.penetration_max_mm <= 10.0, "{name}: a sole is deep in the kerb");
            assert!(report.plausibility.score >= 0.85, "{name}: score {:.2}", report.plausibility.score);
        }
    }
}

/// Walks up or down flights of `count` steps of at least `lowest` m, in the clips of `people` (rig, leg scale, highest step in m): what is
/// wrong with them.
fn flights(people: &[(Rig, f64, f64)], seeds: u64, down: bool, (count, lowest): (u32, f64)) -> Vec<String> {
    let way = if down { -1.0 } else { 1.0 };
    let clips: Vec<(String, [f64; 2], Baked)> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ seeds);
            let (rig, legs, highest) = &people[seed as usize % people.len()];
            let (rise, tread) = (draw.between(lowest, *highest), draw.between(0.301, 0.359));
            let pace = draw.between(0.201, 0.349) * f64::sqrt(*legs);
            let steps = format!("rise = {:.4}\ntread = {tread:.4}\ncount = {count}", way * rise);
            let ground = format!("[ground]\nkind = \"stairs\"\n{steps}");
            let character = format!("[character]\nleg_scale = {legs}");
            let text = format!("title = \"flight\"\nduration = 20.0\n{ground}\n{character}\n{}", walk(pace));
            (format!("{seed}: {rise:.3} m at {pace:.2} m/s, legs {legs}"), [rise, tread], baked(rig, &text, seed))
        })
        .collect();
    let (mut scores, mut failed) = (0.0, Vec::new());
    for (name, [rise, tread], clip) in &clips {
        let (report, ticks) = (&clip.report, &clip.performance.trace.ticks);
        let (first, last) = (ticks[0].com, ticks[ticks.len() - 1].com);
        let (gained, measured) = (way * (last.y - first.y), &report.plausibility);
        println!("{name}: {:?}, {:.1} m, {gained:.2} m on, score {:.2}", report.outcome, last.z, measured.score);
        scores += measured.score;
        // It has come on to the fourth tread at least, or past a kerb, and is as high, or as low, as the treads that it is on.
        let treads = ((last.z - 1.0) / tread).floor() + 1.0;
        let faults = [
            (report.outcome == Outcome::Fall, "it falls"),
            (last.z < 1.0 + f64::from(count.min(3)) * tread, "it does not get on"),
            (gained < rise * (treads.min(f64::from(count + 1)) - 1.0) - 0.08, "it is not as high as its treads"),
            (measured.joint_excess_share > 0.01, "joints past their ranges"),
            (measured.hover_longest_s > 0.05, "in the air"),
            (measured.penetration_max_mm > 6.0, "a sole is deep in a riser"),
            (measured.score < 0.5, "its score"),
        ];
        failed.extend(faults.iter().filter(|fault| fault.0).map(|fault| format!("{name}: {}", fault.1)));
    }
    assert!(scores / clips.len() as f64 > 0.9, "a mean score of {:.2}", scores / clips.len() as f64);
    failed
}

/// Bodies whose feet bend, and how high their steps may be, m.
fn climbers() -> Vec<(Rig, f64, f64)> {
    let mut people = vec![(builtin(), 1.0, 0.17), (builtin(), 1.15, 0.17)];
    if let Some(folder) = data::more() {
        for name in ["m2m_rig_human.glb", "m2m_human_male.glb"] {
            people.push((surefoot::rig::load(&folder.join("rigs").join(name)).expect("the rig loads"), 1.0, 0.17));
        }
    }
    people
}

#[test]
fn flights_are_climbed_step_over_step() {
    let mut people = climbers();
    people.extend([0.7, 1.3].map(|legs| (builtin(), legs, 0.17)));
    if let Some(folder) = data::more() {
        let unbent = folder.join("rigs").join("gdquest_mannequiny.glb");
        people.insert(2, (surefoot::rig::load(&unbent).expect("the rig loads"), 1.0, 0.1));
    }
    let failed = flights(&people, 0xF119, false, (5, 0.03));
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn who_is_shoved_on_his_way_up_goes_on() {
    let people = people(&[0.7, 1.0, 1.15, 1.3], &["m2m_rig_human.glb", "m2m_ue_names_no_animation.glb"]);
    let clips: Vec<(String, f64, Baked)> = (0..32u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x5F0E);
            let (rig, legs) = &people[seed as usize % people.len()];
            let (rise, tread) = (draw.between(0.08, 0.17), draw.between(0.27, 0.35));
            let pace = draw.between(0.25, 0.4) * f64::sqrt(*legs);
            let ground = format!("[ground]\nkind = \"stairs\"\nrise = {rise:.3}\ntread = {tread:.3}\ncount = 16");
            let character = format!("[character]\nleg_scale = {legs}");
            let (start, toward) = (draw.between(7.0, 13.0), draw.between(0.0, 360.0));
            let push = format!("[[push]]\nstart = {start:.2}\nduration = 0.2\nforce = 100.0\ntoward = {toward:.0}");
            let text = format!("title = \"shoved\"\nduration = 20.0\n{ground}\n{character}\n{}{push}\n", walk(pace));
            let name =
                format!("{seed}: {rise:.3} m at {pace:.2} m/s, legs {legs}, towards {toward:.0} at {start:.1} s");
            (name, pace, baked(rig, &text, seed))
        })
        .collect();
    let (mut fallen, mut scores, mut slow) = (0, 0.0, 0);
    for (name, pace, clip) in &clips {
        let (report, ticks) = (&clip.report, &clip.performance.trace.ticks);
        let came = ticks[ticks.len() - 1].com.z;
        println!("{name}: {:?}, {came:.1} m, score {:.2}", report.outcome, report.plausibility.score);
        let falls = report.outcome == Outcome::Fall;
        (fallen, scores) = (fallen + u32::from(falls), scores + report.plausibility.score);
        slow += u32::from(!falls && came < 0.5 * pace * 20.0);
    }
    let mean = scores / clips.len() as f64;
    // goal: one of sixteen
    assert!(fallen <= 2 && mean > 0.8 && slow <= 2, "{fallen} fall, {slow} are slow, a mean score of {mean:.2}");
}

#[test]
fn flights_are_descended_one_tread_at_a_time() {
    let failed = flights(&climbers(), 0xD0F119, true, (5, 0.03));
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Walks of 20 s down flights of steps of those heights (from, to, m) at those paces (from, to, m/s on legs of 0.83 m), drawn, on each of these
/// legs in turn, looking ahead with that effort: those that fall.
fn fallen(
    legs: &[f64],
    (count, seeds): (u64, u64),
    ([low, high], [slow, fast]): ([f64; 2], [f64; 2]),
    effort: u8,
) -> Vec<String> {
    (0..count)
        .into_par_iter()
        .filter_map(|seed| {
            let mut draw = Seed::new(seed ^ seeds);
            let legs = legs[seed as usize % legs.len()];
            let (tread, pace) = (draw.between(0.3, 0.36), draw.between(slow, fast) * f64::sqrt(legs));
            let rise = draw.between(low, high);
            let ground = format!("[ground]\nkind = \"stairs\"\nrise = -{rise:.4}\ntread = {tread:.4}\ncount = 8");
            let character = format!("[character]\nleg_scale = {legs}");
            let text = format!("title = \"flight\"\nduration = 20.0\n{ground}\n{character}\n{}", walk(pace));
            let clip = baked_with(&builtin(), &text, seed, effort);
            let name = format!("{seed}: {rise:.3} m, {tread:.3} m deep, at {pace:.2} m/s, legs {legs}");
            println!("{name}: {:?}, score {:.2}", clip.report.outcome, clip.report.plausibility.score);
            (clip.report.outcome == Outcome::Fall).then_some(name)
        })
        .collect()
}

#[test]
fn short_and_long_legs_go_down_steps_of_17_cm() {
    let effort = BakeOptions::default().effort;
    let fallen = fallen(&[0.7, 1.0, 1.3], (15, 0xD0_5407), ([0.17, 0.17], [0.2, 0.35]), effort);
    // goal: none
    assert!(fallen.len() <= 1, "{fallen:#?}");
}

#[test]
fn short_legs_go_down_steps_of_17_cm_without_looking_ahead() {
    let fallen = fallen(&[0.7], (16, 0x5_4087), ([0.17, 0.17], [0.2, 0.35]), 0);
    // goal: none
    assert!(fallen.len() <= 1, "{fallen:#?}");
}

#[test]
fn who_walks_briskly_stops_before_a_flight_down_without_looking_ahead() {
    let fallen = fallen(&[0.7, 1.0, 0.7, 1.3], (24, 0xB_2157), ([0.1, 0.17], [0.4, 0.7]), 0);
    // goal: none
    assert!(fallen.len() <= 1, "{fallen:#?}");
}

#[test]
fn kerbs_too_high_for_the_gait_are_descended() {
    let failed = flights(&climbers(), 0xD04E2B, true, (1, 0.101));
    // goal: none
    let fallen = failed.iter().filter(|fault| fault.ends_with("it falls")).count();
    let scores = failed.iter().filter(|fault| fault.ends_with("its score")).count();
    assert!(fallen <= 1 && scores <= fallen && failed.len() == fallen + scores, "{failed:#?}");
}

#[test]
fn feet_that_do_not_bend_are_refused_down_stairs() {
    let Some(folder) = data::more() else { return };
    let rig = surefoot::rig::load(&folder.join("rigs").join("khronos_CesiumMan.gltf")).expect("the rig loads");
    for (rise, count, plays) in [(-0.05, 4, false), (-0.12, 1, false), (0.05, 4, true), (-0.08, 1, true)] {
        let ground = format!("[ground]\nkind = \"stairs\"\nrise = {rise}\ntread = 0.32\ncount = {count}");
        let text = format!("title = \"unbent\"\nduration = 2.0\n{ground}\n{}", walk(0.32));
        let scenario = scenario_text::parse("led", &text).expect("it parses");
        let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
        let clip = bake(&rig, &scenario, &BakeOptions { drive, ..BakeOptions::default() });
        let told = clip.as_ref().err().map(ToString::to_string);
        assert_eq!(clip.is_ok(), plays, "{count} steps of {rise} m: {told:?}");
        assert!(plays || told.is_some_and(|told| told.contains("on stairs on feet that do not bend at their toes")));
    }
}
