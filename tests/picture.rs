//! Contact sheets of real rigs: the body that is drawn is the rig's own, whole, upright and in its colours.

use crate::data;
use glam::DAffine3;
use image::RgbaImage;
use surefoot::model::ClipReport;
use surefoot::picture::{Layout, SheetInput, choose_moments, png, sheet};
use surefoot::rig::{Rig, load::load};

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
        let Some(path) = data::file(&format!("rigs/{name}")) else { return };
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
    let Some(path) = data::file("rigs/m2m_human_male.glb") else { return };
    let rig = load(&path).expect("a rig");
    let first = png(&draw(&rig, 0.0));
    assert!(first.len() > 10_000);
    assert_eq!(first, png(&draw(&load(&path).expect("a rig"), 0.0)));
    assert_ne!(first, png(&draw(&rig, 0.1)), "a body 10 cm in the air is another picture");
}

/// What a baked file's clip stood on, read back from its bytes.
fn seen(ground: &str, with_props: bool) -> surefoot::picture::Stage {
    use surefoot::bake::{BakeOptions, bake};
    use surefoot::rig::{clips::read_clip, load_bytes, mannequin::BUILTIN};
    let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
    let rig = load_bytes("builtin", BUILTIN, &alone, None).expect("the built-in rig loads");
    let text = format!(
        "title = \"seen\"\nduration = 5.0\n[ground]\n{ground}\n[[walk]]\nstart = 0.3\nspeed = 0.5\n[[walk]]\nstart = 4.5\nspeed = 0.0\n"
    );
    let scenario = surefoot::model::scenario_text::parse("seen", &text).expect("a scenario");
    let baked = bake(&rig, &scenario, &BakeOptions::default()).expect("it bakes");
    let props = if with_props { baked.props.as_slice() } else { &[] };
    let file = surefoot::export::glb_with_props(&rig, &[(baked.clip, baked.report.clone())], props).expect("written");
    let again = load_bytes("baked", &file.bytes, &alone, None).expect("it loads again");
    let clip = read_clip(&again, again.document.list("animations").len() - 1).expect("the clip");
    surefoot::picture::Stage::at(&surefoot::picture::seen_in_file(&again, &clip, &baked.report), 2.0)
}

#[test]
fn a_baked_files_sheet_stands_on_the_ground_that_it_was_made_on() {
    let height = |stage: &surefoot::picture::Stage, z: f64| stage.height(glam::DVec2::new(0.05, z));
    for with_props in [true, false] {
        assert!(seen("kind = \"flat\"", with_props).is_flat(), "props {with_props}");
        let slope = seen("kind = \"slope\"\nangle = 10.0", with_props);
        let stairs = seen("kind = \"stairs\"\nrise = 0.17\ntread = 0.3\ncount = 4", with_props);
        for z in [-0.5, 0.4, 1.0, 1.7] {
            let off = height(&slope, z) - z * 10_f64.to_radians().tan();
            assert!(off.abs() < 2e-3, "props {with_props}: the slope at {z} is {off} m off");
        }
        for (z, treads) in [(0.5, 0.0), (1.15, 1.0), (1.45, 2.0)] {
            let off = height(&stairs, z) - 0.17 * treads;
            assert!(off.abs() < 2e-3, "props {with_props}: the tread at {z} is {off} m off");
        }
    }
}
