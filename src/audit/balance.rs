//! The zero-moment point against the feet: where the ground would have to push for that motion, and no foot is.
//!
//! Clip space, m. With the rate of angular momentum, 7 Hz, as in `measure::zmp`. The support is the hull of the soles that bear, those
//! that come down or leave within some hundredths of a second among them: a contact's edge is not known better than that.

use super::contacts::Footfalls;
use super::track::Track;
use super::{Domain, Mark};
use crate::maths::hull::{convex_hull, signed_distance};
use crate::maths::pendulum;
use crate::measure::dynamics::dynamics;
use crate::measure::{GRAVITY, KnownPush, Motion, PushPoint};
use crate::model::findings::Rule;
use crate::model::{BodyPose, Side};
use glam::DVec2;
use std::ops::Range;

/// m at a leg of 0.83 m and s: out of the support by more for so long is told. People who swing their arms are 0.3 m out for a frame
/// or two of 30 Hz, and never 0.12 m for longer.
const OUT: [(f64, f64); 2] = [(0.45, 0.06), (0.17, 0.12)];
/// m and s: ξ out of the support by more for longer asks for a step,
const LOST: (f64, f64) = (0.06, 0.25);
/// s: which comes within that time in people, if it comes.
const ANSWER: f64 = 0.9;
/// Frames of a long clip that are differentiated at once.
const PIECE: usize = 4096;
/// s: of frames before and after.
const MARGIN: f64 = 1.0;
/// m and s at a leg of 0.83 m: farther out for longer, nothing balances.
const THROWN: (f64, f64) = (0.7, 0.16);
/// m: what is out by as much beside such a span belongs to it.
const BESIDE: f64 = 0.08;
/// s: so much at either end of a clip is not judged.
const ENDS: f64 = 0.1;
/// s: spans that are nearer are one.
const JOIN: f64 = 0.35;
/// s: soles that bear within that time carry.
const EDGE: f64 = 0.06;
/// Share of the weight that the ground must carry for a ZMP to be.
const LEAST_LOAD: f64 = 0.4;

/// What a frame's balance is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// m, (x, z).
    pub zmp: DVec2,
    /// m out of the support, negative inside.
    pub out: f64,
}

/// Every frame's; `None` where no foot bears or the body falls.
pub fn balance(track: &Track, feet: &Footfalls) -> Vec<Option<Balance>> {
    let mut balance = Vec::with_capacity(track.len());
    // A long clip goes piece by piece, each with a margin for the filter, so that its poses need not all be there at once.
    let margin = (MARGIN * track.capture.fps).ceil() as usize;
    for from in (0..track.len()).step_by(PIECE) {
        let to = (from + PIECE).min(track.len());
        let with_margin = from.saturating_sub(margin)..(to + margin).min(track.len());
        balance.extend(piece(track, feet, with_margin, from..to));
    }
    balance
}

/// The balance of the frames `told`, by the motion of the frames `seen` around them.
fn piece(track: &Track, feet: &Footfalls, seen: Range<usize>, told: Range<usize>) -> Vec<Option<Balance>> {
    let capture = track.capture;
    let poses: Vec<BodyPose> = seen
        .clone()
        .map(|frame| BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() })
        .collect();
    let motion = Motion { body: &capture.body, hz: capture.fps, per_frame: 1, poses: &poses };
    let Some(measured) = crate::measure::Track::new(motion) else { return vec![None; told.len()] };
    let begins = seen.start as f64 / capture.fps;
    let known: Vec<KnownPush> = capture
        .pushes
        .iter()
        .map(|push| KnownPush {
            start: push.start - begins,
            end: push.end - begins,
            force: push.force,
            at: push.joint.map_or(PushPoint::Centre, PushPoint::Joint),
        })
        .collect();
    let found = dynamics(&measured, &known);
    let edge = (EDGE * capture.fps * track.tempo()).round() as usize;
    let weight = capture.body.mass * GRAVITY;
    told.map(|frame| {
        let needed = found.needed[frame - seen.start];
        if needed.force.y < LEAST_LOAD * weight {
            return None;
        }
        let support = support(track, feet, frame, edge)?;
        let com = found.com[frame - seen.start];
        let height = com.y - feet.floor_at(frame, track.below(frame));
        // Where the ground's force has no tangential moment.
        let zmp = DVec2::new(
            com.x - (height * needed.force.x - needed.moment.z) / needed.force.y,
            com.z - (height * needed.force.z + needed.moment.x) / needed.force.y,
        );
        Some(Balance { zmp, out: signed_distance(&support, zmp) })
    })
    .collect()
}

