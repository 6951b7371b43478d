//! Clips x bodies retargeted, and what came out: for the test and the bench.

#![allow(dead_code)] // a bench and a test use their part

use glam::DVec3;
use std::path::Path;
use surefoot::measure::feet::feet;
use surefoot::measure::joints::joints;
use surefoot::measure::support::held_points;
use surefoot::measure::{Frame, HeldContact, Motion, Track};
use surefoot::mocap::retarget::{belt, planted_parts};
use surefoot::mocap::{Options, load};
use surefoot::model::{Body, BodyPose, Capture, Role};
use surefoot::rig;

/// Clip files of the data.
pub const FILES: [&str; 7] = [
    "clips/cmu_02_01_walk.bvh",
    "clips/cmu_12_01_walk.bvh",
    "clips/pab_walk.fbx",
    "clips/makehuman_walk1.bvh",
    "rigs/threevrm_test.vrma",
    "rigs/m2m_human_base_animations.glb",
    "rigs/kaykit_Knight.glb",
];

/// What came out of one clip on one body.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub pieces: usize,
    pub slip: f64,      // mm, level
    pub slip3: f64,     // mm, by the measures' own definition
    pub trunk: f64,     // degrees between the trunks, at worst
    pub source: f64,    // mm, the source's own slip in the same pieces
    pub sink: f64,      // mm, in pieces
    pub float: f64,     // mm, in pieces
    pub under: f64,     // mm, anywhere
    pub arms: f64,      // degrees
    pub legs: [f64; 2], // degrees, mean and worst
    pub knees: f64,     // degrees past straight
    pub pops: [usize; 2],
    pub shake: f64, // m/s2: how much more the pelvis accelerates up and down than the source's, at worst
    pub worst: (f64, usize),
}

pub fn poses(capture: &Capture) -> Vec<BodyPose> {
    (0..capture.frames())
        .map(|frame| BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() })
        .collect()
}

pub const ARMS: [(Role, Role); 4] = [
    (Role::LeftUpperArm, Role::LeftLowerArm),
    (Role::LeftLowerArm, Role::LeftHand),
    (Role::RightUpperArm, Role::RightLowerArm),
    (Role::RightLowerArm, Role::RightHand),
];
pub const LEGS: [(Role, Role); 4] = [
    (Role::LeftUpperLeg, Role::LeftLowerLeg),
    (Role::LeftLowerLeg, Role::LeftFoot),
    (Role::RightUpperLeg, Role::RightLowerLeg),
    (Role::RightLowerLeg, Role::RightFoot),
];

/// Degrees between a limb's directions in both captures.
pub fn off(one: &Capture, other: &Capture, frame: usize, (from, to): (Role, Role)) -> f64 {
    let along = |capture: &Capture| {
        let joint = |role| capture.body.joint(role).expect("a limb");
        // What no node moves, the body's own turns say.
        let (a, b) = (joint(from), joint(to));
        capture.turns_at(frame)[a] * (capture.body.joints[b].rest - capture.body.joints[a].rest)
    };
    along(one).angle_between(along(other)).to_degrees()
}

