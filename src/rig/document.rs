//! A glTF file as it stands: container, JSON, buffers. Everything in it is checked before it is believed.
//!
//! glTF 2.0 sections 3.6 (buffers), 4 (GLB). Reads .glb, .gltf and .vrm bytes; files beside it come through a function,
//! so `parse` touches no disk; `read_file` is the folder's one way to it. Accessors are read in `accessor`; images are decoded in `images`.
//! Leaves out meshopt and Draco compression: such a file is refused by the extension's name.
//!
//! Every entry (mesh, skin, accessor, ...) is read by the `gltf` crate's types, one at a time: see `entry`. The file as a whole is not
//! read by the crate, and these stay by hand (`tests/gltf_crate.rs` holds a file for each):
//! - the JSON is kept as it stands, because a bake appends to it: the crate's `Root` drops every key that it does not know;
//! - one broken clip or material, a required extension such as VRM's, an index written `3.0`: the crate refuses the file;
//! - an index beyond the end of its list, a stride shorter than its element: the crate panics; bytes that are missing: it reads nothing,
//!   and does not say where;
//! - normalised integers and the transforms of nodes: the crate's are off in the last bit, or rounded to f32, and would change clips;
//! - channels without a node (`KHR_animation_pointer`), chunks of another kind in a GLB: the crate refuses them;
//! - what it has no types for: VRM's humanoids, and what this program writes into `extras`.

use super::{Document, Fault, RigError};
use base64::Engine;
use gltf::json::Buffer;
use gltf::json::buffer::View;
use gltf::json::validation::USize64;
use serde_json::Value;

/// Reads a file that the document points to: the decoded relative path, as in `textures/skin.png`.
pub type Resolve<'a> = dyn Fn(&str) -> std::io::Result<Vec<u8>> + 'a;

/// Values of the JSON that are read at most: some 0.5 GiB of memory.
const MOST_VALUES: usize = 4_000_000;
/// Bytes of a file that are read at most.
const MOST_BYTES: u64 = 1 << 30;
/// Nodes, meshes, accessors and so on of a document.
const MOST_ENTRIES: usize = 200_000;
/// Extensions that change how geometry is decoded, with the way out.
const UNREADABLE: [(&str, &str); 4] = [
    ("EXT_meshopt_compression", "decompress it, as with `gltf-transform copy in.glb out.glb`"),
    ("KHR_meshopt_compression", "decompress it, as with `gltf-transform copy in.glb out.glb`"),
    ("KHR_draco_mesh_compression", "decompress it, as with `gltf-transform copy in.glb out.glb`"),
    ("MPEG_buffer_circular", "export it with plain buffers"),
];
/// Required extensions that a rig may have: they leave positions, joints and weights as the core says.
const HARMLESS: [&str; 5] = ["KHR_", "VRM", "EXT_", "VRMC_", "MSFT_"];

impl Document {
    /// The document in those bytes. `file` is its name in messages.
    pub fn parse(file: &str, bytes: &[u8], resolve: &Resolve) -> Result<Document, RigError> {
        let (json_bytes, binary) = split(file, bytes)?;
        let values = json_bytes.iter().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count();
        if values > MOST_VALUES && count_values(json_bytes) > MOST_VALUES {
            return Err(Fault::new("JSON", format!("over {MOST_VALUES} values: too large for a rig")).in_file(file));
        }
        let json: Value = serde_json::from_slice(json_bytes)
            .map_err(|error| Fault::new("JSON", format!("{error}: not valid JSON")).in_file(file))?;
        check_head(file, &json)?;
        let mut document =
            Document { json, buffers: Vec::new(), glb_buffer: false, images: Vec::new(), image_files: Vec::new() };
        document.resolve_buffers(binary, resolve).map_err(|fault| fault.in_file(file))?;
        document.images = vec![None; document.list("images").len()];
        document.image_files = super::images::files(&document, resolve);
        Ok(document)
    }

