//! The contact sheet of a clip: the skinned rig at its telling moments, and the film, the same at equal distances.
//!
//! A clip is anything that answers "which pose at t": the picture computes the body, its centre of mass and ξ = c + v/ω
//! from the pose itself, contacts and pushes from the report. Where the caller knows better (the simulation's own ξ, a
//! measured centre of pressure) it hands in an overlay.

use super::compose::{Frame, Header, Layout, Trail, page};
use super::figure::flat;
use super::marks::{Overlay, Push, SoleMark, sole_mark};
use super::moments::{Moment, even_moments};
use super::skin::{NodeTransforms, Posture, body_pose, node_transforms, surfaces};
use crate::model::report::{Contact, Outcome, Part};
use crate::model::{ClipReport, Role, Side};
use crate::rig::Rig;
use glam::{DVec2, DVec3};
use image::RgbaImage;

/// What a sheet is made from.
pub struct SheetInput<'a> {
    /// Whose clip.
    pub rig: &'a Rig,
    /// The pose at a time, s.
    pub pose: &'a dyn Fn(f64) -> Posture,
    /// What the clip says about itself.
    pub report: &'a ClipReport,
    /// Marks that replace the computed ones where they are given: com, xi, cop; pushes and soles where not empty.
    pub overlay: Option<&'a dyn Fn(f64) -> Overlay>,
    /// Which moments; [`super::choose_moments`] finds them.
    pub moments: Vec<Moment>,
    /// Sizes.
    pub layout: Layout,
}

/// m/s².
const GRAVITY: f64 = 9.81;
/// s, for the velocity of the centre of mass.
const STEP: f64 = 0.012;

/// The sheet.
pub fn sheet(input: &SheetInput) -> RgbaImage {
    let spells = spells(input);
    let frames: Vec<Frame> = input.moments.iter().map(|moment| frame(input, &spells, moment)).collect();
    page(&frames, &trail(input), &header(input.report), &input.layout)
}

/// `count` pictures at equal distances, small: for judging the motion itself.
pub fn film(input: &SheetInput, count: usize) -> RgbaImage {
    let layout = Layout { columns: 10, view: 150, plan: 0, ..input.layout };
    let moments = even_moments(input.report.duration, count.clamp(2, 200));
    let SheetInput { rig, pose, report, overlay, .. } = *input;
    sheet(&SheetInput { rig, pose, report, overlay, moments, layout })
}

/// A foot's unbroken time on the ground and the print that it leaves.
struct Spell {
    side: Side,
    end: f64,
    print: SoleMark,
}

fn frame<'a>(input: &SheetInput<'a>, spells: &[Spell], moment: &Moment) -> Frame<'a> {
    let time = moment.time;
    let transforms = node_transforms(input.rig, &(input.pose)(time));
    let mut overlay = Overlay {
        com: Some(centre_of_mass(input.rig, &transforms)),
        xi: extrapolated(input, time),
        pushes: pushes(input, time, &transforms),
        soles: Side::BOTH
            .into_iter()
            .filter_map(|side| contact_at(input.report, side, time))
            .map(|contact| sole(input.rig, contact.foot, contact.part, &transforms))
            .collect(),
        ..Overlay::default()
    };
    if let Some(known) = input.overlay.map(|overlay| overlay(time)) {
        overlay.com = known.com.or(overlay.com);
        overlay.xi = known.xi.or(overlay.xi);
        overlay.cop = known.cop.or(overlay.cop);
        if !known.pushes.is_empty() {
            overlay.pushes = known.pushes;
        }
        if !known.soles.is_empty() {
            overlay.soles = known.soles;
        }
        overlay.prints = known.prints;
    }
    if overlay.prints.is_empty() {
        let past =
            spells.iter().filter(|spell| spell.end < time && contact_end(input.report, spell.side, time) != spell.end);
        overlay.prints = past.map(|spell| spell.print.clone()).collect();
    }
    Frame { time, label: moment.label.clone(), surfaces: surfaces(input.rig, &transforms), overlay }
}

/// The end of the contact of that foot at that time; NaN in the air.
fn contact_end(report: &ClipReport, side: Side, time: f64) -> f64 {
    contact_at(report, side, time).map_or(f64::NAN, |contact| contact.end)
}

/// The latest contact of a foot that holds at that time.
fn contact_at(report: &ClipReport, side: Side, time: f64) -> Option<&Contact> {
    let holds = |contact: &&Contact| contact.foot == side && contact.start <= time + 1e-6 && time <= contact.end + 1e-6;
    report.contacts.iter().filter(holds).max_by(|a, b| a.start.total_cmp(&b.start))
}

