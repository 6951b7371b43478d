//! A compass: a direction around the character, set by dragging. The character looks up the page; angles rad, positive towards its left.

use eframe::egui::{self, Color32, Response, Sense, Stroke, Vec2, WidgetInfo, vec2};
use std::f64::consts::{PI, TAU};

/// rad: while dragged it stays at whole steps of this, without Alt.
const SNAP: f64 = PI / 12.0;

/// Shows a direction and lets it be dragged, or moved by the arrow keys; the response says whether it changed.
pub fn compass(ui: &mut egui::Ui, label: &str, angle: &mut f64, size: f32) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(Vec2::splat(size), Sense::click_and_drag());
    let (centre, radius) = (rect.center(), size * 0.44);
    let mut changed = false;
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let off = pointer - centre;
        if off.length() > 2.0 {
            let dragged = f64::from(-off.x).atan2(f64::from(-off.y));
            let free = ui.input(|input| input.modifiers.alt);
            let next = if free { dragged } else { (dragged / SNAP).round() * SNAP };
            changed = (next - *angle).rem_euclid(TAU).min((*angle - next).rem_euclid(TAU)) > 1e-6;
            *angle = next;
        }
    }
    if response.has_focus() {
        let step = ui.input(|input| {
            f64::from(input.num_presses(egui::Key::ArrowLeft) as i32 - input.num_presses(egui::Key::ArrowRight) as i32)
        });
        if step != 0.0 {
            *angle += step * SNAP;
            changed = true;
        }
    }
    if changed {
        response.mark_changed();
    }
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        let weak = ui.visuals().weak_text_color();
        let painter = ui.painter();
        painter.circle(centre, radius, ui.visuals().extreme_bg_color, Stroke::new(1.0, visuals.fg_stroke.color));
        for quarter in 0..8 {
            let spoke = point(f64::from(quarter) * PI / 4.0);
            let inner = if quarter % 2 == 0 { 0.82 } else { 0.9 };
            painter.line_segment([centre + spoke * radius * inner, centre + spoke * radius], Stroke::new(1.0, weak));
        }
        // The character from above: shoulders and a nose.
        painter.add(egui::Shape::ellipse_filled(centre, vec2(radius * 0.3, radius * 0.14), weak));
        painter.circle_filled(centre - vec2(0.0, radius * 0.06), radius * 0.12, visuals.fg_stroke.color);
        arrow(painter, centre, point(*angle) * radius * 0.92, ui.visuals().selection.stroke.color);
        if size >= 80.0 {
            let font = egui::FontId::proportional(10.0);
            for (text, quarter) in [("front", 0.0), ("left", 1.0), ("back", 2.0), ("right", 3.0)] {
                let at = centre + point(quarter * PI / 2.0) * radius * 0.64;
                painter.text(at, egui::Align2::CENTER_CENTER, text, font.clone(), weak);
            }
        }
    }
    let degrees = angle.to_degrees().round();
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(egui::Role::Slider, true, label);
        info.value = Some(degrees);
        info
    });
    response.on_hover_text(format!("{label}: {degrees:.0}°, positive towards its left. Alt drags without snapping"))
}

/// Up the page is 0, to the left is positive.
pub fn point(angle: f64) -> Vec2 {
    vec2(-angle.sin() as f32, -angle.cos() as f32)
}

/// An arrow from a point along a vector.
pub fn arrow(painter: &egui::Painter, from: egui::Pos2, along: Vec2, color: Color32) {
    let length = along.length();
    if length < 1.0 {
        return;
    }
    let (tip, unit) = (from + along, along / length);
    let (side, head) = (vec2(-unit.y, unit.x), (length * 0.35).min(9.0));
    painter.line_segment([from, tip - unit * head * 0.8], Stroke::new((length * 0.08).clamp(1.5, 3.0), color));
    let corners = vec![tip, tip - unit * head + side * head * 0.5, tip - unit * head - side * head * 0.5];
    painter.add(egui::Shape::convex_polygon(corners, color, Stroke::NONE));
}
