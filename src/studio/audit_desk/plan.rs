//! Footprints from above, beside where the pendulum puts them, and the way of the centre of mass up to the playhead.
//!
//! Clip space, m, seen from above with the walk going up the picture, so that left is left. It goes with the playhead until it is dragged or
//! zoomed; a double click lets it go along again.

use super::colors;
use super::shown::{Motion, Preview, Print, Shown, flat};
use super::state::{Command, PlanView, State};
use crate::model::findings::{Rule, StepVerdict};
use eframe::egui::{
    self, Align2, Color32, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo, vec2,
};
use glam::{DVec2, DVec3};

/// Points a metre: at less, a footprint is a dot.
const LEAST_ZOOM: f64 = 130.0;
/// Points a metre.
const MOST_ZOOM: f64 = 2000.0;

/// Ground to picture and back.
#[derive(Clone, Copy, Debug)]
struct PlanMap {
    view: PlanView,
    rect: Rect,
    /// Which way goes up.
    up: DVec2,
}

impl PlanMap {
    fn to_screen(self, place: DVec2) -> Pos2 {
        let off = place - self.view.middle;
        // Seen from above, what is left of the way up is (up.z, -up.x).
        let (right, up) = (-off.dot(DVec2::new(self.up.y, -self.up.x)), off.dot(self.up));
        self.rect.center() + vec2((right * self.view.zoom) as f32, (-up * self.view.zoom) as f32)
    }

    fn to_ground(self, at: Pos2) -> DVec2 {
        let off = at - self.rect.center();
        let (right, up) = (f64::from(off.x) / self.view.zoom, -f64::from(off.y) / self.view.zoom);
        self.view.middle - DVec2::new(self.up.y, -self.up.x) * right + self.up * up
    }
}

/// Draws it over what is left of `ui`.
pub fn plan(ui: &mut Ui, state: &State, shown: &Shown, commands: &mut Vec<Command>) {
    let motion = shown.motion(state.preview);
    ui.horizontal(|ui| {
        ui.strong("Footprints");
        ui.weak("from above; dashed: predicted");
    });
    let size = ui.available_size().max(vec2(120.0, 100.0));
    let (rect, background) = ui.allocate_exact_size(size, Sense::click_and_drag());
    background.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "Footprints from above"));
    let map = PlanMap { view: state.plan.unwrap_or_else(|| along(motion, state, rect)), rect, up: way(motion) };
    moved(ui, &map, &background, commands);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
    grid(ui, &painter, &map);
    if state.preview == Preview::Both && shown.after.is_some() {
        for print in &shown.before.prints {
            outline(&painter, &map, print, ui.visuals().weak_text_color());
        }
    }
    for print in &motion.prints {
        sole(ui, &painter, &map, print, state, motion);
    }
    path(ui, &painter, &map, motion, state);
    for (index, step) in motion.findings.steps.iter().enumerate() {
        let was = earlier(shown, state.preview, step);
        prediction(ui, &painter, &map, (index, step, was), state, motion, commands);
    }
}

/// m: how far off the same step is in the file, where that is another number.
fn earlier(shown: &Shown, preview: Preview, step: &StepVerdict) -> Option<f64> {
    shown.after.as_ref().filter(|_| preview != Preview::Original)?;
    let same = |was: &&StepVerdict| was.foot == step.foot && was.touch_down.abs_diff(step.touch_down) <= 3;
    let was = shown.before.findings.steps.iter().find(same)?.error_m;
    ((was - step.error_m).abs() > 0.005).then_some(was)
}

/// The way of the walk; ahead where it goes nowhere.
fn way(motion: &Motion) -> DVec2 {
    let (first, last) = (motion.rows.first(), motion.rows.last());
    let gone = first.zip(last).map_or(DVec2::ZERO, |(first, last)| flat(last.com - first.com));
    if gone.length() > 0.5 { gone.normalize() } else { DVec2::Y }
}

/// All of it, or what is around the playhead where all would be too small.
fn along(motion: &Motion, state: &State, rect: Rect) -> PlanView {
    let map = PlanMap { view: PlanView { middle: DVec2::ZERO, zoom: 1.0 }, rect, up: way(motion) };
    let outlines = motion.prints.iter().flat_map(|print| &print.outline);
    let points = outlines.map(|point| map.to_screen(flat(*point)) - rect.center());
    let (low, high) = points
        .fold((egui::Vec2::INFINITY, -egui::Vec2::INFINITY), |(low, high), point| (low.min(point), high.max(point)));
    let com = motion.rows.get(motion.frame(state.playback.time)).map_or(DVec2::ZERO, |row| flat(row.com));
    let extent = high - low;
    if !extent.is_finite() || !com.is_finite() {
        return PlanView { middle: com, zoom: LEAST_ZOOM };
    }
    let room =
        f64::from((rect.width() - 70.0) / extent.x.max(0.3)).min(f64::from((rect.height() - 50.0) / extent.y.max(0.3)));
    if room >= LEAST_ZOOM {
        let middle = map.to_ground(rect.center() + 0.5 * (low + high));
        return PlanView { middle, zoom: room.min(320.0) };
    }
    let selected = state.step.and_then(|step| motion.findings.steps.get(step)).map(|step| DVec2::from(step.actual));
    let there = |place: &DVec2| !state.playback.playing && place.distance(com) < 1.2;
    // What is to come has more room than what was.
    let ahead = map.up * 0.2 * f64::from(rect.height()) / LEAST_ZOOM;
    PlanView { middle: selected.filter(there).unwrap_or(com + ahead), zoom: LEAST_ZOOM }
}

