//! What a picture is drawn from: plain, owned and comparable, so that one that did not change is not drawn again.
//!
//! Floats as the shader takes them, metres relative to the frame's origin: whole metres near the target, so that a character
//! that has walked far is as sharp as at the start.

use super::camera::Camera;
use super::colors::Colors;
use crate::model::props::{PropKey, Shape};
use crate::picture::NodeTransforms;
use crate::rig::Rig;
use glam::dcamera::rh;
use glam::{DAffine3, DMat4, DVec3};
use std::sync::Arc;

/// How a mesh is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Lit, with the material's picture where it has one.
    Solid,
    /// Lit, with the ground's squares.
    Ground,
    /// Shines through and throws no shadow.
    Ghost,
}

/// Floats of a matrix: three rows of four.
pub(super) const MATRIX: usize = 12;
/// Floats of a loose vertex: place, normal, RGBA.
pub(super) const LOOSE: usize = 10;
/// m, how far around the characters things throw shadows.
const SHADOW_REACH: f64 = 5.0;
/// How dark a shadow on the ground is.
const SHADOW_DARK: f32 = 0.62;
/// m, the flat ground lies so much lower: what lies on it is seen.
const GROUND_DROP: f64 = 0.004;

/// A picture to draw.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    /// px.
    pub(super) size: [u32; 2],
    /// The shader's `Scene`.
    pub(super) scene: Vec<f32>,
    /// The ground without an end.
    pub(super) flat: bool,
    /// All matrices.
    pub(super) matrices: Vec<f32>,
    /// Meshes.
    pub(super) drawn: Vec<Drawn>,
    /// Lit triangles, [`LOOSE`] floats a corner, which throw shadows.
    pub(super) solid: Vec<f32>,
    /// Lit triangles that throw none.
    pub(super) arrows: Vec<f32>,
    /// Flat triangles on the ground, drawn in their order.
    pub(super) decals: Vec<f32>,
    /// Lit triangles that shine through.
    pub(super) pale: Vec<f32>,
}

/// A mesh of it.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) source: Source,
    /// Its first matrix.
    pub(super) first: u32,
    pub(super) kind: Kind,
    /// Linear RGBA, times the material's.
    pub(super) color: [f32; 4],
    /// Linear RGB and its share.
    pub(super) tint: [f32; 4],
}

/// Where its triangles come from.
#[derive(Clone, Debug)]
pub(super) enum Source {
    Rig(Arc<Rig>),
    Shape(Arc<Shape>),
}

impl Source {
    /// One number for one object, as long as it lives.
    pub(super) fn key(&self) -> usize {
        match self {
            Source::Rig(rig) => Arc::as_ptr(rig) as usize,
            Source::Shape(shape) => Arc::as_ptr(shape) as usize,
        }
    }

    /// Does anyone else still have it?
    pub(super) fn is_shared(&self) -> bool {
        match self {
            Source::Rig(rig) => Arc::strong_count(rig) > 1,
            Source::Shape(shape) => Arc::strong_count(shape) > 1,
        }
    }
}

impl PartialEq for Drawn {
    fn eq(&self, other: &Drawn) -> bool {
        let all = |drawn: &Drawn| (drawn.source.key(), drawn.first, drawn.kind, drawn.color, drawn.tint);
        all(self) == all(other)
    }
}

/// The lamp, and what of space its shadows are drawn for.
struct Lamp {
    toward: DVec3,
    light_from_world: DMat4,
    texel: f64,
    /// m, half of what the map shows across, and of its depth.
    radius: f64,
    deep: f64,
    /// m, (x, z) from and to where shadows fall on the flat ground.
    reach: [f64; 4],
}

impl Frame {
    /// An empty one: sky and ground. `characters`: m, what throws shadows, as balls; `foot`: m, where the character stands
    /// that no ground may hide.
    pub(super) fn new(
        camera: &Camera,
        size: [u32; 2],
        colors: &Colors,
        flat: bool,
        (characters, foot): (&[(DVec3, f64)], Option<DVec3>),
    ) -> (Frame, DVec3) {
        let origin = camera.target().round() * DVec3::new(1.0, 0.0, 1.0);
        let across = f64::from(size[0]) / f64::from(size[1].max(1));
        let lamp = lamp(characters, origin, camera);
        let fades = 1.3 * camera.distance + 4.0;
        let [right, up, ahead] = camera.rays(across);
        let mut scene = Vec::with_capacity(96);
        for matrix in [camera.clip_from_world(origin, across), lamp.light_from_world] {
            scene.extend(matrix.to_cols_array().map(|value| value as f32));
        }
        let mut four = |point: DVec3, last: f64| scene.extend(point.extend(last).to_array().map(|value| value as f32));
        four(camera.eye() - origin, fades);
        four(lamp.toward, lamp.texel);
        four(right, f64::from(SHADOW_DARK));
        four(up, 0.0);
        four(ahead, -GROUND_DROP);
        for color in colors.scene() {
            scene.extend([color[0], color[1], color[2], 0.0]);
        }
        scene.extend(lamp.reach.map(|value| value as f32));
        let (foot, cuts) = foot.map_or((DVec3::ZERO, 0.0), |foot| (foot - origin, 1.0));
        scene.extend(foot.extend(cuts).to_array().map(|value| value as f32));
        scene.extend([0.5 / lamp.radius, 0.5 / lamp.deep, 0.0, 0.0].map(|value| value as f32));
        let frame = Frame {
            size,
            scene,
            flat: flat && camera.eye().y > 0.0,
            matrices: Vec::new(),
            drawn: Vec::new(),
            solid: Vec::new(),
            arrows: Vec::new(),
            decals: Vec::new(),
            pale: Vec::new(),
        };
        (frame, origin)
    }

