//! The built-in rig's bytes: one skinned mesh, a primitive a material over shared attributes, and its joints, as GLB.
//!
//! Positions are rounded to 0.01 mm before they become f32, so that a last bit of sine or cosine cannot change a byte.

use super::mannequin::Bone;
use super::mannequin_mesh::Surface;
use crate::maths::real;
use glam::DVec3;
use serde_json::{Map, Value, json};

/// Names, sRGB colours and roughness of the materials.
const MATERIALS: [(&str, [f64; 3], f64); 3] =
    [("body", [0.87, 0.62, 0.36], 0.62), ("joints", [0.20, 0.29, 0.42], 0.55), ("shoes", [0.27, 0.30, 0.36], 0.6)];

/// The file.
pub(super) fn glb(bones: &[Bone], surface: &Surface, mass: f64) -> Vec<u8> {
    let mut file = Buffer::default();
    let vertex_count = surface.positions.len();

    let places: Vec<DVec3> = surface.positions.iter().map(|place| grid(*place)).collect();
    let low = places.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = places.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let position = file.floats(places.iter().flat_map(|place| place.to_array()), "VEC3", vertex_count, 34962);
    file.accessors[position]["min"] = json!(single(low));
    file.accessors[position]["max"] = json!(single(high));
    let normals = surface.normals.iter().map(|normal| grid(*normal).normalize_or(DVec3::Y));
    let normal = file.floats(normals.flat_map(|normal| normal.to_array()), "VEC3", vertex_count, 34962);

    let mut joint_bytes = Vec::with_capacity(vertex_count * 4);
    let mut weight_bytes = Vec::with_capacity(vertex_count * 4);
    for shares in &surface.weights {
        let (joints, weights) = quantised(shares);
        joint_bytes.extend(joints);
        weight_bytes.extend(weights);
    }
    let joints = file.put(&joint_bytes, 5121, "VEC4", vertex_count, false, Some(34962));
    let weights = file.put(&weight_bytes, 5121, "VEC4", vertex_count, true, Some(34962));

    let primitives: Vec<Value> = surface
        .triangles
        .iter()
        .enumerate()
        .filter(|(_, triangles)| !triangles.is_empty())
        .map(|(material, triangles)| {
            let bytes: Vec<u8> = triangles.iter().flat_map(|index| (*index as u16).to_le_bytes()).collect();
            let indices = file.put(&bytes, 5123, "SCALAR", triangles.len(), false, Some(34963));
            json!({
                "attributes": { "POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights },
                "indices": indices,
                "material": material,
            })
        })
        .collect();
    let inverse_binds = bones.iter().flat_map(|bone| {
        let place = grid(bone.place);
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -place.x, -place.y, -place.z, 1.0]
    });
    let inverse_binds: Vec<f64> = inverse_binds.collect();
    let bytes: Vec<u8> = inverse_binds.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect();
    let binds = file.put(&bytes, 5126, "MAT4", bones.len(), false, None);

    let mut nodes: Vec<Value> = bones.iter().enumerate().map(|(index, bone)| node(bones, index, bone)).collect();
    nodes.push(json!({ "name": "mannequin", "mesh": 0, "skin": 0 }));
    let materials: Vec<Value> = MATERIALS
        .iter()
        .map(|(name, colour, roughness)| {
            let [red, green, blue] = colour.map(linear);
            json!({
                "name": name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [red, green, blue, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness,
                },
            })
        })
        .collect();
    let document = json!({
        "asset": { "version": "2.0", "generator": "surefoot" },
        "scene": 0,
        "scenes": [{
            "name": "mannequin",
            "nodes": [0, bones.len()],
            "extras": { "surefoot": { "mass_kg": (mass * 1e4).round() / 1e4 } },
        }],
        "nodes": nodes,
        "meshes": [{ "name": "mannequin", "primitives": primitives }],
        "skins": [{
            "name": "mannequin",
            "inverseBindMatrices": binds,
            "joints": (0..bones.len()).collect::<Vec<_>>(),
            "skeleton": 0,
        }],
        "materials": materials,
        "accessors": file.accessors,
        "bufferViews": file.views,
        "buffers": [{ "byteLength": file.bytes.len() }],
    });
    container(&document, &file.bytes)
}

/// A joint's node.
fn node(bones: &[Bone], index: usize, bone: &Bone) -> Value {
    let mut node = Map::new();
    node.insert("name".into(), json!(bone.name));
    let above = bone.parent.map_or(DVec3::ZERO, |parent| grid(bones[parent].place));
    let offset = grid(grid(bone.place) - above);
    if offset != DVec3::ZERO {
        node.insert("translation".into(), json!(offset.to_array()));
    }
    let children: Vec<usize> = (0..bones.len()).filter(|&child| bones[child].parent == Some(index)).collect();
    if !children.is_empty() {
        node.insert("children".into(), json!(children));
    }
    if !bone.limits.is_empty() {
        let limits: Map<String, Value> =
            bone.limits.iter().map(|(motion, from, to)| ((*motion).to_owned(), json!([from, to]))).collect();
        node.insert("extras".into(), json!({ "surefoot": { "limits_deg": limits } }));
    }
    Value::Object(node)
}

/// To 0.01 mm.
fn grid(place: DVec3) -> DVec3 {
    // Adding zero turns a negative zero into a plain one.
    (place * 1e5).round() / 1e5 + DVec3::ZERO
}

/// As a reader will see it: f32.
fn single(place: DVec3) -> [f64; 3] {
    place.to_array().map(|value| f64::from(value as f32))
}

/// sRGB to linear, to four places.
fn linear(value: f64) -> f64 {
    (real::powf((value + 0.055) / 1.055, 2.4) * 1e4).round() / 1e4
}

/// The four largest shares in 255ths that sum to 255.
fn quantised(shares: &[(usize, f64)]) -> ([u8; 4], [u8; 4]) {
    let mut sorted: Vec<(usize, f64)> = shares.to_vec();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    sorted.truncate(4);
    let sum: f64 = sorted.iter().map(|share| share.1).sum();
    let (mut joints, mut weights) = ([0u8; 4], [0u8; 4]);
    let mut left = 255i32;
    for (slot, (joint, share)) in sorted.iter().enumerate() {
        let weight = ((share / sum * 1e6).round() / 1e6 * 255.0).round() as i32;
        let weight = weight.min(left);
        if weight > 0 {
            joints[slot] = *joint as u8;
            weights[slot] = weight as u8;
            left -= weight;
        }
    }
    weights[0] += left as u8;
    (joints, weights)
}

/// The binary chunk as it grows, and what describes it.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn floats(&mut self, values: impl Iterator<Item = f64>, kind: &str, count: usize, target: u32) -> usize {
        let bytes: Vec<u8> = values.flat_map(|value| (value as f32).to_le_bytes()).collect();
        self.put(&bytes, 5126, kind, count, false, Some(target))
    }

    /// Adds a view and its accessor, whose index it returns.
    fn put(
        &mut self,
        bytes: &[u8],
        component: u32,
        kind: &str,
        count: usize,
        normalised: bool,
        target: Option<u32>,
    ) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(view);
        let mut accessor =
            json!({ "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind });
        if normalised {
            accessor["normalized"] = json!(true);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// The GLB around JSON and bytes.
fn container(document: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = Vec::with_capacity(28 + text.len() + binary.len());
    file.extend(b"glTF");
    file.extend(2u32.to_le_bytes());
    file.extend((28 + text.len() as u32 + binary.len() as u32).to_le_bytes());
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(text);
    file.extend((binary.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(binary);
    file
}
