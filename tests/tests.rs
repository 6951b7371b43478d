//! The integration tests, one binary: each module says what it holds. A new test goes into the module of the thing that
//! a user would see break; helpers that two modules need go into `common`.

mod common;

/// Files that are broken, malicious or of another kind.
mod hostile;
/// Real rigs and variants of them: bones, height, heading, unit.
mod rigs;
