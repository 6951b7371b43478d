//! The body that is simulated and posed: humanoid joints, mass segments and soles, in scenario space at rest.
//!
//! Metres, kilograms, Y up, Z forward, X left, the ground at y = 0 under the soles. "Rest" is the bind pose of the rig
//! (whatever it is: T, A, arms down), turned to face +Z and standing on the ground. A pose turns each joint by a
//! rotation *from rest in scenario axes*, so a rig's local bone axes never matter here. Knows no nodes and no files.

use super::role::Role;
use glam::{DMat3, DQuat, DVec2, DVec3};

/// Left or right. Index arrays of two with `side as usize`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// +X.
    Left = 0,
    /// -X.
    Right = 1,
}

impl Side {
    /// Left, then right.
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];

    /// For a person.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
        }
    }

    /// The other one.
    pub fn other(self) -> Side {
        match self {
            Side::Left => Side::Right,
            Side::Right => Side::Left,
        }
    }

    /// +1 for left, -1 for right: the sign of X on that side.
    pub fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// A humanoid of rigid segments. Joint 0 is the hips; parents come before children.
#[derive(Clone, Debug)]
pub struct Body {
    /// Roles found in the rig, and those extrapolated because the body needs them (always: hips, spine, head, upper
    /// and lower arms and legs, hands, feet). Fingers, eyes and jaw are joints too where the rig has them.
    pub joints: Vec<BodyJoint>,
    /// Masses; their sum is `mass`.
    pub segments: Vec<Segment>,
    /// Left and right foot.
    pub feet: [FootShape; 2],
    /// kg, whole body.
    pub mass: f64,
    /// m, ground to the top of the head at rest.
    pub height: f64,
    /// m, mean over both legs of hip to knee plus knee to ankle.
    pub leg_length: f64,
    /// m, left and right, from the middle plane at rest: how far out the middle of a hanging hand must be to clear the
    /// hips, the thighs and what they wear. 0 without a mesh.
    pub flanks: [f64; 2],
    /// m, at rest: how far the mesh of the trunk reaches ahead of the hips joint, at the waist. 0 without a mesh.
    pub belly: f64,
    /// Boxes around the mesh of its parts, but feet; a part that has too little mesh has none.
    pub flesh: Vec<Flesh>,
}

/// The room that a part of the body takes up: an oriented box that moves with a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flesh {
    /// Index into `Body::joints`.
    pub joint: usize,
    /// m, from the joint to the box's middle, at rest.
    pub middle: DVec3,
    /// m, half sides: across the bone, along it, and square to both.
    pub half: DVec3,
    /// From the box's axes to the scenario's, at rest.
    pub turn: DQuat,
}

/// One joint of the body.
#[derive(Clone, Debug)]
pub struct BodyJoint {
    /// Its part in the humanoid.
    pub role: Role,
    /// Index into `Body::joints`, smaller than its own; `None` for the hips only.
    pub parent: Option<usize>,
    /// m, scenario space, at rest.
    pub rest: DVec3,
    /// False where no node of the rig moves with it (an extrapolated hand, foot or toe): then it must keep its parent's
    /// rotation, since no clip could show another.
    pub animated: bool,
}

/// A rigid mass that moves with one joint (de Leva 1996).
#[derive(Clone, Debug)]
pub struct Segment {
    /// Index into `Body::joints`.
    pub joint: usize,
    /// kg.
    pub mass: f64,
    /// m, from the joint to the segment's centre of mass, at rest.
    pub centre: DVec3,
    /// kg m², about the segment's centre of mass, scenario axes, at rest.
    pub inertia: DMat3,
}

