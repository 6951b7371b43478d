//! The table of a batch: a row a variation, in the order of the plan, as CSV and as JSON. Bytes only; nothing of when or how long, so
//! that the same batch gives the same table.

use super::run::Ended;
use super::{Plan, Variation};
use serde_json::{Map, Value, json};

/// What a row says beside the endings.
pub struct Table<'a> {
    /// Whose.
    pub plan: &'a Plan,
    /// How each variation ended.
    pub endings: &'a [Ended],
    /// Index of the earlier variation that each resembles.
    pub alike: &'a [Option<usize>],
    /// Whether clips are in one file a rig.
    pub merged: bool,
}

/// Columns behind the parameters.
const MEASURED: [&str; 22] = [
    "seed",
    "state",
    "outcome",
    "steps",
    "drive",
    "duration_s",
    "recovery_s",
    "travel_m",
    "direction_deg",
    "impulse_ns",
    "assist_peak_nm",
    "assist_peak_n",
    "slip_mm",
    "penetration_mm",
    "zmp_inside",
    "plausibility",
    "base_error_deg",
    "base_error_mm",
    "loop_error_deg",
    "loop_error_mm",
    "similar_to",
    "hash",
];

impl Table<'_> {
    /// As CSV with a head.
    pub fn csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let paths = self.plan.paths();
        let head = ["number", "name", "file", "rig", "scenario"];
        let columns = head.iter().chain(&paths).chain(&MEASURED).chain(&["warnings", "error"]);
        // A parameter that is a measured column too, the seed, stands once.
        let shown = |column: &&&str| !(MEASURED.contains(column) && paths.contains(column));
        let head: Vec<&str> = columns.filter(|column| **column == "seed" || shown(column)).copied().collect();
        let head = once(head);
        drop(writer.write_record(&head));
        for row in self.rows() {
            let cell = |column: &&str| {
                let value = row.get(*column).or_else(|| row["parameters"].get(*column));
                value.map_or_else(String::new, plain)
            };
            drop(writer.write_record(head.iter().map(cell)));
        }
        writer.into_inner().unwrap_or_default()
    }

    /// As JSON: `{ version, generator, counts, clips: [row] }`.
    pub fn json(&self) -> Value {
        let count = |wanted: &str| {
            let is = |ended: &&Ended| match ended {
                Ended::Done(measured, _) => measured.outcome == wanted,
                Ended::Failed(_) => wanted == "failed",
                Ended::NotRun => wanted == "not run",
            };
            self.endings.iter().filter(is).count()
        };
        let words = ["still", "sway", "step", "fall", "failed", "not run"];
        let counts: Map<String, Value> = words.iter().map(|word| ((*word).to_owned(), count(word).into())).collect();
        json!({
            "version": 1,
            "generator": concat!("surefoot ", env!("CARGO_PKG_VERSION")),
            "counts": counts,
            "clips": self.rows(),
        })
    }

    fn rows(&self) -> Vec<Value> {
        let all = self.plan.variations.iter().zip(self.endings).zip(self.alike);
        all.map(|((variation, ended), alike)| self.row(variation, ended, *alike)).collect()
    }

    fn row(&self, variation: &Variation, ended: &Ended, alike: Option<usize>) -> Value {
        let rig = self.plan.rig_name(variation);
        let ending = self.plan.sweep.bake.format.ending();
        let file = match self.merged {
            true => format!("{rig}.{ending}"),
            false => format!("{rig}/{}.{ending}", variation.name),
        };
        let chosen = self.plan.paths().into_iter().zip(&variation.choices);
        let parameters: Map<String, Value> = chosen
            .map(|(path, choice)| (path.to_owned(), serde_json::to_value(&choice.value).unwrap_or_default()))
            .collect();
        let mut row = json!({
            "number": variation.number,
            "name": variation.name,
            "file": file,
            "rig": rig,
            "scenario": self.plan.sweep.scenarios[variation.scenario].name,
            "parameters": parameters,
        });
        match ended {
            Ended::Failed(why) => {
                row["state"] = "failed".into();
                row["error"] = why.clone().into();
            }
            Ended::NotRun => row["state"] = "not run".into(),
            Ended::Done(measured, _) => {
                let round = |value: f64, digits: i32| {
                    let scale = 10f64.powi(digits);
                    (value * scale).round() / scale
                };
                let pair = |pair: Option<[f64; 2]>, index: usize| pair.map(|pair| round(pair[index], 3));
                row["clip"] = measured.clip.clone().into();
                row["seed"] = measured.seed.into();
                row["state"] = "baked".into();
                row["outcome"] = measured.outcome.clone().into();
                row["steps"] = measured.steps.into();
                row["drive"] = measured.drive.clone().into();
                row["duration_s"] = round(measured.duration, 4).into();
                row["recovery_s"] = measured.recovery.map(|value| round(value, 3)).into();
                row["travel_m"] = round(measured.travel, 3).into();
                row["direction_deg"] = measured.direction.map(|value| round(value, 2)).into();
                row["impulse_ns"] = round(measured.impulse, 3).into();
                row["assist_peak_nm"] = round(measured.assist_nm, 2).into();
                row["assist_peak_n"] = round(measured.assist_n, 2).into();
                row["slip_mm"] = round(measured.slip, 3).into();
                row["penetration_mm"] = round(measured.penetration, 3).into();
                row["zmp_inside"] = round(measured.zmp_inside, 4).into();
                row["plausibility"] = round(measured.plausibility, 4).into();
                row["base_error_deg"] = pair(measured.base_error, 0).into();
                row["base_error_mm"] = pair(measured.base_error, 1).into();
                row["loop_error_deg"] = pair(measured.loop_error, 0).into();
                row["loop_error_mm"] = pair(measured.loop_error, 1).into();
                row["similar_to"] = alike.map(|index| self.plan.variations[index].name.clone()).into();
                row["hash"] = measured.hash.clone().into();
                row["warnings"] = measured.warnings.clone().into();
            }
        }
        row
    }
}

/// Each once, at its first place.
fn once(columns: Vec<&str>) -> Vec<&str> {
    let mut seen = std::collections::BTreeSet::new();
    columns.into_iter().filter(|column| seen.insert(*column)).collect()
}

/// A value as a table has it: text without quotes, nothing for null, lists by semicolons.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(list) => list.iter().map(plain).collect::<Vec<_>>().join("; "),
        other => other.to_string(),
    }
}
