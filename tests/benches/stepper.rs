//! What a tick of the stepper costs (to hold: 0.5 µs): standing, and a mean over a whole reaction with its steps.

use divan::{Bencher, counter::ItemsCount};
use glam::{DVec2, DVec3};
use surefoot::model::Terrain;
use surefoot::sim::{SessionPush, SimulateOptions, simulate_pushes};
use surefoot::stepper::{Inputs, Params, Physique, State, Style, tick};

fn main() {
    divan::main();
}

#[divan::bench]
fn standing(bencher: Bencher) {
    let body = Physique::REFERENCE;
    let params = Params::new(&body, &Style::default());
    let still = Inputs::default();
    let mut state = State::standing(&params, &body, DVec2::ZERO, 0.0);
    bencher
        .counter(ItemsCount::new(1_u32))
        .bench_local(|| tick(&params, &body, &Terrain::flat(), &mut state, divan::black_box(&still), 0.01));
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
