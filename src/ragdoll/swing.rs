//! The swing foot's reference: a quintic that is planned anew each tick, and a lift. Scenario space, SI.

use crate::maths::curve::smooth3;
use glam::{DVec2, DVec3};

/// Where the reference is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// m, the ankle's ground point, and the lift as y.
    pub at: DVec3,
    /// m/s.
    pub velocity: DVec3,
    /// m/s².
    pub acceleration: DVec3,
}

/// One axis of the least-jerk way from a state to a rest at `goal` in `time` s, after `dt` s: place, speed, acceleration.
pub(super) fn quintic(from: [f64; 3], goal: [f64; 2], time: f64, dt: f64) -> [f64; 3] {
    let [p, v, a] = from;
    let [q, w] = goal;
    let t = time.max(1e-3);
    let (t2, t3) = (t * t, t * t * t);
    let d = q - p - v * t - 0.5 * a * t2;
    let e = w - v - a * t;
    let f = -a;
    let c3 = (10.0 * d - 4.0 * e * t + 0.5 * f * t2) / t3;
    let c4 = (-15.0 * d + 7.0 * e * t - f * t2) / (t3 * t);
    let c5 = (6.0 * d - 3.0 * e * t + 0.5 * f * t2) / (t3 * t2);
    let s = dt.min(t);
    [
        p + s * (v + s * (0.5 * a + s * (c3 + s * (c4 + s * c5)))),
        v + s * (a + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5))),
        a + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5)),
    ]
}

/// The level part of the reference a tick later, on its way to `target` in `time` s.
pub(super) fn onwards(reference: &Reference, target: DVec2, time: f64, dt: f64) -> Reference {
    let mut next = *reference;
    for axis in [0, 2] {
        let goal = if axis == 0 { target.x } else { target.y };
        let from = [reference.at[axis], reference.velocity[axis], reference.acceleration[axis]];
        let [p, v, a] = quintic(from, [goal, 0.0], time, dt);
        next.at[axis] = p;
        next.velocity[axis] = v;
        next.acceleration[axis] = a;
    }
    next
}

/// m at legs of 0.83 m: ankles that pass each other are that far apart, and a foot is aimed at most so far beside its goal for it.
const PASSES: f64 = 0.12;
const ASIDE: f64 = 0.25;
/// Share of the way, at either end of it, within which the foot that stands is not passed.
const PASSED: f64 = 0.1;
/// Share of the way at which the foot that stands is passed, at the least, for the aim that goes around it: one that is passed earlier would need
/// an aim far beside the goal.
const SOONEST: f64 = 0.3;

/// m, so far towards `out` of its goal a foot is to be aimed, for its straight way to pass the ankle that `stands` on that side; 0 once it has
/// passed. Aimed anew in each tick it goes around.
pub(super) fn aside([at, goal]: [DVec2; 2], stands: DVec2, out: DVec2, size: f64) -> f64 {
    let way = goal - at;
    let share = (stands - at).dot(way) / way.length_squared().max(1e-9);
    let passes = (share.min(1.0 - share) / PASSED).clamp(0.0, 1.0);
    let apart = (at + way * share - stands).dot(out);
    let lacks = (PASSES * size - apart).max(0.0) * passes;
    (lacks / share.clamp(SOONEST, 1.0)).min(ASIDE * size)
}

/// Share of a swing at which the foot is to be down.
pub(super) const LANDS: f64 = 0.92;

/// Lift at a share of the swing, its first and its second derivative by that share: 0 at both ends.
pub(super) fn lift(x: f64) -> [f64; 3] {
    let x = x.clamp(0.0, 1.0);
    let (y, d) = (x * (1.0 - x), 1.0 - 2.0 * x);
    [16.0 * y * y, 32.0 * y * d, 32.0 * (d * d - 2.0 * y)]
}

/// How much of the height for hanging toes a foot is given at a share of its swing: gained and lost in those shares.
pub(super) fn aloft(share: f64, [gains, loses]: [f64; 2]) -> f64 {
    smooth3(share / gains) * smooth3((1.0 - share) / loses)
}

/// Share of a led swing at which its foot is highest: early, as people's is. m/s at legs of 0.83 m, how fast it comes down.
pub(super) const HIGHEST: f64 = 0.35;
const LANDING: f64 = 0.37;
/// m/s, how fast a foot goes on down that is late.
const SINKS: f64 = 0.6;

/// The height of a led foot's reference a tick later, its speed and its acceleration: from how it moves to the top and then down to
/// the ground (m), as far as it has come in the swing's time (s).
pub(super) fn over(
    reference: &Reference,
    [top, ground]: [f64; 2],
    tempo: f64,
    (passed, time, highest): (f64, f64, f64),
    dt: f64,
) -> [f64; 3] {
    let from = [reference.at.y, reference.velocity.y, reference.acceleration.y];
    let (highest, lands) = (highest * time, LANDS * time);
    if passed < highest {
        quintic(from, [top, 0.0], highest - passed, dt)
    } else if passed < lands - dt {
        quintic(from, [ground, -LANDING * tempo], lands - passed, dt)
    } else {
        down(reference, dt)
    }
}

/// The height of the reference of a foot that should be down by now.
pub(super) fn down(reference: &Reference, dt: f64) -> [f64; 3] {
    [reference.at.y - SINKS * dt, -SINKS, 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foot_that_passes_the_other_one_goes_around_it_and_still_arrives() {
        let (stands, goal) = (DVec2::ZERO, DVec2::new(0.03, 0.35));
        let mut foot = Reference { at: DVec3::new(0.04, 0.0, -0.4), ..Reference::default() };
        let mut nearest = f64::INFINITY;
        for tick in 0..30 {
            let at = DVec2::new(foot.at.x, foot.at.z);
            nearest = nearest.min(at.distance(stands));
            let aimed = goal + DVec2::X * aside([at, goal], stands, DVec2::X, 1.0);
            foot = onwards(&foot, aimed, 0.30 - 0.01 * f64::from(tick), 0.01);
        }
        assert!(nearest > 0.9 * PASSES, "{nearest}");
        assert!(DVec2::new(foot.at.x, foot.at.z).distance(goal) < 1e-3, "{foot:?}");
    }

    #[test]
    fn a_foot_whose_way_is_clear_or_that_has_passed_is_aimed_at_its_goal() {
        let goal = DVec2::new(0.15, 0.4);
        for at in [DVec2::new(0.15, -0.4), DVec2::new(0.03, 0.1)] {
            assert_eq!(aside([at, goal], DVec2::ZERO, DVec2::X, 1.0), 0.0, "{at}");
        }
    }

    #[test]
    fn height_for_hanging_toes_is_there_in_the_midst_of_a_swing_and_at_neither_end() {
        assert_eq!([0.0, 0.3, 0.5, 0.6, 1.0].map(|share| aloft(share, [0.3, 0.4])), [0.0, 1.0, 1.0, 1.0, 0.0]);
    }

    #[test]
    fn the_quintic_arrives_at_rest_from_any_start() {
        let mut state = [0.1, -0.5, 3.0];
        for tick in 0..30 {
            state = quintic(state, [0.7, 0.0], 0.30 - 0.01 * f64::from(tick), 0.01);
        }
        assert!((state[0] - 0.7).abs() < 1e-6 && state[1].abs() < 1e-4, "{state:?}");
    }
}
