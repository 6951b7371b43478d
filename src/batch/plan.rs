//! A sweep and its scenarios to the list of variations: every value set, every scenario checked, every name given, before anything runs.
//!
//! The order is rig, scenario, point: chunks of it share a rig. What is wrong is told as faults with their places in the sweep's
//! text. Rigs are known by name only; no file is touched here.

use super::combine;
use super::name::{self, Template, Word};
use super::paths::{get, parent, passes, set, within};
use crate::bake::safe_letters;
use crate::model::Scenario;
use crate::model::scenario_errors::Fault;
use crate::model::scenario_text;
use crate::model::sweep::{Choice, Condition, Input, Skip, Sweep};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use toml::{Table, Value};

/// Variations of one sweep at most.
const MOST: usize = 1_000_000;
/// Faults that are told at most: whoever mends these sees the rest next time.
const MOST_FAULTS: usize = 20;

/// A sweep that was checked.
#[derive(Clone, Debug)]
pub struct Plan {
    /// As it was read.
    pub sweep: Sweep,
    /// One for every variation, in order.
    pub variations: Vec<Variation>,
    /// s of motion in all.
    pub seconds: f64,
    /// For a person: what is odd but no fault.
    pub notes: Vec<String>,
    sources: Vec<Source>,
}

/// One clip to bake.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// From 1.
    pub number: usize,
    /// Index of the sweep's rig.
    pub rig: usize,
    /// Index of the sweep's scenario.
    pub scenario: usize,
    /// What each path of [`Plan::paths`] is set to.
    pub choices: Vec<Choice>,
    /// Of its clip and, with an ending, its file.
    pub name: String,
}

/// A scenario of the sweep, before its values are set.
#[derive(Clone, Debug)]
struct Source {
    name: String,
    table: Table,
}

/// Makes the plan; `texts` are the sweep's scenarios, each its name for messages and its text, that read without a fault.
pub fn plan(sweep: Sweep, texts: &[(String, String)]) -> Result<Plan, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut sources = Vec::with_capacity(texts.len());
    for ((name, text), input) in texts.iter().zip(&sweep.scenarios) {
        match text.parse::<Table>() {
            Ok(table) => sources.push(Source { name: name.clone(), table }),
            Err(error) => faults.push(fault(&input.path, format!("{name}: {error}"), "mend the scenario first")),
        }
    }
    named_apart(&sweep.rigs, "rigs", &mut faults);
    named_apart(&sweep.scenarios, "scenarios", &mut faults);
    let template = Template::read(&sweep.name).map_err(|what| vec![fault("name", what, "as in \"{rig}_{title}\"")]);
    let points = match combine::count(&sweep.axes, sweep.combine) {
        Some(count) if count.saturating_mul(sweep.rigs.len() * sweep.scenarios.len()) <= MOST => {
            combine::points(&sweep.axes, sweep.combine)
        }
        _ => {
            faults.push(fault("vary", format!("more than {MOST} variations"), "vary less, or draw a [sample]"));
            Vec::new()
        }
    };
    let mut plan = Plan { sweep, variations: Vec::new(), seconds: 0.0, notes: Vec::new(), sources };
    plan.known(&mut faults);
    if let Err(wrong) = &template {
        faults.extend(wrong.clone());
    }
    let (Ok(template), true) = (template, faults.is_empty()) else { return Err(faults) };
    plan.fill(&template, &points)?;
    Ok(plan)
}

impl Plan {
    /// Every path that varies, in the order of the choices.
    pub fn paths(&self) -> Vec<&str> {
        self.sweep.axes.iter().flat_map(|axis| &axis.paths).map(|path| path.path.as_str()).collect()
    }

    /// The name of a variation's rig, and of its folder.
    pub fn rig_name(&self, variation: &Variation) -> &str {
        &self.sweep.rigs[variation.rig].name
    }

    /// The scenario of a variation as a text of its own: what `surefoot bake` would be given.
    pub fn scenario_text(&self, variation: &Variation) -> String {
        let source = &self.sources[variation.scenario];
        self.varied(source, &variation.choices).map_or_else(|_| String::new(), |table| table.to_string())
    }

