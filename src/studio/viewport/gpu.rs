//! What the viewport keeps on the graphics card for all its pictures: pipelines and layouts, rigs and shapes.
//!
//! Joint matrices go in a texture of floats: also the oldest of cards, and software, have those. No storage buffers.

use super::buffers::{Buffers, Textures, VERTEX};
use super::frame::{LOOSE, Source};
use super::view::View;
use eframe::egui_wgpu::RenderState;
use eframe::wgpu;
use std::collections::BTreeMap;

/// Of the picture before it goes to the window.
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// The same bytes, read as they are.
pub(super) const RAW: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Of its depth, and of the shadow's.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How the picture gets to the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blits {
    /// Its bytes as they are.
    Raw,
    /// As light, encoded by the shader.
    Encoded,
    /// As light; the window encodes.
    Light,
}

/// How finely it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Samples a pixel: 1 or 4.
    pub samples: u32,
    /// px, a side of the shadow's map.
    pub shadow: u32,
    /// px, a picture with more is drawn smaller and stretched.
    pub most_pixels: f64,
    /// Shadows blur with the distance of what throws them.
    pub soft: bool,
}

impl Quality {
    /// For a graphics card.
    pub const HARDWARE: Quality = Quality { samples: 4, shadow: 1024, most_pixels: 16e6, soft: true };
    /// For a processor that plays one.
    pub const SOFTWARE: Quality = Quality { samples: 1, shadow: 640, most_pixels: 1.1e6, soft: false };
}

/// All of it.
pub(super) struct Gpu {
    pub(super) quality: Quality,
    pub(super) blits: Blits,
    pub(super) layouts: Layouts,
    pub(super) pipelines: Pipelines,
    pub(super) textures: Textures,
    /// Bound where there is no picture.
    pub(super) white: wgpu::BindGroup,
    /// By [`Source::key`].
    pub(super) meshes: BTreeMap<usize, Buffers>,
    /// By the viewport's id.
    pub(super) views: BTreeMap<u64, View>,
}

/// What is bound where.
pub(super) struct Layouts {
    pub(super) scene: wgpu::BindGroupLayout,
    pub(super) shadow: wgpu::BindGroupLayout,
    pub(super) blit: wgpu::BindGroupLayout,
    pub(super) shadow_sampler: wgpu::Sampler,
    /// Between points, and the nearest.
    pub(super) blit_samplers: [wgpu::Sampler; 2],
}

/// One for each way of drawing.
pub(super) struct Pipelines {
    pub(super) mesh: wgpu::RenderPipeline,
    pub(super) mesh_textured: wgpu::RenderPipeline,
    pub(super) mesh_holed: wgpu::RenderPipeline,
    pub(super) mesh_ground: wgpu::RenderPipeline,
    pub(super) mesh_shadow: wgpu::RenderPipeline,
    pub(super) ghost_depth: wgpu::RenderPipeline,
    pub(super) ghost: wgpu::RenderPipeline,
    pub(super) loose: wgpu::RenderPipeline,
    pub(super) loose_shadow: wgpu::RenderPipeline,
    pub(super) pale_depth: wgpu::RenderPipeline,
    pub(super) pale: wgpu::RenderPipeline,
    pub(super) decal: wgpu::RenderPipeline,
    pub(super) ground: wgpu::RenderPipeline,
    pub(super) ground_bare: wgpu::RenderPipeline,
    pub(super) sky: wgpu::RenderPipeline,
    pub(super) blit: wgpu::RenderPipeline,
}

