//! A run of the articulated body under pushes, and the trace that it leaves: the same as the stepper's, read off the links.
//!
//! Scenario space, SI, 10 ms ticks. The arms are told what a pushed person's would do (`whole_body::reaction`) and do what
//! their joints let them. It stands, sways and steps; where balance is lost the joints give way and it falls until it lies.
//! On flat ground it walks. What breaks down is caught in the tick in which it does.

use super::balls::{Balls, Flown, Incoming};
use super::record::{Record, hung};
use super::{SessionPush, SimulateOptions, TickState, Trace};
use crate::maths::quat::yaw_of;
use crate::measure::{KnownPush, PushPoint};
use crate::model::{Body, BodyPose, Load, Physique, Plant, Role, Side, Terrain};
use crate::ragdoll::control::Assist;
use crate::ragdoll::figure::Part;
use crate::ragdoll::walk::Order;
use crate::ragdoll::{Controller, Figure, LinkState, Locks, Tuning, World, fall};
use crate::whole_body::reaction::{Personality, Reaction, Senses, upper_turns};
use crate::whole_body::solve::{Hold, PoseTarget};
use crate::whole_body::stand::relaxed_arms;
use crate::whole_body::{Anatomy, ArmAngles, Solver, stand};
use glam::{DQuat, DVec2, DVec3};

/// In how many parts the world takes a tick.
const PARTS: usize = 2;
/// Share of the standing height under which the centre of mass has fallen (DESIGN, "fallen").
const FALLEN: f64 = 0.57;
/// And the share from which on who is falling lets himself fall.
const GIVES_WAY: f64 = 0.82;
/// s, the longest that a fall goes on, and for how long no link may be faster than that (m/s) for it to be over.
const LONGEST_FALL: f64 = 2.5;
const LIES: (f64, f64) = (0.3, 0.08);

/// What the pelvis was given that no contact supplied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Help {
    /// N m, largest and root mean square over the run.
    pub torque: [f64; 2],
    /// N, likewise.
    pub force: [f64; 2],
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Articulated {
    /// As of the stepper.
    pub trace: Trace,
    /// What the pelvis was given.
    pub help: Help,
    /// N m, the largest torque that a joint gave.
    pub peak_torque: f64,
    /// N m, the largest torque that each joint gave while balance was fought for; the hardest worked first.
    pub torques: Vec<(Role, f64)>,
    /// N m, what each of them gave at every tick, in the same order.
    pub torque_curves: Vec<Vec<f32>>, // (joints × ticks)
    /// The body as the links stand, one a tick and on through the fall.
    pub poses: Vec<BodyPose>,
    /// N s, what the ground pressed on each foot in the 10 ms before each tick, left and right.
    pub pressed: Vec<[f64; 2]>,
    /// The body's joint that each link turns about, the root's first.
    pub joints: Vec<usize>,
    /// s, from when to when each foot stood, left and right, as far as the run was asked for: between two of them it was up.
    pub stood: [Vec<[f64; 2]>; 2],
    /// The balls that were thrown.
    pub balls: Vec<Flown>,
}

/// Why there is no run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the articulated body broke down at {time:.2} s: {what}")]
pub struct BrokenBody {
    /// s.
    pub time: f64,
    /// Which part of it, and how.
    pub what: String,
}

/// Runs a body that stands, under those pushes (with each: its direction is the character's own).
pub fn simulate_articulated(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    terrain: &Terrain,
    options: &SimulateOptions,
    pushes: &[(KnownPush, bool)],
    assist: Assist,
) -> Result<Articulated, BrokenBody> {
    simulate_with(body, anatomy, physique, terrain, options, pushes, assist, &Things::none())
}

/// What comes at the body and what it carries.
pub struct Things<'a> {
    /// Balls.
    pub incoming: &'a [Incoming<'a>],
    /// Boxes, one after the other.
    pub loads: &'a [Load],
    /// How the hands hold what at a time (s).
    pub hold: &'a dyn Fn(f64) -> Option<Hold>,
    /// Where to walk at a time (s).
    pub walk: &'a dyn Fn(f64) -> Option<Order>,
}

impl Things<'_> {
    /// Nothing.
    pub fn none() -> Self {
        Things { incoming: &[], loads: &[], hold: &|_| None, walk: &|_| None }
    }
}

