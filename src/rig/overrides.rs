//! `hero.bones.toml` beside `hero.glb`: a person's word on which node is which bone.
//!
//! ```toml
//! [bones]
//! leftFoot = "foot_l"   # a node's name, or its index
//! jaw = ""              # "" takes a bone away
//! ```

use super::{RigError, RigNode};
use crate::model::Role;
use std::collections::BTreeMap;

/// The file that belongs to a rig of that name: `hero.glb` -> `hero.bones.toml`.
pub fn file_name(rig: &str) -> String {
    let stem = match rig.rsplit_once('.') {
        Some((stem, tail)) if !stem.is_empty() && !tail.contains(['/', '\\']) => stem,
        _ => rig,
    };
    format!("{stem}.bones.toml")
}

/// Role to node, or to nothing where the file takes a bone away.
pub fn read(file: &str, text: &str, nodes: &[RigNode]) -> Result<BTreeMap<Role, Option<usize>>, RigError> {
    let fault = |key: &str, what: String| RigError::Override { file: file.into(), key: key.into(), what };
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| fault("TOML", error.to_string()))?;
    if let Some(key) = table.keys().find(|key| *key != "bones") {
        return Err(fault(key, "is not known here: a bones file has one table, [bones]".into()));
    }
    let Some(bones) = table.get("bones") else { return Ok(BTreeMap::new()) };
    let bones = bones.as_table().ok_or_else(|| fault("bones", "must be a table: [bones]".into()))?;
    let mut found = BTreeMap::new();
    let mut taken: BTreeMap<usize, &str> = BTreeMap::new();
    for (key, value) in bones {
        let place = format!("bones.{key}");
        let role = Role::from_name(key)
            .ok_or_else(|| fault(&place, format!("is no bone; {} (VRM 1.0 names, case matters)", nearest_role(key))))?;
        let node = node(value, nodes).map_err(|what| fault(&place, what))?;
        if let Some(node) = node
            && let Some(other) = taken.insert(node, key)
        {
            return Err(fault(&place, format!("names the node that bones.{other} names")));
        }
        found.insert(role, node);
    }
    Ok(found)
}

/// The file's text with those bones said anew. `Err`: the text is not TOML; whoever reads it says what is wrong with it.
pub fn with_bones(
    text: &str,
    bones: &BTreeMap<Role, Option<usize>>,
    nodes: &[RigNode],
) -> Result<String, toml::de::Error> {
    let mut table: toml::Table = text.parse()?;
    let told = table.entry("bones").or_insert_with(|| toml::Table::new().into());
    if let Some(told) = told.as_table_mut() {
        for (role, node) in bones {
            told.insert(role.name().to_owned(), node.map_or_else(|| String::new().into(), |node| said(node, nodes)));
        }
    }
    Ok(table.to_string())
}

/// A node by its name where that is its own, else by its index.
fn said(node: usize, nodes: &[RigNode]) -> toml::Value {
    let name = nodes.get(node).and_then(|node| node.name.as_deref()).filter(|name| !name.is_empty());
    match name {
        Some(name) if nodes.iter().filter(|other| other.name.as_deref() == Some(name)).count() == 1 => name.into(),
        _ => toml::Value::Integer(node as i64),
    }
}

fn node(value: &toml::Value, nodes: &[RigNode]) -> Result<Option<usize>, String> {
    match value {
        toml::Value::Integer(index) => match usize::try_from(*index) {
            Ok(index) if index < nodes.len() => Ok(Some(index)),
            _ => Err(format!("node {index} is not there: the file has {} nodes, from 0", nodes.len())),
        },
        toml::Value::String(name) if name.is_empty() => Ok(None),
        toml::Value::String(name) => {
            let same: Vec<usize> =
                (0..nodes.len()).filter(|index| nodes[*index].name.as_deref() == Some(name)).collect();
            match same.as_slice() {
                [node] => Ok(Some(*node)),
                [] => Err(format!("no node is named \"{name}\"{}", nearest_node(name, nodes))),
                several => {
                    Err(format!("{} nodes are named \"{name}\": give an index, one of {several:?}", several.len()))
                }
            }
        }
        _ => Err("must be a node's name or index".into()),
    }
}

fn nearest_role(key: &str) -> String {
    let wanted = super::names::canonical(key);
    match Role::ALL.iter().find(|role| role.name().to_lowercase() == wanted) {
        Some(role) => format!("did you mean {}?", role.name()),
        None => "known are hips, spine, chest, neck, head, leftUpperArm, leftLowerArm, leftHand, leftUpperLeg, leftLowerLeg, leftFoot, leftToes and so on".into(),
    }
}

fn nearest_node(name: &str, nodes: &[RigNode]) -> String {
    let wanted = super::names::canonical(name);
    let alike =
        nodes.iter().filter_map(|node| node.name.as_deref()).find(|other| super::names::canonical(other) == wanted);
    alike.map_or(String::new(), |other| format!("; did you mean \"{other}\"?"))
}
