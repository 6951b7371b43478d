//! All that the studio knows, and the one place where commands change it. No painting here; tests drive it without a window.
//!
//! Edits go into [`History`]; whatever the document is after them is baked by the worker, kept for the case of a crash, and drawn by the
//! panels, which read this and change nothing.

mod answers;

pub use super::asking::{Asking, Message, Purpose};
use super::command::{Command, View};
use super::document::{Document, Edit, Entry, Place};
use super::errands::{self, Done, Errand, Listed};
use super::examples;
use super::history::History;
use super::home::{Home, Remembered, Unsaved};
use super::playback::Playback;
use super::plots::Series;
use super::simulate::{self, Answer, Question, Shown};
use super::worker::{Wake, Worker};
use crate::disk::writer::Output;
use crate::disk::{Failure, clip_files};
use crate::model::Scenario;
use crate::model::scenario::{Ground, GroundKind, Marker};
use crate::model::scenario_errors::Fault;
use crate::rig::Rig;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Unsaved work is kept at least this often.
const KEPT_EVERY: Duration = Duration::from_millis(1000);

/// Without an edit for so long the person rests.
const RESTS: Duration = Duration::from_millis(250);

/// What the desks of the other views are asked to do with a file that was chosen.
pub type Chosen = (Purpose, PathBuf);

/// The state.
pub struct State {
    /// The document and its past.
    pub history: History,
    /// The scenario's file.
    pub file: Option<PathBuf>,
    /// The selected entry.
    pub selected: Option<Place>,
    /// The playhead.
    pub playback: Playback,
    /// The clip that is shown; older than the document while the next is baked.
    pub shown: Option<Shown>,
    /// The curves of the clip that is shown.
    pub curves: Option<Arc<Series>>,
    /// The rig of the document, once it is loaded.
    pub rig: Option<Arc<Rig>>,
    /// What is wrong with the scenario; nothing is baked then.
    pub faults: Vec<Fault>,
    /// Why the last bake gave no clip.
    pub failure: Option<Failure>,
    /// For the person, the newest last.
    pub messages: Vec<Message>,
    /// What is asked.
    pub asking: Option<Asking>,
    /// A name that would do for the file that is asked for.
    pub suggested: Option<String>,
    /// A folder's entries for the file dialog.
    pub listing: Option<(PathBuf, Vec<Listed>)>,
    /// Settings.
    pub remembered: Remembered,
    /// The view.
    pub view: View,
    /// Whether the plots are shown.
    pub plots: bool,
    /// Files that the other views are to open or write.
    pub chosen: Vec<Chosen>,
    /// The window is to close.
    pub closing: bool,
    clipboard: Option<Entry>,
    edit: u64,
    asked: Option<Document>,
    kept: Option<(Document, Instant)>,
    export: Option<PathBuf>,
    then: Option<Command>,
    rig_for: Option<PathBuf>,
    crashed: Vec<(PathBuf, Unsaved)>,
    bake: Worker<Question, Answer>,
    choose: Worker<(Document, Shown), Answer>,
    /// When the clip came for which the ragdoll is still to be asked.
    unchosen: Option<Instant>,
    files: Worker<Errand, Done>,
}

impl State {
    /// Begins with the built-in rig being pushed, or with a file.
    pub fn new(wake: Wake, home: Home, open: Option<PathBuf>) -> State {
        let mut state = State {
            history: History::new(Document::demo()),
            file: None,
            selected: None,
            playback: Playback { playing: true, ..Playback::default() },
            shown: None,
            curves: None,
            rig: None,
            faults: Vec::new(),
            failure: None,
            messages: Vec::new(),
            asking: None,
            suggested: None,
            listing: None,
            remembered: Remembered::default(),
            view: View::Author,
            plots: false,
            chosen: Vec::new(),
            closing: false,
            clipboard: None,
            edit: 0,
            asked: None,
            kept: None,
            export: None,
            then: None,
            rig_for: None,
            crashed: Vec::new(),
            bake: simulate::start(Arc::clone(&wake)),
            choose: simulate::start_choosing(Arc::clone(&wake)),
            unchosen: None,
            files: errands::start(wake, home),
        };
        state.files.ask(Errand::WakeUp);
        if let Some(path) = open {
            state.open(path);
        }
        state
    }

