//! How a motion ends: moved, at rest, fallen, recovered.
//!
//! DESIGN "Measures" says what each word means. Scenario space, SI. "The ground below it" is the terrain's where that is
//! known, else the plane of the contact that holds (the last one that did), y = 0 before any.

use super::dynamics::Dynamics;
use super::ground::height_below;
use super::support::Support;
use super::{GRAVITY, HeldContact, KnownPush, MOVING_SPEED, Track};
use crate::model::{BodyJoint, Role, Side, report::Outcome};
use glam::DVec3;

/// Share of its standing height under which the centre of mass has fallen.
const FALLEN_SHARE: f64 = 0.57;
/// s of stillness that are rest.
const REST_SPAN: f64 = 0.5;
/// s from a push's start within which the body must be at rest again.
const RECOVERY_SPAN: f64 = 8.0;
/// Share of the body's height under which a joint other than the feet's lies on the ground.
const TOUCHING_SHARE: f64 = 0.02;
/// Share of the body's height under which a hips bone stands on the ground at rest.
const LOW_SHARE: f64 = 0.1;

/// How the body kept itself up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Whether the centre of mass ever moved.
    pub moved: bool,
    /// s, when it first had fallen.
    pub fallen: Option<f64>,
    /// s, from when on it is at rest until the end: `None` if it is not at the end. A clip that ends before half a
    /// second of it has passed has not come to rest.
    pub rest_from: Option<f64>,
    /// Not fallen, and at rest within 8 s of the last push (of the beginning, without one).
    pub recovered: bool,
}

/// Looks at the whole motion; `standing_height` is that of the centre of mass in the natural stand (m), the first
/// sample's where it is not given.
pub fn balance(
    track: &Track,
    dynamics: &Dynamics,
    supports: &[Option<Support>],
    contacts: &[HeldContact],
    pushes: &[KnownPush],
    standing_height: Option<f64>,
) -> Balance {
    let motion = track.motion;
    let below = |sample: usize, point: DVec3| match &track.terrain {
        Some(terrain) => height_below(terrain, motion.time(sample), point),
        None => ground_below(contacts, motion.time(sample), point),
    };
    let ground = |sample: usize| below(sample, dynamics.com[sample]);
    let standing = standing_height.unwrap_or_else(|| dynamics.com[0].y - ground(0));
    let others = others_than_feet(track);
    let fallen = (0..track.len()).find(|sample| {
        let touching = TOUCHING_SHARE * motion.body.height;
        let lies = |joint: &usize| {
            let at = track.positions(*sample)[*joint];
            at.y - below(*sample, at) < touching
        };
        let low = FALLEN_SHARE * (standing - track.crouched);
        dynamics.com[*sample].y - ground(*sample) < low || others.iter().any(lies)
    });
    let still = |sample: usize| {
        let time = motion.time(sample);
        let both = Side::BOTH
            .iter()
            .all(|side| contacts.iter().any(|c| c.side == *side && c.start - 1e-6 <= time && time <= c.end + 1e-6));
        both && dynamics.velocity[sample].length() < MOVING_SPEED
            && supports[sample].as_ref().is_some_and(|support| {
                support.outside(support.below(extrapolated(dynamics, sample, ground(sample)))) <= 0.0
            })
    };
    let from = (0..track.len()).rev().take_while(|sample| still(*sample)).last();
    let end = motion.time(track.len() - 1);
    let rest_from = from.map(|sample| motion.time(sample)).filter(|from| end - from >= REST_SPAN - 1e-6);
    let pushed = pushes.iter().map(|push| push.start).fold(0.0, f64::max);
    Balance {
        moved: dynamics.velocity.iter().any(|velocity| velocity.length() > MOVING_SPEED),
        fallen: fallen.map(|sample| motion.time(sample)),
        rest_from,
        recovered: fallen.is_none() && rest_from.is_some_and(|from| from + REST_SPAN <= pushed + RECOVERY_SPAN),
    }
}

impl Balance {
    /// The clip's outcome; a step is a foot that lifted and stands again.
    pub fn outcome(&self, steps: u32) -> Outcome {
        match (self.fallen, steps, self.moved) {
            (Some(_), ..) => Outcome::Fall,
            (None, 0, false) => Outcome::Still,
            (None, 0, true) => Outcome::Sway,
            (None, ..) => Outcome::Step,
        }
    }
}

/// The extrapolated centre of mass c + v/ω, on the ground.
fn extrapolated(dynamics: &Dynamics, sample: usize, ground: f64) -> DVec3 {
    let com = dynamics.com[sample];
    let omega = (GRAVITY / (com.y - ground).max(0.05)).sqrt();
    let at = com + dynamics.velocity[sample] / omega;
    DVec3::new(at.x, ground, at.z)
}

/// m, the height of the ground under a point: the plane of the contact that holds then, or that last did.
fn ground_below(contacts: &[HeldContact], time: f64, point: DVec3) -> f64 {
    let begun = contacts.iter().filter(|contact| contact.start <= time + 1e-6 && contact.normal.y > 0.1);
    match begun.max_by(|a, b| a.end.min(time).total_cmp(&b.end.min(time))) {
        Some(contact) => {
            let n = contact.normal;
            contact.point.y - ((point.x - contact.point.x) * n.x + (point.z - contact.point.z) * n.z) / n.y
        }
        None => 0.0,
    }
}

