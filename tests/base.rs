//! Base clips: what a reaction starts from, plays over and comes back to.

#![expect(clippy::print_stdout, reason = "the tables are what a person runs these for")]

use crate::common::builtin;
use crate::data;
use std::sync::Arc;
use surefoot::bake::base::prepare;
use surefoot::bake::{BakeOptions, Baked, Base, bake};
use surefoot::mocap;
use surefoot::model::Role;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{self, Direction, Push, Scenario};
use surefoot::rig::{Rig, load};

/// The third-party rigs with stands of their own, and where to find them.
const STANDS: [(&str, &str); 7] = [
    ("m2m_human_base_animations.glb", "Idle_Loop"),
    ("m2m_human_base_animations.glb", "Sword_Idle"),
    ("m2m_human_base_animations.glb", "Pistol_Idle_Loop"),
    ("kaykit_Knight.glb", "Idle"),
    ("kaykit_Knight.glb", "2H_Melee_Idle"),
    ("gdquest_mannequiny.glb", "idle"),
    ("gdquest_mannequiny.glb", "fight_idle"),
];

/// A rig and one of its own clips, on it.
fn rig_and_clip(file: &std::path::Path, clip: &str, scenario: &Scenario) -> (Rig, Result<Base, String>) {
    let rig = load(file).expect("the rig loads");
    let clips = mocap::load(file).expect("its clips load");
    let index = clips.find(clip).expect("the clip is there");
    let reading = clips.reading(index, &mocap::Options::default()).expect("it reads");
    let base = prepare(&rig, scenario, &reading, Some(index)).map_err(|error| error.to_string());
    (rig, base)
}

/// A shove of so many Ns towards a heading (degrees), a second in.
fn shoved(clip: &str, heading: f64, impulse: f64) -> Scenario {
    Scenario {
        title: "shove".into(),
        duration: 6.0,
        base: Some(scenario::Base { clip: Some(clip.into()), file: None }),
        push: vec![Push {
            start: 1.0,
            duration: 0.2,
            force: impulse / 0.2,
            toward: Direction::Heading(heading.to_radians()),
            at: Role::Chest,
        }],
        ..Scenario::default()
    }
}

fn baked(rig: &Rig, scenario: &Scenario, base: Base) -> Baked {
    let options = BakeOptions { base: Some(Arc::new(base)), ..BakeOptions::default() };
    bake(rig, scenario, &options).expect("it bakes")
}

#[test]
fn a_reaction_starts_in_the_base_clip_and_comes_back_to_it() {
    let Some(data) = data::folder() else { return };
    println!(
        "{:<44} {:>5} {:>9} {:>22} {:>22} {:>6} {:>6}",
        "", "Ns", "outcome", "first deg mm", "last deg mm", "ZMP", "slip"
    );
    for (file, clip) in STANDS {
        for (heading, impulse) in [(0.0, 30.0), (-90.0, 60.0), (135.0, 90.0)] {
            let scenario = shoved(clip, heading, impulse);
            let (rig, base) = rig_and_clip(&data.join("rigs").join(file), clip, &scenario);
            let baked = baked(&rig, &scenario, base.expect("it is a stand"));
            row(&format!("{file} {clip} {heading}"), impulse, &baked);
            let told = baked.report.base.as_ref().expect("the clip says where it comes from");
            // The soles of mannequiny's idle slide and its thighs are turned by 100 degrees: it comes near.
            let (deg, mm) = if clip == "idle" { (0.6, 3.0) } else { (0.1, 1.0) };
            assert!(told.first_deg < deg && told.last_deg < deg, "{file} {clip}: {told:?}");
            assert!(told.first_mm < mm && told.last_mm < mm, "{file} {clip}: {told:?}");
            if impulse <= 60.0 {
                assert!(baked.report.plausibility.zmp_inside >= 0.95, "{file} {clip} {heading}");
                assert!(!matches!(baked.report.outcome, Outcome::Fall), "{file} {clip} {heading}");
            }
        }
    }
}

