//! What a picture shows besides the body: soles in contact, footprints, centre of mass, ξ, centre of pressure, pushes.
//!
//! Scenario space, metres, newtons. An [`Overlay`] belongs to one moment.

use super::figure::{arrow, flat, linear, side_color, sole_outline, unlevelled};
use super::paint::{self, Ink};
use super::raster::{Camera, Canvas, Lights, Surface};
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Side};
use glam::{DVec2, DVec3};
use image::RgbaImage;

/// sRGB of the push arrows.
pub const PUSH: [u8; 3] = [222, 28, 32];
/// sRGB of ξ.
pub const XI: [u8; 3] = [206, 24, 178];
/// sRGB of the centre of pressure.
pub const COP: [u8; 3] = [255, 255, 255];

/// m; what lies further out from a pushed bone is no longer the body's surface there.
const DEEPEST: f64 = 0.28;

/// The marks of one moment.
#[derive(Clone, Debug, Default)]
pub struct Overlay {
    /// m, centre of mass.
    pub com: Option<DVec3>,
    /// m, extrapolated centre of mass on the ground, (x, z).
    pub xi: Option<DVec2>,
    /// m, centre of pressure on the ground, (x, z).
    pub cop: Option<DVec2>,
    /// What pushes now.
    pub pushes: Vec<Push>,
    /// Soles that hold the ground now.
    pub soles: Vec<SoleMark>,
    /// Where feet stood before.
    pub prints: Vec<SoleMark>,
}

/// A force on the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// m, the bone that it acts on.
    pub point: DVec3,
    /// N.
    pub force: DVec3,
}

/// A sole, or the part of it that holds.
#[derive(Clone, Debug, PartialEq)]
pub struct SoleMark {
    /// Which foot.
    pub side: Side,
    /// What of it holds.
    pub part: Part,
    /// m, convex outline of the whole sole.
    pub whole: Vec<DVec3>,
    /// m, convex outline of the part in contact.
    pub held: Vec<DVec3>,
}

impl Overlay {
    /// Centre of mass and soles of a pose, with these parts in contact.
    pub fn of_pose(body: &Body, pose: &BodyPose, contacts: &[(Side, Part)]) -> Overlay {
        let positions = pose.positions(body);
        let com = pose.centre_of_mass(body, &positions);
        let soles = contacts
            .iter()
            .map(|(side, part)| {
                let shape = &body.feet[*side as usize];
                let rear = |offset: DVec3| positions[shape.ankle] + pose.turns[shape.ankle] * offset;
                let front = |offset: DVec3| match shape.toe {
                    Some(toe) => {
                        let to_toe = body.joints[toe].rest - body.joints[shape.ankle].rest;
                        positions[toe] + pose.turns[toe] * (offset - to_toe)
                    }
                    None => rear(offset),
                };
                sole_mark(body, *side, *part, &rear, &front)
            })
            .collect();
        Overlay { com: Some(com), soles, ..Overlay::default() }
    }
}

/// The mark of a sole whose rear and front parts are placed by these maps from the offset to the ankle at rest.
pub fn sole_mark(
    body: &Body,
    side: Side,
    part: Part,
    rear: &dyn Fn(DVec3) -> DVec3,
    front: &dyn Fn(DVec3) -> DVec3,
) -> SoleMark {
    let place = |levelled: &DVec3| {
        let (offset, by_toe) = unlevelled(body, side, *levelled);
        let moved = if by_toe { front(offset) } else { rear(offset) };
        DVec3::new(moved.x, 0.0, moved.z)
    };
    placed_mark(body, side, part, &place)
}

/// The mark of a sole each of whose points, levelled and seen from the ankle, is placed by that map.
pub fn placed_mark(body: &Body, side: Side, part: Part, place: &dyn Fn(&DVec3) -> DVec3) -> SoleMark {
    let shape = &body.feet[side as usize];
    let outline = |from: f64, to: f64| sole_outline(body, side, from, to).iter().map(place).collect();
    let held = match part {
        Part::Flat => (shape.heel, shape.tip),
        Part::Ball => (shape.ball, shape.tip),
        Part::Heel => (shape.heel, shape.heel + (shape.tip - shape.heel) / 3.0),
    };
    SoleMark { side, part, whole: outline(shape.heel, shape.tip), held: outline(held.0, held.1) }
}

