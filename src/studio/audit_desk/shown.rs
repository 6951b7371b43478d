//! A clip as the desk shows it: its motion with what was found in it, as it was and as it was corrected; the scene at a time.
//!
//! Clip space (metres, Y up), s; frames count from 0. Made beside the window. Judges nothing.

use super::skinned::Skinned;
use crate::audit::{AuditOptions, audit};
use crate::correct::Corrected;
use crate::model::findings::{Findings, StepVerdict};
use crate::model::report::Part;
use crate::model::{Body, BodyPose, Capture, Side};
use crate::picture::report_frames::{FrameRow, frame_rows};
use crate::picture::{NodeTransforms, Overlay};
use crate::rig::Rig;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Whose marks and prints are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preview {
    /// As the file is.
    Original,
    /// With everything that is not rejected.
    Corrected,
    /// Corrected, and the original as its ghost.
    #[default]
    Both,
}

/// A motion with its findings.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The poses.
    pub capture: Arc<Capture>,
    /// What the audit says.
    pub findings: Findings,
    /// One a frame.
    pub rows: Vec<FrameRow>,
    /// Where feet stood, by start.
    pub prints: Vec<Print>,
}

/// Where a foot stood.
#[derive(Clone, Debug)]
pub struct Print {
    /// Which foot.
    pub side: Side,
    /// First frame.
    pub start: usize,
    /// Last.
    pub end: usize,
    /// m, outline of the sole on the ground.
    pub outline: Vec<DVec3>,
    /// Index of the step that it ended, of those that were judged.
    pub step: Option<usize>,
}

/// The clip that is open.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Which of the file's.
    pub index: usize,
    /// As it is in the file.
    pub before: Motion,
    /// As it would be; `None` until it is known.
    pub after: Option<After>,
    /// Its mesh, where the file has one.
    pub skinned: Option<Arc<Skinned>>,
}

/// The clip corrected.
#[derive(Clone, Debug)]
pub struct After {
    /// The motion.
    pub motion: Motion,
    /// What could not be mended, and why.
    pub notes: Vec<String>,
    /// Frames that are other than in the file.
    pub changed: usize,
    /// The nodes of the file that are.
    pub edits: Arc<crate::correct::locals::Edits>,
}

/// A step against its prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct StepMark {
    /// Which foot.
    pub side: Side,
    /// m, on the ground: where the pendulum puts it.
    pub predicted: DVec3,
    /// m: where it stands.
    pub actual: DVec3,
    /// m, between the two.
    pub error: f64,
    /// The one that a person looks at.
    pub selected: bool,
    /// It has come down by now.
    pub taken: bool,
}

/// What a 3D view draws of a moment.
pub struct AuditScene<'a> {
    /// s.
    pub time: f64,
    /// Who moves.
    pub body: &'a Body,
    /// How it stands.
    pub pose: BodyPose,
    /// How it stood in the file, where that is another pose.
    pub ghost: Option<BodyPose>,
    /// The mesh of the file, if it has one: to be drawn instead of the body.
    pub rig: Option<&'a Arc<Rig>>,
    /// Its nodes, and those of the ghost; there with `rig`.
    pub nodes: Option<(NodeTransforms, Option<NodeTransforms>)>,
    /// Soles that bear, prints, centre of mass, ξ, centre of pressure.
    pub overlay: Overlay,
    /// Steps against prediction.
    pub steps: Vec<StepMark>,
    /// m, height of the ground there: clips need not stand at 0.
    pub floor: f64,
}

impl Motion {
    /// Judges a clip.
    pub fn audited(capture: Arc<Capture>) -> Motion {
        let findings = audit(&capture, &AuditOptions::default());
        Motion::of(capture, findings)
    }

    fn of(capture: Arc<Capture>, findings: Findings) -> Motion {
        let rows = frame_rows(&capture, &findings);
        let prints = prints(&capture, &findings, &rows);
        Motion { capture, findings, rows, prints }
    }

    /// s, from the first frame to the last.
    pub fn duration(&self) -> f64 {
        self.rows.len().saturating_sub(1) as f64 / self.capture.fps
    }

    /// The frame shown at a time.
    pub fn frame(&self, time: f64) -> usize {
        ((time * self.capture.fps).round().max(0.0) as usize).min(self.rows.len().saturating_sub(1))
    }

    /// The pose at a time, between frames too.
    pub fn pose(&self, time: f64) -> BodyPose {
        let last = self.rows.len().saturating_sub(1);
        let at = (time * self.capture.fps).clamp(0.0, last as f64);
        let (from, share) = (at.floor() as usize, at.fract());
        let to = (from + 1).min(last);
        let (capture, turns) = (&self.capture, |frame: usize| self.capture.turns_at(frame));
        BodyPose {
            hips: capture.at(from)[0].lerp(capture.at(to)[0], share),
            turns: turns(from).iter().zip(turns(to)).map(|(from, to)| from.slerp(*to, share)).collect(),
        }
    }

