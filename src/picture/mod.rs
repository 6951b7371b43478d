//! Pictures as bytes: contact sheets, drawn on the CPU, plots, and the page of an audit ([`report_page`]).
//!
//! [`sheet()`] shows a clip on its rig at the moments that tell, [`film`] at equal distances, [`stick_strip`] poses of a
//! body alone, as capsules. Below them: [`skin`] poses a rig's mesh, [`compose`] lays out a page of [`Frame`]s,
//! [`marks`] draws what is known of the balance, [`raster`] draws triangles. [`clip_plot()`] draws a run's curves by [`plot`].

mod balance;
pub mod cell;
pub mod clip_plot;
pub mod compose;
pub mod coverage;
mod coverage_marks;
mod coverage_wedges;
pub mod figure;
mod footing;
pub mod grid;
pub mod ground;
pub mod marks;
pub mod moments;
pub mod paint;
pub mod plan;
pub mod plot;
pub mod raster;
pub mod report_data;
pub mod report_frames;
pub mod report_page;
pub mod seen;
pub mod shadow;
pub mod sheet;
pub mod skin;
pub mod stage;
pub mod strip;
pub mod text;
pub mod verdict;

pub use cell::{cell, clip_cell};
pub use clip_plot::clip_plot;
pub use compose::{Frame, Header, Layout, Trail};
pub use coverage::{CoveragePoint, coverage};
pub use grid::{Grid, GridCell};
pub use marks::{Overlay, Push, SoleMark};
pub use moments::{Moment, choose_moments, even_moments};
pub use seen::seen_in_file;
pub use sheet::{SheetInput, film, sheet};
pub use skin::{NodeTransforms, transforms_of_globals, transforms_of_locals};
pub use stage::Stage;
pub use strip::stick_strip;
pub use verdict::Verdict;

/// The bytes of a PNG file.
pub fn png(image: &image::RgbaImage) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    // Writing to memory cannot fail but by size; an empty answer then is no PNG and its writer says so.
    match image.write_to(&mut bytes, image::ImageFormat::Png) {
        Ok(()) => bytes.into_inner(),
        Err(_) => Vec::new(),
    }
}

/// The bytes of a smaller PNG file, without alpha; several times the work of [`png`].
pub fn small_png(image: &image::RgbaImage) -> Vec<u8> {
    use image::codecs::png::{CompressionType, FilterType, PngEncoder};
    use image::{ExtendedColorType, ImageEncoder};
    let (width, height) = image.dimensions();
    let rgb: Vec<u8> = image.pixels().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive);
    match encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8) {
        Ok(()) => bytes,
        Err(_) => Vec::new(), // as above
    }
}

/// A PNG file's picture.
pub fn from_png(bytes: &[u8]) -> Option<image::RgbaImage> {
    let picture = image::load_from_memory_with_format(bytes, image::ImageFormat::Png).ok()?;
    Some(picture.to_rgba8())
}
