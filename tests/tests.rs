//! The integration tests, one binary: each module says what it holds. A new test goes into the module of the thing that
//! a user would see break; helpers that two modules need go into `common`.

/// Row order of `src/lib.rs`, names in their places, shape of files.
mod architecture;
/// The program at the shell: exit codes, words, files.
mod cli;
mod common;
mod export; // poses to the bytes of a GLB and back, nothing lost
mod synthetic; // rigs made by hand, and a stepping motion
