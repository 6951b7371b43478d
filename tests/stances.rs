//! Standing on one foot and going low, under pushes.

use glam::DVec3;
use surefoot::model::Side;
use surefoot::model::scenario::{Crouch, Feet, Stand, Walk};
use surefoot::sim::{Script, SessionPush, SimulateOptions, Trace, simulate};
use surefoot::stepper::support::forward;
use surefoot::stepper::{Params, Physique, StepKind, Style, ground};

fn run(script: &Script, duration: f64) -> Trace {
    simulate(&Physique::REFERENCE, script, &SimulateOptions { duration, ..SimulateOptions::default() })
}

fn push(start: f64, degrees: f64, newtons: f64) -> SessionPush {
    let way = forward(degrees.to_radians());
    SessionPush { start, duration: 0.2, force: DVec3::new(way.x, 0.0, way.y) * newtons, turns: false, arm: 0.0 }
}

fn on(start: f64, on: Feet) -> Stand {
    Stand { start, duration: None, on }
}

#[test]
fn stands_on_either_foot_for_twenty_seconds_under_pushes_from_all_sides() {
    for (feet, side) in [(Feet::Left, Side::Left), (Feet::Right, Side::Right)] {
        let pushes: Vec<_> = (0..8).map(|i| push(3.0 + 2.5 * f64::from(i), 45.0 * f64::from(i), 20.0)).collect();
        let script = Script { stand: vec![on(0.5, feet), on(24.0, Feet::Both)], ..Script::standing(&pushes) };
        let trace = run(&script, 27.0);
        let lifted = trace.ticks.iter().position(|tick| !tick.planted[side.other() as usize]).expect("it lifts a foot");
        let lifted = lifted as f64 * trace.dt;
        let alone = &trace.ticks[(lifted / trace.dt) as usize..2400];
        let sway = alone.iter().map(|tick| (ground(tick.com) - ground(alone[200].com)).length()).fold(0.0, f64::max);
        eprintln!("{side:?}: the other foot lifts at {lifted:.2} s, sways up to {:.1} cm", 100.0 * sway);
        assert!(lifted < 2.5 && alone.iter().all(|tick| !tick.planted[side.other() as usize]));
        assert_eq!(trace.steps.len(), 1, "{:?}", trace.steps);
        assert_eq!((trace.steps[0].side, trace.steps[0].kind), (side.other(), StepKind::Held));
        assert!(trace.lost.is_none() && trace.rest > 0.5 && sway < 0.06);
    }
}

#[test]
fn shifts_from_foot_to_foot_and_back_on_both() {
    let lane = vec![on(0.5, Feet::Left), on(4.0, Feet::Right), on(8.0, Feet::Left), on(12.0, Feet::Both)];
    let trace = run(&Script { stand: lane, ..Script::standing(&[]) }, 15.0);
    let sides: Vec<Side> = trace.steps.iter().map(|step| step.side).collect();
    assert_eq!(sides, [Side::Right, Side::Left, Side::Right]);
    for (time, planted) in [(3.5, [true, false]), (7.5, [false, true]), (11.5, [true, false]), (14.5, [true, true])] {
        assert_eq!(trace.ticks[(time / trace.dt) as usize].planted, planted, "{time}");
    }
    assert!(trace.rest > 0.5);
}

#[test]
fn a_push_too_hard_for_one_foot_is_caught_with_the_other_which_is_lifted_again() {
    for eighth in 0..8 {
        let degrees = 45.0 * f64::from(eighth);
        let script = Script { stand: vec![on(0.5, Feet::Left)], ..Script::standing(&[push(4.0, degrees, 200.0)]) };
        let trace = run(&script, 12.0);
        let end = trace.ticks[trace.ticks.len() - 1];
        eprintln!("{degrees} deg: {} steps", trace.steps.len());
        assert!(trace.lost.is_none() && !trace.steps.is_empty(), "{degrees}: {:?}", trace.lost);
        assert_eq!(end.planted, [true, false], "{degrees}");
    }
}

#[test]
fn goes_low_and_comes_up_without_losing_its_place() {
    let crouch =
        vec![Crouch { start: 0.5, duration: None, amount: 0.5 }, Crouch { start: 4.0, duration: None, amount: 0.0 }];
    let trace = run(&Script { crouch, ..Script::standing(&[]) }, 8.0);
    let body = Physique::REFERENCE;
    let low = trace.ticks[350].com.y;
    let wanted = body.com_height - 0.5 * body.leg_length;
    let fastest = trace.ticks.iter().map(|tick| tick.velocity.y.abs()).fold(0.0, f64::max);
    eprintln!("com {:.3} m, then {low:.3} m; at most {fastest:.2} m/s", trace.ticks[0].com.y);
    assert!((low - wanted).abs() < 0.01 && fastest < 1.5, "{low} {wanted} {fastest}");
    assert!((trace.ticks[790].com.y - body.com_height).abs() < 0.005 && trace.steps.is_empty() && trace.rest > 0.5);
}

#[test]
fn walks_crouched_at_froude_equal_speed_and_takes_pushes() {
    let body = Physique::REFERENCE;
    for amount in [0.2, 0.5] {
        let lower = amount * body.leg_length;
        let short = Physique {
            leg_length: body.leg_length - lower,
            com_height: body.com_height - lower,
            hip_height: body.hip_height - lower,
            ..body
        };
        let params = Params::new(&short, &Style::default());
        for reference in [0.8, 1.2] {
            let speed = reference * params.size / params.tempo;
            let walk = vec![Walk { start: 0.3, duration: None, speed, heading: 0.0, facing: None }];
            let script = Script { walk, crouched: amount, ..Script::standing(&[]) };
            let trace = run(&script, 10.0);
            let lands: Vec<f64> = trace.steps.iter().map(|step| step.land).filter(|&land| land > 4.0).collect();
            let last = (lands.len() - 1) / 2 * 2;
            let at = |time: f64| trace.ticks[(time / trace.dt).round() as usize].com.z;
            let mean = (at(lands[last]) - at(lands[0])) / (lands[last] - lands[0]);
            eprintln!("crouched {amount}: {speed:.2} m/s wanted, {mean:.3} walked");
            assert!(trace.lost.is_none() && (mean / speed - 1.0).abs() < 0.05, "{amount} {speed}: {mean}");
        }
        for eighth in 0..8 {
            let degrees = 45.0 * f64::from(eighth);
            let newtons = 200.0 * (1.0 - amount).sqrt();
            let script = Script { crouched: amount, ..Script::standing(&[push(0.5, degrees, newtons)]) };
            let trace = run(&script, 5.0);
            assert!(trace.lost.is_none() && trace.rest >= 0.5, "{amount} {degrees}: {:?}", trace.lost);
        }
    }
}
