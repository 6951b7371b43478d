//! The integration tests, one binary: each module says what it holds. A new test goes into the module of the thing that
//! a user would see break; helpers that two modules need go into `common`.

/// Row order of `src/lib.rs`, names in their places, shape of files.
mod architecture;
/// Height, masses and soles of real rigs and of the built-in one.
mod bodies;
/// The program at the shell: exit codes, words, files.
mod cli;
mod common;
/// Baked files: the source kept whole, read again, by the Khronos validator, three.js.
mod export;
/// What the measures say of a walk over force plates.
mod measure;
/// The controller: standing, recovering, stepping.
mod stepper;
/// Rigs and motions made by hand for the modules above.
mod synthetic;
