//! Progress on a terminal: a spinner that says what is being done. Elsewhere (a file, a pipe, a farm's log) nothing.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Between two pictures of the spinner.
const TICK: Duration = Duration::from_millis(100);

/// What spins, for who has to clear the line before the program ends.
static SPINNING: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Does the work under a spinner on stderr, if that is a terminal. The work must not write there itself.
pub fn busy<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let _spinner = std::io::stderr().is_terminal().then(|| Spinner::start(what));
    work()
}

/// Clears the line of what spins, if anything does.
pub fn clear() {
    if let Some(spinner) = SPINNING.lock().unwrap_or_else(PoisonError::into_inner).take() {
        spinner.finish_and_clear();
    }
}

/// Spins until it is dropped, also by a panic.
struct Spinner;

impl Spinner {
    fn start(what: &str) -> Spinner {
        let shown: String = what.chars().filter(|letter| !letter.is_control()).collect(); // a clip's name may hold anything
        let spinner = ProgressBar::new_spinner().with_message(shown);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} ({elapsed})") {
            spinner.set_style(style);
        }
        spinner.enable_steady_tick(TICK);
        *SPINNING.lock().unwrap_or_else(PoisonError::into_inner) = Some(spinner);
        Spinner
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        clear();
    }
}
