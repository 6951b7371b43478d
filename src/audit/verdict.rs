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
        lift_off: feet.contacts[step.from].last(),
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
        let parts: Vec<&'static str> =
            (contact.start..=contact.last()).map(|frame| part(track, contact, frame)).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::audit;
    use crate::audit::contacts::footfalls;
    use crate::audit::domain::domain;
    use crate::audit::fixture::{Gait, seat, stand, walk};
    use crate::maths::real;
    use glam::DQuat;

    #[test]
    fn a_pitched_foot_bears_on_its_ball_or_heel() {
        for (angle, expected) in [(0.35, "ball"), (-0.35, "heel"), (0.0, "flat")] {
            let mut capture = stand(2.0);
            let ankle = capture.body.feet[0].ankle;
            let toe = capture.body.feet[0].toe.expect("the body has toes");
            let joints = capture.body.joints.len();
            let turn = DQuat::from_rotation_x(angle);
            for frame in 0..capture.frames() {
                let from = capture.body.joints[toe].rest - capture.body.joints[ankle].rest;
                capture.turns[frame * joints + ankle] = turn;
                capture.positions[frame * joints + toe] = capture.at(frame)[ankle] + turn * from;
                // Toes stay level under a raised heel and rise with the foot before them.
                capture.turns[frame * joints + toe] = if angle < 0.0 { turn } else { DQuat::IDENTITY };
            }
            let track = Track::new(&capture);
            let feet = footfalls(&track);
            let told = contacts(&track, &feet);
            let left = told.iter().find(|contact| contact.foot == "left").expect("it bears");
            assert_eq!(left.part, expected, "{told:?}");
        }
    }

    #[test]
    fn parts_of_a_contact_join_and_cover_it() {
        let capture = walk(Gait::default());
        let track = Track::new(&capture);
        let feet = footfalls(&track);
        let told = contacts(&track, &feet);
        let frames = |list: &[(usize, usize)]| list.iter().map(|(start, end)| end - start + 1).sum::<usize>();
        let all: Vec<(usize, usize)> = feet.contacts.iter().map(|contact| (contact.start, contact.last())).collect();
        let parts: Vec<(usize, usize)> = told.iter().map(|contact| (contact.start, contact.end)).collect();
        assert_eq!(frames(&all), frames(&parts));
        assert!(told.windows(2).all(|pair| pair[0].start <= pair[1].start));
    }

    #[test]
    fn a_verdict_is_trusted_less_where_less_is_seen() {
        let trust_in = |capture: &crate::model::Capture| {
            let track = Track::new(capture);
            let feet = footfalls(&track);
            trust(&feet, &domain(&track, &feet))
        };
        let (walks, stands, sits) = (trust_in(&walk(Gait::default())), trust_in(&stand(2.0)), trust_in(&seat(2.0)));
        assert_eq!(walks, 1.0);
        assert!(stands < walks && sits < stands, "{walks} {stands} {sits}");
    }

    #[test]
    fn steps_are_told_with_their_feet_in_turn() {
        let found = audit(&walk(Gait::default()), &Default::default());
        assert!(found.steps.len() >= 7);
        assert!(found.steps.windows(2).all(|pair| pair[0].foot != pair[1].foot));
        for step in &found.steps {
            assert!(step.lift_off < step.touch_down, "{step:?}");
            assert!((step.error_m - real::hypot(step.error_forward_m, step.error_sideways_m)).abs() < 1e-9);
        }
    }
}
