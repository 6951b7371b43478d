//! `surefoot correct`: a clip file to a corrected one beside it, with what was found before and after.
//!
//! BVH stays BVH, glTF, VRM and VRMA keep their document, FBX becomes a GLB. Every clip of the file is corrected, or the one that is named.
//! What was written is read back and compared with what was meant.

use super::args::CorrectArgs;
use super::exit_code::{Exit, Failure};
use super::writer::{self, Output};
use super::{audit_text, resolve, say, tell};
use crate::audit::AuditOptions;
use crate::correct::{CorrectOptions, Corrected, correct, locals, told};
use crate::export::{Amended, amend};
use crate::mocap::{self, ClipFile, Kind, Options, Reading, bvh, bvh_write};
use crate::model::findings::{Findings, Rule};
use crate::rig::Document;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// m: what is written may be off by so much before it is told.
const EXACT: f64 = 0.001;

/// A clip that was corrected.
struct Clip {
    index: usize,
    reading: Reading,
    corrected: Corrected,
    amended: Amended,
}

/// Corrects.
pub fn run(args: &CorrectArgs) -> Result<Exit, Failure> {
    let inputs = vec![args.clip_file.clone(), args.clip_file.with_extension("bones.toml")];
    let json_file = args.json.as_ref().filter(|path| path.as_os_str() != "-");
    let mut outputs: Vec<&Path> = vec![&args.output];
    outputs.extend(json_file.map(PathBuf::as_path));
    writer::check(&outputs, &inputs)?;
    resolve::plain_file(&args.clip_file, "a clip is a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")?;
    let bad = |error: mocap::MocapError| Failure::bad_input(error.to_string());
    let file = mocap::load(&args.clip_file).map_err(bad)?;
    check_ending(&args.output, file.kind)?;
    let options = Options { fps: args.fps, up: args.up.as_deref().and_then(mocap::up_axis), unit: args.unit };
    // An FBX is judged as what will be written.
    let (file, source) = match file.fbx_to_glb(&options) {
        Some(made) => {
            let bytes = made.map_err(bad)?;
            let name = args.clip_file.with_extension("glb").display().to_string();
            let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
            (mocap::read(&name, &bytes, &alone, None).map_err(bad)?, bytes)
        }
        None => {
            let read = std::fs::read(&args.clip_file);
            let bytes = read.map_err(|error| {
                Failure::bad_input(format!("{}: cannot be read: {error}", args.clip_file.display()))
            })?;
            (file, bytes)
        }
    };
    // What FBX was turned into is in metres and Y up.
    let options = if file.bvh().is_none() && inputs_are_fbx(&args.clip_file) {
        Options { fps: args.fps, ..Options::default() }
    } else {
        options
    };
    let wanted: Vec<usize> = match &args.clip {
        Some(name) => vec![file.find(name).map_err(bad)?],
        None => (0..file.clips.len()).collect(),
    };
    let (clips, unread) = correct_all(args, &file, &wanted, &options)?;
    let bytes = written(&file, &source, &clips, &args.output, &options)?;
    let mut shown: Vec<Value> = Vec::new();
    let mut text = String::new();
    for clip in &clips {
        let off = check_back(&args.output, &bytes, clip, &options);
        text.push_str(&told(clip, off));
        shown.push(as_json(clip)?);
    }
    for failure in &unread {
        tell(&audit_text::plain(&format!("warning: {failure}")));
    }
    let several = args.clip.is_none() && file.clips.len() > 1;
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

fn inputs_are_fbx(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("fbx"))
}

/// The name that is written must say what it will be.
fn check_ending(output: &Path, kind: Kind) -> Result<(), Failure> {
    let ending = output.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let (may, what): (&[&str], &str) = match kind {
        Kind::Bvh => (&["bvh"], "a BVH clip is corrected as BVH"),
        Kind::Fbx => (&["glb"], "an FBX clip is corrected as GLB"),
        Kind::Gltf => (&["glb"], "a glTF clip is corrected as GLB"),
        Kind::Vrm => (&["vrm", "glb"], "a VRM stays one"),
        Kind::Vrma => (&["vrma", "glb"], "a VRM animation stays one"),
    };
    if may.contains(&ending.as_str()) {
        return Ok(());
    }
    Err(Failure::bad_input(format!("{}: {what}\n  help: let the name behind -o end in .{}", output.display(), may[0])))
}

