//! The table of the articulated body: seeded pushes of the paper's range on the trunk, five bins of impulse, root-free and with
//! the least help that recovers; standing, platforms, walks, balls, a box; what a tick costs. `clips.rs` prints what clips come of
//! such pushes.
//!
//! `cargo bench --bench ragdoll` prints it all for the built-in rig and the middle bins for two rigs that nobody here made, where
//! their files are there: 64 pushes a bin on seeds that nothing was tuned on, about a minute on two free cores. Words after `--`: a
//! number of pushes a bin (256 for narrow intervals: the built-in rig's take two minutes), paths of other rigs, and names of sections
//! (`pushes`, `standing`, `platform`, `walk`, `balls`, `box`, `ticks`) to print these alone. Beside the ticks stands what MuJoCo takes,
//! where `python3` has it.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../common.rs"]
mod common;
#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "shoves.rs"]
mod shoves;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use shoves::{AHEAD, COUNT, EDGES, HEAVY, HELD_OUT, OTHERS, Shove, WANTED, share, wilson};
use std::path::PathBuf;
use std::time::Instant;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::measure::{KnownPush, PushPoint};
use surefoot::model::report::Outcome;
use surefoot::model::scenario::{Carry, Direction, Ground, GroundKind, Throw};
use surefoot::model::{Body, Physique, Role, Scenario, Terrain};
use surefoot::ragdoll::control::Assist;
use surefoot::ragdoll::{Controller, Figure, Locks, Tuning, World};
use surefoot::rig::{self, Rig};
use surefoot::sim::{Ahead, Articulated, ArticulatedOptions, Things, simulate_articulated, simulate_with};
use surefoot::stepper::Inputs;
use surefoot::whole_body::reaction::Personality;
use surefoot::whole_body::{Anatomy, Solver, stand};

/// Shares of the bins among the paper's pushes (10 to 500 N for 0.1 to 0.5 s).
const MIX: [f64; 5] = [0.39, 0.31, 0.18, 0.09, 0.03];
/// Wanted with help, %.
const HELPED: [f64; 5] = [100.0, 100.0, 100.0, 99.0, 97.0];
/// Help that is allowed in each bin, N m and N, for a body of 89.5 kg.
const ALLOWED: [[f64; 2]; 5] = [[0.0, 0.0], [60.0, 0.0], [100.0, 0.0], [200.0, 0.0], [300.0, 300.0]];
const FREE: Assist = Assist { torque: 0.0, force: 0.0 };

struct Subject {
    name: String,
    body: Body,
    anatomy: Anatomy,
    physique: Physique,
}

impl Subject {
    fn new(name: &str, body: Body) -> Subject {
        let anatomy = Anatomy::new(&body);
        let physique = stand::physique(&body, &anatomy);
        Subject { name: name.into(), body, anatomy, physique }
    }

