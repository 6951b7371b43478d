//! The desk's bars: the file and what is saved of it above, the playhead's buttons below, and what is said where no clip is open or
//! something went wrong. Texts are for a person.

use super::repairs::Decision;
use super::shown::{Preview, Shown};
use super::state::{Command, State};
use crate::studio::icons::{self, Icon};
use crate::studio::playback::SPEEDS;
use eframe::egui::{Align, Button, ComboBox, Frame, Layout, Margin, RichText, Ui};

/// File, clip, what is under way; save.
pub fn top(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        if ui.button("Open clip…").on_hover_text("A .bvh, .fbx, .glb, .gltf, .vrm or .vrma file").clicked() {
            commands.push(Command::Open);
        }
        if let Some(file) = &state.file {
            let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            ui.strong(name).on_hover_text(file.display().to_string());
        }
        if state.clips.len() > 1 {
            clips(ui, state, commands);
        }
        if let Some(shown) = &state.shown {
            let found = &shown.before.findings;
            ui.weak(format!("{} frames at {:.4} fps", found.frames, found.fps).replace(".0000", ""));
            let sure =
                "How far the verdict is to be believed: how well bones and feet were found, how much was judged.";
            ui.weak(format!("confidence {:.0} %", 100.0 * found.confidence)).on_hover_text(sure);
        }
        if let Some(doing) = state.doing {
            ui.spinner();
            ui.label(format!("{doing}…"));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| save(ui, state, commands));
    });
    ui.add_space(3.0);
}

fn clips(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let name = |index: usize| {
        let name = state.clips.get(index).map(String::as_str).unwrap_or_default();
        if name.is_empty() { format!("clip {index}") } else { name.to_owned() }
    };
    let list = ComboBox::from_id_salt("audit_clip").selected_text(name(state.chosen)).width(160.0);
    let shown = list.show_ui(ui, |ui| {
        for index in 0..state.clips.len() {
            if ui.selectable_label(index == state.chosen, name(index)).clicked() && index != state.chosen {
                commands.push(Command::Choose(index));
            }
        }
    });
    shown.response.accessible_name("Clip");
}

fn save(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let accepted: usize = state.repairs.values().map(|repairs| repairs.count(Decision::Accepted)).sum();
    let button = ui.add_enabled(accepted > 0, Button::new("Save corrected…"));
    let button = button.on_hover_text(
        "Writes another file with the accepted corrections, and no others. Frames that none touches stay as they are.",
    );
    if button.on_disabled_hover_text("Accept a correction first: only accepted ones are written.").clicked() {
        commands.push(Command::Save);
    }
    if let Some(repairs) = state.now().filter(|repairs| !repairs.list.is_empty()) {
        let (all, own) = (repairs.list.len(), repairs.count(Decision::Accepted));
        let rejected = match repairs.count(Decision::Rejected) {
            0 => String::new(),
            count => format!(", {count} rejected"),
        };
        let other = if accepted > own { format!(", {} in other clips", accepted - own) } else { String::new() };
        ui.weak(format!("{own} of {all} accepted{rejected}{other}; only accepted ones are written"));
    }
}

/// The playhead's buttons, and what is shown.
pub fn transport(ui: &mut Ui, state: &State, shown: &Shown, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let mut button = |ui: &mut Ui, text: &str, hint: &str, command: Command| {
            if ui.button(text).on_hover_text(hint).clicked() {
                commands.push(command);
            }
        };
        button(ui, "Previous flag", "P", Command::PreviousFlag);
        button(ui, "Next flag", "N", Command::NextFlag);
        ui.separator();
        let playing = state.playback.playing;
        let play = if playing { (Icon::Pause, "Stop") } else { (Icon::Play, "Play") };
        let mut sign = |ui: &mut Ui, icon: Icon, name: &str, key: &str, command: Command| {
            if icons::button(ui, icon, name, false).on_hover_text(key).clicked() {
                commands.push(command);
            }
        };
        sign(ui, Icon::Start, "To the start", "Home", Command::Seek(0.0));
        sign(ui, Icon::Back, "A frame back", "left arrow", Command::Step(-1));
        sign(ui, play.0, play.1, "Space", Command::Play);
        sign(ui, Icon::On, "A frame on", "right arrow", Command::Step(1));
        let frame = shown.before.frame(state.playback.time);
        let last = shown.before.rows.len().saturating_sub(1);
        ui.monospace(format!("{frame:>4} / {last}   {:6.2} s", state.playback.time));
        speed(ui, state, commands);
        let again = "Begin again at the end";
        if icons::button(ui, Icon::Loop, again, state.playback.looping).clicked() {
            commands.push(Command::Loop);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| preview(ui, state, shown, commands));
    });
}

fn speed(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let list = ComboBox::from_id_salt("audit_speed").width(56.0).selected_text(format!("{}×", state.playback.speed));
    let shown = list.show_ui(ui, |ui| {
        for speed in SPEEDS {
            if ui.selectable_label(state.playback.speed == speed, format!("{speed}×")).clicked() {
                commands.push(Command::Speed(speed));
            }
        }
    });
    shown.response.accessible_name("Speed");
}

/// Right to left.
fn preview(ui: &mut Ui, state: &State, shown: &Shown, commands: &mut Vec<Command>) {
    let choices = [
        (Preview::Both, "Both", "The corrected motion, and the original as its ghost"),
        (Preview::Corrected, "Corrected", "With every correction that is not rejected"),
        (Preview::Original, "Original", "As the file is"),
    ];
    ui.add_enabled_ui(shown.after.is_some(), |ui| {
        for (preview, name, hint) in choices {
            if ui.selectable_label(state.preview == preview, name).on_hover_text(hint).clicked() {
                commands.push(Command::Preview(preview));
            }
        }
    });
    ui.weak("Show");
}

/// What went wrong, or well, over the view.
pub fn fault(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let visuals = ui.visuals();
    let (text, color) = match (&state.fault, &state.notice) {
        (Some(fault), _) => (fault, visuals.error_fg_color),
        (None, Some(notice)) => (notice, visuals.strong_text_color()),
        (None, None) => return,
    };
    Frame::new().fill(visuals.faint_bg_color).inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(plain(text)).color(color));
            if ui.small_button("Dismiss").clicked() {
                commands.push(Command::Dismiss);
            }
        });
        ui.take_available_width();
    });
}

/// A message as lines of a window.
fn plain(message: &str) -> String {
    message.lines().map(|line| line.trim().replacen("help: ", "", 1)).collect::<Vec<_>>().join("\n")
}

/// How a clip is opened.
pub fn empty(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let busy = state.doing.is_some();
    ui.add_space(0.3 * ui.available_height());
    ui.vertical_centered(|ui| {
        if busy {
            ui.spinner();
            ui.label("The clip is read and judged.");
            return;
        }
        ui.heading("Audit a clip");
        ui.label("Drop a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file here, or choose one.");
        ui.add_space(8.0);
        if ui.button("Choose a clip…").clicked() {
            commands.push(Command::Open);
        }
        ui.add_space(8.0);
        ui.weak("Frames that no balanced person could have produced are flagged; each correction is yours to accept or reject.");
    });
}
