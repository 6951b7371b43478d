//! The articulated body as plain data: links with masses, boxes and joints, read from a body in its natural stand.
//!
//! Metres, kilograms, scenario axes. A link's frame has its origin at the joint to its parent and the scenario's axes in the
//! stand, so a link's rotation is its turn from the stand. Joints follow the 30 degrees of freedom of the method's table;
//! a joint of two angles is a ball with a stiff third, for the engine knows joints of one and of three. Knows no engine. Masses and
//! boxes are worked out in `bulk`.

use super::sole;
use super::toes;
use crate::maths::real;
use crate::measure::joints::{JointAxes, LegAngles};
use crate::model::{Body, BodyPose, Role, Side};
use glam::{DMat3, DQuat, DVec3};

/// What a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "parts of a body")]
pub enum Part {
    Pelvis,
    Trunk,
    Head,
    UpperArm(Side),
    Forearm(Side),
    Hand(Side),
    Thigh(Side),
    Shank(Side),
    Foot(Side),
    Toes(Side),
}

impl Part {
    /// For a person.
    pub fn name(self) -> String {
        let of = |side: Side, what: &str| match side {
            Side::Left => format!("left {what}"),
            Side::Right => format!("right {what}"),
        };
        match self {
            Part::Pelvis => "pelvis".into(),
            Part::Trunk => "trunk".into(),
            Part::Head => "head".into(),
            Part::UpperArm(side) => of(side, "upper arm"),
            Part::Forearm(side) => of(side, "forearm"),
            Part::Hand(side) => of(side, "hand"),
            Part::Thigh(side) => of(side, "thigh"),
            Part::Shank(side) => of(side, "shank"),
            Part::Foot(side) => of(side, "foot"),
            Part::Toes(side) => of(side, "toes"),
        }
    }
}

/// How a link may turn against its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// The root.
    Free,
    /// Three angles; about one of them (an axis of the parent's frame) it is held stiffly where that is set.
    Ball {
        /// 0 x, 1 y, 2 z.
        stiff: Option<usize>,
    },
    /// One angle about an axis of both frames, a unit vector; positive bends.
    Hinge {
        /// In the parent's frame.
        axis: DVec3,
        /// rad, least and most from the stand.
        range: [f64; 2],
    },
}

/// One rigid body.
#[derive(Clone, Debug)]
pub struct Link {
    /// What it is.
    pub part: Part,
    /// The link that carries it.
    pub parent: Option<usize>,
    /// How it is joined.
    pub freedom: Freedom,
    /// m, its origin in the parent's frame; of the root, in the stand.
    pub anchor: DVec3,
    /// kg.
    pub mass: f64,
    /// m, centre of mass in its frame.
    pub centre: DVec3,
    /// kg m², about the centre of mass, in its frame.
    pub inertia: DMat3,
    /// m, half sides of its box.
    pub half: DVec3,
    /// m, middle of its box in its frame.
    pub middle: DVec3,
    /// Turn of its box against its frame.
    pub turn: DQuat,
    /// rad/s, natural frequency of its servo.
    pub omega: f64,
    /// kg m², what its joint carries: the inertia of all beyond it about the joint, mean over the axes, in the stand.
    pub carried: f64,
}

/// A body as links.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Parents before children, the pelvis first.
    pub links: Vec<Link>,
    /// Which link each of the body's joints moves with.
    pub link_of: Vec<usize>,
    /// Roles of the body's joints.
    roles: Vec<Role>,
    /// The stand that rotations are counted from.
    pub stand: BodyPose,
    /// kg.
    pub mass: f64,
    /// Links of the legs: thigh, shank, foot; left, right.
    pub legs: [[usize; 3]; 2],
    /// Links of the toes of feet that bend; left, right.
    pub toes: [Option<usize>; 2],
    /// Links of the arms: upper arm, forearm; left, right.
    pub arms: [[usize; 2]; 2],
    /// The trunk's link.
    pub trunk: usize,
    /// m, where each sole bears, in the foot's frame where its toes are flat.
    pub soles: [[DVec3; sole::POINTS]; 2],
    /// m, thigh and shank together.
    pub leg_length: f64,
    /// m, ankle over the sole.
    pub ankle_height: f64,
    /// rad, how far each leg's hip may still flex and abduct from the stand and its ankle flex and invert: least and most; left, right.
    pub leg_ranges: [[[f64; 2]; 4]; 2],
    /// How each leg's hip and ankle are read, and how far they go, where the leg is whole; left, right.
    pub leg_axes: [Option<[JointAxes; 2]>; 2],
}

