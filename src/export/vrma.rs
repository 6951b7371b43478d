//! A clip as a VRM animation (VRMC_vrm_animation 1.0): bones by role at the VRM T-pose, turned from there.
//!
//! In: a rig's clip, document units, whatever its rest pose and axes. Out: a GLB of bare bones in metres, Y up, +Z ahead, whose rest
//! transforms have no rotation, so that a bone's keys are its turn from the T-pose. Only the hips are moved, and carry all of the way,
//! whichever node of the rig did. No scale, no mesh, no eyes (the format's look-at is another thing). Keys stand where the clip's do;
//! what lies on the arc between its neighbours goes. A VRM file's own ground and origin are kept, so that it plays its own clip as it was
//! baked; any other rig stands on y = 0. Contacts and events are in `extras.surefoot`, in this file's own space.

use super::ExportError;
use super::events::report_json;
use super::glb::container;
use super::tpose::{is_vrm, t_pose};
use crate::bake::keys::NEAREST;
use crate::model::{Clip, ClipReport, Interpolation, KeyValues, Role};
use crate::rig::Rig;
use crate::rig::animate::{chord, slerp};
use glam::{DQuat, DVec3};
use serde_json::{Map, Value, json};

/// The bones that every VRM animation has.
pub const REQUIRED: [Role; 15] = [
    Role::Hips,
    Role::Spine,
    Role::Head,
    Role::LeftUpperArm,
    Role::LeftLowerArm,
    Role::LeftHand,
    Role::RightUpperArm,
    Role::RightLowerArm,
    Role::RightHand,
    Role::LeftUpperLeg,
    Role::LeftLowerLeg,
    Role::LeftFoot,
    Role::RightUpperLeg,
    Role::RightLowerLeg,
    Role::RightFoot,
];
/// rad: a key that is nearer to the arc between its neighbours goes.
const SAME_TURN: f64 = 2e-5;
/// m: the same for the hips' way.
const SAME_PLACE: f64 = 1e-5;
/// Of the height: hips that are lower over a VRM's origin are not standing on it.
const LOWEST_HIPS: f64 = 0.1;

/// A VRM animation is done.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedVrma {
    /// The file.
    pub bytes: Vec<u8>,
    /// What the clip says about itself, in the file's space.
    pub report: ClipReport,
    /// What the format cannot say, as sentences.
    pub losses: Vec<String>,
}

/// A bone of the file.
struct Bone {
    role: Role,
    joint: usize,
    parent: Option<usize>, // into the bones
    rest: DVec3,           // m, file space
}

