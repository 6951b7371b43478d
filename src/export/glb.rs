//! A rig and its clips as one GLB: the source document whole, the clips appended.
//!
//! Every JSON value of the source stays at its index and its buffer bytes are a prefix of the new buffer. What else changes:
//! `buffers` becomes one (see `buffers`), scene roots may get a `Root` above them, one node may get two helper children, scenes
//! may get props, and a `matrix` that must move becomes translation, rotation and scale, because glTF animates nothing else; the last is reported.
//! Document units. The same input gives the same bytes.

use super::buffers::Joined;
use super::held::{self, Held};
use super::props::{self, PropChannel};
use super::{ExportError, events::report_json, root_joint};
use crate::model::{Channel, Clip, ClipReport, Interpolation, KeyValues, Prop, Target};
use crate::rig::Rig;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// A file in the making is done.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedGlb {
    /// The file.
    pub bytes: Vec<u8>,
    /// The names that the clips got, in order.
    pub names: Vec<String>,
    /// What had to change in the source's own values, as sentences.
    pub changes: Vec<String>,
}

/// The bytes of a GLB that holds the rig's document and the clips.
pub fn glb(rig: &Rig, clips: &[(Clip, ClipReport)]) -> Result<ExportedGlb, ExportError> {
    glb_with_props(rig, clips, &[])
}

/// The same with things beside the body, which move as they say in every clip.
pub fn glb_with_props(rig: &Rig, clips: &[(Clip, ClipReport)], props: &[Prop]) -> Result<ExportedGlb, ExportError> {
    glb_with_root(rig, clips, props, None)
}

/// The same with the node that carries root motion as a joint of the skins: see [`super::root_joint`].
pub fn glb_with_root(
    rig: &Rig,
    clips: &[(Clip, ClipReport)],
    props: &[Prop],
    carrier: Option<Target>,
) -> Result<ExportedGlb, ExportError> {
    for (clip, _) in clips {
        check(rig, clip)?;
    }
    props::check(props)?;
    let mut root = rig
        .document
        .json
        .as_object()
        .cloned()
        .ok_or_else(|| ExportError::Document { reason: "it is no JSON object".into() })?;
    let mut buffer = Joined::new(&rig.document, &mut root)?;
    buffer.embed_images(&rig.document, &mut root);
    let mut changes = matrices_to_trs(rig, clips, &mut root);
    let targets: BTreeSet<Target> =
        clips.iter().flat_map(|(clip, _)| &clip.channels).map(|channel| channel.target).collect();
    let helpers = add_nodes(rig, &targets, &mut root);
    let joint = carrier.and_then(|carrier| match carrier {
        Target::Node(node) => Some((carrier, node)),
        new => helpers.get(&new).map(|node| (new, *node)),
    });
    if let Some((carrier, node)) = joint {
        changes.extend(root_joint::add(rig, carrier, node, &mut root, &mut buffer)?);
    }
    let props: Vec<(usize, Vec<PropChannel>)> = props::add(rig, props, &mut root, &mut buffer)
        .into_iter()
        .zip(props)
        .map(|(node, prop)| (node, props::channels(rig, prop)))
        .collect();
    let mut writer = Writer { buffer, view: 0, start: 0, accessors: Vec::new(), seen: BTreeMap::new() };
    writer.view = list(&mut root, "bufferViews").len();
    writer.start = writer.buffer.append(&[]);
    let first_accessor = list(&mut root, "accessors").len();
    let moved = held::moved(clips, &helpers, &root);
    let mut names = Vec::new();
    for (clip, report) in clips {
        let name = free_name(&clip.name, list(&mut root, "animations"));
        let mut animation = writer.animation(clip, &helpers, &props, first_accessor, &moved);
        animation.insert("name".into(), name.clone().into());
        animation.insert("extras".into(), json!({ "surefoot": report_json(&name, report)? }));
        list(&mut root, "animations").push(Value::Object(animation));
        names.push(name);
    }
    let length = writer.buffer.bytes.len() - writer.start;
    if length > 0 {
        list(&mut root, "bufferViews").push(json!({ "buffer": 0, "byteOffset": writer.start, "byteLength": length }));
    }
    list(&mut root, "accessors").append(&mut writer.accessors);
    for name in ["bufferViews", "accessors", "animations"] {
        if list(&mut root, name).is_empty() {
            root.shift_remove(name);
        }
    }
    let bytes = writer.buffer.bytes;
    if bytes.is_empty() {
        root.shift_remove("buffers");
    } else {
        list(&mut root, "buffers")[0]["byteLength"] = bytes.len().into();
    }
    Ok(ExportedGlb { bytes: container(&Value::Object(root), bytes)?, names, changes })
}

