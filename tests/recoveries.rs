//! What the articulated body recovers from without looking ahead: shoves of the paper's range, by joint torques alone, each of another person.
//!
//! The shoves are those of `cargo bench --bench ragdoll -- pushes`: 10 to 500 N for 0.1 to 0.5 s at the chest, from anywhere, in bins of impulse, on
//! seeds that nothing was tuned on.

#![expect(clippy::print_stdout, reason = "numbers")]

#[path = "benches/shoves.rs"]
#[expect(dead_code, reason = "of the shoves a test wants those alone that it draws")]
mod shoves;

use crate::common::builtin;
use rayon::prelude::*;
use shoves::{EDGES, WANTED, drawn, wilson};
use surefoot::model::Terrain;
use surefoot::ragdoll::control::Assist;
use surefoot::sim::{ArticulatedOptions, simulate_articulated};
use surefoot::whole_body::reaction::Personality;
use surefoot::whole_body::{Anatomy, stand};

/// Shoves a bin.
const COUNT: usize = 128;
/// s, for how long a run goes on after its shove began: who falls has fallen by then.
const AFTER: f64 = 5.0;

#[test]
fn who_is_shoved_stands_as_often_as_is_wanted() {
    let body = builtin().body;
    let anatomy = Anatomy::new(&body);
    let physique = stand::physique(&body, &anatomy);
    for (bin, wanted) in WANTED.into_iter().enumerate() {
        let stands = |(person, shove): (u64, shoves::Shove)| {
            let options = ArticulatedOptions {
                duration: shove.start + AFTER,
                extra: 0.0,
                personality: Personality::drawn(person),
                seed: person,
                ..ArticulatedOptions::default()
            };
            let pushes = [(shove.known(&body), false)];
            let flat = Terrain::flat();
            let run =
                simulate_articulated(&body, &anatomy, &physique, &flat, &options, &pushes, Assist::default()).ok();
            run.is_some_and(|run| run.trace.lost.is_none())
        };
        let cases: Vec<_> = (0..).zip(drawn(bin, COUNT)).collect();
        let up = cases.into_par_iter().filter(|case| stands(*case)).count();
        let [low, high] = wilson(up, COUNT);
        println!("{} to {} Ns: {up} of {COUNT} stand ({low:.1} to {high:.1} %)", EDGES[bin], EDGES[bin + 1]);
        assert!(
            high + 1e-9 >= wanted,
            "{} to {} Ns: {up} of {COUNT} stand, wanted {wanted} %",
            EDGES[bin],
            EDGES[bin + 1]
        );
    }
}
