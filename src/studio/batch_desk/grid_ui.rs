//! The grid of outcomes: a small picture, a word and its colour for each variation, under headings that stay in sight.
//!
//! Only what is in sight is drawn. A click selects, a double click opens; what a filter hides is pale in the grid and away in the list.

use super::{BatchDesk, BatchRequest, Cell, Grid, View};
use crate::batch::run::Ended;
use crate::picture::Verdict;
use crate::picture::cell::{CELL_HEIGHT, CELL_WIDTH};
use crate::studio::document::Document;
use eframe::egui::{
    self, Align2, Color32, ColorImage, FontId, Pos2, Rect, ScrollArea, Sense, Slider, Stroke, StrokeKind,
    TextureOptions, Ui, Vec2, WidgetInfo, pos2, vec2,
};

/// Points between cells.
const GAP: f32 = 8.0;
/// Points under a picture, for its words.
const CAPTION: f32 = 22.0;
/// Points of the headings at the left and at the top.
const LEFT: f32 = 86.0;
const TOP: f32 = 22.0;
/// Points, the width of a picture at least, and at most unless a person wants more.
const LEAST: f32 = 110.0;
const MOST: f32 = 240.0;

impl BatchDesk {
    pub(super) fn grid_ui(&mut self, ui: &mut Ui, document: &Document, requests: &mut Vec<BatchRequest>) {
        let Some(grid) = &mut self.grid else {
            ui.centered_and_justified(|ui| {
                ui.weak("Choose what varies, then bake the grid: every outcome is shown here, and any of them can be opened.")
            });
            return;
        };
        for (index, cell) in grid.cells.iter_mut().enumerate() {
            if let Some((size, pixels)) = cell.pixels.take() {
                let image = ColorImage::from_rgba_unmultiplied(size, &pixels);
                cell.texture = Some(ui.ctx().load_texture(format!("cell {index}"), image, TextureOptions::LINEAR));
            }
        }
        toolbar(ui, grid, &mut self.view);
        match &grid.over {
            Some(Err(_)) if grid.was_cancelled() => {
                ui.weak(format!("Cancelled: {} of {} are baked.", grid.done(), grid.cells.len()));
            }
            Some(Err(why)) => {
                ui.colored_label(ui.visuals().error_fg_color, why);
            }
            _ => {}
        }
        if grid.job.document.scenario != document.scenario || grid.job.document.rig != document.rig {
            ui.weak("The scenario has changed since this grid was baked. Opening a cell opens it as it was then.");
        }
        if let Some(index) = cells(ui, grid, &mut self.view) {
            requests.extend(grid.scenario(index));
        }
    }
}

/// Order, size, and which outcomes are shown.
fn toolbar(ui: &mut Ui, grid: &Grid, view: &mut View) {
    ui.horizontal_wrapped(|ui| {
        ui.selectable_value(&mut view.by_outcome, false, "by value");
        ui.selectable_value(&mut view.by_outcome, true, "by outcome");
        ui.separator();
        for verdict in Verdict::ALL {
            let count = grid.cells.iter().filter(|cell| cell.verdict() == Some(verdict)).count();
            if count > 0 {
                let hidden = &mut view.hidden[verdict as usize];
                dot(ui, verdict);
                let chip = ui.selectable_label(!*hidden, format!("{} {count}", verdict.word()));
                if chip.on_hover_text("show or hide these").clicked() {
                    *hidden = !*hidden;
                }
            }
        }
        ui.separator();
        let label = ui.label("size");
        let mut width = view.width.unwrap_or_else(|| fitted(ui, grid));
        let slider = Slider::new(&mut width, LEAST..=CELL_WIDTH as f32).show_value(false);
        if ui.add(slider).labelled_by(label.id).changed() {
            view.width = Some(width);
        }
    });
}

/// Points, so wide that all columns are in sight, where that is possible.
fn fitted(ui: &Ui, grid: &Grid) -> f32 {
    let room = ui.max_rect().width() - LEFT - 4.0;
    (room / grid.shape[1] as f32 - GAP).clamp(LEAST, MOST)
}

