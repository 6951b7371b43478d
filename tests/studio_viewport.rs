//! The studio's viewport, drawn without a window: the body and its shadow are where they should be, what a frame costs.
//!
//! Pictures go to `target/studio/`. Where no graphics card, real or played, is found, this says so and passes; on CI it fails.

use super::common;
use crate::data;
use eframe::egui_wgpu::{RenderState, RendererOptions, WgpuConfiguration, WgpuSetup};
use eframe::{egui, wgpu};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{WgpuTestRenderer, default_wgpu_setup};
use glam::DVec3;
use image::RgbaImage;
use std::future::Future;
use std::path::Path;
use std::sync::Arc;
use std::task::{Context, Poll, Waker};
use std::time::Instant;
use surefoot::bake::{BakeOptions, Baked, bake};
use surefoot::model::{BodyPose, Scenario};
use surefoot::picture::{NodeTransforms, transforms_of_globals};
use surefoot::rig::{self, Rig};
use surefoot::studio::viewport::{
    self, Figure, Grip, GripPhase, Marks, Quality, Scene, Tracks, Viewport, camera::Side,
};

fn wait<T>(future: impl Future<Output = T>) -> T {
    let mut future = std::pin::pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    loop {
        if let Poll::Ready(done) = future.as_mut().poll(&mut context) {
            return done;
        }
        std::thread::yield_now();
    }
}

/// A device to draw with; none where there is none.
#[expect(clippy::print_stdout, reason = "a test that does nothing says so")]
fn device(quality: Quality) -> Option<RenderState> {
    let setup = default_wgpu_setup();
    let instance = wait(setup.new_instance());
    let backends = match &setup {
        WgpuSetup::CreateNew(setup) => setup.instance_descriptor.backends,
        WgpuSetup::Existing(_) => wgpu::Backends::all(),
    };
    if wait(instance.enumerate_adapters(backends)).is_empty() {
        assert!(std::env::var_os("CI").is_none(), "no wgpu adapter: install mesa-vulkan-drivers");
        println!("skipped: no wgpu adapter");
        return None;
    }
    let configuration = WgpuConfiguration { wgpu_setup: setup, ..Default::default() };
    let state = wait(RenderState::create(&configuration, &instance, None, RendererOptions::PREDICTABLE));
    let state = state.expect("an adapter gives a device");
    viewport::install_with(&state, Some(quality));
    Some(state)
}

const FINE: Quality = Quality::HARDWARE;

/// A scene that owns what it shows.
struct Shown {
    rig: Arc<Rig>,
    baked: Baked,
    tracks: Tracks,
    ghost: Option<f64>,
}

impl Shown {
    fn new(rig: Rig, scenario: &str) -> Shown {
        let scenario = if scenario.is_empty() { Scenario::demo() } else { read(scenario) };
        let baked = bake(&rig, &scenario, &BakeOptions::default()).expect("it bakes");
        Shown { tracks: Tracks::new(&baked), rig: Arc::new(rig), baked, ghost: None }
    }

    fn pose(&self, time: f64) -> NodeTransforms {
        transforms_of_globals(&self.rig, self.rig.sampler(&self.baked.clip).node_globals(time))
    }

    fn ui(&self, viewport: &mut Viewport, ui: &mut egui::Ui, time: f64) -> Option<Grip> {
        let pose = self.pose(time);
        let late = self.pose(time - self.ghost.unwrap_or(0.0));
        let figures =
            [Figure { rig: &self.rig, pose: &pose, ghost: false }, Figure { rig: &self.rig, pose: &late, ghost: true }];
        let figures = if self.ghost.is_some() { &figures[..] } else { &figures[..1] };
        let marks = self.tracks.at(time);
        viewport.ui(ui, &Scene { figures, capsules: &[], props: &self.baked.props, time, marks: &marks })
    }
}

