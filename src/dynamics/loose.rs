//! A rigid body that hangs from nothing: a ball on its way, a box in the hands. SI units, world axes.

use super::state::GRAVITY;
use glam::{DQuat, DVec3};

/// A loose body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loose {
    /// kg.
    pub mass: f64,
    /// kg m², about its own axes through its centre.
    pub inertia: DVec3,
    /// m, its centre.
    pub place: DVec3,
    /// Its turn.
    pub turn: DQuat,
    /// m/s.
    pub velocity: DVec3,
    /// rad/s.
    pub spin: DVec3,
    /// Whether it falls here; else who owns it lets it.
    pub falls: bool,
}

impl Loose {
    /// m/s, of a point that it carries.
    pub fn motion_at(&self, point: DVec3) -> DVec3 {
        self.velocity + self.spin.cross(point - self.place)
    }

    /// What a unit impulse along `way` at a point does, in the space in which its masses are one.
    pub(super) fn reach(&self, way: DVec3, point: DVec3) -> [f64; 6] {
        let push = way / self.mass.sqrt();
        let turn = self.turned((point - self.place).cross(way));
        [push.x, push.y, push.z, turn.x, turn.y, turn.z]
    }

    /// And what a unit turning impulse about `axis` does.
    pub(super) fn twist(&self, axis: DVec3) -> [f64; 6] {
        let turn = self.turned(axis);
        [0.0, 0.0, 0.0, turn.x, turn.y, turn.z]
    }

    fn turned(&self, moment: DVec3) -> DVec3 {
        (self.turn.inverse() * moment) / DVec3::from_array(self.inertia.to_array().map(f64::sqrt))
    }

    pub(super) fn change(&mut self, by: &[f64; 6]) {
        self.velocity += DVec3::new(by[0], by[1], by[2]) / self.mass.sqrt();
        let turn = DVec3::new(by[3], by[4], by[5]) / DVec3::from_array(self.inertia.to_array().map(f64::sqrt));
        self.spin += self.turn * turn;
    }

    /// What gravity does to it in `dt` s.
    pub(super) fn fall(&mut self, dt: f64) {
        if self.falls {
            self.velocity.y -= GRAVITY * dt;
        }
    }

    pub(super) fn travel(&mut self, dt: f64) {
        self.place += self.velocity * dt;
        self.turn = (DQuat::from_scaled_axis(self.spin * dt) * self.turn).normalize();
    }
}
