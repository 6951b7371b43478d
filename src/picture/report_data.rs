//! A judged clip as the compact JSON that the audit's page draws from. Clip space; lengths in whole millimetres, angles in milliradians.
//!
//! `joints` and `curves` are differences from one sample to the next, so that most numbers have one or two digits. A sample is a frame, or
//! every `stride`-th frame of a clip too long for its share of the page. Numbers of flags, contacts and steps are clip frames.

use super::report_frames::FrameRow;
use crate::maths::real;
use crate::model::findings::{Findings, FootContact};
use crate::model::{Capture, Role, Side};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use std::fmt::Write;

/// A clip with what was found in it.
#[derive(Clone, Copy, Debug)]
pub struct ClipView<'a> {
    /// The file, as a person named it.
    pub file: &'a str,
    /// The motion.
    pub capture: &'a Capture,
    /// What was found.
    pub findings: &'a Findings,
    /// One a frame.
    pub rows: &'a [FrameRow],
    /// Why a flag is accepted, one a flag.
    pub waived: &'a [Option<String>],
    /// The same for what is wrong with the whole clip.
    pub waived_clip: &'a [Option<String>],
}

/// Letters that a number takes in a table of differences, with its comma: what was seen, with a reserve.
const LETTERS: usize = 3;
/// mm; past that a number is cut.
const FARTHEST: f64 = 1e9;

/// The JSON of a clip, in about so many bytes at most.
pub fn clip_json(view: &ClipView, most_bytes: usize) -> String {
    let frames = view.rows.len();
    let shown = shown_joints(view.capture);
    let columns = 3 * (shown.len() + 7) + CURVES.len();
    let mut stride = (frames * columns * LETTERS).div_ceil(most_bytes.max(1)).max(1);
    loop {
        let text = at_stride(view, &shown, stride);
        if text.len() <= most_bytes || stride * 2 >= frames {
            return text;
        }
        stride += stride.div_ceil(4);
    }
}

fn at_stride(view: &ClipView, shown: &[usize], stride: usize) -> String {
    let findings = view.findings;
    let waived = |value: Value, reason: &Option<String>| match (value, reason) {
        (Value::Object(mut object), Some(reason)) => {
            object.insert("waived".to_owned(), json!(reason));
            Value::Object(object)
        }
        (value, _) => value,
    };
    let flags: Vec<Value> =
        findings.flags.iter().zip(view.waived).map(|(flag, reason)| waived(json!(flag), reason)).collect();
    let clip_flags: Vec<Value> =
        findings.clip_flags.iter().zip(view.waived_clip).map(|(flag, reason)| waived(json!(flag), reason)).collect();
    let head = json!({
        "file": view.file, "name": findings.clip, "fps": findings.fps, "frames": view.rows.len(), "stride": stride,
        "unit": findings.units_to_metres, "up": findings.up, "confidence": findings.confidence,
        "method": view.capture.method, "height": view.capture.body.height,
        "bones": bones(view.capture, shown), "columns": shown.len() + 7, "curveNames": CURVES,
        "feet": view.capture.body.feet.each_ref().map(|foot| mm(foot.half_width)),
        "flags": flags, "clipFlags": clip_flags, "contacts": findings.contacts, "prints": prints(view),
        "steps": findings.steps, "abstained": findings.abstained, "notes": findings.notes,
    });
    let mut text = head.to_string();
    text.pop(); // the brace; two tables follow
    let samples = || view.rows.iter().step_by(stride);
    table(&mut text, "joints", samples().map(|row| places(view.capture, shown, row)));
    table(&mut text, "curves", samples().map(|row| curves(row).to_vec()));
    text.push('}');
    text
}

/// `,"name":[...]`: rows of equal length one after the other, each but the first as differences.
fn table(text: &mut String, name: &str, rows: impl Iterator<Item = Vec<i64>>) {
    write!(text, ",\"{name}\":[").expect("a string takes all");
    let mut before: Vec<i64> = Vec::new();
    for (index, row) in rows.enumerate() {
        before.resize(row.len(), 0);
        for (column, (value, before)) in row.iter().zip(&before).enumerate() {
            let comma = if index + column > 0 { "," } else { "" };
            write!(text, "{comma}{}", value - before).expect("a string takes all");
        }
        before = row;
    }
    text.push(']');
}

/// Columns of `curves`. `pressed` and `supported` are 1 where there is a ZMP and a margin, parts -1 where the foot does not bear.
const CURVES: [&str; 16] = [
    "speed",
    "com_x",
    "com_y",
    "com_z",
    "xi_x",
    "xi_z",
    "zmp_x",
    "zmp_z",
    "pressed",
    "margin",
    "supported",
    "part_left",
    "part_right",
    "sole_left",
    "sole_right",
    "floor",
];

