//! Grounds of triangles: kerbs, ramps, steps, ledges and walls that the tests build as GLB files, walked and shoved over.
//!
//! Feet are looked at in the clip, at 120 Hz: no point of a sole over 5 mm in the ground, and of a foot that stands flat no more than a
//! twelfth over an edge (the goal is none; soles are asked about at 21 points).

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde_json::json;
use std::sync::Arc;
use surefoot::bake::{BakeOptions, Baked, Drive, Helped, bake};
use surefoot::maths::seed::Seed;
use surefoot::measure::ground::depth;
use surefoot::model::props::Mesh;
use surefoot::model::report::{Outcome, Part};
use surefoot::model::scenario::{Ground, GroundKind, Scenario};
use surefoot::model::{Side, Surface, scenario_text};
use surefoot::rig::{Rig, level};

/// Goals: no point of a sole deeper in the ground (m), no more of a flat foot over an edge.
const DEEP: f64 = 0.005;
const HANGS: f64 = 1.0 / 12.0;

/// A GLB of one mesh; each of its nodes' extra JSON may turn it.
pub fn glb(mesh: &Mesh, node: serde_json::Value) -> Vec<u8> {
    let mut binary = Vec::new();
    for point in &mesh.positions {
        binary.extend(point.to_array().iter().flat_map(|number| (*number as f32).to_le_bytes()));
    }
    let points = binary.len();
    binary.extend(mesh.indices.iter().flat_map(|index| index.to_le_bytes()));
    let mut node = node;
    node["mesh"] = json!(0);
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [node],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": mesh.positions.len(), "type": "VEC3" },
            { "bufferView": 1, "componentType": 5125, "count": mesh.indices.len(), "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": points },
            { "buffer": 0, "byteOffset": points, "byteLength": binary.len() - points }
        ],
        "buffers": [{ "byteLength": binary.len() }]
    });
    container(&document, &binary)
}

pub fn container(document: &serde_json::Value, binary: &[u8]) -> Vec<u8> {
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    let total = 12 + 8 + text.len() + 8 + binary.len();
    for word in [2, total as u32, text.len() as u32, 0x4E4F_534A] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(text);
    for word in [binary.len() as u32, 0x004E_4942] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(binary);
    bytes
}

pub fn read(bytes: &[u8]) -> Result<Surface, String> {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    level::level("level.glb", bytes, &alone).map_err(|error| error.to_string())
}

pub fn surface(mesh: &Mesh) -> Arc<Surface> {
    Arc::new(read(&glb(mesh, json!({}))).unwrap_or_else(|error| panic!("{error}")))
}

/// Boxes from their low to their high corners.
pub fn boxes(corners: &[([f64; 3], [f64; 3])]) -> Mesh {
    let mut mesh = Mesh::default();
    for (low, high) in corners {
        mesh.cuboid(DVec3::from_array(*low), DVec3::from_array(*high));
    }
    mesh
}

pub const FLOOR: ([f64; 3], [f64; 3]) = ([-6.0, -0.3, -6.0], [6.0, 0.0, 14.0]);

pub fn scenario(title: &str, rest: &str, mesh: &Arc<Surface>) -> Scenario {
    let text = format!("title = \"{title}\"\n{rest}\n[ground]\nkind = \"mesh\"\nfile = \"level.glb\"\n");
    let mut scenario = scenario_text::parse(title, &text).unwrap_or_else(|errors| panic!("{title}: {errors}"));
    scenario.ground.lay(mesh);
    scenario
}

fn baked(rig: &Rig, scenario: &Scenario, drive: Drive) -> Baked {
    let options = BakeOptions { drive, ..BakeOptions::default() };
    bake(rig, scenario, &options).unwrap_or_else(|error| panic!("{}: {error}", scenario.title))
}

/// The soles of the clip as the file has it.
struct Soles {
    /// m, the deepest point of a sole in the ground, and when (s).
    deepest: (f64, f64),
    /// 0..1, the largest share of a flat foot's sole over an edge, and when (s).
    hangs: (f64, f64),
    /// m, the highest that a point of a flat foot's sole is over the ground, where it is not over an edge.
    over: f64,
}

