//! Base clips: what a reaction starts from, plays over and comes back to.

#![expect(clippy::print_stdout, reason = "the tables are what a person runs these for")]

use crate::common::builtin;
use std::path::PathBuf;
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

fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("SUREFOOT_DATA").map(PathBuf::from);
    let folder = folder.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"));
    folder.is_dir().then_some(folder)
}

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
    let Some(data) = data() else {
        println!("skipped: no third-party rigs");
        return;
    };
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
    let Some(data) = data() else {
        println!("skipped: no third-party rigs");
        return;
    };
    let file = data.join("rigs/m2m_human_base_animations.glb");
    for (clip, why) in
        [("Sitting_Idle_Loop", "out of its feet"), ("Sprint_Loop", "A base is"), ("Jump_Loop", "A base is")]
    {
        let scenario = shoved(clip, 0.0, 30.0);
        let (rig, base) = rig_and_clip(&file, clip, &scenario);
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

/// Walks of third-party rigs.
const WALKS: [(&str, &str); 5] = [
    ("m2m_human_base_animations.glb", "Walk_Loop"),
    ("m2m_human_base_animations.glb", "Walk_Formal_Loop"),
    ("kaykit_Knight.glb", "Walking_A"),
    ("kaykit_Knight.glb", "Walking_Backwards"),
    ("khronos_CesiumMan.gltf", "0"),
];

#[test]
fn a_walk_is_pushed_and_walks_on_as_before() {
    let Some(data) = data() else {
        println!("skipped: no third-party rigs");
        return;
    };
    for (file, clip) in WALKS {
        for (heading, impulse) in [(0.0, 0.0), (-90.0, 20.0), (180.0, 40.0)] {
            let mut scenario = shoved(clip, heading, impulse);
            scenario.duration = 8.0;
            if impulse == 0.0 {
                scenario.push.clear();
            }
            let (rig, base) = rig_and_clip(&data.join("rigs").join(file), clip, &scenario);
            let base = match base {
                Ok(base) => base,
                Err(error) => {
                    println!("{file} {clip}: {error}");
                    continue;
                }
            };
            let options = BakeOptions { base: Some(Arc::new(base)), ..BakeOptions::default() };
            match bake(&rig, &scenario, &options) {
                Ok(baked) => {
                    row(&format!("{file} {clip} {heading}"), impulse, &baked);
                    if clip == "Walk_Loop" {
                        let told = baked.report.base.as_ref().expect("the clip says where it comes from");
                        assert!(told.first_deg < 0.1 && told.first_mm < 1.0, "{told:?}");
                        assert!(baked.report.plausibility.zmp_inside > 0.85, "{heading}");
                        assert!(!matches!(baked.report.outcome, Outcome::Fall));
                    }
                }
                Err(error) => println!("{file} {clip}: {error}"),
            }
        }
    }
}

#[test]
fn a_captured_walk_of_another_skeleton_goes_on_is_pushed_and_comes_back() {
    let Some(data) = data() else {
        println!("skipped: no third-party clips");
        return;
    };
    for (clip, rig) in [("cmu_02_01_walk.bvh", None), ("pab_walk.fbx", Some("m2m_human_male.glb"))] {
        let rig = rig.map_or_else(builtin, |file| load(&data.join("rigs").join(file)).expect("the rig loads"));
        let mut scenario = shoved(clip, 90.0, 30.0);
        scenario.duration = 7.0;
        let clips = mocap::load(&data.join("clips").join(clip)).expect("its clip loads");
        let reading = clips.reading(0, &mocap::Options::default()).expect("it reads");
        let base = prepare(&rig, &scenario, &reading, None).expect("it is a walk");
        assert!(base.seconds() < 3.5, "the clip is shorter than what is baked");
        let over = baked(&rig, &scenario, base);
        row(clip, 30.0, &over);
        let told = over.report.base.as_ref().expect("the clip says where it comes from");
        assert!(told.first_deg < 0.1 && told.first_mm < 1.0, "{told:?}");
        assert!(told.last_deg < 0.3 && told.last_mm < 2.0, "{told:?}");
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
