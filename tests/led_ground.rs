//! Clips of the articulated body that walks, turns and stands on one foot on slopes and on uneven ground, shoved in the midst of it.
//!
//! By its own torques alone, each clip of another person, on grounds and at speeds that are drawn.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use crate::people::people;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::report::{Outcome, Part};
use surefoot::model::scenario_text;
use surefoot::ragdoll::control::Assist;
use surefoot::rig::Rig;

/// Bakes that scenario with joint torques alone.
pub fn baked(rig: &Rig, text: &str, seed: u64) -> Baked {
    baked_with(rig, text, seed, BakeOptions::default().effort)
}

/// The same, looking ahead with that effort.
pub fn baked_with(rig: &Rig, text: &str, seed: u64, effort: u8) -> Baked {
    let scenario = scenario_text::parse("led", text).unwrap_or_else(|errors| panic!("{errors:?}\n{text}"));
    bake(rig, &scenario, &BakeOptions { seed: Some(seed), effort, ..by_torques() }).expect("it bakes")
}

fn by_torques() -> BakeOptions {
    BakeOptions { drive: Drive::Ragdoll(Helped::Within(Assist::default())), ..BakeOptions::default() }
}

fn slope(degrees: f64, rest: &str) -> String {
    format!("title = \"slope\"\nduration = 10.0\n[ground]\nkind = \"slope\"\nangle = {degrees:.2}\n{rest}")
}

fn uneven(seed: u32, height: f64, rest: &str) -> String {
    let ground = format!("kind = \"uneven\"\nheight = {height:.3}\nwavelength = 2.0\nseed = {seed}");
    format!("title = \"uneven\"\nduration = 10.0\n[ground]\n{ground}\n{rest}")
}

pub fn walk(speed: f64) -> String {
    format!("[[walk]]\nstart = 0.5\nspeed = {speed:.3}\n")
}

/// m/s, along the walk, in the mean from 4 s on.
fn speed(baked: &Baked) -> f64 {
    let trace = &baked.performance.trace;
    let from = (4.0 / trace.dt) as usize;
    let (first, last) = (trace.ticks[from].com, trace.ticks[trace.ticks.len() - 1].com);
    (last.z - first.z) / ((trace.ticks.len() - 1 - from) as f64 * trace.dt)
}

/// What a clip says of itself holds: joints in their ranges, soles on the ground, links where they were.
fn sound(name: &str, baked: &Baked) {
    let score = &baked.report.plausibility;
    assert!(score.joint_excess_share <= 0.01, "{name}: joints past their ranges in {:.3}", score.joint_excess_share);
    assert!(score.penetration_max_mm <= 6.0, "{name}: a sole is {:.1} mm deep", score.penetration_max_mm);
    assert!(score.legs_mm >= 10.0, "{name}: the legs are {:.0} mm apart", score.legs_mm);
    assert!(score.hover_longest_s <= 0.05, "{name}: in the air for {:.2} s", score.hover_longest_s);
    let drift = baked.report.drift.as_ref().expect("a played clip");
    assert!(drift.position_mm <= 5.0 && drift.angle_deg <= 2.0, "{name}: {drift:?}");
}

/// The built-in rig, more often than others, and third-party ones.
fn bodies() -> Vec<Rig> {
    let mut rigs = vec![builtin(), builtin(), builtin()];
    if let Some(folder) = data::more() {
        for name in ["gdquest_mannequiny.glb", "m2m_rig_human.glb"] {
            rigs.push(surefoot::rig::load(&folder.join("rigs").join(name)).expect("the rig loads"));
        }
    }
    rigs
}

#[test]
fn slopes_are_walked_up_and_down_by_every_body() {
    let rigs = bodies();
    let clips: Vec<(String, f64, Baked)> = (0..24u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x510E);
            let legs = [1.0, 0.7, 1.3][seed as usize % 3];
            let rig = &rigs[seed as usize % rigs.len()];
            let degrees = draw.between(-25.0, 12.0);
            let pace = draw.between(0.35, if degrees.abs() > 10.0 { 0.5 } else { 0.7 });
            let text = slope(degrees, &format!("[character]\nleg_scale = {legs}\n{}", walk(pace)));
            (format!("{seed}: {degrees:.1} degrees at {pace:.2} m/s, legs {legs}"), pace, baked(rig, &text, seed))
        })
        .collect();
    for (name, pace, clip) in &clips {
        let report = &clip.report;
        println!("{name}: {:?}, {:.2} m/s, score {:.2}", report.outcome, speed(clip), report.plausibility.score);
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        // goal 5 %: short legs 14 degrees down are 5.2 % fast
        assert!((speed(clip) / pace - 1.0).abs() < 0.07, "{name}: {:.2} m/s", speed(clip));
        sound(name, clip);
    }
}

