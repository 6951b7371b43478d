//! Contact forces under the soles: those inside their friction cones that come nearest to the wanted accelerations.
//!
//! A quadratic programme with non-negative unknowns (four edges of the friction cone at each corner), by coordinate descent
//! from the last tick's answer. Scenario space, SI. The unknowns are shares of the body's weight.

use super::dynamics::Wrench;
use super::linear::Factored;
use glam::DVec3;

/// Edges of a friction pyramid.
const EDGES: usize = 4;
/// Sweeps over all unknowns.
const SWEEPS: usize = 1000;

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
    keys: Vec<(usize, usize)>,
}

impl Forces {
    /// The wrench about `com` that the corners can give and that serves best; `base` takes a wrench less `bias` to the
    /// pelvis's acceleration. `ids` name corners from tick to tick.
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
        let keys: Vec<(usize, usize)> = corners.iter().flat_map(|(id, _)| (0..EDGES).map(|edge| (*id, edge))).collect();
        let shares: Vec<f64> = keys
            .iter()
            .map(|key| self.keys.iter().position(|old| old == key).map_or(0.0, |at| self.shares[at]))
            .collect();
        self.keys = keys;
        self.shares = shares;
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
        let mut residual = [0.0; 6];
        for axis in 0..3 {
            let gravity = if axis == 1 { -crate::maths::pendulum::GRAVITY } else { 0.0 };
            residual[axis] = scale[axis] * (gravity - wanted.linear[axis]);
            residual[3 + axis] = scale[3 + axis] * (offset[3 + axis] - wanted.angular[axis]);
        }
        for (column, share) in self.columns.iter().zip(&self.shares) {
            add(&mut residual, column, *share);
        }
        for _ in 0..SWEEPS {
            let mut moved = 0.0_f64;
            for index in 0..self.shares.len() {
                let cost = ridge * corners[index / EDGES].1.dear;
                let column = &self.columns[index];
                let slope: f64 = dot(column, &residual) + cost * self.shares[index];
                let curve = dot(column, column) + cost;
                let least = corners[index / EDGES].1.least / EDGES as f64;
                let next = (self.shares[index] - slope / curve).max(least);
                let change = next - self.shares[index];
                if change != 0.0 {
                    add(&mut residual, &self.columns[index], change);
                    self.shares[index] = next;
                    moved = moved.max(change.abs());
                }
            }
            if moved < 1e-5 {
                break;
            }
        }
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (index, (edge, share)) in self.edges.iter().zip(&self.shares).enumerate() {
            force += *edge * *share;
            moment += (corners[index / EDGES].1.at - com).cross(*edge * *share);
        }
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }

    /// Force and moment about `about` of one foot's corners.
    pub fn on_foot(&self, corners: &[(usize, Corner)], foot: usize, about: DVec3) -> (DVec3, DVec3) {
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (index, (edge, share)) in self.edges.iter().zip(&self.shares).enumerate() {
            let corner = corners[index / EDGES].1;
            if corner.foot == foot {
                force += *edge * *share;
                moment += (corner.at - about).cross(*edge * *share);
            }
        }
        (force, moment)
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64; 6], column: &[f64; 6], share: f64) {
    for (to, column) in to.iter_mut().zip(column) {
        *to += column * share;
    }
}
