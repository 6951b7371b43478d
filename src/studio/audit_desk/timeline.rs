//! The clip over time: flags coloured by rule, corrections, contacts of both feet with their steps, where nothing is said; the playhead.
//!
//! The wheel pans, with ctrl it zooms; a drag moves the playhead, a drag with another button pans. Frames count from 0 and a bar covers the
//! whole of its first and last.

use super::colors;
use super::repairs::Decision;
use super::shown::{Shown, side_of};
use super::state::{Command, State};
use crate::model::Side;
use crate::model::findings::Flag;
use crate::studio::time_map::TimeMap;
use eframe::egui::{
    self, Align2, Color32, FontId, Painter, PointerButton, Pos2, Rect, Response, Role, Sense, Shape, Stroke, TextStyle,
    Ui, WidgetInfo, pos2, vec2,
};

/// Points: the names of lanes.
const GUTTER: f32 = 84.0;
/// Points: the ruler.
const RULER: f32 = 22.0;
/// Points between lanes.
const GAP: f32 = 4.0;
/// Flags at the same time stand in so many rows at most.
const ROWS: usize = 3;

struct Lanes<'a> {
    painter: Painter,
    map: TimeMap,
    fps: f64,
    all: Rect,
    small: FontId,
    state: &'a State,
    shown: &'a Shown,
}

/// Draws it over what is left of `ui`.
pub fn timeline(ui: &mut Ui, state: &State, shown: &Shown, commands: &mut Vec<Command>) {
    let size = ui.available_size().max(vec2(200.0, 110.0));
    let (whole, background) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let all = Rect::from_min_max(pos2(whole.left() + GUTTER, whole.top()), whole.max);
    let fps = shown.before.capture.fps;
    let map = TimeMap::new(state.window, all.left()..=all.right());
    let painter = ui.painter_at(whole);
    let small = TextStyle::Small.resolve(ui.style());
    let lanes = Lanes { painter, map, fps, all, small, state, shown };
    let frame = shown.before.frame(state.playback.time);
    background.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Slider, true, "Timeline");
        info.value = Some(frame as f64);
        info
    });
    moved(ui, &lanes, &background, commands);

    let ruler = Rect::from_min_max(all.min, pos2(all.right(), all.top() + RULER));
    lanes.ruler(ui, ruler);
    let left = all.height() - RULER;
    let unit = ((left - 4.0 * GAP) / 5.4).max(12.0);
    let mut top = ruler.bottom() + GAP;
    let mut lane = |height: f32| {
        let rect = Rect::from_min_size(pos2(all.left(), top), vec2(all.width(), height));
        top += height + GAP;
        rect
    };
    let (flags, repairs) = (lane(unit * 2.4), lane(unit));
    let feet = [lane(unit), lane(unit)];
    for (rect, name) in [(flags, "Flags"), (repairs, "Corrections"), (feet[0], "Left foot"), (feet[1], "Right foot")] {
        lanes.lane(ui, whole.left(), rect, name);
    }
    lanes.silences(ui, flags, &background);
    lanes.flags(ui, flags, commands);
    lanes.repairs(ui, repairs, commands);
    lanes.feet(ui, feet);
    lanes.playhead(ui, ruler, feet[1].bottom());
}

/// The wheel, drags and clicks.
fn moved(ui: &Ui, lanes: &Lanes, background: &Response, commands: &mut Vec<Command>) {
    let window = lanes.state.window;
    let primary = background.clicked() || background.dragged_by(PointerButton::Primary);
    if primary && let Some(at) = background.interact_pointer_pos() {
        commands.push(Command::Seek(snapped(lanes.map.time(at.x), lanes.fps)));
    }
    for button in [PointerButton::Secondary, PointerButton::Middle] {
        if background.dragged_by(button) {
            commands.push(Command::Window(window.panned(-lanes.map.length(background.drag_delta().x))));
        }
    }
    if let Some(at) = ui.ctx().pointer_hover_pos().filter(|at| lanes.all.contains(*at)) {
        let (zoom, scroll) = ui.input(|input| (input.zoom_delta(), input.smooth_scroll_delta()));
        if zoom != 1.0 {
            commands.push(Command::Window(window.zoomed(f64::from(zoom), lanes.map.time(at.x))));
        } else if scroll != egui::Vec2::ZERO {
            let by = if scroll.x.abs() > scroll.y.abs() { scroll.x } else { scroll.y };
            commands.push(Command::Window(window.panned(-lanes.map.length(by))));
        }
    }
}