#[test]
fn who_is_asked_to_walk_down_faster_than_he_can_goes_slower_and_keeps_his_feet() {
    let people = people(&[1.0, 0.7, 1.3], &["m2m_rig_human.glb", "m2m_human_male.glb"]);
    let clips: Vec<(String, Baked)> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0xD0B4);
            let (rig, legs) = &people[seed as usize % people.len()];
            let (degrees, pace) = (draw.between(-25.0, -6.0), draw.between(0.8, 1.6) * f64::sqrt(*legs));
            let text = slope(degrees, &format!("[character]\nleg_scale = {legs}\n{}", walk(pace)));
            (format!("{seed}: {degrees:.1} degrees at {pace:.2} m/s, legs {legs}"), baked(rig, &text, seed))
        })
        .collect();
    let mut sum = 0.0;
    for (name, clip) in &clips {
        let report = &clip.report;
        println!("{name}: {:?}, {:.2} m/s, score {:.2}", report.outcome, speed(clip), report.plausibility.score);
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        sum += report.plausibility.score;
    }
    let mean = sum / clips.len() as f64;
    println!("mean score {mean:.3}");
    assert!(mean >= 0.9, "{mean:.3}");
}

#[test]
fn who_walks_up_a_gentle_slope_drags_no_foot_over_it() {
    let files = ["m2m_rig_human.glb", "m2m_human_male.glb", "gdquest_mannequiny.glb", "khronos_CesiumMan.gltf"];
    let people = people(&[1.0, 0.7, 1.3], &files);
    let clips: Vec<(String, f64, Baked)> = (0..28u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x6E27);
            let (rig, legs) = &people[seed as usize % people.len()];
            let (degrees, pace) = (draw.between(3.0, 12.0), draw.between(0.35, 0.5) * f64::sqrt(*legs));
            let text = slope(degrees, &format!("[character]\nleg_scale = {legs}\n{}", walk(pace)));
            (format!("{seed}: {degrees:.1} degrees at {pace:.2} m/s, legs {legs}"), *legs, baked(rig, &text, seed))
        })
        .collect();
    let mut drags = 0;
    for (name, legs, clip) in &clips {
        let score = &clip.report.plausibility;
        println!("{name}: score {:.3}, drags a foot by {:.0} mm", score.score, score.scuff_max_mm);
        assert!(score.score >= 0.93, "{name}: {:.3}", score.score);
        // mm at the reference leg: what viewers notice (Prazak 2011).
        drags += u32::from(score.scuff_max_mm > 21.0 * legs);
    }
    let mean = clips.iter().map(|clip| clip.2.report.plausibility.score).sum::<f64>() / clips.len() as f64;
    println!("mean score {mean:.3}, {drags} drag a foot");
    // goal: none
    assert!(drags <= 2 && mean >= 0.98, "{mean:.3}, {drags} drag a foot");
}

#[test]
fn steep_slopes_are_walked_up_on_the_balls_of_the_feet() {
    let people = people(&[1.0, 0.7, 1.3], &["m2m_rig_human.glb", "m2m_human_male.glb"]);
    let clips: Vec<(String, f64, f64, Baked)> = (0..32u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x57EE9);
            let (rig, legs) = &people[seed as usize % people.len()];
            let [least, most] = if seed < 20 { [12.5, 20.0] } else { [20.0, 25.0] };
            let (degrees, pace) = (draw.between(least, most), draw.between(0.301, 0.449) * f64::sqrt(*legs));
            let ground = format!("[ground]\nkind = \"slope\"\nangle = {degrees:.2}");
            let character = format!("[character]\nleg_scale = {legs}");
            let text = format!("title = \"steep\"\nduration = 20.0\n{ground}\n{character}\n{}", walk(pace));
            let name = format!("{seed}: {degrees:.1} degrees at {pace:.2} m/s, legs {legs}");
            (name, degrees, pace, baked(rig, &text, seed))
        })
        .collect();
    for (name, _, _, clip) in &clips {
        let score = clip.report.plausibility.score;
        println!("{name}: {:?}, {:.2} m/s, score {score:.2}", clip.report.outcome, speed(clip));
    }
    // goal: each of them 0.85
    for (clips, least) in [(&clips[..20], 0.89), (&clips[20..], 0.88)] {
        let mean = clips.iter().map(|clip| clip.3.report.plausibility.score).sum::<f64>() / clips.len() as f64;
        println!("mean score {mean:.3}");
        assert!(mean >= least, "{mean:.3}");
    }
    for (name, degrees, pace, clip) in &clips {
        let report = &clip.report;
        let score = &report.plausibility;
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        assert!((speed(clip) / pace - 1.0).abs() < 0.1, "{name}: {:.2} m/s", speed(clip));
        assert!(score.joint_excess_share <= 0.01, "{name}: joints past their ranges");
        assert!(score.hover_longest_s <= 0.05 && score.legs_mm >= 10.0, "{name}: in the air or through a leg");
        assert!(score.penetration_max_mm <= 10.0, "{name}: a sole is deep");
        // Feet stand on their balls where the ankle has no range left.
        let balls = report.contacts.iter().filter(|contact| contact.part == Part::Ball).count();
        assert!(*degrees < 16.0 || 2 * balls > report.contacts.len(), "{name}: {balls} contacts at the ball");
    }
}

