//! The rigid-body world: the figure as a multibody, the ground and what else there is, stepped by rapier.
//!
//! Scenario space, SI units. Springs and damping of the joints are integrated implicitly (what stands at 10 ms); feed-forward
//! enters through the springs' rests. This is the only file that names the engine's types beside `ground` and `things`.

use super::figure::{Figure, Freedom, Part};
use super::ground;
use super::things::{Held, Sphere};
use crate::model::{Side, Terrain};
use glam::{DMat3, DQuat, DVec3};
use rapier3d::prelude::*;

/// Contacts between the body and the world only, never among the body's parts.
const BODY: InteractionGroups =
    InteractionGroups::new(Group::GROUP_1, Group::GROUP_2.union(Group::GROUP_3), InteractionTestMode::And);
/// What stands still.
pub(super) const GROUND: InteractionGroups =
    InteractionGroups::new(Group::GROUP_2, Group::GROUP_1.union(Group::GROUP_3), InteractionTestMode::And);

/// m from the origin, m/s and m of a joint's gap: beyond, the simulation has broken down.
const FARTHEST: f64 = 100.0;
pub(super) const FASTEST: f64 = 100.0;
const TORN: f64 = 0.05;

/// Where a link is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkState {
    /// m, the link's origin.
    pub origin: DVec3,
    /// Turn from the stand.
    pub turn: DQuat,
    /// m/s, of the link's centre of mass.
    pub velocity: DVec3,
    /// rad/s.
    pub spin: DVec3,
}

/// What a joint does in a tick: a spring towards `rest` and a damper, both implicit, in the parent's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointDrive {
    /// N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    pub damping: f64,
    /// rad from where the joint is now: what the spring pulls towards, a rotation vector in the parent's frame; of a hinge along its axis.
    pub ahead: DVec3,
    /// N m/rad and N m s/rad about the stiff axis.
    pub stiff: [f64; 2],
}

/// The world.
pub struct World {
    pub(super) physics: PhysicsWorld,
    /// s, length of a tick.
    pub dt: f64,
    pub(super) links: Vec<RigidBodyHandle>,
    pub(super) boxes: Vec<ColliderHandle>,
    pub(super) spheres: Vec<Sphere>,
    pub(super) held: Option<Held>,
    pub(super) offsets: Vec<DVec3>, // m, by which the law's centre of a link is beside the engine's, link's frame
    frames: Vec<DQuat>,             // a hinge's frame: its axis as x
    ground: Vec<ground::Piece>,
    root: MultibodyJointHandle,
}

impl World {
    /// The figure placed so, at rest, on that ground.
    pub fn new(figure: &Figure, placed: &[(DVec3, DQuat)], terrain: &Terrain, dt: f64, iterations: usize) -> World {
        let mut physics = PhysicsWorld::new();
        physics.gravity = vector(DVec3::NEG_Y * 9.81);
        physics.integration_parameters.num_solver_iterations = iterations;
        physics.integration_parameters.contact_recycling = false;
        // The engine's CCD would hold single fast links back against their joints; contacts are found without it.
        physics.integration_parameters.max_ccd_substeps = 0;
        physics.integration_parameters.friction_model = FrictionModel::Coulomb;
        let (mut links, mut boxes, mut frames) = (Vec::new(), Vec::new(), Vec::new());
        let mut root = None;
        for (index, (link, (origin, turn))) in figure.links.iter().zip(placed).enumerate() {
            let mass = MassProperties::with_inertia_matrix(
                vector(link.centre),
                link.mass as f32,
                matrix(link.inertia + DMat3::IDENTITY * (1e-6 * link.mass)),
            );
            let body = RigidBodyBuilder::dynamic()
                .pose(Pose::from_parts(vector(*origin), rotation(*turn)))
                .additional_mass_properties(mass)
                .can_sleep(false);
            let (half, middle) = above_legs(figure, index);
            let collider = shape_of(link.part, half)
                .position(Pose::from_parts(vector(middle), rotation(link.turn)))
                .density(0.0)
                .friction(terrain.friction.max(0.0) as f32)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(BODY);
            let (handle, shape) = physics.insert(body, collider);
            let axis = match link.freedom {
                Freedom::Hinge { axis, .. } => DQuat::from_rotation_arc(DVec3::X, axis),
                _ => DQuat::IDENTITY,
            };
            if let Some(parent) = link.parent {
                let joint = joint_of(link.freedom, link.anchor, axis);
                root = physics.multibody_joints.insert(links[parent], handle, joint, true).or(root);
            }
            links.push(handle);
            boxes.push(shape);
            frames.push(axis);
        }
        let ground = ground::build(&mut physics, terrain, GROUND);
        let root = root.unwrap_or(MultibodyJointHandle::invalid());
        let offsets = vec![DVec3::ZERO; figure.links.len()];
        let mut world =
            World { physics, dt, links, boxes, spheres: Vec::new(), held: None, offsets, frames, ground, root };
        world.place(figure, placed);
        // Masses are known after a step: one that moves nothing.
        world.physics.integration_parameters.dt = 1e-6;
        world.physics.step();
        world.physics.integration_parameters.dt = dt as f32;
        world
    }

