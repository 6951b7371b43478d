//! What trunk, head, pelvis and arms do while the pendulum sways and steps. Radians, SI units, angles in the facing frame.
//!
//! Springs that the body's own accelerations drive (lag, counter-lean, swing) and an alarm that raises the arms against
//! the fall: peaks as people show them (7 degrees of trunk lean at 30 Ns, 13 at 60, 26 at 150). What was struck goes
//! first (see [`super::struck`]): a head whips on its neck, a shoulder turns the trunk, hips leave the chest behind. Times
//! scale with the square root of the height of the centre of mass. Everything is odd under mirroring: a mirrored push gives
//! the mirrored motion. Decides no feet and no centre of mass.

use super::solve::ArmAngles;
use super::stand::{TRUNK_LEAN, relaxed_arms};
use super::stride::Stride;
use super::struck::Struck;
use crate::maths::curve::soft_limit;
use crate::maths::pendulum::GRAVITY;
use crate::maths::real;
use crate::maths::seed::Seed;
use crate::maths::spring::Spring;
use crate::model::Side;
use crate::model::{Physique, Plant};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::TAU;

/// What the reaction sees of a tick. World vectors, scenario space.
#[derive(Clone, Copy, Debug)]
pub struct Senses {
    /// m/s², of the centre of mass.
    pub acceleration: DVec3,
    /// N, of the disturbances.
    pub push: DVec3,
    /// N m, their moment about the centre of mass.
    pub push_moment: DVec3,
    /// m, extrapolated centre of mass (x, z).
    pub xi: DVec2,
    /// m/s, of the centre of mass (x, z).
    pub velocity: DVec2,
    /// m/s, as it is commanded (x, z); zero in a stand.
    pub wanted: DVec2,
    /// m, by how much a crouch lowers it.
    pub crouched: f64,
    /// It is told to stand on one foot.
    pub on_one: bool,
    /// 0..1, how sure it is of its balance wherever it stands over its feet: arms that were raised come down.
    pub safe: f64,
    /// Left and right foot.
    pub feet: [Plant; 2],
    /// Which of them carry.
    pub planted: [bool; 2],
    /// rad, where the pelvis should point.
    pub facing: f64,
}

/// Small personal differences, drawn by the seed, each in -1..1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "what they vary")]
pub struct Personality {
    pub arms_gain: f64,
    pub far_arm: f64,
    pub arms_delay: f64,
    pub trunk_gain: f64,
    pub head_gain: f64,
    pub elbow: f64,
}

impl Personality {
    /// The person of a seed.
    pub fn drawn(seed: u64) -> Personality {
        let mut draw = Seed::new(seed);
        let mut one = || draw.between(-1.0, 1.0);
        Personality {
            arms_gain: one(),
            far_arm: one(),
            arms_delay: one(),
            trunk_gain: one(),
            head_gain: one(),
            elbow: one(),
        }
    }
}

/// Angles of the upper body and the pelvis at one time, in an order that interpolates entry by entry. Lean of the trunk (left,
/// forward), of the head (likewise), yaw and list of the pelvis, facing, raise, abduction and elbow of the left and the right arm,
/// alarm, twist of chest and pelvis by a push, lean of the pelvis (left, forward) beyond its share of the trunk's.
pub type UpperAngles = [f64; UPPER];
/// Number of entries of [`UpperAngles`].
pub const UPPER: usize = 18;

/// m, how far over the centre of mass a push at the chest acts on the reference body.
const PUSH_ARM: f64 = 0.19;
/// m, from the middle to a shoulder of the reference body.
const SHOULDER: f64 = 0.18;
/// s, how far ahead a fall is felt.
const FORESEES: f64 = 0.12;
/// Leg lengths: who will be farther off his feet is alarmed.
const ALARMS: f64 = 0.045;
/// s, from a fall that is felt to arms that answer it, give or take a person's own.
const HEARS: f64 = 0.08;
/// s, in which alarm rises: slower, and arms start late; faster, and they jerk.
const RISES: f64 = 0.09;
/// rad that the trunk leans for each leg length that a crouch lowers it by.
pub(super) const CROUCH_LEAN: f64 = 0.5;
/// What the pelvis takes of the trunk's lean, left and forward.
const PELVIS_SHARE: [f64; 2] = [0.30, 0.38];

