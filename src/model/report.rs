//! What a baked clip says about itself: `animations[i].extras.surefoot`, and the same in `OUT.events.json`.
//!
//! Other programs read this: the names and meanings are fixed. World space is glTF's (metres, Y up), times seconds.

use super::body::Side;
use serde::{Deserialize, Serialize};

/// The whole object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the names are the file format's own, described in exports/README.md")]
pub struct ClipReport {
    pub version: u32,
    pub generator: String,
    pub fps: f64,
    pub duration: f64,
    pub seed: u64,
    pub root_motion: String,
    pub drive: String,
    pub scenario: String,
    pub outcome: Outcome,
    pub steps: u32,
    pub body: BodyReport,
    pub contacts: Vec<Contact>,
    /// Of a ragdoll's clip: when a foot is on the ground and does not hold still.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scuffs: Vec<Scuff>,
    pub events: Vec<Event>,
    pub disturbances: Vec<Disturbance>,
    pub assist: Assist,
    /// Of a ragdoll's clip: what its joints gave, the hardest worked first.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub torques: Vec<JointTorque>,
    pub plausibility: Plausibility,
    /// Of a ragdoll's clip: how far it is from the body's run, falls apart.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub drift: Option<Drift>,
    /// Of a ragdoll's clip: how far it looked ahead for a way to keep its feet.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub search: Option<Search>,
    /// Where it starts from and returns to.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub base: Option<BaseReport>,
    /// Of a clip that is a cycle.
    #[serde(rename = "loop", skip_serializing_if = "Option::is_none", default)]
    pub looped: Option<LoopReport>,
}

/// A cycle without a seam.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopReport {
    /// s.
    pub period: f64,
    /// Degrees: the joint whose last key is turned the most from its first.
    pub error_deg: f64,
    /// mm: the joint whose last place is the farthest from its first, relative to the root.
    pub error_mm: f64,
    /// m/s, the root's.
    pub speed: f64,
    /// Degrees, what the ends of the performed motion differed by before it was evened out.
    pub evened_deg: f64,
    /// mm, the same of the hips.
    pub evened_mm: f64,
}

/// The base clip, and how far the first and the last frame are from its pose: horizontal place and heading apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "plain")]
pub struct BaseReport {
    pub clip: String,
    pub first_deg: f64,
    pub first_mm: f64,
    pub last_deg: f64,
    pub last_mm: f64,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Nothing moved (less than the measures' 0.05 m/s).
    Still,
    /// It moved and kept its feet where they were.
    Sway,
    /// It stepped and is standing.
    Step,
    /// Balance was lost.
    Fall,
}

/// kg and m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "plain")]
pub struct BodyReport {
    pub mass: f64,
    pub height: f64,
}

/// The part of a sole that holds the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Part {
    /// The rearmost point of the sole holds still.
    Heel,
    /// The toe joint holds still while the heel is off the ground.
    Ball,
    /// Ankle and toe joints hold still.
    Flat,
}

/// One unbroken contact of one part of one foot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Which foot.
    pub foot: Side,
    /// Which part of it.
    pub part: Part,
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// "world" or "platform".
    pub frame: String,
    /// A point of the ground plane under the foot, m, document world.
    pub position: [f64; 3],
    /// The plane's unit normal.
    pub normal: [f64; 3],
    /// mm, largest displacement from the start of the point that the contact holds, at 4 x fps.
    pub slip_mm: f64,
}

/// A foot that is on the ground and does not hold still: it slides, or rolls on the tip or the edge of its sole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scuff {
    /// Which foot.
    pub foot: Side,
    /// s.
    pub start: f64,
    /// s.
    pub end: f64,
    /// mm, how far what touches slides over the ground.
    pub slid_mm: f64,
}

/// A moment worth a name: foot_down foot_up push_start push_end ball_hit balance_lost balance_regained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "plain")]
pub struct Event {
    pub time: f64,
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub foot: Option<Side>,
    /// Of a ball_hit: the bone that it met.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bone: Option<String>,
    /// Of a ball_hit: N s.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub impulse: Option<f64>,
}

