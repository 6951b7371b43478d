//! The integration tests, one binary: each module says what it holds. A new test goes into the module of the thing that
//! a user would see break; helpers that two modules need go into `common`.

mod common;
/// Contact sheets of real rigs.
mod picture;
