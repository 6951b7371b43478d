//! The balance law: from a reading of the body to the torques of the next tick. Scenario space, SI.
//!
//! Tasks (centre of mass, pelvis, feet, trunk, arms) are wanted accelerations. The contact forces that serve them best and
//! that the soles can give fix the pelvis's acceleration; inverse dynamics turns it all into joint torques, given to the
//! world as springs whose rests meet them at the end of the tick, so that what is not foreseen is resisted.

use super::dynamics::{Acceleration, LegMap, Motion, Wrench};
use super::figure::{Figure, Freedom, Part};
use super::forces::{Corner, Forces, Wanted};
use super::linear::{Factored, Matrix6};
use super::plan::{self, Situation, StepTuning};
use super::swing::{self, Reference};
use super::world::{JointDrive, LinkState, World};
use crate::maths::hull::{closest_point, convex_hull, shrink, signed_distance};
use crate::maths::pendulum::GRAVITY;
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec2, DVec3};

/// Everything that can be turned.
#[derive(Clone, Copy, Debug)]
pub struct Tuning {
    /// Stepping.
    pub step: StepTuning,
    /// Feedback from ξ to the centre of pressure.
    pub cop_gain: f64,
    /// Share of the angular momentum in ξ.
    pub momentum: f64,
    /// m, ξ so far outside the soles starts a step.
    pub trigger: f64,
    /// m, by which the soles are shrunk for that.
    pub shrunk: f64,
    /// N m, the moment that may be asked for in stance, and more in a swing.
    pub moment: [f64; 2],
    /// 1/s², 1/s: height.
    pub height: [f64; 2],
    /// 1/s², 1/s: pelvis.
    pub pelvis: [f64; 2],
    /// rad/s²: most.
    pub pelvis_most: f64,
    /// 1/s², 1/s: trunk.
    pub trunk: [f64; 2],
    /// 1/s², 1/s: swing foot.
    pub foot: [f64; 2],
    /// 1/s², 1/s: swing foot's turn.
    pub foot_turn: [f64; 2],
    /// Weights of the forces' tasks: sideways, up, level turn, yaw.
    pub weights: [f64; 4],
    /// Weight of the shares.
    pub ridge: f64,
    /// Share of the servo's stiffness and damping that stands by, in the legs and elsewhere.
    pub standby: [f64; 2],
    /// N m/rad and N m s/rad that stand by in the joints of a leg that bears.
    pub bearing: [f64; 2],
    /// m, lift of a step.
    pub lift: [f64; 2],
    /// Share of the observed push that is foreseen.
    pub foreseen: f64,
    /// Share of the weight that each foot keeps while both stand, and that the other bears before one leaves.
    pub least: f64,
    /// As `least` says.
    pub borne: f64,
    /// 1/s², pull of the ground on a sole that came off.
    pub settle: f64,
    /// The trunk turns apart from the pelvis.
    pub apart: bool,
    /// m/s², rad/s²: most of a swing foot.
    pub foot_most: [f64; 2],
    /// Share of a swing by which the foot must be off the ground.
    pub rise: f64,
    /// 1/s, how hard a foot that bears is held still.
    pub hold: f64,
    /// Share of a leg's length that it is to use: standing, stepping.
    pub reach: [f64; 2],
    /// Share of a bearing foot's motion that is stopped at once.
    pub snap: f64,
    /// 1/s², how hard a bearing sole is laid flat.
    pub level: f64,
    /// Share of its length that a swinging leg uses.
    pub stretch: f64,
    /// Share of the sole that is planned with.
    pub inside: f64,
    /// m/s, how fast the wanted height changes.
    pub sink: f64,
    /// Damping of the legs' inverse.
    pub damping: f64,
}

