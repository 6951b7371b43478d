//! The JSON Schemas (draft-07) of a scenario's and a sweep's text, with which editors complete and check the TOML. They are kept by
//! hand; the tests here hold them to the readers: the same keys, ranges, words and defaults.

/// Of a scenario.
pub const SCENARIO: &str = include_str!("scenario_schema.json");
/// Of a sweep.
pub const SWEEP: &str = include_str!("sweep_schema.json");

#[cfg(test)]
mod tests {
    use super::super::scenario_reader::asked;
    use super::super::{scenario_text, sweep_text};
    use super::*;
    use serde_json::{Map, Value, json};

    /// A schema, and the reader that it describes.
    struct Kind {
        schema: Value,
        /// What must be said beside anything else.
        least: Value,
        /// The text's meaning, as something to compare; `Err`: the faults.
        read: fn(&str) -> Result<String, String>,
    }

    fn kinds() -> [Kind; 2] {
        let parsed = |text: &str| serde_json::from_str(text).expect("a schema is JSON");
        let scenario = |text: &str| match scenario_text::parse("x.toml", text) {
            Ok(scenario) => Ok(format!("{scenario:?}")),
            Err(errors) => Err(errors.to_string()),
        };
        let sweep = |text: &str| match sweep_text::read("x.toml", text) {
            Ok((sweep, _)) => Ok(format!("{sweep:?}")),
            Err(errors) => Err(errors.to_string()),
        };
        [
            Kind { schema: parsed(SCENARIO), least: json!({ "duration": 600 }), read: scenario },
            Kind { schema: parsed(SWEEP), least: json!({ "scenario": "s.toml" }), read: sweep },
        ]
    }

    /// A table of the document: where it stands, its schema, and the least that it must hold.
    struct Table {
        path: &'static str,
        schema: Value,
        least: Map<String, Value>,
    }

    impl Kind {
        /// Every table whose keys the reader asks for by name.
        fn tables(&self) -> Vec<Table> {
            let mut tables = vec![self.table("", &self.schema)];
            for (name, schema) in self.schema["properties"].as_object().expect("keys") {
                let name: &'static str = name.clone().leak();
                if schema["items"]["properties"].is_object() {
                    tables.push(self.table(format!("{name}.0").leak(), &schema["items"]));
                } else if schema["properties"].is_object() {
                    tables.push(self.table(name, schema));
                }
                let branches = schema["oneOf"].as_array().into_iter().flatten();
                tables.extend(branches.map(|branch| self.table(name, branch)));
            }
            tables
        }

        fn table(&self, path: &'static str, schema: &Value) -> Table {
            let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
            let sample = |key: &str| match key {
                "spacing" => json!(100), // more than the gaps' width
                _ => self.sample(&schema["properties"][key]),
            };
            let mut least: Map<String, Value> = required.map(|key| (key.to_owned(), sample(key))).collect();
            if path.is_empty() {
                least = self.least.as_object().expect("a table").clone();
            }
            Table { path, schema: schema.clone(), least }
        }

        /// The document with that in the table.
        fn document(&self, table: &Table, key: &str, value: Option<Value>) -> Value {
            let mut inner = table.least.clone();
            inner.extend(value.map(|value| (key.to_owned(), value)));
            if table.path.is_empty() {
                return Value::Object(inner);
            }
            let mut document = self.least.clone();
            match table.path.strip_suffix(".0") {
                Some(lane) => document[lane] = json!([inner]),
                None => document[table.path] = Value::Object(inner),
            }
            document
        }

        fn read(&self, document: &Value) -> Result<String, String> {
            (self.read)(&toml::to_string(document).expect("can be said in TOML"))
        }

        fn check(&self, document: &Value) -> Result<(), String> {
            check(&self.schema, &self.schema, document)
        }

        fn resolved<'a>(&'a self, schema: &'a Value) -> &'a Value {
            resolved(&self.schema, schema)
        }

        /// Some value that a schema takes.
        fn sample(&self, schema: &Value) -> Value {
            let schema = self.resolved(schema);
            let first = ["anyOf", "allOf"].iter().find_map(|key| schema[*key].get(0));
            match (first, schema["type"].as_str()) {
                (Some(first), _) => self.sample(first),
                (_, Some("number" | "integer")) => match schema["exclusiveMinimum"].as_f64() {
                    Some(low) => json!(low + 0.001),
                    None => schema.get("minimum").cloned().unwrap_or(json!(0)),
                },
                (_, Some("string")) => json!("x"),
                _ => schema["enum"][0].clone(),
            }
        }

