//! Clips of the articulated body that walks on level ground: its steps are alike, and shoves of the paper's range do not fell it.
//!
//! By its own torques alone, each clip of another person. Shoves are drawn as in "Watch Your Step": 10 to 500 N for 0.1 to 0.5 s.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use crate::people::people;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::Role;
use surefoot::model::report::{Outcome, Part};
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
fn nobody_drags_a_foot_who_walks_straight_ahead() {
    let rigs = rigs(&["gdquest_mannequiny.glb", "m2m_rig_human.glb", "m2m_human_male.glb"]);
    // Short legs have the longest feet for their legs.
    let people = rigs.iter().map(|rig| (rig, 1.0)).chain([(&rigs[0], 0.7), (&rigs[0], 0.85)]);
    let cases: Vec<_> = people.flat_map(|person| (0..6).map(move |index| (person, index))).collect();
    let walked: Vec<_> = cases
        .into_par_iter()
        .map(|(((name, rig), legs), index)| {
            let from = 0.25 + 0.2 * index as f64;
            let speed =
                Seed::new(0xF007 ^ (index << 8) ^ name.len() as u64).between(from, from + 0.2) * f64::sqrt(legs);
            let walk = format!("[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}");
            let text = format!("title = \"walk\"\nduration = 12.0\n{walk}\n");
            (format!("{name}, legs {legs}, at {speed:.2} m/s"), baked(rig, &text, index).report.plausibility)
        })
        .collect();
    for (name, found) in &walked {
        println!("{name}: a foot slides by {:.0} mm at most, score {:.2}", found.scuff_max_mm, found.score);
    }
    for (name, found) in walked {
        assert!(found.scuff_max_mm < 30.0, "{name}: a foot slides by {:.0} mm", found.scuff_max_mm);
        assert!(found.score > 0.85, "{name}: {:.2}, {:?}", found.score, found.notes);
    }
}

/// 1/min on legs of 0.83 m, at most so many steps; people take 55 to 80 of them.
const STEPS: f64 = 136.0;

/// Steps a minute from 4 s on, and s, the longest time from one landing to the next.
fn cadence(clip: &Baked) -> (f64, f64) {
    let steps = clip.performance.trace.steps.iter().filter(|step| step.land > 4.0);
    let lands: Vec<f64> = steps.map(|step| step.land).collect();
    let rate = 60.0 * (lands.len() - 1) as f64 / (lands[lands.len() - 1] - lands[0]);
    (rate, lands.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max))
}

#[test]
fn slow_walks_do_not_patter() {
    // people whose feet bend: others still take quicker steps
    let people = people(&[1.0, 0.7, 1.3], &["m2m_human_male.glb", "m2m_rig_human.glb"]);
    let walked: Vec<_> = (0..24_u64)
        .into_par_iter()
        .map(|seed| {
            let (rig, legs) = &people[seed as usize % people.len()];
            let mut draw = Seed::new(seed ^ 0x9A77E5);
            let tempo = (legs * rig.body.leg_length / 0.83).sqrt();
            let (speed, degrees) = (draw.between(0.4, 0.6) * tempo, draw.between(-10.0, 6.0));
            let ground = if seed % 2 == 0 {
                String::new()
            } else {
                format!("[ground]\nkind = \"slope\"\nangle = {degrees:.1}\n")
            };
            let walk = format!("[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}");
            let clip = baked(rig, &format!("title = \"walk\"\nduration = 14.0\n{ground}{walk}\n"), seed);
            let (rate, longest) = cadence(&clip);
            let (rate, longest) = (rate * tempo, longest / tempo);
            (format!("{seed}: {speed:.2} m/s, legs {legs}"), rate, longest, clip)
        })
        .collect();
    for (name, rate, longest, clip) in &walked {
        let report = &clip.report;
        println!(
            "{name}: {rate:.0} steps a minute, {longest:.2} s the longest, score {:.2}",
            report.plausibility.score
        );
    }
    for (name, rate, longest, clip) in &walked {
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
        assert!(*rate < STEPS, "{name}: {rate:.0} steps a minute");
        assert!(*longest < 0.75, "{name}: it stops for {longest:.2} s");
        assert!(clip.report.plausibility.score > 0.8, "{name}: {:?}", clip.report.plausibility.notes);
    }
}

/// Steps a minute at legs of 0.83 m, of each brisk walk and in the mean at most. People take 105 to 120 of them.
const BRISK: f64 = 165.0;
const BRISK_MEAN: f64 = 160.0;

