//! Rows of the contact problem: directions in which a tree, and a loose body where it meets one, may be pushed. Solved by projected
//! Gauss-Seidel from the last step's impulses, in the space in which the mass matrix is one.
//!
//! A range's end or one of a weld's six is a row of one direction; a contact is one of three: along its normal, and two across it whose
//! impulses stay inside the friction cone.
//!
//! What is swept over is written as loops over indices here and in `factor`: in a build whose units are not inlined into each other
//! (`Cargo.toml`) iterators' adapters took half of a tick.

use super::factor::{Factors, Vector};
use super::loose::Loose;
use super::tree::{DEEPEST, MOST, Tree};

/// Sweeps over all rows at most, and N s by which the largest change of one ends them.
const SWEEPS: usize = 20;
const SETTLED: f64 = 1e-4;
/// Of the mean of all directions' answers to an impulse: what is added to each, so that rows that contradict each other share.
const SOFT: f64 = 1e-4;

/// What a row of one direction may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Pushes only.
    Stop,
    /// Pushes and pulls.
    Weld,
}

/// Directions on the chain of a freedom, from the root on: freedom by freedom, direction by direction.
pub(super) type Ways<const N: usize> = [[f64; N]; DEEPEST];

/// What is wanted in some directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<const N: usize> {
    /// Names it from step to step.
    pub(super) key: u32,
    /// The directions, and the freedom on whose chain they stand.
    pub(super) near: Ways<N>,
    pub(super) last: usize,
    /// Which loose body they move too, and how.
    pub(super) far: Option<(usize, [[f64; 6]; N])>,
    /// m/s or rad/s, how much faster it is to go.
    pub(super) wanted: [f64; N],
}

/// Some directions of one thing.
#[derive(Clone, Copy, Debug)]
struct Row<const N: usize> {
    key: u32,
    /// What unit impulses do to the tree, on the chain of a freedom, and how long that is.
    near: Ways<N>,
    last: usize,
    length: usize,
    /// And to a loose body.
    far: Option<(usize, [[f64; 6]; N])>,
    wanted: [f64; N],
    /// N s or N m s.
    impulse: [f64; N],
    /// N s for each m/s that is lacking.
    answer: [f64; N],
}

/// All rows of a step, and the last step's impulses.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    single: Vec<(Kind, Row<1>)>,
    /// Contacts: Coulomb's coefficient, what the first direction does to the others, the row.
    contacts: Vec<(f64, [f64; 2], Row<3>)>,
    kept: Vec<(u32, [f64; 3])>,
    loose: Vec<[f64; 6]>,
}

impl Rows {
    /// Begins a step: what was found is kept to start from.
    pub(super) fn clear(&mut self) {
        self.kept.clear();
        self.kept.extend(self.single.iter().map(|(_, row)| (row.key, [row.impulse[0], 0.0, 0.0])));
        self.kept.extend(self.contacts.iter().map(|(.., row)| (row.key, row.impulse)));
        self.kept.sort_unstable_by_key(|(key, _)| *key);
        self.single.clear();
        self.contacts.clear();
    }

    fn kept(&self, key: u32) -> [f64; 3] {
        self.kept.binary_search_by_key(&key, |(key, _)| *key).map_or([0.0; 3], |at| self.kept[at].1)
    }

    /// One row more.
    pub(super) fn add(&mut self, tools: (&Tree, &Factors), kind: Kind, asked: &Asked<1>) {
        let [kept, ..] = self.kept(asked.key);
        self.single.push((kind, Row::new(tools, asked, [kept])));
    }

    /// One contact more: along the normal and across it.
    pub(super) fn add_contact(&mut self, tools: (&Tree, &Factors), friction: f64, asked: &Asked<3>) {
        let row = Row::new(tools, asked, self.kept(asked.key));
        self.contacts.push((friction, [row.between(0, 1), row.between(0, 2)], row));
    }

    /// How many contacts there are.
    pub(super) fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// N s, of a contact, along its normal and across it.
    pub(super) fn given(&self, contact: usize) -> [f64; 3] {
        self.contacts[contact].2.impulse
    }

