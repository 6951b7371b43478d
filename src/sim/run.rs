//! The articulated body on its way: its world, its law and its arms, tick by tick. Scenario space, SI. A copy goes its own way.

use super::articulated::{BrokenBody, Things};
use super::balls::Balls;
use super::homeward::Homeward;
use super::pilot::Pilot;
use super::record::{hung, state_of};
use super::{ArticulatedOptions, SessionPush, TickState};
use crate::maths::curve::smooth3;
use crate::maths::quat::yaw_of;
use crate::measure::{KnownPush, PushPoint};
use crate::model::scenario::{Feet, Trigger};
use crate::model::{Body, BodyPose, Load, Physique, Plant, Side, Terrain};
use crate::ragdoll::control::Report;
use crate::ragdoll::figure::Part;
use crate::ragdoll::{Controller, Figure, LinkState, Stance, Tuning, World, fall};
use crate::stepper::Inputs;
use crate::whole_body::reaction::{Personality, Reaction, Senses, upper_turns};
use crate::whole_body::solve::PoseTarget;
use crate::whole_body::stand::relaxed_arms;
use crate::whole_body::{Anatomy, ArmAngles, Solver, stand};
use glam::{DQuat, DVec2, DVec3};

/// In how many parts the world takes a tick.
const PARTS: usize = 2;
/// s, the longest that a fall goes on, and for how long no link may be faster than that (m/s) for it to be over.
const LONGEST_FALL: f64 = 2.5;
const LIES: (f64, f64) = (0.3, 0.08);
/// m/s, slower it rests.
const RESTS: f64 = 0.05;
/// s at legs of 0.83 m after the last push and the last step against a fall: from when on a body feels safe, and when it does in full.
/// With how long alarm and arms take to fade, arms are down within a second, as people's are.
const SAFE: [f64; 2] = [0.1, 0.4];
/// s at legs of 0.83 m, in which who fights for his balance leaves what he did at ease, and goes back to it.
const FIGHTS: f64 = 0.15;
const CALMS: f64 = 1.0;
/// The same of who sets out from it as he is asked to: in 0.15 s who stands low is thrown up.
const SETS_OUT: f64 = 0.6;
/// Of the kinematic body's time, what arms take to come down: these have to be moved, which takes time of its own.
const LOWERS: f64 = 0.6;
/// s, for which nothing has been asked of who goes back to a stance, and no plan has led him, before he does.
const DONE: f64 = 0.3;
/// s at legs of 0.83 m after a push, for which the arms of who is not home fight for his balance.
const STRUCK: f64 = 2.0;
/// rad: an arm that a clip holds so far from how it hangs does not swing.
const HELD: f64 = 0.5;

/// What does not change in a run.
pub(super) struct Course<'a> {
    pub(super) figure: &'a Figure,
    pub(super) body: &'a Body,
    pub(super) anatomy: &'a Anatomy,
    pub(super) physique: &'a Physique,
    pub(super) terrain: &'a Terrain,
    pub(super) pushes: &'a [(KnownPush, bool)],
    pub(super) things: &'a Things<'a>,
    /// The stand on level ground.
    pub(super) level: PoseTarget,
    /// Where the feet stand at first.
    pub(super) start: [Plant; 2],
    /// Whether it is to walk, turn or stand on one foot some time: in a crouch its trunk leans for that.
    pub(super) goes: bool,
    /// Share of its leg by which it crouches at the most: who is to walk some time no lower than his ankles allow.
    pub(super) deepest: f64,
}

/// s, between the times at which it is asked what is meant.
const ASKED: f64 = 0.05;

/// Is anything meant until `duration` (s) that takes steps or lifts a foot?
pub(super) fn goes(things: &Things, duration: f64) -> bool {
    let first = (things.intent)(0.0).map_or(0.0, |intent| intent.facing);
    walks(things, duration) || meant(things, duration, |intent| intent.facing != first || intent.stand != Feet::Both)
}

