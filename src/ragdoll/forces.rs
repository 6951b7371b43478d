//! Contact forces under the soles: those inside their friction cones that come nearest to the wanted accelerations.
//!
//! A quadratic programme with bounded unknowns (four edges of the friction cone at each corner), solved exactly. Scenario space, SI. The
//! unknowns are shares of the body's weight.

use super::dynamics::Wrench;
use super::linear::{Factored, Matrix6};
use glam::DVec3;

/// Edges of a friction pyramid.
const EDGES: usize = 4;
/// Newton's steps at most, and what is left of the slope where it is found, of the largest it can be.
const STEPS: usize = 40;
const FOUND: f64 = 1e-12;
/// Halvings of a step that goes too far.
const BISECTIONS: usize = 12;

/// A corner that may bear.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// m.
    pub at: DVec3,
    /// Out of the ground.
    pub normal: DVec3,
    /// Which foot.
    pub foot: usize,
    /// How dear it is to load it: 1 as usual.
    pub dear: f64,
    /// Share of the weight that it bears at least.
    pub least: f64,
}

/// What is wanted of the forces.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// m/s², of the centre of mass.
    pub linear: DVec3,
    /// rad/s², of the pelvis.
    pub angular: DVec3,
    /// What a metre per second squared counts (sideways and up), and a radian per second squared (level axes and yaw).
    pub weights: [f64; 4],
}

/// The least-squares problem's memory.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    shares: Vec<f64>,
    columns: Vec<[f64; 6]>,
    edges: Vec<DVec3>,
    lack: [f64; 6],
}

impl Forces {
    /// The wrench about `com` that the corners can give and that serves best; `base` takes a wrench less `bias` to the
    /// pelvis's acceleration. Corners are named from tick to tick.
    #[expect(clippy::too_many_arguments, reason = "one problem, all of it")]
    pub fn solve(
        &mut self,
        corners: &[(usize, Corner)],
        com: DVec3,
        mass: f64,
        friction: f64,
        base: &Factored,
        bias: &Wrench,
        wanted: &Wanted,
        ridge: f64,
    ) -> Wrench {
        let weight = mass * crate::maths::pendulum::GRAVITY;
        let [side, up, level, yaw] = wanted.weights;
        let scale = [side, up, side, level, yaw, level];
        self.columns.clear();
        self.edges.clear();
        // The pelvis's angular acceleration as a linear function of the wrench: three columns of what `base` undoes.
        let offset = base.solve(&bias.map(|value| -value));
        for (_, corner) in corners {
            let (a, b) = corner.normal.any_orthonormal_pair();
            for (p, q) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
                let force = (corner.normal + (a * p + b * q) * friction) * weight;
                let moment = (corner.at - com).cross(force);
                let answer = base.solve(&[force.x, force.y, force.z, moment.x, moment.y, moment.z]);
                let mut column = [0.0; 6];
                for axis in 0..3 {
                    column[axis] = scale[axis] * force[axis] / mass;
                    column[3 + axis] = scale[3 + axis] * answer[3 + axis];
                }
                self.columns.push(column);
                self.edges.push(force);
            }
        }
        let mut target = [0.0; 6];
        for axis in 0..3 {
            let gravity = if axis == 1 { -crate::maths::pendulum::GRAVITY } else { 0.0 };
            target[axis] = scale[axis] * (wanted.linear[axis] - gravity);
            target[3 + axis] = scale[3 + axis] * (wanted.angular[axis] - offset[3 + axis]);
        }
        let cost = |index: usize| ridge * corners[index / EDGES].1.dear;
        let least = |index: usize| corners[index / EDGES].1.least / EDGES as f64;
        self.lack = shares(&self.columns, &target, (&cost, &least), self.lack, &mut self.shares);
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (index, (edge, share)) in self.edges.iter().zip(&self.shares).enumerate() {
            force += *edge * *share;
            moment += (corners[index / EDGES].1.at - com).cross(*edge * *share);
        }
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }

    /// Force and moment about `about` of one foot's corners.
    pub fn on_foot(&self, corners: &[(usize, Corner)], foot: usize, about: DVec3) -> (DVec3, DVec3) {
        self.on(corners, &|_, corner| corner.foot == foot, about)
    }

    /// Force and moment about `about` of some corners.
    pub fn on(
        &self,
        corners: &[(usize, Corner)],
        which: &dyn Fn(usize, &Corner) -> bool,
        about: DVec3,
    ) -> (DVec3, DVec3) {
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (index, (edge, share)) in self.edges.iter().zip(&self.shares).enumerate() {
            let (name, corner) = corners[index / EDGES];
            if which(name, &corner) {
                force += *edge * *share;
                moment += (corner.at - about).cross(*edge * *share);
            }
        }
        (force, moment)
    }
}

