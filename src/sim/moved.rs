//! A run begun later, and elsewhere: seen from another place, turned about the vertical. Scenario space, SI.

use super::articulated::Articulated;
use super::{SessionPush, Trace};
use crate::model::{BodyPose, Plant};
use crate::stepper::Step;
use glam::{DQuat, DVec2, DVec3};

impl Articulated {
    /// From a tick on, as if it had begun there, where its feet then stand; they are seen to stand until `end` (s from there).
    pub fn begun_at(mut self, first: usize, end: f64) -> Articulated {
        let ago = first as f64 * self.trace.dt;
        let forget = |count: usize| first.min(count);
        self.poses.drain(..forget(self.poses.len()));
        self.pressed.drain(..forget(self.pressed.len()));
        self.torque_curves.iter_mut().for_each(|curve| drop(curve.drain(..forget(curve.len()))));
        let later = |spans: Vec<[f64; 2]>| {
            let spans = spans.into_iter().map(|[from, to]| [(from - ago).max(0.0), (to - ago).min(end)]);
            spans.filter(|[from, to]| from <= to).collect()
        };
        self.stood = self.stood.map(later);
        self.trace = self.trace.begun_at(first);
        self
    }

    /// Turned (rad) about the vertical through the origin, then moved (m).
    pub fn moved(mut self, yaw: f64, by: DVec3) -> Articulated {
        let turn = DQuat::from_rotation_y(yaw);
        let moved = |pose: &BodyPose| BodyPose {
            hips: turn * pose.hips + by,
            turns: pose.turns.iter().map(|own| (turn * *own).normalize()).collect(),
        };
        self.poses = self.poses.iter().map(moved).collect();
        self.trace = self.trace.moved(yaw, by);
        self
    }
}

impl Trace {
    fn begun_at(mut self, first: usize) -> Trace {
        let ago = first as f64 * self.dt;
        for step in self.steps.iter().filter(|step| step.land <= ago) {
            self.start[step.side as usize] = step.to;
        }
        self.ticks.drain(..first.min(self.ticks.len()));
        self.steps.retain(|step| step.land > ago);
        for step in self.steps.iter_mut().chain(&mut self.aloft) {
            step.lift -= ago;
            step.land -= ago;
        }
        self.pushes.iter_mut().for_each(|push| push.start -= ago);
        self.lost = self.lost.map(|lost| lost - ago);
        self
    }

    fn moved(mut self, yaw: f64, by: DVec3) -> Trace {
        let turn = DQuat::from_rotation_y(yaw);
        let flat = |way: DVec2| {
            let way = turn * DVec3::new(way.x, 0.0, way.y);
            DVec2::new(way.x, way.z)
        };
        let plant =
            |plant: Plant| Plant { ankle: turn * plant.ankle + by, yaw: plant.yaw + yaw, normal: turn * plant.normal };
        for tick in &mut self.ticks {
            for way in [&mut tick.velocity, &mut tick.acceleration, &mut tick.push, &mut tick.push_moment] {
                *way = turn * *way;
            }
            tick.com = turn * tick.com + by;
            tick.xi = flat(tick.xi) + DVec2::new(by.x, by.z);
            tick.cop = flat(tick.cop) + DVec2::new(by.x, by.z);
            tick.walk = flat(tick.walk);
            tick.feet = tick.feet.map(plant);
            tick.facing += yaw;
        }
        self.start = self.start.map(plant);
        for Step { from, to, .. } in self.steps.iter_mut().chain(&mut self.aloft) {
            (*from, *to) = (plant(*from), plant(*to));
        }
        for SessionPush { force, .. } in &mut self.pushes {
            *force = turn * *force;
        }
        self
    }
}
