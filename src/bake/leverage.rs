//! How far a joint's turning moves the zero-moment point: what an error in a channel's acceleration costs the balance.
//!
//! The pendulum's ZMP moves against the acceleration of the centre of mass by its height over g; a joint that turns faster by
//! so much accelerates the masses beyond it, and turns them. Rest pose, scenario space, SI. Leaves out that a planted leg
//! moves the body and not itself: there the held foot is the stricter bound.

use crate::maths::pendulum::GRAVITY;
use crate::model::Body;
use glam::DVec3;
use std::f64::consts::PI;

/// m: what the ZMP may move by the error of one channel: of the hips' way, which moves all of the body, and of a joint's turn.
const ZMP: [f64; 2] = [1.5e-3, 7.0e-3];
/// Of the height: how far the farthest joint that a joint carries may be off, a millimetre and a half of a person.
const PLACE: f64 = 0.9e-3;
/// Of the height: what a joint that carries none reaches, a toe's length.
const LEAST_REACH: f64 = 0.04;
/// rad: what a joint may be off by, 0.1 degrees where it carries far, 0.5 where it carries next to nothing.
const TURN: [f64; 2] = [0.1 * PI / 180.0, 0.5 * PI / 180.0];

/// The masses that each joint carries.
pub(super) struct Leverage {
    height: f64,                // m, of the centre of mass
    mass: f64,                  // kg
    tall: f64,                  // m, the body
    moments: Vec<(DVec3, f64)>, // (joints) kg m and kg m², about it
    reach: Vec<f64>,            // (joints) m, to the farthest joint beyond it
}

impl Leverage {
    pub(super) fn new(body: &Body) -> Leverage {
        let mut moments = vec![(DVec3::ZERO, 0.0); body.joints.len()];
        let mut height = 0.0;
        for segment in &body.segments {
            let centre = body.joints[segment.joint].rest + segment.centre;
            height += segment.mass * centre.y;
            let mut at = Some(segment.joint);
            while let Some(joint) = at {
                let arm = centre - body.joints[joint].rest;
                moments[joint].0 += arm * segment.mass;
                moments[joint].1 += segment.mass * arm.length_squared();
                at = body.joints[joint].parent;
            }
        }
        let mut reach = vec![0.0_f64; body.joints.len()];
        for joint in &body.joints {
            let mut at = joint.parent;
            while let Some(above) = at {
                reach[above] = reach[above].max(joint.rest.distance(body.joints[above].rest));
                at = body.joints[above].parent;
            }
        }
        let mass = body.mass.max(1e-6);
        Leverage { height: (height / mass).max(1e-3), mass, tall: body.height, moments, reach }
    }

    /// m/s²: what the hips' acceleration may be off by.
    pub(super) fn place(&self) -> f64 {
        ZMP[0] * GRAVITY / self.height
    }

    /// m, to the farthest joint that a joint carries; of one that carries none the end of what it moves.
    pub(super) fn reach(&self, joint: usize) -> f64 {
        self.reach[joint].max(LEAST_REACH * self.tall)
    }

    /// rad: what a joint's turn may be off by, for the eye.
    pub(super) fn seen(&self, joint: usize) -> f64 {
        (PLACE * self.tall / self.reach[joint].max(1e-6)).clamp(TURN[0], TURN[1])
    }

    /// rad/s²: what a joint's turning may be off by; infinite where it carries nothing.
    pub(super) fn turn(&self, joint: usize) -> f64 {
        let (first, second) = self.moments[joint];
        ZMP[1] * GRAVITY * self.mass / (first.length() * self.height + second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Role;

    #[test]
    fn a_trunk_may_be_off_by_less_than_an_arm_and_a_finger_by_more_than_both() {
        let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
        let rig = crate::rig::load_bytes("builtin", crate::rig::mannequin::BUILTIN, &alone, None).expect("it loads");
        let leverage = Leverage::new(&rig.body);
        let turn = |role: Role| leverage.turn(rig.body.joint(role).expect("it has one"));
        let (trunk, arm, hand) = (turn(Role::Spine), turn(Role::LeftUpperArm), turn(Role::LeftHand));
        assert!(3.0 * trunk < arm && 10.0 * arm < hand, "{trunk} {arm} {hand} rad/s²");
        // 1.5 mm of 9.81 m/s² over a centre of mass at about a metre.
        assert!((leverage.place() - 0.015).abs() < 0.003, "{} m/s²", leverage.place());
    }
}
