//! The text form of a sweep: TOML, read with the place of every value kept, so that each fault names its line. No I/O.
//!
//! What is wrong by itself is told here; what is wrong with a scenario or a rig that it names, by `batch::plan`.

use super::scenario_errors::{Fault, ScenarioErrors, ScenarioSource};
use super::scenario_reader::Reader;
use super::scenario_text::{syntax_fault, title_from};
use super::sweep::{Axis, AxisPath, AxisValues, Combine, Input, Sweep};
use super::sweep_axes::{linked, skip, values};
use super::sweep_bake::bake_settings;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Reads a sweep. `name` is the file's, for messages.
pub fn read(name: &str, text: &str) -> Result<(Sweep, ScenarioSource), ScenarioErrors> {
    let (document, broken) = DeTable::parse_recoverable(text);
    let mut source = ScenarioSource::new(name, text);
    if !broken.is_empty() {
        let remedy = "`surefoot new sweep` writes an example of every key";
        let faults = broken.iter().map(|error| syntax_fault(text, error, remedy)).collect();
        return Err(source.collect(faults));
    }
    let mut faults = Vec::new();
    let mut rules = Rules::default();
    let reader = Reader::new("the sweep", document.get_ref(), source.places_mut(), &mut faults);
    let sweep = sweep(reader, &mut rules);
    for (path, span) in rules.places {
        source.places_mut().set(path, span);
    }
    faults.extend(rules.faults.iter().map(|fault| source.locate(fault)));
    if faults.is_empty() { Ok((sweep, source)) } else { Err(source.collect(faults)) }
}

/// A commented sweep with every key.
pub fn example_text() -> &'static str {
    include_str!("sweep_example.toml")
}

/// Faults of what the reader does not know by name, and the places of it.
#[derive(Default)]
pub(super) struct Rules {
    faults: Vec<Fault>,
    pub(super) places: Vec<(String, Range<usize>)>,
}

impl Rules {
    pub(super) fn fault(&mut self, path: &str, message: impl Into<String>, remedy: &str) {
        self.faults.push(Fault { path: path.into(), message: message.into(), remedy: remedy.into() });
    }
}

fn sweep(mut root: Reader<'_, '_>, rules: &mut Rules) -> Sweep {
    let mut scenarios = inputs(&mut root, "scenario", rules, &title_from);
    scenarios.extend(inputs(&mut root, "scenarios", rules, &title_from));
    if scenarios.is_empty() && root.peek("scenario").is_none() && root.peek("scenarios").is_none() {
        root.missing("scenario", "name the scenario that varies: scenario = \"shove.toml\"");
    }
    let mut rigs = inputs(&mut root, "rig", rules, &stem);
    rigs.extend(inputs(&mut root, "rigs", rules, &stem));
    if rigs.is_empty() && root.peek("rig").is_none() && root.peek("rigs").is_none() {
        rigs.push(Input { name: "builtin".into(), file: "builtin".into(), path: "rigs".into() });
    }
    let name = root.string("name");
    let mut axes: Vec<(usize, Axis)> = Vec::new();
    if let Some(table) = table_of(&mut root, "vary", rules) {
        for (key, value) in table.iter() {
            let path = key.get_ref().to_string();
            let place = format!("vary.{path}");
            rules.places.push((place.clone(), value.span()));
            let values = values(value, &place, rules);
            axes.push((key.span().start, Axis { paths: vec![AxisPath { path, place }], values }));
        }
    }
    for (index, (start, table)) in tables_of(&mut root, "linked", rules).into_iter().enumerate() {
        axes.extend(linked(index, table, rules).map(|axis| (start, axis)));
    }
    axes.sort_by_key(|(start, _)| *start);
    let axes: Vec<Axis> = axes.into_iter().map(|(_, axis)| axis).collect();
    let skips = tables_of(&mut root, "skip", rules);
    let skips = skips.into_iter().enumerate().map(|(index, (_, table))| skip(index, table, rules)).collect();
    let combine = combine(&mut root, &axes, rules);
    let bake = root.table("bake").map(bake_settings).unwrap_or_default();
    root.finish();
    let name = name.unwrap_or_else(|| default_name(&axes));
    Sweep { scenarios, rigs, name, axes, skips, combine, bake }
}

/// The title and every path that varies.
fn default_name(axes: &[Axis]) -> String {
    let paths = axes.iter().flat_map(|axis| &axis.paths).map(|path| format!("_{{{}}}", path.path));
    format!("{{title}}{}", paths.collect::<String>())
}

