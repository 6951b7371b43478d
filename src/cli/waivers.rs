//! Flags that a person accepted: a TOML file of `[[waive]]`, what it covers, and one written from the flags there are.
//!
//! ```toml
//! [[waive]]
//! clip = "walk*"              # the clip's name or its file's, with * and ?
//! rule = "foot-slide"
//! frames = [10, 40]           # optional: where half of the flag's frames or more lie
//! foot = "left"               # optional
//! reason = "he slips on ice here"
//! ```
//!
//! One without `frames` and `foot` covers what is wrong with the whole clip too. What is wrong with the file is told with its line.

use crate::disk::Failure;
use crate::disk::glob;
use crate::model::findings::{Findings, Flag, Rule};
use serde::Deserialize;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;

/// The largest file that is read, bytes.
const LARGEST: u64 = 16 << 20;

/// The accepted flags of a file.
#[derive(Clone, Debug, Default)]
pub struct Waivers {
    file: String,
    list: Vec<Waiver>,
}

#[derive(Clone, Debug)]
struct Waiver {
    line: usize,
    file: Option<String>,
    clip: String,
    rule: Rule,
    frames: Option<(usize, usize)>,
    foot: Option<String>,
    reason: String,
}

/// Why each flag of a clip is accepted, where it is; in the order of the findings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waived {
    /// One a flag.
    pub flags: Vec<Option<String>>,
    /// One a clip flag.
    pub clip_flags: Vec<Option<String>>,
}

impl Waived {
    /// None of them.
    pub fn none(findings: &Findings) -> Waived {
        Waived { flags: vec![None; findings.flags.len()], clip_flags: vec![None; findings.clip_flags.len()] }
    }

    /// How many flags, the clip's among them, stand.
    pub fn standing(&self) -> usize {
        self.flags.iter().chain(&self.clip_flags).filter(|reason| reason.is_none()).count()
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    #[serde(default)]
    waive: Vec<Spanned<Entry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    file: Option<String>,
    clip: String,
    rule: Spanned<String>,
    frames: Option<Spanned<Vec<i64>>>,
    foot: Option<Spanned<String>>,
    reason: Spanned<String>,
}

/// Reads a file of waivers.
pub fn read(path: &Path) -> Result<Waivers, Failure> {
    let there = crate::disk::resolve::plain_file(path, "--write-waivers FILE.toml writes one to start from")?;
    let bad = |what: &str| Failure::bad_input(format!("{}: {what}", path.display()));
    if there.len() > LARGEST {
        return Err(bad("too large for a file of waivers"));
    }
    let bytes = std::fs::read(path).map_err(|error| bad(&format!("cannot be read: {error}")))?;
    let text = String::from_utf8(bytes).map_err(|_| bad("not UTF-8 text"))?;
    parse(&path.display().to_string(), &text).map_err(Failure::bad_input)
}

/// The same from a text; the error names file and line.
fn parse(file: &str, text: &str) -> Result<Waivers, String> {
    let line = |span: Range<usize>| text.get(..span.start).map_or(1, |before| before.matches('\n').count() + 1);
    let document: Document = toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(1, line);
        let what = error.message().replace('\n', " ");
        format!("{file}:{at}: {what}\n  help: [[waive]] with clip, rule and reason; frames = [first, last], foot, file if you like")
    })?;
    let mut list = Vec::with_capacity(document.waive.len());
    for entry in document.waive {
        let own_line = line(entry.span());
        let entry = entry.into_inner();
        let fault = |span: Range<usize>, what: String| Err(format!("{file}:{}: {what}", line(span)));
        let Some(rule) = Rule::ALL.into_iter().find(|rule| rule.name() == entry.rule.get_ref()) else {
            let names: Vec<&str> = Rule::ALL.iter().map(|rule| rule.name()).collect();
            let what = format!("no rule {:?}\n  help: one of {}", entry.rule.get_ref(), names.join(", "));
            return fault(entry.rule.span(), what);
        };
        if let Some(foot) = entry.foot.as_ref().filter(|foot| !matches!(foot.get_ref().as_str(), "left" | "right")) {
            return fault(foot.span(), format!("no foot {:?}: left or right", foot.get_ref()));
        }
        if entry.reason.get_ref().trim().is_empty() {
            return fault(entry.reason.span(), "a waiver needs its reason".to_owned());
        }
        let frames = match &entry.frames {
            None => None,
            Some(frames) => match frames.get_ref().as_slice() {
                [first, last] if *first >= 0 && first <= last => Some((*first as usize, *last as usize)),
                _ => return fault(frames.span(), "frames is [first, last], from 0".to_owned()),
            },
        };
        list.push(Waiver {
            line: own_line,
            file: entry.file,
            clip: entry.clip,
            rule,
            frames,
            foot: entry.foot.map(Spanned::into_inner),
            reason: entry.reason.into_inner(),
        });
    }
    Ok(Waivers { file: file.to_owned(), list })
}

