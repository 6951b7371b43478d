//! Every frame of a [`Recording`] in clip space (metres, Y up): where each joint of the body is and how it is turned from rest.
//!
//! The rig says where the joints stand at rest and which nodes they are; a joint without a node moves rigidly with its parent.

use super::skeleton::Recording;
use crate::maths::quat::shortest_arc;
use crate::model::Capture;
use crate::rig::{Rig, space};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Reads the whole recording as a clip of that name. `rig` has the recording's nodes, at rest in `bind`; `up` is the file's.
pub fn read(clip: &str, recording: &Recording, rig: &Rig, up: DVec3) -> Capture {
    let similarity = &rig.document_from_scenario;
    let clip_from_file = shortest_arc(up, DVec3::Y);
    let metres = 1.0 / similarity.scale;
    let wanted = wanted(recording, rig);
    let mut place = vec![DAffine3::IDENTITY; recording.names.len()];
    for &node in &recording.order {
        let above = recording.parents[node].map_or(DAffine3::IDENTITY, |parent| place[parent]);
        place[node] = above * rig.nodes[node].bind.affine();
    }
    let to_clip = DMat3::from_quat(clip_from_file);
    let from_rest = DMat3::from_quat(similarity.rotation);
    // A node's axes in the file to the turn of its joint: clip <- file <- node, node at rest -> file -> scenario.
    let joints: Vec<Option<(usize, DMat3, DVec3)>> = rig
        .joint_nodes
        .iter()
        .zip(&rig.body.joints)
        .map(|(node, joint)| {
            let node = (*node)?;
            let rest = orientation(&place[node].matrix3);
            Some((node, rest.transpose() * from_rest, similarity.inverse_point(place[node].translation) - joint.rest))
        })
        .collect();
    let count = rig.body.joints.len();
    let mut positions = Vec::with_capacity(recording.frames * count);
    let mut turns: Vec<DQuat> = Vec::with_capacity(recording.frames * count);
    for frame in 0..recording.frames {
        for &node in &wanted {
            let above = recording.parents[node].map_or(DAffine3::IDENTITY, |parent| place[parent]);
            place[node] = above * (recording.local)(frame, node).affine();
        }
        let base = positions.len();
        for (index, joint) in rig.body.joints.iter().enumerate() {
            let (position, turn) = match (&joints[index], joint.parent) {
                (Some((node, from_scenario, beside)), _) => {
                    let turn = to_clip * orientation(&place[*node].matrix3) * *from_scenario;
                    let node = to_clip * place[*node].translation * metres;
                    (node - turn * *beside, DQuat::from_mat3(&turn).normalize())
                }
                (None, Some(parent)) => {
                    let turn = turns[base + parent];
                    (positions[base + parent] + turn * rig.body.offset(index), turn)
                }
                (None, None) => (joint.rest, DQuat::IDENTITY),
            };
            positions.push(position);
            turns.push(turn);
        }
    }
    let mut notes = rig.mapping.warnings.clone();
    notes.retain(|note| !note.contains("has no mesh"));
    Capture {
        name: clip.to_owned(),
        fps: recording.fps,
        body: rig.body.clone(),
        positions,
        turns,
        units_to_metres: metres,
        up: space::axis_name(up),
        confidence: rig.mapping.confidence,
        method: rig.mapping.method.clone(),
        notes,
        pushes: Vec::new(),
    }
}

/// The orthogonal part of a transform: a rotation, mirrored where the transform mirrors.
pub fn orientation(linear: &DMat3) -> DMat3 {
    let x = linear.x_axis.normalize_or(DVec3::X);
    let y = (linear.y_axis - x * x.dot(linear.y_axis)).normalize_or(x.any_orthonormal_vector());
    let z = x.cross(y);
    DMat3::from_cols(x, y, if z.dot(linear.z_axis) < 0.0 { -z } else { z })
}

/// The nodes of the body's joints and what they hang from, parents first.
fn wanted(recording: &Recording, rig: &Rig) -> Vec<usize> {
    let mut wanted = vec![false; recording.names.len()];
    for node in rig.joint_nodes.iter().flatten() {
        let mut at = Some(*node);
        while let Some(node) = at.filter(|node| !wanted[*node]) {
            wanted[node] = true;
            at = recording.parents[node];
        }
    }
    recording.order.iter().copied().filter(|node| wanted[*node]).collect()
}
