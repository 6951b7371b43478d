//! Words on a picture: two fonts that travel inside the program, blended by coverage. Pixels, from the top left.

use crate::maths::real;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use image::{Rgba, RgbaImage};
use std::sync::LazyLock;

/// Which font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Proportional: titles and sentences.
    Prose,
    /// Fixed width: times and numbers.
    Figures,
}

static PROSE: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).ok());
static FIGURES: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(epaint_default_fonts::HACK_REGULAR).ok());

fn font(face: Face) -> Option<&'static FontRef<'static>> {
    match face {
        Face::Prose => PROSE.as_ref(),
        Face::Figures => FIGURES.as_ref(),
    }
}

/// No picture shows more in a line.
const MOST_LETTERS: usize = 2000;

/// How to write: font, height of the line in pixels, colour.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// The font.
    pub face: Face,
    /// px.
    pub size: f32,
    /// sRGB.
    pub color: [u8; 3],
}

/// Writes one line with its top left corner at (x, y); returns the x where it ends.
pub fn write(image: &mut RgbaImage, x: f32, y: f32, pen: Pen, text: &str) -> f32 {
    let Some(font) = font(pen.face) else { return x };
    let scaled = font.as_scaled(PxScale::from(pen.size));
    let mut caret = x;
    let mut last = None;
    for letter in text.chars() {
        let glyph = scaled.glyph_id(letter);
        if let Some(last) = last {
            caret += scaled.kern(last, glyph);
        }
        let placed = glyph.with_scale_and_position(pen.size, point(caret, y + scaled.ascent()));
        if let Some(outline) = font.outline_glyph(placed) {
            let bounds = outline.px_bounds();
            outline.draw(|dx, dy, coverage| {
                let (px, py) = (bounds.min.x as i64 + i64::from(dx), bounds.min.y as i64 + i64::from(dy));
                // The light cut of the prose font reads thin at these sizes: lift the middle of its edges.
                let coverage =
                    if pen.face == Face::Prose { real::powf32(coverage, 0.72) } else { real::powf32(coverage, 0.88) };
                blend(image, px, py, pen.color, coverage);
            });
        }
        caret += scaled.h_advance(glyph);
        last = Some(glyph);
    }
    caret
}

/// As [`write`], on a halo that keeps it legible over a figure.
pub fn write_haloed(image: &mut RgbaImage, x: f32, y: f32, pen: Pen, halo: [u8; 3], text: &str) -> f32 {
    for (dx, dy) in
        [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-0.7, -0.7), (0.7, 0.7), (-0.7, 0.7), (0.7, -0.7)]
    {
        write(image, x + dx, y + dy, Pen { color: halo, ..pen }, text);
    }
    write(image, x, y, pen, text)
}

/// px that the text takes.
pub fn width(face: Face, size: f32, text: &str) -> f32 {
    let Some(font) = font(face) else { return 0.0 };
    let scaled = font.as_scaled(PxScale::from(size));
    let mut sum = 0.0;
    let mut last = None;
    for letter in text.chars() {
        let glyph = scaled.glyph_id(letter);
        sum += last.map_or(0.0, |last| scaled.kern(last, glyph)) + scaled.h_advance(glyph);
        last = Some(glyph);
    }
    sum
}

/// The text, cut with "…" so that it takes at most `room` px.
pub fn fitted(face: Face, size: f32, text: &str, room: f32) -> String {
    // A letter takes a few px at least: what no picture can hold is not measured.
    let letters: Vec<char> = text.chars().take(MOST_LETTERS).collect();
    if letters.len() < MOST_LETTERS && width(face, size, text) <= room {
        return text.to_owned();
    }
    let cut = |kept: usize| letters[..kept].iter().collect::<String>().trim_end().to_owned() + "…";
    let (mut fits, mut over) = (None, letters.len());
    let mut next = over / 2;
    while fits.map_or(over > 0, |fits| fits + 1 < over) {
        if width(face, size, &cut(next)) <= room {
            fits = Some(next)
        } else {
            over = next
        }
        next = fits.unwrap_or(0).midpoint(over);
    }
    fits.map_or(String::new(), cut)
}

/// Blends a colour over a pixel, if it is in the picture.
pub fn blend(image: &mut RgbaImage, x: i64, y: i64, color: [u8; 3], alpha: f32) {
    if x < 0 || y < 0 || x >= i64::from(image.width()) || y >= i64::from(image.height()) || alpha <= 0.0 {
        return;
    }
    let Rgba([r, g, b, _]) = image.get_pixel_mut(x as u32, y as u32);
    let alpha = alpha.min(1.0);
    for (channel, wanted) in [r, g, b].into_iter().zip(color) {
        *channel = (f32::from(*channel) + (f32::from(wanted) - f32::from(*channel)) * alpha + 0.5) as u8;
    }
}

/// Text between tags or in an attribute of XML or HTML; what XML cannot hold at all is replaced.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            letter if letter.is_control() || matches!(letter, '\u{fffe}' | '\u{ffff}') => safe.push('\u{fffd}'),
            letter => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_ink_where_it_says_and_measures_its_own_width() {
        let mut image = RgbaImage::from_pixel(200, 30, Rgba([255, 255, 255, 255]));
        let pen = Pen { face: Face::Figures, size: 14.0, color: [0, 0, 0] };
        let end = write(&mut image, 10.0, 5.0, pen, "t 0.66 s");
        assert!((end - 10.0 - width(Face::Figures, 14.0, "t 0.66 s")).abs() < 1e-3);
        let dark = |from: u32, to: u32| (from..to).any(|x| (0..30).any(|y| image.get_pixel(x, y)[0] < 90));
        assert!(dark(10, end as u32), "letters");
        assert!(!dark(0, 9) && !dark(end as u32 + 2, 200), "nothing beside them");
    }

    #[test]
    fn a_long_title_is_cut_to_its_room_and_a_short_one_kept() {
        let long = "a shove from the left while walking over uneven ground in the dark".repeat(3);
        let short = fitted(Face::Prose, 20.0, &long, 300.0);
        assert!(short.ends_with('…') && width(Face::Prose, 20.0, &short) <= 300.0 && short.len() > 20, "{short}");
        assert_eq!(fitted(Face::Prose, 20.0, "a shove", 300.0), "a shove");
        assert_eq!(fitted(Face::Prose, 20.0, "a shove", 1.0), "");
        assert_eq!(fitted(Face::Prose, 20.0, "", 1.0), "");
        assert_eq!(fitted(Face::Prose, 20.0, "shove", width(Face::Prose, 20.0, "…")), "…");
        let endless = fitted(Face::Prose, 20.0, &"x".repeat(1_000_000), 300.0);
        assert!(endless.ends_with('…') && width(Face::Prose, 20.0, &endless) > 280.0, "as much as there is room for");
    }

    #[test]
    fn writing_over_the_edge_is_harmless() {
        let mut image = RgbaImage::new(8, 8);
        let pen = Pen { face: Face::Prose, size: 40.0, color: [1, 2, 3] };
        write_haloed(&mut image, -20.0, -20.0, pen, [9, 9, 9], "edge ξ");
    }
}
