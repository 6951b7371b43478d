//! The studio's own folder: what it remembers, and copies of unsaved work for the case of a crash.
//!
//! A session's copy lies in `unsaved/`, beside a lock that the session holds: a copy whose lock is free was left by a crash. Without a
//! folder nothing is remembered and all else works.

use crate::disk::writer::{self, Output};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Recent files that are remembered.
const MOST_RECENT: usize = 12;

/// Settings, from one start to the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Remembered {
    /// Scenarios with the rigs that they were shown on, the newest first.
    pub recent: Vec<Recent>,
    /// `light`, `dark`, or the system's.
    pub theme: Option<String>,
    /// Size of everything; 1 as the system has it.
    pub zoom: Option<f32>,
    /// The studio was open before.
    pub knows_it: bool,
}

/// A scenario that was open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recent {
    /// The scenario's file.
    pub scenario: PathBuf,
    /// The rig that it was shown on.
    pub rig: PathBuf,
}

/// Work that is not on the disk yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unsaved {
    /// The scenario's text.
    pub text: String,
    /// Its file, where it has one.
    pub file: Option<PathBuf>,
    /// The rig.
    pub rig: PathBuf,
}

/// The folder.
#[derive(Debug)]
pub struct Home {
    folder: Option<PathBuf>,
    /// This session's copy, and the lock that says that it lives.
    own: Option<(PathBuf, File)>,
}

impl Remembered {
    /// That one was open last.
    pub fn opened(&mut self, scenario: &Path, rig: &Path) {
        self.recent.retain(|recent| recent.scenario != scenario);
        self.recent.insert(0, Recent { scenario: scenario.to_owned(), rig: rig.to_owned() });
        self.recent.truncate(MOST_RECENT);
    }
}

impl Home {
    /// A folder that need not be there yet; `None` remembers nothing.
    pub fn new(folder: Option<PathBuf>) -> Home {
        Home { folder, own: None }
    }

    /// The one of whoever is logged in.
    pub fn of_user() -> Home {
        let project = directories::ProjectDirs::from("", "", "surefoot");
        Home::new(project.map(|project| project.data_local_dir().join("studio")))
    }

    /// The settings; those of a first start where there are none that can be read.
    pub fn remembered(&self) -> Remembered {
        let bytes = self.folder.as_ref().and_then(|folder| fs::read(folder.join("settings.json")).ok());
        bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
    }

    /// Keeps them.
    pub fn remember(&self, remembered: &Remembered) -> Result<(), String> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let bytes = serde_json::to_vec_pretty(remembered).map_err(|error| error.to_string())?;
        put(folder.join("settings.json"), bytes)
    }

    /// Keeps a copy of unsaved work, or removes it.
    pub fn keep(&mut self, unsaved: Option<&Unsaved>) -> Result<(), String> {
        let Some(folder) = &self.folder else { return Ok(()) };
        let Some(unsaved) = unsaved else {
            if let Some((copy, _)) = &self.own {
                drop(fs::remove_file(copy));
            }
            return Ok(());
        };
        let bytes = serde_json::to_vec_pretty(unsaved).map_err(|error| error.to_string())?;
        if self.own.is_none() {
            self.own = Some(session(&folder.join("unsaved"))?);
        }
        match &self.own {
            Some((copy, _)) => put(copy.clone(), bytes),
            None => Ok(()),
        }
    }

    /// Copies of sessions that did not end in order, the newest last.
    pub fn left_behind(&self) -> Vec<(PathBuf, Unsaved)> {
        let Some(folder) = self.folder.as_ref().map(|folder| folder.join("unsaved")) else { return Vec::new() };
        let mut copies: Vec<PathBuf> =
            fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        copies.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
        copies.sort_by_key(|path| (fs::metadata(path).and_then(|there| there.modified()).ok(), path.clone()));
        copies
            .into_iter()
            .filter(|copy| self.own.as_ref().is_none_or(|(own, _)| own != copy))
            .filter(|copy| File::open(copy.with_extension("lock")).is_ok_and(|lock| lock.try_lock().is_ok()))
            .filter_map(|copy| Some((copy.clone(), serde_json::from_slice(&fs::read(&copy).ok()?).ok()?)))
            .collect()
    }

    /// Removes a copy.
    pub fn forget(&self, copy: &Path) {
        drop(fs::remove_file(copy));
        drop(fs::remove_file(copy.with_extension("lock")));
    }
}

impl Drop for Home {
    fn drop(&mut self) {
        // A session that ends in order leaves its copy only where there is work in it that is not saved.
        if let Some((copy, _)) = self.own.take()
            && !copy.exists()
        {
            drop(fs::remove_file(copy.with_extension("lock")));
        }
    }
}

fn put(path: PathBuf, bytes: Vec<u8>) -> Result<(), String> {
    writer::write(&[Output { path, bytes }], &[]).map_err(|failure| failure.message)
}

/// A name that no session has, and its lock.
fn session(folder: &Path) -> Result<(PathBuf, File), String> {
    let cannot = |error: std::io::Error| format!("{}: cannot be written to: {error}", folder.display());
    fs::create_dir_all(folder).map_err(cannot)?;
    for number in 1..10_000 {
        let copy = folder.join(format!("session-{number}.json"));
        match File::create_new(copy.with_extension("lock")) {
            Ok(lock) => {
                drop(lock.try_lock()); // a file system without locks does without
                return Ok((copy, lock));
            }
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(cannot(error)),
        }
    }
    Err(format!("{}: too many copies of unsaved work\n  help: remove the old ones", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(text: &str) -> Unsaved {
        Unsaved { text: text.to_owned(), file: None, rig: PathBuf::from("builtin") }
    }

    #[test]
    fn what_a_crash_leaves_is_found_and_what_lives_is_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let home = || Home::new(Some(folder.path().to_owned()));
        let (mut crashed, mut lives) = (home(), home());
        crashed.keep(Some(&work("one"))).expect("kept");
        crashed.keep(Some(&work("two"))).expect("kept");
        lives.keep(Some(&work("three"))).expect("kept");
        assert_eq!(home().left_behind(), []);
        drop(crashed); // the system frees a dead process's lock as this does
        let left = home().left_behind();
        assert_eq!(left.iter().map(|(_, work)| work.text.as_str()).collect::<Vec<_>>(), ["two"]);
        home().forget(&left[0].0);
        assert_eq!(home().left_behind(), []);
    }

    #[test]
    fn saved_work_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut home = Home::new(Some(folder.path().to_owned()));
        home.keep(Some(&work("one"))).expect("kept");
        home.keep(None).expect("removed");
        drop(home);
        assert_eq!(fs::read_dir(folder.path().join("unsaved")).expect("there").count(), 0);
    }

    #[test]
    fn settings_come_back_and_broken_ones_are_those_of_a_first_start() {
        let folder = tempfile::tempdir().expect("a folder");
        let home = Home::new(Some(folder.path().to_owned()));
        assert_eq!(home.remembered(), Remembered::default());
        let mut settings = Remembered { knows_it: true, ..Remembered::default() };
        (0..20).for_each(|number| settings.opened(Path::new(&format!("{number}.toml")), Path::new("builtin")));
        home.remember(&settings).expect("kept");
        assert_eq!(home.remembered(), settings);
        assert_eq!((settings.recent.len(), settings.recent[0].scenario.as_path()), (12, Path::new("19.toml")));
        fs::write(folder.path().join("settings.json"), "{").expect("written");
        assert_eq!(home.remembered(), Remembered::default());
    }
}
