//! What is kept of an articulated run: ticks, steps between the places where the feet stood, the upper body without jitter.
//!
//! Scenario space, SI. Feet that slid or were dragged along are kept as steps: a clip's foot holds still or is lifted.

use super::articulated::{Articulated, Help, UpperPose};
use super::{SessionPush, TickState, Trace};
use crate::maths::filter::zero_lag;
use crate::maths::quat::{rotation_vector, yaw_of};
use crate::model::{Plant, Role, Side, Terrain};
use crate::ragdoll::control::Report;
use crate::ragdoll::{Controller, Figure, LinkState, walk};
use crate::stepper::footing::to_ground;
use crate::stepper::{Phase, Step, StepKind};
use crate::whole_body::ArmAngles;
use crate::whole_body::stand::{self, relaxed_arms};
use glam::{DQuat, DVec3, EulerRot};

/// Hz, above which the links' turns are jitter.
const JITTER: f64 = 9.0;
/// s after a landing until a sole has settled.
const SETTLED: f64 = 0.06;
/// s and m/s: a bearing foot whose mean speed over that long before and after is higher drags.
const DRAG_SPAN: f64 = 0.05;
/// As [`DRAG_SPAN`] says.
const DRAG_SPEED: f64 = 0.12;
/// s, a foot that stands for less did not stand.
const HARDLY: f64 = 0.14;
/// m, shorter drags are left out: the foot stands in their mean.
const DRAGGED: f64 = 0.025;

/// What is kept of a run.
pub(super) struct Record {
    pub(super) ticks: Vec<TickState>,
    upper: Vec<UpperPose>,
    start: [Plant; 2],
    bearing: [bool; 2],
    swings: Vec<(Side, StepKind, f64, f64)>, // side, why, lift, land
    lifted: [Option<(f64, StepKind)>; 2],
    help: Help,
    torques: Vec<(Role, f64)>,
    torque_curves: Vec<Vec<f32>>, // (links × ticks)
}

impl Record {
    pub(super) fn new(start: [Plant; 2]) -> Record {
        Record {
            ticks: Vec::new(),
            upper: Vec::new(),
            start,
            bearing: [true; 2],
            swings: Vec::new(),
            lifted: [None; 2],
            help: Help::default(),
            torques: Vec::new(),
            torque_curves: Vec::new(),
        }
    }

    pub(super) fn tick(
        &mut self,
        figure: &Figure,
        control: &Controller,
        report: &Report,
        (push, push_moment): (DVec3, DVec3),
        ground: &Terrain,
        time: f64,
    ) {
        let states = control.states();
        let feet = Side::BOTH.map(|side| {
            let state = states[figure.legs[side as usize][2]];
            let yaw = yaw_of(state.turn) + self.start[side as usize].yaw;
            let normal = if ground.is_flat() { DVec3::Y } else { state.turn * DVec3::Y };
            let ankle = state.origin - normal * figure.ankle_height;
            let ankle = if ground.is_flat() { DVec3::new(ankle.x, 0.0, ankle.z) } else { ankle };
            Plant { ankle, yaw, normal }
        });
        for side in Side::BOTH {
            let bears = report.bears[side as usize];
            if self.bearing[side as usize] && !bears {
                let comfort = control.swing.is_some_and(|swing| swing.comfort);
                let kind = match comfort {
                    _ if control.gait.walks() => StepKind::Walk,
                    true => StepKind::Comfort,
                    false => StepKind::Corrective,
                };
                self.lifted[side as usize] = Some((time, kind));
            } else if !self.bearing[side as usize]
                && bears
                && let Some((lift, kind)) = self.lifted[side as usize].take()
            {
                self.swings.push((side, kind, lift, time));
            }
        }
        self.bearing = report.bears;
        let before = self.ticks.last().map_or(report.velocity, |tick| tick.velocity);
        self.ticks.push(TickState {
            com: report.com,
            velocity: report.velocity,
            acceleration: (report.velocity - before) / 0.01,
            xi: report.xi,
            cop: report.cop,
            push,
            push_moment,
            feet,
            planted: report.bears,
            facing: yaw_of(states[figure.trunk].turn),
            walk: control.gait.velocity(),
            gait: match control.gait.phase() {
                walk::Phase::Rest | walk::Phase::Caught => Phase::Rest,
                walk::Phase::Start => Phase::Start,
                walk::Phase::Double => Phase::Double,
                walk::Phase::Single => Phase::Single,
            },
            crouched: 0.0,
        });
        self.upper.push(upper(figure, states));
        let [torque, force] = report.help.map(DVec3::length);
        self.help.torque = [self.help.torque[0].max(torque), self.help.torque[1] + torque * torque];
        self.help.force = [self.help.force[0].max(force), self.help.force[1] + force * force];
        self.torques.resize_with(figure.links.len(), || (Role::Hips, 0.0));
        for (link, (role, peak)) in self.torques.iter_mut().enumerate() {
            *role = figure.role_of(link);
            *peak = peak.max(control.torques[link]);
        }
        self.torque_curves.resize_with(figure.links.len(), Vec::new);
        for (curve, torque) in self.torque_curves.iter_mut().zip(&control.torques) {
            curve.push(*torque as f32);
        }
    }