/// The array of that name, made where there is none.
pub(super) fn list<'a>(root: &'a mut Map<String, Value>, name: &str) -> &'a mut Vec<Value> {
    let value = root.entry(name).or_insert_with(|| Value::Array(Vec::new()));
    if !value.is_array() {
        *value = Value::Array(Vec::new());
    }
    match value {
        Value::Array(items) => items,
        _ => unreachable!("made an array above"),
    }
}

/// Header, JSON chunk padded with spaces, BIN chunk padded with zeros.
pub(super) fn container(json: &Value, mut bin: Vec<u8>) -> Result<Vec<u8>, ExportError> {
    let mut text = serde_json::to_vec(json).map_err(|error| ExportError::Json { reason: error.to_string() })?;
    text.resize(text.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let total = 12 + 8 + text.len() + if bin.is_empty() { 0 } else { 8 + bin.len() };
    let size = |bytes: usize| u32::try_from(bytes).map_err(|_| ExportError::TooLarge { bytes: total });
    let mut file = Vec::with_capacity(total);
    file.extend_from_slice(b"glTF");
    file.extend_from_slice(&2u32.to_le_bytes());
    file.extend_from_slice(&size(total)?.to_le_bytes());
    file.extend_from_slice(&size(text.len())?.to_le_bytes());
    file.extend_from_slice(b"JSON");
    file.append(&mut text);
    if !bin.is_empty() {
        file.extend_from_slice(&size(bin.len())?.to_le_bytes());
        file.extend_from_slice(b"BIN\0");
        file.append(&mut bin);
    }
    Ok(file)
}

struct Writer {
    buffer: Joined,
    view: usize,
    start: usize,
    accessors: Vec<Value>,
    seen: BTreeMap<(&'static str, Vec<u8>), usize>, // equal data is written once
}

impl Writer {
    fn animation(
        &mut self,
        clip: &Clip,
        helpers: &BTreeMap<Target, usize>,
        props: &[(usize, Vec<PropChannel>)],
        first: usize,
        moved: &[Held],
    ) -> Map<String, Value> {
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        let mut add = |node: usize, path: &str, input: usize, output: usize, interpolation: Option<&str>| {
            channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
            let mut sampler = json!({ "input": input, "output": output });
            if let Some(interpolation) = interpolation {
                sampler["interpolation"] = interpolation.into();
            }
            samplers.push(sampler);
        };
        for channel in &clip.channels {
            let node = match channel.target {
                Target::Node(node) => node,
                helper => helpers[&helper],
            };
            let (kind, values): (_, Vec<f32>) = match &channel.values {
                KeyValues::Translation(keys) | KeyValues::Scale(keys) => {
                    ("VEC3", keys.iter().flatten().copied().collect())
                }
                KeyValues::Rotation(keys) => ("VEC4", keys.iter().flatten().copied().collect()),
            };
            let path = channel.values.path();
            let stays = channel.times.len() == 1 && clip.duration as f32 > channel.times[0];
            let (times, values) = match stays {
                true => (vec![channel.times[0], clip.duration as f32], values.repeat(2)),
                false => (channel.times.clone(), values),
            };
            let count = channel.values.count() * times.len() / channel.times.len();
            let input = first + self.accessor("SCALAR", &times, 1);
            let output = first + self.accessor(kind, &values, count);
            let interpolation = match channel.interpolation {
                Interpolation::Linear => None, // what glTF takes where none is said
                Interpolation::Cubic => Some("CUBICSPLINE"),
                Interpolation::Step => Some("STEP"),
            };
            add(node, path, input, output, interpolation);
        }
        for (node, channel) in props.iter().flat_map(|(node, channels)| channels.iter().map(move |one| (*node, one))) {
            let input = first + self.accessor("SCALAR", &channel.times, 1);
            let output = first + self.accessor(channel.kind, &channel.values, channel.times.len());
            add(node, channel.path, input, output, None);
        }
        let has = |held: &&Held| {
            clip.channels.iter().any(|channel| {
                let node = if let Target::Node(node) = channel.target { node } else { helpers[&channel.target] };
                (node, channel.values.path()) == (held.node, held.path)
            })
        };
        for held in moved.iter().filter(|held| !has(held)) {
            let times = if clip.duration > 0.0 { vec![0.0, clip.duration as f32] } else { vec![0.0] };
            let input = first + self.accessor("SCALAR", &times, 1);
            let output = first + self.accessor(held.kind, &held.values.repeat(times.len()), times.len() * held.count());
            add(held.node, held.path, input, output, None);
        }
        Map::from_iter([("channels".to_owned(), channels.into()), ("samplers".to_owned(), samplers.into())])
    }

    fn accessor(&mut self, kind: &'static str, values: &[f32], count: usize) -> usize {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let mut fields = json!({ "componentType": 5126, "count": count, "type": kind });
        let key = if kind == "SCALAR" && count > 1 { "weights" } else { kind };
        if key == "SCALAR" {
            fields["count"] = values.len().into();
            fields["min"] = json!([f64::from(values.iter().copied().fold(f32::INFINITY, f32::min))]);
            fields["max"] = json!([f64::from(values.iter().copied().fold(f32::NEG_INFINITY, f32::max))]);
        }
        if let Some(accessor) = self.seen.get(&(key, data.clone())) {
            return *accessor;
        }
        let offset = self.buffer.append(&data) - self.start;
        let mut accessor = json!({ "bufferView": self.view, "byteOffset": offset });
        if let (Some(accessor), Value::Object(fields)) = (accessor.as_object_mut(), fields) {
            accessor.extend(fields);
        }
        self.accessors.push(accessor);
        self.seen.insert((key, data), self.accessors.len() - 1);
        self.accessors.len() - 1
    }
}

/// Refuses what no reader could play: numbers that are none, times that do not rise, nodes that are not there.
pub(super) fn check(rig: &Rig, clip: &Clip) -> Result<(), ExportError> {
    let mut seen = BTreeSet::new();
    for channel in &clip.channels {
        let rotates = matches!(channel.values, KeyValues::Rotation(_));
        let node = describe(rig, channel, rotates);
        let fault =
            |reason: &str| ExportError::Keys { clip: clip.name.clone(), node: node.clone(), reason: reason.to_owned() };
        let values: Vec<&[f32]> = match &channel.values {
            KeyValues::Translation(keys) | KeyValues::Scale(keys) => keys.iter().map(<[f32; 3]>::as_slice).collect(),
            KeyValues::Rotation(keys) => keys.iter().map(<[f32; 4]>::as_slice).collect(),
        };
        if let Target::Node(index) = channel.target
            && index >= rig.nodes.len()
        {
            return Err(fault("the document has no such node"));
        }
        if !seen.insert((channel.target, channel.values.path())) {
            return Err(fault("two channels drive the same property"));
        }
        if !channel.is_whole() {
            return Err(fault("there must be as many values as times, and one at least"));
        }
        let stride = channel.interpolation.stride();
        for (time, key) in channel.times.iter().zip(values.chunks_exact(stride)) {
            if !time.is_finite() || key.iter().any(|value| value.iter().any(|part| !part.is_finite())) {
                return Err(ExportError::NotFinite { clip: clip.name.clone(), node, time: f64::from(*time) });
            }
            let value = key[stride / 2];
            if rotates && (value.iter().map(|part| part * part).sum::<f32>() - 1.0).abs() > 1e-3 {
                return Err(fault("a rotation is no unit quaternion"));
            }
        }
        if channel.times[0] < 0.0 || channel.times.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(fault("times must rise from 0"));
        }
    }
    Ok(())
}

fn describe(rig: &Rig, channel: &Channel, rotates: bool) -> String {
    let path = if rotates { "rotation" } else { "translation" };
    match channel.target {
        Target::Node(index) => match rig.nodes.get(index).and_then(|node| node.name.as_deref()) {
            Some(name) => format!("{path} of node {index} \"{name}\""),
            None => format!("{path} of node {index}"),
        },
        Target::NewRoot => format!("{path} of the new Root"),
        Target::ContactLeft => format!("{path} of contact_L"),
        Target::ContactRight => format!("{path} of contact_R"),
    }
}

/// A node that moves may not have a matrix.
fn matrices_to_trs(rig: &Rig, clips: &[(Clip, ClipReport)], root: &mut Map<String, Value>) -> Vec<String> {
    let moved: BTreeSet<usize> = clips
        .iter()
        .flat_map(|(clip, _)| &clip.channels)
        .filter_map(|channel| if let Target::Node(node) = channel.target { Some(node) } else { None })
        .filter(|node| rig.nodes[*node].has_matrix)
        .collect();
    let mut changes = Vec::new();
    for node in moved {
        let Some(fields) = list(root, "nodes").get_mut(node).and_then(Value::as_object_mut) else { continue };
        fields.shift_remove("matrix");
        let local = rig.nodes[node].local;
        fields.insert("translation".into(), json!(local.translation.to_array()));
        fields.insert("rotation".into(), json!(local.rotation.normalize().to_array()));
        fields.insert("scale".into(), json!(local.scale.to_array()));
        let name = rig.nodes[node].name.as_deref().unwrap_or("unnamed");
        changes.push(format!(
            "node {node} ({name}): its matrix became translation, rotation and scale, so that it can move"
        ));
    }
    changes
}

/// Appends the nodes that the clips drive and the document lacks: their indices.
fn add_nodes(rig: &Rig, targets: &BTreeSet<Target>, root: &mut Map<String, Value>) -> BTreeMap<Target, usize> {
    let free = list(root, "nodes").len();
    let new = targets.iter().filter(|target| !matches!(target, Target::Node(_)));
    let added: BTreeMap<Target, usize> = new.zip(free..).map(|(target, node)| (*target, node)).collect();
    if added.is_empty() {
        return added;
    }
    if list(root, "scenes").is_empty() {
        let roots: Vec<usize> = (0..rig.nodes.len()).filter(|node| rig.nodes[*node].parent.is_none()).collect();
        list(root, "scenes").push(json!({ "nodes": roots }));
        root.insert("scene".into(), 0.into());
    }
    let helpers: Vec<usize> =
        added.iter().filter(|(target, _)| **target != Target::NewRoot).map(|(_, node)| *node).collect();
    let top = rig.scene_root(rig.hips_node());
    for target in added.keys() {
        let node = match target {
            Target::NewRoot => {
                let children: Vec<usize> = rig.new_root_children().into_iter().chain(helpers.iter().copied()).collect();
                json!({ "name": "Root", "children": children })
            }
            Target::ContactLeft => json!({ "name": "contact_L" }),
            _ => json!({ "name": "contact_R" }),
        };
        list(root, "nodes").push(node);
    }
    if let Some(new_root) = added.get(&Target::NewRoot) {
        let moved = rig.new_root_children();
        for scene in list(root, "scenes") {
            let Some(nodes) = scene.get_mut("nodes").and_then(Value::as_array_mut) else { continue };
            let is_moved =
                |node: &Value| node.as_u64().is_some_and(|node| moved.iter().any(|moved| *moved as u64 == node));
            let Some(place) = nodes.iter().position(is_moved) else { continue };
            nodes.retain(|node| !is_moved(node));
            nodes.insert(place.min(nodes.len()), (*new_root).into());
        }
    } else if top == rig.hips_node() {
        // Nothing above the hips: the helpers stand beside them in the scene.
        for scene in list(root, "scenes") {
            let Some(nodes) = scene.get_mut("nodes").and_then(Value::as_array_mut) else { continue };
            if nodes.iter().any(|node| node.as_u64() == Some(top as u64)) {
                nodes.extend(helpers.iter().map(|node| Value::from(*node)));
            }
        }
    } else if let Some(fields) = list(root, "nodes")[top].as_object_mut() {
        list(fields, "children").extend(helpers.into_iter().map(Value::from));
    }
    added
}

/// The name, with a number where it is taken.
fn free_name(wanted: &str, animations: &[Value]) -> String {
    let taken = |name: &str| animations.iter().any(|animation| animation["name"] == name);
    if !taken(wanted) {
        return wanted.to_owned();
    }
    (2..).map(|number| format!("{wanted}_{number}")).find(|name| !taken(name)).expect("numbers do not run out")
}
