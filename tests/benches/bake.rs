//! What a bake costs (to hold: a 4 s clip from command to file in 0.15 s): the clip, its bytes, both, loading the rig.
//!
//! One thread, the built-in rig, a 60 Ns shove to the left with its steps; the stepper's tick is in `stepper.rs`.

use divan::Bencher;
use surefoot::bake::{BakeOptions, Baked, bake};
use surefoot::export::glb;
use surefoot::model::Role;
use surefoot::model::scenario::{Direction, Push, Scenario};
use surefoot::rig::mannequin::BUILTIN;
use surefoot::rig::{Rig, load_bytes};

fn main() {
    divan::main();
}

fn rig() -> Rig {
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    load_bytes("builtin", BUILTIN, &none, None).expect("the built-in rig loads")
}

fn shove(impulse: f64) -> Scenario {
    let toward = Direction::Left;
    let push = Push { start: 0.6, duration: 0.2, force: impulse / 0.2, toward, at: Role::Chest };
    Scenario { duration: 4.0, push: vec![push], pull: Vec::new(), ..Scenario::demo() }
}

fn baked(rig: &Rig, scenario: &Scenario) -> Baked {
    bake(rig, scenario, &BakeOptions::default()).expect("the simulation holds")
}

#[divan::bench]
fn load_rig() -> Rig {
    rig()
}

#[divan::bench(args = [0.0, 20.0, 60.0, 100.0])]
fn bake_four_seconds(bencher: Bencher, impulse: f64) {
    let (rig, scenario) = (rig(), shove(impulse));
    bencher.bench_local(|| baked(&rig, divan::black_box(&scenario)));
}

#[divan::bench]
fn export_four_seconds(bencher: Bencher) {
    let rig = rig();
    let made = baked(&rig, &shove(60.0));
    let clips = [(made.clip, made.report)];
    bencher.bench_local(|| glb(&rig, divan::black_box(&clips)).expect("can be written"));
}

/// All that a command does but for the disk.
#[divan::bench]
fn load_bake_and_export() -> usize {
    let rig = rig();
    let made = baked(&rig, &shove(60.0));
    glb(&rig, &[(made.clip, made.report)]).expect("can be written").bytes.len()
}
