//! `surefoot sheet`: a clip as a contact sheet.

use super::args::SheetArgs;
use super::exit_code::{Exit, Failure};
use super::writer::{self, Output};
use super::{parts, resolve, tell};

/// Draws it.
pub fn run(args: &SheetArgs) -> Result<Exit, Failure> {
    resolve::plain_file(&args.file, "give a .glb, .gltf or .vrm file with a clip, as `surefoot bake` writes it")?;
    let inputs = [args.file.clone()];
    writer::check(&[&args.output], &inputs)?;
    let bytes = parts::sheet_of_file(&args.file, args.clip.as_deref())?;
    writer::write(&[Output { path: args.output.clone(), bytes }], &inputs)?;
    tell(&format!("wrote {}", args.output.display()));
    Ok(Exit::Done)
}
