//! Reads typed values out of TOML tables, keeping the place of each and noting every fault instead of stopping.
//!
//! A key that nobody asked for is unknown: [`Reader::finish`] says so, with the nearest key that was.

use super::scenario_errors::{Places, TextFault};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// One table, as it is read.
pub(super) struct Reader<'r, 'i> {
    /// What the whole document is, for messages.
    what: &'static str,
    table: &'r DeTable<'i>,
    /// Bytes of the table's header, for what it lacks.
    span: Range<usize>,
    path: String,
    asked: Vec<&'static str>,
    places: &'r mut Places,
    faults: &'r mut Vec<TextFault>,
}

impl<'r, 'i> Reader<'r, 'i> {
    /// The whole document, and what it is.
    pub(super) fn new(
        what: &'static str,
        table: &'r DeTable<'i>,
        places: &'r mut Places,
        faults: &'r mut Vec<TextFault>,
    ) -> Self {
        Reader { what, table, span: 0..0, path: String::new(), asked: Vec::new(), places, faults }
    }

    /// The value under a key, whatever it is. Counts as asked for.
    pub(super) fn peek(&mut self, key: &'static str) -> Option<&'r DeValue<'i>> {
        self.value(key).map(Spanned::get_ref)
    }

    /// A finite number.
    pub(super) fn number(&mut self, key: &'static str) -> Option<f64> {
        let value = self.value(key)?;
        self.number_of(self.path_of(key), value)
    }

    /// A finite number that must be there; 0 stands in for it where it is not.
    pub(super) fn required_number(&mut self, key: &'static str) -> f64 {
        if self.peek(key).is_none() {
            self.missing(key, &format!("add `{key} = ...`"));
            return 0.0;
        }
        self.number(key).unwrap_or(0.0)
    }

    /// A number of a range; `unit` is for the message.
    pub(super) fn number_within(&mut self, key: &'static str, (low, high): (f64, f64), unit: &str) -> Option<f64> {
        let value = self.value(key)?;
        let number = self.number_of(self.path_of(key), value)?;
        if !(low..=high).contains(&number) {
            let message = format!("`{key}` = {number} is out of range");
            self.fault(self.path_of(key), value.span(), message, &format!("give {low} to {high} {unit}"));
        }
        Some(number)
    }

    /// True or false.
    pub(super) fn truth(&mut self, key: &'static str) -> Option<bool> {
        match self.peek(key)? {
            DeValue::Boolean(truth) => Some(*truth),
            _ => {
                self.wrong_type(key, "true or false", &format!("write `{key} = true`, without quotes"));
                None
            }
        }
    }

    /// A number of degrees, in radians.
    pub(super) fn degrees(&mut self, key: &'static str) -> Option<f64> {
        self.number(key).map(f64::to_radians)
    }

    /// A whole number from 0.
    pub(super) fn whole(&mut self, key: &'static str) -> Option<u64> {
        let value = self.value(key)?;
        if let DeValue::Integer(integer) = value.get_ref() {
            let read = u64::from_str_radix(integer.as_str(), integer.radix()).ok();
            if read.is_none() {
                self.fault(
                    self.path_of(key),
                    value.span(),
                    format!("{integer} is out of range"),
                    "give a whole number from 0",
                );
            }
            return read;
        }
        self.wrong_type(key, "a whole number", "give a whole number from 0, without quotes");
        None
    }

    /// A small whole number from 0.
    pub(super) fn count(&mut self, key: &'static str) -> Option<u32> {
        self.whole(key).map(|count| u32::try_from(count).unwrap_or(u32::MAX))
    }

    /// Text.
    pub(super) fn string(&mut self, key: &'static str) -> Option<String> {
        match self.peek(key)? {
            DeValue::String(text) => Some(text.to_string()),
            _ => {
                self.wrong_type(key, "text", &format!("put it in quotes: `{key} = \"...\"`"));
                None
            }
        }
    }

    /// One of several words.
    pub(super) fn choice<T: Copy>(&mut self, key: &'static str, choices: &[(&str, T)]) -> Option<T> {
        let value = self.value(key)?;
        let DeValue::String(text) = value.get_ref() else {
            self.wrong_type(key, "a word in quotes", &format!("give {}", list(choices)));
            return None;
        };
        #[cfg(test)]
        asked::note(&self.path_of(key), &choices.iter().map(|(name, _)| *name).collect::<Vec<_>>());
        let found = choices.iter().find(|(name, _)| *name == text.as_ref());
        if found.is_none() {
            let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
            let remedy = match nearest(text, &names) {
                Some(name) => format!("did you mean \"{name}\"?"),
                None => format!("give {}", list(choices)),
            };
            self.fault(self.path_of(key), value.span(), format!("`{key}` cannot be {:?}", shorten(text)), &remedy);
        }
        found.map(|(_, choice)| *choice)
    }

    /// As [`Self::choice`], and it must be there.
    pub(super) fn required_choice<T: Copy>(&mut self, key: &'static str, choices: &[(&str, T)], otherwise: T) -> T {
        if self.peek(key).is_none() {
            self.missing(key, &format!("give {}", list(choices)));
        }
        self.choice(key, choices).unwrap_or(otherwise)
    }

