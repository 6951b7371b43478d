//! A rig whose character stands on longer or shorter legs, for one clip. Scenario space and the nodes' own.
//!
//! The nodes of thighs and shanks are scaled alike in every direction and those of the feet scaled back, so whatever
//! hangs between them (twist bones, guards, meshes) follows without shear and a foot stays the foot that it was. A clip
//! holds those scales as constant channels: other clips show the character as it is. The document does not change.

use super::Rig;
use super::animate::ik_role;
use glam::DAffine3;

/// m: a node is moved that is farther than this from where it should be.
const MOVED: f64 = 1e-6;

impl Rig {
    /// The same rig on legs `scale` times as long.
    pub fn with_leg_scale(&self, scale: f64) -> Rig {
        let mut rig = self.clone();
        rig.body = self.body.with_leg_scale(scale);
        let before = self.bind_globals();
        let base = self.scenario_from_document();
        let joints = self.joints_of_nodes();
        let mut globals: Vec<DAffine3> = vec![base; self.nodes.len()];
        let mut grown = vec![1.0; self.nodes.len()];
        for node in self.parents_first() {
            let (above, inherited) =
                self.nodes[node].parent.map_or((base, 1.0), |parent| (globals[parent], grown[parent]));
            let bind = &mut rig.nodes[node].bind;
            grown[node] = inherited;
            if let Some(joint) = joints[node] {
                let wanted = if self.body.grows(joint) { scale } else { 1.0 };
                if inherited != wanted {
                    bind.scale *= wanted / inherited;
                    rig.leg_scales.insert(node, wanted / inherited);
                }
                grown[node] = wanted;
                let offset = before[node].translation - self.body.joints[joint].rest;
                let place = rig.body.joints[joint].rest + offset * wanted;
                if above.transform_point3(bind.translation).distance(place) > MOVED {
                    bind.translation = above.inverse().transform_point3(place);
                }
            }
            globals[node] = above * rig.nodes[node].bind.affine();
        }
        rig
    }

    /// (nodes) the joint of the body that each one is, or follows as an engine's IK bone.
    fn joints_of_nodes(&self) -> Vec<Option<usize>> {
        let mut joints: Vec<Option<usize>> = self
            .nodes
            .iter()
            .map(|node| node.name.as_deref().and_then(ik_role).and_then(|role| self.body.joint(role)))
            .collect();
        for (joint, node) in self.joint_nodes.iter().enumerate() {
            if let Some(node) = node.filter(|node| self.body.joints[joint].animated && *node < joints.len()) {
                joints[node] = Some(joint);
            }
        }
        joints
    }
}
