//! The ends of the joints' ranges as rows: a hinge's angle; a ball joint's swing about two axes, and its twist (Grassia 1998: a rotation is
//! a twist about the bone and then a swing of it).

use super::axes::Axes;
use super::rows::{Asked, Kind};
use super::state::Articulation;
use super::tree::DEEPEST;
use crate::maths::real;
use glam::{DQuat, DVec3};

/// rad before its end from which on a range is looked after.
const NEAR: f64 = 0.3;
/// Share of what it is past its end that a step takes back, and rad/s at most.
const BACK: f64 = 0.15;
const BACK_AT_MOST: f64 = 3.0;
/// Names of limits, apart from those of contacts.
const KEYS: u32 = 1 << 30;

/// How far a joint goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Range {
    /// Everywhere.
    #[default]
    Free,
    /// rad, least and most angle of a hinge.
    Hinge([f64; 2]),
    /// Of a ball joint.
    Ball(Swing),
    /// Of a ball joint whose angles are read about axes of its own.
    Axes(Axes),
}

/// The range of a ball joint from its rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// The bone at rest, a unit vector in the parent's frame.
    pub along: DVec3,
    /// Two axes that it swings about, unit vectors in the parent's frame, square to it and to each other.
    pub about: [DVec3; 2],
    /// rad, least (at most 0) and most (at least 0) about each of the two.
    pub swing: [[f64; 2]; 2],
    /// rad, least and most about the bone.
    pub twist: [f64; 2],
}

/// One end of a range: how far it still is (rad; under 0 past it), and about which axis (parent's frame) a turn leads away from it.
pub(super) type End = (f64, DVec3);

impl Swing {
    /// The low and the high end of the swing about both axes and of the twist.
    fn ends(&self, relative: DQuat) -> [Option<End>; 6] {
        let relative = if relative.w < 0.0 { -relative } else { relative };
        let bone = relative * self.along;
        let cosine = self.along.dot(bone).clamp(-1.0, 1.0);
        let axis = self.along.cross(bone).normalize_or_zero() * real::acos(cosine);
        let mut ends = [None; 6];
        for (way, (about, [low, high])) in self.about.into_iter().zip(self.swing).enumerate() {
            let swung = axis.dot(about);
            ends[2 * way] = Some((swung - low, about));
            ends[2 * way + 1] = Some((high - swung, -about));
        }
        if cosine > -0.99 {
            let twist = 2.0 * real::atan2(DVec3::new(relative.x, relative.y, relative.z).dot(self.along), relative.w);
            let about = (self.along + bone) / (1.0 + cosine);
            ends[4] = Some((twist - self.twist[0], about));
            ends[5] = Some((self.twist[1] - twist, -about));
        }
        ends
    }
}

impl Articulation {
    /// Adds a row for each end that a joint is near to; `free`: the speeds if nothing held it back, over `dt` s.
    pub(super) fn add_limits(&mut self, free: &super::factor::Vector, dt: f64) {
        for index in 1..self.tree.links.len() {
            let ends = match self.tree.links[index].range {
                Range::Free => continue,
                Range::Hinge([low, high]) => {
                    let angle = self.angle[index];
                    [Some((angle - low, DVec3::X)), Some((high - angle, DVec3::NEG_X)), None, None, None, None]
                }
                Range::Ball(swing) => swing.ends(self.relative[index]),
                Range::Axes(axes) => axes.ends(self.relative[index]),
            };
            let hinged = matches!(self.tree.links[index].range, Range::Hinge(_));
            for (which, end) in ends.into_iter().enumerate() {
                let Some((left, away)) = end.filter(|(left, _)| *left < NEAR) else { continue };
                let (first, last) = (self.tree.first[index], self.tree.last[index]);
                let mut near = [[0.0]; DEEPEST];
                let mut goes = 0.0;
                // A ball joint's freedoms turn about the parent's axes; a hinge's about its own.
                for (way, freedom) in (first..=last).enumerate() {
                    let value = if hinged { away.x } else { away[way] };
                    near[self.tree.depth[freedom]] = [value];
                    goes += value * free[freedom];
                }
                let target = if left > 0.0 { -left / dt } else { (-left * BACK / dt).min(BACK_AT_MOST) };
                let key = KEYS + 8 * index as u32 + which as u32;
                let asked = Asked { key, near, last, far: None, wanted: [target - goes] };
                self.rows.add((&self.tree, &self.factors), Kind::Stop, &asked);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hip() -> Swing {
        Swing {
            along: DVec3::NEG_Y,
            about: [DVec3::X, DVec3::Z],
            swing: [[-2.0, 0.5], [-0.5, 0.7]],
            twist: [-0.6, 0.6],
        }
    }

    #[test]
    fn each_end_of_a_swing_is_as_far_as_it_says() {
        for (axis, end) in [(DVec3::X, 0.5), (DVec3::NEG_X, 2.0), (DVec3::Z, 0.7), (DVec3::NEG_Z, 0.5)] {
            for share in [0.8, 0.9, 1.1] {
                let ends = hip().ends(DQuat::from_axis_angle(axis, end * share));
                let (left, away) = ends[..4]
                    .iter()
                    .flatten()
                    .copied()
                    .fold((9.0, DVec3::ZERO), |near, next| if next.0 < near.0 { next } else { near });
                assert!((left - end * (1.0 - share)).abs() < 1e-9, "{axis} {share}: {left}");
                assert!(away.distance(-axis) < 1e-9, "{axis}: back by {away}");
            }
        }
    }

    #[test]
    fn a_twist_is_seen_apart_from_the_swing_before_and_behind() {
        for (swung, twisted) in [(0.0, 0.4), (-1.2, 0.4), (-1.2, -0.5)] {
            let turn = DQuat::from_rotation_x(swung) * DQuat::from_axis_angle(DVec3::NEG_Y, twisted);
            let [.., low, high] = hip().ends(turn);
            assert!((low.expect("low").0 - (twisted + 0.6)).abs() < 1e-9);
            assert!((high.expect("high").0 - (0.6 - twisted)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_small_turn_about_the_axis_that_leads_away_leads_away_by_as_much() {
        let turn =
            DQuat::from_rotation_x(-1.4) * DQuat::from_rotation_z(0.3) * DQuat::from_axis_angle(DVec3::NEG_Y, 0.5);
        for which in 4..6 {
            let (left, away) = hip().ends(turn)[which].expect("an end");
            let step = 1e-5;
            let (then, _) = hip().ends(DQuat::from_scaled_axis(away.normalize() * step) * turn)[which].expect("an end");
            assert!(((then - left) / step - away.length()).abs() < 1e-3, "{which}");
        }
    }
}
