//! The bind pose: where the inverse bind matrices of the skins say that the joints were when the mesh was bound.
//!
//! A skinned vertex is drawn at `sum w * global(j) * IBM(j) * v`; the mesh node's own transform is ignored (glTF 2.0,
//! 3.7.3.3). So `inverse(IBM(j))` is the joint in mesh space, and the bind pose in the world is `W * inverse(IBM(j))` for one
//! W per skin. In most files the nodes stand in the bind pose and `global(j) * IBM(j)` is that W for every joint. Where
//! they stand in another pose, W is one of the transforms that cannot move with the pose (none, the mesh's node, the
//! parent of the topmost joint), the one that leaves bone sizes and the body's heading as the nodes have them.

use super::nodes::{decompose, globals, order};
use super::{Document, Fault, Rig, RigNode};
use crate::maths::real;
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// Relative to the skeleton's size: transforms nearer than this are the same.
const SAME: f64 = 2e-3;
/// Inverse bind matrices of a document.
const MOST_MATRICES: usize = 500_000;
/// Joints that are tried as the origin of W.
const MOST_TRIED: usize = 48;

/// A skin as the file has it.
#[derive(Clone, Debug)]
pub struct Skin {
    /// Node of each joint.
    pub joints: Vec<usize>,
    /// Inverse bind matrices, one a joint; empty where the file has none.
    pub inverse_binds: Vec<DAffine3>,
    /// Nodes that draw a mesh with it.
    pub users: Vec<usize>,
}

/// The skins of the document, checked.
pub fn read_skins(document: &Document, nodes: &[RigNode]) -> Result<Vec<Skin>, Fault> {
    let (mut skins, mut matrices) = (Vec::new(), 0_usize);
    for index in 0..document.list("skins").len() {
        let place = format!("skins[{index}]");
        let skin: gltf::json::Skin = document.typed("skins", index, &place)?;
        let joints: Vec<usize> = skin.joints.iter().map(gltf::json::Index::value).collect();
        if let Some(at) = joints.iter().position(|joint| *joint >= nodes.len()) {
            let what = format!("is no node: there are {}", nodes.len());
            return Err(Fault::new(format!("{place}.joints[{at}]"), what));
        }
        let inverse_binds = match skin.inverse_bind_matrices {
            None => Vec::new(),
            Some(accessor) => {
                let at = format!("{place}.inverseBindMatrices");
                matrices = matrices.saturating_add(document.accessor_count(accessor.value(), &at)?);
                if matrices > MOST_MATRICES {
                    return Err(Fault::new(at, format!("over {MOST_MATRICES} matrices: too large for a rig")));
                }
                let floats = document.read_f32s(accessor.value(), &at)?;
                if floats.width != 16 || floats.len() < joints.len() {
                    return Err(Fault::new(at, format!("must be {} MAT4, one a joint", joints.len())));
                }
                floats.values.chunks_exact(16).take(joints.len()).map(affine).collect()
            }
        };
        skins.push(Skin { joints, inverse_binds, users: Vec::new() });
    }
    for (index, node) in nodes.iter().enumerate() {
        if let Some(skin) = node.skin {
            let (place, count) = (format!("nodes[{index}].skin"), skins.len());
            let what = || Fault::new(place, format!("is {skin}, but there are {count} skins"));
            skins.get_mut(skin).ok_or_else(what)?.users.push(index);
        }
    }
    Ok(skins)
}

impl Rig {
    /// The nodes that skins bind vertices to.
    pub fn skin_joints(&self) -> Vec<usize> {
        let skin = |index| self.document.typed::<gltf::json::Skin>("skins", index, "skins").ok();
        let skins = (0..self.document.list("skins").len()).filter_map(skin);
        skins.flat_map(|skin| skin.joints).map(|joint| joint.value()).collect()
    }
}

