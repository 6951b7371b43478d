//! A capture as a clip of a rig that somebody else's body moved: retargeted, keyed, and with what its feet hold.
//!
//! Clip space in, the rig's scenario space after the retarget: turned by a whole quarter so that it begins facing forward as nearly as that
//! goes, and moved so that it begins over the origin. Contacts are the source's stances; what the keys do is measured on the clip as read back.

use super::contacts::{FootContact, held};
use super::keys::{Curves, KeyInput, keyed_clip};
use super::root_motion::RootMotion;
use crate::maths::quat::yaw_of;
use crate::measure::{Findings, Frame, KnownPush, Motion, PushPoint, measure};
use crate::mocap::retarget::{Planted, belt, planted_parts, retarget};
use crate::model::report::{Assist, BodyReport, Contact, Disturbance, Event, Outcome, Part, Plausibility};
use crate::model::{BodyPose, Capture, Clip, ClipReport, Plant, Side};
use crate::rig::Rig;
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Hz: a clip with more frames a second is keyed at a whole part of its rate.
const FASTEST: f64 = 60.0;
/// Samples a frame that are measured.
const PER_FRAME: usize = 4;

/// What to make of it.
#[derive(Clone, Debug, PartialEq)]
pub struct RetargetOptions {
    /// Name of the clip; the capture's own where none is given.
    pub name: Option<String>,
    /// Keys a second; the capture's own rate, or the whole part of it that is at most 60.
    pub fps: Option<f64>,
    /// Where the travel goes.
    pub root: RootMotion,
    /// How its keys are joined.
    pub curves: Curves,
}

/// A clip and what is known of it.
#[derive(Clone, Debug)]
pub struct Retargeted {
    /// Keys on the rig's nodes.
    pub clip: Clip,
    /// What the clip says about itself.
    pub report: ClipReport,
    /// The motion behind it, in the rig's scenario space.
    pub capture: Capture,
    /// What was done, as sentences.
    pub notes: Vec<String>,
}

/// Makes it. `None` for a capture without a motion: fewer than two frames, or numbers that are none.
pub fn retargeted(rig: &Rig, source: &Capture, options: &RetargetOptions) -> Option<Retargeted> {
    let sound = |capture: &Capture| {
        capture.positions.iter().all(|place| place.is_finite()) && capture.turns.iter().all(|turn| turn.is_finite())
    };
    if source.frames() < 2 || source.fps <= 0.0 || !source.fps.is_finite() || !sound(source) {
        return None;
    }
    let known = source.notes.len();
    let mut capture = retarget(source, &rig.body);
    let mut notes = capture.notes.split_off(known.min(capture.notes.len()));
    notes.extend(begin_at_the_origin(&mut capture));
    if !sound(&capture) {
        return None;
    }
    let name = options.name.clone().unwrap_or_else(|| source.name.clone());
    let fps = options.fps.unwrap_or_else(|| source.fps / (source.fps / FASTEST - 1e-6).ceil().max(1.0));
    let duration = (source.frames() - 1) as f64 / source.fps;
    let contacts = if belt(source).is_none() { contacts(source, &capture) } else { Vec::new() };
    let pose = |time: f64| pose_at(&capture, time);
    let key = |root_motion: RootMotion| {
        keyed_clip(&KeyInput {
            rig,
            name: &name,
            fps,
            duration,
            pose: &pose,
            contacts: &contacts,
            root_motion,
            curves: options.curves,
        })
    };
    let clip = key(options.root);
    // What is measured is the motion with its travel.
    let whole = if options.root == RootMotion::InPlace { key(RootMotion::Root) } else { clip.clone() };
    let report = report(rig, source, &capture, &whole, &contacts, options);
    Some(Retargeted { clip, report, capture, notes })
}

/// Turns and moves a capture so that it begins over the origin, facing forward; what was done, if it was turned.
fn begin_at_the_origin(capture: &mut Capture) -> Option<String> {
    let quarters = (yaw_of(capture.turns_at(0)[0]) / FRAC_PI_2).round();
    let turn = DQuat::from_rotation_y(-quarters * FRAC_PI_2);
    let start = capture.at(0)[0] * DVec3::new(1.0, 0.0, 1.0);
    capture.positions.iter_mut().for_each(|place| *place = turn * (*place - start));
    capture.turns.iter_mut().for_each(|own| *own = (turn * *own).normalize());
    capture.pushes.iter_mut().for_each(|push| push.force = turn * push.force);
    (quarters != 0.0).then(|| format!("turned by {:.0} degrees to face forward as it begins", -90.0 * quarters))
}

/// The pose between frames.
fn pose_at(capture: &Capture, time: f64) -> BodyPose {
    let last = capture.frames() - 1;
    let place = (time * capture.fps).clamp(0.0, last as f64);
    let from = (place.floor() as usize).min(last.saturating_sub(1));
    let share = place - from as f64;
    let (a, b) = (capture.turns_at(from), capture.turns_at(from + 1));
    BodyPose {
        hips: capture.at(from)[0].lerp(capture.at(from + 1)[0], share),
        turns: a.iter().zip(b).map(|(a, b)| a.slerp(*b, share)).collect(),
    }
}

