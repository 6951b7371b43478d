//! A grid of many clips' small pictures: what came of each, its name, its steps; headings by rig, counts over all.
//!
//! Pixels. A page is drawn when it is asked for and pictures are fetched one at a time, so the memory is one page's, however
//! many clips there are. A page of 400 is at most 2600 x 9000 px.

use super::cell::{CELL_HEIGHT, CELL_WIDTH};
use super::paint::{self, Ink};
use super::text::{self, Face, Pen};
use super::verdict::Verdict;
use glam::DVec2;
use image::{Rgba, RgbaImage, imageops};
use std::ops::Range;

/// Cells of a page at most.
pub const PAGE: usize = 400;

/// What stands under and in a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct GridCell {
    /// Of the clip.
    pub name: String,
    /// Cells of one rig stand under its heading; empty for none.
    pub rig: String,
    /// What came of it.
    pub verdict: Verdict,
    /// Footfalls.
    pub steps: u32,
    /// Plausibility, 0..1.
    pub score: Option<f64>,
    /// The name of an earlier one that looks the same.
    pub duplicate_of: Option<String>,
    /// Why there is no clip.
    pub note: String,
}

/// A grid to draw.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    /// All cells, in order; those of one rig beside each other.
    pub cells: &'a [GridCell],
    /// Over every page.
    pub title: &'a str,
    /// Cells a row, where the variations' order suggests a number.
    pub columns: Option<usize>,
}

const CAPTION: u32 = 42;
const GAP: u32 = 6;
const MARGIN: u32 = 14;
const HEADER: u32 = 62;
const HEADING: u32 = 34;
const PAPER: Rgba<u8> = Rgba([244, 245, 246, 255]);
const CARD: [u8; 3] = [255, 255, 255];
const INK: [u8; 3] = [28, 32, 38];
const QUIET: [u8; 3] = [92, 100, 110];

impl Grid<'_> {
    /// How many pages there are; a grid without cells has one, with its header.
    pub fn pages(&self) -> usize {
        self.cells.len().div_ceil(PAGE).max(1)
    }

    /// The cells of a page.
    pub fn range(&self, page: usize) -> Range<usize> {
        let count = self.cells.len();
        (page * PAGE).min(count)..((page + 1) * PAGE).min(count)
    }

    /// Draws a page, asking once for the picture of every cell on it, in order. Without a picture the cell says why.
    pub fn draw(&self, page: usize, picture: &mut dyn FnMut(usize) -> Option<RgbaImage>) -> RgbaImage {
        let range = self.range(page);
        let columns = self.columns(range.len());
        let rows = rows(self.cells, range, columns);
        let width = (2 * MARGIN + columns as u32 * (CELL_WIDTH + GAP) - GAP).max(HEADER * 12);
        let height = HEADER + MARGIN + rows.iter().map(Row::height).sum::<u32>();
        let mut image = RgbaImage::from_pixel(width, height, PAPER);
        self.draw_header(&mut image, page);
        let mut y = HEADER;
        for row in rows {
            match &row {
                Row::Heading(all) => self.draw_heading(&mut image, y, all),
                Row::Cells(cells) => {
                    for (column, index) in cells.clone().enumerate() {
                        let x = MARGIN + column as u32 * (CELL_WIDTH + GAP);
                        draw_cell(&mut image, (x, y), &self.cells[index], picture(index));
                    }
                }
            }
            y += row.height();
        }
        image
    }

    /// So many that a page is a little higher than wide.
    fn columns(&self, count: usize) -> usize {
        let square = (count as f64 * f64::from(CELL_HEIGHT + CAPTION) / f64::from(CELL_WIDTH) / 1.2).sqrt();
        self.columns.unwrap_or(square.round() as usize).clamp(3, 8).min(count.max(1))
    }

    fn draw_header(&self, image: &mut RgbaImage, page: usize) {
        let right = image.width() as f32 - MARGIN as f32;
        let pages = self.pages();
        let of = if pages > 1 { format!("page {} of {pages}", page + 1) } else { String::new() };
        let wide = text::width(Face::Prose, 15.0, &of);
        text::write(image, right - wide, 12.0, Pen { face: Face::Prose, size: 15.0, color: QUIET }, &of);
        let room = right - wide - MARGIN as f32 - 20.0;
        let title = text::fitted(Face::Prose, 24.0, self.title, room);
        text::write(image, MARGIN as f32, 5.0, Pen { face: Face::Prose, size: 24.0, color: INK }, &title);
        counts(image, MARGIN as f32, 36.0, self.cells);
    }

    fn draw_heading(&self, image: &mut RgbaImage, y: u32, all: &Range<usize>) {
        let cells = &self.cells[all.clone()];
        let rig = cells.first().map_or("", |cell| &cell.rig);
        let low = DVec2::new(f64::from(MARGIN), f64::from(y) + 3.0);
        paint::panel(image, low, DVec2::new(f64::from(image.width() - MARGIN), low.y + 1.0), 0.5, Ink(QUIET, 0.35));
        let name = text::fitted(Face::Prose, 18.0, rig, (image.width() as f32 - 520.0).max(120.0));
        let pen = Pen { face: Face::Prose, size: 18.0, color: INK };
        let end = text::write(image, MARGIN as f32, y as f32 + 8.0, pen, &name);
        counts(image, end + 18.0, y as f32 + 10.0, cells);
    }
}

