//! The joints' part of the balance law: what each would do by itself, what the legs that bear must not do, what the pelvis's motion
//! takes of them all, and their torques as springs and dampers. Scenario space, SI.

use super::control::{Controller, MOST_TORQUE};
use super::dynamics::{Acceleration, LegMap, Wrench};
use super::figure::{Figure, Freedom, Link, Part};
use super::linear::{Factored, Matrix6};
use super::world::World;
use super::{short, toes};
use crate::maths::pendulum::GRAVITY;
use crate::model::{Side, Terrain};
use glam::{DMat3, DQuat, DVec3};

/// m/s², by which a force's line may be moved for the pressure's sake: half of gravity.
const MOST_CHANGE: f64 = 5.0;

impl Controller {
    /// What each joint would do by itself: joints that are free to be posed go back to the stand.
    pub(super) fn pose_joints(&mut self, figure: &Figure) {
        let count = figure.links.len();
        self.relative.clear();
        self.relative.resize(count, DVec3::ZERO);
        for index in 1..count {
            let link = &figure.links[index];
            let parent = link.parent.unwrap_or(0);
            let [angle, rate, quickens] = self.with_stride(figure, index);
            let angle = angle + self.hangs(link);
            let axis = if index == figure.trunk { DVec3::Y } else { DVec3::X };
            let swung = DQuat::from_axis_angle(axis, angle) * self.posture[index];
            let wanted = self.states[parent].turn * if angle == 0.0 { self.posture[index] } else { swung };
            let error = short(wanted * self.states[index].turn.inverse());
            let spin = self.motion.relative_spin(figure, index);
            let omega = 0.6 * link.omega;
            self.relative[index] = error * omega * omega - spin * (2.0 * omega);
            if rate != 0.0 || quickens != 0.0 {
                self.relative[index] += self.states[parent].turn * axis * (rate * 2.0 * omega + quickens);
            }
        }
    }

    /// A foot that bears stands still on the ground (a platform turns about the origin) as soon as it touches: its leg's dampers
    /// must not carry its last motion on.
    pub(super) fn stand_still(&mut self, figure: &Figure, terrain: &Terrain, legs: &[LegMap; 2], dt: f64) {
        let ground_spin = short(terrain.turn(self.time + dt) * terrain.turn(self.time).inverse()) / dt;
        self.stopped.clear();
        self.stopped.resize(figure.links.len(), DVec3::ZERO);
        for side in Side::BOTH {
            if self.swing.is_none_or(|swing| swing.side != side) {
                let leg = figure.legs[side as usize];
                let origin = self.states[leg[2]].origin;
                let sole = &self.soles[side as usize];
                let carried = ground_spin.cross(origin) + sole.spin.cross(origin - sole.pivot);
                let change = legs[side as usize].change(
                    carried - self.motion.origin_velocity(leg[2]),
                    ground_spin + sole.spin - self.states[leg[2]].spin,
                );
                for (link, change) in leg.into_iter().zip(change) {
                    self.stopped[link] = change * self.tuning.snap;
                }
            }
        }
    }

    /// The pelvis's acceleration as a function of the wrench: what a unit of it takes, and what it takes where it has none.
    pub(super) fn root_map(
        &mut self,
        figure: &Figure,
        legs: &[LegMap; 2],
        feet: &[Acceleration; 2],
        trunk: DVec3,
    ) -> (Factored, Wrench) {
        let bias = self.spread(figure, legs, feet, &Acceleration::default(), trunk);
        let mut matrix: Matrix6 = [[0.0; 6]; 6];
        for column in 0..6 {
            let mut unit = Acceleration::default();
            if column < 3 {
                unit.linear[column] = 1.0;
            } else {
                unit.angular[column - 3] = 1.0;
            }
            let wrench = self.spread(figure, legs, feet, &unit, trunk);
            for ((row, wrench), bias) in matrix.iter_mut().zip(wrench).zip(bias) {
                row[column] = wrench - bias;
            }
        }
        (Factored::new(matrix, 1e-3), bias)
    }