/// Is it to walk until `duration` (s)?
pub(super) fn walks(things: &Things, duration: f64) -> bool {
    meant(things, duration, |intent| intent.walk.is_some_and(|walk| walk != DVec2::ZERO))
}

fn meant(things: &Things, duration: f64, is: impl Fn(&Inputs) -> bool) -> bool {
    (0..=(duration / ASKED).ceil().max(0.0) as usize)
        .any(|index| (things.intent)(ASKED * index as f64).is_some_and(|intent| is(&intent)))
}

impl Course<'_> {
    /// Does the stepper's plan lead it, when there is something to do?
    pub(super) fn led(&self) -> bool {
        (self.things.intent)(0.0).is_some()
    }

    /// Share of its leg by which it stands lower when it begins.
    pub(super) fn crouched(&self) -> f64 {
        (self.things.intent)(0.0)
            .filter(|_| self.terrain.is_flat())
            .map_or(0.0, |intent| intent.crouch.min(self.deepest))
    }
}

/// The body and all that changes with it.
#[derive(Clone)]
pub(super) struct Run {
    pub(super) world: World,
    pub(super) control: Controller,
    pub(super) balls: Balls,
    /// The pushes, turned the way that it faced when they began.
    pub(super) acting: Vec<SessionPush>,
    /// s, for how long it has been at rest.
    pub(super) rest: f64,
    states: Vec<LinkState>,
    carried: Option<usize>,
    reaction: Reaction,
    pilot: Pilot,
    homeward: Homeward,
    felt: DVec3, // N, what pushed it in the last tick
    velocity: Option<DVec3>,
    pushed: f64,        // s, when something last pushed it
    faces: Option<f64>, // rad, where it was asked to face lately
    asked: f64,         // s, for how long nothing has been asked of it
    natural: f64,       // 0 at ease as it is told, 1 on its legs as in the natural stand
    fights: f64,        // the same of its arms, which fight for its balance only if something pushes it
}

/// What a tick knows before the world goes on.
pub(super) struct Ticked {
    pub(super) state: TickState,
    pub(super) report: Report,
    pub(super) pose: BodyPose,
    /// N s, by the ground in the last tick, left and right.
    pub(super) pressed: [f64; 2],
    pub(super) ground: Terrain,
    /// More than its feet is on the ground.
    pub(super) lies: bool,
    /// The centre of mass over the ground, of its height in a stand, or a crouch, as low as it is to be.
    pub(super) height: f64,
}

fn pose_of(figure: &Figure, states: &[LinkState]) -> BodyPose {
    let placed: Vec<(DVec3, DQuat)> = states.iter().map(|state| (state.origin, state.turn)).collect();
    figure.pose(&placed)
}

/// The law's dials of a person: how soon, how far, how high and with which foot one steps. No farther apart than that all keep their feet
/// about alike: of 16 people's 24 clips each of 100 to 180 Ns without looking ahead 89 % stand, as where all are the same. What costs
/// balance is a foot that is preferred by more than a few centimetres, together with slower steps; what makes them march on the spot is a
/// step that always lands ahead of where it should.
fn tuning_of(person: &Personality) -> Tuning {
    let mut tuning = Tuning::default();
    tuning.step.times.iter_mut().for_each(|time| *time *= 1.0 + 0.1 * person.arms_delay);
    tuning.trigger += 0.02 * person.trunk_gain;
    tuning.step.outside += 0.06 * person.far_arm;
    tuning.lift[0] *= 1.0 + 0.15 * person.head_gain;
    tuning.step.nudge[0] = 0.03 * person.far_arm;
    tuning.step.along += 0.05 * person.arms_gain;
    tuning.step.reach += 0.02 * (person.head_gain + person.trunk_gain);
    tuning.step.left = 0.03 * person.elbow;
    tuning
}