    /// An array of exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&mut self, key: &'static str) -> Option<[f64; N]> {
        let value = self.value(key)?;
        self.numbers_of(&self.path_of(key), value)
    }

    /// An array of (time, value) pairs, at least one.
    pub(super) fn points(&mut self, key: &'static str) -> Option<Vec<[f64; 2]>> {
        let value = self.value(key)?;
        let path = self.path_of(key);
        let DeValue::Array(array) = value.get_ref() else {
            self.wrong_type(key, "a list of pairs", "give [[seconds, value], [seconds, value], ...]");
            return None;
        };
        let mut points = Vec::with_capacity(array.len());
        let mut good = true;
        for (index, pair) in array.iter().enumerate() {
            let pair_path = format!("{path}.{index}");
            self.places.set(pair_path.clone(), pair.span());
            match self.numbers_of::<2>(&pair_path, pair) {
                Some(point) => points.push(point),
                None => good = false,
            }
        }
        good.then_some(points)
    }

    /// An array of [time, [three numbers]].
    pub(super) fn timed(&mut self, key: &'static str) -> Option<Vec<(f64, [f64; 3])>> {
        let value = self.value(key)?;
        let path = self.path_of(key);
        let DeValue::Array(array) = value.get_ref() else { return None };
        let mut points = Vec::with_capacity(array.len());
        for (index, pair) in array.iter().enumerate() {
            let place = format!("{path}.{index}");
            self.places.set(place.clone(), pair.span());
            let parts = match pair.get_ref() {
                DeValue::Array(parts) if parts.len() == 2 => parts,
                other => {
                    let message = format!("`{key}` must be pairs of a time and three lengths, this is {}", kind(other));
                    self.fault(place, pair.span(), message, "give [[seconds, [across, up, forward]], ...]");
                    continue;
                }
            };
            self.places.set(format!("{place}.0"), parts[0].span());
            self.places.set(format!("{place}.1"), parts[1].span());
            let time = self.number_of(format!("{place}.0"), &parts[0]);
            let three = self.numbers_of::<3>(&format!("{place}.1"), &parts[1]);
            points.extend(time.zip(three));
        }
        (points.len() == array.len()).then_some(points)
    }

    /// A table under a key.
    pub(super) fn table(&mut self, key: &'static str) -> Option<Reader<'_, 'i>> {
        let value = self.value(key)?;
        let path = self.path_of(key);
        let DeValue::Table(table) = value.get_ref() else {
            self.wrong_type(key, "a table", &format!("write it under a header of its own: `[{key}]`"));
            return None;
        };
        Some(Reader {
            what: self.what,
            table,
            span: value.span(),
            path,
            asked: Vec::new(),
            places: self.places,
            faults: self.faults,
        })
    }

    /// The entries of a lane, `[[key]]`; each is read by `read`.
    pub(super) fn lane<T>(&mut self, key: &'static str, mut read: impl FnMut(&mut Reader<'_, 'i>) -> T) -> Vec<T> {
        let Some(value) = self.value(key) else { return Vec::new() };
        let DeValue::Array(entries) = value.get_ref() else {
            self.wrong_type(key, "a lane of entries", &format!("two brackets for each entry: `[[{key}]]`"));
            return Vec::new();
        };
        let mut read_entries = Vec::with_capacity(entries.len());
        for (index, entry) in entries.iter().enumerate() {
            let path = format!("{}.{index}", self.path_of(key));
            self.places.set(path.clone(), entry.span());
            let DeValue::Table(table) = entry.get_ref() else {
                let message = format!("an entry of `{key}` must be a table, this is {}", kind(entry.get_ref()));
                self.fault(path, entry.span(), message, &format!("two brackets for each entry: `[[{key}]]`"));
                continue;
            };
            let mut reader = Reader {
                what: self.what,
                table,
                span: entry.span(),
                path,
                asked: Vec::new(),
                places: &mut *self.places,
                faults: &mut *self.faults,
            };
            read_entries.push(read(&mut reader));
            reader.finish();
        }
        read_entries
    }

    /// Notes that a key is not there but must be.
    pub(super) fn missing(&mut self, key: &'static str, remedy: &str) {
        let within = if self.path.is_empty() { self.what.to_owned() } else { format!("`{}`", self.path) };
        self.fault(self.path_of(key), self.span.clone(), format!("{within} has no `{key}`"), remedy);
    }

    /// Notes that a value is not what it should be.
    pub(super) fn wrong_type(&mut self, key: &'static str, expected: &str, remedy: &str) {
        if let Some(value) = self.value(key) {
            let message = format!("`{key}` must be {expected}, this is {}", kind(value.get_ref()));
            self.fault(self.path_of(key), value.span(), message, remedy);
        }
    }

    /// Notes the keys that nobody asked for.
    pub(super) fn finish(&mut self) {
        #[cfg(test)]
        asked::note(&self.path, &self.asked);
        for (key, _) in self.table.iter().filter(|(key, _)| !self.asked.contains(&key.get_ref().as_ref())) {
            let name = key.get_ref().as_ref();
            let remedy = match nearest(name, &self.asked) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", self.asked.join(", ")),
            };
            let within = if self.path.is_empty() { String::new() } else { format!(" in `{}`", self.path) };
            let message = format!("unknown key `{}`{within}", shorten(name));
            let path = if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) };
            self.faults.push(TextFault { path, span: key.span(), message, remedy });
        }
    }

    fn value(&mut self, key: &'static str) -> Option<&'r Spanned<DeValue<'i>>> {
        if !self.asked.contains(&key) {
            self.asked.push(key);
        }
        let value = self.table.get(key)?;
        self.places.set(self.path_of(key), value.span());
        Some(value)
    }

    fn number_of(&mut self, path: String, value: &Spanned<DeValue<'i>>) -> Option<f64> {
        let read = match value.get_ref() {
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64),
            DeValue::Float(float) => float.as_str().parse::<f64>().ok().filter(|number| number.is_finite()),
            other => {
                let message = format!("`{}` must be a number, this is {}", last(&path), kind(other));
                self.fault(path, value.span(), message, "give a plain number, without quotes");
                return None;
            }
        };
        if read.is_none() {
            let message = format!("`{}` is not a finite number", last(&path));
            self.fault(path, value.span(), message, "give a plain number");
        }
        read
    }

    fn numbers_of<const N: usize>(&mut self, path: &str, value: &Spanned<DeValue<'i>>) -> Option<[f64; N]> {
        let array = match value.get_ref() {
            DeValue::Array(array) if array.len() == N => array,
            other => {
                let found = match other {
                    DeValue::Array(array) => format!("a list of {}", array.len()),
                    other => kind(other).to_owned(),
                };
                let message = format!("`{}` must be {N} numbers, this is {found}", last(path));
                let example = vec!["0.0"; N].join(", ");
                self.fault(path.to_owned(), value.span(), message, &format!("as in [{example}]"));
                return None;
            }
        };
        let mut numbers = [0.0; N];
        let mut good = true;
        for (index, (number, element)) in numbers.iter_mut().zip(array.iter()).enumerate() {
            let element_path = format!("{path}.{index}");
            self.places.set(element_path.clone(), element.span());
            match self.number_of(element_path, element) {
                Some(read) => *number = read,
                None => good = false,
            }
        }
        good.then_some(numbers)
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    fn fault(&mut self, path: String, span: Range<usize>, message: String, remedy: &str) {
        self.faults.push(TextFault { path, span, message, remedy: remedy.to_owned() });
    }
}

