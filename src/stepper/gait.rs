//! The gait's own sums: its rhythm at a speed, the pressure's roll under a step, and where the next foot must land for
//! the speed to be held. Ground plane (x, z), metres, seconds.
//!
//! A step is reckoned from touchdown to touchdown: the pressure runs from the rear ball to the front heel while both
//! feet carry, then from heel to ball under the one. Of such a roll the pendulum feels one effective pivot, and over
//! that pivot the paper's formula gives the step's length. Sources: Kenwright (2013), step distance with residual
//! speed; Hof (2008), steady gait by the extrapolated centre of mass; Sekiya (1997), walk ratio.

use super::{Params, Physique, footing, kerb, support};
use crate::maths::pendulum;
use crate::maths::real;
use crate::model::Side;
use glam::DVec2;

/// One step of a steady gait.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rhythm {
    /// s, from touchdown to touchdown.
    pub step: f64,
    /// s of it, both feet carry.
    pub double: f64,
    /// m, between the lines of the two feet.
    pub width: f64,
    /// m ahead of the ankle, where the pressure arrives under a foot and where it leaves it.
    pub roll: [f64; 2],
    /// Share of the time on one foot in which it rolls; after that the pressure stays where it leaves.
    pub run: f64,
}

/// m/s of the reference body: a walk up to the first is slow, one from the second on is not.
const SLOW: [f64; 2] = [0.3, 0.7];

/// m/s ahead of the reference body: a walk from the second on is fast, one up to the first is not.
const FAST: [f64; 2] = [0.7, 1.45];
/// Times as many steps as of a body that goes ahead where nothing is in its way, of another (`timed` of [`rhythm`]).
const ELSEWHERE: f64 = 1.2;

/// m/s of the reference body: a walk from the second on is brisk, one up to the first is not.
const BRISK: [f64; 2] = [1.4, 1.6];
/// m per step/min, the walk ratio ahead of one that is not brisk and of one that is: Sekiya's 0.0065, within whose spread of 0.0006 a brisk
/// one is quicker. At its 0.0065 the hips must drop so far and so fast between the feet that the ground would have to pull.
const RATIOS: [f64; 2] = [0.0065, 0.0061];
/// m of the reference body, no step is longer, for the same.
const FARTHEST: f64 = 0.812;

