//! Ctrl-C and its like: files that are still being written go away, then the program ends with exit code 3.
//!
//! The writer lists what it stages here. While it puts finished files in their places it holds the list, so that an
//! interrupt waits for them all: whole or not at all. SIGKILL cannot be helped; it may leave a `.surefoot-*.tmp`.

use super::exit_code::Exit;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files that an interrupt removes.
static STAGED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What an interrupt says more.
static HINT: Mutex<&str> = Mutex::new("");

/// From now on an interrupt says that too.
pub fn hint(text: &'static str) {
    *HINT.lock().unwrap_or_else(PoisonError::into_inner) = text;
}

/// From now on interrupts end the program in order. Where the system refuses a handler they end it as they always did.
pub fn watch() {
    drop(ctrlc::set_handler(|| {
        for path in staged().drain(..) {
            drop(std::fs::remove_file(path));
        }
        let hint = HINT.lock().unwrap_or_else(PoisonError::into_inner);
        super::tell(&format!("error: interrupted{hint}"));
        std::process::exit(Exit::Failed as i32);
    }));
}

/// The list; an interrupt waits while it is held.
pub fn staged() -> MutexGuard<'static, Vec<PathBuf>> {
    STAGED.lock().unwrap_or_else(PoisonError::into_inner)
}
