//! The studio's batch view: a grid baked headless and found by label, the same bytes as `surefoot batch`, bad ranges, cancelling.

use crate::common::builtin;
use crate::shell::Shell;
use crate::studio_seen;
use eframe::egui;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot::batch::run::options;
use surefoot::export::{self, Form};
use surefoot::model::Scenario;
use surefoot::studio::batch_desk::{BatchDesk, BatchRequest, Job, SweepToSave, Wish};
use surefoot::studio::document::Document;

/// The desk and what it asked for.
struct Desk {
    desk: BatchDesk,
    document: Document,
    requests: Vec<BatchRequest>,
}

fn desk() -> RefCell<Desk> {
    let mut document = Document::demo();
    document.scenario.duration = 2.5;
    document.bake.drive = "stepper";
    RefCell::new(Desk { desk: BatchDesk::new(Arc::new(|| {})), document, requests: Vec::new() })
}

fn show(ui: &mut egui::Ui, desk: &RefCell<Desk>) {
    let Desk { desk, document, requests } = &mut *desk.borrow_mut();
    desk.tick();
    requests.extend(desk.ui(ui, document, None));
}

/// Steps until the desk has nothing to do.
fn settle(harness: &mut Harness, desk: &RefCell<Desk>) {
    let begun = Instant::now();
    loop {
        harness.step();
        if !desk.borrow().desk.is_busy() {
            break;
        }
        assert!(begun.elapsed() < Duration::from_secs(300), "the workers do not end");
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.run();
}

fn type_into(harness: &mut Harness, label: &str, text: &str) {
    harness.get_by_label(label).focus();
    harness.step();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.get_by_label(label).type_text(text);
    harness.step();
}

/// Force 120 and 300 N, to the left and to the right.
fn two_by_two(harness: &mut Harness, desk: &RefCell<Desk>) {
    settle(harness, desk);
    type_into(harness, "Rows: from", "120");
    type_into(harness, "Rows: to", "300");
    type_into(harness, "Rows: count", "2");
    type_into(harness, "Columns: values", "left, right");
    settle(harness, desk);
}

#[test]
fn a_grid_of_two_by_two_is_baked_and_an_opened_cell_has_the_bytes_of_surefoot_batch() {
    let desk = desk();
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).build_ui(|ui| show(ui, &desk));
    two_by_two(&mut harness, &desk);
    harness.get_by_label("4 cells");
    harness.get_by_label("Bake the grid").click();
    settle(&mut harness, &desk);
    for values in ["120 N, left", "120 N, right", "300 N, left", "300 N, right"] {
        let cell = harness.get_by_label_contains(values);
        let words = cell.accesskit_node().label().unwrap_or_default();
        assert!(["still", "sway", "step", "fall"].iter().any(|outcome| words.contains(outcome)), "{words}");
    }
    harness.get_by_label_contains("300 N, left").click();
    harness.run();
    harness.get_by_label("Open this one").click();
    harness.run();
    let requests = std::mem::take(&mut desk.borrow_mut().requests);
    let [BatchRequest::Open(scenario)] = &requests[..] else { panic!("{requests:?}") };
    let mut varied = desk.borrow().document.scenario.clone();
    varied.push[0].toward = surefoot::model::scenario::Direction::Left;
    assert_eq!(**scenario, varied);

    let cell = harness.get_by_label_contains("120 N, right").rect().center();
    for _ in 0..2 {
        let events = &mut harness.input_mut().events;
        events.push(egui::Event::PointerMoved(cell));
        for pressed in [true, false] {
            let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
            events.push(egui::Event::PointerButton { pos: cell, button, pressed, modifiers });
        }
        harness.step();
    }
    let requests = std::mem::take(&mut desk.borrow_mut().requests);
    let [BatchRequest::Open(other)] = &requests[..] else { panic!("a double click opens: {requests:?}") };
    assert_eq!((other.push[0].force, scenario.push[0].force), (120.0, 300.0));

    harness.get_by_label("Save as sweep…").click();
    harness.run();
    let requests = std::mem::take(&mut desk.borrow_mut().requests);
    let [BatchRequest::SaveSweep(save)] = &requests[..] else { panic!("{requests:?}") };
    let shell = Shell::new();
    for output in save.outputs(&shell.path("grid.toml")) {
        std::fs::write(&output.path, &output.bytes).expect("written");
    }
    let told = shell.run("batch grid.toml -o out");
    assert_eq!(told.code, 0, "{}", told.err);
    let name = "shove_from_the_left_300_left";
    let file = std::fs::read(shell.path(&format!("out/builtin/{name}.glb"))).expect("the batch's clip");
    let document = desk.borrow().document.clone();
    let rig = builtin();
    let baked = surefoot::bake::bake(&rig, scenario, &options(&document.bake, name, None)).expect("it holds");
    let exported = export::baked(&rig, &baked, Form::default()).expect("a file");
    assert!(exported.file == file, "the bytes differ");

    // The same into a folder from the desk.
    harness.get_by_label("Bake to folder…").click();
    harness.run();
    let requests = std::mem::take(&mut desk.borrow_mut().requests);
    let [BatchRequest::BakeToFolder(job)] = &requests[..] else { panic!("{requests:?}") };
    desk.borrow_mut().desk.bake_to(shell.path("own"), (**job).clone());
    settle(&mut harness, &desk);
    harness.get_by_label_contains("4 variations are in");
    for of in [
        format!("builtin/{name}.glb"),
        "manifest.csv".into(),
        "manifest.json".into(),
        "coverage.svg".into(),
        "sheet.png".into(),
    ] {
        let read = |root: &str| std::fs::read(shell.path(root).join(&of)).expect("both wrote it");
        let same = read("own") == read("out");
        // The scenario's file has another name in the manifest and over the sheet.
        assert!(same || !of.ends_with("glb"), "{of} differs");
    }
}

