//! Loops: cycles that begin again without a seam, on the built-in rig and on others; what has none, and what it says then.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::data;
use crate::export::{baked_path, json_of};
use crate::limits_grid::rigs;
use glam::DQuat;
use std::sync::Arc;
use surefoot::bake::base::prepare;
use surefoot::bake::{BakeError, BakeOptions, Baked, Performance, RootMotion, bake};
use surefoot::export::glb;
use surefoot::measure::Findings;
use surefoot::mocap;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::Scenario;
use surefoot::model::{Clip, KeyValues, Side, Target, scenario_text};
use surefoot::rig::{Rig, load};

/// The rigs that walk in circles.
const RIGS: [&str; 3] = ["builtin", "gdquest_mannequiny", "m2m_human_male"];
/// What they walk: name, m/s, heading.
const WALKS: [(&str, f64, f64); 5] = [
    ("walk 0.6", 0.6, 0.0),
    ("walk 1.2", 1.2, 0.0),
    ("walk 1.8", 1.8, 0.0),
    ("back 0.6", 0.6, 180.0),
    ("left 0.4", 0.4, 90.0),
];

fn scenario(text: &str) -> Scenario {
    scenario_text::parse("test", text).unwrap_or_else(|error| panic!("{error:?}"))
}

fn walk(rig: &Rig, (name, speed, heading): (&str, f64, f64)) -> Scenario {
    let speed = speed * (rig.body.leg_length / 0.83).sqrt();
    scenario(&format!(
        "title = \"{name}\"\nduration = 8.0\n[[walk]]\nstart = 0.3\nspeed = {speed}\nheading = {heading:.1}\nfacing = 0.0\n"
    ))
}

fn looped(root: RootMotion) -> BakeOptions {
    BakeOptions { looped: true, root, ..BakeOptions::default() }
}

/// How suddenly each joint's speed changes, sample by sample, rad a sample.
fn jerks(turns: &[Vec<DQuat>], joint: usize) -> Vec<f64> {
    let steps: Vec<_> =
        turns.windows(2).map(|pair| (pair[0][joint].inverse() * pair[1][joint]).to_scaled_axis()).collect();
    steps.windows(2).map(|pair| pair[1].distance(pair[0])).collect()
}

/// How many times more suddenly a joint's speed changes at the seam than anywhere else in the cycle, or where a foot comes down in the
/// motion that it was cut from; of the worst joint.
fn seam_step(rig: &Rig, clip: &Clip, performed: &Performance) -> f64 {
    let mut sampler = rig.sampler(clip);
    let frames = (clip.duration * 120.0).round() as usize;
    let dt = clip.duration / frames as f64;
    let mut turns: Vec<_> = (0..frames).map(|frame| sampler.sample(frame as f64 * dt).turns).collect();
    turns.push(turns[0].clone());
    turns.push(turns[1].clone());
    let end = performed.timeline.stands() - 0.1;
    let downs = performed.contacts.iter().map(|contact| contact.start).filter(|start| *start > 1.0 && *start < end);
    let landings: Vec<Vec<Vec<DQuat>>> = downs
        .map(|down| (-2..=2).map(|step| performed.timeline.pose_at(down + f64::from(step) * dt).turns).collect())
        .collect();
    let mut worst = 0.0_f64;
    for joint in 0..turns[0].len() {
        let list = jerks(&turns, joint);
        let (inside, seam) = list.split_at(list.len() - 2);
        let landed = landings.iter().flat_map(|poses| jerks(poses, joint));
        let most = inside.iter().copied().chain(landed).fold(0.25_f64.to_radians(), f64::max);
        worst = worst.max(seam.iter().copied().fold(0.0, f64::max) / most);
    }
    worst
}

