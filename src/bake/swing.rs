//! A step with its roll: when the heel comes up, how the foot pitches on its way, how it passes the other one. Times in s.
//!
//! Ground frame, metres, radians. Pitch is positive with the heel up.

use super::clearance::Raise;
use crate::maths::curve::{bump, sample, smooth3, smooth5, trapezoid};
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::stepper::{Physique, Plant, Step, StepKind};
use glam::DVec3;

/// rad/s, mean speed at which a heel comes up (a smaller body's too, frames being what they are): faster, and toes and
/// ankle snap.
const FASTEST_ROLL: f64 = 1.05;
/// rad/s, likewise of a walker's, whose heel comes up over ten frames.
const FASTEST_STRIDE: f64 = 3.6;
/// s, in which a foot that is to be held goes up, and comes down.
const HELD: f64 = 0.55;
/// Part of the leg, how high.
const HELD_HEIGHT: f64 = 0.13;
/// s, by how much a heel that lands after its ball begins to come down before the ball lands.
const LEAD: f64 = 0.05;
/// s, the same of the toes of a walker that lands on its heel: its pitch takes five frames or more.
const HEEL_LEAD: f64 = 0.04;
/// Part of a walker's stance until the foot is flat: 8 to 12 % of the cycle.
const SETTLES: f64 = 0.183;
/// Part of the leg, how far from the stance foot a foot that crosses before it must pass.
const PASSES_BY: f64 = 0.10;

/// A step with its roll. Times in s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Swing {
    pub(super) planned: f64, // s, the lift that the step has
    pub(super) lift: f64,
    pub(super) land: f64,
    pub(super) heel_off: f64, // how long before `lift` the heel comes up
    pub(super) settle: f64,   // how long after `land` the foot is flat
    pub(super) peak_after: f64,
    pub(super) peak: f64,    // rad, largest pitch, a little after lift
    pub(super) strike: f64,  // rad, pitch at landing: below 0 heel first, over 0 ball first
    pub(super) walks: bool,  // one of the gait
    pub(super) held: f64,    // s, up and again down of a foot that is held up between; 0 for a step
    pub(super) onward: bool, // it goes forwards: the weight is on the ball before it leaves
    pub(super) clearance: f64,
    pub(super) aside: DVec3, // horizontal detour at mid-swing, m
    pub(super) from: Plant,
    pub(super) to: Plant,
    pub(super) raise: Raise, // what the ground between asks for
}

/// What the ankle's range asks of a foot beside its curve: series of pitch and of roll (about the foot's length), rad.
#[derive(Clone, Debug, Default)]
pub(super) struct Extra {
    pub(super) dt: f64,
    pub(super) turns: [Vec<f64>; 2],
}

impl Extra {
    /// Pitch and roll at a time.
    pub(super) fn at(&self, time: f64) -> [f64; 2] {
        if self.dt <= 0.0 { [0.0; 2] } else { [0, 1].map(|axis| sample(&self.turns[axis], self.dt, time)) }
    }
}

