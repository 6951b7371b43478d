//! The documents: every command in them works as it stands, every link leads somewhere, README stays short and plain.
//!
//! A page's commands run in their order, in one folder of the test's own that holds the files which the documents name ([`crate::documents_folder`]). What
//! is a command, and what of it is run, is decided in [`crate::documents_lines`].

use crate::documents_folder::folder;
use crate::documents_lines::{Kind, Line, blocks, commands, kind};
use crate::shell::Shell;
use clap::{CommandFactory, Parser};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use surefoot::cli::args::Args;
use surefoot::model::{scenario_text, sweep_text};

/// Every page; a test holds that there are no others.
const PAGES: [&str; 6] = [
    "README.md",
    "exports/README.md",
    "exports/gallery/README.md",
    "exports/gallery/sweep/README.md",
    "rigs/README.md",
    "tests/README.md",
];
/// Lines of README.md at most.
const MOST_LINES: usize = 170;
/// Characters of a topic's line at most.
const WIDEST: usize = 100;
/// Characters of its first line at most: `surefoot help` lists it beside the name.
const SUMMARY: usize = 80;
/// Words that are not the field's: in contact, reported, path, smooth, earlier are.
const DIALECT: [&str; 11] = [
    "inside of the program",
    " told ",
    " tells ",
    " bears ",
    " bear ",
    "sooner",
    " gauge",
    "evened out",
    "the way over the ground",
    "whoever",
    " lacks ",
];
/// Flags that name a file which must be there afterwards; `-o` and `--json` are special.
const WRITES: [&str; 8] =
    ["--output", "--sheet", "--plot", "--csv", "--html", "--write-waivers", "--openjd", "--slurm"];
