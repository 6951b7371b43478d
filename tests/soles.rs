//! Soles in plan: never one over the other, never crossed, while the character turns, walks, and catches itself.
//!
//! A sole is a capsule, heel to tip and half a width around; what is measured is the clear ground between the two, at
//! every tick that both carry and in every swing beside the foot that stands.

use crate::limits_grid::rigs;
use glam::{DVec2, DVec3};
use surefoot::model::scenario::{Turn, Walk};
use surefoot::model::{Body, Physique, Plant};
use surefoot::sim::{Script, SessionPush, SimulateOptions, TickState, Trace, simulate};
use surefoot::stepper::ground;
use surefoot::stepper::support::{forward, left};
use surefoot::whole_body::{Anatomy, stand};

/// The builds that turn, and the built-in one's legs.
const RIGS: [&str; 3] = ["builtin", "gdquest_mannequiny", "kaykit_Knight"];
const LEGS: [f64; 2] = [0.7, 1.3];

/// The bodies to hold this on: name and measures.
fn bodies() -> Vec<(String, Physique)> {
    let measures = |body: &Body| stand::physique(body, &Anatomy::new(body));
    let mut list = Vec::new();
    for (name, rig) in rigs().into_iter().filter(|(name, _)| RIGS.contains(&name.as_str())) {
        let scales: &[f64] = if name == "builtin" { &[1.0, LEGS[0], LEGS[1]] } else { &[1.0] };
        list.extend(scales.iter().map(|&scale| {
            let rig = rig.with_leg_scale(scale);
            (format!("{name} x{scale}"), measures(&rig.body))
        }));
    }
    list
}

/// m of clear ground between the two soles; negative where they overlap.
fn clear(body: &Physique, feet: &[Plant; 2]) -> f64 {
    let line = |foot: &Plant| {
        let round = body.half_width.min(0.5 * (body.tip - body.heel));
        [body.heel + round, body.tip - round].map(|along| ground(foot.ankle) + forward(foot.yaw) * along)
    };
    let [one, two] = [line(&feet[0]), line(&feet[1])];
    apart(one, two) - 2.0 * body.half_width
}

