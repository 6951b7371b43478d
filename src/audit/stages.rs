//! What the audit sees of a clip before it says anything, stage by stage: for the rules, and for whoever mends what they tell.
//!
//! Clip space, SI. Poses that stand before the motion are held at its first frame; frames count as in the clip.

use super::balance::{self, Balance};
use super::contacts::{Footfalls, footfalls_on};
use super::domain::{self, Domain, Reason};
use super::keyed::{self, Keyed};
use super::placement::{self, Judged};
use super::track::{self, Track};
use crate::model::Capture;

/// s: around what is thrown, so much is not judged either.
const AROUND: f64 = 0.3;

/// One clip's stages.
pub struct Stages<'a> {
    /// Centre of mass and feet.
    pub track: Track<'a>,
    /// Contacts and steps.
    pub feet: Footfalls,
    /// Where the pendulum applies.
    pub domain: Domain,
    /// (frames) the ZMP.
    pub balance: Vec<Option<Balance>>,
    /// The steps that the clip shows whole where the pendulum applies.
    pub judged: Vec<Judged>,
    /// Whether the clip is keyed for effect all through: then nothing in it is judged by itself.
    pub keyed: Option<Keyed>,
}

/// Looks at a clip, on the floor that the feet show or on one that is told (m); `None` of a clip without frames.
pub fn with_stages<T>(capture: &Capture, floor: Option<f64>, look: impl FnOnce(&Stages) -> T) -> Option<T> {
    if capture.frames() == 0 {
        return None;
    }
    let (held, posed) = track::without_pose(capture);
    let track = Track::new(held.as_ref().unwrap_or(capture));
    let feet = footfalls_on(&track, floor);
    let mut domain = domain::domain(&track, &feet);
    domain.begin_after(posed);
    let balance = balance::balance(&track, &feet);
    let around = (AROUND * capture.fps) as usize;
    for (start, end) in balance::thrown(&track, &balance) {
        domain.add(start.saturating_sub(around), (end + around).min(track.len() - 1), Reason::Thrown);
    }
    let mut steps = judged(&track, &feet, &domain);
    let keyed = keyed::keyed(&track, &domain, &balance, steps.len());
    if let Some(keyed) = keyed {
        keyed.silence(&mut domain);
        steps = judged(&track, &feet, &domain);
    }
    Some(look(&Stages { track, feet, domain, balance, judged: steps, keyed }))
}

/// The steps that are judged.
pub fn judged(track: &Track, feet: &Footfalls, domain: &Domain) -> Vec<Judged> {
    let whole = |taken: &placement::Taken| {
        domain.walks_in(feet.contacts[taken.step.from].end, feet.contacts[taken.step.to].start)
    };
    let taken: Vec<_> = placement::taken(track, feet).into_iter().filter(whole).collect();
    placement::judge(track, &taken)
}
