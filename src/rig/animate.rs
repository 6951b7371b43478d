//! From poses of the body to local transforms of nodes. The way back is in `sampler`.
//!
//! All globals here are in scenario space (metres): the scene's roots hang from `scenario_from_document`. A node's *turn* is
//! its global rotation from the reference pose; nodes that no joint drives inherit the turn of their parent, so local bone
//! axes, scaled armatures and mirrored parents never matter. Scale is never animated. Non-uniform scale above a turned bone
//! (a shear) has no exact answer in TRS and is treated as if it were uniform.

pub use super::sampler::{SampledPose, Sampler, hermite, slerp};
use super::{Rig, RigNode, Trs};
use crate::maths::real;
use crate::model::{BodyPose, Clip, Role};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::Scene;

/// Which node carries the root motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RootCarrier {
    /// None: everything is in the hips.
    None,
    /// A node of the document, above the hips.
    Node(usize),
    /// The node that the exporter puts over [`Rig::new_root_children`].
    New,
}

/// The root's motion from rest: a rigid transform of scenario space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootMove {
    /// Turn about +Y.
    pub rotation: DQuat,
    /// m.
    pub translation: DVec3,
}

/// A node whose transform follows a joint of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Index into `Body::joints`.
    pub joint: usize,
    /// m, scenario axes, at rest: from the joint to the node.
    pub offset: DVec3,
    /// Whether the node needs a translation too: the hips, and what does not hang from its joint's parent.
    pub translate: bool,
}

/// Turns poses of the body into local transforms of nodes.
#[derive(Clone, Debug)]
pub struct Poser<'a> {
    rig: &'a Rig,
    order: Vec<usize>,               // parents first
    reference: Vec<Trs>,             // (nodes) local at rest
    reference_global: Vec<DAffine3>, // (nodes) scenario space
    parent_axes: Vec<DMat3>,         // (nodes) orientation of the parent at rest
    drives: Vec<Option<Drive>>,      // (nodes)
    under_new_root: Vec<bool>,       // (nodes)
}

impl Rig {
    /// Local transforms of all nodes in a pose: driven nodes turned, all others at their bind pose.
    pub fn node_locals(&self, pose: &BodyPose) -> Vec<Trs> {
        let mut locals = Vec::new();
        Poser::new(self).locals(pose, RootCarrier::None, &RootMove::IDENTITY, &mut locals);
        locals
    }

    /// The pose that a clip shows at `time` (s).
    pub fn sample(&self, clip: &Clip, time: f64) -> SampledPose {
        self.sampler(clip).sample(time)
    }

    /// A reader of a clip, for many samples.
    pub fn sampler<'a>(&'a self, clip: &'a Clip) -> Sampler<'a> {
        Sampler::new(self, clip)
    }

    /// Transforms of all nodes at the bind pose, node to scenario space.
    pub fn bind_globals(&self) -> Vec<DAffine3> {
        let binds: Vec<Trs> = self.nodes.iter().map(|node| node.bind).collect();
        self.globals(&binds, &self.parents_first())
    }

    /// Nodes with every parent before its children.
    pub fn parents_first(&self) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut seen = vec![false; self.nodes.len()];
        let mut stack: Vec<usize> =
            (0..self.nodes.len()).rev().filter(|node| self.nodes[*node].parent.is_none()).collect();
        while let Some(node) = stack.pop() {
            if std::mem::replace(&mut seen[node], true) {
                continue;
            }
            order.push(node);
            stack.extend(self.nodes[node].children.iter().rev().filter(|child| **child < seen.len()));
        }
        order
    }

    /// The scene roots that a new `Root` becomes the parent of: those of the hips' scenes, without skinned meshes that
    /// have no children (a parent moves no skinned mesh, and validators warn of one).
    pub fn new_root_children(&self) -> Vec<usize> {
        let hips_root = self.scene_root(self.hips_node());
        let scene = |index| self.document.typed::<Scene>("scenes", index, "scenes").ok();
        let listed = |scene: Option<Scene>| scene.into_iter().flat_map(|scene| scene.nodes).map(|node| node.value());
        let scenes: Vec<Vec<usize>> =
            (0..self.document.list("scenes").len()).map(|index| listed(scene(index)).collect()).collect();
        let in_scenes = |node: usize| -> Vec<bool> { scenes.iter().map(|nodes| nodes.contains(&node)).collect() };
        let ours = in_scenes(hips_root);
        (0..self.nodes.len())
            .filter(|node| {
                let bare_skin = self.nodes[*node].skin.is_some() && self.nodes[*node].children.is_empty();
                *node == hips_root || (self.nodes[*node].parent.is_none() && !bare_skin && in_scenes(*node) == ours)
            })
            .collect()
    }

    /// The node of the hips.
    pub fn hips_node(&self) -> usize {
        self.joint_nodes
            .first()
            .copied()
            .flatten()
            .or_else(|| self.mapping.bones.get(&Role::Hips).copied())
            .unwrap_or(0)
    }

    /// The topmost ancestor of a node, or itself.
    pub fn scene_root(&self, node: usize) -> usize {
        let mut at = node;
        for _ in 0..self.nodes.len() {
            match self.nodes.get(at).and_then(|node| node.parent) {
                Some(parent) => at = parent,
                None => break,
            }
        }
        at
    }

    /// Scenario space from the document's world, as a matrix.
    pub fn scenario_from_document(&self) -> DAffine3 {
        let similarity = &self.document_from_scenario;
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(similarity.scale),
            similarity.rotation,
            similarity.translation,
        )
        .inverse()
    }

    fn globals(&self, locals: &[Trs], order: &[usize]) -> Vec<DAffine3> {
        let base = self.scenario_from_document();
        let mut globals = vec![base; self.nodes.len()];
        for &node in order {
            let parent = self.nodes[node].parent.map_or(base, |parent| globals[parent]);
            globals[node] = parent * locals[node].affine();
        }
        globals
    }

    pub(super) fn under(&self, roots: &[usize], order: &[usize]) -> Vec<bool> {
        let mut under = vec![false; self.nodes.len()];
        for &node in order {
            under[node] = self.nodes[node].parent.map_or_else(|| roots.contains(&node), |parent| under[parent]);
        }
        under
    }
}

