//! What a clip that was baked here tells of itself, told again after a correction: where its contacts are, how far they slip, how plausible
//! the motion is. The rest (what was done to the body, when, with which outcome) stays as it was baked.
//!
//! DESIGN, "What a baked file is": document world, metres, s. Measured on the written keys at four times their rate, by `measure/`, as the
//! bake does. What cannot be measured from the file alone (a platform's turning, a load in the hands, travel that was left out) goes.

use super::Corrected;
use crate::maths::quat::shortest_arc;
use crate::measure::{Findings, Frame, HeldContact, KnownPush, Motion, PushPoint, measure};
use crate::mocap::Reading;
use crate::model::report::Contact;
use crate::model::{BodyPose, Capture};
use glam::DVec3;
use serde_json::{Map, Value, json};

/// Samples a frame (DESIGN, "Measures").
pub const PER_FRAME: usize = 4;
/// Of the ground, where the file does not tell it: what a scenario has by default.
const FRICTION: f64 = 1.0;

/// The told object with what the correction changed. `written`: the corrected clip as its file shows it, [`PER_FRAME`] times as dense.
pub fn again(told: &Value, reading: &Reading, corrected: &Corrected, written: &Capture) -> Option<Value> {
    let mut told = told.as_object()?.clone();
    if corrected.speed != 1.0 {
        faster(&mut told, corrected.speed);
    }
    let mut contacts: Vec<Option<Contact>> = list(&told, "contacts").iter().map(read).collect();
    for contact in contacts.iter_mut().flatten() {
        shift(contact, reading, corrected);
    }
    let to_clip = shortest_arc(reading.frame_up, DVec3::Y);
    let units = reading.rig.document_from_scenario.scale;
    let held: Vec<HeldContact> = contacts
        .iter()
        .flatten()
        .map(|contact| HeldContact {
            side: contact.foot,
            part: contact.part,
            start: contact.start - reading.start,
            end: contact.end - reading.start,
            point: to_clip * DVec3::from_array(contact.position) / units,
            normal: to_clip * DVec3::from_array(contact.normal),
            frame: Frame::World,
        })
        .collect();
    let kind = |disturbance: &Value| disturbance.get("kind").and_then(Value::as_str).map(str::to_owned);
    let carries = list(&told, "disturbances").iter().any(|one| kind(one).as_deref() == Some("carry"));
    let turns = contacts.iter().flatten().any(|contact| contact.frame != Frame::World.name());
    let stays = told.get("root_motion").and_then(Value::as_str) == Some("in-place");
    let known = contacts.iter().all(Option::is_some) && !carries && !turns && !stays;
    // Who falls is measured while the feet carry, as in the bake.
    let falls = told.get("outcome").and_then(Value::as_str) == Some("fall");
    let name = |event: &&Value| event.get("name").and_then(Value::as_str) == Some("balance_lost");
    let lost = list(&told, "events").iter().find(name).and_then(|event| event.get("time")).and_then(Value::as_f64);
    let until = lost.filter(|_| falls).map_or(f64::INFINITY, |lost| lost - reading.start / corrected.speed);
    let given = told.get("drive").and_then(Value::as_str) == Some("retarget");
    let found = known.then(|| measured(written, &held, until)).flatten();
    let found = found.map(|found| Findings { falls: falls || found.falls, given, ..found });
    let slips = found.as_ref().map(|found| found.feet.slips.iter().map(|slip| slip.mm).collect::<Vec<f64>>());
    let mut held = 0;
    for (value, contact) in list_mut(&mut told, "contacts").iter_mut().zip(contacts) {
        let (Some(fields), Some(contact)) = (value.as_object_mut(), contact) else { continue };
        fields.insert("position".into(), json!(contact.position));
        match slips.as_ref().and_then(|slips| slips.get(held)) {
            Some(slip) => fields.insert("slip_mm".into(), json!(slip)),
            None => fields.shift_remove("slip_mm"),
        };
        held += 1;
    }
    match found.map(|found| found.plausibility()).and_then(|found| serde_json::to_value(found).ok()) {
        Some(mut plausibility) => {
            if let Some(notes) = plausibility.get_mut("notes").and_then(Value::as_array_mut) {
                notes.push("measured again after a correction".into());
            }
            told.insert("plausibility".into(), plausibility);
        }
        None => drop(told.shift_remove("plausibility")),
    }
    let rate = written.fps / PER_FRAME as f64;
    let time = |frame: usize| reading.start / corrected.speed + frame as f64 / rate;
    let done = corrected.done.iter().map(|done| {
        json!({ "start": time(done.start), "end": time(done.end), "rule": done.rule.name(), "foot": done.foot,
            "moved_m": done.moved_m, "what": done.what })
    });
    told.insert("corrected".into(), done.collect());
    Some(Value::Object(told))
}

