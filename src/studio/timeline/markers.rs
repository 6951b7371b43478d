//! A person's marks: flags in the ruler that are dragged, named and taken away. A click goes there. Times s.

use super::Frame;
use crate::model::scenario::Marker;
use crate::studio::command::Command;
use crate::studio::document::Edit;
use eframe::egui::{self, Align2, Color32, FontId, Rect, Sense, Stroke, pos2, vec2};

/// Of the flags.
const COLOR: Color32 = Color32::from_rgb(120, 150, 240);

/// Draws them over the ruler; their lines go down to `bottom`.
pub(super) fn ui(ui: &mut egui::Ui, frame: &Frame, ruler: Rect, bottom: f32, commands: &mut Vec<Command>) {
    let markers = &frame.input.document.scenario.marker;
    let painter = ui.painter().with_clip_rect(Rect::from_min_max(ruler.min, pos2(ruler.right(), bottom)));
    for (index, marker) in markers.iter().enumerate() {
        let x = frame.map.x(marker.time);
        let with = |change: &dyn Fn(&mut Vec<Marker>)| {
            let mut changed = markers.clone();
            change(&mut changed);
            Edit::Markers(changed)
        };
        painter.line_segment([pos2(x, ruler.top()), pos2(x, bottom)], Stroke::new(1.0, COLOR.gamma_multiply(0.5)));
        let text = painter.layout_no_wrap(marker.name.clone(), FontId::proportional(10.0), Color32::WHITE);
        let flag = Rect::from_min_size(pos2(x, ruler.top() + 1.0), text.size() + vec2(8.0, 2.0));
        painter.rect_filled(flag, 2.0, COLOR.gamma_multiply(0.85));
        painter.text(
            flag.left_center() + vec2(4.0, 0.0),
            Align2::LEFT_CENTER,
            &marker.name,
            FontId::proportional(10.0),
            Color32::BLACK,
        );
        let id = ui.scope_id().with(("marker", index));
        let response = ui.interact(flag.intersect(ruler), id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Marker {}", marker.name)));
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let time = (frame.map.time(pointer.x).max(0.0) * 100.0).round() / 100.0;
            commands.push(Command::Drag(with(&|markers| markers[index].time = time)));
        } else if response.clicked() {
            commands.push(Command::Seek(marker.time));
        }
        if response.drag_stopped() {
            commands.push(Command::Release);
        }
        response.context_menu(|ui| {
            let label = ui.label("Marker");
            let mut name = marker.name.clone();
            let edit = ui.add(egui::TextEdit::singleline(&mut name).char_limit(80)).labelled_by(label.id);
            if edit.changed() && !name.trim().is_empty() {
                commands.push(Command::Drag(with(&|markers| markers[index].name.clone_from(&name))));
            }
            if edit.lost_focus() {
                commands.push(Command::Release);
            }
            if ui.button("Remove").clicked() {
                commands.push(Command::Edit(with(&|markers| drop(markers.remove(index)))));
                ui.close();
            }
        });
        response.on_hover_text(format!("{} at {:.2} s. Right click names or removes it", marker.name, marker.time));
    }
}