#[test]
fn what_neither_stands_nor_walks_is_no_base() {
    let Some(data) = data::folder() else { return };
    let all = [
        ("m2m_human_base_animations.glb", "Sitting_Idle_Loop", "out of its feet"),
        ("m2m_human_base_animations.glb", "Sprint_Loop", "A base is"),
        ("m2m_human_base_animations.glb", "Jump_Loop", "A base is"),
        ("m2m_human_base_animations.glb", "Jog_Fwd_Loop", "runs"),
        ("m2m_human_base_animations.glb", "Swim_Fwd_Loop", "lies"),
        ("kaykit_Knight.glb", "Running_A", "runs"),
        ("kaykit_Knight.glb", "Running_Strafe_Left", "runs"),
    ];
    for (file, clip, why) in all {
        let scenario = shoved(clip, 0.0, 30.0);
        let (rig, base) = rig_and_clip(&data.join("rigs").join(file), clip, &scenario);
        let told = match base {
            Err(error) => error,
            Ok(base) => {
                let options = BakeOptions { base: Some(Arc::new(base)), ..BakeOptions::default() };
                bake(&rig, &scenario, &options).expect_err("it is refused").to_string()
            }
        };
        assert!(told.contains(why) && told.contains(clip), "{clip}: {told}");
    }
}

/// A clip that the program itself bakes on the built-in rig, read back as a base clip of it.
fn own_base(made_of: &Scenario, scenario: &Scenario) -> (Rig, Base) {
    let rig = builtin();
    let made = bake(&rig, made_of, &BakeOptions::default()).expect("it bakes");
    let glb = surefoot::export::glb(&rig, &[(made.clip.clone(), made.report.clone())]).expect("it exports").bytes;
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let clips = mocap::read("made.glb", &glb, &alone, None).expect("it reads");
    let reading = clips.reading(0, &mocap::Options::default()).expect("it reads");
    let base = prepare(&rig, scenario, &reading, None).expect("it is a base");
    (rig, base)
}

#[test]
fn a_shove_over_an_own_stand_begins_and_ends_in_it() {
    let still = Scenario { title: "still".into(), duration: 2.0, ..Scenario::default() };
    let stand = shoved("still", -90.0, 60.0);
    let (rig, base) = own_base(&still, &stand);
    let over = baked(&rig, &stand, base);
    row("own stand", 60.0, &over);
    let told = over.report.base.as_ref().expect("the clip says where it comes from");
    assert!(told.first_deg.max(told.last_deg) < 0.1 && told.first_mm.max(told.last_mm) < 1.0, "{told:?}");
    assert!(over.report.plausibility.zmp_inside >= 0.95 && over.report.steps >= 1);
}

/// Walks that are a rig's own, as keyed for games: in place, their feet sliding and sinking; the least of ZMP inside that is held over
/// them, pushed too (KayKit's bodies bounce as no body on such feet can).
const WALKS: [(&str, &str, f64); 7] = [
    ("m2m_human_base_animations.glb", "Walk_Loop", 0.85),
    ("m2m_human_base_animations.glb", "Walk_Formal_Loop", 0.85),
    ("kaykit_Knight.glb", "Walking_A", 0.8),
    ("kaykit_Knight.glb", "Walking_B", 0.8),
    ("kaykit_Knight.glb", "Walking_C", 0.9),
    ("kaykit_Knight.glb", "Walking_Backwards", 0.75),
    ("khronos_CesiumMan.gltf", "0", 0.8),
];

#[test]
fn a_walk_is_pushed_and_walks_on_as_before() {
    let Some(data) = data::folder() else { return };
    for (file, clip, inside) in WALKS {
        for (heading, impulse) in [(0.0, 0.0), (-90.0, 20.0), (180.0, 40.0)] {
            let mut scenario = shoved(clip, heading, impulse);
            scenario.duration = 8.0;
            scenario.push.retain(|push| push.force > 0.0);
            let (rig, base) = rig_and_clip(&data.join("rigs").join(file), clip, &scenario);
            let scale = rig.body.mass / 89.5 * (rig.body.leg_length / 0.83).sqrt();
            scenario.push.iter_mut().for_each(|push| push.force *= scale);
            let baked = baked(&rig, &scenario, base.expect("it is a walk"));
            row(&format!("{file} {clip} {heading}"), impulse, &baked);
            let told = baked.report.base.as_ref().expect("the clip says where it comes from");
            assert!(told.first_deg < 0.1 && told.first_mm < 1.0, "{clip}: {told:?}");
            assert!(told.last_deg < 0.1 && told.last_mm < 1.0, "{clip} {heading}: {told:?}");
            assert!(baked.report.plausibility.zmp_inside > inside, "{clip} {heading}");
            assert!(!matches!(baked.report.outcome, Outcome::Fall), "{clip} {heading}");
            if impulse == 0.0 {
                // Of Walking_A the last frame has its heel 3 cm under the ground and its leg straight: the frame before does not reach there.
                assert!(baked.report.plausibility.slip_max_mm < 7.0, "{clip}");
            }
        }
    }
}

