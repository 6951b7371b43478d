//! The studio's audit desk, driven without a window and found by label: flags of a clip with planted faults, jumps from flag to flag, a
//! correction rejected and others accepted, what is written then; files that are broken. Draws its pictures into `target/studio/`.

use crate::audit_faults;
use crate::correct::{file_with, read, walk_bytes};
use eframe::egui::{self, Key, Theme, Ui, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot::maths::seed::Seed;
use surefoot::mocap::Options;
use surefoot::model::Capture;
use surefoot::studio::audit_desk::repairs::Decision;
use surefoot::studio::audit_desk::{AuditDesk, AuditRequest, AuditScene};

/// The desk in a window of its own.
struct Window {
    desk: AuditDesk,
    requests: Vec<AuditRequest>,
    /// Moments that the view was given: bodies with ghosts, and meshes.
    seen: (usize, usize),
}

fn window<'a>(size: [f32; 2], points: f32, theme: Theme) -> Harness<'a, Window> {
    let desk = AuditDesk::new(Arc::new(|| {}));
    let window = Window { desk, requests: Vec::new(), seen: (0, 0) };
    let builder = Harness::builder().with_size(size).with_pixels_per_point(points).with_theme(theme).with_step_dt(0.02);
    builder.build_ui_state(
        |ui: &mut Ui, window: &mut Window| {
            let mut seen = window.seen;
            let asked = window.desk.ui(ui, &mut |ui, scene| {
                seen.0 += usize::from(scene.ghost.is_some());
                seen.1 += usize::from(scene.nodes.is_some());
                sticks(ui, scene);
            });
            window.seen = seen;
            window.requests.extend(asked);
        },
        window,
    )
}

/// What stands where the 3D view will be: bodies of sticks from the front, the ghost behind.
fn sticks(ui: &mut Ui, scene: &AuditScene) {
    let rect = ui.available_rect_before_wrap();
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, ui.visuals().extreme_bg_color);
    let middle = scene.pose.hips;
    let place = |at: glam::DVec3| {
        let (x, y) = ((at.z - middle.z) - 0.5 * (at.x - middle.x), at.y - scene.floor);
        let scale = f64::from(rect.height()) / 2.4;
        pos2(rect.center().x + (x * scale) as f32, rect.bottom() - 50.0 - (y * scale) as f32)
    };
    for (pose, width) in [(scene.ghost.as_ref(), 1.0), (Some(&scene.pose), 4.0)] {
        let Some(pose) = pose else { continue };
        let places = pose.positions(scene.body);
        for (joint, above) in scene.body.joints.iter().enumerate().filter_map(|(joint, it)| Some((joint, it.parent?))) {
            let stroke = egui::Stroke::new(width, ui.visuals().text_color());
            painter.line_segment([place(places[joint]), place(places[above])], stroke);
        }
    }
    for sole in scene.overlay.soles.iter().chain(&scene.overlay.prints) {
        let line = sole.whole.iter().map(|point| place(*point)).collect();
        painter.add(egui::Shape::closed_line(line, egui::Stroke::new(1.0, ui.visuals().weak_text_color())));
    }
}

