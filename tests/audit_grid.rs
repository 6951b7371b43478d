//! The table that the audit is held to: false events in clean clips, and how many planted faults are found.
//!
//! `tests/audit.rs` asserts on the held-out part of it, `tests/benches/audit.rs` prints all. Of the walks, turns and runs in data/audit
//! every third (by sorted name) is held out, and of the keyed clips of a rig's file every third too. Four seeds a clip and a fault.

#![allow(dead_code)] // the benchmark and the tests each use their part

use crate::audit_faults::{self as faults, Planted, Way};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use surefoot::audit::{AuditOptions, audit, foot_name};
use surefoot::maths::seed::Seed;
use surefoot::mocap::{Options, load};
use surefoot::model::Capture;
use surefoot::model::findings::{Findings, Rule};

/// A clip and what it shows.
pub struct Clip {
    pub name: String,
    pub kind: Kind,
    /// By a person's motion rather than keys.
    pub captured: bool,
    pub capture: Capture,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Walk,
    Turn,
    Run,
    Stand,
    Other,
}

impl Kind {
    pub const ALL: [Kind; 5] = [Kind::Walk, Kind::Turn, Kind::Run, Kind::Stand, Kind::Other];

    /// False events a minute that are allowed.
    pub fn wanted(self) -> f64 {
        match self {
            Kind::Walk | Kind::Turn => 1.0,
            Kind::Run | Kind::Other => 2.0,
            Kind::Stand => 0.5,
        }
    }

    fn of(name: &str) -> Kind {
        let name = name.to_lowercase();
        let has = |words: &[&str]| words.iter().any(|word| name.contains(word));
        if has(&["walk-turn"]) {
            Kind::Turn
        } else if has(&["run", "jog", "sprint"]) {
            Kind::Run
        } else if has(&["walk"]) {
            Kind::Walk
        } else if has(&["wave-both", "raise-up", ":idle", "unarmed_idle"]) {
            Kind::Stand
        } else {
            Kind::Other
        }
    }
}

/// (tuned, held out); empty without the data.
pub fn clips(data: &Path) -> (Vec<Clip>, Vec<Clip>) {
    let (mut tuned, mut held) = (Vec::new(), Vec::new());
    for folder in ["audit", "clips", "rigs", "forces"] {
        for (index, path) in files(&data.join(folder)).into_iter().enumerate() {
            for (number, clip) in read(&path, folder != "rigs").into_iter().enumerate() {
                let third = if folder == "rigs" { number } else { index };
                let out = matches!(folder, "audit" | "rigs") && third % 3 == 2;
                if out { held.push(clip) } else { tuned.push(clip) }
            }
        }
    }
    (tuned, held)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let kinds = ["bvh", "fbx", "glb", "gltf", "vrm", "vrma"];
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|tail| kinds.iter().any(|kind| tail == *kind))).collect();
    files.sort();
    files
}

/// Every clip of a file that is a humanoid's.
fn read(path: &Path, captured: bool) -> Vec<Clip> {
    let Ok(file) = load(path) else { return Vec::new() };
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let whole = |index: usize| {
        let capture = file.capture(index, &Options::default()).ok().filter(|capture| capture.frames() > 0)?;
        let name = if file.clips.len() > 1 { format!("{stem}:{}", file.clips[index]) } else { stem.clone() };
        Some(Clip { kind: Kind::of(&name), name, captured, capture })
    };
    (0..file.clips.len()).filter_map(whole).collect()
}

/// What is said of clean clips of a kind.
#[derive(Clone, Debug, Default)]
pub struct Clean {
    pub clips: usize,
    pub minutes: f64,
    pub events: usize,
    pub clip_flags: usize,
    frames: usize,
    flagged: usize,
    abstained: usize,
    /// Each flag: clip, frames, rule, words.
    pub told: Vec<String>,
}

impl Clean {
    pub fn a_minute(&self) -> f64 {
        self.events as f64 / self.minutes.max(1e-9)
    }

    /// Of the frames.
    pub fn share(&self) -> f64 {
        self.flagged as f64 / self.frames.max(1) as f64
    }

    pub fn abstained(&self) -> f64 {
        self.abstained as f64 / self.frames.max(1) as f64
    }
}

