//! A stand that is not feet side by side: what the law goes back to is then as given, not as measured on people. Scenario space, SI.

use super::control::Controller;
use super::figure::Figure;
use super::flat;
use super::stepping::EASED;
use crate::maths::hull::{closest_point, convex_hull, shrink};
use crate::maths::quat::{wrap_angle, yaw_of};
use crate::maths::real;
use crate::model::Side;
use glam::{DQuat, DVec2, DVec3};

/// m at legs of 0.83 m, the centre of mass is to rest so far inside the soles at least: nearer to their edges (5 cm) the law steps.
const INSIDE: f64 = 0.065;
/// m at such legs: feet that are nearer to how they are to stand do so.
pub(super) const NEAR: f64 = 0.1;
/// s at such legs, in which who stands turns to where his feet point.
const TURNS: f64 = 0.3;

/// m/s at such legs: who stands as given and is slower only sways, and steps when he leaves his soles, not before: a stance may have its
/// balance near their edges. That fast 25 N s make 89.5 kg, which people take without a step.
const SWAYS: f64 = 0.28;

/// How a body stands at ease.
#[derive(Clone, Debug, PartialEq)]
pub struct Stance {
    /// m, from the middle of the right sole to that of the left one when it faces +Z.
    pub apart: DVec2,
    /// rad, where each foot points in it.
    pub splay: [f64; 2],
    /// m, from the middle of both soles to where the centre of mass is to rest, when it faces +Z.
    pub over: DVec2,
    /// How the pelvis is turned against how it stood at first.
    pub pelvis: DQuat,
    /// m, how much higher than at first it is held.
    pub higher: f64,
    /// It is led elsewhere, and does not go back to it yet.
    pub left: bool,
    natural: [f64; 2], // rad, by how much feet of the natural stand point beside that
    middle: DVec2,
    inside: Vec<DVec2>, // where `over` may be
}

impl Stance {
    /// As a controller's figure stands now; `splay`: where its feet point, rad; `ahead`: m, from the ankle to where a
    /// foot bears best, and rad that feet of the natural stand point outwards.
    pub fn of(control: &mut Controller, figure: &Figure, splay: [f64; 2], (ahead, toe_out): (f64, f64)) -> Stance {
        control.middle = ahead;
        let middles = Side::BOTH.map(|side| {
            let out = splay[side as usize];
            flat(control.states()[figure.legs[side as usize][2]].origin)
                + DVec2::new(real::sin(out), real::cos(out)) * ahead
        });
        let middle = 0.5 * (middles[0] + middles[1]);
        let soles = Side::BOTH.map(|side| figure.sole_at(control.states(), side).map(|corner| flat(corner) - middle));
        let hull = convex_hull(&soles.into_iter().flatten().collect::<Vec<DVec2>>());
        Stance {
            apart: middles[0] - middles[1],
            splay,
            over: DVec2::ZERO,
            pelvis: DQuat::IDENTITY,
            higher: 0.0,
            left: false,
            natural: Side::BOTH.map(|side| side.sign() * toe_out - splay[side as usize]),
            middle,
            inside: shrink(&hull, INSIDE * control.size),
        }
    }

    /// The centre of mass is to rest under that point (m) with the figure where it stood at first, as near as the soles allow; of the way
    /// there from their middle so much.
    pub fn rest_at(&mut self, com: DVec3, share: f64) {
        let over = flat(com) - self.middle;
        self.over = closest_point(&self.inside, over).unwrap_or_default() * share;
    }

    /// m, from the right sole to the left one when it faces there (rad).
    pub(super) fn apart_at(&self, heading: f64) -> DVec2 {
        turned(self.apart, heading)
    }
}

/// About +Y.
fn turned(at: DVec2, heading: f64) -> DVec2 {
    flat(DQuat::from_rotation_y(heading) * DVec3::new(at.x, 0.0, at.y))
}

impl Controller {
    /// rad, where a foot points whose link is turned so.
    pub(super) fn points(&self, side: Side, yaw: f64) -> f64 {
        self.stance.as_ref().map_or(yaw, |stance| yaw + stance.splay[side as usize])
    }

    /// m, where the centre of mass is to rest over both feet, whose soles have that middle.
    pub(super) fn at_rest(&self, middle: DVec2) -> DVec2 {
        self.stance.as_ref().map_or(middle, |stance| middle + turned(stance.over, self.heading))
    }

    /// rad, by how much a foot that steps is to point beside how it stands at ease: as of the natural stand, where it does not go there.
    pub(super) fn turned_out(&self, side: Side) -> f64 {
        let fights = self.swing.is_some_and(|swing| !swing.comfort);
        self.stance.as_ref().filter(|_| fights).map_or(0.0, |stance| stance.natural[side as usize])
    }

    /// Is a foot being set back to where it stands as given, or has just been? Balance is then over its other foot's edge, and fights nothing.
    pub(super) fn goes_home(&self) -> bool {
        self.stance.as_ref().is_some_and(|stance| !stance.left)
            && (self.guide.is_some() || self.time - self.eased < EASED * self.tempo())
    }

    /// How the pelvis is turned besides.
    pub(super) fn tilted(&self) -> DQuat {
        self.stance.as_ref().map_or(DQuat::IDENTITY, |stance| stance.pelvis)
    }

    /// m, by how much its pelvis is higher.
    pub(super) fn raised(&self) -> f64 {
        self.stance.as_ref().map_or(0.0, |stance| stance.higher)
    }

    /// m at legs of 0.83 m, how far a foot is from where it would stand beside the other, a radian of its turn being 0.3 m.
    pub(super) fn strays(&self, figure: &Figure, side: Side, apart: DVec2) -> f64 {
        let (own, other) = (self.sole_middle(figure, side), self.sole_middle(figure, side.other()));
        let turned = wrap_angle(self.foot(figure, side).1 - self.heading).abs();
        own.distance(other + apart * side.sign()) / self.size + 0.3 * turned
    }

    /// Do both feet stand as given?
    pub fn is_home(&self, figure: &Figure) -> bool {
        let Some(stance) = &self.stance else { return true };
        let apart = stance.apart_at(self.heading);
        !stance.left && self.swing.is_none() && Side::BOTH.iter().all(|side| self.strays(figure, *side, apart) < NEAR)
    }

    /// Does it stand as given and only sway?
    pub(super) fn sways(&self, figure: &Figure) -> bool {
        let slow = self.motion.velocity.length() < SWAYS * self.tempo();
        slow && self.stance.is_some() && self.is_home(figure)
    }

    /// Who stands as given faces as his feet do.
    pub(super) fn face_as_feet(&mut self, figure: &Figure, dt: f64) {
        if self.stance.is_none() || self.guide.is_some() || !self.is_home(figure) {
            return;
        }
        let points = |side: Side| yaw_of(self.states[figure.legs[side as usize][2]].turn);
        let yaws = Side::BOTH.map(|side| wrap_angle(points(side) - self.heading));
        let share = (dt / (TURNS * self.tempo())).min(1.0);
        self.heading += share * 0.5 * (yaws[0] + yaws[1]);
    }
}
