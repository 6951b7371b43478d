//! A ground of triangles, and what may be asked of it: how high it is at a place, whether a wall stands between two points.
//!
//! Scenario space, metres, Y up. A triangle is **ground** where its front faces up (normal.y > [`STEEP`]); of several at one place the
//! topmost that is no higher than the asker's ceiling counts, so a bridge is walked over and a roof above the ceiling is not there.
//! The triangles lie in a uniform grid over (x, z); answers do not depend on threads or on the order of the grid's cells.

use glam::{DVec2, DVec3};

/// Least upward part of the unit normal of a face that is ground: cos 80°. Steeper, no foot stands; it is a wall.
pub const STEEP: f64 = 0.173_648_177_666_930_3;
/// m², triangles of less have no direction worth believing: 0.1 mm by 0.1 mm.
const LEAST_AREA: f64 = 1e-8;
/// Cells of the grid at most, and entries (a triangle in a cell): 64 MB of indices.
const MOST_CELLS: f64 = 1_048_576.0;
const MOST_ENTRIES: usize = 16_000_000;
/// m, a cell's side where the entries are few enough: a sole asks for points so far apart, and walls and steps of few large triangles stand
/// close together beside floors that are bare. Entries so many are laid out in 10 ms.
const FINE: f64 = 0.1;
const FEW_ENTRIES: usize = 262_144;
/// m, the least and greatest side of a cell: a sole's width, and a hall's.
const CELLS: [f64; 2] = [0.05, 20.0];
/// m over a floor: what faces up there is another floor, or a roof.
const STANDS: f64 = 1.2;
/// The upward part of the unit normal of ground that leans by 3 degrees.
const LEVEL: f64 = 0.9986;
/// m, by which a place may be beside a triangle's edge and still on it: seams of f32 coordinates leave no holes.
const SEAM: f64 = 1e-6;

/// Triangles of a ground, in a grid.
#[derive(Clone)]
pub struct Surface {
    corners: Vec<[DVec3; 3]>, // m, counter-clockwise from the front
    normals: Vec<DVec3>,      // unit
    low: DVec3,
    high: DVec3,
    cell: f64,           // m, side of a cell
    columns: [usize; 2], // cells along x and z
    starts: Vec<u32>,    // (cells + 1) where the entries of each begin
    entries: Vec<u32>,   // triangles
    mark: u64,           // of the coordinates
    roofed: bool,        // somebody could stand under some of it
    leans: bool,         // some of its ground is not level
    /// Triangles without area that were left out.
    pub dropped: usize,
}

impl std::fmt::Debug for Surface {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Surface({} triangles, {:016x})", self.corners.len(), self.mark)
    }
}

impl PartialEq for Surface {
    fn eq(&self, other: &Surface) -> bool {
        self.mark == other.mark && self.corners.len() == other.corners.len() && self.dropped == other.dropped
    }
}

impl Surface {
    /// Of triangles with finite corners (m), counter-clockwise from the front; those without area are left out and counted.
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Surface {
        let all = triangles.len();
        let (mut corners, mut normals) = (Vec::with_capacity(all), Vec::with_capacity(all));
        for triangle in triangles {
            let [a, b, c] = triangle;
            let across = (b - a).cross(c - a);
            if across.length() > 2.0 * LEAST_AREA {
                corners.push(triangle);
                normals.push(across.normalize());
            }
        }
        let dropped = all - corners.len();
        let mut mark = 0xcbf2_9ce4_8422_2325_u64; // FNV-1a
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in corners.iter().flatten() {
            (low, high) = (low.min(*corner), high.max(*corner));
            for number in corner.to_array() {
                mark = number
                    .to_bits()
                    .to_le_bytes()
                    .iter()
                    .fold(mark, |mark, byte| (mark ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3));
            }
        }
        let mut surface = Surface {
            corners,
            normals,
            low,
            high,
            cell: 1.0,
            columns: [0; 2],
            starts: vec![0],
            entries: Vec::new(),
            mark,
            roofed: false,
            leans: false,
            dropped,
        };
        surface.fill();
        surface.roofed = surface.has_roof();
        surface.leans = surface.normals.iter().any(|normal| normal.y > STEEP && normal.y < LEVEL);
        surface
    }

    /// Does some of its ground lie over other ground, so far that somebody could stand between?
    pub fn is_roofed(&self) -> bool {
        self.roofed
    }

    /// Looks over and under the middle of each triangle that faces up.
    fn has_roof(&self) -> bool {
        (0..self.corners.len()).filter(|index| self.normals[*index].y > STEEP).any(|index| {
            let middle = self.corners[index].iter().sum::<DVec3>() / 3.0;
            let at = DVec2::new(middle.x, middle.z);
            let over = self.ground(at, f64::INFINITY).is_some_and(|(top, _)| top > middle.y + STANDS);
            over || self.ground(at, middle.y - STANDS).is_some()
        })
    }

