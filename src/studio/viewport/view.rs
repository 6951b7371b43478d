//! One viewport's own picture on the graphics card: its targets, what changes each frame, and the passes.

use super::buffers::{Buffers, Material, Skin};
use super::frame::{Drawn, Frame, Kind, LOOSE, MATRIX};
use super::gpu::{Blits, COLOR, DEPTH, Gpu, Quality, RAW};
use eframe::wgpu;

/// Matrices in a row of their texture.
const MATRICES_A_ROW: usize = 128;
/// Bytes between two draws' uniforms.
const DRAW_STRIDE: u64 = 256;

/// Its targets and buffers.
pub(super) struct View {
    size: [u32; 2],
    color: wgpu::TextureView,
    resolved: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    shadow: wgpu::TextureView,
    shadow_bound: wgpu::BindGroup,
    blit_bound: wgpu::BindGroup,
    scene: wgpu::Buffer,
    draws: Grown,
    loose: Grown,
    matrices: wgpu::Texture,
    scene_bound: Option<wgpu::BindGroup>,
    last: Option<Frame>,
    /// Draw calls of the last picture, without the shadow's.
    pub(super) draw_calls: u32,
}

/// A buffer that is replaced by a larger one when it must.
struct Grown {
    buffer: wgpu::Buffer,
    usage: wgpu::BufferUsages,
}

impl Grown {
    fn new(device: &wgpu::Device, usage: wgpu::BufferUsages) -> Grown {
        Grown { buffer: Grown::buffer(device, usage, 4096), usage }
    }

    fn buffer(device: &wgpu::Device, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        device.create_buffer(&wgpu::BufferDescriptor { label: Some("frame"), size, usage, mapped_at_creation: false })
    }

    /// Writes it; true where the buffer is another one.
    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let grows = (bytes.len() as u64) > self.buffer.size();
        if grows {
            self.buffer = Grown::buffer(device, self.usage, (bytes.len() as u64).next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        grows
    }
}

/// The bytes of floats.
fn bytes(floats: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(floats.len() * 4);
    for float in floats {
        bytes.extend_from_slice(&float.to_ne_bytes());
    }
    bytes
}

impl View {
    /// Of the shader's `Scene`.
    pub(super) const SCENE_BYTES: u64 = 2 * 64 + 16 * 16;
    /// Of its `Draw`.
    pub(super) const DRAW_BYTES: u64 = 48;