#[test]
fn brisk_walks_up_steep_slopes_drag_no_foot() {
    let people = people(&[1.0, 0.7, 1.3], &["m2m_rig_human.glb", "m2m_human_male.glb"]);
    let slid: Vec<f64> = (0..40u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0xB215C);
            let (rig, legs) = &people[seed as usize % people.len()];
            let [least, most] = if seed < 20 { [13.5, 20.0] } else { [20.0, 25.0] };
            let (degrees, pace) = (draw.between(least, most), draw.between(0.5, 0.9) * f64::sqrt(*legs));
            let ground = format!("[ground]\nkind = \"slope\"\nangle = {degrees:.2}");
            let character = format!("[character]\nleg_scale = {legs}");
            let text = format!("title = \"brisk\"\nduration = 10.0\n{ground}\n{character}\n{}", walk(pace));
            let report = baked(rig, &text, seed).report;
            let (name, score) = (format!("{degrees:.1} degrees at {pace:.2} m/s, legs {legs}"), report.plausibility);
            println!("{name}: {:.0} mm, score {:.2}", score.scuff_max_mm, score.score);
            assert_ne!(report.outcome, Outcome::Fall, "{name}");
            score.scuff_max_mm
        })
        .collect();
    // goal: none
    for slid in [&slid[..20], &slid[20..]] {
        let drag = slid.iter().filter(|slid| **slid > 30.0).count();
        println!("{drag} of {} slide a foot by more than 30 mm", slid.len());
        assert!(drag <= 1, "{drag} slide a foot");
    }
}

#[test]
fn who_is_shoved_on_a_slope_keeps_his_feet() {
    let rig = builtin();
    for degrees in [5.0, 8.0, 12.0, 15.0, 20.0, -5.0, -15.0, -25.0] {
        let pace = if degrees > 12.0 {
            0.4
        } else if f64::abs(degrees) > 10.0 {
            0.5
        } else {
            0.6
        };
        let clips: Vec<Baked> = (0..16u32)
            .into_par_iter()
            .map(|way| {
                let (start, toward) = (3.0 + 0.05 * f64::from(way), 22.5 * f64::from(way));
                let push = format!("[[push]]\nstart = {start}\nduration = 0.2\nforce = 100\ntoward = {toward}\n");
                baked(&rig, &slope(degrees, &(walk(pace) + &push)), u64::from(way))
            })
            .collect();
        let stands = clips.iter().filter(|clip| clip.report.outcome != Outcome::Fall).count();
        println!("{degrees} degrees: {stands} of 16 keep their feet");
        assert!(stands >= 15, "{degrees} degrees: {stands} of 16");
    }
}

#[test]
fn slopes_to_25_degrees_are_stood_on_without_a_step() {
    let rigs = bodies();
    let clips: Vec<(String, Baked)> = (0..64u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x57A4D);
            // Every second one faces up a slope that leaves his ankles hardly any range.
            let least = if seed % 2 == 0 { -25.0 } else { 18.0 };
            let (legs, degrees) = ([1.0, 0.7, 1.3][seed as usize % 3], draw.between(least, 25.0));
            let text = slope(degrees, &format!("[character]\nleg_scale = {legs}\n"));
            let scenario = scenario_text::parse("stand", &text).expect("a scenario");
            // No search: it would find a step or a luckier stand where the usual one drifts.
            let options = BakeOptions { seed: Some(seed), effort: 0, ..by_torques() };
            let clip = bake(&rigs[seed as usize % rigs.len()], &scenario, &options).expect("it bakes");
            (format!("{seed}: {degrees:.1} degrees, legs {legs}"), clip)
        })
        .collect();
    for (name, clip) in &clips {
        println!("{name}: {:?}, {} steps", clip.report.outcome, clip.report.steps);
    }
    for (name, clip) in &clips {
        assert!(clip.report.outcome != Outcome::Fall && clip.report.steps == 0, "{name}: {:?}", clip.report.outcome);
        sound(name, clip);
    }
}

