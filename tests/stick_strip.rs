//! Stick figures of captures under each other, for eyes: from the side in rows, the feet's ways from above at the bottom.

#![allow(dead_code)] // a bench and a test use their part

use glam::{DVec2, DVec3};
use image::{Rgba, RgbaImage};
use surefoot::model::{Capture, Side};

const ROW: u32 = 260;
const STEP: u32 = 95;
const SCALE: f64 = 125.0; // pixels a metre

/// Rows of captures between two frames, one figure every `every` frames; below, the ways of both ankles and the pelvis from above.
pub fn strip(rows: &[&Capture], span: (usize, usize), every: usize, front: bool) -> RgbaImage {
    let last = rows.iter().map(|capture| capture.frames() - 1).min().unwrap_or(0).min(span.1);
    let frames: Vec<usize> = (span.0..=last).step_by(every.max(1)).collect();
    let width = STEP * frames.len() as u32 + 60;
    let mut image = RgbaImage::from_pixel(width.max(700), (ROW + 170) * rows.len() as u32, Rgba([255, 255, 255, 255]));
    let first = rows[0];
    let way = first.at(last)[0] - first.at(span.0)[0];
    let ahead = DVec3::new(way.x, 0.0, way.z).normalize_or(DVec3::Z);
    let aside = DVec3::new(ahead.z, 0.0, -ahead.x);
    let across = if front { aside } else { ahead };
    let floor =
        (span.0..=last).flat_map(|frame| rows[0].at(frame).iter().map(|place| place.y)).fold(f64::MAX, f64::min);
    for (row, capture) in rows.iter().enumerate() {
        let base = f64::from((ROW + 170) * row as u32 + ROW - 12);
        line(&mut image, DVec2::new(0.0, base), DVec2::new(f64::from(width), base), Rgba([200, 200, 200, 255]));
        for (index, frame) in frames.iter().enumerate() {
            let middle = f64::from(STEP * index as u32 + STEP / 2 + 20);
            let origin = first.at(*frame)[0];
            let at = |place: DVec3| {
                DVec2::new(middle + across.dot(place - origin) * SCALE, base - (place.y - floor) * SCALE)
            };
            figure(&mut image, capture, *frame, &at);
        }
        let top = f64::from((ROW + 170) * row as u32 + ROW + 80);
        let length = (first.at(last)[0] - first.at(span.0)[0]).dot(ahead).abs().max(0.5);
        let scale = (f64::from(image.width()) - 80.0) / (length + 0.8);
        let scale = scale.min(150.0);
        let start = first.at(span.0)[0];
        let above = |place: DVec3| {
            DVec2::new(50.0 + (ahead.dot(place - start) + 0.3) * scale, top + aside.dot(place - start) * scale)
        };
        for frame in span.0..last {
            line(&mut image, above(capture.at(frame)[0]), above(capture.at(frame + 1)[0]), Rgba([120, 120, 120, 255]));
            for side in Side::BOTH {
                let ankle = capture.body.feet[side as usize].ankle;
                let (a, b) = (above(capture.at(frame)[ankle]), above(capture.at(frame + 1)[ankle]));
                line(&mut image, a, b, ink(side));
                dot(&mut image, a, ink(side));
            }
        }
    }
    image
}

fn ink(side: Side) -> Rgba<u8> {
    if side == Side::Left { Rgba([200, 40, 40, 255]) } else { Rgba([30, 80, 200, 255]) }
}

fn figure(image: &mut RgbaImage, capture: &Capture, frame: usize, at: &dyn Fn(DVec3) -> DVec2) {
    let places = capture.at(frame);
    for (joint, parent) in capture.body.joints.iter().enumerate().filter_map(|(j, joint)| Some((j, joint.parent?))) {
        let name = capture.body.joints[joint].role.name();
        let leg = name.contains("Leg") || name.contains("Foot") || name.contains("Toes");
        let ink = match (leg, name.starts_with("left")) {
            (true, true) => ink(Side::Left),
            (true, false) => ink(Side::Right),
            _ => Rgba([90, 90, 90, 255]),
        };
        line(image, at(places[parent]), at(places[joint]), ink);
    }
}

fn dot(image: &mut RgbaImage, at: DVec2, ink: Rgba<u8>) {
    for (x, y) in [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.0, 0.0)] {
        put(image, at + DVec2::new(x, y), ink);
    }
}

fn line(image: &mut RgbaImage, from: DVec2, to: DVec2, ink: Rgba<u8>) {
    let steps = (from.distance(to).ceil() as usize).clamp(1, 4000);
    for step in 0..=steps {
        let place = from.lerp(to, step as f64 / steps as f64);
        put(image, place, ink);
        put(image, place + DVec2::new(0.0, 1.0), ink);
    }
}

fn put(image: &mut RgbaImage, at: DVec2, ink: Rgba<u8>) {
    if at.x >= 0.0 && at.y >= 0.0 && at.x < f64::from(image.width()) && at.y < f64::from(image.height()) {
        image.put_pixel(at.x as u32, at.y as u32, ink);
    }
}
