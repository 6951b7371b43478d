//! Which foot of a body catches its fall, where and when: capture steps from the extrapolated centre of mass at touchdown. Ground plane, SI.
//!
//! What the body does is measured, and it goes there by its own torques (`ragdoll/`). Who is posed takes the steps of `foothold`.
//!
//! Constants are for legs of 0.83 m: lengths scale with the leg, times with its root.

use crate::maths::{pendulum, real};
use crate::model::Side;
use glam::DVec2;

/// What a step plan needs to know.
#[derive(Clone, Copy, Debug)]
pub struct Situation {
    /// m, extrapolated centre of mass, (x, z).
    pub xi: DVec2,
    /// m, where the pressure will be till touchdown, as it acts on ξ (with the push that goes on).
    pub pivot: DVec2,
    /// m, centre of mass and m/s.
    pub com: DVec2,
    /// m/s.
    pub velocity: DVec2,
    /// 1/s.
    pub rate: f64,
    /// rad, the pelvis's heading.
    pub heading: f64,
    /// m, middles of the soles (where a foot bears when all is well).
    pub feet: [DVec2; 2],
    /// Legs against 0.83 m.
    pub size: f64,
    /// The foot that stepped last.
    pub last: Option<Side>,
    /// m, by how much a step is to fall short of ξ: none where it is to stop.
    pub drift: DVec2,
    /// m/m, how the ground rises along x and z.
    pub grade: DVec2,
    /// m, the hips over it.
    pub tall: f64,
}

/// A step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Which foot.
    pub side: Side,
    /// m, the sole's middle.
    pub at: DVec2,
    /// s, the whole swing.
    pub time: f64,
    /// Lower is better.
    pub cost: f64,
}

/// Constants of stepping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTuning {
    /// s, the swings to choose from.
    pub times: [f64; 3],
    /// m, how far outside ξ a foot lands, halved by the growth of ξ.
    pub outside: f64,
    /// m, beyond ξ along the motion.
    pub along: f64,
    /// m, the least distance to the own side of the stance foot.
    pub clear: f64,
    /// m, from the hip.
    pub reach: f64,
    /// m, from the stance foot.
    pub span: f64,
    /// m/s, how fast a foot gets about.
    pub speed: f64,
    /// m/s², how fast it may have to: a step that is too far for its time takes longer.
    pub acceleration: f64,
    /// What a late landing costs, m/s.
    pub late: f64,
    /// m, what it costs to step with the same foot again.
    pub again: f64,
    /// m, what it costs to step with the left foot; under 0 with the right one.
    pub left: f64,
    /// m, beyond where it would land: outwards and ahead.
    pub nudge: [f64; 2],
}

impl Default for StepTuning {
    fn default() -> StepTuning {
        StepTuning {
            times: [0.25, 0.275, 0.30],
            outside: 0.24,
            along: 0.06,
            clear: 0.08,
            reach: 0.38,
            span: 1.0,
            speed: 4.0,
            acceleration: 70.0,
            late: 0.27,
            again: 0.074,
            left: 0.0,
            nudge: [0.0; 2],
        }
    }
}

/// The most that a least-jerk way from rest to rest accelerates, of its length over the square of its time: 10 / √3 (Flash and Hogan 1985).
const LEAST_JERK: f64 = 5.7735;

/// The best step now.
pub fn choose(situation: &Situation, tuning: &StepTuning) -> Target {
    let tempo = situation.size.max(1e-6).sqrt();
    let mut best: Option<Target> = None;
    for side in Side::BOTH {
        for time in tuning.times {
            let mut target = aim(situation, tuning, side, time * tempo, time * tempo);
            let travel = target.at.distance(situation.feet[side as usize]);
            let least = (LEAST_JERK * travel / tuning.acceleration).sqrt();
            if least > target.time {
                target = aim(situation, tuning, side, least, least);
            }
            target.cost += tuning.late * (tuning.times[2] - target.time / tempo) * situation.size;
            target.cost += if situation.last == Some(side) { tuning.again * situation.size } else { 0.0 };
            target.cost += (side.sign() * tuning.left).max(0.0) * situation.size;
            if best.is_none_or(|best| target.cost < best.cost) {
                best = Some(target);
            }
        }
    }
    best.unwrap_or(Target { side: Side::Left, at: situation.feet[0], time: 0.24 * tempo, cost: 0.0 })
}

/// Where that foot should land `left` s from now, in a swing of `time` s.
pub fn aim(situation: &Situation, tuning: &StepTuning, side: Side, time: f64, left: f64) -> Target {
    let size = situation.size;
    let touch = pendulum::carried(situation.xi, situation.pivot, situation.rate, left);
    let left_ward = DVec2::new(real::cos(situation.heading), -real::sin(situation.heading));
    let outward = left_ward * side.sign();
    let stance = situation.feet[side.other() as usize];
    let motion = situation.velocity.normalize_or_zero() * (situation.velocity.length() / 0.3).min(1.0);
    let whole = real::exp(situation.rate * time);
    let capture =
        touch - situation.drift + outward * (tuning.outside * size / (1.0 + whole)) + motion * (tuning.along * size);
    let ahead = DVec2::new(real::sin(situation.heading), real::cos(situation.heading));
    let mut at = capture + (outward * tuning.nudge[0] + ahead * tuning.nudge[1]) * size;
    // On its own side of the stance foot.
    let apart = (at - stance).dot(outward);
    if apart < tuning.clear * size {
        at += outward * (tuning.clear * size - apart);
    }
    // Within reach of the hip as it will be, and of the other foot.
    let (sinh, cosh) = (real::sinh(situation.rate * left), real::cosh(situation.rate * left));
    let hip = situation.pivot
        + (situation.com - situation.pivot) * cosh
        + situation.velocity * (sinh / situation.rate)
        + outward * (0.09 * size);
    at = hip + (at - hip).clamp_length_max(reach(situation, tuning.reach * size, at - hip));
    at = within(at, stance, tuning.span * size);
    let apart = (at - stance).dot(outward);
    if apart < tuning.clear * size {
        at += outward * (tuning.clear * size - apart);
    }
    let travel = at.distance(situation.feet[side as usize]);
    let cost = at.distance(capture) + (travel - tuning.speed * time * size.sqrt()).max(0.0);
    Target { side, at, time, cost }
}

/// m, how far from under the hip a foot lands that way that lands `level` m from it on level ground: with a leg as long, the lower the ground the
/// less. Of r² + (h - g r)² = l² + h² the positive r, g the rise that way.
fn reach(situation: &Situation, level: f64, way: DVec2) -> f64 {
    let rise = situation.grade.dot(way.normalize_or_zero());
    if rise >= 0.0 {
        return level;
    }
    let (half, square) = (situation.tall * rise, 1.0 + rise * rise);
    (half + (half * half + level * level * square).sqrt()) / square
}

fn within(point: DVec2, middle: DVec2, most: f64) -> DVec2 {
    middle + (point - middle).clamp_length_max(most)
}
