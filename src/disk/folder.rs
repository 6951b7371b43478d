//! The folder of a batch: where its rigs come from, what of it is done, and where clips and records go.
//!
//! `DIR/RIG/NAME.glb` and `NAME.events.json` are for people and engines; `DIR/.surefoot/RIG/NAME.record` says that they are whole, and
//! of what. The record is put in its place last: a clip without one is baked again, to the same bytes. Several processes may work in
//! one folder; what a killed one left half-written is cleared by the next that is alone there.

use super::Failure;
use super::level::{self, Level};
use super::resolve;
use super::staged::staged;
use super::writer::{self, Output};
use crate::bake::Base;
use crate::batch::record::{self, Measured, Record};
use crate::batch::run::{Place, Stopped, Wanted};
use crate::batch::{Plan, Variation};
use crate::model::Scenario;
use crate::rig::Rig;
use crate::rig::mannequin::BUILTIN;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Prepared base clips, and meshes of grounds, that are kept.
const MOST_BASES: usize = 8;

/// A rig of the sweep.
pub struct RigFile {
    /// As the command line would name it.
    pub path: PathBuf,
    /// Every file that was read for it.
    pub files: Vec<PathBuf>,
    /// BLAKE3 of those.
    pub hash: String,
    /// Bytes of its document.
    pub size: u64,
}

/// The folder, and what a plan needs of the disk.
pub struct Folder<'a> {
    plan: &'a Plan,
    rigs: Vec<RigFile>,
    scenarios: Vec<PathBuf>,
    dir: PathBuf,
    wanted: Wanted,
    force: bool,
    inputs: Vec<PathBuf>,
    latest: Mutex<Option<(usize, Arc<Rig>)>>,
    bases: Mutex<BTreeMap<String, Arc<Base>>>,
    levels: Mutex<BTreeMap<PathBuf, Arc<Level>>>,
    hashes: Mutex<BTreeMap<PathBuf, String>>,
    _lock: Option<File>,
}

