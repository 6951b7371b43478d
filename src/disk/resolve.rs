//! From the names in the arguments to what they hold: looks at the files, reads them, says what is wrong with them.

use super::{Exit, Failure};
use crate::bake::Base;
use crate::model::{Role, Scenario, ScenarioErrors, ScenarioSource, Sweep};
use crate::model::{scenario_text, sweep_text};
use crate::rig::mannequin::BUILTIN;
use crate::rig::{Rig, RigError};
use crate::{bake, mocap, rig};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The largest scenario that is read, bytes: past that it is some other file.
const LARGEST_SCENARIO: u64 = 4 << 20;

/// A rig and the files that it came from.
pub struct RigInput {
    /// The rig.
    pub rig: Rig,
    /// Every file that was read for it; none for the built-in rig.
    pub files: Vec<PathBuf>,
}

/// Loads the rig of that name.
pub fn rig(path: &Path) -> Result<RigInput, Failure> {
    rig_with(path, &BTreeMap::new())
}

/// The same, with a person's word on which node is which bone; the built-in rig knows its own.
pub fn rig_with(path: &Path, bones: &BTreeMap<Role, Option<usize>>) -> Result<RigInput, Failure> {
    if path.as_os_str() == "builtin" {
        return Ok(RigInput { rig: builtin_rig()?, files: Vec::new() });
    }
    plain_file(path, "a rig is a .glb, .gltf, .vrm or .fbx file; `builtin` is the built-in rig")?;
    if ending(path) == "toml" {
        return Err(Failure::bad_input(format!(
            "{}: a scenario stands where the rig should\n  help: the order is `surefoot bake RIG SCENARIO -o OUT.glb`",
            path.display()
        )));
    }
    let rig = load_rig(path, bones)?;
    let files = files_of(&rig, path);
    Ok(RigInput { rig, files })
}

/// The built-in rig.
pub fn builtin_rig() -> Result<Rig, Failure> {
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    rig::load_bytes("builtin", BUILTIN, &alone, None).map_err(|error| Failure::failed(error.to_string()))
}

/// A rig from a file that is there.
fn load_rig(path: &Path, bones: &BTreeMap<Role, Option<usize>>) -> Result<Rig, Failure> {
    rig::load_with(path, bones).map_err(|error| match error {
        RigError::Io { .. } => Failure::bad_input(format!("{error}\n  help: give a file that you may read")),
        error => Failure::bad_input(error.to_string()),
    })
}

/// The file that a scenario's base clip is from: `file` beside the scenario, else the rig's own.
pub fn base_file(
    scenario: &Scenario,
    scenario_file: Option<&Path>,
    rig_file: &Path,
) -> Result<Option<PathBuf>, Failure> {
    let Some(base) = &scenario.base else { return Ok(None) };
    match &base.file {
        Some(file) => {
            let folder = scenario_file.and_then(Path::parent).unwrap_or(Path::new(""));
            Ok(Some(folder.join(file)))
        }
        None if rig_file.as_os_str() == "builtin" => Err(Failure::bad_input(
            "[base]: the built-in rig has no clips of its own\n  help: name a motion file: file = \"walk.bvh\""
                .to_owned(),
        )),
        None => Ok(Some(rig_file.to_owned())),
    }
}

/// The scenario's base clip on the rig, and the file that it is from.
pub fn base(
    rig: &Rig,
    scenario: &Scenario,
    scenario_file: Option<&Path>,
    rig_file: &Path,
) -> Result<Option<(PathBuf, Arc<Base>)>, Failure> {
    let Some(path) = base_file(scenario, scenario_file, rig_file)? else { return Ok(None) };
    let Some(base) = &scenario.base else { return Ok(None) };
    let bad = |error: String| Failure::bad_input(format!("[base]: {error}"));
    plain_file(&path, "a base clip is in a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")?;
    let file = mocap::load(&path).map_err(|error| bad(error.to_string()))?;
    let clip = match &base.clip {
        Some(name) => file.find(name).map_err(|error| bad(error.to_string()))?,
        None if file.clips.len() == 1 => 0,
        None => {
            let names = file.clips.join(", ");
            return Err(bad(format!("{} has several clips: name one with clip = \"...\": {names}", path.display())));
        }
    };
    let reading = file.reading(clip, &mocap::Options::default()).map_err(|error| bad(error.to_string()))?;
    let base = bake::base::prepare(rig, scenario, &reading, base.file.is_none().then_some(clip))
        .map_err(|error| bad(error.to_string()))?;
    Ok(Some((path, Arc::new(base))))
}