/// Memory of the reaction.
#[derive(Clone, Debug)]
pub struct Reaction {
    physique: Physique,
    personality: Personality,
    arms_dial: f64,
    unhurried: f64,
    lean: [Spring; 2],      // sideways (left positive), forwards
    head: [Spring; 2],      // what the head keeps of it
    pelvis_yaw: Spring,     // relative to facing, left positive
    list: Spring,           // pelvis drop on the right positive
    tuck: [Spring; 2],      // lean of the pelvis by pushes on it
    twist: [Spring; 2],     // of chest and pelvis by pushes, left positive
    stride: Stride,         // what walking adds
    walked: f64,            // 0..1, walks or did until a moment ago
    shoved: f64,            // m/s that pushes gave, fading
    alarm: f64,             // 0..1
    strides: f64,           // 1, or 0 where a base clip walks for it
    alarm_line: Vec<f64>,   // raw alarm of the last ticks, newest last
    fall: DVec2,            // smoothed direction of the fall (left, forward)
    arms: [[Spring; 3]; 2], // raise, abduct, elbow beyond the relaxed stand
}

impl Reaction {
    /// At rest. `arms_dial`: 0..1, 0.5 as found in people.
    pub fn new(physique: &Physique, personality: Personality, arms_dial: f64) -> Self {
        Self {
            physique: *physique,
            personality,
            arms_dial,
            unhurried: 1.0,
            lean: Default::default(),
            head: Default::default(),
            pelvis_yaw: Spring::default(),
            list: Spring::default(),
            tuck: Default::default(),
            twist: Default::default(),
            stride: Stride::default(),
            walked: 0.0,
            shoved: 0.0,
            alarm: 0.0,
            strides: 1.0,
            alarm_line: Vec::new(),
            fall: DVec2::ZERO,
            arms: Default::default(),
        }
    }

    /// The same, coming back to rest in so many times people's time.
    pub fn unhurried(self, times: f64) -> Self {
        Self { unhurried: times, ..self }
    }

    /// The same, over a base clip that walks: what a walk does to trunk, pelvis and arms is the clip's.
    pub fn over_a_walk(self) -> Self {
        Self { strides: 0.0, ..self }
    }

    /// From now on that heavy (kg): what it carries counts.
    pub fn weigh(&mut self, mass: f64) {
        self.physique.mass = mass;
    }

    /// How calm it is: 1 at rest, 0 while it walks or is alarmed.
    pub fn calm(&self) -> f64 {
        (1.0 - 4.0 * self.alarm).max(0.0) * (1.0 - self.walked)
    }

    /// One tick of `dt` s; returns the angles at its end. The pushes are told by their moment alone.
    pub fn tick(&mut self, senses: &Senses, dt: f64) -> UpperAngles {
        let moment = senses.push_moment;
        let (sin, cos) = real::sin_cos(senses.facing);
        let tipping = DVec2::new(-moment.z * cos - moment.x * sin, -moment.z * sin + moment.x * cos);
        self.tick_struck(senses, &Struck { tipping, ..Struck::default() }, dt)
    }

