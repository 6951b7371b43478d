//! The grid's work beside the window: plans are checked, variations baked on all cores but one, and kept in memory or put into a folder.
//!
//! Each is baked by `batch::run`, as `surefoot batch` does it: the same bytes.

use super::wish::{Field, Job, Wrong};
use crate::bake::Base;
use crate::batch::record::{Measured, Record};
use crate::batch::run::{Ended, Place, Stopped, Wanted, run};
use crate::batch::{Plan, Variation};
use crate::disk::batch_results::Results;
use crate::disk::folder::{Folder, rig_file};
use crate::disk::{Failure, level, resolve};
use crate::model::scenario::GroundKind;
use crate::model::{Scenario, Surface};
use crate::picture::from_png;
use crate::rig::Rig;
use crate::studio::worker::{Reply, Wake, Worker};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A plan that was looked for, and of what; `None` where the planner broke down.
pub type Planned = (Option<Box<Job>>, Result<Arc<Plan>, Vec<Wrong>>);

/// What is to be baked.
#[derive(Clone)]
pub struct Order {
    /// Counts orders.
    pub number: u64,
    /// Of what.
    pub job: Job,
    /// Every variation.
    pub plan: Arc<Plan>,
    /// Into which folder; `None`: only to be seen.
    pub folder: Option<PathBuf>,
    /// Set, it ends soon.
    pub cancel: Arc<AtomicBool>,
}

/// What comes of an order.
pub enum Said {
    /// One variation ended: (order, its index).
    Cell(u64, usize, Box<Made>),
    /// The order is done, or not, and why.
    Over(u64, Result<Vec<PathBuf>, String>),
}

/// A variation that ended.
pub struct Made {
    /// How.
    pub ended: Ended,
    /// A small picture: width, height, RGBA.
    pub picture: Option<([usize; 2], Vec<u8>)>,
}

/// Plans in the background: the newest wins.
pub fn planner(wake: Wake) -> Worker<Box<Job>, Planned> {
    let work = |job: Box<Job>, reply: &Reply<Planned>, _: &dyn Fn() -> bool| {
        let planned = job.plan().map(Arc::new);
        reply.give((Some(job), planned));
    };
    Worker::start("grid plan", wake, work, |words| {
        let wrong = Wrong { field: Field::Whole, words: format!("planning broke down: {words}") };
        (None, Err(vec![wrong]))
    })
}

/// Bakes, one order after the other.
pub fn baker(wake: Wake) -> Worker<Order, Said> {
    let work = |order: Order, reply: &Reply<Said>, _: &dyn Fn() -> bool| {
        let over = match &order.folder {
            None => to_see(&order, reply).map(|()| Vec::new()),
            Some(folder) => to_folder(&order, folder, reply),
        };
        let words = |failure: Failure| match &failure.faults {
            Some(faults) => faults.lines().join("\n"),
            None => failure.message,
        };
        reply.give(Said::Over(order.number, over.map_err(words)));
    };
    let broke = |words| {
        Said::Over(u64::MAX, Err(format!("the batch broke down: {words}\n  help: this is a bug. Please report it")))
    };
    Worker::start("grid bake", wake, work, broke)
}

/// All cores but the window's.
fn jobs() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from).saturating_sub(1).max(1)
}

const CELLS: Wanted = Wanted { cells: true, pieces: false };

fn to_see(order: &Order, reply: &Reply<Said>) -> Result<(), Failure> {
    let Job { document, file, .. } = &order.job;
    let rig = Arc::new(resolve::rig(&document.rig)?.rig);
    // Base clips are told before anything runs.
    resolve::base(&rig, &document.scenario, file.as_deref(), &document.rig)?;
    let mut scenario = document.scenario.clone();
    let ground = level::lay(&mut scenario, file.as_deref())?.map(|level| level.surface);
    let ground = match &scenario.ground.kind {
        GroundKind::Mesh { file, .. } => ground.map(|surface| (file.clone(), surface)),
        _ => None,
    };
    let memory = Memory {
        ground,
        rig,
        rig_file: document.rig.clone(),
        scenario_file: file.clone(),
        cells: Mutex::default(),
        bases: Mutex::default(),
    };
    let place = Cancelled { place: &memory, cancel: &order.cancel };
    let (endings, stopped) =
        run(&order.plan, 0..order.plan.variations.len(), jobs(), CELLS, &place, &|variation, ended| {
            if was_cancelled(ended) {
                return;
            }
            let png = lock(&memory.cells).remove(&variation.number);
            let picture = png.and_then(|png| from_png(&png));
            let picture = picture.map(|image| ([image.width() as usize, image.height() as usize], image.into_raw()));
            let made = Made { ended: ended.clone(), picture };
            reply.give(Said::Cell(order.number, variation.number - 1, Box::new(made)));
        });
    not_cancelled(&endings, stopped)
}

/// One that had not begun when it was cancelled fails with that word.
fn not_cancelled(endings: &[Ended], stopped: Option<Stopped>) -> Result<(), Failure> {
    let cancelled = endings.iter().any(was_cancelled).then(|| CANCELLED.to_owned());
    stopped.map(|stopped| stopped.0).or(cancelled).map_or(Ok(()), |why| Err(Failure::failed(why)))
}