impl<'a> Folder<'a> {
    /// Makes the folder where it lacks, and clears what a killed process left if nobody else works there.
    pub fn open(
        plan: &'a Plan,
        rigs: Vec<RigFile>,
        scenarios: Vec<PathBuf>,
        dir: &Path,
        (wanted, force): (Wanted, bool),
        mut inputs: Vec<PathBuf>,
    ) -> Result<Folder<'a>, Failure> {
        let own = dir.join(".surefoot");
        let cannot = |error: std::io::Error| {
            Failure::failed(format!(
                "{}: cannot be written to: {error}\n  help: give -o a folder that is yours",
                dir.display()
            ))
        };
        if fs::metadata(dir).is_ok_and(|there| !there.is_dir()) {
            return Err(Failure::bad_input(format!("{}: this is a file\n  help: give -o a folder", dir.display())));
        }
        fs::create_dir_all(&own).map_err(cannot)?;
        // Not emptied: Windows may refuse that of a file that another process has locked.
        let lock = File::options().create(true).truncate(false).write(true).open(own.join("lock")).map_err(cannot)?;
        if lock.try_lock().is_ok() {
            for input in &plan.sweep.rigs {
                clear(&dir.join(&input.name));
                clear(&own.join(&input.name));
            }
            clear(dir);
            drop(lock.unlock());
        }
        drop(lock.lock_shared()); // a file system without locks does without
        inputs.extend(rigs.iter().flat_map(|rig| rig.files.clone()));
        inputs.extend(scenarios.clone());
        let (latest, bases, levels, hashes) = Default::default();
        let dir = dir.to_owned();
        Ok(Folder {
            plan,
            rigs,
            scenarios,
            dir,
            wanted,
            force,
            inputs,
            latest,
            bases,
            levels,
            hashes,
            _lock: Some(lock),
        })
    }

    /// The files that are never written over.
    pub fn inputs(&self) -> &[PathBuf] {
        &self.inputs
    }

    /// The record of a variation, if it is of this rig, scenario, settings and version and its files are there.
    pub fn record(&self, variation: &Variation) -> Option<Record> {
        let bytes = fs::read(self.record_path(variation)).ok()?;
        let record = Record::from_bytes(&bytes)?;
        let whole = |(ending, size): &(String, u64)| {
            fs::metadata(self.clip_path(variation, ending)).is_ok_and(|there| there.is_file() && there.len() == *size)
        };
        (record.identity == self.identity(variation)? && record.files.iter().all(whole)).then_some(record)
    }

    /// Whether its record is there and right.
    pub fn is_done(&self, variation: &Variation) -> bool {
        self.done(variation).is_some()
    }

    /// The rigs, loaded or not.
    pub fn rigs(&self) -> &[RigFile] {
        &self.rigs
    }

    /// A rig that was loaded already, for the first variations.
    pub fn hold(&self, index: usize, rig: Rig) {
        *lock(&self.latest) = Some((index, Arc::new(rig)));
    }

    fn clip_path(&self, variation: &Variation, ending: &str) -> PathBuf {
        self.dir.join(self.plan.rig_name(variation)).join(format!("{}.{ending}", variation.name))
    }

    fn record_path(&self, variation: &Variation) -> PathBuf {
        self.dir.join(".surefoot").join(self.plan.rig_name(variation)).join(format!("{}.record", variation.name))
    }

    fn identity(&self, variation: &Variation) -> Option<String> {
        let mut scenario = self.plan.scenario(variation).ok()?;
        let rig = &self.rigs[variation.rig];
        let file = resolve::base_file(&scenario, Some(&self.scenarios[variation.scenario]), &rig.path).ok()?;
        let base = match file {
            Some(file) if file != rig.path => self.hash_of(&file)?,
            _ => String::new(),
        };
        let ground = match level::level_file(&scenario, Some(&self.scenarios[variation.scenario])) {
            Some(file) => self
                .level(file, &mut scenario)
                .ok()?
                .files
                .iter()
                .map(|file| self.hash_of(file))
                .collect::<Option<String>>()?,
            None => String::new(),
        };
        let wanted = if self.wanted.pieces { "piece" } else { "file" };
        let cells = if self.wanted.cells { "with a picture" } else { "" };
        Some(record::identity(self.plan, variation, (&rig.hash, &base, &ground), &format!("{wanted} {cells}")))
    }

    /// The mesh of a ground, read once, laid into the scenario.
    fn level(&self, path: PathBuf, scenario: &mut Scenario) -> Result<Arc<Level>, String> {
        let held = lock(&self.levels).get(&path).cloned();
        if let Some(held) = held {
            level::put(scenario, &held.surface, &path).map_err(|failure| failure.message)?;
            return Ok(held);
        }
        let read = Arc::new(level::read(&path).map_err(|failure| failure.message)?);
        level::put(scenario, &read.surface, &path).map_err(|failure| failure.message)?;
        let mut levels = lock(&self.levels);
        if levels.len() >= MOST_BASES {
            levels.clear();
        }
        levels.insert(path, Arc::clone(&read));
        Ok(read)
    }

    fn hash_of(&self, path: &Path) -> Option<String> {
        if let Some(hash) = lock(&self.hashes).get(path) {
            return Some(hash.clone());
        }
        let hash = hash_files(&[path.to_owned()]).ok()?;
        lock(&self.hashes).insert(path.to_owned(), hash.clone());
        Some(hash)
    }
}

