//! Rows of the inspector: a name, a number with its unit and limits, and a button that puts back what it was without a word.
//!
//! A row gives what the person made of it and whether a drag goes on; the caller makes an edit of that.

use crate::studio::command::Command;
use crate::studio::document::Edit;
use crate::studio::icons::{Icon, button};
use eframe::egui::{self, DragValue, Response};
use std::ops::RangeInclusive;

/// A number that a person can change.
pub struct Number<'a> {
    /// Its name.
    pub name: &'a str,
    /// What it does, on hover.
    pub hint: &'a str,
    /// Its unit.
    pub unit: &'static str,
    /// What is allowed.
    pub range: RangeInclusive<f64>,
    /// What a drag of a point changes.
    pub speed: f64,
    /// Digits behind the point at most.
    pub digits: usize,
    /// What it is without a word; `None` has no reset.
    pub default: Option<f64>,
}

impl<'a> Number<'a> {
    /// A number without a unit.
    pub fn new(name: &'a str, range: RangeInclusive<f64>, hint: &'a str) -> Number<'a> {
        Number { name, hint, unit: "", range, speed: 0.01, digits: 2, default: None }
    }

    /// With a unit, and what a drag of a point changes.
    pub fn unit(self, unit: &'static str, speed: f64, digits: usize) -> Number<'a> {
        Number { unit, speed, digits, ..self }
    }

    /// With what it is without a word.
    pub fn default(self, value: f64) -> Number<'a> {
        Number { default: Some(value), ..self }
    }

    /// Draws the row; `edit` makes an edit of the new value.
    pub fn row(self, ui: &mut egui::Ui, value: f64, commands: &mut Vec<Command>, edit: impl Fn(f64) -> Edit) {
        self.row_on(ui, value, commands, &edit, true);
    }

    /// The same, that can be switched off.
    pub fn row_on(
        self,
        ui: &mut egui::Ui,
        value: f64,
        commands: &mut Vec<Command>,
        edit: &dyn Fn(f64) -> Edit,
        on: bool,
    ) {
        let name = ui.label(self.name).on_hover_text(self.hint);
        ui.horizontal(|ui| {
            let mut next = value;
            let suffix = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
            let drag = DragValue::new(&mut next)
                .range(self.range.clone())
                .clamp_existing_to_range(false)
                .speed(self.speed)
                .max_decimals(self.digits)
                .suffix(suffix);
            let low = *self.range.start();
            let told = format!("{}\n{low} to {} {}", self.hint, self.range.end(), self.unit);
            let response = ui.add_enabled(on, drag).labelled_by(name.id).on_hover_text(told.trim_end());
            changed(&response, next != value, commands, || edit(next));
            if let Some(default) = self.default.filter(|default| on && (*default - value).abs() > 1e-9)
                && reset(ui, self.name, &format!("{default} {}", self.unit))
            {
                commands.push(Command::Edit(edit(default)));
            }
        });
        ui.end_row();
    }
}

/// A dial of 0..1 with a slider, 0.5 in its middle.
pub fn dial(
    ui: &mut egui::Ui,
    (name, hint): (&str, &str),
    (value, default): (f64, f64),
    commands: &mut Vec<Command>,
    edit: impl Fn(f64) -> Edit,
) {
    let label = ui.label(name).on_hover_text(hint);
    ui.horizontal(|ui| {
        let mut next = value;
        ui.spacing_mut().slider_width = 84.0;
        let slider = egui::Slider::new(&mut next, 0.0..=1.0).max_decimals(2);
        let response = ui.add(slider).labelled_by(label.id).on_hover_text(hint);
        changed(&response, next != value, commands, || edit(next));
        if (value - default).abs() > 1e-9 && reset(ui, name, &default.to_string()) {
            commands.push(Command::Edit(edit(default)));
        }
    });
    ui.end_row();
}

/// A choice of some.
pub fn choice<T: PartialEq + Clone>(
    ui: &mut egui::Ui,
    (name, hint): (&str, &str),
    value: &T,
    choices: &[(&str, T)],
    commands: &mut Vec<Command>,
    edit: impl Fn(T) -> Edit,
) {
    let label = ui.label(name).on_hover_text(hint);
    let shown = choices.iter().find(|(_, choice)| choice == value).map_or("", |(text, _)| *text);
    let mut next = value.clone();
    let response = egui::ComboBox::from_id_salt(name).selected_text(shown).width(120.0).show_ui(ui, |ui| {
        for (text, choice) in choices {
            ui.selectable_value(&mut next, choice.clone(), *text);
        }
    });
    response.response.labelled_by(label.id).on_hover_text(hint);
    if next != *value {
        commands.push(Command::Edit(edit(next)));
    }
    ui.end_row();
}

/// Edits of a response: parts of one drag while it goes on, a step of its own otherwise.
pub fn changed(response: &Response, is_new: bool, commands: &mut Vec<Command>, edit: impl FnOnce() -> Edit) {
    if is_new {
        let goes_on = response.dragged() || response.has_focus();
        commands.push(if goes_on { Command::Drag(edit()) } else { Command::Edit(edit()) });
    }
    if response.drag_stopped() || response.lost_focus() {
        commands.push(Command::Release);
    }
}

fn reset(ui: &mut egui::Ui, name: &str, to: &str) -> bool {
    button(ui, Icon::Reset, &format!("Reset {name}"), false).on_hover_text(format!("back to {to}")).clicked()
}

/// Two columns of rows.
pub fn grid(ui: &mut egui::Ui, id: &str, rows: impl FnOnce(&mut egui::Ui)) {
    egui::Grid::new(id).num_columns(2).min_col_width(96.0).spacing([8.0, 5.0]).show(ui, rows);
}
