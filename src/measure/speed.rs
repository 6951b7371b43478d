//! How much of a push the centre of mass takes up, and how much it could.
//!
//! Scenario space, SI. A body that stops a push as soon as people answer takes up what the push gave until then. A body
//! that falls with the push gains more than the impulse, from gravity: an inverted pendulum of rate ω = √(g/h) over a fixed
//! pivot that is pushed with F from s to e has at T gained F/(mω)·(sinh ω(T-s) - sinh ω(T-e)). What a motion changes its
//! speed by without a push (a walk's sway, a start) comes on top of either.

use super::dynamics::Dynamics;
use super::{KnownPush, Track};
use crate::maths::pendulum::rate;
use crate::maths::real;
use glam::DVec3;

/// s after a push within which its speed shows.
const SHOWS: f64 = 0.3;
/// s; what pushes for longer drags, and says nothing by the speed it gives.
const LONGEST_PUSH: f64 = 1.0;
/// s, for which a push has the body busy.
const BUSY: f64 = 1.0;
/// s before a push in which a motion shows how it changes its speed by itself: a stride of a slow walk.
const STRIDE: f64 = 1.2;
/// s before a push into which the filter of the velocities smears it.
const SMEARED: f64 = 0.05;
/// s after a push's start, before which nobody answers it: people do after 0.1 to 0.15 s.
const ANSWERED: f64 = 0.12;
/// Share of an impulse that the centre of mass takes up until it is answered: a rigid body that turns about its ankles and is
/// pushed at the height of its centre of mass, h = 0.95 m, takes up h² / (h² + r²), with a radius of gyration r of 0.45 m.
const BRACED: f64 = 0.8;
/// What a body may gain over a pendulum's gain: it is no pendulum, bends at the hips and lowers itself. A judgement.
const OVER_PENDULUM: f64 = 1.1;

/// What one push gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedGain {
    /// Peak change of the centre of mass's speed along the push, from just before its start until 0.3 s after its end, over
    /// impulse / mass. Forces of all pushes in that span count into the impulse.
    pub ratio: f64,
    /// The ratios that a body on its feet can have.
    pub within: [f64; 2],
}

impl SpeedGain {
    /// How far the ratio is from what can be.
    pub fn beyond(&self) -> f64 {
        (self.ratio - self.within[1]).max(self.within[0] - self.ratio).max(0.0)
    }
}

/// Of several pushes the one that is farthest from what can be, or from 1 where all can. A push that comes within a second
/// of an earlier one meets a body that is still busy with that, and says nothing. `None` without a push of at most a second.
pub fn speed_gain(track: &Track, dynamics: &Dynamics, pushes: &[KnownPush]) -> Option<SpeedGain> {
    let short = |push: &KnownPush| push.end - push.start <= LONGEST_PUSH + 1e-9;
    let busy =
        |push: &KnownPush, other: &KnownPush| short(other) && other.start < push.start && other.end + BUSY > push.start;
    pushes
        .iter()
        .filter(|push| push.end > push.start && short(push))
        .filter(|push| !pushes.iter().any(|other| busy(push, other)))
        .filter_map(|push| gain_of(track, dynamics, pushes, push))
        .max_by(|a, b| {
            let from_one = (a.ratio - 1.0).abs().total_cmp(&(b.ratio - 1.0).abs());
            a.beyond().total_cmp(&b.beyond()).then(from_one)
        })
}

fn gain_of(track: &Track, dynamics: &Dynamics, pushes: &[KnownPush], push: &KnownPush) -> Option<SpeedGain> {
    let direction = push.force.try_normalize()?;
    let until = push.end + SHOWS;
    let samples = track.motion.samples_in((push.start - SMEARED).max(0.0), until);
    if samples.is_empty() {
        return None;
    }
    let (first, along) = (samples.start, |sample: usize| dynamics.velocity[sample].dot(direction));
    let omega = rate(height(track, dynamics, first).max(0.05));
    let (mut impulse, mut pendulum, mut unanswered) = (0.0, 0.0, 0.0);
    let early = |time: f64| (push.start + ANSWERED - time.max(push.start)).max(0.0);
    for other in pushes {
        let (force, left) = (other.force.dot(direction), |time: f64| (until - time.max(push.start)).max(0.0));
        impulse += (left(other.start) - left(other.end)) * force;
        unanswered += (early(other.start) - early(other.end)) * force;
        pendulum += (sinh(omega * left(other.start)) - sinh(omega * left(other.end))) / omega * force;
    }
    if impulse <= 0.0 {
        return None;
    }
    let mass = track.mass(first);
    let own = own_change(track, dynamics, direction, push.start, until - push.start + SMEARED) * mass / impulse;
    let peak = samples.map(|sample| along(sample) - along(first)).fold(0.0, f64::max);
    Some(SpeedGain {
        ratio: peak * mass / impulse,
        within: [BRACED * unanswered / impulse - own, OVER_PENDULUM * (pendulum / impulse).max(1.0) + own],
    })
}

