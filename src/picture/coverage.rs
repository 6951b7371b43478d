//! Coverage as SVG: for each rig the pushes of a sweep as they lie around the character, by what came of them, and a table.
//!
//! Seen from above, the character facing up: a push lies where it leads to, so far out as its impulse (N s) is large. Few
//! pushes are marks, fanned out where they share a place ([`super::coverage_marks`]); many are shares of wedges
//! ([`super::coverage_wedges`]). No script, no outside file; light and dark follow the viewer.

use super::coverage_marks as marks;
use super::coverage_wedges as wedges;
use super::text::escaped;
use super::verdict::Verdict;
use crate::maths::real;
use std::fmt::Write;

/// One variation.
#[derive(Clone, Debug, PartialEq)]
pub struct CoveragePoint {
    /// Of the clip.
    pub name: String,
    /// Whose.
    pub rig: String,
    /// Degrees, where the push leads, seen from above: 0 = the rig's forward, 90 = its left. `None` without a level push.
    pub direction_deg: Option<f64>,
    /// N s.
    pub impulse_ns: f64,
    /// What came of it.
    pub verdict: Verdict,
    /// Footfalls.
    pub steps: u32,
    /// The place in the list of the earlier one that looks the same.
    pub duplicate_of: Option<usize>,
}

/// The scales of one rig's plot: px and N s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dial {
    /// px.
    pub(super) centre: [f64; 2],
    /// px, where impulse 0 lies; the character stands inside.
    pub(super) hole: f64,
    /// px.
    pub(super) radius: f64,
    /// N s, at `radius`.
    pub(super) most: f64,
}

impl Dial {
    /// px from the centre.
    pub(super) fn far(&self, impulse: f64) -> f64 {
        self.hole + (self.radius - self.hole) * (impulse / self.most).clamp(0.0, 1.0)
    }

    /// The place of a direction (degrees) so far out (px).
    pub(super) fn place(&self, direction: f64, far: f64) -> [f64; 2] {
        let (sin, cos) = real::sin_cos(direction.to_radians());
        [self.centre[0] - far * sin, self.centre[1] - far * cos]
    }
}

/// Marks of a rig at most; more become shares of wedges.
const MOST_MARKS: usize = 130;
/// px.
const WIDTH: f64 = 1120.0;
const MARGIN: f64 = 28.0;
const TOP: f64 = 112.0;
const ROW: f64 = 24.0;

