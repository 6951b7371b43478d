//! What an audit says of a clip: flags, contacts, steps, what it abstained from. The JSON of it is fixed (DESIGN, "What an audit says").
//!
//! Metres, Y up, clip space; frames count from 0 and spans include both ends.

use serde::Serialize;

/// The findings of one clip.
#[derive(Clone, Debug, Serialize)]
pub struct Findings {
    /// Of this format.
    pub version: u32,
    /// The clip's name.
    pub clip: String,
    /// Frames a second.
    pub fps: f64,
    /// How many.
    pub frames: usize,
    /// Metres a unit of the file.
    pub units_to_metres: f64,
    /// The file's up axis, as in "+Y".
    pub up: String,
    /// 0..1: how far the verdict is to be believed.
    pub confidence: f64,
    /// By start.
    pub flags: Vec<Flag>,
    /// What is wrong with the whole clip.
    pub clip_flags: Vec<ClipFlag>,
    /// By start, left before right.
    pub contacts: Vec<FootContact>,
    /// By touchdown.
    pub steps: Vec<StepVerdict>,
    /// Where the model does not apply.
    pub abstained: Vec<Abstained>,
    /// Sentences for a person: how the file was read.
    pub notes: Vec<String>,
}

/// A rule's name, as the JSON has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// A step that the inverted pendulum would not have taken.
    FootPlacement,
    /// The zero-moment point is out of the support.
    Balance,
    /// A foot that bears moves over the ground.
    FootSlide,
    /// A foot is under the ground.
    Penetration,
    /// A foot that bears is over the ground.
    Float,
    /// A flight that does not fall as bodies fall.
    Ballistic,
    /// Too slow or too fast for that body.
    Timing,
    /// The root wanders while the feet say otherwise.
    Drift,
}

impl Rule {
    /// Every rule.
    pub const ALL: [Rule; 8] = [
        Rule::FootPlacement,
        Rule::Balance,
        Rule::FootSlide,
        Rule::Penetration,
        Rule::Float,
        Rule::Ballistic,
        Rule::Timing,
        Rule::Drift,
    ];

    /// As the JSON spells it.
    pub fn name(self) -> &'static str {
        match self {
            Rule::FootPlacement => "foot-placement",
            Rule::Balance => "balance",
            Rule::FootSlide => "foot-slide",
            Rule::Penetration => "penetration",
            Rule::Float => "float",
            Rule::Ballistic => "ballistic",
            Rule::Timing => "timing",
            Rule::Drift => "drift",
        }
    }
}

/// A span of frames that no balanced person could have produced.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flag {
    /// First frame.
    pub start: usize,
    /// Last frame, inclusive.
    pub end: usize,
    /// Which rule.
    pub rule: Rule,
    /// "left" or "right", where it is one foot's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub foot: Option<&'static str>,
    /// 0..1.
    pub severity: f64,
    /// What was found; of a foot-placement the actual foothold's lead over the calibrated prediction's origin, m. SI by rule.
    pub measured: f64,
    /// What the model expects there.
    pub predicted: f64,
    /// m, by how much it is off.
    pub delta_m: f64,
    /// A sentence for a person.
    pub why: String,
}

/// What is wrong with a whole clip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClipFlag {
    /// Which rule.
    pub rule: Rule,
    /// 0..1.
    pub severity: f64,
    /// A sentence for a person.
    pub why: String,
}

/// A foot on the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FootContact {
    /// "left" or "right".
    pub foot: &'static str,
    /// "heel", "ball" or "flat".
    pub part: &'static str,
    /// First frame.
    pub start: usize,
    /// Last frame, inclusive.
    pub end: usize,
}

/// One step against the pendulum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepVerdict {
    /// "left" or "right".
    pub foot: &'static str,
    /// Frame.
    pub touch_down: usize,
    /// Frame at which that foot left the ground before.
    pub lift_off: usize,
    /// m, (x, z): where the pendulum puts it.
    pub predicted: [f64; 2],
    /// m, (x, z): where it stands.
    pub actual: [f64; 2],
    /// m, between the two.
    pub error_m: f64,
    /// m, signed along the way: positive is too far ahead.
    pub error_forward_m: f64,
    /// m, signed: positive is too far out, on its own side.
    pub error_sideways_m: f64,
    /// m, along the way from the centre of mass: where a step that stops would land, by the paper's step distance.
    pub stopping_m: f64,
    /// m, along the way from the centre of mass: where this one landed.
    pub lead_m: f64,
}

/// Where nothing is said.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Abstained {
    /// First frame.
    pub start: usize,
    /// Last frame, inclusive.
    pub end: usize,
    /// A sentence for a person.
    pub why: String,
}
