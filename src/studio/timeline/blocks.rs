//! The entries of a lane: blocks with a middle that moves, an end that stretches, a knob for strength and an arrow for direction.
//!
//! Knob and ends lie over the block and are grabbed before it. While something is dragged its edits are one step of the history.

use super::{Frame, block, knob};
use crate::studio::command::Command;
use crate::studio::compass::{arrow, compass, point};
use crate::studio::document::{Edit, Entry, Lane, Place};
use crate::studio::strength::{direction, label, strength, with_direction, with_strength};
use eframe::egui::{self, Align2, Color32, CursorIcon, FontId, Rect, Sense, Stroke, pos2, vec2};

/// Points within which an edge catches another.
const CATCHES: f32 = 7.0;
/// Points that a knob is dragged from nothing to the most.
const KNOB_TRAVEL: f64 = 90.0;
/// Points; shorter blocks are drawn this long.
const SHORTEST: f32 = 12.0;

/// What is being dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct Grabbed {
    place: Place,
    /// As it was when the drag began.
    from: Entry,
    /// s, where in the entry the pointer took it.
    at: f64,
}

/// Draws a lane's entries.
pub(super) fn lane(
    ui: &mut egui::Ui,
    frame: &Frame,
    row: Rect,
    lane: Lane,
    grabbed: &mut Option<Grabbed>,
    free: bool,
    commands: &mut Vec<Command>,
) {
    let space = Rect::from_min_max(pos2(frame.area.left(), row.top()), row.max);
    let empty = ui.interact(space, ui.scope_id().with(("lane", lane)), Sense::click());
    empty.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Group, true, format!("{} lane", lane.name())));
    if let Some(pointer) = empty.interact_pointer_pos() {
        if empty.double_clicked() {
            let time = rounded(frame.map.time(pointer.x)).max(0.0);
            commands.push(Command::Add(lane, Some(time)));
        } else if empty.clicked() {
            commands.push(Command::Select(None));
        }
    }
    let entries = frame.input.document.entries(lane);
    let ends = ends(&entries, frame.input.document.scenario.duration);
    for (index, (entry, end)) in entries.iter().zip(&ends).enumerate() {
        let one = One { place: Place { lane, index }, entry, end: *end, space };
        one.ui(ui, frame, grabbed, free, commands);
    }
}

/// s, until when each lasts: as it says, or until the next of its lane begins, or the end.
fn ends(entries: &[Entry], duration: f64) -> Vec<f64> {
    let next = |start: f64| entries.iter().map(Entry::start).filter(|other| *other > start).fold(duration, f64::min);
    entries.iter().map(|entry| entry.end().unwrap_or_else(|| next(entry.start()))).collect()
}

/// An entry and where it is drawn.
struct One<'a> {
    place: Place,
    entry: &'a Entry,
    end: f64,
    space: Rect,
}

