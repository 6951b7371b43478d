//! A document with other keys in spans of its clips: what was not touched keeps its bytes, its indices and its values.
//!
//! Document units. In a changed span a node's keys are one a frame; the frames beside it get keys that the old curve runs through, so that it
//! goes on as it was to the bit of a float. LINEAR and STEP stay what they are, CUBICSPLINE keeps its tangents outside ([`super::amend_spline`])
//! and, where keys stand too close for that, gets them from the neighbours inside. Old keys stay in the buffer, unreferenced where no other sampler names them. Nodes that were not animated get a channel.

use super::ExportError;
use super::amend_spline::amended;
use super::buffers::Joined;
use super::glb::{container, list};
use crate::rig::clips::{Join, Property, RawKeys, Tracks, read_tracks};
use crate::rig::{Document, RigNode, Trs};
use glam::DVec4;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// s: keys that are nearer to a frame are that frame's.
const NEAR: f64 = 1e-4;
/// A value that is no farther from the old one is the old one.
const SAME: f64 = 1e-12;

/// What happens to one clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Amended {
    /// Its index in the document.
    pub animation: usize,
    /// s, of frame 0.
    pub start: f64,
    /// Frames a second.
    pub fps: f64,
    /// New local transforms by frame and node.
    pub edits: BTreeMap<(usize, usize), Trs>,
    /// By how much faster it plays.
    pub speed: f64,
    /// What it tells in `extras.surefoot` from now on; as it was, if none.
    pub extras: Option<Value>,
}

/// The document as a GLB with those clips changed. `nodes` are the document's.
pub fn amend(document: &Document, nodes: &[RigNode], clips: &[Amended]) -> Result<Vec<u8>, ExportError> {
    let fault = |reason: String| ExportError::Document { reason };
    let mut root = document.json.as_object().cloned().ok_or_else(|| fault("it is no JSON object".into()))?;
    let mut buffer = Joined::new(document, &mut root)?;
    buffer.embed_images(document, &mut root);
    let view = list(&mut root, "bufferViews").len();
    let start = buffer.append(&[]);
    let first = list(&mut root, "accessors").len();
    let mut keys = Keys { buffer, view, start, first, accessors: Vec::new() };
    let mut moved = BTreeSet::new();
    for clip in clips {
        let tracks = read_tracks(document, nodes.len(), clip.animation)
            .map_err(|error| fault(error.in_file("the document").to_string()))?;
        let Some(animation) = list(&mut root, "animations").get_mut(clip.animation) else {
            return Err(fault(format!("animations[{}] is not there", clip.animation)));
        };
        let new = clip_channels(clip, &tracks, nodes);
        moved.extend(new.keys().map(|(node, _)| *node));
        for ((node, property), track) in &new {
            put(animation, *node, *property, track, &mut keys);
        }
        if (clip.speed - 1.0).abs() > 1e-9 {
            play_faster(document, animation, clip.speed, &mut keys)?;
        }
        if let Some(told) = &clip.extras {
            animation["extras"]["surefoot"] = told.clone();
        }
    }
    for node in moved.into_iter().filter(|node| nodes[*node].has_matrix) {
        let Some(fields) = list(&mut root, "nodes").get_mut(node).and_then(Value::as_object_mut) else { continue };
        fields.shift_remove("matrix");
        let local = nodes[node].local;
        fields.insert("translation".into(), json!(local.translation.to_array()));
        fields.insert("rotation".into(), json!(local.rotation.normalize().to_array()));
        fields.insert("scale".into(), json!(local.scale.to_array()));
    }
    let length = keys.buffer.bytes.len() - keys.start;
    if length > 0 {
        list(&mut root, "bufferViews").push(json!({ "buffer": 0, "byteOffset": keys.start, "byteLength": length }));
    }
    list(&mut root, "accessors").append(&mut keys.accessors);
    for name in ["bufferViews", "accessors"] {
        if list(&mut root, name).is_empty() {
            root.shift_remove(name);
        }
    }
    let bytes = keys.buffer.bytes;
    if bytes.is_empty() {
        root.shift_remove("buffers");
    } else {
        list(&mut root, "buffers")[0]["byteLength"] = bytes.len().into();
    }
    container(&Value::Object(root), bytes)
}