impl Place for Folder<'_> {
    fn rig(&self, index: usize) -> Result<Arc<Rig>, String> {
        let mut latest = lock(&self.latest);
        if let Some((_, rig)) = latest.as_ref().filter(|(held, _)| *held == index) {
            return Ok(Arc::clone(rig));
        }
        let file = &self.rigs[index];
        let loaded = resolve::rig(&file.path).map_err(|failure| failure.message)?;
        if hash_files(&loaded.files).ok().as_deref() != Some(&file.hash) {
            let path = file.path.display();
            return Err(format!("{path}: changed while the batch ran\n  help: run it again when the file is at rest"));
        }
        let rig = Arc::new(loaded.rig);
        *latest = Some((index, Arc::clone(&rig)));
        Ok(rig)
    }

    fn base(&self, variation: &Variation, rig: &Rig, scenario: &Scenario) -> Result<Option<Arc<Base>>, String> {
        let Some(base) = &scenario.base else { return Ok(None) };
        let key = format!("{} {} {base:?} {}", variation.rig, variation.scenario, scenario.character.leg_scale);
        if let Some(base) = lock(&self.bases).get(&key) {
            return Ok(Some(Arc::clone(base)));
        }
        let scenario_file = &self.scenarios[variation.scenario];
        let found = resolve::base(rig, scenario, Some(scenario_file), &self.rigs[variation.rig].path);
        let found = found.map_err(|failure| failure.message)?.map(|(_, base)| base);
        if let Some(base) = &found {
            let mut bases = lock(&self.bases);
            if bases.len() >= MOST_BASES {
                bases.clear();
            }
            bases.insert(key, Arc::clone(base));
        }
        Ok(found)
    }

    fn lay(&self, variation: &Variation, scenario: &mut Scenario) -> Result<(), String> {
        match level::level_file(scenario, Some(&self.scenarios[variation.scenario])) {
            Some(path) => self.level(path, scenario).map(|_| ()),
            None => Ok(()),
        }
    }

    fn done(&self, variation: &Variation) -> Option<Measured> {
        if self.force { None } else { self.record(variation).map(|record| record.measured) }
    }

    fn keep(&self, variation: &Variation, files: Vec<(String, Vec<u8>)>, mut record: Record) -> Result<(), Stopped> {
        record.identity = self.identity(variation).unwrap_or_default();
        record.files = files.iter().map(|(ending, bytes)| (ending.clone(), bytes.len() as u64)).collect();
        let clip = |(ending, bytes): (String, Vec<u8>)| Output { path: self.clip_path(variation, &ending), bytes };
        let mut outputs: Vec<Output> = files.into_iter().map(clip).collect();
        outputs.push(Output { path: self.record_path(variation), bytes: record.to_bytes() });
        writer::write(&outputs, &self.inputs).map_err(|failure| Stopped(failure.message))
    }
}

/// Loads a rig and hashes its files.
pub fn rig_file(path: &Path) -> Result<(RigFile, Rig), Failure> {
    let loaded = resolve::rig(path)?;
    let hash = hash_files(&loaded.files).map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))?;
    let size = match loaded.files.is_empty() {
        true => BUILTIN.len() as u64,
        false => loaded.files.iter().filter_map(|file| fs::metadata(file).ok()).map(|there| there.len()).sum(),
    };
    Ok((RigFile { path: path.to_owned(), files: loaded.files, hash, size }, loaded.rig))
}

/// BLAKE3 of files, one after the other; files that are not there count as nothing, for an override file may not be.
fn hash_files(files: &[PathBuf]) -> std::io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    for file in files {
        match fs::read(file) {
            Ok(bytes) => {
                hasher.update(&(bytes.len() as u64).to_le_bytes());
                hasher.update(&bytes);
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                hasher.update(&u64::MAX.to_le_bytes());
            }
            Err(error) => return Err(error),
        }
    }
    Ok(hasher.finalize().to_hex().to_string())
}

/// Removes what a killed process had not put in its place yet.
fn clear(folder: &Path) {
    let list = staged();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(writer::STAGED.0) && name.ends_with(writer::STAGED.1) && !list.contains(&entry.path()) {
            drop(fs::remove_file(entry.path()));
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
