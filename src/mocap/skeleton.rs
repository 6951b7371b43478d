//! Named nodes that move, without a mesh: finds the humanoid in them, a rest pose to measure it by, the unit and the up axis.
//!
//! In: local transforms in file units, any axes. Out: a [`Rig`] that stands at rest, and which way up is. A file's zero pose is taken
//! for the rest pose where a person could stand like that; else the frame that stands best. The feet of the rest pose are then laid as
//! they lie in the frames where they are slow and low: what is level is what bears, whatever the file's zero pose says. The frames
//! themselves are read in [`super::frames`].

use super::{MocapError, unit};
use crate::maths::quat::shortest_arc;
use crate::model::Role;
use crate::rig::nodes::decompose;
use crate::rig::space::{self, Landmarks};
use crate::rig::{Rig, RigError, RigNode, Trs, skeleton};
use glam::{DAffine3, DQuat, DVec3};
use std::collections::BTreeMap;

/// Frames that are looked at to find up, a rest pose and level feet.
const LOOKED_AT: usize = 240;
/// Nodes of all of them together.
const LOOKED_AT_NODES: usize = 500_000;
/// rad: a foot whose sole is nearer to level than that in the rest pose stays.
const LEVEL: f64 = 0.03;
/// Body against the up axis, and a leg's straightness (thigh along shank), from which a pose stands.
const STANDS: (f64, f64) = (0.9, 0.8);

/// Cosine from which a leg hangs down, and is straight: 15 degrees.
const HANGS: f64 = 0.966;
/// Of the body's own up along the up axis that a file names, from which the file is believed.
const BELIEVED: f64 = 0.2;

/// Nodes and how they move.
pub struct Recording<'a> {
    /// One a node.
    pub names: Vec<String>,
    /// One a node.
    pub parents: Vec<Option<usize>>,
    /// Every node, parents before children.
    pub order: Vec<usize>,
    /// Local transforms of the file's pose without animation.
    pub zero: Vec<Trs>,
    /// Hz.
    pub fps: f64,
    /// Frames, one at least.
    pub frames: usize,
    /// (frame, node) to its local transform.
    pub local: &'a dyn Fn(usize, usize) -> Trs,
    /// Metres a unit by the file's word, or what its format says.
    pub unit: f64,
    /// Up by the file's word.
    pub up: Option<DVec3>,
    /// The document's extensions, where they name bones.
    pub extensions: Option<&'a serde_json::Value>,
}

/// What a person says about a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Said<'a> {
    /// The text of `FILE.bones.toml`.
    pub overrides: Option<&'a str>,
    /// Which way up is.
    pub up: Option<DVec3>,
    /// Metres a unit.
    pub unit: Option<f64>,
}

/// The humanoid at its rest pose, in metres, and the file's up axis. `file` is its name in messages.
pub fn stand(file: &str, recording: &Recording, said: &Said) -> Result<(Rig, DVec3), MocapError> {
    let most = LOOKED_AT.min(LOOKED_AT_NODES / recording.names.len().max(1)).max(3);
    let step = recording.frames.div_ceil(most).max(1);
    let looked_at: Vec<usize> = (0..recording.frames).step_by(step).collect();
    let (mut rig, up) = find(file, recording, &looked_at, said)?;
    settle_unit(&mut rig, recording.unit, said.unit);
    Ok((rig, up))
}

/// Gives the rig the unit that a person says, or that its size shows.
pub fn settle_unit(rig: &mut Rig, by_file: f64, by_person: Option<f64>) {
    let scale = rig.document_from_scenario.scale;
    let found = match by_person {
        Some(metres) => unit::Unit { metres, note: None },
        None => unit::of(rig.body.leg_length * scale, rig.body.height * scale, by_file),
    };
    rig.mapping.warnings.retain(|note| !note.contains("units high: taken as"));
    rig.mapping.warnings.extend(found.note);
    unit::resize(rig, found.metres * scale);
}

/// The humanoid at its rest pose, and the file's up axis as the motion shows it.
fn find(file: &str, recording: &Recording, looked_at: &[usize], said: &Said) -> Result<(Rig, DVec3), MocapError> {
    let pose =
        |frame: usize| -> Vec<Trs> { (0..recording.names.len()).map(|node| (recording.local)(frame, node)).collect() };
    let stand = |locals: &[Trs]| skeleton(file, nodes(recording, locals), recording.extensions, said.overrides);
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
    let shown = sum / tracks.len().max(1) as f64;
    let believed = recording.up.filter(|up| shown.dot(*up) > BELIEVED);
    let up = said.up.or(believed).unwrap_or_else(|| space::nearest_axis(shown));
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
        let best = best.unwrap_or(0);
        let own_up = marks(&tracks[best]).map_or(up, |marks| space::nearest_axis(marks.body_up()));
        (pose(looked_at[best]), own_up)
    };
    straighten_legs(recording, &bones, rest_up, &mut rest);
    level_feet(recording, &bones, &tracks, up, rest_up, &mut rest);
    Ok((stand(&rest)?, up))
}

/// Lets both legs of the rest pose hang straight down where one of them does not: a stride is no pose to measure a foot's height in.
fn straighten_legs(recording: &Recording, bones: &BTreeMap<Role, usize>, up: DVec3, rest: &mut [Trs]) {
    use Role::{LeftFoot, LeftLowerLeg, LeftUpperLeg, RightFoot, RightLowerLeg, RightUpperLeg};
    let legs = [[LeftUpperLeg, LeftLowerLeg, LeftFoot], [RightUpperLeg, RightLowerLeg, RightFoot]];
    let legs = legs.map(|leg| leg.map(|role| bones.get(&role).copied()));
    let [Some(left), Some(right)] = legs.map(|[hip, knee, foot]| Some([hip?, knee?, foot?])) else { return };
    let along = |globals: &[DAffine3], from: usize, to: usize| {
        (globals[to].translation - globals[from].translation).normalize_or(-up)
    };
    let before = globals(recording, rest);
    let hangs = |[hip, knee, foot]: [usize; 3]| {
        let bend = along(&before, hip, knee).dot(along(&before, knee, foot));
        along(&before, hip, foot).dot(-up) > HANGS && bend > HANGS
    };
    if hangs(left) && hangs(right) {
        return;
    }
    for (bone, next) in [left, right].into_iter().flat_map(|[hip, knee, foot]| [(hip, knee), (knee, foot)]) {
        let globals = globals(recording, rest);
        let turn = shortest_arc(along(&globals, bone, next), -up);
        let above = recording.parents[bone].map_or(DQuat::IDENTITY, |parent| decompose(&globals[parent]).rotation);
        rest[bone].rotation = (above.inverse() * turn * decompose(&globals[bone]).rotation).normalize();
    }
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
            mesh: None,
            skin: None,
        })
        .collect();
    for (index, parent) in recording.parents.iter().enumerate() {
        if let Some(parent) = parent {
            nodes[*parent].children.push(index);
        }
    }
    nodes
}

/// World transforms, file units.
pub fn globals(recording: &Recording, locals: &[Trs]) -> Vec<DAffine3> {
    let mut globals = vec![DAffine3::IDENTITY; locals.len()];
    for &node in &recording.order {
        let above = recording.parents[node].map_or(DAffine3::IDENTITY, |parent| globals[parent]);
        globals[node] = above * locals[node].affine();
    }
    globals
}