fn read(text: &str) -> Scenario {
    surefoot::model::scenario_text::parse("test", text).unwrap_or_else(|errors| panic!("{errors:?}"))
}

fn save(name: &str, image: &RgbaImage) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/studio");
    std::fs::create_dir_all(&folder).expect("target can be written");
    image.save(folder.join(name)).expect("target can be written");
}

/// A window of that size that shows one thing with one viewport.
fn picture(name: &str, size: [f32; 2], dark: bool, draw: impl FnMut(&mut egui::Ui)) -> Option<RgbaImage> {
    picture_of(name, size, dark, (FINE, 1.0), draw)
}

fn picture_of(
    name: &str,
    size: [f32; 2],
    dark: bool,
    (quality, scale): (Quality, f32),
    draw: impl FnMut(&mut egui::Ui),
) -> Option<RgbaImage> {
    let state = device(quality)?;
    let theme = if dark { egui::Theme::Dark } else { egui::Theme::Light };
    let mut harness = Harness::builder()
        .with_size(size)
        .with_theme(theme)
        .with_pixels_per_point(scale)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_ui(draw);
    harness.run_steps(3);
    let image = harness.render().expect("it renders");
    save(name, &image);
    Some(image)
}

/// The middle of a push.
fn mid_push(baked: &Baked) -> f64 {
    let push = baked.performance.pushes[0];
    push.start + 0.9 * (push.end - push.start)
}

#[test]
fn the_built_in_rig_mid_push_covers_its_share_and_its_shadow_lies_under_it() {
    let shown = Shown::new(common::builtin(), "");
    let time = mid_push(&shown.baked);
    let draw = |name: &str, plain: bool| {
        let mut viewport = Viewport::default();
        if plain {
            viewport.show = viewport::Show::none();
        }
        picture(name, [960.0, 640.0], false, |ui| {
            shown.ui(&mut viewport, ui, time);
        })
    };
    let Some(_) = draw("viewport.png", false) else { return };
    let plain = draw("plain.png", true).expect("a device as before");
    let mut empty = Viewport::default();
    let marks = Marks::default();
    empty.show = viewport::Show::none();
    empty.camera.frame(DVec3::Y * 0.9, 1.12, 1.5);
    let scene = Scene { figures: &[], capsules: &[], props: &[], time, marks: &marks };
    let empty = picture("empty.png", [960.0, 640.0], false, |ui| {
        empty.ui(ui, &scene);
    });
    let _ = empty.expect("a device as before");
    // The body is warm, the ground is cold.
    let warm = |x: u32, y: u32| plain.get_pixel(x, y)[0] > plain.get_pixel(x, y)[2].saturating_add(4);
    let body: Vec<(u32, u32)> =
        (20..620).flat_map(|y| (20..880).map(move |x| (x, y))).filter(|(x, y)| warm(*x, *y)).collect();
    let share = body.len() as f64 / (960.0 * 640.0);
    assert!((0.02..0.25).contains(&share), "{share}");
    let lowest = body.iter().map(|(_, y)| *y).max().expect("some");
    let feet: Vec<u32> = body.iter().filter(|(_, y)| *y > lowest - 40).map(|(x, _)| *x).collect();
    let (left, right) = (*feet.iter().min().expect("some"), *feet.iter().max().expect("some"));
    let dark = |x: u32, y: u32| !warm(x, y) && plain.get_pixel(x, y).0[..3].iter().all(|channel| *channel < 130);
    let near = (left..right).flat_map(|x| (lowest - 40..lowest + 10).map(move |y| (x, y)));
    let shadow = near.filter(|(x, y)| dark(*x, *y)).count();
    assert!(shadow > 200, "{shadow}");
}

