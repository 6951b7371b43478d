//! What a person wants varied, as they typed it; the same as a sweep's text, and the plan or the faults that come of it.
//!
//! The text is the one way: what the desk bakes, saves and complains of is what `surefoot batch` would. Pure.

use super::values::{self, Try};
use crate::batch::{Plan, plan};
use crate::disk::writer::Output;
use crate::model::scenario::GroundKind;
use crate::model::scenario_write::write;
use crate::model::sweep::{AxisValues, BakeSettings, Sweep};
use crate::model::{FileKind, Scenario, sweep_text};
use crate::studio::document::Document;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Cells of a grid at most.
pub const MOST_CELLS: usize = 400;

/// What varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Down.
    pub rows: Axis,
    /// Across.
    pub columns: Axis,
    /// Seeds of each, from the scenario's own on.
    pub seeds: u32,
}

/// A value and what it is set to, as typed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// The value's path; empty: nothing varies.
    pub path: String,
    /// A list, not a range.
    pub listed: bool,
    /// The first.
    pub from: String,
    /// The last.
    pub to: String,
    /// How many.
    pub count: String,
    /// Even steps of the logarithm.
    pub log: bool,
    /// The list.
    pub list: String,
}

/// What is to be planned.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// What varies.
    pub wish: Wish,
    /// Of what.
    pub document: Document,
    /// Where its scenario lies.
    pub file: Option<PathBuf>,
}

/// Where a fault is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Under the rows.
    Rows,
    /// Under the columns.
    Columns,
    /// Under the seeds.
    Seeds,
    /// Under all.
    Whole,
}

/// What is wrong, in the sweep's words.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrong {
    /// Where it is told.
    pub field: Field,
    /// For a person.
    pub words: String,
}

impl Axis {
    /// That value, with something to try.
    pub fn of(path: &str, scenario: &Scenario) -> Axis {
        let mut axis = Axis { path: path.to_owned(), ..Axis::default() };
        match values::first_try(path, values::now(scenario, path).as_ref()) {
            Try::Words(words) => (axis.listed, axis.list) = (true, words.to_owned()),
            Try::Range(from, to, count) => {
                (axis.from, axis.to, axis.count) = (from.to_string(), to.to_string(), count.to_string());
            }
        }
        axis
    }

    /// As the sweep's text has it.
    fn text(&self) -> String {
        let log = if self.log { ", scale = \"log\"" } else { "" };
        match self.listed {
            true => format!("[{}]", items(&self.list).map(value).collect::<Vec<_>>().join(", ")),
            false => format!(
                "{{ from = {}, to = {}, count = {}{log} }}",
                value(&self.from),
                value(&self.to),
                value(&self.count)
            ),
        }
    }
}

/// Parts of a list between commas that stand in no brackets and no quotes.
fn items(list: &str) -> impl Iterator<Item = &str> {
    let (mut depth, mut quoted) = (0_i32, false);
    let parts = list.split(move |letter: char| {
        match letter {
            '"' => quoted = !quoted,
            '[' if !quoted => depth += 1,
            ']' if !quoted => depth -= 1,
            _ => {}
        }
        letter == ',' && depth <= 0 && !quoted
    });
    parts.filter(|part| !part.trim().is_empty())
}

/// What was typed as a value of TOML: numbers, lists and quoted words as they are, all else as a word.
fn value(typed: &str) -> String {
    let typed = typed.trim();
    let table: Option<Table> = format!("value = {typed}").parse().ok();
    let read = table.filter(|table| table.len() == 1).and_then(|table| table.get("value").cloned());
    match read {
        Some(value @ (Value::Integer(_) | Value::Float(_) | Value::Array(_) | Value::String(_))) => value.to_string(),
        _ => quoted(typed),
    }
}

fn quoted(text: &str) -> String {
    Value::String(text.to_owned()).to_string()
}

