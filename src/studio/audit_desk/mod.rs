//! The audit's desk: a clip is opened, its flags stand on a timeline and its footprints beside their prediction, and each correction is
//! looked at, accepted or rejected. Works in whatever window shows it.
//!
//! [`state`] is what is shown and decided, plain; the panels (`flags_list`, `details`, `timeline`, `plan`, `bars`) read it and
//! give [`Command`]s, which [`AuditDesk`] alone applies. [`work`] opens, judges, corrects and saves beside the window. The 3D
//! view is the caller's: it gets an [`AuditScene`]. Times s, frames from 0, clip space (metres, Y up).

mod bars;
mod colors;
mod details;
mod flags_list;
mod plan;
pub mod repairs;
pub mod shown;
pub mod skinned;
pub mod state;
mod timeline;
pub mod work;

pub use shown::{AuditScene, Preview, StepMark};

use super::time_map::TimeWindow;
use super::worker::{Wake, Worker};
use crate::disk::Failure;
use eframe::egui::{CentralPanel, Frame, Key, Modifiers, Panel, Ui};
use repairs::Decision;
use shown::Shown;
use state::{Command, State};
use std::path::{Path, PathBuf};
use work::{Answer, Ask, Question, Said, Wanted};

/// What the desk asks of the window around it.
#[derive(Clone, Debug, PartialEq)]
pub enum AuditRequest {
    /// A person wants to choose a clip; the answer is [`AuditDesk::open`].
    OpenDialog,
    /// A person wants to choose where the corrected file goes; this is a name that would do. The answer is [`AuditDesk::save`].
    SaveDialog(PathBuf),
    /// A sentence for the status line.
    Message(String),
}

/// The desk.
pub struct AuditDesk {
    state: State,
    worker: Worker<Question, Answer>,
    opening: u64,
    /// Counts corrections.
    run: u64,
    /// The one of that number is on its way; the decisions have changed since if true.
    correcting: Option<(u64, bool)>,
    requests: Vec<AuditRequest>,
}

impl AuditDesk {
    /// An empty one. `wake` is called from another thread when [`AuditDesk::tick`] has something to take.
    pub fn new(wake: Wake) -> AuditDesk {
        let worker = work::start(wake);
        AuditDesk { state: State::default(), worker, opening: 0, run: 0, correcting: None, requests: Vec::new() }
    }

    /// Opens a clip file; what was decided about another is gone.
    pub fn open(&mut self, path: PathBuf) {
        self.opening += 1;
        self.correcting = None;
        self.state = State { file: Some(path.clone()), doing: Some("Opening"), ..self.state.emptied() };
        self.ask(Ask::Open(path));
    }

    /// Writes the file with the corrections that were accepted; never over the file that is open.
    pub fn save(&mut self, path: PathBuf) {
        let wanted: Vec<Wanted> = self
            .state
            .repairs
            .iter()
            .filter(|(_, repairs)| repairs.count(Decision::Accepted) > 0)
            .map(|(clip, repairs)| Wanted {
                clip: *clip,
                accepted: repairs.flags(Decision::Accepted),
                leave: [repairs.flags(Decision::Rejected), repairs.flags(Decision::Pending)].concat(),
            })
            .collect();
        if wanted.is_empty() {
            self.state.fault = Some("nothing to save\n  help: accept a correction first".to_owned());
            return;
        }
        self.state.doing = Some("Saving");
        self.ask(Ask::Save(path, wanted));
    }

    /// Takes what the work beside the window has answered.
    pub fn tick(&mut self) {
        // Asked before its answers are taken: a worker that is idle has given them all.
        let idle = !self.worker.is_busy();
        for answer in self.worker.answers() {
            if answer.opening == self.opening {
                self.take(answer.said);
            }
        }
        if idle && !self.worker.is_busy() {
            self.state.doing = None;
        }
    }

    /// Whether work is under way.
    pub fn is_busy(&self) -> bool {
        self.state.doing.is_some()
    }

    /// Whether the playhead runs, so that the window has to be painted again.
    pub fn is_playing(&self) -> bool {
        self.state.playback.playing && self.state.shown.is_some()
    }

