//! Ctrl-C and its like: files that are still being written go away, then the program ends with exit code 3.
//!
//! While the writer puts finished files in their places an interrupt waits for them all: whole or not at all. SIGKILL cannot
//! be helped; it may leave a `.surefoot-*.tmp`.

use crate::disk::Exit;
use crate::disk::staged::staged;
use std::sync::{Mutex, PoisonError};

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
        super::progress::clear();
        let hint = HINT.lock().unwrap_or_else(PoisonError::into_inner);
        super::tell(&format!("error: interrupted{hint}"));
        std::process::exit(Exit::Failed as i32);
    }));
}
