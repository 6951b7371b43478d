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
    /// The body walks on the spot.
    InPlace,
    /// The body goes where no feet could push it.
    Thrown,
    /// Fast limbs: a blow, a throw, a dance.
    Action,
    /// Nothing in it is physical: keyed for effect.
    Keyed,
    /// Feet are far under what looks like the floor.
    NoFloor,
    /// The clip is over before anything shows.
    Short,
}

impl Reason {
    fn words(self) -> &'static str {
        match self {
            Reason::Flight => "flight: a run or a jump is no inverted pendulum",
            Reason::Low => "the body is too low for a pendulum on legs: it sits, kneels or lies",
            Reason::Hands => "a hand rests on something that is not in the clip",
            Reason::InPlace => {
                "the clip plays in place: the feet go under a body that stays; bake its way into the root to have it judged"
            }
            Reason::Thrown => {
                "the body is thrown about as no feet could: keyed action, or something pushes that is not in the clip"
            }
            Reason::Action => "fast limbs: blows, throws and dance are balanced by more than feet",
            Reason::Keyed => {
                "keyed, not physical: its balance is off all through, so no frame of it is judged by itself"
            }
            Reason::NoFloor => {
                "the feet agree on no floor: a piece of a jump or a climb, or a floor that is not in the clip"
            }
            Reason::Short => "the clip is too short to show a floor and a balance",
            Reason::Pose => "a pose that stands before the motion begins",
            Reason::Unsupported => "no foot bears: what carries the body is not seen",
        }
    }
}

