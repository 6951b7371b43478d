//! `surefoot completions`: a shell's completion script, on stdout.

use super::args::{Args, CompletionsArgs};
use super::say;
use crate::disk::{Exit, Failure};
use clap::CommandFactory;

/// Prints it.
pub fn run(args: &CompletionsArgs) -> Result<Exit, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "surefoot", &mut script);
    say(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}
