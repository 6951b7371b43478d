//! Feet: how far a contact slips, how deep a sole sinks, how high it hovers, how fast ankles go, how near the legs come.
//!
//! Scenario space; distances in mm where the name says so, else m and m/s. Slip is the largest displacement, from the
//! first sample of a contact, of any point that the contact holds ([`held_points`]), in the contact's own frame: on a
//! platform a foot that goes with it is still. Depth is under the contact's plane; in the air, under the ground where it
//! is known ([`super::ground`]).

use super::ground;
use super::support::{held_points, levelled_point, part_points};
use super::{HeldContact, Track, percentile};
use crate::model::{FootShape, Role, Side, report::Part};
use glam::DVec3;

/// Slip of one contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip {
    /// mm, the largest displacement from the start.
    pub mm: f64,
    /// mm/s, 95th percentile of the held points' speed.
    pub speed_p95: f64,
}

/// What the feet do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FeetFindings {
    /// One a contact, same order.
    pub slips: Vec<Slip>,
    /// mm, 95th percentile over contacts.
    pub slip_p95_mm: f64,
    /// mm, the largest.
    pub slip_max_mm: f64,
    /// mm/s, 95th percentile over all held points of all contacts and samples.
    pub slip_speed_p95: f64,
    /// mm, the deepest sole vertex in the ground: as its contact meets it ([`ground::depth_held`]), or (y = 0 where it is not known) as a foot
    /// without one does.
    pub penetration_max_mm: f64,
    /// s, when that is.
    pub penetration_time: f64,
    /// mm, the highest that the lowest vertex of a contacting part is over its plane.
    pub float_max_mm: f64,
    /// s, when that is.
    pub float_time: f64,
    /// mm, one a contact, same order: the highest that its part floats.
    pub floats_mm: Vec<f64>,
    /// m/s.
    pub peak_ankle_speed: f64,
    /// m, the least distance between the two legs' axes while a foot is in the air; infinite without a swing.
    pub least_leg_distance: f64,
    /// s, when that is.
    pub least_leg_time: f64,
}

/// Measures them.
pub fn feet(track: &Track, contacts: &[HeldContact]) -> FeetFindings {
    let mut speeds: Vec<f64> = Vec::new();
    let slips: Vec<Slip> = contacts.iter().map(|contact| slip(track, contact, &mut speeds)).collect();
    let lengths: Vec<f64> = slips.iter().map(|slip| slip.mm).collect();
    let (penetration, floats) = depths(track, contacts);
    let float = floats.iter().copied().fold((0.0, 0.0), |most, next| if next.0 > most.0 { next } else { most });
    let (distance, time) = leg_distance(track, contacts);
    FeetFindings {
        slip_p95_mm: percentile(&lengths, 0.95),
        slip_max_mm: lengths.iter().copied().fold(0.0, f64::max),
        slip_speed_p95: percentile(&speeds, 0.95),
        slips,
        penetration_max_mm: penetration.0,
        penetration_time: penetration.1,
        float_max_mm: float.0,
        float_time: float.1,
        floats_mm: floats.iter().map(|float| float.0).collect(),
        peak_ankle_speed: peak_ankle_speed(track),
        least_leg_distance: distance,
        least_leg_time: time,
    }
}

/// Slip of one contact; its points' speeds (mm/s) are added to `speeds`.
fn slip(track: &Track, contact: &HeldContact, speeds: &mut Vec<f64>) -> Slip {
    let samples = track.motion.samples_in(contact.start, contact.end);
    let mut own: Vec<f64> = Vec::new();
    let mut farthest: f64 = 0.0;
    for point in held_points(track.motion.body, contact.side, contact.part) {
        let mut first: Option<DVec3> = None;
        let mut last = DVec3::ZERO;
        for sample in samples.clone() {
            let turn = track.turn(contact.frame, sample).inverse();
            let here = turn * track.rigid_point(sample, point.joint, point.offset);
            match first {
                None => first = Some(here),
                Some(first) => {
                    farthest = farthest.max(here.distance(first));
                    own.push(1000.0 * here.distance(last) * track.motion.hz);
                }
            }
            last = here;
        }
    }
    speeds.extend_from_slice(&own);
    Slip { mm: 1000.0 * farthest, speed_p95: percentile(&own, 0.95) }
}

/// A length (mm) and when it is reached (s).
type Peak = (f64, f64);

