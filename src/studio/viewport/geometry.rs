//! Loose triangles of a frame: figures of capsules, arrows, and what is drawn on the ground. Scenario space in, the frame's
//! floats out.

use super::Show;
use super::colors::Colors;
use super::frame::Frame;
use super::marks::{Marks, Region};
use super::pick;
use crate::model::{Body, BodyPose};
use crate::picture::figure::{arrow, figure, flat, linear, side_color};
use crate::picture::marks::{PUSH, Push, SoleMark, arrow_length};
use crate::picture::raster::Surface;
use glam::{DVec2, DVec3};

/// m over its plane, what is drawn on the ground.
const LIFT: f64 = 0.0015;
/// m, half the width of a trail.
const TRAIL: f64 = 0.006;
/// sRGB of the regions: inner, middle, outer.
pub(super) const REGIONS: [[u8; 3]; 3] = [[28, 160, 96], [226, 160, 20], [214, 60, 40]];

/// Corners of triangles relative to an origin.
struct Pen<'a> {
    floats: &'a mut Vec<f32>,
    origin: DVec3,
}

impl Pen<'_> {
    fn corner(&mut self, at: DVec3, normal: DVec3, color: [f32; 4]) {
        let at = at - self.origin;
        self.floats.extend([at.x, at.y, at.z, normal.x, normal.y, normal.z].map(|value| value as f32));
        self.floats.extend(color);
    }

    fn surface(&mut self, surface: &Surface, alpha: f32) {
        let color = [surface.color[0], surface.color[1], surface.color[2], alpha];
        let smooth = surface.normals.len() == surface.positions.len();
        for triangle in surface.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|at| triangle[at] as usize);
            let corners = [a, b, c].map(|at| surface.positions.get(at).copied());
            let [Some(pa), Some(pb), Some(pc)] = corners else { continue };
            let face = (pb - pa).cross(pc - pa).normalize_or(DVec3::Y);
            for (at, point) in [(a, pa), (b, pb), (c, pc)] {
                self.corner(point, if smooth { surface.normals[at] } else { face }, color);
            }
        }
    }

    fn triangle(&mut self, corners: [DVec3; 3], color: [f32; 4]) {
        for corner in corners {
            self.corner(corner + DVec3::Y * LIFT, DVec3::Y, color);
        }
    }

    /// A filled outline around its middle.
    fn fill(&mut self, outline: &[DVec3], color: [f32; 3], alpha: f32) {
        let middle = outline.iter().sum::<DVec3>() / outline.len().max(1) as f64;
        for at in 0..outline.len() {
            let next = outline[(at + 1) % outline.len()];
            self.triangle([middle, outline[at], next], [color[0], color[1], color[2], alpha]);
        }
    }

    /// A band along an outline, from `inner` to `outer` m outside of it; it fades from the first alpha to the second.
    fn band(&mut self, outline: &[DVec3], [inner, outer]: [f64; 2], color: [f32; 3], alphas: [f32; 2]) {
        let (low, high) = (grown(outline, inner), grown(outline, outer));
        let [near, far] = alphas.map(|alpha| [color[0], color[1], color[2], alpha]);
        for at in 0..outline.len() {
            let next = (at + 1) % outline.len();
            let lifted = |point: DVec3| point + DVec3::Y * LIFT;
            let quad = [(low[at], near), (low[next], near), (high[next], far), (high[at], far)];
            for corner in [0, 1, 2, 0, 2, 3] {
                let (point, color) = quad[corner];
                self.corner(lifted(point), DVec3::Y, color);
            }
        }
    }

    /// A line on the ground that comes out of nothing.
    fn ribbon(&mut self, points: &[DVec3], half: f64, color: [f32; 3], alpha: f32) {
        let count = points.len();
        let side = |at: usize| {
            let along = flat(points[(at + 1).min(count - 1)] - points[at.saturating_sub(1)]).normalize_or_zero();
            DVec3::new(-along.y, 0.0, along.x) * half
        };
        for at in 1..count {
            let (a, b) = (points[at - 1], points[at]);
            let (left, right) = (side(at - 1), side(at));
            let color = [color[0], color[1], color[2], alpha * (0.25 + 0.75 * at as f32 / count as f32)];
            self.triangle([a - left, b - right, b + right], color);
            self.triangle([a - left, b + right, a + left], color);
        }
    }
}

/// The convex outline moved outwards by that many metres.
fn grown(outline: &[DVec3], by: f64) -> Vec<DVec3> {
    let count = outline.len();
    let middle = outline.iter().sum::<DVec3>() / count.max(1) as f64;
    let outward = |from: DVec3, to: DVec3| {
        let normal = DVec3::Y.cross(to - from).normalize_or_zero();
        if normal.dot((from + to) / 2.0 - middle) < 0.0 { -normal } else { normal }
    };
    let place = |at: usize| {
        let (before, here, after) = (outline[(at + count - 1) % count], outline[at], outline[(at + 1) % count]);
        here + (outward(before, here) + outward(here, after)).normalize_or_zero() * by
    };
    (0..count).map(place).collect()
}

