//! Questions and lists that stand before everything else: unsaved work, what a crash left, the keys; and messages that pass by.

use super::command::{BESIDES, Command, shortcuts};
use super::file_dialog::FileDialog;
use super::state::{Asking, State};
use eframe::egui::{self, Align2, Color32, Id, Modal, vec2};

/// s, how long a message stays; a bad one stays until it is closed.
const STAYS: f64 = 6.0;

/// What they keep from frame to frame.
#[derive(Default)]
pub struct Dialogs {
    file: FileDialog,
    /// s, when each message that is shown came.
    since: Vec<f64>,
}

impl Dialogs {
    /// Draws what is asked.
    pub fn ui(&mut self, ctx: &egui::Context, state: &mut State) {
        match state.asking.clone() {
            None => {}
            Some(Asking::File(purpose)) => self.file.ui(ctx, state, purpose),
            Some(Asking::Unsaved(command)) => unsaved(ctx, state, &command),
            Some(Asking::Recover(_, unsaved)) => {
                let what = match &unsaved.file {
                    Some(file) => format!("changes of {} that were not saved", file.display()),
                    None => "a scenario that was not saved".to_owned(),
                };
                let text = format!("The studio did not end in order last time. It kept {what}.");
                match question(ctx, "Take up where it ended?", &text, &["Take it up", "Throw it away"]) {
                    Some(Some(0)) => state.recover(true),
                    Some(Some(_)) => state.recover(false),
                    _ => {}
                }
            }
            Some(Asking::Keys) => keys(ctx, state),
        }
        self.messages(ctx, state);
    }

    /// Messages in the corner, the newest lowest.
    fn messages(&mut self, ctx: &egui::Context, state: &mut State) {
        let now = ctx.input(|input| input.time);
        self.since.resize(state.messages.len(), now);
        let mut index = 0;
        while index < state.messages.len() {
            if !state.messages[index].bad && now - self.since[index] > STAYS {
                state.messages.remove(index);
                self.since.remove(index);
            } else {
                index += 1;
            }
        }
        if state.messages.is_empty() {
            return;
        }
        ctx.request_repaint_after_secs(1.0);
        let mut closed = None;
        let area = egui::Area::new(Id::unique("messages")).anchor(Align2::LEFT_BOTTOM, vec2(12.0, -12.0));
        area.order(egui::Order::Foreground).show(ctx, |ui| {
            for (index, message) in state.messages.iter().enumerate() {
                let rim = if message.bad { ui.visuals().error_fg_color } else { Color32::from_rgb(26, 122, 74) };
                let frame = egui::Frame::popup(ui.style()).stroke(egui::Stroke::new(1.5, rim));
                frame.show(ui, |ui| {
                    ui.set_max_width(460.0);
                    ui.horizontal(|ui| {
                        let close = ui.small_button("×");
                        close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Close message"));
                        if close.clicked() {
                            closed = Some(index);
                        }
                        ui.add(egui::Label::new(&message.text).wrap());
                    });
                });
            }
        });
        if let Some(index) = closed {
            state.messages.remove(index);
            self.since.remove(index);
        }
    }
}

fn unsaved(ctx: &egui::Context, state: &mut State, command: &Command) {
    let title = &state.document().scenario.title;
    let then = match command {
        Command::Quit => "quit",
        Command::New => "begin a new one",
        _ => "open another",
    };
    let text = format!("\"{title}\" has changes that are not on the disk.");
    let save = format!("Save, then {then}");
    match question(ctx, "Save the changes?", &text, &[&save, "Do not save"]) {
        Some(Some(0)) => state.unsaved(Some(true)),
        Some(Some(_)) => state.unsaved(Some(false)),
        Some(None) => state.unsaved(None),
        None => {}
    }
}

/// `Some(None)` is a cancel.
fn question(ctx: &egui::Context, title: &str, text: &str, answers: &[&str]) -> Option<Option<usize>> {
    let mut given = None;
    let modal = Modal::new(Id::unique(title)).show(ctx, |ui| {
        ui.set_width(400.0);
        ui.heading(title);
        ui.add_space(6.0);
        ui.label(text);
        ui.add_space(10.0);
        ui.horizontal(|ui| {
            for (index, answer) in answers.iter().enumerate() {
                if ui.button(*answer).clicked() {
                    given = Some(Some(index));
                }
            }
            if ui.button("Cancel").clicked() {
                given = Some(None);
            }
        });
    });
    given.or(modal.should_close().then_some(None))
}

fn keys(ctx: &egui::Context, state: &mut State) {
    let modal = Modal::new(Id::unique("keys")).show(ctx, |ui| {
        ui.set_width(460.0);
        ui.heading("Keys and mouse");
        egui::ScrollArea::vertical().max_height(460.0).show(ui, |ui| {
            egui::Grid::new("keys").num_columns(2).spacing([24.0, 4.0]).striped(true).show(ui, |ui| {
                for shortcut in shortcuts() {
                    ui.label(shortcut.what);
                    ui.monospace(ui.ctx().format_shortcut(&shortcut.key));
                    ui.end_row();
                }
                for (what, how) in BESIDES {
                    ui.label(what);
                    ui.monospace(how);
                    ui.end_row();
                }
            });
        });
        if ui.button("Close").clicked() {
            ui.close();
        }
    });
    if modal.should_close() {
        state.cancel();
    }
}