fn was_cancelled(ended: &Ended) -> bool {
    matches!(ended, Ended::Failed(why) if why == CANCELLED)
}

/// As `surefoot batch` does it: clips, records, manifest, sheet, coverage, helpers.
fn to_folder(order: &Order, dir: &Path, reply: &Reply<Said>) -> Result<Vec<PathBuf>, Failure> {
    let Job { document, file, .. } = &order.job;
    let (rig, loaded) = rig_file(&document.rig)?;
    resolve::base(&loaded, &document.scenario, file.as_deref(), &document.rig)?;
    level::lay(&mut document.scenario.clone(), file.as_deref())?;
    let scenario = file.clone().unwrap_or_else(|| PathBuf::from("scenario.toml"));
    let plan = &*order.plan;
    let folder = Folder::open(plan, vec![rig], vec![scenario], dir, (CELLS, false), Vec::new())?;
    folder.hold(0, loaded);
    let place = Cancelled { place: &folder, cancel: &order.cancel };
    let (endings, stopped) = run(plan, 0..plan.variations.len(), jobs(), CELLS, &place, &|variation, ended| {
        let made = Made { ended: ended.clone(), picture: None };
        reply.give(Said::Cell(order.number, variation.number - 1, Box::new(made)));
    });
    not_cancelled(&endings, stopped)?;
    let results = Results { plan, folder: &folder, output: dir, endings: &endings };
    let mut files = results.helpers(false)?;
    let alike = results.alike();
    files.extend(results.manifest(&alike, false)?.1);
    files.extend(results.sheet(&alike)?);
    files.extend(results.coverage(&alike)?);
    Ok(files)
}

/// One rig, its base clips, and small pictures until they are told.
struct Memory {
    rig: Arc<Rig>,
    rig_file: PathBuf,
    scenario_file: Option<PathBuf>,
    cells: Mutex<BTreeMap<usize, Vec<u8>>>,
    bases: Mutex<BTreeMap<String, Arc<Base>>>,
    /// The ground's mesh, by the file that the scenario names.
    ground: Option<(String, Arc<Surface>)>,
}

impl Place for Memory {
    fn rig(&self, _: usize) -> Result<Arc<Rig>, String> {
        Ok(Arc::clone(&self.rig))
    }

    fn base(&self, _: &Variation, rig: &Rig, scenario: &Scenario) -> Result<Option<Arc<Base>>, String> {
        let Some(base) = &scenario.base else { return Ok(None) };
        let key = format!("{base:?} {}", scenario.character.leg_scale);
        if let Some(held) = lock(&self.bases).get(&key) {
            return Ok(Some(Arc::clone(held)));
        }
        let found = resolve::base(rig, scenario, self.scenario_file.as_deref(), &self.rig_file);
        let found = found.map_err(|failure| failure.message)?.map(|(_, base)| base);
        lock(&self.bases).extend(found.iter().map(|base| (key.clone(), Arc::clone(base))));
        Ok(found)
    }

    fn lay(&self, _: &Variation, scenario: &mut Scenario) -> Result<(), String> {
        match (&self.ground, &scenario.ground.kind) {
            (Some((file, read)), GroundKind::Mesh { file: named, .. }) if file == named => scenario.ground.lay(read),
            _ => drop(level::lay(scenario, self.scenario_file.as_deref()).map_err(|failure| failure.message)?),
        }
        Ok(())
    }

    fn done(&self, _: &Variation) -> Option<Measured> {
        None
    }

    fn keep(&self, variation: &Variation, _: Vec<(String, Vec<u8>)>, record: Record) -> Result<(), Stopped> {
        lock(&self.cells).insert(variation.number, record.cell);
        Ok(())
    }
}

/// A place that takes nothing any more once it is cancelled.
struct Cancelled<'a> {
    place: &'a dyn Place,
    cancel: &'a AtomicBool,
}

/// What a cancelled batch says.
pub const CANCELLED: &str = "cancelled";

impl Place for Cancelled<'_> {
    fn rig(&self, index: usize) -> Result<Arc<Rig>, String> {
        self.place.rig(index)
    }

    fn base(&self, variation: &Variation, rig: &Rig, scenario: &Scenario) -> Result<Option<Arc<Base>>, String> {
        match self.cancel.load(Ordering::Relaxed) {
            true => Err(CANCELLED.into()),
            false => self.place.base(variation, rig, scenario),
        }
    }

    fn lay(&self, variation: &Variation, scenario: &mut Scenario) -> Result<(), String> {
        self.place.lay(variation, scenario)
    }

    fn done(&self, variation: &Variation) -> Option<Measured> {
        self.place.done(variation)
    }

    fn keep(&self, variation: &Variation, files: Vec<(String, Vec<u8>)>, record: Record) -> Result<(), Stopped> {
        match self.cancel.load(Ordering::Relaxed) {
            true => Err(Stopped(CANCELLED.into())),
            false => self.place.keep(variation, files, record),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
