//! The clips that a document holds already: as [`Tracks`], exact at any time, and as plain [`Clip`]s for pictures of them.
//!
//! Document units and local transforms, as in the file: translations, rotations and scales of nodes. glTF 2.0, 3.11 and appendix C:
//! LINEAR (rotations along the shorter arc), STEP and CUBICSPLINE; a [`Clip`] knows no splines, so there they are cut into short
//! straight lines. Leaves out morph weights, and what extensions animate (`KHR_animation_pointer`), with a note.

use super::entry::read;
use super::sampler::{hermite, slerp};
use super::{Document, Fault, Rig, Trs};
use crate::model::{Channel, Clip, Interpolation, KeyValues, Target};
use glam::{DQuat, DVec3, DVec4};
pub use gltf::animation::{Interpolation as Join, Property};
use gltf::json::animation::Sampler;
use gltf::json::validation::Checked;
use serde_json::Value;

/// Numbers of a clip's keys that are read at most: 64 MiB of them.
const MOST_NUMBERS: usize = 1 << 24;
/// s: a spline is cut into lines no longer than that.
const LINE: f64 = 1.0 / 240.0;
/// Lines between two keys at most.
const MOST_LINES: usize = 64;

/// A clip of a document, to be read at any time.
#[derive(Clone, Debug, Default)]
pub struct Tracks {
    /// The clip's name; "" where it has none.
    pub name: String,
    /// In the file's order; at most one for a node's property.
    pub list: Vec<Track>,
    /// (nodes) the tracks of translation, rotation and scale.
    of_node: Vec<[Option<usize>; 3]>,
    /// Sentences for a person.
    pub notes: Vec<String>,
}

/// One animated property of one node.
#[derive(Clone, Debug)]
pub struct Track {
    /// Index of the node.
    pub node: usize,
    /// What of it.
    pub property: Property,
    /// How its keys join.
    pub join: Join,
    /// s, never falling, one at least.
    pub times: Vec<f32>,
    values: Vec<f32>, // a value a key; of a spline in-tangent, value and out-tangent
}

/// A track's keys as the file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct RawKeys {
    /// s.
    pub times: Vec<f32>,
    /// A value a key; of a spline in-tangent, value and out-tangent.
    pub numbers: Vec<Vec<f32>>,
    /// How they join.
    pub join: Join,
}

/// Names of the clips, by index; "" where one has none.
pub fn clip_names(rig: &Rig) -> Vec<String> {
    names_in(&rig.document)
}

/// As [`clip_names`], of a document that need not be a rig.
pub fn names_in(document: &Document) -> Vec<String> {
    let name = |clip: &Value| clip.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    document.list("animations").iter().map(name).collect()
}

/// Reads one clip.
pub fn read_clip(rig: &Rig, index: usize) -> Result<Clip, Fault> {
    let tracks = read_tracks(&rig.document, rig.nodes.len(), index)?;
    let channels: Vec<Channel> = tracks.list.iter().map(Track::channel).collect();
    let duration =
        channels.iter().filter_map(|channel| channel.times.last()).fold(0.0, |a: f64, b| a.max(f64::from(*b)));
    Ok(Clip { name: tracks.name, fps: 30.0, duration, channels })
}

/// Reads one clip of a document of so many nodes.
pub fn read_tracks(document: &Document, nodes: usize, index: usize) -> Result<Tracks, Fault> {
    let place = format!("animations[{index}]");
    let animation = document.entry("animations", index, &place)?;
    let list = |name: &str| animation.get(name).and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let name = animation.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    let mut tracks = Tracks { name, of_node: vec![[None; 3]; nodes], ..Tracks::default() };
    let (mut foreign, mut numbers) = (0, 0);
    for (at, json) in list("channels").iter().enumerate() {
        let place = format!("{place}.channels[{at}]");
        // An extension's business (KHR_animation_pointer) or nobody's; the crate's `Channel` must have a node and a path.
        let says = |target: &Value| target.get("node").is_some() && target.get("path").is_some_and(Value::is_string);
        if json.get("target").is_some_and(|target| !says(target)) {
            foreign += 1;
            continue;
        }
        let gltf::json::animation::Channel { target, sampler, .. } = read(json, &place)?;
        let node = target.node.value();
        if node >= nodes {
            return Err(Fault::new(format!("{place}.target.node"), format!("node {node} is not there")));
        }
        let property = match target.path {
            Checked::Valid(Property::MorphTargetWeights) => continue,
            Checked::Valid(property) => property,
            Checked::Invalid => {
                foreign += 1;
                continue;
            }
        };
        let sampler = sampler.value();
        let Some(json) = list("samplers").get(sampler) else {
            return Err(Fault::new(format!("{place}.sampler"), format!("sampler {sampler} is not there")));
        };
        let sampler: Sampler = read(json, &format!("animations[{index}].samplers[{sampler}]"))?;
        let Some(track) = read_track(document, &sampler, node, property, &place)? else { continue };
        numbers += track.values.len() + track.times.len();
        if numbers > MOST_NUMBERS {
            return Err(Fault::new(place, format!("over {MOST_NUMBERS} numbers in one clip: too large")));
        }
        let slot = &mut tracks.of_node[node][slot(property)];
        if slot.is_none() {
            *slot = Some(tracks.list.len());
            tracks.list.push(track);
        }
    }
    if foreign > 0 {
        tracks
            .notes
            .push(format!("{foreign} channels animate something other than nodes (KHR_animation_pointer): left out"));
    }
    Ok(tracks)
}

