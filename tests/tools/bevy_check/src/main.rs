//! Loads a baked clip with Bevy's glTF loader, plays it at 60 Hz without a window and compares the events that arrive with the sidecar's:
//!   cargo run -- FOLDER NAME.glb
//! FOLDER holds NAME.glb, NAME.events.json and surefoot_bevy.rs as `surefoot bake --engine bevy` writes them; the helper is compiled
//! from target/made/engines, where .ci/run puts them. Twice: once to the end, once with a loop.

use bevy::animation::graph::{AnimationGraph, AnimationGraphHandle};
use bevy::animation::{AnimationPlayer, AnimationPlugin, RepeatAnimation};
use bevy::app::{App, TaskPoolPlugin};
use bevy::asset::{AssetApp, AssetPlugin, AssetServer, Assets, Handle, LoadState};
use bevy::ecs::prelude::*;
use bevy::gltf::{Gltf, GltfPlugin};
use bevy::time::{TimePlugin, TimeUpdateStrategy};
use serde_json::Value;
use std::process::ExitCode;
use std::time::Duration;
use surefoot_bevy::{SurefootContact, SurefootEvent, SurefootPlugin};

#[path = "../../../../target/made/engines/surefoot_bevy.rs"]
mod surefoot_bevy;

/// s, of a frame.
const FRAME: f64 = 1.0 / 60.0;

/// What arrived: the app's clock, the time that the event says, its name, its foot.
#[derive(Resource, Default)]
struct Arrived(Vec<(f64, f64, String, Option<String>)>);

/// s since the player started.
#[derive(Resource, Default)]
struct Clock(f64);

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (Some(folder), Some(name)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: bevy_check FOLDER NAME.glb");
        return ExitCode::from(2);
    };
    let folder = std::fs::canonicalize(&folder).expect("the folder is there");
    let sidecar = std::fs::read(folder.join(&name).with_extension("events.json")).expect("the sidecar is there");
    let reports: Value = serde_json::from_slice(&sidecar).expect("the sidecar is JSON");
    let (clip, report) = reports.as_object().and_then(|reports| reports.iter().next()).expect("one report");

    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), TimePlugin));
    app.add_plugins(AssetPlugin { file_path: folder.display().to_string(), ..AssetPlugin::default() });
    app.add_plugins((
        bevy::image::ImagePlugin::default(),
        bevy::mesh::MeshPlugin,
        bevy::transform::TransformPlugin,
        bevy::world_serialization::WorldSerializationPlugin,
        AnimationPlugin,
        GltfPlugin::default(),
        SurefootPlugin,
    ));
    app.init_asset::<bevy::mesh::skinning::SkinnedMeshInverseBindposes>();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(FRAME)));
    app.init_resource::<Arrived>().init_resource::<Clock>();
    app.finish();
    app.cleanup();

    let handle: Handle<Gltf> = app.world().resource::<AssetServer>().load(name.clone());
    let started = std::time::Instant::now();
    let animation = loop {
        app.update();
        if let LoadState::Failed(error) = app.world().resource::<AssetServer>().load_state(&handle) {
            eprintln!("Bevy does not load {name}: {error}");
            return ExitCode::FAILURE;
        }
        if let Some(gltf) = app.world().resource::<Assets<Gltf>>().get(&handle) {
            break gltf.named_animations.get(clip.as_str()).expect("the clip is there by its name").clone();
        }
        assert!(started.elapsed() < Duration::from_secs(60), "{name} is not loaded after a minute");
        std::thread::sleep(Duration::from_millis(5));
    };
    let duration = report["duration"].as_f64().expect("a duration");
    let length = f64::from(app.world().resource::<Assets<bevy::animation::AnimationClip>>().get(&animation).expect("loaded").duration());
    assert!((length - duration).abs() < 1e-3, "the clip lasts {length} s in Bevy, {duration} s by its report");

    app.add_observer(|event: On<SurefootEvent>, clock: Res<Clock>, players: Query<&AnimationPlayer>, mut arrived: ResMut<Arrived>| {
        assert!(players.contains(event.trigger().target), "the target is the player's entity");
        arrived.0.push((clock.0, f64::from(event.time), event.name.clone(), event.foot.clone()));
    });
    app.add_observer(|event: On<SurefootContact>, clock: Res<Clock>, mut arrived: ResMut<Arrived>| {
        let name = format!("{} {}", event.part, if event.begins { "begins" } else { "ends" });
        arrived.0.push((clock.0, f64::from(event.time), name, Some(event.foot.clone())));
    });
    let mut bad = 0;
    for loops in [1, 2] {
        let (graph, index) = AnimationGraph::from_clip(animation.clone());
        let graph = app.world_mut().resource_mut::<Assets<AnimationGraph>>().add(graph);
        let mut player = AnimationPlayer::default();
        player.play(index).set_repeat(RepeatAnimation::Count(loops));
        app.world_mut().resource_mut::<Arrived>().0.clear();
        app.world_mut().resource_mut::<Clock>().0 = 0.0;
        let entity = app.world_mut().spawn((player, AnimationGraphHandle(graph))).id();
        for _ in 0..(f64::from(loops) * duration / FRAME) as usize + 10 {
            app.world_mut().resource_mut::<Clock>().0 += FRAME;
            app.update();
        }
        bad += compare(report, f64::from(loops), duration, &app.world().resource::<Arrived>().0);
        app.world_mut().entity_mut(entity).despawn();
    }
    println!("{name} in Bevy: {}", if bad == 0 { "ok" } else { "BAD" });
    if bad == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Every event of every loop once, not before its time and at most two frames after it: how many are not so.
fn compare(report: &Value, loops: f64, duration: f64, arrived: &[(f64, f64, String, Option<String>)]) -> usize {
    let mut wanted: Vec<(f64, String, Option<String>)> = Vec::new();
    let text = |object: &Value, name: &str| object[name].as_str().map(str::to_owned);
    for event in report["events"].as_array().expect("events") {
        wanted.push((event["time"].as_f64().expect("a time"), text(event, "name").expect("a name"), text(event, "foot")));
    }
    for contact in report["contacts"].as_array().expect("contacts") {
        let part = text(contact, "part").expect("a part");
        for (key, does) in [("start", "begins"), ("end", "ends")] {
            wanted.push((contact[key].as_f64().expect("a time"), format!("{part} {does}"), text(contact, "foot")));
        }
    }
    let mut bad = 0;
    let mut latest: f64 = 0.0;
    for (time, name, foot) in &wanted {
        let found: Vec<f64> = arrived
            .iter()
            .filter(|(_, said, what, whose)| (said - time).abs() < 1e-3 && what == name && whose == foot)
            .map(|(clock, ..)| *clock)
            .collect();
        let due: Vec<f64> = (0..loops as usize).map(|turn| turn as f64 * duration + time).collect();
        let late = found.iter().zip(&due).map(|(clock, due)| clock - due).collect::<Vec<f64>>();
        latest = late.iter().copied().fold(latest, f64::max);
        if found.len() != due.len() || late.iter().any(|late| *late < -1e-3 || *late > 2.0 * FRAME + 1e-3) {
            println!("  BAD: {name} {foot:?} is due at {due:.3?} s and came at {found:.3?}");
            bad += 1;
        }
    }
    if arrived.len() != wanted.len() * loops as usize {
        println!("  BAD: {} events came, {} were due", arrived.len(), wanted.len() * loops as usize);
        bad += 1;
    }
    println!("  {loops} times: {} events, at most {:.1} ms after their time", arrived.len(), latest * 1e3);
    bad
}
