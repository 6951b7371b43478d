//! A tree of rigid links: who hangs from whom by which joint, its masses, and the chain of freedoms from the root to each link.
//!
//! SI units. A link's frame has its origin at its joint; all links have the same axes where every joint is at rest.

use super::limits::Range;
use glam::{DMat3, DVec3};

/// The most degrees of freedom that a tree may have.
pub const MOST: usize = 48;
/// The most degrees of freedom from the root to a link, its own included.
pub const DEEPEST: usize = 20;

/// How a link may move against its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// The root: three ways to travel and three to turn, along the world's axes.
    Free,
    /// Three ways to turn, about the parent's axes.
    Ball,
    /// One way to turn.
    Hinge {
        /// A unit vector, the same in both links' frames.
        axis: DVec3,
    },
}

impl Joint {
    /// Degrees of freedom.
    pub fn freedoms(self) -> usize {
        match self {
            Joint::Free => 6,
            Joint::Ball => 3,
            Joint::Hinge { .. } => 1,
        }
    }
}

/// One rigid link.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// The link that it hangs from; the root has none.
    pub parent: Option<usize>,
    /// By which joint.
    pub joint: Joint,
    /// m, its joint in the parent's frame.
    pub anchor: DVec3,
    /// kg.
    pub mass: f64,
    /// m, its centre of mass in its frame.
    pub centre: DVec3,
    /// kg m², about its centre of mass, in its frame.
    pub inertia: DMat3,
    /// How far its joint goes.
    pub range: Range,
}

/// Links with their degrees of freedom numbered from the root outwards.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(super) links: Vec<Link>,
    /// The first freedom of each link.
    pub(super) first: Vec<usize>,
    /// The last freedom of each link: its chain is the link's.
    pub(super) last: Vec<usize>,
    /// Of each freedom: those from the root to it, itself last.
    pub(super) chain: Vec<[u8; DEEPEST]>,
    /// Of each freedom: its place in its own chain.
    pub(super) depth: Vec<usize>,
}

/// Why links are no tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TreeError {
    /// A link stands before its parent, or a link other than the first has no parent or is free.
    #[error("link {0} does not hang from a link before it")]
    Order(usize),
    /// Too many freedoms.
    #[error("more than {MOST} degrees of freedom, or more than {DEEPEST} to link {0}")]
    Large(usize),
    /// A mass, an inertia or a place is no number or not above 0.
    #[error("link {0} has no mass, no inertia or no place")]
    Mass(usize),
}

impl Tree {
    /// Links with parents before children, the root first and free.
    pub fn new(links: Vec<Link>) -> Result<Tree, TreeError> {
        let mut tree =
            Tree { links: Vec::new(), first: Vec::new(), last: Vec::new(), chain: Vec::new(), depth: Vec::new() };
        for (index, link) in links.iter().enumerate() {
            let rooted = (index == 0) == (link.joint == Joint::Free);
            if !rooted || link.parent.is_none() != (index == 0) || link.parent.is_some_and(|parent| parent >= index) {
                return Err(TreeError::Order(index));
            }
            let sound = link.anchor.is_finite() && link.centre.is_finite() && link.inertia.is_finite();
            let turns = [link.inertia.x_axis.x, link.inertia.y_axis.y, link.inertia.z_axis.z];
            if !(sound && link.mass > 0.0 && link.mass.is_finite() && turns.iter().all(|axis| *axis > 0.0)) {
                return Err(TreeError::Mass(index));
            }
            tree.add(index, link)?;
        }
        if links.is_empty() {
            return Err(TreeError::Order(0));
        }
        tree.links = links;
        Ok(tree)
    }

    fn add(&mut self, index: usize, link: &Link) -> Result<(), TreeError> {
        self.first.push(self.chain.len());
        let mut over = link.parent.map(|parent| self.last[parent]);
        for _ in 0..link.joint.freedoms() {
            let (mut chain, mut length) = ([0_u8; DEEPEST], 0);
            if let Some(over) = over {
                (chain, length) = (self.chain[over], self.depth[over] + 1);
            }
            let freedom = self.chain.len();
            if length >= DEEPEST || freedom >= MOST {
                return Err(TreeError::Large(index));
            }
            chain[length] = freedom as u8;
            self.chain.push(chain);
            self.depth.push(length);
            over = Some(freedom);
        }
        self.last.push(self.chain.len() - 1);
        Ok(())
    }

    /// How many degrees of freedom.
    pub fn freedoms(&self) -> usize {
        self.chain.len()
    }

    /// The freedoms of a link's joint.
    pub fn freedoms_of(&self, link: usize) -> std::ops::RangeInclusive<usize> {
        self.first[link]..=self.last[link]
    }
}
