//! The binary chunk of a glTF document in the making, and the file around both.

use serde_json::{Value, json};

/// The binary chunk as it grows.
#[derive(Default)]
pub struct Buffer {
    /// The chunk.
    pub bytes: Vec<u8>,
    /// The document's buffer views.
    pub views: Vec<Value>,
    /// The document's accessors.
    pub accessors: Vec<Value>,
}

impl Buffer {
    /// Appends floats: the index of their accessor. `bounds`: of rising keys, with the first as the least.
    pub fn push<const N: usize>(&mut self, keys: &[[f32; N]], kind: &str, bounds: bool) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(keys.iter().flatten().flat_map(|number| number.to_le_bytes()));
        let view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        let mut accessor =
            json!({ "bufferView": self.views.len(), "componentType": 5126, "count": keys.len(), "type": kind });
        if bounds {
            accessor["min"] = json!(keys.first().map(<[f32; N]>::as_slice));
            accessor["max"] = json!(keys.last().map(<[f32; N]>::as_slice));
        }
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Appends floats with the least and the most of them, as positions need.
    pub fn positions(&mut self, places: &[[f32; 3]]) -> usize {
        let accessor = self.push(places, "VEC3", false);
        let ends = |pick: fn(f32, f32) -> f32, from: f32| {
            [0, 1, 2].map(|axis| places.iter().map(|place| place[axis]).fold(from, pick))
        };
        self.accessors[accessor]["min"] = json!(ends(f32::min, f32::INFINITY));
        self.accessors[accessor]["max"] = json!(ends(f32::max, f32::NEG_INFINITY));
        accessor
    }

    /// Appends whole numbers: a list of them, or of four each.
    pub fn whole(&mut self, numbers: &[u32], kind: &str) -> usize {
        let start = self.bytes.len();
        let small = kind != "SCALAR" && numbers.iter().all(|number| *number <= u32::from(u16::MAX));
        for number in numbers {
            match small {
                true => self.bytes.extend((*number as u16).to_le_bytes()),
                false => self.bytes.extend(number.to_le_bytes()),
            }
        }
        let count = if kind == "SCALAR" { numbers.len() } else { numbers.len() / 4 };
        let component = if small { 5123 } else { 5125 };
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start }));
        let view = self.views.len() - 1;
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }

    /// Appends a file: the index of its view.
    pub fn file(&mut self, bytes: &[u8]) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() }));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }
}

/// JSON and bytes as a GLB.
pub fn container(document: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = bytes.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let word = |number: usize| u32::try_from(number).unwrap_or(u32::MAX).to_le_bytes();
    let mut out = Vec::with_capacity(28 + json.len() + binary.len());
    out.extend(b"glTF");
    out.extend(word(2));
    out.extend(word(28 + json.len() + binary.len()));
    out.extend(word(json.len()));
    out.extend(b"JSON");
    out.extend(json);
    out.extend(word(binary.len()));
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}
