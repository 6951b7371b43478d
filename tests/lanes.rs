//! Lanes and keys that concern the body: [[throw]], [[carry]], recovery_time. `--nocapture` prints what was measured.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::export::baked_path;
use crate::limits_grid::{THIRD_PARTY, rigs, shove};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, RootMotion, bake};
use surefoot::export::glb_with_props;
use surefoot::measure::{Frame, Motion, measure_on};
use surefoot::model::props::Shape;
use surefoot::model::report::{Event, Outcome};
use surefoot::model::scenario::{Carry, Direction, Push, Scenario, Throw, Turn, Walk};
use surefoot::model::{Role, Side};
use surefoot::rig::Rig;

/// Rigs of the larger tests: names of those that stand for the rest.
const FEW: [&str; 5] = ["builtin", "m2m_human_male", "gdquest_mannequiny", "kaykit_Knight", "godette_vrm0"];

pub fn few() -> Vec<(String, Rig)> {
    rigs().into_iter().filter(|(name, _)| FEW.contains(&name.as_str())).collect()
}

pub fn baked(rig: &Rig, scenario: &Scenario) -> Baked {
    bake(rig, scenario, &BakeOptions::default()).expect("the simulation holds")
}

/// Writes a clip with its props to where the validator looks, and reads it back.
pub fn written(rig: &Rig, baked: &Baked, name: &str) -> Vec<u8> {
    let clips = [(baked.clip.clone(), baked.report.clone())];
    let file = glb_with_props(rig, &clips, &baked.props).expect("it can be written").bytes;
    let path = baked_path(&format!("lanes_{name}.glb"));
    std::fs::write(&path, &file).expect("target can be written");
    if let Some(source) = THIRD_PARTY.iter().find(|source| name.ends_with(source.split('.').next().unwrap_or(source))) {
        std::fs::write(path.with_extension("glb.source"), source).expect("target can be written");
    }
    file
}

/// Issue A's limits on the feet.
pub fn feet_hold(name: &str, baked: &Baked) {
    let found = &baked.report.plausibility;
    println!(
        "{name}: {:?}, {} steps, slip {:.2} mm, sink {:.2} mm, ZMP {:.1} %, residual {:.3} {:.3}, score {:.2}",
        baked.report.outcome,
        baked.report.steps,
        found.slip_max_mm,
        found.penetration_max_mm,
        100.0 * found.zmp_inside,
        found.residual_force,
        found.residual_moment,
        found.score
    );
    assert!(found.slip_max_mm < 2.0, "{name}: slip {}", found.slip_max_mm);
    assert!(found.penetration_max_mm < 5.0, "{name}: {} mm under the ground", found.penetration_max_mm);
    assert!(baked.report.outcome != Outcome::Fall, "{name} falls");
}

fn box_of(kg: f64) -> Carry {
    Carry { start: 0.0, end: None, mass: vec![[0.0, kg]], size: vec![(0.0, DVec3::new(0.4, 0.3, 0.3))] }
}

fn carrying(kg: f64, toward: f64) -> Scenario {
    let push = Push { start: 0.8, duration: 0.2, force: 100.0, toward: Direction::Heading(toward), at: Role::Chest };
    let title = format!("{kg} kg pushed to {:.0}", toward.to_degrees());
    Scenario { title, duration: 5.0, push: vec![push], carry: vec![box_of(kg)], ..Scenario::demo() }
}

/// rad, the largest bend of a knee before anything happens.
fn standing_knee(baked: &Baked) -> f64 {
    let timeline = &baked.performance.timeline;
    let solved = timeline.solve_all();
    solved[20].knees[0].max(solved[20].knees[1])
}

#[test]
fn a_box_of_ten_to_forty_kilograms_is_kept_up_from_sixteen_directions() {
    let rig = builtin();
    let unloaded = standing_knee(&baked(&rig, &Scenario { carry: Vec::new(), ..carrying(10.0, 0.0) }));
    for kg in [10.0, 25.0, 40.0] {
        let directions: Vec<f64> = (0..16).map(|index| f64::from(index) * std::f64::consts::TAU / 16.0).collect();
        let clips: Vec<Baked> = directions.par_iter().map(|toward| baked(&rig, &carrying(kg, *toward))).collect();
        let up =
            clips.iter().filter(|clip| clip.findings.as_ref().is_some_and(|found| found.balance.recovered)).count();
        for (index, clip) in clips.iter().enumerate() {
            feet_hold(&format!("{kg} kg, {:.1}", directions[index].to_degrees()), clip);
            assert!(clip.report.plausibility.zmp_inside > 0.9, "{:?}", clip.report.plausibility);
        }
        let more = (standing_knee(&clips[0]) - unloaded).to_degrees();
        println!("{kg} kg: {up} of 16 recover, knees {more:.2} degrees more bent than unloaded");
        assert_eq!(up, 16, "{kg} kg");
        assert!(more.abs() < 15.0, "{kg} kg: {more} degrees");
    }
}

