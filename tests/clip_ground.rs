//! Stands and walks on slopes, stairs, rolling ground and a platform that turns: what the feet hold, and the props beside.
//!
//! Slip and depth keep the limits of clips on level ground. The friction that is needed is printed; `ground` holds
//! what the controller asks for. The files stay in target/baked for the scripts of tests/tools.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::data;
use crate::export::{baked_path, json_of};
use glam::{DQuat, DVec3};
use rayon::prelude::*;
use serde_json::Value;
use surefoot::bake::{BakeOptions, Baked, RootMotion, bake};
use surefoot::maths::seed::Seed;
use surefoot::measure::percentile;

use crate::common::builtin;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::Scenario;
use surefoot::model::scenario_text;
use surefoot::model::{KeyValues, Role, Target};
use surefoot::rig::animate::RootCarrier;
use surefoot::rig::{Rig, load_bytes};

/// A rig in centimetres that another program made; `None` without the data.
fn foreign() -> Option<Rig> {
    let file = data::more()?.join("rigs/kaykit_Knight.glb");
    Some(surefoot::rig::load(&file).expect("the rig loads"))
}

fn scenario(title: &str, duration: f64, rest: &str) -> Scenario {
    let text = format!("title = \"{title}\"\nduration = {duration}\n{rest}");
    scenario_text::parse(title, &text).unwrap_or_else(|errors| panic!("{title}: {errors:?}"))
}

const SHOVE: &str = "[[push]]\nstart = 1.0\nduration = 0.2\nforce = 200.0\n";

fn slope(degrees: f64, rest: &str) -> String {
    format!("[ground]\nkind = \"slope\"\nangle = {degrees}\n{rest}")
}

fn baked(rig: &Rig, scenario: &Scenario) -> Baked {
    bake(rig, scenario, &BakeOptions::default()).expect("it bakes")
}

/// What the limits are held on, one a clip.
struct Held {
    title: String,
    slips: Vec<f64>,
    speed: f64,
    sink: f64,
    float: f64,
}

/// Bakes, prints the row and writes the file with its props.
fn held(rig: &Rig, scenario: &Scenario) -> (Held, Baked) {
    let baked = baked(rig, scenario);
    let found = baked.findings.as_ref().expect("it can be measured");
    let report = &baked.report;
    println!(
        "{:<34} {:?}, {} steps: slip {:.2} mm, {:.1} mm/s, sink {:.1} mm, float {:.1} mm, ZMP inside {:.0} %, friction {:.2}, pops {}, score {:.2}",
        report.scenario,
        report.outcome,
        report.steps,
        found.feet.slip_max_mm,
        found.feet.slip_speed_p95,
        found.feet.penetration_max_mm,
        found.feet.float_max_mm,
        100.0 * found.zmp.inside,
        found.friction_p99,
        found.joints.pops.len(),
        report.plausibility.score
    );
    let file = surefoot::export::glb_with_props(rig, &[(baked.clip.clone(), report.clone())], &baked.props)
        .expect("it can be written");
    let name = format!("ground_{}.glb", baked.clip.name);
    std::fs::write(baked_path(&name), &file.bytes).expect("target can be written");
    let held = Held {
        title: report.scenario.clone(),
        slips: found.feet.slips.iter().map(|slip| slip.mm).collect(),
        speed: found.feet.slip_speed_p95,
        sink: found.feet.penetration_max_mm,
        float: found.feet.float_max_mm,
    };
    (held, baked)
}

fn hold(rows: &[Held]) {
    let slips: Vec<f64> = rows.iter().flat_map(|row| row.slips.iter().copied()).collect();
    assert!(percentile(&slips, 0.95) <= 1.0, "slip p95 {:.2} mm", percentile(&slips, 0.95));
    for row in rows {
        let worst = row.slips.iter().copied().fold(0.0, f64::max);
        assert!(worst <= 2.0, "{}: a foot slips {worst:.2} mm", row.title);
        assert!(row.speed <= 10.0, "{}: held points move at {:.1} mm/s", row.title, row.speed);
        assert!(row.sink <= 5.0, "{}: a sole is {:.1} mm under its plane", row.title, row.sink);
        assert!(row.float <= 5.0, "{}: a sole is {:.1} mm over its plane", row.title, row.float);
    }
}

