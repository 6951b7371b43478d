//! The articulated body led by the stepper's plan on flat ground: walks, stops, turns, crouches, one foot; shoved in the midst of them.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use surefoot::maths::quat::{wrap_angle, yaw_of};
use surefoot::maths::seed::Seed;
use surefoot::measure::{KnownPush, PushPoint};
use surefoot::model::scenario::Feet;
use surefoot::model::{Body, Physique, Role, Terrain};
use surefoot::ragdoll::control::Assist;
use surefoot::sim::{Ahead, Articulated, ArticulatedOptions, Things, simulate_with};
use surefoot::stepper::{Inputs, StepKind};
use surefoot::whole_body::{Anatomy, stand};

/// s, when what is asked for begins.
const BEGINS: f64 = 0.5;

/// Runs what is meant, on its own, looking ahead as far as that.
fn play(
    body: &Body,
    duration: f64,
    effort: u8,
    pushes: &[KnownPush],
    intent: &(dyn Fn(f64) -> Inputs + Sync),
) -> Articulated {
    let anatomy = Anatomy::new(body);
    let physique: Physique = stand::physique(body, &anatomy);
    let ahead = Ahead { effort, ..Ahead::default() };
    let options = ArticulatedOptions { duration, extra: 0.0, ahead, ..ArticulatedOptions::default() };
    let pushes: Vec<(KnownPush, bool)> = pushes.iter().map(|push| (*push, false)).collect();
    let intent = |time: f64| Some(intent(time));
    let things = Things { intent: &intent, ..Things::none() };
    let run = simulate_with(body, &anatomy, &physique, &Terrain::flat(), &options, &pushes, Assist::default(), &things)
        .expect("the body does not break down");
    assert_eq!((run.help.torque, run.help.force), ([0.0; 2], [0.0; 2]));
    run
}

/// Walks that fast until `stop` s, that way (rad from where it faces); it turns at `turn` rad/s from 4 s on.
fn walking(speed: f64, way: f64, turn: f64, stop: f64) -> impl Fn(f64) -> Inputs + Sync {
    move |time: f64| {
        let facing = turn * (time - 4.0).max(0.0);
        let (sin, cos) = (facing + way).sin_cos();
        let walk = (BEGINS..stop).contains(&time).then(|| DVec2::new(sin, cos) * speed);
        Inputs { walk, facing, ..Inputs::default() }
    }
}

fn shove(body: &Body, start: f64, force: DVec3) -> KnownPush {
    let chest = body.joint(Role::Chest).expect("the built-in rig has a chest");
    KnownPush { start, end: start + 0.2, force, at: PushPoint::Joint(chest) }
}

/// N, that hard towards that heading.
fn towards(heading: f64, newtons: f64) -> DVec3 {
    DVec3::new(heading.sin(), 0.0, heading.cos()) * newtons
}

/// rad, the farthest that the pelvis turned from straight ahead.
fn strayed(run: &Articulated) -> f64 {
    run.poses.iter().map(|pose| yaw_of(pose.turns[0]).abs()).fold(0.0, f64::max)
}

/// m/s, (x, z), in the mean from a time (s) to the end.
fn velocity(run: &Articulated, from: f64) -> DVec2 {
    let ticks = &run.trace.ticks;
    let (first, last) = (&ticks[(from / run.trace.dt) as usize], &ticks[ticks.len() - 1]);
    let way = (last.com - first.com) / ((ticks.len() - 1) as f64 * run.trace.dt - from);
    DVec2::new(way.x, way.z)
}

