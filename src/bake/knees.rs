//! Knees of swinging legs: bends that leave the ground and come down again as the planted leg bends, without a jerk.
//!
//! The foot's own flight, the hip's sway and the soft reach each are smooth, but the knee near straight is a steep function
//! of the distance between hip and ankle: together they start, turn and stop it within a frame or two. So the bend over a
//! swing is fitted by the least speed and acceleration that stay near the wanted bend, join the planted bends on both sides
//! and keep the sole off the ground; the ankle follows along its leg's line. Scenario space, metres, seconds, radians.

use super::care::Care;
use super::timeline::Timeline;
use crate::maths::banded::BandedLeastSquares;
use crate::measure::ground::height_below;
use crate::model::{Body, Side};
use crate::whole_body::FootTarget;
use crate::whole_body::solve::{Solved, soft_reach};
use glam::DVec3;

/// s, over which the fit slows the knee down, and over which it rounds what is left (for a centre of mass at 0.96 m).
const SLOW: f64 = 0.05;
/// s.
const EVEN: f64 = 0.02;
/// How much more than to be slow a knee keeps to a speed that it is asked for.
const ASKED: f64 = 16.0;
/// rad, least bend of a leg in the air.
const LEAST_BEND: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Part of the sole's height over the ground that a straighter knee may take up.
const DOWN: f64 = 0.8;
/// m, by which a sole may be under the ground.
const SUNK: f64 = 1e-3;
/// Weight of a bend that must not be less, and of a planted one, against a wanted one.
const HOLD: f64 = 1e5;
/// Rounds of the one-sided penalty.
const ROUNDS: usize = 40;

/// Fits the bends of all swings afresh to the poses that the present ones gave. `scale`: times relative to the reference body.
pub fn even_knees(timeline: &mut Timeline, solved: &[Solved], scale: f64, care: &Care) {
    for side in Side::BOTH {
        let legs = (0..solved.len()).map(|index| Leg::of(timeline, side, index, &solved[index]));
        let legs: Vec<Leg> = legs.collect();
        let paces: Vec<f64> = care.paces(side).iter().map(|pace| pace * timeline.dt).collect();
        let bends = fitted(&legs, (care.of(side), &paces), scale / timeline.dt);
        timeline.bends[side as usize] = bends;
    }
}

/// A leg at one entry. rad.
#[derive(Clone, Copy, Debug)]
struct Leg {
    wanted: f64,
    least: f64,
    free: bool,
}

impl Leg {
    fn of(timeline: &Timeline, side: Side, index: usize, solved: &Solved) -> Leg {
        let time = index as f64 * timeline.dt;
        let leg = &timeline.anatomy.legs[side as usize];
        let foot = timeline.feet.at(side, time);
        let hip = solved.hips[side as usize];
        let ankle = soft_reach(hip, foot.ankle, leg.length(), foot.soft);
        let length = (ankle - hip).length();
        let wanted = leg.bend_at(length);
        let free = timeline.feet.freedom(side, time) > 0.0;
        if !free {
            return Leg { wanted, least: wanted, free };
        }
        let down = ((hip.y - ankle.y) / length.max(1e-9)).max(0.3);
        let ground = |point: DVec3| height_below(&timeline.terrain, time, point);
        let over = |ankle: DVec3| lowest(&timeline.body, side, &foot, ankle, &ground);
        let mut room = DOWN * over(ankle).max(0.0) / down;
        // Down along the leg is on, into a riser where there is one.
        while room > SUNK && over(ankle + (ankle - hip) * (room / length.max(1e-9))) < -SUNK {
            room *= 0.5;
        }
        Leg { wanted, least: leg.bend_at(length + room).max(LEAST_BEND.min(wanted)), free }
    }
}

/// m, least height over the ground of the sole with its ankle there.
fn lowest(body: &Body, side: Side, foot: &FootTarget, ankle: DVec3, ground: &dyn Fn(DVec3) -> f64) -> f64 {
    let shape = &body.feet[side as usize];
    let rear = shape.rear_sole.iter().map(|vertex| foot.foot * *vertex);
    let joint = shape.toe.map(|toe| body.joints[toe].rest - body.joints[shape.ankle].rest);
    let front = shape.front_sole.iter().map(|vertex| match joint {
        Some(joint) => foot.foot * joint + foot.toe * (*vertex - joint),
        None => foot.foot * *vertex,
    });
    let over = rear.chain(front).map(|offset| (ankle + offset).y - ground(ankle + offset));
    over.fold(f64::INFINITY, f64::min)
}

