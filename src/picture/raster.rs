//! A small z-buffered rasteriser on the CPU: lit, textured triangles over a checkered ground under a soft sky.
//!
//! Scenario space, metres; the picture has its origin at the top left. Light is added up in linear light, on several
//! samples a pixel, and turned into sRGB once, at the end ([`Canvas::resolve`]). Triangles with a corner behind the camera
//! are left out, not clipped: these cameras stand well away. No window, no GPU, no global state: equal input, equal bytes.

use super::ground::tiles;
use super::shadow::GroundShadow;
use crate::maths::real;
use glam::{DMat3, DVec2, DVec3, Vec3};
use image::{Rgba, RgbaImage};
use std::borrow::Cow;

/// Triangles as they stand in the scene.
#[derive(Clone, Debug, Default)]
pub struct Surface<'a> {
    /// m, scenario space.
    pub positions: Vec<DVec3>,
    /// Unit; empty for flat shading.
    pub normals: Vec<DVec3>,
    /// (vertices) or empty.
    pub uvs: Cow<'a, [DVec2]>,
    /// Three a triangle.
    pub indices: Cow<'a, [u32]>,
    /// Linear RGB base colour.
    pub color: [f32; 3],
    /// Multiplied in; its alpha cuts holes.
    pub texture: Option<&'a RgbaImage>,
}

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// m.
    pub eye: DVec3,
    /// Rows: right, up, forward; a rotation with `forward` into the picture.
    pub axes: DMat3,
    /// px a unit of tangent.
    pub focal: f64,
    /// px, where the optical axis meets the picture.
    pub centre: DVec2,
}

impl Camera {
    /// Stands at `eye` and looks at `target`, which appears at `centre`.
    pub fn looking_at(eye: DVec3, target: DVec3, focal: f64, centre: DVec2) -> Camera {
        let forward = (target - eye).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(DVec3::Y).normalize_or(DVec3::X);
        let up = right.cross(forward);
        Camera { eye, axes: DMat3::from_cols(right, up, forward).transpose(), focal, centre }
    }

    /// Where a point appears (px) and how far ahead it lies (m); `None` behind the camera.
    pub fn project(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let seen = self.axes * (point - self.eye);
        let near = seen.z > NEAR && seen.is_finite();
        near.then(|| (self.centre + DVec2::new(seen.x, -seen.y) * (self.focal / seen.z), seen.z))
    }

    /// The direction of the ray through a point of the picture; its forward part is 1.
    pub fn ray(&self, pixel: DVec2) -> DVec3 {
        let tangent = (pixel - self.centre) / self.focal;
        self.axes.transpose() * DVec3::new(tangent.x, -tangent.y, 1.0)
    }

    /// To the right of the picture, m.
    pub fn right(&self) -> DVec3 {
        self.axes.row(0)
    }

    /// Into the picture.
    pub fn forward(&self) -> DVec3 {
        self.axes.row(2)
    }
}

/// How triangles are lit: a key light over the shoulder of the viewer, sky from above, bounce from below.
#[derive(Clone, Copy, Debug)]
pub struct Lights {
    /// Unit, towards the key light.
    pub key: DVec3,
    /// Unit, towards the viewer: the rim is measured against it.
    pub view: DVec3,
    /// (key, view, halfway between them) as they are shaded with.
    shading: [Vec3; 3],
}

impl Lights {
    /// The key light stands to the left of, above and behind the viewer.
    pub fn of(camera: &Camera) -> Lights {
        let view = -camera.forward();
        let key = (view * 0.75 - camera.right() * 0.62 + DVec3::Y * 1.25).normalize();
        Lights { key, view, shading: [key, view, (key + view).normalize()].map(|light| light.as_vec3()) }
    }
}

/// A picture in the making, several samples a pixel.
pub struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Samples a pixel in each direction.
    pub(super) across: usize,
    /// Linear RGB a sample.
    pub(super) color: Vec<Vec3>,
    /// 1/m a sample: larger is nearer, 0 is the sky.
    pub(super) nearness: Vec<f32>,
    /// Whether the sample shows the body.
    body: Vec<bool>,
}

