//! The mass matrix of a tree and what bends its motion: composite rigid bodies and recursive Newton-Euler about the root's origin
//! (Featherstone 2008, ch. 5 and 6), with joint springs and dampers taken at the end of the step (Baraff and Witkin 1998).

use super::factor::Vector;
use super::state::{Articulation, GRAVITY};
use super::tree::{DEEPEST, Joint, MOST};
use glam::{DMat3, DQuat, DVec3};

/// Mass, its moment and inertia about the root's origin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Composite {
    mass: f64,
    moment: DVec3,
    inertia: DMat3,
}

/// A force and its moment about the root's origin, N and N m.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    force: DVec3,
    moment: DVec3,
}

/// All links together.
#[derive(Clone, Copy, Debug, Default)]
struct Whole {
    mass: f64,
    centre: DVec3,
    linear: DVec3,
    angular: DVec3,
    inertia: DMat3,
}

/// kg m², of a mass (kg) at a place (m) about the origin.
pub(super) fn steiner(mass: f64, at: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(at * at.x, at * at.y, at * at.z);
    (DMat3::IDENTITY * at.length_squared() - outer) * mass
}

impl Articulation {
    /// Fills and factors the matrix for a step of `dt` s; returns what each freedom's speed gains in it where nothing touches.
    /// `held`: joints whose drive is a torque (N m, one for each freedom) instead of a spring and a damper.
    pub(super) fn assemble(&mut self, dt: f64, held: &Held) -> Vector {
        let mut composites = [Composite::default(); MOST];
        let mut loads = [Load::default(); MOST];
        self.spread(&mut composites, &mut loads);
        for index in (1..self.tree.links.len()).rev() {
            let parent = self.tree.links[index].parent.unwrap_or(0);
            let (below, load) = (composites[index], loads[index]);
            let (over, carried) = (&mut composites[parent], &mut loads[parent]);
            over.mass += below.mass;
            over.moment += below.moment;
            over.inertia += below.inertia;
            carried.force += load.force;
            carried.moment += load.moment;
        }
        self.bend = self.bend_of(&composites[0], &loads[0]);
        let mut gain = [0.0; MOST];
        for index in 0..self.tree.links.len() {
            let (Composite { mass, moment, inertia }, load) = (composites[index], loads[index]);
            for freedom in self.tree.freedoms_of(index) {
                let (turn, way) = (self.turns[freedom], self.moves[freedom]);
                let force = way * mass + turn.cross(moment);
                let torque = inertia * turn + moment.cross(way);
                let depth = self.tree.depth[freedom];
                let (row, chain) = (&mut self.factors.rows[freedom], &self.tree.chain[freedom]);
                for e in 0..=depth.min(DEEPEST - 1) {
                    let over = usize::from(chain[e]);
                    row[e] = self.turns[over].dot(torque) + self.moves[over].dot(force);
                }
                let bias = turn.dot(load.moment) + way.dot(load.force);
                if held.joints & (1 << index) != 0 {
                    gain[freedom] = dt * (held.torque[freedom] - bias);
                    continue;
                }
                let drive = &self.drive;
                let soft = dt * drive.damping[freedom] + dt * dt * drive.stiffness[freedom];
                row[depth] += soft;
                gain[freedom] =
                    dt * (drive.stiffness[freedom] * drive.ahead[freedom] - bias) - soft * self.speed[freedom];
            }
        }
        self.factors.factor(&self.tree);
        self.factors.solve(&self.tree, &mut gain);
        gain
    }

    /// What the speeds alone bend: the force and its moment about the root's origin that it takes to keep them, less weight and pushes.
    fn bend_of(&self, whole: &Composite, load: &Load) -> (DVec3, DVec3) {
        let root = self.origin[0];
        let (mut force, mut moment) = (load.force, load.moment);
        for (push, turn) in &self.pushed {
            force += *push;
            moment += *turn - root.cross(*push);
        }
        let weight = DVec3::Y * GRAVITY;
        (force - weight * whole.mass, moment - whole.moment.cross(weight))
    }

