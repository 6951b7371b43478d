//! By how much more than on level ground a foot is lifted on its way: over the edges of stairs and over bumps.
//!
//! Metres, ground frame; times as shares of the swing. The least curved lift that keeps the whole sole over the ground.

use crate::maths::banded::BandedLeastSquares;
use crate::maths::curve::{bump, sample, smooth3, trapezoid};
use crate::model::Terrain;
use glam::{DVec2, DVec3};

/// Pieces of a swing.
const PIECES: usize = 32;
/// Weight of a sample that must be higher, against the squared curvature (a share of the swing is the unit of time): a
/// few millimetres are given for a foot that does not leap.
const HOLD: f64 = 1e6;
/// Rounds of the one-sided penalty.
const ROUNDS: usize = 16;
/// Share of a swing, at each end, over which a sole may lie in round ground as it does where it stands.
const NEAR: f64 = 0.25;
/// m, how far ahead and behind an edge is seen.
const AHEAD: f64 = 0.02;
/// m, by which a sole lacks more half a piece before or after: an edge is met there.
const EDGE: f64 = 0.03;
/// Part of the swing's clearance that is kept over the ground at mid-swing.
const MARGIN: f64 = 0.4;
/// How much sooner than the way over the ground the way up a stair is done.
const SOONER: f64 = 1.35;
/// Share of the swing by which the way over the ground starts later (or ends sooner, downwards).
const LATER: f64 = 0.12;

/// A lift over a swing, sampled evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Raise([f64; PIECES + 1]);

/// The shares of a stair's depth and height at a share of the swing: first up and then over, first over and then down.
pub(super) fn stair(u: f64, up: bool) -> [f64; 2] {
    let (late, soon) = (trapezoid((u - LATER) / (1.0 - LATER)), trapezoid(u * SOONER));
    let (early, last) = (trapezoid(u / (1.0 - LATER)), 1.0 - trapezoid((1.0 - u) * SOONER));
    if up { [late, soon] } else { [early, last] }
}

impl Raise {
    /// Nothing in the way.
    pub(super) const NONE: Raise = Raise([0.0; PIECES + 1]);

    /// m.
    pub(super) fn at(&self, u: f64) -> f64 {
        if *self == Raise::NONE { 0.0 } else { sample(&self.0, 1.0 / PIECES as f64, u) }
    }

    /// For a foot whose sole is where `sole` says without it; `way`: the swing's direction, unit; `clearance`: what it has
    /// over level ground, m.
    pub(super) fn over(terrain: &Terrain, way: DVec2, clearance: f64, sole: &dyn Fn(f64, &mut Vec<DVec3>)) -> Raise {
        let mut points = Vec::new();
        let mut lacks = |u: f64| {
            sole(u, &mut points);
            let reach = AHEAD * bump(u).sqrt();
            let ground = |point: &DVec3| {
                let at = DVec2::new(point.x, point.z);
                [-reach, 0.0, reach]
                    .map(|ahead| terrain.spot(at + way * ahead).height)
                    .into_iter()
                    .fold(f64::MIN, f64::max)
            };
            points.iter().map(|point| ground(point) - point.y).fold(f64::MIN, f64::max)
        };
        let mut need = [0.0; PIECES + 1];
        for (index, need) in need.iter_mut().enumerate() {
            let u = index as f64 / PIECES as f64;
            *need = lacks(u);
            // An edge may be met between two of them.
            if index > 0 && index < PIECES {
                let beside = [u - 0.5 / PIECES as f64, u + 0.5 / PIECES as f64].map(&mut lacks);
                *need = beside.into_iter().filter(|lack| *lack > *need + EDGE).fold(*need, f64::max);
            }
        }
        let ends = [need[0].max(0.0), need[PIECES].max(0.0)];
        for (index, need) in need.iter_mut().enumerate() {
            let u = index as f64 / PIECES as f64;
            *need -= ends[0] * (1.0 - smooth3(u / NEAR)) + ends[1] * (1.0 - smooth3((1.0 - u) / NEAR));
            *need += MARGIN * clearance * bump(u);
        }
        Raise::least(&need)
    }

    /// The least curved lift over `need`, at rest at both ends.
    fn least(need: &[f64; PIECES + 1]) -> Raise {
        let mut held = need.map(|need| need > 1e-4);
        if !held.contains(&true) {
            return Raise::NONE;
        }
        let bend = (PIECES * PIECES) as f64;
        let mut lift = vec![0.0; PIECES + 1];
        for _ in 0..ROUNDS {
            let mut system = BandedLeastSquares::new(PIECES + 1, 2);
            for index in 0..PIECES - 1 {
                system.equation(index, &[bend, -2.0 * bend, bend], 0.0, 1.0);
            }
            for index in [0, 1, PIECES - 1, PIECES] {
                system.equation(index, &[1.0], 0.0, 1e3 * HOLD);
            }
            for index in 2..PIECES - 1 {
                system.equation(index, &[1.0], 0.0, 1.0);
                if held[index] {
                    system.equation(index, &[1.0], need[index], HOLD);
                }
            }
            lift = system.solve();
            let now: Vec<bool> = lift.iter().zip(need).map(|(lift, need)| *need > 1e-4 && lift < need).collect();
            if now == held {
                break;
            }
            held.copy_from_slice(&now);
        }
        let mut raise = Raise::NONE;
        raise.0.iter_mut().zip(lift).for_each(|(raise, lift)| *raise = lift.max(0.0));
        raise
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::{Ground, GroundKind};

    #[test]
    fn a_foot_goes_over_the_edge_of_a_stair() {
        let kind = GroundKind::Stairs { rise: 0.17, tread: 0.3, count: 4 };
        let terrain = Terrain::new(&Ground { kind, ..Ground::default() });
        // A sole of 0.2 m from 0.7 to 1.15 m, 17 cm up.
        let sole = |u: f64, points: &mut Vec<DVec3>| {
            let [over, up] = stair(u, true);
            let way = 0.7 + 0.45 * over;
            points.clear();
            let height = 0.17 * up + 0.06 * bump(u);
            points.extend((0..=10).map(|at| DVec3::new(0.0, height, way - 0.07 + 0.02 * f64::from(at))));
        };
        let raise = Raise::over(&terrain, DVec2::Y, 0.06, &sole);
        let mut points = Vec::new();
        for index in 0..=200 {
            let u = f64::from(index) / 200.0;
            sole(u, &mut points);
            let under = points.iter().map(|p| terrain.spot(DVec2::new(p.x, p.z)).height - p.y - raise.at(u));
            assert!(under.fold(f64::MIN, f64::max) < 3e-3, "at {u}");
        }
        let steps: Vec<f64> = (0..=100).map(|at| raise.at(f64::from(at) / 100.0)).collect();
        let worst = steps.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).fold(0.0, f64::max);
        assert!(worst < 0.01 && steps[0] == 0.0 && steps[100] == 0.0, "{worst}");
        assert_eq!(Raise::over(&Terrain::flat(), DVec2::Y, 0.0, &sole), Raise::NONE);
    }
}
