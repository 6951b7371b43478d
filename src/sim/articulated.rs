//! A run of the articulated body under pushes, and the trace that it leaves: the same as the stepper's, read off the links.
//!
//! Scenario space, SI, 10 ms ticks. The arms are told what a pushed person's would do (`whole_body::reaction`) and do what
//! their joints let them. It stands, sways and steps; where balance is lost the joints give way and it falls until it lies.
//! On flat ground it walks. What breaks down is caught in the tick in which it does.

use super::Trace;
use super::balls::{Flown, Incoming};
use super::record::Record;
use super::retrace::Retrace;
use super::run::{self, Course, Run};
use super::search::{Ahead, Search, Searched};
use super::session::{DEEPEST, TICK};
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::measure::KnownPush;
use crate::model::scenario::GroundKind;
use crate::model::{Body, BodyPose, Load, Physique, Plant, Role, Side, Terrain};
use crate::ragdoll::control::Assist;
use crate::ragdoll::{Figure, Locks, crouch, slope};
use crate::stepper::{Inputs, Style};
use crate::whole_body::reaction::Personality;
use crate::whole_body::solve::{Hold, PoseTarget};
use crate::whole_body::{Anatomy, ArmAngles, Solver, stand};
use glam::{DQuat, DVec2, DVec3};

/// Share of the leg by which who walks some time, or stands off level ground, crouches at the most: with half of the leg short ones go backwards,
/// or fall.
const LOW: f64 = 0.3;
/// Share of the standing height under which the centre of mass has fallen (DESIGN, "fallen").
const FALLEN: f64 = 0.57;
/// And the share from which on who is falling lets himself fall.
const GIVES_WAY: f64 = 0.82;
/// The share under which a snapshot is kept at every tick: a fall may begin there.
const SINKS: f64 = 0.95;
/// s at rest, after which a run that goes on past what was asked ends.
const RESTS: f64 = 0.5;

/// Sines of a knee's bend: less bent, it does not tell its axis; more, it does.
const STRAIGHT: [f64; 2] = [0.1, 0.3];

/// How to run the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArticulatedOptions {
    /// s; it goes on to the next tick.
    pub duration: f64,
    /// s, at most so much longer if it is not at rest by then.
    pub extra: f64,
    /// s, the length of a tick.
    pub dt: f64,
    /// What is the person's own.
    pub personality: Personality,
    /// 0 to 1, how much its arms do.
    pub arms: f64,
    /// What it draws from.
    pub seed: u64,
    /// How the plan that leads it is tuned.
    pub style: Style,
    /// How it is looked for.
    pub ahead: Ahead,
}

impl Default for ArticulatedOptions {
    fn default() -> ArticulatedOptions {
        ArticulatedOptions {
            duration: 4.0,
            extra: 8.0,
            dt: TICK,
            personality: Personality::default(),
            arms: 0.5,
            seed: 0,
            style: Style::default(),
            ahead: Ahead::default(),
        }
    }
}

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
    /// What was looked for ahead, and found.
    pub search: Searched,
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
    options: &ArticulatedOptions,
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
    /// What is meant at a time (s), where the stepper's plan is to lead the body.
    pub intent: &'a dyn Fn(f64) -> Option<Inputs>,
    /// What it does at ease, where that is not the natural stand.
    pub ease: Option<Ease<'a>>,
}

/// What a body does at ease: it begins so, and goes back to it.
pub struct Ease<'a> {
    /// How it begins, its soles flat on the ground.
    pub stand: BodyPose,
    /// Where its feet are then.
    pub plants: [Plant; 2],
    /// How it stands while it fights for its balance.
    pub natural: BodyPose,
    /// The pose at a time (s) and its centre of mass, m, where it has not moved.
    pub goal: &'a dyn Fn(f64) -> (BodyPose, DVec3),
}

impl Things<'_> {
    /// Nothing.
    pub fn none() -> Self {
        Things { incoming: &[], loads: &[], hold: &|_| None, intent: &|_| None, ease: None }
    }
}

