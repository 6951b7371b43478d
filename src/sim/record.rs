//! What is kept of an articulated run: ticks, when each foot stood, and the steps between the places where it did.
//!
//! Scenario space, SI. A foot stands while the ground presses on it and it does not slide along; it has been up where it cleared the
//! ground or went on. Nothing is added: a step is a foot that went, a foot that is dragged while it bears takes none.

use super::articulated::{Articulated, Help};
use super::run::{Course, Ticked};
use super::search::Searched;
use super::{SessionPush, TickState, Trace};
use crate::maths::pendulum::GRAVITY;
use crate::maths::quat::yaw_of;
use crate::model::{BodyPose, Plant, Role, Side, Terrain};
use crate::ragdoll::control::Report;
use crate::ragdoll::{Controller, Figure};
use crate::stepper::footing::to_ground;
use crate::stepper::{Phase, Step, StepKind};
use crate::whole_body::ArmAngles;
use glam::{DQuat, DVec2, DVec3};

/// s after a landing until a sole has settled.
const SETTLED: f64 = 0.06;
/// Share of the body's weight by which the ground presses on a foot that stands.
pub const PRESSED: f64 = 0.01;
/// m/s at legs of 0.83 m: a foot that swings and touches the ground at more only scuffs it.
const SCUFFS: f64 = 0.15;
/// m at legs of 0.83 m, from which height of its lowest corner on a foot is up.
const CLEARED: f64 = 0.005;
/// m at legs of 0.83 m: a foot that has gone so far without standing has been up too.
const WENT: f64 = 0.03;

/// What is kept of a run.
pub(super) struct Record {
    pub(super) ticks: Vec<TickState>,
    start: [Plant; 2],
    soles: [Vec<Sole>; 2],
    bearing: [bool; 2],
    lifts: Vec<(Side, f64, StepKind)>, // as the law has them: side, s, why
    size: f64,                         // legs over 0.83 m
    dt: f64,
    helps: Vec<[f64; 2]>, // N m and N
    roles: Vec<Role>,
    pub(super) poses: Vec<BodyPose>,
    pressed: Vec<[f64; 2]>,
    torque_curves: Vec<Vec<f32>>, // (links × ticks)
}

/// A foot at a tick.
#[derive(Clone, Copy, Debug)]
struct Sole {
    ankle: DVec3, // m, its ground point
    lowest: f64,  // m, its lowest corner over the ground
    pressed: bool,
    bears: bool, // as the law has it
}

impl Record {
    pub(super) fn new(start: [Plant; 2], figure: &Figure, dt: f64) -> Record {
        Record {
            ticks: Vec::new(),
            start,
            soles: [Vec::new(), Vec::new()],
            bearing: [true; 2],
            lifts: Vec::new(),
            size: figure.leg_length / 0.83,
            dt,
            helps: Vec::new(),
            roles: (0..figure.links.len()).map(|link| figure.role_of(link)).collect(),
            poses: Vec::new(),
            pressed: Vec::new(),
            torque_curves: Vec::new(),
        }
    }

    pub(super) fn tick(&mut self, course: &Course, control: &Controller, ticked: &Ticked, time: f64) {
        let Ticked { report, state: kept, ground, .. } = ticked;
        let (figure, states) = (course.figure, control.states());
        let feet = kept.feet;
        self.poses.push(ticked.pose.clone());
        self.pressed.push(ticked.pressed);
        let pressed = ticked.pressed.map(|impulse| impulse / self.dt);
        for side in Side::BOTH {
            let foot = side as usize;
            let over = |at: DVec3| at.y - ground.spot(DVec2::new(at.x, at.z)).height;
            self.soles[foot].push(Sole {
                ankle: feet[foot].ankle,
                lowest: figure.sole_at(states, side).map(over).into_iter().fold(f64::INFINITY, f64::min),
                pressed: pressed[foot] > PRESSED * figure.mass * GRAVITY,
                bears: report.bears[foot],
            });
            if self.bearing[foot] && !report.bears[foot] {
                let comfort = control.swing.is_some_and(|swing| swing.comfort);
                let kind = match comfort {
                    _ if control.held_up() => StepKind::Held,
                    _ if control.follows() => StepKind::Walk,
                    true => StepKind::Comfort,
                    false => StepKind::Corrective,
                };
                self.lifts.push((side, time, kind));
            }
        }
        self.bearing = report.bears;
        self.ticks.push(*kept);
        let [torque, force] = report.help.map(DVec3::length);
        self.helps.push([torque, force]);
        self.torque_curves.resize_with(figure.links.len(), Vec::new);
        for (curve, torque) in self.torque_curves.iter_mut().zip(&control.torques) {
            curve.push(*torque as f32);
        }
    }