/// What readers of this thread have asked for: the keys of each table, the words of each choice, by path. For the tests of the schemas.
#[cfg(test)]
pub(super) mod asked {
    use std::cell::RefCell;
    use std::collections::{BTreeMap, BTreeSet};

    type Asked = BTreeMap<String, BTreeSet<String>>;

    thread_local! { static ASKED: RefCell<Asked> = const { RefCell::new(BTreeMap::new()) }; }

    pub(super) fn note(path: &str, words: &[&str]) {
        ASKED.with_borrow_mut(|asked| {
            asked.entry(path.to_owned()).or_default().extend(words.iter().map(|word| (*word).to_owned()));
        });
    }

    /// What was asked for since it was last taken.
    pub(in super::super) fn take() -> Asked {
        ASKED.take()
    }
}

/// What a value is, for a person.
fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

fn list<T>(choices: &[(&str, T)]) -> String {
    let shown: Vec<String> = choices.iter().take(24).map(|(name, _)| format!("\"{name}\"")).collect();
    let more = if choices.len() > shown.len() { ", ..." } else { "" };
    format!("{}{more}", shown.join(", "))
}

/// The last key of a path that is not an index.
fn last(path: &str) -> &str {
    path.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(path)
}

/// Text from a file, short enough for a message.
fn shorten(text: &str) -> String {
    if text.chars().count() <= 40 { text.to_owned() } else { text.chars().take(39).chain(['…']).collect() }
}

/// The known word that was probably meant.
fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    if word.len() > 64 {
        return None; // nothing is near, and the distance costs the product of the lengths
    }
    let lower = word.to_lowercase();
    known
        .iter()
        .map(|candidate| (strsim::osa_distance(&lower, &candidate.to_lowercase()), *candidate))
        .filter(|(distance, candidate)| *distance <= 1 + candidate.len().min(word.len()) / 4)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_finds_its_word() {
        let known = ["duration", "start", "force", "toward", "at"];
        for (typed, meant) in [
            ("duraton", Some("duration")),
            ("Duration", Some("duration")),
            ("towards", Some("toward")),
            ("strat", Some("start")),
            ("colour", None),
            ("xy", None),
        ] {
            assert_eq!(nearest(typed, &known), meant, "{typed}");
        }
    }

    #[test]
    fn a_swap_of_neighbours_is_one_slip() {
        assert_eq!(nearest("ta", &["at"]), Some("at"), "two replacements would be too far");
        assert_eq!(nearest("ba", &["at"]), None);
    }
}