    /// The same as it is played.
    pub fn scenario(&self, variation: &Variation) -> Result<Scenario, String> {
        let source = &self.sources[variation.scenario];
        scenario_text::parse(&source.name, &self.scenario_text(variation)).map_err(|errors| errors.to_string())
    }

    /// What is known before a value is set: names and paths that lead nowhere.
    fn known(&self, faults: &mut Vec<Fault>) {
        let mut seen: BTreeSet<&str> = BTreeSet::new();
        for path in self.sweep.axes.iter().flat_map(|axis| &axis.paths) {
            if !seen.insert(&path.path) {
                faults.push(fault(&path.place, format!("`{}` varies twice", path.path), "leave one of them away"));
            }
            for source in &self.sources {
                if let Err(what) = set(&mut source.table.clone(), &path.path, Value::Integer(0)) {
                    let message = format!("{}: {what}", source.name);
                    faults.push(fault(&path.place, message, "give the path of a value, as in \"push.0.force\""));
                }
            }
        }
        for condition in self.sweep.skips.iter().flat_map(|skip| &skip.conditions) {
            let there = |source: &Source| {
                seen.contains(condition.path.as_str()) || get(&source.table, &condition.path).is_some()
            };
            if !["rig", "scenario"].contains(&condition.path.as_str()) && !self.sources.iter().any(there) {
                let message = format!("no scenario has `{}`", condition.path);
                faults.push(fault(&condition.place, message, "give `rig`, `scenario`, or a path that varies"));
            }
        }
    }

    /// Scenarios and names of every variation.
    fn fill(&mut self, template: &Template, points: &[Vec<Choice>]) -> Result<(), Vec<Fault>> {
        let mut faults = Faults::default();
        // A scenario does not depend on the rig: each point is checked once.
        let mut checked: Vec<Vec<Checked>> = Vec::new();
        for source in &self.sources {
            checked.push(points.par_iter().map(|choices| self.check(source, choices)).collect());
        }
        for (index, scenario) in checked.iter().enumerate() {
            for (point, checked) in scenario.iter().enumerate() {
                faults.extend(&checked.faults, || self.said(index, &points[point]));
            }
        }
        let mut names: BTreeMap<(usize, String), usize> = BTreeMap::new();
        let mut skipped = vec![0usize; self.sweep.skips.len()];
        let mut variations = Vec::new();
        let mut seconds = 0.0;
        for (rig, input) in self.sweep.rigs.iter().enumerate() {
            for (scenario, points_checked) in checked.iter().enumerate() {
                for (point, checked) in points_checked.iter().enumerate() {
                    let choices = &points[point];
                    let hit = self.sweep.skips.iter().position(|skip| self.meets(skip, rig, scenario, choices));
                    if let Some(skip) = hit {
                        skipped[skip] += 1;
                        continue;
                    }
                    let number = variations.len() + 1;
                    let word = |place: &str| self.word(place, number, (&input.name, scenario), checked, choices);
                    let name = match template.fill(&word) {
                        Ok(name) => name,
                        Err(place) => {
                            let remedy =
                                format!("known are rig, title, scenario, index, seed, {}", self.paths().join(", "));
                            faults.one(fault(
                                "name",
                                format!("`{{{place}}}` is nothing that a variation has"),
                                &remedy,
                            ));
                            return Err(faults.list);
                        }
                    };
                    if let Some(why) = name::illegal(&name) {
                        faults.one(fault("name", format!("{name:?} cannot be a file's name: {why}"), REMEDY));
                    }
                    if let Some(earlier) = names.insert((rig, name.to_lowercase()), number) {
                        let message = format!("variations {earlier} and {number} would both be called {name:?}");
                        faults.one(fault("name", message, "let the name hold every path that varies, or {index}"));
                    }
                    seconds += checked.duration;
                    variations.push(Variation { number, rig, scenario, choices: choices.clone(), name });
                }
            }
        }
        for (skip, _) in self.sweep.skips.iter().zip(&skipped).filter(|(_, count)| **count == 0) {
            self.notes.push(format!("`{}` leaves nothing out", skip.place));
        }
        if variations.is_empty() && faults.list.is_empty() {
            faults.one(fault("skip", "every variation is left out", "skip less"));
        }
        if !faults.list.is_empty() {
            return Err(faults.list);
        }
        (self.variations, self.seconds) = (variations, seconds);
        Ok(())
    }

