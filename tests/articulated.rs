//! The articulated body on its feet: standing, shoved from all sides, with help and without; the same motion every time.
//!
//! `benches/ragdoll.rs` prints the whole table; what stands here are its guards.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::common::builtin;
use glam::DVec3;
use surefoot::maths::seed::Seed;
use surefoot::measure::{KnownPush, PushPoint};
use surefoot::model::{Body, BodyPose, Physique, Role, Terrain};
use surefoot::ragdoll::control::Assist;
use surefoot::ragdoll::dynamics::{Acceleration, LegMap, Motion};
use surefoot::ragdoll::{Figure, Locks, World};
use surefoot::sim::{Ahead, Articulated, ArticulatedOptions, simulate_articulated};
use surefoot::stepper::StepKind;
use surefoot::whole_body::reaction::Personality;
use surefoot::whole_body::{Anatomy, Solver, stand};

const FREE: Assist = Assist { torque: 0.0, force: 0.0 };

fn run(body: &Body, pushes: &[KnownPush], duration: f64, assist: Assist) -> Articulated {
    let anatomy = Anatomy::new(body);
    let physique: Physique = stand::physique(body, &anatomy);
    let options = ArticulatedOptions { duration, extra: 0.0, ..ArticulatedOptions::default() };
    let pushes: Vec<(KnownPush, bool)> = pushes.iter().map(|push| (*push, false)).collect();
    simulate_articulated(body, &anatomy, &physique, &Terrain::flat(), &options, &pushes, assist)
        .expect("the body does not break down")
}

/// The body as links, and how it stands.
fn standing(body: &Body) -> (Figure, BodyPose) {
    let anatomy = Anatomy::new(body);
    let physique = stand::physique(body, &anatomy);
    let pose = Solver::new(body, &anatomy).solve(&stand::natural_stand(body, &physique)).pose;
    (Figure::new(body, &pose, Locks::default()), pose)
}

/// `degrees`: 90 is to its left.
fn shove(body: &Body, newtons: f64, seconds: f64, degrees: f64) -> KnownPush {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let chest = body.joint(Role::Chest).expect("the built-in rig has a chest");
    KnownPush {
        start: 0.5,
        end: 0.5 + seconds,
        force: DVec3::new(sin, 0.0, cos) * newtons,
        at: PushPoint::Joint(chest),
    }
}

#[test]
fn stands_for_a_minute_on_its_own_within_five_millimetres() {
    let run = run(&builtin().body, &[], 60.0, FREE);
    let ticks = &run.trace.ticks;
    let drift = (ticks[ticks.len() - 1].com - ticks[0].com).with_y(0.0).length();
    assert!(run.trace.lost.is_none() && run.trace.steps.is_empty());
    assert!(drift < 0.005, "{:.1} mm", drift * 1000.0);
    assert_eq!((run.help.torque, run.help.force), ([0.0; 2], [0.0; 2]));
}

#[test]
fn recovers_on_its_own_from_300_newtons_from_sixteen_directions() {
    let body = builtin().body;
    for index in 0..16 {
        let degrees = f64::from(index) * 22.5;
        let run = run(&body, &[shove(&body, 300.0, 0.2, degrees)], 6.0, FREE);
        assert!(run.trace.lost.is_none(), "falls towards {degrees} degrees");
        assert_eq!((run.help.torque[0], run.help.force[0]), (0.0, 0.0), "helped towards {degrees} degrees");
        assert!(run.peak_torque <= 500.0 + 1e-9, "{} Nm", run.peak_torque);
    }
}

#[test]
fn who_has_caught_a_hard_shove_comes_to_rest_and_does_not_fall_after_all() {
    let body = builtin().body;
    let mut stand = 0;
    for push in drawn(&body, 41_000, 24, [150.0, 220.0]) {
        let run = run(&body, &[push], 9.0, FREE);
        let fell = run.trace.lost.unwrap_or(f64::INFINITY);
        if fell < 4.5 {
            continue;
        }
        stand += 1;
        let towards = push.force.x.atan2(push.force.z).to_degrees();
        assert!(fell.is_infinite(), "towards {towards:.0} degrees it falls at {fell:.2} s");
        assert!(run.trace.rest >= 0.5, "towards {towards:.0} degrees it steps on and on");
    }
    assert!(stand >= 12, "{stand} of 24 stand: nothing proved");
}

