//! An FBX's nodes and clips as a GLB document, for what writes glTF only: metres, Y up, a key a frame.
//!
//! The nodes stand at the rest pose that was found in the file, so that the rig loader finds the same body; what moves or stands
//! otherwise in a clip has a channel in it. Leaves out meshes, materials, cameras and everything else that is no node.

use super::fbx::{ClipTimes, Fbx};
use super::skeleton::Said;
use super::{MocapError, Options};
use crate::maths::quat::shortest_arc;
use crate::rig::Trs;
use serde_json::{Value, json};

/// Relative to itself, m or radians: what moves less stands still.
const STILL: f64 = 1e-7;

/// Transforms that are written at most.
const MOST_TRANSFORMS: usize = 1 << 26;

/// The bytes of the GLB.
pub fn write(fbx: &Fbx, file: &str, said: &Said, options: &Options) -> Result<Vec<u8>, MocapError> {
    let clips = fbx.names().len();
    let mut first = Err(MocapError::NoClip { file: file.into(), what: "has no animation".into() });
    for clip in 0..clips {
        first = fbx.read(file, clip, said, options);
        if first.is_ok() {
            break;
        }
    }
    let reading = first?;
    let metres = reading.capture.units_to_metres;
    let turned = shortest_arc(reading.frame_up, glam::DVec3::Y);
    let nodes = &reading.rig.nodes;
    let place = |node: usize, local: &Trs| {
        let mut place = Trs { translation: local.translation * metres, ..*local };
        if nodes[node].parent.is_none() {
            place.translation = turned * place.translation;
            place.rotation = (turned * place.rotation).normalize();
        }
        place
    };
    let rest: Vec<Trs> = nodes.iter().enumerate().map(|(index, node)| place(index, &node.bind)).collect();
    let list: Vec<Value> = nodes
        .iter()
        .zip(&rest)
        .map(|(node, rest)| {
            let mut json = json!({
                "name": node.name.as_deref().unwrap_or_default(),
                "translation": rest.translation.to_array(),
                "rotation": rest.rotation.to_array(),
                "scale": rest.scale.to_array(),
            });
            if !node.children.is_empty() {
                json["children"] = json!(node.children);
            }
            json
        })
        .collect();
    let roots: Vec<usize> = (0..nodes.len()).filter(|node| nodes[*node].parent.is_none()).collect();
    let mut out = Buffer::default();
    let (mut animations, mut evaluated) = (Vec::new(), 0_usize);
    for clip in 0..clips {
        let times = fbx.clip(file, clip, options.fps);
        let name = fbx.names().swap_remove(clip);
        let still = ClipTimes { name: name.clone(), start: 0.0, fps: 30.0, frames: 0 };
        let times = times.unwrap_or(still); // a stack without keys keeps its index
        evaluated += times.frames.saturating_mul(nodes.len());
        if evaluated > MOST_TRANSFORMS {
            let what = format!("{} nodes in so many frames are too many to write", nodes.len());
            return Err(MocapError::Malformed { file: file.into(), place: format!("clip \"{name}\""), what });
        }
        animations.push(animation(fbx, clip, &times, &rest, &place, &mut out));
    }
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "surefoot" },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": list,
        "animations": animations,
        "accessors": out.accessors,
        "bufferViews": out.views,
        "buffers": [{ "byteLength": out.bytes.len() }],
    });
    if clips == 0 {
        document.as_object_mut().map(|object| object.remove("animations"));
    }
    Ok(container(&document, &out.bytes))
}

/// A clip; `place` takes a local transform of the file to the document's.
fn animation(
    fbx: &Fbx,
    clip: usize,
    times: &ClipTimes,
    rest: &[Trs],
    place: &dyn Fn(usize, &Trs) -> Trs,
    out: &mut Buffer,
) -> Value {
    let seconds: Vec<[f32; 1]> = (0..times.frames.max(1)).map(|frame| [(frame as f64 / times.fps) as f32]).collect();
    let input = out.push(&seconds, "SCALAR", true);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    let mut channel = |node: usize, path: &str, output: usize| {
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
    };
    for (node, rest) in rest.iter().enumerate() {
        let locals: Vec<Trs> = (0..times.frames)
            .map(|frame| place(node, &fbx.local(clip, node, times.start + frame as f64 / times.fps)))
            .collect();
        let differs = |of: &dyn Fn(&Trs) -> f64| locals.iter().any(|local| of(local) > STILL);
        if differs(&|local| (local.translation - rest.translation).length()) {
            let keys: Vec<[f32; 3]> = locals.iter().map(|local| local.translation.as_vec3().to_array()).collect();
            channel(node, "translation", out.push(&keys, "VEC3", false));
        }
        if differs(&|local| 1.0 - local.rotation.dot(rest.rotation).abs()) {
            let mut before = rest.rotation;
            let keys: Vec<[f32; 4]> = locals
                .iter()
                .map(|local| {
                    before = if local.rotation.dot(before) < 0.0 { -local.rotation } else { local.rotation };
                    before.as_quat().to_array()
                })
                .collect();
            channel(node, "rotation", out.push(&keys, "VEC4", false));
        }
        if differs(&|local| (local.scale - rest.scale).length()) {
            let keys: Vec<[f32; 3]> = locals.iter().map(|local| local.scale.as_vec3().to_array()).collect();
            channel(node, "scale", out.push(&keys, "VEC3", false));
        }
    }
    if channels.is_empty() && !rest.is_empty() {
        let keys = vec![rest[0].translation.as_vec3().to_array(); seconds.len()];
        let output = out.push(&keys, "VEC3", false);
        channels.push(json!({ "sampler": 0, "target": { "node": 0, "path": "translation" } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
    }
    json!({ "name": times.name, "channels": channels, "samplers": samplers })
}

/// The binary chunk as it grows.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn push<const N: usize>(&mut self, keys: &[[f32; N]], kind: &str, bounds: bool) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(keys.iter().flatten().flat_map(|number| number.to_le_bytes()));
        let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        let mut accessor =
            json!({ "bufferView": self.views.len(), "componentType": 5126, "count": keys.len(), "type": kind });
        if bounds {
            accessor["min"] = json!(keys.first().map(<[f32; N]>::as_slice));
            accessor["max"] = json!(keys.last().map(<[f32; N]>::as_slice));
        }
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// JSON and bytes as a GLB.
fn container(document: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = bytes.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let word = |number: usize| u32::try_from(number).unwrap_or(u32::MAX).to_le_bytes();
    let mut out = Vec::with_capacity(28 + json.len() + binary.len());
    out.extend(b"glTF");
    out.extend(word(2));
    out.extend(word(28 + json.len() + binary.len()));
    out.extend(word(json.len()));
    out.extend(b"JSON");
    out.extend(json);
    out.extend(word(binary.len()));
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}
