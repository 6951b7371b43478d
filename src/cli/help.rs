//! `surefoot help`: commands and topics under one word. A topic is a text in the program; its first line is its summary.

use super::args::{Args, HelpArgs};
use super::say;
use crate::disk::{Exit, Failure};
use clap::Parser;
use clap::builder::{PossibleValue, PossibleValuesParser};

/// Every topic and its text, in the order in which they are listed.
const TOPICS: [(&str, &str); 14] = [
    ("scenario", include_str!("topics/scenario.txt")),
    ("base", include_str!("topics/base.txt")),
    ("loops", include_str!("topics/loops.txt")),
    ("vrm", include_str!("topics/vrm.txt")),
    ("engines", include_str!("topics/engines.txt")),
    ("body", include_str!("topics/body.txt")),
    ("plausibility", include_str!("topics/plausibility.txt")),
    ("audit", include_str!("topics/audit.txt")),
    ("correct", include_str!("topics/correct.txt")),
    ("batch", include_str!("topics/batch.txt")),
    ("farm", include_str!("topics/farm.txt")),
    ("studio", include_str!("topics/studio.txt")),
    ("rigs", include_str!("topics/rigs.txt")),
    ("format", include_str!("topics/format.txt")),
];

/// The commands. The list cannot be asked of clap here: it is a part of what clap is told.
const COMMANDS: [&str; 12] = [
    "bake",
    "audit",
    "correct",
    "retarget",
    "batch",
    "inspect",
    "new",
    "sheet",
    "studio",
    "completions",
    "man",
    "help",
];

/// Every word that can be explained.
pub(super) fn words() -> PossibleValuesParser {
    let commands = COMMANDS.map(PossibleValue::new);
    let topics = TOPICS.iter().filter(|(name, _)| !COMMANDS.contains(name));
    let topics = topics.map(|(name, text)| PossibleValue::new(name).help(summary(text)));
    PossibleValuesParser::new(commands.into_iter().chain(topics))
}

/// Explains.
pub fn run(args: &HelpArgs) -> Result<Exit, Failure> {
    let Some(word) = args.word.as_deref() else {
        shown(&["--help"])?;
        say(&list())?;
        return Ok(Exit::Done);
    };
    let command = COMMANDS.contains(&word);
    if command {
        shown(&[word, "--help"])?;
    }
    if let Some((_, text)) = TOPICS.iter().find(|(name, _)| *name == word) {
        say(&if command { format!("\n{text}") } else { (*text).to_owned() })?;
    }
    Ok(Exit::Done)
}

/// What the program prints with those arguments, which ask for help.
fn shown(words: &[&str]) -> Result<(), Failure> {
    let program = std::env::args_os().next().unwrap_or_else(|| "surefoot".into());
    let line = std::iter::once(program).chain(words.iter().map(std::ffi::OsString::from));
    match Args::try_parse_from(line) {
        Err(error) => error.print().map_err(|error| Failure::stdout(&error)),
        Ok(_) => Ok(()),
    }
}

fn list() -> String {
    let row = |(name, text): &(&str, &str)| format!("  {name:<13} {}\n", summary(text));
    format!("\nTopics:\n{}", TOPICS.iter().map(row).collect::<String>())
}

fn summary(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_words_are_every_command_and_every_topic() {
        let command = Args::command();
        let commands: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(commands, COMMANDS);
        let after = command.get_after_help().expect("says where topics are").to_string();
        for (name, _) in TOPICS {
            let listed = [format!(" {name},"), format!(" {name}."), format!("\n{name},")];
            assert!(listed.iter().any(|form| after.contains(form)), "`{name}` is not in\n{after}");
        }
    }

    #[test]
    fn topics_have_a_summary_and_fit_a_terminal() {
        for (name, text) in TOPICS {
            assert!((10..=80).contains(&summary(text).chars().count()), "{name}: {}", summary(text));
            assert!(text.ends_with('\n') && !text.ends_with("\n\n"), "{name}: one line break at the end");
            for line in text.lines() {
                assert!(line.chars().count() <= 100, "{name}: over 100 columns: {line}");
                assert_eq!(line, line.trim_end(), "{name}: blanks at the end of a line");
            }
        }
    }
}
