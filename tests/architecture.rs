//! What the compiler cannot hold inside of one package: the row order of `src/lib.rs`, where names may stand, file shape.
//!
//! Each rule is a function from files to violations, run on this repository and, beside it, on a planted violation.

use std::collections::BTreeMap;
use std::path::Path;

/// A file of the repository: its path with `/`, its text, and the text without comments and literals.
struct Source {
    path: String,
    text: String,
    code: String,
}

/// Row by folder, from the table in `src/lib.rs`.
type Rows = BTreeMap<String, u32>;

fn source(path: &str, text: &str) -> Source {
    Source { path: path.to_owned(), text: text.to_owned(), code: code_of(text) }
}

/// Every `.rs` file that git knows or would add, under `folder`.
fn sources(folder: &str) -> Vec<Source> {
    let paths = git(&["ls-files", "--cached", "--others", "--exclude-standard", folder]);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    paths
        .into_iter()
        .filter(|path| path.ends_with(".rs"))
        .filter_map(|path| Some(source(&path, &std::fs::read_to_string(root.join(&path)).ok()?)))
        .collect()
}

fn git(arguments: &[&str]) -> Vec<String> {
    let mut command = std::process::Command::new("git");
    command.arg("-c").arg("core.quotepath=off").args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.output().expect("git is needed to know which files are the repository's");
    assert!(output.status.success(), "git: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8 paths").lines().map(str::to_owned).collect()
}

/// Blanks comments and the insides of string and character literals, keeping lines.
fn code_of(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let at = |index: usize| chars.get(index).copied().unwrap_or('\0');
    let mut code = String::with_capacity(text.len());
    let mut i = 0;
    while i < chars.len() {
        let word_before = i > 0 && (at(i - 1).is_alphanumeric() || at(i - 1) == '_');
        let hashes = (i + 1..chars.len()).take_while(|&j| at(j) == '#').count();
        let end = if at(i) == '/' && at(i + 1) == '/' {
            (i..chars.len()).find(|&j| at(j) == '\n').unwrap_or(chars.len())
        } else if at(i) == '/' && at(i + 1) == '*' {
            let mut depth = 0_i32;
            let mut j = i;
            while j < chars.len() {
                match (at(j), at(j + 1)) {
                    ('/', '*') => (depth, j) = (depth + 1, j + 2),
                    ('*', '/') => (depth, j) = (depth - 1, j + 2),
                    _ => j += 1,
                }
                if depth == 0 {
                    break;
                }
            }
            j.min(chars.len())
        } else if at(i) == 'r' && !word_before && at(i + 1 + hashes) == '"' {
            let closing: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
            let body = i + 2 + hashes;
            let found = (body..chars.len()).find(|&j| chars[j..].starts_with(&closing));
            found.map_or(chars.len(), |j| j + closing.len())
        } else if at(i) == '"' {
            let mut j = i + 1;
            while j < chars.len() && at(j) != '"' {
                j += if at(j) == '\\' { 2 } else { 1 };
            }
            (j + 1).min(chars.len())
        } else if at(i) == '\'' && (at(i + 1) == '\\' || at(i + 2) == '\'') {
            let from = if at(i + 1) == '\\' { i + 3 } else { i + 2 };
            (from..chars.len()).find(|&j| at(j) == '\'').map_or(chars.len(), |j| j + 1)
        } else {
            code.push(at(i));
            i += 1;
            continue;
        };
        code.push(' ');
        code.extend(chars[i..end].iter().filter(|character| **character == '\n'));
        i = end;
    }
    code
}

/// The code before the unit tests at the bottom of a file.
fn without_tests(code: &str) -> &str {
    let head = "#[cfg(test)]\n";
    let is_here = |at: &usize| {
        let line = code[at + head.len()..].lines().next().unwrap_or_default();
        line.split(' ').any(|word| word == "mod") && line.contains('{')
    };
    code.match_indices(head).map(|(at, _)| at).find(is_here).map_or(code, |start| &code[..start])
}

fn folder_of(path: &str) -> Option<&str> {
    path.strip_prefix("src/")?.split_once('/').map(|(folder, _)| folder)
}

