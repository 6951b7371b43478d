//! What the audit says of clean clips, of planted faults and of measured forces, and what it costs, beside what is wanted of it.
//!
//! `cargo bench --bench audit` prints the table of the clips that may be tuned on; after `--`, `--held-out` adds the others (so that nobody
//! looks at them by chance) and `-v` each false event and each fault that was missed. The lab data are
//! third party's and stand beside the package (or where SUREFOOT_DATA points); without them it says so.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../audit_faults.rs"]
mod audit_faults;
#[path = "../audit_forces.rs"]
mod audit_forces;
#[path = "../audit_grid.rs"]
mod audit_grid;
#[path = "../audit_velocity.rs"]
mod audit_velocity;
#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;

use audit_grid::{Clip, Fault, Found, Kind, ask, clean, clips, faults, slow_clips, slow_flights, walks};
use audit_velocity::Detector;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [first, path, ..] = words.as_slice()
        && first == "--long"
    {
        return long(Path::new(path));
    }
    let verbose = words.iter().any(|word| word == "-v");
    let all = words.iter().any(|word| word == "--held-out");
    let data = data::place();
    if !data.is_dir() {
        println!("skipped: no lab data at {} (SUREFOOT_DATA names another folder)", data.display());
        return;
    }
    let (tuned, held) = clips(&data);
    let clean = walks(&tuned);
    let minutes = audit_velocity::minutes(&clean);
    let rates = [audit_velocity::own_flags(&clean), minutes.floor() as usize, (2.0 * minutes).floor() as usize];
    let pairs: Vec<[Detector; 2]> = rates.iter().map(|allowed| audit_velocity::pair(&clean, *allowed)).collect();
    for (title, list) in [("TUNED ON", &tuned), ("HELD OUT", &held)].into_iter().take(1 + usize::from(all)) {
        println!("\n{title}: {} clips", list.len());
        cleans(list, verbose);
        planted(list, &pairs, verbose);
    }
    println!("\nMEASURED FORCES (of wanted)");
    match audit_forces::compare(&data) {
        Some(lines) => lines.iter().for_each(|line| println!("  {line}")),
        None => println!("  skipped: no data/forces"),
    }
    println!("\nSPEED (of wanted)");
    match stretched(&data.join("clips/cmu_01_01_hops.bvh")) {
        Some(path) => child(&path),
        None => println!("  skipped: no data/clips/cmu_01_01_hops.bvh"),
    }
}

fn cleans(clips: &[Clip], verbose: bool) {
    for (kind, captured) in Kind::ALL.into_iter().flat_map(|kind| [(kind, true), (kind, false)]) {
        let found = clean(clips, kind, captured);
        if found.clips == 0 {
            continue;
        }
        let name = format!("{kind:?}, {}", if captured { "captured" } else { "keyed" }).to_lowercase();
        println!(
            "  clean {name:<16} {:>3} clips, {:>4.2} min: {:.2} false events a minute of {:.1}, {:.2} % of the frames of 2, abstained {:.0} %, clip flags {}",
            found.clips,
            found.minutes,
            found.a_minute(),
            kind.wanted(),
            100.0 * found.share(),
            100.0 * found.abstained(),
            found.clip_flags
        );
        if verbose {
            found.told.iter().for_each(|line| println!("      {line}"));
        }
    }
}

fn planted(clips: &[Clip], pairs: &[[Detector; 2]], verbose: bool) {
    let walks = walks(clips);
    for fault in faults() {
        let found = ask(&walks, &fault);
        row(&fault, &found, verbose);
        if fault.name.starts_with("swing") {
            println!("    (counted is the flag of the foot that was sped up, at its own touchdown)");
            pairs.iter().for_each(|pair| compared(&walks, &fault, pair));
        }
    }
    let whole = |name: &str, found: &Found, wanted: f64| {
        let recall = found.recall();
        println!("  {name:<26} {:>4} planted: recall {recall:.3} of {wanted:.2}", found.planted);
        if verbose {
            found.missed.iter().for_each(|line| println!("      missed {line}"));
        }
    };
    whole("clip at 0.6 of its speed", &slow_clips(&walks), 0.9);
    whole("flight at 0.6 (60 fps up)", &slow_flights(clips), 0.95);
}

