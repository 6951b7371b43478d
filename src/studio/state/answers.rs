//! What the state does with the answers of its workers, and what it asks of them by itself: bakes of the newest document, copies of
//! unsaved work.

use super::{KEPT_EVERY, RESTS, State, told};
use crate::model::scenario_write::write;
use crate::studio::document::{Document, Edit};
use crate::studio::errands::{Done, Errand};
use crate::studio::home::Unsaved;
use crate::studio::simulate::{Answer, Question};
use std::sync::Arc;
use std::time::Instant;

impl State {
    /// Bakes the document if it is not what was asked last.
    pub(super) fn ask(&mut self) {
        if self.asked.as_ref() == Some(self.document()) {
            return;
        }
        let document = self.document().clone();
        self.faults = document.scenario.validate();
        self.asked = Some(document.clone());
        if self.selected.is_some_and(|place| document.entry(place).is_none()) {
            self.selected = None;
        }
        self.unchosen = None;
        if self.faults.is_empty() {
            self.edit += 1;
            self.bake.ask_only(Question { edit: self.edit, document, file: self.file.clone(), asked: Instant::now() });
        }
    }

    /// Asks whether the ragdoll does it better, once the person rests: that takes longer than a drag waits.
    pub(super) fn ask_ragdoll(&mut self) {
        let rested = self.unchosen.is_some_and(|came| came.elapsed() >= RESTS);
        let asked = self.asked.as_ref() == Some(self.document());
        if let Some(shown) =
            self.shown.as_ref().filter(|shown| rested && asked && shown.edit == self.edit && !shown.last)
        {
            self.choose.ask_only((self.document().clone(), shown.clone()));
            self.unchosen = None;
        }
    }

    pub(super) fn baked(&mut self, answer: Answer) {
        match answer {
            Answer::Rig(rig) => self.rig = Some(rig),
            Answer::Clip(shown) if shown.edit < self.shown.as_ref().map_or(0, |held| held.edit) => {}
            Answer::Clip(shown) => {
                self.failure = None;
                self.unchosen = (!shown.last).then(Instant::now);
                self.rig = Some(Arc::clone(&shown.rig));
                self.shown = Some(*shown);
                self.playback.time = self.playback.time.min(self.duration());
                if self.is_fresh()
                    && let Some(path) = self.export.take()
                {
                    self.export(path);
                }
            }
            Answer::Curves(edit, curves) => {
                if self.shown.as_ref().is_some_and(|shown| shown.edit == edit) {
                    self.curves = Some(curves);
                }
            }
            Answer::Failed(edit, failure) => {
                if edit >= self.edit && self.export.take().is_some() {
                    self.say_bad(format!("nothing was exported: {}", failure.message));
                }
                self.failure = Some(failure);
            }
        }
    }

    pub(super) fn done(&mut self, done: Done) {
        match done {
            Done::Opened(path, scenario) => {
                let known = self.remembered.recent.iter().find(|recent| recent.scenario == path);
                let rig = self.rig_for.take().or_else(|| known.map(|recent| recent.rig.clone()));
                let rig = rig.unwrap_or_else(|| self.document().rig.clone());
                self.begin(Document::of(rig, *scenario), Some(path));
                self.remember();
            }
            Done::Saved(path, scenario) => {
                self.say(format!("saved {}", path.display()));
                self.file = Some(path);
                self.history.saved(&scenario);
                self.remember();
                if let Some(then) = self.then.take() {
                    self.carry_out(then);
                }
            }
            Done::Exported(paths, warnings) => {
                let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
                self.say(format!("exported {}", names.join(", ")));
                warnings.into_iter().for_each(|warning| self.say(format!("warning: {warning}")));
            }
            Done::Bones(path) => {
                self.say(format!("wrote {}", path.display()));
                self.history.apply(Edit::Bones(Default::default()), false);
            }
            Done::Listed(folder, entries) => self.listing = Some((folder, entries)),
            Done::Woke(remembered, crashed) => {
                let first = !remembered.knows_it;
                self.remembered = *remembered;
                self.crashed = crashed;
                if first {
                    self.remembered.knows_it = true;
                    self.files.ask(Errand::Remember(Box::new(self.remembered.clone())));
                }
            }
            Done::Failed(what, failure) => {
                self.then = None;
                self.rig_for = None;
                self.say_bad(format!("could not {what}: {}", told(&failure)));
            }
        }
    }

    /// Keeps a copy of unsaved work, a second after the last one at the latest.
    pub(super) fn keep(&mut self) {
        let due = self.kept.as_ref().is_none_or(|(kept, at)| kept != self.document() && at.elapsed() >= KEPT_EVERY);
        if !due || self.closing {
            return;
        }
        let document = self.document().clone();
        let unsaved = self.history.is_unsaved().then(|| {
            let (file, rig) = (self.file.clone(), document.rig.clone());
            Box::new(Unsaved { text: write(&document.scenario), file, rig })
        });
        self.files.ask(Errand::Keep(unsaved));
        self.kept = Some((document, Instant::now()));
    }
}
