//! A clip that plays at the wrong speed: by how much faster it must play.
//!
//! The pendulum's clock (`audit::timing`) tells it. Retiming changes the frame rate alone: every pose stays as it is.

use super::seen::with_seen;
use crate::audit::{AuditOptions, audit, timing};
use crate::model::Capture;
use crate::model::findings::{Findings, Rule};

/// By how much faster the clip has to play; `None` where its clock is not flagged.
pub fn speed(capture: &Capture, findings: &Findings, floor: Option<f64>) -> Option<f64> {
    findings.clip_flags.iter().find(|flag| flag.rule == Rule::Timing)?;
    let clock =
        with_seen(capture, floor, |seen| timing::clock(&seen.track, &seen.feet, &seen.domain, seen.judged.len()))??;
    // Across the way a walk keeps to its clock whatever its style; a clip that is too fast shows it in both.
    let mean = (clock.across.max(0.0) * clock.along.max(0.0)).sqrt();
    let measured = if mean > 1.0 { mean } else { clock.across };
    Some((1.0 / measured.max(0.06).sqrt()).clamp(0.25, 4.0))
}

/// The clip at a frame rate at which its clock is right, and what is found then; `None` if there is none.
pub fn retimed(capture: &Capture, findings: &Findings, options: &AuditOptions) -> Option<(Capture, Findings)> {
    const TRIES: usize = 4;
    let (mut clip, mut found) = (capture.clone(), findings.clone());
    for _ in 0..TRIES {
        let faster = speed(&clip, &found, options.floor)?;
        clip.fps *= faster;
        // What pushed it, pushes in the same frames.
        for push in &mut clip.pushes {
            (push.start, push.end) = (push.start / faster, push.end / faster);
        }
        found = audit(&clip, options);
        if !found.clip_flags.iter().any(|flag| flag.rule == Rule::Timing) {
            return Some((clip, found));
        }
    }
    None
}
