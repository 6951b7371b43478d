//! Triangles of the document at the bind pose, with weights by node. Document world until `into_scenario` moves them.
//!
//! Every node that draws a mesh gives a part a primitive; a skinned mesh is skinned here once, a rigid one hangs on its
//! node. Draws neither points nor lines, and no morph targets. A part that is broken is an error; a document with more
//! vertices than a rig has is cut off with a warning.

use super::bind::Skin;
use super::{Document, Fault, MeshPart, RigNode, Similarity};
use glam::{DAffine3, DVec2, DVec3};
use gltf::json::mesh::Primitive;
use gltf::json::validation::Checked;
use gltf::json::{Index, Material, Mesh, Texture};
use gltf::mesh::{Mode, Semantic};
use serde_json::Value;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Vertices read at most, over all parts; a guard against files that draw one mesh ten thousand times.
const MOST_VERTICES: usize = 1_500_000;
/// Corners of triangles, over all parts.
const MOST_CORNERS: usize = 9_000_000;
/// Parts.
const MOST_PARTS: usize = 20_000;

/// One weight: node and share.
type Weights = [(usize, f64); 4];

/// All parts in document space, and warnings. `bind` are the bind globals of the nodes.
pub fn read_parts(
    document: &Document,
    nodes: &[RigNode],
    skins: &[Skin],
    bind: &[DAffine3],
) -> Result<(Vec<MeshPart>, Vec<String>), Fault> {
    let (mut parts, mut warnings) = (Vec::new(), Vec::new());
    let (mut vertices, mut corners, mut primitives_seen, mut broken) = (0_usize, 0_usize, 0, 0);
    let mut meshes: BTreeMap<usize, Mesh> = BTreeMap::new(); // that many nodes may draw
    for (index, (node, json)) in nodes.iter().zip(document.list("nodes")).enumerate() {
        let Some(mesh) = node.mesh else { continue };
        if json.pointer("/extras/surefoot/prop") == Some(&Value::Bool(true)) {
            continue; // a thing that a bake put beside the body
        }
        let skin = node.skin.and_then(|skin| skins.get(skin));
        if let Entry::Vacant(vacant) = meshes.entry(mesh) {
            vacant.insert(document.typed("meshes", mesh, &format!("nodes[{index}].mesh"))?);
        }
        for (at, primitive) in meshes[&mesh].primitives.iter().enumerate() {
            let Some(position) = attribute(primitive, Semantic::Positions) else { continue };
            let place = format!("meshes[{mesh}].primitives[{at}]");
            vertices = vertices.saturating_add(document.accessor_count(position, &place)?);
            if let Some(indices) = primitive.indices {
                corners = corners.saturating_add(document.accessor_count(indices.value(), &place)?);
            }
            primitives_seen += 1;
            if vertices > MOST_VERTICES || corners > MOST_CORNERS || primitives_seen > MOST_PARTS {
                warnings.push("the mesh is too large: only the beginning of it was looked at".into());
                return Ok((parts, warnings));
            }
            match read_part(document, primitive, &place, index, skin, nodes.len(), bind)? {
                Some(part) if part.positions.iter().all(|point| point.is_finite() && point.length() < 1e9) => {
                    parts.push(part);
                }
                Some(_) => broken += 1,
                None => {}
            }
        }
    }
    if broken > 0 {
        warnings.push(format!("{broken} mesh parts have vertices that are not finite and were left out"));
    }
    Ok((parts, warnings))
}

/// Moves the parts into scenario space.
pub fn into_scenario(parts: &mut [MeshPart], document_from_scenario: &Similarity) {
    let turn = document_from_scenario.rotation.inverse();
    for part in parts {
        for point in &mut part.positions {
            *point = document_from_scenario.inverse_point(*point);
        }
        for normal in &mut part.normals {
            *normal = turn * *normal;
        }
    }
}

/// The accessor of an attribute.
pub fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&Checked::Valid(semantic)).map(Index::value)
}

