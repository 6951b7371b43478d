//! How fast a batch goes: clips a second with one job and with as many as there are cores, pictures included, files left out; and how
//! long ten thousand variations take to plan. Alternating runs, the best of three: the machine has other things to do.
//!
//! `cargo bench --bench batch [-- RIG.glb]`

use std::sync::Arc;
use std::time::Instant;
use surefoot::bake::Base;
use surefoot::batch::record::{Measured, Record};
use surefoot::batch::run::{Ended, Place, Stopped, Wanted, run};
use surefoot::batch::{Plan, Variation, plan};
use surefoot::model::{Scenario, sweep_text};
use surefoot::rig::{self, Rig, mannequin::BUILTIN};

const SHOVE: &str = "title = \"shove\"\nduration = 4.0\n[[push]]\nstart = 1.0\nduration = 0.2\nforce = 300\ntoward = \"left\"\nat = \"chest\"\n";

/// One rig, and nothing kept.
struct Nowhere(Arc<Rig>);

impl Place for Nowhere {
    fn rig(&self, _: usize) -> Result<Arc<Rig>, String> {
        Ok(Arc::clone(&self.0))
    }

    fn base(&self, _: &Variation, _: &Rig, _: &Scenario) -> Result<Option<Arc<Base>>, String> {
        Ok(None)
    }

    fn done(&self, _: &Variation) -> Option<Measured> {
        None
    }

    fn keep(&self, _: &Variation, _: Vec<(String, Vec<u8>)>, _: Record) -> Result<(), Stopped> {
        Ok(())
    }
}

fn planned(vary: &str, drive: &str) -> Plan {
    let text = format!("scenario = \"shove.toml\"\n[vary]\n{vary}\n[bake]\ndrive = \"{drive}\"\n");
    let (sweep, _) = sweep_text::read("sweep.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
    plan(sweep, &[("shove.toml".to_owned(), SHOVE.to_owned())]).unwrap_or_else(|faults| panic!("{faults:?}"))
}

/// Clips a second.
fn rate(plan: &Plan, place: &Nowhere, jobs: usize) -> f64 {
    let wanted = Wanted { cells: true, pieces: false };
    let begun = Instant::now();
    let (endings, _) = run(plan, 0..plan.variations.len(), jobs, wanted, place, &|_, _| {});
    let done = endings.iter().filter(|ended| matches!(ended, Ended::Done(..))).count();
    assert_eq!(done, plan.variations.len(), "every variation has its clip");
    done as f64 / begun.elapsed().as_secs_f64()
}

#[expect(clippy::print_stdout, reason = "a bench prints")]
fn main() {
    let wanted = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let rig = match &wanted {
        Some(path) => rig::load(std::path::Path::new(path)).unwrap_or_else(|error| panic!("{error}")),
        None => {
            let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
            rig::load_bytes("builtin", BUILTIN, &alone, None).expect("the built-in rig")
        }
    };
    let place = Nowhere(Arc::new(rig));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("{}: clips of 4 s a second, with their small pictures", wanted.as_deref().unwrap_or("builtin"));
    println!("drive      1 job  {cores} jobs  of {cores} x one");
    let eight = "\"push.0.toward\" = { from = 0, to = 315, step = 45 }";
    for (drive, seeds) in [("stepper", 6), ("ragdoll", 2)] {
        let vary =
            format!("{eight}\n\"push.0.force\" = [150, 400]\nseed = {{ from = 1, to = {seeds}, count = {seeds} }}");
        let plan = planned(&vary, drive);
        let mut best = [0.0_f64; 2];
        for _ in 0..3 {
            for (best, jobs) in best.iter_mut().zip([1, cores]) {
                *best = best.max(rate(&plan, &place, jobs));
            }
        }
        println!("{drive:<9} {:6.2} {:7.2} {:10.2}", best[0], best[1], best[1] / best[0] / cores as f64);
    }
    let begun = Instant::now();
    let vary = "\"push.0.toward\" = { from = 0, to = 351, step = 9 }\n\"push.0.force\" = { from = 100, to = 340, count = 25 }\nseed = { from = 1, to = 10, count = 10 }";
    let count = planned(vary, "stepper").variations.len();
    println!("planning {count} variations: {:.2} s", begun.elapsed().as_secs_f64());
}
