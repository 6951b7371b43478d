//! A plan from outside that the law follows: where the pressure is to be, which foot goes where and when, where the pelvis points.
//!
//! Who plans does not know links and torques, the law does not know what for. As long as a guide is there, steps are its steps; the law
//! keeps the pressure where it is wanted (`over_pressure`), the pelvis upright and turned, and swings the foot. When the guide goes, a
//! foot in the air is brought down by the law's own rules. Scenario space, SI.

use super::control::{Controller, Swing};
use super::figure::{Figure, Part};
use super::flat;
use super::swing::Reference;
use crate::maths::curve::smooth3;
use crate::maths::quat::wrap_angle;
use crate::maths::real;
use crate::model::{Side, Terrain};
use glam::{DVec2, DVec3};

/// Feet come down before their time by this much of what is left of it: what swings reaches the ground before its path ends there.
const LATER: f64 = 1.08;
/// Times its planned time, the swing of a walk ahead that is not brisk, for its foot to land when it is planned to. Without this it lands 0.03 s
/// early, where ξ has not yet come, and the next step is wider for it: at 125 steps a minute half of the walks up 5 degrees are given up.
const IN_TIME: f64 = 1.07;
/// m/s at legs of 0.83 m between which that ends. Ended at 0.9, who sets out at 0.7 m/s walks 0.3 m wide for ten steps.
const HURRIES: [f64; 2] = [0.75, 0.95];
/// Share of the angular momentum in ξ where the pressure is held where it is planned.
pub(super) const MOMENTUM: f64 = 1.1;
/// What a radian per second squared of the pelvis counts under a guide, tilt and yaw.
pub(super) const UPRIGHT: [f64; 2] = [0.14, 2.9];
/// Share of a leg's length that it is to use under a guide; and where the way goes up by `UPHILL` or more a metre: a bent knee leans
/// the shank forward, and uphill the ankle has no range left for it.
const LEGS: [f64; 2] = [0.947, 0.995];
/// The same of the leg that carries while the other swings: with less, walks at 1.0 m/s and faster limp.
const CARRIES: f64 = 0.97;
const UPHILL: f64 = 0.17;
/// Shares of a guided swing by which the foot must be off the ground, and at which it is over its place.
const TRAVELS: [f64; 2] = [0.04, 0.945];
/// Times the law's own, how hard a guided swing's foot is turned.
const LEVELS: f64 = 1.4;
/// Share of a guided swing in which that comes in, of who goes somewhere, but not backwards or by stairs, over whose edges toes have to be
/// up at once. Turned as hard from its first tick on, a foot whose heel is up jumps by 5 degrees in a frame towards lying level, and its
/// leg then takes it on the other way.
const EASES: f64 = 0.5;
/// The second on balls: over bent knees a foot that is there sooner comes down before its ball is where it is to bear.
const ARRIVES: f64 = 0.976;
/// Damping of a guided swing's inverse, of a bent leg and of a straight one, and shares of its length between which it is the one and
/// the other. As damped as the law's own (0.2) a foot rises 4 cm and sinks to the ground again in mid-swing.
const DAMPING: [f64; 2] = [0.105, 0.175];
const STRAIGHT: [f64; 2] = [0.86, 0.96];
/// The same of every leg on its way down in a brisk walk, shares of a swing between which it comes to that, and from which m/s on a walk is
/// brisk and in full. As damped as before, a leg that is almost straight is not braked: its foot falls at 0.7 m/s, and each landing of a
/// walk of 1.1 m/s throws the body back by 0.1 m/s.
const LOWERED: f64 = 0.055;
const LOWERS: [f64; 2] = [0.25, 0.45];
const BRISK: [f64; 2] = [0.7, 0.9];
/// m at legs of 0.83 m, where ground that does not lean has an ankle beside its foot's ground point: by less than a degree.
const LEVEL: f64 = 0.001;
/// m at legs of 0.83 m, at most so much higher goes a guided foot whose toes hang down: where the leg that it leaves with leans forward
/// by more than the ankle's range.
pub(super) const CLEARS: f64 = 0.1;
/// Shares of a guided swing in which that height is gained and lost.
pub(super) const HANGS: [f64; 2] = [0.3, 0.4];
/// Share of a guided swing in which its leg, straight when it leaves, comes to use no more of its length than one that can be steered.
const BENDS: f64 = 0.2;
/// Share of a guided swing up to which a straight leg is steered by its knee, share in which that ends, and how much quicker than in the
/// law's own swings: in a slow walk and in a brisk one, where toes drag over the ground by 10 cm in each step otherwise, and on balls uphill: with
/// 2.0 there 5 of 40 walks up 25 degrees fall, with 5.0 knees bend at 900 degrees/s. By where its foot is to go alone, a straight leg is
/// dragged over the ground for 0.4 of the swing and then thrown ahead, which lifts the body off its feet.
const KNEES: [f64; 2] = [0.6, 0.25];
const QUICKER: [f64; 2] = [2.0, 5.0];
const QUICKER_UPHILL: f64 = 3.0;
/// rad at 1 m/s, to either side, in a slow walk and in a brisk one: how far the arms swing, the trunk turns against the pelvis, and the
/// pelvis with the leg that is ahead. Of people at 1.3 m/s by about 20, 8 and 5 degrees; who walks slowly hardly turns. Where arms alone
/// hold the feet's yaw they have to swing up to the horizontal for it.
const ARMS: [f64; 2] = [0.5, 0.38];
/// rad, to either side: arms are asked to swing no farther. They overshoot it by 5 to 8 degrees at 1.6 m/s.
const FARTHEST: f64 = 0.52;
const TWIST: [f64; 2] = [0.08, 0.25];
const PELVIS: [f64; 2] = [0.0, 0.1];
/// The arms where the ground leans.
const WIDER: f64 = 0.75;
/// Share of a swing before which ground under the foot is not where it lands: near its place, and elsewhere.
const SCUFFS: [f64; 2] = [0.6, 0.8];
/// The same of a turn on the spot, whose foot is at its place long before it points where it is to: with less, short legs land 13 degrees short.
const SCUFFS_TURNED: f64 = 0.85;
/// m at legs of 0.83 m: that near a foot is at its place.
const NEAR: f64 = 0.1;
/// s at such legs: what is left of a swing that the law takes over.
const HASTE: f64 = 0.25;

