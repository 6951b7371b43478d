//! `surefoot retarget`: a clip of another skeleton onto a rig, as one more clip in a copy of the rig's file, or as a file of its own.

use super::args::RetargetArgs;
use super::progress::busy;
use super::{say, tell, travel};
use crate::bake::RootMotion;
use crate::bake::retargeted::{RetargetOptions, Retargeted, retargeted};
use crate::disk::resolve;
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::export::{self, Form};
use crate::mocap::{self, ClipFile, Options};
use crate::model::FileKind;
use serde_json::json;
use std::path::Path;

/// Retargets.
pub fn run(args: &RetargetArgs) -> Result<Exit, Failure> {
    let mut inputs = vec![args.clip_file.clone(), args.clip_file.with_extension("bones.toml")];
    resolve::plain_file(&args.clip_file, "a clip is a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")?;
    let rig = busy(&format!("reading {}", args.rig.display()), || resolve::rig(&args.rig))?;
    inputs.extend(rig.files);
    let rig = rig.rig;
    let events = args.output.with_extension("events.json");
    writer::check(&[&args.output, &events], &inputs)?;
    let bad = |error: mocap::MocapError| Failure::bad_input(error.to_string());
    let reading = format!("reading {}", args.clip_file.display());
    let file = busy(&reading, || mocap::load(&args.clip_file)).map_err(bad)?;
    let index = wanted(&file, args.clip.as_deref())?;
    let source =
        file.capture(index, &Options { fps: None, up: args.up.as_deref().and_then(mocap::up_axis), unit: args.unit });
    let source = source.map_err(bad)?;
    let (root, why) = travel::chosen(&rig, args.root, &[], args.only_animation);
    let root = RootMotion::from(root);
    let options = RetargetOptions { name: args.name.clone(), fps: args.fps, root, curves: args.curves.into() };
    let what = format!("retargeting \"{}\" onto {}", source.name, args.rig.display());
    let Some(made) = busy(&what, || retargeted(&rig, &source, &options)) else {
        let what = format!(
            "clip \"{}\" has {} frames that can be read: a motion has two at least",
            source.name,
            source.frames()
        );
        return Err(Failure::bad_input(format!("{}: {what}", args.clip_file.display())));
    };
    let failed = |error: export::ExportError| Failure::failed(error.to_string());
    let form = Form {
        kind: FileKind::of(&args.output),
        only_animation: args.only_animation,
        no_contact_nodes: args.no_contact_nodes,
        ..Form::default()
    };
    let written = export::exported(&rig, (&made.clip, &made.report), &[], form).map_err(failed)?;
    let name = written.name;
    for warning in rig.mapping.warnings.iter().chain(&why).chain(&source.notes).chain(&written.changes) {
        tell(&format!("warning: {warning}"));
    }
    let size = written.file.len();
    writer::write(
        &[
            Output { path: args.output.clone(), bytes: written.file },
            Output { path: events.clone(), bytes: written.events },
        ],
        &inputs,
    )?;
    say(&if args.json {
        let report = export::events::report_json(&name, &made.report).unwrap_or_default();
        let object = json!({
            "output": args.output.display().to_string(),
            "events": events.display().to_string(),
            "clip": name,
            "notes": made.notes,
            "report": report,
        });
        format!("{object}\n")
    } else {
        summary(&made, &name, &args.output, &events, size)
    })?;
    Ok(Exit::Done)
}

/// The clip that is meant: the named one, else the file's only one.
fn wanted(file: &ClipFile, named: Option<&str>) -> Result<usize, Failure> {
    match named {
        Some(name) => file.find(name).map_err(|error| Failure::bad_input(error.to_string())),
        None if file.clips.len() == 1 => Ok(0),
        None => {
            let shown: Vec<&str> = file.clips.iter().take(40).map(String::as_str).collect();
            let more = file.clips.len() - shown.len();
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            Err(Failure::bad_input(format!(
                "{}: there are {} clips in it\n  help: name one with --clip: {}{more}",
                file.file,
                file.clips.len(),
                shown.join(", ")
            )))
        }
    }
}

/// What came of it, for a person.
fn summary(made: &Retargeted, name: &str, output: &Path, events: &Path, size: usize) -> String {
    let report = &made.report;
    let keys: usize = made.clip.channels.iter().map(|channel| channel.times.len()).sum();
    let mut text = format!("retargeted {} ({:.1} MB)\n", output.display(), size as f64 / 1e6);
    text += &format!("events     {}\n", events.display());
    text += &format!(
        "clip       {name}: {:.2} s at {} fps, root motion {}, {keys} keys\n",
        report.duration, report.fps, report.root_motion
    );
    let slip = report.contacts.iter().map(|contact| contact.slip_mm).fold(0.0, f64::max);
    text += &format!(
        "feet       {} contacts, slip up to {slip:.1} mm, soles up to {:.1} mm into the ground\n",
        report.contacts.len(),
        report.plausibility.penetration_max_mm
    );
    for note in &made.notes {
        text += &format!("note       {note}\n");
    }
    text
}
