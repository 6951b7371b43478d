//! A clean jointed figure made of capsules, for bodies without a mesh and for looking at poses alone.
//!
//! Scenario space, metres. Thickness follows the body's height; left limbs are blue, right limbs green, as the contacts
//! are, so that a side view tells them apart.

use super::raster::{Surface, to_linear};
use crate::maths::real;
use crate::model::{Body, BodyPose, Role, Side};
use glam::{DQuat, DVec2, DVec3};
use std::borrow::Cow;

/// sRGB of what belongs to a side: soles and limbs.
pub fn side_color(side: Side) -> [u8; 3] {
    match side {
        Side::Left => [36, 104, 232],
        Side::Right => [12, 148, 84],
    }
}

/// sRGB bytes as linear light.
pub fn linear(color: [u8; 3]) -> [f32; 3] {
    color.map(to_linear)
}

/// The body as capsules in that pose.
pub fn figure(body: &Body, pose: &BodyPose) -> Vec<Surface<'static>> {
    let positions = pose.positions(body);
    if positions.iter().any(|point| !point.is_finite()) || pose.turns.len() != body.joints.len() {
        return Vec::new();
    }
    let unit = body.height.clamp(0.2, 4.0);
    let mut surfaces = Vec::new();
    let at = |role: Role| body.joint(role).map(|joint| (positions[joint], pose.turns[joint]));
    // The nearest joint of a list that this body has.
    let first = |roles: &[Role]| roles.iter().find_map(|role| at(*role));
    let trunk = linear([226, 218, 206]);
    for side in Side::BOTH {
        let left = side == Side::Left;
        let own = |role: Role| if left { role } else { role.mirrored() };
        let color = linear(side_color(side).map(|channel| (u16::from(channel) * 3 / 5 + 86) as u8));
        let mut limb = |from: Role, to: Role, start: f64, end: f64| {
            if let (Some((a, turn)), Some((b, _))) = (at(own(from)), at(own(to))) {
                surfaces.push(capsule(a, b, turn, [start * unit, end * unit], 1.0, color));
            }
        };
        limb(Role::LeftUpperLeg, Role::LeftLowerLeg, 0.046, 0.032);
        limb(Role::LeftLowerLeg, Role::LeftFoot, 0.031, 0.021);
        limb(Role::LeftUpperArm, Role::LeftLowerArm, 0.027, 0.021);
        limb(Role::LeftLowerArm, Role::LeftHand, 0.021, 0.015);
        if let (Some((shoulder, turn)), Some((chest, _))) =
            (at(own(Role::LeftUpperArm)), first(&[own(Role::LeftShoulder), Role::UpperChest, Role::Chest, Role::Spine]))
        {
            surfaces.push(capsule(chest, shoulder, turn, [0.022 * unit, 0.028 * unit], 1.0, trunk));
        }
        if let (Some((hand, turn)), Some((elbow, _))) = (at(own(Role::LeftHand)), at(own(Role::LeftLowerArm))) {
            let along = (hand - elbow).normalize_or(DVec3::NEG_Y);
            let rest = body.joint(own(Role::LeftHand)).zip(body.joint(own(Role::LeftLowerArm)));
            let along = rest.map_or(along, |(hand, elbow)| {
                turn * (body.joints[hand].rest - body.joints[elbow].rest).normalize_or(DVec3::NEG_Y)
            });
            surfaces.push(capsule(hand, hand + along * 0.065 * unit, turn, [0.018 * unit, 0.013 * unit], 1.4, color));
        }
        surfaces.extend(foot(body, pose, &positions, side, color));
    }
    if let (Some((left, turn)), Some((right, _))) = (at(Role::LeftUpperLeg), at(Role::RightUpperLeg)) {
        surfaces.push(capsule(left, right, turn, [0.05 * unit; 2], 1.0, trunk));
        let shoulders = at(Role::LeftUpperArm).zip(at(Role::RightUpperArm));
        let middle = (left + right) / 2.0;
        if let Some((top, chest_turn)) = first(&[Role::UpperChest, Role::Chest, Role::Spine]) {
            let neck = first(&[Role::Neck, Role::Head]).map_or(top, |(neck, _)| neck);
            let width = shoulders.map_or(0.1 * unit, |((a, _), (b, _))| a.distance(b) / 2.0);
            let spine = first(&[Role::Spine, Role::Chest]).map_or(top, |(spine, _)| spine);
            let spine_turn = first(&[Role::Spine, Role::Chest]).map_or(turn, |(_, turn)| turn);
            let wide = (width * 0.62 / (0.055 * unit)).clamp(1.0, 2.4);
            surfaces.push(capsule(middle, spine, turn, [0.056 * unit, 0.052 * unit], 1.5, trunk));
            let high = neck.lerp(top, 0.45);
            surfaces.push(capsule(
                spine,
                high,
                spine_turn.slerp(chest_turn, 0.6),
                [0.052 * unit, 0.058 * unit],
                wide,
                trunk,
            ));
        }
    }
    if let Some((head, turn)) = at(Role::Head) {
        let rest = body.joint(Role::Head).map_or(0.88 * unit, |joint| body.joints[joint].rest.y);
        let tall = (body.height - rest).clamp(0.06 * unit, 0.3 * unit);
        if let Some((neck, neck_turn)) = first(&[Role::Neck, Role::UpperChest, Role::Chest]) {
            surfaces.push(capsule(neck, head, neck_turn, [0.03 * unit, 0.027 * unit], 1.0, trunk));
        }
        let crown = |up: f64, ahead: f64| head + turn * DVec3::new(0.0, up * tall, ahead * unit);
        surfaces.push(capsule(crown(0.38, 0.008), crown(0.62, 0.008), turn, [0.042 * unit, 0.047 * unit], 0.86, trunk));
        let nose = linear([150, 120, 96]);
        surfaces.push(capsule(crown(0.42, 0.05), crown(0.36, 0.062), turn, [0.007 * unit, 0.011 * unit], 1.0, nose));
    }
    surfaces
}

