//! Kerbs and flights of meshes, drawn by seed, walked by the stepper at every pace and climbed by the body.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::mesh_ground::{FLOOR, boxes, says_it_stops, scenario, surface};
use crate::people::people;
use glam::DVec3;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::props::Mesh;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::GroundKind;
use surefoot::ragdoll::control::Assist;

/// Of 1: the scores of each clip, and of all.
const LEAST: f64 = 0.8;
const MEAN: f64 = 0.93;
/// mm: a sole in the ground.
const DEEP: f64 = 6.0;

/// Steps of that rise (m, less than 0 down) and depth, one behind another from there on.
fn steps(count: u32, rise: f64, tread: f64, from: f64) -> Mesh {
    let floor = if rise > 0.0 { FLOOR } else { ([-6.0, -3.0, -6.0], [6.0, 0.0, from]) };
    let step = |number: u32| {
        let near = from + tread * f64::from(number);
        let far = if rise > 0.0 || number + 1 == count { 14.0 } else { near + tread };
        ([-6.0, -3.0, near], [6.0, rise * f64::from(number + 1), far])
    };
    boxes(&std::iter::once(floor).chain((0..count).map(step)).collect::<Vec<_>>())
}

#[test]
fn walks_of_every_pace_over_kerbs_and_flights_of_meshes_keep_their_feet() {
    let people = people(&[1.0, 0.7, 1.3], &["m2m_human_male.glb", "godette_vrm0.vrm"]);
    let clips: Vec<(String, Baked)> = (0..20_u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x3E5D);
            let (rig, legs) = &people[seed as usize % people.len()];
            let count = [1, 4][(seed / 10) as usize];
            let size = legs * rig.body.leg_length / 0.83;
            let rise = [1.0, -1.0][(seed / 5) as usize % 2] * size.min(1.0) * draw.between(0.06, 0.15);
            let (tread, from) = (draw.between(0.28, 0.35), draw.between(1.0, 2.0));
            let speed = draw.between(0.3, 0.9) * size.sqrt();
            let rest = format!(
                "duration = 10.0\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n"
            );
            let name = format!("{seed}: {count} of {rise:.3} by {tread:.2} m at {speed:.2} m per s, legs {legs}");
            let scenario = scenario(&name, &rest, &surface(&steps(count, rise, tread, from)));
            let options = BakeOptions { drive: Drive::Stepper, ..BakeOptions::default() };
            (name, bake(rig, &scenario, &options).expect("it bakes"))
        })
        .collect();
    let mut mean = 0.0;
    for (name, clip) in &clips {
        let score = &clip.report.plausibility;
        println!("{name}: {:?}, {:.2}, {:?}", clip.report.outcome, score.score, score.notes);
        mean += score.score / clips.len() as f64;
    }
    println!("mean score {mean:.3}");
    for (name, clip) in &clips {
        let score = &clip.report.plausibility;
        assert_ne!(clip.report.outcome, Outcome::Fall, "{name}");
        assert!(!says_it_stops(clip), "{name}: {:?}", clip.warnings);
        assert!(score.score >= LEAST, "{name}: {:.2}", score.score);
        assert!(score.penetration_max_mm < DEEP, "{name}: {:.1} mm in the ground", score.penetration_max_mm);
    }
    assert!(mean >= MEAN, "{mean:.3}");
}

/// m/s that the body comes on at least, in the mean, from its first step to where it is at the end: a tread of 0.28 m each 2.3 s.
const COMES_ON: f64 = 0.1;
/// m.
const LOWER: f64 = 0.05;

