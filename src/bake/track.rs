//! One channel in the making: a value and its slopes at every frame, and which of them stay keys.
//!
//! Values are f32 as stored; differences are of what a reader interpolates: a Hermite spline, of a rotation part by part and
//! made a unit again. Angles in rad, lengths in the node's own units.

use super::spline::{self, Knot};
use crate::model::{Channel, Interpolation, KeyValues, Target};
use crate::rig::animate::{chord, hermite, slerp};
use glam::{DQuat, DVec3, DVec4};

/// A spline that leaves out a fourth derivative is off by h^4/384 of it and bends wrong by h^2/12 of it.
const BEND: f64 = 32.0;
/// Keys of straight lines that are worth one of a curve: it has two tangents beside its value.
const STRAIGHT: f64 = 2.0;
/// A second: an end that leads by less is level; in rad or m.
pub(super) const CORNER: f64 = 0.05;
/// A second: slopes at corners and ends are no steeper, in rad or m; where a pose jumps they mean nothing.
pub(super) const STEEP: f64 = 20.0;
/// What an f32 can hold, of a value.
const ROUNDING: f64 = 5.0e-7;

/// One channel in the making.
pub(super) struct Track {
    pub(super) target: Target,
    pub(super) rotates: bool,
    pub(super) unit: f64,          // m, what one of its own units makes; 1 for rotations
    pub(super) straight: bool,     // joined by straight lines and arcs
    pub(super) still: bool,        // has one value: not asked for where keys are joined by splines
    pub(super) reach: f64,         // m, from a rotation to the farthest that it moves
    pub(super) tolerance: f64,     // of `chord` for rotations, of local units for translations
    pub(super) planted: f64,       // the same while a foot that it moves is planted
    pub(super) bend: f64,          // the same a second squared: what its acceleration may be off by
    pub(super) moves: [bool; 2],   // the left foot, the right foot
    pub(super) frames: Vec<Frame>, // (frames)
    pub(super) keep: Vec<bool>,    // (frames)
    pub(super) own: Vec<bool>,     // (frames) keys with their own slopes, where the smooth curve's slip
    around: Vec<(usize, usize)>,   // (frames) last kept at or before, first kept at or after
    fits: Vec<Fit>,                // (frames) of the kept ones
}

/// A key as written: value, slopes before and after.
#[derive(Clone, Copy, Debug, Default)]
struct Fit {
    value: DVec4,
    slopes: [DVec4; 2],
}

/// A key's value as stored: three of a translation, or a unit quaternion.
pub(super) type Value = [f32; 4];

/// A value and how fast it changes before and after, a second: the same but at a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) value: Value,
    pub(super) slopes: [Value; 2],
}

impl Track {
    /// A translation without any frame; `unit` in m, `tolerance` in m, `bend` in m/s².
    pub(super) fn moving(target: Target, unit: f64, tolerance: f64, bend: f64) -> Track {
        let unit = unit.abs().max(1e-12);
        Track { unit, ..Track::new(target, false, tolerance / unit, bend / unit) }
    }

    /// A rotation without any frame; `tolerance` in rad, `bend` in rad/s².
    pub(super) fn turning(target: Target, tolerance: f64, bend: f64) -> Track {
        Track::new(target, true, tolerance / 2.0, bend / 2.0)
    }

    fn new(target: Target, rotates: bool, tolerance: f64, bend: f64) -> Track {
        let (frames, keep, own, around, fits) = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (straight, still, moves, planted) = (false, false, [false; 2], tolerance);
        let (unit, reach) = (1.0, 1.0);
        Track {
            target,
            rotates,
            unit,
            straight,
            still,
            reach,
            tolerance,
            planted,
            bend,
            moves,
            frames,
            keep,
            own,
            around,
            fits,
        }
    }

    pub(super) fn difference(&self, a: &Value, b: &Value) -> f64 {
        if self.rotates { chord(quaternion(a), quaternion(b)) } else { vector(a).distance(vector(b)) }
    }

    /// As a reader interpolates between two frames that are so many seconds apart, were they keys with their own slopes.
    pub(super) fn between(&self, from: usize, to: usize, seconds: f64, share: f64) -> Value {
        let (a, b) = (&self.frames[from], &self.frames[to]);
        // A turn and its opposite are one: the neighbour's is the nearer.
        let sign = if self.rotates && four(&a.value).dot(four(&b.value)) < 0.0 { -1.0 } else { 1.0 };
        let ends = [four(&a.value), four(&a.slopes[1]), four(&b.slopes[0]) * sign, four(&b.value) * sign];
        self.joined(ends, seconds, share)
    }

