//! The times that frames begin with: a grid, and the edges of contacts.
//!
//! Seconds, as 32 bits store them.

use super::contacts::FootContact;

/// s: frames never come closer, but for contact edges. Six of the shortest steps between keys, so that a spline's corner can be rounded.
pub(super) const SHORTEST: f64 = 6.0 * NEAREST;
/// s: keys of a channel never come closer: Blender's importer drops what is nearer than 0.01 of its frames, 0.42 ms at 24 a second.
pub(crate) const NEAREST: f64 = 0.6e-3;
/// s: contact edges nearer to each other than this are one. A little more, for what f32 makes of a time of minutes.
pub(super) const SAME_EDGE: f64 = NEAREST + 0.05e-3;

/// Whether a time is in a clip of that duration: the last key's time, as 32 bits store it, may be a hair before what it stands for.
pub(super) fn within(time: f64, duration: f64) -> bool {
    time as f32 <= duration as f32
}

/// The distinct times at which contacts start and end, rising.
pub(super) fn edges(contacts: &[FootContact], duration: f64) -> Vec<f32> {
    let mut edges: Vec<f64> = contacts
        .iter()
        .flat_map(|contact| [contact.start, contact.end])
        .map(|time| time.clamp(0.0, duration))
        .collect();
    edges.retain(|time| time.is_finite());
    edges.sort_by(f64::total_cmp);
    edges.iter_mut().filter(|time| **time < SAME_EDGE).for_each(|time| *time = 0.0);
    edges.dedup_by(|later, earlier| *later - *earlier < SAME_EDGE);
    if let Some(last) = edges.last_mut().filter(|last| duration - **last < SAME_EDGE) {
        *last = duration;
    }
    edges.into_iter().map(|time| time as f32).collect()
}

/// The edge nearest to a time.
pub(super) fn snapped(edges: &[f32], time: f64, duration: f64) -> f32 {
    let time = time.clamp(0.0, duration) as f32;
    edges.iter().copied().min_by(|a, b| (a - time).abs().total_cmp(&(b - time).abs())).unwrap_or(time)
}

/// The frames to begin with: the grid, and the edges instead of grid times that are too near to them.
pub(super) fn grid(fps: f64, duration: f64, edges: &[f32]) -> Vec<f32> {
    let fps = if fps.is_finite() && fps > 0.0 { fps } else { 30.0 };
    let mut times: Vec<f32> = edges.to_vec();
    let far = |time: f64| edges.iter().all(|edge| (f64::from(*edge) - time).abs() > SHORTEST);
    times.extend(
        (1..)
            .map(|index| f64::from(index) / fps)
            .take_while(|time| *time < duration - SHORTEST)
            .filter(|time| far(*time))
            .map(|time| time as f32),
    );
    times.extend([0.0, duration as f32]);
    times.sort_by(f32::total_cmp);
    times.dedup();
    times
}
