//! When a foot leaves the ground, where it goes and when it stands again: corrective steps and unhurried ones. Scenario space, SI.

use super::control::{Controller, Swing, slant};
use super::figure::Figure;
use super::flat;
use super::kerb;
use super::reach::OVER;
use super::swing::{self, Reference};
use super::tuning::Tuning;
use crate::maths::hull::{closest_point, convex_hull, shrink, signed_distance};
use crate::maths::pendulum::GRAVITY;
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::{Side, Terrain};
use crate::stepper::catch::{self, Situation};
use glam::{DQuat, DVec2, DVec3};

/// s, for how long after an unhurried step only what leaves the soles is a fall: the time to take weight on the foot that landed.
pub(super) const EASED: f64 = 0.5;
/// m at legs of 0.83 m: feet that are farther from standing beside each other are set so.
const BESIDE: f64 = 0.09;
/// m at legs of 0.83 m, how far a foot that a wide landing brings along goes towards a stance that is not side by side; s at such legs, how
/// long it takes; share of what who stands wide is spared of the wait for his weight.
const FARTHEST: f64 = 0.25;
const QUICK: f64 = 0.36;
const SHIFTS: f64 = 0.5;
/// m at legs of 0.83 m, that soles keep from edges in steps against a fall.
const EDGE: f64 = 0.01;
/// Ticks for which a foot waits for the other one to bear: who falls away from that one waits in vain. And on treads, where a foot that lands
/// takes longer to bear: of 80 who are shoved amid flights up 5 fall with 3 and 4 with 12.
const WAITS: [usize; 2] = [3, 12];
/// s at legs of 0.83 m, in which a foot that has landed takes weight: it does not leave sooner for the next step against a fall. A foot that
/// only grazes the ground would be lifted again and again, and the body falls over it. Of 256 who are shoved by 150 to 200 Ns 93.4 % stand
/// without it and 94.9 % with 0.05, 0.1 or 0.2.
const TAKES_WEIGHT: f64 = 0.1;
/// Share of a step against a fall at which its foot is over its place.
const ARRIVES: f64 = 0.95;
/// Upward part of a normal at least: ground that is steeper holds no foot.
const STEEP: f64 = 0.5;
/// m at legs of 0.83 m, by which who stands on steep ground lets balance go farther out before he steps, and the upward part of the ground's
/// normal where that begins and where it is all: 26 and 41 degrees. A step downhill finds no ground there, and a platform comes back: of 30 drawn
/// minutes on platforms that lean to 45 degrees, shoved, 13 end in a fall without it and 7 with it.
const BIDES: f64 = 0.02;
const LEANS: [f64; 2] = [0.9, 0.75];

impl Controller {
    /// s since it last stepped against a fall or was about to.
    pub fn at_ease(&self) -> f64 {
        self.time - self.fought
    }

    /// Times of a body with legs of 0.83 m are so many times as long for this one.
    pub fn tempo(&self) -> f64 {
        self.size.sqrt()
    }

    /// The dials of steps against a fall.
    pub(super) fn against_a_fall(&self) -> Tuning {
        if self.going == DVec2::ZERO { self.tuning.standing() } else { self.tuning }
    }

    /// m, around the soles of the feet that stand, (x, z).
    pub(super) fn hull(&self, figure: &Figure) -> Vec<DVec2> {
        self.hull_of(figure, OVER)
    }

    /// m, around what of them can bear, (x, z).
    pub(super) fn bearing_hull(&self, figure: &Figure) -> Vec<DVec2> {
        self.hull_of(figure, self.tuning.lifted[0] * self.size)
    }

    fn hull_of(&self, figure: &Figure, most: f64) -> Vec<DVec2> {
        let mut points = Vec::with_capacity(8);
        for side in Side::BOTH {
            if self.swing.is_none_or(|swing| swing.side != side) {
                let corners = self.bearing_points(figure, side).into_iter().zip(self.soles[side as usize].lifted);
                points.extend(corners.filter(|(_, lifted)| *lifted < most).map(|(corner, _)| flat(corner)));
            }
        }
        convex_hull(&points)
    }