impl Default for Tuning {
    fn default() -> Tuning {
        Tuning {
            step: StepTuning::default(),
            cop_gain: 2.8,
            momentum: 1.1,
            trigger: 0.02,
            shrunk: 0.03,
            moment: [120.0, 350.0],
            height: [100.0, 20.0],
            pelvis: [80.0, 12.0],
            pelvis_most: 40.0,
            trunk: [100.0, 16.0],
            foot: [600.0, 40.0],
            foot_turn: [600.0, 40.0],
            weights: [1.0, 1.0, 0.3, 0.2],
            ridge: 0.02,
            standby: [0.2, 0.2],
            bearing: [8000.0, 800.0],
            lift: [0.06, 0.1],
            foreseen: 0.7,
            least: 0.06,
            borne: 0.03,
            settle: 1000.0,
            apart: false,
            foot_most: [80.0, 150.0],
            rise: 0.25,
            hold: 0.0,
            reach: [0.965, 0.945],
            snap: 0.8,
            level: 800.0,
            stretch: 0.965,
            inside: 0.9,
            sink: 0.6,
            damping: 0.2,
        }
    }
}

/// N m, the most that a joint gives.
pub const MOST_TORQUE: f64 = 500.0;

/// A swing under way.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    /// Which foot.
    pub side: Side,
    /// s.
    pub start: f64,
    /// s, planned.
    pub time: f64,
    /// m, where the sole's middle goes.
    pub target: DVec2,
    /// m, where the ankle's ground point left.
    pub from: DVec3,
    /// m, how high.
    pub lift: f64,
    reference: Reference,
    yaw: f64,
    free: bool,
}

/// What the last tick knew and did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report {
    /// m, centre of mass.
    pub com: DVec3,
    /// m/s.
    pub velocity: DVec3,
    /// m.
    pub xi: DVec2,
    /// m, the centre of pressure that was commanded.
    pub cop: DVec2,
    /// N m, the largest joint torque.
    pub peak_torque: f64,
    /// Feet that bear.
    pub bears: [bool; 2],
    /// Steps so far.
    pub steps: usize,
}

/// The controller.
pub struct Controller {
    /// Its dials.
    pub tuning: Tuning,
    /// s.
    pub time: f64,
    /// The swing under way.
    pub swing: Option<Swing>,
    /// What is known.
    pub report: Report,
    /// N m by link: the torque that each joint was given.
    pub torques: Vec<f64>,
    size: f64,
    stand_height: f64,
    pelvis_height: f64,
    heading: f64,
    last: Option<Side>,
    push: DVec3,
    before: Option<(DVec3, DVec3)>, // velocity and commanded force a tick ago
    motion: Motion,
    forces: Forces,
    states: Vec<LinkState>,
    accelerations: Vec<Acceleration>,
    outside: Vec<(DVec3, DVec3)>,
    needed: Vec<DVec3>,
    relative: Vec<DVec3>,
    middle: f64,
    stopped: Vec<DVec3>,
    aimed: f64,
    leaving: Option<(Side, usize)>,
    dbg2: (DVec3, DVec3, DVec3, DVec3),
    dbg: (Vec<Acceleration>, Vec<(DVec3, DVec3)>),
}

impl Controller {
    /// For a figure that stands.
    pub fn new(figure: &Figure, world: &World, tuning: Tuning) -> Controller {
        let mut states = Vec::new();
        world.read(&mut states);
        let mut motion = Motion::default();
        motion.read(figure, &states);
        let sole = |side: usize| figure.soles[side].iter().copied().sum::<DVec3>() / 4.0;
        Controller {
            tuning,
            time: 0.0,
            swing: None,
            report: Report::default(),
            torques: vec![0.0; figure.links.len()],
            size: figure.leg_length / 0.83,
            stand_height: motion.com.y,
            pelvis_height: states[0].origin.y,
            leaving: None,
            dbg2: Default::default(),
            dbg: (Vec::new(), vec![(DVec3::ZERO, DVec3::ZERO); 40]),
            aimed: states[0].origin.y,
            heading: yaw_of(states[0].turn),
            last: None,
            push: DVec3::ZERO,
            before: None,
            motion,
            forces: Forces::default(),
            states,
            accelerations: Vec::new(),
            outside: Vec::new(),
            needed: Vec::new(),
            relative: Vec::new(),
            stopped: Vec::new(),
            middle: 0.5 * (sole(0).z + sole(1).z),
        }
    }

    /// m, ground point under the ankle of a foot and where it points.
    fn foot(&self, figure: &Figure, side: Side) -> (DVec3, f64) {
        let state = &self.motion.states[figure.legs[side as usize][2]];
        (state.origin, yaw_of(state.turn))
    }

