//! The studio, driven without a window and found by label: push, drag, undo, save, export, faults, crashes.

use crate::shell::Shell;
use crate::studio_seen;
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use surefoot::model::scenario::Direction;
use surefoot::studio::Studio;
use surefoot::studio::command::{Command, View};
use surefoot::studio::document::{Edit, Lane, Place};
use surefoot::studio::home::{Home, Unsaved};
use surefoot::studio::state::Asking;

type Window<'a> = Harness<'a, Studio>;

/// A window with a home of its own, on a file or on none.
pub fn window<'a>(home: &Path, open: Option<PathBuf>) -> Window<'a> {
    let home = Home::new(Some(home.to_owned()));
    let mut window = Harness::builder()
        .with_size([1280.0, 900.0])
        .with_max_steps(60)
        .build_eframe(move |context| Studio::new(context, home, open));
    window.state_mut().state.playback.playing = false;
    window.state_mut().state.playback.time = 0.0;
    settle(&mut window);
    window
}

/// Goes on until nothing is worked on.
pub fn settle(window: &mut Window) {
    let began = Instant::now();
    // An answer may ask for more: it rests when it is idle from frame to frame.
    let mut idle = 0;
    while idle < 4 {
        assert!(began.elapsed() < Duration::from_secs(300), "the studio does not come to rest");
        window.run_steps(1);
        idle = if window.state().is_busy() { 0 } else { idle + 1 };
        std::thread::sleep(Duration::from_millis(3));
    }
}

pub fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

pub fn key(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    settle(window);
}

/// Drags a thing by so many points.
fn drag(window: &mut Window, label: &str, by: egui::Vec2) {
    let from = window.get_by_label(label).rect().center();
    window.hover_at(from);
    window.run_steps(1);
    window.drag_at(from);
    window.run_steps(1);
    for step in 1..=4 {
        window.hover_at(from + by * (step as f32 / 4.0));
        window.run_steps(1);
    }
    window.drop_at(from + by);
    settle(window);
}

fn pushes(window: &Window) -> Vec<surefoot::model::scenario::Push> {
    window.state().state.document().scenario.push.clone()
}

/// Types a file's place into the dialog and confirms it.
pub fn choose(window: &mut Window, path: &Path, field: &str, verb: &str) {
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, field).focus();
    window.run_steps(1);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.run_steps(1);
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, field).type_text(&path.display().to_string());
    window.run_steps(2);
    window.get_by_role_and_label(egui::accesskit::Role::Button, verb).click();
    settle(window);
}

#[test]
fn the_first_start_shows_the_built_in_rig_being_pushed() {
    let home = tempfile::tempdir().expect("a folder");
    let window = window(home.path(), None);
    window.get_by_label("Viewport");
    window.get_by_label("Push 1");
    let shown = window.state().state.shown.as_ref().expect("a clip is shown");
    window.get_by_label_contains(&format!("{} steps, 4.00 s", shown.baked.report.steps));
    assert!(shown.last && window.state().state.is_fresh() && shown.baked.report.steps > 0);
    assert!(window.state().state.remembered.knows_it, "the next start is not the first");
}