fn check_seam(name: &str, rig: &Rig, baked: &Baked) {
    let told = baked.report.looped.as_ref().expect("it is a loop");
    let found: &Findings = baked.findings.as_ref().expect("it can be measured");
    let feet = &found.feet;
    let step = seam_step(rig, &baked.clip, &baked.performance);
    println!(
        "{name:<34} {:.2} s {:.2} m/s seam {:.4} deg {:.4} mm (evened {:.1} deg {:.0} mm) slip {:.2} mm sink {:.1} float {:.1} pops {} \
         seam's jerk {step:.2} zmp {:.1} % score {:.2}",
        told.period,
        told.speed,
        told.error_deg,
        told.error_mm,
        told.evened_deg,
        told.evened_mm,
        feet.slip_max_mm,
        feet.penetration_max_mm,
        feet.float_max_mm,
        found.joints.pops.len(),
        100.0 * found.zmp.inside,
        baked.report.plausibility.score,
    );
    assert!(told.error_deg < 0.1 && told.error_mm < 1.0, "{name}: {told:?}");
    assert!(feet.slip_max_mm < 1.0, "{name}: slips {} mm", feet.slip_max_mm);
    // A cycle that is not joined smoothly jerks there as nowhere else.
    assert!(step < 3.0, "{name}: the seam jerks {step:.2} times as much as anything else");
    assert!(baked.clip.name.ends_with("_loop"), "{}", baked.clip.name);
    for contact in &baked.report.contacts {
        assert!(
            contact.start >= 0.0 && contact.end <= told.period + 1e-6 && contact.start < contact.end,
            "{contact:?}"
        );
    }
    assert!((baked.report.duration - told.period).abs() < 1e-9 && (baked.clip.duration - told.period).abs() < 1e-9);
}

/// The same, and what a walk of the program's own keeps beside it.
fn check(name: &str, rig: &Rig, baked: &Baked) {
    check_seam(name, rig, baked);
    let told = baked.report.looped.as_ref().expect("it is a loop");
    let found: &Findings = baked.findings.as_ref().expect("it can be measured");
    let feet = &found.feet;
    assert!(feet.penetration_max_mm < 5.0 && feet.float_max_mm < 5.0, "{name}: {feet:?}");
    let at_seam = |time: f64| {
        // The step from the last frame before a seam to the first after it, and its neighbours.
        let near = (time / told.period).round();
        (time + 0.5 / baked.clip.fps - near * told.period).abs() < 1.5 / baked.clip.fps
    };
    let pops: Vec<_> = found.joints.pops.iter().filter(|pop| at_seam(pop.time)).collect();
    assert!(pops.is_empty(), "{name}: {pops:?}");
}

/// Leaves the file for the validator and says what it is called there.
fn leave(rig: &Rig, baked: &Baked, name: &str, source: Option<&str>) {
    let made = glb(rig, &[(baked.clip.clone(), baked.report.clone())]).expect("can be written");
    assert!(made.names[0].to_lowercase().ends_with("_loop"), "{:?}", made.names);
    let (json, _) = json_of(&made.bytes);
    let animations = json["animations"].as_array().expect("there are some");
    let extras = &animations[animations.len() - 1]["extras"]["surefoot"]["loop"];
    assert!(extras["period"].as_f64().is_some_and(|period| period > 0.5), "{extras}");
    assert!(extras["error_deg"].as_f64().is_some_and(|error| error < 0.1), "{extras}");
    let path = baked_path(&format!("loop_{name}.glb").replace(' ', "_"));
    if let Some(source) = source {
        std::fs::write(path.with_extension("glb.source"), source).expect("can be written");
    }
    std::fs::write(path, made.bytes).expect("can be written");
}

