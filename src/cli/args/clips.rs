//! The arguments of the commands that read clips: `audit`, `correct` and `retarget`.

use super::super::forms::{axis, clip_name, csv_path, fps, glb_path, html_path, number, rule, toml_path};
use super::{Curves, Root};
use crate::model::findings::Rule;
use std::path::PathBuf;

/// `surefoot audit`.
#[derive(Debug, clap::Args)]
pub struct AuditArgs {
    /// .bvh, .fbx, .glb, .gltf, .vrm or .vrma files, folders of them, or patterns with * and ?
    #[arg(value_name = "CLIP", required = true)]
    pub clips: Vec<PathBuf>,
    /// Audit only the clip of this name [default: every clip of each file]
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// Write the findings as JSON: an object for one clip, an array for several; - is stdout
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Write a table with one row per frame
    #[arg(long, value_name = "FILE.csv", value_parser = csv_path)]
    pub csv: Option<PathBuf>,
    /// Write a page for a browser: stick figure, footprints, curves, flags
    #[arg(long, value_name = "FILE.html", value_parser = html_path)]
    pub html: Option<PathBuf>,
    /// Exit with 1 if any flag remains that is not waived
    #[arg(long)]
    pub strict: bool,
    /// Flags that a person has accepted, in TOML; --write-waivers writes a file to start from
    #[arg(long, value_name = "FILE.toml")]
    pub waive: Option<PathBuf>,
    /// Write a waiver for every flag found
    #[arg(long, value_name = "FILE.toml", value_parser = toml_path)]
    pub write_waivers: Option<PathBuf>,
    /// Frames per second, if the file states the wrong rate
    #[arg(long, value_name = "N", value_parser = |text: &str| number(text, 1.0, 2000.0, "frames per second"))]
    pub fps: Option<f64>,
    /// The file's up axis, if it is not recognised: X, Y or Z, also with a sign (-Z)
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres per unit of the file, if it is not recognised: 0.01 for centimetres
    #[arg(long, value_name = "METRES", value_parser = |text: &str| number(text, 1e-6, 1e3, "metres a unit"))]
    pub unit: Option<f64>,
    /// Height of the floor above the file's zero, in metres, if it is not recognised from the feet
    #[arg(long, value_name = "M", value_parser = |text: &str| number(text, -1e4, 1e4, "m"), allow_hyphen_values = true)]
    pub floor: Option<f64>,
    /// How many clips to audit at once [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
}

/// `surefoot correct`.
#[derive(Debug, clap::Args)]
pub struct CorrectArgs {
    /// A .bvh, .fbx, .glb, .gltf, .vrm or .vrma file
    #[arg(value_name = "CLIP")]
    pub clip_file: PathBuf,
    /// The corrected file: of the same format; for .fbx and .gltf a .glb
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Correct only the clip of this name [default: every clip of the file]
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// Write the findings before and after, and every change, as JSON; - is stdout
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Repair only what these rules flag: foot-placement, balance, foot-slide, penetration, float,
    /// ballistic, timing, drift
    #[arg(long, value_name = "RULE,..", value_delimiter = ',', value_parser = rule)]
    pub rules: Vec<Rule>,
    /// Of .glb, .gltf, .vrm and .fbx: write skeleton and clips alone, no mesh, no image
    #[arg(long)]
    pub only_animation: bool,
    /// Change the frame rate of a clip that plays too slowly or too fast
    #[arg(long)]
    pub retime: bool,
    /// Frames per second, if the file states the wrong rate
    #[arg(long, value_name = "N", value_parser = |text: &str| number(text, 1.0, 2000.0, "frames per second"))]
    pub fps: Option<f64>,
    /// The file's up axis, if it is not recognised: X, Y or Z, also with a sign (-Z)
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres per unit of the file, if it is not recognised: 0.01 for centimetres
    #[arg(long, value_name = "METRES", value_parser = |text: &str| number(text, 1e-6, 1e3, "metres a unit"))]
    pub unit: Option<f64>,
    /// Height of the floor above the file's zero, in metres, if it is not recognised from the feet
    #[arg(long, value_name = "M", value_parser = |text: &str| number(text, -1e4, 1e4, "m"), allow_hyphen_values = true)]
    pub floor: Option<f64>,
}

/// `surefoot retarget`.
#[derive(Debug, clap::Args)]
pub struct RetargetArgs {
    /// The clip: a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file
    #[arg(value_name = "CLIP")]
    pub clip_file: PathBuf,
    /// The character: a .glb, .gltf, .vrm or .fbx file, or `builtin` for the built-in rig
    #[arg(value_name = "RIG")]
    pub rig: PathBuf,
    /// Where to write the new clip: .glb: in a copy of the rig's file; .vrma: the motion alone, as a VRM
    /// animation; .fbx: skeleton and take
    #[arg(short, long, value_name = "OUT.glb|OUT.vrma|OUT.fbx", value_parser = glb_path)]
    pub output: PathBuf,
    /// Which clip of the file; required if it has several
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// Name of the new clip [default: the clip's own]
    #[arg(long, value_name = "NAME", value_parser = clip_name)]
    pub name: Option<String>,
    /// Keys per second [default: the clip's own rate, or the whole fraction of it that is at most 60]
    #[arg(long, value_name = "N", value_parser = fps)]
    pub fps: Option<f64>,
    /// Which node carries the movement over the ground (root motion) [default: root; hips with
    /// --only-animation where the rig has no root bone]
    #[arg(long, value_enum)]
    pub root: Option<Root>,
    /// How the keys are joined
    #[arg(long, value_enum, default_value_t = Curves::Linear)]
    pub curves: Curves,
    /// Write skeleton and clip alone, for a character that is in the scene already: no mesh, no image
    #[arg(long)]
    pub only_animation: bool,
    /// Leave out the two nodes that show the foot contacts, contact_L and contact_R
    #[arg(long)]
    pub no_contact_nodes: bool,
    /// The clip file's up axis, if it is not recognised: X, Y or Z, also with a sign (-Z)
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres per unit of the clip file, if it is not recognised: 0.01 for centimetres
    #[arg(long, value_name = "METRES", value_parser = |text: &str| number(text, 1e-6, 1e3, "metres a unit"))]
    pub unit: Option<f64>,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}
