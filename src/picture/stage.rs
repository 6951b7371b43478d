//! The ground and the things of a moment as they are drawn: props in their places, and how high the ground is where.
//!
//! Scenario space, metres. Without a ground the picture has the flat one without an end.

use super::raster::Surface;
use crate::model::props::{Mesh, Prop};
use glam::{DQuat, DVec2, DVec3};

/// m; longer edges of the ground are split, so that what reaches behind the camera is left out by small pieces.
const LONGEST_EDGE: f64 = 0.35;

/// m before the body, from where on ground that hides it is left out.
const CUT: f64 = 0.45;

/// What stands around the body.
#[derive(Clone, Debug, Default)]
pub struct Stage {
    /// Ground, and how its squares are turned.
    pub ground: Vec<(Surface<'static>, DQuat)>,
    /// Boxes and balls.
    pub things: Vec<Surface<'static>>,
}

impl Stage {
    /// The props at a time.
    pub fn at(props: &[Prop], time: f64) -> Stage {
        let mut stage = Stage::default();
        for prop in props {
            let key = prop.at(time);
            let mesh = prop.shape.mesh();
            let mesh = if prop.ground { split(mesh) } else { mesh };
            let surface = Surface {
                positions: mesh.positions.iter().map(|point| key.point(*point)).collect(),
                normals: mesh.normals.iter().map(|normal| key.rotation * *normal).collect(),
                indices: mesh.indices.into(),
                color: prop.color,
                ..Surface::default()
            };
            if prop.ground {
                stage.ground.push((surface, key.rotation));
            } else {
                stage.things.push(surface);
            }
        }
        stage
    }

    /// Is the ground the flat one without an end?
    pub fn is_flat(&self) -> bool {
        self.ground.is_empty()
    }

    /// m, the highest ground at (x, z); 0 where there is none.
    pub fn height(&self, at: DVec2) -> f64 {
        let mut highest: Option<f64> = None;
        for (surface, _) in &self.ground {
            for triangle in surface.indices.chunks_exact(3) {
                let corners = [0, 1, 2].map(|corner| surface.positions.get(triangle[corner] as usize).copied());
                let [Some(a), Some(b), Some(c)] = corners else { continue };
                if let Some(y) = under(at, [a, b, c]) {
                    highest = Some(highest.map_or(y, |highest| highest.max(y)));
                }
            }
        }
        highest.unwrap_or(0.0)
    }
}

/// Does ground at a point hide what stands at `foot` from an eye? There it is cut open, before the body.
pub fn hides(point: DVec3, foot: DVec3, eye: DVec3) -> bool {
    let (sight, off) = (eye - foot, point - foot);
    let ahead = DVec2::new(sight.x, sight.z);
    let near = DVec2::new(off.x, off.z).dot(ahead.normalize_or_zero());
    near > CUT && off.y > 0.02 + (near - CUT) * sight.y / ahead.length().max(1e-6)
}

/// m, the height of a triangle over (x, z), if it is there.
fn under(at: DVec2, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let flat = |point: DVec3| DVec2::new(point.x, point.z);
    let (a2, b2, c2) = (flat(a), flat(b), flat(c));
    let low = a2.min(b2).min(c2);
    let high = a2.max(b2).max(c2);
    if at.x < low.x || at.y < low.y || at.x > high.x || at.y > high.y {
        return None;
    }
    let area = (b2 - a2).perp_dot(c2 - a2);
    if area.abs() < 1e-12 {
        return None;
    }
    let (u, v) = ((c2 - b2).perp_dot(at - b2) / area, (a2 - c2).perp_dot(at - c2) / area);
    let w = 1.0 - u - v;
    (u.min(v).min(w) >= -1e-9).then_some(a.y * u + b.y * v + c.y * w)
}

/// The same surface in triangles whose edges are short.
fn split(mesh: Mesh) -> Mesh {
    let mut whole = Mesh { positions: mesh.positions, normals: mesh.normals, indices: Vec::new() };
    let mut open: Vec<[u32; 3]> =
        mesh.indices.chunks_exact(3).map(|triangle| [triangle[0], triangle[1], triangle[2]]).collect();
    while let Some(triangle) = open.pop() {
        let at = |corner: usize| whole.positions[triangle[corner % 3] as usize];
        let lengths = [0, 1, 2].map(|corner| at(corner).distance(at(corner + 1)));
        let longest = (0..3).max_by(|a, b| lengths[*a].total_cmp(&lengths[*b])).unwrap_or(0);
        // A long way makes many pieces; a million are enough for any picture.
        if lengths[longest] <= LONGEST_EDGE || whole.positions.len() > 1_000_000 {
            whole.indices.extend(triangle);
            continue;
        }
        let [a, b, c] = [0, 1, 2].map(|corner| triangle[(longest + corner) % 3]);
        let middle = whole.positions.len() as u32;
        whole.positions.push((whole.positions[a as usize] + whole.positions[b as usize]) * 0.5);
        whole.normals.push((whole.normals[a as usize] + whole.normals[b as usize]).normalize_or(DVec3::Y));
        open.push([a, middle, c]);
        open.push([middle, b, c]);
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::props::Shape;

    #[test]
    fn a_split_box_has_the_height_of_its_top() {
        let mut mesh = Mesh::default();
        mesh.cuboid(DVec3::new(-2.0, -0.1, -3.0), DVec3::new(2.0, 0.3, 3.0));
        let prop = Prop { ground: true, ..Prop::standing("g", Shape::Mesh(mesh), [0.5; 3]) };
        let stage = Stage::at(&[prop], 0.0);
        assert!(stage.ground[0].0.indices.len() > 300 && !stage.is_flat());
        for at in [(0.0, 0.0), (1.9, -2.9), (-0.77, 2.31)] {
            assert!((stage.height(DVec2::from(at)) - 0.3).abs() < 1e-9, "{at:?}");
        }
        assert_eq!(stage.height(DVec2::new(5.0, 0.0)), 0.0);
    }
}