    pub(super) fn finish(
        mut self,
        dt: f64,
        pushes: Vec<SessionPush>,
        lost: Option<f64>,
        rest: f64,
        terrain: &Terrain,
    ) -> Articulated {
        let count = self.ticks.len().max(1) as f64;
        self.help.torque[1] = (self.help.torque[1] / count).sqrt();
        self.help.force[1] = (self.help.force[1] / count).sqrt();
        self.lift_what_drags(dt, terrain);
        let steps = self.steps(dt, terrain);
        let upper = smooth(&self.upper, 1.0 / dt);
        let aloft = self.lifted.iter().flatten().map(|(lift, _)| *lift).reduce(f64::min);
        let unlanded = aloft.filter(|_| lost.is_some());
        let trace = Trace { dt, ticks: self.ticks, steps, aloft: None, pushes, start: self.start, lost, rest };
        // The root's link has no joint.
        let joints = self.torques.into_iter().zip(self.torque_curves).skip(1);
        let mut joints: Vec<((Role, f64), Vec<f32>)> = joints.collect();
        joints.sort_by(|a, b| b.0.1.total_cmp(&a.0.1));
        let (torques, torque_curves): (Vec<(Role, f64)>, _) = joints.into_iter().unzip();
        Articulated {
            trace,
            upper,
            help: self.help,
            peak_torque: torques.first().map_or(0.0, |worst| worst.1),
            torques,
            torque_curves,
            poses: Vec::new(),
            unlanded,
            balls: Vec::new(),
        }
    }

    /// A bearing foot that a stretched leg dragged along is drawn as a step from where the drag began to where it ended.
    fn lift_what_drags(&mut self, dt: f64, terrain: &Terrain) {
        let count = self.ticks.len();
        let around = (DRAG_SPAN / dt).round().max(1.0) as usize;
        let mut drawn = Vec::new();
        for side in Side::BOTH {
            let foot = side as usize;
            let at = |index: usize| to_ground(&self.ticks[index].feet[foot], terrain.turn(index as f64 * dt)).ankle;
            let drags = |index: usize| {
                let (from, to) = (index.saturating_sub(around), (index + around).min(count - 1));
                (from..=to).all(|index| self.ticks[index].planted[foot])
                    && (at(to) - at(from)).length() > DRAG_SPEED * (to - from) as f64 * dt
            };
            let mut runs: Vec<[usize; 2]> = Vec::new();
            for index in 0..count {
                if drags(index) {
                    match runs.last_mut() {
                        Some(run) if index <= run[1] + 2 * around => run[1] = index,
                        _ => runs.push([index, index]),
                    }
                }
            }
            for [from, to] in runs {
                let (from, to) = (from.saturating_sub(around), (to + around).min(count - 1));
                if (at(to) - at(from)).length() > DRAGGED {
                    drawn.push((side, StepKind::Corrective, from as f64 * dt, to as f64 * dt));
                }
            }
        }
        self.swings.extend(drawn);
        self.swings.sort_by(|a, b| a.2.total_cmp(&b.2));
        // A foot that hardly stood between two swings did not stand.
        let mut merged: Vec<(Side, StepKind, f64, f64)> = Vec::new();
        for swing in std::mem::take(&mut self.swings) {
            match merged.iter_mut().rev().find(|before| before.0 == swing.0) {
                Some(before) if swing.2 < before.3 + HARDLY => before.3 = before.3.max(swing.3),
                _ => merged.push(swing),
            }
        }
        self.swings = merged;
    }

