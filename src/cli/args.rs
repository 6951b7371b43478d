//! The arguments as text: what they are called, their forms and ranges. Opens nothing.

use super::forms::{
    assist, axis, clip_name, csv_path, engine, fps, glb_path, html_path, number, numbers, png_path, rule, svg_path,
    toml_path,
};
use crate::export::engine::Engine;
use crate::model::findings::Rule;
use clap::{ArgGroup, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Reactive stepping and balance, baked into glTF animation clips.
#[derive(Debug, Parser)]
#[command(name = "surefoot", version, about, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 done (a fall is a result too); 1 bake --require-balance fell, or audit --strict found flags; 2 bad \
                        usage or input; 3 the work could not be completed."
)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Bake a scenario onto a rig: one new clip in a copy of the rig's file
    Bake(BakeArgs),
    /// Find the frames of captured or keyed clips that no balanced person could have produced
    Audit(AuditArgs),
    /// Repair what an audit flags: hold feet, move plants, bring the body back over them; beside the original
    Correct(CorrectArgs),
    /// Put a clip of another skeleton onto a rig: by humanoid role, feet held
    Retarget(RetargetArgs),
    /// Bake every variation of a sweep: clips, a table of what each does, pictures
    Batch(BatchArgs),
    /// Say what was found in a rig: bones, sizes, masses, feet
    Inspect(InspectArgs),
    /// Write a rig, a scenario or a sweep to start from
    New(NewArgs),
    /// Draw a clip as a contact sheet
    Sheet(SheetArgs),
    /// Place disturbances by hand and see the reaction at once; audit clips; compare variations
    Studio(StudioArgs),
}