/// Share of how fast its height is to change that a pelvis follows in a walk of long strides, s over which that is taken and m/s, the most of
/// it. With none the pelvis comes 0.045 m late to where the legs of a step of 0.8 m need it, and the foot lands 0.1 m short on a straight leg.
const SINKS: f64 = 0.5;
const SINKS_OVER: f64 = 0.03;
const SINKS_BY: f64 = 0.5;

/// Share of its speed that corrective steps of who is going somewhere keep; s at legs of 0.83 m, how long such a step takes.
const KEEPS: f64 = 0.5;
const STEPS: f64 = 0.28;

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
    /// m, the centre of pressure, on the ground.
    pub pressure: DVec3,
    /// m, the ground's height from which the pelvis's counts; m/s, how fast that rises.
    pub floor: f64,
    /// As `floor` says.
    pub climbs: f64,
    /// rad, where the pelvis is to point.
    pub heading: f64,
    /// m/s, how fast it goes, (x, z).
    pub velocity: DVec2,
    /// rad, how far the trunk is to lean forwards.
    pub lean: f64,
    /// The foot whose heel is to rise, and how far, rad.
    pub heel: Option<(Side, f64)>,
    /// It turns on the spot.
    pub spot: bool,
    /// The step under way is the last one: it stands after it.
    pub ends: bool,
    /// The step under way.
    pub swing: Option<Wish>,
    /// The foot that is about to leave.
    pub leaves: Option<Side>,
    /// The foot that swings or is next, and where in its step that is, 0 to 1; its time, s. `None` where nothing alternates.
    pub stride: Option<(Side, f64, f64)>,
    /// How long its strides are for its speed, 0 to 1.
    pub strides: f64,
    /// Its feet are to land when they are planned to (`IN_TIME`).
    pub in_time: bool,
    /// How far feet stand on their balls, 0 to 1: where ankles have no range for ground that rises ahead.
    pub balls: f64,
}

/// How far a swinging leg has come from straight to one that can be steered, by the share of its swing.
pub(super) fn bends(share: f64) -> f64 {
    smooth3(share / BENDS)
}