#[test]
fn a_walk_loops_on_every_rig() {
    for (name, rig) in rigs().iter().filter(|(name, _)| RIGS.contains(&name.trim_end_matches(".glb"))) {
        for way in WALKS {
            let baked = bake(rig, &walk(rig, way), &looped(RootMotion::Root))
                .unwrap_or_else(|error| panic!("{name} {}: {error}", way.0));
            let title = format!("{name} {}", way.0);
            check(&title, rig, &baked);
            let report = &baked.report;
            assert_eq!((report.outcome, report.steps), (Outcome::Step, 2), "{title}");
            for side in Side::BOTH {
                for event in ["foot_down", "foot_up"] {
                    let count = report.events.iter().filter(|one| one.foot == Some(side) && one.name == event).count();
                    assert_eq!(count, 1, "{title}: {event} {side:?}: {:?}", report.events);
                }
            }
            let told = report.looped.as_ref().expect("it is a loop");
            let wanted = way.1 * (rig.body.leg_length / 0.83).sqrt();
            assert!((told.speed - wanted).abs() < 0.1 * wanted, "{title}: {} m/s for {wanted}", told.speed);
            let source = format!("{name}.glb");
            leave(rig, &baked, &title, (name != "builtin").then_some(source.as_str()));
        }
    }
}

#[test]
fn a_cycle_that_is_cut_where_it_is_not_alike_would_be_seen() {
    // The planted extreme of the seam's measures: the same walk cut a fifth too early.
    let rig = &builtin();
    let baked = bake(rig, &walk(rig, WALKS[1]), &looped(RootMotion::Root)).expect("it loops");
    let mut cut = baked.clip.clone();
    cut.duration *= 0.8;
    let step = seam_step(rig, &baked.clip, &baked.performance);
    assert!(step < 3.0, "{step}");
    assert!(seam_step(rig, &cut, &baked.performance) > 3.0, "{}", seam_step(rig, &cut, &baked.performance));
}

#[test]
fn the_travel_of_a_loop_goes_at_one_speed_where_it_is_asked_for() {
    for (name, rig) in rigs().iter().filter(|(name, _)| RIGS.contains(&name.trim_end_matches(".glb"))) {
        let scenario = walk(rig, WALKS[1]);
        let baked = [RootMotion::Root, RootMotion::Hips, RootMotion::InPlace]
            .map(|mode| bake(rig, &scenario, &looped(mode)).expect("it loops"));
        let [root, hips, place] = &baked;
        for one in &baked {
            check(&format!("{name} {}", one.report.root_motion), rig, one);
        }
        let told = root.report.looped.as_ref().expect("it is a loop");
        let carrier = surefoot::bake::root_motion::root_bone(rig).map_or(Target::NewRoot, Target::Node);
        let channel = root.clip.channels.iter().find(|channel| channel.target == carrier);
        let KeyValues::Translation(keys) = &channel.expect("the root moves").values else { panic!("{name}: no way") };
        assert_eq!(keys.len(), 2, "{name}: one straight line");
        let travel = |baked: &Baked| rig.sample(&baked.clip, told.period).hips - rig.sample(&baked.clip, 0.0).hips;
        for baked in [root, hips] {
            assert!((travel(baked).length() / told.period - told.speed).abs() < 1e-3, "{name}: {}", travel(baked));
        }
        assert!(travel(place).length() < 1e-5, "{name}: {}", travel(place));
        // The three show one motion.
        for part in 0..=20 {
            let time = told.period * f64::from(part) / 20.0;
            let [root, hips, place] = [root, hips, place].map(|baked| rig.sample(&baked.clip, time));
            let way = travel(&baked[0]) * (f64::from(part) / 20.0);
            for joint in 0..root.positions.len() {
                let off = root.positions[joint].distance(hips.positions[joint]);
                assert!(off < 1e-4, "{name} {time}: {off} m");
                let off = root.positions[joint].distance(place.positions[joint] + way);
                assert!(off < 1e-4, "{name} {time}: in place {off} m");
            }
        }
    }
}