/// m/s, the most that the speed along a direction changes within `span` s in the stride before a time.
fn own_change(track: &Track, dynamics: &Dynamics, direction: DVec3, time: f64, span: f64) -> f64 {
    let samples = track.motion.samples_in((time - STRIDE).max(0.0), time - SMEARED);
    let reach = (span * track.motion.hz) as usize;
    let speeds: Vec<f64> = samples.map(|sample| dynamics.velocity[sample].dot(direction)).collect();
    let change = |(index, speed): (usize, &f64)| {
        speeds[index..(index + reach + 1).min(speeds.len())]
            .iter()
            .map(|later| (later - speed).abs())
            .fold(0.0, f64::max)
    };
    speeds.iter().enumerate().map(change).fold(0.0, f64::max)
}

/// m, how high the centre of mass is over the ground that the lowest foot stands on.
fn height(track: &Track, dynamics: &Dynamics, sample: usize) -> f64 {
    let joints = track.motion.body.joints.iter().zip(track.positions(sample));
    let lowest = joints.min_by(|a, b| a.1.y.total_cmp(&b.1.y));
    dynamics.com[sample].y - lowest.map_or(0.0, |(joint, at)| at.y - joint.rest.y)
}

fn sinh(x: f64) -> f64 {
    let grown = real::exp(x);
    0.5 * (grown - 1.0 / grown)
}

#[cfg(test)]
mod tests {
    use super::super::{PushPoint, dynamics::dynamics, fixture};
    use super::*;

    const FORCE: f64 = 200.0;

    fn push(start: f64, end: f64) -> KnownPush {
        KnownPush { start, end, force: DVec3::X * FORCE, at: PushPoint::Centre }
    }

    /// 3 s of a body whose hips are so far along x at each time; pushed from 1.0 to 1.2 s.
    fn gain(path: impl Fn(f64) -> f64) -> SpeedGain {
        let body = fixture::body();
        let poses = fixture::poses(&body, 360, |pose, sample| pose.hips.x += path(sample / 120.0));
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        speed_gain(&track, &dynamics(&track, &[]), &[push(1.0, 1.2)]).expect("a push")
    }

    /// m, after that share of the push, at a steady speed before it.
    fn shoved(share: f64, before: f64) -> impl Fn(f64) -> f64 {
        let a = share * FORCE / fixture::body().mass;
        move |t| {
            let during = (t - 1.0).clamp(0.0, 0.2);
            before * t + 0.5 * a * during * during + a * during * (t - 1.2).max(0.0)
        }
    }

    /// m, of a pendulum with the fixture's height that the push has let fall, times `much`.
    fn falling(much: f64) -> impl Fn(f64) -> f64 {
        let body = fixture::body();
        let poses = fixture::poses(&body, 2, |_, _| {});
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        let omega = rate(height(&track, &dynamics(&track, &[]), 0));
        let a = much * FORCE / body.mass;
        let after = move |t: f64| {
            let grown = real::exp(omega * t.max(0.0));
            0.5 * (grown + 1.0 / grown) - 1.0
        };
        move |t| a / (omega * omega) * (after(t - 1.0) - after(t - 1.2))
    }

    #[test]
    fn a_sliding_body_takes_up_all_of_a_push_and_a_stiff_one_too_little() {
        for (share, before) in [(1.0, 0.0), (0.5, 0.0), (1.0, 1.5)] {
            let ratio = gain(shoved(share, before)).ratio;
            assert!((ratio - share).abs() < 0.03, "{share} of it at {before} m/s before: {ratio}");
        }
        // Of 0.2 s 0.12 are over before anybody answers: 0.8 * 0.6 of it are taken up.
        assert_eq!(gain(shoved(0.52, 0.0)).beyond(), 0.0);
        assert!((gain(shoved(0.3, 0.0)).beyond() - 0.18).abs() < 0.03);
        let body = fixture::body();
        let poses = fixture::poses(&body, 360, |_, _| {});
        let track = Track::new(fixture::motion(&body, &poses)).expect("sound");
        assert_eq!(speed_gain(&track, &dynamics(&track, &[]), &[push(0.0, 3.0)]), None, "a pull has none");
    }

    #[test]
    fn a_pendulum_that_falls_with_the_push_gains_what_it_can_and_no_body_a_third_more() {
        let falls = gain(falling(1.0));
        assert!((falls.ratio * OVER_PENDULUM / falls.within[1] - 1.0).abs() < 0.03, "{falls:?}");
        assert!(falls.ratio > 1.5 && falls.beyond() == 0.0, "{falls:?}");
        assert!(gain(falling(1.33)).beyond() > 0.2);
    }

    #[test]
    fn a_sway_that_goes_on_through_the_push_is_not_the_pushs() {
        let sway = |t: f64| 0.05 * real::sin_cos(std::f64::consts::TAU * t).0;
        let push = shoved(1.0, 0.0);
        let both = gain(|t| push(t) + sway(t));
        assert!(both.beyond() == 0.0 && both.within[0] < 0.1, "{both:?}");
        let pause = shoved(0.05, 0.0);
        assert!(gain(pause).beyond() > 0.4, "a stand that hardly moves is stiff");
    }
}
