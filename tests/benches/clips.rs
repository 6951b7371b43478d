//! What a user gets of the articulated body: whole clips, baked as the command line bakes them, and what is measured on each.
//!
//! `cargo bench --bench clips` prints four tables; words after `--` choose some of them:
//! `pushes` held-out shoves of at most 500 N at the chest in five bins of impulse, as `--drive ragdoll --assist off` bakes them;
//! `grid` six rigs x 8 directions x 30, 60 and 120 Ns as `--drive ragdoll` does, by what nobody should see in a clip;
//! `batch` clips a second; `same` one scenario six times, byte by byte.
//! A number is that of shoves a bin, any other word a part of a rig's name; `scaled`: shoves are as large for each body as they are for
//! 89.5 kg; `-v`: each clip on a line. All of it takes some minutes. Rigs that nobody here made are left out where their files are not there.
//!
//! Seconds are of one thread, from the scenario to the bytes of the files, and hold for the profile that the first line names: `cargo
//! bench` builds as `cargo install` does. `cargo test --bench clips` builds the tests' profile, whose code is slower and checks more; all
//! but the seconds is the same there.

#![expect(clippy::print_stdout, reason = "the tables")]

#[path = "batched.rs"]
mod batched;
#[path = "../common.rs"]
mod common;
#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "shoves.rs"]
#[expect(dead_code, reason = "clips are made of scenarios, not of runs")]
mod shoves;

use rayon::prelude::*;
use shoves::{AHEAD, COUNT, EDGES, HEAVY, OTHERS, Shove, WANTED, share, wilson};
use std::sync::Arc;
use std::time::Instant;
use surefoot::bake::{BakeOptions, Drive, Helped, bake, gated};
use surefoot::export::{self, Exported, Form};
use surefoot::measure::gate::{LEAST_LEGS, LONGEST_HOVER};
use surefoot::measure::percentile;
use surefoot::model::ClipReport;
use surefoot::model::report::Outcome;
use surefoot::ragdoll::control::Assist;
use surefoot::rig::{Rig, load};

/// s, when a shove begins, and how long the clip is.
const WHEN: (f64, f64) = (0.6, 4.0);
/// Beside the built-in rig, for the grid: of five makers.
const FIVE: [&str; 5] =
    ["m2m_human_male.glb", "gdquest_mannequiny.glb", "kaykit_Knight.glb", "godette_vrm0.vrm", "vrm1_debug_robot.vrm"];
/// Ns of the grid.
const IMPULSES: [f64; 3] = [30.0, 60.0, 120.0];
/// Degrees, less beyond its range than this a joint is within: nobody sees half a degree.
const IN_RANGE: f64 = 0.5;
/// Share of the moving frames that should have their ZMP inside.
const INSIDE: f64 = 0.98;

/// A clip as the files say it, and what it took.
struct Made {
    report: ClipReport,
    files: Exported,
    /// The gate made a fall of a run that stood.
    gated: bool,
    /// s.
    took: f64,
}

impl Made {
    /// Bakes a shove of the person of a seed and makes its files, all but the disk.
    fn of(rig: &Rig, shove: &Shove, helped: Helped, effort: u8, seed: u64) -> Result<Made, String> {
        let begun = Instant::now();
        let drive = Drive::Ragdoll(helped);
        let options = BakeOptions { drive, effort, seed: Some(seed), ..BakeOptions::default() };
        let baked = bake(rig, &shove.scenario(WHEN.1), &options).map_err(|error| error.to_string())?;
        let files = export::baked(rig, &baked, Form::default()).map_err(|error| error.to_string())?;
        let took = begun.elapsed().as_secs_f64();
        let gated = baked.warnings.iter().any(|warning| warning.starts_with(gated::FALLS));
        Ok(Made { report: baked.report, files, gated, took })
    }

    fn stands(&self) -> bool {
        self.report.outcome != Outcome::Fall
    }

    /// mm and degrees off the run.
    fn drift(&self) -> [f64; 2] {
        self.report.drift.as_ref().map_or([0.0; 2], |drift| [drift.position_mm, drift.angle_deg])
    }

    fn told(&self, rig: &str, shove: &Shove) -> String {
        let (report, found) = (&self.report, &self.report.plausibility);
        let [place, turn] = self.drift();
        format!(
            "{rig} {:.0} Ns in {:.2} s towards {:.0}: {:?}{} {} steps, {:.2} s, score {:.2}, ZMP {:.3}, residual {:.3}, hover {:.2} s, legs {:.0} mm, {} pops, {:.1} degrees out of range, {:.0} Nm of help, drift {place:.2} mm {turn:.2} deg",
            shove.impulse(),
            shove.duration,
            shove.heading.to_degrees(),
            report.outcome,
            if self.gated { " (the gate's)" } else { "" },
            report.steps,
            self.took,
            found.score,
            found.zmp_inside,
            found.residual_force,
            found.hover_longest_s,
            found.legs_mm,
            found.pops,
            found.joint_excess_deg,
            report.assist.peak_nm
        )
    }
}

