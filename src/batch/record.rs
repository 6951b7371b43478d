//! What is kept of a variation that is done: its identity, what was measured of it, what a sheet and a merged file need. One small file
//! a clip, so that a batch can go on where it stopped and a farm's chunks can be put together.
//!
//! The bytes are `postcard`'s behind a word of magic and a version; what does not read is taken for not done.

use super::{Plan, Variation};
use crate::bake::Baked;
use crate::export::Exported;
use crate::maths::real;
use crate::measure::KnownPush;
use crate::model::report::Outcome;
use crate::model::{Clip, ClipReport};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Before the bytes; the last letter is the version of their form.
const MAGIC: &[u8; 8] = b"SUREREC1";

/// A variation that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Of rig, scenario, settings, name and version: see [`identity`].
    pub identity: String,
    /// Endings and sizes of its files.
    pub files: Vec<(String, u64)>,
    /// What came of it.
    pub measured: Measured,
    /// Tells motions apart: see `measure::alike`.
    pub signature: Vec<f32>,
    /// A small contact sheet, PNG; empty where none was wanted.
    pub cell: Vec<u8>,
    /// What a merged file is made from, where one was wanted instead of a file a clip.
    pub piece: Option<Piece>,
}

/// A clip that waits to be merged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    /// Its keys.
    pub clip: Clip,
    /// Its report, as JSON.
    pub report: String,
}

/// What came of a variation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The clip's name in its file.
    pub clip: String,
    /// still, sway, step or fall.
    pub outcome: String,
    /// Steps.
    pub steps: u32,
    /// The seed that it ran with.
    pub seed: u64,
    /// Who moved the body.
    pub drive: String,
    /// s.
    pub duration: f64,
    /// s from the start of the last disturbance until it is at rest for good; `None` where it is not when the clip ends.
    pub recovery: Option<f64>,
    /// m over the ground from the first frame to the last, of the centre of mass.
    pub travel: f64,
    /// Degrees seen from above, 0 the rig's forward, 90 its left: where all pushes together lead. `None` without one.
    pub direction: Option<f64>,
    /// N s of the horizontal pushes together.
    pub impulse: f64,
    /// Nm on the root.
    pub assist_nm: f64,
    /// N on the root.
    pub assist_n: f64,
    /// mm.
    pub slip: f64,
    /// mm.
    pub penetration: f64,
    /// 0..1.
    pub plausibility: f64,
    /// 0..1.
    pub zmp_inside: f64,
    /// Degrees and mm that the first and the last frame are off the base clip's pose: the larger.
    pub base_error: Option<[f64; 2]>,
    /// Degrees and mm that a loop's last frame is off its first.
    pub loop_error: Option<[f64; 2]>,
    /// BLAKE3 of the clip's file, or of the piece where there is none.
    pub hash: String,
    /// For a person.
    pub warnings: Vec<String>,
}

impl Record {
    /// As bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        postcard::to_extend(self, MAGIC.to_vec()).unwrap_or_default()
    }

    /// From bytes; `None` where they are no record of this version.
    pub fn from_bytes(bytes: &[u8]) -> Option<Record> {
        postcard::from_bytes(bytes.strip_prefix(MAGIC)?).ok()
    }
}

/// What decides a clip's bytes, as one word: the scenario as it is played, the name, the settings, the files of the rig, the
/// base clip and the ground, and the version of the program.
pub fn identity(plan: &Plan, variation: &Variation, (rig, base, ground): (&str, &str, &str), wanted: &str) -> String {
    let mut hasher = blake3::Hasher::new();
    let settings = format!("{:?}", plan.sweep.bake);
    let text = plan.scenario_text(variation);
    let parts = [env!("CARGO_PKG_VERSION"), rig, base, ground, &variation.name, &settings, &text, wanted];
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

/// Reads off a baked clip what the manifest tells.
pub fn measured(baked: &Baked, exported: &Exported) -> Measured {
    let report: &ClipReport = &baked.report;
    let pushes = &baked.performance.pushes;
    let impulse: DVec3 = pushes.iter().map(|push: &KnownPush| push.force * (push.end - push.start)).sum();
    let flat = real::hypot(impulse.x, impulse.z);
    let last = pushes.iter().map(|push| push.start).fold(0.0, f64::max);
    let findings = baked.findings.as_ref();
    let rest = findings.and_then(|findings| findings.balance.rest_from);
    let timeline = &baked.performance.timeline;
    let place = |time: f64| {
        let pose = timeline.pose_at(time);
        pose.centre_of_mass(&timeline.body, &pose.positions(&timeline.body))
    };
    let travel = place(timeline.duration()) - place(0.0);
    let plausibility = &report.plausibility;
    let mut warnings = baked.warnings.clone();
    warnings.extend(exported.changes.clone());
    Measured {
        clip: exported.name.clone(),
        outcome: outcome(report.outcome).into(),
        steps: report.steps,
        seed: report.seed,
        drive: report.drive.clone(),
        duration: report.duration,
        recovery: rest.map(|rest| (rest - last).max(0.0)).filter(|_| report.outcome != Outcome::Fall),
        travel: real::hypot(travel.x, travel.z),
        direction: (flat > 1e-9).then(|| real::atan2(impulse.x, impulse.z).to_degrees()),
        impulse: flat,
        assist_nm: report.assist.peak_nm,
        assist_n: report.assist.peak_n,
        slip: plausibility.slip_max_mm,
        penetration: plausibility.penetration_max_mm,
        plausibility: plausibility.score,
        zmp_inside: plausibility.zmp_inside,
        base_error: report.base.as_ref().map(|b| [b.first_deg.max(b.last_deg), b.first_mm.max(b.last_mm)]),
        loop_error: report.looped.as_ref().map(|cycle| [cycle.error_deg, cycle.error_mm]),
        hash: String::new(),
        warnings,
    }
}

/// The outcome as files call it.
pub fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Still => "still",
        Outcome::Sway => "sway",
        Outcome::Step => "step",
        Outcome::Fall => "fall",
    }
}

/// BLAKE3 of bytes, in hexadecimal digits.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
