//! Buttons of the playhead, drawn as shapes: no font need have their signs.

use eframe::egui::{Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

/// What is on a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// To the start.
    Start,
    /// A frame back.
    Back,
    /// Play.
    Play,
    /// Stop.
    Pause,
    /// A frame on.
    On,
    /// Begin again at the end.
    Loop,
}

/// A button; `name` is its name for whoever cannot see it.
pub fn button(ui: &mut Ui, icon: Icon, name: &str, hint: &str, chosen: bool) -> Response {
    let side = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(side * 1.25, side), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, name));
    let visuals = ui.style().interact_selectable(&response, chosen);
    if chosen || response.hovered() || response.has_focus() {
        ui.painter().rect(
            rect,
            visuals.corner_radius,
            visuals.weak_bg_fill,
            visuals.bg_stroke,
            eframe::egui::StrokeKind::Inside,
        );
    }
    draw(ui.painter(), Rect::from_center_size(rect.center(), vec2(11.0, 11.0)), icon, visuals.fg_stroke);
    response.on_hover_text(hint)
}

fn draw(painter: &Painter, rect: Rect, icon: Icon, stroke: Stroke) {
    let color = stroke.color;
    let place = |x: f32, y: f32| pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height());
    let triangle = |points: [Pos2; 3]| {
        painter.add(Shape::convex_polygon(points.to_vec(), color, Stroke::NONE));
    };
    let bar = |x: f32, width: f32| {
        painter.rect_filled(Rect::from_min_max(place(x, 0.05), place(x + width, 0.95)), 0.5, color);
    };
    match icon {
        Icon::Start => {
            bar(0.05, 0.15);
            triangle([place(0.25, 0.5), place(0.95, 0.05), place(0.95, 0.95)]);
        }
        Icon::Back => {
            triangle([place(0.05, 0.5), place(0.6, 0.1), place(0.6, 0.9)]);
            bar(0.72, 0.15);
        }
        Icon::Play => triangle([place(0.15, 0.0), place(1.0, 0.5), place(0.15, 1.0)]),
        Icon::Pause => {
            bar(0.15, 0.25);
            bar(0.6, 0.25);
        }
        Icon::On => {
            bar(0.13, 0.15);
            triangle([place(0.95, 0.5), place(0.4, 0.1), place(0.4, 0.9)]);
        }
        Icon::Loop => {
            let angle = |share: f32| std::f32::consts::TAU * (0.08 + 0.8 * share) - std::f32::consts::FRAC_PI_2;
            let on = |angle: f32, radius: f32| rect.center() + vec2(angle.cos(), angle.sin()) * radius * rect.width();
            let arc = (0..=20).map(|at| on(angle(at as f32 / 20.0), 0.42)).collect();
            painter.line(arc, Stroke::new(1.6, color));
            let (tip, end) = (on(angle(1.0) + 0.55, 0.42), angle(1.0));
            triangle([on(end, 0.2), on(end, 0.66), tip]);
        }
    }
}