/// Soles and footprints, drawn on the ground before the body stands on it.
pub fn draw_ground(canvas: &mut Canvas, camera: &Camera, overlay: &Overlay) {
    for print in &overlay.prints {
        let color = linear(side_color(print.side));
        canvas.decal(camera, &print.whole, color, 0.16);
        draw_rim(canvas, camera, &print.whole, 0.0, 0.012, color, 0.40);
    }
    for sole in &overlay.soles {
        let color = linear(side_color(sole.side));
        canvas.decal(camera, &sole.held, color, 0.85);
        // The shoe hides its own print: what holds shines out around it, the rest of the sole is a thin line.
        draw_rim(canvas, camera, &sole.whole, 0.030, 0.040, color, 0.75);
        draw_rim(canvas, camera, &sole.held, 0.0, 0.040, color, 0.85);
    }
}

/// A band around an outline, from `inner` to `outer` m outside of it.
fn draw_rim(
    canvas: &mut Canvas,
    camera: &Camera,
    outline: &[DVec3],
    inner: f64,
    outer: f64,
    color: [f32; 3],
    alpha: f32,
) {
    let (low, high) = (grow(outline, inner), grow(outline, outer));
    for at in 0..outline.len() {
        let next = (at + 1) % outline.len();
        canvas.decal(camera, &[low[at], low[next], high[next], high[at]], color, alpha);
    }
}

/// The convex outline moved outwards by that many metres.
fn grow(outline: &[DVec3], by: f64) -> Vec<DVec3> {
    let count = outline.len();
    let middle = outline.iter().sum::<DVec3>() / count.max(1) as f64;
    let outward = |from: DVec3, to: DVec3| {
        let normal = DVec3::Y.cross(to - from).normalize_or_zero();
        if normal.dot((from + to) / 2.0 - middle) < 0.0 { -normal } else { normal }
    };
    (0..count)
        .map(|at| {
            let (before, here, after) = (outline[(at + count - 1) % count], outline[at], outline[(at + 1) % count]);
            here + (outward(before, here) + outward(here, after)).normalize_or_zero() * by
        })
        .collect()
}

/// How long the arrow of a force is, m.
pub fn arrow_length(force: f64) -> f64 {
    0.24 + 0.24 * (force / 300.0).min(2.0)
}

/// The tail and the tip of a push's arrow: it ends where the body's surface is met.
pub fn arrow_ends(push: &Push, surfaces: &[Surface]) -> (DVec3, DVec3) {
    let along = push.force.normalize_or(DVec3::X);
    let mut reach: f64 = 0.02;
    let deepest = DEEPEST * stature(surfaces);
    for surface in surfaces {
        for triangle in surface.indices.chunks_exact(3) {
            let corner = |at: usize| surface.positions.get(triangle[at] as usize).copied();
            let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
            if let Some(far) = meets(push.point, -along, [a, b, c]).filter(|far| *far < deepest) {
                reach = reach.max(far);
            }
        }
    }
    let tip = push.point - along * (reach + 0.01);
    (tip - along * arrow_length(push.force.length()) * stature(surfaces), tip)
}

/// How tall the body stands, to an ordinary one.
fn stature(surfaces: &[Surface]) -> f64 {
    let heights = surfaces.iter().flat_map(|surface| &surface.positions).map(|point| point.y);
    let (low, high) = heights.fold((f64::INFINITY, 0.0_f64), |(low, high), y| (low.min(y), high.max(y)));
    ((high - low.clamp(0.0, high)) / 1.75).clamp(0.4, 2.5)
}

