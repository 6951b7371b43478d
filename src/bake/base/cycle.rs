//! Where a walking clip goes, and the cycle of it that is begun again for as long as is needed. Scenario space, metres, seconds.
//!
//! A clip that walks in place travels by what the feet that bear go back by, evened over a moment: those that somebody names, else the
//! low ones. One that is no loop is cut from a
//! touchdown to the like one a stride later, and what the two differ by is let go over the cycle.

use super::bearing::{Bears, LOW, as_capture, lowest};
use super::gait::SLOWEST;
use super::{Base, BaseFrame};
use crate::audit::contacts::footfalls;
use crate::audit::track::Track;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::model::{Body, BodyPose, Side};
use crate::whole_body::Anatomy;
use glam::{DQuat, DVec2, DVec3};

/// Part of the feet's speed under a body by which a body that walks in place moves at most.
const IN_PLACE: f64 = 0.3;
/// s at a leg of 0.83 m: no cycle of two steps is shorter.
const SHORTEST: f64 = 0.7;

/// m, where the clip's body is by each frame that walks in place: what the feet that bear go back by, evened. Zero where it travels by
/// itself; `None` where no foot ever bears. `contacts`: which feet do, else those that are low.
pub(super) fn travelled(base: &Base, body: &Body, evened: f64, contacts: Option<&[Bears]>) -> Option<Vec<DVec3>> {
    let frames = base.frames();
    let count = frames.len();
    let point = |frame: &BaseFrame, side: Side, which: usize| {
        let (rear, front) = frame.pose.sole(body, &frame.pose.positions(body), side);
        rear.iter().chain(&front).nth(which).copied().unwrap_or(DVec3::ZERO)
    };
    let lows: Vec<[f64; 2]> = frames.iter().map(|frame| lowest(body, frame)).collect();
    let floor = lows.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let mut steps: Vec<Option<DVec3>> = Vec::with_capacity(count);
    for frame in 1..count {
        let (mut way, mut weight) = (DVec3::ZERO, 0.0);
        for side in Side::BOTH {
            let height = 0.5 * (lows[frame][side as usize] + lows[frame - 1][side as usize]) - floor;
            let bears = match contacts {
                Some(contacts) => loaded(contacts, side, frame),
                None => (1.0 - height / LOW).max(0.0).powi(2),
            };
            if bears > 0.0 {
                let positions = frames[frame].pose.positions(body);
                let (rear, front) = frames[frame].pose.sole(body, &positions, side);
                let lowest = rear.iter().chain(&front).enumerate().min_by(|a, b| a.1.y.total_cmp(&b.1.y));
                let Some((which, at)) = lowest else { continue };
                way += (*at - point(&frames[frame - 1], side, which)) * bears;
                weight += bears;
            }
        }
        steps.push((weight > 1e-6).then(|| way / weight * DVec3::new(1.0, 0.0, 1.0)));
    }
    let known: Vec<DVec3> = steps.iter().flatten().copied().collect();
    if known.is_empty() {
        return None;
    }
    let mean = known.iter().sum::<DVec3>() / known.len() as f64;
    let seconds = (count - 1).max(1) as f64 / base.fps;
    let way = frames[count - 1].com - frames[0].com;
    let goes = DVec2::new(way.x, way.z).length() / seconds;
    let under = mean.length() * base.fps;
    if under < SLOWEST || goes > IN_PLACE * under {
        return Some(vec![DVec3::ZERO; count]);
    }
    let steps: Vec<DVec3> = steps.into_iter().map(|step| step.unwrap_or(mean)).collect();
    // Evened over a moment: a body has no jolts.
    let sigma = (evened * base.fps).max(1e-3);
    let reach = (3.0 * sigma).ceil() as isize;
    let evened = |at: usize| {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for off in -reach..=reach {
            let weight = real::exp(-0.5 * (off as f64 / sigma).powi(2));
            let index = at as isize + off;
            let last = steps.len() as isize;
            let index = if base.loops { index.rem_euclid(last) } else { index.clamp(0, last - 1) };
            sum += steps[index as usize] * weight;
            total += weight;
        }
        sum / total
    };
    let mut list = vec![DVec3::ZERO; count];
    for frame in 1..count {
        list[frame] = list[frame - 1] - evened(frame - 1);
    }
    Some(list)
}

/// How much a foot bears from the frame before to a frame: less where it comes and goes.
fn loaded(contacts: &[Bears], side: Side, frame: usize) -> f64 {
    const COMES: f64 = 3.0;
    let own = contacts.iter().find(|contact| contact.side == side && contact.start < frame && frame <= contact.end);
    own.map_or(0.0, |own| ((frame - own.start).min(own.end + 1 - frame) as f64 / COMES).min(1.0))
}