        /// The schemas of the numbers and words in a value, each with the value around it.
        fn leaves(&self, schema: &Value) -> Vec<(Value, Box<dyn Fn(Value) -> Value>)> {
            let schema = self.resolved(schema);
            let choices = ["anyOf", "allOf"].iter().flat_map(|key| schema[*key].as_array().into_iter().flatten());
            let mut leaves: Vec<_> = choices.flat_map(|choice| self.leaves(choice)).collect();
            let items = &schema["items"];
            if let Some(pair) = items.as_array() {
                for (index, item) in pair.iter().enumerate() {
                    let others: Vec<Value> = pair.iter().map(|item| self.sample(item)).collect();
                    for (leaf, around) in self.leaves(item) {
                        let others = others.clone();
                        let inside = move |value: Value| {
                            let mut all = others.clone();
                            all[index] = around(value);
                            Value::Array(all)
                        };
                        leaves.push((leaf, Box::new(inside)));
                    }
                }
            } else if items.is_object() && !items["properties"].is_object() {
                let count = schema["minItems"].as_u64().unwrap_or(1) as usize;
                for (leaf, around) in self.leaves(items) {
                    leaves.push((leaf, Box::new(move |value| Value::Array(vec![around(value); count]))));
                }
            } else if schema["enum"].is_array()
                || ["number", "integer", "string"].iter().any(|kind| schema["type"] == *kind)
            {
                leaves.push((schema.clone(), Box::new(|value| value)));
            }
            leaves
        }
    }

    /// Values at the ends of what a schema takes, and just outside; true for those that it takes.
    fn ends(schema: &Value) -> Vec<(Value, bool)> {
        let whole = schema["type"] == "integer";
        let beside = |bound: &Value, by: i64| match bound.as_i64().filter(|_| whole) {
            Some(bound) => json!(bound + by),
            None => json!(bound.as_f64().expect("a number") + 0.01 * by as f64),
        };
        let mut ends = Vec::new();
        for (key, outwards, inclusive) in [
            ("minimum", -1, true),
            ("maximum", 1, true),
            ("exclusiveMinimum", -1, false),
            ("exclusiveMaximum", 1, false),
        ] {
            let Some(bound) = schema.get(key) else { continue };
            ends.push((bound.clone(), inclusive));
            ends.push(if inclusive { (beside(bound, outwards), false) } else { (beside(bound, -outwards), true) });
        }
        ends.extend(schema["enum"].as_array().into_iter().flatten().map(|word| (word.clone(), true)));
        if schema["enum"].is_array() {
            ends.push((json!("nonsense"), false));
        }
        let letters = |count: &Value, more: u64| json!("x".repeat((count.as_u64().unwrap_or(0) + more) as usize));
        if let Some(most) = schema.get("maxLength") {
            ends.extend([
                (letters(most, 0), true),
                (letters(most, 1), false),
                (json!(""), false),
                (json!("  "), false),
            ]);
        }
        ends
    }

    /// The part of draft-07 that the schemas use; another keyword is a bug of the test.
    fn check(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
        if let Some(truth) = schema.as_bool() {
            return if truth { Ok(()) } else { Err(format!("{value} is one too many")) };
        }
        let schema = resolved(root, schema);
        let number = |key: &str| schema[key].as_f64().unwrap_or_default();
        let passing = |key: &str| {
            schema[key].as_array().into_iter().flatten().filter(|one| check(root, one, value).is_ok()).count()
        };
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

    fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
        match schema["$ref"].as_str() {
            Some(name) => root.pointer(name.trim_start_matches('#')).unwrap_or_else(|| panic!("{name} leads nowhere")),
            None => schema,
        }
    }

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

    fn json_of(text: &str) -> Value {
        serde_json::to_value(toml::from_str::<toml::Table>(text).expect("TOML")).expect("can be said in JSON")
    }