/// The source's stances as what the target's feet hold.
fn contacts(source: &Capture, target: &Capture) -> Vec<FootContact> {
    let scale = target.body.leg_length / source.body.leg_length.max(1e-6);
    let mut pieces = planted_parts(source);
    pieces.sort_by_key(|(planted, ..)| (planted.side as usize, planted.start));
    let time = |frame: usize| frame as f64 / source.fps;
    let mut out: Vec<FootContact> = Vec::new();
    let mut before: Option<Planted> = None;
    for (planted, part, height) in pieces {
        let Planted { side, start, end } = planted;
        let ankle = target.body.feet[side as usize].ankle;
        let middle = (start + end) / 2;
        let place = target.at(middle)[ankle] * DVec3::new(1.0, 0.0, 1.0) + DVec3::Y * height * scale;
        let plant = Plant::level(place, yaw_of(target.turns_at(middle)[ankle]));
        let mut contact = FootContact { side, part, start: time(start), end: time(end), plant };
        if let Some(last) =
            out.last_mut().filter(|_| before.is_some_and(|one| one.side == side && one.end + 1 == start))
        {
            // Between two frames the part that both share holds: a flat foot's ball, a heel that comes down.
            if last.part == Part::Flat {
                contact.start = last.end;
            } else {
                last.end = contact.start;
            }
        }
        before = Some(planted);
        out.push(contact);
    }
    out.retain(|contact| contact.end > contact.start + 1e-9);
    out.sort_by(|a, b| a.start.total_cmp(&b.start).then((a.side as usize).cmp(&(b.side as usize))));
    out
}

fn report(
    rig: &Rig,
    source: &Capture,
    capture: &Capture,
    clip: &Clip,
    contacts: &[FootContact],
    options: &RetargetOptions,
) -> ClipReport {
    let hz = clip.fps * PER_FRAME as f64;
    let count = (clip.duration * hz + 1e-6).floor() as usize + 1;
    let mut sampler = rig.sampler(clip);
    let poses: Vec<BodyPose> = (0..count).map(|sample| sampler.sample(sample as f64 / hz).pose()).collect();
    let pushes: Vec<KnownPush> = (capture.pushes.iter())
        .map(|push| KnownPush {
            start: push.start,
            end: push.end,
            force: push.force,
            at: push.joint.map_or(PushPoint::Centre, PushPoint::Joint),
        })
        .collect();
    let motion = Motion { body: &rig.body, hz, per_frame: PER_FRAME, poses: &poses };
    let findings = measure(motion, &held(contacts, Frame::World), &pushes, 1.0);
    let findings = findings.map(|found| Findings { given: true, ..found });
    let mut plausibility = findings.as_ref().map_or_else(Plausibility::default, |findings| findings.plausibility());
    plausibility.notes.push("measured in the stances of the clip that it was retargeted from".into());
    if options.root == RootMotion::InPlace {
        plausibility.notes.push("measured with the travel that in-place leaves out".into());
    }
    let stances = crate::mocap::retarget::planted(source);
    let steps = stances.iter().filter(|stance| stance.start > 0).count() as u32;
    let time = |frame: usize| frame as f64 / source.fps;
    let mut events: Vec<Event> = Vec::new();
    let mut event = |time: f64, name: &str, foot: Side| {
        events.push(Event { time, name: name.into(), foot: Some(foot), bone: None, impulse: None });
    };
    for stance in &stances {
        if stance.start > 0 {
            event(time(stance.start), "foot_down", stance.side);
        }
        if stance.end + 1 < source.frames() {
            event(time(stance.end), "foot_up", stance.side);
        }
    }
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    let similarity = &rig.document_from_scenario;
    let slip =
        |at: usize| findings.as_ref().and_then(|findings| findings.feet.slips.get(at)).map_or(0.0, |slip| slip.mm);
    ClipReport {
        version: 1,
        generator: concat!("surefoot ", env!("CARGO_PKG_VERSION")).into(),
        fps: clip.fps,
        duration: clip.duration,
        seed: 0,
        root_motion: options.root.name().into(),
        drift: None,
        search: None,
        base: None,
        looped: None,
        drive: "retarget".into(),
        scenario: source.name.clone(),
        outcome: findings.as_ref().map_or(Outcome::Still, |findings| findings.balance.outcome(steps)),
        steps,
        body: BodyReport { mass: rig.body.mass, height: rig.body.height },
        contacts: contacts
            .iter()
            .enumerate()
            .map(|(at, contact)| Contact {
                foot: contact.side,
                part: contact.part,
                start: contact.start,
                end: contact.end,
                frame: Frame::World.name().into(),
                position: similarity.point(contact.plant.ankle).to_array(),
                normal: (similarity.rotation * contact.plant.normal).to_array(),
                slip_mm: slip(at),
            })
            .collect(),
        scuffs: Vec::new(),
        events,
        disturbances: capture
            .pushes
            .iter()
            .map(|push| Disturbance {
                kind: "push".into(),
                start: push.start,
                end: push.end,
                force: (similarity.rotation * push.force).to_array(),
                bone: push.joint.map_or("hips", |joint| rig.body.joints[joint].role.name()).into(),
            })
            .collect(),
        assist: Assist::default(),
        torques: Vec::new(),
        plausibility,
    }
}