/// Spans in which the body is moved as no feet could, for longer than any slip of a hand: what is keyed for effect.
pub fn thrown(track: &Track, balance: &[Option<Balance>]) -> Vec<(usize, usize)> {
    let lasts = (THROWN.1 * track.tempo() * track.capture.fps).round() as usize;
    let far = |frame: usize| balance[frame].is_some_and(|found| found.out > THROWN.0 * track.size());
    super::spans(track.len(), far).into_iter().filter(|(start, end)| end - start + 1 >= lasts.max(2)).collect()
}

/// Every mark of the rule.
pub fn marks(track: &Track, balance: &[Option<Balance>], domain: &Domain) -> Vec<Mark> {
    let size = track.size();
    // A filter knows less at the ends of a clip.
    let end = (ENDS * track.capture.fps).round() as usize;
    let inner = end..(track.len().saturating_sub(end));
    let out = |frame: usize| {
        balance[frame].filter(|_| inner.contains(&frame) && domain.walks(frame)).map_or(f64::MIN, |found| found.out)
    };
    let join = (JOIN * track.capture.fps).round() as usize;
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for (start, end) in super::spans(track.len(), |frame| out(frame) > BESIDE * size) {
        let told = OUT.iter().any(|(limit, lasts)| {
            let lasts = (lasts * track.capture.fps).round().max(2.0) as usize;
            let over = |frame: usize| out(frame) > limit * size;
            super::spans(end + 1, |frame| frame >= start && over(frame)).iter().any(|(from, to)| to - from + 1 >= lasts)
        });
        match spans.last_mut() {
            _ if !told => {}
            Some(last) if start - last.1 <= join => last.1 = end,
            _ => spans.push((start, end)),
        }
    }
    spans
        .into_iter()
        .map(|(start, end)| {
            let most = (start..=end).filter_map(|frame| balance[frame]).map(|found| found.out).fold(0.0, f64::max);
            Mark {
                start,
                end,
                rule: Rule::Balance,
                side: None,
                measured: most,
                predicted: 0.0,
                delta: most,
                limit: OUT[1].0 * size,
                why: format!("the ground would have to push {:.0} cm outside of the feet", 100.0 * most),
            }
        })
        .collect()
}

/// Every mark of a stand that is lost: ξ leaves the support for good (the third of the three regions: ankles, hips, step) and no step
/// comes for it.
pub fn unanswered(track: &Track, feet: &Footfalls, domain: &Domain) -> Vec<Mark> {
    let hz = track.capture.fps;
    let size = track.size();
    let ahead = (ANSWER * track.tempo() * hz).round() as usize;
    let lasts = (LOST.1 * track.tempo() * hz).round().max(2.0) as usize;
    let out = |frame: usize| {
        let answered = feet.contacts.iter().any(|contact| (frame + 1..=frame + ahead).contains(&contact.start));
        if frame + ahead >= track.len() || answered || !domain.walks(frame) {
            return f64::MIN;
        }
        let Some(support) = support(track, feet, frame, 0) else { return f64::MIN };
        let velocity = DVec2::new(track.velocity[frame].x, track.velocity[frame].z);
        let omega = track.omega(frame, feet.floor_at(frame, track.below(frame)));
        signed_distance(&support, pendulum::extrapolated(track.below(frame), velocity, omega))
    };
    let lost = super::spans(track.len(), |frame| out(frame) > LOST.0 * size);
    lost.into_iter()
        .filter(|(start, end)| end - start + 1 >= lasts)
        .map(|(start, end)| {
            let most = (start..=end).map(out).fold(0.0, f64::max);
            Mark {
                start,
                end,
                rule: Rule::Balance,
                side: None,
                measured: most,
                predicted: 0.0,
                delta: most,
                limit: LOST.0 * size,
                why: format!("the body is falling {:.0} cm beyond its feet, and no step comes", 100.0 * most),
            }
        })
        .collect()
}

