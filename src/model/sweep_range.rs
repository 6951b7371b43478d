//! `{ from, to, count }`, `{ from, to, step }` and `{ from, to }` of a sweep: even steps, or even steps of the logarithm.
//!
//! Steps of whole numbers are whole numbers where they come out so. Values are rounded to 12 digits: what a person would write.

use super::sweep::{AxisValues, Choice};
use super::sweep_axes::owned;
use crate::maths::real;
use toml::Value;
use toml::de::DeTable;

/// Steps of one range at most.
const MOST_STEPS: f64 = 1.0e6;

/// A complaint, and its remedy where it is not the list of forms.
type Wrong = (String, Option<&'static str>);

/// The values of a range.
pub(super) fn range(table: &DeTable<'_>) -> Result<AxisValues, Wrong> {
    const KNOWN: [&str; 5] = ["from", "to", "count", "step", "scale"];
    if let Some((key, _)) = table.iter().find(|(key, _)| !KNOWN.contains(&key.get_ref().as_ref())) {
        return Err((format!("unknown key `{}` in a range", key.get_ref()), None));
    }
    let number = |key: &str| match table.get(key).map(|value| owned(value.get_ref())) {
        None => Ok(None),
        Some(Value::Integer(whole)) => Ok(Some((whole as f64, true))),
        Some(Value::Float(number)) if number.is_finite() => Ok(Some((number, false))),
        Some(_) => Err((format!("`{key}` must be a number"), None)),
    };
    let lacks = |key: &str| (format!("a range has no `{key}`"), None);
    let (from, from_whole) = number("from")?.ok_or_else(|| lacks("from"))?;
    let (to, to_whole) = number("to")?.ok_or_else(|| lacks("to"))?;
    let log = match table.get("scale").map(|value| owned(value.get_ref())) {
        None => false,
        Some(Value::String(scale)) if scale == "linear" => false,
        Some(Value::String(scale)) if scale == "log" => true,
        Some(_) => return Err(("`scale` is \"linear\" or \"log\"".into(), None)),
    };
    if log && (from <= 0.0 || to <= 0.0) {
        return Err(("a logarithm needs both ends over 0".into(), Some("give ends over 0, or leave `scale` away")));
    }
    let (count, step) = (number("count")?, number("step")?);
    let values: Vec<f64> = match (count, step) {
        (Some(_), Some(_)) => return Err(("`count` and `step` are two answers to one question".into(), None)),
        (None, None) => return Ok(AxisValues::Between { from, to, log }),
        (Some((count, whole)), None) => {
            if !whole || !(1.0..=MOST_STEPS).contains(&count) {
                return Err((format!("`count` is a whole number from 1 to {MOST_STEPS}"), None));
            }
            let last = (count - 1.0).max(1.0);
            (0..count as usize).map(|index| between(from, to, log, index as f64 / last)).collect()
        }
        (None, Some((step, _))) => {
            if step == 0.0 || (to - from) * step < 0.0 || log {
                let remedy = "let it lead from `from` to `to`; logarithmic ranges take `count`";
                return Err((format!("`step` = {step} never arrives"), Some(remedy)));
            }
            let steps = ((to - from) / step + 1e-9).floor();
            if steps >= MOST_STEPS {
                return Err((format!("`step` = {step} makes too many values"), None));
            }
            (0..=steps as usize).map(|index| from + step * index as f64).collect()
        }
    };
    let whole = from_whole && to_whole && step.is_none_or(|(_, whole)| whole);
    Ok(AxisValues::Rows(
        values.into_iter().map(|value| vec![Choice { value: valued(value, whole), name: None }]).collect(),
    ))
}

/// The value at that share of the way.
pub fn between(from: f64, to: f64, log: bool, share: f64) -> f64 {
    if log { from * real::powf(to / from, share) } else { from + (to - from) * share }
}

/// A number as a person would write it.
pub fn valued(value: f64, whole: bool) -> Value {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    if whole && rounded.fract() == 0.0 && rounded.abs() < 9.0e15 {
        Value::Integer(rounded as i64)
    } else {
        Value::Float(rounded)
    }
}
