//! The nodes that carry one foot, and the points of it that a contact holds, evaluated from keys alone.
//!
//! Scenario space, m. Only the chain from the scene's root to the foot is computed: this runs thousands of times a clip.

use super::track::{quaternion, vector};
use crate::measure::support::held_points;
use crate::model::{Side, report::Part};
use crate::rig::Rig;
use crate::rig::animate::Poser;
use glam::{DAffine3, DQuat, DVec3};

/// One foot's chain of nodes.
#[derive(Clone, Debug)]
pub(super) struct LegChain {
    base: DAffine3,                   // scenario space from the document's world
    new_root: [Option<usize>; 2],     // tracks: translation, rotation
    links: Vec<Link>,                 // parents first
    points: [Vec<(usize, DVec3)>; 3], // flat, ball, heel: link, point in its node
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
    /// The same points in a frame that is turned about the origin.
    pub(super) fn seen_from(self, frame: DQuat) -> Held {
        let back = frame.inverse();
        Held(self.0.map(|point| back * point))
    }

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
        let base = rig.scenario_from_document();
        let mut chain = LegChain { base, new_root, links: Vec::new(), points: [const { Vec::new() }; 3] };
        for part in [Part::Flat, Part::Ball, Part::Heel] {
            for point in held_points(&rig.body, side, part) {
                let node = node_of(rig, point.joint);
                let local = poser.reference_globals()[node].inverse();
                let place = local.transform_point3(rig.body.joints[point.joint].rest + point.offset);
                let link = chain.link(rig, poser, track, node);
                chain.points[part as usize].push((link, place));
            }
        }
        if !poser.under_new_root(node_of(rig, rig.body.feet[side as usize].ankle)) {
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
        let mut places = self.points[part as usize].iter().map(|(link, point)| globals[*link].transform_point3(*point));
        let first = places.next().unwrap_or_default();
        Held([first, places.next().unwrap_or(first)])
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
