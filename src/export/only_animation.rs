//! A GLB without what is drawn: its nodes, its skeletons and its clips, for the character that is in the scene already.
//!
//! Every node stays, at its index, with its name and its rest pose: programs bind by names or paths, and Blender lays a bone's axis by
//! its children, so that a skeleton with fewer nodes would be another one to it. Skins stay as lists of joints with their bind matrices,
//! because Blender and Godot make a skeleton of nothing else. Meshes, materials, images, cameras, lights, extensions and all clips but
//! the wanted ones go, and so do channels of morph targets. Values are written as floats, as they are read.

use super::ExportError;
use super::glb::container;
use crate::rig::{Document, Fault};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Of a node: what places it.
const OF_NODES: [&str; 7] = ["name", "children", "translation", "rotation", "scale", "matrix", "extras"];
/// Of a skin.
const OF_SKINS: [&str; 4] = ["name", "joints", "skeleton", "extras"];
/// Of the document.
const OF_ALL: [&str; 4] = ["asset", "extras", "scene", "scenes"];

/// The same file with the clips for which `keeps` says so (index, name), and without what is drawn.
pub fn only_animation(glb: &[u8], keeps: &dyn Fn(usize, &str) -> bool) -> Result<Vec<u8>, ExportError> {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let unread = |error: &dyn std::fmt::Display| ExportError::Document { reason: error.to_string() };
    let document = Document::parse("the file with the clip", glb, &alone).map_err(|error| unread(&error))?;
    stripped(&document, keeps).map_err(|fault| unread(&fault.in_file("the file with the clip")))?
}

fn stripped(document: &Document, keeps: &dyn Fn(usize, &str) -> bool) -> Result<Result<Vec<u8>, ExportError>, Fault> {
    let mut data = Data { document, bytes: Vec::new(), accessors: Vec::new(), known: BTreeMap::new() };
    let mut root = picked(&document.json, &OF_ALL);
    for scene in root.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        *scene = Value::Object(picked(scene, &["name", "nodes", "extras"]));
    }
    let nodes: Vec<Value> = document.list("nodes").iter().map(|node| picked(node, &OF_NODES).into()).collect();
    root.insert("nodes".into(), nodes.into());
    let mut skins = Vec::new();
    for (index, skin) in document.list("skins").iter().enumerate() {
        let mut kept = picked(skin, &OF_SKINS);
        if let Some(matrices) = skin.get("inverseBindMatrices") {
            kept.insert("inverseBindMatrices".into(), data.copied(matrices, &format!("skins[{index}]"), false)?.into());
        }
        skins.push(Value::Object(kept));
    }
    let mut animations = Vec::new();
    for (index, animation) in document.list("animations").iter().enumerate() {
        if keeps(index, animation["name"].as_str().unwrap_or_default()) {
            animations.push(animated(&mut data, animation, &format!("animations[{index}]"))?);
        }
    }
    for (name, list) in [("skins", skins), ("animations", animations), ("accessors", data.accessors)] {
        if !list.is_empty() {
            root.insert(name.into(), list.into());
        }
    }
    if !data.bytes.is_empty() {
        root.insert("bufferViews".into(), json!([{ "buffer": 0, "byteLength": data.bytes.len() }]));
        root.insert("buffers".into(), json!([{ "byteLength": data.bytes.len() }]));
    }
    Ok(container(&Value::Object(root), data.bytes))
}

/// A clip with the accessors that it reads.
fn animated(data: &mut Data, animation: &Value, place: &str) -> Result<Value, Fault> {
    let mut kept = picked(animation, &["name", "extras"]);
    let list = |name: &str| animation.get(name).and_then(Value::as_array).cloned().unwrap_or_default();
    let old = list("samplers");
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    for channel in list("channels") {
        let path = channel.pointer("/target/path").and_then(Value::as_str).unwrap_or_default();
        let sampler = channel["sampler"].as_u64().and_then(|sampler| old.get(usize::try_from(sampler).ok()?));
        let (Some(sampler), true) = (sampler, ["translation", "rotation", "scale"].contains(&path)) else { continue };
        let mut made = picked(sampler, &["interpolation"]);
        made.insert("input".into(), data.copied(&sampler["input"], place, true)?.into());
        made.insert("output".into(), data.copied(&sampler["output"], place, false)?.into());
        channels.push(json!({ "sampler": samplers.len(), "target": picked(&channel["target"], &["node", "path"]) }));
        samplers.push(Value::Object(made));
    }
    kept.insert("channels".into(), channels.into());
    kept.insert("samplers".into(), samplers.into());
    Ok(Value::Object(kept))
}

/// Those of an object's values that have these names, in its order.
fn picked(object: &Value, names: &[&str]) -> Map<String, Value> {
    let all = object.as_object().into_iter().flatten();
    all.filter(|(name, _)| names.contains(&name.as_str())).map(|(name, value)| (name.clone(), value.clone())).collect()
}

/// The buffer of the new file.
struct Data<'a> {
    document: &'a Document,
    bytes: Vec<u8>,
    accessors: Vec<Value>,
    known: BTreeMap<usize, usize>, // accessor of the document to that of the new file
}

impl Data<'_> {
    /// The new accessor with the values of that one.
    fn copied(&mut self, index: &Value, place: &str, times: bool) -> Result<usize, Fault> {
        let old = index.as_u64().and_then(|index| usize::try_from(index).ok());
        let old = old.ok_or_else(|| Fault::new(place, "names no accessor"))?;
        if let Some(known) = self.known.get(&old) {
            return Ok(*known);
        }
        let kind = self.document.entry("accessors", old, place)?["type"].clone();
        let values = self.document.read_f32s(old, place)?.values;
        let count = self.document.accessor_count(old, place)?;
        let mut accessor = json!({
            "bufferView": 0, "byteOffset": self.bytes.len(), "componentType": 5126, "count": count, "type": kind
        });
        if times {
            accessor["min"] = json!([f64::from(values.iter().copied().fold(f32::INFINITY, f32::min))]);
            accessor["max"] = json!([f64::from(values.iter().copied().fold(f32::NEG_INFINITY, f32::max))]);
        }
        self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        self.accessors.push(accessor);
        self.known.insert(old, self.accessors.len() - 1);
        Ok(self.accessors.len() - 1)
    }
}
