//! A clip's motion to findings: which frames no balanced person could have produced.
//!
//! The way of a clip: capture -> [`track`] (centre of mass, feet) -> [`contacts`] (floor, contacts, steps) -> [`domain`] (where the
//! pendulum applies) -> the rules, each a file of its own, that leave marks -> [`Findings`]. Clip space, SI; limits are for a leg of 0.83 m
//! and scale with the body.

pub mod balance;
pub mod contacts;
pub mod domain;
pub mod flight;
pub mod placement;
pub mod sole;
pub mod timing;
pub mod track;
mod verdict;

pub use domain::Domain;
pub use verdict::{foot_name, part};

use crate::model::findings::{Findings, Flag, Rule};
use crate::model::{Capture, Side};
use contacts::footfalls_on;
use track::Track;

/// What a person may set.
#[derive(Clone, Debug, Default)]
pub struct AuditOptions {
    /// m over the file's zero: where the floor is, if the feet shall not tell.
    pub floor: Option<f64>,
    /// Rules that are not asked.
    pub without: Vec<Rule>,
}

/// Judges a clip.
pub fn audit(capture: &Capture, options: &AuditOptions) -> Findings {
    let mut findings = verdict::empty(capture);
    if capture.frames() == 0 {
        return findings;
    }
    let (held, posed) = track::without_pose(capture);
    let track = Track::new(held.as_ref().unwrap_or(capture));
    let feet = footfalls_on(&track, options.floor);
    let mut domain = domain::domain(&track, &feet);
    domain.begin_after(posed);
    let balance = balance::balance(&track, &feet);
    for (start, end) in balance::thrown(&track, &balance) {
        let around = (0.3 * capture.fps) as usize;
        domain.add(start.saturating_sub(around), (end + around).min(track.len() - 1), domain::Reason::Thrown);
    }
    let taken: Vec<_> = placement::taken(&track, &feet)
        .into_iter()
        .filter(|taken| domain.walks_in(feet.contacts[taken.step.from].end, feet.contacts[taken.step.to].start))
        .collect();
    let judged = placement::judge(&track, &taken);
    let mut marks = placement::marks(&feet, &judged);
    marks.extend(sole::marks(&track, &feet).into_iter().filter(|mark| match mark.rule {
        Rule::Float => domain.walks_in(mark.start, mark.end),
        _ => domain.stands_in(mark.start, mark.end),
    }));
    marks.extend(balance::marks(&track, &balance, &domain));
    marks.extend(flight::marks(&track, &feet).into_iter().filter(|mark| domain.stands_in(mark.start, mark.end)));
    marks.retain(|mark| !options.without.contains(&mark.rule));
    marks.sort_by_key(|mark| (mark.start, mark.end, mark.rule));
    findings.flags = marks.iter().map(Mark::flag).collect();
    let clock = timing::clock(&track, &feet, &domain, taken.len());
    findings.clip_flags.extend(clock.and_then(timing::mark).filter(|_| !options.without.contains(&Rule::Timing)));
    findings.steps = judged.iter().map(|judged| verdict::step(&feet, judged)).collect();
    findings.contacts = verdict::contacts(&track, &feet);
    findings.abstained = domain.abstained();
    findings.confidence *= verdict::trust(&feet, &domain);
    findings
}

/// A flag in the making.
#[derive(Clone, Debug)]
pub struct Mark {
    /// First frame.
    pub start: usize,
    /// Last frame.
    pub end: usize,
    /// Which rule.
    pub rule: Rule,
    /// Of one foot.
    pub side: Option<Side>,
    /// As in [`Flag`].
    pub measured: f64,
    /// As in [`Flag`].
    pub predicted: f64,
    /// m, by how much.
    pub delta: f64,
    /// m, from where on it is told.
    pub limit: f64,
    /// A sentence.
    pub why: String,
}

impl Mark {
    fn flag(&self) -> Flag {
        Flag {
            start: self.start,
            end: self.end,
            rule: self.rule,
            foot: self.side.map(foot_name),
            // Half at the limit, nearing 1 the farther it is.
            severity: (1.0 - 0.5 * self.limit / self.delta.max(self.limit)).clamp(0.0, 1.0),
            measured: self.measured,
            predicted: self.predicted,
            delta_m: self.delta,
            why: self.why.clone(),
        }
    }
}

/// Spans of frames, first and last, in which something holds.
pub fn spans(frames: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for frame in (0..frames).filter(|frame| holds(*frame)) {
        match spans.last_mut() {
            Some(last) if last.1 + 1 == frame => last.1 = frame,
            _ => spans.push((frame, frame)),
        }
    }
    spans
}
