//! A plan from outside that the law follows: where the pressure is to be, which foot goes where and when, where the pelvis points.
//!
//! Who plans does not know links and torques, the law does not know what for. As long as a guide is there, steps are its steps; the law
//! keeps the pressure where it is wanted (`over_pressure`), the pelvis upright and turned, and swings the foot. When the guide goes, a
//! foot in the air is brought down by the law's own rules. Scenario space, SI.

use super::control::{Controller, Swing};
use super::figure::{Figure, Part};
use super::flat;
use super::swing::Reference;
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::{DQuat, DVec2, DVec3};

/// Feet come down before their time by this much of it: what swings reaches the ground before its path ends there.
const LATER: f64 = 1.046;
/// Share of the angular momentum in ξ where the pressure is held where it is planned.
pub(super) const MOMENTUM: f64 = 0.9;
/// What a radian per second squared of the pelvis counts under a guide, tilt and yaw.
pub(super) const UPRIGHT: [f64; 2] = [0.062, 1.5];
/// Share of a leg's length that it is to use under a guide.
pub(super) const LEGS: f64 = 0.96;
/// Share of a guided swing by which the foot must be off the ground.
pub(super) const RISE: f64 = 0.01;
/// rad at 1 m/s: swing of the arms and twist of the trunk.
const ARMS: f64 = 0.6;
const TWIST: f64 = 0.08;
/// Share of a swing before which ground under the foot is not where it lands: near its place, and elsewhere.
const SCUFFS: [f64; 2] = [0.6, 0.8];
/// m at legs of 0.83 m: that near a foot is at its place.
const NEAR: f64 = 0.1;
/// s at such legs: what is left of a swing that the law takes over.
const HASTE: f64 = 0.25;

/// Share of its speed that corrective steps of who is going somewhere keep; s at legs of 0.83 m, how long such a step takes.
const KEEPS: f64 = 0.5;
const STEPS: f64 = 0.28;

/// rad by which the trunk leans for each share of the leg by which the pelvis is lower.
const LEANS: f64 = 2.0;

/// A step that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Which foot.
    pub side: Side,
    /// m, where its ankle is to stand, (x, z).
    pub ankle: DVec2,
    /// rad, how its link is then to be turned.
    pub yaw: f64,
    /// s, until then; infinite of a foot that is held up.
    pub left: f64,
    /// m, how high it goes.
    pub lift: f64,
    /// m, how high it is to be held now, of a foot that is held up.
    pub height: Option<f64>,
}

/// What is wanted of the law in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// m, the centre of pressure, (x, z).
    pub pressure: DVec2,
    /// rad, where the pelvis is to point.
    pub heading: f64,
    /// m/s, how fast it goes, (x, z).
    pub velocity: DVec2,
    /// The step under way.
    pub swing: Option<Wish>,
    /// The foot that is about to leave.
    pub leaves: Option<Side>,
    /// The foot that swings or is next, and where in its step that is, 0 to 1; its time, s. `None` where nothing alternates.
    pub stride: Option<(Side, f64, f64)>,
}

impl Controller {
    /// The guide's part in a tick; false where there is none.
    pub(super) fn led(&mut self, figure: &Figure, terrain: &Terrain, pressed: [bool; 2], dt: f64) -> bool {
        let Some(guide) = self.guide else {
            self.take_over();
            return false;
        };
        (self.heading, self.facing) = (guide.heading, guide.heading);
        (self.shifting, self.leaving, self.quiet) = (None, None, 0.0);
        let Some(wish) = guide.swing else {
            (self.swing, self.guided) = (None, false);
            return true;
        };
        let mut swing = match self.swing {
            Some(swing) if swing.side == wish.side => swing,
            _ => self.lifted(figure, &wish),
        };
        self.guided = true;
        let passed = self.time - swing.start;
        swing.target = wish.ankle + self.ahead(wish.yaw);
        if wish.left.is_finite() {
            swing.time = passed + wish.left * LATER;
        }
        let (ankle, _) = self.foot(figure, swing.side);
        let near = flat(ankle).distance(wish.ankle) < NEAR * self.size;
        let comes_down = wish.height.is_none_or(|height| wish.left.is_finite() && height < 0.3 * swing.lift);
        let down = pressed[swing.side as usize];
        if down && comes_down && passed > SCUFFS[usize::from(!near)] * swing.time {
            self.swing = None;
            self.guided = false;
            self.last = Some(swing.side);
            if wish.height.is_some() {
                self.eased = self.time;
            }
            return true;
        }
        self.carry_on(figure, swing, terrain, down, dt);
        if let (Some(height), Some(swing)) = (wish.height, self.swing.as_mut()) {
            let ground = terrain.spot(wish.ankle).height;
            swing.reference.at.y = ground + height - if wish.left <= 0.0 { 0.02 * self.size } else { 0.0 };
            (swing.reference.velocity.y, swing.reference.acceleration.y) = (0.0, 0.0);
        }
        true
    }

