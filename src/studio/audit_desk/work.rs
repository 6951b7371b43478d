//! The desk's work beside the window: a clip file opened, audited, corrected, saved.
//!
//! One thread that keeps the file that is open. Every answer names the opening that it belongs to, so that answers about an earlier file
//! are known as such.

use super::repairs::meet;
use super::shown::{After, Motion};
use super::skinned::Skinned;
use crate::correct::{CorrectOptions, Done, Target};
use crate::disk::correction::{Clip, Opened};
use crate::disk::writer::{self, Output};
use crate::disk::{Failure, resolve};
use crate::mocap::{Options, Reading};
use crate::rig::Rig;
use crate::studio::worker::{Reply, Wake, Worker};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Corrections with one part of them left out at most, until only what was accepted is left.
const TRIES: usize = 8;

/// Something to do, for the file of an opening.
#[derive(Clone, Debug)]
pub struct Question {
    /// Counts files that were opened.
    pub opening: u64,
    /// What.
    pub ask: Ask,
}

/// What to do.
#[derive(Clone, Debug)]
pub enum Ask {
    /// Open a file.
    Open(PathBuf),
    /// Read and audit a clip of it.
    Choose(usize),
    /// Correct a clip, but for these flags; corrections are counted.
    Correct(usize, u64, Vec<Target>),
    /// The mesh of a clip's file.
    Mesh(usize),
    /// Write the file with what was accepted.
    Save(PathBuf, Vec<Wanted>),
}

/// What of a clip is written.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Which of the file's.
    pub clip: usize,
    /// Flags whose repairs are.
    pub accepted: Vec<Target>,
    /// Flags whose repairs were seen and are not.
    pub leave: Vec<Target>,
}

/// What came of it.
pub struct Answer {
    /// Of the question.
    pub opening: u64,
    /// What.
    pub said: Said,
}

/// What came of it.
pub enum Said {
    /// The file is open: names of its clips.
    Opened(Vec<String>),
    /// A clip as it is.
    Read(usize, Box<Motion>),
    /// A correction of that number, and what was done.
    Corrected(u64, Box<After>, Vec<Done>),
    /// The mesh of a clip's file.
    Mesh(usize, Arc<Skinned>),
    /// It is on the disk: repairs that were written.
    Saved(PathBuf, usize),
    /// Not done: what, and why.
    Failed(&'static str, Failure),
}

/// The file that is open.
#[derive(Default)]
struct Desk {
    file: Option<(PathBuf, Opened)>,
    reading: Option<(usize, Reading)>,
    rig: Option<Arc<Rig>>,
}

/// Starts the worker.
pub fn start(wake: Wake) -> Worker<Question, Answer> {
    let mut desk = Desk::default();
    let mut at = 0;
    let working_on = Arc::new(std::sync::atomic::AtomicU64::new(0));
    let broken_at = Arc::clone(&working_on);
    let work = move |question: Question, reply: &Reply<Answer>, _: &dyn Fn() -> bool| {
        working_on.store(question.opening, std::sync::atomic::Ordering::Relaxed);
        if question.opening != at {
            (desk, at) = (Desk::default(), question.opening);
        }
        let what = name(&question.ask);
        let said = match desk.run(question.ask) {
            Ok(said) => said,
            Err(failure) => Some(Said::Failed(what, failure)),
        };
        if let Some(said) = said {
            reply.give(Answer { opening: at, said });
        }
    };
    let broke = move |words: String| {
        let failure = Failure::failed(format!("{words}\n  help: this is a bug. Please report it"));
        let opening = broken_at.load(std::sync::atomic::Ordering::Relaxed);
        Answer { opening, said: Said::Failed("work on the clip", failure) }
    };
    Worker::start("audit", wake, work, broke)
}

fn name(ask: &Ask) -> &'static str {
    match ask {
        Ask::Open(_) => "open",
        Ask::Choose(_) => "read the clip",
        Ask::Correct(..) => "correct the clip",
        Ask::Mesh(_) => "show the character",
        Ask::Save(..) => "save",
    }
}

