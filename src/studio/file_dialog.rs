//! Which file? A dialog inside of the window: a folder's entries, a path that can be typed, recent files.
//!
//! It looks at no disk itself: [`super::state`] asks for a folder's entries and has them listed beside the window.

use super::errands::Listed;
use super::state::{Purpose, State};
use eframe::egui::{self, Key};
use std::path::{Path, PathBuf};

/// The dialog, from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct FileDialog {
    purpose: Option<Purpose>,
    folder: PathBuf,
    name: String,
    asked: Option<PathBuf>,
}

/// What a purpose is called, what is chosen, its endings, and whether a new file is named.
fn terms(purpose: Purpose) -> (&'static str, &'static str, &'static [&'static str], bool) {
    const CLIPS: &[&str] = &["bvh", "fbx", "glb", "gltf", "vrm", "vrma"];
    match purpose {
        Purpose::Open => ("Open", "Open", &["toml", "glb", "gltf", "vrm", "bvh", "fbx", "vrma"], false),
        Purpose::Rig => ("Open a rig", "Open", &["glb", "gltf", "vrm", "fbx"], false),
        Purpose::Base => ("A clip under the reaction", "Use", CLIPS, false),
        Purpose::Ground => ("A mesh to stand on", "Use", &["glb", "gltf"], false),
        Purpose::Clip => ("Open a clip to audit", "Open", CLIPS, false),
        Purpose::Save => ("Save the scenario", "Save", &["toml"], true),
        Purpose::Export => ("Export the clip", "Export", &["glb", "vrma", "fbx"], true),
        Purpose::Corrected => ("Save the corrected clip", "Save", CLIPS, true),
        Purpose::Sweep => ("Save the sweep", "Save", &["toml"], true),
        Purpose::Folder => ("Bake into a folder", "Bake here", &[], true),
    }
}