    /// m, the middle of a sole, (x, z).
    fn sole_middle(&self, figure: &Figure, side: Side) -> DVec2 {
        let (ankle, yaw) = self.foot(figure, side);
        flat(ankle) + self.ahead(yaw)
    }

    /// m, from the ankle to where a foot bears best.
    fn ahead(&self, yaw: f64) -> DVec2 {
        DVec2::new(yaw.sin(), yaw.cos()) * (self.middle * 0.8)
    }

    /// One tick: reads the world, decides, drives. The world is to be stepped after it.
    pub fn tick(&mut self, figure: &Figure, world: &mut World, terrain: &Terrain) -> Report {
        let dt = world.dt;
        let mut states = std::mem::take(&mut self.states);
        world.read(&mut states);
        self.motion.read(figure, &states);
        self.states = states;
        let pressed = world.feet_pressed(figure);
        let loads = Side::BOTH.map(|side| world.pressed(figure.legs[side as usize][2]));
        self.observe(dt);
        let floor = self.floor(figure, terrain);
        let height = (self.motion.com.y - floor).max(0.3 * self.stand_height);
        let rate = (GRAVITY / height).sqrt();
        let xi = self.motion.extrapolated(rate, self.tuning.momentum);
        self.step(figure, terrain, pressed, loads, xi, rate, dt);
        self.act(figure, world, terrain, xi, height, floor, dt);
        self.time += dt;
        self.report
    }

    /// The push that acts, from what the centre of mass did against what was commanded.
    fn observe(&mut self, dt: f64) {
        if let Some((velocity, force)) = self.before {
            let seen = self.motion.mass * (self.motion.velocity - velocity) / dt
                + DVec3::Y * (self.motion.mass * GRAVITY)
                - force;
            self.push += 0.3 * (seen - self.push);
        }
    }

    /// m, the ground under the feet that bear.
    fn floor(&self, figure: &Figure, terrain: &Terrain) -> f64 {
        let mut sum = (0.0, 0.0);
        for side in Side::BOTH {
            if self.swing.is_none_or(|swing| swing.side != side) {
                sum.0 += terrain.spot(flat(self.foot(figure, side).0)).height;
                sum.1 += 1.0;
            }
        }
        sum.0 / f64::max(sum.1, 1.0)
    }

    fn hull(&self, figure: &Figure) -> Vec<DVec2> {
        let mut points = Vec::with_capacity(8);
        for side in Side::BOTH {
            if self.swing.is_none_or(|swing| swing.side != side) {
                let state = &self.motion.states[figure.legs[side as usize][2]];
                points.extend(figure.soles[side as usize].map(|corner| flat(state.origin + state.turn * corner)));
            }
        }
        convex_hull(&points)
    }

