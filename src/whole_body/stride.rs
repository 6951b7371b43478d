//! What walking adds to the upper body: arms swing against the legs, the pelvis turns with them and drops on the side of
//! the swing. Radians, SI units.
//!
//! Driven by where the feet are, so that it keeps step with whatever the controller does; peaks as people show them
//! (shoulders about 15 degrees either way at 1.3 m/s, pelvis 5). Odd under mirroring. Knows no push: `reaction` adds.

use super::reaction::Senses;
use crate::maths::curve::soft_limit;
use crate::maths::real;
use crate::maths::spring::Spring;
use crate::model::{Physique, Side};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// rad of the shoulder for each leg length between the feet.
const ARM_SWING: f64 = 0.34;
/// rad of the pelvis likewise.
const PELVIS_TURN: f64 = 0.13;
/// rad, by how much more a walker's pelvis tilts forwards.
const PELVIS_TILT: f64 = 2.0 * TAU / 360.0;
/// Of the ground's grade (rad) the chest leans into it, up and down. The line from hips to neck, that has less of it, then
/// leans forward by 6 to 8 degrees more at 10 degrees up, as people's does, and is about upright going down.
const INTO_SLOPE: [f64; 2] = [1.0, 0.15];
/// rad, about what the grade of stairs comes to.
const STEEPEST: f64 = 0.35;
/// m/s (reference body), from which on it is a walk and no longer a shuffle.
const WALKING: f64 = 0.5;

/// Memory of the stride.
#[derive(Clone, Debug, Default)]
pub struct Stride {
    share: f64,
    arms: [Spring; 2],
    elbows: [Spring; 2],
    turn: Spring,
    grade: Spring,
    fresh: bool,
}

/// What it asks of the body now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrideAngles {
    /// 0 standing, 1 walking.
    pub share: f64,
    /// Of the pelvis relative to the facing, left positive.
    pub turn: f64,
    /// Flexion of the shoulders, left and right.
    pub arms: [f64; 2],
    /// Flexion of the elbows beyond the relaxed stand.
    pub elbows: [f64; 2],
    /// Lean of the trunk, forwards.
    pub lean: f64,
    /// Tilt of the pelvis, forwards.
    pub tilt: f64,
}

impl Stride {
    /// One tick of `dt` s.
    pub fn tick(&mut self, senses: &Senses, physique: &Physique, dt: f64) -> StrideAngles {
        let scale = (physique.com_height / 0.96).sqrt();
        let pace = physique.leg_length / 0.83 / scale;
        let wanted = senses.wanted.length() / pace;
        let to = (wanted / WALKING).min(1.0);
        if self.fresh {
            self.share += (to - self.share) * (1.0 - real::exp(-dt / (0.35 * scale)));
        } else {
            (self.share, self.fresh) = (to, true);
        }
        let ahead = DVec2::new(real::sin(senses.facing), real::cos(senses.facing));
        let between = senses.feet[0].ankle - senses.feet[1].ankle;
        let reach = between.x * ahead.x + between.z * ahead.y; // left foot ahead of the right
        let reach = soft_limit(reach / physique.leg_length, 1.2) * self.share;
        self.turn.step(-PELVIS_TURN * reach, TAU * 3.0 / scale, 0.8, dt);
        for side in Side::BOTH {
            let swing = -side.sign() * ARM_SWING * reach;
            let (arm, elbow) = (&mut self.arms[side as usize], &mut self.elbows[side as usize]);
            arm.step(swing, TAU * 2.2 / scale, 0.9, dt);
            elbow.step(self.share * 0.06 + 0.8 * swing.max(0.0), TAU * 2.0 / scale, 0.9, dt);
        }
        let grade = grade(senses, physique, ahead).unwrap_or(self.grade.x);
        self.grade.step(grade, TAU * 0.6 / scale, 1.0, dt);
        let into = INTO_SLOPE[usize::from(self.grade.x < 0.0)] * soft_limit(self.grade.x, STEEPEST);
        let forward = senses.wanted.dot(ahead) / pace;
        StrideAngles {
            share: self.share,
            turn: self.turn.x,
            arms: [self.arms[0].x, self.arms[1].x],
            elbows: [self.elbows[0].x, self.elbows[1].x],
            lean: (0.02 * soft_limit(forward, 2.0) + into) * self.share,
            tilt: PELVIS_TILT * soft_limit(forward.max(0.0), 1.0) * self.share,
        }
    }
}

