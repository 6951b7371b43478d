//! The document's reaction, baked beside the window: the newest edit wins, and what was there stays until the next is done.
//!
//! Only scenarios without faults are asked for. Where the drive is left to the tool the stepper's clip is shown at once; whether the ragdoll
//! does it better is another worker's question, asked when the person rests.

use super::document::Document;
use super::plots::{Series, series};
use super::viewport::Tracks;
use super::worker::{Reply, Wake, Worker};
use crate::bake::auto::choose;
use crate::bake::{self, Baked, Base, Drive};
use crate::batch::run::options;
use crate::disk::level::{self, Level};
use crate::disk::{Failure, resolve};
use crate::model::sweep::BakeSettings;
use crate::model::{Role, Scenario, Surface};
use crate::rig::Rig;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

/// What is to be baked.
#[derive(Clone, Debug)]
pub struct Question {
    /// Counts edits.
    pub edit: u64,
    /// The document.
    pub document: Document,
    /// Where its scenario lies: base clips are named from there.
    pub file: Option<PathBuf>,
    /// s, when it was asked.
    pub asked: Instant,
}

/// A clip to be shown.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Of which edit.
    pub edit: u64,
    /// On which rig.
    pub rig: Arc<Rig>,
    /// Every file that was read for it.
    pub files: Vec<PathBuf>,
    /// The clip under the reaction.
    pub base: Option<Arc<Base>>,
    /// The ground's triangles, where it is a mesh.
    pub ground: Option<Arc<Surface>>,
    /// The clip and all that is known of it.
    pub baked: Arc<Baked>,
    /// What is known of its balance at any time.
    pub tracks: Arc<Tracks>,
    /// No better one comes.
    pub last: bool,
    /// From the question to here.
    pub took: Duration,
}

/// What a bake says.
#[derive(Clone, Debug)]
pub enum Answer {
    /// The rig is there: its bones can be looked at before the clip is baked.
    Rig(Arc<Rig>),
    /// A clip.
    Clip(Box<Shown>),
    /// The curves of an edit's clip.
    Curves(u64, Arc<Series>),
    /// There is none, and why.
    Failed(u64, Failure),
}

/// The worker's own: what it need not do twice.
#[derive(Default)]
struct Kept {
    rig: Option<HeldRig>,
    base: Option<(String, PathBuf, Arc<Base>)>,
    ground: Option<(PathBuf, Option<SystemTime>, Level)>,
}

/// As [`Document::bones`].
type Bones = BTreeMap<Role, Option<usize>>;

struct HeldRig {
    path: PathBuf,
    /// When the file and its overrides were written.
    at: [Option<SystemTime>; 2],
    bones: Bones,
    rig: Arc<Rig>,
    files: Vec<PathBuf>,
}

/// Starts the worker that answers at once: with the stepper's clip where the drive is left to the tool.
pub fn start(wake: Wake) -> Worker<Question, Answer> {
    let mut kept = Kept::default();
    let pool = rayon::ThreadPoolBuilder::new().thread_name(|index| format!("bake {index}")).build().ok();
    let work = move |question: Question, reply: &Reply<Answer>, _: &dyn Fn() -> bool| {
        let mut answer = || match kept.answer(&question, reply) {
            Ok(shown) => {
                let curves = series(&shown.baked, &question.document.scenario, &shown.rig);
                reply.give(Answer::Clip(Box::new(shown)));
                reply.give(Answer::Curves(question.edit, Arc::new(curves)));
            }
            Err(failure) => reply.give(Answer::Failed(question.edit, failure)),
        };
        // In a pool the poses of one clip are shared out to the cores.
        match &pool {
            Some(pool) => pool.install(&mut answer),
            None => answer(),
        }
    };
    Worker::start("bake", wake, work, broke)
}

/// Starts the worker that looks whether the ragdoll does it better than a clip that is shown.
pub fn start_choosing(wake: Wake) -> Worker<(Document, Shown), Answer> {
    let work = |(document, shown): (Document, Shown), reply: &Reply<Answer>, _: &dyn Fn() -> bool| {
        let Document { mut scenario, bake, .. } = document;
        shown.ground.iter().for_each(|read| scenario.ground.lay(read));
        let (scenario, bake) = (&scenario, &bake);
        let options = options(bake, &shown.baked.clip.name, shown.base.clone());
        let Drive::Auto(helped) = options.drive else { return };
        let stepper = Baked::clone(&shown.baked);
        let chosen = Arc::new(choose(stepper, &shown.rig, scenario, &options, helped));
        let tracks = Arc::new(Tracks::new(&chosen));
        let curves = series(&chosen, scenario, &shown.rig);
        let edit = shown.edit;
        reply.give(Answer::Clip(Box::new(Shown { baked: chosen, tracks, last: true, ..shown })));
        reply.give(Answer::Curves(edit, Arc::new(curves)));
    };
    Worker::start("choose", wake, work, broke)
}

