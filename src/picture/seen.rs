//! What a baked file says that stood around its clip: the nodes that were written with `--props`, else the planes that
//! its contacts name. Scenario space, metres.
//!
//! Planes tell treads and slopes where feet were, no more: between two treads the edge is half-way, and ground that turns
//! is not known without its node.

use crate::model::props::{Mesh, Prop, PropKey, Shape};
use crate::model::{Clip, ClipReport};
use crate::rig::Rig;
use crate::rig::mesh::{attribute, vec3s};
use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use gltf::Semantic;
use gltf::json::Material;
use serde_json::Value;

/// m around what was stepped on.
const AROUND: f64 = 2.0;
/// m around a contact on ground that is neither a plane nor stairs.
const PATCH: f64 = 0.25;
/// m, how thick ground is drawn.
const THICK: f64 = 0.05;
/// m, planes that differ by less under their contacts are one.
const SAME: f64 = 0.006;
/// 1/s, how often a node that moves is looked at.
const RATE: f64 = 30.0;
/// Linear RGB where a file names none.
const STONE: [f32; 3] = [0.32, 0.34, 0.36];
/// What nodes are called that feet stand on.
const GROUNDS: [&str; 5] = ["ground", "slope", "stairs", "slabs", "platform"];

/// What stands beside the body in a clip of the rig's own file; no ground where it is level and at 0.
pub fn seen_in_file(rig: &Rig, clip: &Clip, report: &ClipReport) -> Vec<Prop> {
    let mut props = nodes(rig, clip);
    if !props.iter().any(|prop| prop.ground) {
        props.extend(planes(rig, report));
    }
    props.retain(|prop| !(prop.ground && is_level(prop)));
    props
}

/// Is it what is drawn without a prop too?
fn is_level(prop: &Prop) -> bool {
    let Shape::Mesh(mesh) = &prop.shape else { return false };
    let level = |(point, normal): (&DVec3, &DVec3)| normal.y < 0.9 || (point.y.abs() < 1e-6 && normal.y > 1.0 - 1e-9);
    prop.name == GROUNDS[0] && mesh.positions.iter().zip(&mesh.normals).all(level)
}

/// The nodes that are marked as props, where the clip has them.
fn nodes(rig: &Rig, clip: &Clip) -> Vec<Prop> {
    let marked = |node: &Value| node.pointer("/extras/surefoot/prop") == Some(&Value::Bool(true));
    let list = rig.document.list("nodes");
    let found: Vec<usize> = (0..list.len().min(rig.nodes.len())).filter(|&index| marked(&list[index])).collect();
    if found.is_empty() {
        return Vec::new();
    }
    let mut sampler = rig.sampler(clip);
    sampler.limit_to(&found);
    let count = (clip.duration * RATE).ceil().clamp(0.0, 1e5) as usize;
    let mut keys: Vec<Vec<PropKey>> = vec![Vec::new(); found.len()];
    for index in 0..=count {
        let time = (index as f64 / RATE).min(clip.duration);
        let globals = sampler.node_globals(time);
        for (keys, &node) in keys.iter_mut().zip(&found) {
            keys.push(key(&globals[node], time));
        }
    }
    let props = found.iter().zip(keys).filter_map(|(&node, keys)| {
        let name = rig.nodes[node].name.clone().unwrap_or_default();
        let (mesh, color) = mesh(rig, rig.nodes[node].mesh?)?;
        let ground = GROUNDS.contains(&name.as_str());
        Some(Prop { name, shape: Shape::Mesh(mesh), color, ground, keys })
    });
    props.collect()
}

/// A prop's place from its node's.
fn key(global: &DAffine3, time: f64) -> PropKey {
    let axes = [global.matrix3.x_axis, global.matrix3.y_axis, global.matrix3.z_axis];
    let scale = DVec3::from(axes.map(DVec3::length));
    let turn = DMat3::from_cols(axes[0] / scale.x, axes[1] / scale.y, axes[2] / scale.z);
    let rotation = if scale.min_element() > 1e-9 { DQuat::from_mat3(&turn) } else { DQuat::IDENTITY };
    PropKey { time, translation: global.translation, rotation, scale }
}

/// The triangles of a mesh's first primitive and their colour; `None` where they cannot be read.
fn mesh(rig: &Rig, mesh: usize) -> Option<(Mesh, [f32; 3])> {
    let document = &rig.document;
    let drawn: gltf::json::Mesh = document.typed("meshes", mesh, "mesh").ok()?;
    let primitive = drawn.primitives.first()?;
    let vectors = |semantic: Semantic| vec3s(document, attribute(primitive, semantic)?, "a prop").ok();
    let (positions, normals) = (vectors(Semantic::Positions)?, vectors(Semantic::Normals)?);
    let indices = document.read_indices(primitive.indices?.value(), "indices").ok()?;
    let whole = positions.len() == normals.len() && indices.iter().all(|&index| (index as usize) < positions.len());
    let material =
        primitive.material.and_then(|at| document.typed::<Material>("materials", at.value(), "material").ok());
    let color = material.map_or(STONE, |material| {
        let [red, green, blue, _] = material.pbr_metallic_roughness.base_color_factor.0;
        [red, green, blue]
    });
    whole.then_some((Mesh { positions, normals, indices }, color))
}

/// A plane that feet stood on, and where.
struct Plane {
    point: DVec3,
    normal: DVec3,
    low: DVec2,
    high: DVec2,
}

impl Plane {
    fn height(&self, at: DVec2) -> f64 {
        let off = at - DVec2::new(self.point.x, self.point.z);
        self.point.y - (self.normal.x * off.x + self.normal.z * off.y) / self.normal.y
    }