/// The rhythm in which people walk at that velocity, m/s (x, z), and turn at that rate, rad/s, where no step is longer
/// than `longest` m, or all are `even` m long; a slow walk takes its time the less the more it is `hurried`, 0 to 1. `timed`, 0 to 1: a
/// body takes more steps, as one that goes sideways or backwards does, for they are timed to land off edges, or ankles do little for it.
pub fn rhythm(
    params: &Params,
    physique: &Physique,
    ahead: DVec2,
    velocity: DVec2,
    (turn, longest, even): (f64, f64, Option<f64>),
    (hurried, timed): (f64, f64),
) -> Rhythm {
    let pace = velocity * (params.tempo / params.size); // of the reference body
    let speed = pace.length();
    let way = pace / speed.max(1e-9);
    let (along, across) = (way.dot(ahead), way.perp_dot(ahead));
    let brisk = ((speed - BRISK[0]) / (BRISK[1] - BRISK[0])).clamp(0.0, 1.0);
    let forward = if along > 0.0 { RATIOS[0] + (RATIOS[1] - RATIOS[0]) * brisk } else { 0.0050 };
    let ratio = forward * along * along + 0.0018 * across * across; // m per step/min
    let spin = (turn.abs() * params.tempo).min(1.0);
    let hurried = ((speed - SLOW[0]) / (SLOW[1] - SLOW[0])).max(spin).max(across.abs()).max(hurried);
    let quick = hurried.clamp(0.0, 1.0);
    let fast = ((along * speed - FAST[0]) / (FAST[1] - FAST[0])).clamp(0.0, 1.0);
    let [slowest, usual, flat, fastest] = params.cadence;
    // who cannot push off with his toes takes fewer steps
    let fastest = if params.balls.is_some() { fastest } else { flat };
    let least = slowest + (usual - slowest) * quick + (fastest - usual) * fast;
    let elsewhere = timed.max(1.0 - along.max(0.0).powi(2));
    let more = (ELSEWHERE * least.min(usual) - least).max(0.0);
    let least = if params.fits { least + more * elsewhere } else { least };
    let cadence = (60.0 * speed / ratio.max(1e-4)).sqrt().max(least.max(66.0 + 36.0 * spin));
    let step = (60.0 / cadence).min((longest / params.size).min(FARTHEST) / speed.max(1e-9));
    let [least, most] = kerb::TAKES;
    let step = even.map_or(step, |even| (even / params.size / speed.max(1e-9)).clamp(least, most));
    let share = (0.24 - 0.133 * (speed - 1.2)).clamp(0.14, 0.36);
    let travel = speed * step * across.abs() * params.size;
    let foot = physique.tip - physique.heel;
    // feet that land beside each other, not one ahead of the other, need room for their heels
    let ahead_by = (pace * step * params.size).dot(ahead).abs() / foot.max(1e-9);
    let beside = 2.0 * (physique.half_width - physique.heel * physique.toe_out.max(0.0)) + footing::ROOM * params.size;
    let room = (beside - params.step_width).max(0.0) * ((1.15 - ahead_by) / 0.3).clamp(0.0, 1.0);
    let full = (speed / 0.5).min(1.0) * along;
    let (rear, front) = (physique.heel + 0.26 * foot, physique.heel + 0.70 * foot);
    let (mid, half) = (0.5 * (rear + front), 0.5 * (front - rear) * full * params.rolled);
    let (mid, half) = if params.rolls { (mid + params.roll_ahead, half) } else { (params.com_forward, 0.0) };
    Rhythm {
        step: step * params.tempo,
        double: if params.rolls { params.double * share * step * params.tempo } else { 0.0 },
        width: params.step_width
            + room
            + (params.width - params.step_width).max(0.06 * params.size) * spin * (1.0 - speed).max(0.0)
            + travel,
        roll: [mid - half, mid + half],
        run: 1.0,
    }
}

/// What a linear run of the pressure weighs in ξ's fate: the factors of its two ends, for a run of `time` s that starts
/// `after` s from now.
pub fn weights(omega: f64, after: f64, time: f64) -> [f64; 2] {
    let (one, two) = (real::exp(-omega * after), real::exp(-omega * (after + time)));
    if omega * time < 1e-9 {
        return [0.0, 0.0];
    }
    let mean = (one - two) / (omega * time);
    [one - mean, mean - two]
}

/// The same of a run that is over after `run` of its time and stays at its end.
pub fn rolled(omega: f64, after: f64, time: f64, run: f64) -> [f64; 2] {
    let [from, to] = weights(omega, after, run * time);
    let stays = real::exp(-omega * (after + run * time)) - real::exp(-omega * (after + time));
    [from, to + stays]
}

/// Position and velocity after `time` s while the pivot runs straight from `from` to `to`, at constant height.
pub fn carried(position: DVec2, velocity: DVec2, [from, to]: [DVec2; 2], omega: f64, time: f64) -> (DVec2, DVec2) {
    let drift = (to - from) / time.max(1e-9);
    let (end, speed) = pendulum::predict(position, velocity - drift, from, omega, time);
    (end + drift * time, speed + drift)
}

/// The step that a landing begins, as ξ sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivot {
    /// Weights of the rear foot and of the landing one; they add up to 1.
    pub shares: [f64; 2],
    /// m, what the roll adds, (x, z).
    pub rolled: DVec2,
    /// m, how far ξ is from it at touchdown in the steady gait, (x, z).
    pub lead: DVec2,
    /// m, the same at the next touchdown, of the other foot.
    pub then: DVec2,
    /// m, from this landing to the next, (x, z).
    pub stride: DVec2,
    /// e^-ωT.
    pub decay: f64,
    /// Unit vector to the pelvis's left.
    pub aside: DVec2,
}

