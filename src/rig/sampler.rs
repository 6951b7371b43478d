//! A clip read back as a glTF reader would: f32 keys, linear, spherical, cubic and step interpolation, unanimated nodes as the file
//! has them.
//!
//! Globals are in scenario space (metres). A joint's turn is its node's global rotation from the bind pose.

use super::Rig;
use super::animate::orientation;
use crate::maths::real;
use crate::model::{BodyPose, Clip, Interpolation, KeyValues, Target};
use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

/// What a clip shows at one time, in scenario space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampledPose {
    /// m, the hips joint.
    pub hips: DVec3,
    /// (body joints) global rotation from rest.
    pub turns: Vec<DQuat>,
    /// (body joints) m, where the nodes really are; joints without a node move rigidly with their parent.
    pub positions: Vec<DVec3>,
}

/// Reads a clip at any time. Keeps its place in each channel, so rising times are fast.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    rig: &'a Rig,
    order: Vec<usize>,
    tracks: Vec<[Option<Track<'a>>; 3]>, // (nodes) translation, rotation, scale
    root: [Option<Track<'a>>; 2],
    under_new_root: Vec<bool>,
    joints: Vec<Option<(usize, DMat3, DVec3)>>, // (body joints) node, inverse of its bind orientation, joint to node at rest
    scenario_from_document: DAffine3,
    globals: Vec<DAffine3>,
}

#[derive(Clone, Debug)]
struct Track<'a> {
    times: &'a [f32],
    values: &'a KeyValues,
    interpolation: Interpolation,
    cursor: usize,
}

impl SampledPose {
    /// The pose alone.
    pub fn pose(&self) -> BodyPose {
        BodyPose { hips: self.hips, turns: self.turns.clone() }
    }
}

impl<'a> Sampler<'a> {
    /// Prepares to read a clip. Channels of nodes that the rig lacks are passed over.
    pub fn new(rig: &'a Rig, clip: &'a Clip) -> Sampler<'a> {
        let order = rig.parents_first();
        let mut tracks: Vec<[Option<Track<'a>>; 3]> = vec![[None, None, None]; rig.nodes.len()];
        let mut root = [None, None];
        for channel in &clip.channels {
            let path = match &channel.values {
                KeyValues::Translation(_) => 0,
                KeyValues::Rotation(_) => 1,
                KeyValues::Scale(_) => 2,
            };
            if !channel.is_whole() {
                continue;
            }
            let track = Track {
                times: &channel.times,
                values: &channel.values,
                interpolation: channel.interpolation,
                cursor: 0,
            };
            match channel.target {
                Target::Node(node) if node < tracks.len() => tracks[node][path] = Some(track),
                Target::NewRoot if path < 2 => root[path] = Some(track),
                _ => {}
            }
        }
        let bind = rig.bind_globals();
        let joints = rig.joint_nodes.iter().zip(&rig.body.joints).map(|(node, joint)| {
            let node = node.filter(|node| joint.animated && *node < bind.len())?;
            Some((node, orientation(&bind[node].matrix3).transpose(), bind[node].translation - joint.rest))
        });
        Sampler {
            under_new_root: rig.under(&rig.new_root_children(), &order),
            scenario_from_document: rig.scenario_from_document(),
            globals: vec![DAffine3::IDENTITY; rig.nodes.len()],
            joints: joints.collect(),
            rig,
            order,
            tracks,
            root,
        }
    }

    /// Evaluates only what these nodes need from now on: they and their ancestors. Other globals are not kept up.
    pub fn limit_to(&mut self, nodes: &[usize]) {
        let mut wanted = vec![false; self.rig.nodes.len()];
        for &node in nodes {
            let mut at = Some(node);
            while let Some(node) = at.filter(|node| !wanted[*node]) {
                wanted[node] = true;
                at = self.rig.nodes[node].parent;
            }
        }
        self.order.retain(|node| wanted[*node]);
    }

    /// The transform of the node that the exporter puts over the scene at `time`, to scenario space.
    pub fn new_root_global(&mut self, time: f64) -> DAffine3 {
        let base = self.scenario_from_document;
        if self.root.iter().all(Option::is_none) {
            return base;
        }
        let translation = self.root[0].as_mut().map_or(DVec3::ZERO, |track| track.translation(time));
        let rotation = self.root[1].as_mut().map_or(DQuat::IDENTITY, |track| track.rotation(time));
        base * DAffine3::from_rotation_translation(rotation, translation)
    }

    /// Transforms of all nodes at `time`, node to scenario space.
    pub fn node_globals(&mut self, time: f64) -> &[DAffine3] {
        let base = self.scenario_from_document;
        let new_root = self.new_root_global(time);
        for &node in &self.order {
            let [translation, rotation, scale] = &mut self.tracks[node];
            let mut local = self.rig.nodes[node].local;
            if let Some(track) = translation {
                local.translation = track.translation(time);
            }
            if let Some(track) = rotation {
                local.rotation = track.rotation(time);
            }
            if let Some(track) = scale {
                local.scale = track.translation(time);
            }
            let parent = match self.rig.nodes[node].parent {
                Some(parent) => self.globals[parent],
                None if self.under_new_root[node] => new_root,
                None => base,
            };
            self.globals[node] = parent * local.affine();
        }
        &self.globals
    }

