//! Base clips, played by the articulated body: as the clip until it is struck, in it again at the end.
//!
//! Of those that stand in the end so many are to be back in the clip by their own steps ([`BACK`]). How many fall is printed and not
//! asserted: `Sword_Idle` stands near the edge of its own feet, and short legs set wide apart do not catch a shove backwards.

#![expect(clippy::print_stdout, reason = "the tables are what a person runs these for")]

use crate::common::builtin;
use crate::data;
use rayon::prelude::*;
use std::sync::Arc;
use surefoot::bake::base::{Walked, prepare};
use surefoot::bake::{BakeOptions, Baked, Base, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::mocap;
use surefoot::model::Role;
use surefoot::model::report::{ClipReport, Outcome};
use surefoot::model::scenario::{self, Crouch, Direction, Push, Scenario, Walk};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::{Rig, load};
use surefoot::stepper::StepKind;
use surefoot::whole_body::Anatomy;

/// Stands that third-party rigs have of their own.
const STANDS: [(&str, &str); 5] = [
    ("m2m_human_base_animations.glb", "Idle_Loop"),
    ("m2m_human_base_animations.glb", "Sword_Idle"),
    ("m2m_human_base_animations.glb", "Pistol_Idle_Loop"),
    ("kaykit_Knight.glb", "Idle"),
    ("kaykit_Knight.glb", "2H_Melee_Idle"),
];
/// mm that a clip which is back may be led from its run: the run's hinges are 24 to 49 mm beside the clip's joints from the start.
const LED: f64 = 60.0;
/// Share of those that stand which are back in the clip by themselves at the end. The goal is 0.95.
const BACK: f64 = 0.6;
/// N s (on 89.5 kg): so much nobody falls of.
const HOLDS: f64 = 75.0;
/// Degrees and mm: as near to the clip are the first frame and the last one of who is back in it.
const AS_CLIP: (f64, f64) = (0.5, 2.0);

fn rig_and_base(file: &str, clip: &str, scenario: &Scenario) -> Option<(Rig, Base)> {
    let file = data::folder()?.join("rigs").join(file);
    let rig = load(&file).expect("the rig loads");
    let clips = mocap::load(&file).expect("its clips load");
    let index = clips.find(clip).expect("the clip is there");
    let reading = clips.reading(index, &mocap::Options::default()).expect("it reads");
    let base = prepare(&rig, scenario, &reading, Some(index)).expect("it is a base");
    Some((rig, base))
}

fn over(clip: &str) -> Scenario {
    let base = Some(scenario::Base { clip: Some(clip.into()), file: None });
    Scenario { title: "over".into(), duration: 8.0, base, ..Scenario::default() }
}

fn play(rig: &Rig, scenario: &Scenario, base: Base) -> Result<Baked, String> {
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    let options = BakeOptions { base: Some(Arc::new(base)), drive, ..BakeOptions::default() };
    bake(rig, scenario, &options).map_err(|error| error.to_string())
}

/// A stand, and a shove of so many N s (on 89.5 kg) towards anywhere, drawn.
fn drawn(draw: &mut Seed, index: usize, [least, most]: [f64; 2]) -> Option<(Rig, Base, Scenario)> {
    let (file, clip) = STANDS[index % STANDS.len()];
    let mut scenario = over(clip);
    let (rig, base) = rig_and_base(file, clip, &scenario)?;
    let scale = rig.body.mass / 89.5 * (rig.body.leg_length / 0.83).sqrt();
    let impulse = draw.between(least, most) * scale;
    let toward = Direction::Heading(draw.between(0.0, 360.0).to_radians());
    scenario.push.push(Push { start: 1.5, duration: 0.2, force: impulse / 0.2, toward, at: Role::Chest });
    scenario.seed = index as u64;
    Some((rig, base, scenario))
}

#[test]
fn who_is_shoved_out_of_a_stand_begins_in_it_and_ends_in_it_or_is_told() {
    let [mut standing, mut by_itself, mut stiff] = [0; 3];
    for (bin, impulses) in [[15.0, 40.0], [40.0, 75.0], [75.0, 110.0], [110.0, 150.0]].into_iter().enumerate() {
        let mut draw = Seed::new(2300 + bin as u64);
        let Some(cases) = (0..10).map(|index| drawn(&mut draw, index, impulses)).collect::<Option<Vec<_>>>() else {
            return;
        };
        let [mut stand, mut home] = [0; 2];
        let all: Vec<Baked> = cases
            .into_par_iter()
            .map(|(rig, base, scenario)| play(&rig, &scenario, base).expect("it is played"))
            .collect();
        for baked in &all {
            let what = format!("{:?}: {:?}", baked.report.base, baked.report.disturbances);
            let told = baked.report.base.as_ref().expect("the clip says where it comes from");
            assert!(told.first_deg < AS_CLIP.0 && told.first_mm < AS_CLIP.1, "{what}");
            // The feet stand as in the clip from the start, and what is said to stand is still.
            for side in surefoot::model::Side::BOTH {
                let first = baked.performance.contacts.iter().find(|contact| contact.side == side);
                assert!(first.is_some_and(|first| first.start == 0.0 && first.end >= 1.5), "{what}: {first:?}");
            }
            let drift = baked.report.drift.expect("a ragdoll's");
            assert!(drift.position_mm > 0.0, "{what}: no clip is its run to the last digit");
            if baked.report.outcome == Outcome::Fall {
                continue;
            }
            stand += 1;
            stiff += usize::from(baked.report.plausibility.notes.iter().any(|note| note.starts_with("the push gives")));
            let back = told.last_deg < AS_CLIP.0 && told.last_mm < AS_CLIP.1;
            home += usize::from(back);
            let led = drift.position_mm > LED;
            by_itself += usize::from(back && !led);
            if !back || led {
                println!(
                    "  {} steps, {:.0} mm from its run, {what}: {:?}",
                    baked.report.steps, drift.position_mm, baked.warnings
                );
            }
            let says = baked.warnings.iter().any(|one| one.contains("base clip"));
            let unrest = baked.warnings.iter().any(|one| one.contains("not at rest"));
            assert!(back || says || unrest, "{what}: {:?}", baked.warnings);
            assert!(baked.report.plausibility.slip_max_mm < 1.0 || !back, "{what}: {:?}", baked.report.contacts);
        }
        println!("{impulses:?} N s: of {} {stand} stand, {home} are back in the clip", all.len());
        standing += stand;
        assert!(impulses[1] > HOLDS || stand == all.len(), "{impulses:?}: {stand} stand");
    }
    println!("{by_itself} of {standing} are back by their own steps, {stiff} answer a push before anybody feels it");
    // goal: none
    assert!(stiff * 5 <= standing, "{stiff} of {standing} answer a push before anybody feels it");
    assert!(by_itself as f64 >= BACK * standing as f64);
}

#[test]
fn nobody_struck_is_the_clip_and_what_cannot_be_played_over_a_base_is_named() {
    for (file, clip) in STANDS {
        let scenario = Scenario { duration: 3.0, ..over(clip) };
        let Some((rig, base)) = rig_and_base(file, clip, &scenario) else { return };
        let baked = play(&rig, &scenario, base.clone()).expect("it is played");
        let told = baked.report.base.as_ref().expect("told");
        assert!(told.last_deg < AS_CLIP.0 && told.last_mm < AS_CLIP.1, "{clip}: {told:?}");
        assert!(baked.report.outcome != Outcome::Fall && baked.report.steps == 0, "{clip}");
        assert!(baked.report.plausibility.slip_max_mm < 1.0, "{clip}");
        let crouch = Crouch { start: 0.5, duration: None, amount: 0.2 };
        let told = play(&rig, &Scenario { crouch: vec![crouch], ..scenario }, base).expect_err("not yet");
        assert!(told.contains("[base] beside [[crouch]]"), "{told}");
    }
    for (file, clip, why) in [
        ("kaykit_Knight.glb", "Walking_A", "[base] that walks at more than 1.3 m/s"),
        ("kaykit_Knight.glb", "Walking_C", "[base] that walks as the body of this rig does not"),
        ("m2m_human_base_animations.glb", "Crouch_Fwd_Loop", "[base] that walks crouched"),
        ("gdquest_mannequiny.glb", "idle", "thighs are turned"),
    ] {
        let Some((rig, base)) = rig_and_base(file, clip, &over(clip)) else { return };
        let told = play(&rig, &over(clip), base).expect_err("not yet");
        assert!(told.contains(why), "{clip}: {told}");
    }
}

/// Walks: a rig, and a clip of its own or a captured one.
const WALKS: [(&str, &str); 5] = [
    ("m2m_human_base_animations.glb", "Walk_Loop"),
    ("m2m_human_base_animations.glb", "Walk_Formal_Loop"),
    ("builtin", "cmu_02_01_walk.bvh"),
    ("m2m_human_male.glb", "pab_walk.fbx"),
    ("m2m_human_male.glb", "cmu_12_01_walk.bvh"),
];
/// N s (on 89.5 kg): so much an own walk stands from anywhere.
const WALKERS: [f64; 2] = [10.0, 40.0];
/// Shoves of each walk.
const SHOVES: usize = 4;

/// mm that a planted foot may slip from the strike on. Contacts of the clip itself may as in the clip without a shove.
const SLIPS: f64 = 1.0;
/// s, the longest that no foot may be on the ground.
const HOVERS: f64 = 0.05;
/// Of the score of the same clip without a shove, mean: what a clip of a person leaves open (zero-moment point, knees) is not the body's.
const AS_GOOD: f64 = 0.8;

/// A rig and a walk.
fn walk_on(place: usize, scenario: &Scenario) -> Option<(Rig, Base)> {
    let Some(data) = data::folder() else {
        // Without other people's walks, those that the program bakes.
        let rig = builtin();
        let speed = 0.6 + 0.1 * place as f64;
        let lane = Walk { start: 0.0, duration: None, speed, heading: 0.0, facing: None };
        let made = Scenario { title: "made".into(), duration: 8.0, walk: vec![lane], ..Scenario::default() };
        let made = bake(&rig, &made, &BakeOptions { looped: true, ..BakeOptions::default() }).expect("it bakes");
        let glb = surefoot::export::glb(&rig, &[(made.clip.clone(), made.report.clone())]).expect("it exports").bytes;
        let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let clips = mocap::read("made.glb", &glb, &alone, None).expect("it reads");
        let reading = clips.reading(0, &mocap::Options::default()).expect("it reads");
        let base = prepare(&rig, scenario, &reading, None).expect("it is a walk");
        return Some((rig, base));
    };
    let (file, clip) = WALKS[place];
    if !clip.contains('.') {
        return rig_and_base(file, clip, scenario);
    }
    let rig = if file == "builtin" { builtin() } else { load(&data.join("rigs").join(file)).expect("it loads") };
    let clips = mocap::load(&data.join("clips").join(clip)).expect("its clip loads");
    let reading = clips.reading(0, &mocap::Options::default()).expect("it reads");
    let base = prepare(&rig, scenario, &reading, None).expect("it is a walk");
    Some((rig, base))
}

/// Steps against a fall, and to a comfortable stand.
fn catches(baked: &Baked) -> usize {
    baked.performance.trace.steps.iter().filter(|step| step.kind != StepKind::Walk && step.land < 10.0).count()
}

#[test]
fn who_is_shoved_in_a_walk_catches_himself_and_is_back_in_it() {
    let mut draw = Seed::new(4100);
    let mut cases = Vec::new();
    let mut bare = Vec::new();
    for (place, walk) in WALKS.iter().enumerate() {
        let scenario = Scenario { duration: 9.0, ..over(walk.1) };
        let Some((rig, base)) = walk_on(place, &scenario) else { return };
        bare.push(play(&rig, &scenario, base).expect("it is played"));
        for index in 0..SHOVES {
            let mut scenario = scenario.clone();
            let Some((rig, base)) = walk_on(place, &scenario) else { return };
            let scale = rig.body.mass / 89.5 * (rig.body.leg_length / 0.83).sqrt();
            let impulse = draw.between(WALKERS[0], WALKERS[1]);
            let heading = draw.between(0.0, 360.0);
            let toward = Direction::Heading(heading.to_radians());
            let start = draw.between(1.5, 2.8);
            let push = Push { start, duration: 0.2, force: impulse * scale / 0.2, toward, at: Role::Chest };
            scenario.push.push(push);
            scenario.seed = (SHOVES * place + index) as u64;
            cases.push((format!("{walk:?} {impulse:.0} N s to {heading:.0} at {start:.2} s"), rig, base, scenario));
        }
    }
    let count = cases.len();
    let all: Vec<(String, Baked, Baked)> = cases
        .into_par_iter()
        .map(|(what, rig, base, scenario)| {
            // The same shove of an own walk, in the midst of it too.
            let walked = Walked::new(Arc::new(base.clone()), &rig.body, &Anatomy::new(&rig.body), 9.0).expect("a walk");
            let lane =
                Walk { start: 0.0, duration: None, speed: walked.gait.velocity.length(), heading: 0.0, facing: None };
            let mut own = Scenario { base: None, walk: vec![lane], duration: 12.0, ..scenario.clone() };
            own.push[0].start += 4.0;
            let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
            let own = bake(&rig, &own, &BakeOptions { drive, ..BakeOptions::default() }).expect("it bakes");
            (what, play(&rig, &scenario, base).expect("it is played"), own)
        })
        .collect();
    let [mut stand, mut own_stand, mut home, mut steps, mut own_steps] = [0; 5];
    let mut as_good = 0.0;
    for (index, (what, baked, own)) in all.iter().enumerate() {
        let clip = &bare[index / SHOVES].report;
        let struck = baked.report.disturbances.first().map_or(0.0, |push| push.start);
        let slips = |report: &ClipReport, from: f64| {
            let later = report.contacts.iter().filter(|contact| contact.end > from);
            later.map(|contact| contact.slip_mm).fold(0.0, f64::max)
        };
        let (slip, own_slip) = (slips(&baked.report, struck), slips(clip, 0.0));
        let told = baked.report.base.as_ref().expect("the clip says where it comes from");
        let measured = &baked.report.plausibility;
        println!(
            "{what}: {:?}, own {:?}, catches {} and {}, score {:.2} ({:.2}), slip {slip:.2} ({own_slip:.2}), hover {:.2}, sunk {:.1}, pops {:.0}, {told:?} {:?}",
            baked.report.outcome,
            own.report.outcome,
            catches(baked),
            catches(own),
            measured.score,
            clip.plausibility.score,
            measured.hover_longest_s,
            measured.penetration_max_mm,
            measured.pops_deg,
            baked.warnings
        );
        assert!(told.first_deg < AS_CLIP.0 && told.first_mm < AS_CLIP.1, "{what}: {told:?}");
        own_stand += usize::from(own.report.outcome != Outcome::Fall);
        if baked.report.outcome == Outcome::Fall {
            continue;
        }
        stand += 1;
        let back = told.last_deg < AS_CLIP.0 && told.last_mm < AS_CLIP.1;
        home += usize::from(back);
        assert!(slip < SLIPS.max(own_slip + 0.1), "{what}: slips by {slip} mm, the clip by {own_slip} mm");
        assert!(measured.hover_longest_s <= HOVERS, "{what}: hovers for {} s", measured.hover_longest_s);
        as_good += measured.score / clip.plausibility.score;
        steps += catches(baked);
        own_steps += catches(own);
    }
    println!("of {count} {stand} stand ({own_stand} own walks), {home} are back; {steps} steps, own {own_steps}");
    println!("score {:.2} of the clip's own", as_good / stand as f64);
    assert!(as_good >= AS_GOOD * stand as f64, "score {:.2} of the clip's own", as_good / stand as f64);
    assert!(stand + 1 >= count, "of {count} {stand} stand");
    assert!(home == stand, "of {stand} {home} are back");
    assert!(steps <= own_steps + stand / 5, "{steps} steps, own walks {own_steps}");
}
