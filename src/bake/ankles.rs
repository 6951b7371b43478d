//! Ankles and hips within their ranges: what a foot turns beside its curve where its contact leaves it free to, and how far
//! the pelvis goes along with a thigh.
//!
//! A foot's curve knows the ground and not the shank above it. In the air a foot turns as its ankle likes; on its ball or
//! heel it rolls a little; flat it does not. So pitch and roll beside the curve are fitted by the least acceleration that
//! keeps flexion and inversion within range and the contact as it is; tilt and list of the pelvis likewise. A knee that is bent
//! turns in or out, so that its shank stands straighter over a flat foot. What such a foot's ankle flexes is not eased here: that
//! is up to when heels rise (`feet`) and feet leave (`footing`).
//! Scenario space, radians, seconds.

use super::swing::Extra;
use super::timeline::Timeline;
use crate::maths::banded::BandedLeastSquares;
use crate::maths::curve::smooth3;
use crate::measure::joints::LegAngles;
use crate::model::Side;
use crate::whole_body::solve::Solved;
use glam::{DQuat, DVec3};

/// s, over which the fit slows the turn down, and over which it rounds it (for a centre of mass at 0.96 m).
const SLOW: f64 = 0.05;
/// s.
const EVEN: f64 = 0.035;
/// rad/s, how fast a contact may take the turn away.
const FASTEST: f64 = 4.0;
/// rad, by which it stays inside of the range.
const MARGIN: f64 = 0.6 * std::f64::consts::PI / 180.0;
/// Weight of a bound of the ankle, against no turn.
const HOLD: f64 = 3e4;
/// The same of a bound of the contact.
const GROUND: f64 = 1e9;
/// Rounds of the one-sided penalty.
const ROUNDS: usize = 12;

/// Fits the turns of both feet afresh to the poses that the present ones gave. `scale`: times relative to the reference
/// body. A walker's feet keep to their curves: turned like this, they pop more often than their ankles gain.
pub fn ease(timeline: &mut Timeline, legs: &LegAngles, solved: &[Solved], scale: f64) {
    let Timeline { feet, walking, dt, .. } = timeline;
    let dt = *dt;
    for side in Side::BOTH {
        let ranges = legs.ranges(side);
        // A foot that turns its heel up flexes less; one that rolls leftwards everts on the left side, inverts on the right.
        let signs = [-1.0, -side.sign()];
        let present: Vec<[f64; 2]> = (0..solved.len()).map(|index| feet.extra(side).at(index as f64 * dt)).collect();
        let mut rooms: Vec<[[f64; 2]; 2]> = (0..solved.len())
            .map(|index| if walking[index] > 0.0 { [[0.0; 2]; 2] } else { feet.room(side, index as f64 * dt, dt) })
            .collect();
        // No foot snaps from what its ankle wants to what its contact does.
        let step = FASTEST * dt / scale;
        let narrow = |room: &mut [[f64; 2]; 2], beside: [[f64; 2]; 2]| {
            for (room, beside) in room.iter_mut().zip(beside) {
                *room = [room[0].max(beside[0] - step), room[1].min(beside[1] + step)];
            }
        };
        for index in 1..rooms.len() {
            let beside = rooms[index - 1];
            narrow(&mut rooms[index], beside);
        }
        for index in (1..rooms.len()).rev() {
            let beside = rooms[index];
            narrow(&mut rooms[index - 1], beside);
        }
        let turns = [0, 1].map(|axis| {
            let bounds: Vec<Bound> = (0..solved.len())
                .map(|index| {
                    let room = rooms[index][axis];
                    let Some(angles) = legs.at(&solved[index].pose, side) else {
                        return Bound { room, wanted: room };
                    };
                    let bare = present[index][axis] - signs[axis] * angles[2 + axis];
                    let ends = ranges[2 + axis].map(|end| bare + signs[axis] * end);
                    let (low, high) = (ends[0].min(ends[1]) + MARGIN, ends[0].max(ends[1]) - MARGIN);
                    Bound { room, wanted: [low.clamp(room[0], room[1]), high.clamp(room[0], room[1])] }
                })
                .collect();
            fitted(&bounds, scale / dt)
        });
        *feet.extra(side) = Extra { dt, turns };
    }
}

/// rad, the most that the pelvis tilts and lists for a thigh.
const PELVIS: [f64; 2] = [10.0 * std::f64::consts::PI / 180.0, 7.0 * std::f64::consts::PI / 180.0];
/// How much slower than a foot the pelvis turns.
const PELVIS_SLOWER: f64 = 1.6;

