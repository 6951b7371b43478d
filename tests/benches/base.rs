//! The plausibility of shoves with and without a base clip: six third-party rigs x 8 directions x 4 strengths, and how far the ends are
//! from the base clip's pose. `cargo bench --bench base` prints it.
//!
//! Impulses are for 89.5 kg and a 0.83 m leg, and scale with the body. Stands only: of walks `tests/base.rs` prints some.

#![expect(clippy::print_stdout, reason = "the table")]

use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;
use surefoot::bake::base::prepare;
use surefoot::bake::{BakeOptions, Base, bake};
use surefoot::mocap;
use surefoot::model::report::{ClipReport, Outcome};
use surefoot::model::scenario::{Direction, Push, Scenario};
use surefoot::model::{Role, scenario};
use surefoot::rig::{Rig, load};

/// Rig, file of the base clip, the clip.
const RIGS: [(&str, &str, &str); 6] = [
    ("m2m_human_base_animations.glb", "m2m_human_base_animations.glb", "Idle_Loop"),
    ("gdquest_mannequiny.glb", "gdquest_mannequiny.glb", "fight_idle"),
    ("kaykit_Knight.glb", "kaykit_Knight.glb", "Idle"),
    ("m2m_human_male.glb", "m2m_human_base_animations.glb", "Sword_Idle"),
    ("godette_vrm0.vrm", "m2m_human_base_animations.glb", "Idle_Loop"),
    ("vrm1_debug_robot.vrm", "m2m_human_base_animations.glb", "Pistol_Idle_Loop"),
];
const IMPULSES: [f64; 4] = [25.0, 50.0, 75.0, 100.0];

fn main() {
    let folder = std::env::var_os("SUREFOOT_DATA").map(PathBuf::from);
    let folder =
        folder.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data")).join("rigs");
    if !folder.is_dir() {
        println!("skipped: no third-party rigs in {}", folder.display());
        return;
    }
    println!(
        "{:<34}{:>6}{:>6}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>7}{:>10}{:>8}",
        "% of clips that hold",
        "clips",
        "fell",
        "zmp>95",
        "out<3",
        "out<10",
        "mu<.6",
        "vert>.2",
        "res<.7",
        "mom<1.2",
        "slip<2",
        "score",
        "ends deg",
        "mm"
    );
    for (rig, file, clip) in RIGS {
        let rig_file = folder.join(rig);
        let Ok(loaded) = load(&rig_file) else {
            println!("{rig}: does not load");
            continue;
        };
        for over in [false, true] {
            let runs: Vec<(f64, f64)> =
                (0..8).flat_map(|way| IMPULSES.map(|impulse| (f64::from(way) * 45.0, impulse))).collect();
            let made = base_of(&loaded, &folder.join(file), clip, rig == file);
            let base = match made {
                Ok(base) => Arc::new(base),
                Err(error) => {
                    println!("{rig} {clip}: {error}");
                    continue;
                }
            };
            let reports: Vec<ClipReport> = runs
                .par_iter()
                .filter_map(|(way, impulse)| {
                    let options = BakeOptions { base: over.then(|| base.clone()), ..BakeOptions::default() };
                    bake(&loaded, &shove(&loaded, clip, *way, *impulse, over), &options).ok().map(|baked| baked.report)
                })
                .collect();
            row(&format!("{} {}", rig.split('.').next().unwrap_or(rig), if over { clip } else { "-" }), &reports);
        }
    }
}

fn base_of(rig: &Rig, file: &std::path::Path, clip: &str, own: bool) -> Result<Base, String> {
    let clips = mocap::load(file).map_err(|error| error.to_string())?;
    let index = clips.find(clip).map_err(|error| error.to_string())?;
    let reading = clips.reading(index, &mocap::Options::default()).map_err(|error| error.to_string())?;
    prepare(rig, &Scenario::default(), &reading, own.then_some(index)).map_err(|error| error.to_string())
}

fn shove(rig: &Rig, clip: &str, way: f64, impulse: f64, over: bool) -> Scenario {
    let scale = rig.body.mass / 89.5 * (rig.body.leg_length / 0.83).sqrt();
    let push = Push {
        start: 0.6,
        duration: 0.2,
        force: impulse * scale / 0.2,
        toward: Direction::Heading(way.to_radians()),
        at: Role::Chest,
    };
    let base = over.then(|| scenario::Base { clip: Some(clip.into()), file: None });
    Scenario { title: "shove".into(), duration: 5.0, push: vec![push], base, ..Scenario::default() }
}

fn row(name: &str, reports: &[ClipReport]) {
    let stands: Vec<&ClipReport> = reports.iter().filter(|report| report.outcome != Outcome::Fall).collect();
    let count = stands.len().max(1) as f64;
    let share = |holds: &dyn Fn(&ClipReport) -> bool| {
        100.0 * stands.iter().filter(|report| holds(report)).count() as f64 / count
    };
    let of = |pick: &dyn Fn(&ClipReport) -> f64| stands.iter().map(|report| pick(report)).fold(0.0, f64::max);
    let ends =
        |pick: fn(&surefoot::model::report::BaseReport) -> f64| of(&|report| report.base.as_ref().map_or(0.0, pick));
    println!(
        "{name:<34}{:>6}{:>6}{:>8.0}{:>8.0}{:>8.0}{:>8.0}{:>8.0}{:>8.0}{:>8.0}{:>8.0}{:>7.2}{:>10.3}{:>8.2}",
        reports.len(),
        reports.len() - stands.len(),
        share(&|report| report.plausibility.zmp_inside >= 0.95),
        share(&|report| report.plausibility.zmp_outside_p95_cm <= 3.0),
        share(&|report| report.plausibility.zmp_outside_p95_cm <= 10.0),
        share(&|report| report.plausibility.friction_p99 < 0.6),
        share(&|report| report.plausibility.vertical_min > 0.2),
        share(&|report| report.plausibility.residual_force <= 0.007),
        share(&|report| report.plausibility.residual_moment <= 0.012),
        share(&|report| report.plausibility.slip_max_mm <= 2.0),
        stands.iter().map(|report| report.plausibility.score).sum::<f64>() / count,
        ends(|base| base.first_deg.max(base.last_deg)),
        ends(|base| base.first_mm.max(base.last_mm)),
    );
}
