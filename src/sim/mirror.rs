//! A run of the mirrored body, seen in the mirror: the run of the body itself. Scenario space, SI.

use super::articulated::Articulated;
use super::balls::Flown;
use super::{SessionPush, TickState, Trace};
use crate::maths::mirror;
use crate::model::{Plant, Role};
use crate::stepper::Step;

impl Articulated {
    /// Its mirror image; `twins` as of [`crate::model::Body::mirrored`].
    pub fn mirrored(self, twins: &[usize]) -> Articulated {
        let [left, right] = self.stood;
        let side = |(role, torque): (Role, f64)| (role.mirrored(), torque);
        Articulated {
            trace: self.trace.mirrored(),
            torques: self.torques.into_iter().map(side).collect(),
            poses: self.poses.iter().map(|pose| pose.mirrored(twins)).collect(),
            pressed: self.pressed.into_iter().map(|[left, right]| [right, left]).collect(),
            joints: self.joints.into_iter().map(|joint| twins[joint]).collect(),
            stood: [right, left],
            balls: self.balls.into_iter().map(|ball| ball.mirrored(twins)).collect(),
            ..self
        }
    }
}

impl Trace {
    fn mirrored(mut self) -> Trace {
        self.ticks.iter_mut().for_each(TickState::mirror);
        self.start = feet(self.start);
        for Step { side, from, to, .. } in self.steps.iter_mut().chain(&mut self.aloft) {
            (*side, *from, *to) = (side.other(), plant(*from), plant(*to));
        }
        for SessionPush { force, .. } in &mut self.pushes {
            *force = mirror::point(*force);
        }
        self
    }
}

impl TickState {
    fn mirror(&mut self) {
        for way in [&mut self.com, &mut self.velocity, &mut self.acceleration, &mut self.push] {
            *way = mirror::point(*way);
        }
        for place in [&mut self.xi, &mut self.cop, &mut self.walk] {
            *place = mirror::ground(*place);
        }
        self.push_moment = mirror::axial(self.push_moment);
        self.feet = feet(self.feet);
        self.planted.reverse();
        self.facing = mirror::flipped(self.facing);
    }
}

impl Flown {
    fn mirrored(mut self, twins: &[usize]) -> Flown {
        for (_, place, turn) in &mut self.way {
            (*place, *turn) = (mirror::point(*place), mirror::turn(*turn));
        }
        self.velocity = mirror::point(self.velocity);
        for hit in &mut self.hits {
            hit.impulse = mirror::point(hit.impulse);
            hit.at = (twins[hit.at.0], mirror::point(hit.at.1));
            hit.point = mirror::point(hit.point);
        }
        self
    }
}

fn plant(plant: Plant) -> Plant {
    Plant { ankle: mirror::point(plant.ankle), yaw: mirror::flipped(plant.yaw), normal: mirror::point(plant.normal) }
}

fn feet([left, right]: [Plant; 2]) -> [Plant; 2] {
    [plant(right), plant(left)]
}
