//! The measures against a measured walk: both feet on force plates (Rajagopal et al. 2016, `forces/` of the lab data).
//!
//! The walk's nodes become a body with de Leva's masses, as any rig's would; what it needs of the ground is held against
//! what the plates measured. Skipped where the data are not beside the package.

use crate::data;
use glam::{DQuat, DVec2, DVec3, dvec3};
use std::collections::BTreeMap;
use surefoot::measure::{self, HeldContact, Motion, Track, dynamics, support, zmp};
use surefoot::model::{Body, BodyPose, Role, Side, report::Part};
use surefoot::rig::body::{BodyInput, derive};

/// Document (X forward, Z right) to scenario (Z forward, X left).
fn scenario(point: DVec3) -> DVec3 {
    dvec3(-point.z, point.y, point.x)
}

struct Walk {
    body: Body,
    poses: Vec<BodyPose>,
    hz: f64,
}

/// A row of the force file: force and centre of pressure of left and right, whether each carries, and the model's own
/// centre of mass; scenario space.
struct Plate {
    force: [DVec3; 2],
    pressure: [DVec3; 2],
    carries: [bool; 2],
    com: DVec3,
}

fn plates(text: &str) -> Vec<Plate> {
    let row = |line: &str| -> Plate {
        let n: Vec<f64> = line.split(',').map(|field| field.trim().parse().expect("a number")).collect();
        let at = |i: usize| scenario(dvec3(n[i], n[i + 1], n[i + 2]));
        Plate { force: [at(1), at(7)], pressure: [at(4), at(10)], carries: [n[13] > 0.5, n[14] > 0.5], com: at(15) }
    };
    text.lines().skip(1).filter(|line| !line.is_empty()).map(row).collect()
}

