//! The ground: its floors with edges (treads, strips between gaps), and all of it as rapier's colliders, for balls: plane, slope, floors, a
//! height field, a platform that turns.

use crate::model::scenario::GroundKind;
use crate::model::terrain::FIRST;
use crate::model::{Surface, Terrain};
use glam::{DQuat, DVec2, DVec3};
use rapier3d::parry::utils::Array2;
use rapier3d::prelude::*;

/// A piece of ground that may be moved.
pub(super) struct Piece {
    handle: RigidBodyHandle,
    moves: bool,
}

/// m, how thick the pieces are and how far they reach.
pub(super) const DEEP: f64 = 2.0;
pub(super) const FAR: f64 = 200.0;
/// m, so far ahead there are gaps.
const WALKED: f64 = 100.0;
/// m, half side of the height field of uneven ground, and of its cells.
const ROUGH: f64 = 15.0;
const CELL: f64 = 0.1;

/// A floor with edges: from z to z (m), its top at that height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tread {
    pub(super) span: [f64; 2],
    pub(super) top: f64,
}

/// The floors of ground with edges; none where it is a smooth surface.
pub(super) fn treads(terrain: &Terrain) -> Vec<Tread> {
    match terrain.kind {
        GroundKind::Stairs { rise, tread, count } => (0..=count)
            .map(|step| {
                let from = if step == 0 { -FAR } else { FIRST + tread * f64::from(step - 1) };
                let to = if step == count { FAR } else { FIRST + tread * f64::from(step) };
                Tread { span: [from, to], top: rise * f64::from(step) }
            })
            .collect(),
        GroundKind::Gaps { width, spacing } => {
            let first = Tread { span: [-FAR, FIRST], top: 0.0 };
            let floors = (0..((WALKED / spacing) as usize).min(500)).map(|gap| {
                let from = FIRST + spacing * gap as f64;
                Tread { span: [from + width, from + spacing], top: 0.0 }
            });
            std::iter::once(first).chain(floors).collect()
        }
        _ => Vec::new(),
    }
}

/// Puts the ground into the world.
pub(super) fn build(physics: &mut PhysicsWorld, terrain: &Terrain, groups: InteractionGroups) -> Vec<Piece> {
    let friction = terrain.friction.max(0.0) as f32;
    let dressed = |shape: ColliderBuilder| {
        shape.friction(friction).friction_combine_rule(CoefficientCombineRule::Min).collision_groups(groups)
    };
    let block = |half: DVec3| dressed(ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32));
    let still = RigidBodyBuilder::fixed;
    // A floor between two z, its top at that height.
    let level = |[from, to]: [f64; 2], top: f64| {
        let middle = DVec3::new(0.0, top - DEEP, 0.5 * (from + to));
        block(DVec3::new(FAR, DEEP, 0.5 * (to - from))).position(Pose::from_parts(vector(middle), Rotation::IDENTITY))
    };
    let mut pieces = Vec::new();
    match &terrain.kind {
        GroundKind::Platform { .. } => {
            let side = 0.5 * crate::model::terrain::PLATFORM_SIDE;
            let (handle, _) = physics.insert(
                RigidBodyBuilder::kinematic_position_based(),
                block(DVec3::new(side, 0.1, side))
                    .position(Pose::from_parts(vector(DVec3::NEG_Y * 0.1), Rotation::IDENTITY)),
            );
            pieces.push(Piece { handle, moves: true });
        }
        GroundKind::Slope { angle } => {
            let turn = DQuat::from_rotation_x(-angle);
            let at = turn * (DVec3::NEG_Y * DEEP);
            let body = RigidBodyBuilder::fixed().pose(Pose::from_parts(vector(at), rotation(turn)));
            let (handle, _) = physics.insert(body, block(DVec3::new(FAR, DEEP, FAR)));
            pieces.push(Piece { handle, moves: false });
        }
        GroundKind::Flat => {
            let (handle, _) = physics.insert(still(), level([-FAR, FAR], 0.0));
            pieces.push(Piece { handle, moves: false });
        }
        GroundKind::Stairs { .. } | GroundKind::Gaps { .. } => {
            let handle = physics.insert_body(still());
            for tread in treads(terrain) {
                physics.insert_collider(level(tread.span, tread.top), Some(handle));
            }
            pieces.push(Piece { handle, moves: false });
        }
        GroundKind::Mesh { surface, .. } => {
            let handle = physics.insert_body(still());
            if let Some(shape) = surface.as_ref().and_then(|surface| trimesh(surface)) {
                physics.insert_collider(dressed(shape), Some(handle));
            }
            pieces.push(Piece { handle, moves: false });
        }
        GroundKind::Uneven { .. } => {
            let handle = physics.insert_body(still());
            let count = (2.0 * ROUGH / CELL) as usize + 1;
            let at = |index: usize| -ROUGH + CELL * index as f64;
            let mut heights = Vec::with_capacity(count * count);
            for column in 0..count {
                heights.extend((0..count).map(|row| terrain.spot(DVec2::new(at(column), at(row))).height as f32));
            }
            let side = (CELL * (count - 1) as f64) as f32;
            let heights = Array2::new(count, count, heights);
            let field = ColliderBuilder::heightfield(heights, Vector::new(side, 1.0, side));
            physics.insert_collider(dressed(field), Some(handle));
            pieces.push(Piece { handle, moves: false });
        }
    }
    pieces
}

/// A mesh as a shape; `None` where it has no triangles.
fn trimesh(surface: &Surface) -> Option<ColliderBuilder> {
    let points = surface.triangles().iter().flatten().map(|corner| vector(*corner)).collect();
    let indices = (0..surface.len() as u32).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
    ColliderBuilder::trimesh(points, indices).ok()
}

/// Sends what moves to where it will be at `time`.
pub(super) fn turn(physics: &mut PhysicsWorld, pieces: &[Piece], terrain: &Terrain, time: f64) {
    for piece in pieces.iter().filter(|piece| piece.moves) {
        let pose = Pose::from_parts(Vector::ZERO, rotation(terrain.turn(time)));
        physics.bodies[piece.handle].set_next_kinematic_position(pose);
    }
}

pub(super) fn vector(v: DVec3) -> Vector {
    Vector::new(v.x as f32, v.y as f32, v.z as f32)
}

pub(super) fn double(v: Vector) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

pub(super) fn rotation(q: DQuat) -> Rotation {
    Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32)
}