impl RootMove {
    /// No motion.
    pub const IDENTITY: RootMove = RootMove { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// As a matrix.
    pub fn affine(&self) -> DAffine3 {
        DAffine3::from_rotation_translation(self.rotation, self.translation)
    }
}

impl<'a> Poser<'a> {
    /// Prepares for a rig.
    pub fn new(rig: &'a Rig) -> Poser<'a> {
        let order = rig.parents_first();
        let bind_global = rig.bind_globals();
        let mut drives: Vec<Option<Drive>> = vec![None; rig.nodes.len()];
        for (joint, node) in rig.joint_nodes.iter().enumerate() {
            if let Some(node) = node.filter(|node| rig.body.joints[joint].animated && *node < drives.len()) {
                let offset = bind_global[node].translation - rig.body.joints[joint].rest;
                drives[node] = Some(Drive { joint, offset, translate: joint == 0 });
            }
        }
        let hangs_right: Vec<bool> = (0..drives.len()).map(|node| hangs_from_its_parent(rig, &drives, node)).collect();
        for (node, drive) in drives.iter_mut().enumerate() {
            if let Some(drive) = drive {
                drive.translate |= !hangs_right[node];
            } else if let Some(joint) =
                rig.nodes[node].name.as_deref().and_then(ik_role).and_then(|role| rig.body.joint(role))
            {
                let offset = bind_global[node].translation - rig.body.joints[joint].rest;
                *drive = Some(Drive { joint, offset, translate: true });
            }
        }
        let reference: Vec<Trs> = (0..rig.nodes.len())
            .map(|node| {
                let RigNode { local, bind, .. } = &rig.nodes[node];
                let (moved, turned) = differs(local, bind, node_scale(&bind_global, rig, node));
                Trs {
                    translation: if moved { bind.translation } else { local.translation },
                    rotation: if turned || drives[node].is_some() { bind.rotation } else { local.rotation },
                    scale: local.scale * rig.leg_scales.get(&node).copied().unwrap_or(1.0),
                }
            })
            .collect();
        let reference_global = rig.globals(&reference, &order);
        let under_new_root = rig.under(&rig.new_root_children(), &order);
        let base = rig.scenario_from_document();
        let parent = |node: &RigNode| node.parent.map_or(base, |parent| reference_global[parent]);
        let parent_axes = rig.nodes.iter().map(|node| orientation(&parent(node).matrix3)).collect();
        Poser { rig, order, reference, reference_global, parent_axes, drives, under_new_root }
    }

    /// Which joint each node follows.
    pub fn drives(&self) -> &[Option<Drive>] {
        &self.drives
    }

    /// Local transforms of all nodes at rest: what nodes that nothing drives hold.
    pub fn reference(&self) -> &[Trs] {
        &self.reference
    }

    /// Transforms of all nodes at rest, node to scenario space.
    pub fn reference_globals(&self) -> &[DAffine3] {
        &self.reference_global
    }

    /// The transform of a node's parent at rest, to scenario space.
    pub fn parent_rest(&self, node: usize) -> DAffine3 {
        self.rig.nodes[node]
            .parent
            .map_or_else(|| self.rig.scenario_from_document(), |parent| self.reference_global[parent])
    }

    /// Whether a node would move with a new root.
    pub fn under_new_root(&self, node: usize) -> bool {
        self.under_new_root[node]
    }

    /// Nodes whose rest differs from what the document says, so that a clip must hold it: node, translation, rotation. Scales:
    /// [`Rig::leg_scales`].
    pub fn held(&self) -> Vec<(usize, bool, bool)> {
        (0..self.reference.len())
            .map(|node| {
                let local = &self.rig.nodes[node].local;
                (
                    node,
                    self.reference[node].translation != local.translation,
                    self.reference[node].rotation != local.rotation,
                )
            })
            .filter(|(_, moved, turned)| *moved || *turned)
            .collect()
    }

    /// Writes the local transforms of all nodes. With a carrier, it makes the root's `motion` and the rest is relative to it:
    /// the globals stay the same.
    pub fn locals(&self, pose: &BodyPose, carrier: RootCarrier, motion: &RootMove, locals: &mut Vec<Trs>) {
        let positions = pose.positions(&self.rig.body);
        let base = self.rig.scenario_from_document();
        let moved = motion.affine();
        locals.clear();
        locals.extend_from_slice(&self.reference);
        let mut globals = self.reference_global.clone();
        let mut turns = vec![DQuat::IDENTITY; locals.len()];
        for &node in &self.order {
            let (parent_global, parent_turn) = match self.rig.nodes[node].parent {
                Some(parent) => (globals[parent], turns[parent]),
                None if carrier == RootCarrier::New && self.under_new_root[node] => (moved * base, motion.rotation),
                None => (base, DQuat::IDENTITY),
            };
            let (turn, position) = match &self.drives[node] {
                _ if carrier == RootCarrier::Node(node) => {
                    (motion.rotation, Some(moved.transform_point3(self.reference_global[node].translation)))
                }
                Some(drive) => {
                    let turn = pose.turns[drive.joint];
                    (turn, drive.translate.then(|| positions[drive.joint] + turn * drive.offset))
                }
                None => (parent_turn, None),
            };
            let local = &mut locals[node];
            if turn != parent_turn {
                let relative = conjugate(&self.parent_axes[node], parent_turn.inverse() * turn);
                local.rotation = (relative * local.rotation).normalize();
            }
            if let Some(position) = position {
                local.translation = parent_global.inverse().transform_point3(position);
            }
            turns[node] = turn;
            globals[node] = parent_global * local.affine();
        }
    }

    /// The translation and rotation of the new root node in document space that make a root's motion.
    pub fn new_root(&self, motion: &RootMove) -> (DVec3, DQuat) {
        let similarity = &self.rig.document_from_scenario;
        let origin = similarity.inverse_point(DVec3::ZERO);
        (similarity.point(motion.affine().transform_point3(origin)), similarity.turn(motion.rotation))
    }
}

/// The orthogonal part of a transform: a rotation, mirrored where the transform mirrors.
pub fn orientation(linear: &DMat3) -> DMat3 {
    let x = linear.x_axis.normalize_or(DVec3::X);
    let y = (linear.y_axis - x * x.dot(linear.y_axis)).normalize_or(x.any_orthonormal_vector());
    let z = x.cross(y);
    DMat3::from_cols(x, y, if z.dot(linear.z_axis) < 0.0 { -z } else { z })
}

/// `basis⁻¹ * turn * basis`, also where the basis mirrors.
fn conjugate(basis: &DMat3, turn: DQuat) -> DQuat {
    let axis = basis.transpose() * turn.xyz() * basis.determinant().signum();
    DQuat::from_xyzw(axis.x, axis.y, axis.z, turn.w)
}

/// Whether a node's nearest driven ancestor is the one that its joint hangs from in the body.
fn hangs_from_its_parent(rig: &Rig, drives: &[Option<Drive>], node: usize) -> bool {
    let Some(drive) = drives[node] else { return true };
    let driven =
        |joint: usize| rig.joint_nodes[joint].is_some_and(|node| drives.get(node).is_some_and(Option::is_some));
    let mut wanted = rig.body.joints[drive.joint].parent;
    while let Some(joint) = wanted.filter(|joint| !driven(*joint)) {
        wanted = rig.body.joints[joint].parent;
    }
    let mut ancestor = rig.nodes[node].parent;
    while let Some(above) = ancestor.filter(|above| drives[*above].is_none()) {
        ancestor = rig.nodes[above].parent;
    }
    ancestor.and_then(|above| drives[above]).map(|drive| drive.joint) == wanted
}

/// The joint that an Unreal IK bone follows.
pub(super) fn ik_role(name: &str) -> Option<Role> {
    let name = name.rsplit([':', '|']).next().unwrap_or(name).to_ascii_lowercase().replace(['.', '-', ' '], "_");
    match name.as_str() {
        "ik_foot_l" => Some(Role::LeftFoot),
        "ik_foot_r" => Some(Role::RightFoot),
        "ik_hand_l" => Some(Role::LeftHand),
        "ik_hand_r" | "ik_hand_gun" => Some(Role::RightHand),
        _ => None,
    }
}

/// Metres in scenario space that one unit of a node's local translation makes.
fn node_scale(globals: &[DAffine3], rig: &Rig, node: usize) -> f64 {
    let linear =
        rig.nodes[node].parent.map_or_else(|| rig.scenario_from_document().matrix3, |parent| globals[parent].matrix3);
    real::cbrt(linear.determinant().abs())
}

/// Whether two transforms differ by more than the rounding of a file: (by 0.05 mm, by 0.005 degrees).
fn differs(local: &Trs, bind: &Trs, metres: f64) -> (bool, bool) {
    let moved = (local.translation - bind.translation).length() * metres > 5e-5;
    (moved, chord(local.rotation, bind.rotation) > 4.4e-5)
}

/// About half of the angle between two rotations, exact for small ones.
pub fn chord(from: DQuat, to: DQuat) -> f64 {
    (from - to).length().min((from + to).length())
}