/// m between two straight pieces.
fn apart(one: [DVec2; 2], two: [DVec2; 2]) -> f64 {
    let side = |line: [DVec2; 2], point: DVec2| (line[1] - line[0]).perp_dot(point - line[0]);
    let parted = |line: [DVec2; 2], other: [DVec2; 2]| side(line, other[0]) * side(line, other[1]) < 0.0;
    if parted(one, two) && parted(two, one) {
        return 0.0;
    }
    let near = |line: [DVec2; 2], point: DVec2| {
        let way = line[1] - line[0];
        let share = ((point - line[0]).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
        point.distance(line[0] + way * share)
    };
    near(one, two[0]).min(near(one, two[1])).min(near(two, one[0])).min(near(two, one[1]))
}

/// rad, between the ways that the feet point, toes out positive, beyond the natural stand's.
fn splay(body: &Physique, feet: &[Plant; 2]) -> f64 {
    wrap(feet[0].yaw - feet[1].yaw) - 2.0 * body.toe_out
}

fn wrap(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}

/// m, how far the left ankle is to the left of the right one, as the feet point; negative where they are crossed.
fn uncrossed(feet: &[Plant; 2]) -> f64 {
    let way = feet[1].yaw + 0.5 * wrap(feet[0].yaw - feet[1].yaw);
    ground(feet[0].ankle - feet[1].ankle).dot(left(way))
}

/// The least of a measure over ticks, and when.
fn least(trace: &Trace, of: impl Fn(&TickState) -> Option<f64>) -> (f64, f64) {
    let all = trace.ticks.iter().enumerate().filter_map(|(at, tick)| Some((of(tick)?, at as f64 * trace.dt)));
    all.fold((f64::INFINITY, 0.0), |best, next| if next.0 < best.0 { next } else { best })
}

#[test]
fn soles_stay_apart_and_uncrossed_in_turns_on_the_spot() {
    let mut failed = Vec::new();
    for (name, body) in bodies() {
        for degrees in [45.0_f64, 90.0, 135.0, 180.0, -180.0] {
            let turn = vec![Turn { start: 0.5, duration: None, facing: degrees.to_radians() }];
            let script = Script { turn, ..Script::standing(&[]) };
            let trace = simulate(&body, &script, &SimulateOptions { duration: 5.0, ..SimulateOptions::default() });
            let stood = clear(&body, &trace.ticks[0].feet);
            let down = least(&trace, |tick| (tick.planted == [true; 2]).then(|| clear(&body, &tick.feet)));
            let swinging = least(&trace, |tick| (tick.planted != [true; 2]).then(|| clear(&body, &tick.feet)));
            let crossed = least(&trace, |tick| Some(uncrossed(&tick.feet)));
            let inward = least(&trace, |tick| Some(splay(&body, &tick.feet))).0;
            let outward = -least(&trace, |tick| Some(-splay(&body, &tick.feet))).0;
            let end = trace.ticks[trace.ticks.len() - 1];
            let middle = |tick: &TickState| 0.5 * ground(tick.feet[0].ankle + tick.feet[1].ankle);
            let away = middle(&end).distance(middle(&trace.ticks[0])) / body.stance_width;
            let rests = trace.ticks.len() as f64 * trace.dt - trace.rest;
            eprintln!(
                "{name} {degrees} deg: {} steps, rests from {rests:.1} s, {away:.2} stances away; soles {:.1} cm apart \
                 at rest, least {:.1} cm down at {:.2} s, {:.1} cm in a swing at {:.2} s; \
                 ankles {:.1} cm uncrossed; toes in {:.0} deg, out {:.0} deg",
                trace.steps.len(),
                100.0 * stood,
                100.0 * down.0,
                down.1,
                100.0 * swinging.0,
                swinging.1,
                100.0 * crossed.0,
                -inward.to_degrees(),
                outward.to_degrees(),
            );
            if std::env::var_os("STEPS").is_some() {
                for step in &trace.steps {
                    let at = trace.ticks[(step.land / trace.dt).round() as usize];
                    eprintln!(
                        "    {:?} {:?} {:.2}..{:.2} to {:.3} {:.3} yaw {:.0}; clear {:.1} cm, facing {:.0}",
                        step.side,
                        step.kind,
                        step.lift,
                        step.land,
                        step.to.ankle.x,
                        step.to.ankle.z,
                        step.to.yaw.to_degrees(),
                        100.0 * clear(&body, &at.feet),
                        at.facing.to_degrees(),
                    );
                }
            }
            let room = 0.01_f64.min(0.5 * stood);
            let mut hold = |what: &str, holds: bool| {
                if !holds {
                    failed.push(format!("{name} {degrees}: {what}"));
                }
            };
            hold("soles apart", down.0 >= room && swinging.0 >= room);
            hold("uncrossed", crossed.0 > body.half_width);
            hold("toes", inward > -0.6 && outward < 1.1);
            hold("on the spot", away < 0.65);
            hold("rests", trace.lost.is_none() && trace.rest >= 0.5);
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Shoved for 0.2 s towards `degrees` with so many Ns of the reference body.
fn shove(body: &Physique, start: f64, degrees: f64, impulse: f64) -> SessionPush {
    let scale = body.mass / 89.5 * (body.leg_length / 0.83).sqrt();
    let way = forward(degrees.to_radians()) * (impulse * scale / 0.2);
    SessionPush { start, duration: 0.2, force: DVec3::new(way.x, 0.0, way.y), turns: false, arm: 0.0 }
}

#[test]
fn soles_stay_apart_in_recoveries_and_come_to_stand_side_by_side() {
    let (mut failed, mut fallen) = (Vec::new(), 0);
    for (name, body) in bodies() {
        let size = body.leg_length / 0.83;
        for (what, speed, heading) in
            [("standing", 0.0, 0.0), ("walking", 1.2, 0.0), ("sideways", 0.4, 90.0), ("backward", 0.6, 180.0_f64)]
        {
            let mut worst = [(f64::INFINITY, String::new()), (f64::INFINITY, String::new())];
            let mut clips = 0;
            let mut overlapping = 0;
            for eighth in 0..8 {
                for impulse in [0.0, 20.0, 40.0, 60.0, 80.0, 100.0] {
                    let degrees = 45.0 * f64::from(eighth);
                    let entry = Walk {
                        start: 0.3,
                        duration: None,
                        speed: speed * size.sqrt(),
                        heading: heading.to_radians(),
                        facing: Some(0.0),
                    };
                    let walk = if speed > 0.0 { vec![entry, Walk { start: 4.5, speed: 0.0, ..entry }] } else { vec![] };
                    let push = shove(&body, if speed > 0.0 { 2.5 } else { 0.6 }, degrees, impulse);
                    let script = Script { walk, ..Script::standing(&[push]) };
                    let options = SimulateOptions { duration: 9.0, ..SimulateOptions::default() };
                    let trace = simulate(&body, &script, &options);
                    if trace.lost.is_some() {
                        fallen += 1;
                        continue;
                    }
                    clips += 1;
                    let down = least(&trace, |tick| (tick.planted == [true; 2]).then(|| clear(&body, &tick.feet)));
                    let swing = least(&trace, |tick| (tick.planted != [true; 2]).then(|| clear(&body, &tick.feet)));
                    overlapping += u32::from(down.0 < 0.0);
                    for (worst, (found, at)) in worst.iter_mut().zip([down, swing]) {
                        if found < worst.0 {
                            *worst = (found, format!("{degrees} deg {impulse} Ns at {at:.2} s"));
                        }
                    }
                    let end = trace.ticks[trace.ticks.len() - 1];
                    let (stood, stands) = (clear(&body, &trace.ticks[0].feet), clear(&body, &end.feet));
                    let staggered = ground(end.feet[0].ankle - end.feet[1].ankle).dot(forward(end.facing)).abs() / size;
                    let twisted = splay(&body, &end.feet).abs();
                    if stands < 0.01_f64.min(0.5 * stood)
                        || uncrossed(&end.feet) < body.half_width
                        || staggered > 0.051
                        || twisted > 0.25
                        || trace.rest < 0.5
                    {
                        failed.push(format!(
                            "{name} {what} {degrees} {impulse}: ends {stands:.3} clear, {staggered:.3} staggered, {twisted:.2} twisted"
                        ));
                    }
                    if down.0 < (0.01 * size).min(0.2 * stood) {
                        failed
                            .push(format!("{name} {what} {degrees} {impulse}: {:.3} clear at {:.2} s", down.0, down.1));
                    }
                }
            }
            let [down, swing] = worst;
            eprintln!(
                "{name} {what}: {clips} clips, {overlapping} overlap; least {:.1} cm down ({}), {:.1} cm in a swing ({})",
                100.0 * down.0,
                down.1,
                100.0 * swing.0,
                swing.1
            );
        }
    }
    assert!(failed.is_empty(), "{} of them: {failed:#?}", failed.len());
    // Goal 0: pushes of 60 to 100 Ns against the way of the gait.
    assert!(fallen <= 16, "{fallen} of 960 fall");
}
