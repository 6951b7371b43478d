//! A flight that does not fall as bodies fall: the body rises and sinks on gravity's parabola between the same take-off and landing.
//!
//! Clip space, SI. The length of the flight stays, so a flight that was slowed becomes a higher one. What would have to fly more than
//! [`HIGHEST`] over what the clip shows flies that much higher and is told to fall too slowly still, or is left alone if that is not nearly
//! enough: such a span has to be retimed, which moves every later frame of the clip.

use super::Fix;
use super::posing::Piece;
use super::seen::Seen;
use crate::measure::GRAVITY;
use crate::model::findings::{Findings, Rule};
use glam::DVec3;

/// Of the leg's length: what a flight gains at most.
const HIGHEST: f64 = 0.6;
/// Of gravity: a flight that could not be brought to fall as fast as that is left alone.
const FALLS: f64 = 0.75;
/// Of the leg's length: the centre of mass of a body that jumps.
const UPRIGHT: f64 = 0.85;

/// Proposals for the flags of ballistic.
pub fn fixes(seen: &Seen, findings: &Findings, attempt: usize) -> Vec<Fix> {
    if attempt > 0 {
        return Vec::new();
    }
    let flags = findings.flags.iter().filter(|flag| flag.rule == Rule::Ballistic);
    let mut fixes = Vec::new();
    for flag in flags {
        let capture = seen.capture();
        let (from, to) = (flag.start.saturating_sub(1), (flag.end + 1).min(seen.track.len() - 1));
        let height = |frame: usize| capture.centre_of_mass(frame).y;
        // A body that is low as it takes off or lands falls down or gets up.
        let low = |frame: usize| {
            height(frame) - seen.feet.floor_at(frame, seen.track.below(frame)) < UPRIGHT * capture.body.leg_length
        };
        if low(from) || low(to) {
            continue;
        }
        let seconds = (to - from) as f64 / capture.fps;
        let rises: Vec<f64> = (flag.start..=flag.end)
            .map(|frame| {
                let t = (frame - from) as f64 / capture.fps;
                let line = height(from) + (height(to) - height(from)) * t / seconds;
                line + 0.5 * GRAVITY * t * (seconds - t) - height(frame)
            })
            .collect();
        let most = rises.iter().map(|rise| rise.abs()).fold(0.0, f64::max);
        let share = (HIGHEST * capture.body.leg_length / most.max(1e-9)).min(1.0);
        let falls = flag.measured + (GRAVITY - flag.measured) * share;
        if falls < FALLS * GRAVITY || (share < 1.0 && flag.measured > GRAVITY) {
            continue;
        }
        let mut piece = Piece::cut(capture, flag.start, flag.end);
        for (frame, rise) in (flag.start..=flag.end).zip(&rises) {
            piece.shift(frame, DVec3::Y * *rise * share);
        }
        let moved = most * share;
        let short = if share < 1.0 {
            format!(
                "; for {GRAVITY} it would have to fly {:.0} cm higher still, or be played faster",
                100.0 * (most - moved)
            )
        } else {
            String::new()
        };
        let what =
            format!("the flight falls at {falls:.2} m/s², up to {:.1} cm from where it was{short}", 100.0 * moved);
        fixes.push(Fix { piece, flags: vec![flag.clone()], moved, what, held: Vec::new() });
    }
    fixes
}

#[cfg(test)]
mod tests {
    use crate::audit::fixture::jump;
    use crate::correct::{CorrectOptions, correct};
    use crate::model::findings::Rule;

    #[test]
    fn a_flight_that_would_have_to_go_too_high_goes_as_high_as_it_may_and_says_so() {
        for (seconds, short) in [(0.45, false), (0.58, true)] {
            let capture = jump(seconds, 0.6);
            let corrected = correct(&capture, &CorrectOptions::default());
            assert!(corrected.before.flags.iter().any(|flag| flag.rule == Rule::Ballistic), "{seconds}");
            assert!(corrected.after.flags.is_empty(), "{seconds}: {:?}", corrected.after.flags);
            let done = &corrected.done[0];
            assert!(done.moved_m <= super::HIGHEST * capture.body.leg_length + 1e-9, "{done:?}");
            assert_eq!(done.what.contains("higher still"), short, "{done:?}");
        }
    }

    #[test]
    fn a_flight_that_hangs_in_the_air_is_left_alone() {
        let corrected = correct(&jump(0.58, 0.5), &CorrectOptions::default());
        assert!(corrected.changed.is_empty() && !corrected.after.flags.is_empty());
        assert!(corrected.notes.iter().any(|note| note.contains("falls at")), "{:?}", corrected.notes);
    }
}
