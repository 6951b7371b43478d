//! Keys joined by straight lines and arcs (LINEAR): as few as keep what is seen of a pose close to it, between keys too.
//!
//! Tracks that move a point together get keys at the same times: what each is off by between them then largely cancels (a planted foot
//! under hips that travel), and a file stores the times once. From the hips outwards, each group on what is chosen already: hips and the
//! legs that stand, legs in the air, trunk and head, arms, and everything else alone. A *line* is what joins two keys; each is made as long
//! as it stays close to the frames that it passes. Scenario space, m, rad, s.

use super::chain::{Chain, PARTS};
use super::curved::Held;
use super::keys::Frames;
use super::track::{Track, Value, stored};
use crate::measure::percentile;
use crate::model::report::Part;
use crate::model::{Role, Side, Target};
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// m: the held points of a planted foot, of a person 1.75 m tall.
const PLANTED: f64 = 0.2e-3;
/// m/s: and how fast they may move in any line, where [`SLIDING`] asks for it: the first, or the second where the first will not do. A line
/// of h s that is off by d in its middle has points that move at 4 d / h at its ends.
const PACES: [f64; 2] = [0.014, 0.009];
/// Of [`SLIDING`]: points that move faster where nothing holds them back need the second pace. Walks do, shoves do not.
const FAST: f64 = 1.6;
/// m/s: the 95th percentile of their speed, as `measure` takes it; some below the 10 mm/s that a planted foot may have.
const SLIDING: f64 = 0.0085;
/// Samples a frame for that.
const PER_FRAME: f64 = 4.0;
/// m: the points of a foot in the air.
const SWUNG: f64 = 0.3e-3;
/// m: the same for what the hips alone do to it.
const CARRIED: f64 = 0.17e-3;
/// m: head and shoulders.
const TRUNK: f64 = 0.7e-3;
/// m: hands, of which the trunk's part may be half.
const HANDS: f64 = 1.3e-3;
/// m: the hips, and whatever else is moved and not turned.
const PLACE: f64 = 0.25e-3;
/// m, height of the person that these lengths are of.
const TALL: f64 = 1.75;
/// rad: hips (0.02 degrees: 0.3 mm at a foot in the air), legs (0.05), trunk and arms (0.2).
const TURN: [f64; 3] = [0.02 * PI / 180.0, 0.05 * PI / 180.0, 0.2 * PI / 180.0];
/// m, at the farthest joint that it carries: what a track may add to that where it is given fewer keys than its group, in legs and above.
const SPARED: [f64; 2] = [0.03e-3, 0.1e-3];
/// Of its group's keys: with fewer than that a track has times of its own, which take a quarter more bytes a key.
const WORTH_IT: f64 = 0.75;
/// s: lines no longer than that look like a curve to what measures accelerations below 7 Hz.
const SHORT: f64 = 0.045;
/// s: as long as the kick of the corner between two lines lasts there.
const KICK: f64 = 0.06;
/// s: no line is longer, but where nothing moves.
const LONGEST: f64 = 0.5;
/// s: frames that are put in come no closer.
const CLOSEST: f64 = 1.2e-3;
/// Times that frames are put in, at most: what bends unevenly needs another.
const ROUNDS: usize = 3;
/// m: bends that are less than that cannot be seen.
const BENT: f64 = 0.1e-3;
/// Frames of a line that are looked at, at most.
const LOOKED_AT: usize = 8;
/// Of its tolerance: a track that changes by less has one value.
const STILL: f64 = 0.1;
/// Of a value: what f32 makes of it.
const ROUNDING: f64 = 5.0e-7;

/// Points of a chain that are watched while a group gets its keys.
struct Watch<'a> {
    posed: &'a Posed,
    bounds: Vec<Bound>,
}

/// How far the points of a chain's set may be off, m, and how fast they may go, m/s.
struct Bound {
    set: usize,
    most: f64,
    fastest: f64,
}

/// Tracks that get keys at the same times.
struct Group<'a> {
    tracks: Vec<usize>,
    places: Vec<Option<usize>>, // (tracks) which of them it is, if any
    watches: Vec<Watch<'a>>,
}

/// How far off the straight lines from a frame to the next are, in their middle.
#[derive(Clone, Copy)]
struct Off {
    planted: f64,  // m, of what contacts hold there, of a person's size
    farthest: f64, // of what may be off, the most
}

/// What is known of the lines from a frame to the next, by the times (s) of the frames that it hangs on: it does not change while other frames
/// are put in.
#[derive(Default)]
struct Known {
    offs: BTreeMap<[u32; 2], Off>,
    bends: BTreeMap<[u32; 4], f64>, // m, see `bends`; by the frame before, both and the one after
}