/// A foot's sole.
///
/// A bind pose may hold a foot pitched or rolled (mid-stride, on tiptoe). `level` is the turn from rest that lays its
/// sole flat; `ankle_height`, `forward`, `heel`, `ball`, `tip` and `half_width` are measured in that **levelled** frame
/// (scenario axes, origin at the ankle, the foot turned by `level` and the toes by `toe_level`): there the ground is
/// `y = -ankle_height`. `rear_sole` and `front_sole` are offsets from the ankle **at rest**, unturned; so the levelled
/// place of a rear vertex is `level * v`, and of a front vertex, where there is a toe joint at rest offset t,
/// `level * t + toe_level * (v - t)`.
#[derive(Clone, Debug)]
pub struct FootShape {
    /// Index of the foot (ankle) joint.
    pub ankle: usize,
    /// Index of the toe joint, where there is one that a node moves and that bends the sole.
    pub toe: Option<usize>,
    /// The foot joint's turn from rest (scenario axes) that makes the sole level. The identity where the foot is level
    /// within 3 degrees at rest.
    pub level: DQuat,
    /// The toe joint's turn from rest (scenario axes, as `level`: not relative to the foot) that makes the front of the
    /// sole level too. Equal to `level` where the toe is straight at rest or there is no toe joint.
    pub toe_level: DQuat,
    /// m, ankle joint over the sole, levelled.
    pub ankle_height: f64,
    /// Unit, horizontal, levelled: from heel to toe tip, (x, z).
    pub forward: DVec2,
    /// m, along `forward` from the ankle, levelled: rearmost point of the sole (negative).
    pub heel: f64,
    /// m, along `forward` from the ankle, levelled: the line over which the foot bends (the toe joint, or 0.72 of the sole).
    pub ball: f64,
    /// m, along `forward` from the ankle, levelled: foremost point of the sole; of a foot without toe joint the foremost that bears.
    pub tip: f64,
    /// m, half of the sole's width at the ball.
    pub half_width: f64,
    /// Sole vertices (from the mesh, thinned; made from the outline where there is no mesh), offset from the ankle at
    /// rest. Behind the ball line they move with the foot joint.
    pub rear_sole: Vec<DVec3>,
    /// Ahead of the ball line they move with the toe joint where there is one (offset still from the ankle).
    pub front_sole: Vec<DVec3>,
}

impl FootShape {
    /// m, along `forward` from the ankle, levelled: where the sole ends for a body that leans on it, its bevel with it. A
    /// stiff foot turns about `tip` only, the foremost point that bears.
    pub fn foremost(&self) -> f64 {
        if self.toe.is_some() {
            return self.tip;
        }
        let along = |vertex: &DVec3| {
            let levelled = self.level * *vertex;
            levelled.x * self.forward.x + levelled.z * self.forward.y
        };
        self.front_sole.iter().map(along).fold(self.tip, f64::max)
    }

    /// The rearmost point of the sole that a raised forefoot turns about: an offset from the ankle at rest, rigid with the
    /// foot joint. A heel's rounded back hangs over the ground and holds nothing, so height counts against it.
    pub fn heel_point(&self) -> DVec3 {
        let lateness = |vertex: &DVec3| {
            let levelled = self.level * *vertex;
            let over = (levelled.y + self.ankle_height).max(0.0);
            levelled.x * self.forward.x + levelled.z * self.forward.y + HEEL_ROUNDING * over
        };
        self.rear_sole.iter().min_by(|a, b| lateness(a).total_cmp(&lateness(b))).copied().unwrap_or_else(|| {
            let back = self.forward * self.heel;
            self.level.inverse() * DVec3::new(back.x, -self.ankle_height, back.y)
        })
    }
}

/// How much further back a vertex must lie for each unit that it is over the ground, to be the heel's point: a
/// few millimetres of height would show as a foot that hovers through its heel strike.
const HEEL_ROUNDING: f64 = 8.0;

impl Body {
    /// Index of that role's joint.
    pub fn joint(&self, role: Role) -> Option<usize> {
        self.joints.iter().position(|joint| joint.role == role)
    }

    /// The same body with another mass, every segment in proportion.
    pub fn with_mass(&self, mass: f64) -> Body {
        let factor = mass / self.mass;
        let mut body = self.clone();
        for segment in &mut body.segments {
            segment.mass *= factor;
            segment.inertia *= factor;
        }
        body.mass = mass;
        body
    }

    /// The rest offset of a joint from its parent's joint, m; its own rest position for the hips.
    pub fn offset(&self, joint: usize) -> DVec3 {
        match self.joints[joint].parent {
            Some(parent) => self.joints[joint].rest - self.joints[parent].rest,
            None => self.joints[joint].rest,
        }
    }
}