impl Waivers {
    /// What is accepted of a clip; `used` counts what each waiver covered.
    pub fn apply(&self, path: &Path, findings: &Findings, used: &mut [usize]) -> Waived {
        let mut waived = Waived::none(findings);
        for (index, waiver) in self.list.iter().enumerate().filter(|(_, waiver)| waiver.is_for(path, &findings.clip)) {
            for (flag, reason) in findings.flags.iter().zip(&mut waived.flags) {
                if waiver.covers(flag) {
                    used[index] += 1;
                    reason.get_or_insert_with(|| waiver.reason.clone());
                }
            }
            for (flag, reason) in findings.clip_flags.iter().zip(&mut waived.clip_flags) {
                if waiver.rule == flag.rule && waiver.frames.is_none() && waiver.foot.is_none() {
                    used[index] += 1;
                    reason.get_or_insert_with(|| waiver.reason.clone());
                }
            }
        }
        waived
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// A warning for each that covered nothing.
    pub fn idle(&self, used: &[usize]) -> Vec<String> {
        let idle = self.list.iter().zip(used).filter(|(_, used)| **used == 0);
        idle.map(|(waiver, _)| {
            format!("{}:{}: this waiver of {} covers no flag", self.file, waiver.line, waiver.rule.name())
        })
        .collect()
    }
}

impl Waiver {
    fn is_for(&self, path: &Path, clip: &str) -> bool {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let whole = path.display().to_string();
        let is = |pattern: &str, text: &str| pattern == text || glob::matches(pattern, text);
        let of_file = |pattern: &str| is(pattern, &name) || is(pattern, &stem) || is(pattern, &whole);
        self.file.as_deref().is_none_or(of_file) && (is(&self.clip, clip) || of_file(&self.clip))
    }

    fn covers(&self, flag: &Flag) -> bool {
        let frames = self.frames.is_none_or(|(first, last)| {
            let (from, to) = (flag.start.max(first), flag.end.min(last));
            let frames = flag.end.saturating_sub(flag.start) + 1;
            to >= from && 2 * (to - from + 1) >= frames
        });
        frames && self.rule == flag.rule && self.foot.as_deref().is_none_or(|foot| flag.foot == Some(foot))
    }
}

/// A file that waives every flag of those clips; a reason that was given before is kept.
pub fn write(clips: &[(&Path, &Findings, &Waived)]) -> String {
    let mut text =
        "# Flags that were seen and accepted: say why in `reason`, delete what shall be flagged again.\n".to_owned();
    for (path, findings, waived) in clips {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let mut entry = |rule: Rule, place: &str, reason: &Option<String>, why: &str| {
            let why: String = why.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
            text.push_str(&format!("\n# {}\n[[waive]]\n", why.trim()));
            if stem != findings.clip {
                text.push_str(&format!("file = {}\n", quoted(&name)));
            }
            let reason = reason.as_deref().unwrap_or("seen and accepted");
            text.push_str(&format!("clip = {}\nrule = \"{}\"\n{place}", quoted(&findings.clip), rule.name()));
            text.push_str(&format!("reason = {}\n", quoted(reason)));
        };
        for (flag, reason) in findings.clip_flags.iter().zip(&waived.clip_flags) {
            entry(flag.rule, "", reason, &flag.why);
        }
        for (flag, reason) in findings.flags.iter().zip(&waived.flags) {
            let foot = flag.foot.map(|foot| format!("foot = \"{foot}\"\n")).unwrap_or_default();
            entry(flag.rule, &format!("frames = [{}, {}]\n{foot}", flag.start, flag.end), reason, &flag.why);
        }
    }
    text
}

/// A TOML string of any text.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::findings::ClipFlag;

