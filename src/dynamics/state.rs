//! Where the links of a tree are and how they move; their energy and momentum. World axes, y up, SI units.

use super::factor::{Factors, Vector};
use super::rows::Rows;
use super::tree::{Joint, MOST, Tree};
use glam::{DMat3, DQuat, DVec3};

/// m/s².
pub(super) const GRAVITY: f64 = crate::maths::pendulum::GRAVITY;

/// A tree that moves.
#[derive(Clone, Debug)]
pub struct Articulation {
    pub(super) tree: Tree,
    /// m, origins of the links.
    pub(super) origin: Vec<DVec3>,
    /// Their turns from rest.
    pub(super) turn: Vec<DQuat>,
    /// Turns against the parents.
    pub(super) relative: Vec<DQuat>,
    /// rad, of hinges.
    pub(super) angle: Vec<f64>,
    /// m/s and rad/s, one for each freedom.
    pub(super) speed: Vector,
    /// rad/s, of the links.
    pub(super) spin: Vec<DVec3>,
    /// m/s, of the links' origins.
    pub(super) travel: Vec<DVec3>,
    /// A freedom's motion of its link: turn, and travel of what is at the root's origin.
    pub(super) turns: Vec<DVec3>,
    pub(super) moves: Vec<DVec3>,
    /// N and N m about the world's origin, on each link.
    pub(super) pushed: Vec<(DVec3, DVec3)>,
    /// N and N m about the root's origin, what the speeds alone bend.
    pub(super) bend: (DVec3, DVec3),
    pub(super) drive: Drives,
    pub(super) factors: Factors,
    pub(super) rows: Rows,
}

/// What the joints' springs and dampers do, one for each freedom.
#[derive(Clone, Debug)]
pub(super) struct Drives {
    /// N m/rad.
    pub(super) stiffness: Vector,
    /// N m s/rad.
    pub(super) damping: Vector,
    /// rad, how far the spring's rest is ahead of the joint.
    pub(super) ahead: Vector,
    /// N m, what they gave on average in the last tick.
    pub(super) given: Vector,
    /// N m, the most that a joint gives.
    pub(super) most: f64,
}

/// Energy and momentum of a moving tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Momentum {
    /// J.
    pub kinetic: f64,
    /// J, over the world's origin.
    pub potential: f64,
    /// N s.
    pub linear: DVec3,
    /// N m s about the world's origin.
    pub angular: DVec3,
}

impl Articulation {
    /// A tree at rest, its links placed and turned so. Only the root's place is taken; the others follow from the joints. No joint gives
    /// more than `most` N m.
    pub fn new(tree: Tree, placed: &[(DVec3, DQuat)], most: f64) -> Articulation {
        let count = tree.links.len();
        let freedoms = tree.freedoms();
        let at = |link: usize| placed.get(link).copied().unwrap_or((DVec3::ZERO, DQuat::IDENTITY));
        let mut made = Articulation {
            origin: vec![at(0).0; count],
            turn: vec![at(0).1.normalize(); count],
            relative: vec![DQuat::IDENTITY; count],
            angle: vec![0.0; count],
            speed: [0.0; MOST],
            spin: vec![DVec3::ZERO; count],
            travel: vec![DVec3::ZERO; count],
            turns: vec![DVec3::ZERO; freedoms],
            moves: vec![DVec3::ZERO; freedoms],
            pushed: vec![(DVec3::ZERO, DVec3::ZERO); count],
            bend: (DVec3::ZERO, DVec3::ZERO),
            drive: Drives {
                stiffness: [0.0; MOST],
                damping: [0.0; MOST],
                ahead: [0.0; MOST],
                given: [0.0; MOST],
                most,
            },
            factors: Factors::new(&tree),
            rows: Rows::default(),
            tree,
        };
        for link in 1..count {
            let parent = made.tree.links[link].parent.unwrap_or(0);
            let turn = (at(parent).1.inverse() * at(link).1).normalize();
            made.relative[link] = turn;
            if let Joint::Hinge { axis } = made.tree.links[link].joint {
                let short = if turn.w < 0.0 { -turn } else { turn };
                made.angle[link] = short.to_scaled_axis().dot(axis);
            }
        }
        made.follow();
        made
    }

    /// How many links.
    pub fn links(&self) -> usize {
        self.tree.links.len()
    }

    /// m, and the turn from rest, of a link.
    pub fn place(&self, link: usize) -> (DVec3, DQuat) {
        (self.origin[link], self.turn[link])
    }

    /// m/s of a point (m) that a link carries, and the link's spin (rad/s).
    pub fn motion_at(&self, link: usize, point: DVec3) -> (DVec3, DVec3) {
        (self.travel[link] + self.spin[link].cross(point - self.origin[link]), self.spin[link])
    }

