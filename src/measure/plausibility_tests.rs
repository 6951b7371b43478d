//! The measures together: what costs the score, what does not, what cannot be measured.

use super::dynamics::dynamics;
use super::support::support;
use super::{GRAVITY, KnownPush, PushPoint, Track, fixture, measure, plausibility, zmp};
use crate::maths::real;
use crate::model::{Side, report::Plausibility};
use glam::DVec3;
use std::f64::consts::TAU;

#[test]
fn a_still_stand_is_beyond_reproach() {
    let body = fixture::body();
    let poses = fixture::poses(&body, 240, |_, _| {});
    let found = measure(fixture::motion(&body, &poses), &fixture::standing(), &[], 1.0).expect("sound");
    assert!(found.residual_force < 1e-9 && found.residual_moment < 1e-9);
    assert!((found.vertical_min - 1.0).abs() < 1e-9);
    assert!(found.joints.excesses.is_empty() && found.joints.pops.is_empty(), "{:?}", found.joints);
    assert!(!found.balance.moved && found.balance.recovered && found.balance.rest_from == Some(0.0));
    // Inside by how far the projection of the centre of mass is from the edge.
    let com = fixture::com(&body);
    let depth = (0.145 - com.x.abs()).min(com.z + 0.06).min(0.19 - com.z);
    assert!(found.zmp_distances.iter().all(|d| (d.expect("in contact") + depth).abs() < 1e-6));
    let report = found.plausibility();
    assert!((report.score - 1.0).abs() < 1e-9 && report.notes.is_empty(), "{report:?}");
}

/// A body that rides the linear pendulum of a pressure that goes to `reach` and back along X, smoothly.
fn pendulum(reach: f64) -> (crate::model::Body, Vec<crate::model::BodyPose>, Vec<f64>) {
    let body = fixture::body();
    let height = fixture::com(&body).y;
    let omega_squared = GRAVITY / height;
    // c = A sin² gives p = c - c''/ω².
    let w = TAU * 0.4;
    let along = |time: f64| (0.5 - 0.5 * real::cos(w * time), 0.5 * w * w * real::cos(w * time));
    let scale = reach / (1.0 + w * w / (2.0 * omega_squared));
    let poses = fixture::poses(&body, 601, |pose, sample| pose.hips.x += scale * along(sample / 120.0).0);
    let pressure =
        (0..601).map(|sample| along(f64::from(sample) / 120.0)).map(|(c, a)| scale * (c - a / omega_squared)).collect();
    (body, poses, pressure)
}

#[test]
fn a_pendulums_own_pressure_is_found_within_2_mm() {
    let (body, poses, pressure) = pendulum(0.3);
    let motion = fixture::motion(&body, &poses);
    let track = Track::new(motion).expect("sound");
    let dynamics = dynamics(&track, &[]);
    let z = fixture::com(&body).z;
    // It starts in mid-acceleration, which the padding of a filter cannot know: a quarter of a second is left out.
    for (sample, pressure) in pressure.iter().enumerate().take(track.len() - 30).skip(30) {
        let support = support(&track, &fixture::standing(), sample).expect("in contact");
        let found = zmp::zmp(&support, dynamics.needed[sample], dynamics.com[sample], body.mass * GRAVITY);
        assert!((found.x - pressure).abs() < 0.002, "{sample}: {found} against {pressure}");
        assert!((found.y - z).abs() < 0.002, "{sample}: {found}");
    }
}

#[test]
fn keys_at_30_fps_joined_by_straight_lines_show_the_same_pressure() {
    let (body, poses, pressure) = pendulum(0.3);
    let keyed: Vec<_> = (0..poses.len())
        .map(|sample| {
            let (from, u) = (sample - sample % 4, (sample % 4) as f64 / 4.0);
            let mut pose = poses[sample].clone();
            pose.hips = poses[from].hips.lerp(poses[(from + 4).min(poses.len() - 1)].hips, u);
            pose
        })
        .collect();
    let motion = fixture::motion(&body, &keyed);
    let track = Track::new(motion).expect("sound");
    let dynamics = dynamics(&track, &[]);
    for (sample, pressure) in pressure.iter().enumerate().take(track.len() - 30).skip(30) {
        let support = support(&track, &fixture::standing(), sample).expect("in contact");
        let found = zmp::zmp(&support, dynamics.needed[sample], dynamics.com[sample], body.mass * GRAVITY);
        assert!((found.x - pressure).abs() < 0.004, "{sample}: {found} against {pressure}");
    }
}

