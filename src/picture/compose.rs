//! Frames to a page: a header with its legend, then for each row of moments a front view, a side view and a plan.
//!
//! The cameras of one view share scale and height; they follow the body only as far as it would otherwise leave the
//! picture, so that the squares of the ground show the way it went. The front camera looks at the rig's face (from +Z, the
//! character's left is on the right), the side camera stands on its left (+X, it faces to the left), the plan is seen from
//! above with the front camera's right.

use super::figure::flat;
use super::ground::GroundLook;
use super::marks::{self, Overlay};
use super::paint::{self, Ink};
use super::plan;
use super::raster::{Camera, Canvas, Lights, Surface};
use super::shadow::{self, GroundShadow};
use super::stage::{self, Stage};
use super::text::{self, Face, Pen};
use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage, imageops};
use rayon::prelude::*;

/// One moment, ready to be drawn.
#[derive(Clone, Debug, Default)]
pub struct Frame<'a> {
    /// s.
    pub time: f64,
    /// What happens: "hit", "right foot down".
    pub label: String,
    /// The body.
    pub surfaces: Vec<Surface<'a>>,
    /// The marks.
    pub overlay: Overlay,
    /// What is around it.
    pub stage: Stage,
}

/// Where the centre of mass and ξ went, for the plan: (s, com (x, z), ξ (x, z)).
pub type Trail = Vec<(f64, DVec2, Option<DVec2>)>;

/// What stands over the pictures.
#[derive(Clone, Debug, Default)]
pub struct Header {
    /// The scenario's title.
    pub title: String,
    /// A line of numbers.
    pub subtitle: String,
    /// A short word on a coloured ground, and that colour.
    pub badge: Option<(String, [u8; 3])>,
}

/// Sizes in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Of the whole page.
    pub width: u32,
    /// Moments a row.
    pub columns: usize,
    /// Height of a front or side view.
    pub view: u32,
    /// Height of the plan; 0 for none.
    pub plan: u32,
}

impl Default for Layout {
    fn default() -> Layout {
        Layout { width: 1400, columns: 6, view: 214, plan: 96 }
    }
}

impl Layout {
    /// Sizes at which that many moments fill a page well.
    pub fn fitting(count: usize) -> Layout {
        match count {
            0..=5 => Layout { columns: count.max(3), view: 320, plan: 120, ..Layout::default() },
            6..=8 => Layout { columns: count, view: if count < 8 { 270 } else { 240 }, ..Layout::default() },
            9..=12 => Layout { columns: count.div_ceil(2), ..Layout::default() },
            13..=16 => Layout { columns: 8, view: 190, ..Layout::default() },
            _ => Layout { columns: 8, view: 180, plan: 84, ..Layout::default() },
        }
    }
}

/// From where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum View {
    Front,
    Side,
}

const HEADER: u32 = 58;
const GAP: u32 = 2;
const PAPER: Rgba<u8> = Rgba([244, 245, 246, 255]);
const INK: [u8; 3] = [28, 32, 38];
const QUIET: [u8; 3] = [92, 100, 110];

