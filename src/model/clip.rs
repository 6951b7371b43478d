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

/// A part of a rotation, to the nearest that a normalised 16-bit integer says.
pub fn in_16_bits(part: f32) -> f32 {
    f32::from(short(part)) / MOST_SHORT
}

/// What a normalised 16-bit integer says as one (glTF 2.0, 3.11).
const MOST_SHORT: f32 = 32767.0;

fn short(part: f32) -> i16 {
    (part * MOST_SHORT).round().clamp(-MOST_SHORT, MOST_SHORT) as i16
}

impl Channel {
    /// Its rotations as normalised 16-bit integers, where those say every part to the bit.
    pub fn shorts(&self) -> Option<Vec<i16>> {
        let KeyValues::Rotation(keys) = &self.values else { return None };
        let exact = |part: &f32| (in_16_bits(*part) == *part).then(|| short(*part));
        keys.iter().flatten().map(exact).collect()
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_that_16_bits_say_to_the_bit_are_told_and_no_others() {
        let turn = |angle: f32| [0.0, (0.5 * angle).sin(), -0.0, (0.5 * angle).cos()];
        let channel = |keys: Vec<[f32; 4]>| Channel {
            target: Target::Node(0),
            times: (0..keys.len()).map(|key| key as f32).collect(),
            values: KeyValues::Rotation(keys),
            interpolation: Interpolation::Linear,
        };
        let exact: Vec<[f32; 4]> = [0.0, 0.3, -2.0].map(|angle| turn(angle).map(in_16_bits)).to_vec();
        let shorts = channel(exact.clone()).shorts().expect("they are of 16 bits");
        assert_eq!(shorts[..4], [0, 0, 0, 32767]);
        let back: Vec<f32> = shorts.iter().map(|short| (f32::from(*short) / 32767.0).max(-1.0)).collect();
        assert_eq!(back, exact.concat());
        let most = exact[1].iter().zip(turn(0.3)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(most <= 0.5 / 32767.0 + 1e-7, "{most}");
        // The planted extreme: one part beside the lattice.
        assert_eq!(channel(vec![exact[0], turn(0.3)]).shorts(), None);
        let moved = Channel { values: KeyValues::Translation(vec![[0.0; 3]]), ..channel(exact) };
        assert_eq!(moved.shorts(), None);
    }
}
