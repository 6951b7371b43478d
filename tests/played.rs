//! Clips of the articulated body are its runs: joints, outcome and footfalls, read from the keys, against what the body did.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use crate::data;
use glam::DVec3;
use rayon::prelude::*;
use surefoot::bake::contacts::FootContact;
use surefoot::bake::gated::FALLS;
use surefoot::bake::played::drift::{self, Drift};
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake, perform_by};
use surefoot::maths::seed::Seed;
use surefoot::model::report::{Outcome, Part};
use surefoot::model::scenario::{Direction, Ground, GroundKind, Push, Scenario, Walk};
use surefoot::model::{Body, BodyPose, Role, Side};
use surefoot::ragdoll::control::Assist;
use surefoot::rig::{Rig, load};
use surefoot::sim::{Articulated, PRESSED};

/// What a clip may be off its run while it stands.
const MOST: Drift = Drift { place: 5e-3, turn: 2.0 * std::f64::consts::PI / 180.0 };

/// The built-in rig, and two that nobody here made.
fn rigs() -> Vec<(&'static str, Rig)> {
    let mut rigs = vec![("builtin", builtin())];
    if let Some(folder) = data::more() {
        for name in ["m2m_human_male.glb", "kaykit_Knight.glb"] {
            rigs.push((name, load(&folder.join("rigs").join(name)).expect("a rig")));
        }
    }
    rigs
}