/// `surefoot bake`.
#[derive(Debug, clap::Args)]
#[command(group(ArgGroup::new("what").args(["scenario", "demo"]).required(true)))]
pub struct BakeArgs {
    /// .glb, .gltf or .vrm; `builtin` is the rig inside of the program
    #[arg(value_name = "RIG")]
    pub rig: PathBuf,
    /// What happens, in TOML; `surefoot new scenario` writes an example
    #[arg(value_name = "SCENARIO")]
    pub scenario: Option<PathBuf>,
    /// Bake a shove of 60 Ns from the left instead of a scenario
    #[arg(long)]
    pub demo: bool,
    /// Where the copy with the new clip goes, or a .vrma: the motion alone, as a VRM animation; with --demo exports/demo.glb where
    /// left out
    #[arg(short, long, value_name = "OUT.glb|OUT.vrma", value_parser = glb_path, required_unless_present = "demo")]
    pub output: Option<PathBuf>,
    /// Also draw the clip as a contact sheet
    #[arg(long, value_name = "FILE.png", value_parser = png_path)]
    pub sheet: Option<PathBuf>,
    /// Also draw the run: speed, centre of mass, ξ and pressure against the support, contacts, lanes
    #[arg(long, value_name = "FILE.svg", value_parser = svg_path)]
    pub plot: Option<PathBuf>,
    /// Name of the new clip; made from the scenario's title where left out
    #[arg(long, value_name = "NAME", value_parser = clip_name)]
    pub clip: Option<String>,
    /// Frames per second
    #[arg(long, value_name = "N", default_value = "30", value_parser = fps)]
    pub fps: f64,
    /// Starts the random draws; the scenario's own where left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(0..=1 << 53))]
    pub seed: Option<u64>,
    /// Which node carries the way over the ground
    #[arg(long, value_enum, default_value_t = Root::Root)]
    pub root: Root,
    /// What moves the body: the pendulum's path, or joint torques and contacts; `auto` tries both and says which it kept
    #[arg(long, value_enum, default_value_t = Drive::Auto)]
    pub drive: Drive,
    /// Bound on the help that the ragdoll's root gets: off, auto, or Nm[,N]
    #[arg(long, value_name = "off|auto|NM[,N]", default_value = "auto", value_parser = assist)]
    pub assist: Assist,
    /// Also write the ground, the platform, boxes and balls into the file, as animated nodes
    #[arg(long)]
    pub props: bool,
    /// Bake only a cycle that begins again without a seam: a stride of a steady walk, or of a stand; its name ends in _loop
    #[arg(long = "loop")]
    pub looped: bool,
    /// Also write, beside the clip, what turns its contacts and events into an engine's own: three, blender, bevy, godot, unity, unreal
    #[arg(long, value_name = "NAME,..", value_delimiter = ',', value_parser = engine)]
    pub engine: Vec<&'static Engine>,
    /// Exit 1 and write nothing if the character falls
    #[arg(long)]
    pub require_balance: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `surefoot audit`.
#[derive(Debug, clap::Args)]
pub struct AuditArgs {
    /// .bvh, .fbx, .glb, .gltf, .vrm or .vrma files, folders of them, or patterns with * and ?
    #[arg(value_name = "CLIP", required = true)]
    pub clips: Vec<PathBuf>,
    /// Only the clip of that name; every clip of each file where left out
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// Write the findings as JSON: one object for one clip, an array for several; - is stdout
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Write a table with a row a frame
    #[arg(long, value_name = "FILE.csv", value_parser = csv_path)]
    pub csv: Option<PathBuf>,
    /// Write a page to look through: stick figure, footprints, curves, flags
    #[arg(long, value_name = "FILE.html", value_parser = html_path)]
    pub html: Option<PathBuf>,
    /// Exit 1 if a flag stands that is not waived
    #[arg(long)]
    pub strict: bool,
    /// Flags that a person accepted, in TOML; --write-waivers writes one to start from
    #[arg(long, value_name = "FILE.toml")]
    pub waive: Option<PathBuf>,
    /// Write a waiver for every flag that there is
    #[arg(long, value_name = "FILE.toml", value_parser = toml_path)]
    pub write_waivers: Option<PathBuf>,
    /// Frames per second, where the file is wrong about it
    #[arg(long, value_name = "N", value_parser = |text: &str| number(text, 1.0, 2000.0, "frames per second"))]
    pub fps: Option<f64>,
    /// The file's up axis, where it was not found: X, Y or Z, with a sign if you like
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres a unit of the file, where it was not found: 0.01 for centimetres
    #[arg(long, value_name = "METRES", value_parser = |text: &str| number(text, 1e-6, 1e3, "metres a unit"))]
    pub unit: Option<f64>,
    /// Height of the floor over the file's zero in metres, where the feet mislead
    #[arg(long, value_name = "M", value_parser = |text: &str| number(text, -1e4, 1e4, "m"), allow_hyphen_values = true)]
    pub floor: Option<f64>,
    /// How many clips at once; as many as there are cores where left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
}

/// `surefoot batch`.
#[derive(Debug, clap::Args)]
pub struct BatchArgs {
    /// What varies, in TOML; `surefoot new sweep` writes an example
    #[arg(value_name = "SWEEP")]
    pub sweep: PathBuf,
    /// The folder of the results: a folder of clips for each rig, manifest.csv and .json, sheet.png, coverage.svg. What is done there
    /// already is kept, so the same command goes on where it stopped
    #[arg(short, long, value_name = "DIR", required_unless_present = "dry_run")]
    pub output: Option<PathBuf>,
    /// How many clips at once; as many as there are cores where left out
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Only the variations of those numbers, from 1; no manifest and no pictures: run it without --only when all are done
    #[arg(long, value_name = "A-B", value_parser = numbers)]
    pub only: Option<(usize, usize)>,
    /// Exit 0 although a variation failed, once all were tried: for a farm's chunks, so that the merge after them still runs
    #[arg(long)]
    pub tolerant: bool,
    /// Bake again what is done already
    #[arg(long)]
    pub force: bool,
    /// Only list the variations, and say what they will take
    #[arg(long, conflicts_with_all = ["only", "force", "merge"])]
    pub dry_run: bool,
    /// One file a rig with all of its clips, instead of a file a clip
    #[arg(long)]
    pub merge: bool,
    /// No sheet.png
    #[arg(long)]
    pub no_sheet: bool,
    /// Also write each variation's scenario, for `surefoot bake` and the studio
    #[arg(long)]
    pub scenarios: bool,
    /// Instead of baking write a job for a render farm: an Open Job Description bundle into that folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["only", "dry_run", "force"])]
    pub openjd: Option<PathBuf>,
    /// Instead of baking write a job for Slurm: array and merge scripts into that folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["only", "dry_run", "force"])]
    pub slurm: Option<PathBuf>,
    /// Variations of one task of a farm's job
    #[arg(long, value_name = "N", default_value = "24", value_parser = clap::value_parser!(u32).range(1..))]
    pub chunk: u32,
    /// Print the manifest as one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `surefoot inspect`.
#[derive(Debug, clap::Args)]
pub struct InspectArgs {
    /// .glb, .gltf or .vrm; `builtin` is the rig inside of the program
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
    /// Where to; a scenario or a sweep goes to stdout where left out, a rig to exports/mannequin.glb
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// rig: metres from the ground to the top of the head, with ordinary legs; 1.7 where left out
    #[arg(long, value_name = "M", value_parser = |text: &str| number(text, 0.3, 5.0, "m"))]
    pub height: Option<f64>,
    /// rig: times the legs' ordinary length; the height changes with them
    #[arg(long, value_name = "N", value_parser = |text: &str| number(text, 0.3, 3.0, "times"))]
    pub leg_scale: Option<f64>,
}

/// `surefoot sheet`.
#[derive(Debug, clap::Args)]
pub struct SheetArgs {
    /// A .glb, .gltf or .vrm with clips
    #[arg(value_name = "CLIP")]
    pub file: PathBuf,
    /// The picture
    #[arg(short, long, value_name = "FILE.png", value_parser = png_path)]
    pub output: PathBuf,
    /// Which clip of the file; the last one where left out
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
}

/// `surefoot studio`.
#[derive(Debug, clap::Args)]
pub struct StudioArgs {
    /// A scenario (.toml), a rig (.glb, .gltf, .vrm) or a clip to audit (.bvh, .fbx, .vrma); the built-in rig without
    #[arg(value_name = "FILE")]
    pub file: Option<PathBuf>,
    /// Play and edit for so many seconds, print how fast it was as JSON, and close
    #[arg(long, value_name = "SECONDS")]
    pub measure: Option<f64>,
}

/// Root motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Root {
    /// A root node over the scene moves over the ground
    Root,
    /// The hips do
    Hips,
    /// Nothing does: the clip stays in its place
    InPlace,
}

/// What moves the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Drive {
    /// The better of the two; the stepper in this version
    Auto,
    /// Joint torques and contacts
    Ragdoll,
    /// The body is posed on the pendulum's path
    Stepper,
}

