//! How fast a batch goes: clips a second with one job and with as many as there are cores, pictures included, files left out; and how
//! long ten thousand variations take to plan.
//!
//! `cargo bench --bench batch [-- RIG.glb]`

#[path = "batched.rs"]
mod batched;
#[path = "../common.rs"]
mod common;

use batched::{Nowhere, eight_sides, planned, rates};
use std::sync::Arc;
use std::time::Instant;
use surefoot::rig;

#[expect(clippy::print_stdout, reason = "a bench prints")]
fn main() {
    let wanted = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let rig = match &wanted {
        Some(path) => rig::load(std::path::Path::new(path)).unwrap_or_else(|error| panic!("{error}")),
        None => common::builtin(),
    };
    let place = Nowhere(Arc::new(rig));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("{}: clips of 4 s a second, with their small pictures", wanted.as_deref().unwrap_or("builtin"));
    println!("drive      1 job  {cores} jobs  of {cores} x one");
    for (drive, persons) in [("stepper", 6), ("ragdoll", 2)] {
        let [one, all] = rates(&eight_sides(drive, persons), &place, cores);
        println!("{drive:<9} {one:6.2} {all:7.2} {:10.2}", all / one / cores as f64);
    }
    let begun = Instant::now();
    let vary = "\"push.0.toward\" = { from = 0, to = 351, step = 9 }\n\"push.0.force\" = { from = 100, to = 340, count = 25 }\nseed = { from = 1, to = 10, count = 10 }";
    let count = planned(vary, "stepper").variations.len();
    println!("planning {count} variations: {:.2} s", begun.elapsed().as_secs_f64());
}
