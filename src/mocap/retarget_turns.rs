//! Global turns from one body to another by humanoid role: what makes two rest poses the same stand.
//!
//! Scenario axes, radians. Each segment gets a frame at rest: where its bone points and about what it bends (elbow and knee hinges, the
//! row of the knuckles, the level sole). A segment of the target takes the frame that the source's has in the clip, so that a T-pose and an
//! A-pose, straight and bent knees, palms down and palms in mean the same. Trunks stand upright at rest on both, but for one that leans
//! well over. Spines of different counts share the way from pelvis to shoulders by length. Does not look at places.

use crate::maths::quat::{limb_frame, shortest_arc};
use crate::maths::real;
use crate::model::{Body, Role, Side};
use glam::{DQuat, DVec3};

/// rad: a limb that rests bent by the first tells nothing of its hinge, by the second all of it.
const BENT: (f64, f64) = (0.17, 0.44);
/// rad: a trunk that leans by the first at rest is how it was drawn, by the second a pose.
const LEANS: (f64, f64) = (0.09, 0.21);

/// Leads the source's turns to the target's.
pub(super) struct TurnMap {
    joints: Vec<Way>,
    parents: Vec<Option<usize>>,
}

/// Where a joint's turn comes from.
enum Way {
    /// The source's joint, then a correction of the rest pose.
    Joint(usize, DQuat),
    /// Between two source joints at a share, each with its correction.
    Between([(usize, DQuat); 2], f64),
    /// Between two joints of the target: what is above it, and one further on.
    Midway(usize, usize),
    /// As its parent in the target.
    Parent,
}

impl TurnMap {
    /// Pairs the joints of two bodies.
    pub fn new(source: &Body, target: &Body) -> TurnMap {
        let (from, to) = (rest_frames(source), rest_frames(target));
        let spines = [spine(source), spine(target)];
        let direct = |s: usize, t: usize| (s, (from[s] * to[t].inverse()).normalize());
        let joints = target
            .joints
            .iter()
            .enumerate()
            .map(|(index, joint)| {
                if !joint.animated && joint.parent.is_some() {
                    return Way::Parent;
                }
                if let Some(place) = spines[1].iter().position(|(at, _)| *at == index).filter(|place| *place > 0) {
                    return spine_way(&spines, place, &|s| direct(s, index));
                }
                if let Some(own) = source.joint(joint.role) {
                    let (own, correction) = direct(own, index);
                    return Way::Joint(own, correction);
                }
                match joint.role {
                    Role::LeftToes | Role::RightToes => {
                        let foot = if joint.role == Role::LeftToes { Role::LeftFoot } else { Role::RightFoot };
                        source.joint(foot).map_or(Way::Parent, |foot| {
                            let (foot, correction) = direct(foot, index);
                            Way::Joint(foot, correction)
                        })
                    }
                    Role::Neck => match (joint.parent, target.joint(Role::Head)) {
                        (Some(parent), Some(head)) => Way::Midway(parent, head),
                        _ => Way::Parent,
                    },
                    _ => Way::Parent,
                }
            })
            .collect();
        TurnMap { joints, parents: target.joints.iter().map(|joint| joint.parent).collect() }
    }

    /// The target's turns of a frame; `turns` are the source's.
    pub fn turns(&self, turns: &[DQuat]) -> Vec<DQuat> {
        let mut out: Vec<DQuat> = Vec::with_capacity(self.joints.len());
        for (index, way) in self.joints.iter().enumerate() {
            let above = self.parents[index].map_or(DQuat::IDENTITY, |parent| out[parent]);
            let turn = match way {
                Way::Joint(own, correction) => turns[*own] * *correction,
                Way::Between([(a, before), (b, after)], share) => {
                    (turns[*a] * *before).slerp(turns[*b] * *after, *share)
                }
                Way::Midway(..) | Way::Parent => above,
            };
            out.push(turn.normalize());
        }
        for (index, way) in self.joints.iter().enumerate() {
            if let Way::Midway(above, beyond) = way {
                out[index] = out[*above].slerp(out[*beyond], 0.5);
            }
        }
        out
    }
}

