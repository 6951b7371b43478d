//! A pose of the body: where the hips are and how far each joint is turned from rest, in scenario axes.

use super::body::{Body, Side};
use glam::{DQuat, DVec3};

/// One pose. `turns[j]` rotates what is rigid with joint `j` from rest to the pose: a *global* rotation, not a local one.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPose {
    /// m, scenario space: the hips joint.
    pub hips: DVec3,
    /// One a joint of the body, same order.
    pub turns: Vec<DQuat>,
}

impl BodyPose {
    /// The rig's own rest pose.
    pub fn rest(body: &Body) -> BodyPose {
        BodyPose { hips: body.joints[0].rest, turns: vec![DQuat::IDENTITY; body.joints.len()] }
    }

    /// Positions of all joints, m, scenario space.
    pub fn positions(&self, body: &Body) -> Vec<DVec3> {
        let mut positions = Vec::with_capacity(body.joints.len());
        self.positions_into(body, &mut positions);
        positions
    }

    /// As [`Self::positions`], into a buffer that is kept between calls.
    pub fn positions_into(&self, body: &Body, positions: &mut Vec<DVec3>) {
        positions.clear();
        for (index, joint) in body.joints.iter().enumerate() {
            positions.push(match joint.parent {
                Some(parent) => positions[parent] + self.turns[parent] * body.offset(index),
                None => self.hips,
            });
        }
    }

    /// The articulated centre of mass, m, of joints at `positions`.
    pub fn centre_of_mass(&self, body: &Body, positions: &[DVec3]) -> DVec3 {
        let moment: DVec3 = body
            .segments
            .iter()
            .map(|segment| (positions[segment.joint] + self.turns[segment.joint] * segment.centre) * segment.mass)
            .sum();
        moment / body.mass
    }

    /// Sole vertices of one foot, m, scenario space: (rear, front).
    pub fn sole(&self, body: &Body, positions: &[DVec3], side: Side) -> (Vec<DVec3>, Vec<DVec3>) {
        let foot = &body.feet[side as usize];
        let ankle = positions[foot.ankle];
        let turn = self.turns[foot.ankle];
        let rear = foot.rear_sole.iter().map(|offset| ankle + turn * *offset).collect();
        let front = match foot.toe {
            Some(toe) => {
                let toe_offset = body.joints[toe].rest - body.joints[foot.ankle].rest;
                let toe_turn = self.turns[toe];
                foot.front_sole.iter().map(|offset| positions[toe] + toe_turn * (*offset - toe_offset)).collect()
            }
            None => foot.front_sole.iter().map(|offset| ankle + turn * *offset).collect(),
        };
        (rear, front)
    }
}
