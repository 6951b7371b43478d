//! The surface of the built-in rig: tubes lofted over tables of rings, and the skin weights along them.
//!
//! Metres, scenario axes (Y up, Z forward, X left). A ring is a superellipse across a path; rings between those of a
//! table are Catmull-Rom. Tubes run into each other and are not welded: balls at shoulder and hip turn in place, knees
//! and elbows blend. Only the left side is written down; the right is its mirror image.

use crate::maths::real;
use glam::{DVec2, DVec3};

/// A skin weight: joint index and share.
pub(super) type Share = (usize, f64);

/// Vertices and triangles by material.
#[derive(Default)]
pub(super) struct Surface {
    /// m.
    pub positions: Vec<DVec3>,
    /// Unit.
    pub normals: Vec<DVec3>,
    /// Up to four, summing to 1.
    pub weights: Vec<Vec<Share>>,
    /// (materials) three a triangle, counter-clockwise from outside.
    pub triangles: Vec<Vec<u32>>,
}

/// A cross-section of a tube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// m.
    pub centre: DVec3,
    /// Unit, to the ring's own left.
    pub left: DVec3,
    /// Unit, to the ring's own front.
    pub front: DVec3,
    /// m, half extents to the left, to the right, to the front, to the back.
    pub half: [f64; 4],
    /// Of the superellipse: 2 is an ellipse, 4 nearly a box.
    pub power: f64,
    /// Of the gap from here to the next ring.
    pub material: usize,
}

impl Ring {
    /// A horizontal ring.
    pub fn level(centre: DVec3, half: [f64; 4], power: f64, material: usize) -> Ring {
        Ring { centre, left: DVec3::X, front: DVec3::Z, half, power, material }
    }

    fn point(&self, turn: f64) -> DVec3 {
        let (sine, cosine) = real::sin_cos(turn);
        let bend = |value: f64| value.signum() * real::powf(value.abs(), 2.0 / self.power);
        let aside = bend(cosine) * if cosine >= 0.0 { self.half[0] } else { self.half[1] };
        let ahead = bend(sine) * if sine >= 0.0 { self.half[2] } else { self.half[3] };
        self.centre + self.left * aside + self.front * ahead
    }

    /// Catmull-Rom over four rings, `t` from `b` to `c`.
    fn between(a: &Ring, b: &Ring, c: &Ring, d: &Ring, t: f64) -> Ring {
        let mix = |p: f64, q: f64, r: f64, s: f64| {
            let value = 0.5
                * (2.0 * q
                    + (r - p) * t
                    + (2.0 * p - 5.0 * q + 4.0 * r - s) * t * t
                    + (3.0 * q - p - 3.0 * r + s) * t * t * t);
            // No bulges that the table does not have.
            value.clamp(q.min(r), q.max(r))
        };
        let vector = |pick: &dyn Fn(&Ring) -> DVec3| {
            let [p, q, r, s] = [a, b, c, d].map(pick);
            DVec3::new(mix(p.x, q.x, r.x, s.x), mix(p.y, q.y, r.y, s.y), mix(p.z, q.z, r.z, s.z))
        };
        let mut half = [0.0; 4];
        for (side, value) in half.iter_mut().enumerate() {
            *value = mix(a.half[side], b.half[side], c.half[side], d.half[side]);
        }
        let left = vector(&|ring| ring.left).normalize_or(b.left);
        let front = vector(&|ring| ring.front);
        let front = (front - left * front.dot(left)).normalize_or(b.front);
        Ring {
            centre: vector(&|ring| ring.centre),
            left,
            front,
            half,
            power: mix(a.power, b.power, c.power, d.power),
            material: b.material,
        }
    }
}

impl Surface {
    /// An empty one with room for so many materials.
    pub fn new(materials: usize) -> Surface {
        Surface { triangles: vec![Vec::new(); materials], ..Surface::default() }
    }

