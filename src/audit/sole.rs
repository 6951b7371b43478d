//! What a foot may not do while it bears: slide over the ground, sink into it, hover over it; and a root that wanders under both.
//!
//! Clip space, m. A foot that rolls has a point that stays: the path of the stillest point is what it slides. Floors are those that the
//! feet themselves show ([`super::contacts`]); on uneven ground each contact is its own floor, and what is told is that it rises or sinks.

use super::Mark;
use super::contacts::{Contact, Footfalls};
use super::track::Track;
use crate::model::Side;
use crate::model::findings::Rule;
use glam::DVec2;

/// m at a leg of 0.83 m: a slide that is told.
const SLIDE: f64 = 0.08;
/// s: within that time.
const WITHIN: f64 = 0.7;
/// s at a leg of 0.83 m: a foot that bears longer stands, and who stands shifts and turns his feet now and then: that many times as far.
const STANDS: f64 = 1.2;
/// See [`STANDS`].
const SHIFTED: f64 = 1.6;
/// m: a sole that far under or over its floor is told.
const DEPTH: f64 = 0.035;
/// m a m by which heel and tip differ in height, beyond what a level foot's do: how uncertain a sole's lowest point is.
const STEEP: f64 = 0.3;
/// m.
const LEVEL: f64 = 0.05;
/// m: over its floor by more, a foot stands on something.
const HOVER: f64 = 0.16;
/// s: no shorter.
const BRIEF: f64 = 0.1;

/// Every mark of these rules.
pub fn marks(track: &Track, feet: &Footfalls) -> Vec<Mark> {
    let mut marks = slides(track, feet);
    marks.dedup_by(|later, first| later.rule == Rule::Drift && first.rule == Rule::Drift && later.start <= first.end);
    marks.extend(heights(track, feet));
    marks
}

/// m, (x, z): the way that a contact's stillest point has gone up to each of its frames.
pub fn slid(track: &Track, contact: &Contact) -> Vec<DVec2> {
    let foot = &track.feet[contact.side as usize];
    let mut way = DVec2::ZERO;
    (contact.start..=contact.end)
        .map(|frame| {
            let slowest = foot.speeds[frame].iter().copied().min_by(|a, b| a.length().total_cmp(&b.length()));
            if let Some(speed) = slowest.filter(|_| frame > contact.start && frame < contact.end) {
                way += DVec2::new(speed.x, speed.z) / track.capture.fps;
            }
            way
        })
        .collect()
}

fn slides(track: &Track, feet: &Footfalls) -> Vec<Mark> {
    let mut marks = Vec::new();
    for contact in &feet.contacts {
        let way = slid(track, contact);
        let far = farthest(&way, (WITHIN * track.capture.fps).round() as usize);
        let seconds = (contact.end - contact.start) as f64 / track.capture.fps / track.tempo();
        let limit = SLIDE * track.size().max(0.75) * if seconds > STANDS { SHIFTED } else { 1.0 };
        if far > limit {
            let other = other_slides(track, feet, contact, &way);
            let rule = if other { Rule::Drift } else { Rule::FootSlide };
            let name = super::foot_name(contact.side);
            let why = if other {
                format!(
                    "the {name} foot and the other one go {:.0} cm over the ground together: the root wanders",
                    100.0 * far
                )
            } else {
                format!("the {name} foot bears and slides {:.0} cm", 100.0 * far)
            };
            let (start, end) = where_it_slides(&way);
            marks.push(Mark {
                start: contact.start + start,
                end: contact.start + end,
                rule,
                side: Some(contact.side).filter(|_| !other),
                measured: far,
                predicted: 0.0,
                delta: far,
                limit,
                why,
            });
        }
    }
    marks
}

/// m: the farthest that a way leads within so many frames.
fn farthest(way: &[DVec2], frames: usize) -> f64 {
    let from = |at: usize| &way[at.saturating_sub(frames)..at];
    (0..way.len()).flat_map(|at| from(at).iter().map(move |before| way[at].distance(*before))).fold(0.0, f64::max)
}

/// The part of a way, first and last frame, in which all but a tenth of it is gone at either end.
fn where_it_slides(way: &[DVec2]) -> (usize, usize) {
    let gone: Vec<f64> = way
        .windows(2)
        .scan(0.0, |sum, pair| {
            *sum += pair[0].distance(pair[1]);
            Some(*sum)
        })
        .collect();
    let whole = gone.last().copied().unwrap_or(0.0);
    let start = gone.iter().position(|gone| *gone > 0.05 * whole).unwrap_or(0);
    let end = gone.iter().position(|gone| *gone > 0.95 * whole).map_or(way.len() - 1, |at| at + 1);
    (start, end)
}

/// Whether the other foot bears in half of that contact and goes the same way.
fn other_slides(track: &Track, feet: &Footfalls, contact: &Contact, way: &[DVec2]) -> bool {
    let others = feet.contacts.iter().filter(|other| other.side != contact.side);
    others.into_iter().any(|other| {
        let (from, to) = (other.start.max(contact.start), other.end.min(contact.end));
        if from >= to || 2 * (to - from) < contact.end - contact.start {
            return false;
        }
        let theirs = slid(track, other);
        let mine = way[to - contact.start] - way[from - contact.start];
        let its = theirs[to - other.start] - theirs[from - other.start];
        mine.length() > 0.5 * SLIDE && mine.distance(its) < 0.5 * mine.length()
    })
}

