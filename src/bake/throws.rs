//! The [[throw]] lane in its simple form: each ball that meets the body gives its impulse where it hits, bounces off and
//! rolls away. Scenario space, SI.
//!
//! A ball is aimed at a bone of the character as it stands when the ball arrives, with the scatter that the seed draws;
//! whether it meets anything is decided by its flight against capsules round the bones. What is said of the body at
//! that moment comes from the run until then: its place, its feet, the way it faces, the trunk upright. A contact lasts
//! 20 ms, keeps 0.3 of the closing speed and has no friction. A ball meets the body once, and no other ball.

use super::carried::hide_beyond;
use super::pushes::nearest_joint;
use super::timeline::Timeline;
use crate::maths::curve::smooth3;
use crate::maths::real;
use crate::maths::seed::Seed;
use crate::measure::{GRAVITY, KnownPush, PushPoint};
use crate::model::props::{Prop, PropKey, Shape};
use crate::model::scenario::{Scenario, Throw};
use crate::model::{Body, BodyPose, Load, Role, Side, Terrain};
use crate::sim::Flown;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::PI;

/// s, that a ball and the body touch.
const CONTACT: f64 = 0.02;
/// Share of the closing speed that a ball leaves the body with, and the ground.
const RESTITUTION: f64 = 0.3;
const GROUND_RESTITUTION: f64 = 0.45;
/// Share of its speed along the ground that a bounce leaves.
const GROUND_KEEPS: f64 = 0.85;
/// m/s², that rolling slows down by.
const ROLLING: f64 = 0.5;
/// rad, how far the seed turns a ball's way at most.
const JITTER: f64 = 7.0 * PI / 180.0;
/// m and s, from how far away a ball is seen, but no longer than so before it arrives.
const SEEN: (f64, f64) = (5.0, 0.5);
/// Share of a ball's speed that it may have downwards when it arrives.
const MOST_DROP: f64 = 0.35;
/// s, how far before and after its arrival a ball may meet the body, and by what steps that is looked for.
const AROUND: f64 = 0.25;
const STEP: f64 = 0.001;
/// s between keys of a ball's way.
const KEYS: f64 = 1.0 / 60.0;
/// Linear RGB of a ball.
const RUBBER: [f32; 3] = [0.6, 0.09, 0.05];

/// A ball as it was drawn, before anybody knows where the body will be.
#[derive(Clone, Copy, Debug)]
pub struct Toss {
    /// s, when it arrives at what it is aimed at.
    pub arrives: f64,
    throw: Throw,
    radius: f64,   // m
    yaw: f64,      // rad, jitter
    pitch: f64,    // rad
    spread: DVec2, // m, in the plane across its way
}

/// A ball in flight past or into the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// m.
    pub radius: f64,
    /// kg.
    pub mass: f64,
    /// s, when it is at `place` with `velocity`.
    pub time: f64,
    /// m.
    pub place: DVec3,
    /// m/s.
    pub velocity: DVec3,
    /// What it did to the body; `None` for a miss.
    pub hit: Option<Hit>,
}

/// A ball's meeting with the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// As the stepper and the measures take it.
    pub push: KnownPush,
    /// N s, on the body.
    pub impulse: DVec3,
    /// The joint whose bone was met.
    pub joint: usize,
    /// m, the point that was met.
    pub point: DVec3,
}

/// The body when a ball comes.
#[derive(Clone, Copy, Debug)]
pub struct Standing<'a> {
    /// Who.
    pub body: &'a Body,
    /// How it stands.
    pub pose: &'a BodyPose,
    /// m/s, of its centre of mass.
    pub velocity: DVec3,
    /// rad.
    pub facing: f64,
    /// kg, with what it carries.
    pub mass: f64,
    /// The box in its hands, where there is one: it is in the way.
    pub load: Option<&'a Load>,
}

/// A bone with flesh: a segment, its radius, its joint.
struct Capsule {
    ends: [DVec3; 2],
    radius: f64,
    joint: usize,
}