/// m; nothing nearer than this is drawn.
const NEAR: f64 = 0.05;
/// m; the drawn ground lies that much lower, so that soles on it are in front of it.
pub(super) const GROUND_DROP: f64 = 0.004;

pub(super) const SKY_HIGH: Vec3 = Vec3::new(0.60, 0.68, 0.76);
pub(super) const SKY_LOW: Vec3 = Vec3::new(0.80, 0.84, 0.87);
pub(super) const SHADOW_TINT: Vec3 = Vec3::new(0.05, 0.065, 0.09);

impl Canvas {
    /// An empty picture, in pixels, `samples` x `samples` samples each.
    pub fn new(width: usize, height: usize, samples: usize) -> Canvas {
        let across = samples.max(1);
        let samples = width * height * across * across;
        Canvas {
            width,
            height,
            across,
            color: vec![SKY_LOW; samples],
            nearness: vec![0.0; samples],
            body: vec![false; samples],
        }
    }

    /// Sky, and the ground with squares that fade towards the horizon. The squares are averaged over each pixel by formula,
    /// so one look a pixel is enough.
    pub fn background(&mut self, camera: &Camera) {
        let columns = self.width * self.across;
        let step = 1.0 / self.across as f64;
        let below = -GROUND_DROP - camera.eye.y;
        for y in 0..self.height {
            for x in 0..self.width {
                let color = backdrop(camera, DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
                for row in y * self.across..(y + 1) * self.across {
                    let first = row * columns + x * self.across;
                    // 1/depth of a plane is linear in the picture.
                    let ray = camera.ray(DVec2::new(x as f64 + 0.5, (row as f64 + 0.5) * step));
                    let nearness = (ray.y / below).max(0.0) as f32;
                    self.color[first..first + self.across].fill(color);
                    self.nearness[first..first + self.across].fill(nearness);
                }
            }
        }
    }

    /// The body's shadow on the ground and on what is painted there; before the body itself is drawn.
    pub fn shade_ground(&mut self, camera: &Camera, shadow: &GroundShadow) {
        let columns = self.width * self.across;
        let below = -camera.eye.y;
        for y in 0..self.height {
            for x in 0..self.width {
                let ray = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
                if ray.y * below <= 1e-9 {
                    continue;
                }
                let point = camera.eye + ray * (below / ray.y);
                let dark = shadow.at(point.x, point.z);
                if dark > 0.0 {
                    for row in y * self.across..(y + 1) * self.across {
                        let first = row * columns + x * self.across;
                        for color in &mut self.color[first..first + self.across] {
                            *color = color.lerp(SHADOW_TINT, dark);
                        }
                    }
                }
            }
        }
    }

    /// Lets a thing shine through what hides it.
    pub fn ghost(&mut self, camera: &Camera, surface: &Surface, alpha: f32) {
        let projected: Vec<Option<(DVec2, f64)>> =
            surface.positions.iter().map(|point| camera.project(*point)).collect();
        let mut hidden = std::collections::BTreeSet::new();
        for triangle in surface.indices.chunks_exact(3) {
            let corner = |at: usize| projected.get(triangle[at] as usize).copied().flatten();
            let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
            self.fill([a, b, c], |canvas, sample, nearness, _| {
                if nearness <= canvas.nearness[sample] {
                    hidden.insert(sample);
                }
            });
        }
        for sample in hidden {
            self.color[sample] = self.color[sample].lerp(Vec3::from(surface.color), alpha);
        }
    }

    /// A polygon that lies on the ground (convex, m), blended in; what stands before it hides it.
    pub fn decal(&mut self, camera: &Camera, outline: &[DVec3], color: [f32; 3], alpha: f32) {
        let corners: Option<Vec<_>> = outline.iter().map(|point| camera.project(*point + DVec3::Y * 0.001)).collect();
        let Some(corners) = corners else { return };
        for corner in 2..corners.len() {
            let triangle = [corners[0], corners[corner - 1], corners[corner]];
            self.fill(triangle, |canvas, sample, nearness, _| {
                if nearness > canvas.nearness[sample] * 0.999 {
                    canvas.color[sample] = canvas.color[sample].lerp(Vec3::from(color), alpha);
                }
            });
        }
    }

    /// Lit triangles. `body` marks them for the outline that [`Canvas::ink`] draws.
    pub fn surface(&mut self, camera: &Camera, lights: &Lights, surface: &Surface, body: bool) {
        let projected: Vec<Option<(DVec2, f64)>> =
            surface.positions.iter().map(|point| camera.project(*point)).collect();
        let smooth = surface.normals.len() == surface.positions.len();
        let texture = surface.texture.filter(|_| surface.uvs.len() == surface.positions.len());
        // What faces the camera first: most of the rest is then hidden and need not be lit.
        let triangles = || surface.indices.chunks_exact(3);
        let passes = triangles().map(|triangle| (triangle, false)).chain(triangles().map(|triangle| (triangle, true)));
        for (triangle, second) in passes {
            let [a, b, c] = [triangle[0] as usize, triangle[1] as usize, triangle[2] as usize];
            let corner = |index: usize| projected.get(index).copied().flatten();
            let (Some(pa), Some(pb), Some(pc)) = (corner(a), corner(b), corner(c)) else { continue };
            let positions = &surface.positions;
            let flat = (positions[b] - positions[a]).cross(positions[c] - positions[a]).normalize_or_zero();
            let away = flat.dot(positions[a] - camera.eye) > 0.0;
            if away != second {
                continue;
            }
            let flat = (if away { -flat } else { flat }).as_vec3();
            let normals = smooth.then(|| {
                // A sheet seen from behind is lit as its back.
                let turn = if away { -1.0 } else { 1.0 };
                [a, b, c].map(|vertex| surface.normals[vertex].as_vec3() * turn)
            });
            // Normals that point the other way than the winding (mirrored parts) are turned as a whole.
            let normals = normals.map(|normals| {
                let sum = normals[0] + normals[1] + normals[2];
                if sum.dot(flat) < 0.0 { normals.map(|normal| -normal) } else { normals }
            });
            let uvs = texture.map(|image| (image, [a, b, c].map(|vertex| surface.uvs[vertex].as_vec2())));
            self.fill([pa, pb, pc], |canvas, sample, nearness, weights| {
                if nearness <= canvas.nearness[sample] {
                    return;
                }
                let mut albedo = Vec3::from(surface.color);
                if let Some((image, uvs)) = &uvs {
                    let uv = uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2];
                    let (texel, alpha) = sample_texture(image, uv.x, uv.y);
                    if alpha < 0.4 {
                        return;
                    }
                    albedo *= texel;
                }
                let normal = match &normals {
                    Some(n) => (n[0] * weights[0] + n[1] * weights[1] + n[2] * weights[2]).normalize_or(flat),
                    None => flat,
                };
                canvas.color[sample] = shade(albedo, normal, lights);
                canvas.nearness[sample] = nearness;
                canvas.body[sample] = body;
            });
        }
    }

