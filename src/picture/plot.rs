//! Plots as SVG text: panels of lines over one time axis, and rows of bars under them. Seconds across.
//!
//! [`svg`] draws what it is given and knows nothing of clips (`clip_plot` does). No fonts are embedded: viewers bring a
//! sans-serif of their own.

use plotters::coord::Shift;
use plotters::prelude::*;

/// A drawing of panels that share the time axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Over everything.
    pub title: String,
    /// s, where the axis ends.
    pub duration: f64,
    /// From top to bottom.
    pub panels: Vec<Panel>,
    /// Under them.
    pub rows: Vec<Row>,
    /// Panels side by side.
    pub columns: usize,
}

/// Lines over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// What is drawn, with its unit.
    pub label: String,
    /// Drawn in order.
    pub lines: Vec<Line>,
    /// (s, low, high): an area behind the lines.
    pub band: Vec<(f64, f64, f64)>,
    /// (from, to) s: marked from top to bottom.
    pub marks: Vec<(f64, f64)>,
}

/// One line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// For the legend.
    pub name: String,
    /// Which of the colours.
    pub colour: Colour,
    /// Broken, for what was wanted.
    pub dashed: bool,
    /// (s, value).
    pub points: Vec<(f64, f64)>,
}

/// One row of bars.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// At its left.
    pub label: String,
    /// In order.
    pub bars: Vec<Bar>,
}

/// One bar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bar {
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// Which of the colours.
    pub colour: Colour,
    /// Written in it.
    pub text: String,
}

/// The colours that a plot uses (legible in print and to people who confuse red and green: Okabe and Ito's).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colour {
    /// What was wanted.
    #[default]
    Grey,
    /// The centre of mass, the left foot.
    Blue,
    /// The extrapolated centre of mass, the right foot.
    Orange,
    /// The centre of pressure.
    Green,
    /// Disturbances.
    Red,
}

impl Colour {
    /// sRGB.
    pub fn srgb(self) -> [u8; 3] {
        match self {
            Colour::Grey => [110, 110, 110],
            Colour::Blue => [0, 114, 178],
            Colour::Orange => [230, 159, 0],
            Colour::Green => [0, 158, 115],
            Colour::Red => [213, 94, 0],
        }
    }

    fn rgb(self) -> RGBColor {
        let [red, green, blue] = self.srgb();
        RGBColor(red, green, blue)
    }
}

/// px.
const WIDTH: u32 = 1000;
const TITLE: u32 = 40;
const PANEL: u32 = 185;
const ROW: u32 = 24;
const AXIS: u32 = 34;
const LEFT: u32 = 66;

/// The bytes of an SVG file.
pub fn svg(plot: &Plot) -> String {
    let mut text = String::new();
    let columns = plot.columns.max(1);
    let lines = plot.panels.len().div_ceil(columns) as u32;
    let size = (WIDTH, TITLE + lines * PANEL + plot.rows.len() as u32 * ROW + AXIS);
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        // Writing to memory cannot fail; a drawing that did would be short and its reader says so.
        let _ = draw(plot, &area, columns);
        let _ = area.present();
    }
    text
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Failed<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

fn draw<'a>(plot: &Plot, area: &Area<'a>, columns: usize) -> Result<(), Failed<'a>> {
    area.fill(&WHITE)?;
    area.draw_text(&plot.title, &("sans-serif", 18).into_text_style(area), (LEFT as i32, 12))?;
    let (_, rest) = area.split_vertically(TITLE);
    let lines = plot.panels.len().div_ceil(columns) as u32;
    let (panels, rows) = rest.split_vertically(lines * PANEL);
    let cells = panels.split_evenly((lines.max(1) as usize, columns));
    for (panel, cell) in plot.panels.iter().zip(&cells) {
        draw_panel(plot, panel, cell)?;
    }
    draw_rows(plot, &rows)
}