/// Chains with the places of all their points at every frame.
struct Posed {
    chain: Chain,
    exact: Vec<Vec<DVec3>>, // (frames, points)
}

impl Posed {
    fn new(chain: &Chain, tracks: &[Track], frames: usize) -> Posed {
        let at = |frame: usize| chain.all_places(&|track| tracks[track].frames[frame].value);
        Posed { chain: chain.clone(), exact: (0..frames).map(at).collect() }
    }

    /// All of them.
    fn watch(&self, most: f64) -> Watch<'_> {
        let bound = |set| Bound { set, most, fastest: f64::INFINITY };
        Watch { posed: self, bounds: (0..self.chain.sets()).map(bound).collect() }
    }
}

impl<'a> Group<'a> {
    fn new(all: &[Track], tracks: impl Iterator<Item = usize>, watches: Vec<Watch<'a>>) -> Group<'a> {
        let moving: Vec<usize> = tracks.filter(|track| !all[*track].still).collect();
        let places = (0..all.len()).map(|track| moving.iter().position(|moving| *moving == track)).collect();
        Group { tracks: moving, places, watches }
    }

    /// Whether lines from one frame to another stay close to the frames between.
    fn spans(&self, all: &[Track], times: &[f64], from: usize, to: usize) -> bool {
        let seconds = times[to] - times[from];
        let inner = to - from - 1;
        let looked_at = inner.min(LOOKED_AT);
        (1..=looked_at).map(|part| from + (part * (inner + 1)) / (looked_at + 1)).all(|frame| {
            let share = (times[frame] - times[from]) / seconds;
            let mut lines = Vec::with_capacity(self.tracks.len());
            let mut close = |track: &usize| {
                let track = &all[*track];
                lines.push(track.line(from, to, share));
                track.difference(&lines[lines.len() - 1], &track.frames[frame].value) <= allowed(track, seconds)
            };
            if !self.tracks.iter().all(&mut close) {
                return false;
            }
            let value = |track: usize| match self.places[track] {
                Some(place) => lines[place],
                None => all[track].reduced(times, frame, 0.0),
            };
            self.watches.iter().all(|watch| watch.is_close(frame, seconds, &value))
        })
    }
}

impl Watch<'_> {
    /// The points that a part of the foot holds still too.
    fn hold(&mut self, part: Part, near: Near) {
        self.bounds.push(Bound { set: part as usize, most: PLANTED * near.size, fastest: near.pace });
    }

    /// Whether the points are where they should be at a frame of a line of that many seconds.
    fn is_close(&self, frame: usize, seconds: f64, value: &dyn Fn(usize) -> Value) -> bool {
        let Posed { chain, exact } = self.posed;
        let places = chain.all_places(value);
        self.bounds.iter().all(|bound| {
            let most = bound.most.min(bound.fastest * seconds / 4.0);
            chain.points_of(bound.set).all(|point| places[point].distance(exact[frame][point]) <= most)
        })
    }
}

/// What a track may be off by in a line of that many seconds. Where two long lines meet, their corner is a kick of its own.
fn allowed(track: &Track, seconds: f64) -> f64 {
    let kick = if seconds > SHORT { track.bend * KICK * seconds / 8.0 } else { f64::INFINITY };
    track.tolerance.min(kick).max(ROUNDING)
}

/// How close keys keep to the poses.
#[derive(Clone, Copy)]
struct Near {
    size: f64, // of the body, over the person's that the lengths are of
    pace: f64, // m/s, of a planted foot's points
}

/// The tracks of a body's parts; none is in two.
struct Parts {
    roots: Vec<usize>,
    hips: Vec<usize>,      // what both legs hang from
    legs: [Vec<usize>; 2], // left, right
    trunk: Vec<usize>,
    arms: [Vec<usize>; 2],
    others: Vec<Vec<usize>>, // each alone
}

impl Parts {
    fn new(frames: &Frames, legs: &[Chain; 2], trunk: &Chain, arms: &[Chain; 2]) -> Parts {
        let root = frames.root();
        let mut free: Vec<usize> = (0..frames.tracks.len()).collect();
        let mut take = |wanted: &dyn Fn(usize) -> bool| -> Vec<usize> {
            let taken = free.iter().copied().filter(|track| wanted(*track)).collect();
            free.retain(|track| !wanted(*track));
            taken
        };
        let [left, right, trunk, left_arm, right_arm] =
            [&legs[0], &legs[1], trunk, &arms[0], &arms[1]].map(Chain::tracks);
        Parts {
            roots: take(&|track| root == Some(frames.tracks[track].target)),
            hips: take(&|track| left.contains(&track) && right.contains(&track)),
            legs: [take(&|track| left.contains(&track)), take(&|track| right.contains(&track))],
            // A chain to a shoulder has the turns of the arm there too.
            trunk: take(&|track| trunk.contains(&track) && left_arm.contains(&track) == right_arm.contains(&track)),
            arms: [take(&|track| left_arm.contains(&track)), take(&|track| right_arm.contains(&track))],
            others: free.into_iter().map(|track| vec![track]).collect(),
        }
    }
}