/// Joints that are neither a foot nor a toe.
/// Some rigs have their hips bone on the ground, between the feet: there it tells no fall.
fn others_than_feet(track: &Track) -> Vec<usize> {
    let feet = [Role::LeftFoot, Role::RightFoot, Role::LeftToes, Role::RightToes];
    let body = track.motion.body;
    let low = |joint: &BodyJoint| joint.role == Role::Hips && joint.rest.y < LOW_SHARE * body.height;
    let tells = |joint: &BodyJoint| !feet.contains(&joint.role) && !low(joint);
    body.joints.iter().enumerate().filter(|(_, joint)| tells(joint)).map(|(index, _)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::super::support::support;
    use super::super::{PushPoint, dynamics::dynamics, fixture};
    use super::*;
    use crate::maths::real;
    use crate::model::{Body, BodyPose};

    fn judged(body: &Body, poses: &[BodyPose], contacts: &[HeldContact], pushes: &[KnownPush]) -> Balance {
        let track = Track::new(fixture::motion(body, poses)).expect("sound");
        let dynamics = dynamics(&track, pushes);
        let supports: Vec<_> = (0..track.len()).map(|sample| support(&track, contacts, sample)).collect();
        balance(&track, &dynamics, &supports, contacts, pushes, None)
    }

    fn push(start: f64, end: f64) -> KnownPush {
        KnownPush { start, end, force: DVec3::X * 200.0, at: PushPoint::Centre }
    }

    #[test]
    fn a_body_that_sways_and_stops_has_recovered() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 481, |pose, sample| {
            let u = ((sample / 120.0 - 1.0) / 1.0).clamp(0.0, 1.0);
            pose.hips.x += 0.05 * 16.0 * u * u * (1.0 - u) * (1.0 - u);
        });
        let found = judged(&body, &poses, &fixture::standing(), &[push(1.0, 1.2)]);
        assert!(found.moved && found.recovered && found.fallen.is_none(), "{found:?}");
        let rest = found.rest_from.expect("it rests");
        assert!((1.7..2.1).contains(&rest), "{rest}");
        assert_eq!((found.outcome(0), found.outcome(2)), (Outcome::Sway, Outcome::Step));
        // Cut off 0.3 s after the sway it has not come to rest.
        let short = judged(&body, &poses[..268], &fixture::standing(), &[push(1.0, 1.2)]);
        assert!(short.rest_from.is_none() && !short.recovered, "{short:?}");
    }

    #[test]
    fn on_one_foot_nobody_rests() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 240, |_, _| {});
        let found = judged(&body, &poses, &[fixture::flat(Side::Left, 0.0, 9.0)], &[]);
        assert!(found.rest_from.is_none() && !found.moved, "{found:?}");
    }

    #[test]
    fn a_body_that_sinks_under_57_percent_has_fallen_and_one_above_has_not() {
        let body = fixture::body();
        let stands = fixture::com(&body).y;
        let mut seen = [0, 0];
        for drop in [0.30, 0.36, 0.40, 0.44, 0.50, 0.60] {
            // Squatting on feet that stay: thighs forward, shanks back.
            let poses = fixture::poses(&body, 240, |pose, sample| {
                let u = (sample / 120.0).clamp(0.0, 1.0);
                let sunk = drop * (3.0 * u * u - 2.0 * u * u * u);
                pose.hips.y -= sunk;
                let bend = real::acos(1.0 - sunk / 0.82);
                for side in Side::BOTH {
                    let hip = body.feet[side as usize].ankle - 2;
                    pose.turns[hip] = glam::DQuat::from_rotation_x(-bend);
                    pose.turns[hip + 1] = glam::DQuat::from_rotation_x(bend);
                }
            });
            let last = &poses[239];
            let share = last.centre_of_mass(&body, &last.positions(&body)).y / stands;
            let fallen = judged(&body, &poses, &fixture::standing(), &[]).fallen;
            assert_eq!(fallen.is_some(), share < 0.57, "sunk by {drop} to {share}");
            seen[usize::from(fallen.is_some())] += 1;
        }
        assert!(seen[0] >= 2 && seen[1] >= 2, "{seen:?}");
    }

    #[test]
    fn a_hips_bone_that_is_on_the_ground_at_rest_is_no_fall() {
        let mut body = fixture::body();
        let down = body.joints[0].rest.y - 0.03;
        body.joints[0].rest.y = 0.03;
        body.segments.iter_mut().filter(|segment| segment.joint == 0).for_each(|segment| segment.centre.y += down);
        let sinks = |by: f64| {
            let poses = fixture::poses(&body, 240, |pose, sample| pose.hips.y -= by * (sample / 120.0).clamp(0.0, 1.0));
            judged(&body, &poses, &fixture::standing(), &[]).fallen
        };
        assert_eq!(sinks(0.03), None);
        assert!(sinks(0.6).is_some());
    }

    #[test]
    fn a_hand_on_the_ground_is_a_fall() {
        let mut body = fixture::body();
        let poses = fixture::poses(&body, 60, |_, _| {});
        assert!(judged(&body, &poses, &fixture::standing(), &[]).fallen.is_none());
        let hand = body.joint(Role::LeftHand).expect("a hand");
        body.joints[hand].rest.y = 0.01;
        let poses = fixture::poses(&body, 60, |_, _| {});
        assert_eq!(judged(&body, &poses, &fixture::standing(), &[]).fallen, Some(0.0));
    }
}
