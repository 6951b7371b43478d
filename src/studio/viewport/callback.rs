//! The viewport in egui's frame: drawn before egui's own pass, into targets with a depth, and brought to its place in it.

use super::frame::{Frame, Source};
use super::gpu::{Gpu, Quality};
use super::view::View;
use eframe::egui::PaintCallbackInfo;
use eframe::egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::wgpu;

/// Viewports whose pictures are kept.
const MOST_VIEWS: usize = 8;

/// Makes what the viewport needs on the graphics card. Once, when the window opens; without it viewports stay empty.
pub fn install(state: &RenderState) {
    install_with(state, None);
}

/// The same, drawn as finely as told.
pub fn install_with(state: &RenderState, quality: Option<Quality>) {
    let gpu = Gpu::new(state, quality);
    state.renderer.write().callback_resources.insert(gpu);
}

/// Draw calls of the picture that a viewport drew last, without the shadow's; `None` where it drew none.
pub fn draw_calls(state: &RenderState) -> Option<u32> {
    let renderer = state.renderer.read();
    let gpu = renderer.callback_resources.get::<Gpu>()?;
    gpu.views.values().next_back().map(|view| view.draw_calls)
}

/// One viewport in one frame.
pub(super) struct Callback {
    /// The viewport's.
    pub(super) id: u64,
    pub(super) frame: Frame,
}

impl CallbackTrait for Callback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let Some(gpu) = resources.get_mut::<Gpu>() else { return Vec::new() };
        gpu.meshes.retain(|_, mesh| mesh.source.is_shared());
        let sources: Vec<&Source> = self.frame.drawn.iter().map(|drawn| &drawn.source).collect();
        for source in sources {
            gpu.mesh(device, queue, source);
        }
        if gpu.views.len() > MOST_VIEWS {
            gpu.views.clear(); // of viewports that are long gone
        }
        let size = fitted(self.frame.size, gpu.quality.most_pixels, device.limits().max_texture_dimension_2d);
        let before = gpu.views.remove(&self.id).filter(|view| view.fits(size));
        let mut view = before.unwrap_or_else(|| View::new(device, gpu, size, size == self.frame.size));
        view.draw(device, queue, encoder, gpu, &self.frame);
        gpu.views.insert(self.id, view);
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        let Some(gpu) = resources.get::<Gpu>() else { return };
        if let Some(view) = gpu.views.get(&self.id) {
            view.show(gpu, pass);
        }
    }
}

/// The size with no more pixels than that, and no side longer than the card allows.
fn fitted([width, height]: [u32; 2], most: f64, side: u32) -> [u32; 2] {
    let pixels = f64::from(width) * f64::from(height);
    let longest = f64::from(width.max(height).max(1));
    let scale = (most / pixels.max(1.0)).sqrt().min(f64::from(side) / longest).min(1.0);
    [width, height].map(|length| ((f64::from(length) * scale).round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_is_too_large_keeps_its_shape() {
        assert_eq!(fitted([1280, 800], 1.1e6, 8192), [1280, 800]);
        assert_eq!(fitted([2560, 1600], 1.024e6, 8192), [1280, 800]);
        assert_eq!(fitted([20000, 10], 1e9, 2048), [2048, 1]);
        assert_eq!(fitted([0, 0], 1e9, 2048), [1, 1]);
    }
}