/// m/s at a leg of 0.83 m, of a hand about the hips: faster is no gait.
const BLOW: f64 = 5.0;
/// s: and so much around it.
const AROUND: f64 = 0.35;
/// One frame in so many in which feet (or the pendulum) tell nothing takes the others of a span along.
const MUTE: usize = 4;
/// Cosine of a thigh against straight down: flatter on both sides, the body sits.
const SEATED: f64 = 0.45;
/// m at a leg of 0.83 m: feet are no deeper in a floor that is theirs.
const DEEPEST: f64 = 0.12;
/// Of the frames: where feet are deeper in more of them, nothing is known of the floor in any.
const DEEP: f64 = 0.2;
/// Of the frames, and contacts: a clip in which feet bear in no more of them shows no floor.
const BEARS: (f64, usize) = (0.25, 2);
/// s, not the body's but the filters': a shorter clip is beginning and end alone.
const SHORTEST: f64 = 0.6;
/// m/s, and m/s: low feet that go as fast under a centre of mass that goes no faster, the clip through.
const TREADMILL: (f64, f64) = (0.35, 0.12);

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

    /// Whether it applies in nearly all of a span.
    pub fn mostly_walks_in(&self, start: usize, end: usize) -> bool {
        MUTE * self.reasons[start..=end].iter().filter(|reason| reason.is_some()).count() < end - start + 1
    }

    /// Says nothing of so many frames at the beginning.
    pub fn begin_after(&mut self, frames: usize) {
        self.reasons[..frames].fill(Some(Reason::Pose));
    }

    /// Says nothing of a span for that reason, where there is none yet.
    pub fn add(&mut self, start: usize, end: usize, reason: Reason) {
        for slot in &mut self.reasons[start..=end] {
            *slot = slot.or(Some(reason));
        }
    }

    /// Whether feet tell anything in nearly all of a span: they do not under a body that sits, lies or walks in place.
    pub fn stands_in(&self, start: usize, end: usize) -> bool {
        let mute = |reason: &&Option<Reason>| {
            matches!(
                reason,
                Some(
                    Reason::Low
                        | Reason::Unsupported
                        | Reason::InPlace
                        | Reason::Pose
                        | Reason::Action
                        | Reason::Thrown
                        | Reason::Keyed
                        | Reason::NoFloor
                        | Reason::Short
                )
            )
        };
        MUTE * self.reasons[start..=end].iter().filter(mute).count() < end - start + 1
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
    for (start, end) in super::spans(frames, |frame| sits(track, frame)) {
        set(start, end, Reason::Low);
    }
    let around = (AROUND * hz).round() as usize;
    for (start, end) in blows(track) {
        set(start.saturating_sub(around), end + around, Reason::Action);
    }
    for (start, end) in held(track) {
        set(start, end, Reason::Hands);
    }
    let deep = |frame: usize| !feet.ground.uneven && deepest(track, feet, frame) > DEEPEST * track.size();
    if (0..frames).filter(|frame| deep(*frame)).count() as f64 > DEEP * frames as f64 {
        reasons.fill(Some(Reason::NoFloor));
    }
    if !bears_enough(feet, frames) {
        reasons.fill(Some(Reason::NoFloor));
    }
    if in_place(track) {
        reasons.fill(Some(Reason::InPlace));
    }
    if (frames as f64) < SHORTEST * hz {
        reasons.fill(Some(Reason::Short));
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

/// Whether feet are on the ground for long enough, or often enough, to show where it is.
fn bears_enough(feet: &Footfalls, frames: usize) -> bool {
    let bearing = (0..frames).filter(|frame| feet.bearing(*frame) > 0).count();
    feet.contacts.len() > BEARS.1 || bearing as f64 > BEARS.0 * frames as f64
}

/// m: how far the deeper foot is under its floor.
fn deepest(track: &Track, feet: &Footfalls, frame: usize) -> f64 {
    let under = |side: Side| {
        let foot = &track.feet[side as usize];
        feet.ground.under(side, foot.place(frame)) - foot.low[frame]
    };
    under(Side::Left).max(under(Side::Right))
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

/// Whether both thighs lie.
fn sits(track: &Track, frame: usize) -> bool {
    let body = &track.capture.body;
    let places = track.capture.at(frame);
    Side::BOTH.into_iter().all(|side| {
        let (hip, knee) = match side {
            Side::Left => (Role::LeftUpperLeg, Role::LeftLowerLeg),
            Side::Right => (Role::RightUpperLeg, Role::RightLowerLeg),
        };
        let (Some(hip), Some(knee)) = (body.joint(hip), body.joint(knee)) else { return false };
        (places[hip] - places[knee]).normalize_or_zero().y < SEATED
    })
}

/// Spans in which a hand is faster about the hips than a gait swings it.
fn blows(track: &Track) -> Vec<(usize, usize)> {
    let body = &track.capture.body;
    let mut found = Vec::new();
    for role in [Role::LeftHand, Role::RightHand] {
        let Some(hand) = body.joint(role) else { continue };
        let path: Vec<glam::DVec3> =
            (0..track.len()).map(|frame| track.capture.at(frame)[hand] - track.capture.at(frame)[0]).collect();
        let speed = crate::maths::filter::derivative(&path, track.capture.fps);
        found.extend(super::spans(track.len(), |frame| speed[frame].length() > BLOW * track.size()));
    }
    found
}

/// Whether the lower foot goes over the ground all the time while the centre of mass does not.
fn in_place(track: &Track) -> bool {
    let frames = track.len();
    let way = track.com[frames - 1] - track.com[0];
    let seconds = (frames as f64 - 1.0).max(1.0) / track.capture.fps;
    let slow = way.length() / seconds < TREADMILL.1 * track.size();
    let speeds: Vec<f64> = (0..frames)
        .map(|frame| {
            let [left, right] = &track.feet;
            if left.low[frame] < right.low[frame] { left.still[frame] } else { right.still[frame] }
        })
        .collect();
    slow && super::placement::median(&speeds) > TREADMILL.0 * track.tempo()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::contacts::footfalls;
    use crate::audit::fixture::{Gait, jump, seat, shift_all, stand, walk};
    use crate::model::Capture;
    use glam::DVec3;

    fn found(capture: &Capture) -> Domain {
        let track = Track::new(capture);
        let feet = footfalls(&track);
        domain(&track, &feet)
    }

    #[test]
    fn walking_and_standing_are_judged_all_through() {
        for capture in [stand(3.0), walk(Gait::default()), walk(Gait { floor: 0.8, ..Gait::default() })] {
            let domain = found(&capture);
            assert_eq!(domain.share(), 1.0, "{:?}", domain.abstained());
            assert!(domain.abstained().is_empty());
        }
    }

    #[test]
    fn a_seat_is_passed_over() {
        let domain = found(&seat(3.0));
        assert_eq!(domain.share(), 0.0);
        assert!(domain.reasons.iter().all(|reason| *reason == Some(Reason::Low)));
        assert!(domain.abstained()[0].why.contains("sits"));
    }

    #[test]
    fn a_walk_in_place_is_passed_over_and_says_what_to_do() {
        let gait = Gait::default();
        let mut capture = walk(gait);
        for frame in 0..capture.frames() {
            shift_all(&mut capture, frame, -DVec3::Z * gait.speed * frame as f64 / gait.fps);
        }
        let domain = found(&capture);
        assert!(domain.reasons.iter().all(|reason| *reason == Some(Reason::InPlace)));
        assert!(domain.abstained()[0].why.contains("root"));
    }

    #[test]
    fn feet_that_are_far_under_what_looks_like_the_floor_show_none_and_a_sunk_span_is_still_judged() {
        for (depth, known) in [(-0.06, true), (-0.4, false)] {
            let mut capture = stand(4.0);
            let frames = capture.frames();
            for frame in frames / 2..frames * 9 / 10 {
                shift_all(&mut capture, frame, DVec3::Y * depth);
            }
            let domain = found(&capture);
            assert_eq!(domain.reasons.iter().all(|reason| *reason == Some(Reason::NoFloor)), !known, "{depth}");
            assert_eq!(domain.stands_in(0, frames - 1), known);
        }
    }

    #[test]
    fn a_clip_of_half_a_second_is_passed_over() {
        let mut capture = walk(Gait::default());
        let joints = capture.body.joints.len();
        let keep = (0.5 * capture.fps) as usize * joints;
        capture.positions.truncate(keep);
        capture.turns.truncate(keep);
        let domain = found(&capture);
        assert!(domain.reasons.iter().all(|reason| *reason == Some(Reason::Short)), "{:?}", domain.abstained());
    }

    #[test]
    fn a_flight_and_the_strides_about_it_are_passed_over_and_the_stand_before_is_not() {
        let domain = found(&jump(0.4, 1.0));
        assert!(domain.walks_in(0, 60));
        assert_eq!(domain.reasons[140], Some(Reason::Flight));
        assert!(!domain.walks_in(0, 140) && domain.stands_in(0, 140));
    }

    #[test]
    fn spans_of_one_reason_are_told_once() {
        let mut domain = found(&stand(2.0));
        domain.begin_after(3);
        domain.add(2, 9, Reason::Thrown);
        domain.add(20, 22, Reason::Thrown);
        let told: Vec<(usize, usize)> = domain.abstained().iter().map(|span| (span.start, span.end)).collect();
        assert_eq!(told, [(0, 2), (3, 9), (20, 22)]);
    }
}
