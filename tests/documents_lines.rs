//! What in a document is a command, and what kind it is.
//!
//! Commands are the lines of ```sh blocks, the lines of a topic that stand four blanks in and begin with a program's name, and what stands between
//! backticks and begins with one. A comment, a `$` before it and what a shell would fill in are taken away.

/// A command of a document.
pub struct Line {
    /// "README.md:12".
    pub at: String,
    /// Without comment.
    pub text: String,
}

/// What a command calls.
pub enum Kind {
    /// The program, with what follows its name.
    Surefoot(String),
    /// Cargo, with what follows.
    Cargo(String),
    /// Something that is not run here, and why.
    Other(String, &'static str),
    /// Not known.
    Unknown,
}

/// Programs that the tests do not run, and why.
const OTHERS: [(&str, &str); 11] = [
    ("openjd", "Open Job Description's own tool: tests/tools/openjd_check.sh runs these commands in .ci/run"),
    ("deadline", "AWS Deadline Cloud's tool wants an account there"),
    ("slurm/submit.sh", "wants a Slurm cluster: tests/tools/slurm_check.sh runs it there, by hand"),
    ("tests/tools/openjd_check.sh", "wants openjd-cli from PyPI; .ci/run runs it"),
    ("tests/tools/slurm_check.sh", "wants a Slurm cluster"),
    ("node", "wants packages from npm; .ci/run runs these scripts"),
    (".ci/run", "runs these tests"),
    (".ci/gallery", "bakes for minutes, and wants a browser"),
    (
        "python3",
        "reads the manifest that the command before it wrote; no Python is asked of a machine that runs the tests",
    ),
    ("set", "the shell's own"),
    ("npm", "fetches packages"),
];

/// Blanks before a command in a topic.
const INDENT: &str = "    ";

/// The kind of a command. Assignments before it (`SUREFOOT_SHEETS=folder cargo test`) are not part of it.
pub fn kind(text: &str) -> Kind {
    let mut words = text.split_whitespace().skip_while(|word| is_assignment(word));
    let Some(program) = words.next() else { return Kind::Unknown };
    let rest = words.collect::<Vec<_>>().join(" ");
    match program {
        "surefoot" => Kind::Surefoot(filled_in(&rest)),
        "cargo" => Kind::Cargo(rest),
        other => match OTHERS.iter().find(|(name, _)| *name == other) {
            Some((name, why)) => Kind::Other((*name).to_owned(), why),
            None => Kind::Unknown,
        },
    }
}

fn is_assignment(word: &str) -> bool {
    let name = word.split_once('=').map_or("", |(name, _)| name);
    !name.is_empty() && name.chars().all(|letter| letter.is_ascii_uppercase() || letter == '_')
}

/// What a shell would fill in, and places that a test may not write to.
fn filled_in(words: &str) -> String {
    words.replace("\"$(nproc)\"", "2").replace("/mnt/", "mnt/")
}

/// The commands of a page, in order.
pub fn commands(page: &str, text: &str) -> Vec<Line> {
    let topic = page.ends_with(".txt");
    let mut found: Vec<Line> = Vec::new();
    let mut block: Option<&str> = None;
    let mut until: Option<String> = None;
    let mut goes_on = false;
    for (index, line) in text.lines().enumerate() {
        let trimmed = line.trim();
        let mut push = |text: &str| {
            let text = without_comment(text.strip_prefix("$ ").unwrap_or(text));
            if !text.is_empty() {
                found.push(Line { at: format!("{page}:{}", index + 1), text: text.to_owned() });
            }
        };
        if let Some(language) = trimmed.strip_prefix("```") {
            block = if block.is_some() { None } else { Some(language) };
        } else if let Some(word) = &until {
            if trimmed == word {
                until = None;
            }
        } else if goes_on {
            goes_on = trimmed.ends_with('\\');
            if let Some(last) = found.last_mut() {
                last.text = format!("{} {}", last.text.trim_end_matches('\\').trim_end(), without_comment(trimmed));
            }
        } else if block == Some("sh") {
            goes_on = trimmed.ends_with('\\');
            until = heredoc(trimmed);
            push(trimmed);
        } else if block.is_none() {
            let indented = line.strip_prefix(INDENT).filter(|rest| topic && !rest.starts_with(' ') && is_command(rest));
            match indented {
                Some(command) => {
                    goes_on = command.ends_with('\\');
                    push(command);
                }
                None => line.split('`').skip(1).step_by(2).filter(|span| is_command(span)).for_each(push),
            }
        }
    }
    found
}

/// Whether a text begins as a command does, with a blank after the program's name.
fn is_command(text: &str) -> bool {
    let text = text.strip_prefix("$ ").unwrap_or(text);
    let mut words = text.split_whitespace().skip_while(|word| is_assignment(word));
    let program = words.next().unwrap_or_default();
    let known =
        ["surefoot", "cargo"].contains(&program) || OTHERS.iter().any(|(name, _)| *name == program && *name != "set");
    known && words.next().is_some()
}

/// The word that ends what a command reads from the lines after it.
fn heredoc(line: &str) -> Option<String> {
    let (_, rest) = line.split_once("<<'")?;
    rest.split_once('\'').map(|(word, _)| word.to_owned())
}

/// A comment begins behind a blank.
fn without_comment(text: &str) -> &str {
    if text.starts_with('#') {
        return "";
    }
    text.split_once(" #").map_or(text, |(command, _)| command).trim_end()
}

/// The fenced blocks of a language, without the blanks that all of their fences stand in.
pub fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut open: Option<(bool, usize, String)> = None;
    for line in text.lines() {
        let indent = line.len() - line.trim_start().len();
        match (&mut open, line.trim_start().strip_prefix("```")) {
            (None, Some(name)) => open = Some((name == language, indent, String::new())),
            (Some(_), Some(_)) => found.extend(open.take().filter(|(wanted, ..)| *wanted).map(|(.., block)| block)),
            (Some((_, indent, block)), None) => {
                block.push_str(line.get(*indent..).unwrap_or_default());
                block.push('\n');
            }
            (None, None) => {}
        }
    }
    found
}

#[test]
fn commands_are_found_in_blocks_in_topics_and_between_backticks() {
    let page = "Text `surefoot inspect a.glb` and `other`, `cargo` alone.\n```sh\nsurefoot bake a b -o c   # why\n# no command\n\
                openjd run a \\\n  -p b\npython3 - <<'PY'\nsurefoot no\nPY\n```\n```text\n$ surefoot not this\n```\n";
    let texts = |page: &str, text: &str| commands(page, text).into_iter().map(|line| line.text).collect::<Vec<_>>();
    assert_eq!(
        texts("a.md", page),
        ["surefoot inspect a.glb", "surefoot bake a b -o c", "openjd run a -p b", "python3 - <<'PY'"]
    );
    let topic = "A summary\n\n    surefoot audit a.bvh\n    [base]\n  surefoot is not one here\n    surefoot\n";
    assert_eq!(texts("a.txt", topic), ["surefoot audit a.bvh"]);
    assert_eq!(commands("a.txt", topic)[0].at, "a.txt:3");
}
