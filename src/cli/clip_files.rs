//! From what a person named (files, folders, patterns) to clips: which files, in which order, and what is in each.

use super::exit_code::Failure;
use super::{glob, resolve};
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

/// What a person knows better than the file.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Hz.
    pub fps: Option<f64>,
    /// As in "+Z".
    pub up: Option<String>,
    /// m.
    pub unit: Option<f64>,
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

/// Every clip of a file, or the one of that name. The error is for a person and begins with the file.
pub fn load(path: &Path, overrides: &Overrides, only: Option<&str>) -> Result<Vec<Capture>, String> {
    resolve::plain_file(path, "a clip is a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")
        .map_err(|failure| failure.message)?;
    let mut captures = read(path)?;
    if let Some(name) = only {
        let there: Vec<String> = captures.iter().map(|capture| format!("{:?}", capture.name)).collect();
        captures.retain(|capture| capture.name == name);
        if captures.is_empty() {
            return Err(format!("{}: no clip {name:?} in it; there is {}", path.display(), there.join(", ")));
        }
    }
    for capture in &mut captures {
        capture.fps = overrides.fps.unwrap_or(capture.fps);
    }
    Ok(captures)
}

fn read(path: &Path) -> Result<Vec<Capture>, String> {
    let name = path.display().to_string();
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ending != "bvh" {
        return Err(format!("{name}: this version reads .bvh files only"));
    }
    let bytes = std::fs::read(path).map_err(|error| format!("{name}: cannot be read: {error}"))?;
    let text = String::from_utf8_lossy(&bytes);
    mocap::read_bvh(&name, &text).map(|capture| vec![capture]).map_err(|error| error.to_string())
}

fn is_clip(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()))
}
