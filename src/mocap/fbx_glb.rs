//! An FBX's nodes and clips as a GLB document, for what writes glTF only: metres, Y up, a key a frame.
//!
//! The nodes stand at the rest pose that was found in the file, so that the rig loader finds the same body; what moves or stands
//! otherwise in a clip has a channel in it. Leaves out meshes, materials, cameras and everything else that is no node.

use super::fbx::{ClipTimes, Fbx};
use super::skeleton::Said;
use super::{MocapError, Options};
use crate::maths::quat::shortest_arc;
use crate::rig::Trs;
use crate::rig::fbx::{Buffer, animation, container};
use serde_json::{Value, json};

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
        let local =
            |frame: usize, node: usize| place(node, &fbx.local(clip, node, times.start + frame as f64 / times.fps));
        animations.push(animation(&times.name, (times.fps, times.frames), &rest, &local, &mut out));
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
