//! File work beside the window, in order: open, save, export, list a folder, keep what a crash must not lose.
//!
//! Everything is read and written by `disk`: whole files or none, and never over an input.

use super::home::{Home, Remembered, Unsaved};
use super::rewrite::rewrite;
use super::simulate::Shown;
use super::worker::{Reply, Wake, Worker};
use crate::batch::run::{engines, form};
use crate::disk::writer::{self, Output};
use crate::disk::{Failure, clip_files, resolve};
use crate::export;
use crate::model::scenario_write::write;
use crate::model::sweep::BakeSettings;
use crate::model::{FileKind, Role, Scenario};
use crate::rig::{Rig, overrides};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Something to do.
#[derive(Clone, Debug)]
pub enum Errand {
    /// Read a scenario.
    Open(PathBuf),
    /// Write it.
    Save(PathBuf, Box<Scenario>),
    /// Write a clip and what stands beside it.
    Export(PathBuf, Box<Shown>, Box<BakeSettings>),
    /// Write these files.
    Write(Vec<Output>),
    /// Write which node is which bone beside the rig.
    Bones(PathBuf, Arc<Rig>, BTreeMap<Role, Option<usize>>),
    /// What is in a folder.
    List(PathBuf),
    /// Keep the document in case of a crash; `None`: there is nothing to lose any more.
    Keep(Option<Box<Unsaved>>),
    /// Keep settings.
    Remember(Box<Remembered>),
    /// What crashes left, and the settings.
    WakeUp,
    /// Take what a crash left out of the way: it was taken up, or is not wanted.
    Forget(PathBuf),
}

/// What came of it.
#[derive(Clone, Debug)]
pub enum Done {
    /// A scenario.
    Opened(PathBuf, Box<Scenario>),
    /// It is on the disk.
    Saved(PathBuf, Box<Scenario>),
    /// These files are.
    Exported(Vec<PathBuf>, Vec<String>),
    /// The rig's override file is there.
    Bones(PathBuf),
    /// Folders, then files, by name.
    Listed(PathBuf, Vec<Listed>),
    /// Settings, and what crashes left.
    Woke(Box<Remembered>, Vec<(PathBuf, Unsaved)>),
    /// Not done, and why.
    Failed(&'static str, Failure),
}

/// An entry of a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Listed {
    /// A file, not a folder.
    pub is_file: bool,
    /// Its name.
    pub name: String,
}

/// Starts the worker; settings and what crashes must not lose lie in `home`.
pub fn start(wake: Wake, mut home: Home) -> Worker<Errand, Done> {
    let work = move |errand: Errand, reply: &Reply<Done>, _: &dyn Fn() -> bool| {
        let what = name(&errand);
        match run(&mut home, errand) {
            Ok(Some(done)) => reply.give(done),
            Ok(None) => {}
            Err(failure) => reply.give(Done::Failed(what, failure)),
        }
    };
    let broke = |words: String| {
        Done::Failed("files", Failure::failed(format!("{words}\n  help: this is a bug. Please report it")))
    };
    Worker::start("files", wake, work, broke)
}

fn name(errand: &Errand) -> &'static str {
    match errand {
        Errand::Open(_) => "open",
        Errand::Save(..) => "save",
        Errand::Export(..) => "export",
        Errand::Write(_) => "write the files",
        Errand::Bones(..) => "write the bones",
        Errand::List(_) => "list the folder",
        Errand::Keep(_) => "keep a copy in case of a crash",
        Errand::Remember(_) => "keep the settings",
        Errand::WakeUp => "read the settings",
        Errand::Forget(_) => "remove the copy",
    }
}

fn run(home: &mut Home, errand: Errand) -> Result<Option<Done>, Failure> {
    Ok(match errand {
        Errand::Open(path) => {
            let scenario = resolve::scenario(&path)?;
            Some(Done::Opened(path, Box::new(scenario)))
        }
        Errand::Save(path, scenario) => {
            // A person's own words stay in a text that is there.
            let text = match std::fs::read_to_string(&path) {
                Ok(old) => rewrite(&old, &scenario),
                Err(_) => write(&scenario),
            };
            writer::write(&[Output { path: path.clone(), bytes: text.into_bytes() }], &[])?;
            Some(Done::Saved(path, scenario))
        }
        Errand::Export(path, shown, settings) => Some(export(&path, &shown, &settings)?),
        Errand::Write(outputs) => {
            writer::write(&outputs, &[])?;
            Some(Done::Exported(outputs.into_iter().map(|output| output.path).collect(), Vec::new()))
        }
        Errand::Bones(rig_file, rig, bones) => {
            let path = rig_file.with_extension("bones.toml");
            let text = match std::fs::read_to_string(&path) {
                Ok(text) => text,
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
                Err(error) => return Err(Failure::bad_input(format!("{}: cannot be read: {error}", path.display()))),
            };
            let text = overrides::with_bones(&text, &bones, &rig.nodes)
                .map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
            writer::write(&[Output { path: path.clone(), bytes: text.into_bytes() }], &[])?;
            Some(Done::Bones(path))
        }
        Errand::List(folder) => Some(Done::Listed(folder.clone(), list(&folder)?)),
        Errand::Keep(unsaved) => {
            home.keep(unsaved.as_deref()).map_err(Failure::failed)?;
            None
        }
        Errand::Remember(remembered) => {
            home.remember(&remembered).map_err(Failure::failed)?;
            None
        }
        Errand::WakeUp => Some(Done::Woke(Box::new(home.remembered()), home.left_behind())),
        Errand::Forget(path) => {
            home.forget(&path);
            None
        }
    })
}

/// A clip's files: the rig with the clip, a VRM animation or an FBX, its events, and the helpers of engines.
fn export(path: &Path, shown: &Shown, settings: &BakeSettings) -> Result<Done, Failure> {
    let form = form(&BakeSettings { format: FileKind::of(path), ..settings.clone() });
    let made = export::baked(&shown.rig, &shown.baked, form).map_err(|error| Failure::failed(error.to_string()))?;
    let mut outputs = vec![
        Output { path: path.to_owned(), bytes: made.file },
        Output { path: path.with_extension("events.json"), bytes: made.events },
    ];
    for engine in engines(settings) {
        outputs.push(Output { path: path.with_file_name(engine.file), bytes: engine.helper() });
    }
    writer::write(&outputs, &shown.files)?;
    let warnings = shown.baked.warnings.iter().chain(&made.changes).cloned().collect();
    Ok(Done::Exported(outputs.into_iter().map(|output| output.path).collect(), warnings))
}

/// What a person could open there: folders, rigs, clips and texts; nothing hidden.
fn list(folder: &Path) -> Result<Vec<Listed>, Failure> {
    let cannot = |error: std::io::Error| {
        Failure::bad_input(format!("{}: cannot be read: {error}\n  help: choose another folder", folder.display()))
    };
    let mut entries: Vec<Listed> = std::fs::read_dir(folder)
        .map_err(cannot)?
        .flatten()
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_file = std::fs::metadata(entry.path()).ok()?.is_file();
            (!name.starts_with('.')).then_some(Listed { is_file, name })
        })
        .filter(|entry| !entry.is_file || is_ours(&entry.name))
        .collect();
    entries.sort_by_key(|entry| (entry.is_file, entry.name.to_lowercase(), entry.name.clone()));
    Ok(entries)
}

fn is_ours(name: &str) -> bool {
    let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ending == "toml" || clip_files::ENDINGS.contains(&ending.as_str()))
}