/// The clip with its travel, begun again as often as is needed: frames, and s of a cycle.
pub(super) fn unrolled(
    base: &Base,
    travelled: &[DVec3],
    (body, anatomy): (&Body, &Anatomy),
    seconds: f64,
) -> (Vec<BaseFrame>, f64) {
    let mut frames: Vec<BaseFrame> =
        base.frames().iter().zip(travelled).map(|(frame, way)| frame.moved(*way)).collect();
    let (from, to) = if base.loops { (0, frames.len() - 1) } else { cycle(base, &frames, body) };
    let whole = to - from;
    let period = whole as f64 / base.fps;
    let needed = (seconds * base.fps).ceil() as usize + 2;
    if frames.len() >= needed || whole < 3 {
        return (frames, period);
    }
    if !base.loops {
        // What the cycle's end differs by from its start is let go over the cycle, so that it can begin again.
        let (start, end) = (frames[from].pose.clone(), frames[to].pose.clone());
        let off: Vec<DQuat> = end.turns.iter().zip(&start.turns).map(|(end, start)| end.inverse() * *start).collect();
        let rise = start.hips.y - end.hips.y;
        for (index, frame) in frames.iter_mut().enumerate().take(to + 1).skip(from) {
            let share = smooth3((index - from) as f64 / whole as f64);
            let mut pose = frame.pose.clone();
            for (turn, off) in pose.turns.iter_mut().zip(&off) {
                *turn = (*turn * DQuat::IDENTITY.slerp(*off, share)).normalize();
            }
            pose.hips.y += rise * share;
            *frame = BaseFrame::of(body, anatomy, pose, 0.0);
        }
    }
    let way = frames[to].pose.hips - frames[from].pose.hips;
    let level = DVec3::new(way.x, 0.0, way.z);
    let mut list: Vec<BaseFrame> = frames[..to].to_vec();
    let mut rounds = 1.0;
    while list.len() < needed {
        list.extend((from..to).map(|frame| frames[frame].moved(level * rounds)));
        rounds += 1.0;
    }
    (list, period)
}

/// The two frames a cycle apart that are most alike, of a clip that is no loop: two touchdowns, or any two where it is too short for those.
fn cycle(base: &Base, frames: &[BaseFrame], body: &Body) -> (usize, usize) {
    let capture = as_capture(base, body, frames);
    let track = Track::new(&capture);
    let found = footfalls(&track);
    let mut best = (f64::INFINITY, 0, frames.len() - 1);
    for side in Side::BOTH {
        let downs: Vec<usize> = found
            .contacts
            .iter()
            .filter(|contact| contact.side == side && !contact.cut.0)
            .map(|contact| contact.start)
            .collect();
        for (at, from) in downs.iter().enumerate() {
            for to in &downs[at + 1..] {
                let (one, other) = (&frames[*from].pose, &frames[*to].pose);
                let off: f64 = one.turns.iter().zip(&other.turns).map(|(a, b)| a.angle_between(*b)).sum();
                if off < best.0 {
                    best = (off, *from, *to);
                }
            }
        }
    }
    if best.0.is_finite() {
        return (best.1, best.2);
    }
    let least = (SHORTEST * base.fps * (body.leg_length / 0.83).max(0.01).sqrt()).ceil() as usize;
    let stride = frames.len().div_ceil(120).max(1);
    for from in (0..frames.len()).step_by(stride) {
        for to in (from + least..frames.len()).step_by(stride) {
            let (one, other) = (&frames[from].pose, &frames[to].pose);
            let off: f64 = one.turns.iter().zip(&other.turns).map(|(a, b)| a.angle_between(*b)).sum();
            if off < best.0 {
                best = (off, from, to);
            }
        }
    }
    (best.1, best.2)
}

/// Frames at another rate.
pub(super) fn resampled(frames: &[BaseFrame], from: f64, to: f64) -> Vec<BaseFrame> {
    let last = frames.len() - 1;
    let count = (last as f64 * to / from).floor() as usize;
    let one = |frame: usize| {
        let place = frame as f64 * from / to;
        let first = (place.floor() as usize).min(last);
        frames[first].between(&frames[(first + 1).min(last)], place - first as f64)
    };
    (0..=count).map(one).collect()
}

impl BaseFrame {
    /// The same elsewhere.
    fn moved(&self, way: DVec3) -> BaseFrame {
        BaseFrame {
            pose: BodyPose { hips: self.pose.hips + way, turns: self.pose.turns.clone() },
            com: self.com + way,
            base: self.base.clone(),
        }
    }
}
