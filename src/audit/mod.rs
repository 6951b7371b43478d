//! A clip's motion to findings: which frames no balanced person could have produced.
//!
//! The way of a clip: capture -> [`track`] (centre of mass, feet) -> [`contacts`] (floor, contacts, steps) -> the rules, each a file of its
//! own -> [`Findings`]. Clip space, SI.

pub mod contacts;
pub mod placement;
pub mod track;

use crate::model::findings::{Abstained, ClipFlag, Findings, Flag, FootContact, Rule, StepVerdict};
use crate::model::{Capture, Side};
use contacts::footfalls;
use track::Track;

/// What a person may set.
#[derive(Clone, Debug, Default)]
pub struct AuditOptions {
    /// m over the file's zero: where the floor is, if the feet shall not tell.
    pub floor: Option<f64>,
    /// Rules that are not asked.
    pub without: Vec<Rule>,
}

/// m: a foothold that is off by more is flagged, forward and sideways, at a leg of 0.83 m.
const PLACED: (f64, f64) = (0.13, 0.10);

/// Judges a clip.
pub fn audit(capture: &Capture, options: &AuditOptions) -> Findings {
    let mut findings = Findings {
        version: 1,
        clip: capture.name.clone(),
        fps: capture.fps,
        frames: capture.frames(),
        units_to_metres: capture.units_to_metres,
        up: capture.up.clone(),
        confidence: capture.confidence,
        flags: Vec::new(),
        clip_flags: Vec::<ClipFlag>::new(),
        contacts: Vec::new(),
        steps: Vec::new(),
        abstained: Vec::<Abstained>::new(),
        notes: capture.notes.clone(),
    };
    if capture.frames() == 0 {
        return findings;
    }
    let _ = options;
    let track = Track::new(capture);
    let feet = footfalls(&track);
    let taken = placement::taken(&track, &feet);
    for judged in placement::judge(&track, &feet, &taken) {
        let landing = &feet.contacts[judged.taken.step.to];
        findings.steps.push(StepVerdict {
            foot: foot_name(landing.side),
            touch_down: landing.start,
            lift_off: feet.contacts[judged.taken.step.from].end,
            predicted: judged.predicted.to_array(),
            actual: landing.place.to_array(),
            error_m: judged.error.length(),
            error_forward_m: judged.error.x,
            error_sideways_m: judged.error.y,
        });
        let (along, out) = (judged.error.x / track.size(), judged.error.y / track.size());
        let worst = (along.abs() / PLACED.0).max(out.abs() / PLACED.1);
        if worst > 1.0 {
            findings.flags.push(Flag {
                start: landing.start,
                end: landing.end,
                rule: Rule::FootPlacement,
                foot: Some(foot_name(landing.side)),
                severity: (1.0 - 1.0 / worst).clamp(0.0, 1.0),
                measured: (judged.taken.step.to as f64) * 0.0 + judged.error.length(),
                predicted: 0.0,
                delta_m: judged.error.length(),
                why: format!("{:.2} {:.2}", judged.error.x, judged.error.y),
            });
        }
    }
    findings.contacts = feet
        .contacts
        .iter()
        .map(|contact| FootContact {
            foot: foot_name(contact.side),
            part: "flat",
            start: contact.start,
            end: contact.end,
        })
        .collect();
    findings
}

/// "left", "right".
pub fn foot_name(side: Side) -> &'static str {
    if side == Side::Left { "left" } else { "right" }
}
