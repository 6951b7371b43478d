//! Pictures of the studio's panels, drawn without a window and kept under target/studio for a person to look at.

use eframe::egui;
use egui_kittest::Harness;
use egui_kittest::wgpu::WgpuTestRenderer;
use std::panic::catch_unwind;

/// A harness that can draw; `None`, told plainly, where no adapter is. With CI set that fails.
pub fn harness<'a>(
    size: [f32; 2],
    (scale, theme): (f32, egui::Theme),
    app: impl FnMut(&mut egui::Ui) + 'a,
) -> Option<Harness<'a>> {
    let renderer = renderer()?;
    let builder = Harness::builder().with_size(size).with_pixels_per_point(scale).with_theme(theme);
    Some(builder.renderer(renderer).build_ui(app))
}

/// What draws without a window; `None`, told plainly, where no adapter is. With CI set that fails.
#[expect(clippy::print_stdout, reason = "a test that did not run says so")]
pub fn renderer() -> Option<WgpuTestRenderer> {
    // It panics where there is none.
    let renderer = catch_unwind(WgpuTestRenderer::new).ok();
    if renderer.is_none() {
        assert!(std::env::var_os("CI").is_none(), "no wgpu adapter: the pictures could not be drawn");
        println!("skipped: no wgpu adapter");
    }
    renderer
}

/// Draws what the harness shows, keeps it as target/studio/NAME.png, and gives its pixels.
pub fn keep<State>(harness: &mut Harness<'_, State>, name: &str) -> image::RgbaImage {
    let image = harness.render().expect("the frame is drawn");
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/studio");
    std::fs::create_dir_all(&folder).expect("target can be written to");
    image.save(folder.join(format!("{name}.png"))).expect("the picture is kept");
    image
}

/// Pixels that are near a colour.
pub fn near(image: &image::RgbaImage, [red, green, blue]: [u8; 3]) -> usize {
    let close = |pixel: &&image::Rgba<u8>| {
        pixel[0].abs_diff(red) < 24 && pixel[1].abs_diff(green) < 24 && pixel[2].abs_diff(blue) < 24
    };
    image.pixels().filter(close).count()
}
