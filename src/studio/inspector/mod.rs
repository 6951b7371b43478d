//! The inspector: the numbers behind the selected entry, the scene, the character, the ground, the base clip, the rig, and what came of it.

pub mod entry;
pub mod fields;
pub mod outcome;
pub mod rig;
pub mod scene;
pub mod stepper;

use super::command::Command;
use super::state::State;
use eframe::egui::{self, CollapsingHeader};

/// Draws it.
pub fn ui(ui: &mut egui::Ui, state: &State) -> Vec<Command> {
    let mut commands = Vec::new();
    let document = state.document();
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        outcome::ui(ui, state, &mut commands);
        if let (Some(place), Some(entry)) = (state.selected, state.selected_entry()) {
            let title = format!("Selected: {} {}", place.lane.name().to_lowercase(), place.index + 1);
            section(ui, "entry", &title, true, |ui| {
                ui.weak(place.lane.hint());
                entry::ui(ui, place, &entry, document.scenario.duration, &mut commands);
            });
        }
        section(ui, "scene", "Scene", true, |ui| scene::scene(ui, document, &mut commands));
        section(ui, "character", "Character", true, |ui| {
            scene::character(ui, document, state.rig.as_deref(), &mut commands)
        });
        section(ui, "ground", "Ground", false, |ui| scene::ground(ui, document, &mut commands));
        section(ui, "stepper", "Stepper", false, |ui| stepper::ui(ui, document.scenario.stepper, &mut commands));
        section(ui, "base", "Base clip", false, |ui| scene::base(ui, document, state.rig.as_deref(), &mut commands));
        section(ui, "rig", "Rig", false, |ui| rig::ui(ui, state, &mut commands));
        section(ui, "bake", "Bake", false, |ui| scene::bake(ui, document, &mut commands));
    });
    commands
}

fn section(ui: &mut egui::Ui, id: &str, title: &str, open: bool, rows: impl FnOnce(&mut egui::Ui)) {
    CollapsingHeader::new(egui::RichText::new(title).strong()).id_salt(id).default_open(open).show(ui, |ui| {
        rows(ui);
        ui.add_space(4.0);
    });
}