    /// m/s², how the centre of mass has to move for the ground's pressure to be where it is commanded while the pelvis turns as `angular`
    /// (rad/s²) says. A force that only passes through that point, as a pendulum has it, is not enough: legs that swing take moments
    /// too, and the pressure would make up for them. So the wrench (F, M about the centre of mass c) is sought whose
    /// moment about the point p is vertical, M = (p - c) × F + τ Y, with F's height as in `linear`: three unknowns, three equations of
    /// the pelvis's turn. Where they are nearly dependent `linear` is kept.
    pub(super) fn over_pressure(
        &self,
        base: &Factored,
        bias: &Wrench,
        level: f64,
        linear: DVec3,
        angular: DVec3,
    ) -> DVec3 {
        let (mass, cop) = (self.motion.mass, self.report.cop);
        let arm = DVec3::new(cop.x, level, cop.y) - self.motion.com;
        let turned = |force: DVec3, about: f64| {
            let moment = arm.cross(force) + DVec3::Y * about;
            let wrench = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
            let root = base.solve(&std::array::from_fn(|axis| wrench[axis] - bias[axis]));
            DVec3::new(root[3], root[4], root[5])
        };
        let up = DVec3::Y * (mass * (linear.y + GRAVITY));
        let none = turned(up, 0.0);
        let columns = [(DVec3::X * mass, 0.0), (DVec3::Z * mass, 0.0), (DVec3::ZERO, mass)];
        let map = columns.map(|(force, about)| turned(up + force, about) - none);
        let map = DMat3::from_cols(map[0], map[1], map[2]);
        let found = map.inverse() * (angular - none);
        let level = DVec3::new(found.x, linear.y, found.y);
        if map.determinant().abs() < 1e-6 || !level.is_finite() {
            return linear;
        }
        let change = level - linear;
        linear + change.clamp_length_max(MOST_CHANGE)
    }

    /// Torques to the world: a spring and a damper whose rests give what is needed if all goes as planned.
    pub(super) fn give(&mut self, figure: &Figure, world: &mut World, dt: f64) {
        // The world takes the tick in parts, springs and dampers at their ends: what counts is the mean over these, of the times and of the
        // ways that an even acceleration makes by then.
        let parts = world.parts as f64;
        let late = dt * (parts + 1.0) / (2.0 * parts);
        let far = dt * dt * (parts + 1.0) * (parts + 2.0) / (6.0 * parts * parts);
        toes::drive(figure, world, &self.states, &self.toes);
        for index in (1..figure.links.len()).filter(|index| figure.bears(*index) == *index) {
            let link = &figure.links[index];
            let parent = link.parent.unwrap_or(0);
            let back = self.states[parent].turn.inverse();
            let [stiffness, damping] = self.stands_by(link);
            let mut torque = back * self.needed[index];
            if let Freedom::Hinge { axis, .. } = link.freedom {
                torque = axis * axis.dot(torque);
            }
            let torque = torque.clamp_length_max(MOST_TORQUE);
            // Relative acceleration and speed at the end of the tick, as planned, in the parent's frame.
            let spin = self.states[index].spin - self.states[parent].spin + self.stopped[index];
            let relative = self.accelerations[index].angular
                - self.accelerations[parent].angular
                - self.states[parent].spin.cross(spin - self.stopped[index]);
            let (spin, relative) = (back * spin, back * relative);
            let speed = spin + relative * late;
            let way = spin * late + relative * far;
            let ahead = way + (torque + speed * damping) / stiffness.max(1e-9);
            world.drive(index, DVec3::splat(stiffness), DVec3::splat(damping), ahead);
        }
    }

    /// N m/rad and N m s/rad of a joint's spring and damper, which resist what is not foreseen.
    fn stands_by(&self, link: &Link) -> [f64; 2] {
        let side = match link.part {
            Part::Thigh(side) | Part::Shank(side) | Part::Foot(side) => Some(side),
            _ => None,
        };
        if side.is_some_and(|side| self.swing.is_none_or(|swing| swing.side != side)) {
            let scale = self.motion.mass / 89.5 * self.size * self.size;
            return self.tuning.bearing.map(|gain| gain * scale);
        }
        let share = self.tuning.standby[usize::from(side.is_none())];
        [share * link.carried * link.omega * link.omega, share * 2.0 * link.carried * link.omega]
    }
}

/// What the pelvis does under a wrench of the contacts and that help, N and N m.
pub(super) fn pelvis(base: &Factored, bias: &Wrench, wrench: &Wrench, [force, torque]: [DVec3; 2]) -> Acceleration {
    let mut less = *wrench;
    for (value, bias) in less.iter_mut().zip(bias) {
        *value -= bias;
    }
    for axis in 0..3 {
        less[axis] += force[axis];
        less[3 + axis] += torque[axis];
    }
    let root = base.solve(&less);
    Acceleration { linear: DVec3::new(root[0], root[1], root[2]), angular: DVec3::new(root[3], root[4], root[5]) }
}
