//! A box in both hands as mechanics sees it: a rigid mass that moves with the trunk. Scenario space, SI units.

use super::pose::BodyPose;
use glam::{DMat3, DQuat, DVec3};

/// A carried box over a whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Index of the joint that it moves with (the uppermost of the spine).
    pub joint: usize,
    /// m, from the joint to the box's centre, at rest.
    pub centre: DVec3,
    /// What the joint's turn is multiplied with to turn the box: its edges along X, Y, Z.
    pub level: DQuat,
    /// m: across, up, forward.
    pub size: DVec3,
    /// (s, kg), straight lines between; what the character holds of it, so that it rises and falls as the box is taken up
    /// and put down.
    pub mass: Vec<[f64; 2]>,
    /// s, from when to when the box is there.
    pub span: [f64; 2],
}

impl Load {
    /// kg at a time; nothing outside of its span.
    pub fn mass_at(&self, time: f64) -> f64 {
        let there = time >= self.span[0] && time <= self.span[1];
        if there { along(&self.mass, time) } else { 0.0 }
    }

    /// m, its centre in a pose.
    pub fn centre_in(&self, pose: &BodyPose, positions: &[DVec3]) -> DVec3 {
        positions[self.joint] + pose.turns[self.joint] * self.centre
    }

    /// kg m², about its centre, scenario axes, at a mass and a turn of its joint.
    pub fn inertia(&self, mass: f64, turn: DQuat) -> DMat3 {
        let square = self.size * self.size;
        let axes = DVec3::new(square.y + square.z, square.x + square.z, square.x + square.y) * (mass / 12.0);
        let turn = DMat3::from_quat(turn * self.level);
        turn * DMat3::from_diagonal(axes) * turn.transpose()
    }
}

/// A curve of straight lines, constant beyond its ends; 0 without points.
pub fn along(points: &[[f64; 2]], time: f64) -> f64 {
    let next = points.partition_point(|[at, _]| *at <= time);
    match (next.checked_sub(1).map(|before| points[before]), points.get(next)) {
        (Some([from, low]), Some([to, high])) => low + (high - low) * ((time - from) / (to - from)),
        (Some([_, only]), None) => only,
        (None, Some([_, only])) => *only,
        (None, None) => 0.0,
    }
}