    /// Finds the impulses; adds what they do to the speeds and to the loose bodies.
    pub(super) fn solve(&mut self, tree: &Tree, factors: &Factors, speed: &mut Vector, loose: &mut [Loose]) {
        let directions = self.single.len() + 3 * self.contacts.len();
        if directions == 0 {
            return;
        }
        let mut sum = [0.0; MOST];
        self.loose.clear();
        self.loose.resize(loose.len(), [0.0; 6]);
        let stiff = self.single.iter().map(|(_, row)| row.answer[0]).sum::<f64>()
            + self.contacts.iter().map(|(.., row)| row.answer.iter().sum::<f64>()).sum::<f64>();
        let soft = SOFT * stiff / directions as f64;
        self.single.iter_mut().for_each(|(_, row)| row.begin(tree, &mut sum, &mut self.loose, soft));
        self.contacts.iter_mut().for_each(|(.., row)| row.begin(tree, &mut sum, &mut self.loose, soft));
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
        let mut moved = 0.0_f64;
        for (kind, row) in &mut self.single {
            let [lacks] = row.lacks(tree, sum, &self.loose);
            let next = row.impulse[0] + lacks * row.answer[0];
            let next = if *kind == Kind::Weld { next } else { next.max(0.0) };
            moved = moved.max(row.give(tree, sum, &mut self.loose, [next]));
        }
        for (friction, between, row) in &mut self.contacts {
            let lacks = row.lacks(tree, sum, &self.loose);
            let normal = (row.impulse[0] + lacks[0] * row.answer[0]).max(0.0);
            let change = normal - row.impulse[0];
            let a = row.impulse[1] + (lacks[1] - between[0] * change) * row.answer[1];
            let b = row.impulse[2] + (lacks[2] - between[1] * change) * row.answer[2];
            let most = normal * *friction;
            let size = a * a + b * b;
            let share = if size > most * most { most / size.sqrt() } else { 1.0 };
            moved = moved.max(row.give(tree, sum, &mut self.loose, [normal, a * share, b * share]));
        }
        moved
    }
}

impl<const N: usize> Row<N> {
    fn new((tree, factors): (&Tree, &Factors), asked: &Asked<N>, impulse: [f64; N]) -> Row<N> {
        let Asked { key, mut near, last, far, wanted } = *asked;
        let length = tree.depth[last] + 1;
        factors.halve(tree, last, &mut near);
        let mut row = Row { key, near, last, length, far, wanted, impulse, answer: [0.0; N] };
        for way in 0..N {
            row.answer[way] = row.between(way, way);
        }
        row
    }

    /// What a unit impulse in one direction does in another, m/s for each N s.
    fn between(&self, one: usize, other: usize) -> f64 {
        let mut near = 0.0;
        for ways in &self.near[..self.length.min(DEEPEST)] {
            near += ways[one] * ways[other];
        }
        near + self.far.map_or(0.0, |(_, far)| dot(&far[one], &far[other]))
    }

    /// Turns answers from m/s a N s to N s a m/s, and gives what the last step gave.
    fn begin(&mut self, tree: &Tree, sum: &mut Vector, loose: &mut [[f64; 6]], soft: f64) {
        for answer in &mut self.answer {
            *answer = 1.0 / (*answer + soft).max(1e-12);
        }
        self.act(tree, sum, loose, &self.impulse);
    }

    /// m/s or rad/s, how much slower it goes than it should.
    #[inline]
    #[expect(clippy::needless_range_loop, reason = "see the head of the file")]
    fn lacks(&self, tree: &Tree, sum: &Vector, loose: &[[f64; 6]]) -> [f64; N] {
        let chain = &tree.chain[self.last];
        let mut lacks = self.wanted;
        for e in 0..self.length.min(DEEPEST) {
            let value = sum[usize::from(chain[e])];
            for way in 0..N {
                lacks[way] -= self.near[e][way] * value;
            }
        }
        if let Some((body, far)) = &self.far {
            for (lacks, far) in lacks.iter_mut().zip(far) {
                *lacks -= dot(far, &loose[*body]);
            }
        }
        lacks
    }

    /// Gives that much instead of what was given; the largest change.
    #[inline]
    fn give(&mut self, tree: &Tree, sum: &mut Vector, loose: &mut [[f64; 6]], impulse: [f64; N]) -> f64 {
        let (mut change, mut most) = ([0.0; N], 0.0_f64);
        for way in 0..N {
            change[way] = impulse[way] - self.impulse[way];
            most = most.max(change[way].abs());
        }
        self.impulse = impulse;
        if most > 0.0 {
            self.act(tree, sum, loose, &change);
        }
        most
    }

    #[inline]
    #[expect(clippy::needless_range_loop, reason = "see the head of the file")]
    fn act(&self, tree: &Tree, sum: &mut Vector, loose: &mut [[f64; 6]], impulse: &[f64; N]) {
        let chain = &tree.chain[self.last];
        for e in 0..self.length.min(DEEPEST) {
            let mut change = 0.0;
            for way in 0..N {
                change += self.near[e][way] * impulse[way];
            }
            sum[usize::from(chain[e])] += change;
        }
        if let Some((body, far)) = &self.far {
            for (far, impulse) in far.iter().zip(impulse) {
                for (sum, value) in loose[*body].iter_mut().zip(far) {
                    *sum += value * impulse;
                }
            }
        }
    }
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
