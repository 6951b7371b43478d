//! Walking of the articulated body: feet alternate by time, each lands where the extrapolated centre of mass asks for it.
//!
//! A step runs from touchdown to touchdown: both feet bear, then one. The wanted pressure runs from foot to foot and under the
//! foot; the periodic orbit of the extrapolated centre of mass ξ that belongs to it (Hof 2008) is what ξ is held on, by the
//! pressure within the sole and by where the next foot lands. Scenario space, SI; lengths for legs of 0.83 m, scaled.

use super::control::{Controller, Swing};
use super::figure::Figure;
use super::figure::Part;
use super::gait::{Orbit, fastest, turned, weights};
use super::swing::Reference;
use crate::maths::hull::{closest_point, signed_distance};
use crate::maths::pendulum::GRAVITY;
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

pub use super::gait::{Gait, Order, Phase, WalkTuning};

impl Controller {
    /// The gait's part in a tick; false where it is not in charge.
    #[expect(clippy::too_many_arguments, reason = "one tick")]
    pub(super) fn stride(
        &mut self,
        figure: &Figure,
        terrain: &Terrain,
        pressed: [bool; 2],
        loads: [f64; 2],
        xi: DVec2,
        rate: f64,
        dt: f64,
    ) -> bool {
        let Some(order) = self.order else { return false };
        let tempo = self.size.sqrt();
        let tuning = self.gait.tuning;
        let goes = order.velocity.length() > 0.02 * tempo;
        if self.gait.phase == Phase::Rest && (!goes || self.swing.is_some() || self.shifting.is_some()) {
            return false;
        }
        let hull = self.hull(figure);
        let turn = wrap_angle(order.facing - self.heading).clamp(-tuning.turn * dt, tuning.turn * dt);
        match self.gait.phase {
            Phase::Rest => {
                if signed_distance(&hull, xi) > -0.01 * self.size {
                    return false;
                }
                self.gait = Gait { tuning, phase: Phase::Start, since: self.time, ..Gait::default() };
                self.gait.side = self.last.map_or(Side::Right, Side::other) as usize;
                self.quiet = 0.0;
            }
            Phase::Start => {}
            Phase::Caught => return self.goes_on(figure, xi, rate, &hull, goes),
            _ => {
                self.heading += turn;
                // While it turns, the way to go turns with it.
                let left = wrap_angle(order.facing - self.heading);
                let wanted = turned(order.velocity, -left).clamp_length_max(self.fastest());
                let velocity = turned(self.gait.velocity, turn);
                self.gait.velocity = velocity + (wanted - velocity).clamp_length_max(tuning.ramp * dt);
                self.gait.lacks = turned(self.gait.lacks, turn);
                self.gait.mean = turned(self.gait.mean, turn);
                let share = dt / (0.6 * tempo);
                let seen = super::flat(self.motion.velocity);
                self.gait.mean += (seen - self.gait.mean) * share;
                let lack = self.gait.velocity - self.gait.mean;
                self.gait.lacks = (self.gait.lacks + lack * (tuning.integral * dt)).clamp_length_max(0.3 * tempo);
            }
        }
        match self.gait.phase {
            Phase::Rest | Phase::Caught => false,
            Phase::Start => self.set_off(figure, loads, xi, rate, &hull, dt, goes),
            Phase::Double => self.both(figure, loads, xi, rate, &hull, dt, goes),
            Phase::Single => self.single(figure, terrain, pressed, xi, rate, &hull, dt),
        }
    }

    /// rad, rad/s, rad/s²: how arms (about x) and trunk (about y) swing against the legs.
    pub(super) fn against_legs(&self, figure: &Figure, link: usize) -> [f64; 3] {
        let tuning = &self.gait.tuning;
        if !matches!(self.gait.phase, Phase::Double | Phase::Single) {
            return [0.0; 3];
        }
        let [step, _] = self.rhythm();
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let pace = self.gait.velocity.dot(ahead) / self.size.sqrt();
        let swings = self.gait.swings();
        let most = match figure.links[link].part {
            // The arm of the side that swings is ahead at the step's start; ahead is about -x.
            Part::UpperArm(side) => -tuning.arms * pace * if side == swings { 1.0 } else { -1.0 },
            Part::Trunk => -tuning.twist * pace * swings.sign(),
            _ => return [0.0; 3],
        };
        let turn = std::f64::consts::PI / step;
        let (sin, cos) = real::sin_cos(turn * (self.time - self.gait.since).clamp(0.0, 1.2 * step));
        [most * cos, -most * turn * sin, -most * turn * turn * cos]
    }

