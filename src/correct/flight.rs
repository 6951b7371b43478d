//! A flight that does not fall as bodies fall: the body rises and sinks on gravity's parabola between the same take-off and landing.
//!
//! Clip space, SI. The length of the flight stays, so a flight that was slowed becomes a higher one. What would have to fly more than
//! [`HIGHEST`] over what the clip shows is left alone: such a span has to be retimed, which moves every later frame of the clip.

use super::Fix;
use super::posing::Piece;
use super::seen::Seen;
use crate::measure::GRAVITY;
use crate::model::findings::{Findings, Rule};
use glam::DVec3;

/// Of the leg's length: what a flight gains at most.
const HIGHEST: f64 = 0.6;
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
        let mut piece = Piece::cut(capture, flag.start, flag.end);
        let mut moved: f64 = 0.0;
        for frame in flag.start..=flag.end {
            let t = (frame - from) as f64 / capture.fps;
            let line = height(from) + (height(to) - height(from)) * t / seconds;
            let rise = line + 0.5 * GRAVITY * t * (seconds - t) - height(frame);
            moved = moved.max(rise.abs());
            piece.shift(frame, DVec3::Y * rise);
        }
        if moved < HIGHEST * capture.body.leg_length {
            let what = format!("the flight falls at {GRAVITY} m/s², up to {:.1} cm from where it was", 100.0 * moved);
            fixes.push(Fix { piece, flag: flag.clone(), moved, what, held: Vec::new() });
        }
    }
    fixes
}
