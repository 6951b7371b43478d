//! Rigs and shapes on the graphics card: uploaded once, one draw a material. Bind pose, metres.

use super::frame::Source;
use crate::model::props::Shape;
use crate::rig::{MeshPart, Rig};
use eframe::wgpu::{self, util::DeviceExt};
use glam::{DVec2, DVec3};
use image::RgbaImage;
use std::collections::BTreeMap;

/// Bytes of a vertex: place and normal, uv, four joints, four weights.
pub(super) const VERTEX: u64 = 48;
/// px, a larger picture is uploaded smaller.
const LARGEST_TEXTURE: u32 = 2048;

/// What is on the card of a rig or a shape.
pub(super) struct Buffers {
    /// Keeps its identity.
    pub(super) source: Source,
    pub(super) vertices: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) materials: Vec<Material>,
}

/// Triangles of one material.
pub(super) struct Material {
    pub(super) indices: std::ops::Range<u32>,
    /// Linear RGBA.
    pub(super) color: [f32; 4],
    /// Its picture.
    pub(super) skin: Skin,
    /// White where it has none.
    pub(super) texture: wgpu::BindGroup,
}

/// What a material's picture is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Skin {
    /// There is none.
    Plain,
    /// It covers all.
    Whole,
    /// Its alpha cuts holes.
    Holed,
}

impl Skin {
    fn of(image: Option<&RgbaImage>) -> Skin {
        match image {
            None => Skin::Plain,
            // The alpha from which on the shader leaves a point out.
            Some(image) if image.pixels().any(|pixel| pixel[3] < 102) => Skin::Holed,
            Some(_) => Skin::Whole,
        }
    }
}

/// How textures are bound.
pub(super) struct Textures {
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) sampler: wgpu::Sampler,
}

/// Vertices and indices while they are gathered.
#[derive(Default)]
struct Gathered {
    vertices: Vec<u8>,
    count: u32,
    indices: Vec<u32>,
}

impl Gathered {
    fn vertex(&mut self, at: DVec3, normal: DVec3, uv: DVec2, weights: &[(usize, f64); 4]) {
        let floats = [at.x, at.y, at.z, normal.x, normal.y, normal.z, uv.x, uv.y];
        self.vertices.extend(floats.iter().flat_map(|value| (*value as f32).to_ne_bytes()));
        let joints = weights.iter().flat_map(|(joint, _)| u16::try_from(*joint).unwrap_or(u16::MAX).to_ne_bytes());
        self.vertices.extend(joints);
        let shares =
            weights.iter().flat_map(|(_, share)| ((share.clamp(0.0, 1.0) * 65535.0).round() as u16).to_ne_bytes());
        self.vertices.extend(shares);
        self.count += 1;
    }

    fn part(&mut self, part: &MeshPart) {
        let none = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        let uv = |vertex: usize| part.uvs.get(vertex).copied().unwrap_or_default();
        let weights = |vertex: usize| part.weights.get(vertex).unwrap_or(&none);
        if part.normals.len() == part.positions.len() {
            let first = self.count;
            for (vertex, (at, normal)) in part.positions.iter().zip(&part.normals).enumerate() {
                self.vertex(*at, *normal, uv(vertex), weights(vertex));
            }
            self.indices.extend(part.indices.iter().map(|index| first + index));
            return;
        }
        // Without normals each triangle is flat.
        for triangle in part.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|at| triangle[at] as usize);
            let corner = |at: usize| part.positions.get(at).copied().unwrap_or_default();
            let normal = (corner(b) - corner(a)).cross(corner(c) - corner(a)).normalize_or(DVec3::Y);
            for at in [a, b, c] {
                self.indices.push(self.count);
                self.vertex(corner(at), normal, uv(at), weights(at));
            }
        }
    }
}

