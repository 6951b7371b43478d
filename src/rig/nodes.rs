//! The node hierarchy: local transforms, parents, globals. Document units; checked for cycles and second parents.

use super::{Document, Fault, RigNode, Trs};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde_json::Value;

/// Coordinates beyond this (document units) are a broken file.
const FARTHEST: f64 = 1e7;

/// The nodes of the document, `bind` as `local`.
pub fn read_nodes(document: &Document) -> Result<Vec<RigNode>, Fault> {
    let list = document.list("nodes");
    let mut nodes = Vec::with_capacity(list.len());
    for (index, json) in list.iter().enumerate() {
        let place = format!("nodes[{index}]");
        let node: gltf::json::Node = document.typed("nodes", index, &place)?;
        let local = local(json, &place)?;
        nodes.push(RigNode {
            children: children(&node, list.len(), &place)?,
            name: node.name,
            parent: None,
            local,
            bind: local,
            has_matrix: json.get("matrix").is_some(),
            mesh: node.mesh.map(|mesh| mesh.value()),
            skin: node.skin.map(|skin| skin.value()),
        });
    }
    for parent in 0..nodes.len() {
        for at in 0..nodes[parent].children.len() {
            let child = nodes[parent].children[at];
            if let Some(other) = nodes[child].parent {
                let what = format!("{child} is a child of nodes[{other}] already: a node has one parent");
                return Err(Fault::new(format!("nodes[{parent}].children[{at}]"), what));
            }
            nodes[child].parent = Some(parent);
        }
    }
    let order = order(&nodes);
    if order.len() < nodes.len() {
        let mut seen = vec![false; nodes.len()];
        order.iter().for_each(|node| seen[*node] = true);
        let node = seen.iter().position(|seen| !seen).unwrap_or(0);
        return Err(Fault::new(format!("nodes[{node}].children"), "the node is its own descendant"));
    }
    let globals = globals(&nodes, |node| node.local);
    match globals.iter().position(|global| !(global.is_finite() && global.translation.length() < FARTHEST)) {
        Some(node) => Err(Fault::new(format!("nodes[{node}]"), "its place in the world is beyond any sense")),
        None => Ok(nodes),
    }
}

/// Every node, parents before children; nodes of a cycle are left out.
pub fn order(nodes: &[RigNode]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..nodes.len()).filter(|index| nodes[*index].parent.is_none()).collect();
    let mut at = 0;
    while at < order.len() {
        order.extend(&nodes[order[at]].children);
        at += 1;
    }
    order
}

/// World transforms of the pose that `pose` picks from each node.
pub fn globals(nodes: &[RigNode], pose: impl Fn(&RigNode) -> Trs) -> Vec<DAffine3> {
    let mut globals = vec![DAffine3::IDENTITY; nodes.len()];
    for index in order(nodes) {
        let parent = nodes[index].parent.map_or(DAffine3::IDENTITY, |parent| globals[parent]);
        globals[index] = parent * pose(&nodes[index]).affine();
    }
    globals
}

/// Whether `ancestor` is `node` or above it.
pub fn is_under(nodes: &[RigNode], node: usize, ancestor: usize) -> bool {
    let mut at = Some(node);
    while let Some(index) = at {
        if index == ancestor {
            return true;
        }
        at = nodes[index].parent;
    }
    false
}

/// An affine transform as T * R * S; a shear is lost.
pub fn decompose(affine: &DAffine3) -> Trs {
    let columns = [affine.matrix3.x_axis, affine.matrix3.y_axis, affine.matrix3.z_axis];
    if columns.iter().any(|column| column.length() < 1e-12) {
        let scale = DVec3::new(columns[0].length(), columns[1].length(), columns[2].length());
        return Trs { translation: affine.translation, rotation: DQuat::IDENTITY, scale };
    }
    let (scale, rotation, translation) = affine.to_scale_rotation_translation();
    let rotation =
        if rotation.is_finite() && rotation.length() > 1e-6 { rotation.normalize() } else { DQuat::IDENTITY };
    Trs { translation, rotation, scale }
}

fn children(node: &gltf::json::Node, count: usize, place: &str) -> Result<Vec<usize>, Fault> {
    let children = node.children.iter().flatten().map(gltf::json::Index::value).enumerate();
    children
        .map(|(at, child)| match child {
            child if child < count => Ok(child),
            _ => Err(Fault::new(format!("{place}.children[{at}]"), format!("is no node: there are {count}"))),
        })
        .collect()
}

/// In f64, as the file has it: the crate's f32 would change the rest pose in the last bits.
fn local(json: &Value, place: &str) -> Result<Trs, Fault> {
    if let Some(matrix) = numbers::<16>(json, "matrix", place)? {
        let affine = DAffine3::from_mat4(DMat4::from_cols_array(&matrix));
        return Ok(decompose(&affine));
    }
    let translation = numbers::<3>(json, "translation", place)?.map_or(DVec3::ZERO, DVec3::from_array);
    let scale = numbers::<3>(json, "scale", place)?.map_or(DVec3::ONE, DVec3::from_array);
    let rotation = numbers::<4>(json, "rotation", place)?.map_or(DQuat::IDENTITY, DQuat::from_array);
    let length = rotation.length();
    if !(0.5..2.0).contains(&length) {
        return Err(Fault::new(format!("{place}.rotation"), "must be a unit quaternion [x, y, z, w]"));
    }
    // A unit quaternion written as f32 stays as it is, so that what is not animated is not changed.
    let rotation = if (length - 1.0).abs() < 1e-9 { rotation } else { rotation.normalize() };
    Ok(Trs { translation, rotation, scale })
}

fn numbers<const N: usize>(json: &Value, field: &str, place: &str) -> Result<Option<[f64; N]>, Fault> {
    let Some(value) = json.get(field) else { return Ok(None) };
    let fault = || Fault::new(format!("{place}.{field}"), format!("must be {N} finite numbers"));
    let list = value.as_array().filter(|list| list.len() == N).ok_or_else(fault)?;
    let mut numbers = [0.0; N];
    for (number, value) in numbers.iter_mut().zip(list) {
        *number = value.as_f64().filter(|number| number.is_finite() && number.abs() < 1e12).ok_or_else(fault)?;
    }
    Ok(Some(numbers))
}

/// How many nodes stand above that one.
pub fn depth(nodes: &[RigNode], node: usize) -> usize {
    std::iter::successors(nodes[node].parent, |parent| nodes[*parent].parent).count()
}