/// What is appended.
struct Keys {
    buffer: Joined,
    view: usize,
    start: usize,
    first: usize,
    accessors: Vec<Value>,
}

impl Keys {
    fn accessor(&mut self, kind: &str, values: &[f32], width: usize) -> usize {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let offset = self.buffer.append(&data) - self.start;
        let mut accessor = json!({ "bufferView": self.view, "byteOffset": offset, "componentType": 5126,
            "count": values.len() / width, "type": kind });
        if kind == "SCALAR" {
            accessor["min"] = json!([f64::from(values.iter().copied().fold(f32::INFINITY, f32::min))]);
            accessor["max"] = json!([f64::from(values.iter().copied().fold(f32::NEG_INFINITY, f32::max))]);
        }
        self.accessors.push(accessor);
        self.first + self.accessors.len() - 1
    }
}

type Curves = BTreeMap<(usize, u8), RawKeys>;

/// The new keys of every property that a clip's edits change.
fn clip_channels(clip: &Amended, tracks: &Tracks, nodes: &[RigNode]) -> Curves {
    let time = |frame: usize| clip.start + frame as f64 / clip.fps;
    let mut frames: BTreeMap<(usize, u8), BTreeMap<usize, DVec4>> = BTreeMap::new();
    for ((frame, node), local) in &clip.edits {
        let old = tracks.local(*node, time(*frame), &nodes[*node].local);
        if (old.translation - local.translation).length() > SAME {
            frames.entry((*node, 0)).or_default().insert(*frame, local.translation.extend(0.0));
        }
        if 1.0 - old.rotation.dot(local.rotation).abs() > SAME * SAME || old.rotation != local.rotation {
            frames.entry((*node, 1)).or_default().insert(*frame, DVec4::from(local.rotation));
        }
    }
    frames
        .into_iter()
        .map(|((node, property), frames)| {
            let wanted = if property == 0 { Property::Translation } else { Property::Rotation };
            let track = tracks.list.iter().find(|track| track.node == node && track.property == wanted);
            let sample = |at: f64| {
                let local = tracks.local(node, at, &nodes[node].local);
                if property == 0 { local.translation.extend(0.0) } else { DVec4::from(local.rotation) }
            };
            let old = track.map(|track| track.keys());
            ((node, property), curve(old, &frames, &time, &sample, property == 1))
        })
        .collect()
}

