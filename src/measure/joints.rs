//! Joints: knees past straight, ranges of motion. Radians, angles from the neutral stand (arms down, legs straight).
//!
//! A body's rest is the rig's bind pose, whatever that is; the neutral stand is found from it: the trunk, head, hands
//! (against the forearm) and feet (laid level) are neutral as they rest, and the limbs' long bones are turned from straight
//! down to where they rest by the shortest way; a trunk that rests leaning over 6 degrees is set upright. Hips are read as flexion, abduction, rotation about the turned axes
//! (ISB); shoulder, waist and neck as a swing vector and the twist before it, which has no pole within reach; knees and
//! elbows about their own hinge; ankles and wrists as a swing, their twist belonging to shank and forearm. The ranges are notes' own
//! table (standard ranges of motion). A bound gives way to a rest pose that lies beyond it, but for the knee's 0.

use super::Track;
use super::dynamics::shortest;
pub use super::pops::Pop;
use super::pops::pops;
use crate::maths::real;
use crate::model::{Body, BodyPose, Role, Side};
use glam::{DQuat, DVec2, DVec3, dvec3};

/// rad, beyond a bound that is not counted.
pub const LIMIT_TOLERANCE: f64 = 1.0 * DEGREE;
const HIP: [[f64; 2]; 2] = [[-30.0, 125.0], [-30.0, 45.0]]; // degrees, flexion and abduction
const ROTATION: [f64; 2] = [-45.0, 45.0]; // degrees, of the hip
const ANKLE: [[f64; 2]; 2] = [[-50.0, 30.0], [-20.0, 30.0]]; // degrees, flexion and inversion
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// An angle of the body, of that sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// Which joint.
    pub role: Role,
    /// "flexion", "abduction", "side", "rotation", "twist", "deviation" or "inversion".
    pub axis: &'static str,
    /// rad.
    pub value: f64,
    /// rad, least and greatest.
    pub range: [f64; 2],
}

/// The worst of an angle that leaves its range by more than the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// The angle where it is farthest out.
    pub angle: Angle,
    /// rad, how far out.
    pub by: f64,
    /// s.
    pub time: f64,
}

/// What the joints do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointFindings {
    /// Worst first within a joint's own order; empty is good.
    pub excesses: Vec<Excess>,
    /// rad, how far the worse knee bends past straight (0 if it does not; no tolerance taken off).
    pub knee_past_straight: f64,
    /// In the order of joints, then of time.
    pub pops: Vec<Pop>,
    /// One a sample: whether any angle is beyond its range then by more than the tolerance.
    pub beyond: Vec<bool>,
}

/// Measures them.
pub fn joints(track: &Track) -> JointFindings {
    let body = track.motion.body;
    let neutral = Neutral::of(body);
    let mut bounds: Vec<Angle> = Vec::new();
    neutral.angles(body, &BodyPose::rest(body), &mut bounds);
    let mut worst: Vec<Option<Excess>> = vec![None; bounds.len()];
    let mut found = JointFindings::default();
    let mut angles: Vec<Angle> = Vec::new();
    for (sample, pose) in track.motion.poses.iter().enumerate() {
        angles.clear();
        neutral.angles(body, pose, &mut angles);
        let mut beyond = false;
        for ((angle, rest), worst) in angles.iter().zip(&bounds).zip(&mut worst) {
            let is_knee = matches!(angle.role, Role::LeftLowerLeg | Role::RightLowerLeg);
            if is_knee {
                found.knee_past_straight = found.knee_past_straight.max(-angle.value);
            }
            let low = if is_knee { angle.range[0] } else { angle.range[0].min(rest.value) };
            let high = angle.range[1].max(rest.value);
            let by = (low - angle.value).max(angle.value - high);
            beyond |= by > LIMIT_TOLERANCE;
            if by > LIMIT_TOLERANCE && worst.is_none_or(|worst| by > worst.by) {
                *worst = Some(Excess { angle: *angle, by, time: track.motion.time(sample) });
            }
        }
        found.beyond.push(beyond);
    }
    found.excesses = worst.into_iter().flatten().collect();
    found.pops = pops(track);
    found
}