/// One file or several, each a name or `{ name, file }`.
fn inputs(
    root: &mut Reader<'_, '_>,
    key: &'static str,
    rules: &mut Rules,
    called: &dyn Fn(&str) -> String,
) -> Vec<Input> {
    const FORMS: &str = "give file names in quotes, or { name = \"guard\", file = \"rigs/b.glb\" }";
    let Some(value) = root.peek(key) else { return Vec::new() };
    let single;
    let entries: Vec<(String, &DeValue<'_>)> = match value {
        DeValue::Array(list) => {
            let paths = (0..list.len()).map(|index| format!("{key}.{index}"));
            let entries: Vec<_> = paths.zip(list.iter()).collect();
            rules.places.extend(entries.iter().map(|(path, entry)| (path.clone(), entry.span())));
            if entries.is_empty() {
                rules.fault(key, "this is empty", FORMS);
            }
            entries.into_iter().map(|(path, entry)| (path, entry.get_ref())).collect()
        }
        one => {
            single = one;
            vec![(key.to_owned(), single)]
        }
    };
    let mut found = Vec::new();
    for (path, entry) in entries {
        let text = |value: Option<&Spanned<DeValue<'_>>>| match value.map(Spanned::get_ref) {
            Some(DeValue::String(text)) => Some(text.to_string()),
            _ => None,
        };
        match entry {
            DeValue::String(file) => {
                found.push(Input { name: called(file), file: file.to_string(), path });
            }
            DeValue::Table(table)
                if table.iter().all(|(key, _)| ["name", "file"].contains(&key.get_ref().as_ref())) =>
            {
                match (text(table.get("name")), text(table.get("file"))) {
                    (Some(name), Some(file)) => found.push(Input { name, file, path }),
                    _ => rules.fault(&path, "not a file", FORMS),
                }
            }
            _ => rules.fault(&path, "not a file", FORMS),
        }
    }
    found
}

/// "dir/hero.glb" -> "hero".
fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
}

fn table_of<'r, 'i>(root: &mut Reader<'r, 'i>, key: &'static str, rules: &mut Rules) -> Option<&'r DeTable<'i>> {
    match root.peek(key)? {
        DeValue::Table(table) => Some(table),
        _ => {
            rules.fault(key, "this must be a table", &format!("write it under a header of its own: `[{key}]`"));
            None
        }
    }
}

/// Entries of `[[key]]` with their places in the text.
fn tables_of<'r, 'i>(root: &mut Reader<'r, 'i>, key: &'static str, rules: &mut Rules) -> Vec<(usize, &'r DeTable<'i>)> {
    let Some(value) = root.peek(key) else { return Vec::new() };
    let remedy = format!("two brackets for each entry: `[[{key}]]`");
    let DeValue::Array(entries) = value else {
        rules.fault(key, "this must be a list of tables", &remedy);
        return Vec::new();
    };
    let mut tables = Vec::new();
    for (index, entry) in entries.iter().enumerate() {
        let path = format!("{key}.{index}");
        rules.places.push((path.clone(), entry.span()));
        match entry.get_ref() {
            DeValue::Table(table) if table.iter().next().is_some() => tables.push((entry.span().start, table)),
            DeValue::Table(_) => rules.fault(&path, "there is nothing in it", "name a path and its values"),
            _ => rules.fault(&path, "this must be a table", &remedy),
        }
    }
    tables
}

