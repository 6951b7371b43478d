//! Rigid-body dynamics of a tree of links in reduced coordinates: joints that cannot come apart, contacts, limits, drives. f64, SI units.
//!
//! [`Tree`] says what hangs where; [`Articulation`] moves: each part of a tick it sums the inertias up the tree, factors the mass matrix
//! without fill (`factor`), solves for the speeds with the joints' springs and dampers taken at the end of the part, finds the impulses of
//! contacts and ranges (`rows`), and travels. Nothing is allocated in a tick once its lists have grown. It knows no ground: who steps it
//! lists what may be touched. The same input gives the same bits.

mod axes;
mod contacts;
mod factor;
mod inertia;
mod limits;
mod loose;
mod rows;
mod state;
mod step;
#[cfg(test)]
mod tests;
mod tree;

pub use axes::{Axes, Reading};
pub use contacts::{Met, Touch, Weld};
pub use limits::{Range, Swing};
pub use loose::Loose;
pub use state::{Articulation, Momentum};
pub use step::{Around, Find};
pub use tree::{Joint, Link, MOST, Tree, TreeError};
