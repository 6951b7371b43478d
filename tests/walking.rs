//! Walking, as a person would judge it: speed held, pushes caught without losing the walk, turns, stops, sizes; with the
//! whole controller and with the paper's bare pendulum. What the numbers are is printed.

use glam::{DVec2, DVec3};
use surefoot::maths::seed::Seed;
use surefoot::model::scenario::{Stepper, Turn, Walk};
use surefoot::sim::{Script, SessionPush, SimulateOptions, Trace, simulate};
use surefoot::stepper::support::{forward, left};
use surefoot::stepper::{Params, Physique, StepKind, Style, ground};

/// s, when the walk of most tests begins.
const GO: f64 = 0.2;

fn adult() -> Physique {
    Physique::REFERENCE
}

/// The same upper body on legs of that share.
fn legs(share: f64) -> Physique {
    let body = adult();
    let lower = body.hip_height * (1.0 - share);
    Physique {
        com_height: body.com_height - lower,
        leg_length: body.leg_length * share,
        hip_height: body.hip_height * share,
        ankle_height: body.ankle_height * share,
        heel: body.heel * share,
        tip: body.tip * share,
        half_width: body.half_width * share,
        com_forward: body.com_forward * share,
        stance_width: body.stance_width * share,
        ..body
    }
}

fn bare() -> Style {
    Style { variant: Stepper { ankle_feedback: false, leg_change: false, ..Stepper::default() }, ..Style::default() }
}

/// Walks towards `heading` degrees, facing 0, from `GO` to `until`.
fn walk(speed: f64, heading: f64, until: f64) -> Script {
    let entry = Walk { start: GO, duration: None, speed, heading: heading.to_radians(), facing: Some(0.0) };
    let stop = Walk { start: until, speed: 0.0, ..entry };
    Script { walk: vec![entry, stop], ..Script::standing(&[]) }
}

fn run(body: &Physique, script: &Script, style: Style, duration: f64) -> Trace {
    simulate(body, script, &SimulateOptions { duration, style, ..SimulateOptions::default() })
}

fn at(trace: &Trace, time: f64) -> DVec2 {
    ground(trace.ticks[(time / trace.dt).round() as usize].com)
}

/// Mean speed that way over whole strides within a span, m/s.
fn mean_speed(trace: &Trace, from: f64, until: f64, way: DVec2) -> f64 {
    let lands: Vec<f64> = trace.steps.iter().map(|step| step.land).filter(|&t| t > from && t < until).collect();
    let Some(last) = lands.len().checked_sub(1).map(|strides| strides / 2 * 2).filter(|&last| last > 0) else {
        return f64::NAN;
    };
    (at(trace, lands[last]) - at(trace, lands[0])).dot(way) / (lands[last] - lands[0])
}

/// s after `from` until the speed along +Z, averaged over the step around it, is within 10 % for good.
fn back_in(trace: &Trace, from: f64, speed: f64) -> Option<f64> {
    let span = (60.0 / (60.0 * speed / 0.0065_f64).sqrt() / trace.dt).round() as usize;
    let (start, end) = ((from / trace.dt).round() as usize, trace.ticks.len().checked_sub(span)?);
    let off = |i: usize| {
        let way = ground(trace.ticks[i + span].com) - ground(trace.ticks[i].com);
        (way.y / (span as f64 * trace.dt) / speed - 1.0).abs() > 0.1
    };
    match (start..end).rev().find(|&i| off(i)) {
        None => Some(0.0),
        Some(last) if last + 1 >= end => None,
        Some(last) => Some((last + 1 + span / 2 - start) as f64 * trace.dt),
    }
}

fn force(degrees: f64, newtons: f64) -> DVec3 {
    let way = forward(degrees.to_radians());
    DVec3::new(way.x, 0.0, way.y) * newtons
}

