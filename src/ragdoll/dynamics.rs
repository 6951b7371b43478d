//! Rigid-body dynamics of the figure: centre of mass, momentum, accelerations down the tree, forces back up it.
//!
//! Scenario space, SI. Recursive Newton-Euler (Featherstone 2008, ch. 5) in world axes, for accelerations that a controller
//! wants: it answers which wrench the world must give, and which torques the joints. Knows no engine and no contacts' limits.

use super::figure::{Figure, Freedom};
use super::linear::{Factored, Matrix6, damped, transposed};
use super::world::LinkState;
use crate::maths::pendulum::GRAVITY;
use glam::{DMat3, DVec2, DVec3};

/// The links' motion at one instant.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// As read.
    pub states: Vec<LinkState>,
    /// m, links' centres of mass.
    pub centres: Vec<DVec3>,
    /// kg m², about them, world axes.
    pub inertias: Vec<DMat3>,
    /// m, of the whole.
    pub com: DVec3,
    /// m/s.
    pub velocity: DVec3,
    /// kg m²/s, about the centre of mass.
    pub momentum: DVec3,
    /// kg.
    pub mass: f64,
}

/// A force and its moment about the centre of mass: [x, y, z, mx, my, mz].
pub type Wrench = [f64; 6];

/// Linear acceleration of a link's origin and its angular acceleration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Acceleration {
    /// m/s².
    pub linear: DVec3,
    /// rad/s².
    pub angular: DVec3,
}

impl Motion {
    /// Takes a reading in; buffers are kept.
    pub fn read(&mut self, figure: &Figure, states: &[LinkState]) {
        self.states.clear();
        self.states.extend_from_slice(states);
        self.centres.clear();
        self.inertias.clear();
        self.mass = figure.mass;
        let (mut moment, mut impulse) = (DVec3::ZERO, DVec3::ZERO);
        for (link, state) in figure.links.iter().zip(states) {
            let centre = state.origin + state.turn * link.centre;
            let turn = DMat3::from_quat(state.turn);
            self.centres.push(centre);
            self.inertias.push(turn * link.inertia * turn.transpose());
            moment += link.mass * centre;
            impulse += link.mass * state.velocity;
        }
        self.com = moment / figure.mass;
        self.velocity = impulse / figure.mass;
        self.momentum = DVec3::ZERO;
        for (index, link) in figure.links.iter().enumerate() {
            let state = &states[index];
            self.momentum += self.inertias[index] * state.spin
                + (self.centres[index] - self.com).cross(link.mass * (state.velocity - self.velocity));
        }
    }

    /// m/s, of a link's origin.
    pub fn origin_velocity(&self, link: usize) -> DVec3 {
        let state = &self.states[link];
        state.velocity + state.spin.cross(state.origin - self.centres[link])
    }

    /// rad/s, of a link against its parent, world axes.
    pub fn relative_spin(&self, figure: &Figure, link: usize) -> DVec3 {
        figure.links[link].parent.map_or(DVec3::ZERO, |parent| self.states[link].spin - self.states[parent].spin)
    }

    /// The acceleration of a link whose parent has `parent`, turning against it with `relative` (rad/s², world axes).
    pub fn child(&self, figure: &Figure, link: usize, parent: &Acceleration, relative: DVec3) -> Acceleration {
        let Some(over) = figure.links[link].parent else { return *parent };
        let spin = self.states[over].spin;
        let arm = self.states[link].origin - self.states[over].origin;
        Acceleration {
            linear: parent.linear + parent.angular.cross(arm) + spin.cross(spin.cross(arm)),
            angular: parent.angular + relative + spin.cross(self.states[link].spin - spin),
        }
    }

    /// The force (less gravity's) and the moment about its centre of mass that a link's acceleration takes.
    pub fn needs(&self, figure: &Figure, link: usize, acceleration: &Acceleration) -> (DVec3, DVec3) {
        let spin = self.states[link].spin;
        let arm = self.centres[link] - self.states[link].origin;
        let centre = acceleration.linear + acceleration.angular.cross(arm) + spin.cross(spin.cross(arm));
        let inertia = self.inertias[link];
        (
            figure.links[link].mass * (centre + DVec3::Y * GRAVITY),
            inertia * acceleration.angular + spin.cross(inertia * spin),
        )
    }

    /// The wrench that the world must give for those accelerations.
    pub fn wrench(&self, figure: &Figure, accelerations: &[Acceleration]) -> Wrench {
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for (index, acceleration) in accelerations.iter().enumerate() {
            let (f, n) = self.needs(figure, index, acceleration);
            force += f;
            moment += n + (self.centres[index] - self.com).cross(f);
        }
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }

