//! Breathing and the small unrest of who stands still. Radians, seconds; amplitudes of quiet standing people at 0.5.
//!
//! A breath every four seconds or so lifts the chest and the arms on it; slower wandering of trunk, hips and head comes from sines
//! whose periods have no common measure. All drawn by the seed. Nothing at the clip's first and last frame, so that it starts and ends
//! in the pose that it would without; nothing of it in a walk or while something is being recovered from. The centre of mass
//! stays where it was: the solver moves the hips against the chest.

use super::reaction::{UPPER, UpperAngles};
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::maths::seed::Seed;
use std::f64::consts::TAU;

/// s, in which it comes up at the start and goes at the end.
const FADES: f64 = 0.8;
/// Breaths a second.
const BREATHS: [f64; 2] = [0.22, 0.28];
/// rad, of the chest backwards when it is full, at 0.5.
const CHEST: f64 = 0.011;
/// rad, of the arms outwards likewise.
const ARMS: f64 = 0.012;
/// Wanderings: which angle, rad at 0.5, and whether it is to one side.
const WANDERS: [(usize, f64, bool); 6] =
    [(0, 0.005, true), (1, 0.006, false), (2, 0.006, true), (3, 0.006, false), (4, 0.008, true), (5, 0.006, true)];
/// 1/s, about the frequencies of the sines of one wandering.
const WANDER_HZ: [f64; 3] = [0.11, 0.19, 0.31];

/// The unrest of one clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Sway {
    amount: f64,
    side: f64,
    seconds: f64,
    scale: f64,
    breath: [f64; 2],          // 1/s, and turns that it starts at
    waves: Vec<[[f64; 2]; 3]>, // the same, of each wandering
}

impl Sway {
    /// Of a clip so many `seconds` long. `amount`: 0..1, 0 none, 0.5 as in people; `side`: 1 or -1, the side that it is drawn for (a
    /// mirrored scenario sways mirrored); `scale`: times people's times.
    pub fn new(seed: u64, amount: f64, side: f64, seconds: f64, scale: f64) -> Sway {
        let mut draw = Seed::new(seed).split(0x53a7);
        let breath = [draw.between(BREATHS[0], BREATHS[1]), draw.unit()];
        let wave = |draw: &mut Seed| WANDER_HZ.map(|hz| [hz * draw.between(0.8, 1.25), draw.unit()]);
        let waves = WANDERS.iter().map(|_| wave(&mut draw)).collect();
        Sway { amount, side, seconds, scale, breath, waves }
    }

    /// What is added to the angles at a time, of who is that `calm` (0..1).
    pub fn at(&self, time: f64, calm: f64) -> UpperAngles {
        let mut angles = [0.0; UPPER];
        let shown = smooth3(time / FADES) * smooth3((self.seconds - time) / FADES);
        let share = 2.0 * self.amount * shown * calm.clamp(0.0, 1.0);
        if share <= 0.0 {
            return angles;
        }
        let time = time / self.scale;
        let phase = self.breath[0] * time + self.breath[1];
        // In is quicker than out.
        let full = real::sin(TAU * phase + 0.35 * real::sin(TAU * phase));
        for ((entry, size, sideways), waves) in WANDERS.iter().zip(&self.waves) {
            let wave: f64 = waves.iter().map(|[hz, start]| real::sin(TAU * (hz * time + start))).sum();
            angles[*entry] = share * size * wave / 1.7 * if *sideways { self.side } else { 1.0 };
        }
        angles[1] -= share * CHEST * full;
        for side in 0..2 {
            angles[8 + side * 3] += share * ARMS * full;
        }
        angles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peak(sway: &Sway, entry: usize) -> f64 {
        (0..=1000).map(|tick| sway.at(0.01 * f64::from(tick), 1.0)[entry].abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_still_person_moves_by_half_a_degree_or_so_and_starts_and_ends_where_he_stood() {
        let sway = Sway::new(3, 0.5, 1.0, 10.0, 1.0);
        for entry in [0, 1, 2, 3, 4, 5, 8, 11] {
            let degrees = peak(&sway, entry).to_degrees();
            assert!((0.15..1.5).contains(&degrees), "{entry}: {degrees}");
        }
        assert_eq!((sway.at(0.0, 1.0), sway.at(10.0, 1.0)), ([0.0; UPPER], [0.0; UPPER]));
        assert_eq!(sway.at(5.0, 0.0), [0.0; UPPER], "not while he recovers");
        assert_eq!(peak(&Sway::new(3, 0.0, 1.0, 10.0, 1.0), 1), 0.0, "not where none is asked for");
    }

    #[test]
    fn seeds_differ_and_the_other_side_is_the_mirror_image() {
        let [one, other, mirrored] =
            [(1, 1.0), (2, 1.0), (1, -1.0)].map(|(seed, side)| Sway::new(seed, 0.5, side, 9.0, 1.0));
        assert_ne!(one.at(4.0, 1.0), other.at(4.0, 1.0));
        let (ours, theirs) = (one.at(4.0, 1.0), mirrored.at(4.0, 1.0));
        for entry in [0, 2, 4, 5] {
            assert_eq!(ours[entry], -theirs[entry], "{entry}");
        }
        for entry in [1, 3, 8, 11] {
            assert_eq!(ours[entry], theirs[entry], "{entry}");
        }
    }
}
