//! A baked animation as plain keys on the nodes of a document. Values are in *document* units and each node's local space.
//!
//! Keys are f32, as glTF stores them: what is measured on a clip is measured on what a reader will get.

use serde::{Deserialize, Serialize};

/// An animation clip.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clip {
    /// Animation name.
    pub name: String,
    /// Hz of the grid that the keys were made on; single keys may lie between.
    pub fps: f64,
    /// s; the last key of at least one channel stands here.
    pub duration: f64,
    /// Channels; at most one for a (target, path).
    pub channels: Vec<Channel>,
}

/// One animated property.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// What moves.
    pub target: Target,
    /// s, strictly rising, from 0.
    pub times: Vec<f32>,
    /// As many as there are times; of a cubic three a time: tangent in, value, tangent out (units a second).
    pub values: KeyValues,
    /// How values join between keys.
    pub interpolation: Interpolation,
}

/// The node that a channel drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Target {
    /// A node of the source document, by its index there.
    Node(usize),
    /// The `Root` node that the exporter puts over the scene's roots.
    NewRoot,
    /// The helper nodes of the foot contacts.
    ContactLeft,
    /// The same for the right foot.
    ContactRight,
}

/// Key values by path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum KeyValues {
    /// Local translation.
    Translation(Vec<[f32; 3]>),
    /// Local rotation, unit quaternions x, y, z, w; neighbours on the same hemisphere. A cubic's tangents are of their parts.
    Rotation(Vec<[f32; 4]>),
    /// Local scale: only of legs that a scenario makes longer or shorter, and constant.
    Scale(Vec<[f32; 3]>),
}

impl KeyValues {
    /// The property that it drives, as glTF calls it.
    pub fn path(&self) -> &'static str {
        match self {
            KeyValues::Translation(_) => "translation",
            KeyValues::Rotation(_) => "rotation",
            KeyValues::Scale(_) => "scale",
        }
    }

    /// How many there are, a cubic's tangents among them.
    pub fn count(&self) -> usize {
        match self {
            KeyValues::Translation(keys) | KeyValues::Scale(keys) => keys.len(),
            KeyValues::Rotation(keys) => keys.len(),
        }
    }
}

impl Channel {
    /// Whether it has as many values as its times ask for, and a key at least.
    pub fn is_whole(&self) -> bool {
        !self.times.is_empty() && self.values.count() == self.times.len() * self.interpolation.stride()
    }
}

/// glTF interpolation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interpolation {
    /// LINEAR, slerp for rotations.
    Linear,
    /// CUBICSPLINE, of a rotation part by part and made a unit again (glTF 2.0, appendix C).
    Cubic,
    /// STEP.
    Step,
}

impl Interpolation {
    /// Values a key: a cubic has its tangents too.
    pub fn stride(self) -> usize {
        if self == Interpolation::Cubic { 3 } else { 1 }
    }
}
