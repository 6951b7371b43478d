//! The table of the articulated body: seeded pushes of the paper's range on the trunk, five bins of impulse, root-free and with
//! the least help that recovers; and what a tick costs beside a bare step of the same bodies.
//!
//! `cargo bench --bench ragdoll` prints it for the built-in rig, 256 pushes a bin, on seeds that nothing was tuned on; words
//! after `--` are a number of pushes a bin and paths of other rigs, whose middle bins are printed.

#![expect(clippy::print_stdout, reason = "the table")]

use glam::DVec3;
use rayon::prelude::*;
use std::time::Instant;
use surefoot::maths::seed::Seed;
use surefoot::measure::{KnownPush, PushPoint};
use surefoot::model::{Body, Physique, Role, Terrain};
use surefoot::ragdoll::control::Assist;
use surefoot::ragdoll::{Controller, Figure, Locks, Tuning, World};
use surefoot::rig::{self, mannequin};
use surefoot::sim::{SimulateOptions, simulate_articulated};
use surefoot::whole_body::{Anatomy, Solver, stand};

/// The first seed of the held-out pushes: tuning used 1 to 400 000.
const HELD_OUT: u64 = 5_000_000;
/// Ns, the edges of the bins.
const EDGES: [f64; 6] = [0.0, 50.0, 100.0, 150.0, 200.0, 250.0];
/// Shares of the bins among the paper's pushes (10 to 500 N for 0.1 to 0.5 s).
const MIX: [f64; 5] = [0.39, 0.31, 0.18, 0.09, 0.03];
/// Wanted root-free, %.
const WANTED: [f64; 5] = [100.0, 98.0, 93.0, 70.0, 45.0];
/// Help that is allowed in each bin, N m and N, for a body of 89.5 kg.
const ALLOWED: [[f64; 2]; 5] = [[0.0, 0.0], [60.0, 0.0], [100.0, 0.0], [200.0, 0.0], [300.0, 300.0]];

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

    /// Whether it stays up, and whether it then stands still.
    fn pushed(&self, push: &KnownPush, [torque, force]: [f64; 2]) -> (bool, bool) {
        let scale = self.physique.mass / 89.5;
        let options = SimulateOptions { duration: push.start + 8.0, extra: 0.0, ..SimulateOptions::default() };
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
    let count = words.iter().find_map(|word| word.parse().ok()).unwrap_or(256);
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let builtin = rig::load_bytes("builtin", mannequin::BUILTIN, &alone, None).expect("the built-in rig loads").body;
    let builtin = Subject::new("builtin", builtin);
    table(&builtin, count, &[0, 1, 2, 3, 4]);
    standing(&builtin);
    for path in words.iter().filter(|word| word.parse::<usize>().is_err()) {
        match rig::load(std::path::Path::new(path)) {
            Ok(loaded) => table(&Subject::new(path, loaded.body), count, &[1, 2]),
            Err(error) => println!("{path}: {error}"),
        }
    }
    ticks(&builtin);
}

fn table(subject: &Subject, count: usize, bins: &[usize]) {
    println!("\n{}, {:.1} kg, {count} pushes a bin\n", subject.name, subject.physique.mass);
    println!("impulse, Ns | root-free %  (95 % interval) | wanted | at rest % | with help %, at most");
    let mut mix = 0.0;
    for &bin in bins {
        let pushes = pushes(&subject.body, EDGES[bin], EDGES[bin + 1], count);
        let free: Vec<(bool, bool)> = pushes.par_iter().map(|push| subject.pushed(push, [0.0, 0.0])).collect();
        let up = free.iter().filter(|(up, _)| *up).count();
        let rests = free.iter().filter(|(up, rests)| *up && *rests).count();
        let allowed = ALLOWED[bin];
        let helped = pushes
            .par_iter()
            .zip(&free)
            .filter(|(push, (up, _))| {
                *up || allowed != [0.0, 0.0] && ladder(allowed).iter().any(|bound| subject.pushed(push, *bound).0)
            })
            .count();
        let [low, high] = wilson(up, count);
        println!(
            "{:>3.0} to {:>3.0}  | {:>6.1} ({low:.1} to {high:.1})      | {:>6.0} | {:>8.1}  | {:>6.1}, {:.0} N m and {:.0} N",
            EDGES[bin],
            EDGES[bin + 1],
            share(up, count),
            WANTED[bin],
            share(rests, up.max(1)),
            share(helped, count),
            allowed[0],
            allowed[1]
        );
        mix += MIX[bin] * share(up, count);
    }
    if bins.len() == MIX.len() {
        println!("the paper's mix: {mix:.1} % root-free (wanted 94)");
    }
}

