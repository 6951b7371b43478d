//! The ground's squares, and ground that is drawn as triangles: slopes, stairs, a platform. Scenario space, metres.

use super::raster::{Camera, Canvas, GROUND_DROP, Lights, SHADOW_TINT, SKY_HIGH, SKY_LOW, Surface, shade};
use glam::{DVec2, DVec3, Vec3};

/// m, the side of a square of the ground.
pub const TILE: f64 = 0.25;
const TILE_LIGHT: Vec3 = Vec3::new(0.60, 0.63, 0.65);
const TILE_DARK: Vec3 = Vec3::new(0.50, 0.535, 0.56);
const SECTION: Vec3 = Vec3::new(0.36, 0.39, 0.42);

/// What ground looks like at a point of space.
pub struct GroundLook<'a> {
    /// m, the place in its squares.
    pub squares: &'a dyn Fn(DVec3) -> DVec2,
    /// 0..1, how much shadow lies there.
    pub dark: &'a dyn Fn(DVec3) -> f32,
    /// It is cut away there.
    pub cut: &'a dyn Fn(DVec3) -> bool,
}

impl Canvas {
    /// Sky alone, with haze under the horizon: for a ground that is drawn as triangles.
    pub fn sky(&mut self, camera: &Camera) {
        let columns = self.width * self.across;
        for y in 0..self.height {
            for x in 0..self.width {
                let ray = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
                let color = SKY_LOW.lerp(SKY_HIGH, (ray.normalize().y / 0.45).clamp(0.0, 1.0) as f32);
                for row in y * self.across..(y + 1) * self.across {
                    let first = row * columns + x * self.across;
                    self.color[first..first + self.across].fill(color);
                }
            }
        }
    }

    /// Triangles of the ground, lit, with its squares, cut open where it hides the body: what then shows of its inside is
    /// plain. They are drawn a little lower, as the flat ground is.
    pub fn ground(&mut self, camera: &Camera, lights: &Lights, surface: &Surface, look: &GroundLook) {
        let drop = DVec3::Y * GROUND_DROP;
        for triangle in surface.indices.chunks_exact(3) {
            let corners = [0, 1, 2].map(|at| surface.positions.get(triangle[at] as usize).copied());
            let [Some(a), Some(b), Some(c)] = corners else { continue };
            let projected = [a, b, c].map(|corner| camera.project(corner - drop));
            let [Some(pa), Some(pb), Some(pc)] = projected else { continue };
            let flat = (b - a).cross(c - a).normalize_or(DVec3::Y);
            let inside = flat.dot(a - camera.eye) > 0.0;
            let smooth = surface.normals.len() == surface.positions.len();
            let normals = [0, 1, 2].map(|at| if smooth { surface.normals[triangle[at] as usize] } else { flat });
            self.fill([pa, pb, pc], |canvas, sample, nearness, weights| {
                if nearness <= canvas.nearness[sample] {
                    return;
                }
                let mix = |of: [DVec3; 3]| (0..3).map(|at| of[at] * f64::from(weights[at])).sum::<DVec3>();
                let (point, normal) = (mix([a, b, c]), mix(normals).normalize_or(flat).as_vec3());
                if (look.cut)(point) {
                    return;
                }
                canvas.nearness[sample] = nearness;
                if inside {
                    canvas.color[sample] = SECTION;
                    return;
                }
                let covers = DVec2::splat(1.0 / (f64::from(nearness) * camera.focal * canvas.across as f64));
                let upright = (normal.y - 0.2).clamp(0.0, 0.1) * 10.0;
                let tile = tiles((look.squares)(point), covers).lerp(TILE_DARK * 0.8, 1.0 - upright);
                // Level ground is as bright as the flat one.
                let level = shade(Vec3::ONE, Vec3::Y, lights);
                let color = tile * shade(Vec3::ONE, normal, lights) / level;
                canvas.color[sample] = color.lerp(SHADOW_TINT, (look.dark)(point));
            });
        }
    }
}

/// The squares and lines of the ground at a place, m, averaged over `covers`.
pub(super) fn tiles(at: DVec2, covers: DVec2) -> Vec3 {
    let square = checker(at.x, covers.x) * checker(at.y, covers.y);
    let color = TILE_DARK.lerp(TILE_LIGHT, (0.5 + 0.5 * square) as f32);
    color * (1.0 - 0.20 * grid_line(at.x, covers.x).max(grid_line(at.y, covers.y)) as f32)
}

/// +1 on even squares, -1 on odd ones, averaged over `width`.
fn checker(at: f64, width: f64) -> f64 {
    // The integral of the square wave is a triangle wave.
    let integral = |x: f64| {
        let phase = (x / (2.0 * TILE)).rem_euclid(1.0);
        TILE * (1.0 - (2.0 * phase - 1.0).abs())
    };
    let width = width.max(1e-4);
    ((integral(at + width / 2.0) - integral(at - width / 2.0)) / width).clamp(-1.0, 1.0)
}

/// The share of `width` that a line at every whole metre takes.
fn grid_line(at: f64, width: f64) -> f64 {
    let thick = 0.016;
    let width = width.max(1e-4);
    let off = (at - at.round()).abs();
    let low = (off - width / 2.0).max(-thick / 2.0);
    let high = (off + width / 2.0).min(thick / 2.0);
    ((high - low) / width).clamp(0.0, 1.0)
}
