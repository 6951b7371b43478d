//! A clip on the even grid of frames that FBX programs read: the local transform of every bone in every frame.
//!
//! The grid has the clip's own rate where FBX has a name for it, else 60 or 30 Hz. A loop lasts a whole number of frames, the nearest to
//! its own time, so that its last frame is its first; any other clip ends in the first frame at or after its end, and holds.

use super::super::ExportError;
use super::skeleton::{Skeleton, shown};
use crate::model::{Clip, ClipReport};
use crate::rig::{Rig, Trs};

/// Rates that FBX has a name for (FbxTime::EMode), Hz, and their numbers.
const RATES: [(f64, i32); 8] =
    [(24.0, 11), (25.0, 10), (30.0, 6), (48.0, 5), (50.0, 4), (60.0, 3), (100.0, 2), (120.0, 1)];
/// Hz: for clips of another rate, above 30 and up to it.
const FAST: f64 = 60.0;
/// The same for the others.
const USUAL: f64 = 30.0;
/// Hz: rates nearer to each other are the same.
const SAME_RATE: f64 = 1e-3;
/// Frames: a clip that ends so shortly after a frame ends with it.
const SAME_FRAME: f64 = 1e-2;
/// Frames and bones of a file at most, multiplied.
const MOST_TRANSFORMS: usize = 1 << 26;

/// The frames.
#[derive(Clone, Debug)]
pub struct Take {
    /// Hz.
    pub fps: f64,
    /// The number of that rate in FBX.
    pub time_mode: i32,
    /// (frames)(bones) local transforms, cm. One frame at least.
    pub frames: Vec<Vec<Trs>>,
    /// The take's seconds in one of the clip's: 1 but for loops.
    pub pace: f64,
}

impl Take {
    /// Of that clip; sentences of what differs go to `changes`.
    pub fn new(
        rig: &Rig,
        clip: &Clip,
        report: &ClipReport,
        skeleton: &Skeleton,
        changes: &mut Vec<String>,
    ) -> Result<Take, ExportError> {
        let (fps, time_mode) = rate(clip.fps);
        if (fps - clip.fps).abs() > SAME_RATE {
            changes.push(format!("FBX has no name for {} fps: the take has {fps} frames a second", clip.fps));
        }
        let exact = (clip.duration * fps).clamp(0.0, f64::from(u32::MAX));
        let last = if report.looped.is_some() { exact.round().max(1.0) } else { (exact - SAME_FRAME).ceil().max(0.0) };
        let pace = if report.looped.is_some() && exact > 0.0 { last / exact } else { 1.0 };
        if (last - exact).abs() > SAME_FRAME && report.looped.is_some() {
            changes.push(format!(
                "the loop lasts {:.3} s: in the FBX {last} frames, {:.3} s, so that it ends on a frame",
                clip.duration,
                last / fps
            ));
        }
        let count = last as usize + 1;
        if count.saturating_mul(skeleton.bones.len()) > MOST_TRANSFORMS {
            let what = format!("{count} frames of {} bones are too many for an FBX", skeleton.bones.len());
            return Err(ExportError::Document { reason: what });
        }
        let mut sampler = rig.sampler(clip);
        let mut frames = Vec::with_capacity(count);
        for frame in 0..count {
            let time = frame as f64 / fps / pace;
            let root = sampler.new_root_global(time);
            let locals = skeleton.locals(sampler.node_globals(time), root);
            let broken =
                |local: &Trs| !(local.translation.is_finite() && local.rotation.is_finite() && local.scale.is_finite());
            if let Some(bone) = locals.iter().position(broken) {
                let node = format!("bone \"{}\"", shown(&skeleton.bones[bone].name));
                return Err(ExportError::NotFinite { clip: clip.name.clone(), node, time });
            }
            frames.push(locals);
        }
        Ok(Take { fps, time_mode, frames, pace })
    }
}

/// The rate of the grid, Hz, and its number.
fn rate(clip: f64) -> (f64, i32) {
    let named = |wanted: f64| RATES.into_iter().find(|(rate, _)| (rate - wanted).abs() < SAME_RATE);
    let other = if clip > USUAL { FAST } else { USUAL };
    named(clip).or_else(|| named(other)).unwrap_or((USUAL, 6))
}