/// What moves as one with its neighbour to save time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Locks {
    /// Hands with the forearms.
    pub hands: bool,
    /// The head with the trunk.
    pub head: bool,
    /// The toes with the feet.
    pub toes: bool,
}

impl Figure {
    /// Reads a body that stands as `stand`.
    pub fn new(body: &Body, stand: &BodyPose, locks: Locks) -> Figure {
        Figure::with_knees(body, stand, locks, None)
    }

    /// The same with the axes of its knees, left and right, where the stand's bends do not tell them.
    pub fn with_knees(body: &Body, stand: &BodyPose, locks: Locks, knees: Option<[DVec3; 2]>) -> Figure {
        let mut make = Maker::new(body, stand);
        make.link(Part::Pelvis, None, Role::Hips, Freedom::Free, 25.0);
        let trunk_joint =
            [Role::Spine, Role::Chest, Role::UpperChest].into_iter().find(|role| body.joint(*role).is_some());
        make.link(Part::Trunk, Some(0), trunk_joint.unwrap_or(Role::Spine), BALL, 20.0);
        if !locks.head {
            let neck = if body.joint(Role::Neck).is_some() { Role::Neck } else { Role::Head };
            make.link(Part::Head, Some(1), neck, BALL, 15.0);
        }
        let mut arms = [[0; 2]; 2];
        for (side, upper, lower, hand) in [
            (Side::Left, Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand),
            (Side::Right, Role::RightUpperArm, Role::RightLowerArm, Role::RightHand),
        ] {
            let shoulder = make.link(Part::UpperArm(side), Some(1), upper, BALL, 15.0);
            let hinge = make.hinge([upper, lower, hand], DVec3::NEG_X, 145.0);
            let elbow = make.link(Part::Forearm(side), Some(shoulder), lower, hinge, 15.0);
            if !locks.hands {
                make.link(Part::Hand(side), Some(elbow), hand, Freedom::Ball { stiff: Some(1) }, 15.0);
            }
            arms[side as usize] = [shoulder, elbow];
        }
        let (mut legs, mut toes) = ([[0; 3]; 2], [None; 2]);
        for (side, upper, lower, foot) in [
            (Side::Left, Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot),
            (Side::Right, Role::RightUpperLeg, Role::RightLowerLeg, Role::RightFoot),
        ] {
            let hip = make.link(Part::Thigh(side), Some(0), upper, BALL, 25.0);
            let chain = [upper, lower, foot];
            let hinge = match knees {
                Some(axes) => make.hinge_about(chain, axes[side as usize], 150.0),
                None => make.hinge(chain, DVec3::X, 150.0),
            };
            let knee = make.link(Part::Shank(side), Some(hip), lower, hinge, 25.0);
            let ankle = make.link(Part::Foot(side), Some(knee), foot, Freedom::Ball { stiff: Some(1) }, 40.0);
            legs[side as usize] = [hip, knee, ankle];
            let bend = toes::bend(body, &make.positions, &stand.turns, side).filter(|_| !locks.toes);
            toes[side as usize] =
                bend.map(|bend| (make.link(Part::Toes(side), Some(ankle), bend.role, bend.freedom, 40.0), bend));
        }
        make.finish(legs, toes, arms)
    }

