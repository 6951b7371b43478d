//! `surefoot correct`: a clip file to a corrected one beside it, with what was found before and after.
//!
//! BVH stays BVH, glTF, VRM and VRMA keep their document, FBX becomes a GLB. Every clip of the file is corrected, or the one that is named.
//! What was written is read back and compared with what was meant.

use super::args::CorrectArgs;
use super::progress::busy;
use super::{audit_text, say, tell};
use crate::audit::AuditOptions;
use crate::correct::{CorrectOptions, Corrected};
use crate::disk::correction::{Clip, Opened};
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::export::only_animation;
use crate::mocap::{self, Options};
use crate::model::findings::{Findings, Rule};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// m: what is written may be off by so much before it is told.
const EXACT: f64 = 0.001;

/// Corrects.
pub fn run(args: &CorrectArgs) -> Result<Exit, Failure> {
    let inputs = vec![args.clip_file.clone(), args.clip_file.with_extension("bones.toml")];
    let json_file = args.json.as_ref().filter(|path| path.as_os_str() != "-");
    let mut outputs: Vec<&Path> = vec![&args.output];
    outputs.extend(json_file.map(PathBuf::as_path));
    writer::check(&outputs, &inputs)?;
    let options = Options { fps: args.fps, up: args.up.as_deref().and_then(mocap::up_axis), unit: args.unit };
    let reading = format!("reading {}", args.clip_file.display());
    let file = busy(&reading, || Opened::open(&args.clip_file, &options))?;
    file.check_ending(&args.output)?;
    if args.only_animation && has_ending(&args.output, "vrm") {
        return Err(Failure::bad_input(format!(
            "{}: a VRM file is a character with its mesh\n  help: let the name behind -o end in .glb",
            args.output.display()
        )));
    }
    let wanted: Vec<usize> = match &args.clip {
        Some(name) => vec![file.find(name)?],
        None => (0..file.clips().len()).collect(),
    };
    let (clips, unread) = correct_all(args, &file, &wanted)?;
    let mut bytes = file.bytes(&clips, &args.output)?;
    let mut shown: Vec<Value> = Vec::new();
    let mut text = String::new();
    for clip in &clips {
        let off = file.off_by(clip, &args.output, &bytes);
        text.push_str(&told(clip, off));
        shown.push(as_json(clip)?);
    }
    for failure in &unread {
        tell(&audit_text::plain(&format!("warning: {failure}")));
    }
    if args.only_animation && has_ending(&args.output, "glb") {
        bytes = only_animation(&bytes, &|_, _| true).map_err(|error| Failure::failed(error.to_string()))?;
    }
    let several = args.clip.is_none() && file.clips().len() > 1;
    let value = if several { Value::Array(shown) } else { shown.into_iter().next().unwrap_or(Value::Null) };
    let pretty =
        serde_json::to_string_pretty(&value).map_err(|error| Failure::failed(format!("writing JSON: {error}")))? + "\n";
    let mut files = vec![Output { path: args.output.clone(), bytes }];
    files.extend(json_file.map(|path| Output { path: path.clone(), bytes: pretty.clone().into_bytes() }));
    writer::write(&files, &inputs)?;
    for file in &files {
        tell(&format!("wrote {}", file.path.display()));
    }
    say(&if args.json.is_some() && json_file.is_none() { pretty } else { audit_text::plain(&text) })?;
    Ok(Exit::Done)
}