/// Every angle of the table at a pose.
pub fn angles(body: &Body, pose: &BodyPose) -> Vec<Angle> {
    let mut out = Vec::new();
    Neutral::of(body).angles(body, pose, &mut out);
    out
}

/// Reads hips and ankles of many poses of one body.
pub struct LegAngles {
    neutral: Neutral,
    ranges: [[[f64; 2]; 4]; 2], // by side
}

impl LegAngles {
    /// Of a body.
    pub fn of(body: &Body) -> LegAngles {
        let table = [HIP[0], HIP[1], ANKLE[0], ANKLE[1]].map(|range| range.map(f64::to_radians));
        let mut legs = LegAngles { neutral: Neutral::of(body), ranges: [table; 2] };
        let rest = BodyPose::rest(body);
        for side in Side::BOTH {
            let Some(angles) = legs.at(&rest, side) else { continue };
            for (range, angle) in legs.ranges[side as usize].iter_mut().zip(angles) {
                *range = [range[0].min(angle), range[1].max(angle)];
            }
        }
        legs
    }

    /// rad: flexion and abduction of the hip, flexion and inversion of the ankle; `None` for a leg that is not whole.
    pub fn at(&self, pose: &BodyPose, side: Side) -> Option<[f64; 4]> {
        let limb = self.neutral.limbs.iter().find(|limb| !limb.arm && limb.side == side)?;
        let (upper, shank, foot) = (limb.joints[0]?, limb.joints[1]?, limb.joints[2]?);
        let pelvis = pose.turns[0] * self.neutral.upright.inverse();
        let [flexion, abduction, _] = hip_angles(pelvis.inverse() * pose.turns[upper] * limb.rest[0], side.sign());
        let [ankle, inversion] = limb.ankle(pose.turns[shank], pose.turns[foot]);
        Some([flexion, abduction, ankle, inversion])
    }

    /// rad, least and greatest of each of the four.
    pub fn ranges(&self, side: Side) -> [[f64; 2]; 4] {
        self.ranges[side as usize]
    }

    /// How hip and ankle are read off the turns of a leg's bones against those of a stand; `None` for a leg that is not whole.
    pub fn axes(&self, stand: &BodyPose, side: Side) -> Option<[JointAxes; 2]> {
        let limb = self.neutral.limbs.iter().find(|limb| !limb.arm && limb.side == side)?;
        let (upper, shank, foot) = (limb.joints[0]?, limb.joints[1]?, limb.joints[2]?);
        let ahead = DQuat::from_rotation_y(real::atan2(limb.forward.x, limb.forward.z));
        let hip = [self.neutral.upright * stand.turns[0].inverse(), stand.turns[upper] * limb.rest[0]];
        let ankle = [(stand.turns[shank] * limb.rest[1] * ahead).inverse(), stand.turns[foot] * limb.level[0] * ahead];
        let sided = |[low, high]: [f64; 2]| if side == Side::Left { [low, high] } else { [-high, -low] };
        let turned = |[low, high]: [f64; 2]| [-high, -low];
        let [flexion, abduction, dorsal, inversion] = self.ranges(side);
        let rotation = ROTATION.map(f64::to_radians);
        Some([
            JointAxes {
                before: hip[0],
                after: hip[1],
                range: [turned(flexion), sided(abduction), sided(turned(rotation))],
            },
            JointAxes {
                before: ankle[0],
                after: ankle[1],
                range: [turned(dorsal), sided(turned(inversion)), [-std::f64::consts::PI, std::f64::consts::PI]],
            },
        ])
    }
}

/// How the angles of a joint are read off its bone's turn R against the stand, in the parent's: off `before` R `after`. A hip's are those of
/// turns about x, then z, then y; an ankle's a swing of the y axis about x and z as they go with the twist about y before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointAxes {
    /// Left of the turn.
    pub before: DQuat,
    /// Right of it.
    pub after: DQuat,
    /// rad, least and most about x (forwards bends a trunk by more, a limb by less), z and y.
    pub range: [[f64; 2]; 3],
}

/// What the neutral stand of a body is, seen from its rest.
struct Neutral {
    thorax: usize,
    /// Rest to neutral, of pelvis and trunk.
    upright: DQuat,
    limbs: Vec<Limb>,
    has_waist: bool,
    head: Option<usize>,
}

