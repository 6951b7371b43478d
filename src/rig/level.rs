//! A glTF file as the ground of a scenario: its triangles as they stand in the file's own world, metres, Y up, nothing else of it.
//!
//! The file's world is scenario space: the character starts at its origin and walks towards +Z; transforms of nodes apply. Read are the
//! nodes of the file's scene (all nodes where it has none), lists, strips and fans of triangles; of a double-sided material both sides.
//! Skins, morph targets, animations and instancing extensions change nothing.

use super::document::Resolve;
use super::entry::read;
use super::mesh::{attribute, triangles, vec3s};
use super::nodes::{globals, read_nodes};
use super::{Document, Fault, RigError};
use crate::model::Surface;
use glam::{DAffine3, DVec3};
use gltf::json::mesh::Primitive;
use gltf::json::validation::Checked;
use gltf::json::{Mesh, Scene};
use gltf::mesh::{Mode, Semantic};
use serde_json::Value;

/// Triangles that are read at most: ten times a large level's collision mesh, some 300 MB.
const MOST_TRIANGLES: usize = 2_000_000;
/// m, farther from end to end no level is: a file in centimetres or millimetres.
const LARGEST: f64 = 3000.0;
/// m, and none is smaller: nobody could stand on it.
const SMALLEST: f64 = 0.1;

/// The ground in those bytes; `file` is its name in messages, `resolve` reads the files beside it.
pub fn level(file: &str, bytes: &[u8], resolve: &Resolve) -> Result<Surface, RigError> {
    let lower = file.to_lowercase();
    if !lower.ends_with(".glb") && !lower.ends_with(".gltf") && !bytes.starts_with(b"glTF") {
        let remedy = "export the level as .glb (in Blender: File > Export > glTF 2.0)";
        return Err(wrong(file, "a ground is read from glTF only", remedy));
    }
    let document = Document::parse(file, bytes, resolve)?;
    let triangles = read_triangles(&document).map_err(|fault| fault.in_file(file))?;
    if triangles.is_empty() {
        let what = "holds no triangles in its scene, so there is nothing to stand on";
        return Err(wrong(file, what, "export the level's meshes; lines, points and empty nodes are no ground"));
    }
    let surface = Surface::new(triangles);
    if surface.is_empty() {
        let what = format!("none of its {} triangles has an area", surface.dropped);
        return Err(wrong(file, &what, "look at its scale: lengths are metres"));
    }
    let [low, high] = surface.bounds();
    let size = (high - low).max_element();
    if !(SMALLEST..=LARGEST).contains(&size) {
        let what = format!("is {size:.3} m from end to end");
        let remedy = "lengths are metres: if it was made in centimetres, scale its root node by 0.01";
        return Err(wrong(
            file,
            &what,
            if size > LARGEST { remedy } else { "lengths are metres: scale its root node" },
        ));
    }
    Ok(surface)
}

fn wrong(file: &str, what: &str, remedy: &str) -> RigError {
    RigError::WrongKind { file: file.into(), what: what.into(), remedy: remedy.into() }
}

fn read_triangles(document: &Document) -> Result<Vec<[DVec3; 3]>, Fault> {
    let nodes = read_nodes(document)?;
    let places = globals(&nodes, |node| node.local);
    let mut found = Vec::new();
    let mut shown = vec![false; nodes.len()];
    let mut open: Vec<usize> = roots(document, nodes.len())?;
    while let Some(node) = open.pop() {
        if !std::mem::replace(&mut shown[node], true) {
            open.extend(&nodes[node].children);
        }
    }
    for (index, node) in nodes.iter().enumerate().filter(|(index, _)| shown[*index]) {
        let Some(mesh) = node.mesh else { continue };
        let drawn: Mesh = document.typed("meshes", mesh, &format!("nodes[{index}].mesh"))?;
        for (at, primitive) in drawn.primitives.iter().enumerate() {
            let place = format!("meshes[{mesh}].primitives[{at}]");
            read_primitive(document, primitive, &place, places[index], &mut found)?;
        }
    }
    Ok(found)
}

/// The nodes of the scene that the file shows; all where it has none.
fn roots(document: &Document, count: usize) -> Result<Vec<usize>, Fault> {
    let index = document.json.get("scene").and_then(super::document::as_index).unwrap_or(0);
    let Some(json) = document.list("scenes").get(index) else { return Ok((0..count).collect()) };
    let place = format!("scenes[{index}]");
    let scene: Scene = if json.get("nodes").is_some() { read(json, &place)? } else { return Ok(Vec::new()) };
    let nodes = scene.nodes.iter().map(gltf::json::Index::value);
    nodes
        .map(|node| match node {
            node if node < count => Ok(node),
            _ => Err(Fault::new(format!("{place}.nodes"), format!("names node {node}, but there are {count}"))),
        })
        .collect()
}

fn read_primitive(
    document: &Document,
    primitive: &Primitive,
    place: &str,
    global: DAffine3,
    found: &mut Vec<[DVec3; 3]>,
) -> Result<(), Fault> {
    let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = primitive.mode else {
        return Ok(());
    };
    let Some(positions) = attribute(primitive, Semantic::Positions) else { return Ok(()) };
    let count = match primitive.indices {
        Some(accessor) => document.accessor_count(accessor.value(), &format!("{place}.indices"))?,
        None => document.accessor_count(positions, place)?,
    };
    if found.len().saturating_add(count / 3) > MOST_TRIANGLES {
        let what = format!("over {MOST_TRIANGLES} triangles: give a simplified mesh, as a game's collision mesh is");
        return Err(Fault::new(place, what));
    }
    let points = vec3s(document, positions, place)?;
    let points: Vec<DVec3> = points.into_iter().map(|point| global.transform_point3(point)).collect();
    if let Some(vertex) = points.iter().position(|point| !point.is_finite() || point.length() > 1e9) {
        let what = format!("vertex {vertex} is not at a finite place: export the mesh again");
        return Err(Fault::new(format!("{place}.attributes.POSITION"), what));
    }
    let corners = match primitive.indices {
        Some(accessor) => document.read_indices(accessor.value(), &format!("{place}.indices"))?,
        None => (0..points.len() as u32).collect(),
    };
    if let Some(corner) = corners.iter().find(|corner| **corner as usize >= points.len()) {
        let what = format!("{corner} lies beyond the {} vertices", points.len());
        return Err(Fault::new(format!("{place}.indices"), what));
    }
    let mirrored = global.matrix3.determinant() < 0.0; // turns the front of a face to its back
    let material = primitive.material.map(|material| material.value());
    let material = material.and_then(|material| document.list("materials").get(material));
    let both = material.and_then(|material| material.get("doubleSided")).and_then(Value::as_bool).unwrap_or(false);
    for corners in triangles(corners, mode).chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|at| points[corners[at] as usize]);
        let [front, back] = [[a, b, c], [a, c, b]];
        found.push(if mirrored { back } else { front });
        if both {
            found.push(if mirrored { front } else { back });
        }
    }
    if found.len() > 2 * MOST_TRIANGLES {
        return Err(Fault::new(place, format!("over {MOST_TRIANGLES} triangles: give a simplified mesh")));
    }
    Ok(())
}
