//! The articulated body in its world: it falls without flying apart, balls hit it, every ground carries it, and what breaks
//! down is caught in its tick.

#![expect(clippy::print_stdout, reason = "numbers, and what was skipped")]

use crate::limits_grid::rigs;
use glam::{DQuat, DVec3};
use surefoot::bake::obeys::{Shirked, shirked};
use surefoot::bake::ragdoll::{Stroll, stroll};
use surefoot::bake::{BakeError, BakeOptions, Baked, Drive, Fall, Helped, bake};
use surefoot::measure::{KnownPush, PushPoint};
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{Carry, Direction, Ground, GroundKind, Push, Scenario, Throw, Walk};
use surefoot::model::scenario_text::parse;
use surefoot::model::{Body, BodyPose, Role, Side, Terrain};
use surefoot::ragdoll::control::Assist;
use surefoot::ragdoll::figure::Part;
use surefoot::ragdoll::{Figure, LinkState, Locks, World};
use surefoot::rig::Rig;
use surefoot::sim::{Articulated, ArticulatedOptions, simulate_articulated};
use surefoot::whole_body::{Anatomy, Solver, stand};

fn built_in() -> Rig {
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    surefoot::rig::load_bytes("builtin", surefoot::rig::mannequin::BUILTIN, &none, None)
        .expect("the built-in rig loads")
}