    /// Turns the joints to where the links are wanted.
    fn place(&mut self, figure: &Figure, placed: &[(DVec3, DQuat)]) {
        let Some((multibody, _)) = self.physics.multibody_joints.get_mut(self.root) else { return };
        let mut displacements = vec![0.0_f32; multibody.ndofs()];
        let mut at = 6;
        for (index, link) in figure.links.iter().enumerate().skip(1) {
            let parent = link.parent.unwrap_or(0);
            let turn = (placed[parent].1.inverse() * placed[index].1).to_scaled_axis();
            match link.freedom {
                Freedom::Hinge { axis, .. } => {
                    displacements[at] = turn.dot(axis) as f32;
                    at += 1;
                }
                _ => {
                    displacements[at..at + 3].copy_from_slice(&[turn.x as f32, turn.y as f32, turn.z as f32]);
                    at += 3;
                }
            }
        }
        // The root takes its body's own pose; before the first step it may still count as a joint without freedom.
        multibody.forward_kinematics(&self.physics.bodies, true);
        multibody.apply_displacements(&displacements);
        multibody.forward_kinematics(&self.physics.bodies, true);
        multibody.update_rigid_bodies(&mut self.physics.bodies, true);
    }

    /// Where the links are.
    pub fn read(&self, states: &mut Vec<LinkState>) {
        states.clear();
        states.extend(self.links.iter().zip(&self.offsets).map(|(handle, offset)| {
            let body = &self.physics.bodies[*handle];
            let pose = body.position();
            let turn = pose.rotation;
            let turn = DQuat::from_xyzw(turn.x.into(), turn.y.into(), turn.z.into(), turn.w.into()).normalize();
            let spin = double(body.angvel());
            let velocity = double(body.linvel()) + spin.cross(turn * *offset);
            LinkState { origin: double(pose.translation), turn, velocity, spin }
        }));
    }

    /// What is wrong with the links, for a person: a number that is none, a part that flew away, was torn off, or is faster than
    /// any body; `None` where all is well.
    pub fn broken(figure: &Figure, states: &[LinkState]) -> Option<String> {
        for (index, (link, state)) in figure.links.iter().zip(states).enumerate() {
            let name = link.part.name();
            let finite = state.origin.is_finite() && state.turn.is_finite();
            if !finite || !state.velocity.is_finite() || !state.spin.is_finite() {
                return Some(format!("the place of the {name} is not a finite number"));
            }
            if state.origin.length() > FARTHEST {
                return Some(format!("the {name} left the world ({:.0} m away)", state.origin.length()));
            }
            if state.velocity.length() > FASTEST {
                return Some(format!("the {name} moves at {:.0} m/s", state.velocity.length()));
            }
            let joint = link.parent.map(|parent| states[parent].origin + states[parent].turn * link.anchor);
            let gap = joint.map_or(0.0, |joint| joint.distance(state.origin));
            if index > 0 && gap > TORN {
                return Some(format!("the joint of the {name} came apart by {:.0} cm", gap * 100.0));
            }
        }
        None
    }

    /// Sets what the joint of a link does in the next tick.
    pub fn drive(&mut self, figure: &Figure, link: usize, drive: &JointDrive) {
        let frame = self.frames[link];
        let Some(id) = self.physics.multibody_joints.rigid_body_link(self.links[link]).copied() else { return };
        let Some(multibody) = self.physics.multibody_joints.get_multibody_mut(id.multibody) else { return };
        let Some(part) = multibody.link_mut(id.id) else { return };
        let assembly = part.assembly_id();
        let coords = part.joint.coords();
        let freedom = figure.links[link].freedom;
        let axes: &[usize] = if matches!(freedom, Freedom::Hinge { .. }) { &[0] } else { &[0, 1, 2] };
        let ahead = frame.inverse() * drive.ahead;
        let mut damping = [0.0; 3];
        for axis in axes {
            let held = matches!(freedom, Freedom::Ball { stiff: Some(stiff) } if stiff == *axis);
            let [k, d] = if held { drive.stiff } else { [drive.stiffness, drive.damping] };
            part.joint.set_spring(3 + axis, k as f32, coords[3 + axis] + ahead[*axis] as f32);
            damping[*axis] = d;
        }
        for (offset, axis) in axes.iter().enumerate() {
            multibody.damping_mut()[assembly + offset] = damping[*axis] as f32;
        }
    }