impl Run {
    pub(super) fn new(course: &Course, standing: &BodyPose, options: &ArticulatedOptions) -> Result<Run, BrokenBody> {
        let figure = course.figure;
        let world = World::new(figure, &figure.placed(course.body, standing), course.terrain, options.dt, PARTS)
            .map_err(|error| BrokenBody { time: 0.0, what: error.to_string() })?;
        let mut control = Controller::new(figure, &world, tuning_of(&options.personality));
        control.stands_on(figure, course.terrain);
        control.goes = course.goes;
        control.projected = options.style.variant.trigger == Trigger::Projected;
        control.stands_low(figure, course.terrain, course.crouched() * course.physique.leg_length);
        if course.things.ease.is_some() {
            let splay = course.start.map(|plant| plant.yaw);
            control.stance =
                Some(Stance::of(&mut control, figure, splay, (course.physique.com_forward, course.physique.toe_out)));
        }
        let act = |(push, turns): &(KnownPush, bool)| SessionPush {
            start: push.start,
            duration: push.end - push.start,
            force: push.force,
            turns: *turns,
            arm: 0.0,
        };
        Ok(Run {
            states: control.states().to_vec(),
            world,
            control,
            balls: Balls::default(),
            acting: course.pushes.iter().map(act).collect(),
            rest: 0.0,
            carried: None,
            reaction: Reaction::new(course.physique, options.personality, options.arms).unhurried(LOWERS),
            pilot: Pilot::new(course, &options.style, options.dt),
            homeward: Homeward::default(),
            felt: DVec3::ZERO,
            velocity: None,
            pushed: f64::NEG_INFINITY,
            faces: None,
            asked: DONE,
            natural: 0.0,
            fights: 0.0,
        })
    }

    /// The law's part of a tick: it reads the world, decides, drives; pushes act, arms are told.
    pub(super) fn tick(&mut self, course: &Course, time: f64) -> Ticked {
        let (figure, things, dt) = (course.figure, course.things, self.world.dt);
        self.world.clear_forces();
        let ground = course.terrain.held_at(time);
        let laden = self.carry(figure, course.body, things.loads, time);
        let model = laden.as_ref().unwrap_or(figure);
        let intent = (things.intent)(time);
        if intent.is_some() || things.ease.is_some() {
            self.control.sense(model, &self.world);
        }
        let asked = intent.filter(|intent| self.asks(intent, dt));
        match (asked, things.ease.is_some()) {
            (Some(asked), _) => self.pilot.lead(course, &mut self.control, &asked, self.felt),
            (None, true) => {
                if intent.is_some() {
                    self.pilot.rest(course, &mut self.control, self.felt);
                }
                self.homeward.lead(course, &mut self.control, dt);
            }
            (None, false) => {}
        }
        let report = self.control.tick(model, &mut self.world, &ground);
        let pressed = figure.legs.map(|leg| self.world.pressed(leg[2]));
        let facing = yaw_of(self.control.states()[0].turn);
        for push in self.acting.iter_mut().filter(|push| push.turns && push.start < time + dt - 1e-9) {
            push.force = DQuat::from_rotation_y(facing) * push.force;
            push.turns = false;
        }
        let (force, moment) = self.push(course, time, report.com);
        let (hit, hit_moment) = self.balls.felt(report.com, dt);
        let before = self.velocity.replace(report.velocity).unwrap_or(report.velocity);
        let pushed = (force + hit, moment + hit_moment);
        self.felt = pushed.0;
        let mut state = state_of(course, &self.control, &report, pushed, (report.velocity - before) / dt, &ground);
        state.barred = self.pilot.barred();
        if let Some((gait, walk)) = self.pilot.gait() {
            (state.gait, state.walk) = (gait, walk);
        }
        if pushed.0 != DVec3::ZERO {
            self.pushed = time;
        }
        let senses = Senses { safe: self.safe(time), ..state.senses(false) };
        let angles = self.reaction.tick(&senses, dt);
        let (_, _, _, arms) = upper_turns(&angles);
        self.pose_arms(figure, &self.at_walk(arms));
        self.at_ease(course, time + dt);
        if let Some(hold) = (things.hold)(time + dt) {
            let held = Solver::new(course.body, course.anatomy).solve(&course.level.holding(hold)).pose;
            self.pose_held(figure, &figure.placed(course.body, &held), hold.weight);
        }
        let rests = self.control.swing.is_none() && report.velocity.length() < RESTS;
        self.rest = if rests { self.rest + dt } else { 0.0 };
        let over = report.com.y - ground.spot(DVec2::new(report.com.x, report.com.z)).height;
        Ticked {
            state,
            report,
            pose: pose_of(figure, self.control.states()),
            pressed,
            lies: self.world.lies_on(figure, self.control.states(), &ground).is_some(),
            height: over / (course.physique.com_height - self.control.lower),
            ground,
        }
    }