/// A strip of a page.
enum Row {
    /// Over the cells of this rig (all of them, on every page).
    Heading(Range<usize>),
    Cells(Range<usize>),
}

impl Row {
    fn height(&self) -> u32 {
        match self {
            Row::Heading(_) => HEADING,
            Row::Cells(_) => CELL_HEIGHT + CAPTION + GAP,
        }
    }
}

fn rows(cells: &[GridCell], page: Range<usize>, columns: usize) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut at = page.start;
    while at < page.end {
        let rig = &cells[at].rig;
        let first = cells[..at].iter().rposition(|cell| cell.rig != *rig).map_or(0, |before| before + 1);
        let last = cells[at..].iter().position(|cell| cell.rig != *rig).map_or(cells.len(), |after| at + after);
        if !rig.is_empty() {
            rows.push(Row::Heading(first..last));
        }
        let end = last.min(page.end);
        while at < end {
            let next = (at + columns).min(end);
            rows.push(Row::Cells(at..next));
            at = next;
        }
    }
    rows
}

/// How many there are, and how many came to what.
fn counts(image: &mut RgbaImage, x: f32, y: f32, cells: &[GridCell]) {
    let pen = Pen { face: Face::Prose, size: 15.0, color: QUIET };
    let total = if cells.len() == 1 { "1 variation".to_owned() } else { format!("{} variations", cells.len()) };
    let mut x = text::write(image, x, y, pen, &total) + 16.0;
    for verdict in Verdict::ALL {
        let count = cells.iter().filter(|cell| cell.verdict == verdict).count();
        if count > 0 {
            verdict.draw(image, DVec2::new(f64::from(x) + 6.0, f64::from(y) + 9.5), 5.5, verdict.color());
            let words = format!("{count} {}", verdict.word());
            x = text::write(image, x + 16.0, y, Pen { color: INK, ..pen }, &words) + 16.0;
        }
    }
    let alike = cells.iter().filter(|cell| cell.duplicate_of.is_some()).count();
    if alike > 0 {
        text::write(image, x, y, pen, &format!("{alike} much like an earlier one"));
    }
}

/// The picture, a bar in the verdict's colour, the badge and what is known beside it, the name.
fn draw_cell(image: &mut RgbaImage, (x, y): (u32, u32), cell: &GridCell, picture: Option<RgbaImage>) {
    let low = DVec2::new(f64::from(x), f64::from(y));
    let card = low + DVec2::new(f64::from(CELL_WIDTH), f64::from(CELL_HEIGHT + CAPTION));
    paint::panel(image, low, card, 2.0, Ink(CARD, 1.0));
    match picture {
        Some(picture) => {
            let (wide, high) = (picture.width().min(CELL_WIDTH), picture.height().min(CELL_HEIGHT));
            let picture = imageops::crop_imm(&picture, 0, 0, wide, high).to_image();
            imageops::replace(image, &picture, i64::from(x), i64::from(y));
        }
        None => draw_absent(image, (x, y), cell),
    }
    let color = cell.verdict.color();
    let under = low + DVec2::new(0.0, f64::from(CELL_HEIGHT));
    paint::panel(image, under, under + DVec2::new(f64::from(CELL_WIDTH), 3.0), 0.0, Ink(color, 1.0));
    let (left, top) = (x as f32 + 6.0, (y + CELL_HEIGHT) as f32 + 6.0);
    let word = cell.verdict.word();
    let pill = under + DVec2::new(6.0, 6.0);
    let wide = f64::from(text::width(Face::Prose, 13.0, word)) + 26.0;
    paint::panel(image, pill, pill + DVec2::new(wide, 16.0), 8.0, Ink(color, 1.0));
    cell.verdict.draw(image, pill + DVec2::new(10.0, 8.0), 4.0, [255; 3]);
    text::write(image, left + 19.0, top + 0.5, Pen { face: Face::Prose, size: 13.0, color: [255; 3] }, word);
    let (facts, room) = (left + wide as f32 + 8.0, CELL_WIDTH as f32 - 20.0 - wide as f32);
    let pen = Pen { face: Face::Prose, size: 13.0, color: QUIET };
    let mut known = match cell.steps {
        0 => Vec::new(),
        1 => vec!["1 step".to_owned()],
        steps => vec![format!("{steps} steps")],
    };
    match &cell.duplicate_of {
        Some(other) => {
            known.push("like ".to_owned());
            let end = text::write(image, facts, top + 0.5, pen, &known.join(" · "));
            let other = cut_in_the_middle(Face::Prose, 13.0, other, room - (end - facts));
            text::write(image, end, top + 0.5, pen, &other);
        }
        None => {
            known.extend(cell.score.filter(|score| score.is_finite()).map(|score| format!("plausibility {score:.2}")));
            text::write(image, facts, top + 0.5, pen, &text::fitted(Face::Prose, 13.0, &known.join(" · "), room));
        }
    }
    let name = cut_in_the_middle(Face::Prose, 14.0, &cell.name, CELL_WIDTH as f32 - 12.0);
    text::write(image, left, top + 17.5, Pen { face: Face::Prose, size: 14.0, color: INK }, &name);
}

