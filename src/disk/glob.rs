//! Names with `*` and `?`, for shells that leave them alone and for waivers. Touches no file but to list folders.
//!
//! `*` is any letters of one name, none too, `?` one letter; `**` as a whole part of a path is any folders. A bracket is a bracket.

use std::path::{Component, Path, PathBuf};
use wildmatch::WildMatch;

/// Folders below one another that are looked through at most: past that it is a loop.
const DEEPEST: usize = 24;

/// Whether a text has that form, letter by letter. Case counts.
pub fn matches(pattern: &str, text: &str) -> bool {
    WildMatch::new(pattern).matches(text)
}

/// Whether a path has to be looked up rather than opened.
pub fn is_pattern(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains(['*', '?']))
}

/// The files of that form, sorted.
pub fn files(pattern: &Path) -> Vec<PathBuf> {
    let parts: Vec<Component> = pattern.components().collect();
    let mut found = Vec::new();
    walk(PathBuf::new(), &parts, DEEPEST, &mut found);
    found.sort();
    found.dedup();
    found
}

/// The files of a folder and its folders that `wanted` takes, sorted. Links to folders are not followed.
pub fn files_below(folder: &Path, wanted: &dyn Fn(&Path) -> bool) -> Vec<PathBuf> {
    fn below(folder: &Path, wanted: &dyn Fn(&Path) -> bool, depth: usize, found: &mut Vec<PathBuf>) {
        for (path, kind) in entries(folder) {
            if kind.is_dir() && depth > 0 {
                below(&path, wanted, depth - 1, found);
            } else if path.is_file() && wanted(&path) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    below(folder, wanted, DEEPEST, &mut found);
    found.sort();
    found
}

fn walk(at: PathBuf, parts: &[Component], depth: usize, found: &mut Vec<PathBuf>) {
    let Some((part, rest)) = parts.split_first() else {
        if at.is_file() {
            found.push(at);
        }
        return;
    };
    let text = part.as_os_str().to_str().unwrap_or_default();
    if !matches!(part, Component::Normal(_)) || !text.contains(['*', '?']) {
        return walk(at.join(part), rest, depth, found);
    }
    let folders_too = text == "**";
    if folders_too {
        walk(at.clone(), rest, depth, found);
    }
    for (path, kind) in entries(&at) {
        if folders_too && kind.is_dir() && depth > 0 {
            walk(path, parts, depth - 1, found);
        } else if !folders_too {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            if matches(text, name) && (!name.starts_with('.') || text.starts_with('.')) {
                walk(path, rest, depth, found);
            }
        }
    }
}

/// What a folder holds; nothing where it cannot be read.
fn entries(folder: &Path) -> Vec<(PathBuf, std::fs::FileType)> {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let listed = std::fs::read_dir(here).into_iter().flatten().flatten();
    listed.filter_map(|entry| Some((folder.join(entry.file_name()), entry.file_type().ok()?))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_star_takes_any_letters_and_a_question_mark_one() {
        for (pattern, text) in [("walk*", "walk"), ("*a*b*", "xxaxxbxx"), ("w?lk", "wölk"), ("*", ""), ("a[1]", "a[1]")]
        {
            assert!(matches(pattern, text), "{pattern} {text}");
        }
        for (pattern, text) in [("walk*", "Walk"), ("?", ""), ("*ab", "abc"), ("a?c", "ac"), ("", "a"), ("a[1]", "a1")]
        {
            assert!(!matches(pattern, text), "{pattern} {text}");
        }
        assert!(!matches(&"*a".repeat(40), &"a".repeat(39)), "one letter too few, and no explosion");
    }

    #[test]
    fn patterns_find_files_in_order_and_folders_are_looked_through() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir_all(folder.path().join("b/c")).expect("made");
        for name in ["z.bvh", "a.bvh", "a.txt", "b/m.bvh", "b/c/n.bvh", ".hidden.bvh"] {
            fs::write(folder.path().join(name), "x").expect("written");
        }
        let names = |found: Vec<PathBuf>| -> Vec<String> {
            let below = |path: PathBuf| path.strip_prefix(folder.path()).expect("below").display().to_string();
            found.into_iter().map(|path| below(path).replace('\\', "/")).collect()
        };
        assert_eq!(names(files(&folder.path().join("*.bvh"))), ["a.bvh", "z.bvh"]);
        assert_eq!(names(files(&folder.path().join("*/?.bvh"))), ["b/m.bvh"]);
        assert_eq!(names(files(&folder.path().join("**/*.bvh"))), ["a.bvh", "b/c/n.bvh", "b/m.bvh", "z.bvh"]);
        assert!(files(&folder.path().join("*.fbx")).is_empty());
        let bvh = |path: &Path| path.extension().is_some_and(|ending| ending == "bvh");
        assert_eq!(names(files_below(folder.path(), &bvh)).len(), 5);
    }
}
