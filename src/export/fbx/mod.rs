//! A clip as an FBX file: the skeleton and one take, for programs that take root motion and avatars from FBX alone.
//!
//! In: a rig's clip, document units. Out: binary FBX 7.4 in centimetres, Y up; no mesh, no helper nodes. What is written to whom:
//! [`skeleton`] chooses the bones and their rest, [`take`] samples the clip on even frames, [`euler`] and [`curves`] make curves of it,
//! [`document`] orders the records and [`element`] writes them.

mod curves;
mod document;
mod element;
mod euler;
mod skeleton;
mod take;

use super::{ExportError, glb};
use crate::model::{Clip, ClipReport};
use crate::rig::Rig;
use glam::{DAffine3, DVec3};

/// A metre in the file's unit.
const CENTIMETRES: f64 = 100.0;

/// An FBX file is done.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedFbx {
    /// The file.
    pub bytes: Vec<u8>,
    /// The take's name.
    pub name: String,
    /// Hz.
    pub fps: f64,
    /// What the clip says about itself, in the take's seconds and the file's axes, metres.
    pub report: ClipReport,
    /// What is other than in the rig or the clip, as sentences.
    pub changes: Vec<String>,
}

/// The bytes of an FBX file of that clip.
pub fn fbx(rig: &Rig, clip: &Clip, report: &ClipReport) -> Result<ExportedFbx, ExportError> {
    glb::check(rig, clip)?;
    let mut skeleton = skeleton::Skeleton::new(rig, clip);
    let mut changes = skeleton.changes.clone();
    let take = take::Take::new(rig, clip, report, &skeleton, &mut changes)?;
    let name = take_name(&clip.name, &mut changes);
    skeleton.set_aside(&take.frames);
    let animated = curves::curves(&skeleton, &take);
    let bytes = element::file(&document::document(&name, &skeleton, &take, &animated))?;
    let report = in_take(report, take.pace, &skeleton.file_from_document);
    Ok(ExportedFbx { bytes, name, fps: take.fps, report, changes })
}

/// The clip's name as FBX can hold it.
fn take_name(clip: &str, changes: &mut Vec<String>) -> String {
    let held = skeleton::held(clip);
    let name = if held.is_empty() { "take".to_owned() } else { held };
    if name != clip {
        changes.push(format!("clip \"{}\" is \"{name}\" in the FBX", skeleton::shown(clip)));
    }
    name
}

/// The report in the take's seconds, and in metres along the file's axes.
fn in_take(report: &ClipReport, pace: f64, file_from_document: &DAffine3) -> ClipReport {
    let mut report = report.clone();
    for contact in &mut report.contacts {
        (contact.start, contact.end) = (contact.start * pace, contact.end * pace);
        let place = file_from_document.transform_point3(DVec3::from(contact.position));
        contact.position = (place / CENTIMETRES).to_array();
        contact.normal = file_from_document.transform_vector3(contact.normal.into()).normalize_or_zero().to_array();
    }
    for scuff in &mut report.scuffs {
        (scuff.start, scuff.end) = (scuff.start * pace, scuff.end * pace);
    }
    for push in &mut report.disturbances {
        (push.start, push.end) = (push.start * pace, push.end * pace);
        let force = DVec3::from(push.force);
        push.force = (file_from_document.transform_vector3(force).normalize_or_zero() * force.length()).to_array();
    }
    report.events.iter_mut().for_each(|event| event.time *= pace);
    report.duration *= pace;
    if let Some(looped) = &mut report.looped {
        looped.period *= pace;
        looped.speed /= pace;
    }
    report
}
