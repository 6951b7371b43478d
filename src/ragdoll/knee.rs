//! Legs that are almost straight: where a foot is to go does not tell what the knee is to do, so it is told by itself. Radians, SI.

use super::control::Controller;
use super::figure::{Figure, Freedom};
use super::flat;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::Side;
use glam::{DVec2, DVec3};

/// Share of its length from which on a leg that carries is unlocked, in full at its whole length: a knee at its end stays there, for no force
/// along the leg bends it, and the body goes on over it as over a stilt: it limps.
const LOCKS: f64 = 0.99;
/// The same of a walk up a slope, of a leg that carries alone: there the knee is opened faster.
const LOCKS_UPHILL: f64 = 0.98;
/// The same of the leg behind when both carry, on a foot that lies flat and on one that stands on its ball: from behind a straight leg a foot is
/// dragged along by centimetres before it lifts. The second where it is steep: from `LOCKS_UPHILL` to it goes that rise, m per m.
const LOCKS_BEHIND: [f64; 2] = [0.96, 0.965];
const RISES_BEHIND: [f64; 2] = [0.3, 0.4];
/// Shares of the leg's length from which on a sole is long enough to be dragged so, and at which it is so in full: the leg over a short one is
/// not straight for long, and unlocked it gives way (with a sole of 0.24 legs a walk up 12 degrees scores 0.84, without 0.98).
const LONG: [f64; 2] = [0.3, 0.33];
/// m per m, rises of the ground from which on that is so, and at which it is so in full: of feet that lie flat, and of a foot that stands on its
/// ball alone. Of 80 walks up 5 to 12 degrees on five bodies, feet are dragged over the ground 11 times in each otherwise, and not once so.
const RISES: [f64; 2] = [0.05, 0.17];
const RISES_ON_BALLS: [f64; 2] = [0.25, 0.5];
/// rad/s², no knee is bent or stretched harder.
const HARDEST: f64 = 300.0;

/// A leg's two bones, m, and how far its ends are apart.
struct Reach {
    bones: [f64; 2],
    away: f64,
}

impl Reach {
    fn whole(&self) -> f64 {
        self.bones[0] + self.bones[1]
    }

    /// rad, the knee's flexion where hip and ankle are so far apart.
    fn flexion(&self, length: f64) -> f64 {
        let [thigh, shank] = self.bones;
        let cos = (thigh * thigh + shank * shank - length * length) / (2.0 * thigh * shank);
        std::f64::consts::PI - real::acos(cos.clamp(-1.0, 1.0))
    }
}

impl Controller {
    fn leg(&self, figure: &Figure, side: Side) -> Reach {
        let [hip, knee, ankle] = figure.legs[side as usize];
        let bones = [figure.links[knee].anchor.length(), figure.links[ankle].anchor.length()];
        Reach { bones, away: self.states[hip].origin.distance(self.states[ankle].origin) }
    }

    /// How much of a knee's acceleration is given by itself, 0 to 1, and the acceleration: of a leg that is almost straight.
    pub(super) fn bend(&self, figure: &Figure, side: Side) -> Option<(f64, f64)> {
        let leg = self.leg(figure, side);
        let Some(swing) = self.swing else {
            return if self.behind(side) { self.unlock(figure, side, &leg) } else { None };
        };
        if swing.side != side {
            return self.unlock(figure, side, &leg);
        }
        let [hip, _, ankle] = figure.legs[side as usize];
        let [early, quicker] = if self.guided { self.knees((self.time - swing.start) / swing.time) } else { [1.0; 2] };
        let share = smooth3((leg.away / leg.whole() - self.tuning.straight) / 0.05) * early;
        if share <= 0.0 {
            return None;
        }
        let goal = if self.guided || self.on_open_ground() {
            let turns = [self.soles[side as usize].level, self.states[ankle].turn];
            self.swing_goal(figure, &swing, turns, DVec3::Y)
        } else {
            swing.reference.at + DVec3::Y * figure.ankle_height
        };
        let wanted = self.states[hip].origin.distance(goal).min(self.stretches(&swing) * leg.whole());
        Some((share, self.flexed(figure, side, &leg, (wanted, quicker))?))
    }