/// m, (x, z): the hull of the soles that bear.
pub fn support(track: &Track, feet: &Footfalls, frame: usize, edge: usize) -> Option<Vec<DVec2>> {
    let mut points: Vec<DVec2> = Vec::new();
    for side in Side::BOTH {
        let of = &feet.of[side as usize];
        let span = frame.saturating_sub(edge)..=(frame + edge).min(track.len() - 1);
        let Some(bears) = span.filter(|at| of[*at].is_some()).min_by_key(|at| at.abs_diff(frame)) else { continue };
        let foot = &track.capture.body.feet[side as usize];
        let [heel, ball, tip] = track.feet[side as usize].points[bears];
        let along = DVec2::new(tip.x - heel.x, tip.z - heel.z).normalize_or_zero();
        let across = DVec2::new(along.y, -along.x) * foot.half_width;
        for point in [heel, ball, tip] {
            let place = DVec2::new(point.x, point.z);
            points.extend([place + across, place - across]);
        }
    }
    (!points.is_empty()).then(|| convex_hull(&points))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::contacts::footfalls;
    use crate::audit::domain::domain;
    use crate::audit::fixture::{Gait, shift_all, shift_foot, stand, walk};
    use crate::model::Capture;
    use glam::DVec3;

    type Found = (Vec<Option<Balance>>, Vec<Mark>, Vec<(usize, usize)>);

    fn found(capture: &Capture) -> Found {
        let track = Track::new(capture);
        let feet = footfalls(&track);
        let balance = balance(&track, &feet);
        let marks = marks(&track, &balance, &domain(&track, &feet));
        let thrown = thrown(&track, &balance);
        (balance, marks, thrown)
    }

    /// The pelvis and all above it aside from `start` to `end`, eased over 0.2 s; the feet stay.
    fn pushed_aside(capture: &Capture, (start, end): (usize, usize), aside: DVec3) -> Capture {
        let mut made = capture.clone();
        let ramp = 0.2 * capture.fps;
        for frame in start..=end {
            let near = (frame - start).min(end - frame) as f64;
            let u = (near / ramp).min(1.0);
            let shift = aside * (u * u * (3.0 - 2.0 * u));
            shift_all(&mut made, frame, shift);
            Side::BOTH.into_iter().for_each(|side| shift_foot(&mut made, frame, side, -shift));
        }
        made
    }

    #[test]
    fn who_stands_or_walks_as_a_pendulum_is_in_balance() {
        for capture in [stand(3.0), walk(Gait::default())] {
            let (balance, marks, thrown) = found(&capture);
            assert!(marks.is_empty() && thrown.is_empty(), "{marks:?}");
            let inner = balance.iter().skip(10).take(capture.frames() - 20).flatten();
            let most = inner.map(|balance| balance.out).fold(f64::MIN, f64::max);
            assert!(most < 0.06, "{most}");
        }
        let still = found(&stand(3.0)).0;
        assert!(still.iter().flatten().all(|balance| balance.out < 0.0));
    }

    #[test]
    fn a_pelvis_aside_is_told_in_its_frames_and_a_little_of_it_is_not() {
        let clean = stand(4.0);
        for (metres, told) in [(0.25, true), (0.02, false)] {
            for aside in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
                let (_, marks, _) = found(&pushed_aside(&clean, (90, 150), aside * metres));
                assert_eq!(!marks.is_empty(), told, "{metres} m along {aside}: {marks:?}");
                for mark in &marks {
                    assert!(mark.start >= 80 && mark.end <= 160, "{mark:?}");
                    assert!(mark.side.is_none() && mark.delta > 0.05, "{mark:?}");
                }
            }
        }
    }

    #[test]
    fn a_window_of_a_clip_has_the_balance_that_the_whole_clip_has() {
        let capture = walk(Gait::default());
        let track = Track::new(&capture);
        let feet = footfalls(&track);
        let whole = balance(&track, &feet);
        let part = piece(&track, &feet, 90..260, 150..200);
        for (one, two) in whole[150..200].iter().zip(&part) {
            let (one, two) = (one.expect("it bears"), two.expect("it bears"));
            assert!(one.zmp.distance(two.zmp) < 1e-6 && (one.out - two.out).abs() < 1e-6, "{one:?} {two:?}");
        }
    }

    #[test]
    fn a_body_that_is_metres_aside_is_thrown() {
        let (_, _, thrown) = found(&pushed_aside(&stand(4.0), (90, 150), DVec3::X * 1.3));
        assert_eq!(thrown.len(), 1, "{thrown:?}");
        assert!(thrown[0].0 >= 85 && thrown[0].1 <= 155, "{thrown:?}");
    }
}