fn moved(ui: &Ui, map: &PlanMap, background: &egui::Response, commands: &mut Vec<Command>) {
    let PlanView { middle, zoom } = map.view;
    if background.double_clicked() {
        commands.push(Command::Plan(None));
        return;
    }
    if background.dragged() {
        let by = map.to_ground(map.rect.center() + background.drag_delta()) - middle;
        commands.push(Command::Plan(Some(PlanView { middle: middle - by, zoom })));
    }
    if let Some(at) = ui.ctx().pointer_hover_pos().filter(|at| map.rect.contains(*at) && background.contains_pointer())
    {
        let (pinch, scroll) = ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta().y));
        let factor = f64::from(pinch) * f64::from(scroll * 0.004).exp();
        if (factor - 1.0).abs() > 1e-6 {
            let (under, wanted) = (map.to_ground(at), (zoom * factor).clamp(10.0, MOST_ZOOM));
            let middle = under + (middle - under) * (zoom / wanted);
            commands.push(Command::Plan(Some(PlanView { middle, zoom: wanted })));
        }
    }
}

/// Lines a metre apart, half a metre where there is room; a scale.
fn grid(ui: &Ui, painter: &Painter, map: &PlanMap) {
    let color = ui.visuals().widgets.noninteractive.bg_stroke.color.gamma_multiply(0.6);
    let apart = if map.view.zoom > 90.0 { 0.5 } else { 1.0 };
    let reach = f64::from(map.rect.width().max(map.rect.height())) / map.view.zoom;
    let lines = (reach / apart).ceil().min(100.0) as i32;
    let middle = (map.view.middle / apart).round() * apart;
    for line in -lines..=lines {
        let by = f64::from(line) * apart;
        for (from, to) in
            [(DVec2::new(by, -reach), DVec2::new(by, reach)), (DVec2::new(-reach, by), DVec2::new(reach, by))]
        {
            painter.line_segment([map.to_screen(middle + from), map.to_screen(middle + to)], Stroke::new(1.0, color));
        }
    }
    let (left, bottom) = (map.rect.left() + 8.0, map.rect.bottom() - 8.0);
    let weak = ui.visuals().weak_text_color();
    painter.hline(left..=left + (apart * map.view.zoom) as f32, bottom, Stroke::new(1.5, weak));
    let font = TextStyle::Small.resolve(ui.style());
    painter.text(Pos2::new(left, bottom - 3.0), Align2::LEFT_BOTTOM, format!("{apart} m"), font, weak);
}

fn corners(map: &PlanMap, outline: &[DVec3], by: DVec2) -> Vec<Pos2> {
    outline.iter().map(|point| map.to_screen(flat(*point) + by)).collect()
}

fn outline(painter: &Painter, map: &PlanMap, print: &Print, color: Color32) {
    painter.add(Shape::closed_line(corners(map, &print.outline, DVec2::ZERO), Stroke::new(1.0, color)));
}

fn sole(ui: &Ui, painter: &Painter, map: &PlanMap, print: &Print, state: &State, motion: &Motion) {
    let color = colors::foot(print.side, ui.visuals());
    let frame = motion.frame(state.playback.time);
    let (bears, come) = ((print.start..=print.end).contains(&frame), print.start <= frame);
    let fill = color.gamma_multiply(if bears {
        0.75
    } else if come {
        0.4
    } else {
        0.15
    });
    let line = Stroke::new(if bears { 2.0 } else { 1.0 }, color);
    painter.add(Shape::convex_polygon(corners(map, &print.outline, DVec2::ZERO), fill, line));
}

fn path(ui: &Ui, painter: &Painter, map: &PlanMap, motion: &Motion, state: &State) {
    let frame = motion.frame(state.playback.time);
    let way: Vec<Pos2> = motion.rows.iter().take(frame + 1).map(|row| map.to_screen(flat(row.com))).collect();
    let color = ui.visuals().text_color();
    let now = way.last().copied();
    if way.len() > 1 {
        painter.line(way, Stroke::new(1.5, color.gamma_multiply(0.7)));
    }
    if let Some(now) = now {
        painter.circle(now, 4.0, ui.visuals().extreme_bg_color, Stroke::new(2.0, color));
    }
    if let Some(row) = motion.rows.get(frame) {
        let xi = colors::rule(Rule::Balance, ui.visuals());
        painter.circle_filled(map.to_screen(row.xi), 3.5, xi);
    }
}

