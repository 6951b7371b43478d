//! Accessor reading (glTF 2.0, 3.6.2): strides, normalised integers, sparse values, all checked against the bytes.
//!
//! Nothing is allocated from a count that the bytes do not back; an accessor without bytes (zeros, sparse) is bounded.

use super::document::whole;
use super::{Document, Fault};
use gltf::accessor::Item;
use gltf::json::Accessor;
use gltf::json::accessor::sparse::Sparse;
use gltf::json::accessor::{ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::validation::Checked;

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

/// What an accessor's elements are made of.
struct Layout {
    component: ComponentType,
    normalized: bool,
    /// Components an element.
    width: usize,
    count: usize,
}

impl Document {
    /// The numbers of an accessor, floats or (normalised) integers. `place` names who asks, as in `skins[0].joints`.
    pub fn read_f32s(&self, accessor: usize, place: &str) -> Result<Floats, Fault> {
        let (layout, bytes) = self.dense(accessor, place)?;
        let size = layout.component.size();
        let values = bytes.chunks_exact(size).map(|raw| number(layout.component, raw, layout.normalized)).collect();
        Ok(Floats { width: layout.width, values })
    }

    /// The whole numbers of an integer accessor: indices, joints. Flat, (elements x width).
    pub fn read_indices(&self, accessor: usize, place: &str) -> Result<Vec<u32>, Fault> {
        let (layout, bytes) = self.dense(accessor, place)?;
        if !matches!(layout.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            let what = "must hold unsigned integers (componentType 5121, 5123 or 5125)";
            return Err(Fault::new(format!("accessors[{accessor}].componentType"), what));
        }
        let size = layout.component.size();
        Ok(bytes.chunks_exact(size).map(|raw| unsigned(layout.component, raw)).collect())
    }

    /// How many elements the accessor says it has.
    pub fn accessor_count(&self, accessor: usize, place: &str) -> Result<usize, Fault> {
        Ok(whole(self.typed::<Accessor>("accessors", accessor, place)?.count))
    }

    /// The elements, packed tightly, sparse values put in.
    fn dense(&self, accessor: usize, place: &str) -> Result<(Layout, Vec<u8>), Fault> {
        let json: Accessor = self.typed("accessors", accessor, place)?;
        let place = format!("accessors[{accessor}]");
        let layout = layout(&json, &place)?;
        let element = layout.width * layout.component.size();
        let mut bytes = match json.buffer_view {
            Some(view) => {
                let start = json.byte_offset.map_or(0, whole);
                self.strided(view.value(), start, false, element, layout.count, &place)?
            }
            None if layout.count > MOST_UNBACKED => {
                let what = format!("{} elements without a bufferView: at most {MOST_UNBACKED} are read", layout.count);
                return Err(Fault::new(format!("{place}.count"), what));
            }
            None => vec![0; layout.count * element],
        };
        if let Some(sparse) = &json.sparse {
            self.put_sparse(sparse, &layout, &mut bytes, &format!("{place}.sparse"))?;
        }
        Ok((layout, bytes))
    }

    /// `count` elements of a view without the gaps between them. `packed`: there are none, whatever stride the view gives.
    fn strided(
        &self,
        index: usize,
        start: usize,
        packed: bool,
        element: usize,
        count: usize,
        place: &str,
    ) -> Result<Vec<u8>, Fault> {
        let view: View = self.typed("bufferViews", index, &format!("{place}.bufferView"))?;
        let bytes = self.bytes_of(&view, index)?;
        let stride = view.byte_stride.filter(|_| !packed).map_or(element, |stride| stride.0);
        if stride < element {
            let what = format!("is {stride}, less than an element of {element} bytes");
            return Err(Fault::new(format!("bufferViews[{index}].byteStride"), what));
        }
        let needed = count.checked_sub(1).and_then(|last| last.checked_mul(stride)?.checked_add(element));
        match needed.map_or(Some(0), |needed| needed.checked_add(start)) {
            Some(end) if end <= bytes.len() => {}
            _ => {
                let what = format!(
                    "{count} elements of {element} bytes from {start}, {stride} apart, do not fit bufferViews[{index}] of {} bytes",
                    bytes.len()
                );
                return Err(Fault::new(place, what));
            }
        }
        if count > 0 && stride == element {
            return Ok(bytes[start..start + count * element].to_vec());
        }
        let mut dense = Vec::with_capacity(count * element);
        for at in (0..count).map(|nth| start + nth * stride) {
            dense.extend_from_slice(&bytes[at..at + element]);
        }
        Ok(dense)
    }

    fn put_sparse(&self, sparse: &Sparse, layout: &Layout, bytes: &mut [u8], place: &str) -> Result<(), Fault> {
        let (count, indices, values) = (whole(sparse.count), &sparse.indices, &sparse.values);
        let at = format!("{place}.indices");
        let Checked::Valid(IndexComponentType(component)) = indices.component_type else {
            return Err(Fault::new(format!("{at}.componentType"), "must be 5121, 5123 or 5125"));
        };
        let (view, start) = (indices.buffer_view.value(), whole(indices.byte_offset));
        let indices = self.strided(view, start, true, component.size(), count, &at)?;
        let element = layout.width * layout.component.size();
        let (view, start) = (values.buffer_view.value(), whole(values.byte_offset));
        let values = self.strided(view, start, true, element, count, &format!("{place}.values"))?;
        for (raw, value) in indices.chunks_exact(component.size()).zip(values.chunks_exact(element)) {
            let index = unsigned(component, raw) as usize;
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

fn layout(accessor: &Accessor, place: &str) -> Result<Layout, Fault> {
    let Checked::Valid(kind) = accessor.type_ else {
        return Err(Fault::new(format!("{place}.type"), "must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4"));
    };
    let at = || format!("{place}.componentType");
    let Checked::Valid(GenericComponentType(component)) = accessor.component_type else {
        return Err(Fault::new(at(), "must be 5120, 5121, 5122, 5123, 5125 or 5126"));
    };
    if matches!(kind, Type::Mat2 | Type::Mat3) && component.size() < 4 {
        return Err(Fault::new(at(), "small matrices of small integers are not read"));
    }
    let (width, count) = (kind.multiplicity(), whole(accessor.count));
    Ok(Layout { component, normalized: accessor.normalized, width, count })
}

/// An unsigned integer; the bits of any other.
fn unsigned(component: ComponentType, raw: &[u8]) -> u32 {
    match component {
        ComponentType::I8 | ComponentType::U8 => u8::from_slice(raw).into(),
        ComponentType::I16 | ComponentType::U16 => u16::from_slice(raw).into(),
        ComponentType::U32 | ComponentType::F32 => u32::from_slice(raw),
    }
}

/// A number; a normalised integer divided as glTF 2.0, 3.6.2.2 says: the crate multiplies by the reciprocal, which is off by a bit.
fn number(component: ComponentType, raw: &[u8], normalized: bool) -> f32 {
    let (value, most) = match component {
        ComponentType::F32 => return f32::from_slice(raw),
        ComponentType::I8 => (f32::from(i8::from_slice(raw)), 127.0),
        ComponentType::U8 => (f32::from(u8::from_slice(raw)), 255.0),
        ComponentType::I16 => (f32::from(i16::from_slice(raw)), 32767.0),
        ComponentType::U16 => (f32::from(u16::from_slice(raw)), 65535.0),
        ComponentType::U32 => (u32::from_slice(raw) as f32, 4_294_967_295.0),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}
