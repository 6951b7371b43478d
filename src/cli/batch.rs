//! `surefoot batch`: a sweep to clips side by side. All that can be wrong is told before anything runs; what is done is kept.
//!
//! Exit 0: every variation has its clip (falls are results). 2: the sweep, a scenario or a rig is wrong; nothing ran. 3: some
//! variation failed, or the work was stopped by the disk or an interrupt; the same command goes on.

use super::args::{BatchArgs, Root};
use super::batch_out::{self, Results};
use super::{interrupt, say, tell, travel};
use crate::batch::run::{Ended, Place, Wanted, engines, run as bake_all};
use crate::batch::{Plan, Variation, plan};
use crate::disk::folder::{Folder, RigFile, rig_file};
use crate::disk::resolve;
use crate::disk::{Exit, Failure};
use crate::rig::Rig;
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Core seconds that a second of motion takes on an ordinary machine, by drive; rough.
const EFFORT: [(&str, f64); 3] = [("stepper", 0.035), ("ragdoll", 0.11), ("auto", 0.15)];
/// Bytes that a second of motion adds to a file at 30 fps; rough.
const BYTES_A_SECOND: f64 = 14e3;
/// Bytes of a record with its small picture; rough.
const RECORD_BYTES: f64 = 65e3;
/// Failures that are told one by one.
const MOST_TOLD: usize = 10;

/// Bakes a sweep, or lists it, or writes a farm's job for it.
pub fn run(args: &BatchArgs) -> Result<Exit, Failure> {
    let (mut plan, scenarios) = planned(&args.sweep)?;
    plan.sweep.bake.only_animation |= args.only_animation;
    for note in &plan.notes {
        tell(&format!("warning: {}: {note}", args.sweep.display()));
    }
    check_flags(args, &plan)?;
    for engine in engines(&plan.sweep.bake).filter(|engine| !engine.takes(plan.sweep.bake.root)) {
        tell(&format!("warning: {} takes root motion from {}", engine.title, engine.root));
    }
    let (rigs, first) = rigs(&plan, &args.sweep)?;
    let jobs = args.jobs.map_or_else(|| std::thread::available_parallelism().map_or(1, usize::from), usize::from);
    if args.dry_run {
        return listed(&plan, &rigs, jobs, args.json).map(|()| Exit::Done);
    }
    let output = args.output.as_deref().unwrap_or(Path::new("."));
    if args.openjd.is_some() || args.slurm.is_some() {
        return super::batch_farm::write(args, &plan, &rigs, &scenarios, output);
    }
    let range = match args.only {
        None => 0..plan.variations.len(),
        Some((from, to)) if from <= plan.variations.len() => from - 1..to.min(plan.variations.len()),
        Some((from, _)) => {
            let count = plan.variations.len();
            return Err(Failure::bad_input(format!(
                "--only {from}: the sweep has {count} variations\n  help: give 1-{count}"
            )));
        }
    };
    let wanted = Wanted { cells: !args.no_sheet, pieces: args.merge };
    let folder = Folder::open(&plan, rigs, scenarios, output, (wanted, args.force), vec![args.sweep.clone()])?;
    folder.hold(0, first);
    check_bases(&plan, &folder)?;
    interrupt::hint("; whole clips are kept, and the same command goes on from here");
    let open: Vec<&Variation> = plan.variations[range.clone()].iter().filter(|one| !folder.is_done(one)).collect();
    let kept = range.len() - open.len();
    room(&plan, &folder, &open, output)?;
    if !open.is_empty() {
        let been = if kept > 0 { format!(" ({kept} of {} are done already)", range.len()) } else { String::new() };
        tell(&format!("baking {}{been}", estimate(&plan, folder.rigs(), &open, jobs)));
    }
    let bar = progress(open.len());
    let (endings, stopped) = bake_all(&plan, range.clone(), jobs, wanted, &folder, &|variation, ended| match ended {
        Ended::Done(_, true) => {}
        Ended::Failed(why) => {
            bar.suspend(|| tell(&format!("failed: {} on {}: {why}", variation.name, plan.rig_name(variation))));
            bar.inc(1);
        }
        _ => bar.inc(1),
    });
    bar.finish_and_clear();
    let failed = endings.iter().filter(|ended| matches!(ended, Ended::Failed(_))).count();
    let results = Results { plan: &plan, folder: &folder, args, output, range, endings: &endings };
    if let Some(stopped) = stopped {
        let done = endings.iter().filter(|ended| matches!(ended, Ended::Done(..))).count();
        return Err(Failure::failed(format!(
            "stopped with {done} of {} clips done: {}\n  help: then run the same command: it goes on from there",
            endings.len(),
            stopped.0
        )));
    }
    match args.only {
        Some(_) => say(&batch_out::chunk(&results))?,
        None => batch_out::finish(&results)?,
    }
    if failed > 0 {
        let told = failed.min(MOST_TOLD);
        let first: Vec<String> = failures(&plan, &results).take(told).collect();
        let more = if failed > told {
            format!("\n  ... and {} more: see `error` in manifest.csv", failed - told)
        } else {
            String::new()
        };
        let what =
            format!("{failed} of {} variations failed; the rest is done\n{}{more}", endings.len(), first.join("\n"));
        if !args.tolerant {
            return Err(Failure::failed(what));
        }
        tell(&format!("warning: {what}"));
    }
    Ok(Exit::Done)
}