/// What was asked for on the command line.
struct Asked {
    words: Vec<String>,
    verbose: bool,
    scaled: bool,
}

impl Asked {
    fn rigs(&self, names: &[&str]) -> Vec<(String, Rig)> {
        let files = shoves::files(names).into_iter().filter_map(|path| match load(&path) {
            Ok(rig) => Some((path.file_stem()?.to_string_lossy().into_owned(), rig)),
            Err(error) => {
                println!("{}: {error}", path.display());
                None
            }
        });
        let all = std::iter::once(("builtin".to_owned(), common::builtin())).chain(files);
        all.filter(|(name, _)| self.words.is_empty() || self.words.iter().any(|word| name.contains(word))).collect()
    }

    /// A shove of the table, for that body.
    fn shove(&self, rig: &Rig, shove: Shove) -> Shove {
        let scale = if self.scaled { rig.body.mass / HEAVY } else { 1.0 };
        Shove { start: WHEN.0, force: shove.force * scale, ..shove }
    }

    /// The clip of a shove; what could not be made is told.
    fn made(&self, (name, rig): &(String, Rig), shove: &Shove, how: (Helped, u8, u64)) -> Option<Made> {
        let (helped, effort, seed) = how;
        let made = Made::of(rig, shove, helped, effort, seed);
        match &made {
            Ok(made) if self.verbose => println!("{}", made.told(name, shove)),
            Ok(_) => {}
            Err(error) => println!("{name}, {shove:?}: {error}"),
        }
        made.ok()
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let tables = ["pushes", "grid", "batch", "same"];
    let (chosen, words): (Vec<_>, Vec<_>) = words.into_iter().partition(|word| tables.contains(&word.as_str()));
    let (numbers, words): (Vec<_>, Vec<_>) = words.into_iter().partition(|word| word.parse::<usize>().is_ok());
    let (scaled, words): (Vec<_>, Vec<_>) = words.into_iter().partition(|word| word == "scaled");
    let verbose = std::env::args().any(|word| word == "-v");
    let asked = Asked { words, verbose, scaled: !scaled.is_empty() };
    let count = numbers.iter().find_map(|word| word.parse().ok()).unwrap_or(COUNT);
    println!(
        "{}; shoves {}",
        if cfg!(debug_assertions) {
            "the tests' profile: its seconds do not hold for users"
        } else {
            "the profile that users build"
        },
        if asked.scaled { "as large for each body as for 89.5 kg" } else { "as written, whatever the body weighs" }
    );
    for (table, print) in [
        ("pushes", &(|| pushes(&asked, count)) as &dyn Fn()),
        ("grid", &|| grid(&asked)),
        ("batch", &batch),
        ("same", &same),
    ] {
        if chosen.is_empty() || chosen.iter().any(|word| word == table) {
            print();
        }
    }
}

/// Held-out shoves, a row a bin.
fn pushes(asked: &Asked, count: usize) {
    for named in asked.rigs(&OTHERS) {
        println!(
            "\n{}, {:.1} kg, {count} shoves a bin, --drive ragdoll --assist off, each of another person (--seed)",
            named.0, named.1.body.mass
        );
        println!(
            "impulse, Ns | --effort 0: stand, % of wanted | --effort 1: stand, % (95 % interval) of wanted | fall by the gate | of those that stand: score, ZMP inside, % without pops, % in range | drift at most | s, median and 95 %"
        );
        for bin in 0..AHEAD.len() {
            let shoves: Vec<Shove> =
                shoves::drawn(bin, count).into_iter().map(|shove| asked.shove(&named.1, shove)).collect();
            // One after the other: seconds of one thread.
            let made = |effort: u8| -> Vec<Made> {
                let how = |seed: usize| (Helped::Within(Assist::default()), effort, seed as u64);
                shoves.iter().enumerate().filter_map(|(seed, shove)| asked.made(&named, shove, how(seed))).collect()
            };
            println!("{}", row(bin, count, &made(0), &made(1)));
        }
    }
}

fn row(bin: usize, count: usize, plain: &[Made], made: &[Made]) -> String {
    let standing: Vec<&Made> = made.iter().filter(|made| made.stands()).collect();
    let up = standing.len();
    let [low, high] = wilson(up, count);
    let pops = standing.iter().filter(|made| made.report.plausibility.pops == 0).count();
    let range = standing.iter().filter(|made| made.report.plausibility.joint_excess_deg < IN_RANGE).count();
    let [place, turn] =
        standing.iter().map(|made| made.drift()).fold([0.0_f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);
    let took: Vec<f64> = made.iter().map(|made| made.took).collect();
    format!(
        "{:>4.0} to {:>3.0} | {:>5.1} of {:>3.0} | {:>5.1} ({low:.1} to {high:.1}) of {:>3.0} | {:>2} | {:.2} {:.3} {:>5.1} {:>5.1} | {place:.2} mm {turn:.2} deg | {:.3} {:.3}",
        EDGES[bin],
        EDGES[bin + 1],
        share(plain.iter().filter(|made| made.stands()).count(), count),
        WANTED[bin],
        share(up, count),
        AHEAD[bin],
        made.iter().filter(|made| made.gated).count(),
        mean(&standing, |made| made.report.plausibility.score),
        mean(&standing, |made| made.report.plausibility.zmp_inside),
        share(pops, up),
        share(range, up),
        percentile(&took, 0.5),
        percentile(&took, 0.95)
    )
}

fn mean(made: &[&Made], value: impl Fn(&Made) -> f64) -> f64 {
    made.iter().map(|made| value(made)).sum::<f64>() / made.len().max(1) as f64
}

/// What nobody should see, by rig.
fn grid(asked: &Asked) {
    println!("\n--drive ragdoll, 8 directions x {IMPULSES:?} Ns: % of the clips that stand");
    println!(
        "rig                     clips  stand helped | no hover  ZMP in 98 % (mean, wanted 98)  in range (wanted 99)  no pops (wanted 95)  legs 6 cm  score"
    );
    let mut all = Vec::new();
    for named in asked.rigs(&FIVE) {
        let cells: Vec<(f64, f64)> = (0..8).flat_map(|eighth| IMPULSES.map(|ns| (f64::from(eighth), ns))).collect();
        let shove = |(eighth, impulse): &(f64, f64)| {
            let heading = eighth * std::f64::consts::FRAC_PI_4;
            asked.shove(&named.1, Shove { start: 0.0, duration: 0.2, force: impulse / 0.2, heading })
        };
        let made: Vec<Made> =
            cells.par_iter().filter_map(|cell| asked.made(&named, &shove(cell), (Helped::Auto, 1, 0))).collect();
        println!("{}", shares(&named.0, &made.iter().collect::<Vec<_>>()));
        all.extend(made);
    }
    println!("{}", shares("all", &all.iter().collect::<Vec<_>>()));
}

fn shares(name: &str, made: &[&Made]) -> String {
    let standing: Vec<&Made> = made.iter().copied().filter(|made| made.stands()).collect();
    let of = |holds: &dyn Fn(&ClipReport) -> bool| {
        share(standing.iter().filter(|made| holds(&made.report)).count(), standing.len())
    };
    format!(
        "{name:<22} {:>6} {:>6} {:>6} | {:>8.1}  {:>11.1} ({:>4.1})  {:>17.1}  {:>19.1}  {:>17.1}  {:>5.2}",
        made.len(),
        standing.len(),
        standing.iter().filter(|made| made.report.assist.peak_nm > 0.0).count(),
        of(&|report| report.plausibility.hover_longest_s <= LONGEST_HOVER + 1e-9),
        of(&|report| report.plausibility.zmp_inside >= INSIDE),
        100.0 * mean(&standing, |made| made.report.plausibility.zmp_inside),
        of(&|report| report.plausibility.joint_excess_deg < IN_RANGE),
        of(&|report| report.plausibility.pops == 0),
        of(&|report| report.plausibility.legs_mm >= 1000.0 * LEAST_LEGS),
        mean(&standing, |made| made.report.plausibility.score)
    )
}

/// Clips a second.
fn batch() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let place = batched::Nowhere(Arc::new(common::builtin()));
    let [one, all] = batched::rates(&batched::eight_sides("ragdoll", 2), &place, cores);
    println!(
        "\nbatch, ragdoll, builtin: {one:.2} clips a second on one core, {:.2} a core on {cores}, of wanted 6",
        all / cores as f64
    );
}

/// The shove that takes most of looking ahead, three times alone and three times beside each other.
fn same() {
    let rig = common::builtin();
    let shove = Shove { start: WHEN.0, ..shoves::drawn(AHEAD.len() - 1, 1)[0] };
    let once = |_: usize| Made::of(&rig, &shove, Helped::Auto, 1, 0).map(|made| (made.files.file, made.files.events));
    let mut made: Vec<_> = (0..3).map(once).collect();
    made.extend((0..3).into_par_iter().map(once).collect::<Vec<_>>());
    let first = made[0].clone();
    let alike = made.iter().filter(|made| made.is_ok() && **made == first).count();
    let bytes = first.map_or(0, |(file, events)| file.len() + events.len());
    println!("\nsame: {alike} of wanted 6 clips of {:.0} Ns are the same {bytes} bytes", shove.impulse());
}
