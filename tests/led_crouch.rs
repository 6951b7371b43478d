//! The articulated body crouched on level ground: walks, shoved and not, and crouches in the midst of walks, turns and stands on one foot.
//! Measured on the clip that the user gets.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::report::Outcome;
use surefoot::model::{Role, scenario_text};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::Rig;

/// By joint torques alone.
const DRIVE: Drive = Drive::Ragdoll(Helped::Within(Assist { torque: 0.0, force: 0.0 }));
/// s, from when to when a walk is looked at, and how long clips are.
const STEADY: [f64; 2] = [3.0, 7.5];
const LONG: f64 = 8.0;

/// A rig, how long its legs are made, and the deepest crouch that is drawn for it.
struct Subject {
    rig: Rig,
    legs: f64,
    deepest: f64,
    /// m, kg.
    leg: f64,
    mass: f64,
}

fn subjects() -> Vec<Subject> {
    let subject = |rig: Rig, legs: f64, deepest: f64| {
        let at = |role: Role| rig.body.joints[rig.body.joint(role).expect("it is there")].rest;
        let [hip, knee, ankle] = [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot].map(at);
        let leg = (hip.distance(knee) + knee.distance(ankle)) * legs;
        Subject { mass: rig.body.mass, rig, legs, deepest, leg }
    };
    let mut subjects = vec![subject(builtin(), 1.0, 0.25), subject(builtin(), 0.7, 0.3), subject(builtin(), 1.3, 0.17)];
    match data::more() {
        Some(folder) => {
            let loaded = |name: &str| surefoot::rig::load(&folder.join("rigs").join(name)).expect("the rig loads");
            subjects.push(subject(loaded("m2m_human_male.glb"), 1.0, 0.16));
            subjects.push(subject(loaded("gdquest_mannequiny.glb"), 1.0, 0.25));
        }
        None => subjects.extend([subject(builtin(), 0.85, 0.27), subject(builtin(), 1.1, 0.22)]),
    }
    subjects
}

impl Subject {
    /// Times what it is for legs of 0.83 m, a speed.
    fn pace(&self) -> f64 {
        (self.leg / 0.83).sqrt()
    }

    /// Share of the leg, m/s: a crouch and a pace that are drawn.
    fn low_and_fast(&self, draw: &mut Seed) -> [f64; 2] {
        let amount = draw.between(0.1, self.deepest);
        [amount, (draw.between(0.3, 1.0) * self.pace()).min(self.legs.sqrt())]
    }