struct Limb {
    side: Side,
    arm: bool,
    /// Joint indices: upper bone, lower bone, hand or foot, toes.
    joints: [Option<usize>; 4],
    /// Neutral to rest, of the upper and the lower bone.
    rest: [DQuat; 2],
    /// At rest: the unit axis about which the lower bone bends.
    hinge: DVec3,
    /// At rest, unit: upper and lower bone.
    along: [DVec3; 2],
    /// Unit, horizontal, where the levelled foot points (legs).
    forward: DVec3,
    /// Level to rest, of foot and toes (legs).
    level: [DQuat; 2],
}

impl Neutral {
    fn of(body: &Body) -> Neutral {
        let spine = [Role::UpperChest, Role::Chest, Role::Spine];
        let thorax = spine.iter().find_map(|role| body.joint(*role)).unwrap_or(0);
        let mut limbs = Vec::new();
        for arm in [true, false] {
            for side in Side::BOTH {
                limbs.extend(Limb::of(body, side, arm));
            }
        }
        // A trunk that rests leaning by more than a few degrees rests in no stand: it is set upright.
        let middle = |left: Role| {
            let both = [left, left.mirrored()].map(|role| body.joint(role).map(|joint| body.joints[joint].rest));
            both[0].zip(both[1]).map(|(left, right)| (left + right) * 0.5)
        };
        let trunk = middle(Role::LeftUpperArm).zip(middle(Role::LeftUpperLeg)).map(|(top, bottom)| top - bottom);
        let lean = trunk.map_or(0.0, |trunk| real::atan2(trunk.z, trunk.y));
        let upright = if lean.abs() > 6.0 * DEGREE { DQuat::from_rotation_x(-lean) } else { DQuat::IDENTITY };
        Neutral { thorax, upright, limbs, has_waist: thorax != 0, head: body.joint(Role::Head) }
    }

    /// The same angles in the same order for every pose.
    fn angles(&self, body: &Body, pose: &BodyPose, out: &mut Vec<Angle>) {
        let pelvis = pose.turns[0] * self.upright.inverse();
        let thorax = pose.turns[self.thorax] * self.upright.inverse();
        let mut add = |role: Role, axis: &'static str, value: f64, low: f64, high: f64| {
            out.push(Angle { role, axis, value, range: [low * DEGREE, high * DEGREE] });
        };
        if self.has_waist {
            let (swing, twist) = swing_twist(pelvis.inverse() * thorax, DVec3::Y);
            add(Role::Spine, "flexion", swing.x, -25.0, 60.0);
            add(Role::Spine, "side", swing.z, -30.0, 30.0);
            add(Role::Spine, "twist", twist, -35.0, 35.0);
        }
        if let Some(head) = self.head {
            let (swing, twist) = swing_twist(thorax.inverse() * pose.turns[head], DVec3::Y);
            add(Role::Head, "flexion", swing.x, -60.0, 60.0);
            add(Role::Head, "side", swing.z, -45.0, 45.0);
            add(Role::Head, "twist", twist, -75.0, 75.0);
        }
        for limb in &self.limbs {
            let Some(upper) = limb.joints[0] else { continue };
            let upper_turn = pose.turns[upper];
            let role = body.joints[upper].role;
            let out_sign = limb.side.sign();
            // From the neutral bone to the posed one, in the trunk's axes.
            if limb.arm {
                let (swing, twist) = swing_twist(thorax.inverse() * upper_turn * limb.rest[0], DVec3::Y);
                add(role, "flexion", -swing.x, -50.0, 170.0);
                add(role, "abduction", out_sign * swing.z, -40.0, 160.0);
                add(role, "rotation", -out_sign * twist, -80.0, 80.0);
            } else {
                let [flexion, abduction, rotation] = hip_angles(pelvis.inverse() * upper_turn * limb.rest[0], out_sign);
                add(role, "flexion", flexion, HIP[0][0], HIP[0][1]);
                add(role, "abduction", abduction, HIP[1][0], HIP[1][1]);
                add(role, "rotation", rotation, ROTATION[0], ROTATION[1]);
            }
            let Some(lower) = limb.joints[1] else { continue };
            let lower_turn = pose.turns[lower];
            let (from, to) = (upper_turn * limb.along[0], lower_turn * limb.along[1]);
            let bend = real::atan2(from.cross(to).dot(upper_turn * limb.hinge), from.dot(to));
            let most = if limb.arm { 145.0 } else { 150.0 };
            add(body.joints[lower].role, "flexion", bend, 0.0, most);
            let Some(end) = limb.joints[2] else { continue };
            let end_role = body.joints[end].role;
            if limb.arm {
                // Against the forearm, in the axes of the arm that hangs: the palm faces the thigh.
                let relative = limb.rest[1].inverse() * (lower_turn.inverse() * pose.turns[end]) * limb.rest[1];
                let (swing, _) = swing_twist(relative, DVec3::Y);
                add(end_role, "flexion", -out_sign * swing.z, -70.0, 75.0);
                add(end_role, "deviation", swing.x, -20.0, 35.0);
            } else {
                let [flexion, inversion] = limb.ankle(lower_turn, pose.turns[end]);
                add(end_role, "flexion", flexion, ANKLE[0][0], ANKLE[0][1]);
                add(end_role, "inversion", inversion, ANKLE[1][0], ANKLE[1][1]);
            }
            if let Some(toes) = limb.joints[3] {
                let foot = pose.turns[end] * limb.level[0];
                let relative = shortest(foot.inverse() * pose.turns[toes] * limb.level[1]).to_scaled_axis();
                let lift = relative.dot(limb.forward.cross(DVec3::Y));
                add(body.joints[toes].role, "flexion", lift, -30.0, 60.0);
            }
        }
    }
}