fn within(value: f64, [from, to]: [f64; 2]) -> f64 {
    smooth3((value - from) / (to - from))
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
        swing.target = wish.ankle + self.ahead(wish.side, wish.yaw);
        if wish.left.is_finite() {
            swing.time = (passed + wish.left * LATER) * self.in_time();
        }
        let (ankle, _) = self.foot(figure, swing.side);
        let near = flat(ankle).distance(wish.ankle) < NEAR * self.size;
        let comes_down = wish.height.is_none_or(|height| wish.left.is_finite() && height < 0.3 * swing.lift);
        let down = pressed[swing.side as usize];
        let scuffs = if guide.spot { SCUFFS_TURNED } else { SCUFFS[usize::from(!near)] };
        if down && comes_down && passed > scuffs * swing.time {
            self.swing = None;
            self.guided = false;
            self.last = Some(swing.side);
            if wish.height.is_some() || guide.ends {
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
        let velocity = self.motion.origin_velocity(figure.legs[wish.side as usize][2]);
        Swing {
            side: wish.side,
            start: self.time,
            time: if wish.left.is_finite() { wish.left * LATER } else { 1.0 },
            target: self.sole_middle(figure, wish.side),
            from: ground,
            lift: wish.lift,
            reference: Reference { at: ground, velocity, ..Reference::default() },
            comfort: false,
            yaw,
            spin: 0.0,
            free: false,
        }
    }

    /// Share of its length that a leg is to use on the way that the guide goes, while the other swings (`carries`) and when it lands.
    pub(super) fn leg_used(&self, terrain: &Terrain, carries: bool) -> f64 {
        if self.guide.is_none() {
            return self.against_a_fall().reach[1];
        }
        let least = if carries { CARRIES } else { LEGS[0] };
        least + (LEGS[1] - least) * (self.uphill(terrain) / UPHILL).clamp(0.0, 1.0)
    }

    /// As `TRAVELS` says.
    pub(super) fn travels(&self) -> [f64; 2] {
        let [rise, arrives] = TRAVELS;
        [rise, (arrives + (ARRIVES - arrives) * self.on_balls()) / self.in_time()]
    }

    /// Times its planned time a swing is to last for its foot to land then.
    fn in_time(&self) -> f64 {
        let Some(guide) = self.guide.filter(|guide| guide.in_time) else { return 1.0 };
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let straight = guide.velocity.normalize_or_zero().dot(ahead).max(0.0).powi(2);
        1.0 + (IN_TIME - 1.0) * straight * (1.0 - self.faster_than(HURRIES)) * (1.0 - self.on_balls())
    }

    /// How brisk the walk is that is led, 0 to 1; where the ground leans, none is.
    fn brisk(&self) -> f64 {
        self.faster_than(BRISK)
    }

    /// How much faster it goes than the first of two speeds, 0 to 1 at the second; where the ground leans, it does not.
    fn faster_than(&self, speeds: [f64; 2]) -> f64 {
        let Some(guide) = self.guide.filter(|_| self.on_level()) else { return 0.0 };
        within(guide.velocity.length() / self.size.sqrt(), speeds)
    }

    /// Do its feet stand on level ground?
    pub(super) fn on_level(&self) -> bool {
        self.slants.iter().all(|slant| slant.length() < LEVEL * self.size)
    }

    /// s⁻² and s⁻¹, how hard a swinging foot is turned and damped at a share of its swing.
    pub(super) fn foot_turn(&self, share: f64) -> [f64; 2] {
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let goes = self.guide.map_or(DVec2::ZERO, |guide| guide.velocity);
        let eases = !self.treads && goes != DVec2::ZERO && goes.normalize().dot(ahead) > -0.5;
        let levels = match (self.guided, eases) {
            (true, true) => LEVELS * smooth3(share / EASES),
            (true, false) => LEVELS,
            (false, _) => 1.0,
        };
        let [stiff, damp] = self.tuning.foot_turn;
        [stiff * levels, damp * levels.sqrt()]
    }

    /// How much a straight leg is steered by its knee, by the share of a guided swing, and how much quicker.
    pub(super) fn knees(&self, share: f64) -> [f64; 2] {
        let [slow, brisk] = QUICKER;
        let level = slow + (brisk - slow) * self.brisk();
        let quicker = if self.on_level() { level } else { slow + (QUICKER_UPHILL - slow) * self.on_balls() };
        [smooth3((KNEES[0] - share) / KNEES[1]), quicker]
    }

    /// Takes in the height (m) at which the pelvis should be: what is aimed at goes there.
    pub(super) fn sink_to(&mut self, height: f64, dt: f64) {
        let most = self.tuning.sink * dt * self.size.sqrt();
        let step = (height - self.aimed).clamp(-most, most);
        self.aimed += step;
        self.sinking += (step / dt - self.sinking) * (dt / SINKS_OVER);
    }

    /// m/s, upwards: how fast the pelvis is to come to another height.
    pub(super) fn sinks(&self) -> f64 {
        self.sinking.clamp(-SINKS_BY, SINKS_BY) * SINKS * self.guide.map_or(0.0, |guide| guide.strides)
    }

    /// How far feet stand on their balls, 0 to 1.
    pub(super) fn on_balls(&self) -> f64 {
        self.guide.map_or(0.0, |guide| guide.balls)
    }

    /// By how much the ground rises a metre on the way that the guide goes.
    fn uphill(&self, terrain: &Terrain) -> f64 {
        let Some(guide) = self.guide else { return 0.0 };
        let normal = terrain.spot(flat(self.states[0].origin)).normal;
        -flat(normal).dot(guide.velocity.normalize_or_zero()) / normal.y
    }

    /// Damping of the inverse of a leg that swings.
    pub(super) fn swing_damping(&self, figure: &Figure, side: Side) -> f64 {
        if self.guide.is_none() {
            return self.tuning.damping[1];
        }
        let [hip, knee, ankle] = figure.legs[side as usize];
        let length = figure.links[knee].anchor.length() + figure.links[ankle].anchor.length();
        let share = self.states[hip].origin.distance(self.states[ankle].origin) / length;
        let usual = DAMPING[0] + (DAMPING[1] - DAMPING[0]) * within(share, STRAIGHT);
        let swung = self.swing.map_or(0.0, |swing| (self.time - swing.start) / swing.time);
        usual + (LOWERED - usual) * within(swung, LOWERS) * self.brisk()
    }

    /// rad, where a swinging foot is to point when it lands.
    pub(super) fn foot_heading(&self, side: Side) -> f64 {
        let wish = self.guide.and_then(|guide| guide.swing).filter(|wish| wish.side == side);
        wish.map_or(self.heading + self.turned_out(side), |wish| wish.yaw)
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

    /// Has it only just begun a step against a fall, in the last tick of `dt` s?
    pub fn steps_off(&self, dt: f64) -> bool {
        let begun = |swing: Swing| !swing.comfort && !self.guided && self.time - swing.start < 1.5 * dt;
        self.shifting.is_none() && self.swing.is_some_and(begun)
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

    /// rad, rad/s, rad/s²: how arms (about x) and trunk (about y) swing against the legs of a guide's stride, and the pelvis (about y) with
    /// them.
    pub(super) fn with_stride(&self, figure: &Figure, link: usize) -> [f64; 3] {
        let Some(Guide { stride: Some((swings, share, time)), velocity, .. }) = self.guide else { return [0.0; 3] };
        let ahead = DVec2::new(real::sin(self.heading), real::cos(self.heading));
        let pace = velocity.dot(ahead) / self.size.sqrt();
        let of = |[slow, brisk]: [f64; 2]| pace * (slow + (brisk - slow) * self.brisk());
        let arms = if self.on_level() { of(ARMS).min(FARTHEST) } else { WIDER * pace };
        let most = match figure.links[link].part {
            // The arm of the side that swings is ahead at the step's start; ahead is about -x.
            Part::UpperArm(side) => arms * if side == swings { -1.0 } else { 1.0 },
            Part::Trunk => -of(TWIST) * swings.sign(),
            Part::Pelvis => of(PELVIS) * swings.sign(),
            _ => return [0.0; 3],
        };
        let turn = std::f64::consts::PI / time.max(0.1);
        let (sin, cos) = real::sin_cos(std::f64::consts::PI * share.clamp(0.0, 1.2));
        [most * cos, -most * turn * sin, -most * turn * turn * cos]
    }
}
