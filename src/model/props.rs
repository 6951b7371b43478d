//! Things beside the body: ground, platform, boxes, balls. A shape and how it moves. Scenario space, metres, seconds.
//!
//! What is shown, not what is simulated: pictures draw props and the exporter makes nodes of them.

use crate::maths::real;
use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// A thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Prop {
    /// What its node is called.
    pub name: String,
    /// How it looks.
    pub shape: Shape,
    /// Linear RGB, 0..1.
    pub color: [f32; 3],
    /// Feet stand on it: pictures draw the ground's squares onto it.
    pub ground: bool,
    /// Where it is, in order of time; straight lines between, constant beyond the ends. One key: it stands. Never none.
    pub keys: Vec<PropKey>,
}

/// The form of a thing, about its own origin, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A cuboid about its centre: its edges along X, Y and Z.
    Box(DVec3),
    /// A sphere about its centre, by its radius.
    Ball(f64),
    /// Triangles.
    Mesh(Mesh),
}

/// Triangles, counter-clockwise from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// m.
    pub positions: Vec<DVec3>,
    /// Unit, one a position.
    pub normals: Vec<DVec3>,
    /// Three a triangle.
    pub indices: Vec<u32>,
}

/// A moment of a thing's way: `translation + rotation * (scale * point)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PropKey {
    /// s.
    pub time: f64,
    /// m.
    pub translation: DVec3,
    /// Unit.
    pub rotation: DQuat,
    /// Along the shape's own axes; 0 hides it.
    pub scale: DVec3,
}

impl Default for PropKey {
    fn default() -> PropKey {
        PropKey { time: 0.0, translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Prop {
    /// A thing that stands where its shape is.
    pub fn standing(name: &str, shape: Shape, color: [f32; 3]) -> Prop {
        Prop { name: name.to_owned(), shape, color, ground: false, keys: vec![PropKey::default()] }
    }

    /// Where it is at a time.
    pub fn at(&self, time: f64) -> PropKey {
        let after = self.keys.partition_point(|key| key.time <= time);
        match (after.checked_sub(1).and_then(|before| self.keys.get(before)), self.keys.get(after)) {
            (Some(before), Some(next)) => {
                let share = (time - before.time) / (next.time - before.time).max(1e-9);
                PropKey {
                    time,
                    translation: before.translation.lerp(next.translation, share),
                    rotation: before.rotation.slerp(next.rotation, share),
                    scale: before.scale.lerp(next.scale, share),
                }
            }
            (Some(only), None) | (None, Some(only)) => PropKey { time, ..*only },
            (None, None) => PropKey { time, ..PropKey::default() },
        }
    }
}

impl PropKey {
    /// m, where a point of the shape is.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.translation + self.rotation * (self.scale * point)
    }
}

impl Shape {
    /// Its triangles.
    pub fn mesh(&self) -> Mesh {
        match self {
            Shape::Box(size) => {
                let mut mesh = Mesh::default();
                mesh.cuboid(*size * -0.5, *size * 0.5);
                mesh
            }
            Shape::Ball(radius) => ball(*radius),
            Shape::Mesh(mesh) => mesh.clone(),
        }
    }
}

impl Mesh {
    /// Adds a flat quad, its corners counter-clockwise from outside.
    pub fn quad(&mut self, corners: [DVec3; 4]) {
        let first = self.positions.len() as u32;
        let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize_or(DVec3::Y);
        self.positions.extend(corners);
        self.normals.extend([normal; 4]);
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }

    /// Adds a cuboid from its low to its high corner.
    pub fn cuboid(&mut self, low: DVec3, high: DVec3) {
        let corner =
            |x: usize, y: usize, z: usize| DVec3::new([low.x, high.x][x], [low.y, high.y][y], [low.z, high.z][z]);
        self.quad([corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)]);
        self.quad([corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)]);
        self.quad([corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)]);
        self.quad([corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)]);
        self.quad([corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)]);
        self.quad([corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)]);
    }
}

/// A sphere in rings and sectors.
fn ball(radius: f64) -> Mesh {
    const RINGS: u32 = 10;
    const SECTORS: u32 = 18;
    let mut mesh = Mesh::default();
    for ring in 0..=RINGS {
        let (sine, cosine) = real::sin_cos(PI * f64::from(ring) / f64::from(RINGS));
        for sector in 0..=SECTORS {
            let (aside, ahead) = real::sin_cos(TAU * f64::from(sector) / f64::from(SECTORS));
            let normal = DVec3::new(sine * aside, cosine, sine * ahead);
            mesh.positions.push(normal * radius);
            mesh.normals.push(normal);
        }
    }
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            let here = ring * (SECTORS + 1) + sector;
            let below = here + SECTORS + 1;
            // At the poles one of the two triangles has no area.
            if ring + 1 < RINGS {
                mesh.indices.extend([here, below, below + 1]);
            }
            if ring > 0 {
                mesh.indices.extend([here, below + 1, here + 1]);
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// m³, signed: positive where triangles run counter-clockwise from outside.
    fn volume(mesh: &Mesh) -> f64 {
        let corner = |index: u32| mesh.positions[index as usize];
        mesh.indices.chunks_exact(3).map(|t| corner(t[0]).cross(corner(t[1])).dot(corner(t[2])) / 6.0).sum()
    }

    #[test]
    fn shapes_are_closed_and_face_outwards() {
        let cuboid = Shape::Box(DVec3::new(0.4, 0.3, 0.2)).mesh();
        assert!((volume(&cuboid) - 0.024).abs() < 1e-12, "{}", volume(&cuboid));
        let ball = Shape::Ball(0.1).mesh();
        let whole = 4.0 / 3.0 * PI * 1e-3;
        assert!(volume(&ball) > 0.9 * whole && volume(&ball) < whole, "{}", volume(&ball));
        for mesh in [cuboid, ball] {
            for triangle in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|at| mesh.positions[triangle[at] as usize]);
                let normal = (b - a).cross(c - a).normalize();
                assert!(triangle.iter().all(|at| mesh.normals[*at as usize].dot(normal) > 0.7));
            }
        }
    }

    #[test]
    fn a_thing_moves_between_its_keys_and_stays_beyond_them() {
        let key = |time: f64, x: f64| PropKey { time, translation: DVec3::X * x, ..PropKey::default() };
        let prop = Prop { keys: vec![key(1.0, 0.0), key(2.0, 4.0)], ..Prop::standing("a", Shape::Ball(1.0), [1.0; 3]) };
        assert_eq!([0.0, 1.25, 9.0].map(|time| prop.at(time).translation.x), [0.0, 1.0, 4.0]);
    }
}