fn play(rig: &Rig, scenario: &Scenario) -> Baked {
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    bake(rig, scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("it holds together")
}

/// Shoves of so many N s from all around, as large for each body, drawn by a seed.
fn shoves(rig: &Rig, count: usize, impulses: [f64; 2], seed: u64) -> Vec<Scenario> {
    let mut draw = Seed::new(seed);
    let body = &rig.body;
    let scale = body.mass / 89.5 * (body.leg_length / 0.83).sqrt();
    let one = |_| {
        let (impulse, degrees) = (draw.between(impulses[0], impulses[1]) * scale, draw.between(0.0, 360.0));
        let toward = Direction::Heading(degrees.to_radians());
        let push = Push { start: 0.6, duration: 0.2, force: impulse / 0.2, toward, at: Role::Chest };
        Scenario { duration: 3.0, push: vec![push], ..Scenario::default() }
    };
    (0..count).map(one).collect()
}

fn run(baked: &Baked) -> &Articulated {
    &baked.performance.articulated.as_ref().expect("a ragdoll").run
}

/// The clip's keys against the run's links, tick by tick as far as it stands.
fn drift_of(rig: &Rig, baked: &Baked) -> Drift {
    let (run, timeline) = (run(baked), &baked.performance.timeline);
    let body = &timeline.body;
    let joints: Vec<usize> = run.joints.iter().copied().filter(|joint| body.joints[*joint].animated).collect();
    let mut sampler = rig.sampler(&baked.clip);
    let ticks = (timeline.stands() / timeline.dt).round() as usize;
    let off = |tick: usize| {
        let pose = sampler.sample(tick as f64 * timeline.dt).pose();
        drift::between(body, &joints, &run.poses[tick], &pose)
    };
    (0..=ticks).map(off).fold(Drift::default(), Drift::or)
}

#[test]
fn joints_are_where_the_body_had_them_within_5_millimetres_and_2_degrees() {
    for (name, rig) in rigs() {
        let one = |scenario: &Scenario| {
            let baked = play(&rig, scenario);
            (drift_of(&rig, &baked), baked.report.drift.expect("it is told"), scenario.push[0])
        };
        let all: Vec<_> = shoves(&rig, 16, [20.0, 150.0], 41).par_iter().map(one).collect();
        let worst = all.iter().map(|(found, ..)| *found).fold(Drift::default(), Drift::or);
        println!("{name}: at most {:.2} mm, {:.2} degrees", worst.place * 1e3, worst.turn.to_degrees());
        for (found, told, push) in all {
            assert!(found.within(&MOST), "{name}: {found:?} after {push:?}");
            assert!(told.position_mm <= 5.0 && told.angle_deg <= 2.0, "{name}: {told:?} after {push:?}");
            // Told at the frames' rate, measured here at the ticks': the same but for what is between.
            assert!((told.position_mm - found.place * 1e3).abs() < 1.0, "{name}: {told:?} and {found:?}");
        }
    }
}

#[test]
fn a_leg_that_straightens_between_two_ticks_has_its_knee_where_the_body_had_it() {
    for (name, rig) in rigs() {
        shoves(&rig, 16, [120.0, 240.0], 43).par_iter().for_each(|scenario| {
            let baked = play(&rig, scenario);
            let timeline = &baked.performance.timeline;
            let played = timeline.played.as_ref().expect("a run");
            let mut sampler = rig.sampler(&baked.clip);
            for millisecond in 0..(timeline.stands() * 1e3) as usize {
                let time = millisecond as f64 * 1e-3;
                let pose = sampler.sample(time).pose();
                let off = drift::between(&timeline.body, played.joints(), &played.run_at(time), &pose);
                assert!(off.within(&MOST), "{name}: {off:?} at {time} s after {:?}", scenario.push[0]);
            }
        });
    }
}

#[test]
fn who_stands_in_the_run_stands_in_the_clip_and_who_falls_falls() {
    let mut seen = [0, 0];
    for (name, rig) in rigs() {
        let judged: Vec<(bool, bool, Push)> = shoves(&rig, 12, [40.0, 320.0], 7)
            .par_iter()
            .map(|scenario| {
                let baked = play(&rig, scenario);
                let falls = run(&baked).trace.lost.is_some_and(|lost| lost <= scenario.duration);
                assert_eq!(falls, baked.performance.timeline.falls(), "the fall is shown");
                (falls, baked.report.outcome == Outcome::Fall, scenario.push[0])
            })
            .collect();
        for (falls, told, push) in judged {
            assert_eq!(falls, told, "{name}: after {push:?}");
            seen[usize::from(falls)] += 1;
        }
    }
    println!("{} stand, {} fall", seen[0], seen[1]);
    assert!(seen[0] >= 3 && seen[1] >= 2, "{seen:?}: shoves of both kinds are needed");
}

#[test]
fn footfalls_of_the_clip_are_those_of_the_run_and_none_is_added() {
    for (name, rig) in rigs() {
        for scenario in shoves(&rig, 6, [30.0, 130.0], 99) {
            let baked = play(&rig, &scenario);
            let (run, end) = (run(&baked), baked.performance.timeline.stands());
            let weight = PRESSED * rig.body.mass * 9.81 * 0.01;
            for side in Side::BOTH {
                let foot = side as usize;
                let of = |event: &str| -> Vec<f64> {
                    let own = baked.report.events.iter().filter(|one| one.name == event && one.foot == Some(side));
                    own.map(|one| one.time).collect()
                };
                let (ups, downs) = (of("foot_up"), of("foot_down"));
                let stood: Vec<[f64; 2]> =
                    run.stood[foot].iter().copied().filter(|[from, _]| *from <= end + 1e-9).collect();
                let wanted: Vec<f64> = stood.iter().map(|span| span[1]).filter(|up| *up < end - 1e-4).collect();
                assert_eq!(ups, wanted, "{name}: {side:?}");
                assert_eq!(downs, stood[1..].iter().map(|span| span[0]).collect::<Vec<_>>(), "{name}: {side:?}");
                // And the run's are true: the ground presses when it is down, and not all the while between.
                let tick = |time: f64| (time / 0.01).round() as usize;
                assert!(downs.iter().all(|down| run.pressed[tick(*down)][foot] > weight), "{name}: {side:?}");
                for pair in stood.windows(2) {
                    let (up, down) = (tick(pair[0][1]), tick(pair[1][0]));
                    let free = (up + 1..down).filter(|at| run.pressed[*at][foot] < weight).count();
                    assert!(free > 0, "{name}: {side:?} never left the ground from {up} to {down}");
                }
            }
        }
    }
}

#[test]
fn what_a_contact_holds_stands_still_where_the_ground_presses_and_nothing_else_is_held() {
    for (name, rig) in rigs() {
        for scenario in shoves(&rig, 6, [40.0, 140.0], 17) {
            let baked = play(&rig, &scenario);
            let run = run(&baked);
            assert!(baked.report.plausibility.slip_max_mm < 1.0, "{name}: {:?}", baked.report.contacts);
            let ends: Vec<&FootContact> = baked.performance.contacts.iter().collect();
            assert!(ends.iter().filter(|contact| contact.part == Part::Flat).count() >= 2, "{name}");
            for contact in &ends {
                let ticks = (contact.start / 0.01).round() as usize + 1..=(contact.end / 0.01).round() as usize;
                let count = ticks.clone().count();
                let pressed = ticks.filter(|tick| run.pressed[*tick][contact.side as usize] > 0.0).count();
                assert!(pressed * 10 >= count * 8, "{name}: {contact:?} is pressed for {pressed} of {count} ticks");
                let other = ends.iter().find(|other| {
                    other.side == contact.side
                        && other.start < contact.end - 1e-6
                        && other.end > contact.start + 1e-6
                        && **other != *contact
                });
                assert!(other.is_none(), "{name}: {contact:?} and {other:?} at once");
            }
        }
    }
}

/// m/s, what a contact is about goes slower; half of what a foot that slides goes faster than.
const SLIDES: f64 = 0.15;

/// m, what a contact is about: of a foot that lies flat its ankle, of one that rolls its ball or its heel.
fn held_point(body: &Body, pose: &BodyPose, side: usize, about: Part) -> DVec3 {
    let shape = &body.feet[side];
    let ball = shape.forward * shape.ball;
    let offset = match about {
        Part::Flat => DVec3::ZERO,
        Part::Ball => shape.level.inverse() * DVec3::new(ball.x, -shape.ankle_height, ball.y),
        Part::Heel => shape.heel_point(),
    };
    pose.positions(body)[shape.ankle] + pose.turns[shape.ankle] * offset
}

#[test]
fn a_foot_that_slides_has_no_contact() {
    let ground = Ground { kind: GroundKind::Slope { angle: 12_f64.to_radians() }, friction: 0.05 };
    let baked = play(&builtin(), &Scenario { ground, duration: 3.0, ..Scenario::default() });
    let run = run(&baked);
    let body = &baked.performance.timeline.body;
    let moves = |tick: usize, side: usize, about: Part| {
        let [from, to] = [tick - 2, tick].map(|tick| held_point(body, &run.poses[tick], side, about));
        from.distance(to) / 0.02
    };
    let ticks = (baked.performance.timeline.stands() / 0.01).round() as usize;
    let mut sliding = 0;
    for (tick, side) in (2..ticks).flat_map(|tick| Side::BOTH.map(|side| (tick, side))) {
        let time = tick as f64 * 0.01;
        let holds = |c: &&FootContact| c.side == side && c.start <= time && time <= c.end + 1e-9;
        if let Some(contact) = baked.performance.contacts.iter().find(holds) {
            let landed = contact.start + 0.02 > time + 1e-9;
            let speed = if landed { 0.0 } else { moves(tick, side as usize, contact.part) };
            assert!(speed < SLIDES, "{contact:?} holds at {time} s, where it goes at {speed:.2} m/s");
        } else if run.pressed[tick][side as usize] > 0.0 && moves(tick, side as usize, Part::Flat) > 2.0 * SLIDES {
            sliding += 1;
        }
    }
    assert!(sliding > 20, "it slides for {sliding} ticks");
}

#[test]
fn a_walk_is_its_run_and_every_stand_of_it_is_held() {
    let walk = Walk { start: 0.5, duration: None, speed: 1.0, heading: 0.0, facing: None };
    let rig = builtin();
    let baked = play(&rig, &Scenario { duration: 5.0, walk: vec![walk], ..Scenario::default() });
    let found = drift_of(&rig, &baked);
    assert!(found.within(&MOST), "{found:?}");
    let steps = run(&baked).trace.steps.len();
    assert!(steps >= 6, "{steps} steps");
    for side in Side::BOTH {
        for [from, to] in run(&baked).stood[side as usize].iter().filter(|[from, to]| to - from > 0.2) {
            let own = baked.performance.contacts.iter().filter(|contact| contact.side == side);
            let held: f64 = own.map(|contact| (contact.end.min(*to) - contact.start.max(*from)).max(0.0)).sum();
            assert!(held > 0.8 * (to - from), "{side:?} is held for {held:.2} s from {from:.2} to {to:.2} s");
        }
    }
}

/// Whether the body's run stands to the clip's end, as it is before anybody asks whether it may pass.
fn stands_ungated(rig: &Rig, scenario: &Scenario) -> bool {
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    let performance = perform_by(&rig.body, scenario, scenario.seed, drive).expect("it holds together");
    let lost = performance.articulated.expect("a ragdoll").run.trace.lost;
    lost.is_none_or(|lost| lost > scenario.duration)
}

#[test]
fn no_clip_that_stands_is_in_the_air_held_by_nothing_or_has_its_legs_in_each_other() {
    for (name, rig) in rigs() {
        let hard = shoves(&rig, 24, [90.0, 300.0], 77);
        let judged: Vec<(Baked, bool)> =
            hard.par_iter().map(|scenario| (play(&rig, scenario), stands_ungated(&rig, scenario))).collect();
        let [mut stands, mut told] = [0; 2];
        for (index, (baked, ran)) in judged.iter().enumerate() {
            let gated = baked.warnings.iter().any(|warning| warning.starts_with(FALLS));
            let up = baked.report.outcome != Outcome::Fall;
            // A clip falls where its run does or where the gate says why it may not pass, and for nothing else.
            assert_eq!(up, *ran && !gated, "{name}, shove {index}: {:?}", baked.warnings);
            if up {
                let found = baked.findings.as_ref().map(surefoot::measure::gate).expect("measured");
                assert!(found.is_empty(), "{name}, shove {index}: {}", found[0]);
            }
            // What `surefoot help body` says of this rig.
            let impulse = hard[index].push[0].force * hard[index].push[0].duration;
            assert!(up || name != "builtin" || impulse > 150.0, "shove {index} of {impulse} Ns: {:?}", baked.warnings);
            stands += usize::from(up);
            told += usize::from(gated);
        }
        println!("{name}: {stands} of {} stand, {told} fall by the gate", judged.len());
    }
}