/// Pelvis and spine joints from below, each with its share of the length between the pelvis and the last.
fn spine(body: &Body) -> Vec<(usize, f64)> {
    let roles = [Role::Hips, Role::Spine, Role::Chest, Role::UpperChest];
    let chain: Vec<usize> = roles.into_iter().filter_map(|role| body.joint(role)).collect();
    let mut lengths = vec![0.0; chain.len()];
    for at in 1..chain.len() {
        lengths[at] = lengths[at - 1] + body.joints[chain[at]].rest.distance(body.joints[chain[at - 1]].rest);
    }
    let whole = lengths.last().copied().unwrap_or(0.0).max(1e-9);
    chain.into_iter().zip(lengths).map(|(joint, length)| (joint, length / whole)).collect()
}

/// Where the spine joint at a place of the target's chain gets its turn: the last one the last's, one of as many its own, else by length.
fn spine_way(spines: &[Vec<(usize, f64)>; 2], place: usize, direct: &dyn Fn(usize) -> (usize, DQuat)) -> Way {
    let [source, target] = spines;
    let Some(last) = source.len().checked_sub(1) else { return Way::Parent };
    let one = |at: usize| {
        let (joint, correction) = direct(source[at].0);
        Way::Joint(joint, correction)
    };
    if place + 1 == target.len() {
        return one(last);
    }
    if source.len() == target.len() {
        return one(place);
    }
    let share = target[place].1;
    let above = (1..=last).find(|at| source[*at].1 >= share).unwrap_or(last);
    let (low, high) = (source[above - usize::from(above > 0)], source[above]);
    let share = ((share - low.1) / (high.1 - low.1).max(1e-9)).clamp(0.0, 1.0);
    Way::Between([direct(low.0), direct(high.0)], share)
}

/// From a segment's own axes (bone against Y, hinge along X) to the scenario's, at rest; one a joint.
pub(super) fn rest_frames(body: &Body) -> Vec<DQuat> {
    let lean = lean(body);
    let arms = Side::BOTH.map(|side| ArmFrames::of(body, side));
    let legs = Side::BOTH.map(|side| leg_frames(body, side));
    body.joints
        .iter()
        .enumerate()
        .map(|(index, joint)| {
            let side = if joint.role.name().starts_with("left") { 0 } else { 1 };
            use Role::*;
            match joint.role {
                Hips | Spine | Chest | UpperChest | Neck | LeftShoulder | RightShoulder => lean,
                Head | Jaw | LeftEye | RightEye => DQuat::IDENTITY,
                LeftUpperArm | RightUpperArm => arms[side].upper,
                LeftLowerArm | RightLowerArm => arms[side].lower,
                LeftHand | RightHand => arms[side].hand,
                LeftUpperLeg | RightUpperLeg => legs[side][0],
                LeftLowerLeg | RightLowerLeg => legs[side][1],
                LeftFoot | RightFoot => legs[side][2],
                LeftToes | RightToes => legs[side][3],
                _ => finger(body, index, &arms[side]),
            }
        })
        .collect()
}

/// The trunk's lean at rest, as far as it is a pose.
fn lean(body: &Body) -> DQuat {
    let middle = |left: Role| {
        let [left, right] = [left, left.mirrored()].map(|role| body.joint(role));
        Some((body.joints[left?].rest + body.joints[right?].rest) * 0.5)
    };
    let (Some(top), Some(bottom)) = (middle(Role::LeftUpperArm), middle(Role::LeftUpperLeg)) else {
        return DQuat::IDENTITY;
    };
    let trunk = top - bottom;
    let lean = real::atan2(trunk.z, trunk.y);
    DQuat::from_rotation_x(lean * eased(lean.abs(), LEANS))
}