impl Limb {
    fn of(body: &Body, side: Side, arm: bool) -> Option<Limb> {
        let roles = if arm {
            [Role::LeftUpperArm, Role::LeftLowerArm, Role::LeftHand, Role::LeftHand]
        } else {
            [Role::LeftUpperLeg, Role::LeftLowerLeg, Role::LeftFoot, Role::LeftToes]
        };
        let find = |role: Role| body.joint(if side == Side::Left { role } else { role.mirrored() });
        let joints = [find(roles[0]), find(roles[1]), find(roles[2]), if arm { None } else { find(roles[3]) }];
        let at = |joint: usize| body.joints[joint].rest;
        let upper = (at(joints[1]?) - at(joints[0]?)).try_normalize()?;
        let lower = joints[2].and_then(|end| (at(end) - at(joints[1]?)).try_normalize()).unwrap_or(upper);
        let down = |to: DVec3| DQuat::from_rotation_arc(-DVec3::Y, to);
        let rest = [down(upper), down(lower)];
        let foot = &body.feet[side as usize];
        let level = [foot.level.inverse(), foot.toe_level.inverse()];
        let forward = foot.forward;
        let forward = dvec3(forward.x, 0.0, forward.y).normalize_or(DVec3::Z);
        // Hanging, elbows bend the forearm forwards (about -X) and knees the shank backwards from where the foot points;
        // a limb that rests well bent shows its hinge itself.
        let assumed = if arm { rest[0] * -DVec3::X } else { DVec3::Y.cross(forward) };
        let shown = upper.cross(lower);
        let bent = shown.length() > real::sin(15.0 * DEGREE) && shown.dot(assumed) > 0.5 * shown.length();
        let hinge = if bent { shown.normalize() } else { assumed };
        Some(Limb { side, arm, joints, rest, hinge, along: [upper, lower], forward, level })
    }

    /// Flexion and inversion of a foot against its shank; neutral where it is flat under an upright one.
    fn ankle(&self, shank: DQuat, foot: DQuat) -> [f64; 2] {
        let relative = (shank * self.rest[1]).inverse() * foot * self.level[0];
        let (swing, twist) = swing_twist(relative, DVec3::Y);
        let forward = DQuat::from_rotation_y(twist) * self.forward;
        [swing.dot(forward.cross(DVec3::Y)), -self.side.sign() * swing.dot(forward)]
    }
}

/// A rotation as a swing after a twist about an axis: (the swing's rotation vector, the twist's angle).
fn swing_twist(turn: DQuat, axis: DVec3) -> (DVec3, f64) {
    let turn = shortest(turn);
    let along = turn.xyz().dot(axis);
    let twist = DQuat::from_xyzw(axis.x * along, axis.y * along, axis.z * along, turn.w);
    let twist = if twist.length_squared() > 1e-18 { shortest(twist.normalize()) } else { DQuat::IDENTITY };
    let angle = 2.0 * real::atan2(twist.xyz().dot(axis), twist.w);
    (shortest(turn * twist.inverse()).to_scaled_axis(), angle)
}