impl Desk {
    fn run(&mut self, ask: Ask) -> Result<Option<Said>, Failure> {
        Ok(match ask {
            Ask::Open(path) => {
                let file = Opened::open(&path, &Options::default())?;
                let clips = file.clips().to_vec();
                self.file = Some((path, file));
                Some(Said::Opened(clips))
            }
            Ask::Choose(clip) => {
                let reading = self.opened()?.1.reading(clip)?;
                let motion = Motion::audited(Arc::new(reading.capture.clone()));
                self.reading = Some((clip, reading));
                if motion.rows.is_empty() {
                    return Err(Failure::bad_input("the clip has no frames\n  help: choose another clip"));
                }
                Some(Said::Read(clip, Box::new(motion)))
            }
            Ask::Correct(clip, run, leave) => {
                let settings = CorrectOptions { leave, ..CorrectOptions::default() };
                let made = self.opened()?.1.correct_reading(clip, self.reading(clip)?, &settings)?;
                let (edits, done) = (Arc::new(made.edits().clone()), made.corrected.done.clone());
                Some(Said::Corrected(run, Box::new(After::of(made.corrected, edits)), done))
            }
            Ask::Mesh(clip) => self.mesh(clip)?.map(|skinned| Said::Mesh(clip, skinned)),
            Ask::Save(output, wanted) => Some(self.save(output, &wanted)?),
        })
    }

    fn opened(&self) -> Result<&(PathBuf, Opened), Failure> {
        self.file.as_ref().ok_or_else(|| Failure::bad_input("no clip is open\n  help: open one first"))
    }

    fn reading(&self, clip: usize) -> Result<Reading, Failure> {
        match &self.reading {
            Some((index, reading)) if *index == clip => Ok(reading.clone()),
            _ => self.opened()?.1.reading(clip),
        }
    }

    /// A file without a mesh, or one that is no rig, is shown as a body of capsules.
    fn mesh(&mut self, clip: usize) -> Result<Option<Arc<Skinned>>, Failure> {
        let path = self.opened()?.0.clone();
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        if !["glb", "gltf", "vrm"].contains(&ending.as_str()) {
            return Ok(None);
        }
        if self.rig.is_none() {
            self.rig = resolve::rig(&path).ok().map(|loaded| Arc::new(loaded.rig));
        }
        let Some(rig) = self.rig.clone() else { return Ok(None) };
        let reading = self.reading(clip)?;
        Ok(Skinned::of(rig, clip, &reading).map(Arc::new))
    }

    fn save(&self, output: PathBuf, wanted: &[Wanted]) -> Result<Said, Failure> {
        let (path, file) = self.opened()?;
        let inputs = [path.clone(), path.with_extension("bones.toml")];
        writer::check(&[&output], &inputs)?;
        check_ending(file, &output)?;
        let clips: Vec<Clip> = wanted.iter().map(|wanted| self.only_accepted(wanted)).collect::<Result<_, _>>()?;
        let repairs = clips.iter().map(|clip| clip.corrected.done.len()).sum();
        let bytes = file.bytes(&clips, &output)?;
        writer::write(&[Output { path: output.clone(), bytes }], &inputs)?;
        Ok(Said::Saved(output, repairs))
    }

    /// A clip with the repairs that were accepted and no other: leaving flags out may let others come up.
    fn only_accepted(&self, wanted: &Wanted) -> Result<Clip, Failure> {
        let (_, file) = self.opened()?;
        let mut leave = wanted.leave.clone();
        for _ in 0..TRIES {
            let settings = CorrectOptions { leave: leave.clone(), ..CorrectOptions::default() };
            let clip = file.correct_reading(wanted.clip, self.reading(wanted.clip)?, &settings)?;
            let others = clip.corrected.done.iter().filter(|done| !meet(&done.answers, &wanted.accepted));
            let others: Vec<Target> = others.flat_map(|done| done.answers.iter().copied()).collect();
            if others.is_empty() {
                return Ok(clip);
            }
            leave.extend(others);
        }
        Err(Failure::failed(
            "the corrections that were accepted cannot be had without others\n  help: accept their neighbours too",
        ))
    }
}

/// In the words of a window: there is no `-o` here.
fn check_ending(file: &Opened, output: &Path) -> Result<(), Failure> {
    file.check_ending(output).map_err(|failure| {
        let message = failure.message.replace("let the name behind -o end in", "choose a name that ends in");
        Failure { message, ..failure }
    })
}
