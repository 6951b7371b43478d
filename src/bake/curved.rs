//! Keys joined by splines: bisection where a planted foot would slip, reduction everywhere else.
//!
//! Few keys, which are easy to edit: `--curves spline`. Reduction leaves out keys channel by channel, and the planted feet are measured
//! again on what is left. Lengths in m, angles in rad.

use super::chain::Chain;
use super::contacts::FootContact;
use super::key_times::SHORTEST;
use super::keys::Frames;
use super::track::{Frame, Track};
use crate::model::Side;
use glam::DQuat;

/// m: a frame is put in where a planted foot is off by more between frames.
const BISECT: f64 = 0.05e-3;
/// m: keys are put back where a planted foot is off by more after reduction.
const SLIP: f64 = 0.22e-3;
/// A second: what of the poses' slopes a key may lack, in rad or m, before it gets them for its own.
const ASTRAY: f64 = 0.03;
/// Times its tolerance that a leg may be off where keys for a planted foot are near.
const ASIDE: f64 = 1.0;
/// Times that keys are put back.
const PUT_BACK: i32 = 24;

/// A contact with its first and its last moment as keys have them, s.
pub(super) type Held<'a> = (&'a FootContact, f32, f32);

impl Frames<'_> {
    /// Chooses the keys.
    pub(super) fn choose_curved(&mut self, contacts: &[Held], legs: &[Chain; 2], turn: &dyn Fn(f64) -> DQuat) {
        self.bisect(contacts, legs, turn);
        self.reduce(contacts);
        self.put_back(contacts, legs, turn);
        self.bring_back(contacts);
        self.put_back(contacts, legs, turn);
    }

    /// Splits intervals in which a planted foot would slip, as long as that helps.
    fn bisect(&mut self, contacts: &[Held], legs: &[Chain; 2], turn: &dyn Fn(f64) -> DQuat) {
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

    /// Leaves out every key that interpolation restores.
    fn reduce(&mut self, contacts: &[Held]) {
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
                if track.moves == [false; 2] {
                    track.choose_join(&times, &planted);
                } else {
                    track.choose(&times, &planted);
                }
            }
            track.settle(&times);
        }
    }

    /// (sides, frames) whether the foot holds something.
    fn planted(&self, contacts: &[Held]) -> [Vec<bool>; 2] {
        Side::BOTH.map(|side| {
            let holds = |time: &f32| {
                contacts.iter().any(|(contact, start, end)| contact.side == side && start <= time && time <= end)
            };
            self.times.iter().map(holds).collect()
        })
    }

    /// Puts keys back where what was done for the planted feet led the legs astray beside them.
    fn bring_back(&mut self, contacts: &[Held]) {
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
    fn put_back(&mut self, contacts: &[Held], legs: &[Chain; 2], turn: &dyn Fn(f64) -> DQuat) {
        let times: Vec<f64> = self.times.iter().map(|time| f64::from(*time)).collect();
        let root = self.root();
        for pass in 1..PUT_BACK {
            let mut missing: Vec<(usize, usize)> = Vec::new(); // frame, side
            for (contact, start, end) in contacts {
                let leg = &legs[contact.side as usize];
                let first = self.frame_at(*start);
                let held = leg.held(contact.part, &|track| self.tracks[track].frames[first].value);
                let held = held.seen_from(turn(f64::from(self.times[first])));
                let mut worst = (SLIP, None); // of a run of intervals that slip
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
                    if off > SLIP && pass > PUT_BACK / 2 {
                        // Where the worst cannot be mended, its neighbours can.
                        missing.push((frame, contact.side as usize));
                    } else if off > worst.0 {
                        worst = (off, Some(frame));
                    } else if off <= SLIP {
                        missing.extend(worst.1.map(|frame| (frame, contact.side as usize)));
                        worst = (SLIP, None);
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
}