    /// Where each link is in a pose of the body: origin and turn from the stand.
    pub fn placed(&self, body: &Body, pose: &BodyPose) -> Vec<(DVec3, DQuat)> {
        let mut placed: Vec<(DVec3, DQuat)> = Vec::with_capacity(self.links.len());
        for (index, link) in self.links.iter().enumerate() {
            let joint = self.link_of.iter().position(|owner| *owner == index).unwrap_or(0);
            let turn = (pose.turns[joint] * self.stand.turns[joint].inverse()).normalize();
            let origin = match link.parent {
                Some(parent) => placed[parent].0 + placed[parent].1 * link.anchor,
                None => pose.hips + (self.links[0].anchor - self.stand.hips),
            };
            placed.push((origin, turn));
        }
        debug_assert_eq!(self.link_of.len(), body.joints.len());
        placed
    }

    /// m, where a joint of the body is in its link's frame.
    pub fn joint_in_link(&self, body: &Body, joint: usize) -> DVec3 {
        let positions = self.stand.positions(body);
        let link = self.link_of[joint];
        let origin =
            self.link_of.iter().position(|owner| *owner == link).map_or(positions[0], |first| positions[first]);
        positions[joint] - origin
    }

    /// The body's joint that a point on a link (its frame, m) is best said to be at: the uppermost of the spine that is not
    /// above it, else the link's own.
    pub fn joint_at(&self, body: &Body, link: usize, point: DVec3) -> usize {
        let own = self.link_of.iter().position(|owner| *owner == link).unwrap_or(0);
        let spine = [Role::Spine, Role::Chest, Role::UpperChest];
        let below = |joint: &usize| {
            self.link_of[*joint] == link
                && spine.contains(&self.roles[*joint])
                && self.joint_in_link(body, *joint).y <= point.y
        };
        (0..self.link_of.len()).rev().find(below).unwrap_or(own)
    }

    /// The body's joint that each link turns about.
    pub fn joints(&self) -> Vec<usize> {
        let own = |link: usize| self.link_of.iter().position(|owner| *owner == link).unwrap_or(0);
        (0..self.links.len()).map(own).collect()
    }

    /// The role of the joint that a link turns about.
    pub fn role_of(&self, link: usize) -> Role {
        let joint = self.link_of.iter().position(|owner| *owner == link);
        joint.map_or(Role::Hips, |joint| self.roles[joint])
    }

    /// The link that a role's joint moves with.
    pub fn link_of_role(&self, role: Role) -> Option<usize> {
        self.roles.iter().position(|own| *own == role).map(|joint| self.link_of[joint])
    }

    /// The body's pose when the links are so placed.
    pub fn pose(&self, placed: &[(DVec3, DQuat)]) -> BodyPose {
        let turns = self.link_of.iter().zip(&self.stand.turns).map(|(link, stand)| placed[*link].1 * *stand).collect();
        BodyPose { hips: placed[0].0, turns }
    }
}

/// A ball joint with all its angles.
const BALL: Freedom = Freedom::Ball { stiff: None };

/// rad inside the ranges that hips and ankles are measured by, as far as the body goes: a clip's joints are beside its run's by up to 2 degrees.
pub(super) const INSIDE: f64 = 0.019;

/// Gathers links.
pub(super) struct Maker<'a> {
    pub(super) body: &'a Body,
    pub(super) stand: &'a BodyPose,
    pub(super) positions: Vec<DVec3>,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<usize>,
}

