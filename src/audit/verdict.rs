//! What was found in the words of the findings' format: contacts by part, steps, confidence.
//!
//! Clip space, m; frames.

use super::Domain;
use super::contacts::{Contact, Footfalls};
use super::placement::Judged;
use super::track::Track;
use crate::model::findings::{Findings, FootContact, StepVerdict};
use crate::model::{Capture, Side};

/// m: a heel (a ball) higher over the contact than that is off the ground.
const LIFTED: f64 = 0.03;

/// Findings that say nothing yet.
pub fn empty(capture: &Capture) -> Findings {
    Findings {
        version: 1,
        clip: capture.name.clone(),
        fps: capture.fps,
        frames: capture.frames(),
        units_to_metres: capture.units_to_metres,
        up: capture.up.clone(),
        confidence: capture.confidence,
        flags: Vec::new(),
        clip_flags: Vec::new(),
        contacts: Vec::new(),
        steps: Vec::new(),
        abstained: Vec::new(),
        notes: capture.notes.clone(),
    }
}

/// "left", "right".
pub fn foot_name(side: Side) -> &'static str {
    if side == Side::Left { "left" } else { "right" }
}

/// A judged step.
pub fn step(feet: &Footfalls, judged: &Judged) -> StepVerdict {
    let step = judged.taken.step;
    let landing = &feet.contacts[step.to];
    StepVerdict {
        foot: foot_name(step.side),
        touch_down: landing.start,
        lift_off: feet.contacts[step.from].end,
        predicted: judged.predicted.to_array(),
        actual: landing.place.to_array(),
        error_m: judged.error.length(),
        error_forward_m: judged.error.x,
        error_sideways_m: judged.error.y,
        stopping_m: judged.taken.stopping,
        lead_m: (landing.place - judged.taken.com).dot(judged.taken.ahead),
    }
}

/// Every contact, by the part of the sole that bears.
pub fn contacts(track: &Track, feet: &Footfalls) -> Vec<FootContact> {
    let mut told: Vec<FootContact> = Vec::new();
    for contact in &feet.contacts {
        let parts: Vec<&'static str> = (contact.start..=contact.end).map(|frame| part(track, contact, frame)).collect();
        let mut from = 0;
        for at in 1..=parts.len() {
            if at == parts.len() || parts[at] != parts[from] {
                let (start, end) = (contact.start + from, contact.start + at - 1);
                told.push(FootContact { foot: foot_name(contact.side), part: parts[from], start, end });
                from = at;
            }
        }
    }
    told.sort_by_key(|contact| (contact.start, contact.foot));
    told
}

/// "heel", "ball" or "flat".
pub fn part(track: &Track, contact: &Contact, frame: usize) -> &'static str {
    let foot = &track.feet[contact.side as usize];
    let [heel, ball, tip] = foot.points[frame];
    let lowest = foot.low[frame];
    let lifted = LIFTED * track.size();
    match (heel.y - lowest > lifted, ball.y.min(tip.y) - lowest > lifted) {
        (true, _) => "ball",
        (false, true) => "heel",
        (false, false) => "flat",
    }
}

/// 0..1: how far the verdict is to be believed, by what was seen.
pub fn trust(feet: &Footfalls, domain: &Domain) -> f64 {
    let steps = feet.steps.len() as f64;
    let stands = if feet.contacts.is_empty() { 0.3 } else { 1.0 };
    (0.3 + 0.7 * domain.share()) * (0.7 + 0.3 * (steps / 4.0).min(1.0)) * stands
}