/// The table of `src/lib.rs`: `| 2 | [`rig`], [`measure`] | ...`.
fn rows_of(lib: &str) -> Rows {
    let mut rows = Rows::new();
    for line in lib.lines().filter_map(|line| line.strip_prefix("//! |")) {
        let mut cells = line.split('|').map(str::trim);
        let (Some(row), Some(folders)) = (cells.next().and_then(|row| row.parse().ok()), cells.next()) else {
            continue;
        };
        for folder in folders.split(',') {
            rows.insert(folder.trim().trim_matches(['[', ']', '`']).to_owned(), row);
        }
    }
    rows
}

/// Folders that the code of a file names by `crate::x`, `crate::{x, y}` or `super::x`.
fn imports(file: &Source, rows: &Rows) -> Vec<String> {
    let mut found = Vec::new();
    let code: String =
        file.code.split_whitespace().collect::<Vec<_>>().join(" ").replace(":: ", "::").replace(" ::", "::");
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        if let Some(group) = rest.strip_prefix('{') {
            let mut depth = 0;
            let mut word_starts = true;
            for (index, character) in group.char_indices() {
                match character {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' => word_starts = true,
                    character if character.is_alphabetic() && depth == 0 && word_starts => {
                        found.push(word(&group[index..]));
                        word_starts = false;
                    }
                    _ => {}
                }
            }
        } else {
            found.push(word(rest));
        }
    }
    for (at, _) in code.match_indices("super::") {
        found.push(word(&code[at + "super::".len()..]));
    }
    found.retain(|name| rows.contains_key(name));
    found.sort();
    found.dedup();
    found
}

fn word(text: &str) -> String {
    text.chars().take_while(|character| character.is_alphanumeric() || *character == '_').collect()
}

fn row_violations(files: &[Source], rows: &Rows) -> Vec<String> {
    let mut violations = Vec::new();
    for file in files {
        let Some(folder) = folder_of(&file.path) else { continue };
        let Some(row) = rows.get(folder) else {
            violations.push(format!("{}: the folder `{folder}` is not in the table of src/lib.rs", file.path));
            continue;
        };
        for import in imports(file, rows) {
            if import != folder && rows[&import] >= *row {
                violations
                    .push(format!("{}: `{folder}` (row {row}) imports `{import}` (row {})", file.path, rows[&import]));
            }
        }
    }
    violations
}

/// Names that may stand only in files whose path begins so. Unit tests may touch the disk and print.
const CONFINED: [(&str, &[&str], bool); 13] = [
    ("rapier3d", &["src/ragdoll/"], true),
    ("egui", &["src/studio/"], true),
    ("eframe", &["src/studio/"], true),
    ("clap", &["src/cli/"], true),
    ("miette", &["src/cli/"], true),
    ("std::fs", &["src/rig/document.rs", "src/mocap/", "src/disk/", "src/cli/", "src/studio/"], false),
    ("fs::", &["src/rig/document.rs", "src/mocap/", "src/disk/", "src/cli/", "src/studio/"], false),
    ("File::", &["src/rig/document.rs", "src/mocap/", "src/disk/", "src/cli/", "src/studio/"], false),
    ("println!", &["src/cli/", "src/studio/"], false),
    ("print!", &["src/cli/", "src/studio/"], false),
    ("eprintln!", &["src/cli/", "src/studio/"], false),
    ("std::time", &["src/cli/", "src/studio/"], false),
    ("std::env", &["src/cli/", "src/studio/", "src/main.rs"], false),
];

fn name_violations(files: &[Source]) -> Vec<String> {
    let mut violations = Vec::new();
    for file in files.iter().filter(|file| file.path.starts_with("src/")) {
        for (name, allowed, in_tests) in CONFINED {
            let code = if in_tests { &file.code } else { without_tests(&file.code) };
            if names(code, name) && !allowed.iter().any(|place| file.path.starts_with(place)) {
                violations.push(format!("{}: `{name}` may stand only in {}", file.path, allowed.join(", ")));
            }
        }
    }
    violations
}

/// Functions of the system's mathematics, which round otherwise elsewhere: `maths::real` has them all.
const SYSTEMS: [&str; 22] = [
    "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "exp2", "exp_m1",
    "ln", "ln_1p", "log2", "log10", "powf", "hypot", "cbrt", "log",
];

