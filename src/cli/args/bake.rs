//! The arguments of the commands that bake: `bake` and `batch`.

use super::super::forms::{assist, clip_name, engine, fps, glb_path, numbers, png_path, svg_path};
use super::{Assist, Curves, Drive, Root};
use crate::export::engine::Engine;
use clap::ArgGroup;
use std::path::PathBuf;

/// `surefoot bake`.
#[derive(Debug, clap::Args)]
#[command(group(ArgGroup::new("what").args(["scenario", "demo"]).required(true)))]
#[command(override_usage = "surefoot bake [OPTIONS] <RIG> <SCENARIO> --output <OUT.glb|OUT.vrma|OUT.fbx>\n       \
                            surefoot bake [OPTIONS] <RIG> --demo")]
pub struct BakeArgs {
    /// The character: a .glb, .gltf, .vrm or .fbx file, or `builtin` for the built-in rig
    #[arg(value_name = "RIG")]
    pub rig: PathBuf,
    /// What happens to it, in TOML; `surefoot new scenario` prints an example
    #[arg(value_name = "SCENARIO")]
    pub scenario: Option<PathBuf>,
    /// Bake a shove of 60 N s from the left instead of a scenario
    #[arg(long)]
    pub demo: bool,
    /// .glb: a copy of the rig's file with the new clip; .vrma: a VRM animation; .fbx: skeleton and take
    /// [default with --demo: exports/demo.glb]
    #[arg(short, long, value_name = "OUT.glb|OUT.vrma|OUT.fbx", value_parser = glb_path, required_unless_present = "demo")]
    pub output: Option<PathBuf>,
    /// Also draw the clip as a contact sheet
    #[arg(long, value_name = "FILE.png", value_parser = png_path)]
    pub sheet: Option<PathBuf>,
    /// Also plot the run: speed, capture point and centre of pressure against the feet, contacts
    #[arg(long, value_name = "FILE.svg", value_parser = svg_path)]
    pub plot: Option<PathBuf>,
    /// Name of the new clip [default: from the scenario's title]
    #[arg(long, value_name = "NAME", value_parser = clip_name)]
    pub clip: Option<String>,
    /// Frames per second
    #[arg(long, value_name = "N", default_value = "30", value_parser = fps)]
    pub fps: f64,
    /// Seed of the random draws [default: the scenario's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(0..=1 << 53))]
    pub seed: Option<u64>,
    /// Which node carries the movement over the ground (root motion) [default: root; for rigs without a
    /// root bone what --engine and --only-animation need]
    #[arg(long, value_enum)]
    pub root: Option<Root>,
    /// What moves the body; the result says which one `auto` kept, and why
    #[arg(long, value_enum, default_value_t = Drive::Auto)]
    pub drive: Drive,
    /// Limit of the helping torque (N m) and force (N) on the ragdoll's root
    #[arg(long, value_name = "off|auto|NM[,N]", default_value = "auto", value_parser = assist)]
    pub assist: Assist,
    /// How far the ragdoll looks ahead for a way to keep its feet: 0 not at all, 3 for minutes
    #[arg(long, value_name = "0..3", default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=3))]
    pub effort: u8,
    /// How the keys are joined
    #[arg(long, value_enum, default_value_t = Curves::Linear)]
    pub curves: Curves,
    /// Also write the ground, the platform, boxes and balls into the file, as animated nodes
    #[arg(long)]
    pub props: bool,
    /// Write skeleton and clip alone, for a character that is in the scene already: no mesh, no image
    #[arg(long, conflicts_with = "props")]
    pub only_animation: bool,
    /// Leave out the two nodes that show the foot contacts, contact_L and contact_R
    #[arg(long)]
    pub no_contact_nodes: bool,
    /// Bake only one cycle of a steady walk or stand, which repeats without a seam; the clip's name
    /// ends in _loop
    #[arg(long = "loop")]
    pub looped: bool,
    /// Also write a helper for each of these engines, which turns the clip's contacts and events into the
    /// engine's own: three, blender, bevy, godot, unity, unreal
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', value_parser = engine)]
    pub engine: Vec<&'static Engine>,
    /// If the character falls, write nothing and exit with 1
    #[arg(long)]
    pub require_balance: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `surefoot batch`.
#[derive(Debug, clap::Args)]
pub struct BatchArgs {
    /// What varies, in TOML; `surefoot new sweep` prints an example
    #[arg(value_name = "SWEEP")]
    pub sweep: PathBuf,
    /// The folder for the results: clips, manifest.csv and .json, sheet.png, coverage.svg. Clips that are
    /// complete there are kept, so that the same command continues an interrupted batch
    #[arg(short, long, value_name = "DIR", required_unless_present = "dry_run")]
    pub output: Option<PathBuf>,
    /// How many clips to bake at once [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Bake only the variations with these numbers, counted from 1. Writes no manifest and no pictures:
    /// run the batch without --only when all are baked
    #[arg(long, value_name = "A-B", value_parser = numbers)]
    pub only: Option<(usize, usize)>,
    /// Exit with 0 even if variations failed, once all were tried: for chunks of a farm's job, so that
    /// the merge after them still runs
    #[arg(long)]
    pub tolerant: bool,
    /// Bake again what is complete already
    #[arg(long)]
    pub force: bool,
    /// Only list the variations and estimate the time and the space they take
    #[arg(long, conflicts_with_all = ["only", "force", "merge"])]
    pub dry_run: bool,
    /// Write one file per rig with all of its clips, instead of one file per clip
    #[arg(long)]
    pub merge: bool,
    /// Write skeletons and clips alone, for characters that are in the scene already, as
    /// `only_animation = true` in [bake]
    #[arg(long, conflicts_with_all = ["openjd", "slurm"])]
    pub only_animation: bool,
    /// Do not draw sheet.png
    #[arg(long)]
    pub no_sheet: bool,
    /// Also write each variation's scenario, to bake or to open in the studio
    #[arg(long)]
    pub scenarios: bool,
    /// Do not bake: write a render farm's job (an Open Job Description bundle) into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["only", "dry_run", "force"])]
    pub openjd: Option<PathBuf>,
    /// Do not bake: write a Slurm job (array and merge scripts) into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["only", "dry_run", "force"])]
    pub slurm: Option<PathBuf>,
    /// How many variations one task of a farm's job bakes
    #[arg(long, value_name = "N", default_value = "24", value_parser = clap::value_parser!(u32).range(1..))]
    pub chunk: u32,
    /// Print the manifest as one JSON object
    #[arg(long)]
    pub json: bool,
}