/// The balls of a scenario in the order of their arrival. The same seed draws the same balls.
pub fn tosses(scenario: &Scenario, seed: u64) -> Vec<Toss> {
    let mut tosses = Vec::new();
    for (lane, throw) in scenario.throw.iter().enumerate() {
        for index in 0..throw.count {
            let arrives = throw.start + throw.interval * f64::from(index);
            if arrives >= scenario.duration {
                break;
            }
            let mut draw = Seed::new(seed).split(1 + lane as u64).split(u64::from(index));
            let radius = draw.between(throw.radius[0], throw.radius[1]);
            let (yaw, pitch) = (draw.between(-JITTER, JITTER), draw.between(-0.5 * JITTER, 0.5 * JITTER));
            let (angle, out) = (draw.between(0.0, 2.0 * PI), draw.unit().sqrt() * throw.spread);
            let spread = DVec2::new(real::cos(angle), real::sin(angle)) * out;
            tosses.push(Toss { arrives, throw: *throw, radius, yaw, pitch, spread });
        }
    }
    tosses.sort_by(|a, b| a.arrives.total_cmp(&b.arrives));
    tosses
}

impl Toss {
    /// m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// kg.
    pub fn mass(&self) -> f64 {
        self.throw.density * 4.0 / 3.0 * PI * self.radius.powi(3)
    }

    /// The joint that it is aimed at, and the middle of that bone's flesh in a pose (m).
    pub fn aimed(&self, body: &Body, pose: &BodyPose) -> (usize, DVec3) {
        let joint = nearest_joint(body, self.throw.at);
        let positions = pose.positions(body);
        let own = capsules(body, pose, &positions).into_iter().find(|capsule| capsule.joint == joint);
        (joint, own.map_or(positions[joint], |capsule| (capsule.ends[0] + capsule.ends[1]) * 0.5))
    }

    /// Place (m) and velocity (m/s) on arrival, of a ball that is aimed at `aim` on a character that faces `facing` (rad).
    pub fn way(&self, aim: DVec3, facing: f64) -> (DVec3, DVec3) {
        let towards = DQuat::from_rotation_y(self.yaw) * -self.throw.from.unit(facing);
        let flat = DVec3::new(towards.x, 0.0, towards.z).try_normalize();
        let speed = self.throw.speed;
        let velocity = match flat {
            Some(flat) if towards.y.abs() < 0.5 => {
                // It has fallen for half of the time that it was in the air.
                let time = (SEEN.0 / speed.max(0.1)).min(SEEN.1);
                let drop = real::asin((0.5 * GRAVITY * time / speed.max(0.1)).min(MOST_DROP));
                let down = drop - real::asin(towards.y.clamp(-1.0, 1.0)) + self.pitch;
                (flat * real::cos(down) - DVec3::Y * real::sin(down)) * speed
            }
            _ => towards * speed,
        };
        let way = velocity.normalize_or(DVec3::NEG_Y);
        let across = way.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
        (aim + across * self.spread.x + across.cross(way) * self.spread.y, velocity)
    }