/// Bound on the help for the root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Assist {
    /// None.
    Off,
    /// The program's own bound.
    Auto,
    /// Nm, and N where given.
    Bound(f64, Option<f64>),
}

/// What `new` writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum New {
    /// A copy of the rig inside of the program, of other measures if you like
    Rig,
    /// A commented scenario with every key
    Scenario,
    /// A commented sweep with every key
    Sweep,
}

/// `surefoot correct`.
#[derive(Debug, clap::Args)]
pub struct CorrectArgs {
    /// A .bvh, .fbx, .glb, .gltf, .vrm or .vrma file
    #[arg(value_name = "CLIP")]
    pub clip_file: PathBuf,
    /// The corrected file: of the same kind; an FBX or a .gltf becomes a .glb
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Only the clip of that name; every clip of the file where left out
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// Write what was found before and after, and what was changed, as JSON; - is stdout
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Repair only what these rules flag: foot-placement, balance, foot-slide, penetration, float, ballistic, timing, drift
    #[arg(long, value_name = "RULE,..", value_delimiter = ',', value_parser = rule)]
    pub rules: Vec<Rule>,
    /// Give a clip that plays too slow or too fast another frame rate
    #[arg(long)]
    pub retime: bool,
    /// Frames per second, where the file is wrong about it
    #[arg(long, value_name = "N", value_parser = |text: &str| number(text, 1.0, 2000.0, "frames per second"))]
    pub fps: Option<f64>,
    /// The file's up axis, where it was not found: X, Y or Z, with a sign if you like
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres a unit of the file, where it was not found: 0.01 for centimetres
    #[arg(long, value_name = "METRES", value_parser = |text: &str| number(text, 1e-6, 1e3, "metres a unit"))]
    pub unit: Option<f64>,
    /// Height of the floor over the file's zero in metres, where the feet mislead
    #[arg(long, value_name = "M", value_parser = |text: &str| number(text, -1e4, 1e4, "m"), allow_hyphen_values = true)]
    pub floor: Option<f64>,
}

