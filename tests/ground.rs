//! The controller on ground that is not flat: slopes, stairs, gaps, rolling ground, a platform that turns.
//!
//! The reference body. Each run is seeded: its speed, its start and small pushes differ. Shares are printed.

use glam::{DVec2, DVec3};
use surefoot::maths::seed::Seed;
use surefoot::model::scenario::{Ground, GroundKind, Walk};
use surefoot::model::{Side, Terrain};
use surefoot::sim::{Script, SessionPush, SimulateOptions, Trace, simulate};
use surefoot::stepper::{Physique, Style};

fn terrain(kind: GroundKind) -> Terrain {
    Terrain::new(&Ground { kind, ..Ground::default() })
}

fn options(duration: f64, agility: f64) -> SimulateOptions {
    SimulateOptions { duration, extra: 0.0, style: Style { agility, ..Style::default() }, ..SimulateOptions::default() }
}

fn shove(start: f64, heading: f64, force: f64) -> SessionPush {
    let force = DVec3::new(heading.sin(), 0.0, heading.cos()) * force;
    SessionPush { start, duration: 0.2, force, turns: false, arm: 0.0 }
}

/// 20 s of walking over it; the seed draws the speed, the start and three small pushes.
fn walked(kind: &GroundKind, heading: f64, seed: u64) -> (Trace, f64) {
    let mut draw = Seed::new(seed);
    let speed = draw.between(0.7, 1.2);
    let start = draw.between(0.2, 0.8);
    let walk = Walk { start, duration: None, speed, heading, facing: None };
    let pushes = (0..3).map(|index| {
        let at = 4.0 + 5.0 * f64::from(index) + draw.between(0.0, 1.0);
        shove(at, draw.between(0.0, std::f64::consts::TAU), draw.between(20.0, 60.0))
    });
    let pushes: Vec<SessionPush> = pushes.collect();
    let script = Script { terrain: terrain(kind.clone()), walk: vec![walk], ..Script::standing(&pushes) };
    (simulate(&Physique::REFERENCE, &script, &options(20.0, 0.5)), speed)
}

/// Mean speed along the heading over the last whole seconds, over the commanded one.
fn held_speed(trace: &Trace, heading: f64, speed: f64) -> f64 {
    let way = DVec2::new(heading.sin(), heading.cos());
    let at = |index: usize| DVec2::new(trace.ticks[index].com.x, trace.ticks[index].com.z).dot(way);
    let last = trace.ticks.len() - 1;
    (at(last) - at(last - 400)) / (4.0 * speed)
}

/// (walked through, mean speed over the commanded one) of 20 seeds.
fn twenty(name: &str, kind: &GroundKind, heading: f64) -> (usize, f64) {
    let mut through = 0;
    let mut speeds = Vec::new();
    for seed in 0..20 {
        let (trace, speed) = walked(kind, heading, seed);
        match trace.lost {
            None => {
                through += 1;
                speeds.push(held_speed(&trace, heading, speed));
            }
            Some(time) => eprintln!("{name}: seed {seed} fell at {time:.1} s"),
        }
    }
    let mean = speeds.iter().sum::<f64>() / speeds.len().max(1) as f64;
    eprintln!("{name}: {through} of 20 walk for 20 s, speed {mean:.3} of the commanded");
    (through, mean)
}

#[test]
fn walks_up_down_and_across_a_slope_of_25_degrees() {
    for (name, degrees, heading) in [
        ("25 degrees up", 25.0, 0.0),
        ("25 degrees down", -25.0, 0.0),
        ("25 degrees across", 25.0, std::f64::consts::FRAC_PI_2),
    ] {
        let (through, speed) = twenty(name, &GroundKind::Slope { angle: f64::to_radians(degrees) }, heading);
        assert_eq!(through, 20, "{name}");
        assert!((speed - 1.0).abs() < 0.05, "{name}: {speed}");
    }
}

#[test]
fn climbs_and_descends_stairs_a_tread_a_step_with_whole_soles() {
    for (name, rise) in [("stairs up", 0.17), ("stairs down", -0.17)] {
        let kind = GroundKind::Stairs { rise, tread: 0.29, count: 30 };
        assert_eq!(twenty(name, &kind, 0.0).0, 20, "{name}");
        let ground = terrain(kind.clone());
        let (trace, _) = walked(&kind, 0.0, 3);
        let physique = Physique::REFERENCE;
        let mut hasty = 0;
        for step in trace.steps.iter().filter(|step| step.to.ankle.z > 1.3) {
            let toe = step.to.yaw.cos();
            for point in [physique.heel, physique.tip] {
                let height = ground.spot(DVec2::new(step.to.ankle.x, step.to.ankle.z + point * toe)).height;
                assert!((height - step.to.ankle.y).abs() < 1e-9, "{name}: a sole over an edge at {:?}", step.to);
            }
            let risen = (step.to.ankle.y - step.from.ankle.y).abs();
            hasty += usize::from(risen > 2.1 * 0.17);
        }
        assert!(hasty <= 2, "{name}: {hasty} steps past three treads; one after a push may be");
    }
}

