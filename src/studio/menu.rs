//! The menu bar, with the three views at its end.

use super::command::{Command, View, shortcuts};
use super::examples;
use super::state::State;
use eframe::egui::{self, Button, MenuBar};

/// Draws it.
pub fn ui(ui: &mut egui::Ui, state: &State) -> Vec<Command> {
    let mut commands = Vec::new();
    let history = &state.history;
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| {
            item(ui, "New", Command::New, true, &mut commands);
            item(ui, "Open...", Command::OpenDialog, true, &mut commands);
            ui.menu_button("Recent", |ui| {
                if state.remembered.recent.is_empty() {
                    ui.weak("nothing yet");
                }
                for recent in &state.remembered.recent {
                    let name = recent.scenario.display().to_string();
                    if ui.button(name).clicked() {
                        commands.push(Command::Open(recent.scenario.clone()));
                    }
                }
            });
            ui.menu_button("Examples", |ui| {
                for (index, (name, what)) in examples::names().enumerate() {
                    if ui.button(name).on_hover_text(what).clicked() {
                        commands.push(Command::Example(index));
                    }
                }
            });
            item(ui, "Open rig...", Command::RigDialog, true, &mut commands);
            ui.separator();
            item(ui, "Save", Command::Save, true, &mut commands);
            item(ui, "Save as...", Command::SaveAs, true, &mut commands);
            item(ui, "Export the clip...", Command::ExportDialog, true, &mut commands);
            ui.separator();
            item(ui, "Quit", Command::Quit, true, &mut commands);
        });
        ui.menu_button("Edit", |ui| {
            let (back, on) = (history.undoes(), history.redoes());
            let text =
                |verb: &str, what: Option<&str>| format!("{verb} {}", what.unwrap_or_default()).trim().to_owned();
            item(ui, &text("Undo", back), Command::Undo, back.is_some(), &mut commands);
            item(ui, &text("Redo", on), Command::Redo, on.is_some(), &mut commands);
            ui.separator();
            let selected = state.selected.is_some();
            item(ui, "Cut", Command::Cut, selected, &mut commands);
            item(ui, "Copy", Command::Copy, selected, &mut commands);
            item(ui, "Paste", Command::Paste, true, &mut commands);
            item(ui, "Duplicate", Command::Duplicate, selected, &mut commands);
            item(ui, "Delete", Command::Delete, selected, &mut commands);
        });
        ui.menu_button("View", |ui| {
            for (view, name, what) in View::ALL {
                if ui.radio(state.view == view, name).on_hover_text(what).clicked() {
                    commands.push(Command::View(view));
                }
            }
            ui.separator();
            let mut plots = state.plots;
            if ui.checkbox(&mut plots, "Plots").clicked() {
                commands.push(Command::TogglePlots);
            }
            ui.separator();
            for (name, dark) in [("Light", Some(false)), ("Dark", Some(true)), ("As the system", None)] {
                let now = state.remembered.theme.as_deref();
                let is = now == dark.map(|dark| if dark { "dark" } else { "light" });
                if ui.radio(is, name).clicked() {
                    commands.push(Command::Theme(dark));
                }
            }
            ui.separator();
            egui::gui_zoom::zoom_menu_buttons(ui);
        });
        ui.menu_button("Help", |ui| {
            item(ui, "Keys and mouse", Command::Keys, true, &mut commands);
            ui.weak(concat!("Surefoot ", env!("CARGO_PKG_VERSION")));
        });
        ui.separator();
        for (view, name, what) in View::ALL {
            if ui.selectable_label(state.view == view, name).on_hover_text(what).clicked() {
                commands.push(Command::View(view));
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let file = state.file.as_deref().and_then(std::path::Path::file_name);
            let name = file.map_or_else(|| "not saved yet".to_owned(), |name| name.to_string_lossy().into_owned());
            let mark = if history.is_unsaved() { " *" } else { "" };
            ui.weak(format!("{name}{mark}"));
        });
    });
    commands
}

/// A menu's entry with its key.
fn item(ui: &mut egui::Ui, text: &str, command: Command, on: bool, commands: &mut Vec<Command>) {
    let key = shortcuts().into_iter().find(|shortcut| shortcut.command == command).map(|shortcut| shortcut.key);
    let mut button = Button::new(text);
    if let Some(key) = key {
        button = button.shortcut_text(ui.ctx().format_shortcut(&key));
    }
    if ui.add_enabled(on, button).clicked() {
        commands.push(command);
        ui.close();
    }
}
