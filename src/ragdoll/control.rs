//! The balance law: from a reading of the body to the torques of the next tick. Scenario space, SI.
//!
//! Tasks (centre of mass, pelvis, feet, trunk, arms) are wanted accelerations. The contact forces that serve them best and
//! that the soles can give fix the pelvis's acceleration; inverse dynamics turns it all into joint torques, given to the
//! world as springs whose rests meet them at the end of the tick, so that what is not foreseen is resisted (`joints`).

use super::crouch;
use super::dynamics::{Acceleration, LegMap, Motion};
use super::figure::Figure;
use super::forces::{Corner, Forces, Wanted};
use super::guide::{self, Guide};
use super::joints::pelvis;
use super::reach::Sole;
use super::slope;
use super::stance::Stance;
use super::swing::Reference;
use super::toes;
use super::tuning::Tuning;
use super::world::{LinkState, World};
use super::{flat, short};
use crate::maths::hull::{closest_point, signed_distance};
use crate::maths::pendulum::GRAVITY;
use crate::maths::quat::yaw_of;
use crate::maths::real;
use crate::model::{Side, Spot, Terrain};
use glam::{DQuat, DVec2, DVec3};

pub use super::world::MOST_TORQUE;

/// What the pelvis may be given that no contact supplies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Assist {
    /// N m, the most torque.
    pub torque: f64,
    /// N, the most force.
    pub force: f64,
}

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
    /// Unhurried, to stand well again.
    pub comfort: bool,
    pub(super) reference: Reference,
    pub(super) yaw: f64,
    pub(super) spin: f64, // rad/s, how fast that changes, of a turn on the spot
    pub(super) free: bool,
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
    /// N m and N, the help that the pelvis was given.
    pub help: [DVec3; 2],
}

/// The controller.
#[derive(Clone)]
pub struct Controller {
    /// Its dials.
    pub tuning: Tuning,
    /// The dials that it began with.
    pub character: Tuning,
    /// s.
    pub time: f64,
    /// The swing under way.
    pub swing: Option<Swing>,
    /// What is known.
    pub report: Report,
    /// N m by link: what each joint gave in the last tick, springs and dampers included.
    pub torques: Vec<f64>,
    pub(super) size: f64,
    pub(super) stand_height: f64,
    pub(super) pelvis_height: f64,
    pub(super) heading: f64,
    /// rad, where it faces when nothing disturbs it.
    pub(super) facing: f64,
    pub(super) last: Option<Side>,
    pub(super) push: DVec3,
    /// N s, of that what is not felt yet, (x, z).
    pub(super) unfelt: DVec2,
    pub(super) before: Option<(DVec3, DVec3)>, // velocity and commanded force a tick ago
    pub(super) motion: Motion,
    pub(super) forces: Forces,
    pub(super) states: Vec<LinkState>,
    pub(super) accelerations: Vec<Acceleration>,
    pub(super) outside: Vec<(DVec3, DVec3)>,
    pub(super) toes: [toes::Asked; 2],
    pub(super) needed: Vec<DVec3>,
    pub(super) relative: Vec<DVec3>,
    pub(super) middle: f64,
    /// How each link is wanted to be turned against its parent, from the stand; arms, head and trunk heed it.
    pub posture: Vec<DQuat>,
    /// Bounds of the help.
    pub assist: Assist,
    pub(super) shifting: Option<(Side, f64)>,
    pub(super) quiet: f64,
    pub(super) stance_width: f64,
    pub(super) alarmed: f64,
    pub(super) fought: f64, // s, when it last stepped against a fall or was about to
    pub(super) eased: f64,  // s, when an unhurried step last landed
    pub(super) landed: f64, // s, when any step of the law's own last landed
    pub(super) upper_inertia: f64,
    pub(super) stopped: Vec<DVec3>,
    pub(super) aimed: f64,
    /// m/s, how fast that changes.
    pub(super) sinking: f64,
    pub(super) leaving: Option<(Side, usize)>,
    pub(super) soles: [Sole; 2],
    pub(super) slants: [DVec2; 2], // m, from the ground point of a foot to under its ankle: none on level ground
    /// What leads it now, if anything does.
    pub guide: Option<Guide>,
    /// m, how much lower than in the stand it is to hold its pelvis.
    pub lower: f64,
    /// m/s, what of its speed corrective steps are to keep, (x, z).
    pub going: DVec2,
    /// m/s, how fast it went there when it was led last: there may be a wall.
    pub went: f64,
    /// Whether it takes steps some time by what is meant: in a crouch its trunk leans for that.
    pub goes: bool,
    /// It steps when its projected centre of mass leaves its soles, not ξ: the paper's wording.
    pub projected: bool,
    /// How it stands when it is at ease, where that is not side by side.
    pub stance: Option<Stance>,
    pub(super) guided: bool, // the swing under way is the guide's
    pub(super) uphill: f64,  // rad, how far the trunk leans for ground that rises before it
    pub(super) treads: bool, // the ground has them
    pub(super) stairs: bool, // and is no mesh
    pub(super) leans: f64,   // rad, how far the trunk is to lean forwards
}