/// Calls of them; the window only shows what others have found.
fn system_violations(files: &[Source]) -> Vec<String> {
    let mut violations = Vec::new();
    for file in files.iter().filter(|file| file.path.starts_with("src/") && !file.path.starts_with("src/studio/")) {
        let code: String = file.code.split_whitespace().collect();
        for name in SYSTEMS {
            let called = [format!(".{name}("), format!("f64::{name}"), format!("f32::{name}")];
            let called = called.iter().any(|call| {
                code.match_indices(call).any(|(at, _)| {
                    !code[at + call.len()..].starts_with(|c: char| c == '_' || c.is_alphanumeric())
                        || call.ends_with('(')
                })
            });
            if called {
                violations.push(format!("{}: `{name}` is the system's: take that of maths::real", file.path));
            }
        }
    }
    violations
}

/// Whether the code has that name, not as the end of a longer one.
fn names(code: &str, name: &str) -> bool {
    let part_of_word = |character: char| character.is_alphanumeric() || character == '_';
    code.match_indices(name).any(|(at, _)| {
        let goes_on = name.ends_with(part_of_word) && code[at + name.len()..].starts_with(part_of_word);
        !code[..at].ends_with(part_of_word) && !goes_on
    })
}

fn shape_violations(files: &[Source]) -> Vec<String> {
    let mut violations = Vec::new();
    for file in files {
        let mut complain = |what: &str| violations.push(format!("{}: {what}", file.path));
        if !file.text.starts_with("//! ") {
            complain("does not begin with a //! line that says what it does");
        }
        if file.text.lines().count() > 500 {
            complain("over 500 lines: split it");
        }
        let code = without_tests(&file.code).lines().filter(|line| !line.trim().is_empty()).count();
        if code > 400 && file.path.starts_with("src/") {
            complain("over 400 lines of code: split it by job");
        }
        for unfinished in ["todo!(", "unimplemented!(", "#[ignore"] {
            if file.code.contains(unfinished) {
                complain(&format!("`{unfinished}`: finish it or take it out"));
            }
        }
    }
    violations
}

fn top_level_violations(paths: &[String]) -> Vec<String> {
    const SHOWN: [&str; 9] =
        ["Cargo.toml", "Cargo.lock", "src", "rigs", "exports", "tests", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];
    let first = |path: &String| path.split('/').next().unwrap_or_default().to_owned();
    let mut tops: Vec<String> = paths.iter().map(first).collect();
    tops.dedup();
    tops.retain(|top| !top.starts_with('.') && !SHOWN.contains(&top.as_str()));
    tops.iter().map(|top| format!("{top}: not one of {}", SHOWN.join(", "))).collect()
}

#[test]
fn files_import_only_from_rows_above_their_own() {
    let files = sources("src");
    assert!(files.len() > 20, "the files were not found: {}", files.len());
    let lib = files.iter().find(|file| file.path == "src/lib.rs").expect("src/lib.rs");
    let rows = rows_of(&lib.text);
    for declared in lib.code.lines().filter_map(|line| line.trim().strip_prefix("pub mod ")) {
        assert!(rows.contains_key(declared.trim_end_matches(';')), "`{declared}` is not in the table of src/lib.rs");
    }
    assert_eq!(row_violations(&files, &rows), [""; 0]);
}

#[test]
fn an_import_from_a_lower_row_or_a_neighbour_is_caught() {
    let rows = rows_of("//! | 0 | [`maths`] | a |\n//! | 2 | [`rig`], [`measure`] | b |\n//! | 5 | [`bake`] | c |\n");
    assert_eq!(
        rows.into_iter().collect::<Vec<_>>(),
        [("bake".into(), 5), ("maths".into(), 0), ("measure".into(), 2), ("rig".into(), 2)]
    );
    let rows = rows_of("//! | 0 | [`maths`] | a |\n//! | 2 | [`rig`], [`measure`] | b |\n//! | 5 | [`bake`] | c |\n");
    let caught = |path: &str, text: &str| row_violations(&[source(path, text)], &rows).len();
    for planted in [
        "use crate::bake::Clip;",
        "use crate::measure;",
        "fn f() { crate::measure::slip() }",
        "use crate::{maths::quat, measure::slip};",
        "use crate::{\n    maths::{a, b},\n    bake,\n};",
        "use super::super::bake::keys;",
        "use crate ::\n bake::x;",
    ] {
        assert_eq!(caught("src/rig/load.rs", planted), 1, "{planted}");
    }
    for fine in [
        "use crate::maths::quat;\nuse crate::rig::names;",
        "// use crate::bake::Clip;",
        "const S: &str = \"crate::bake\";",
        "/* crate::bake */ const S: &str = r#\"crate::bake\"#; const C: char = '\"'; // \" crate::bake",
        "use crate::{maths::{bake_angle}};",
    ] {
        assert_eq!(caught("src/rig/load.rs", fine), 0, "{fine}");
    }
    assert_eq!(caught("src/attic/x.rs", ""), 1, "a folder without a row");
}