    /// A closed tube through the table's rings, `between` more rings in each gap; `weigh` gives a vertex its weights by its place.
    pub fn tube(&mut self, table: &[Ring], between: usize, sides: usize, weigh: &dyn Fn(DVec3) -> Vec<Share>) {
        let mut rings: Vec<Ring> = Vec::new();
        for index in 0..table.len() {
            let at = |offset: isize| &table[(index as isize + offset).clamp(0, table.len() as isize - 1) as usize];
            rings.push(table[index]);
            if index + 1 < table.len() {
                for step in 1..=between {
                    let t = step as f64 / (between + 1) as f64;
                    rings.push(Ring::between(at(-1), at(0), at(1), at(2), t));
                }
            }
        }
        let (Some(first), Some(last)) = (rings.first().copied(), rings.last().copied()) else { return };
        let base = self.positions.len() as u32;
        for ring in &rings {
            for side in 0..sides {
                self.positions.push(ring.point(std::f64::consts::TAU * side as f64 / sides as f64));
            }
        }
        let (start, end) = (self.positions.len() as u32, self.positions.len() as u32 + 1);
        self.positions.extend([first.centre, last.centre]);
        let count = sides as u32;
        // Rings whose left and front lie so that left x front runs along the path wind the other way.
        let along = last.centre - first.centre;
        let flip = first.left.cross(first.front).dot(along) < 0.0;
        let put = |surface: &mut Surface, material: usize, mut corners: [u32; 3]| {
            if flip {
                corners.swap(1, 2);
            }
            surface.triangles[material].extend(corners);
        };
        for (row, ring) in rings.iter().enumerate().take(rings.len() - 1) {
            let (here, next) = (base + row as u32 * count, base + (row as u32 + 1) * count);
            for side in 0..count {
                let other = (side + 1) % count;
                put(self, ring.material, [here + side, here + other, next + side]);
                put(self, ring.material, [here + other, next + other, next + side]);
            }
        }
        let top = base + (rings.len() as u32 - 1) * count;
        for side in 0..count {
            let other = (side + 1) % count;
            put(self, first.material, [start, base + other, base + side]);
            put(self, last.material, [end, top + side, top + other]);
        }
        for index in base as usize..self.positions.len() {
            let shares = weigh(self.positions[index]);
            self.weights.push(shares);
        }
    }

    /// Adds the mirror image of every vertex from `first` on, with left and right joints exchanged.
    pub fn mirror(&mut self, first: usize, first_triangles: &[usize], other: &dyn Fn(usize) -> usize) {
        let count = self.positions.len() - first;
        let shift = count as u32;
        for index in first..first + count {
            let place = self.positions[index];
            self.positions.push(DVec3::new(-place.x, place.y, place.z));
            let shares = self.weights[index].iter().map(|share| (other(share.0), share.1)).collect();
            self.weights.push(shares);
        }
        for (material, from) in first_triangles.iter().enumerate() {
            let added: Vec<u32> = self.triangles[material][*from..]
                .chunks_exact(3)
                .flat_map(|corner| [corner[0] + shift, corner[2] + shift, corner[1] + shift])
                .collect();
            self.triangles[material].extend(added);
        }
    }

    /// Smooth normals: the mean of the faces around, by area.
    pub fn shade(&mut self) {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for corner in self.triangles.iter().flat_map(|list| list.chunks_exact(3)) {
            let [a, b, c] = [corner[0], corner[1], corner[2]].map(|index| self.positions[index as usize]);
            let face = (b - a).cross(c - a);
            for index in corner {
                normals[*index as usize] += face;
            }
        }
        self.normals = normals.into_iter().map(|normal| normal.normalize_or(DVec3::Y)).collect();
    }
}

/// Weights along a chain of joints: each has the stretch up to the next, with a smooth blend of the given half width.
pub(super) fn chain(stations: &[(usize, f64, f64)], at: f64) -> Vec<Share> {
    let mut shares: Vec<Share> = Vec::new();
    for (position, (joint, start, blend)) in stations.iter().enumerate() {
        let on = if position == 0 { 1.0 } else { ease((at - start) / (2.0 * blend) + 0.5) };
        let off = stations.get(position + 1).map_or(0.0, |(_, start, blend)| ease((at - start) / (2.0 * blend) + 0.5));
        let share = on - off;
        if share > 0.004 {
            shares.push((*joint, share));
        }
    }
    shares
}

/// 0 to 1, smoothly.
pub(super) fn ease(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A table's row: where along the path, offsets from it to the left and to the front, half extents left, right, front,
/// back, power, material.
pub(super) type Row = (f64, [f64; 2], [f64; 4], f64, usize);

/// Rings of a table along a straight path from `from` in direction `down`, `left` and `front` across it.
pub(super) fn rings(from: DVec3, down: DVec3, left: DVec3, front: DVec3, table: &[Row]) -> Vec<Ring> {
    table
        .iter()
        .map(|&(at, offset, half, power, material)| {
            let offset = DVec2::from_array(offset);
            Ring { centre: from + down * at + left * offset.x + front * offset.y, left, front, half, power, material }
        })
        .collect()
}
