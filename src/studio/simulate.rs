//! The document's reaction, baked beside the window: the newest edit wins, and what was there stays until the next is done.
//!
//! Only scenarios without faults are asked for. Where the drive is left to the tool the stepper's clip is shown first, and the chosen one
//! when it is there.

use super::document::Document;
use super::plots::{Series, series};
use super::viewport::Tracks;
use super::worker::{Reply, Wake, Worker};
use crate::bake::{self, Baked, Base};
use crate::batch::run::options;
use crate::disk::{Failure, resolve};
use crate::model::Role;
use crate::model::sweep::BakeSettings;
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

/// Starts the worker.
pub fn start(wake: Wake) -> Worker<Question, Answer> {
    let mut kept = Kept::default();
    let work = move |question: Question, reply: &Reply<Answer>, stale: &dyn Fn() -> bool| {
        if let Err(failure) = answer(&mut kept, &question, reply, stale) {
            reply.give(Answer::Failed(question.edit, failure));
        }
    };
    let broke = |words: String| {
        let message =
            format!("the simulation broke down: {words}\n  help: this is a bug. Undo goes back; please report it");
        Answer::Failed(u64::MAX, Failure::failed(message))
    };
    Worker::start("bake", wake, work, broke)
}

fn answer(
    kept: &mut Kept,
    question: &Question,
    reply: &Reply<Answer>,
    stale: &dyn Fn() -> bool,
) -> Result<(), Failure> {
    let Document { rig, bones, scenario, bake } = &question.document;
    let (loaded, mut files) = kept.rig(rig, bones)?;
    reply.give(Answer::Rig(Arc::clone(&loaded)));
    let base = kept.base(&loaded, question)?;
    files.extend(base.as_ref().map(|(file, _)| file.clone()));
    let name = bake::safe_name(&scenario.title);
    let give = |settings: &BakeSettings, last: bool| -> Result<Arc<Baked>, Failure> {
        let base = base.as_ref().map(|(_, base)| Arc::clone(base));
        let baked = bake::bake(&loaded, scenario, &options(settings, &name, base));
        let baked = Arc::new(baked.map_err(|error| Failure::failed(error.to_string()))?);
        let tracks = Arc::new(Tracks::new(&baked));
        let (rig, files, took) = (Arc::clone(&loaded), files.clone(), question.asked.elapsed());
        let shown = Shown { edit: question.edit, rig, files, baked: Arc::clone(&baked), tracks, last, took };
        reply.give(Answer::Clip(Box::new(shown)));
        Ok(baked)
    };
    if bake.drive == "auto" {
        give(&BakeSettings { drive: "stepper", ..bake.clone() }, false)?;
        if stale() {
            return Ok(());
        }
    }
    let baked = give(bake, true)?;
    if !stale() {
        reply.give(Answer::Curves(question.edit, Arc::new(series(&baked, scenario, &loaded))));
    }
    Ok(())
}

impl Kept {
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
