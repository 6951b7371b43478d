//! The nodes that carry one foot, and the points of it that a contact holds, evaluated from keys alone.
//!
//! Scenario space, m. Only the chain from the scene's root to the foot is computed: this runs thousands of times a clip.

use super::keys::{quaternion, vector};
use crate::model::{Side, report::Part};
use crate::rig::Rig;
use crate::rig::animate::Poser;
use glam::{DAffine3, DQuat, DVec3};

/// One foot's chain of nodes.
#[derive(Clone, Debug)]
pub(super) struct LegChain {
    base: DAffine3,               // scenario space from the document's world
    new_root: [Option<usize>; 2], // tracks: translation, rotation
    links: Vec<Link>,             // parents first
    ankle: (usize, DVec3),        // link, point in its node
    ball: (usize, DVec3),
    heel: (usize, DVec3),
}

#[derive(Clone, Debug)]
struct Link {
    node: usize,
    parent: Option<usize>, // link
    rest: crate::rig::Trs,
    tracks: [Option<usize>; 2],
}

/// Where the held points are: one or two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held([DVec3; 2]);

impl Held {
    /// m, how far the farthest of the points has moved.
    pub(super) fn distance(&self, other: &Held) -> f64 {
        self.0[0].distance(other.0[0]).max(self.0[1].distance(other.0[1]))
    }
}

impl LegChain {
    /// The chain of one foot; `track` finds the track of a node's translation (false) or rotation (true).
    pub(super) fn new(
        rig: &Rig,
        poser: &Poser,
        side: Side,
        track: &dyn Fn(usize, bool) -> Option<usize>,
        new_root: [Option<usize>; 2],
    ) -> LegChain {
        let foot = &rig.body.feet[side as usize];
        let rest = rig.body.joints[foot.ankle].rest;
        let along = |length: f64| DVec3::new(foot.forward.x * length, -foot.ankle_height, foot.forward.y * length);
        let ankle = node_of(rig, foot.ankle);
        let (ball, ball_point) = match foot.toe {
            Some(toe) => (node_of(rig, toe), rig.body.joints[toe].rest),
            None => (ankle, rest + along(foot.ball)),
        };
        let mut chain = LegChain {
            base: rig.scenario_from_document(),
            new_root,
            links: Vec::new(),
            ankle: (0, rest),
            ball: (0, rest),
            heel: (0, rest),
        };
        let globals = poser.reference_globals();
        let local = |node: usize, point: DVec3| globals[node].inverse().transform_point3(point);
        chain.ankle = (chain.link(rig, poser, track, ankle), local(ankle, rest));
        chain.ball = (chain.link(rig, poser, track, ball), local(ball, ball_point));
        chain.heel = (chain.ankle.0, local(ankle, rest + along(foot.heel)));
        if !poser.under_new_root(ankle) {
            chain.new_root = [None, None];
        }
        chain
    }

    fn link(&mut self, rig: &Rig, poser: &Poser, track: &dyn Fn(usize, bool) -> Option<usize>, node: usize) -> usize {
        if let Some(link) = self.links.iter().position(|link| link.node == node) {
            return link;
        }
        let parent = rig.nodes[node].parent.map(|parent| self.link(rig, poser, track, parent));
        let tracks = [track(node, false), track(node, true)];
        self.links.push(Link { node, parent, rest: poser.reference()[node], tracks });
        self.links.len() - 1
    }

    /// The tracks that move this foot.
    pub(super) fn tracks(&self) -> Vec<usize> {
        let links = self.links.iter().flat_map(|link| link.tracks);
        links.chain(self.new_root).flatten().collect()
    }

    /// The points that a contact of `part` holds, with the value of each track as `value` gives it.
    pub(super) fn held(&self, part: Part, value: &dyn Fn(usize) -> [f32; 4]) -> Held {
        let mut base = self.base;
        if self.new_root.iter().any(Option::is_some) {
            let translation = self.new_root[0].map_or(DVec3::ZERO, |track| vector(&value(track)));
            let rotation = self.new_root[1].map_or(DQuat::IDENTITY, |track| quaternion(&value(track)));
            base = self.base * DAffine3::from_rotation_translation(rotation, translation);
        }
        let mut globals: Vec<DAffine3> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let translation = link.tracks[0].map_or(link.rest.translation, |track| vector(&value(track)));
            let rotation = link.tracks[1].map_or(link.rest.rotation, |track| quaternion(&value(track)));
            let local = DAffine3::from_scale_rotation_translation(link.rest.scale, rotation, translation);
            globals.push(link.parent.map_or(base, |parent| globals[parent]) * local);
        }
        let place = |(link, point): (usize, DVec3)| globals[link].transform_point3(point);
        match part {
            Part::Flat => Held([place(self.ankle), place(self.ball)]),
            Part::Ball => Held([place(self.ball); 2]),
            Part::Heel => Held([place(self.heel); 2]),
        }
    }
}

/// The node that a joint is rigid with.
fn node_of(rig: &Rig, joint: usize) -> usize {
    let mut at = Some(joint);
    while let Some(joint) = at {
        if let Some(node) = rig.joint_nodes.get(joint).copied().flatten().filter(|_| rig.body.joints[joint].animated) {
            return node;
        }
        at = rig.body.joints[joint].parent;
    }
    rig.hips_node()
}
