//! How a body holds itself where the ground rises before it. Scenario space, SI; a rise is metres a metre, where the pelvis faces.
//!
//! An ankle flexes by 30 degrees from upright. Uphill the slope takes of that what it leans by, and a bent knee, which leans the shank
//! forwards, takes the rest: then the heel comes up, only the ball is in contact, and the body tips backwards. So legs are held straighter,
//! the trunk leans forwards, which brings the hips back, and balance is held over a point nearer to the heel.

use super::control::Controller;
use super::crouch;
use super::figure::{Figure, Link, Part};
use super::flat;
use crate::maths::real;
use crate::model::Terrain;
use glam::{DQuat, DVec2};

/// rad by which the trunk leans for each metre that the ground rises in a metre, of who stands and of who walks. Standing, with 1.4 two of
/// five bodies tip backwards at 27 degrees, with 1.2 at 25. By walks on four: with 1.5 a third falls up 16 degrees; with 2.4 they are
/// steadier still, but bent over.
const LEANS_IN: [f64; 2] = [1.6, 1.8];
/// The steepest rise that it leans for: 27 degrees.
const STEEPEST: f64 = 0.5;
/// By how much less it leans for each metre a metre that the ground is steeper. There legs are stretched behind it, and steer it no more: of 30 drawn
/// minutes on platforms that lean to 45 degrees, shoved, 26 end in a fall with 0, 14 with 0.25, 13 with this, 10 with 1.
const EASES: f64 = 0.5;
/// Share of the sole's length by which balance is held nearer to the heels, for each metre that the ground rises in a metre. By stands of
/// five bodies at 25 degrees: with 0.37 most drift back over their heels and step, with 0.1 ankles are at their ends and some tip backwards.
/// Of 160 drawn shoves of who stands facing up 10 to 25 degrees 11 fall with 0.37 (and 1.4 above), 6 with these.
const BACK: f64 = 0.15;
/// Share of a leg's length that is used uphill with both feet down, and the rise from which on it is: 14 degrees. With 0.998 knees come to be
/// locked, where nothing moves the body along its legs.
const STRAIGHT: f64 = 0.993;
const STEEP: f64 = 0.25;
/// rad by which the trunk leans for each share of the leg by which the pelvis is held lower.
const CROUCHES: f64 = 2.0;
/// s at legs of 0.83 m, time constant of the lean: on waves of 2 m it follows the hill, not the wave.
const FOLLOWS: f64 = 0.3;
/// Share of its trunk's lean that the head is turned back by, to look ahead: within what necks do at 25 degrees.
const LOOKS: f64 = 0.8;

/// m/m, the rise of ground with that unit normal for who faces `heading` (rad), at most 1; 0 downhill.
pub fn rise(normal: glam::DVec3, heading: f64) -> f64 {
    (-flat(normal).dot(DVec2::new(real::sin(heading), real::cos(heading))) / normal.y.max(0.1)).clamp(0.0, 1.0)
}

/// rad about x, by which the trunk of who stands leans.
pub fn lean(rise: f64) -> f64 {
    LEANS_IN[0] * leaned_for(rise)
}

/// Share of the sole's length by which balance is held nearer to the heels than on level ground; not on a platform, where ankles go further.
pub fn back(terrain: &Terrain, rise: f64) -> f64 {
    if terrain.moves() { 0.0 } else { BACK * rise.min(STEEPEST) }
}

/// m/m: the rise that the trunk leans for.
fn leaned_for(rise: f64) -> f64 {
    rise.min(STEEPEST) - EASES * (rise - STEEPEST).max(0.0)
}

/// Share of its length that a leg uses with both feet down that would use `used` on level ground.
pub fn straightened(used: f64, rise: f64) -> f64 {
    used + (STRAIGHT - used).max(0.0) * (rise / STEEP).min(1.0)
}

/// rad about x, by which the trunk leans of a body of which the pelvis is held that much lower, m, on that ground; `goes`: and that takes steps.
pub fn lowered(figure: &Figure, terrain: &Terrain, by: f64, goes: bool) -> f64 {
    let least = CROUCHES * by / figure.leg_length;
    if terrain.is_flat() { crouch::lean(figure, by, goes).max(least) } else { least }
}

impl Controller {
    /// The rise of the ground under the pelvis where it faces.
    pub(super) fn faces_up(&self, terrain: &Terrain) -> f64 {
        rise(terrain.spot(flat(self.states[0].origin)).normal, self.heading)
    }

    /// Lets the trunk lean as the ground rises and as the pelvis is held low, so that it stays over the feet; `dt` s after the last time.
    pub(super) fn bow(&mut self, figure: &Figure, terrain: &Terrain, dt: f64) {
        let share = (dt / (FOLLOWS * self.tempo())).min(1.0);
        let goes = self.guide.is_some_and(|guide| guide.velocity != DVec2::ZERO);
        self.uphill += (LEANS_IN[usize::from(goes)] * leaned_for(self.faces_up(terrain))
            + self.guide.map_or(0.0, |guide| guide.lean)
            - self.uphill)
            * share;
        self.leans = self.uphill + lowered(figure, terrain, self.lower, self.goes);
    }

    /// The trunk's lean as a turn.
    pub(super) fn bowed(&self) -> DQuat {
        if self.leans == 0.0 { DQuat::IDENTITY } else { DQuat::from_rotation_x(self.leans) }
    }

    /// rad about x, by which a link is turned back against the trunk's lean: the head looks ahead, arms hang.
    pub(super) fn hangs(&self, link: &Link) -> f64 {
        match link.part {
            Part::Head => -LOOKS * self.leans,
            Part::UpperArm(_) => -self.leans,
            _ => 0.0,
        }
    }
}