    /// A top-level array of the JSON; empty where there is none.
    pub fn list(&self, name: &str) -> &[Value] {
        self.json.get(name).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// An entry of a top-level array.
    pub fn entry(&self, name: &str, index: usize, place: &str) -> Result<&Value, Fault> {
        let list = self.list(name);
        list.get(index).ok_or_else(|| Fault::new(place, format!("is {index}, but there are {} {name}", list.len())))
    }

    /// The bytes of a buffer view: exactly its `byteLength`.
    pub fn view(&self, index: usize, place: &str) -> Result<&[u8], Fault> {
        self.bytes_of(&self.typed("bufferViews", index, place)?, index)
    }

    /// The bytes of that buffer view.
    pub(super) fn bytes_of(&self, view: &View, index: usize) -> Result<&[u8], Fault> {
        let (place, buffer) = (format!("bufferViews[{index}]"), view.buffer.value());
        let bytes = self.buffers.get(buffer).ok_or_else(|| {
            Fault::new(format!("{place}.buffer"), format!("is {buffer}, but there are {} buffers", self.buffers.len()))
        })?;
        let declared = self.typed::<Buffer>("buffers", buffer, &place);
        let size = declared.map_or(bytes.len(), |declared| whole(declared.byte_length).min(bytes.len()));
        let (start, length) = (view.byte_offset.map_or(0, whole), whole(view.byte_length));
        match start.checked_add(length) {
            Some(end) if end <= size => Ok(&bytes[start..end]),
            _ => Err(Fault::new(
                place,
                format!("bytes {start} to {start} + {length} lie outside buffers[{buffer}], which has {size}"),
            )),
        }
    }

    fn resolve_buffers(&mut self, binary: Option<&[u8]>, resolve: &Resolve) -> Result<(), Fault> {
        let mut buffers = Vec::new();
        for (index, buffer) in self.list("buffers").iter().enumerate() {
            let place = format!("buffers[{index}]");
            if buffer.get("byteLength").is_none() {
                return Err(Fault::new(place, "has no byteLength")); // 0 to the crate
            }
            let length = whole(self.typed::<Buffer>("buffers", index, &place)?.byte_length);
            let bytes = match (buffer.get("uri"), binary) {
                (Some(uri), _) => {
                    let uri = uri.as_str().ok_or_else(|| Fault::new(format!("{place}.uri"), "must be a string"))?;
                    fetch(uri, resolve).map_err(|what| Fault::new(format!("{place}.uri"), what))?
                }
                (None, Some(binary)) if index == 0 => binary.to_vec(),
                (None, _) => return Err(Fault::new(place, "has no uri and the file has no BIN chunk for it")),
            };
            if bytes.len() < length {
                let what = format!("should have {length} bytes, but {} are there: the file is cut short", bytes.len());
                return Err(Fault::new(place, what));
            }
            buffers.push(bytes);
        }
        self.glb_buffer =
            binary.is_some() && self.list("buffers").first().is_some_and(|first| first.get("uri").is_none());
        self.buffers = buffers;
        Ok(())
    }
}

/// A plain file of bounded size: no device, no pipe.
pub fn read_file(path: &std::path::Path) -> std::io::Result<Vec<u8>> {
    let about = std::fs::metadata(path)?;
    if !about.is_file() {
        return Err(std::io::Error::other("is not a file"));
    }
    if about.len() > MOST_BYTES {
        return Err(std::io::Error::other("is over 1 GiB: too large for a rig"));
    }
    std::fs::read(path)
}

/// The bytes of a uri: a `data:` one, or a relative path for `resolve`.
pub fn fetch(uri: &str, resolve: &Resolve) -> Result<Vec<u8>, String> {
    let shown: String = uri.chars().take(60).collect();
    if let Some(data) = uri.strip_prefix("data:") {
        let (head, body) = data.split_once(',').ok_or("is a data uri without a comma")?;
        if !head.ends_with(";base64") {
            return Ok(percent_encoding::percent_decode_str(body).collect());
        }
        let engine = base64::engine::GeneralPurpose::new(
            &base64::alphabet::STANDARD,
            base64::engine::GeneralPurposeConfig::new()
                .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent)
                .with_decode_allow_trailing_bits(true),
        );
        return engine.decode(body).map_err(|error| format!("is no valid base64: {error}"));
    }
    let path = percent_encoding::percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("\"{shown}\" is not UTF-8 when decoded"))?;
    let scheme = path.split('/').next().is_some_and(|first| first.contains(':'));
    if scheme || path.starts_with('/') || path.starts_with('\\') || path.contains('\0') {
        return Err(format!("\"{shown}\" is not a relative path: put the file beside this one"));
    }
    resolve(&path).map_err(|error| format!("\"{shown}\" cannot be read: {error}"))
}

/// A JSON number as an index or count; also `3.0`, as some writers have it.
pub fn as_index(value: &Value) -> Option<usize> {
    let whole = |number: f64| (number >= 0.0 && number.fract() == 0.0 && number < 9e15).then_some(number as usize);
    value.as_u64().and_then(|number| usize::try_from(number).ok()).or_else(|| value.as_f64().and_then(whole))
}

/// A count or offset of the crate's.
pub fn whole(size: USize64) -> usize {
    usize::try_from(size.0).unwrap_or(usize::MAX)
}

