//! The command line: parse, resolve, run, exit code.
//!
//! `args` only looks at the text of the arguments, [`crate::disk`] opens and writes the files they name, one file a subcommand
//! does the work. Results go to stdout, messages to stderr. No panic reaches the shell.

pub mod args;
pub mod audit;
pub mod audit_json;
pub mod audit_table;
pub mod audit_text;
pub mod bake;
pub mod batch;
pub mod batch_farm;
pub mod batch_out;
pub mod correct;
pub mod exit_code;
mod forms;
pub mod inspect;
pub mod interrupt;
pub mod new;
pub mod parts;
pub mod retarget;
pub mod scenario_fault;
pub mod sheet;
pub mod waivers;

use crate::disk::{Exit, Failure};
use args::{Args, Command};
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;

/// Runs the program with those arguments.
pub fn run(args: std::env::ArgsOs) -> ExitCode {
    interrupt::watch();
    let outcome = exit_code::guarded(|| match Args::try_parse_from(args) {
        Ok(args) => dispatch(args.command),
        Err(error) => {
            // Help and version are results, the rest is bad usage; clap knows which stream is whose.
            let told = error.print();
            match error.exit_code() {
                0 => told.map(|()| Exit::Done).map_err(|error| Failure::stdout(&error)),
                _ => Ok(Exit::BadInput),
            }
        }
    });
    match outcome {
        Ok(exit) => exit.into(),
        Err(failure) => {
            if let Some(faults) = &failure.faults {
                tell(scenario_fault::draw(faults).trim_end());
            }
            complain(&failure.message);
            failure.exit.into()
        }
    }
}

fn dispatch(command: Command) -> Result<Exit, Failure> {
    match command {
        Command::Bake(args) => bake::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::New(args) => new::run(&args),
        Command::Sheet(args) => sheet::run(&args),
        Command::Audit(args) => audit::run(&args),
        Command::Correct(args) => correct::run(&args),
        Command::Retarget(args) => retarget::run(&args),
        Command::Batch(args) => batch::run(&args),
        Command::Studio(_) => Err(not_yet("studio")),
    }
}

fn not_yet(command: &str) -> Failure {
    Failure::bad_input(format!(
        "`surefoot {command}` is not in this version yet\n  help: this version has audit, bake, batch, correct, inspect, new, retarget and sheet"
    ))
}

/// Writes a result to stdout.
fn say(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|error| Failure::stdout(&error))
}

/// Writes a message to stderr, where nothing can be done if that fails.
fn tell(text: &str) {
    drop(writeln!(std::io::stderr().lock(), "{text}"));
}

fn complain(message: &str) {
    if !message.is_empty() {
        tell(&format!("error: {message}"));
    }
}
