//! Where a push takes hold of the body: what of it whips the head, bends trunk or hips, twists the shoulders, swings an arm.
//!
//! A [`Blow`] is a push with its part of the body, found once in the natural stand; [`struck`] sums those that act in a tick as
//! `reaction` feels them. Scenario space, SI; what is for the facing frame says so. An arm passes its push on to its shoulder,
//! a leg to the hips, a neck only some of it. Leaves out where on the skin a push acts, and pushes from above.

use super::anatomy::Anatomy;
use super::solve::Solver;
use super::stand::natural_stand;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::measure::{KnownPush, PushPoint};
use crate::model::{Body, Physique, Role, Side};
use glam::{DVec2, DVec3};

/// What a neck passes on to the trunk.
const THROUGH_NECK: f64 = 0.6;
/// What an arm does; the rest swings it.
const THROUGH_ARM: f64 = 0.85;
/// Part of the way from hips to shoulders up to which a push is felt at the hips.
const HIPS_REACH: f64 = 0.4;

/// A push on a part of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blow {
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// N, world.
    pub force: DVec3,
    /// m over the centre of mass, where the trunk feels it.
    pub arm: f64,
    /// m from the body's middle, where it feels it: left, forward.
    pub beside: DVec2,
    /// 0..1, how much of it the head takes.
    pub head: f64,
    /// 0..1, how much of it the hips take.
    pub hips: f64,
    /// 0..1, by how much it swings the left and the right arm.
    pub arms: [f64; 2],
}

/// The sum of what acts now, in the facing frame (left, forward).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Struck {
    /// N m, the moment about the centre of mass that tips the trunk that way.
    pub tipping: DVec2,
    /// N on the head.
    pub head: DVec2,
    /// N on the hips.
    pub hips: DVec2,
    /// N on the arms.
    pub arms: [DVec2; 2],
    /// N m about the vertical, positive turns to the left.
    pub twist: f64,
}

impl Blow {
    /// Of the pushes on a body.
    pub fn of(body: &Body, anatomy: &Anatomy, physique: &Physique, pushes: &[KnownPush]) -> Vec<Blow> {
        let stand = natural_stand(body, physique);
        let (com, standing) = (stand.com, Solver::new(body, anatomy).solve(&stand).pose);
        let places = standing.positions(body);
        let blow = |push: &KnownPush| {
            let (joint, at) = match push.at {
                // Of a joint of the trunk: at its middle.
                PushPoint::Joint(joint) => (joint, places[joint].with_x(0.0).with_z(0.0)),
                PushPoint::Segment(joint, offset) => (joint, places[joint] + standing.turns[joint] * offset),
                PushPoint::Centre => (0, com),
                PushPoint::World(point) => (0, point),
            };
            let mut blow = Blow {
                start: push.start,
                end: push.end,
                force: push.force,
                arm: at.y - com.y,
                beside: DVec2::new(at.x, at.z),
                head: 0.0,
                hips: 0.0,
                arms: [0.0; 2],
            };
            blow.take(body, anatomy, &places, joint, com.y);
            blow
        };
        pushes.iter().map(blow).collect()
    }

    /// Finds the part of the body that takes it.
    fn take(&mut self, body: &Body, anatomy: &Anatomy, places: &[DVec3], joint: usize, com: f64) {
        let shoulders = (places[anatomy.arms[0].upper] + places[anatomy.arms[1].upper]) * 0.5;
        let hips = (places[anatomy.legs[0].upper] + places[anatomy.legs[1].upper]) * 0.5;
        let mut part = Some(joint);
        while let Some(here) = part {
            if matches!(body.joints[here].role, Role::Chest | Role::UpperChest) {
                self.arm = self.arm.min(shoulders.y - com);
                return;
            }
            if here == anatomy.head || Some(here) == anatomy.neck {
                self.head = if here == anatomy.head { 1.0 } else { 0.5 };
                let passed = 1.0 - (1.0 - THROUGH_NECK) * self.head;
                (self.arm, self.beside) = ((shoulders.y - com) * passed, DVec2::ZERO);
                return;
            }
            for side in Side::BOTH {
                let (arm, leg) = (&anatomy.arms[side as usize], &anatomy.legs[side as usize]);
                let along =
                    [(Some(arm.hand), 1.0), (Some(arm.lower), 0.7), (Some(arm.upper), 0.35), (arm.shoulder, 0.0)];
                if let Some((_, swings)) = along.into_iter().find(|(known, _)| *known == Some(here)) {
                    let shoulder = places[arm.upper];
                    self.arms[side as usize] = swings;
                    let passed = 1.0 - (1.0 - THROUGH_ARM) * swings;
                    self.arm = (shoulder.y - com) * passed;
                    self.beside = DVec2::new(shoulder.x, shoulder.z) * passed;
                    return;
                }
                if let Some((_, share)) =
                    [(leg.upper, 1.0), (leg.lower, 0.5), (leg.foot, 0.2)].into_iter().find(|(known, _)| *known == here)
                {
                    (self.arm, self.hips) = (hips.y - com, share);
                    self.beside = DVec2::ZERO;
                    return;
                }
            }
            part = body.joints[here].parent;
        }
        let low = places[0].y.max(hips.y);
        let up = (com + self.arm - low) / ((shoulders.y - low) * HIPS_REACH).max(1e-6);
        self.hips = 1.0 - smooth3(up);
        self.arm = self.arm.min(shoulders.y - com);
    }
}

