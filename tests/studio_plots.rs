//! The studio's plots: headless, found by label; a click seeks; pictures of them in both themes.

use crate::common::builtin;
use crate::studio_seen::{harness, keep, near};
use eframe::egui;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::cell::{Cell, RefCell};
use surefoot::bake::{BakeOptions, Drive, Helped, bake};
use surefoot::model::Scenario;
use surefoot::ragdoll::control::Assist;
use surefoot::studio::plots::{Kind, Plots, Series, series};

fn demo(drive: Drive) -> Series {
    let (rig, scenario) = (builtin(), Scenario::demo());
    let baked = bake(&rig, &scenario, &BakeOptions { drive, ..BakeOptions::default() }).expect("the simulation holds");
    series(&baked, &scenario, &rig)
}

fn ragdoll() -> Drive {
    Drive::Ragdoll(Helped::Within(Assist { torque: 100.0, force: 0.0 }))
}

#[test]
fn a_click_on_a_plot_seeks_there_and_the_menu_hides_plots() {
    let series = demo(Drive::Stepper);
    let (plots, sought) = (RefCell::new(Plots::default()), Cell::new(None));
    let app = |ui: &mut egui::Ui| {
        if let Some(time) = plots.borrow_mut().ui(ui, &series, 0.7, None) {
            sought.set(Some(time));
        }
    };
    let mut harness = Harness::builder().with_size([900.0, 1000.0]).build_ui(app);
    harness.run();
    let area = harness.get_by_label("plot of Speed").rect();
    harness.get_by_label("at 0.70 s");
    harness.get_by_label_contains("none: the stepper moved this body");
    assert_eq!(sought.get(), None);
    let to = |x: f32| egui::pos2(area.left() + x * area.width(), area.center().y);
    harness.drag_at(to(0.5));
    harness.step();
    let half = sought.get().expect("a press seeks");
    harness.hover_at(to(0.75));
    harness.step();
    let later = sought.get().expect("a drag seeks");
    harness.drop_at(to(0.75));
    harness.run();
    assert!((half - 2.0).abs() < 0.1 && (later - half - 1.04).abs() < 0.05, "{half} s, then {later} s");

    harness.get_by_label("Plots").click();
    harness.run();
    harness.get_by_role_and_label(egui::accesskit::Role::CheckBox, "Speed").click();
    harness.run();
    assert!(harness.query_by_label("plot of Speed").is_none() && !plots.borrow().shown[Kind::Speed as usize]);
    harness.get_by_label("plot of Slip");
}

#[test]
fn pictures_of_the_plots_show_every_curve() {
    use egui::Theme::{Dark, Light};
    for (name, theme, scale, drive) in [
        ("plots_dark", Dark, 1.0, Drive::Stepper),
        ("plots_light", Light, 1.0, ragdoll()),
        ("plots_dark_2x", Dark, 2.0, ragdoll()),
    ] {
        let series = demo(drive);
        let mut plots = Plots::default();
        let app = |ui: &mut egui::Ui| {
            plots.ui(ui, &series, 0.93, None);
        };
        let Some(mut harness) = harness([1280.0, 1000.0], (scale, theme), app) else { return };
        harness.run();
        let image = keep(&mut harness, name);
        let (blue, orange) =
            if theme == Dark { ([86, 180, 233], [230, 159, 0]) } else { ([0, 114, 178], [230, 159, 0]) };
        assert!(near(&image, blue) > 1500 && near(&image, orange) > 800, "{name}: the curves are not there");
    }
}
