//! Third-party rigs and clips, which are not part of the repository: where they are, and which tests want them.
//!
//! The folder is the one that SUREFOOT_DATA names, or `../shared/data` beside the package. A test that asks for it leaves a
//! note under `target/tmp` that says whether it got it; `without_data.rs` reads those notes once all tests have run, and
//! prints how many did not run, or ran on fewer rigs.

use std::path::{Path, PathBuf};

/// Where the notes are: a file a test, named after it.
pub const NOTES: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/third_party_data");
/// The note of a test that got the data.
pub const USED: &str = "used";
/// The note of a test that did nothing without the data.
pub const NOT_RUN: &str = "not run";
/// The note of a test that ran on what is in the repository alone.
pub const PARTLY: &str = "partly run";

/// The folder, for a test that does nothing without it.
#[track_caller]
pub fn folder() -> Option<PathBuf> {
    asked(NOT_RUN)
}

/// The folder, for a test that runs without it too, on what is in the repository.
#[track_caller]
pub fn more() -> Option<PathBuf> {
    asked(PARTLY)
}

/// A file or folder of it, for a test that does nothing without it. One that lacks in a folder that is there is a failure.
#[track_caller]
pub fn file(relative: &str) -> Option<PathBuf> {
    let path = folder()?.join(relative);
    assert!(path.exists(), "{} is not there: the folder of third-party data is not whole", path.display());
    Some(path)
}

/// The folder, whether it is there or not, for benches: they say themselves what they leave out.
pub fn place() -> PathBuf {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    std::env::var_os("SUREFOOT_DATA").map_or_else(beside, PathBuf::from)
}

#[track_caller]
fn asked(without: &str) -> Option<PathBuf> {
    let found = Some(place()).filter(|place| place.join("rigs").is_dir());
    // The harness names each test's thread after it, but runs on the main one where it may use only one.
    let thread = std::thread::current();
    let test = match thread.name() {
        Some(name) if name != "main" => name.to_owned(),
        _ => std::panic::Location::caller().to_string(),
    };
    let note = if found.is_some() { USED } else { without };
    let path = Path::new(NOTES).join(test.replace([':', '/', '\\'], "_"));
    std::fs::create_dir_all(NOTES).expect("target/tmp can be written");
    // A test that is partly run in one place and not at all in another is partly run.
    if note == NOT_RUN && std::fs::read_to_string(&path).is_ok_and(|noted| noted.starts_with(PARTLY)) {
        return found;
    }
    std::fs::write(path, format!("{note}\n{test}\n")).expect("target/tmp can be written");
    found
}
