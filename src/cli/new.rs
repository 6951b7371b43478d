//! `surefoot new`: a scenario, a sweep or a rig to start from.

use super::args::{New, NewArgs};
use super::{parts, say, tell};
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};
use crate::model::{scenario_text, sweep_text};
use std::path::{Path, PathBuf};

/// Where a rig goes unless it is told.
const RIG_OUTPUT: &str = "exports/mannequin.glb";

/// Writes it.
pub fn run(args: &NewArgs) -> Result<Exit, Failure> {
    if args.what != New::Rig && (args.height.is_some() || args.leg_scale.is_some()) {
        return Err(Failure::bad_input("--height and --leg-scale are for `surefoot new rig`"));
    }
    match args.what {
        New::Scenario => match &args.output {
            None => say(scenario_text::example_text())?,
            Some(path) => put(path, scenario_text::example_text().into())?,
        },
        New::Rig => {
            let path = args.output.clone().unwrap_or_else(|| PathBuf::from(RIG_OUTPUT));
            if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("glb")) {
                return Err(Failure::bad_input(format!(
                    "{}: the rig is a binary glTF file\n  help: let its name end in .glb",
                    path.display()
                )));
            }
            put(&path, parts::new_rig(args.height, args.leg_scale))?;
        }
        New::Sweep => match &args.output {
            None => say(sweep_text::example_text())?,
            Some(path) => put(path, sweep_text::example_text().into())?,
        },
    }
    Ok(Exit::Done)
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