    /// Steps between the places where the feet stood while they stood.
    fn steps(&self, dt: f64, terrain: &Terrain) -> Vec<Step> {
        let last = self.ticks.len() as f64 * dt;
        let mut steps: Vec<Step> = Vec::new();
        for side in Side::BOTH {
            let own: Vec<_> = self.swings.iter().filter(|swing| swing.0 == side).collect();
            let mut from = self.start[side as usize];
            for (index, (_, kind, lift, land)) in own.iter().enumerate() {
                let until = own.get(index + 1).map_or(last, |next| next.2);
                let to = self.stood(side, (land + SETTLED).min(until), until, dt, terrain);
                steps.push(Step { side, kind: *kind, lift: *lift, land: *land, from, to });
                from = to;
            }
        }
        steps.sort_by(|a, b| a.lift.total_cmp(&b.lift));
        steps
    }

    /// Where a foot stood between two times, in the mean, in the ground's frame.
    fn stood(&self, side: Side, from: f64, to: f64, dt: f64, terrain: &Terrain) -> Plant {
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

/// The upper body's pose from the links.
fn upper(figure: &Figure, states: &[LinkState]) -> UpperPose {
    let lean = DQuat::from_rotation_x(stand::TRUNK_LEAN);
    let trunk = states[figure.trunk].turn;
    let head = figure.link_of_role(Role::Head).map_or(trunk, |link| states[link].turn);
    let arms = Side::BOTH.map(|side| {
        let [upper, lower] = figure.arms[side as usize];
        let relaxed = relaxed_arms();
        let against = trunk.inverse() * states[upper].turn;
        let turned = lean.inverse() * against * lean * hung(side, &relaxed);
        let (z, x, y) = turned.to_euler(EulerRot::ZXY);
        let bend = match figure.links[lower].freedom {
            crate::ragdoll::figure::Freedom::Hinge { axis, .. } => {
                rotation_vector(states[upper].turn.inverse() * states[lower].turn).dot(axis)
            }
            _ => 0.0,
        };
        ArmAngles {
            raise: -x,
            abduct: side.sign() * z,
            inward: -side.sign() * y,
            elbow: relaxed.elbow + bend,
            curl: relaxed.curl,
        }
    });
    UpperPose { pelvis: states[0].turn, chest: trunk * lean, head, arms }
}

/// Without the contacts' jitter, and without lag.
fn smooth(upper: &[UpperPose], hz: f64) -> Vec<UpperPose> {
    let turned = |pick: &dyn Fn(&UpperPose) -> DQuat| -> Vec<DQuat> {
        let vectors: Vec<DVec3> = upper.iter().map(|pose| rotation_vector(pick(pose))).collect();
        zero_lag(&vectors, JITTER, hz).into_iter().map(DQuat::from_scaled_axis).collect()
    };
    let (pelvis, chest, head) = (turned(&|pose| pose.pelvis), turned(&|pose| pose.chest), turned(&|pose| pose.head));
    let angle = |side: usize, pick: &dyn Fn(&ArmAngles) -> f64| -> Vec<f64> {
        let series: Vec<f64> = upper.iter().map(|pose| pick(&pose.arms[side])).collect();
        zero_lag(&series, JITTER, hz)
    };
    let arms = [0, 1].map(|side| {
        [
            angle(side, &|arm| arm.raise),
            angle(side, &|arm| arm.abduct),
            angle(side, &|arm| arm.inward),
            angle(side, &|arm| arm.elbow),
        ]
    });
    (0..upper.len())
        .map(|index| UpperPose {
            pelvis: pelvis[index],
            chest: chest[index],
            head: head[index],
            arms: [0, 1].map(|side| ArmAngles {
                raise: arms[side][0][index],
                abduct: arms[side][1][index],
                inward: arms[side][2][index],
                elbow: arms[side][3][index],
                curl: upper[index].arms[side].curl,
            }),
        })
        .collect()
}

/// An upper arm's turn against the chest from hanging straight down.
pub(super) fn hung(side: Side, angles: &ArmAngles) -> DQuat {
    DQuat::from_rotation_z(side.sign() * angles.abduct)
        * DQuat::from_rotation_x(-angles.raise)
        * DQuat::from_rotation_y(-side.sign() * angles.inward)
}