/// Flexion, abduction, inward rotation of a thigh that hung straight: R = Rx(-flexion) Rz(abduction) Ry(rotation).
fn hip_angles(turn: DQuat, out_sign: f64) -> [f64; 3] {
    let down = turn * -DVec3::Y;
    let flexion = real::atan2(down.z, -down.y);
    let abduction = DVec2::new(down.y, down.z).length();
    let abduction = real::atan2(down.x, abduction);
    let bare = DQuat::from_rotation_x(-flexion) * DQuat::from_rotation_z(abduction);
    let spin = shortest(bare.inverse() * turn).to_scaled_axis().y;
    [flexion, out_sign * abduction, -out_sign * spin]
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    const D: f64 = DEGREE;

    /// The value (degrees) of an angle at a pose of the fixture.
    fn degrees(pose: &BodyPose, body: &Body, role: Role, axis: &str) -> f64 {
        let angles = angles(body, pose);
        let found = angles.iter().find(|angle| angle.role == role && angle.axis == axis);
        found.expect("an angle of the table").value / D
    }

    /// Turns a joint and all below it.
    fn turn(body: &Body, pose: &mut BodyPose, role: Role, by: DQuat) {
        let root = body.joint(role).expect("the fixture has it");
        for joint in root..body.joints.len() {
            let mut above = Some(joint);
            while let Some(at) = above {
                if at == root {
                    pose.turns[joint] = by * pose.turns[joint];
                    break;
                }
                above = body.joints[at].parent;
            }
        }
    }

    #[test]
    fn turns_about_anatomical_axes_read_as_their_angles_on_both_sides() {
        let body = fixture::body();
        let cases: [(Role, DQuat, &str, f64); 17] = [
            (Role::LeftUpperLeg, DQuat::from_rotation_x(-0.5), "flexion", 0.5),
            (Role::LeftUpperLeg, DQuat::from_rotation_z(0.4), "abduction", 0.4),
            (Role::RightUpperLeg, DQuat::from_rotation_z(-0.4), "abduction", 0.4),
            (Role::LeftUpperLeg, DQuat::from_rotation_y(-0.3), "rotation", 0.3),
            (Role::RightUpperLeg, DQuat::from_rotation_y(0.3), "rotation", 0.3),
            (Role::LeftLowerLeg, DQuat::from_rotation_x(0.9), "flexion", 0.9),
            (Role::LeftFoot, DQuat::from_rotation_x(-0.3), "flexion", 0.3),
            (Role::RightFoot, DQuat::from_rotation_x(0.6), "flexion", -0.6),
            (Role::LeftFoot, DQuat::from_rotation_z(-0.2), "inversion", 0.2),
            (Role::RightFoot, DQuat::from_rotation_z(0.2), "inversion", 0.2),
            (Role::LeftToes, DQuat::from_rotation_x(-0.7), "flexion", 0.7),
            (Role::LeftUpperArm, DQuat::from_rotation_x(-1.5), "flexion", 1.5),
            (Role::RightUpperArm, DQuat::from_rotation_z(-2.0), "abduction", 2.0),
            (Role::RightLowerArm, DQuat::from_rotation_x(-1.9), "flexion", 1.9),
            (Role::LeftHand, DQuat::from_rotation_z(-0.6), "flexion", 0.6),
            (Role::Spine, DQuat::from_rotation_x(0.4), "flexion", 0.4),
            (Role::Head, DQuat::from_rotation_y(0.9), "twist", 0.9),
        ];
        for (role, by, axis, expected) in cases {
            // The whole body turned and moved: the angles must not care.
            for heading in [0.0, 2.0] {
                let mut pose = BodyPose::rest(&body);
                turn(&body, &mut pose, role, by);
                turn(&body, &mut pose, Role::Hips, DQuat::from_rotation_y(heading) * DQuat::from_rotation_x(0.2));
                let found = degrees(&pose, &body, role, axis);
                assert!((found - expected / D).abs() < 1e-6, "{role:?} {axis}: {found} for {}", expected / D);
                let others = angles(&body, &pose);
                let stray = others.iter().filter(|a| !(a.role == role && a.axis == axis) && a.value.abs() > 1e-6);
                assert_eq!(stray.count(), 0, "{role:?} {axis} shows in other angles: {others:?}");
            }
        }
    }

    /// The fixture with its rest moved to a T-pose.
    fn t_posed() -> Body {
        let body = fixture::body();
        let mut pose = BodyPose::rest(&body);
        turn(&body, &mut pose, Role::LeftUpperArm, DQuat::from_rotation_z(90.0 * D));
        turn(&body, &mut pose, Role::RightUpperArm, DQuat::from_rotation_z(-90.0 * D));
        let positions = pose.positions(&body);
        let mut posed = body;
        for (joint, position) in posed.joints.iter_mut().zip(positions) {
            joint.rest = position;
        }
        posed
    }

    #[test]
    fn a_t_pose_reads_as_arms_out_and_lowered_arms_as_none() {
        let body = t_posed();
        let mut pose = BodyPose::rest(&body);
        assert!((degrees(&pose, &body, Role::LeftUpperArm, "abduction") - 90.0).abs() < 1e-6);
        turn(&body, &mut pose, Role::LeftUpperArm, DQuat::from_rotation_z(-90.0 * D));
        turn(&body, &mut pose, Role::LeftLowerArm, DQuat::from_rotation_x(-0.7));
        for axis in ["flexion", "abduction", "rotation"] {
            assert!(degrees(&pose, &body, Role::LeftUpperArm, axis).abs() < 1e-6);
        }
        assert!((degrees(&pose, &body, Role::LeftLowerArm, "flexion") * D - 0.7).abs() < 1e-9);
    }

    #[test]
    fn a_foot_that_rests_on_tiptoe_is_neutral_where_it_is_level() {
        let mut body = fixture::body();
        let lay_flat = DQuat::from_rotation_x(-0.6);
        body.feet[0].level = lay_flat;
        body.feet[0].toe_level = DQuat::IDENTITY;
        let pose = BodyPose::rest(&body);
        assert!((degrees(&pose, &body, Role::LeftFoot, "flexion") * D + 0.6).abs() < 1e-9);
        assert!((degrees(&pose, &body, Role::LeftToes, "flexion") * D - 0.6).abs() < 1e-9);
        let mut pose = pose;
        let foot = body.feet[0].ankle;
        pose.turns[foot] = lay_flat;
        assert!(degrees(&pose, &body, Role::LeftFoot, "flexion").abs() < 1e-9);
        assert!(degrees(&pose, &body, Role::LeftToes, "flexion").abs() < 1e-9);
    }

    #[test]
    fn a_knee_past_straight_and_an_elbow_bent_backwards_are_found() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 9, |pose, sample| {
            turn(&body, pose, Role::RightLowerLeg, DQuat::from_rotation_x(-0.02 * sample));
            turn(&body, pose, Role::LeftLowerArm, DQuat::from_rotation_x(0.05 * sample));
        });
        let found = joints(&Track::new(fixture::motion(&body, &poses)).expect("sound"));
        assert!((found.knee_past_straight - 0.16).abs() < 1e-9, "{found:?}");
        let roles: Vec<Role> = found.excesses.iter().map(|excess| excess.angle.role).collect();
        assert_eq!(roles, [Role::LeftLowerArm, Role::RightLowerLeg]);
        assert!((found.excesses[0].by - 0.4).abs() < 1e-9 && (found.excesses[0].time - 8.0 / 120.0).abs() < 1e-9);
    }

    #[test]
    fn a_foot_twisted_under_a_bent_leg_is_past_its_inversion() {
        let body = fixture::body();
        let poses = fixture::poses(&body, 2, |pose, _| {
            turn(&body, pose, Role::LeftFoot, DQuat::from_rotation_z(-45.0 * D));
        });
        let found = joints(&Track::new(fixture::motion(&body, &poses)).expect("sound"));
        assert_eq!(found.excesses.len(), 1, "{found:?}");
        assert!((found.excesses[0].by - 15.0 * D).abs() < 1e-9, "{found:?}");
    }
}