/// How far along a ray it meets a triangle, m (Möller and Trumbore).
fn meets(from: DVec3, along: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let cross = along.cross(ac);
    let volume = ab.dot(cross);
    if volume.abs() < 1e-12 {
        return None;
    }
    let off = from - a;
    let u = off.dot(cross) / volume;
    let turn = off.cross(ab);
    let v = along.dot(turn) / volume;
    let far = ac.dot(turn) / volume;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && far > 0.0).then_some(far)
}

/// The arrows as solid things in the scene.
pub fn draw_pushes(canvas: &mut Canvas, camera: &Camera, lights: &Lights, overlay: &Overlay, surfaces: &[Surface]) {
    for push in &overlay.pushes {
        let (tail, tip) = arrow_ends(push, surfaces);
        let arrow = arrow(tail, tip, 0.024 * stature(surfaces), linear(PUSH));
        canvas.ghost(camera, &arrow, 0.55);
        canvas.surface(camera, lights, &arrow, false);
    }
}

/// Marks that stay legible: drawn flat over the finished picture, `size` times as large as on a common sheet. `floor`: how
/// high the ground is where, m.
pub fn draw_points(image: &mut RgbaImage, camera: &Camera, overlay: &Overlay, size: f64, floor: &dyn Fn(DVec2) -> f64) {
    let ground = |at: DVec2| camera.project(DVec3::new(at.x, floor(at), at.y)).map(|(point, _)| point);
    if let Some(com) = overlay.com
        && let (Some((point, _)), Some(below)) = (camera.project(com), ground(flat(com)))
    {
        paint::dashed(image, point, below, 1.2, Ink([20, 22, 26], 0.75));
        paint::disc(image, below, 1.8, Ink([20, 22, 26], 0.9));
        paint::quartered(image, point, 5.0 * size);
    }
    if let Some(point) = overlay.cop.and_then(ground) {
        paint::disc(image, point, 3.4 * size, Ink([20, 22, 26], 0.9));
        paint::disc(image, point, 2.2 * size, Ink(COP, 1.0));
    }
    if let Some(point) = overlay.xi.and_then(ground) {
        draw_xi(image, point, size);
    }
}

/// The mark of ξ: a ring with a cross.
pub fn draw_xi(image: &mut RgbaImage, point: DVec2, size: f64) {
    let (radius, arm) = (3.9 * size, 6.0 * size);
    paint::ring(image, point, radius, 3.0 * size, Ink([255, 255, 255], 0.85));
    for (from, to) in [((-1.0, 0.0), (1.0, 0.0)), ((0.0, -1.0), (0.0, 1.0))] {
        paint::line(image, point + DVec2::from(from) * arm, point + DVec2::from(to) * arm, 1.1, Ink(XI, 0.95));
    }
    paint::ring(image, point, radius, 1.6 * size, Ink(XI, 1.0));
}

/// Two small soles, the lower right corner at `corner`: filled where the foot holds, hollow in the air. Toes point down
/// and the character's right is on the left, as the front camera sees it.
pub fn draw_feet(image: &mut RgbaImage, corner: DVec2, overlay: &Overlay) {
    for side in Side::BOTH {
        let middle = corner + DVec2::new(if side == Side::Left { -6.0 } else { -18.0 }, -10.5);
        let half = DVec2::new(3.6, 9.0);
        let color = side_color(side);
        paint::panel(image, middle - half - 1.3, middle + half + 1.3, 4.8, Ink(color, 0.9));
        paint::panel(image, middle - half, middle + half, 3.6, Ink([236, 239, 241], 1.0));
        let (low, high) = match overlay.soles.iter().find(|sole| sole.side == side).map(|sole| sole.part) {
            None => continue,
            Some(Part::Flat) => (-1.0, 1.0),
            Some(Part::Ball) => (0.25, 1.0),
            Some(Part::Heel) => (-1.0, -0.35),
        };
        let (low, high) = (DVec2::new(-half.x, half.y * low), DVec2::new(half.x, half.y * high));
        paint::panel(image, middle + low, middle + high, 2.6, Ink(color, 1.0));
    }
}