    /// Is any of its ground not level?
    pub fn leans(&self) -> bool {
        self.leans
    }

    /// How many triangles.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// m, the least and greatest coordinates.
    pub fn bounds(&self) -> [DVec3; 2] {
        [self.low, self.high]
    }

    /// A word that differs where a coordinate does.
    pub fn mark(&self) -> u64 {
        self.mark
    }

    /// Each triangle's corners (m), counter-clockwise from the front.
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.corners
    }

    /// Height (m) and unit normal of the ground at (x, z): the topmost face that faces up and lies no higher than `ceiling` (m).
    pub fn ground(&self, at: DVec2, ceiling: f64) -> Option<(f64, DVec3)> {
        let mut best: Option<(f64, DVec3)> = None;
        for index in self.over(at) {
            let (corners, normal) = (&self.corners[*index as usize], self.normals[*index as usize]);
            if normal.y <= STEEP || !holds(corners, at) {
                continue;
            }
            let from = corners[0];
            let height = from.y - (normal.x * (at.x - from.x) + normal.z * (at.y - from.z)) / normal.y;
            if height <= ceiling && best.is_none_or(|(top, _)| height > top) {
                best = Some((height, normal));
            }
        }
        best
    }

    /// How far along the way from one point to another (0..1) the first face stands that is not ground, and its unit normal towards where
    /// one comes from: a wall, seen from either side.
    pub fn wall(&self, from: DVec3, to: DVec3) -> Option<(f64, DVec3)> {
        let way = to - from;
        let [a, b] = [from, to].map(|end| DVec2::new(end.x, end.z));
        let mut nearest: Option<(f64, DVec3)> = None;
        for index in self.near(a.min(b), a.max(b)) {
            let (corners, normal) = (&self.corners[index], self.normals[index]);
            let fall = normal.dot(way);
            if normal.y > STEEP || fall.abs() < 1e-12 {
                continue;
            }
            let share = normal.dot(corners[0] - from) / fall;
            let point = from + way * share;
            let inside = (0..3).all(|side| {
                let (here, next) = (corners[side], corners[(side + 1) % 3]);
                (next - here).cross(point - here).dot(normal) >= -SEAM
            });
            if (0.0..=1.0).contains(&share) && inside && nearest.is_none_or(|known| share < known.0) {
                nearest = Some((share, normal * -fall.signum()));
            }
        }
        nearest
    }

    /// The triangles that may be over or under a place.
    fn over(&self, at: DVec2) -> &[u32] {
        let [column, row] = ((at - DVec2::new(self.low.x, self.low.z)) / self.cell).to_array();
        let [columns, rows] = self.columns;
        if !(column >= 0.0 && row >= 0.0 && column <= columns as f64 && row <= rows as f64) || columns == 0 {
            return &[];
        }
        let cell = (column as usize).min(columns - 1) * rows + (row as usize).min(rows - 1);
        &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The triangles that may touch the box from low to high (x, z), each at least once, in an order that is always the same.
    pub fn near(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = usize> + '_ {
        let [first, last] = [low, high].map(|at| (at - DVec2::new(self.low.x, self.low.z)) / self.cell);
        let most = DVec2::new(self.columns[0] as f64, self.columns[1] as f64);
        let there = self.columns[0] > 0 && first.cmple(most).all() && last.cmpge(DVec2::ZERO).all();
        let whole = |value: f64, most: usize| (value.max(0.0) as usize).min(most.saturating_sub(1));
        let [columns, rows] = self.columns;
        let across = if there { whole(first.x, columns)..whole(last.x, columns) + 1 } else { 0..0 };
        let along = whole(first.y, rows)..whole(last.y, rows) + 1;
        across.flat_map(move |column| along.clone().map(move |row| column * rows + row)).flat_map(|cell| {
            let (from, to) = (self.starts[cell] as usize, self.starts[cell + 1] as usize);
            self.entries[from..to].iter().map(|index| *index as usize)
        })
    }

    /// Puts the triangles into cells of about two each or of [`FINE`], whichever is finer; larger ones where that takes too much room.
    fn fill(&mut self) {
        if self.corners.is_empty() {
            return;
        }
        let size = DVec2::new(self.high.x - self.low.x, self.high.z - self.low.z);
        let area = size.x.max(0.01) * size.y.max(0.01);
        let least = (area / MOST_CELLS).sqrt();
        let sided =
            |wanted: f64| wanted.max(least).clamp(CELLS[0], CELLS[1]).max((size.max_element() / 30_000.0).max(1e-3));
        let two = sided((area / self.corners.len() as f64 * 2.0).sqrt());
        self.cell = sided(FINE).min(two);
        while self.cell < two {
            if self.filled(FEW_ENTRIES) {
                return;
            }
            self.cell = (self.cell * std::f64::consts::SQRT_2).min(two);
        }
        while !self.filled(MOST_ENTRIES) {
            self.cell *= 2.0;
        }
    }

    fn filled(&mut self, most: usize) -> bool {
        let size = DVec2::new(self.high.x - self.low.x, self.high.z - self.low.z);
        self.columns = [size.x, size.y].map(|side| (side / self.cell) as usize + 1);
        let [columns, rows] = self.columns;
        let alone = columns == 1 && rows == 1;
        if (columns as f64 * rows as f64) > 4.0 * MOST_CELLS && !alone {
            return false;
        }
        let mut counts = vec![0_u32; columns * rows + 1];
        let mut entries = 0_usize;
        for corners in &self.corners {
            self.cells_of(corners, &mut |cell| {
                counts[cell + 1] += 1;
                entries += 1;
            });
            if entries > most && !alone {
                return false;
            }
        }
        for cell in 0..columns * rows {
            counts[cell + 1] += counts[cell];
        }
        let mut next = counts.clone();
        let mut list = vec![0; entries];
        for (index, corners) in self.corners.iter().enumerate() {
            self.cells_of(corners, &mut |cell| {
                list[next[cell] as usize] = index as u32;
                next[cell] += 1;
            });
        }
        (self.starts, self.entries) = (counts, list);
        true
    }

    /// The cells that a triangle's shadow may touch.
    fn cells_of(&self, corners: &[DVec3; 3], take: &mut dyn FnMut(usize)) {
        let flat = corners.map(|corner| DVec2::new(corner.x - self.low.x, corner.z - self.low.z));
        let low = flat[0].min(flat[1]).min(flat[2]) - 2.0 * SEAM;
        let high = flat[0].max(flat[1]).max(flat[2]) + 2.0 * SEAM;
        let whole = |value: f64, most: usize| ((value / self.cell).max(0.0) as usize).min(most - 1);
        let [columns, rows] = self.columns;
        for column in whole(low.x, columns)..=whole(high.x, columns) {
            for row in whole(low.y, rows)..=whole(high.y, rows) {
                let middle = (DVec2::new(column as f64, row as f64) + 0.5) * self.cell;
                // Apart along the normal of a side: the cell lies wholly beyond it.
                let beyond = (0..3).any(|side| {
                    let (a, b, c) = (flat[side], flat[(side + 1) % 3], flat[(side + 2) % 3]);
                    let out = (b - a).perp() * -(b - a).perp_dot(c - a).signum();
                    let reach = 0.5 * self.cell * (out.x.abs() + out.y.abs()) + 4.0 * SEAM * out.length();
                    out.dot(middle - a) > reach && (b - a).perp_dot(c - a).abs() > 1e-12
                });
                if !beyond {
                    take(column * rows + row);
                }
            }
        }
    }
}