/// The JSON and, in a GLB, the BIN chunk.
fn split<'a>(file: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), RigError> {
    if bytes.is_empty() {
        return Err(wrong_kind(file, "is empty", "give a .glb, .gltf, .vrm or .fbx file"));
    }
    if !bytes.starts_with(b"glTF") {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return match text.iter().find(|byte| !byte.is_ascii_whitespace()) {
            Some(b'{') => Ok((text, None)),
            _ => Err(refuse_kind(file, bytes)),
        };
    }
    let broken = |place: &str, what: String| Fault::new(place, what).in_file(file);
    let word = |at: usize| bytes.get(at..at + 4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(broken("GLB header", format!("version {version}: only 2 can be read"))),
        None => return Err(broken("GLB header", "is cut short".into())),
    }
    let total = word(8).unwrap_or(0) as usize;
    if total > bytes.len() {
        let what = format!("says {total} bytes, but {} are there: the file is cut short", bytes.len());
        return Err(broken("GLB header", what));
    }
    let (mut at, mut json, mut binary) = (12, None, None);
    while at + 8 <= total {
        let (length, kind) = (word(at).unwrap_or(0) as usize, word(at + 4).unwrap_or(0));
        let body = at + 8..(at + 8).saturating_add(length);
        let Some(chunk) = bytes.get(body.clone()).filter(|_| body.end <= total) else {
            return Err(broken("GLB chunk", format!("at byte {at} says {length} bytes, past the end of the file")));
        };
        match kind {
            0x4E4F_534A if json.is_none() => json = Some(chunk),
            0x004E_4942 if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        // Chunks are padded to four; some writers leave the padding out of the length.
        at = body.end;
    }
    Ok((json.ok_or_else(|| broken("GLB", "has no JSON chunk".into()))?, binary))
}

fn wrong_kind(file: &str, what: impl Into<String>, remedy: &str) -> RigError {
    RigError::WrongKind { file: file.into(), what: what.into(), remedy: remedy.into() }
}

/// What a file that is neither GLB nor JSON seems to be.
fn refuse_kind(file: &str, bytes: &[u8]) -> RigError {
    let lower = file.to_lowercase();
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(64)]).into_owned();
    if head.starts_with("Kaydara FBX") || head.contains("FBX") || lower.ends_with(".fbx") {
        return wrong_kind(file, "is an FBX file by its content, not what its name says", "let its name end in .fbx");
    }
    if head.trim_start().starts_with("HIERARCHY") || lower.ends_with(".bvh") {
        return wrong_kind(file, "is a BVH motion, not a rig", "give the .glb, .gltf, .vrm or .fbx of the character");
    }
    wrong_kind(file, "is not a glTF file", "give a .glb, .gltf, .vrm or .fbx file")
}

fn check_head(file: &str, json: &Value) -> Result<(), RigError> {
    if !json.is_object() {
        return Err(Fault::new("JSON", "must be an object").in_file(file));
    }
    let asset = json.get("asset").and_then(|asset| asset.get("version")).and_then(Value::as_str);
    match asset {
        Some(version) if version.starts_with("2.") => {}
        Some(version) => {
            let shown: String = version.chars().take(20).collect();
            return Err(Fault::new("asset.version", format!("\"{shown}\": only glTF 2.0 can be read")).in_file(file));
        }
        None => return Err(Fault::new("asset.version", "is missing: this is not a glTF 2.0 file").in_file(file)),
    }
    let lists = ["nodes", "meshes", "skins", "accessors", "bufferViews", "buffers", "images", "textures", "materials"];
    for name in lists {
        let Some(list) = json.get(name) else { continue };
        let list = list.as_array().ok_or_else(|| Fault::new(name, "must be an array").in_file(file))?;
        if list.len() > MOST_ENTRIES {
            let what = format!("has {} entries: over {MOST_ENTRIES} is too large for a rig", list.len());
            return Err(Fault::new(name, what).in_file(file));
        }
    }
    check_extensions(file, json)
}

fn check_extensions(file: &str, json: &Value) -> Result<(), RigError> {
    let Some(required) = json.get("extensionsRequired") else { return Ok(()) };
    let list = required
        .as_array()
        .ok_or_else(|| Fault::new("extensionsRequired", "must be an array of names").in_file(file))?;
    for name in list.iter().filter_map(Value::as_str) {
        let refuse = |remedy: &str| RigError::Extension {
            file: file.into(),
            extension: name.chars().take(80).collect(),
            remedy: remedy.into(),
        };
        if let Some((_, remedy)) = UNREADABLE.iter().find(|(known, _)| *known == name) {
            return Err(refuse(remedy));
        }
        if !HARMLESS.iter().any(|prefix| name.starts_with(prefix)) {
            return Err(refuse("export the file without it"));
        }
    }
    Ok(())
}

/// Commas and brackets outside strings: an upper bound of the values.
fn count_values(json: &[u8]) -> usize {
    let (mut count, mut string, mut escaped) = (0, false, false);
    for byte in json {
        match (string, byte) {
            (true, _) if escaped => escaped = false,
            (true, b'\\') => escaped = true,
            (_, b'"') => string = !string,
            (false, b',' | b'[' | b'{') => count += 1,
            _ => {}
        }
    }
    count
}