/// The same with balls that come at it and boxes in its hands.
#[expect(clippy::too_many_arguments, reason = "all that a run depends on")]
pub fn simulate_with(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    terrain: &Terrain,
    options: &SimulateOptions,
    pushes: &[(KnownPush, bool)],
    assist: Assist,
    things: &Things,
) -> Result<Articulated, BrokenBody> {
    let full = attempt(body, anatomy, physique, terrain, options, pushes, assist, things, None)?;
    let Some(_) = full.trace.lost else { return Ok(full) };
    // Nobody fights until he lies: seen from the end, the joints give way as soon as the body sinks for good.
    let up = |(index, tick): (usize, &TickState)| {
        let ground = terrain.held_at(index as f64 * options.dt);
        let floor = ground.spot(DVec2::new(tick.com.x, tick.com.z)).height;
        tick.com.y - floor > GIVES_WAY * physique.com_height
    };
    let last = full.trace.ticks.iter().enumerate().rev().find(|entry| up(*entry)).map_or(0, |(index, _)| index);
    attempt(body, anatomy, physique, terrain, options, pushes, assist, things, Some(last))
}

/// One run; the joints give way at that tick, or where it has fallen.
#[expect(clippy::too_many_arguments, reason = "one run")]
fn attempt(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    terrain: &Terrain,
    options: &SimulateOptions,
    pushes: &[(KnownPush, bool)],
    assist: Assist,
    things: &Things,
    gives_way: Option<usize>,
) -> Result<Articulated, BrokenBody> {
    let plants = stand::natural_plants(physique.stance_width, physique.com_forward);
    let target = stand::stand_target(body, &plants, DVec3::Y * physique.com_height, 0.0);
    let level = target;
    let standing = Solver::new(body, anatomy).solve(&target).pose;
    let figure = Figure::new(body, &standing, Locks::default());
    let carries = |time: f64, target: &PoseTarget| match (things.hold)(time) {
        Some(hold) => target.holding(hold),
        None => *target,
    };
    let target = carries(0.0, &target);
    let first = on_ground(body, anatomy, physique, terrain, &plants, &target)
        .unwrap_or_else(|| Solver::new(body, anatomy).solve(&target).pose);
    let mut run = Run::new(&figure, &first, body, terrain, options.dt)?;
    run.control.assist = assist;
    let mut reaction = Reaction::new(physique, Personality::default(), 0.5);
    let planned = (options.duration / options.dt - 1e-9).ceil().max(0.0) as usize;
    let most = planned + (options.extra / options.dt).ceil() as usize;
    let mut acting: Vec<SessionPush> = pushes
        .iter()
        .map(|(push, turns)| SessionPush {
            start: push.start,
            duration: push.end - push.start,
            force: push.force,
            turns: *turns,
            arm: 0.0,
        })
        .collect();
    let mut record = Record::new(plants, &figure);
    let mut rest = 0.0;
    let mut lost = None;
    let (mut poses, mut pressed) = (Vec::new(), Vec::new());
    for tick in 0..=most {
        let time = tick as f64 * options.dt;
        if tick > planned && rest >= 0.5 {
            break;
        }
        run.world.clear_forces();
        let ground = terrain.held_at(time);
        let laden = run.carry(&figure, body, things.loads, time);
        let model = laden.as_ref().unwrap_or(&figure);
        run.control.order = (things.walk)(time);
        let report = run.control.tick(model, &mut run.world, &ground);
        poses.push(pose_of(&figure, run.control.states()));
        let on_feet = figure.legs.map(|leg| run.world.pressed(leg[2]));
        pressed.push(on_feet);
        let facing = yaw_of(run.control.states()[0].turn);
        for push in acting.iter_mut().filter(|push| push.turns && push.start < time + options.dt - 1e-9) {
            push.force = DQuat::from_rotation_y(facing) * push.force;
            push.turns = false;
        }
        let (force, moment) = run.push(&figure, body, &acting, pushes, time, report.com);
        let (hit, hit_moment) = run.balls.felt(report.com, options.dt);
        let (force, moment) = (force + hit, moment + hit_moment);
        record.tick(&figure, &run.control, &report, (force, moment), &ground, on_feet.map(|n| n / options.dt), time);
        let state = record.ticks.last().expect("just recorded");
        let angles = reaction.tick(&senses(state), options.dt);
        let (_, _, _, arms) = upper_turns(&angles);
        run.pose_arms(&figure, &run.at_walk(arms));
        if let Some(hold) = (things.hold)(time + options.dt) {
            let held = Solver::new(body, anatomy).solve(&level.holding(hold)).pose;
            run.pose_held(&figure, &figure.placed(body, &held), hold.weight);
        }
        rest = if run.control.swing.is_none() && report.velocity.length() < 0.05 { rest + options.dt } else { 0.0 };
        let over = report.com.y - ground.spot(DVec2::new(report.com.x, report.com.z)).height;
        let lies = run.world.lies_on(&figure, run.control.states(), &ground).is_some();
        if gives_way == Some(tick) || lies || over < FALLEN * physique.com_height {
            lost = Some(time);
            run.fall(&figure, body, terrain, tick, &mut poses)?;
            break;
        }
        run.balls.launch(&figure, body, things.incoming, &run.states, &mut run.world, (time, facing, report.velocity));
        run.step(&figure, terrain, time)?;
        run.balls.watch(&figure, body, &run.states, &run.world, time + options.dt);
    }
    let balls = run.balls.finish();
    let joints = figure.joints();
    Ok(Articulated {
        poses,
        pressed,
        joints,
        balls,
        ..record.finish(options.dt, acting, (lost, rest), terrain, options.duration)
    })
}