/// Landing foot from the other one: along the heading, across it to the foot's own side.
fn strides(trace: &Trace, from: f64, until: f64, way: DVec2) -> Vec<(f64, f64)> {
    let aside = DVec2::new(way.y, -way.x);
    let within = trace.steps.iter().filter(|step| step.land > from && step.land < until);
    within
        .map(|step| {
            let other = trace.ticks[(step.land / trace.dt).round() as usize].feet[step.side.other() as usize];
            let apart = ground(step.to.ankle - other.ankle);
            (apart.dot(way), apart.dot(aside) * step.side.sign())
        })
        .collect()
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// Ends side by side, at rest.
fn assert_stands(body: &Physique, trace: &Trace, what: &str) {
    let end = trace.ticks[trace.ticks.len() - 1];
    let apart = ground(end.feet[0].ankle - end.feet[1].ankle) * (0.18 / body.stance_width);
    let (wide, staggered) = (apart.dot(left(end.facing)), apart.dot(forward(end.facing)).abs());
    assert!(trace.lost.is_none() && trace.rest >= 0.5, "{what}: lost {:?}, rest {}", trace.lost, trace.rest);
    assert!((0.13..0.23).contains(&wide) && staggered < 0.051, "{what}: ends {wide} wide, {staggered} staggered");
}

#[test]
fn walks_at_any_speed_from_a_stand_and_back_to_one() {
    let ways = [
        ("forward", 0.0, vec![0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8]),
        ("backward", 180.0, vec![0.2, 0.4, 0.6, 0.8, 1.0]),
        ("sideways", 90.0, vec![0.1, 0.2, 0.4, 0.6]),
        ("sideways", 270.0, vec![0.3, 0.6]),
        ("aslant", 40.0, vec![0.5, 1.0]),
    ];
    for (style, name) in [(Style::default(), "whole"), (bare(), "bare pendulum")] {
        for (way, heading, speeds) in &ways {
            for &speed in speeds {
                let trace = run(&adult(), &walk(speed, *heading, 8.0), style, 12.0);
                let mean = mean_speed(&trace, 3.5, 8.0, forward(heading.to_radians()));
                let error = mean / speed - 1.0;
                let steady = &trace.ticks[400..800];
                let (low, high) = range(steady.iter().map(|tick| tick.com.y));
                let (right, left) = range(steady.iter().map(|tick| tick.com.x));
                let after = trace.steps.iter().filter(|step| step.lift > 8.0).count();
                eprintln!(
                    "{name}, {way} {speed} m/s: {:+.1} %, up and down {:.3} m, across {:.3} m, {after} steps to stand",
                    100.0 * error,
                    high - low,
                    left - right
                );
                assert!(error.abs() <= 0.05, "{name} {way} {speed}: {mean}");
                assert_stands(&adult(), &trace, &format!("{name} {way} {speed}"));
                assert!(trace.steps.iter().filter(|step| step.land < 8.0).all(|step| step.kind == StepKind::Walk));
            }
        }
    }
}

#[test]
fn a_plain_walk_crosses_nothing_and_keeps_its_width_and_ratio() {
    for speed in [0.4, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8] {
        let trace = run(&adult(), &walk(speed, 0.0, 20.0), Style::default(), 12.0);
        let steps = strides(&trace, 3.5, 12.0, DVec2::Y);
        let (narrow, wide) = range(steps.iter().map(|step| step.1));
        let (short, long) = range(steps.iter().map(|step| step.0));
        let lands: Vec<f64> = trace.steps.iter().map(|step| step.land).filter(|&land| land > 3.5).collect();
        let time = (lands[lands.len() - 1] - lands[0]) / (lands.len() - 1) as f64;
        let ratio = 0.5 * (short + long) / (60.0 / time);
        let near = trace.ticks.iter().map(|t| ground(t.feet[0].ankle - t.feet[1].ankle).length());
        let near = near.fold(f64::INFINITY, f64::min);
        let doubles = trace.ticks[400..1200].iter().filter(|t| t.planted == [true; 2]).count() as f64 / 800.0;
        let sway = range(trace.ticks[600..].iter().map(|t| t.com.x));
        eprintln!(
            "{speed} m/s: steps {short:.3}..{long:.3} m at {:.0} a minute, ratio {ratio:.5}, width {narrow:.3}..{wide:.3} m, \
             double support {:.0} %, sway {:.3} m, ankles at least {near:.3} m apart",
            60.0 / time,
            100.0 * doubles,
            sway.1 - sway.0
        );
        assert!(narrow > 0.07 && wide < 0.13 && long - short < 0.03, "{speed}: {narrow}..{wide}, {short}..{long}");
        assert!(near > 0.085, "{speed}: {near}");
        assert!(speed < 0.7 || (0.0059..0.0071).contains(&ratio), "{speed}: {ratio}");
        assert!((speed - 1.2).abs() > 0.1 || (0.20..0.28).contains(&doubles), "{doubles}");
        assert!(speed < 0.9 || (0.018..0.045).contains(&(sway.1 - sway.0)), "{speed}: {sway:?}");
    }
}

#[test]
fn holds_its_speed_in_the_papers_cases() {
    let cases = [
        ("an impulse from behind", 0.0, 100.0, 0.2),
        ("an impulse from the front", 180.0, 100.0, 0.2),
        ("a push that lasts", 0.0, 60.0, 99.0),
        ("a pull that lasts", 180.0, 60.0, 99.0),
        ("dragging", 180.0, 80.0, 99.0),
        ("being dragged", 0.0, 80.0, 99.0),
    ];
    for (style, name) in [(Style::default(), "whole"), (bare(), "bare pendulum")] {
        for (case, degrees, newtons, duration) in cases {
            for speed in [0.8, 1.0, 1.2] {
                let mut slowest = 0.0_f64;
                let mut worst = 0.0_f64;
                for start in [5.0, 5.2, 5.4] {
                    let push = SessionPush { start, duration, force: force(degrees, newtons), turns: false, arm: 0.0 };
                    let script = Script { pushes: vec![push], ..walk(speed, 0.0, 99.0) };
                    let trace = run(&adult(), &script, style, 14.0);
                    let back = back_in(&trace, start + duration.min(0.2), speed).unwrap_or(f64::INFINITY);
                    slowest = slowest.max(back);
                    worst = worst.max((mean_speed(&trace, 8.0, 14.0, DVec2::Y) / speed - 1.0).abs());
                    assert!(trace.lost.is_none(), "{name} {case} {speed}");
                }
                eprintln!("{name}, {case} at {speed} m/s: back in {slowest:.2} s, then {:.1} % off", 100.0 * worst);
                assert!(worst <= 0.05, "{name} {case} {speed}: {worst}");
                assert!(duration > 1.0 || slowest <= 2.0, "{name} {case} {speed}: back in {slowest}");
            }
        }
        let changing = [0.6, 1.4, 0.9, 1.8, 0.4];
        let walk = (0..).zip(changing).map(|(i, speed)| Walk {
            start: GO + 6.0 * f64::from(i),
            duration: None,
            speed,
            heading: 0.0,
            facing: None,
        });
        let trace = run(&adult(), &Script { walk: walk.collect(), ..Script::standing(&[]) }, style, 30.0);
        for (i, speed) in (0..).zip(changing) {
            let start = GO + 6.0 * f64::from(i);
            let error = mean_speed(&trace, start + 2.5, start + 6.0, DVec2::Y) / speed - 1.0;
            eprintln!("{name}, changing speed, {speed} m/s: {:+.1} %", 100.0 * error);
            assert!(error.abs() <= 0.05, "{name} {speed}: {error}");
        }
    }
}

#[test]
fn keeps_walking_under_the_papers_pushes() {
    let share = |agility: f64, count: u32| {
        let mut seed = Seed::new(2013);
        let style = Style { agility, ..Style::default() };
        let (mut kept, mut fallen) = (0, 0);
        for _ in 0..count {
            let (newtons, duration) = (seed.between(10.0, 500.0), seed.between(0.1, 0.5));
            let (degrees, start) = (seed.between(0.0, 360.0), seed.between(4.0, 6.0));
            let push = SessionPush { start, duration, force: force(degrees, newtons), turns: false, arm: 0.0 };
            let script = Script { pushes: vec![push], ..walk(1.2, 0.0, 99.0) };
            let trace = run(&adult(), &script, style, start + duration + 5.0);
            let back = back_in(&trace, start + duration, 1.2);
            kept += u32::from(trace.lost.is_none() && back.is_some_and(|back| back <= 3.0));
            fallen += u32::from(trace.lost.is_some());
        }
        (f64::from(kept) / f64::from(count), fallen)
    };
    let (best, best_fell) = share(1.0, 1000);
    let (adult, adult_fell) = share(0.5, 1000);
    eprintln!(
        "of 1000 pushes at 1.2 m/s kept walking: agility 1 {best:.4} ({best_fell} fell), 0.5 {adult:.4} ({adult_fell})"
    );
    assert!(best >= 0.985, "{best}");
    assert!(adult >= 0.94, "{adult}");
}

#[test]
fn other_legs_walk_at_the_same_froude_number() {
    for share in [0.7, 1.3] {
        let body = legs(share);
        for reference in [0.4, 0.8, 1.2, 1.6] {
            let params = Params::new(&body, &Style::default());
            let speed = reference * params.size / params.tempo;
            let trace = run(&body, &walk(speed, 0.0, 8.0), Style::default(), 13.0);
            let error = mean_speed(&trace, 4.0, 8.0, DVec2::Y) / speed - 1.0;
            eprintln!("legs x {share}, {speed:.2} m/s (Froude-equal to {reference}): {:+.1} %", 100.0 * error);
            assert!(error.abs() <= 0.05, "{share} {reference}: {error}");
            assert_stands(&body, &trace, &format!("{share} {reference}"));
        }
    }
}

#[test]
fn turns_on_the_spot_and_stands_again() {
    for degrees in [30.0_f64, 90.0, 180.0, -90.0, -135.0] {
        let turn = vec![Turn { start: 0.5, duration: None, facing: degrees.to_radians() }];
        let trace = run(&adult(), &Script { turn, ..Script::standing(&[]) }, Style::default(), 5.0);
        let end = trace.ticks[trace.ticks.len() - 1];
        let took =
            trace.ticks.iter().rposition(|t| (t.facing - end.facing).abs() > 0.05).map_or(0.0, |i| i as f64 * 0.01);
        let near = trace.ticks.iter().map(|t| ground(t.feet[0].ankle - t.feet[1].ankle).length());
        let near = near.fold(f64::INFINITY, f64::min);
        let away = (ground(end.com) - ground(trace.ticks[0].com)).length();
        eprintln!(
            "{degrees} deg: faces there after {:.1} s, {} steps, {away:.2} m away, ankles at least {near:.3} m apart",
            took - 0.5,
            trace.steps.len()
        );
        assert!((end.facing - degrees.to_radians()).sin().abs() < 1e-6, "{degrees}: {}", end.facing);
        assert!(near > 0.085 && away < 0.25 && took < 5.0, "{degrees}: {near} {away} {took}");
        assert_stands(&adult(), &trace, &format!("{degrees}"));
    }
}

#[test]
fn walks_a_curve_where_the_heading_turns() {
    let entry = Walk { start: GO, duration: None, speed: 1.2, heading: 0.0, facing: None };
    let mut script = Script { walk: vec![entry], ..Script::standing(&[]) };
    script.walk.push(Walk { start: 4.0, heading: 1.6, ..entry });
    let trace = run(&adult(), &script, Style::default(), 9.0);
    let mean = mean_speed(&trace, 6.5, 9.0, forward(1.6));
    let slowest = trace.ticks[400..].iter().map(|tick| ground(tick.velocity).length()).fold(f64::INFINITY, f64::min);
    eprintln!("a turn by 92 deg at 1.2 m/s: then {mean:.3} m/s that way, never under {slowest:.2} m/s");
    assert!(trace.lost.is_none() && (mean / 1.2 - 1.0).abs() < 0.05 && slowest > 0.7, "{mean} {slowest}");
    assert!(trace.steps.iter().all(|step| step.kind == StepKind::Walk));
}

#[test]
fn a_push_of_its_own_direction_turns_with_the_character() {
    let turn = vec![Turn { start: 0.2, duration: None, facing: std::f64::consts::FRAC_PI_2 }];
    let push = SessionPush { start: 4.0, duration: 0.2, force: force(0.0, 200.0), turns: true, arm: 0.0 };
    let script = Script { turn, pushes: vec![push], ..Script::standing(&[]) };
    let trace = run(&adult(), &script, Style::default(), 6.0);
    let acted = trace.pushes[0].force;
    assert!((acted - force(90.0, 200.0)).length() < 1.0 && !trace.pushes[0].turns, "{acted}");
    assert!((trace.ticks[405].push - acted).length() < 1e-9);
}
