//! Paths into a scenario's text (`push.0.force`): reading and setting what stands there, and tests of it. Plain TOML values.

use crate::model::sweep::Test;
use toml::{Table, Value};

/// Whether one path is the other or lies in it.
pub fn within(inner: &str, outer: &str) -> bool {
    inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// The value at a path.
pub fn get<'t>(table: &'t Table, path: &str) -> Option<&'t Value> {
    let mut keys = path.split('.');
    let mut value = table.get(keys.next()?)?;
    for key in keys {
        value = match value {
            Value::Table(table) => table.get(key)?,
            Value::Array(list) => list.get(key.parse::<usize>().ok()?)?,
            _ => return None,
        };
    }
    Some(value)
}

/// Sets the value at a path; tables on the way are made, entries of lanes are not.
pub fn set(table: &mut Table, path: &str, value: Value) -> Result<(), String> {
    let keys: Vec<&str> = path.split('.').collect();
    if keys.iter().any(|key| key.is_empty()) {
        return Err(format!("`{path}` is no path"));
    }
    let mut so_far = keys[0].to_owned();
    let mut at = if keys.len() == 1 {
        table.insert(keys[0].to_owned(), value);
        return Ok(());
    } else if keys[1].parse::<usize>().is_ok() {
        table.get_mut(keys[0]).ok_or_else(|| format!("there is no `{so_far}` in it"))?
    } else {
        table.entry(keys[0]).or_insert_with(|| Value::Table(Table::new()))
    };
    for (index, key) in keys.iter().enumerate().skip(1) {
        let last = index + 1 == keys.len();
        at = match at {
            Value::Array(list) => {
                let count = list.len();
                let entry = key.parse::<usize>().ok().and_then(|index| list.get_mut(index));
                entry.ok_or_else(|| format!("`{so_far}` has {count} entries, counted from 0: there is no `{key}`"))?
            }
            Value::Table(table) => table.entry(*key).or_insert_with(|| match last {
                true => Value::Integer(0),
                false => Value::Table(Table::new()),
            }),
            _ => return Err(format!("`{so_far}` is one value: there is no `{key}` in it")),
        };
        so_far = format!("{so_far}.{key}");
    }
    *at = value;
    Ok(())
}

/// What a value lies in: `push.0` of `push.0.force`. `None` for a value of the whole.
pub fn parent(path: &str) -> Option<&str> {
    path.rsplit_once('.').map(|(parent, _)| parent)
}

/// Whether a value passes a test; `name` is what the sweep calls it.
pub fn passes(test: &Test, value: &Value, name: Option<&str>) -> bool {
    let number = |value: &Value| match value {
        Value::Integer(number) => Some(*number as f64),
        Value::Float(number) => Some(*number),
        _ => None,
    };
    match test {
        Test::OneOf(values) => values.iter().any(|wanted| {
            wanted == value
                || number(wanted).is_some_and(|wanted| number(value) == Some(wanted))
                || wanted.as_str().is_some_and(|wanted| name == Some(wanted))
        }),
        Test::Within { above, below } => number(value)
            .is_some_and(|value| above.is_none_or(|above| value > above) && below.is_none_or(|below| value < below)),
    }
}
