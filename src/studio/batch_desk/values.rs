//! The values of a scenario that a grid may vary: their paths, units, and what to try first. Pure; as the text says them: degrees.

use crate::model::Scenario;
use crate::model::scenario_write::write;
use toml::{Table, Value};

/// Values that every scenario has, whether its text says them or not.
const EVERYWHERE: [&str; 13] = [
    "character.mass",
    "character.leg_scale",
    "character.crouch",
    "character.agility",
    "character.breathing",
    "character.step_height",
    "character.stance_width",
    "character.readiness",
    "character.recovery_time",
    "character.arms",
    "ground.friction",
    "duration",
    "seed",
];

/// What a person may want to vary in that scenario: disturbances first, then walks and the like, the ground, the character.
pub fn paths(scenario: &Scenario) -> Vec<String> {
    let table: Table = write(scenario).parse().unwrap_or_default();
    let lanes = ["push", "pull", "throw", "carry", "walk", "turn", "crouch", "stand", "ground"];
    let mut paths = Vec::new();
    for lane in lanes {
        if let Some(value) = table.get(lane) {
            leaves(value, lane, &mut paths);
        }
    }
    paths
        .extend(EVERYWHERE.map(str::to_owned).into_iter().filter(|path| table_lacks(&paths, path)).collect::<Vec<_>>());
    paths
}

fn table_lacks(paths: &[String], path: &str) -> bool {
    !paths.iter().any(|known| known == path)
}

/// Paths of single values; curves over time are left out.
fn leaves(value: &Value, path: &str, found: &mut Vec<String>) {
    let key = path.rsplit('.').next().unwrap_or(path);
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| leaves(value, &format!("{path}.{key}"), found)),
        Value::Array(list) if ["toward", "from", "mass", "pitch", "roll"].contains(&key) => {
            if matches!(key, "toward" | "from") && !list.is_empty() {
                found.push(path.to_owned());
            }
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(index, value)| leaves(value, &format!("{path}.{index}"), found));
        }
        _ if key == "kind" => {}
        _ => found.push(path.to_owned()),
    }
}

/// What stands there, if the text says it.
pub fn now(scenario: &Scenario, path: &str) -> Option<Value> {
    let table: Table = write(scenario).parse().ok()?;
    let mut at = &Value::Table(table);
    for key in path.split('.') {
        at = match at {
            Value::Array(list) => list.get(key.parse::<usize>().ok()?)?,
            other => other.get(key)?,
        };
    }
    Some(at.clone())
}

/// Its unit; empty for words, counts and shares.
pub fn unit(path: &str) -> &'static str {
    let mut keys = path.rsplit('.');
    let mut key = keys.next().unwrap_or_default();
    if key.parse::<usize>().is_ok() {
        key = keys.next().unwrap_or_default();
    }
    match key {
        "force" => "N",
        "start" | "end" | "duration" | "interval" => "s",
        "speed" => "m/s",
        "heading" | "facing" | "angle" | "toward" | "from" => "°",
        "mass" => "kg",
        "density" => "kg/m³",
        "radius" | "spread" | "size" | "rise" | "tread" | "height" | "wavelength" | "width" | "spacing" => "m",
        _ => "",
    }
}

/// A value with its unit, as a heading says it.
pub fn told(path: &str, value: &Value) -> String {
    let shown = crate::batch::name::shown(value);
    match (unit(path), value) {
        ("", Value::Integer(_) | Value::Float(_)) if path == "seed" => format!("seed {shown}"),
        ("°", Value::Integer(_) | Value::Float(_)) => format!("{shown}°"),
        (unit, Value::Integer(_) | Value::Float(_)) if !unit.is_empty() => format!("{shown} {unit}"),
        _ => shown,
    }
}

/// What to try of a value first: words, or (from, to, count).
pub enum Try {
    /// A list.
    Words(&'static str),
    /// Even steps.
    Range(f64, f64, u32),
}

/// What to try first.
pub fn first_try(path: &str, now: Option<&Value>) -> Try {
    let number = now.and_then(|value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64)));
    let key = path.rsplit('.').next().unwrap_or(path);
    match (key, number) {
        ("toward" | "from", None) => Try::Words("front, back, left, right"),
        ("at", _) => Try::Words("head, chest, hips"),
        ("on", _) => Try::Words("both, left, right"),
        ("seed", Some(seed)) => Try::Range(seed, seed + 3.0, 4),
        ("seed", None) => Try::Range(0.0, 3.0, 4),
        ("heading" | "facing" | "toward" | "from", Some(_)) => Try::Range(-90.0, 90.0, 5),
        ("mass", None) => Try::Range(60.0, 120.0, 4),
        ("leg_scale", _) => Try::Range(0.8, 1.2, 5),
        ("friction", _) => Try::Range(0.3, 1.0, 4),
        ("duration", None) => Try::Range(3.0, 6.0, 4),
        ("start", Some(start)) => Try::Range(start, rounded(start + 0.6), 4),
        (_, Some(value)) if value != 0.0 && !path.starts_with("character.") => {
            Try::Range(rounded(0.5 * value), rounded(1.5 * value), 4)
        }
        _ => Try::Range(0.0, 1.0, 5),
    }
}

/// Three digits are enough to begin with.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