fn failures<'a>(plan: &'a Plan, results: &'a Results) -> impl Iterator<Item = String> + 'a {
    let all = plan.variations[results.range.clone()].iter().zip(results.endings);
    all.filter_map(|(variation, ended)| match ended {
        Ended::Failed(why) => {
            let why = why.lines().next().unwrap_or_default();
            Some(format!("  {} {} on {}: {why}", variation.number, variation.name, plan.rig_name(variation)))
        }
        _ => None,
    })
}

/// Reads the sweep and its scenarios and makes the plan.
fn planned(path: &Path) -> Result<(Plan, Vec<PathBuf>), Failure> {
    let (sweep, source) = resolve::sweep(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut texts = Vec::new();
    let mut files = Vec::new();
    for input in &sweep.scenarios {
        let file = folder.join(&input.file);
        texts.push((file.display().to_string(), resolve::scenario_text(&file)?.1));
        files.push(file);
    }
    let plan = plan(sweep, &texts).map_err(|faults| resolve::faulty(source.errors(&faults)))?;
    Ok((plan, files))
}

fn check_flags(args: &BatchArgs, plan: &Plan) -> Result<(), Failure> {
    let bake = &plan.sweep.bake;
    let wrong = match (args.merge, bake.format.without_props(), bake.props) {
        (true, Some(what), _) => format!("{what} holds one clip: leave --merge away, or `format` in [bake]"),
        (true, _, true) => "props belong to one clip each: leave --merge away, or `props` in [bake]".to_owned(),
        (_, Some(what), true) => format!("{what} holds no meshes, so no props: leave one of them away in [bake]"),
        (_, _, true) if bake.only_animation => {
            "props are meshes: leave them or `only_animation` away in [bake]".to_owned()
        }
        _ => return Ok(()),
    };
    Err(Failure::bad_input(format!("{}: {wrong}", args.sweep.display())))
}

/// Every rig loaded once, for what is wrong with it; the first is given back loaded.
fn rigs(plan: &Plan, sweep: &Path) -> Result<(Vec<RigFile>, Rig), Failure> {
    let folder = sweep.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    let mut first = None;
    for input in &plan.sweep.rigs {
        let path = if input.file == "builtin" { PathBuf::from("builtin") } else { folder.join(&input.file) };
        let (file, rig) = rig_file(&path)?;
        let bake = &plan.sweep.bake;
        let engines: Vec<_> = engines(bake).collect();
        let root = if bake.root == "root" { Root::Root } else { Root::Hips };
        let (_, why) = travel::chosen(&rig, Some(root), &engines, bake.only_animation);
        for warning in rig.mapping.warnings.iter().chain(&why) {
            tell(&format!("warning: {}: {warning}", path.display()));
        }
        files.push(file);
        first.get_or_insert(rig);
    }
    let first = first.ok_or_else(|| Failure::bad_input("the sweep names no rig"))?;
    Ok((files, first))
}

/// Base clips of every rig and grounds of every scenario, by the first variation of each.
fn check_bases(plan: &Plan, folder: &Folder) -> Result<(), Failure> {
    let mut seen = BTreeSet::new();
    for variation in plan.variations.iter().filter(|variation| seen.insert((variation.rig, variation.scenario))) {
        let mut scenario = plan.scenario(variation).map_err(Failure::bad_input)?;
        let told =
            |what: String| Failure::bad_input(format!("variation {} ({}): {what}", variation.number, variation.name));
        folder.lay(variation, &mut scenario).map_err(told)?;
        if scenario.base.is_some() {
            let rig = folder.rig(variation.rig).map_err(Failure::bad_input)?;
            folder.base(variation, &rig, &scenario).map_err(told)?;
        }
    }
    Ok(())
}

/// What those variations take: (core seconds, bytes).
fn effort(plan: &Plan, rigs: &[RigFile], open: &[&Variation]) -> (f64, f64) {
    let bake = &plan.sweep.bake;
    let each = plan.seconds / plan.variations.len().max(1) as f64;
    let rate = EFFORT.iter().find(|(drive, _)| *drive == bake.drive).map_or(0.1, |(_, rate)| *rate);
    let keys = each * BYTES_A_SECOND * bake.fps / 30.0;
    let bytes = open
        .iter()
        .map(|one| {
            let alone = bake.only_animation || bake.format != crate::model::FileKind::Glb;
            RECORD_BYTES + keys + if alone { 0.0 } else { rigs[one.rig].size as f64 }
        })
        .sum();
    (open.len() as f64 * (0.03 + each * rate), bytes)
}

fn estimate(plan: &Plan, rigs: &[RigFile], open: &[&Variation], jobs: usize) -> String {
    let (seconds, bytes) = effort(plan, rigs, open);
    let time = std::time::Duration::from_secs((seconds / jobs as f64).ceil() as u64);
    let clips = if open.len() == 1 { "1 clip".to_owned() } else { format!("{} clips", open.len()) };
    format!(
        "{clips}: about {} with {jobs} at once, and {}",
        indicatif::HumanDuration(time),
        batch_out::bytes(bytes as u64)
    )
}

/// Refuses to start what the disk cannot hold.
fn room(plan: &Plan, folder: &Folder, open: &[&Variation], output: &Path) -> Result<(), Failure> {
    let needed = effort(plan, folder.rigs(), open).1 as u64;
    match fs4::available_space(output) {
        Ok(free) if free < needed => Err(Failure::failed(format!(
            "{}: about {} are needed, {} are free\n  help: make room, or write to another disk",
            output.display(),
            batch_out::bytes(needed),
            batch_out::bytes(free)
        ))),
        _ => Ok(()),
    }
}

fn progress(count: usize) -> ProgressBar {
    let bar = if count > 1 { ProgressBar::new(count as u64) } else { ProgressBar::hidden() };
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len} clips, {per_sec}, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// `--dry-run`.
fn listed(plan: &Plan, rigs: &[RigFile], jobs: usize, json: bool) -> Result<(), Failure> {
    let all: Vec<&Variation> = plan.variations.iter().collect();
    if json {
        let (seconds, bytes) = effort(plan, rigs, &all);
        let one = |variation: &&Variation| {
            let chosen = plan.paths().into_iter().map(str::to_owned).zip(&variation.choices);
            let parameters: serde_json::Map<String, serde_json::Value> =
                chosen.map(|(path, choice)| (path, serde_json::to_value(&choice.value).unwrap_or_default())).collect();
            serde_json::json!({ "number": variation.number, "name": variation.name, "rig": plan.rig_name(variation), "parameters": parameters })
        };
        let clips: Vec<serde_json::Value> = all.iter().map(one).collect();
        let about = serde_json::json!({ "core_seconds": seconds.round(), "bytes": bytes.round(), "clips": clips });
        return say(&format!("{about}\n"));
    }
    let mut text = String::new();
    for variation in &all {
        let chosen = plan.paths().into_iter().zip(&variation.choices);
        let values: Vec<String> = chosen.map(|(path, choice)| format!("{path} = {}", choice.value)).collect();
        text += &format!(
            "{:5}  {}/{}  {}\n",
            variation.number,
            plan.rig_name(variation),
            variation.name,
            values.join(", ")
        );
    }
    text += &format!("{}\n", estimate(plan, rigs, &all, jobs));
    say(&text)
}
