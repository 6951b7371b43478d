//! The paper's seven cases: speed over time on the flat, up and down slopes, under impulses, push and pull; by the kinematic drive and by
//! the articulated body's torques, the whole controller and the bare pendulum.
//!
//! `cargo bench --bench seven_cases` prints for five bodies how far each clip's steady speed is from the commanded one (to hold: 5 %, back
//! within 2 s of an impulse), what the body refuses, and the step lengths on slopes beside equation 2's.
//! With `-- FOLDER` it writes the figure there, seven.svg by the kinematic drive and seven_body.svg by torques, of the built-in rig;
//! with `-- WORD` only cases, drives or bodies whose name holds that word are printed.

#![expect(clippy::print_stdout, reason = "the table")]

#[path = "../data.rs"]
#[expect(dead_code, reason = "a bench wants the place alone")]
mod data;
#[path = "../seven_grid.rs"]
mod seven_grid;

use rayon::prelude::*;
use seven_grid::{BARE, Case, Walked, bodies, seven, walked};
use std::path::{Path, PathBuf};
use surefoot::bake::{Drive, Helped};
use surefoot::picture::plot::{Colour, Line, Panel, Plot, svg};
use surefoot::ragdoll::control::Assist;

/// m/s, of the cases that do not change it.
const SPEED: f64 = 1.2;
/// N, of impulses and of forces that last.
const FORCES: [f64; 2] = [100.0, 60.0];
/// Degrees and m/s, up and down: the paper's, and what the articulated body plays.
const SLOPES: [[(f64, f64); 2]; 2] = [[(15.0, 1.2), (15.0, 1.2)], [(8.0, 0.7), (15.0, 0.5)]];
const VARIANTS: [(&str, &str); 2] = [("whole", ""), ("bare", BARE)];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let (folders, words): (Vec<String>, Vec<String>) = words.into_iter().partition(|word| Path::new(word).is_dir());
    let folder = folders.first().map(PathBuf::from);
    let cases = cases();
    let drives = [("kinematic", Drive::Stepper), ("torques", Drive::Ragdoll(Helped::Within(Assist::default())))];
    for (index, (name, rig, legs)) in
        bodies(Some(data::place()).filter(|place| place.join("rigs").is_dir())).into_iter().enumerate()
    {
        for (drive_name, drive) in drives {
            let chosen = |case: &&Case| {
                words.iter().all(|word| [case.name.as_str(), drive_name, &name].iter().any(|text| text.contains(word)))
            };
            let chosen: Vec<&Case> = cases.iter().filter(chosen).collect();
            let runs: Vec<[Result<Walked, String>; 2]> = chosen
                .par_iter()
                .map(|case| VARIANTS.map(|(_, more)| walked(&rig, legs, case, drive, more, 7)))
                .collect();
            for (case, runs) in chosen.iter().zip(&runs) {
                let [whole, bare] = runs.each_ref().map(told);
                println!("{name:<30} {drive_name:<10} {:<34} {whole:<52} bare: {bare}", case.name);
            }
            if let Some(folder) = folder.as_ref().filter(|_| index == 0 && words.is_empty()) {
                let file = folder.join(if drive == Drive::Stepper { "seven.svg" } else { "seven_body.svg" });
                std::fs::write(&file, drawn(&cases, &runs, drive_name)).expect("a place for the figure");
                println!("wrote {}", file.display());
            }
        }
    }
}

/// The paper's seven, slopes that the body plays too, and the flat at their speeds, which equation 2 wants to compare.
fn cases() -> Vec<Case> {
    let [paper, milder] = SLOPES.map(|slopes| seven(SPEED, slopes, FORCES));
    let milder = milder.into_iter().filter(|case| case.slope != 0.0);
    let flat = [0.5, 0.7, SPEED].map(|speed| Case::level(&format!("flat at {speed:.1} m/s"), speed));
    paper.into_iter().chain(milder).chain(flat).collect()
}

fn told(run: &Result<Walked, String>) -> String {
    let run = match run {
        Ok(run) => run,
        Err(why) => return format!("refused: {why}"),
    };
    if let Some(time) = run.fell {
        return format!("fell at {time:.1} s");
    }
    let back = run.back.map_or(String::new(), |time| format!(", back in {time:.2} s"));
    let vault = &run.vault;
    format!(
        "{:+.1} %{back}, score {:.2}; steps {:.3} m, lands {:.3} ahead, eq. 2 {:.3}, s {:+.3}",
        100.0 * run.error,
        run.score,
        vault.step,
        vault.ahead,
        vault.vaulted,
        vault.rise
    )
}

/// The figure of those cases that ran.
fn drawn(cases: &[Case], runs: &[[Result<Walked, String>; 2]], drive: &str) -> String {
    let colours = [("whole", Colour::Blue), ("bare pendulum", Colour::Orange)];
    let panels = cases.iter().zip(runs).filter(|(case, runs)| !case.name.starts_with("flat") && runs[0].is_ok());
    let panels = panels.map(|(case, runs)| {
        let commanded = (0..=(case.duration * 20.0) as usize).map(|i| {
            let time = i as f64 / 20.0;
            (time, case.walks.iter().rev().find(|walk| walk.0 <= time).map_or(0.0, |walk| walk.1))
        });
        let commanded =
            Line { name: "commanded".into(), colour: Colour::Grey, dashed: true, points: commanded.collect() };
        let lines = colours.iter().zip(runs).rev().filter_map(|((name, colour), run)| {
            let points = run.as_ref().ok()?.curve.clone();
            Some(Line { name: (*name).into(), colour: *colour, dashed: false, points })
        });
        let force = case.force.map(|(start, lasts, _)| (start, start + lasts));
        Panel {
            label: case.name.clone(),
            lines: lines.chain([commanded]).collect(),
            band: Vec::new(),
            marks: force.into_iter().collect(),
        }
    });
    let duration = cases.iter().map(|case| case.duration).fold(0.0, f64::max);
    svg(&Plot {
        title: format!("Speed held in the paper's seven cases by the {drive} drive, m/s over s"),
        duration,
        panels: panels.collect(),
        rows: Vec::new(),
        columns: 2,
    })
}