    /// m/s, the fastest that it walks: by its legs and by how fast it falls.
    pub fn fastest(&self) -> f64 {
        fastest(self.size, self.stand_height, self.gait.tuning.fastest)
    }

    fn across(&self) -> DVec2 {
        DVec2::new(real::cos(self.heading), -real::sin(self.heading))
    }

    /// s: a whole step, and its part in which both feet bear.
    fn rhythm(&self) -> [f64; 2] {
        // A step's time is the pendulum's, which falls from the centre of mass's height; its length is the legs'.
        let tempo = (self.stand_height / 0.96).sqrt();
        let speed = self.gait.velocity.length() * tempo / self.size;
        let step = (self.gait.tuning.step[0] + self.gait.tuning.step[1] * speed) * tempo;
        [step, step * self.gait.tuning.double]
    }

    /// The orbit `passed` s after a touchdown, from which on the foot across from `swings` bears.
    fn orbit(&self, rate: f64, swings: Side, passed: f64) -> Orbit {
        let tuning = &self.gait.tuning;
        let [step, double] = self.rhythm();
        let passed = passed.clamp(0.0, step);
        let tempo = self.size.sqrt();
        let velocity = self.gait.velocity + self.gait.lacks;
        let slow = (1.0 - self.gait.velocity.length() / (0.5 * tempo)).max(0.0);
        let width = tuning.width * self.size + (self.stance_width - tuning.width * self.size).max(0.0) * slow;
        let inner = self.across() * (swings.sign() * width);
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let pace = (velocity.dot(ahead) / tempo).clamp(-0.5, 1.5);
        let roll = tuning.roll.map(|way| ahead * (way * pace * self.size));
        let way = velocity * step;
        let rear = inner - way + roll[1];
        let fade = real::exp(-rate * step);
        let [a0, a1] = weights(rate, 0.0, double);
        let [s0, s1] = weights(rate, double, step - double);
        let level = (roll[1] * (a0 + s1) + roll[0] * (a1 + s0) + way * (fade - a0)) / (1.0 - fade);
        let side = inner * ((a0 + fade) / (1.0 + fade));
        let end = way + inner + level - side;
        let (cop, xi) = if passed < double {
            let cop = rear + (roll[0] - rear) * (passed / double);
            let [a, b] = weights(rate, 0.0, double - passed);
            let [c, d] = weights(rate, double - passed, step - double);
            (cop, cop * a + roll[0] * (b + c) + roll[1] * d + end * real::exp(-rate * (step - passed)))
        } else {
            let cop = roll[0] + (roll[1] - roll[0]) * ((passed - double) / (step - double));
            let [a, b] = weights(rate, 0.0, step - passed);
            (cop, cop * a + roll[1] * b + end * real::exp(-rate * (step - passed)))
        };
        Orbit { cop, xi, stride: way + inner, rear: a0, left: step - passed }
    }

    /// Both feet bear and the weight goes over the first stance foot.
    #[expect(clippy::too_many_arguments, reason = "one tick")]
    fn set_off(
        &mut self,
        figure: &Figure,
        loads: [f64; 2],
        xi: DVec2,
        rate: f64,
        hull: &[DVec2],
        dt: f64,
        goes: bool,
    ) -> bool {
        let swings = self.gait.swings();
        let passed = self.time - self.gait.since;
        if !goes || signed_distance(hull, xi) > 0.0 || passed > 3.0 * self.size.sqrt() {
            self.gait.phase = Phase::Rest;
            return false;
        }
        let inner = self.across() * swings.sign();
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let stance = self.sole_middle(figure, swings.other());
        let [step, _] = self.rhythm();
        let near = self.stance_width / (1.0 + real::exp(rate * step));
        let goal = stance + inner * near + ahead * (0.03 * self.size);
        self.gait.goal = xi + (xi - goal) * self.gait.tuning.gain;
        let off = (xi - stance).dot(inner);
        let weight = self.motion.mass * GRAVITY * dt;
        let light = loads[swings as usize] < 0.35 * weight;
        let over = (self.gait.tuning.over * self.size).max(near + 0.01 * self.size);
        if off < over && (light || off < near + 0.005 * self.size) {
            self.gait.velocity = DVec2::ZERO;
            let [_, double] = self.rhythm();
            self.gait.since = self.time - double;
            self.lift(figure, swings);
        }
        true
    }