    /// The pose at `time` (s); before the first key and after the last they hold.
    pub fn sample(&mut self, time: f64) -> SampledPose {
        let mut pose = SampledPose::default();
        self.sample_into(time, &mut pose);
        pose
    }

    /// As [`Self::sample`], into a pose that is kept between calls.
    pub fn sample_into(&mut self, time: f64, pose: &mut SampledPose) {
        self.node_globals(time);
        let body = &self.rig.body;
        pose.turns.clear();
        pose.positions.clear();
        for (index, joint) in body.joints.iter().enumerate() {
            let (turn, position) = match (&self.joints[index], joint.parent) {
                (Some((node, bind_inverse, offset)), _) => {
                    let global = &self.globals[*node];
                    let turn = DQuat::from_mat3(&(orientation(&global.matrix3) * *bind_inverse)).normalize();
                    (turn, global.translation - turn * *offset)
                }
                (None, Some(parent)) => {
                    let turn: DQuat = pose.turns[parent];
                    (turn, pose.positions[parent] + turn * body.offset(index))
                }
                (None, None) => (DQuat::IDENTITY, joint.rest),
            };
            pose.turns.push(turn);
            pose.positions.push(position);
        }
        pose.hips = pose.positions.first().copied().unwrap_or_default();
    }
}

impl Track<'_> {
    /// The keys around a time and how far between them it is.
    fn place(&mut self, time: f64) -> (usize, usize, f64) {
        let last = self.times.len() - 1;
        let at = |key: usize| f64::from(self.times[key]);
        self.cursor = self.cursor.min(last);
        if time < at(self.cursor) {
            self.cursor = self.times.partition_point(|key| f64::from(*key) <= time).saturating_sub(1);
        }
        while self.cursor < last && at(self.cursor + 1) <= time {
            self.cursor += 1;
        }
        let from = self.cursor;
        if from == last || time <= at(from) || self.interpolation == Interpolation::Step {
            return (from, from, 0.0);
        }
        (from, from + 1, (time - at(from)) / (at(from + 1) - at(from)))
    }

    fn translation(&mut self, time: f64) -> DVec3 {
        let (from, to, share) = self.place(time);
        let (KeyValues::Translation(keys) | KeyValues::Scale(keys)) = self.values else { return DVec3::ZERO };
        let at = |index: usize| DVec3::from_array(keys[index].map(f64::from));
        match self.interpolation {
            Interpolation::Cubic if share > 0.0 => {
                self.spline(from, to, share, |index| at(index).extend(0.0)).truncate()
            }
            Interpolation::Cubic => at(3 * from + 1),
            _ => at(from).lerp(at(to), share),
        }
    }

    fn rotation(&mut self, time: f64) -> DQuat {
        let (from, to, share) = self.place(time);
        let KeyValues::Rotation(keys) = self.values else { return DQuat::IDENTITY };
        let at = |index: usize| DVec4::from_array(keys[index].map(f64::from));
        let unit = |four: DVec4| DQuat::from_vec4(four.try_normalize().unwrap_or(DVec4::W));
        match self.interpolation {
            Interpolation::Cubic if share > 0.0 => unit(self.spline(from, to, share, at)),
            Interpolation::Cubic => unit(at(3 * from + 1)),
            _ if share > 0.0 => slerp(unit(at(from)), unit(at(to)), share),
            _ => unit(at(from)),
        }
    }

    fn spline(&self, from: usize, to: usize, share: f64, at: impl Fn(usize) -> DVec4) -> DVec4 {
        let seconds = f64::from(self.times[to]) - f64::from(self.times[from]);
        hermite([at(3 * from + 1), at(3 * from + 2), at(3 * to), at(3 * to + 1)], seconds, share)
    }
}

/// glTF 2.0, appendix C: value and tangent where a key is left, tangent and value where the next is reached (tangents a
/// second), so many seconds apart.
pub fn hermite([from, leaving, arriving, to]: [DVec4; 4], seconds: f64, share: f64) -> DVec4 {
    let (t, t2, t3) = (share, share * share, share * share * share);
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + leaving * (seconds * (t3 - 2.0 * t2 + t))
        + to * (3.0 * t2 - 2.0 * t3)
        + arriving * (seconds * (t3 - t2))
}

/// Spherical interpolation along the shorter arc, as glTF asks of readers.
pub fn slerp(from: DQuat, to: DQuat, share: f64) -> DQuat {
    let dot = from.dot(to);
    let (to, dot) = if dot < 0.0 { (-to, -dot) } else { (to, dot) };
    if dot > 1.0 - 1e-9 {
        return (from * (1.0 - share) + to * share).normalize();
    }
    let angle = real::acos(dot.min(1.0));
    (from * real::sin((1.0 - share) * angle) + to * real::sin(share * angle)) * (1.0 / real::sin(angle))
}