/// The deepest under the ground, and of each contact the highest over it.
fn depths(track: &Track, contacts: &[HeldContact]) -> (Peak, Vec<Peak>) {
    let mut points: Vec<DVec3> = Vec::new();
    let mut deepest: Peak = (0.0, 0.0);
    let mut highest: Vec<Peak> = vec![(0.0, 0.0); contacts.len()];
    for sample in 0..track.len() {
        let time = track.motion.time(sample);
        for side in Side::BOTH {
            points.clear();
            part_points(track, sample, side, Part::Flat, &mut points);
            let sole = points.len();
            let mut sink = |depth: f64| {
                if depth > deepest.0 {
                    deepest = (depth, time);
                }
            };
            let mut in_contact = false;
            for (contact, highest) in contacts.iter().zip(&mut highest) {
                if contact.side != side || !holds(contact, time) {
                    continue;
                }
                in_contact = true;
                let contact = &track.placed(contact, sample);
                let deep = |point: &DVec3| 1000.0 * ground::depth_held(track, contact, sample, *point);
                points[..sole].iter().for_each(|point| sink(deep(point)));
                part_points(track, sample, side, contact.part, &mut points);
                let lowest = points[sole..].iter().map(|point| contact.height(*point)).fold(f64::INFINITY, f64::min);
                points.truncate(sole);
                if 1000.0 * lowest > highest.0 {
                    *highest = (1000.0 * lowest, time);
                }
            }
            if !in_contact {
                let floor = ground::Swung::new(track, contacts, side, sample);
                points.iter().for_each(|point| sink(1000.0 * floor.depth(*point)));
            }
        }
    }
    (deepest, highest)
}

/// Whether a contact holds at a time.
fn holds(contact: &HeldContact, time: f64) -> bool {
    contact.start - 1e-6 <= time && time <= contact.end + 1e-6
}

/// m/s, of both ankles, from sample to sample.
fn peak_ankle_speed(track: &Track) -> f64 {
    let mut peak: f64 = 0.0;
    for sample in 1..track.len() {
        for foot in &track.motion.body.feet {
            let step = track.positions(sample)[foot.ankle].distance(track.positions(sample - 1)[foot.ankle]);
            peak = peak.max(step * track.motion.hz);
        }
    }
    peak
}

/// Least distance between the axes knee-ankle and ankle-toe of one leg and those of the other, over the samples at
/// which a foot has no contact; and when. Infinite without such a sample.
fn leg_distance(track: &Track, contacts: &[HeldContact]) -> (f64, f64) {
    let body = track.motion.body;
    let knees = [Role::LeftLowerLeg, Role::RightLowerLeg].map(|role| body.joint(role));
    let [Some(left), Some(right)] = knees else { return (f64::INFINITY, 0.0) };
    let knees = [left, right];
    let mut least = (f64::INFINITY, 0.0);
    for sample in 0..track.len() {
        let time = track.motion.time(sample);
        if Side::BOTH.iter().all(|side| contacts.iter().any(|contact| contact.side == *side && holds(contact, time))) {
            continue;
        }
        let [a, b] = Side::BOTH.map(|side| leg_axis(track, sample, knees[side as usize], &body.feet[side as usize]));
        for from in a.windows(2) {
            for to in b.windows(2) {
                let distance = segment_distance([from[0], from[1]], [to[0], to[1]]);
                if distance < least.0 {
                    least = (distance, time);
                }
            }
        }
    }
    least
}

/// Knee, ankle, toe joint (for a foot without one, over the ball line, a third of the ankle's height up).
fn leg_axis(track: &Track, sample: usize, knee: usize, foot: &FootShape) -> [DVec3; 3] {
    let positions = track.positions(sample);
    let toe = match foot.toe {
        Some(toe) => positions[toe],
        None => {
            let offset = levelled_point(foot, foot.ball, 0.0, foot.ankle_height / 3.0);
            track.rigid_point(sample, foot.ankle, offset)
        }
    };
    [positions[knee], positions[foot.ankle], toe]
}

/// Least distance between two segments.
pub fn segment_distance(a: [DVec3; 2], b: [DVec3; 2]) -> f64 {
    let [on_a, on_b] = nearest_points(a, b);
    on_a.distance(on_b)
}