/// The old keys with those frames in it.
fn curve(
    old: Option<RawKeys>,
    frames: &BTreeMap<usize, DVec4>,
    time: &dyn Fn(usize) -> f64,
    sample: &dyn Fn(f64) -> DVec4,
    rotation: bool,
) -> RawKeys {
    let none = RawKeys { times: Vec::new(), numbers: Vec::new(), join: Join::Linear };
    let RawKeys { times, numbers, join } = old.unwrap_or(none);
    let cubic = join == Join::CubicSpline;
    let slope = |at: f64| {
        // A spline's own tangent: exact but for rounding, since a cubic's central difference errs with its third power alone.
        let near = 1e-4;
        let (a, b) = (sample(at - near), sample(at + near));
        (if rotation && a.dot(b) < 0.0 { b + a } else { b - a }) / (2.0 * near)
    };
    let whole = RawKeys { times, numbers, join };
    if let Some(spline) = cubic.then(|| amended(&whole, frames, time, sample, &slope, rotation)).flatten() {
        return spline;
    }
    let RawKeys { times, numbers, join } = whole;
    let width = if rotation { 4 } else { 3 };
    let floats = |value: DVec4| value.to_array()[..width].iter().map(|part| *part as f32).collect::<Vec<f32>>();
    let mut keys: BTreeMap<u64, (f32, Vec<f32>)> = BTreeMap::new(); // by nanosecond, so that equal times meet
    let slot = |at: f64| ((at.max(0.0)) * 1e9).round() as u64;
    let spans = spans(frames);
    let covered = |at: f64| spans.iter().any(|(from, to)| at > time(*from) - NEAR && at < time(*to) + NEAR);
    let beside = |frame: i64| frame >= 0 && !frames.contains_key(&(frame as usize));
    // Between the frames beside a span, its own keys are the only ones.
    let within = |at: f64| {
        spans.iter().any(|(from, to)| {
            let before = from.checked_sub(1).map_or(time(*from) - NEAR, |before| time(before) + NEAR);
            at > before && at < time(to + 1) - NEAR
        })
    };
    for (index, at) in times.iter().enumerate() {
        let seconds = f64::from(*at);
        if !covered(seconds) && !within(seconds) {
            keys.insert(slot(seconds), (*at, numbers[index].clone()));
        }
    }
    let last_key = times.last().map_or(f64::MAX, |last| f64::from(*last));
    for (from, to) in &spans {
        for frame in [*from as i64 - 1, *to as i64 + 1] {
            let at = time(frame.max(0) as usize);
            let there = times.iter().any(|key| (f64::from(*key) - at).abs() < NEAR);
            // A curve that ends before the next frame ends with the span; one that ended long ago is held on.
            let beyond = frame > *to as i64 && at > last_key + NEAR && time(*to) <= last_key + NEAR;
            if beside(frame) && !there && !beyond {
                let (value, tangent) = (floats(sample(at)), floats(slope(at)));
                let numbers = if cubic { [tangent.clone(), value, tangent].concat() } else { value };
                keys.insert(slot(at), (at as f32, numbers));
            }
        }
    }
    for (frame, value) in frames {
        let at = time(*frame);
        let neighbour = |frame: usize| frames.get(&frame).copied().unwrap_or_else(|| sample(time(frame)));
        let numbers = if cubic {
            let aligned = |other: DVec4| if rotation && other.dot(*value) < 0.0 { -other } else { other };
            let (before, after) = (frame.saturating_sub(1), frame + 1);
            let tangent = (aligned(neighbour(after)) - aligned(neighbour(before))) / (time(after) - time(before));
            [floats(tangent), floats(*value), floats(tangent)].concat()
        } else {
            floats(*value)
        };
        keys.insert(slot(at), (at as f32, numbers));
    }
    let mut curve = RawKeys { times: Vec::new(), numbers: Vec::new(), join };
    for (at, numbers) in keys.into_values() {
        if curve.times.last().is_none_or(|last| *last < at) {
            curve.times.push(at);
            curve.numbers.push(numbers);
        }
    }
    if rotation && !cubic {
        align(&mut curve, &covered);
    }
    curve
}

/// New rotations on the near side of the key before, so that a reader that does not look for the shorter arc takes it too.
fn align(curve: &mut RawKeys, new: &dyn Fn(f64) -> bool) {
    for index in 1..curve.times.len() {
        let dot: f32 = curve.numbers[index - 1].iter().zip(&curve.numbers[index]).map(|(a, b)| a * b).sum();
        if dot < 0.0 && new(f64::from(curve.times[index])) {
            curve.numbers[index].iter_mut().for_each(|part| *part = -*part);
        }
    }
}

/// First and last of frames that follow each other.
pub(super) fn spans(frames: &BTreeMap<usize, DVec4>) -> Vec<(usize, usize)> {
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for frame in frames.keys() {
        match spans.last_mut() {
            Some(last) if last.1 + 1 == *frame => last.1 = *frame,
            _ => spans.push((*frame, *frame)),
        }
    }
    spans
}