#[test]
fn stands_and_recoveries_on_slopes_keep_their_feet() {
    let rig = builtin();
    let mut scenarios = Vec::new();
    for degrees in [10, -10, 25, -25] {
        scenarios.push(scenario(&format!("still {degrees}"), 2.0, &slope(f64::from(degrees), "")));
        for toward in ["front", "back", "left"] {
            let push = slope(f64::from(degrees), &format!("{SHOVE}toward = \"{toward}\"\n"));
            scenarios.push(scenario(&format!("shove {toward} {degrees}"), 5.0, &push));
        }
        let turn = slope(f64::from(degrees), "[[turn]]\nstart = 0.3\nfacing = 90.0\n");
        scenarios.push(scenario(&format!("across {degrees}"), 4.0, &turn));
    }
    let all: Vec<(Held, Baked)> = scenarios.par_iter().map(|scenario| held(&rig, scenario)).collect();
    for (_, baked) in all.iter().filter(|(row, _)| row.title.starts_with("still")) {
        assert_eq!(baked.report.outcome, Outcome::Still, "{}", baked.report.scenario);
        let tangent = baked.performance.timeline.terrain.spot(glam::DVec2::ZERO).normal;
        let needed = (1.0 - tangent.y * tangent.y).sqrt() / tangent.y;
        assert!((baked.report.plausibility.friction_p99 - needed).abs() < 0.01, "{}", baked.report.scenario);
    }
    assert!(all.iter().all(|(_, baked)| baked.report.contacts.iter().all(|contact| contact.normal[1] < 0.99)));
    assert!(all.iter().filter(|(_, baked)| baked.report.outcome == Outcome::Step).count() >= 12);
    hold(&all.into_iter().map(|(held, _)| held).collect::<Vec<_>>());
}

#[test]
fn stands_and_walks_on_rolling_ground_and_stairs_keep_their_feet() {
    let rig = builtin();
    let uneven = |seed: u32| format!("[ground]\nkind = \"uneven\"\nheight = 0.05\nwavelength = 1.0\nseed = {seed}\n");
    let stairs = |rise: f64| format!("[ground]\nkind = \"stairs\"\nrise = {rise}\ntread = 0.29\ncount = 6\n");
    let gaps = "[ground]\nkind = \"gaps\"\nwidth = 0.2\nspacing = 1.0\n";
    let walk = |speed: f64| format!("[[walk]]\nstart = 0.5\nspeed = {speed}\n[[walk]]\nstart = 4.0\nspeed = 0.0\n");
    let mut scenarios = vec![
        scenario("uneven shove", 5.0, &format!("{}{SHOVE}toward = \"right\"\n", uneven(1))),
        scenario("stairs up", 6.0, &format!("{}{}", stairs(0.17), walk(0.8))),
        scenario("stairs down", 6.0, &format!("{}{}", stairs(-0.17), walk(0.8))),
        scenario("gaps", 6.0, &format!("{gaps}{}", walk(1.0))),
        scenario("walk up", 6.0, &slope(15.0, &walk(1.0))),
        scenario("walk down", 6.0, &slope(-15.0, &walk(1.0))),
    ];
    scenarios
        .extend((2..5).map(|seed| scenario(&format!("uneven {seed}"), 6.0, &format!("{}{}", uneven(seed), walk(1.2)))));
    let all: Vec<Held> = scenarios.par_iter().map(|scenario| held(&rig, scenario).0).collect();
    hold(&all);
}