#[test]
fn a_base_ends_in_its_clip_wherever_in_a_frame_the_bake_ends() {
    let Some(data) = data::folder() else { return };
    for duration in [5.31, 6.487] {
        for impulse in [0.0, 20.0] {
            let mut scenario = shoved("Walk_Loop", 180.0, impulse);
            scenario.duration = duration;
            scenario.push.retain(|push| push.force > 0.0);
            let file = data.join("rigs/m2m_human_base_animations.glb");
            let (rig, base) = rig_and_clip(&file, "Walk_Loop", &scenario);
            let baked = baked(&rig, &scenario, base.expect("it is a walk"));
            let told = baked.report.base.as_ref().expect("the clip says where it comes from");
            assert!(told.last_deg < 0.1 && told.last_mm < 1.0, "{duration} {impulse}: {told:?}");
            assert!(told.first_deg < 0.1 && told.first_mm < 1.0, "{duration} {impulse}: {told:?}");
        }
    }
}

#[test]
fn a_stand_that_shifts_its_feet_is_played_from_where_they_stay() {
    let Some(data) = data::folder() else { return };
    let scenario = shoved("1H_Ranged_Aiming", -90.0, 15.0);
    let (rig, base) = rig_and_clip(&data.join("rigs/kaykit_Knight.glb"), "1H_Ranged_Aiming", &scenario);
    let base = base.expect("it is a stand");
    assert!(!base.walks && base.seconds() > 0.5 && base.seconds() < 0.9, "{} s of 1.07", base.seconds());
    assert!(base.notes.iter().any(|note| note.contains("shifts its feet")), "{:?}", base.notes);
    let baked = baked(&rig, &scenario, base);
    let told = baked.report.base.as_ref().expect("the clip says where it comes from");
    assert!(told.first_deg.max(told.last_deg) < 0.1 && told.first_mm.max(told.last_mm) < 1.0, "{told:?}");
}

#[test]
fn a_captured_walk_of_another_skeleton_goes_on_is_pushed_and_comes_back() {
    let Some(data) = data::folder() else { return };
    // The last one begins with a T-pose and in the middle of a stance.
    for (clip, rig) in [
        ("cmu_02_01_walk.bvh", None),
        ("pab_walk.fbx", Some("m2m_human_male.glb")),
        ("cmu_12_01_walk.bvh", Some("gdquest_mannequiny.glb")),
    ] {
        let rig = rig.map_or_else(builtin, |file| load(&data.join("rigs").join(file)).expect("the rig loads"));
        let mut scenario = shoved(clip, 90.0, 30.0);
        scenario.duration = 7.0;
        let clips = mocap::load(&data.join("clips").join(clip)).expect("its clip loads");
        let reading = clips.reading(0, &mocap::Options::default()).expect("it reads");
        let base = prepare(&rig, &scenario, &reading, None).expect("it is a walk");
        assert!(base.seconds() < 4.5, "the clip is shorter than what is baked");
        let over = baked(&rig, &scenario, base);
        row(clip, 30.0, &over);
        let told = over.report.base.as_ref().expect("the clip says where it comes from");
        assert!(told.first_deg < 0.1 && told.first_mm < 1.0, "{told:?}");
        assert!(told.last_deg < 0.1 && told.last_mm < 1.0, "{told:?}");
        assert!(over.report.plausibility.zmp_inside > 0.95 && over.report.plausibility.slip_max_mm < 2.0);
        assert!(!matches!(over.report.outcome, Outcome::Fall));
    }
}

fn row(name: &str, impulse: f64, baked: &Baked) {
    let told = baked.report.base.as_ref().expect("the clip says where it comes from");
    let measured = &baked.report.plausibility;
    println!(
        "{name:<44} {impulse:>5} {:>9} {:>11.3} {:>10.2} {:>11.3} {:>10.2} {:>6.1} {:>6.2} sink {:>4.1} score {:.2}",
        format!("{:?}{}", baked.report.outcome, baked.report.steps),
        told.first_deg,
        told.first_mm,
        told.last_deg,
        told.last_mm,
        measured.zmp_inside * 100.0,
        measured.slip_max_mm,
        measured.penetration_max_mm,
        measured.score
    );
    for note in baked.warnings.iter().chain(&measured.notes) {
        println!("      {note}");
    }
}