    #[test]
    fn a_schema_has_the_keys_that_the_reader_asks_for_and_no_others() {
        for kind in kinds() {
            for table in kind.tables() {
                drop(asked::take());
                drop(kind.read(&kind.document(&table, "", None)));
                let asked = asked::take().remove(table.path).unwrap_or_default();
                let keys = table.schema["properties"].as_object().expect("keys").keys().cloned().collect();
                assert_eq!(
                    asked, keys,
                    "`{}` of {}: what is read, what the schema has",
                    table.path, kind.schema["title"]
                );
                assert_eq!(table.schema["additionalProperties"], false, "{}", table.path);
            }
        }
    }

    #[test]
    fn what_a_schema_takes_up_to_its_ends_is_read_and_what_is_outside_is_refused() {
        let mut seen = 0;
        for kind in kinds() {
            for table in kind.tables() {
                for (key, schema) in table.schema["properties"].as_object().expect("keys") {
                    for (leaf, around) in kind.leaves(schema) {
                        for (value, good) in ends(&leaf) {
                            let document = kind.document(&table, key, Some(around(value)));
                            let (read, checked) = (kind.read(&document), kind.check(&document));
                            assert_eq!(checked.is_ok(), good, "{document}: {checked:?}");
                            assert_eq!(read.is_ok(), good, "{document}: {read:?}");
                            seen += 1;
                        }
                    }
                }
            }
        }
        assert!(seen > 400, "only {seen} values were tried");
    }

    #[test]
    fn words_are_those_of_the_reader() {
        for kind in kinds() {
            for table in kind.tables() {
                for (key, schema) in table.schema["properties"].as_object().expect("keys") {
                    let words = |schema: &Value| -> Option<Vec<String>> {
                        let words = schema["enum"].as_array()?;
                        Some(words.iter().filter_map(|word| word.as_str().map(str::to_owned)).collect())
                    };
                    let Some((word, mut words)) = kind
                        .leaves(schema)
                        .into_iter()
                        .find_map(|(leaf, _)| Some((leaf["enum"][0].clone(), words(&leaf)?)))
                    else {
                        continue;
                    };
                    if key == "kind" {
                        continue; // one word a branch: the ends of the branches hold them
                    }
                    drop(asked::take());
                    drop(kind.read(&kind.document(&table, key, Some(word))));
                    let path = if table.path.is_empty() { key.clone() } else { format!("{}.{key}", table.path) };
                    words.sort();
                    let read = asked::take().remove(&path).unwrap_or_default().into_iter().collect::<Vec<_>>();
                    assert_eq!(words, read, "{path}");
                }
            }
        }
    }