    fn situation(&self, figure: &Figure, xi: DVec2, rate: f64, cop: DVec2) -> Situation {
        let push = flat(self.push) * self.tuning.foreseen / (self.motion.mass * rate * rate);
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
        }
    }

    /// Lands, aims and starts swings.
    fn step(&mut self, figure: &Figure, terrain: &Terrain, pressed: [bool; 2], loads: [f64; 2], xi: DVec2, rate: f64, dt: f64) {
        if let Some(mut swing) = self.swing {
            let passed = self.time - swing.start;
            let (ankle, _) = self.foot(figure, swing.side);
            let near = (flat(ankle) + self.ahead(swing.yaw)).distance(swing.target) < 0.10 * self.size;
            let down = pressed[swing.side as usize];
            if down && passed > if near { 0.5 } else { 0.7 } * swing.time {
                self.swing = None;
                self.last = Some(swing.side);
                self.report.steps += 1;
            } else {
                let left = (swing.time - passed).max(0.0);
                if passed < 0.85 * swing.time {
                    let hull = self.hull(figure);
                    let cop = closest_point(&hull, xi).unwrap_or(xi);
                    let situation = self.situation(figure, xi, rate, cop);
                    swing.target = plan::aim(&situation, &self.tuning.step, swing.side, swing.time, left).at;
                }
                swing.yaw += wrap_angle(self.heading - swing.yaw) * (dt / (left + dt)).min(1.0);
                let goal = swing.target - self.ahead(swing.yaw);
                // Off the ground before it travels.
                if !down || passed > self.tuning.rise * swing.time {
                    swing.free = true;
                }
                if swing.free {
                    let left = (0.95 * swing.time - passed).max(0.02);
                    swing.reference = swing::onwards(&swing.reference, goal, left, dt);
                }
                let x = (passed + dt) / (0.92 * swing.time);
                let ground = terrain.spot(goal).height;
                let base = swing.from.y + (ground - swing.from.y) * x.clamp(0.0, 1.0);
                let (y, v, a) = if x < 1.0 {
                    let [l, d, a] = swing::lift(x);
                    let speed = 1.0 / (0.92 * swing.time);
                    (base + swing.lift * l, swing.lift * d * speed, swing.lift * a * speed * speed)
                } else {
                    (swing.reference.at.y - 0.6 * dt, -0.6, 0.0)
                };
                swing.reference.acceleration.y = a;
                swing.reference.at.y = y;
                swing.reference.velocity.y = v;
                self.swing = Some(swing);
            }
        }
        if self.swing.is_none() {
            let hull = self.hull(figure);
            let out = signed_distance(&shrink(&hull, self.tuning.shrunk * self.size), xi);
            if out > self.tuning.trigger * self.size {
                let cop = closest_point(&hull, xi).unwrap_or(xi);
                let situation = self.situation(figure, xi, rate, cop);
                let target = plan::choose(&situation, &self.tuning.step);
                // A foot leaves when the other bears.
                let weight = self.motion.mass * GRAVITY * dt;
                let waited = self.leaving.map_or(0, |(_, ticks)| ticks);
                if loads[target.side.other() as usize] < self.tuning.borne * weight && waited < 8 {
                    self.leaving = Some((target.side, waited + 1));
                    return;
                }
                self.leaving = None;
                let (ankle, yaw) = self.foot(figure, target.side);
                let ground = ankle - DVec3::Y * figure.ankle_height;
                let travel = target.at.distance(situation.feet[target.side as usize]);
                self.swing = Some(Swing {
                    side: target.side,
                    start: self.time,
                    time: target.time,
                    target: target.at,
                    from: ground,
                    lift: self.tuning.lift[0] * self.size
                        + self.tuning.lift[1] * (travel - 0.4 * self.size).max(0.0),
                    reference: Reference { at: ground, ..Reference::default() },
                    yaw,
                    free: false,
                });
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "one tick")]
    fn act(
        &mut self,
        figure: &Figure,
        world: &mut World,
        terrain: &Terrain,
        xi: DVec2,
        height: f64,
        floor: f64,
        dt: f64,
    ) {
        let tuning = self.tuning;
        let count = figure.links.len();
        let mass = self.motion.mass;
        let moving = self.swing.is_some();
        // Where the pressure should be.
        let hull = self.hull(figure);
        let middle = self.support_middle(figure);
        let fast = (flat(self.motion.velocity).length() / self.size.sqrt() - 0.8).clamp(0.0, 1.0);
        let moment = (tuning.moment[0] + if moving { tuning.moment[1] * fast } else { 0.0 }) * (mass / 89.5) * self.size;
        let goal = middle + (xi - middle) * tuning.cop_gain;
        let inside = closest_point(&hull, goal).unwrap_or(middle);
        let cop = inside + (goal - inside).clamp_length_max(moment / (mass * GRAVITY));
        self.report.cop = inside;
        // Height: as the stand, but never past the legs' reach.
        let aim = self.wanted_height(figure, floor);
        let most = tuning.sink * dt * self.size.sqrt();
        self.aimed += (aim - self.aimed).clamp(-most, most);
        let wanted_height = self.aimed;
        let up = GRAVITY
            + tuning.height[0] * (wanted_height - self.states[0].origin.y) / self.size.sqrt()
            - tuning.height[1] * self.motion.velocity.y;
        let up = up.clamp(0.6 * GRAVITY, 2.0 * GRAVITY);
        let level = (flat(self.motion.com) - cop) * (up / height);
        let linear = DVec3::new(level.x, up - GRAVITY, level.y);
        // Pelvis and trunk upright, towards the heading.
        if moving {
            self.heading += 0.03 * wrap_angle(yaw_of(self.states[0].turn) - self.heading);
        }
        let facing = DQuat::from_rotation_y(self.heading);
        let turn = |link: usize, wanted: DQuat, gains: [f64; 2], most: f64| {
            let error = (wanted * self.states[link].turn.inverse()).to_scaled_axis_short();
            (error * gains[0] - self.states[link].spin * gains[1]).clamp_length_max(most)
        };
        let angular = turn(0, facing, tuning.pelvis, tuning.pelvis_most);
        let trunk = turn(figure.trunk, facing, tuning.trunk, 60.0);
        // Joints that are free to be posed: back to the stand.
        self.relative.clear();
        self.relative.resize(count, DVec3::ZERO);
        for index in 1..count {
            let link = &figure.links[index];
            let parent = link.parent.unwrap_or(0);
            let error = (self.states[parent].turn * self.states[index].turn.inverse()).to_scaled_axis_short();
            let spin = self.motion.relative_spin(figure, index);
            let omega = 0.6 * link.omega;
            self.relative[index] = error * omega * omega - spin * (2.0 * omega);
        }
        let legs = Side::BOTH.map(|side| LegMap::new(figure, &self.motion, figure.legs[side as usize], tuning.damping));
        let feet = Side::BOTH.map(|side| self.foot_task(figure, terrain, side));
        // A foot that bears stands still as soon as it touches: its leg's dampers must not carry its last motion on.
        self.stopped.clear();
        self.stopped.resize(count, DVec3::ZERO);
        for side in Side::BOTH {
            if self.swing.is_none_or(|swing| swing.side != side) {
                let leg = figure.legs[side as usize];
                let change = legs[side as usize].change(-self.motion.origin_velocity(leg[2]), -self.states[leg[2]].spin);
                for (link, change) in leg.into_iter().zip(change) {
                    self.stopped[link] = change * tuning.snap;
                }
            }
        }
        // The pelvis's acceleration as a function of the wrench.
        let bias = self.spread(figure, &legs, &feet, &Acceleration::default(), trunk);
        let mut matrix: Matrix6 = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut unit = Acceleration::default();
            if column < 3 {
                unit.linear[column] = 1.0;
            } else {
                unit.angular[column - 3] = 1.0;
            }
            let wrench = self.spread(figure, &legs, &feet, &unit, trunk);
            for row in 0..6 {
                matrix[row][column] = wrench[row] - bias[row];
            }
        }
        let base = Factored::new(matrix, 1e-3);
        let corners = self.corners(figure, terrain);
        let wanted = Wanted { linear, angular, weights: tuning.weights };
        let mut forces = std::mem::take(&mut self.forces);
        let wrench = forces.solve(&corners, self.motion.com, mass, terrain.friction.clamp(0.0, 0.95), &base, &bias, &wanted, tuning.ridge);
        let mut less = wrench;
        for (value, bias) in less.iter_mut().zip(bias) {
            *value -= bias;
        }
        let root = base.solve(&less);
        let root = Acceleration {
            linear: DVec3::new(root[0], root[1], root[2]),
            angular: DVec3::new(root[3], root[4], root[5]),
        };
        self.spread(figure, &legs, &feet, &root, trunk);
        self.outside.clear();
        self.outside.resize(count, (DVec3::ZERO, DVec3::ZERO));
        for side in 0..2 {
            let foot = figure.legs[side][2];
            self.outside[foot] = forces.on_foot(&corners, side, self.states[foot].origin);
        }
        self.forces = forces;
        let mut needed = std::mem::take(&mut self.needed);
        self.motion.torques(figure, &self.accelerations, &self.outside, &mut needed);
        self.needed = needed;
        let force = DVec3::new(wrench[0], wrench[1], wrench[2]);
        if std::env::var("DBG").is_ok() {
            let real = |i: usize| (self.motion.origin_velocity(i) - self.dbg.1[i].0) / dt;
            let reala = |i: usize| (self.states[i].spin - self.dbg.1[i].1) / dt;
            if self.dbg.0.len() == count {
                let (f, m, v, l) = self.dbg2;
                eprintln!("W {:.2} F {:.0} real {:.0} M {:.0} real {:.0}", self.time, f, mass * ((self.motion.velocity - v) / dt + DVec3::Y * GRAVITY), m, (self.motion.momentum - l) / dt);
                for side in 0..2 { let st = self.states[figure.legs[side][2]]; let c: Vec<String> = figure.soles[side].iter().map(|c| format!("{:.1}", (st.origin + st.turn * *c).y * 1000.0)).collect(); eprintln!("C {:.2} {side} {} v {:.2} w {:.1} ref {:?}", self.time, c.join(" "), self.motion.origin_velocity(figure.legs[side][2]), st.spin, self.swing.map(|s| s.reference.at.y)); }
                eprint!("t {:.2} ", self.time);
                for i in [0, figure.trunk, figure.legs[0][0], figure.legs[0][1], figure.legs[0][2], figure.legs[1][0], figure.legs[1][2]] {
                    eprint!("| {i} plan {:.1} {:.1} real {:.1} {:.1} ", self.dbg.0[i].linear, self.dbg.0[i].angular, real(i), reala(i));
                }
                eprintln!("push {:.0} pressed {:.2} {:.2} tau {:.0} {:.0} {:.0} / {:.0} {:.0} {:.0}", self.push, world.pressed(figure.legs[0][2]), world.pressed(figure.legs[1][2]), self.torques[figure.legs[0][0]], self.torques[figure.legs[0][1]], self.torques[figure.legs[0][2]], self.torques[figure.legs[1][0]], self.torques[figure.legs[1][1]], self.torques[figure.legs[1][2]]);
            }
            self.dbg.1 = (0..count).map(|i| (self.motion.origin_velocity(i), self.states[i].spin)).collect();
            self.dbg.0 = self.accelerations.clone();
            self.dbg2 = (DVec3::new(wrench[0], wrench[1], wrench[2]), DVec3::new(wrench[3], wrench[4], wrench[5]), self.motion.velocity, self.motion.momentum);
        }
        self.before = Some((self.motion.velocity, force));
        self.give(figure, world, dt);
        let report = &mut self.report;
        report.com = self.motion.com;
        report.velocity = self.motion.velocity;
        report.xi = xi;
        report.bears = Side::BOTH.map(|side| self.swing.is_none_or(|swing| swing.side != side));
    }

    /// The middle of what bears, (x, z).
    fn support_middle(&self, figure: &Figure) -> DVec2 {
        match self.swing {
            Some(swing) => self.sole_middle(figure, swing.side.other()),
            None => 0.5 * (self.sole_middle(figure, Side::Left) + self.sole_middle(figure, Side::Right)),
        }
    }

    /// m, the pelvis's height: the stand's, or less where a leg would not reach.
    fn wanted_height(&self, figure: &Figure, floor: f64) -> f64 {
        let pelvis = self.states[0];
        let mut height = self.pelvis_height + floor;
        for side in Side::BOTH {
            let [hip, knee, ankle] = figure.legs[side as usize];
            let length = figure.links[knee].anchor.length() + figure.links[ankle].anchor.length();
            let hip_at = self.states[hip].origin;
            let over = hip_at.y - pelvis.origin.y;
            let (foot, reach) = match self.swing {
                Some(swing) if swing.side == side => {
                    let left = (swing.start + swing.time - self.time).max(0.0);
                    let goal = swing.target - self.ahead(swing.yaw);
                    let drift = flat(self.motion.velocity) * left;
                    let at = DVec3::new(goal.x - drift.x, self.states[ankle].origin.y.min(floor + figure.ankle_height), goal.y - drift.y);
                    (at, self.tuning.reach[1] + 0.05 * left / swing.time)
                }
                _ => (self.states[ankle].origin, if self.swing.is_some() { self.tuning.reach[1] } else { self.tuning.reach[0] }),
            };
            let away = (flat(hip_at) - flat(foot)).length();
            let reach = reach * length;
            let above = (reach * reach - away * away).max(0.09 * length * length).sqrt();
            height = height.min(foot.y + above - over);
        }
        height.max(floor + 0.72 * self.pelvis_height)
    }

    /// What a foot's link should do.
    fn foot_task(&self, figure: &Figure, terrain: &Terrain, side: Side) -> Acceleration {
        let foot = figure.legs[side as usize][2];
        let state = &self.states[foot];
        let tuning = &self.tuning;
        match self.swing {
            Some(swing) if swing.side == side => {
                let goal = swing.reference.at + DVec3::Y * figure.ankle_height;
                // Never so far that the knee would be straight: there a leg cannot be steered.
                let [hip, knee, ankle] = figure.legs[side as usize];
                let length = figure.links[knee].anchor.length() + figure.links[ankle].anchor.length();
                let hip = self.states[hip].origin;
                let goal = hip + (goal - hip).clamp_length_max(tuning.stretch * length);
                let velocity = self.motion.origin_velocity(foot);
                let spot = terrain.spot(flat(goal));
                let level = DQuat::from_rotation_arc(DVec3::Y, spot.normal) * DQuat::from_rotation_y(swing.yaw);
                let error = (level * state.turn.inverse()).to_scaled_axis_short();
                Acceleration {
                    linear: (swing.reference.acceleration
                        + (goal - state.origin) * tuning.foot[0]
                        + (swing.reference.velocity - velocity) * tuning.foot[1])
                        .clamp_length_max(tuning.foot_most[0]),
                    angular: (error * tuning.foot_turn[0] - state.spin * tuning.foot_turn[1]).clamp_length_max(tuning.foot_most[1]),
                }
            }
            _ => {
                let spot = terrain.spot(flat(state.origin));
                let up = state.turn * DVec3::Y;
                let tilt = up.cross(spot.normal);
                // A sole that came off goes back down; a tilted one turns about where it stands.
                let over = figure.soles[side as usize].map(|corner| {
                    let at = state.origin + state.turn * corner;
                    (at, at.y - terrain.spot(flat(at)).height)
                });
                let low = over.iter().map(|(_, height)| *height).fold(f64::INFINITY, f64::min);
                let bearing = |height: f64| (1.0 - (height - low) / (0.01 * self.size)).max(0.0);
                let weight: f64 = over.iter().map(|(_, height)| bearing(*height)).sum();
                let pivot = over.iter().map(|(at, height)| *at * bearing(*height)).sum::<DVec3>() / weight.max(1e-9);
                let gap = low.clamp(-0.002, 0.1);
                let back = spot.normal * ((gap + 0.001).max(0.0) * tuning.settle);
                let angular = (tilt * tuning.level - state.spin * tuning.hold).clamp_length_max(400.0);
                let held = -self.motion.origin_velocity(foot) * tuning.hold - back;
                Acceleration {
                    linear: held.clamp_length_max(100.0) + angular.cross(state.origin - pivot),
                    angular,
                }
            }
        }
    }

    /// All links' accelerations for one of the pelvis; the wrench that they take.
    fn spread(
        &mut self,
        figure: &Figure,
        legs: &[LegMap; 2],
        feet: &[Acceleration; 2],
        root: &Acceleration,
        trunk: DVec3,
    ) -> Wrench {
        let count = figure.links.len();
        self.accelerations.clear();
        self.accelerations.resize(count, Acceleration::default());
        self.accelerations[0] = *root;
        for side in 0..2 {
            let [hip, knee, ankle] = figure.legs[side];
            let shank = self.states[knee].turn;
            let held = shank * DVec3::Y;
            let held = held * held.dot(self.relative[ankle]);
            let [a, b, c] = legs[side].solve(figure, &self.motion, root, &feet[side], held);
            for (link, relative) in [(hip, a), (knee, b), (ankle, c)] {
                let parent = figure.links[link].parent.unwrap_or(0);
                self.accelerations[link] = self.motion.child(figure, link, &self.accelerations[parent], relative);
            }
        }
        for index in 1..count {
            let link = &figure.links[index];
            match link.part {
                Part::Thigh(_) | Part::Shank(_) | Part::Foot(_) => {}
                Part::Trunk if self.tuning.apart => {
                    let parent = self.accelerations[0];
                    let still = self.motion.child(figure, index, &parent, DVec3::ZERO);
                    self.accelerations[index] = Acceleration { angular: trunk, ..still };
                }
                _ => {
                    let parent = link.parent.unwrap_or(0);
                    let relative = match link.freedom {
                        Freedom::Hinge { axis, .. } => {
                            let axis = self.states[parent].turn * axis;
                            axis * axis.dot(self.relative[index])
                        }
                        _ => self.relative[index],
                    };
                    self.accelerations[index] =
                        self.motion.child(figure, index, &self.accelerations[parent], relative);
                }
            }
        }
        self.motion.wrench(figure, &self.accelerations)
    }

    /// Corners of the feet that bear, named.
    fn corners(&self, figure: &Figure, terrain: &Terrain) -> Vec<(usize, Corner)> {
        let mut corners = Vec::with_capacity(8);
        let moving = self.swing.is_some();
        for side in Side::BOTH {
            if self.swing.is_some_and(|swing| swing.side == side) {
                continue;
            }
            let state = &self.states[figure.legs[side as usize][2]];
            let middle = figure.soles[side as usize].iter().copied().sum::<DVec3>() / 4.0;
            let dear = if self.leaving.is_some_and(|(leaving, _)| leaving == side) { 30.0 } else { 1.0 };
            for (index, corner) in figure.soles[side as usize].iter().enumerate() {
                let at = state.origin + state.turn * (middle + (*corner - middle) * self.tuning.inside);
                let spot = terrain.spot(flat(at));
                if at.y - spot.height < 0.02 * self.size {
                    let corner = Corner { at, normal: spot.normal, foot: side as usize, dear, least: if moving { 0.0 } else { self.tuning.least / 4.0 } };
                    corners.push((side as usize * 4 + index, corner));
                }
            }
        }
        corners
    }

    /// Torques to the world: a spring and a damper whose rests give what is needed if all goes as planned.
    fn give(&mut self, figure: &Figure, world: &mut World, dt: f64) {
        self.report.peak_torque = 0.0;
        for index in 1..figure.links.len() {
            let link = &figure.links[index];
            let parent = link.parent.unwrap_or(0);
            let back = self.states[parent].turn.inverse();
            let leg = matches!(link.part, Part::Thigh(_) | Part::Shank(_) | Part::Foot(_));
            let share = self.tuning.standby[usize::from(!leg)];
            let bears = match link.part {
                Part::Thigh(side) | Part::Shank(side) | Part::Foot(side) => {
                    self.swing.is_none_or(|swing| swing.side != side)
                }
                _ => false,
            };
            let scale = self.motion.mass / 89.5 * self.size * self.size;
            let stiffness = if bears {
                self.tuning.bearing[0] * scale
            } else {
                share * link.carried * link.omega * link.omega
            };
            let damping =
                if bears { self.tuning.bearing[1] * scale } else { share * 2.0 * link.carried * link.omega };
            let mut torque = back * self.needed[index];
            if let Freedom::Hinge { axis, .. } = link.freedom {
                torque = axis * axis.dot(torque);
            }
            let torque = torque.clamp_length_max(MOST_TORQUE);
            self.torques[index] = torque.length();
            self.report.peak_torque = self.report.peak_torque.max(torque.length());
            // Relative acceleration and speed at the end of the tick, as planned, in the parent's frame.
            let spin = self.states[index].spin - self.states[parent].spin + self.stopped[index];
            let relative = self.accelerations[index].angular
                - self.accelerations[parent].angular
                - self.states[parent].spin.cross(spin - self.stopped[index]);
            // The engine takes the tick in parts: what counts is the mean over their ends.
            let (spin, relative) = (back * spin, back * relative);
            let speed = spin + relative * (0.625 * dt);
            let way = spin * (0.625 * dt) + relative * (0.5 * 0.46875 * dt * dt);
            let ahead = way + (torque + speed * damping) / stiffness.max(1e-9);
            let stiff = [stiffness, damping];
            world.drive(figure, index, &JointDrive { stiffness, damping, ahead, stiff });
        }
    }
}

fn flat(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}

/// The rotation vector by the short way.
trait Short {
    fn to_scaled_axis_short(self) -> DVec3;
}

impl Short for DQuat {
    fn to_scaled_axis_short(self) -> DVec3 {
        if self.w < 0.0 { (-self).to_scaled_axis() } else { self.to_scaled_axis() }
    }
}