fn soles(rig: &Rig, baked: &Baked) -> Soles {
    let terrain = &baked.performance.timeline.terrain;
    let mut sampler = rig.sampler(&baked.clip);
    let mut found = Soles { deepest: (f64::NEG_INFINITY, 0.0), hangs: (0.0, 0.0), over: 0.0 };
    let duration = baked.report.duration;
    let until = baked.performance.lost.map_or(duration, |lost| lost.min(duration));
    for sample in 0..=(until * 120.0) as usize {
        let time = sample as f64 / 120.0;
        let pose = sampler.sample(time);
        for side in Side::BOTH {
            let foot = &rig.body.feet[side as usize];
            let ankle = rig.body.joints[foot.ankle].rest;
            let mut points: Vec<DVec3> = Vec::new();
            points.extend(foot.rear_sole.iter().map(|at| pose.positions[foot.ankle] + pose.turns[foot.ankle] * *at));
            points.extend(foot.front_sole.iter().map(|at| match foot.toe {
                Some(toe) => pose.positions[toe] + pose.turns[toe] * (*at - (rig.body.joints[toe].rest - ankle)),
                None => pose.positions[foot.ankle] + pose.turns[foot.ankle] * *at,
            }));
            let deepest = points.iter().map(|point| depth(terrain, time, *point)).fold(f64::NEG_INFINITY, f64::max);
            if deepest > found.deepest.0 {
                found.deepest = (deepest, time);
            }
            let flat = baked.performance.contacts.iter().any(|contact| {
                contact.side == side && contact.part == Part::Flat && contact.start <= time && time <= contact.end
            });
            if flat {
                let height = |point: &DVec3| {
                    let spot = terrain.spot(DVec2::new(point.x, point.z));
                    if spot.holds { (point.y - spot.height) * spot.normal.y } else { f64::INFINITY }
                };
                let off = points.iter().filter(|point| height(point) > 0.03).count();
                let share = off as f64 / points.len().max(1) as f64;
                if share > found.hangs.0 {
                    found.hangs = (share, time);
                }
                let over = points.iter().map(height).filter(|height| *height <= 0.03).fold(0.0, f64::max);
                found.over = found.over.max(over);
            }
        }
    }
    found
}

/// Bakes, prints what the soles do, and gives what is wrong.
fn wrong(rig: &Rig, scenario: &Scenario, drive: Drive) -> (Vec<String>, Baked) {
    let baked = baked(rig, scenario, drive);
    let soles = soles(rig, &baked);
    let report = &baked.report;
    let end = baked.performance.timeline.com.last().copied().unwrap_or_default();
    println!(
        "{:<28} {:?}, {} steps, {}: deepest {:.1} mm at {:.2} s, over an edge {:.0} % at {:.2} s, flat foot over {:.1} mm, slip {:.2} mm, \
         ankle {:.1} m/s, pops {}, score {:.2}, ends at ({:.2}, {:.2}, {:.2})",
        scenario.title,
        report.outcome,
        report.steps,
        report.drive,
        1e3 * soles.deepest.0,
        soles.deepest.1,
        100.0 * soles.hangs.0,
        soles.hangs.1,
        1e3 * soles.over,
        report.plausibility.slip_max_mm,
        report.plausibility.peak_ankle_speed,
        baked.findings.as_ref().map_or(0, |found| found.joints.pops.len()),
        report.plausibility.score,
        end.x,
        end.y,
        end.z,
    );
    if let Some(folder) = std::env::var_os("SUREFOOT_MESHES") {
        let file = surefoot::export::glb_with_props(rig, &[(baked.clip.clone(), report.clone())], &baked.props);
        let path = std::path::Path::new(&folder).join(format!("{}.glb", scenario.title.replace(' ', "_")));
        std::fs::write(path, file.expect("it can be written").bytes).expect("the folder can be written");
    }
    let mut wrong = Vec::new();
    let mut note = |is: bool, what: String| {
        if is {
            wrong.push(format!("{}: {what}", scenario.title));
        }
    };
    note(report.outcome == Outcome::Fall, "it falls".into());
    note(soles.deepest.0 > DEEP, format!("{:.1} mm in the ground at {:.2} s", 1e3 * soles.deepest.0, soles.deepest.1));
    note(soles.hangs.0 > HANGS, format!("{:.0} % over an edge at {:.2} s", 100.0 * soles.hangs.0, soles.hangs.1));
    note(report.plausibility.slip_max_mm > 2.0, format!("slips {:.2} mm", report.plausibility.slip_max_mm));
    (wrong, baked)
}

/// A kerb of 12 to 17 cm, one to three metres ahead.
pub fn kerb(draw: &mut Seed) -> (Mesh, f64) {
    let (rise, from) = (draw.between(0.12, 0.17), draw.between(1.0, 2.2));
    (boxes(&[FLOOR, ([-6.0, -0.3, from], [6.0, rise, 14.0])]), rise)
}