pub fn clean(clips: &[Clip], kind: Kind, captured: bool) -> Clean {
    let of: Vec<&Clip> = clips.iter().filter(|clip| clip.kind == kind && clip.captured == captured).collect();
    let found: Vec<Findings> = of.par_iter().map(|clip| audit(&clip.capture, &AuditOptions::default())).collect();
    let mut clean = Clean::default();
    for (clip, found) in of.iter().zip(found) {
        clean.clips += 1;
        clean.minutes += clip.capture.frames() as f64 / clip.capture.fps / 60.0;
        clean.events += found.flags.len();
        clean.clip_flags += found.clip_flags.len();
        clean.frames += clip.capture.frames();
        clean.flagged += covered(found.frames, found.flags.iter().map(|flag| (flag.start, flag.end)))
            .iter()
            .filter(|set| **set)
            .count();
        let spans = found.abstained.iter().map(|span| (span.start, span.end));
        clean.abstained += covered(found.frames, spans).iter().filter(|set| **set).count();
        let line = |flag: &surefoot::model::findings::Flag| {
            format!("{} {}..{} {}: {}", clip.name, flag.start, flag.end, flag.rule.name(), flag.why)
        };
        clean.told.extend(found.flags.iter().map(line));
        clean
            .told
            .extend(found.clip_flags.iter().map(|flag| format!("{} {}: {}", clip.name, flag.rule.name(), flag.why)));
    }
    clean
}

fn covered(frames: usize, spans: impl Iterator<Item = (usize, usize)>) -> Vec<bool> {
    let mut covered = vec![false; frames];
    for (start, end) in spans {
        covered[start..=end].fill(true);
    }
    covered
}

/// How a fault is planted.
type Plant = Box<dyn Fn(&Capture, &mut Seed) -> Option<Planted> + Sync>;

/// One row: a fault, the rule that is to find it (any, if none), and what is wanted.
pub struct Fault {
    pub name: String,
    pub rule: Rule,
    pub wanted: Option<f64>,
    /// Of the frames' F1.
    pub wanted_f1: Option<f64>,
    pub plant: Plant,
}

/// Every fault that is planted into walks and turns.
pub fn faults() -> Vec<Fault> {
    let row = |name: &str, rule: Rule, wanted: Option<f64>, plant: Plant| Fault {
        name: name.to_owned(),
        rule,
        wanted,
        wanted_f1: None,
        plant,
    };
    let mut list = Vec::new();
    let ways = [("in", Way::Inward), ("out", Way::Outward), ("back", Way::Backward), ("forward", Way::Forward)];
    for centimetres in [10, 20, 30] {
        for (word, way) in ways {
            let wanted = match (centimetres, way) {
                (20, Way::Inward | Way::Outward) | (30, _) => Some(0.95),
                (20, Way::Backward) => Some(0.9),
                (20, Way::Forward) => Some(0.8),
                _ => None,
            };
            let metres = f64::from(centimetres) / 100.0;
            let plant: Plant = Box::new(move |clip, seed| faults::moved_plant(clip, way, metres, seed));
            let name = format!("plant {centimetres} cm {word}");
            let sideways = centimetres == 20 && matches!(way, Way::Inward | Way::Outward);
            let f1 = sideways.then_some(0.85);
            list.push(Fault { wanted_f1: f1, ..row(&name, Rule::FootPlacement, wanted, plant) });
        }
    }
    for (name, times, wanted) in [("swing at 1.4 times speed", 1.4, None), ("swing at double speed", 2.0, Some(0.6))] {
        let swing: Plant = Box::new(move |clip, seed| faults::fast_swing(clip, times, seed));
        list.push(row(name, Rule::FootPlacement, wanted, swing));
    }
    let pelvis: Plant = Box::new(|clip, seed| faults::moved_pelvis(clip, 0.25, seed));
    list.push(row("pelvis 25 cm off for 1 s", Rule::Balance, Some(0.95), pelvis));
    let lift: Plant = Box::new(|clip, seed| faults::lifted(clip, 0.06, seed));
    list.push(row("lifted 6 cm for 1 s", Rule::Float, Some(0.95), lift));
    let sink: Plant = Box::new(|clip, seed| faults::lifted(clip, -0.06, seed));
    list.push(row("sunk 6 cm for 1 s", Rule::Penetration, Some(0.95), sink));
    let slide: Plant = Box::new(|clip, seed| faults::slide(clip, 0.2, seed));
    list.push(row("slide of 20 cm", Rule::FootSlide, Some(0.9), slide));
    list
}

/// How often a fault was found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    pub planted: usize,
    pub found: usize,
    frames: (usize, usize, usize), // rightly flagged, wrongly, missed
    /// Where it was not: clip and frames.
    pub missed: Vec<String>,
}

impl Found {
    pub fn recall(&self) -> f64 {
        self.found as f64 / self.planted.max(1) as f64
    }

    /// Of the frames that are flagged by whatever rule, against those that the fault spoils.
    pub fn f1(&self) -> f64 {
        let (right, wrong, missed) = self.frames;
        2.0 * right as f64 / (2 * right + wrong + missed).max(1) as f64
    }
}