/// Fits the tilt and the list of the pelvis that keep both hips within range; a walker's where the ground is `uneven` or it crouches.
pub fn ease_hips(timeline: &mut Timeline, legs: &LegAngles, solved: &[Solved], scale: f64, uneven: bool) {
    let dt = timeline.dt;
    let first = (timeline.still_until / dt).round() as usize;
    // Who stands beyond a range (on legs of a quarter of their length) stands so: nothing is eased that nobody disturbs.
    let standing = Side::BOTH.map(|side| {
        let mut ranges = legs.ranges(side);
        if let Some(angles) = solved.first().and_then(|first| legs.at(&first.pose, side)) {
            for (range, angle) in ranges.iter_mut().zip(angles) {
                *range = [range[0].min(angle - 2.0 * MARGIN), range[1].max(angle + 2.0 * MARGIN)];
            }
        }
        ranges
    });
    let turns = [0, 1].map(|axis| {
        let bounds: Vec<Bound> = (0..solved.len())
            .map(|index| {
                let most = if timeline.walking[index] > 0.0 && !uneven || index <= first + 1 || index + 3 > solved.len()
                {
                    0.0
                } else {
                    PELVIS[axis]
                };
                let room = [-most, most];
                let present = timeline.pelvis[axis].get(index).copied().unwrap_or(0.0);
                let mut wanted = [f64::NEG_INFINITY, f64::INFINITY];
                for side in Side::BOTH {
                    let Some(angles) = legs.at(&solved[index].pose, side) else { continue };
                    // Tilted forwards both hips flex; listed to the right the left leg is adducted, the right abducted.
                    let sign = if axis == 0 { 1.0 } else { -side.sign() };
                    let bare = present - sign * angles[axis];
                    let ends = standing[side as usize][axis].map(|end| bare + sign * end);
                    wanted[0] = wanted[0].max(ends[0].min(ends[1]) + MARGIN);
                    wanted[1] = wanted[1].min(ends[0].max(ends[1]) - MARGIN);
                }
                if wanted[0] > wanted[1] {
                    // What helps one hip harms the other.
                    wanted = [0.5 * (wanted[0] + wanted[1]); 2];
                }
                Bound { room, wanted: wanted.map(|end| end.clamp(room[0], room[1])) }
            })
            .collect();
        fitted(&bounds, PELVIS_SLOWER * scale / dt)
    });
    timeline.pelvis = turns;
}

/// rad, the most that a knee turns in or out for its ankle: on level ground, and of a walker and of who stands on ground that slants.
const SWIVEL: [f64; 3] =
    [14.0 * std::f64::consts::PI / 180.0, 40.0 * std::f64::consts::PI / 180.0, 60.0 * std::f64::consts::PI / 180.0];
/// rad, the most of that inwards on ground that slants: in walks across a slope of 25 degrees knees come near each other, and the score
/// falls by 0.01 to 0.05 for the next 4 degrees.
const INWARD: f64 = 4.0 * std::f64::consts::PI / 180.0;
/// Inversion that a knee's turn yields, rad a rad: a straighter knee than the first does not turn, from the second on as far as any.
const YIELDS: [f64; 2] = [0.08, 0.25];
/// rad, by which a knee is turned to see what that yields.
const PROBE: f64 = 1e-3;

/// Fits the turns of both knees about the lines from hip to ankle that bring back into range what inversion [`ease`] left out of
/// it. A walker's knees keep to their way but where the ground is `uneven`.
pub fn ease_knees(timeline: &mut Timeline, legs: &LegAngles, solved: &[Solved], scale: f64, uneven: bool) {
    let dt = timeline.dt;
    let first = (timeline.still_until / dt).round() as usize;
    for side in Side::BOTH {
        let leg = &timeline.anatomy.legs[side as usize];
        let range = legs.ranges(side)[3];
        let bounds: Vec<Bound> = (0..solved.len())
            .map(|index| {
                const NONE: Bound = Bound { room: [0.0; 2], wanted: [0.0; 2] };
                let Some(angles) = legs.at(&solved[index].pose, side) else { return NONE };
                if timeline.walking[index] > 0.0 && !uneven || index <= first + 1 || index + 3 > solved.len() {
                    return NONE;
                }
                let pose = &solved[index].pose;
                let shank = timeline.body.offset(leg.foot);
                let thigh = timeline.body.offset(leg.lower);
                let axis = (pose.turns[leg.upper] * thigh + pose.turns[leg.lower] * shank).normalize_or(DVec3::NEG_Y);
                let mut turned = pose.clone();
                turned.turns[leg.lower] = DQuat::from_axis_angle(axis, PROBE) * pose.turns[leg.lower];
                let Some(beside) = legs.at(&turned, side) else { return NONE };
                let slope = (beside[3] - angles[3]) / PROBE;
                let stands = uneven && timeline.walking[index] <= 0.0;
                let most = SWIVEL[usize::from(uneven) + usize::from(stands)]
                    * smooth3((slope.abs() - YIELDS[0]) / (YIELDS[1] - YIELDS[0]));
                if most <= 0.0 {
                    return NONE;
                }
                let present = timeline.swivels[side as usize].get(index).copied().unwrap_or(0.0);
                let ends = [range[0] + MARGIN, range[1] - MARGIN].map(|end| present + (end - angles[3]) / slope);
                let inward = if uneven { most.min(INWARD) } else { most };
                let room = if side == Side::Left { [-most, inward] } else { [-inward, most] };
                let wanted = [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| end.clamp(room[0], room[1]));
                Bound { room, wanted }
            })
            .collect();
        timeline.swivels[side as usize] = fitted(&bounds, scale / dt);
    }
}

