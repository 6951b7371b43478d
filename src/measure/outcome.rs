//! How a motion ends: moved, at rest, fallen, recovered; and how much of a push the centre of mass took up.
//!
//! DESIGN "Measures" says what each word means. Scenario space, SI. "The ground below it" is the plane of the contact
//! that holds (the last one that did), y = 0 before any.

use super::dynamics::Dynamics;
use super::support::Support;
use super::{GRAVITY, HeldContact, KnownPush, MOVING_SPEED, Track};
use crate::model::{Role, Side, report::Outcome};
use glam::DVec3;

/// Share of its standing height under which the centre of mass has fallen.
const FALLEN_SHARE: f64 = 0.57;
/// s of stillness that are rest.
const REST_SPAN: f64 = 0.5;
/// s from a push's start within which the body must be at rest again.
const RECOVERY_SPAN: f64 = 8.0;
/// s after a push within which its speed shows.
const SPEED_SPAN: f64 = 0.3;
/// s; what pushes for longer drags, and says nothing by the speed it gives.
const LONGEST_PUSH: f64 = 1.0;
/// Share of the body's height under which a joint other than the feet's lies on the ground.
const TOUCHING_SHARE: f64 = 0.02;

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
    let ground = |sample: usize| ground_below(contacts, motion.time(sample), dynamics.com[sample]);
    let standing = standing_height.unwrap_or_else(|| dynamics.com[0].y - ground(0));
    let others = others_than_feet(track);
    let fallen = (0..track.len()).find(|sample| {
        let floor = ground(*sample);
        let touching = floor + TOUCHING_SHARE * motion.body.height;
        dynamics.com[*sample].y - floor < FALLEN_SHARE * standing
            || others.iter().any(|joint| track.positions(*sample)[*joint].y < touching)
    });
    let still = |sample: usize| {
        let time = motion.time(sample);
        let both = Side::BOTH
            .iter()
            .all(|side| contacts.iter().any(|c| c.side == *side && c.start - 1e-6 <= time && time <= c.end + 1e-6));
        both && dynamics.velocity[sample].length() < MOVING_SPEED
            && supports[sample].as_ref().is_some_and(|support| {
                support.outside(support.on_plane(extrapolated(dynamics, sample, ground(sample)))) <= 0.0
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

/// Peak change of the centre of mass's speed along a push, from the push's start until 0.3 s after its end, over
/// impulse / mass; of several pushes the one that is farthest from 1. Forces of all pushes in that span count into the
/// impulse. `None` without a push of at most a second.
pub fn speed_ratio(track: &Track, dynamics: &Dynamics, pushes: &[KnownPush]) -> Option<f64> {
    let motion = track.motion;
    let mass = motion.body.mass;
    let ratio = |push: &KnownPush| {
        let direction = push.force.try_normalize()?;
        let until = push.end + SPEED_SPAN;
        let impulse: f64 = pushes
            .iter()
            .map(|other| (other.end.min(until) - other.start.max(push.start)).max(0.0) * other.force.dot(direction))
            .sum();
        let samples = motion.samples_in(push.start, until);
        if impulse <= 0.0 || samples.is_empty() {
            return None;
        }
        let before = dynamics.velocity[samples.start].dot(direction);
        let peak = samples.map(|sample| dynamics.velocity[sample].dot(direction) - before).fold(0.0, f64::max);
        Some(peak * mass / impulse)
    };
    pushes
        .iter()
        .filter(|push| push.end > push.start && push.end - push.start <= LONGEST_PUSH + 1e-9)
        .filter_map(ratio)
        .max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))
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
fn others_than_feet(track: &Track) -> Vec<usize> {
    let feet = [Role::LeftFoot, Role::RightFoot, Role::LeftToes, Role::RightToes];
    let joints = track.motion.body.joints.iter().enumerate();
    joints.filter(|(_, joint)| !feet.contains(&joint.role)).map(|(index, _)| index).collect()
}