    fn joined(&self, ends: [DVec4; 4], seconds: f64, share: f64) -> Value {
        let at = hermite(ends, seconds, share);
        let at = if self.rotates { at.try_normalize().unwrap_or(DVec4::W) } else { at };
        stored(at)
    }

    /// Between `frame` and the next, from the keys that are left.
    pub(super) fn reduced(&self, times: &[f64], frame: usize, share: f64) -> Value {
        let next = (frame + 1).min(times.len() - 1);
        let (from, to) = (self.around[frame].0, self.around[next].1);
        if from == to || times[from] >= times[to] {
            return self.frames[from].value;
        }
        let seconds = times[to] - times[from];
        let now = times[frame] + share * (times[next] - times[frame]);
        let share = (now - times[from]) / seconds;
        let (a, b) = (&self.fits[from], &self.fits[to]);
        if self.straight {
            return self.lined(a.value, b.value, share);
        }
        self.joined([a.value, a.slopes[1], b.slopes[0], b.value], seconds, share)
    }

    /// As a reader joins two values by a straight line or an arc.
    fn lined(&self, from: DVec4, to: DVec4, share: f64) -> Value {
        stored(match self.rotates {
            true => DVec4::from(slerp(DQuat::from_vec4(from), DQuat::from_vec4(to), share)),
            false => from.lerp(to, share),
        })
    }

    /// On the straight line or arc between two frames.
    pub(super) fn line(&self, from: usize, to: usize, share: f64) -> Value {
        self.lined(four(&self.frames[from].value), four(&self.frames[to].value), share)
    }

    /// How far a frame is from the line between two others, about: rotations part by part, which is quicker than an arc.
    pub(super) fn bent(&self, before: usize, frame: usize, after: usize, share: f64) -> f64 {
        let here = four(&self.frames[frame].value);
        let near = |at: usize| {
            let there = four(&self.frames[at].value);
            if self.rotates && there.dot(here) < 0.0 { -there } else { there }
        };
        near(before).lerp(near(after), share).distance(here)
    }

    /// Leaves out keys of straight lines that change what is shown by at most `most`, if the share of those that stay is at most `worth`.
    pub(super) fn spare(&mut self, times: &[f64], most: f64, worth: f64) {
        let kept: Vec<usize> = (0..times.len()).filter(|frame| self.keep[*frame]).collect();
        let spans = |from: usize, to: usize| {
            let seconds = times[kept[to]] - times[kept[from]];
            (from + 1..to).all(|key| {
                let share = (times[kept[key]] - times[kept[from]]) / seconds;
                let line = self.line(kept[from], kept[to], share);
                self.difference(&line, &self.frames[kept[key]].value) <= most
            })
        };
        let mut fewer = vec![0];
        while let Some(from) = fewer.last().copied().filter(|from| from + 1 < kept.len()) {
            let mut to = from + 1;
            while to + 1 < kept.len() && spans(from, to + 1) {
                to += 1;
            }
            fewer.push(to);
        }
        if fewer.len() as f64 <= worth * kept.len() as f64 {
            self.keep.fill(false);
            fewer.iter().for_each(|key| self.keep[kept[*key]] = true);
            self.settle(times);
        }
    }

    /// Keeps frames until none is off by more than `most` times its tolerance, first each time the worst between two keys.
    pub(super) fn fill(&mut self, times: &[f64], planted: &[Vec<bool>; 2], most: f64) {
        self.settle(times);
        loop {
            let mut worst: Vec<(f64, usize)> = Vec::new(); // of the intervals between keys, in order
            let mut from = usize::MAX;
            for frame in (0..times.len()).filter(|frame| !self.keep[*frame]) {
                let off = self.off(times, planted, frame);
                if self.around[frame].0 != from {
                    from = self.around[frame].0;
                    worst.push((most, frame));
                }
                if let Some(worst) = worst.last_mut().filter(|worst| off > worst.0) {
                    *worst = (off, frame);
                }
            }
            worst.retain(|worst| worst.0 > most);
            if worst.is_empty() {
                break;
            }
            worst.iter().for_each(|(_, frame)| self.keep[*frame] = true);
            self.settle(times);
        }
    }

