//! What a clip holds still because another animation of the file moves it.
//!
//! A player that goes from one animation to the next leaves what the next does not animate where the last one left it (Babylon.js,
//! Blender, Bevy). So every property that any animation of the file drives has a channel in ours too: its value at rest, as the
//! document's nodes have it. Document units.

use crate::model::{Clip, ClipReport, Target};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// A property at rest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Held {
    pub(super) node: usize,
    pub(super) path: &'static str,
    pub(super) kind: &'static str, // of its accessor
    pub(super) values: Vec<f32>,   // of one moment
}

impl Held {
    /// Elements of the accessor in one moment: a mesh has a weight for each of its targets.
    pub(super) fn count(&self) -> usize {
        if self.path == "weights" { self.values.len() } else { 1 }
    }
}

/// Every property that an animation of the document, or one of the clips, drives. Without those of nodes that have a matrix, which
/// nothing can animate.
pub(super) fn moved(
    clips: &[(Clip, ClipReport)],
    helpers: &BTreeMap<Target, usize>,
    root: &Map<String, Value>,
) -> Vec<Held> {
    let ours = clips.iter().flat_map(|(clip, _)| &clip.channels).map(|channel| {
        let node = if let Target::Node(node) = channel.target { node } else { helpers[&channel.target] };
        (node, channel.values.path())
    });
    let items = |value: Option<&'_ Value>| value.and_then(Value::as_array).cloned().unwrap_or_default();
    let animations = items(root.get("animations"));
    let theirs = animations.iter().flat_map(|animation| items(animation.get("channels"))).filter_map(|channel| {
        let target = channel.get("target")?;
        let node = usize::try_from(target.get("node")?.as_u64()?).ok()?;
        let path = target.get("path")?.as_str()?;
        Some((node, ["translation", "rotation", "scale", "weights"].into_iter().find(|known| *known == path)?))
    });
    let all: BTreeSet<(usize, &'static str)> = ours.chain(theirs).collect();
    all.into_iter().filter_map(|(node, path)| held(root, node, path)).collect()
}

/// The value of a node's property as the document has it.
fn held(root: &Map<String, Value>, node: usize, path: &'static str) -> Option<Held> {
    let fields = root.get("nodes")?.get(node)?;
    if fields.get("matrix").is_some() {
        return None;
    }
    let (kind, rest): (_, &[f32]) = match path {
        "translation" => ("VEC3", &[0.0; 3]),
        "scale" => ("VEC3", &[1.0; 3]),
        "rotation" => ("VEC4", &[0.0, 0.0, 0.0, 1.0]),
        _ => ("SCALAR", &[]),
    };
    let numbers = |value: &Value| -> Option<Vec<f32>> {
        value.as_array()?.iter().map(|part| Some(part.as_f64()? as f32)).collect()
    };
    let said = fields.get(path).and_then(numbers);
    let values = if path == "weights" {
        let mesh = root.get("meshes")?.get(usize::try_from(fields.get("mesh")?.as_u64()?).ok()?)?;
        let targets = mesh.pointer("/primitives/0/targets")?.as_array()?.len();
        let weights = said.or_else(|| mesh.get("weights").and_then(numbers)).unwrap_or_default();
        (0..targets).map(|target| weights.get(target).copied().unwrap_or(0.0)).collect()
    } else {
        said.filter(|said| said.len() == rest.len()).unwrap_or_else(|| rest.to_vec())
    };
    let sound = !values.is_empty() && values.iter().all(|value| value.is_finite());
    sound.then_some(Held { node, path, kind, values })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_other_animations_move_is_held_at_rest_and_a_matrix_is_not() {
        let root = json!({
            "nodes": [
                { "translation": [1.0, 2.0, 3.0], "mesh": 0 },
                { "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },
            ],
            "meshes": [{ "primitives": [{ "targets": [{}, {}] }], "weights": [0.25] }],
            "animations": [{ "channels": [
                { "target": { "node": 0, "path": "translation" } },
                { "target": { "node": 0, "path": "rotation" } },
                { "target": { "node": 0, "path": "weights" } },
                { "target": { "node": 0, "path": "weights" } },
                { "target": { "node": 1, "path": "scale" } },
                { "target": { "node": 9, "path": "scale" } },
                { "target": { "path": "pointer" } },
            ] }],
        });
        let found = moved(&[], &BTreeMap::new(), root.as_object().expect("an object"));
        let shown: Vec<(usize, &str, Vec<f32>)> =
            found.iter().map(|held| (held.node, held.path, held.values.clone())).collect();
        let expected = vec![
            (0, "rotation", vec![0.0, 0.0, 0.0, 1.0]),
            (0, "translation", vec![1.0, 2.0, 3.0]),
            (0, "weights", vec![0.25, 0.0]),
        ];
        assert_eq!(shown, expected);
        assert_eq!(found[2].count(), 2, "a weight is an element of its own");
    }
}
