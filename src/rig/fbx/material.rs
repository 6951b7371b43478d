//! Base colours of an FBX's materials: a factor, and a PNG or JPEG that is in the file or beside it.

use super::Buffer;
use crate::rig::document::Resolve;
use serde_json::{Value, json};
use ufbx::{Material, Scene, Texture};

/// What pictures begin with, and their kinds. Others are left out.
const PICTURES: [(&[u8], &str); 2] = [(b"\x89PNG\r\n\x1a\n", "image/png"), (b"\xff\xd8\xff", "image/jpeg")];

/// The lists of a document.
#[derive(Default)]
pub struct Painted {
    /// One a material of the file, same index.
    pub materials: Vec<Value>,
    /// Of its base colours.
    pub textures: Vec<Value>,
    /// Of the textures, in the buffer.
    pub images: Vec<Value>,
}

/// All materials of a file.
pub fn list(scene: &Scene, resolve: &Resolve, out: &mut Buffer) -> Painted {
    let mut painted = Painted::default();
    let mut seen: Vec<(u32, Option<usize>)> = Vec::new(); // identities of textures that were looked at
    for material in &scene.materials {
        let (colour, texture) = base(material);
        let mut paint = json!({ "baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.9 });
        if let Some(texture) = texture {
            let known = seen.iter().find(|(id, _)| *id == texture.element.element_id).map(|(_, index)| *index);
            let index = known.unwrap_or_else(|| {
                let index = picture(texture, resolve).map(|(bytes, kind)| {
                    painted.images.push(json!({ "bufferView": out.file(&bytes), "mimeType": kind }));
                    painted.textures.push(json!({ "source": painted.images.len() - 1 }));
                    painted.textures.len() - 1
                });
                seen.push((texture.element.element_id, index));
                index
            });
            if let Some(index) = index {
                // A picture is the colour; the factor beside it is often a left-over grey.
                paint["baseColorFactor"] = json!([1.0, 1.0, 1.0, 1.0]);
                paint["baseColorTexture"] = json!({ "index": index });
            }
        }
        painted.materials.push(json!({ "name": &*material.element.name, "pbrMetallicRoughness": paint }));
    }
    painted
}

/// Colour and texture, of the physical description where there is one.
fn base(material: &Material) -> ([f64; 4], Option<&Texture>) {
    let (physical, plain) = (&material.pbr.base_color, &material.fbx.diffuse_color);
    let map = if physical.has_value || physical.texture.is_some() { physical } else { plain };
    let value = &map.value_vec4;
    let channel = |part: f64| if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.8 };
    let colour = if map.has_value { [value.x, value.y, value.z].map(channel) } else { [0.8; 3] };
    let texture = map.texture.as_ref().or(plain.texture.as_ref());
    ([colour[0], colour[1], colour[2], 1.0], texture.map(|texture| &**texture))
}

/// The picture's bytes: from within the file, else from where it says, relative to itself.
fn picture(texture: &Texture, resolve: &Resolve) -> Option<(Vec<u8>, &'static str)> {
    let within = |bytes: &[u8]| {
        let kind = PICTURES.iter().find(|(beginning, _)| bytes.starts_with(beginning))?.1;
        Some((bytes.to_vec(), kind))
    };
    let video = texture.video.as_ref();
    if let Some(found) = within(&texture.content).or_else(|| within(&video?.content)) {
        return Some(found);
    }
    let place = texture.relative_filename.replace('\\', "/");
    let file = place.rsplit('/').next().unwrap_or_default().to_owned();
    let below = !place.starts_with('/') && !place.contains(':') && !place.split('/').any(|part| part == "..");
    let tried = below.then_some(place).into_iter().chain([file]).filter(|name| !name.is_empty());
    tried.filter_map(|name| resolve(&name).ok()).find_map(|bytes| within(&bytes))
}