/// Draws the page.
pub fn page(frames: &[Frame], trail: &Trail, header: &Header, layout: &Layout) -> RgbaImage {
    let columns = layout.columns.clamp(1, frames.len().max(1));
    let rows = frames.len().div_ceil(columns).max(1) as u32;
    let plan_height = if layout.plan > 0 { layout.plan + 1 } else { 0 };
    let block = 2 * layout.view + 1 + plan_height + GAP;
    let height = HEADER + rows * block;
    let mut image = RgbaImage::from_pixel(layout.width, height, PAPER);
    draw_header(&mut image, header);
    let cell = (layout.width - (columns as u32 - 1)) / columns as u32;
    let sides = [View::Front, View::Side];
    let told = frames.iter().any(|frame| !frame.overlay.soles.is_empty());
    let cameras = sides.map(|view| cameras(frames, view, cell, layout.view));
    let jobs: Vec<(usize, usize)> = (0..frames.len()).flat_map(|at| [(at, 0), (at, 1)]).collect();
    let pictures: Vec<RgbaImage> = jobs
        .par_iter()
        .map(|(at, side)| picture(&frames[*at], &cameras[*side][*at], cell as usize, layout.view as usize, FULL))
        .collect();
    let corner = |at: usize| ((at % columns) as u32 * (cell + 1), HEADER + (at / columns) as u32 * block);
    for ((at, side), picture) in jobs.iter().zip(&pictures) {
        let (x, y) = corner(*at);
        let y = y + *side as u32 * (layout.view + 1);
        imageops::replace(&mut image, picture, i64::from(x), i64::from(y));
        if at % columns == 0 {
            let name = ["front", "side"][*side];
            let pen = Pen { face: Face::Prose, size: 13.0, color: QUIET };
            text::write(&mut image, x as f32 + 7.0, (y + layout.view) as f32 - 19.0, pen, name);
        }
        if *side == 0 {
            draw_label(&mut image, x as f32 + 7.0, y as f32 + 5.0, &frames[*at], cell as f32 - 14.0);
            if told {
                let corner = DVec2::new(f64::from(x + cell) - 6.0, f64::from(y + layout.view) - 6.0);
                marks::draw_feet(&mut image, corner, &frames[*at].overlay);
            }
        }
    }
    if layout.plan > 0 {
        let scale = plan::scale(frames, trail, cell, layout.plan);
        for (at, frame) in frames.iter().enumerate() {
            let (x, y) = corner(at);
            let picture = plan::draw(frame, trail, &scale, cell, layout.plan);
            imageops::replace(&mut image, &picture, i64::from(x), i64::from(y + 2 * (layout.view + 1)));
            if at % columns == 0 {
                let pen = Pen { face: Face::Prose, size: 13.0, color: QUIET };
                let low = (y + 2 * (layout.view + 1) + layout.plan) as f32;
                text::write(&mut image, x as f32 + 7.0, low - 19.0, pen, "above");
            }
        }
    }
    image
}

/// How finely a picture is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grain {
    /// Samples a pixel in each direction.
    pub(super) samples: usize,
    /// m, the squares of the shadow.
    pub(super) shadow: f64,
    /// With the marks of the balance.
    pub(super) points: bool,
}

/// A page's.
const FULL: Grain = Grain { samples: 3, shadow: shadow::FINE, points: true };

/// One view of one moment.
pub(super) fn picture(frame: &Frame, camera: &Camera, width: usize, height: usize, grain: Grain) -> RgbaImage {
    let lights = Lights::of(camera);
    let lamp = (lights.key + DVec3::Y * 1.4).normalize();
    let mut canvas = Canvas::new(width, height, grain.samples);
    let stage = &frame.stage;
    if stage.is_flat() {
        canvas.background(camera);
        marks::draw_ground(&mut canvas, camera, &frame.overlay);
        if let Some(shadow) = &GroundShadow::cast(&frame.surfaces, lamp, grain.shadow) {
            canvas.shade_ground(camera, shadow);
        }
    } else {
        let level = stage.height(frame.overlay.com.map_or(DVec2::ZERO, flat));
        // Near a sole the ground is as high as that.
        let near = |point: DVec3| {
            let soles = frame.overlay.soles.iter().flat_map(|sole| &sole.whole);
            let nearest = soles.min_by(|a, b| flat(**a - point).length().total_cmp(&flat(**b - point).length()));
            nearest.map_or(level, |sole| sole.y)
        };
        let shadow = GroundShadow::cast_over(&frame.surfaces, lamp, grain.shadow, &near);
        let dark = |point: DVec3| shadow.as_ref().map_or(0.0, |shadow| shadow.on(point));
        canvas.sky(camera);
        let foot = frame.overlay.com.map_or(DVec3::ZERO, |com| DVec3::new(com.x, level, com.z));
        for (surface, turn) in &stage.ground {
            let back = turn.inverse();
            let cut = |point: DVec3| stage::hides(point, foot, camera.eye);
            canvas.ground(
                camera,
                &lights,
                surface,
                &GroundLook { squares: &|point| flat(back * point), dark: &dark, cut: &cut },
            );
        }
        marks::draw_ground(&mut canvas, camera, &frame.overlay);
    }
    for thing in &stage.things {
        canvas.surface(camera, &lights, thing, true);
    }
    for surface in &frame.surfaces {
        canvas.surface(camera, &lights, surface, true);
    }
    marks::draw_pushes(&mut canvas, camera, &lights, &frame.overlay, &frame.surfaces);
    canvas.ink();
    let mut image = canvas.resolve();
    if grain.points {
        let size = (height as f64 / 214.0).sqrt().clamp(0.75, 1.25);
        marks::draw_points(&mut image, camera, &frame.overlay, size, &|at| stage.height(at));
    }
    image
}