#[test]
fn raised_arms_come_down_soon_after_the_last_step_against_a_fall() {
    let body = builtin().body;
    let chest = body.joint(Role::Chest).expect("a chest");
    let arms = [Role::LeftUpperArm, Role::RightUpperArm].map(|role| body.joint(role).expect("an arm"));
    for degrees in [0.0, 90.0, 180.0, 225.0] {
        let run = run(&body, &[shove(&body, 400.0, 0.2, degrees)], 7.0, FREE);
        let hangs = |pose: &BodyPose| arms.map(|arm| pose.turns[chest].inverse() * pose.turns[arm]);
        let still = hangs(&run.poses[0]);
        let raised = |pose: &BodyPose| {
            let now = hangs(pose);
            f64::max(now[0].angle_between(still[0]), now[1].angle_between(still[1])).to_degrees()
        };
        // Balance is regained with the last step against a fall, and with those that follow it at once.
        let caught = run.trace.steps.iter().fold(0.7, |caught: f64, step| {
            let fights = step.kind == StepKind::Corrective || step.lift < caught + 0.3;
            if fights { step.land } else { caught }
        });
        let most = run.poses.iter().map(raised).fold(0.0, f64::max);
        // An unhurried step that lands later has them swing, as far as people's do in a slow walk.
        let lands = |after: f64| run.trace.steps.iter().map(|step| step.land).find(|land| *land > after);
        let (down, next) = (caught + 1.3, lands(caught + 1.3).unwrap_or(f64::INFINITY));
        let index = |time: f64| ((time / run.trace.dt) as usize).min(run.poses.len());
        let at_most = |poses: &[BodyPose]| poses.iter().map(raised).fold(0.0, f64::max);
        let (later, swung) = (at_most(&run.poses[index(down)..index(next)]), at_most(&run.poses[index(down)..]));
        println!("towards {degrees}: {most:.1} degrees, {later:.1} from {down:.2} s on, {swung:.1} after {next:.2} s");
        assert!(most > 25.0 && later < 8.0 && swung < 15.0, "towards {degrees}: {later:.0}, {swung:.0} of {most:.0}");
    }
}

#[test]
fn falls_on_its_own_where_help_holds_it_and_the_help_keeps_its_bounds() {
    let body = builtin().body;
    let hard = shove(&body, 560.0, 0.5, 90.0);
    assert!(run(&body, &[hard], 6.0, FREE).trace.lost.is_some());
    let helped = run(&body, &[hard], 6.0, Assist { torque: 300.0, force: 300.0 });
    assert!(helped.trace.lost.is_none());
    assert!(helped.help.force[0] > 1.0 && helped.help.force[0] <= 300.0 + 1e-6, "{:?}", helped.help.force);
    assert!(helped.help.torque[1] <= helped.help.torque[0], "{:?}", helped.help.torque);
}

/// Near the straight leg a knee's bend is given apart; the foot must go where it is wanted all the same.
#[test]
fn hip_and_ankle_make_up_for_a_knee_that_is_bent_apart() {
    let body = builtin().body;
    let (figure, pose) = standing(&body);
    let world = World::new(&figure, &figure.placed(&body, &pose), &Terrain::flat(), 0.01, 2).expect("a tree");
    let (mut states, mut motion) = (Vec::new(), Motion::default());
    world.read(&mut states);
    motion.read(&figure, &states);
    let wanted = Acceleration { linear: DVec3::new(5.0, 0.0, -20.0), angular: DVec3::ZERO };
    let (still, leg) = (Acceleration::default(), figure.legs[0]);
    for bend in [-60.0, 60.0] {
        let map = LegMap::new(&figure, &motion, leg, 0.05, Some((1.0, bend)));
        let turns = map.solve(&figure, &motion, &still, &wanted, DVec3::ZERO);
        let (mut at, mut above) = (0, still);
        for (link, turn) in leg.into_iter().zip(turns) {
            above = motion.child(&figure, link, &above, turn);
            at = link;
        }
        assert_eq!(at, leg[2]);
        assert!((turns[1].length() - 60.0).abs() < 1e-6, "the knee bends as told: {}", turns[1]);
        let missed = (above.linear - wanted.linear).with_y(0.0).length();
        assert!(missed < 1.0, "{missed} m/s² beside what was wanted of the foot");
    }
}

