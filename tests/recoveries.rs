//! What the articulated body recovers from: shoves of the paper's range, by joint torques alone, each of another person; and that a clip whose
//! run loses its balance says so.
//!
//! The shoves are those of `cargo bench --bench ragdoll -- pushes`: 10 to 500 N for 0.1 to 0.5 s at the chest, from anywhere, in bins of impulse, on
//! seeds that nothing was tuned on.

#![expect(clippy::print_stdout, reason = "numbers")]

#[path = "benches/shoves.rs"]
#[expect(dead_code, reason = "of the shoves a test wants those alone that it draws")]
mod shoves;

use crate::common::builtin;
use rayon::prelude::*;
use shoves::{AHEAD, EDGES, WANTED, drawn, wilson};
use surefoot::bake::{BakeOptions, Drive, bake};
use surefoot::model::Terrain;
use surefoot::model::report::Outcome;
use surefoot::ragdoll::control::Assist;
use surefoot::sim::{Ahead, Articulated, ArticulatedOptions, simulate_articulated};
use surefoot::whole_body::reaction::Personality;
use surefoot::whole_body::{Anatomy, stand};

/// Shoves a bin.
const COUNT: usize = 128;
/// s, for how long a run goes on after its shove began: who falls has fallen by then.
const AFTER: f64 = 5.0;

/// The runs of that many people, each shoved by as many N s as the bin has.
fn runs(bin: usize, count: usize, effort: u8) -> Vec<Option<Articulated>> {
    let body = builtin().body;
    let anatomy = Anatomy::new(&body);
    let physique = stand::physique(&body, &anatomy);
    let run = |(person, shove): (u64, shoves::Shove)| {
        let options = ArticulatedOptions {
            duration: shove.start + AFTER,
            extra: 0.0,
            personality: Personality::drawn(person),
            seed: person,
            ahead: Ahead { effort, ..Ahead::default() },
            ..ArticulatedOptions::default()
        };
        let pushes = [(shove.known(&body), false)];
        simulate_articulated(&body, &anatomy, &physique, &Terrain::flat(), &options, &pushes, Assist::default()).ok()
    };
    let cases: Vec<_> = (0..).zip(drawn(bin, count)).collect();
    cases.into_par_iter().map(run).collect()
}

fn stands(run: &Option<Articulated>) -> bool {
    run.as_ref().is_some_and(|run| run.trace.lost.is_none())
}

#[test]
fn who_is_shoved_stands_as_often_as_is_wanted() {
    for (bin, wanted) in WANTED.into_iter().enumerate() {
        let up = runs(bin, COUNT, 0).iter().filter(|run| stands(run)).count();
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

#[test]
fn nobody_who_looks_ahead_falls_where_nobody_is_to() {
    for bin in (0..EDGES.len() - 1).filter(|bin| AHEAD[*bin] == 100.0) {
        let falls = runs(bin, 2 * COUNT, 1).iter().filter(|run| !stands(run)).count();
        assert_eq!(falls, 0, "of {}, {} to {} Ns", 2 * COUNT, EDGES[bin], EDGES[bin + 1]);
    }
}

#[test]
fn a_clip_says_that_it_falls_wherever_its_run_loses_balance() {
    let rig = builtin();
    let options = BakeOptions { drive: Drive::Stepper, ..BakeOptions::default() };
    let bins = [0, EDGES.len() - 2].into_iter();
    let cases: Vec<_> = bins.flat_map(|bin| drawn(bin, COUNT / 4)).collect();
    let clips: Vec<_> = cases
        .into_par_iter()
        .map(|shove| bake(&rig, &shove.scenario(shove.start + AFTER), &options).unwrap_or_else(|why| panic!("{why}")))
        .collect();
    let lost = clips.iter().filter(|clip| clip.performance.lost.is_some()).count();
    println!("{lost} of {} lose balance by the stepper", clips.len());
    assert!((COUNT / 16..clips.len()).contains(&lost), "{lost}: too few or all, so that this shows nothing");
    for clip in clips {
        let falls = clip.performance.lost.is_some();
        let told = clip.report.events.iter().any(|event| event.name == "balance_lost");
        let says = [clip.report.outcome == Outcome::Fall, clip.report.plausibility.falls, told, clip.fall().is_some()];
        assert_eq!(says, [falls; 4], "outcome, score, event, fall: balance lost at {:?}", clip.performance.lost);
    }
}