    /// Whether it stays up, and whether it then stands still; as the person of that seed.
    fn pushed(&self, (person, push): (usize, &KnownPush), [torque, force]: [f64; 2], effort: u8) -> (bool, bool) {
        let scale = self.physique.mass / HEAVY;
        let ahead = Ahead { effort, ..Ahead::default() };
        let options = ArticulatedOptions {
            duration: push.start + 8.0,
            extra: 0.0,
            personality: Personality::drawn(person as u64),
            seed: person as u64,
            ahead,
            ..ArticulatedOptions::default()
        };
        let push = KnownPush { force: push.force * scale, ..*push };
        let assist = Assist { torque: torque * scale, force: force * scale };
        let run = simulate_articulated(
            &self.body,
            &self.anatomy,
            &self.physique,
            &Terrain::flat(),
            &options,
            &[(push, false)],
            assist,
        );
        run.map_or((false, false), |run| (run.trace.lost.is_none(), run.trace.rest >= 0.5))
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let sections = ["pushes", "standing", "platform", "walk", "balls", "box", "ticks"];
    let named = |word: &String| sections.contains(&word.as_str());
    let wants = |section: &str| !words.iter().any(named) || words.iter().any(|word| word == section);
    let count = words.iter().find_map(|word| word.parse().ok()).unwrap_or(COUNT);
    let rig = common::builtin();
    let builtin = Subject::new("builtin", rig.body.clone());
    if wants("pushes") {
        table(&builtin, count, &[0, 1, 2, 3, 4]);
        let given = words.iter().filter(|word| word.parse::<usize>().is_err() && !named(word)).map(PathBuf::from);
        for path in shoves::files(&OTHERS).into_iter().chain(given) {
            match rig::load(&path) {
                Ok(loaded) => table(&Subject::new(&path.display().to_string(), loaded.body), count, &[1, 2]),
                Err(error) => println!("{}: {error}", path.display()),
            }
        }
    }
    println!();
    for (section, print) in [
        ("standing", &(|| standing(&builtin)) as &dyn Fn()),
        ("platform", &|| platforms(&builtin)),
        ("walk", &|| walks(&builtin)),
        ("balls", &|| balls(&rig)),
        ("box", &|| boxes(&rig)),
        ("ticks", &|| ticks(&builtin)),
    ] {
        if wants(section) {
            print();
        }
    }
}

fn table(subject: &Subject, count: usize, bins: &[usize]) {
    println!("\n{}, {:.1} kg, {count} pushes a bin\n", subject.name, subject.physique.mass);
    println!(
        "impulse, Ns | root-free %  (95 % interval) | of wanted | looking ahead, % of wanted | at rest % of 90 | with help % of wanted, at most"
    );
    let mut mix = 0.0;
    for &bin in bins {
        let pushes: Vec<KnownPush> = shoves::drawn(bin, count).iter().map(|shove| shove.known(&subject.body)).collect();
        let each = || pushes.par_iter().enumerate();
        let free: Vec<(bool, bool)> = each().map(|push| subject.pushed(push, [0.0, 0.0], 0)).collect();
        let ahead = each().filter(|push| subject.pushed(*push, [0.0, 0.0], 1).0).count();
        let up = free.iter().filter(|(up, _)| *up).count();
        let rests = free.iter().filter(|(up, rests)| *up && *rests).count();
        let allowed = ALLOWED[bin];
        let helped = each()
            .zip(&free)
            .filter(|(push, (up, _))| {
                *up || allowed != [0.0, 0.0] && ladder(allowed).iter().any(|bound| subject.pushed(*push, *bound, 0).0)
            })
            .count();
        let [low, high] = wilson(up, count);
        println!(
            "{:>3.0} to {:>3.0}  | {:>6.1} ({low:.1} to {high:.1})      | {:>9.0} | {:>16.1} of {:>6.0} | {:>15.1} | {:>6.1} of {:.0}, {:.0} N m and {:.0} N",
            EDGES[bin],
            EDGES[bin + 1],
            share(up, count),
            WANTED[bin],
            share(ahead, count),
            AHEAD[bin],
            share(rests, up.max(1)),
            share(helped, count),
            HELPED[bin],
            allowed[0],
            allowed[1]
        );
        mix += MIX[bin] * share(up, count);
    }
    if bins.len() == MIX.len() {
        println!("the paper's mix: {mix:.1} % root-free of wanted 94");
    }
}

/// Bounds up to that one.
fn ladder([torque, force]: [f64; 2]) -> Vec<[f64; 2]> {
    (1..=4).map(|part| f64::from(part) / 4.0).map(|share| [torque * share, force * share]).collect()
}

/// A minute of standing, and 60 Ns from 16 directions.
fn standing(subject: &Subject) {
    let chest = subject.body.joint(Role::Chest).unwrap_or(0);
    let options = ArticulatedOptions { duration: 60.0, extra: 0.0, ..ArticulatedOptions::default() };
    let run = simulate_articulated(
        &subject.body,
        &subject.anatomy,
        &subject.physique,
        &Terrain::flat(),
        &options,
        &[],
        Assist::default(),
    );
    if let Ok(run) = run {
        let ticks = &run.trace.ticks;
        let drift = |from: usize| (ticks[ticks.len() - 1].com - ticks[from].com).with_y(0.0).length() * 1000.0;
        println!(
            "standing 60 s: drift {:.1} mm of wanted 5, {:.1} mm of it after the first second",
            drift(0),
            drift(100)
        );
    }
    let sixteen = (0..16)
        .filter(|index| {
            let angle = f64::from(*index) * std::f64::consts::TAU / 16.0;
            let force = DVec3::new(angle.sin(), 0.0, angle.cos()) * 300.0;
            let push = KnownPush { start: 0.5, end: 0.7, force, at: PushPoint::Joint(chest) };
            subject.pushed((*index as usize, &push), [0.0, 0.0], 0).0
        })
        .count();
    println!("300 N for 0.2 s: {sixteen} of wanted 16 directions root-free");
}

/// s and newtons: every 5 s a shove of 100 N for 0.2 s, each from elsewhere.
fn every_five_seconds(body: &Body, until: f64) -> Vec<(KnownPush, bool)> {
    let chest = PushPoint::Joint(body.joint(Role::Chest).unwrap_or(0));
    let shove = |index: i32| {
        let (sin, cos) = (f64::from(index) * 2.4).sin_cos(); // the golden angle: no two alike
        let start = 5.0 * f64::from(index + 1);
        (KnownPush { start, end: start + 0.2, force: DVec3::new(sin, 0.0, cos) * 100.0, at: chest }, false)
    };
    (0..100).map(shove).take_while(|(push, _)| push.end < until).collect()
}

/// A minute on a platform that turns, with shoves, root-free.
fn platforms(subject: &Subject) {
    let swing = |most: f64, period: f64, phase: f64| -> Vec<[f64; 2]> {
        let turn = |index: i32| {
            let time = f64::from(index) * 0.25;
            let angle = std::f64::consts::TAU * time / period + phase;
            [time, most.to_radians() * angle.sin() * (time / 6.0).min(1.0)]
        };
        (0..=240).map(turn).collect()
    };
    let still = || vec![[0.0, 0.0]];
    // As a scenario would write it: 3 degrees a second.
    let slow = || {
        [[0.0, 0.0], [10.0, 30.0], [30.0, -30.0], [50.0, 30.0], [60.0, 0.0]]
            .map(|[time, angle]: [f64; 2]| [time, angle.to_radians()])
            .to_vec()
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    let rows = [
        ("pitch to 30 degrees at 3 a second", slow(), still()),
        ("roll to 30 degrees at 3 a second", still(), slow()),
        ("gyrating to 20 degrees in 24 s a turn", swing(20.0, 24.0, 0.0), swing(20.0, 24.0, quarter)),
        ("pitch to 30 degrees in 12 s a turn", swing(30.0, 12.0, 0.0), still()),
        ("roll to 30 degrees in 12 s a turn", still(), swing(30.0, 12.0, 0.0)),
    ];
    let told: Vec<String> = rows
        .into_par_iter()
        .map(|(name, pitch, roll)| {
            let terrain = Terrain::new(&Ground { kind: GroundKind::Platform { pitch, roll }, friction: 1.0 });
            let options = ArticulatedOptions { duration: 60.0, extra: 0.0, ..ArticulatedOptions::default() };
            let (body, pushes) = (&subject.body, every_five_seconds(&subject.body, 60.0));
            let run =
                simulate_articulated(body, &subject.anatomy, &subject.physique, &terrain, &options, &pushes, FREE);
            match run {
                Ok(run) => {
                    let (up, steps) = (run.trace.lost.unwrap_or(60.0), run.trace.steps.len());
                    format!("platform, {name}, 100 N every 5 s: up for {up:.1} of wanted 60 s, {steps} steps")
                }
                Err(broken) => format!("platform, {name}: {broken}"),
            }
        })
        .collect();
    told.iter().for_each(|line| println!("{line}"));
}

impl Subject {
    /// Walks straight on from 0.5 s, root-free, looking ahead that far.
    fn walks(&self, speed: f64, duration: f64, pushes: &[(KnownPush, bool)], effort: u8) -> Option<Articulated> {
        let ahead = Ahead { effort, ..Ahead::default() };
        let options = ArticulatedOptions { duration, extra: 0.0, ahead, ..ArticulatedOptions::default() };
        let order = |time: f64| {
            let velocity = if time >= 0.5 { DVec2::Y * speed } else { DVec2::ZERO };
            Some(Inputs { walk: Some(velocity), ..Inputs::default() })
        };
        let things = Things { intent: &order, ..Things::none() };
        let flat = Terrain::flat();
        simulate_with(&self.body, &self.anatomy, &self.physique, &flat, &options, pushes, FREE, &things).ok()
    }
}

/// Pushes of walkers.
const WALKERS: u64 = 256;

impl Subject {
    /// A walk at 1.2 m/s under a push of the paper's range at any time, from anywhere.
    fn struck(&self, index: u64, effort: u8) -> Option<Articulated> {
        let mut draw = Seed::new(HELD_OUT.wrapping_add(7 * index));
        let heading = draw.between(0.0, std::f64::consts::TAU);
        let force = DVec3::new(heading.sin(), 0.0, heading.cos()) * draw.between(10.0, 500.0);
        let start = draw.between(4.0, 6.0);
        let at = PushPoint::Joint(self.body.joint(Role::Chest).unwrap_or(0));
        let push = KnownPush { start, end: start + draw.between(0.1, 0.5), force, at };
        self.walks(1.2, start + 5.0, &[(push, false)], effort)
    }
}

/// A minute of walking, and shoves on the way.
fn walks(subject: &Subject) {
    let mean = |run: &Articulated, from: f64| {
        let ticks = &run.trace.ticks;
        let (first, last) = (&ticks[((from / run.trace.dt) as usize).min(ticks.len() - 1)], &ticks[ticks.len() - 1]);
        (last.com - first.com).with_y(0.0).length() / ((ticks.len() - 1) as f64 * run.trace.dt - from).max(0.01)
    };
    let told: Vec<String> = [0.6, 1.0, 1.2]
        .into_par_iter()
        .map(|speed| match subject.walks(speed, 60.0, &[], 0) {
            Some(run) => {
                let up = run.trace.lost.unwrap_or(60.0);
                format!(
                    "walk at {speed} m/s: up for {up:.1} of wanted 60 s, {:.2} m/s in the mean from 4 s on",
                    mean(&run, 4.0)
                )
            }
            None => format!("walk at {speed} m/s: breaks down"),
        })
        .collect();
    told.iter().for_each(|line| println!("{line}"));
    let chest = PushPoint::Joint(subject.body.joint(Role::Chest).unwrap_or(0));
    let goes_on = (0..16)
        .into_par_iter()
        .filter(|index| {
            let (sin, cos) = (f64::from(*index) * std::f64::consts::TAU / 16.0).sin_cos();
            // Held-out moments of the stride.
            let start = 6.31 + 0.11 * f64::from(*index);
            let push = KnownPush { start, end: start + 0.2, force: DVec3::new(sin, 0.0, cos) * 100.0, at: chest };
            let run = subject.walks(1.2, 14.0, &[(push, false)], 0);
            run.is_some_and(|run| run.trace.lost.is_none() && mean(&run, 12.0) > 1.0)
        })
        .count();
    println!("walk at 1.2 m/s, 100 N for 0.2 s: {goes_on} of 16 go on, of wanted 14.4");
    let [without, with] = [0, 1].map(|effort| {
        let stays = |index: &u64| subject.struck(*index, effort).is_some_and(|run| run.trace.lost.is_none());
        let count = (0..WALKERS).into_par_iter().filter(stays).count();
        share(count, WALKERS as usize)
    });
    println!(
        "walk at 1.2 m/s, pushes of 10 to 500 N for 0.1 to 0.5 s: {with:.1} % keep their feet, of wanted 97; without search {without:.1}"
    );
}

/// Bakes on the built-in rig with that help.
fn baked(rig: &Rig, scenario: &Scenario, helped: Helped) -> Option<Baked> {
    bake(rig, scenario, &BakeOptions { drive: Drive::Ragdoll(helped), ..BakeOptions::default() }).ok()
}

fn stays(baked: &Option<Baked>) -> bool {
    baked.as_ref().is_some_and(|baked| baked.report.outcome != Outcome::Fall)
}

/// Twenty balls from two sides within 10 s, root-free.
fn balls(rig: &Rig) {
    let throw = |start: f64, speed: f64, from: Direction| Throw {
        start,
        count: 10,
        interval: 1.0,
        radius: [0.1, 0.2],
        density: 50.0,
        speed,
        from,
        at: Role::Chest,
        spread: 0.2,
    };
    let throw = vec![throw(0.5, 8.0, Direction::Front), throw(1.0, 10.0, Direction::Left)];
    let scenario = Scenario { duration: 11.0, throw, ..Scenario::default() };
    let up = (HELD_OUT..HELD_OUT + 10)
        .into_par_iter()
        .filter(|seed| stays(&baked(rig, &Scenario { seed: *seed, ..scenario.clone() }, Helped::Within(FREE))))
        .count();
    println!("20 balls of 0.1 to 0.2 m at 8 to 10 m/s: {up} of 10 seeds stay up root-free, of wanted 9");
}

/// A box whose mass grows from 2 to 25 kg, and a shove from sixteen sides.
fn boxes(rig: &Rig) {
    let carry = Carry {
        start: 0.0,
        end: None,
        mass: vec![[0.0, 2.0], [5.0, 25.0]],
        size: vec![(0.0, DVec3::new(0.4, 0.3, 0.3))],
    };
    let up = |helped: Helped| {
        (0..16)
            .into_par_iter()
            .filter(|index| {
                let heading = f64::from(*index) * std::f64::consts::TAU / 16.0;
                let scenario = Shove { start: 4.0, duration: 0.2, force: 100.0, heading }.scenario(7.0);
                stays(&baked(rig, &Scenario { carry: vec![carry.clone()], ..scenario }, helped))
            })
            .count()
    };
    println!(
        "box of 2 to 25 kg, 100 N for 0.2 s: {} of 16 root-free, {} with help of wanted 16",
        up(Helped::Within(FREE)),
        up(Helped::Auto)
    );
}

/// What a tick costs, on one thread.
fn ticks(subject: &Subject) {
    let target = stand::natural_stand(&subject.body, &subject.physique);
    let pose = Solver::new(&subject.body, &subject.anatomy).solve(&target).pose;
    for (name, locks, wanted) in [
        ("all joints", Locks::default(), 60),
        ("hands and head locked", Locks { hands: true, head: true, ..Locks::default() }, 55),
    ] {
        let figure = Figure::new(&subject.body, &pose, locks);
        let terrain = Terrain::flat();
        let mut world = World::new(&figure, &figure.placed(&subject.body, &pose), &terrain, 0.01, 2).expect("a tree");
        let mut control = Controller::new(&figure, &world, Tuning::default());
        let (mut law, mut step) = (Vec::new(), Vec::new());
        for tick in 0..3000 {
            world.clear_forces();
            let begun = Instant::now();
            control.tick(&figure, &mut world, &terrain);
            law.push(begun.elapsed().as_secs_f64() * 1e6);
            if tick % 300 < 20 {
                world.push(figure.trunk, DVec3::X * 250.0, control.states()[figure.trunk].origin, DVec3::ZERO);
            }
            let begun = Instant::now();
            world.step(&terrain, f64::from(tick + 1) * 0.01);
            step.push(begun.elapsed().as_secs_f64() * 1e6);
        }
        law.sort_by(f64::total_cmp);
        step.sort_by(f64::total_cmp);
        let (law, step) = (law[1500], step[1500]);
        println!(
            "tick, {name}: {:.0} µs of wanted {wanted} (law {law:.0}, links {step:.0}; median of 3000)",
            law + step
        );
    }
    println!("{}", mujoco());
}

/// What a step takes in MuJoCo, on this machine and now; or why that is not known.
fn mujoco() -> String {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/tools/mujoco_tick.py");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    match std::process::Command::new("python3").arg(script).output() {
        Ok(output) if output.status.success() => text(&output.stdout),
        Ok(output) => text(&output.stderr),
        Err(error) => format!("skipped: MuJoCo, for python3 does not start: {error}"),
    }
}