    fn check(&self, source: &Source, choices: &[Choice]) -> Checked {
        let mut checked = Checked { title: String::new(), seed: 0, duration: 0.0, faults: Vec::new() };
        let read = self.varied(source, choices).map(|table| scenario_text::parse(&source.name, &table.to_string()));
        match read {
            Ok(Ok(scenario)) => {
                checked.title = safe_letters(&scenario.title);
                checked.seed = scenario.seed;
                checked.duration = scenario.duration;
            }
            Ok(Err(errors)) => {
                let told = errors.faults.into_iter();
                checked.faults = told.map(|text| fault(&text.path, text.message, &text.remedy)).collect();
            }
            Err(what) => checked.faults.push(fault("", what, "give another path")),
        }
        checked
    }

    /// The scenario with its values set.
    fn varied(&self, source: &Source, choices: &[Choice]) -> Result<Table, String> {
        let mut table = source.table.clone();
        let paths = self.sweep.axes.iter().flat_map(|axis| &axis.paths);
        for (path, choice) in paths.zip(choices) {
            set(&mut table, &path.path, choice.value.clone())?;
        }
        Ok(table)
    }

    /// What the scenario says of a faulty point, and where in the sweep it is said.
    fn said(&self, scenario: usize, choices: &[Choice]) -> Said<'_> {
        let paths: Vec<_> = self.sweep.axes.iter().flat_map(|axis| &axis.paths).collect();
        let with = |index: usize| format!("{} = {}", paths[index].path, choices[index].value);
        let set: Vec<(&str, &str, String)> = (0..paths.len())
            .map(|index| (paths[index].path.as_str(), paths[index].place.as_str(), with(index)))
            .collect();
        Said { source: &self.sources[scenario].name, place: &self.sweep.scenarios[scenario].path, set }
    }

    fn word(
        &self,
        place: &str,
        number: usize,
        (rig, scenario): (&str, usize),
        checked: &Checked,
        choices: &[Choice],
    ) -> Option<Word> {
        Some(match place {
            "rig" => Word::Text(rig.to_owned()),
            "title" => Word::Text(checked.title.clone()),
            "scenario" => Word::Text(self.sweep.scenarios[scenario].name.clone()),
            "index" => Word::Value(Value::Integer(number as i64)),
            path => match self.chosen(path, choices) {
                Some(Choice { name: Some(name), .. }) => Word::Text(name.clone()),
                Some(choice) => Word::Value(choice.value.clone()),
                None if path == "seed" => Word::Value(Value::Integer(checked.seed as i64)),
                None => Word::Value(get(&self.sources[scenario].table, path)?.clone()),
            },
        })
    }

    fn chosen<'c>(&self, path: &str, choices: &'c [Choice]) -> Option<&'c Choice> {
        self.paths().iter().position(|known| *known == path).map(|index| &choices[index])
    }

    fn meets(&self, skip: &Skip, rig: usize, scenario: usize, choices: &[Choice]) -> bool {
        skip.conditions.iter().all(|condition: &Condition| {
            let text;
            let (value, name) = match condition.path.as_str() {
                "rig" | "scenario" => {
                    let of_rig = condition.path == "rig";
                    let input = if of_rig { &self.sweep.rigs[rig] } else { &self.sweep.scenarios[scenario] };
                    text = Value::String(input.name.clone());
                    (Some(&text), None)
                }
                path => match self.chosen(path, choices) {
                    Some(choice) => (Some(&choice.value), choice.name.as_deref()),
                    None => (get(&self.sources[scenario].table, path), None),
                },
            };
            value.is_some_and(|value| passes(&condition.test, value, name))
        })
    }
}