#[test]
fn what_a_clip_of_a_walk_on_slippery_ground_asks_for_is_what_the_ground_has() {
    let rig = builtin();
    let mut draw = Seed::new(5);
    let mut scenarios = Vec::new();
    for friction in [0.1, 0.3] {
        for _ in 0..3 {
            let speed = draw.between(0.6, 1.4);
            let text = format!("[ground]\nfriction = {friction}\n[[walk]]\nstart = 0.5\nspeed = {speed}\n");
            scenarios.push((friction, scenario(&format!("friction {friction} at {speed:.2}"), 7.0, &text)));
        }
    }
    let all: Vec<(f64, Baked)> =
        scenarios.par_iter().map(|(friction, scenario)| (*friction, held(&rig, scenario).1)).collect();
    for (friction, baked) in all {
        let needed = baked.report.plausibility.friction_p99;
        // the pressure's roll from foot to foot takes its time: that much is not the gait's to spare
        assert!(needed <= friction + 0.03, "{}: {needed:.3}", baked.report.scenario);
        assert_eq!(baked.report.outcome, Outcome::Step, "{}", baked.report.scenario);
    }
}

/// Walks over ground that is drawn for a size (legs over the reference body's), of the built-in body on short, usual and long legs and of other
/// people's rigs: how they are called, and their clips.
fn drawn(seed: u64, paces: [f64; 2], ground: impl Fn(&mut Seed, f64) -> String + Sync) -> Vec<(String, Baked)> {
    let load = |name: &'static str| Some((name, surefoot::rig::load(&data::more()?.join("rigs").join(name)).ok()?));
    let foreign = ["m2m_human_base_animations.glb", "vrm1_debug_robot.vrm"].map(load);
    let one = |index: u64| {
        let mut draw = Seed::new(index ^ seed);
        let legs = [1.0, 0.7, 1.3, 1.0][index as usize % 4];
        let other = foreign[index as usize / 4 % 2].as_ref().filter(|_| index % 4 == 3);
        let rig = other.map_or_else(builtin, |(_, rig)| rig.clone());
        let size: f64 = legs * rig.body.leg_length / 0.83;
        let ground = ground(&mut draw, size);
        let speed = draw.between(paces[0], paces[1]) * size.sqrt();
        let rest = format!(
            "[ground]\n{ground}[character]\nleg_scale = {legs:.1}\n[[walk]]\nstart = 0.5\nspeed = {speed:.2}\n"
        );
        let name = format!("{index}: {} at {speed:.2} m/s, legs {legs}", ground.replace('\n', " "));
        // Blender cuts names after 63 characters.
        let title = format!("{} {index} at {speed:.2} m/s legs {legs}", name.split('"').nth(1).unwrap_or_default());
        let baked = held(&rig, &scenario(&title, 12.0, &rest)).1;
        if let Some((source, _)) = other {
            std::fs::write(baked_path(&format!("ground_{}.glb.source", baked.clip.name)), source).expect("written");
        }
        (name, baked)
    };
    (0..20_u64).into_par_iter().map(one).collect()
}

/// None falls or looks bad, soles stay over the ground and still; of their scores `least` each, `mean` of all.
fn all_keep_their_feet(clips: &[(String, Baked)], [least, mean]: [f64; 2]) {
    let mut all = 0.0;
    for (name, clip) in clips {
        let (report, found) = (&clip.report, clip.findings.as_ref().expect("it can be measured"));
        let (score, deep) = (report.plausibility.score, found.feet.penetration_max_mm);
        println!("{name}: {:?}, {score:.2}, {deep:.1} mm deep, {:?}", report.outcome, report.plausibility.notes);
        all += score / clips.len() as f64;
    }
    println!("mean score {all:.3}");
    for (name, clip) in clips {
        let (report, found) = (&clip.report, clip.findings.as_ref().expect("it can be measured"));
        assert_ne!(report.outcome, Outcome::Fall, "{name}");
        assert!(found.feet.penetration_max_mm < 6.0, "{name}: {:.1} mm", found.feet.penetration_max_mm);
        assert!(report.plausibility.score >= least, "{name}: {:.2}", report.plausibility.score);
        assert!(found.feet.slip_max_mm < 2.0, "{name}: slips {:.2} mm", found.feet.slip_max_mm);
    }
    assert!(all >= mean, "{all:.3}");
}