fn broke(words: String) -> Answer {
    let message =
        format!("the simulation broke down: {words}\n  help: this is a bug. Undo goes back; please report it");
    Answer::Failed(u64::MAX, Failure::failed(message))
}

impl Kept {
    fn answer(&mut self, question: &Question, reply: &Reply<Answer>) -> Result<Shown, Failure> {
        let Document { rig, bones, scenario, bake } = &question.document;
        let mut scenario = scenario.clone();
        let (rig, mut files) = self.rig(rig, bones)?;
        reply.give(Answer::Rig(Arc::clone(&rig)));
        let base = self.base(&rig, question)?;
        files.extend(base.as_ref().map(|(file, _)| file.clone()));
        let base = base.map(|(_, base)| base);
        files.extend(self.ground(&mut scenario, question.file.as_deref())?);
        let name = bake::safe_name(&scenario.title);
        let at_once = if bake.drive == "auto" { "stepper" } else { bake.drive };
        let settings = BakeSettings { drive: at_once, ..bake.clone() };
        let baked = bake::bake(&rig, &scenario, &options(&settings, &name, base.clone()));
        let baked = Arc::new(baked.map_err(|error| Failure::failed(error.to_string()))?);
        let tracks = Arc::new(Tracks::new(&baked));
        let (last, took) = (bake.drive != "auto", question.asked.elapsed());
        let ground = scenario.ground.surface().cloned();
        Ok(Shown { edit: question.edit, rig, files, base, ground, baked, tracks, last, took })
    }

    fn rig(&mut self, path: &Path, bones: &Bones) -> Result<(Arc<Rig>, Vec<PathBuf>), Failure> {
        let overrides = path.with_extension("bones.toml");
        let at = [path, &overrides].map(|file| std::fs::metadata(file).and_then(|there| there.modified()).ok());
        if let Some(held) = self.rig.as_ref().filter(|held| held.path == path && held.at == at && held.bones == *bones)
        {
            return Ok((Arc::clone(&held.rig), held.files.clone()));
        }
        let loaded = resolve::rig_with(path, bones)?;
        let (rig, files) = (Arc::new(loaded.rig), loaded.files);
        self.rig = Some(HeldRig {
            path: path.to_owned(),
            at,
            bones: bones.clone(),
            rig: Arc::clone(&rig),
            files: files.clone(),
        });
        self.base = None;
        Ok((rig, files))
    }

    /// Lays the ground's mesh into the scenario, read again where its file was written since; its files.
    fn ground(&mut self, scenario: &mut Scenario, file: Option<&Path>) -> Result<Vec<PathBuf>, Failure> {
        let Some(path) = level::level_file(scenario, file) else { return Ok(Vec::new()) };
        let at = std::fs::metadata(&path).and_then(|there| there.modified()).ok();
        if self.ground.as_ref().is_none_or(|(held, written, _)| *held != path || *written != at || at.is_none()) {
            self.ground = Some((path.clone(), at, level::read(&path)?));
        }
        let Some((_, _, read)) = &self.ground else { return Ok(Vec::new()) };
        level::put(scenario, &read.surface, &path)?;
        Ok(read.files.clone())
    }

    fn base(&mut self, rig: &Rig, question: &Question) -> Result<Option<(PathBuf, Arc<Base>)>, Failure> {
        let scenario = &question.document.scenario;
        let Some(base) = &scenario.base else { return Ok(None) };
        let key = format!("{base:?} {:?} {:?}", scenario.character, question.file);
        if let Some((_, file, base)) = self.base.as_ref().filter(|(held, ..)| *held == key) {
            return Ok(Some((file.clone(), Arc::clone(base))));
        }
        let found = resolve::base(rig, scenario, question.file.as_deref(), &question.document.rig)?;
        self.base = found.map(|(file, base)| (key, file, base));
        Ok(self.base.as_ref().map(|(_, file, base)| (file.clone(), Arc::clone(base))))
    }
}