    /// The same, where it is known what part of the body a push takes hold of.
    pub fn tick_struck(&mut self, senses: &Senses, struck: &Struck, dt: f64) -> UpperAngles {
        let scale = (self.physique.com_height / 0.96).sqrt(); // times are for a centre of mass at 0.96 m
        let length = self.physique.com_height / 0.96;
        let local = |world: DVec3| {
            let (sin, cos) = real::sin_cos(senses.facing);
            DVec2::new(world.x * cos - world.z * sin, world.x * sin + world.z * cos)
        };
        let mass = self.physique.mass;
        let acceleration = local(senses.acceleration);
        let push = local(senses.push) / mass;
        let ground = acceleration - push;

        // What the push would be at the chest, by its moment: high ones tip the trunk, at the hips it stays behind.
        let tipping = struck.tipping / (mass * PUSH_ARM * length);
        // Trunk: the push carries the shoulders off, the ground's braking pulls the hips from under them.
        let gain = 1.0 + 0.08 * self.personality.trunk_gain;
        let trunk_omega = TAU * 1.35 / scale;
        let (head, hips) = (struck.head / mass, struck.hips / mass);
        let drive = ((push * 0.2 + tipping * 0.8) * 5.2 - hips * 4.0 - ground * 1.2) * gain / length;
        for axis in 0..2 {
            self.lean[axis].v += drive[axis] * dt;
            self.lean[axis].step(0.0, trunk_omega, 0.5, dt);
        }
        let lean = DVec2::new(soft_limit(self.lean[0].x, 0.42), soft_limit(self.lean[1].x, 0.60));
        let head_omega = TAU * 2.2 / scale;
        for axis in 0..2 {
            let keeps = 0.25 + 0.08 * self.personality.head_gain;
            self.head[axis].v += (head[axis] * 30.0 - (push[axis] - head[axis]) * 1.1) / length * dt;
            self.head[axis].step(keeps * lean[axis], head_omega, 0.45, dt);
            self.tuck[axis].v += hips[axis] * 7.0 / length * dt;
            self.tuck[axis].step(0.0, TAU * 2.4 / scale, 0.75, dt);
        }
        let turns = 70.0 * struck.twist / (mass * length * length) * gain;
        let turned = self.twist[0].v;
        self.twist[0].v += turns * dt;
        self.twist[0].step(0.0, TAU * 1.6 / scale, 0.5, dt);
        self.twist[1].step(0.35 * soft_limit(self.twist[0].x, 0.6), TAU * 1.6 / scale, 0.7, dt);
        let spin = (self.twist[0].v - turned) / dt;

        let stride = self.stride.tick(senses, &self.physique, dt);
        self.tick_pelvis(senses, stride.share, scale, dt);
        self.tick_alarm(senses, stride.share, &local, scale, dt);
        // Walking, the arms follow the legs and not every jolt of the shoulders.
        self.tick_arms(acceleration * (1.0 - 0.8 * stride.share * (1.0 - self.alarm)), scale, length, dt);
        self.swing_arms(struck, spin, length, dt);

        let mut angles = [0.0; UPPER];
        angles[0] = lean.x;
        // Who crouches bends forwards.
        angles[1] = lean.y + stride.lean * self.strides + CROUCH_LEAN * senses.crouched / self.physique.leg_length;
        angles[2] = self.head[0].x;
        angles[3] = self.head[1].x;
        angles[4] = (self.pelvis_yaw.x + stride.turn) * self.strides;
        angles[5] = self.list.x * self.strides;
        angles[6] = senses.facing;
        for side in 0..2 {
            for joint in 0..3 {
                angles[7 + side * 3 + joint] = self.arms[side][joint].x;
            }
            // An arm that is raised against a fall swings no more.
            angles[7 + side * 3] += stride.arms[side] * (1.0 - self.alarm) * self.strides;
            angles[9 + side * 3] += stride.elbows[side] * (1.0 - self.alarm) * self.strides;
        }
        angles[13] = self.alarm;
        angles[14] = soft_limit(self.twist[0].x, 0.6);
        angles[15] = self.twist[1].x;
        for axis in 0..2 {
            angles[16 + axis] = soft_limit(self.tuck[axis].x, 0.35);
        }
        angles[17] += stride.tilt * self.strides;
        angles
    }

    /// A struck arm swings off; those of a trunk that is turned are left behind.
    fn swing_arms(&mut self, struck: &Struck, spin: f64, length: f64, dt: f64) {
        for side in Side::BOTH {
            let springs = &mut self.arms[side as usize];
            let off = struck.arms[side as usize] / self.physique.mass;
            springs[0].v += (off.y * 12.0 + 0.6 * side.sign() * spin * SHOULDER) / length * dt;
            springs[1].v += side.sign() * off.x * 12.0 / length * dt;
            springs[2].v += off.length() * 6.0 / length * dt;
        }
    }