    /// Chooses as few frames beside those that are kept as leave the others within tolerance: first each time the worst
    /// between two keys, then without each that the rest can spare.
    pub(super) fn choose(&mut self, times: &[f64], planted: &[Vec<bool>; 2]) {
        let forced = self.keep.clone();
        self.fill(times, planted, 1.0);
        for frame in (0..times.len()).filter(|frame| !forced[*frame]) {
            if !self.keep[frame] {
                continue;
            }
            // What a key does is gone some keys away.
            let (from, to) = self.neighbours(frame, 8);
            self.keep[frame] = false;
            self.settle_between(times, from, to);
            if (from..to).any(|frame| !self.keep[frame] && self.off(times, planted, frame) > 1.0) {
                self.keep[frame] = true;
                self.settle_between(times, from, to);
            }
        }
        self.settle(times);
    }

    /// The same with curves, or with straight lines where they take fewer bytes and not too many more keys; for what moves no
    /// foot.
    pub(super) fn choose_join(&mut self, times: &[f64], planted: &[Vec<bool>; 2]) {
        let forced = self.keep.clone();
        let mut chosen = [false, true].map(|straight| {
            (self.straight, self.keep) = (straight, forced.clone());
            self.choose(times, planted);
            std::mem::take(&mut self.keep)
        });
        let [curved, straight] = chosen.each_ref().map(|keep| keep.iter().filter(|keep| **keep).count());
        self.straight = straight as f64 <= STRAIGHT * curved as f64;
        self.keep = std::mem::take(&mut chosen[usize::from(self.straight)]);
        self.settle(times);
    }

    /// The keys so many keys before and after a frame, or the outermost.
    fn neighbours(&self, frame: usize, keys: usize) -> (usize, usize) {
        let kept = |frame: &usize| self.keep[*frame];
        let first = (0..frame).rev().filter(kept).nth(keys - 1).unwrap_or(0);
        (first, (frame + 1..self.keep.len()).filter(kept).nth(keys - 1).unwrap_or(self.keep.len() - 1))
    }

    /// How far what the keys show at a frame is from it, over what it may be.
    fn off(&self, times: &[f64], planted: &[Vec<bool>; 2], frame: usize) -> f64 {
        let (from, to) = self.around[frame];
        let seconds = times[to] - times[from];
        let bend = (self.bend * seconds * seconds / BEND).max(ROUNDING);
        let holds = (0..2).any(|side| self.moves[side] && planted[side][frame]);
        let tolerance = if holds { self.planted } else { self.tolerance };
        self.lacks(times, frame) / tolerance.min(bend)
    }

    /// How far what the keys show at a frame is from it.
    pub(super) fn lacks(&self, times: &[f64], frame: usize) -> f64 {
        self.difference(&self.reduced(times, frame, 0.0), &self.frames[frame].value)
    }

    /// How far the slopes of a key are from the poses' own, in rad or m a second.
    pub(super) fn astray(&self, frame: usize) -> f64 {
        let sign = if four(&self.frames[frame].value).dot(self.fits[frame].value) < 0.0 { -1.0 } else { 1.0 };
        let off = |way: usize| four(&self.frames[frame].slopes[way]).distance(self.fits[frame].slopes[way] * sign);
        off(0).max(off(1)) * self.unit
    }

    /// After a change of what is kept: the keys around each frame, and the slopes of the smooth curve through them. At a corner
    /// it has the corner's own.
    pub(super) fn settle(&mut self, times: &[f64]) {
        let count = self.keep.len();
        // Frames are put in and never changed; straight lines have no slopes.
        if !self.straight || self.fits.len() != count {
            self.fit();
        }
        self.around.resize(count, (0, 0));
        self.own.resize(count, false);
        let last = self.keep.iter().rposition(|keep| *keep).unwrap_or(0);
        for end in [0, last] {
            let slow =
                |slope: &mut DVec4| *slope = if slope.length() * self.unit < CORNER { DVec4::ZERO } else { *slope };
            self.fits[end].slopes.iter_mut().for_each(slow);
        }
        self.settle_between(times, 0, last);
        self.around[last..].fill((last, last));
    }

    /// Every frame as a key of its own, rotations on the side of the one before.
    fn fit(&mut self) {
        let mut before: Option<DVec4> = None;
        self.fits.clear();
        for Frame { value, slopes } in self.frames.iter().take(self.keep.len()) {
            let opposite = self.rotates && before.is_some_and(|before| before.dot(four(value)) < 0.0);
            let turned = |value: &Value| if opposite { -four(value) } else { four(value) };
            before = Some(turned(value));
            self.fits.push(Fit { value: turned(value), slopes: slopes.each_ref().map(turned) });
        }
    }

