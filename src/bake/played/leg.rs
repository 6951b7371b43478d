//! A leg posed anew for its ankle: hip and ankle given, the knee stays in the plane that it had. Scenario space, m.

use crate::maths::curve::smooth3;
use crate::maths::quat::shortest_arc;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::{Body, BodyPose, Side};
use crate::whole_body::Anatomy;
use glam::{DQuat, DVec3};

/// The part of its length that a leg may use. The run's own was within its joints; a little less than all keeps the knee's side.
const STRAIGHTEST: f64 = 0.9998;

/// Parts of a leg's length, that the knee is beside the line from hip to ankle: less, it does not tell where it bends to; more, it does (a
/// bend of 7 and of 27 degrees).
const BENT: [f64; 2] = [0.015, 0.06];

/// Where a foot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// m, the ankle joint.
    pub ankle: DVec3,
    /// Global turn of the foot from rest.
    pub foot: DQuat,
    /// Of its toes; of a foot without a toe joint the foot's.
    pub toe: DQuat,
}

impl Foot {
    /// Of a pose whose joints are at `positions`.
    pub fn of(body: &Body, pose: &BodyPose, positions: &[DVec3], side: Side) -> Foot {
        let shape = &body.feet[side as usize];
        let foot = pose.turns[shape.ankle];
        Foot { ankle: positions[shape.ankle], foot, toe: shape.toe.map_or(foot, |toe| pose.turns[toe]) }
    }

    /// The same in a frame that is turned so about the origin.
    pub fn seen_from(self, frame: DQuat) -> Foot {
        if frame == DQuat::IDENTITY {
            return self;
        }
        let back = frame.inverse();
        Foot { ankle: back * self.ankle, foot: back * self.foot, toe: back * self.toe }
    }
}

/// Puts a foot there; `positions` are the joints' before. Returns by how much the leg is too short for it, m. `ahead`, for a foot that may
/// be far from where it was: the knee of a leg that is almost straight goes that way.
pub fn reach(
    body: &Body,
    anatomy: &Anatomy,
    pose: &mut BodyPose,
    positions: &[DVec3],
    (side, ahead): (Side, Option<DVec3>),
    wanted: &Foot,
) -> f64 {
    let leg = &anatomy.legs[side as usize];
    let [hip, knee, ankle] = [leg.upper, leg.lower, leg.foot].map(|joint| positions[joint]);
    let mut short = 0.0;
    if (wanted.ankle - ankle).length_squared() > 1e-20 {
        let axis = (ankle - hip).normalize_or(DVec3::NEG_Y);
        let off = (knee - hip) - axis * (knee - hip).dot(axis);
        // A knee on the line says by the thigh's own hinge where it would go.
        let hinge = pose.turns[leg.upper] * leg.thigh_from_rest.inverse() * DVec3::X;
        let pole = if off.length() > 1e-4 * leg.length() { off } else { hinge.cross(-axis) };
        let pole = ahead.map_or(pole, |ahead| {
            let known = smooth3((off.length() / leg.length() - BENT[0]) / (BENT[1] - BENT[0]));
            off * known + (ahead - axis * ahead.dot(axis)) * (BENT[1] * leg.length() * (1.0 - known))
        });
        // Turned as the leg turns, so that the plane goes along.
        let pole = shortest_arc(ankle - hip, wanted.ankle - hip) * pole;
        let (upper, lower) = ((knee - hip).length(), (ankle - knee).length());
        let used = (ankle - hip).length() / (upper + lower).max(1e-9);
        let chain = two_bone_ik(hip, wanted.ankle, upper, lower, pole, STRAIGHTEST.max(used.min(1.0)));
        short = chain.end.distance(wanted.ankle);
        let thigh = shortest_arc(knee - hip, chain.middle - hip);
        let shank = shortest_arc(ankle - knee, chain.end - chain.middle);
        pose.turns[leg.upper] = (thigh * pose.turns[leg.upper]).normalize();
        pose.turns[leg.lower] = (shank * pose.turns[leg.lower]).normalize();
    }
    let by = wanted.foot * pose.turns[leg.foot].inverse();
    pose.turns[leg.foot] = wanted.foot.normalize();
    for (joint, shape) in body.joints.iter().enumerate() {
        if Some(joint) == body.feet[side as usize].toe {
            pose.turns[joint] = wanted.toe.normalize();
        } else if shape.parent == Some(leg.foot) {
            pose.turns[joint] = (by * pose.turns[joint]).normalize();
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;

    #[test]
    fn a_foot_is_put_where_it_is_wanted_and_the_knee_keeps_its_side() {
        let body = fixture::body();
        let anatomy = Anatomy::new(&body);
        let leg = &anatomy.legs[0];
        let mut pose = BodyPose::rest(&body);
        pose.turns[leg.upper] = DQuat::from_rotation_x(-0.4);
        pose.turns[leg.lower] = DQuat::from_rotation_x(0.3);
        let positions = pose.positions(&body);
        let now = Foot::of(&body, &pose, &positions, Side::Left);
        for by in [DVec3::new(0.004, 0.0, 0.0), DVec3::new(0.0, 0.01, -0.02), DVec3::new(0.0, -0.003, 0.0)] {
            let wanted = Foot { ankle: now.ankle + by, foot: DQuat::from_rotation_y(0.02), ..now };
            let mut moved = pose.clone();
            reach(&body, &anatomy, &mut moved, &positions, (Side::Left, None), &wanted);
            let after = moved.positions(&body);
            assert!(after[leg.foot].distance(wanted.ankle) < 1e-9, "{by}");
            assert!(
                after[leg.lower].z > 0.02 && after[leg.upper] == positions[leg.upper],
                "{by}: the knee bends ahead"
            );
            assert!(moved.turns[leg.foot].angle_between(wanted.foot) < 1e-9);
        }
        let mut same = pose.clone();
        reach(&body, &anatomy, &mut same, &positions, (Side::Left, None), &now);
        assert!(
            same.turns.iter().zip(&pose.turns).all(|(a, b)| a.angle_between(*b) < 1e-7),
            "nothing wanted, nothing done"
        );
    }
}
