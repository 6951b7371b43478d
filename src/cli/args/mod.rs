//! The arguments as text: what they are called, their forms and ranges. Opens nothing. One file a group of commands.

mod bake;
mod clips;
mod tools;

pub use bake::{BakeArgs, BatchArgs};
pub use clips::{AuditArgs, CorrectArgs, RetargetArgs};
pub use tools::{CompletionsArgs, HelpArgs, InspectArgs, ManArgs, New, NewArgs, SheetArgs, StudioArgs};

use clap::{Parser, Subcommand, ValueEnum};

/// What stands under the list of commands.
const AFTER_HELP: &str = "\
`surefoot help COMMAND` explains a command, `surefoot help TOPIC` a topic: scenario, base, loops,
vrm, engines, body, plausibility, audit, correct, batch, farm, studio, rigs, format.

Exit codes:
  0  done; a fall is a result too
  1  `bake --require-balance` fell, or `audit --strict` found flags
  2  bad usage or bad input
  3  the work could not be completed";

/// Simulate how a character steps to keep its balance, and bake that into glTF animation clips.
#[derive(Debug, Parser)]
#[command(name = "surefoot", version, max_term_width = 100, after_help = AFTER_HELP)]
#[command(disable_help_subcommand = true, subcommand_value_name = "COMMAND")]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Bake a scenario onto a rig: a copy of the rig's file with one new clip
    Bake(BakeArgs),
    /// Find the frames of a captured or keyed clip whose balance or footing is not plausible
    Audit(AuditArgs),
    /// Repair what an audit flags, in a copy: plant feet, move steps, bring the body back over them
    Correct(CorrectArgs),
    /// Put a clip of another skeleton onto a rig, with planted feet kept in place
    Retarget(RetargetArgs),
    /// Bake every variation of a sweep: clips, a table of the results, pictures
    Batch(BatchArgs),
    /// Report what was found in a rig: bones, sizes, masses, feet
    Inspect(InspectArgs),
    /// Write a rig, a scenario or a sweep to start from, or a schema for editors
    New(NewArgs),
    /// Draw a clip as a contact sheet
    Sheet(SheetArgs),
    /// Open the window: place disturbances by hand, audit clips, compare variations
    Studio(StudioArgs),
    /// Print a completion script for a shell
    Completions(CompletionsArgs),
    /// Write the manual pages, one for each command
    Man(ManArgs),
    /// Explain a command or a topic; alone, list them all
    Help(HelpArgs),
}

/// Root motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Root {
    /// A root node above the skeleton
    Root,
    /// The hips
    Hips,
    /// No node: the clip stays in place
    InPlace,
}

/// How keys are joined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Curves {
    /// Straight lines: every program plays them alike
    #[default]
    Linear,
    /// Splines: fewer keys, easier to edit by hand
    Spline,
}

/// What moves the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Drive {
    /// Bake with both, keep the better clip
    Auto,
    /// A simulated body with joint torques and contacts
    Ragdoll,
    /// The body is posed along the path of an inverted pendulum
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
    fn a_flag_says_what_it_does_in_two_lines_at_most() {
        let program = Args::command();
        for command in program.get_subcommands() {
            for flag in command.get_arguments() {
                let help = flag.get_help().map(ToString::to_string).unwrap_or_default();
                let name = format!("{} {}", command.get_name(), flag.get_id());
                assert!((8..=180).contains(&help.chars().count()), "{name}: {help}");
            }
        }
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