impl Swing {
    /// Chooses the roll of a step: `room` bounds the time of the heel's rise, `after` is the foot's next lift, `other` the stance foot.
    pub(super) fn new(step: &Step, room: f64, after: f64, other: &Plant, physique: &Physique, scale: f64) -> Swing {
        let travel = step.to.ankle - step.from.ankle;
        let yaw = 0.5 * (step.from.yaw + step.to.yaw);
        let leg = physique.leg_length;
        let forward = (travel.x * real::sin(yaw) + travel.z * real::cos(yaw)) / leg;
        let distance = travel.length() / leg;
        let calm = step.kind == StepKind::Comfort;
        let duration = step.land - step.lift;
        // Forwards the foot rolls off its toes; sideways and back it is picked up.
        let peak =
            if calm { 14.0 } else { 12.0 + 40.0 * forward.clamp(0.0, 0.8) + 8.0 * (distance - forward.abs()).max(0.0) };
        // A foot that is to go back has the weight on its heel: it is picked up flat.
        let backward = (-forward / 0.15).clamp(0.0, 1.0);
        let peak = peak + (9.0 - peak) * backward;
        let heel_off = (1.0 - 0.35 * backward)
            * ((if calm { 0.15 } else { 0.13 + 0.05 * forward.clamp(0.0, 1.0) }) * scale).min(room);
        let peak_after = (0.085 * scale).min(0.3 * duration);
        // A walker rolls over the ball long before the foot leaves, and far.
        let walks = step.kind == StepKind::Walk && forward > 0.25;
        let (peak, heel_off, peak_after, fastest) = if walks {
            (28.0 + 22.0 * forward.min(1.5), (0.42 * scale).min(1.8 * room), 0.04 * scale, FASTEST_STRIDE)
        } else {
            (peak, heel_off, peak_after, FASTEST_ROLL)
        };
        // Toes that point up as on level ground are less far from ground that rises.
        let ahead = DVec3::new(real::sin(yaw), 0.0, real::cos(yaw));
        let rises = real::atan2(-step.to.normal.dot(ahead), step.to.normal.y).max(0.0).to_degrees();
        let strike = if forward > 0.12 {
            -((30.0 * (forward - 0.05)).min(if walks { 20.0 } else { 18.0 }) - rises).max(0.0)
        } else if forward < -0.10 {
            (40.0 * (-forward - 0.05)).min(12.0)
        } else {
            0.0
        };
        // Flat again two or three frames after landing; from the ball a little later.
        let settle = if strike > 0.0 {
            0.15
        } else if walks {
            (SETTLES * (after - step.land) / scale).clamp(0.09, 0.19)
        } else {
            0.085
        };
        let settle = (settle * scale).min(0.35 * (after - step.land).max(0.0));
        Swing {
            planned: step.lift,
            lift: step.lift,
            land: step.land,
            heel_off,
            settle,
            peak_after,
            walks,
            held: if step.kind == StepKind::Held { (HELD * scale).min(0.5 * duration) } else { 0.0 },
            onward: forward > 0.1,
            peak: peak.to_radians().min(fastest / scale.max(1.0) * (heel_off + peak_after)),
            strike: strike.to_radians(),
            clearance: if step.kind == StepKind::Held {
                HELD_HEIGHT * leg
            } else {
                leg * (0.045 + 0.05 * distance.min(1.0))
            },
            aside: detour(step, other, physique),
            from: step.from,
            to: step.to,
            raise: Raise::NONE,
        }
    }

    /// How far along its way it is, 0..1; a foot that is held up waits at the half.
    pub(super) fn along(&self, time: f64) -> f64 {
        if self.held <= 0.0 {
            return (time - self.lift) / (self.land - self.lift);
        }
        let (up, down) = ((time - self.lift) / self.held, (self.land - time) / self.held);
        if up < 1.0 {
            0.5 * smooth3(up)
        } else if down < 1.0 {
            1.0 - 0.5 * smooth3(down)
        } else {
            0.5
        }
    }

    /// Pitch that the heel's rise alone gives.
    fn rise(&self, time: f64) -> f64 {
        let share = (time - self.lift + self.heel_off) / (self.heel_off + self.peak_after);
        // A walker's heel comes away sooner: its shank leans on all the while.
        self.peak * if self.walks { 0.5 * (smooth3(share) + smooth5(share)) } else { smooth5(share) }
    }

    /// s, when the foot begins to come down to flat: a little before it lands.
    fn settles_from(&self) -> f64 {
        let lead = if self.strike > 0.0 {
            LEAD
        } else if self.strike < 0.0 && self.walks {
            HEEL_LEAD
        } else {
            0.0
        };
        self.land - lead.min(0.25 * (self.land - self.lift - self.peak_after)).max(0.0)
    }

    /// rad, the pitch about the heel with which a heel-first landing is flown to.
    pub(super) fn landing_pitch(&self, time: f64) -> f64 {
        if time > self.settles_from() { self.pitch(time) } else { self.strike }
    }

    /// Pitch at a time between heel off and flat.
    pub(super) fn pitch(&self, time: f64) -> f64 {
        let (start, top) = (self.lift - self.heel_off, self.lift + self.peak_after);
        if time <= start {
            0.0
        } else if time <= top && (self.strike <= self.peak || time <= self.lift) {
            self.rise(time)
        } else {
            let turn = self.settles_from();
            if time <= turn {
                let more = self.strike - self.peak;
                if more > 0.0 {
                    // A heel that lands higher than it left rises all the way.
                    self.rise(time) + more * smooth3((time - self.lift) / (turn - self.lift))
                } else {
                    self.peak + more * smooth5((time - top) / (turn - top))
                }
            } else {
                self.strike * (1.0 - smooth3((time - turn) / (self.land - turn + self.settle).max(1e-9)))
            }
        }
    }
}