/// s, of the nearest frame.
fn snapped(time: f64, fps: f64) -> f64 {
    (time * fps).round() / fps
}

impl Lanes<'_> {
    /// What a span of frames covers of a lane; at least so wide that it can be seen.
    fn bar(&self, lane: Rect, start: usize, end: usize) -> Rect {
        let from = self.map.x((start as f64 - 0.5) / self.fps).max(self.all.left());
        let to = self.map.x((end as f64 + 0.5) / self.fps).min(self.all.right());
        Rect::from_min_max(pos2(from, lane.top()), pos2(to.max(from + 3.0), lane.bottom()))
    }

    fn seen(&self, start: usize, end: usize) -> bool {
        let edge = |frame: f64| self.map.x(frame / self.fps);
        edge(start as f64 - 0.5) < self.all.right() && edge(end as f64 + 0.5) > self.all.left()
    }

    fn ruler(&self, ui: &Ui, rect: Rect) {
        let weak = ui.visuals().weak_text_color();
        let line = ui.visuals().widgets.noninteractive.bg_stroke.color;
        let wide = self.map.x(1.0 / self.fps) - self.map.x(0.0);
        let steps = [1_usize, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000];
        let step = steps.into_iter().find(|step| wide * *step as f32 >= 56.0).unwrap_or(50_000);
        let fine = steps.into_iter().find(|step| wide * *step as f32 >= 8.0).unwrap_or(step);
        let last = self.shown.before.rows.len().saturating_sub(1);
        let first = (self.map.time(self.all.left()) * self.fps).max(0.0) as usize / fine * fine;
        for frame in (first..=last).step_by(fine).take(2000) {
            let x = self.map.x(frame as f64 / self.fps);
            if x > self.all.right() {
                break;
            }
            let named = frame % step == 0;
            let from = if named { rect.bottom() - 8.0 } else { rect.bottom() - 4.0 };
            self.painter.vline(x, from..=rect.bottom(), Stroke::new(1.0, if named { weak } else { line }));
            if named {
                self.painter.text(pos2(x + 3.0, rect.top()), Align2::LEFT_TOP, frame, self.small.clone(), weak);
            }
        }
    }

    fn lane(&self, ui: &Ui, left: f32, rect: Rect, name: &str) {
        self.painter.rect_filled(rect, 3.0, ui.visuals().faint_bg_color);
        let color = match name {
            "Left foot" => colors::foot(Side::Left, ui.visuals()),
            "Right foot" => colors::foot(Side::Right, ui.visuals()),
            _ => ui.visuals().text_color(),
        };
        self.painter.text(pos2(left + 2.0, rect.center().y), Align2::LEFT_CENTER, name, self.small.clone(), color);
    }

    /// Hatched where nothing is said.
    fn silences(&self, ui: &Ui, lane: Rect, background: &Response) {
        let color = ui.visuals().weak_text_color().gamma_multiply(0.5);
        for span in &self.shown.before.findings.abstained {
            if !self.seen(span.start, span.end) {
                continue;
            }
            let bar = self.bar(lane, span.start, span.end);
            let hatch = self.painter.with_clip_rect(bar);
            let mut x = bar.left() - bar.height();
            while x < bar.right() {
                hatch.line_segment([pos2(x, bar.bottom()), pos2(x + bar.height(), bar.top())], Stroke::new(1.0, color));
                x += 7.0;
            }
            if background.hover_pos().is_some_and(|at| bar.contains(at)) {
                background.show_tooltip_text(format!("Not judged, frames {}–{}: {}", span.start, span.end, span.why));
            }
        }
    }

    fn flags(&self, ui: &Ui, lane: Rect, commands: &mut Vec<Command>) {
        let flags = &self.shown.before.findings.flags;
        let rows = rows(flags);
        let height = (lane.height() - 2.0) / (rows.iter().max().map_or(1, |row| row + 1)).max(2) as f32;
        for (index, (flag, row)) in flags.iter().zip(rows).enumerate() {
            if self.state.hidden.contains(&flag.rule) || !self.seen(flag.start, flag.end) {
                continue;
            }
            let top = lane.top() + 1.0 + height * row as f32;
            let bar = self.bar(lane, flag.start, flag.end);
            let bar = Rect::from_min_max(pos2(bar.left(), top), pos2(bar.right(), top + height - 1.0));
            let selected = self.state.flag == Some(index);
            let response =
                ui.interact(bar.expand2(vec2(2.0, 0.0)), ui.scope_id().with(("flag", index)), Sense::click());
            response.widget_info(|| WidgetInfo::selected(Role::Button, true, selected, label(flag)));
            let color = colors::rule(flag.rule, ui.visuals());
            let fill = if selected || response.hovered() { color } else { color.gamma_multiply(0.75) };
            self.painter.rect_filled(bar, 2.0, fill);
            if selected {
                outlined(&self.painter, bar, ui.visuals().strong_text_color());
            }
            if response.clicked() {
                commands.push(Command::Flag(index));
            }
            response.on_hover_text(format!("{}: {}", colors::title(flag.rule), flag.why));
        }
    }

    fn repairs(&self, ui: &Ui, lane: Rect, commands: &mut Vec<Command>) {
        let Some(repairs) = self.state.now() else { return };
        for (index, repair) in repairs.list.iter().enumerate() {
            if !self.seen(repair.start, repair.end) {
                continue;
            }
            // Neighbours share the swing between them: each a little lower than the last.
            let shift = if index % 2 == 0 { 0.0 } else { 0.4 * lane.height() };
            let bar = self.bar(lane, repair.start, repair.end);
            let bar =
                Rect::from_min_size(pos2(bar.left(), lane.top() + 1.0 + shift), vec2(bar.width(), 0.5 * lane.height()));
            let color = colors::decision(repair.decision, ui.visuals());
            let response = ui.interact(bar, ui.scope_id().with(("repair", index)), Sense::click());
            let (from, to) = (repair.start, repair.end);
            let told = format!("correction {from}-{to}, {}", colors::word(repair.decision));
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &told));
            match repair.decision {
                Decision::Accepted => {
                    self.painter.rect_filled(bar, 2.0, color);
                }
                Decision::Pending => {
                    self.painter.rect_filled(bar, 2.0, color.gamma_multiply(0.35));
                    outlined(&self.painter, bar, color);
                }
                Decision::Rejected => {
                    outlined(&self.painter, bar, color);
                    self.painter.hline(bar.x_range(), bar.center().y, Stroke::new(1.0, color));
                }
            }
            if self.state.selected_repair() == Some(index) {
                outlined(&self.painter, bar.expand(1.0), ui.visuals().strong_text_color());
            }
            let answered = |flag: &Flag| repair.answers_any(&[crate::correct::Target::of(flag)]);
            if response.clicked()
                && let Some(flag) = self.state.flags().iter().position(answered)
            {
                commands.push(Command::Flag(flag));
            }
            response.on_hover_text(format!("{} ({})", repair.what, colors::word(repair.decision)));
        }
    }

    fn feet(&self, ui: &Ui, lanes: [Rect; 2]) {
        let motion = self.shown.motion(self.state.preview);
        for contact in motion.findings.contacts.iter().filter(|contact| self.seen(contact.start, contact.end)) {
            let side = side_of(contact.foot);
            let bar = self.bar(lanes[side as usize], contact.start, contact.end);
            let bar = match contact.part {
                "heel" => Rect::from_min_max(pos2(bar.left(), bar.center().y), bar.max),
                "ball" => Rect::from_min_max(bar.min, pos2(bar.right(), bar.center().y)),
                _ => bar,
            };
            self.painter.rect_filled(bar, 1.0, colors::foot(side, ui.visuals()).gamma_multiply(0.55));
        }
        for (index, step) in motion.findings.steps.iter().enumerate() {
            if !self.seen(step.touch_down, step.touch_down) {
                continue;
            }
            let side = side_of(step.foot);
            let lane = lanes[side as usize];
            let x = self.map.x(step.touch_down as f64 / self.fps);
            let selected = self.state.step == Some(index);
            let color = if selected { ui.visuals().strong_text_color() } else { colors::foot(side, ui.visuals()) };
            let half = if selected { 6.0 } else { 4.0 };
            let corners =
                vec![pos2(x - half, lane.top()), pos2(x + half, lane.top()), pos2(x, lane.top() + 1.6 * half)];
            self.painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
        }
    }

    fn playhead(&self, ui: &Ui, ruler: Rect, bottom: f32) {
        let x = self.map.x(self.state.playback.time);
        if x < self.all.left() - 1.0 || x > self.all.right() + 1.0 {
            return;
        }
        let color = ui.visuals().selection.stroke.color;
        self.painter.vline(x, ruler.top()..=bottom, Stroke::new(1.5, color));
        let frame = self.shown.before.frame(self.state.playback.time);
        let text = self.painter.layout_no_wrap(frame.to_string(), self.small.clone(), ui.visuals().extreme_bg_color);
        let plate =
            Rect::from_center_size(Pos2::new(x, ruler.top() + 0.5 * text.size().y + 1.0), text.size() + vec2(8.0, 2.0));
        self.painter.rect_filled(plate, 3.0, color);
        self.painter.galley(plate.center() - 0.5 * text.size(), text, color);
    }
}