const REMEDY: &str = "change the template, or name the value: { name = \"light\", value = 150 }";

/// A point of a scenario.
struct Checked {
    title: String,
    seed: u64,
    duration: f64,
    faults: Vec<Fault>,
}

/// What is needed to place a scenario's fault in the sweep.
struct Said<'a> {
    source: &'a str,
    place: &'a str,
    /// Path, its place, "path = value".
    set: Vec<(&'a str, &'a str, String)>,
}

/// Faults, each once, not too many.
#[derive(Default)]
struct Faults {
    list: Vec<Fault>,
    /// Place and words of those that a scenario told: the same of another value is not told again.
    told: BTreeSet<(String, String)>,
}

impl Faults {
    fn one(&mut self, fault: Fault) {
        if self.list.len() < MOST_FAULTS && !self.list.contains(&fault) {
            self.list.push(fault);
        }
    }

    /// A scenario's, at the value that the sweep set where it is that one's.
    fn extend<'a>(&mut self, faults: &[Fault], said: impl Fn() -> Said<'a>) {
        if faults.is_empty() || self.list.len() >= MOST_FAULTS {
            return;
        }
        let said = said();
        for wrong in faults {
            let touched = |(path, ..): &&(&str, &str, String)| within(&wrong.path, path) || within(path, &wrong.path);
            // Else a value beside it: a start too late for its duration is told of the duration.
            let beside = |(path, ..): &&(&str, &str, String)| parent(path).is_some_and(|all| within(&wrong.path, all));
            let own = said.set.iter().find(touched).or_else(|| said.set.iter().find(beside));
            let all: Vec<&str> = said.set.iter().map(|(.., with)| with.as_str()).collect();
            let (place, with) = match own {
                Some((_, place, with)) => (*place, with.clone()),
                None => (said.place, all.join(", ")),
            };
            if !self.told.insert((place.to_owned(), wrong.message.clone())) {
                continue;
            }
            let message = format!("{} with {with}: {}", said.source, wrong.message);
            self.one(fault(place, message, &wrong.remedy));
        }
    }
}

fn fault(path: &str, message: impl Into<String>, remedy: &str) -> Fault {
    Fault { path: path.into(), message: message.into(), remedy: remedy.into() }
}