/// What is possible at one entry, and what the ankle wants of it: least and greatest. rad.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    pub(super) room: [f64; 2],
    pub(super) wanted: [f64; 2],
}

/// The turns. `per`: entries a second, of the body's own time.
pub(super) fn fitted(bounds: &[Bound], per: f64) -> Vec<f64> {
    let count = bounds.len();
    let mut turns = vec![0.0; count];
    // Which bound each entry is held to: the ankle's or the contact's, lower or upper.
    let mut held: Vec<Option<(f64, f64)>> = vec![None; count];
    for _ in 0..ROUNDS {
        let mut changed = false;
        for (index, bound) in bounds.iter().enumerate() {
            let turn: f64 = turns[index];
            let to = |end: f64, edge: f64| (end, if end == edge { GROUND } else { HOLD });
            let next = if bound.room[0] == bound.room[1] {
                Some((bound.room[0], GROUND))
            } else if turn < bound.wanted[0] - 1e-9
                || (held[index].is_some_and(|held| held.0 == bound.wanted[0]) && turn < bound.wanted[0] + 1e-9)
            {
                Some(to(bound.wanted[0], bound.room[0]))
            } else if turn > bound.wanted[1] + 1e-9 {
                Some(to(bound.wanted[1], bound.room[1]))
            } else {
                None
            };
            changed |= next != held[index];
            held[index] = next;
        }
        if !changed {
            break;
        }
        let mut system = BandedLeastSquares::new(count, 2);
        for (index, held) in held.iter().enumerate() {
            system.equation(index, &[1.0], 0.0, 1.0);
            if index + 1 < count {
                system.equation(index, &[-1.0, 1.0], 0.0, (SLOW * per).powi(2));
            }
            if index + 2 < count {
                system.equation(index, &[1.0, -2.0, 1.0], 0.0, (EVEN * per).powi(4));
            }
            if let Some((end, weight)) = *held {
                system.equation(index, &[1.0], end, weight);
            }
        }
        turns = system.solve();
    }
    turns.iter().zip(bounds).map(|(turn, bound)| turn.clamp(bound.room[0], bound.room[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::{Bound, fitted};

    #[test]
    fn a_foot_in_the_air_turns_as_its_ankle_asks_and_not_before_it_is_off_the_ground() {
        // Flat but for 40 entries in the air, of which the ankle asks for 0.3 rad in the last three quarters.
        let bound = |index: i32| match index {
            30..70 => {
                let far = 0.04 * f64::from((index - 29).min(70 - index));
                let room = [-far, far];
                Bound { room, wanted: [if index > 40 { 0.3_f64.min(far) } else { -far }, far] }
            }
            _ => Bound { room: [0.0; 2], wanted: [0.0; 2] },
        };
        let bounds: Vec<Bound> = (0..100).map(bound).collect();
        let turns = fitted(&bounds, 100.0);
        assert!(turns[..30].iter().chain(&turns[70..]).all(|turn| *turn == 0.0), "a flat foot turns");
        assert!(turns[42..60].iter().all(|turn| *turn > 0.29), "short of what the ankle asks: {:?}", &turns[40..62]);
        assert!(turns.iter().all(|turn| *turn < 0.40), "far beyond it");
        let fastest = turns.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(fastest < 0.06, "{fastest} rad in 10 ms");
        let free = vec![Bound { room: [-0.5, 0.5], wanted: [-0.1, 0.2] }; 50];
        assert!(fitted(&free, 100.0).iter().all(|turn| *turn == 0.0), "nothing asked, nothing done");
    }
}
