//! What the program says of itself: help of commands and topics, completions, manual pages, schemas, and what follows the demo.

use crate::shell::{Shell, Told};
use std::fs;
use std::process::Command;

/// Every command, from the list of `surefoot --help`.
fn commands() -> Vec<String> {
    let told = Shell::new().run("--help").exits(0);
    let list = told.out.split("Commands:\n").nth(1).expect("a list of commands");
    let list = list.split("\n\n").next().unwrap_or_default();
    let names = list.lines().filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
    names.filter_map(|line| line.split_whitespace().next().map(str::to_owned)).collect()
}

/// Every long flag of a command, from its help.
fn flags(command: &str) -> Vec<String> {
    let told = Shell::new().run(&format!("{command} --help")).exits(0);
    let words = told.out.lines().filter(|line| line.trim_start().starts_with('-')).flat_map(str::split_whitespace);
    let words = words.map(|word| word.trim_end_matches(|letter: char| !letter.is_alphanumeric()));
    let names = words.filter(|word| word.starts_with("--"));
    let mut names: Vec<String> = names.map(str::to_owned).collect();
    names.dedup();
    names
}

fn run_with(words: &[&str], by_cargo: bool) -> Told {
    let shell = Shell::new();
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    command.args(words).current_dir(shell.path("")).env_remove("CARGO_PKG_NAME");
    if by_cargo {
        command.env("CARGO_PKG_NAME", "surefoot");
    }
    let output = command.output().expect("the program was built");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    Told { code: output.status.code().unwrap_or(-1), out: text(output.stdout), err: text(output.stderr) }
}

#[test]
fn help_of_a_command_is_that_of_its_flag_and_a_topic_follows_where_it_has_the_same_name() {
    let shell = Shell::new();
    let commands = commands();
    assert!(commands.len() >= 12, "{commands:?}");
    for command in &commands {
        let (flag, word) = (shell.run(&format!("{command} --help")), shell.run(&format!("help {command}")).exits(0));
        let topic = word.out.strip_prefix(&flag.out).unwrap_or_else(|| panic!("{command}: {}", word.out));
        let both = ["audit", "batch", "correct", "studio"].contains(&command.as_str());
        assert_eq!(topic.len() > 40, both, "{command}: {topic}");
    }
}

#[test]
fn the_usage_of_a_bake_names_its_arguments_in_the_order_in_which_they_are_given() {
    let told = Shell::new().run("bake --help").exits(0);
    assert!(
        told.out.contains("\nUsage: surefoot bake [OPTIONS] <RIG> <SCENARIO> --output <OUT.glb|OUT.vrma|OUT.fbx>\n"),
        "{}",
        told.out
    );
    assert!(told.out.contains("\n       surefoot bake [OPTIONS] <RIG> --demo\n"), "{}", told.out);
}

#[test]
fn help_alone_lists_commands_and_topics_and_every_topic_has_a_text() {
    let shell = Shell::new();
    let all = shell.run("help").exits(0).out;
    let topics = all.split("\nTopics:\n").nth(1).expect("a list of topics");
    for command in commands() {
        assert!(all.contains(&format!("\n  {command} ")), "{command}");
    }
    let mut count = 0;
    for line in topics.lines() {
        let (topic, summary) = line.trim().split_once(' ').expect("a topic and its summary");
        let told = shell.run(&format!("help {topic}")).exits(0);
        assert!(told.out.contains(summary.trim()) && told.err.is_empty(), "{topic}");
        assert!(told.out.lines().count() >= 3, "{topic} is only its summary");
        count += 1;
    }
    assert_eq!(count, 14);
}

#[test]
fn a_word_that_is_neither_command_nor_topic_exits_two_with_the_nearest() {
    let told = Shell::new().run("help plausability").exits(2).says(&["plausability", "'plausibility'"]);
    assert_eq!(told.out, "");
    Shell::new().run("help bkae").exits(2).says(&["'bake'"]);
}

#[test]
fn completions_name_every_command_and_flag_and_bash_can_read_its_own() {
    let shell = Shell::new();
    let commands = commands();
    for name in ["bash", "zsh", "fish", "powershell"] {
        let script = shell.run(&format!("completions {name}")).exits(0).out;
        for command in &commands {
            assert!(script.contains(command.as_str()), "{name}: {command}");
            for flag in flags(command) {
                // fish writes `-l fps` for --fps.
                let form = if name == "fish" { format!("-l {}", &flag[2..]) } else { flag.clone() };
                assert!(script.contains(&form), "{name}: {command} {flag}");
            }
        }
        if name == "bash" {
            fs::write(shell.path("surefoot.bash"), script).expect("the test's own folder");
        }
    }
    match Command::new("bash").arg("-n").arg(shell.path("surefoot.bash")).output() {
        Ok(read) => assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr)),
        Err(_) => eprintln!("skipped: no bash here to read its script"),
    }
    shell.run("completions tcsh").exits(2).says(&["powershell"]);
}