fn alone(scenario: &Scenario) -> Baked {
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    bake(&built_in(), scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("it holds together")
}

fn shoved(force: f64, toward: Direction) -> Scenario {
    let push = Push { start: 0.6, duration: 0.2, force, toward, at: Role::Chest };
    Scenario { duration: 4.0, push: vec![push], ..Scenario::default() }
}

fn under_balls(density: f64) -> Scenario {
    let throw = |start: f64, speed: f64, from: Direction| Throw {
        start,
        count: 10,
        interval: 1.0,
        radius: [0.1, 0.2],
        density,
        speed,
        from,
        at: Role::Chest,
        spread: 0.2,
    };
    let throw = vec![throw(0.5, 8.5, Direction::Front), throw(1.0, 9.5, Direction::Left)];
    Scenario { duration: 11.0, throw, ..Scenario::default() }
}

fn stands(body: &Body) -> BodyPose {
    let anatomy = Anatomy::new(body);
    let physique = stand::physique(body, &anatomy);
    Solver::new(body, &anatomy).solve(&stand::natural_stand(body, &physique)).pose
}

/// m/s, the fastest joint between two poses so far apart.
fn fastest(body: &Body, from: &BodyPose, to: &BodyPose, dt: f64) -> f64 {
    let (a, b) = (from.positions(body), to.positions(body));
    a.iter().zip(&b).map(|(a, b)| a.distance(*b) / dt).fold(0.0, f64::max)
}

#[test]
fn who_is_knocked_over_comes_down_whole_and_lies_still() {
    for toward in [Direction::Front, Direction::Back, Direction::Left, Direction::Right] {
        let baked = alone(&shoved(1600.0, toward));
        let timeline = &baked.performance.timeline;
        let (lost, end) = (baked.performance.lost.expect("no balance"), timeline.duration());
        assert_eq!(baked.report.outcome, Outcome::Fall, "{toward:?}");
        assert!(end - lost > 0.5 && end - timeline.stands() <= 2.5 + 0.5, "{toward:?}: from {lost} to {end}");
        let ticks = ((end - lost + 0.2) / 0.01) as usize;
        let poses: Vec<BodyPose> =
            (0..=ticks).map(|tick| timeline.pose_at(end - 0.01 * (ticks - tick) as f64)).collect();
        let speeds: Vec<f64> = poses.windows(2).map(|pair| fastest(&timeline.body, &pair[0], &pair[1], 0.01)).collect();
        let worst = speeds.iter().copied().fold(0.0, f64::max);
        let last = poses.last().expect("poses");
        let low = last.positions(&timeline.body).iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
        println!(
            "{toward:?}: falls {:.2} s, at most {worst:.1} m/s, ends at {:.2} m/s with the hips at {:.2} m, lowest joint {low:.3} m",
            end - lost,
            speeds.last().copied().unwrap_or(0.0),
            last.hips.y
        );
        assert!(worst < 25.0, "{toward:?}: {worst} m/s");
        assert!(last.hips.y < 0.45 && low > -0.05, "{toward:?}: hips {} lowest {low}", last.hips.y);
        assert!(speeds.iter().rev().take(5).all(|speed| *speed < 0.7), "{toward:?} still moves");
    }
}

#[test]
fn a_clip_tells_the_peak_torque_of_every_joint_worst_first_and_the_steppers_none() {
    let told = |baked: &Baked| surefoot::export::events::report_json("clip", &baked.report).expect("numbers");
    let shove = shoved(300.0, Direction::Left);
    let (light, hard) = (alone(&shoved(40.0, Direction::Left)), alone(&shove));
    let torques = &hard.report.torques;
    println!("{torques:?}");
    assert_eq!(torques.len(), 16, "every joint of the figure but its root, toes too");
    assert!(torques.windows(2).all(|pair| pair[0].peak_nm >= pair[1].peak_nm));
    assert!(torques.iter().all(|torque| (torque.share * 500.0 - torque.peak_nm).abs() < 1e-9 && torque.share <= 1.0));
    assert!(torques[0].joint.contains("Leg") || torques[0].joint.contains("Foot"), "{}", torques[0].joint);
    let of = |baked: &Baked, joint: &str| {
        baked.report.torques.iter().find(|torque| torque.joint == joint).map_or(f64::NAN, |torque| torque.peak_nm)
    };
    for joint in ["leftUpperLeg", "leftLowerLeg", "leftFoot", "spine", "rightUpperArm"] {
        let (little, much) = (of(&light, joint), of(&hard, joint));
        assert!(little > 1.0 && much > little, "{joint}: {little} Nm, then {much}");
    }
    let json = told(&hard);
    assert_eq!(json["torques"][0]["joint"], torques[0].joint.as_str());
    assert!(json["torques"][13]["peak_nm"].as_f64().is_some_and(|peak| peak > 0.0));
    let stepper = bake(&built_in(), &shove, &BakeOptions::default()).expect("it bakes");
    assert!(told(&stepper).get("torques").is_none());
}

#[test]
fn a_fall_that_no_help_prevents_gets_none_and_says_so() {
    let drive = Drive::Ragdoll(Helped::Auto);
    let hard = shoved(2000.0, Direction::Back);
    let baked = bake(&built_in(), &hard, &BakeOptions { drive, ..BakeOptions::default() }).expect("it holds together");
    assert!(matches!(baked.fall(), Some(Fall::Down(time)) if time > 0.6 && time < 2.0), "{:?}", baked.fall());
    assert_eq!(baked.report.assist, surefoot::model::report::Assist::default());
    let driven = baked.performance.articulated.as_ref().expect("a ragdoll");
    assert!(driven.why.as_ref().is_some_and(|why| why.contains("300 Nm and 300 N do not")), "{:?}", driven.why);
    assert!(alone(&shoved(100.0, Direction::Back)).fall().is_none());
}

#[test]
fn the_drive_that_is_chosen_for_a_fall_is_the_one_whose_clip_shows_it_and_the_reason_is_true() {
    let drive = Drive::Auto(Helped::Auto);
    let options = BakeOptions { drive, ..BakeOptions::default() };
    let baked = bake(&built_in(), &shoved(1600.0, Direction::Back), &options).expect("it holds together");
    let why = baked.choice.as_ref().map_or(String::new(), |choice| choice.why.clone());
    assert_eq!(baked.report.drive, "ragdoll");
    let down = baked.fall().expect("a fall").to_string();
    assert!(down.starts_with("goes down from") && why.contains(&down) && why.starts_with("both fall"), "{why}");
    let lost = baked.report.events.iter().find(|event| event.name == "balance_lost").map(|event| event.time);
    assert!(lost.is_some() && lost == baked.performance.lost);
}

#[test]
fn where_the_steppers_clip_is_as_good_as_can_be_seen_the_ragdoll_is_not_tried() {
    let options = BakeOptions { drive: Drive::Auto(Helped::Auto), ..BakeOptions::default() };
    let chosen = |newtons: f64| bake(&built_in(), &shoved(newtons, Direction::Back), &options).expect("it bakes");
    let clear = chosen(100.0);
    let choice = clear.choice.as_ref().expect("a choice");
    assert!(clear.report.drive == "stepper" && clear.report.plausibility.score >= 0.95, "{choice:?}");
    assert!(choice.other.is_none() && choice.why.contains("0.95"), "{choice:?}");
    let hard = chosen(600.0);
    let choice = hard.choice.as_ref().expect("a choice");
    assert!(hard.report.drive == "ragdoll", "{choice:?}");
    assert!(choice.other.is_some_and(|other| other < 0.95), "both were looked at: {choice:?}");
}

fn walking(speed: f64, legs: f64) -> Scenario {
    let walk = Walk { start: 0.5, duration: None, speed, heading: 0.0, facing: None };
    let mut scenario = Scenario { duration: 6.0, walk: vec![walk], ..Scenario::default() };
    scenario.character.leg_scale = legs;
    scenario
}

#[test]
fn a_walk_that_is_slower_than_asked_or_never_sets_off_is_told() {
    let brisk = walking(1.2, 1.0);
    let whole = alone(&brisk);
    assert_eq!(stroll(&brisk, &whole.performance), Stroll::AsTold);
    assert!(!whole.warnings.iter().any(|warning| warning.contains("the ragdoll")), "{:?}", whole.warnings);
    let still = alone(&Scenario { duration: 6.0, ..Scenario::default() });
    assert_eq!(stroll(&brisk, &still.performance), Stroll::Never, "who stands has not walked");
    assert!(matches!(stroll(&walking(1.2, 1.0), &alone(&walking(0.8, 1.0)).performance), Stroll::Slower(..)));
    let short = alone(&walking(1.4, 0.6));
    let tells = |list: &[String]| list.iter().any(|text| text.contains("walks at most") && text.contains("not 1.40"));
    println!("{:?}: {:?}", short.report.outcome, short.warnings);
    assert!(tells(&short.warnings) && tells(&short.report.plausibility.notes), "{:?}", short.warnings);
}

#[test]
fn who_does_not_lift_his_foot_or_turn_as_told_is_told() {
    let lanes = |lane: &str| parse("x.toml", &format!("title = 'x'\nduration = 7.0\n{lane}\n")).expect("a scenario");
    let still = alone(&Scenario { duration: 7.0, ..Scenario::default() });
    for (lane, what) in [
        ("[[stand]]\nstart = 0.5\non = 'left'", Shirked::Stand),
        ("[[turn]]\nstart = 0.5\nfacing = 90", Shirked::Turn),
        ("[[walk]]\nstart = 0.5\nspeed = 0.8", Shirked::Walk),
    ] {
        let asked = lanes(lane);
        assert_eq!(shirked(&asked, &still.performance), Some(what), "who stands has not done it: {lane}");
        assert_eq!(shirked(&asked, &alone(&asked).performance), None, "{lane}");
    }
}

#[test]
fn what_it_cannot_play_is_named_and_never_left_out() {
    let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
    for (lane, named) in [
        ("[stepper]\nspring = 2.0\n[[walk]]\nstart = 0.5\nspeed = 0.4", "spring and damping of [stepper]"),
        ("[stepper]\ndamping = 0.5", "spring and damping of [stepper]"),
    ] {
        let scenario = parse("x.toml", &format!("title = 'x'\nduration = 3.0\n{lane}\n")).expect("a scenario");
        let error = bake(&built_in(), &scenario, &BakeOptions { drive, ..BakeOptions::default() }).map(|_| ());
        let error = error.expect_err("it is not played").to_string();
        assert!(error.contains(named) && error.contains("--drive stepper"), "{error}");
        let auto = BakeOptions { drive: Drive::Auto(Helped::Auto), ..BakeOptions::default() };
        let choice = bake(&built_in(), &scenario, &auto).expect("the stepper plays it").choice.expect("a choice");
        assert!(choice.why.contains(named), "{}", choice.why);
    }
}

#[test]
fn who_keeps_balance_has_no_fall_in_the_clip() {
    let baked = alone(&shoved(150.0, Direction::Back));
    assert_ne!(baked.report.outcome, Outcome::Fall);
    assert!(!baked.performance.timeline.falls() && baked.performance.lost.is_none());
}

#[test]
fn twenty_light_balls_do_not_fell_it_and_each_is_told() {
    let mut stays = 0;
    for seed in 101..111 {
        let baked = alone(&Scenario { seed, ..under_balls(50.0) });
        stays += u32::from(baked.report.outcome != Outcome::Fall);
        let hits: Vec<_> = baked.report.events.iter().filter(|event| event.name == "ball_hit").collect();
        assert!(hits.len() >= 15, "seed {seed}: {} hits", hits.len());
        assert!(hits.iter().all(|hit| hit.bone.is_some() && hit.impulse.is_some_and(|size| size > 0.1 && size < 25.0)));
        assert_eq!(baked.props.iter().filter(|prop| prop.name.starts_with("ball")).count(), 20);
    }
    println!("{stays} of 10 seeds stay up");
    assert!(stays >= 9);
}

#[test]
fn balls_of_stone_fell_it() {
    assert_eq!(alone(&under_balls(1500.0)).report.outcome, Outcome::Fall);
}

#[test]
fn a_ball_loses_the_momentum_that_the_body_is_said_to_get() {
    let body = built_in().body;
    let pose = stands(&body);
    let figure = Figure::new(&body, &pose, Locks::default());
    let mut world = World::new(&figure, &figure.placed(&body, &pose), &Terrain::flat(), 0.01, 2).expect("a tree");
    let chest = pose.positions(&body)[body.joint(Role::Chest).expect("a chest")];
    let (mass, velocity) = (1.0, DVec3::new(0.0, 0.0, -9.0));
    let ball = world.throw(0.12, mass, chest + DVec3::new(0.0, 0.05, 0.8), velocity);
    let (mut given, mut speed) = (DVec3::ZERO, velocity);
    for tick in 0..14 {
        world.step(&Terrain::flat(), 0.01 * f64::from(tick));
        given += world.blows(ball).iter().map(|blow| blow.impulse).sum::<DVec3>();
        speed = world.ball(ball).2;
    }
    let lost = mass * (velocity - speed) + DVec3::NEG_Y * (9.81 * 0.14 * mass);
    println!("given {given:.2}, lost {lost:.2}");
    assert!(given.z < -9.0, "it bounces: {given}");
    assert!((given.z - lost.z).abs() < 0.1 * lost.z.abs(), "{given} against {lost}");
}

#[test]
fn it_stands_and_is_shoved_on_ground_that_is_not_level() {
    let slope = |degrees: f64| GroundKind::Slope { angle: degrees.to_radians() };
    let platform = |pitch: f64, roll: f64| {
        let there = |degrees: f64| vec![[0.5, 0.0], [3.0, degrees.to_radians()], [6.0, 0.0]];
        GroundKind::Platform { pitch: there(pitch), roll: there(roll) }
    };
    let uneven = GroundKind::Uneven { height: 0.05, wavelength: 1.5, seed: 4 };
    for (kind, force) in [
        (slope(10.0), 0.0),
        (slope(-20.0), 0.0),
        (slope(10.0), 150.0),
        (slope(-10.0), 150.0),
        (uneven, 200.0),
        (platform(10.0, 0.0), 0.0),
        (platform(0.0, -10.0), 0.0),
        (platform(8.0, 5.0), 100.0),
    ] {
        let mut scenario = shoved(force, Direction::Back);
        scenario.push.retain(|push| push.force > 0.0);
        scenario.duration = 6.0;
        scenario.ground = Ground { kind: kind.clone(), friction: 1.0 };
        let report = alone(&scenario).report;
        let (slip, sink) = (report.plausibility.slip_max_mm, report.plausibility.penetration_max_mm);
        println!("{kind:?} {force} N: {:?}, slip {slip:.1} mm, sink {sink:.1} mm", report.outcome);
        assert!(report.outcome != Outcome::Fall && slip < 2.0 && sink < 5.0, "{kind:?}");
    }
}

#[test]
fn nobody_stands_on_a_slope_of_ice() {
    let ground = Ground { kind: GroundKind::Slope { angle: 15_f64.to_radians() }, friction: 0.05 };
    let baked = alone(&Scenario { ground, duration: 5.0, ..Scenario::default() });
    let moved = baked.performance.trace.ticks.last().map_or(0.0, |tick| tick.com.z);
    assert!(baked.report.outcome == Outcome::Fall || moved < -0.3, "{:?} at {moved} m", baked.report.outcome);
}

#[test]
fn a_box_of_2_to_25_kg_is_held_and_a_shove_is_caught_with_it() {
    let carrying = |mass: Vec<[f64; 2]>, force: f64, toward: Direction| {
        let carry = Carry { start: 0.0, end: None, mass, size: vec![(0.0, DVec3::new(0.4, 0.3, 0.3))] };
        let mut scenario = shoved(force, toward);
        scenario.push[0].start = 3.0;
        alone(&Scenario { carry: vec![carry], duration: 6.0, ..scenario })
    };
    let torque = |baked: &Baked| baked.performance.articulated.as_ref().map_or(0.0, |driven| driven.run.peak_torque);
    let (light, heavy) =
        (carrying(vec![[0.0, 2.0]], 0.0, Direction::Front), carrying(vec![[0.0, 25.0]], 0.0, Direction::Front));
    println!("at most {:.0} Nm with 2 kg, {:.0} with 25", torque(&light), torque(&heavy));
    assert!(torque(&heavy) > torque(&light) + 15.0, "{} {}", torque(&light), torque(&heavy));
    let mut caught = 0;
    for mass in [vec![[0.0, 2.0]], vec![[0.0, 2.0], [4.0, 25.0]], vec![[0.0, 25.0]], vec![[0.0, 10.0]]] {
        for toward in [Direction::Front, Direction::Back, Direction::Left, Direction::Right] {
            let report = carrying(mass.clone(), 100.0, toward).report;
            println!("{mass:?} {toward:?}: {:?} after {} steps", report.outcome, report.steps);
            caught += u32::from(report.outcome != Outcome::Fall);
        }
    }
    assert_eq!(caught, 16);
}

fn forced(force: DVec3) -> Result<Articulated, surefoot::sim::articulated::BrokenBody> {
    let body = built_in().body;
    let anatomy = Anatomy::new(&body);
    let physique = stand::physique(&body, &anatomy);
    let push = KnownPush { start: 1.0, end: 1.2, force, at: PushPoint::Joint(body.joint(Role::Chest).unwrap_or(0)) };
    let options = ArticulatedOptions { duration: 2.0, ..ArticulatedOptions::default() };
    simulate_articulated(&body, &anatomy, &physique, &Terrain::flat(), &options, &[(push, false)], Assist::default())
}

#[test]
fn a_force_that_is_no_number_is_caught_in_its_tick_with_the_part() {
    for force in [DVec3::new(f64::NAN, 0.0, 0.0), DVec3::new(0.0, f64::INFINITY, 0.0), DVec3::new(1e9, 0.0, 0.0)] {
        let broken = forced(force).expect_err("it breaks down");
        println!("{force}: {broken}");
        assert!((broken.time - 1.01).abs() < 1e-6, "in its tick: {broken}");
        assert!(
            ["pelvis", "trunk", "head", "arm", "hand", "thigh", "shank", "foot"]
                .iter()
                .any(|part| broken.what.contains(part)),
            "{broken}"
        );
    }
    assert!(forced(DVec3::X * 50.0).is_ok());
    let error = BakeError::BrokeDown { time: 1.01, what: "the head left the world".into() };
    assert!(error.to_string().contains("1.01 s: the head left the world"));
}

#[test]
fn a_torn_or_lost_link_is_named() {
    let body = built_in().body;
    let pose = stands(&body);
    let figure = Figure::new(&body, &pose, Locks::default());
    let placed = figure.placed(&body, &pose);
    let state = |(origin, turn): &(DVec3, DQuat)| LinkState {
        origin: *origin,
        turn: *turn,
        velocity: DVec3::ZERO,
        spin: DVec3::ZERO,
    };
    let whole: Vec<LinkState> = placed.iter().map(state).collect();
    assert_eq!(World::broken(&figure, &whole), None);
    let shank = figure.links.iter().position(|link| link.part == Part::Shank(Side::Left)).expect("a shank");
    let with = |change: &dyn Fn(&mut LinkState)| {
        let mut states = whole.clone();
        change(&mut states[shank]);
        World::broken(&figure, &states).expect("broken")
    };
    for (what, words) in [
        (with(&|state| state.origin.x += 0.2), "came apart"),
        (with(&|state| state.origin.x += 200.0), "left the world"),
        (with(&|state| state.velocity.z = 150.0), "150 m/s"),
        (with(&|state| state.spin.z = f64::NAN), "not a finite number"),
    ] {
        assert!(what.contains("left shank") && what.contains(words), "{what}");
    }
}

#[test]
fn the_boxes_of_every_rig_lie_along_its_bones_and_are_as_large_as_parts_of_a_body() {
    for (name, rig) in rigs() {
        let body = &rig.body;
        let figure = Figure::new(body, &stands(body), Locks::default());
        println!("{name}: {} of 13 parts by the mesh, {:.2} m", body.flesh.len(), body.height);
        assert!(body.flesh.len() == 13 || rig.mesh.is_empty() || !body.flesh.is_empty(), "{name}");
        for (index, link) in figure.links.iter().enumerate() {
            let dense = link.mass / (8.0 * link.half.x * link.half.y * link.half.z);
            let [x, y, z] = link.half.to_array().map(|half| 200.0 * half / body.height);
            println!("    {:<16} {x:5.1} {y:5.1} {z:5.1} % of the height, {dense:6.0} kg/m³", link.part.name());
            // The head of a toy knight is half of him: as heavy as a man's, and light for its size.
            let least = if link.part == Part::Head { 10.0 } else { 30.0 };
            assert!((least..6000.0).contains(&dense), "{name}: {:?} of {dense} kg/m³", link.part);
            let limb = matches!(link.part, Part::UpperArm(_) | Part::Forearm(_) | Part::Thigh(_) | Part::Shank(_));
            let by_mesh = body.flesh.iter().any(|flesh| figure.link_of[flesh.joint] == index);
            if let (true, true, Some(next)) =
                (limb, by_mesh, figure.links.iter().find(|other| other.parent == Some(index)))
            {
                let bone = next.anchor.normalize();
                assert!((link.turn * DVec3::Y).dot(bone) > 0.999, "{name}: {:?} lies across its bone", link.part);
                assert!(link.half.y <= 0.5 * next.anchor.length() + 1e-6, "{name}: {:?} is too long", link.part);
                let off = link.middle - bone * bone.dot(link.middle);
                assert!(off.length() <= link.half.x.hypot(link.half.z), "{name}: {:?} is beside its bone", link.part);
            }
        }
    }
}

#[test]
fn every_rig_settles_on_its_feet_without_help() {
    let mut fell = Vec::new();
    for (name, rig) in rigs() {
        let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
        let scenario = Scenario { duration: 2.0, ..Scenario::default() };
        match bake(&rig, &scenario, &BakeOptions { drive, ..BakeOptions::default() }) {
            Ok(baked) => {
                let ticks = &baked.performance.trace.ticks;
                let drift = ticks.iter().map(|tick| tick.com.distance(ticks[0].com)).fold(0.0, f64::max);
                println!("{name}: {:?}, {:.1} mm from where it began", baked.report.outcome, drift * 1e3);
                if baked.report.outcome == Outcome::Fall {
                    fell.push(name);
                }
            }
            Err(error) => {
                println!("{name}: {error}");
                fell.push(name);
            }
        }
    }
    println!("do not stand: {fell:?}");
    assert!(fell.is_empty(), "{fell:?}");
}
