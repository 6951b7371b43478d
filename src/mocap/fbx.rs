//! Clips of FBX files, by `ufbx`: every animation stack is one.
//!
//! The nodes' local transforms are evaluated, pivots, pre- and post-rotations and inherited scales resolved, in the file's own axes and
//! unit; what its settings say of both is believed where a body of that size and posture can be. Rest is the bind pose, where the file
//! has one. Leaves out the mesh (soles are made from the joints) and what the file points to.

use super::skeleton::{Recording, Said, stand};
use super::{MocapError, Options, Reading, frames, rate};
use crate::rig::Trs;
use crate::rig::fbx::{self, trs};
use glam::DVec3;
use ufbx::{CoordinateAxis, Scene, SceneRoot};

/// Curves whose keys are looked at for a rate.
const CURVES_LOOKED_AT: usize = 200;
/// Sentences.
const MOST_NOTES: usize = 20;
/// Hz, that a file's settings may say.
const RATES: std::ops::RangeInclusive<f64> = 10.0..=1000.0;

/// A file that was read.
pub struct Fbx {
    scene: SceneRoot,
}

impl Fbx {
    /// Reads a file's bytes. `name` is the file in messages.
    pub fn open(name: &str, bytes: &[u8]) -> Result<Fbx, MocapError> {
        let opts = ufbx::LoadOpts {
            ignore_geometry: true,
            ignore_embedded: true,
            skip_skin_vertices: true,
            skip_mesh_parts: true,
            ..ufbx::LoadOpts::default()
        };
        let broken = |what| MocapError::Malformed { file: name.into(), place: "FBX".into(), what };
        let scene = fbx::open(bytes, opts).map_err(broken)?;
        Ok(Fbx { scene })
    }

    /// The clips' names.
    pub fn names(&self) -> Vec<String> {
        let name = |(index, stack): (usize, &ufbx::AnimStack)| {
            let name: &str = &stack.element.name;
            if name.is_empty() { format!("stack {index}") } else { name.to_owned() }
        };
        self.scene.anim_stacks.into_iter().enumerate().map(name).collect()
    }

    /// Reads one clip.
    pub fn read(&self, file: &str, index: usize, person: &Said, options: &Options) -> Result<Reading, MocapError> {
        let nodes = fbx::nodes(&self.scene);
        let clip = self.clip(file, index, options.fps)?;
        let scene: &Scene = &self.scene;
        let local = |frame: usize, node: usize| self.local(index, node, clip.start + frame as f64 / clip.fps);
        let recording = Recording {
            names: nodes.names,
            parents: nodes.parents,
            order: nodes.order,
            zero: nodes.zero,
            fps: clip.fps,
            frames: clip.frames,
            local: &local,
            unit: scene.settings.unit_meters,
            up: axis(scene.settings.axes.up),
            extensions: None,
        };
        let (rig, up) = stand(file, &recording, person)?;
        let mut capture = frames::read(&clip.name, &recording, &rig, up);
        for warning in &scene.metadata.warnings {
            let note = format!("FBX: {}", &*warning.description);
            if capture.notes.len() < MOST_NOTES && !capture.notes.contains(&note) {
                capture.notes.push(note);
            }
        }
        Ok(Reading { capture, rig, start: clip.start, frame_up: up })
    }
}

/// When a clip plays and how finely.
pub(super) struct ClipTimes {
    pub name: String,
    pub start: f64,
    pub fps: f64,
    pub frames: usize,
}

impl Fbx {
    /// A node's local transform in a clip at a time, s.
    pub(super) fn local(&self, clip: usize, node: usize, time: f64) -> Trs {
        trs(&ufbx::evaluate_transform(&self.scene.anim_stacks[clip].anim, &self.scene.nodes[node], time))
    }

    pub(super) fn clip(&self, file: &str, index: usize, wanted_fps: Option<f64>) -> Result<ClipTimes, MocapError> {
        let name = self.names().get(index).cloned().unwrap_or_default();
        let stack = &self.scene.anim_stacks[index];
        let (mut keys, mut first, mut last) = (0, f64::MAX, f64::MIN);
        let mut times: Vec<Vec<f32>> = Vec::new();
        let values = stack.layers.into_iter().flat_map(|layer| &layer.anim_values);
        for curve in values.flat_map(|value| value.curves.iter().flatten()) {
            keys = keys.max(curve.keyframes.count);
            if let (Some(one), Some(other)) = (curve.keyframes.first(), curve.keyframes.last()) {
                (first, last) = (first.min(one.time), last.max(other.time));
            }
            if times.len() < CURVES_LOOKED_AT && curve.keyframes.count > 1 {
                times.push(curve.keyframes.iter().map(|key| (key.time - stack.time_begin) as f32).collect());
            }
        }
        if keys == 0 {
            let what = format!("clip \"{name}\" moves nothing: it has no keys");
            return Err(MocapError::NoClip { file: file.into(), what });
        }
        let (mut start, mut end) = (stack.time_begin, stack.time_end);
        // A stack without a span of its own, or one that misses its keys.
        if !(end > start && first < end && last > start) {
            (start, end) = (first, last);
        }
        let said = self.scene.settings.frames_per_second;
        let said = if RATES.contains(&said) { rate::of_frame_time(1.0 / said) } else { rate::DEFAULT };
        let by_keys = || {
            let origin = times.iter().filter_map(|times| times.first()).fold(f32::MAX, |a, b| a.min(*b));
            let usual = rate::of_keys(times.iter().map(Vec::as_slice), f64::from(origin))?;
            // Keys on every n-th frame are no rate; keys between the frames are.
            (usual > said * 1.01).then_some(usual)
        };
        let fps = wanted_fps.unwrap_or_else(|| by_keys().unwrap_or(said));
        let frames = rate::frames(end - start, fps, keys).ok_or_else(|| MocapError::Malformed {
            file: file.into(),
            place: format!("clip \"{name}\""),
            what: format!("lasts {:.0} s: too long for its {keys} keys", end - start),
        })?;
        Ok(ClipTimes { name, start, fps, frames })
    }
}

/// Up, as the settings say.
fn axis(axis: CoordinateAxis) -> Option<DVec3> {
    Some(match axis {
        CoordinateAxis::PositiveX => DVec3::X,
        CoordinateAxis::NegativeX => DVec3::NEG_X,
        CoordinateAxis::PositiveY => DVec3::Y,
        CoordinateAxis::NegativeY => DVec3::NEG_Y,
        CoordinateAxis::PositiveZ => DVec3::Z,
        CoordinateAxis::NegativeZ => DVec3::NEG_Z,
        CoordinateAxis::Unknown => return None,
    })
}
