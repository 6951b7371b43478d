//! The zero-moment point: where on the contact plane the ground would have to press, and how far out of the support.
//!
//! Scenario space, m. With the vertical acceleration, the rate of whole-body angular momentum and the known pushes
//! (Vukobratovic; [`super::dynamics`]). On planes that differ there is no one point: there the distance is that by
//! which the residual wrench ([`super::residual`]) misses, moment over the normal force. Flight is counted apart.

use super::dynamics::{Dynamics, Wrench};
use super::support::Support;
use super::{GRAVITY, MOVING_SPEED, Motion, percentile};
use glam::{DVec2, DVec3};

/// m, how far out still counts as inside.
pub const INSIDE_TOLERANCE: f64 = 0.005;

/// Share of the body's weight below which the normal force is taken as that much, lest a foot that hardly presses has
/// its ZMP kilometres away.
const LEAST_NORMAL: f64 = 0.1;

/// What the samples say together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ZmpFindings {
    /// Share of moving samples with contact that are inside; 1 where nothing moves.
    pub inside: f64,
    /// cm, 95th percentile over them of the distance out of the support (0 where inside).
    pub outside_p95_cm: f64,
    /// cm, the farthest.
    pub outside_max_cm: f64,
    /// s, when that is.
    pub worst_time: f64,
    /// Samples that move and have contact.
    pub moving_with_contact: usize,
    /// Samples without any contact.
    pub flight: usize,
    /// m/s², in flight, the farthest that the centre of mass is from falling freely (pushes taken off).
    pub flight_worst: f64,
}

/// The place on the support's plane at which a needed wrench (about a centre of mass) has no tangential moment.
pub fn zmp(support: &Support, needed: Wrench, com: DVec3, weight: f64) -> DVec2 {
    let normal_force = needed.force.dot(support.normal).max(LEAST_NORMAL * weight);
    let moment = needed.moment + (com - support.origin).cross(needed.force);
    support.on_plane(support.origin + support.normal.cross(moment) / normal_force)
}

/// m out of the support (negative inside) at every sample with contact; `residuals` are the samples' missing wrenches.
pub fn distances(
    motion: &Motion,
    dynamics: &Dynamics,
    supports: &[Option<Support>],
    residuals: &[Wrench],
) -> Vec<Option<f64>> {
    let weight = motion.body.mass * GRAVITY;
    let one = |sample: usize, support: &Support| {
        let needed = dynamics.needed[sample];
        if support.level {
            return support.outside(zmp(support, needed, dynamics.com[sample], weight));
        }
        let height = (dynamics.com[sample] - support.origin).dot(support.normal).abs();
        let missing = residuals[sample].moment.length() + residuals[sample].force.length() * height;
        missing / needed.force.dot(support.normal).max(LEAST_NORMAL * weight)
    };
    supports.iter().enumerate().map(|(sample, support)| support.as_ref().map(|support| one(sample, support))).collect()
}

/// Sums the distances up.
pub fn findings(motion: &Motion, dynamics: &Dynamics, distances: &[Option<f64>]) -> ZmpFindings {
    let mut found = ZmpFindings { inside: 1.0, ..ZmpFindings::default() };
    let mut outside: Vec<f64> = Vec::new();
    for (sample, distance) in distances.iter().enumerate() {
        let Some(distance) = distance else {
            found.flight += 1;
            let free = dynamics.needed[sample].force.length() / motion.body.mass;
            found.flight_worst = found.flight_worst.max(free);
            continue;
        };
        if dynamics.velocity[sample].length() <= MOVING_SPEED {
            continue;
        }
        let out = if *distance <= INSIDE_TOLERANCE { 0.0 } else { *distance };
        if 100.0 * out > found.outside_max_cm {
            found.outside_max_cm = 100.0 * out;
            found.worst_time = motion.time(sample);
        }
        outside.push(out);
    }
    found.moving_with_contact = outside.len();
    if !outside.is_empty() {
        found.inside = outside.iter().filter(|out| **out == 0.0).count() as f64 / outside.len() as f64;
        found.outside_p95_cm = 100.0 * percentile(&outside, 0.95);
    }
    found
}
