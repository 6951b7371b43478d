//! The flag that a person looks at: what is wrong, what the correction does about it, and what becomes of that.

use super::colors;
use super::flags_list::{amount, fate, frames};
use super::repairs::{Decision, Repair};
use super::shown::Shown;
use super::state::{Command, State};
use eframe::egui::{Button, Frame, RichText, Ui};

/// Draws it.
pub fn details(ui: &mut Ui, state: &State, shown: &Shown, commands: &mut Vec<Command>) {
    ui.add_space(4.0);
    let flag = state.flag.and_then(|index| shown.before.findings.flags.get(index));
    match flag {
        Some(flag) => {
            let color = colors::rule(flag.rule, ui.visuals());
            ui.horizontal(|ui| {
                let foot = flag.foot.map(|foot| format!(" · {foot}")).unwrap_or_default();
                ui.label(RichText::new(format!("{}{foot}", colors::title(flag.rule))).color(color).strong());
                ui.weak(format!("{} · {}", frames(flag), amount(flag)));
            });
            ui.label(&flag.why);
            let repair = state.now().and_then(|repairs| {
                let index = repairs.of_flag(flag)?;
                Some((index, repairs.list.get(index)?))
            });
            ui.add_space(2.0);
            match repair {
                Some((index, repair)) => correction(ui, index, repair, commands),
                None => {
                    let (word, color) = fate(state, shown, flag, ui);
                    let sentence = match word {
                        "…" => "The correction is being worked out.",
                        "no correction found" => {
                            "No correction was found that makes it cleaner and raises no other flag."
                        }
                        _ => "The correction of another flag mends this one too.",
                    };
                    ui.colored_label(color, sentence);
                }
            }
        }
        None if shown.before.findings.flags.is_empty() => drop(ui.weak("There is nothing to correct.")),
        None => drop(ui.weak("Choose a flag in the list or on the timeline, or press N for the next one.")),
    }
    let pending = state.now().map_or(0, |repairs| repairs.count(Decision::Pending));
    if pending > 0 {
        ui.horizontal(|ui| {
            if ui.button("Accept all").on_hover_text("Accepts every correction that is not decided").clicked() {
                commands.push(Command::AcceptAll);
            }
            ui.weak(format!("{pending} to decide"));
        });
    }
    ui.separator();
}

fn correction(ui: &mut Ui, index: usize, repair: &Repair, commands: &mut Vec<Command>) {
    Frame::new().fill(ui.visuals().faint_bg_color).inner_margin(8.0).corner_radius(4.0).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.strong("Correction");
            ui.colored_label(colors::decision(repair.decision, ui.visuals()), colors::word(repair.decision));
        });
        ui.label(sentence(&repair.what));
        let others = repair.answers.len().saturating_sub(1);
        let also = match others {
            0 => String::new(),
            1 => ", and answers another flag too".to_owned(),
            _ => format!(", and answers {others} other flags too"),
        };
        let cm = 100.0 * repair.moved_m;
        ui.weak(format!("Touches frames {}–{}, moves up to {cm:.1} cm{also}.", repair.start, repair.end));
        ui.horizontal(|ui| {
            let mut choice = |ui: &mut Ui, name: &str, hint: &str, decision: Decision| {
                let chosen = repair.decision == decision;
                let color = colors::decision(decision, ui.visuals());
                let mut button = Button::new(RichText::new(name).color(color));
                if chosen {
                    button = Button::new(RichText::new(name).color(ui.visuals().extreme_bg_color)).fill(color);
                }
                let hint = if chosen { "Once more takes it back" } else { hint };
                if ui.add(button).on_hover_text(hint).clicked() {
                    commands.push(Command::Decide(index, decision));
                }
            };
            choice(ui, "Accept", "It will be written (A)", Decision::Accepted);
            choice(ui, "Reject", "The frames stay as they are in the file (R)", Decision::Rejected);
        });
        ui.take_available_width();
    });
}

/// With a capital letter.
fn sentence(what: &str) -> String {
    let mut letters = what.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
