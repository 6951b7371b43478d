//! The batch view: vary a value or two of the document, see the grid of outcomes, open one.
//!
//! [`BatchDesk`] is shown inside of the window and gives [`BatchRequest`]s. It plans and bakes on threads of its own; what it bakes is
//! what `surefoot batch` would of the sweep that it saves.

mod form_ui;
mod grid_ui;
mod one_ui;
mod values;
mod wish;
mod work;

pub use values::paths;
pub use wish::{Axis, Field, Job, MOST_CELLS, SweepToSave, Wish, Wrong};

use super::document::Document;
use super::worker::{Wake, Worker};
use crate::batch::run::Ended;
use crate::batch::{Plan, Variation};
use crate::model::Scenario;
use crate::picture::Verdict;
use eframe::egui::{self, TextureHandle};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use work::{CANCELLED, Order, Planned, Said};

/// What the desk wants of the window.
#[derive(Clone, Debug, PartialEq)]
pub enum BatchRequest {
    /// That variation becomes the document's scenario, as one edit.
    Open(Box<Scenario>),
    /// Ask where, then write its [`SweepToSave::outputs`].
    SaveSweep(Box<SweepToSave>),
    /// Ask for a folder, then [`BatchDesk::bake_to`].
    BakeToFolder(Box<Job>),
}

/// The desk.
pub struct BatchDesk {
    /// What varies; suggested by the first document that is shown.
    pub wish: Option<Wish>,
    planner: Worker<Box<Job>, Planned>,
    baker: Worker<Order, Said>,
    asked: Option<Box<Job>>,
    planned: Option<Planned>,
    wanted: Option<Option<PathBuf>>, // to be baked as soon as it is planned: to be seen, or into a folder
    orders: u64,
    grid: Option<Grid>,
    folder: Option<ToFolder>,
    view: View,
}

/// How the grid is looked at.
struct View {
    /// Points, of a cell; `None`: as the columns fit.
    width: Option<f32>,
    by_outcome: bool,
    hidden: [bool; Verdict::ALL.len()],
    selected: Option<usize>,
}

/// A grid that is baked or being baked.
struct Grid {
    number: u64,
    job: Job,
    plan: Arc<Plan>,
    /// Rows, columns with their seeds.
    shape: [usize; 2],
    cells: Vec<Cell>,
    cancel: Arc<AtomicBool>,
    over: Option<Result<(), String>>,
}

/// One of its cells.
#[derive(Default)]
struct Cell {
    ended: Option<Ended>,
    pixels: Option<([usize; 2], Vec<u8>)>,
    texture: Option<TextureHandle>,
}

/// A batch into a folder.
struct ToFolder {
    number: u64,
    path: PathBuf,
    count: usize,
    done: usize,
    cancel: Arc<AtomicBool>,
    over: Option<Result<Vec<PathBuf>, String>>,
}

impl BatchDesk {
    /// A desk; `wake` is called when there is something new to see.
    pub fn new(wake: Wake) -> BatchDesk {
        BatchDesk {
            wish: None,
            planner: work::planner(Arc::clone(&wake)),
            baker: work::baker(wake),
            asked: None,
            planned: None,
            wanted: None,
            orders: 0,
            grid: None,
            folder: None,
            view: View { width: None, by_outcome: false, hidden: [false; Verdict::ALL.len()], selected: None },
        }
    }

    /// Takes what the workers have; once a frame, shown or not.
    pub fn tick(&mut self) {
        for planned in self.planner.answers() {
            self.planned = Some(planned);
        }
        self.begin();
        for said in self.baker.answers() {
            self.hear(said);
        }
    }

    /// Shows it.
    pub fn ui(&mut self, ui: &mut egui::Ui, document: &Document, file: Option<&Path>) -> Vec<BatchRequest> {
        self.wish.get_or_insert_with(|| Wish::suggested(&document.scenario));
        let mut requests = Vec::new();
        egui::Panel::top("batch form").show(ui, |ui| self.form_ui(ui, document, &mut requests));
        self.ask(document, file);
        if self.grid.is_some() {
            egui::Panel::right("batch cell").exact_size(300.0).show(ui, |ui| self.one_ui(ui, &mut requests));
        }
        egui::CentralPanel::default().show(ui, |ui| self.grid_ui(ui, document, &mut requests));
        requests
    }

    /// Bakes the grid into a folder, as `surefoot batch` would.
    pub fn bake_to(&mut self, folder: PathBuf, job: Job) {
        self.plan(Box::new(job));
        self.wanted = Some(Some(folder));
    }

    /// Whether something is planned or baked.
    pub fn is_busy(&self) -> bool {
        self.wanted.is_some() || self.planner.is_busy() || self.baker.is_busy()
    }

    /// Ends what is baked; the variations that are being baked still end.
    pub fn cancel(&mut self) {
        self.wanted = None;
        stop(self.grid.as_ref().map(|grid| &grid.cancel));
        stop(self.folder.as_ref().map(|folder| &folder.cancel));
    }