/// `surefoot retarget`.
#[derive(Debug, clap::Args)]
pub struct RetargetArgs {
    /// A .bvh, .fbx, .glb, .gltf, .vrm or .vrma file
    #[arg(value_name = "CLIP")]
    pub clip_file: PathBuf,
    /// .glb, .gltf or .vrm; `builtin` is the rig inside of the program
    #[arg(value_name = "RIG")]
    pub rig: PathBuf,
    /// Where the copy of the rig's file with the new clip goes
    #[arg(short, long, value_name = "OUT.glb", value_parser = glb_path)]
    pub output: PathBuf,
    /// The clip of that name; needed where the file has several
    #[arg(long, value_name = "NAME")]
    pub clip: Option<String>,
    /// Name of the new clip; the clip's own where left out
    #[arg(long, value_name = "NAME", value_parser = clip_name)]
    pub name: Option<String>,
    /// Keys per second; where left out the clip's own rate, or the whole part of it that is at most 60
    #[arg(long, value_name = "N", value_parser = fps)]
    pub fps: Option<f64>,
    /// Which node carries the way over the ground
    #[arg(long, value_enum, default_value_t = Root::Root)]
    pub root: Root,
    /// The clip file's up axis, where it was not found: X, Y or Z, with a sign if you like
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    pub up: Option<String>,
    /// Metres a unit of the clip file, where it was not found: 0.01 for centimetres
    #[arg(long, value_name = "METRES", value_parser = |text: &str| number(text, 1e-6, 1e3, "metres a unit"))]
    pub unit: Option<f64>,
    /// Print the result as one JSON object
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parsed(line: &str) -> Result<Command, clap::Error> {
        Args::try_parse_from(line.split(' ')).map(|args| args.command)
    }

    #[test]
    fn the_arguments_are_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn the_demo_needs_neither_scenario_nor_output() {
        assert!(matches!(parsed("surefoot bake builtin --demo"), Ok(Command::Bake(args)) if args.demo));
        assert!(parsed("surefoot bake builtin").is_err(), "neither scenario nor demo");
        assert!(parsed("surefoot bake builtin s.toml").is_err(), "no output");
        assert!(parsed("surefoot bake builtin s.toml --demo -o a.glb").is_err(), "both");
    }

    #[test]
    fn forms_out_of_range_are_refused() {
        for flag in [
            "--fps 0",
            "--fps nan",
            "--fps 1e9",
            "--seed -1",
            "--assist half",
            "--assist 5,",
            "--assist -1",
            "--root x",
            "--drive y",
        ] {
            assert!(parsed(&format!("surefoot bake a b -o c.glb {flag}")).is_err(), "{flag}");
        }
        for flag in ["--fps 29.97", "--seed 7", "--assist 50,100", "--assist off", "--root in-place", "--drive ragdoll"]
        {
            assert!(parsed(&format!("surefoot bake a b -o c.glb {flag}")).is_ok(), "{flag}");
        }
        assert!(parsed("surefoot bake a b -o c.gltf").is_err(), "only binary glTF is written");
    }

    #[test]
    fn a_batch_needs_a_folder_or_only_lists() {
        assert!(parsed("surefoot batch a.toml").is_err(), "no folder");
        assert!(parsed("surefoot batch a.toml --dry-run").is_ok());
        for (only, good) in [("3-9", true), ("4", true), ("0-3", false), ("9-3", false), ("a", false), ("1-", false)] {
            assert_eq!(parsed(&format!("surefoot batch a.toml -o d --only {only}")).is_ok(), good, "{only}");
        }
    }

    #[test]
    fn an_audit_takes_many_clips_and_checks_the_form_of_its_flags() {
        let line = "surefoot audit a.bvh b.fbx --json - --strict --up -z --floor -0.2 --jobs 3";
        let Ok(Command::Audit(args)) = parsed(line) else { panic!("{line}") };
        assert_eq!((args.clips.len(), args.up.as_deref(), args.floor, args.jobs), (2, Some("-Z"), Some(-0.2), Some(3)));
        assert!(parsed("surefoot audit").is_err(), "no clip");
        for flag in ["--up W", "--unit 0", "--fps 0", "--jobs 0", "--csv a.bvh", "--html a.png", "--floor nan"] {
            assert!(parsed(&format!("surefoot audit a.bvh {flag}")).is_err(), "{flag}");
        }
    }
}