    /// What is shown and decided.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Draws it over all of `ui`; `view` draws the scene in the middle.
    pub fn ui(&mut self, ui: &mut Ui, view: &mut dyn FnMut(&mut Ui, &AuditScene)) -> Vec<AuditRequest> {
        self.tick();
        let mut commands = Vec::new();
        self.keys(ui, &mut commands);
        self.play(ui);
        let state = &self.state;
        Panel::top("audit_top").resizable(false).show(ui, |ui| bars::top(ui, state, &mut commands));
        if let Some(shown) = &state.shown {
            Panel::bottom("audit_time").resizable(true).default_size(210.0).size_range(170.0..=400.0).show(ui, |ui| {
                bars::transport(ui, state, shown, &mut commands);
                timeline::timeline(ui, state, shown, &mut commands);
            });
            Panel::left("audit_flags").default_size(290.0).size_range(220.0..=460.0).show(ui, |ui| {
                flags_list::flags_list(ui, state, shown, &mut commands);
            });
            Panel::right("audit_prints").default_size(320.0).size_range(240.0..=520.0).show(ui, |ui| {
                details::details(ui, state, shown, &mut commands);
                plan::plan(ui, state, shown, &mut commands);
            });
            CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
                bars::fault(ui, state, &mut commands);
                view(ui, &shown.scene(state.playback.time, state.preview, state.step));
            });
        } else {
            CentralPanel::default().show(ui, |ui| {
                bars::fault(ui, state, &mut commands);
                bars::empty(ui, state, &mut commands);
            });
        }
        for command in commands {
            self.apply(command);
        }
        std::mem::take(&mut self.requests)
    }

    fn ask(&self, ask: Ask) {
        self.worker.ask(Question { opening: self.opening, ask });
    }

    /// Keys of the desk, where no text is being written.
    fn keys(&self, ui: &Ui, commands: &mut Vec<Command>) {
        let text = ui.ctx().text_edit_focused();
        if self.state.shown.is_none() || text {
            return;
        }
        // Space and the arrows belong to a button that has the focus.
        let free = !ui.ctx().egui_wants_keyboard_input();
        let decide = |decision| self.state.selected_repair().map(|index| Command::Decide(index, decision));
        let keys = [
            (Key::N, Some(Command::NextFlag)),
            (Key::P, Some(Command::PreviousFlag)),
            (Key::A, decide(Decision::Accepted)),
            (Key::R, decide(Decision::Rejected)),
            (Key::Space, free.then_some(Command::Play)),
            (Key::ArrowRight, free.then_some(Command::Step(1))),
            (Key::ArrowLeft, free.then_some(Command::Step(-1))),
            (Key::Home, free.then_some(Command::Seek(0.0))),
            (Key::End, free.then_some(Command::Seek(f64::MAX))),
        ];
        for (key, command) in keys {
            if let Some(command) = command
                && ui.input_mut(|input| input.consume_key(Modifiers::NONE, key))
            {
                commands.push(command);
            }
        }
    }

    fn play(&mut self, ui: &Ui) {
        let duration = self.state.duration();
        if self.is_playing() {
            self.state.playback.advance(f64::from(ui.input(|input| input.stable_dt)), duration);
            ui.ctx().request_repaint();
        }
    }

    fn take(&mut self, said: Said) {
        let state = &mut self.state;
        match said {
            Said::Opened(clips) => {
                state.clips = clips;
                self.apply(Command::Choose(0));
            }
            Said::Read(clip, motion) if clip == state.chosen => {
                state.window = TimeWindow::whole(motion.duration());
                state.shown = Some(Shown { index: clip, before: *motion, after: None, skinned: None });
                self.correct();
                self.ask(Ask::Mesh(clip));
            }
            Said::Corrected(run, after, done) => {
                let Some((_, changed)) = self.correcting.take_if(|(asked, _)| *asked == run) else { return };
                state.repairs.entry(state.chosen).or_default().take(&done);
                if let Some(shown) = &mut state.shown {
                    shown.after = Some(*after);
                }
                if changed {
                    self.correct();
                }
            }
            Said::Mesh(clip, skinned) => {
                if let Some(shown) = state.shown.as_mut().filter(|shown| shown.index == clip) {
                    shown.skinned = Some(skinned);
                }
            }
            Said::Saved(path, repairs) => {
                let what = if repairs == 1 { "correction" } else { "corrections" };
                let sentence = format!("Saved {} with {repairs} {what}", path.display());
                state.notice = Some(sentence.clone());
                self.requests.push(AuditRequest::Message(sentence));
            }
            Said::Failed(what, Failure { message, .. }) => {
                self.correcting = None;
                let help =
                    if message.contains("help:") { "" } else { "\nOpen another file, or export this one again." };
                state.fault = Some(format!("Cannot {what}: {message}{help}"));
            }
            Said::Read(..) => {}
        }
    }

    /// Corrects again with what is rejected now; once more when that is done if it changes meanwhile.
    fn correct(&mut self) {
        if let Some((_, changed)) = &mut self.correcting {
            *changed = true;
            return;
        }
        self.run += 1;
        self.correcting = Some((self.run, false));
        self.state.doing = Some("Correcting");
        let leave = self.state.now().map(|repairs| repairs.flags(Decision::Rejected)).unwrap_or_default();
        self.ask(Ask::Correct(self.state.chosen, self.run, leave));
    }

    /// The one place where commands change anything.
    fn apply(&mut self, command: Command) {
        let state = &mut self.state;
        match command {
            Command::Choose(clip) => {
                self.correcting = None;
                (state.chosen, state.shown, state.doing) = (clip, None, Some("Reading"));
                (state.flag, state.step, state.playback.time) = (None, None, 0.0);
                self.ask(Ask::Choose(clip));
            }
            Command::Decide(index, decision) => {
                let now = state.repairs.entry(state.chosen).or_default();
                // The same once more takes it back.
                let same = now.list.get(index).is_some_and(|repair| repair.decision == decision);
                if now.decide(index, if same { Decision::Pending } else { decision }) {
                    self.correct();
                }
            }
            Command::AcceptAll => state.repairs.entry(state.chosen).or_default().accept_all(),
            Command::Open => self.requests.push(AuditRequest::OpenDialog),
            Command::Save => {
                let file = state.file.clone().unwrap_or_default();
                self.requests.push(AuditRequest::SaveDialog(beside(&file)));
            }
            other => state.apply(other),
        }
    }
}

/// A name for what is saved: beside the file, and never the file's own.
fn beside(file: &Path) -> PathBuf {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let ending = if ["fbx", "gltf"].contains(&ending.as_str()) { "glb" } else { &ending };
    file.with_file_name(format!("{stem}-corrected.{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_to_save_under_is_never_the_files_own() {
        let named = |file: &str| beside(Path::new(file)).display().to_string();
        assert_eq!(named("a/walk.bvh"), "a/walk-corrected.bvh");
        assert_eq!(named("walk.FBX"), "walk-corrected.glb");
        assert_eq!(named("hero.gltf"), "hero-corrected.glb");
        assert_eq!(named("hero.vrm"), "hero-corrected.vrm");
    }
}