fn curves(row: &FrameRow) -> [i64; 16] {
    let part = |part: Option<&str>| match part {
        None => -1,
        Some("heel") => 0,
        Some("ball") => 1,
        Some(_) => 2,
    };
    let zmp = row.zmp.unwrap_or(DVec2::new(row.com.x, row.com.z));
    [
        mm(row.speed),
        mm(row.com.x),
        mm(row.com.y),
        mm(row.com.z),
        mm(row.xi.x),
        mm(row.xi.y),
        mm(zmp.x),
        mm(zmp.y),
        i64::from(row.zmp.is_some()),
        mm(row.margin.unwrap_or(0.0)),
        i64::from(row.margin.is_some()),
        part(row.parts[0]),
        part(row.parts[1]),
        mm(row.soles[0]),
        mm(row.soles[1]),
        mm(row.floor),
    ]
}

/// The joints that a stick figure needs: no fingers, eyes, jaw.
fn shown_joints(capture: &Capture) -> Vec<usize> {
    let drawn =
        |role: Role| !matches!(role, Role::Jaw | Role::LeftEye | Role::RightEye) && role < Role::LeftThumbMetacarpal;
    (0..capture.body.joints.len()).filter(|joint| drawn(capture.body.joints[*joint].role)).collect()
}

/// Joints, then the top of the head, then heel, ball and tip of the left sole and of the right.
fn places(capture: &Capture, shown: &[usize], row: &FrameRow) -> Vec<i64> {
    let at = capture.at(row.frame);
    let mut points: Vec<DVec3> = shown.iter().map(|joint| at[*joint]).collect();
    let head = capture.body.joint(Role::Head).unwrap_or(0);
    let over =
        (capture.body.height - capture.body.joints[head].rest.y).clamp(0.08 * capture.body.height, capture.body.height);
    points.push(capture.rigid_point(row.frame, head, DVec3::Y * over));
    points.extend(row.outlines.iter().flatten());
    points.iter().flat_map(|point| point.to_array()).map(mm).collect()
}

/// [from, to, role] in columns of `joints`.
fn bones(capture: &Capture, shown: &[usize]) -> Vec<Value> {
    let column = |joint: usize| shown.iter().position(|other| *other == joint);
    let mut bones = Vec::new();
    for (index, joint) in shown.iter().enumerate() {
        let mut above = capture.body.joints[*joint].parent;
        while above.is_some_and(|parent| column(parent).is_none()) {
            above = above.and_then(|parent| capture.body.joints[parent].parent);
        }
        if let Some(parent) = above.and_then(column) {
            bones.push(json!([parent, index, capture.body.joints[*joint].role.name()]));
        }
    }
    bones
}

/// Footprints: one a stance, from the contacts of a foot that touch one another; where it stands, where it looks, how long it is.
fn prints(view: &ClipView) -> Vec<Value> {
    let mut prints = Vec::new();
    for (side, name) in Side::BOTH.into_iter().zip(["left", "right"]) {
        let mut own: Vec<&FootContact> = view.findings.contacts.iter().filter(|contact| contact.foot == name).collect();
        own.sort_by_key(|contact| (contact.start, contact.end));
        let mut stances: Vec<(usize, usize)> = Vec::new();
        for contact in own {
            match stances.last_mut() {
                Some(last) if contact.start <= last.1 + 1 => last.1 = last.1.max(contact.end),
                _ => stances.push((contact.start, contact.end)),
            }
        }
        for (start, end) in stances {
            let end = end.min(view.rows.len().saturating_sub(1));
            let tilt = |frame: &usize| {
                let [heel, ball, _] = view.rows[*frame].outlines[side as usize];
                (heel.y - ball.y).abs()
            };
            // Where it lies flattest; of an equal tilt the earlier frame.
            let Some(frame) = (start..=end).min_by(|a, b| tilt(a).total_cmp(&tilt(b)).then(a.cmp(b))) else { continue };
            let [heel, ball, tip] = view.rows[frame].outlines[side as usize];
            let flat = |point: DVec3| DVec2::new(point.x, point.z);
            let along = (flat(ball) - flat(heel)).try_normalize().unwrap_or(DVec2::Y);
            let middle = flat(heel + ball) * 0.5;
            let length = |point: DVec3| mm((flat(point) - middle).dot(along));
            prints.push(json!({
                "foot": name, "start": start, "end": end, "x": mm(middle.x), "y": mm(view.rows[frame].floor), "z": mm(middle.y),
                "angle": (real::atan2(along.x, along.y) * 1000.0).round() as i64,
                "heel": length(heel), "ball": length(ball), "tip": length(tip),
            }));
        }
    }
    prints
}

fn mm(metres: f64) -> i64 {
    let value = (metres * 1000.0).round();
    if value.is_finite() { value.clamp(-FARTHEST, FARTHEST) as i64 } else { 0 }
}
