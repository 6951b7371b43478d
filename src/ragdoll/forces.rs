//! Contact forces under the soles: those inside their friction cones that come nearest to the wanted accelerations.
//!
//! A quadratic programme with bounded unknowns (four or eight edges of the friction cone at each corner), solved exactly. Scenario space, SI. The
//! unknowns are shares of the body's weight.

use super::dynamics::Wrench;
use super::linear::{Factored, Matrix6};
use glam::{DVec3, Vec3Swizzles};

/// Edges of a friction pyramid, on ground that hardly leans and on other: between two of four it holds 0.71 of the cone, of eight 0.92.
const EDGES: [usize; 2] = [4, 8];
/// Share of what friction holds that the ground may rise, metres a metre, and hardly lean: 21 degrees with a friction of 1.
const HARDLY: f64 = 0.4;
/// Least and greatest friction coefficient that the law reckons with. On ice one that keeps within what there is lets the trunk go where a force
/// would slide: of 72 drawn walks on 0.1, half of them shoved, 45 fall; with 0.3 none does, of 20 others 2. What the ground has not got slides.
const FRICTIONS: [f64; 2] = [0.3, 0.95];
/// Newton's steps at most, and what is left of the slope where it is found, of the largest it can be.
const STEPS: usize = 40;
const FOUND: f64 = 1e-12;
/// Looks at most for where a step that goes too far is to end, and the share of the slope along it at its beginning that may be left.
const LOOKS: usize = 12;
const LEFT: f64 = 0.1;

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
    unknowns: Vec<Unknown>,
    edges: Vec<DVec3>,
    owners: Vec<usize>, // the corner of each edge
    lack: [f64; 6],
}

/// The share of the weight that is borne along an edge of a corner's friction pyramid.
#[derive(Clone, Copy, Debug)]
struct Unknown {
    /// What a share of 1 does, weighted as it counts.
    column: [f64; 6],
    /// 1 over what a share costs.
    cheap: f64,
    least: f64,
}

/// What a corner's forces lie within.
struct Pyramid {
    /// N, of a share of 1: off the ground, and across that to the edges.
    along: DVec3,
    across: [DVec3; 2],
    /// How many edges.
    count: usize,
    /// Share of what the corner bears at least that is borne by the edge up the slope, so that it is upright and not off the ground.
    upright: f64,
}

/// The friction pyramid of a corner. Where the ground leans much, all the friction that there is may be asked for, and the first edge goes down
/// the slope.
fn pyramid(corner: &Corner, friction: f64, weight: f64) -> Pyramid {
    let [least, most] = FRICTIONS;
    let usual = friction.clamp(least, most);
    let rise = corner.normal.xz().length() / corner.normal.y;
    let (count, friction, upright, across) = if rise > HARDLY * usual {
        let friction = friction.max(least);
        let down = (corner.normal * corner.normal.y - DVec3::Y).normalize();
        (EDGES[1], friction, (rise / friction).min(1.0), (down, corner.normal.cross(down)))
    } else {
        (EDGES[0], usual, 0.0, corner.normal.any_orthonormal_pair())
    };
    let across = [across.0, across.1].map(|across| across * (friction * weight));
    Pyramid { along: corner.normal * weight, across, count, upright }
}

impl Forces {
    /// The wrench about `com` that the corners can give, where the ground hardly leans as if with a friction within [`FRICTIONS`], and that serves
    /// best; `base` takes a wrench less `bias` to the pelvis's acceleration. Corners are named from tick to tick.
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
        self.unknowns.clear();
        self.edges.clear();
        self.owners.clear();
        // The pelvis's angular acceleration as a linear function of the wrench: the last three rows of what `base` undoes.
        let offset = base.solve(&bias.map(|value| -value));
        let undone: Matrix6 = std::array::from_fn(|column| {
            let mut unit = [0.0; 6];
            unit[column] = 1.0;
            base.solve(&unit)
        });
        let effect = |force: DVec3, arm: DVec3| {
            let moment = arm.cross(force);
            let mut effect = [0.0; 6];
            for (way, column) in force.to_array().into_iter().chain(moment.to_array()).zip(&undone) {
                for axis in 3..6 {
                    effect[axis] += column[axis] * way;
                }
            }
            (0..3).for_each(|axis| effect[axis] = force[axis] / mass);
            effect.iter_mut().zip(scale).for_each(|(effect, scale)| *effect *= scale);
            effect
        };
        for (index, (_, corner)) in corners.iter().enumerate() {
            let Pyramid { along, across: [a, b], count, upright } = pyramid(corner, friction, weight);
            let [normal, first, second] = [along, a, b].map(|force| effect(force, corner.at - com));
            let cheap = 1.0 / (ridge * corner.dear);
            for edge in 0..count {
                let up_the_slope = if edge == count / 2 { upright } else { 0.0 };
                let least = corner.least * ((1.0 - upright) / count as f64 + up_the_slope);
                let [x, y] = DIRECTIONS[edge * (EDGES[1] / count)];
                let column = std::array::from_fn(|axis| normal[axis] + x * first[axis] + y * second[axis]);
                self.unknowns.push(Unknown { column, cheap, least });
                self.edges.push(along + a * x + b * y);
                self.owners.push(index);
            }
        }
        let mut target = [0.0; 6];
        for axis in 0..3 {
            let gravity = if axis == 1 { -crate::maths::pendulum::GRAVITY } else { 0.0 };
            target[axis] = scale[axis] * (wanted.linear[axis] - gravity);
            target[3 + axis] = scale[3 + axis] * (wanted.angular[axis] - offset[3 + axis]);
        }
        self.lack = shares(&self.unknowns, &target, self.lack, &mut self.shares);
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (index, (edge, share)) in self.edges.iter().zip(&self.shares).enumerate() {
            force += *edge * *share;
            moment += (corners[self.owners[index]].1.at - com).cross(*edge * *share);
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
            let (name, corner) = corners[self.owners[index]];
            if which(name, &corner) {
                force += *edge * *share;
                moment += (corner.at - about).cross(*edge * *share);
            }
        }
        (force, moment)
    }
}

