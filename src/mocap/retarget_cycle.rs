//! Clips that repeat and clips that walk on the spot, made to what they stand for before they are retargeted.
//!
//! Clip space, m, s. In a walk on the spot the ground goes by like a belt: its velocity is that of the feet while they are low, and taking it
//! out lets the feet stand still. A clip that ends as it began is played three times and the middle one kept, so that what is held and eased
//! across the seam is the same on both sides of it. Turns of the heading between the ends are no cycle here.

use super::retarget_planted::{Planted, Sole, Stance, merged};
use crate::maths::real;
use crate::model::report::Part;
use crate::model::{Body, Capture, Side};
use glam::{DQuat, DVec3};

/// m/s at a leg of 0.83 m: a belt is faster.
const SLOWEST: f64 = 0.2;
/// Of the belt's speed: the pelvis gets no further, the low feet are no less of one mind.
const STAYS: f64 = 0.25;
/// See [`STAYS`].
const AGREE: f64 = 0.4;
/// m: a foot is low while it is no higher over its lowest.
const LOW: f64 = 0.03;
/// rad, m: the ends of a cycle differ by no more.
const SAME: (f64, f64) = (0.01, 0.005);

/// m/s: how the ground goes by under somebody who walks on the spot; `None` for a clip that stands on its ground.
pub fn belt(capture: &Capture) -> Option<DVec3> {
    let body = &capture.body;
    let frames = capture.frames();
    let size = body.leg_length / 0.83;
    let level = DVec3::new(1.0, 0.0, 1.0);
    if frames < 5 {
        return None;
    }
    let mut speeds: Vec<DVec3> = Vec::new();
    for side in Side::BOTH {
        let sole = Sole::of(body, side);
        let ankle = body.feet[side as usize].ankle;
        let points = |frame: usize| {
            let (at, turn) = (capture.at(frame)[ankle], capture.turns_at(frame)[ankle]);
            [at + sole.pivot(Part::Heel, turn), at + sole.pivot(Part::Ball, turn)]
        };
        let low = |frame: usize| points(frame).map(|point| point.y);
        let lowest = (0..frames).fold([f64::INFINITY; 2], |lowest, frame| {
            let now = low(frame);
            [lowest[0].min(now[0]), lowest[1].min(now[1])]
        });
        for frame in 1..frames - 1 {
            let (before, now, after) = (points(frame - 1), low(frame), points(frame + 1));
            let over = [0, 1].map(|at| now[at] - lowest[at]);
            let at = usize::from(over[1] < over[0]);
            if over[at] < LOW * size {
                speeds.push((after[at] - before[at]) * level * (0.5 * capture.fps));
            }
        }
    }
    let median = |value: &dyn Fn(&DVec3) -> f64| {
        let mut values: Vec<f64> = speeds.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let belt = DVec3::new(median(&|speed| speed.x), 0.0, median(&|speed| speed.z));
    let speed = belt.length();
    let off = median(&|one| one.distance(belt));
    let seconds = (frames - 1) as f64 / capture.fps;
    let gone = (capture.at(frames - 1)[0] - capture.at(0)[0]) * level / seconds;
    (speed > SLOWEST * size.max(0.0).sqrt() && off < AGREE * speed && gone.length() < STAYS * speed).then_some(belt)
}

/// The clip moved by a velocity: on the ground's side of a belt, or back.
pub(super) fn moved(capture: &mut Capture, velocity: DVec3) {
    let joints = capture.body.joints.len().max(1);
    let fps = capture.fps;
    for (index, place) in capture.positions.iter_mut().enumerate() {
        *place += velocity * ((index / joints) as f64 / fps);
    }
}

/// What a cycle adds to the places, if the clip ends as it began.
pub(super) fn cycle(capture: &Capture) -> Option<DVec3> {
    let last = capture.frames().checked_sub(1).filter(|last| *last >= 8)?;
    let turned = capture.turns_at(0).iter().zip(capture.turns_at(last)).map(|(a, b): (&DQuat, &DQuat)| {
        let turn = a.inverse() * *b;
        2.0 * real::atan2(turn.xyz().length(), turn.w.abs())
    });
    let travel = capture.at(last)[0] - capture.at(0)[0];
    let same = turned.fold(0.0, f64::max) < SAME.0 && travel.y.abs() < SAME.1 * capture.body.leg_length / 0.83;
    same.then_some(travel * DVec3::new(1.0, 0.0, 1.0))
}

/// Three cycles, the first of which begins one travel earlier: the middle one is the clip.
pub(super) fn three(capture: &Capture, travel: DVec3) -> Capture {
    let joints = capture.body.joints.len();
    let whole = capture.positions.len();
    let mut long = Capture { positions: Vec::new(), turns: Vec::new(), ..capture.clone() };
    // The middle one has both of its ends.
    for (round, range) in [(-1.0, 0..whole - joints), (0.0, 0..whole), (1.0, joints..whole)] {
        long.positions.extend(capture.positions[range.clone()].iter().map(|place| *place + travel * round));
        long.turns.extend_from_slice(&capture.turns[range]);
    }
    long
}

/// The middle one of three again, of another body by now.
pub(super) fn middle(long: &Capture, body: &Body, frames: usize) -> Capture {
    let joints = body.joints.len();
    let range = (frames - 1) * joints..(2 * frames - 1) * joints;
    let positions = long.positions[range.clone()].to_vec();
    Capture { positions, turns: long.turns[range].to_vec(), ..long.clone() }
}

/// Stances of one cycle in three; what ends with it goes on with the next.
pub(super) fn thrice(planted: &[Planted], frames: usize) -> Vec<Planted> {
    let once = frames - 1;
    let all: Vec<Planted> = (0..3)
        .flat_map(|round| {
            let by = round * once;
            let inside = planted.iter().filter(|one| one.start <= once);
            inside.map(move |one| Planted { start: one.start + by, end: one.end.min(once) + by, ..*one })
        })
        .collect();
    merged(&all)
}

/// The stances of three cycles that lie in the middle one, by its frames.
pub(super) fn stances_of_middle(stances: Vec<Stance>, frames: usize) -> Vec<Stance> {
    let (first, last) = (frames - 1, 2 * (frames - 1));
    let cut = |stance: Stance| {
        let Planted { side, start, end } = stance.planted;
        let (from, to) = (start.max(first), end.min(last));
        (from <= to).then(|| Stance {
            planted: Planted { side, start: from - first, end: to - first },
            parts: stance.parts[from - start..=to - start].to_vec(),
            height: stance.height,
        })
    };
    stances.into_iter().filter_map(cut).collect()
}