    fn lift(&mut self, figure: &Figure, side: Side) {
        let (ankle, yaw) = self.foot(figure, side);
        let ground = ankle - DVec3::Y * figure.ankle_height;
        let [step, _] = self.rhythm();
        let left = (step - (self.time - self.gait.since)).max(0.2 * self.size.sqrt());
        self.gait.phase = Phase::Single;
        self.swing = Some(Swing {
            side,
            start: self.time,
            time: left,
            target: self.sole_middle(figure, side),
            from: ground,
            lift: self.gait.tuning.lift * self.size,
            reference: Reference { at: ground, ..Reference::default() },
            comfort: false,
            yaw,
            free: false,
        });
    }

    /// The pressure that holds ξ on its orbit; ξ's error, and how much of it the pressure can hold.
    fn steer(&mut self, stance: DVec2, xi: DVec2, orbit: &Orbit, hull: &[DVec2]) -> (DVec2, DVec2) {
        let off = xi - stance - orbit.xi;
        let wanted = stance + orbit.cop + off * self.gait.tuning.gain;
        self.gait.goal = wanted;
        let inside = closest_point(hull, wanted).unwrap_or(wanted);
        let gives = (inside - stance - orbit.cop).clamp_length_max(off.length());
        (off, gives)
    }

    #[expect(clippy::too_many_arguments, reason = "one tick")]
    fn both(
        &mut self,
        figure: &Figure,
        loads: [f64; 2],
        xi: DVec2,
        rate: f64,
        hull: &[DVec2],
        dt: f64,
        goes: bool,
    ) -> bool {
        let swings = self.gait.swings();
        let stance = self.sole_middle(figure, swings.other());
        let passed = self.time - self.gait.since;
        let orbit = self.orbit(rate, swings, passed);
        self.steer(stance, xi, &orbit, hull);
        let weight = self.motion.mass * GRAVITY * dt;
        let borne = loads[swings.other() as usize] > 0.3 * weight;
        if !goes && self.gait.velocity.length() < 0.02 && signed_distance(hull, xi) < -0.03 * self.size {
            self.gait.phase = Phase::Rest;
            return false;
        }
        if self.time >= self.gait.ends && (borne || passed > 0.3 * self.size.sqrt()) {
            self.lift(figure, swings);
        }
        true
    }

    #[expect(clippy::too_many_arguments, reason = "one tick")]
    fn single(
        &mut self,
        figure: &Figure,
        terrain: &Terrain,
        pressed: [bool; 2],
        xi: DVec2,
        rate: f64,
        hull: &[DVec2],
        dt: f64,
    ) -> bool {
        let Some(mut swing) = self.swing else {
            self.gait.phase = Phase::Rest;
            return false;
        };
        let tuning = self.gait.tuning;
        let passed = self.time - swing.start;
        let (ankle, _) = self.foot(figure, swing.side);
        let near = (super::flat(ankle) + self.ahead(swing.yaw)).distance(swing.target) < 0.10 * self.size;
        let down = pressed[swing.side as usize];
        if down && passed > if near { 0.6 } else { 0.8 } * swing.time {
            self.swing = None;
            self.last = Some(swing.side);
            self.report.steps += 1;
            self.gait.phase = Phase::Double;
            self.gait.side = swing.side.other() as usize;
            self.gait.since = self.time;
            self.gait.ends = self.time + self.rhythm()[1];
            let stance = self.sole_middle(figure, swing.side);
            let orbit = self.orbit(rate, swing.side.other(), 0.0);
            let hull = self.hull(figure);
            let (off, _) = self.steer(stance, xi, &orbit, &hull);
            if off.length() > tuning.caught[0] * self.size {
                self.gait.phase = Phase::Caught;
                return false;
            }
            return true;
        }
        let stance = self.sole_middle(figure, swing.side.other());
        let orbit = self.orbit(rate, swing.side, self.time - self.gait.since);
        let own = orbit.left.max(0.2 * self.size.sqrt() - passed).max(0.0);
        let (off, gives) = self.steer(stance, xi, &orbit, hull);
        if passed < 0.85 * swing.time {
            let (at, left) = self.foothold(&swing, stance, &orbit, rate, off, gives, own);
            swing.target = at;
            swing.time = passed + left.max(0.02);
        }
        self.carry_on(figure, swing, terrain, down, dt);
        true
    }

