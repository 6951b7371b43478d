//! The articulated body in the mirror: a scenario and its mirror image give clips that are each other's mirror image.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use crate::limits::{apart, twins};
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::model::scenario::{Carry, Direction, Feet, Ground, GroundKind, Push, Scenario, Stand, Throw, Turn, Walk};
use surefoot::model::{Body, BodyPose, Role, Side};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::{Rig, load};

/// m, that a joint may be off its twin's mirror image on a rig that is the same on both sides.
const MOST: f64 = 1e-6;

/// m, by which keys may leave a joint beside its way.
const KEYS: f64 = 1e-3;

fn play(rig: &Rig, scenario: &Scenario) -> Baked {
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    bake(rig, scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("it holds together")
}

/// A shove of so many N s for an adult, as large for each body; `degrees`: 90 is to its left.
fn shove(body: &Body, degrees: f64, impulse: f64) -> Push {
    let force = impulse * body.mass / 89.5 * (body.leg_length / 0.83).sqrt() / 0.2;
    Push { start: 0.6, duration: 0.2, force, toward: Direction::Heading(degrees.to_radians()), at: Role::Chest }
}

fn shoved(body: &Body, degrees: f64, impulse: f64) -> Scenario {
    Scenario { duration: 3.5, seed: 7, push: vec![shove(body, degrees, impulse)], ..Scenario::default() }
}

/// The foot, why, and the times (s) of each step: of the mirrored clip the other foot's.
fn steps(baked: &Baked, mirrored: bool) -> Vec<(Side, String, i64, i64)> {
    let own = |side: Side| if mirrored { side.other() } else { side };
    let tick = |time: f64| (time * 100.0).round() as i64;
    let steps = &baked.performance.trace.steps;
    steps.iter().map(|step| (own(step.side), format!("{:?}", step.kind), tick(step.lift), tick(step.land))).collect()
}

/// m, the farthest that a joint of one clip is from where the other's twin is in the mirror.
fn off(rig: &Rig, one: &Baked, other: &Baked) -> f64 {
    let twins = twins(&rig.body).expect("it is the same on both sides");
    let (mut ours, mut theirs) = (rig.sampler(&one.clip), rig.sampler(&other.clip));
    let frames = (one.report.duration * 60.0).floor() as usize;
    let at = |frame: usize| {
        let time = frame as f64 / 60.0;
        apart(&ours.sample(time).positions, &theirs.sample(time).positions, &twins)
    };
    (0..=frames).map(at).fold(0.0, f64::max)
}

/// m, the same of the runs that the clips were made of.
fn run_off(rig: &Rig, one: &Baked, other: &Baked) -> f64 {
    let twins = twins(&rig.body).expect("it is the same on both sides");
    let run = |baked: &Baked, time: f64| {
        let played = baked.performance.timeline.played.as_ref().expect("a run");
        played.run_at(time).positions(&rig.body)
    };
    let frames = (one.report.duration * 60.0).floor() as usize;
    let times = (0..=frames).map(|frame| frame as f64 / 60.0);
    times.map(|time| apart(&run(one, time), &run(other, time), &twins)).fold(0.0, f64::max)
}

#[track_caller]
fn are_images(rig: &Rig, what: &str, one: &Scenario, other: &Scenario) {
    let (one, other) = (play(rig, one), play(rig, other));
    let off = off(rig, &one, &other);
    println!("{what}: {:?}, {} steps, {:.2e} m", one.report.outcome, one.report.steps, off);
    assert_eq!(one.report.outcome, other.report.outcome, "{what}");
    assert_eq!(steps(&one, false), steps(&other, true), "{what}");
    assert_eq!(one.report.duration, other.report.duration, "{what}");
    let scores = [&one, &other].map(|baked| baked.report.plausibility.score);
    assert!((scores[0] - scores[1]).abs() < 1e-3, "{what}: {scores:?}");
    assert!(off < MOST, "{what}: {off} m");
}

#[test]
fn a_mirrored_shove_gives_the_mirrored_clip() {
    let rig = builtin();
    let all: Vec<(f64, f64)> =
        [30.0, 60.0, 90.0, 120.0, 150.0].iter().flat_map(|way| [50.0, 110.0].map(|size| (*way, size))).collect();
    all.par_iter().for_each(|(way, size)| {
        let of = |degrees: f64| shoved(&rig.body, degrees, *size);
        are_images(&rig, &format!("{size} N s towards {way}"), &of(*way), &of(360.0 - way));
    });
}

#[test]
fn whatever_else_goes_to_a_side_goes_to_the_other_in_the_mirror() {
    let rig = builtin();
    let body = &rig.body;
    let throw = |from: Direction, at: Role| {
        let (radius, spread) = ([0.1, 0.12], 0.1);
        let lane = Throw { start: 0.8, count: 3, interval: 0.3, radius, density: 400.0, speed: 9.0, from, at, spread };
        Scenario { throw: vec![lane], ..Scenario::default() }
    };
    let mass = vec![[0.0, 8.0]];
    let carry = Carry { start: 0.0, end: None, mass, size: vec![(0.0, glam::DVec3::new(0.4, 0.3, 0.3))] };
    let carrying = |degrees: f64| Scenario { carry: vec![carry.clone()], ..shoved(body, degrees, 60.0) };
    let ground = |kind: GroundKind, scenario: Scenario| Scenario { ground: Ground { kind, friction: 1.0 }, ..scenario };
    let slope = |degrees: f64| ground(GroundKind::Slope { angle: 0.12 }, shoved(body, degrees, 60.0));
    let platform = |sign: f64| {
        let roll = vec![[0.5, 0.0], [1.5, sign * 0.25], [2.5, 0.0]];
        ground(GroundKind::Platform { pitch: vec![[0.0, 0.0], [2.0, 0.1]], roll }, Scenario::default())
    };
    let walk = Walk { start: 0.2, duration: None, speed: 0.8, heading: 0.0, facing: None };
    let walking = |degrees: f64| {
        let push = Push { start: 2.0, ..shove(body, degrees, 40.0) };
        Scenario { walk: vec![walk], push: vec![push], ..Scenario::default() }
    };
    let turning = |heading: f64| Scenario { walk: vec![Walk { heading, ..walk }], ..Scenario::default() };
    let aslant = |heading: f64| Scenario {
        walk: vec![Walk { heading, speed: 0.5, facing: Some(0.0), ..walk }],
        ..Scenario::default()
    };
    let turned = |facing: f64| Scenario {
        turn: vec![Turn { start: 0.4, duration: None, facing }],
        duration: 4.0,
        ..Scenario::default()
    };
    let on_one = |on: Feet| Scenario {
        stand: vec![Stand { start: 0.4, duration: None, on }],
        push: vec![shove(body, 0.0, 15.0)],
        duration: 4.0,
        ..Scenario::default()
    };
    let arm = |at: Role| Scenario { push: vec![Push { at, ..shove(body, 0.0, 60.0) }], ..Scenario::default() };
    let vector = |x: f64| {
        let toward = Direction::Vector(glam::DVec3::new(x, 0.0, -1.0));
        Scenario { push: vec![Push { toward, ..shove(body, 0.0, 80.0) }], ..Scenario::default() }
    };
    let both = [
        ("balls", throw(Direction::Left, Role::Chest), throw(Direction::Right, Role::Chest)),
        (
            "balls at a shoulder",
            throw(Direction::Front, Role::LeftUpperArm),
            throw(Direction::Front, Role::RightUpperArm),
        ),
        ("a box", carrying(70.0), carrying(-70.0)),
        ("a slope", slope(100.0), slope(260.0)),
        ("a platform", platform(1.0), platform(-1.0)),
        ("a walk that is shoved", walking(90.0), walking(270.0)),
        ("a walk to the side", turning(0.6), turning(-0.6)),
        ("a walk aslant", aslant(0.8), aslant(-0.8)),
        ("a turn", turned(1.5), turned(-1.5)),
        ("one foot", on_one(Feet::Left), on_one(Feet::Right)),
        ("a shoulder", arm(Role::LeftUpperArm), arm(Role::RightUpperArm)),
        ("a vector", vector(0.7), vector(-0.7)),
        ("a fall", shoved(body, 80.0, 400.0), shoved(body, 280.0, 400.0)),
    ];
    both.par_iter().for_each(|(what, one, other)| are_images(&rig, what, one, other));
}

#[test]
fn rigs_that_nobody_here_made_do_in_the_mirror_what_they_do() {
    let Some(folder) = data::folder() else { return };
    for name in ["m2m_human_male.glb", "kaykit_Knight.glb"] {
        let rig = load(&folder.join("rigs").join(name)).expect("a rig");
        let alike = rig.body.is_alike(&rig.body.mirrored().0) && twins(&rig.body).is_some();
        println!("{name}: {}", if alike { "the same on both sides" } else { "its sides differ" });
        let all: Vec<(f64, f64)> =
            [45.0, 90.0, 135.0].iter().flat_map(|way| [60.0, 120.0].map(|size| (*way, size))).collect();
        all.par_iter().for_each(|(way, size)| {
            let of = |degrees: f64| play(&rig, &shoved(&rig.body, degrees, *size));
            let (one, other) = (of(*way), of(360.0 - way));
            let what = format!("{name}, {size} N s towards {way}");
            println!("{what}: {:?}", steps(&one, false));
            assert_eq!(one.report.outcome, other.report.outcome, "{what}");
            assert_eq!(steps(&one, false), steps(&other, true), "{what}");
            if alike {
                // Whether a key is set may hang on the micrometre by which the sides of such a rig differ: the clips are within what keys
                // may leave out, the runs that they are made of are images.
                let off = [run_off(&rig, &one, &other), off(&rig, &one, &other)];
                println!("{what}: {:.2e} m, by its keys {:.2e} m", off[0], off[1]);
                assert!(off[0] < 1e-5 && off[1] < KEYS, "{what}: {off:?} m");
            }
        });
    }
}

#[test]
fn a_scenario_and_its_image_are_played_as_one() {
    let body = builtin().body;
    let of = |ways: &[f64]| {
        let push = ways.iter().map(|way| shove(&body, *way, 50.0)).collect();
        Scenario { push, ..Scenario::default() }
    };
    for (one, other) in [
        (of(&[30.0]), of(&[330.0])),
        (of(&[-150.0]), of(&[150.0])),
        // At once: the first in the file counts.
        (of(&[40.0, 300.0]), of(&[320.0, 60.0])),
        // What is straight is the same in the mirror.
        (of(&[180.0, 90.0]), of(&[-180.0, -90.0])),
    ] {
        let ((one, turned), (other, returned)) = (one.to_the_left(), other.to_the_left());
        assert!(one == other && turned != returned, "{:?} and {:?}", one.push, other.push);
    }
    assert!(!of(&[0.0]).to_the_left().1 && !of(&[180.0]).to_the_left().1 && !of(&[]).to_the_left().1);
    // Rolling ground has no image that a scenario could name.
    let kind = GroundKind::Uneven { height: 0.05, wavelength: 2.0, seed: 1 };
    assert!(!Scenario { ground: Ground { kind, friction: 1.0 }, ..of(&[270.0]) }.to_the_left().1);
}

#[test]
fn a_body_that_is_seen_twice_in_the_mirror_is_itself() {
    let mut body = builtin().body;
    assert!(body.is_alike(&body.mirrored().0), "the built-in rig is the same on both sides");
    // A shorter arm, a heavier foot, and a thumb without a twin.
    for (role, by) in [(Role::LeftLowerArm, 0.03), (Role::LeftThumbProximal, 0.0)] {
        let joint = body.joint(role).expect("it has one");
        body.joints[joint].rest.x -= by;
    }
    let thumb = body.joint(Role::RightThumbProximal).expect("it has one");
    body.joints[thumb].role = Role::Jaw;
    let (image, twins) = body.mirrored();
    assert!(!body.is_alike(&image));
    assert!((0..twins.len()).all(|joint| twins[twins[joint]] == joint), "{twins:?}");
    let before = |(index, joint): (usize, &surefoot::model::BodyJoint)| joint.parent.is_none_or(|up| up < index);
    assert!(image.joints.iter().enumerate().all(before), "parents before children");
    let again = image.mirrored().0;
    assert!(again.is_alike(&body));
    for (one, other) in again.segments.iter().zip(&body.segments) {
        assert!(
            (one.joint, one.mass, one.centre, one.inertia) == (other.joint, other.mass, other.centre, other.inertia)
        );
    }
}

/// A body that is heavier and longer on one side is another one in the mirror: what comes back must be its own motion.
#[test]
fn a_lopsided_body_moves_as_its_own_masses_and_bones_do() {
    let mut rig = builtin();
    let arm = rig.body.joint(Role::LeftLowerArm).expect("an arm");
    for segment in rig.body.segments.iter_mut().filter(|segment| segment.joint == arm) {
        (segment.mass, segment.inertia) = (segment.mass + 4.0, segment.inertia * 3.0);
        segment.centre.x += 0.02;
        rig.body.mass += 4.0;
    }
    for degrees in [100.0, 260.0] {
        let baked = play(&rig, &shoved(&rig.body, degrees, 60.0));
        let run = &baked.performance.articulated.as_ref().expect("a ragdoll's").run;
        for (tick, pose) in run.trace.ticks.iter().zip(&run.poses).step_by(20) {
            let centre = pose.centre_of_mass(&rig.body, &pose.positions(&rig.body));
            assert!(centre.distance(tick.com) < 2e-3, "towards {degrees}: {centre} is not {}", tick.com);
        }
        let first = BodyPose::positions(&run.poses[0], &rig.body);
        let ankles = rig.body.feet.each_ref().map(|foot| first[foot.ankle]);
        assert!(ankles[0].x > 0.05 && ankles[1].x < -0.05, "{ankles:?}");
        let drift = baked.report.drift.expect("it is told");
        assert!(drift.position_mm <= 5.0 && drift.angle_deg <= 2.0, "towards {degrees}: {drift:?}");
    }
}