    /// Has the newest wish planned.
    fn ask(&mut self, document: &Document, file: Option<&Path>) {
        let Some(wish) = &self.wish else { return };
        let same = |job: &Job| job.wish == *wish && job.document == *document && job.file.as_deref() == file;
        if !self.asked.as_deref().is_some_and(same) && !matches!(self.wanted, Some(Some(_))) {
            let job = Job { wish: wish.clone(), document: document.clone(), file: file.map(Path::to_owned) };
            self.plan(Box::new(job));
        }
    }

    fn plan(&mut self, job: Box<Job>) {
        self.asked = Some(job.clone());
        self.planner.ask_only(job);
    }

    /// The plan of what was asked last, or its faults; `None` while it is being made.
    fn newest(&self) -> Option<&Result<Arc<Plan>, Vec<Wrong>>> {
        let (job, planned) = self.planned.as_ref()?;
        (job.is_none() || *job == self.asked).then_some(planned)
    }

    /// Starts what was wanted once its plan is there. With faults nothing runs.
    fn begin(&mut self) {
        if self.wanted.is_none() {
            return;
        }
        let (Some(planned), Some(job)) = (self.newest().cloned(), self.asked.clone()) else { return };
        let Some(folder) = self.wanted.take() else { return };
        let Ok(plan) = planned else { return };
        self.orders += 1;
        let (number, cancel) = (self.orders, Arc::new(AtomicBool::new(false)));
        let order = Order { number, job: *job, plan, folder, cancel };
        match &order.folder {
            Some(path) => {
                let (path, count) = (path.clone(), order.plan.variations.len());
                let cancel = Arc::clone(&order.cancel);
                stop(self.folder.as_ref().map(|folder| &folder.cancel));
                self.folder = Some(ToFolder { number, path, count, done: 0, cancel, over: None });
            }
            None => {
                stop(self.grid.as_ref().map(|grid| &grid.cancel));
                self.view.selected = None;
                self.grid = Some(Grid::new(&order));
            }
        }
        self.baker.ask(order);
    }

    fn hear(&mut self, said: Said) {
        match said {
            Said::Cell(number, index, made) => {
                if let Some(folder) = self.folder.as_mut().filter(|folder| folder.number == number) {
                    folder.done += 1;
                }
                let grid = self.grid.as_mut().filter(|grid| grid.number == number);
                if let Some(cell) = grid.and_then(|grid| grid.cells.get_mut(index)) {
                    *cell = Cell { ended: Some(made.ended), pixels: made.picture, texture: None };
                }
            }
            Said::Over(number, over) => {
                let all = number == u64::MAX;
                if let Some(grid) =
                    self.grid.as_mut().filter(|grid| grid.number == number || all && grid.over.is_none())
                {
                    grid.over = Some(over.clone().map(drop));
                }
                if let Some(folder) =
                    self.folder.as_mut().filter(|folder| folder.number == number || all && folder.over.is_none())
                {
                    folder.over = Some(over);
                }
            }
        }
    }
}

fn stop(cancel: Option<&Arc<AtomicBool>>) {
    if let Some(cancel) = cancel {
        cancel.store(true, Ordering::Relaxed);
    }
}

impl Drop for BatchDesk {
    /// The window does not wait for a grid that nobody sees.
    fn drop(&mut self) {
        self.cancel();
    }
}

impl Grid {
    fn new(order: &Order) -> Grid {
        let count = order.plan.variations.len();
        let wish = &order.job.wish;
        let shape = wish::shape(&order.plan.sweep);
        let rows = if wish.rows.path.is_empty() { 1 } else { shape.first().copied().unwrap_or(1).max(1) };
        Grid {
            number: order.number,
            job: order.job.clone(),
            plan: Arc::clone(&order.plan),
            shape: [rows, (count / rows).max(1)],
            cells: (0..count).map(|_| Cell::default()).collect(),
            cancel: Arc::clone(&order.cancel),
            over: None,
        }
    }

    /// How many of its cells ended.
    fn done(&self) -> usize {
        self.cells.iter().filter(|cell| cell.ended.is_some()).count()
    }

    fn was_cancelled(&self) -> bool {
        matches!(&self.over, Some(Err(why)) if why == CANCELLED)
    }

    /// What a variation is set to, each with its unit.
    fn values(&self, variation: &Variation) -> Vec<(String, String)> {
        let told =
            |(path, choice): (&str, &crate::model::sweep::Choice)| (path.to_owned(), values::told(path, &choice.value));
        self.plan.paths().into_iter().zip(&variation.choices).map(told).collect()
    }

    /// The scenario of a cell, to be opened.
    fn scenario(&self, index: usize) -> Option<BatchRequest> {
        let scenario = self.plan.scenario(self.plan.variations.get(index)?).ok()?;
        Some(BatchRequest::Open(Box::new(scenario)))
    }
}

impl Cell {
    fn verdict(&self) -> Option<Verdict> {
        Some(match self.ended.as_ref()? {
            Ended::Done(measured, _) => {
                let known = Verdict::ALL.into_iter().find(|verdict| verdict.word() == measured.outcome);
                known.unwrap_or(Verdict::Failed)
            }
            Ended::Failed(_) | Ended::NotRun => Verdict::Failed,
        })
    }
}