/// Why there is no picture, in a striped field.
fn draw_absent(image: &mut RgbaImage, (x, y): (u32, u32), cell: &GridCell) {
    for (dx, dy) in (0..CELL_WIDTH).flat_map(|dx| (0..CELL_HEIGHT).map(move |dy| (dx, dy))) {
        let shade = if (dx + dy) / 9 % 2 == 0 { 226 } else { 234 };
        image.put_pixel(x + dx, y + dy, Rgba([shade, shade, shade, 255]));
    }
    let words = if cell.note.is_empty() { "no picture" } else { &cell.note };
    let pen = Pen { face: Face::Prose, size: 14.0, color: INK };
    for (at, line) in wrapped(words, CELL_WIDTH as f32 - 20.0, 6).iter().enumerate() {
        text::write(image, x as f32 + 10.0, (y + 10 + 18 * at as u32) as f32, pen, line);
    }
}

/// Lines of words, the last one cut.
fn wrapped(words: &str, room: f32, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = vec![String::new()];
    // A cause can be long; what no cell can show is not measured.
    let words: String = words.chars().take(600).collect();
    for word in words.split_whitespace() {
        let line = lines.last().cloned().unwrap_or_default();
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if line.is_empty() || text::width(Face::Prose, 14.0, &longer) <= room {
            lines.pop();
            lines.push(longer);
        } else {
            lines.push(word.to_owned());
        }
    }
    let left: String = lines.iter().skip(most - 1).cloned().collect::<Vec<_>>().join(" ");
    lines.truncate(most - 1);
    lines.push(left);
    lines.iter().map(|line| text::fitted(Face::Prose, 14.0, line, room)).collect()
}

