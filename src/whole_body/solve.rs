//! The pose whose articulated centre of mass and feet are the wanted ones. Scenario space, metres, radians.
//!
//! The upper body is posed by angles; then the pelvis is moved until the articulated centre of mass lies on the target
//! (a fixed point: the legs are a third of the mass and follow by two-bone IK, so each pass leaves about a quarter of the
//! error). A foot that is out of reach stays on its leg's line; the caller keeps it in reach and is told the excess.

use super::anatomy::Anatomy;
use super::overlay::{BasePose, Neutral};
use crate::maths::curve::smooth3;
use crate::maths::quat::{limb_frame, yaw_of};
use crate::maths::real;
use crate::maths::two_bone_ik::two_bone_ik;
use crate::model::{Body, BodyPose, Side};
use glam::{DQuat, DVec3};

/// What the pose is to be.
#[derive(Clone, Copy, Debug)]
pub struct PoseTarget {
    /// m, articulated centre of mass.
    pub com: DVec3,
    /// Global turn of the pelvis from its upright rest.
    pub pelvis: DQuat,
    /// Global turn of the upper trunk; the spine joints share the way from the pelvis to it.
    pub chest: DQuat,
    /// Global turn of the head; the neck goes half way.
    pub head: DQuat,
    /// Left and right.
    pub arms: [ArmAngles; 2],
    /// Left and right.
    pub feet: [FootTarget; 2],
    /// A box in both hands: `com` is then that of body and box together.
    pub hold: Option<Hold>,
}

/// A box in both hands, rigid with the upper trunk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// kg.
    pub mass: f64,
    /// The joint that it moves with.
    pub joint: usize,
    /// m, its centre from that joint at rest.
    pub centre: DVec3,
    /// 0..1, from arms that do as they are told to arms that hold the box.
    pub weight: f64,
    /// Left and right: upper arm and forearm, turned from hanging straight down, relative to the chest.
    pub arms: [[DQuat; 2]; 2],
    /// rad, how far the chest leans back for it.
    pub lean: f64,
}

impl PoseTarget {
    /// The same with a box in the hands, the trunk leaning back.
    pub fn holding(self, hold: Hold) -> PoseTarget {
        let back = |share: f64| DQuat::from_rotation_x(-share * hold.lean);
        PoseTarget { pelvis: self.pelvis * back(0.25), chest: self.chest * back(1.0), hold: Some(hold), ..self }
    }
}

/// Joint angles of an arm, rad, from hanging straight down with the palm inwards.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmAngles {
    /// Flexion of the shoulder: forwards and up.
    pub raise: f64,
    /// Abduction: away from the body.
    pub abduct: f64,
    /// Inward rotation about the upper arm.
    pub inward: f64,
    /// Flexion of the elbow.
    pub elbow: f64,
    /// Curl of each finger joint.
    pub curl: f64,
}

/// Where a foot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootTarget {
    /// m, ankle joint.
    pub ankle: DVec3,
    /// Global turn of the foot from rest.
    pub foot: DQuat,
    /// Global turn of the toes from rest.
    pub toe: DQuat,
    /// rad, where the foot points.
    pub yaw: f64,
    /// 0 planted: the ankle is where it is told. Towards 1 (mid-swing) a leg near its full length gives way softly.
    pub soft: f64,
    /// rad, instead of the ankle's distance from the hip: how far the knee bends. The ankle lies on the line to `ankle` then.
    pub bend: Option<f64>,
    /// rad, how far the knee turns about the line from hip to ankle: a right-handed turn about the way down, so that a positive
    /// one takes a knee that points forwards to the right.
    pub swivel: f64,
}

/// A solved pose and what it cost.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The pose.
    pub pose: BodyPose,
    /// m, hip joints, left and right.
    pub hips: [DVec3; 2],
    /// m, by how much each ankle target was out of reach (0 within).
    pub short: [f64; 2],
    /// rad, knee bends.
    pub knees: [f64; 2],
    /// m, distance of the articulated centre of mass from its target.
    pub error: f64,
}

/// Solves poses of one body; keeps the last pelvis place as the next first guess.
#[derive(Clone, Debug)]
pub struct Solver<'a> {
    body: &'a Body,
    anatomy: &'a Anatomy,
    positions: Vec<DVec3>,
    is_thumb: Vec<bool>,        // (joints)
    is_lower: Vec<bool>,        // (joints) of a leg
    lower: Vec<usize>,          // segments of the legs
    held_toes: [Vec<usize>; 2], // joints that go with a foot: toes that its sole does not bend at
}