/// A ramp of 8 to 14 degrees, 2 m long, onto a floor.
fn ramp(draw: &mut Seed) -> (Mesh, f64) {
    let (rise, from) = (draw.between(8.0, 14.0).to_radians().tan() * 2.0, draw.between(0.8, 1.6));
    let mut mesh = boxes(&[FLOOR, ([-6.0, -0.3, from + 2.0], [6.0, rise, 14.0])]);
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let to = from + 2.0;
    mesh.quad([at(-6.0, 0.0, from), at(-6.0, rise, to), at(6.0, rise, to), at(6.0, 0.0, from)]);
    (mesh, rise)
}

/// Three steps of 14 to 18 cm, of 28 to 36 cm each.
fn steps(draw: &mut Seed) -> (Mesh, f64) {
    let (rise, tread, from) = (draw.between(0.14, 0.18), draw.between(0.28, 0.36), draw.between(1.0, 1.6));
    let step = |number: f64| ([-6.0, -0.3, from + number * tread], [6.0, rise * (number + 1.0), 14.0]);
    (boxes(&[FLOOR, step(0.0), step(1.0), step(2.0)]), 3.0 * rise)
}

fn walk(draw: &mut Seed) -> String {
    format!(
        "duration = 7.0\n[[walk]]\nstart = 0.5\nspeed = {:.2}\n[[walk]]\nstart = 5.5\nspeed = 0.0\n",
        draw.between(0.7, 1.1)
    )
}

#[test]
fn walks_go_up_kerbs_ramps_and_steps_with_whole_soles_on_them() {
    let rig = builtin();
    type Make = fn(&mut Seed) -> (Mesh, f64);
    let kinds: [(&str, Make); 3] = [("kerb", kerb), ("ramp", ramp), ("steps", steps)];
    let cases: Vec<(Scenario, f64)> = (0..4_u64)
        .flat_map(|seed| {
            kinds.map(|(name, make)| {
                let mut draw = Seed::new(seed);
                let (mesh, rise) = make(&mut draw);
                (scenario(&format!("{name} {seed}"), &walk(&mut draw), &surface(&mesh)), rise)
            })
        })
        .collect();
    let wrongs: Vec<String> = cases
        .par_iter()
        .flat_map(|(scenario, rise)| {
            let (mut wrong, baked) = wrong(&rig, scenario, BakeOptions::default().drive);
            let [first, last] =
                [0, baked.performance.timeline.com.len() - 1].map(|at| baked.performance.timeline.com[at].y);
            if (last - first - rise).abs() > 0.06 {
                wrong.push(format!("{}: it ends {:.2} m up, not {rise:.2}", scenario.title, last - first));
            }
            wrong
        })
        .collect();
    assert!(wrongs.is_empty(), "{}", wrongs.join("\n"));
}

#[test]
fn shoves_beside_ledges_and_kerbs_end_on_whole_soles() {
    let rig = builtin();
    let cases: Vec<Scenario> = (0..4_u64)
        .flat_map(|seed| {
            let mut draw = Seed::new(100 + seed);
            let (rise, beside) = (draw.between(0.12, 0.17), draw.between(0.25, 0.6));
            let up = boxes(&[FLOOR, ([beside, -0.3, -6.0], [6.0, rise, 14.0])]);
            let down = boxes(&[([-6.0, -1.0, -6.0], [6.0, -rise, 14.0]), ([-6.0, -0.5, -6.0], [beside, 0.0, 14.0])]);
            let cliff = boxes(&[([-6.0, -0.5, -6.0], [beside + 0.25, 0.0, 14.0])]);
            let force = draw.between(150.0, 300.0);
            [("kerb up", up), ("kerb down", down), ("cliff", cliff)].map(|(name, mesh)| {
                let push = format!(
                    "duration = 5.0\n[[push]]\nstart = 0.6\nduration = 0.2\nforce = {force:.0}\ntoward = \"left\"\n"
                );
                scenario(&format!("{name} {seed}"), &push, &surface(&mesh))
            })
        })
        .collect();
    let wrongs: Vec<String> = cases.par_iter().flat_map(|scenario| wrong(&rig, scenario, Drive::Stepper).0).collect();
    assert!(wrongs.is_empty(), "{}", wrongs.join("\n"));
}

/// Is it told that something is in the way of the walk?
pub fn says_it_stops(baked: &Baked) -> bool {
    baked.warnings.iter().any(|one| one.starts_with("the walk stops at "))
}