impl Gpu {
    /// For the card of a window.
    pub(super) fn new(state: &RenderState, quality: Option<Quality>) -> Gpu {
        let software = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let quality = quality.unwrap_or(if software { Quality::SOFTWARE } else { Quality::HARDWARE });
        let device = &state.device;
        let layouts = Layouts::new(device);
        let linear = |label, repeat| {
            let address = if repeat { wgpu::AddressMode::Repeat } else { wgpu::AddressMode::ClampToEdge };
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: address,
                address_mode_v: address,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            })
        };
        let textures = Textures { layout: texture_layout(device), sampler: linear("skin", true) };
        let views = wgpu::DownlevelFlags::VIEW_FORMATS;
        let blits = match state.target_format.is_srgb() {
            true => Blits::Light,
            false if state.adapter.get_downlevel_capabilities().flags.contains(views) => Blits::Raw,
            false => Blits::Encoded,
        };
        let pipelines = Pipelines::new(device, (&layouts, &textures), quality, (state.target_format, blits));
        let white = textures.bind(device, &state.queue, None);
        Gpu { quality, blits, layouts, pipelines, textures, white, meshes: BTreeMap::new(), views: BTreeMap::new() }
    }

    /// What of a source is on the card; uploads it where it is not yet.
    pub(super) fn mesh(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, source: &Source) {
        if !self.meshes.contains_key(&source.key()) {
            let buffers = Buffers::new(device, queue, &self.textures, source.clone());
            self.meshes.insert(source.key(), buffers);
        }
    }
}

fn entry(binding: u32, stages: wgpu::ShaderStages, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: stages, ty, count: None }
}

fn uniform(dynamic: bool, bytes: u64) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: dynamic,
        min_binding_size: std::num::NonZeroU64::new(bytes),
    }
}

fn texture(sample_type: wgpu::TextureSampleType) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled: false }
}

const FILTERED: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: true };

fn texture_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let fragment = wgpu::ShaderStages::FRAGMENT;
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("texture"),
        entries: &[
            entry(0, fragment, texture(FILTERED)),
            entry(1, fragment, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
        ],
    })
}

impl Layouts {
    fn new(device: &wgpu::Device) -> Layouts {
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let floats = texture(wgpu::TextureSampleType::Float { filterable: false });
        let scene = layout(
            "scene",
            &[
                entry(0, both, uniform(false, View::SCENE_BYTES)),
                entry(1, wgpu::ShaderStages::VERTEX, floats),
                entry(2, both, uniform(true, View::DRAW_BYTES)),
            ],
        );
        let compares = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
        let shadow = layout(
            "shadow",
            &[entry(0, fragment, texture(wgpu::TextureSampleType::Depth)), entry(1, fragment, compares)],
        );
        let shadow_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let blit_samplers = [wgpu::FilterMode::Linear, wgpu::FilterMode::Nearest].map(|filter| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("blit"),
                mag_filter: filter,
                min_filter: filter,
                ..Default::default()
            })
        });
        Layouts { scene, shadow, blit: texture_layout(device), shadow_sampler, blit_samplers }
    }
}

/// What one pipeline differs by from another.
struct Way<'a> {
    label: &'a str,
    vertex: &'a str,
    buffer: Option<&'a wgpu::VertexBufferLayout<'a>>,
    /// Its fragment shader; whether it blends, and writes colour at all.
    fragment: Option<(&'a str, Option<wgpu::BlendState>, wgpu::ColorWrites)>,
    depth_write: bool,
    compare: wgpu::CompareFunction,
    bias: i32,
}

