//! Records of a binary FBX file: a name, values, records within. `fbxcel` writes the bytes.

use super::super::ExportError;
use fbxcel::low::FbxVersion;
use fbxcel::low::v7400::ArrayAttributeEncoding::Zlib;
use fbxcel::writer::v7400::binary::{Error, FbxFooter, Writer};
use std::io::Cursor;

/// Arrays of fewer numbers are written plain: compression would make them longer.
const FEWEST_COMPRESSED: usize = 32;
/// The footer of files whose time of creation is the epoch, as `document` says it: the SDK computes the one from the other.
const FOOTER: [u8; 16] =
    [0xfa, 0xbc, 0xab, 0x09, 0xd0, 0xc8, 0xd4, 0x66, 0xb1, 0x76, 0xfb, 0x83, 0x1c, 0xf7, 0x26, 0x7e];

/// A record.
#[derive(Clone, Debug)]
pub struct Element {
    name: &'static str,
    values: Vec<Value>,
    within: Vec<Element>,
}

/// A value of a record.
#[derive(Clone, Debug)]
pub enum Value {
    /// One byte.
    Bool(bool),
    /// Whole number.
    I32(i32),
    /// Object identities and times.
    I64(i64),
    /// Number.
    F64(f64),
    /// UTF-8.
    Text(String),
    /// As they are.
    Bytes(Vec<u8>),
    /// Array of flags.
    I32s(Vec<i32>),
    /// Array of times.
    I64s(Vec<i64>),
    /// Array of key values.
    F32s(Vec<f32>),
    /// A matrix.
    F64s(Vec<f64>),
}

impl From<&str> for Value {
    fn from(text: &str) -> Value {
        Value::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Value {
        Value::Text(text)
    }
}

impl From<i32> for Value {
    fn from(number: i32) -> Value {
        Value::I32(number)
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Value {
        Value::I64(number)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Value {
        Value::F64(number)
    }
}

impl Element {
    /// A record with values.
    pub fn new(name: &'static str, values: Vec<Value>) -> Element {
        Element { name, values, within: Vec::new() }
    }

    /// A record with one value.
    pub fn one(name: &'static str, value: impl Into<Value>) -> Element {
        Element::new(name, vec![value.into()])
    }

    /// The same with records within.
    pub fn with(mut self, within: impl IntoIterator<Item = Element>) -> Element {
        self.within.extend(within);
        self
    }
}

/// A list of properties.
pub fn properties(list: impl IntoIterator<Item = Element>) -> Element {
    Element::new("Properties70", Vec::new()).with(list)
}

/// A property: its name, type, label of the type, flags ("A": it can be animated) and values.
pub fn property(name: &str, kind: &str, label: &str, flags: &str, values: Vec<Value>) -> Element {
    let mut all = vec![name.into(), kind.into(), label.into(), flags.into()];
    all.extend(values);
    Element::new("P", all)
}

/// The bytes of a file of those records.
pub fn file(elements: &[Element]) -> Result<Vec<u8>, ExportError> {
    let failed = |error: Error| ExportError::Document { reason: format!("it cannot be written as FBX: {error}") };
    let mut writer = Writer::new(Cursor::new(Vec::new()), FbxVersion::V7_4).map_err(failed)?;
    for element in elements {
        write(&mut writer, element).map_err(failed)?;
    }
    let footer = FbxFooter { unknown1: Some(&FOOTER), ..FbxFooter::default() };
    Ok(writer.finalize(&footer).map_err(failed)?.into_inner())
}

fn write(writer: &mut Writer<Cursor<Vec<u8>>>, element: &Element) -> Result<(), Error> {
    let mut values = writer.new_node(element.name)?;
    for value in &element.values {
        let packed = |count: usize| (count >= FEWEST_COMPRESSED).then_some(Zlib);
        match value {
            Value::Bool(value) => values.append_bool(*value)?,
            Value::I32(value) => values.append_i32(*value)?,
            Value::I64(value) => values.append_i64(*value)?,
            Value::F64(value) => values.append_f64(*value)?,
            Value::Text(value) => values.append_string_direct(value)?,
            Value::Bytes(value) => values.append_binary_direct(value)?,
            Value::I32s(list) => values.append_arr_i32_from_iter(packed(list.len()), list.iter().copied())?,
            Value::I64s(list) => values.append_arr_i64_from_iter(packed(list.len()), list.iter().copied())?,
            Value::F32s(list) => values.append_arr_f32_from_iter(packed(list.len()), list.iter().copied())?,
            Value::F64s(list) => values.append_arr_f64_from_iter(packed(list.len()), list.iter().copied())?,
        }
    }
    for inner in &element.within {
        write(writer, inner)?;
    }
    writer.close_node()
}