/// The largest part of the straight leg that a pose may use: past it the knee locks and pops.
pub const STRAIGHTEST: f64 = 0.9985;
/// rad, lift of an arm from which on its hand is no longer beside the hips, and how much further until it is well past them.
const PAST_HIPS: [f64; 2] = [0.25, 0.8];
const MOST_PASSES: usize = 10;
/// Rounds in which a foot that is one with its shank finds its height.
const RIGID_FOOT_PASSES: usize = 4;
const COM_TOLERANCE: f64 = 2e-5; // m

impl<'a> Solver<'a> {
    /// For a body.
    pub fn new(body: &'a Body, anatomy: &'a Anatomy) -> Self {
        let roots = [anatomy.legs[0].upper, anatomy.legs[1].upper];
        let mut is_lower = vec![false; body.joints.len()];
        for (joint, shape) in body.joints.iter().enumerate() {
            is_lower[joint] = roots.contains(&joint) || shape.parent.is_some_and(|parent| is_lower[parent]);
        }
        let lower = (0..body.segments.len()).filter(|segment| is_lower[body.segments[*segment].joint]).collect();
        let held_toes = Side::BOTH.map(|side| {
            let leg = &anatomy.legs[side as usize];
            let held = |joint: &usize| body.joints[*joint].parent == Some(leg.foot) && leg.toe != Some(*joint);
            (0..body.joints.len()).filter(held).collect()
        });
        let is_thumb = body.joints.iter().map(|joint| joint.role.name().contains("Thumb")).collect();
        Self { body, anatomy, positions: Vec::new(), is_thumb, is_lower, lower, held_toes }
    }

    /// The pose for a target.
    pub fn solve(&mut self, target: &PoseTarget) -> Solved {
        self.solve_over(target, None)
    }

    /// Turns of the upper body alone; the legs are left at rest.
    pub(super) fn upper(&self, target: &PoseTarget) -> Vec<DQuat> {
        let mut pose = BodyPose { hips: DVec3::ZERO, turns: vec![DQuat::IDENTITY; self.body.joints.len()] };
        self.pose_upper(target, &mut pose);
        pose.turns
    }

    /// The same, laid over a base clip's pose.
    pub fn solve_over(&mut self, target: &PoseTarget, over: Option<(&Neutral, &BasePose)>) -> Solved {
        let body = self.body;
        let mut pose = BodyPose { hips: target.com, turns: vec![DQuat::IDENTITY; body.joints.len()] };
        self.pose_upper(target, &mut pose);
        if let Some((neutral, base)) = over {
            neutral.lay(&mut pose.turns, base, target.hold.map_or(0.0, |hold| hold.weight));
            self.hold_unanimated(&mut pose.turns);
        }
        let over = over.map(|(_, base)| base);
        // The upper body's moment about the hips does not change while the pelvis moves.
        pose.hips = DVec3::ZERO;
        pose.positions_into(body, &mut self.positions);
        let mut upper_moment = DVec3::ZERO;
        let mut upper_mass = 0.0;
        for segment in body.segments.iter().filter(|segment| !self.is_lower[segment.joint]) {
            upper_moment += segment.mass * (self.positions[segment.joint] + pose.turns[segment.joint] * segment.centre);
            upper_mass += segment.mass;
        }
        let mut mass = body.mass;
        if let Some(hold) = &target.hold {
            upper_moment += hold.mass * (self.positions[hold.joint] + pose.turns[hold.joint] * hold.centre);
            upper_mass += hold.mass;
            mass += hold.mass;
        }
        pose.hips = target.com - upper_moment / mass * 1.3;
        let mut solved = [two_bone_ik(DVec3::Y, DVec3::ZERO, 0.5, 0.5, DVec3::Z, 1.0); 2];
        let mut hips = [DVec3::ZERO; 2];
        let mut error = f64::INFINITY;
        for _ in 0..MOST_PASSES {
            let mut moment = upper_moment + pose.hips * upper_mass;
            for side in Side::BOTH {
                let (hip, leg) = self.pose_leg(target, side, over, &mut pose);
                hips[side as usize] = hip;
                solved[side as usize] = leg;
            }
            for segment in self.lower.iter().map(|segment| &body.segments[*segment]) {
                moment += segment.mass * (self.positions[segment.joint] + pose.turns[segment.joint] * segment.centre);
            }
            let miss = target.com - moment / mass;
            error = miss.length();
            if error < COM_TOLERANCE {
                break;
            }
            pose.hips += miss;
        }
        let short = Side::BOTH.map(|side| {
            let leg = &solved[side as usize];
            if leg.reached { 0.0 } else { (target.feet[side as usize].ankle - leg.end).length() }
        });
        Solved { pose, hips, short, knees: [solved[0].bend, solved[1].bend], error }
    }