pub fn measured(source: &Capture, target: &Capture) -> Row {
    let parts = planted_parts(source);
    let scale = target.body.leg_length / source.body.leg_length;
    let held = |floors: bool| -> Vec<HeldContact> {
        parts
            .iter()
            .map(|(planted, part, height)| HeldContact {
                side: planted.side,
                part: *part,
                start: planted.start as f64 / source.fps,
                end: planted.end as f64 / source.fps,
                point: DVec3::Y * if floors { height * scale } else { 0.0 },
                normal: DVec3::Y,
                frame: Frame::World,
            })
            .collect()
    };
    let (before, after) = (poses(source), poses(target));
    let motion = |body, poses| Motion { body, hz: source.fps, per_frame: 1, poses };
    let track = Track::new(motion(&target.body, &after)).expect("sound");
    let own = Track::new(motion(&source.body, &before)).expect("sound");
    let contacts = held(true);
    let (now, was) = (feet(&track, &contacts), feet(&own, &held(false)));
    let angles = [joints(&own), joints(&track)];
    let mut row = Row {
        pieces: parts.len(),
        slip3: now.slip_max_mm,
        source: was.slip_max_mm,
        float: now.float_max_mm,
        under: now.penetration_max_mm,
        knees: angles[1].knee_past_straight.to_degrees(),
        pops: [angles[0].pops.len(), angles[1].pops.len()],
        ..Row::default()
    };
    let belt = belt(source).unwrap_or(DVec3::ZERO) * scale;
    for (planted, part, height) in &parts {
        for held in held_points(&target.body, planted.side, *part) {
            let place = |frame: usize| {
                let passed = belt * (frame as f64 / source.fps);
                (target.rigid_point(frame, held.joint, held.offset) - passed) * DVec3::new(1.0, 0.0, 1.0)
            };
            let first = place(planted.start);
            for frame in planted.start..=planted.end {
                row.slip = row.slip.max(1000.0 * place(frame).distance(first));
            }
        }
        let sole = |frame: usize| {
            let pose = &after[frame];
            let (rear, front) = pose.sole(&target.body, target.at(frame), planted.side);
            rear.into_iter().chain(front).map(|vertex| vertex.y).fold(f64::INFINITY, f64::min)
        };
        for frame in planted.start..=planted.end {
            row.sink = row.sink.max(1000.0 * (height * scale - sole(frame)));
        }
    }
    let mut count = 0.0;
    for frame in 0..source.frames() {
        let trunk = |capture: &Capture| {
            let at = |role: Role| capture.at(frame)[capture.body.joint(role).expect("a limb")];
            at(Role::LeftUpperArm) + at(Role::RightUpperArm) - at(Role::LeftUpperLeg) - at(Role::RightUpperLeg)
        };
        row.trunk = row.trunk.max(trunk(source).angle_between(trunk(target)).to_degrees());
        for limb in ARMS {
            row.arms = row.arms.max(off(source, target, frame, limb));
        }
        for limb in LEGS {
            let off = off(source, target, frame, limb);
            row.legs[0] += off;
            count += 1.0;
            if off > row.legs[1] {
                row.legs[1] = off;
                row.worst = (off, frame);
            }
        }
    }
    row.legs[0] /= count;
    let square = source.fps * source.fps;
    for frame in 1..source.frames() - 1 {
        let bend = |capture: &Capture, scale: f64| {
            let leg = |frame: usize, role: Role| capture.at(frame)[capture.body.joint(role).expect("a leg")].y;
            let y = |frame: usize| 0.5 * (leg(frame, Role::LeftUpperLeg) + leg(frame, Role::RightUpperLeg));
            (y(frame + 1) - 2.0 * y(frame) + y(frame - 1)) * scale * square
        };
        row.shake = row.shake.max((bend(target, 1.0) - bend(source, scale)).abs());
    }
    row
}

pub fn clips(data: &Path, file: &str, wanted: &dyn Fn(&str) -> bool) -> Vec<Capture> {
    let file = load(&data.join(file)).expect("a clip file");
    (0..file.clips.len())
        .filter(|index| wanted(&file.clips[*index]))
        .filter_map(|index| file.capture(index, &Options::default()).ok())
        .collect()
}

pub fn bodies(data: &Path) -> Vec<(&'static str, Body)> {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let own = rig::load_bytes("builtin", rig::mannequin::BUILTIN, &alone, None).expect("the built-in rig loads");
    let mut bodies = vec![("builtin", own.body)];
    for name in [
        "m2m_human_male.glb",
        "gdquest_mannequiny.glb",
        "kaykit_Knight.glb",
        "godette_vrm0.vrm",
        "sketchbook_boxman.glb",
    ] {
        bodies.push((name, rig::load(&data.join("rigs").join(name)).expect("a rig").body));
    }
    bodies
}

/// One line of the table.
pub fn line(clip: &str, body: &str, row: &Row) -> String {
    format!(
        "  {clip:24.24} {body:14.14} {:3} pieces slip {:5.2} {:6.2} ({:6.1}) sink {:5.2} float {:6.2} under {:6.1} trunk {:4.1} arms {:4.2} legs {:5.2} {:5.1}@{:4} knee {:4.2} pops {:2}/{:2} shake {:6.2}",
        row.pieces,
        row.slip,
        row.slip3,
        row.source,
        row.sink,
        row.float,
        row.under,
        row.trunk,
        row.arms,
        row.legs[0],
        row.legs[1],
        row.worst.1,
        row.knees,
        row.pops[0],
        row.pops[1],
        row.shake
    )
}
