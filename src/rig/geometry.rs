//! A humanoid by hierarchy and places alone: no names. The two lowest chains that hang from one node are the legs, the
//! longest mirrored pair above it the arms, what goes up between them the spine, the neck and the head.
//!
//! Document world, any of six ups. Which side is left is a guess that `space::stance` corrects by the feet. Fingers,
//! eyes and jaw are left out.

use super::bind::Skin;
use super::names::assign_spine;
use super::{Document, RigNode, space};
use crate::maths::real;
use crate::model::Role;
use glam::DVec3;
use std::collections::BTreeMap;

/// Joints beyond this are no single character.
const MOST_JOINTS: usize = 1500;
/// A clavicle starts nearer to the middle than this, in arm lengths.
const CLAVICLE: f64 = 0.16;
/// Cost of leaving out a node between two bones.
const SKIPPED: f64 = 0.3;
/// Cost of leaving out a node behind the last bone.
const TAIL: f64 = 0.1;

/// The bones; else why what looks like them is no human, if anything does.
pub fn guess(
    document: &Document,
    nodes: &[RigNode],
    skins: &[Skin],
    positions: &[DVec3],
) -> Result<BTreeMap<Role, usize>, Option<String>> {
    let tree = Tree::new(document, nodes, skins, positions);
    if tree.joints.len() > MOST_JOINTS {
        return Err(Some(format!("{} joints are too many to find a human among", tree.joints.len())));
    }
    let mut reason = None;
    for up in [DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::NEG_X, DVec3::NEG_Y] {
        let Some(bones) = tree.guess(up) else { continue };
        match space::not_human(&bones, positions) {
            None => return Ok(bones),
            Some(why) => reason = reason.or(Some(why)),
        }
    }
    Err(reason)
}

/// The joints as a tree of their own.
struct Tree<'a> {
    joints: Vec<usize>,
    /// (nodes)
    parent: Vec<Option<usize>>,
    /// (nodes)
    children: Vec<Vec<usize>>,
    at: &'a [DVec3],
}

/// A pair of limbs, each as its path from the trunk to the tip.
struct Pair {
    from: usize,
    limbs: [Vec<usize>; 2],
}