/// One camera a frame: equal scale, following no further than the frame needs.
fn cameras(frames: &[Frame], view: View, width: u32, height: u32) -> Vec<Camera> {
    let (right, toward) = match view {
        View::Front => (DVec3::X, DVec3::Z),
        View::Side => (DVec3::NEG_Z, DVec3::X),
    };
    let found: Vec<(DVec3, DVec3)> = frames.iter().map(bounds).collect();
    // m, the ground that the body is on.
    let floors: Vec<f64> = frames.iter().zip(&found).map(|(frame, found)| floor(frame, found)).collect();
    let top = found.iter().zip(&floors).map(|((_, high), floor)| high.y - floor).fold(0.3, f64::max).min(6.0);
    let distance = 2.5 * top.max(1.0);
    // What reaches towards the camera looks larger by that much.
    let nearer =
        |low: DVec3, high: DVec3, axis: DVec3| 1.0 / (1.0 - ((high - low).dot(axis).abs() / 2.0 / distance).min(0.6));
    // The widest body decides in both views, so that front and side have one scale.
    let widths = found.iter().map(|(low, high)| {
        let size = *high - *low;
        (size.x * nearer(*low, *high, DVec3::Z)).max(size.z * nearer(*low, *high, DVec3::X))
    });
    let widest = widths.fold(0.3, f64::max).min(8.0);
    let (head_room, foot_room) = (25.0, 15.0);
    let scale = ((f64::from(height) - head_room - foot_room) / top).min((f64::from(width) - 18.0) / widest);
    let room = f64::from(width) / scale - 0.06;
    // Arrows are seen whole where there is room for them beside the body.
    let boxes: Vec<(DVec3, DVec3)> =
        frames.iter().zip(&found).map(|(frame, found)| with_arrows(frame, *found, right, room)).collect();
    let follow = |axis: DVec3, room: f64, whole_box: bool| -> Vec<f64> {
        let spans: Vec<(f64, f64)> = boxes
            .iter()
            .map(|(low, high)| {
                let (a, b) = (low.dot(axis), high.dot(axis));
                ((a + b) / 2.0, if whole_box { (a - b).abs() / 2.0 * nearer(*low, *high, toward) } else { 0.0 })
            })
            .collect();
        let low = spans.iter().map(|(at, half)| at - half).fold(f64::INFINITY, f64::min);
        let high = spans.iter().map(|(at, half)| at + half).fold(f64::NEG_INFINITY, f64::max);
        let bodies = found.iter().flat_map(|(low, high)| [low.dot(axis), high.dot(axis)]);
        let (first, last) = bodies.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), at| (a.min(at), b.max(at)));
        // The bodies stand in the middle, unless the arrows then want more than the other side has to give.
        let middle = ((first + last) / 2.0).min(low + room / 2.0).max(high - room / 2.0);
        let middle = if high - low > room { (low + high) / 2.0 } else { middle };
        let share = spans
            .iter()
            .map(|(at, half)| 1.0 - ((room / 2.0 - half) / (at - middle).abs().max(1e-9)).max(0.0))
            .fold(0.0, f64::max);
        spans.iter().map(|(at, _)| middle + share * (at - middle)).collect()
    };
    let across = follow(right, room, true);
    let depth = follow(toward, 0.5, false);
    let centre = DVec2::new(f64::from(width) / 2.0, (head_room + f64::from(height) - foot_room) / 2.0);
    across
        .iter()
        .zip(depth)
        .zip(floors)
        .map(|((across, depth), floor)| {
            let target = right * *across + toward * depth + DVec3::Y * (floor + top * 0.5);
            let eye = target + toward * distance + DVec3::Y * (top * 0.32);
            Camera::looking_at(eye, target, scale * distance, centre)
        })
        .collect()
}

/// m, how high the ground is under a body, or the body's lowest point where that is lower.
pub(super) fn floor(frame: &Frame, (low, high): &(DVec3, DVec3)) -> f64 {
    if frame.stage.is_flat() {
        return 0.0;
    }
    let middle = frame.overlay.com.map_or(flat((*low + *high) / 2.0), flat);
    frame.stage.height(middle).min(low.y)
}

/// Of the body, m.
pub(super) fn bounds(frame: &Frame) -> (DVec3, DVec3) {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for point in frame.surfaces.iter().flat_map(|surface| &surface.positions).filter(|point| point.is_finite()) {
        low = low.min(*point);
        high = high.max(*point);
    }
    if !(low + high).is_finite() {
        let middle = frame.overlay.com.map_or(DVec2::ZERO, flat);
        return (DVec3::new(middle.x - 0.4, 0.0, middle.y - 0.4), DVec3::new(middle.x + 0.4, 1.8, middle.y + 0.4));
    }
    (low, high)
}

