//! Meshes of an FBX as glTF meshes and skins: triangles by material, vertices with position, normal, texture coordinates, four weights.

use super::{Buffer, affine};
use glam::{DAffine3, DVec3};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use ufbx::{Mesh, Node, Scene, SkinDeformer};

/// Coordinates beyond this (m) are a broken file.
const FARTHEST: f64 = 1e6;
/// Corners of all faces of a file.
const MOST_CORNERS: usize = 1 << 25;

/// The lists of a document.
#[derive(Default)]
pub struct Drawn {
    /// One a node that draws something.
    pub meshes: Vec<Value>,
    /// One a node that draws something skinned.
    pub skins: Vec<Value>,
}

/// Adds what every node draws: `mesh` and `skin` of the nodes in `list`, and the lists.
pub fn add(
    scene: &Scene,
    kept: &[usize],
    places: &[Option<usize>],
    list: &mut [Value],
    out: &mut Buffer,
    notes: &mut Vec<String>,
) -> Drawn {
    let mut drawn = Drawn::default();
    let (mut corners, mut shapes, mut beyond, mut skins) = (0_usize, 0, 0, 0);
    for (place, node) in kept.iter().enumerate() {
        let node: &Node = &scene.nodes[*node];
        let Some(mesh) = node.mesh.as_deref().filter(|mesh| mesh.num_triangles > 0) else { continue };
        corners = corners.saturating_add(mesh.num_indices);
        if corners > MOST_CORNERS {
            notes.push("its meshes are too large: some were not read".into());
            break;
        }
        let placed = placed(node);
        let skin = mesh.skin_deformers.first().and_then(|skin| Skin::read(skin, places, &placed));
        let placed = if skin.is_some() { placed } else { DAffine3::IDENTITY };
        shapes += mesh.blend_deformers.count;
        skins += mesh.skin_deformers.count.saturating_sub(1);
        let primitives = primitives(node, (mesh, &placed), skin.as_ref(), out);
        if primitives.is_empty() {
            continue;
        }
        list[place]["mesh"] = drawn.meshes.len().into();
        drawn.meshes.push(json!({ "name": &*node.element.name, "primitives": primitives }));
        if let Some(skin) = skin {
            beyond += skin.beyond;
            if let Some(fields) = list[place].as_object_mut().filter(|fields| !fields.contains_key("children")) {
                // The joints place the mesh, not the node.
                fields.retain(|field, _| !["translation", "rotation", "scale"].contains(&field.as_str()));
            }
            list[place]["skin"] = drawn.skins.len().into();
            let binds = out.push(&skin.binds, "MAT4", false);
            drawn.skins.push(json!({ "joints": skin.joints, "inverseBindMatrices": binds }));
        }
    }
    if shapes > 0 {
        notes.push("blend shapes of its meshes are left out".into());
    }
    if beyond > 0 {
        notes.push(format!("{beyond} vertices have more than 4 weights: the 4 largest are kept"));
    }
    if skins > 0 {
        notes.push("meshes with several skins keep the first".into());
    }
    drawn
}

/// Where a node draws its mesh at rest: vertices of skinned meshes are stored there, in the document's world.
fn placed(node: &Node) -> DAffine3 {
    let placed = affine(&node.geometry_to_world);
    let sound = placed.is_finite() && placed.inverse().is_finite();
    if sound { placed } else { DAffine3::IDENTITY }
}

/// A skin as glTF has it.
struct Skin {
    /// Nodes of the document.
    joints: Vec<usize>,
    /// One a joint, column by column: from the mesh to the joint.
    binds: Vec<[f32; 16]>,
    /// (vertices of the mesh) joints and their weights, which sum to 1.
    weights: Vec<([u32; 4], [f32; 4])>,
    /// Vertices that had more than four.
    beyond: usize,
}

impl Skin {
    fn read(skin: &SkinDeformer, places: &[Option<usize>], placed: &DAffine3) -> Option<Skin> {
        let (mut joints, mut binds): (Vec<usize>, Vec<[f32; 16]>) = Default::default();
        let mut of_cluster: Vec<Option<usize>> = Vec::with_capacity(skin.clusters.count);
        for cluster in &skin.clusters {
            let node = cluster.bone_node.as_ref().and_then(|bone| *places.get(bone.element.typed_id as usize)?);
            let bind = affine(&cluster.geometry_to_bone) * placed.inverse();
            of_cluster.push(node.filter(|_| bind.is_finite()).map(|node| {
                let bind = glam::DMat4::from(bind).to_cols_array().map(|number| number as f32);
                joints.push(node);
                binds.push(bind);
                joints.len() - 1
            }));
        }
        if joints.is_empty() {
            return None;
        }
        let mut beyond = 0;
        let weights = skin.vertices.iter().map(|vertex| {
            let first = vertex.weight_begin as usize;
            let all = (first..first + vertex.num_weights as usize).filter_map(|at| skin.weights.get(at));
            let mut shares: Vec<(f64, usize)> = all
                .filter_map(|share| Some((share.weight, (*of_cluster.get(share.cluster_index as usize)?)?)))
                .filter(|(weight, _)| *weight > 0.0 && weight.is_finite())
                .collect();
            shares.sort_by(|(one, a), (other, b)| other.total_cmp(one).then(a.cmp(b)));
            beyond += usize::from(shares.len() > 4);
            shares.truncate(4);
            let sum: f64 = shares.iter().map(|(weight, _)| weight).sum();
            let mut kept = ([0; 4], [0.0; 4]);
            for (at, (weight, joint)) in shares.into_iter().enumerate() {
                (kept.0[at], kept.1[at]) = (joint as u32, (weight / sum) as f32);
            }
            if sum <= 0.0 {
                kept.1[0] = 1.0; // bound to nothing: it goes with the first joint
            }
            kept
        });
        let weights = weights.collect();
        Some(Skin { joints, binds, weights, beyond })
    }
}