    pub(super) fn situation(&self, figure: &Figure, terrain: &Terrain, xi: DVec2, rate: f64, cop: DVec2) -> Situation {
        let ground = terrain.spot(cop);
        let push = flat(self.push) * self.against_a_fall().foreseen / (self.motion.mass * rate * rate);
        Situation {
            xi,
            pivot: cop - push,
            com: flat(self.motion.com),
            velocity: flat(self.motion.velocity),
            rate,
            heading: self.heading,
            feet: Side::BOTH.map(|side| self.sole_middle(figure, side)),
            size: self.size,
            last: self.last,
            drift: self.drift(rate),
            grade: -flat(ground.normal) / ground.normal.y.max(STEEP),
            tall: self.states[0].origin.y - ground.height,
        }
    }

    /// Lands, aims and starts swings.
    #[expect(clippy::too_many_arguments, reason = "one tick")]
    pub(super) fn step(
        &mut self,
        figure: &Figure,
        terrain: &Terrain,
        pressed: [bool; 2],
        loads: [f64; 2],
        xi: DVec2,
        rate: f64,
        dt: f64,
    ) {
        if self.led(figure, terrain, pressed, dt) {
            return;
        }
        if let Some(swing) = self.swing {
            self.land(figure, terrain, swing, pressed[swing.side as usize], (xi, rate), dt);
        }
        if self.swing.is_some() {
            return;
        }
        let hull = self.hull(figure);
        let falls = if self.projected { flat(self.motion.com) } else { xi };
        let out = signed_distance(&shrink(&hull, self.tuning.shrunk * self.size), falls);
        // Who has just set a foot beside the other has balance over that other foot, near its edge as in the swing.
        let eased = self.time - self.eased < EASED * self.tempo() || self.sways(figure);
        let trigger = if eased { self.tuning.shrunk } else { self.against_a_fall().trigger };
        let upright = terrain.spot(flat(self.motion.com)).normal.y;
        let trigger = trigger + BIDES * ((LEANS[0] - upright) / (LEANS[0] - LEANS[1])).clamp(0.0, 1.0);
        if out > trigger * self.size {
            let cop = closest_point(&hull, xi).unwrap_or(xi);
            let situation = self.situation(figure, terrain, xi, rate, cop);
            self.step_off(figure, &situation, loads, dt);
        } else {
            self.leaving = None;
            // Who stands as given is brought there (`sim::homeward`), but for the foot that a wide landing brings along.
            if self.stance.is_none() || self.shifting.is_some() {
                self.comfort(figure, loads, xi, out, dt);
            }
        }
    }

    /// Ends a swing whose foot is `down` when it may be, or takes it on towards where the body falls.
    fn land(
        &mut self,
        figure: &Figure,
        terrain: &Terrain,
        mut swing: Swing,
        down: bool,
        (xi, rate): (DVec2, f64),
        dt: f64,
    ) {
        let passed = self.time - swing.start;
        let (ankle, _) = self.foot(figure, swing.side);
        let near = (flat(ankle) - self.slants[swing.side as usize] + self.ahead(swing.side, swing.yaw))
            .distance(swing.target)
            < 0.10 * self.size;
        if down && passed > if near { 0.5 } else { 0.7 } * swing.time {
            self.swing = None;
            self.last = Some(swing.side);
            self.landed = self.time;
            if swing.comfort {
                self.eased = self.time;
            }
            self.report.steps += 1;
            // Who lands wide goes on over the foot that landed and brings the other along.
            let apart = self.sole_middle(figure, Side::Left).distance(self.sole_middle(figure, Side::Right));
            let wide = self.stance.as_ref().map_or(0.0, |stance| stance.apart.length() + 0.1 * self.size);
            if apart > wide.max(self.tuning.wide * self.size) {
                self.shifting = Some((swing.side.other(), self.time - self.tuning.onwards * self.size.sqrt()));
            }
            return;
        }
        let left = (swing.time - passed).max(0.0);
        let hull = self.hull(figure);
        if swing.comfort && signed_distance(&hull, xi) > 0.03 * self.size {
            swing.comfort = false;
        }
        if !swing.comfort && passed < 0.85 * swing.time {
            let cop = closest_point(&hull, xi).unwrap_or(xi);
            let situation = self.situation(figure, terrain, xi, rate, cop);
            swing.target = catch::aim(&situation, &self.against_a_fall().step, swing.side, swing.time, left).at;
        }
        self.carry_on(figure, swing, terrain, down, dt);
    }