/// Which row of the lane each flag stands in: the first that is free.
fn rows(flags: &[Flag]) -> Vec<usize> {
    let mut free = [0_usize; ROWS];
    let place = |flag: &Flag| {
        let row = (0..ROWS).find(|row| free[*row] <= flag.start).unwrap_or(ROWS - 1);
        free[row] = free[row].max(flag.end + 1);
        row
    };
    flags.iter().map(place).collect()
}

fn outlined(painter: &Painter, rect: Rect, color: Color32) {
    painter.rect_stroke(rect, 2.0, Stroke::new(1.0, color), egui::StrokeKind::Inside);
}

/// Its name, for whoever cannot see it: "foot-slide 120-133 left".
pub fn label(flag: &Flag) -> String {
    let foot = flag.foot.map(|foot| format!(" {foot}")).unwrap_or_default();
    format!("{} {}-{}{foot}", flag.rule.name(), flag.start, flag.end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::findings::Rule;

    fn flag(start: usize, end: usize) -> Flag {
        let (severity, measured, predicted, delta_m, why) = (0.6, 0.0, 0.0, 0.1, String::new());
        Flag { start, end, rule: Rule::FootSlide, foot: Some("left"), severity, measured, predicted, delta_m, why }
    }

    #[test]
    fn flags_that_share_frames_stand_in_rows_and_have_names() {
        let flags = [flag(0, 9), flag(5, 20), flag(9, 12), flag(10, 30), flag(11, 12), flag(40, 41)];
        assert_eq!(rows(&flags), [0, 1, 2, 0, 2, 0]);
        assert_eq!(label(&flags[1]), "foot-slide 5-20 left");
        assert_eq!(label(&Flag { foot: None, rule: Rule::Balance, ..flags[0].clone() }), "balance 0-9");
    }

    #[test]
    fn a_click_means_a_whole_frame() {
        assert!((snapped(0.51, 30.0) - 0.5).abs() < 1e-12 && (snapped(0.52, 30.0) - 16.0 / 30.0).abs() < 1e-12);
    }
}