fn dot(ui: &mut Ui, verdict: Verdict) {
    let (area, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().circle_filled(area.center(), 5.0, colour(verdict));
}

/// The colour of an outcome.
pub(super) fn colour(verdict: Verdict) -> Color32 {
    let [red, green, blue] = verdict.color();
    Color32::from_rgb(red, green, blue)
}

/// Draws the cells; the one to be opened.
fn cells(ui: &mut Ui, grid: &Grid, view: &mut View) -> Option<usize> {
    let width = view.width.unwrap_or_else(|| fitted(ui, grid));
    let size = vec2(width, width * CELL_HEIGHT as f32 / CELL_WIDTH as f32 + CAPTION);
    let step = size + Vec2::splat(GAP);
    let is_hidden = |cell: &Cell| cell.verdict().is_some_and(|verdict| view.hidden[verdict as usize]);
    let [rows, columns] = grid.shape;
    let (places, columns, corner) = if view.by_outcome {
        let mut order: Vec<usize> = (0..grid.cells.len()).filter(|index| !is_hidden(&grid.cells[*index])).collect();
        order.sort_by_key(|index| (grid.cells[*index].verdict().is_none(), grid.cells[*index].verdict(), *index));
        let columns = ((ui.available_width() - 14.0) / step.x).floor().max(1.0) as usize;
        (order, columns, Vec2::ZERO)
    } else {
        ((0..rows * columns).collect(), columns, vec2(LEFT, TOP))
    };
    let lines = places.len().div_ceil(columns.max(1));
    let total = corner + vec2(step.x * columns as f32, step.y * lines as f32);
    let mut open = None;
    ui.add_space(2.0);
    ScrollArea::both().auto_shrink([false, false]).show_viewport(ui, |ui, sight| {
        let (area, _) = ui.allocate_exact_size(total, Sense::hover());
        for (place, index) in places.iter().enumerate() {
            let offset = corner + vec2(step.x * (place % columns) as f32, step.y * (place / columns) as f32);
            let Some(cell) = grid.cells.get(*index) else { continue };
            if !sight.intersects(Rect::from_min_size(offset.to_pos2(), size)) {
                continue;
            }
            let at = Rect::from_min_size(area.min + offset, size);
            let selected = view.selected == Some(*index);
            let response = ui.interact(at, ui.scope_id().with(("cell", *index)), Sense::click());
            let pale = is_hidden(cell);
            paint(ui, at, cell, (selected || response.has_focus(), response.hovered(), pale), grid);
            if view.by_outcome {
                let values = grid.values(&grid.plan.variations[*index]);
                let words = values.into_iter().map(|(_, value)| value).collect::<Vec<_>>().join(" · ");
                tag(ui, at.min, &words);
            }
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, words(grid, *index)));
            if response.clicked() {
                view.selected = Some(*index);
            }
            if response.double_clicked() {
                open = Some(*index);
            }
            response.on_hover_ui(|ui| super::one_ui::numbers_ui(ui, grid, *index));
        }
        if !view.by_outcome {
            headings(ui, grid, (area.min, sight), step);
        }
    });
    open
}

/// What a screen reader says of a cell.
fn words(grid: &Grid, index: usize) -> String {
    let (Some(cell), Some(variation)) = (grid.cells.get(index), grid.plan.variations.get(index)) else {
        return String::new();
    };
    let values = grid.values(variation).into_iter().map(|(_, value)| value).collect::<Vec<_>>().join(", ");
    let what = match &cell.ended {
        Some(Ended::Done(measured, _)) => format!("{}, {}", measured.outcome, steps(measured.steps)),
        Some(Ended::Failed(_) | Ended::NotRun) => "failed".into(),
        None => "not baked yet".into(),
    };
    format!("{values}: {what}")
}

fn steps(count: u32) -> String {
    if count == 1 { "1 step".into() } else { format!("{count} steps") }
}

