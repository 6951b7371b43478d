//! From a file to a [`Rig`]: the order in which the parts of this folder are asked.
//!
//! `load` reads the rig file, what it points to beside itself, and the override file `hero.bones.toml`; `load_bytes`
//! reads nothing but what it is given.

use super::body::{BodyInput, derive, stated_mass};
use super::document::{Resolve, read_file};
use super::nodes::globals;
use super::{
    Document, Mapping, MeshPart, Rig, RigError, RigNode, bind, fbx, images, mapping, mesh, nodes, overrides, space,
};
use crate::model::Role;
use std::collections::BTreeMap;
use std::path::Path;

/// Loads a rig from disk.
pub fn load(path: &Path) -> Result<Rig, RigError> {
    load_with(path, &BTreeMap::new())
}

/// The same, with a person's word on which node is which bone beyond what the override file says; `None` takes a bone away.
pub fn load_with(path: &Path, bones: &BTreeMap<Role, Option<usize>>) -> Result<Rig, RigError> {
    let file = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let bytes = read_file(path).map_err(|source| RigError::Io { file: file.clone(), source })?;
    let beside = overrides::file_name(&file);
    let text = match read_file(Path::new(&beside)) {
        Ok(bytes) => Some(String::from_utf8_lossy(&bytes).into_owned()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
        Err(source) => return Err(RigError::Io { file: beside, source }),
    };
    // Nodes by their index: their names are not read yet.
    let text = match (bones.is_empty(), overrides::with_bones(text.as_deref().unwrap_or_default(), bones, &[])) {
        (false, Ok(merged)) => Some(merged),
        _ => text,
    };
    load_bytes(&file, &bytes, &|relative| read_file(&folder.join(relative)), text.as_deref())
}

/// Loads a rig from memory. `name` stands for the file in messages; `resolve` reads what the document points to;
/// `overrides` is the text of the override file, if there is one.
pub fn load_bytes(name: &str, bytes: &[u8], resolve: &Resolve, overrides: Option<&str>) -> Result<Rig, RigError> {
    if fbx::is_fbx(name, bytes) {
        let (glb, notes) = fbx::to_glb(name, bytes, resolve)?;
        return load_document(Document::parse(name, &glb, resolve)?, name, notes, resolve, overrides);
    }
    let document = Document::parse(name, bytes, resolve)?;
    load_document(document, name, Vec::new(), resolve, overrides)
}

/// The same of a document; `warnings` were found on the way to it.
fn load_document(
    document: Document,
    name: &str,
    mut warnings: Vec<String>,
    resolve: &Resolve,
    overrides: Option<&str>,
) -> Result<Rig, RigError> {
    if document.list("extensionsUsed").iter().any(|used| used == "VRMC_vrm_animation") {
        let remedy = "give the .vrm (or .glb) of the character".into();
        return Err(RigError::WrongKind { file: name.into(), what: "is a VRM animation, not a rig".into(), remedy });
    }
    let mut nodes = nodes::read_nodes(&document).map_err(|fault| fault.in_file(name))?;
    let skins = bind::read_skins(&document, &nodes).map_err(|fault| fault.in_file(name))?;
    warnings.extend(bind::set_bind_pose(&mut nodes, &skins));
    let bind_globals = globals(&nodes, |node| node.bind);
    let (parts, notes) =
        mesh::read_parts(&document, &nodes, &skins, &bind_globals).map_err(|fault| fault.in_file(name))?;
    warnings.extend(notes);
    assemble(Parts { name, document, nodes, skins, parts, warnings, overrides }, resolve)
}

/// A rig of bare nodes: a skeleton from another kind of file, standing at its rest pose. `nodes` has `local` and `bind` alike;
/// `extensions` are those of its document, where they name bones by node.
pub fn skeleton(
    name: &str,
    nodes: Vec<RigNode>,
    extensions: Option<&serde_json::Value>,
    overrides: Option<&str>,
) -> Result<Rig, RigError> {
    let list: Vec<serde_json::Value> =
        nodes.iter().map(|node| serde_json::json!({ "name": node.name.as_deref().unwrap_or_default() })).collect();
    let mut json = serde_json::json!({ "asset": { "version": "2.0" }, "nodes": list });
    if let Some(extensions) = extensions {
        json["extensions"] = extensions.clone();
    }
    let document =
        Document { json, buffers: Vec::new(), glb_buffer: false, images: Vec::new(), image_files: Vec::new() };
    let nothing = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let bare = Parts { name, document, nodes, skins: Vec::new(), parts: Vec::new(), warnings: Vec::new(), overrides };
    assemble(bare, &nothing)
}

/// What a file was read into.
struct Parts<'a> {
    name: &'a str,
    document: Document,
    nodes: Vec<RigNode>,
    skins: Vec<bind::Skin>,
    parts: Vec<MeshPart>,
    warnings: Vec<String>,
    overrides: Option<&'a str>,
}

/// Finds the humanoid and its stance, and derives the body.
fn assemble(read: Parts, resolve: &Resolve) -> Result<Rig, RigError> {
    let Parts { name, mut document, nodes, skins, mut parts, mut warnings, overrides } = read;
    let bind_globals = globals(&nodes, |node| node.bind);
    let found = mapping::find(name, &document, &nodes, &skins, &bind_globals, overrides)?;
    warnings.extend(found.warnings);
    let mut bones = found.bones;
    let positions: Vec<_> = bind_globals.iter().map(|global| global.translation).collect();
    let stance = space::stance(&nodes, &bones, &positions, &parts, found.sides_known).ok_or_else(|| {
        let reason = "its limbs lie in one place".into();
        RigError::NotHumanoid { file: name.into(), reason, overrides: overrides::file_name(name) }
    })?;
    warnings.extend(stance.warnings);
    if stance.swapped {
        bones = bones.into_iter().map(|(role, node)| (role.mirrored(), node)).collect();
    }
    let similarity = stance.document_from_scenario;
    mesh::into_scenario(&mut parts, &similarity);
    let places: BTreeMap<Role, _> =
        bones.iter().map(|(role, node)| (*role, (*node, similarity.inverse_point(positions[*node])))).collect();
    let parents: Vec<Option<usize>> = nodes.iter().map(|node| node.parent).collect();
    let mass = stated_mass(&document.json);
    let derived = derive(&BodyInput { bones: &places, mesh: &parts, parents: &parents, mass });
    warnings.extend(derived.warnings);
    images::decode(&mut document, &parts, resolve);
    warnings.dedup();
    let mapping = Mapping {
        method: found.method,
        confidence: (found.confidence * stance.confidence * derived.confidence_factor).clamp(0.0, 1.0),
        bones,
        warnings,
        up: stance.up,
        forward: stance.forward,
    };
    Ok(Rig {
        document,
        nodes,
        body: derived.body,
        joint_nodes: derived.joint_nodes,
        document_from_scenario: similarity,
        mapping,
        mesh: parts,
        leg_scales: BTreeMap::new(),
    })
}