#[test]
fn a_run_is_the_same_to_the_last_bit() {
    let body = builtin().body;
    let told = |run: &Articulated| {
        let bits = |vector: DVec3| vector.to_array().map(f64::to_bits);
        let ticks = run.trace.ticks.iter().flat_map(|tick| [bits(tick.com), bits(tick.velocity)]);
        // FNV-1a.
        ticks
            .flatten()
            .flat_map(u64::to_le_bytes)
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    };
    let pushes = [shove(&body, 375.0, 0.2, 30.0)];
    let hashes: Vec<u64> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..3).map(|_| scope.spawn(|| told(&run(&body, &pushes, 5.0, FREE)))).collect();
        workers.into_iter().map(|worker| worker.join().expect("no panic")).collect()
    });
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:x?}");
    // Moves whenever the law does; on one platform, never else.
    if cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        assert_eq!(hashes[0], PINNED, "{:#x}", hashes[0]);
    }
}

const PINNED: u64 = 0xe68f_e646_1de8_b65a;

/// Seeded pushes on the chest, from and to so many N s.
fn drawn(body: &Body, first: u64, count: usize, impulse: [f64; 2]) -> Vec<KnownPush> {
    let chest = body.joint(Role::Chest).expect("the built-in rig has a chest");
    (first..first + count as u64)
        .map(|seed| {
            let mut draw = Seed::new(seed);
            let impulse = draw.between(impulse[0], impulse[1]);
            // The paper's pushes: at most 500 N.
            let seconds = draw.between(impulse / 500.0, 0.5);
            let angle = draw.between(0.0, std::f64::consts::TAU);
            let force = DVec3::new(angle.sin(), 0.0, angle.cos()) * (impulse / seconds);
            KnownPush { start: 0.5, end: 0.5 + seconds, force, at: PushPoint::Joint(chest) }
        })
        .collect()
}

fn looking(body: &Body, push: &KnownPush, options: ArticulatedOptions) -> Articulated {
    let anatomy = Anatomy::new(body);
    let physique = stand::physique(body, &anatomy);
    let options = ArticulatedOptions { duration: 4.0, extra: 0.0, ..options };
    simulate_articulated(body, &anatomy, &physique, &Terrain::flat(), &options, &[(*push, false)], FREE)
        .expect("the body does not break down")
}

#[test]
fn who_looks_ahead_falls_less_and_never_acts_before_the_push_is_felt() {
    let body = builtin().body;
    let pushes = drawn(&body, 9_100, 16, [180.0, 230.0]);
    let runs = |effort: u8| -> Vec<Articulated> {
        let options =
            ArticulatedOptions { ahead: Ahead { effort, ..Ahead::default() }, ..ArticulatedOptions::default() };
        pushes.iter().map(|push| looking(&body, push, options)).collect()
    };
    let (blind, ahead) = (runs(0), runs(1));
    let stand = |runs: &[Articulated]| runs.iter().filter(|run| run.trace.lost.is_none()).count();
    println!("{} of {} stand without, {} with", stand(&blind), pushes.len(), stand(&ahead));
    assert!(stand(&ahead) >= 14 && stand(&ahead) > stand(&blind));
    for (blind, ahead) in blind.iter().zip(&ahead) {
        assert_eq!(blind.search.tried, 0);
        let same = blind.trace.ticks.iter().zip(&ahead.trace.ticks).take_while(|(a, b)| a == b).count();
        // The push begins at 0.5 s and is felt 0.1 s on.
        assert!(same >= 60, "they part at {same}");
        assert!(ahead.search.chosen > 0 || same == ahead.trace.ticks.len().min(blind.trace.ticks.len()));
    }
}

#[test]
fn what_a_joint_gives_is_bounded_with_its_spring_and_damper() {
    let body = builtin().body;
    let mut most = 0.0_f64;
    for push in drawn(&body, 9_200, 24, [100.0, 240.0]) {
        let run = looking(&body, &push, ArticulatedOptions::default());
        let peak = run.torque_curves.iter().flatten().copied().fold(0.0_f32, f32::max);
        assert!(peak <= 500.01 && (f64::from(peak) - run.peak_torque).abs() < 1e-9, "{peak} N m");
        most = most.max(f64::from(peak));
    }
    println!("at most {most:.0} N m");
    assert!(most > 350.0, "nobody worked hard: {most} N m");
}