/// 0 at the first, 1 at the second.
fn eased(value: f64, (from, to): (f64, f64)) -> f64 {
    let u = ((value - from) / (to - from)).clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

/// The hinge of a limb: as its bend at rest shows, else as assumed.
fn hinge(upper: DVec3, lower: DVec3, assumed: DVec3) -> DVec3 {
    let shown = upper.normalize_or_zero().cross(lower.normalize_or_zero());
    let bend = real::atan2(shown.length(), upper.normalize_or_zero().dot(lower.normalize_or_zero()));
    let sure = if shown.dot(assumed) > 0.5 * shown.length() { eased(bend, BENT) } else { 0.0 };
    assumed.lerp(shown.normalize_or(assumed), sure)
}

struct ArmFrames {
    upper: DQuat,
    lower: DQuat,
    hand: DQuat,
    /// At rest: from the little finger's knuckle to the index's, and out of the palm.
    row: DVec3,
    palm: DVec3,
}

impl ArmFrames {
    fn of(body: &Body, side: Side) -> ArmFrames {
        let own = |role: Role| if side == Side::Left { role } else { role.mirrored() };
        let rest = |role: Role| body.joint(own(role)).map(|joint| body.joints[joint].rest);
        let place = |role: Role| rest(role).unwrap_or_default();
        let (shoulder, elbow, wrist) = (place(Role::LeftUpperArm), place(Role::LeftLowerArm), place(Role::LeftHand));
        let (upper, lower) = (elbow - shoulder, wrist - elbow);
        // An arm that hangs bends its elbow about -X and has its thumb in front; one that is raised came there by the shortest way.
        let raised = shortest_arc(DVec3::NEG_Y, upper);
        let hinge = hinge(upper, lower, raised * DVec3::NEG_X);
        let forearm = shortest_arc(upper, lower);
        let along = forearm * raised;
        let knuckles: Vec<DVec3> =
            [Role::LeftIndexProximal, Role::LeftMiddleProximal, Role::LeftRingProximal, Role::LeftLittleProximal]
                .into_iter()
                .filter_map(rest)
                .collect();
        let (mut out, mut row) = (lower, along * DVec3::Z);
        if let (Some(first), Some(last)) = (rest(Role::LeftIndexProximal), rest(Role::LeftLittleProximal)) {
            let middle = knuckles.iter().sum::<DVec3>() / knuckles.len() as f64 - wrist;
            let shown = (first - last) - middle.normalize_or_zero() * (first - last).dot(middle.normalize_or_zero());
            // Hands that were put together wrongly tell nothing.
            if middle.dot(lower) > 0.0 && shown.length() > 0.1 * middle.length() {
                (out, row) = (middle, shown);
            }
        }
        let row = row.normalize_or(DVec3::Z);
        let palm = out.normalize_or_zero().cross(row) * side.sign();
        ArmFrames {
            upper: limb_frame(upper, hinge),
            lower: limb_frame(lower, hinge),
            hand: limb_frame(out, row),
            row,
            palm,
        }
    }
}

/// A phalanx points where the next one is, or as the one before.
fn finger(body: &Body, joint: usize, arm: &ArmFrames) -> DQuat {
    let role = body.joints[joint].role;
    let next = (0..body.joints.len()).find(|other| {
        body.joints[*other].parent == Some(joint) && Role::parent(body.joints[*other].role) == Some(role)
    });
    let rest = |joint: usize| body.joints[joint].rest;
    let along = match (next, body.joints[joint].parent) {
        (Some(next), _) => rest(next) - rest(joint),
        (None, Some(parent)) => rest(joint) - rest(parent),
        _ => DVec3::NEG_Y,
    };
    let about = if role.name().contains("Thumb") { arm.palm } else { arm.row };
    limb_frame(along, about)
}

/// Thigh, shank, foot and toes.
fn leg_frames(body: &Body, side: Side) -> [DQuat; 4] {
    let own = |role: Role| if side == Side::Left { role } else { role.mirrored() };
    let place = |role: Role| body.joint(own(role)).map_or(DVec3::ZERO, |joint| body.joints[joint].rest);
    let foot = &body.feet[side as usize];
    let (hip, knee, ankle) = (place(Role::LeftUpperLeg), place(Role::LeftLowerLeg), body.joints[foot.ankle].rest);
    let (thigh, shank) = (knee - hip, ankle - knee);
    let across = DVec3::new(foot.forward.y, 0.0, -foot.forward.x);
    let hinge = hinge(thigh, shank, across);
    let heading = DQuat::from_rotation_y(real::atan2(foot.forward.x, foot.forward.y));
    [
        limb_frame(thigh, hinge),
        limb_frame(shank, hinge),
        (foot.level.inverse() * heading).normalize(),
        (foot.toe_level.inverse() * heading).normalize(),
    ]
}