/// Paints until the work beside the window is done.
fn settle(harness: &mut Harness<Window>) {
    let started = Instant::now();
    loop {
        harness.step();
        let window = harness.state_mut();
        window.desk.tick();
        if !window.desk.is_busy() {
            break;
        }
        assert!(started.elapsed() < Duration::from_secs(300), "still at work");
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.run_steps(3);
}

/// A walk whose foot slides once, and which hovers at another time.
pub fn spoiled(folder: &Path) -> PathBuf {
    let file = read("walk.glb", walk_bytes());
    let reading = file.reading(1, &Options::default()).expect("a clip");
    let both = (0..12).flat_map(|one| (0..12).map(move |other| (one, other))).find_map(|(one, other)| {
        let slid = audit_faults::slide(&reading.capture, 0.2, &mut Seed::new(one))?;
        let lifted = audit_faults::lifted(&slid.capture, 0.06, &mut Seed::new(other))?;
        let apart = |one: (usize, usize), other: (usize, usize)| one.1 + 30 < other.0;
        (apart(slid.span, lifted.span) || apart(lifted.span, slid.span)).then_some(lifted.capture)
    });
    let path = folder.join("spoiled.glb");
    std::fs::write(&path, file_with(&file, &reading, 1, &both.expect("room for both"))).expect("written");
    path
}

pub fn walk_of(path: &Path) -> Capture {
    let bytes = std::fs::read(path).expect("it is there");
    read("spoiled.glb", &bytes).capture(1, &Options::default()).expect("a clip")
}

/// The desk with the walk of that file.
fn opened<'a>(path: &Path, size: [f32; 2], points: f32, theme: Theme) -> Harness<'a, Window> {
    let mut harness = window(size, points, theme);
    harness.state_mut().desk.open(path.to_owned());
    settle(&mut harness);
    // The file's first clip is a shove.
    harness.get_by_label("Clip").click();
    harness.run_steps(4);
    let walk = harness.state().desk.state().clips[1].clone();
    harness.get_by_label(&walk).click();
    harness.run_steps(2);
    settle(&mut harness);
    harness
}

#[test]
fn flags_are_seen_jumped_to_and_decided_and_what_is_saved_is_what_was_accepted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = spoiled(folder.path());
    let mut harness = opened(&path, [1280.0, 800.0], 1.0, Theme::Dark);
    let state = |harness: &Harness<Window>| harness.state().desk.state().clone();
    let before = state(&harness);
    let shown = before.shown.as_ref().expect("a clip");
    let flags = shown.before.findings.flags.clone();
    assert!(flags.len() >= 2, "{flags:?}");
    for flag in &flags {
        let foot = flag.foot.map(|foot| format!(" {foot}")).unwrap_or_default();
        harness.get_by_label(&format!("{} {}-{}{foot}", flag.rule.name(), flag.start, flag.end));
    }
    assert!(shown.skinned.is_some(), "the file's own mesh");

    for flag in &flags {
        harness.key_press(Key::N);
        harness.run_steps(2);
        let now = state(&harness);
        assert_eq!(now.flags()[now.flag.expect("one is looked at")], *flag);
        assert_eq!(now.shown.as_ref().map(|shown| shown.before.frame(now.playback.time)), Some(flag.start));
    }
    harness.get_by_label("Previous flag").click();
    harness.run_steps(2);
    assert_eq!(state(&harness).flag, Some(flags.len() - 2));

    let slide = flags.iter().position(|flag| flag.rule.name() == "foot-slide").expect("it slides");
    let flag = &flags[slide];
    let name = format!("foot-slide {}-{} {}", flag.start, flag.end, flag.foot.expect("a foot"));
    harness.get_by_label(&name).click();
    harness.run_steps(2);
    assert_eq!(state(&harness).flag, Some(slide));
    harness.get_by_label("Reject").click();
    harness.run_steps(2);
    settle(&mut harness);
    harness.get_by_label("Accept all").click();
    harness.run_steps(2);
    let decided = state(&harness);
    let repairs = decided.now().expect("corrections");
    assert_eq!((repairs.count(Decision::Rejected), repairs.count(Decision::Pending)), (1, 0));
    assert!(repairs.count(Decision::Accepted) >= 1 && harness.state().seen.0 > 0 && harness.state().seen.1 > 0);

    harness.get_by_label("Save corrected…").click();
    harness.run_steps(2);
    let asked = harness.state().requests.last().cloned();
    let Some(AuditRequest::SaveDialog(output)) = asked else { panic!("{asked:?}") };
    assert_eq!(output, folder.path().join("spoiled-corrected.glb"));
    harness.state_mut().desk.save(output.clone());
    settle(&mut harness);
    harness.get_by_label_contains("Saved");

    let (was, is) = (walk_of(&path), walk_of(&output));
    let off = |frame: usize| was.at(frame).iter().zip(is.at(frame)).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let within = |decision: Decision, frame: usize| {
        repairs.list.iter().any(|repair| repair.decision == decision && (repair.start..=repair.end).contains(&frame))
    };
    let mut moved = 0;
    for frame in 0..was.frames() {
        if within(Decision::Accepted, frame) {
            moved += usize::from(off(frame) > 0.01);
        } else {
            assert!(off(frame) < 1e-6, "frame {frame} moved {} m", off(frame));
        }
    }
    assert!(moved > 5, "{moved} frames moved");
    assert!((flag.start..=flag.end).all(|frame| within(Decision::Rejected, frame)));
    assert!(walk_bytes().len() < std::fs::read(&output).expect("written").len());
}

#[test]
fn a_footprint_leads_to_its_frame_and_a_rejection_can_be_taken_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = spoiled(folder.path());
    let mut harness = opened(&path, [1280.0, 800.0], 1.0, Theme::Light);
    let desk = |harness: &Harness<Window>| harness.state().desk.state().clone();
    let steps = desk(&harness).shown.expect("a clip").motion(desk(&harness).preview).findings.steps.clone();
    let name = format!("step 2 {} {:.1} cm", steps[1].foot, 100.0 * steps[1].error_m);
    harness.get_by_label(&name).click();
    harness.run_steps(2);
    let now = desk(&harness);
    let frame = now.shown.as_ref().map(|shown| shown.before.frame(now.playback.time));
    assert_eq!((now.step, frame), (Some(1), Some(steps[1].touch_down)));

    harness.get_by_label("Next flag").click();
    harness.run_steps(2);
    let all = desk(&harness).now().expect("corrections").clone();
    for key in [Key::R, Key::R] {
        harness.key_press(key);
        harness.run_steps(2);
        settle(&mut harness);
    }
    assert_eq!(desk(&harness).now(), Some(&all), "rejected and taken back");
    harness.get_by_label("Accept").click();
    harness.run_steps(2);
    settle(&mut harness);
    let now = desk(&harness);
    let repairs = now.now().expect("corrections");
    assert_eq!((repairs.list.len(), repairs.count(Decision::Accepted)), (all.list.len(), 1));
}

