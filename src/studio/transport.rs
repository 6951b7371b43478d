//! Play, step, loop, speed and time: the strip between the view and the timeline.

use super::command::Command;
use super::icons::{Icon, button};
use super::playback::SPEEDS;
use super::state::State;
use super::timeline::Timeline;
use eframe::egui;

/// Draws it.
pub fn ui(ui: &mut egui::Ui, state: &State, timeline: &mut Timeline) -> Vec<Command> {
    let mut commands = Vec::new();
    let playback = &state.playback;
    let fps = state.document().bake.fps;
    ui.horizontal(|ui| {
        let (sign, name) = if playback.playing { (Icon::Pause, "Pause") } else { (Icon::Play, "Play") };
        for (icon, name, on, command) in [
            (Icon::Start, "To the start", false, Command::Seek(0.0)),
            (Icon::Back, "A frame back", false, Command::Step(-1)),
            (sign, name, playback.playing, Command::PlayPause),
            (Icon::On, "A frame on", false, Command::Step(1)),
            (Icon::Loop, "Loop", playback.looping, Command::ToggleLoop),
        ] {
            if button(ui, icon, name, on).clicked() {
                commands.push(command);
            }
        }
        egui::ComboBox::from_id_salt("speed")
            .selected_text(format!("× {}", playback.speed))
            .width(64.0)
            .show_ui(ui, |ui| {
                for speed in SPEEDS {
                    if ui.selectable_label(playback.speed == speed, format!("× {speed}")).clicked() {
                        commands.push(Command::Speed(speed));
                    }
                }
            })
            .response
            .on_hover_text("how fast it plays")
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Playing speed"));
        ui.separator();
        ui.monospace(format!("{:6.3} s", playback.time)).on_hover_text("the playhead");
        ui.weak(format!("frame {:3.0} of {:.0}", (playback.time * fps).round(), (state.duration() * fps).round()));
        ui.separator();
        let mut snap = !timeline.free;
        if ui
            .checkbox(&mut snap, "Snap")
            .on_hover_text("entries come to rest on round times and on each other's edges; Alt drags freely")
            .changed()
        {
            timeline.free = !snap;
        }
        if ui.button("Fit").on_hover_text("show the whole clip").clicked() {
            timeline.fit();
        }
        ui.separator();
        for lane in [super::document::Lane::Push, super::document::Lane::Walk] {
            let text = format!("+ {}", lane.name());
            if ui.button(text).on_hover_text(lane.hint()).clicked() {
                commands.push(Command::Add(lane, None));
            }
        }
        if ui.button("Export...").on_hover_text("bake the clip into a file").clicked() {
            commands.push(Command::ExportDialog);
        }
    });
    commands
}