#[test]
fn slopes_are_turned_crouched_and_stood_on_with_one_foot() {
    let rigs = bodies();
    let clips: Vec<(String, Baked)> = (0..30u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x1A9E);
            let (legs, most) = ([1.0, 0.7, 1.3][(seed / 5) as usize % 3], [12.0, 15.0, 15.0][seed as usize % 3]);
            let degrees = draw.between(-most, most);
            let lane = match seed % 3 {
                0 => format!("[[turn]]\nstart = 1\nfacing = {:.0}\n", draw.between(-170.0, 170.0)),
                1 => "[[stand]]\nstart = 1\nduration = 6\non = \"right\"\n".into(),
                _ => format!("[[crouch]]\nstart = 1\namount = {:.2}\n", draw.between(0.05, 0.2)),
            };
            let text = slope(degrees, &format!("[character]\nleg_scale = {legs}\n{lane}"));
            (format!("{seed}: {degrees:.1} degrees, {lane}"), baked(&rigs[seed as usize % rigs.len()], &text, seed))
        })
        .collect();
    for (name, clip) in &clips {
        println!("{name}: {:?}, score {:.2}", clip.report.outcome, clip.report.plausibility.score);
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
        assert!(!clip.warnings.iter().any(|warning| warning.contains("the ragdoll")), "{name}: {:?}", clip.warnings);
    }
}

#[test]
fn slopes_are_walked_across_backwards_and_sideways() {
    let rigs = bodies();
    let clips: Vec<(String, Baked)> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0xAC055);
            let aside = seed % 2 == 0;
            let most = if aside { 8.0 } else { 12.0 };
            let degrees = draw.between(-most, most);
            let (heading, pace) = (draw.between(45.0, 315.0), draw.between(0.15, if aside { 0.3 } else { 0.6 }));
            let facing = if aside { "facing = 0\n" } else { "" };
            let text = slope(degrees, &format!("{}heading = {heading:.0}\n{facing}", walk(pace)));
            let name = format!("{seed}: {degrees:.1} degrees at {pace:.2} m/s toward {heading:.0} {facing}");
            (name, baked(&rigs[seed as usize % rigs.len()], &text, seed))
        })
        .collect();
    for (name, clip) in &clips {
        println!("{name}: {:?}, score {:.2}", clip.report.outcome, clip.report.plausibility.score);
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
    }
}

#[test]
fn who_stands_on_a_steep_slope_and_is_shoved_keeps_his_feet() {
    let rig = builtin();
    for degrees in [20.0, -25.0] {
        let one = |way: u32| {
            let push =
                format!("[[push]]\nstart = 1\nduration = 0.2\nforce = 100\ntoward = {}\n", 22.5 * f64::from(way));
            baked(&rig, &slope(degrees, &push), u64::from(way)).report.outcome != Outcome::Fall
        };
        let stands = (0..16u32).into_par_iter().filter(|way| one(*way)).count();
        println!("{degrees} degrees: {stands} of 16 keep their feet");
        assert!(stands >= 15, "{degrees} degrees: {stands} of 16");
    }
}

#[test]
fn uneven_ground_is_walked_and_stood_on() {
    let rig = builtin();
    let lanes =
        [walk(0.5), "[[turn]]\nstart = 0.5\nfacing = 90\n".into(), "[[stand]]\nstart = 0.5\non = \"left\"\n".into()];
    let clips: Vec<(String, Baked)> = (0..18u32)
        .into_par_iter()
        .map(|seed| {
            let height = Seed::new(u64::from(seed)).between(0.02, 0.06);
            let text = uneven(seed, height, &lanes[seed as usize % 3]);
            (format!("{seed}: {height:.3} m"), baked(&rig, &text, u64::from(seed)))
        })
        .collect();
    for (name, clip) in &clips {
        println!("{name}: {:?}, score {:.2}", clip.report.outcome, clip.report.plausibility.score);
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
        assert!(!clip.warnings.iter().any(|warning| warning.contains("the ragdoll")), "{name}: {:?}", clip.warnings);
        sound(name, clip);
    }
}