    /// Adds a rig in a pose.
    pub(super) fn rig(&mut self, rig: &Arc<Rig>, pose: &NodeTransforms, origin: DVec3, ghost: Option<[f32; 3]>) {
        let first = self.matrix_count();
        self.matrices.reserve(pose.len() * MATRIX);
        for transform in pose {
            self.matrix(transform, origin);
        }
        let tint = ghost.map_or([0.0; 4], |[red, green, blue]| [red, green, blue, 0.65]);
        self.drawn.push(Drawn {
            source: Source::Rig(rig.clone()),
            first,
            kind: if ghost.is_some() { Kind::Ghost } else { Kind::Solid },
            color: [1.0; 4],
            tint,
        });
    }

    /// Adds a thing.
    pub(super) fn thing(&mut self, shape: &Arc<Shape>, at: &PropKey, color: [f32; 3], ground: bool, origin: DVec3) {
        let first = self.matrix_count();
        self.matrix(&DAffine3::from_scale_rotation_translation(at.scale, at.rotation, at.translation), origin);
        self.drawn.push(Drawn {
            source: Source::Shape(shape.clone()),
            first,
            kind: if ground { Kind::Ground } else { Kind::Solid },
            color: [color[0], color[1], color[2], 1.0],
            tint: [0.0; 4],
        });
    }

    fn matrix_count(&self) -> u32 {
        (self.matrices.len() / MATRIX) as u32
    }

    fn matrix(&mut self, transform: &DAffine3, origin: DVec3) {
        let at = transform.translation - origin;
        let rows = transform.matrix3.transpose();
        for (row, at) in [(rows.x_axis, at.x), (rows.y_axis, at.y), (rows.z_axis, at.z)] {
            self.matrices.extend([row.x as f32, row.y as f32, row.z as f32, at as f32]);
        }
    }
}

/// A lamp over the viewer's first place; its shadows reach around the characters, on whole texels so that they do not swim.
fn lamp(characters: &[(DVec3, f64)], origin: DVec3, camera: &Camera) -> Lamp {
    let toward = DVec3::new(-0.28, 1.35, 0.62).normalize();
    let near = camera.target();
    let near: Vec<&(DVec3, f64)> =
        characters.iter().filter(|(at, _)| at.is_finite() && at.distance(near) < 4.0 * SHADOW_REACH).collect();
    let low = near.iter().fold(DVec3::INFINITY, |low, (at, radius)| low.min(*at - *radius));
    let high = near.iter().fold(DVec3::NEG_INFINITY, |high, (at, radius)| high.max(*at + *radius));
    let (middle, radius) = match (low + high).is_finite() {
        true => ((low + high) * 0.5, ((high - low).max_element() * 0.5).clamp(0.5, SHADOW_REACH)),
        false => (camera.target(), 1.5),
    };
    let radius = (radius * 4.0).ceil() / 4.0;
    let texel = 2.0 * radius / 1024.0;
    let turn = rh::view::look_to_mat4(DVec3::ZERO, -toward, DVec3::Z);
    let seen = turn.transform_point3(middle);
    let snapped = DVec3::new((seen.x / texel).round() * texel, (seen.y / texel).round() * texel, seen.z);
    let view = DMat4::from_translation(-snapped) * turn * DMat4::from_translation(origin);
    let deep = radius + 3.0;
    // From the top of the ball down the light to the ground.
    let fall = (middle.y + radius).max(0.0) / toward.y;
    let ends = [middle - origin, middle - origin - toward * fall];
    let low = ends[0].min(ends[1]) - radius - 0.1;
    let high = ends[0].max(ends[1]) + radius + 0.1;
    Lamp {
        toward,
        light_from_world: rh::proj::directx::orthographic(-radius, radius, -radius, radius, -deep, deep) * view,
        texel,
        radius,
        deep,
        reach: [low.x, low.z, high.x, high.z],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_scene_is_the_same_picture_and_far_away_it_has_the_same_matrices() {
        let camera = Camera::default();
        let colors = Colors::of(true);
        let make = |camera: &Camera, at: DVec3| {
            let (mut frame, origin) = Frame::new(camera, [64, 48], &colors, true, (&[(at + DVec3::Y, 1.0)], None));
            frame.matrix(&DAffine3::from_translation(at), origin);
            frame
        };
        assert_eq!(make(&camera, DVec3::ZERO), make(&camera, DVec3::ZERO));
        let mut far = camera;
        far.jump(DVec3::new(1000.0, 0.0, -500.0));
        let (near, far) = (make(&camera, DVec3::X * 0.25), make(&far, DVec3::new(1000.25, 0.0, -500.0)));
        assert_eq!(near.matrices, far.matrices);
    }
}