/// The bytes of a VRM animation of that clip.
pub fn vrma(rig: &Rig, clip: &Clip, report: &ClipReport) -> Result<ExportedVrma, ExportError> {
    let times = times(clip);
    let moved = Moved::read(rig, clip, &times)?;
    let still = t_pose(rig, &moved.rest);
    let bones = bones(rig, &moved, &still);
    let to_file = file_offset(rig, &moved);
    let mut file = Bytes::default();
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    let mut add = |node: usize, path: &str, kind: &str, keys: &[(f32, Vec<f32>)], file: &mut Bytes| {
        let times: Vec<f32> = keys.iter().map(|(time, _)| *time).collect();
        let values: Vec<f32> = keys.iter().flat_map(|(_, value)| value.iter().copied()).collect();
        let (input, output) =
            (file.accessor("SCALAR", &times, 1), file.accessor(kind, &values, values.len() / times.len()));
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "interpolation": "LINEAR", "output": output }));
    };
    let hips: Vec<DVec3> = moved.hips.iter().map(|place| *place + to_file).collect();
    let kept = thin(&times, |from, to, at, share| hips[from].lerp(hips[to], share).distance(hips[at]) <= SAME_PLACE);
    let key = |at: usize| (times[at], hips[at].to_array().map(stored).to_vec());
    add(1, "translation", "VEC3", &kept.into_iter().map(key).collect::<Vec<_>>(), &mut file);
    for (index, bone) in bones.iter().enumerate() {
        let from_t = |at: usize, joint: usize| moved.turns[at][joint] * still[joint].inverse();
        let turns: Vec<DQuat> = (0..times.len())
            .map(|at| match bone.parent {
                Some(parent) => from_t(at, bones[parent].joint).inverse() * from_t(at, bone.joint),
                None => from_t(at, bone.joint),
            })
            .collect();
        let same = |a: DQuat, b: DQuat| chord(a, b) <= SAME_TURN;
        if index > 0 && turns.iter().all(|turn| same(*turn, DQuat::IDENTITY)) {
            continue;
        }
        let kept = thin(&times, |from, to, at, share| same(slerp(turns[from], turns[to], share), turns[at]));
        let mut keys: Vec<(f32, Vec<f32>)> = Vec::with_capacity(kept.len());
        for at in kept {
            let turn = turns[at].normalize().to_array().map(stored);
            let opposite = keys
                .last()
                .map_or(turn[3] < 0.0, |(_, before)| before.iter().zip(&turn).map(|(a, b)| a * b).sum::<f32>() < 0.0);
            keys.push((times[at], if opposite { turn.map(|part| 0.0 - part) } else { turn }.to_vec()));
        }
        add(index + 1, "rotation", "VEC4", &keys, &mut file);
    }
    let report = in_file_space(rig, report, to_file);
    let mut animation = json!({ "channels": channels, "samplers": samplers, "name": clip.name });
    animation["extras"] = json!({ "surefoot": report_json(&clip.name, &report)? });
    let root = json!({
        "asset": { "version": "2.0", "generator": report.generator },
        "extensionsUsed": ["VRMC_vrm_animation"],
        "extensions": { "VRMC_vrm_animation": { "specVersion": "1.0", "humanoid": { "humanBones": human_bones(&bones) } } },
        "scene": 0,
        "scenes": [{ "nodes": [0], "extras": { "surefoot": { "mass_kg": (report.body.mass * 1e4).round() / 1e4 } } }],
        "nodes": nodes(&bones),
        "animations": [animation],
        "accessors": file.accessors,
        "bufferViews": [{ "buffer": 0, "byteLength": file.bytes.len() }],
        "buffers": [{ "byteLength": file.bytes.len() }],
    });
    let scales = clip.channels.iter().any(|channel| matches!(channel.values, KeyValues::Scale(_)));
    let losses = scales.then(|| {
        "a VRM animation cannot scale bones: on a character of its own legs the feet are where that character's are"
            .to_owned()
    });
    Ok(ExportedVrma { bytes: container(&root, file.bytes)?, report, losses: losses.into_iter().collect() })
}

/// Every time at which the clip has a key or a frame, and its end: straight lines need them where the clip's own keys are joined by curves.
fn times(clip: &Clip) -> Vec<f32> {
    let mut times: Vec<f32> = clip.channels.iter().flat_map(|channel| channel.times.iter().copied()).collect();
    let curved = clip.channels.iter().any(|channel| channel.interpolation == Interpolation::Cubic);
    let fps = clip.fps.max(1e-6) * if curved { 3.0 } else { 1.0 };
    let frames = (clip.duration * fps).floor().clamp(0.0, 1e6) as usize;
    times.extend((0..=frames).map(|frame| (frame as f64 / fps) as f32));
    times.extend([0.0, clip.duration as f32]);
    times.retain(|time| *time >= 0.0);
    times.sort_by(f32::total_cmp);
    times.dedup_by(|later, earlier| f64::from(*later - *earlier) < NEAREST);
    times
}

/// The clip as its joints show it.
struct Moved {
    turns: Vec<Vec<DQuat>>, // (times, joints) from rest
    hips: Vec<DVec3>,       // (times) m, scenario space: the hips' node
    rest: Vec<DVec3>,       // (joints) m: where the nodes stand at rest, with the lengths that the clip gives them
    still: DVec3,           // m, scenario space: the hips' node at rest, of a VRM as its file has it without a clip
}

