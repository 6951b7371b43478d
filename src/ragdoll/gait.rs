//! What a walk is made of: where to go, the gait's constants and memory, its steady orbit's parts, and what a body is fit for.
//!
//! Scenario space, SI; lengths are for legs of 0.83 m, times for a centre of mass 0.96 m up, and scale with them.

use crate::maths::real;
use crate::model::Side;
use glam::DVec2;

/// Where to walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Order {
    /// m/s, (x, z).
    pub velocity: DVec2,
    /// rad, where to face.
    pub facing: f64,
}

/// Constants of the gait.
#[derive(Clone, Copy, Debug)]
pub struct WalkTuning {
    /// s, from touchdown to touchdown, at no speed and for each m/s more.
    pub step: [f64; 2],
    /// Share of a step in which both feet bear.
    pub double: f64,
    /// m, between the feet.
    pub width: f64,
    /// m, the pressure's way under a foot at 1 m/s, from and to.
    pub roll: [f64; 2],
    /// Feedback from ξ to the pressure.
    pub gain: f64,
    /// m/s, the most.
    pub fastest: f64,
    /// m/s², how fast the speed changes.
    pub ramp: f64,
    /// rad/s, how fast the heading changes.
    pub turn: f64,
    /// m, lift of a foot.
    pub lift: f64,
    /// m, how near to the stance foot ξ must be for the first step.
    pub over: f64,
    /// m, the least distance to the own side of the stance foot.
    pub clear: f64,
    /// m, from the stance foot.
    pub span: f64,
    /// Share of ξ's error that the next foot takes up.
    pub place: f64,
    /// 1/s, how fast a lasting lack of speed is made up for.
    pub integral: f64,
    /// rad at 1 m/s, swing of the arms.
    pub arms: f64,
    /// rad at 1 m/s, twist of the trunk.
    pub twist: f64,
    /// Weight of the pelvis's yaw among what the contact forces are for.
    pub yaw: f64,
    /// Share of a swing by which the foot must be off the ground.
    pub rise: f64,
    /// m, a foothold so much farther off than the gait's own is to be come down on sooner.
    pub astray: f64,
    /// s, the shortest swing.
    pub soonest: f64,
    /// m/s, how fast a foot gets about.
    pub speed: f64,
    /// m/s, what a landing before its time costs.
    pub hurry: f64,
    /// What a foothold that is farther off than that costs, and one beyond reach.
    pub dear: [f64; 2],
    /// m, from the hip.
    pub reach: f64,
    /// Share of a leg's length that it uses: who walks with bent knees bends his ankles to their end.
    pub legs: f64,
    /// Share of the observed push that is foreseen.
    pub foreseen: f64,
    /// m, ξ so far off its orbit at a touchdown is caught, and one so near to it goes on.
    pub caught: [f64; 2],
    /// Share of the speed that corrective steps keep.
    pub keeps: f64,
}

impl Default for WalkTuning {
    fn default() -> WalkTuning {
        WalkTuning {
            step: [0.50, -0.05],
            double: 0.06,
            width: 0.11,
            roll: [-0.05, 0.07],
            gain: 2.0,
            fastest: 1.3,
            ramp: 0.8,
            turn: 0.6,
            lift: 0.04,
            over: 0.05,
            clear: 0.09,
            span: 0.9,
            place: 1.0,
            integral: 0.3,
            arms: 0.6,
            twist: 0.08,
            yaw: 3.0,
            rise: 0.05,
            astray: 0.2,
            soonest: 0.22,
            speed: 4.0,
            hurry: 0.5,
            dear: [0.5, 2.0],
            reach: 0.5,
            legs: 0.98,
            foreseen: 0.0,
            caught: [0.2, 0.1],
            keeps: 0.5,
        }
    }
}

/// Where in the gait.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// Not walking.
    #[default]
    Rest,
    /// The weight goes over the first stance foot.
    Start,
    /// Both feet bear.
    Double,
    /// One foot bears.
    Single,
    /// It was pushed off its orbit: corrective steps bring it back, and the walk goes on from there.
    Caught,
}

/// m/s: what a body does that is to walk at `at` m/s on legs of 0.83 m, by its legs and by how fast it falls.
pub(super) fn fastest(size: f64, com_height: f64, at: f64) -> f64 {
    at * size / (com_height / 0.96).sqrt()
}

/// What the gait remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gait {
    /// Its constants.
    pub tuning: WalkTuning,
    pub(super) phase: Phase,
    pub(super) velocity: DVec2,
    pub(super) side: usize, // that swings, or will next
    pub(super) since: f64,  // the last touchdown, or the start
    pub(super) goal: DVec2,
    pub(super) ends: f64, // when both feet bear no more
    pub(super) lacks: DVec2,
    pub(super) mean: DVec2,
}

/// The steady gait beside the stance sole's middle, at an instant.
pub(super) struct Orbit {
    pub(super) cop: DVec2,
    pub(super) xi: DVec2,
    pub(super) stride: DVec2,
    pub(super) rear: f64,
    pub(super) left: f64,
}

impl Gait {
    /// Whether it is in charge.
    pub fn walks(&self) -> bool {
        !matches!(self.phase, Phase::Rest | Phase::Caught)
    }

    /// m/s, the command as it is followed now, (x, z).
    pub fn velocity(&self) -> DVec2 {
        self.velocity
    }

    /// Whether both feet bear, or one does, in a walk that has begun.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    pub(super) fn pressure(&self) -> Option<DVec2> {
        self.walks().then_some(self.goal)
    }

    /// Whether that foot is about to leave.
    pub(super) fn leaves(&self, side: Side, time: f64) -> bool {
        self.phase == Phase::Double && self.side == side as usize && time > self.ends - 0.03
    }

    pub(super) fn swings(&self) -> Side {
        Side::BOTH[self.side]
    }
}

/// A ground vector (x, z) turned by a yaw.
pub(super) fn turned(vector: DVec2, yaw: f64) -> DVec2 {
    let (sin, cos) = real::sin_cos(yaw);
    DVec2::new(vector.x * cos + vector.y * sin, vector.y * cos - vector.x * sin)
}

/// What a straight run of the pressure of `time` s, that starts `after` s from now, counts in ξ: of its two ends.
pub(super) fn weights(rate: f64, after: f64, time: f64) -> [f64; 2] {
    let (one, two) = (real::exp(-rate * after), real::exp(-rate * (after + time)));
    if rate * time < 1e-9 {
        return [0.0, 0.0];
    }
    let mean = (one - two) / (rate * time);
    [one - mean, mean - two]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressure_s_weights_are_those_of_the_pendulum() {
        // A pressure that stays counts all that is left of ξ over the time: 1 - e^(-ωT).
        let [a, b] = weights(3.2, 0.0, 0.4);
        assert!((a + b - (1.0 - real::exp(-3.2_f64 * 0.4))).abs() < 1e-12 && a > b, "{a} {b}");
        assert_eq!(weights(3.2, 0.1, 0.0), [0.0, 0.0]);
    }

    #[test]
    fn the_fastest_walk_is_in_proportion_to_the_body() {
        let (tall, small) = (fastest(1.0, 0.96, 1.3), fastest(0.25, 0.24, 1.3));
        assert!((tall - 1.3).abs() < 1e-12);
        assert!((small - 0.65).abs() < 1e-12, "a quarter of the size walks at the half of the speed: {small}");
        assert!(fastest(0.5, 0.96, 1.3) < tall, "short legs under a high centre of mass");
    }
}
