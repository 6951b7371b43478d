//! The soft shadow that a body drops on the ground: sharp where it touches, blurred where it is high.
//!
//! The triangles are cast along the light onto a fine grid of the plane y = 0, in bands of height; each band is blurred by
//! a width of its own, the way a large lamp does it. Metres. It judges contact for the eye; it measures nothing.

use super::raster::Surface;
use glam::{DVec2, DVec3};

/// Darkness on a patch of the ground.
#[derive(Clone, Debug)]
pub struct GroundShadow {
    /// m, how far light goes sideways for each metre down, (x, z).
    slant: DVec2,
    /// m, side of a square of the grid.
    cell: f64,
    /// m, the patch's low corner, (x, z).
    origin: DVec2,
    /// Squares along each side.
    columns: usize,
    rows: usize,
    /// (rows x columns) 0..1.
    dark: Vec<f32>,
}

/// m, side of a square of the grid for a common sheet.
pub const FINE: f64 = 0.012;
/// m, the top of each band of height, its blur and how dark it gets.
const BANDS: [(f64, f64, f32); 4] = [(0.07, 0.010, 0.62), (0.30, 0.030, 0.50), (0.90, 0.065, 0.46), (9.0, 0.12, 0.40)];
/// Squares; a larger patch is not drawn (a body flung apart by bad data).
const LARGEST: usize = 700;

impl GroundShadow {
    /// The shadow of what the surfaces are, under a light that comes from `light` (unit, upwards), on squares of `cell` m.
    pub fn cast(surfaces: &[Surface], light: DVec3, cell: f64) -> Option<GroundShadow> {
        GroundShadow::cast_over(surfaces, light, cell, &|_| 0.0)
    }

    /// The same over ground that is so high (m) below a point: what lies on it is sharp. Ask [`GroundShadow::on`] then.
    pub fn cast_over(
        surfaces: &[Surface],
        light: DVec3,
        cell: f64,
        floor: &dyn Fn(DVec3) -> f64,
    ) -> Option<GroundShadow> {
        let slant = DVec2::new(light.x, light.z) / light.y.max(0.2);
        let fall = |point: DVec3| DVec2::new(point.x, point.z) - slant * point.y.max(floor(point));
        let mut low = DVec2::INFINITY;
        let mut high = DVec2::NEG_INFINITY;
        for point in surfaces.iter().flat_map(|surface| &surface.positions).filter(|point| point.is_finite()) {
            low = low.min(fall(*point));
            high = high.max(fall(*point));
        }
        let margin = DVec2::splat(0.4);
        let origin = low - margin;
        let size = ((high + margin - origin) / cell).ceil();
        if !size.is_finite() || size.x < 1.0 || size.y < 1.0 || size.max_element() > LARGEST as f64 {
            return None;
        }
        let (columns, rows) = (size.x as usize, size.y as usize);
        let mut bands: Vec<Vec<f32>> = BANDS.iter().map(|_| vec![0.0; columns * rows]).collect();
        for surface in surfaces {
            for triangle in surface.indices.chunks_exact(3) {
                let corner = |at: usize| surface.positions.get(triangle[at] as usize).copied();
                let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
                let middle = (a + b + c) / 3.0;
                let height = middle.y - floor(middle);
                let Some(band) = BANDS.iter().position(|(top, _, _)| height < *top) else { continue };
                let place = |point: DVec3| (fall(point) - origin) / cell;
                cover(&mut bands[band], columns, rows, [place(a), place(b), place(c)]);
            }
        }
        let mut dark = vec![0.0f32; columns * rows];
        for (band, (_, blur, depth)) in bands.iter_mut().zip(BANDS) {
            let radius = (blur / cell).round() as usize;
            for _ in 0..2 {
                blur_rows(band, columns, radius);
                blur_columns(band, columns, rows, radius);
            }
            for (dark, covered) in dark.iter_mut().zip(band.iter()) {
                *dark = 1.0 - (1.0 - *dark) * (1.0 - covered * depth);
            }
        }
        Some(GroundShadow { slant, cell, origin, columns, rows, dark })
    }

    /// How dark a point of ground at any height is, 0..1.
    pub fn on(&self, point: DVec3) -> f32 {
        self.at(point.x - self.slant.x * point.y, point.z - self.slant.y * point.y)
    }

    /// How dark the ground at height 0 is there, 0..1.
    pub fn at(&self, x: f64, z: f64) -> f32 {
        let place = (DVec2::new(x, z) - self.origin) / self.cell - 0.5;
        if place.x < 0.0 || place.y < 0.0 {
            return 0.0;
        }
        let (column, row) = (place.x as usize, place.y as usize);
        if column + 1 >= self.columns || row + 1 >= self.rows {
            return 0.0;
        }
        let (fx, fy) = (place.x.fract() as f32, place.y.fract() as f32);
        let here = row * self.columns + column;
        let above = self.dark[here] * (1.0 - fx) + self.dark[here + 1] * fx;
        let below = self.dark[here + self.columns] * (1.0 - fx) + self.dark[here + self.columns + 1] * fx;
        above * (1.0 - fy) + below * fy
    }
}

/// Marks the squares whose centre the triangle covers, and the square of each corner so that thin ones are not lost.
fn cover(grid: &mut [f32], columns: usize, rows: usize, [a, b, c]: [DVec2; 3]) {
    if !(a + b + c).is_finite() {
        return;
    }
    for corner in [a, b, c] {
        let (x, y) = (corner.x.max(0.0) as usize, corner.y.max(0.0) as usize);
        if x < columns && y < rows {
            grid[y * columns + x] = 1.0;
        }
    }
    let area = (b - a).perp_dot(c - a);
    if area.abs() < 1e-12 {
        return;
    }
    let low = (a.min(b).min(c) - 0.5).ceil().max(DVec2::ZERO);
    let high = (a.max(b).max(c) - 0.5).floor().min(DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0));
    let mut row = low.y;
    while row <= high.y {
        let mut column = low.x;
        while column <= high.x {
            let centre = DVec2::new(column + 0.5, row + 0.5);
            let sides = [(c - b).perp_dot(centre - b), (a - c).perp_dot(centre - c), (b - a).perp_dot(centre - a)];
            if sides.iter().all(|side| side * area >= 0.0) {
                grid[row as usize * columns + column as usize] = 1.0;
            }
            column += 1.0;
        }
        row += 1.0;
    }
}

/// A running mean over 2 radius + 1 along each row.
fn blur_rows(grid: &mut [f32], columns: usize, radius: usize) {
    let mut line = Vec::with_capacity(columns);
    for row in grid.chunks_exact_mut(columns) {
        line.clear();
        line.extend_from_slice(row);
        running_mean(&line, radius, |at, mean| row[at] = mean);
    }
}

/// The same along each column.
fn blur_columns(grid: &mut [f32], columns: usize, rows: usize, radius: usize) {
    let mut line = Vec::with_capacity(rows);
    for column in 0..columns {
        line.clear();
        line.extend((0..rows).map(|row| grid[row * columns + column]));
        running_mean(&line, radius, |at, mean| grid[at * columns + column] = mean);
    }
}

/// Means over a window around each entry; beyond the ends lies 0.
fn running_mean(line: &[f32], radius: usize, mut put: impl FnMut(usize, f32)) {
    let width = (2 * radius + 1) as f32;
    let mut sum: f32 = line.iter().take(radius).sum();
    for at in 0..line.len() {
        sum += line.get(at + radius).copied().unwrap_or(0.0);
        put(at, (sum / width).clamp(0.0, 1.0));
        sum -= at.checked_sub(radius).map_or(0.0, |gone| line[gone]);
    }
}