#[test]
fn bad_values_are_told_in_the_sweeps_words_and_nothing_runs() {
    let desk = desk();
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).build_ui(|ui| show(ui, &desk));
    two_by_two(&mut harness, &desk);
    for (label, text, words) in [
        ("Rows: from", "hard", "`from` must be a number"),
        ("Rows: from", "", "`from` must be a number"),
        ("Rows: from", "1e9", "out of range"),
        ("Rows: count", "0", "`count` is a whole number"),
        ("Rows: count", "1000", "a grid has 400 at most"),
        ("Columns: values", "left, sideways", "sideways"),
        ("Columns: values", "", "an empty list"),
        ("Columns: values", "\"], [[[", ""),
    ] {
        let before = desk.borrow().desk.wish.clone();
        type_into(&mut harness, label, if text.is_empty() { " " } else { text });
        settle(&mut harness, &desk);
        harness.get_by_label("mend what is red first");
        if !words.is_empty() {
            harness.get_by_label_contains(words);
        }
        harness.get_by_label("Bake the grid").click();
        settle(&mut harness, &desk);
        assert!(harness.query_by_label_contains("120 N, left").is_none());
        desk.borrow_mut().desk.wish = before;
        settle(&mut harness, &desk);
        harness.get_by_label("4 cells");
    }
}

#[test]
fn cancelling_leaves_what_is_done_and_another_grid_can_be_baked() {
    let desk = desk();
    let mut harness = Harness::builder().with_size([1280.0, 800.0]).build_ui(|ui| show(ui, &desk));
    two_by_two(&mut harness, &desk);
    type_into(&mut harness, "Rows: count", "60");
    settle(&mut harness, &desk);
    harness.get_by_label("Bake the grid").click();
    harness.step();
    let begun = Instant::now();
    while harness.query_by_label("Cancel").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(20));
        harness.step();
    }
    harness.get_by_label("Cancel").click();
    settle(&mut harness, &desk);
    harness.get_by_label_contains("Cancelled: ");
    assert!(begun.elapsed() < Duration::from_secs(20), "120 clips were baked after all");
    type_into(&mut harness, "Rows: count", "1");
    settle(&mut harness, &desk);
    harness.get_by_label("Bake the grid").click();
    settle(&mut harness, &desk);
    assert!(harness.query_by_label_contains("Cancelled").is_none());
    harness.get_by_label_contains("120 N, right: ");
}