#[test]
fn a_box_is_carried_without_an_end() {
    let rig = &builtin();
    let points: Vec<String> =
        (0..=10).map(|second| format!("[{second}.0, {}]", if second % 2 == 0 { "4.0" } else { "14.0" })).collect();
    let text = format!(
        "title = \"carry\"\nduration = 10.0\n[[carry]]\nstart = 0.0\nmass = [{}]\nsize = [0.4, 0.3, 0.3]\n",
        points.join(", ")
    );
    let baked = bake(rig, &scenario(&text), &looped(RootMotion::Root)).expect("it loops");
    check("a box that gets heavier and lighter", rig, &baked);
    let told = baked.report.looped.as_ref().expect("it is a loop");
    assert!(
        (told.period - 2.0).abs() < 0.05 || (told.period - 4.0).abs() < 0.05,
        "the box's own two seconds: {told:?}"
    );
    assert_eq!(told.speed, 0.0);
    assert!(baked.warnings.is_empty(), "{:?}", baked.warnings);
    let held = baked.props.iter().find(|prop| prop.name == "box").expect("the box is there");
    assert!(held.at(0.0).translation.distance(held.at(told.period).translation) < 1e-3);
    leave(rig, &baked, "builtin carry", None);
    // And while walking.
    let text = "title = \"porter\"\nduration = 9.0\n[[carry]]\nstart = 0.0\nmass = [[0.0, 10.0]]\nsize = [0.4, 0.3, 0.3]\n[[walk]]\nstart = 0.3\nspeed = 1.0\n";
    let baked = bake(rig, &scenario(text), &looped(RootMotion::Root)).expect("it loops");
    check("a box on the way", rig, &baked);
    let held = baked.props.iter().find(|prop| prop.name == "box").expect("the box is there");
    let told = baked.report.looped.as_ref().expect("it is a loop");
    let way = held.at(told.period).translation - held.at(0.0).translation;
    assert!((way.z / told.period - told.speed).abs() < 5e-3, "{way}");
}

#[test]
fn what_has_no_cycle_says_what_would_give_one() {
    let rig = &builtin();
    let why = |text: &str| match bake(rig, &scenario(text), &looped(RootMotion::Root)) {
        Err(BakeError::NoCycle { why }) => why,
        Err(other) => panic!("{other}"),
        Ok(baked) => panic!("a loop of {:?}", baked.report.looped),
    };
    let short = why("title = \"short\"\nduration = 2.0\n[[walk]]\nstart = 0.3\nspeed = 1.2\n");
    assert!(short.contains("duration"), "{short}");
    let pushed = "[[push]]\nstart = 1.0\nduration = 0.2\nforce = 100.0\ntoward = \"left\"\nat = \"chest\"\n";
    let mut text = "title = \"pushed\"\nduration = 3.2\n[[walk]]\nstart = 0.3\nspeed = 1.2\n".to_owned();
    text += pushed;
    let told = why(&text);
    assert!(told.contains("disturbance"), "{told}");
    let stairs = why(
        "title = \"up\"\nduration = 7.0\n[ground]\nkind = \"stairs\"\nrise = 0.16\ntread = 0.3\ncount = 12\n[[walk]]\nstart = 0.3\nspeed = 0.6\n",
    );
    assert!(stairs.contains("stairs"), "{stairs}");
    let ship = why(
        "title = \"deck\"\nduration = 6.0\n[ground]\nkind = \"platform\"\npitch = [[0.0, 0.0], [3.0, 6.0], [6.0, 0.0]]\n",
    );
    assert!(ship.contains("turns"), "{ship}");
}

#[test]
fn a_walk_that_is_pushed_is_looped_after_it_has_recovered() {
    let rig = &builtin();
    let text = "title = \"pushed\"\nduration = 10.0\n[[walk]]\nstart = 0.3\nspeed = 1.0\n[[push]]\nstart = 2.0\nduration = 0.2\nforce = 150.0\ntoward = \"left\"\nat = \"chest\"\n";
    let baked = bake(rig, &scenario(text), &looped(RootMotion::Root)).expect("it loops");
    check("pushed", rig, &baked);
    assert!(
        baked.report.disturbances.is_empty() && baked.report.events.iter().all(|event| event.name.starts_with("foot"))
    );
    // What pulls all the while is part of it.
    let text = "title = \"drag\"\nduration = 9.0\n[[walk]]\nstart = 0.3\nspeed = 1.0\n[[pull]]\nstart = 0.0\nduration = 9.0\nforce = 50.0\ntoward = \"back\"\nat = \"hips\"\n";
    let baked = bake(rig, &scenario(text), &looped(RootMotion::Root)).expect("it loops");
    check("drags 50 N", rig, &baked);
    let pulled: Vec<_> = baked.report.disturbances.iter().map(|one| (one.kind.as_str(), one.start, one.end)).collect();
    assert_eq!(pulled, [("pull", 0.0, baked.report.duration)]);
}

