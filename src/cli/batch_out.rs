//! What a batch leaves when all is done: merged files, the manifest, the pictures; and what it says of them.

use super::args::BatchArgs;
use super::say;
use crate::batch::merged::{self, MOST_CLIPS};
use crate::batch::run::{Ended, Place, form};
use crate::batch::{Plan, Variation};
use crate::disk::Failure;
use crate::disk::batch_results;
use crate::disk::folder::Folder;
use crate::disk::writer::Output;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A batch that ran.
pub struct Results<'a> {
    /// Its plan.
    pub plan: &'a Plan,
    /// Its folder.
    pub folder: &'a Folder<'a>,
    /// How it was asked for.
    pub args: &'a BatchArgs,
    /// The folder's path.
    pub output: &'a Path,
    /// Which variations ran.
    pub range: Range<usize>,
    /// How each ended.
    pub endings: &'a [Ended],
}

/// A chunk's last words.
pub fn chunk(results: &Results) -> String {
    let done = results.endings.iter().filter(|ended| matches!(ended, Ended::Done(..))).count();
    format!(
        "chunk      {} to {} of {}: {done} clips are in {}\n           without --only the same command makes manifest and pictures\n",
        results.range.start + 1,
        results.range.end,
        results.plan.variations.len(),
        results.output.display()
    )
}

/// Merged files, manifest and pictures.
pub fn finish(results: &Results) -> Result<(), Failure> {
    let mut places = Vec::new();
    if results.args.merge {
        places.push(("merged", merge(results)?));
    }
    if results.args.scenarios {
        places.push(("scenarios", scenarios(results)?));
    }
    let left = left(results);
    let helpers = left.helpers(results.args.merge)?;
    if !helpers.is_empty() {
        places.push(("helpers", helpers));
    }
    let alike = left.alike();
    let (manifest, tables) = left.manifest(&alike, results.args.merge)?;
    places.push(("manifest", tables));
    if !results.args.no_sheet {
        places.push(("sheet", left.sheet(&alike)?));
    }
    places.push(("coverage", left.coverage(&alike)?));
    if results.args.json {
        let mut object = manifest;
        object["output"] = results.output.display().to_string().into();
        return say(&format!("{object}\n"));
    }
    say(&summary(results, &alike, &places))
}

/// One file a rig, or several where there are very many clips.
fn merge(results: &Results) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    for (rig, input) in results.plan.sweep.rigs.iter().enumerate() {
        let of_rig = |one: &&Variation| one.rig == rig && results.folder.is_done(one);
        let clips: Vec<&Variation> = results.plan.variations.iter().filter(of_rig).collect();
        for (part, clips) in clips.chunks(MOST_CLIPS).enumerate() {
            let records = clips.iter().filter_map(|one| results.folder.record(one)).filter_map(|record| record.piece);
            let loaded = results.folder.rig(rig).map_err(Failure::failed)?;
            let merged = merged::merged(&loaded, records, form(&results.plan.sweep.bake))
                .map_err(|error| Failure::failed(error.to_string()))?;
            let name = merged::file_name(&input.name, part);
            let outputs = vec![
                Output { path: results.output.join(format!("{name}.glb")), bytes: merged.file },
                Output { path: results.output.join(format!("{name}.events.json")), bytes: merged.events },
            ];
            let paths = put(results, outputs)?;
            written.extend(paths.into_iter().take(1));
        }
    }
    Ok(written)
}

/// The scenario of each variation, in one folder.
fn scenarios(results: &Results) -> Result<Vec<PathBuf>, Failure> {
    let folder = results.output.join("scenarios");
    for variation in &results.plan.variations {
        let path = folder.join(format!("{}_{}.toml", results.plan.rig_name(variation), variation.name));
        put(results, vec![Output { path, bytes: results.plan.scenario_text(variation).into_bytes() }])?;
    }
    Ok(vec![folder])
}

fn put(results: &Results, outputs: Vec<Output>) -> Result<Vec<PathBuf>, Failure> {
    left(results).put(outputs)
}

fn left<'a>(results: &Results<'a>) -> batch_results::Results<'a> {
    let Results { plan, folder, output, endings, .. } = *results;
    batch_results::Results { plan, folder, output, endings }
}

fn summary(results: &Results, alike: &[Option<usize>], places: &[(&str, Vec<PathBuf>)]) -> String {
    let mut counts: Vec<(&str, usize)> = ["still", "sway", "step", "fall", "failed"].map(|word| (word, 0)).to_vec();
    let mut kept = 0;
    for ended in results.endings {
        let word = match ended {
            Ended::Done(measured, before) => {
                kept += usize::from(*before);
                measured.outcome.as_str()
            }
            Ended::Failed(_) | Ended::NotRun => "failed",
        };
        counts.iter_mut().filter(|(known, _)| *known == word).for_each(|(_, count)| *count += 1);
    }
    let told: Vec<String> =
        counts.iter().filter(|(_, count)| *count > 0).map(|(word, count)| format!("{count} {word}")).collect();
    let mut text = String::new();
    let mut line = |label: &str, what: String| text += &format!("{label:<11}{what}\n");
    line(
        "baked",
        format!("{} variations into {}: {}", results.endings.len(), results.output.display(), told.join(", ")),
    );
    if kept > 0 {
        line("kept", format!("{kept} were there already"));
    }
    let similar = alike.iter().flatten().count();
    if similar > 0 {
        line("similar", format!("{similar} move almost as an earlier one does: see `similar_to` in the manifest"));
    }
    for (label, paths) in places {
        for (index, path) in paths.iter().enumerate() {
            line(if index == 0 { label } else { "" }, path.display().to_string());
        }
    }
    text
}

/// A size for a person.
pub fn bytes(size: u64) -> String {
    indicatif::DecimalBytes(size).to_string()
}
