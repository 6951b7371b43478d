//! `surefoot inspect`: what was found in a rig.

use super::args::InspectArgs;
use super::say;
use crate::disk::resolve;
use crate::disk::{Exit, Failure};
use crate::rig;

/// Inspects.
pub fn run(args: &InspectArgs) -> Result<Exit, Failure> {
    let rig = resolve::rig(&args.rig)?.rig;
    // Warnings are part of what was found: they stand in the result.
    say(&match args.json {
        true => format!("{}\n", rig::inspect_json(&rig)),
        false => format!("{}\n", rig::inspect_text(&rig).trim_end()),
    })?;
    Ok(Exit::Done)
}
