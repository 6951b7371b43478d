//! leg_scale: legs of any length, in the file, in the controller, in the limits. `--nocapture` prints what was measured.

#![expect(clippy::print_stdout, reason = "tests tell what they measured")]

use crate::common::builtin;
use crate::export::{json_of, reads_back};
use crate::lanes::{baked, feet_hold, few, written};
use crate::limits_grid::{EIGHT, Measured, measured_by, rigs, shove};
use crate::synthetic;
use rayon::prelude::*;
use surefoot::bake::{BakeOptions, Baked};
use surefoot::export::glb_with_props;
use surefoot::model::report::Outcome;
use surefoot::model::scenario::Scenario;
use surefoot::model::{Body, Role};
use surefoot::rig::mannequin::{MannequinOptions, mannequin};
use surefoot::rig::{Rig, load_bytes};

fn on_legs(rig: &Rig, scale: f64) -> Scenario {
    let mut scenario = shove(&rig.body.with_leg_scale(scale), 270.0, 60.0);
    scenario.title = format!("legs {scale}");
    scenario.character.leg_scale = scale;
    scenario
}

/// m, the farthest that a joint of the legs, any joint, and any at time 0, of the file (read with the rig as it was loaded)
/// is from where the pose says.
fn farthest(rig: &Rig, baked: &Baked) -> [(f64, &'static str); 3] {
    let timeline = &baked.performance.timeline;
    let longer = rig.with_leg_scale(timeline.body.leg_length / rig.body.leg_length);
    let bind = longer.bind_globals();
    let mut sampler = rig.sampler(&baked.clip);
    let mut worst = [(0.0, ""); 3];
    for key in 0..=(baked.clip.duration * baked.clip.fps) as usize {
        let time = key as f64 / baked.clip.fps;
        let pose = timeline.pose_at(time);
        let positions = pose.positions(&timeline.body);
        let globals = sampler.node_globals(time);
        for (joint, node) in rig.joint_nodes.iter().enumerate() {
            let Some(node) = node.filter(|_| rig.body.joints[joint].animated) else { continue };
            let offset = bind[node].translation - timeline.body.joints[joint].rest;
            let off = globals[node].translation.distance(positions[joint] + pose.turns[joint] * offset);
            let off = off * (1.7 / timeline.body.height).min(1.0);
            let name = rig.body.joints[joint].role.name();
            let of_leg = ["hips", "Leg", "Foot", "Toes"].iter().any(|part| name.contains(part));
            for (worst, counts) in worst.iter_mut().zip([of_leg, true, key == 0]) {
                if counts && off > worst.0 {
                    *worst = (off, name);
                }
            }
        }
    }
    worst
}

#[test]
fn a_file_on_longer_or_shorter_legs_has_its_joints_where_the_pose_has_them() {
    let made = synthetic::troubles().into_iter().map(|(name, trouble)| (name.to_owned(), synthetic::rig(trouble)));
    let all: Vec<(String, Rig)> = rigs().into_iter().chain(made).collect();
    let cells: Vec<(&(String, Rig), f64)> = all.iter().flat_map(|rig| [0.7, 1.3].map(|scale| (rig, scale))).collect();
    let lines: Vec<(String, [f64; 3])> = cells
        .par_iter()
        .map(|((name, rig), scale)| {
            let baked = baked(rig, &on_legs(rig, *scale));
            let [(leg, of_leg), (off, joint), (first, _)] = farthest(rig, &baked);
            let line = format!("{name} x {scale}: {:.3} mm at {of_leg}, {:.3} mm at {joint}", leg * 1e3, off * 1e3);
            (line, [leg, off, first])
        })
        .collect();
    for (line, _) in &lines {
        println!("{line}");
    }
    for (line, [leg, off, first]) in &lines {
        // Keys are thinned: 0.1 degrees in every joint of the upper body are millimetres at the tip of a finger. At time 0
        // everything has its key.
        assert!(*first < 0.2e-3 && *leg < 2e-3 && *off < 7e-3, "{line}, {:.4} mm at the start", first * 1e3);
    }
}

#[test]
fn legs_grow_and_feet_and_trunk_do_not() {
    for (name, rig) in few() {
        for scale in [0.25, 0.7, 1.3, 4.0] {
            let scenario = Scenario { push: Vec::new(), duration: 1.0, ..on_legs(&rig, scale) };
            let baked = baked(&rig, &scenario);
            let place = |role: Role, scaled: bool| {
                let node = rig.joint_nodes[rig.body.joint(role)?].filter(|node| *node < rig.nodes.len())?;
                if scaled {
                    Some(rig.sampler(&baked.clip).node_globals(0.5)[node].translation)
                } else {
                    Some(rig.bind_globals()[node].translation)
                }
            };
            let ratio = |from: Role, to: Role| {
                let length = |scaled: bool| Some(place(from, scaled)?.distance(place(to, scaled)?));
                length(true).zip(length(false)).map(|(now, before)| now / before)
            };
            use Role::*;
            for (from, to) in [(LeftUpperLeg, LeftLowerLeg), (LeftLowerLeg, LeftFoot), (RightLowerLeg, RightFoot)] {
                let got = ratio(from, to).expect("it has legs");
                assert!((got / scale - 1.0).abs() < 2e-3, "{name} x {scale}: {} {got}", from.name());
            }
            for (from, to) in [(LeftFoot, LeftToes), (LeftUpperArm, LeftLowerArm), (Hips, Head)] {
                let Some(got) = ratio(from, to).filter(|_| from != Hips || name == "builtin") else { continue };
                let least = if from == Hips { 0.02 } else { 2e-3 }; // the spine bends
                assert!((got - 1.0).abs() < least, "{name} x {scale}: {} {got}", from.name());
            }
            assert!(baked.report.plausibility.slip_max_mm < 0.5, "{name} x {scale}: {:?}", baked.report.plausibility);
            assert!(baked.report.outcome == Outcome::Still, "{name} x {scale}: {:?}", baked.report.outcome);
        }
    }
}

#[test]
fn characters_on_other_legs_recover_and_keep_their_feet() {
    for (name, rig) in few() {
        for scale in [0.7, 1.3] {
            let baked = baked(&rig, &on_legs(&rig, scale));
            feet_hold(&format!("{name} x {scale}"), &baked);
            let file = written(&rig, &baked, &format!("legs_{scale}_{name}"));
            let scales = baked.clip.channels.iter().filter(|channel| channel.values.path() == "scale");
            let (json, _) = json_of(&file);
            let before = rig.document.json["nodes"].as_array().map_or(0, Vec::len);
            assert!(scales.clone().count() >= 4, "{name}: thighs and feet");
            assert!(scales.clone().all(|channel| channel.times == [0.0]), "{name}: they hold");
            for node in 0..before {
                let of = |json: &serde_json::Value| json["nodes"][node]["scale"].clone();
                assert_eq!(of(&json), of(&rig.document.json), "{name}: the document does not change");
            }
        }
    }
}

#[test]
fn legs_of_any_length_recover_as_often_as_the_rigs_own() {
    let rig = builtin();
    let share = |scale: f64| {
        let cells: Vec<(f64, f64)> =
            EIGHT.iter().flat_map(|way| [60.0, 100.0].map(|impulse| (*way, impulse))).collect();
        let up = |(way, impulse): &(f64, f64)| {
            let mut scenario = shove(&rig.body.with_leg_scale(scale), *way, *impulse);
            scenario.character.leg_scale = scale;
            let found = baked(&rig, &scenario);
            let plausible = &found.report.plausibility;
            let held = plausible.slip_max_mm < 2.0 && plausible.penetration_max_mm < 5.0;
            if !held {
                println!("x {scale}, {impulse} Ns to {way}: {:?} {:?}", found.report.outcome, plausible);
            }
            [found.report.outcome != Outcome::Fall, held]
        };
        let all: Vec<[bool; 2]> = cells.par_iter().map(up).collect();
        [0, 1].map(|which| all.iter().filter(|one| one[which]).count())
    };
    let own = share(1.0);
    for scale in [0.25, 0.5, 0.7, 1.3, 2.0, 4.0] {
        let [up, held] = share(scale);
        println!(
            "legs x {scale}: {up} of 16 stand, {held} of 16 keep their feet; the rig's own {} and {}",
            own[0], own[1]
        );
        if (0.7..=1.3).contains(&scale) {
            // Goal: as many. Feet do not grow with the legs: on 1.3, 100 Ns backwards is a lunge so deep that a trailing
            // foot is drawn along today, by 3.4 mm.
            let excused = usize::from(scale > 1.0);
            assert!(up >= own[0] && held + excused >= own[1], "x {scale}");
        }
    }
}

#[test]
fn a_clip_on_its_own_legs_has_no_scale() {
    let rig = builtin();
    let baked = baked(&rig, &shove(&rig.body, 0.0, 60.0));
    assert!(baked.clip.channels.iter().all(|channel| channel.values.path() != "scale"));
    reads_back(&rig, &baked.clip, &glb_with_props(&rig, &[(baked.clip.clone(), baked.report)], &[]).expect("ok").bytes);
}

#[test]
fn a_body_on_other_legs_weighs_the_same_and_stands_on_the_same_ground() {
    for (name, rig) in few() {
        for scale in [0.25, 1.3, 4.0] {
            let body: Body = rig.body.with_leg_scale(scale);
            let sum: f64 = body.segments.iter().map(|segment| segment.mass).sum();
            assert!((sum - rig.body.mass).abs() < 1e-9 && body.mass == rig.body.mass, "{name}");
            assert!((body.leg_length / rig.body.leg_length - scale).abs() < 1e-9, "{name}");
            let ankles = |body: &Body| body.feet.iter().map(|foot| body.joints[foot.ankle].rest.y).sum::<f64>();
            assert!((ankles(&body) - ankles(&rig.body)).abs() < 1e-9, "{name}: soles stay on the ground");
        }
    }
}

#[test]
fn no_foot_flies_off_on_odd_legs_that_step_twice_running() {
    let none = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let cells = [(1.7, 1.3, 135.0, 120.0), (1.0, 1.3, 135.0, 120.0), (1.0, 0.6, 135.0, 150.0), (1.0, 0.7, 45.0, 150.0)];
    let found = cells.par_iter().map(|(height, leg_scale, direction, impulse)| {
        let options = MannequinOptions { height: *height, leg_scale: *leg_scale, ..MannequinOptions::default() };
        let rig = load_bytes("odd.glb", &mannequin(&options), &none, None).expect("it loads");
        measured_by(&rig, *direction, *impulse, &BakeOptions::default())
    });
    for (cell, clip) in cells.iter().zip(found.collect::<Vec<Measured>>()) {
        println!("{cell:?}: {} steps, ankle {:.1} m/s", clip.steps, clip.ankle_speed);
        assert!(clip.steps >= 3, "{cell:?}: only {} steps, nothing to hold", clip.steps);
        // 34 to 137 m/s while a foot could leave before it had come down.
        assert!(clip.ankle_speed < 14.0, "{cell:?}: an ankle at {} m/s", clip.ankle_speed);
    }
}