#[test]
fn brisk_walks_do_not_patter() {
    // people whose feet bend
    let people = people(&[1.0, 0.7, 1.3], &["m2m_human_male.glb", "m2m_rig_human.glb"]);
    let walked: Vec<_> = (0..15_u64)
        .into_par_iter()
        .map(|seed| {
            let (rig, legs) = &people[seed as usize % people.len()];
            let tempo = (legs * rig.body.leg_length / 0.83).sqrt();
            let speed = Seed::new(seed ^ 0xCADE).between(1.0, 1.3) * tempo;
            let walk = format!("[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}");
            let clip = baked(rig, &format!("title = \"walk\"\nduration = 14.0\n{walk}\n"), seed);
            assert_ne!(clip.report.outcome, Outcome::Fall, "{seed}");
            (format!("{seed}: {speed:.2} m/s, legs {legs}"), cadence(&clip).0 * tempo)
        })
        .collect();
    let mean = walked.iter().map(|(_, rate)| rate).sum::<f64>() / walked.len() as f64;
    walked.iter().for_each(|(name, rate)| println!("{name}: {rate:.0} steps a minute"));
    println!("mean {mean:.0}");
    for (name, rate) in &walked {
        assert!(*rate < BRISK, "{name}: {rate:.0} steps a minute");
    }
    assert!(mean < BRISK_MEAN, "{mean:.0}");
}

/// Of 1: the scores of each brisk walk, and of all; rad, how far a person's upper arms swing from hanging down at most.
const LEAST: f64 = 0.8;
const MEAN: f64 = 0.95;
const SWING: f64 = 0.8;
/// Share by which who has just set off is too fast at most.
const TOO_FAST: f64 = 0.08;

/// rad, how far ahead or behind the upper arms swing, from 4 s on.
fn arms(rig: &Rig, clip: &Baked) -> f64 {
    let arms = [[Role::LeftUpperArm, Role::LeftLowerArm], [Role::RightUpperArm, Role::RightLowerArm]];
    let arms = arms.map(|arm| arm.map(|role| rig.body.joint(role).expect("an arm")));
    let swung = |frame: u32| {
        let at = rig.sample(&clip.clip, 4.0 + f64::from(frame) / 30.0).positions;
        arms.map(|[shoulder, elbow]| at[elbow] - at[shoulder]).map(|bone| bone.z.atan2(-bone.y).abs())
    };
    (0..180).flat_map(swung).fold(0.0, f64::max)
}

#[test]
fn brisk_walks_are_as_fast_as_asked_and_swing_their_arms_as_people_do() {
    let people = people(&[1.0, 0.85, 1.2], &["gdquest_mannequiny.glb", "m2m_human_male.glb", "m2m_rig_human.glb"]);
    let walked: Vec<_> = (0..18_u64)
        .into_par_iter()
        .map(|seed| {
            let (rig, legs) = &people[seed as usize % people.len()];
            let speed = Seed::new(0xB215 ^ seed).between(0.7, 1.6) * (legs * rig.body.leg_length / 0.83).sqrt();
            let character = format!("[character]\nleg_scale = {legs}\n");
            let text =
                format!("title = \"walk\"\nduration = 12.0\n{character}[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n");
            let clip = baked(rig, &text, seed);
            let went = |from: f64, to: f64| {
                (rig.sample(&clip.clip, to).hips - rig.sample(&clip.clip, from).hips).length() / (to - from)
            };
            let off = [went(3.0, 5.0), went(4.0, 11.5)].map(|went| went / speed - 1.0);
            (format!("{seed}: {speed:.2} m/s, legs {legs}"), off, arms(rig, &clip), clip)
        })
        .collect();
    let mean = walked.iter().map(|(.., clip)| clip.report.plausibility.score).sum::<f64>() / walked.len() as f64;
    for (name, off, arms, clip) in &walked {
        let found = &clip.report.plausibility;
        let [first, then] = off.map(|off| 100.0 * off);
        println!("{name}: {first:+.1} %, then {then:+.1} %, arms {:.0} degrees, {:.2}", arms.to_degrees(), found.score);
    }
    println!("mean score {mean:.3}");
    for (name, off, arms, clip) in &walked {
        let found = &clip.report.plausibility;
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
        let [first, then] = off;
        assert!(*first < TOO_FAST && then.abs() < 0.05, "{name}: {:+.1}, then {:+.1} %", 100.0 * first, 100.0 * then);
        assert!(*arms < SWING, "{name}: arms swing by {:.0} degrees", arms.to_degrees());
        assert!(found.score > LEAST, "{name}: {:.2}, {:?}", found.score, found.notes);
    }
    assert!(mean > MEAN, "{mean:.3}");
}

/// m at legs of 0.83 m, how far apart the feet of who walks are at most, and how much farther after a shove than before. People's are 0.1
/// m apart; rigs with broad feet are planned 0.2 m apart.
const WIDTH: f64 = 0.25;
const WIDER: f64 = 0.05;

/// m, how far one foot is beside the other in the mean, of the steps in that time (s) along +Z.
fn width(baked: &Baked, [from, to]: [f64; 2]) -> f64 {
    let within = |start: f64| from < start && start < to;
    let flat = baked.report.contacts.iter().filter(|contact| contact.part == Part::Flat && within(contact.start));
    let mut feet: Vec<_> = flat.map(|contact| (contact.foot, contact.position[0])).collect();
    feet.dedup_by_key(|(foot, _)| *foot);
    feet.windows(2).map(|pair| (pair[1].1 - pair[0].1).abs()).sum::<f64>() / (feet.len() - 1) as f64
}

