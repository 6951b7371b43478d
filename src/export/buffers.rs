//! All buffers of a document as the one buffer of a GLB: the source's bytes first, in order, then whatever is appended.
//!
//! Buffer views are re-based where a document had several buffers, also inside extensions (`EXT_meshopt_compression` names a
//! buffer of its own). A buffer that has neither bytes nor uri (the fallback of that extension) stays a buffer.

use super::ExportError;
use crate::rig::Document;
use base64::Engine;
use serde_json::{Map, Value, json};

/// The buffer in the making.
#[derive(Clone, Debug, Default)]
pub(super) struct Joined {
    /// What goes into the BIN chunk.
    pub(super) bytes: Vec<u8>,
}

impl Joined {
    /// Joins the buffers of `document` and re-bases the views in `root`, its copy.
    pub(super) fn new(document: &Document, root: &mut Map<String, Value>) -> Result<Joined, ExportError> {
        let sources = root.get("buffers").and_then(Value::as_array).cloned().unwrap_or_default();
        let mut bytes = Vec::new();
        let mut places: Vec<(usize, usize)> = Vec::with_capacity(sources.len()); // new buffer, offset
        let mut first = None;
        let mut rest = Vec::new();
        for (index, source) in sources.into_iter().enumerate() {
            let data = document.buffers.get(index).map_or(&[][..], Vec::as_slice);
            let own = source.get("uri").is_some() || (index == 0 && document.glb_buffer);
            if !own && is_fallback(&source) {
                rest.push(source);
                places.push((rest.len(), 0));
                continue;
            }
            let length = source.get("byteLength").and_then(Value::as_u64).unwrap_or_default();
            if (data.len() as u64) < length {
                let reason = format!("buffers[{index}] has {} of its {length} bytes", data.len());
                return Err(ExportError::Document { reason });
            }
            pad(&mut bytes);
            places.push((0, bytes.len()));
            bytes.extend_from_slice(data);
            first.get_or_insert(source);
        }
        let mut buffer = first.unwrap_or_else(|| json!({ "byteLength": 0 }));
        if let Some(fields) = buffer.as_object_mut() {
            fields.shift_remove("uri");
        }
        rest.insert(0, buffer);
        root.insert("buffers".into(), Value::Array(rest));
        if places.iter().any(|place| *place != (0, 0)) {
            for view in root.get_mut("bufferViews").and_then(Value::as_array_mut).into_iter().flatten() {
                rebase(view, &places)?;
                let extensions = view.get_mut("extensions").and_then(Value::as_object_mut).into_iter();
                for extension in extensions.flat_map(Map::values_mut) {
                    rebase(extension, &places)?;
                }
            }
        }
        Ok(Joined { bytes })
    }

    /// Appends bytes at a multiple of four: their place.
    pub(super) fn append(&mut self, data: &[u8]) -> usize {
        pad(&mut self.bytes);
        let at = self.bytes.len();
        self.bytes.extend_from_slice(data);
        at
    }

    /// Moves images that lie in files beside the document, or in `data:` uris, into the buffer.
    pub(super) fn embed_images(&mut self, document: &Document, root: &mut Map<String, Value>) {
        let mut views = Vec::new();
        let present = root.get("bufferViews").and_then(Value::as_array).map_or(0, Vec::len);
        for (index, image) in root.get_mut("images").and_then(Value::as_array_mut).into_iter().flatten().enumerate() {
            let Some(fields) = image.as_object_mut() else { continue };
            let Some(uri) = fields.get("uri").and_then(Value::as_str) else { continue };
            let outer = document.image_files.get(index).cloned().flatten();
            let Some(data) = outer.or_else(|| data_uri(uri)) else { continue };
            let kind = mime_type(&data)
                .or_else(|| fields.get("mimeType").and_then(Value::as_str))
                .unwrap_or_else(|| mime_type_of(uri))
                .to_owned();
            views.push(json!({ "buffer": 0, "byteOffset": self.append(&data), "byteLength": data.len() }));
            fields.shift_remove("uri");
            fields.insert("mimeType".into(), kind.into());
            fields.insert("bufferView".into(), (present + views.len() - 1).into());
        }
        super::glb::list(root, "bufferViews").extend(views);
        if super::glb::list(root, "bufferViews").is_empty() {
            root.shift_remove("bufferViews");
        }
    }
}

fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

fn is_fallback(buffer: &Value) -> bool {
    let extensions = buffer.get("extensions").and_then(Value::as_object);
    extensions.is_some_and(|extensions| extensions.values().any(|extension| extension["fallback"] == true))
}

fn rebase(holder: &mut Value, places: &[(usize, usize)]) -> Result<(), ExportError> {
    let Some(fields) = holder.as_object_mut() else { return Ok(()) };
    let Some(buffer) = fields.get("buffer").and_then(Value::as_u64) else { return Ok(()) };
    let missing =
        || ExportError::Document { reason: format!("a buffer view names buffer {buffer} of {}", places.len()) };
    let (to, offset) = *usize::try_from(buffer).ok().and_then(|buffer| places.get(buffer)).ok_or_else(missing)?;
    fields.insert("buffer".into(), to.into());
    if offset > 0 {
        let before = fields.get("byteOffset").and_then(Value::as_u64).unwrap_or_default();
        fields.insert("byteOffset".into(), (before + offset as u64).into());
    }
    Ok(())
}

/// The bytes of a base64 `data:` uri.
fn data_uri(uri: &str) -> Option<Vec<u8>> {
    let (head, data) = uri.strip_prefix("data:")?.split_once(',')?;
    head.ends_with(";base64").then(|| base64::engine::general_purpose::STANDARD.decode(data.trim()).ok()).flatten()
}

/// What the first bytes say.
fn mime_type(data: &[u8]) -> Option<&'static str> {
    match data {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, ..] => Some("image/jpeg"),
        [0xab, b'K', b'T', b'X', b' ', b'2', ..] => Some("image/ktx2"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        _ => None,
    }
}

fn mime_type_of(uri: &str) -> &'static str {
    let uri = uri.to_ascii_lowercase();
    if uri.ends_with(".jpg") || uri.ends_with(".jpeg") { "image/jpeg" } else { "image/png" }
}
