//! Many clips of one rig in one file. Each is as it would be in a file of its own; names are the plan's.

use super::record::Piece;
use crate::export::{ExportError, Form, events_json, glb_with_root, root_target};
use crate::model::{Clip, ClipReport};
use crate::rig::Rig;

/// Clips of one file at most: past that engines take minutes to import it, and it would not be made in bounded memory.
pub const MOST_CLIPS: usize = 500;

/// A file with many clips.
pub struct Merged {
    /// GLB.
    pub file: Vec<u8>,
    /// `{ clip name: report }`.
    pub events: Vec<u8>,
}

/// The stem of a rig's merged file: the first has the rig's name, further ones a number.
pub fn file_name(rig: &str, part: usize) -> String {
    if part == 0 { rig.to_owned() } else { format!("{rig}_{}", part + 1) }
}

/// Puts the clips into a copy of the rig's document, as that form says.
pub fn merged(rig: &Rig, pieces: impl Iterator<Item = Piece>, form: Form) -> Result<Merged, ExportError> {
    let mut clips: Vec<(Clip, ClipReport)> = Vec::new();
    for piece in pieces {
        let report =
            serde_json::from_str(&piece.report).map_err(|error| ExportError::Json { reason: error.to_string() })?;
        clips.push((form.clip(&piece.clip), report));
    }
    let made = glb_with_root(rig, &clips, &[], form.root_joint.then(|| root_target(rig)))?;
    let named = made.names.iter().map(String::as_str).zip(clips.iter().map(|(_, report)| report));
    Ok(Merged { events: events_json(named)?, file: form.file(made.bytes, &made.names)? })
}