    /// Forgets all but the first ticks.
    pub(super) fn cut(&mut self, count: usize) {
        self.ticks.truncate(count);
        self.poses.truncate(count);
        self.pressed.truncate(count);
        self.helps.truncate(count);
        self.soles.iter_mut().for_each(|soles| soles.truncate(count));
        self.torque_curves.iter_mut().for_each(|curve| curve.truncate(count));
        let last = (self.ticks.len() as f64 - 0.5) * self.dt;
        self.lifts.retain(|(_, time, _)| *time < last);
        let bears = |soles: &Vec<Sole>| soles.last().is_none_or(|sole| sole.bears);
        self.bearing = [bears(&self.soles[0]), bears(&self.soles[1])];
    }

    /// `until`: s, the clip's end: what comes later is no part of the feet's stands.
    pub(super) fn finish(
        self,
        dt: f64,
        pushes: Vec<SessionPush>,
        (lost, rest): (Option<f64>, f64),
        terrain: &Terrain,
        until: f64,
    ) -> Articulated {
        let count = self.ticks.len().max(1) as f64;
        let help = |which: usize| {
            let peak = self.helps.iter().map(|help| help[which]).fold(0.0, f64::max);
            let square: f64 = self.helps.iter().map(|help| help[which] * help[which]).sum();
            [peak, (square / count).sqrt()]
        };
        let help = Help { torque: help(0), force: help(1) };
        let stood = Side::BOTH.map(|side| self.stood(side, dt, until));
        let steps = self.steps(&stood, dt, terrain);
        let trace = Trace { dt, ticks: self.ticks, steps, aloft: None, pushes, start: self.start, lost, rest };
        // The root's link has no joint.
        let joints = self.roles.into_iter().zip(self.torque_curves).skip(1).map(|(role, curve)| {
            let peak = curve.iter().copied().fold(0.0, f32::max);
            ((role, f64::from(peak)), curve)
        });
        let mut joints: Vec<((Role, f64), Vec<f32>)> = joints.collect();
        joints.sort_by(|a, b| b.0.1.total_cmp(&a.0.1));
        let (torques, torque_curves): (Vec<(Role, f64)>, _) = joints.into_iter().unzip();
        Articulated {
            trace,
            help,
            peak_torque: torques.first().map_or(0.0, |worst| worst.1),
            torques,
            torque_curves,
            poses: self.poses,
            pressed: self.pressed,
            joints: Vec::new(),
            stood,
            balls: Vec::new(),
            search: Searched::default(),
        }
    }

    /// From when to when a foot stood, s.
    fn stood(&self, side: Side, dt: f64, until: f64) -> Vec<[f64; 2]> {
        let soles = &self.soles[side as usize];
        let count = soles.len().min((until / dt + 1e-9).floor() as usize + 1);
        let soles = &soles[..count];
        let Some(last) = count.checked_sub(1) else { return Vec::new() };
        let slow = |index: usize| {
            let (from, to) = (index.saturating_sub(1), (index + 1).min(last));
            let way = soles[to].ankle.distance(soles[from].ankle);
            way < SCUFFS * self.size.sqrt() * (to - from).max(1) as f64 * dt
        };
        // It stands from the start: the ground has not pressed yet.
        let first = soles.iter().position(|sole| sole.pressed).unwrap_or(0);
        let stands = |index: usize| index < first || (soles[index].pressed && (soles[index].bears || slow(index)));
        let mut spans: Vec<[usize; 2]> = Vec::new();
        for index in (0..count).filter(|index| stands(*index)) {
            match spans.last_mut() {
                Some(span) if !was_up(&soles[span[1]..=index], self.size) => span[1] = index,
                _ => spans.push([index, index]),
            }
        }
        // What hovers by a hair at the end has not left.
        if let Some(span) = spans.last_mut().filter(|span| !was_up(&soles[span[1]..], self.size)) {
            span[1] = last;
        }
        spans.into_iter().map(|span| span.map(|index| index as f64 * dt)).collect()
    }

