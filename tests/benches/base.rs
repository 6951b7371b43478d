//! The plausibility of shoves with and without a base clip: six third-party rigs x 8 directions x 4 strengths, and how far the ends are
//! from the base clip's pose. `cargo bench --bench base` prints it.
//!
//! Below them the walks: each clip as it is, held on its feet, and pushed with 40 Ns from four directions. Impulses are for 89.5 kg and a
//! 0.83 m leg, and scale with the body. Words after `--` choose walks by a part of their name and leave the shoves out, `-v` prints each
//! clip's contacts that slip and its pops.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;
use surefoot::bake::base::{gait::Gait, prepare};
use surefoot::bake::{BakeOptions, Baked, Base, bake, contacts};
use surefoot::measure::{Findings, Frame, Motion, measure};
use surefoot::mocap;
use surefoot::model::report::{ClipReport, Outcome};
use surefoot::model::scenario::{Direction, Push, Scenario};
use surefoot::model::{Role, Side, scenario};
use surefoot::rig::{Rig, load};
use surefoot::whole_body::Anatomy;

/// Rig, file of the base clip, the clip.
const RIGS: [(&str, &str, &str); 6] = [
    ("m2m_human_base_animations.glb", "m2m_human_base_animations.glb", "Idle_Loop"),
    ("gdquest_mannequiny.glb", "gdquest_mannequiny.glb", "fight_idle"),
    ("kaykit_Knight.glb", "kaykit_Knight.glb", "Idle"),
    ("m2m_human_male.glb", "m2m_human_base_animations.glb", "Sword_Idle"),
    ("godette_vrm0.vrm", "m2m_human_base_animations.glb", "Idle_Loop"),
    ("vrm1_debug_robot.vrm", "m2m_human_base_animations.glb", "Pistol_Idle_Loop"),
];
/// Rig, file of the walk, and the clip; `""` is the only one.
const WALKS: [(&str, &str, &str); 22] = [
    ("rigs/kaykit_Knight.glb", "rigs/kaykit_Knight.glb", "Walking_A"),
    ("rigs/kaykit_Knight.glb", "rigs/kaykit_Knight.glb", "Walking_B"),
    ("rigs/kaykit_Knight.glb", "rigs/kaykit_Knight.glb", "Walking_C"),
    ("rigs/kaykit_Knight.glb", "rigs/kaykit_Knight.glb", "Walking_Backwards"),
    ("rigs/m2m_human_base_animations.glb", "rigs/m2m_human_base_animations.glb", "Walk_Loop"),
    ("rigs/m2m_human_base_animations.glb", "rigs/m2m_human_base_animations.glb", "Walk_Formal_Loop"),
    ("rigs/m2m_human_base_animations.glb", "rigs/m2m_human_base_animations.glb", "Crouch_Fwd_Loop"),
    ("rigs/m2m_human_base_animations.glb", "rigs/m2m_human_base_animations.glb", "Push_Loop"),
    ("rigs/khronos_CesiumMan.gltf", "rigs/khronos_CesiumMan.gltf", ""),
    ("rigs/gdquest_mannequiny.glb", "rigs/m2m_human_base_animations.glb", "Walk_Loop"),
    ("rigs/gdquest_mannequiny.glb", "rigs/kaykit_Knight.glb", "Walking_A"),
    ("rigs/gdquest_mannequiny.glb", "clips/cmu_12_01_walk.bvh", ""),
    ("rigs/gdquest_mannequiny.glb", "clips/cmu_02_01_walk.bvh", ""),
    ("rigs/m2m_human_male.glb", "clips/pab_walk.fbx", ""),
    ("rigs/m2m_human_male.glb", "clips/makehuman_walk1.bvh", ""),
    ("rigs/m2m_human_male.glb", "clips/cmu_03_01_walk_uneven.bvh", ""),
    ("rigs/m2m_human_male.glb", "forces/rajagopal_walk.glb", ""),
    ("rigs/kaykit_Knight.glb", "rigs/kaykit_Knight.glb", "Running_A"),
    ("rigs/m2m_human_base_animations.glb", "rigs/m2m_human_base_animations.glb", "Jog_Fwd_Loop"),
    ("rigs/gdquest_mannequiny.glb", "rigs/gdquest_mannequiny.glb", "run"),
    ("rigs/m2m_human_male.glb", "clips/pab_jog.fbx", ""),
    ("rigs/m2m_human_male.glb", "clips/cmu_jumping_jacks_30hz.bvh", ""),
];
/// Degrees, the ways that a walk is pushed.
const WAYS: [f64; 4] = [0.0, 90.0, 180.0, -90.0];
/// s of a walk that is measured.
const WALKED: f64 = 8.0;
const IMPULSES: [f64; 4] = [25.0, 50.0, 75.0, 100.0];