impl Controller {
    /// Counts heights from the ground under the feet, not from y = 0, and leans as that ground asks for.
    pub fn stands_on(&mut self, figure: &Figure, terrain: &Terrain) {
        let floor = self.floor(figure, terrain);
        self.stand_height -= floor;
        self.pelvis_height -= floor;
        self.uphill = slope::lean(self.faces_up(terrain));
    }

    /// It stands so much lower than the figure does already, m.
    pub fn stands_low(&mut self, figure: &Figure, terrain: &Terrain, by: f64) {
        self.lower = by;
        self.pelvis_height += by;
        self.stand_height += by;
        self.leans = slope::lowered(figure, terrain, by, self.goes);
    }

    /// For a figure that stands.
    pub fn new(figure: &Figure, world: &World, tuning: Tuning) -> Controller {
        let mut states = Vec::new();
        world.read(&mut states);
        let mut motion = Motion::default();
        motion.read(figure, &states);
        let middle = motion.com.z - 0.5 * (states[figure.legs[0][2]].origin.z + states[figure.legs[1][2]].origin.z);
        let stance_width = (states[figure.legs[0][2]].origin.x - states[figure.legs[1][2]].origin.x).abs();
        Controller {
            tuning,
            character: tuning,
            time: 0.0,
            swing: None,
            report: Report::default(),
            torques: vec![0.0; figure.links.len()],
            size: figure.leg_length / 0.83,
            stand_height: motion.com.y,
            pelvis_height: states[0].origin.y,
            leaving: None,
            soles: [Sole::default(); 2],
            slants: [DVec2::ZERO; 2],
            guide: None,
            lower: 0.0,
            going: DVec2::ZERO,
            went: 0.0,
            stance: None,
            guided: false,
            uphill: 0.0,
            treads: false,
            stairs: false,
            leans: 0.0,
            goes: false,
            projected: false,
            aimed: states[0].origin.y,
            sinking: 0.0,
            heading: yaw_of(states[0].turn),
            facing: yaw_of(states[0].turn),
            last: None,
            push: DVec3::ZERO,
            unfelt: DVec2::ZERO,
            before: None,
            motion,
            forces: Forces::default(),
            states,
            accelerations: Vec::new(),
            outside: Vec::new(),
            toes: [toes::Asked::default(); 2],
            needed: Vec::new(),
            relative: Vec::new(),
            stopped: Vec::new(),
            posture: vec![DQuat::IDENTITY; figure.links.len()],
            assist: Assist::default(),
            shifting: None,
            quiet: 0.0,
            stance_width,
            alarmed: f64::NEG_INFINITY,
            fought: f64::NEG_INFINITY,
            eased: f64::NEG_INFINITY,
            landed: f64::NEG_INFINITY,
            upper_inertia: figure.links[figure.trunk].carried + figure.links[0].carried.min(3.0),
            middle,
        }
    }

    /// m, by how much its trunk's lean over a crouch lowers its centre of mass.
    pub fn stoops(&self, figure: &Figure) -> f64 {
        crouch::sinks(figure, self.lower, self.leans - self.uphill)
    }

    /// Where the links are, as last read.
    pub fn states(&self) -> &[LinkState] {
        &self.states
    }

    /// m, ground point under the ankle of a foot and where it points.
    pub(super) fn foot(&self, figure: &Figure, side: Side) -> (DVec3, f64) {
        let state = &self.motion.states[figure.legs[side as usize][2]];
        (state.origin, yaw_of(state.turn))
    }