/// The same with balls that come at it and boxes in its hands.
#[expect(clippy::too_many_arguments, reason = "all that a run depends on")]
pub fn simulate_with(
    body: &Body,
    anatomy: &Anatomy,
    physique: &Physique,
    terrain: &Terrain,
    options: &ArticulatedOptions,
    pushes: &[(KnownPush, bool)],
    assist: Assist,
    things: &Things,
) -> Result<Articulated, BrokenBody> {
    let natural = stand::natural_plants(physique.stance_width, physique.com_forward);
    let plants = things.ease.as_ref().map_or(natural, |ease| ease.plants);
    let level = stand::natural_stand(body, physique);
    let standing = match &things.ease {
        Some(ease) => ease.stand.clone(),
        None => Solver::new(body, anatomy).solve(&level).pose,
    };
    let figure = match &things.ease {
        Some(ease) => {
            let knees = knees(body, anatomy, &ease.stand, &ease.plants);
            let plain = untwisted(body, anatomy, &ease.stand, &knees);
            let mut figure = Figure::with_knees(body, &plain, Locks::default(), Some(knees));
            figure.stand = ease.stand.clone();
            figure
        }
        None => Figure::new(body, &standing, Locks::default()),
    };
    let target = (things.hold)(0.0).map_or(level, |hold| level.holding(hold));
    let goes = run::goes(things, options.duration);
    let leg = physique.leg_length;
    let walks = run::walks(things, options.duration);
    let deepest = match (walks, terrain.is_flat()) {
        (true, _) => crouch::deepest(&figure, LOW * leg) / leg,
        (false, true) => DEEPEST,
        (false, false) => LOW,
    };
    let course = Course {
        figure: &figure,
        body,
        anatomy,
        physique,
        terrain,
        pushes,
        things,
        level,
        start: plants,
        goes,
        deepest,
    };
    let first = match &things.ease {
        Some(ease) => ease.stand.clone(),
        None if course.crouched() > 0.0 => low(&course, &standing, &target),
        None => on_ground(body, anatomy, physique, terrain, &plants, &target)
            .unwrap_or_else(|| Solver::new(body, anatomy).solve(&target).pose),
    };
    let mut run = Run::new(&course, &first, options)?;
    run.control.assist = assist;
    play(&course, run, options)
}

/// The run from its start to its end.
fn play(course: &Course, mut run: Run, options: &ArticulatedOptions) -> Result<Articulated, BrokenBody> {
    let planned = (options.duration / options.dt - 1e-9).ceil().max(0.0) as usize;
    let most = planned + (options.extra / options.dt).ceil() as usize;
    let mut record = Record::new(course.start, course.figure, options.dt);
    let mut search = Search::new(options);
    let (mut sinking, mut lost): (Option<(usize, Run)>, _) = (None, None);
    let mut retrace = (course.led() && options.ahead.effort > 0).then(|| Retrace::new(course, options.dt));
    let mut tick = 0;
    while tick <= most {
        let time = tick as f64 * options.dt;
        if tick > planned && run.rest >= RESTS {
            break;
        }
        if let Some(retrace) = &mut retrace {
            retrace.keep(&run, tick);
        }
        let before = search.may_decide(&run, time).then(|| run.clone());
        let mut ticked = run.tick(course, time);
        if let Some(before) = before.filter(|_| search.decides(&run, time))
            && let Some(tuning) = search.better(course, &before, time)
        {
            run = before;
            run.control.tuning = tuning;
            ticked = run.tick(course, time);
        }
        record.tick(course, &run.control, &ticked, time);
        let gives_up = options.ahead.gives_up.is_some_and(|when| time >= when - 1e-9);
        let falls = ticked.lies || ticked.height < FALLEN;
        if let Some(retrace) = retrace.as_mut().filter(|_| !gives_up)
            && let Some(back) = retrace.back(&mut search, course, (&run, &ticked), (tick, falls))
        {
            ((tick, run), sinking) = (back, None);
            record.cut(tick);
            continue;
        }
        if falls || gives_up {
            // Nobody fights until he lies: seen from the end, the joints give way as soon as the body sinks for good, or where it meets a stair
            // before it sinks.
            let (last, mut from) = sinking.take().filter(|_| !gives_up).unwrap_or((tick, run));
            record.cut(last + 1);
            lost = Some(last as f64 * options.dt);
            from.fall(course, last, &mut record.poses)?;
            run = from;
            break;
        }
        if ticked.height >= SINKS {
            sinking = None;
        } else if ticked.height > GIVES_WAY {
            sinking = Some((tick, run.clone()));
        }
        run.go_on(course, time)?;
        tick += 1;
    }
    let rest = if lost.is_some() { 0.0 } else { run.rest };
    let (balls, acting) = (run.balls.finish(), run.acting);
    let made = record.finish(options.dt, acting, (lost, rest), course.terrain, options.duration);
    Ok(Articulated { joints: course.figure.joints(), balls, search: search.done(), ..made })
}

