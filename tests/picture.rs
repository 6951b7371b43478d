//! Contact sheets of real rigs: the body that is drawn is the rig's own, whole, upright and in its colours.

use glam::DAffine3;
use image::RgbaImage;
use surefoot::model::ClipReport;
use surefoot::picture::{Layout, SheetInput, choose_moments, png, sheet};
use surefoot::rig::{Rig, load::load};

/// A file of the shared test data, if it is there.
fn data(path: &str) -> Option<std::path::PathBuf> {
    let beside = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let folder = std::env::var_os("SUREFOOT_DATA").map_or(beside, Into::into);
    let found = folder.join(path);
    if !found.exists() {
        eprintln!("skipped: {} is not there", found.display());
        return None;
    }
    Some(found)
}

/// A clip of 1 s in which nothing happens.
fn still() -> ClipReport {
    serde_json::from_value(serde_json::json!({
        "version": 1, "generator": "test", "fps": 30.0, "duration": 1.0, "seed": 0, "root_motion": "root",
        "drive": "stepper", "scenario": "nothing happens", "outcome": "still", "steps": 0,
        "body": { "mass": 70.0, "height": 1.7 }, "contacts": [], "events": [], "disturbances": [],
        "assist": { "peak_nm": 0.0, "rms_nm": 0.0, "peak_n": 0.0, "rms_n": 0.0 },
        "plausibility": { "score": 1.0, "zmp_inside": 1.0, "zmp_outside_p95_cm": 0.0, "friction_p99": 0.0,
            "vertical_min": 1.0, "residual_force": 0.0, "residual_moment": 0.0, "slip_max_mm": 0.0,
            "penetration_max_mm": 0.0, "peak_ankle_speed": 0.0, "speed_ratio": 0.0, "notes": [] }
    }))
    .expect("the report's own format")
}

/// One moment of the rig at its bind pose, `raised` m over the ground.
fn draw(rig: &Rig, raised: f64) -> RgbaImage {
    let report = still();
    let up = DAffine3::from_translation(glam::DVec3::Y * raised);
    let pose = |_: f64| vec![up; rig.nodes.len()];
    let moments = choose_moments(&report, 1);
    let layout = Layout { width: 420, columns: 1, view: 400, plan: 0 };
    sheet(&SheetInput { rig, pose: &pose, report: &report, overlay: None, props: &[], moments, layout })
}

/// How many pixels are clearly not the sky or ground that the left edge of their row shows, and the box that holds them: x
/// from, to, y from, to. The corners with words are left out.
fn body(image: &RgbaImage, rows: std::ops::Range<u32>) -> (usize, [u32; 4]) {
    let mut count = 0;
    let mut bounds = [u32::MAX, 0, u32::MAX, 0];
    for (x, y, pixel) in image.enumerate_pixels().filter(|(_, y, _)| (rows.start + 22..rows.end - 22).contains(y)) {
        let backdrop = image.get_pixel(3, y);
        if (0..3).any(|channel| pixel[channel].abs_diff(backdrop[channel]) > 45) {
            count += 1;
            bounds = [bounds[0].min(x), bounds[1].max(x), bounds[2].min(y), bounds[3].max(y)];
        }
    }
    (count, bounds)
}

#[test]
fn every_rig_fills_its_picture_from_head_to_foot() {
    let rigs = [
        "m2m_human_male.glb",
        "gdquest_mannequiny.glb",
        "kaykit_Knight.glb",
        "godette_vrm0.vrm",
        "m2m_ue_names_no_animation.glb",
        "vrm1_debug_robot.vrm",
        "vrm_tiny_basic_armature.vrm",
    ];
    for name in rigs {
        let Some(path) = data(&format!("rigs/{name}")) else { return };
        let rig = load(&path).expect(name);
        let image = draw(&rig, 0.0);
        for view in [58..458, 459..859] {
            let (count, [left, right, top, bottom]) = body(&image, view.clone());
            let (tall, wide) = (bottom.saturating_sub(top), right.saturating_sub(left));
            assert!(count > 5_000, "{name}: {count} pixels of body");
            assert!(tall > 180 && bottom > view.end - 100, "{name}: {top}..{bottom} of {view:?}");
            assert!(wide > 30 && left > 3 && right < 417, "{name}: {left}..{right}");
            let middle = f64::from(left + right) / 2.0;
            assert!((middle - 210.0).abs() < 60.0, "{name}: stands at {middle}");
        }
    }
}

#[test]
fn a_sheet_of_a_real_rig_is_the_same_bytes_every_time() {
    let Some(path) = data("rigs/m2m_human_male.glb") else { return };
    let rig = load(&path).expect("a rig");
    let first = png(&draw(&rig, 0.0));
    assert!(first.len() > 10_000);
    assert_eq!(first, png(&draw(&load(&path).expect("a rig"), 0.0)));
    assert_ne!(first, png(&draw(&rig, 0.1)), "a body 10 cm in the air is another picture");
}
