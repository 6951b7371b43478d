//! `surefoot batch --openjd DIR` and `--slurm DIR`: jobs for render farms.

use super::args::BatchArgs;
use super::batch_place::RigFile;
use super::exit_code::{Exit, Failure};
use crate::batch::Plan;
use std::path::{Path, PathBuf};

/// Writes the job's files.
pub fn write(_: &BatchArgs, _: &Plan, _: &[RigFile], _: &[PathBuf], _: &Path) -> Result<Exit, Failure> {
    Err(Failure::bad_input("not yet"))
}
