//! Which nodes of a rig become an FBX skeleton, under which names, and where they stand at rest.
//!
//! Every node that the clips move, that a skin uses or that is a bone of the body, with all above it, under one root. Meshes, cameras
//! and the helper nodes of the contacts are left out. Rest is the rig's own: each bone's local transform is the node's, centimetres for
//! document units. FBX readers differ on scaled bones (Blender has none), so a scale stays only on what stands above all joints, the
//! armature of many programs, which is written as a null object as those programs do; a scale further down goes into the lengths below.

use crate::model::{Clip, Target};
use crate::rig::animate::orientation;
use crate::rig::nodes::{self, decompose};
use crate::rig::{Rig, Trs};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::collections::BTreeSet;

/// Relative: scales nearer to each other are the same.
const SAME_SCALE: f64 = 1e-4;
/// Of an axis: an up direction nearer to +Y is +Y.
const UPRIGHT: f64 = 0.999;
/// Centimetres in a metre: FBX files of game programs are in centimetres (UnitScaleFactor 1).
const CENTIMETRES: f64 = 100.0;
/// Bytes of a name at most: a reader's own limit would cut it (Blender's is 63, and says so itself).
const LONGEST_NAME: usize = 250;

/// cm of a body of usual size: 0.01 mm, more than Blender takes for the same place at 10 m.
const ASIDE: f64 = 1e-3;
/// cm: a bone that is moved less stays in its place.
const LEFT: f64 = 1e-5;

/// The bone that carries root motion where the rig has no root bone, as in a GLB.
const NEW_ROOT: &str = "Root";

/// What a bone is in the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A node of the document.
    Node(usize),
    /// The `Root` that carries root motion on rigs that have no root bone.
    NewRoot,
    /// A root over several trees; it does not move.
    Over,
}

/// A bone of the file.
#[derive(Clone, Debug)]
pub struct Bone {
    /// What it is in the rig.
    pub source: Source,
    /// As it is written.
    pub name: String,
    /// Into the bones; `None` for the one root.
    pub parent: Option<usize>,
    /// A null object: it stands above all joints and is scaled, or is above one that is.
    pub is_null: bool,
    /// Local transform without animation, cm.
    pub rest: Trs,
    /// The same in the file's world.
    pub rest_global: DAffine3,
    /// In the file's world, in the bind pose of the rig's skins.
    pub bind_global: DAffine3,
    /// What turns a place of the node in the file's world into the bone's: by as much as the node has moved from its rest, the bone
    /// has from its own. `None` for what does not move.
    rest_from_node: Option<DAffine3>,
}

/// The skeleton of a file.
#[derive(Clone, Debug)]
pub struct Skeleton {
    /// Parents before children; the first is the root.
    pub bones: Vec<Bone>,
    /// The rig's document to the file's world (cm).
    pub file_from_document: DAffine3,
    file_from_scenario: DAffine3,
    units: f64, // of the document a metre of the body
    /// What is other than in the rig, as sentences.
    pub changes: Vec<String>,
}

impl Skeleton {
    /// Of the rig, for that clip.
    pub fn new(rig: &Rig, clip: &Clip) -> Skeleton {
        let mut changes = Vec::new();
        let file_from_document = file_from_document(rig, &mut changes);
        let wanted = wanted(rig, clip);
        let new_root = clip.channels.iter().any(|channel| channel.target == Target::NewRoot);
        let mut bones = tree(rig, &wanted, new_root, &mut changes);
        name(&mut bones, rig, &mut changes);
        place(&mut bones, rig, &file_from_document, &mut changes);
        let file_from_scenario = file_from_document * rig.scenario_from_document().inverse();
        Skeleton { bones, file_from_document, file_from_scenario, units: rig.document_from_scenario.scale, changes }
    }

    /// Local transforms of the bones (cm) where the rig's nodes are at those places of scenario space.
    pub fn locals(&self, nodes: &[DAffine3], new_root: DAffine3) -> Vec<Trs> {
        let mut globals: Vec<DAffine3> = Vec::with_capacity(self.bones.len());
        let mut locals = Vec::with_capacity(self.bones.len());
        for bone in &self.bones {
            let at = match bone.source {
                Source::Node(node) => nodes.get(node),
                Source::NewRoot => Some(&new_root),
                Source::Over => None,
            };
            let above = bone.parent.map_or(DAffine3::IDENTITY, |parent| globals[parent]);
            let target = at.zip(bone.rest_from_node).map(|(at, rest)| self.file_from_scenario * *at * rest);
            let local = target.map_or(bone.rest, |target| decompose(&(above.inverse() * target)));
            globals.push(above * local.affine());
            locals.push(local);
        }
        locals
    }
}

