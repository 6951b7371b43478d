//! A box in both hands as mechanics sees it: a rigid mass that moves with the trunk. Scenario space, SI units.

use super::pose::BodyPose;
use glam::{DMat3, DQuat, DVec3};

/// A carried box over a whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Index of the joint that it moves with (the uppermost of the spine).
    pub joint: usize,
    /// What the joint's turn is multiplied with to turn the box: its edges along X, Y, Z.
    pub level: DQuat,
    /// Its form over time, straight lines between; never none.
    pub forms: Vec<Form>,
    /// (s, kg), straight lines between; what the character holds of it, so that it rises and falls as the box is taken up
    /// and put down.
    pub mass: Vec<[f64; 2]>,
    /// s, from when to when the box is there.
    pub span: [f64; 2],
}

/// A box and how it is held at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// s.
    pub time: f64,
    /// m: across, up, forward.
    pub size: DVec3,
    /// m, from the joint to the box's centre, at rest.
    pub centre: DVec3,
    /// m, the wrists from the box's centre along its edges, left and right.
    pub wrists: [DVec3; 2],
}

impl Load {
    /// Its form at a time.
    pub fn form_at(&self, time: f64) -> Form {
        let after = self.forms.partition_point(|form| form.time <= time);
        match (after.checked_sub(1).map(|before| self.forms[before]), self.forms.get(after)) {
            (Some(one), Some(next)) => {
                let share = (time - one.time) / (next.time - one.time).max(1e-9);
                Form {
                    time,
                    size: one.size.lerp(next.size, share),
                    centre: one.centre.lerp(next.centre, share),
                    wrists: [0, 1].map(|side| one.wrists[side].lerp(next.wrists[side], share)),
                }
            }
            (Some(only), None) => only,
            (None, Some(only)) => *only,
            (None, None) => Form { time, size: DVec3::ONE, centre: DVec3::ZERO, wrists: [DVec3::ZERO; 2] },
        }
    }

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

    /// m, its centre in a pose of that time.
    pub fn centre_in(&self, pose: &BodyPose, positions: &[DVec3], time: f64) -> DVec3 {
        positions[self.joint] + pose.turns[self.joint] * self.form_at(time).centre
    }

    /// kg m², about its centre, scenario axes, at a mass and a turn of its joint and at a time.
    pub fn inertia(&self, mass: f64, turn: DQuat, time: f64) -> DMat3 {
        let size = self.form_at(time).size;
        let square = size * size;
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

    fn form(size: DVec3) -> Form {
        Form { time: 0.0, size, centre: DVec3::ZERO, wrists: [DVec3::ZERO; 2] }
    }

    #[test]
    fn a_mass_follows_its_lines_and_is_nothing_outside_of_its_span() {
        let mass = vec![[1.0, 2.0], [3.0, 10.0]];
        let load = Load { joint: 0, level: DQuat::IDENTITY, forms: vec![form(DVec3::ONE)], mass, span: [0.5, 4.0] };
        for (time, kg) in [(0.4, 0.0), (0.5, 2.0), (2.0, 6.0), (3.0, 10.0), (4.0, 10.0), (4.1, 0.0)] {
            assert!((load.mass_at(time) - kg).abs() < 1e-12, "{time}: {}", load.mass_at(time));
        }
        assert_eq!(along(&[], 1.0), 0.0);
    }

    #[test]
    fn a_long_box_is_hard_to_turn_across_its_length_however_it_is_held() {
        let load = Load {
            joint: 0,
            level: DQuat::IDENTITY,
            forms: vec![form(DVec3::new(1.2, 0.1, 0.1))],
            mass: vec![[0.0, 12.0]],
            span: [0.0, 1.0],
        };
        let straight = load.inertia(12.0, DQuat::IDENTITY, 0.0);
        assert!((straight.x_axis.x - 0.02).abs() < 1e-12 && (straight.y_axis.y - 1.45).abs() < 1e-12, "{straight}");
        let turned = load.inertia(12.0, DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2), 0.0);
        assert!((turned.z_axis.z - 0.02).abs() < 1e-12 && (turned.x_axis.x - 1.45).abs() < 1e-12, "{turned}");
    }
}