    /// Sets what the spring and the damper of a joint do in the next tick: N m/rad, N m s/rad and how far (rad) the spring's rest is ahead,
    /// about the parent's axes; of a hinge the first of the first two, and what is ahead along its axis.
    pub fn drive(&mut self, link: usize, stiffness: DVec3, damping: DVec3, ahead: DVec3) {
        let first = self.tree.first[link];
        match self.tree.links[link].joint {
            Joint::Hinge { axis } => {
                self.drive.stiffness[first] = stiffness.x;
                self.drive.damping[first] = damping.x;
                self.drive.ahead[first] = ahead.dot(axis);
            }
            Joint::Ball => {
                for way in 0..3 {
                    self.drive.stiffness[first + way] = stiffness[way];
                    self.drive.damping[first + way] = damping[way];
                    self.drive.ahead[first + way] = ahead[way];
                }
            }
            Joint::Free => {}
        }
    }

    /// N m, what a joint's spring and damper gave on average in the last tick.
    pub fn given(&self, link: usize) -> f64 {
        let ways = if link == 0 { 0..=0 } else { self.tree.freedoms_of(link) };
        if link == 0 { 0.0 } else { ways.map(|way| self.drive.given[way].powi(2)).sum::<f64>().sqrt() }
    }

    /// A force (N) on a link at a point (m) and a torque (N m), until [`Articulation::rest`].
    pub fn push(&mut self, link: usize, force: DVec3, point: DVec3, torque: DVec3) {
        self.pushed[link].0 += force;
        self.pushed[link].1 += torque + point.cross(force);
    }

    /// Lets go of all forces.
    pub fn let_go(&mut self) {
        self.pushed.fill((DVec3::ZERO, DVec3::ZERO));
    }

    /// A link with another mass (kg), centre of mass (m) and inertia (kg m²) from now on.
    pub fn load(&mut self, link: usize, mass: f64, centre: DVec3, inertia: DMat3) {
        let loaded = &mut self.tree.links[link];
        (loaded.mass, loaded.centre, loaded.inertia) = (mass, centre, inertia);
    }

    /// Places and velocities of the links from the joints.
    pub(super) fn follow(&mut self) {
        self.travel[0] = DVec3::new(self.speed[0], self.speed[1], self.speed[2]);
        self.spin[0] = DVec3::new(self.speed[3], self.speed[4], self.speed[5]);
        for (way, axis) in DVec3::AXES.into_iter().enumerate() {
            (self.turns[way], self.moves[way]) = (DVec3::ZERO, axis);
            (self.turns[3 + way], self.moves[3 + way]) = (axis, DVec3::ZERO);
        }
        for index in 1..self.tree.links.len() {
            let link = &self.tree.links[index];
            let (parent, first) = (link.parent.unwrap_or(0), self.tree.first[index]);
            let arm = self.turn[parent] * link.anchor;
            self.origin[index] = self.origin[parent] + arm;
            self.travel[index] = self.travel[parent] + self.spin[parent].cross(arm);
            if let Joint::Hinge { axis } = link.joint {
                self.relative[index] = DQuat::from_axis_angle(axis, self.angle[index]);
            }
            self.turn[index] = (self.turn[parent] * self.relative[index]).normalize();
            let lever = self.origin[index] - self.origin[0];
            let mut spin = self.spin[parent];
            let axes = match link.joint {
                Joint::Hinge { axis } => [self.turn[parent] * axis, DVec3::ZERO, DVec3::ZERO],
                _ => DMat3::from_quat(self.turn[parent]).to_cols_array_2d().map(DVec3::from_array),
            };
            for (way, axis) in axes.into_iter().enumerate().take(link.joint.freedoms()) {
                self.turns[first + way] = axis;
                self.moves[first + way] = lever.cross(axis);
                spin += axis * self.speed[first + way];
            }
            self.spin[index] = spin;
        }
    }

    /// Turns a joint against its parent by a rotation vector (rad), at once.
    #[cfg(test)]
    pub(super) fn tilt(&mut self, link: usize, by: DVec3) {
        match self.tree.links[link].joint {
            Joint::Hinge { axis } => self.angle[link] += by.dot(axis),
            _ => self.relative[link] = DQuat::from_scaled_axis(by) * self.relative[link],
        }
        self.follow();
    }

    /// Energy and momentum as it moves now.
    pub fn momentum(&self) -> Momentum {
        let mut sum = Momentum { kinetic: 0.0, potential: 0.0, linear: DVec3::ZERO, angular: DVec3::ZERO };
        for (index, link) in self.tree.links.iter().enumerate() {
            let at = self.origin[index] + self.turn[index] * link.centre;
            let (velocity, spin) = self.motion_at(index, at);
            let turn = DMat3::from_quat(self.turn[index]);
            let own = turn * (link.inertia * (turn.transpose() * spin));
            sum.kinetic += 0.5 * (link.mass * velocity.length_squared() + spin.dot(own));
            sum.potential += link.mass * GRAVITY * at.y;
            sum.linear += link.mass * velocity;
            sum.angular += own + at.cross(link.mass * velocity);
        }
        sum
    }
}
