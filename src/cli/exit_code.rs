//! How the program ends: four exit codes, and the guard that turns a panic, which would be a bug, into one of them.

use crate::disk::{Exit, Failure};
use std::panic::{self, AssertUnwindSafe};
use std::process::ExitCode;
use std::sync::Mutex;

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// Runs the program; a panic in it becomes a message and exit code 3.
pub fn guarded(program: impl FnOnce() -> Result<Exit, Failure>) -> Result<Exit, Failure> {
    static PANIC: Mutex<Option<String>> = Mutex::new(None);
    let quiet = panic::take_hook();
    panic::set_hook(Box::new(|info| {
        let place = info.location().map_or_else(|| "an unknown place".to_owned(), ToString::to_string);
        let payload = info.payload();
        let words = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let words = words.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
        if let Ok(mut slot) = PANIC.lock() {
            slot.get_or_insert(format!("{words} (at {place})"));
        }
    }));
    let outcome = panic::catch_unwind(AssertUnwindSafe(program));
    panic::set_hook(quiet);
    outcome.unwrap_or_else(|_| {
        let seen = PANIC.lock().ok().and_then(|mut slot| slot.take()).unwrap_or_default();
        Err(Failure::failed(format!(
            "surefoot {} broke down: {seen}\n  help: this is a bug. Please report it with the command and its input files",
            env!("CARGO_PKG_VERSION")
        )))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_exit_three_with_its_place_and_a_request_to_report() {
        let failure = guarded(|| panic!("index {} of 3", 7)).expect_err("a failure");
        assert_eq!(failure.exit, Exit::Failed);
        assert!(failure.message.contains("index 7 of 3") && failure.message.contains("exit_code.rs"), "{failure:?}");
        assert!(failure.message.contains("Please report"), "{failure:?}");
    }

    #[test]
    fn a_reader_that_went_away_is_no_failure() {
        let gone = std::io::Error::from(std::io::ErrorKind::BrokenPipe);
        assert_eq!(Failure::stdout(&gone).exit, Exit::Done);
        let full = std::io::Error::from(std::io::ErrorKind::StorageFull);
        assert_eq!(Failure::stdout(&full).exit, Exit::Failed);
    }
}
