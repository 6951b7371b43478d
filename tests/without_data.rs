//! Runs after the tests (cargo runs test programs in the order of their names) and says how many of them did not run because
//! the folder of third-party data is not there. Not a test: it never fails.

#![expect(clippy::print_stdout, reason = "what it is for")]

#[path = "data.rs"]
#[expect(dead_code, reason = "the tests' side of it")]
mod data;

use std::path::Path;

fn main() {
    if std::env::args().any(|argument| argument == "--list") {
        return; // a runner that asks for names of tests: there are none here
    }
    let notes = Path::new(data::NOTES);
    let mut names: Vec<(String, String)> = std::fs::read_dir(notes)
        .into_iter()
        .flatten()
        .filter_map(|entry| std::fs::read_to_string(entry.ok()?.path()).ok())
        .filter_map(|note| note.trim().split_once('\n').map(|(what, test)| (what.to_owned(), test.to_owned())))
        .collect();
    names.sort();
    // The next run leaves its own notes.
    drop(std::fs::remove_dir_all(notes));
    let asked: String = names.iter().map(|(_, test)| format!("{test}\n")).collect();
    drop(std::fs::write(notes.with_extension("txt"), asked));

    let count = |wanted: &str| names.iter().filter(|(what, _)| what == wanted).count();
    let (not_run, partly) = (count(data::NOT_RUN), count(data::PARTLY));
    if partly > 0 {
        println!("{partly} tests ran on the built-in rig and on made files only: no SUREFOOT_DATA");
    }
    if not_run > 0 {
        println!("{not_run} tests did not run: no SUREFOOT_DATA");
    }
}