fn main() {
    let folder = data::place();
    if !folder.is_dir() {
        println!("skipped: no third-party rigs in {}", folder.display());
        return;
    }
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    if words.is_empty() {
        stands(&folder);
    }
    walks(&folder, &words, std::env::args().any(|word| word == "-v"));
}

fn stands(folder: &Path) {
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
        let rig_file = folder.join("rigs").join(rig);
        let Ok(loaded) = load(&rig_file) else {
            println!("{rig}: does not load");
            continue;
        };
        for over in [false, true] {
            let runs: Vec<(f64, f64)> =
                (0..8).flat_map(|way| IMPULSES.map(|impulse| (f64::from(way) * 45.0, impulse))).collect();
            let made = base_of(&loaded, &folder.join("rigs").join(file), clip, rig == file);
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

/// The walks: as keyed (its travel taken from its feet), as held, and pushed.
fn walks(folder: &Path, words: &[String], verbose: bool) {
    println!(
        "\n{:<40}{:>32}{:>26}{:>62}",
        "walks", "the clip as it is", "on held feet", "pushed with 40 Ns from four directions, the worst"
    );
    println!(
        "{:<40}{:>7}{:>7}{:>6}{:>6}{:>6}{:>8}{:>6}{:>6}{:>6}{:>8}{:>6}{:>6}{:>6}{:>10}{:>6}{:>9}{:>6}{:>6}",
        "",
        "m/s",
        "zmp %",
        "slip",
        "sink",
        "pops",
        "zmp %",
        "slip",
        "sink",
        "pops",
        "zmp %",
        "slip",
        "sink",
        "pops",
        "first deg",
        "mm",
        "last deg",
        "mm",
        "back"
    );
    for (rig, file, clip) in WALKS {
        let stem =
            |path: &str| path.rsplit('/').next().and_then(|name| name.split('.').next()).unwrap_or("").to_owned();
        let name = if rig == file { clip.to_owned() } else { format!("{} {clip}", stem(file)) };
        let name = format!("{} {name}", stem(rig).split('_').nth(1).unwrap_or(""));
        if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
            continue;
        }
        match walk(folder, rig, file, clip) {
            Ok((row, lines)) => {
                println!("{name:<40}{row}");
                lines.iter().filter(|_| verbose).for_each(|line| println!("    {line}"));
            }
            Err(error) => println!("{name:<40}{error}"),
        }
    }
}

fn walk(folder: &Path, rig_file: &str, file: &str, clip: &str) -> Result<(String, Vec<String>), String> {
    let rig = load(&folder.join(rig_file)).map_err(|error| error.to_string())?;
    let base = Arc::new(base_of(&rig, &folder.join(file), clip, rig_file == file)?);
    let own = as_it_is(&rig, &base)?;
    let runs: Vec<(f64, f64)> = [(0.0, 0.0)].into_iter().chain(WAYS.map(|way| (way, 40.0))).collect();
    let baked: Result<Vec<Baked>, String> = runs
        .par_iter()
        .map(|(way, impulse)| {
            let mut scenario = shove(&rig, clip, *way, *impulse, true);
            scenario.duration = WALKED;
            scenario.push.iter_mut().for_each(|push| push.start = 2.0);
            scenario.push.retain(|push| push.force > 0.0);
            let options = BakeOptions { base: Some(base.clone()), ..BakeOptions::default() };
            bake(&rig, &scenario, &options).map_err(|error| error.to_string())
        })
        .collect();
    let baked = baked?;
    let (still, pushed) = baked.split_at(1);
    let ends = |baked: &Baked| {
        let told = baked.report.base.as_ref().expect("the clip says where it comes from");
        [told.first_deg, told.first_mm, told.last_deg, told.last_mm]
    };
    let back = |baked: &&Baked| {
        let [.., deg, mm] = ends(baked);
        baked.report.outcome != Outcome::Fall && deg < 0.5 && mm < 5.0
    };
    let worst = |baked: &[Baked]| {
        let all: Vec<[f64; 4]> = baked.iter().filter_map(|baked| baked.findings.as_ref()).map(told).collect();
        all.into_iter().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1]), a[2].max(b[2]), a[3].max(b[3])])
    };
    let show = |told: Option<[f64; 4]>| {
        told.map_or(String::new(), |[zmp, slip, sink, pops]| format!("{zmp:>8.1}{slip:>6.1}{sink:>6.1}{pops:>6.0}"))
    };
    let most = baked.iter().map(ends).fold([0.0_f64; 4], |a, b| std::array::from_fn(|at| a[at].max(b[at])));
    let lines = runs.iter().zip(&baked).flat_map(|(run, baked)| faults(*run, baked)).collect();
    let row = format!(
        "{own}{}{}{:>10.3}{:>6.2}{:>9.3}{:>6.2}{:>4}/4",
        show(worst(still)),
        show(worst(pushed)),
        most[0],
        most[1],
        most[2],
        most[3],
        pushed.iter().filter(back).count()
    );
    Ok((row, lines))
}