/// A tapered capsule from `a` to `b` with radii; `wide` stretches it along the turned X axis.
pub fn capsule(a: DVec3, b: DVec3, turn: DQuat, radii: [f64; 2], wide: f64, color: [f32; 3]) -> Surface<'static> {
    const ROUND: usize = 14;
    const CAP: usize = 4;
    let axis = (b - a).normalize_or(turn * DVec3::Y);
    let across = turn * DVec3::X;
    let across = (across - axis * across.dot(axis)).normalize_or(axis.any_orthonormal_vector());
    let depth = axis.cross(across);
    let mut surface = Surface { color, ..Surface::default() };
    for ring in 0..2 * CAP {
        // From pole to pole: the first half caps `a`, the second `b`.
        let end = ring / CAP;
        let lift = if end == 0 { ring as f64 / CAP as f64 - 1.0 } else { (ring - CAP + 1) as f64 / CAP as f64 };
        let angle = (lift + if end == 0 { 1.0 / CAP as f64 } else { -1.0 / CAP as f64 }) * std::f64::consts::FRAC_PI_2;
        let (sin, cos) = real::sin_cos(angle);
        let (sin, cos) = if ring == 0 || ring == 2 * CAP - 1 { (sin.signum(), 0.0) } else { (sin, cos) };
        let centre = if end == 0 { a } else { b };
        for step in 0..ROUND {
            let (s, c) = real::sin_cos(std::f64::consts::TAU * step as f64 / ROUND as f64);
            let out = across * (c * wide) + depth * s;
            surface.positions.push(centre + (out * cos + axis * sin) * radii[end]);
            let normal = (across * (c / wide) + depth * s).normalize_or(depth) * cos + axis * sin;
            surface.normals.push(normal.normalize_or(axis));
        }
    }
    let mut indices = Vec::with_capacity((2 * CAP - 1) * ROUND * 6);
    for ring in 0..(2 * CAP - 1) as u32 {
        for step in 0..ROUND as u32 {
            let next = (step + 1) % ROUND as u32;
            let [a, b] = [ring * ROUND as u32 + step, ring * ROUND as u32 + next];
            let [c, d] = [a + ROUND as u32, b + ROUND as u32];
            indices.extend([a, b, d, a, d, c]);
        }
    }
    surface.indices = Cow::Owned(indices);
    surface
}

/// A shaft and a cone that ends in `tip`.
pub fn arrow(tail: DVec3, tip: DVec3, radius: f64, color: [f32; 3]) -> Surface<'static> {
    const ROUND: u32 = 16;
    let axis = (tip - tail).normalize_or(DVec3::X);
    let across = axis.any_orthonormal_vector();
    let depth = axis.cross(across);
    let head = (radius * 5.0).min(tail.distance(tip));
    let neck = tip - axis * head;
    let mut surface = Surface { color, ..Surface::default() };
    let mut ring = |centre: DVec3, radius: f64, lean: f64| {
        for step in 0..ROUND {
            let (s, c) = real::sin_cos(std::f64::consts::TAU * f64::from(step) / f64::from(ROUND));
            let out = across * c + depth * s;
            surface.positions.push(centre + out * radius);
            surface.normals.push((out * (1.0 - lean.abs()) + axis * lean).normalize_or(axis));
        }
    };
    ring(tail, 0.0, -1.0);
    ring(tail, radius, -1.0);
    ring(tail, radius, 0.0);
    ring(neck, radius, 0.0);
    ring(neck, radius, -1.0);
    ring(neck, radius * 2.5, -1.0);
    ring(neck, radius * 2.5, 0.35);
    ring(tip, 0.0, 0.35);
    let mut indices = Vec::new();
    for ring in 0..7 {
        for step in 0..ROUND {
            let next = (step + 1) % ROUND;
            let (a, b) = (ring * ROUND + step, ring * ROUND + next);
            indices.extend([a, b, b + ROUND, a, b + ROUND, a + ROUND]);
        }
    }
    surface.indices = Cow::Owned(indices);
    surface
}