#[test]
fn gaps_are_stepped_over() {
    let rigs = people(&[1.0, 1.3], &["gdquest_mannequiny.glb", "m2m_rig_human.glb"]);
    let clips: Vec<(String, f64, Baked)> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x9A95);
            let (rig, legs) = &rigs[seed as usize % rigs.len()];
            let (width, apart) = (draw.between(0.1, 0.2), draw.between(0.9 * legs, 1.5 * legs));
            let pace = draw.between(0.401, 0.499) * f64::sqrt(*legs);
            let ground = format!("[ground]\nkind = \"gaps\"\nwidth = {width:.3}\nspacing = {apart:.3}");
            let character = format!("[character]\nleg_scale = {legs}");
            let text = format!("title = \"gaps\"\nduration = 20.0\n{ground}\n{character}\n{}", walk(pace));
            let name = format!("{seed}: {width:.3} m every {apart:.2} m at {pace:.2} m/s, legs {legs}");
            (name, pace, baked(rig, &text, seed))
        })
        .collect();
    for (name, pace, clip) in &clips {
        let report = &clip.report;
        println!("{name}: {:?}, score {:.2}", report.outcome, report.plausibility.score);
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        assert!((speed(clip) / pace - 1.0).abs() < 0.1, "{name}: {:.2} m/s", speed(clip));
        sound(name, clip);
    }
}

#[test]
fn gaps_of_20_cm_are_stepped_over_by_short_legs_too() {
    let rigs = people(&[0.7, 1.0, 1.3], &["m2m_rig_human.glb", "m2m_ue_names_no_animation.glb"]);
    let clips: Vec<(String, Baked)> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x9A96);
            let (rig, legs) = &rigs[seed as usize % rigs.len()];
            let (apart, pace) = (draw.between(0.9 * legs, 1.5 * legs), draw.between(0.4, 0.5) * f64::sqrt(*legs));
            let ground = format!("[ground]\nkind = \"gaps\"\nwidth = 0.2\nspacing = {apart:.3}");
            let character = format!("[character]\nleg_scale = {legs}");
            let text = format!("title = \"gaps\"\nduration = 20.0\n{ground}\n{character}\n{}", walk(pace));
            (format!("{seed}: every {apart:.2} m at {pace:.2} m/s, legs {legs}"), baked(rig, &text, seed))
        })
        .collect();
    let mut scores = 0.0;
    for (name, clip) in &clips {
        let report = &clip.report;
        println!("{name}: {:?}, score {:.2}", report.outcome, report.plausibility.score);
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        scores += report.plausibility.score;
    }
    assert!(scores / clips.len() as f64 > 0.85, "a mean score of {:.2}", scores / clips.len() as f64);
}

#[test]
fn ice_is_walked_on_by_every_body_and_shoves_on_it_are_stood() {
    let files = ["m2m_rig_human.glb", "m2m_human_male.glb", "gdquest_mannequiny.glb", "vrm1_debug_robot.vrm"];
    let people = people(&[0.7, 1.0, 1.3], &files);
    let clips: Vec<(String, f64, Baked)> = (0..28u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x1CE);
            let (rig, legs) = &people[seed as usize % people.len()];
            let (friction, pace) = (draw.between(0.1, 0.2), draw.between(0.3, 0.5) * f64::sqrt(*legs));
            let (start, toward) = (draw.between(7.0, 13.0), draw.between(0.0, 360.0));
            let push = format!("[[push]]\nstart = {start:.2}\nduration = 0.2\nforce = 100.0\ntoward = {toward:.0}\n");
            let lanes = format!("{}{}", walk(pace), if seed < 14 { "" } else { &push });
            let ground = format!("[ground]\nfriction = {friction:.3}\n[character]\nleg_scale = {legs}");
            let text = format!("title = \"ice\"\nduration = 20.0\n{ground}\n{lanes}");
            (format!("{seed}: {friction:.2} at {pace:.2} m/s, legs {legs}"), pace, baked(rig, &text, seed))
        })
        .collect();
    for (clips, least) in [(&clips[..14], 0.9), (&clips[14..], 0.7)] {
        let (mut scores, mut slow) = (0.0, 0);
        for (name, pace, clip) in clips {
            let score = clip.report.plausibility.score;
            println!("{name}: {:?}, {:.2} m/s, score {score:.2}", clip.report.outcome, speed(clip));
            assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
            slow += u32::from(speed(clip) < 0.95 * pace);
            scores += score;
        }
        let mean = scores / clips.len() as f64;
        // who is shoved walks off askew on ice, and slides; goal: as who is not
        assert!(mean > least, "a mean score of {mean:.2}");
        assert!(slow <= 5 || least < 0.9, "{slow} of 14 are slow");
    }
}
