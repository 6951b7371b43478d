//! A clip as a glTF animation: a key a frame, for what moves or stands otherwise than at rest.

use super::Buffer;
use crate::rig::Trs;
use serde_json::{Value, json};

/// Relative to itself, m or radians: what moves less stands still.
const STILL: f64 = 1e-7;

/// The animation of so many frames at that rate (Hz); `local` is a node's local transform in a frame.
pub fn animation(
    name: &str,
    (fps, frames): (f64, usize),
    rest: &[Trs],
    local: &dyn Fn(usize, usize) -> Trs,
    out: &mut Buffer,
) -> Value {
    let seconds: Vec<[f32; 1]> = (0..frames.max(1)).map(|frame| [(frame as f64 / fps) as f32]).collect();
    let input = out.push(&seconds, "SCALAR", true);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    let mut channel = |node: usize, path: &str, output: usize| {
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
    };
    for (node, rest) in rest.iter().enumerate() {
        let locals: Vec<Trs> = (0..frames).map(|frame| local(frame, node)).collect();
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
    json!({ "name": name, "channels": channels, "samplers": samplers })
}