/// `kaykit_Knight` falls into them: its soles are longer than its steps.
#[test]
fn walks_of_every_pace_over_gaps_keep_their_feet() {
    let clips = drawn(0x6A9, [0.3, 1.2], |draw, size| {
        let (width, spacing) = (draw.between(0.08, 0.2), draw.between(0.7, 1.3));
        format!("kind = \"gaps\"\nwidth = {:.3}\nspacing = {:.3}\n", width * size.min(1.0), spacing * size.max(1.0))
    });
    all_keep_their_feet(&clips, [0.8, 0.9]);
}

#[test]
fn walks_of_every_pace_over_flights_keep_their_feet() {
    let clips = drawn(0xF119, [0.3, 0.9], |draw, size| {
        let (rise, tread) = (draw.between(0.1, 0.17) * size.min(1.0), draw.between(0.28, 0.34));
        let rise = if draw.between(0.0, 1.0) < 0.5 { rise } else { -rise };
        format!("kind = \"stairs\"\nrise = {rise:.3}\ntread = {tread:.3}\ncount = 5\n")
    });
    all_keep_their_feet(&clips, [0.7, 0.85]);
}

#[test]
fn feet_on_a_platform_turn_with_it_and_do_not_slip() {
    let rig = builtin();
    let platform = "[ground]\nkind = \"platform\"\npitch = [[1.0, 0.0], [3.0, 20.0], [5.0, 0.0]]\nroll = [[2.0, 0.0], [4.0, -15.0]]\n";
    let scenarios = [
        scenario("platform still", 5.5, platform),
        scenario(
            "platform shove",
            6.0,
            &format!("{platform}[[push]]\nstart = 2.5\nduration = 0.2\nforce = 150.0\ntoward = \"back\"\n"),
        ),
    ];
    let all: Vec<(Held, Baked)> = scenarios.par_iter().map(|scenario| held(&rig, scenario)).collect();
    for (_, baked) in &all {
        assert!(baked.report.contacts.iter().all(|contact| contact.frame == "platform"));
        // In the world they do move: by 20 degrees about the origin; the toes do, where the heel is up.
        let timeline = &baked.performance.timeline;
        let ankle = |time: f64| timeline.feet.at(surefoot::model::Side::Left, time);
        let turned = (ankle(2.4).toe * ankle(0.0).toe.inverse()).to_axis_angle().1;
        assert!(turned > 0.2, "{turned}");
    }
    hold(&all.into_iter().map(|(held, _)| held).collect::<Vec<_>>());
}

