//! The balance filter: moves the centre of mass by the least that brings the zero-moment point back into the support.
//!
//! The swing leg's angular momentum throws the ZMP of the posed body out of the feet that the pendulum's own CoP never
//! left. Per pass: the ZMP of the poses as they are, its distance out of the (shrunk) support as the wanted change Δp,
//! and the banded least squares for Δc with Δc - Δc''/ω² = Δp, smooth, at rest at both ends. Scenario space, SI.
//! Arms and trunk do not do this job: the legs carry most of the momentum (measured).

use super::timeline::Timeline;
use crate::maths::banded::BandedLeastSquares;
use crate::maths::hull;
use crate::measure::{GRAVITY, HeldContact, KnownPush, Motion, Track, dynamics, support, zmp};
use crate::model::BodyPose;
use glam::{DVec2, DVec3};

/// m, how far inside the support the ZMP is asked to be.
const MARGIN: f64 = 0.03;
/// Weight of a sample whose ZMP is inside already (outside: 1).
const INSIDE_WEIGHT: f64 = 0.05;
/// Share of the body's weight on the ground below which the ZMP says nothing.
const LEAST_WEIGHT: f64 = 0.2;
/// Weight of the third difference, at 10 ms.
const SMOOTHNESS: f64 = 1e5;

/// One pass: adds to `timeline.shift`; returns the largest distance of the ZMP out of the support before it, m.
pub fn pass(timeline: &mut Timeline, poses: &[BodyPose], contacts: &[HeldContact], pushes: &[KnownPush]) -> f64 {
    let motion = Motion { body: &timeline.body, hz: 1.0 / timeline.dt, per_frame: 1, poses };
    let Some(track) = Track::over(motion, &timeline.terrain) else { return 0.0 };
    let track = track.carrying(&timeline.loads);
    let dynamics = dynamics::dynamics(&track, pushes);
    let count = poses.len();
    let weight = timeline.body.mass * GRAVITY;
    let mut wanted = vec![DVec2::ZERO; count];
    let mut outside = vec![false; count];
    let mut worst: f64 = 0.0;
    // m, of the centre of mass over the ground that carries it.
    let mut heights: Vec<f64> = dynamics.com.iter().map(|com| com.y).collect();
    for index in 0..count {
        let needed = dynamics.needed[index];
        let Some(support) = support::support(&track, contacts, index) else { continue };
        if needed.force.y < LEAST_WEIGHT * weight {
            continue;
        }
        heights[index] = dynamics.com[index].y - support.in_space(support.below(dynamics.com[index])).y;
        let zmp = zmp::zmp(&support, needed, dynamics.com[index], weight);
        worst = worst.max(support.outside(zmp));
        if hull::signed_distance(&support.hull, zmp) < -MARGIN {
            continue;
        }
        let inner = hull::shrink(&support.hull, MARGIN);
        if !hull::contains(&inner, zmp)
            && let Some(nearest) = hull::closest_point(&inner, zmp)
        {
            let change = support.in_space(nearest) - support.in_space(zmp);
            wanted[index] = DVec2::new(change.x, change.z);
            outside[index] = true;
        }
    }
    let shift = solve(timeline, &heights, &dynamics.acceleration, &wanted, &outside);
    for (entry, add) in timeline.shift.iter_mut().zip(shift) {
        entry.x += add.x;
        entry.z += add.y;
    }
    worst
}

/// Δc for the wanted Δp, (x, z) a sample.
fn solve(
    timeline: &Timeline,
    heights: &[f64],
    acceleration: &[DVec3],
    wanted: &[DVec2],
    outside: &[bool],
) -> Vec<DVec2> {
    let count = wanted.len();
    let dt2 = timeline.dt * timeline.dt;
    // A heel that is up from the first frame to the last moves the pressure to the ball: the body may stand elsewhere, at rest.
    let loose = timeline.feet.feet.iter().any(|path| path.raised.is_up());
    let axis = |pick: fn(&DVec2) -> f64| {
        let mut system = BandedLeastSquares::new(count, 3);
        for index in 1..count - 1 {
            let gravity = (GRAVITY + acceleration[index].y).max(2.0);
            let a = heights[index] / (gravity * dt2);
            let weight = if outside[index] { 1.0 } else { INSIDE_WEIGHT };
            system.equation(index - 1, &[-a, 1.0 + 2.0 * a, -a], pick(&wanted[index]), weight);
        }
        for index in 0..count - 3 {
            system.equation(index, &[-1.0, 3.0, -3.0, 1.0], 0.0, SMOOTHNESS);
        }
        // At rest until somebody pushes, and where the clip ends.
        let first = ((timeline.still_until / timeline.dt).round() as usize).min(count - 1);
        if loose {
            for index in (0..first).chain([count - 2]) {
                system.equation(index, &[-1.0, 1.0], 0.0, 1e9);
            }
        } else {
            for index in (0..=first).chain([count - 2, count - 1]) {
                system.equation(index, &[1.0], 0.0, 1e9);
            }
        }
        system.solve()
    };
    let (x, z) = (axis(|p| p.x), axis(|p| p.y));
    x.into_iter().zip(z).map(|(x, z)| DVec2::new(x, z)).collect()
}
