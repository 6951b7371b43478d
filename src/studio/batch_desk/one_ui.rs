//! The selected variation beside the grid: its picture, its numbers, and the button that opens it.

use super::grid_ui::colour;
use super::{BatchDesk, BatchRequest, Grid};
use crate::batch::run::Ended;
use eframe::egui::{self, Button, Image, RichText, ScrollArea, Ui};

impl BatchDesk {
    pub(super) fn one_ui(&mut self, ui: &mut Ui, requests: &mut Vec<BatchRequest>) {
        let Some(grid) = &self.grid else { return };
        let Some(index) = self.view.selected.filter(|index| *index < grid.cells.len()) else {
            ui.add_space(8.0);
            ui.weak("Select a cell to see its numbers. A double click opens it.");
            return;
        };
        ui.add_space(6.0);
        if let Some(texture) = &grid.cells[index].texture {
            let width = ui.available_width();
            ui.add(Image::new(texture).fit_to_exact_size(texture.size_vec2() * (width / texture.size_vec2().x)));
        }
        let button = Button::new(RichText::new("Open this one").strong());
        if ui.add_sized([ui.available_width(), 26.0], button).on_hover_text("as one edit: undo goes back").clicked() {
            requests.extend(grid.scenario(index));
        }
        ui.add_space(4.0);
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| numbers_ui(ui, grid, index));
    }
}

/// What it is set to, and what came of it.
pub(super) fn numbers_ui(ui: &mut Ui, grid: &Grid, index: usize) {
    let (Some(cell), Some(variation)) = (grid.cells.get(index), grid.plan.variations.get(index)) else { return };
    ui.strong(&variation.name);
    let mut rows = grid.values(variation);
    let mut warnings = Vec::new();
    match &cell.ended {
        Some(Ended::Done(measured, _)) => {
            if let Some(verdict) = cell.verdict() {
                ui.label(
                    RichText::new(format!(" {} ", verdict.word()))
                        .color(egui::Color32::WHITE)
                        .background_color(colour(verdict)),
                );
            }
            let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
            row("steps", measured.steps.to_string());
            row("plausibility", format!("{:.2}", measured.plausibility));
            row("recovery", measured.recovery.map_or_else(|| "–".into(), |secs| format!("{secs:.2} s")));
            row("travel", format!("{:.2} m", measured.travel));
            row("impulse", format!("{:.0} N s", measured.impulse));
            row("ZMP inside", format!("{:.0} %", 100.0 * measured.zmp_inside));
            row("slip", format!("{:.1} mm", measured.slip));
            row("seed", measured.seed.to_string());
            row("moved by", measured.drive.clone());
            if measured.assist_nm > 0.0 || measured.assist_n > 0.0 {
                row("help", format!("{:.0} Nm, {:.0} N", measured.assist_nm, measured.assist_n));
            }
            row("length", format!("{:.2} s", measured.duration));
            warnings = measured.warnings.clone();
        }
        Some(Ended::Failed(why)) => warnings.push(why.clone()),
        Some(Ended::NotRun) | None => {}
    }
    egui::Grid::new(("numbers", index)).num_columns(2).striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.weak(name);
            ui.label(value);
            ui.end_row();
        }
    });
    for warning in warnings {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    }
}
