//! Where the pendulum is no model of what happens, and the audit abstains: running flight, sitting or lying, hands that hold something, no
//! steps to speak of.
//!
//! Clip space, SI. Each frame is either walked and stood (judged by every rule) or has a reason why only the soles are judged.

use super::contacts::Footfalls;
use super::track::Track;
use crate::model::findings::Abstained;
use crate::model::{Role, Side};

/// s: shorter gaps between contacts are no flight.
const FLIGHT: f64 = 0.05;
/// s: before a flight and after it the stride is a running one.
const STRIDE: f64 = 0.35;
/// Of the leg's length: a centre of mass lower than that over the floor sits, kneels or lies.
const LOW: f64 = 0.72;
/// s and m/s: a hand that is still so long while the body moves holds something.
const HELD: (f64, f64, f64) = (0.4, 0.06, 0.25);
/// s: what lies between two spans of abstaining is none of its own if shorter.
const JOIN: f64 = 0.4;

/// Why nothing is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// Both feet are off the ground.
    Flight,
    /// The body is too low.
    Low,
    /// A hand is on something.
    Hands,
    /// Nothing bears that is seen.
    Unsupported,
    /// A pose before the motion begins.
    Pose,
}

impl Reason {
    fn words(self) -> &'static str {
        match self {
            Reason::Flight => "flight: a run or a jump is no inverted pendulum",
            Reason::Low => "the body is too low for a pendulum on legs: it sits, kneels or lies",
            Reason::Hands => "a hand rests on something that is not in the clip",
            Reason::Pose => "a pose that stands before the motion begins",
            Reason::Unsupported => "no foot bears: what carries the body is not seen",
        }
    }
}

/// Frame by frame.
#[derive(Clone, Debug)]
pub struct Domain {
    /// (frames)
    pub reasons: Vec<Option<Reason>>,
}

impl Domain {
    /// Whether the pendulum applies.
    pub fn walks(&self, frame: usize) -> bool {
        self.reasons[frame].is_none()
    }

    /// Whether it applies in all of a span.
    pub fn walks_in(&self, start: usize, end: usize) -> bool {
        self.reasons[start..=end].iter().all(Option::is_none)
    }

    /// Says nothing of so many frames at the beginning.
    pub fn begin_after(&mut self, frames: usize) {
        self.reasons[..frames].fill(Some(Reason::Pose));
    }

    /// Share of the frames in which it does.
    pub fn share(&self) -> f64 {
        self.reasons.iter().filter(|reason| reason.is_none()).count() as f64 / self.reasons.len().max(1) as f64
    }

    /// As the findings tell it.
    pub fn abstained(&self) -> Vec<Abstained> {
        let mut told: Vec<Abstained> = Vec::new();
        let mut last: Option<Reason> = None;
        for (frame, reason) in self.reasons.iter().enumerate() {
            match (reason, told.last_mut()) {
                (Some(reason), Some(span)) if last == Some(*reason) => span.end = span.end.max(frame),
                (Some(reason), _) => {
                    told.push(Abstained { start: frame, end: frame, why: reason.words().to_owned() });
                }
                _ => {}
            }
            last = *reason;
        }
        told
    }
}

/// Looks at every frame.
pub fn domain(track: &Track, feet: &Footfalls) -> Domain {
    let frames = track.len();
    let hz = track.capture.fps;
    let mut reasons: Vec<Option<Reason>> = vec![None; frames];
    let mut set = |start: usize, end: usize, reason: Reason| {
        for slot in &mut reasons[start..=end.min(frames - 1)] {
            *slot = slot.or(Some(reason));
        }
    };
    let stride = (STRIDE * track.tempo() * hz).round() as usize;
    for (start, end) in super::flight::flights(track, feet) {
        let seconds = (end - start + 1) as f64 / hz;
        if seconds >= FLIGHT * track.tempo() {
            let falls = (start..=end).any(|frame| track.acceleration[frame].y < -0.35 * crate::measure::GRAVITY);
            let reason = if falls || seconds < 0.6 { Reason::Flight } else { Reason::Unsupported };
            set(start.saturating_sub(stride), end + stride, reason);
        }
    }
    let low = LOW * track.capture.body.leg_length;
    for (start, end) in
        super::spans(frames, |frame| track.com[frame].y - feet.floor_at(frame, track.below(frame)) < low)
    {
        set(start, end, Reason::Low);
    }
    for (start, end) in held(track) {
        set(start, end, Reason::Hands);
    }
    let join = (JOIN * hz).round() as usize;
    let gaps = super::spans(frames, |frame| reasons[frame].is_none());
    for (start, end) in gaps {
        if end - start < join && start > 0 && end + 1 < frames {
            let reason = reasons[start - 1];
            reasons[start..=end].fill(reason);
        }
    }
    Domain { reasons }
}

/// Spans in which a hand is still in the world while the body goes on.
fn held(track: &Track) -> Vec<(usize, usize)> {
    let hz = track.capture.fps;
    let body = &track.capture.body;
    let mut found = Vec::new();
    for side in Side::BOTH {
        let role = if side == Side::Left { Role::LeftHand } else { Role::RightHand };
        let Some(hand) = body.joint(role).filter(|joint| body.joints[*joint].animated) else { continue };
        let path: Vec<glam::DVec3> = (0..track.len()).map(|frame| track.capture.at(frame)[hand]).collect();
        let speed = crate::maths::filter::derivative(&path, hz);
        let still = |frame: usize| {
            speed[frame].length() < HELD.1 * track.size() && track.velocity[frame].length() > HELD.2 * track.size()
        };
        let long = (HELD.0 * hz).round() as usize;
        found.extend(super::spans(track.len(), still).into_iter().filter(|(start, end)| end - start >= long));
    }
    found
}
