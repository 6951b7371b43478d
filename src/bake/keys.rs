//! Poses to keys: the frames that keys are chosen from, and the clip that is made of the chosen ones.
//!
//! A *frame* is a time at which every channel has a value: the grid, and the beginnings and ends of contacts. [`super::straight`] chooses
//! keys that straight lines and arcs join (LINEAR, what every program plays alike), [`super::curved`] those of splines (CUBICSPLINE, fewer,
//! for who edits them). What is checked is what a glTF reader gets: f32 keys in the local spaces of the rig's nodes. Lengths in m, angles
//! in rad. Writes scale only where the scenario scales the legs.

use super::chain::Chain;
use super::contacts::FootContact;
use super::curved::Held;
pub(crate) use super::key_times::NEAREST;
use super::key_times::{SAME_EDGE, edges, grid, snapped};
use super::leverage::Leverage;
use super::root_motion::{RootCurve, RootMotion};
use super::track::{Frame, STEEP, Track, stored, stored_rotation, stored_translation};
use crate::maths::real;
use crate::model::{BodyPose, Channel, Clip, Interpolation, KeyValues, Side, Target};
use crate::rig::animate::{Poser, RootCarrier, RootMove};
use crate::rig::{Rig, Trs};
use glam::{DQuat, DVec3, DVec4};
use std::collections::BTreeMap;

/// rad: what reduction may change in planted legs and what carries them, 0.05 degrees.
const LEG_TOLERANCE: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// rad: the same of legs in the air, 0.2 degrees.
const SWING_TOLERANCE: f64 = 0.2 * std::f64::consts::PI / 180.0;
/// m: and in translations.
const PLACE_TOLERANCE: f64 = 0.3e-3;
/// A second: where a contact begins or ends, slopes before and after that differ by more are a corner, in rad or m; less is
/// left to the curve.
const EDGE_CORNER: f64 = 0.4;
/// s: slopes are taken over three times this, to either side.
const SLOPE: f64 = 1.0e-3;
/// Hz: straight lines join keys that are chosen from that many frames a second at least: a hand that is thrown at 50 m/s² is 0.4 mm
/// off a line of that length.
const FINEST: f64 = 120.0;

/// How keys are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curves {
    /// By straight lines and arcs (LINEAR).
    #[default]
    Linear,
    /// By splines (CUBICSPLINE); what no foot hangs from by straight lines where that takes fewer bytes.
    Spline,
}

/// What keys are made from.
#[derive(Clone, Copy)]
pub struct KeyInput<'a> {
    /// Whose nodes.
    pub rig: &'a Rig,
    /// The clip's name.
    pub name: &'a str,
    /// Hz of the grid.
    pub fps: f64,
    /// s.
    pub duration: f64,
    /// The pose at any time of 0..=duration.
    pub pose: &'a dyn Fn(f64) -> BodyPose,
    /// What the feet hold.
    pub contacts: &'a [FootContact],
    /// Where the travel goes.
    pub root_motion: RootMotion,
    /// How keys are joined.
    pub curves: Curves,
}

/// A clip in the making.
pub(super) struct Frames<'a> {
    pub(super) input: KeyInput<'a>,
    pub(super) poser: Poser<'a>,
    carrier: RootCarrier,
    pub(super) curve: RootCurve,
    pub(super) times: Vec<f32>,    // s, strictly rising
    pub(super) tracks: Vec<Track>, // whose frames are at `times`
    locals: Vec<Trs>,
}

/// Keys a clip. The result reads back with planted feet still to 0.5 mm wherever the poses hold them.
pub fn keyed_clip(input: &KeyInput) -> Clip {
    keyed_clip_on(input, &|_| DQuat::IDENTITY, &|_| 0.0)
}

