//! The balance of a clip's body as its pictures show it: centre of mass and ξ = c + v/ω of the poses, their way over the
//! ground, and the pushes that the report tells. Scenario space, m.

use super::compose::Trail;
use super::figure::flat;
use super::marks::Push;
use super::sheet::SheetInput;
use super::skin::{NodeTransforms, body_pose};
use crate::maths::pendulum::GRAVITY;
use crate::model::Role;
use crate::rig::Rig;
use glam::{DVec2, DVec3};

/// s, for the velocity of the centre of mass.
const STEP: f64 = 0.012;

/// m, of a rig whose nodes are moved so.
pub(super) fn centre_of_mass(rig: &Rig, transforms: &NodeTransforms) -> DVec3 {
    let pose = body_pose(rig, transforms);
    let positions = pose.positions(&rig.body);
    pose.centre_of_mass(&rig.body, &positions)
}

/// The same at a time of a clip.
pub(super) fn com_at(input: &SheetInput, time: f64) -> DVec3 {
    centre_of_mass(input.rig, &(input.pose)(time))
}

/// ξ from the pose's own centre of mass, m, (x, z).
pub(super) fn extrapolated(input: &SheetInput, time: f64) -> Option<DVec2> {
    let (before, after) = ((time - STEP).max(0.0), (time + STEP).min(input.report.duration));
    let span = after - before;
    let com = com_at(input, time);
    if span < 1e-6 || com.y < 0.05 {
        return None;
    }
    let velocity = (com_at(input, after) - com_at(input, before)) / span;
    let xi = flat(com) + flat(velocity) / (GRAVITY / com.y).sqrt();
    xi.is_finite().then_some(xi)
}

/// The way of the centre of mass and ξ at 60 Hz, or as much of it as a picture can use.
pub(super) fn trail(input: &SheetInput) -> Trail {
    if input.layout.plan == 0 {
        return Trail::new();
    }
    let duration = input.report.duration.clamp(0.0, 60.0);
    let count = ((duration * 60.0).ceil() as usize).clamp(2, 400);
    let times: Vec<f64> = (0..=count).map(|at| duration * at as f64 / count as f64).collect();
    let coms: Vec<DVec3> = times.iter().map(|time| com_at(input, *time)).collect();
    (0..times.len())
        .map(|at| {
            let (before, after) = (at.saturating_sub(1), (at + 1).min(count));
            let span = times[after] - times[before];
            let velocity = if span > 0.0 { flat(coms[after] - coms[before]) / span } else { DVec2::ZERO };
            let xi = flat(coms[at]) + velocity / (GRAVITY / coms[at].y.max(0.05)).sqrt();
            (times[at], flat(coms[at]), Some(xi))
        })
        .collect()
}

/// The report's pushes at that time, on the bones that they name.
pub(super) fn pushes(input: &SheetInput, time: f64, transforms: &NodeTransforms) -> Vec<Push> {
    let rig = input.rig;
    // of what is carried the box itself is seen
    let pushes = input.report.disturbances.iter().filter(|push| push.kind != "carry");
    let active = pushes.filter(|push| push.start <= time && time <= push.end);
    active
        .filter_map(|push| {
            let document = DVec3::from(push.force);
            let force = rig.document_from_scenario.rotation.inverse() * document;
            let mut role = Role::from_name(&push.bone).or(Some(Role::Chest));
            let mut joint = None;
            while let (None, Some(at)) = (joint, role) {
                joint = rig.body.joint(at);
                role = at.parent();
            }
            let pose = body_pose(rig, transforms);
            let point = *pose.positions(&rig.body).get(joint.unwrap_or(0))?;
            (force.length() > 1e-6 && force.is_finite() && point.is_finite()).then_some(Push { point, force })
        })
        .collect()
}