    /// Is it led: does it walk, turn or stand on one foot?
    pub(super) fn goes(&self) -> bool {
        self.pilot.gait().is_some()
    }

    /// Is something asked of it that the plan leads? Who has a stance to go back to is led by it only as long as that takes.
    fn asks(&mut self, intent: &Inputs, dt: f64) -> bool {
        let Some(stance) = &mut self.control.stance else { return true };
        let turned = self.faces.replace(intent.facing).is_some_and(|before| before != intent.facing);
        let asks = turned || intent.walk.is_some_and(|walk| walk != DVec2::ZERO) || intent.stand != Feet::Both;
        self.asked = if asks { 0.0 } else { self.asked + if self.pilot.gait().is_some() { 0.0 } else { dt } };
        stance.left = self.asked < DONE;
        stance.left
    }

    /// How sure it is of its balance, 0 to 1.
    fn safe(&self, time: f64) -> f64 {
        let since = (time - self.pushed).min(self.control.at_ease());
        let [from, to] = SAFE.map(|safe| safe * self.control.tempo());
        smooth3((since - from) / (to - from))
    }

    /// The world's part: balls are let loose, everything moves.
    pub(super) fn go_on(&mut self, course: &Course, time: f64) -> Result<(), BrokenBody> {
        let velocity = self.control.report.velocity;
        let facing = yaw_of(self.control.states()[0].turn);
        let now = (time, facing, velocity);
        self.balls.launch(course.figure, course.body, course.things.incoming, &self.states, &mut self.world, now);
        self.step(course, time)?;
        self.balls.watch(course.figure, course.body, &self.states, &self.world, time + self.world.dt);
        Ok(())
    }

    /// One tick of the world from `time` on, and a look at whether it still holds together.
    pub(super) fn step(&mut self, course: &Course, time: f64) -> Result<(), BrokenBody> {
        let after = time + self.world.dt;
        self.world.step(course.terrain, after);
        self.world.read(&mut self.states);
        let broken = World::broken(course.figure, &self.states);
        match broken.or_else(|| self.world.broken_ball()) {
            Some(what) => Err(BrokenBody { time: after, what }),
            None => Ok(()),
        }
    }

    /// Balance is lost at that tick: the body comes down with its joints relaxed until it lies.
    pub(super) fn fall(&mut self, course: &Course, tick: usize, poses: &mut Vec<BodyPose>) -> Result<(), BrokenBody> {
        let dt = self.world.dt;
        self.world.read(&mut self.states);
        let mut lies = 0.0;
        for fallen in 0..(LONGEST_FALL / dt).round() as usize {
            self.world.clear_forces();
            fall::relax(course.figure, &mut self.world, &self.states, fallen as f64 * dt);
            self.step(course, (tick + fallen) as f64 * dt)?;
            let time = (tick + fallen + 1) as f64 * dt;
            self.balls.watch(course.figure, course.body, &self.states, &self.world, time);
            poses.push(pose_of(course.figure, &self.states));
            let fastest = self.states.iter().map(|state| state.velocity.length()).fold(0.0, f64::max);
            lies = if fastest < LIES.1 { lies + dt } else { 0.0 };
            if lies >= LIES.0 {
                break;
            }
        }
        Ok(())
    }