    fn findings(clip: &str) -> Findings {
        let flag = |start, end, rule, foot| Flag {
            start,
            end,
            rule,
            foot,
            severity: 0.5,
            measured: 0.1,
            predicted: 0.0,
            delta_m: 0.1,
            why: "it\nslides".to_owned(),
        };
        Findings {
            version: 1,
            clip: clip.to_owned(),
            fps: 30.0,
            frames: 100,
            units_to_metres: 0.01,
            up: "+Y".to_owned(),
            confidence: 1.0,
            flags: vec![
                flag(10, 19, Rule::FootSlide, Some("left")),
                flag(12, 15, Rule::FootSlide, Some("right")),
                flag(50, 59, Rule::Balance, None),
            ],
            clip_flags: vec![ClipFlag { rule: Rule::Timing, severity: 0.5, why: "slow".to_owned() }],
            contacts: Vec::new(),
            steps: Vec::new(),
            abstained: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn applied(text: &str) -> (Waived, Vec<String>) {
        let waivers = parse("w.toml", text).expect("waivers");
        let mut used = vec![0; waivers.len()];
        let waived = waivers.apply(Path::new("mocap/walk_01.bvh"), &findings("walk_01"), &mut used);
        (waived, waivers.idle(&used))
    }

    #[test]
    fn a_waiver_covers_its_rule_foot_and_frames_and_no_more() {
        let entry = |rest: &str| applied(&format!("[[waive]]\nclip = \"walk*\"\nreason = \"ice\"\n{rest}")).0;
        let ice = Some("ice".to_owned());
        let slides = entry("rule = \"foot-slide\"");
        assert_eq!(slides.flags, [ice.clone(), ice.clone(), None]);
        assert_eq!((slides.standing(), slides.clip_flags[0].clone()), (2, None));
        assert_eq!(entry("rule = \"foot-slide\"\nfoot = \"right\"").flags, [None, ice.clone(), None]);
        assert_eq!(entry("rule = \"balance\"\nframes = [55, 80]").flags, [None, None, ice.clone()], "half of it");
        assert_eq!(entry("rule = \"balance\"\nframes = [56, 80]").flags, [None, None, None], "less than half");
        assert_eq!(entry("rule = \"timing\"").clip_flags, [ice]);
        assert_eq!(entry("rule = \"timing\"\nframes = [0, 99]").clip_flags, [None]);
    }

    #[test]
    fn a_waiver_that_covers_nothing_is_told_with_its_line() {
        let (waived, idle) = applied(
            "\n[[waive]]\nclip = \"run*\"\nrule = \"float\"\nreason = \"a\"\n\n[[waive]]\nclip = \"walk_01.bvh\"\nrule = \"balance\"\nreason = \"b\"\n",
        );
        assert_eq!(idle, ["w.toml:2: this waiver of float covers no flag"]);
        assert_eq!(waived.flags[2].as_deref(), Some("b"), "by the name of the file");
    }

    #[test]
    fn what_is_wrong_is_told_with_file_and_line() {
        let entry = "[[waive]]\nclip = \"a\"\nreason = \"x\"\n";
        for (text, wanted) in [
            (format!("{entry}rule = \"slide\""), "w.toml:4: no rule \"slide\""),
            (format!("{entry}rule = \"float\"\nfoot = \"both\""), "w.toml:5: no foot"),
            (format!("{entry}rule = \"float\"\nframes = [4, 2]"), "w.toml:5: frames is [first, last]"),
            (format!("{entry}rule = \"float\"\nframes = [1]"), "w.toml:5:"),
            (format!("{entry}rule = \"float\"\nframe = 1"), "w.toml:5: unknown field `frame`"),
            (
                "[[waive]]\nclip = \"a\"\nrule = \"float\"\nreason = \" \"".to_owned(),
                "w.toml:4: a waiver needs its reason",
            ),
            ("[[waive]]\nclip = \"a\"\nrule = \"float\"".to_owned(), "missing field `reason`"),
            ("x = ".to_owned(), "w.toml:1:"),
        ] {
            let told = parse("w.toml", &text).expect_err(&text);
            assert!(told.contains(wanted), "{wanted}: {told}");
        }
    }

    #[test]
    fn what_is_written_waives_everything_and_keeps_reasons() {
        let hostile = "wa*lk \"1\" \u{1b}[31m\\ [x]";
        let mut findings = findings(hostile);
        findings.flags[2].why = "\u{1b}[2J".to_owned();
        let mut before = Waived::none(&findings);
        before.flags[1] = Some("'''\"he's\" on ice".to_owned());
        let path = Path::new("a/Take \"1\".fbx");
        let text = write(&[(path, &findings, &before)]);
        let waivers = parse("w.toml", &text).expect("a file that is read again");
        let mut used = vec![0; waivers.len()];
        let waived = waivers.apply(path, &findings, &mut used);
        assert_eq!((waived.standing(), waived.flags[1].clone()), (0, before.flags[1].clone()));
        assert_eq!((waivers.idle(&used).len(), waivers.len()), (0, 4));
        assert!(!text.contains('\u{1b}'), "{text}");
    }
}