/// The foot as two wedges on its sole: behind the ball with the ankle, ahead of it with the toes.
fn foot(body: &Body, pose: &BodyPose, positions: &[DVec3], side: Side, color: [f32; 3]) -> Vec<Surface<'static>> {
    let shape = &body.feet[side as usize];
    let Some(ankle) = positions.get(shape.ankle).copied() else { return Vec::new() };
    let forward = DVec3::new(shape.forward.x, 0.0, shape.forward.y);
    let across = DVec3::Y.cross(forward);
    let place =
        |along: f64, out: f64, height: f64| forward * along + across * out + DVec3::Y * (height - shape.ankle_height);
    let ankle_turn = pose.turns[shape.ankle];
    let posed = |levelled: DVec3, toes: bool| {
        // A hair's breadth decides on which side of the ball line a corner lies: the wedge says so.
        let nudge = forward * if toes { 1e-6 } else { -1e-6 };
        let (offset, by_toe) = unlevelled(body, side, levelled + nudge);
        match shape.toe.filter(|_| by_toe) {
            Some(toe) => {
                positions[toe] + pose.turns[toe] * (offset - (body.joints[toe].rest - body.joints[shape.ankle].rest))
            }
            None => ankle + ankle_turn * offset,
        }
    };
    let rear = |levelled: DVec3| posed(levelled, false);
    let front = |levelled: DVec3| posed(levelled, true);
    let half = shape.half_width;
    let (heel, ball, tip) = (shape.heel, shape.ball, shape.tip);
    let high = shape.ankle_height;
    let wedge = |place_in: &dyn Fn(DVec3) -> DVec3, ends: [(f64, f64, f64); 3]| {
        // Bottom and top outlines as rows of left/right pairs, then joined: (along, half width, height).
        let mut surface = Surface { color, ..Surface::default() };
        for (along, width, top) in ends {
            for (out, height, squeeze) in [(1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (-1.0, 1.0, 0.7), (1.0, 1.0, 0.7)] {
                surface.positions.push(place_in(place(along, out * width * squeeze, height * top)));
            }
        }
        let mut indices = vec![0u32, 1, 2, 0, 2, 3, 8, 9, 10, 8, 10, 11];
        for row in 0..2 {
            for edge in 0..4 {
                let (a, b) = (row * 4 + edge, row * 4 + (edge + 1) % 4);
                indices.extend([a, b, b + 4, a, b + 4, a + 4]);
            }
        }
        surface.indices = Cow::Owned(indices);
        surface
    };
    let middle = heel.mul_add(0.55, 0.0).min(0.0);
    let rear_wedge =
        wedge(&rear, [(heel, half * 0.62, high * 0.55), (middle, half * 0.8, high * 0.95), (ball, half, high * 0.45)]);
    let toe_middle = ball + (tip - ball) * 0.6;
    let front_wedge = wedge(
        &front,
        [(ball, half, high * 0.45), (toe_middle, half * 0.92, high * 0.34), (tip, half * 0.55, high * 0.22)],
    );
    vec![rear_wedge, front_wedge]
}

/// An outline of a part of a sole, levelled: offsets from the ankle, closed, convex.
pub fn sole_outline(body: &Body, side: Side, from: f64, to: f64) -> Vec<DVec3> {
    let shape = &body.feet[side as usize];
    let forward = DVec3::new(shape.forward.x, 0.0, shape.forward.y);
    let across = DVec3::Y.cross(forward);
    let length = (shape.tip - shape.heel).max(1e-6);
    let half = |along: f64| {
        let share = ((along - shape.heel) / length).clamp(0.0, 1.0);
        let body = 0.74 + 0.26 * (share / 0.7).min(1.0);
        // Round ends, a third of a width long.
        let end = (share.min(1.0 - share) / 0.14).min(1.0);
        shape.half_width * body * (1.0 - (1.0 - end).powi(2)).max(0.0).sqrt()
    };
    let stations = 13;
    // Denser at the ends, where it is round.
    let share = |at: usize| 0.5 - 0.5 * real::cos(std::f64::consts::PI * at as f64 / (stations - 1) as f64);
    let along = |at: usize| from + (to - from) * share(at);
    let edge = |at: usize, sign: f64| {
        let along = along(at);
        forward * along + across * (sign * half(along)) - DVec3::Y * shape.ankle_height
    };
    (0..stations).map(|at| edge(at, 1.0)).chain((0..stations).rev().map(|at| edge(at, -1.0))).collect()
}

/// Where a point of the levelled foot (offset from the ankle) lies while the body is at rest, and whether the toes carry it.
pub fn unlevelled(body: &Body, side: Side, levelled: DVec3) -> (DVec3, bool) {
    let shape = &body.feet[side as usize];
    let ahead = levelled.dot(DVec3::new(shape.forward.x, 0.0, shape.forward.y)) > shape.ball;
    let joints = shape.toe.and_then(|toe| body.joints.get(toe)).zip(body.joints.get(shape.ankle));
    match joints.filter(|_| ahead) {
        Some((toe, ankle)) => {
            let to_toe = toe.rest - ankle.rest;
            (to_toe + shape.toe_level.inverse() * (levelled - shape.level * to_toe), true)
        }
        None => (shape.level.inverse() * levelled, false),
    }
}

/// (x, z) of a point.
pub fn flat(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}
