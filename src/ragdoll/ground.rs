//! The ground as colliders: plane, slope, treads, strips between gaps, a height field, a platform that turns.

use super::world::{rotation, vector};
use crate::model::Terrain;
use crate::model::scenario::GroundKind;
use glam::{DQuat, DVec3};
use rapier3d::prelude::*;

/// A piece of ground that may be moved.
pub(super) struct Piece {
    handle: RigidBodyHandle,
    moves: bool,
}

/// m, how thick the pieces are and how far they reach.
const DEEP: f64 = 2.0;
const FAR: f64 = 200.0;

/// Puts the ground into the world.
pub(super) fn build(physics: &mut PhysicsWorld, terrain: &Terrain, groups: InteractionGroups) -> Vec<Piece> {
    let friction = terrain.friction.max(0.0) as f32;
    let dressed = |shape: ColliderBuilder| {
        shape.friction(friction).friction_combine_rule(CoefficientCombineRule::Min).collision_groups(groups)
    };
    let block = |half: DVec3| dressed(ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32));
    let mut pieces = Vec::new();
    match &terrain.kind {
        GroundKind::Platform { .. } => {
            let side = 0.5 * crate::model::terrain::PLATFORM_SIDE;
            let (handle, _) = physics.insert(
                RigidBodyBuilder::kinematic_position_based(),
                block(DVec3::new(side, 0.1, side)).position(Pose::from_parts(vector(DVec3::NEG_Y * 0.1), Rotation::IDENTITY)),
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
        _ => {
            let body = RigidBodyBuilder::fixed().translation(vector(DVec3::NEG_Y * DEEP));
            let (handle, _) = physics.insert(body, block(DVec3::new(FAR, DEEP, FAR)));
            pieces.push(Piece { handle, moves: false });
        }
    }
    pieces
}

/// Sends what moves to where it will be at `time`.
pub(super) fn turn(physics: &mut PhysicsWorld, pieces: &[Piece], terrain: &Terrain, time: f64) {
    for piece in pieces.iter().filter(|piece| piece.moves) {
        let pose = Pose::from_parts(Vector::ZERO, rotation(terrain.turn(time)));
        physics.bodies[piece.handle].set_next_kinematic_position(pose);
    }
}
