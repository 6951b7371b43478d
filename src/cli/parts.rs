//! The calls that the subcommands make into the rows above, each with its errors sorted into exit codes.

use super::args::{Drive, Root};
use super::exit_code::Failure;
use crate::model::{Clip, ClipReport, Scenario};
use crate::rig::Rig;
use std::path::Path;

/// A baked clip with what is known of it.
pub struct Bake {
    /// Keys.
    pub clip: Clip,
    /// What the clip says about itself.
    pub report: ClipReport,
    /// For a person.
    pub warnings: Vec<String>,
}

/// What the arguments say about a bake.
pub struct BakeChoices<'a> {
    /// Name of the clip, if one was given.
    pub clip: Option<&'a str>,
    /// Hz.
    pub fps: f64,
    /// Instead of the scenario's.
    pub seed: Option<u64>,
    /// Root motion.
    pub root: Root,
    /// What moves the body.
    pub drive: Drive,
}

/// The rig inside of the program.
pub fn builtin_rig() -> Result<Rig, Failure> {
    Err(pending("the built-in rig"))
}

/// A rig from a file that is there.
pub fn load_rig(_path: &Path) -> Result<Rig, Failure> {
    Err(pending("loading a rig"))
}

/// The built-in rig's file, of that height in metres and with legs so many times as long.
pub fn mannequin(_height: Option<f64>, _leg_scale: Option<f64>) -> Result<Vec<u8>, Failure> {
    Err(pending("making a rig"))
}

/// What was found in a rig, for other programs.
pub fn inspect_json(_rig: &Rig) -> Result<serde_json::Value, Failure> {
    Err(pending("inspecting a rig"))
}

/// Runs a scenario on a rig.
pub fn bake(_rig: &Rig, _scenario: &Scenario, _choices: &BakeChoices) -> Result<Bake, Failure> {
    Err(pending("baking"))
}

/// The rig's document with that clip in it.
pub fn glb(_rig: &Rig, _clip: &Clip, _report: &ClipReport) -> Result<Vec<u8>, Failure> {
    Err(pending("writing a clip"))
}

/// The file that lies beside the clip: `{ clip name: report }`.
pub fn events(clip: &Clip, report: &ClipReport) -> Result<Vec<u8>, Failure> {
    let object = serde_json::json!({ clip.name.as_str(): report });
    let mut bytes = serde_json::to_vec_pretty(&object).map_err(|error| Failure::failed(error.to_string()))?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// A contact sheet as PNG bytes.
pub fn sheet(_rig: &Rig, _baked: &Bake) -> Result<Vec<u8>, Failure> {
    Err(pending("drawing a contact sheet"))
}

/// A contact sheet of a clip that lies in a file.
pub fn sheet_of_file(_path: &Path, _clip: Option<&str>) -> Result<Vec<u8>, Failure> {
    Err(pending("drawing a contact sheet"))
}

fn pending(what: &str) -> Failure {
    Failure::bad_input(format!("{what} is not in this version yet"))
}