/// Where the pendulum puts a step, joined with where it is, and by how much it is off.
fn prediction(
    ui: &Ui,
    painter: &Painter,
    map: &PlanMap,
    (index, step, was): (usize, &StepVerdict, Option<f64>),
    state: &State,
    motion: &Motion,
    commands: &mut Vec<Command>,
) {
    let (actual, predicted) = (DVec2::from(step.actual), DVec2::from(step.predicted));
    let flagged = motion.findings.flags.iter().any(|flag| {
        flag.rule == Rule::FootPlacement
            && flag.foot == Some(step.foot)
            && (flag.start..=flag.end).contains(&step.touch_down)
    });
    let selected = state.step == Some(index);
    let visuals = ui.visuals();
    let quiet = visuals.text_color().gamma_multiply(0.8);
    let color = if flagged { colors::rule(Rule::FootPlacement, visuals) } else { quiet };
    let print = motion.prints.iter().find(|print| print.step == Some(index));
    if let Some(print) = print {
        let mut dashed = corners(map, &print.outline, predicted - actual);
        dashed.extend(dashed.first().copied());
        painter.extend(Shape::dashed_line(&dashed, Stroke::new(1.2, color), 4.0, 3.0));
    }
    let (from, to) = (map.to_screen(actual), map.to_screen(predicted));
    painter.line_segment([from, to], Stroke::new(if flagged || selected { 2.5 } else { 1.5 }, color));
    painter.circle_filled(to, 2.5, color);
    let response = ui.interact(touch(map, print, from), ui.scope_id().with(("step", index)), Sense::click());
    let cm = 100.0 * step.error_m;
    let name = format!("step {} {} {cm:.1} cm", index + 1, step.foot);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, &name));
    if selected && let Some(print) = print {
        let ring = corners(map, &print.outline, DVec2::ZERO);
        painter.add(Shape::closed_line(ring, Stroke::new(2.5, visuals.strong_text_color())));
    }
    if map.view.zoom > 60.0 {
        let left = step.foot == "left";
        let aside = if left { vec2(-9.0, 0.0) } else { vec2(9.0, 0.0) };
        let anchor = if left { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        let edge = touch(map, print, from);
        let at = Pos2::new(if left { edge.left() } else { edge.right() }, from.y) + aside * 0.5;
        let was = was.map(|was| format!(" (was {:.0})", 100.0 * was)).unwrap_or_default();
        painter.text(at, anchor, format!("{cm:.0} cm{was}"), TextStyle::Small.resolve(ui.style()), color);
    }
    if response.clicked() {
        commands.push(Command::Footprint(index));
    }
    response.on_hover_text(told(step));
}

/// Where a click means that step.
fn touch(map: &PlanMap, print: Option<&Print>, at: Pos2) -> Rect {
    let points = print.map(|print| corners(map, &print.outline, DVec2::ZERO)).unwrap_or_default();
    let rect =
        if points.is_empty() { Rect::from_center_size(at, vec2(16.0, 16.0)) } else { Rect::from_points(&points) };
    rect.intersect(map.rect.expand(1.0))
}

fn told(step: &StepVerdict) -> String {
    let part = |value: f64, plus: &str, minus: &str| {
        format!("{:.1} cm too far {}", 100.0 * value.abs(), if value > 0.0 { plus } else { minus })
    };
    format!(
        "{} foot, down at frame {}: {}, {}",
        step.foot,
        step.touch_down,
        part(step.error_forward_m, "ahead", "behind"),
        part(step.error_sideways_m, "out", "in")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_goes_up_and_left_is_left() {
        let view = PlanView { middle: DVec2::new(1.0, 2.0), zoom: 100.0 };
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 400.0));
        for turn in [0.0, 1.0, 2.5, -2.0] {
            let up = DVec2::from_angle(turn);
            let map = PlanMap { view, rect, up };
            let ahead = map.to_screen(view.middle + up);
            assert!((ahead - (rect.center() + vec2(0.0, -100.0))).length() < 1e-3, "{ahead}");
            // A character that looks along (x, z) = up has its left at up cross forward: for +Z that is +X.
            let left = DVec3::Y.cross(DVec3::new(up.x, 0.0, up.y));
            let left = map.to_screen(view.middle + flat(left));
            assert!((left - (rect.center() + vec2(-100.0, 0.0))).length() < 1e-3, "{left}");
            let place = DVec2::new(-3.0, 0.7);
            assert!(map.to_ground(map.to_screen(place)).distance(place) < 1e-4);
        }
    }
}