#[test]
fn a_stand_on_two_stairs_is_carried_and_one_past_them_is_not() {
    let body = fixture::body();
    let mut contacts = fixture::standing();
    contacts[1].point.y = 0.17;
    let at = |shift: f64| {
        let poses = fixture::poses(&body, 240, |pose, sample| {
            let u = (sample / 120.0).clamp(0.0, 1.0);
            pose.hips.x += shift * (3.0 * u * u - 2.0 * u * u * u);
            for side in Side::BOTH {
                let hip = body.feet[side as usize].ankle - 2;
                let ankle = body.joints[hip + 2].rest;
                let hip_now = body.joints[hip].rest + (pose.hips - body.joints[0].rest);
                pose.turns[hip] = glam::DQuat::from_rotation_arc(-DVec3::Y, (ankle - hip_now).normalize());
                pose.turns[hip + 1] = pose.turns[hip];
            }
        });
        measure(fixture::motion(&body, &poses), &contacts, &[], 1.0).expect("sound")
    };
    assert!(at(0.02).residual_moment < 1e-6 && at(0.02).zmp.inside == 1.0, "{:?}", at(0.02).zmp);
    assert!(at(0.30).zmp.inside < 0.95 && at(0.30).zmp.outside_max_cm > 3.0, "{:?}", at(0.30).zmp);
}

/// A bad clip that has come to rest at its end: it slips, leans out of its feet, crosses its legs, jerks an arm, hovers.
fn faulty(seconds: f64) -> (crate::model::Body, Vec<crate::model::BodyPose>) {
    let body = fixture::body();
    let hip = body.feet[0].ankle - 2;
    let arm = body.joint(crate::model::Role::LeftUpperArm).expect("an arm");
    let poses = fixture::poses(&body, (120.0 * seconds) as usize + 1, |pose, sample| {
        let time = sample / 120.0;
        let ease = |from: f64, to: f64| {
            let u = ((time - from) / (to - from)).clamp(0.0, 1.0);
            u * u * (3.0 - 2.0 * u)
        };
        pose.hips +=
            DVec3::new(0.3 * ease(0.5, 1.0) - 0.28 * ease(1.3, 2.0), -0.02 * ease(0.5, 0.6), 0.1 * ease(0.5, 0.7));
        let cross = glam::DQuat::from_rotation_z(-0.6 * ease(0.8, 1.2) + 0.25 * ease(1.3, 2.0));
        (hip..hip + 4).for_each(|joint| pose.turns[joint] = cross);
        let bend = -3.3 * ease(0.9, 1.1) + if time > 1.5 { 0.4 } else { 0.0 } + 2.9 * ease(1.7, 2.3);
        (arm..arm + 3).for_each(|joint| pose.turns[joint] = glam::DQuat::from_rotation_x(bend));
    });
    (body, poses)
}

#[test]
fn seconds_of_stillness_at_the_end_make_no_measure_and_no_score_better() {
    let contacts = [
        fixture::flat(Side::Left, 0.0, 0.6),
        fixture::flat(Side::Right, 0.0, 1.0),
        fixture::flat(Side::Left, 1.2, 99.0),
        fixture::flat(Side::Right, 1.3, 99.0),
    ];
    let push = KnownPush { start: 0.5, end: 0.7, force: DVec3::X * 100.0, at: PushPoint::Centre };
    let told = |seconds: f64| {
        let (body, poses) = faulty(seconds);
        plausibility(fixture::motion(&body, &poses), &contacts, &[push], 0.2)
    };
    // It must end still, lest the stillness come with a jerk of its own.
    let (clip, padded) = (told(3.0), told(9.0));
    let terms = |p: &Plausibility| {
        [
            ("zmp_inside", 1.0 - p.zmp_inside),
            ("zmp_outside_p95_cm", p.zmp_outside_p95_cm),
            ("residual_force", p.residual_force),
            ("residual_moment", p.residual_moment),
            ("friction_p99", p.friction_p99),
            ("vertical_min", -p.vertical_min),
            ("slip_max_mm", p.slip_max_mm),
            ("penetration_max_mm", p.penetration_max_mm),
            ("peak_ankle_speed", p.peak_ankle_speed),
            ("speed_beyond", p.speed_beyond),
            ("hover_s", p.hover_s),
            ("hover_longest_s", p.hover_longest_s),
            ("legs_mm", -p.legs_mm),
            ("joint_excess_deg", p.joint_excess_deg),
            ("joint_excess_share", p.joint_excess_share),
            ("pops_deg", p.pops_deg),
            ("end_stance_mm", p.end_stance_mm),
            ("score", -p.score),
        ]
    };
    for ((name, before), (_, after)) in terms(&clip).into_iter().zip(terms(&padded)) {
        assert!(after >= before - 1e-6, "{name} is {before} and with 6 s of stillness {after}");
    }
    assert!((padded.score - clip.score).abs() < 1e-4 && clip.score < 0.1, "{clip:?}");
    // Each of them says something here.
    let good = Plausibility { zmp_inside: 1.0, vertical_min: 1.0, legs_mm: 200.0, ..Plausibility::default() };
    for ((name, is), (_, good)) in terms(&clip).into_iter().zip(terms(&good)).take(17) {
        assert!(is > good + 1e-6, "{name} is {is}");
    }
}

#[test]
fn a_stand_that_nothing_could_hold_is_seen_although_nothing_moves() {
    let body = fixture::body();
    let lean = |angle: f64| {
        let poses = fixture::poses(&body, 240, |pose, _| {
            let turn = glam::DQuat::from_rotation_x(angle);
            pose.turns.iter_mut().for_each(|joint| *joint = turn * *joint);
            pose.hips = turn * pose.hips;
        });
        measure(fixture::motion(&body, &poses), &fixture::standing(), &[], 1.0).expect("sound").plausibility()
    };
    let (held, unheld) = (lean(0.1), lean(0.6));
    assert!(held.residual_moment < 1e-9 && unheld.residual_moment > 0.1, "{unheld:?}");
    assert!(unheld.score < 0.8 * held.score, "{} {}", unheld.score, held.score);
}