/// Adds a figure of capsules.
pub(super) fn add_figure(frame: &mut Frame, body: &Body, pose: &BodyPose, ghost: Option<[f32; 3]>, origin: DVec3) {
    let surfaces = figure(body, pose);
    let mut pen = Pen { floats: if ghost.is_some() { &mut frame.pale } else { &mut frame.solid }, origin };
    for surface in surfaces {
        match ghost {
            Some(color) => pen.surface(&Surface { color, ..surface }, 0.42),
            None => pen.surface(&surface, 1.0),
        }
    }
}

/// Where the arrow of a push begins and ends: outside of the flesh of the bone that it acts on.
pub(super) fn arrow_ends(push: &Push, body: &Body, pose: &BodyPose, positions: &[DVec3]) -> (DVec3, DVec3) {
    let along = push.force.normalize_or(DVec3::X);
    let stature = (body.height / 1.75).clamp(0.4, 2.5);
    let reach = pick::reach(body, &pose.turns, positions, push.point, -along);
    let tip = push.point - along * (reach + 0.015);
    (tip - along * arrow_length(push.force.length()) * stature, tip)
}

/// Adds the arrows of the pushes on a body.
pub(super) fn add_arrows(
    frame: &mut Frame,
    pushes: &[Push],
    body: &Body,
    pose: &BodyPose,
    positions: &[DVec3],
    origin: DVec3,
) {
    let stature = (body.height / 1.75).clamp(0.4, 2.5);
    let mut pen = Pen { floats: &mut frame.arrows, origin };
    for push in pushes.iter().filter(|push| push.point.is_finite() && push.force.is_finite()) {
        let (tail, tip) = arrow_ends(push, body, pose, positions);
        pen.surface(&arrow(tail, tip, 0.022 * stature, linear(PUSH)), 1.0);
    }
}

/// Adds what is drawn on the ground, the lowest first.
pub(super) fn add_ground(frame: &mut Frame, marks: &Marks, show: &Show, colors: &Colors, origin: DVec3) {
    let mut pen = Pen { floats: &mut frame.decals, origin };
    if show.regions
        && let Some(regions) = &marks.regions
    {
        let [inner, middle, outer] = REGIONS.map(linear);
        let strong = |region: Region| if regions.now == region { 1.6 } else { 1.0 };
        pen.band(&regions.sway, [0.0, 0.07], outer, [0.34 * strong(Region::Step), 0.0]);
        pen.fill(&regions.sway, middle, 0.20 * strong(Region::Sway));
        pen.band(&regions.sway, [-0.004, 0.004], outer, [0.8; 2]);
        pen.fill(&circle(regions.middle, regions.inner.max(0.006)), inner, 0.9);
        pen.band(
            &circle(regions.middle, regions.inner.max(0.006)),
            [0.008, 0.012],
            inner,
            [0.5 * strong(Region::Rest); 2],
        );
    }
    if show.support {
        let ink = linear(colors.ink);
        if !(show.regions && marks.regions.is_some()) {
            pen.fill(&marks.support, ink, 0.10);
        }
        pen.band(&marks.support, [-0.003, 0.003], ink, [0.7; 2]);
    }
    if show.trail {
        pen.ribbon(&marks.trail, TRAIL, linear([250, 186, 20]), 0.9);
    }
    let tinted = |mark: &SoleMark| linear(side_color(mark.side));
    if show.footprints {
        for print in &marks.overlay.prints {
            pen.fill(&print.whole, tinted(print), 0.20);
            pen.band(&print.whole, [0.0, 0.009], tinted(print), [0.5; 2]);
        }
        for print in &marks.coming {
            pen.band(&print.whole, [-0.004, 0.005], tinted(print), [0.75; 2]);
        }
    }
    if show.contacts {
        for sole in &marks.overlay.soles {
            let color = tinted(sole);
            pen.fill(&sole.held, color, 0.85);
            pen.band(&sole.whole, [0.024, 0.032], color, [0.75; 2]);
            pen.band(&sole.held, [0.0, 0.032], color, [0.85; 2]);
        }
    }
}

fn circle(middle: DVec3, radius: f64) -> Vec<DVec3> {
    let point = |at: i32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(at) / 28.0).sin_cos();
        middle + DVec3::new(cos, 0.0, sin) * radius
    };
    (0..28).map(point).collect()
}

/// (x, z) of a corner as a point on the ground.
pub(super) fn ground(at: DVec2, height: f64) -> DVec3 {
    DVec3::new(at.x, height, at.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grown_outline_is_larger_and_a_shrunk_one_smaller() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, z)| DVec3::new(x, 0.0, z));
        let area = |outline: &[DVec3]| {
            let cross = |at: usize| flat(outline[at]).perp_dot(flat(outline[(at + 1) % outline.len()]));
            (0..outline.len()).map(cross).sum::<f64>().abs() / 2.0
        };
        assert!(area(&grown(&square, 0.1)) > 1.1 && area(&grown(&square, -0.1)) < 0.9);
        assert!(grown(&[], 0.1).is_empty());
    }
}