    /// Torques at the joints, world axes, on each link from its parent; `outside`: force and moment about its origin on each link from the world.
    pub fn torques(
        &self,
        figure: &Figure,
        accelerations: &[Acceleration],
        outside: &[(DVec3, DVec3)],
        torques: &mut Vec<DVec3>,
    ) {
        torques.clear();
        torques.resize(figure.links.len(), DVec3::ZERO);
        let mut forces = vec![DVec3::ZERO; figure.links.len()];
        for index in (0..figure.links.len()).rev() {
            let (f, n) = self.needs(figure, index, &accelerations[index]);
            let origin = self.states[index].origin;
            let (push, twist) = outside[index];
            forces[index] += f - push;
            torques[index] += n + (self.centres[index] - origin).cross(f) - twist;
            if let Some(parent) = figure.links[index].parent {
                let (force, torque) = (forces[index], torques[index]);
                forces[parent] += force;
                torques[parent] += torque + (origin - self.states[parent].origin).cross(force);
            }
        }
    }

    /// The extrapolated centre of mass on the ground, with the moment that the angular momentum still has to give (Hof 2008;
    /// the factor is measured), (x, z).
    pub fn extrapolated(&self, rate: f64, share: f64) -> DVec2 {
        let lean = DVec2::new(-self.momentum.z, self.momentum.x) * (share * rate / (self.mass * GRAVITY));
        DVec2::new(self.com.x, self.com.z) + DVec2::new(self.velocity.x, self.velocity.z) / rate + lean
    }
}

/// A leg as six angles: three of the hip, the knee, two of the ankle. The ankle's third is held.
#[derive(Clone, Copy, Debug)]
pub struct LegMap {
    jacobian: Matrix6,
    factored: Factored,
    axes: [DVec3; 6],
    links: [usize; 3],
    bent: Option<(f64, f64)>,
}

impl LegMap {
    /// At the present pose. `bent`: how much of the knee's acceleration is given apart, and the acceleration, rad/s²; the other
    /// joints make up for it.
    pub fn new(figure: &Figure, motion: &Motion, leg: [usize; 3], damping: f64, bent: Option<(f64, f64)>) -> LegMap {
        let [hip, knee, ankle] = leg;
        let pelvis = figure.links[hip].parent.unwrap_or(0);
        let over = motion.states[pelvis].turn;
        let knee_axis = match figure.links[knee].freedom {
            Freedom::Hinge { axis, .. } => motion.states[hip].turn * axis,
            _ => motion.states[hip].turn * DVec3::X,
        };
        let shank = motion.states[knee].turn;
        let axes = [over * DVec3::X, over * DVec3::Y, over * DVec3::Z, knee_axis, shank * DVec3::X, shank * DVec3::Z];
        let at = motion.states[ankle].origin;
        let mut jacobian = [[0.0; 6]; 6];
        for (column, axis) in axes.iter().enumerate() {
            let joint = if column < 3 {
                hip
            } else if column == 3 {
                knee
            } else {
                ankle
            };
            let linear = axis.cross(at - motion.states[joint].origin);
            for (row, value) in [linear.x, linear.y, linear.z, axis.x, axis.y, axis.z].into_iter().enumerate() {
                jacobian[row][column] = value;
            }
        }
        let mut left = jacobian;
        if let Some((share, _)) = bent {
            for row in &mut left {
                row[3] *= 1.0 - share;
            }
        }
        LegMap { jacobian: left, factored: damped(&left, damping), axes, links: leg, bent }
    }

    /// Changes of the relative angular velocities of hip, knee and ankle (world axes) that change the foot's motion by that.
    pub fn change(&self, linear: DVec3, angular: DVec3) -> [DVec3; 3] {
        let y = self.factored.solve(&[linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]);
        let x = transposed(&self.jacobian, &y);
        [
            self.axes[0] * x[0] + self.axes[1] * x[1] + self.axes[2] * x[2],
            self.axes[3] * x[3],
            self.axes[4] * x[4] + self.axes[5] * x[5],
        ]
    }

    /// Relative angular accelerations of hip, knee and ankle (world axes) that give the foot `wanted`, the pelvis having `pelvis`.
    pub fn solve(
        &self,
        figure: &Figure,
        motion: &Motion,
        pelvis: &Acceleration,
        wanted: &Acceleration,
        held: DVec3,
    ) -> [DVec3; 3] {
        let [hip, knee, ankle] = self.links;
        let thigh = motion.child(figure, hip, pelvis, DVec3::ZERO);
        let shank = motion.child(figure, knee, &thigh, DVec3::ZERO);
        let foot = motion.child(figure, ankle, &shank, held);
        let (mut linear, mut angular) = (wanted.linear - foot.linear, wanted.angular - foot.angular);
        let (mut left, mut bend) = (1.0, DVec3::ZERO);
        if let Some((share, acceleration)) = self.bent {
            bend = self.axes[3] * (acceleration * share);
            left = 1.0 - share;
            linear -= bend.cross(motion.states[ankle].origin - motion.states[knee].origin);
            angular -= bend;
        }
        let y = self.factored.solve(&[linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]);
        let x = transposed(&self.jacobian, &y);
        [
            self.axes[0] * x[0] + self.axes[1] * x[1] + self.axes[2] * x[2],
            self.axes[3] * (x[3] * left) + bend,
            self.axes[4] * x[4] + self.axes[5] * x[5] + held,
        ]
    }
}
