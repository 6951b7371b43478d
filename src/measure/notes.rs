//! Sentences for a person: what is to be looked at in a motion, and when. The most telling first.

use super::joints::LIMIT_TOLERANCE;
use super::score::{ANKLE_SPEED, LEGS_APART};
use super::{Findings, Scuff};

/// s of hover that a person sees: two frames of film.
const SEEN_HOVER: f64 = 0.08;
/// m at the reference leg, between the axes of shanks and feet in a swing; nearer, they touch.
const SWING_APART: f64 = 0.08;
/// mm at the reference leg: so far a foot slides before viewers notice (Prazak 2011).
const SEEN_SLIDE: f64 = 21.0;
/// m at the reference leg, half a foot's length: a stance that is farther off is seen.
const SEEN_STANCE: f64 = 0.12;

impl Findings {
    /// What a person should look at.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(time) = self.balance.fallen {
            notes.push(format!("the body has fallen at {time:.2} s"));
        }
        if self.hover.longest > SEEN_HOVER {
            let hover = &self.hover;
            notes.push(format!("neither foot is on the ground for {:.2} s from {:.2} s on", hover.longest, hover.time));
        }
        self.forces(&mut notes);
        self.ground(&mut notes);
        self.posture(&mut notes);
        notes
    }

    /// Balance and forces.
    fn forces(&self, notes: &mut Vec<String>) {
        if self.zmp.inside < 0.95 {
            notes.push(format!(
                "the zero-moment point is out of the feet in {:.0} % of the moving frames, {:.1} cm at {:.2} s",
                100.0 * (1.0 - self.zmp.inside),
                self.zmp.outside_max_cm,
                self.zmp.worst_time
            ));
        }
        if self.residual_force > 0.05 {
            let (newtons, time) = self.residual_peak.0;
            notes.push(format!("up to {newtons:.0} N come from nowhere (at {time:.2} s)"));
        }
        if self.residual_moment > 0.02 {
            let (moment, time) = self.residual_peak.1;
            notes.push(format!("up to {moment:.0} Nm come from nowhere (at {time:.2} s)"));
        }
        if self.friction_p99 > self.friction {
            notes.push(format!(
                "the feet need a friction of {:.2}, the ground has {:.2}",
                self.friction_p99, self.friction
            ));
        }
        if self.vertical_min < 0.0 {
            notes.push(format!("the ground would have to pull with {:.2} body weights", -self.vertical_min));
        }
        if self.zmp.flight > 0 && self.zmp.flight_worst > 2.0 {
            notes.push(format!("in flight the body is {:.1} m/s² off a free fall", self.zmp.flight_worst));
        }
        if let Some(gain) = self.speed.filter(|gain| gain.beyond() > 0.0) {
            let (than, bound) =
                if gain.ratio > 1.0 { ("at most", gain.within[1]) } else { ("at least", gain.within[0]) };
            notes.push(format!(
                "the push gives {:.2} of the speed that its impulse would; a body on its feet takes up {than} {bound:.2}",
                gain.ratio
            ));
        }
    }

    /// Feet on the ground.
    fn ground(&self, notes: &mut Vec<String>) {
        if self.feet.slip_max_mm > 2.0 {
            notes.push(format!("a planted foot slips {:.1} mm", self.feet.slip_max_mm));
        }
        let far = |scuff: &&(Scuff, f64)| scuff.1 > SEEN_SLIDE * self.leg_scale;
        for (scuff, slid) in self.scuffs.iter().filter(far) {
            notes.push(format!(
                "the {} foot slides {slid:.0} mm over the ground from {:.2} s on",
                scuff.side.name(),
                scuff.start
            ));
        }
        if self.feet.penetration_max_mm > 5.0 {
            notes.push(format!(
                "a sole is {:.1} mm under the ground at {:.2} s",
                self.feet.penetration_max_mm, self.feet.penetration_time
            ));
        }
        if self.feet.float_max_mm > 5.0 {
            notes.push(format!(
                "a sole that should touch is {:.1} mm over the ground at {:.2} s",
                self.feet.float_max_mm, self.feet.float_time
            ));
        }
        if self.feet.peak_ankle_speed > ANKLE_SPEED {
            notes.push(format!("an ankle moves at {:.1} m/s; people reach about 8", self.feet.peak_ankle_speed));
        }
    }

    /// Legs, the last stance, joints.
    fn posture(&self, notes: &mut Vec<String>) {
        // Thighs and shanks all the time, shanks and feet while one swings: a toe may pass nearer than a calf.
        let (swing, legs) = (&self.feet, &self.legs);
        let nearest = if swing.least_leg_distance < SWING_APART * legs.size && swing.least_leg_distance < legs.least {
            Some((swing.least_leg_distance, swing.least_leg_time))
        } else {
            Some((legs.least, legs.time)).filter(|(least, _)| *least < LEGS_APART * legs.size)
        };
        if let Some((least, time)) = nearest {
            notes.push(format!("the legs come within {:.0} mm of each other at {time:.2} s", 1000.0 * least));
        }
        if let Some(end) = self.end_stance.filter(|end| end.off > SEEN_STANCE * self.leg_scale) {
            let crossed = if end.apart.x < 0.0 { ", crossed" } else { "" };
            notes.push(format!("it ends with the feet {:.0} cm from side by side{crossed}", 100.0 * end.off));
        }
        if self.joints.knee_past_straight > LIMIT_TOLERANCE {
            notes
                .push(format!("a knee bends {:.1} degrees past straight", self.joints.knee_past_straight.to_degrees()));
        }
        for excess in &self.joints.excesses {
            notes.push(format!(
                "{} {} is {:.0} degrees at {:.2} s, {:.0} past its limit",
                excess.angle.role.name(),
                excess.angle.axis,
                excess.angle.value.to_degrees(),
                excess.time,
                excess.by.to_degrees()
            ));
        }
        for pop in &self.joints.pops {
            notes.push(format!(
                "{} pops by {:.0} degrees at {:.2} s",
                pop.role.name(),
                pop.step.to_degrees(),
                pop.time
            ));
        }
    }
}