fn read_part(
    document: &Document,
    primitive: &Primitive,
    place: &str,
    node: usize,
    skin: Option<&Skin>,
    node_count: usize,
    bind: &[DAffine3],
) -> Result<Option<MeshPart>, Fault> {
    let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = primitive.mode else {
        return Ok(None);
    };
    let Some(positions) = attribute(primitive, Semantic::Positions) else { return Ok(None) };
    let mut part = MeshPart { positions: vec3s(document, positions, place)?, ..MeshPart::default() };
    let count = part.positions.len();
    let corners = match primitive.indices {
        Some(accessor) => document.read_indices(accessor.value(), &format!("{place}.indices"))?,
        None => (0..count as u32).collect(),
    };
    if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
        return Err(Fault::new(format!("{place}.indices"), format!("{corner} lies beyond the {count} vertices")));
    }
    part.indices = triangles(corners, mode);
    let whole = |accessor: usize| Ok(document.accessor_count(accessor, place)? == count);
    if let Some(accessor) = attribute(primitive, Semantic::Normals)
        && whole(accessor)?
    {
        part.normals = vec3s(document, accessor, place)?;
    }
    if let Some(accessor) = attribute(primitive, Semantic::TexCoords(0))
        && whole(accessor)?
    {
        let uvs = document.read_f32s(accessor, place)?;
        if uvs.width == 2 {
            part.uvs = uvs.values.chunks_exact(2).map(|uv| DVec2::new(uv[0].into(), uv[1].into())).collect();
        }
    }
    if part.normals.len() != count || part.normals.iter().any(|normal| !normal.is_finite()) {
        part.normals.clear();
    }
    if part.uvs.len() != count {
        part.uvs.clear();
    }
    match (skin, attribute(primitive, Semantic::Joints(0)), attribute(primitive, Semantic::Weights(0))) {
        (Some(skin), Some(joints), Some(weights)) => {
            if !whole(joints)? || !whole(weights)? {
                return Err(Fault::new(
                    format!("{place}.attributes"),
                    "JOINTS_0 and WEIGHTS_0 must be VEC4, one a vertex",
                ));
            }
            let joints = document.read_indices(joints, &format!("{place}.attributes.JOINTS_0"))?;
            let weights = document.read_f32s(weights, &format!("{place}.attributes.WEIGHTS_0"))?;
            if joints.len() != count * 4 || weights.values.len() != count * 4 {
                return Err(Fault::new(
                    format!("{place}.attributes"),
                    "JOINTS_0 and WEIGHTS_0 must be VEC4, one a vertex",
                ));
            }
            skin_part(&mut part, skin, &joints, &weights.values, bind)
                .map_err(|joint| beyond(place, joint, skin.joints.len()))?;
        }
        _ => {
            part.weights = vec![[(node, 1.0), (node, 0.0), (node, 0.0), (node, 0.0)]; count];
            let normal_turn = bind[node].matrix3.inverse().transpose();
            for point in &mut part.positions {
                *point = bind[node].transform_point3(*point);
            }
            for normal in &mut part.normals {
                *normal = (normal_turn * *normal).normalize_or_zero();
            }
        }
    }
    debug_assert!(part.weights.iter().flatten().all(|(node, _)| *node < node_count), "weights name nodes");
    colour(document, primitive, &mut part);
    Ok(Some(part))
}

fn beyond(place: &str, joint: u32, count: usize) -> Fault {
    Fault::new(format!("{place}.attributes.JOINTS_0"), format!("{joint} lies beyond the skin's {count} joints"))
}

/// Poses the vertices and names their nodes; the joint that does not exist, if there is one.
fn skin_part(part: &mut MeshPart, skin: &Skin, joints: &[u32], shares: &[f32], bind: &[DAffine3]) -> Result<(), u32> {
    let moves: Vec<DAffine3> = (0..skin.joints.len())
        .map(|at| bind[skin.joints[at]] * skin.inverse_binds.get(at).copied().unwrap_or(DAffine3::IDENTITY))
        .collect();
    let first = skin.joints.first().copied().ok_or(0_u32)?;
    part.weights.reserve(part.positions.len());
    for vertex in 0..part.positions.len() {
        let mut weights: Weights = [(first, 0.0); 4];
        let (mut point, mut normal, mut sum) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for corner in 0..4 {
            let share = f64::from(shares[vertex * 4 + corner]);
            if !(share > 0.0 && share.is_finite()) {
                continue;
            }
            let joint = joints[vertex * 4 + corner];
            let at = joint as usize;
            let node = *skin.joints.get(at).ok_or(joint)?;
            weights[corner] = (node, share);
            sum += share;
            point += moves[at].transform_point3(part.positions[vertex]) * share;
            if let Some(rest) = part.normals.get(vertex) {
                normal += moves[at].transform_vector3(*rest) * share;
            }
        }
        if sum > 0.0 {
            weights.iter_mut().for_each(|weight| weight.1 /= sum);
            part.positions[vertex] = point / sum;
        } else {
            weights[0].1 = 1.0;
            part.positions[vertex] = moves[0].transform_point3(part.positions[vertex]);
        }
        if let Some(rest) = part.normals.get_mut(vertex) {
            *rest = normal.normalize_or_zero();
        }
        part.weights.push(weights);
    }
    Ok(())
}

/// The vectors of a VEC3 accessor.
pub fn vec3s(document: &Document, accessor: usize, place: &str) -> Result<Vec<DVec3>, Fault> {
    let floats = document.read_f32s(accessor, place)?;
    if floats.width != 3 {
        return Err(Fault::new(format!("accessors[{accessor}].type"), format!("must be VEC3 for {place}")));
    }
    Ok(floats.values.chunks_exact(3).map(|xyz| DVec3::new(xyz[0].into(), xyz[1].into(), xyz[2].into())).collect())
}

/// Lists, strips and fans as a list.
pub(super) fn triangles(mut corners: Vec<u32>, mode: Mode) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => (2..corners.len())
            .flat_map(|at| if at % 2 == 0 { [at - 2, at - 1, at] } else { [at - 1, at - 2, at] })
            .map(|at| corners[at])
            .collect(),
        Mode::TriangleFan => (2..corners.len()).flat_map(|at| [corners[0], corners[at - 1], corners[at]]).collect(),
        _ => {
            corners.truncate(corners.len() - corners.len() % 3);
            corners
        }
    }
}

/// Base colour and its image; what is not there, or cannot be read, is white.
fn colour(document: &Document, primitive: &Primitive, part: &mut MeshPart) {
    part.base_color = [1.0; 4];
    let material =
        primitive.material.and_then(|at| document.typed::<Material>("materials", at.value(), "material").ok());
    let Some(material) = material.map(|material| material.pbr_metallic_roughness) else { return };
    part.base_color = material.base_color_factor.0.map(|factor| factor.clamp(0.0, 1.0));
    let texture = material.base_color_texture.map(|info| info.index.value());
    let texture = texture.and_then(|index| document.typed::<Texture>("textures", index, "texture").ok());
    part.base_texture = texture.map(|texture| texture.source.value()).filter(|image| *image < document.images.len());
}
