//! The mesh by what it moves with: the vertices of a role, of a foot, of the skull; and the crown of a head.
//!
//! Scenario space, metres, at the bind pose. A node without a role counts for the mapped one above it.

use super::body::{BodyInput, leg_roles};
use super::sole::FootVertex;
use crate::model::{Role, Side};
use glam::DVec3;
use std::collections::BTreeMap;

/// Whether a joint under the head moves a part of the skull: a robot's eyes may be its highest part.
fn in_skull(role: Role) -> bool {
    matches!(role, Role::LeftEye | Role::RightEye | Role::Jaw)
}

/// The mesh by what it moves with.
pub(super) struct Skin {
    /// Place, and shares by mapped role.
    vertices: Vec<SkinVertex>,
    /// (nodes) the mapped role that each node moves with.
    owners: Vec<Option<Role>>,
}

struct SkinVertex {
    place: DVec3,
    shares: [(Option<Role>, f64); 4],
    /// The share that hangs on the head's own node or on the eyes and the jaw, not on hair or a hat under it.
    skull: f64,
}

impl Skin {
    pub(super) fn new(input: &BodyInput) -> Skin {
        let mut role_of: BTreeMap<usize, Role> = BTreeMap::new();
        for (role, (node, _)) in input.bones {
            role_of.entry(*node).or_insert(*role);
        }
        let owner = |node: usize| -> Option<Role> {
            let mut at = node;
            // No chain is longer than there are nodes; a loop in a broken file ends here.
            for _ in 0..=input.parents.len() {
                if let Some(role) = role_of.get(&at) {
                    return Some(*role);
                }
                at = (*input.parents.get(at)?)?;
            }
            None
        };
        let owners: Vec<Option<Role>> = (0..input.parents.len()).map(owner).collect();
        let head = input.bones.get(&Role::Head).map(|bone| bone.0);
        let vertices = input
            .mesh
            .iter()
            .flat_map(|part| part.positions.iter().zip(&part.weights))
            .filter(|(place, _)| place.is_finite())
            .map(|(place, weights)| SkinVertex {
                place: *place,
                shares: weights.map(|(node, weight)| (owners.get(node).copied().flatten(), weight)),
                skull: weights
                    .iter()
                    .filter(|(node, _)| {
                        Some(*node) == head || owners.get(*node).copied().flatten().is_some_and(in_skull)
                    })
                    .map(|entry| entry.1)
                    .sum(),
            })
            .collect();
        Skin { vertices, owners }
    }

    /// Whether nothing is drawn.
    pub(super) fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The share of a vertex with those weights that moves with roles of some kind.
    pub(super) fn share(&self, weights: &[(usize, f64); 4], kind: impl Fn(Role) -> bool) -> f64 {
        let of_kind = |node: &usize| self.owners.get(*node).copied().flatten().is_some_and(&kind);
        weights.iter().filter(|(node, _)| of_kind(node)).map(|entry| entry.1).sum()
    }

    /// Vertices of which a role has more than half.
    pub(super) fn of(&self, role: Role) -> impl Iterator<Item = DVec3> + '_ {
        self.vertices.iter().filter(move |vertex| vertex.share(role) > 0.5).map(|vertex| vertex.place)
    }

    /// Vertices of which roles of some kind have more than half together.
    pub(super) fn moved_by(&self, kind: &dyn Fn(Role) -> bool) -> Vec<DVec3> {
        let share = |vertex: &&SkinVertex| {
            vertex.shares.iter().filter(|entry| entry.0.is_some_and(kind)).map(|entry| entry.1).sum::<f64>() > 0.5
        };
        self.vertices.iter().filter(share).map(|vertex| vertex.place).collect()
    }

    /// The vertices of the head; `itself`: without what hangs on nodes of its own, hair and hats.
    pub(super) fn head(&self, itself: bool) -> Vec<DVec3> {
        let hung = |vertex: &SkinVertex| {
            let of_head = |role: Role| role == Role::Head || in_skull(role);
            vertex.shares.iter().filter(|entry| entry.0.is_some_and(of_head)).map(|entry| entry.1).sum()
        };
        let share = |vertex: &&SkinVertex| if itself { vertex.skull } else { hung(vertex) } > 0.5;
        self.vertices.iter().filter(share).map(|vertex| vertex.place).collect()
    }

    /// The vertices of a foot; where no node is the foot, the end of the shank's.
    pub(super) fn foot(&self, side: Side, ankle: DVec3, has_foot: bool) -> Vec<FootVertex> {
        let [_, shank, foot, toes] = leg_roles(side);
        self.vertices
            .iter()
            .filter_map(|vertex| {
                let (of_foot, of_toes) = (vertex.share(foot), vertex.share(toes));
                let chosen = if has_foot {
                    of_foot + of_toes > 0.5
                } else {
                    vertex.share(shank) + of_toes > 0.5 && vertex.place.y < ankle.y
                };
                chosen.then_some(FootVertex { offset: vertex.place - ankle, toe: of_toes > of_foot && of_toes >= 0.4 })
            })
            .collect()
    }
}

impl SkinVertex {
    fn share(&self, role: Role) -> f64 {
        self.shares.iter().filter(|entry| entry.0 == Some(role)).map(|entry| entry.1).sum()
    }
}

/// The top of a head without what is thin on it: antennas, feathers, a spike of hair.
pub(super) fn crown(points: &[DVec3]) -> Option<f64> {
    let mut sorted: Vec<DVec3> = points.to_vec();
    sorted.sort_by(|a, b| b.y.total_cmp(&a.y));
    let (first, last) = (sorted.first()?, sorted.last()?);
    let spread = |low: DVec3, high: DVec3| ((high.x - low.x) * (high.z - low.z)).sqrt();
    let fold = |points: &[DVec3]| {
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        spread(low, high)
    };
    let whole = fold(&sorted);
    let (mut low, mut high) = (*first, *first);
    for point in &sorted {
        low = low.min(*point);
        high = high.max(*point);
        if spread(low, high) >= 0.2 * whole {
            let trimmed = first.y - point.y;
            // A round skull is thin at its very top too: trim only what stands out.
            let stands_out = trimmed > 0.2 * (first.y - last.y);
            return Some(if stands_out { point.y } else { first.y });
        }
    }
    Some(first.y)
}
