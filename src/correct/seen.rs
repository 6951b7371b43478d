//! What the audit sees of a clip, for passes that ask more than its flags tell: its own stages, and where things are in them.
//!
//! Clip space, SI.

use crate::audit::contacts::Contact;
use crate::audit::stages::{Stages, with_stages};
use crate::model::{Capture, Side};
use glam::DVec3;
use std::ops::Deref;

/// One clip's stages.
pub struct Seen<'a>(&'a Stages<'a>);

impl<'a> Deref for Seen<'a> {
    type Target = Stages<'a>;
    fn deref(&self) -> &Stages<'a> {
        self.0
    }
}

/// Looks at a clip; `None` of a clip without frames.
pub fn with_seen<T>(capture: &Capture, floor: Option<f64>, look: impl FnOnce(&Seen) -> T) -> Option<T> {
    with_stages(capture, floor, |stages| look(&Seen(stages)))
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
