//! Named nodes that move to a [`Capture`]: finds the humanoid, a rest pose to measure it by, the unit and the up axis.
//!
//! In: local transforms in file units, any axes. Out: clip space (metres, Y up). A file's zero pose is taken for the rest pose where a
//! person could stand like that; else the frame that stands best. The feet of the rest pose are then laid as they lie in the frames
//! where they are slow and low: what is level is what bears, whatever the file's zero pose says. Leaves out scale (taken as it is).

use super::MocapError;
use crate::maths::quat::shortest_arc;
use crate::model::{Capture, Role};
use crate::rig::nodes::decompose;
use crate::rig::space::{self, Landmarks};
use crate::rig::{Rig, RigError, RigNode, Trs, skeleton};
use glam::{DAffine3, DQuat, DVec3};
use std::collections::BTreeMap;

/// Frames that are looked at to find up, a rest pose and level feet.
const LOOKED_AT: usize = 240;
/// rad: a foot whose sole is nearer to level than that in the rest pose stays.
const LEVEL: f64 = 0.03;
/// Body against the up axis, and a leg's straightness (thigh along shank), from which a pose stands.
const STANDS: (f64, f64) = (0.9, 0.8);

/// Nodes and how they move.
pub struct Recording<'a> {
    /// One a node.
    pub names: Vec<String>,
    /// One a node, smaller than its own index.
    pub parents: Vec<Option<usize>>,
    /// Local transforms of the file's pose without animation.
    pub zero: Vec<Trs>,
    /// Hz.
    pub fps: f64,
    /// Frames, one at least.
    pub frames: usize,
    /// (frame, node) to its local transform.
    pub local: &'a dyn Fn(usize, usize) -> Trs,
}

/// Hz of a frame time: the whole number that is meant where it is within a few millionths of one.
pub fn rate(frame_time: f64) -> f64 {
    let fps = 1.0 / frame_time;
    if (fps - fps.round()).abs() < 2e-4 * fps { fps.round() } else { (fps * 1000.0).round() / 1000.0 }
}

/// Reads the whole recording. `file` is its name in messages, `clip` the clip's; `overrides` the text of `FILE.bones.toml`.
pub fn capture(file: &str, clip: &str, recording: &Recording, overrides: Option<&str>) -> Result<Capture, MocapError> {
    let step = recording.frames.div_ceil(LOOKED_AT).max(1);
    let looked_at: Vec<usize> = (0..recording.frames).step_by(step).collect();
    let (rig, up) = find(file, recording, &looked_at, overrides)?;
    Ok(read(clip, recording, &rig, up))
}

/// The humanoid at its rest pose, and the file's up axis as the motion shows it.
fn find(
    file: &str,
    recording: &Recording,
    looked_at: &[usize],
    overrides: Option<&str>,
) -> Result<(Rig, DVec3), MocapError> {
    let pose =
        |frame: usize| -> Vec<Trs> { (0..recording.names.len()).map(|node| (recording.local)(frame, node)).collect() };
    let stand = |locals: &[Trs]| skeleton(file, nodes(recording, locals), overrides);
    // Roles first: by the zero pose, else by frames of the motion.
    let zero = stand(&recording.zero);
    let middle = looked_at.len() / 2;
    let mut first: Result<Rig, RigError> = zero;
    for at in [middle, 0, looked_at.len() / 4, 3 * looked_at.len() / 4] {
        if first.is_ok() {
            break;
        }
        if let Ok(rig) = stand(&pose(looked_at[at])) {
            first = Ok(rig);
        }
    }
    let bones = first?.mapping.bones;
    let tracks: Vec<Vec<DAffine3>> = looked_at.iter().map(|frame| globals(recording, &pose(*frame))).collect();
    let marks = |globals: &[DAffine3]| {
        let places: Vec<DVec3> = globals.iter().map(|global| global.translation).collect();
        Landmarks::of(&bones, &places)
    };
    let sum: DVec3 = tracks.iter().filter_map(|globals| marks(globals)).map(|marks| marks.body_up()).sum();
    let up = space::nearest_axis(sum);
    let standing = |globals: &[DAffine3], up: DVec3| {
        let Some(marks) = marks(globals) else { return (0.0, 0.0) };
        let place = |role: Role| bones.get(&role).map(|node| globals[*node].translation);
        let straight = |hip: Role, knee: Role, foot: Role| match (place(hip), place(knee), place(foot)) {
            (Some(hip), Some(knee), Some(foot)) => {
                (knee - hip).normalize_or_zero().dot((foot - knee).normalize_or_zero())
            }
            _ => 1.0,
        };
        let left = straight(Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot);
        let right = straight(Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot);
        let legs = (marks.hips - marks.feet).normalize_or_zero().dot(up);
        (marks.body_up().dot(up).min(legs), left.min(right))
    };
    let zero_globals = globals(recording, &recording.zero);
    let zero_up = marks(&zero_globals).map_or(up, |marks| space::nearest_axis(marks.body_up()));
    let (upright, straight) = standing(&zero_globals, zero_up);
    let (mut rest, rest_up) = if upright > STANDS.0 && straight > STANDS.1 {
        (recording.zero.clone(), zero_up)
    } else {
        let score = |globals: &[DAffine3]| {
            let (upright, straight) = standing(globals, up);
            upright + straight
        };
        let best = (0..tracks.len()).max_by(|a, b| score(&tracks[*a]).total_cmp(&score(&tracks[*b])).then(b.cmp(a)));
        (pose(looked_at[best.unwrap_or(0)]), up)
    };
    level_feet(recording, &bones, &tracks, up, rest_up, &mut rest);
    Ok((stand(&rest)?, up))
}

