//! The balance filter: moves the centre of mass by the least that brings the zero-moment point back into the support.
//!
//! The swing leg's angular momentum throws the ZMP of the posed body out of the feet that the pendulum's own CoP never
//! left. Per pass: the ZMP of the poses as they are, its distance out of the (shrunk) support as the wanted change Δp,
//! and the banded least squares for Δc with Δc - Δc''/ω² = Δp, smooth, at rest at both ends. Scenario space, SI.
//! Arms and trunk do not do this job: the legs carry most of the momentum (measured).

use super::timeline::Timeline;
use crate::maths::banded::BandedLeastSquares;
use crate::maths::hull;
use crate::measure::{HeldContact, KnownPush, Motion, Track, dynamics};
use crate::model::BodyPose;
use glam::{DVec2, DVec3};

/// m, how far inside the support the ZMP is asked to be.
const MARGIN: f64 = 0.012;
/// Weight of a sample whose ZMP is inside already (outside: 1).
const INSIDE_WEIGHT: f64 = 0.25;
/// Weight of the third difference, at 10 ms.
const SMOOTHNESS: f64 = 3e4;

/// One pass: adds to `timeline.shift`; returns the largest distance of the ZMP out of the support before it, m.
pub fn pass(timeline: &mut Timeline, poses: &[BodyPose], contacts: &[HeldContact], pushes: &[KnownPush]) -> f64 {
    let motion = Motion { body: timeline.body, hz: 1.0 / timeline.dt, per_frame: 1, poses };
    let Some(track) = Track::new(motion) else { return 0.0 };
    let dynamics = dynamics::dynamics(&track, pushes);
    let count = poses.len();
    let mut wanted = vec![DVec2::ZERO; count];
    let mut outside = vec![false; count];
    let mut worst: f64 = 0.0;
    for index in 0..count {
        let wrench = &dynamics.needed[index];
        let com = dynamics.com[index];
        if wrench.force.y < 0.2 * timeline.body.mass * 9.81 {
            continue;
        }
        let zmp = DVec2::new(
            com.x + (wrench.moment.z - com.y * wrench.force.x) / wrench.force.y,
            com.z - (wrench.moment.x + com.y * wrench.force.z) / wrench.force.y,
        );
        let support = crate::measure::support::support_at(&track, index, contacts);
        if support.is_empty() {
            continue;
        }
        worst = worst.max(hull::signed_distance(&support, zmp));
        let inner = hull::shrink(&support, MARGIN);
        if !hull::contains(&inner, zmp)
            && let Some(nearest) = hull::closest_point(&inner, zmp)
        {
            wanted[index] = nearest - zmp;
            outside[index] = true;
        }
    }
    let shift = solve(timeline, &dynamics.com, &dynamics.acceleration, &wanted, &outside);
    for (entry, add) in timeline.shift.iter_mut().zip(shift) {
        entry.x += add.x;
        entry.z += add.y;
    }
    worst
}

/// Δc for the wanted Δp, (x, z) a sample.
fn solve(timeline: &Timeline, com: &[DVec3], acceleration: &[DVec3], wanted: &[DVec2], outside: &[bool]) -> Vec<DVec2> {
    let count = wanted.len();
    let dt2 = timeline.dt * timeline.dt;
    let axis = |pick: fn(&DVec2) -> f64| {
        let mut system = BandedLeastSquares::new(count, 3);
        for index in 1..count - 1 {
            let gravity = (9.81 + acceleration[index].y).max(2.0);
            let a = com[index].y / (gravity * dt2);
            let weight = if outside[index] { 1.0 } else { INSIDE_WEIGHT };
            system.equation(index - 1, &[-a, 1.0 + 2.0 * a, -a], pick(&wanted[index]), weight);
        }
        for index in 0..count - 3 {
            system.equation(index, &[-1.0, 3.0, -3.0, 1.0], 0.0, SMOOTHNESS);
        }
        // At rest where the clip begins and ends.
        for end in [0, 1, count - 2, count - 1] {
            system.equation(end, &[1.0], 0.0, 1e9);
        }
        system.solve()
    };
    let (x, z) = (axis(|p| p.x), axis(|p| p.y));
    x.into_iter().zip(z).map(|(x, z)| DVec2::new(x, z)).collect()
}