/// Bounds up to that one.
fn ladder([torque, force]: [f64; 2]) -> Vec<[f64; 2]> {
    (1..=4).map(|part| f64::from(part) / 4.0).map(|share| [torque * share, force * share]).collect()
}

fn share(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole as f64
}

/// Wilson's interval for a share, %.
fn wilson(part: usize, whole: usize) -> [f64; 2] {
    let (n, p, z) = (whole as f64, part as f64 / whole as f64, 1.96);
    let middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    [100.0 * (middle - half).max(0.0), 100.0 * (middle + half).min(1.0)]
}

/// Seeded pushes on the trunk whose impulses lie in a bin.
fn pushes(body: &Body, low: f64, high: f64, count: usize) -> Vec<KnownPush> {
    let chest = [Role::Chest, Role::Spine, Role::Hips].into_iter().find_map(|role| body.joint(role)).unwrap_or(0);
    (HELD_OUT..)
        .map(|seed| {
            let mut draw = Seed::new(seed);
            let start = draw.between(0.5, 1.5);
            let duration = draw.between(0.1, 0.5);
            let force = draw.between(10.0, 500.0);
            let angle = draw.between(0.0, std::f64::consts::TAU);
            let force = DVec3::new(angle.sin(), 0.0, angle.cos()) * force;
            KnownPush { start, end: start + duration, force, at: PushPoint::Joint(chest) }
        })
        .filter(|push| (low..high).contains(&(push.force.length() * (push.end - push.start))))
        .take(count)
        .collect()
}

/// A minute of standing, and 60 Ns from 16 directions.
fn standing(subject: &Subject) {
    let chest = subject.body.joint(Role::Chest).unwrap_or(0);
    let options = SimulateOptions { duration: 60.0, extra: 0.0, ..SimulateOptions::default() };
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
            "\nstanding 60 s: drift {:.1} mm from the start, {:.1} mm after the first second",
            drift(0),
            drift(100)
        );
    }
    let sixteen = (0..16)
        .filter(|index| {
            let angle = f64::from(*index) * std::f64::consts::TAU / 16.0;
            let force = DVec3::new(angle.sin(), 0.0, angle.cos()) * 300.0;
            subject.pushed(&KnownPush { start: 0.5, end: 0.7, force, at: PushPoint::Joint(chest) }, [0.0, 0.0]).0
        })
        .count();
    println!("300 N for 0.2 s: {sixteen} of 16 directions root-free");
}

/// What a tick costs, on one thread.
fn ticks(subject: &Subject) {
    let plants = stand::natural_plants(subject.physique.stance_width, subject.physique.com_forward);
    let com = DVec3::Y * subject.physique.com_height;
    let target = stand::stand_target(&subject.body, &plants, com, 0.0);
    let pose = Solver::new(&subject.body, &subject.anatomy).solve(&target).pose;
    println!();
    for (name, locks) in
        [("all joints", Locks::default()), ("hands and head locked", Locks { hands: true, head: true })]
    {
        let figure = Figure::new(&subject.body, &pose, locks);
        let terrain = Terrain::flat();
        let mut world = World::new(&figure, &figure.placed(&subject.body, &pose), &terrain, 0.01, 4);
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
        println!("tick, {name}: {:.0} µs (law {law:.0}, rapier {step:.0}; median of 3000)", law + step);
    }
}