    /// Its flight against the body as it stands when the ball arrives.
    pub fn meet(&self, standing: &Standing) -> Ball {
        let Standing { body, pose, .. } = standing;
        let positions = pose.positions(body);
        let mut capsules = capsules(body, pose, &positions);
        capsules.extend(standing.load.map(|load| boxed(load, pose, &positions, self.arrives)));
        let aim = self.aimed(body, pose).1;
        let (aim, velocity) = self.way(aim, standing.facing);
        let way = velocity.normalize_or(DVec3::NEG_Y);
        let mass = self.mass();
        let mut ball = Ball { radius: self.radius, mass, time: self.arrives, place: aim, velocity, hit: None };
        let body_at = |time: f64| standing.velocity * (time - self.arrives);
        let steps = (2.0 * AROUND / STEP) as usize;
        for step in 0..=steps {
            let time = self.arrives - AROUND + STEP * step as f64;
            let (place, velocity) = flight(aim, velocity, time - self.arrives);
            let met = capsules
                .iter()
                .filter_map(|capsule| {
                    let gap = place - body_at(time);
                    let on = nearest_on(capsule.ends, gap);
                    (gap.distance(on) < capsule.radius + ball.radius).then_some((capsule, on + body_at(time)))
                })
                .min_by(|a, b| place.distance(a.1).total_cmp(&place.distance(b.1)));
            let Some((capsule, on)) = met.filter(|_| time > 0.0) else { continue };
            let normal = (on - place).try_normalize().unwrap_or(way);
            let closing = (velocity - standing.velocity).dot(normal);
            if closing <= 0.0 {
                continue;
            }
            let shared = ball.mass * standing.mass / (ball.mass + standing.mass);
            let impulse = normal * ((1.0 + RESTITUTION) * shared * closing);
            let point = on - normal * capsule.radius;
            let at = pose.turns[capsule.joint].inverse() * (point - body_at(time) - positions[capsule.joint]);
            let push = KnownPush {
                start: time,
                end: time + CONTACT,
                force: impulse / CONTACT,
                at: PushPoint::Segment(capsule.joint, at),
            };
            (ball.time, ball.place, ball.velocity) = (time, place, velocity);
            ball.hit = Some(Hit { push, impulse, joint: capsule.joint, point });
            break;
        }
        ball
    }
}

/// Place and velocity under gravity, a time after (or before) being at a place with a velocity.
fn flight(place: DVec3, velocity: DVec3, time: f64) -> (DVec3, DVec3) {
    let fall = DVec3::NEG_Y * GRAVITY;
    (place + velocity * time + fall * (0.5 * time * time), velocity + fall * time)
}

fn nearest_on([from, to]: [DVec3; 2], point: DVec3) -> DVec3 {
    let along = to - from;
    from + along * ((point - from).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0)
}

/// A carried box as a capsule across.
fn boxed(load: &Load, pose: &BodyPose, positions: &[DVec3], time: f64) -> Capsule {
    let size = load.form_at(time).size;
    let radius = 0.25 * (size.y + size.z);
    let out = DVec3::X * (0.5 * size.x - radius).max(0.0);
    let turn = pose.turns[load.joint] * load.level;
    let centre = load.centre_in(pose, positions, time);
    Capsule { ends: [centre - turn * out, centre + turn * out], radius, joint: load.joint }
}