/// rad, how steeply the ground rises ahead: from foot to foot where both stand far enough apart, else as the soles lie.
/// `None` where neither tells.
fn grade(senses: &Senses, physique: &Physique, ahead: DVec2) -> Option<f64> {
    let along = |point: DVec3| point.x * ahead.x + point.z * ahead.y;
    let between = senses.feet[0].ankle - senses.feet[1].ankle;
    let apart = along(between);
    if senses.planted == [true; 2] && apart.abs() > 0.2 * physique.leg_length {
        return Some(real::atan(between.y / apart));
    }
    let leaning = Side::BOTH.into_iter().filter(|side| senses.planted[*side as usize]);
    let normals: DVec3 = leaning.map(|side| senses.feet[side as usize].normal).sum();
    let leans = along(normals).abs() > 1e-9;
    leans.then(|| real::atan2(-along(normals), normals.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Plant;

    fn senses(left_ahead: f64, speed: f64) -> Senses {
        Senses {
            acceleration: DVec3::ZERO,
            push: DVec3::ZERO,
            push_moment: DVec3::ZERO,
            xi: DVec2::ZERO,
            velocity: DVec2::new(0.0, speed),
            wanted: DVec2::new(0.0, speed),
            crouched: 0.0,
            on_one: false,
            safe: 0.0,
            feet: Side::BOTH
                .map(|side| Plant::level(DVec3::new(0.1 * side.sign(), 0.0, 0.5 * side.sign() * left_ahead), 0.0)),
            planted: [true; 2],
            facing: 0.0,
        }
    }

    fn settled(left_ahead: f64, speed: f64) -> StrideAngles {
        let physique = Physique::REFERENCE;
        let mut stride = Stride::default();
        let mut angles = StrideAngles::default();
        for _ in 0..300 {
            angles = stride.tick(&senses(left_ahead, speed), &physique, 0.01);
        }
        angles
    }

    #[test]
    fn the_arm_of_the_foot_ahead_swings_back_and_that_hip_goes_forward() {
        let angles = settled(0.66, 1.3);
        assert!(angles.arms[0] < -0.2 && angles.arms[1] > 0.2, "{angles:?}");
        assert!((angles.turn.to_degrees() + 6.0).abs() < 2.0, "the left hip forward: {}", angles.turn.to_degrees());
        let mirrored = settled(-0.66, 1.3);
        assert!((angles.arms[0] - mirrored.arms[1]).abs() < 1e-12 && (angles.turn + mirrored.turn).abs() < 1e-12);
    }

    #[test]
    fn a_stand_with_one_foot_ahead_does_not_swing_its_arms() {
        assert_eq!(settled(0.3, 0.0), StrideAngles { arms: [0.0, 0.0], ..StrideAngles::default() });
    }

    #[test]
    fn the_trunk_leans_into_a_rise_and_hardly_back_from_a_fall() {
        let leaning = |degrees: f64, speed: f64| {
            let angle = degrees.to_radians();
            let mut senses = senses(0.6, speed);
            for foot in &mut senses.feet {
                foot.ankle.y = foot.ankle.z * real::tan(angle);
                foot.normal = DVec3::new(0.0, real::cos(angle), -real::sin(angle));
            }
            let mut stride = Stride::default();
            (0..400).map(|_| stride.tick(&senses, &Physique::REFERENCE, 0.01).lean).fold(0.0, |_, lean| lean)
        };
        let more = |degrees: f64| leaning(degrees, 1.2) - leaning(0.0, 1.2);
        assert!((0.14..0.18).contains(&more(10.0)), "{}", more(10.0));
        assert!((-0.05..-0.01).contains(&more(-10.0)), "{}", more(-10.0));
        assert!(more(45.0) < 0.36 && leaning(10.0, 0.0) == 0.0, "{}", more(45.0));
    }
}