    /// The document.
    pub fn document(&self) -> &Document {
        self.history.document()
    }

    /// s: the length of what the playhead runs over.
    pub fn duration(&self) -> f64 {
        self.shown.as_ref().map_or(self.document().scenario.duration, |shown| shown.baked.clip.duration)
    }

    /// Whether the clip that is shown is the document's.
    pub fn is_fresh(&self) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.edit == self.edit && shown.last)
            && self.asked.as_ref() == Some(self.document())
    }

    /// Whether something is worked on.
    pub fn is_busy(&self) -> bool {
        self.bake.is_busy() || self.choose.is_busy() || self.files.is_busy() || self.unchosen.is_some()
    }

    /// A frame goes by: answers are taken, the playhead moves, the newest document is asked for.
    pub fn tick(&mut self, passed: f64) {
        for answer in self.bake.answers().into_iter().chain(self.choose.answers()) {
            self.baked(answer);
        }
        for done in self.files.answers() {
            self.done(done);
        }
        self.playback.advance(passed, self.duration());
        self.ask();
        self.ask_ragdoll();
        self.keep();
        if self.asking.is_none()
            && let Some((copy, unsaved)) = self.crashed.pop()
        {
            self.asking = Some(Asking::Recover(copy, unsaved));
        }
    }

    /// Carries a command out; asks first where unsaved work would be lost.
    pub fn apply(&mut self, command: Command) {
        let loses = matches!(command, Command::New | Command::Example(_) | Command::Quit)
            || matches!(&command, Command::Open(path) if is_scenario(path));
        if loses && self.history.is_unsaved() && self.asking.is_none() {
            self.asking = Some(Asking::Unsaved(Box::new(command)));
        } else {
            self.carry_out(command);
        }
    }

    fn carry_out(&mut self, command: Command) {
        let duration = self.duration();
        match command {
            Command::Edit(edit) => self.history.apply(edit, false),
            Command::Drag(edit) => self.history.apply(edit, true),
            Command::Release => self.history.release(),
            Command::Undo => self.history.undo(),
            Command::Redo => self.history.redo(),
            Command::Select(place) => self.selected = place,
            Command::Add(lane, at) => self.add(lane.entry(tidy(at.unwrap_or(self.playback.time)))),
            Command::Mark => {
                let mut markers = self.document().scenario.marker.clone();
                let time = tidy(self.playback.time);
                let place = markers.partition_point(|marker| marker.time <= time);
                markers.insert(place, Marker { time, name: format!("mark {}", markers.len() + 1) });
                self.history.apply(Edit::Markers(markers), false);
            }
            Command::Copy => self.clipboard = self.selected_entry().or(self.clipboard.take()),
            Command::Cut => {
                self.clipboard = self.selected_entry().or(self.clipboard.take());
                self.delete();
            }
            Command::Paste => {
                if let Some(entry) = self.clipboard.clone() {
                    self.add(entry.moved(tidy(self.playback.time)));
                }
            }
            Command::Duplicate => {
                if let Some(entry) = self.selected_entry() {
                    let behind = entry.end().unwrap_or(entry.start() + 0.5).max(entry.start() + 0.1);
                    self.add(entry.moved(tidy(behind)));
                }
            }
            Command::Delete => self.delete(),
            Command::PlayPause => self.playback.toggle(duration),
            Command::Seek(time) => self.playback.seek(time, duration),
            Command::Step(frames) => self.playback.step(frames, self.document().bake.fps, duration),
            Command::ToggleLoop => self.playback.looping = !self.playback.looping,
            Command::Speed(speed) => self.playback.speed = speed,
            Command::New => self.begin(Document::of(self.document().rig.clone(), Scenario::default()), None),
            Command::OpenDialog => self.asking = Some(Asking::File(Purpose::Open)),
            Command::RigDialog => self.asking = Some(Asking::File(Purpose::Rig)),
            Command::BaseDialog => self.asking = Some(Asking::File(Purpose::Base)),
            Command::GroundDialog => self.asking = Some(Asking::File(Purpose::Ground)),
            Command::Open(path) => self.open(path),
            Command::Example(index) => {
                if let Some(scenario) = examples::scenario(index) {
                    self.begin(Document::of(PathBuf::from("builtin"), scenario), None);
                }
            }
            Command::Save => match self.file.clone() {
                Some(path) => self.save(path),
                None => self.asking = Some(Asking::File(Purpose::Save)),
            },
            Command::WriteBones => {
                if let Some(rig) = self.rig.clone() {
                    let document = self.document();
                    self.files.ask(Errand::Bones(document.rig.clone(), rig, document.bones.clone()));
                }
            }
            Command::SaveAs => self.asking = Some(Asking::File(Purpose::Save)),
            Command::ExportDialog => self.asking = Some(Asking::File(Purpose::Export)),
            Command::Keys => self.asking = Some(Asking::Keys),
            Command::View(view) => self.view = view,
            Command::TogglePlots => self.plots = !self.plots,
            Command::Theme(dark) => {
                self.remembered.theme = dark.map(|dark| if dark { "dark" } else { "light" }.to_owned());
                self.files.ask(Errand::Remember(Box::new(self.remembered.clone())));
            }
            Command::Quit => {
                self.files.ask(Errand::Keep(None));
                self.closing = true;
            }
        }
    }

    /// A file was chosen in the dialog.
    pub fn choose(&mut self, purpose: Purpose, path: PathBuf) {
        self.asking = None;
        match purpose {
            Purpose::Open => self.apply(Command::Open(path)),
            Purpose::Rig => self.carry_out(Command::Edit(Edit::Rig(path))),
            Purpose::Base => {
                let file = Some(self.beside_scenario(&path));
                let base = crate::model::scenario::Base { clip: None, file };
                self.carry_out(Command::Edit(Edit::Base(Some(base))));
            }
            Purpose::Ground => {
                let ground = self.document().scenario.ground.clone();
                let ceiling = match ground.kind {
                    GroundKind::Mesh { ceiling, .. } => ceiling,
                    _ => None,
                };
                let kind = GroundKind::Mesh { file: self.beside_scenario(&path), ceiling, surface: None };
                self.carry_out(Command::Edit(Edit::Ground(Ground { kind, ..ground })));
            }
            Purpose::Save => self.save(with_ending(path, &["toml"])),
            Purpose::Export => {
                let path = with_ending(path, &["glb", "vrma", "fbx"]);
                if self.is_fresh() { self.export(path) } else { self.export = Some(path) }
            }
            Purpose::Clip | Purpose::Corrected | Purpose::Sweep | Purpose::Folder => self.chosen.push((purpose, path)),
        }
    }

    /// Answers the question of unsaved work: save it first, let it go, or neither.
    pub fn unsaved(&mut self, save: Option<bool>) {
        let Some(Asking::Unsaved(command)) = self.asking.take() else { return };
        match save {
            None => {}
            Some(false) => self.carry_out(*command),
            Some(true) => {
                self.then = Some(*command);
                self.carry_out(Command::Save);
            }
        }
    }

    /// Answers the question of what a crash left.
    pub fn recover(&mut self, take: bool) {
        let Some(Asking::Recover(copy, unsaved)) = self.asking.take() else { return };
        if take {
            match crate::model::scenario_text::parse("the copy", &unsaved.text) {
                Ok(scenario) => {
                    self.begin(Document::of(unsaved.rig, scenario), unsaved.file);
                    self.history.never_saved();
                }
                Err(errors) => {
                    return self.say_bad(format!(
                        "the copy cannot be read ({} faults): {}",
                        errors.faults.len(),
                        copy.display()
                    ));
                }
            }
        }
        self.files.ask(Errand::Forget(copy));
    }

    /// Stops asking.
    pub fn cancel(&mut self) {
        self.asking = None;
        self.then = None;
    }

    /// The file dialog looks into a folder.
    pub fn list(&mut self, folder: &Path) {
        self.files.ask(Errand::List(folder.to_owned()));
    }

    /// Writes files.
    pub fn write(&mut self, outputs: Vec<Output>) {
        self.files.ask(Errand::Write(outputs));
    }

    /// Says something.
    pub fn say(&mut self, text: String) {
        self.messages.push(Message { text, bad: false });
    }

    /// Says what went wrong.
    pub fn say_bad(&mut self, text: String) {
        self.messages.push(Message { text, bad: true });
    }

    /// The entry that is selected.
    pub fn selected_entry(&self) -> Option<Entry> {
        self.document().entry(self.selected?)
    }

    fn add(&mut self, entry: Entry) {
        let lane = entry.lane();
        self.history.apply(Edit::Add(entry), false);
        let index = self.document().entries(lane).len().saturating_sub(1);
        self.selected = Some(Place { lane, index });
    }

    fn delete(&mut self) {
        if let Some(place) = self.selected.take() {
            self.history.apply(Edit::Remove(place), false);
        }
    }

    fn begin(&mut self, document: Document, file: Option<PathBuf>) {
        self.history = History::new(document);
        (self.file, self.selected, self.view) = (file, None, View::Author);
        self.playback = Playback { playing: true, ..self.playback.clone() };
        self.playback.time = 0.0;
        self.asked = None;
    }

    /// Opens a file by what it is: a scenario, a rig to act on, a clip to audit.
    fn open(&mut self, path: PathBuf) {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        if is_scenario(&path) {
            self.files.ask(Errand::Open(path));
        } else if self.view == View::Audit || matches!(ending.as_str(), "bvh" | "fbx" | "vrma") {
            self.view = View::Audit;
            self.chosen.push((Purpose::Clip, path));
        } else if clip_files::ENDINGS.contains(&ending.as_str()) || path.as_os_str() == "builtin" {
            self.carry_out(Command::Edit(Edit::Rig(path)));
        } else {
            self.say_bad(format!(
                "{}: no file of this kind can be opened\n  help: open a scenario (.toml), a rig (.glb, .gltf, .vrm) or a clip (.bvh, .fbx, .vrma)",
                path.display()
            ));
        }
    }

    fn save(&mut self, path: PathBuf) {
        if self.faults.is_empty() {
            let scenario = Box::new(self.document().scenario.clone());
            self.files.ask(Errand::Save(path, scenario));
        } else {
            // It would not be read back.
            self.then = None;
            self.say_bad("not saved: the scenario has faults\n  help: mend what is marked red, or undo".to_owned());
        }
    }

    fn export(&mut self, path: PathBuf) {
        let Some(shown) = &self.shown else { return };
        let settings = Box::new(self.document().bake.clone());
        self.files.ask(Errand::Export(path, Box::new(shown.clone()), settings));
    }

    fn remember(&mut self) {
        if let Some(file) = self.file.clone() {
            let rig = self.document().rig.clone();
            self.remembered.opened(&file, &rig);
            self.files.ask(Errand::Remember(Box::new(self.remembered.clone())));
        }
    }

    /// A path as a scenario names it: from the scenario's folder where it lies in it.
    fn beside_scenario(&self, path: &Path) -> String {
        let folder = self.file.as_deref().and_then(Path::parent);
        let short = folder.and_then(|folder| path.strip_prefix(folder).ok()).unwrap_or(path);
        short.display().to_string()
    }
}

fn is_scenario(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// A name that ends as it should.
fn with_ending(path: PathBuf, endings: &[&str]) -> PathBuf {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if endings.contains(&ending.as_str()) {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(format!(".{}", endings.first().unwrap_or(&"")));
    PathBuf::from(name)
}

/// s, to the tick of 10 ms.
fn tidy(time: f64) -> f64 {
    (time * 100.0).round() / 100.0
}

/// A failure with its faults.
pub fn told(failure: &Failure) -> String {
    let Some(errors) = &failure.faults else { return failure.message.clone() };
    let mut text = failure.message.clone();
    for fault in errors.faults.iter().take(5) {
        let (line, _) = errors.line_column(fault);
        text += &format!("\nline {line}: {} ({})", fault.message, fault.remedy);
    }
    text
}