    /// Darkens the rim of the body and the places where one limb passes before another.
    pub fn ink(&mut self) {
        let columns = self.width * self.across;
        let rows = self.height * self.across;
        let reach = self.across.div_ceil(2);
        let mut strength = vec![0.0f32; self.color.len()];
        for row in reach..rows.saturating_sub(reach) {
            for column in reach..columns.saturating_sub(reach) {
                let sample = row * columns + column;
                let here = self.nearness[sample];
                if here <= 0.0 {
                    continue;
                }
                let depth = 1.0 / here;
                let mut ink = 0.0f32;
                for other in [sample - reach, sample + reach, sample - reach * columns, sample + reach * columns] {
                    let there = self.nearness[other];
                    // This sample is behind: the limb in front casts its line on it. Or the rim against the ground.
                    if self.body[other] && self.body[sample] {
                        let gap = depth - 1.0 / there;
                        ink = ink.max(((gap - 0.03) / 0.06).clamp(0.0, 1.0));
                    } else if self.body[sample] {
                        ink = ink.max(0.55);
                    }
                }
                strength[sample] = ink;
            }
        }
        for (color, ink) in self.color.iter_mut().zip(strength) {
            *color *= 1.0 - 0.62 * ink;
        }
    }

    /// The finished picture in sRGB.
    pub fn resolve(&self) -> RgbaImage {
        let columns = self.width * self.across;
        let mut image = RgbaImage::new(self.width as u32, self.height as u32);
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            let mut sum = Vec3::ZERO;
            for row in 0..self.across {
                let start = (y as usize * self.across + row) * columns + x as usize * self.across;
                sum += self.color[start..start + self.across].iter().sum::<Vec3>();
            }
            let mean = sum / (self.across * self.across) as f32;
            *pixel = Rgba([to_srgb(mean.x), to_srgb(mean.y), to_srgb(mean.z), 255]);
        }
        image
    }

    /// Whether the body is drawn over more than half of a pixel.
    pub fn shows_body(&self, x: usize, y: usize) -> bool {
        let columns = self.width * self.across;
        let rows = (0..self.across).map(|row| (y * self.across + row) * columns + x * self.across);
        rows.flat_map(|start| &self.body[start..start + self.across]).filter(|body| **body).count() * 2
            > self.across * self.across
    }

    /// Visits the samples of a triangle: sample, 1/depth, perspective-correct weights of the corners.
    pub(super) fn fill(
        &mut self,
        corners: [(DVec2, f64); 3],
        mut visit: impl FnMut(&mut Canvas, usize, f32, [f32; 3]),
    ) {
        let scale = self.across as f64;
        let [a, b, c] = corners.map(|(point, _)| point * scale - 0.5);
        let area = (b - a).perp_dot(c - a);
        if area.abs() < 1e-9 || !area.is_finite() {
            return;
        }
        let inverse = corners.map(|(_, depth)| 1.0 / depth);
        let (columns, rows) = (self.width * self.across, self.height * self.across);
        let low = a.min(b).min(c).ceil().max(DVec2::ZERO);
        let high = a.max(b).max(c).floor().min(DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0));
        if low.x > high.x || low.y > high.y {
            return;
        }
        // Barycentric weights are linear in the picture: value at the first sample and steps along x.
        let step_a = -(c.y - b.y) / area;
        let step_b = -(a.y - c.y) / area;
        for row in low.y as usize..=high.y as usize {
            let y = row as f64;
            let start = DVec2::new(low.x, y);
            let mut weight_a = (c - b).perp_dot(start - b) / area;
            let mut weight_b = (a - c).perp_dot(start - c) / area;
            for column in low.x as usize..=high.x as usize {
                let weight_c = 1.0 - weight_a - weight_b;
                if weight_a >= -1e-9 && weight_b >= -1e-9 && weight_c >= -1e-9 {
                    let [wa, wb, wc] = [weight_a * inverse[0], weight_b * inverse[1], weight_c * inverse[2]];
                    let nearness = wa + wb + wc;
                    let weights = [(wa / nearness) as f32, (wb / nearness) as f32, (wc / nearness) as f32];
                    visit(self, row * columns + column, nearness as f32, weights);
                }
                weight_a += step_a;
                weight_b += step_b;
            }
        }
    }
}

