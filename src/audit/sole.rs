//! What a foot may not do while it bears: slide over the ground, sink into it, hover over it; and a root that wanders under both.
//!
//! Clip space, m. A foot that rolls has a point that stays: the path of the stillest point is what it slides. Floors are those that the
//! feet themselves show ([`super::contacts`]); on uneven ground each contact is its own floor, so nothing sinks or hovers there.

use super::Mark;
use super::contacts::{Contact, Footfalls};
use super::track::Track;
use crate::model::Side;
use crate::model::findings::Rule;
use glam::DVec2;

/// m at a leg of 0.83 m: a slide that is told.
const SLIDE: f64 = 0.08;
/// s: within that time. A foot that stands for long shifts and turns now and then.
const WITHIN: f64 = 0.7;
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
    if !feet.ground.uneven {
        marks.extend(heights(track, feet));
    }
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
        let limit = SLIDE * track.size().max(0.75);
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
            let [heel, _, tip] = foot.points[frame];
            // The point of a steep foot is where its bones are thought to end.
            let guess = STEEP * ((tip.y - heel.y).abs() - LEVEL * track.size()).max(0.0);
            if bears || rule == Rule::Penetration { sign * height - guess } else { f64::MIN }
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