    /// m, the middle of a sole, (x, z).
    pub(super) fn sole_middle(&self, figure: &Figure, side: Side) -> DVec2 {
        let (ankle, yaw) = self.foot(figure, side);
        flat(ankle) - self.slants[side as usize] + self.ahead(side, yaw)
    }

    /// (x, z) of `far` m ahead of where it faces.
    fn ahead_by(&self, far: f64) -> DVec2 {
        DVec2::new(real::sin(self.heading), real::cos(self.heading)) * far
    }

    /// m, from the ankle to where a foot bears best whose link is turned so.
    pub(super) fn ahead(&self, side: Side, yaw: f64) -> DVec2 {
        let yaw = self.points(side, yaw);
        DVec2::new(real::sin(yaw), real::cos(yaw)) * self.middle
    }

    /// Reads where the links are and how they move.
    pub fn sense(&mut self, figure: &Figure, world: &World) {
        let mut states = std::mem::take(&mut self.states);
        world.read(&mut states);
        self.motion.read(figure, &states);
        self.states = states;
    }

    /// 1/s, of the pendulum that it is over level ground.
    pub fn rate(&self) -> f64 {
        (GRAVITY / self.motion.com.y.max(0.3 * self.stand_height)).sqrt()
    }

    /// m, ξ of what was last read, as the law takes it under a guide.
    pub fn extrapolated(&self) -> DVec2 {
        self.motion.extrapolated(self.rate(), guide::MOMENTUM)
    }

    /// m and m/s, the centre of mass as last read, with a velocity that makes ξ of both, at `rate` 1/s, what a guide's law takes for it.
    pub fn motion_of(&self, rate: f64) -> (DVec3, DVec3) {
        let (com, velocity) = (self.motion.com, self.motion.velocity);
        let lean = (self.motion.extrapolated(rate, guide::MOMENTUM) - self.motion.extrapolated(rate, 0.0)) * rate;
        (com, velocity + DVec3::new(lean.x, 0.0, lean.y))
    }

    /// One tick: reads the world, decides, drives. The world is to be stepped after it.
    pub fn tick(&mut self, figure: &Figure, world: &mut World, terrain: &Terrain) -> Report {
        let dt = world.dt;
        self.sense(figure, world);
        let pressed = world.feet_pressed(figure);
        let loads = Side::BOTH.map(|side| world.pressed(figure.legs[side as usize][2]));
        self.observe(dt);
        self.strain(world);
        self.slants = Side::BOTH.map(|side| slant(figure, &self.stood_on(figure, terrain, side)));
        self.soles = Side::BOTH.map(|side| self.sole(figure, terrain, side));
        self.stairs = terrain.has_treads();
        self.treads = self.stairs || terrain.is_mesh();
        let floor = self.floor(figure, terrain);
        let height = (self.motion.com.y - floor).max(0.3 * self.stand_height);
        let rate = (GRAVITY / height).sqrt();
        let momentum = if self.guide.is_some() { guide::MOMENTUM } else { self.tuning.momentum };
        let xi = self.motion.extrapolated(rate, momentum);
        self.step(figure, terrain, pressed, loads, xi, rate, dt);
        let felt = self.feels(figure, xi, rate);
        self.act(figure, world, terrain, felt, height, floor, dt);
        self.report.xi = xi;
        self.time += dt;
        self.report
    }

    /// m, the ground under the feet that bear.
    fn floor(&self, figure: &Figure, terrain: &Terrain) -> f64 {
        let mut sum = (0.0, 0.0);
        for side in Side::BOTH {
            if self.swing.is_none_or(|swing| swing.side != side) {
                sum.0 += self.stood_on(figure, terrain, side).height;
                sum.1 += 1.0;
            }
        }
        sum.0 / f64::max(sum.1, 1.0)
    }