impl Moved {
    fn read(rig: &Rig, clip: &Clip, times: &[f32]) -> Result<Moved, ExportError> {
        let body = &rig.body;
        let node = rig.hips_node();
        let mut sampler = rig.sampler(clip);
        let (mut turns, mut hips) = (Vec::with_capacity(times.len()), Vec::with_capacity(times.len()));
        let mut rest = vec![body.joints[0].rest; body.joints.len()];
        for (at, time) in times.iter().enumerate() {
            let pose = sampler.sample(f64::from(*time));
            let globals = sampler.node_globals(f64::from(*time));
            let fine = pose.turns.iter().all(|turn| turn.is_finite()) && pose.positions.iter().all(|it| it.is_finite());
            if !fine {
                let (clip, node) = (clip.name.clone(), "a joint".to_owned());
                return Err(ExportError::NotFinite { clip, node, time: f64::from(*time) });
            }
            let place = |joint: usize| match rig.joint_nodes[joint] {
                Some(node) if body.joints[joint].animated => globals[node].translation,
                _ => pose.positions[joint],
            };
            if at == 0 {
                for (joint, one) in body.joints.iter().enumerate() {
                    if let Some(parent) = one.parent {
                        rest[joint] = rest[parent] + pose.turns[parent].inverse() * (place(joint) - place(parent));
                    }
                }
            }
            hips.push(globals.get(node).map_or(pose.hips, |global| global.translation));
            turns.push(pose.turns);
        }
        let none = Clip { name: String::new(), fps: clip.fps, duration: 0.0, channels: Vec::new() };
        let at_rest = if is_vrm(rig) { rig.sampler(&none).node_globals(0.0).to_vec() } else { rig.bind_globals() };
        let still = at_rest.get(node).map_or(body.joints[0].rest, |global| global.translation);
        Ok(Moved { turns, hips, rest, still })
    }
}

/// From scenario space to the file's: a VRM keeps its own origin, any other rig gets the scenario's; so does a VRM whose hips lie on
/// its origin, since players scale the way by the hips' height.
fn file_offset(rig: &Rig, moved: &Moved) -> DVec3 {
    let similarity = &rig.document_from_scenario;
    let own = similarity.rotation.inverse() * similarity.translation / similarity.scale;
    let over = (moved.still + own).y > LOWEST_HIPS * rig.body.height;
    if is_vrm(rig) && own.is_finite() && over { own } else { DVec3::ZERO }
}

/// The bones, parents first, at the T-pose.
fn bones(rig: &Rig, moved: &Moved, still: &[DQuat]) -> Vec<Bone> {
    let body = &rig.body;
    let mut bones: Vec<Bone> = Vec::new();
    for role in Role::ALL.iter().copied() {
        if matches!(role, Role::Jaw | Role::LeftEye | Role::RightEye) {
            continue;
        }
        let Some(joint) = body.joint(role) else { continue };
        if !REQUIRED.contains(&role) && !body.joints[joint].animated {
            continue;
        }
        // Upwards to the next bone that is there; the format lets no bone skip one within a finger, nor an upper chest its chest.
        let mut above = role.parent();
        while above.is_some_and(|above| bones.iter().all(|bone| bone.role != above)) {
            above = above.and_then(Role::parent);
        }
        let must = match role {
            Role::UpperChest => Some(Role::Chest),
            _ if ["Intermediate", "Distal", "ThumbProximal"].iter().any(|end| role.name().ends_with(end)) => {
                role.parent()
            }
            _ => None,
        };
        if must.is_some_and(|must| above != Some(must)) {
            continue;
        }
        let parent = above.and_then(|above| bones.iter().position(|bone| bone.role == above));
        bones.push(Bone { role, joint, parent, rest: DVec3::ZERO });
    }
    // Every joint at the T-pose, from the hips down.
    let mut places = vec![moved.still; body.joints.len()];
    for (joint, one) in body.joints.iter().enumerate() {
        if let Some(parent) = one.parent {
            places[joint] = places[parent] + still[parent] * (moved.rest[joint] - moved.rest[parent]);
        }
    }
    let mut offset = file_offset(rig, moved);
    if !is_vrm(rig) {
        let soles = body.feet.iter().map(|foot| places[foot.ankle].y - foot.ankle_height);
        offset.y -= soles.fold(f64::INFINITY, f64::min);
    }
    for bone in &mut bones {
        bone.rest = places[bone.joint] + offset;
    }
    bones
}

