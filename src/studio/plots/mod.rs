//! The plots under the clip: small, one over another, on one time axis with the playhead in all of them.
//!
//! [`series()`] computes the curves, off the window's thread; [`Plots`] draws them and says where a person wants the playhead. Times s,
//! values in the unit of their [`Kind`].

mod series;
#[cfg(test)]
mod series_tests;

pub use series::{Chart, Curve, Kind, Series, series};

use super::time_map::TimeWindow;
use crate::model::Side;
use crate::picture::plot::Colour;
use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, Color32, PopupCloseBehavior, RichText, ScrollArea, Sense, Stroke, Vec2, WidgetInfo, vec2};
use egui_plot::{AxisHints, FilledArea, GridMark, HoverPosition, Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotUi};
use egui_plot::{Polygon, Span, VLine};
use std::ops::RangeInclusive;

/// Points, what one plot is high, without its words.
const HIGH: f32 = 84.0;
/// Points, the room for numbers at the left: the same for all, so that one time is at one place.
const LEFT: f32 = 58.0;
/// Share of a plot's height that each foot's contacts take at its bottom.
const STRIP: f64 = 0.055;

/// Which plots are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Plots {
    /// By [`Kind`], in the order of [`Kind::ALL`].
    pub shown: [bool; Kind::ALL.len()],
    /// What a person zoomed to, where nobody else says it.
    zoomed: Option<TimeWindow>,
}

impl Default for Plots {
    fn default() -> Plots {
        Plots { shown: [true; Kind::ALL.len()], zoomed: None }
    }
}

impl Plots {
    /// Draws them; the answer is where the playhead is wanted, s. Without a window of the timeline's all of the clip is shown, and
    /// pinching or the wheel with Ctrl zooms.
    pub fn ui(&mut self, ui: &mut egui::Ui, series: &Series, time: f64, window: Option<TimeWindow>) -> Option<f64> {
        let whole = TimeWindow::whole(series.duration);
        let across = window.or(self.zoomed).unwrap_or(whole);
        let mut seek = None;
        ui.horizontal(|ui| {
            let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
            MenuButton::new("Plots").config(config).ui(ui, |ui| {
                for (kind, shown) in Kind::ALL.into_iter().zip(&mut self.shown) {
                    ui.checkbox(shown, kind.name()).on_hover_text(kind.hint());
                }
            });
            if window.is_none() && self.zoomed.is_some() && ui.button("Whole clip").clicked() {
                self.zoomed = None;
            }
            ui.label(format!("at {time:.2} s"));
            key(ui, Colour::Red, "push");
            key(ui, Colour::Blue, "left foot down");
            key(ui, Colour::Orange, "right foot down");
        });
        let shown: Vec<&Chart> = series.charts.iter().filter(|chart| self.shown[chart.kind as usize]).collect();
        if shown.is_empty() {
            ui.weak("No plot is chosen: the menu over this has them.");
        }
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            for (index, chart) in shown.iter().enumerate() {
                heading(ui, chart, time);
                if chart.curves.iter().all(|curve| curve.stretches.is_empty()) {
                    continue;
                }
                let last = index + 1 == shown.len();
                let (wanted, zoom) = plot_ui(ui, chart, series, time, (across, last));
                seek = seek.or(wanted);
                if let (None, Some((factor, about))) = (window, zoom) {
                    let near = across.zoomed(factor, about);
                    self.zoomed = (near.span < whole.span).then_some(near);
                }
            }
        });
        seek
    }
}

/// Name, and what each curve is at the playhead.
fn heading(ui: &mut egui::Ui, chart: &Chart, time: f64) {
    let unit = chart.kind.unit();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        ui.label(RichText::new(format!("{}, {unit}", chart.kind.name())).strong()).on_hover_text(chart.kind.hint());
        for (curve, value) in chart.values(time) {
            ui.add_space(6.0);
            let told = value.map_or_else(|| "–".to_owned(), |value| told(value, unit));
            key(ui, curve.colour, &format!("{} {told}", curve.name));
        }
        if let Some(note) = &chart.note {
            ui.weak(note);
        }
    });
}

/// Places of a grid's lines: round numbers, about so many.
fn marks((low, high): (f64, f64), about: f64) -> Vec<GridMark> {
    let least = ((high - low) / about).max(1e-9);
    let decade = 10_f64.powf(least.log10().floor());
    let step_size = [1.0, 2.0, 5.0, 10.0].map(|times| times * decade).into_iter().find(|step| *step >= least * 0.999);
    let step_size = step_size.unwrap_or(10.0 * decade);
    let (first, last) = ((low / step_size).ceil() as i64, (high / step_size).floor() as i64);
    (first..=last.min(first + 100)).map(|at| GridMark { value: at as f64 * step_size, step_size }).collect()
}

