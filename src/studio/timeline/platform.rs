//! The platform's lane: how it is turned about x (pitch) and z (roll) over time, as two lines with points that are dragged.
//!
//! Across is time, up is the angle. Other grounds have no line; a button makes the ground a platform. Angles rad.

use super::{Frame, HEAD, knob, row};
use crate::model::scenario::{Ground, GroundKind};
use crate::studio::command::Command;
use crate::studio::document::Edit;
use eframe::egui::{self, Align2, Color32, FontId, Rect, Sense, Stroke, pos2, vec2};

/// rad, the lane's upper edge; the points go no farther, numbers in the inspector do.
const MOST: f64 = std::f64::consts::FRAC_PI_4;

/// Draws the lane.
pub(super) fn lane(ui: &mut egui::Ui, frame: &Frame, height: f32, commands: &mut Vec<Command>) {
    let ground = &frame.input.document.scenario.ground;
    let lines = match &ground.kind {
        GroundKind::Platform { pitch, roll } => Some([pitch.clone(), roll.clone()]),
        _ => None,
    };
    let row = row(ui, if lines.is_some() { height * 1.6 } else { height });
    let visuals = ui.visuals().clone();
    ui.painter().line_segment([row.left_bottom(), row.right_bottom()], visuals.widgets.noninteractive.bg_stroke);
    let at = pos2(row.left() + 8.0, row.center().y);
    ui.painter().text(at, Align2::LEFT_CENTER, "Platform", FontId::proportional(13.0), visuals.text_color());
    let Some(lines) = lines else {
        let button = Rect::from_center_size(pos2(row.left() + HEAD - 15.0, row.center().y), vec2(18.0, 18.0));
        let plus = ui.put(button, egui::Button::new("+").small());
        plus.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Add platform"));
        if plus.on_hover_text("Add platform: the ground becomes a square that tilts").clicked() {
            let turned = 12_f64.to_radians();
            let pitch = vec![[0.5, 0.0], [1.5, turned], [2.5, -turned], [3.5, 0.0]];
            let kind = GroundKind::Platform { pitch, roll: Vec::new() };
            commands.push(Command::Edit(Edit::Ground(Ground { kind, ..ground.clone() })));
        }
        return;
    };
    let space = Rect::from_min_max(pos2(frame.area.left(), row.top() + 4.0), row.max - vec2(0.0, 4.0));
    let y = |angle: f64| space.center().y - (angle / MOST) as f32 * space.height() * 0.5;
    let colors = [Color32::from_rgb(70, 150, 220), Color32::from_rgb(220, 160, 60)];
    let painter = ui.painter().with_clip_rect(space);
    painter.line_segment(
        [pos2(space.left(), y(0.0)), pos2(space.right(), y(0.0))],
        Stroke::new(1.0, visuals.weak_text_color().gamma_multiply(0.5)),
    );
    let empty = ui.interact(space, ui.scope_id().with("platform"), Sense::click());
    if let Some(pointer) = empty.interact_pointer_pos().filter(|_| empty.double_clicked()) {
        let mut changed = lines.clone();
        let angle = f64::from((space.center().y - pointer.y) / (space.height() * 0.5)) * MOST;
        insert(&mut changed[0], frame.map.time(pointer.x), angle);
        commands.push(Command::Edit(edit(ground, changed)));
    }
    for (which, (points, name)) in lines.iter().zip(["pitch", "roll"]).enumerate() {
        let mut path: Vec<egui::Pos2> =
            points.iter().map(|[time, angle]| pos2(frame.map.x(*time), y(*angle))).collect();
        if let (Some(first), Some(last)) = (path.first().copied(), path.last().copied()) {
            path.insert(0, pos2(space.left(), first.y));
            path.push(pos2(space.right(), last.y));
        }
        painter.add(egui::Shape::line(path, Stroke::new(1.5, colors[which])));
        for (index, [time, angle]) in points.iter().enumerate() {
            let at = pos2(frame.map.x(*time), y(*angle));
            let id = ui.scope_id().with(("platform", which, index));
            let response = ui.interact(Rect::from_center_size(at, vec2(12.0, 12.0)), id, Sense::click_and_drag());
            let label = format!("Platform {name} {}", index + 1);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, label.clone()));
            knob(&painter, at, colors[which], visuals.strong_text_color());
            if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
                let mut changed = lines.clone();
                let low = index.checked_sub(1).map_or(0.0, |before| points[before][0] + 0.05);
                let high = points.get(index + 1).map_or(f64::MAX, |after| after[0] - 0.05);
                let angle = f64::from((space.center().y - pointer.y) / (space.height() * 0.5)) * MOST;
                changed[which][index] = [
                    (frame.map.time(pointer.x) * 20.0).round().max(0.0) / 20.0,
                    angle.clamp(-MOST, MOST).to_degrees().round().to_radians(),
                ];
                changed[which][index][0] = changed[which][index][0].max(low).min(high);
                commands.push(Command::Drag(edit(ground, changed)));
            }
            if response.drag_stopped() {
                commands.push(Command::Release);
            }
            if response.secondary_clicked() {
                let mut changed = lines.clone();
                changed[which].remove(index);
                commands.push(Command::Edit(edit(ground, changed)));
            }
            response.on_hover_text(format!("{name} {:.0}° at {time:.2} s. Right click removes it", angle.to_degrees()));
        }
    }
    empty.on_hover_text(
        "how the platform is turned: blue about x (pitch), yellow about z (roll). Double click adds a point",
    );
}

fn edit(ground: &Ground, [pitch, roll]: [Vec<[f64; 2]>; 2]) -> Edit {
    Edit::Ground(Ground { kind: GroundKind::Platform { pitch, roll }, ..ground.clone() })
}

/// A new point in its place, rounded; none where there is one already.
fn insert(points: &mut Vec<[f64; 2]>, time: f64, angle: f64) {
    let time = ((time * 20.0).round() / 20.0).max(0.0);
    let place = points.partition_point(|point| point[0] < time);
    if points.get(place).is_none_or(|point| point[0] > time + 1e-9) {
        points.insert(place, [time, angle.clamp(-MOST, MOST).to_degrees().round().to_radians()]);
    }
}
