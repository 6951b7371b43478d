//! The node that carries root motion as a joint of the skins: an engine whose skeletons are made of joints alone has no root bone else.
//!
//! Only on demand: it is the one thing that changes a source's skins. Joints keep their order and are appended to, so vertices keep
//! theirs; the inverse bind matrices get one more for each new joint, in their accessor's place where no other skin uses it. The nodes between the carrier
//! and the skin's topmost joints become joints too, that no bone hangs from what is none. No vertex has a weight there.

use super::ExportError;
use super::buffers::Joined;
use super::glb::list;
use crate::model::Target;
use crate::rig::nodes::globals;
use crate::rig::{Fault, Rig};
use glam::DAffine3;
use gltf::json::{Index, Skin};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Appends the carrier, at node `index` of the file, to the skins of the joints under it: what was changed, as sentences.
pub(super) fn add(
    rig: &Rig,
    carrier: Target,
    index: usize,
    root: &mut Map<String, Value>,
    buffer: &mut Joined,
) -> Result<Vec<String>, ExportError> {
    let bind = globals(&rig.nodes, |node| node.bind);
    let top = rig.new_root_children();
    // From a node up to the carrier: the nodes between; `None` where it is not under it.
    let between = |joint: usize| {
        let (mut path, mut at) = (Vec::new(), rig.nodes[joint].parent);
        let mut last = joint;
        while let Some(node) = at.filter(|node| carrier != Target::Node(*node)) {
            path.push(node);
            (last, at) = (node, rig.nodes[node].parent);
        }
        (at.is_some() || (carrier == Target::NewRoot && top.contains(&last))).then_some(path)
    };
    let mut changes = Vec::new();
    let skins = rig.document.list("skins").len();
    for skin in 0..skins {
        let read: Skin = rig.document.typed("skins", skin, "skins").map_err(unreadable)?;
        let joints: BTreeSet<usize> = read.joints.iter().map(Index::value).collect();
        let known = |joint: &usize| *joint < rig.nodes.len();
        let paths: Vec<Vec<usize>> = joints.iter().copied().filter(known).filter_map(between).collect();
        if paths.is_empty() || joints.contains(&index) {
            continue;
        }
        let mut new: Vec<(usize, DAffine3)> = vec![(
            index,
            match carrier {
                Target::Node(node) => bind[node],
                _ => DAffine3::IDENTITY,
            },
        )];
        let nodes: BTreeSet<usize> = paths.into_iter().flatten().filter(|node| !joints.contains(node)).collect();
        new.extend(nodes.into_iter().map(|node| (node, bind[node])));
        let matrices = matrices(rig, &read, &new)?;
        let Some(fields) = list(root, "skins").get_mut(skin).and_then(Value::as_object_mut) else { continue };
        list(fields, "joints").extend(new.iter().map(|(node, _)| Value::from(*node)));
        if fields.contains_key("skeleton") {
            fields.insert("skeleton".into(), index.into());
        }
        if let Some(matrices) = matrices {
            let count = matrices.len() / 16;
            let data: Vec<u8> = matrices.iter().flat_map(|part| part.to_le_bytes()).collect();
            let view = json!({ "buffer": 0, "byteOffset": buffer.append(&data), "byteLength": data.len() });
            let view = put(root, "bufferViews", own_view(rig, skin), view);
            let kind = json!({ "bufferView": view, "componentType": 5126, "count": count, "type": "MAT4" });
            let accessor = put(root, "accessors", own_accessor(rig, skin), kind);
            list(root, "skins")[skin]["inverseBindMatrices"] = accessor.into();
        }
        changes.push(format!("skin {skin}: {} joined it as a root bone for the engine", names(rig, carrier, &new)));
    }
    Ok(changes)
}

/// Puts a value at its place in a list, or at the end where it has none: which place that is.
fn put(root: &mut Map<String, Value>, name: &str, place: Option<usize>, value: Value) -> usize {
    let items = list(root, name);
    match place.filter(|place| *place < items.len()) {
        Some(place) => {
            items[place] = value;
            place
        }
        None => {
            items.push(value);
            items.len() - 1
        }
    }
}

/// The accessor of a skin's inverse bind matrices, if nothing else of the document uses it: left behind it would be unused.
fn own_accessor(rig: &Rig, skin: usize) -> Option<usize> {
    let skins = rig.document.list("skins");
    let accessor = skins.get(skin)?.get("inverseBindMatrices")?.as_u64()?;
    let users = skins.iter().filter(|skin| skin.get("inverseBindMatrices").and_then(Value::as_u64) == Some(accessor));
    (users.count() == 1).then_some(usize::try_from(accessor).ok()?)
}

/// The buffer view of that accessor, if no other accessor lies in it.
fn own_view(rig: &Rig, skin: usize) -> Option<usize> {
    let accessor = own_accessor(rig, skin)?;
    let accessors = rig.document.list("accessors");
    let view = accessors.get(accessor)?.get("bufferView")?.as_u64()?;
    let uses = |accessor: &&Value| {
        let places = ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"];
        places.iter().any(|place| accessor.pointer(place).and_then(Value::as_u64) == Some(view))
    };
    let images = rig.document.list("images").iter().any(|image| image["bufferView"].as_u64() == Some(view));
    let alone = accessors.iter().filter(uses).count() == 1 && !images;
    alone.then_some(usize::try_from(view).ok()?)
}

/// The skin's inverse bind matrices and those of the new joints; `None` where it has none, which is the identity for all.
fn matrices(rig: &Rig, skin: &Skin, new: &[(usize, DAffine3)]) -> Result<Option<Vec<f32>>, ExportError> {
    let Some(accessor) = skin.inverse_bind_matrices else { return Ok(None) };
    let mut values = rig.document.read_f32s(accessor.value(), "skins").map_err(unreadable)?.values;
    for (_, bind) in new {
        let inverse = glam::DMat4::from(bind.inverse()).to_cols_array();
        values.extend(inverse.map(|part| if part.is_finite() { part as f32 + 0.0 } else { 0.0 }));
    }
    Ok(Some(values))
}

fn unreadable(fault: Fault) -> ExportError {
    ExportError::Document { reason: fault.in_file("the rig").to_string() }
}

fn names(rig: &Rig, carrier: Target, new: &[(usize, DAffine3)]) -> String {
    let name = |(at, (node, _)): (usize, &(usize, DAffine3))| match (at, carrier) {
        (0, Target::NewRoot) => "Root".to_owned(),
        _ => rig.nodes.get(*node).and_then(|node| node.name.clone()).unwrap_or_else(|| format!("node {node}")),
    };
    new.iter().enumerate().map(name).collect::<Vec<_>>().join(", ")
}
