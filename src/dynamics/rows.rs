//! Rows of the contact problem: one direction each in which a tree, and a loose body where it meets one, may be pushed. Solved by
//! projected Gauss-Seidel from the last step's impulses, in the space in which the mass matrix is one.
//!
//! A contact is three rows in a row: along its normal, and two across it whose impulses stay inside the friction cone.

use super::factor::{Factors, Vector};
use super::loose::Loose;
use super::tree::{DEEPEST, MOST, Tree};

/// Sweeps over all rows at most, and N s by which the largest change of one ends them.
const SWEEPS: usize = 20;
const SETTLED: f64 = 1e-4;
/// Of the mean of all rows' answers to an impulse: what is added to each, so that rows that contradict each other share.
const SOFT: f64 = 1e-4;

/// What a row's impulse may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Pushes only, and is the first of a contact's three.
    Normal,
    /// Across a contact.
    Across,
    /// Pushes only.
    Stop,
    /// Pushes and pulls.
    Weld,
}

/// One direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) kind: Kind,
    /// Names it from step to step.
    pub(super) key: u32,
    /// What a unit impulse does to the tree, on the chain of a freedom, and how long that is.
    pub(super) near: [f64; DEEPEST],
    pub(super) last: usize,
    pub(super) length: usize,
    /// And to a loose body.
    pub(super) far: Option<(usize, [f64; 6])>,
    /// m/s or rad/s, how much faster it is to go.
    pub(super) wanted: f64,
    /// Of a contact.
    pub(super) friction: f64,
    /// N s or N m s.
    pub(super) impulse: f64,
    answer: f64,
}

/// All rows of a step, and the last step's impulses.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub(super) rows: Vec<Row>,
    kept: Vec<(u32, f64)>,
    loose: Vec<[f64; 6]>,
}

impl Rows {
    /// Begins a step: what was found is kept to start from.
    pub(super) fn clear(&mut self) {
        self.kept.clear();
        self.kept.extend(self.rows.iter().map(|row| (row.key, row.impulse)));
        self.kept.sort_unstable_by_key(|(key, _)| *key);
        self.rows.clear();
    }

    /// One row more. The direction stands on the chain of freedom `last`; `wanted` is how much faster it is to go along it.
    #[expect(clippy::too_many_arguments, reason = "one row, all of it")]
    pub(super) fn add(
        &mut self,
        (tree, factors): (&Tree, &Factors),
        kind: Kind,
        key: u32,
        (last, mut near): (usize, [f64; DEEPEST]),
        far: Option<(usize, [f64; 6])>,
        wanted: f64,
        friction: f64,
    ) {
        let length = tree.depth[last] + 1;
        factors.halve(tree, last, &mut near);
        let answer: f64 = near[..length].iter().map(|value| value * value).sum();
        let answer = answer + far.map_or(0.0, |(_, far)| far.iter().map(|value| value * value).sum());
        let kept = self.kept.binary_search_by_key(&key, |(key, _)| *key);
        let impulse = kept.map_or(0.0, |at| self.kept[at].1);
        self.rows.push(Row { kind, key, near, last, length, far, wanted, friction, impulse, answer });
    }

    /// Finds the impulses; adds what they do to the speeds and to the loose bodies.
    pub(super) fn solve(&mut self, tree: &Tree, factors: &Factors, speed: &mut Vector, loose: &mut [Loose]) {
        if self.rows.is_empty() {
            return;
        }
        let mut sum = [0.0; MOST];
        self.loose.clear();
        self.loose.resize(loose.len(), [0.0; 6]);
        let soft = SOFT * self.rows.iter().map(|row| row.answer).sum::<f64>() / self.rows.len() as f64;
        for row in &mut self.rows {
            row.answer = 1.0 / (row.answer + soft).max(1e-12);
            row.act(tree, &mut sum, &mut self.loose, row.impulse);
        }
        for _ in 0..SWEEPS {
            if self.sweep(tree, &mut sum) < SETTLED {
                break;
            }
        }
        for (value, root) in sum.iter_mut().zip(&factors.root).take(tree.freedoms()) {
            *value *= root;
        }
        factors.back(tree, &mut sum);
        for (speed, change) in speed.iter_mut().zip(&sum) {
            *speed += change;
        }
        for (body, change) in loose.iter_mut().zip(&self.loose) {
            body.change(change);
        }
    }

    /// Once over all rows; the largest change of an impulse.
    fn sweep(&mut self, tree: &Tree, sum: &mut Vector) -> f64 {
        let (mut moved, mut index) = (0.0_f64, 0);
        while index < self.rows.len() {
            let row = &self.rows[index];
            let next = row.next(tree, sum, &self.loose);
            let next = if row.kind == Kind::Weld { next } else { next.max(0.0) };
            moved = moved.max(self.give(tree, sum, index, next));
            if self.rows[index].kind != Kind::Normal {
                index += 1;
                continue;
            }
            let most = self.rows[index].impulse * self.rows[index].friction;
            let (a, b) =
                (self.rows[index + 1].next(tree, sum, &self.loose), self.rows[index + 2].next(tree, sum, &self.loose));
            let size = (a * a + b * b).sqrt();
            let share = if size > most { most / size } else { 1.0 };
            moved = moved.max(self.give(tree, sum, index + 1, a * share));
            moved = moved.max(self.give(tree, sum, index + 2, b * share));
            index += 3;
        }
        moved
    }

    fn give(&mut self, tree: &Tree, sum: &mut Vector, index: usize, impulse: f64) -> f64 {
        let row = &mut self.rows[index];
        let change = impulse - row.impulse;
        if change != 0.0 {
            row.impulse = impulse;
            row.act(tree, sum, &mut self.loose, change);
        }
        change.abs()
    }
}

impl Row {
    /// The impulse with which it would go as it should.
    fn next(&self, tree: &Tree, sum: &Vector, loose: &[[f64; 6]]) -> f64 {
        let chain = &tree.chain[self.last];
        let mut goes = 0.0;
        for (value, freedom) in self.near[..self.length].iter().zip(chain) {
            goes += value * sum[usize::from(*freedom)];
        }
        if let Some((body, far)) = &self.far {
            goes += far.iter().zip(&loose[*body]).map(|(a, b)| a * b).sum::<f64>();
        }
        self.impulse + (self.wanted - goes) * self.answer
    }

    fn act(&self, tree: &Tree, sum: &mut Vector, loose: &mut [[f64; 6]], impulse: f64) {
        let chain = &tree.chain[self.last];
        for (value, freedom) in self.near[..self.length].iter().zip(chain) {
            sum[usize::from(*freedom)] += value * impulse;
        }
        if let Some((body, far)) = &self.far {
            for (sum, value) in loose[*body].iter_mut().zip(far) {
                *sum += value * impulse;
            }
        }
    }
}
