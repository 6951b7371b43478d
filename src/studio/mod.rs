//! The window: a scenario by hand, its reaction at once; a clip's faults and their correction; variations side by side.
//!
//! [`document`] is what is edited and [`history`] its past; [`state`] is all that the studio knows, and the one place where a [`command`]
//! changes it. Panels read the state and give commands. Simulation and files are [`worker`]s' ([`simulate`], [`errands`]); [`home`] keeps
//! what must outlive a crash. egui and eframe are named in this folder only, and everything it does goes through the calls of the rows above.

pub mod app;
pub mod asking;
pub mod audit_desk;
pub mod audit_view;
pub mod author;
pub mod batch_desk;
pub mod command;
pub mod compass;
pub mod dialogs;
pub mod document;
pub mod errands;
pub mod examples;
pub mod file_dialog;
pub mod history;
pub mod home;
pub mod icons;
pub mod inspector;
pub mod measure;
pub mod menu;
pub mod playback;
pub mod plots;
pub mod rewrite;
pub mod simulate;
pub mod state;
pub mod strength;
pub mod time_map;
pub mod timeline;
pub mod transport;
pub mod viewport;
pub mod worker;

pub use app::Studio;

use eframe::egui::{IconData, ViewportBuilder};
use home::Home;
use measure::{Measure, Times, Told};
use std::path::PathBuf;
use std::sync::PoisonError;
use std::time::Instant;

/// Opens the window and stays until it is closed. With `measure` it plays for so many seconds, ends by itself and tells its times.
/// The error is for a person.
pub fn run(open: Option<PathBuf>, measure: Option<f64>) -> Result<Option<Times>, String> {
    let began = Instant::now();
    let told = Told::default();
    let own = Told::clone(&told);
    let viewport = ViewportBuilder::default()
        .with_title("Surefoot")
        .with_app_id("surefoot")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([880.0, 560.0])
        .with_icon(icon())
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions { viewport, depth_buffer: 0, ..eframe::NativeOptions::default() };
    let home = if measure.is_some() { Home::new(None) } else { Home::of_user() };
    let made = eframe::run_native(
        "surefoot",
        options,
        Box::new(move |context| {
            let studio = Studio::new(context, home, open);
            Ok(Box::new(match measure {
                Some(seconds) => studio.measured(Measure::new(began, seconds, own)),
                None => studio,
            }))
        }),
    );
    made.map_err(|error| {
        let wayland = if cfg!(feature = "desktop") { "" } else { ", on Linux X11 or XWayland (a build with `--features desktop` takes Wayland too)" };
        format!("the window cannot be opened: {error}\n  help: the studio needs a graphics driver and a desktop{wayland}; every other command works without")
    })?;
    let times = told.lock().unwrap_or_else(PoisonError::into_inner).clone();
    Ok(measure.map(|_| times))
}

/// A footprint.
fn icon() -> IconData {
    const SIZE: usize = 32;
    let mut rgba = Vec::with_capacity(SIZE * SIZE * 4);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let (x, y) = (x as f64 / 31.0 - 0.5, y as f64 / 31.0 - 0.5);
            let inside = |cx: f64, cy: f64, rx: f64, ry: f64| ((x - cx) / rx).powi(2) + ((y - cy) / ry).powi(2) < 1.0;
            let print = inside(0.0, 0.28, 0.16, 0.19) || inside(0.02, -0.14, 0.22, 0.26);
            rgba.extend(if print { [46, 160, 103, 255] } else { [0, 0, 0, 0] });
        }
    }
    IconData { rgba, width: SIZE as u32, height: SIZE as u32 }
}