#[test]
fn props_stand_after_the_sources_own_nodes_and_turn_as_the_ground_does() {
    let platform =
        "[ground]\nkind = \"platform\"\npitch = [[0.5, 0.0], [1.5, 10.0]]\nroll = [[1.0, 0.0], [2.0, 5.0]]\n";
    let tilts = scenario("tilts", 2.5, platform);
    let mut rigs = vec![builtin()];
    rigs.extend(foreign());
    for rig in &rigs {
        let baked = baked(rig, &tilts);
        let clips = [(baked.clip.clone(), baked.report.clone())];
        let with = surefoot::export::glb_with_props(rig, &clips, &baked.props).expect("it can be written").bytes;
        let without = surefoot::export::glb(rig, &clips).expect("it can be written").bytes;
        let ((with_json, bin), (without_json, _)) = (json_of(&with), json_of(&without));
        // The source's own values stand where they stood.
        for list in ["nodes", "meshes", "materials", "skins", "accessors", "bufferViews", "animations"] {
            let source = rig.document.json[list].as_array().map_or(&[][..], Vec::as_slice);
            let now = with_json[list].as_array().map_or(&[][..], Vec::as_slice);
            assert!(now.len() >= source.len(), "{list}");
            for (index, value) in source.iter().enumerate().filter(|_| !["nodes", "bufferViews"].contains(&list)) {
                assert_eq!(&now[index], value, "{list}[{index}]");
            }
        }
        let nodes = with_json["nodes"].as_array().expect("nodes");
        let is_prop = |node: &Value| node.pointer("/extras/surefoot/prop") == Some(&Value::Bool(true));
        assert!(!without_json["nodes"].as_array().expect("nodes").iter().any(is_prop));
        let (index, node) = nodes.iter().enumerate().find(|(_, node)| is_prop(node)).expect("a platform");
        assert!(index >= rig.document.json["nodes"].as_array().map_or(0, Vec::len));
        assert_eq!(node["name"], "platform");
        let scene = &with_json["scenes"][with_json["scene"].as_u64().unwrap_or(0) as usize]["nodes"];
        assert!(scene.as_array().expect("nodes").iter().any(|listed| *listed == index), "it is in the scene");
        // Its mesh is 3 m wide, in the document's own units.
        let accessor = |at: &Value| &with_json["accessors"][at.as_u64().expect("an index") as usize];
        let mesh = &with_json["meshes"][node["mesh"].as_u64().expect("a mesh") as usize]["primitives"][0];
        let high = accessor(&mesh["attributes"]["POSITION"])["max"][0].as_f64().expect("bounds");
        let scale = node["scale"][0].as_f64().expect("a scale");
        assert!((high * scale - 1.5 * rig.document_from_scenario.scale).abs() < 1e-4 * scale, "{high} x {scale}");
        // Its channel is the terrain's turn.
        let animations = with_json["animations"].as_array().expect("clips");
        let animation = animations.last().expect("the new one");
        let channels = animation["channels"].as_array().expect("channels");
        let turns: Vec<&Value> = channels.iter().filter(|channel| channel["target"]["node"] == index).collect();
        assert_eq!(turns.len(), 1, "only its rotation moves");
        assert_eq!(turns[0]["target"]["path"], "rotation");
        let sampler = &animation["samplers"][turns[0]["sampler"].as_u64().expect("an index") as usize];
        let floats = |at: &Value, width: usize| -> Vec<Vec<f64>> {
            let accessor = accessor(at);
            let view = &with_json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
            let offset = |of: &Value| of["byteOffset"].as_u64().unwrap_or(0) as usize;
            let from = offset(view) + offset(accessor);
            let count = accessor["count"].as_u64().expect("a count") as usize;
            let read = |place: usize| f32::from_le_bytes(bin[place..place + 4].try_into().expect("four bytes"));
            (0..count)
                .map(|key| (0..width).map(|part| f64::from(read(from + 4 * (key * width + part)))).collect())
                .collect()
        };
        let axes = rig.document_from_scenario.rotation;
        for (time, turn) in floats(&sampler["input"], 1).iter().zip(floats(&sampler["output"], 4)) {
            let wanted = axes * baked.performance.timeline.terrain.turn(time[0]);
            let off = DQuat::from_slice(&turn).angle_between(wanted);
            assert!(off < 1e-3, "{off} rad at {} s", time[0]);
        }
        // Loaded again, the props are no part of the body.
        let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let again = load_bytes("again.glb", &with, &alone, None).expect("it loads");
        assert_eq!(again.mesh.len(), rig.mesh.len());
        assert!((again.body.height - rig.body.height).abs() < 1e-9);
        let shift = |a: DVec3, b: DVec3| a.distance(b);
        assert!(shift(again.document_from_scenario.translation, rig.document_from_scenario.translation) < 1e-9);
    }
}

