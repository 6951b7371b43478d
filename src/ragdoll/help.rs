//! The help that the pelvis may be given: what the contacts lack for what is wanted, within its bounds. Scenario space, SI.

use super::control::Controller;
use super::dynamics::Wrench;
use super::forces::Wanted;
use super::joints::pelvis;
use super::linear::Factored;
use crate::maths::pendulum::GRAVITY;
use glam::{DVec2, DVec3};

impl Controller {
    /// Torque about the centre of mass and force on it that contacts lack for what is wanted, within the bounds; none in quiet.
    #[expect(clippy::too_many_arguments, reason = "one tick")]
    pub(super) fn help(
        &mut self,
        base: &Factored,
        bias: &Wrench,
        wrench: &Wrench,
        wanted: &Wanted,
        goal: DVec2,
        cop: DVec2,
        rate: f64,
    ) -> (DVec3, DVec3) {
        let bound = self.assist;
        if bound.torque <= 0.0 && bound.force <= 0.0 {
            return (DVec3::ZERO, DVec3::ZERO);
        }
        let quiet = ((self.time - self.alarmed - 0.3) / 0.4).clamp(0.0, 1.0);
        let share = 1.0 - quiet;
        if share <= 0.0 {
            return (DVec3::ZERO, DVec3::ZERO);
        }
        let lacks = wanted.angular - pelvis(base, bias, wrench, [DVec3::ZERO; 2]).angular;
        // The upper body's inertia about the pelvis turns a lack of acceleration into a torque.
        let torque = (lacks * self.upper_inertia).clamp_length_max(bound.torque * share);
        let mass = self.motion.mass;
        let beyond = (cop - goal) * (rate * mass);
        let short = wanted.linear - DVec3::new(wrench[0], wrench[1] - mass * GRAVITY, wrench[2]) / mass;
        let force = DVec3::new(beyond.x, 0.0, beyond.y) + DVec3::new(short.x, 0.0, short.z) * mass;
        let force = force.clamp_length_max(bound.force * share);
        // What is bounded is the torque at the pelvis, where the force acts: its moment about the centre of mass is part of it.
        let moment = (self.states[0].origin - self.motion.com).cross(force);
        ((torque - moment).clamp_length_max(bound.torque * share) + moment, force)
    }
}