/// The same where what the feet hold on to turns about the origin: `turn` says how at a time (s), and `height` how high
/// (m) the ground then carries the body.
pub fn keyed_clip_on(input: &KeyInput, turn: &dyn Fn(f64) -> DQuat, height: &dyn Fn(f64) -> f64) -> Clip {
    let duration = f64::from(input.duration.max(0.0) as f32);
    let straight = input.curves == Curves::Linear;
    let mut frames = Frames::new(*input, duration, height);
    frames.tracks.iter_mut().for_each(|track| track.straight = straight);
    let edges = edges(input.contacts, duration);
    let finer = if straight { (FINEST / input.fps - 1e-6).ceil().max(1.0) } else { 1.0 };
    let grid = grid(input.fps * finer, duration, &edges);
    let knots: Vec<f64> = grid.iter().map(|time| f64::from(*time)).collect();
    frames.curve.key(&knots, straight, frames.carrier_at_rest());
    for (at, time) in grid.into_iter().enumerate() {
        frames.insert(at, time);
    }
    let contacts: Vec<Held> = input
        .contacts
        .iter()
        .map(|contact| (contact, snapped(&edges, contact.start, duration), snapped(&edges, contact.end, duration)))
        .filter(|(_, start, end)| end > start)
        .collect();
    let legs = frames.legs();
    if straight {
        frames.choose_straight(&contacts, &legs);
    } else {
        frames.choose_curved(&contacts, &legs, turn);
    }
    frames.into_clip(duration, &contacts)
}