/// Flags of cargo that the documents use and that need no more of a check.
const PLAIN_CARGO: [&str; 6] = ["--release", "--lib", "--no-default-features", "--locked", "--path", "."];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(page: &str) -> String {
    fs::read_to_string(root().join(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// The texts of `surefoot help TOPIC`, by name.
fn topics() -> Vec<String> {
    let folder = fs::read_dir(root().join("src/cli/topics")).expect("the topics");
    let name = |path: PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let mut names: Vec<String> = folder.flatten().filter_map(|entry| name(entry.path())).collect();
    names.sort();
    names
}

fn topic_page(name: &str) -> String {
    format!("src/cli/topics/{name}.txt")
}

/// Runs a page's commands; how many of them the program ran.
fn try_page(page: &str) -> usize {
    let lines = commands(page, &read(page));
    let shell = folder();
    lines.iter().filter(|line| try_line(line, &shell)).count()
}

/// Whether the program was run.
fn try_line(line: &Line, shell: &Shell) -> bool {
    match kind(&line.text) {
        Kind::Surefoot(words) => return surefoot(line, &words, shell),
        Kind::Cargo(words) if words.starts_with("run ") => {
            let (_, own) = words.split_once(" -- ").unwrap_or_else(|| panic!("{}: nothing after `--`", line.at));
            return surefoot(line, own, shell);
        }
        Kind::Cargo(words) => cargo(line, &words),
        Kind::Other(program, _why) => {
            let script =
                line.text.split_whitespace().find(|word| word.starts_with("tests/tools/") || word.starts_with(".ci/"));
            let script = script.filter(|_| program != "slurm/submit.sh");
            assert!(
                script.is_none_or(|script| root().join(script).exists()),
                "{}: no such file: {}",
                line.at,
                line.text
            );
        }
        Kind::Unknown => panic!("{}: what is `{}`? Say in documents_lines.rs why it is not run", line.at, line.text),
    }
    false
}

fn surefoot(line: &Line, words: &str, shell: &Shell) -> bool {
    let list: Vec<&str> = words.split_whitespace().collect();
    match list.as_slice() {
        [] => panic!("{}: no command", line.at),
        ["help"] => return false,
        ["help", topic] => {
            let known = root().join(topic_page(topic)).is_file() || Args::command().find_subcommand(topic).is_some();
            assert!(known, "{}: there is no topic and no command called {topic}", line.at);
            return false;
        }
        ["studio", rest @ ..] => {
            parses(line, words);
            let file = rest.iter().find(|word| !word.starts_with('-') && word.parse::<f64>().is_err());
            assert!(file.is_none_or(|file| shell.path(file).is_file()), "{}: no such file: {}", line.at, line.text);
            return false;
        }
        // Names a command, as "what `surefoot correct` writes" does.
        [command] => {
            assert!(Args::command().find_subcommand(command).is_some(), "{}: no command {command}", line.at);
            return false;
        }
        _ => parses(line, words),
    }
    let farm = words.contains("--openjd") || words.contains("--slurm");
    let writes = |flag: &str| match flag {
        "-o" => !farm,
        "--json" => takes_file(&list),
        flag => WRITES.contains(&flag),
    };
    let named: Vec<PathBuf> = list
        .windows(2)
        .filter(|pair| writes(pair[0]) && pair[1] != "-" && !pair[1].starts_with("--"))
        .map(|pair| shell.path(pair[1]))
        .collect();
    for path in &named {
        assert!(!path.exists(), "{}: {} is there already: give it another name", line.at, path.display());
    }
    let ran = shell.run(words);
    assert_eq!(ran.code, 0, "{}: `{}`\nstdout:\n{}\nstderr:\n{}", line.at, line.text, ran.out, ran.err);
    for path in &named {
        assert!(path.exists(), "{}: `{}` did not write {}", line.at, line.text, path.display());
    }
    true
}

/// Whether `--json` of that command is followed by a file.
fn takes_file(words: &[&str]) -> bool {
    matches!(words.first(), Some(&"audit" | &"correct"))
}

fn parses(line: &Line, words: &str) {
    let words = std::iter::once("surefoot").chain(words.split_whitespace());
    let parsed = Args::try_parse_from(words).map(drop);
    assert!(
        parsed.is_ok(),
        "{}: `{}`: {}",
        line.at,
        line.text,
        parsed.err().map_or_else(String::new, |error| error.to_string())
    );
}

/// Benches, tests, modules and flags are there.
fn cargo(line: &Line, words: &str) {
    let manifest: toml::Table = read("Cargo.toml").parse().expect("a manifest");
    let has = |kind: &str, name: &str| {
        let targets = manifest[kind].as_array().into_iter().flatten();
        targets.into_iter().any(|target| target["name"].as_str() == Some(name))
    };
    let modules = read("tests/tests.rs");
    let (own, free) = words.split_once(" -- ").unwrap_or((words, ""));
    let mut own = own.split_whitespace();
    let command = own.next().unwrap_or_default();
    assert!(["test", "bench", "build", "install", "check"].contains(&command), "{}: cargo {command}?", line.at);
    let (mut filters, mut lib) = (Vec::new(), false);
    while let Some(word) = own.next() {
        match word {
            "--test" | "--bench" => {
                let name = own.next().unwrap_or_default();
                assert!(has(&word[2..], name), "{}: Cargo.toml has no {} called {name:?}", line.at, &word[2..]);
            }
            flag if flag.starts_with('-') || flag == "." => {
                lib |= flag == "--lib";
                assert!(PLAIN_CARGO.contains(&flag), "{}: what is {flag}?", line.at);
            }
            filter => filters.push(filter),
        }
    }
    if command == "test" {
        filters.extend(free.split_whitespace());
    }
    for filter in filters {
        let module = filter.trim_end_matches("::").replace("::", "/");
        let there = match lib {
            true => ["", ".rs"].iter().any(|end| root().join(format!("src/{module}{end}")).exists()),
            false => modules.lines().any(|own| own.starts_with("mod ") && own[4..].starts_with(&module)),
        };
        assert!(there, "{}: no module {filter}", line.at);
    }
}

#[test]
fn every_command_of_readme_works() {
    assert!(try_page("README.md") >= 12, "README's commands were not found");
}

#[test]
fn every_command_of_the_other_pages_works() {
    let ran: usize = PAGES[1..].par_iter().map(|page| try_page(page)).sum();
    assert!(ran >= 12, "the pages' commands were not found: {ran}");
}

#[test]
fn every_command_of_the_topics_works() {
    let ran: usize = topics().par_iter().map(|name| try_page(&topic_page(name))).sum();
    assert!(ran >= 18, "the topics' commands were not found: {ran}");
}

#[test]
fn a_command_that_does_not_work_is_caught() {
    let shell = folder();
    let fails = |text: &str| {
        let line = Line { at: "planted".into(), text: text.into() };
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| try_line(&line, &shell))).is_err()
    };
    for planted in [
        "surefoot bkae hero.glb shove.toml -o exports/a.glb",
        "surefoot bake nobody.glb shove.toml -o exports/a.glb",
        "surefoot help nothing",
        "surefoot studio nothing.toml",
        "surefoot inspect shove.toml",
        "cargo bench --bench nothing",
        "cargo test --test tests -- nothing_of_that_name",
        "cargo test --lib -- nowhere::",
        "cargo run --release -- bake builtin --dmo",
        "node tests/tools/nothing.mjs",
        "frobnicate hero.glb",
    ] {
        assert!(fails(planted), "{planted}");
    }
    assert!(!fails("surefoot inspect hero.glb") && !fails("surefoot help scenario") && !fails("cargo test"));
}

#[test]
fn readme_is_short_and_begins_with_the_two_commands() {
    let text = read("README.md");
    assert!(text.lines().count() <= MOST_LINES, "{} lines", text.lines().count());
    let first = blocks(&text, "sh").into_iter().next().expect("a block of commands");
    assert_eq!(first.lines().collect::<Vec<_>>(), ["cargo run --release -- bake builtin --demo", "cargo test"]);
    for topic in topics() {
        assert!(text.contains(&topic), "README does not name the topic {topic}");
    }
}

#[test]
fn a_topic_has_a_summary_and_no_line_that_is_too_wide_for_a_terminal() {
    assert!(topics().len() >= 14, "{:?}", topics());
    for name in topics() {
        let text = read(&topic_page(&name));
        let summary = text.lines().next().unwrap_or_default();
        assert!(
            (20..=SUMMARY).contains(&summary.chars().count()) && text.lines().nth(1) == Some(""),
            "{name}: no summary of 20 to 80 letters in its first line"
        );
        for (index, line) in text.lines().enumerate() {
            assert!(line.chars().count() <= WIDEST && line == line.trim_end(), "{name}.txt:{}: {line}", index + 1);
        }
    }
}

#[test]
fn the_words_are_plain() {
    let mut pages: Vec<String> = topics().iter().map(|name| topic_page(name)).collect();
    pages.push("README.md".into());
    for page in pages {
        let text = read(&page).replace('\n', " ").to_lowercase();
        for word in DIALECT {
            assert!(!text.contains(word), "{page}: `{}`", word.trim());
        }
    }
}

#[test]
fn every_link_and_picture_of_the_pages_is_there() {
    for page in PAGES {
        let text = read(page);
        let marks = [("](", ")"), ("src=\"", "\"")];
        let targets = marks.into_iter().flat_map(|(from, to)| {
            text.split(from).skip(1).filter_map(move |rest| rest.split_once(to).map(|(target, _)| target.to_owned()))
        });
        let mut seen = 0;
        for target in targets.filter(|target| !target.contains("://")) {
            let (path, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let there = root().join(page).parent().expect("a folder").join(path);
            assert!(path.is_empty() || there.exists(), "{page}: {target} is not there");
            assert!(!path.is_empty() || headings(&text).contains(anchor), "{page}: no heading for #{anchor}");
            seen += 1;
        }
        assert!(seen > 0 || page == "tests/README.md", "{page}: no links were found");
    }
}

/// Headings as anchors.
fn headings(text: &str) -> BTreeSet<String> {
    let title = |line: &str| line.strip_prefix('#').map(|rest| rest.trim_start_matches('#').trim().to_lowercase());
    let anchor = |title: String| {
        let kept = title.chars().filter(|letter| letter.is_alphanumeric() || [' ', '-'].contains(letter));
        kept.collect::<String>().replace(' ', "-")
    };
    text.lines().filter_map(title).map(anchor).collect()
}

#[test]
fn scenarios_and_sweeps_in_the_pages_are_good() {
    let mut seen = 0;
    for page in PAGES {
        for block in blocks(&read(page), "toml") {
            if block.starts_with("title = ") {
                scenario_text::parse(page, &block).unwrap_or_else(|errors| panic!("{page}: {errors}"));
                seen += 1;
            } else if block.starts_with("scenario = ") {
                drop(sweep_text::read(page, &block).unwrap_or_else(|errors| panic!("{page}: {errors}")));
                seen += 1;
            } else {
                block.parse::<toml::Table>().unwrap_or_else(|error| panic!("{page}: {error}"));
            }
        }
    }
    assert!(seen >= 2, "{seen}");
}

#[test]
fn there_is_no_page_that_is_not_checked() {
    let output =
        std::process::Command::new("git").args(["ls-files", "*.md"]).current_dir(root()).output().expect("git");
    let known = String::from_utf8(output.stdout).expect("UTF-8 paths");
    let unchecked: Vec<&str> = known.lines().filter(|page| !PAGES.contains(page)).collect();
    assert_eq!(unchecked, [""; 0], "name them in PAGES");
}
