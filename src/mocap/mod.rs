//! Clip files of any kind to [`Capture`]s: who moves, and where every joint is in every frame.
//!
//! The way of a file: bytes -> its own parser ([`bvh`]) -> named nodes with local transforms a frame -> the humanoid found in them and
//! its rest pose ([`skeleton`]) -> a capture in clip space (metres, Y up).

pub mod bvh;
pub mod error;
pub mod skeleton;

pub use error::MocapError;

use crate::model::Capture;

/// Every clip of a BVH file's text. `name` stands for the file in messages.
pub fn read_bvh(name: &str, text: &str) -> Result<Capture, MocapError> {
    let bvh = bvh::Bvh::parse(name, text)?;
    let zero = bvh
        .joints
        .iter()
        .map(|joint| crate::rig::Trs { translation: joint.offset, ..crate::rig::Trs::IDENTITY })
        .collect();
    let recording = skeleton::Recording {
        names: bvh.joints.iter().map(|joint| joint.name.clone()).collect(),
        parents: bvh.joints.iter().map(|joint| joint.parent).collect(),
        zero,
        fps: skeleton::rate(bvh.frame_time),
        frames: bvh.frames(),
        local: &|frame, node| bvh.local(frame, node),
    };
    let stem = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    let mut capture = skeleton::capture(name, stem, &recording, None)?;
    capture.notes.extend(bvh.notes.iter().cloned());
    Ok(capture)
}
