//! Plants faults into captured clips, corrects them and prints what is gone: `cargo bench --bench correct [-- FILTER -v]`.
//!
//! "gone" is a planted fault that the audit flagged and flags no more; "of all" counts what it never saw as not gone. "new" are flags where
//! neither the spoiled clip nor the clean one had any. "off" is how far the spoiled joints are from the clip as it was, mean over the span, before and after;
//! slip is that of the feet that were locked. With SUREFOOT_STRIPS=FOLDER the first clips of each fault are drawn there: spoiled, corrected, as it was.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../audit_faults.rs"]
mod audit_faults;
#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "../stick_strip.rs"]
mod stick_strip;

use audit_faults::{Planted, Way};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use surefoot::audit::{AuditOptions, audit};
use surefoot::correct::{CorrectOptions, Corrected, correct};
use surefoot::maths::seed::Seed;
use surefoot::mocap::read_bvh;
use surefoot::model::Capture;
use surefoot::model::findings::Findings;

type Plant = fn(&Capture, &mut Seed) -> Option<Planted>;

const FAULTS: [(&str, Plant); 9] = [
    ("plant 20 cm forward", |c, s| audit_faults::moved_plant(c, Way::Forward, 0.2, s)),
    ("plant 20 cm backward", |c, s| audit_faults::moved_plant(c, Way::Backward, 0.2, s)),
    ("plant 20 cm inward", |c, s| audit_faults::moved_plant(c, Way::Inward, 0.2, s)),
    ("plant 20 cm outward", |c, s| audit_faults::moved_plant(c, Way::Outward, 0.2, s)),
    ("swing at double speed", |c, s| audit_faults::fast_swing(c, 2.0, s)),
    ("pelvis 25 cm aside", |c, s| audit_faults::moved_pelvis(c, 0.25, s)),
    ("lifted 6 cm", |c, s| audit_faults::lifted(c, 0.06, s)),
    ("sunk 6 cm", |c, s| audit_faults::lifted(c, -0.06, s)),
    ("slide of 20 cm", |c, s| audit_faults::slide(c, 0.2, s)),
];
const FLIGHT: (&str, Plant) = ("flight at 0.6", |c, s| audit_faults::slow_flight(c, 0.6, s));

#[derive(Default)]
struct Row {
    planted: usize,
    seen: usize,
    gone: usize,
    new: usize,
    off: [f64; 2],
    slips: Vec<f64>,
    touched: usize,
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let told = words.iter().any(|word| word == "-v");
    let filter = words.iter().find(|word| !word.starts_with('-')).cloned().unwrap_or_default();
    let data = data::place();
    if !data.join("audit").is_dir() {
        println!("skipped: no data/audit");
        return;
    }
    let walks = clips(&data.join("audit"), &["walk"]);
    let mut fast: Vec<(String, Capture)> = clips(&data.join("clips"), &["cmu_", "fair1"]);
    fast.retain(|(_, capture)| capture.fps >= 60.0);
    println!(
        "{:24} {:>8} {:>5} {:>5} {:>7} {:>7} {:>4} {:>14} {:>12} {:>8}",
        "fault", "planted", "seen", "gone", "of seen", "of all", "new", "off cm", "slip mm max", "frames"
    );
    for (name, plant) in FAULTS.into_iter().chain([FLIGHT]) {
        if !name.contains(&filter) {
            continue;
        }
        let clips = if name == FLIGHT.0 { &fast } else { &walks };
        let seeds = if name == FLIGHT.0 { 6 } else { 1 };
        let jobs: Vec<(usize, u64)> = (0..clips.len()).flat_map(|at| (0..seeds).map(move |seed| (at, seed))).collect();
        let results: Vec<Option<(String, Planted, Corrected)>> = jobs
            .par_iter()
            .map(|(at, seed)| {
                let (clip, capture) = &clips[*at];
                let planted = plant(capture, &mut Seed::new(*seed).split(*at as u64))?;
                let corrected = correct(&planted.capture, &CorrectOptions::default());
                Some((format!("{clip} seed {seed}"), planted, corrected))
            })
            .collect();
        let mut row = Row::default();
        for ((at, _), result) in jobs.iter().zip(&results) {
            let Some((clip, planted, corrected)) = result else { continue };
            if row.planted < 3 {
                draw(name, row.planted, &clips[*at].1, planted, corrected);
            }
            judge(&mut row, &clips[*at].1, planted, corrected, clip, told);
        }
        row.slips.sort_by(f64::total_cmp);
        println!(
            "{:24} {:8} {:5} {:5} {:6.0}% {:6.0}% {:4} {:6.1} {:6.1} {:12.1} {:8.0}",
            name,
            row.planted,
            row.seen,
            row.gone,
            100.0 * row.gone as f64 / row.seen.max(1) as f64,
            100.0 * row.gone as f64 / row.planted.max(1) as f64,
            row.new,
            100.0 * row.off[0] / row.seen.max(1) as f64,
            100.0 * row.off[1] / row.seen.max(1) as f64,
            1000.0 * row.slips.last().copied().unwrap_or(0.0),
            row.touched as f64 / row.planted.max(1) as f64,
        );
    }
}

