//! Which feet of a walk bear when, by where they turn: a foot comes down when it is farthest ahead of the pelvis and leaves when it is
//! farthest behind it.
//!
//! Zeni, Richards and Higginson, "Two simple methods for determining gait events during treadmill and overground walking using kinematic
//! data", Gait & Posture 27 (2008). It holds for keyed walks in place, whose feet slide, sink and are never still; what is high over a
//! foot's own floor is in the air all the same. Frames of the clip, m. Leaves out walks that turn on the way by more than they step.

use super::BaseFrame;
use super::bearing::{Bears, lowest};
use super::foot::to_ball;
use crate::maths::real;
use crate::model::{Body, Side};
use glam::{DVec2, DVec3};

/// Part of a foot's way that a turn must be followed by to be one.
const TURNS: f64 = 0.3;
/// m at a leg of 0.83 m: a sole that is farther over its own floor is in the air.
const HIGH: f64 = 0.05;
/// m at a leg of 0.83 m: feet that go less to and fro do not walk.
const STRIDES: f64 = 0.1;

/// Where the feet are against the pelvis, by frame and side: ankle and ball, m.
fn against_pelvis(body: &Body, frames: &[BaseFrame]) -> Vec<[[DVec3; 2]; 2]> {
    let one = |frame: &BaseFrame| {
        let positions = frame.pose.positions(body);
        Side::BOTH.map(|side| {
            let ankle = body.feet[side as usize].ankle;
            let off = positions[ankle] - frame.pose.hips;
            [off, off + frame.pose.turns[ankle] * to_ball(body, side)]
        })
    };
    frames.iter().map(one).collect()
}

/// Unit, level: where a walk goes, as its feet say. They go to and fro along it, forward higher than back.
fn ahead(feet: &[[[DVec3; 2]; 2]], heights: &[[f64; 2]]) -> Option<DVec2> {
    let flat = |point: DVec3| DVec2::new(point.x, point.z);
    let count = feet.len().max(1) as f64;
    let apart: Vec<DVec2> = feet.iter().map(|feet| flat(feet[0][0] - feet[1][0])).collect();
    let mean = apart.iter().sum::<DVec2>() / count;
    let (mut xx, mut xz, mut zz) = (0.0, 0.0, 0.0);
    for apart in &apart {
        let off = *apart - mean;
        xx += off.x * off.x;
        xz += off.x * off.y;
        zz += off.y * off.y;
    }
    let axis = DVec2::from_angle(0.5 * real::atan2(2.0 * xz, xx - zz));
    let level = heights.iter().map(|heights| heights[0] + heights[1]).sum::<f64>() / (2.0 * count);
    let mut sign = 0.0;
    for (pair, heights) in feet.windows(2).zip(heights.windows(2)) {
        for side in 0..2 {
            let goes = flat(pair[1][side][0] - pair[0][side][0]).dot(axis);
            sign += goes * (0.5 * (heights[0][side] + heights[1][side]) - level);
        }
    }
    (sign != 0.0).then(|| axis * sign.signum())
}

/// The feet that bear by where they turn; none where they do not walk.
pub(super) fn turning(body: &Body, frames: &[BaseFrame], size: f64) -> Vec<Bears> {
    let feet = against_pelvis(body, frames);
    let positions: Vec<[f64; 2]> = frames.iter().map(|frame| lowest(body, frame)).collect();
    let ankles: Vec<[f64; 2]> =
        frames.iter().zip(&feet).map(|(frame, feet)| [0, 1].map(|side| feet[side][0].y + frame.pose.hips.y)).collect();
    let Some(ahead) = ahead(&feet, &ankles) else { return Vec::new() };
    let mut list = Vec::new();
    for side in Side::BOTH {
        let along = |point: usize| -> Vec<f64> {
            feet.iter()
                .map(|feet| DVec2::new(feet[side as usize][point].x, feet[side as usize][point].z))
                .map(|at| at.dot(ahead))
                .collect()
        };
        let (ankle, ball) = (along(0), along(1));
        let low: Vec<f64> = positions.iter().map(|low| low[side as usize]).collect();
        let spans = falls(&ankle, STRIDES * size);
        let spans = spans.into_iter().map(|(start, end)| {
            // The ball leaves a little sooner or later than the ankle turns.
            let near = (end - start) / 3;
            let window = end.saturating_sub(near)..=(end + near).min(ball.len() - 1);
            let left = window.min_by(|a, b| ball[*a].total_cmp(&ball[*b])).unwrap_or(end);
            (start, if end + 1 == ball.len() { end } else { left })
        });
        let spans: Vec<(usize, usize)> = spans.collect();
        let mut middles: Vec<f64> = spans
            .iter()
            .flat_map(|(start, end)| {
                let third = (end - start) / 3;
                low[start + third..=end - third].iter().copied()
            })
            .collect();
        middles.sort_by(f64::total_cmp);
        let Some(floor) = middles.get(middles.len() / 2) else { continue };
        for (mut start, mut end) in spans {
            let high = |frame: usize| low[frame] > floor + HIGH * size;
            while start < end && high(start) {
                start += 1;
            }
            while end > start && high(end) {
                end -= 1;
            }
            if end > start + 1 {
                list.push(Bears { side, start, end });
            }
        }
    }
    list.sort_by_key(|contact| (contact.start, contact.side));
    list
}

/// From each highest value to the lowest one after it; a clip may begin or end on the way.
fn falls(values: &[f64], least: f64) -> Vec<(usize, usize)> {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    let turn = TURNS * (high - low);
    if high - low < least || values.len() < 3 {
        return Vec::new();
    }
    let mut list = Vec::new();
    let mut falling: Option<bool> = None;
    let (mut top, mut bottom, mut from) = (0, 0, 0);
    for (at, value) in values.iter().enumerate() {
        if *value >= values[top] {
            top = at;
        }
        if *value <= values[bottom] {
            bottom = at;
        }
        if falling != Some(true) && values[top] - value > turn {
            // Before its first turn a clip falls from its start, or from the top.
            from = top;
            falling = Some(true);
            bottom = at;
        } else if falling != Some(false) && value - values[bottom] > turn {
            match falling {
                Some(true) => list.push((from, bottom)),
                _ if bottom > 2 => list.push((0, bottom)),
                _ => {}
            }
            falling = Some(false);
            top = at;
        }
    }
    if falling == Some(true) {
        list.push((from, values.len() - 1));
    } else if falling == Some(false) && top + 3 < values.len() {
        list.push((top, values.len() - 1));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_foot_bears_from_its_foremost_to_its_rearmost_place_and_at_the_clips_ends_on_the_way() {
        // Foremost at 0, 40, 80; rearmost at 20, 60, 100.
        let place = |frame: usize| 0.3 * real::cos(frame as f64 * std::f64::consts::PI / 20.0);
        let all: Vec<f64> = (0..=110).map(place).collect();
        assert_eq!(falls(&all, 0.1), vec![(0, 20), (40, 60), (80, 100)]);
        let inside: Vec<f64> = (50..=93).map(place).collect();
        assert_eq!(falls(&inside, 0.1), vec![(0, 10), (30, 43)]);
        let still: Vec<f64> = all.iter().map(|value| value * 0.1).collect();
        assert!(falls(&still, 0.1).is_empty());
    }
}