/// Sets `bind` of every node from the skins, and says what was odd.
pub fn set_bind_pose(nodes: &mut [RigNode], skins: &[Skin]) -> Vec<String> {
    let mut warnings = Vec::new();
    let locals = globals(nodes, |node| node.local);
    let mut wanted: Vec<Option<DAffine3>> = vec![None; nodes.len()];
    let mut ranked: Vec<&Skin> = skins.iter().filter(|skin| !skin.inverse_binds.is_empty()).collect();
    ranked.sort_by_key(|skin| std::cmp::Reverse(skin.joints.len()));
    let mut conflicts = 0;
    for skin in ranked {
        let (skin, dropped) = usable(skin, &locals);
        if dropped > 0 {
            warnings.push(format!("{dropped} inverse bind matrices cannot be inverted and were ignored"));
        }
        if skin.joints.is_empty() {
            continue;
        }
        let size = spread(skin.joints.iter().map(|joint| locals[*joint].translation)).max(1e-9);
        let bound = spread(skin.inverse_binds.iter().map(|bind| bind.inverse().translation));
        if skin.joints.len() > 2 && bound < size * 1e-4 {
            warnings.push("the inverse bind matrices put every joint in one place and were ignored".into());
            continue;
        }
        let world = world_of_mesh(&skin, nodes, &locals, size);
        for (joint, inverse_bind) in skin.joints.iter().zip(&skin.inverse_binds) {
            let bind = world * inverse_bind.inverse();
            match wanted[*joint] {
                None => wanted[*joint] = Some(bind),
                Some(first) if distance(&first, &bind, size) > 0.02 => conflicts += 1,
                Some(_) => {}
            }
        }
    }
    if conflicts > 0 {
        warnings.push(format!("{conflicts} joints are bound in two poses by two skins: the larger skin's was taken"));
    }
    apply(nodes, &locals, &wanted);
    warnings
}

/// Puts the wanted globals into `bind`; nodes whose bind is their local keep it to the bit.
fn apply(nodes: &mut [RigNode], locals: &[DAffine3], wanted: &[Option<DAffine3>]) {
    let size = spread(locals.iter().map(|global| global.translation)).max(1e-9);
    let mut placed = vec![DAffine3::IDENTITY; nodes.len()];
    for index in order(nodes) {
        let parent = nodes[index].parent.map_or(DAffine3::IDENTITY, |parent| placed[parent]);
        let kept = parent * nodes[index].local.affine();
        nodes[index].bind = nodes[index].local;
        placed[index] = kept;
        let Some(target) = wanted[index] else { continue };
        if distance(&kept, &target, size) < 1e-4 || parent.matrix3.determinant().abs() < 1e-15 {
            continue;
        }
        let bind = decompose(&(parent.inverse() * target));
        if bind.translation.is_finite() && bind.scale.is_finite() && bind.scale.abs().min_element() > 1e-9 {
            nodes[index].bind = bind;
            placed[index] = parent * bind.affine();
        }
    }
}

/// W: mesh space at bind time to the document's world.
fn world_of_mesh(skin: &Skin, nodes: &[RigNode], locals: &[DAffine3], size: f64) -> DAffine3 {
    let drawn: Vec<DAffine3> = skin
        .joints
        .iter()
        .zip(&skin.inverse_binds)
        .map(|(joint, inverse_bind)| locals[*joint] * *inverse_bind)
        .collect();
    let reach = spread(skin.inverse_binds.iter().map(|bind| bind.inverse().translation)).max(1e-9);
    let agreeing =
        |world: &DAffine3| drawn.iter().filter(|other| mesh_distance(world, other, reach, size) < SAME).count();
    let step = drawn.len().div_ceil(MOST_TRIED).max(1);
    let common = drawn.iter().step_by(step).map(|world| (agreeing(world), world));
    if let Some((count, world)) = common.max_by_key(|(count, _)| *count)
        && count * 10 >= drawn.len() * 6
    {
        return *world;
    }
    let top = topmost(skin, nodes);
    let mut fixed = vec![DAffine3::IDENTITY];
    fixed.extend(skin.users.iter().take(4).map(|user| locals[*user]));
    fixed.extend(nodes[skin.joints[top]].parent.map(|parent| locals[parent]));
    let posed = drawn[top];
    let judge = |world: &DAffine3| misfit(world, skin, locals, size);
    let best = fixed.into_iter().map(|world| (judge(&world), world)).min_by(|a, b| a.0.total_cmp(&b.0));
    match best {
        // A turn of a radian over the whole body is no longer the same heading: then the root joint is what is known.
        Some((cost, world)) if cost < 1.0 || cost <= judge(&posed) => world,
        _ => posed,
    }
}

