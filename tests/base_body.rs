//! Base clips that stand, played by the articulated body: as the clip until it is struck, in it again at the end.
//!
//! Of those that stand in the end so many are to be back in the clip by their own steps ([`BACK`]). How many fall is printed and not
//! asserted: `Sword_Idle` stands near the edge of its own feet, and short legs set wide apart do not catch a shove backwards.

#![expect(clippy::print_stdout, reason = "the tables are what a person runs these for")]

use crate::data;
use rayon::prelude::*;
use std::sync::Arc;
use surefoot::bake::base::prepare;
use surefoot::bake::{BakeOptions, Baked, Base, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::mocap;
use surefoot::model::Role;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{self, Direction, Push, Scenario, Walk};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::{Rig, load};

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
    let [mut standing, mut by_itself] = [0; 2];
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
    println!("{by_itself} of {standing} are back by their own steps");
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
        let walk = Walk { start: 0.5, duration: None, speed: 0.5, heading: 0.0, facing: None };
        let told = play(&rig, &Scenario { walk: vec![walk], ..scenario }, base).expect_err("not yet");
        assert!(told.contains("[base] beside [[walk]]"), "{told}");
    }
    for (file, clip, why) in [
        ("m2m_human_base_animations.glb", "Walk_Loop", "[base] that walks"),
        ("gdquest_mannequiny.glb", "idle", "thighs are turned"),
    ] {
        let Some((rig, base)) = rig_and_base(file, clip, &over(clip)) else { return };
        let told = play(&rig, &over(clip), base).expect_err("not yet");
        assert!(told.contains(why), "{clip}: {told}");
    }
}
