//! The program at a shell of the test's own: a folder, the words, what came of them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// An empty folder that the program runs in.
pub struct Shell {
    folder: tempfile::TempDir,
}

/// What came of a command.
pub struct Told {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Shell {
    pub fn new() -> Shell {
        Shell { folder: tempfile::tempdir().expect("a folder for the test") }
    }

    pub fn with(files: &[(&str, &str)]) -> Shell {
        let shell = Shell::new();
        for (name, text) in files {
            fs::write(shell.path(name), text).expect("the test's own folder");
        }
        shell
    }

    pub fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    /// Runs `surefoot` with those words, split at blanks.
    pub fn run(&self, words: &str) -> Told {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
        command.args(words.split_whitespace()).current_dir(self.folder.path()).env("NO_COLOR", "1");
        let Output { status, stdout, stderr } = command.output().expect("the program was built");
        let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
        let told = Told { code: status.code().unwrap_or(-1), out: text(stdout), err: text(stderr) };
        assert!(!told.err.contains("panicked") && !told.err.contains("broke down"), "{words}: {}", told.err);
        told
    }

    /// Names in the folder and below, sorted.
    pub fn files(&self) -> Vec<String> {
        fn walk(folder: &Path, root: &Path, names: &mut Vec<String>) {
            for entry in fs::read_dir(folder).expect("the test's own folder").flatten() {
                match entry.path() {
                    path if path.is_dir() => walk(&path, root, names),
                    path => names.push(path.strip_prefix(root).expect("below").display().to_string()),
                }
            }
        }
        let mut names = Vec::new();
        walk(self.folder.path(), self.folder.path(), &mut names);
        names.sort();
        names
    }
}

impl Told {
    #[track_caller]
    pub fn exits(self, code: i32) -> Told {
        assert_eq!(self.code, code, "stdout:\n{}\nstderr:\n{}", self.out, self.err);
        self
    }

    #[track_caller]
    pub fn says(self, parts: &[&str]) -> Told {
        for part in parts {
            assert!(self.err.contains(part), "stderr lacks `{part}`:\n{}", self.err);
        }
        self
    }

    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error} in {}", self.out))
    }
}