#[test]
fn a_saved_sweep_reads_back_as_the_same_variations() {
    let document = Document::demo();
    let mut wish = Wish::suggested(&document.scenario);
    wish.seeds = 3;
    let job = Job { wish, document, file: None };
    let plan = job.plan().expect("what is suggested is good");
    assert_eq!(plan.variations.len(), 4 * 4 * 3);
    let save = SweepToSave::new(job.clone());
    let (sweep, _) = surefoot::model::sweep_text::read("saved.toml", &save.sweep("s.toml")).expect("it reads back");
    assert_eq!(sweep.bake, job.document.bake);
    let again = surefoot::batch::plan(sweep, &[("s.toml".to_owned(), save.scenario())]).expect("and plans");
    assert_eq!(again.variations, plan.variations);
    let of = |plan: &surefoot::batch::Plan| -> Vec<Scenario> {
        plan.variations.iter().map(|one| plan.scenario(one).expect("a scenario")).collect()
    };
    assert_eq!(of(&again), of(&plan));
    assert_eq!(save.outputs(Path::new("a/x.toml"))[1].path, Path::new("a/x.scenario.toml"));
}

#[test]
fn every_value_that_is_offered_can_be_varied() {
    let text = surefoot::model::scenario_text::example_text();
    let example = surefoot::model::scenario_text::parse("example", text).expect("the example is good");
    for scenario in [example, Scenario::demo(), Scenario::default()] {
        let document = Document::of("builtin".into(), scenario.clone());
        for path in surefoot::studio::batch_desk::paths(&scenario) {
            let rows = surefoot::studio::batch_desk::Axis::of(&path, &scenario);
            let wish = Wish { rows, columns: Default::default(), seeds: 1 };
            let job = Job { wish, document: document.clone(), file: None };
            let told = job.plan().map(|plan| plan.variations.len());
            assert!(told.as_ref().is_ok_and(|count| *count > 1), "{path}: {told:?}");
        }
    }
}

#[test]
fn pictures_of_the_desk_in_both_themes() {
    use egui::Theme::{Dark, Light};
    for (name, theme, scale) in [("batch_dark", Dark, 1.0), ("batch_light", Light, 1.0), ("batch_light_2x", Light, 2.0)]
    {
        let desk = desk();
        let Some(mut harness) = studio_seen::harness([1280.0, 800.0], (scale, theme), |ui| show(ui, &desk)) else {
            return;
        };
        settle(&mut harness, &desk);
        if scale > 1.0 {
            desk.borrow_mut().desk.wish.as_mut().expect("shown").rows.from = "-5".into();
            settle(&mut harness, &desk);
            studio_seen::keep(&mut harness, "batch_faulty");
            desk.borrow_mut().desk.wish.as_mut().expect("shown").rows.from = "150".into();
            settle(&mut harness, &desk);
        }
        harness.get_by_label("Bake the grid").click();
        settle(&mut harness, &desk);
        harness.get_by_label_contains("350 N, left").click();
        harness.run();
        harness.remove_cursor();
        if scale > 1.0 {
            harness.get_by_label("by outcome").click();
            harness.run();
            harness.get_by_label_contains("step 1").click();
            harness.run();
            assert!(harness.query_by_label_contains("350 N, left").is_none(), "what is hidden is not listed");
            harness.get_by_label_contains("150 N, front");
            harness.get_by_label_contains("step 1").click();
            harness.run();
        }
        let image = studio_seen::keep(&mut harness, name);
        assert!(studio_seen::near(&image, [0, 142, 104]) > 300, "{name}: no pill says that it stepped");
    }
}
