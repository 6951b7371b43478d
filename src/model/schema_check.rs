//! Checks a value against a JSON Schema, for the tests of [`super::schema`]: the part of draft-07 that the schemas use.

use serde_json::Value;

/// Why the value does not fit; a keyword that is not known here is a bug of the test.
pub(super) fn check(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    if let Some(truth) = schema.as_bool() {
        return if truth { Ok(()) } else { Err(format!("{value} is one too many")) };
    }
    let schema = resolved(root, schema);
    let number = |key: &str| schema[key].as_f64().unwrap_or_default();
    let passing =
        |key: &str| schema[key].as_array().into_iter().flatten().filter(|one| check(root, one, value).is_ok()).count();
    let length = || value.as_str().map(|text| text.chars().count() as f64);
    for (keyword, rule) in schema.as_object().expect("a schema is a table") {
        let good = match keyword.as_str() {
            "$schema" | "title" | "description" | "default" | "definitions" => true,
            "type" => match rule.as_array() {
                Some(kinds) => kinds.iter().any(|kind| is_a(kind, value)),
                None => is_a(rule, value),
            },
            "enum" => rule.as_array().is_some_and(|words| words.contains(value)),
            "minimum" => value.as_f64().is_none_or(|value| value >= number("minimum")),
            "maximum" => value.as_f64().is_none_or(|value| value <= number("maximum")),
            "exclusiveMinimum" => value.as_f64().is_none_or(|value| value > number("exclusiveMinimum")),
            "exclusiveMaximum" => value.as_f64().is_none_or(|value| value < number("exclusiveMaximum")),
            "minLength" => length().is_none_or(|length| length >= number("minLength")),
            "maxLength" => length().is_none_or(|length| length <= number("maxLength")),
            "pattern" if rule == "\\S" => value.as_str().is_none_or(|text| !text.trim().is_empty()),
            "minItems" => value.as_array().is_none_or(|list| list.len() as f64 >= number("minItems")),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as f64 <= number("maxItems")),
            "minProperties" => value.as_object().is_none_or(|table| table.len() as f64 >= number("minProperties")),
            "required" => rule.as_array().into_iter().flatten().all(|key| match value.as_object() {
                Some(table) => table.contains_key(key.as_str().unwrap_or_default()),
                None => true,
            }),
            "anyOf" => passing("anyOf") >= 1,
            "oneOf" => passing("oneOf") == 1,
            "allOf" => passing("allOf") == rule.as_array().map_or(0, Vec::len),
            "not" => check(root, rule, value).is_err(),
            "items" => {
                for (index, entry) in value.as_array().into_iter().flatten().enumerate() {
                    check(root, rule.get(index).unwrap_or(rule), entry).map_err(|why| format!("{index}: {why}"))?;
                }
                true
            }
            "properties" | "additionalProperties" => {
                for (key, entry) in value.as_object().into_iter().flatten() {
                    let known = schema["properties"].get(key);
                    let rule = known.or(schema.get("additionalProperties")).unwrap_or(&Value::Bool(true));
                    check(root, rule, entry).map_err(|why| format!("{key}: {why}"))?;
                }
                true
            }
            _ => panic!("the keyword `{keyword}` is not known to this test"),
        };
        if !good {
            return Err(format!("{value} does not meet {keyword} = {rule}"));
        }
    }
    Ok(())
}

/// Where a reference leads.
pub(super) fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    match schema["$ref"].as_str() {
        Some(name) => root.pointer(name.trim_start_matches('#')).unwrap_or_else(|| panic!("{name} leads nowhere")),
        None => schema,
    }
}

/// Whether a value is of that type.
fn is_a(kind: &Value, value: &Value) -> bool {
    match kind.as_str().expect("a type is a word") {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        other => panic!("the type `{other}` is not known to this test"),
    }
}