    /// The same of a leg that carries in a walk on level ground or up a slope, as long as the pelvis's height lets it be.
    fn unlock(&self, figure: &Figure, side: Side, leg: &Reach) -> Option<(f64, f64)> {
        let (from, most) = self.unlocks(figure, side);
        let share = smooth3((leg.away / leg.whole() - from) / (1.0 - from)) * most;
        if share <= 0.0 {
            return None;
        }
        let [hip, _, ankle] = figure.legs[side as usize];
        let (hip, ankle) = (self.states[hip].origin, self.states[ankle].origin);
        let lower = (self.states[0].origin.y - self.aimed).max(0.0);
        let wanted = (hip - DVec3::Y * lower).distance(ankle).min(from * leg.whole());
        Some((share, self.flexed(figure, side, leg, (wanted, 1.0))?))
    }

    /// Is this the foot that leaves next, of who goes on?
    fn behind(&self, side: Side) -> bool {
        let goes_on = self.guide.filter(|guide| !guide.ends && !guide.spot);
        goes_on.and_then(|guide| guide.stride).is_some_and(|(next, _, _)| next == side)
    }

    /// Share of its length from which on a leg that carries is unlocked, and how far it is so at the most, 0 to 1.
    fn unlocks(&self, figure: &Figure, side: Side) -> (f64, f64) {
        if self.on_level() {
            return (LOCKS, f64::from(self.guided));
        }
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let way = self.guide.map_or(DVec2::ZERO, |guide| guide.velocity).normalize_or_zero();
        let normal = self.soles[side as usize].level * DVec3::Y;
        let rise = -flat(normal).dot(way) / normal.y.max(0.1) * way.dot(ahead).max(0.0);
        let from = |[from, to]: [f64; 2]| smooth3((rise - from) / (to - from));
        let (balls, [lying, on_ball]) = (self.on_balls(), LOCKS_BEHIND);
        let on_ball = LOCKS_UPHILL + (on_ball - LOCKS_UPHILL) * from(RISES_BEHIND);
        let long = smooth3((figure.sole_share(side) - LONG[0]) / (LONG[1] - LONG[0]));
        match self.swing {
            None => (lying + (on_ball - lying) * balls, long * (from(RISES) * (1.0 - balls) + balls)),
            Some(_) => (LOCKS_UPHILL, from(RISES) * (1.0 - balls) + long * from(RISES_ON_BALLS) * balls),
        }
    }

    /// rad/s², the knee's acceleration towards such a length of its leg, so much quicker than usual.
    fn flexed(&self, figure: &Figure, side: Side, leg: &Reach, (wanted, quicker): (f64, f64)) -> Option<f64> {
        let [hip, knee, _] = figure.legs[side as usize];
        let Freedom::Hinge { axis, .. } = figure.links[knee].freedom else { return None };
        let speed = self.motion.relative_spin(figure, knee).dot(self.states[hip].turn * axis);
        let [stiff, damp] = self.tuning.foot;
        let asked = (leg.flexion(wanted) - leg.flexion(leg.away)) * (stiff * quicker) - speed * (damp * quicker.sqrt());
        Some(asked.clamp(-HARDEST, HARDEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_leg_has_no_flexion_and_a_leg_of_equal_bones_is_bent_by_twice_the_angle_of_its_half() {
        let leg = Reach { bones: [0.4, 0.4], away: 0.8 };
        assert!(leg.flexion(leg.whole()).abs() < 1e-6);
        let bent = leg.flexion(0.8 * real::cos(0.3));
        assert!((bent - 0.6).abs() < 1e-9, "{bent}");
    }
}