fn heights(track: &Track, feet: &Footfalls) -> Vec<Mark> {
    let depth = DEPTH * track.size();
    let brief = (BRIEF * track.capture.fps).round().max(1.0) as usize;
    let mut marks = Vec::new();
    for (rule, sign) in [(Rule::Penetration, -1.0), (Rule::Float, 1.0)] {
        let off = |side: Side, frame: usize| {
            let bears = feet.of[side as usize][frame].is_some();
            let foot = &track.feet[side as usize];
            let height = foot.low[frame] - feet.under(side, frame, foot.place(frame));
            let [heel, ball, tip] = foot.points[frame];
            // The point of a steep foot is where its bones are thought to end.
            let guess = STEEP * ((tip.y - heel.y).abs() - LEVEL * track.size()).max(0.0);
            // On a foot that tips forward the toes bend: it is no deeper than its ball.
            let tips = rule == Rule::Penetration && heel.y - tip.y > LEVEL * track.size();
            let ball = feet.under(side, frame, foot.place(frame)) - ball.y;
            let off = if tips { (-height - guess).min(ball) } else { sign * height - guess };
            // Uneven ground is known where a foot stands on it.
            if bears || (rule == Rule::Penetration && !feet.ground.uneven) { off } else { f64::MIN }
        };
        // Only what bears can hover, and only if nothing holds the body up meanwhile.
        let worst = |frame: usize| match rule {
            Rule::Penetration => off(Side::Left, frame).max(off(Side::Right, frame)),
            _ => {
                let held = Side::BOTH.map(|side| off(side, frame)).into_iter().filter(|off| *off > f64::MIN);
                held.fold(f64::MAX, f64::min)
            }
        };
        // What hovers higher than a step stands on something.
        let most = if rule == Rule::Float { HOVER * track.size() } else { f64::MAX };
        for (start, end) in super::spans(track.len(), |frame| (depth..most).contains(&worst(frame))) {
            if end - start + 1 < brief {
                continue;
            }
            let most = (start..=end).map(worst).fold(0.0, f64::max);
            let feet_in = Side::BOTH.map(|side| (start..=end).any(|frame| off(side, frame) > depth));
            let side = match feet_in {
                [true, false] => Some(Side::Left),
                [false, true] => Some(Side::Right),
                _ => None,
            };
            let who = side.map_or("what bears".to_owned(), |side| format!("the {} foot", super::foot_name(side)));
            let what = if rule == Rule::Float { "over" } else { "under" };
            marks.push(Mark {
                start,
                end,
                rule,
                side,
                measured: sign * most,
                predicted: 0.0,
                delta: most,
                limit: depth,
                why: format!("{who} is {:.1} cm {what} the floor", 100.0 * most),
            });
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::contacts::footfalls;
    use crate::audit::fixture::{Gait, shift_all, shift_foot, stand, walk};
    use crate::model::Capture;
    use glam::DVec3;

    fn found(capture: &Capture) -> Vec<Mark> {
        let track = Track::new(capture);
        marks(&track, &footfalls(&track))
    }

    fn of(marks: &[Mark], rule: Rule) -> Vec<&Mark> {
        marks.iter().filter(|mark| mark.rule == rule).collect()
    }

    #[test]
    fn feet_that_do_as_feet_do_are_not_told() {
        for capture in [
            stand(3.0),
            walk(Gait::default()),
            walk(Gait { floor: -1.2, slope: DVec2::new(0.0, 0.015), ..Gait::default() }),
            walk(Gait { rise: 0.15, ..Gait::default() }),
        ] {
            let marks = found(&capture);
            assert!(marks.is_empty(), "{marks:?}");
        }
    }

    #[test]
    fn a_foot_that_slides_while_it_bears_is_told_and_only_that_foot() {
        for side in Side::BOTH {
            let mut capture = stand(3.0);
            for frame in 60..capture.frames() {
                let way = ((frame - 60) as f64 / 30.0).min(1.0) * 0.15;
                shift_foot(&mut capture, frame, side, DVec3::Z * way);
            }
            let marks = found(&capture);
            let slides = of(&marks, Rule::FootSlide);
            assert_eq!((slides.len(), marks.len()), (1, 1), "{marks:?}");
            assert_eq!(slides[0].side, Some(side));
            assert!((slides[0].delta - 0.15).abs() < 0.03, "{slides:?}");
        }
    }

    #[test]
    fn feet_that_wander_together_are_the_roots_drift() {
        let mut capture = stand(3.0);
        for frame in 0..capture.frames() {
            shift_all(&mut capture, frame, DVec3::X * 0.2 * frame as f64 / 60.0);
        }
        let marks = found(&capture);
        assert!(!marks.is_empty() && marks.iter().all(|mark| mark.rule == Rule::Drift && mark.side.is_none()));
    }

    #[test]
    fn six_centimetres_over_and_under_the_floor_are_told_in_their_frames() {
        for (lift, rule) in [(0.06, Rule::Float), (-0.06, Rule::Penetration)] {
            let mut capture = walk(Gait::default());
            for frame in 120..=180 {
                let near = (frame - 120).min(180 - frame) as f64 / 6.0;
                shift_all(&mut capture, frame, DVec3::Y * lift * near.min(1.0));
            }
            let marks = found(&capture);
            let told = of(&marks, rule);
            assert!(!told.is_empty() && told.len() == marks.len(), "{marks:?}");
            let frames: usize = told.iter().map(|mark| mark.end - mark.start + 1).sum();
            assert!((35..=61).contains(&frames), "{told:?}");
            assert!(told.iter().all(|mark| mark.start >= 118 && mark.end <= 182), "{told:?}");
            assert!(told.iter().all(|mark| mark.measured.signum() == lift.signum()), "{told:?}");
        }
    }

    #[test]
    fn the_farthest_way_is_looked_for_within_the_frames() {
        let way: Vec<DVec2> = (0..10).map(|frame| DVec2::X * f64::from(frame)).collect();
        assert_eq!(farthest(&way, 3), 3.0);
        assert_eq!(farthest(&way, 30), 9.0);
    }
}