#[test]
fn the_balance_is_that_of_body_and_box_together() {
    let rig = builtin();
    let baked = baked(&rig, &carrying(40.0, 0.0));
    let findings = baked.findings.as_ref().expect("it can be measured");
    let with = findings.zmp.outside_max_cm;
    // The same motion without the box in the sum: its weight would hang from nowhere.
    let timeline = &baked.performance.timeline;
    let hz = 120.0;
    let mut sampler = rig.sampler(&baked.clip);
    let poses: Vec<_> =
        (0..(baked.clip.duration * hz) as usize).map(|sample| sampler.sample(sample as f64 / hz).pose()).collect();
    let motion = Motion { body: &timeline.body, hz, per_frame: 4, poses: &poses };
    let held = surefoot::bake::contacts::held(&baked.performance.contacts, Frame::World);
    let without = measure_on(motion, &timeline.terrain, &held, &baked.performance.pushes).expect("sound");
    let ahead = |com: DVec3| com.z;
    let shift = ahead(findings.dynamics.com[60]) - ahead(without.dynamics.com[60]);
    println!("box ahead: whole {:.1} cm before the body's own; ZMP out {with:.1} cm", 100.0 * shift);
    assert!(with < 3.0, "{with} cm");
    assert!(shift > 0.06, "the whole lies {shift} m ahead of the body's own");
    let upright = findings.dynamics.com[60].z - baked.performance.trace.ticks[50].com.z;
    assert!(upright.abs() < 2e-3, "the whole is where the stepper has it: {upright}");
    // And the ground carries both.
    let newtons = findings.dynamics.needed[60].force.y / 9.81;
    assert!((newtons - timeline.body.mass - 40.0).abs() < 1.0, "{newtons} kg");
}

#[test]
fn the_hands_stay_at_the_box_through_a_shove() {
    for (name, rig) in few() {
        let mut scenario = carrying(15.0, std::f64::consts::FRAC_PI_2);
        scenario.push[0].force = 250.0 * rig.body.mass / 89.5;
        scenario.carry[0].mass = vec![[0.0, 0.2 * rig.body.mass]];
        scenario.carry[0].size = vec![(0.0, DVec3::new(0.22, 0.17, 0.17) * rig.body.height)];
        let baked = baked(&rig, &scenario);
        feet_hold(&name, &baked);
        written(&rig, &baked, &format!("carry_{name}"));
        let prop = baked.props.iter().find(|prop| prop.name == "box").expect("there is the box");
        let mut sampler = rig.sampler(&baked.clip);
        let in_box = |sampler: &mut surefoot::rig::animate::Sampler, time: f64| {
            let (key, pose) = (prop.at(time), sampler.sample(time));
            [Role::LeftHand, Role::RightHand].map(|role| {
                let hand = pose.positions[rig.body.joint(role).expect("it has hands")];
                key.rotation.inverse() * (hand - key.translation)
            })
        };
        let first = in_box(&mut sampler, 0.0);
        for side in Side::BOTH {
            let hand = first[side as usize];
            let out = hand.x * side.sign() - 0.11 * rig.body.height;
            println!(
                "{name} {side:?}: wrist {:.1} cm beside, {:.1} over, {:.1} ahead",
                out * 1e2,
                hand.y * 1e2,
                hand.z * 1e2
            );
            assert!(hand.x * side.sign() > 0.0, "{name}: {hand}");
            assert!(hand.y.abs() < 0.15 * rig.body.height, "{name}: {hand}");
        }
        let worst = (0..150)
            .map(|frame| in_box(&mut sampler, f64::from(frame) / 30.0))
            .map(|now| now[0].distance(first[0]).max(now[1].distance(first[1])))
            .fold(0.0, f64::max);
        println!("{name}: hands move {:.1} mm at the box", worst * 1e3);
        assert!(worst < 0.006 * rig.body.height, "{name}: {worst}");
    }
}