    /// Begins a step against a fall, as soon as its foot may leave.
    fn step_off(&mut self, figure: &Figure, situation: &Situation, loads: [f64; 2], dt: f64) {
        let target = catch::choose(situation, &self.against_a_fall().step);
        if self.last == Some(target.side) && self.time - self.landed < TAKES_WEIGHT * self.tempo() {
            self.leaving = None;
            return;
        }
        // A foot leaves when the other bears.
        let weight = self.motion.mass * GRAVITY * dt;
        let waited = self.leaving.map_or(0, |(_, ticks)| ticks);
        let most = WAITS[usize::from(self.stairs)];
        if loads[target.side.other() as usize] < self.tuning.borne * weight && waited < most {
            self.leaving = Some((target.side, waited + 1));
            return;
        }
        self.leaving = None;
        self.shifting = None;
        let (ankle, yaw) = self.foot(figure, target.side);
        let ground = ankle - DVec3::Y * figure.ankle_height;
        let travel = target.at.distance(situation.feet[target.side as usize]);
        self.swing = Some(Swing {
            side: target.side,
            start: self.time,
            time: target.time,
            target: target.at,
            from: ground,
            lift: self.tuning.lift[0] * self.size + self.tuning.lift[1] * (travel - 0.4 * self.size).max(0.0),
            reference: Reference { at: ground, ..Reference::default() },
            comfort: false,
            yaw,
            spin: 0.0,
            free: false,
        });
    }

    /// m, the place nearest to that one, along z, where a foot's sole is off the edges of the ground.
    fn off_edges(&self, figure: &Figure, terrain: &Terrain, side: Side, ankle: DVec2, yaw: f64) -> DVec2 {
        let turn = DQuat::from_rotation_y(yaw);
        let span = figure.soles[side as usize].iter().map(|corner| (turn * *corner).z);
        let [rear, front] = span.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
        let middle = ankle + DVec2::Y * (0.5 * (rear + front));
        let Some([from, to]) = terrain.floor_at(middle) else { return ankle };
        let (low, high) = (from - rear + EDGE * self.size, to - front - EDGE * self.size);
        DVec2::new(ankle.x, if low <= high { ankle.y.clamp(low, high) } else { 0.5 * (low + high) })
    }

    /// One tick more of a swing's reference, towards its target.
    pub(super) fn carry_on(&mut self, figure: &Figure, mut swing: Swing, terrain: &Terrain, down: bool, dt: f64) {
        let passed = self.time - swing.start;
        let left = (swing.time - passed).max(0.0);
        let turns = wrap_angle(self.foot_heading(swing.side) - swing.yaw) * (dt / (left + dt)).min(1.0);
        swing.yaw += turns;
        swing.spin = if self.guide.is_some_and(|guide| guide.spot) { turns / dt } else { 0.0 };
        let stands = swing.target - self.ahead(swing.side, swing.yaw);
        let stands = if self.guided || !terrain.has_edges() {
            stands
        } else {
            self.off_edges(figure, terrain, swing.side, stands, swing.yaw)
        };
        let goal = stands + slant(figure, &self.lies(figure, terrain, swing.side, stands, swing.yaw));
        // Off the ground before it travels.
        let ground = self.under_sole(figure, terrain, swing.side, stands, swing.yaw);
        let usual = if self.guided { self.travels() } else { [self.tuning.rise, ARRIVES] };
        let way = self.over_kerb(figure, terrain, &swing, (stands, ground));
        let [rise, arrives] = way.filter(|_| self.guided).map_or(usual, |way| way.travels);
        if !down && !self.guided || passed > rise * swing.time {
            swing.free = true;
        }
        if swing.free {
            let left = (arrives * swing.time - passed).max(0.02);
            let goal = goal + self.around(figure, &swing, goal);
            swing.reference = swing::onwards(&swing.reference, goal, left, dt);
        }
        let x = (passed + dt) / (swing::LANDS * swing.time);
        let base = swing.from.y + (ground - swing.from.y) * x.clamp(0.0, 1.0);
        let speed = 1.0 / (swing::LANDS * swing.time);
        let [y, v, a] = if self.guided || way.is_some() {
            let (top, highest) = way.map_or_else(
                || (base + swing.lift + kerb::crest(terrain, &swing, (stands, ground)), swing::HIGHEST),
                |way| (base.max(way.over) + way.lift, way.highest),
            );
            swing::over(&swing.reference, [top, ground], self.tempo(), (passed, swing.time, highest), dt)
        } else if x < 1.0 {
            let [l, d, a] = swing::lift(x);
            [base + swing.lift * l, swing.lift * d * speed, swing.lift * a * speed * speed]
        } else {
            swing::down(&swing.reference, dt)
        };
        swing.reference.at.y = y;
        swing.reference.velocity.y = v;
        swing.reference.acceleration.y = a;
        self.swing = Some(swing);
    }

