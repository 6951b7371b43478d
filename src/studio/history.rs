//! Undo and redo: documents as they were. A drag, which is many edits, is one step back.

use super::document::{Document, Edit};
use crate::model::Scenario;

/// Steps that are kept.
const MOST_STEPS: usize = 2000;

/// A document with its past.
#[derive(Clone, Debug)]
pub struct History {
    now: Document,
    past: Vec<(Document, &'static str)>,
    future: Vec<(Document, &'static str)>,
    /// A drag that goes on.
    open: bool,
    /// What the file on the disk holds; `None`: there is none, or an older one.
    saved: Option<Scenario>,
}

impl History {
    /// Begins with a document that is on the disk, or new.
    pub fn new(document: Document) -> History {
        History {
            saved: Some(document.scenario.clone()),
            now: document,
            past: Vec::new(),
            future: Vec::new(),
            open: false,
        }
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.now
    }

    /// Changes it, in one step with the edits of the same drag before. An edit that changes nothing is no step.
    pub fn apply(&mut self, edit: Edit, dragging: bool) {
        let what = name(&edit);
        let mut next = self.now.clone();
        next.apply(edit);
        if next == self.now {
            return;
        }
        if !(self.open && dragging) {
            self.past.push((self.now.clone(), what));
            if self.past.len() > MOST_STEPS {
                self.past.remove(0);
            }
        }
        self.future.clear();
        self.now = next;
        self.open = dragging;
    }

    /// The drag is over.
    pub fn release(&mut self) {
        self.open = false;
    }

    /// One step back.
    pub fn undo(&mut self) {
        self.open = false;
        if let Some((before, what)) = self.past.pop() {
            self.future.push((std::mem::replace(&mut self.now, before), what));
        }
    }

    /// One step on again.
    pub fn redo(&mut self) {
        self.open = false;
        if let Some((after, what)) = self.future.pop() {
            self.past.push((std::mem::replace(&mut self.now, after), what));
        }
    }

    /// What a step back takes back.
    pub fn undoes(&self) -> Option<&'static str> {
        self.past.last().map(|(_, what)| *what)
    }

    /// What a step on does again.
    pub fn redoes(&self) -> Option<&'static str> {
        self.future.last().map(|(_, what)| *what)
    }

    /// The disk holds that scenario now.
    pub fn saved(&mut self, scenario: &Scenario) {
        self.saved = Some(scenario.clone());
    }

    /// The disk does not hold it.
    pub fn never_saved(&mut self) {
        self.saved = None;
    }

    /// Whether the disk holds another scenario. Rig and bake settings are no part of its file.
    pub fn is_unsaved(&self) -> bool {
        self.saved.as_ref() != Some(&self.now.scenario)
    }
}

/// What an edit does, for a menu.
fn name(edit: &Edit) -> &'static str {
    match edit {
        Edit::Rig(_) => "change the rig",
        Edit::Bones(_) => "change the bones",
        Edit::Title(_) => "change the title",
        Edit::Duration(_) => "change the duration",
        Edit::Seed(_) => "change the seed",
        Edit::Character(_) => "change the character",
        Edit::Ground(_) => "change the ground",
        Edit::Stepper(_) => "change the stepper",
        Edit::Base(_) => "change the base clip",
        Edit::Add(_) => "add an entry",
        Edit::Replace(..) => "change an entry",
        Edit::Remove(_) => "remove an entry",
        Edit::Scenario(_) => "change the scenario",
        Edit::Markers(_) => "change the markers",
        Edit::Bake(_) => "change how it is baked",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::seed::Seed;
    use crate::model::scenario_write::write;
    use crate::studio::document::{Lane, Place};

    fn random(draw: &mut Seed, document: &Document) -> Edit {
        let lane = Lane::ALL[(draw.unit() * 8.0) as usize];
        let entries = document.entries(lane);
        let place = Place { lane, index: (draw.unit() * (entries.len() + 1) as f64) as usize };
        let time = (draw.unit() * 400.0).round() / 100.0;
        match (draw.unit() * 7.0) as usize {
            0 | 1 => Edit::Add(lane.entry(time)),
            2 => Edit::Remove(place),
            3 => Edit::Replace(place, document.entry(place).unwrap_or_else(|| lane.entry(time)).moved(time)),
            4 => Edit::Replace(place, document.entry(place).unwrap_or_else(|| lane.entry(time)).stretched(time + 0.5)),
            5 => Edit::Duration(time + 1.0),
            _ => Edit::Title(format!("edit {time}")),
        }
    }

    #[test]
    fn a_thousand_edits_undone_give_the_first_document_back_and_redone_the_last() {
        let mut history = History::new(Document::demo());
        let first = write(&history.document().scenario);
        let mut draw = Seed::new(11);
        let mut steps = 0;
        while steps < 1000 {
            let before = history.past.len();
            let edit = random(&mut draw, history.document());
            history.apply(edit, draw.unit() < 0.3);
            steps += 1;
            if draw.unit() < 0.1 {
                history.undo();
                history.redo();
            }
            assert!(history.past.len() <= before + 1);
        }
        let last = history.document().clone();
        assert!(history.past.len() > 300 && last != Document::demo());
        while history.undoes().is_some() {
            history.undo();
        }
        assert_eq!(write(&history.document().scenario), first);
        assert_eq!(*history.document(), Document::demo());
        while history.redoes().is_some() {
            history.redo();
        }
        assert_eq!(*history.document(), last);
    }

    #[test]
    fn a_drag_is_one_step_and_nothing_is_none() {
        let mut history = History::new(Document::demo());
        for tenth in 1..=9 {
            let place = Place { lane: Lane::Push, index: 0 };
            let entry = history.document().entry(place).expect("the demo's push");
            history.apply(Edit::Replace(place, entry.moved(f64::from(tenth) / 10.0)), true);
        }
        history.release();
        assert_eq!(history.document().scenario.push[0].start, 0.9);
        history.apply(Edit::Duration(4.0), false);
        history.undo();
        assert_eq!(*history.document(), Document::demo());
        assert!(!history.is_unsaved() && history.undoes().is_none());
    }
}
