//! The natural stand: arms down, legs almost straight, feet side by side. Scenario space, metres.
//!
//! Clips start and end in it, whatever the bind pose is, and the stepper takes its lengths from it. The values are those
//! that read as a relaxed adult; style dials and base clips change them elsewhere.

use super::anatomy::Anatomy;
use super::solve::{ArmAngles, FootTarget, Hold, PoseTarget, Solved, Solver};
use crate::maths::quat::yaw_of;
use crate::maths::real;
use crate::model::{Body, Side};
use crate::model::{Physique, Plant};
use glam::{DQuat, DVec3};

/// Part of the leg's full length that a relaxed stand uses.
const STAND_STRETCH: f64 = 0.992;
/// Outward turn of each foot, rad.
const TOE_OUT: f64 = 6.0 * std::f64::consts::PI / 180.0;
/// Where the centre of mass stands over the sole, from heel (0) to tip (1).
const COM_OVER_SOLE: f64 = 0.42;
/// Forward lean of the trunk, rad.
pub const TRUNK_LEAN: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Hanging arms of a relaxed stand.
pub fn relaxed_arms() -> ArmAngles {
    ArmAngles {
        raise: 4_f64.to_radians(),
        abduct: 9_f64.to_radians(),
        inward: 8_f64.to_radians(),
        elbow: 16_f64.to_radians(),
        curl: 20_f64.to_radians(),
    }
}

/// The most by which arms are spread for it, rad: past that they do not hang, and stay as they are.
const MOST_WIDENING: f64 = 28.0 * std::f64::consts::PI / 180.0;

/// rad, by how much more than [`relaxed_arms`] an arm must be abducted for its hand to be `flank` (m, [`Body::flanks`]) out of
/// the middle plane. `lengths`: upper arm and forearm, m; `shoulder`: how far out it is, m.
pub(super) fn widening(lengths: [f64; 2], shoulder: f64, flank: f64) -> f64 {
    let relaxed = relaxed_arms();
    // Where the wrist is with the arm abducted: the same chain as the solver's, for the left side.
    let wrist = |widen: f64| {
        let upper = DQuat::from_rotation_z(widen + relaxed.abduct)
            * DQuat::from_rotation_x(-relaxed.raise)
            * DQuat::from_rotation_y(-relaxed.inward);
        let lower = upper * DQuat::from_rotation_x(-relaxed.elbow);
        shoulder + (upper * DVec3::NEG_Y * lengths[0] + lower * DVec3::NEG_Y * lengths[1]).x
    };
    if wrist(0.0) >= flank || wrist(MOST_WIDENING) < flank {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST_WIDENING);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if wrist(middle) < flank { low = middle } else { high = middle }
    }
    high
}

/// A foot flat on the ground (y = `plant.ankle.y`) at a plant.
pub fn flat_foot(body: &Body, side: Side, plant: &Plant) -> FootTarget {
    let shape = &body.feet[side as usize];
    let rest_yaw = real::atan2(shape.forward.x, shape.forward.y);
    let turn = DQuat::from_rotation_y(plant.yaw - rest_yaw);
    FootTarget {
        ankle: plant.ankle + DVec3::Y * shape.ankle_height,
        foot: turn * shape.level,
        toe: turn * shape.toe_level,
        yaw: plant.yaw,
        soft: 0.0,
        bend: None,
        swivel: 0.0,
    }
}

/// The stand's target with the feet at those plants, the centre of mass where given, the pelvis facing `facing` (rad).
pub fn stand_target(body: &Body, plants: &[Plant; 2], com: DVec3, facing: f64) -> PoseTarget {
    let yaw = DQuat::from_rotation_y(facing);
    PoseTarget {
        com,
        pelvis: yaw,
        chest: yaw * DQuat::from_rotation_x(TRUNK_LEAN),
        head: yaw,
        arms: [relaxed_arms(); 2],
        feet: Side::BOTH.map(|side| flat_foot(body, side, &plants[side as usize])),
        hold: None,
    }
}

/// The natural stand on level ground at the origin, facing +Z.
pub fn natural_stand(body: &Body, physique: &Physique) -> PoseTarget {
    let plants = natural_plants(physique.stance_width, physique.com_forward);
    stand_target(body, &plants, DVec3::Y * physique.com_height, 0.0)
}

