//! From what a person named (files, folders, patterns) to clips: which files, in which order, and what is in each.

use super::{Failure, glob, resolve};
use crate::mocap;
use crate::model::Capture;
use std::path::{Path, PathBuf};

/// Endings of clip files, lower case.
pub const ENDINGS: [&str; 6] = ["bvh", "fbx", "glb", "gltf", "vrm", "vrma"];

/// A file to read.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipFile {
    /// As it was named.
    pub path: PathBuf,
    /// It was found in a folder or by a pattern, not named.
    pub found: bool,
}

/// The files, each once: as given, and sorted within a folder or a pattern. True if several could be meant.
pub fn expand(named: &[PathBuf]) -> Result<(Vec<ClipFile>, bool), Failure> {
    let mut files: Vec<ClipFile> = Vec::new();
    let mut several = named.len() > 1;
    for path in named {
        let (found, paths) = if path.is_dir() {
            (true, glob::files_below(path, &is_clip))
        } else if !path.exists() && glob::is_pattern(path) {
            (true, glob::files(path))
        } else {
            (false, vec![path.clone()])
        };
        if paths.is_empty() {
            return Err(Failure::bad_input(format!(
                "{}: no clip there\n  help: a clip is a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file",
                path.display()
            )));
        }
        several |= found;
        files.extend(paths.into_iter().map(|path| ClipFile { path, found }));
    }
    let mut seen = std::collections::BTreeSet::new();
    files.retain(|file| seen.insert(file.path.clone()));
    Ok((files, several))
}

/// A file of clips, opened, and which of them are asked for.
pub struct Opened {
    file: mocap::ClipFile,
    /// Indices of clips.
    pub wanted: Vec<usize>,
}

/// Opens a file: every clip of it, or the one of that name. `None` where it was found, not named, and has no clip at all (a rig among
/// clips). The error is for a person and begins with the file.
pub fn open(file: &ClipFile, only: Option<&str>) -> Result<Option<Opened>, String> {
    resolve::plain_file(&file.path, "a clip is a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")
        .map_err(|failure| failure.message)?;
    let opened = match mocap::load(&file.path) {
        Err(mocap::MocapError::NoClip { .. }) if file.found => return Ok(None),
        opened => opened.map_err(|error| error.to_string())?,
    };
    let wanted = match only.map(|name| opened.find(name)) {
        None => (0..opened.clips.len()).collect(),
        Some(Ok(index)) => vec![index],
        Some(Err(_)) if file.found => return Ok(None),
        Some(Err(error)) => return Err(error.to_string()),
    };
    Ok(Some(Opened { file: opened, wanted }))
}

impl Opened {
    /// A clip of it. The error is for a person and begins with the file.
    pub fn capture(&self, index: usize, options: &mocap::Options) -> Result<Capture, String> {
        self.file.capture(index, options).map_err(|error| match self.file.clips.len() {
            1 => error.to_string(),
            _ => format!("{error} (clip {:?})", self.file.clips[index]),
        })
    }
}

fn is_clip(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}
