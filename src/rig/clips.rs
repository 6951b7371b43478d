//! The clips that a document holds already, as [`Clip`]s: for pictures of them, and for their names.
//!
//! Document units and local transforms, as in the file. Translations and rotations of nodes; scale and morph weights are
//! left out. A cubic spline is taken as straight lines between its keys.

use super::document::required_index;
use super::{Fault, Rig};
use crate::model::{Channel, Clip, Interpolation, KeyValues, Target};
use serde_json::Value;

/// Names of the clips, by index; "" where one has none.
pub fn clip_names(rig: &Rig) -> Vec<String> {
    let name = |clip: &Value| clip.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    rig.document.list("animations").iter().map(name).collect()
}

/// Reads one clip.
pub fn read_clip(rig: &Rig, index: usize) -> Result<Clip, Fault> {
    let place = format!("animations[{index}]");
    let animation = rig.document.entry("animations", index, &place)?;
    let list = |name: &str| animation.get(name).and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let mut clip = Clip { name: clip_names(rig)[index].clone(), fps: 30.0, duration: 0.0, channels: Vec::new() };
    for (at, channel) in list("channels").iter().enumerate() {
        let place = format!("{place}.channels[{at}]");
        let Some(target) = channel.get("target") else { return Err(Fault::new(&place, "has no target")) };
        if target.get("node").is_none() {
            continue; // an extension's business
        }
        let node = required_index(target, "node", &format!("{place}.target"))?;
        if node >= rig.nodes.len() {
            return Err(Fault::new(format!("{place}.target.node"), format!("node {node} is not there")));
        }
        let rotation = match target.get("path").and_then(Value::as_str) {
            Some("translation") => false,
            Some("rotation") => true,
            _ => continue,
        };
        let sampler = required_index(channel, "sampler", &place)?;
        let Some(sampler) = list("samplers").get(sampler) else {
            return Err(Fault::new(format!("{place}.sampler"), format!("sampler {sampler} is not there")));
        };
        if let Some(channel) = read_channel(rig, sampler, node, rotation, &place)? {
            clip.duration = channel.times.last().map_or(clip.duration, |last| clip.duration.max(f64::from(*last)));
            clip.channels.push(channel);
        }
    }
    Ok(clip)
}

/// `None` for a channel without keys.
fn read_channel(
    rig: &Rig,
    sampler: &Value,
    node: usize,
    rotation: bool,
    place: &str,
) -> Result<Option<Channel>, Fault> {
    let times = rig.document.read_f32s(required_index(sampler, "input", place)?, place)?;
    let values = rig.document.read_f32s(required_index(sampler, "output", place)?, place)?;
    let (interpolation, stride, first) = match sampler.get("interpolation").and_then(Value::as_str) {
        Some("STEP") => (Interpolation::Step, 1, 0),
        Some("CUBICSPLINE") => (Interpolation::Linear, 3, 1), // in-tangent, value, out-tangent
        _ => (Interpolation::Linear, 1, 0),
    };
    let times: Vec<f32> = (0..times.len()).map(|key| times.element(key)[0]).collect();
    let width = if rotation { 4 } else { 3 };
    let enough = values.len() >= times.len() * stride && (values.is_empty() || values.element(0).len() == width);
    let rising = times.windows(2).all(|pair| pair[0] < pair[1]) && times.iter().all(|time| time.is_finite());
    if !enough || !rising {
        return Err(Fault::new(place, "needs rising times and a value for each"));
    }
    if times.is_empty() {
        return Ok(None);
    }
    let keys = (0..times.len()).map(|key| values.element(key * stride + first));
    let values = if rotation {
        KeyValues::Rotation(keys.map(|key| [key[0], key[1], key[2], key[3]]).collect())
    } else {
        KeyValues::Translation(keys.map(|key| [key[0], key[1], key[2]]).collect())
    };
    Ok(Some(Channel { target: Target::Node(node), times, values, interpolation }))
}
