//! The file of a ground of triangles: found beside its scenario, read, and looked at where the character is to stand.

use super::Failure;
use super::resolve::plain_file;
use crate::maths::real;
use crate::model::scenario::GroundKind;
use crate::model::{Scenario, Surface, Terrain};
use crate::rig::document::read_file;
use crate::rig::level::level;
use glam::DVec2;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A ground that was read, and every file that was read for it: the one that the scenario names first.
pub struct Level {
    /// Its triangles.
    pub surface: Arc<Surface>,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// The file of the scenario's mesh, where it has one: beside the scenario.
pub fn level_file(scenario: &Scenario, scenario_file: Option<&Path>) -> Option<PathBuf> {
    let GroundKind::Mesh { file, .. } = &scenario.ground.kind else { return None };
    let folder = scenario_file.and_then(Path::parent).unwrap_or(Path::new(""));
    Some(folder.join(file))
}

/// Reads the scenario's mesh, where it has one, and lays it into the scenario.
pub fn lay(scenario: &mut Scenario, scenario_file: Option<&Path>) -> Result<Option<Level>, Failure> {
    let Some(path) = level_file(scenario, scenario_file) else { return Ok(None) };
    let read = read(&path)?;
    put(scenario, &read.surface, &path)?;
    Ok(Some(read))
}

/// Lays triangles that were read already into a scenario; `path` is their file's, for messages.
pub fn put(scenario: &mut Scenario, read: &Arc<Surface>, path: &Path) -> Result<(), Failure> {
    scenario.ground.lay(read);
    stands(scenario).map_err(|what| Failure::bad_input(format!("[ground]: {}: {what}", path.display())))
}

/// A warning for what was left out of a file.
pub fn left_out(level: &Level) -> Option<String> {
    let count = level.surface.dropped;
    let path = level.files.first().map(|path| path.display().to_string()).unwrap_or_default();
    let of = count + level.surface.len();
    (count > 0).then(|| format!("[ground]: {path}: {count} of {of} triangles have no area and were left out"))
}

/// Reads a mesh.
pub fn read(path: &Path) -> Result<Level, Failure> {
    plain_file(path, "a ground's mesh is a .glb or .gltf file; its name counts from the scenario's folder")
        .map_err(|failure| Failure::bad_input(format!("[ground]: {}", failure.message)))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = RefCell::new(vec![path.to_owned()]);
    let resolve = |relative: &str| {
        let beside = folder.join(relative);
        let bytes = read_file(&beside)?;
        files.borrow_mut().push(beside);
        Ok(bytes)
    };
    let name = path.display().to_string();
    let bytes =
        read_file(path).map_err(|error| Failure::bad_input(format!("[ground]: {name}: cannot be read: {error}")))?;
    let surface = level(&name, &bytes, &resolve).map_err(|error| Failure::bad_input(format!("[ground]: {error}")))?;
    Ok(Level { surface: Arc::new(surface), files: files.into_inner() })
}

/// Whether anybody could stand where the character starts.
fn stands(scenario: &Scenario) -> Result<(), String> {
    let kind = &scenario.ground.kind;
    let GroundKind::Mesh { surface: Some(surface), .. } = kind else { return Ok(()) };
    let terrain = Terrain::new(&scenario.ground);
    let spot = terrain.spot(DVec2::ZERO);
    let [low, high] = surface.bounds();
    if !spot.holds {
        let ceiling = Some(kind.ceiling()).filter(|ceiling| ceiling.is_finite());
        let ceiling = ceiling.map_or_else(String::new, |ceiling| format!(" under the ceiling of {ceiling} m"));
        let over = surface.ground(DVec2::ZERO, f64::INFINITY).map(|found| found.0);
        let help = match over {
            Some(height) => format!("its face there is {height:.2} m up: raise `ceiling` over that, or lower the mesh"),
            None => "move the mesh so that floor lies under its origin; if it does, its faces are seen from below: flip them, or make the material double-sided".to_owned(),
        };
        return Err(format!(
            "nothing under the start: no face faces up at x = 0, z = 0{ceiling}\n  help: the mesh reaches from x {:.2} to {:.2} and z {:.2} to {:.2} m; {help}",
            low.x, high.x, low.z, high.z
        ));
    }
    let (leans, most) = (real::acos(spot.normal.y.clamp(-1.0, 1.0)), real::atan2(scenario.ground.friction, 1.0));
    if leans > most {
        return Err(format!(
            "the ground under the start leans by {:.0} degrees, and its friction holds no foot past {:.0}\n  help: start on a gentler place, or raise `friction`",
            leans.to_degrees(),
            most.to_degrees()
        ));
    }
    Ok(())
}