#[test]
fn a_hill_is_walked_higher_than_the_usual_ceiling_and_a_ceiling_that_stops_a_walk_is_named() {
    let rig = builtin();
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let mut hill = boxes(&[([-6.0, -0.3, -6.0], [6.0, 0.0, 1.5])]);
    hill.quad([at(-6.0, 0.0, 1.5), at(-6.0, 3.0, 13.5), at(6.0, 3.0, 13.5), at(6.0, 0.0, 1.5)]);
    let walk = "duration = 14.0\n[[walk]]\nstart = 0.5\nspeed = 0.9\n";
    let mut scenario = scenario("hill", walk, &surface(&hill));
    let free = baked(&rig, &scenario, Drive::Stepper);
    assert!(!says_it_stops(&free), "{:?}", free.warnings);
    let top = |baked: &Baked| baked.performance.timeline.com.last().map_or(0.0, |com| com.z);
    assert!(top(&free) > 10.5, "{}", top(&free));
    // 2 m is the usual ceiling: one that is written holds here too, where none would.
    for (height, reached) in [(1.5, 7.5), (2.0, 9.5)] {
        let GroundKind::Mesh { ceiling, .. } = &mut scenario.ground.kind else { panic!("a mesh") };
        *ceiling = Some(height);
        let stopped = baked(&rig, &scenario, Drive::Stepper);
        let name = format!("ceiling of {height} m: raise [ground] ceiling");
        assert!(stopped.warnings.iter().any(|one| one.contains(&name)), "{:?}", stopped.warnings);
        assert!(top(&stopped) < reached, "{height}: {}", top(&stopped));
    }
    // A wall whose top is a little over the usual ceiling is a wall.
    let wall = boxes(&[FLOOR, ([-6.0, 0.0, 2.5], [6.0, 2.2, 2.8])]);
    let walled = baked(&rig, &self::scenario("wall", walk, &surface(&wall)), Drive::Stepper);
    assert!(walled.warnings.iter().any(|one| one.contains("a wall, a drop")), "{:?}", walled.warnings);
}

#[test]
fn a_walk_stops_before_a_wall_and_before_a_cliff() {
    let rig = builtin();
    let wall = boxes(&[FLOOR, ([-6.0, -0.3, 2.5], [6.0, 3.0, 2.7])]);
    let cliff = boxes(&[([-6.0, -0.5, -6.0], [6.0, 0.0, 2.5])]);
    for (name, mesh) in [("wall", wall), ("cliff edge", cliff)] {
        let walk = "duration = 7.0\n[[walk]]\nstart = 0.5\nspeed = 1.2\n[[walk]]\nstart = 5.5\nspeed = 0.0\n";
        let (wrong, baked) = wrong(&rig, &scenario(name, walk, &surface(&mesh)), Drive::Stepper);
        assert!(wrong.is_empty(), "{wrong:?}");
        let far = baked.performance.timeline.com.iter().map(|com| com.z).fold(0.0, f64::max);
        assert!((1.2..2.4).contains(&far), "{name}: it comes to {far:.2} m, the end is at 2.5 m");
        assert!(says_it_stops(&baked), "{name}: {:?}", baked.warnings);
    }
}

/// m, the farthest that a joint of two clips is apart.
fn apart(rig: &Rig, one: &Baked, other: &Baked) -> f64 {
    let (mut first, mut second) = (rig.sampler(&one.clip), rig.sampler(&other.clip));
    (0..=(one.report.duration * 60.0) as usize)
        .map(|sample| {
            let time = sample as f64 / 60.0;
            let (a, b) = (first.sample(time), second.sample(time));
            a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
        })
        .fold(0.0, f64::max)
}

fn named(mut scenario: Scenario, kind: GroundKind) -> Scenario {
    scenario.ground = Ground { kind, ..scenario.ground };
    scenario
}

#[test]
fn a_flat_mesh_gives_the_clip_of_the_flat() {
    let rig = builtin();
    let flat = surface(&boxes(&[FLOOR]));
    let walk = "duration = 5.0\n[[walk]]\nstart = 0.5\nspeed = 1.1\n[[walk]]\nstart = 3.0\nspeed = 0.0\n";
    let push = |toward: &str, force: u32| {
        format!("duration = 4.0\n[[push]]\nstart = 0.6\nduration = 0.2\nforce = {force}\ntoward = \"{toward}\"\n")
    };
    let cases = [
        ("walk", walk.to_owned(), Drive::Stepper),
        ("shove", push("right", 300), Drive::Stepper),
        ("shove back", push("back", 250), Drive::Stepper),
        ("shove torques", push("left", 200), Drive::Ragdoll(Helped::Auto)),
    ];
    for (name, rest, drive) in cases {
        let mesh = scenario(name, &rest, &flat);
        let plain = named(mesh.clone(), GroundKind::Flat);
        let far = apart(&rig, &baked(&rig, &mesh, drive), &baked(&rig, &plain, drive));
        println!("{name}: on a flat mesh and on the flat joints are {:.4} mm apart at most", 1e3 * far);
        assert!(far < 1e-4, "{name}: {:.3} mm", 1e3 * far);
    }
}