    fn overlay(&self, time: f64, pose: &BodyPose) -> Overlay {
        let frame = self.frame(time);
        let Some(row) = self.rows.get(frame) else { return Overlay::default() };
        let contacts: Vec<(Side, Part)> =
            Side::BOTH.into_iter().filter_map(|side| Some((side, part(row.parts[side as usize]?)))).collect();
        let mut overlay = Overlay::of_pose(&self.capture.body, pose, &contacts);
        let left = self.prints.iter().filter(|print| print.end < frame);
        overlay.prints = left
            .map(|print| crate::picture::SoleMark {
                side: print.side,
                part: Part::Flat,
                whole: print.outline.clone(),
                held: Vec::new(),
            })
            .collect();
        for point in overlay.soles.iter_mut().flat_map(|sole| sole.whole.iter_mut().chain(&mut sole.held)) {
            point.y = row.floor;
        }
        (overlay.xi, overlay.cop) = (Some(row.xi), row.zmp);
        overlay
    }
}

impl After {
    /// What a correction made.
    pub fn of(corrected: Corrected, edits: Arc<crate::correct::locals::Edits>) -> After {
        let changed = corrected.changed.len();
        let motion = Motion::of(Arc::new(corrected.capture), corrected.after);
        After { motion, notes: corrected.notes, changed, edits }
    }
}

impl Shown {
    /// The motion whose marks are shown.
    pub fn motion(&self, preview: Preview) -> &Motion {
        match (&self.after, preview) {
            (Some(after), Preview::Corrected | Preview::Both) => &after.motion,
            _ => &self.before,
        }
    }

    /// The moment of a time.
    pub fn scene(&self, time: f64, preview: Preview, step: Option<usize>) -> AuditScene<'_> {
        let motion = self.motion(preview);
        let pose = motion.pose(time);
        let both = preview == Preview::Both && self.after.is_some();
        let ghost = both.then(|| self.before.pose(time)).filter(|ghost| *ghost != pose);
        let edits = self.after.as_ref().filter(|_| preview != Preview::Original).map(|after| &*after.edits);
        let nodes = self.skinned.as_ref().map(|skinned| {
            let ghost = ghost.is_some().then(|| skinned.pose(time, None));
            (skinned.pose(time, edits), ghost)
        });
        AuditScene {
            time,
            body: &motion.capture.body,
            overlay: motion.overlay(time, &pose),
            pose,
            ghost,
            rig: self.skinned.as_ref().map(|skinned| &skinned.rig),
            nodes,
            steps: steps(motion, time, step),
            floor: motion.rows.get(motion.frame(time)).map_or(0.0, |row| row.floor),
        }
    }
}

/// Which foot that is.
pub fn side_of(foot: &str) -> Side {
    if foot == "right" { Side::Right } else { Side::Left }
}

fn steps(motion: &Motion, time: f64, selected: Option<usize>) -> Vec<StepMark> {
    let frame = motion.frame(time);
    let mark = |(index, step): (usize, &StepVerdict)| {
        let floor = motion.rows.get(step.touch_down).map_or(0.0, |row| row.floor);
        let place = |[x, z]: [f64; 2]| DVec3::new(x, floor, z);
        StepMark {
            side: side_of(step.foot),
            predicted: place(step.predicted),
            actual: place(step.actual),
            error: step.error_m,
            selected: selected == Some(index),
            taken: step.touch_down <= frame,
        }
    };
    motion.findings.steps.iter().enumerate().map(mark).collect()
}

fn part(name: &str) -> Part {
    match name {
        "heel" => Part::Heel,
        "ball" => Part::Ball,
        _ => Part::Flat,
    }
}

/// A print a stance, from the contacts of a foot that touch one another, where the sole lies flattest.
fn prints(capture: &Capture, findings: &Findings, rows: &[FrameRow]) -> Vec<Print> {
    let mut prints = Vec::new();
    for side in Side::BOTH {
        let mut stances: Vec<(usize, usize)> = Vec::new();
        let mut own: Vec<(usize, usize)> = findings
            .contacts
            .iter()
            .filter(|contact| side_of(contact.foot) == side)
            .map(|contact| (contact.start, contact.end.min(rows.len().saturating_sub(1))))
            .collect();
        own.sort_unstable();
        for (start, end) in own {
            match stances.last_mut() {
                Some(last) if start <= last.1 + 1 => last.1 = last.1.max(end),
                _ => stances.push((start, end)),
            }
        }
        for (start, end) in stances.into_iter().filter(|(start, end)| start <= end && *end < rows.len()) {
            let tilt = |frame: &usize| {
                let [heel, ball, _] = rows[*frame].outlines[side as usize];
                (heel.y - ball.y).abs()
            };
            let Some(frame) = (start..=end).min_by(|a, b| tilt(a).total_cmp(&tilt(b))) else { continue };
            let pose = BodyPose { hips: capture.at(frame)[0], turns: capture.turns_at(frame).to_vec() };
            let overlay = Overlay::of_pose(&capture.body, &pose, &[(side, Part::Flat)]);
            let outline = overlay.soles.into_iter().next().map(|sole| sole.whole).unwrap_or_default();
            let ground = |point: DVec3| DVec3::new(point.x, rows[frame].floor, point.z);
            let ends = |step: &StepVerdict| side_of(step.foot) == side && (start..=end).contains(&step.touch_down);
            let step = findings.steps.iter().position(ends);
            prints.push(Print { side, start, end, outline: outline.into_iter().map(ground).collect(), step });
        }
    }
    prints.sort_by_key(|print| (print.start, print.side));
    prints
}

/// (x, z) of a point.
pub fn flat(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}