fn human_bones(bones: &[Bone]) -> Value {
    let named =
        bones.iter().enumerate().map(|(index, bone)| (bone.role.name().to_owned(), json!({ "node": index + 1 })));
    Value::Object(named.collect::<Map<String, Value>>())
}

/// A root at the origin, then the bones.
fn nodes(bones: &[Bone]) -> Vec<Value> {
    let mut nodes = vec![json!({ "name": "Root", "children": [1] })];
    for (index, bone) in bones.iter().enumerate() {
        let above = bone.parent.map_or(DVec3::ZERO, |parent| bones[parent].rest);
        let place = (bone.rest - above).to_array().map(|part| f64::from(stored(part)));
        let children: Vec<usize> =
            (0..bones.len()).filter(|child| bones[*child].parent == Some(index)).map(|child| child + 1).collect();
        let mut node = json!({ "name": bone.role.name(), "translation": place });
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        nodes.push(node);
    }
    nodes
}

/// The report's places and forces where this file has them, and the way: in the hips, unless it was left out.
fn in_file_space(rig: &Rig, report: &ClipReport, offset: DVec3) -> ClipReport {
    let similarity = &rig.document_from_scenario;
    let back = similarity.rotation.inverse();
    let mut report = report.clone();
    if report.root_motion == "root" {
        report.root_motion = "hips".into();
    }
    for contact in &mut report.contacts {
        contact.position = (similarity.inverse_point(contact.position.into()) + offset).to_array();
        contact.normal = (back * DVec3::from(contact.normal)).to_array();
    }
    for push in &mut report.disturbances {
        push.force = (back * DVec3::from(push.force)).to_array();
    }
    report
}

/// The keys to keep so that each other is `fits(from, to, at, share)`: each time the farthest that can be reached.
fn thin(times: &[f32], fits: impl Fn(usize, usize, usize, f64) -> bool) -> Vec<usize> {
    let spans = |from: usize, to: usize| {
        (from + 1..to).all(|at| {
            let share = f64::from(times[at] - times[from]) / f64::from(times[to] - times[from]);
            fits(from, to, at, share)
        })
    };
    let last = times.len().saturating_sub(1);
    let (mut kept, mut at) = (vec![0], 0);
    while at < last {
        let (mut good, mut stride) = (at + 1, 2);
        while at + stride <= last && spans(at, at + stride) {
            good = at + stride;
            stride *= 2;
        }
        let mut bad = (at + stride).min(last + 1);
        while good + 1 < bad {
            let middle = good.midpoint(bad);
            if spans(at, middle) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        kept.push(good);
        at = good;
    }
    kept
}

/// As a file stores it; never -0.
fn stored(value: f64) -> f32 {
    value as f32 + 0.0
}

/// The buffer and its accessors; equal data is written once.
#[derive(Default)]
struct Bytes {
    bytes: Vec<u8>,
    accessors: Vec<Value>,
    seen: std::collections::BTreeMap<(String, Vec<u8>), usize>,
}

impl Bytes {
    fn accessor(&mut self, kind: &str, values: &[f32], width: usize) -> usize {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        if let Some(index) = self.seen.get(&(kind.to_owned(), data.clone())) {
            return *index;
        }
        let mut accessor = json!({ "bufferView": 0, "byteOffset": self.bytes.len(), "componentType": 5126,
            "count": values.len() / width.max(1), "type": kind });
        if kind == "SCALAR" {
            accessor["min"] = json!([f64::from(values.iter().copied().fold(f32::INFINITY, f32::min))]);
            accessor["max"] = json!([f64::from(values.iter().copied().fold(f32::NEG_INFINITY, f32::max))]);
        }
        self.bytes.extend_from_slice(&data);
        self.accessors.push(accessor);
        self.seen.insert((kind.to_owned(), data), self.accessors.len() - 1);
        self.accessors.len() - 1
    }
}
