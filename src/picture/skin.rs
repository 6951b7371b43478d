//! A rig in a pose, as triangles in scenario space.
//!
//! A pose comes as local or global transforms of the document's nodes; [`transforms_of_locals`] and [`transforms_of_globals`]
//! turn them into what carries a point from the bind pose to the posed body, in metres. Linear blend skinning, as glTF has it. No morph targets.

use super::figure::figure;
use super::raster::Surface;
use crate::model::BodyPose;
use crate::rig::{MeshPart, Rig, Trs};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::borrow::Cow;

/// (nodes) scenario space: where the bind pose's points of each node go.
pub type NodeTransforms = Vec<DAffine3>;

/// What each node does to the points of the bind pose, from local transforms (document units). `root` is what a node over
/// all of the document's roots would add, in document space.
pub fn transforms_of_locals(rig: &Rig, locals: &[Trs], root: DAffine3) -> NodeTransforms {
    let scenario = document_from_scenario(rig).inverse();
    let posed: Vec<DAffine3> = globals(rig, locals).into_iter().map(|global| scenario * root * global).collect();
    transforms_of_globals(rig, &posed)
}

/// The same from global transforms, node to scenario space.
pub fn transforms_of_globals(rig: &Rig, posed: &[DAffine3]) -> NodeTransforms {
    let document = document_from_scenario(rig);
    let bind = globals(rig, &rig.nodes.iter().map(|node| node.bind).collect::<Vec<_>>());
    let transform = |(bind, posed): (&DAffine3, &DAffine3)| {
        // A node that the bind pose has squashed flat carries nothing that could be seen.
        let flat = bind.matrix3.determinant().abs() < 1e-12;
        if flat { DAffine3::IDENTITY } else { *posed * bind.inverse() * document }
    };
    bind.iter().zip(posed).map(transform).collect()
}

/// The bind pose.
pub fn bind_transforms(rig: &Rig) -> NodeTransforms {
    vec![DAffine3::IDENTITY; rig.nodes.len()]
}

fn document_from_scenario(rig: &Rig) -> DAffine3 {
    let similarity = &rig.document_from_scenario;
    DAffine3::from_scale_rotation_translation(
        DVec3::splat(similarity.scale),
        similarity.rotation,
        similarity.translation,
    )
}

/// Document-space transforms of all nodes; one that hangs in a ring of parents counts as a root.
fn globals(rig: &Rig, locals: &[Trs]) -> Vec<DAffine3> {
    let mut done: Vec<Option<DAffine3>> = vec![None; rig.nodes.len()];
    for node in 0..rig.nodes.len() {
        let mut chain = vec![node];
        while let Some(parent) = chain.last().and_then(|last| rig.nodes[*last].parent) {
            if parent >= rig.nodes.len() || chain.contains(&parent) || done[parent].is_some() {
                break;
            }
            chain.push(parent);
        }
        for node in chain.into_iter().rev() {
            if done[node].is_none() {
                let above = rig.nodes[node].parent.and_then(|parent| done.get(parent).copied().flatten());
                let local = locals.get(node).copied().unwrap_or(rig.nodes[node].local).affine();
                done[node] = Some(above.unwrap_or(DAffine3::IDENTITY) * local);
            }
        }
    }
    done.into_iter().map(|global| global.unwrap_or(DAffine3::IDENTITY)).collect()
}

/// The rig's mesh in that pose; a jointed figure where it has none.
pub fn surfaces<'a>(rig: &'a Rig, transforms: &NodeTransforms) -> Vec<Surface<'a>> {
    let drawn = rig.mesh.iter().filter(|part| !part.indices.is_empty());
    let parts: Vec<Surface> = drawn.map(|part| skin(rig, part, transforms)).collect();
    if parts.is_empty() { figure(&rig.body, &body_pose(rig, transforms)) } else { parts }
}

/// One mesh, posed.
pub fn skin<'a>(rig: &'a Rig, part: &'a MeshPart, transforms: &NodeTransforms) -> Surface<'a> {
    let smooth = part.normals.len() == part.positions.len();
    let mut positions = Vec::with_capacity(part.positions.len());
    let mut normals = Vec::with_capacity(if smooth { part.positions.len() } else { 0 });
    for (vertex, position) in part.positions.iter().enumerate() {
        let blended = blend(part.weights.get(vertex), transforms);
        positions.push(blended.transform_point3(*position));
        if smooth {
            normals.push(blended.transform_vector3(part.normals[vertex]).normalize_or_zero());
        }
    }
    let [red, green, blue, _] = part.base_color;
    let texture = part.base_texture.and_then(|index| rig.document.images.get(index)).and_then(Option::as_ref);
    Surface {
        positions,
        normals,
        uvs: Cow::Borrowed(&part.uvs),
        indices: Cow::Borrowed(&part.indices),
        color: [red, green, blue],
        texture,
    }
}

/// The weighted sum of what a vertex hangs on.
fn blend(weights: Option<&[(usize, f64); 4]>, transforms: &NodeTransforms) -> DAffine3 {
    let mut matrix = DMat3::ZERO;
    let mut translation = DVec3::ZERO;
    let mut sum = 0.0;
    for (node, weight) in weights.into_iter().flatten() {
        if let Some(transform) = transforms.get(*node).filter(|_| *weight > 0.0) {
            matrix += transform.matrix3 * *weight;
            translation += transform.translation * *weight;
            sum += weight;
        }
    }
    if sum <= 1e-9 {
        return DAffine3::IDENTITY;
    }
    DAffine3 { matrix3: matrix * (1.0 / sum), translation: translation / sum }
}

/// The body's pose as the nodes have it. A joint without a node turns with its parent.
pub fn body_pose(rig: &Rig, transforms: &NodeTransforms) -> BodyPose {
    let body = &rig.body;
    let mut pose = BodyPose::rest(body);
    for (index, joint) in body.joints.iter().enumerate() {
        let node = rig.joint_nodes.get(index).copied().flatten().and_then(|node| transforms.get(node));
        match node {
            Some(transform) => {
                let (_, turn, _) = transform.to_scale_rotation_translation();
                pose.turns[index] = if turn.is_finite() { turn.normalize() } else { DQuat::IDENTITY };
                if index == 0 {
                    pose.hips = transform.transform_point3(joint.rest);
                }
            }
            None => pose.turns[index] = joint.parent.map_or(DQuat::IDENTITY, |parent| pose.turns[parent]),
        }
    }
    pose
}
