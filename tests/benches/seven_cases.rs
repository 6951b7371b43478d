//! The paper's seven cases as one figure: speed over time on the flat, up and down a slope, under impulses, push and pull,
//! of the whole controller and of the bare pendulum.
//!
//! `cargo bench --bench seven_cases -- FILE.svg` writes it and prints the speed errors (to hold: 5 % steady, back within
//! 2 s of an impulse). The reference body, 1.2 m/s unless the case says otherwise.

#![expect(clippy::print_stdout, reason = "the table")]

use glam::DVec3;
use std::path::PathBuf;
use surefoot::model::scenario::{Ground, GroundKind, Stepper, Walk};
use surefoot::model::{Physique, Terrain};
use surefoot::picture::plot::{Colour, Line, Panel, Plot, svg};
use surefoot::sim::{Script, SessionPush, SimulateOptions, Trace, simulate};
use surefoot::stepper::Style;

/// m/s.
const SPEED: f64 = 1.2;
/// s.
const LENGTH: f64 = 12.0;

struct Case {
    name: &'static str,
    script: Script,
    /// (from, to) s in which it disturbs.
    disturbed: Option<(f64, f64)>,
}

fn main() {
    let file = std::env::args().skip(1).find(|word| word.ends_with(".svg")).map(PathBuf::from);
    let bare = Style {
        variant: Stepper { ankle_feedback: false, leg_change: false, ..Stepper::default() },
        ..Style::default()
    };
    let mut panels = Vec::new();
    println!("{:<34} {:>22} {:>22}", "steady error; back within 10 %", "whole controller", "bare pendulum");
    for case in cases() {
        let runs = [Style::default(), bare].map(|style| run(&case.script, style));
        let told = runs.each_ref().map(|trace| told(&case, trace));
        println!("{:<34} {:>22} {:>22}", case.name, told[0], told[1]);
        let line = |name: &str, colour, trace: &Trace| Line {
            name: name.into(),
            colour,
            dashed: false,
            points: trace.ticks.iter().enumerate().map(|(i, tick)| (i as f64 * trace.dt, tick.velocity.z)).collect(),
        };
        let commanded = (0..=(LENGTH * 20.0) as usize).map(|i| {
            let time = i as f64 / 20.0;
            (time, case.script.intent(time).walk.map_or(0.0, |walk| walk.y))
        });
        panels.push(Panel {
            label: case.name.into(),
            lines: vec![
                line("bare pendulum", Colour::Orange, &runs[1]),
                line("whole", Colour::Blue, &runs[0]),
                Line { name: "commanded".into(), colour: Colour::Grey, dashed: true, points: commanded.collect() },
            ],
            band: Vec::new(),
            marks: case.disturbed.into_iter().collect(),
        });
    }
    let plot = Plot {
        title: "Speed held in the paper's seven cases, m/s over s".into(),
        duration: LENGTH,
        panels,
        rows: Vec::new(),
        columns: 2,
    };
    if let Some(file) = file {
        std::fs::write(&file, svg(&plot)).expect("a place for the figure");
        println!("wrote {}", file.display());
    }
}

fn cases() -> Vec<Case> {
    let walk = |start: f64, speed: f64| Walk { start, duration: None, speed, heading: 0.0, facing: None };
    let script = |walks: Vec<Walk>, pushes: &[SessionPush]| Script { walk: walks, ..Script::standing(pushes) };
    let steady = || vec![walk(0.2, SPEED)];
    let slope = |degrees: f64| {
        Terrain::new(&Ground { kind: GroundKind::Slope { angle: degrees.to_radians() }, ..Ground::default() })
    };
    let force = |start: f64, duration: f64, newtons: f64| SessionPush {
        start,
        duration,
        force: DVec3::new(0.0, 0.0, newtons),
        turns: false,
        arm: 0.0,
    };
    let case = |name, script, disturbed| Case { name, script, disturbed };
    let changing = vec![walk(0.2, 0.6), walk(3.0, 1.4), walk(5.5, 0.9), walk(7.5, 1.2)];
    vec![
        case("(a) changing speed", script(changing, &[]), None),
        case("(b) 15 degrees up", Script { terrain: slope(15.0), ..script(steady(), &[]) }, None),
        case("(c) 15 degrees down", Script { terrain: slope(-15.0), ..script(steady(), &[]) }, None),
        case("(d) 100 N, 0.2 s from behind", script(steady(), &[force(6.0, 0.2, 100.0)]), Some((6.0, 6.2))),
        case("(e) 100 N, 0.2 s from the front", script(steady(), &[force(6.0, 0.2, -100.0)]), Some((6.0, 6.2))),
        case("(f) 60 N push that lasts", script(steady(), &[force(5.0, 7.0, 60.0)]), Some((5.0, 12.0))),
        case("(g) 60 N pull that lasts", script(steady(), &[force(5.0, 7.0, -60.0)]), Some((5.0, 12.0))),
    ]
}

fn run(script: &Script, style: Style) -> Trace {
    let options = SimulateOptions { duration: LENGTH, extra: 0.0, style, ..SimulateOptions::default() };
    simulate(&Physique::REFERENCE, script, &options)
}

/// Steady error over the last whole strides, and how long after the disturbance began the speed was back for good.
fn told(case: &Case, trace: &Trace) -> String {
    if let Some(time) = trace.lost {
        return format!("fell at {time:.1} s");
    }
    let wanted = case.script.intent(LENGTH - 0.1).walk.map_or(0.0, |walk| walk.y);
    let lands: Vec<f64> = trace.steps.iter().map(|step| step.land).filter(|land| *land > 9.5).collect();
    let strides = lands.len().saturating_sub(1) / 2 * 2;
    let at = |time: f64| trace.ticks[(time / trace.dt).round() as usize].com.z;
    if strides == 0 {
        return "no stride".into();
    }
    let error = (at(lands[strides]) - at(lands[0])) / (lands[strides] - lands[0]) / wanted - 1.0;
    let back = case.disturbed.map(|(from, _)| {
        let span = (0.57 / trace.dt) as usize; // about a step
        let first = (from / trace.dt) as usize;
        let off =
            |i: usize| ((at((i + span) as f64 * trace.dt) - at(i as f64 * trace.dt)) / 0.57 / wanted - 1.0).abs() > 0.1;
        let last = (first..trace.ticks.len() - span).rev().find(|i| off(*i));
        last.map_or(0.0, |last| (last - first) as f64 * trace.dt)
    });
    match back {
        Some(time) => format!("{:+.1} %; {time:.2} s", 100.0 * error),
        None => format!("{:+.1} %", 100.0 * error),
    }
}
