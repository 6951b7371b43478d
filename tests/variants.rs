//! The paper's variants of the stepper, as a scenario's `[stepper]` chooses them: what each changes in what a person is given.

use crate::common::builtin;
use rayon::prelude::*;
use surefoot::bake::{BakeError, BakeOptions, Baked, Drive, Helped, bake, perform_by};
use surefoot::maths::seed::Seed;
use surefoot::model::Scenario;
use surefoot::model::scenario_text::parse;
use surefoot::ragdoll::control::Assist;
use surefoot::sim::Trace;

/// A shove of so many N s in 0.2 s, to that side, by a stepper of those keys.
fn shoved(keys: &str, impulse: f64, toward: f64, duration: f64) -> Scenario {
    let text = format!(
        "duration = {duration}\n[stepper]\n{keys}\n[[push]]\nstart = 0.6\nduration = 0.2\nforce = {}\ntoward = {toward}\n",
        impulse / 0.2
    );
    parse("shoved", &text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn traced(scenario: &Scenario) -> Trace {
    perform_by(&builtin().body, scenario, 0, Drive::Stepper).expect("it runs").trace
}

/// The steps of 16 seeded shoves from all around, and how many of them fall.
fn steps(keys: &str, impulses: [f64; 2]) -> (usize, usize) {
    let mut draw = Seed::new(11);
    let cases: Vec<(f64, f64)> =
        (0..16).map(|_| (draw.between(impulses[0], impulses[1]), draw.between(0.0, 360.0))).collect();
    let runs: Vec<Trace> =
        cases.par_iter().map(|(impulse, toward)| traced(&shoved(keys, *impulse, *toward, 3.0))).collect();
    (runs.iter().map(|run| run.steps.len()).sum(), runs.iter().filter(|run| run.lost.is_some()).count())
}

#[test]
fn who_walks_without_ankle_feedback_touches_the_ground_in_points() {
    let moving = |keys: &str| {
        let text = format!("duration = 6\n[stepper]\n{keys}\n[[walk]]\nstart = 0.2\nspeed = 1.0\n");
        let run = traced(&parse("walk", &text).unwrap_or_else(|errors| panic!("{errors}")));
        assert!(run.lost.is_none() && run.steps.len() >= 8, "{} steps", run.steps.len());
        let ticks = &run.ticks[200..];
        let moved = ticks.windows(2).filter(|pair| pair[0].cop.distance(pair[1].cop) > 1e-4).count();
        moved as f64 / ticks.len() as f64
    };
    let (rolls, bare) = (moving(""), moving("ankle_feedback = false"));
    assert!(rolls > 0.8 && bare < 0.1, "the pressure moves in {rolls} and {bare} of the ticks");
}

#[test]
fn the_area_under_a_foot_decides_how_much_is_swayed_out() {
    let of = |support: &str| steps(&format!("support = \"{support}\""), [15.0, 45.0]).0;
    let [soles, circles] = ["soles", "circles"].map(of);
    assert!(soles < circles, "{soles} steps on soles, {circles} on circles");
}

#[test]
fn who_waits_for_the_bare_projection_steps_later_and_falls_more() {
    let first = |trigger: &str| {
        let run = traced(&shoved(&format!("trigger = \"{trigger}\""), 70.0, 0.0, 3.0));
        run.steps.first().expect("a step").lift
    };
    assert!(first("projected") > first("extrapolated") + 0.05);
    let of = |trigger: &str| steps(&format!("trigger = \"{trigger}\""), [110.0, 170.0]).1;
    assert!(of("projected") > of("extrapolated"));
}

#[test]
fn legs_give_by_their_springs_and_not_at_all_where_they_may_not_change() {
    let dips = |keys: &str| {
        let run = traced(&shoved(keys, 70.0, 0.0, 3.0));
        let heights = || run.ticks.iter().map(|tick| tick.com.y);
        heights().fold(0.0, f64::max) - heights().fold(f64::INFINITY, f64::min)
    };
    let [plain, soft, stiff, none] = ["", "spring = 0.25", "spring = 4", "leg_change = false"].map(dips);
    assert!(none < 1e-9, "{none} m");
    assert!(plain > 0.01 && (soft - plain).abs() > 1e-3 && (stiff - plain).abs() > 1e-4, "{soft} {plain} {stiff} m");
}

#[test]
fn a_pull_moves_the_foothold_as_far_as_its_bias_says() {
    let landed = |bias: f64| {
        let text = format!(
            "duration = 4\n[stepper]\npull_bias = {bias}\n[[pull]]\nstart = 0.5\nduration = 3\nforce = 110\ntoward = 0\n"
        );
        let run = traced(&parse("pulled", &text).unwrap_or_else(|errors| panic!("{errors}")));
        run.steps.first().expect("it is pulled off its feet").to.ankle.z
    };
    let [none, usual, twice] = [0.0, 0.4, 0.8].map(landed);
    assert!(none + 0.005 < usual && usual + 0.005 < twice, "{none} {usual} {twice} m");
}

#[test]
fn the_body_says_that_it_has_no_springs_and_auto_takes_the_stepper() {
    let scenario = shoved("spring = 2.0", 40.0, 0.0, 3.0);
    let by = |drive: Drive| -> Result<Baked, BakeError> {
        bake(&builtin(), &scenario, &BakeOptions { drive, ..BakeOptions::default() })
    };
    let refused = by(Drive::Ragdoll(Helped::Within(Assist::default()))).expect_err("it cannot").to_string();
    assert!(refused.contains("spring and damping of [stepper]"), "{refused}");
    let chosen = by(Drive::Auto(Helped::Auto)).expect("it bakes").choice.expect("a choice");
    assert!(chosen.why.contains("[stepper]"), "{}", chosen.why);
}

#[test]
fn the_body_that_waits_for_the_bare_projection_steps_later() {
    let first = |trigger: &str, toward: f64| {
        let scenario = shoved(&format!("trigger = \"{trigger}\""), 55.0, toward, 3.0);
        let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
        let trace = perform_by(&builtin().body, &scenario, 0, drive).expect("it runs").trace;
        trace.steps.first().map_or(f64::INFINITY, |step| step.lift)
    };
    let mut draw = Seed::new(23);
    for toward in (0..8).map(|_| draw.between(0.0, 360.0)) {
        let [usual, late] = ["extrapolated", "projected"].map(|trigger| first(trigger, toward));
        assert!(usual + 0.04 < late, "toward {toward:.0}: at {usual:.2} s, and by the projection at {late:.2} s");
    }
}

#[test]
fn the_body_that_is_dragged_lands_elsewhere_by_its_bias() {
    let way = |bias: f64| {
        let text = format!(
            "duration = 6\n[stepper]\npull_bias = {bias}\n[[walk]]\nstart = 0.2\nspeed = 0.8\n[[pull]]\nstart = 2.0\n\
             duration = 4.0\nforce = 60.0\ntoward = \"back\"\n"
        );
        let scenario = parse("dragged", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
        let trace = perform_by(&builtin().body, &scenario, 0, drive).expect("it runs").trace;
        assert!(trace.lost.is_none(), "pull_bias {bias}");
        let leads = |tick: &surefoot::sim::TickState| {
            let foremost = tick.feet.iter().map(|foot| foot.ankle.z).fold(f64::NEG_INFINITY, f64::max);
            foremost - tick.com.z
        };
        trace.ticks[400..].iter().map(leads).sum::<f64>() / trace.ticks[400..].len() as f64
    };
    let [none, twice] = [0.0, 0.8].map(way);
    assert!(twice + 0.01 < none, "the foremost foot is {none:.3} m ahead without, {twice:.3} m with twice the bias");
}

#[test]
fn a_key_of_the_stepper_changes_the_bodys_clip_or_is_said_to_change_nothing() {
    let rig = builtin();
    let lanes = [
        "duration = 3.0\n[[push]]\nstart = 0.5\nduration = 0.2\nforce = 400\ntoward = 40\n",
        "duration = 4.0\n[[walk]]\nstart = 0.5\nspeed = 0.6\n[[pull]]\nstart = 1.0\nduration = 3.0\nforce = 60\ntoward = \"back\"\n",
    ];
    let keys = [
        "ankle_feedback = false",
        "leg_change = false",
        "support = \"circles\"",
        "trigger = \"projected\"",
        "length_bias = 0.0",
        "pull_bias = 2.0",
    ];
    for lane in lanes {
        let baked = |rest: &str| {
            let scenario = parse("keys", &format!("{lane}[stepper]\n{rest}\n")).expect("a scenario");
            let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
            bake(&rig, &scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("it bakes")
        };
        let usual = baked("");
        // A trigger makes who stands step: of a walk that nothing shoves it changes nothing.
        for key in keys.into_iter().filter(|key| lane.contains("[[push]]") || !key.starts_with("trigger")) {
            let set = baked(key);
            let name = key.split(' ').next().expect("a key");
            let told = set.warnings.iter().any(|one| one.starts_with("[stepper]") && one.contains(name));
            assert_eq!(told, set.clip == usual.clip, "{key} in {lane}: {:?}", set.warnings);
        }
    }
}