#[test]
fn walks_for_a_minute_at_the_speed_that_is_asked() {
    let body = builtin().body;
    for wanted in [0.3, 0.6, 1.0, 1.2] {
        let run = play(&body, 62.0, 0, &[], &walking(wanted, 0.0, 0.0, f64::INFINITY));
        assert!(run.trace.lost.is_none(), "falls at {:?} s at {wanted} m/s", run.trace.lost);
        let (got, yaw) = (velocity(&run, 4.0).length(), strayed(&run).to_degrees());
        println!("{wanted} m/s: {got:.3}, its pelvis turns by {yaw:.0} degrees at most");
        assert!((got - wanted).abs() < 0.05 * wanted, "{got:.3} m/s for {wanted}");
        // Who falls by yaw goes beyond 90.
        assert!(yaw < 30.0, "its pelvis turns by {yaw:.0} degrees at {wanted} m/s");
    }
}

#[test]
fn walks_backwards_and_sideways() {
    let body = builtin().body;
    for (degrees, wanted) in [(180.0_f64, 0.3), (180.0, 0.5), (90.0, 0.3), (-90.0, 0.3), (45.0, 0.5)] {
        let way = degrees.to_radians();
        let run = play(&body, 20.0, 0, &[], &walking(wanted, way, 0.0, f64::INFINITY));
        assert!(run.trace.lost.is_none(), "falls at {:?} s, {degrees} degrees, {wanted} m/s", run.trace.lost);
        let got = velocity(&run, 5.0);
        let off = wrap_angle(got.x.atan2(got.y) - way).to_degrees();
        println!("{degrees} degrees, {wanted} m/s: {:.3} m/s, {off:.1} degrees off", got.length());
        assert!((got.length() - wanted).abs() < 0.1 * wanted && off.abs() < 5.0, "{got} for {wanted}, {degrees}");
        assert!(strayed(&run).to_degrees() < 30.0, "faces ahead");
    }
}

#[test]
fn stops_and_stands() {
    let body = builtin().body;
    for wanted in [0.5, 1.0, 1.2] {
        let run = play(&body, 14.0, 0, &[], &walking(wanted, 0.0, 0.0, 6.0));
        assert!(run.trace.lost.is_none(), "falls at {:?} s", run.trace.lost);
        assert!(run.trace.rest > 0.5, "still moves after {wanted} m/s");
        let ends = run.trace.ticks[run.trace.ticks.len() - 1];
        let apart = (ends.feet[0].ankle - ends.feet[1].ankle).z.abs();
        assert!(apart < 0.1, "one foot stands {apart:.2} m ahead of the other");
    }
}

#[test]
fn goes_on_walking_when_it_is_shoved() {
    let body = builtin().body;
    let mut stays = 0;
    for index in 0..16 {
        let force = towards((f64::from(index) * 22.5_f64).to_radians(), 100.0);
        let push = shove(&body, 6.0 + 0.07 * f64::from(index), force);
        let run = play(&body, 14.0, 0, &[push], &walking(1.2, 0.0, 0.0, f64::INFINITY));
        let goes_on = run.trace.lost.is_none() && velocity(&run, 12.0).length() > 1.0;
        stays += usize::from(goes_on);
    }
    assert!(stays >= 15, "{stays} of 16");
}

#[test]
fn who_is_shoved_in_a_walk_keeps_his_feet() {
    let body = builtin().body;
    let one = |index: u64| {
        let mut draw = Seed::new(9_000 + index);
        let force = towards(draw.between(0.0, std::f64::consts::TAU), draw.between(50.0, 250.0));
        let speed = if draw.between(0.0, 1.0) < 0.5 { 0.8 } else { 1.2 };
        let push = shove(&body, draw.between(5.0, 6.0), force);
        play(&body, 12.0, 1, &[push], &walking(speed, 0.0, 0.0, f64::INFINITY)).trace.lost.is_none()
    };
    let stays = (0..64).into_par_iter().filter(|index| one(*index)).count();
    println!("{stays} of 64 shoves of 10 to 50 Ns");
    assert!(stays >= 62, "{stays} of 64: 97 % are wanted");
}

#[test]
fn its_heading_turns_by_thirty_degrees_a_second() {
    let body = builtin().body;
    for side in [-1.0, 1.0] {
        let turn = side * 30.0_f64.to_radians();
        let run = play(&body, 16.0, 0, &[], &walking(1.0, 0.0, turn, f64::INFINITY));
        assert!(run.trace.lost.is_none(), "falls at {:?} s", run.trace.lost);
    }
}