#[test]
fn the_root_goes_with_the_ground_under_the_character() {
    let rig = builtin();
    let carrier = match RootMotion::Root.carrier(&rig) {
        RootCarrier::Node(node) => Target::Node(node),
        _ => Target::NewRoot,
    };
    let walk = "[[walk]]\nstart = 0.3\nspeed = 0.5\n[[walk]]\nstart = 5.5\nspeed = 0.0\n";
    let grounds = [
        ("flat", "", 0.0),
        ("up", "[ground]\nkind = \"slope\"\nangle = 10.0\n", 0.0),
        ("down", "[ground]\nkind = \"slope\"\nangle = -10.0\n", 0.0),
        ("stairs", "[ground]\nkind = \"stairs\"\nrise = 0.17\ntread = 0.3\ncount = 4\n", 0.68),
    ];
    for (name, ground, top) in grounds {
        let baked = baked(&rig, &scenario(&format!("root {name}"), 9.0, &format!("{ground}{walk}")));
        let terrain = &baked.performance.timeline.terrain;
        let channel = baked.clip.channels.iter().find_map(|channel| match &channel.values {
            KeyValues::Translation(keys) if channel.target == carrier => Some((channel.interpolation.stride(), keys)),
            _ => None,
        });
        let (stride, numbers) = channel.expect("the root travels");
        let values = numbers.chunks_exact(stride).map(|key| key[stride / 2]);
        let keys: Vec<DVec3> = values.map(|key| DVec3::from(key.map(f64::from))).collect();
        let height = |key: &DVec3| terrain.spot(glam::DVec2::new(key.x, key.z)).height;
        let off = keys.iter().map(|key| (key.y - height(key)).abs()).fold(0.0, f64::max);
        let end = keys[keys.len() - 1];
        println!("{name}: the root ends at {end}, at most {:.1} cm off the ground under it", 100.0 * off);
        match name {
            "flat" => assert!(keys.iter().all(|key| key.y == 0.0), "{name}"),
            "stairs" => assert!((end.y - top).abs() < 1e-3 && off < 0.17, "{name}: {end}, {off}"),
            // The ground is that between the ankles: the root is ahead of it by as much as the hips are.
            _ => assert!(off < 0.03 && end.y.abs() > 0.3, "{name}: {end}, {off}"),
        }
    }
}

#[test]
fn the_trunk_of_a_walk_leans_into_the_slope() {
    let rig = builtin();
    let walk = "[[walk]]\nstart = 0.3\nspeed = 1.0\n";
    let lean = |degrees: f64| {
        let ground = if degrees == 0.0 { String::new() } else { slope(degrees, "") };
        let baked = baked(&rig, &scenario("lean", 6.0, &format!("{ground}{walk}")));
        let body = &baked.performance.timeline.body;
        let [low, high] = [Role::Hips, Role::Neck].map(|role| body.joint(role).expect("the built-in rig has all"));
        let mut sampler = rig.sampler(&baked.clip);
        let leans = (75..180).map(|frame| {
            let positions = sampler.sample(f64::from(frame) / 30.0).positions;
            let up = positions[high] - positions[low];
            up.z.atan2(up.y)
        });
        (leans.sum::<f64>() / 105.0, baked.report.plausibility.zmp_inside)
    };
    let (level, _) = lean(0.0);
    let [(up, zmp_up), (down, zmp_down)] = [lean(10.0), lean(-10.0)];
    let more = [up - level, down - level].map(f64::to_degrees);
    println!("10 degrees up: {:.1} degrees more, down: {:.1}; ZMP inside {zmp_up:.3} {zmp_down:.3}", more[0], more[1]);
    assert!((5.7..8.6).contains(&more[0]) && (-4.0..0.5).contains(&more[1]), "{more:?}");
    assert!(zmp_up > 0.98 && zmp_down > 0.98, "{zmp_up} {zmp_down}");
}
