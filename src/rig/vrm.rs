//! The humanoid that a VRM file declares: `VRMC_vrm` (1.0), `VRM` (0.x), and of an animation `VRMC_vrm_animation`.
//! Sources: the VRM specifications.

use super::document::as_index;
use super::{Document, Fault};
use crate::model::Role;
use serde_json::Value;
use std::collections::BTreeMap;

/// A declared humanoid.
#[derive(Clone, Debug, PartialEq)]
pub struct Declared {
    /// "vrm1", "vrm0" or "vrma".
    pub method: &'static str,
    /// Role to node.
    pub bones: BTreeMap<Role, usize>,
    /// Entries that make no sense.
    pub warnings: Vec<String>,
}

/// The humanoid of the VRM extension, if the document has one.
pub fn declared(document: &Document) -> Result<Option<Declared>, Fault> {
    let extensions = document.json.get("extensions");
    let human = |name: &str| {
        extensions.and_then(|all| all.get(name)).and_then(|vrm| vrm.get("humanoid")).and_then(|it| it.get("humanBones"))
    };
    for (extension, method) in [("VRMC_vrm", "vrm1"), ("VRMC_vrm_animation", "vrma")] {
        let Some(bones) = human(extension) else { continue };
        let place = || format!("extensions.{extension}.humanoid.humanBones");
        let list = bones.as_object().ok_or_else(|| Fault::new(place(), "must be an object of bone names"))?;
        let entries = list.iter().map(|(name, bone)| (name.as_str(), bone.get("node"), name.clone()));
        return Ok(Some(collect(document, method, entries)));
    }
    let Some(bones) = human("VRM") else { return Ok(None) };
    let place = "extensions.VRM.humanoid.humanBones";
    let list = bones.as_array().ok_or_else(|| Fault::new(place, "must be an array of { bone, node }"))?;
    let entries = list.iter().enumerate().map(|(at, entry)| {
        let name = entry.get("bone").and_then(Value::as_str).unwrap_or("");
        (modern(name), entry.get("node"), format!("{place}[{at}]"))
    });
    Ok(Some(collect(document, "vrm0", entries)))
}

fn collect<'a>(
    document: &Document,
    method: &'static str,
    entries: impl Iterator<Item = (&'a str, Option<&'a Value>, String)>,
) -> Declared {
    let count = document.list("nodes").len();
    let mut declared = Declared { method, bones: BTreeMap::new(), warnings: Vec::new() };
    let mut odd = 0;
    for (name, node, place) in entries {
        let Some(role) = Role::from_name(name) else {
            odd += 1;
            continue;
        };
        match node.and_then(as_index) {
            Some(node) if node < count && !declared.bones.values().any(|other| *other == node) => {
                declared.bones.entry(role).or_insert(node);
            }
            Some(node) if node < count => {
                declared.warnings.push(format!("VRM: {} names node {node}, which another bone has", role.name()));
            }
            // VRM 0.x writes -1 for a bone that is not there.
            _ if node.and_then(Value::as_i64) == Some(-1) => {}
            _ => declared.warnings.push(format!("VRM: {place}: {} names no node of the file", role.name())),
        }
    }
    if odd > 0 {
        declared.warnings.push(format!("VRM: {odd} humanBones have names that VRM does not know"));
    }
    declared.warnings.truncate(8);
    declared
}

/// The VRM 1.0 name of a VRM 0.x bone: the thumb moved by one.
fn modern(name: &str) -> &str {
    match name {
        "leftThumbProximal" => "leftThumbMetacarpal",
        "leftThumbIntermediate" => "leftThumbProximal",
        "rightThumbProximal" => "rightThumbMetacarpal",
        "rightThumbIntermediate" => "rightThumbProximal",
        other => other,
    }
}