/// Up the whole flight is climbed in 15 s, down half of it.
#[test]
fn the_body_climbs_flights_and_kerbs_of_meshes_by_its_torques() {
    let people = people(&[1.0, 0.7, 1.3], &["m2m_rig_human.glb", "gdquest_mannequiny.glb"]);
    let clips: Vec<(String, u32, f64, Baked)> = (0..24_u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0xC11B);
            let (rig, legs) = &people[seed as usize % people.len()];
            let count = [4, 1, 6][(seed / 8) as usize];
            let size = (legs * rig.body.leg_length / 0.83).min(1.0);
            let up = seed % 8 < 5;
            let rise = if up { 1.0 } else { -1.0 } * size * draw.between(0.1, 0.18);
            let (tread, from) = (draw.between(0.28, 0.34), draw.between(1.2, 2.0));
            let speed = draw.between(0.3, 0.7) * size.sqrt();
            let rest = format!(
                "duration = 16.0\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n"
            );
            let name = format!("{seed}: {count} of {rise:.3} by {tread:.2} m at {speed:.2} m per s, legs {legs}");
            let scenario = scenario(&name, &rest, &surface(&steps(count, rise, tread, from)));
            let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
            let options = BakeOptions { drive, ..BakeOptions::default() };
            (name, count, rise, bake(rig, &scenario, &options).expect("it bakes"))
        })
        .collect();
    let mut mean = [0.0; 2];
    let mut wrongs = Vec::new();
    for (name, count, rise, clip) in &clips {
        let (score, com) = (&clip.report.plausibility, &clip.performance.timeline.com);
        let way = com[com.len() - 1] - com[0];
        println!(
            "{name}: {:?}, {:.2} m on, {:.2} m up, {:.2}, {:?}",
            clip.report.outcome, way.z, way.y, score.score, score.notes
        );
        let (climbed, share) = (rise.abs() * f64::from(*count), if *rise > 0.0 { 1.0 } else { 0.5 });
        let alike = clips.iter().filter(|other| (other.2 > 0.0) == (*rise > 0.0)).count();
        mean[usize::from(*rise < 0.0)] += score.score / alike as f64;
        // A walk's centre of mass is a little lower than the stand's at its beginning.
        let climbs = way.y * rise.signum() > share * climbed - LOWER && way.z > COMES_ON * 15.5;
        if clip.report.outcome == Outcome::Fall || !climbs || says_it_stops(clip) {
            wrongs.push(name);
        }
    }
    println!("mean score {:.3} up, {:.3} down", mean[0], mean[1]);
    assert!(wrongs.is_empty(), "{wrongs:?}");
    assert!(mean[0] >= 0.9 && mean[1] >= 0.7, "{mean:?}, goal 0.9 both ways");
}

/// A plane that rises by so many degrees along z, past the height of the usual ceiling.
fn plane(degrees: f64) -> Mesh {
    let at = |x: f64, z: f64| DVec3::new(x, z * degrees.to_radians().tan(), z);
    let mut mesh = Mesh::default();
    mesh.quad([at(-6.0, -4.0), at(-6.0, 18.0), at(6.0, 18.0), at(6.0, -4.0)]);
    mesh
}

/// Of the speed that is asked for, and of 1: what a walk on a slope of a mesh comes to at least, and how much less than on the same slope by name
/// its score may be in the mean.
const ON: f64 = 0.85;
const LESS: f64 = 0.05;

#[test]
fn a_slope_of_a_mesh_is_walked_by_torques_as_the_same_slope_by_name() {
    let people = people(&[1.0, 0.7, 1.3], &["m2m_rig_human.glb", "gdquest_mannequiny.glb"]);
    let clips: Vec<(String, f64, [Baked; 2])> = (0..10_u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x510E);
            let (rig, legs) = &people[seed as usize % people.len()];
            let degrees = [1.0, -1.0][(seed / 5) as usize] * draw.between(12.0, 22.0);
            let speed = draw.between(0.45, 0.7) * (legs * rig.body.leg_length / 0.83).sqrt();
            let rest = format!(
                "duration = 12.0\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n"
            );
            let name = format!("{seed}: {degrees:.1} degrees at {speed:.2} m per s, legs {legs}");
            let drive = Drive::Ragdoll(Helped::Within(Assist::default()));
            let options = BakeOptions { drive, ..BakeOptions::default() };
            let mesh = scenario(&name, &rest, &surface(&plane(degrees)));
            let mut named = mesh.clone();
            named.ground.kind = GroundKind::Slope { angle: degrees.to_radians() };
            (name, speed, [mesh, named].map(|scenario| bake(rig, &scenario, &options).expect("it bakes")))
        })
        .collect();
    let mut mean = [0.0; 2];
    for (name, speed, both) in &clips {
        let score = both.each_ref().map(|clip| clip.report.plausibility.score);
        let com = &both[0].performance.timeline.com;
        let share = (com[com.len() - 1].z - com[0].z) / (11.5 * speed);
        println!("{name}: {:?}, {share:.2} of the way, {score:.2?}", both[0].report.outcome);
        mean = [0, 1].map(|at| mean[at] + score[at] / clips.len() as f64);
        assert_ne!(both[0].report.outcome, Outcome::Fall, "{name}");
        assert!(share > ON && !says_it_stops(&both[0]), "{name}: {share:.2} of the way, {:?}", both[0].warnings);
    }
    println!("mean score {:.3}, by name {:.3}", mean[0], mean[1]);
    assert!(mean[0] > mean[1] - LESS, "{mean:?}");
}