/// Linear light to an sRGB byte.
pub fn to_srgb(linear: f32) -> u8 {
    let value = linear.clamp(0.0, 1.0);
    let curve = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * real::powf32(value, 1.0 / 2.4) - 0.055 };
    (curve * 255.0 + 0.5) as u8
}

/// An sRGB byte to linear light.
pub fn to_linear(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { real::powf32((value + 0.055) / 1.055, 2.4) }
}

/// What is seen at a pixel where nothing stands.
fn backdrop(camera: &Camera, pixel: DVec2) -> Vec3 {
    let ray = camera.ray(pixel);
    let below = -GROUND_DROP - camera.eye.y;
    let distance = if ray.y * below > 1e-9 { below / ray.y } else { -1.0 };
    if distance <= NEAR {
        let height = (ray.normalize().y / 0.45).clamp(0.0, 1.0);
        return SKY_LOW.lerp(SKY_HIGH, height as f32);
    }
    let point = camera.eye + ray * distance;
    // What a pixel covers on the ground, across and along the view.
    let across = distance / camera.focal;
    let along = across * (1.0 + (distance / below).powi(2)).sqrt();
    let ahead = DVec2::new(ray.x, ray.z).normalize_or(DVec2::Y).abs();
    let covers = DVec2::new(across * ahead.y + along * ahead.x, across * ahead.x + along * ahead.y);
    let color = tiles(DVec2::new(point.x, point.z), covers);
    let fade = 1.0 - real::exp(-((distance - 5.0).max(0.0) / 14.0));
    color.lerp(SKY_LOW, fade as f32)
}