#[test]
fn scenes_of_every_kind_are_drawn() {
    let stairs = "duration = 7.0\n[ground]\nkind = \"stairs\"\nrise = 0.17\ntread = 0.29\ncount = 7\n[[walk]]\nstart = 0.5\nspeed = 0.9\n";
    let platform = "duration = 6.0\n[ground]\nkind = \"platform\"\npitch = [[0.5, 0.0], [2.0, 15.0], [4.5, -12.0]]\nroll = [[1.0, 0.0], [3.0, 12.0]]\n";
    let balls = "duration = 4.0\nseed = 5\n[[throw]]\nstart = 0.8\ncount = 5\ninterval = 0.15\nradius = [0.1, 0.2]\ndensity = 50.0\nspeed = 6.0\nfrom = \"front\"\nat = \"chest\"\n";
    let carry = "duration = 4.0\n[[carry]]\nstart = 0.3\nend = 3.5\nmass = [[0.3, 2.0]]\nsize = [0.4, 0.3, 0.3]\n";
    let walk = "duration = 5.0\n[[walk]]\nstart = 0.3\nspeed = 1.3\n";
    for (name, text, time, dark) in [
        ("stairs.png", stairs, 4.4, false),
        ("platform.png", platform, 2.6, false),
        ("balls.png", balls, 1.05, false),
        ("carry.png", carry, 2.0, true),
        ("walk.png", walk, 3.0, false),
        ("walk_dark.png", walk, 3.0, true),
    ] {
        let shown = Shown::new(common::builtin(), text);
        let mut viewport = Viewport::default();
        viewport.show.regions = name.starts_with("walk");
        let drawn = picture(name, [960.0, 640.0], dark, |ui| {
            shown.ui(&mut viewport, ui, time);
        });
        if drawn.is_none() {
            return;
        }
    }
    let mut shown = Shown::new(common::builtin(), "");
    shown.ghost = Some(0.45);
    for (name, from, dark) in [("ghost.png", None, false), ("ghost_top.png", Some(Side::Top), true)] {
        let mut viewport = Viewport::default();
        viewport.show.regions = true;
        let time = mid_push(&shown.baked) + 0.5;
        picture(name, [960.0, 640.0], dark, |ui| {
            shown.ui(&mut viewport, ui, time);
            if let Some(from) = from {
                viewport.camera.look(from);
            }
        });
    }
    for (name, scale) in [("software.png", 1.0), ("hidpi.png", 2.0)] {
        let mut viewport = Viewport::default();
        let time = mid_push(&shown.baked);
        let drawn = picture_of(name, [960.0, 640.0], true, (Quality::SOFTWARE, scale), |ui| {
            shown.ui(&mut viewport, ui, time);
        });
        assert_eq!(drawn.map(|image| image.width()), Some((960.0 * scale) as u32));
    }
    let body = common::builtin().body;
    let pose = shown.baked.performance.timeline.pose_at(1.2);
    let rest = BodyPose::rest(&body);
    let marks = shown.tracks.at(1.2);
    let mut viewport = Viewport::default();
    let capsules = [(&body, &pose, false), (&body, &rest, true)];
    picture("capsules.png", [960.0, 640.0], false, |ui| {
        viewport.ui(ui, &Scene { figures: &[], capsules: &capsules, props: &[], time: 1.2, marks: &marks });
    });
}

#[test]
fn foreign_rigs_are_drawn_with_their_pictures() {
    for (file, name) in [
        ("rigs/kaykit_Knight.glb", "knight.png"),
        ("rigs/godette_vrm0.vrm", "godette.png"),
        ("rigs/khronos_CesiumMan.gltf", "cesium.png"),
        ("rigs/gdquest_mannequiny.glb", "mannequiny.png"),
    ] {
        let Some(path) = data::file(file) else { continue };
        let shown = Shown::new(rig::load(&path).expect("it loads"), "");
        let mut viewport = Viewport::default();
        let time = mid_push(&shown.baked);
        let drawn = picture(name, [960.0, 640.0], false, |ui| {
            shown.ui(&mut viewport, ui, time);
        });
        if drawn.is_none() {
            return;
        }
    }
}