impl Buffers {
    /// Uploads it.
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue, textures: &Textures, source: Source) -> Buffers {
        let (gathered, materials) = match &source {
            Source::Rig(rig) => gather_rig(rig),
            Source::Shape(shape) => (gather_shape(shape), Vec::new()),
        };
        let buffer = |contents: &[u8], usage: wgpu::BufferUsages| {
            // A buffer of no bytes cannot be bound.
            let contents = if contents.is_empty() { &[0; 4] } else { contents };
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("mesh"), contents, usage })
        };
        let bytes: Vec<u8> = gathered.indices.iter().flat_map(|index| index.to_ne_bytes()).collect();
        let images = match &source {
            Source::Rig(rig) => rig.document.images.as_slice(),
            Source::Shape(_) => &[],
        };
        let mut uploaded: BTreeMap<Option<usize>, wgpu::BindGroup> = BTreeMap::new();
        let mut material = |indices, color, texture: Option<usize>| {
            let image = texture.and_then(|index| images.get(index)).and_then(Option::as_ref);
            let texture = texture.filter(|_| image.is_some());
            let bound = uploaded.entry(texture).or_insert_with(|| textures.bind(device, queue, image)).clone();
            Material { indices, color, skin: Skin::of(image), texture: bound }
        };
        let mut materials: Vec<Material> =
            materials.into_iter().map(|(range, color, texture)| material(range, color, texture)).collect();
        if matches!(source, Source::Shape(_)) {
            materials.push(material(0..gathered.indices.len() as u32, [1.0; 4], None));
        }
        Buffers {
            vertices: buffer(&gathered.vertices, wgpu::BufferUsages::VERTEX),
            indices: buffer(&bytes, wgpu::BufferUsages::INDEX),
            materials,
            source,
        }
    }
}

/// Indices, base colour and texture of one draw.
type Range = (std::ops::Range<u32>, [f32; 4], Option<usize>);

/// All parts, those of one material beside each other.
fn gather_rig(rig: &Rig) -> (Gathered, Vec<Range>) {
    let mut by_material: BTreeMap<([u32; 4], Option<usize>), Vec<&MeshPart>> = BTreeMap::new();
    for part in rig.mesh.iter().filter(|part| !part.indices.is_empty()) {
        by_material.entry((part.base_color.map(f32::to_bits), part.base_texture)).or_default().push(part);
    }
    let mut gathered = Gathered::default();
    let mut ranges = Vec::new();
    for ((color, texture), parts) in by_material {
        let first = gathered.indices.len() as u32;
        parts.into_iter().for_each(|part| gathered.part(part));
        ranges.push((first..gathered.indices.len() as u32, color.map(f32::from_bits), texture));
    }
    (gathered, ranges)
}

fn gather_shape(shape: &Shape) -> Gathered {
    let mesh = shape.mesh();
    let mut gathered = Gathered::default();
    let whole = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
    for (vertex, at) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.get(vertex).copied().unwrap_or(DVec3::Y);
        gathered.vertex(*at, normal, DVec2::ZERO, &whole);
    }
    let count = gathered.count;
    gathered.indices.extend(mesh.indices.iter().copied().filter(|index| *index < count));
    gathered
}

impl Textures {
    /// Uploads a picture with all its smaller sizes; a white point for none.
    pub(super) fn bind(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        image: Option<&RgbaImage>,
    ) -> wgpu::BindGroup {
        let white = RgbaImage::from_pixel(1, 1, image::Rgba([255; 4]));
        let image = image.filter(|image| image.width() > 0 && image.height() > 0).unwrap_or(&white);
        let mut levels = vec![image.clone()];
        while let Some(last) = levels.last().filter(|last| last.width().max(last.height()) > 1) {
            let half = halved(last);
            levels.push(half);
        }
        let too_large = levels.iter().take_while(|level| level.width().max(level.height()) > LARGEST_TEXTURE).count();
        let levels = &levels[too_large.min(levels.len() - 1)..];
        let extent = |level: &RgbaImage| wgpu::Extent3d {
            width: level.width(),
            height: level.height(),
            depth_or_array_layers: 1,
        };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("base colour"),
            size: extent(&levels[0]),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (number, level) in levels.iter().enumerate() {
            let place = wgpu::TexelCopyTextureInfo { mip_level: number as u32, ..texture.as_image_copy() };
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * level.width()), rows_per_image: None };
            queue.write_texture(place, level.as_raw(), layout, extent(level));
        }
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("base colour"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        })
    }
}

/// Half as large, each point the mean of four.
fn halved(image: &RgbaImage) -> RgbaImage {
    let (width, height) = image.dimensions();
    RgbaImage::from_fn((width / 2).max(1), (height / 2).max(1), |x, y| {
        let at = |dx: u32, dy: u32| image.get_pixel((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1)).0;
        let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
        image::Rgba([0, 1, 2, 3].map(|channel| {
            (four.iter().map(|texel| u32::from(texel[channel])).sum::<u32>().div_ceil(4)).min(255) as u8
        }))
    })
}