/// Reads a scenario.
pub fn scenario(path: &Path) -> Result<Scenario, Failure> {
    scenario_text(path).map(|(scenario, _)| scenario)
}

/// Reads a scenario, and gives its text too.
pub fn scenario_text(path: &Path) -> Result<(Scenario, String), Failure> {
    const REMEDY: &str = "a scenario is a TOML text; the order is `surefoot bake RIG SCENARIO -o OUT.glb`";
    let text = text_of(path, "`surefoot new scenario -o FILE.toml` writes one to start from", "a scenario", REMEDY)?;
    let scenario = scenario_text::parse(&path.display().to_string(), &text).map_err(faulty)?;
    Ok((scenario, text))
}

/// Reads a sweep, with the places of its values.
pub fn sweep(path: &Path) -> Result<(Sweep, ScenarioSource), Failure> {
    const REMEDY: &str = "a sweep is a TOML text; the order is `surefoot batch SWEEP -o FOLDER`";
    let text = text_of(path, "`surefoot new sweep -o FILE.toml` writes one to start from", "a sweep", REMEDY)?;
    sweep_text::read(&path.display().to_string(), &text).map_err(faulty)
}

fn text_of(path: &Path, lacking: &str, what: &str, remedy: &str) -> Result<String, Failure> {
    let there = plain_file(path, lacking)?;
    let not_text = |wrong: &str| Failure::bad_input(format!("{}: {wrong}\n  help: {remedy}", path.display()));
    if there.len() > LARGEST_SCENARIO {
        return Err(not_text(&format!("too large for {what}")));
    }
    let bytes =
        fs::read(path).map_err(|error| Failure::bad_input(format!("{}: cannot be read: {error}", path.display())))?;
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|byte| **byte == b'\n').count() + 1;
        not_text(&format!("line {line} is not UTF-8 text"))
    })
}

/// A failure that holds the faults of a scenario or a sweep.
pub fn faulty(errors: ScenarioErrors) -> Failure {
    let count = errors.faults.len();
    let faults = if count == 1 { "1 fault".to_owned() } else { format!("{count} faults") };
    let message = format!("{faults} in {}; nothing was written", errors.name);
    Failure { exit: Exit::BadInput, message, faults: Some(Box::new(errors)) }
}

/// Makes sure that a path leads to a plain file.
pub fn plain_file(path: &Path, remedy: &str) -> Result<fs::Metadata, Failure> {
    let complain =
        |what: String, remedy: &str| Err(Failure::bad_input(format!("{}: {what}\n  help: {remedy}", path.display())));
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => complain("this is a folder, not a file".to_owned(), remedy),
        Ok(there) if !there.is_file() => complain("this is not a plain file".to_owned(), remedy),
        Ok(there) => Ok(there),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => match neighbour(path) {
            Some(name) => complain("no such file".to_owned(), &format!("did you mean {name}?")),
            None => complain("no such file".to_owned(), remedy),
        },
        Err(error) => complain(format!("cannot be read: {error}"), remedy),
    }
}

/// A file of the same folder whose name differs in its ending or its case only.
fn neighbour(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_stem()?.to_string_lossy().to_lowercase();
    let entries = fs::read_dir(folder).ok()?;
    let mut alike: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| path.with_file_name(entry.file_name()))
        .filter(|other| other.file_stem().is_some_and(|stem| stem.to_string_lossy().to_lowercase() == wanted))
        .filter(|other| other.is_file())
        .collect();
    alike.sort();
    alike.first().map(|other| other.display().to_string())
}

/// The rig's file, its override file, and the buffers and images that lie beside it.
fn files_of(rig: &Rig, path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = vec![path.to_path_buf(), path.with_extension("bones.toml")];
    for list in ["buffers", "images"] {
        let entries = rig.document.json.get(list).and_then(|list| list.as_array()).into_iter().flatten();
        let uris = entries.filter_map(|entry| entry.get("uri").and_then(|uri| uri.as_str()));
        for uri in uris.filter(|uri| !uri.starts_with("data:")) {
            files.push(folder.join(percent_encoding::percent_decode_str(uri).decode_utf8_lossy().as_ref()));
        }
    }
    files
}

fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}
