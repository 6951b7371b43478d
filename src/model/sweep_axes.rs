//! What varies in the text of a sweep: `[vary]`, `[[linked]]`, and `[[skip]]`, which leaves some of it out.

use super::sweep::{Axis, AxisPath, AxisValues, Choice, Condition, Skip, Test};
use super::sweep_text::Rules;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

/// Rows of one axis at most.
const LONGEST_AXIS: usize = 1_000_000;

/// Several paths whose values go together.
pub(super) fn linked(index: usize, table: &DeTable<'_>, rules: &mut Rules) -> Option<Axis> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let mut paths = Vec::new();
    let mut columns: Vec<Vec<Choice>> = Vec::new();
    for (key, value) in entries {
        let path = key.get_ref().to_string();
        let place = format!("linked.{index}.{path}");
        rules.places.push((place.clone(), value.span()));
        match values(value, &place, rules) {
            AxisValues::Rows(rows) => columns.push(rows.into_iter().flatten().collect()),
            AxisValues::Between { .. } => {
                rules.fault(&place, "linked values are counted", "give count or step, or a list");
                return None;
            }
        }
        paths.push(AxisPath { path, place });
    }
    let length = columns[0].len();
    if let Some((column, path)) = columns.iter().zip(&paths).find(|(column, _)| column.len() != length) {
        let message = format!("has {} values, `{}` beside it {length}", column.len(), paths[0].path);
        rules.fault(&path.place, message, "linked values go row by row: give each as many");
        return None;
    }
    let row = |row: usize| columns.iter().map(|column| column[row].clone()).collect();
    Some(Axis { paths, values: AxisValues::Rows((0..length).map(row).collect()) })
}

/// A list, or a range.
pub(super) fn values(value: &Spanned<DeValue<'_>>, place: &str, rules: &mut Rules) -> AxisValues {
    const FORMS: &str = "give a list, { from, to, count }, { from, to, step }, or, with [sample], { from, to }; scale = \"log\" for logarithmic steps";
    let nothing = AxisValues::Rows(vec![vec![Choice { value: Value::Integer(0), name: None }]]);
    match value.get_ref() {
        DeValue::Array(list) if list.iter().next().is_none() => {
            rules.fault(place, "an empty list", FORMS);
            nothing
        }
        DeValue::Array(list) => {
            let mut rows = Vec::with_capacity(list.len());
            for (index, entry) in list.iter().enumerate() {
                rules.places.push((format!("{place}.{index}"), entry.span()));
                rows.push(vec![choice(entry.get_ref())]);
            }
            AxisValues::Rows(rows)
        }
        DeValue::Table(table) => match super::sweep_range::range(table) {
            Ok(AxisValues::Rows(rows)) if rows.len() > LONGEST_AXIS => {
                rules.fault(place, format!("{} steps are too many", rows.len()), "give fewer");
                nothing
            }
            Ok(values) => values,
            Err((message, remedy)) => {
                rules.fault(place, message, remedy.unwrap_or(FORMS));
                nothing
            }
        },
        _ => {
            rules.fault(place, "one value does not vary", FORMS);
            nothing
        }
    }
}

/// A value, or `{ name, value }`.
fn choice(value: &DeValue<'_>) -> Choice {
    if let DeValue::Table(table) = value
        && table.len() == 2
        && let (Some(name), Some(value)) = (table.get("name"), table.get("value"))
        && let DeValue::String(name) = name.get_ref()
    {
        return Choice { value: owned(value.get_ref()), name: Some(name.to_string()) };
    }
    Choice { value: owned(value), name: None }
}

/// A value without its places. Numbers that do not fit become text, which no scenario takes for a number.
pub(super) fn owned(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) => Value::Integer(number),
            Err(_) => Value::String(number.as_str().to_owned()),
        },
        DeValue::Float(number) => match number.as_str().parse() {
            Ok(number) => Value::Float(number),
            Err(_) => Value::String(number.as_str().to_owned()),
        },
        DeValue::Boolean(truth) => Value::Boolean(*truth),
        DeValue::Datetime(time) => Value::Datetime(*time),
        DeValue::Array(list) => Value::Array(list.iter().map(|entry| owned(entry.get_ref())).collect()),
        DeValue::Table(table) => {
            Value::Table(table.iter().map(|(key, entry)| (key.get_ref().to_string(), owned(entry.get_ref()))).collect())
        }
    }
}

pub(super) fn skip(index: usize, table: &DeTable<'_>, rules: &mut Rules) -> Skip {
    let place = format!("skip.{index}");
    let mut conditions = Vec::new();
    for (key, value) in table.iter() {
        let path = key.get_ref().to_string();
        let place = format!("{place}.{path}");
        rules.places.push((place.clone(), value.span()));
        let number = |value: &Spanned<DeValue<'_>>| match owned(value.get_ref()) {
            Value::Integer(number) => Some(number as f64),
            Value::Float(number) => Some(number),
            _ => None,
        };
        let test = match value.get_ref() {
            DeValue::Array(list) => Test::OneOf(list.iter().map(|entry| owned(entry.get_ref())).collect()),
            DeValue::Table(table) => {
                let known = table.iter().all(|(key, _)| ["above", "below"].contains(&key.get_ref().as_ref()));
                let (above, below) = (table.get("above").and_then(number), table.get("below").and_then(number));
                if !known || above.is_none() && below.is_none() {
                    rules.fault(
                        &place,
                        "not a test",
                        "give a value, a list of values, { above = 300 } or { below = 100 }",
                    );
                }
                Test::Within { above, below }
            }
            one => Test::OneOf(vec![owned(one)]),
        };
        conditions.push(Condition { path, place, test });
    }
    Skip { conditions, place }
}