    /// A slab of it over a patch.
    fn slab(&self, mesh: &mut Mesh, low: DVec2, high: DVec2, thick: f64) {
        let corners = [(low.x, low.y), (low.x, high.y), (high.x, high.y), (high.x, low.y)];
        let [a, b, c, d] = corners.map(|(x, z)| DVec3::new(x, self.height(DVec2::new(x, z)), z));
        let under = |point: DVec3| point - DVec3::Y * thick;
        mesh.quad([a, b, c, d]);
        mesh.quad([under(a), under(d), under(c), under(b)]);
        for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
            mesh.quad([under(from), under(to), to, from]);
        }
    }
}

/// Ground made of the planes of the contacts, in the order of the first step on each.
fn planes(rig: &Rig, report: &ClipReport) -> Option<Prop> {
    let similarity = &rig.document_from_scenario;
    let mut planes: Vec<Plane> = Vec::new();
    let mut contacts: Vec<_> = report.contacts.iter().filter(|contact| contact.frame == "world").collect();
    contacts.sort_by(|a, b| a.start.total_cmp(&b.start));
    for contact in contacts {
        let point = similarity.inverse_point(DVec3::from(contact.position));
        let normal = similarity.rotation.inverse() * DVec3::from(contact.normal);
        if !(point + normal).is_finite() || normal.y < 0.1 {
            continue;
        }
        let (at, normal) = (DVec2::new(point.x, point.z), normal.normalize());
        let same =
            |plane: &&mut Plane| plane.normal.angle_between(normal) < 0.01 && (plane.height(at) - point.y).abs() < SAME;
        match planes.iter_mut().find(same) {
            Some(plane) => (plane.low, plane.high) = (plane.low.min(at), plane.high.max(at)),
            None => planes.push(Plane { point, normal, low: at, high: at }),
        }
    }
    let mut mesh = Mesh::default();
    let (low, high) = planes
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), plane| (low.min(plane.low), high.max(plane.high)));
    let (low, high) = (low - AROUND, high + AROUND);
    let name = match planes.as_slice() {
        [] => return None,
        [one] if one.normal.y > 1.0 - 1e-6 && one.point.y.abs() < SAME => return None,
        [one] => {
            one.slab(&mut mesh, low, high, THICK);
            "slope"
        }
        all if all.iter().all(|plane| plane.normal.y > 1.0 - 1e-6) => {
            treads(&mut mesh, all, (low, high), rig.body.height);
            "stairs"
        }
        all => {
            for plane in all {
                plane.slab(&mut mesh, plane.low - PATCH, plane.high + PATCH, THICK);
            }
            "slabs"
        }
    };
    Some(Prop { ground: true, ..Prop::standing(name, Shape::Mesh(mesh), STONE) })
}

/// Level slabs one after the other along the axis on which they lie apart, down to the lowest.
fn treads(mesh: &mut Mesh, planes: &[Plane], (low, high): (DVec2, DVec2), height: f64) {
    let middle = |plane: &Plane| (plane.low + plane.high) * 0.5;
    let (first, last) = (middle(&planes[0]), middle(&planes[planes.len() - 1]));
    let axis = usize::from((last - first).y.abs() >= (last - first).x.abs());
    let on = (last - first)[axis].signum();
    let floor = planes.iter().map(|plane| plane.point.y).fold(f64::INFINITY, f64::min) - THICK;
    let mut order: Vec<&Plane> = planes.iter().collect();
    order.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    // contacts name the ankle's place: the middle of a sole is a little farther on
    let edge = |a: &Plane, b: &Plane| 0.5 * (a.high[axis] + b.low[axis]) + on * 0.035 * height;
    for (index, plane) in order.iter().enumerate() {
        let (mut from, mut to) = (low, high);
        if index > 0 {
            from[axis] = edge(order[index - 1], plane);
        }
        if let Some(next) = order.get(index + 1) {
            to[axis] = edge(plane, next);
        }
        if to[axis] > from[axis] {
            plane.slab(mesh, from, to, plane.point.y - floor);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;

    fn level(y: f64, from: f64, to: f64) -> Plane {
        let (low, high) = (DVec2::new(-0.1, from), DVec2::new(0.1, to));
        Plane { point: DVec3::new(0.0, y, from), normal: DVec3::Y, low, high }
    }

    #[test]
    fn treads_are_as_high_as_their_planes_and_leave_no_gap() {
        let planes = [level(0.0, 0.0, 0.7), level(0.17, 1.1, 1.1), level(0.34, 1.4, 2.5)];
        let mut mesh = Mesh::default();
        treads(&mut mesh, &planes, (DVec2::splat(-2.0), DVec2::splat(4.5)), 1.7);
        let prop = Prop { ground: true, ..Prop::standing("stairs", Shape::Mesh(mesh), STONE) };
        let stage = super::super::Stage::at(&[prop], 0.0);
        for (z, height) in [(-1.0, 0.0), (0.7, 0.0), (1.12, 0.17), (1.42, 0.34), (4.0, 0.34)] {
            assert!((stage.height(DVec2::new(0.3, z)) - height).abs() < 1e-9, "{z}");
        }
    }

    #[test]
    fn a_plane_knows_its_height_beside_its_point() {
        let angle = 0.2_f64;
        let normal = DVec3::new(0.0, real::cos(angle), -real::sin(angle));
        let plane = Plane { point: DVec3::new(0.0, 1.0, 2.0), normal, low: DVec2::ZERO, high: DVec2::ZERO };
        assert!((plane.height(DVec2::new(5.0, 3.0)) - 1.0 - real::tan(angle)).abs() < 1e-12);
    }
}