/// The stand with the soles on ground that is not flat.
fn on_ground(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    terrain: &Terrain,
    plants: &[Plant; 2],
    level: &PoseTarget,
) -> Option<BodyPose> {
    if terrain.is_flat() {
        return None;
    }
    let ground = terrain.held_at(0.0);
    let mut target = *level;
    let mut base = 0.0;
    for side in Side::BOTH {
        let plant = &plants[side as usize];
        let spot = ground.spot(DVec2::new(plant.ankle.x, plant.ankle.z));
        let lean = DQuat::from_rotation_arc(DVec3::Y, spot.normal);
        let foot = &mut target.feet[side as usize];
        foot.ankle =
            DVec3::new(plant.ankle.x, spot.height, plant.ankle.z) + spot.normal * body.feet[side as usize].ankle_height;
        (foot.foot, foot.toe) = (lean * foot.foot, lean * foot.toe);
        base += 0.5 * (foot.ankle.y - body.feet[side as usize].ankle_height);
    }
    target.com = DVec3::Y * (physique.com_height + base);
    Some(Solver::new(body, anatomy).solve(&target).pose)
}

fn pose_of(figure: &Figure, states: &[LinkState]) -> BodyPose {
    let placed: Vec<(DVec3, DQuat)> = states.iter().map(|state| (state.origin, state.turn)).collect();
    figure.pose(&placed)
}

/// The world and its controller.
struct Run {
    world: World,
    control: Controller,
    states: Vec<LinkState>,
    balls: Balls,
    carried: Option<usize>,
}

impl Run {
    fn new(figure: &Figure, standing: &BodyPose, body: &Body, terrain: &Terrain, dt: f64) -> Result<Run, BrokenBody> {
        let world = World::new(figure, &figure.placed(body, standing), terrain, dt, PARTS)
            .map_err(|error| BrokenBody { time: 0.0, what: error.to_string() })?;
        let control = Controller::new(figure, &world, Tuning::default());
        let states = control.states().to_vec();
        Ok(Run { world, control, states, balls: Balls::default(), carried: None })
    }

    /// One tick of the world from `time` on, and a look at whether it still holds together.
    fn step(&mut self, figure: &Figure, terrain: &Terrain, time: f64) -> Result<(), BrokenBody> {
        let after = time + self.world.dt;
        self.world.step(terrain, after);
        self.world.read(&mut self.states);
        let broken = World::broken(figure, &self.states);
        match broken.or_else(|| self.world.broken_ball()) {
            Some(what) => Err(BrokenBody { time: after, what }),
            None => Ok(()),
        }
    }

    /// Balance is lost at that tick: the body comes down with its joints relaxed until it lies.
    fn fall(
        &mut self,
        figure: &Figure,
        body: &Body,
        terrain: &Terrain,
        tick: usize,
        poses: &mut Vec<BodyPose>,
    ) -> Result<(), BrokenBody> {
        let dt = self.world.dt;
        self.world.read(&mut self.states);
        let mut lies = 0.0;
        let ticks = (LONGEST_FALL / dt).round() as usize;
        for fallen in 0..ticks {
            self.world.clear_forces();
            fall::relax(figure, &mut self.world, &self.states, fallen as f64 * dt);
            self.step(figure, terrain, (tick + fallen) as f64 * dt)?;
            self.balls.watch(figure, body, &self.states, &self.world, (tick + fallen + 1) as f64 * dt);
            poses.push(pose_of(figure, &self.states));
            let fastest = self.states.iter().map(|state| state.velocity.length()).fold(0.0, f64::max);
            lies = if fastest < LIES.1 { lies + dt } else { 0.0 };
            if lies >= LIES.0 {
                break;
            }
        }
        Ok(())
    }

