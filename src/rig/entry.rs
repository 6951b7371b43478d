//! The entries of a document by the `gltf` crate's types: one mesh, one skin, one accessor at a time.
//!
//! An entry is read alone, and of it only the keys that are used here: a broken name or a clip that nobody asked for makes no rig
//! unreadable, and a fault names its place, as in `meshes[3].primitives[0].indices`.

use super::document::as_index;
use super::{Document, Fault};
use gltf::json;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// Keys of bytes and counts, which 32 bits may not hold; the other numbers are indices and codes.
const SIZES: [&str; 4] = ["byteLength", "byteOffset", "byteStride", "count"];

/// A type of the crate, and what of it is read.
pub trait Entry: DeserializeOwned {
    /// Keys that are read, at any depth of the entry.
    const KEYS: &'static [&'static str];
}

macro_rules! entries {
    ($($kind:ty: $($key:literal)+;)+) => {
        $(impl Entry for $kind {
            const KEYS: &'static [&'static str] = &[$($key),+];
        })+
    };
}

entries! {
    json::Accessor: "bufferView" "byteOffset" "componentType" "count" "indices" "normalized" "sparse" "type" "values";
    json::animation::Channel: "node" "path" "sampler" "target";
    json::animation::Sampler: "input" "interpolation" "output";
    json::Buffer: "byteLength"; // the uri can be the whole buffer: it is not copied
    json::buffer::View: "buffer" "byteLength" "byteOffset" "byteStride";
    json::Image: "bufferView" "uri";
    json::Material: "baseColorFactor" "baseColorTexture" "index" "pbrMetallicRoughness";
    json::Mesh: "JOINTS_0" "NORMAL" "POSITION" "TEXCOORD_0" "WEIGHTS_0" "attributes" "indices" "material" "mode" "primitives";
    json::Node: "children" "mesh" "name" "skin";
    json::Scene: "nodes";
    json::Skin: "inverseBindMatrices" "joints";
    json::Texture: "source";
}

impl Document {
    /// An entry of a top-level array. `place` names who asks for it, as in `nodes[2].mesh`.
    pub fn typed<T: Entry>(&self, list: &str, index: usize, place: &str) -> Result<T, Fault> {
        read(self.entry(list, index, place)?, &format!("{list}[{index}]"))
    }
}

/// An object of the JSON by its type.
pub fn read<T: Entry>(value: &Value, place: &str) -> Result<T, Fault> {
    if !value.is_object() {
        return Err(Fault::new(place, "must be an object"));
    }
    serde_path_to_error::deserialize(tidy("", value, T::KEYS)).map_err(|error| {
        let within = error.path().to_string();
        let place = if within == "." { place.to_owned() } else { format!("{place}.{within}") };
        Fault::new(place, remedy(&error.into_inner().to_string()))
    })
}

/// A copy of what stands under a key, with those keys alone: wrong fields that do no harm are left out, integers written as `3.0` made
/// whole. To the crate `null` is absent and an index of 2^32 is 0: here they are of the wrong type.
fn tidy(key: &str, value: &Value, keys: &[&str]) -> Value {
    match value {
        Value::Null => Value::Bool(false),
        Value::Array(list) if key == "primitives" => list
            .iter()
            .map(|item| if draws(item) { tidy(key, item, keys) } else { json!({ "attributes": {} }) })
            .collect(),
        Value::Array(list) => list.iter().map(|item| tidy(key, item, keys)).collect(),
        Value::Object(fields) => {
            let kept = fields.iter().filter(|(key, value)| keys.contains(&key.as_str()) && !harmless(key, value));
            kept.map(|(key, value)| (key.clone(), tidy(key, value, keys))).collect()
        }
        Value::Number(_) => match as_index(value) {
            Some(index) if SIZES.contains(&key) || u32::try_from(index).is_ok() => index.into(),
            Some(index) => (index as f64).into(),
            None => value.clone(),
        },
        other => other.clone(),
    }
}

/// Whether a primitive has vertices; what has none is drawn by nobody, and may be wrong.
fn draws(primitive: &Value) -> bool {
    primitive.pointer("/attributes/POSITION").and_then(as_index).is_some()
}

/// Whether a field is wrong, and can be taken as absent: names, materials, and what has a default.
fn harmless(key: &str, value: &Value) -> bool {
    match key {
        "name" | "interpolation" => !value.is_string(),
        "material" => as_index(value).is_none_or(|index| u32::try_from(index).is_err()),
        "normalized" => !value.is_boolean(),
        _ => false,
    }
}

