//! The kinds of file that a clip is written as.

use std::path::Path;

/// What kind of file a clip is written as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileKind {
    /// The rig's document with the clip in it.
    #[default]
    Glb,
    /// A VRM animation, the motion alone.
    Vrma,
    /// Skeleton and take.
    Fbx,
}

impl FileKind {
    /// All.
    pub const ALL: [FileKind; 3] = [FileKind::Glb, FileKind::Vrma, FileKind::Fbx];

    /// Of a file of that name.
    pub fn of(output: &Path) -> FileKind {
        let ending = output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        match ending.to_ascii_lowercase().as_str() {
            "vrma" => FileKind::Vrma,
            "fbx" => FileKind::Fbx,
            _ => FileKind::Glb,
        }
    }

    /// The ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            FileKind::Glb => "glb",
            FileKind::Vrma => "vrma",
            FileKind::Fbx => "fbx",
        }
    }

    /// What such a file is, where it cannot hold the things beside the body.
    pub fn without_props(self) -> Option<&'static str> {
        match self {
            FileKind::Glb => None,
            FileKind::Vrma => Some("a VRM animation"),
            FileKind::Fbx => Some("an FBX take"),
        }
    }
}
