//! The arguments of everything beside baking and clips: `inspect`, `new`, `sheet`, `studio`, `completions`, `man`, `help`.

use super::super::forms::{number, png_path};
use super::super::help::words;
use clap::ValueEnum;
use std::path::PathBuf;

/// `surefoot inspect`.
#[derive(Debug, clap::Args)]
pub struct InspectArgs {
    /// A .glb, .gltf, .vrm or .fbx file, or `builtin` for the built-in rig
    #[arg(value_name = "RIG")]
    pub rig: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `surefoot new`.
#[derive(Debug, clap::Args)]
pub struct NewArgs {
    /// What to write
    #[arg(value_enum)]
    pub what: New,
    /// Where to write [default: stdout; for a rig exports/mannequin.glb]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// For a scenario or a sweep: write its JSON Schema, with which an editor completes and checks the TOML
    #[arg(long)]
    pub schema: bool,
    /// For a rig: height in metres, with legs of ordinary length [default: 1.7]
    #[arg(long, value_name = "M", value_parser = |text: &str| number(text, 0.3, 5.0, "m"))]
    pub height: Option<f64>,
    /// For a rig: factor on the length of the legs; the height changes with it [default: 1]
    #[arg(long, value_name = "N", value_parser = |text: &str| number(text, 0.3, 3.0, "times"))]
    pub leg_scale: Option<f64>,
}

/// What `new` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum New {
    /// A copy of the built-in rig, in other proportions with --height and --leg-scale
    Rig,
    /// A commented scenario with every key
    Scenario,
    /// A commented sweep with every key
    Sweep,
}

/// `surefoot sheet`.
#[derive(Debug, clap::Args)]
pub struct SheetArgs {
    /// A .glb, .gltf, .vrm or .fbx file with clips
    #[arg(value_name = "CLIP")]
    pub file: PathBuf,
    /// The picture to write
    #[arg(short, long, value_name = "FILE.png", value_parser = png_path)]
    pub output: PathBuf,
    /// Which clip of the file [default: the last]
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
}

/// `surefoot studio`.
#[derive(Debug, clap::Args)]
pub struct StudioArgs {
    /// A scenario (.toml), a rig (.glb, .gltf, .vrm) or a clip to audit (.bvh, .fbx, .vrma)
    /// [default: the built-in rig]
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Play and edit for this long, print the frame times as JSON, and close
    #[arg(long, value_name = "SECONDS")]
    pub measure: Option<f64>,
}

/// `surefoot completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Where the script belongs:
  bash        surefoot completions bash > ~/.local/share/bash-completion/completions/surefoot
  zsh         surefoot completions zsh > DIR/_surefoot, with DIR one of your $fpath
  fish        surefoot completions fish > ~/.config/fish/completions/surefoot.fish
  PowerShell  surefoot completions powershell >> $PROFILE")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

/// `surefoot man`.
#[derive(Debug, clap::Args)]
#[command(after_help = "`surefoot man -o ~/.local/share/man/man1` makes `man surefoot-bake` work for you.")]
pub struct ManArgs {
    /// The folder for surefoot.1, surefoot-bake.1 and so on
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// `surefoot help`.
#[derive(Debug, clap::Args)]
pub struct HelpArgs {
    /// What to explain
    #[arg(value_name = "COMMAND|TOPIC", value_parser = words())]
    pub word: Option<String>,
}