#[test]
fn a_drag_from_the_character_is_a_push_and_one_beside_it_turns_the_view() {
    let shown = Shown::new(common::builtin(), "");
    let grips = std::cell::RefCell::new(Vec::new());
    let yaw = std::cell::Cell::new(0.0);
    let mut viewport = Viewport::default();
    // Without a renderer: nothing is drawn, all else works.
    let mut harness = Harness::builder().with_size([960.0, 640.0]).build_ui(|ui| {
        grips.borrow_mut().extend(shown.ui(&mut viewport, ui, 0.0));
        yaw.set(viewport.camera.yaw);
    });
    harness.run_steps(2);
    let middle = harness.get_by_label("Viewport").rect().center();
    let drag = |harness: &mut Harness, from: egui::Pos2, by: egui::Vec2| {
        harness.hover_at(from);
        harness.run_steps(1);
        harness.drag_at(from);
        harness.run_steps(1);
        for step in 1..=8 {
            harness.hover_at(from + by * step as f32 / 8.0);
            harness.run_steps(1);
        }
        harness.drop_at(from + by);
        harness.run_steps(2);
    };
    drag(&mut harness, middle - egui::vec2(0.0, 60.0), egui::vec2(192.0, 0.0));
    let all: Vec<Grip> = grips.borrow_mut().drain(..).collect();
    let phases: Vec<GripPhase> = all.iter().map(|grip| grip.phase).collect();
    assert_eq!((phases.first(), phases.last()), (Some(&GripPhase::Started), Some(&GripPhase::Released)), "{phases:?}");
    assert_eq!(phases.iter().filter(|phase| **phase != GripPhase::Held).count(), 2);
    let last = all[all.len() - 1];
    // The pointer went 30 % of the height to the right of where it was, near the bone.
    assert!((last.force.length() - 300.0).abs() < 60.0 && last.force.y == 0.0, "{last:?}");
    let before = yaw.get();
    drag(&mut harness, egui::pos2(80.0, 200.0), egui::vec2(100.0, 10.0));
    assert!(grips.borrow().is_empty() && (yaw.get() - before).abs() > 0.3);
}

