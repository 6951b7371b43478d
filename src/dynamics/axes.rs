//! The ends of a ball joint's range where its angles are read about axes of its own, as those of hips and ankles are. Radians.

use super::limits::End;
use crate::maths::real;
use glam::{DQuat, DVec3};

/// Least cosine of the angle about z with which turns about x and y are told apart: at a right angle they are the same.
const APART: f64 = 0.2;

/// How the three angles are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Of turns about x, then z, then y (Cardan's angles).
    Turns,
    /// Of a swing of the y axis after a twist about it, about x and z as they go with the twist, and the twist.
    Swing,
}

/// The range of a ball joint: its turn R from rest has the angles of `before` R `after`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// How they are read.
    pub reading: Reading,
    /// Left of the turn.
    pub before: DQuat,
    /// Right of it.
    pub after: DQuat,
    /// rad, least and most about x, z and y.
    pub range: [[f64; 2]; 3],
}

impl Axes {
    /// The angles about x, z and y, and the turns of the parent's frame by which each grows by as much as they are long.
    pub fn angles(&self, relative: DQuat) -> [(f64, DVec3); 3] {
        let turn = self.before * relative * self.after;
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let back = self.before.inverse();
        let found = match self.reading {
            Reading::Turns => {
                let down = turn * DVec3::NEG_Y;
                let x = -real::atan2(down.z, -down.y);
                let level = real::hypot(down.y, down.z);
                let z = real::atan2(down.x, level);
                let about = DQuat::from_rotation_x(x);
                let spin = (about * DQuat::from_rotation_z(z)).inverse() * turn;
                let y = 2.0 * real::atan2(spin.y, spin.w);
                let cosine = level.max(APART);
                [(x, DVec3::new(1.0, down.x / cosine, 0.0)), (z, DVec3::Z), (wrapped(y), DVec3::Y / cosine)]
                    .map(|(angle, grows)| (angle, about * grows))
            }
            Reading::Swing => {
                let y = wrapped(2.0 * real::atan2(turn.y, turn.w));
                let twist = DQuat::from_rotation_y(y);
                let swung = (twist.inverse() * turn).to_scaled_axis();
                let up = DVec3::Y + turn * DVec3::Y;
                let grows = up / (0.5 * up.length_squared()).max(APART);
                [(swung.x, twist * DVec3::X), (swung.z, twist * DVec3::Z), (y, grows)]
            }
        };
        found.map(|(angle, grows)| (angle, back * grows))
    }

    /// The low and the high end of each.
    pub(super) fn ends(&self, relative: DQuat) -> [Option<End>; 6] {
        let mut ends = [None; 6];
        for (way, ((angle, grows), [low, high])) in self.angles(relative).into_iter().zip(self.range).enumerate() {
            ends[2 * way] = Some((angle - low, grows));
            ends[2 * way + 1] = Some((high - angle, -grows));
        }
        ends
    }
}

/// rad, from -π to π.
fn wrapped(angle: f64) -> f64 {
    crate::maths::quat::wrap_angle(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(reading: Reading) -> Axes {
        let before = DQuat::from_rotation_y(0.3) * DQuat::from_rotation_x(0.1);
        let after = DQuat::from_rotation_z(0.2) * DQuat::from_rotation_x(-0.2);
        Axes { reading, before, after, range: [[-1.0, 1.0]; 3] }
    }

    #[test]
    fn turns_about_the_three_axes_one_after_the_other_are_read_as_they_were_made() {
        let joint = axes(Reading::Turns);
        let made = DQuat::from_rotation_x(-1.2) * DQuat::from_rotation_z(0.6) * DQuat::from_rotation_y(-0.5);
        let angles = joint.angles(joint.before.inverse() * made * joint.after.inverse()).map(|(angle, _)| angle);
        for (angle, wanted) in angles.into_iter().zip([-1.2, 0.6, -0.5]) {
            assert!((angle - wanted).abs() < 1e-9, "{angles:?}");
        }
    }

    #[test]
    fn a_swing_is_read_about_the_axes_that_the_twist_has_turned() {
        let joint = axes(Reading::Swing);
        let twist = DQuat::from_rotation_y(0.4);
        let made = DQuat::from_axis_angle(twist * DVec3::X, -0.7) * twist;
        let angles = joint.angles(joint.before.inverse() * made * joint.after.inverse()).map(|(angle, _)| angle);
        for (angle, wanted) in angles.into_iter().zip([-0.7, 0.0, 0.4]) {
            assert!((angle - wanted).abs() < 1e-9, "{angles:?}");
        }
    }

    #[test]
    fn a_small_turn_makes_each_angle_grow_by_as_much_as_is_told() {
        for (reading, most) in [(Reading::Turns, 1e-4), (Reading::Swing, 0.1)] {
            let joint = axes(reading);
            let made = DQuat::from_rotation_x(-0.5) * DQuat::from_rotation_z(0.2) * DQuat::from_rotation_y(0.3);
            let relative = joint.before.inverse() * made * joint.after.inverse();
            let before = joint.angles(relative);
            for turn in [DVec3::X, DVec3::Y, DVec3::Z] {
                let after = joint.angles(DQuat::from_scaled_axis(turn * 1e-5) * relative);
                for ((was, grows), (is, _)) in before.into_iter().zip(after) {
                    let told = grows.dot(turn);
                    assert!(
                        ((is - was) / 1e-5 - told).abs() < most,
                        "{reading:?} {turn}: {told}, {}",
                        (is - was) / 1e-5
                    );
                }
            }
        }
    }
}
