//! Small signs as shapes: fonts differ in which of them they have.

use eframe::egui::{self, Pos2, Rect, Response, Sense, Shape, Stroke, pos2, vec2};

/// A sign on a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// A triangle.
    Play,
    /// Two bars.
    Pause,
    /// A bar and a triangle back.
    Start,
    /// A triangle back before a bar.
    Back,
    /// A triangle behind a bar.
    On,
    /// Around and around.
    Loop,
    /// An arrow back to where it was.
    Reset,
}

/// A button with a sign, its name for who cannot see it and on hover.
pub fn button(ui: &mut egui::Ui, icon: Icon, name: &str, on: bool) -> Response {
    let size = if icon == Icon::Reset { vec2(18.0, 18.0) } else { vec2(28.0, 22.0) };
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, on, name));
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact_selectable(&response, on);
        if icon != Icon::Reset || response.hovered() {
            ui.painter().rect(
                rect,
                visuals.corner_radius,
                visuals.weak_bg_fill,
                Stroke::NONE,
                egui::StrokeKind::Inside,
            );
        }
        paint(ui.painter(), rect, icon, visuals.fg_stroke.color);
    }
    response.on_hover_text(name)
}

fn paint(painter: &egui::Painter, rect: Rect, icon: Icon, color: egui::Color32) {
    let (middle, half) = (rect.center(), 5.0);
    let at = |x: f32, y: f32| middle + vec2(x, y) * half;
    let triangle = |a: Pos2, b: Pos2, c: Pos2| Shape::convex_polygon(vec![a, b, c], color, Stroke::NONE);
    let bar = |x: f32| Shape::rect_filled(Rect::from_center_size(at(x, 0.0), vec2(2.5, half * 2.0)), 0.0, color);
    match icon {
        Icon::Play => drop(painter.add(triangle(at(-0.8, -1.1), at(1.1, 0.0), at(-0.8, 1.1)))),
        Icon::Pause => painter.extend([bar(-0.5), bar(0.5)]),
        Icon::Start => painter.extend([bar(-0.9), triangle(at(0.9, -1.0), at(-0.6, 0.0), at(0.9, 1.0))]),
        Icon::Back => painter.extend([triangle(at(0.2, -0.9), at(-1.1, 0.0), at(0.2, 0.9)), bar(0.7)]),
        Icon::On => painter.extend([triangle(at(-0.2, -0.9), at(1.1, 0.0), at(-0.2, 0.9)), bar(-0.7)]),
        Icon::Loop => around(painter, middle, half, color, (0.6, 5.6)),
        Icon::Reset => around(painter, middle, half * 0.85, color, (5.6, 0.9)),
    }
}

/// A circle from an angle to another (rad, clockwise from the right), with a head at its end.
fn around(painter: &egui::Painter, middle: Pos2, radius: f32, color: egui::Color32, (from, to): (f32, f32)) {
    let point = |angle: f32| pos2(middle.x + radius * angle.cos(), middle.y + radius * angle.sin());
    let points: Vec<Pos2> = (0..=20).map(|step| point(egui::lerp(from..=to, step as f32 / 20.0))).collect();
    painter.add(Shape::line(points, Stroke::new(1.8, color)));
    let along = vec2(-to.sin(), to.cos()) * (to - from).signum();
    let (tip, side) = (point(to) + along * 4.0, vec2(-along.y, along.x) * 3.5);
    painter.add(Shape::convex_polygon(vec![tip, point(to) + side, point(to) - side], color, Stroke::NONE));
}