/// How far the path bends away from a stance foot that stands near it: at least 0.14 leg lengths of gap, m.
fn detour(step: &Step, other: &Plant, physique: &Physique) -> DVec3 {
    let (from, to) = (step.from.ankle, step.to.ankle);
    let path = DVec3::new(to.x - from.x, 0.0, to.z - from.z);
    let length = path.length();
    if length < 1e-6 {
        return DVec3::ZERO;
    }
    let along = path / length;
    let across = DVec3::new(along.z, 0.0, -along.x);
    let rel = other.ankle - from;
    let u = rel.dot(along) / length;
    if !(0.1..=0.9).contains(&u) {
        return DVec3::ZERO;
    }
    let gap = -rel.dot(across); // where the path lies from the stance foot, along `across`
    // A foot that passes ahead of the other (or behind it) must clear its length, not its width alone.
    let lengthwise = across.dot(DVec3::new(real::sin(other.yaw), 0.0, real::cos(other.yaw))).abs();
    let least = (0.15 * physique.leg_length).max(0.14 * physique.leg_length + physique.tip * lengthwise);
    // Keep to the side of the stance foot where the swing foot belongs.
    let own = step.side.sign() * across.dot(DVec3::new(real::cos(other.yaw), 0.0, -real::sin(other.yaw))).signum();
    // In a turn the straight way cuts across the stance foot though it begins and ends on its own side: go round.
    let on_own_side = |plant: &Plant| {
        let apart = plant.ankle - other.ankle;
        step.side.sign() * (apart.x * real::cos(plant.yaw) - apart.z * real::sin(plant.yaw)) > 0.0
    };
    let turns = wrap_angle(step.to.yaw - step.from.yaw).abs() > 0.15;
    let mut round = turns && on_own_side(&step.from) && on_own_side(&step.to);
    let bent = |sign: f64| {
        let missing = least - gap * sign;
        if missing > 0.0 { across * (sign * missing / bump(u).max(0.3)) } else { DVec3::ZERO }
    };
    if step.kind == StepKind::Walk && on_own_side(&step.from) && !on_own_side(&step.to) {
        // Who is shoved across in mid-stride comes past the stance leg first, where there is room before its toes.
        let toe = DVec3::new(real::sin(other.yaw), 0.0, real::cos(other.yaw));
        let [behind, before] = [from, to].map(|ankle| (ankle - other.ankle).dot(toe));
        let near = |share: f64| {
            let at = from + path * trapezoid(share) + bent(own) * bump(share) - other.ankle;
            (at - toe * at.dot(toe).clamp(physique.heel, physique.tip)).with_y(0.0).length()
        };
        let clear = (1..20).map(|piece| near(f64::from(piece) / 20.0)).fold(f64::INFINITY, f64::min);
        round |= behind * before < 0.0 && clear > PASSES_BY * physique.leg_length;
    }
    let sign = if gap.abs() > 0.02 * physique.leg_length && !round { gap.signum() } else { own };
    bent(sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Side;

    #[test]
    fn a_stride_that_is_shoved_across_comes_past_the_stance_leg_on_its_own_side() {
        let physique = Physique::REFERENCE;
        let at = |x: f64, z: f64| Plant::level(DVec3::new(x, 0.0, z), 0.0);
        let stance = at(-0.02, 0.0);
        let step = |side: Side, sign: f64| Step {
            kind: StepKind::Walk,
            side,
            lift: 0.0,
            land: 0.4,
            from: at(-0.02 + 0.11 * sign, -0.68),
            to: at(-0.02 - 0.30 * sign, 0.65),
        };
        for side in Side::BOTH {
            let sign = side.sign();
            let walk = step(side, sign);
            let amid = 0.5 * (walk.from.ankle + walk.to.ankle) + detour(&walk, &stance, &physique);
            let beside = (amid.x - stance.ankle.x) * sign;
            assert!(beside > 0.12 * physique.leg_length, "{side:?}: beside the stance leg by {beside} m");
            let aimed = Step { to: at(-0.02 + 0.11 * sign, 0.65), ..walk };
            assert!(detour(&aimed, &stance, &physique).length() < 0.02, "{side:?}: a plain stride goes straight");
        }
    }
}
