//! Clip files of any kind to [`Capture`]s: who moves, and where every joint is in every frame.
//!
//! The way of a file: bytes -> its own parser ([`bvh`], [`gltf`], [`fbx`]) -> named nodes with local transforms a frame -> the humanoid
//! found in them and its rest pose ([`skeleton`], or the rig loader where a body is drawn) -> [`frames`] in clip space (metres, Y up).
//! The extension says what a file is; the content is asked whether that is true.

pub mod bvh;
pub mod bvh_write;
pub mod error;
pub mod fbx;
mod fbx_glb;
pub mod frames;
pub mod gltf;
mod kind;
pub mod rate;
pub mod retarget;
mod retarget_cycle;
mod retarget_feet;
mod retarget_planted;
mod retarget_pose;
mod retarget_turns;
pub mod skeleton;
pub mod unit;

pub use error::MocapError;
pub use kind::Kind;
pub use retarget::{Planted, retarget, retarget_with};

use crate::model::Capture;
use crate::rig::document::{Resolve, read_file};
use crate::rig::{Document, Rig, RigError, Trs, overrides};
use bvh::Bvh;
use glam::DVec3;
use skeleton::{Recording, Said};
use std::path::Path;

/// A file of clips, read and ready.
pub struct ClipFile {
    /// Its name in messages.
    pub file: String,
    /// What it is.
    pub kind: Kind,
    /// The clips' names: one at least.
    pub clips: Vec<String>,
    source: Source,
    overrides: Option<String>,
}

enum Source {
    Bvh(Bvh),
    Gltf(Box<gltf::Gltf>),
    Fbx(fbx::Fbx),
}

/// What a person says of a clip instead of what its file shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Hz. A BVH plays at that rate; of others frames are read at it.
    pub fps: Option<f64>,
    /// The file's up axis: see [`up_axis`].
    pub up: Option<DVec3>,
    /// Metres a unit.
    pub unit: Option<f64>,
}

/// A clip with what is needed to write it back.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The motion.
    pub capture: Capture,
    /// Who moves: its nodes are the file's (a BVH's joints, by index), its rest pose in `bind`. Its document and pictures may be empty.
    pub rig: Rig,
    /// s in the file at which frame 0 stands.
    pub start: f64,
    /// The file's up axis: the shortest arc from it to +Y leads from the file's axes to clip space.
    pub frame_up: DVec3,
}

