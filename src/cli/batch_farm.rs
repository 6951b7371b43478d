//! `surefoot batch --openjd DIR` and `--slurm DIR`: jobs for render farms.

use super::args::BatchArgs;
use super::tell;
use crate::batch::farm::{FarmFile, FarmJob};
use crate::batch::{Plan, openjd, slurm};
use crate::disk::folder::RigFile;
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::disk::{level, resolve};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Core seconds that a second of motion takes at most on an ordinary machine.
const EFFORT: f64 = 0.15;

/// Writes the job's files.
pub fn write(
    args: &BatchArgs,
    plan: &Plan,
    rigs: &[RigFile],
    scenarios: &[PathBuf],
    output: &Path,
) -> Result<Exit, Failure> {
    let inputs = inputs(args, plan, rigs, scenarios)?;
    let (count, chunk) = (plan.variations.len(), args.chunk as usize);
    let flags = [("--merge", args.merge), ("--no-sheet", args.no_sheet), ("--scenarios", args.scenarios)];
    let stem = args.sweep.file_stem().map_or_else(|| "sweep".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let mut job = FarmJob {
        name: format!("surefoot {stem}"),
        count,
        chunk,
        sweep: text(&args.sweep)?,
        inputs: inputs.iter().map(|path| text(path)).collect::<Result<_, _>>()?,
        output: text(output)?,
        program: "surefoot".to_owned(),
        flags: flags.iter().filter(|(_, given)| *given).map(|(flag, _)| (*flag).to_owned()).collect(),
        core_minutes: plan.seconds * EFFORT / 60.0 * chunk.min(count) as f64 / count.max(1) as f64,
    };
    if let Some(folder) = &args.openjd {
        place(folder, openjd::bundle(&job), &inputs)?;
        tell(&format!(
            "wrote {}: {count} variations in {} chunks; check it with `openjd check {}`",
            folder.display(),
            job.chunk_count(),
            folder.join("template.json").display()
        ));
    }
    if let Some(folder) = &args.slurm {
        // A cluster's nodes see the folders of who submits.
        if let Ok(program) = std::env::current_exe() {
            job.program = text(&program)?;
        }
        place(folder, slurm::scripts(&job), &inputs)?;
        tell(&format!("wrote {}: submit it with {}", folder.display(), folder.join("submit.sh").display()));
    }
    Ok(Exit::Done)
}

/// Every file that the batch reads but the sweep, each once.
fn inputs(args: &BatchArgs, plan: &Plan, rigs: &[RigFile], scenarios: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut inputs: BTreeSet<PathBuf> = scenarios.iter().cloned().collect();
    inputs.extend(rigs.iter().flat_map(|rig| rig.files.iter().cloned()));
    for variation in &plan.variations {
        let mut scenario = plan.scenario(variation).map_err(Failure::bad_input)?;
        let file = &scenarios[variation.scenario];
        if level::level_file(&scenario, Some(file)).is_some_and(|path| !inputs.contains(&path)) {
            inputs.extend(level::lay(&mut scenario, Some(file))?.into_iter().flat_map(|level| level.files));
        }
        inputs.extend(resolve::base_file(&scenario, Some(file), &rigs[variation.rig].path)?);
    }
    inputs.remove(&args.sweep);
    inputs.retain(|path| path.is_file());
    Ok(inputs.into_iter().collect())
}

/// An absolute path as text: a farm's files are UTF-8.
fn text(path: &Path) -> Result<String, Failure> {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    whole.to_str().map(str::to_owned).ok_or_else(|| {
        Failure::bad_input(format!("{}: a farm's files are UTF-8, this name is not\n  help: rename it", path.display()))
    })
}

fn place(folder: &Path, files: Vec<FarmFile>, inputs: &[PathBuf]) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::failed(format!("{}: {error}", folder.display()));
    fs::create_dir_all(folder).map_err(failed)?;
    let scripts: Vec<PathBuf> = files.iter().filter(|file| file.script).map(|file| folder.join(file.name)).collect();
    let outputs: Vec<Output> =
        files.into_iter().map(|file| Output { path: folder.join(file.name), bytes: file.bytes }).collect();
    writer::write(&outputs, inputs)?;
    scripts.iter().try_for_each(|script| executable(script)).map_err(failed)
}

/// Makes a script one to run.
#[cfg(unix)]
fn executable(script: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let mut permissions = fs::metadata(script)?.permissions();
    permissions.set_mode(permissions.mode() | 0o111);
    fs::set_permissions(script, permissions)
}

#[cfg(not(unix))]
fn executable(_: &Path) -> std::io::Result<()> {
    Ok(())
}
