//! The bodies of tests that draw them: the built-in rig on longer and shorter legs, and third-party rigs where they are there.

use crate::common::builtin;
use crate::data;
use surefoot::rig::{Rig, load};

/// Rigs and how long their legs are made: the built-in one by each of `legs`, then those files as they are.
#[track_caller]
pub fn people(legs: &[f64], files: &[&str]) -> Vec<(Rig, f64)> {
    let mut people: Vec<(Rig, f64)> = legs.iter().map(|legs| (builtin(), *legs)).collect();
    if let Some(folder) = data::more() {
        let loaded = |name: &&str| (load(&folder.join("rigs").join(name)).expect("the rig loads"), 1.0);
        people.extend(files.iter().map(loaded));
    }
    people
}