fn draw_panel<'a>(plot: &Plot, panel: &Panel, area: &Area<'a>) -> Result<(), Failed<'a>> {
    let (low, high) = bounds(panel);
    let mut chart = ChartBuilder::on(area)
        .margin_right(12)
        .margin_top(4)
        .caption(&panel.label, ("sans-serif", 13))
        .x_label_area_size(20)
        .y_label_area_size(LEFT)
        .build_cartesian_2d(0.0..plot.duration.max(1e-3), low..high)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(228, 228, 228))
        .axis_style(RGBColor(120, 120, 120))
        .x_labels(11)
        .y_labels(5)
        .y_label_formatter(&|value| format!("{value:.2}"))
        .x_label_formatter(&|value| format!("{value:.1}"))
        .label_style(("sans-serif", 11))
        .draw()?;
    let mark = Colour::Red.rgb().mix(0.15).filled();
    chart.draw_series(panel.marks.iter().map(|(from, to)| Rectangle::new([(*from, low), (*to, high)], mark)))?;
    if panel.band.len() > 1 {
        let upper = panel.band.iter().map(|(time, _, high)| (*time, *high));
        let lower = panel.band.iter().rev().map(|(time, low, _)| (*time, *low));
        let outline: Vec<(f64, f64)> = upper.chain(lower).collect();
        chart.draw_series([Polygon::new(outline, RGBColor(120, 120, 120).mix(0.18).filled())])?;
    }
    for line in &panel.lines {
        let stroke = line.colour.rgb().stroke_width(if line.dashed { 1 } else { 2 });
        let legend = line.colour.rgb();
        let points = line.points.iter().copied();
        let series = if line.dashed {
            chart.draw_series(DashedLineSeries::new(points, 6, 4, stroke))?
        } else {
            chart.draw_series(LineSeries::new(points, stroke))?
        };
        series.label(&line.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], legend.stroke_width(2)));
    }
    if panel.lines.len() > 1 {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .background_style(WHITE.mix(0.8))
            .label_font(("sans-serif", 11))
            .draw()?;
    }
    Ok(())
}

/// The range of the values, with some air.
fn bounds(panel: &Panel) -> (f64, f64) {
    let lines = panel.lines.iter().flat_map(|line| line.points.iter().map(|(_, value)| (*value, *value)));
    let band = panel.band.iter().map(|(_, low, high)| (*low, *high));
    let (low, high) = lines
        .chain(band)
        .filter(|(low, high)| low.is_finite() && high.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |all, one| (all.0.min(one.0), all.1.max(one.1)));
    if low > high {
        return (0.0, 1.0);
    }
    let air = (0.08 * (high - low)).max(0.01);
    (low - air, high + air)
}

fn draw_rows<'a>(plot: &Plot, area: &Area<'a>) -> Result<(), Failed<'a>> {
    let span = f64::from(WIDTH - LEFT - 12);
    let x = |time: f64| (f64::from(LEFT) + span * (time / plot.duration.max(1e-3)).clamp(0.0, 1.0)) as i32;
    let small = ("sans-serif", 11).into_text_style(area);
    for (index, row) in plot.rows.iter().enumerate() {
        let top = (index as u32 * ROW) as i32;
        area.draw_text(&row.label, &small, (6, top + 6))?;
        for bar in &row.bars {
            let (from, to) = (x(bar.start), x(bar.end).max(x(bar.start) + 2));
            area.draw(&Rectangle::new([(from, top + 3), (to, top + 19)], bar.colour.rgb().mix(0.8).filled()))?;
            if !bar.text.is_empty() {
                area.draw_text(&bar.text, &small, (from + 3, top + 6))?;
            }
        }
    }
    let bottom = (plot.rows.len() as u32 * ROW) as i32 + 6;
    area.draw_text("time, s", &small, ((WIDTH / 2) as i32, bottom))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;

    fn plot() -> Plot {
        let points: Vec<(f64, f64)> = (0..100).map(|i| (f64::from(i) * 0.04, real::sin(f64::from(i)))).collect();
        let line = Line { name: "speed <&>".into(), colour: Colour::Blue, dashed: false, points };
        let band = vec![(0.0, -2.0, 2.0), (4.0, -1.0, 1.0)];
        let panel = Panel { label: "m/s".into(), lines: vec![line.clone(), line], band, marks: vec![(1.0, 1.2)] };
        let bar = Bar { start: 0.5, end: 1.0, colour: Colour::Red, text: "push".into() };
        let rows = vec![Row { label: "left".into(), bars: vec![bar] }];
        Plot { title: "a \"test\"".into(), duration: 4.0, panels: vec![panel.clone(), panel], rows, columns: 1 }
    }

    #[test]
    fn the_text_is_a_whole_svg_with_names_escaped() {
        let text = svg(&plot());
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        assert!(text.contains("speed &lt;&amp;&gt;"), "escaped names");
        assert!(text.matches("<polyline").count() >= 4, "lines are drawn");
    }

    #[test]
    fn numbers_that_are_none_and_empty_plots_draw_without_harm() {
        let mut broken = plot();
        broken.panels[0].lines[0].points[3].1 = f64::NAN;
        broken.panels[1].lines.clear();
        broken.panels[1].band.clear();
        assert!(svg(&broken).contains("</svg>"));
        assert!(svg(&Plot::default()).contains("</svg>"));
    }
}