/// Vertices of a primitive, each corner that differs once.
#[derive(Default)]
struct Vertices {
    seen: BTreeMap<[u32; 4], u32>,
    places: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    joints: Vec<u32>,
    weights: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

/// A primitive a material that the mesh uses.
fn primitives(node: &Node, (mesh, placed): (&Mesh, &DAffine3), skin: Option<&Skin>, out: &mut Buffer) -> Vec<Value> {
    let materials = mesh.materials.count.max(1);
    let mut parts: Vec<Vertices> = (0..materials).map(|_| Vertices::default()).collect();
    let mut triangles = vec![0_u32; mesh.max_face_triangles.saturating_mul(3)];
    for (index, face) in mesh.faces.iter().enumerate() {
        if face.num_indices < 3 {
            continue;
        }
        let part = mesh.face_material.get(index).map_or(0, |part| *part as usize).min(materials - 1);
        let count = 3 * ufbx::triangulate_face(&mut triangles, mesh, *face) as usize;
        for triangle in triangles[..count.min(triangles.len())].chunks_exact(3) {
            let corners: Vec<u32> = triangle
                .iter()
                .filter_map(|corner| parts[part].corner((mesh, placed), skin, *corner as usize))
                .collect();
            if corners.len() == 3 {
                parts[part].indices.extend(corners);
            }
        }
    }
    let mut list = Vec::new();
    for (index, part) in parts.into_iter().enumerate().filter(|(_, part)| !part.indices.is_empty()) {
        let mut attributes = json!({ "POSITION": out.positions(&part.places) });
        if part.normals.len() == part.places.len() {
            attributes["NORMAL"] = out.push(&part.normals, "VEC3", false).into();
        }
        if part.uvs.len() == part.places.len() {
            attributes["TEXCOORD_0"] = out.push(&part.uvs, "VEC2", false).into();
        }
        if skin.is_some() {
            attributes["JOINTS_0"] = out.whole(&part.joints, "VEC4").into();
            attributes["WEIGHTS_0"] = out.push(&part.weights, "VEC4", false).into();
        }
        let mut primitive = json!({ "attributes": attributes, "indices": out.whole(&part.indices, "SCALAR") });
        let material = node.materials.get(index).or_else(|| mesh.materials.get(index));
        if let Some(material) = material {
            primitive["material"] = material.element.typed_id.into();
        }
        list.push(primitive);
    }
    list
}

impl Vertices {
    /// The vertex of a corner of a face; `None` where its place is none.
    fn corner(&mut self, (mesh, placed): (&Mesh, &DAffine3), skin: Option<&Skin>, corner: usize) -> Option<u32> {
        let index = |exists: bool, indices: &[u32]| match exists {
            true => indices.get(corner).copied().unwrap_or(u32::MAX),
            false => u32::MAX,
        };
        let key = [
            *mesh.vertex_indices.get(corner)?,
            index(mesh.vertex_position.exists, &mesh.vertex_position.indices),
            index(mesh.vertex_normal.exists, &mesh.vertex_normal.indices),
            index(mesh.vertex_uv.exists, &mesh.vertex_uv.indices),
        ];
        if let Some(vertex) = self.seen.get(&key) {
            return Some(*vertex);
        }
        let place = mesh.vertex_position.values.get(key[1] as usize)?;
        let place = placed.transform_point3(DVec3::new(place.x, place.y, place.z));
        if !place.is_finite() || place.abs().max_element() > FARTHEST {
            return None;
        }
        let weights = match skin {
            Some(skin) => Some(skin.weights.get(key[0] as usize)?),
            None => None,
        };
        let vertex = self.places.len() as u32;
        self.places.push(place.as_vec3().to_array());
        if let Some(normal) = mesh.vertex_normal.values.get(key[2] as usize) {
            let turned = placed.matrix3.inverse().transpose() * DVec3::new(normal.x, normal.y, normal.z);
            let normal = turned.normalize_or(DVec3::Y);
            self.normals.push(normal.as_vec3().to_array());
        }
        if let Some(uv) = mesh.vertex_uv.values.get(key[3] as usize) {
            self.uvs.push([uv.x as f32, 1.0 - uv.y as f32]); // glTF counts from the top
        }
        if let Some((joints, shares)) = weights {
            self.joints.extend(joints);
            self.weights.push(*shares);
        }
        self.seen.insert(key, vertex);
        Some(vertex)
    }
}