    /// Sets each axis of a joint apart: a spring towards `ahead` (rad from where it is, the parent's frame) and a damper.
    pub fn loosen(&mut self, figure: &Figure, link: usize, stiffness: DVec3, damping: DVec3, ahead: DVec3) {
        let Some(id) = self.physics.multibody_joints.rigid_body_link(self.links[link]).copied() else { return };
        let Some(multibody) = self.physics.multibody_joints.get_multibody_mut(id.multibody) else { return };
        let Some(part) = multibody.link_mut(id.id) else { return };
        let assembly = part.assembly_id();
        let coords = part.joint.coords();
        match figure.links[link].freedom {
            Freedom::Hinge { axis, .. } => {
                part.joint.set_spring(3, stiffness.x as f32, coords[3] + ahead.dot(axis) as f32);
                multibody.damping_mut()[assembly] = damping.x as f32;
            }
            _ => {
                for axis in 0..3 {
                    part.joint.set_spring(3 + axis, stiffness[axis] as f32, coords[3 + axis] + ahead[axis] as f32);
                }
                for axis in 0..3 {
                    multibody.damping_mut()[assembly + axis] = damping[axis] as f32;
                }
            }
        }
    }

    /// Lets all forces of the last tick go.
    pub fn clear_forces(&mut self) {
        for handle in &self.links {
            let body = &mut self.physics.bodies[*handle];
            body.reset_forces(false);
            body.reset_torques(false);
        }
    }

    /// A force on a link at a point of scenario space, and a torque, for the next tick.
    pub fn push(&mut self, link: usize, force: DVec3, point: DVec3, torque: DVec3) {
        let body = &mut self.physics.bodies[self.links[link]];
        body.add_force_at_point(vector(force), vector(point), true);
        body.add_torque(vector(torque), true);
    }

    /// One tick; the ground stands as it will at `time` (s) at its end.
    pub fn step(&mut self, terrain: &Terrain, time: f64) {
        ground::turn(&mut self.physics, &self.ground, terrain, time);
        self.physics.step();
    }

    /// N s, what the ground pressed on a link's box in the last tick.
    pub fn pressed(&self, link: usize) -> f64 {
        let still = |handle: ColliderHandle| {
            let groups = self.physics.colliders.get(handle).map(|collider| collider.collision_groups().memberships);
            groups.is_some_and(|groups| groups.contains(Group::GROUP_2))
        };
        self.physics
            .narrow_phase
            .contact_pairs_with(self.boxes[link])
            .filter(|pair| still(pair.collider1) || still(pair.collider2))
            .map(|pair| f64::from(pair.total_impulse_magnitude()))
            .sum()
    }

    /// A link other than a foot that bears on the ground; shanks only where the knee is down.
    pub fn lies_on(&self, figure: &Figure, states: &[LinkState], terrain: &Terrain) -> Option<usize> {
        let least = 0.03 * figure.mass * 9.81 * self.dt;
        (0..figure.links.len()).find(|index| {
            let at = states[*index].origin;
            let knee = || at.y - terrain.spot(glam::DVec2::new(at.x, at.z)).height < 0.2 * figure.leg_length;
            match figure.links[*index].part {
                Part::Foot(_) => false,
                Part::Shank(_) => knee() && self.pressed(*index) > least,
                _ => self.pressed(*index) > least,
            }
        })
    }

    /// Is either foot's box pressed: left, right.
    pub fn feet_pressed(&self, figure: &Figure) -> [bool; 2] {
        Side::BOTH.map(|side| self.pressed(figure.legs[side as usize][2]) > 0.0)
    }
}

/// Half sides and middle of a link's box. A pelvis whose joint is far below the hips (a root on the floor) reaches down to
/// under the hips only: it would scrape along the ground.
fn above_legs(figure: &Figure, index: usize) -> (DVec3, DVec3) {
    let link = &figure.links[index];
    let (mut half, mut middle) = (link.half, link.middle);
    if index == 0 {
        let hips = figure.legs.map(|leg| figure.links[leg[0]].anchor.y);
        let (low, high) = (middle.y - half.y, middle.y + half.y);
        let least = (hips[0].min(hips[1]) - 0.2 * figure.leg_length).min(high - 0.1 * figure.leg_length);
        if low < least {
            (half.y, middle.y) = (0.5 * (high - least), 0.5 * (high + least));
        }
    }
    (half, middle)
}

/// A foot is a box, the rest are capsules along their longest side.
fn shape_of(part: Part, half: DVec3) -> ColliderBuilder {
    match part {
        Part::Foot(_) => ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32),
        _ => ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32),
    }
}

fn joint_of(freedom: Freedom, anchor: DVec3, axis: DQuat) -> GenericJoint {
    let locked = match freedom {
        Freedom::Hinge { .. } => JointAxesMask::LOCKED_REVOLUTE_AXES,
        _ => JointAxesMask::LOCKED_SPHERICAL_AXES,
    };
    let mut joint = GenericJointBuilder::new(locked)
        .local_frame1(Pose::from_parts(vector(anchor), rotation(axis)))
        .local_frame2(Pose::from_parts(Vector::ZERO, rotation(axis)))
        .contacts_enabled(false)
        .build();
    if let Freedom::Hinge { range, .. } = freedom {
        joint.set_limits(JointAxis::AngX, [range[0] as f32, range[1] as f32]);
    }
    joint
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

fn matrix(m: DMat3) -> Matrix {
    Matrix::from_cols(vector(m.x_axis), vector(m.y_axis), vector(m.z_axis))
}
