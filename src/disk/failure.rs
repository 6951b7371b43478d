//! Why a piece of work ended badly, in words for a person, and the exit code that tells a shell.

use crate::model::ScenarioErrors;

/// What the shell gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Done; a fall is a result too.
    Done = 0,
    /// `bake --require-balance` fell and wrote nothing.
    Refused = 1,
    /// Bad usage or bad input.
    BadInput = 2,
    /// The work could not be completed: disk, breakdown, bug.
    Failed = 3,
}

/// Why it ended badly, in words for the person at the keyboard.
#[derive(Clone, Debug)]
pub struct Failure {
    /// The code.
    pub exit: Exit,
    /// What to print after "error: "; empty where all is said already.
    pub message: String,
    /// What is wrong with a scenario or a sweep, place by place; `message` only counts them.
    pub faults: Option<Box<ScenarioErrors>>,
}

impl Failure {
    /// The user can mend it.
    pub fn bad_input(message: impl Into<String>) -> Failure {
        Failure { exit: Exit::BadInput, message: message.into(), faults: None }
    }

    /// The user cannot mend it by another input.
    pub fn failed(message: impl Into<String>) -> Failure {
        Failure { exit: Exit::Failed, message: message.into(), faults: None }
    }

    /// Writing to stdout failed. A reader that has seen enough (`| head`) is no failure.
    pub fn stdout(error: &std::io::Error) -> Failure {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure { exit: Exit::Done, message: String::new(), faults: None },
            _ => Failure::failed(format!("cannot write to stdout: {error}")),
        }
    }
}
