//! The plan under a moment: footprints, support, the ways of the centre of mass and ξ, seen from above.
//!
//! The picture's right is the character's left (+X) and its bottom the character's front (+Z): the front camera's plan.

use super::compose::{Frame, Trail};
use super::figure::{flat, side_color};
use super::marks::{self, PUSH, SoleMark, XI};
use super::paint::{self, Ink};
use glam::DVec2;
use image::{Rgba, RgbaImage};

/// How the ground maps to the picture.
#[derive(Clone, Copy, Debug)]
pub struct PlanScale {
    /// m, shown in the middle.
    middle: DVec2,
    /// px a metre.
    zoom: f64,
}

const GROUND: Rgba<u8> = Rgba([226, 230, 233, 255]);

/// One scale for all plans of a page: everything that was trodden on fits.
pub fn scale(frames: &[Frame], trail: &Trail, width: u32, height: u32) -> PlanScale {
    let mut low = DVec2::INFINITY;
    let mut high = DVec2::NEG_INFINITY;
    let mut take = |point: DVec2| {
        if point.is_finite() {
            low = low.min(point);
            high = high.max(point);
        }
    };
    for frame in frames {
        let soles = frame.overlay.soles.iter().chain(&frame.overlay.prints);
        soles.flat_map(|sole| &sole.whole).for_each(|point| take(flat(*point)));
        frame.overlay.com.into_iter().for_each(|com| take(flat(com)));
    }
    trail.iter().for_each(|(_, com, _)| take(*com));
    if !(low + high).is_finite() {
        (low, high) = (DVec2::splat(-0.5), DVec2::splat(0.5));
    }
    let size = (high - low).max(DVec2::splat(0.2)) + 0.12;
    let zoom = ((f64::from(width) - 8.0) / size.x).min((f64::from(height) - 8.0) / size.y).min(220.0);
    PlanScale { middle: (low + high) / 2.0, zoom }
}

/// The plan of one moment.
pub fn draw(frame: &Frame, trail: &Trail, scale: &PlanScale, width: u32, height: u32) -> RgbaImage {
    let mut image = RgbaImage::from_pixel(width, height, GROUND);
    let centre = DVec2::new(f64::from(width), f64::from(height)) / 2.0;
    let place = |point: DVec2| centre + (point - scale.middle) * scale.zoom;
    draw_grid(&mut image, scale, centre);
    let overlay = &frame.overlay;
    let corners = |sole: &[glam::DVec3]| sole.iter().map(|point| place(flat(*point))).collect::<Vec<_>>();
    for print in &overlay.prints {
        paint::polygon(&mut image, &corners(&print.whole), Ink(side_color(print.side), 0.10));
        paint::outline(&mut image, &corners(&print.whole), 1.0, Ink(side_color(print.side), 0.35));
    }
    let support = support(&overlay.soles);
    let hull: Vec<DVec2> = support.iter().map(|point| place(*point)).collect();
    paint::polygon(&mut image, &hull, Ink([255, 255, 255], 0.55));
    if hull.len() > 2 {
        paint::outline(&mut image, &hull, 1.0, Ink([92, 100, 110], 0.8));
    }
    for SoleMark { side, whole, held, .. } in &overlay.soles {
        paint::outline(&mut image, &corners(whole), 1.2, Ink(side_color(*side), 0.9));
        paint::polygon(&mut image, &corners(held), Ink(side_color(*side), 0.75));
    }
    let past = trail.iter().filter(|(time, _, _)| *time <= frame.time + 1e-9);
    let ways: Vec<(DVec2, Option<DVec2>)> = past.map(|(_, com, xi)| (place(*com), xi.map(place))).collect();
    let xi: Vec<DVec2> = ways.iter().filter_map(|(_, xi)| *xi).collect();
    paint::polyline(&mut image, &xi, 1.1, Ink(XI, 0.55));
    let com: Vec<DVec2> = ways.iter().map(|(com, _)| *com).collect();
    paint::polyline(&mut image, &com, 1.3, Ink([28, 32, 38], 0.75));
    for push in &overlay.pushes {
        let along = flat(push.force).normalize_or_zero();
        let tip = place(flat(push.point)) - along * 8.0;
        paint::arrow(&mut image, tip - along * 26.0, tip, 3.0, Ink(PUSH, 1.0));
    }
    if let Some(cop) = overlay.cop {
        paint::disc(&mut image, place(cop), 3.4, Ink([28, 32, 38], 0.9));
        paint::disc(&mut image, place(cop), 2.2, Ink(marks::COP, 1.0));
    }
    if let Some(com) = overlay.com {
        paint::quartered(&mut image, place(flat(com)), 4.2);
    }
    if let Some(xi) = overlay.xi {
        marks::draw_xi(&mut image, place(xi), 0.9);
    }
    image
}

/// Half metres, fine; metres, stronger.
fn draw_grid(image: &mut RgbaImage, scale: &PlanScale, centre: DVec2) {
    let reach = centre / scale.zoom;
    for axis in 0..2 {
        let (low, high) = (scale.middle[axis] - reach[axis], scale.middle[axis] + reach[axis]);
        let mut step = (low * 2.0).ceil();
        while step <= high * 2.0 {
            let at = centre[axis] + (step / 2.0 - scale.middle[axis]) * scale.zoom;
            let strength = if step.rem_euclid(2.0) == 0.0 { 0.24 } else { 0.10 };
            let mut from = DVec2::ZERO;
            let mut to = centre * 2.0;
            from[axis] = at;
            to[axis] = at;
            paint::line(image, from, to, 1.0, Ink([60, 70, 80], strength));
            step += 1.0;
        }
    }
}

/// The convex hull of what holds, m, (x, z): Andrew's monotone chain.
fn support(soles: &[SoleMark]) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = soles.iter().flat_map(|sole| sole.held.iter().map(|point| flat(*point))).collect();
    points.retain(|point| point.is_finite());
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return Vec::new();
    }
    let chain = |points: &mut dyn Iterator<Item = &DVec2>| {
        let mut hull: Vec<DVec2> = Vec::new();
        for point in points {
            while hull.len() > 1 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(*point - a) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(*point);
        }
        hull.pop();
        hull
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    hull
}
