//! One channel in the making: a value and its slopes at every frame, and which of them stay keys.
//!
//! Values are f32 as stored; differences are of what a reader interpolates: a Hermite spline, of a rotation part by part and
//! made a unit again. Angles in rad, lengths in the node's own units.

use crate::model::{Channel, Interpolation, KeyValues, Target};
use crate::rig::animate::{chord, hermite};
use glam::{DQuat, DVec3, DVec4};

/// rad: what reduction may change in the upper body, 0.1 degrees.
pub(super) const UPPER_TOLERANCE: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// A spline that leaves out a fourth derivative is off by h^4/384 of it and bends wrong by h^2/12 of it.
const BEND: f64 = 32.0;
/// What an f32 can hold, of a value.
const ROUNDING: f64 = 5.0e-7;

/// One channel in the making.
pub(super) struct Track {
    pub(super) target: Target,
    pub(super) rotates: bool,
    pub(super) unit: f64,          // m, what one of its own units makes; 1 for rotations
    pub(super) tolerance: f64,     // of `chord` for rotations, of local units for translations
    pub(super) bend: f64,          // the same a second squared: what its acceleration may be off by
    pub(super) moves: [bool; 2],   // the left foot, the right foot
    pub(super) frames: Vec<Frame>, // (frames)
    pub(super) keep: Vec<bool>,    // (frames)
    around: Vec<(usize, usize)>,   // (frames) last kept at or before, first kept at or after
}

/// A key's value as stored: three of a translation, or a unit quaternion.
pub(super) type Value = [f32; 4];

/// A value and how fast it changes before and after, a second.
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
        let (frames, keep, around) = (Vec::new(), Vec::new(), Vec::new());
        Track { target, rotates, unit: 1.0, tolerance, bend, moves: [false; 2], frames, keep, around }
    }

    pub(super) fn difference(&self, a: &Value, b: &Value) -> f64 {
        if self.rotates { chord(quaternion(a), quaternion(b)) } else { vector(a).distance(vector(b)) }
    }

    /// As a reader interpolates between two frames that are so many seconds apart.
    pub(super) fn between(&self, from: usize, to: usize, seconds: f64, share: f64) -> Value {
        let four = |value: &Value| DVec4::from_array(value.map(f64::from));
        let (a, b) = (&self.frames[from], &self.frames[to]);
        // A turn and its opposite are one: the neighbour's is the nearer.
        let sign = if self.rotates && four(&a.value).dot(four(&b.value)) < 0.0 { -1.0 } else { 1.0 };
        let ends = [four(&a.value), four(&a.slopes[1]), four(&b.slopes[0]) * sign, four(&b.value) * sign];
        let at = hermite(ends, seconds, share);
        let at = if self.rotates { at.try_normalize().unwrap_or(DVec4::W) } else { at };
        at.to_array().map(|part| part as f32)
    }

    /// Between `frame` and the next, from the keys that are left.
    pub(super) fn reduced(&self, times: &[f32], frame: usize, share: f64) -> Value {
        let time = |frame: usize| f64::from(times[frame]);
        let next = (frame + 1).min(times.len() - 1);
        let (from, to) = (self.around[frame].0, self.around[next].1);
        if from == to || times[from] >= times[to] {
            return self.frames[from].value;
        }
        let seconds = time(to) - time(from);
        let now = time(frame) + share * (time(next) - time(frame));
        self.between(from, to, seconds, (now - time(from)) / seconds)
    }

    /// Keeps as few frames between two kept ones as leave the others within tolerance: each time the farthest that can
    /// be reached, found by doubling and halving.
    pub(super) fn thin(&mut self, times: &[f64], planted: &[Vec<bool>; 2], from: usize, to: usize) {
        let mut at = from;
        while at < to {
            let (mut good, mut stride) = (at + 1, 2);
            while at + stride <= to && self.spans(times, planted, at, at + stride) {
                good = at + stride;
                stride *= 2;
            }
            let mut bad = (at + stride).min(to + 1);
            while good + 1 < bad {
                let middle = good.midpoint(bad);
                if self.spans(times, planted, at, middle) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            self.keep[good] = true;
            at = good;
        }
    }

    /// Whether interpolation between two frames restores all between them.
    fn spans(&self, times: &[f64], planted: &[Vec<bool>; 2], from: usize, to: usize) -> bool {
        let seconds = times[to] - times[from];
        let bend = (self.bend * seconds * seconds / BEND).max(ROUNDING);
        (from + 1..to).all(|frame| {
            let share = (times[frame] - times[from]) / seconds;
            let holds = !self.rotates || (0..2).any(|side| self.moves[side] && planted[side][frame]);
            let tolerance = if holds { self.tolerance } else { UPPER_TOLERANCE / 2.0 };
            self.difference(&self.between(from, to, seconds, share), &self.frames[frame].value) <= tolerance.min(bend)
        })
    }

    pub(super) fn look_around(&mut self) {
        let count = self.keep.len();
        self.around = vec![(0, 0); count];
        let mut at = 0;
        for frame in 0..count {
            if self.keep[frame] {
                at = frame;
            }
            self.around[frame].0 = at;
        }
        let mut at = self.keep.iter().rposition(|keep| *keep).unwrap_or(0);
        for frame in (0..count).rev() {
            if self.keep[frame] {
                at = frame;
            }
            self.around[frame].1 = at;
        }
    }

    /// What of it is written: one value where nothing moves, else a spline through the keys.
    pub(super) fn channel(&self, times: &[f32]) -> Channel {
        let kept: Vec<usize> = (0..times.len()).filter(|frame| self.keep[*frame]).collect();
        let spline = kept.len() > 1;
        let mut numbers: Vec<Value> = Vec::with_capacity(3 * kept.len());
        let mut before: Option<Value> = None;
        for (index, frame) in kept.iter().enumerate() {
            let Frame { value, slopes } = self.frames[*frame];
            let opposite = self.rotates
                && before.is_some_and(|before| before.iter().zip(&value).map(|(a, b)| a * b).sum::<f32>() < 0.0);
            let turned = |value: Value| if opposite { value.map(|part| 0.0 - part) } else { value };
            before = Some(turned(value));
            // The outermost tangents lead nowhere.
            let lead = |end: bool, slope: Value| if end { [0.0; 4] } else { turned(slope) };
            if spline {
                numbers.push(lead(index == 0, slopes[0]));
            }
            numbers.push(turned(value));
            if spline {
                numbers.push(lead(index + 1 == kept.len(), slopes[1]));
            }
        }
        let values = match self.rotates {
            true => KeyValues::Rotation(numbers),
            false => KeyValues::Translation(numbers.iter().map(|value| [value[0], value[1], value[2]]).collect()),
        };
        let times = kept.iter().map(|frame| times[*frame]).collect();
        let interpolation = if spline { Interpolation::Cubic } else { Interpolation::Linear };
        Channel { target: self.target, times, values, interpolation }
    }
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
