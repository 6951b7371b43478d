//! The rig: which file, how its bones were found and how sure that is, and a way to name another node for one.
//!
//! What is named here is an edit of the document; a button writes it beside the rig, where every other command reads it too.

use super::fields::grid;
use crate::model::Role;
use crate::rig::Rig;
use crate::studio::command::Command;
use crate::studio::document::Edit;
use crate::studio::state::State;
use eframe::egui;

/// Bones that are listed: the body's, without eyes, jaw and fingers.
fn listed() -> impl Iterator<Item = Role> {
    let face = [Role::Jaw, Role::LeftEye, Role::RightEye];
    Role::ALL.iter().copied().filter(move |role| *role <= Role::RightToes && !face.contains(role))
}

/// Draws it.
pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Vec<Command>) {
    let document = state.document();
    ui.horizontal(|ui| {
        ui.label(document.rig.display().to_string());
    });
    ui.horizontal(|ui| {
        if ui.button("Open rig...").on_hover_text("a humanoid .glb, .gltf, .vrm or .fbx").clicked() {
            commands.push(Command::RigDialog);
        }
        if document.rig.as_os_str() != "builtin" && ui.button("Built-in").clicked() {
            commands.push(Command::Edit(Edit::Rig("builtin".into())));
        }
    });
    let Some(rig) = state.rig.as_deref() else { return };
    let mapping = &rig.mapping;
    grid(ui, "rig facts", |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(name);
            ui.label(value);
            ui.end_row();
        };
        row("Found by", format!("{}, {:.0} % sure", mapping.method, mapping.confidence * 100.0));
        row("Body", format!("{:.2} m, {:.1} kg", rig.body.height, rig.body.mass));
        row("Legs", format!("{:.2} m", rig.body.leg_length));
        row("Axes", format!("up {}, forward {}", mapping.up, mapping.forward));
    });
    for warning in &mapping.warnings {
        ui.label(egui::RichText::new(warning).color(ui.visuals().warn_fg_color));
    }
    egui::CollapsingHeader::new("Bones").id_salt("bones").show(ui, |ui| bones(ui, state, rig, commands));
}

fn bones(ui: &mut egui::Ui, state: &State, rig: &Rig, commands: &mut Vec<Command>) {
    let document = state.document();
    let fixed = &document.bones;
    let own = document.rig.as_os_str() != "builtin";
    if own && !fixed.is_empty() {
        ui.horizontal(|ui| {
            if ui
                .button("Write beside the rig")
                .on_hover_text("as a .bones.toml file, which every command reads")
                .clicked()
            {
                commands.push(Command::WriteBones);
            }
            if ui.button("Forget").clicked() {
                commands.push(Command::Edit(Edit::Bones(Default::default())));
            }
        });
    }
    grid(ui, "bones", |ui| {
        for role in listed() {
            let node = rig.mapping.bones.get(&role).copied();
            let label = ui.label(role.name());
            let shown = node.map_or("none".to_owned(), |node| name(rig, node));
            let text = if fixed.contains_key(&role) {
                egui::RichText::new(&shown).strong()
            } else {
                egui::RichText::new(&shown)
            };
            let combo = egui::ComboBox::from_id_salt(("bone", role)).selected_text(text).width(150.0);
            let response = ui.add_enabled_ui(own, |ui| {
                combo.show_ui(ui, |ui| {
                    if ui.selectable_label(node.is_none(), "none").clicked() {
                        commands.push(Command::Edit(Edit::Bones(with(fixed, role, None))));
                    }
                    for index in 0..rig.nodes.len() {
                        if ui.selectable_label(node == Some(index), name(rig, index)).clicked() {
                            commands.push(Command::Edit(Edit::Bones(with(fixed, role, Some(index)))));
                        }
                    }
                })
            });
            response.inner.response.labelled_by(label.id);
            ui.end_row();
        }
    });
}

type Bones = std::collections::BTreeMap<Role, Option<usize>>;

fn with(bones: &Bones, role: Role, node: Option<usize>) -> Bones {
    let mut changed = bones.clone();
    // A node is one bone: who had it before loses it.
    changed.retain(|_, other| node.is_none() || *other != node);
    changed.insert(role, node);
    changed
}

fn name(rig: &Rig, node: usize) -> String {
    rig.nodes.get(node).and_then(|node| node.name.clone()).unwrap_or_else(|| format!("node {node}"))
}