#[test]
fn a_slope_and_a_turned_walk_loop_along_their_own_way() {
    let rig = &builtin();
    let slope = "title = \"slope\"\nduration = 8.0\n[ground]\nkind = \"slope\"\nangle = 8.0\n[[walk]]\nstart = 0.3\nspeed = 1.0\n";
    let baked = bake(rig, &scenario(slope), &looped(RootMotion::Root)).expect("it loops");
    check("slope", rig, &baked);
    let way = rig.sample(&baked.clip, baked.clip.duration).hips - rig.sample(&baked.clip, 0.0).hips;
    assert!((way.y / way.z - 8.0_f64.to_radians().tan()).abs() < 1e-3, "{way}");
    let turned = "title = \"turned\"\nduration = 9.0\n[[walk]]\nstart = 0.3\nspeed = 1.0\nheading = 90.0\n";
    let baked = bake(rig, &scenario(turned), &looped(RootMotion::Root)).expect("it loops");
    check("turned", rig, &baked);
    let way = rig.sample(&baked.clip, baked.clip.duration).hips - rig.sample(&baked.clip, 0.0).hips;
    assert!(way.z > 0.5 && way.x.abs() < 0.02, "it walks ahead in its clip: {way}");
}

#[test]
fn a_base_clips_own_cycle_is_the_loop() {
    let Some(file) = data::file("rigs/m2m_human_base_animations.glb") else { return };
    let rig = load(&file).expect("the rig loads");
    let clips = mocap::load(&file).expect("its clips load");
    for (clip, seconds) in [("Walk_Loop", 10.0), ("Idle_Loop", 12.0)] {
        let scenario = scenario(&format!("title = \"{clip}\"\nduration = {seconds:.1}\n[base]\nclip = \"{clip}\"\n"));
        let index = clips.find(clip).expect("the clip is there");
        let reading = clips.reading(index, &mocap::Options::default()).expect("it reads");
        let base = prepare(&rig, &scenario, &reading, Some(index)).unwrap_or_else(|error| panic!("{clip}: {error}"));
        let options = BakeOptions { base: Some(Arc::new(base)), ..looped(RootMotion::Root) };
        let baked = bake(&rig, &scenario, &options).unwrap_or_else(|error| panic!("{clip}: {error}"));
        // A base clip's own sinking and pops are not the loop's.
        check_seam(clip, &rig, &baked);
        println!("   base {:?}, named {}", baked.report.base, baked.clip.name);
        let found = baked.report.looped.as_ref().expect("it is a loop");
        let whole = if clip == "Walk_Loop" { 4.0 / 3.0 } else { 2.5 };
        assert!((found.period - whole).abs() < 1e-3, "the cycle is the clip's own: {found:?}");
        assert!(found.evened_deg < 2.0 && found.evened_mm < 10.0, "and so is its seam: {found:?}");
        leave(&rig, &baked, &format!("m2m {clip}"), Some("m2m_human_base_animations.glb"));
    }
}

#[test]
fn the_same_loop_comes_out_twice() {
    let rig = &builtin();
    let once = || bake(rig, &walk(rig, WALKS[1]), &looped(RootMotion::Root)).expect("it loops");
    let (one, other) = (once(), once());
    assert_eq!(one.clip, other.clip);
    assert_eq!(one.report, other.report);
}
