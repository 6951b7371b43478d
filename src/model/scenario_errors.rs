//! What is wrong with a scenario and where: a fault by its path, the same in a text, and the places that join the two.
//!
//! Plain data; how a fault is drawn on a screen is the command line's affair.

use std::collections::BTreeMap;
use std::ops::Range;

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where: keys and indices from 0, joined by dots, as in `push.0.force`.
    pub path: String,
    /// What is wrong, with the value in it.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

/// The text of a scenario and where in it each value stands.
#[derive(Clone, Debug)]
pub struct ScenarioSource {
    name: String,
    text: String,
    places: Places,
}

/// Everything that is wrong with a scenario's text, in the order of the text.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", self.lines().join("\n"))]
pub struct ScenarioErrors {
    /// The file's name.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// At least one.
    pub faults: Vec<TextFault>,
}

/// A fault with its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    /// Keys and indices joined by dots; empty where the syntax is broken.
    pub path: String,
    /// Bytes of the text, on character boundaries.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

impl ScenarioErrors {
    /// Line and column of a fault, from 1; columns count characters.
    pub fn line_column(&self, fault: &TextFault) -> (usize, usize) {
        let before = self.text.get(..fault.span.start).unwrap_or(&self.text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }

    /// One line a fault: `shove.toml:4:9: message (remedy)`.
    pub fn lines(&self) -> Vec<String> {
        let line = |fault: &TextFault| {
            let (line, column) = self.line_column(fault);
            format!("{}:{line}:{column}: {} ({})", self.name, fault.message, fault.remedy)
        };
        self.faults.iter().map(line).collect()
    }
}

impl ScenarioSource {
    pub(super) fn new(name: &str, text: &str) -> ScenarioSource {
        ScenarioSource { name: name.to_owned(), text: text.to_owned(), places: Places::default() }
    }

    pub(super) fn places_mut(&mut self) -> &mut Places {
        &mut self.places
    }

    /// Those faults, at their places in this text.
    pub fn errors(&self, faults: &[Fault]) -> ScenarioErrors {
        self.collect(faults.iter().map(|fault| self.locate(fault)).collect())
    }

    pub(super) fn locate(&self, fault: &Fault) -> TextFault {
        TextFault {
            path: fault.path.clone(),
            span: whole_characters(&self.text, self.places.find(&fault.path)),
            message: format!("`{}`: {}", fault.path, fault.message),
            remedy: fault.remedy.clone(),
        }
    }

    pub(super) fn collect(&self, mut faults: Vec<TextFault>) -> ScenarioErrors {
        for fault in &mut faults {
            fault.span = whole_characters(&self.text, fault.span.clone());
        }
        faults.sort_by(|a, b| (a.span.start, a.span.end, &a.path).cmp(&(b.span.start, b.span.end, &b.path)));
        ScenarioErrors { name: self.name.clone(), text: self.text.clone(), faults }
    }
}

/// Where in the text each value stands, by its path.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    spans: BTreeMap<String, Range<usize>>,
}

impl Places {
    pub(super) fn set(&mut self, path: String, span: Range<usize>) {
        self.spans.insert(path, span);
    }

    /// The place of that path, or of the nearest thing around it that has one.
    pub(super) fn find(&self, path: &str) -> Range<usize> {
        let mut path = path;
        loop {
            if let Some(span) = self.spans.get(path) {
                return span.clone();
            }
            match path.rfind('.') {
                Some(dot) => path = &path[..dot],
                None => return 0..0,
            }
        }
    }
}

/// The nearest range inside of the text that cuts no character.
fn whole_characters(text: &str, span: Range<usize>) -> Range<usize> {
    let start = text.floor_char_boundary(span.start);
    let end = text.ceil_char_boundary(span.end.max(start));
    start..end
}
