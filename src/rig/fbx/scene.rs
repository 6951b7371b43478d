//! FBX files opened by `ufbx`, and what of them rigs and clips both need: the nodes and their rest.
//!
//! Pivots, pre- and post-rotations and inherited scales are resolved by ufbx. File units and axes, unless the options say otherwise.

use crate::rig::Trs;
use crate::rig::nodes::decompose;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use ufbx::{Scene, SceneRoot};

/// Memory that a file may take: this, and so many times its own size.
const MEMORY: (usize, usize) = (64 << 20, 24);
/// Nodes and their depth.
const MOST_NODES: usize = 20_000;
const DEEPEST: u32 = 512;
/// Coordinates beyond this are a broken file.
const FARTHEST: f64 = 1e7;

/// The hierarchy as it stands without animation.
pub struct Nodes {
    /// One a node.
    pub names: Vec<String>,
    /// One a node.
    pub parents: Vec<Option<usize>>,
    /// Every node, parents before children.
    pub order: Vec<usize>,
    /// Local transforms at rest.
    pub zero: Vec<Trs>,
}

/// Reads a file's bytes, as `opts` say and in bounded memory; what is wrong as a sentence.
pub fn open(bytes: &[u8], opts: ufbx::LoadOpts) -> Result<SceneRoot, String> {
    let memory = |opts: &mut ufbx::AllocatorOpts| {
        opts.memory_limit = MEMORY.0.saturating_add(bytes.len().saturating_mul(MEMORY.1)).min(2 << 30);
    };
    let mut opts = ufbx::LoadOpts {
        node_depth_limit: DEEPEST,
        file_format: ufbx::FileFormat::Fbx,
        inherit_mode_handling: ufbx::InheritModeHandling::Compensate,
        ..opts
    };
    memory(&mut opts.temp_allocator);
    memory(&mut opts.result_allocator);
    let scene = ufbx::load_memory(bytes, opts).map_err(|error| said(&error))?;
    if scene.nodes.count > MOST_NODES {
        return Err(format!("{} nodes: over {MOST_NODES} are too many", scene.nodes.count));
    }
    Ok(scene)
}

/// The nodes, and where each rests: in the file's bind pose, where it has one.
pub fn nodes(scene: &Scene) -> Nodes {
    let count = scene.nodes.count;
    let index = |node: &ufbx::Node| node.element.typed_id as usize;
    let parents: Vec<Option<usize>> = scene
        .nodes
        .into_iter()
        .map(|node| node.parent.as_ref().map(|parent| index(parent)).filter(|parent| *parent < count))
        .collect();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut order: Vec<usize> = Vec::with_capacity(count);
    for (node, parent) in parents.iter().enumerate() {
        match parent {
            Some(parent) => children[*parent].push(node),
            None => order.push(node),
        }
    }
    let mut at = 0;
    while at < order.len() {
        order.extend(&children[order[at]]);
        at += 1;
    }
    let locals: Vec<Trs> = scene.nodes.into_iter().map(|node| trs(&node.local_transform)).collect();
    let mut bound: Vec<Option<DAffine3>> = vec![None; count];
    for pose in scene.poses.into_iter().filter(|pose| pose.is_bind_pose) {
        for bone in &pose.bone_poses {
            let node = index(&bone.bone_node);
            let matrix = affine(&bone.bone_to_world);
            if node < count && matrix.is_finite() && matrix.matrix3.determinant().abs() > 1e-12 {
                bound[node].get_or_insert(matrix);
            }
        }
    }
    let mut zero = locals.clone();
    let mut placed = vec![DAffine3::IDENTITY; count];
    for &node in &order {
        let above = parents[node].map_or(DAffine3::IDENTITY, |parent| placed[parent]);
        if let Some(target) = bound[node]
            && above.matrix3.determinant().abs() > 1e-15
        {
            let bind = decompose(&(above.inverse() * target));
            if bind.translation.length() < FARTHEST && bind.scale.is_finite() {
                zero[node] = bind;
            }
        }
        placed[node] = above * zero[node].affine();
    }
    let names = scene.nodes.into_iter().map(|node| node.element.name.to_string()).collect();
    Nodes { names, parents, order, zero }
}

/// What ufbx says, with its details; its first line.
fn said(error: &ufbx::Error) -> String {
    let mut text = [0_u8; 512];
    let length = ufbx::format_error(&mut text, error).min(text.len());
    let text = String::from_utf8_lossy(&text[..length]).into_owned();
    let line = text.lines().next().unwrap_or_default().trim_end_matches('\0');
    line.split_once("error: ").map_or(line, |(_, what)| what).to_owned()
}

/// A transform of ufbx; what is no number stands still.
pub fn trs(transform: &ufbx::Transform) -> Trs {
    let vector = |v: &ufbx::Vec3, other: DVec3| {
        let vector = DVec3::new(v.x, v.y, v.z);
        if vector.abs().max_element() < FARTHEST { vector } else { other }
    };
    let turn = &transform.rotation;
    let rotation = DQuat::from_xyzw(turn.x, turn.y, turn.z, turn.w);
    let length = rotation.length();
    Trs {
        translation: vector(&transform.translation, DVec3::ZERO),
        rotation: if length.is_finite() && length > 1e-6 { rotation.normalize() } else { DQuat::IDENTITY },
        scale: vector(&transform.scale, DVec3::ONE),
    }
}

/// The same of a matrix.
pub fn affine(m: &ufbx::Matrix) -> DAffine3 {
    let columns = [[m.m00, m.m10, m.m20], [m.m01, m.m11, m.m21], [m.m02, m.m12, m.m22]];
    let [x, y, z] = columns.map(DVec3::from_array);
    DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: DVec3::new(m.m03, m.m13, m.m23) }
}
