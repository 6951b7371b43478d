//! The forms of the arguments' values: numbers in their ranges, names, file endings. Each says what would be right.

use super::args::Assist;
use crate::export::engine::{ENGINES, Engine};
use crate::model::findings::Rule;
use std::path::PathBuf;

pub(super) fn number(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| format!("give a number of {unit}"))?;
    if number >= low && number <= high { Ok(number) } else { Err(format!("give {low} to {high} {unit}")) }
}

pub(super) fn numbers(text: &str) -> Result<(usize, usize), String> {
    let (from, to) = text.split_once('-').unwrap_or((text, text));
    match (from.trim().parse(), to.trim().parse()) {
        (Ok(from), Ok(to)) if 1 <= from && from <= to => Ok((from, to)),
        _ => Err("give the first and the last number, from 1, as in 25-48".to_owned()),
    }
}

pub(super) fn fps(text: &str) -> Result<f64, String> {
    number(text, 1.0, 240.0, "frames per second")
}

pub(super) fn clip_name(text: &str) -> Result<String, String> {
    let good = !text.trim().is_empty() && text.chars().count() <= 200 && !text.chars().any(char::is_control);
    if good { Ok(text.to_owned()) } else { Err("give 1 to 200 visible letters".to_owned()) }
}

pub(super) fn assist(text: &str) -> Result<Assist, String> {
    const FORMS: &str = "give off, auto, Nm, or Nm,N as in 50,100";
    let bound = |text: &str| match text.trim().parse::<f64>() {
        Ok(number) if number >= 0.0 && number.is_finite() => Ok(number),
        _ => Err(FORMS.to_owned()),
    };
    match text {
        "off" => Ok(Assist::Off),
        "auto" => Ok(Assist::Auto),
        _ => match text.split_once(',') {
            None => Ok(Assist::Bound(bound(text)?, None)),
            Some((moment, force)) => Ok(Assist::Bound(bound(moment)?, Some(bound(force)?))),
        },
    }
}

pub(super) fn glb_path(text: &str) -> Result<PathBuf, String> {
    const REMEDY: &str =
        "a baked clip is a binary glTF file: let its name end in .glb, in .vrma for a VRM animation, or in .fbx";
    with_ending(text, &["glb", "vrm", "vrma", "fbx"], REMEDY)
}

pub(super) fn png_path(text: &str) -> Result<PathBuf, String> {
    with_ending(text, &["png"], "the picture is a PNG file: let its name end in .png")
}

pub(super) fn svg_path(text: &str) -> Result<PathBuf, String> {
    with_ending(text, &["svg"], "the plot is an SVG file: let its name end in .svg")
}

pub(super) fn rule(text: &str) -> Result<Rule, String> {
    let names = || Rule::ALL.map(Rule::name).join(", ");
    Rule::ALL.into_iter().find(|rule| rule.name() == text).ok_or_else(|| format!("give one of {}", names()))
}

pub(super) fn engine(text: &str) -> Result<&'static Engine, String> {
    let names = || ENGINES.each_ref().map(|engine| engine.name).join(", ");
    Engine::named(text).ok_or_else(|| format!("give one of {}, or several: three,bevy", names()))
}

pub(super) fn csv_path(text: &str) -> Result<PathBuf, String> {
    with_ending(text, &["csv"], "the table is a CSV file: let its name end in .csv")
}

pub(super) fn html_path(text: &str) -> Result<PathBuf, String> {
    with_ending(text, &["html", "htm"], "the page is an HTML file: let its name end in .html")
}

pub(super) fn toml_path(text: &str) -> Result<PathBuf, String> {
    with_ending(text, &["toml"], "waivers are a TOML file: let its name end in .toml")
}

pub(super) fn axis(text: &str) -> Result<String, String> {
    let (sign, letter) = match text.strip_prefix('-') {
        Some(rest) => ('-', rest),
        None => ('+', text.strip_prefix('+').unwrap_or(text)),
    };
    match letter.to_ascii_uppercase().as_str() {
        letter @ ("X" | "Y" | "Z") => Ok(format!("{sign}{letter}")),
        _ => Err("give X, Y or Z, also with a sign, as in -Z".to_owned()),
    }
}

pub(super) fn with_ending(text: &str, endings: &[&str], remedy: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    if ending.is_some_and(|ending| endings.contains(&ending.as_str())) { Ok(path) } else { Err(remedy.to_owned()) }
}