    /// Lets the pushes act on their links for the coming tick; their sum, and its moment about the centre of mass.
    fn push(&mut self, course: &Course, time: f64, com: DVec3) -> (DVec3, DVec3) {
        let (figure, dt) = (course.figure, self.world.dt);
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (push, (known, _)) in self.acting.iter().zip(course.pushes) {
            let covered = (push.start + push.duration).min(time + dt) - push.start.max(time);
            let share = (covered / dt).clamp(0.0, 1.0);
            if share < 1e-9 {
                continue;
            }
            let states = self.control.states();
            let placed = |joint: usize, offset: DVec3| {
                let link = figure.link_of[joint];
                let rest = figure.joint_in_link(course.body, joint) + figure.stand.turns[joint] * offset;
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
                let (mass, form) = (load.mass_at(time), load.form_at(time));
                self.world.take_up(figure, form.size, mass, joint + turn * form.centre, turn * load.level);
            }
        }
        let load = &loads[due?];
        let (mass, form) = (load.mass_at(time), load.form_at(time));
        self.world.reshape(form.size, form.wrists);
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

    /// How far it walks, 0 to 1.
    fn walks(&self) -> f64 {
        let speed = self.pilot.gait().map_or(0.0, |(_, velocity)| velocity.length());
        (speed / 0.5).min(1.0)
    }

    /// The arms of a walker hang, a little bent, and leave the swing to the gait.
    fn at_walk(&self, arms: [ArmAngles; 2]) -> [ArmAngles; 2] {
        let share = self.walks();
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

    /// Tells the body how it is at ease then; arms react from there.
    fn at_ease(&mut self, course: &Course, time: f64) {
        let Some(ease) = &course.things.ease else { return };
        let (figure, (pose, com)) = (course.figure, (ease.goal)(time));
        let [dt, tempo] = [self.world.dt, self.control.tempo()];
        // Who only sways stays as he is: to rise out of a crouch in that time would throw him.
        let led = self.control.stance.as_ref().is_some_and(|stance| stance.left) && self.goes();
        let home = self.control.is_home(figure);
        let over = match home {
            true => -CALMS,
            false if led => SETS_OUT,
            false => FIGHTS,
        };
        self.natural = (self.natural + dt / (over * tempo)).clamp(0.0, 1.0);
        // Who goes where he is asked to, or back, goes on with what the clip does with his arms.
        let fights = !home && !led && time - self.pushed < STRUCK * tempo;
        let over = if fights { FIGHTS } else { -CALMS };
        self.fights = (self.fights + dt / (over * tempo)).clamp(0.0, 1.0);
        let [share, upper] = [self.natural, self.fights].map(smooth3);
        let walks = self.walks();
        let clip = figure.placed(course.body, &pose);
        let natural = figure.placed(course.body, &ease.natural);
        let height = clip[0].0.y + (natural[0].0.y - clip[0].0.y) * share;
        let pelvis = clip[0].1.slerp(natural[0].1, share);
        for (index, link) in figure.links.iter().enumerate() {
            let Some(parent) = link.parent else { continue };
            let local = |placed: &[(DVec3, DQuat)]| placed[parent].1.inverse() * placed[index].1;
            let [own, wanted] = [&clip, &natural].map(|placed| local(placed));
            match link.part {
                Part::UpperArm(_) | Part::Forearm(_) => {
                    let own = own.slerp(wanted, upper);
                    let held = walks * smooth3(own.angle_between(wanted) / HELD);
                    self.control.posture[index] = self.control.posture[index].slerp(DQuat::IDENTITY, held) * own;
                }
                Part::Hand(_) => self.control.posture[index] = own.slerp(wanted, upper),
                Part::Trunk | Part::Head => {
                    let [own, above] = [index, parent].map(|link| clip[link].1.slerp(natural[link].1, share));
                    self.control.posture[index] = above.inverse() * own;
                }
                _ => {}
            }
        }
        if let Some(stance) = &mut self.control.stance {
            stance.rest_at(com, 1.0 - share);
            (stance.pelvis, stance.higher) = (pelvis, height - figure.links[0].anchor.y);
        }
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
