//! `surefoot sheet`: a clip as a contact sheet.

use super::args::SheetArgs;
use super::exit_code::{Exit, Failure};
use super::writer::{self, Output};
use super::{parts, resolve, tell};

/// Draws it.
pub fn run(args: &SheetArgs) -> Result<Exit, Failure> {
    let rig = resolve::rig(&args.file)?;
    writer::check(&[&args.output], &rig.files)?;
    let bytes = parts::sheet_of_file(&rig.rig, &args.file.display().to_string(), args.clip.as_deref())?;
    writer::write(&[Output { path: args.output.clone(), bytes }], &rig.files)?;
    tell(&format!("wrote {}", args.output.display()));
    Ok(Exit::Done)
}
