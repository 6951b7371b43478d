//! What came of the scenario: the outcome and the numbers that decide, or why there is no clip.

use crate::model::report::Outcome;
use crate::studio::command::Command;
use crate::studio::state::{State, told};
use crate::studio::timeline::tracks::faults;
use eframe::egui::{self, Color32, RichText};

/// Draws it.
pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Vec<Command>) {
    ui.add_space(4.0);
    if !state.faults.is_empty() {
        ui.colored_label(ui.visuals().error_fg_color, "The scenario has faults; the clip is from before.");
        for fault in &state.faults {
            ui.label(format!("{}: {}. {}", fault.path, fault.message, capital(&fault.remedy)));
        }
        return;
    }
    if let Some(failure) = &state.failure {
        ui.colored_label(ui.visuals().error_fg_color, told(failure));
        return;
    }
    let Some(shown) = &state.shown else {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label("baking the first clip");
        });
        return;
    };
    let report = &shown.baked.report;
    let (word, color) = word(report.outcome);
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!(" {word} ")).strong().color(Color32::WHITE).background_color(color));
        let steps = if report.steps == 1 { "1 step".to_owned() } else { format!("{} steps", report.steps) };
        ui.label(format!("{steps}, {:.2} s, {}", report.duration, report.drive));
        if state.is_fresh() {
            ui.weak(format!("{} ms", shown.took.as_millis())).on_hover_text("from the edit to this clip");
        } else {
            ui.spinner().on_hover_text("the next clip is being baked");
        }
    });
    let measured = &report.plausibility;
    super::fields::grid(ui, "outcome", |ui| {
        let mut row = |name: &str, value: String, hint: &str, good: bool| {
            ui.label(name).on_hover_text(hint);
            let text = RichText::new(value);
            ui.label(if good { text } else { text.color(ui.visuals().warn_fg_color) }).on_hover_text(hint);
            ui.end_row();
        };
        row(
            "Plausibility",
            format!("{:.2}", measured.score),
            "0 to 1, one number over the rest",
            measured.score >= 0.8,
        );
        row(
            "Balance",
            format!("{:.0} % inside", measured.zmp_inside * 100.0),
            "share of moving frames whose zero-moment point lies in the support",
            measured.zmp_inside >= 0.95,
        );
        row(
            "Slip",
            format!("{:.2} mm", measured.slip_max_mm),
            "the farthest that a held foot slides",
            measured.slip_max_mm <= 2.0,
        );
        row(
            "Friction",
            format!("{:.2} needed", measured.friction_p99),
            "what the ground must hold; rubber on concrete has 0.8",
            measured.friction_p99 <= 0.9,
        );
        row(
            "Ankle",
            format!("{:.1} m/s", measured.peak_ankle_speed),
            "the fastest that a foot swings; people reach 8",
            measured.peak_ankle_speed <= 8.0,
        );
    });
    if let Some(choice) = &shown.baked.choice {
        ui.weak(format!("{}: {}", report.drive, choice.why));
    }
    let told: Vec<&String> = shown.baked.warnings.iter().chain(&measured.notes).collect();
    let (first, rest) = told.split_at(told.len().min(TOLD));
    for warning in first {
        ui.label(RichText::new(*warning).color(ui.visuals().warn_fg_color));
    }
    if !rest.is_empty() {
        let all: Vec<&str> = rest.iter().map(|text| text.as_str()).collect();
        ui.weak(format!("and {} more", rest.len())).on_hover_text(all.join("\n"));
    }
    let faults = faults(&shown.baked);
    if let Some(first) = faults.first() {
        let count = faults.len();
        let text = if count == 1 { "1 flag".to_owned() } else { format!("{count} flags") };
        if ui.link(text).on_hover_text(&first.why).clicked() {
            let next = faults.iter().find(|fault| fault.start > state.playback.time + 1e-3).unwrap_or(first);
            commands.push(Command::Seek(next.start));
        }
    }
    ui.separator();
}

/// Warnings and notes that are told at once, the most telling ones: what is below them stays in sight.
const TOLD: usize = 3;

/// What an outcome is called, and its colour.
pub fn word(outcome: Outcome) -> (&'static str, Color32) {
    match outcome {
        Outcome::Still => ("still", Color32::from_rgb(110, 118, 128)),
        Outcome::Sway => ("sway", Color32::from_rgb(32, 128, 140)),
        Outcome::Step => ("step", Color32::from_rgb(26, 122, 74)),
        Outcome::Fall => ("fall", Color32::from_rgb(190, 38, 38)),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
