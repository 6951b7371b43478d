//! An FBX file as a glTF document in memory, which is then loaded as any other rig: metres, Y up.
//!
//! Every node under its name in its place, skinned and rigid meshes with their base colours, the file's own takes as animations at the
//! file's rate, at the index of their stack. [`scene`] opens the file, for rigs and clips alike. Left out, with a sentence: blend
//! shapes, weights beyond four a vertex, further skins of a mesh. Left out without one: cameras, lights, and materials but their colour.

mod animation;
mod buffer;
mod material;
mod mesh;
mod scene;

pub use animation::animation;
pub use buffer::{Buffer, container};
pub use scene::{Nodes, affine, nodes, open, trs};

use super::document::Resolve;
use super::{Fault, RigError, Trs};
use serde_json::{Value, json};
use ufbx::Scene;

/// What files begin with: binary, and text as FBX programs write it.
const BEGINNINGS: [&[u8]; 2] = [b"Kaydara FBX Binary", b"; FBX"];
/// Hz, that a file's settings may say.
const RATES: std::ops::RangeInclusive<f64> = 10.0..=240.0;
/// Hz, where they say nothing.
const USUAL_RATE: f64 = 30.0;
/// Nodes times frames of all takes together; takes beyond are left out.
const MOST_TRANSFORMS: usize = 1 << 22;

/// Whether those are the bytes of an FBX file.
pub fn is_fbx(name: &str, bytes: &[u8]) -> bool {
    let named = name.len() > 4 && name.as_bytes()[name.len() - 4..].eq_ignore_ascii_case(b".fbx");
    let known = BEGINNINGS.iter().any(|beginning| bytes.starts_with(beginning));
    known || named && !bytes.starts_with(b"glTF") && !bytes.trim_ascii_start().starts_with(b"{")
}

/// The bytes of a GLB with what the file holds, and sentences of what it does not. `resolve` reads pictures beside the file.
pub fn to_glb(name: &str, bytes: &[u8], resolve: &Resolve) -> Result<(Vec<u8>, Vec<String>), RigError> {
    let opts = ufbx::LoadOpts {
        target_axes: ufbx::CoordinateAxes {
            right: ufbx::CoordinateAxis::PositiveX,
            up: ufbx::CoordinateAxis::PositiveY,
            front: ufbx::CoordinateAxis::PositiveZ,
        },
        target_unit_meters: 1.0,
        space_conversion: ufbx::SpaceConversion::ModifyGeometry,
        geometry_transform_handling: ufbx::GeometryTransformHandling::ModifyGeometry,
        generate_missing_normals: true,
        clean_skin_weights: true,
        ..ufbx::LoadOpts::default()
    };
    let fault = |what: String| Fault::new("FBX", format!("{what}; export it again as binary FBX")).in_file(name);
    let root = open(bytes, opts).map_err(fault)?;
    let scene: &Scene = &root;
    let mut out = Buffer::default();
    let mut notes = Vec::new();
    // The scene's own root is no node of the document.
    let mut places: Vec<Option<usize>> = vec![None; scene.nodes.count];
    let kept: Vec<usize> = (0..scene.nodes.count).filter(|node| !scene.nodes[*node].is_root).collect();
    for (place, node) in kept.iter().enumerate() {
        places[*node] = Some(place);
    }
    let rest = rest(scene, &kept);
    let mut list = node_list(scene, &kept, &places, &rest);
    let roots: Vec<usize> = (0..kept.len()).filter(|place| parent(scene, kept[*place], &places).is_none()).collect();
    let drawn = mesh::add(scene, &kept, &places, &mut list, &mut out, &mut notes);
    let painted = material::list(scene, resolve, &mut out);
    let animations = animations(scene, &kept, &rest, &mut out, &mut notes);
    let mut document = json!({
        "asset": { "version": "2.0", "generator": "surefoot" },
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": list,
    });
    let lists = [
        ("meshes", drawn.meshes),
        ("skins", drawn.skins),
        ("materials", painted.materials),
        ("textures", painted.textures),
        ("images", painted.images),
        ("animations", animations),
        ("accessors", std::mem::take(&mut out.accessors)),
        ("bufferViews", std::mem::take(&mut out.views)),
    ];
    for (field, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
        document[field] = Value::Array(list);
    }
    if !out.bytes.is_empty() {
        document["buffers"] = json!([{ "byteLength": out.bytes.len() }]);
    }
    Ok((container(&document, &out.bytes), notes))
}

/// Local transforms as the file has them; of a bare skeleton those of its bind pose, where it has one.
fn rest(scene: &Scene, kept: &[usize]) -> Vec<Trs> {
    let skinned = scene.meshes.into_iter().any(|mesh| mesh.skin_deformers.count > 0);
    if skinned {
        return kept.iter().map(|node| trs(&scene.nodes[*node].local_transform)).collect();
    }
    let zero = nodes(scene).zero;
    kept.iter().map(|node| zero[*node]).collect()
}

fn parent(scene: &Scene, node: usize, places: &[Option<usize>]) -> Option<usize> {
    let parent = scene.nodes[node].parent.as_ref()?;
    places.get(parent.element.typed_id as usize).copied().flatten()
}

fn node_list(scene: &Scene, kept: &[usize], places: &[Option<usize>], rest: &[Trs]) -> Vec<Value> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); kept.len()];
    for (place, node) in kept.iter().enumerate() {
        if let Some(parent) = parent(scene, *node, places) {
            children[parent].push(place);
        }
    }
    let mut list = Vec::with_capacity(kept.len());
    for ((node, rest), children) in kept.iter().zip(rest).zip(children) {
        let mut json = json!({ "name": &*scene.nodes[*node].element.name });
        if rest.translation != glam::DVec3::ZERO {
            json["translation"] = json!(rest.translation.to_array());
        }
        if rest.rotation != glam::DQuat::IDENTITY {
            json["rotation"] = json!(rest.rotation.to_array());
        }
        if rest.scale != glam::DVec3::ONE {
            json["scale"] = json!(rest.scale.to_array());
        }
        if !children.is_empty() {
            json["children"] = json!(children);
        }
        list.push(json);
    }
    list
}

/// Every stack at its index, from its own beginning.
fn animations(scene: &Scene, kept: &[usize], rest: &[Trs], out: &mut Buffer, notes: &mut Vec<String>) -> Vec<Value> {
    let said = scene.settings.frames_per_second;
    let fps = if RATES.contains(&said) { said } else { USUAL_RATE };
    let (mut list, mut evaluated, mut left) = (Vec::new(), 0_usize, 0);
    for (index, stack) in scene.anim_stacks.into_iter().enumerate() {
        let name: &str = &stack.element.name;
        let name = if name.is_empty() { format!("stack {index}") } else { name.to_owned() };
        let seconds = (stack.time_end - stack.time_begin).max(0.0);
        let frames = (seconds * fps + 0.01).floor() as usize + 1;
        evaluated = evaluated.saturating_add(frames.saturating_mul(kept.len()));
        let frames = if evaluated > MOST_TRANSFORMS || !seconds.is_finite() { 0 } else { frames };
        left += usize::from(frames == 0);
        let local = |frame: usize, node: usize| {
            let time = stack.time_begin + frame as f64 / fps;
            trs(&ufbx::evaluate_transform(&stack.anim, &scene.nodes[kept[node]], time))
        };
        list.push(animation(&name, (fps, frames), rest, &local, out));
    }
    if left > 0 {
        notes.push(format!("{left} of its {} takes are too long together, and were not read", list.len()));
    }
    list
}