/// Lets a channel of the animation play that curve.
fn put(animation: &mut Value, node: usize, property: u8, curve: &RawKeys, keys: &mut Keys) {
    let path = if property == 0 { "translation" } else { "rotation" };
    let (kind, width) = if property == 0 { ("VEC3", 3) } else { ("VEC4", 4) };
    let input = keys.accessor("SCALAR", &curve.times, 1);
    let output = keys.accessor(kind, &curve.numbers.concat(), width);
    let interpolation = match curve.join {
        Join::CubicSpline => "CUBICSPLINE",
        Join::Step => "STEP",
        Join::Linear => "LINEAR",
    };
    let Some(fields) = animation.as_object_mut() else { return };
    let at = list(fields, "channels")
        .iter()
        .position(|channel| channel["target"]["node"] == node && channel["target"]["path"] == path);
    let old = at.and_then(|at| list(fields, "channels")[at]["sampler"].as_u64());
    let mut sampler = old
        .and_then(|old| list(fields, "samplers").get(old as usize).cloned())
        .unwrap_or_else(|| Value::Object(Map::new()));
    sampler["input"] = input.into();
    sampler["output"] = output.into();
    sampler["interpolation"] = interpolation.into();
    let users = list(fields, "channels").iter().filter(|channel| channel["sampler"].as_u64() == old).count();
    let index = match old {
        Some(old) if users == 1 => {
            list(fields, "samplers")[old as usize] = sampler;
            old as usize
        }
        _ => {
            list(fields, "samplers").push(sampler);
            list(fields, "samplers").len() - 1
        }
    };
    match at {
        Some(at) => list(fields, "channels")[at]["sampler"] = index.into(),
        None => {
            list(fields, "channels").push(json!({ "sampler": index, "target": { "node": node, "path": path } }));
        }
    }
}

/// Divides the times of every sampler; a spline's tangents are a second, and grow.
fn play_faster(document: &Document, animation: &mut Value, speed: f64, keys: &mut Keys) -> Result<(), ExportError> {
    let fault = |reason: String| ExportError::Document { reason };
    let mut made: BTreeMap<usize, usize> = BTreeMap::new();
    let mut steeper: BTreeMap<usize, usize> = BTreeMap::new();
    let Some(fields) = animation.as_object_mut() else { return Ok(()) };
    for sampler in list(fields, "samplers") {
        let Some(input) = sampler["input"].as_u64().and_then(|input| usize::try_from(input).ok()) else { continue };
        let accessor = match made.get(&input) {
            Some(accessor) => *accessor,
            None => {
                let times = match input.checked_sub(keys.first) {
                    Some(own) => keys.numbers_of(own),
                    None => {
                        document
                            .read_f32s(input, "a clip's times")
                            .map_err(|error| fault(error.in_file("the document").to_string()))?
                            .values
                    }
                };
                let times: Vec<f32> = times.iter().map(|time| (f64::from(*time) / speed) as f32).collect();
                let accessor = keys.accessor("SCALAR", &times, 1);
                made.insert(input, accessor);
                accessor
            }
        };
        sampler["input"] = accessor.into();
        if sampler["interpolation"] != "CUBICSPLINE" {
            continue;
        }
        let Some(output) = sampler["output"].as_u64().and_then(|output| usize::try_from(output).ok()) else { continue };
        if let Some(accessor) = steeper.get(&output) {
            sampler["output"] = (*accessor).into();
            continue;
        }
        let (mut values, kind) = match output.checked_sub(keys.first) {
            Some(own) => (keys.numbers_of(own), keys.accessors[own]["type"].clone()),
            None => {
                let read = document
                    .read_f32s(output, "a clip's values")
                    .map_err(|error| fault(error.in_file("the document").to_string()))?;
                (read.values, document.json["accessors"][output]["type"].clone())
            }
        };
        let (kind, width) = match kind.as_str() {
            Some("VEC4") => ("VEC4", 4),
            Some("SCALAR") => ("SCALAR", 1),
            _ => ("VEC3", 3),
        };
        // In-tangent, value, out-tangent; of a scalar (weights) it is not said how many go together.
        if width > 1 {
            for key in values.chunks_mut(3 * width).filter(|key| key.len() == 3 * width) {
                let (before, rest) = key.split_at_mut(width);
                let after = &mut rest[width..];
                before.iter_mut().chain(after).for_each(|part| *part = (f64::from(*part) * speed) as f32);
            }
        }
        let accessor = keys.accessor(kind, &values, width);
        steeper.insert(output, accessor);
        sampler["output"] = accessor.into();
    }
    Ok(())
}

