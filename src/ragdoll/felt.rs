//! The push that acts, as a body feels it that stands over a base clip: at once where it is about to leave its soles, later where it only sways.
//! Who stands by himself, or is led, answers at once. Ground plane, SI.

use super::control::Controller;
use super::figure::Figure;
use super::flat;
use crate::maths::hull::signed_distance;
use crate::maths::pendulum::GRAVITY;
use glam::{DVec2, DVec3};

/// s, how long what a push did is not felt: people answer after 0.1 to 0.15 s.
const FELT: f64 = 0.1;
/// m at legs of 0.83 m, how far inside its soles ξ is from where on the delay begins and where it is whole. Who answers hard pushes as late
/// as light ones falls more often: 7 instead of 5 of 240 shoves of 20 to 170 N s.
const LIGHT: [f64; 2] = [0.02, 0.06];
/// Share of what is seen of a push that is taken over in a tick of 0.01 s.
const SEEN: f64 = 0.3;

impl Controller {
    /// The push that acts, from what the centre of mass did against what was commanded.
    pub(super) fn observe(&mut self, dt: f64) {
        if let Some((velocity, force)) = self.before {
            let seen = self.motion.mass * (self.motion.velocity - velocity) / dt
                + DVec3::Y * (self.motion.mass * GRAVITY)
                - force;
            self.push += SEEN * (seen - self.push);
        }
        self.unfelt += (flat(self.push) - self.unfelt / FELT) * dt;
    }

    /// m, where ξ is taken to be by who stands over a base clip: without what he has not felt yet.
    pub(super) fn feels(&self, figure: &Figure, xi: DVec2, rate: f64) -> DVec2 {
        if self.stance.is_none() || self.swing.is_some() {
            return xi;
        }
        let inside = -signed_distance(&self.bearing_hull(figure), xi) / self.size;
        let share = ((inside - LIGHT[0]) / (LIGHT[1] - LIGHT[0])).clamp(0.0, 1.0);
        xi - self.unfelt * (share / (self.motion.mass * rate))
    }
}