/// Share of the way (m) of such a walk along +Z that feet gain in `AFTER` s after a shove begins: by half a step at either end it can be off.
fn goes_on(baked: &Baked, start: f64, speed: f64) -> f64 {
    let until = |time: f64| {
        let stood = baked.report.contacts.iter().filter(|contact| contact.start < time);
        stood.map(|contact| contact.position[2]).fold(0.0, f64::max)
    };
    (until(start + AFTER) - until(start)) / (speed * AFTER)
}

const AFTER: f64 = 3.8;
/// What of that way is gone in the mean, and by all: a shove aside costs people a step or two, of seven.
const ONWARDS: [f64; 2] = [0.8, 0.5];

#[test]
fn who_is_shoved_aside_walks_on_with_his_feet_as_close_together_as_before() {
    let people = people(&[1.0, 0.85, 1.2], &["gdquest_mannequiny.glb", "m2m_human_male.glb", "m2m_rig_human.glb"]);
    let one = |seed: u64| {
        let (rig, legs) = &people[seed as usize % people.len()];
        let mut draw = Seed::new(0x51DE ^ seed);
        let size = legs * rig.body.leg_length / 0.83;
        let speed = (draw.between(0.4, 1.25) * size.sqrt()).min(1.3);
        let (start, lasts, impulse) = (draw.between(3.0, 4.0), draw.between(0.1, 0.3), draw.between(10.0, 60.0));
        let toward = draw.between(30.0, 150.0) * if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
        let push =
            format!("start = {start:.2}\nduration = {lasts:.2}\nforce = {:.0}\ntoward = {toward:.0}", impulse / lasts);
        let walk = format!("[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}");
        let text = format!("title = \"shove\"\nduration = {:.2}\n{walk}\n[[push]]\n{push}\n", start + 7.0);
        let clip = baked(rig, &text, seed);
        let stands = clip.report.outcome != Outcome::Fall;
        let [before, after] = [[start - 1.5, start], [start + 4.0, start + 6.7]];
        let wide = stands.then(|| [before, after].map(|time| width(&clip, time) / size));
        let gone = goes_on(&clip, start, speed);
        (format!("{seed}: legs {legs}, {speed:.2} m/s, {impulse:.0} N s toward {toward:.0}"), wide, gone)
    };
    let all: Vec<_> = (0..20).into_par_iter().map(one).collect();
    for (name, wide, gone) in &all {
        println!("{name}: {wide:.3?} m wide, {gone:.2} of its way");
    }
    let mean = all.iter().map(|(_, _, gone)| gone).sum::<f64>() / all.len() as f64;
    let halted: Vec<_> = all.iter().filter(|(_, _, gone)| *gone < ONWARDS[1]).map(|(name, ..)| name).collect();
    assert!(mean > ONWARDS[0] && halted.is_empty(), "{mean:.2} of the way in the mean; {halted:?}");
    for (name, wide, _) in &all {
        let close = wide.is_some_and(|[before, after]| after < WIDTH.min(before + WIDER));
        assert!(close, "{name}: {wide:.3?} m wide, or it falls");
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
fn who_has_narrow_hips_is_not_told_that_his_legs_come_near_each_other() {
    // Third-party skeletons whose hips' joints are 106 mm apart, on legs of 0.84 m: they stand so.
    let rigs = rigs(&["vrm_tiny_basic_armature.vrm", "vrm_tiny_basic_armature_vrm1.vrm"]);
    let cases: Vec<_> = rigs.iter().flat_map(|rig| (0..3).map(move |index| (rig, index))).collect();
    let walked: Vec<_> = cases
        .into_par_iter()
        .map(|((name, rig), index)| {
            let speed = Seed::new(0x4A2205 ^ (index << 8) ^ name.len() as u64).between(0.25, 1.2);
            let text = format!("title = \"walk\"\nduration = 8.0\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n");
            (format!("{name} at {speed:.2} m/s"), baked(rig, &text, index).report.plausibility)
        })
        .collect();
    for (name, found) in walked {
        println!("{name}: legs {:.0} mm, score {:.2}", found.legs_mm, found.score);
        let told = found.notes.iter().any(|note| note.contains("legs come within"));
        assert!(found.score > 0.9 && !told, "{name}: {:.2}, {:?}", found.score, found.notes);
    }
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
fn whoever_walks_stands_on_the_whole_of_his_sole() {
    let rig = builtin();
    for speed in [0.72, 0.74] {
        let character = "[character]\nleg_scale = 0.85\n";
        let text = format!("title = \"walk\"\nduration = 12.0\n{character}[[walk]]\nstart = 0.5\nspeed = {speed}\n");
        let report = baked(&rig, &text, 0).report;
        let on_ball = report.contacts.iter().filter(|contact| contact.part == Part::Ball);
        let longest = on_ball.map(|contact| contact.end - contact.start).fold(0.0, f64::max);
        assert!(longest < 0.12, "{speed} m/s: on a ball for {longest:.2} s");
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
