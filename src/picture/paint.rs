//! Flat drawing on a finished picture: lines, discs, rings, arrows and polygons with smooth edges. Pixels, sRGB.

use super::text::blend;
use glam::DVec2;
use image::RgbaImage;

/// A colour and how much it covers, 0..1.
#[derive(Clone, Copy, Debug)]
pub struct Ink(pub [u8; 3], pub f64);

/// Visits the pixels of a box with their centres.
fn over(image: &mut RgbaImage, low: DVec2, high: DVec2, ink: Ink, coverage: impl Fn(DVec2) -> f64) {
    if !(low + high).is_finite() {
        return;
    }
    let limit = DVec2::new(f64::from(image.width()), f64::from(image.height()));
    let low = low.floor().clamp(DVec2::ZERO, limit);
    let high = high.ceil().clamp(DVec2::ZERO, limit);
    for y in low.y as i64..high.y as i64 {
        for x in low.x as i64..high.x as i64 {
            let covered = coverage(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)).clamp(0.0, 1.0);
            if covered > 0.0 {
                blend(image, x, y, ink.0, (covered * ink.1) as f32);
            }
        }
    }
}

/// A straight line with round ends.
pub fn line(image: &mut RgbaImage, from: DVec2, to: DVec2, width: f64, ink: Ink) {
    let margin = DVec2::splat(width / 2.0 + 1.0);
    let along = to - from;
    over(image, from.min(to) - margin, from.max(to) + margin, ink, |point| {
        let share = ((point - from).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        width / 2.0 + 0.5 - point.distance(from + along * share)
    });
}

/// Joined lines.
pub fn polyline(image: &mut RgbaImage, points: &[DVec2], width: f64, ink: Ink) {
    for pair in points.windows(2) {
        line(image, pair[0], pair[1], width, ink);
    }
}

/// A dashed line.
pub fn dashed(image: &mut RgbaImage, from: DVec2, to: DVec2, width: f64, ink: Ink) {
    let length = from.distance(to);
    if !length.is_finite() || length > 4000.0 {
        return;
    }
    let along = (to - from).normalize_or_zero();
    let mut at = 0.0;
    while at < length {
        line(image, from + along * at, from + along * (at + 2.5).min(length), width, ink);
        at += 6.0;
    }
}

/// A filled disc.
pub fn disc(image: &mut RgbaImage, centre: DVec2, radius: f64, ink: Ink) {
    let margin = DVec2::splat(radius + 1.0);
    over(image, centre - margin, centre + margin, ink, |point| radius + 0.5 - point.distance(centre));
}

/// A circle.
pub fn ring(image: &mut RgbaImage, centre: DVec2, radius: f64, width: f64, ink: Ink) {
    let margin = DVec2::splat(radius + width + 1.0);
    over(image, centre - margin, centre + margin, ink, |point| {
        width / 2.0 + 0.5 - (point.distance(centre) - radius).abs()
    });
}

/// The mark of a centre of mass: a disc in four quarters.
pub fn quartered(image: &mut RgbaImage, centre: DVec2, radius: f64) {
    disc(image, centre, radius + 1.3, Ink([255, 255, 255], 0.9));
    disc(image, centre, radius, Ink([20, 22, 26], 1.0));
    let margin = DVec2::splat(radius);
    over(image, centre - margin, centre + margin, Ink([255, 214, 64], 1.0), |point| {
        let off = point - centre;
        let inside = radius - 0.7 + 0.5 - off.length();
        let quarter = (off.x * off.y).signum() * off.x.abs().min(off.y.abs()) + 0.5;
        inside.clamp(0.0, 1.0) * quarter.clamp(0.0, 1.0)
    });
}

/// A filled convex polygon, corners in either order.
pub fn polygon(image: &mut RgbaImage, corners: &[DVec2], ink: Ink) {
    if corners.len() < 3 {
        return;
    }
    let turn: f64 = (0..corners.len()).map(|at| corners[at].perp_dot(corners[(at + 1) % corners.len()])).sum();
    let sign = if turn < 0.0 { -1.0 } else { 1.0 };
    let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    over(image, low - 1.0, high + 1.0, ink, |point| {
        let edges = (0..corners.len()).map(|at| {
            let (from, to) = (corners[at], corners[(at + 1) % corners.len()]);
            let side = (to - from).normalize_or_zero();
            if side == DVec2::ZERO { f64::INFINITY } else { sign * side.perp_dot(point - from) + 0.5 }
        });
        edges.fold(f64::INFINITY, f64::min)
    });
}

/// A closed outline.
pub fn outline(image: &mut RgbaImage, corners: &[DVec2], width: f64, ink: Ink) {
    for at in 0..corners.len() {
        line(image, corners[at], corners[(at + 1) % corners.len()], width, ink);
    }
}

/// A flat arrow.
pub fn arrow(image: &mut RgbaImage, from: DVec2, to: DVec2, width: f64, ink: Ink) {
    let length = from.distance(to);
    let along = (to - from).normalize_or_zero();
    let head = (width * 3.2).min(length);
    let neck = to - along * head;
    if length > head {
        line(image, from, neck, width, ink);
    }
    let side = along.perp() * head * 0.52;
    polygon(image, &[to, neck + side, neck - side], ink);
}

/// A filled box with round corners.
pub fn panel(image: &mut RgbaImage, low: DVec2, high: DVec2, radius: f64, ink: Ink) {
    let centre = (low + high) / 2.0;
    let half = (high - low) / 2.0 - radius;
    over(image, low - 1.0, high + 1.0, ink, |point| {
        let off = (point - centre).abs() - half;
        let outside = off.max(DVec2::ZERO).length() + off.max_element().min(0.0);
        radius + 0.5 - outside
    });
}
