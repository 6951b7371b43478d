//! One channel in the making: a value at every frame, and which of them stay keys.
//!
//! Values are f32 as stored; differences are of what a reader interpolates. Angles in rad, lengths in the node's own units.

use crate::model::{Channel, Interpolation, KeyValues, Target};
use crate::rig::animate::{chord, slerp};
use glam::{DQuat, DVec3};

/// rad: what reduction may change in the upper body, 0.1 degrees.
pub(super) const UPPER_TOLERANCE: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// One channel in the making.
pub(super) struct Track {
    pub(super) target: Target,
    pub(super) rotates: bool,
    pub(super) tolerance: f64,     // of `chord` for rotations, of local units for translations
    pub(super) moves: [bool; 2],   // the left foot, the right foot
    pub(super) values: Vec<Value>, // (frames)
    pub(super) keep: Vec<bool>,    // (frames)
    around: Vec<(usize, usize)>,   // (frames) last kept at or before, first kept at or after
}

/// A key's value as stored: three of a translation, or a unit quaternion.
pub(super) type Value = [f32; 4];

impl Track {
    /// Without any frame.
    pub(super) fn new(target: Target, rotates: bool, tolerance: f64) -> Track {
        let (values, keep, around) = (Vec::new(), Vec::new(), Vec::new());
        Track { target, rotates, tolerance, moves: [false; 2], values, keep, around }
    }

    pub(super) fn difference(&self, a: &Value, b: &Value) -> f64 {
        if self.rotates { chord(quaternion(a), quaternion(b)) } else { vector(a).distance(vector(b)) }
    }

    /// As a reader interpolates between two frames.
    pub(super) fn between(&self, from: usize, to: usize, share: f64) -> Value {
        let (a, b) = (&self.values[from], &self.values[to]);
        if self.rotates {
            let turn = slerp(quaternion(a), quaternion(b), share);
            [turn.x as f32, turn.y as f32, turn.z as f32, turn.w as f32]
        } else {
            let place = vector(a).lerp(vector(b), share);
            [place.x as f32, place.y as f32, place.z as f32, 0.0]
        }
    }

    /// Between `frame` and the next, from the keys that are left.
    pub(super) fn reduced(&self, times: &[f32], frame: usize, share: f64) -> Value {
        let (from, to) = (self.around[frame].0, self.around[(frame + 1).min(times.len() - 1)].1);
        if from == to || times[from] >= times[to] {
            return self.values[from];
        }
        let time = f64::from(times[frame])
            + share * (f64::from(times[(frame + 1).min(times.len() - 1)]) - f64::from(times[frame]));
        self.between(from, to, (time - f64::from(times[from])) / (f64::from(times[to]) - f64::from(times[from])))
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
        (from + 1..to).all(|frame| {
            let share = (times[frame] - times[from]) / (times[to] - times[from]);
            let holds = !self.rotates || (0..2).any(|side| self.moves[side] && planted[side][frame]);
            let tolerance = if holds { self.tolerance } else { UPPER_TOLERANCE / 2.0 };
            self.difference(&self.between(from, to, share), &self.values[frame]) <= tolerance
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

    pub(super) fn channel(&self, times: &[f32]) -> Channel {
        let kept: Vec<usize> = (0..times.len()).filter(|frame| self.keep[*frame]).collect();
        let values = if self.rotates {
            let mut keys: Vec<Value> = Vec::with_capacity(kept.len());
            for frame in &kept {
                let key = self.values[*frame];
                let opposite =
                    keys.last().is_some_and(|before| before.iter().zip(&key).map(|(a, b)| a * b).sum::<f32>() < 0.0);
                keys.push(if opposite { key.map(|part| 0.0 - part) } else { key });
            }
            KeyValues::Rotation(keys)
        } else {
            KeyValues::Translation(
                kept.iter()
                    .map(|frame| [self.values[*frame][0], self.values[*frame][1], self.values[*frame][2]])
                    .collect(),
            )
        };
        let times = kept.iter().map(|frame| times[*frame]).collect();
        Channel { target: self.target, times, values, interpolation: Interpolation::Linear }
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