/// Reads a file of clips and the override file beside it.
pub fn load(path: &Path) -> Result<ClipFile, MocapError> {
    let file = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let bytes = read_file(path).map_err(|source| MocapError::Io { file: file.clone(), source })?;
    let beside = overrides::file_name(&file);
    let text = match read_file(Path::new(&beside)) {
        Ok(bytes) => Some(String::from_utf8_lossy(&bytes).into_owned()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
        Err(source) => return Err(MocapError::Io { file: beside, source }),
    };
    read(&file, &bytes, &|relative| read_file(&folder.join(relative)), text.as_deref())
}

/// Reads a file's bytes. `name` stands for the file in messages and says its kind; `resolve` reads what a .gltf points to; `overrides`
/// is the text of the override file, if there is one.
pub fn read(name: &str, bytes: &[u8], resolve: &Resolve, overrides: Option<&str>) -> Result<ClipFile, MocapError> {
    let kind = kind::of(name, bytes)?;
    let (source, clips) = match kind {
        Kind::Bvh => {
            let bvh = Bvh::parse(name, &bvh::decode(bytes))?;
            (Source::Bvh(bvh), vec![stem(name)])
        }
        Kind::Fbx => {
            let fbx = fbx::Fbx::open(name, bytes)?;
            let names = fbx.names();
            (Source::Fbx(fbx), names)
        }
        Kind::Gltf | Kind::Vrm | Kind::Vrma => {
            let gltf = gltf::Gltf::open(name, bytes, resolve, overrides)?;
            let names = gltf.names();
            (Source::Gltf(Box::new(gltf)), names)
        }
    };
    if clips.is_empty() {
        let what = "has no animation: there is nothing to judge".to_owned();
        return Err(MocapError::NoClip { file: name.to_owned(), what });
    }
    Ok(ClipFile { file: name.to_owned(), kind, clips, source, overrides: overrides.map(str::to_owned) })
}

impl ClipFile {
    /// The index of a clip: by its name, else by a number from 0.
    pub fn find(&self, wanted: &str) -> Result<usize, MocapError> {
        let by_name = self.clips.iter().position(|name| name == wanted);
        let alike = || self.clips.iter().position(|name| name.eq_ignore_ascii_case(wanted));
        let by_number = || wanted.parse::<usize>().ok().filter(|index| *index < self.clips.len());
        by_name.or_else(alike).or_else(by_number).ok_or_else(|| {
            let shown: Vec<&str> = self.clips.iter().take(40).map(String::as_str).collect();
            let more = self.clips.len().saturating_sub(shown.len());
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let what = format!("has no clip \"{wanted}\"; there are: {}{more}", shown.join(", "));
            MocapError::NoClip { file: self.file.clone(), what }
        })
    }

    /// One clip's motion.
    pub fn capture(&self, index: usize, options: &Options) -> Result<Capture, MocapError> {
        self.reading(index, options).map(|reading| reading.capture)
    }

    /// One clip's motion, with what is needed to write it back.
    pub fn reading(&self, index: usize, options: &Options) -> Result<Reading, MocapError> {
        if index >= self.clips.len() {
            self.find(&index.to_string())?;
        }
        let said = Said { overrides: self.overrides.as_deref(), up: options.up, unit: options.unit };
        let file = &self.file;
        match &self.source {
            Source::Bvh(bvh) => read_recorded(file, &self.clips[0], bvh, &said, options),
            Source::Gltf(gltf) => gltf.read(file, index, &said, options),
            Source::Fbx(fbx) => fbx.read(file, index, &said, options),
        }
    }

    /// The parsed BVH, if it is one.
    pub fn bvh(&self) -> Option<&Bvh> {
        if let Source::Bvh(bvh) = &self.source { Some(bvh) } else { None }
    }

    /// An FBX as a GLB document, metres and Y up: its nodes under their names at the rest pose that was found, and for every clip an
    /// animation at the same index, frame 0 at 0 s. `None` for other kinds.
    pub fn fbx_to_glb(&self, options: &Options) -> Option<Result<Vec<u8>, MocapError>> {
        let Source::Fbx(fbx) = &self.source else { return None };
        let said = Said { overrides: self.overrides.as_deref(), up: options.up, unit: options.unit };
        Some(fbx_glb::write(fbx, &self.file, &said, options))
    }

    /// The document's nodes, if it is a glTF.
    pub fn nodes(&self) -> Option<&[crate::rig::RigNode]> {
        if let Source::Gltf(gltf) = &self.source { Some(gltf.nodes()) } else { None }
    }

    /// The glTF document, if it is one.
    pub fn document(&self) -> Option<&Document> {
        if let Source::Gltf(gltf) = &self.source { Some(&gltf.document) } else { None }
    }
}

/// A clip of a BVH file's text, by its name. `name` stands for the file in messages.
pub fn read_bvh(name: &str, text: &str) -> Result<Capture, MocapError> {
    let bvh = Bvh::parse(name, text)?;
    read_recorded(name, &stem(name), &bvh, &Said::default(), &Options::default()).map(|reading| reading.capture)
}

/// The axis that a person names: "+Y", "-z", "X".
pub fn up_axis(text: &str) -> Option<DVec3> {
    let (sign, letter) = match text.strip_prefix('-') {
        Some(letter) => (-1.0, letter),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let axis = match letter {
        "x" | "X" => DVec3::X,
        "y" | "Y" => DVec3::Y,
        "z" | "Z" => DVec3::Z,
        _ => return None,
    };
    Some(axis * sign)
}

fn read_recorded(file: &str, clip: &str, bvh: &Bvh, said: &Said, options: &Options) -> Result<Reading, MocapError> {
    let zero = bvh.joints.iter().map(|joint| Trs { translation: joint.offset, ..Trs::IDENTITY }).collect();
    let recording = Recording {
        names: bvh.joints.iter().map(|joint| joint.name.clone()).collect(),
        parents: bvh.joints.iter().map(|joint| joint.parent).collect(),
        order: (0..bvh.joints.len()).collect(),
        zero,
        fps: options.fps.unwrap_or_else(|| rate::of_frame_time(bvh.frame_time)),
        frames: bvh.frames(),
        local: &|frame, node| bvh.local(frame, node),
        unit: 1.0,
        up: None,
        extensions: None,
    };
    let (rig, up) = skeleton::stand(file, &recording, said)?;
    let mut capture = frames::read(clip, &recording, &rig, up);
    capture.notes.extend(bvh.notes.iter().cloned());
    Ok(Reading { capture, rig, start: 0.0, frame_up: up })
}

/// A file's name without folder and extension.
fn stem(name: &str) -> String {
    let stem = name.rsplit(['/', '\\']).next().unwrap_or(name);
    stem.rsplit_once('.').map_or(stem, |(stem, _)| stem).to_owned()
}

impl MocapError {
    /// Whether it is the skeleton that is not understood, rather than the file.
    pub fn is_about_bones(&self) -> bool {
        matches!(self, MocapError::Rig(RigError::MissingBones { .. } | RigError::NotHumanoid { .. }))
    }
}
