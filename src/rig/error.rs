//! What can be wrong with a rig file, told to the person who gave it: the file, the place in it, what would be right.

use crate::model::Role;

/// Why a file is no rig.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The file, or one that it points to, could not be read.
    #[error("{file}: cannot be read: {source}")]
    Io {
        /// The rig file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// Another kind of file.
    #[error("{file}: {what}; {remedy}")]
    WrongKind {
        /// The rig file.
        file: String,
        /// What it is.
        what: String,
        /// What to do.
        remedy: String,
    },
    /// The glTF itself is broken.
    #[error("{file}: {fault}")]
    Malformed {
        /// The rig file.
        file: String,
        /// Where and what.
        fault: Fault,
    },
    /// An extension that changes how geometry is decoded is required.
    #[error("{file}: extensionsRequired: {extension} is not supported; {remedy}")]
    Extension {
        /// The rig file.
        file: String,
        /// Its name.
        extension: String,
        /// What to do.
        remedy: String,
    },
    /// Bones without which there is no body to balance were not found.
    #[error(
        "{file}: no humanoid found: missing {}; bones in the file: {seen}; name them in {overrides}, as in\n  [bones]\n  {} = \"the node's name\"",
        names(missing), missing.first().map_or("hips", |role| role.name())
    )]
    MissingBones {
        /// The rig file.
        file: String,
        /// Which.
        missing: Vec<Role>,
        /// The node names that were seen, shortened.
        seen: String,
        /// The override file that would help.
        overrides: String,
    },
    /// It has the bones, but not the build of a human.
    #[error("{file}: not a humanoid: {reason}; if it is one all the same, say which bone is which in {overrides}")]
    NotHumanoid {
        /// The rig file.
        file: String,
        /// Why.
        reason: String,
        /// The override file that would help.
        overrides: String,
    },
    /// The override file is wrong.
    #[error("{file}: {key}: {what}")]
    Override {
        /// The override file.
        file: String,
        /// The key in it.
        key: String,
        /// What is wrong and what would be right.
        what: String,
    },
}

/// A place in the document and what is wrong there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct Fault {
    /// As in `accessors[3].bufferView`.
    pub place: String,
    /// What is wrong and what would be right.
    pub what: String,
}

impl Fault {
    /// A fault at that place.
    pub fn new(place: impl Into<String>, what: impl Into<String>) -> Fault {
        Fault { place: place.into(), what: what.into() }
    }

    /// With the file that it was found in.
    pub fn in_file(self, file: &str) -> RigError {
        RigError::Malformed { file: file.to_owned(), fault: self }
    }
}

fn names(roles: &[Role]) -> String {
    roles.iter().map(|role| role.name()).collect::<Vec<_>>().join(", ")
}