/// The bends: as wanted where the leg is not free. `care`: how much more than elsewhere each is evened; `paces`: rad to the next entry that are
/// asked for instead of none, but for 0; `per`: entries a second, of the body's own time.
fn fitted(legs: &[Leg], (care, paces): (&[f64], &[f64]), per: f64) -> Vec<f64> {
    let count = legs.len();
    let mut held = vec![false; count];
    let mut bends: Vec<f64> = legs.iter().map(|leg| leg.wanted).collect();
    if legs.iter().all(|leg| !leg.free) {
        return bends;
    }
    for _ in 0..ROUNDS {
        let mut system = BandedLeastSquares::new(count, 2);
        for (index, leg) in legs.iter().enumerate() {
            if index + 1 < count && legs[index..=index + 1].iter().any(|leg| leg.free) {
                let asked = if paces[index] == 0.0 { 1.0 } else { ASKED };
                system.equation(index, &[-1.0, 1.0], paces[index], asked * care[index] * (SLOW * per).powi(2));
            }
            if index + 2 < count && legs[index..=index + 2].iter().any(|leg| leg.free) {
                system.equation(index, &[1.0, -2.0, 1.0], 0.0, care[index + 1] * (EVEN * per).powi(4));
            }
            let weight = if leg.free { 1.0 } else { 1e4 * HOLD };
            system.equation(index, &[1.0], leg.wanted, weight);
            if leg.free && held[index] {
                system.equation(index, &[1.0], leg.least, HOLD);
            }
        }
        bends = system.solve();
        let mut changed = false;
        for (index, leg) in legs.iter().enumerate() {
            let wanted = leg.free && bends[index] < leg.least;
            changed |= wanted != held[index] && leg.free;
            held[index] = wanted;
        }
        if !changed {
            break;
        }
    }
    for (bend, leg) in bends.iter_mut().zip(legs) {
        *bend = if leg.free { bend.max(0.5 * leg.least) } else { leg.wanted };
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::{Leg, fitted};

    #[test]
    fn bends_join_the_planted_leg_clear_the_ground_and_turn_slowly() {
        // A swing of 0.3 s that snaps from 0.3 to 1.2 rad within 20 ms of lift, and must not go under 0.9 in its middle.
        let leg = |index: i32| match index {
            30..60 => Leg { wanted: 1.2, least: if (42..48).contains(&index) { 0.9 } else { 0.2 }, free: true },
            _ => Leg { wanted: 0.3, least: 0.3, free: false },
        };
        let legs: Vec<Leg> = (0..90).map(leg).collect();
        let bends = fitted(&legs, (&[1.0; 90], &[0.0; 90]), 100.0);
        assert!((0..90).filter(|at| !legs[*at].free).all(|at| bends[at] == 0.3), "a planted leg is left alone");
        assert!(bends[42..48].iter().all(|bend| *bend > 0.89), "over the ground: {:?}", &bends[42..48]);
        let fastest = bends.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(fastest < 0.13, "{fastest} rad in 10 ms, 0.9 wanted");
    }

    #[test]
    fn a_knee_that_is_asked_for_a_speed_in_the_air_has_it_and_one_on_the_ground_has_not() {
        let leg = |index: i32| Leg {
            wanted: 0.5,
            least: if (20..60).contains(&index) { 0.2 } else { 0.5 },
            free: (20..60).contains(&index),
        };
        let legs: Vec<Leg> = (0..80).map(leg).collect();
        let mut paces = [0.0; 80];
        paces[53..57].fill(-0.02);
        paces[70..74].fill(-0.02);
        let bends = fitted(&legs, (&[1.0; 80], &paces), 100.0);
        assert!((53..57).all(|at| bends[at + 1] - bends[at] < -0.012), "{:?}", &bends[50..60]);
        assert!(bends[60..].iter().all(|bend| *bend == 0.5), "a planted leg is left alone");
    }
}