impl<'a> Frames<'a> {
    fn new(input: KeyInput<'a>, duration: f64, height: &dyn Fn(f64) -> f64) -> Frames<'a> {
        let poser = Poser::new(input.rig);
        let carrier = input.root_motion.carrier(input.rig);
        let steps = (duration * 30.0).ceil().max(1.0);
        let dt = duration / steps;
        let curve = if carrier == RootCarrier::None {
            RootCurve::follow(&[], &[], dt, false)
        } else {
            let poses: Vec<BodyPose> = (0..=steps as usize).map(|index| (input.pose)(index as f64 * dt)).collect();
            let travels = input.root_motion == RootMotion::Root;
            let heights: Vec<f64> = match travels {
                true => (0..=steps as usize).map(|index| height(index as f64 * dt)).collect(),
                false => Vec::new(),
            };
            RootCurve::follow(&poses, &heights, dt, travels)
        };
        let mut frames =
            Frames { input, carrier, curve, times: Vec::new(), tracks: Vec::new(), locals: Vec::new(), poser };
        let leverage = Leverage::new(&input.rig.body);
        match carrier {
            RootCarrier::New => frames.add_tracks(Target::NewRoot, input.rig.document_from_scenario.scale.recip()),
            RootCarrier::Node(node) => frames.add_tracks(Target::Node(node), frames.metres(node)),
            RootCarrier::None => {}
        }
        for node in 0..input.rig.nodes.len() {
            if carrier == RootCarrier::Node(node) {
                continue;
            }
            if let Some(drive) = frames.poser.drives()[node] {
                let target = Target::Node(node);
                if drive.translate {
                    let bend = if drive.joint == 0 { leverage.place() } else { f64::INFINITY };
                    frames.tracks.push(Track::moving(target, frames.metres(node), PLACE_TOLERANCE, bend));
                }
                let mut turning = Track::turning(target, leverage.seen(drive.joint), leverage.turn(drive.joint));
                turning.reach = leverage.reach(drive.joint);
                frames.tracks.push(turning);
            }
        }
        frames
    }

    fn add_tracks(&mut self, target: Target, metres: f64) {
        self.tracks.push(Track::moving(target, metres, PLACE_TOLERANCE, f64::INFINITY));
        self.tracks.push(Track::turning(target, LEG_TOLERANCE, f64::INFINITY));
    }

    /// The chains of both feet, whose tracks know from here on that they move them.
    fn legs(&mut self) -> [Chain; 2] {
        let track = |node, rotates| self.track_of(Target::Node(node), rotates);
        let legs = Side::BOTH.map(|side| Chain::of_foot(self.input.rig, &self.poser, side, &track, self.new_root()));
        for (side, leg) in legs.iter().enumerate() {
            for track in leg.tracks() {
                let track = &mut self.tracks[track];
                track.moves[side] = true;
                if track.rotates {
                    track.planted = LEG_TOLERANCE / 2.0;
                    track.tolerance = track.tolerance.min(SWING_TOLERANCE / 2.0);
                }
            }
        }
        legs
    }

    /// m, scenario space: where the node that carries the travel is at rest.
    fn carrier_at_rest(&self) -> DVec3 {
        match self.carrier {
            RootCarrier::Node(node) => self.poser.reference_globals()[node].translation,
            _ => self.input.rig.document_from_scenario.inverse_point(DVec3::ZERO),
        }
    }

    /// The tracks of a root over the scene's: translation, rotation.
    pub(super) fn new_root(&self) -> [Option<usize>; 2] {
        [false, true].map(|rotates| self.track_of(Target::NewRoot, rotates))
    }

    pub(super) fn track_of(&self, target: Target, rotates: bool) -> Option<usize> {
        self.tracks.iter().position(|track| track.target == target && track.rotates == rotates)
    }

    /// Metres that one unit of a node's local translation makes.
    fn metres(&self, node: usize) -> f64 {
        let linear = self.poser.parent_rest(node).matrix3;
        real::cbrt(linear.determinant().abs()).max(1e-12)
    }

    /// Puts a frame at `time` before frame `at`.
    pub(super) fn insert(&mut self, at: usize, time: f32) {
        let made = self.frames_at(time);
        self.times.insert(at, time);
        self.tracks.iter_mut().zip(made).for_each(|(track, frame)| track.frames.insert(at, frame));
    }

    /// Puts frames in at these times, rising.
    pub(super) fn insert_all(&mut self, times: &[f32]) {
        let made: Vec<Vec<Frame>> = times.iter().map(|time| self.frames_at(*time)).collect();
        let old = std::mem::take(&mut self.times);
        let merged = |track: usize, own: &[Frame]| -> Vec<Frame> {
            let mut frames = Vec::with_capacity(old.len() + times.len());
            let mut next = 0;
            for (time, frame) in old.iter().zip(own) {
                while next < times.len() && times[next] < *time {
                    frames.push(made[next][track]);
                    next += 1;
                }
                frames.push(*frame);
            }
            frames.extend(made[next..].iter().map(|made| made[track]));
            frames
        };
        for (index, track) in self.tracks.iter_mut().enumerate() {
            track.frames = merged(index, &track.frames);
        }
        self.times = old.iter().chain(times).copied().collect();
        self.times.sort_by(f32::total_cmp);
    }

    /// The frame of every track at a time.
    fn frames_at(&mut self, time: f32) -> Vec<Frame> {
        // A file's 32 bits may put the edge of a contact into the air.
        let edges = self.input.contacts.iter().flat_map(|contact| [contact.start, contact.end]);
        let edge = edges.into_iter().find(|edge| *edge as f32 == time);
        let exact = edge.unwrap_or(f64::from(time));
        let now = self.values_at(exact);
        let curved = self.input.curves == Curves::Spline;
        // Three samples to each side that there is, and not the frame's own: where a foot touches down the pose may jump a little.
        let [before, after] = [-SLOPE, SLOPE].map(|step| {
            let inside = curved && (0.0..=self.input.duration).contains(&(exact + 3.0 * step));
            inside.then(|| [1.0, 2.0, 3.0].map(|steps| self.values_at(exact + steps * step)))
        });
        let frame = |(index, track): (usize, &Track)| {
            let here = now[index];
            let slope = |samples: &Option<[Vec<DVec4>; 3]>, way: f64| {
                let near = |there: DVec4| if track.rotates && there.dot(here) < 0.0 { -there } else { there };
                let [a, b, c] = samples.as_ref()?.each_ref().map(|sample| near(sample[index]));
                let slope = (b * 8.0 - a * 5.0 - c * 3.0) * (way / (2.0 * SLOPE));
                Some(slope.clamp_length_max(STEEP / track.unit))
            };
            let (before, after) = (slope(&before, -1.0), slope(&after, 1.0));
            let (before, after) = (before.or(after).unwrap_or_default(), after.or(before).unwrap_or_default());
            // Elsewhere a jump is the noise of a capture.
            let corner = edge.is_some() && before.distance(after) * track.unit > EDGE_CORNER;
            let slopes = if corner { [before, after] } else { [(before + after) * 0.5; 2] };
            Frame {
                value: if track.rotates { stored(here.normalize()) } else { stored(here) },
                slopes: slopes.map(stored),
            }
        };
        self.tracks.iter().enumerate().map(frame).collect()
    }

    /// What every track has at a time.
    pub(super) fn values_at(&mut self, time: f64) -> Vec<DVec4> {
        let pose = (self.input.pose)(time);
        let motion = if self.carrier == RootCarrier::None { RootMove::IDENTITY } else { self.curve.at(time) };
        self.poser.locals(&pose, self.carrier, &motion, &mut self.locals);
        let value = |track: &Track| {
            let (translation, rotation) = match track.target {
                Target::Node(node) => (self.locals[node].translation, self.locals[node].rotation),
                _ => self.poser.new_root(&motion),
            };
            if track.rotates { DVec4::from(rotation) } else { translation.extend(0.0) }
        };
        self.tracks.iter().map(value).collect()
    }

    pub(super) fn frame_at(&self, time: f32) -> usize {
        self.times.partition_point(|frame| *frame < time).min(self.times.len() - 1)
    }

    /// What carries the travel.
    pub(super) fn root(&self) -> Option<Target> {
        match self.carrier {
            RootCarrier::New => Some(Target::NewRoot),
            RootCarrier::Node(node) => Some(Target::Node(node)),
            RootCarrier::None => None,
        }
    }

    fn into_clip(self, duration: f64, contacts: &[Held]) -> Clip {
        let mut channels = Vec::new();
        let in_place = self.input.root_motion == RootMotion::InPlace;
        let dropped = match self.carrier {
            RootCarrier::New if in_place => Some(Target::NewRoot),
            RootCarrier::Node(node) if in_place => Some(Target::Node(node)),
            _ => None,
        };
        for track in self.tracks.iter().filter(|track| Some(track.target) != dropped) {
            channels.push(track.channel(&self.times));
        }
        for (node, moved, turned) in self.poser.held() {
            let has = |rotates: bool| {
                let same = |values: &KeyValues| matches!(values, KeyValues::Rotation(_)) == rotates;
                channels.iter().any(|channel: &Channel| channel.target == Target::Node(node) && same(&channel.values))
            };
            let (moved, turned) = (moved && !has(false), turned && !has(true));
            let reference = self.poser.reference()[node];
            let single = |values| Channel {
                target: Target::Node(node),
                times: vec![0.0],
                values,
                interpolation: Interpolation::Linear,
            };
            if moved {
                let [x, y, z, _] = stored_translation(reference.translation);
                channels.push(single(KeyValues::Translation(vec![[x, y, z]])));
            }
            if turned {
                channels.push(single(KeyValues::Rotation(vec![stored_rotation(reference.rotation)])));
            }
        }
        for node in self.input.rig.leg_scales.keys() {
            let [x, y, z, _] = stored_translation(self.poser.reference()[*node].scale);
            channels.push(Channel {
                target: Target::Node(*node),
                times: vec![0.0],
                values: KeyValues::Scale(vec![[x, y, z]]),
                interpolation: Interpolation::Linear,
            });
        }
        let order = |values: &KeyValues| match values {
            KeyValues::Translation(_) => 0,
            KeyValues::Rotation(_) => 1,
            KeyValues::Scale(_) => 2,
        };
        channels.sort_by_key(|channel| (channel.target, order(&channel.values)));
        channels.extend(contact_channels(contacts, duration as f32));
        Clip { name: self.input.name.to_owned(), fps: self.input.fps, duration, channels }
    }
}

/// The contacts as plain animation: translation.x of a helper node is 1 while any part of the foot holds.
fn contact_channels(contacts: &[Held], duration: f32) -> Vec<Channel> {
    let channel = |side: Side| {
        let mut spans: Vec<(f32, f32)> = contacts
            .iter()
            .filter(|(contact, ..)| contact.side == side)
            .map(|(_, start, end)| (*start, *end))
            .collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut merged: Vec<(f32, f32)> = Vec::new();
        for (start, end) in spans {
            match merged.last_mut() {
                Some(last) if start <= last.1 + 2.0 * SAME_EDGE as f32 => last.1 = last.1.max(end),
                _ => merged.push((start, end)),
            }
        }
        let mut keys: BTreeMap<u32, f32> = BTreeMap::from([(0.0f32.to_bits(), 0.0)]); // bits of times >= 0 rise with them
        for (start, end) in merged {
            keys.insert(start.to_bits(), 1.0);
            if end < duration {
                keys.insert(end.to_bits(), 0.0);
            }
        }
        let held = keys.values().next_back().copied().unwrap_or_default();
        keys.entry(duration.to_bits()).or_insert(held);
        let times = keys.keys().map(|bits| f32::from_bits(*bits)).collect();
        let values = KeyValues::Translation(keys.values().map(|value| [*value, 0.0, 0.0]).collect());
        let target = if side == Side::Left { Target::ContactLeft } else { Target::ContactRight };
        Channel { target, times, values, interpolation: Interpolation::Step }
    };
    Side::BOTH.map(channel).to_vec()
}