fn has_ending(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Every clip that is wanted; of several, those that cannot be read are told.
fn correct_all(args: &CorrectArgs, file: &Opened, wanted: &[usize]) -> Result<(Vec<Clip>, Vec<String>), Failure> {
    let settings = CorrectOptions {
        audit: AuditOptions { floor: args.floor, ..AuditOptions::default() },
        only: args.rules.clone(),
        retime: args.retime,
        leave: Vec::new(),
    };
    let (mut clips, mut unread) = (Vec::new(), Vec::new());
    for index in wanted.iter().copied() {
        match file.reading(index) {
            Ok(reading) => {
                let what = format!("correcting \"{}\" ({} of {})", file.clips()[index], clips.len() + 1, wanted.len());
                clips.push(busy(&what, || file.correct_reading(index, reading, &settings))?);
            }
            Err(failure) if wanted.len() > 1 => {
                unread.push(format!("{} (clip {:?}: left as it is)", failure.message, file.clips()[index]));
            }
            Err(failure) => return Err(failure),
        }
    }
    if clips.is_empty() {
        return Err(Failure::bad_input(unread.join("\n")));
    }
    Ok((clips, unread))
}

fn as_json(clip: &Clip) -> Result<Value, Failure> {
    let Corrected { before, after, done, notes, speed, .. } = &clip.corrected;
    let of = |findings: &Findings| {
        serde_json::to_value(findings).map_err(|error| Failure::failed(format!("writing JSON: {error}")))
    };
    Ok(
        json!({ "clip": before.clip, "before": of(before)?, "after": of(after)?, "changed": done, "speed": speed, "notes": notes }),
    )
}

/// Of the frames: a clip in which more are not judged is not said to be without flags.
const SILENT: f64 = 0.95;

/// One clip for people.
fn told(clip: &Clip, off: Option<f64>) -> String {
    let Corrected { before, after, done, notes, changed, speed, .. } = &clip.corrected;
    let mut text = format!("clip       {}: {} frames at {:.5} fps\n", before.clip, before.frames, before.fps);
    let rules: Vec<Rule> =
        Rule::ALL.into_iter().filter(|rule| count(before, *rule) + count(after, *rule) > 0).collect();
    for rule in &rules {
        text.push_str(&format!(
            "  {:15} before {:22} after {}\n",
            rule.name(),
            amount(before, *rule),
            amount(after, *rule)
        ));
    }
    if rules.is_empty() {
        let unjudged: usize = before.abstained.iter().map(|span| span.end + 1 - span.start).sum();
        let silent = unjudged as f64 > SILENT * before.frames as f64;
        text.push_str(if silent {
            "  not judged: nothing to correct (surefoot audit says why)\n"
        } else {
            "  no flags: nothing to correct\n"
        });
    }
    if *speed != 1.0 {
        text.push_str(&format!("  plays {speed:.2} times as fast: {:.3} fps\n", clip.corrected.capture.fps));
    }
    for done in done {
        text.push_str(&format!("  frames {}-{}: {} ({})\n", done.start, done.end, done.what, done.rule.name()));
    }
    if !done.is_empty() {
        let share = 100.0 * changed.len() as f64 / before.frames.max(1) as f64;
        text.push_str(&format!(
            "changed    {} frames of {} ({share:.0} %); every other is as it was\n",
            changed.len(),
            before.frames
        ));
    }
    if clip.corrected.slip > 0.0 {
        text.push_str(&format!(
            "slip       up to {:.1} mm in contacts that are held now\n",
            1000.0 * clip.corrected.slip
        ));
    }
    match off {
        Some(off) if off > EXACT => {
            text.push_str(&format!("note       the file's nodes show it {:.1} mm off at worst\n", 1000.0 * off));
        }
        None => text.push_str("note       what was written could not be read back as the same clip\n"),
        _ => {}
    }
    for note in notes {
        text.push_str(&format!("note       {note}\n"));
    }
    text
}

fn count(findings: &Findings, rule: Rule) -> usize {
    findings.flags.iter().filter(|flag| flag.rule == rule).count()
        + findings.clip_flags.iter().filter(|flag| flag.rule == rule).count()
}

fn amount(findings: &Findings, rule: Rule) -> String {
    let worst = findings.flags.iter().filter(|flag| flag.rule == rule).map(|flag| flag.delta_m).fold(0.0, f64::max);
    match count(findings, rule) {
        0 => "none".to_owned(),
        count if worst > 0.0 => format!("{count}, worst {:.1} cm", 100.0 * worst),
        count => count.to_string(),
    }
}