impl Frames<'_> {
    /// Chooses the keys.
    pub(super) fn choose_straight(&mut self, contacts: &[Held], legs: &[Chain; 2]) {
        let size = (self.input.rig.body.height / TALL).min(1.0);
        let trunk = self.chain_to(&[Role::Head, Role::LeftUpperArm, Role::RightUpperArm]);
        let arms = [
            self.chain_to(&[Role::LeftHand, Role::LeftMiddleProximal]),
            self.chain_to(&[Role::RightHand, Role::RightMiddleProximal]),
        ];
        let parts = Parts::new(self, legs, &trunk, &arms);
        let mut pace = f64::INFINITY;
        let mut known = Known::default();
        loop {
            let near = Near { size, pace };
            let mut rounds = 0..ROUNDS;
            while rounds.next().is_some() && self.refine(contacts, legs, [&trunk, &arms[0], &arms[1]], near, &mut known)
            {
            }
            self.lay_legs(contacts, legs, &parts, near);
            let sliding = self.sliding(contacts, legs);
            if sliding <= SLIDING || pace <= PACES[1] {
                break;
            }
            pace = if pace > PACES[0] && sliding <= FAST * SLIDING { PACES[0] } else { PACES[1] };
        }
        let times = self.clock();
        let [left, right] = &arms;
        for (chain, tracks, most) in
            [(&trunk, &parts.trunk, TRUNK), (left, &parts.arms[0], HANDS), (right, &parts.arms[1], HANDS)]
        {
            let posed = Posed::new(chain, &self.tracks, times.len());
            self.lay_all(tracks, vec![posed.watch(most * size)], &times);
        }
        for track in &parts.others {
            self.lay_all(track, Vec::new(), &times);
        }
        let legs = parts.legs.iter().flatten().map(|track| (track, SPARED[0]));
        let above = parts.trunk.iter().chain(parts.arms.iter().flatten()).map(|track| (track, SPARED[1]));
        for (track, by) in legs.chain(above) {
            let track = &mut self.tracks[*track];
            let most = if track.rotates { by / (2.0 * track.reach) } else { by / track.unit };
            track.spare(&times, most * size, WORTH_IT);
        }
    }

    /// Puts frames in where even lines from frame to frame would be off; whether there were any.
    fn refine(
        &mut self,
        contacts: &[Held],
        legs: &[Chain; 2],
        upper: [&Chain; 3],
        near: Near,
        known: &mut Known,
    ) -> bool {
        let mut new = Vec::new();
        for at in 0..self.times.len() - 1 {
            let [from, to] = [self.times[at], self.times[at + 1]];
            let most = (f64::from(to - from) / CLOSEST).floor();
            if most < 2.0 || self.bends(at, &mut known.bends) < BENT * near.size {
                continue;
            }
            let ends = [from.to_bits(), to.to_bits()];
            let off = *known.offs.entry(ends).or_insert_with(|| self.off_between(at, contacts, legs, upper, near.size));
            // Half as long a line is off by a quarter, and its ends move half as fast.
            let off = off.farthest.sqrt().max(4.0 * off.planted / (near.pace * f64::from(to - from)));
            let pieces = off.ceil().min(most) as usize;
            new.extend((1..pieces).map(|piece| from + (to - from) * (piece as f32 / pieces as f32)));
        }
        self.insert_all(&new);
        !new.is_empty()
    }

    /// How far off the lines from a frame to the next are, of a body of that size.
    fn off_between(&mut self, at: usize, contacts: &[Held], legs: &[Chain; 2], upper: [&Chain; 3], size: f64) -> Off {
        let [from, to] = [self.times[at], self.times[at + 1]];
        let exact = self.values_at(f64::from(from) + f64::from(to - from) / 2.0);
        let exact: Vec<Value> = exact.into_iter().map(stored).collect();
        let off = |chain: &Chain| -> Vec<f64> {
            let line = chain.all_places(&|track| self.tracks[track].line(at, at + 1, 0.5));
            let exact = chain.all_places(&|track| exact[track]);
            line.iter().zip(&exact).map(|(line, exact)| line.distance(*exact) / size).collect()
        };
        let most = |off: &[f64]| off.iter().copied().fold(0.0, f64::max);
        let feet = legs.each_ref().map(off);
        let planted = contacts
            .iter()
            .filter(|held| held.1 <= from && to <= held.2)
            .flat_map(|(held, ..)| {
                let side = held.side as usize;
                legs[side].points_of(held.part as usize).map(move |point| (side, point))
            })
            .map(|(side, point)| feet[side][point])
            .fold(0.0, f64::max);
        let swung = feet.iter().map(|off| most(off)).fold(0.0, f64::max);
        let [trunk, left, right] = upper.map(|chain| most(&off(chain)));
        let farthest = [planted / PLANTED, swung / SWUNG, trunk / TRUNK, left / HANDS, right / HANDS]
            .into_iter()
            .fold(0.0, f64::max);
        Off { planted, farthest }
    }

    /// m, about: how far off lines between a frame and the next may be, by what bends from the one before to the one after.
    fn bends(&self, at: usize, known: &mut BTreeMap<[u32; 4], f64>) -> f64 {
        let (before, after) = (at.saturating_sub(1), (at + 2).min(self.times.len() - 1));
        let around = [before, at, at + 1, after].map(|frame| self.times[frame].to_bits());
        let bent = |track: &Track| {
            let share = |from: usize, to: usize| {
                f64::from((self.times[to] - self.times[from]) / (self.times[after] - self.times[before]))
            };
            let off = |frame: usize| track.bent(before, frame, after, share(before, frame));
            off(at).max(off(at + 1)) * if track.rotates { 2.0 } else { track.unit }
        };
        *known.entry(around).or_insert_with(|| self.tracks.iter().map(bent).fold(0.0, f64::max))
    }

    /// Hips and legs.
    fn lay_legs(&mut self, contacts: &[Held], legs: &[Chain; 2], parts: &Parts, near: Near) {
        let times = self.clock();
        self.begin(parts, &times, near.size);
        let posed = [0, 1].map(|side| Posed::new(&legs[side], &self.tracks, times.len()));
        self.lay_standing(contacts, parts, &posed, &times, near);
        self.lay_swinging(contacts, parts, &posed, &times, near.size);
    }

    /// m/s: the 95th percentile of the speed of what contacts hold.
    fn sliding(&self, contacts: &[Held], legs: &[Chain; 2]) -> f64 {
        let times = self.clock();
        let step = 1.0 / (PER_FRAME * self.input.fps);
        let mut speeds = Vec::new();
        for (contact, start, end) in contacts {
            let places = |time: f64| {
                let frame = times.partition_point(|frame| *frame <= time).clamp(1, times.len() - 1) - 1;
                let share = ((time - times[frame]) / (times[frame + 1] - times[frame])).clamp(0.0, 1.0);
                let value = |track: usize| self.tracks[track].reduced(&times, frame, share);
                legs[contact.side as usize].places(contact.part as usize, &value)
            };
            let [first, last] = [(f64::from(*start) / step).ceil(), (f64::from(*end) / step).floor()];
            let mut before = places(first * step);
            for tick in first as usize + 1..=last as usize {
                let now = places(tick as f64 * step);
                speeds.extend(before.iter().zip(&now).map(|(a, b)| a.distance(*b) / step));
                before = now;
            }
        }
        percentile(&speeds, 0.95)
    }

    /// s, of the frames.
    fn clock(&self) -> Vec<f64> {
        self.times.iter().map(|time| f64::from(*time)).collect()
    }

    /// The chain to those joints that the body has.
    fn chain_to(&self, roles: &[Role]) -> Chain {
        let body = &self.input.rig.body;
        let points = roles.iter().filter_map(|role| body.joint(*role)).map(|joint| (joint, DVec3::ZERO)).collect();
        let track = |node, rotates| self.track_of(Target::Node(node), rotates);
        Chain::to(self.input.rig, &self.poser, &[points], &track, self.new_root())
    }

    /// What each track may be off by, and which stay as they are. The root has the keys that the hips were made for; all others have every
    /// frame until their group is chosen.
    fn begin(&mut self, parts: &Parts, times: &[f64], size: f64) {
        let upper = parts.trunk.iter().chain(parts.arms.iter().flatten());
        let turns = parts.hips.iter().map(|track| (*track, TURN[0]));
        let turns = turns.chain(parts.legs.iter().flatten().map(|track| (*track, TURN[1])));
        for (track, turn) in turns.chain(upper.map(|track| (*track, TURN[2]))).collect::<Vec<(usize, f64)>>() {
            let track = &mut self.tracks[track];
            track.tolerance = if track.rotates { turn / 2.0 } else { PLACE * size / track.unit };
        }
        for (index, track) in self.tracks.iter_mut().enumerate() {
            let first = track.frames[0].value;
            track.still =
                track.frames.iter().all(|frame| track.difference(&first, &frame.value) <= STILL * track.tolerance);
            let is_root = parts.roots.contains(&index);
            let last = times.len() - 1;
            let keeps =
                |at: usize| at == 0 || !track.still && (!is_root || at == last || self.curve.has_knot(times[at]));
            track.keep = (0..times.len()).map(keeps).collect();
            track.settle(times);
        }
    }

    /// Hips, and the legs of the feet that are in contact.
    fn lay_standing(&mut self, contacts: &[Held], parts: &Parts, posed: &[Posed; 2], times: &[f64], near: Near) {
        let last = times.len() - 1;
        let edges = contacts.iter().flat_map(|(_, start, end)| [self.frame_at(*start), self.frame_at(*end)]);
        let mut cuts: Vec<usize> = edges.chain([0, last]).collect();
        cuts.sort_unstable();
        cuts.dedup();
        self.clear(parts.hips.iter().chain(parts.legs.iter().flatten()));
        for span in cuts.windows(2) {
            let mut tracks = parts.hips.clone();
            // The legs have all of their frames until they are laid: what is off at a foot in the air is off by the hips.
            let mut watches: Vec<Watch> = posed.iter().map(|leg| leg.watch(CARRIED * near.size)).collect();
            for (contact, start, end) in contacts {
                if self.frame_at(*start) <= span[0] && span[1] <= self.frame_at(*end) {
                    let side = contact.side as usize;
                    tracks.extend(&parts.legs[side]);
                    watches[side].bounds.iter_mut().take(PARTS.len()).for_each(|bound| bound.most = SWUNG * near.size);
                    watches[side].hold(contact.part, near);
                }
            }
            let group = Group::new(&self.tracks, tracks.into_iter(), watches);
            self.lay(&group, times, span[0], span[1]);
        }
        self.settle(parts.hips.iter(), times);
    }

    /// Legs of feet in the air, on hips that are chosen.
    fn lay_swinging(&mut self, contacts: &[Held], parts: &Parts, posed: &[Posed; 2], times: &[f64], size: f64) {
        let last = times.len() - 1;
        for side in Side::BOTH.map(|side| side as usize) {
            let own = contacts.iter().filter(|(contact, ..)| contact.side as usize == side);
            let mut held: Vec<(usize, usize)> =
                own.map(|(_, start, end)| (self.frame_at(*start), self.frame_at(*end))).collect();
            held.sort_unstable();
            held.push((last, last));
            let mut from = 0;
            for (start, end) in held {
                if start > from {
                    let watches = vec![posed[side].watch(SWUNG * size)];
                    let group = Group::new(&self.tracks, parts.legs[side].iter().copied(), watches);
                    self.lay(&group, times, from, start);
                }
                from = from.max(end);
            }
            self.settle(parts.legs[side].iter(), times);
        }
    }

    /// One group from the first frame to the last.
    fn lay_all(&mut self, tracks: &[usize], watches: Vec<Watch>, times: &[f64]) {
        self.clear(tracks.iter());
        let group = Group::new(&self.tracks, tracks.iter().copied(), watches);
        self.lay(&group, times, 0, times.len() - 1);
        self.settle(tracks.iter(), times);
    }

    /// Lines for a group between two frames, each as long as it may be.
    fn lay(&mut self, group: &Group, times: &[f64], from: usize, to: usize) {
        let mut ends = vec![from];
        let mut at = from;
        while at < to {
            let mut end = at + 1;
            while end < to && times[end + 1] - times[at] <= LONGEST && group.spans(&self.tracks, times, at, end + 1) {
                end += 1;
            }
            ends.push(end);
            at = end;
        }
        for track in &group.tracks {
            ends.iter().for_each(|end| self.tracks[*track].keep[*end] = true);
        }
    }

    fn clear<'t>(&mut self, tracks: impl Iterator<Item = &'t usize>) {
        tracks.for_each(|track| self.tracks[*track].keep[1..].fill(false));
    }

    fn settle<'t>(&mut self, tracks: impl Iterator<Item = &'t usize>, times: &[f64]) {
        tracks.for_each(|track| self.tracks[*track].settle(times));
    }
}