    fn pose_upper(&self, target: &PoseTarget, pose: &mut BodyPose) {
        let anatomy = self.anatomy;
        let upright = anatomy.torso_upright;
        let turns = &mut pose.turns;
        // Whatever has no say of its own inherits from its parent.
        let mut set = vec![false; turns.len()];
        let mut put = |turns: &mut Vec<DQuat>, joint: usize, turn: DQuat| {
            turns[joint] = turn;
            set[joint] = true;
        };
        put(turns, 0, target.pelvis * upright);
        let count = anatomy.spine.len() as f64;
        for (place, joint) in anatomy.spine.iter().enumerate() {
            let share = (place + 1) as f64 / count;
            put(turns, *joint, target.pelvis.slerp(target.chest, share) * upright);
        }
        if let Some(neck) = anatomy.neck {
            put(turns, neck, (target.chest * upright).slerp(target.head, 0.5));
        }
        put(turns, anatomy.head, target.head);
        for side in Side::BOTH {
            let (arm, angles) = (&anatomy.arms[side as usize], &target.arms[side as usize]);
            let sign = side.sign();
            if let Some(shoulder) = arm.shoulder {
                // The collar bone follows a third of what the arm lifts past 30 degrees.
                let free = target.hold.map_or(1.0, |hold| 1.0 - hold.weight);
                let lift = ((angles.abduct.abs().max(angles.raise.abs()) - 0.52).max(0.0)) * 0.33 * free;
                put(turns, shoulder, target.chest * DQuat::from_rotation_z(sign * lift) * upright);
            }
            // Hands that hang clear something wide; those of a lifted arm are past it.
            let lifted = angles.abduct.abs().max(angles.raise.abs());
            let abduct = angles.abduct + arm.widen * (1.0 - smooth3((lifted - PAST_HIPS[0]) / PAST_HIPS[1]));
            let upper = target.chest
                * DQuat::from_rotation_z(sign * abduct)
                * DQuat::from_rotation_x(-angles.raise)
                * DQuat::from_rotation_y(-sign * angles.inward);
            let mut lower = upper * DQuat::from_rotation_x(-angles.elbow);
            let (mut upper, mut curl) = (upper, angles.curl);
            if let Some(hold) = target.hold.filter(|hold| hold.weight > 0.0) {
                let [above, below] = hold.arms[side as usize];
                upper = upper.slerp(target.chest * above, hold.weight);
                lower = lower.slerp(target.chest * below, hold.weight);
                curl *= 1.0 - 0.5 * hold.weight;
            }
            put(turns, arm.upper, upper * arm.upper_down);
            put(turns, arm.lower, lower * arm.lower_down);
            put(turns, arm.hand, lower * arm.lower_down);
            for finger in &arm.fingers {
                let parent = self.body.joints[*finger].parent.unwrap_or(0);
                let share = if self.is_thumb[*finger] { 0.3 } else { 1.0 };
                // In the hanging hand the palm faces inwards: fingers curl about the hand's own fore-aft axis.
                let axis = lower * DVec3::new(0.0, 0.0, -sign);
                let turn = DQuat::from_axis_angle(axis, curl * share) * turns[parent];
                put(turns, *finger, turn);
            }
        }
        for joint in 1..turns.len() {
            if !set[joint]
                && !self.is_lower[joint]
                && let Some(parent) = self.body.joints[joint].parent
            {
                turns[joint] = turns[parent];
            }
        }
        self.hold_unanimated(turns);
    }

    /// A joint that no node moves keeps its parent's turn.
    fn hold_unanimated(&self, turns: &mut [DQuat]) {
        for (index, joint) in self.body.joints.iter().enumerate() {
            if !joint.animated
                && let Some(parent) = joint.parent
            {
                turns[index] = turns[parent];
            }
        }
    }