    /// Each link's own inertia, and the force that it takes to keep all speeds as they are.
    fn spread(&self, composites: &mut [Composite; MOST], loads: &mut [Load; MOST]) {
        let root = self.origin[0];
        // Acceleration of the origin, gravity as one upwards, and of the spin.
        let mut bends = [(DVec3::Y * GRAVITY, DVec3::ZERO); MOST];
        for (index, link) in self.tree.links.iter().enumerate() {
            if let Some(parent) = link.parent {
                let arm = self.origin[index] - self.origin[parent];
                let spin = self.spin[parent];
                let (travel, turn) = bends[parent];
                bends[index] = (
                    travel + turn.cross(arm) + spin.cross(spin.cross(arm)),
                    turn + spin.cross(self.spin[index] - spin),
                );
            }
            let turn = DMat3::from_quat(self.turn[index]);
            let inertia = turn * link.inertia * turn.transpose();
            let arm = turn * link.centre;
            let centre = self.origin[index] + arm - root;
            let spin = self.spin[index];
            composites[index] = Composite {
                mass: link.mass,
                moment: centre * link.mass,
                inertia: inertia + steiner(link.mass, centre),
            };
            let (travel, bend) = bends[index];
            let force = (travel + bend.cross(arm) + spin.cross(spin.cross(arm))) * link.mass;
            let torque = inertia * bend + spin.cross(inertia * spin) + centre.cross(force);
            let (push, moment) = self.pushed[index];
            loads[index] = Load { force: force - push, moment: torque - (moment - root.cross(push)) };
        }
    }

    /// A step of `dt` s along the speeds: places, angles, and how far ahead the springs' rests still are.
    pub(super) fn travel(&mut self, dt: f64) {
        self.follow();
        let was = self.whole();
        let old = self.origin[0];
        let v = &self.speed;
        self.origin[0] += DVec3::new(v[0], v[1], v[2]) * dt;
        self.turn[0] = (DQuat::from_scaled_axis(DVec3::new(v[3], v[4], v[5]) * dt) * self.turn[0]).normalize();
        for index in 1..self.tree.links.len() {
            let first = self.tree.first[index];
            match self.tree.links[index].joint {
                Joint::Hinge { .. } => self.angle[index] += dt * v[first],
                _ => {
                    let turned = DVec3::new(v[first], v[first + 1], v[first + 2]) * dt;
                    self.relative[index] = (DQuat::from_scaled_axis(turned) * self.relative[index]).normalize();
                }
            }
        }
        for freedom in 6..self.tree.freedoms() {
            self.drive.ahead[freedom] -= dt * self.speed[freedom];
        }
        self.follow();
        // Momentum and its moment about where the root was, as weight, pushes and contacts made them.
        let linear = was.linear + self.bend.0 * dt;
        let angular = was.angular + (was.centre - old).cross(was.linear) + self.bend.1 * dt;
        self.keep_momentum(linear, angular, old);
    }

    /// Joint speeds that stay while the pose changes are another momentum: the root's motion makes up for that, so that nothing but what
    /// pushes it moves the whole.
    fn keep_momentum(&mut self, linear: DVec3, angular: DVec3, about: DVec3) {
        let now = self.whole();
        let lost = (linear - now.linear) / now.mass;
        let angular = angular - (now.centre - about).cross(linear);
        let turned = now.inertia.inverse() * (angular - now.angular);
        if !(lost.is_finite() && turned.is_finite()) {
            return;
        }
        let travel = lost + turned.cross(self.origin[0] - now.centre);
        for way in 0..3 {
            self.speed[way] += travel[way];
            self.speed[3 + way] += turned[way];
        }
        for index in 0..self.tree.links.len() {
            self.travel[index] += lost + turned.cross(self.origin[index] - now.centre);
            self.spin[index] += turned;
        }
    }

    /// Mass, centre, momentum about it and inertia of all links together.
    fn whole(&self) -> Whole {
        let mut whole = Whole::default();
        let root = self.origin[0];
        for (index, link) in self.tree.links.iter().enumerate() {
            let turn = DMat3::from_quat(self.turn[index]);
            let inertia = turn * link.inertia * turn.transpose();
            let arm = turn * link.centre;
            let at = self.origin[index] + arm - root;
            let travel = (self.travel[index] + self.spin[index].cross(arm)) * link.mass;
            whole.mass += link.mass;
            whole.centre += at * link.mass;
            whole.linear += travel;
            whole.angular += inertia * self.spin[index] + at.cross(travel);
            whole.inertia += inertia + steiner(link.mass, at);
        }
        whole.centre /= whole.mass;
        whole.angular -= whole.centre.cross(whole.linear);
        whole.inertia -= steiner(whole.mass, whole.centre);
        whole.centre += root;
        whole
    }
}

/// Joints that give all that they can: their drive is that torque.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// One bit a link.
    pub(super) joints: u64,
    /// N m, one for each freedom.
    pub(super) torque: Vector,
}