/// Hemisphere, key light, a little sheen and rim.
pub(super) fn shade(albedo: Vec3, normal: Vec3, lights: &Lights) -> Vec3 {
    let [key, view, half] = lights.shading;
    let up = 0.5 + 0.5 * normal.y;
    let ambient = Vec3::new(0.24, 0.23, 0.22).lerp(Vec3::new(0.50, 0.55, 0.62), up);
    let facing = normal.dot(key);
    // A wrapped Lambert: the terminator is soft.
    let diffuse = ((facing + 0.18) / 1.18).max(0.0);
    let sheen = normal.dot(half).max(0.0).powi(24) * 0.07;
    let rim = (1.0 - normal.dot(view).max(0.0)).powi(4) * 0.05;
    albedo * (ambient + Vec3::new(0.86, 0.82, 0.76) * diffuse) + Vec3::splat(sheen + rim)
}

/// Repeating; bilinear where the texture is coarse (the samples of a pixel average a fine one): linear RGB and alpha.
fn sample_texture(image: &RgbaImage, u: f32, v: f32) -> (Vec3, f32) {
    let (width, height) = image.dimensions();
    if width == 0 || height == 0 || !u.is_finite() || !v.is_finite() {
        return (Vec3::ONE, 1.0);
    }
    let (x, y) = (u.rem_euclid(1.0) * width as f32, v.rem_euclid(1.0) * height as f32);
    let texel = |px: u32, py: u32| {
        let Rgba([r, g, b, a]) = *image.get_pixel(px % width, py % height);
        (Vec3::new(LINEAR[r as usize], LINEAR[g as usize], LINEAR[b as usize]), f32::from(a) / 255.0)
    };
    if width.min(height) >= 256 {
        return texel(x as u32, y as u32);
    }
    // From texel centres, moved by a whole turn so that the first is never negative.
    let (x, y) = (x + width as f32 - 0.5, y + height as f32 - 0.5);
    let (fx, fy) = (x.fract(), y.fract());
    let (px, py) = (x as u32, y as u32);
    let mix = |one: (Vec3, f32), two: (Vec3, f32), at: f32| (one.0.lerp(two.0, at), one.1 + (two.1 - one.1) * at);
    mix(mix(texel(px, py), texel(px + 1, py), fx), mix(texel(px, py + 1), texel(px + 1, py + 1), fx), fy)
}

/// [`to_linear`] of every byte.
static LINEAR: std::sync::LazyLock<[f32; 256]> =
    std::sync::LazyLock::new(|| std::array::from_fn(|byte| to_linear(byte as u8)));