    /// m, where the pressure would be best, and where it is to be: under the soles, and past them by what the upper body's moment makes up.
    fn pressure(&mut self, figure: &Figure, terrain: &Terrain, xi: DVec2) -> (DVec2, DVec2) {
        let tuning = self.tuning;
        let mass = self.motion.mass;
        let moving = self.swing.is_some();
        let hull = self.bearing_hull(figure);
        let [heel, .., tip, _] = figure.soles[0];
        let back = slope::back(terrain, self.faces_up(terrain)) * heel.distance(tip);
        let middle = self.support_middle(figure) - self.ahead_by(back);
        let fast = (flat(self.motion.velocity).length() / self.size.sqrt() - 0.8).clamp(0.0, 1.0);
        if self.swing.is_some_and(|swing| !swing.comfort) || signed_distance(&hull, xi) > -0.02 * self.size {
            self.alarmed = self.time;
            // Who sets a foot beside the other at his ease is over its edge as well, and fights nothing.
            if self.swing.is_none_or(|swing| !swing.comfort) && self.shifting.is_none() && !self.goes_home() {
                self.fought = self.time;
            }
        }
        let moment =
            (tuning.moment[0] + if moving { tuning.moment[1] * fast } else { 0.0 }) * (mass / 89.5) * self.size;
        let led = self.guide.map(|guide| flat(guide.pressure));
        // Who is going somewhere is not to be brought to rest: at his speed ξ is that far ahead of him.
        let goes = if self.on_open_ground() { self.going.clamp_length_max(self.went) } else { DVec2::ZERO };
        let ahead = goes / self.rate();
        let goal = led.unwrap_or(middle + (xi - ahead - middle) * tuning.cop_gain);
        let inside = closest_point(&hull, goal).unwrap_or(middle);
        let cop = inside + (goal - inside).clamp_length_max(moment / (mass * GRAVITY));
        self.report.cop = inside;
        (goal, cop)
    }

    /// m/s², how the centre of mass is to move over that pressure. Its height is the stand's, but never past the legs' reach.
    fn carried(&mut self, figure: &Figure, terrain: &Terrain, cop: DVec2, height: f64, floor: f64, dt: f64) -> DVec3 {
        let tuning = self.tuning;
        self.sink_to(self.wanted_height(figure, terrain, floor), dt);
        let wanted_height = self.aimed;
        let up = GRAVITY + tuning.height[0] * (wanted_height - self.states[0].origin.y) / self.size.sqrt()
            - tuning.height[1] * (self.motion.velocity.y - self.sinks() - self.guide.map_or(0.0, |guide| guide.climbs));
        let up = up.clamp(0.6 * GRAVITY, 2.0 * GRAVITY);
        let level = (flat(self.motion.com) - cop) * (up / height);
        DVec3::new(level.x, up - GRAVITY, level.y)
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
        let mass = self.motion.mass;
        let (goal, cop) = self.pressure(figure, terrain, xi);
        let linear = self.carried(figure, terrain, cop, height, floor, dt);
        // Pelvis and trunk upright, towards the heading.
        self.face();
        self.face_as_feet(figure, dt);
        self.bow(figure, terrain, dt);
        let facing = DQuat::from_rotation_y(self.heading) * self.bowed() * self.tilted();
        let turn = |link: usize, wanted: DQuat, gains: [f64; 2], most: f64| {
            let error = short(wanted * self.states[link].turn.inverse());
            (error * gains[0] - self.states[link].spin * gains[1]).clamp_length_max(most)
        };
        let [by, rate, quickens] = self.with_stride(figure, 0);
        let strides = DVec3::Y * (rate * tuning.pelvis[1] + quickens);
        let angular = turn(0, DQuat::from_rotation_y(by) * facing, tuning.pelvis, tuning.pelvis_most) + strides;
        let trunk = turn(figure.trunk, facing, tuning.trunk, 60.0);
        self.pose_joints(figure);
        let legs = Side::BOTH.map(|side| {
            let bent = self.bend(figure, side);
            let bears = self.swing.is_none_or(|swing| swing.side != side);
            let damping = if bears { tuning.damping[0] } else { self.swing_damping(figure, side) };
            LegMap::new(figure, &self.motion, figure.legs[side as usize], damping, bent)
        });
        let feet = Side::BOTH.map(|side| self.foot_task(figure, terrain, side));
        self.stand_still(figure, terrain, &legs, dt);
        let (base, bias) = self.root_map(figure, &legs, &feet, trunk);
        let corners = self.corners(figure, terrain);
        let [level, up, mut tilt, mut yaw] = tuning.weights;
        let mut linear = linear;
        if let Some(guide) = self.guide {
            [tilt, yaw] = guide::UPRIGHT;
            linear = self.over_pressure(&base, &bias, guide.pressure.y, linear, angular);
        }
        let wanted = Wanted { linear, angular, weights: [level, up, tilt, yaw] };
        let mut forces = std::mem::take(&mut self.forces);
        let wrench =
            forces.solve(&corners, self.motion.com, mass, terrain.friction, &base, &bias, &wanted, tuning.ridge);
        let (help_torque, help_force) = self.help(&base, &bias, &wrench, &wanted, goal, cop, GRAVITY / height);
        let root = pelvis(&base, &bias, &wrench, [help_force, help_torque]);
        self.spread(figure, &legs, &feet, &root, trunk);
        self.press(figure, terrain, &forces, &corners);
        self.forces = forces;
        self.lend(world, help_force, help_torque);
        let mut needed = std::mem::take(&mut self.needed);
        self.motion.torques(figure, &self.accelerations, &self.outside, &mut needed);
        self.needed = needed;
        let force = DVec3::new(wrench[0], wrench[1], wrench[2]) + help_force;
        self.before = Some((self.motion.velocity, force));
        self.give(figure, world, dt);
        let report = &mut self.report;
        report.com = self.motion.com;
        report.velocity = self.motion.velocity;
        report.bears = Side::BOTH.map(|side| self.swing.is_none_or(|swing| swing.side != side));
    }