    fn baked(&self, character: &str, lanes: &str, seed: u64) -> Baked {
        let text =
            format!("title = \"c\"\nduration = {LONG}\n[character]\nleg_scale = {}\n{character}\n{lanes}", self.legs);
        let scenario = scenario_text::parse("crouch", &text).unwrap_or_else(|errors| panic!("{errors:?}\n{text}"));
        let options = BakeOptions { drive: DRIVE, seed: Some(seed), ..BakeOptions::default() };
        bake(&self.rig, &scenario, &options).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    /// m, where the hips are at those times.
    fn hips(&self, clip: &Baked, times: &[f64]) -> Vec<glam::DVec3> {
        let hips = self.rig.body.joint(Role::Hips).expect("hips");
        let mut sampler = self.rig.sampler(&clip.clip);
        times.iter().map(|time| sampler.sample(*time).positions[hips]).collect()
    }

    /// m, how high the hips are in the stand that an uncrouched clip begins in.
    fn stands(&self) -> f64 {
        self.hips(&self.baked("", "", 0), &[0.0])[0].y
    }
}

/// Numbers of a clip for a person, and what no clip may do.
fn told(name: &str, clip: &Baked) -> f64 {
    let (report, score) = (&clip.report, &clip.report.plausibility);
    println!(
        "{name}: {:?}, {} steps, score {:.2}, point inside {:.2}, slip {:.1} mm, {:.1} mm deep, {:?}",
        report.outcome,
        report.steps,
        score.score,
        score.zmp_inside,
        score.slip_max_mm,
        score.penetration_max_mm,
        score.notes
    );
    assert!(score.joint_excess_share <= 0.01, "{name}: {:?}", score.notes);
    assert!(score.hover_longest_s <= 0.05, "{name}: {:?}", score.notes);
    assert!(score.slip_max_mm <= 1.5 && score.penetration_max_mm <= 6.0, "{name}: {:?}", score.notes);
    score.score
}

#[test]
fn crouched_walks_go_as_fast_and_as_low_as_they_are_told() {
    let subjects = subjects();
    let heights: Vec<f64> = subjects.par_iter().map(Subject::stands).collect();
    let found: Vec<_> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0xC203C);
            let subject = &subjects[seed as usize % subjects.len()];
            let [amount, speed] = subject.low_and_fast(&mut draw);
            let lane = format!("[[walk]]\nstart = 0.5\nspeed = {speed:.3}\n");
            let clip = subject.baked(&format!("crouch = {amount:.3}"), &lane, seed);
            let times: Vec<f64> =
                (0..=150).map(|tick| STEADY[0] + (STEADY[1] - STEADY[0]) * f64::from(tick) / 150.0).collect();
            let hips = subject.hips(&clip, &times);
            let goes = (hips[150] - hips[0]).with_y(0.0).length() / (STEADY[1] - STEADY[0]);
            let low = heights[seed as usize % subjects.len()] - hips.iter().map(|at| at.y).sum::<f64>() / 151.0;
            (
                seed,
                format!("crouched by {amount:.2} at {speed:.2} m/s"),
                clip,
                [goes / speed - 1.0, low / (amount * subject.leg)],
            )
        })
        .collect();
    let mut sum = 0.0;
    for (seed, name, clip, [faster, share]) in found {
        let score = told(&format!("{seed}: {name}, {:+.1} %, {share:.2} as low", 100.0 * faster), &clip);
        assert_ne!(clip.report.outcome, Outcome::Fall, "{seed}: {name}");
        assert!((0.85..1.15).contains(&share), "{seed}: {name}: lower by {share:.2} of what was asked");
        assert!(score >= 0.7, "{seed}: {name}: {:?}", clip.report.plausibility.notes);
        assert!(faster.abs() < 0.05, "{seed}: {name}: {:+.1} %", 100.0 * faster);
        sum += score;
    }
    println!("mean score {:.3}", sum / 20.0);
    assert!(sum / 20.0 > 0.9, "mean score {:.3}", sum / 20.0);
}

#[test]
fn who_is_shoved_in_a_crouched_walk_or_stand_keeps_his_feet() {
    let subjects = subjects();
    let found: Vec<_> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x5407E);
            let subject = &subjects[seed as usize % subjects.len()];
            let [amount, speed] = subject.low_and_fast(&mut draw);
            let walk = if seed < 15 { format!("[[walk]]\nstart = 0.5\nspeed = {speed:.3}\n") } else { String::new() };
            let force = 30.0 / 0.2 * subject.mass / 89.5 * subject.pace();
            let (start, toward) = (draw.between(3.0, 4.5), draw.between(-180.0, 180.0));
            let push =
                format!("[[push]]\nstart = {start:.2}\nduration = 0.2\nforce = {force:.0}\ntoward = {toward:.0}\n");
            let name = format!("crouched by {amount:.2}, {walk:?}, toward {toward:.0}");
            (seed, name, subject.baked(&format!("crouch = {amount:.3}"), &(walk + &push), seed))
        })
        .collect();
    let mut falls = 0;
    for (seed, name, clip) in found {
        told(&format!("{seed}: {name}"), &clip);
        falls += usize::from(clip.report.outcome == Outcome::Fall);
    }
    assert_eq!(falls, 0, "{falls} of 20 fall");
}