    /// Lets the pushes act on their links for the coming tick; their sum, and its moment about the centre of mass.
    fn push(
        &mut self,
        figure: &Figure,
        body: &Body,
        acting: &[SessionPush],
        pushes: &[(KnownPush, bool)],
        time: f64,
        com: DVec3,
    ) -> (DVec3, DVec3) {
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (push, (known, _)) in acting.iter().zip(pushes) {
            let covered = (push.start + push.duration).min(time + self.world.dt) - push.start.max(time);
            let share = (covered / self.world.dt).clamp(0.0, 1.0);
            if share < 1e-9 {
                continue;
            }
            let states = self.control.states();
            let placed = |joint: usize, offset: DVec3| {
                let link = figure.link_of[joint];
                let rest = figure.joint_in_link(body, joint) + figure.stand.turns[joint] * offset;
                (link, states[link].origin + states[link].turn * rest)
            };
            let (link, at) = match known.at {
                PushPoint::Joint(joint) => placed(joint, DVec3::ZERO),
                PushPoint::Segment(joint, offset) => placed(joint, offset),
                PushPoint::Centre => (0, com),
                PushPoint::World(point) => (figure.trunk, point),
            };
            self.world.push(link, push.force * share, at, DVec3::ZERO);
            force += push.force * share;
            moment += (at - com).cross(push.force * share);
        }
        (force, moment)
    }

    /// Has the box in the hands that is due at `time`; the figure as the law sees it then.
    fn carry(&mut self, figure: &Figure, body: &Body, loads: &[Load], time: f64) -> Option<Figure> {
        let due = loads.iter().position(|load| load.span[0] <= time + 1e-9 && time < load.span[1]);
        if due != self.carried {
            self.world.let_go();
            self.carried = due;
            if let Some(load) = due.map(|index| &loads[index]) {
                let link = figure.link_of[load.joint];
                let state = self.states[link];
                let turn = state.turn * figure.stand.turns[load.joint];
                let joint = state.origin + state.turn * figure.joint_in_link(body, load.joint);
                let mass = load.mass_at(time);
                self.world.take_up(figure, load.size, mass, joint + turn * load.centre, turn * load.level);
            }
        }
        let load = &loads[due?];
        let mass = load.mass_at(time);
        self.world.weigh(mass);
        self.world.laden(figure, &self.states, mass)
    }

    /// Tells the arms to hold on to a box, that much (0..1), as in that pose of the links.
    fn pose_held(&mut self, figure: &Figure, held: &[(DVec3, DQuat)], weight: f64) {
        for (index, link) in figure.links.iter().enumerate() {
            if let (Part::UpperArm(_) | Part::Forearm(_) | Part::Hand(_), Some(parent)) = (link.part, link.parent) {
                let turn = held[parent].1.inverse() * held[index].1;
                self.control.posture[index] = self.control.posture[index].slerp(turn, weight);
            }
        }
    }

    /// The arms of a walker hang, a little bent, and leave the swing to the gait.
    fn at_walk(&self, arms: [ArmAngles; 2]) -> [ArmAngles; 2] {
        let speed = if self.control.gait.walks() { self.control.gait.velocity().length() } else { 0.0 };
        let share = (speed / 0.5).min(1.0);
        let hang = relaxed_arms();
        let mix = |a: f64, b: f64| a + (b - a) * share;
        arms.map(|arm| ArmAngles {
            raise: mix(arm.raise, hang.raise),
            abduct: mix(arm.abduct, hang.abduct),
            inward: mix(arm.inward, hang.inward),
            elbow: mix(arm.elbow, hang.elbow + 0.2),
            ..arm
        })
    }

    /// Tells the arms how they would be held.
    fn pose_arms(&mut self, figure: &Figure, arms: &[ArmAngles; 2]) {
        let lean = DQuat::from_rotation_x(stand::TRUNK_LEAN);
        for side in Side::BOTH {
            let [upper, lower] = figure.arms[side as usize];
            let (wanted, relaxed) = (hung(side, &arms[side as usize]), hung(side, &relaxed_arms()));
            self.control.posture[upper] = lean * wanted * relaxed.inverse() * lean.inverse();
            if let crate::ragdoll::figure::Freedom::Hinge { axis, .. } = figure.links[lower].freedom {
                let bend = arms[side as usize].elbow - relaxed_arms().elbow;
                self.control.posture[lower] = DQuat::from_axis_angle(axis, bend);
            }
        }
    }
}

fn senses(tick: &TickState) -> Senses {
    Senses {
        acceleration: tick.acceleration,
        push: tick.push,
        push_moment: tick.push_moment,
        xi: tick.xi,
        velocity: DVec2::new(tick.velocity.x, tick.velocity.z),
        wanted: tick.walk,
        crouched: 0.0,
        on_one: false,
        feet: tick.feet,
        planted: tick.planted,
        facing: tick.facing,
    }
}
