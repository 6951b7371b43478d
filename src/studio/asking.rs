//! What the studio says and asks: messages that pass by, and questions that stand in front of everything else.

use super::command::Command;
use super::home::Unsaved;
use std::path::PathBuf;

/// A message for the person.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// What happened, and behind `help:` what to do.
    pub text: String,
    /// Something went wrong.
    pub bad: bool,
}

/// What a file is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Anything that can be opened.
    Open,
    /// A rig.
    Rig,
    /// A clip under the reaction.
    Base,
    /// The mesh of the ground.
    Ground,
    /// The scenario's place.
    Save,
    /// The baked clip's place.
    Export,
    /// A clip to audit.
    Clip,
    /// The corrected clip's place.
    Corrected,
    /// A sweep's place.
    Sweep,
    /// A folder for a batch.
    Folder,
}

/// A question that stands in front of everything else.
#[derive(Clone, Debug, PartialEq)]
pub enum Asking {
    /// Which file?
    File(Purpose),
    /// Save before that?
    Unsaved(Box<Command>),
    /// Take up what a crash left?
    Recover(PathBuf, Unsaved),
    /// The keys.
    Keys,
}
