//! A clip that plays at the wrong speed: by how much faster it must play.
//!
//! The pendulum's clock (`audit::timing`) tells it. Retiming changes the frame rate alone: every pose stays as it is.

use super::seen::with_seen;
use crate::audit::timing;
use crate::model::Capture;
use crate::model::findings::{Findings, Rule};

/// By how much faster the clip has to play; `None` where its clock is not flagged.
pub fn speed(capture: &Capture, findings: &Findings) -> Option<f64> {
    findings.clip_flags.iter().find(|flag| flag.rule == Rule::Timing)?;
    let clock = with_seen(capture, |seen| timing::clock(&seen.track, &seen.feet, &seen.domain))?;
    let measured = (clock.across.max(0.05) * clock.along.max(0.05)).sqrt();
    Some((1.0 / measured.sqrt()).clamp(0.25, 4.0))
}