/// The body as capsules. Radii are an adult's by height; those of a head by its own size.
fn capsules(body: &Body, pose: &BodyPose, positions: &[DVec3]) -> Vec<Capsule> {
    use Role::*;
    let height = body.height;
    let mut capsules = Vec::new();
    let mut add = |from: Option<DVec3>, to: Option<DVec3>, radius: f64, joint: Option<usize>| {
        if let (Some(from), Some(to), Some(joint)) = (from, to, joint) {
            capsules.push(Capsule { ends: [from, to], radius, joint });
        }
    };
    let joint = |role: Role| body.joint(role);
    let place = |role: Role| body.joint(role).map(|joint| positions[joint]);
    let chest = joint(UpperChest).or(joint(Chest)).or(joint(Spine));
    let shoulders = place(LeftUpperArm).zip(place(RightUpperArm)).map(|(left, right)| (left + right) * 0.5);
    let hips = place(LeftUpperLeg).zip(place(RightUpperLeg)).map(|(left, right)| (left + right) * 0.5);
    let girdle =
        |ends: Option<(DVec3, DVec3)>| ends.map(|(left, right)| [left.lerp(right, 0.2), left.lerp(right, 0.8)]);
    let low = hips.zip(shoulders).map(|(hips, shoulders)| hips.lerp(shoulders, 0.45));
    let high = hips.zip(shoulders).map(|(hips, shoulders)| hips.lerp(shoulders, 0.9));
    add(low, high, 0.068 * height, joint(Chest).or(chest));
    add(hips, low, 0.066 * height, joint(Spine).or(joint(Hips)));
    if let Some([left, right]) = girdle(place(LeftUpperArm).zip(place(RightUpperArm))) {
        add(Some(left), Some(right), 0.055 * height, chest);
    }
    if let Some([left, right]) = girdle(place(LeftUpperLeg).zip(place(RightUpperLeg))) {
        add(Some(left), Some(right), 0.066 * height, joint(Hips));
    }
    if let Some(head) = joint(Head) {
        let half = (0.5 * (height - body.joints[head].rest.y)).max(0.03 * height);
        let middle = positions[head] + pose.turns[head] * DVec3::Y * half;
        add(Some(middle), Some(middle), half, Some(head));
        add(shoulders, Some(positions[head]), 0.035 * height, joint(Neck).or(chest));
    }
    for side in Side::BOTH {
        let [upper_arm, lower_arm, hand, thigh, shank, foot] = match side {
            Side::Left => [LeftUpperArm, LeftLowerArm, LeftHand, LeftUpperLeg, LeftLowerLeg, LeftFoot],
            Side::Right => [RightUpperArm, RightLowerArm, RightHand, RightUpperLeg, RightLowerLeg, RightFoot],
        };
        add(place(upper_arm), place(lower_arm), 0.028 * height, joint(upper_arm));
        let palm = place(lower_arm).zip(place(hand)).map(|(elbow, wrist)| wrist + (wrist - elbow) * 0.4);
        add(place(lower_arm), palm, 0.024 * height, joint(lower_arm));
        add(place(thigh), place(shank), 0.045 * height, joint(thigh));
        add(place(shank), place(foot), 0.032 * height, joint(shank));
    }
    capsules
}

/// The balls as things to see: thrown, bouncing, rolling out. A hit is shown where the performed body was met.
pub fn props(timeline: &Timeline, balls: &[Ball]) -> Vec<Prop> {
    let duration = timeline.duration();
    let shown = balls.iter().filter(|ball| ball.time - SEEN.1 < duration);
    shown
        .enumerate()
        .map(|(index, ball)| {
            let mut keys = way(ball, shift(timeline, ball), &timeline.terrain, duration);
            hide_beyond(&mut keys, duration);
            Prop { keys, ..Prop::standing(&format!("ball_{}", index + 1), Shape::Ball(ball.radius), RUBBER) }
        })
        .filter(|prop| !prop.keys.is_empty())
        .collect()
}

/// The balls of an articulated run as things to see, where the engine had them; a little to the side where the clip's body
/// stands beside the engine's.
pub fn flown(timeline: &Timeline, flown: &[Flown], balls: &[Ball]) -> Vec<Prop> {
    let duration = timeline.duration();
    let one = |(index, flown): (usize, &Flown)| {
        let (time, place, _) = *flown.way.first()?;
        let hit = flown.hits.first().map(|hit| hit.span[0]);
        let ball = balls.iter().find(|ball| ball.hit.is_some_and(|own| Some(own.push.start) == hit));
        let shift = ball.map_or(DVec3::ZERO, |ball| shift(timeline, ball));
        let met = hit.unwrap_or(f64::INFINITY);
        let beside = |at: f64| shift * (1.0 - smooth3((at - met) / 0.3));
        let key = |time: f64, translation: DVec3, rotation: DQuat| PropKey {
            time,
            translation: translation + beside(time),
            rotation,
            ..PropKey::default()
        };
        let seen = (SEEN.0 / flown.velocity.length().max(0.1)).min(SEEN.1);
        let from = (met.min(time + 0.15) - seen).clamp(0.0, time);
        let before = ((time - from) / KEYS).floor() as usize;
        let mut keys: Vec<PropKey> = (1..=before)
            .rev()
            .map(|step| {
                let at = time - KEYS * step as f64;
                key(at, flight(place, flown.velocity, at - time).0, DQuat::IDENTITY)
            })
            .collect();
        let mut due = time;
        for (at, place, turn) in flown.way.iter().filter(|(at, ..)| *at <= duration) {
            // Every tick about the hit, else as often as the eye needs.
            if *at + 1e-9 >= due || (*at - met).abs() < 0.03 {
                keys.push(key(*at, *place, *turn));
                due = at + KEYS;
            }
        }
        hide_beyond(&mut keys, duration);
        Some(Prop { keys, ..Prop::standing(&format!("ball_{}", index + 1), Shape::Ball(flown.radius), RUBBER) })
    };
    flown.iter().enumerate().filter_map(one).filter(|prop| prop.keys.len() > 1).collect()
}

