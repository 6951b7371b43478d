//! What a variation is called: a template with `{places}`, and what a name must be to be a file on every system and a clip in every
//! engine. Pure text.
//!
//! A place is `rig`, `title`, `scenario`, `index`, or a path that varies or that the scenario holds; `{place:3}` pads a whole number
//! with zeros to three digits, `{place:.1}` rounds to one decimal.

use toml::Value;

/// Letters of a name at most: with `.events.json` behind them it must fit into 255 bytes.
const LONGEST: usize = 200;

/// A template that was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template(Vec<Part>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Place { name: String, width: usize, decimals: Option<usize> },
}

impl Template {
    /// Reads a template; the complaint names what is wrong with it.
    pub fn read(text: &str) -> Result<Template, String> {
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some(open) = rest.find('{') {
            parts.push(Part::Text(rest[..open].to_owned()));
            let inner = &rest[open + 1..];
            let close = inner.find('}').ok_or_else(|| "a `{` without its `}`".to_owned())?;
            parts.push(place(&inner[..close])?);
            rest = &inner[close + 1..];
        }
        parts.push(Part::Text(rest.to_owned()));
        Ok(Template(parts))
    }

    /// The places that it names.
    pub fn places(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|part| match part {
            Part::Place { name, .. } => Some(name.as_str()),
            Part::Text(_) => None,
        })
    }

    /// The name with those values; `Err` names the place that has none.
    pub fn fill(&self, value: &dyn Fn(&str) -> Option<Word>) -> Result<String, String> {
        let mut name = String::new();
        for part in &self.0 {
            match part {
                Part::Text(text) => name += text,
                Part::Place { name: place, width, decimals } => {
                    let word = value(place).ok_or_else(|| place.clone())?;
                    name += &word.shown(*width, *decimals);
                }
            }
        }
        Ok(name)
    }
}

/// What stands in a place.
#[derive(Clone, Debug, PartialEq)]
pub enum Word {
    /// As it is.
    Text(String),
    /// A value of the scenario.
    Value(Value),
}

impl Word {
    fn shown(&self, width: usize, decimals: Option<usize>) -> String {
        match self {
            Word::Text(text) => text.clone(),
            Word::Value(Value::Integer(number)) => format!("{number:0width$}"),
            Word::Value(Value::Float(number)) => match decimals {
                Some(decimals) => format!("{number:0width$.decimals$}"),
                None => {
                    let text = format!("{number:.3}");
                    let text = text.trim_end_matches('0').trim_end_matches('.').to_owned();
                    format!("{text:0>width$}")
                }
            },
            Word::Value(value) => shown(value),
        }
    }
}

/// A value as a word.
pub fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(list) => list.iter().map(shown).collect::<Vec<_>>().join("_"),
        Value::Integer(_) | Value::Float(_) => Word::Value(value.clone()).shown(0, None),
        other => other.to_string().split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

/// Why a name cannot be a file's on every system; `None` where it can.
pub fn illegal(name: &str) -> Option<String> {
    const RESERVED: [&str; 4] = ["con", "prn", "aux", "nul"];
    let bad = |letter: &char| letter.is_control() || "<>:\"/\\|?*{}".contains(*letter);
    let stem = name.split('.').next().unwrap_or_default().to_lowercase();
    let numbered = |word: &str| {
        stem.strip_prefix(word).is_some_and(|rest| rest.len() == 1 && rest.chars().all(|digit| digit.is_ascii_digit()))
    };
    if name.trim().is_empty() {
        return Some("it is empty".into());
    }
    if let Some(letter) = name.chars().find(bad) {
        return Some(format!("{letter:?} stands in no file name"));
    }
    if name.starts_with(['.', ' ', '-']) || name.ends_with(['.', ' ']) {
        return Some("it begins with a dot, a space or a dash, or ends in a dot or a space".into());
    }
    if RESERVED.contains(&stem.as_str()) || numbered("com") || numbered("lpt") {
        return Some("Windows keeps this name for a device".into());
    }
    (name.len() > LONGEST).then(|| format!("{} bytes are too many, {LONGEST} are the most", name.len()))
}

fn place(inner: &str) -> Result<Part, String> {
    let (name, form) = inner.split_once(':').unwrap_or((inner, ""));
    let wrong = || format!("`{{{inner}}}`: after the colon stand digits for the width, or a dot and the decimals");
    let (width, decimals) = form.split_once('.').map_or((form, None), |(width, decimals)| (width, Some(decimals)));
    let number = |text: &str| match text {
        "" => Ok(0),
        digits => digits.parse::<usize>().ok().filter(|number| *number <= 20).ok_or_else(wrong),
    };
    if name.is_empty() || name.contains('{') {
        return Err(format!("`{{{inner}}}` names no place"));
    }
    Ok(Part::Place { name: name.to_owned(), width: number(width)?, decimals: decimals.map(number).transpose()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(template: &str) -> Result<String, String> {
        let value = |place: &str| match place {
            "rig" => Some(Word::Text("hero".into())),
            "index" => Some(Word::Value(Value::Integer(7))),
            "push.0.force" => Some(Word::Value(Value::Float(133.333_333))),
            "push.0.toward" => Some(Word::Value(Value::Array(vec![Value::Integer(1), Value::Float(0.5)]))),
            _ => None,
        };
        Template::read(template).and_then(|template| template.fill(&value))
    }

    #[test]
    fn places_are_filled_in_the_form_they_ask_for() {
        for (template, name) in [
            ("{rig}_{index:3}", "hero_007"),
            ("{push.0.force}N", "133.333N"),
            ("{push.0.force:.0}N", "133N"),
            ("{push.0.force:6.1}", "0133.3"),
            ("d{push.0.toward}", "d1_0.5"),
            ("plain", "plain"),
        ] {
            assert_eq!(filled(template).as_deref(), Ok(name), "{template}");
        }
    }

    #[test]
    fn a_broken_template_and_an_unknown_place_are_told() {
        for template in ["{rig", "{}", "{rig:x}", "{rig:.y}", "{rig:99}", "{pusn}"] {
            assert!(filled(template).is_err(), "{template}");
        }
    }

    #[test]
    fn names_that_some_system_refuses_are_found() {
        for name in ["", " ", "a/b", "a:b", "con", "NUL.x", "com1", "a.", " a", ".a", "-a", "a\nb", &"x".repeat(201)] {
            assert!(illegal(name).is_some(), "{name:?}");
        }
        for name in ["hero_left_150N_s1", "a.b", "console", "com", "naïve", "1"] {
            assert_eq!(illegal(name), None, "{name:?}");
        }
    }
}