/// Every clip that is wanted; of several, those that cannot be read are told.
fn correct_all(
    args: &CorrectArgs,
    file: &ClipFile,
    wanted: &[usize],
    options: &Options,
) -> Result<(Vec<Clip>, Vec<String>), Failure> {
    let settings = CorrectOptions {
        audit: AuditOptions { floor: args.floor, ..AuditOptions::default() },
        only: args.rules.clone(),
        retime: args.retime,
    };
    let (mut clips, mut unread) = (Vec::new(), Vec::new());
    for index in wanted.iter().copied() {
        let reading = match file.reading(index, options) {
            Ok(reading) => reading,
            Err(error) if wanted.len() > 1 => {
                unread.push(format!("{error} (clip {:?}: left as it is)", file.clips[index]));
                continue;
            }
            Err(error) => return Err(Failure::bad_input(error.to_string())),
        };
        let Some(source) = locals::Source::of(file, index, &reading) else {
            return Err(Failure::failed(format!("{}: its tracks cannot be read again", file.file)));
        };
        let corrected = correct(&reading.capture, &settings);
        let edits = locals::edits(&reading, &source, &corrected);
        let (start, fps, speed) = (reading.start, reading.capture.fps, corrected.speed);
        let amended = Amended { animation: index, start, fps, edits, speed, extras: None };
        clips.push(Clip { index, reading, corrected, amended });
    }
    if clips.is_empty() {
        return Err(Failure::bad_input(unread.join("\n")));
    }
    Ok((clips, unread))
}

/// The bytes of the corrected file.
fn written(
    file: &ClipFile,
    source: &[u8],
    clips: &[Clip],
    output: &Path,
    options: &Options,
) -> Result<Vec<u8>, Failure> {
    let untouched = clips.iter().all(|clip| clip.amended.edits.is_empty() && clip.amended.speed == 1.0);
    let gltf_text = source.first() != Some(&b'g');
    if let (Some(parsed), Some(clip)) = (file.bvh(), clips.first()) {
        if untouched {
            return Ok(source.to_vec());
        }
        let text = bvh::decode(source);
        let edited = bvh_write::write(&text, parsed, &clip.amended.edits);
        let edited = if clip.amended.speed == 1.0 { edited } else { faster(&edited, 1.0 / clip.corrected.capture.fps) };
        return Ok(edited.into_bytes());
    }
    if untouched && !gltf_text {
        return Ok(source.to_vec());
    }
    let (Some(document), Some(nodes)) = (file.document(), file.nodes()) else {
        return Err(Failure::failed(format!("{}: this kind of file cannot be written", output.display())));
    };
    let mut amended: Vec<Amended> = clips.iter().map(|clip| clip.amended.clone()).collect();
    let failed = |error: crate::export::ExportError| Failure::failed(error.to_string());
    let bytes = amend(document, nodes, &amended).map_err(failed)?;
    // A clip that was baked here tells of itself as the written keys are.
    let said: Vec<Option<Value>> =
        clips.iter().map(|clip| told_again(document, clip, output, &bytes, options)).collect();
    if said.iter().all(Option::is_none) {
        return Ok(bytes);
    }
    for (amended, said) in amended.iter_mut().zip(said) {
        amended.extras = said;
    }
    amend(document, nodes, &amended).map_err(failed)
}

/// What a clip tells from now on; `None` where it told nothing or nothing was changed.
fn told_again(document: &Document, clip: &Clip, output: &Path, bytes: &[u8], options: &Options) -> Option<Value> {
    if clip.amended.edits.is_empty() && clip.amended.speed == 1.0 {
        return None;
    }
    let said = document.list("animations").get(clip.index)?.pointer("/extras/surefoot")?;
    let dense = Options {
        unit: options.unit.or(Some(clip.reading.capture.units_to_metres)),
        fps: Some(clip.corrected.capture.fps * told::PER_FRAME as f64),
        ..options.clone()
    };
    let written = locals::read_back(&output.display().to_string(), bytes, clip.index, &dense)?;
    told::again(said, &clip.reading, &clip.corrected, &written)
}

/// The text with another frame time.
fn faster(text: &str, frame_time: f64) -> String {
    let Some(at) = text.to_ascii_lowercase().find("frame time:") else { return text.to_owned() };
    let rest = &text[at + "frame time:".len()..];
    let skipped = rest.len() - rest.trim_start().len();
    let number = rest.split_whitespace().next().map_or(0, str::len);
    let start = at + "frame time:".len() + skipped;
    format!("{}{frame_time:.9}{}", &text[..start], &text[start + number..])
}

/// m: how far the written clip is from what was meant, frame by frame at its rate; `None` where it cannot be read again.
fn check_back(output: &Path, bytes: &[u8], clip: &Clip, options: &Options) -> Option<f64> {
    let unit = options.unit.or(Some(clip.reading.capture.units_to_metres));
    let options = Options { unit, fps: Some(clip.corrected.capture.fps), ..options.clone() };
    let back = locals::read_back(&output.display().to_string(), bytes, clip.index, &options)?;
    Some(locals::written_off_by(&clip.corrected.capture, &back))
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
        text.push_str("  no flags: nothing to correct\n");
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

#[cfg(test)]
mod tests {
    use super::faster;

    #[test]
    fn only_the_frame_time_becomes_another() {
        let text = "MOTION\nFrames: 2\nFrame Time:\t0.04\r\n1 2 3\n";
        assert_eq!(faster(text, 0.02), "MOTION\nFrames: 2\nFrame Time:\t0.020000000\r\n1 2 3\n");
        assert_eq!(faster("no motion", 0.02), "no motion");
    }
}
