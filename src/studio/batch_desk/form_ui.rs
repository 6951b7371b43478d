//! What varies, the buttons and how far the work is: the top of the desk.

use super::wish::{Axis, Field, MOST_CELLS, SweepToSave, Wrong};
use super::{BatchDesk, BatchRequest, values};
use crate::model::Scenario;
use crate::studio::document::Document;
use eframe::egui::{self, Button, ComboBox, DragValue, ProgressBar, RichText, TextEdit, Ui};

/// Seeds of each at most.
const MOST_SEEDS: u32 = 50;

impl BatchDesk {
    pub(super) fn form_ui(&mut self, ui: &mut Ui, document: &Document, requests: &mut Vec<BatchRequest>) {
        let wrong: Vec<Wrong> = match self.newest() {
            Some(Err(wrong)) => wrong.clone(),
            _ => Vec::new(),
        };
        let Some(wish) = &mut self.wish else { return };
        ui.add_space(4.0);
        let paths = values::paths(&document.scenario);
        axis_ui(ui, "Rows", &mut wish.rows, (&paths, &document.scenario));
        told(ui, &wrong, Field::Rows);
        axis_ui(ui, "Columns", &mut wish.columns, (&paths, &document.scenario));
        told(ui, &wrong, Field::Columns);
        ui.horizontal(|ui| {
            let seeded = [&wish.rows, &wish.columns].iter().all(|axis| axis.path != "seed");
            let label = heading(ui, "Seeds");
            let number = DragValue::new(&mut wish.seeds).range(1..=MOST_SEEDS);
            ui.add_enabled(seeded, number).labelled_by(label.id);
            let first = document.scenario.seed;
            ui.weak(if seeded { format!("of each, from seed {first} on") } else { "they vary already".into() });
        });
        told(ui, &wrong, Field::Seeds);
        ui.horizontal(|ui| self.buttons_ui(ui, requests));
        told(ui, &wrong, Field::Whole);
        self.folder_ui(ui);
        ui.add_space(4.0);
    }

    fn buttons_ui(&mut self, ui: &mut Ui, requests: &mut Vec<BatchRequest>) {
        let cells = match self.newest() {
            Some(Ok(plan)) => Some(plan.variations.len()),
            _ => None,
        };
        let faulty = matches!(self.newest(), Some(Err(_)));
        let running = self.grid.as_ref().is_some_and(|grid| grid.over.is_none());
        let bake = Button::new(RichText::new("Bake the grid").strong());
        if ui.add_enabled(!faulty, bake).on_hover_text(format!("at most {MOST_CELLS} cells")).clicked() {
            self.wanted = Some(None);
        }
        match cells {
            Some(1) => ui.label("1 cell"),
            Some(cells) => ui.label(format!("{cells} cells")),
            None => ui.weak(if faulty { "mend what is red first" } else { "…" }),
        };
        let job = self.asked.clone().filter(|_| cells.is_some());
        let enabled = job.is_some();
        if ui.add_enabled(enabled, Button::new("Save as sweep…")).clicked() {
            let save = job.as_ref().map(|job| BatchRequest::SaveSweep(Box::new(SweepToSave::new((**job).clone()))));
            requests.extend(save);
        }
        if ui.add_enabled(enabled, Button::new("Bake to folder…")).clicked() {
            requests.extend(job.map(BatchRequest::BakeToFolder));
        }
        let cancelling = self.grid.as_ref().is_some_and(|grid| grid.cancel.load(std::sync::atomic::Ordering::Relaxed));
        if running && ui.add_enabled(!cancelling, Button::new("Cancel")).clicked() {
            super::stop(self.grid.as_ref().map(|grid| &grid.cancel));
        }
        if let Some(grid) = self.grid.as_ref().filter(|_| running) {
            let (done, count) = (grid.done(), grid.cells.len());
            let bar = ProgressBar::new(done as f32 / count.max(1) as f32).desired_width(180.0);
            ui.add(bar.text(format!("{done} of {count}")));
        }
    }