impl Pipelines {
    fn new(
        device: &wgpu::Device,
        (layouts, textures): (&Layouts, &Textures),
        quality: Quality,
        window: (wgpu::TextureFormat, Blits),
    ) -> Pipelines {
        let soft = [("soft", f64::from(u8::from(quality.soft)))];
        let options = wgpu::PipelineCompilationOptions { constants: &soft, ..Default::default() };
        let source = |text: &'static str| wgpu::ShaderSource::Wgsl(text.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("scene"),
            source: source(include_str!("scene.wgsl")),
        });
        let layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("viewport"),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let all = layout(&[Some(&layouts.scene), Some(&textures.layout), Some(&layouts.shadow)]);
        let casting = layout(&[Some(&layouts.scene)]);
        let skinned = wgpu::VertexBufferLayout {
            array_stride: VERTEX,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Uint16x4, 4 => Unorm16x4],
        };
        let loose = wgpu::VertexBufferLayout {
            array_stride: 4 * LOOSE as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x4],
        };
        let make = |way: &Way| {
            let buffers = way.buffer.map(|buffer| [Some(buffer.clone())]);
            let target = way
                .fragment
                .map(|(_, blend, write_mask)| [Some(wgpu::ColorTargetState { format: COLOR, blend, write_mask })]);
            let in_picture = way.fragment.is_some();
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(way.label),
                layout: Some(if in_picture { &all } else { &casting }),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(way.vertex),
                    compilation_options: Default::default(),
                    buffers: buffers.as_ref().map_or(&[], |buffers| buffers.as_slice()),
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(way.depth_write),
                    depth_compare: Some(way.compare),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState { constant: way.bias, slope_scale: 0.0, clamp: 0.0 },
                }),
                multisample: wgpu::MultisampleState {
                    count: if in_picture { quality.samples } else { 1 },
                    ..Default::default()
                },
                fragment: way.fragment.as_ref().zip(target.as_ref()).map(|((entry, _, _), targets)| {
                    wgpu::FragmentState {
                        module: &module,
                        entry_point: Some(entry),
                        compilation_options: options.clone(),
                        targets,
                    }
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let (less, equal) = (wgpu::CompareFunction::Less, wgpu::CompareFunction::LessEqual);
        let every = wgpu::ColorWrites::ALL;
        let blends = Some(wgpu::BlendState::ALPHA_BLENDING);
        let mesh = Way {
            label: "mesh",
            vertex: "skinned",
            buffer: Some(&skinned),
            fragment: Some(("surface", None, every)),
            depth_write: true,
            compare: less,
            bias: 0,
        };
        let solid = Way { label: "loose", vertex: "loose", buffer: Some(&loose), ..mesh };
        let solid = Way { fragment: Some(("surface_loose", None, every)), ..solid };
        let hidden = wgpu::ColorWrites::empty();
        let ground = Way {
            label: "ground",
            vertex: "ground",
            buffer: None,
            fragment: Some(("ground_color", None, every)),
            ..mesh
        };
        let over = Way { depth_write: false, compare: equal, ..mesh };
        Pipelines {
            mesh: make(&mesh),
            mesh_textured: make(&Way { label: "textured", fragment: Some(("surface_textured", None, every)), ..mesh }),
            mesh_holed: make(&Way { label: "holed", fragment: Some(("surface_holed", None, every)), ..mesh }),
            mesh_ground: make(&Way { label: "squares", fragment: Some(("surface_ground", None, every)), ..mesh }),
            mesh_shadow: make(&Way { label: "mesh shadow", vertex: "skinned_shadow", fragment: None, ..mesh }),
            ghost_depth: make(&Way { label: "ghost depth", fragment: Some(("surface_ghost", None, hidden)), ..mesh }),
            ghost: make(&Way { label: "ghost", fragment: Some(("surface_ghost", blends, every)), ..over }),
            loose: make(&solid),
            loose_shadow: make(&Way { label: "loose shadow", vertex: "loose_shadow", fragment: None, ..solid }),
            pale_depth: make(&Way { label: "pale depth", fragment: Some(("flat_color", None, hidden)), ..solid }),
            pale: make(&Way {
                label: "pale",
                fragment: Some(("surface_loose", blends, every)),
                depth_write: false,
                compare: equal,
                ..solid
            }),
            decal: make(&Way {
                label: "decal",
                fragment: Some(("flat_color", blends, every)),
                depth_write: false,
                compare: equal,
                bias: -24,
                ..solid
            }),
            ground: make(&ground),
            ground_bare: make(&Way { label: "bare ground", fragment: Some(("ground_bare", None, every)), ..ground }),
            sky: make(&Way {
                label: "sky",
                vertex: "sky",
                buffer: None,
                fragment: Some(("sky_color", None, every)),
                ..over
            }),
            blit: blit(device, layouts, &layout, window),
        }
    }
}

/// The one that brings the picture to the window.
fn blit(
    device: &wgpu::Device,
    layouts: &Layouts,
    layout: &dyn Fn(&[Option<&wgpu::BindGroupLayout>]) -> wgpu::PipelineLayout,
    (window, blits): (wgpu::TextureFormat, Blits),
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("blit"),
        source: wgpu::ShaderSource::Wgsl(include_str!("blit.wgsl").into()),
    });
    let encodes = [("encodes", f64::from(u8::from(blits == Blits::Encoded)))];
    let options = wgpu::PipelineCompilationOptions { constants: &encodes, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blit"),
        layout: Some(&layout(&[Some(&layouts.blit)])),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("shown"),
            compilation_options: options,
            targets: &[Some(window.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