impl Skeleton {
    /// Moves the bind pose of bones that leave their place in the frames aside by [`ASIDE`]. Blender's importer joins a bone to its
    /// parent where it rests at the very end of it, along its Y axis, and a bone that is joined cannot leave it.
    pub fn set_aside(&mut self, frames: &[Vec<Trs>]) {
        let binds: Vec<DAffine3> = self.bones.iter().map(|bone| bone.bind_global).collect();
        let mut asides = vec![0.0; binds.len()]; // each by one more than its parent, or they would be beside each other again
        for (index, bone) in self.bones.iter_mut().enumerate() {
            let Some(parent) = bone.parent else { continue };
            let place = binds[parent].inverse().transform_point3(binds[index].translation);
            if frames.iter().any(|locals| locals[index].translation.distance(place) > LEFT * self.units) {
                asides[index] = asides[parent] + ASIDE * self.units;
                bone.bind_global.translation += binds[parent].matrix3.x_axis.normalize_or(DVec3::X) * asides[index];
            }
        }
    }
}

/// Centimetres for the document's units, which are metres by its format, and Y up. A rig that is larger or smaller than a person stays
/// so, and keeps its origin and heading: the take must fit it.
fn file_from_document(rig: &Rig, changes: &mut Vec<String>) -> DAffine3 {
    let stands = &rig.document_from_scenario;
    let upright = (stands.rotation * DVec3::Y).dot(DVec3::Y) > UPRIGHT;
    let turned = if upright { DQuat::IDENTITY } else { stands.rotation.inverse() };
    if !upright {
        changes.push(format!("the rig's file has {} up: in the FBX +Y is up and +Z ahead", rig.mapping.up));
    }
    DAffine3::from_scale_rotation_translation(DVec3::splat(CENTIMETRES), turned, DVec3::ZERO)
}

/// (nodes) whether it is part of the skeleton.
fn wanted(rig: &Rig, clip: &Clip) -> Vec<bool> {
    let moved = clip.channels.iter().filter_map(|channel| match channel.target {
        Target::Node(node) => Some(node),
        _ => None,
    });
    let mut wanted = vec![false; rig.nodes.len()];
    let body = rig.joint_nodes.iter().flatten().copied();
    for node in moved.chain(body).chain(rig.skin_joints()) {
        let mut at = Some(node).filter(|node| *node < wanted.len());
        while let Some(node) = at.filter(|node| !wanted[*node]) {
            wanted[node] = true;
            at = rig.nodes[node].parent;
        }
    }
    wanted
}

/// The bones, parents first, under one root; names and places are still to come.
fn tree(rig: &Rig, wanted: &[bool], new_root: bool, changes: &mut Vec<String>) -> Vec<Bone> {
    let order: Vec<usize> = rig.parents_first().into_iter().filter(|node| wanted[*node]).collect();
    let tops = order.iter().filter(|node| rig.nodes[**node].parent.is_none()).count();
    let mut bones: Vec<Bone> = Vec::with_capacity(order.len() + 1);
    let bone = |source, parent| Bone {
        source,
        name: String::new(),
        parent,
        is_null: false,
        rest: Trs::IDENTITY,
        rest_global: DAffine3::IDENTITY,
        bind_global: DAffine3::IDENTITY,
        rest_from_node: None,
    };
    if new_root {
        bones.push(bone(Source::NewRoot, None));
    } else if tops > 1 {
        changes
            .push(format!("the skeleton has {tops} roots: in the FBX they hang from a bone Root, which stands still"));
        bones.push(bone(Source::Over, None));
    }
    let over = (!bones.is_empty()).then_some(0);
    let mut places = vec![None; rig.nodes.len()];
    for node in order {
        let parent = rig.nodes[node].parent.and_then(|parent| places[parent]).or(over);
        places[node] = Some(bones.len());
        bones.push(bone(Source::Node(node), parent));
    }
    bones
}

/// Names as the rig has them, each once; what FBX cannot hold is changed and told.
fn name(bones: &mut [Bone], rig: &Rig, changes: &mut Vec<String>) {
    let own = |bone: &Bone| match bone.source {
        Source::Node(node) => rig.nodes[node].name.clone().unwrap_or_default(),
        Source::NewRoot | Source::Over => NEW_ROOT.to_owned(),
    };
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut unnamed = Vec::new();
    // The rig's own names first: a Root that is added gives way.
    let mut order: Vec<usize> = (0..bones.len()).collect();
    order.sort_by_key(|bone| !matches!(bones[*bone].source, Source::Node(_)));
    for index in order {
        let wanted = own(&bones[index]);
        let mut name = held(&wanted);
        if name.is_empty() {
            name = match bones[index].source {
                Source::Node(node) => format!("node_{node}"),
                _ => NEW_ROOT.to_owned(),
            };
        }
        if taken.contains(&name) {
            name = (2..).map(|number| format!("{name}_{number}")).find(|name| !taken.contains(name)).unwrap_or(name);
        }
        if name != wanted {
            match wanted.is_empty() {
                true => unnamed.push(name.clone()),
                false => changes.push(format!("bone \"{}\" is \"{name}\" in the FBX", shown(&wanted))),
            }
        }
        taken.insert(name.clone());
        bones[index].name = name;
    }
    if !unnamed.is_empty() {
        changes.push(format!("nodes without a name got one in the FBX: {}", some_of(&unnamed)));
    }
}

