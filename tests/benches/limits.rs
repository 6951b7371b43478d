//! The whole table of a baked clip's limits: every rig, 8 directions, 20 to 100 Ns, and 120 and 150 Ns beside them.
//!
//! `cargo bench --bench limits` prints it; words after `--` choose rigs by a part of their name, `-v` prints each clip.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "../limits_grid.rs"]
mod limits_grid;

use limits_grid::{EIGHT, LIMITS, Measured, faults, grid, head, rigs, row};

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let verbose = std::env::args().any(|word| word == "-v");
    let mut all: [Vec<Measured>; 2] = [Vec::new(), Vec::new()];
    let mut lines: [Vec<String>; 2] = [Vec::new(), Vec::new()];
    for (name, rig) in rigs() {
        if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
            continue;
        }
        for (at, impulses) in [&[20.0, 40.0, 60.0, 80.0, 100.0][..], &[120.0, 150.0]].into_iter().enumerate() {
            let clips = grid(&rig, &EIGHT, impulses);
            if verbose {
                clips.iter().for_each(|clip| println!("{name} {}", told(clip)));
            }
            lines[at].push(row(&name, &clips));
            lines[at].push(format!("    {}", faults(&clips)));
            all[at].extend(clips);
        }
    }
    for (at, title) in ["20 to 100 Ns", "120 and 150 Ns"].into_iter().enumerate() {
        println!("\n{title}\n{}", head());
        lines[at].iter().for_each(|line| println!("{line}"));
        println!("{}", row("all", &all[at]));
    }
}

/// One clip on one line: what fails in it.
fn told(clip: &Measured) -> String {
    let failed: Vec<String> = LIMITS
        .iter()
        .filter(|(_, value, holds)| !holds(value(clip), clip))
        .map(|(name, value, _)| format!("{name}={:.2}", value(clip)))
        .collect();
    format!(
        "{:>3} Ns towards {:>3}: {:?} {} steps, ankle {:.1} m/s, {:.1} % keys of the {} channels of {} that move: {} {}",
        clip.impulse,
        clip.direction,
        clip.outcome,
        clip.steps,
        clip.ankle_speed,
        100.0 * clip.keys.moving,
        clip.keys.channels[1],
        clip.keys.channels[0],
        failed.join(" "),
        faults(std::slice::from_ref(clip))
    )
}
