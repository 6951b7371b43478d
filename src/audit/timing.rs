//! The clip's clock: a pendulum of that body swings at one rate, and a clip that plays too slow or too fast swings at another.
//!
//! Clip space, SI. On one foot the centre of mass is driven away from it at ω² times its distance, ω² = g/h: the slope of the horizontal
//! acceleration over the distance, across the way and along it, is a clock that gravity winds. A clip at 0.6 of its speed shows 0.36 of
//! the slope. (Captured walks and turns lie within 0.78 to 1.45 across, whatever their style; cadence alone does not tell a slow clip from
//! a tired walker.) What it leaves out: clips without single support, and spans that are too slow or too fast within a clip that is not.

use super::Domain;
use super::contacts::Footfalls;
use super::track::Track;
use crate::measure::GRAVITY;
use crate::model::Side;
use crate::model::findings::{ClipFlag, Rule};
use glam::DVec2;

/// Measured over expected ω², from which a clip is slow, across and along.
const SLOW: (f64, f64) = (0.62, 0.62);
/// Their geometric mean from which it is fast.
const FAST: f64 = 1.5;
/// m/s: slower than that nobody walks.
const WALKS: f64 = 0.12;
/// Share of the clip that must be walked or stood.
const WALKED: f64 = 0.5;
/// Frames in single support and steps that tell a rate.
const LEAST: (usize, usize) = (20, 4);
/// See [`SLOW`]: of a clip with fewer steps, one at least; that it is fast is not told.
const FEW: (f64, f64) = (0.5, 0.5);

/// s: a told push shows in the filtered motion for as long before it and after it; meanwhile the pendulum is not alone.
const PUSHED: f64 = 0.1;

/// Measured over expected ω².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Across the way.
    pub across: f64,
    /// Along it.
    pub along: f64,
    /// Of so few steps that only a plain case is told.
    pub few: bool,
}

/// The clip's, from its walking, of which so many steps could be judged; `None` where there is too little of it.
pub fn clock(track: &Track, feet: &Footfalls, domain: &Domain, steps: usize) -> Option<Clock> {
    let mut sums = [[0.0; 2]; 2]; // across, along: distance², distance x acceleration
    let (mut frames, mut expected) = (0, 0.0);
    for frame in 0..track.len() {
        let [left, right] = Side::BOTH.map(|side| feet.of[side as usize][frame]);
        let stance = match (left, right) {
            (Some(contact), None) | (None, Some(contact)) if domain.walks(frame) && !is_pushed(track, frame) => {
                &feet.contacts[contact]
            }
            _ => continue,
        };
        let flat = |vector: glam::DVec3| DVec2::new(vector.x, vector.z);
        let velocity = flat(track.velocity[frame]);
        if velocity.length() < WALKS * track.tempo() {
            continue;
        }
        let ahead = velocity.normalize();
        let distance = flat(track.com[frame]) - stance.place;
        let acceleration = flat(track.acceleration[frame]);
        for (axis, sums) in [ahead.perp(), ahead].into_iter().zip(&mut sums) {
            sums[0] += distance.dot(axis).powi(2);
            sums[1] += distance.dot(axis) * acceleration.dot(axis);
        }
        frames += 1;
        expected += track.omega(frame, stance.height).powi(2);
    }
    if frames < LEAST.0 || steps == 0 || domain.share() < WALKED {
        return None;
    }
    let expected = expected / frames as f64;
    let slope = |sums: [f64; 2]| sums[1] / sums[0].max(1e-9) / expected;
    Some(Clock { across: slope(sums[0]), along: slope(sums[1]), few: steps < LEAST.1 })
}

/// Whether something that the clip tells of pushes the body.
fn is_pushed(track: &Track, frame: usize) -> bool {
    let time = frame as f64 / track.capture.fps;
    track.capture.pushes.iter().any(|push| (push.start - PUSHED..=push.end + PUSHED).contains(&time))
}

/// The mark of the rule.
pub fn mark(clock: Clock) -> Option<ClipFlag> {
    let limit = if clock.few { FEW } else { SLOW };
    let slow = clock.across < limit.0 && clock.along < limit.1 && clock.across > 0.0;
    let mean = (clock.across.max(0.0) * clock.along.max(0.0)).sqrt();
    if !slow && (clock.few || mean <= FAST) {
        return None;
    }
    let speed = if slow { clock.across.sqrt() } else { mean.sqrt() };
    let word = if slow { "slower" } else { "faster" };
    Some(ClipFlag {
        rule: Rule::Timing,
        severity: (1.0 - speed.min(1.0 / speed)).clamp(0.0, 1.0) * 2.0_f64.min(1.0 / speed.min(1.0)),
        why: format!(
            "the body sways {word} than gravity lets it: the clip plays at about {speed:.1} of its speed (ω² {:.2} of g/h, {:.2} m/s² expected a metre)",
            if slow { clock.across } else { mean },
            GRAVITY
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::contacts::footfalls;
    use crate::audit::domain::domain;
    use crate::audit::fixture::{Gait, at_speed, resized, stand, walk};
    use crate::model::Capture;
    use glam::DVec3;

    fn found(capture: &Capture) -> Option<Clock> {
        let track = Track::new(capture);
        let feet = footfalls(&track);
        let domain = domain(&track, &feet);
        clock(&track, &feet, &domain, feet.steps.len())
    }

    #[test]
    fn frames_in_which_a_told_push_acts_wind_no_clock() {
        let mut capture = walk(Gait::default());
        let free = found(&capture).expect("it walks");
        let push =
            |start: f64, end: f64| crate::model::capture::ToldPush { start, end, force: DVec3::X * 80.0, joint: None };
        capture.pushes = vec![push(1.0, 1.4)];
        let pushed = found(&capture).expect("it walks");
        assert!(pushed != free && (pushed.across - free.across).abs() < 0.2, "{pushed:?} {free:?}");
        capture.pushes = vec![push(0.0, 1e3)];
        assert_eq!(found(&capture), None);
    }

    #[test]
    fn a_pendulums_clock_is_right_at_any_speed_of_walking_and_size() {
        for speed in [0.6, 1.0, 1.3] {
            for scale in [0.5, 1.0, 1.5] {
                let capture = resized(&walk(Gait { speed, ..Gait::default() }), scale);
                let clock = found(&capture).expect("it walks");
                assert!((0.75..1.2).contains(&clock.across) && (0.75..1.2).contains(&clock.along), "{clock:?}");
                assert!(mark(clock).is_none());
            }
        }
    }

    #[test]
    fn a_walk_at_six_tenths_of_its_speed_is_told_and_one_at_one_and_a_half() {
        let walk = walk(Gait::default());
        for (speed, word) in [(0.6, "slower"), (1.5, "faster")] {
            let clock = found(&at_speed(&walk, speed)).expect("it walks");
            let told = mark(clock).unwrap_or_else(|| panic!("{speed}: {clock:?}"));
            assert!(told.why.contains(word), "{}", told.why);
            assert!((0.0..=1.0).contains(&told.severity) && told.rule == Rule::Timing);
            assert!((clock.across.sqrt() - speed).abs() < 0.2 * speed, "{clock:?}");
        }
    }

    #[test]
    fn who_stands_has_no_clock() {
        assert!(found(&stand(5.0)).is_none());
    }
}