/// The same detector with the velocity and without it, both set to the same false events in the clean clips that were tuned on.
fn compared(walks: &[&Clip], fault: &Fault, pair: &[Detector; 2]) {
    let minutes = audit_velocity::minutes(walks);
    let [with, without] = pair.map(|detector| {
        let recall = detector.ask(walks, fault).recall();
        (recall, detector.flagged(walks) as f64 / minutes.max(1e-9), detector.placed)
    });
    let words = |(recall, rate, placed): (f64, f64, glam::DVec2)| {
        format!("{recall:.3} (false {rate:.2} a minute, limits {:.2} and {:.2} m)", placed.x, placed.y)
    };
    println!(
        "    at one false rate: with the velocity {}, without {}: the pendulum adds {:.2} of 0.30",
        words(with),
        words(without),
        with.0 - without.0
    );
}

fn row(fault: &Fault, found: &Found, verbose: bool) {
    let of = |wanted: Option<f64>| wanted.map_or(String::new(), |wanted| format!(" of {wanted:.2}"));
    println!(
        "  {:<26} {:>4} planted: recall {:.3}{}, frame F1 {:.2}{}",
        fault.name,
        found.planted,
        found.recall(),
        of(fault.wanted),
        found.f1(),
        of(fault.wanted_f1)
    );
    if verbose {
        found.missed.iter().for_each(|line| println!("      missed {line}"));
    }
}

/// Ten minutes at 120 fps: the rows of a clip again and again.
fn stretched(clip: &Path) -> Option<PathBuf> {
    const FRAMES: usize = 72_000;
    let text = std::fs::read_to_string(clip).ok()?;
    let (head, rows) = text.split_once("Frames:")?;
    let rows: Vec<&str> = rows.lines().skip(2).filter(|line| !line.trim().is_empty()).collect();
    let mut long = format!("{head}Frames: {FRAMES}\nFrame Time: 0.0083333\n");
    for row in rows.iter().cycle().take(FRAMES) {
        long.push_str(row);
        long.push('\n');
    }
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("audit_long.bvh");
    std::fs::write(&path, long).ok()?;
    Some(path)
}

/// Times it in a process of its own, whose peak of memory is its own too.
fn child(path: &Path) {
    let this = std::env::current_exe().expect("a benchmark knows where it is");
    let status = std::process::Command::new(this).arg("--long").arg(path).status();
    if !status.is_ok_and(|status| status.success()) {
        println!("  the process that times it failed");
    }
}

fn long(path: &Path) {
    let start = Instant::now();
    let file = surefoot::mocap::load(path).expect("a BVH");
    let capture = file.capture(0, &surefoot::mocap::Options::default()).expect("a capture");
    drop(file);
    let (read, peak_read) = (start.elapsed().as_secs_f64(), peak());
    let found = surefoot::audit::audit(&capture, &surefoot::audit::AuditOptions::default());
    let all = start.elapsed().as_secs_f64();
    let frames = capture.frames() as f64;
    println!(
        "  BVH of 31 joints, {} of the body, {:.0} s at {:.0} fps: {:.0} frames a second of 20000 on one core ({read:.2} s reading, {:.2} s judging, {} flags)",
        capture.body.joints.len(),
        frames / capture.fps,
        capture.fps,
        frames / all,
        all - read,
        found.flags.len()
    );
    match peak_read.zip(peak()) {
        Some((read, all)) => println!("  peak memory {all:.0} MB of 300 ({read:.0} up to the end of reading)"),
        None => println!("  peak memory: not told by this system"),
    }
}

/// MB, of this process so far.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