/// Captured walks and turns: what faults are planted into.
pub fn walks(clips: &[Clip]) -> Vec<&Clip> {
    clips.iter().filter(|clip| clip.captured && matches!(clip.kind, Kind::Walk | Kind::Turn)).collect()
}

const SEEDS: u64 = 4;

/// Plants it in every clip and asks the audit.
pub fn ask(clips: &[&Clip], fault: &Fault) -> Found {
    let say = |_: &Clip, planted: &Planted| {
        let found = audit(&planted.capture, &AuditOptions::default());
        let swing = fault.name.starts_with("swing");
        let hit = if swing { lands(&found, planted) } else { overlaps(&found, planted.span, fault.rule) };
        (hit, frames(&found, planted.span))
    };
    each(clips, &fault.plant, say)
}

/// Plants it in every clip, four times, and asks: found or not, and frames rightly flagged, wrongly, missed.
pub fn each(
    clips: &[&Clip],
    plant: &Plant,
    say: impl Fn(&Clip, &Planted) -> (bool, (usize, usize, usize)) + Sync,
) -> Found {
    let cells: Vec<(usize, u64)> = (0..clips.len()).flat_map(|clip| (0..SEEDS).map(move |seed| (clip, seed))).collect();
    let said: Vec<_> = cells
        .par_iter()
        .filter_map(|(index, seed)| {
            let clip = clips[*index];
            let planted = plant(&clip.capture, &mut Seed::new(1000 * *index as u64 + seed))?;
            let (hit, frames) = say(clip, &planted);
            Some((hit, frames, format!("{} {}..{}", clip.name, planted.span.0, planted.span.1)))
        })
        .collect();
    let mut sum = Found::default();
    for (hit, frames, place) in said {
        sum.planted += 1;
        sum.found += usize::from(hit);
        sum.frames = (sum.frames.0 + frames.0, sum.frames.1 + frames.1, sum.frames.2 + frames.2);
        if !hit {
            sum.missed.push(place);
        }
    }
    sum
}

/// Whether a flag of the rule touches the span, give or take two frames.
fn overlaps(found: &Findings, (start, end): (usize, usize), rule: Rule) -> bool {
    found.flags.iter().any(|flag| flag.rule == rule && flag.start <= end + 2 && flag.end + 2 >= start)
}

/// Whether the foot that was moved is flagged for where it came down, at that touchdown: the flag begins within the span that is spoiled,
/// give or take two frames, and names the foot.
fn lands(found: &Findings, planted: &Planted) -> bool {
    let feet = found.flags.iter().filter(|flag| flag.rule == Rule::FootPlacement);
    feet.into_iter().any(|flag| at_touchdown(flag.start, flag.foot, planted))
}

/// See [`lands`].
pub fn at_touchdown(start: usize, foot: Option<&str>, planted: &Planted) -> bool {
    foot.is_some() && foot == planted.side.map(foot_name) && (planted.span.0..=planted.span.1 + 2).contains(&start)
}

fn frames(found: &Findings, span: (usize, usize)) -> (usize, usize, usize) {
    let flagged = covered(found.frames, found.flags.iter().map(|flag| (flag.start, flag.end)));
    let spoiled = covered(found.frames, std::iter::once(span));
    let count = |wanted: (bool, bool)| flagged.iter().zip(&spoiled).filter(|(f, s)| (**f, **s) == wanted).count();
    (count((true, true)), count((true, false)), count((false, true)))
}

/// Whole clips at 0.6 of their speed, by `clip_flags`.
pub fn slow_clips(clips: &[&Clip]) -> Found {
    let mut sum = Found::default();
    let told: Vec<bool> = clips
        .par_iter()
        .map(|clip| {
            let found = audit(&faults::slow_clip(&clip.capture, 0.6).capture, &AuditOptions::default());
            found.clip_flags.iter().any(|flag| flag.rule == Rule::Timing)
        })
        .collect();
    for (clip, told) in clips.iter().zip(told) {
        sum.planted += 1;
        sum.found += usize::from(told);
        if !told {
            sum.missed.push(clip.name.clone());
        }
    }
    sum
}

/// Flights at 0.6 of their speed, in clips of 60 frames a second and up.
pub fn slow_flights(clips: &[Clip]) -> Found {
    let fast: Vec<&Clip> = clips.iter().filter(|clip| clip.capture.fps >= 59.0).collect();
    let plant: Plant = Box::new(|clip, seed| faults::slow_flight(clip, 0.6, seed));
    let rule = Rule::Ballistic;
    ask(&fast, &Fault { name: String::new(), rule, wanted: None, wanted_f1: None, plant })
}
