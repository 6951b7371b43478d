//! The mass matrix of a tree as LᵀDL, without fill: row i holds freedom i against the freedoms from the root to it only
//! (Featherstone 2008, ch. 6).

use super::tree::{DEEPEST, MOST, Tree};

/// A number for each freedom.
pub type Vector = [f64; MOST];

/// The matrix, and once factored L below the diagonal, 1/D and its root.
#[derive(Clone, Debug)]
pub(super) struct Factors {
    pub(super) rows: Vec<[f64; DEEPEST]>,
    pub(super) inverse: Vector,
    pub(super) root: Vector,
}

impl Factors {
    pub(super) fn new(tree: &Tree) -> Factors {
        Factors { rows: vec![[0.0; DEEPEST]; tree.freedoms()], inverse: [0.0; MOST], root: [0.0; MOST] }
    }

    /// Factors what stands in the rows.
    pub(super) fn factor(&mut self, tree: &Tree) {
        for k in (0..tree.freedoms()).rev() {
            let depth = tree.depth[k].min(DEEPEST - 1);
            let chain = &tree.chain[k];
            let (lower, upper) = self.rows.split_at_mut(k);
            let row = &mut upper[0];
            let inverse = 1.0 / row[depth];
            for e in (0..depth).rev() {
                let factor = row[e] * inverse;
                let to = &mut lower[usize::from(chain[e])];
                for over in 0..=e {
                    to[over] -= factor * row[over];
                }
                row[e] = factor;
            }
            self.inverse[k] = inverse;
            self.root[k] = inverse.max(0.0).sqrt();
        }
    }

    /// x of H x = b.
    pub(super) fn solve(&self, tree: &Tree, x: &mut Vector) {
        for i in (0..tree.freedoms()).rev() {
            let (value, row, chain) = (x[i], &self.rows[i], &tree.chain[i]);
            for e in 0..tree.depth[i].min(DEEPEST) {
                x[usize::from(chain[e])] -= row[e] * value;
            }
        }
        x.iter_mut().zip(&self.inverse).for_each(|(value, inverse)| *value *= inverse);
        self.back(tree, x);
    }

    /// L⁻¹ z: from the space in which rows are short vectors and the mass matrix is one, with `root` applied, to velocities.
    pub(super) fn back(&self, tree: &Tree, x: &mut Vector) {
        for i in 0..tree.freedoms() {
            let (mut value, row, chain) = (x[i], &self.rows[i], &tree.chain[i]);
            for e in 0..tree.depth[i].min(DEEPEST) {
                value -= row[e] * x[usize::from(chain[e])];
            }
            x[i] = value;
        }
    }

    /// D^-1/2 L⁻ᵀ j of directions that stand on the chain of freedom `last`.
    pub(super) fn halve<const N: usize>(&self, tree: &Tree, last: usize, j: &mut [[f64; N]; DEEPEST]) {
        let chain = &tree.chain[last];
        for e in (0..=tree.depth[last].min(DEEPEST - 1)).rev() {
            let freedom = usize::from(chain[e]);
            let (value, row, root) = (j[e], &self.rows[freedom], self.root[freedom]);
            for over in 0..e {
                for way in 0..N {
                    j[over][way] -= row[over] * value[way];
                }
            }
            for way in 0..N {
                j[e][way] = value[way] * root;
            }
        }
    }
}