/// Names that are good for folders and differ, whatever the case of their letters.
fn named_apart(inputs: &[Input], what: &str, faults: &mut Vec<Fault>) {
    let mut seen: BTreeMap<String, &Input> = BTreeMap::new();
    for input in inputs {
        if let Some(why) = name::illegal(&input.name) {
            let remedy = "name it: { name = \"hero\", file = \"...\" }";
            faults.push(fault(&input.path, format!("{:?} cannot be a folder's name: {why}", input.name), remedy));
        }
        if let Some(earlier) = seen.insert(input.name.to_lowercase(), input) {
            let message = format!("two {what} are called {:?}: {} and {}", input.name, earlier.file, input.file);
            faults.push(fault(&input.path, message, "name one of them: { name = \"hero2\", file = \"...\" }"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::sweep_text;

    const SHOVE: &str =
        "title = \"a shove\"\nduration = 4.0\n[[push]]\nstart = 1.0\nduration = 0.2\nforce = 300\ntoward = \"left\"\n";

    fn planned(text: &str) -> Result<Plan, Vec<Fault>> {
        let (sweep, _) = sweep_text::read("sweep.toml", text).unwrap_or_else(|errors| panic!("{errors}"));
        let texts: Vec<_> = sweep.scenarios.iter().map(|input| (input.file.clone(), SHOVE.to_owned())).collect();
        plan(sweep, &texts)
    }

    fn names(plan: &Plan) -> Vec<&str> {
        plan.variations.iter().map(|variation| variation.name.as_str()).collect()
    }

    fn only_fault(text: &str) -> Fault {
        let faults = planned(text).map(|plan| plan.variations.len()).expect_err("a faulty sweep");
        assert_eq!(faults.len(), 1, "{faults:?}");
        faults[0].clone()
    }

    #[test]
    fn rigs_scenarios_and_points_multiply_and_every_value_is_set() {
        let plan = planned(
            "scenarios = [\"s.toml\", \"t.toml\"]\nrigs = [\"a.glb\", \"b.glb\"]\nname = \"{scenario}_{title}_{push.0.force}_s{seed}\"\n[vary]\n\"push.0.force\" = [{ name = \"hard\", value = 400 }, 100]\nseed = [3, 4]\n",
        )
        .expect("a good sweep");
        assert_eq!(plan.variations.len(), 16);
        assert_eq!(
            names(&plan)[..4],
            ["s_a_shove_hard_s3", "s_a_shove_hard_s4", "s_a_shove_100_s3", "s_a_shove_100_s4"]
        );
        let last = plan.scenario(&plan.variations[15]).expect("a scenario");
        assert_eq!((last.push[0].force, last.seed, last.push[0].start), (100.0, 4, 1.0));
        assert_eq!((plan.variations[15].rig, plan.variations[15].scenario, plan.seconds), (1, 1, 64.0));
    }

    #[test]
    fn skips_leave_out_what_meets_all_their_conditions() {
        let plan = planned(
            "scenario = \"s.toml\"\nrigs = [\"a.glb\", \"b.glb\"]\n[vary]\n\"push.0.force\" = [100, 200, 300]\nseed = [1, 2]\n[[skip]]\nrig = \"b\"\n\"push.0.force\" = { above = 150 }\n[[skip]]\nseed = 9\n",
        )
        .expect("a good sweep");
        let b: Vec<&str> =
            plan.variations.iter().filter(|variation| variation.rig == 1).map(|v| v.name.as_str()).collect();
        assert_eq!(b, ["a_shove_100_1", "a_shove_100_2"]);
        assert_eq!(plan.variations.len(), 8);
        assert_eq!(plan.notes, ["`skip.1` leaves nothing out"]);
    }

    #[test]
    fn each_fault_is_told_at_its_place_in_the_sweep() {
        let sweep = |rest: &str| format!("scenario = \"s.toml\"\nrigs = [\"a.glb\"]\n{rest}");
        let cases = [
            ("[vary]\n\"push.0.forse\" = [1, 2]\n", "vary.push.0.forse", "unknown key `forse`"),
            ("[vary]\n\"push.1.force\" = [1, 2]\n", "vary.push.1.force", "has 1 entries"),
            ("[vary]\n\"title.x\" = [1, 2]\n", "vary.title.x", "one value"),
            ("[vary]\n\"push.0.force\" = [1e9]\n", "vary.push.0.force", "out of range"),
            ("[vary]\n\"push.0.start\" = [3.9]\n", "vary.push.0.start", "s.toml with push.0.start = 3.9"),
            ("name = \"{push.0.forse}\"\n", "name", "nothing that a variation has"),
            ("name = \"a{\"\n", "name", "without its"),
            ("name = \"a/b\"\n", "name", "stands in no file name"),
            ("name = \"A\"\n[vary]\nseed = [1, 2]\n", "name", "would both be called"),
            (
                "[vary]\nseed = { from = 1, to = 2000, count = 2000 }\n\"push.0.force\" = { from = 1, to = 900, count = 900 }\n",
                "vary",
                "more than",
            ),
            ("[vary]\nseed = [1]\n[[skip]]\nseed = 1\n", "skip", "every variation"),
            ("[[skip]]\n\"push.0.forse\" = 1\n", "skip.0.push.0.forse", "no scenario has"),
        ];
        for (rest, place, words) in cases {
            let fault = only_fault(&sweep(rest));
            assert!(fault.path == place && fault.message.contains(words), "{rest}: {fault:?}");
        }
        let fault = only_fault("scenario = \"s.toml\"\nrigs = [\"a/x.glb\", \"b/X.glb\"]\n");
        assert!(fault.path == "rigs.1" && fault.message.contains("two rigs"), "{fault:?}");
    }
}