/// A name as FBX can hold it: no control characters (a zero and a one end it), no "::" (it parts a name from its kind).
pub fn held(name: &str) -> String {
    let mut held: String = name.chars().map(|letter| if letter.is_control() { '_' } else { letter }).collect();
    while held.contains("::") {
        held = held.replace("::", "_");
    }
    while held.len() > LONGEST_NAME {
        held.pop();
    }
    held
}

/// The first three names, and how many more.
fn some_of(names: &[String]) -> String {
    let more = if names.len() > 3 { format!(" and {} more", names.len() - 3) } else { String::new() };
    names[..names.len().min(3)].join(", ") + &more
}

/// A name in a message.
pub fn shown(name: &str) -> String {
    name.chars().take(60).flat_map(char::escape_default).collect()
}

/// Rest and bind pose of every bone.
fn place(bones: &mut [Bone], rig: &Rig, file_from_document: &DAffine3, changes: &mut Vec<String>) {
    let size = file_from_document.matrix3.x_axis.length();
    let rests = nodes::globals(&rig.nodes, |node| node.local);
    let binds = nodes::globals(&rig.nodes, |node| node.bind);
    let kept = nulls(bones, rig);
    let mut scales = vec![1.0; bones.len()]; // of the null objects above and at each bone
    let mut lost = Vec::new();
    for index in 0..bones.len() {
        bones[index].is_null = kept[index];
        let parent = bones[index].parent;
        let above = parent.map_or(DAffine3::IDENTITY, |parent| bones[parent].rest_global);
        scales[index] = parent.map_or(1.0, |parent| scales[parent]);
        let Source::Node(node) = bones[index].source else {
            // At the origin of the document, turned as the file is.
            bones[index].rest_from_node = Some(file_from_document.inverse());
            continue;
        };
        let local = rig.nodes[node].local.scale;
        match kept[index] {
            true => scales[index] *= local.x,
            false if (local - DVec3::ONE).abs().max_element() > SAME_SCALE => lost.push(bones[index].name.clone()),
            false => {}
        }
        let placed = *file_from_document * rests[node];
        let rest = DAffine3 {
            matrix3: proper(&orientation(&(placed.matrix3 * (1.0 / size)))) * scales[index],
            translation: placed.translation,
        };
        let sound = placed.matrix3.determinant().abs() > f64::MIN_POSITIVE && placed.is_finite();
        let back = sound.then(|| placed.inverse()).filter(DAffine3::is_finite);
        let bind = back.map_or(rest, |back| *file_from_document * binds[node] * back * rest);
        let bone = &mut bones[index];
        bone.rest = decompose(&(above.inverse() * rest));
        bone.rest_global = rest;
        bone.bind_global = bind;
        bone.rest_from_node = back.map(|back| back * rest);
    }
    if !lost.is_empty() {
        let names = some_of(&lost);
        changes
            .push(format!("{names}: scaled in the rig. In the FBX bones have no scale, and are as long as they look"));
    }
}

/// (bones) which are null objects: those above all joints that are scaled alike in all axes, and what stands over them.
fn nulls(bones: &[Bone], rig: &Rig) -> Vec<bool> {
    let mut joints: BTreeSet<usize> = rig.skin_joints().into_iter().collect();
    joints.extend(rig.joint_nodes.iter().flatten().copied());
    let (mut over, mut kept) = (vec![true; bones.len()], vec![false; bones.len()]);
    for (index, bone) in bones.iter().enumerate() {
        let Source::Node(node) = bone.source else { continue };
        over[index] = !joints.contains(&node) && bone.parent.is_none_or(|parent| over[parent]);
        if !over[index] {
            continue;
        }
        let scale = rig.nodes[node].local.scale;
        if scale.min_element() <= 0.0 || scale.max_element() > scale.min_element() * (1.0 + SAME_SCALE) {
            return vec![false; bones.len()];
        }
        kept[index] = (scale.x - 1.0).abs() > SAME_SCALE;
    }
    for index in (0..bones.len()).rev() {
        if let (true, Some(parent)) = (kept[index], bones[index].parent) {
            kept[parent] = true;
        }
    }
    kept
}

/// Without a mirror.
fn proper(orientation: &DMat3) -> DMat3 {
    if orientation.determinant() < 0.0 {
        return DMat3 { z_axis: -orientation.z_axis, ..*orientation };
    }
    *orientation
}