impl<'a> Maker<'a> {
    fn new(body: &'a Body, stand: &'a BodyPose) -> Maker<'a> {
        Maker { body, stand, positions: stand.positions(body), links: Vec::new(), joints: Vec::new() }
    }

    fn joint(&self, role: Role) -> usize {
        self.body.joint(role).unwrap_or(0)
    }

    fn link(&mut self, part: Part, parent: Option<usize>, role: Role, freedom: Freedom, omega: f64) -> usize {
        let joint = self.joint(role);
        let at = self.positions[joint];
        let anchor = parent.map_or(at, |parent: usize| at - self.positions[self.joints[parent]]);
        self.joints.push(joint);
        self.links.push(Link {
            part,
            parent,
            freedom,
            anchor,
            mass: 0.0,
            centre: DVec3::ZERO,
            inertia: DMat3::ZERO,
            half: DVec3::ZERO,
            middle: DVec3::ZERO,
            turn: DQuat::IDENTITY,
            omega,
            carried: 0.0,
        });
        self.links.len() - 1
    }

    /// The hinge of the middle of three joints about an axis.
    fn hinge_about(&self, chain: [Role; 3], axis: DVec3, most: f64) -> Freedom {
        let [a, b, c] = chain.map(|role| self.positions[self.joint(role)]);
        let (upper, lower) = ((b - a).normalize_or_zero(), (c - b).normalize_or_zero());
        let bent = real::atan2(upper.cross(lower).dot(axis), upper.dot(lower));
        Freedom::Hinge { axis, range: [-bent.max(0.0), most.to_radians() - bent] }
    }

    /// The hinge of the middle of three joints: square to the bend of the stand, else across the body.
    fn hinge(&self, chain: [Role; 3], across: DVec3, most: f64) -> Freedom {
        let [a, b, c] = chain.map(|role| self.positions[self.joint(role)]);
        let (upper, lower) = ((b - a).normalize_or_zero(), (c - b).normalize_or_zero());
        let square = upper.cross(lower);
        let axis = if square.length() > 0.03 { square.normalize() } else { across };
        let bent = real::atan2(square.length(), upper.dot(lower));
        Freedom::Hinge { axis, range: [-bent, most.to_radians() - bent] }
    }

    fn finish(mut self, legs: [[usize; 3]; 2], toes: toes::Bends, arms: [[usize; 2]; 2]) -> Figure {
        let link_of: Vec<usize> = (0..self.body.joints.len()).map(|joint| self.owner(joint)).collect();
        self.gather_masses(&link_of);
        self.shape(&link_of);
        toes::divide(&mut self.links, &legs, &toes);
        self.carry();
        let soles = Side::BOTH.map(|side| {
            let shape = &self.body.feet[side as usize];
            sole::points(shape, self.stand.turns[shape.ankle])
        });
        let leg = |[hip, knee, ankle]: [usize; 3]| {
            debug_assert!(hip < knee);
            self.links[knee].anchor.length() + self.links[ankle].anchor.length()
        };
        let leg_length = 0.5 * (leg(legs[0]) + leg(legs[1]));
        Figure {
            link_of,
            roles: self.body.joints.iter().map(|joint| joint.role).collect(),
            stand: self.stand.clone(),
            mass: self.links.iter().map(|link| link.mass).sum(),
            legs,
            toes: toes.map(|toes| toes.map(|(link, _)| link)),
            arms,
            trunk: 1,
            soles,
            leg_length,
            ankle_height: 0.5 * (self.body.feet[0].ankle_height + self.body.feet[1].ankle_height),
            leg_ranges: self.leg_ranges(),
            leg_axes: Side::BOTH.map(|side| LegAngles::of(self.body).axes(self.stand, side)),
            links: self.links,
        }
    }

    /// As the measures have them less what a clip may be beside its run, from the stand.
    fn leg_ranges(&self) -> [[[f64; 2]; 4]; 2] {
        let angles = LegAngles::of(self.body);
        Side::BOTH.map(|side| {
            let at = angles.at(self.stand, side).unwrap_or_default();
            let mut ranges = angles.ranges(side);
            for (range, at) in ranges.iter_mut().zip(at) {
                // Who stands past an end may stand.
                *range = [(range[0] + INSIDE - at).min(0.0), (range[1] - INSIDE - at).max(0.0)];
            }
            ranges
        })
    }

    /// The link that a joint of the body moves with: its own or the nearest above.
    fn owner(&self, joint: usize) -> usize {
        let mut at = Some(joint);
        while let Some(joint) = at {
            if let Some(link) = self.joints.iter().position(|own| *own == joint) {
                return link;
            }
            at = self.body.joints[joint].parent;
        }
        0
    }
}