/// The shares x that make |A x - b|² + Σ cᵢ xᵢ² least with xᵢ ≥ lᵢ, A by columns; returns b - A x, to begin with the next time.
///
/// With y = b - A x what is lacking, each share is max(lᵢ, aᵢ·y / cᵢ), so that y alone is unknown: the least of the convex
/// ½|y|² - b·y + Σ hᵢ(aᵢ·y), hᵢ' = max(lᵢ, ·/cᵢ), which Newton's steps with a line search reach in a few (a system of six each): exact
/// once the set of loaded edges is.
fn shares(
    columns: &[[f64; 6]],
    target: &[f64; 6],
    (cost, least): (&dyn Fn(usize) -> f64, &dyn Fn(usize) -> f64),
    begin: [f64; 6],
    shares: &mut Vec<f64>,
) -> [f64; 6] {
    let mut lack = if begin.iter().all(|value| value.is_finite()) { begin } else { [0.0; 6] };
    let share = |index: usize, lack: &[f64; 6]| (dot(&columns[index], lack) / cost(index)).max(least(index));
    // The slope of the convex function: lack + A x(lack) - b.
    let slope = |lack: &[f64; 6]| {
        let mut slope = *lack;
        add(&mut slope, target, -1.0);
        (0..columns.len()).for_each(|index| add(&mut slope, &columns[index], share(index, lack)));
        slope
    };
    let enough = FOUND * (1.0 + dot(target, target));
    for _ in 0..STEPS {
        let down = slope(&lack);
        if dot(&down, &down) <= enough * enough {
            break;
        }
        let mut curve: Matrix6 = [[0.0; 6]; 6];
        curve.iter_mut().enumerate().for_each(|(axis, row)| row[axis] = 1.0);
        for (index, column) in columns.iter().enumerate() {
            if dot(column, &lack) / cost(index) > least(index) {
                for (row, value) in curve.iter_mut().zip(column) {
                    add(row, column, value / cost(index));
                }
            }
        }
        let way = Factored::new(curve, 1e-12).solve(&down.map(|value| -value));
        // The slope along the way only rises: where it is 0 lies between a step that is too short and one that is too long.
        let along = |step: f64| {
            let mut at = lack;
            add(&mut at, &way, step);
            dot(&slope(&at), &way)
        };
        let mut step = 1.0;
        if along(step) > 0.0 {
            let (mut short, mut long) = (0.0, 1.0);
            for _ in 0..BISECTIONS {
                step = 0.5 * (short + long);
                if along(step) > 0.0 { long = step } else { short = step }
            }
        }
        add(&mut lack, &way, step);
    }
    shares.clear();
    shares.extend((0..columns.len()).map(|index| share(index, &lack)));
    lack
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64; 6], column: &[f64; 6], share: f64) {
    for (to, column) in to.iter_mut().zip(column) {
        *to += column * share;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::seed::Seed;

    /// By coordinate descent until nothing moves: slow and sure.
    fn swept(columns: &[[f64; 6]], target: &[f64; 6], cost: &[f64], least: &[f64]) -> Vec<f64> {
        let mut shares = vec![0.0; columns.len()];
        let mut residual = target.map(|value| -value);
        for _ in 0..200_000 {
            let mut moved = 0.0_f64;
            for index in 0..columns.len() {
                let slope = dot(&columns[index], &residual) + cost[index] * shares[index];
                let next =
                    (shares[index] - slope / (dot(&columns[index], &columns[index]) + cost[index])).max(least[index]);
                moved = moved.max((next - shares[index]).abs());
                add(&mut residual, &columns[index], next - shares[index]);
                shares[index] = next;
            }
            if moved < 1e-13 {
                break;
            }
        }
        shares
    }

    #[test]
    fn the_shares_are_those_that_endless_sweeps_creep_up_to() {
        let mut draw = Seed::new(11);
        for round in 0..60 {
            let count = 4 + 4 * (round % 8);
            let mut one = |most: f64| draw.between(-most, most);
            let columns: Vec<[f64; 6]> =
                (0..count).map(|_| [one(5.0), 9.8 + one(0.1), one(5.0), one(20.0), one(8.0), one(20.0)]).collect();
            let target = [one(3.0), 9.8 + one(3.0), one(3.0), one(30.0), one(10.0), one(30.0)];
            let cost: Vec<f64> = (0..count).map(|index| if index % 5 == 4 { 0.6 } else { 0.02 }).collect();
            let least: Vec<f64> =
                (0..count).map(|index| if round % 3 == 0 && index < 4 { 0.004 } else { 0.0 }).collect();
            let wanted = swept(&columns, &target, &cost, &least);
            let mut found = Vec::new();
            let objective = |x: &[f64]| {
                let mut left = target.map(|v| -v);
                x.iter().enumerate().for_each(|(i, x)| add(&mut left, &columns[i], *x));
                dot(&left, &left) + x.iter().zip(&cost).map(|(x, c)| c * x * x).sum::<f64>()
            };
            let begin = if round % 2 == 0 { [0.0; 6] } else { [30.0, -50.0, 20.0, 5.0, -80.0, 7.0] };
            shares(&columns, &target, (&|index| cost[index], &|index| least[index]), begin, &mut found);
            // Sweeps creep up to the least; it is never under it.
            assert!(objective(&found) <= objective(&wanted) + 1e-12, "{round}");
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 2e-3, "{round}: {found} not {wanted}");
            }
        }
    }
}