/// What serde says, as what would be right.
fn remedy(said: &str) -> String {
    if let Some(field) = said.strip_prefix("missing field `") {
        return format!("has no {}", field.trim_end_matches('`'));
    }
    let wanted = said.rsplit_once(", expected ").map_or(said, |(_, wanted)| wanted);
    match wanted {
        "index into child of root" => "must be a whole number from 0 to 4294967295".into(),
        "u64" | "usize" => "must be a whole number from 0 up".into(),
        "a sequence" => "must be an array".into(),
        "a map" => "must be an object".into(),
        "a string" => "must be a string".into(),
        _ if wanted.starts_with("struct ") => "must be an object".into(),
        _ => match wanted.strip_prefix("any of: ") {
            Some(choices) => format!("must be one of {}", choices.trim_matches(['[', ']'])),
            None => format!("{said}: write it as glTF 2.0 has it, or export the file again"),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gltf::json::{Accessor, Index, Mesh, Node, Skin};

    const WHOLE: &str = "must be a whole number from 0 to 4294967295";

    fn fault<T: Entry>(value: Value) -> String {
        read::<T>(&value, "it[3]").err().map_or_else(|| "no fault".into(), |fault| fault.to_string())
    }

    #[test]
    fn whole_numbers_written_with_a_point_are_whole_and_others_stay() {
        let skin: Skin = read(&json!({ "joints": [3.0, 4, 0.0] }), "skins[0]").expect("a skin");
        assert_eq!(skin.joints.iter().map(Index::value).collect::<Vec<_>>(), [3, 4, 0]);
        let odd = json!({ "joints": [0.5, -1.0, 1e300, { "joints": [2.0] }] });
        let whole = json!({ "joints": [0.5, -1.0, 1e300, { "joints": [2] }] });
        assert_eq!(tidy("", &odd, &["joints"]), whole, "only what is whole, at any depth");
    }

    #[test]
    fn an_index_that_32_bits_do_not_hold_is_not_cut_to_them_and_null_is_not_absent() {
        for wrong in [json!(4_294_967_296_u64), json!(u64::MAX), json!(4_294_967_296.0), json!(null), json!(-1)] {
            assert_eq!(fault::<Node>(json!({ "mesh": wrong })), format!("it[3].mesh: {WHOLE}"), "{wrong}");
        }
        let accessor = json!({ "componentType": 5126, "type": "SCALAR", "count": u64::MAX });
        let accessor: Accessor = read(&accessor, "accessors[0]").expect("an accessor");
        assert_eq!(accessor.count.0, u64::MAX);
    }

    #[test]
    fn what_is_not_read_may_be_wrong() {
        let node =
            json!({ "name": 7, "extras": 1, "extensions": 2, "weights": "x", "camera": -1, "matrix": [], "mesh": 1 });
        let node: Node = read(&node, "nodes[0]").expect("a node");
        assert_eq!((node.name, node.mesh.map(|mesh| mesh.value())), (None, Some(1)));
        let drawn = json!({ "attributes": { "POSITION": 0, "COLOR_0": "x" }, "material": -1, "targets": 3 });
        let mesh = json!({ "primitives": [7, { "attributes": { "NORMAL": -1 } }, drawn], "name": [] });
        let mesh: Mesh = read(&mesh, "meshes[0]").expect("a mesh");
        assert_eq!(mesh.primitives.iter().map(|it| it.attributes.len()).collect::<Vec<_>>(), [0, 0, 1]);
        assert!(mesh.primitives[2].material.is_none());
    }

    #[test]
    fn a_fault_says_its_place_and_what_would_be_right() {
        assert_eq!(fault::<Node>(json!([1])), "it[3]: must be an object");
        assert_eq!(fault::<Node>(json!({ "children": 1 })), "it[3].children: must be an array");
        assert_eq!(fault::<Node>(json!({ "children": [0, 0.5] })), format!("it[3].children[1]: {WHOLE}"));
        assert_eq!(fault::<Skin>(json!({})), "it[3]: has no joints");
        let mesh = |primitive: Value| fault::<Mesh>(json!({ "primitives": [3, primitive] }));
        let place = "it[3].primitives[1]";
        let normal = mesh(json!({ "attributes": { "POSITION": 0, "NORMAL": -1 } }));
        assert_eq!(normal, format!("{place}.attributes.NORMAL: {WHOLE}"));
        let mode = mesh(json!({ "attributes": { "POSITION": 0 }, "mode": "x" }));
        assert_eq!(mode, format!("{place}.mode: must be one of 0, 1, 2, 3, 4, 5, 6"));
        let accessor =
            |count: Value| fault::<Accessor>(json!({ "componentType": 5126, "type": "VEC3", "count": count }));
        assert_eq!(accessor(json!(-1)), "it[3].count: must be a whole number from 0 up");
        assert_eq!(accessor(json!(2.0)), "no fault");
        let sparse = json!({ "componentType": 5126, "type": "VEC3", "count": 1, "sparse": 3 });
        assert_eq!(fault::<Accessor>(sparse), "it[3].sparse: must be an object");
    }
}
