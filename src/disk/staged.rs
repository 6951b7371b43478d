//! Files that are being written and are not in their places yet: whoever ends the program early removes them.
//!
//! The writer lists what it stages here. While it puts finished files in their places it holds the list, so that who wants to end
//! the program waits for them all: whole or not at all.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files that an interrupt removes.
static STAGED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The list; an interrupt waits while it is held.
pub fn staged() -> MutexGuard<'static, Vec<PathBuf>> {
    STAGED.lock().unwrap_or_else(PoisonError::into_inner)
}
