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
pub mod completions;
pub mod correct;
pub mod exit_code;
mod forms;
pub mod help;
pub mod inspect;
pub mod interrupt;
pub mod man;
pub mod new;
pub mod parts;
pub mod progress;
pub mod retarget;
pub mod scenario_fault;
pub mod sheet;
mod travel;
pub mod waivers;

use crate::disk::{Exit, Failure};
use args::{Args, Command};
use clap::Parser;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Opens the window on a file, or measures how fast it is for so many seconds and gives that as JSON. The error is for a person.
pub type OpenStudio = fn(Option<PathBuf>, Option<f64>) -> Result<Option<String>, String>;

/// Runs the program with those arguments. The window is another face, which this one does not know: `main` gives it.
pub fn run(args: std::env::ArgsOs, studio: Option<OpenStudio>) -> ExitCode {
    interrupt::watch();
    let outcome = exit_code::guarded(|| match Args::try_parse_from(args) {
        Ok(args) => dispatch(args.command, studio),
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

fn dispatch(command: Command, studio: Option<OpenStudio>) -> Result<Exit, Failure> {
    match command {
        Command::Bake(args) => bake::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::New(args) => new::run(&args),
        Command::Sheet(args) => sheet::run(&args),
        Command::Audit(args) => audit::run(&args),
        Command::Correct(args) => correct::run(&args),
        Command::Retarget(args) => retarget::run(&args),
        Command::Batch(args) => batch::run(&args),
        Command::Studio(args) => open_studio(&args, studio),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
        Command::Help(args) => help::run(&args),
    }
}

fn open_studio(args: &args::StudioArgs, studio: Option<OpenStudio>) -> Result<Exit, Failure> {
    let Some(open) = studio else {
        let remedy =
            "build it with the feature `studio`, which is on unless it is switched off; every other command works";
        return Err(Failure::bad_input(format!("this build of surefoot has no window\n  help: {remedy}")));
    };
    if let Some(file) = args.file.as_deref().filter(|file| file.as_os_str() != "builtin") {
        crate::disk::resolve::plain_file(file, "give a scenario, a rig or a clip; or none, for the built-in rig")?;
    }
    if let Some(times) = open(args.file.clone(), args.measure).map_err(Failure::failed)? {
        say(&format!("{times}\n"))?;
    }
    Ok(Exit::Done)
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
