//! Clips as bytes: the source document with animations appended, a VRM animation or an FBX; events and helpers for engines beside it. No file
//! is touched here.

pub mod amend;
mod amend_spline;
mod baked;
mod buffers;
pub mod engine;
pub mod events;
pub mod fbx;
pub mod glb;
mod held;
mod only_animation;
mod props;
pub mod root_joint;
mod tpose;
pub mod vrma;

pub use amend::{Amended, amend};
pub use baked::{Exported, Form, baked, exported, root_target};
pub use events::events_json;
pub use fbx::{ExportedFbx, fbx};
pub use glb::{ExportedGlb, glb, glb_with_props, glb_with_root};
pub use only_animation::only_animation;
pub use tpose::t_pose;
pub use vrma::{ExportedVrma, vrma};

/// Why a clip could not be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// A key, or a number of the report, is NaN or infinite.
    #[error("clip \"{clip}\": {node} is not a number at {time:.4} s")]
    NotFinite {
        /// The clip.
        clip: String,
        /// Whose value: a node and its path.
        node: String,
        /// s.
        time: f64,
    },
    /// Key times that no reader accepts.
    #[error("clip \"{clip}\": {node}: {reason}")]
    Keys {
        /// The clip.
        clip: String,
        /// The node and its path.
        node: String,
        /// What is wrong.
        reason: String,
    },
    /// The source document lacks what the clip needs.
    #[error("the source document: {reason}")]
    Document {
        /// What is wrong, with its place.
        reason: String,
    },
    /// The JSON could not be made.
    #[error("writing JSON: {reason}")]
    Json {
        /// As serde_json says.
        reason: String,
    },
    /// GLB counts bytes with 32 bits.
    #[error("the file would have {bytes} bytes; a GLB holds at most 4 GiB")]
    TooLarge {
        /// How many.
        bytes: usize,
    },
}

#[cfg(test)]
pub(crate) mod tests {
    use crate::model::report::*;
    use crate::model::{ClipReport, Side};

    /// A report with one of everything.
    pub(crate) fn report(title: &str) -> ClipReport {
        ClipReport {
            version: 1,
            generator: "surefoot test".into(),
            fps: 30.0,
            duration: 1.0,
            seed: 7,
            root_motion: "root".into(),
            drive: "stepper".into(),
            scenario: title.into(),
            outcome: Outcome::Sway,
            steps: 0,
            body: BodyReport { mass: 89.5, height: 1.7 },
            contacts: vec![Contact {
                foot: Side::Left,
                part: Part::Flat,
                start: 0.0,
                end: 1.0,
                frame: "world".into(),
                position: [0.1, 0.0, 0.0],
                normal: [0.0, 1.0, 0.0],
                slip_mm: 0.1,
            }],
            scuffs: vec![Scuff { foot: Side::Right, start: 0.2, end: 0.3, slid_mm: 12.0 }],
            events: vec![Event { time: 0.5, name: "push_start".into(), foot: None, bone: None, impulse: None }],
            disturbances: Vec::new(),
            assist: Assist::default(),
            torques: Vec::new(),
            plausibility: Plausibility::default(),
            drift: None,
            search: None,
            base: None,
            looped: None,
        }
    }
}