/// The axes that the knees bend about in a pose, left and right: as they are bent; of a leg that is almost straight, across its foot. What
/// thighs are turned about their own length says nothing: clips have it by a right angle and more.
fn knees(body: &Body, anatomy: &Anatomy, pose: &BodyPose, plants: &[Plant; 2]) -> [DVec3; 2] {
    let positions = pose.positions(body);
    Side::BOTH.map(|side| {
        let leg = &anatomy.legs[side as usize];
        let [hip, knee, ankle] = [leg.upper, leg.lower, leg.foot].map(|joint| positions[joint]);
        let square = (knee - hip).normalize_or_zero().cross((ankle - knee).normalize_or_zero());
        let line = (ankle - hip).normalize_or(DVec3::NEG_Y);
        let across = DQuat::from_rotation_y(plants[side as usize].yaw) * DVec3::X;
        let across = (across - line * across.dot(line)).normalize_or(DVec3::X);
        let bent = smooth3((square.length() - STRAIGHT[0]) / (STRAIGHT[1] - STRAIGHT[0]));
        let own = if square.dot(across) > 0.0 { square.normalize_or(across) } else { across };
        across.lerp(own, bent).normalize_or(across)
    })
}

/// A pose whose thighs and shanks are turned about their own length so that their hinges are those of the knees: how far hips and ankles go
/// is measured by them.
fn untwisted(body: &Body, anatomy: &Anatomy, pose: &BodyPose, knees: &[DVec3; 2]) -> BodyPose {
    let positions = pose.positions(body);
    let mut plain = pose.clone();
    for (leg, knee) in anatomy.legs.iter().zip(knees) {
        let bones = [(leg.upper, leg.lower, leg.thigh_from_rest), (leg.lower, leg.foot, leg.shank_from_rest)];
        for (joint, next, from_rest) in bones {
            let along = (positions[next] - positions[joint]).normalize_or(DVec3::NEG_Y);
            let hinge = pose.turns[joint] * from_rest.inverse() * DVec3::X;
            let [hinge, wanted] = [hinge, *knee].map(|axis| axis - along * axis.dot(along));
            let by = real::atan2(hinge.cross(wanted).dot(along), hinge.dot(wanted));
            plain.turns[joint] = (DQuat::from_axis_angle(along, by) * pose.turns[joint]).normalize();
        }
    }
    plain
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
    target.com = match terrain.kind {
        GroundKind::Mesh { .. } => level.com + DVec3::Y * base,
        _ => DVec3::Y * (physique.com_height + base),
    };
    let normals = plants.map(|plant| ground.spot(DVec2::new(plant.ankle.x, plant.ankle.z)).normal);
    uphill(body, anatomy, terrain, (normals[0] + normals[1]).normalize_or(DVec3::Y), &mut target);
    Some(Solver::new(body, anatomy).solve(&target).pose)
}

/// The stand on level ground with the pelvis as low and leant as it begins.
fn low(course: &Course, standing: &BodyPose, level: &PoseTarget) -> BodyPose {
    let by = course.crouched() * course.physique.leg_length;
    let leans = slope::lowered(course.figure, course.terrain, by, course.goes);
    let lean = DQuat::from_rotation_x(leans);
    // Arms hang.
    let arms = level.arms.map(|arm| ArmAngles { raise: arm.raise + leans, ..arm });
    let mut target = PoseTarget { pelvis: level.pelvis * lean, chest: level.chest * lean, arms, ..*level };
    let mut solver = Solver::new(course.body, course.anatomy);
    let (mut lowest, mut highest) = (0.3 * level.com.y, level.com.y);
    for _ in 0..30 {
        target.com.y = 0.5 * (lowest + highest);
        if solver.solve(&target).pose.hips.y > standing.hips.y - by {
            highest = target.com.y
        } else {
            lowest = target.com.y
        }
    }
    solver.solve(&target).pose
}

/// Share of a leg's length that a stand uses, as on level ground ([`stand::physique`]).
const STRETCHED: f64 = 0.992;

/// Leans a stand on ground with that unit normal as the law does, at the height at which its legs are as straight as they are to be.
fn uphill(body: &Body, anatomy: &Anatomy, terrain: &Terrain, normal: DVec3, target: &mut PoseTarget) {
    let rise = slope::rise(normal, 0.0);
    if rise <= 0.0 {
        return;
    }
    let lean = DQuat::from_rotation_x(slope::lean(rise));
    (target.pelvis, target.chest) = (target.pelvis * lean, target.chest * lean);
    let leg = anatomy.legs.each_ref().map(|leg| leg.length());
    let sole = &body.feet[0];
    target.com.z -= slope::back(terrain, rise) * (sole.foremost() - sole.heel);
    let mut solver = Solver::new(body, anatomy);
    let (mut low, mut high) = (0.7 * target.com.y, 1.05 * target.com.y);
    for _ in 0..30 {
        target.com.y = 0.5 * (low + high);
        let hips = solver.solve(target).hips;
        let used = [0, 1].map(|side: usize| hips[side].distance(target.feet[side].ankle) / leg[side]);
        if used[0].max(used[1]) > STRETCHED { high = target.com.y } else { low = target.com.y }
    }
}