#[test]
fn one_goes_down_and_up_in_the_midst_of_walks_turns_and_stands() {
    let subjects = subjects();
    let found: Vec<_> = (0..20u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0xD0D0);
            let subject = &subjects[seed as usize % subjects.len()];
            let [amount, speed] = subject.low_and_fast(&mut draw);
            let slow = speed.min(0.3 * subject.legs.sqrt()) - 1e-3;
            let start = draw.between(1.5, 3.0);
            let aside = [180.0, 90.0, -90.0][(draw.bits() % 3) as usize];
            let other = match seed / 5 {
                0 => format!("[[walk]]\nstart = 0.5\nspeed = {speed:.3}\n"),
                1 => format!("[[walk]]\nstart = 0.5\nspeed = {slow:.3}\nheading = {aside}\nfacing = 0\n"),
                2 => format!("[[turn]]\nstart = 3\nfacing = {:.0}\n", draw.between(-170.0, 170.0)),
                _ => {
                    format!("[[stand]]\nstart = 2.5\nduration = 3\non = \"{}\"\n", ["left", "right"][seed as usize % 2])
                }
            };
            let lane = format!("[[crouch]]\nstart = {start:.2}\nduration = 3.5\namount = {amount:.3}\n{other}");
            let clip = subject.baked("", &lane, seed);
            let hips = subject.hips(&clip, &[0.0, start + 2.5, LONG]);
            (
                seed,
                lane,
                clip,
                [(hips[0].y - hips[1].y) / (amount * subject.leg), (hips[2].y - hips[1].y) / (hips[0].y - hips[1].y)],
            )
        })
        .collect();
    let mut sum = 0.0;
    for (seed, name, clip, [share, rises]) in found {
        let score = told(&format!("{seed}: {name:?}, {share:.2} as low, {rises:.2} of it risen"), &clip);
        assert_ne!(clip.report.outcome, Outcome::Fall, "{seed}: {name}");
        assert!((0.75..1.3).contains(&share), "{seed}: {name}: lower by {share:.2} of what was asked");
        // Who walks is lower than who stands, and so is who has yet to set his feet side by side.
        assert!(rises > 0.5, "{seed}: {name}: risen by {rises:.2} of what it was lower");
        assert!(score >= 0.7, "{seed}: {name}: {:?}", clip.report.plausibility.notes);
        sum += score;
    }
    println!("mean score {:.3}", sum / 20.0);
    assert!(sum / 20.0 > 0.9, "mean score {:.3}", sum / 20.0);
}

#[test]
fn who_is_told_to_walk_lower_than_his_ankles_allow_walks_as_low_as_they_do_and_says_so() {
    let mut draw = Seed::new(0xDEE9);
    for (index, subject) in subjects().iter().enumerate() {
        let pace = draw.between(0.4, 0.8) * subject.pace();
        let lanes = format!("[[crouch]]\nstart = 1.0\namount = 0.5\n[[walk]]\nstart = 0.5\nspeed = {pace:.3}\n");
        let clip = subject.baked("", &lanes, index as u64);
        assert_ne!(clip.report.outcome, Outcome::Fall, "{index}");
        let said = clip.warnings.iter().any(|warning| warning.contains("legs of the ragdoll let it crouch by"));
        assert!(said, "{index}: {:?}", clip.warnings);
        let hips = subject.hips(&clip, &[0.0, STEADY[0], STEADY[1]]);
        let speed = (hips[2].z - hips[1].z) / (STEADY[1] - STEADY[0]);
        let lower = (hips[0].y - hips[2].y) / subject.leg;
        println!("{index}: {lower:.2} of the leg lower, at {speed:.2} of {pace:.2} m/s");
        assert!(lower > 0.1 && speed > 0.8 * pace, "{index}: {lower:.2} lower at {speed:.2} of {pace:.2} m/s");
    }
}