/// How a run ended, its contacts that slip by more than 2 mm, and its pops.
fn faults((way, impulse): (f64, f64), baked: &Baked) -> Vec<String> {
    let told = baked.report.base.as_ref().expect("the clip says where it comes from");
    let measured = &baked.report.plausibility;
    let mut lines = vec![format!(
        "{impulse} Ns towards {way}: {:?}, {} steps, ZMP {:.1} %, last {:.2} degrees and {:.2} mm off",
        baked.report.outcome,
        baked.report.steps,
        measured.zmp_inside * 100.0,
        told.last_deg,
        told.last_mm
    )];
    lines.extend(baked.warnings.iter().map(|note| format!("    {note}")));
    for contact in baked.report.contacts.iter().filter(|contact| contact.slip_mm > 2.0) {
        lines.push(format!(
            "    {:?} {:?} {:.3} to {:.3} s slips by {:.1} mm",
            contact.foot, contact.part, contact.start, contact.end, contact.slip_mm
        ));
    }
    for pop in baked.findings.iter().flat_map(|findings| &findings.joints.pops) {
        lines.push(format!(
            "    {} pops by {:.1} degrees at {:.2} s",
            pop.role.name(),
            pop.step.to_degrees(),
            pop.time
        ));
    }
    lines
}

/// ZMP inside (%), slip and sink (mm), pops.
fn told(findings: &Findings) -> [f64; 4] {
    let told = findings.plausibility();
    [told.zmp_inside * 100.0, told.slip_max_mm, told.penetration_max_mm, findings.joints.pops.len() as f64]
}

/// A walk before its feet are held, travelling as they say.
fn as_it_is(rig: &Rig, base: &Base) -> Result<String, String> {
    const HZ: f64 = 120.0;
    let anatomy = Anatomy::new(&rig.body);
    let gait = Gait::new(base, &rig.body, &anatomy, WALKED + 1.0, WALKED).map_err(|error| error.to_string())?;
    let poses: Vec<_> = (0..=(WALKED * HZ) as usize).map(|frame| gait.at(frame as f64 / HZ).pose).collect();
    let mut list = Vec::new();
    for side in Side::BOTH {
        gait.contacts(side, 0.0, WALKED, Default::default(), 0.0, &mut list);
    }
    let motion = Motion { body: &rig.body, hz: HZ, per_frame: 4, poses: &poses };
    let findings = measure(motion, &contacts::held(&list, Frame::World), &[], 1.0).ok_or("is too short")?;
    let [zmp, slip, sink, pops] = told(&findings);
    Ok(format!("{:>7.2}{zmp:>7.1}{slip:>6.0}{sink:>6.1}{pops:>6.0}", gait.velocity.length()))
}

fn base_of(rig: &Rig, file: &Path, clip: &str, own: bool) -> Result<Base, String> {
    let clips = mocap::load(file).map_err(|error| error.to_string())?;
    let index = clips.find(if clip.is_empty() { "0" } else { clip }).map_err(|error| error.to_string())?;
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
