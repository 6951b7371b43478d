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

    /// kg, the mean of what is held over that time; `None` where that is no time.
    pub fn mean_mass(&self, start: f64, end: f64) -> Option<f64> {
        let inside = self.mass.iter().map(|point| point[0]).filter(|at| (start..=end).contains(at));
        let mut times: Vec<f64> = [start].into_iter().chain(inside).chain([end]).collect();
        times.sort_by(f64::total_cmp);
        let whole: f64 = times
            .windows(2)
            .map(|pair| 0.5 * (along(&self.mass, pair[0]) + along(&self.mass, pair[1])) * (pair[1] - pair[0]))
            .sum();
        (end > start).then(|| whole / (end - start))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_follows_its_lines_and_is_nothing_outside_of_its_span() {
        let mass = vec![[1.0, 2.0], [3.0, 10.0]];
        let load =
            Load { joint: 0, centre: DVec3::ZERO, level: DQuat::IDENTITY, size: DVec3::ONE, mass, span: [0.5, 4.0] };
        for (time, kg) in [(0.4, 0.0), (0.5, 2.0), (2.0, 6.0), (3.0, 10.0), (4.0, 10.0), (4.1, 0.0)] {
            assert!((load.mass_at(time) - kg).abs() < 1e-12, "{time}: {}", load.mass_at(time));
        }
        assert_eq!(along(&[], 1.0), 0.0);
    }

    #[test]
    fn a_long_box_is_hard_to_turn_across_its_length_however_it_is_held() {
        let load = Load {
            joint: 0,
            centre: DVec3::ZERO,
            level: DQuat::IDENTITY,
            size: DVec3::new(1.2, 0.1, 0.1),
            mass: vec![[0.0, 12.0]],
            span: [0.0, 1.0],
        };
        let straight = load.inertia(12.0, DQuat::IDENTITY);
        assert!((straight.x_axis.x - 0.02).abs() < 1e-12 && (straight.y_axis.y - 1.45).abs() < 1e-12, "{straight}");
        let turned = load.inertia(12.0, DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2));
        assert!((turned.z_axis.z - 0.02).abs() < 1e-12 && (turned.x_axis.x - 1.45).abs() < 1e-12, "{turned}");
    }
}