/// Along the first axis and along the second.
const DIRECTIONS: [[f64; 2]; 8] = {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    [[1.0, 0.0], [half, half], [0.0, 1.0], [-half, half], [-1.0, 0.0], [-half, -half], [0.0, -1.0], [half, -half]]
};

/// The shares x that make |A x - b|² + Σ cᵢ xᵢ² least with xᵢ ≥ lᵢ, A by columns; returns b - A x, to begin with the next time.
///
/// With y = b - A x what is lacking, each share is max(lᵢ, aᵢ·y / cᵢ), so that y alone is unknown: the least of the convex
/// ½|y|² - b·y + Σ hᵢ(aᵢ·y), hᵢ' = max(lᵢ, ·/cᵢ), which Newton's steps with a line search reach in a few (a system of six each): exact
/// once the set of loaded edges is.
fn shares(unknowns: &[Unknown], target: &[f64; 6], begin: [f64; 6], shares: &mut Vec<f64>) -> [f64; 6] {
    let mut lack = if begin.iter().all(|value| value.is_finite()) { begin } else { [0.0; 6] };
    // The slope of the convex function: lack + A x(lack) - b.
    let slope = |lack: &[f64; 6]| {
        let mut slope = *lack;
        add(&mut slope, target, -1.0);
        unknowns.iter().for_each(|unknown| add(&mut slope, &unknown.column, unknown.share(lack)));
        slope
    };
    let enough = FOUND * (1.0 + dot(target, target));
    let mut down = slope(&lack);
    for _ in 0..STEPS {
        if dot(&down, &down) <= enough * enough {
            break;
        }
        let way = Factored::new(curve(unknowns, &lack), 1e-12).solve(&down.map(|value| -value));
        // The slope along the way only rises: where it is 0 lies between a step that is too short and one that is too long.
        let falls = dot(&down, &way);
        let (mut short, mut long, mut step) = ((0.0, falls), (1.0, f64::NAN), 1.0);
        for look in 0..LOOKS {
            if look > 0 {
                let share = -short.1 / (long.1 - short.1);
                step = short.0 + (long.0 - short.0) * share.clamp(0.1, 0.9);
            }
            let mut at = lack;
            add(&mut at, &way, step);
            down = slope(&at);
            let along = dot(&down, &way);
            if along.abs() <= LEFT * falls.abs() || (look == 0 && along <= 0.0) {
                break;
            }
            *(if along > 0.0 { &mut long } else { &mut short }) = (step, along);
        }
        add(&mut lack, &way, step);
    }
    shares.clear();
    shares.extend(unknowns.iter().map(|unknown| unknown.share(&lack)));
    lack
}

/// How the slope of the convex function changes.
fn curve(unknowns: &[Unknown], lack: &[f64; 6]) -> Matrix6 {
    let mut curve: Matrix6 = [[0.0; 6]; 6];
    curve.iter_mut().enumerate().for_each(|(axis, row)| row[axis] = 1.0);
    for Unknown { column, cheap, least } in unknowns {
        if dot(column, lack) * cheap > *least {
            for (row, value) in curve.iter_mut().zip(column) {
                add(row, column, value * cheap);
            }
        }
    }
    curve
}

impl Unknown {
    /// The share that goes with what is lacking.
    fn share(&self, lack: &[f64; 6]) -> f64 {
        (dot(&self.column, lack) * self.cheap).max(self.least)
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    // Two sums, for one number must wait for the one before.
    (a[0] * b[0] + a[2] * b[2] + a[4] * b[4]) + (a[1] * b[1] + a[3] * b[3] + a[5] * b[5])
}

fn add(to: &mut [f64; 6], column: &[f64; 6], share: f64) {
    for axis in 0..6 {
        to[axis] += column[axis] * share;
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
            let unknowns = columns.iter().zip(cost.iter().zip(&least));
            let unknowns =
                unknowns.map(|(column, (cost, least))| Unknown { column: *column, cheap: 1.0 / cost, least: *least });
            shares(&unknowns.collect::<Vec<_>>(), &target, begin, &mut found);
            // Sweeps creep up to the least; it is never under it.
            assert!(objective(&found) <= objective(&wanted) + 1e-12, "{round}");
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 2e-3, "{round}: {found} not {wanted}");
            }
        }
    }
}