/// The body's box, stretched by its arrows as far as there is room along `right`.
fn with_arrows(frame: &Frame, (low, high): (DVec3, DVec3), right: DVec3, room: f64) -> (DVec3, DVec3) {
    let ends = frame.overlay.pushes.iter().map(|push| marks::arrow_ends(push, &frame.surfaces).0);
    ends.fold((low, high), |(low, high), end| {
        let along = right * (end.dot(right) - low.dot(right)) + low;
        let (wide_low, wide_high) = (low.min(along), high.max(along));
        let fits = ((wide_high - wide_low).dot(right)).abs() <= room;
        if fits { (wide_low, wide_high) } else { (low, high) }
    })
}

/// Time and what happens.
fn draw_label(image: &mut RgbaImage, x: f32, y: f32, frame: &Frame, room: f32) {
    let halo = [214, 221, 227];
    let pen = Pen { face: Face::Figures, size: 13.5, color: INK };
    let end = text::write_haloed(image, x, y, pen, halo, &format!("{:.2} s", frame.time));
    let words = text::fitted(Face::Prose, 14.0, &frame.label, room - (end - x) - 8.0);
    let pen = Pen { face: Face::Prose, size: 14.0, color: INK };
    text::write_haloed(image, end + 8.0, y - 0.5, pen, halo, &words);
}

/// Title, numbers, outcome, legend.
fn draw_header(image: &mut RgbaImage, header: &Header) {
    let right = image.width() as f32;
    let legend = 372.0;
    let title = text::fitted(Face::Prose, 24.0, &header.title, right - legend - 150.0);
    let pen = Pen { face: Face::Prose, size: 24.0, color: INK };
    let mut x = text::write(image, 12.0, 5.0, pen, &title) + 14.0;
    if let Some((word, color)) = &header.badge {
        let wide = text::width(Face::Prose, 15.0, word);
        let (low, high) = (DVec2::new(f64::from(x), 9.0), DVec2::new(f64::from(x + wide) + 20.0, 29.0));
        paint::panel(image, low, high, 10.0, Ink(*color, 1.0));
        x = text::write(image, x + 10.0, 11.0, Pen { face: Face::Prose, size: 15.0, color: [255; 3] }, word);
    }
    let _ = x;
    let room = right - legend - 30.0;
    let numbers = text::fitted(Face::Prose, 15.0, &header.subtitle, room);
    text::write(image, 12.0, 34.0, Pen { face: Face::Prose, size: 15.0, color: QUIET }, &numbers);
    draw_legend(image, right - legend);
}

/// What the marks mean.
fn draw_legend(image: &mut RgbaImage, left: f32) {
    use crate::model::Side;
    let pen = Pen { face: Face::Prose, size: 14.0, color: QUIET };
    let left = f64::from(left);
    let spot = |column: usize, row: usize| DVec2::new(left + [0.0, 122.0, 262.0][column], [19.0, 41.0][row]);
    let word = |image: &mut RgbaImage, at: DVec2, what: &str| {
        text::write(image, at.x as f32 + 13.0, at.y as f32 - 8.5, pen, what);
    };
    paint::quartered(image, spot(0, 0), 5.0);
    word(image, spot(0, 0), "centre of mass");
    marks::draw_xi(image, spot(0, 1), 1.0);
    word(image, spot(0, 1), "extrapolated");
    paint::disc(image, spot(1, 0), 3.6, Ink(INK, 0.9));
    paint::disc(image, spot(1, 0), 2.4, Ink(marks::COP, 1.0));
    word(image, spot(1, 0), "centre of pressure");
    let at = spot(1, 1);
    paint::arrow(image, at - DVec2::new(9.0, 0.0), at + DVec2::new(9.0, 0.0), 3.0, Ink(marks::PUSH, 1.0));
    word(image, at, "push");
    for (row, side) in Side::BOTH.into_iter().enumerate() {
        let at = spot(2, row);
        let half = DVec2::new(8.0, 3.5);
        paint::panel(image, at - half, at + half, 3.5, Ink(super::figure::side_color(side), 0.85));
        word(image, at, ["left foot holds", "right foot holds"][row]);
    }
}