fn list<'a>(told: &'a Map<String, Value>, key: &str) -> &'a [Value] {
    told.get(key).and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default()
}

fn list_mut<'a>(told: &'a mut Map<String, Value>, key: &str) -> &'a mut [Value] {
    told.get_mut(key).and_then(Value::as_array_mut).map(Vec::as_mut_slice).unwrap_or_default()
}

fn read(contact: &Value) -> Option<Contact> {
    let mut contact = contact.clone();
    contact.as_object_mut()?.entry("slip_mm").or_insert(json!(0.0));
    let contact: Contact = serde_json::from_value(contact).ok()?;
    let sound = contact.position.iter().chain(&contact.normal).all(|number| number.is_finite());
    (sound && contact.start.is_finite() && contact.end.is_finite()).then_some(contact)
}

/// Every time in it divided.
fn faster(told: &mut Map<String, Value>, speed: f64) {
    let scale = |fields: &mut Map<String, Value>, key: &str, by: f64| {
        if let Some(number) = fields.get(key).and_then(Value::as_f64) {
            fields.insert(key.into(), json!(number * by));
        }
    };
    scale(told, "fps", speed);
    scale(told, "duration", 1.0 / speed);
    for (key, times) in
        [("contacts", ["start", "end"]), ("disturbances", ["start", "end"]), ("events", ["time", "time_end"])]
    {
        for fields in list_mut(told, key).iter_mut().filter_map(Value::as_object_mut) {
            times.iter().for_each(|time| scale(fields, time, 1.0 / speed));
        }
    }
}

/// A contact's place goes with the foot: by the median of what its ankle was moved over the contact's frames, along the plane.
fn shift(contact: &mut Contact, reading: &Reading, corrected: &Corrected) {
    let (old, new) = (&reading.capture, &corrected.capture);
    let ankle = old.body.feet[contact.foot as usize].ankle;
    let frame =
        |time: f64| ((time * new.fps - reading.start * old.fps).round().max(0.0) as usize).min(old.frames() - 1);
    let mut moved: Vec<DVec3> =
        (frame(contact.start)..=frame(contact.end)).map(|frame| new.at(frame)[ankle] - old.at(frame)[ankle]).collect();
    moved.sort_by(|a, b| a.length().total_cmp(&b.length()));
    let Some(by) = moved.get(moved.len() / 2) else { return };
    let to_file = shortest_arc(reading.frame_up, DVec3::Y).inverse();
    let by = to_file * *by * reading.rig.document_from_scenario.scale;
    let normal = DVec3::from_array(contact.normal).normalize_or(to_file * DVec3::Y);
    let along = by - normal * by.dot(normal);
    contact.position = (DVec3::from_array(contact.position) + along).to_array();
}

/// `until`: s, what comes later is left out.
fn measured(written: &Capture, contacts: &[HeldContact], until: f64) -> Option<Findings> {
    let frames = ((until * written.fps).floor().max(4.0) as usize).saturating_add(1).min(written.frames());
    let poses: Vec<BodyPose> = (0..frames)
        .map(|frame| BodyPose { hips: written.at(frame)[0], turns: written.turns_at(frame).to_vec() })
        .collect();
    let motion = Motion { body: &written.body, hz: written.fps, per_frame: PER_FRAME, poses: &poses };
    let pushes: Vec<KnownPush> = written
        .pushes
        .iter()
        .map(|push| KnownPush {
            start: push.start,
            end: push.end,
            force: push.force,
            at: push.joint.map_or(PushPoint::Centre, PushPoint::Joint),
        })
        .collect();
    measure(motion, contacts, &pushes, FRICTION)
}
