//! Props as nodes: a mesh, a simple material, a place in the scene after everything of the source, and channels that move it.
//!
//! The document's units and axes come from the node (rotation and scale of the rig's similarity), so a mesh stays in metres of
//! scenario space. `extras.surefoot.prop` marks the node: the rig loader takes no body from it. Equal meshes and materials are
//! written once. Vertices and indices have buffer views of their own, as targets demand.

use super::ExportError;
use super::buffers::Joined;
use super::glb::list;
use crate::model::props::{Mesh, Prop, PropKey};
use crate::rig::Rig;
use glam::DVec3;
use serde_json::{Map, Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A channel in the making: path, accessor kind, times, values.
pub(super) struct PropChannel {
    pub(super) path: &'static str,
    pub(super) kind: &'static str,
    pub(super) times: Vec<f32>,
    pub(super) values: Vec<f32>,
}

/// Refuses what is not finite and triangles of corners that are not there.
pub(super) fn check(props: &[Prop]) -> Result<(), ExportError> {
    for prop in props {
        let fault = |time: f64| ExportError::NotFinite { clip: "props".into(), node: prop.name.clone(), time };
        let finite = |key: &PropKey| (key.translation + key.scale).is_finite() && key.rotation.is_finite();
        if let Some(key) = prop.keys.iter().find(|key| !finite(key) || !key.time.is_finite()) {
            return Err(fault(key.time));
        }
        let mesh = prop.shape.mesh();
        let whole = mesh.positions.len() == mesh.normals.len() && !mesh.indices.is_empty();
        let there = mesh.indices.iter().all(|index| (*index as usize) < mesh.positions.len());
        let finite = mesh.positions.iter().chain(&mesh.normals).all(|value| value.is_finite());
        if !whole || !there || !finite {
            return Err(fault(0.0));
        }
    }
    Ok(())
}

/// Appends the props: the indices of their nodes.
pub(super) fn add(rig: &Rig, props: &[Prop], root: &mut Map<String, Value>, buffer: &mut Joined) -> Vec<usize> {
    if props.is_empty() {
        return Vec::new();
    }
    let mut parts = Parts { views: list(root, "bufferViews").len(), ..Parts::default() };
    parts.first_accessor = list(root, "accessors").len();
    let mut meshes: Vec<(Mesh, [f32; 3], usize)> = Vec::new(); // shape, colour, index
    let mut nodes = Vec::new();
    for prop in props {
        let mesh = prop.shape.mesh();
        let found = meshes.iter().find(|(other, color, _)| *other == mesh && *color == prop.color);
        let index = match found {
            Some((_, _, index)) => *index,
            None => {
                let index = list(root, "meshes").len();
                let material = parts.material(root, prop);
                let primitive = parts.primitive(&mesh, material);
                list(root, "meshes").push(json!({ "name": prop.name, "primitives": [primitive] }));
                meshes.push((mesh, prop.color, index));
                index
            }
        };
        let mut node = json!({ "name": prop.name, "mesh": index, "extras": { "surefoot": { "prop": true } } });
        let key = prop.at(0.0);
        node["translation"] = json!(translation(rig, &key));
        node["rotation"] = json!(rotation(rig, &key));
        node["scale"] = json!(scale(rig, &key));
        nodes.push(list(root, "nodes").len());
        list(root, "nodes").push(node);
    }
    parts.write(root, buffer);
    place(rig, &nodes, root);
    nodes
}

/// The channels of a prop that moves: of each property that changes.
pub(super) fn channels(rig: &Rig, prop: &Prop) -> Vec<PropChannel> {
    // Keys that a file's 32 bits cannot tell apart are one; times rise from 0.
    let mut keys: Vec<(f32, PropKey)> = Vec::new();
    for key in &prop.keys {
        let time = key.time.max(0.0) as f32;
        if keys.last().is_none_or(|(last, _)| time > *last) {
            keys.push((time, *key));
        }
    }
    let mut channels = Vec::new();
    let mut add = |path, kind, values: Vec<Vec<f32>>| {
        if values.windows(2).any(|pair| pair[0] != pair[1]) {
            let times = keys.iter().map(|(time, _)| *time).collect();
            channels.push(PropChannel { path, kind, times, values: values.concat() });
        }
    };
    add("translation", "VEC3", keys.iter().map(|(_, key)| translation(rig, key).to_vec()).collect());
    let mut turns: Vec<Vec<f32>> = Vec::new();
    for (_, key) in &keys {
        let turn = rotation(rig, key).to_vec();
        let opposite = turns.last().is_some_and(|last| last.iter().zip(&turn).map(|(a, b)| a * b).sum::<f32>() < 0.0);
        turns.push(if opposite { turn.iter().map(|part| 0.0 - part).collect() } else { turn });
    }
    add("rotation", "VEC4", turns);
    add("scale", "VEC3", keys.iter().map(|(_, key)| scale(rig, key).to_vec()).collect());
    channels
}

fn translation(rig: &Rig, key: &PropKey) -> [f32; 3] {
    rig.document_from_scenario.point(key.translation).to_array().map(stored)
}

fn rotation(rig: &Rig, key: &PropKey) -> [f32; 4] {
    let turn = (rig.document_from_scenario.rotation * key.rotation).normalize();
    turn.to_array().map(stored)
}

fn scale(rig: &Rig, key: &PropKey) -> [f32; 3] {
    (key.scale * rig.document_from_scenario.scale).to_array().map(stored)
}

/// As a file stores it; never -0.
fn stored(value: f64) -> f32 {
    value as f32 + 0.0
}

/// Vertices, indices and their accessors, collected before they are written.
#[derive(Default)]
struct Parts {
    views: usize,
    first_accessor: usize,
    vertices: Vec<u8>,
    indices: Vec<u8>,
    accessors: Vec<Value>,
    materials: Vec<([f32; 3], usize)>,
}

impl Parts {
    fn material(&mut self, root: &mut Map<String, Value>, prop: &Prop) -> usize {
        if let Some((_, index)) = self.materials.iter().find(|(color, _)| *color == prop.color) {
            return *index;
        }
        let index = list(root, "materials").len();
        let [r, g, b] = prop.color.map(|part| part.clamp(0.0, 1.0));
        list(root, "materials").push(json!({
            "name": prop.name,
            "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9 },
        }));
        self.materials.push((prop.color, index));
        index
    }

    fn primitive(&mut self, mesh: &Mesh, material: usize) -> Value {
        let position = self.vectors(&mesh.positions, true);
        let normal = self.vectors(&mesh.normals, false);
        let offset = self.indices.len();
        self.indices.extend(mesh.indices.iter().flat_map(|index| index.to_le_bytes()));
        let indices = self.accessor(json!({
            "bufferView": self.views + 1, "byteOffset": offset, "componentType": UNSIGNED_INT,
            "count": mesh.indices.len(), "type": "SCALAR",
        }));
        json!({ "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices, "material": material })
    }

    fn vectors(&mut self, values: &[DVec3], bounds: bool) -> usize {
        let stored: Vec<[f32; 3]> = values.iter().map(|value| value.to_array().map(stored)).collect();
        let mut accessor = json!({
            "bufferView": self.views, "byteOffset": self.vertices.len(), "componentType": FLOAT,
            "count": values.len(), "type": "VEC3",
        });
        if bounds {
            let over = |fold: fn(f32, f32) -> f32, from: f32| {
                [0, 1, 2].map(|axis| f64::from(stored.iter().map(|value| value[axis]).fold(from, fold)))
            };
            accessor["min"] = json!(over(f32::min, f32::INFINITY));
            accessor["max"] = json!(over(f32::max, f32::NEG_INFINITY));
        }
        self.vertices.extend(stored.iter().flatten().flat_map(|part| part.to_le_bytes()));
        self.accessor(accessor)
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.first_accessor + self.accessors.len() - 1
    }

    fn write(mut self, root: &mut Map<String, Value>, buffer: &mut Joined) {
        let at = buffer.append(&self.vertices);
        list(root, "bufferViews").push(json!({
            "buffer": 0, "byteOffset": at, "byteLength": self.vertices.len(), "byteStride": 12, "target": ARRAY_BUFFER,
        }));
        let at = buffer.append(&self.indices);
        list(root, "bufferViews").push(json!({
            "buffer": 0, "byteOffset": at, "byteLength": self.indices.len(), "target": ELEMENT_ARRAY_BUFFER,
        }));
        list(root, "accessors").append(&mut self.accessors);
    }
}

/// The nodes join the scenes that show the character; the first scene where none does.
fn place(rig: &Rig, nodes: &[usize], root: &mut Map<String, Value>) {
    let roots: Vec<usize> = (0..rig.nodes.len()).filter(|node| rig.nodes[*node].parent.is_none()).collect();
    if list(root, "scenes").is_empty() {
        list(root, "scenes").push(json!({ "nodes": roots }));
        root.insert("scene".into(), 0.into());
    }
    let top = rig.scene_root(rig.hips_node());
    // A new Root stands in the character's place: it is the child that tells.
    let above: Vec<usize> = list(root, "nodes")
        .iter()
        .enumerate()
        .filter(|(_, node)| node["children"].as_array().is_some_and(|all| all.iter().any(|child| *child == top)))
        .map(|(index, _)| index)
        .collect();
    let shows = |scene: &Value| {
        let listed = scene["nodes"].as_array().into_iter().flatten().filter_map(Value::as_u64);
        listed.into_iter().any(|node| node == top as u64 || above.iter().any(|above| *above as u64 == node))
    };
    let scenes = list(root, "scenes");
    let mut joined: Vec<usize> = (0..scenes.len()).filter(|at| shows(&scenes[*at])).collect();
    if joined.is_empty() {
        joined.push(0);
    }
    for at in joined {
        if let Some(scene) = scenes[at].as_object_mut() {
            list(scene, "nodes").extend(nodes.iter().map(|node| Value::from(*node)));
        }
    }
}
