//! The same body on longer or shorter legs: the paper's character-dimension experiment. Scenario space, metres.
//!
//! Thighs and shanks grow alike in every direction about their own joints, so that a skin on them needs one scale and no
//! shear; they weigh what they weighed. Feet and upper body stay as they are, the hips go up or down with the legs.

use super::body::Body;
use super::role::Role;
use glam::DVec3;

impl Body {
    /// Legs `scale` times as long.
    pub fn with_leg_scale(&self, scale: f64) -> Body {
        let mut body = self.clone();
        let mut lift = 0.0;
        for foot in &self.feet {
            let ankle = foot.ankle;
            let Some(hip) = self.hip_of(ankle) else { continue };
            lift += 0.5 * (scale - 1.0) * (self.joints[hip].rest.y - self.joints[ankle].rest.y);
        }
        for (index, joint) in self.joints.iter().enumerate() {
            body.joints[index].rest = match joint.parent {
                Some(parent) => {
                    let grown = if self.grows(parent) { scale } else { 1.0 };
                    body.joints[parent].rest + (joint.rest - self.joints[parent].rest) * grown
                }
                None => joint.rest + DVec3::Y * lift,
            };
        }
        for segment in &mut body.segments {
            if self.grows(segment.joint) {
                segment.centre *= scale;
                segment.inertia *= scale * scale;
            }
        }
        for flesh in &mut body.flesh {
            if self.grows(flesh.joint) {
                flesh.middle *= scale;
                flesh.half *= scale;
            }
        }
        body.height += lift;
        body.leg_length *= scale;
        body
    }

    /// Whether what is rigid with a joint is a part of a leg that grows with it: its thigh or its shank.
    pub fn grows(&self, joint: usize) -> bool {
        use Role::{LeftLowerLeg, LeftUpperLeg, RightLowerLeg, RightUpperLeg};
        matches!(self.joints[joint].role, LeftUpperLeg | LeftLowerLeg | RightUpperLeg | RightLowerLeg)
    }

    /// The topmost growing joint over a foot.
    fn hip_of(&self, foot: usize) -> Option<usize> {
        let mut hip = None;
        let mut at = self.joints[foot].parent;
        while let Some(joint) = at.filter(|joint| self.grows(*joint)) {
            hip = Some(joint);
            at = self.joints[joint].parent;
        }
        hip
    }
}