/// One cell; (marked, under the pointer, pale).
fn paint(ui: &Ui, at: Rect, cell: &Cell, (marked, hovered, pale): (bool, bool, bool), grid: &Grid) {
    let visuals = ui.visuals();
    let painter = ui.painter();
    let fade = if pale { 0.25 } else { 1.0 };
    painter.rect_filled(at, 4.0, visuals.faint_bg_color);
    let picture = Rect::from_min_max(at.min, pos2(at.max.x, at.max.y - CAPTION));
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    let (text, weak) = (visuals.text_color().gamma_multiply(fade), visuals.weak_text_color().gamma_multiply(fade));
    let font = FontId::proportional(12.5);
    let middle = at.max.y - CAPTION * 0.5;
    match &cell.texture {
        Some(texture) => {
            painter.image(texture.id(), picture, whole, Color32::WHITE.gamma_multiply(fade));
        }
        None => {
            let words = match (&cell.ended, &grid.over) {
                (Some(Ended::Failed(_) | Ended::NotRun), _) => "no clip",
                (Some(_), _) => "",
                (None, Some(_)) => "not baked",
                (None, None) => "…",
            };
            painter.text(picture.center(), Align2::CENTER_CENTER, words, font.clone(), weak);
        }
    }
    if let Some(verdict) = cell.verdict() {
        let galley =
            painter.layout_no_wrap(verdict.word().to_owned(), font.clone(), Color32::WHITE.gamma_multiply(fade));
        let pill = Rect::from_min_size(pos2(at.min.x + 5.0, middle - 8.0), vec2(galley.size().x + 12.0, 16.0));
        painter.rect_filled(pill, 8.0, colour(verdict).gamma_multiply(fade));
        painter.galley(pill.center() - galley.size() * 0.5, galley, Color32::WHITE);
        if let Some(Ended::Done(measured, _)) = &cell.ended {
            let place = pos2(pill.max.x + 6.0, middle);
            painter.text(place, Align2::LEFT_CENTER, steps(measured.steps), font.clone(), text);
            let score = format!("{:.2}", measured.plausibility);
            painter.text(pos2(at.max.x - 6.0, middle), Align2::RIGHT_CENTER, score, font, weak);
        }
    }
    let stroke = match (marked, hovered) {
        (true, _) => Stroke::new(2.0, visuals.selection.stroke.color),
        (false, true) => visuals.widgets.hovered.bg_stroke,
        (false, false) => visuals.widgets.noninteractive.bg_stroke,
    };
    painter.rect_stroke(at, 4.0, stroke, StrokeKind::Inside);
}

/// Words over the corner of a picture.
fn tag(ui: &Ui, corner: Pos2, words: &str) {
    let galley = ui.painter().layout_no_wrap(words.to_owned(), FontId::proportional(11.5), Color32::WHITE);
    let under = Rect::from_min_size(corner + vec2(3.0, 3.0), galley.size() + vec2(8.0, 3.0));
    ui.painter().rect_filled(under, 3.0, Color32::from_black_alpha(170));
    ui.painter().galley(under.min + vec2(4.0, 1.0), galley, Color32::WHITE);
}

/// Values of the rows at the left and of the columns at the top, over the cells, wherever one has scrolled.
fn headings(ui: &Ui, grid: &Grid, (origin, sight): (Pos2, Rect), step: Vec2) {
    let [rows, columns] = grid.shape;
    let wish = &grid.job.wish;
    let values = |index: usize| grid.plan.variations.get(index).map(|one| grid.values(one)).unwrap_or_default();
    let down = usize::from(!wish.rows.path.is_empty());
    let (painter, visuals) = (ui.painter(), ui.visuals());
    let (fill, text) = (visuals.panel_fill, visuals.strong_text_color());
    let seen = origin + sight.min.to_vec2();
    let font = FontId::proportional(13.0);
    painter.rect_filled(Rect::from_min_size(seen, vec2(sight.width(), TOP)), 0.0, fill);
    for column in 0..columns {
        let words = values(column).into_iter().skip(down).map(|(_, value)| value).collect::<Vec<_>>().join(" · ");
        let x = origin.x + LEFT + step.x * (column as f32 + 0.5) - GAP * 0.5;
        painter.text(pos2(x, seen.y + TOP * 0.5), Align2::CENTER_CENTER, words, font.clone(), text);
    }
    painter.rect_filled(Rect::from_min_size(seen, vec2(LEFT, sight.height())), 0.0, fill);
    for row in 0..rows {
        let words = values(row * columns).into_iter().take(down).map(|(_, value)| value).collect::<String>();
        let y = origin.y + TOP + step.y * (row as f32 + 0.5) - GAP * 0.5;
        painter.text(pos2(seen.x + LEFT - 8.0, y), Align2::RIGHT_CENTER, words, font.clone(), text);
    }
    painter.rect_filled(Rect::from_min_size(seen, vec2(LEFT, TOP)), 0.0, fill);
    let path = if wish.rows.path.is_empty() { &wish.columns.path } else { &wish.rows.path };
    let corner = path.rsplit('.').next().unwrap_or_default();
    let place = seen + vec2(2.0, TOP * 0.5);
    painter.text(place, Align2::LEFT_CENTER, corner, FontId::proportional(12.0), visuals.weak_text_color());
}