#[test]
fn a_manual_page_for_each_command_names_its_flags() {
    let shell = Shell::new();
    shell.run("man -o pages/man1").exits(0).says(&["pages"]);
    let read = |name: &str| fs::read_to_string(shell.path(&format!("pages/man1/{name}.1"))).expect("a page");
    let program = read("surefoot");
    let commands = commands();
    for command in &commands {
        assert!(program.replace("\\-", "-").contains(&format!("surefoot-{command}(1)")), "{command}");
        let page = read(&format!("surefoot-{command}")).replace("\\-", "-");
        assert!(page.contains(".TH surefoot-"), "{command}: {page:.200}");
        for flag in flags(command) {
            assert!(page.contains(&flag), "{command}: {flag} is not in\n{page}");
        }
    }
    assert_eq!(shell.files().len(), commands.len() + 1);
}

#[test]
fn schemas_go_to_stdout_or_to_a_new_json_file_and_the_example_names_that_file() {
    let shell = Shell::new();
    for what in ["scenario", "sweep"] {
        let schema = shell.run(&format!("new {what} --schema")).exits(0);
        assert_eq!(schema.json()["$schema"], "http://json-schema.org/draft-07/schema#");
        let file = format!("{what}.schema.json");
        shell.run(&format!("new {what} --schema -o {file}")).exits(0).says(&["wrote"]);
        assert_eq!(fs::read_to_string(shell.path(&file)).expect("there"), schema.out);
        shell.run(&format!("new {what} --schema -o {file}")).exits(2).says(&["already"]);
        shell.run(&format!("new {what} --schema -o {what}.toml")).exits(2).says(&[".json"]);
        let example = shell.run(&format!("new {what}")).exits(0).out;
        assert_eq!(example.lines().next(), Some(format!("#:schema ./{file}").as_str()));
    }
    shell.run("new rig --schema").exits(2).says(&["surefoot new scenario"]);
}

#[test]
fn the_demo_says_what_to_do_next_in_the_words_with_which_the_program_was_started() {
    let cargo = run_with(&["bake", "builtin", "--demo"], true).exits(0).out;
    let installed = run_with(&["bake", "builtin", "--demo"], false).exits(0).out;
    let (cargo, installed) = (cargo.as_str(), installed.as_str());
    for text in [cargo, installed] {
        for part in
            ["drop exports/demo.glb", "File > Import > glTF 2.0", "bake hero.glb shove.toml -o exports/hero_shove.glb"]
        {
            assert!(text.contains(part), "`{part}` is not in\n{text}");
        }
    }
    assert!(cargo.contains("  cargo run --release -- new scenario -o shove.toml\n"), "{cargo}");
    assert!(cargo.contains("cargo install --path ."), "{cargo}");
    assert!(
        installed.contains("  surefoot new scenario -o shove.toml\n") && !installed.contains("cargo"),
        "{installed}"
    );
    let json = run_with(&["bake", "builtin", "--demo", "--json"], true).exits(0);
    assert_eq!(json.json()["clip"], "shove_from_the_left");
    let shell = Shell::with(&[("s.toml", "duration = 1.0\n")]);
    let told = shell.run("bake builtin s.toml -o a.glb").exits(0);
    assert!(!told.out.contains("hero.glb") && told.err.is_empty(), "{}\n{}", told.out, told.err);
}

/// `script` of util-linux gives the program a terminal; Debian always has it.
#[cfg(target_os = "linux")]
#[test]
fn on_a_terminal_a_bake_shows_what_it_does_and_clears_the_line() {
    let shell = Shell::with(&[("s.toml", "title = \"calm\"\n")]);
    let program = format!("{} bake builtin s.toml -o a.glb > told.txt", env!("CARGO_BIN_EXE_surefoot"));
    let mut command = Command::new("script");
    command.args(["-qec", &program, "/dev/null"]).current_dir(shell.path("")).env("TERM", "xterm");
    let Ok(output) = command.output() else {
        eprintln!("skipped: no `script` here to give the program a terminal");
        return;
    };
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{shown}");
    assert!(shown.contains("baking \"calm\" onto builtin"), "{shown:?}");
    let rest = shown.rsplit("onto builtin").next().unwrap_or_default();
    assert!(rest.contains("\u{1b}[2K"), "the line is not cleared: {shown:?}");
    assert!(fs::read_to_string(shell.path("told.txt")).expect("there").starts_with("baked "));
}
