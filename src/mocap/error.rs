//! What can be wrong with a clip file, told to the person who gave it.

use crate::rig::RigError;

/// Why a file is no clip that can be judged.
#[derive(Debug, thiserror::Error)]
pub enum MocapError {
    /// It could not be read.
    #[error("{file}: cannot be read: {source}")]
    Io {
        /// The file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// Another kind of file.
    #[error("{file}: {what}; {remedy}")]
    WrongKind {
        /// The file.
        file: String,
        /// What it is.
        what: String,
        /// What to do.
        remedy: String,
    },
    /// It is broken.
    #[error("{file}: {place}: {what}")]
    Malformed {
        /// The file.
        file: String,
        /// Line or byte.
        place: String,
        /// What is wrong.
        what: String,
    },
    /// Its skeleton is no human's, or its glTF is broken.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// It has no clip, or none of that name.
    #[error("{file}: {what}")]
    NoClip {
        /// The file.
        file: String,
        /// Which there are.
        what: String,
    },
}