impl<'a> Tree<'a> {
    fn new(document: &Document, nodes: &[RigNode], skins: &[Skin], at: &'a [DVec3]) -> Tree<'a> {
        let mut is_joint = vec![false; nodes.len()];
        skins.iter().flat_map(|skin| &skin.joints).for_each(|joint| is_joint[*joint] = true);
        if !is_joint.contains(&true) {
            for ((joint, node), json) in is_joint.iter_mut().zip(nodes).zip(document.list("nodes")) {
                *joint = node.mesh.is_none() && json.get("camera").is_none();
            }
        }
        let joints: Vec<usize> = super::nodes::order(nodes).into_iter().filter(|node| is_joint[*node]).collect();
        let (mut parent, mut children) = (vec![None; nodes.len()], vec![Vec::new(); nodes.len()]);
        for joint in joints.iter().take(MOST_JOINTS + 1) {
            let above =
                std::iter::successors(nodes[*joint].parent, |node| nodes[*node].parent).find(|node| is_joint[*node]);
            parent[*joint] = above;
            if let Some(above) = above {
                children[above].push(*joint);
            }
        }
        Tree { joints, parent, children, at }
    }

    fn guess(&self, up: DVec3) -> Option<BTreeMap<Role, usize>> {
        let height = |node: usize| self.at[node].dot(up);
        let low = self.joints.iter().map(|node| height(*node)).fold(f64::MAX, f64::min);
        let high = self.joints.iter().map(|node| height(*node)).fold(f64::MIN, f64::max);
        let size = high - low;
        if !(size > 1e-9 && size.is_finite()) {
            return None;
        }
        let legs = self.legs(up, low, size)?;
        let [a, b] = [legs.limbs[0][0], legs.limbs[1][0]];
        let flat = |vector: DVec3| vector - up * vector.dot(up);
        let (middle, across) = ((self.at[a] + self.at[b]) * 0.5, flat(self.at[a] - self.at[b]).normalize_or_zero());
        let lateral = |node: usize| (self.at[node] - middle).dot(across);
        let mut upper: Vec<bool> = vec![false; self.at.len()];
        self.joints.iter().for_each(|node| upper[*node] = true);
        for leg in [a, b] {
            self.under(leg).into_iter().for_each(|node| upper[node] = false);
        }
        let arms = self.arms(size, &|node| height(node) - low, &upper, &lateral)?;
        for arm in &arms.limbs {
            self.under(arm[0]).into_iter().for_each(|node| upper[node] = false);
        }
        let shoulder = arms.limbs.iter().map(|arm| height(arm[0])).fold(f64::MAX, f64::min);
        let crown = self.joints.iter().copied().filter(|node| upper[*node] && lateral(*node).abs() < 0.08 * size);
        let crown = crown.max_by(|a, b| height(*a).total_cmp(&height(*b)))?;
        let (hips, trunk) = self.trunk(legs.from, crown, size)?;
        let joined = trunk.iter().position(|node| *node == arms.from);
        let shoulders = joined
            .map_or_else(|| trunk.iter().filter(|node| height(**node) < shoulder - 0.01 * size).count(), |at| at + 1);
        let (spine, neck) = trunk.split_at(shoulders.min(trunk.len().saturating_sub(1)));
        let mut bones = BTreeMap::from([(Role::Hips, hips)]);
        assign_spine(&mut bones, spine);
        self.head(neck, &mut bones)?;
        let front = across.cross(up);
        let flip = front.z < -0.1 || (front.z.abs() <= 0.1 && front.x < 0.0);
        for (at, leg) in legs.limbs.iter().enumerate() {
            self.leg(leg, (at == 0) != flip, up, &mut bones);
        }
        for (at, arm) in arms.limbs.iter().enumerate() {
            self.arm(arm, (at == 0) != flip, &lateral, &mut bones)?;
        }
        Role::REQUIRED.iter().all(|role| bones.contains_key(role)).then_some(bones)
    }

    /// The node from which the two lowest mirrored chains hang.
    fn legs(&self, up: DVec3, low: f64, size: f64) -> Option<Pair> {
        let height = |node: usize| self.at[node].dot(up);
        let mut best: Option<(f64, Pair)> = None;
        for from in self.joints.iter().copied() {
            let chains: Vec<Vec<usize>> = self.children[from]
                .iter()
                .filter(|child| height(**child) > low + 0.2 * size)
                .map(|child| self.path_to(*child, |node| -height(node)))
                .filter(|path| path.len() >= 2 && height(path[path.len() - 1]) < low + 0.25 * size)
                .collect();
            for (at, one) in chains.iter().enumerate() {
                for other in &chains[at + 1..] {
                    let (long, short) = (self.length(one), self.length(other));
                    let apart = self.at[one[0]] - self.at[other[0]];
                    let apart = (apart - up * apart.dot(up)).length();
                    if long.max(short) > 1.3 * long.min(short) || apart < 0.02 * size {
                        continue;
                    }
                    let tips = [one, other].map(|path| height(path[path.len() - 1]) - low);
                    let uneven = (one.len() as f64 - other.len() as f64).abs() * 0.1;
                    let cost = (tips[0] + tips[1]) / size + real::ln(long / short).abs() + uneven;
                    if best.as_ref().is_none_or(|(least, _)| cost < *least - 1e-9) {
                        best = Some((cost, Pair { from, limbs: [one.clone(), other.clone()] }));
                    }
                }
            }
        }
        best.map(|(_, pair)| pair)
    }

    /// The longest mirrored pair that is no leg; the first limb on the side of the first leg. Those of a quadruped count
    /// too, so that it can be refused by its name.
    fn arms(
        &self,
        size: f64,
        over_ground: &dyn Fn(usize) -> f64,
        upper: &[bool],
        lateral: &dyn Fn(usize) -> f64,
    ) -> Option<Pair> {
        let mut best: Option<(f64, Pair)> = None;
        for from in self.joints.iter().copied().filter(|node| upper[*node]) {
            let chains: Vec<Vec<usize>> = self.children[from]
                .iter()
                .filter(|child| upper[**child] && over_ground(**child) > 0.2 * size)
                .map(|child| self.path_to(*child, |node| self.at[node].distance(self.at[*child])))
                .filter(|path| path.len() >= 2)
                .collect();
            for one in &chains {
                for other in &chains {
                    let tips = [lateral(one[one.len() - 1]), lateral(other[other.len() - 1])];
                    let reach = self.length(one).min(self.length(other));
                    let alike = self.length(one).max(self.length(other)) < 1.3 * reach;
                    if !(tips[0] > 0.04 * size && tips[1] < -0.04 * size && alike && reach > 0.12 * size) {
                        continue;
                    }
                    if best.as_ref().is_none_or(|(longest, _)| reach > *longest + 1e-9) {
                        best = Some((reach, Pair { from, limbs: [one.clone(), other.clone()] }));
                    }
                }
            }
        }
        best.map(|(_, pair)| pair)
    }

    /// The hips, and the nodes from above them to the crown.
    fn trunk(&self, pelvis: usize, crown: usize, size: f64) -> Option<(usize, Vec<usize>)> {
        let above: Vec<usize> = std::iter::successors(Some(pelvis), |node| self.parent[*node]).collect();
        let mut path: Vec<usize> = Vec::new();
        let mut at = crown;
        while !above.contains(&at) {
            path.push(at);
            at = self.parent[at]?;
        }
        path.reverse();
        // A node over the hips, in the same place and with nothing else on it, moves the same body: the upper one counts.
        let mut hips = at;
        while let Some(over) = self.parent[hips]
            && self.children[over].len() == 1
            && self.at[over].distance(self.at[hips]) < 1e-3 * size
        {
            hips = over;
        }
        Some((hips, path))
    }

    /// Neck and head of the nodes above the shoulders.
    fn head(&self, neck: &[usize], bones: &mut BTreeMap<Role, usize>) -> Option<()> {
        let branching = neck.iter().position(|node| self.children[*node].len() > 1);
        let head = match (branching, neck.len()) {
            (Some(at), _) => at,
            (None, 0) => return None,
            (None, 1) => 0,
            // neck, head; a third is the end of the head.
            (None, 2) => 1,
            (None, count) => count - 2,
        };
        bones.insert(Role::Head, neck[head]);
        if head > 0 {
            bones.insert(Role::Neck, neck[0]);
        }
        Some(())
    }

    fn leg(&self, path: &[usize], left: bool, up: DVec3, bones: &mut BTreeMap<Role, usize>) {
        let roles = [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes];
        let place = |at: usize| self.at[path[at]];
        let low = path.iter().map(|node| self.at[*node].dot(up)).fold(f64::MAX, f64::min);
        let count = path.len().min(12);
        let mut best: (f64, Vec<usize>) = (f64::MAX, vec![0, 1]);
        for first in 0..count.saturating_sub(2).min(2) {
            for knee in first + 1..count {
                for foot in knee + 1..count {
                    let (thigh, shank) = (place(first).distance(place(knee)), place(knee).distance(place(foot)));
                    let over = (place(foot).dot(up) - low) / (thigh + shank).max(1e-9);
                    let bones = real::ln(thigh.max(1e-9) / shank.max(1e-9)).abs() + 3.0 * (over - 0.4).max(0.0);
                    let skipped = (foot - first - 2) as f64 * SKIPPED + first as f64 * 0.5;
                    for toes in foot..count {
                        let ahead = place(toes) - place(foot);
                        let cost = if toes == foot {
                            0.15 + (count - 1 - foot) as f64 * TAIL
                        } else {
                            let steep = ahead.dot(up).abs() > 0.95 * ahead.length();
                            let stub = ahead.length() < 0.04 * (thigh + shank);
                            (toes - foot - 1) as f64 * SKIPPED
                                + (count - 1 - toes) as f64 * TAIL
                                + if steep || stub { 0.6 } else { 0.0 }
                        };
                        if bones + skipped + cost < best.0 - 1e-9 {
                            let mut chosen = vec![first, knee, foot];
                            if toes > foot {
                                chosen.push(toes);
                            }
                            best = (bones + skipped + cost, chosen);
                        }
                    }
                }
            }
        }
        for (role, at) in roles.iter().zip(best.1) {
            bones.insert(if left { *role } else { role.mirrored() }, path[at]);
        }
    }

    fn arm(
        &self,
        path: &[usize],
        left: bool,
        lateral: &dyn Fn(usize) -> f64,
        bones: &mut BTreeMap<Role, usize>,
    ) -> Option<()> {
        let place = |at: usize| self.at[path[at]];
        // Where fingers part, there is the hand.
        let parting = (1..path.len()).find(|at| self.children[path[*at]].len() >= 3);
        let count = parting.map_or(path.len(), |hand| hand + 1).min(12);
        let mut best: (f64, Vec<(Role, usize)>) = (f64::MAX, Vec::new());
        for first in 0..count.saturating_sub(1).min(2) {
            for elbow in first + 1..count {
                for hand in elbow..count {
                    let upper = place(first).distance(place(elbow));
                    let lower = if hand > elbow { place(elbow).distance(place(hand)) } else { upper };
                    let mut cost = real::ln(upper.max(1e-9) / lower.max(1e-9)).abs();
                    cost += (hand.max(elbow + 1) - first - 2) as f64 * SKIPPED + (count - 1 - hand) as f64 * TAIL;
                    cost += if hand == elbow { 0.4 } else { 0.0 };
                    // More behind the hand than fingers: the hand was taken too early.
                    let behind = self.length(&path[hand..count]);
                    cost += if hand > elbow && behind > 0.6 * (upper + lower) { 1.0 } else { 0.0 };
                    let middle = lateral(path[0]).abs() / (upper + lower).max(1e-9);
                    cost += match first {
                        0 if middle < 0.1 => 1.0,
                        1 if middle > CLAVICLE => 1.0,
                        _ => 0.0,
                    };
                    if cost < best.0 - 1e-9 {
                        let mut chosen = vec![(Role::LeftUpperArm, first), (Role::LeftLowerArm, elbow)];
                        if first == 1 {
                            chosen.push((Role::LeftShoulder, 0));
                        }
                        if hand > elbow {
                            chosen.push((Role::LeftHand, hand));
                        }
                        best = (cost, chosen);
                    }
                }
            }
        }
        if best.1.is_empty() {
            return None;
        }
        for (role, at) in best.1 {
            bones.insert(if left { role } else { role.mirrored() }, path[at]);
        }
        Some(())
    }

    /// That node and everything below it.
    fn under(&self, top: usize) -> Vec<usize> {
        let mut found = vec![top];
        let mut at = 0;
        while at < found.len() {
            found.extend(&self.children[found[at]]);
            at += 1;
        }
        found
    }

    /// From `top` to the node below it that scores highest.
    fn path_to(&self, top: usize, score: impl Fn(usize) -> f64) -> Vec<usize> {
        let mut tip = top;
        for node in self.under(top) {
            if score(node) > score(tip) + 1e-12 {
                tip = node;
            }
        }
        let mut path = vec![tip];
        while tip != top {
            match self.parent[tip] {
                Some(parent) => tip = parent,
                None => break,
            }
            path.push(tip);
        }
        path.reverse();
        path
    }

    fn length(&self, path: &[usize]) -> f64 {
        path.windows(2).map(|pair| self.at[pair[0]].distance(self.at[pair[1]])).sum()
    }
}