#[test]
fn turns_on_the_spot_to_where_it_is_told() {
    let body = builtin().body;
    for (degrees, within) in [(30.0_f64, 1.5), (90.0, 1.5), (-90.0, 1.5), (170.0, 2.8)] {
        let wanted = degrees.to_radians();
        let facing = |time: f64| if time < 1.0 { 0.0 } else { wanted };
        let run = play(&body, 7.0, 0, &[], &|time| Inputs { facing: facing(time), ..Inputs::default() });
        assert!(run.trace.lost.is_none(), "falls at {:?} s", run.trace.lost);
        let (mut unwound, mut last, mut begun, mut done) = (0.0, 0.0, f64::INFINITY, 0.0);
        for (index, pose) in run.poses.iter().enumerate() {
            let (yaw, time) = (yaw_of(pose.turns[0]), index as f64 * run.trace.dt - 1.0);
            unwound += wrap_angle(yaw - last);
            last = yaw;
            begun = if time > 0.0 && unwound.abs() > 0.02 { time.min(begun) } else { begun };
            done = if (unwound - wanted).abs() > 3.0_f64.to_radians() { time } else { done };
        }
        println!("{degrees} degrees: begun after {begun:.2} s, done after {done:.2} s");
        assert!(begun < 0.4, "{degrees} degrees: begun after {begun} s");
        assert!(done < within, "{degrees} degrees: done after {done} s");
        assert!(run.trace.steps.iter().all(|step| step.kind != StepKind::Corrective), "nothing to catch");
    }
}

#[test]
fn stands_on_one_foot_while_it_is_pushed() {
    let body = builtin().body;
    for on in [Feet::Left, Feet::Right] {
        for index in 0..8 {
            let force = towards(f64::from(index) * std::f64::consts::FRAC_PI_4, 20.0);
            let pushes: Vec<_> = (0..4).map(|push| shove(&body, 5.0 + 4.0 * f64::from(push), force)).collect();
            let stand = |time: f64| if (1.0..22.0).contains(&time) { on } else { Feet::Both };
            let run = play(&body, 26.0, 0, &pushes, &|time| Inputs { stand: stand(time), ..Inputs::default() });
            assert!(run.trace.lost.is_none(), "{on:?} {index}: falls at {:?} s", run.trace.lost);
            let [held] = run.trace.steps[..] else { panic!("{on:?} {index}: {:?}", run.trace.steps) };
            assert!(held.kind == StepKind::Held && held.lift < 2.5 && held.land > 22.0, "{on:?} {index}: {held:?}");
            assert!(run.trace.rest > 1.0, "{on:?} {index}: stands on both again");
        }
    }
}

#[test]
fn crouches_as_low_as_it_is_told_and_rises_again() {
    let body = builtin().body;
    for amount in [0.1, 0.2] {
        let low = |time: f64| if (1.0..4.0).contains(&time) { amount } else { 0.0 };
        let run = play(&body, 7.0, 0, &[], &|time| Inputs { crouch: low(time), ..Inputs::default() });
        assert!(run.trace.lost.is_none(), "falls at {:?} s", run.trace.lost);
        let hips = |time: f64| run.poses[(time / run.trace.dt).round() as usize].hips.y;
        let lowered = hips(0.5) - hips(3.8);
        let wanted = amount * body.leg_length;
        assert!((lowered - wanted).abs() < 0.02, "{lowered:.3} m for {wanted:.3}");
        assert!((hips(0.5) - hips(6.8)).abs() < 0.02, "and up again");
        assert!(run.trace.steps.is_empty(), "{:?}", run.trace.steps);
        let upright = run.poses.iter().all(|pose| (pose.turns[0] * DVec3::Y).angle_between(DVec3::Y) < 0.6);
        assert!(upright && strayed(&run) < 0.2, "it stays upright and faces ahead");
    }
}