fn combine(root: &mut Reader<'_, '_>, axes: &[Axis], rules: &mut Rules) -> Combine {
    let ordered = root.choice("combine", &[("product", Combine::Product), ("zip", Combine::Zip)]);
    let sampled = root.table("sample").map(|mut table| {
        let count = table.count("count");
        if count.is_none() {
            table.missing("count", "how many points to draw: count = 200");
        }
        let seed = table.whole("seed").unwrap_or(0);
        let methods = [("latin-hypercube", true), ("random", false)];
        let stratified = table.choice("method", &methods).unwrap_or(true);
        table.finish();
        Combine::Sample { count: count.unwrap_or(1) as usize, seed, stratified }
    });
    if ordered.is_some() && sampled.is_some() {
        rules.fault("combine", "a sample needs no `combine`", "leave one of them away");
    }
    if let Some(Combine::Sample { count: 0, .. }) = sampled {
        rules.fault("sample.count", "0 points are none", "give 1 or more");
    }
    let length = |axis: &Axis| match &axis.values {
        AxisValues::Rows(rows) => Some(rows.len()),
        AxisValues::Between { .. } => None,
    };
    if sampled.is_none() {
        for axis in axes.iter().filter(|axis| length(axis).is_none()) {
            let remedy = "give count or step; or draw a sample: [sample] count = 200";
            rules.fault(&axis.paths[0].place, "a range without steps has no end of values", remedy);
        }
    }
    if ordered == Some(Combine::Zip)
        && let Some(first) = axes.first()
    {
        for axis in axes.iter().filter(|axis| length(axis) != length(first)) {
            let shown = |axis: &Axis| length(axis).unwrap_or_default();
            let message = format!("has {} values, `{}` {}", shown(axis), first.paths[0].path, shown(first));
            rules.fault(&axis.paths[0].place, message, "zip goes row by row: give each as many");
        }
    }
    sampled.or(ordered).unwrap_or(Combine::Product)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn only_fault(text: &str) -> String {
        let errors = read("sweep.toml", text).expect_err("a faulty text");
        assert_eq!(errors.faults.len(), 1, "{errors}");
        errors.lines()[0].clone()
    }

    fn rows(axis: &Axis) -> Vec<String> {
        match &axis.values {
            AxisValues::Rows(rows) => rows
                .iter()
                .map(|row| row.iter().map(|choice| choice.value.to_string()).collect::<Vec<_>>().join(" "))
                .collect(),
            AxisValues::Between { from, to, log } => vec![format!("{from}..{to} {log}")],
        }
    }

    #[test]
    fn the_example_is_good() {
        let (sweep, _) = read("sweep.toml", example_text()).unwrap_or_else(|errors| panic!("{errors}"));
        assert!(sweep.axes.len() >= 2, "{sweep:?}");
    }

    #[test]
    fn axes_come_in_the_order_of_the_text_with_every_form_of_values() {
        let text = r#"
scenario = "shove.toml"
rigs = ["a/hero.glb", { name = "guard", file = "b/hero.glb" }]
[vary]
seed = [1, 2]
"push.0.force" = { from = 100, to = 400, count = 4 }
"push.0.at" = [{ name = "high", value = "head" }, "hips"]
"push.0.duration" = { from = 0.1, to = 0.8, count = 4, scale = "log" }
[[linked]]
"push.0.start" = { from = 0.5, to = 1.0, step = 0.25 }
duration = [3, 4, 5.5]
"#;
        let (sweep, _) = read("sweep.toml", text).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(sweep.rigs.iter().map(|rig| rig.name.as_str()).collect::<Vec<_>>(), ["hero", "guard"]);
        let axes: Vec<Vec<String>> = sweep.axes.iter().map(rows).collect();
        assert_eq!(axes[0], ["1", "2"]);
        assert_eq!(axes[1], ["100", "200", "300", "400"]);
        assert_eq!(axes[2], ["\"head\"", "\"hips\""]);
        assert_eq!(axes[3], ["0.1", "0.2", "0.4", "0.8"]);
        assert_eq!(axes[4], ["0.5 3", "0.75 4", "1.0 5.5"]);
        assert_eq!(sweep.name, "{title}_{seed}_{push.0.force}_{push.0.at}_{push.0.duration}_{push.0.start}_{duration}");
        let AxisValues::Rows(rows) = &sweep.axes[2].values else { panic!("rows") };
        assert_eq!(rows[0][0].name.as_deref(), Some("high"));
    }

    #[test]
    fn faults_name_their_line_and_the_remedy() {
        let cases = [
            ("scenario = \"s.toml\"\n[vary]\nseed = []\n", "sweep.toml:3:8", "empty list"),
            ("scenario = \"s.toml\"\n[vary]\nseed = 4\n", "sweep.toml:3:8", "does not vary"),
            ("scenario = \"s.toml\"\n[vary]\nseed = { from = 1, to = 2 }\n", "sweep.toml:3:8", "[sample]"),
            ("scenario = \"s.toml\"\n[vary]\nseed = { from = 1, to = 2, cuont = 2 }\n", "sweep.toml:3:8", "cuont"),
            ("scenario = \"s.toml\"\nrgis = [\"a.glb\"]\n", "sweep.toml:2:1", "did you mean `rigs`"),
            ("scenario = \"s.toml\"\nrigs = []\n", "sweep.toml:2:8", "empty"),
            ("[vary]\nseed = [1]\n", "sweep.toml:1:1", "has no `scenario`"),
            (
                "scenario = \"s.toml\"\ncombine = \"zip\"\n[vary]\nseed = [1, 2]\nduration = [1, 2, 3]\n",
                "sweep.toml:5:12",
                "row by row",
            ),
            ("scenario = \"s.toml\"\n[[linked]]\nseed = [1, 2]\nduration = [1]\n", "sweep.toml:4:12", "row by row"),
            ("scenario = \"s.toml\"\n[sample]\nseed = 1\n", "sweep.toml:2:1", "no `count`"),
            ("scenario = \"s.toml\"\n[bake]\nfps = 0\n", "sweep.toml:3:7", "1 to 240"),
            ("scenario = \"s.toml\"\n[bake]\nengine = [\"three\", \"untiy\"]\n", "sweep.toml:3:10", "give some of"),
        ];
        for (text, place, words) in cases {
            let line = only_fault(text);
            assert!(line.starts_with(place) && line.contains(words), "{text}: {line}");
        }
    }
}