/// Measures the body in its natural stand: what the stepper needs to know.
pub fn physique(body: &Body, anatomy: &Anatomy) -> Physique {
    physique_holding(body, anatomy, None)
}

/// The same with a box in the hands: mass and height of the centre of mass are those of both together.
pub fn physique_holding(body: &Body, anatomy: &Anatomy, hold: Option<Hold>) -> Physique {
    let leg_length = (anatomy.legs[0].length() + anatomy.legs[1].length()) * 0.5;
    let mean = |value: fn(&crate::model::FootShape) -> f64| (value(&body.feet[0]) + value(&body.feet[1])) * 0.5;
    let (heel, tip, half_width) = (mean(|f| f.heel), mean(|f| f.foremost()), mean(|f| f.half_width));
    let stance_width = Physique::natural_width(leg_length, anatomy.hip_width, half_width);
    let com_forward = heel + COM_OVER_SOLE * (tip - heel);
    let plants = natural_plants(stance_width, com_forward);
    // The height at which the longer-stretched leg reaches the stand's stretch, by bisection: the pose decides.
    let mut solver = Solver::new(body, anatomy);
    let (mut low, mut high) = (0.1 * body.height, body.height);
    let mut solved = None;
    for _ in 0..30 {
        let height = 0.5 * (low + high);
        let target = stand_target(body, &plants, DVec3::new(0.0, height, 0.0), 0.0);
        let pose = solver.solve(&hold.map_or(target, |hold| target.holding(hold)));
        let stretch = Side::BOTH
            .map(|side| {
                let ankle = plants[side as usize].ankle + DVec3::Y * body.feet[side as usize].ankle_height;
                (pose.hips[side as usize] - ankle).length() / anatomy.legs[side as usize].length()
            })
            .into_iter()
            .fold(0.0, f64::max);
        if stretch > STAND_STRETCH {
            high = height;
        } else {
            low = height;
        }
        solved = Some(pose);
    }
    let hip_height = solved.map_or(leg_length, |pose: Solved| (pose.hips[0].y + pose.hips[1].y) * 0.5);
    Physique {
        mass: body.mass + hold.map_or(0.0, |hold| hold.mass),
        com_height: low,
        leg_length,
        hip_height,
        ankle_height: mean(|f| f.ankle_height),
        stance_width,
        com_forward,
        toe_out: TOE_OUT,
        heel,
        tip,
        half_width,
        stance: None,
    }
}

/// Feet side by side under a centre of mass at the origin.
pub fn natural_plants(stance_width: f64, com_forward: f64) -> [Plant; 2] {
    Side::BOTH.map(|side| {
        let ankle = DVec3::new(side.sign() * stance_width * 0.5, 0.0, -com_forward);
        Plant::level(ankle, side.sign() * TOE_OUT)
    })
}

/// Heading of a foot turned by `turn` from rest, rad.
pub fn foot_yaw(body: &Body, side: Side, turn: DQuat) -> f64 {
    let shape = &body.feet[side as usize];
    yaw_of(turn * shape.level.inverse() * DQuat::from_rotation_y(real::atan2(shape.forward.x, shape.forward.y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arms_hang_wider_only_where_something_wide_is_beside_them_and_can_be_cleared() {
        let lengths = [0.30, 0.25];
        let hangs = 0.18 + 0.55 * real::sin(relaxed_arms().abduct);
        assert_eq!(widening(lengths, 0.18, 0.0), 0.0, "no mesh");
        assert_eq!(widening(lengths, 0.18, hangs - 0.03), 0.0, "narrow hips");
        assert_eq!(widening(lengths, 0.18, 1.5), 0.0, "a hoop skirt that no hanging arm clears");
        let skirt = widening(lengths, 0.18, hangs + 0.08);
        // 8 cm at the end of 0.55 m are about 8.5 degrees.
        assert!((6.0..12.0).contains(&skirt.to_degrees()), "{}", skirt.to_degrees());
        assert!(widening(lengths, 0.18, hangs + 0.10) > skirt);
        assert_eq!(widening([0.0, 0.0], 0.18, 0.3), 0.0);
    }
}