/// Costs of frames; prints them. `SUREFOOT_FRAMES` says how many.
#[test]
#[expect(clippy::print_stdout, reason = "the costs are what it is for")]
fn a_frame_costs_little() {
    let count: u32 =
        std::env::var("SUREFOOT_FRAMES").ok().and_then(|count| count.parse().ok()).unwrap_or(12_u32).max(3);
    let heaviest = ["rigs/gdquest_mannequiny.glb", "rigs/kaykit_Knight.glb", "rigs/m2m_human_base_animations.glb"];
    let mut rigs = vec![("built-in".to_owned(), common::builtin())];
    for file in heaviest {
        rigs.extend(data::file(file).map(|path| (file.to_owned(), rig::load(&path).expect("it loads"))));
    }
    rigs.push(("built-in, heavy".to_owned(), heavy(common::builtin(), 60_000)));
    for (name, rig) in rigs {
        let Some(state) = device(Quality::SOFTWARE) else { return };
        let triangles: usize = rig.mesh.iter().map(|part| part.indices.len() / 3).sum();
        let shown = Shown::new(rig, "");
        let mut viewport = Viewport::default();
        let poses: Vec<NodeTransforms> = (0..count).map(|at| shown.pose(0.5 + f64::from(at) * 0.02)).collect();
        let context = egui::Context::default();
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 800.0))),
            ..Default::default()
        };
        let window = state.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 1280, height: 800, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: state.target_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let window = window.create_view(&Default::default());
        let screen = eframe::egui_wgpu::ScreenDescriptor { size_in_pixels: [1280, 800], pixels_per_point: 1.0 };
        let (mut ui_time, mut prepare_time) = (0.0, 0.0);
        let mut whole = Instant::now();
        for (at, pose) in poses.iter().enumerate() {
            if at == 2 {
                whole = Instant::now();
                (ui_time, prepare_time) = (0.0, 0.0);
            }
            let time = 0.5 + at as f64 * 0.02;
            let marks = shown.tracks.at(time);
            let figures = [Figure { rig: &shown.rig, pose, ghost: false }];
            let scene = Scene { figures: &figures, capsules: &[], props: &shown.baked.props, time, marks: &marks };
            let mut output = context.run_ui(input.clone(), |ui| {
                let started = Instant::now();
                viewport.ui(ui, &scene);
                ui_time += started.elapsed().as_secs_f64();
            });
            let jobs = context.tessellate(std::mem::take(&mut output.shapes), 1.0);
            let mut renderer = state.renderer.write();
            output.textures_delta.set.drain().for_each(|(id, images)| {
                images.iter().for_each(|image| renderer.update_texture(&state.device, &state.queue, id, image));
            });
            let started = Instant::now();
            let mut encoder = state.device.create_command_encoder(&Default::default());
            renderer.update_buffers(&state.device, &state.queue, &mut encoder, &jobs, &screen);
            prepare_time += started.elapsed().as_secs_f64();
            let mut pass = encoder
                .begin_render_pass(&wgpu::RenderPassDescriptor {
                    color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                        view: &window,
                        resolve_target: None,
                        depth_slice: None,
                        ops: Default::default(),
                    })],
                    ..Default::default()
                })
                .forget_lifetime();
            renderer.render(&mut pass, &jobs, &screen);
            drop(pass);
            state.queue.submit([encoder.finish()]);
            let waits = wgpu::PollType::Wait { submission_index: None, timeout: None };
            state.device.poll(waits).expect("the device works");
        }
        let frames = f64::from(count - 2);
        assert!(ui_time + prepare_time < 0.02 * frames, "{name}: {ui_time} s, {prepare_time} s");
        let calls = viewport::draw_calls(&state).expect("it drew");
        // Besides the materials: arrows, two parts of the ground, the sky, the marks.
        assert!(calls as usize <= materials(&shown.rig) + 5, "{name}: {calls}");
        println!(
            "{name}: {triangles} triangles, {} materials, {} draws; ui {:.2} ms, prepare {:.2} ms; {:.1} fps on {}",
            materials(&shown.rig),
            calls,
            ui_time / frames * 1e3,
            prepare_time / frames * 1e3,
            frames / whole.elapsed().as_secs_f64(),
            state.adapter.get_info().name,
        );
    }
}

fn materials(rig: &Rig) -> usize {
    let of = |part: &surefoot::rig::MeshPart| (part.base_color.map(f32::to_bits), part.base_texture);
    rig.mesh.iter().map(of).collect::<std::collections::BTreeSet<_>>().len()
}

/// The rig with each triangle split until it has that many.
fn heavy(mut rig: Rig, triangles: usize) -> Rig {
    while rig.mesh.iter().map(|part| part.indices.len() / 3).sum::<usize>() < triangles {
        for part in &mut rig.mesh {
            let corners = std::mem::take(&mut part.indices);
            for triangle in corners.chunks_exact(3) {
                let [a, b, c] = [triangle[0] as usize, triangle[1] as usize, triangle[2] as usize];
                let middle = part.positions.len() as u32;
                let third = |of: &[DVec3]| (of[a] + of[b] + of[c]) / 3.0;
                let (at, normal) = (third(&part.positions), third(&part.normals).normalize());
                part.positions.push(at);
                part.normals.push(normal);
                part.weights.push(part.weights[a]);
                if !part.uvs.is_empty() {
                    part.uvs.push(part.uvs[a]);
                }
                let [a, b, c] = [a as u32, b as u32, c as u32];
                part.indices.extend([a, b, middle, b, c, middle, c, a, middle]);
            }
        }
    }
    rig
}