    fn tick_pelvis(&mut self, senses: &Senses, walking: f64, scale: f64, dt: f64) {
        let between = senses.feet[0].ankle - senses.feet[1].ankle;
        let ahead = between.x * real::sin(senses.facing) + between.z * real::cos(senses.facing); // left foot ahead of the right
        // More so than at rest.
        let ahead = ahead - self.physique.stance.map_or(0.0, |stance| stance.apart.y);
        // In a stand the pelvis turns to where the feet stand; in a walk `stride` turns it.
        let yaw = -soft_limit(1.1 * ahead / self.physique.leg_length, 16_f64.to_radians()) * (1.0 - walking);
        self.pelvis_yaw.step(yaw, TAU * 1.8 / scale, 0.9, dt);
        let list = match senses.planted {
            [false, true] => -1.0,
            [true, false] => 1.0,
            _ => 0.0,
        };
        self.list.step(list * 4.5_f64.to_radians(), TAU * 1.6 / scale, 0.8, dt);
    }

    fn tick_alarm(&mut self, senses: &Senses, walking: f64, local: &dyn Fn(DVec3) -> DVec2, scale: f64, dt: f64) {
        let over = self.physique.stance.map_or(DVec2::new(0.0, self.physique.com_forward), |stance| stance.over);
        let over = DQuat::from_rotation_y(senses.facing) * DVec3::new(over.x, 0.0, over.y);
        let middle = (senses.feet[0].ankle + senses.feet[1].ankle) * 0.5 + over;
        let standing = local(DVec3::new(senses.xi.x, 0.0, senses.xi.y) - middle) / self.physique.leg_length;
        // A walker is alarmed by speed that it did not mean to have.
        let unmeant = (senses.velocity - senses.wanted) / (GRAVITY * self.physique.com_height).sqrt();
        let strayed =
            local(DVec3::new(unmeant.x, 0.0, unmeant.y)) * (self.physique.com_height / self.physique.leg_length);
        // Who is thrown feels where he will be, not where he is: the arms are on their way before the body is far off.
        let omega = (GRAVITY / self.physique.com_height).sqrt();
        let rate = senses.velocity + DVec2::new(senses.acceleration.x, senses.acceleration.z) / omega;
        let rate = local(DVec3::new(rate.x, 0.0, rate.y)) / self.physique.leg_length;
        let foreseen = if rate.dot(standing) >= 0.0 { standing + rate * (FORESEES * scale) } else { standing };
        let off = foreseen.lerp(strayed, walking);
        let raw = ((off.length() - ALARMS - 0.06 * walking) / 0.32).clamp(0.0, 1.0);
        // Nobody is alarmed by his own starting and stopping.
        let willed = walking.max(f64::from(u8::from(senses.on_one)));
        self.walked = willed.max(self.walked - dt / (2.0 * scale));
        self.shoved = self.shoved * real::exp(-dt / (1.5 * scale)) + senses.push.length() / self.physique.mass * dt;
        let pace = (GRAVITY * self.physique.com_height).sqrt();
        let raw = raw * (self.shoved / (0.05 * pace)).min(1.0).max(1.0 - self.walked) * (1.0 - senses.safe);
        self.alarm_line.push(raw);
        let delay = ((HEARS + 0.02 * self.personality.arms_delay) * scale / dt).round() as usize;
        let heard =
            if self.alarm_line.len() > delay { self.alarm_line[self.alarm_line.len() - 1 - delay] } else { 0.0 };
        let time = if heard > self.alarm { RISES } else { 0.40 * self.unhurried } * scale;
        self.alarm += (heard - self.alarm) * (1.0 - real::exp(-dt / time));
        if raw > 0.0 {
            let towards = off.normalize_or_zero();
            self.fall += (towards - self.fall) * (1.0 - real::exp(-dt / (0.10 * scale)));
        }
    }

