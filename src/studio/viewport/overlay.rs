//! What is painted flat over the picture: marks that stay legible, the push in hand, the menu of what is shown. Points.

use super::Show;
use super::camera::Sight;
use super::colors::Colors;
use super::geometry::ground;
use super::marks::Marks;
use crate::picture::marks::{COP, PUSH, XI};
use eframe::egui::{self, Align2, Color32, FontId, Pos2, Shape, Stroke, Vec2};
use glam::DVec3;

/// sRGB with how much of it, 0..1.
fn ink([red, green, blue]: [u8; 3], alpha: f32) -> Color32 {
    Color32::from_rgb(red, green, blue).gamma_multiply(alpha)
}

/// Centre of mass with its plumb line, ξ, centre of pressure.
pub(super) fn points(painter: &egui::Painter, sight: &Sight, marks: &Marks, show: &Show, colors: &Colors) {
    let on_ground = |at: Option<glam::DVec2>| at.and_then(|at| sight.project(ground(at, marks.ground)));
    if show.com
        && let Some(com) = marks.overlay.com
    {
        let below = sight.project(DVec3::new(com.x, marks.ground, com.z));
        if let (Some(point), Some(below)) = (sight.project(com), below) {
            painter.extend(Shape::dashed_line(&[point, below], Stroke::new(2.6, ink(colors.halo, 0.45)), 4.0, 3.0));
            painter.extend(Shape::dashed_line(&[point, below], Stroke::new(1.3, ink(colors.ink, 0.9)), 4.0, 3.0));
            painter.circle_filled(below, 2.4, ink(colors.ink, 0.95));
            quartered(painter, point, 7.0);
        }
    }
    if show.cop
        && let Some(point) = on_ground(marks.overlay.cop)
    {
        painter.circle_filled(point, 5.0, ink([20, 22, 26], 0.95));
        painter.circle_filled(point, 3.3, ink(COP, 1.0));
    }
    if show.xi
        && let Some(point) = on_ground(marks.overlay.xi)
    {
        painter.circle_stroke(point, 5.5, Stroke::new(4.2, ink([255, 255, 255], 0.85)));
        for arm in [Vec2::new(8.5, 0.0), Vec2::new(0.0, 8.5)] {
            painter.line_segment([point - arm, point + arm], Stroke::new(1.6, ink(XI, 0.95)));
        }
        painter.circle_stroke(point, 5.5, Stroke::new(2.2, ink(XI, 1.0)));
    }
}

/// The mark of a centre of mass: a disc in four quarters.
fn quartered(painter: &egui::Painter, centre: Pos2, radius: f32) {
    painter.circle_filled(centre, radius + 1.6, ink([255, 255, 255], 0.95));
    painter.circle_filled(centre, radius, ink([20, 22, 26], 1.0));
    for first in [0.0, std::f32::consts::PI] {
        let corner = |step: u8| {
            let angle = first + std::f32::consts::FRAC_PI_2 * f32::from(step) / 8.0;
            centre + Vec2::angled(angle) * (radius - 1.0)
        };
        let corners = std::iter::once(centre).chain((0..=8).map(corner)).collect();
        painter.add(Shape::convex_polygon(corners, ink([255, 214, 64], 1.0), Stroke::NONE));
    }
}

/// Newtons beside an arrow.
pub(super) fn newtons(painter: &egui::Painter, at: Pos2, force: f64, colors: &Colors) {
    let text = format!("{force:.0} N");
    let font = FontId::proportional(13.0);
    let size = painter.layout_no_wrap(text.clone(), font.clone(), Color32::WHITE).size();
    let around = egui::Rect::from_center_size(at, size + Vec2::new(8.0, 3.0));
    painter.rect_filled(around, 4.0, ink(colors.halo, 0.75));
    painter.text(at, Align2::CENTER_CENTER, text, font, ink(PUSH, 1.0));
}

/// The push in hand: an arrow from the bone to the pointer and what it is worth.
pub(super) fn grip(painter: &egui::Painter, bone: Pos2, pointer: Pos2, force: f64, colors: &Colors) {
    let along = pointer - bone;
    let length = along.length();
    painter.circle_filled(bone, 5.5, ink(colors.halo, 0.9));
    painter.circle_filled(bone, 4.0, ink(PUSH, 1.0));
    if length > 2.0 {
        let way = along / length;
        let head = 14.0_f32.min(length);
        let neck = pointer - way * head;
        let side = way.rot90() * head * 0.5;
        painter.line_segment([bone, neck], Stroke::new(7.0, ink(colors.halo, 0.6)));
        painter.line_segment([bone, neck], Stroke::new(4.5, ink(PUSH, 1.0)));
        painter.add(Shape::convex_polygon(vec![pointer, neck + side, neck - side], ink(PUSH, 1.0), Stroke::NONE));
    }
    newtons(painter, pointer + Vec2::new(0.0, if along.y > 0.0 { 18.0 } else { -18.0 }), force, colors);
}

/// What is shown, as a menu in the corner. Whether something was switched.
pub(super) fn menu(ui: &mut egui::Ui, show: &mut Show, follows: &mut bool) {
    ui.menu_button("Show", |ui| {
        for (on, name, meaning) in show.switches() {
            ui.checkbox(on, name).on_hover_text(meaning);
        }
        ui.separator();
        ui.checkbox(follows, "Follow the character").on_hover_text("The eye goes with it");
    });
}
