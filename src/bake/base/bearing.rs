//! Which feet of a walking clip bear when: as the audit sees it, or by their height where a keyed clip's feet slide. Frames of the clip.

use super::{Base, BaseFrame};
use crate::audit::contacts::footfalls;
use crate::audit::track::Track;
use crate::model::{Body, Capture, Side};

/// m: soles lower than this over the lowest bear, of a walk in place.
pub(super) const LOW: f64 = 0.03;

/// A foot that bears: first and last frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bears {
    pub(super) side: Side,
    pub(super) start: usize,
    pub(super) end: usize,
}

/// Whether any foot does in a frame.
pub(super) fn bears(contacts: &[Bears], frame: usize) -> bool {
    contacts.iter().any(|contact| (contact.start..=contact.end).contains(&frame))
}

/// The feet that bear as the audit sees them: they hardly move.
pub(super) fn seen(base: &Base, body: &Body, frames: &[BaseFrame]) -> Vec<Bears> {
    let capture = as_capture(base, body, frames);
    let found = footfalls(&Track::new(&capture)).contacts;
    found.iter().map(|contact| Bears { side: contact.side, start: contact.start, end: contact.end }).collect()
}

/// The feet that are low, however fast they slide.
pub(super) fn low(body: &Body, frames: &[BaseFrame], size: f64) -> Vec<Bears> {
    let heights: Vec<[f64; 2]> = frames.iter().map(|frame| lowest(body, frame)).collect();
    let floor = heights.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let mut list = Vec::new();
    for side in Side::BOTH {
        let is_low = |frame: usize| heights[frame][side as usize] - floor < 0.8 * LOW * size.max(0.8);
        let mut frame = 0;
        while frame < frames.len() {
            if !is_low(frame) {
                frame += 1;
                continue;
            }
            let start = frame;
            while frame < frames.len() && is_low(frame) {
                frame += 1;
            }
            if frame - start > 2 {
                list.push(Bears { side, start, end: frame - 1 });
            }
        }
    }
    list.sort_by_key(|contact| (contact.start, contact.side));
    list
}

/// m, the lowest point of each sole.
pub(super) fn lowest(body: &Body, frame: &BaseFrame) -> [f64; 2] {
    let positions = frame.pose.positions(body);
    Side::BOTH.map(|side| {
        let (rear, front) = frame.pose.sole(body, &positions, side);
        rear.iter().chain(&front).map(|point| point.y).fold(f64::INFINITY, f64::min)
    })
}

/// Closes what few frames no foot is seen to bear in, half by the foot that leaves and half by the one that comes.
pub(super) fn bridge(contacts: &mut [Bears], frames: usize) {
    let mut frame = 0;
    while frame < frames {
        if bears(contacts, frame) {
            frame += 1;
            continue;
        }
        let from = frame;
        while frame < frames && !bears(contacts, frame) {
            frame += 1;
        }
        let middle = (from + frame) / 2;
        let leaves = contacts.iter().position(|contact| contact.end + 1 == from);
        let comes = contacts.iter().position(|contact| contact.start == frame);
        if let Some(leaves) = leaves {
            contacts[leaves].end = if comes.is_some() { middle } else { frame - 1 };
        }
        if let Some(comes) = comes {
            contacts[comes].start = if leaves.is_some() { middle } else { from };
        }
    }
    // A foot stays until the other one is there: between two frames too.
    for index in 0..contacts.len() {
        let Bears { side, end, .. } = contacts[index];
        let other = |contact: &Bears| contact.side != side && contact.start <= end && end < contact.end;
        if end + 1 < frames && !contacts.iter().any(other) {
            contacts[index].end += 1;
        }
    }
}

/// Frames as a capture.
pub(super) fn as_capture(base: &Base, body: &Body, frames: &[BaseFrame]) -> Capture {
    Capture {
        name: base.name.clone(),
        fps: base.fps,
        body: body.clone(),
        positions: frames.iter().flat_map(|frame| frame.pose.positions(body)).collect(),
        turns: frames.iter().flat_map(|frame| frame.pose.turns.clone()).collect(),
        units_to_metres: 1.0,
        up: "+Y".into(),
        confidence: 1.0,
        method: String::new(),
        notes: Vec::new(),
        pushes: Vec::new(),
    }
}