    /// A batch into a folder: how far it is, or what came of it.
    fn folder_ui(&mut self, ui: &mut Ui) {
        let Some(folder) = &self.folder else { return };
        let mut close = false;
        ui.horizontal_wrapped(|ui| {
            let place = folder.path.display();
            match &folder.over {
                None => {
                    ui.label(format!("Baking to {place}: {} of {}", folder.done, folder.count));
                    if ui.button("Stop").clicked() {
                        folder.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
                    }
                }
                Some(Ok(_)) => {
                    ui.label(format!("{} variations are in {place}", folder.count));
                }
                Some(Err(why)) => {
                    ui.colored_label(ui.visuals().error_fg_color, format!("Not all is in {place}: {why}"));
                }
            }
            close = folder.over.is_some() && ui.button("Good").clicked();
        });
        if close {
            self.folder = None;
        }
    }
}

fn heading(ui: &mut Ui, words: &str) -> egui::Response {
    let size = egui::vec2(62.0, ui.spacing().interact_size.y);
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_width(size.x);
        ui.strong(words)
    })
    .inner
}

/// Path, form and values of an axis.
fn axis_ui(ui: &mut Ui, name: &str, axis: &mut Axis, (paths, scenario): (&[String], &Scenario)) {
    ui.horizontal(|ui| {
        let label = heading(ui, name);
        let shown = if axis.path.is_empty() { "nothing".to_owned() } else { axis.path.clone() };
        let mut chosen = axis.path.clone();
        let pull_down = ComboBox::from_id_salt(name).width(190.0).selected_text(shown).height(420.0);
        let response = pull_down.show_ui(ui, |ui| {
            ui.selectable_value(&mut chosen, String::new(), "nothing");
            for path in paths {
                ui.selectable_value(&mut chosen, path.clone(), path);
            }
        });
        response.response.labelled_by(label.id);
        if chosen != axis.path {
            *axis = if chosen.is_empty() { Axis::default() } else { Axis::of(&chosen, scenario) };
        }
        if axis.path.is_empty() {
            return;
        }
        let range = ui.selectable_label(!axis.listed, "range");
        named(ui, &range, &format!("{name}: range"));
        let list = ui.selectable_label(axis.listed, "list");
        named(ui, &list, &format!("{name}: list"));
        if range.clicked() || list.clicked() {
            axis.listed = list.clicked();
        }
        let field = |ui: &mut Ui, words: &str, text: &mut String, width: f32| {
            ui.label(words);
            let response = ui.add(TextEdit::singleline(text).desired_width(width));
            named(ui, &response, &format!("{name}: {words}"));
        };
        let unit = values::unit(&axis.path);
        if axis.listed {
            field(ui, "values", &mut axis.list, 330.0);
            ui.weak(if unit == "°" { "words, degrees or [x, y, z]" } else { unit });
        } else {
            field(ui, "from", &mut axis.from, 56.0);
            ui.weak(unit);
            field(ui, "to", &mut axis.to, 56.0);
            ui.weak(unit);
            field(ui, "count", &mut axis.count, 36.0);
            let log = ui.checkbox(&mut axis.log, "log");
            named(ui, &log, &format!("{name}: log"));
            log.on_hover_text("even steps of the logarithm");
        }
    });
}

/// What a screen reader calls a widget whose words stand more than once.
fn named(ui: &Ui, response: &egui::Response, name: &str) {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// What is wrong there, in the sweep's words.
fn told(ui: &mut Ui, wrong: &[Wrong], field: Field) {
    for wrong in wrong.iter().filter(|wrong| wrong.field == field) {
        ui.horizontal_wrapped(|ui| {
            ui.add_space(70.0);
            ui.colored_label(ui.visuals().error_fg_color, &wrong.words);
        });
    }
}