/// Contacts that follow each other without a gap leave one print, taken where the foot is flat if it ever is.
fn spells(input: &SheetInput) -> Vec<Spell> {
    let mut spells = Vec::new();
    for side in Side::BOTH {
        let mut own: Vec<&Contact> = input.report.contacts.iter().filter(|contact| contact.foot == side).collect();
        own.sort_by(|a, b| a.start.total_cmp(&b.start));
        let mut at = 0;
        while at < own.len() {
            let mut last = at;
            while last + 1 < own.len() && own[last + 1].start <= own[last].end + 2e-3 {
                last += 1;
            }
            let length = |contact: &&&Contact| (contact.part == Part::Flat, contact.end - contact.start);
            let best = own[at..=last].iter().max_by(|a, b| {
                let (a, b) = (length(a), length(b));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
            });
            if let Some(best) = best {
                let transforms = node_transforms(input.rig, &(input.pose)((best.start + best.end) / 2.0));
                let print = sole(input.rig, side, Part::Flat, &transforms);
                spells.push(Spell { side, end: own[last].end, print });
            }
            at = last + 1;
        }
    }
    spells
}

/// The sole of a foot where its nodes have it.
fn sole(rig: &Rig, side: Side, part: Part, transforms: &NodeTransforms) -> SoleMark {
    let body = &rig.body;
    let shape = &body.feet[side as usize];
    let moves =
        |joint: usize| rig.joint_nodes.get(joint).copied().flatten().and_then(|node| transforms.get(node)).copied();
    let ankle_rest = body.joints.get(shape.ankle).map_or(DVec3::ZERO, |joint| joint.rest);
    // A foot that was extrapolated moves with the shin.
    let mut joint = Some(shape.ankle);
    let mut rear = None;
    while let (None, Some(at)) = (rear, joint) {
        rear = moves(at);
        joint = body.joints.get(at).and_then(|joint| joint.parent);
    }
    let rear = rear.unwrap_or(glam::DAffine3::IDENTITY);
    let front = shape.toe.and_then(moves).unwrap_or(rear);
    let place_rear = |offset: DVec3| rear.transform_point3(ankle_rest + offset);
    let place_front = |offset: DVec3| front.transform_point3(ankle_rest + offset);
    sole_mark(body, side, part, &place_rear, &place_front)
}

fn centre_of_mass(rig: &Rig, transforms: &NodeTransforms) -> DVec3 {
    let pose = body_pose(rig, transforms);
    let positions = pose.positions(&rig.body);
    pose.centre_of_mass(&rig.body, &positions)
}

fn com_at(input: &SheetInput, time: f64) -> DVec3 {
    centre_of_mass(input.rig, &node_transforms(input.rig, &(input.pose)(time)))
}

/// ξ from the pose's own centre of mass, m, (x, z).
fn extrapolated(input: &SheetInput, time: f64) -> Option<DVec2> {
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

/// The report's pushes at that time, on the bones that they name.
fn pushes(input: &SheetInput, time: f64, transforms: &NodeTransforms) -> Vec<Push> {
    let rig = input.rig;
    let active = input.report.disturbances.iter().filter(|push| push.start <= time && time <= push.end);
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

/// The way of the centre of mass and ξ at 60 Hz, or as much of it as a picture can use.
fn trail(input: &SheetInput) -> Trail {
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

/// Title, outcome and the numbers that decide.
fn header(report: &ClipReport) -> Header {
    let (word, color) = match report.outcome {
        Outcome::Still => ("still", [110, 118, 128]),
        Outcome::Sway => ("sway", [32, 128, 140]),
        Outcome::Step => ("step", [26, 122, 74]),
        Outcome::Fall => ("fall", [190, 38, 38]),
    };
    let plausibility = &report.plausibility;
    let steps = if report.steps == 1 { "1 step".to_owned() } else { format!("{} steps", report.steps) };
    let numbers = [
        steps,
        format!("{:.1} s", report.duration),
        format!("{:.1} kg, {:.2} m", report.body.mass, report.body.height),
        format!("plausibility {:.2}", plausibility.score),
        format!("ZMP inside {:.0} %", plausibility.zmp_inside * 100.0),
        format!("slip {:.1} mm", plausibility.slip_max_mm),
        format!("penetration {:.1} mm", plausibility.penetration_max_mm),
        format!("ankle {:.1} m/s", plausibility.peak_ankle_speed),
    ];
    Header { title: report.scenario.clone(), subtitle: numbers.join("  ·  "), badge: Some((word.to_owned(), color)) }
}
