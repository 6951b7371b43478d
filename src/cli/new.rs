//! `surefoot new`: a scenario, a sweep or a rig to start from; of the first two also the schema, for editors.

use super::args::{New, NewArgs};
use super::{parts, say, tell};
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::model::{scenario_text, schema, sweep_text};
use std::path::{Path, PathBuf};

/// Where a rig goes unless it is told.
const RIG_OUTPUT: &str = "exports/mannequin.glb";

/// Writes it.
pub fn run(args: &NewArgs) -> Result<Exit, Failure> {
    if args.what != New::Rig && (args.height.is_some() || args.leg_scale.is_some()) {
        return Err(Failure::bad_input("--height and --leg-scale are for `surefoot new rig`"));
    }
    match args.what {
        New::Rig if args.schema => {
            return Err(Failure::bad_input("--schema is for `surefoot new scenario` and `surefoot new sweep`"));
        }
        New::Rig => {
            let path = args.output.clone().unwrap_or_else(|| PathBuf::from(RIG_OUTPUT));
            must_end_in(&path, "glb", "the rig is a binary glTF file")?;
            put(&path, parts::new_rig(args.height, args.leg_scale))?;
        }
        New::Scenario if args.schema => text(args, schema::SCENARIO)?,
        New::Scenario => text(args, scenario_text::example_text())?,
        New::Sweep if args.schema => text(args, schema::SWEEP)?,
        New::Sweep => text(args, sweep_text::example_text())?,
    }
    Ok(Exit::Done)
}

/// To stdout, or where it is wanted.
fn text(args: &NewArgs, text: &str) -> Result<(), Failure> {
    match &args.output {
        None => say(text),
        Some(path) => {
            if args.schema {
                must_end_in(path, "json", "a schema is a JSON file")?;
            }
            put(path, text.into())
        }
    }
}

fn must_end_in(path: &Path, ending: &str, what: &str) -> Result<(), Failure> {
    if path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)) {
        return Ok(());
    }
    Err(Failure::bad_input(format!("{}: {what}\n  help: let its name end in .{ending}", path.display())))
}

/// A file to start from is written once: what a person made of it since is not replaced.
fn put(path: &Path, bytes: Vec<u8>) -> Result<(), Failure> {
    if path.exists() {
        return Err(Failure::bad_input(format!(
            "{}: there is a file already, and it may be your work\n  help: give -o another name, or remove it",
            path.display()
        )));
    }
    writer::write(&[Output { path: path.to_path_buf(), bytes }], &[])?;
    tell(&format!("wrote {}", path.display()));
    Ok(())
}