#[test]
fn nonsense_in_contacts_and_pushes_costs_the_score_not_the_program() {
    let body = fixture::body();
    let poses = fixture::poses(&body, 60, |pose, sample| pose.hips.x += 0.01 * sample);
    for value in [f64::NAN, f64::INFINITY, -1e300, 1e300] {
        let push = KnownPush { start: value, end: 1.0, force: DVec3::splat(value), at: PushPoint::Joint(999) };
        let mut contact = fixture::flat(Side::Left, 0.0, value);
        contact.normal = DVec3::splat(value);
        contact.point.y = value;
        let other = fixture::flat(Side::Right, value, 0.2);
        for friction in [value, 0.0, 1.0] {
            let report = plausibility(fixture::motion(&body, &poses), &[contact, other], &[push], friction);
            assert!((0.0..=1.0).contains(&report.score), "{report:?}");
        }
    }
}

#[test]
fn a_pelvis_25_cm_off_its_feet_has_its_pressure_outside() {
    let body = fixture::body();
    // The pelvis goes 25 cm sideways between 1 and 2 s, the feet stay.
    let poses = fixture::poses(&body, 360, |pose, sample| {
        let u = (sample / 120.0 - 1.0).clamp(0.0, 1.0);
        pose.hips.x += 0.25 * (3.0 * u * u - 2.0 * u * u * u);
        for side in Side::BOTH {
            // Legs lean so that the ankles stay: a turn of the whole leg about the hip.
            let hip = body.feet[side as usize].ankle - 2;
            let ankle = body.joints[hip + 2].rest;
            let hip_now = body.joints[hip].rest + (pose.hips - body.joints[0].rest);
            let turn = glam::DQuat::from_rotation_arc(-DVec3::Y, (ankle - hip_now).normalize());
            pose.turns[hip] = turn;
            pose.turns[hip + 1] = turn;
        }
    });
    let found = measure(fixture::motion(&body, &poses), &fixture::standing(), &[], 1.0).expect("sound");
    assert!(found.zmp.outside_max_cm > 5.0 && found.zmp.inside < 0.9, "{:?}", found.zmp);
    assert!(found.residual_moment > 0.01, "{}", found.residual_moment);
    let report = found.plausibility();
    assert!(report.score < 0.6 && report.notes.iter().any(|note| note.contains("zero-moment")), "{report:?}");
}

#[test]
fn a_body_in_free_fall_needs_nothing_and_a_hovering_one_its_weight() {
    let body = fixture::body();
    let fall = fixture::poses(&body, 60, |pose, sample| {
        let t = sample / 120.0;
        pose.hips += DVec3::new(1.0 * t, 3.0 + 1.0 * t - 0.5 * GRAVITY * t * t, 0.0);
    });
    let found = measure(fixture::motion(&body, &fall), &[], &[], 1.0).expect("sound");
    // The filter's padding bends the ends of a parabola: look at the middle, and at the whole with leave.
    for needed in &found.dynamics.needed[20..40] {
        assert!(needed.force.length() < 0.01 * body.mass * GRAVITY, "{needed:?}");
    }
    assert_eq!(found.zmp.flight, 60);
    let hover = fixture::poses(&body, 60, |pose, _| pose.hips.y += 1.0);
    let found = measure(fixture::motion(&body, &hover), &[], &[], 1.0).expect("sound");
    assert!((found.residual_force - 1.0).abs() < 1e-9, "{}", found.residual_force);
}

#[test]
fn a_body_that_speeds_up_with_no_contact_lacks_all_of_the_force() {
    let body = fixture::body();
    let w = TAU * 0.5;
    let poses = fixture::poses(&body, 481, |pose, sample| {
        pose.hips.z += 0.4 * (1.0 - real::cos(w * sample / 120.0));
        pose.hips.y += 1.0;
    });
    let found = measure(fixture::motion(&body, &poses), &[], &[], 1.0).expect("sound");
    let a_rms = 0.4 * w * w * 0.5_f64.sqrt() / GRAVITY;
    assert!((found.residual_force - real::hypot(1.0, a_rms)).abs() < 0.01, "{}", found.residual_force);
}

#[test]
fn an_unsound_motion_says_so() {
    let body = fixture::body();
    let mut poses = fixture::poses(&body, 3, |_, _| {});
    poses[1].turns.pop();
    let report = plausibility(fixture::motion(&body, &poses), &[], &[], 1.0);
    assert!(report.score == 0.0 && report.notes.len() == 1);
    assert!(measure(fixture::motion(&body, &[]), &[], &[], 1.0).is_none());
    let one = fixture::poses(&body, 1, |_, _| {});
    assert!(measure(fixture::motion(&body, &one), &fixture::standing(), &[], 1.0).is_some());
}