    #[test]
    fn a_value_of_another_type_that_the_reader_takes_is_taken_by_the_schema() {
        let values = [
            json!(true),
            json!("zz"),
            json!("left"),
            json!(0.5),
            json!(3),
            json!([]),
            json!([0.1, 0.2]),
            json!([[0, 1]]),
            json!({}),
        ];
        for kind in kinds() {
            for table in kind.tables() {
                for key in table.schema["properties"].as_object().expect("keys").keys() {
                    for value in &values {
                        let document = kind.document(&table, key, Some(value.clone()));
                        let (read, checked) = (kind.read(&document), kind.check(&document));
                        assert!(read.is_err() || checked.is_ok(), "{document}: {checked:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_default_means_what_leaving_the_key_out_means() {
        for kind in kinds() {
            for table in kind.tables() {
                for (key, schema) in table.schema["properties"].as_object().expect("keys") {
                    let Some(default) = schema.get("default") else { continue };
                    if table.least.contains_key(key) {
                        continue;
                    }
                    let without = kind.read(&kind.document(&table, key, None));
                    let with = kind.read(&kind.document(&table, key, Some(default.clone())));
                    assert!(without.is_ok(), "{}: {without:?}", table.path);
                    assert_eq!(without, with, "{}.{key}", table.path);
                }
            }
        }
        let standing = scenario_text::parse("x.toml", "").expect("nothing is required");
        assert_eq!(kinds()[0].schema["properties"]["duration"]["default"], standing.duration);
    }

    #[test]
    fn every_key_is_described() {
        for kind in kinds() {
            for table in kind.tables() {
                for (key, schema) in table.schema["properties"].as_object().expect("keys") {
                    let said = schema["description"].as_str().unwrap_or_default();
                    assert!(said.len() > 8 && said.ends_with('.'), "{}.{key}: {said}", table.path);
                }
            }
        }
    }

    #[test]
    fn the_examples_and_every_scenario_of_the_gallery_fit_their_schema() {
        let [scenario, sweep] = kinds();
        let uncomment = |line: &str| match line.strip_prefix("# ") {
            Some(rest) if rest.starts_with('[') || rest.split(' ').nth(1) == Some("=") => rest.to_owned(),
            _ => line.to_owned(),
        };
        let whole: Vec<String> = scenario_text::example_text().lines().map(uncomment).collect();
        let mut texts = vec![scenario_text::example_text().to_owned(), whole.join("\n")];
        let gallery = concat!(env!("CARGO_MANIFEST_DIR"), "/exports/gallery");
        for entry in std::fs::read_dir(gallery).expect("the gallery").flatten() {
            texts.extend(std::fs::read_to_string(entry.path().join("scenario.toml")));
        }
        assert!(texts.len() > 8, "the gallery was not found");
        for text in texts {
            scenario.check(&json_of(&text)).unwrap_or_else(|why| panic!("{why} in\n{text}"));
        }
        sweep.check(&json_of(sweep_text::example_text())).unwrap_or_else(|why| panic!("{why}"));
        for (text, name) in [(scenario_text::example_text(), "scenario"), (sweep_text::example_text(), "sweep")] {
            let file = format!("{name}.schema.json");
            assert!(text.starts_with(&format!("#:schema ./{file}\n")), "{name}");
            assert!(text.contains(&format!("surefoot new {name} --schema -o {file}")), "{name}");
        }
    }

    #[test]
    fn the_free_parts_of_a_sweep_are_taken_and_refused_as_by_the_reader() {
        let [_, sweep] = kinds();
        let sample = "[sample]\ncount = 2\n";
        for (text, good) in [
            ("", false),
            ("scenarios = [\"a.toml\", { name = \"b\", file = \"c.toml\" }]", true),
            ("scenario = { file = \"c.toml\" }", false),
            ("scenario = { name = \"a\", file = \"c.toml\", x = 1 }", false),
            ("scenario = \"a.toml\"\nrigs = []", false),
            ("scenario = \"a.toml\"\nrig = 3", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = []", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = 4", false),
            ("scenario = \"a.toml\"\n[vary]\n\"push.0.at\" = [{ name = \"high\", value = \"head\" }, \"hips\"]", true),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, count = 2 }", true),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, step = 1, scale = \"linear\" }", true),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, count = 2, scale = \"log\" }", true),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, count = 2, scale = \"ln\" }", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, count = 2, step = 1 }", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, count = 0 }", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, count = 1.5 }", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, count = 2 }", false),
            ("scenario = \"a.toml\"\n[vary]\nseed = { from = 1, to = 4, cuont = 2 }", false),
            (&format!("scenario = \"a.toml\"\n{sample}[vary]\nseed = {{ from = 1, to = 4 }}"), true),
            ("scenario = \"a.toml\"\n[[linked]]\nseed = [1, 2]\nduration = [3, 4]", true),
            ("scenario = \"a.toml\"\n[[linked]]", false),
            ("scenario = \"a.toml\"\n[linked]\nseed = [1]", false),
            (
                "scenario = \"a.toml\"\n[[skip]]\nseed = [1, 2]\nrig = \"guard\"\nduration = { above = 2, below = 3 }",
                true,
            ),
            ("scenario = \"a.toml\"\n[[skip]]\nseed = { over = 2 }", false),
            ("scenario = \"a.toml\"\n[[skip]]\nseed = {}", false),
            ("scenario = \"a.toml\"\n[bake]\nengine = [\"three\", \"untiy\"]", false),
            ("scenario = \"a.toml\"\n[bake]\nengine = [\"three\", \"bevy\"]\nassist = [50, 100.5]", true),
            ("scenario = \"a.toml\"\n[bake]\nassist = [50, -1]", false),
        ] {
            let checked = sweep.check(&json_of(text));
            assert_eq!(checked.is_ok(), good, "the schema on\n{text}\n{checked:?}");
            assert_eq!((sweep.read)(text).is_ok(), good, "the reader on\n{text}");
        }
    }
}