#[test]
fn a_walk_goes_on_at_its_speed_with_a_box_that_grows_heavy() {
    let rig = builtin();
    let walk = Walk { start: 0.5, duration: Some(6.0), speed: 1.0, heading: 0.0, facing: None };
    let carry = Carry { mass: vec![[0.0, 5.0], [6.0, 25.0]], ..box_of(0.0) };
    let title = "walk with a box".to_owned();
    let scenario =
        Scenario { title, duration: 9.0, walk: vec![walk], carry: vec![carry], push: Vec::new(), ..Scenario::demo() };
    let baked = baked(&rig, &scenario);
    feet_hold("walk with a box", &baked);
    written(&rig, &baked, "walk_with_a_box");
    let ticks = &baked.performance.trace.ticks;
    let speed = (ticks[630].com.z - ticks[230].com.z) / 4.0;
    println!("it walks at {speed:.3} m/s");
    assert!((speed - 1.0).abs() < 0.1, "{speed} m/s");
}

#[test]
fn what_is_carried_is_told_as_its_mean_weight_in_either_hand() {
    let rig = &builtin();
    let carry = Carry { start: 0.0, mass: vec![[0.0, 2.0], [2.0, 2.0], [4.0, 12.0]], ..box_of(2.0) };
    let scenario = Scenario { title: "told".into(), duration: 4.0, carry: vec![carry], ..Scenario::demo() };
    let baked = baked(rig, &scenario);
    let told: Vec<_> = baked.report.disturbances.iter().filter(|one| one.kind == "carry").collect();
    let bones: Vec<&str> = told.iter().map(|one| one.bone.as_str()).collect();
    assert_eq!(bones, ["leftHand", "rightHand"]);
    for one in told {
        // 2 kg for 2 s, then up to 12 kg in 2 s: 4.5 kg in the mean
        assert_eq!((one.start, one.end), (0.0, baked.clip.duration));
        let down = -one.force[1];
        assert!((down - 0.5 * 4.5 * 9.81).abs() < 0.01 && one.force[0] == 0.0 && one.force[2] == 0.0, "{one:?}");
    }
    assert_eq!(baked.report.disturbances.iter().filter(|one| one.kind == "push").count(), 1);
}