/// How far W leaves the sizes, the heading and the place of the joints from those of the nodes.
fn misfit(world: &DAffine3, skin: &Skin, locals: &[DAffine3], size: f64) -> f64 {
    let mut cost = 0.0;
    for (joint, inverse_bind) in skin.joints.iter().zip(&skin.inverse_binds) {
        let (bound, posed) = (decompose(&(*world * inverse_bind.inverse())), decompose(&locals[*joint]));
        let scale = real::ln(mean(bound.scale.abs()).max(1e-12) / mean(posed.scale.abs()).max(1e-12)).abs();
        let angle = angle(bound.rotation, posed.rotation);
        let shift = (bound.translation - posed.translation).length() / size;
        cost += 20.0 * scale + angle + 0.5 * shift.min(10.0);
    }
    cost / skin.joints.len() as f64
}

/// Index into the skin's joints of one that no other joint is above.
fn topmost(skin: &Skin, nodes: &[RigNode]) -> usize {
    let mut depth = vec![0_usize; nodes.len()];
    for index in order(nodes) {
        depth[index] = nodes[index].parent.map_or(0, |parent| depth[parent] + 1);
    }
    (0..skin.joints.len()).min_by_key(|at| depth[skin.joints[*at]]).unwrap_or(0)
}

/// The skin without joints whose matrices are singular, and how many those were.
fn usable(skin: &Skin, locals: &[DAffine3]) -> (Skin, usize) {
    let mut kept = Skin { joints: Vec::new(), inverse_binds: Vec::new(), users: skin.users.clone() };
    for (joint, inverse_bind) in skin.joints.iter().zip(&skin.inverse_binds) {
        let inverse = inverse_bind.inverse();
        let sane = inverse_bind.is_finite() && inverse.is_finite() && inverse.translation.length() < 1e9;
        if sane && inverse_bind.matrix3.determinant().abs() > 1e-18 && locals[*joint].is_finite() {
            kept.joints.push(*joint);
            kept.inverse_binds.push(*inverse_bind);
        }
    }
    let dropped = skin.joints.len() - kept.joints.len();
    (kept, dropped)
}

/// How far apart two globals are, relative to the skeleton: places by its size, axes by their own length.
fn distance(a: &DAffine3, b: &DAffine3, size: f64) -> f64 {
    let place = (a.translation - b.translation).length() / size;
    let length = a.matrix3.x_axis.length().max(1e-12);
    let axes = [a.matrix3.x_axis - b.matrix3.x_axis, a.matrix3.y_axis - b.matrix3.y_axis];
    axes.iter().fold(place, |most, axis| most.max(axis.length() / length))
}

/// How far apart two W put a mesh of that reach, relative to the skeleton.
fn mesh_distance(a: &DAffine3, b: &DAffine3, reach: f64, size: f64) -> f64 {
    let corners = [DVec3::ZERO, DVec3::X * reach, DVec3::Y * reach, DVec3::Z * reach];
    corners.iter().fold(0.0_f64, |most, corner| {
        most.max((a.transform_point3(*corner) - b.transform_point3(*corner)).length() / size)
    })
}

fn spread(points: impl Iterator<Item = DVec3>) -> f64 {
    let (low, high) = points.fold((DVec3::MAX, DVec3::MIN), |(low, high), point| (low.min(point), high.max(point)));
    if low.x > high.x { 0.0 } else { (high - low).length() }
}

fn mean(scale: DVec3) -> f64 {
    real::cbrt(scale.x * scale.y * scale.z)
}

fn angle(a: DQuat, b: DQuat) -> f64 {
    2.0 * real::acos(a.dot(b).abs().min(1.0))
}

fn affine(columns: &[f32]) -> DAffine3 {
    let mut values = [0.0; 16];
    values.iter_mut().zip(columns).for_each(|(value, column)| *value = f64::from(*column));
    DAffine3::from_mat4(DMat4::from_cols_array(&values))
}
