//! What a loop says about itself: the seam read from its keys, and the measures over the cycle three times, so that the seam counts.

use super::motion::Looped;
use super::travel::repeated;
use crate::bake::RootMotion;
use crate::bake::contacts::FootContact;
use crate::bake::perform::Performance;
use crate::bake::report::{ReportInput, report, told};
use crate::measure::{Findings, Frame};
use crate::model::report::{Event, LoopReport};
use crate::model::scenario::Scenario;
use crate::model::{Clip, ClipReport, Plant, Side};
use crate::rig::Rig;
use glam::DVec3;

/// Cycles that are measured.
const ROUNDS: usize = 3;
/// s: contacts whose ends are this near are one.
const SAME: f64 = 1e-4;

/// What it is told of.
pub(super) struct Told<'a> {
    pub rig: &'a Rig,
    pub scenario: &'a Scenario,
    pub seed: u64,
    pub root: RootMotion,
    pub performance: &'a Performance,
    pub looped: &'a Looped<'a>,
}

/// The report, everything measured, and warnings for a person. `travelling`: the same clip with its travel.
pub(super) fn tell(input: &Told, clip: &Clip, travelling: &Clip) -> (ClipReport, Option<Findings>, Vec<String>) {
    let Told { rig, scenario, seed, root, performance, looped } = *input;
    let period = looped.cycle.period;
    let mut thrice = performance.clone();
    thrice.contacts = in_turn(&looped.contacts, period, looped.travel);
    thrice.pushes = looped.pushes(ROUNDS);
    thrice.balls = Vec::new();
    thrice.lost = None;
    thrice.trace.lost = None;
    thrice.trace.steps = looped.steps.iter().map(|step| crate::stepper::Step { land: 0.0, ..*step }).collect();
    thrice.trace.ticks.truncate(thrice.timeline.com.len());
    thrice.timeline.played = None;
    thrice.timeline.loads = looped.loads(ROUNDS);
    if !looped.cycle.clips {
        thrice.timeline.over = None;
    }
    let repeated = repeated(travelling, ROUNDS);
    let measured = ReportInput { rig, clip: &repeated, performance: &thrice, scenario, seed, root };
    let (mut report, mut findings, warnings) = report(&measured);
    if let Some(found) = &mut findings {
        whole_pops(found, &mut report, period);
    }
    let slips: Vec<f64> =
        findings.as_ref().map(|found| found.feet.slips.iter().map(|slip| slip.mm).collect()).unwrap_or_default();
    let slip = |contact: &FootContact| {
        let middle = period + 0.5 * (contact.start + contact.end);
        let same = |one: &FootContact| {
            one.side == contact.side && one.part == contact.part && one.start <= middle && middle <= one.end
        };
        let of = thrice.contacts.iter().position(same);
        of.and_then(|index| slips.get(index).copied()).unwrap_or(0.0)
    };
    let frame = Frame::of(&performance.timeline.terrain);
    report.contacts = looped.contacts.iter().map(|contact| told(rig, contact, frame, slip(contact))).collect();
    report.duration = clip.duration;
    report.events = events(&looped.contacts, period);
    for acting in &mut report.disturbances {
        acting.end = acting.end.min(clip.duration);
        let pulled = scenario.pull.iter().any(|pull| (pull.force - DVec3::from(acting.force).length()).abs() < 1e-6);
        if acting.kind == "push" && pulled {
            acting.kind = "pull".into();
        }
    }
    let travel = if root == RootMotion::InPlace { DVec3::ZERO } else { looped.travel };
    let (error_deg, error_mm) = seam(rig, clip, travel);
    let off = &looped.cycle.off;
    report.looped = Some(LoopReport {
        period: clip.duration,
        error_deg,
        error_mm,
        speed: looped.travel.length() / period,
        evened_deg: off.angle.to_degrees(),
        evened_mm: off.place * 1e3,
    });
    report.plausibility.notes.push("measured over three cycles on end, whose times are told".into());
    (report, findings, warnings)
}

/// Leaves out what is a pop only because the measured cycles begin and end in the middle of a motion.
fn whole_pops(found: &mut Findings, report: &mut ClipReport, period: f64) {
    let before = found.plausibility().notes;
    found.joints.pops.retain(|pop| pop.time > 0.5 * period && pop.time < (ROUNDS as f64 - 0.5) * period);
    let mut plausibility = found.plausibility();
    let others = report.plausibility.notes.iter().filter(|note| !before.contains(note));
    plausibility.notes.extend(others.cloned());
    report.plausibility = plausibility;
}

/// Degrees and mm, what the last keys differ from the first by, `travel` (m) apart: joints' turns and places.
fn seam(rig: &Rig, clip: &Clip, travel: DVec3) -> (f64, f64) {
    let mut sampler = rig.sampler(clip);
    let first = sampler.sample(0.0);
    let last = sampler.sample(clip.duration);
    let turned = first.turns.iter().zip(&last.turns).map(|(a, b)| a.angle_between(*b)).fold(0.0, f64::max);
    let moved =
        first.positions.iter().zip(&last.positions).map(|(a, b)| (*a + travel).distance(*b)).fold(0.0, f64::max);
    (turned.to_degrees(), moved * 1e3)
}

/// The contacts of cycles one after the other; what goes on over a seam is one.
fn in_turn(contacts: &[FootContact], period: f64, travel: DVec3) -> Vec<FootContact> {
    let mut list: Vec<FootContact> = Vec::new();
    for side in Side::BOTH {
        for round in 0..ROUNDS {
            let (later, way) = (round as f64 * period, travel * round as f64);
            for contact in contacts.iter().filter(|contact| contact.side == side) {
                let plant = Plant { ankle: contact.plant.ankle + way, ..contact.plant };
                let next = FootContact { start: contact.start + later, end: contact.end + later, plant, ..*contact };
                match list.last_mut() {
                    Some(last)
                        if last.side == side && last.part == next.part && (next.start - last.end).abs() < SAME =>
                    {
                        last.end = next.end;
                    }
                    _ => list.push(next),
                }
            }
        }
    }
    list
}

/// When feet come down and leave; what happens at the end happens at the start.
fn events(contacts: &[FootContact], period: f64) -> Vec<Event> {
    let mut list = Vec::new();
    let around = |a: f64, b: f64| (a - b).abs().min((a - b - period).abs()).min((a - b + period).abs());
    for contact in contacts {
        let own = || contacts.iter().filter(|other| other.side == contact.side);
        let mut event = |time: f64, name: &str| {
            let time = if period - time < SAME { 0.0 } else { time };
            list.push(Event { time, name: name.into(), foot: Some(contact.side), bone: None, impulse: None });
        };
        if !own().any(|other| around(contact.start, other.end) < SAME) {
            event(contact.start, "foot_down");
        }
        if !own().any(|other| around(contact.end, other.start) < SAME) {
            event(contact.end, "foot_up");
        }
    }
    list.sort_by(|a, b| a.time.total_cmp(&b.time));
    list
}