/// The walk as a body and its poses, one a key.
fn walk(bytes: &[u8]) -> Walk {
    let file = gltf::Gltf::from_slice(bytes).expect("a GLB");
    let blob = file.blob.clone().expect("a BIN chunk");
    let nodes: Vec<gltf::Node> = file.nodes().collect();
    let mut parents = vec![None; nodes.len()];
    for node in &nodes {
        for child in node.children() {
            parents[child.index()] = Some(node.index());
        }
    }
    let named = |name: &str| nodes.iter().position(|node| node.name() == Some(name)).expect("a bone of the model");
    let rest: Vec<(DVec3, DQuat)> = nodes
        .iter()
        .map(|node| {
            let (t, r, _) = node.transform().decomposed();
            (dvec3(f64::from(t[0]), f64::from(t[1]), f64::from(t[2])), quat(r))
        })
        .collect();
    let animation = file.animations().next().expect("an animation");
    let mut keys: Vec<Vec<(DVec3, DQuat)>> = Vec::new();
    let mut duration = 0.0;
    for channel in animation.channels() {
        let reader = channel.reader(|_| Some(&blob));
        let times: Vec<f32> = reader.read_inputs().expect("times").collect();
        keys.resize(times.len(), rest.clone());
        duration = f64::from(times[times.len() - 1]);
        let node = channel.target().node().index();
        match reader.read_outputs().expect("values") {
            gltf::animation::util::ReadOutputs::Translations(values) => {
                for (frame, v) in keys.iter_mut().zip(values) {
                    frame[node].0 = dvec3(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
                }
            }
            gltf::animation::util::ReadOutputs::Rotations(values) => {
                for (frame, v) in keys.iter_mut().zip(values.into_f32()) {
                    frame[node].1 = quat(v);
                }
            }
            _ => {}
        }
    }
    let world = |local: &[(DVec3, DQuat)]| -> Vec<(DVec3, DQuat)> {
        let mut out: Vec<(DVec3, DQuat)> = Vec::new();
        for (index, (t, r)) in local.iter().enumerate() {
            out.push(match parents[index] {
                Some(parent) => (out[parent].0 + out[parent].1 * *t, out[parent].1 * *r),
                None => (*t, *r),
            });
        }
        out
    };
    let bind = world(&rest);
    // Points rigid with a node that stand for the joints of a humanoid: the hips' middle, the neck and the skull's base
    // on the trunk.
    let hips = (bind[named("femur_l")].0 + bind[named("femur_r")].0) * 0.5;
    let shoulders = (bind[named("humerus_l")].0 + bind[named("humerus_r")].0) * 0.5;
    let mut places: Vec<(Role, &str, DVec3)> = vec![
        (Role::Hips, "pelvis", hips),
        (Role::Spine, "torso", bind[named("torso")].0),
        (Role::Neck, "torso", shoulders + dvec3(0.0, 0.05, 0.0)),
        (Role::Head, "torso", shoulders + dvec3(0.02, 0.13, 0.0)),
    ];
    let limbs: [(Role, &str, &str); 7] = [
        (Role::LeftUpperArm, "humerus", "humerus"),
        (Role::LeftLowerArm, "ulna", "ulna"),
        (Role::LeftHand, "hand", "hand"),
        (Role::LeftUpperLeg, "femur", "femur"),
        (Role::LeftLowerLeg, "tibia", "tibia"),
        (Role::LeftFoot, "talus", "calcn"),
        (Role::LeftToes, "toes", "toes"),
    ];
    let names: Vec<(Role, String, String)> = Side::BOTH
        .iter()
        .flat_map(|side| {
            limbs.map(|(role, place, turn)| {
                let (role, end) = if *side == Side::Left { (role, "_l") } else { (role.mirrored(), "_r") };
                (role, format!("{place}{end}"), format!("{turn}{end}"))
            })
        })
        .collect();
    places.extend(names.iter().map(|(role, place, turn)| (*role, turn.as_str(), bind[named(place)].0)));
    // The ground under the soles: the toes' and heels' origins lie about 1.5 cm over them.
    let lowest = places.iter().map(|place| place.2.y).fold(f64::INFINITY, f64::min) - 0.015;
    let bones: BTreeMap<Role, (usize, DVec3)> =
        places.iter().map(|(role, node, place)| (*role, (named(node), scenario(*place - DVec3::Y * lowest)))).collect();
    let derived = derive(&BodyInput { bones: &bones, mesh: &[], parents: &parents, mass: Some(85.1) });
    let to_scenario = DQuat::from_rotation_y(-std::f64::consts::FRAC_PI_2);
    let poses = keys
        .iter()
        .map(|local| {
            let now = world(local);
            let turn = |node: usize| to_scenario * (now[node].1 * bind[node].1.inverse()) * to_scenario.inverse();
            let pelvis = named("pelvis");
            let hips_now = now[pelvis].0 + now[pelvis].1 * (bind[pelvis].1.inverse() * (hips - bind[pelvis].0));
            let mut turns: Vec<DQuat> = Vec::new();
            for (index, node) in derived.joint_nodes.iter().enumerate() {
                let inherited = derived.body.joints[index].parent.map_or(DQuat::IDENTITY, |parent| turns[parent]);
                turns.push(node.map_or(inherited, turn));
            }
            BodyPose { hips: scenario(hips_now), turns }
        })
        .collect();
    Walk { body: derived.body, hz: (keys.len() - 1) as f64 / duration, poses }
}

fn quat(r: [f32; 4]) -> DQuat {
    DQuat::from_xyzw(f64::from(r[0]), f64::from(r[1]), f64::from(r[2]), f64::from(r[3])).normalize()
}

/// Spans of time in which a foot carries.
fn contacts(plates: &[Plate], hz: f64) -> Vec<HeldContact> {
    let mut out = Vec::new();
    for side in Side::BOTH {
        let mut from = None;
        for index in 0..=plates.len() {
            let carries = plates.get(index).is_some_and(|plate| plate.carries[side as usize]);
            match (from, carries) {
                (None, true) => from = Some(index),
                (Some(start), false) => {
                    let (start, end) = (start as f64 / hz, (index - 1) as f64 / hz);
                    out.push(HeldContact {
                        side,
                        part: Part::Flat,
                        start,
                        end,
                        point: DVec3::ZERO,
                        normal: DVec3::Y,
                        frame: measure::Frame::World,
                    });
                    from = None;
                }
                _ => {}
            }
        }
    }
    out
}

/// The walk and its plates, where the folder of third-party data is there.
#[track_caller]
fn load() -> Option<(Walk, Vec<Plate>)> {
    let folder = data::folder()?.join("forces");
    let read = |name: &str| std::fs::read(folder.join(name)).expect("the folder of third-party data is whole");
    let (bytes, text) = (read("rajagopal_walk.glb"), read("rajagopal_walk_forces.csv"));
    let (walk, plates) = (walk(&bytes), plates(&String::from_utf8_lossy(&text)));
    assert_eq!(walk.poses.len(), plates.len());
    Some((walk, plates))
}

#[test]
fn the_ground_force_and_pressure_of_a_measured_walk_are_found() {
    let Some((walk, plates)) = load() else { return };
    let motion = Motion { body: &walk.body, hz: walk.hz, per_frame: 1, poses: &walk.poses };
    let track = Track::new(motion).expect("sound");
    let found = dynamics::dynamics(&track, &[]);
    let contacts = contacts(&plates, walk.hz);
    let weight = walk.body.mass * measure::GRAVITY;
    let (mut force_error, mut pressure_error, mut pressure_worst, mut com_error) = (0.0, 0.0, 0.0_f64, 0.0);
    let (mut frames, mut single) = (0.0, 0.0);
    // The ends are left out: what the motion was before them no filter knows.
    for (index, plate) in plates.iter().enumerate().take(plates.len() - 12).skip(12) {
        let measured = plate.force[0] + plate.force[1];
        force_error += (found.needed[index].force - measured).length_squared();
        com_error += (found.com[index] - plate.com).length_squared();
        frames += 1.0;
        if plate.carries[0] != plate.carries[1] {
            let side = usize::from(plate.carries[1]);
            let support = support::support(&track, &contacts, index).expect("in contact");
            let at = zmp::zmp(&support, found.needed[index], found.com[index], weight);
            let off = at.distance(DVec2::new(plate.pressure[side].x, plate.pressure[side].z));
            pressure_error += off * off;
            pressure_worst = pressure_worst.max(off);
            single += 1.0;
        }
    }
    let force_rms = (force_error / frames).sqrt() / weight;
    let pressure_rms = (pressure_error / single).sqrt();
    let com_rms = (com_error / frames).sqrt();
    eprintln!(
        "measured walk: force off by {force_rms:.3} body weights RMS, pressure by {:.1} mm RMS ({:.1} at most) over \
         {single} frames of single support, centre of mass by {:.1} mm",
        1000.0 * pressure_rms,
        1000.0 * pressure_worst,
        1000.0 * com_rms
    );
    assert!(single > 40.0, "{single} frames of single support");
    assert!(force_rms < 0.06, "{force_rms} body weights");
    assert!(pressure_rms < 0.035, "{pressure_rms} m");
}

#[test]
fn a_measured_walk_needs_next_to_nothing_that_the_ground_does_not_give_and_a_bent_one_does() {
    let Some((walk, plates)) = load() else { return };
    let contacts = contacts(&plates, walk.hz);
    let measured = |poses: &[BodyPose]| {
        let motion = Motion { body: &walk.body, hz: walk.hz, per_frame: 1, poses };
        measure::measure(motion, &contacts, &[], 1.0).expect("sound")
    };
    let told = |name: &str, found: &measure::Findings| {
        eprintln!(
            "{name}: ZMP inside {:.0} %, p95 out {:.1} cm, residual {:.3} weights and {:.4} weight x height, friction \
             p99 {:.2}, vertical min {:.2}, ankle {:.1} m/s, legs {:.0} mm, knee past straight {:.1} deg, {} limits, {} pops, score {:.2}",
            100.0 * found.zmp.inside,
            found.zmp.outside_p95_cm,
            found.residual_force,
            found.residual_moment,
            found.friction_p99,
            found.vertical_min,
            found.feet.peak_ankle_speed,
            1000.0 * found.feet.least_leg_distance,
            found.joints.knee_past_straight.to_degrees(),
            found.joints.excesses.len(),
            found.joints.pops.len(),
            found.plausibility().score
        );
        for excess in &found.joints.excesses {
            eprintln!("  {:?}", excess);
        }
    };
    let real = measured(&walk.poses);
    told("as measured", &real);
    // The pelvis and all above it 20 cm to the left in the middle third, eased in and out.
    let count = walk.poses.len() as f64;
    let mut bent = walk.poses.clone();
    for (index, pose) in bent.iter_mut().enumerate() {
        let u = ((index as f64 / count - 0.25) / 0.5).clamp(0.0, 1.0);
        pose.hips.x += 0.20 * 16.0 * u * u * (1.0 - u) * (1.0 - u);
    }
    let bent = measured(&bent);
    told("pelvis moved 20 cm", &bent);
    assert!(real.residual_force < 0.05 && real.residual_moment < 0.02);
    assert!(real.joints.pops.is_empty(), "{:?}", real.joints.pops);
    assert!(bent.plausibility().score < real.plausibility().score - 0.1);
    assert!(bent.residual_moment + bent.residual_force > 2.0 * (real.residual_moment + real.residual_force));
}