/// The effective pivot of the step that begins when `side` lands beside a foot of yaw `rear_yaw`, and ξ's lead on it
/// that keeps the velocity.
pub fn pivot(
    rhythm: &Rhythm,
    omega: f64,
    side: Side,
    [rear_yaw, yaw]: [f64; 2],
    ahead: DVec2,
    velocity: DVec2,
) -> Pivot {
    let [first, second] = weights(omega, 0.0, rhythm.double);
    let [third, fourth] = rolled(omega, rhythm.double, rhythm.step - rhythm.double, rhythm.run);
    let decay = real::exp(-omega * rhythm.step);
    let all = 1.0 - decay;
    let [early, late] = rhythm.roll;
    let toe = support::forward(yaw);
    let rolled = support::forward(rear_yaw) * (first * late) + toe * ((second + third) * early + fourth * late);
    let rolled = rolled / all;
    let shares = [first / all, (second + third + fourth) / all];
    let aside = DVec2::new(ahead.y, -ahead.x);
    let next = -aside * (side.sign() * rhythm.width);
    let mirrored = next * (shares[1] - shares[0]) - aside * (2.0 * rolled.dot(aside));
    let (along, across) = (velocity * (rhythm.step * decay / all), mirrored * (decay / (1.0 + decay)));
    let (lead, then) = (along + across, along - across);
    Pivot { shares, rolled, lead, then, stride: velocity * rhythm.step + next, decay, aside }
}

impl Pivot {
    /// The ξ at touchdown that suits that landing.
    pub fn xi_for(&self, rear: DVec2, ankle: DVec2) -> DVec2 {
        rear * self.shares[0] + ankle * self.shares[1] + self.rolled + self.lead
    }

    /// The landing after which the next one will be a steady one, for a body that is at `com` with `velocity` at
    /// touchdown: along the way by the paper's step distance with the apex speed that belongs to it.
    pub fn landing(
        &self,
        rear: DVec2,
        (com, velocity): (DVec2, DVec2),
        (omega, height, rise): (f64, f64, f64),
        way: DVec2,
    ) -> DVec2 {
        let mirror = |of: DVec2| of - self.aside * (2.0 * of.dot(self.aside));
        let fixed = rear * self.shares[0] + self.rolled;
        let then = self.stride * self.shares[1] + mirror(self.rolled) + self.then; // the next landing is a steady one
        let [kept, gone] = [1.0 - self.decay, self.decay];
        let ankle = (com + velocity / omega - fixed * kept - then * gone) / (self.shares[1] * kept + gone);
        let wanted = fixed + ankle * self.shares[1] - com;
        let (speed, level) = (velocity.dot(way), wanted.dot(way));
        // the apex speed that the vault over a level step leaves
        let residual = speed * speed - 2.0 * pendulum::GRAVITY * (real::hypot(height, level) - height);
        let distance = if residual > 0.0 && level > 0.0 {
            pendulum::step_distance(speed, residual.sqrt(), height, rise)
        } else {
            level
        };
        ankle + way * ((distance - level) / self.shares[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_roll_that_is_over_early_carries_the_body_as_its_two_parts_do() {
        let (omega, time, run) = (3.2, 0.4, 0.7);
        let [from, to] = [DVec2::new(0.0, -0.05), DVec2::new(0.0, 0.12)];
        let (com, velocity) = (DVec2::new(0.02, 0.0), DVec2::new(0.1, 1.1));
        let (amid, then) = carried(com, velocity, [from, to], omega, run * time);
        let (end, last) = carried(amid, then, [to, to], omega, (1.0 - run) * time);
        let [one, two] = rolled(omega, 0.0, time, run);
        let xi = (com + velocity / omega - from * one - to * two) * real::exp(omega * time);
        assert!(xi.distance(end + last / omega) < 1e-9, "{xi} {}", end + last / omega);
        assert_eq!(rolled(omega, 0.1, time, 1.0), weights(omega, 0.1, time));
    }
}
