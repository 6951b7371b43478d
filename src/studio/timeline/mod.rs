//! The timeline: lanes of entries that are dragged, stretched and strengthened, and beneath them what the clip says of itself.
//!
//! It reads the document and gives commands. [`blocks`] are the entries, [`tracks`] the clip's contacts, flags and events. Times s, places
//! egui points.

mod blocks;
mod markers;
mod platform;
pub mod tracks;

use super::command::Command;
use super::document::{Document, Lane, Place};
use super::simulate::Shown;
use super::time_map::{TimeMap, TimeWindow};
use blocks::Grabbed;
use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, StrokeKind, pos2, vec2};

/// Width of the lanes' names.
const HEAD: f32 = 96.0;
/// Height of the ruler.
const RULER: f32 = 22.0;
/// Height of a lane of entries.
const LANE: f32 = 25.0;
/// s, entries come to rest on these.
const SNAP: f64 = 0.05;

/// What the timeline keeps from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    window: Option<TimeWindow>,
    grabbed: Option<Grabbed>,
    /// Entries come to rest on round times and on others' edges.
    pub free: bool,
}

/// What it shows.
pub struct Input<'a> {
    /// The document.
    pub document: &'a Document,
    /// The clip.
    pub shown: Option<&'a Shown>,
    /// The clip is the document's.
    pub fresh: bool,
    /// The selected entry.
    pub selected: Option<Place>,
    /// s, the playhead.
    pub time: f64,
    /// Paths of what is wrong, and the words.
    pub faults: &'a [crate::model::scenario_errors::Fault],
}

/// What one frame's lanes share.
struct Frame<'a> {
    map: TimeMap,
    input: &'a Input<'a>,
    area: Rect,
}

impl Timeline {
    /// The times that it shows.
    pub fn window(&self, duration: f64) -> TimeWindow {
        self.window.unwrap_or(TimeWindow::whole(duration))
    }

    /// All of the clip again.
    pub fn fit(&mut self) {
        self.window = None;
    }

    /// Draws it; the commands are what the person did.
    pub fn ui(&mut self, ui: &mut egui::Ui, input: &Input) -> Vec<Command> {
        let mut commands = Vec::new();
        let duration = input.document.scenario.duration.max(0.1);
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let whole = ui.available_rect_before_wrap();
            let area = Rect::from_min_max(pos2(whole.left() + HEAD, whole.top()), whole.max);
            self.navigate(ui, area, duration);
            let map = TimeMap::new(self.window(duration), area.left()..=area.right());
            let frame = Frame { map, input, area };
            let top = whole.top();
            let ruler = ruler(ui, &frame, duration, &mut commands);
            for lane in Lane::ALL {
                let row = row(ui, LANE);
                head(ui, row, lane, input.time, &mut commands);
                blocks::lane(ui, &frame, row, lane, &mut self.grabbed, self.free, &mut commands);
            }
            platform::lane(ui, &frame, LANE, &mut commands);
            tracks::ui(ui, &frame.map, input.shown, input.fresh, &mut commands);
            let bottom = ui.min_rect().bottom();
            let clip = Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), bottom));
            markers::ui(ui, &frame, ruler, bottom, &mut commands);
            playhead(ui, &frame, clip);
        });
        commands
    }

    /// Wheel and middle button: shift, and zoom with Ctrl.
    fn navigate(&mut self, ui: &egui::Ui, area: Rect, duration: f64) {
        let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|at| area.contains(*at)) else { return };
        let (scroll, zoom, middle, moved) = ui.input(|input| {
            let middle = input.pointer.middle_down();
            (input.smooth_scroll_delta(), input.zoom_delta(), middle, input.pointer.delta())
        });
        let window = self.window(duration);
        let map = TimeMap::new(window, area.left()..=area.right());
        let mut next = window;
        if zoom != 1.0 {
            next = next.zoomed(f64::from(zoom), map.time(pointer.x));
        }
        let across = if middle { moved.x } else { scroll.x };
        if across != 0.0 {
            next = next.panned(-map.length(across));
        }
        if next != window {
            self.window = Some(next);
        }
    }
}

/// The next row of a height, over the whole width.
fn row(ui: &mut egui::Ui, height: f32) -> Rect {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    rect
}