    /// Steps between the places where the feet stood.
    fn steps(&self, stood: &[Vec<[f64; 2]>; 2], dt: f64, terrain: &Terrain) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::new();
        for side in Side::BOTH {
            let mut from = self.start[side as usize];
            for pair in stood[side as usize].windows(2) {
                let ([_, lift], [land, until]) = (pair[0], pair[1]);
                let to = self.plant(side, (land + SETTLED).min(until), until, dt, terrain);
                let why = |entry: &&(Side, f64, StepKind)| entry.0 == side && entry.1 < land;
                let kind = self.lifts.iter().rev().find(why).map_or(StepKind::Corrective, |entry| entry.2);
                steps.push(Step { side, kind, lift, land, from, to });
                from = to;
            }
        }
        steps.sort_by(|a, b| a.lift.total_cmp(&b.lift));
        steps
    }

    /// Where a foot stood between two times, in the mean, in the ground's frame.
    fn plant(&self, side: Side, from: f64, to: f64, dt: f64, terrain: &Terrain) -> Plant {
        let last = self.ticks.len() - 1;
        let first = ((from / dt).round() as usize).min(last);
        let end = ((to / dt).round() as usize).clamp(first, last);
        let plants =
            (first..=end).map(|tick| to_ground(&self.ticks[tick].feet[side as usize], terrain.turn(tick as f64 * dt)));
        let count = (end - first + 1) as f64;
        let ankle = plants.clone().map(|plant| plant.ankle).sum::<DVec3>() / count;
        let yaw = plants.map(|plant| plant.yaw).sum::<f64>() / count;
        Plant::level(ankle, yaw)
    }
}

/// Whether a foot was up between the first and the last of these.
fn was_up(soles: &[Sole], size: f64) -> bool {
    let Some(first) = soles.first() else { return false };
    let between = &soles[1..soles.len().max(2) - 1];
    let cleared = between.iter().any(|sole| sole.lowest > CLEARED * size);
    cleared || between.iter().any(|sole| sole.ankle.distance(first.ankle) > WENT * size)
}

/// An upper arm's turn against the chest from hanging straight down.
pub(super) fn hung(side: Side, angles: &ArmAngles) -> DQuat {
    DQuat::from_rotation_z(side.sign() * angles.abduct)
        * DQuat::from_rotation_x(-angles.raise)
        * DQuat::from_rotation_y(-side.sign() * angles.inward)
}

/// What a tick leaves in the trace.
pub(super) fn state_of(
    course: &Course,
    control: &Controller,
    report: &Report,
    (push, push_moment): (DVec3, DVec3),
    acceleration: DVec3,
    ground: &Terrain,
) -> TickState {
    let (figure, states) = (course.figure, control.states());
    let feet = Side::BOTH.map(|side| {
        let state = states[figure.legs[side as usize][2]];
        let yaw = yaw_of(state.turn) + course.start[side as usize].yaw;
        let level = ground.level_at(DVec2::new(state.origin.x, state.origin.z));
        let normal = if level.is_some() { DVec3::Y } else { state.turn * DVec3::Y };
        let ankle = state.origin - normal * figure.ankle_height;
        let ankle = level.map_or(ankle, |height| DVec3::new(ankle.x, height, ankle.z));
        Plant { ankle, yaw, normal }
    });
    TickState {
        com: report.com,
        velocity: report.velocity,
        acceleration,
        xi: report.xi,
        cop: report.cop,
        push,
        push_moment,
        feet,
        planted: report.bears,
        facing: yaw_of(states[figure.trunk].turn),
        walk: DVec2::ZERO,
        gait: Phase::Rest,
        barred: false,
        crouched: control.lower,
    }
}