#[test]
fn a_box_that_grows_is_shown_so_and_keeps_the_hands_at_its_sides() {
    let rig = builtin();
    let sizes = [DVec3::new(0.30, 0.25, 0.24), DVec3::new(0.50, 0.32, 0.30)];
    let carry = Carry { size: vec![(0.5, sizes[0]), (3.5, sizes[1])], ..box_of(6.0) };
    for (name, drive) in [("stepper", Drive::Stepper), ("ragdoll", Drive::Ragdoll(Helped::Auto))] {
        let title = format!("growing box {name}");
        let scenario =
            Scenario { title, duration: 4.5, push: Vec::new(), carry: vec![carry.clone()], ..Scenario::demo() };
        let baked = bake(&rig, &scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("it bakes");
        feet_hold(&format!("growing box {name}"), &baked);
        written(&rig, &baked, &format!("growing_box_{name}"));
        let prop = baked.props.iter().find(|prop| prop.name == "box").expect("there is the box");
        let Shape::Box(first) = prop.shape else { panic!("a box") };
        let mut sampler = rig.sampler(&baked.clip);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for sample in 0..=90 {
            let time = 0.05 * f64::from(sample);
            let share = ((time - 0.5) / 3.0).clamp(0.0, 1.0);
            let (key, size) = (prop.at(time), sizes[0].lerp(sizes[1], share));
            assert!((key.scale * first).distance(size) < 1e-3, "{name} at {time:.2} s: {} m", key.scale * first);
            let positions = sampler.sample(time).positions;
            for (role, side) in [(Role::LeftHand, 1.0), (Role::RightHand, -1.0)] {
                let wrist = positions[rig.body.joint(role).expect("a hand")];
                let out = (key.rotation.inverse() * (wrist - key.translation)).x * side - 0.5 * size.x;
                (least, most) = (least.min(out), most.max(out));
            }
        }
        println!("{name}: wrists {:.1} to {:.1} mm out of the box's sides", 1e3 * least, 1e3 * most);
        // A palm's half thickness is 2 cm; nobody sees a centimetre.
        assert!(least > 0.0 && most < 0.04 && most - least < 0.015, "{name}");
    }
}

#[test]
fn a_box_is_taken_up_and_put_down_without_a_jolt() {
    let rig = builtin();
    let carry = Carry { start: 1.5, end: Some(4.5), mass: vec![[1.5, 5.0], [3.5, 30.0]], ..box_of(0.0) };
    let scenario =
        Scenario { title: "pick up".into(), duration: 6.0, push: Vec::new(), carry: vec![carry], ..Scenario::demo() };
    let baked = baked(&rig, &scenario);
    feet_hold("pick up", &baked);
    written(&rig, &baked, "pick_up");
    let timeline = &baked.performance.timeline;
    let hips: Vec<DVec3> = timeline.solve_all().iter().map(|solved| solved.pose.hips).collect();
    let fastest = hips.windows(2).map(|pair| pair[0].distance(pair[1]) / timeline.dt).fold(0.0, f64::max);
    println!("the hips move at {fastest:.3} m/s at most");
    assert!(fastest < 0.35, "{fastest} m/s");
    let prop = baked.props.iter().find(|prop| prop.name == "box").expect("there is the box");
    for (time, seen) in [(0.5, 0.0), (1.4, 0.0), (1.6, 1.0), (4.4, 1.0), (4.6, 0.0), (5.9, 0.0)] {
        assert!((prop.at(time).scale.x - seen).abs() < 1e-9, "at {time} s");
    }
    assert_eq!(baked.report.steps, 0, "it stands");
}

fn balls(from: Direction) -> Throw {
    Throw {
        start: 1.0,
        count: 3,
        interval: 0.4,
        radius: [0.12, 0.16],
        density: 50.0,
        speed: 9.0,
        from,
        at: Role::Chest,
        spread: 0.08,
    }
}

fn thrown(throw: Throw, seed: u64) -> Scenario {
    let title = format!("balls {seed}");
    Scenario { title, duration: 5.0, seed, push: Vec::new(), throw: vec![throw], ..Scenario::demo() }
}

fn hits(baked: &Baked) -> Vec<&Event> {
    baked.report.events.iter().filter(|event| event.name == "ball_hit").collect()
}

#[test]
fn balls_push_the_way_they_fly_and_are_told() {
    let rig = builtin();
    let ways = [
        (Direction::Front, DVec2::new(0.0, -1.0)),
        (Direction::Back, DVec2::new(0.0, 1.0)),
        (Direction::Left, DVec2::new(-1.0, 0.0)),
        (Direction::Right, DVec2::new(1.0, 0.0)),
    ];
    for (index, (from, way)) in ways.into_iter().enumerate() {
        let baked = baked(&rig, &thrown(balls(from), 7));
        feet_hold(&format!("{from:?}"), &baked);
        written(&rig, &baked, &format!("balls_{index}"));
        let hits = hits(&baked);
        println!("{from:?}: {:?}", hits.iter().map(|hit| (hit.time, &hit.bone, hit.impulse)).collect::<Vec<_>>());
        assert!(hits.len() >= 2, "{from:?}: {} of 3", hits.len());
        for (hit, told) in hits.iter().zip(baked.report.disturbances.iter().filter(|one| one.kind == "throw")) {
            let force = DVec3::from(told.force);
            assert!(DVec2::new(force.x, force.z).normalize().dot(way) > 0.5, "{from:?}: {force}");
            let (impulse, spell) = (hit.impulse.expect("told"), told.end - told.start);
            assert!((force.length() * spell / impulse - 1.0).abs() < 1e-6 && Some(&told.bone) == hit.bone.as_ref());
            // No more than 1.3 times the momentum of the heaviest ball.
            let heaviest = 50.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.16_f64.powi(3);
            assert!(impulse > 0.1 && impulse < 1.3 * heaviest * 9.6, "{impulse} N s");
        }
        let ticks = &baked.performance.trace.ticks;
        let gone = ticks[130].com - ticks[90].com;
        assert!(DVec2::new(gone.x, gone.z).dot(way) > 0.005, "{from:?}: it went {gone}");
    }
}

#[test]
fn from_the_front_is_the_characters_own_front() {
    let rig = builtin();
    let facing = std::f64::consts::FRAC_PI_2;
    let mut scenario = thrown(Throw { start: 4.0, count: 1, ..balls(Direction::Front) }, 3);
    scenario.duration = 7.0;
    scenario.turn = vec![Turn { start: 0.5, duration: None, facing }];
    let baked = baked(&rig, &scenario);
    let told = baked.report.disturbances.iter().find(|one| one.kind == "throw").expect("it hits");
    let force = DVec3::from(told.force).normalize();
    assert!(force.x < -0.7, "it faces +X and is pushed {force}");
}

#[test]
fn the_seed_draws_the_balls_and_some_miss_what_is_too_far() {
    let rig = builtin();
    let of = |seed: u64, spread: f64| baked(&rig, &thrown(Throw { spread, count: 6, ..balls(Direction::Front) }, seed));
    let (one, again, other) = (of(7, 0.1), of(7, 0.1), of(8, 0.1));
    assert_eq!(one.report, again.report);
    assert_ne!(
        hits(&one).iter().map(|hit| hit.impulse).collect::<Vec<_>>(),
        hits(&other).iter().map(|hit| hit.impulse).collect::<Vec<_>>()
    );
    let scattered = of(7, 1.5);
    let (met, all) = (hits(&scattered).len(), scattered.performance.balls.len());
    println!("spread 1.5 m: {met} of {all} meet it; 0.1 m: {} of {}", hits(&one).len(), one.performance.balls.len());
    assert!(met < all && all == 6, "{met} of {all}");
    // Whatever is thrown ends on the ground, resting or rolling, or on its way there.
    for prop in one.props.iter().filter(|prop| prop.name.starts_with("ball_")) {
        let last = prop.keys.last().expect("it has keys");
        let surefoot::model::props::Shape::Ball(radius) = prop.shape else { panic!("a ball is a ball") };
        assert!((last.translation.y - radius).abs() < 0.02, "{}: {}", prop.name, last.translation);
        assert!(prop.keys.iter().all(|key| key.translation.y > radius - 0.02), "{}: under the ground", prop.name);
        assert!(prop.keys.windows(2).all(|pair| pair[0].time < pair[1].time), "{}", prop.name);
    }
}

#[test]
fn a_carried_box_is_hit_before_the_belly_behind_it() {
    let rig = builtin();
    let throw = Throw { spread: 0.0, count: 1, speed: 12.0, at: Role::Spine, ..balls(Direction::Front) };
    let bare = baked(&rig, &thrown(throw, 7));
    let mut scenario = thrown(throw, 7);
    scenario.carry = vec![box_of(10.0)];
    let boxed = baked(&rig, &scenario);
    let earlier = hits(&bare)[0].time - hits(&boxed)[0].time;
    println!("the box is met {:.0} ms before the belly", earlier * 1e3);
    assert!(earlier > 0.1 / 12.0, "{earlier} s");
    feet_hold("hit at the box", &boxed);
}

#[test]
fn a_ball_is_where_the_body_is_when_it_hits() {
    for (name, rig) in few() {
        let throw = Throw { count: 4, radius: [0.06 * rig.body.height; 2], spread: 0.03, ..balls(Direction::Front) };
        let baked = baked(&rig, &thrown(throw, 5));
        let timeline = &baked.performance.timeline;
        let met: Vec<_> = baked.performance.balls.iter().filter_map(|ball| ball.hit.map(|hit| (ball, hit))).collect();
        assert!(met.len() >= 2, "{name}: {} hits", met.len());
        for (index, ball) in baked.performance.balls.iter().enumerate() {
            let Some(hit) = ball.hit else { continue };
            let prop = baked.props.iter().find(|prop| prop.name == format!("ball_{}", index + 1)).expect("shown");
            let pose = timeline.pose_at(hit.push.start);
            let positions = pose.positions(&timeline.body);
            let place = prop.at(hit.push.start).translation;
            let near = positions.iter().map(|joint| joint.distance(place)).fold(f64::INFINITY, f64::min);
            assert!(near < ball.radius + 0.2 * rig.body.height, "{name}: nearest joint {near} m");
            assert!(near > 0.3 * ball.radius, "{name}: a joint is inside of the ball, {near} m");
        }
    }
}

#[test]
fn a_longer_recovery_comes_to_its_comfortable_stand_later() {
    let rig = builtin();
    let ends: Vec<f64> = [0.0, 0.5, 1.0]
        .into_iter()
        .map(|dial| {
            let mut scenario = shove(&rig.body, 20.0, 60.0);
            scenario.duration = 6.0;
            scenario.character.style.recovery_time = dial;
            let baked = baked(&rig, &scenario);
            feet_hold(&format!("recovery_time {dial}"), &baked);
            baked.report.events.iter().find(|event| event.name == "balance_regained").expect("it does").time
        })
        .collect();
    println!("regained at {ends:?} s");
    assert!(ends[0] < ends[1] - 0.05 && ends[1] < ends[2] - 0.05, "{ends:?}");
}

#[test]
fn scaled_legs_and_a_box_walk_the_root_motions() {
    let rig = builtin();
    for root in [RootMotion::Root, RootMotion::Hips, RootMotion::InPlace] {
        let mut scenario = carrying(20.0, 1.0);
        scenario.character.leg_scale = 1.2;
        scenario.push[0].force = 300.0;
        let options = BakeOptions { root, ..BakeOptions::default() };
        let baked = bake(&rig, &scenario, &options).expect("the simulation holds");
        feet_hold(root.name(), &baked);
    }
}
