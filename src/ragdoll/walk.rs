//! Walking of the articulated body: feet alternate by time, each lands where the extrapolated centre of mass asks for it.
//!
//! A step runs from touchdown to touchdown: both feet bear, then one. The wanted pressure runs from foot to foot and under the
//! foot; the periodic orbit of the extrapolated centre of mass ξ that belongs to it (Hof 2008) is what ξ is held on, by the
//! pressure within the sole and by where the next foot lands. Scenario space, SI; lengths for legs of 0.83 m, scaled.

use super::control::{Controller, Swing};
use super::figure::Figure;
use super::figure::Part;
use super::swing::Reference;
use crate::maths::hull::{closest_point, signed_distance};
use crate::maths::pendulum::GRAVITY;
use crate::maths::quat::wrap_angle;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

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
            arms: 0.4,
            twist: 0.08,
            yaw: 3.0,
            rise: 0.05,
            astray: 0.2,
            soonest: 0.22,
            speed: 4.0,
            hurry: 0.5,
            dear: [0.5, 2.0],
            reach: 0.5,
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

/// What the gait remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gait {
    /// Its constants.
    pub tuning: WalkTuning,
    phase: Phase,
    velocity: DVec2,
    side: usize, // that swings, or will next
    since: f64,  // the last touchdown, or the start
    goal: DVec2,
    ends: f64, // when both feet bear no more
    hurries: bool,
    lacks: DVec2,
    mean: DVec2,
}

/// The steady gait beside the stance sole's middle, at an instant.
struct Orbit {
    cop: DVec2,
    xi: DVec2,
    stride: DVec2,
    rear: f64,
    left: f64,
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

    /// Whether the swing is not the gait's own, but one that catches the body.
    pub(super) fn hurries(&self) -> bool {
        self.hurries
    }

    fn swings(&self) -> Side {
        Side::BOTH[self.side]
    }
}

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
                let wanted = turned(order.velocity, -left).clamp_length_max(tuning.fastest * tempo);
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
        let ahead = DVec2::new(self.heading.sin(), self.heading.cos());
        let pace = self.gait.velocity.dot(ahead) / self.size.sqrt();
        let swings = self.gait.swings();
        let most = match figure.links[link].part {
            // The arm of the side that swings is ahead at the step's start; ahead is about -x.
            Part::UpperArm(side) => -tuning.arms * pace * if side == swings { 1.0 } else { -1.0 },
            Part::Trunk => -tuning.twist * pace * swings.sign(),
            _ => return [0.0; 3],
        };
        let turn = std::f64::consts::PI / step;
        let (sin, cos) = (turn * (self.time - self.gait.since).clamp(0.0, 1.2 * step)).sin_cos();
        [most * cos, -most * turn * sin, -most * turn * turn * cos]
    }

    fn across(&self) -> DVec2 {
        DVec2::new(self.heading.cos(), -self.heading.sin())
    }

    /// s: a whole step, and its part in which both feet bear.
    fn rhythm(&self) -> [f64; 2] {
        let tempo = self.size.sqrt();
        let speed = self.gait.velocity.length() / tempo;
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
        let ahead = DVec2::new(self.heading.sin(), self.heading.cos());
        let pace = (velocity.dot(ahead) / tempo).clamp(-0.5, 1.5);
        let roll = tuning.roll.map(|way| ahead * (way * pace * self.size));
        let way = velocity * step;
        let rear = inner - way + roll[1];
        let fade = (-rate * step).exp();
        let [a0, a1] = weights(rate, 0.0, double);
        let [s0, s1] = weights(rate, double, step - double);
        let level = (roll[1] * (a0 + s1) + roll[0] * (a1 + s0) + way * (fade - a0)) / (1.0 - fade);
        let side = inner * ((a0 + fade) / (1.0 + fade));
        let end = way + inner + level - side;
        let (cop, xi) = if passed < double {
            let cop = rear + (roll[0] - rear) * (passed / double);
            let [a, b] = weights(rate, 0.0, double - passed);
            let [c, d] = weights(rate, double - passed, step - double);
            (cop, cop * a + roll[0] * (b + c) + roll[1] * d + end * (-rate * (step - passed)).exp())
        } else {
            let cop = roll[0] + (roll[1] - roll[0]) * ((passed - double) / (step - double));
            let [a, b] = weights(rate, 0.0, step - passed);
            (cop, cop * a + roll[1] * b + end * (-rate * (step - passed)).exp())
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
        let ahead = DVec2::new(self.heading.sin(), self.heading.cos());
        let stance = self.sole_middle(figure, swings.other());
        let [step, _] = self.rhythm();
        let near = self.stance_width / (1.0 + (rate * step).exp());
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
            let (at, left) = self.foothold(figure, &swing, stance, &orbit, rate, off, gives, own);
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
        self.gait.velocity * (self.gait.tuning.keeps * time / ((rate * time).exp() - 1.0))
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
        &mut self,
        figure: &Figure,
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
            let growth = (rate * left).exp();
            let error = gives + (off - gives) * growth + push * (growth - 1.0);
            let early = self.orbit(rate, swing.side, begun + left).xi - last;
            let wanted = orbit.stride + (early + error) * (tuning.place / (1.0 - orbit.rear));
            let mut step = wanted.clamp_length_max(tuning.span * size);
            let (sinh, cosh) = ((rate * left).sinh(), (rate * left).cosh());
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
        let hurries = astray > tuning.astray * size;
        if hurries {
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
        self.gait.hurries = hurries;
        (stance + step, time)
    }
}

/// A ground vector (x, z) turned by a yaw.
fn turned(vector: DVec2, yaw: f64) -> DVec2 {
    let (sin, cos) = yaw.sin_cos();
    DVec2::new(vector.x * cos + vector.y * sin, vector.y * cos - vector.x * sin)
}

/// What a straight run of the pressure of `time` s, that starts `after` s from now, counts in ξ: of its two ends.
fn weights(rate: f64, after: f64, time: f64) -> [f64; 2] {
    let (one, two) = ((-rate * after).exp(), (-rate * (after + time)).exp());
    if rate * time < 1e-9 {
        return [0.0, 0.0];
    }
    let mean = (one - two) / (rate * time);
    [one - mean, mean - two]
}