#[test]
fn stairs_as_a_mesh_are_climbed_as_stairs_by_name() {
    let rig = builtin();
    let (rise, tread, count) = (0.16, 0.36, 4_u32);
    let step = |number: u32| {
        let (number, far) = (f64::from(number), 14.0);
        ([-6.0, -0.3, 1.0 + number * tread], [6.0, rise * (number + 1.0), far])
    };
    let corners: Vec<_> = std::iter::once(FLOOR).chain((0..count).map(step)).collect();
    let walk = "duration = 7.0\n[[walk]]\nstart = 0.5\nspeed = 0.8\n[[walk]]\nstart = 5.5\nspeed = 0.0\n";
    let mesh = scenario("stairs", walk, &surface(&boxes(&corners)));
    let plain = named(mesh.clone(), GroundKind::Stairs { rise, tread, count });
    let (one, other) = (baked(&rig, &mesh, Drive::Stepper), baked(&rig, &plain, Drive::Stepper));
    let far = apart(&rig, &one, &other);
    let hips = |baked: &Baked, time: f64| rig.sample(&baked.clip, time).hips;
    let times = (0..=140).map(|tick| 0.05 * f64::from(tick));
    let hips = times.map(|time| hips(&one, time).distance(hips(&other, time))).fold(0.0, f64::max);
    let holds =
        |baked: &Baked| -> Vec<DVec3> { baked.performance.trace.steps.iter().map(|step| step.to.ankle).collect() };
    let lands = holds(&one).iter().zip(holds(&other)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    println!(
        "stairs as a mesh: hips {:.1} cm, joints {:.1} cm, footholds {:.1} cm apart at most; {} steps and {}, score {:.2} and {:.2}",
        1e2 * hips,
        1e2 * far,
        1e2 * lands,
        one.report.steps,
        other.report.steps,
        one.report.plausibility.score,
        other.report.plausibility.score
    );
    assert!(lands < 0.05, "footholds are {:.1} cm apart", 1e2 * lands);
    let climbs = |baked: &Baked| baked.performance.timeline.com.last().map_or(0.0, |com| com.y);
    assert!((climbs(&one) - climbs(&other)).abs() < 0.01, "{} and {}", climbs(&one), climbs(&other));
    assert_eq!(one.report.steps, other.report.steps);
    assert!(one.report.plausibility.score > other.report.plausibility.score - 0.05);
}

#[test]
fn a_body_moved_by_torques_stands_on_a_box_as_on_the_flat() {
    let rig = builtin();
    let on = |rest: &str, height: f64| {
        let mesh = boxes(&[FLOOR, ([-1.5, 0.0, -1.5], [1.5, height, 1.5])]);
        scenario("box", rest, &surface(&mesh))
    };
    let push = "duration = 4.0\n[[push]]\nstart = 0.6\nduration = 0.2\nforce = 200\ntoward = \"left\"\n";
    for (name, rest) in [("still", "duration = 2.0\n"), ("shoved", push)] {
        let mesh = on(rest, 0.3);
        let plain = named(mesh.clone(), GroundKind::Flat);
        let drive = Drive::Ragdoll(Helped::Auto);
        let (mesh, plain) = (baked(&rig, &mesh, drive), baked(&rig, &plain, drive));
        let soles = soles(&rig, &mesh);
        println!(
            "{name} on a box: {:?} and {:?}, {} and {} steps, deepest {:.1} mm, score {:.2} and {:.2}",
            mesh.report.outcome,
            plain.report.outcome,
            mesh.report.steps,
            plain.report.steps,
            1e3 * soles.deepest.0,
            mesh.report.plausibility.score,
            plain.report.plausibility.score
        );
        let [hips, flat] = [&mesh, &plain].map(|baked| rig.sample(&baked.clip, 0.0).hips);
        assert!((hips - flat - DVec3::Y * 0.3).length() < 2e-3, "{name}: hips at {hips}, on the flat at {flat}");
        assert_eq!(mesh.report.outcome, plain.report.outcome, "{name}");
        assert_eq!(mesh.report.steps, plain.report.steps, "{name}");
        assert!(soles.deepest.0 < DEEP, "{name}: {:.1} mm", 1e3 * soles.deepest.0);
    }
}