#[test]
fn the_timeline_is_scrubbed_and_zoomed_about_the_pointer() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = opened(&spoiled(folder.path()), [1280.0, 800.0], 1.0, Theme::Dark);
    let desk = |harness: &Harness<Window>| harness.state().desk.state().clone();
    let rect = harness.get_by_label("Timeline").rect();
    let at = |share: f32| pos2(rect.left() + share * rect.width(), rect.top() + 6.0);
    let mut times = Vec::new();
    harness.hover_at(at(0.4));
    harness.drag_at(at(0.4));
    for share in [0.4, 0.6, 0.8] {
        harness.hover_at(at(share));
        harness.run_steps(2);
        times.push(desk(&harness).playback.time);
    }
    harness.drop_at(at(0.8));
    harness.run_steps(2);
    let frames: Vec<f64> = times.iter().map(|time| time * 30.0).collect();
    assert!(times.windows(2).all(|pair| pair[1] > pair[0] + 0.5), "{times:?}");
    assert!(frames.iter().all(|frame| (frame - frame.round()).abs() < 1e-6), "{frames:?}");
    let whole = desk(&harness).window;
    harness.hover_at(at(0.5));
    harness.event(egui::Event::Zoom(2.0));
    harness.run_steps(3);
    let near = desk(&harness).window;
    assert!((near.span - 0.5 * whole.span).abs() < 1e-6 && near.start > whole.start, "{near:?}");
    // A jump to what is out of sight brings it there.
    harness.key_press(Key::Home);
    harness.key_press(Key::P);
    harness.run_steps(3);
    let now = desk(&harness);
    assert!((now.window.start..now.window.start + now.window.span).contains(&now.playback.time));
}

#[test]
fn a_broken_file_says_what_to_do_and_the_next_one_opens() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = folder.path().join("broken.bvh");
    std::fs::write(&broken, "HIERARCHY\nROOT hips\n{\nOFFSET 0 0").expect("written");
    let mut harness = window([1280.0, 800.0], 1.0, Theme::Dark);
    harness.run_steps(2);
    harness.get_by_label("Choose a clip…").click();
    harness.run_steps(2);
    assert_eq!(harness.state().requests, [AuditRequest::OpenDialog]);
    for path in [broken, folder.path().join("nowhere.glb"), folder.path().to_owned()] {
        harness.state_mut().desk.open(path.clone());
        settle(&mut harness);
        let fault = harness.state().desk.state().fault.clone().expect("a message");
        assert!(fault.starts_with("Cannot open") && fault.lines().count() > 1, "{}: {fault}", path.display());
        harness.get_by_label_contains("Cannot open");
    }
    harness.get_by_label("Dismiss").click();
    harness.run_steps(2);
    let path = spoiled(folder.path());
    harness.state_mut().desk.open(path.clone());
    settle(&mut harness);
    assert!(harness.state().desk.state().shown.is_some() && harness.state().desk.state().fault.is_none());
    // Nothing is accepted, and the file that is open is never written.
    harness.state_mut().desk.save(folder.path().join("out.glb"));
    settle(&mut harness);
    harness.get_by_label_contains("accept a correction first");
    assert!(!folder.path().join("out.glb").exists());
}

#[test]
fn its_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = spoiled_thrice(folder.path());
    for (name, theme, points) in [("dark", Theme::Dark, 1.0), ("light", Theme::Light, 2.0)] {
        let mut harness = opened(&path, [1280.0, 800.0], points, theme);
        for key in [Key::N, Key::A, Key::N, Key::R, Key::N] {
            harness.key_press(key);
            harness.run_steps(2);
            settle(&mut harness);
        }
        if !drawn(&mut harness, &format!("audit_{name}")) {
            return;
        }
    }
}

/// The same walk with a plant set aside too.
fn spoiled_thrice(folder: &Path) -> PathBuf {
    let path = spoiled(folder);
    let file = read("spoiled.glb", &std::fs::read(&path).expect("written"));
    let reading = file.reading(1, &Options::default()).expect("a clip");
    let moved = (0..9).find_map(|seed| {
        audit_faults::moved_plant(&reading.capture, audit_faults::Way::Outward, 0.2, &mut Seed::new(seed))
    });
    std::fs::write(&path, file_with(&file, &reading, 1, &moved.expect("a step").capture)).expect("written");
    path
}

/// Saves what is painted; false where this machine has nothing to draw with.
fn drawn(harness: &mut Harness<Window>, name: &str) -> bool {
    let picture = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| harness.render()));
    let Ok(Ok(picture)) = picture else {
        assert!(std::env::var_os("CI").is_none(), "no wgpu adapter");
        eprintln!("skipped: no wgpu adapter");
        return false;
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/studio");
    std::fs::create_dir_all(&folder).expect("a folder");
    picture.save(folder.join(format!("{name}.png"))).expect("saved");
    let colors: std::collections::BTreeSet<[u8; 4]> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(colors.len() > 100, "{} colours", colors.len());
    true
}