impl One<'_> {
    fn ui(
        &self,
        ui: &mut egui::Ui,
        frame: &Frame,
        grabbed: &mut Option<Grabbed>,
        free: bool,
        commands: &mut Vec<Command>,
    ) {
        let (left, right) = (frame.map.x(self.entry.start()), frame.map.x(self.end));
        let rect = Rect::from_x_y_ranges(
            left..=right.max(left + SHORTEST),
            self.space.top() + 2.0..=self.space.bottom() - 3.0,
        );
        if !rect.intersects(self.space) {
            return;
        }
        let id = ui.scope_id().with(("entry", self.place.lane, self.place.index));
        let body = ui.interact(rect.intersect(self.space), id, Sense::click_and_drag());
        let name = format!("{} {}", self.place.lane.name(), self.place.index + 1);
        body.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, self.selected(frame), name.clone()));
        let edge = Rect::from_center_size(pos2(rect.right(), rect.center().y), vec2(9.0, rect.height()));
        let edge = ui.interact(edge, id.with("end"), Sense::drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);
        edge.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, format!("{name} end")));
        let there = strength(self.entry);
        let handle = there.map(|there| {
            let y = egui::lerp(rect.bottom() - 4.0..=rect.top() + 4.0, there.share() as f32);
            let at = pos2(rect.left() + 6.0, y);
            let response = ui
                .interact(Rect::from_center_size(at, vec2(13.0, 13.0)), id.with("strength"), Sense::drag())
                .on_hover_cursor(CursorIcon::ResizeVertical);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, format!("{name} strength")));
            (at, response)
        });
        self.dragged(ui, frame, &body, grabbed, free, commands, |from, time, _| from.moved(time.max(0.0)));
        self.dragged(ui, frame, &edge, grabbed, free, commands, |from, _, end| from.stretched(end));
        if let (Some((_, response)), Some(there)) = (&handle, there) {
            let press = ui.input(|input| input.pointer.press_origin());
            if response.drag_started() {
                *grabbed = Some(Grabbed { place: self.place, from: self.entry.clone(), at: 0.0 });
                commands.push(Command::Select(Some(self.place)));
            }
            let held = grabbed.as_ref().filter(|held| held.place == self.place && response.dragged());
            if let (Some(held), Some(pointer), Some(press)) = (held, response.interact_pointer_pos(), press) {
                let first = strength(&held.from).map_or(0.0, |first| first.share());
                let value = there.at(first + f64::from(press.y - pointer.y) / KNOB_TRAVEL);
                commands.push(Command::Drag(Edit::Replace(self.place, with_strength(self.entry, value))));
            }
            if response.drag_stopped() {
                *grabbed = None;
                commands.push(Command::Release);
            }
        }
        if body.clicked() || body.drag_started() || edge.drag_started() {
            commands.push(Command::Select(Some(self.place)));
        }
        body.context_menu(|ui| self.menu(ui, commands));
        self.paint(ui, frame, rect, handle.map(|(at, _)| at), body.hovered());
        if body.hovered() && grabbed.is_none() {
            body.on_hover_text(self.told(frame));
        }
    }

    /// A drag of the whole or of an end: `change` gets the entry as it was, its new start and its new end.
    #[expect(clippy::too_many_arguments, reason = "what one frame has at hand")]
    fn dragged(
        &self,
        ui: &egui::Ui,
        frame: &Frame,
        response: &egui::Response,
        grabbed: &mut Option<Grabbed>,
        free: bool,
        commands: &mut Vec<Command>,
        change: impl Fn(&Entry, f64, f64) -> Entry,
    ) {
        let Some(pointer) = response.interact_pointer_pos() else {
            if response.drag_stopped() {
                *grabbed = None;
                commands.push(Command::Release);
            }
            return;
        };
        if response.drag_started() {
            let press = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
            let at = frame.map.time(press.x) - self.entry.start();
            *grabbed = Some(Grabbed { place: self.place, from: self.entry.clone(), at });
        }
        if let Some(held) = grabbed.as_ref().filter(|held| held.place == self.place && response.dragged()) {
            let free = free || ui.input(|input| input.modifiers.alt);
            let length = held.from.end().map_or(0.0, |end| end - held.from.start());
            let start = frame.map.time(pointer.x) - held.at;
            let snapped = if free { hundredths(start) } else { self.snap(frame, start, length) };
            let end = frame.map.time(pointer.x);
            let end = if free { hundredths(end) } else { self.snap(frame, end, 0.0) };
            commands.push(Command::Drag(Edit::Replace(self.place, change(&held.from, snapped, end))));
        }
        if response.drag_stopped() {
            *grabbed = None;
            commands.push(Command::Release);
        }
    }

    /// The nearest round time, edge of another entry, or playhead, for the start of something of that length.
    fn snap(&self, frame: &Frame, start: f64, length: f64) -> f64 {
        let mut near: Vec<f64> = vec![frame.input.time, 0.0, frame.input.document.scenario.duration];
        near.extend(frame.input.document.scenario.marker.iter().map(|marker| marker.time));
        for lane in Lane::ALL {
            for (index, entry) in frame.input.document.entries(lane).iter().enumerate() {
                if (Place { lane, index }) != self.place {
                    near.push(entry.start());
                    near.extend(entry.end());
                }
            }
        }
        let catches = frame.map.length(CATCHES);
        let off = near.iter().flat_map(|edge| [edge - start, edge - start - length]);
        let nearest = off.filter(|off| off.abs() < catches).min_by(|a, b| a.abs().total_cmp(&b.abs()));
        hundredths(nearest.map_or_else(|| rounded(start), |off| start + off))
    }

    fn menu(&self, ui: &mut egui::Ui, commands: &mut Vec<Command>) {
        if let Some(mut angle) = direction(self.entry) {
            let toward = if self.place.lane == Lane::Throw { "From" } else { "Toward" };
            ui.label(toward);
            let response = compass(ui, toward, &mut angle, 96.0);
            if response.changed() {
                commands.push(Command::Drag(Edit::Replace(self.place, with_direction(self.entry, angle))));
            }
            if response.drag_stopped() {
                commands.push(Command::Release);
            }
            ui.separator();
        }
        for (text, command) in [
            ("Copy", Command::Copy),
            ("Cut", Command::Cut),
            ("Duplicate", Command::Duplicate),
            ("Delete", Command::Delete),
        ] {
            if ui.button(text).clicked() {
                commands.push(Command::Select(Some(self.place)));
                commands.push(command);
                ui.close();
            }
        }
    }

    fn selected(&self, frame: &Frame) -> bool {
        frame.input.selected == Some(self.place)
    }

    fn fault<'f>(&self, frame: &'f Frame) -> Option<&'f crate::model::scenario_errors::Fault> {
        let path = format!("{}.{}", self.place.lane.name().to_lowercase(), self.place.index);
        let mine = |at: &str| at.strip_prefix(&path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        frame.input.faults.iter().find(|fault| mine(&fault.path))
    }

    fn told(&self, frame: &Frame) -> String {
        let times = format!("{:.2} to {:.2} s", self.entry.start(), self.end);
        let mut text = format!("{} {}, {times}", self.place.lane.name(), label(self.entry));
        if let Some(angle) = direction(self.entry) {
            text += &format!(", {:.0}°", angle.to_degrees());
        }
        if let Some(fault) = self.fault(frame) {
            text += &format!("\n{}: {}", fault.message, fault.remedy);
        }
        text
    }

    fn paint(&self, ui: &egui::Ui, frame: &Frame, rect: Rect, handle: Option<egui::Pos2>, hovered: bool) {
        let painter = ui.painter().with_clip_rect(self.space);
        let color = color(self.place.lane, ui.visuals().dark_mode);
        let bad = self.fault(frame).is_some();
        let selected = self.selected(frame);
        let strong = if selected || hovered { 1.0 } else { 0.8 };
        let rim = match (bad, selected) {
            (true, _) => Stroke::new(2.0, ui.visuals().error_fg_color),
            (_, true) => Stroke::new(2.0, ui.visuals().strong_text_color()),
            _ => Stroke::new(1.0, color.gamma_multiply(0.7)),
        };
        block(&painter, rect, color.gamma_multiply(0.55 * strong), rim);
        let ink = ui.visuals().strong_text_color();
        let mut x = rect.left() + if handle.is_some() { 15.0 } else { 6.0 };
        if let Some(angle) = direction(self.entry).filter(|_| rect.width() > 30.0) {
            let along = point(angle) * 9.0;
            arrow(&painter, pos2(x + 9.0, rect.center().y) - along, along * 2.0, ink);
            x += 22.0;
        }
        let text = painter.with_clip_rect(rect.shrink2(vec2(2.0, 0.0)).intersect(self.space));
        text.text(pos2(x, rect.center().y), Align2::LEFT_CENTER, label(self.entry), FontId::proportional(12.0), ink);
        if let Some(at) = handle {
            painter.line_segment([pos2(at.x, rect.bottom() - 3.0), at], Stroke::new(2.0, ink.gamma_multiply(0.5)));
            knob(&painter, at, color, ink);
        }
        if self.entry.end().is_some() {
            let x = rect.right() - 3.0;
            painter.line_segment(
                [pos2(x, rect.top() + 7.0), pos2(x, rect.bottom() - 7.0)],
                Stroke::new(1.5, ink.gamma_multiply(0.6)),
            );
        }
    }
}

fn rounded(time: f64) -> f64 {
    hundredths((time / super::SNAP).round() * super::SNAP)
}

fn hundredths(time: f64) -> f64 {
    (time * 100.0).round() / 100.0
}

/// The lane's colour.
pub(super) fn color(lane: Lane, dark: bool) -> Color32 {
    let [r, g, b] = match lane {
        Lane::Walk => [46, 160, 103],
        Lane::Turn => [38, 154, 168],
        Lane::Crouch => [92, 118, 208],
        Lane::Stand => [128, 96, 200],
        Lane::Push => [222, 66, 58],
        Lane::Pull => [226, 124, 44],
        Lane::Throw => [196, 70, 150],
        Lane::Carry => [158, 120, 70],
    };
    if dark { Color32::from_rgb(r, g, b) } else { Color32::from_rgb(r / 8 * 7 + 24, g / 8 * 7 + 24, b / 8 * 7 + 24) }
}
