//! The nodes that carry some points of the body (what a foot's contact holds, a wrist, the head), evaluated from keys alone.
//!
//! Scenario space, m. Only the chains from the scene's root to the points are computed: this runs thousands of times a clip.

use super::track::{Value, quaternion, vector};
use crate::measure::support::held_points;
use crate::model::{Side, report::Part};
use crate::rig::Rig;
use crate::rig::animate::Poser;
use glam::{DAffine3, DQuat, DVec3};
use std::ops::Range;

/// The chain of nodes that carries a few points.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    base: DAffine3,               // scenario space from the document's world
    new_root: [Option<usize>; 2], // tracks: translation, rotation
    links: Vec<Link>,             // parents first
    points: Vec<(usize, DVec3)>,  // set after set; link, point in its node
    ends: Vec<usize>,             // of each set, in them
}

/// The sets of a foot's chain, in the order of the enumeration.
pub(super) const PARTS: [Part; 3] = [Part::Heel, Part::Ball, Part::Flat];

/// Where the tracks of a node are found: its translation (false) or its rotation (true).
pub(super) type TrackOf<'a> = &'a dyn Fn(usize, bool) -> Option<usize>;

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

impl Chain {
    /// The chain of one foot, whose sets are the points that a contact of each part holds, in the order of [`Part`].
    pub(super) fn of_foot(rig: &Rig, poser: &Poser, side: Side, track: TrackOf, new_root: [Option<usize>; 2]) -> Chain {
        let points = |part| held_points(&rig.body, side, part).into_iter().map(|point| (point.joint, point.offset));
        let sets = PARTS.map(|part| points(part).collect());
        Chain::to(rig, poser, &sets, track, new_root)
    }

    /// The chain of these sets of points: a joint, and m from it at rest.
    pub(super) fn to(
        rig: &Rig,
        poser: &Poser,
        sets: &[Vec<(usize, DVec3)>],
        track: TrackOf,
        new_root: [Option<usize>; 2],
    ) -> Chain {
        let mut chain = Chain {
            base: rig.scenario_from_document(),
            new_root,
            links: Vec::new(),
            points: Vec::new(),
            ends: Vec::new(),
        };
        for set in sets {
            for (joint, offset) in set {
                let node = node_of(rig, *joint);
                let local = poser.reference_globals()[node].inverse();
                let place = local.transform_point3(rig.body.joints[*joint].rest + *offset);
                let link = chain.link(rig, poser, track, node);
                chain.points.push((link, place));
            }
            chain.ends.push(chain.points.len());
        }
        let first = sets.iter().flatten().next();
        if first.is_none_or(|(joint, _)| !poser.under_new_root(node_of(rig, *joint))) {
            chain.new_root = [None, None];
        }
        chain
    }

    fn link(&mut self, rig: &Rig, poser: &Poser, track: TrackOf, node: usize) -> usize {
        if let Some(link) = self.links.iter().position(|link| link.node == node) {
            return link;
        }
        let parent = rig.nodes[node].parent.map(|parent| self.link(rig, poser, track, parent));
        let tracks = [track(node, false), track(node, true)];
        self.links.push(Link { node, parent, rest: poser.reference()[node], tracks });
        self.links.len() - 1
    }

    /// The tracks that move its points.
    pub(super) fn tracks(&self) -> Vec<usize> {
        let links = self.links.iter().flat_map(|link| link.tracks);
        links.chain(self.new_root).flatten().collect()
    }

    /// The points that a contact of `part` holds, with the value of each track as `value` gives it.
    pub(super) fn held(&self, part: Part, value: &dyn Fn(usize) -> Value) -> Held {
        let places = self.places(part as usize, value);
        let first = places.first().copied().unwrap_or_default();
        Held([first, places.get(1).copied().unwrap_or(first)])
    }

    /// How many sets it has.
    pub(super) fn sets(&self) -> usize {
        self.ends.len()
    }

    /// Which of all points a set's are; none where there is no such set.
    pub(super) fn points_of(&self, set: usize) -> Range<usize> {
        let end = self.ends.get(set).copied().unwrap_or(self.points.len());
        let start = if set == 0 { 0 } else { self.ends.get(set - 1).copied().unwrap_or(end) };
        start..end
    }

    /// The points of a set, with the value of each track as `value` gives it.
    pub(super) fn places(&self, set: usize, value: &dyn Fn(usize) -> Value) -> Vec<DVec3> {
        self.all_places(value).drain(self.points_of(set)).collect()
    }

    /// All points, set after set.
    pub(super) fn all_places(&self, value: &dyn Fn(usize) -> Value) -> Vec<DVec3> {
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
        self.points.iter().map(|(link, point)| globals[*link].transform_point3(*point)).collect()
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
