//! What the audit sees of a clip, for passes that ask more than its flags tell.
//!
//! The same stages as `audit::audit`; clip space, SI.

use crate::audit::balance::{Balance, balance, thrown};
use crate::audit::contacts::{Contact, Footfalls, footfalls_on};
use crate::audit::domain::{Domain, Reason, domain};
use crate::audit::placement::{self, Judged};
use crate::audit::track::{Track, without_pose};
use crate::model::{Capture, Side};
use glam::DVec3;

/// One clip's stages.
pub struct Seen<'a> {
    /// Centre of mass and feet.
    pub track: Track<'a>,
    /// Contacts and steps.
    pub feet: Footfalls,
    /// Where the pendulum applies.
    pub domain: Domain,
    /// Steps that were judged.
    pub judged: Vec<Judged>,
    /// (frames) the ZMP.
    pub balance: Vec<Option<Balance>>,
    /// Steps that the clip shows whole where the pendulum applies.
    pub steps: usize,
}

/// Looks at a clip of one frame at least.
pub fn with_seen<T>(capture: &Capture, floor: Option<f64>, look: impl FnOnce(&Seen) -> T) -> T {
    let (held, posed) = without_pose(capture);
    let track = Track::new(held.as_ref().unwrap_or(capture));
    let feet = footfalls_on(&track, floor);
    let mut domain = domain(&track, &feet);
    domain.begin_after(posed);
    let balance = balance(&track, &feet);
    for (start, end) in thrown(&track, &balance) {
        let around = (0.3 * capture.fps) as usize;
        domain.add(start.saturating_sub(around), (end + around).min(track.len() - 1), Reason::Thrown);
    }
    let judged = judged(&track, &feet, &domain);
    let steps = judged.len();
    look(&Seen { track, feet, domain, judged, balance, steps })
}

/// The steps that the audit judges.
pub fn judged(track: &Track, feet: &Footfalls, domain: &Domain) -> Vec<Judged> {
    let taken: Vec<_> = placement::taken(track, feet)
        .into_iter()
        .filter(|taken| domain.walks_in(feet.contacts[taken.step.from].end, feet.contacts[taken.step.to].start))
        .collect();
    placement::judge(track, &taken)
}

impl Seen<'_> {
    /// The motion.
    pub fn capture(&self) -> &Capture {
        self.track.capture
    }

    /// Frames of so many seconds, one at least.
    pub fn frames_in(&self, seconds: f64) -> usize {
        (seconds * self.track.capture.fps * self.track.tempo()).round().max(1.0) as usize
    }

    /// The contact of a foot that a flag's span names: the one that shares most frames with it.
    pub fn contact(&self, side: Side, start: usize, end: usize) -> Option<usize> {
        let shared = |contact: &Contact| (contact.end.min(end) + 1).saturating_sub(contact.start.max(start));
        (0..self.feet.contacts.len())
            .filter(|index| self.feet.contacts[*index].side == side && shared(&self.feet.contacts[*index]) > 0)
            .max_by_key(|index| (shared(&self.feet.contacts[*index]), usize::MAX - index))
    }

    /// Frames from the end of the foot's contact before to the start of the one after: within them its swings lie. Where there is none,
    /// the clip's ends.
    pub fn swings(&self, index: usize) -> (usize, usize) {
        let contact = &self.feet.contacts[index];
        let own = || self.feet.contacts.iter().filter(|other| other.side == contact.side);
        let before = own().filter(|other| other.end < contact.start).map(|other| other.end).max();
        let after = own().filter(|other| other.start > contact.end).map(|other| other.start).min();
        (before.unwrap_or(0), after.unwrap_or(self.track.len() - 1))
    }

    /// m: that joint in a frame.
    pub fn at(&self, frame: usize, joint: usize) -> DVec3 {
        self.track.capture.at(frame)[joint]
    }
}

/// The side of a flag.
pub fn side_of(foot: Option<&str>) -> Option<Side> {
    match foot {
        Some("left") => Some(Side::Left),
        Some("right") => Some(Side::Right),
        _ => None,
    }
}

/// 0 at `from`, 1 at `to`, at rest at both.
pub fn eased(frame: usize, from: usize, to: usize) -> f64 {
    let u = ((frame as f64 - from as f64) / (to as f64 - from as f64).max(1.0)).clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}
