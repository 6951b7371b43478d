//! Poses to keys: the grid, the contact edges, bisection where a planted foot would slip, reduction everywhere else.
//!
//! What is checked is what a glTF reader gets: f32 keys joined by Hermite splines (CUBICSPLINE), in the local spaces of the rig's
//! nodes. A *frame* is a time at which every channel has a value and slopes; reduction then leaves out keys channel by channel,
//! and the planted feet are measured again on what is left. Lengths in m, angles in rad. Writes scale only where the scenario
//! scales the legs.

use super::contacts::FootContact;
use super::key_times::{SAME_EDGE, SHORTEST, edges, grid, snapped};
use super::leg_chain::LegChain;
use super::leverage::Leverage;
use super::root_motion::{RootCurve, RootMotion};
use super::track::{Frame, STEEP, Track, stored, stored_rotation, stored_translation};
use crate::model::{BodyPose, Channel, Clip, Interpolation, KeyValues, Side, Target};
use crate::rig::animate::{Poser, RootCarrier, RootMove};
use crate::rig::{Rig, Trs};
use glam::{DQuat, DVec4};
use std::collections::BTreeMap;

/// m: a frame is put in where a planted foot is off by more between frames.
const BISECT: f64 = 0.05e-3;
/// m: keys are put back where a planted foot is off by more after reduction.
const SLIP: f64 = 0.22e-3;
/// m: the same where keys are joined by straight lines: there looser ones slide at more than 10 mm/s.
const SLIP_STRAIGHT: f64 = 0.11e-3;
/// rad: and what reduction may then change, 0.02 degrees.
const LEG_STRAIGHT: f64 = 0.02 * std::f64::consts::PI / 180.0;
/// rad: what reduction may change in planted legs and what carries them, 0.05 degrees.
const LEG_TOLERANCE: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// rad: the same of legs in the air, 0.14 degrees.
const SWING_TOLERANCE: f64 = 0.2 * std::f64::consts::PI / 180.0;
/// m: and in translations.
const PLACE_TOLERANCE: f64 = 0.3e-3;
/// A second: what of the poses' slopes a key may lack, in rad or m, before it gets them for its own.
const ASTRAY: f64 = 0.03;
/// Times its tolerance that a leg may be off where keys for a planted foot are near.
const ASIDE: f64 = 1.0;
/// Times that keys are put back.
const PUT_BACK: i32 = 24;
/// A second: where a contact begins or ends, slopes before and after that differ by more are a corner, in rad or m; less is
/// left to the curve.
const EDGE_CORNER: f64 = 0.4;
/// s: slopes are taken over three times this, to either side.
const SLOPE: f64 = 1.0e-3;

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
}

struct Frames<'a> {
    input: KeyInput<'a>,
    poser: Poser<'a>,
    carrier: RootCarrier,
    curve: RootCurve,
    times: Vec<f32>,
    tracks: Vec<Track>,
    locals: Vec<Trs>,
    straight: bool,
}

/// Keys a clip. The result reads back with planted feet still to 0.5 mm wherever the poses hold them.
pub fn keyed_clip(input: &KeyInput) -> Clip {
    keyed_clip_on(input, &|_| DQuat::IDENTITY, &|_| 0.0)
}

/// The same with all keys joined by straight lines: more keys, but a line may be taken out of them, and what a capture trembles
/// between them is left out.
pub fn straight_clip_on(input: &KeyInput, turn: &dyn Fn(f64) -> DQuat, height: &dyn Fn(f64) -> f64) -> Clip {
    keyed(input, turn, height, true)
}

/// The same where what the feet hold on to turns about the origin: `turn` says how at a time (s), and `height` how high
/// (m) the ground then carries the body.
pub fn keyed_clip_on(input: &KeyInput, turn: &dyn Fn(f64) -> DQuat, height: &dyn Fn(f64) -> f64) -> Clip {
    keyed(input, turn, height, false)
}