    /// m, (x, z): so far beside its goal a swinging foot is aimed for its leg to pass the one that stands; on ground without treads, and not of
    /// feet that stand on their balls, for with it legs of 1.08 m walk up 19 degrees at two thirds of their speed.
    fn around(&self, figure: &Figure, swing: &Swing, goal: DVec2) -> DVec2 {
        if self.treads || self.on_balls() > 0.0 {
            return DVec2::ZERO;
        }
        let stance = swing.side.other();
        let stands = flat(self.foot(figure, stance).0) - self.slants[stance as usize];
        let out = DVec2::new(real::cos(self.heading), -real::sin(self.heading)) * swing.side.sign();
        out * swing::aside([flat(swing.reference.at), goal], stands, out, self.size)
    }

    /// Feet that do not stand side by side are set so, one after the other, once all is quiet.
    pub(super) fn comfort(&mut self, figure: &Figure, loads: [f64; 2], xi: DVec2, out: f64, dt: f64) {
        let tempo = self.size.sqrt();
        let still = self.motion.velocity.length() < 0.12 * tempo && out < -0.01 * self.size;
        self.quiet = if still { self.quiet + dt } else { 0.0 };
        let feet = Side::BOTH.map(|side| self.sole_middle(figure, side));
        let across = DVec2::new(real::cos(self.heading), -real::sin(self.heading));
        // Where a foot would stand beside the other.
        let beside = |side: Side| {
            let to = self.stance.as_ref().map_or(across * self.stance_width, |stance| stance.apart_at(self.heading));
            let at = feet[side.other() as usize] + to * side.sign();
            match self.stance {
                // Far steps are taken in several: the weight has to come over the foot that landed before the next one.
                Some(_) => feet[side as usize] + (at - feet[side as usize]).clamp_length_max(FARTHEST * self.size),
                None => at,
            }
        };
        if let Some((side, since)) = self.shifting {
            let stance = side.other();
            let sole = figure.sole_at(&self.motion.states, stance).map(flat);
            // Who stands wide gets only nearly there, and lets the swing take what is left.
            let wide = ((feet[0].distance(feet[1]) / self.size - 0.45) / 0.25).clamp(0.0, 1.0);
            let wide = if self.stance.is_some() { wide.max(SHIFTS) } else { wide };
            let waited = ((self.time - since) / tempo - 0.15).clamp(0.0, 1.0) * wide;
            let over = signed_distance(&convex_hull(&sole), xi) < ((0.25 * waited).min(0.13) - 0.012) * self.size;
            let weight = self.motion.mass * GRAVITY * dt;
            if over && loads[side as usize] < (0.25 + 0.3 * waited) * weight {
                let (ankle, yaw) = self.foot(figure, side);
                let ground = ankle - DVec3::Y * figure.ankle_height;
                self.shifting = None;
                self.swing = Some(Swing {
                    side,
                    start: self.time,
                    time: (if self.stance.is_some() { QUICK } else { 0.47 } - 0.22 * waited) * tempo,
                    target: beside(side),
                    from: ground,
                    lift: 0.05 * self.size,
                    comfort: true,
                    reference: Reference { at: ground, ..Reference::default() },
                    yaw,
                    spin: 0.0,
                    free: false,
                });
            } else if self.time - since > 2.0 * tempo {
                self.shifting = None;
                self.quiet = -1.0;
            }
        } else if self.quiet > 0.15 * tempo {
            let off = |side: Side| {
                let turned = wrap_angle(self.foot(figure, side).1 - self.heading).abs();
                feet[side as usize].distance(beside(side)) / self.size + 0.3 * turned
            };
            let (left, right) = (off(Side::Left), off(Side::Right));
            if left.max(right) > BESIDE {
                let side = if left > right { Side::Left } else { Side::Right };
                self.shifting = Some((side, self.time));
            }
        }
    }
}
