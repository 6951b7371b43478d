//! Batches through the real path, their files left out: how many clips a second. For `tests/benches/{batch,clips}.rs`.

use std::sync::Arc;
use std::time::Instant;
use surefoot::bake::Base;
use surefoot::batch::record::{Measured, Record};
use surefoot::batch::run::{Ended, Place, Stopped, Wanted, run};
use surefoot::batch::{Plan, Variation, plan};
use surefoot::model::{Scenario, sweep_text};
use surefoot::rig::Rig;

const SHOVE: &str = "title = \"shove\"\nduration = 4.0\n[[push]]\nstart = 1.0\nduration = 0.2\nforce = 300\ntoward = \"left\"\nat = \"chest\"\n";

/// One rig, and nothing kept.
pub struct Nowhere(pub Arc<Rig>);

impl Place for Nowhere {
    fn rig(&self, _: usize) -> Result<Arc<Rig>, String> {
        Ok(Arc::clone(&self.0))
    }

    fn base(&self, _: &Variation, _: &Rig, _: &Scenario) -> Result<Option<Arc<Base>>, String> {
        Ok(None)
    }

    fn lay(&self, _: &Variation, _: &mut Scenario) -> Result<(), String> {
        Ok(())
    }

    fn done(&self, _: &Variation) -> Option<Measured> {
        None
    }

    fn keep(&self, _: &Variation, _: Vec<(String, Vec<u8>)>, _: Record) -> Result<(), Stopped> {
        Ok(())
    }
}

/// What varies of a shove, moved like that.
pub fn planned(vary: &str, drive: &str) -> Plan {
    let text = format!("scenario = \"shove.toml\"\n[vary]\n{vary}\n[bake]\ndrive = \"{drive}\"\n");
    let (sweep, _) = sweep_text::read("sweep.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
    plan(sweep, &[("shove.toml".to_owned(), SHOVE.to_owned())]).unwrap_or_else(|faults| panic!("{faults:?}"))
}

/// Shoves of 30 and 80 Ns from eight sides, by so many persons.
pub fn eight_sides(drive: &str, persons: u32) -> Plan {
    let vary = format!(
        "\"push.0.toward\" = {{ from = 0, to = 315, step = 45 }}\n\"push.0.force\" = [150, 400]\nseed = {{ from = 1, to = {persons}, count = {persons} }}"
    );
    planned(&vary, drive)
}

/// Clips a second with one job and with so many: alternating runs, the best of three, for the machine has other things to do.
pub fn rates(plan: &Plan, place: &Nowhere, jobs: usize) -> [f64; 2] {
    let mut best = [0.0_f64; 2];
    for _ in 0..3 {
        for (best, jobs) in best.iter_mut().zip([1, jobs]) {
            *best = best.max(rate(plan, place, jobs));
        }
    }
    best
}

/// Clips a second, with their small pictures.
fn rate(plan: &Plan, place: &Nowhere, jobs: usize) -> f64 {
    let wanted = Wanted { cells: true, pieces: false };
    let begun = Instant::now();
    let (endings, _) = run(plan, 0..plan.variations.len(), jobs, wanted, place, &|_, _| {});
    let done = endings.iter().filter(|ended| matches!(ended, Ended::Done(..))).count();
    assert_eq!(done, plan.variations.len(), "every variation has its clip");
    done as f64 / begun.elapsed().as_secs_f64()
}