/// `None` for a channel without keys.
fn read_track(
    document: &Document,
    sampler: &Sampler,
    node: usize,
    property: Property,
    place: &str,
) -> Result<Option<Track>, Fault> {
    let times = document.read_f32s(sampler.input.value(), place)?;
    let values = document.read_f32s(sampler.output.value(), place)?;
    let join = match sampler.interpolation {
        Checked::Valid(join) => join,
        Checked::Invalid => Join::Linear,
    };
    let (stride, width) = (if join == Join::CubicSpline { 3 } else { 1 }, width(property));
    let enough = values.len() >= times.len() * stride && (values.is_empty() || values.width == width);
    let rising = times.width == 1 && times.values.windows(2).all(|pair| pair[0] <= pair[1]);
    if !enough || !rising || !times.values.iter().all(|time| time.is_finite()) {
        return Err(Fault::new(place, "needs rising times and a value for each"));
    }
    if !values.values.iter().all(|value| value.abs() < 1e9) {
        return Err(Fault::new(place, "has a value that is no number, or beyond any sense"));
    }
    if times.is_empty() {
        return Ok(None);
    }
    let mut numbers = values.values;
    numbers.truncate(times.values.len() * stride * width);
    Ok(Some(Track { node, property, join, times: times.values, values: numbers }))
}

impl Tracks {
    /// A node's local transform at a time (s): `rest` where nothing moves it. Before the first key and after the last they hold.
    pub fn local(&self, node: usize, time: f64, rest: &Trs) -> Trs {
        let mut local = *rest;
        let [translation, rotation, scale] = self.of_node.get(node).copied().unwrap_or_default();
        if let Some(track) = translation {
            local.translation = self.list[track].vector(time);
        }
        if let Some(track) = rotation {
            local.rotation = self.list[track].rotation(time);
        }
        if let Some(track) = scale {
            local.scale = self.list[track].vector(time);
        }
        local
    }

    /// Whether a property of that node moves.
    pub fn moves(&self, node: usize) -> bool {
        self.of_node.get(node).is_some_and(|tracks| tracks.iter().any(Option::is_some))
    }

    /// s, first and last key; `None` without keys.
    pub fn span(&self) -> Option<(f64, f64)> {
        let ends = self.list.iter().filter_map(|track| Some((*track.times.first()?, *track.times.last()?)));
        ends.map(|(first, last)| (f64::from(first), f64::from(last))).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}

/// Where a property stands among a node's three.
fn slot(property: Property) -> usize {
    match property {
        Property::Translation => 0,
        Property::Rotation => 1,
        Property::Scale | Property::MorphTargetWeights => 2,
    }
}

/// Numbers a value.
fn width(property: Property) -> usize {
    if property == Property::Rotation { 4 } else { 3 }
}

impl Track {
    /// The rotation at a time, s.
    pub fn rotation(&self, time: f64) -> DQuat {
        let (from, to, share) = self.place(time);
        let unit = |four: DVec4| DQuat::from_vec4(four.try_normalize().unwrap_or(DVec4::W));
        match self.join {
            Join::CubicSpline if share > 0.0 => unit(self.spline(from, to, share)),
            _ if share > 0.0 => slerp(unit(self.value(from)), unit(self.value(to)), share),
            _ => unit(self.value(from)),
        }
    }

    /// The translation or scale at a time, s.
    pub fn vector(&self, time: f64) -> DVec3 {
        let (from, to, share) = self.place(time);
        match self.join {
            Join::CubicSpline if share > 0.0 => self.spline(from, to, share).truncate(),
            _ if share > 0.0 => self.value(from).lerp(self.value(to), share).truncate(),
            _ => self.value(from).truncate(),
        }
    }

    /// The keys as the file has them.
    pub fn keys(&self) -> RawKeys {
        let width = width(self.property) * if self.join == Join::CubicSpline { 3 } else { 1 };
        let numbers = self.values.chunks_exact(width).map(<[f32]>::to_vec).collect();
        RawKeys { times: self.times.clone(), numbers, join: self.join }
    }

    /// The keys around a time and how far between them it is.
    fn place(&self, time: f64) -> (usize, usize, f64) {
        let after = self.times.partition_point(|key| f64::from(*key) <= time);
        if after == 0 || after == self.times.len() || self.join == Join::Step {
            let held = after.saturating_sub(1);
            return (held, held, 0.0);
        }
        let (from, to) = (f64::from(self.times[after - 1]), f64::from(self.times[after]));
        (after - 1, after, (time - from) / (to - from))
    }

