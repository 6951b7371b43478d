//! The report of a clip as JSON: rounded for files, and as the sidecar `OUT.events.json` for tools that cannot read extras.
//!
//! Times are given to 0.1 ms, lengths to 0.1 mm, forces and torques to 0.01, everything else to four decimals.

use super::ExportError;
use crate::model::ClipReport;
use serde_json::{Map, Value};

/// The bytes of `OUT.events.json`: an object with one report a clip name, in the order given.
pub fn events_json<'a>(reports: impl IntoIterator<Item = (&'a str, &'a ClipReport)>) -> Result<Vec<u8>, ExportError> {
    let mut object = Map::new();
    for (name, report) in reports {
        object.insert(name.to_owned(), report_json(name, report)?);
    }
    let mut bytes = serde_json::to_vec_pretty(&Value::Object(object))
        .map_err(|error| ExportError::Json { reason: error.to_string() })?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// The object of one clip, rounded: what `animations[i].extras.surefoot` holds.
pub fn report_json(name: &str, report: &ClipReport) -> Result<Value, ExportError> {
    let mut value = serde_json::to_value(report).map_err(|error| ExportError::Json { reason: error.to_string() })?;
    round(&mut value, "");
    match not_a_number(&value, "") {
        Some(place) => {
            Err(ExportError::NotFinite { clip: name.to_owned(), node: format!("report: {place}"), time: 0.0 })
        }
        None => Ok(value),
    }
}

fn round(value: &mut Value, key: &str) {
    match value {
        Value::Number(number) if number.is_f64() => {
            let digits = if matches!(key, "force" | "peak_nm" | "rms_nm" | "peak_n" | "rms_n") { 1e2 } else { 1e4 };
            let rounded = number.as_f64().map(|number| (number * digits).round() / digits + 0.0);
            if let Some(rounded) = rounded.and_then(serde_json::Number::from_f64) {
                *number = rounded;
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| round(item, key)),
        Value::Object(fields) => fields.iter_mut().for_each(|(name, field)| round(field, name)),
        _ => {}
    }
}

/// serde_json writes NaN and infinities as null; nothing else in a report is.
fn not_a_number(value: &Value, place: &str) -> Option<String> {
    match value {
        Value::Null => Some(place.to_owned()),
        Value::Array(items) => {
            items.iter().enumerate().find_map(|(index, item)| not_a_number(item, &format!("{place}[{index}]")))
        }
        Value::Object(fields) => {
            fields.iter().find_map(|(name, field)| not_a_number(field, &format!("{place}.{name}")))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::report;
    use super::*;

    #[test]
    fn times_are_given_to_a_tenth_of_a_millisecond() {
        let mut report = report("shove");
        report.duration = 1.234_567_89;
        report.events[0].time = -0.000_001;
        let json = report_json("shove", &report).expect("finite");
        assert_eq!(json["duration"].to_string(), "1.2346");
        assert_eq!(json["events"][0]["time"].to_string(), "0.0");
    }

    #[test]
    fn a_report_that_is_not_a_number_is_refused_by_its_place() {
        let mut report = report("shove");
        report.contacts[0].position[1] = f64::NAN;
        let error = report_json("shove", &report).expect_err("NaN");
        assert!(error.to_string().contains("contacts[0].position[1]"), "{error}");
    }

    #[test]
    fn the_sidecar_holds_every_clip_by_name() {
        let (one, two) = (report("one"), report("two"));
        let bytes = events_json([("one", &one), ("two", &two)]).expect("finite");
        let json: Value = serde_json::from_slice(&bytes).expect("JSON");
        assert_eq!(json.as_object().expect("object").keys().collect::<Vec<_>>(), ["one", "two"]);
        assert_eq!(json["two"]["scenario"], "two");
    }
}