    /// The same between two keys, whose slopes stay.
    fn settle_between(&mut self, times: &[f64], from: usize, to: usize) {
        let mut at = from;
        for frame in from..=to {
            if self.keep[frame] {
                at = frame;
            }
            self.around[frame].0 = at;
        }
        let mut at = to;
        for frame in (from..=to).rev() {
            if self.keep[frame] {
                at = frame;
            }
            self.around[frame].1 = at;
        }
        if self.straight {
            return;
        }
        let kept: Vec<usize> = (from..=to).filter(|frame| self.keep[*frame]).collect();
        let mut first = 0;
        for last in 1..kept.len() {
            if !self.is_corner(kept[last]) && last + 1 < kept.len() {
                continue;
            }
            let piece = &kept[first..=last];
            let clock: Vec<f64> = piece.iter().map(|frame| times[*frame]).collect();
            let values: Vec<DVec4> = piece.iter().map(|frame| self.fits[*frame].value).collect();
            let ends = [self.fits[kept[first]].slopes[1], self.fits[kept[last]].slopes[0]];
            let slopes = spline::slopes(&clock, &values, ends);
            for (frame, slope) in piece.iter().zip(&slopes).take(last - first).skip(1) {
                self.fits[*frame].slopes = [four(&stored(*slope)); 2];
            }
            first = last;
        }
    }

    /// Whether the curve may have a corner at a frame. Nobody stands on what moves no foot: there it is rounded.
    fn is_corner(&self, frame: usize) -> bool {
        let Frame { slopes, .. } = self.frames[frame];
        self.own[frame] || (slopes[0] != slopes[1] && self.moves != [false; 2])
    }

    /// What of it is written: one value where nothing moves, else straight lines or a curve through the keys.
    pub(super) fn channel(&self, times: &[f32]) -> Channel {
        let kept: Vec<usize> = (0..times.len()).filter(|frame| self.keep[*frame]).collect();
        let curved = kept.len() > 1 && !self.straight;
        let (times, numbers) = if curved {
            let knot = |frame: &usize| {
                let Fit { value, slopes } = self.fits[*frame];
                Knot { time: f64::from(times[*frame]), value, slopes, corner: self.is_corner(*frame) }
            };
            let (times, values, slopes) =
                spline::level(&kept.iter().map(knot).collect::<Vec<Knot>>(), self.rotates, self.unit);
            let key = |(value, slope): (&DVec4, &DVec4)| [stored(*slope), stored(*value), stored(*slope)];
            (times, values.iter().zip(&slopes).flat_map(key).collect())
        } else {
            let numbers: Vec<Value> = kept.iter().map(|frame| stored(self.fits[*frame].value)).collect();
            (kept.iter().map(|frame| times[*frame]).collect(), numbers)
        };
        let values = match self.rotates {
            true => KeyValues::Rotation(numbers),
            false => KeyValues::Translation(numbers.iter().map(|value| [value[0], value[1], value[2]]).collect()),
        };
        let interpolation = if curved { Interpolation::Cubic } else { Interpolation::Linear };
        Channel { target: self.target, times, values, interpolation }
    }
}

fn four(value: &Value) -> DVec4 {
    DVec4::from_array(value.map(f64::from))
}

/// As a file stores it.
pub(super) fn stored(four: DVec4) -> Value {
    four.to_array().map(|part| part as f32 + 0.0)
}

/// A translation as a file stores it.
pub(super) fn stored_translation(place: DVec3) -> Value {
    [place.x as f32 + 0.0, place.y as f32 + 0.0, place.z as f32 + 0.0, 0.0]
}

/// A rotation as a file stores it.
pub(super) fn stored_rotation(turn: DQuat) -> Value {
    let turn = turn.normalize();
    [turn.x as f32 + 0.0, turn.y as f32 + 0.0, turn.z as f32 + 0.0, turn.w as f32 + 0.0]
}

/// The translation of a key.
pub(super) fn vector(value: &Value) -> DVec3 {
    DVec3::new(f64::from(value[0]), f64::from(value[1]), f64::from(value[2]))
}

/// The rotation of a key.
pub(super) fn quaternion(value: &Value) -> DQuat {
    DQuat::from_xyzw(f64::from(value[0]), f64::from(value[1]), f64::from(value[2]), f64::from(value[3])).normalize()
}
