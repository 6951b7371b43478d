//! Meshes walked by the articulated body, by its own torques: kerbs, ramps, walls and ledges, drawn by seed.

#![expect(clippy::print_stdout, reason = "numbers")]

use crate::mesh_ground::{FLOOR, boxes, says_it_stops, scenario, surface};
use crate::people::people;
use glam::DVec3;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::model::props::Mesh;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::Scenario;
use surefoot::ragdoll::control::Assist;
use surefoot::rig::Rig;

fn baked(rig: &Rig, scenario: &Scenario, drive: Drive) -> Baked {
    let options = BakeOptions { drive, ..BakeOptions::default() };
    bake(rig, scenario, &options).unwrap_or_else(|error| panic!("{}: {error}", scenario.title))
}

/// Bodies that walk by their own torques on meshes, and the size of their legs.
fn bodies() -> Vec<(Rig, f64)> {
    people(&[1.0, 1.3], &["m2m_human_male.glb", "gdquest_mannequiny.glb"])
}

#[test]
fn the_body_walks_over_kerbs_and_ramps_of_meshes_by_its_torques() {
    let people = bodies();
    let clips: Vec<(String, f64, Baked)> = (0..20_u64)
        .into_par_iter()
        .map(|seed| {
            let mut draw = Seed::new(seed ^ 0x3E5);
            let (rig, legs) = &people[seed as usize % people.len()];
            let (sign, from) = ([1.0, -1.0][(seed / 4) as usize % 2], draw.between(0.9, 2.0));
            let (name, rise, mesh) = if seed % 3 == 0 {
                let (degrees, to) = (draw.between(3.0, 9.9), from + draw.between(1.0, 2.5));
                let rise = sign * degrees.to_radians().tan() * (to - from);
                let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
                let mut mesh = Mesh::default();
                for [(near, low), (far, high)] in
                    [[(-6.0, 0.0), (from, 0.0)], [(from, 0.0), (to, rise)], [(to, rise), (14.0, rise)]]
                {
                    mesh.quad([at(-6.0, low, near), at(-6.0, high, far), at(6.0, high, far), at(6.0, low, near)]);
                }
                (format!("ramp of {:.1} degrees", sign * degrees), rise, mesh)
            } else {
                let rise = sign * draw.between(0.03, 0.079);
                let mesh = boxes(&[([-6.0, -0.5, -6.0], [6.0, 0.0, from]), ([-6.0, -0.5, from], [6.0, rise, 14.0])]);
                (format!("kerb of {rise:.3} m"), rise, mesh)
            };
            let pace = draw.between(0.301, 0.399) * f64::sqrt(*legs);
            let rest =
                format!("duration = 14.0\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {pace:.3}\n");
            let name = format!("{seed} {name} at {pace:.2} legs {legs}");
            let scenario = scenario(&name, &rest, &surface(&mesh));
            (name, rise, baked(rig, &scenario, Drive::Ragdoll(Helped::Within(Assist::default()))))
        })
        .collect();
    let (mut mean, mut over) = (0.0, 0);
    for (name, rise, clip) in &clips {
        let report = &clip.report;
        let com = &clip.performance.timeline.com;
        let (far, up) = (com[com.len() - 1].z - com[0].z, com[com.len() - 1].y - com[0].y - rise);
        let score = &report.plausibility;
        mean += score.score / clips.len() as f64;
        println!(
            "{name}: {:?}, {far:.2} m, height {:+.3} m, score {:.2}, {:.1} mm in the ground",
            report.outcome, up, score.score, score.penetration_max_mm
        );
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        over += usize::from(far > 2.8 && up.abs() < 0.06);
        assert!(score.penetration_max_mm <= 6.0, "{name}: {:.1} mm in the ground", score.penetration_max_mm);
        assert!(score.joint_excess_share <= 0.01 && score.hover_longest_s <= 0.05, "{name}");
    }
    println!("mean score {mean:.3}, {over} of {} get over it", clips.len());
    assert_eq!(over, clips.len(), "all get over it");
    assert!(mean >= 0.85, "{mean:.3}");
}

#[test]
fn the_body_stops_before_walls_and_ledges_of_meshes_by_its_torques() {
    let people = bodies();
    let wrongs: Vec<String> = (0..12_u64)
        .into_par_iter()
        .flat_map(|seed| {
            let mut draw = Seed::new(seed ^ 0x57A11);
            let (rig, legs) = &people[seed as usize % people.len()];
            let (end, speed) = (draw.between(1.8, 3.5), draw.between(0.4, 1.0));
            let wall = boxes(&[FLOOR, ([-6.0, -0.3, end], [6.0, 3.0, end + 0.3])]);
            let ledge = boxes(&[([-6.0, -0.5, -6.0], [6.0, 0.0, end])]);
            let (name, mesh) = if seed % 2 == 0 { ("wall", wall) } else { ("ledge", ledge) };
            let rest = format!(
                "duration = 12.0\n[character]\nleg_scale = {legs}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n"
            );
            let name = format!("{seed} {name} at {end:.2} m, {speed:.2} m per s");
            let clip =
                baked(rig, &scenario(&name, &rest, &surface(&mesh)), Drive::Ragdoll(Helped::Within(Assist::default())));
            let far = clip.performance.timeline.com.iter().map(|com| com.z).fold(0.0, f64::max);
            let score = clip.report.plausibility.score;
            println!("{name}: {:?}, comes to {far:.2} m, score {score:.2}", clip.report.outcome);
            let told =
                says_it_stops(&clip) && clip.report.plausibility.notes.iter().all(|note| !note.contains("walks at"));
            let stops =
                told && clip.report.outcome != Outcome::Fall && (0.5..end - 0.1).contains(&far) && score >= 0.85;
            (!stops).then(|| format!("{name}: {:?} at {far:.2} m, score {score:.2}", clip.report.outcome))
        })
        .collect();
    assert!(wrongs.is_empty(), "{}", wrongs.join("\n"));
}