impl FileDialog {
    /// Draws it; a choice or a cancel goes to the state.
    pub fn ui(&mut self, ctx: &egui::Context, state: &mut State, purpose: Purpose) {
        let (title, verb, endings, new) = terms(purpose);
        if self.purpose != Some(purpose) {
            self.purpose = Some(purpose);
            self.name = suggestion(state, purpose);
            self.asked = None;
            if self.folder.as_os_str().is_empty() {
                self.folder = start(state);
            }
        }
        if self.asked.as_ref() != Some(&self.folder) {
            self.asked = Some(self.folder.clone());
            state.list(&self.folder);
        }
        let mut chosen = None;
        let modal = egui::Modal::new(egui::Id::unique("file dialog")).show(ctx, |ui| {
            ui.set_width(520.0);
            ui.heading(title);
            ui.add_space(6.0);
            self.path_row(ui);
            ui.separator();
            chosen = self.entries(ui, state, endings);
            ui.separator();
            if purpose == Purpose::Open {
                recent(ui, state, &mut chosen);
            }
            let field = ui.horizontal(|ui| {
                let label = ui.label(if new { "Name" } else { "File" });
                let edit = egui::TextEdit::singleline(&mut self.name).desired_width(f32::INFINITY);
                ui.add(edit).labelled_by(label.id)
            });
            let entered = field.inner.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let ready = !self.name.trim().is_empty() || purpose == Purpose::Folder;
                if ui.add_enabled(ready, egui::Button::new(verb)).clicked() || (entered && ready) {
                    chosen = Some(self.path());
                }
                if ui.button("Cancel").clicked() {
                    ui.close();
                }
                if new && self.exists(state) {
                    ui.colored_label(ui.visuals().warn_fg_color, "a file of this name is there; it will be replaced");
                }
            });
        });
        match chosen {
            Some(path) if path.is_absolute() && self.is_folder(state, &path) && purpose != Purpose::Folder => {
                self.enter(path);
            }
            Some(path) => {
                self.purpose = None;
                state.choose(purpose, path);
            }
            None if modal.should_close() => {
                self.purpose = None;
                state.cancel();
            }
            None => {}
        }
    }

    fn path_row(&mut self, ui: &mut egui::Ui) {
        ui.horizontal(|ui| {
            if ui.button("Up").on_hover_text("the folder above").clicked()
                && let Some(above) = self.folder.parent().map(Path::to_owned)
            {
                self.enter(above);
            }
            let label = ui.label("Folder");
            let mut text = self.folder.display().to_string();
            let edit = egui::TextEdit::singleline(&mut text).desired_width(f32::INFINITY);
            if ui.add(edit).labelled_by(label.id).changed() {
                self.folder = PathBuf::from(text);
            }
        });
    }

    fn entries(&mut self, ui: &mut egui::Ui, state: &State, endings: &[&str]) -> Option<PathBuf> {
        let mut chosen = None;
        let here = state.listing.as_ref().filter(|(folder, _)| *folder == self.folder);
        egui::ScrollArea::vertical().max_height(260.0).min_scrolled_height(260.0).auto_shrink(false).show(ui, |ui| {
            let Some((_, entries)) = here else {
                ui.weak("...");
                return;
            };
            let fits = |entry: &&Listed| !entry.is_file || endings.contains(&ending(&entry.name).as_str());
            let mut any = false;
            for entry in entries.iter().filter(fits) {
                any = true;
                let text = if entry.is_file { entry.name.clone() } else { format!("{}/", entry.name) };
                let response = ui.selectable_label(entry.is_file && self.name == entry.name, text);
                if response.double_clicked() && entry.is_file {
                    chosen = Some(self.folder.join(&entry.name));
                } else if response.clicked() && entry.is_file {
                    self.name = entry.name.clone();
                } else if response.clicked() {
                    self.enter(self.folder.join(&entry.name));
                    return;
                }
            }
            if !any {
                ui.weak("nothing here that fits");
            }
        });
        chosen
    }

    fn enter(&mut self, folder: PathBuf) {
        self.folder = folder;
        self.asked = None;
    }

    /// What is typed, from the folder on.
    fn path(&self) -> PathBuf {
        self.folder.join(self.name.trim())
    }

    fn exists(&self, state: &State) -> bool {
        let here = state.listing.as_ref().filter(|(folder, _)| *folder == self.folder);
        here.is_some_and(|(_, entries)| entries.iter().any(|entry| entry.is_file && entry.name == self.name.trim()))
    }

    fn is_folder(&self, state: &State, path: &Path) -> bool {
        let here = state.listing.as_ref().filter(|(folder, _)| path.parent() == Some(folder.as_path()));
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
        here.is_some_and(|(_, entries)| {
            entries.iter().any(|entry| !entry.is_file && Some(&entry.name) == name.as_ref())
        })
    }
}

fn recent(ui: &mut egui::Ui, state: &State, chosen: &mut Option<PathBuf>) {
    if state.remembered.recent.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.weak("recent");
        for recent in state.remembered.recent.iter().take(6) {
            let name = recent.scenario.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            if ui.link(name).on_hover_text(recent.scenario.display().to_string()).clicked() {
                *chosen = Some(recent.scenario.clone());
            }
        }
    });
    ui.separator();
}

/// Where a person is likely to look: beside the scenario, else where the program was started.
fn start(state: &State) -> PathBuf {
    let beside = state.file.as_deref().and_then(Path::parent).map(Path::to_owned);
    beside.or_else(|| std::env::current_dir().ok()).unwrap_or_else(|| PathBuf::from("."))
}

fn suggestion(state: &State, purpose: Purpose) -> String {
    let title = crate::bake::safe_letters(&state.document().scenario.title);
    let title = if title.is_empty() { "scenario".to_owned() } else { title };
    match purpose {
        Purpose::Save => state
            .file
            .as_deref()
            .and_then(Path::file_name)
            .map_or_else(|| format!("{title}.toml"), |name| name.to_string_lossy().into_owned()),
        Purpose::Export => {
            let rig =
                state.document().rig.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            format!("{rig}_{title}.glb")
        }
        Purpose::Sweep | Purpose::Corrected => state.suggested.clone().unwrap_or_default(),
        _ => String::new(),
    }
}

fn ending(name: &str) -> String {
    Path::new(name).extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}