/// The nearest points of two segments (Ericson, "Real-Time Collision Detection", 5.1.9).
pub fn nearest_points(a: [DVec3; 2], b: [DVec3; 2]) -> [DVec3; 2] {
    let (along_a, along_b, between) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (aa, bb, ab) = (along_a.length_squared(), along_b.length_squared(), along_a.dot(along_b));
    let (c, f) = (along_a.dot(between), along_b.dot(between));
    let tiny = 1e-18;
    let (s, t) = if aa <= tiny && bb <= tiny {
        (0.0, 0.0)
    } else if aa <= tiny {
        (0.0, (f / bb).clamp(0.0, 1.0))
    } else if bb <= tiny {
        ((-c / aa).clamp(0.0, 1.0), 0.0)
    } else {
        let denominator = aa * bb - ab * ab;
        let s = if denominator > tiny { ((ab * f - c * bb) / denominator).clamp(0.0, 1.0) } else { 0.0 };
        let t = (ab * s + f) / bb;
        if t < 0.0 {
            ((-c / aa).clamp(0.0, 1.0), 0.0)
        } else if t > 1.0 {
            (((ab - c) / aa).clamp(0.0, 1.0), 1.0)
        } else {
            (s, t)
        }
    };
    [a[0] + along_a * s, b[0] + along_b * t]
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;
    use crate::maths::real;
    use glam::{DQuat, dvec3};

    #[test]
    fn a_foot_that_slides_20_mm_slips_20_mm() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 121, |pose, sample| pose.hips.x += 0.020 * sample / 120.0);
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let found = feet(&track, &fixture::standing().map(|contact| HeldContact { end: 1.0, ..contact }));
        assert!((found.slip_max_mm - 20.0).abs() < 1e-6, "{found:?}");
        assert!((found.slip_speed_p95 - 20.0).abs() < 1e-6, "{found:?}");
        assert!(found.penetration_max_mm < 1e-9 && found.float_max_mm < 1e-9, "{found:?}");
        // Half of the time, half of the slide.
        let half = feet(&track, &[fixture::flat(Side::Left, 0.5, 1.0)]);
        assert!((half.slip_max_mm - 10.0).abs() < 1e-6, "{half:?}");
    }

    #[test]
    fn a_foot_that_turns_on_its_ankle_slips_at_the_toe() {
        let body = fixture::body();
        let ankle = body.feet[0].ankle;
        let toe = body.feet[0].toe.expect("it has toes");
        let poses = fixture::poses(&body, 61, |pose, sample| {
            let turn = DQuat::from_rotation_y(0.2 * sample / 60.0);
            pose.turns[ankle] = turn;
            pose.turns[toe] = turn;
        });
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let found = feet(&track, &[fixture::flat(Side::Left, 0.0, 0.5)]);
        let expected = 1000.0 * 2.0 * 0.12 * real::sin(0.1);
        assert!((found.slip_max_mm - expected).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_heel_that_lifts_over_the_ball_does_not_slip_but_one_over_the_tip_does() {
        let body = fixture::body();
        let (ankle, toe) = (body.feet[0].ankle, body.feet[0].toe.expect("it has toes"));
        let lifted = |pivot: DVec3, toes_too: bool| {
            fixture::poses(&body, 31, |pose, sample| {
                let turn = DQuat::from_rotation_x(0.5 * sample / 30.0);
                pose.turns[ankle] = turn;
                if toes_too {
                    pose.turns[toe] = turn;
                }
                let rest = body.joints[ankle].rest;
                pose.hips += pivot + turn * (rest - pivot) - rest;
            })
        };
        let contact = HeldContact { part: Part::Ball, ..fixture::flat(Side::Left, 0.0, 0.25) };
        let measured = |poses: &[crate::model::BodyPose]| {
            feet(&Track::new(fixture::motion(&body, poses)).expect("sound"), &[contact])
        };
        assert!(measured(&lifted(body.joints[toe].rest, false)).slip_max_mm < 1e-9);
        assert!(measured(&lifted(dvec3(0.1, 0.0, 0.19), true)).slip_max_mm > 20.0);
    }

    #[test]
    fn sinking_and_hovering_are_told_apart_in_millimetres() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 3, |pose, sample| pose.hips.y += [0.0, -0.012, 0.007][sample as usize]);
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let found = feet(&track, &fixture::standing());
        assert!((found.penetration_max_mm - 12.0).abs() < 1e-6 && (found.float_max_mm - 7.0).abs() < 1e-6, "{found:?}");
        assert_eq!((found.penetration_time, found.float_time), (1.0 / 120.0, 2.0 / 120.0));
        let air = feet(&track, &[]);
        assert!((air.penetration_max_mm - 12.0).abs() < 1e-6 && air.float_max_mm == 0.0, "{air:?}");
    }

    #[test]
    fn a_leg_that_crosses_is_found_by_its_distance_only_in_a_swing() {
        let body = fixture::body();
        let hip = body.joint(Role::LeftUpperLeg).expect("a leg");
        let leg: Vec<usize> = (hip..hip + 4).collect();
        // The left leg swings 0.15 m inwards at the ankle: 5 cm are left of the 20.
        let angle = -real::asin(0.15_f64 / 0.82);
        let poses = fixture::poses(&body, 61, |pose, sample| {
            let turn = DQuat::from_rotation_z(angle * real::sin(std::f64::consts::PI * sample / 60.0));
            for joint in &leg {
                pose.turns[*joint] = turn;
            }
        });
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let swing = feet(&track, &[fixture::flat(Side::Right, 0.0, 1.0)]);
        assert!(swing.least_leg_distance < 0.055 && swing.least_leg_distance > 0.03, "{swing:?}");
        assert!((swing.least_leg_time - 0.25).abs() < 0.02);
        assert!(feet(&track, &fixture::standing()).least_leg_distance.is_infinite());
    }

    #[test]
    fn segments_know_their_distance() {
        let x = [DVec3::ZERO, DVec3::X];
        assert!((segment_distance(x, [dvec3(0.5, 0.3, -1.0), dvec3(0.5, 0.3, 1.0)]) - 0.3).abs() < 1e-12);
        assert!((segment_distance(x, [dvec3(2.0, 0.0, 0.0), dvec3(3.0, 0.0, 0.0)]) - 1.0).abs() < 1e-12);
        assert!((segment_distance(x, [dvec3(0.2, 2.0, 0.0), dvec3(0.8, 2.0, 0.0)]) - 2.0).abs() < 1e-12);
        assert!((segment_distance([DVec3::Y; 2], [DVec3::ZERO; 2]) - 1.0).abs() < 1e-12);
    }
}