    /// m, by how much corrective steps are to fall short of ξ so that it keeps its speed.
    pub(super) fn drift(&self, rate: f64) -> DVec2 {
        if self.gait.phase != Phase::Caught {
            return DVec2::ZERO;
        }
        let tempo = self.size.sqrt();
        let time = 0.28 * tempo;
        self.gait.velocity * (self.gait.tuning.keeps * time / (real::exp(rate * time) - 1.0))
    }

    /// Whether corrective steps have brought it back to where the walk can go on.
    fn goes_on(&mut self, figure: &Figure, xi: DVec2, rate: f64, hull: &[DVec2], goes: bool) -> bool {
        if self.swing.is_some() {
            return false;
        }
        if !goes || signed_distance(hull, xi) < -0.02 * self.size {
            self.gait.phase = Phase::Rest;
            return false;
        }
        let landed = self.last.unwrap_or(Side::Left);
        let stance = self.sole_middle(figure, landed);
        let orbit = self.orbit(rate, landed.other(), 0.0);
        if (xi - stance - orbit.xi).length() > self.gait.tuning.caught[1] * self.size {
            return false;
        }
        self.gait.phase = Phase::Double;
        self.gait.side = landed.other() as usize;
        self.gait.since = self.time;
        self.gait.ends = self.time + self.rhythm()[1];
        self.gait.lacks = DVec2::ZERO;
        self.gait.mean = self.gait.velocity;
        self.shifting = None;
        self.leaving = None;
        self.steer(stance, xi, &orbit, hull);
        true
    }

    /// Where the swinging foot should stand, and in how many seconds: at the gait's own time while that is near its own place,
    /// sooner when ξ runs away.
    #[expect(clippy::too_many_arguments, reason = "one plan")]
    fn foothold(
        &self,
        swing: &Swing,
        stance: DVec2,
        orbit: &Orbit,
        rate: f64,
        off: DVec2,
        gives: DVec2,
        own: f64,
    ) -> (DVec2, f64) {
        let tuning = self.gait.tuning;
        let (size, tempo) = (self.size, self.size.sqrt());
        let passed = self.time - swing.start;
        let outward = self.across() * swing.side.sign();
        let begun = self.time - self.gait.since;
        let last = self.orbit(rate, swing.side, begun + own).xi;
        let push = super::flat(self.push) * (tuning.foreseen / (self.motion.mass * rate * rate));
        let (com, velocity) = (super::flat(self.motion.com), super::flat(self.motion.velocity));
        let from = DVec2::new(swing.reference.at.x, swing.reference.at.z) + self.ahead(swing.yaw);
        let plan = |left: f64| {
            let growth = real::exp(rate * left);
            let error = gives + (off - gives) * growth + push * (growth - 1.0);
            let early = self.orbit(rate, swing.side, begun + left).xi - last;
            let wanted = orbit.stride + (early + error) * (tuning.place / (1.0 - orbit.rear));
            let mut step = wanted.clamp_length_max(tuning.span * size);
            let (sinh, cosh) = (real::sinh(rate * left), real::cosh(rate * left));
            let pivot = stance + orbit.cop + gives;
            let hip = pivot + (com - pivot) * cosh + velocity * (sinh / rate) + outward * (0.09 * size) - stance;
            step = hip + (step - hip).clamp_length_max(tuning.reach * size);
            let apart = step.dot(outward);
            if apart < tuning.clear * size {
                step += outward * (tuning.clear * size - apart);
            }
            let astray = (wanted - orbit.stride).length();
            let late = (from.distance(stance + step) - tuning.speed * tempo * left).max(0.0);
            let cost = tuning.hurry * tempo * (own - left)
                + tuning.dear[0] * (astray - tuning.astray * size).max(0.0)
                + tuning.dear[1] * (wanted.distance(step) + late);
            (cost, step, astray)
        };
        let (mut cost, mut step, astray) = plan(own);
        let mut time = own;
        if astray > tuning.astray * size {
            let mut left = (tuning.soonest * tempo - passed).max(0.06 * tempo);
            while left < own {
                let other = plan(left);
                if other.0 < cost {
                    (cost, step, _) = other;
                    time = left;
                }
                left += 0.02 * tempo;
            }
        }
        (stance + step, time)
    }
}