/// The text with "…" in its middle where it takes more than `room` px: names of variations differ at their ends.
fn cut_in_the_middle(face: Face, size: f32, words: &str, room: f32) -> String {
    if words.chars().count() < 400 && text::width(face, size, words) <= room {
        return words.to_owned();
    }
    let letters: Vec<char> = words.chars().collect();
    // The most letters that fit, by halving.
    let shown = |kept: usize| {
        let head: String = letters[..kept - kept / 2].iter().collect();
        let tail: String = letters[letters.len() - kept / 2..].iter().collect();
        format!("{head}…{tail}")
    };
    let (mut fits, mut over) = (0, letters.len().min(400));
    while fits + 1 < over {
        let middle = fits.midpoint(over);
        if text::width(face, size, &shown(middle)) <= room { fits = middle } else { over = middle }
    }
    shown(fits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(name: &str, rig: &str, verdict: Verdict) -> GridCell {
        let (name, rig, note) = (name.to_owned(), rig.to_owned(), String::new());
        GridCell { name, rig, verdict, steps: 2, score: Some(0.91), duplicate_of: None, note }
    }

    fn cells(count: usize) -> Vec<GridCell> {
        (0..count).map(|at| cell(&format!("shove_{at}"), "hero", Verdict::ALL[at % 4])).collect()
    }

    fn grey(shade: u8) -> Option<RgbaImage> {
        Some(RgbaImage::from_pixel(CELL_WIDTH, CELL_HEIGHT, Rgba([shade, shade, shade, 255])))
    }

    fn near(image: &RgbaImage, color: [u8; 3]) -> usize {
        image.pixels().filter(|pixel| (0..3).all(|c| pixel[c].abs_diff(color[c]) < 3)).count()
    }

    #[test]
    fn every_cell_is_asked_for_once_in_order_over_all_pages() {
        let cells = cells(2 * PAGE + 5);
        let grid = Grid { cells: &cells, title: "many", columns: None };
        assert_eq!(grid.pages(), 3);
        let mut asked = Vec::new();
        for page in 0..grid.pages() {
            let image = grid.draw(page, &mut |index| {
                asked.push(index);
                None
            });
            assert!(image.width() <= 2700 && image.height() <= 9200, "{} x {}", image.width(), image.height());
        }
        assert_eq!(asked, (0..cells.len()).collect::<Vec<_>>());
    }

    #[test]
    fn a_cell_shows_its_picture_and_its_verdicts_colour() {
        for verdict in Verdict::ALL {
            let cells = [cell("one", "", verdict)];
            let grid = Grid { cells: &cells, title: "t", columns: None };
            let image = grid.draw(0, &mut |_| grey(17));
            let shown = near(&image, [17; 3]);
            assert!(shown >= (CELL_WIDTH * CELL_HEIGHT) as usize, "{shown} pixels of the picture");
            assert!(near(&image, verdict.color()) > 900, "{verdict:?}: {}", near(&image, verdict.color()));
            for other in Verdict::ALL.into_iter().filter(|other| *other != verdict) {
                assert!(near(&image, other.color()) < 60, "{verdict:?} looks like {other:?}");
            }
        }
    }

    #[test]
    fn rigs_have_headings_and_a_new_row() {
        let mut mixed = cells(4);
        mixed.extend((0..2).map(|at| cell(&format!("shove_{at}"), "guard", Verdict::Step)));
        let rows = rows(&mixed, 0..6, 3);
        let kinds: Vec<(bool, Range<usize>)> = rows
            .into_iter()
            .map(|row| match row {
                Row::Heading(all) => (true, all),
                Row::Cells(cells) => (false, cells),
            })
            .collect();
        assert_eq!(kinds, [(true, 0..4), (false, 0..3), (false, 3..4), (true, 4..6), (false, 4..6)]);
    }

    #[test]
    fn a_heading_on_a_further_page_counts_the_whole_rig() {
        let cells = cells(PAGE + 3);
        let on_second = rows(&cells, PAGE..PAGE + 3, 8);
        assert!(matches!(&on_second[0], Row::Heading(all) if *all == (0..PAGE + 3)));
    }

    #[test]
    fn a_failed_one_says_why_and_hostile_names_stay_inside() {
        let long = "x".repeat(100_000);
        let mut failed = cell(&long, &long, Verdict::Failed);
        failed.note = "the simulation broke down at 1.20 s: the hips flew away ".repeat(40);
        failed.duplicate_of = Some(long.clone());
        failed.score = Some(f64::NAN);
        let plain = GridCell { note: String::new(), ..failed.clone() };
        let draw = |cell: GridCell| Grid { cells: &[cell], title: &long, columns: Some(0) }.draw(0, &mut |_| None);
        let (told, untold) = (draw(failed), draw(plain));
        let dark = |image: &RgbaImage| image.pixels().filter(|pixel| pixel[0] < 110).count();
        assert!(dark(&told) > dark(&untold) + 300, "the cause is written out: {} and {}", dark(&told), dark(&untold));
    }

    #[test]
    fn a_long_name_keeps_both_its_ends() {
        let name = format!("hero_{}_front_300N_s1", "shove_while_walking_".repeat(6));
        let short = cut_in_the_middle(Face::Prose, 14.0, &name, 308.0);
        assert!(short.starts_with("hero_") && short.ends_with("_300N_s1") && short.contains('…'), "{short}");
        let wide = text::width(Face::Prose, 14.0, &short);
        assert!((270.0..=308.0).contains(&wide), "{wide}");
        assert_eq!(cut_in_the_middle(Face::Prose, 14.0, "short", 308.0), "short");
    }

    #[test]
    fn pictures_of_another_size_do_not_spill_and_an_empty_grid_has_a_page() {
        let two = cells(2);
        let grid = Grid { cells: &two, title: "t", columns: None };
        let image = grid.draw(0, &mut |_| Some(RgbaImage::from_pixel(2000, 2000, Rgba([9, 9, 9, 255]))));
        assert_eq!(near(&image, [9; 3]), 2 * (CELL_WIDTH * CELL_HEIGHT) as usize);
        let none = Grid { cells: &[], title: "nothing", columns: None };
        assert_eq!(none.pages(), 1);
        assert!(none.draw(0, &mut |_| None).height() > 50);
    }
}