/// Turns the rest pose's feet and toes so that what lies level in stance lies level there.
fn level_feet(
    recording: &Recording,
    bones: &BTreeMap<Role, usize>,
    tracks: &[Vec<DAffine3>],
    up: DVec3,
    rest_up: DVec3,
    rest: &mut [Trs],
) {
    for roles in [[Role::LeftFoot, Role::LeftToes], [Role::RightFoot, Role::RightToes]] {
        let Some(ankle) = bones.get(&roles[0]).copied() else { continue };
        let slow = slow_frames(tracks, ankle, up);
        if slow.len() < 3 {
            continue;
        }
        for role in roles {
            let Some(node) = bones.get(&role).copied() else { continue };
            let turn = |globals: &[DAffine3]| decompose(&globals[node]).rotation;
            let own_up: DVec3 = slow.iter().map(|frame| turn(&tracks[*frame]).inverse() * up).sum();
            let globals = globals(recording, rest);
            let now = turn(&globals);
            let shown = now * own_up.normalize_or(now.inverse() * rest_up);
            if shown.angle_between(rest_up) < LEVEL {
                continue;
            }
            let parent = recording.parents[node].map_or(DQuat::IDENTITY, |parent| decompose(&globals[parent]).rotation);
            rest[node].rotation = (parent.inverse() * shortest_arc(shown, rest_up) * now).normalize();
        }
    }
}

/// The tenth of the looked-at frames in which a node is slowest and lowest, three at least.
fn slow_frames(tracks: &[Vec<DAffine3>], node: usize, up: DVec3) -> Vec<usize> {
    let place = |at: usize| tracks[at][node].translation;
    let mut cost: Vec<(f64, usize)> = (1..tracks.len().saturating_sub(1))
        .map(|at| ((place(at + 1) - place(at - 1)).length() + 0.2 * place(at).dot(up), at))
        .collect();
    cost.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    cost.truncate((cost.len() / 10).max(3));
    cost.into_iter().map(|(_, at)| at).collect()
}

fn nodes(recording: &Recording, locals: &[Trs]) -> Vec<RigNode> {
    let mut nodes: Vec<RigNode> = recording
        .names
        .iter()
        .zip(locals)
        .enumerate()
        .map(|(index, (name, local))| RigNode {
            name: Some(name.clone()),
            parent: recording.parents[index],
            children: Vec::new(),
            local: *local,
            bind: *local,
            has_matrix: false,
        })
        .collect();
    for (index, parent) in recording.parents.iter().enumerate() {
        if let Some(parent) = parent {
            nodes[*parent].children.push(index);
        }
    }
    nodes
}

fn globals(recording: &Recording, locals: &[Trs]) -> Vec<DAffine3> {
    let mut globals: Vec<DAffine3> = Vec::with_capacity(locals.len());
    for (parent, local) in recording.parents.iter().zip(locals) {
        let above = parent.map_or(DAffine3::IDENTITY, |parent| globals[parent]);
        globals.push(above * local.affine());
    }
    globals
}

/// Every frame, in clip space.
fn read(clip: &str, recording: &Recording, rig: &Rig, up: DVec3) -> Capture {
    let similarity = &rig.document_from_scenario;
    let clip_from_file = shortest_arc(up, DVec3::Y);
    let metres = 1.0 / similarity.scale;
    let wanted = wanted(recording, rig);
    let rest: Vec<DAffine3> = globals(recording, &rig.nodes.iter().map(|node| node.bind).collect::<Vec<_>>());
    let rest_inverse: Vec<DQuat> = rest.iter().map(|global| decompose(global).rotation.inverse()).collect();
    let joints = rig.body.joints.len();
    let mut positions = Vec::with_capacity(recording.frames * joints);
    let mut turns: Vec<DQuat> = Vec::with_capacity(recording.frames * joints);
    let mut place = vec![DAffine3::IDENTITY; rest.len()];
    for frame in 0..recording.frames {
        for &node in &wanted {
            let above = recording.parents[node].map_or(DAffine3::IDENTITY, |parent| place[parent]);
            place[node] = above * (recording.local)(frame, node).affine();
        }
        let base = positions.len();
        for (index, joint) in rig.body.joints.iter().enumerate() {
            let (position, turn) = match (rig.joint_nodes[index], joint.parent) {
                (Some(node), _) => {
                    let turn = decompose(&place[node]).rotation * rest_inverse[node] * similarity.rotation;
                    let offset = similarity.point(joint.rest) - rest[node].translation; // a joint may stand beside its node
                    let moved = place[node].translation + turn * (similarity.rotation.inverse() * offset);
                    (clip_from_file * moved * metres, (clip_from_file * turn).normalize())
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
    }
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
    (0..wanted.len()).filter(|node| wanted[*node]).collect()
}
