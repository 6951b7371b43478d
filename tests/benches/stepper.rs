//! What a tick of the stepper costs (to hold: 0.5 µs): standing, and a mean over a whole reaction with its steps.

use divan::{Bencher, counter::ItemsCount};
use glam::{DVec2, DVec3};
use surefoot::model::Terrain;
use surefoot::model::scenario::Walk;
use surefoot::sim::{Script, SessionPush, SimulateOptions, simulate, simulate_pushes};
use surefoot::stepper::{Inputs, Params, Physique, State, Style, tick};

fn main() {
    divan::main();
}

#[divan::bench]
fn standing(bencher: Bencher) {
    let body = Physique::REFERENCE;
    let params = Params::new(&body, &Style::default());
    let still = Inputs::default();
    let flat = Terrain::flat();
    let mut state = State::standing(&params, &body, &flat, DVec2::ZERO, 0.0);
    bencher
        .counter(ItemsCount::new(1_u32))
        .bench_local(|| tick(&params, &body, &flat, &mut state, divan::black_box(&still), 0.01));
}

/// Four seconds of ticks: items a second are ticks a second.
#[divan::bench(args = [30.0, 60.0, 100.0])]
fn pushed(bencher: Bencher, impulse: f64) {
    let body = Physique::REFERENCE;
    let push = SessionPush {
        start: 0.1,
        duration: 0.2,
        force: DVec3::new(0.7, 0.0, 0.7) * (impulse / 0.2),
        turns: false,
        arm: 0.3,
    };
    let options = SimulateOptions { duration: 4.0, extra: 0.0, ..SimulateOptions::default() };
    bencher
        .counter(ItemsCount::new(400_u32))
        .bench_local(|| simulate_pushes(&body, divan::black_box(&[push]), &options));
}

/// Eight seconds of walking ticks, pushed in the middle by that many N for 0.2 s.
#[divan::bench(args = [0.0, 100.0, 300.0])]
fn walking(bencher: Bencher, newtons: f64) {
    let body = Physique::REFERENCE;
    let push =
        SessionPush { start: 4.0, duration: 0.2, force: DVec3::new(0.7, 0.0, 0.7) * newtons, turns: false, arm: 0.3 };
    let walk = vec![Walk { start: 0.1, duration: None, speed: 1.2, heading: 0.0, facing: None }];
    let script = Script { walk, ..Script::standing(&[push]) };
    let options = SimulateOptions { duration: 8.0, extra: 0.0, ..SimulateOptions::default() };
    bencher.counter(ItemsCount::new(800_u32)).bench_local(|| simulate(&body, divan::black_box(&script), &options));
}