/// m, from where the body was thought to be met to where the performed one is.
fn shift(timeline: &Timeline, ball: &Ball) -> DVec3 {
    let Some(hit) = ball.hit.filter(|hit| hit.push.start <= timeline.duration()) else { return DVec3::ZERO };
    let PushPoint::Segment(joint, offset) = hit.push.at else { return DVec3::ZERO };
    let pose = timeline.pose_at(hit.push.start);
    pose.positions(&timeline.body)[joint] + pose.turns[joint] * offset - hit.point
}

/// Keys from the throw until the clip ends.
fn way(ball: &Ball, shift: DVec3, terrain: &Terrain, duration: f64) -> Vec<PropKey> {
    let mut keys = Vec::new();
    let seen = (SEEN.0 / ball.velocity.length().max(0.1)).min(SEEN.1);
    let from = (ball.time - seen).max(0.0);
    let key =
        |time: f64, translation: DVec3, rotation: DQuat| PropKey { time, translation, rotation, ..PropKey::default() };
    let mut time = from;
    while time < ball.time - 1e-3 && time <= duration {
        let (place, _) = flight(ball.place + shift, ball.velocity, time - ball.time);
        keys.push(key(time, place, DQuat::IDENTITY));
        time += KEYS;
    }
    let (mut place, mut velocity, mut turn) = (ball.place + shift, ball.velocity, DQuat::IDENTITY);
    if ball.time <= duration {
        keys.push(key(ball.time, place, turn));
    }
    if let Some(hit) = &ball.hit {
        velocity -= hit.impulse / ball.mass.max(1e-9);
    }
    let dt = 0.002;
    let (mut now, mut due, mut rolling) = (ball.time, ball.time + KEYS, false);
    while now < duration {
        now += dt;
        let spot = terrain.spot(DVec2::new(place.x, place.z));
        let (floor, holds) = (spot.height + ball.radius, spot.holds);
        if rolling && holds {
            let speed = velocity.length();
            let slower = (speed - ROLLING * dt).max(0.0);
            velocity *= if speed > 1e-9 { slower / speed } else { 0.0 };
            place += velocity * dt;
            place.y = terrain.spot(DVec2::new(place.x, place.z)).height + ball.radius;
        } else {
            rolling = false;
            (place, velocity) = flight(place, velocity, dt);
            if holds && place.y < floor && velocity.y < 0.0 {
                place.y = floor;
                velocity = DVec3::new(velocity.x, -GROUND_RESTITUTION * velocity.y, velocity.z)
                    * DVec3::new(GROUND_KEEPS, 1.0, GROUND_KEEPS);
                if velocity.y < 0.4 {
                    velocity.y = 0.0;
                    rolling = true;
                }
                keys.push(key(now, place, turn));
                due = now + KEYS;
            }
        }
        let flat = DVec3::new(velocity.x, 0.0, velocity.z);
        turn = (DQuat::from_scaled_axis(DVec3::Y.cross(flat) * (dt / ball.radius.max(1e-3))) * turn).normalize();
        if now >= due && now < duration {
            keys.push(key(now, place, turn));
            due += KEYS;
            if rolling && flat.length() < 1e-3 {
                break;
            }
        }
    }
    keys.retain(|key| key.time <= duration);
    keys.dedup_by(|later, earlier| later.time - earlier.time < 1e-4);
    if let Some(last) = keys.last().copied().filter(|last| last.time < duration) {
        keys.push(PropKey { time: duration, ..last });
    }
    keys
}
