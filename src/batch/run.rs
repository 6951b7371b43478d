//! Bakes the variations of a plan on several threads, in the order of the plan, each exactly as `bake` alone would.
//!
//! Where rigs come from and where results go is the caller's [`Place`]: no file is touched here. One variation that fails, or breaks
//! down, is told with its cause and the rest goes on; a place that takes nothing any more stops them all. Results come in the plan's
//! order, whatever the number of threads.

use super::record::{Measured, Piece, Record, hash, measured};
use super::{Plan, Variation};
use crate::bake::{self, BakeOptions, Baked, Base, Curves, Drive, Helped, RootMotion};
use crate::export::engine::Engine;
use crate::export::{self, Exported, Form};
use crate::model::Scenario;
use crate::model::sweep::BakeSettings;
use crate::ragdoll::control::Assist;
use crate::rig::Rig;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Where rigs come from and results go. Called from several threads at once.
pub trait Place: Sync {
    /// A rig of the sweep.
    fn rig(&self, index: usize) -> Result<Arc<Rig>, String>;
    /// The base clip of a scenario on that rig, where it has one.
    fn base(&self, variation: &Variation, rig: &Rig, scenario: &Scenario) -> Result<Option<Arc<Base>>, String>;
    /// Lays the triangles of a scenario's ground into it, where it is a mesh.
    fn lay(&self, variation: &Variation, scenario: &mut Scenario) -> Result<(), String>;
    /// What came of a variation that is done already.
    fn done(&self, variation: &Variation) -> Option<Measured>;
    /// Makes room for what was made of a variation; the record's identity and files are the place's to fill in.
    fn keep(&self, variation: &Variation, files: Vec<(String, Vec<u8>)>, record: Record) -> Result<(), Stopped>;
}

/// The work cannot go on: disk, folder, interrupt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stopped(pub String);

/// Beside the clips themselves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    /// A small contact sheet of each.
    pub cells: bool,
    /// No file a clip, but what a merged file is made from.
    pub pieces: bool,
}

/// How a variation ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// Its clip is there; whether it was there before.
    Done(Box<Measured>, bool),
    /// There is no clip, and why.
    Failed(String),
    /// The batch was stopped before it.
    NotRun,
}

