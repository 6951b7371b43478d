//! Swinging legs that come too near to the other one go round it by a little more.
//!
//! A swing's own detour (`swing`) knows where the feet are and not where shanks and toes are: what is left is seen on the
//! poses, and the foot's path bent away from the nearest point. Ground frame, metres, seconds. Not on ground that moves.

use super::timeline::Timeline;
use crate::maths::curve::bump;
use crate::measure::feet::nearest_points;
use crate::model::{Body, Side};
use crate::whole_body::anatomy::Leg;
use crate::whole_body::solve::Solved;
use glam::DVec3;

/// m at a leg of 0.83 m: legs nearer than this (axes of shank and foot) go round. The measure asks for 0.08.
const NEAR: f64 = 0.088;
/// Part of the leg, the farthest that a swing goes round beyond its own detour, each time.
const MOST: f64 = 0.04;
/// Least part of a swing's detour that a moment may have for it to be mended by the detour.
const AMID: f64 = 0.25;

/// Bends the swings of both feet away from where the legs come near; `solved`: the poses of the present curves.
pub fn keep_apart(timeline: &mut Timeline, solved: &[Solved]) {
    let Timeline { body, anatomy, feet, terrain, dt, .. } = timeline;
    if terrain.moves() {
        return;
    }
    let leg = anatomy.legs[0].length();
    let near = NEAR * leg / 0.83;
    for side in Side::BOTH {
        for number in 0..feet.feet[side as usize].swings.len() {
            let swing = feet.feet[side as usize].swings[number];
            let ticks = (swing.lift / *dt).ceil() as usize..=(swing.land / *dt).floor() as usize;
            let mut worst = DVec3::ZERO;
            for index in ticks.filter(|index| *index < solved.len()) {
                let time = index as f64 * *dt;
                let amid = bump(swing.along(time));
                if amid < AMID || feet.is_clips(side, time) {
                    continue;
                }
                let axes = Side::BOTH.map(|side| axis(body, &anatomy.legs[side as usize], &solved[index]));
                let (own, other) = (&axes[side as usize], &axes[side.other() as usize]);
                let pairs = own.windows(2).flat_map(|a| other.windows(2).map(move |b| [[a[0], a[1]], [b[0], b[1]]]));
                for [a, b] in pairs {
                    let [here, there] = nearest_points(a, b);
                    let away = here - there;
                    let missing = near - away.length();
                    let flat = (away * DVec3::new(1.0, 0.0, 1.0)).normalize_or_zero();
                    // A knee goes half as far as its foot.
                    let far = missing / amid / if a[0] == own[0] { 0.7 } else { 1.0 };
                    if missing > 0.0 && far > worst.length() {
                        worst = flat * far;
                    }
                }
            }
            feet.feet[side as usize].swings[number].aside += worst.clamp_length_max(MOST * leg);
        }
    }
}

/// Knee, ankle and toe joint, or for want of one the ankle again.
fn axis(body: &Body, leg: &Leg, solved: &Solved) -> [DVec3; 3] {
    let positions = solved.pose.positions(body);
    [leg.lower, leg.foot, leg.toe.unwrap_or(leg.foot)].map(|joint| positions[joint])
}