    fn pose_leg(
        &mut self,
        target: &PoseTarget,
        side: Side,
        over: Option<&BasePose>,
        pose: &mut BodyPose,
    ) -> (DVec3, crate::maths::two_bone_ik::TwoBone) {
        let (body, leg, foot) = (self.body, &self.anatomy.legs[side as usize], &target.feet[side as usize]);
        let pelvis = pose.turns[0];
        let parent = body.joints[leg.upper].parent.unwrap_or(0);
        let hip = pose.hips + pelvis * (body.joints[leg.upper].rest - body.joints[0].rest);
        debug_assert!(parent == 0, "legs hang from the hips");
        // The knee points between the foot and the pelvis, a little upwards so that a raised thigh keeps its knee above.
        let pelvis_yaw = yaw_of(target.pelvis);
        let yaw = pelvis_yaw + 0.65 * crate::maths::quat::wrap_angle(foot.yaw - pelvis_yaw);
        let ankle = match foot.bend {
            Some(bend) => hip + (foot.ankle - hip).normalize_or(DVec3::NEG_Y) * leg.length_at(bend),
            None => soft_reach(hip, foot.ankle, leg.length(), foot.soft),
        };
        let mut pole = knee_pole(ankle - hip, yaw);
        if foot.swivel != 0.0 {
            pole = DQuat::from_axis_angle((ankle - hip).normalize_or(DVec3::NEG_Y), foot.swivel) * pole;
        }
        let mut straightest = STRAIGHTEST;
        if let Some(base) = over {
            let distance = (ankle - hip).length().min(leg.length() * base.straightest[side as usize]);
            let swivel = base.knees[side as usize] * base.keeps(side, leg.bend_at(distance));
            pole = DQuat::from_axis_angle((ankle - hip).normalize_or(DVec3::NEG_Y), swivel) * pole;
            straightest = base.straightest[side as usize];
        }
        let reach = |ankle: DVec3| two_bone_ik(hip, ankle, leg.thigh_length, leg.shank_length, pole, straightest);
        let mut chain = reach(ankle);
        if !body.joints[leg.foot].animated {
            // A foot that is one with its shank leans with it: the ankle is where its lowest point is as low as it should be.
            let shape = &body.feet[side as usize];
            let lowest = |turn: DQuat| {
                let sole = shape.rear_sole.iter().chain(&shape.front_sole).map(|vertex| (turn * *vertex).y);
                sole.fold(f64::INFINITY, f64::min)
            };
            let wanted = lowest(foot.foot);
            for _ in 0..RIGID_FOOT_PASSES {
                let turn = limb_frame(chain.end - chain.middle, chain.hinge) * leg.shank_from_rest;
                let raise = wanted - lowest(turn);
                if raise.is_finite() {
                    chain = reach(ankle + DVec3::Y * raise);
                }
            }
        }
        pose.turns[leg.upper] = limb_frame(chain.middle - hip, chain.hinge) * leg.thigh_from_rest;
        pose.turns[leg.lower] = limb_frame(chain.end - chain.middle, chain.hinge) * leg.shank_from_rest;
        if let Some(base) = over {
            let keeps = base.keeps(side, chain.bend);
            let [thigh, shank] = base.twists[side as usize].map(|twist| DQuat::IDENTITY.slerp(twist, keeps));
            pose.turns[leg.upper] *= thigh;
            pose.turns[leg.lower] *= shank;
        }
        pose.turns[leg.foot] = if body.joints[leg.foot].animated { foot.foot } else { pose.turns[leg.lower] };
        self.positions[leg.upper] = hip;
        self.positions[leg.lower] = chain.middle;
        self.positions[leg.foot] = chain.end;
        if let Some(toe) = leg.toe {
            pose.turns[toe] = foot.toe;
            self.positions[toe] = chain.end + pose.turns[leg.foot] * body.offset(toe);
        }
        // Toes that the sole does not bend at go with the foot, held to it as a clip holds them.
        for joint in &self.held_toes[side as usize] {
            let held = over.map_or(DQuat::IDENTITY, |base| base.turns[leg.foot].inverse() * base.turns[*joint]);
            pose.turns[*joint] = (pose.turns[leg.foot] * held).normalize();
        }
        (hip, chain)
    }
}

/// Where a knee points. Along a leg that reaches straight back (or forwards and up) "forwards" says nothing, and past there
/// it would say the opposite: there the knee stays square to the body's own left instead.
pub(super) fn knee_pole(leg: DVec3, yaw: f64) -> DVec3 {
    let forwards = DVec3::new(real::sin(yaw), 0.25, real::cos(yaw)).normalize();
    let axis = leg.normalize_or(DVec3::NEG_Y);
    let along = smooth3((axis.dot(forwards).abs() - 0.8) / 0.15);
    let square = axis.cross(DVec3::new(real::cos(yaw), 0.0, -real::sin(yaw))).normalize_or(forwards);
    (forwards - axis * axis.dot(forwards)).normalize_or(square).lerp(square, along)
}

/// Draws a swinging ankle in before the leg is straight, so that the knee does not snap: from 88 % of the leg at `soft` 1.
pub fn soft_reach(hip: DVec3, ankle: DVec3, leg: f64, soft: f64) -> DVec3 {
    let to = ankle - hip;
    let distance = to.length();
    let longest = leg * (STRAIGHTEST - 0.012 * soft);
    let from = leg * (STRAIGHTEST - (STRAIGHTEST - 0.88) * soft);
    let room = longest - from;
    if distance <= from || room < 1e-9 {
        return ankle;
    }
    hip + to * ((from + room * (1.0 - real::exp(-(distance - from) / room))) / distance)
}