    /// Does it stand on level ground that is not stairs? There, who steps against a fall lifts toes that point down and keeps up his way;
    /// on stairs and up steep slopes he does not come on with it.
    pub(super) fn on_open_ground(&self) -> bool {
        self.on_level() && !self.stairs
    }

    /// How far the toes of a foot are to lie along the ground, 0 to 1: of who steps against a fall and is in no hurry, and up a slope of who is
    /// led and lands on his balls. In line with the foot their tips touch 2 cm before the ball is down, and drag over the ground.
    fn levels(&self, side: Side) -> f64 {
        let Some(swing) = self.swing.filter(|swing| swing.side == side) else { return 0.0 };
        let share = match self.guided {
            true if self.on_level() => 0.0,
            true => self.on_balls(),
            false if self.on_open_ground() => self.unhurried(),
            false => 0.0,
        };
        share * toes::levels((self.time - swing.start) / swing.time)
    }

    /// What the contacts do to the feet.
    fn press(&mut self, figure: &Figure, terrain: &Terrain, forces: &Forces, corners: &[(usize, Corner)]) {
        self.outside.clear();
        self.outside.resize(figure.links.len(), (DVec3::ZERO, DVec3::ZERO));
        for side in 0..2 {
            let foot = figure.legs[side][2];
            self.outside[foot] = forces.on_foot(corners, side, self.states[foot].origin);
            self.toes[side] = toes::Asked {
                about: toes::asked(figure, &self.states, forces, corners, side),
                level: self.levels(Side::BOTH[side]),
                up: self.swing.map_or(DVec3::Y, |swing| terrain.spot(swing.target).normal),
            };
        }
    }

    /// Gives the pelvis that help, N and N m about the centre of mass.
    fn lend(&mut self, world: &mut World, help_force: DVec3, help_torque: DVec3) {
        // Through the pelvis's origin: the force's own moment about the centre of mass is part of the help.
        let origin = self.states[0].origin;
        let at_pelvis = help_torque - (origin - self.motion.com).cross(help_force);
        self.outside[0] = (help_force, at_pelvis);
        world.push(0, help_force, origin, at_pelvis);
        self.report.help = [at_pelvis, help_force];
    }

    /// What the joints gave in the last tick.
    fn strain(&mut self, world: &World) {
        for (index, torque) in self.torques.iter_mut().enumerate() {
            *torque = world.given(index);
        }
        self.report.peak_torque = self.torques.iter().copied().fold(0.0, f64::max);
    }
}

/// m, by how much an ankle is beside its foot's ground point where the ground leans, (x, z).
pub(super) fn slant(figure: &Figure, ground: &Spot) -> DVec2 {
    flat(ground.normal) * figure.ankle_height
}