/// A disturbance as it was applied. `force`: mean over start..end, N, document world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "plain")]
pub struct Disturbance {
    pub kind: String,
    pub start: f64,
    pub end: f64,
    pub force: [f64; 3],
    pub bone: String,
}

/// What the root was given that no contact supplied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "plain")]
pub struct Assist {
    pub peak_nm: f64,
    pub rms_nm: f64,
    pub peak_n: f64,
    pub rms_n: f64,
}

/// The largest torque of a joint over a run, falls apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointTorque {
    /// The humanoid bone that turns about it.
    pub joint: String,
    /// N m.
    pub peak_nm: f64,
    /// Of the most that a joint may give, 0..1.
    pub share: f64,
}

/// What the body looked for ahead, on copies of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Search {
    /// 0 (none) to 3.
    pub effort: u8,
    /// Copies that were run with other dials of the law.
    pub tried: u32,
    /// Decisions at which one of them was taken.
    pub chosen: u32,
}

/// The joint that is the farthest from where the body's run had it, and the one that is turned the most against it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "plain")]
pub struct Drift {
    pub position_mm: f64,
    pub angle_deg: f64,
}

/// Measured on the exported keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plausibility {
    /// 0..1, one number over the rest.
    pub score: f64,
    /// Share of moving frames with contact whose ZMP is in the support (0.5 cm allowed).
    pub zmp_inside: f64,
    /// cm, 95th percentile, over moving frames with contact, of the distance out of the support (0 where inside).
    pub zmp_outside_p95_cm: f64,
    /// 99th percentile of tangential over normal force.
    pub friction_p99: f64,
    /// Least vertical force over body weight.
    pub vertical_min: f64,
    /// RMS missing force over moving frames, body weights; of a stand's worst half second, where that misses more.
    pub residual_force: f64,
    /// RMS missing moment over the same, body weights x height.
    pub residual_moment: f64,
    /// mm.
    pub slip_max_mm: f64,
    /// mm, the farthest that a foot slides that bears and holds nothing.
    #[serde(default)]
    pub scuff_max_mm: f64,
    /// mm.
    pub penetration_max_mm: f64,
    /// m/s.
    pub peak_ankle_speed: f64,
    /// Peak change of the centre of mass's speed along the push over impulse / mass; 0 without a push.
    pub speed_ratio: f64,
    /// How far that is from what a body on its feet can have, which answers the push after 0.12 s or falls with it as a pendulum.
    #[serde(default)]
    pub speed_beyond: f64,
    /// s in the air: neither foot in contact nor scuffing over the ground, while it has not fallen.
    #[serde(default)]
    pub hover_s: f64,
    /// s, the longest of them at a stretch.
    #[serde(default)]
    pub hover_longest_s: f64,
    /// mm at the reference leg of 0.83 m, or at hips 0.15 m apart where the body's are narrower: the nearest that the axes of thigh or shank of
    /// the two legs come.
    #[serde(default)]
    pub legs_mm: f64,
    /// Degrees, the farthest that a joint is beyond its range.
    #[serde(default)]
    pub joint_excess_deg: f64,
    /// Share of moving frames in which a joint is.
    #[serde(default)]
    pub joint_excess_share: f64,
    /// Jumps of a joint from one frame to the next that those around it do not explain.
    #[serde(default)]
    pub pops: u32,
    /// Degrees, all of them together.
    #[serde(default)]
    pub pops_deg: f64,
    /// mm at the reference leg: how far the feet are at the end from side by side, or from how they stood at first where that is
    /// nearer; 0 for who walks, turns or has fallen there.
    #[serde(default)]
    pub end_stance_mm: f64,
    /// Whether it falls.
    #[serde(default)]
    pub falls: bool,
    /// Sentences for a person.
    pub notes: Vec<String>,
}