    fn value(&self, key: usize) -> DVec4 {
        if self.join == Join::CubicSpline { self.number(3 * key + 1) } else { self.number(key) }
    }

    fn number(&self, element: usize) -> DVec4 {
        let width = width(self.property);
        let at = |part: usize| f64::from(self.values[element * width + part]);
        DVec4::new(at(0), at(1), at(2), if width == 4 { at(3) } else { 0.0 })
    }

    /// Appendix C: a Hermite spline, tangents per second.
    fn spline(&self, from: usize, to: usize, t: f64) -> DVec4 {
        let seconds = f64::from(self.times[to]) - f64::from(self.times[from]);
        hermite([self.value(from), self.number(3 * from + 2), self.number(3 * to), self.value(to)], seconds, t)
    }

    /// As a channel of a [`Clip`].
    fn channel(&self) -> Channel {
        let mut times: Vec<f32> = Vec::with_capacity(self.times.len());
        for (key, time) in self.times.iter().enumerate() {
            if self.join == Join::CubicSpline && key > 0 {
                let (from, to) = (f64::from(self.times[key - 1]), f64::from(*time));
                let lines = (((to - from) / LINE).ceil() as usize).clamp(1, MOST_LINES);
                times.extend((1..lines).map(|line| (from + (to - from) * line as f64 / lines as f64) as f32));
            }
            times.push(*time);
        }
        times.dedup();
        let at = |time: &f32| f64::from(*time);
        let triple = |vector: DVec3| [vector.x as f32, vector.y as f32, vector.z as f32];
        let vectors = || times.iter().map(|time| triple(self.vector(at(time)))).collect();
        let values = match self.property {
            Property::Scale => KeyValues::Scale(vectors()),
            Property::Rotation => {
                let four = |turn: DQuat| [turn.x as f32, turn.y as f32, turn.z as f32, turn.w as f32];
                KeyValues::Rotation(times.iter().map(|time| four(self.rotation(at(time)))).collect())
            }
            _ => KeyValues::Translation(vectors()),
        };
        let interpolation = if self.join == Join::Step { Interpolation::Step } else { Interpolation::Linear };
        Channel { target: Target::Node(self.node), times, values, interpolation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;

    fn track(property: Property, join: Join, times: &[f32], values: &[f32]) -> Track {
        Track { node: 0, property, join, times: times.to_vec(), values: values.to_vec() }
    }

    #[test]
    fn a_spline_follows_its_tangents_and_not_a_straight_line() {
        // From 0 to 1 in 2 s, leaving at 3 units a second, arriving at rest.
        let values = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 9.0, 9.0, 9.0];
        let track = track(Property::Translation, Join::CubicSpline, &[1.0, 3.0], &values);
        // t = 1/2: v 1/2, tangent 3 * 2 s * 1/8.
        assert!((track.vector(2.0).x - (0.5 + 0.75)).abs() < 1e-12, "{}", track.vector(2.0));
        assert_eq!((track.vector(0.0).x, track.vector(9.0).x), (0.0, 1.0), "held outside");
        let start = (track.vector(1.001).x - track.vector(1.0).x) / 0.001;
        assert!((start - 3.0).abs() < 0.01, "leaves at its tangent: {start}");
        let channel = track.channel();
        let KeyValues::Translation(keys) = &channel.values else { panic!("translation") };
        assert!(keys.len() > 60 && (keys[keys.len() / 2][0] - 1.25).abs() < 1e-3, "cut into lines that follow it");
    }

    #[test]
    fn a_step_holds_and_of_two_keys_at_one_time_the_last_counts_from_there() {
        let step = track(Property::Scale, Join::Step, &[0.0, 1.0], &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!((step.vector(0.999).x, step.vector(1.0).x), (1.0, 2.0));
        let values = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 5.0, 0.0, 0.0, 6.0, 0.0, 0.0];
        let jump = track(Property::Translation, Join::Linear, &[0.0, 1.0, 1.0, 2.0], &values);
        assert!((jump.vector(0.5).x - 0.5).abs() < 1e-12);
        assert_eq!((jump.vector(1.0).x, jump.vector(1.5).x), (5.0, 5.5));
    }

    #[test]
    fn rotations_take_the_shorter_arc_and_a_spline_of_them_stays_of_unit_length() {
        let half = real::sin(0.5) as f32;
        let linear = track(
            Property::Rotation,
            Join::Linear,
            &[0.0, 1.0],
            &[0.0, 0.0, 0.0, 1.0, -half, 0.0, 0.0, -(real::cos(0.5) as f32)],
        );
        assert!((linear.rotation(0.5).to_scaled_axis().x - 0.5).abs() < 1e-6);
        let mut values = vec![0.0; 24];
        (values[7], values[16], values[19]) = (1.0, half, (real::cos(0.5) as f32));
        (values[8], values[13]) = (2.0, -1.0);
        let cubic = track(Property::Rotation, Join::CubicSpline, &[0.0, 1.0], &values);
        for at in 0..=10 {
            assert!((cubic.rotation(f64::from(at) / 10.0).length() - 1.0).abs() < 1e-12);
        }
    }
}
