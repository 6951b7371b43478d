//! The JSON Schemas (draft-07) of a scenario's and a sweep's text, with which editors complete and check the TOML. They are kept by
//! hand; the tests here hold them to the readers: the same keys, ranges, words and defaults.

/// Of a scenario.
pub const SCENARIO: &str = include_str!("scenario_schema.json");
/// Of a sweep.
pub const SWEEP: &str = include_str!("sweep_schema.json");

#[cfg(test)]
mod tests {
    use super::super::scenario_reader::asked;
    use super::super::schema_check::{check, resolved};
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

    /// The schema of a number or a word, and the value around it.
    type Leaf = (Value, Box<dyn Fn(Value) -> Value>);

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
                (_, Some("array")) => {
                    let count = schema["minItems"].as_u64().unwrap_or(1) as usize;
                    Value::Array(vec![self.sample(&schema["items"]); count])
                }
                _ => schema["enum"][0].clone(),
            }
        }

        /// The schemas of the numbers and words in a value.
        fn leaves(&self, schema: &Value) -> Vec<Leaf> {
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
            Some(bound) if bound.abs() > 1 << 52 => json!(bound + 2 * by), // the next double
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

    fn json_of(text: &str) -> Value {
        serde_json::to_value(toml::from_str::<toml::Table>(text).expect("TOML")).expect("can be said in JSON")
    }

    /// Calls that with every table of a document and each of its keys.
    fn each_key(kind: &Kind, mut what: impl FnMut(&Table, &str, &Value)) {
        for table in kind.tables() {
            for (key, schema) in table.schema["properties"].as_object().expect("keys") {
                what(&table, key, schema);
            }
        }
    }

    /// Tables whose keys are not those that the reader asks for.
    fn other_keys(kind: &Kind) -> Vec<String> {
        let mut wrong = Vec::new();
        for table in kind.tables() {
            drop(asked::take());
            drop(kind.read(&kind.document(&table, "", None)));
            let asked = asked::take().remove(table.path).unwrap_or_default();
            let keys = table.schema["properties"].as_object().expect("keys").keys().cloned().collect();
            if asked != keys || table.schema["additionalProperties"] != false {
                wrong.push(format!("`{}`: read {asked:?}, in the schema {keys:?}", table.path));
            }
        }
        wrong
    }

    /// Values at the ends of what the schema takes, or just outside, on which schema and reader do not agree.
    fn other_ends(kind: &Kind) -> (usize, Vec<String>) {
        let (mut seen, mut wrong) = (0, Vec::new());
        each_key(kind, |table, key, schema| {
            for (leaf, around) in kind.leaves(schema) {
                for (value, good) in ends(&leaf) {
                    let document = kind.document(table, key, Some(around(value)));
                    assert_eq!(kind.check(&document).is_ok(), good, "{document}");
                    if kind.read(&document).is_ok() != good {
                        wrong.push(document.to_string());
                    }
                    seen += 1;
                }
            }
        });
        (seen, wrong)
    }

    /// Keys whose words are not those that the reader knows.
    fn other_words(kind: &Kind) -> Vec<String> {
        let mut wrong = Vec::new();
        each_key(kind, |table, key, schema| {
            let words = kind.leaves(schema).into_iter().find_map(|(leaf, _)| leaf["enum"].as_array().cloned());
            let Some(words) = words.filter(|_| key != "kind") else { return }; // a kind is one word a branch: `other_ends` holds it
            drop(asked::take());
            drop(kind.read(&kind.document(table, key, Some(words[0].clone()))));
            let path = if table.path.is_empty() { key.to_owned() } else { format!("{}.{key}", table.path) };
            let read = asked::take().remove(&path).unwrap_or_default();
            if read != words.iter().filter_map(|word| word.as_str().map(str::to_owned)).collect() {
                wrong.push(format!("{path}: read {read:?}, in the schema {words:?}"));
            }
        });
        wrong
    }

    /// Defaults that do not mean what leaving the key out means.
    fn other_defaults(kind: &Kind) -> Vec<String> {
        let mut wrong = Vec::new();
        each_key(kind, |table, key, schema| {
            let Some(default) = schema.get("default") else { return };
            let mut without = Table { path: table.path, schema: Value::Null, least: table.least.clone() };
            without.least.remove(key);
            let [without, with] =
                [None, Some(default.clone())].map(|value| kind.read(&kind.document(&without, key, value)));
            if without != with || with.is_err() {
                wrong.push(format!("{}.{key}: {with:?}, without {without:?}", table.path));
            }
        });
        wrong
    }

    #[test]
    fn a_schema_has_the_readers_keys_ends_words_and_defaults() {
        let mut tried = 0;
        for kind in kinds() {
            let (seen, ends) = other_ends(&kind);
            tried += seen;
            let wrong = [other_keys(&kind), ends, other_words(&kind), other_defaults(&kind)].concat();
            assert!(wrong.is_empty(), "{}: {wrong:#?}", kind.schema["title"]);
        }
        assert!(tried > 400, "only {tried} values were tried");
    }

    #[test]
    fn a_schema_that_differs_from_the_reader_is_caught() {
        let planted = |change: fn(&mut Value)| {
            let [mut kind, _] = kinds();
            change(&mut kind.schema["properties"]);
            kind
        };
        let more = planted(|keys| keys["character"]["properties"]["weight"] = json!({ "type": "number" }));
        assert_eq!(other_keys(&more).len(), 1);
        let fewer = planted(|keys| {
            drop(keys["ground"]["oneOf"][2]["properties"].as_object_mut().map(|keys| keys.remove("count")))
        });
        assert_eq!(other_keys(&fewer).len(), 1);
        let wider = planted(|keys| keys["push"]["items"]["properties"]["force"]["maximum"] = json!(30_000));
        assert_eq!(other_ends(&wider).1.len(), 1);
        let narrower =
            planted(|keys| keys["carry"]["items"]["properties"]["size"]["anyOf"][0]["items"]["minimum"] = json!(0.5));
        assert_eq!(other_ends(&narrower).1.len(), 1);
        let word = planted(|keys| keys["stand"]["items"]["properties"]["on"]["enum"] = json!(["both", "left"]));
        assert_eq!(other_words(&word).len(), 1);
        let default = planted(|keys| keys["throw"]["items"]["properties"]["speed"]["default"] = json!(8.0));
        assert_eq!(other_defaults(&default).len(), 1);
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
            each_key(&kind, |table, key, _| {
                for value in &values {
                    let document = kind.document(table, key, Some(value.clone()));
                    let (read, checked) = (kind.read(&document), kind.check(&document));
                    assert!(read.is_err() || checked.is_ok(), "{document}: {checked:?}");
                }
            });
        }
    }

    #[test]
    fn every_key_is_described() {
        for kind in kinds() {
            each_key(&kind, |table, key, schema| {
                let said = schema["description"].as_str().unwrap_or_default();
                assert!(said.len() > 8 && said.ends_with('.'), "{}.{key}: {said}", table.path);
            });
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