#[test]
fn people_differ_in_when_where_or_with_which_foot_they_step() {
    let body = builtin().body;
    let push = shove(&body, 400.0, 0.2, 180.0);
    let first = |seed: u64| {
        let options =
            ArticulatedOptions { personality: Personality::drawn(seed), seed, ..ArticulatedOptions::default() };
        let run = looking(&body, &push, options);
        let step = run.trace.steps.first().copied().expect("it steps");
        (step.side, step.lift, step.to.ankle)
    };
    let steps: Vec<_> = (1..7).map(first).collect();
    for (index, one) in steps.iter().enumerate() {
        for other in &steps[index + 1..] {
            let differ = one.0 != other.0 || (one.1 - other.1).abs() > 0.015 || one.2.distance(other.2) > 0.01;
            assert!(differ, "{one:?} and {other:?}");
        }
    }
    assert!(steps.iter().any(|step| step.0 != steps[0].0), "all with the same foot: {steps:?}");
}

/// Everybody of another seed, who looks ahead.
fn somebody(seed: u64) -> ArticulatedOptions {
    let ahead = Ahead { effort: 1, ..Ahead::default() };
    ArticulatedOptions { personality: Personality::drawn(seed), seed, ahead, ..ArticulatedOptions::default() }
}

#[test]
fn who_is_pushed_gently_does_not_march_on_the_spot() {
    let body = builtin().body;
    let pushes = drawn(&body, 9_300, 48, [10.0, 60.0]);
    let runs: Vec<Articulated> =
        pushes.iter().zip(700..).map(|(push, seed)| looking(&body, push, somebody(seed))).collect();
    let steps: Vec<usize> = runs.iter().map(|run| run.trace.steps.len()).collect();
    println!("steps of each: {steps:?}");
    assert!(runs.iter().all(|run| run.trace.lost.is_none()));
    // One against the push, one beside it, and as many again where the first was too short.
    assert!(steps.iter().all(|steps| *steps <= 6), "{steps:?}");
}

#[test]
fn who_steps_faces_where_he_did() {
    let body = builtin().body;
    let hips = body.joint(Role::Hips).expect("hips");
    let (mut most, mut stood) = (0.0_f64, 0);
    for (push, seed) in drawn(&body, 9_400, 24, [100.0, 220.0]).iter().zip(800..) {
        let run = looking(&body, push, somebody(seed));
        if run.trace.lost.is_some() {
            continue;
        }
        stood += 1;
        let rest = run.poses[0].turns[hips];
        let ahead = |tick: usize| (run.poses[tick].turns[hips] * rest.inverse() * DVec3::Z).with_y(0.0);
        most = most.max(ahead(run.poses.len() - 1).angle_between(ahead(0)));
    }
    println!("{stood} of 24 stand, turned by at most {:.0} degrees", most.to_degrees());
    assert!(stood >= 23, "{stood} of 24 stand");
    assert!(most < 25.0_f64.to_radians(), "{:.0} degrees", most.to_degrees());
}

#[test]
fn a_body_that_is_none_is_an_error_in_words() {
    let body = builtin().body;
    let (figure, pose) = standing(&body);
    let made = |change: &dyn Fn(&mut Figure)| {
        let mut figure = figure.clone();
        change(&mut figure);
        World::new(&figure, &figure.placed(&body, &pose), &Terrain::flat(), 0.01, 2).map(|_| ())
    };
    assert!(made(&|_| ()).is_ok());
    for (change, link) in [
        (&(|figure: &mut Figure| figure.links[3].mass = f64::NAN) as &dyn Fn(&mut Figure), "link 3"),
        (&|figure| figure.links[2].mass = 0.0, "link 2"),
        (&|figure| figure.links[4].anchor.x = f64::INFINITY, "link 4"),
    ] {
        let error = made(change).expect_err("no body").to_string();
        assert!(error.contains(link), "{error}");
    }
}

#[test]
fn who_is_to_give_up_falls_from_that_moment_on_and_not_before() {
    let body = builtin().body;
    let push = shove(&body, 300.0, 0.2, 180.0);
    let run = |gives_up: Option<f64>| {
        let ahead = Ahead { gives_up, ..Ahead::default() };
        looking(&body, &push, ArticulatedOptions { ahead, ..ArticulatedOptions::default() })
    };
    let (stands, falls) = (run(None), run(Some(1.3)));
    assert_eq!(stands.trace.lost, None);
    assert!((falls.trace.lost.expect("it falls") - 1.3).abs() < 1e-9, "{:?}", falls.trace.lost);
    for tick in 0..130 {
        assert_eq!(stands.trace.ticks[tick].com, falls.trace.ticks[tick].com, "tick {tick}");
    }
    let low = falls.poses.last().expect("poses").hips.y;
    assert!(low < 0.4 * stands.poses[0].hips.y, "it ends with its hips {low} m up");
}
