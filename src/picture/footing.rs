//! Where a clip's feet hold the ground in its pictures: the soles of the contacts that the report tells, and the prints
//! that past ones leave. Scenario space, m.

use super::figure::flat;
use super::marks::{SoleMark, sole_mark};
use super::sheet::SheetInput;
use super::skin::NodeTransforms;
use crate::model::report::{Contact, Part};
use crate::model::{ClipReport, Side};
use crate::rig::Rig;
use glam::{DQuat, DVec3};

/// The sole of a foot where its nodes have it.
pub(super) fn sole(rig: &Rig, side: Side, part: Part, transforms: &NodeTransforms) -> SoleMark {
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

/// The latest contact of a foot that holds at that time.
pub(super) fn contact_at(report: &ClipReport, side: Side, time: f64) -> Option<&Contact> {
    let holds = |contact: &&Contact| contact.foot == side && contact.start <= time + 1e-6 && time <= contact.end + 1e-6;
    report.contacts.iter().filter(holds).max_by(|a, b| a.start.total_cmp(&b.start))
}

/// A mark on the plane of its contact.
pub(super) fn laid(input: &SheetInput, contact: &Contact, time: f64, mark: SoleMark) -> SoleMark {
    let similarity = &input.rig.document_from_scenario;
    let turn = if contact.frame == "platform" { turn(input, time) } else { DQuat::IDENTITY };
    let point = turn * similarity.inverse_point(DVec3::from(contact.position));
    let normal = turn * (similarity.rotation.inverse() * DVec3::from(contact.normal));
    if !(point + normal).is_finite() || normal.y < 0.1 {
        return mark;
    }
    let down = |at: &DVec3| DVec3::new(at.x, point.y - flat(normal).dot(flat(*at - point)) / normal.y, at.z);
    SoleMark { whole: mark.whole.iter().map(down).collect(), held: mark.held.iter().map(down).collect(), ..mark }
}

/// A foot's unbroken time on the ground and the print that it leaves.
pub(super) struct Spell {
    side: Side,
    end: f64,
    made: f64, // s, the moment of `print`
    print: SoleMark,
}

/// Contacts that follow each other without a gap leave one print, taken where the foot is flat if it ever is.
pub(super) fn spells(input: &SheetInput) -> Vec<Spell> {
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
                let made = (best.start + best.end) / 2.0;
                let print = laid(input, best, made, sole(input.rig, side, Part::Flat, &(input.pose)(made)));
                spells.push(Spell { side, end: own[last].end, made, print });
            }
            at = last + 1;
        }
    }
    spells
}

/// What is left of those that are over.
pub(super) fn prints(input: &SheetInput, spells: &[Spell], time: f64) -> Vec<SoleMark> {
    let past =
        spells.iter().filter(|spell| spell.end < time && contact_end(input.report, spell.side, time) != spell.end);
    // Prints on a platform turn on with it.
    let turned = |spell: &Spell| carried(&spell.print, turn(input, time) * turn(input, spell.made).inverse());
    past.map(turned).collect()
}

/// The end of the contact of that foot at that time; NaN in the air.
fn contact_end(report: &ClipReport, side: Side, time: f64) -> f64 {
    contact_at(report, side, time).map_or(f64::NAN, |contact| contact.end)
}

/// How the ground is turned at a time.
fn turn(input: &SheetInput, time: f64) -> DQuat {
    input.props.iter().find(|prop| prop.ground).map_or(DQuat::IDENTITY, |prop| prop.at(time).rotation)
}

/// A mark turned about the origin.
fn carried(mark: &SoleMark, turn: DQuat) -> SoleMark {
    let all = |points: &[DVec3]| points.iter().map(|point| turn * *point).collect();
    SoleMark { whole: all(&mark.whole), held: all(&mark.held), ..*mark }
}