impl Keys {
    /// The numbers of an accessor that was appended.
    fn numbers_of(&self, own: usize) -> Vec<f32> {
        let accessor = &self.accessors[own];
        let at = self.start + accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
        let width = match accessor["type"].as_str() {
            Some("VEC4") => 4,
            Some("VEC3") => 3,
            _ => 1,
        };
        let count = width * accessor["count"].as_u64().unwrap_or(0) as usize;
        let bytes = self.buffer.bytes.get(at..at + 4 * count).unwrap_or(&[]);
        bytes.chunks_exact(4).map(|raw| f32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x over time of a spline with those keys: in-tangent, value, out-tangent.
    fn hermite(keys: &RawKeys, at: f64) -> f64 {
        let after = keys.times.partition_point(|key| f64::from(*key) <= at).clamp(1, keys.times.len() - 1);
        let (from, to) = (f64::from(keys.times[after - 1]), f64::from(keys.times[after]));
        let number = |key: usize, part: usize| f64::from(keys.numbers[key][3 * part]);
        let (seconds, t) = (to - from, ((at - from) / (to - from)).clamp(0.0, 1.0));
        let (t2, t3) = (t * t, t * t * t);
        number(after - 1, 1) * (2.0 * t3 - 3.0 * t2 + 1.0)
            + number(after - 1, 2) * seconds * (t3 - 2.0 * t2 + t)
            + number(after, 1) * (3.0 * t2 - 2.0 * t3)
            + number(after, 0) * seconds * (t3 - t2)
    }

    fn key(value: f32, tangent: f32) -> Vec<f32> {
        vec![tangent, 0.0, 0.0, value, 0.0, 0.0, tangent, 0.0, 0.0]
    }

    #[test]
    fn a_spline_that_is_changed_within_goes_on_as_it_was_outside() {
        let old = RawKeys {
            times: vec![0.0, 1.0, 2.0],
            numbers: vec![key(0.0, 1.0), key(2.0, -1.0), key(1.0, 0.5)],
            join: Join::CubicSpline,
        };
        let sample = |at: f64| DVec4::new(hermite(&old, at), 0.0, 0.0, 0.0);
        let time = |frame: usize| frame as f64 / 30.0;
        let frames: BTreeMap<usize, DVec4> = (22..=26).map(|frame| (frame, DVec4::new(9.0, 0.0, 0.0, 0.0))).collect();
        let new = curve(Some(old.clone()), &frames, &time, &sample, false);
        for step in 0..=2000 {
            let at = f64::from(step) * 1e-3;
            if !(time(21)..=time(27)).contains(&at) {
                let off = (hermite(&new, at) - hermite(&old, at)).abs();
                assert!(off < 2e-5, "{at} s: {off}");
            }
        }
        for frame in 22..=26 {
            assert!((hermite(&new, time(frame)) - 9.0).abs() < 1e-4);
        }
        for (index, at) in old.times.iter().enumerate() {
            let kept = new.times.iter().position(|time| time == at).expect("an old key outside stays");
            assert_eq!(new.numbers[kept], old.numbers[index]);
        }
    }

    #[test]
    fn straight_keys_of_which_few_are_left_keep_their_line_beside_the_change() {
        let value = |x: f32| vec![x, 0.0, 0.0];
        let old = RawKeys { times: vec![0.0, 2.0], numbers: vec![value(0.0), value(4.0)], join: Join::Linear };
        let sample = |at: f64| DVec4::new(2.0 * at.clamp(0.0, 2.0), 0.0, 0.0, 0.0);
        let frames = BTreeMap::from([(10, DVec4::new(-1.0, 0.0, 0.0, 0.0)), (60, DVec4::new(7.0, 0.0, 0.0, 0.0))]);
        let new = curve(Some(old), &frames, &|frame| frame as f64 / 30.0, &sample, false);
        let pairs: Vec<(i32, f32)> =
            new.times.iter().zip(&new.numbers).map(|(time, value)| ((time * 30.0).round() as i32, value[0])).collect();
        let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-5;
        assert_eq!(pairs.iter().map(|pair| pair.0).collect::<Vec<_>>(), [0, 9, 10, 11, 59, 60]);
        assert!(near(pairs[1].1, 0.6) && pairs[2].1 == -1.0 && near(pairs[3].1, 22.0 / 30.0) && pairs[5].1 == 7.0);
    }
}
