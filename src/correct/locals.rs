//! Back to the file's own nodes: new local transforms for the nodes of what was changed, in the frames that were.
//!
//! The inverse of `mocap::frames`: clip space (metres, Y up) to file axes and units. A node gets a new rotation where its joint's turn
//! relative to its parent's became another, a new translation where the hips went; every other local transform is the file's. The change is
//! carried over, not the pose: what the file says in the last decimal stays.

use super::Corrected;
use crate::maths::quat::shortest_arc;
use crate::mocap::frames::orientation;
use crate::mocap::{ClipFile, Options, Reading};
use crate::model::Capture;
use crate::rig::Trs;
use crate::rig::clips::{Tracks, read_tracks};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::collections::BTreeMap;

/// New local transforms by frame and node, file units.
pub type Edits = BTreeMap<(usize, usize), Trs>;

/// Rotations nearer than that (sine of half the angle) are the same.
const SAME: f64 = 1e-9;

/// A file's own local transforms, frame by frame.
pub enum Source<'a> {
    /// Of a BVH's joints.
    Bvh(&'a crate::mocap::bvh::Bvh),
    /// Of a document's nodes: the tracks, the first frame's time (s), frames a second.
    Gltf(Box<Tracks>, f64, f64),
}

impl<'a> Source<'a> {
    /// Of a clip of a file; `None` for FBX, which has to become a GLB first.
    pub fn of(file: &'a ClipFile, clip: usize, reading: &Reading) -> Option<Source<'a>> {
        if let Some(bvh) = file.bvh() {
            return Some(Source::Bvh(bvh));
        }
        let tracks = read_tracks(file.document()?, reading.rig.nodes.len(), clip).ok()?;
        Some(Source::Gltf(Box::new(tracks), reading.start, reading.capture.fps))
    }

    /// A node's.
    pub fn local(&self, frame: usize, node: usize, rest: &Trs) -> Trs {
        match self {
            Source::Bvh(bvh) => bvh.local(frame, node),
            Source::Gltf(tracks, start, fps) => tracks.local(node, start + frame as f64 / fps, rest),
        }
    }
}

/// What the file's nodes have to become.
pub fn edits(reading: &Reading, source: &Source, corrected: &Corrected) -> Edits {
    let (rig, old) = (&reading.rig, &reading.capture);
    let to_file = shortest_arc(reading.frame_up, DVec3::Y).inverse();
    let units = rig.document_from_scenario.scale;
    let mut joint_of: BTreeMap<usize, usize> = BTreeMap::new();
    for (joint, node) in rig.joint_nodes.iter().enumerate() {
        if let Some(node) = node {
            joint_of.entry(*node).or_insert(joint);
        }
    }
    // What hangs from no node that the hips carry has to be moved by itself.
    let hips = rig.joint_nodes.first().copied().flatten();
    let carried = |node: usize| {
        let mut at = rig.nodes[node].parent;
        while let Some(above) = at {
            if Some(above) == hips || joint_of.contains_key(&above) {
                return true;
            }
            at = rig.nodes[above].parent;
        }
        false
    };
    let order = wanted(reading);
    let mut edits = Edits::new();
    for frame in corrected.changed.keys().copied() {
        let new = &corrected.capture;
        let mut places = vec![DAffine3::IDENTITY; rig.nodes.len()];
        let mut deltas = vec![DQuat::IDENTITY; rig.nodes.len()]; // file axes: what each node is turned by
        for &node in &order {
            let parent = rig.nodes[node].parent;
            let above = parent.map_or(DAffine3::IDENTITY, |parent| places[parent]);
            let turned = parent.map_or(DQuat::IDENTITY, |parent| deltas[parent]);
            let mut local = source.local(frame, node, &rig.nodes[node].local);
            places[node] = above * local.affine();
            let Some(joint) = joint_of.get(&node).copied() else {
                deltas[node] = turned;
                continue;
            };
            let own = delta(old, new, frame, joint);
            deltas[node] = to_file * own * to_file.inverse();
            let mut edited = false;
            let by = turned.inverse() * deltas[node];
            if DVec3::new(by.x, by.y, by.z).length() > SAME {
                let axes = orientation(&above.matrix3);
                let inside = DQuat::from_mat3(&(axes.transpose() * DMat3::from_quat(by) * axes));
                local.rotation = (inside * local.rotation).normalize();
                edited = true;
            }
            let moved = new.at(frame)[joint] - old.at(frame)[joint];
            if !carried(node) && moved.length() > SAME {
                local.translation += above.matrix3.inverse() * (to_file * moved * units);
                edited = true;
            }
            if edited {
                edits.insert((frame, node), local);
            }
        }
    }
    edits
}

/// What a joint is turned by, clip space; exactly nothing where its turn is the same.
fn delta(old: &Capture, new: &Capture, frame: usize, joint: usize) -> DQuat {
    let (was, is) = (old.turns_at(frame)[joint], new.turns_at(frame)[joint]);
    if was == is { DQuat::IDENTITY } else { is * was.inverse() }
}

/// Nodes of joints and what they hang from, parents first.
fn wanted(reading: &Reading) -> Vec<usize> {
    let rig = &reading.rig;
    let mut wanted = vec![false; rig.nodes.len()];
    for node in rig.joint_nodes.iter().flatten() {
        let mut at = Some(*node);
        while let Some(node) = at.filter(|node| !wanted[*node]) {
            wanted[node] = true;
            at = rig.nodes[node].parent;
        }
    }
    rig.parents_first().into_iter().filter(|node| wanted[*node]).collect()
}

/// m: the farthest that a joint of the file that was written is from where it was meant to be.
pub fn written_off_by(meant: &Capture, written: &Capture) -> f64 {
    let pairs = meant.positions.iter().zip(&written.positions);
    if meant.positions.len() != written.positions.len() {
        return f64::INFINITY;
    }
    pairs.map(|(meant, written)| meant.distance(*written)).fold(0.0, f64::max)
}

/// A file's bytes, read as a clip again.
pub fn read_back(name: &str, bytes: &[u8], clip: usize, options: &Options) -> Option<Capture> {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    crate::mocap::read(name, bytes, &alone, None).ok()?.capture(clip, options).ok()
}
