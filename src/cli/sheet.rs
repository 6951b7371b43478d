//! `surefoot sheet`: a clip as a contact sheet.

use super::args::SheetArgs;
use super::{parts, tell};
use crate::disk::resolve;
use crate::disk::writer::{self, Output};
use crate::disk::{Exit, Failure};

/// Draws it.
pub fn run(args: &SheetArgs) -> Result<Exit, Failure> {
    let rig = resolve::rig(&args.file)?;
    writer::check(&[&args.output], &rig.files)?;
    let bytes = parts::sheet_of_file(&rig.rig, &args.file.display().to_string(), args.clip.as_deref())?;
    writer::write(&[Output { path: args.output.clone(), bytes }], &rig.files)?;
    tell(&format!("wrote {}", args.output.display()));
    Ok(Exit::Done)
}