/// A lane's name, and a button that adds to it.
fn head(ui: &mut egui::Ui, row: Rect, lane: Lane, time: f64, commands: &mut Vec<Command>) {
    let name = Rect::from_min_size(row.min, vec2(HEAD - 26.0, row.height()));
    let visuals = ui.visuals();
    ui.painter().line_segment([row.left_bottom(), row.right_bottom()], visuals.widgets.noninteractive.bg_stroke);
    let at = pos2(name.left() + 8.0, name.center().y);
    ui.painter().text(at, Align2::LEFT_CENTER, lane.name(), FontId::proportional(13.0), visuals.text_color());
    let button = Rect::from_center_size(pos2(row.left() + HEAD - 15.0, row.center().y), vec2(18.0, 18.0));
    let plus = ui.put(button, egui::Button::new("+").small());
    let label = format!("Add {}", lane.name().to_lowercase());
    plus.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, label.clone()));
    if plus.on_hover_text(format!("{label} at {time:.2} s: {}", lane.hint())).clicked() {
        commands.push(Command::Add(lane, None));
    }
}

/// Seconds along the top; dragging in it moves the playhead.
fn ruler(ui: &mut egui::Ui, frame: &Frame, duration: f64, commands: &mut Vec<Command>) -> Rect {
    let row = row(ui, RULER);
    let bar = Rect::from_min_max(pos2(frame.area.left(), row.top()), row.max);
    let response = ui.interact(bar, ui.scope_id().with("ruler"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Playhead"));
    if let Some(pointer) = response.interact_pointer_pos() {
        commands.push(Command::Seek(frame.map.time(pointer.x)));
    }
    let painter = ui.painter().with_clip_rect(bar);
    let (text, line) = (ui.visuals().weak_text_color(), ui.visuals().widgets.noninteractive.bg_stroke);
    let clip = Rect::from_x_y_ranges(frame.map.x(0.0)..=frame.map.x(duration), bar.y_range());
    painter.rect_filled(clip, 0.0, ui.visuals().faint_bg_color);
    let (ticks, step) = frame.map.ticks(56.0);
    let digits = if step < 0.01 {
        3
    } else if step < 0.1 {
        2
    } else if step < 1.0 {
        1
    } else {
        0
    };
    for tick in ticks {
        let x = frame.map.x(tick);
        painter.line_segment([pos2(x, bar.bottom() - 5.0), pos2(x, bar.bottom())], Stroke::new(1.0, text));
        painter.text(
            pos2(x, bar.center().y - 2.0),
            Align2::CENTER_CENTER,
            format!("{tick:.digits$}"),
            FontId::proportional(11.0),
            text,
        );
    }
    painter.line_segment([bar.left_bottom(), bar.right_bottom()], line);
    bar
}

/// A line through everything.
fn playhead(ui: &egui::Ui, frame: &Frame, clip: Rect) {
    let x = frame.map.x(frame.input.time);
    let painter = ui.painter().with_clip_rect(clip);
    let color = Color32::from_rgb(236, 84, 64);
    painter.line_segment([pos2(x, clip.top() + 8.0), pos2(x, clip.bottom())], Stroke::new(1.5, color));
    let top = clip.top();
    let grip = vec![
        pos2(x - 6.0, top),
        pos2(x + 6.0, top),
        pos2(x + 6.0, top + 7.0),
        pos2(x, top + 13.0),
        pos2(x - 6.0, top + 7.0),
    ];
    painter.add(egui::Shape::convex_polygon(grip, color, Stroke::NONE));
    let end = frame.map.x(frame.input.document.scenario.duration);
    let after = Rect::from_min_max(pos2(end.max(clip.left()), clip.top() + RULER), clip.max);
    if after.width() > 0.0 {
        painter.rect_filled(after, 0.0, ui.visuals().extreme_bg_color.gamma_multiply(0.55));
    }
}

/// A rounded block with a rim.
fn block(painter: &egui::Painter, rect: Rect, fill: Color32, rim: Stroke) {
    painter.rect(rect, 4.0, fill, rim, StrokeKind::Inside);
}

/// A small round handle.
fn knob(painter: &egui::Painter, at: Pos2, fill: Color32, rim: Color32) {
    painter.circle(at, 4.0, fill, Stroke::new(1.5, rim));
}