#[test]
fn a_push_is_added_dragged_stretched_strengthened_turned_and_undone() {
    let home = tempfile::tempdir().expect("a folder");
    let mut window = window(home.path(), None);
    let first = window.state().state.document().clone();
    window.state_mut().state.apply(Command::Seek(2.0));
    click(&mut window, "Add push");
    assert_eq!(pushes(&window).len(), 2);
    assert_eq!(pushes(&window)[1].start, 2.0);
    assert_eq!(window.state().state.selected, Some(Place { lane: Lane::Push, index: 1 }));
    let steps = |window: &Window| window.state().state.shown.as_ref().expect("shown").baked.report.steps;
    let two = steps(&window);

    drag(&mut window, "Push 2", egui::vec2(-90.0, 0.0));
    let moved = pushes(&window)[1];
    assert!((1.2..1.9).contains(&moved.start) && moved.duration == 0.2, "{moved:?}");
    drag(&mut window, "Push 2 end", egui::vec2(60.0, 0.0));
    let stretched = pushes(&window)[1];
    assert!(stretched.start == moved.start && stretched.duration > 0.35, "{stretched:?}");
    drag(&mut window, "Push 2 strength", egui::vec2(0.0, -30.0));
    let strong = pushes(&window)[1];
    assert!(strong.force > 450.0 && strong.duration == stretched.duration, "{strong:?}");
    // In the compass of the inspector, straight up is to the front.
    let compass = window.get_by_role_and_label(egui::accesskit::Role::Slider, "Toward").rect();
    window.drag_at(compass.center() - egui::vec2(0.0, compass.height() * 0.3));
    window.run_steps(1);
    window.drop_at(compass.center() - egui::vec2(0.0, compass.height() * 0.3));
    settle(&mut window);
    assert_eq!(pushes(&window)[1].toward, Direction::Front);

    // Each drag was one step; all the way back is the first document to the byte.
    for _ in 0..5 {
        key(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(*window.state().state.document(), first);
    assert!(window.state().state.history.undoes().is_none());
    let count = |window: &Window| window.state().state.shown.as_ref().expect("shown").baked.report.disturbances.len();
    assert_eq!(count(&window), 1, "the clip is the document's again");
    for _ in 0..5 {
        key(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    }
    assert_eq!(pushes(&window)[1].toward, Direction::Front);
    assert!(two > 0 && count(&window) == 2);
    click(&mut window, "Push 2");
    key(&mut window, Modifiers::NONE, Key::Delete);
    assert_eq!(pushes(&window).len(), 1);
}

#[test]
fn every_lane_takes_an_entry_that_bakes() {
    let home = tempfile::tempdir().expect("a folder");
    for lane in Lane::ALL {
        let mut window = window(&home.path().join(lane.name()), None);
        window.state_mut().state.apply(Command::Edit(Edit::Remove(Place { lane: Lane::Push, index: 0 })));
        window.state_mut().state.apply(Command::Seek(0.5));
        click(&mut window, &format!("Add {}", lane.name().to_lowercase()));
        let state = &window.state().state;
        assert!(state.faults.is_empty() && state.failure.is_none(), "{lane:?} {:?} {:?}", state.faults, state.failure);
        assert!(state.is_fresh(), "{lane:?}");
        window.get_by_label(&format!("{} 1", lane.name()));
    }
}

#[test]
fn an_export_is_what_bake_writes_and_a_saved_scenario_is_its_input() {
    let shell = Shell::new();
    let mut window = window(&shell.path("home"), None);
    window.state_mut().state.apply(Command::Seek(1.8));
    click(&mut window, "Add push");
    key(&mut window, Modifiers::COMMAND, Key::S);
    choose(&mut window, &shell.path("two.toml"), "Name", "Save");
    assert_eq!(window.state().state.file, Some(shell.path("two.toml")));
    assert!(!window.state().state.history.is_unsaved());
    key(&mut window, Modifiers::COMMAND, Key::E);
    choose(&mut window, &shell.path("studio.glb"), "Name", "Export");
    shell.run("bake builtin two.toml -o bake.glb").exits(0);
    let bytes = |name: &str| std::fs::read(shell.path(name)).expect("it is there");
    assert_eq!(bytes("studio.glb"), bytes("bake.glb"));
    assert_eq!(bytes("studio.events.json"), bytes("bake.events.json"));
    window.get_by_label_contains("exported");

    // The next start knows it, and on which rig it was.
    drop(window);
    let next = self::window(&shell.path("home"), Some(shell.path("two.toml")));
    assert_eq!(pushes(&next).len(), 2);
    assert_eq!(next.state().state.remembered.recent[0].scenario, shell.path("two.toml"));
}

#[test]
fn faults_are_told_where_they_are_and_nothing_is_lost() {
    let shell = Shell::with(&[("bad.toml", "duration = 3\n[[push]]\nstart = 9\nforce = -4\n"), ("notes.txt", "x")]);
    let mut window = window(&shell.path("home"), Some(shell.path("bad.toml")));
    let message = &window.state().state.messages.last().expect("told").text;
    assert!(message.contains("line 4") && message.contains("bad.toml"), "{message}");
    assert_eq!(pushes(&window).len(), 1, "the document is as it was");
    click(&mut window, "Close message");

    window.state_mut().state.apply(Command::Edit(Edit::Duration(0.5)));
    settle(&mut window);
    window.get_by_label_contains("push.0.start");
    assert!(window.state().state.shown.is_some(), "the clip from before stays");
    key(&mut window, Modifiers::COMMAND, Key::S);
    choose(&mut window, &shell.path("never.toml"), "Name", "Save");
    assert!(!shell.path("never.toml").exists());
    assert!(window.state().state.messages.last().is_some_and(|message| message.text.contains("has faults")));
    key(&mut window, Modifiers::COMMAND, Key::Z);
    assert!(window.state().state.faults.is_empty() && window.state().state.is_fresh());

    for (file, words) in [("notes.txt", "no file of this kind"), ("gone.toml", "no such file")] {
        window.state_mut().state.apply(Command::Open(shell.path(file)));
        settle(&mut window);
        assert!(window.state().state.messages.last().is_some_and(|message| message.text.contains(words)), "{file}");
    }
    window.state_mut().state.apply(Command::Edit(Edit::Rig(shell.path("no.glb"))));
    settle(&mut window);
    assert!(window.state().state.failure.as_ref().is_some_and(|failure| failure.message.contains("no such file")));
    key(&mut window, Modifiers::COMMAND, Key::Z);
    assert!(window.state().state.failure.is_none() && window.state().state.is_fresh());
}

#[test]
fn unsaved_work_is_asked_about_and_a_crash_loses_none() {
    let shell = Shell::new();
    let home = shell.path("home");
    let mut window = window(&home, None);
    window.state_mut().state.apply(Command::Edit(Edit::Title("dear work".to_owned())));
    settle(&mut window);
    key(&mut window, Modifiers::COMMAND, Key::N);
    window.get_by_label("Save the changes?");
    click(&mut window, "Cancel");
    assert_eq!(window.state().state.document().scenario.title, "dear work");

    // A crash: the program's copy stays, its lock is freed by the system.
    std::thread::sleep(Duration::from_millis(1100));
    window.run_steps(2);
    settle(&mut window);
    let copy = home.join("unsaved/session-1.json");
    let kept: Unsaved = serde_json::from_slice(&std::fs::read(&copy).expect("kept")).expect("whole");
    assert!(kept.text.contains("dear work"));
    drop(window);
    let mut next = self::window(&home, None);
    assert!(matches!(next.state().state.asking, Some(Asking::Recover(..))), "{:?}", next.state().state.asking);
    click(&mut next, "Take it up");
    assert_eq!(next.state().state.document().scenario.title, "dear work");
    assert!(next.state().state.history.is_unsaved());

    key(&mut next, Modifiers::COMMAND, Key::Q);
    click(&mut next, "Do not save");
    assert!(next.state().state.closing);
    drop(next);
    let last = self::window(&home, None);
    assert_eq!(last.state().state.asking, None);
}

#[test]
fn a_rig_is_opened_its_bones_are_shown_and_one_is_mended() {
    let shell = Shell::new();
    shell.run("new rig -o hero.glb").exits(0);
    let mut window = window(&shell.path("home"), Some(shell.path("hero.glb")));
    assert_eq!(window.state().state.document().rig, shell.path("hero.glb"));
    click(&mut window, "Rig");
    window.get_by_label_contains("sure");
    let rig = window.state().state.rig.clone().expect("loaded");
    let jaw = rig.mapping.bones[&surefoot::model::Role::LeftToes];
    let bones = [(surefoot::model::Role::LeftToes, None)].into();
    window.state_mut().state.apply(Command::Edit(Edit::Bones(bones)));
    settle(&mut window);
    let mended = window.state().state.rig.clone().expect("loaded");
    assert!(!mended.mapping.bones.values().any(|node| *node == jaw), "the toes are taken away");
    window.state_mut().state.apply(Command::WriteBones);
    settle(&mut window);
    let text = std::fs::read_to_string(shell.path("hero.bones.toml")).expect("written");
    assert!(text.contains("leftToes = \"\""), "{text}");
    assert!(window.state().state.is_fresh() && window.state().state.failure.is_none());
}

#[test]
fn keys_play_step_and_list_themselves() {
    let home = tempfile::tempdir().expect("a folder");
    let mut window = window(home.path(), None);
    key(&mut window, Modifiers::NONE, Key::ArrowRight);
    assert!((window.state().state.playback.time - 1.0 / 30.0).abs() < 1e-9);
    key(&mut window, Modifiers::NONE, Key::End);
    assert_eq!(window.state().state.playback.time, window.state().state.duration());
    key(&mut window, Modifiers::NONE, Key::Space);
    assert!(window.state().state.playback.playing);
    key(&mut window, Modifiers::NONE, Key::Space);
    key(&mut window, Modifiers::NONE, Key::F1);
    window.get_by_label("Keys and mouse");
    key(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(window.state().state.asking, None);
    // While a title is typed its letters are no keys.
    window.get_by_label("Title").focus();
    window.run_steps(1);
    window.key_press(Key::P);
    window.key_press(Key::Space);
    settle(&mut window);
    assert!(pushes(&window).len() == 1 && !window.state().state.playback.playing);
    key(&mut window, Modifiers::COMMAND, Key::Num2);
    assert_eq!(window.state().state.view, View::Audit);
}

#[test]
fn pictures_of_the_author_in_both_themes() {
    let home = tempfile::tempdir().expect("a folder");
    for (dark, name) in [(true, "author_dark"), (false, "author_light")] {
        let Some(renderer) = studio_seen::renderer() else { return };
        let own = Home::new(Some(home.path().join(name)));
        let mut window = Harness::builder()
            .with_size([1280.0, 800.0])
            .with_max_steps(60)
            .renderer(renderer)
            .build_eframe(move |context| Studio::new(context, own, None));
        window.state_mut().state.playback.playing = false;
        settle(&mut window);
        window.state_mut().state.apply(Command::Theme(Some(dark)));
        window.state_mut().state.apply(Command::Seek(1.05));
        window.state_mut().state.apply(Command::Select(Some(Place { lane: Lane::Push, index: 0 })));
        settle(&mut window);
        let image = studio_seen::keep(&mut window, name);
        // The mannequin's own colour in the middle, the push in its lane.
        assert!(studio_seen::near(&image, [214, 152, 82]) > 3_000, "{name}: the character is not seen");
    }
}