fn judge(row: &mut Row, clean: &Capture, planted: &Planted, corrected: &Corrected, clip: &str, told: bool) {
    let natural = audit(clean, &AuditOptions::default());
    let same_length = natural.frames == corrected.before.frames;
    let near = |found: &Findings| {
        let (start, end) = (planted.span.0.saturating_sub(6), planted.span.1 + 6);
        found.flags.iter().any(|flag| {
            let old = same_length && overlaps(flag.start, flag.end, &natural);
            flag.start <= end && flag.end >= start && !old
        })
    };
    row.planted += 1;
    let new = corrected.after.flags.iter().filter(|flag| {
        let natural = same_length && overlaps(flag.start, flag.end, &natural);
        !natural && !overlaps(flag.start, flag.end, &corrected.before)
    });
    let new = new.count();
    row.new += new;
    row.touched += corrected.changed.len();
    let seen = near(&corrected.before);
    let gone = seen && !near(&corrected.after);
    row.seen += usize::from(seen);
    row.gone += usize::from(gone);
    let mut off = [0.0; 2];
    if seen && same_length {
        off = [&planted.capture, &corrected.capture].map(|capture| distance(clean, capture, planted.span));
        row.off[0] += off[0];
        row.off[1] += off[1];
    }
    let slip = corrected.slip;
    row.slips.push(slip);
    if told {
        let frames = planted.span;
        println!(
            "  {clip}: {frames:?} seen {seen} gone {gone} new {new} off {:.1} -> {:.1} cm slip {:.1} mm",
            100.0 * off[0],
            100.0 * off[1],
            1000.0 * slip
        );
        for flag in &corrected.before.flags {
            println!("      before {}-{} {} {:.2}", flag.start, flag.end, flag.rule.name(), flag.delta_m);
        }
        for done in &corrected.done {
            println!("      {}-{} {}: {}", done.start, done.end, done.rule.name(), done.what);
        }
        for flag in &corrected.after.flags {
            println!("      after {}-{} {} {:.2}", flag.start, flag.end, flag.rule.name(), flag.delta_m);
        }
    }
}

fn draw(name: &str, number: usize, clean: &Capture, planted: &Planted, corrected: &Corrected) {
    let Some(folder) = std::env::var_os("SUREFOOT_STRIPS") else { return };
    let edge = (0.4 * clean.fps) as usize;
    let span = (planted.span.0.saturating_sub(edge), planted.span.1 + edge);
    let every = ((span.1 - span.0) / 16).max(1);
    let rows = [&planted.capture, &corrected.capture, clean];
    for (front, view) in [(false, "side"), (true, "front")] {
        let image = stick_strip::strip(&rows, span, every, front);
        let file = format!("{}_{number}_{view}.png", name.replace(' ', "_"));
        if let Err(error) = image.save(Path::new(&folder).join(file)) {
            println!("cannot draw: {error}");
        }
    }
}

fn overlaps(start: usize, end: usize, found: &Findings) -> bool {
    found.flags.iter().any(|flag| flag.start <= end && start <= flag.end)
}

/// m: the mean over the span of the worst of hips and ankles.
fn distance(clean: &Capture, other: &Capture, span: (usize, usize)) -> f64 {
    let joints = [0, clean.body.feet[0].ankle, clean.body.feet[1].ankle];
    let worst = |frame: usize| {
        joints.iter().map(|joint| clean.at(frame)[*joint].distance(other.at(frame)[*joint])).fold(0.0, f64::max)
    };
    (span.0..=span.1).map(worst).sum::<f64>() / (span.1 - span.0 + 1) as f64
}

fn clips(folder: &Path, beginnings: &[&str]) -> Vec<(String, Capture)> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.ends_with(".bvh") && beginnings.iter().any(|beginning| name.starts_with(beginning))
    });
    paths.sort();
    let read = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).ok()?;
        let name = path.file_stem()?.to_string_lossy().into_owned();
        Some((name.clone(), read_bvh(&name, &text).ok()?))
    };
    paths.iter().filter_map(read).collect()
}
