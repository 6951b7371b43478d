//! A base clip that stands, and what is asked of the character besides: it sets out from the clip's pose and is back in it at the end.

#![expect(clippy::print_stdout, reason = "the tables are what a person runs these for")]

use crate::common::builtin;
use crate::data;
use rayon::prelude::*;
use std::sync::Arc;
use surefoot::bake::base::prepare;
use surefoot::bake::{BakeOptions, Baked, Base, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::mocap;
use surefoot::model::Role;
use surefoot::model::pose::BodyPose;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{self, Carry, Direction, Feet, Push, Scenario, Stand, Turn, Walk};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::{Rig, load};

/// Rigs, the built-in one too, and stands of two of them, which all take.
const RIGS: [&str; 4] = ["builtin", "m2m_human_male.glb", "m2m_rig_human.glb", "m2m_human_base_animations.glb"];
const STANDS: [(&str, &str); 5] = [
    ("m2m_human_base_animations.glb", "Idle_Loop"),
    ("m2m_human_base_animations.glb", "Idle_Talking_Loop"),
    ("m2m_human_base_animations.glb", "Sword_Idle"),
    ("kaykit_Knight.glb", "Idle"),
    ("m2m_human_base_animations.glb", "Pistol_Idle_Loop"),
];
/// Cases of each kind.
const DRAWN: usize = 18;
/// Degrees and mm: as near to the clip are the first frame and the last one of who is back in it.
const AS_CLIP: (f64, f64) = (0.5, 2.0);
/// N s (on 89.5 kg), of who is shoved besides.
const SHOVES: [f64; 2] = [10.0, 30.0];
/// Share of the body's runs that are back in the clip at the end. The goal is 0.95.
const BACK: f64 = 0.8;

/// A rig and a stand on it; without other people's, the built-in one as it stands by itself with its feet apart.
fn stand(index: usize, scenario: &Scenario) -> (Rig, Base) {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let Some(data) = data::more() else {
        let rig = builtin();
        let mut wide = Scenario { title: "wide".into(), duration: 2.0, ..Scenario::default() };
        wide.character.style.stance_width = 1.0 + 0.2 * (index % 4) as f64;
        let made = bake(&rig, &wide, &BakeOptions::default()).expect("it bakes");
        let glb = surefoot::export::glb(&rig, &[(made.clip.clone(), made.report.clone())]).expect("it exports").bytes;
        let clips = mocap::read("made.glb", &glb, &alone, None).expect("it reads");
        let reading = clips.reading(0, &mocap::Options::default()).expect("it reads");
        let base = prepare(&rig, scenario, &reading, None).expect("it is a stand");
        return (rig, base);
    };
    let (on, (from, clip)) = (RIGS[index % RIGS.len()], STANDS[index % STANDS.len()]);
    let rig = if on == "builtin" { builtin() } else { load(&data.join("rigs").join(on)).expect("the rig loads") };
    let clips = mocap::load(&data.join("rigs").join(from)).expect("its clips load");
    let place = clips.find(clip).expect("the clip is there");
    let reading = clips.reading(place, &mocap::Options::default()).expect("it reads");
    let base = prepare(&rig, scenario, &reading, (on == from).then_some(place)).expect("it is a stand");
    (rig, base)
}

fn over() -> Scenario {
    let base = Some(scenario::Base { clip: None, file: None });
    Scenario { title: "asked".into(), duration: 12.0, base, ..Scenario::default() }
}

/// A walk, a turn or a stand on one foot, by turns, and a shove in the midst of every other one.
fn drawn(draw: &mut Seed, index: usize) -> (String, Rig, Base, Scenario) {
    let mut scenario = Scenario { seed: index as u64, ..over() };
    let start = draw.between(1.0, 2.0);
    let what = match index % 3 {
        0 => {
            let (speed, heading) = (draw.between(0.4, 1.0), draw.between(-45.0, 45.0_f64).to_radians());
            let duration = Some(draw.between(1.5, 3.0));
            scenario.walk.push(Walk { start, duration, speed, heading, facing: None });
            format!("walks at {speed:.2} m/s")
        }
        1 => {
            let facing = draw.between(30.0, 150.0) * if draw.between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
            scenario.turn.push(Turn { start, duration: None, facing: facing.to_radians() });
            format!("turns by {facing:.0}")
        }
        _ => {
            let on = if draw.between(0.0, 1.0) < 0.5 { Feet::Left } else { Feet::Right };
            scenario.stand.push(Stand { start, duration: Some(draw.between(2.0, 3.5)), on });
            format!("stands on {on:?}")
        }
    };
    let (rig, base) = stand(index, &scenario);
    let scale = rig.body.mass / 89.5 * (rig.body.leg_length / 0.83).sqrt();
    let (impulse, toward) = (draw.between(SHOVES[0], SHOVES[1]), draw.between(0.0, 360.0));
    let shoved = (index / 3) % 2 == 1;
    if shoved {
        let (start, toward) = (start + draw.between(0.3, 1.5), Direction::Heading(toward.to_radians()));
        scenario.push.push(Push { start, duration: 0.2, force: impulse * scale / 0.2, toward, at: Role::Chest });
    }
    let what = format!("{index}: {} {what}, shoved {shoved}", base.name);
    (what, rig, base, scenario)
}

fn play(rig: &Rig, scenario: &Scenario, base: Base, drive: Drive) -> Baked {
    let options = BakeOptions { base: Some(Arc::new(base)), drive, ..BakeOptions::default() };
    bake(rig, scenario, &options).expect("it bakes")
}

/// All cases with that drive; whether each ends in the clip, whose pose all begin in.
fn all(seed: u64, drive: Drive) -> Vec<(String, Baked, bool)> {
    let mut draw = Seed::new(seed);
    let cases: Vec<_> = (0..DRAWN).map(|index| drawn(&mut draw, index)).collect();
    let played = cases.into_par_iter().map(|(what, rig, base, scenario)| {
        let baked = play(&rig, &scenario, base, drive);
        let told = baked.report.base.as_ref().expect("the clip says where it comes from");
        let home = told.last_deg < AS_CLIP.0 && told.last_mm < AS_CLIP.1;
        assert!(told.first_deg < AS_CLIP.0 && told.first_mm < AS_CLIP.1, "{what}: {told:?}");
        (what, baked, home)
    });
    let played: Vec<_> = played.collect();
    for (what, baked, home) in &played {
        let report = &baked.report;
        println!(
            "{what}: {} {:?}, {} steps, score {:.2}, home {home} {:?}",
            report.drive, report.outcome, report.steps, report.plausibility.score, baked.warnings
        );
    }
    played
}

#[test]
fn who_walks_turns_or_stands_on_one_foot_out_of_a_stand_is_back_in_it() {
    let auto = Drive::Auto(Helped::Within(Assist::default()));
    for (what, baked, home) in all(7100, auto) {
        assert!(baked.report.outcome != Outcome::Fall, "{what} falls");
        assert!(home, "{what}: {:?}", baked.report.base);
    }
}

#[test]
fn the_body_walks_turns_and_stands_on_one_foot_out_of_a_stand() {
    let played = all(7200, Drive::Ragdoll(Helped::Within(Assist::default())));
    let [mut back, mut falls] = [0; 2];
    for (what, baked, home) in &played {
        if baked.report.outcome == Outcome::Fall {
            assert!(what.contains("shoved true"), "{what} falls");
            falls += 1;
            continue;
        }
        assert!(baked.report.steps > 0 || what.contains("stands"), "{what} does not step");
        let says = baked.warnings.iter().any(|one| one.contains("base clip") || one.contains("not at rest"));
        assert!(*home || says, "{what}: {:?}", baked.warnings);
        back += usize::from(*home);
    }
    println!("{back} of {} are back in the clip, {falls} fall", played.len());
    // goal: none
    assert!(falls <= 1, "{falls} who are shoved fall");
    assert!(back as f64 >= BACK * played.len() as f64, "{back} of {}", played.len());
}

/// Degrees: as far may an upper arm be turned against the chest from how the clip has it, of who goes and is not pushed: an aim holds.
const ARMS: f64 = 45.0;

#[test]
fn arms_stay_as_the_clip_has_them_while_the_body_turns_and_goes_back() {
    let mut draw = Seed::new(7300);
    // An aim, which each of the rigs takes.
    for index in [4, 9, 14, 19] {
        let facing = draw.between(50.0, 130.0_f64).to_radians() * [1.0, -1.0][index % 2];
        let scenario = Scenario { turn: vec![Turn { start: 1.5, duration: None, facing }], ..over() };
        let (rig, base) = stand(index, &scenario);
        let what = format!("{} on {}, turned by {:.0}", base.name, RIGS[index % RIGS.len()], facing.to_degrees());
        let baked = play(&rig, &scenario, base, Drive::Ragdoll(Helped::Within(Assist::default())));
        let run = &baked.performance.articulated.as_ref().expect("the body played").run;
        let chest = rig.body.joint(Role::Chest).or(rig.body.joint(Role::Spine)).expect("a chest");
        let farthest = [Role::LeftUpperArm, Role::RightUpperArm].map(|role| {
            let arm = rig.body.joint(role).expect("an arm");
            let against = |pose: &BodyPose| pose.turns[chest].inverse() * pose.turns[arm];
            let first = against(&run.poses[0]);
            let far = run.poses.iter().map(|pose| first.angle_between(against(pose)).to_degrees());
            far.fold(0.0, f64::max)
        });
        println!("{what}: {farthest:.0?} degrees");
        assert!(baked.report.outcome != Outcome::Fall, "{what}");
        assert!(farthest.iter().all(|far| *far < ARMS), "{what}: {farthest:?} degrees");
    }
}

#[test]
fn who_takes_up_a_box_out_of_a_stand_begins_in_it_and_is_back_when_he_has_let_go() {
    for index in 0..STANDS.len() {
        let size = vec![(0.0, glam::DVec3::new(0.4, 0.3, 0.3))];
        let carry = Carry { start: 1.5, end: Some(4.0), mass: vec![[0.0, 5.0]], size };
        let scenario = Scenario { carry: vec![carry], duration: 8.0, ..over() };
        let (rig, base) = stand(index, &scenario);
        let what = base.name.clone();
        let baked = play(&rig, &scenario, base, Drive::Stepper);
        let told = baked.report.base.as_ref().expect("the clip says where it comes from");
        let (degrees, mm) = (told.first_deg.max(told.last_deg), told.first_mm.max(told.last_mm));
        println!("{what}: {told:?} {:?}", baked.report.plausibility.notes);
        assert!(degrees < AS_CLIP.0 && mm < AS_CLIP.1, "{what}: {told:?}");
        // Fists open by their own bends: they popped by half a turn.
        assert!(baked.report.plausibility.pops_deg < 10.0, "{what}: {:?}", baked.report.plausibility.notes);
    }
}