/// Runs those of a plan. `tell` hears of each as it ends. `Err` is why the batch was stopped; the endings are what there is.
pub fn run(
    plan: &Plan,
    range: Range<usize>,
    jobs: usize,
    wanted: Wanted,
    place: &dyn Place,
    tell: &(dyn Fn(&Variation, &Ended) + Sync),
) -> (Vec<Ended>, Option<Stopped>) {
    let variations = &plan.variations[range];
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    let stopped: Mutex<Option<Stopped>> = Mutex::new(None);
    let endings: Vec<Mutex<Ended>> = variations.iter().map(|_| Mutex::new(Ended::NotRun)).collect();
    let work = || {
        let mut held: Option<(usize, Arc<Rig>)> = None;
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(variation) = variations.get(index).filter(|_| !stop.load(Ordering::Relaxed)) else { return };
            let ended = match one(plan, variation, wanted, place, &mut held) {
                Ok(ended) => ended,
                Err(why) => {
                    stop.store(true, Ordering::Relaxed);
                    stopped.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(why);
                    return;
                }
            };
            tell(variation, &ended);
            *endings[index].lock().unwrap_or_else(PoisonError::into_inner) = ended;
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, variations.len().max(1)) {
            scope.spawn(work);
        }
    });
    let endings = endings.into_iter().map(|ended| ended.into_inner().unwrap_or_else(PoisonError::into_inner)).collect();
    (endings, stopped.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// A panic, which would be a bug, is that variation's alone.
fn one(
    plan: &Plan,
    variation: &Variation,
    wanted: Wanted,
    place: &dyn Place,
    held: &mut Option<(usize, Arc<Rig>)>,
) -> Result<Ended, Stopped> {
    if let Some(measured) = place.done(variation) {
        return Ok(Ended::Done(Box::new(measured), true));
    }
    let made = catch_unwind(AssertUnwindSafe(|| make(plan, variation, wanted, place, held)));
    let (files, record) = match made {
        Ok(Ok(made)) => made,
        Ok(Err(why)) => return Ok(Ended::Failed(why)),
        Err(_) => {
            *held = None;
            return Ok(Ended::Failed(
                "surefoot broke down on it: this is a bug. Please report it with the sweep".into(),
            ));
        }
    };
    let measured = record.measured.clone();
    place.keep(variation, files, record)?;
    Ok(Ended::Done(Box::new(measured), false))
}

type Made = (Vec<(String, Vec<u8>)>, Record);

fn make(
    plan: &Plan,
    variation: &Variation,
    wanted: Wanted,
    place: &dyn Place,
    held: &mut Option<(usize, Arc<Rig>)>,
) -> Result<Made, String> {
    let rig = match held.take().filter(|(index, _)| *index == variation.rig) {
        Some((_, rig)) => rig,
        None => place.rig(variation.rig)?,
    };
    *held = Some((variation.rig, Arc::clone(&rig)));
    let mut scenario = plan.scenario(variation)?;
    place.lay(variation, &mut scenario)?;
    let base = place.base(variation, &rig, &scenario)?;
    let settings = &plan.sweep.bake;
    let baked =
        bake::bake(&rig, &scenario, &options(settings, &variation.name, base)).map_err(|error| error.to_string())?;
    let exported = export::baked(&rig, &baked, form(settings)).map_err(|error| error.to_string())?;
    Ok(kept(&rig, baked, exported, settings, wanted))
}

fn kept(rig: &Rig, baked: Baked, exported: Exported, settings: &BakeSettings, wanted: Wanted) -> Made {
    let mut measured = measured(&baked, &exported);
    measured.hash = hash(&exported.file);
    let cell = if wanted.cells { super::pictures::cell(rig, &baked) } else { Vec::new() };
    let signature = super::pictures::signature(&baked);
    let mut files = Vec::new();
    let piece = if wanted.pieces {
        let report = serde_json::to_string(&baked.report).unwrap_or_default();
        Some(Piece { clip: baked.clip, report })
    } else {
        files.push((settings.format.ending().to_owned(), exported.file));
        files.push(("events.json".to_owned(), exported.events));
        None
    };
    (files, Record { identity: String::new(), files: Vec::new(), measured, signature, cell, piece })
}

/// Which files are made.
pub fn form(settings: &BakeSettings) -> Form {
    Form {
        kind: settings.format,
        props: settings.props && settings.format.without_props().is_none(),
        root_joint: root_joint(settings),
        only_animation: settings.only_animation,
        no_contact_nodes: !settings.contact_nodes,
    }
}

/// Whether an engine wants the root as a joint of the skins.
fn root_joint(settings: &BakeSettings) -> bool {
    settings.root == "root" && engines(settings).any(|engine| engine.root_is_joint)
}

/// Those whose helper is wanted.
pub fn engines(settings: &BakeSettings) -> impl Iterator<Item = &'static Engine> {
    settings.engines.iter().filter_map(|name| Engine::named(name))
}

/// As the flags of `surefoot bake`.
pub fn options(settings: &BakeSettings, name: &str, base: Option<Arc<Base>>) -> BakeOptions {
    let helped = match settings.assist {
        None => Helped::Auto,
        Some([torque, force]) => Helped::Within(Assist { torque, force }),
    };
    BakeOptions {
        name: Some(name.to_owned()),
        fps: settings.fps,
        seed: None,
        root: match settings.root {
            "hips" => RootMotion::Hips,
            "in-place" => RootMotion::InPlace,
            _ => RootMotion::Root,
        },
        effort: BakeOptions::default().effort,
        drive: match settings.drive {
            "stepper" => Drive::Stepper,
            "ragdoll" => Drive::Ragdoll(helped),
            _ => Drive::Auto(helped),
        },
        base,
        looped: settings.looped,
        curves: if settings.curves == "spline" { Curves::Spline } else { Curves::Linear },
    }
}

#[cfg(test)]
mod tests {
    use crate::export::engine::ENGINES;
    use crate::model::sweep;

    #[test]
    fn a_sweep_knows_every_engine_by_name() {
        assert_eq!(sweep::ENGINES, ENGINES.each_ref().map(|engine| engine.name));
    }
}