    /// Targets of a size. `exact`: it is the window's, so that no point lies between its own.
    pub(super) fn new(device: &wgpu::Device, gpu: &Gpu, size: [u32; 2], exact: bool) -> View {
        let Quality { samples, shadow, .. } = gpu.quality;
        let target = |label, [width, height]: [u32; 2], samples, format, read: bool| {
            let read = if read { wgpu::TextureUsages::TEXTURE_BINDING } else { wgpu::TextureUsages::empty() };
            let raw = format == COLOR && gpu.blits == Blits::Raw && !read.is_empty();
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | read,
                view_formats: if raw { &[RAW] } else { &[] },
            })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let color = target("color", size, samples, COLOR, samples == 1);
        let resolved = (samples > 1).then(|| target("resolved", size, 1, COLOR, true));
        let format = (gpu.blits == Blits::Raw).then_some(RAW);
        let finished = resolved.as_ref().unwrap_or(&color);
        let finished = finished.create_view(&wgpu::TextureViewDescriptor {
            format,
            usage: Some(wgpu::TextureUsages::TEXTURE_BINDING),
            ..Default::default()
        });
        let shadow = view(&target("shadow", [shadow; 2], 1, DEPTH, true));
        let bound = |layout, view: &wgpu::TextureView, sampler| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("viewport"),
                layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
                ],
            })
        };
        let layouts = &gpu.layouts;
        let uniform = wgpu::BufferUsages::UNIFORM;
        View {
            size,
            depth: view(&target("depth", size, samples, DEPTH, false)),
            shadow_bound: bound(&layouts.shadow, &shadow, &layouts.shadow_sampler),
            blit_bound: bound(&layouts.blit, &finished, &layouts.blit_samplers[usize::from(exact)]),
            color: view(&color),
            resolved: resolved.as_ref().map(view),
            shadow,
            scene: Grown::buffer(device, uniform, View::SCENE_BYTES),
            draws: Grown::new(device, uniform),
            loose: Grown::new(device, wgpu::BufferUsages::VERTEX),
            matrices: matrices(device, 1),
            scene_bound: None,
            last: None,
            draw_calls: 0,
        }
    }

    /// Whether it is of that size.
    pub(super) fn fits(&self, size: [u32; 2]) -> bool {
        self.size == size
    }

    /// Draws a frame, unless it is the same as the last one.
    pub(super) fn draw(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        gpu: &Gpu,
        frame: &Frame,
    ) {
        if self.last.as_ref() == Some(frame) {
            return;
        }
        let calls = self.write(device, queue, gpu, frame);
        let Some(scene) = self.scene_bound.as_ref() else { return };
        let parts = [&frame.solid, &frame.arrows, &frame.decals, &frame.pale].map(|part| (part.len() / LOOSE) as u32);
        let mut from = 0;
        let [solid, arrows, decals, pale] = parts.map(|count| {
            from += count;
            from - count..from
        });
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shadow"),
                depth_stencil_attachment: Some(cleared(&self.shadow)),
                ..Default::default()
            });
            pass.set_pipeline(&gpu.pipelines.mesh_shadow);
            for call in calls.iter().filter(|call| call.drawn.kind == Kind::Solid) {
                call.mesh(&mut pass, scene);
            }
            if !solid.is_empty() {
                pass.set_pipeline(&gpu.pipelines.loose_shadow);
                pass.set_bind_group(0, scene, &[0]);
                pass.set_vertex_buffer(0, self.loose.buffer.slice(..));
                pass.draw(solid.clone(), 0..1);
            }
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.color,
                resolve_target: self.resolved.as_ref(),
                depth_slice: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: if self.resolved.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                },
            })],
            depth_stencil_attachment: Some(cleared(&self.depth)),
            ..Default::default()
        });
        let mut draw_calls = 0;
        pass.set_bind_group(2, &self.shadow_bound, &[]);
        let pipelines = &gpu.pipelines;
        for (pipeline, kind, skin) in [
            (&pipelines.mesh, Kind::Solid, Skin::Plain),
            (&pipelines.mesh_textured, Kind::Solid, Skin::Whole),
            (&pipelines.mesh_holed, Kind::Solid, Skin::Holed),
            (&pipelines.mesh_ground, Kind::Ground, Skin::Plain),
        ] {
            pass.set_pipeline(pipeline);
            for call in calls.iter().filter(|call| (call.drawn.kind, call.material.skin) == (kind, skin)) {
                call.textured(&mut pass, scene);
                draw_calls += 1;
            }
        }
        pass.set_bind_group(0, scene, &[0]);
        pass.set_bind_group(1, &gpu.white, &[]);
        let mut loose = |pass: &mut wgpu::RenderPass, pipeline, corners: std::ops::Range<u32>| {
            if !corners.is_empty() {
                pass.set_pipeline(pipeline);
                pass.set_vertex_buffer(0, self.loose.buffer.slice(..));
                pass.draw(corners, 0..1);
                draw_calls += 1;
            }
        };
        loose(&mut pass, &gpu.pipelines.loose, solid.start..arrows.end);
        if frame.flat {
            pass.set_pipeline(&gpu.pipelines.ground);
            pass.draw(0..6, 0..1);
            pass.set_pipeline(&gpu.pipelines.ground_bare);
            pass.draw(6..30, 0..1);
        }
        pass.set_pipeline(&gpu.pipelines.sky);
        pass.draw(0..3, 0..1);
        loose(&mut pass, &gpu.pipelines.decal, decals);
        loose(&mut pass, &gpu.pipelines.pale_depth, pale.clone());
        loose(&mut pass, &gpu.pipelines.pale, pale);
        for pipeline in [&gpu.pipelines.ghost_depth, &gpu.pipelines.ghost] {
            pass.set_pipeline(pipeline);
            for call in calls.iter().filter(|call| call.drawn.kind == Kind::Ghost) {
                call.textured(&mut pass, scene);
                draw_calls += 1;
            }
        }
        drop(pass);
        self.draw_calls = draw_calls + 1 + 2 * u32::from(frame.flat);
        self.last = Some(frame.clone());
    }

    /// Brings the picture to the window.
    pub(super) fn show(&self, gpu: &Gpu, pass: &mut wgpu::RenderPass<'static>) {
        pass.set_pipeline(&gpu.pipelines.blit);
        pass.set_bind_group(0, &self.blit_bound, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Uploads what changes each frame; the draws.
    fn write<'a>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        gpu: &'a Gpu,
        frame: &'a Frame,
    ) -> Vec<Call<'a>> {
        queue.write_buffer(&self.scene, 0, &bytes(&frame.scene));
        let mut calls = Vec::new();
        // The first is of the loose triangles.
        let mut draws = vec![0_u8; DRAW_STRIDE as usize];
        for drawn in &frame.drawn {
            let Some(buffers) = gpu.meshes.get(&drawn.source.key()) else { continue };
            for material in &buffers.materials {
                let offset = draws.len() as u32;
                let color: [f32; 4] = std::array::from_fn(|at| drawn.color[at] * material.color[at]);
                draws.extend(bytes(&color));
                draws.extend(bytes(&drawn.tint));
                draws.extend([drawn.first, 0, 0, 0].iter().flat_map(|number| number.to_ne_bytes()));
                draws.resize(offset as usize + DRAW_STRIDE as usize, 0);
                calls.push(Call { drawn, buffers, material, offset });
            }
        }
        let mut rebind = self.draws.write(device, queue, &draws) || self.scene_bound.is_none();
        let loose: Vec<u8> =
            [&frame.solid, &frame.arrows, &frame.decals, &frame.pale].iter().flat_map(|part| bytes(part)).collect();
        self.loose.write(device, queue, &loose);
        let rows = (frame.matrices.len() / MATRIX).div_ceil(MATRICES_A_ROW).max(1);
        if rows as u32 > self.matrices.height() {
            self.matrices = matrices(device, (rows as u32).next_power_of_two());
            rebind = true;
        }
        let mut floats = bytes(&frame.matrices);
        let row = MATRICES_A_ROW * MATRIX * 4;
        floats.resize(rows * row, 0);
        queue.write_texture(
            self.matrices.as_image_copy(),
            &floats,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None },
            wgpu::Extent3d { width: self.matrices.width(), height: rows as u32, depth_or_array_layers: 1 },
        );
        if rebind {
            self.scene_bound = Some(self.bind(device, gpu));
        }
        calls
    }

    fn bind(&self, device: &wgpu::Device, gpu: &Gpu) -> wgpu::BindGroup {
        let matrices = self.matrices.create_view(&wgpu::TextureViewDescriptor::default());
        let draw = wgpu::BufferBinding {
            buffer: &self.draws.buffer,
            offset: 0,
            size: std::num::NonZeroU64::new(View::DRAW_BYTES),
        };
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("scene"),
            layout: &gpu.layouts.scene,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.scene.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&matrices) },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Buffer(draw) },
            ],
        })
    }
}

/// One draw of a mesh.
struct Call<'a> {
    drawn: &'a Drawn,
    buffers: &'a Buffers,
    material: &'a Material,
    offset: u32,
}

impl Call<'_> {
    fn textured(&self, pass: &mut wgpu::RenderPass, scene: &wgpu::BindGroup) {
        pass.set_bind_group(1, &self.material.texture, &[]);
        self.mesh(pass, scene);
    }

    fn mesh(&self, pass: &mut wgpu::RenderPass, scene: &wgpu::BindGroup) {
        pass.set_bind_group(0, scene, &[self.offset]);
        pass.set_vertex_buffer(0, self.buffers.vertices.slice(..));
        pass.set_index_buffer(self.buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(self.material.indices.clone(), 0, 0..1);
    }
}

fn cleared(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
        stencil_ops: None,
    }
}

fn matrices(device: &wgpu::Device, rows: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("matrices"),
        size: wgpu::Extent3d { width: 3 * MATRICES_A_ROW as u32, height: rows, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}