#[test]
fn steps_over_gaps_and_never_into_them() {
    let kind = GroundKind::Gaps { width: 0.2, spacing: 1.2 };
    let (through, _) = twenty("gaps of 0.2 m", &kind, 0.0);
    assert_eq!(through, 20);
    let ground = terrain(kind.clone());
    for seed in 0..20 {
        for step in walked(&kind, 0.0, seed).0.steps {
            for point in [Physique::REFERENCE.heel, 0.0, Physique::REFERENCE.tip] {
                let at = DVec2::new(step.to.ankle.x, step.to.ankle.z + point * step.to.yaw.cos());
                assert!(ground.spot(at).holds, "seed {seed}: a sole over a gap at {at}");
            }
        }
    }
}

#[test]
fn walks_over_rolling_ground() {
    let kind = GroundKind::Uneven { height: 0.05, wavelength: 1.5, seed: 4 };
    assert_eq!(twenty("uneven 5 cm", &kind, 0.3).0, 20);
}

/// Gyrates about both axes between -45 and 45 degrees at 10 degrees a second.
fn gyrating() -> GroundKind {
    let points = |first: f64| {
        let mut points = vec![[0.0, 0.0]];
        let (mut time, mut angle, mut to) = (0.0, 0.0_f64, first);
        while time < 70.0 {
            time += (to - angle).abs() / 10.0;
            angle = to;
            points.push([time, angle.to_radians()]);
            to = -to;
        }
        points
    };
    // the second starts half a swing later, so that the two lean together and apart
    let mut roll = vec![[0.0, 0.0]];
    roll.extend(points(-45.0).into_iter().map(|[time, angle]| [time + 4.5, angle]));
    GroundKind::Platform { pitch: points(45.0), roll }
}

#[test]
fn stays_upright_on_a_gyrating_platform_under_pushes() {
    for agility in [1.0, 0.5] {
        let mut upright = 0;
        for seed in 0..10 {
            let mut draw = Seed::new(seed);
            let pushes: Vec<SessionPush> = (1..12)
                .map(|index| shove(5.0 * f64::from(index), draw.between(0.0, std::f64::consts::TAU), 100.0))
                .collect();
            let script = Script { terrain: terrain(gyrating()), ..Script::standing(&pushes) };
            let trace = simulate(&Physique::REFERENCE, &script, &options(60.0, agility));
            match trace.lost {
                None => upright += 1,
                Some(time) => eprintln!("platform, agility {agility}: seed {seed} fell at {time:.1} s"),
            }
        }
        eprintln!("platform to 45 degrees, agility {agility}: {upright} of 10 upright for 60 s");
        assert!(agility < 1.0 || upright == 10);
    }
}

#[test]
fn standing_still_on_any_ground_is_still() {
    let slope = |degrees: f64| GroundKind::Slope { angle: f64::to_radians(degrees) };
    let stairs = GroundKind::Stairs { rise: 0.17, tread: 0.29, count: 10 };
    let uneven = GroundKind::Uneven { height: 0.05, wavelength: 1.0, seed: 2 };
    for kind in [slope(25.0), slope(-25.0), stairs, uneven] {
        let script = Script { terrain: terrain(kind.clone()), ..Script::standing(&[]) };
        let trace = simulate(&Physique::REFERENCE, &script, &options(60.0, 0.5));
        let (first, last) = (&trace.ticks[0], trace.ticks.last().expect("ticks"));
        assert!(first.com == last.com && first.feet == last.feet && trace.steps.is_empty(), "{kind:?} moves");
        let on = terrain(kind.clone());
        for side in Side::BOTH {
            let foot = first.feet[side as usize].ankle;
            assert!((on.spot(DVec2::new(foot.x, foot.z)).height - foot.y).abs() < 1e-9, "{kind:?}: not on the ground");
        }
    }
}

#[test]
fn a_push_on_a_slope_is_caught_as_on_the_flat() {
    let mut caught = 0;
    let mut all = 0;
    for degrees in [25.0, -25.0] {
        for eighth in 0..8 {
            let pushes = vec![shove(0.3, f64::from(eighth) * std::f64::consts::FRAC_PI_4, 300.0)];
            let kind = GroundKind::Slope { angle: f64::to_radians(degrees) };
            let script = Script { terrain: terrain(kind), ..Script::standing(&pushes) };
            let trace = simulate(&Physique::REFERENCE, &script, &options(8.0, 0.5));
            caught += usize::from(trace.lost.is_none() && trace.rest > 0.5);
            all += 1;
        }
    }
    eprintln!("60 Ns on slopes of 25 degrees: {caught} of {all} at rest again");
    assert!(caught == all);
}
