//! Images of the base colours, decoded for pictures. Best effort: what cannot be read stays `None`, never an error.

use super::document::{Resolve, fetch};
use super::{Document, MeshPart};
use gltf::json::Image;
use image::{ImageReader, RgbaImage};
use std::io::Cursor;

/// Pixels decoded at most, over all images: 128 MiB.
const MOST_PIXELS: u64 = 32 << 20;
/// Pixels along an edge.
const LONGEST_EDGE: u32 = 8192;

/// Decodes the images that the parts use.
pub fn decode(document: &mut Document, parts: &[MeshPart], resolve: &Resolve) {
    let mut used: Vec<usize> = parts.iter().filter_map(|part| part.base_texture).collect();
    used.sort_unstable();
    used.dedup();
    let mut left = MOST_PIXELS;
    for index in used {
        let decoded = bytes(document, index, resolve).and_then(|bytes| pixels(&bytes, left));
        left -= decoded.as_ref().map_or(0, |image| u64::from(image.width()) * u64::from(image.height())).min(left);
        document.images[index] = decoded;
    }
}

/// The files of images with a uri of their own, undecoded, by image index: an exported GLB takes them in.
pub fn files(document: &Document, resolve: &Resolve) -> Vec<Option<Vec<u8>>> {
    let uri = |index: usize| document.typed::<Image>("images", index, "images").ok()?.uri;
    let outer = |uri: &String| !uri.starts_with("data:");
    (0..document.list("images").len()).map(|index| fetch(&uri(index).filter(outer)?, resolve).ok()).collect()
}

fn bytes(document: &Document, index: usize, resolve: &Resolve) -> Option<Vec<u8>> {
    let image: Image = document.typed("images", index, "images").ok()?;
    match image.buffer_view {
        Some(view) => document.view(view.value(), "images").ok().map(<[u8]>::to_vec),
        None => fetch(&image.uri?, resolve).ok(),
    }
}

fn pixels(bytes: &[u8], left: u64) -> Option<RgbaImage> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok();
    let (width, height) = reader()?.into_dimensions().ok()?;
    if width > LONGEST_EDGE || height > LONGEST_EDGE || u64::from(width) * u64::from(height) > left {
        return None;
    }
    let mut reader = reader()?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(LONGEST_EDGE);
    limits.max_image_height = Some(LONGEST_EDGE);
    limits.max_alloc = Some(256 << 20);
    reader.limits(limits);
    Some(reader.decode().ok()?.into_rgba8())
}
