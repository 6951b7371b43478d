//! The other views in the studio's own window: a clip is audited and corrected through the dialogs, a grid is baked and one of it opened.

use crate::studio::{choose, click, key, settle, window};
use crate::studio_audit::{spoiled, walk_of};
use crate::studio_seen;
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use surefoot::studio::Studio;
use surefoot::studio::command::{Command, View};
use surefoot::studio::home::Home;

#[test]
fn a_clip_is_opened_in_the_audit_a_correction_accepted_and_saved_by_the_dialogs() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = spoiled(folder.path());
    let mut window = window(&folder.path().join("home"), None);
    click(&mut window, "Audit");
    window.state_mut().state.apply(Command::Open(path.clone()));
    settle(&mut window);
    click(&mut window, "Clip");
    let walk = window.state().audit.state().clips[1].clone();
    click(&mut window, &walk);
    assert!(!window.state().audit.state().flags().is_empty());
    key(&mut window, Modifiers::NONE, Key::N);
    click(&mut window, "Accept all");
    click(&mut window, "Save corrected…");
    window.get_by_label("Save the corrected clip");
    let out = folder.path().join("mended.glb");
    choose(&mut window, &out, "Name", "Save");
    let (was, is) = (walk_of(&path), walk_of(&out));
    assert!(was.positions != is.positions && was.frames() == is.frames());
    assert_eq!(
        window.state().state.document().scenario,
        surefoot::model::Scenario::demo(),
        "the scenario is as it was"
    );
}

#[test]
fn a_variation_of_the_grid_becomes_the_scenario_in_one_step_of_the_history() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(folder.path(), None);
    click(&mut window, "Batch");
    click(&mut window, "Bake the grid");
    let labels =
        window.query_all_by_role(egui::accesskit::Role::Button).filter_map(|node| node.accesskit_node().label());
    let cells: Vec<String> = labels.filter(|label| label.contains(": ") && label.contains("step")).collect();
    click(&mut window, cells.last().expect("some step"));
    click(&mut window, "Open this one");
    assert_eq!(window.state().state.view, View::Author);
    assert_ne!(window.state().state.document().scenario, surefoot::model::Scenario::demo());
    assert!(window.state().state.is_fresh());
    key(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(window.state().state.document().scenario, surefoot::model::Scenario::demo());
}

#[test]
fn pictures_of_the_audit_and_of_the_batch() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = spoiled(folder.path());
    let Some(renderer) = studio_seen::renderer() else { return };
    let own = Home::new(Some(folder.path().join("home")));
    let mut window = Harness::builder()
        .with_size([1280.0, 800.0])
        .with_max_steps(60)
        .renderer(renderer)
        .build_eframe(move |context| Studio::new(context, own, None));
    window.state_mut().state.apply(Command::Theme(Some(true)));
    window.state_mut().state.apply(Command::View(View::Audit));
    window.state_mut().state.apply(Command::Open(path));
    settle(&mut window);
    click(&mut window, "Clip");
    let walk = window.state().audit.state().clips[1].clone();
    click(&mut window, &walk);
    key(&mut window, Modifiers::NONE, Key::N);
    let audit = studio_seen::keep(&mut window, "window_audit");
    click(&mut window, "Batch");
    click(&mut window, "Bake the grid");
    let batch = studio_seen::keep(&mut window, "window_batch");
    for image in [audit, batch] {
        let mut colours: Vec<[u8; 4]> = image.pixels().map(|pixel| pixel.0).collect();
        colours.sort_unstable();
        colours.dedup();
        assert!(colours.len() > 1000, "{} colours", colours.len());
    }
}