/// What acts during the tick of `dt` s that ends at `time` (s) on a body that faces `facing` (rad).
pub fn struck(blows: &[Blow], facing: f64, time: f64, dt: f64) -> Struck {
    let (sin, cos) = real::sin_cos(facing);
    let mut sum = Struck::default();
    for blow in blows {
        let share = ((blow.end.min(time) - blow.start.max(time - dt)) / dt).clamp(0.0, 1.0);
        if share < 1e-9 {
            continue;
        }
        let force = blow.force * share;
        let force = DVec2::new(force.x * cos - force.z * sin, force.x * sin + force.z * cos);
        sum.tipping += force * blow.arm;
        sum.head += force * blow.head;
        sum.hips += force * blow.hips;
        sum.twist += blow.beside.y * force.x - blow.beside.x * force.y;
        for side in 0..2 {
            sum.arms[side] += force * blow.arms[side];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fixture;

    fn blow(role: Role, force: DVec3) -> Blow {
        let body = fixture::body();
        let joint = body.joint(role).expect("the fixture has it");
        let push = KnownPush { start: 1.0, end: 1.2, force, at: PushPoint::Joint(joint) };
        Blow::of(&body, &Anatomy::new(&body), &Physique::REFERENCE, &[push])[0]
    }

    #[test]
    fn each_part_of_the_body_takes_a_push_in_its_own_way() {
        let push = DVec3::Z * 300.0;
        let (head, hips) = (blow(Role::Head, push), blow(Role::Hips, push));
        let (hand, thigh) = (blow(Role::LeftHand, push), blow(Role::RightUpperLeg, push));
        assert!(head.head == 1.0 && head.hips == 0.0, "{head:?}");
        assert!(hips.head == 0.0 && hips.hips > 0.8 && hips.arm < 0.1, "{hips:?}");
        assert!(hand.arms == [1.0, 0.0] && hand.arm > 0.1 && hand.beside.x > 0.1, "{hand:?}");
        assert!(thigh.hips == 1.0 && thigh.arms == [0.0; 2], "{thigh:?}");
    }

    #[test]
    fn a_push_at_the_left_shoulder_from_behind_twists_to_the_right_and_its_mirror_image_to_the_left() {
        let twist = |role, force| struck(&[blow(role, force)], 0.0, 1.1, 0.01).twist;
        let left = twist(Role::LeftUpperArm, DVec3::Z * 300.0);
        assert!(left < -20.0, "{left} N m");
        assert!((left + twist(Role::RightUpperArm, DVec3::Z * 300.0)).abs() < 1e-6);
        assert!((left + twist(Role::LeftUpperArm, DVec3::NEG_Z * 300.0)).abs() < 1e-6);
    }

    #[test]
    fn a_push_counts_in_the_ticks_that_it_acts_in_and_as_the_body_faces() {
        let blow = blow(Role::Hips, DVec3::X * 100.0);
        let hips = |time: f64, facing: f64| struck(&[blow], facing, time, 0.01).hips / blow.hips;
        assert_eq!(hips(1.0, 0.0), DVec2::ZERO);
        assert!((hips(1.005, 0.0).x - 50.0).abs() < 1e-6 && (hips(1.2, 0.0).x - 100.0).abs() < 1e-6);
        assert_eq!(hips(1.22, 0.0), DVec2::ZERO);
        // Facing its left, where the push goes to, it is pushed forwards.
        let ahead = hips(1.1, std::f64::consts::FRAC_PI_2);
        assert!((ahead - DVec2::Y * 100.0).length() < 1e-6, "{ahead}");
    }
}