const STYLE: &str = "
text{font:13px system-ui,-apple-system,'Segoe UI',Roboto,Helvetica,Arial,sans-serif;fill:#1b2330}
.page{fill:#fff}.dial{fill:#f4f6f8}.ring{fill:none;stroke:#cdd4dd}.rim,.rule{stroke:#b3bcc9}.spoke{stroke:#dfe4ea}
.h{font-size:22px;font-weight:600}.rig{font-size:16px;font-weight:600}.soft{fill:#5d6878}.tick{font-size:11px;fill:#5d6878}
.halo{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round;fill:#1b2330}
.n{text-anchor:end;font-variant-numeric:tabular-nums}.m{text-anchor:middle}.body{fill:#aab4c1}.link{stroke:#5d6878;opacity:.6}
.still{fill:#80868f;stroke:#80868f}.sway{fill:#3a92d0;stroke:#3a92d0}.step{fill:#008e68;stroke:#008e68}
.fall{fill:#d55e00;stroke:#d55e00}.failed{fill:#78266e;stroke:#78266e}
.k{stroke-width:1.6}.k.o{fill:#f4f6f8}.w{stroke:#fff;stroke-width:.8}.d{fill-opacity:.45}
@media (prefers-color-scheme:dark){
text{fill:#e7ebf1}
.page{fill:#11151b}.dial{fill:#1a2029}.ring{stroke:#3a4656}.rim,.rule{stroke:#56637a}.spoke{stroke:#2c3542}
.soft,.tick{fill:#a3aebd}.halo{stroke:#11151b;fill:#e7ebf1}.body{fill:#6c7888}.link{stroke:#a3aebd}
.still{fill:#9aa2ad;stroke:#9aa2ad}.sway{fill:#56b4e9;stroke:#56b4e9}.step{fill:#1fbf90;stroke:#1fbf90}
.fall{fill:#f0803c;stroke:#f0803c}.failed{fill:#d68fb8;stroke:#d68fb8}
.k.o{fill:#1a2029}.w{stroke:#11151b}}
";

/// What lies over falls and failures.
const STRIPES: &str = "<defs><pattern id=\"stripes\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" \
    patternTransform=\"rotate(45)\"><rect width=\"1.6\" height=\"6\" fill=\"#fff\" fill-opacity=\".5\"/></pattern></defs>";

/// The text of an SVG file. Points of one rig need not be beside each other; rigs come in the order of their first.
pub fn coverage(points: &[CoveragePoint], title: &str) -> String {
    let mut rigs: Vec<(&str, Vec<usize>)> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        match rigs.iter_mut().find(|(rig, _)| *rig == point.rig) {
            Some((_, own)) => own.push(index),
            None => rigs.push((&point.rig, vec![index])),
        }
    }
    let columns = rigs.len().clamp(1, 3);
    let gap = 26.0;
    let side = ((WIDTH - 2.0 * MARGIN - gap * (columns - 1) as f64) / columns as f64).min(620.0);
    let lines = rigs.len().div_ceil(columns) as f64;
    let block = side + 58.0;
    let table = TOP + lines * block + 14.0;
    let height = table + ROW * (rigs.len() as f64 + if rigs.len() > 1 { 3.0 } else { 2.0 }) + 44.0;
    let mut svg = String::new();
    let size = format!("width=\"{WIDTH:.0}\" height=\"{height:.0}\"");
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH:.0} {height:.0}\" {size} role=\"img\">\
         <title>{}</title><style>{STYLE}</style>{STRIPES}<rect class=\"page\" {size}/>",
        escaped(title)
    );
    let _ = write!(svg, "<text class=\"h\" x=\"{MARGIN}\" y=\"40\">{}</text>", escaped(&short(title, 84)));
    legend(&mut svg, points);
    for (at, (rig, own)) in rigs.iter().enumerate() {
        let (column, line) = ((at % columns) as f64, (at / columns) as f64);
        // A plot that is alone stands in the middle.
        let free = WIDTH - 2.0 * MARGIN - side * columns as f64 - gap * (columns - 1) as f64;
        let left = MARGIN + free / 2.0 + column * (side + gap);
        plot(&mut svg, points, rig, own, [left, TOP + line * block, side]);
    }
    counts(&mut svg, points, &rigs, table);
    svg.push_str("</svg>\n");
    svg
}

/// One rig's plot, in a square field and a line under it.
fn plot(svg: &mut String, points: &[CoveragePoint], rig: &str, own: &[usize], [left, top, side]: [f64; 3]) {
    let letters = (side / 11.0) as usize;
    let _ = write!(
        svg,
        "<text class=\"rig\" x=\"{left:.1}\" y=\"{:.1}\">{}</text>",
        top + 14.0,
        escaped(&short(rig, letters))
    );
    let (placed, rest): (Vec<usize>, Vec<usize>) = own.iter().partition(|at| bearing(&points[**at]).is_some());
    // Marks at the outermost ring stay within the rim, words outside of it.
    let rim = side / 2.0 - 30.0;
    let radius = rim - 16.0;
    let most = placed.iter().map(|at| points[*at].impulse_ns).fold(0.0, f64::max);
    let tick = step(most);
    let rings = (most / tick - 1e-9).ceil().max(1.0);
    let centre = [left + side / 2.0, top + 30.0 + side / 2.0];
    let dial = Dial { centre, hole: 0.085 * side, radius, most: tick * rings };
    let [x, y] = centre;
    let _ = write!(svg, "<circle class=\"dial rim\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{rim:.1}\"/>");
    for direction in (0..8).map(|at| f64::from(at) * 45.0) {
        let ([x1, y1], [x2, y2]) = (dial.place(direction, dial.hole), dial.place(direction, rim));
        let _ = write!(svg, "<path class=\"spoke\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>");
    }
    for ring in 1..=rings as usize {
        let _ = write!(
            svg,
            "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/>",
            dial.far(tick * ring as f64)
        );
    }
    let own: Vec<(usize, f64)> = placed.iter().filter_map(|at| Some((*at, bearing(&points[*at])?))).collect();
    if own.len() <= MOST_MARKS {
        marks::draw(svg, points, &own, &dial);
    } else {
        wedges::draw(svg, points, &own, &dial);
    }
    for ring in 1..=rings as usize {
        // Between two spokes, where marks are rare.
        let [tx, ty] = dial.place(-22.5, dial.far(tick * ring as f64));
        let unit = if ring == rings as usize { " Ns" } else { "" };
        let _ = write!(
            svg,
            "<text class=\"tick halo m\" x=\"{tx:.1}\" y=\"{:.1}\">{}{unit}</text>",
            ty + 4.0,
            plain(tick * ring as f64)
        );
    }
    character(svg, &dial);
    for (direction, word, anchor) in [(0.0, "to its front", "m"), (180.0, "to its back", "m")] {
        let [wx, wy] = dial.place(direction, rim + 12.0);
        let _ = write!(svg, "<text class=\"tick {anchor}\" x=\"{wx:.1}\" y=\"{:.1}\">{word}</text>", wy + 4.0);
    }
    for (direction, word) in [(90.0, "left"), (-90.0, "right")] {
        let [wx, wy] = dial.place(direction, rim + 16.0);
        let _ = write!(svg, "<text class=\"tick m\" x=\"{wx:.1}\" y=\"{:.1}\">{word}</text>", wy + 4.0);
    }
    if !rest.is_empty() {
        let words =
            Verdict::ALL.map(|verdict| (rest.iter().filter(|at| points[**at].verdict == verdict).count(), verdict));
        let words: Vec<String> = words
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, verdict)| format!("{count} {}", verdict.word()))
            .collect();
        let text = format!("without a level push: {}", words.join(", "));
        let _ = write!(svg, "<text class=\"soft m\" x=\"{x:.1}\" y=\"{:.1}\">{text}</text>", top + side + 50.0);
    }
}

/// Where a push leads, degrees, if it has a place in the plot.
fn bearing(point: &CoveragePoint) -> Option<f64> {
    let sound = point.impulse_ns.is_finite() && point.impulse_ns >= 0.0;
    point.direction_deg.filter(|direction| direction.is_finite() && sound).map(|direction| direction.rem_euclid(360.0))
}

/// A person from above: shoulders, head, nose ahead.
fn character(svg: &mut String, dial: &Dial) {
    let [x, y] = dial.centre;
    let unit = dial.hole * 0.62;
    let _ = write!(
        svg,
        "<g class=\"body\"><ellipse cx=\"{x:.1}\" cy=\"{y:.1}\" rx=\"{:.1}\" ry=\"{:.1}\"/>\
         <path d=\"M{:.1} {:.1}L{x:.1} {:.1}L{:.1} {:.1}Z\"/><circle class=\"page\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/>\
         <circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\"/></g>",
        unit,
        unit * 0.45,
        x - unit * 0.28,
        y - unit * 0.3,
        y - unit * 1.05,
        x + unit * 0.28,
        y - unit * 0.3,
        unit * 0.47,
        unit * 0.38
    );
}

/// What marks and colours mean, and how many came to it.
fn legend(svg: &mut String, points: &[CoveragePoint]) {
    let mut x = MARGIN + 7.0;
    for verdict in Verdict::ALL {
        let count = points.iter().filter(|point| point.verdict == verdict).count();
        if count == 0 && verdict == Verdict::Failed {
            continue;
        }
        marks::mark(svg, verdict, [x, 66.0], 6.0, false, "");
        let words = format!("{} {count}", verdict.word());
        let _ = write!(svg, "<text x=\"{:.1}\" y=\"70.5\">{words}</text>", x + 13.0);
        x += 36.0 + 7.8 * words.len() as f64;
    }
    let alike = points.iter().filter(|point| point.duplicate_of.is_some()).count();
    if alike > 0 {
        marks::mark(svg, Verdict::Step, [x, 66.0], 6.0, true, "");
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"70.5\">hollow or pale: much like an earlier one, {alike}</text>",
            x + 13.0
        );
    }
    let _ = write!(
        svg,
        "<text class=\"soft\" x=\"{MARGIN}\" y=\"94\">Seen from above, the character facing up. A push lies where it leads to; \
         the farther out, the larger its impulse.</text>"
    );
}

/// The table: a row a rig, and all.
fn counts(svg: &mut String, points: &[CoveragePoint], rigs: &[(&str, Vec<usize>)], top: f64) {
    let columns =
        ["variations", "still", "sway", "step", "fall", "failed", "alike", "most steps", "stands to", "falls from"];
    let x = |column: usize| MARGIN + 300.0 + 84.0 * column as f64 - if column > 0 { 40.0 } else { 30.0 };
    let mut y = top + 16.0;
    for (column, name) in columns.iter().enumerate() {
        let _ = write!(svg, "<text class=\"soft n\" x=\"{:.0}\" y=\"{y:.1}\">{name}</text>", x(column));
    }
    let whole = (0..points.len()).collect::<Vec<usize>>();
    let all = (rigs.len() > 1).then_some(("all", whole));
    for (rig, own) in rigs.iter().chain(all.as_ref()) {
        let _ = write!(
            svg,
            "<path class=\"rule\" d=\"M{MARGIN} {:.1}H{:.1}\"/><text x=\"{MARGIN}\" y=\"{:.1}\">{}</text>",
            y + 7.5,
            WIDTH - MARGIN,
            y + ROW,
            escaped(&short(rig, 28))
        );
        y += ROW;
        let own = || own.iter().map(|at| &points[*at]);
        let count = |verdict: Verdict| own().filter(|point| point.verdict == verdict).count();
        let mut cells = vec![own().count().to_string()];
        cells.extend(Verdict::ALL.map(|verdict| count(verdict).to_string()));
        cells.push(own().filter(|point| point.duplicate_of.is_some()).count().to_string());
        cells.push(own().map(|point| point.steps).max().unwrap_or(0).to_string());
        let impulses = |falls: bool| {
            let has_clip = own().filter(|point| point.verdict != Verdict::Failed && bearing(point).is_some());
            has_clip.filter(move |point| (point.verdict == Verdict::Fall) == falls).map(|point| point.impulse_ns)
        };
        let newton_seconds =
            |found: Option<f64>| found.map_or("–".to_owned(), |found| format!("{} Ns", plain(found)));
        cells.push(newton_seconds(impulses(false).max_by(f64::total_cmp)));
        cells.push(newton_seconds(impulses(true).min_by(f64::total_cmp)));
        for (column, cell) in cells.iter().enumerate() {
            let _ = write!(svg, "<text class=\"n\" x=\"{:.0}\" y=\"{y:.1}\">{cell}</text>", x(column));
        }
    }
    let _ = write!(
        svg,
        "<text class=\"soft\" x=\"{MARGIN}\" y=\"{:.1}\">stands to: the largest impulse without a fall; falls from: the smallest with one.</text>",
        y + ROW + 6.0
    );
}

/// The distance of rings: 1, 2 or 5 times a power of ten, three to six of them.
fn step(most: f64) -> f64 {
    if !(most > 1e-9 && most.is_finite()) {
        return 1.0;
    }
    let power = real::powf(10f64, real::log10(most / 5.0).floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|of| of * power).find(|step| most / step <= 5.0).unwrap_or(10.0 * power)
}

/// A number without needless digits.
pub(super) fn plain(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e6.. => format!("{value:.1e}"),
        100.0.. => format!("{value:.0}"),
        10.0.. => format!("{value:.1}").trim_end_matches(".0").to_owned(),
        _ => format!("{value:.2}").trim_end_matches('0').trim_end_matches('.').to_owned(),
    }
}

/// So many letters at most, the middle left out.
fn short(text: &str, most: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most.max(3) {
        return text.to_owned();
    }
    let tail = most.max(3) / 2;
    let head: String = letters[..most.max(3) - tail - 1].iter().collect();
    let tail: String = letters[letters.len() - tail..].iter().collect();
    format!("{head}…{tail}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(direction: f64, impulse: f64, verdict: Verdict) -> CoveragePoint {
        CoveragePoint {
            name: format!("push_{direction}_{impulse}"),
            rig: "hero".to_owned(),
            direction_deg: Some(direction),
            impulse_ns: impulse,
            verdict,
            steps: 2,
            duplicate_of: None,
        }
    }

    /// The place that a mark's path or circle begins at.
    fn place(svg: &str, name: &str) -> [f64; 2] {
        let told = svg.find(&format!("<title>{name}:")).expect("the mark");
        let start = svg[..told].rfind('<').expect("its element");
        let element = &svg[start..told];
        let number = |key: &str| {
            let from = element.find(key)? + key.len();
            element[from..].split(['"', ' ']).next()?.parse::<f64>().ok()
        };
        [number("cx=\"").expect("x"), number("cy=\"").expect("y")]
    }

    #[test]
    fn pushes_lie_where_they_lead_and_stronger_ones_farther_out() {
        let sway = |direction: f64, impulse: f64| point(direction, impulse, Verdict::Sway);
        let points = [sway(0.0, 50.0), sway(90.0, 50.0), sway(180.0, 50.0), sway(270.0, 50.0), sway(90.0, 100.0)];
        let svg = coverage(&points, "t");
        let at: Vec<[f64; 2]> = points.iter().map(|point| place(&svg, &point.name)).collect();
        let middle = [(at[1][0] + at[3][0]) / 2.0, (at[0][1] + at[2][1]) / 2.0];
        assert!(at[0][1] < middle[1] - 50.0 && (at[0][0] - middle[0]).abs() < 0.2, "forwards is up");
        assert!(at[1][0] < middle[0] - 50.0 && (at[1][1] - middle[1]).abs() < 0.2, "its left is on the left");
        assert!(at[4][0] < at[1][0] - 50.0, "a stronger one is farther out");
    }

    #[test]
    fn what_looks_the_same_is_hollow_and_joined() {
        let mut points = [point(0.0, 50.0, Verdict::Step), point(45.0, 50.0, Verdict::Step)];
        assert!(!coverage(&points, "t").contains("class=\"link\"") && !coverage(&points, "t").contains("step k o"));
        points[1].duplicate_of = Some(0);
        let svg = coverage(&points, "t");
        assert_eq!(svg.matches("class=\"link\"").count(), 1);
        assert_eq!(svg.matches("step k o").count(), 2, "the mark and the legend's");
        points[1].duplicate_of = Some(77);
        assert!(!coverage(&points, "t").contains("class=\"link\""), "one that is not there");
    }

    #[test]
    fn thousands_are_shares_of_few_fields_in_a_small_file() {
        let verdict = |at: usize| if at % 10 > 6 { Verdict::Fall } else { Verdict::Step };
        let points: Vec<CoveragePoint> =
            (0..10_000).map(|at| point((at * 37 % 360) as f64, (at * 13 % 200) as f64, verdict(at))).collect();
        let svg = coverage(&points, "many");
        assert!(svg.len() < 120_000, "{} bytes", svg.len());
        // What the fields say adds up.
        let mut sums = [0, 0];
        for told in svg.split("<g class=\"w\"><title>").skip(1) {
            let words = told.split("</title>").next().expect("a title");
            for part in words.split(", ") {
                let (count, word) = part.split_once(' ').expect("a count and a word");
                if let Some(at) = ["step", "fall"].iter().position(|known| *known == word) {
                    sums[at] += count.parse::<usize>().expect("a count");
                }
            }
        }
        assert_eq!(sums, [7000, 3000]);
    }

    #[test]
    fn hostile_names_and_numbers_leave_a_whole_document() {
        let mut points: Vec<CoveragePoint> = [f64::NAN, f64::INFINITY, -3.0, 0.0, 1e300, 1e-300]
            .into_iter()
            .map(|impulse| point(f64::NAN, impulse, Verdict::Failed))
            .collect();
        points.extend([f64::NAN, 0.0, 1e300, 5.0].map(|impulse| point(-725.0, impulse, Verdict::Still)));
        points[6].name = "</title><script>alert(1)</script>\u{0}\u{b}\"&'".to_owned();
        points[7].name = points[6].name.clone();
        points[7].rig = format!("{}\u{1}", "<rig>&".repeat(40));
        let svg = coverage(&points, "]]>&<x \u{ffff}");
        assert!(!svg.contains("<script") && !svg.contains("<x ") && !svg.contains("<rig>") && !svg.contains("NaN"));
        assert!(svg.chars().all(|letter| letter == '\n' || !letter.is_control() && letter != '\u{ffff}'));
        assert_eq!(svg.matches("<title>").count(), svg.matches("</title>").count());
        assert!(coverage(&[], "").ends_with("</svg>\n"));
    }

    #[test]
    fn the_table_says_to_where_each_stands_and_from_where_it_falls() {
        let mut points =
            vec![point(0.0, 30.0, Verdict::Sway), point(0.0, 60.0, Verdict::Step), point(0.0, 80.0, Verdict::Fall)];
        points.push(CoveragePoint { rig: "guard".to_owned(), ..point(0.0, 25.0, Verdict::Failed) });
        let svg = coverage(&points, "t");
        let row = |rig: &str| {
            let from = svg.rfind(&format!(">{rig}</text>")).expect("the row");
            let cells = svg[from..].split("class=\"n\"").skip(1).take(10);
            cells.map(|cell| cell.split(['>', '<']).nth(1).expect("text").to_owned()).collect::<Vec<String>>()
        };
        assert_eq!(row("hero"), ["3", "0", "1", "1", "1", "0", "0", "2", "60 Ns", "80 Ns"]);
        assert_eq!(row("guard"), ["1", "0", "0", "0", "0", "1", "0", "2", "–", "–"]);
        assert_eq!(row("all")[0], "4");
    }

    #[test]
    fn rings_lie_at_round_numbers() {
        assert_eq!([3.0, 12.0, 60.0, 200.0, 288.0].map(step), [1.0, 5.0, 20.0, 50.0, 100.0]);
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(step), [1.0; 3]);
        assert_eq!([0.0, 0.5, 12.0, 62.5, 288.4].map(plain), ["0", "0.5", "12", "62.5", "288"]);
    }
}
