//! A clip file's motion on the rig that is baked: in scenario space, facing +Z, near the origin, retargeted by role.

use super::{Base, BaseError};
use crate::audit::track;
use crate::maths::quat::{shortest_arc, wrap_angle, yaw_of};
use crate::mocap::Reading;
use crate::model::scenario::Scenario;
use crate::model::{Body, Capture, Role, Side};
use crate::rig::Rig;
use crate::whole_body::stand::foot_yaw;
use glam::{DQuat, DVec3};

/// rad: a clip that faces farther from the rig's forward is turned to it.
const AWRY: f64 = 60.0 * std::f64::consts::PI / 180.0;
/// m: one that begins farther from the origin is moved there.
const AFAR: f64 = 0.5;

/// The base clip of a scenario, on a rig. `reading`: the clip as its file has it; `own`: its index, where the file is the rig's.
pub fn prepare(rig: &Rig, scenario: &Scenario, reading: &Reading, own: Option<usize>) -> Result<Base, BaseError> {
    let scale = scenario.character.leg_scale;
    let body = if scale == 1.0 { rig.body.clone() } else { rig.with_leg_scale(scale).body };
    let mut capture = without_pose(in_scenario(reading));
    face_forward(&mut capture);
    let capture = onto(&capture, &body);
    let mut base = Base { own, ..Base::new(&capture)? };
    if own.is_none() {
        base.notes.splice(0..0, capture.notes.iter().cloned());
    }
    Ok(base)
}

/// The clip from where it begins to move: captures often begin with a frame or two of a T-pose.
fn without_pose(capture: Capture) -> Capture {
    let (Some(mut held), cut) = track::without_pose(&capture) else { return capture };
    let joints = held.body.joints.len();
    held.positions.drain(..cut * joints);
    held.turns.drain(..cut * joints);
    held.notes.push(format!("the first {cut} of its frames are a pose apart from its motion: left out"));
    held
}

/// The motion on that body.
fn onto(capture: &Capture, body: &Body) -> Capture {
    crate::mocap::retarget(capture, body)
}

/// From clip space to the scenario's.
fn in_scenario(reading: &Reading) -> Capture {
    let mut capture = reading.capture.clone();
    let similarity = &reading.rig.document_from_scenario;
    let up = shortest_arc(reading.frame_up, DVec3::Y);
    let back = (up * similarity.rotation).inverse();
    let origin = up * similarity.translation / similarity.scale;
    capture.positions.iter_mut().for_each(|position| *position = back * (*position - origin));
    capture.turns.iter_mut().for_each(|turn| *turn = (back * *turn).normalize());
    capture
}

/// Turns and moves a clip that begins elsewhere.
fn face_forward(capture: &mut Capture) {
    if capture.frames() == 0 {
        return;
    }
    let body = &capture.body;
    let turns = capture.turns_at(0);
    let pelvis = yaw_of(turns[0]);
    let feet = Side::BOTH.map(|side| wrap_angle(foot_yaw(body, side, turns[body.feet[side as usize].ankle]) - pelvis));
    let yaw = wrap_angle(pelvis + (feet[0] + feet[1]) / 4.0);
    if yaw.abs() > AWRY {
        turn(capture, -yaw);
    }
    let ankles = [Role::LeftFoot, Role::RightFoot].map(|role| capture.at(0)[capture.body.joint(role).unwrap_or(0)]);
    let middle = (ankles[0] + ankles[1]) * 0.5 * DVec3::new(1.0, 0.0, 1.0);
    if middle.length() > AFAR {
        capture.positions.iter_mut().for_each(|position| *position -= middle);
    }
}

/// Turns the whole clip about +Y.
fn turn(capture: &mut Capture, yaw: f64) {
    let by = DQuat::from_rotation_y(yaw);
    capture.positions.iter_mut().for_each(|position| *position = by * *position);
    capture.turns.iter_mut().for_each(|turn| *turn = by * *turn);
}