impl Wish {
    /// What a scenario suggests: how hard and where to, else how fast, else how agile.
    pub fn suggested(scenario: &Scenario) -> Wish {
        let paths = values::paths(scenario);
        let first = |wanted: [&'static str; 5]| wanted.into_iter().find(|path| paths.iter().any(|known| known == path));
        let rows = first(["push.0.force", "pull.0.force", "throw.0.speed", "walk.0.speed", "character.agility"]);
        let columns =
            first(["push.0.toward", "pull.0.toward", "throw.0.from", "walk.0.heading", "character.leg_scale"]);
        let axis = |path: Option<&str>| path.map_or_else(Axis::default, |path| Axis::of(path, scenario));
        Wish { rows: axis(rows), columns: axis(columns), seeds: 1 }
    }

    fn axes(&self) -> impl Iterator<Item = &Axis> {
        [&self.rows, &self.columns].into_iter().filter(|axis| !axis.path.is_empty())
    }

    /// Whether seeds vary beside the axes.
    pub fn varies_seeds(&self) -> bool {
        self.seeds > 1 && self.axes().all(|axis| axis.path != "seed")
    }

    /// The sweep; `scenario` is the file that it names.
    fn text(&self, document: &Document, rig: &Path, scenario: &str) -> String {
        let mut text =
            format!("scenario = {}\nrigs = [{}]\n\n[vary]\n", quoted(scenario), quoted(&rig.to_string_lossy()));
        for axis in self.axes() {
            let _ = writeln!(text, "{} = {}", quoted(&axis.path), axis.text());
        }
        if self.varies_seeds() {
            let first = document.scenario.seed;
            let seeds = (0..u64::from(self.seeds)).map(|seed| first.saturating_add(seed).to_string());
            let _ = writeln!(text, "seed = [{}]", seeds.collect::<Vec<_>>().join(", "));
        }
        text + &bake_text(&document.bake)
    }
}

/// The table of settings.
fn bake_text(bake: &BakeSettings) -> String {
    let mut text =
        format!("\n[bake]\ndrive = {}\nfps = {}\nroot = {}\n", quoted(bake.drive), bake.fps, quoted(bake.root));
    let mut line = |is: bool, line: String| {
        if is {
            text += &line;
            text.push('\n');
        }
    };
    line(bake.assist.is_some(), format!("assist = {:?}", bake.assist.unwrap_or_default()));
    line(bake.props && bake.format.without_props().is_none(), "props = true".into());
    line(bake.looped, "loop = true".into());
    line(bake.curves == "spline", "curves = \"spline\"".into());
    line(bake.only_animation, "only_animation = true".into());
    line(!bake.contact_nodes, "contact_nodes = false".into());
    line(bake.format != FileKind::Glb, format!("format = {}", quoted(bake.format.ending())));
    line(!bake.engines.is_empty(), format!("engine = {:?}", bake.engines));
    text
}

impl Job {
    /// Every variation, or what is wrong.
    pub fn plan(&self) -> Result<Plan, Vec<Wrong>> {
        let text = self.wish.text(&self.document, &self.document.rig, "scenario.toml");
        let (sweep, _) = sweep_text::read("the grid", &text).map_err(|errors| {
            errors.faults.iter().map(|fault| self.wrong(&fault.path, &fault.message, &fault.remedy)).collect::<Vec<_>>()
        })?;
        self.few(&sweep)?;
        plan(sweep, &[("the scenario".to_owned(), write(&self.document.scenario))]).map_err(|faults| {
            faults.iter().map(|fault| self.wrong(&fault.path, &fault.message, &fault.remedy)).collect()
        })
    }

    fn few(&self, sweep: &Sweep) -> Result<(), Vec<Wrong>> {
        let cells = shape(sweep).into_iter().fold(1, usize::saturating_mul);
        if cells <= MOST_CELLS {
            return Ok(());
        }
        let words = format!(
            "{cells} cells: a grid has {MOST_CELLS} at most (give fewer values, or save it as a sweep for `surefoot batch`)"
        );
        Err(vec![Wrong { field: Field::Whole, words }])
    }

    fn wrong(&self, path: &str, message: &str, remedy: &str) -> Wrong {
        let of = |axis: &Axis| {
            !axis.path.is_empty() && path.strip_prefix("vary.").is_some_and(|rest| rest.starts_with(&axis.path))
        };
        let field = match () {
            () if of(&self.wish.rows) => Field::Rows,
            () if of(&self.wish.columns) => Field::Columns,
            () if path.starts_with("vary.seed") => Field::Seeds,
            () => Field::Whole,
        };
        let message = message.strip_prefix(&format!("`{path}`: ")).unwrap_or(message);
        Wrong { field, words: format!("{message} ({remedy})") }
    }
}

/// Rows, columns, seeds of a sweep that [`Wish`] made.
pub fn shape(sweep: &Sweep) -> Vec<usize> {
    let length = |values: &AxisValues| match values {
        AxisValues::Rows(rows) => rows.len(),
        AxisValues::Between { .. } => 1,
    };
    sweep.axes.iter().map(|axis| length(&axis.values)).collect()
}

/// A grid as files: a sweep and, beside it, the scenario as it is now.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepToSave {
    job: Job,
}

impl SweepToSave {
    /// Of a grid.
    pub fn new(job: Job) -> SweepToSave {
        SweepToSave { job }
    }

    /// A name to offer.
    pub fn name(&self) -> String {
        format!("{}.sweep.toml", crate::bake::safe_name(&self.job.document.scenario.title))
    }

    /// The sweep's text where the scenario's file is called that.
    pub fn sweep(&self, scenario_file: &str) -> String {
        let Job { wish, document, .. } = &self.job;
        let rig = if document.rig.as_os_str() == "builtin" { document.rig.clone() } else { whole(&document.rig) };
        let head = "# A sweep from the studio: `surefoot batch THIS -o FOLDER` bakes it.\n";
        format!("{head}{}", wish.text(document, &rig, scenario_file))
    }

    /// The scenario's text. A base clip's and a ground's file are named from everywhere.
    pub fn scenario(&self) -> String {
        let mut scenario = self.job.document.scenario.clone();
        let folder = self.job.file.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        if let Some(file) = scenario.base.as_mut().and_then(|base| base.file.as_mut()) {
            *file = whole(&folder.join(&*file)).to_string_lossy().into_owned();
        }
        if let GroundKind::Mesh { file, .. } = &mut scenario.ground.kind {
            *file = whole(&folder.join(&*file)).to_string_lossy().into_owned();
        }
        write(&scenario)
    }

    /// Both, for that place: `x.toml` and `x.scenario.toml`.
    pub fn outputs(&self, path: &Path) -> Vec<Output> {
        let beside = path.with_extension("scenario.toml");
        let name = beside.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        vec![
            Output { path: path.to_owned(), bytes: self.sweep(&name).into_bytes() },
            Output { path: beside, bytes: self.scenario().into_bytes() },
        ]
    }
}

fn whole(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