    fn tick_arms(&mut self, acceleration: DVec2, scale: f64, length: f64, dt: f64) {
        let (back, forth) = ((-self.fall.y).max(0.0), self.fall.y.max(0.0));
        let aside = self.fall.x.abs();
        let sum = (back + forth + aside).max(1e-6);
        let dial = self.arms_dial * 2.0 * (1.0 + 0.12 * self.personality.arms_gain);
        let omega = TAU * (1.05 / self.unhurried.sqrt() + 0.75 * self.alarm) / scale;
        for side in Side::BOTH {
            // Far: the arm on the side that the body falls away from. It goes higher.
            let far = -side.sign() * self.fall.x.signum() * f64::from(self.fall.x != 0.0);
            let aside_far = [5.0, 46.0, 8.0];
            let aside_near = [5.0, 30.0, 30.0];
            let uneven = 1.0 + 0.11 * far * aside + 0.06 * far * self.personality.far_arm;
            let mut target = [0.0; 3];
            for joint in 0..3 {
                let sideways = if far > 0.0 { aside_far[joint] } else { aside_near[joint] };
                let degrees =
                    ([40.0, 30.0, 26.0][joint] * back + [16.0, 26.0, 34.0][joint] * forth + sideways * aside) / sum;
                target[joint] = degrees.to_radians() * self.alarm * dial * uneven;
            }
            target[2] *= 1.0 + 0.15 * self.personality.elbow;
            let springs = &mut self.arms[side as usize];
            // The arm is left behind when its shoulder is accelerated.
            springs[0].v -= acceleration.y / (0.62 * length) * 1.1 * dt;
            springs[1].v -= side.sign() * acceleration.x / (0.62 * length) * 1.1 * dt;
            springs[2].v += acceleration.length() / (0.62 * length) * 0.25 * dt;
            springs[0].step(target[0], omega, 0.38, dt);
            springs[1].step(target[1], omega, 0.48, dt);
            springs[2].step(target[2], omega, 0.45, dt);
        }
    }
}

/// The turns that those angles mean: pelvis, chest, head (global, from upright rest), and the arms.
pub fn upper_turns(angles: &UpperAngles) -> (DQuat, DQuat, DQuat, [ArmAngles; 2]) {
    let lean = |sideways: f64, forwards: f64| DQuat::from_scaled_axis(DVec3::new(forwards, 0.0, -sideways));
    let facing = angles[6];
    let [sideways, forwards] = [0, 1].map(|axis| PELVIS_SHARE[axis] * angles[axis] + angles[16 + axis]);
    let pelvis = DQuat::from_rotation_y(facing + angles[4] + angles[15])
        * lean(sideways, forwards)
        * DQuat::from_rotation_z(angles[5]);
    let chest =
        DQuat::from_rotation_y(facing - 0.55 * angles[4] + angles[14]) * lean(angles[0], angles[1] + TRUNK_LEAN);
    let head = DQuat::from_rotation_y(facing) * lean(soft_limit(angles[2], 0.6), soft_limit(angles[3], 0.7));
    let relaxed = relaxed_arms();
    let arms = [0, 1].map(|side| {
        let (raise, abduct, elbow) = (angles[7 + side * 3], angles[8 + side * 3], angles[9 + side * 3]);
        let lift = raise.abs().max(abduct.abs());
        ArmAngles {
            raise: relaxed.raise + soft_limit(raise, 1.6),
            // Never through the ribs: inwards it stops soon.
            abduct: relaxed.abduct + if abduct < 0.0 { soft_limit(abduct, 0.10) } else { soft_limit(abduct, 1.5) },
            // A raised forearm that stays turned in crosses the face.
            inward: relaxed.inward * (1.0 - lift / 0.8).clamp(-0.5, 1.0),
            elbow: relaxed.elbow + if elbow < 0.0 { soft_limit(elbow, 0.2) } else { soft_limit(elbow, 1.6) },
            curl: relaxed.curl * (1.0 - 0.55 * angles[13]),
        }
    });
    (pelvis, chest, head, arms)
}