#[test]
fn names_stand_where_they_belong() {
    assert_eq!(name_violations(&sources("src")), [""; 0]);
}

#[test]
fn the_systems_mathematics_is_left_alone_and_a_call_of_it_is_caught() {
    assert_eq!(system_violations(&sources("src")), [""; 0]);
    let found = |text: &str| system_violations(&[source("src/bake/it.rs", text)]).len();
    assert_eq!(found("fn it(x: f64) -> f64 { x.sin() }"), 1);
    assert_eq!(found("fn it(x: f64) -> f64 { (x + 1.0)\n    .atan2(2.0) }"), 1);
    assert_eq!(found("fn it(x: Option<f64>) -> f64 { x.map_or(0.0, f64::sin) }"), 1);
    assert_eq!(found("fn it(x: f64) -> f64 { real::sin(x).sqrt() } // not x.sin()"), 0);
}

#[test]
fn a_name_in_the_wrong_place_is_caught() {
    for (path, planted) in [
        ("src/sim/session.rs", "use rapier3d::prelude::*;"),
        ("src/bake/mod.rs", "let ui: &egui::Ui;"),
        ("src/export/glb.rs", "std::fs::write(path, bytes)?;"),
        ("src/export/glb.rs", "use std::{fs, io};\nfn f() { fs::write(a, b) }"),
        ("src/rig/names.rs", "let file = File::open(path)?;"),
        ("src/stepper/control.rs", "println!(\"{x}\");"),
        ("src/stepper/control.rs", "eprintln!(\"{x}\");"),
        ("src/bake/mod.rs", "let now = std::time::Instant::now();"),
        ("src/model/scenario.rs", "use clap::ValueEnum;"),
    ] {
        assert!(!name_violations(&[source(path, planted)]).is_empty(), "{path}: {planted}");
    }
    for (path, fine) in [
        ("src/rig/document.rs", "std::fs::read(path)"),
        ("src/cli/bake.rs", "eprintln!(\"{x}\");"),
        ("src/rig/names.rs", "#[cfg(test)]\nmod tests { fn f() { println!(\"skipped: \"); std::fs::read(a); } }"),
        ("src/stepper/control.rs", "let collapse = 1; let s = \"std::fs\"; let offs = OffsetFile::new();"),
    ] {
        assert_eq!(name_violations(&[source(path, fine)]), [""; 0], "{path}: {fine}");
    }
}

#[test]
fn files_have_a_head_a_readable_length_and_nothing_unfinished() {
    let mut files = sources("src");
    files.extend(sources("tests"));
    assert_eq!(shape_violations(&files), [""; 0]);
}

#[test]
fn a_headless_an_endless_and_an_unfinished_file_are_caught() {
    let head = "//! Does something.\n";
    for planted in [
        "use std::io;\n".to_owned(),
        format!("{head}{}", "// line\n".repeat(500)),
        format!("{head}{}", "use std::io;\n".repeat(401)),
        format!("{head}fn f() {{ todo!() }}"),
        format!("{head}fn f() {{ unimplemented!(\"later\") }}"),
        format!("{head}#[test]\n#[ignore = \"slow\"]\nfn f() {{}}"),
    ] {
        assert_eq!(shape_violations(&[source("src/a/b.rs", &planted)]).len(), 1, "{planted:.60}");
    }
    let tests = format!("#[cfg(test)]\npub(super) mod tests {{\n{}}}\n", "use std::io;\n".repeat(50));
    for fine in [
        format!("{head}// todo!() is not code"),
        format!("{head}{}{tests}", "use std::io; // a line\n\n".repeat(200) + &"use std::io;\n".repeat(40)),
        format!("{head}{}{tests}", "use std::io;\n".repeat(400)),
    ] {
        assert_eq!(shape_violations(&[source("src/a/b.rs", &fine)]), [""; 0]);
    }
}

#[test]
fn the_top_level_holds_only_what_it_should() {
    assert_eq!(top_level_violations(&git(&["ls-files"])), [""; 0]);
    let planted = ["Cargo.toml", ".ci/run", "docs/notes.md", "build.rs"].map(str::to_owned);
    assert_eq!(top_level_violations(&planted).len(), 2);
}