fn keyed(input: &KeyInput, turn: &dyn Fn(f64) -> DQuat, height: &dyn Fn(f64) -> f64, straight: bool) -> Clip {
    let duration = f64::from(input.duration.max(0.0) as f32);
    let mut frames = Frames::new(*input, duration, height);
    frames.straight = straight;
    frames.tracks.iter_mut().for_each(|track| track.straight = straight);
    let legs = Side::BOTH.map(|side| {
        LegChain::new(
            input.rig,
            &frames.poser,
            side,
            &|node, rotates| frames.track_of(Target::Node(node), rotates),
            [frames.track_of(Target::NewRoot, false), frames.track_of(Target::NewRoot, true)],
        )
    });
    for (side, leg) in legs.iter().enumerate() {
        for track in leg.tracks() {
            frames.tracks[track].moves[side] = true;
            if frames.tracks[track].rotates {
                frames.tracks[track].planted = if straight { LEG_STRAIGHT } else { LEG_TOLERANCE } / 2.0;
                frames.tracks[track].tolerance = frames.tracks[track].tolerance.min(SWING_TOLERANCE / 2.0);
            }
        }
    }
    let edges = edges(input.contacts, duration);
    let grid = grid(input.fps, duration, &edges);
    frames.curve.key(&grid.iter().map(|time| f64::from(*time)).collect::<Vec<f64>>(), straight);
    for (at, time) in grid.into_iter().enumerate() {
        frames.insert(at, time);
    }
    let contacts: Vec<(&FootContact, f32, f32)> = input
        .contacts
        .iter()
        .map(|contact| (contact, snapped(&edges, contact.start, duration), snapped(&edges, contact.end, duration)))
        .filter(|(_, start, end)| end > start)
        .collect();
    frames.bisect(&contacts, &legs, turn);
    frames.reduce(&contacts);
    frames.put_back(&contacts, &legs, turn);
    frames.bring_back(&contacts);
    frames.put_back(&contacts, &legs, turn);
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
        let mut frames = Frames {
            input,
            carrier,
            curve,
            times: Vec::new(),
            tracks: Vec::new(),
            locals: Vec::new(),
            poser,
            straight: false,
        };
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
                frames.tracks.push(Track::turning(target, leverage.seen(drive.joint), leverage.turn(drive.joint)));
            }
        }
        frames
    }

    fn add_tracks(&mut self, target: Target, metres: f64) {
        self.tracks.push(Track::moving(target, metres, PLACE_TOLERANCE, f64::INFINITY));
        self.tracks.push(Track::turning(target, LEG_TOLERANCE, f64::INFINITY));
    }

    fn track_of(&self, target: Target, rotates: bool) -> Option<usize> {
        self.tracks.iter().position(|track| track.target == target && track.rotates == rotates)
    }

    /// Metres that one unit of a node's local translation makes.
    fn metres(&self, node: usize) -> f64 {
        let linear = self.poser.parent_rest(node).matrix3;
        linear.determinant().abs().cbrt().max(1e-12)
    }

    /// Puts a frame at `time` before frame `at`.
    fn insert(&mut self, at: usize, time: f32) {
        // A file's 32 bits may put the edge of a contact into the air.
        let edges = self.input.contacts.iter().flat_map(|contact| [contact.start, contact.end]);
        let edge = edges.into_iter().find(|edge| *edge as f32 == time);
        let exact = edge.unwrap_or(f64::from(time));
        let now = self.values_at(exact);
        // Three samples to each side that there is, and not the frame's own: where a foot touches down the pose may jump a little.
        let [before, after] = [-SLOPE, SLOPE].map(|step| {
            let inside = (0.0..=self.input.duration).contains(&(exact + 3.0 * step));
            inside.then(|| [1.0, 2.0, 3.0].map(|steps| self.values_at(exact + steps * step)))
        });
        self.times.insert(at, time);
        for index in 0..self.tracks.len() {
            let here = now[index];
            let slope = |samples: &Option<[Vec<DVec4>; 3]>, way: f64| {
                let rotates = self.tracks[index].rotates;
                let near = |there: DVec4| if rotates && there.dot(here) < 0.0 { -there } else { there };
                let [a, b, c] = samples.as_ref()?.each_ref().map(|sample| near(sample[index]));
                let slope = (b * 8.0 - a * 5.0 - c * 3.0) * (way / (2.0 * SLOPE));
                Some(slope.clamp_length_max(STEEP / self.tracks[index].unit))
            };
            let (before, after) = (slope(&before, -1.0), slope(&after, 1.0));
            let (before, after) = (before.or(after).unwrap_or_default(), after.or(before).unwrap_or_default());
            let unit = self.tracks[index].unit;
            // Elsewhere a jump is the noise of a capture.
            let corner = edge.is_some() && before.distance(after) * unit > EDGE_CORNER;
            let slopes = if corner { [before, after] } else { [(before + after) * 0.5; 2] };
            let value = if self.tracks[index].rotates { stored(here.normalize()) } else { stored(here) };
            self.tracks[index].frames.insert(at, Frame { value, slopes: slopes.map(stored) });
        }
    }

    /// What every track has at a time.
    fn values_at(&mut self, time: f64) -> Vec<DVec4> {
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

    fn frame_at(&self, time: f32) -> usize {
        self.times.partition_point(|frame| *frame < time).min(self.times.len() - 1)
    }

    /// Splits intervals in which a planted foot would slip, as long as that helps.
    fn bisect(&mut self, contacts: &[(&FootContact, f32, f32)], legs: &[LegChain; 2], turn: &dyn Fn(f64) -> DQuat) {
        for (contact, start, end) in contacts {
            let leg = &legs[contact.side as usize];
            let mut from = self.frame_at(*start);
            let held = leg.held(contact.part, &|track| self.tracks[track].frames[from].value);
            let held = held.seen_from(turn(f64::from(self.times[from])));
            while from + 1 < self.times.len() && self.times[from] < *end {
                let (earlier, later) = (f64::from(self.times[from]), f64::from(self.times[from + 1]));
                let off = [0.25, 0.5, 0.75].map(|share| {
                    let now = leg.held(contact.part, &|track| {
                        self.tracks[track].between(from, from + 1, later - earlier, share)
                    });
                    held.distance(&now.seen_from(turn(earlier + (later - earlier) * share)))
                });
                if off.iter().all(|off| *off <= BISECT) || later - earlier < 2.0 * SHORTEST {
                    from += 1;
                    continue;
                }
                let middle = ((earlier + later) / 2.0) as f32;
                self.insert(from + 1, middle);
                let exact = leg.held(contact.part, &|track| self.tracks[track].frames[from + 1].value);
                let exact = held.distance(&exact.seen_from(turn(f64::from(middle))));
                if exact > 0.8 * off[1].max(BISECT) {
                    self.remove(from + 1); // the pose itself is off: a key would not mend it
                    from += 1;
                }
            }
        }
    }

    fn remove(&mut self, at: usize) {
        self.times.remove(at);
        for track in &mut self.tracks {
            track.frames.remove(at);
        }
    }

    /// What carries the travel.
    fn root(&self) -> Option<Target> {
        match self.carrier {
            RootCarrier::New => Some(Target::NewRoot),
            RootCarrier::Node(node) => Some(Target::Node(node)),
            RootCarrier::None => None,
        }
    }

    /// Leaves out every key that interpolation restores.
    fn reduce(&mut self, contacts: &[(&FootContact, f32, f32)]) {
        let planted = self.planted(contacts);
        let times: Vec<f64> = self.times.iter().map(|time| f64::from(*time)).collect();
        let root = self.root();
        for track in &mut self.tracks {
            let last = times.len() - 1;
            track.keep = vec![false; times.len()];
            track.keep[0] = true;
            let first = track.frames[0].value;
            let moves = |frame: &Frame| track.difference(&first, &frame.value) > 0.25 * track.tolerance;
            if track.frames.iter().any(moves) {
                track.keep[last] = true;
                if root == Some(track.target) {
                    // The hips make up for what it does between its knots.
                    let knot = |time: &f64| self.curve.has_knot(*time);
                    track.keep.iter_mut().zip(&times).for_each(|(keep, time)| *keep |= knot(time));
                    track.settle(&times);
                    continue;
                }
                if track.moves == [false; 2] && !self.straight {
                    track.choose_join(&times, &planted);
                } else {
                    track.choose(&times, &planted);
                }
            }
            track.settle(&times);
        }
    }

    /// (sides, frames) whether the foot holds something.
    fn planted(&self, contacts: &[(&FootContact, f32, f32)]) -> [Vec<bool>; 2] {
        Side::BOTH.map(|side| {
            let holds = |time: &f32| {
                contacts.iter().any(|(contact, start, end)| contact.side == side && start <= time && time <= end)
            };
            self.times.iter().map(holds).collect()
        })
    }

    /// Puts keys back where what was done for the planted feet led the legs astray beside them.
    fn bring_back(&mut self, contacts: &[(&FootContact, f32, f32)]) {
        let planted = self.planted(contacts);
        let times: Vec<f64> = self.times.iter().map(|time| f64::from(*time)).collect();
        let root = self.root();
        let moving = |track: &&mut Track| {
            track.moves != [false; 2] && root != Some(track.target) && track.keep.iter().skip(1).any(|keep| *keep)
        };
        for track in self.tracks.iter_mut().filter(moving) {
            track.fill(&times, &planted, ASIDE);
        }
    }

    /// Puts keys back until the planted feet are still.
    fn put_back(&mut self, contacts: &[(&FootContact, f32, f32)], legs: &[LegChain; 2], turn: &dyn Fn(f64) -> DQuat) {
        let times: Vec<f64> = self.times.iter().map(|time| f64::from(*time)).collect();
        let root = self.root();
        let most = if self.straight { SLIP_STRAIGHT } else { SLIP };
        for pass in 1..PUT_BACK {
            let mut missing: Vec<(usize, usize)> = Vec::new(); // frame, side
            for (contact, start, end) in contacts {
                let leg = &legs[contact.side as usize];
                let first = self.frame_at(*start);
                let held = leg.held(contact.part, &|track| self.tracks[track].frames[first].value);
                let held = held.seen_from(turn(f64::from(self.times[first])));
                let mut worst = (most, None); // of a run of intervals that slip
                for frame in first..self.frame_at(*end) {
                    let [from, to] = [frame, frame + 1].map(|frame| f64::from(self.times[frame]));
                    let off = [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().map(|share| {
                        let now = leg.held(contact.part, &|track| self.tracks[track].reduced(&times, frame, share));
                        held.distance(&now.seen_from(turn(from + (to - from) * share)))
                    });
                    // What the poses slip by themselves no key mends.
                    let poses = [frame, frame + 1].map(|at| {
                        let now = leg.held(contact.part, &|track| self.tracks[track].frames[at].value);
                        held.distance(&now.seen_from(turn(f64::from(self.times[at]))))
                    });
                    let off = off.fold(0.0, f64::max) - poses[0].max(poses[1]);
                    if off > most && pass > PUT_BACK / 2 {
                        // Where the worst cannot be mended, its neighbours can.
                        missing.push((frame, contact.side as usize));
                    } else if off > worst.0 {
                        worst = (off, Some(frame));
                    } else if off <= most {
                        missing.extend(worst.1.map(|frame| (frame, contact.side as usize)));
                        worst = (most, None);
                    }
                }
                missing.extend(worst.1.map(|frame| (frame, contact.side as usize)));
            }
            if missing.is_empty() {
                break;
            }
            // First where a track is off most, then wherever it is off at all.
            let share = 0.5_f64.powi(pass);
            for track in &mut self.tracks {
                let before = track.keep.clone();
                let wanted = missing.iter().filter(|(_, side)| track.moves[*side]).flat_map(|(at, _)| [*at, *at + 1]);
                for frame in wanted.collect::<Vec<usize>>() {
                    if !track.keep[frame] && track.lacks(&times, frame) >= share * track.planted {
                        track.keep[frame] = true;
                    } else if root != Some(track.target)
                        && track.astray(frame) > ASTRAY
                        && track.keep[frame]
                        && pass > PUT_BACK / 2
                    {
                        track.own[frame] = true;
                    }
                }
                if track.keep != before || pass > PUT_BACK / 2 {
                    track.settle(&times);
                }
            }
        }
    }

    fn into_clip(self, duration: f64, contacts: &[(&FootContact, f32, f32)]) -> Clip {
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
fn contact_channels(contacts: &[(&FootContact, f32, f32)], duration: f32) -> Vec<Channel> {
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
