//! How a foot lies at rest: which way it points, whether it lies flat, and the turn that lays its toes flat.
//!
//! Metres; offsets from the ankle joint in scenario axes. Lengths are along the foot and to its left. It leaves out where
//! the sole ends: that is [`super::sole`]'s.

use super::sole::FootInput;
use super::sole_plane::resting_normal;
use crate::maths::real;
use glam::{DQuat, DVec2, DVec3};

/// Toes whose soles are off level by less than this are taken as level, rad: they curve up in front (toe spring).
const TOE_LEVEL_WITHIN: f64 = 12.0 * std::f64::consts::PI / 180.0;
/// Vertices this close to the lowest, share of the height, are on the ground with it (4 mm for 1.7 m).
const FLAT_BAND: f64 = 0.0025;

/// Whether a good part of the foot's length and width is already on the lowest level: blocks and spheres for feet have faces
/// under their middle that are no soles.
pub(super) fn lies_flat(input: &FootInput, rear: &[DVec3], all: &[DVec3]) -> bool {
    let forward = heading(input, all, DQuat::IDENTITY);
    let size = |points: &[DVec3]| {
        let one = |measure: fn(DVec3, DVec2) -> f64| {
            extent(points.iter().map(|point| measure(*point, forward))).map_or(0.0, |(low, high)| high - low)
        };
        (one(along), one(aside))
    };
    let Some((lowest, _)) = extent(rear.iter().map(|point| point.y)) else { return true };
    let touching: Vec<DVec3> =
        rear.iter().copied().filter(|point| point.y < lowest + FLAT_BAND * input.height).collect();
    let ((length, width), (whole_length, whole_width)) = (size(&touching), size(rear));
    length > 0.5 * whole_length && width > 0.3 * whole_width
}

/// Along the foot, from the ankle.
pub(super) fn along(point: DVec3, forward: DVec2) -> f64 {
    DVec2::new(point.x, point.z).dot(forward)
}

/// To the foot's left.
pub(super) fn aside(point: DVec3, forward: DVec2) -> f64 {
    DVec2::new(point.x, point.z).dot(across(forward))
}

/// To the left of a heading, (x, z).
pub(super) fn across(forward: DVec2) -> DVec2 {
    DVec2::new(forward.y, -forward.x)
}

pub(super) fn angle_of(turn: DQuat) -> f64 {
    2.0 * real::atan2(turn.xyz().length(), turn.w.abs())
}

pub(super) fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let mut range: Option<(f64, f64)> = None;
    for value in values {
        range = Some(range.map_or((value, value), |(low, high)| (low.min(value), high.max(value))));
    }
    range
}

/// The ball line: the toe joint where there is one, else 0.72 of the sole.
pub(super) fn ball_line(input: &FootInput, level: DQuat, forward: DVec2, heel: f64, tip: f64) -> f64 {
    let proportion = heel + 0.72 * (tip - heel);
    match input.toe {
        Some((_, offset)) => along(level * offset, forward).clamp(heel + 0.3 * (tip - heel), tip),
        None => proportion,
    }
}

/// The way that a foot points: by its toe joint, else by its longer side.
pub(super) fn heading(input: &FootInput, points: &[DVec3], level: DQuat) -> DVec2 {
    if let Some((_, offset)) = input.toe {
        let turned = level * offset;
        let flat = DVec2::new(turned.x, turned.z);
        if flat.length() > 0.015 * input.height && flat.y > -0.3 * flat.length() {
            return flat.normalize();
        }
    }
    let count = points.len() as f64;
    let flat: Vec<DVec2> = points
        .iter()
        .map(|point| {
            let turned = level * *point;
            DVec2::new(turned.x, turned.z)
        })
        .collect();
    let mean = flat.iter().sum::<DVec2>() / count;
    let (mut xx, mut zz, mut xz) = (0.0, 0.0, 0.0);
    for point in &flat {
        let from_mean = *point - mean;
        xx += from_mean.x * from_mean.x;
        zz += from_mean.y * from_mean.y;
        xz += from_mean.x * from_mean.y;
    }
    // The long axis of the spread; near round, or far from ahead, it says nothing.
    let swing = 0.5 * real::atan2(2.0 * xz, zz - xx);
    let spread = ((zz - xx).powi(2) + 4.0 * xz * xz).sqrt() / (zz + xx).max(1e-12);
    if spread < 0.25 || swing.abs() > 0.9 { DVec2::Y } else { DVec2::new(real::sin(swing), real::cos(swing)) }
}

/// The turn that lays the toes flat: only the pitch counts, and a toe spring is left alone.
pub(super) fn toe_turn(points: &[DVec3], level: DQuat, forward: DVec2) -> DQuat {
    let pitch_of = |turn: DQuat| -> f64 {
        let turned: Vec<DVec3> = points.iter().map(|point| turn * *point).collect();
        let (Some((near, far)), Some((left, right))) = (
            extent(turned.iter().map(|point| along(*point, forward))),
            extent(turned.iter().map(|point| aside(*point, forward))),
        ) else {
            return 0.0;
        };
        let middle = forward * (near + 0.4 * (far - near)) + across(forward) * ((left + right) / 2.0);
        let normal = resting_normal(&turned, middle);
        // Positive where the toes point up.
        real::atan2(-along(normal, forward), normal.y)
    };
    let pitch = pitch_of(level);
    if pitch.abs() < TOE_LEVEL_WITHIN {
        return level;
    }
    if level != DQuat::IDENTITY && pitch_of(DQuat::IDENTITY).abs() < TOE_LEVEL_WITHIN {
        // A lifted heel over toes that lie flat.
        return DQuat::IDENTITY;
    }
    let axis = across(forward);
    DQuat::from_axis_angle(DVec3::new(axis.x, 0.0, axis.y), pitch) * level
}
