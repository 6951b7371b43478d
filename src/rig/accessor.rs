//! Accessor reading (glTF 2.0, 3.6.2): strides, normalised integers, sparse values, all checked against the bytes.
//!
//! Nothing is allocated from a count that the bytes do not back; an accessor without bytes (zeros, sparse) is bounded.

use super::document::{index_or, optional_index, required_index};
use super::{Document, Fault};
use serde_json::Value;

/// Elements of an accessor that no bytes back.
const MOST_UNBACKED: usize = 2_000_000;

/// Numbers of an accessor.
#[derive(Clone, Debug, PartialEq)]
pub struct Floats {
    /// Components an element: 1 SCALAR, 3 VEC3, 16 MAT4.
    pub width: usize,
    /// (elements x width), normalised integers as 0..1 or -1..1.
    pub values: Vec<f32>,
}

impl Floats {
    /// How many elements.
    pub fn len(&self) -> usize {
        self.values.len() / self.width
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// One element; empty beyond the last.
    pub fn element(&self, index: usize) -> &[f32] {
        self.values.get(index * self.width..(index + 1) * self.width).unwrap_or(&[])
    }
}

/// Layout of an accessor.
struct Layout {
    component: Component,
    normalized: bool,
    width: usize,
    count: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Document {
    /// The numbers of an accessor, floats or (normalised) integers. `place` names who asks, as in `skins[0].joints`.
    pub fn read_f32s(&self, accessor: usize, place: &str) -> Result<Floats, Fault> {
        let (layout, bytes) = self.dense(accessor, place)?;
        let size = layout.component.size();
        let values = bytes.chunks_exact(size).map(|raw| layout.component.float(raw, layout.normalized)).collect();
        Ok(Floats { width: layout.width, values })
    }

    /// The whole numbers of an integer accessor: indices, joints. Flat, (elements x width).
    pub fn read_indices(&self, accessor: usize, place: &str) -> Result<Vec<u32>, Fault> {
        let (layout, bytes) = self.dense(accessor, place)?;
        if !matches!(layout.component, Component::U8 | Component::U16 | Component::U32) {
            let what = "must hold unsigned integers (componentType 5121, 5123 or 5125)";
            return Err(Fault::new(format!("accessors[{accessor}].componentType"), what));
        }
        let size = layout.component.size();
        Ok(bytes.chunks_exact(size).map(|raw| layout.component.whole(raw)).collect())
    }

    /// How many elements the accessor says it has.
    pub fn accessor_count(&self, accessor: usize, place: &str) -> Result<usize, Fault> {
        required_index(self.entry("accessors", accessor, place)?, "count", &format!("accessors[{accessor}]"))
    }

    /// The elements, packed tightly, sparse values put in.
    fn dense(&self, accessor: usize, place: &str) -> Result<(Layout, Vec<u8>), Fault> {
        let json = self.entry("accessors", accessor, place)?;
        let place = format!("accessors[{accessor}]");
        let layout = layout(json, &place)?;
        let element = layout.width * layout.component.size();
        let mut bytes = match optional_index(json, "bufferView", &place)? {
            Some(view) => {
                let start = index_or(json, "byteOffset", 0, &place)?;
                let at = format!("bufferViews[{view}]");
                let entry = self.entry("bufferViews", view, &format!("{place}.bufferView"))?;
                let stride = optional_index(entry, "byteStride", &at)?;
                self.strided(view, start, stride, element, layout.count, &place)?
            }
            None if layout.count > MOST_UNBACKED => {
                let what = format!("{} elements without a bufferView: at most {MOST_UNBACKED} are read", layout.count);
                return Err(Fault::new(format!("{place}.count"), what));
            }
            None => vec![0; layout.count * element],
        };
        if let Some(sparse) = json.get("sparse") {
            self.put_sparse(sparse, &layout, &mut bytes, &format!("{place}.sparse"))?;
        }
        Ok((layout, bytes))
    }

    fn strided(
        &self,
        view: usize,
        start: usize,
        stride: Option<usize>,
        element: usize,
        count: usize,
        place: &str,
    ) -> Result<Vec<u8>, Fault> {
        let bytes = self.view(view, &format!("{place}.bufferView"))?;
        let stride = stride.unwrap_or(element);
        if stride < element {
            let what = format!("is {stride}, less than an element of {element} bytes");
            return Err(Fault::new(format!("bufferViews[{view}].byteStride"), what));
        }
        let needed = count.checked_sub(1).and_then(|last| last.checked_mul(stride)?.checked_add(element));
        match needed.map_or(Some(0), |needed| needed.checked_add(start)) {
            Some(end) if end <= bytes.len() => {}
            _ => {
                let what = format!(
                    "{count} elements of {element} bytes from {start}, {stride} apart, do not fit bufferViews[{view}] of {} bytes",
                    bytes.len()
                );
                return Err(Fault::new(place, what));
            }
        }
        if count > 0 && stride == element {
            return Ok(bytes[start..start + count * element].to_vec());
        }
        let mut packed = Vec::with_capacity(count * element);
        for index in 0..count {
            let at = start + index * stride;
            packed.extend_from_slice(&bytes[at..at + element]);
        }
        Ok(packed)
    }

    fn put_sparse(&self, sparse: &Value, layout: &Layout, bytes: &mut [u8], place: &str) -> Result<(), Fault> {
        let count = required_index(sparse, "count", place)?;
        let part = |name: &str| sparse.get(name).ok_or_else(|| Fault::new(place, format!("has no {name}")));
        let (indices, values) = (part("indices")?, part("values")?);
        let at = format!("{place}.indices");
        let component = component(required_index(indices, "componentType", &at)?, &at)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(Fault::new(format!("{at}.componentType"), "must be 5121, 5123 or 5125"));
        }
        let start = index_or(indices, "byteOffset", 0, &at)?;
        let view = required_index(indices, "bufferView", &at)?;
        let indices = self.strided(view, start, None, component.size(), count, &at)?;
        let at = format!("{place}.values");
        let element = layout.width * layout.component.size();
        let start = index_or(values, "byteOffset", 0, &at)?;
        let view = required_index(values, "bufferView", &at)?;
        let values = self.strided(view, start, None, element, count, &at)?;
        for (raw, value) in indices.chunks_exact(component.size()).zip(values.chunks_exact(element)) {
            let index = component.whole(raw) as usize;
            match bytes.get_mut(index * element..(index + 1) * element) {
                Some(target) => target.copy_from_slice(value),
                None => {
                    let what = format!("{index} lies beyond the accessor's {} elements", layout.count);
                    return Err(Fault::new(format!("{place}.indices"), what));
                }
            }
        }
        Ok(())
    }
}

fn layout(json: &Value, place: &str) -> Result<Layout, Fault> {
    let kind = json.get("type").and_then(Value::as_str).unwrap_or("");
    let width = match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return Err(Fault::new(format!("{place}.type"), "must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4")),
    };
    let component = component(required_index(json, "componentType", place)?, place)?;
    if matches!(kind, "MAT2" | "MAT3") && component.size() < 4 {
        return Err(Fault::new(format!("{place}.componentType"), "small matrices of small integers are not read"));
    }
    Ok(Layout {
        component,
        normalized: json.get("normalized").and_then(Value::as_bool).unwrap_or(false),
        width,
        count: required_index(json, "count", place)?,
    })
}

fn component(code: usize, place: &str) -> Result<Component, Fault> {
    Ok(match code {
        5120 => Component::I8,
        5121 => Component::U8,
        5122 => Component::I16,
        5123 => Component::U16,
        5125 => Component::U32,
        5126 => Component::F32,
        _ => {
            let what = format!("is {code}: must be 5120, 5121, 5122, 5123, 5125 or 5126");
            return Err(Fault::new(format!("{place}.componentType"), what));
        }
    })
}

impl Component {
    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    fn whole(self, raw: &[u8]) -> u32 {
        raw.iter().rev().fold(0, |sum, byte| (sum << 8) | u32::from(*byte))
    }

    fn float(self, raw: &[u8], normalized: bool) -> f32 {
        let whole = self.whole(raw);
        let (value, most) = match self {
            Component::F32 => return f32::from_bits(whole),
            Component::I8 => (f32::from(whole as u8 as i8), 127.0),
            Component::U8 => (whole as f32, 255.0),
            Component::I16 => (f32::from(whole as u16 as i16), 32767.0),
            Component::U16 => (whole as f32, 65535.0),
            Component::U32 => (whole as f32, 4_294_967_295.0),
        };
        if normalized { (value / most).max(-1.0) } else { value }
    }
}