/// Is a place over the triangle?
fn holds(corners: &[DVec3; 3], at: DVec2) -> bool {
    let flat = corners.map(|corner| DVec2::new(corner.x, corner.z));
    // Faces up: clockwise in (x, z), for z x x = y.
    (0..3).all(|side| {
        let (a, b) = (flat[side], flat[(side + 1) % 3]);
        let out = (b - a).perp_dot(at - a);
        out <= 0.0 || out <= SEAM * (b - a).length()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::seed::Seed;

    /// A horizontal rectangle that faces up.
    fn floor(low: DVec2, high: DVec2, y: f64) -> [[DVec3; 3]; 2] {
        let at = |x: f64, z: f64| DVec3::new(x, y, z);
        let [a, b, c, d] = [at(low.x, low.y), at(low.x, high.y), at(high.x, high.y), at(high.x, low.y)];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn the_topmost_face_under_the_ceiling_is_the_ground() {
        let wide = DVec2::splat(5.0);
        let mut triangles = floor(-wide, wide, 0.0).to_vec();
        triangles.extend(floor(DVec2::new(-1.0, 2.0), DVec2::new(1.0, 3.0), 0.15));
        triangles.extend(floor(-wide, wide, 3.0));
        triangles.extend(floor(-wide, wide, 1.0).map(|[a, b, c]| [a, c, b])); // faces down: a lamp's underside
        let surface = Surface::new(triangles);
        let height = |x: f64, z: f64, ceiling: f64| surface.ground(DVec2::new(x, z), ceiling).map(|found| found.0);
        assert_eq!(height(0.0, 0.0, 2.0), Some(0.0));
        assert_eq!(height(0.5, 2.5, 2.0), Some(0.15));
        assert_eq!(height(0.5, 2.5, 9.0), Some(3.0));
        assert_eq!(height(6.0, 0.0, 9.0), None);
        assert_eq!(height(f64::NAN, 0.0, 9.0), None);
    }

    #[test]
    fn ground_over_ground_is_a_roof_and_a_hill_or_a_kerb_is_none() {
        let wide = DVec2::splat(5.0);
        let with = |more: &[[DVec3; 3]]| {
            let surface = Surface::new([floor(-wide, wide, 0.0).as_slice(), more].concat());
            (surface.is_roofed(), surface.leans())
        };
        assert_eq!(with(&[]), (false, false));
        assert_eq!(with(&floor(DVec2::ZERO, DVec2::splat(0.4), 2.5)), (true, false)); // smaller than what is under it
        assert_eq!(with(&floor(-2.0 * wide, 2.0 * wide, 2.5)), (true, false));
        assert_eq!(with(&floor(-wide, DVec2::ZERO, 0.5)), (false, false));
        let hill = [DVec3::new(-5.0, 0.0, 5.0), DVec3::new(-5.0, 4.0, 9.0), DVec3::new(5.0, 4.0, 9.0)];
        assert_eq!(with(&[hill]), (false, true));
    }

    #[test]
    fn the_grid_finds_what_looking_at_every_triangle_finds() {
        for seed in 0..6 {
            let mut draw = Seed::new(seed);
            let reach = [0.5, 3.0, 40.0][seed as usize % 3];
            let mut point = |reach: f64| {
                DVec3::new(draw.between(-reach, reach), draw.between(-1.0, 1.0), draw.between(-reach, reach))
            };
            let triangles: Vec<[DVec3; 3]> = (0..300)
                .map(|_| {
                    let middle = point(reach);
                    [middle + point(1.5), middle + point(1.5), middle + point(1.5)]
                })
                .collect();
            let surface = Surface::new(triangles);
            let all = |at: DVec2| {
                let over = (0..surface.len())
                    .filter(|index| surface.normals[*index].y > STEEP && holds(&surface.corners[*index], at));
                let height = |index: usize| {
                    let (from, normal) = (surface.corners[index][0], surface.normals[index]);
                    from.y - (normal.x * (at.x - from.x) + normal.z * (at.y - from.z)) / normal.y
                };
                over.map(height).filter(|height| *height <= 0.7).fold(f64::NEG_INFINITY, f64::max)
            };
            let mut found = 0;
            for _ in 0..400 {
                let at = point(1.2 * reach);
                let at = DVec2::new(at.x, at.z);
                let known = surface.ground(at, 0.7).map_or(f64::NEG_INFINITY, |known| known.0);
                assert_eq!(known, all(at), "seed {seed} at {at}");
                found += usize::from(known.is_finite());
            }
            assert!(found > 10 || seed % 3 == 2, "seed {seed}: {found}");
        }
    }

    #[test]
    fn a_wall_is_seen_from_both_sides_and_over_it_is_free() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 2.0);
        let surface = Surface::new(vec![[at(-1.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)]]);
        let wall = |from: [f64; 3], to: [f64; 3]| surface.wall(DVec3::from_array(from), DVec3::from_array(to));
        let between = |from: [f64; 3], to: [f64; 3]| wall(from, to).map(|found| found.0);
        assert_eq!(between([0.0, 0.3, 0.0], [0.0, 0.3, 4.0]), Some(0.5));
        assert_eq!(between([0.0, 0.3, 4.0], [0.0, 0.3, 0.0]), Some(0.5));
        assert_eq!(wall([0.0, 0.3, 4.0], [0.0, 0.3, 0.0]).map(|found| found.1), Some(DVec3::Z));
        assert_eq!(between([0.0, 1.1, 0.0], [0.0, 1.1, 4.0]), None);
        assert_eq!(between([0.0, 0.3, 0.0], [0.0, 0.3, 1.9]), None);
    }

    #[test]
    fn triangles_without_area_are_counted_and_left_out() {
        let surface = Surface::new(vec![[DVec3::ZERO, DVec3::X, DVec3::X * 2.0], [DVec3::ZERO, DVec3::Z, DVec3::X]]);
        assert_eq!((surface.len(), surface.dropped), (1, 1));
        assert_eq!(surface.ground(DVec2::new(0.2, 0.2), 1.0), Some((0.0, DVec3::Y)));
        assert!(Surface::new(Vec::new()).ground(DVec2::ZERO, 1.0).is_none());
    }
}