/// A colour and what it stands for.
fn key(ui: &mut egui::Ui, colour: Colour, words: &str) {
    let (area, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
    let bar = egui::Rect::from_center_size(area.center(), vec2(12.0, 3.0));
    ui.painter().rect_filled(bar, 1.0, tint(colour, ui.visuals().dark_mode));
    ui.label(words);
}

/// A value as a person reads it: three digits that tell.
fn told(value: f64, unit: &str) -> String {
    let decimals = match unit {
        "mm" | "cm" | "Nm" => 1,
        "m" => 3,
        _ => 2,
    };
    format!("{value:.decimals$} {unit}")
}

/// The colours of the tool's plots, lighter on dark ground.
fn tint(colour: Colour, dark: bool) -> Color32 {
    let [red, green, blue] = match (colour, dark) {
        (Colour::Grey, true) => [150, 150, 150],
        (Colour::Blue, true) => [86, 180, 233],
        (Colour::Green, true) => [40, 196, 150],
        (Colour::Red, true) => [240, 120, 60],
        _ => colour.srgb(),
    };
    Color32::from_rgb(red, green, blue)
}

/// A zoom: by which factor, about which time.
type Zoom = Option<(f64, f64)>;

/// Draws one; where the playhead is wanted.
fn plot_ui(
    ui: &mut egui::Ui,
    chart: &Chart,
    series: &Series,
    time: f64,
    (across, last): (TimeWindow, bool),
) -> (Option<f64>, Zoom) {
    let (low, high) = chart.bounds();
    let low = low - (high - low) * STRIP * 2.5; // room for the feet's strips
    let unit = chart.kind.unit();
    let dark = ui.visuals().dark_mode;
    let playhead = ui.visuals().strong_text_color();
    let mark = |mark: GridMark, _: &RangeInclusive<f64>| {
        let decimals = (-mark.step_size.log10().floor()).clamp(0.0, 3.0) as usize;
        format!("{:.decimals$} {unit}", mark.value)
    };
    let hover = move |position: &HoverPosition| match position {
        HoverPosition::NearDataPoint { plot_name, position, .. } if !plot_name.is_empty() => {
            Some(format!("{plot_name}\n{} at {:.2} s", told(position.y, unit), position.x))
        }
        HoverPosition::NearDataPoint { .. } => None,
        HoverPosition::Elsewhere { position } => Some(format!("{:.2} s", position.x)),
    };
    let plot = Plot::new(chart.kind.name())
        .height(if last { HIGH + 16.0 } else { HIGH })
        .show_axes([last, true])
        .custom_x_axes(vec![AxisHints::new_x().formatter(|mark: GridMark, _: &RangeInclusive<f64>| {
            format!("{} s", (mark.value * 1000.0).round() / 1000.0)
        })])
        .custom_y_axes(vec![AxisHints::new_y().formatter(mark).min_thickness(LEFT).label_spacing(8.0..=9.0)])
        .x_grid_spacer(|input| marks(input.bounds, 14.0))
        .y_grid_spacer(|input| marks(input.bounds, 4.0))
        .grid_color(ui.visuals().text_color().gamma_multiply(0.35))
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .set_margin_fraction(Vec2::ZERO)
        .show_y(false)
        .link_cursor(egui::Id::unique("plots"), [true, false])
        .label_formatter(hover);
    let response = plot.show(ui, |plot| {
        plot.set_plot_bounds_x(across.start..=across.start + across.span);
        plot.set_plot_bounds_y(low..=high);
        behind(plot, chart, series, (low, high), dark);
        for curve in &chart.curves {
            for stretch in &curve.stretches {
                let style = if curve.dashed { LineStyle::dashed_dense() } else { LineStyle::Solid };
                let width = if curve.dashed { 1.2 } else { 1.8 };
                let points = PlotPoints::Borrowed(stretch);
                plot.line(
                    Line::new(&curve.name, points).stroke(Stroke::new(width, tint(curve.colour, dark))).style(style),
                );
            }
        }
        plot.vline(VLine::new("", time).stroke(Stroke::new(1.5, playhead)).allow_hover(false));
    });
    let area = response.response;
    area.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, format!("plot of {}", chart.kind.name())));
    let at = |place: egui::Pos2| response.transform.value_from_position(place).x;
    let pressed = area.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_down());
    let wanted = area.interact_pointer_pos().filter(|_| pressed || area.clicked());
    let seek = wanted.map(|place| at(place).clamp(0.0, series.duration));
    let zoom = area.hover_pos().and_then(|place| {
        let factor = f64::from(ui.input(|input| input.zoom_delta()));
        (factor != 1.0).then_some((factor, at(place)))
    });
    (seek, zoom)
}

/// Support, pushes and contacts.
fn behind<'a>(plot: &mut PlotUi<'a>, chart: &'a Chart, series: &Series, (low, high): (f64, f64), dark: bool) {
    let pale = |colour: Colour, share: f32| tint(colour, dark).gamma_multiply(share);
    for (from, to) in &series.pushes {
        plot.span(Span::new("", *from..=to.max(from + 0.01)).fill(pale(Colour::Red, 0.16)));
    }
    for stretch in &chart.band {
        let column = |of: usize| stretch.iter().map(|row| row[of]).collect::<Vec<f64>>();
        let (times, lows, highs) = (column(0), column(1), column(2));
        let area = FilledArea::new("", &times, &lows, &highs).fill_color(pale(Colour::Grey, 0.25));
        plot.add(area.stroke(Stroke::NONE).allow_hover(false));
    }
    if chart.kind.has_zero() {
        let ends = vec![PlotPoint::new(-1e6, 0.0), PlotPoint::new(1e6, 0.0)];
        let stroke = Stroke::new(1.0, pale(Colour::Grey, 0.8));
        plot.line(Line::new("", PlotPoints::Owned(ends)).stroke(stroke).allow_hover(false));
    }
    for (side, from, to) in &series.contacts {
        let strip = (high - low) * STRIP;
        let bottom = low + strip * if *side == Side::Left { 1.15 } else { 0.0 };
        let colour = if *side == Side::Left { Colour::Blue } else { Colour::Orange };
        let corners: PlotPoints =
            [[*from, bottom], [*to, bottom], [*to, bottom + strip], [*from, bottom + strip]].into_iter().collect();
        let bar = Polygon::new("", corners).fill_color(pale(colour, 0.45)).stroke(Stroke::NONE);
        plot.polygon(bar.allow_hover(false));
    }
}
