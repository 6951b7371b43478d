//! Base clips: what a reaction starts from, plays over and comes back to.

use std::path::PathBuf;
use std::sync::Arc;
use surefoot::bake::base::prepare;
use surefoot::bake::{BakeOptions, Baked, Base, bake};
use surefoot::mocap;
use surefoot::model::Role;
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
    println!("{:<44} {:>5} {:>9} {:>22} {:>22} {:>6} {:>6}", "", "Ns", "outcome", "first deg mm", "last deg mm", "ZMP", "slip");
    for (file, clip) in STANDS {
        for (heading, impulse) in [(0.0, 30.0), (-90.0, 60.0), (135.0, 90.0)] {
            let scenario = shoved(clip, heading, impulse);
            let (rig, base) = rig_and_clip(&data.join("rigs").join(file), clip, &scenario);
            let baked = baked(&rig, &scenario, base.expect("it is a stand"));
            let told = baked.report.base.as_ref().expect("the clip says where it comes from");
            let measured = &baked.report.plausibility;
            println!(
                "{:<44} {:>5} {:>9} {:>11.3} {:>10.2} {:>11.3} {:>10.2} {:>6.1} {:>6.2}",
                format!("{file} {clip} {heading}"),
                impulse,
                format!("{:?}{}", baked.report.outcome, baked.report.steps),
                told.first_deg,
                told.first_mm,
                told.last_deg,
                told.last_mm,
                measured.zmp_inside * 100.0,
                measured.slip_max_mm
            );
        }
    }
}