    /// The swing that the guide began, which it has let go of: it ends as a step against a fall.
    fn take_over(&mut self) {
        if !std::mem::take(&mut self.guided) {
            return;
        }
        if let Some(swing) = &mut self.swing {
            let left = (swing.start + swing.time - self.time).min(HASTE * self.size.sqrt()).max(0.1 * self.size.sqrt());
            swing.time = self.time - swing.start + left;
            if swing.time > 2.0 * self.size.sqrt() {
                (swing.start, swing.time) = (self.time, left);
            }
        }
    }

    /// A foot that leaves the ground for that.
    fn lifted(&self, figure: &Figure, wish: &Wish) -> Swing {
        let (ankle, yaw) = self.foot(figure, wish.side);
        let ground = ankle - DVec3::Y * figure.ankle_height;
        Swing {
            side: wish.side,
            start: self.time,
            time: if wish.left.is_finite() { wish.left * LATER } else { 1.0 },
            target: self.sole_middle(figure, wish.side),
            from: ground,
            lift: wish.lift,
            reference: Reference { at: ground, ..Reference::default() },
            comfort: false,
            yaw,
            free: false,
        }
    }

    /// The turn by which who holds his pelvis low leans his trunk, so that it stays over his feet.
    pub(super) fn bowed(&self, figure: &Figure) -> DQuat {
        let lean = LEANS * self.lower / figure.leg_length;
        if lean == 0.0 { DQuat::IDENTITY } else { DQuat::from_rotation_x(lean) }
    }

    /// rad, where a swinging foot is to point when it lands.
    pub(super) fn foot_heading(&self, side: Side) -> f64 {
        let wish = self.guide.and_then(|guide| guide.swing).filter(|wish| wish.side == side);
        wish.map_or(self.heading, |wish| wish.yaw)
    }

    /// Is a foot held up?
    pub fn held_up(&self) -> bool {
        self.guide.and_then(|guide| guide.swing).is_some_and(|wish| wish.height.is_some())
    }

    /// m, by how much corrective steps are to fall short of ξ so that it keeps its speed.
    pub(super) fn drift(&self, rate: f64) -> DVec2 {
        let time = STEPS * self.size.sqrt();
        self.going * (KEEPS * time / (real::exp(rate * time) - 1.0))
    }

    /// Is the law following a guide?
    pub fn follows(&self) -> bool {
        self.guide.is_some()
    }

    /// Is the law at work on its own: does it step, or bring a foot beside the other?
    pub fn occupied(&self) -> bool {
        self.swing.is_some() && !self.guided || self.shifting.is_some()
    }

    /// rad, where it faces from now on when nothing disturbs it.
    pub fn look(&mut self, heading: f64) {
        let turned = wrap_angle(heading - self.facing);
        self.facing += turned;
        self.heading += turned;
    }

    /// rad, where it faces when nothing disturbs it.
    pub fn looks(&self) -> f64 {
        self.facing
    }

    /// rad, rad/s, rad/s²: how arms (about x) and trunk (about y) swing against the legs of a guide's stride.
    pub(super) fn against_stride(&self, figure: &Figure, link: usize) -> [f64; 3] {
        let Some(Guide { stride: Some((swings, share, time)), velocity, .. }) = self.guide else { return [0.0; 3] };
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let pace = velocity.dot(ahead) / self.size.sqrt();
        let most = match figure.links[link].part {
            // The arm of the side that swings is ahead at the step's start; ahead is about -x.
            Part::UpperArm(side) => -ARMS * pace * if side == swings { 1.0 } else { -1.0 },
            Part::Trunk => -TWIST * pace * swings.sign(),
            _ => return [0.0; 3],
        };
        let turn = std::f64::consts::PI / time.max(0.1);
        let (sin, cos) = real::sin_cos(std::f64::consts::PI * share.clamp(0.0, 1.2));
        [most * cos, -most * turn * sin, -most * turn * turn * cos]
    }
}
